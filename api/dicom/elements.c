#include "elements.h"

#include "refusal.h"

#include <string.h>

#define ITEM 0xfffee000u
#define UNDEFINED UINT32_MAX

/* A segmentation of 2^18 frames has some 200 MB of functional groups; what is wanted of them is short. */
static const uint64_t most_bytes = (uint64_t)1 << 28;
enum { longest_value = 1 << 12 };

typedef struct {
	esk_window *window;
	const esk_element_visitor *visitor;
	void *reader;
	eskel_error *error;
	esk_element_place place;
	int depth;
} walk;

typedef struct {
	uint32_t tag, size;
	bool sequence;
} head;

static uint32_t little_endian(const uint8_t *bytes, unsigned size)
{
	uint32_t number = 0;
	for (unsigned i = size; i-- > 0;)
		number = number << 8 | bytes[i];
	return number;
}

static uint32_t tag_at(const uint8_t *bytes)
{
	return little_endian(bytes, 2) << 16 | little_endian(bytes + 2, 2);
}

/* The value representations whose length has 32 bits, behind two bytes that are reserved (PS3.5, table 7.1-1). */
static bool is_long(const uint8_t *representation)
{
	static const char names[][3] = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"};
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (memcmp(representation, names[i], 2) == 0)
			return true;
	return false;
}

static eskel_status read_head(walk *w, head *h)
{
	const uint8_t *bytes;
	eskel_status status = esk_window_look(w->window, 8, &bytes, w->error);
	if (status != ESKEL_OK)
		return status;
	const bool extended = is_long(bytes + 4);
	if (extended)
		status = esk_window_look(w->window, 12, &bytes, w->error);
	if (status != ESKEL_OK)
		return status;
	*h = (head){.tag = tag_at(bytes),
		.size = extended ? little_endian(bytes + 8, 4) : little_endian(bytes + 6, 2),
		.sequence = memcmp(bytes + 4, "SQ", 2) == 0};
	esk_window_take(w->window, extended ? 12 : 8);
	if (h->size == UNDEFINED)
		return esk_refuse(w->error, ESKEL_UNSUPPORTED, "DICOM element (%04x,%04x) has no length%s",
			h->tag >> 16, h->tag & 0xffff, h->tag == ESK_PIXEL_DATA ? ": its pixels are compressed" : "");
	if (h->tag != ESK_PIXEL_DATA && w->window->taken + h->size > most_bytes)
		return esk_refuse(w->error, ESKEL_TOO_LARGE,
			"the DICOM file has more than %llu bytes before its pixel data",
			(unsigned long long)most_bytes);
	return ESKEL_OK;
}

static eskel_status refuse_overrun(const walk *w, uint32_t tag)
{
	return esk_refuse(w->error, ESKEL_MALFORMED, "DICOM element (%04x,%04x) is longer than the sequence it is in",
		tag >> 16, tag & 0xffff);
}

static eskel_status read_value(walk *w, const head *h)
{
	const uint8_t *bytes;
	w->place.tag = h->tag;
	if (!w->visitor->wants(w->reader, &w->place))
		return esk_window_skip(w->window, h->size, w->error);
	if (h->size > longest_value)
		return esk_refuse(w->error, ESKEL_MALFORMED,
			"DICOM element (%04x,%04x) has %u bytes, expected at most %d", h->tag >> 16, h->tag & 0xffff,
			h->size, longest_value);
	eskel_status status = esk_window_look(w->window, h->size, &bytes, w->error);
	if (status != ESKEL_OK)
		return status;
	status = w->visitor->value(w->reader, &w->place, bytes, h->size, w->error);
	esk_window_take(w->window, h->size);
	return status;
}

static eskel_status read_sequence(walk *w, const head *sequence);

static eskel_status read_item(walk *w, uint64_t end)
{
	eskel_status status = ESKEL_OK;
	head h;
	while (status == ESKEL_OK && w->window->taken < end) {
		status = read_head(w, &h);
		if (status == ESKEL_OK && w->window->taken + h.size > end)
			status = refuse_overrun(w, h.tag);
		if (status == ESKEL_OK)
			status = h.sequence ? read_sequence(w, &h) : read_value(w, &h);
	}
	return status;
}

static eskel_status begin_item(walk *w, uint64_t end_of_sequence, uint64_t *end)
{
	const uint8_t *bytes;
	eskel_status status = esk_window_look(w->window, 8, &bytes, w->error);
	if (status != ESKEL_OK)
		return status;
	const uint32_t tag = tag_at(bytes), size = little_endian(bytes + 4, 4);
	esk_window_take(w->window, 8);
	*end = w->window->taken + size;
	if (tag != ITEM)
		return esk_refuse(w->error, ESKEL_MALFORMED, "(%04x,%04x) is in a DICOM sequence, expected an item",
			tag >> 16, tag & 0xffff);
	return *end > end_of_sequence ? refuse_overrun(w, tag) : ESKEL_OK;
}

static eskel_status read_items(walk *w, uint32_t sequence, uint64_t end)
{
	const bool outermost = w->depth == 1;
	eskel_status status = ESKEL_OK;
	uint64_t end_of_item;
	while (status == ESKEL_OK && w->window->taken < end) {
		status = begin_item(w, end, &end_of_item);
		if (status == ESKEL_OK && outermost)
			status = w->visitor->item(w->reader, sequence, true, w->error);
		if (status == ESKEL_OK)
			status = read_item(w, end_of_item);
		if (status == ESKEL_OK && outermost)
			status = w->visitor->item(w->reader, sequence, false, w->error);
	}
	return status;
}

static eskel_status read_sequence(walk *w, const head *sequence)
{
	const esk_element_place place = w->place;
	if (w->depth == ESK_ELEMENTS_DEPTH)
		return esk_refuse(w->error, ESKEL_UNSUPPORTED, "DICOM sequences are nested more than %d deep",
			ESK_ELEMENTS_DEPTH);
	if (w->depth++ == 0)
		w->place.root = sequence->tag;
	w->place.parent = sequence->tag;
	eskel_status status = read_items(w, sequence->tag, w->window->taken + sequence->size);
	w->depth--;
	w->place = place;
	return status;
}

eskel_status esk_elements_read(
	esk_window *window, const esk_element_visitor *visitor, void *reader, uint32_t *pixel_bytes, eskel_error *error)
{
	walk w = {.window = window, .visitor = visitor, .reader = reader, .error = error};
	for (;;) {
		bool at_end = false;
		head h;
		eskel_status status = esk_window_at_end(window, &at_end, error);
		if (status == ESKEL_OK && at_end)
			status = esk_refuse(error, ESKEL_TRUNCATED, "the DICOM file has no pixel data");
		if (status == ESKEL_OK)
			status = read_head(&w, &h);
		if (status == ESKEL_OK && h.tag == ESK_PIXEL_DATA) {
			*pixel_bytes = h.size;
			return ESKEL_OK;
		}
		if (status == ESKEL_OK)
			status = h.sequence ? read_sequence(&w, &h) : read_value(&w, &h);
		if (status != ESKEL_OK)
			return status;
	}
}
