/* The push decoder of mesh files, see solid_reader.h.
 *
 * What a file is shows in its first 84 bytes. Binary STL has no magic, and its 80 bytes of header may be any text, even
 * "solid", the first word of an ASCII one. The number of triangles that follows decides: a number that is allowed has a last
 * byte of 0 or 1, and no text has that.
 *
 * As in volume.c, each format sees every byte before a fault and none after it, however the file was cut.
 */
#include "error.h"
#include "memory.h"
#include "solid_format.h"

#include <stdlib.h>
#include <string.h>

/* Longer than any face, and any comment. */
enum { longest_line = 1 << 16 };

/* Bytes of text, or binary values: what a few kilobytes can unfold to is refused in seconds. A PLY of the most triangles, with
 * normals and colours, has half as many values. A line takes the time of shortest_line bytes, however few it has. */
static const uint64_t most_work = (uint64_t)1 << 28;
enum { shortest_line = 32 };

static bool is_text(uint8_t byte)
{
	return byte >= ' ' ? byte != 0x7f : byte == '\t' || byte == '\n' || byte == '\r';
}

bool esk_solid_may_begin(const uint8_t bytes[4])
{
	for (int i = 0; i < 4; i++)
		if (!is_text(bytes[i]) && bytes[i] != 0)
			return false;
	return true;
}

static bool begins_with_word(const uint8_t *bytes, size_t size, const char *word)
{
	size_t length = strlen(word);
	return size > length && memcmp(bytes, word, length) == 0 && bytes[length] <= ' ';
}

/* OBJ comes last: its reader finds out itself. */
static eskel_status begin_text(esk_solid_reader *r, const uint8_t *bytes, size_t size, eskel_error *error)
{
	bool is_stl = begins_with_word(bytes, size, "solid"), is_ply = begins_with_word(bytes, size, "ply");
	r->format = is_stl ? "STL" : is_ply ? "PLY" : NULL;
	r->take_line = is_stl ? esk_stl_take_line : is_ply ? esk_ply_take_line : esk_obj_take_line;
	r->item_size = 0;
	return esk_solid_reader_feed(r, bytes, size, error);
}

static eskel_status begin(esk_solid_reader *r, const uint8_t *header, eskel_error *error)
{
	uint8_t bytes[esk_stl_header_size]; /* header is overwritten by what follows */
	memcpy(bytes, header, sizeof bytes);
	eskel_status status = esk_stl_begin_binary(r, bytes, error);
	return status == ESKEL_NOT_VOLUME ? begin_text(r, bytes, sizeof bytes, error) : status;
}

eskel_status esk_solid_reader_new(esk_solid_reader **reader)
{
	esk_solid_reader *r = esk_memory_zeroed_array(1, sizeof *r);
	if (!r)
		return ESKEL_NO_MEMORY;
	r->item_size = esk_stl_header_size;
	r->take_item = begin;
	r->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (r->locale == (locale_t)0) {
		free(r);
		return ESKEL_NO_MEMORY;
	}
	*reader = r;
	return ESKEL_OK;
}

void esk_solid_reader_free(esk_solid_reader *reader)
{
	if (!reader)
		return;
	esk_solid_clear(&reader->solid);
	free(reader->pending);
	freelocale(reader->locale);
	free(reader);
}

static eskel_status keep(esk_solid_reader *r, const uint8_t *bytes, size_t size, eskel_error *error)
{
	void *pending = r->pending;
	if (!esk_memory_reserve(&pending, &r->pending_capacity, r->pending_size + size + 1, 1))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out in the mesh");
	r->pending = pending;
	memcpy(r->pending + r->pending_size, bytes, size);
	r->pending_size += size;
	return ESKEL_OK;
}

static eskel_status count_work(esk_solid_reader *r, uint64_t amount, eskel_error *error)
{
	r->work += amount;
	if (r->work <= most_work)
		return ESKEL_OK;
	return r->format ? esk_error_set(error, ESKEL_TOO_LARGE,
				   "the mesh takes more than %llu bytes of text or binary values",
				   (unsigned long long)most_work)
			 : ESKEL_NOT_VOLUME;
}

