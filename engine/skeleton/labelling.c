#include "labelling.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

void esk_labelling_clear(esk_labelling *labelling)
{
	free(labelling->parts);
	*labelling = (esk_labelling){0};
}

static bool reserve(esk_labelling *labelling, size_t more)
{
	return esk_memory_reserve(
		(void **)&labelling->parts, &labelling->capacity, labelling->count + more, sizeof *labelling->parts);
}

bool esk_labelling_add(esk_labelling *labelling, const esk_part *parts, size_t count)
{
	if (!reserve(labelling, count))
		return false;
	memcpy(labelling->parts + labelling->count, parts, count * sizeof *parts);
	labelling->count += count;
	return true;
}

/* The part becomes up to three: what lies before the voxel, the voxel, what lies after it. */
eskel_status esk_labelling_give(esk_labelling *labelling, size_t part, int32_t x, uint32_t class_index)
{
	const esk_part old = labelling->parts[part];
	esk_part made[3];
	size_t count = 0;
	if (x > old.segment.x_first) {
		made[count] = old;
		made[count++].segment.x_last = x - 2;
	}
	made[count] = (esk_part){old.segment, class_index};
	made[count].segment.x_first = x;
	made[count++].segment.x_last = x;
	if (x < old.segment.x_last) {
		made[count] = old;
		made[count++].segment.x_first = x + 2;
	}
	if (!reserve(labelling, 2))
		return ESKEL_NO_MEMORY;
	esk_part *place = labelling->parts + part;
	memmove(place + count, place + 1, (labelling->count - part - 1) * sizeof *place);
	memcpy(place, made, count * sizeof *place);
	labelling->count += count - 1;
	return ESKEL_OK;
}

eskel_status esk_labelling_collect(
	const esk_labelling *labelling, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1])
{
	size_t next[ESKEL_LEVELS_MAX + 1] = {0};
	for (size_t i = 0; i < labelling->count; i++)
		next[labelling->parts[i].class_index + 1]++;
	for (uint32_t j = 0; j < ESKEL_LEVELS_MAX; j++)
		next[j + 1] += next[j];
	esk_segment *out = esk_memory_array(labelling->count, sizeof *out);
	if (!out)
		return ESKEL_NO_MEMORY;
	memcpy(first, next, sizeof next);
	for (size_t i = 0; i < labelling->count; i++)
		out[next[labelling->parts[i].class_index]++] = labelling->parts[i].segment;
	*segments = out;
	return ESKEL_OK;
}
