#include "segments.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

eskel_status esk_segments_add(esk_segments *segments, const esk_segment *segment)
{
	void *items = segments->items;
	if (!esk_memory_reserve(&items, &segments->capacity, segments->count + 1, sizeof *segments->items))
		return ESKEL_NO_MEMORY;
	segments->items = items;
	esk_segment copy = *segment;
	if (segment->name) {
		const size_t size = strlen(segment->name) + 1;
		copy.name = esk_memory_array(size, 1);
		if (!copy.name)
			return ESKEL_NO_MEMORY;
		memcpy(copy.name, segment->name, size);
	}
	segments->items[segments->count++] = copy;
	return ESKEL_OK;
}

const char *esk_segments_name(const esk_segments *segments, int32_t label)
{
	for (size_t i = 0; i < segments->count; i++)
		if (segments->items[i].label == label && segments->items[i].name)
			return segments->items[i].name;
	return NULL;
}

void esk_segments_clear(esk_segments *segments)
{
	for (size_t i = 0; i < segments->count; i++)
		free(segments->items[i].name);
	free(segments->items);
	*segments = (esk_segments){0};
}
