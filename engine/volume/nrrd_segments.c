/* Segments of 3D Slicer: pairs such as
 *
 *   Segment0_LabelValue:=3
 *   Segment0_Layer:=0
 *   Segment0_Name:=Femur
 *   Segment0_Tags:=Segmentation.TerminologyEntry:CONTEXT~CATEGORY~TYPE~MODIFIER~CONTEXT~REGION~MODIFIER|...
 *
 * in which each part of the terminology but a context is scheme^code^meaning, or ^^. A segment is called what its person
 * calls it. One that nobody named (Slicer writes Segment_1 and so on) is called by the meaning of its region or, without
 * one, of its type, unless that is Slicer's default, Tissue. Where a modifier means Left or Right and the name has no
 * such word, the word is added, so that the name tells the side too.
 *
 * A segment's label is its label value. Segments that overlap lie in several layers, of which each has values of its own:
 * where two segments have the same, the label of every segment is its number, from 1 on. The oldest files say no layer:
 * segment N is in layer N, with value 1.
 */
#include "nrrd_segments.h"

#include "error.h"
#include "memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A name fits what is kept, with the word for a side behind it. */
enum { name_room = ESK_SEGMENTS_LONGEST_NAME + 1, longest_name = name_room - sizeof " right" };

typedef struct {
	esk_nrrd_span name, tags;
	int32_t value, layer;
	bool there;
} segment;

typedef struct {
	segment *items;
	size_t count, capacity;
} collection;

static bool starts_with(esk_nrrd_span span, const char *word)
{
	return span.size >= strlen(word) && memcmp(span.text, word, strlen(word)) == 0;
}

static esk_nrrd_span without(esk_nrrd_span span, size_t size)
{
	return (esk_nrrd_span){span.text + size, span.size - size};
}

/* Takes the digits at the start of the span as a number; false when there is none or it has more than 9 digits. */
static bool take_number(esk_nrrd_span *span, int32_t *number)
{
	size_t digits = 0;
	*number = 0;
	for (; digits < span->size && span->text[digits] >= '0' && span->text[digits] <= '9' && digits < 10; digits++)
		if (digits < 9)
			*number = *number * 10 + (span->text[digits] - '0');
	*span = without(*span, digits);
	return digits > 0 && digits < 10;
}

/* ---- collecting */

static eskel_status make_room(collection *all, size_t number, eskel_error *error)
{
	void *items = all->items;
	if (number >= ESK_SEGMENTS_MOST_NAMES)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the NRRD header describes segment %zu, expected at most %d segments", number,
			ESK_SEGMENTS_MOST_NAMES);
	if (!esk_memory_reserve(&items, &all->capacity, number + 1, sizeof *all->items))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu segments", number + 1);
	all->items = items;
	for (; all->count <= number; all->count++)
		all->items[all->count] = (segment){.value = 1, .layer = (int32_t)all->count};
	return ESKEL_OK;
}

static eskel_status take_value(segment *s, size_t number, esk_nrrd_span value, eskel_error *error)
{
	if (!take_number(&value, &s->value) || value.size > 0 || s->value == 0)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the label value of segment %zu is no whole number from 1 to 999999999", number);
	return ESKEL_OK;
}

static eskel_status take_pair(collection *all, esk_nrrd_span key, esk_nrrd_span value, eskel_error *error)
{
	static const char prefix[] = "Segment";
	int32_t number;
	if (!starts_with(key, prefix))
		return ESKEL_OK;
	key = without(key, strlen(prefix));
	if (!take_number(&key, &number) || key.size == 0 || key.text[0] != '_')
		return ESKEL_OK;
	eskel_status status = make_room(all, (size_t)number, error);
	if (status != ESKEL_OK)
		return status;
	segment *s = &all->items[number];
	s->there = true;
	if (esk_nrrd_span_is(key, "_Name"))
		s->name = value;
	else if (esk_nrrd_span_is(key, "_Tags"))
		s->tags = value;
	else if (esk_nrrd_span_is(key, "_LabelValue"))
		status = take_value(s, (size_t)number, value, error);
	else if (esk_nrrd_span_is(key, "_Layer") && (!take_number(&value, &s->layer) || value.size > 0))
		status = esk_error_set(
			error, ESKEL_MALFORMED, "the layer of segment %d is no whole number from 0", (int)number);
	return status;
}

static eskel_status collect(esk_nrrd_span header, collection *all, eskel_error *error)
{
	esk_nrrd_span line, key, value;
	eskel_status status = ESKEL_OK;
	while (status == ESKEL_OK && esk_nrrd_next_line(&header, &line))
		if (esk_nrrd_split(line, &key, &value) == ESK_NRRD_PAIR)
			status = take_pair(all, key, value, error);
	return status;
}

/* ---- naming */

typedef enum { TYPE = 2, TYPE_MODIFIER = 3, REGION = 5, REGION_MODIFIER = 6 } terminology_part;

