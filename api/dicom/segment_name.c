#include "segment_name.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Empty, or a number behind the word that programs give. */
static bool is_nobodys(const char *label)
{
	static const char *const words[] = {"Segment_", "Segment "};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strncasecmp(label, words[i], strlen(words[i])) == 0)
			label += strlen(words[i]);
	return label[strspn(label, "0123456789")] == 0;
}

void esk_segment_name(const esk_dicom_segment *segment, char name[ESK_SEGMENT_NAME])
{
	static const char *const sides[] = {[ESK_CODED_LEFT] = "left", [ESK_CODED_RIGHT] = "right"};
	const char *type = strcasecmp(segment->type, "Tissue") == 0 ? "" : segment->type;
	const char *chosen = !is_nobodys(segment->label) ? segment->label : segment->region[0] ? segment->region : type;
	const esk_coded_side side = segment->type_side ? segment->type_side : segment->region_side;
	const bool said = side == ESK_CODED_NOTHING || strcasestr(chosen, sides[side]);
	snprintf(name, ESK_SEGMENT_NAME, "%s%s%s", chosen, chosen[0] && !said ? " " : "",
		chosen[0] && !said ? sides[side] : "");
}