/* An item that lies whole in the piece is taken where it is. */
static eskel_status gather_item(esk_solid_reader *r, const uint8_t **bytes, size_t *size, eskel_error *error)
{
	const uint8_t *item = *bytes;
	size_t missing = r->item_size - r->pending_size, taken = *size < missing ? *size : missing;
	bool whole = taken == r->item_size;
	*bytes += taken;
	*size -= taken;
	eskel_status status = whole ? ESKEL_OK : keep(r, item, taken, error);
	if (status != ESKEL_OK || (!whole && r->pending_size < r->item_size))
		return status;
	r->pending_size = 0;
	status = count_work(r, 1, error);
	return status == ESKEL_OK ? r->take_item(r, whole ? item : r->pending, error) : status;
}

/* The pending bytes, which have room for one more. */
static eskel_status end_line(esk_solid_reader *r, eskel_error *error)
{
	char *line = (char *)r->pending;
	size_t size = r->pending_size;
	r->line++;
	r->pending_size = 0;
	eskel_status status = count_work(r, size < shortest_line ? shortest_line : size, error);
	if (status != ESKEL_OK)
		return status;
	if (memchr(line, 0, size))
		return r->format ? esk_error_set(error, ESKEL_MALFORMED, "line %llu has a zero byte, expected text",
					   (unsigned long long)r->line)
				 : ESKEL_NOT_VOLUME;
	line[size] = 0;
	line[strcspn(line, "\r")] = 0;
	return r->take_line(r, line, error);
}

static eskel_status gather_line(esk_solid_reader *r, const uint8_t **bytes, size_t *size, eskel_error *error)
{
	const uint8_t *end = memchr(*bytes, '\n', *size), *begin = *bytes;
	size_t length = end ? (size_t)(end - begin) : *size;
	size_t room = longest_line - r->pending_size;
	if (length > room)
		return r->format ? esk_error_set(error, ESKEL_MALFORMED, "line %llu is longer than %d bytes",
					   (unsigned long long)r->line + 1, longest_line)
				 : ESKEL_NOT_VOLUME;
	eskel_status status = keep(r, begin, length, error);
	*bytes += length + (end != NULL);
	*size -= length + (end != NULL);
	return status == ESKEL_OK && end ? end_line(r, error) : status;
}

eskel_status esk_solid_reader_feed(esk_solid_reader *reader, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	while (size > 0 && status == ESKEL_OK)
		status = reader->item_size > 0 ? gather_item(reader, &bytes, &size, error)
					       : gather_line(reader, &bytes, &size, error);
	return status;
}

/* A file of less than 84 bytes, and a last line without its end. */
static eskel_status take_rest(esk_solid_reader *r, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	if (r->take_item == begin && r->item_size > 0) {
		uint8_t bytes[esk_stl_header_size];
		size_t size = r->pending_size;
		memcpy(bytes, r->pending, size);
		r->pending_size = 0;
		status = begin_text(r, bytes, size, error);
	}
	if (status == ESKEL_OK && r->item_size == 0 && r->pending_size > 0)
		status = end_line(r, error);
	return status;
}

eskel_status esk_solid_reader_finish(esk_solid_reader *reader, const esk_solid **solid, eskel_error *error)
{
	eskel_status status = take_rest(reader, error);
	if (status != ESKEL_OK)
		return status;
	if (!reader->format)
		return ESKEL_NOT_VOLUME;
	if (!reader->complete)
		return esk_error_set(
			error, ESKEL_TRUNCATED, "the file ends before the end of its %s mesh", reader->format);
	status = esk_solid_close(&reader->solid, reader->space == ESK_SPACE_LPS, error);
	if (status == ESKEL_OK)
		*solid = &reader->solid;
	return status;
}

const char *esk_solid_reader_format(const esk_solid_reader *reader)
{
	return reader->format;
}

esk_solid_space esk_solid_reader_space(const esk_solid_reader *reader)
{
	return reader->space;
}
