/* A gzip stream inflated as it arrives (RFC 1952): up to 1024 members, as parallel compressors write them. What follows
 * the last member must be nothing.
 *
 * A member is a header, deflated data (inflater.h) and a trailer, which tells their checksum and size. Header and
 * trailer are read here, a byte at a time, so that what is refused, and how, does not depend on the library that
 * inflates.
 */
#include "gzip.h"

#include "error.h"
#include "inflater.h"
#include "memory.h"

#include <stdlib.h>

/* The parts of a member, in their order. */
typedef enum { FIXED, EXTRA, NAME, COMMENT, HEADER_CHECKSUM, DATA, TRAILER } part;

/* The bit of the header's flags that tells of an optional part; 0: every member has the part. */
static const uint8_t flag_of[] = {[EXTRA] = 4, [NAME] = 8, [COMMENT] = 16, [HEADER_CHECKSUM] = 2, [TRAILER] = 0};

struct esk_gzip {
	esk_inflater *inflater;
	unsigned members;
	part part;       /* that the next byte belongs to */
	size_t at;       /* how many of its bytes were taken */
	uint64_t number; /* its first eight bytes, little-endian */
	uint8_t flags;
	uint32_t header_crc; /* of the header before its checksum */
	uint32_t crc, size;  /* of the inflated data */
};

enum { fixed_size = 10, extra_size_size = 2, header_checksum_size = 2, trailer_size = 8 };
enum { second_byte = 0x8b, deflate = 8, known_flags = 0x1f };

static const unsigned most_members = 1024;

eskel_status esk_gzip_new(esk_gzip **gzip)
{
	esk_gzip *g = esk_memory_zeroed_array(1, sizeof *g);
	if (!g || esk_inflater_new(&g->inflater) != ESKEL_OK) {
		free(g);
		return ESKEL_NO_MEMORY;
	}
	*gzip = g;
	return ESKEL_OK;
}

void esk_gzip_free(esk_gzip *gzip)
{
	if (!gzip)
		return;
	esk_inflater_free(gzip->inflater);
	free(gzip);
}

static eskel_status begin_member(esk_gzip *g, uint8_t first_byte, eskel_error *error)
{
	if (first_byte != ESK_GZIP_FIRST_BYTE)
		return esk_error_set(
			error, ESKEL_MALFORMED, "byte 0x%02x follows the end of the gzip data", first_byte);
	if (g->members == most_members)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the gzip data has more than %u members", most_members);
	g->members++;
	g->header_crc = 0;
	g->crc = 0;
	g->size = 0;
	esk_inflater_begin(g->inflater);
	return ESKEL_OK;
}

static eskel_status check_fixed(esk_gzip *g, uint8_t byte, eskel_error *error)
{
	switch (g->at) {
	case 0:
		return begin_member(g, byte, error);
	case 1:
		if (byte != second_byte)
			return esk_error_set(error, ESKEL_MALFORMED,
				"the gzip header begins with %02x %02x, expected %02x %02x", ESK_GZIP_FIRST_BYTE, byte,
				ESK_GZIP_FIRST_BYTE, second_byte);
		return ESKEL_OK;
	case 2:
		if (byte != deflate)
			return esk_error_set(error, ESKEL_MALFORMED,
				"the gzip header names compression method %u, expected %u", byte, deflate);
		return ESKEL_OK;
	case 3:
		g->flags = byte;
		if ((byte & ~known_flags) != 0)
			return esk_error_set(error, ESKEL_MALFORMED,
				"the gzip header has flags 0x%02x, expected none but 0x%02x", byte, known_flags);
		return ESKEL_OK;
	default: /* time, compression level and operating system */
		return ESKEL_OK;
	}
}

static eskel_status check_header(const esk_gzip *g, eskel_error *error)
{
	unsigned crc = g->header_crc & 0xffff, stored = (unsigned)g->number;
	if (crc != stored)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the gzip header is damaged: its checksum is %04x, expected %04x", crc, stored);
	return ESKEL_OK;
}

