#include "labelling.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

eskel_status esk_labelling_init(esk_labelling *labelling, const esk_segment *segments, size_t segment_count)
{
	esk_slot *slots = esk_memory_array(segment_count, sizeof *slots);
	esk_piece *pieces = esk_memory_zeroed_array(segment_count, ESK_SLOT_PIECES * sizeof *pieces);
	if (!slots || !pieces) {
		free(slots);
		free(pieces);
		return ESKEL_NO_MEMORY;
	}
	*labelling = (esk_labelling){
		.segments = segments,
		.segment_count = segment_count,
		.slots = slots,
		.pieces = pieces,
		.piece_count = segment_count * ESK_SLOT_PIECES,
		.piece_capacity = segment_count * ESK_SLOT_PIECES,
		.class_count = 1,
	};
	for (size_t i = 0; i < segment_count; i++) {
		slots[i] = (esk_slot){i * ESK_SLOT_PIECES, 1, ESK_SLOT_PIECES};
		pieces[i * ESK_SLOT_PIECES] = (esk_piece){segments[i].x_last, 0};
		esk_sums_add(&labelling->sums[0], &segments[i]);
	}
	return ESKEL_OK;
}

void esk_labelling_clear(esk_labelling *labelling)
{
	free(labelling->slots);
	free(labelling->pieces);
	*labelling = (esk_labelling){0};
}

/* Makes room for count pieces, of which none is there yet. */
static bool reserve(esk_labelling *labelling, esk_slot *slot, uint32_t count)
{
	if (count > slot->capacity) {
		const uint32_t room = 2 * count;
		if (!esk_memory_reserve((void **)&labelling->pieces, &labelling->piece_capacity,
			    labelling->piece_count + room, sizeof *labelling->pieces))
			return false;
		slot->first = labelling->piece_count;
		slot->capacity = (uint16_t)room;
		labelling->piece_count += room;
	}
	slot->count = (uint16_t)count;
	return true;
}

eskel_status esk_labelling_replace(esk_labelling *labelling, size_t segment, const esk_piece *pieces, uint32_t count)
{
	const esk_slot before = labelling->slots[segment];
	if (!reserve(labelling, &labelling->slots[segment], count))
		return ESKEL_NO_MEMORY;
	esk_segment part = labelling->segments[segment];
	for (uint32_t i = 0; i < before.count; i++) {
		const esk_piece *piece = &labelling->pieces[before.first + i];
		part.x_last = piece->x_last;
		esk_sums_remove(&labelling->sums[piece->class_index], &part);
		labelling->touched[piece->class_index] = true;
		part.x_first = part.x_last + 2;
	}
	part = labelling->segments[segment];
	for (uint32_t i = 0; i < count; i++) {
		part.x_last = pieces[i].x_last;
		esk_sums_add(&labelling->sums[pieces[i].class_index], &part);
		labelling->touched[pieces[i].class_index] = true;
		part.x_first = part.x_last + 2;
	}
	memcpy(labelling->pieces + labelling->slots[segment].first, pieces, count * sizeof *pieces);
	return ESKEL_OK;
}

static void load_piece(const esk_labelling *labelling, esk_piece_cursor *c, int32_t x_first)
{
	const esk_piece *piece = &labelling->pieces[labelling->slots[c->segment].first + c->piece];
	c->part = labelling->segments[c->segment];
	c->part.x_first = x_first;
	c->part.x_last = piece->x_last;
	c->class_index = piece->class_index;
}

esk_piece_cursor esk_labelling_first(const esk_labelling *labelling)
{
	esk_piece_cursor c = {.valid = labelling->segment_count > 0};
	if (c.valid)
		load_piece(labelling, &c, labelling->segments[0].x_first);
	return c;
}

void esk_labelling_next(const esk_labelling *labelling, esk_piece_cursor *c)
{
	if (++c->piece < labelling->slots[c->segment].count) {
		load_piece(labelling, c, c->part.x_last + 2);
		return;
	}
	c->piece = 0;
	c->valid = ++c->segment < labelling->segment_count;
	if (c->valid)
		load_piece(labelling, c, labelling->segments[c->segment].x_first);
}

void esk_labelling_moments(const esk_labelling *labelling, const bool wanted[ESKEL_LEVELS_MAX], esk_moments *moments)
{
	for (uint32_t j = 0; j < labelling->class_count; j++)
		if (wanted[j])
			moments[j] = (esk_moments){0};
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		if (wanted[c.class_index])
			esk_moments_add(&moments[c.class_index], &c.part);
}

eskel_status esk_labelling_collect(
	const esk_labelling *labelling, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1])
{
	size_t next[ESKEL_LEVELS_MAX + 1] = {0};
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		next[c.class_index + 1]++;
	for (uint32_t j = 0; j < ESKEL_LEVELS_MAX; j++)
		next[j + 1] += next[j];
	esk_segment *out = esk_memory_array(next[ESKEL_LEVELS_MAX], sizeof *out);
	if (!out)
		return ESKEL_NO_MEMORY;
	memcpy(first, next, sizeof next);
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		out[next[c.class_index]++] = c.part;
	*segments = out;
	return ESKEL_OK;
}
