/* Pixels of one bit follow one another from the lowest bit of a byte to its highest, on from frame to frame (PS3.5,
 * 8.1.1 and D), so a row may begin within a byte. Others have one or two bytes.
 */
#include "pixels.h"

#include "refusal.h"

#include <endian.h>
#include <string.h>

typedef struct {
	const esk_segmentation *segmentation;
	eskel_volume *volume;
	const esk_frame *frame;
	uint32_t frame_number; /* from 1 on */
	uint32_t row;          /* of the frame */
	eskel_error *error;
} reading;

static eskel_status add_run(const reading *r, int32_t label, uint32_t first, uint32_t end)
{
	const uint16_t *place = r->frame->place;
	const eskel_run run = {
		(uint16_t)(place[0] + first), (uint16_t)(place[0] + end - 1), (uint16_t)(place[1] + r->row), place[2]};
	return eskel_volume_add_run(r->volume, label, run, r->error);
}

/* The first place in from .. end - 1 whose bit is set, or is not; end without one. 8 bytes beyond the last may be
 * loaded. */
static uint64_t find_bit(const uint8_t *bytes, uint64_t from, uint64_t end, bool set)
{
	enum { loaded = 57 }; /* bits, whichever of a byte's is the first */
	while (from < end) {
		uint64_t word;
		memcpy(&word, bytes + from / 8, sizeof word);
		word = le64toh(word) >> from % 8;
		word = (set ? word : ~word) & (((uint64_t)1 << loaded) - 1);
		if (word != 0) {
			from += (uint64_t)__builtin_ctzll(word);
			break;
		}
		from += loaded;
	}
	return from < end ? from : end;
}

/* first: of the row's bits. */
static eskel_status add_bits(const reading *r, const uint8_t *bytes, unsigned first)
{
	const uint64_t end = first + r->segmentation->columns;
	eskel_status status = ESKEL_OK;
	for (uint64_t from = find_bit(bytes, first, end, true); from < end && status == ESKEL_OK;) {
		const uint64_t to = find_bit(bytes, from, end, false);
		status = add_run(r, r->frame->segment, (uint32_t)(from - first), (uint32_t)(to - first));
		from = find_bit(bytes, to, end, true);
	}
	return status;
}

static unsigned value_at(const reading *r, const uint8_t *bytes, uint32_t x)
{
	return r->segmentation->bits == 8 ? bytes[x] : (unsigned)(bytes[2 * x] | bytes[2 * x + 1] << 8);
}

/* 0 for background. */
static eskel_status label_of(const reading *r, unsigned value, int32_t *label)
{
	const esk_segmentation *s = r->segmentation;
	if (s->type == ESK_LABEL_MAP) {
		*label = value == s->background ? 0 : (int32_t)value;
		return ESKEL_OK;
	}
	*label = value == 0 ? 0 : r->frame->segment;
	return value == 0 || value == s->most_fraction
		       ? ESKEL_OK
		       : esk_refuse(r->error, ESKEL_BAD_VALUE,
				 "frame %u has the fraction %u of %u, expected 0 or %u: only segmentations that are "
				 "binary are read",
				 r->frame_number, value, s->most_fraction, s->most_fraction);
}

static eskel_status add_values(const reading *r, const uint8_t *bytes)
{
	const uint32_t columns = r->segmentation->columns;
	eskel_status status = ESKEL_OK;
	for (uint32_t first = 0, end; first < columns && status == ESKEL_OK; first = end) {
		const unsigned value = value_at(r, bytes, first);
		int32_t label = 0;
		for (end = first + 1; end < columns && value_at(r, bytes, end) == value;)
			end++;
		status = label_of(r, value, &label);
		if (status == ESKEL_OK && label != 0)
			status = add_run(r, label, first, end);
	}
	return status;
}

/* *bit: where the row begins in the next byte of the window. */
static eskel_status read_row(reading *r, esk_window *window, unsigned *bit)
{
	const uint64_t end = *bit + (uint64_t)r->segmentation->columns * r->segmentation->bits;
	const uint8_t *bytes;
	eskel_status status = esk_window_look(window, (size_t)((end + 7) / 8), &bytes, r->error);
	if (status != ESKEL_OK)
		return status;
	status = r->segmentation->bits == 1 ? add_bits(r, bytes, *bit) : add_values(r, bytes);
	esk_window_take(window, (size_t)(end / 8));
	*bit = (unsigned)(end % 8);
	return status;
}

eskel_status esk_pixels_read(
	esk_window *window, const esk_segmentation *segmentation, eskel_volume *volume, eskel_error *error)
{
	reading r = {.segmentation = segmentation, .volume = volume, .error = error};
	eskel_status status = ESKEL_OK;
	unsigned bit = 0;
	for (size_t i = 0; i < segmentation->frame_count; i++) {
		r.frame = &segmentation->frames[i];
		r.frame_number = (uint32_t)i + 1;
		for (r.row = 0; r.row < segmentation->rows && status == ESKEL_OK; r.row++)
			status = read_row(&r, window, &bit);
	}
	return status;
}
