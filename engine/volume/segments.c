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

static bool is_blank(char c)
{
	return (unsigned char)c <= ' ' || c == 0x7f;
}

eskel_status esk_segments_add_name(esk_segments *segments, int32_t label, const char *name, size_t size)
{
	char kept[ESK_SEGMENTS_LONGEST_NAME + 1];
	for (; size > 0 && is_blank(name[0]); size--)
		name++;
	if (size > ESK_SEGMENTS_LONGEST_NAME)
		for (size = ESK_SEGMENTS_LONGEST_NAME; size > 0 && (name[size] & 0xc0) == 0x80;)
			size--;
	while (size > 0 && is_blank(name[size - 1]))
		size--;
	if (label == 0 || size == 0)
		return ESKEL_OK;
	if (segments->count >= ESK_SEGMENTS_MOST_NAMES)
		return ESKEL_MALFORMED;
	for (size_t i = 0; i < size; i++)
		kept[i] = is_blank(name[i]) ? ' ' : name[i];
	kept[size] = 0;
	return esk_segments_add(segments, &(esk_segment){.label = label, .value = label, .name = kept});
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
