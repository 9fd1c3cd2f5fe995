/* A part of a body that is asked for: Range (RFC 9110, 14). */
#ifndef ESK_BYTE_RANGE_H
#define ESK_BYTE_RANGE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
	uint64_t first, size;
	bool partial; /* not the whole */
} esk_byte_range;

/* Of a body of so many bytes. A header that is NULL, of another unit, malformed or of several ranges asks for the whole, as
 * the RFC allows; false for a range that begins behind the end. */
bool esk_byte_range_parse(const char *header, uint64_t total, esk_byte_range *range);

#endif