static eskel_status check_trailer(const esk_gzip *g, eskel_error *error)
{
	uint32_t crc = (uint32_t)g->number, size = (uint32_t)(g->number >> 32);
	if (crc != g->crc)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the gzip data is damaged: its checksum is %08x, expected %08x", g->crc, crc);
	if (size != g->size)
		return esk_error_set(
			error, ESKEL_MALFORMED, "the gzip data is damaged: its size is %u, expected %u", g->size, size);
	return ESKEL_OK;
}

/* Whether the part ends with this byte, which is counted in at already. */
static bool is_last(const esk_gzip *g, uint8_t byte)
{
	switch (g->part) {
	case FIXED:
		return g->at == fixed_size;
	case EXTRA:
		return g->at >= extra_size_size && g->at == extra_size_size + (size_t)(uint16_t)g->number;
	case NAME:
	case COMMENT:
		return byte == 0;
	case HEADER_CHECKSUM:
		return g->at == header_checksum_size;
	case DATA:
		return false;
	case TRAILER:
		break;
	}
	return g->at == trailer_size;
}

static void begin_part(esk_gzip *g, part next)
{
	while (flag_of[next] != 0 && (g->flags & flag_of[next]) == 0)
		next++;
	g->part = next;
	g->at = 0;
	g->number = 0;
}

static eskel_status take_byte(esk_gzip *g, uint8_t byte, eskel_error *error)
{
	eskel_status status = g->part == FIXED ? check_fixed(g, byte, error) : ESKEL_OK;
	if (status != ESKEL_OK)
		return status;
	if (g->part < HEADER_CHECKSUM)
		g->header_crc = esk_inflater_crc32(g->header_crc, &byte, 1);
	if (g->at < sizeof g->number)
		g->number |= (uint64_t)byte << 8 * g->at;
	g->at++;
	if (!is_last(g, byte))
		return ESKEL_OK;
	if (g->part == HEADER_CHECKSUM)
		status = check_header(g, error);
	if (g->part == TRAILER)
		status = check_trailer(g, error);
	begin_part(g, g->part == TRAILER ? FIXED : g->part + 1);
	return status;
}

static eskel_status take_data(esk_gzip *g, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error)
{
	bool ended;
	eskel_status status = esk_inflater_run(g->inflater, in, in_size, out, out_size, out_used, &ended);
	g->crc = esk_inflater_crc32(g->crc, out, *out_used);
	g->size += (uint32_t)*out_used;
	if (status == ESKEL_NO_MEMORY)
		return esk_error_set(error, status, "memory ran out while inflating");
	if (status != ESKEL_OK)
		return esk_error_set(error, status, "the gzip data is damaged: it cannot be inflated");
	if (ended)
		begin_part(g, TRAILER);
	return ESKEL_OK;
}

eskel_status esk_gzip_inflate(esk_gzip *g, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error)
{
	*out_used = 0;
	if (g->part == DATA) /* also without input: there may be output that had no room before */
		return take_data(g, in, in_size, out, out_size, out_used, error);
	if (*in_size == 0)
		return ESKEL_OK;
	(*in_size)--;
	return take_byte(g, *(*in)++, error);
}

bool esk_gzip_is_complete(const esk_gzip *gzip)
{
	return gzip->members > 0 && gzip->part == FIXED && gzip->at == 0;
}

size_t eskel_gzip_begin(const uint8_t *bytes, size_t size, uint8_t *begin, size_t most)
{
	esk_gzip *gzip = NULL;
	size_t begun = 0;
	if (esk_gzip_new(&gzip) != ESKEL_OK)
		return 0;
	eskel_status status = ESKEL_OK;
	while (status == ESKEL_OK && size > 0 && begun < most) {
		size_t used = 0;
		status = esk_gzip_inflate(gzip, &bytes, &size, begin + begun, most - begun, &used, NULL);
		begun += used;
	}
	esk_gzip_free(gzip);
	return begun;
}