/* The meaning of a part of the terminology entry; empty when there is none. */
static esk_nrrd_span meaning_of(esk_nrrd_span tags, terminology_part part)
{
	static const char key[] = "TerminologyEntry:";
	const char *begin = tags.size > 0 ? memmem(tags.text, tags.size, key, strlen(key)) : NULL;
	if (!begin)
		return (esk_nrrd_span){"", 0};
	const char *at = begin + strlen(key), *end = tags.text + tags.size, *bar = memchr(at, '|', (size_t)(end - at));
	end = bar ? bar : end;
	for (int i = 0; i < (int)part; i++) {
		at = memchr(at, '~', (size_t)(end - at));
		if (!at)
			return (esk_nrrd_span){"", 0};
		at++;
	}
	const char *tilde = memchr(at, '~', (size_t)(end - at));
	end = tilde ? tilde : end;
	for (const char *hat; (hat = memchr(at, '^', (size_t)(end - at)));)
		at = hat + 1;
	return (esk_nrrd_span){at, (size_t)(end - at)};
}

static bool is_nobodys_name(esk_nrrd_span name)
{
	static const char prefix[] = "Segment_";
	int32_t number;
	if (!starts_with(name, prefix))
		return name.size == 0;
	name = without(name, strlen(prefix));
	return take_number(&name, &number) && name.size == 0;
}

static esk_nrrd_span choose_name(const segment *s)
{
	if (!is_nobodys_name(s->name))
		return s->name;
	const esk_nrrd_span region = meaning_of(s->tags, REGION), type = meaning_of(s->tags, TYPE);
	return region.size > 0 ? region : esk_nrrd_span_is(type, "Tissue") ? (esk_nrrd_span){"", 0} : type;
}

/* "left", "right" or "". */
static const char *side_of(const segment *s)
{
	static const terminology_part modifiers[] = {TYPE_MODIFIER, REGION_MODIFIER};
	for (size_t i = 0; i < 2; i++) {
		const esk_nrrd_span meaning = meaning_of(s->tags, modifiers[i]);
		if (esk_nrrd_span_is(meaning, "left"))
			return "left";
		if (esk_nrrd_span_is(meaning, "right"))
			return "right";
	}
	return "";
}

/* Undoes the escapes of a value, \n and \\; a line's end is a blank in a name. What does not fit is cut off before a
 * character of UTF-8. */
static void unescape(esk_nrrd_span value, char name[name_room])
{
	size_t size = 0;
	for (size_t i = 0; i < value.size && value.text[i] && size <= longest_name; i++) {
		char c = value.text[i];
		if (c == '\\' && i + 1 < value.size && (value.text[i + 1] == 'n' || value.text[i + 1] == '\\'))
			c = value.text[++i] == 'n' ? ' ' : '\\';
		name[size++] = c;
	}
	if (size > longest_name)
		for (size = longest_name; size > 0 && (name[size] & 0xc0) == 0x80;)
			size--;
	name[size] = 0;
}

static void name_segment(const segment *s, char name[name_room])
{
	unescape(choose_name(s), name);
	const char *side = side_of(s);
	if (name[0] && side[0] && !strcasestr(name, side)) {
		strcat(name, " ");
		strcat(name, side);
	}
}

/* ---- the whole */

static bool are_values_distinct(const collection *all)
{
	for (size_t i = 0; i < all->count; i++)
		for (size_t j = 0; j < i && all->items[i].there; j++)
			if (all->items[j].there && all->items[j].value == all->items[i].value)
				return false;
	return true;
}

static eskel_status add_segments(
	const collection *all, uint32_t layer_count, esk_segments *segments, eskel_error *error)
{
	const bool by_value = layer_count == 1 || are_values_distinct(all);
	for (size_t i = 0; i < all->count; i++) {
		const segment *s = &all->items[i];
		char name[name_room];
		if (!s->there)
			continue;
		if (layer_count > 1 && (uint32_t)s->layer >= layer_count)
			return esk_error_set(error, ESKEL_MALFORMED,
				"segment %zu is in layer %d, expected one below %u", i, (int)s->layer, layer_count);
		name_segment(s, name);
		const esk_segment added = {.label = by_value ? s->value : (int32_t)i + 1,
			.layer = layer_count > 1 ? (uint32_t)s->layer : 0,
			.value = s->value,
			.name = name[0] ? name : NULL};
		if (esk_segments_add(segments, &added) != ESKEL_OK)
			return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu segments", all->count);
	}
	return ESKEL_OK;
}

eskel_status esk_nrrd_segments_read(
	esk_nrrd_span header, uint32_t layer_count, esk_segments *segments, eskel_error *error)
{
	collection all = {0};
	eskel_status status = collect(header, &all, error);
	if (status == ESKEL_OK)
		status = add_segments(&all, layer_count, segments, error);
	free(all.items);
	if (status != ESKEL_OK)
		esk_segments_clear(segments);
	return status;
}
