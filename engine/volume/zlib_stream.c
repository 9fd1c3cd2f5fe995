/* A zlib stream inflated as it arrives (RFC 1950): two bytes of header, deflated data (inflater.h), and their Adler-32.
 * What follows it must be nothing.
 *
 * As in gzip.c, header and trailer are read here, so that what is refused, and how, does not depend on the library that
 * inflates.
 */
#include "zlib_stream.h"

#include "error.h"
#include "inflater.h"
#include "memory.h"

#include <stdlib.h>

typedef enum { HEADER, DATA, TRAILER, AFTER } part;

struct esk_zlib_stream {
	esk_inflater *inflater;
	part part;       /* that the next byte belongs to */
	size_t at;       /* how many of its bytes were taken */
	uint32_t number; /* they, big-endian */
	uint32_t adler;  /* of the inflated data */
};

enum { header_size = 2, trailer_size = 4 };

eskel_status esk_zlib_stream_new(esk_zlib_stream **stream)
{
	esk_zlib_stream *s = esk_memory_zeroed_array(1, sizeof *s);
	if (!s || esk_inflater_new(&s->inflater) != ESKEL_OK) {
		free(s);
		return ESKEL_NO_MEMORY;
	}
	esk_inflater_begin(s->inflater);
	s->adler = 1;
	*stream = s;
	return ESKEL_OK;
}

void esk_zlib_stream_free(esk_zlib_stream *stream)
{
	if (!stream)
		return;
	esk_inflater_free(stream->inflater);
	free(stream);
}

static void begin_part(esk_zlib_stream *s, part next)
{
	s->part = next;
	s->at = 0;
	s->number = 0;
}

/* The first byte tells the method, 8, and the window's size, at most 7; the second has a bit for a preset dictionary,
 * which nobody could know here, and makes both together a multiple of 31. */
static eskel_status check_header(const esk_zlib_stream *s, eskel_error *error)
{
	unsigned first = s->number >> 8, second = s->number & 0xff;
	const unsigned method = 8, largest_window = 7, dictionary = 0x20;
	if ((first & 15) != method || first >> 4 > largest_window || s->number % 31 != 0 || (second & dictionary) != 0)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the compressed data begins with %02x %02x, expected the header of a zlib stream, such as 78 "
			"9c",
			first, second);
	return ESKEL_OK;
}

static eskel_status check_trailer(const esk_zlib_stream *s, eskel_error *error)
{
	if (s->number != s->adler)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the zlib data is damaged: its checksum is %08x, expected %08x", s->adler, s->number);
	return ESKEL_OK;
}

static eskel_status take_byte(esk_zlib_stream *s, uint8_t byte, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	if (s->part == AFTER)
		return esk_error_set(error, ESKEL_MALFORMED, "byte 0x%02x follows the end of the zlib data", byte);
	s->number = s->number << 8 | byte;
	s->at++;
	if (s->part == HEADER && s->at == header_size) {
		status = check_header(s, error);
		begin_part(s, DATA);
	} else if (s->part == TRAILER && s->at == trailer_size) {
		status = check_trailer(s, error);
		begin_part(s, AFTER);
	}
	return status;
}

static eskel_status take_data(esk_zlib_stream *s, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error)
{
	bool ended;
	eskel_status status = esk_inflater_run(s->inflater, in, in_size, out, out_size, out_used, &ended);
	s->adler = esk_inflater_adler32(s->adler, out, *out_used);
	if (status == ESKEL_NO_MEMORY)
		return esk_error_set(error, status, "memory ran out while inflating");
	if (status != ESKEL_OK)
		return esk_error_set(error, status, "the zlib data is damaged: it cannot be inflated");
	if (ended)
		begin_part(s, TRAILER);
	return ESKEL_OK;
}

eskel_status esk_zlib_stream_inflate(esk_zlib_stream *s, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, eskel_error *error)
{
	*out_used = 0;
	if (s->part == DATA) /* also without input: there may be output that had no room before */
		return take_data(s, in, in_size, out, out_size, out_used, error);
	if (*in_size == 0)
		return ESKEL_OK;
	(*in_size)--;
	return take_byte(s, *(*in)++, error);
}

bool esk_zlib_stream_is_complete(const esk_zlib_stream *stream)
{
	return stream->part == AFTER;
}
