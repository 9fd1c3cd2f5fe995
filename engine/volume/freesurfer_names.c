/* The rows of FreeSurferColorLUT.txt (version 7) that FreeSurfer's aseg.mgz uses. No more: numbers beyond these are as often
 * somebody's own. */
#include "freesurfer_names.h"

#include <stddef.h>

static const struct {
	int32_t label;
	const char *name;
} names[] = {
	{2, "Left-Cerebral-White-Matter"},
	{3, "Left-Cerebral-Cortex"},
	{4, "Left-Lateral-Ventricle"},
	{5, "Left-Inf-Lat-Vent"},
	{7, "Left-Cerebellum-White-Matter"},
	{8, "Left-Cerebellum-Cortex"},
	{10, "Left-Thalamus"},
	{11, "Left-Caudate"},
	{12, "Left-Putamen"},
	{13, "Left-Pallidum"},
	{14, "3rd-Ventricle"},
	{15, "4th-Ventricle"},
	{16, "Brain-Stem"},
	{17, "Left-Hippocampus"},
	{18, "Left-Amygdala"},
	{24, "CSF"},
	{26, "Left-Accumbens-area"},
	{28, "Left-VentralDC"},
	{30, "Left-vessel"},
	{31, "Left-choroid-plexus"},
	{41, "Right-Cerebral-White-Matter"},
	{42, "Right-Cerebral-Cortex"},
	{43, "Right-Lateral-Ventricle"},
	{44, "Right-Inf-Lat-Vent"},
	{46, "Right-Cerebellum-White-Matter"},
	{47, "Right-Cerebellum-Cortex"},
	{49, "Right-Thalamus"},
	{50, "Right-Caudate"},
	{51, "Right-Putamen"},
	{52, "Right-Pallidum"},
	{53, "Right-Hippocampus"},
	{54, "Right-Amygdala"},
	{58, "Right-Accumbens-area"},
	{60, "Right-VentralDC"},
	{62, "Right-vessel"},
	{63, "Right-choroid-plexus"},
	{72, "5th-Ventricle"},
	{77, "WM-hypointensities"},
	{78, "Left-WM-hypointensities"},
	{79, "Right-WM-hypointensities"},
	{80, "non-WM-hypointensities"},
	{81, "Left-non-WM-hypointensities"},
	{82, "Right-non-WM-hypointensities"},
	{85, "Optic-Chiasm"},
	{251, "CC_Posterior"},
	{252, "CC_Mid_Posterior"},
	{253, "CC_Central"},
	{254, "CC_Mid_Anterior"},
	{255, "CC_Anterior"},
};

const char *esk_freesurfer_name(int32_t label)
{
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (names[i].label == label)
			return names[i].name;
	return NULL;
}
