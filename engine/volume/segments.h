/* What a file says of its labels: segments, in layers when they overlap. */
#ifndef ESK_SEGMENTS_H
#define ESK_SEGMENTS_H

#include "eskel.h"

typedef struct {
	int32_t label;  /* that the volume gives it */
	uint32_t layer; /* that it is in */
	int32_t value;  /* of its voxels there */
	char *name;     /* NULL: none */
} esk_segment;

enum { ESK_SEGMENTS_LONGEST_NAME = 200, ESK_SEGMENTS_MOST_NAMES = 4096 };

/* All-zero is empty. */
typedef struct {
	size_t count, capacity;
	esk_segment *items;
} esk_segments;

/* Copies the segment and its name. ESKEL_NO_MEMORY. */
eskel_status esk_segments_add(esk_segments *segments, const esk_segment *segment);
/* Adds that a label is called so: without blanks at the ends and with blanks for control characters, cut off before the
 * character of UTF-8 that has no room. Nothing for label 0 or an empty name. ESKEL_MALFORMED past ESK_SEGMENTS_MOST_NAMES,
 * ESKEL_NO_MEMORY. */
eskel_status esk_segments_add_name(esk_segments *segments, int32_t label, const char *name, size_t size);
/* The name of the first segment that has the label and a name; NULL without. */
const char *esk_segments_name(const esk_segments *segments, int32_t label);
void esk_segments_clear(esk_segments *segments);

#endif
