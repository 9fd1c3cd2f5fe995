/* FreeSurfer's names of the labels of its subcortical segmentation. */
#ifndef ESK_FREESURFER_NAMES_H
#define ESK_FREESURFER_NAMES_H

#include <stdint.h>

/* What FreeSurferColorLUT.txt calls a label that FreeSurfer's own aseg.mgz may have; NULL for any other. Static. */
const char *esk_freesurfer_name(int32_t label);

#endif
