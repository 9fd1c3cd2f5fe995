/* The elements of a segmentation that are read. */
#ifndef ESK_ATTRIBUTES_H
#define ESK_ATTRIBUTES_H

#include "elements.h"

/* Sequences of the data set, and of functional groups what all frames share and what each has. */
#define ESK_SEGMENTS 0x00620002u
#define ESK_SHARED_GROUPS 0x52009229u
#define ESK_FRAME_GROUPS 0x52009230u

typedef enum {
	ESK_CHARACTER_SET,
	ESK_CLASS,
	ESK_SAMPLES,
	ESK_FRAME_COUNT,
	ESK_ROWS,
	ESK_COLUMNS,
	ESK_BITS,
	ESK_BACKGROUND,
	ESK_TYPE,
	ESK_MOST_FRACTION,
	ESK_NUMBER,
	ESK_LABEL,
	ESK_TYPE_MEANING,
	ESK_TYPE_SIDE_VALUE,
	ESK_TYPE_SIDE_MEANING,
	ESK_REGION_MEANING,
	ESK_REGION_SIDE_VALUE,
	ESK_REGION_SIDE_MEANING,
	ESK_POSITION,
	ESK_ORIENTATION,
	ESK_SPACING,
	ESK_THICKNESS,
	ESK_BETWEEN,
	ESK_FRAME_SEGMENT,
} esk_attribute;

/* False for an element that is not read. */
bool esk_attribute_find(const esk_element_place *place, esk_attribute *attribute);

#endif
