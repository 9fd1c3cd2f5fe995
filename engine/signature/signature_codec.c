/* Signatures as bytes, little-endian:
 *
 *   offset 0   u8    version, 1
 *   offset 1   u8    level count, 1 to 64
 *   offset 2   f64   volume, mm^3
 *   offset 10  f32   five numbers for each class, ordered as in eskel_signature
 *
 * A signature's numbers are floats, so this loses nothing. The size follows from the level count. */
#include "bytes.h"
#include "error.h"
#include "memory.h"
#include "signature.h"

#include <stdlib.h>

enum { version = 1, header_size = 10, row_size = 4 * ESKEL_SIGNATURE_NUMBERS };

static size_t encoded_size(uint32_t level_count)
{
	return header_size + row_size * ESKEL_NODES(level_count);
}

eskel_status eskel_signature_encode(const eskel_signature *signature, uint8_t **bytes, size_t *size)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status != ESKEL_OK)
		return status;
	size_t needed = encoded_size(signature->level_count);
	uint8_t *made = malloc(needed);
	if (!made)
		return ESKEL_NO_MEMORY;
	made[0] = version;
	made[1] = (uint8_t)signature->level_count;
	esk_bytes_put_f64(made + 2, signature->volume);
	uint8_t *row = made + header_size;
	for (size_t n = 0; n < ESKEL_NODES(signature->level_count); n++, row += row_size)
		for (size_t i = 0; i < ESKEL_SIGNATURE_NUMBERS; i++)
			esk_bytes_put_f32(row + 4 * i, (float)signature->rows[n][i]);
	*bytes = made;
	*size = needed;
	return ESKEL_OK;
}

static eskel_status check_header(const uint8_t *bytes, size_t size, eskel_error *error)
{
	if (size < header_size)
		return esk_error_set(error, ESKEL_TRUNCATED, "a signature is %zu bytes, expected at least %d", size,
			(int)header_size);
	if (bytes[0] != version)
		return esk_error_set(
			error, ESKEL_MALFORMED, "a signature has version %d, expected %d", bytes[0], (int)version);
	if (bytes[1] < 1 || bytes[1] > ESKEL_LEVELS_MAX)
		return esk_error_set(error, ESKEL_MALFORMED, "a signature has %d levels, expected 1 to %d", bytes[1],
			ESKEL_LEVELS_MAX);
	if (size != encoded_size(bytes[1]))
		return esk_error_set(error, size < encoded_size(bytes[1]) ? ESKEL_TRUNCATED : ESKEL_MALFORMED,
			"a signature of %d levels is %zu bytes, expected %zu", bytes[1], size, encoded_size(bytes[1]));
	return ESKEL_OK;
}

eskel_status eskel_signature_decode(const uint8_t *bytes, size_t size, eskel_signature **signature, eskel_error *error)
{
	eskel_status status = check_header(bytes, size, error);
	if (status != ESKEL_OK)
		return status;
	eskel_signature *made = esk_signature_alloc(bytes[1]);
	if (!made)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a signature of %d levels", bytes[1]);
	made->volume = esk_bytes_get_f64(bytes + 2);
	const uint8_t *row = bytes + header_size;
	for (size_t n = 0; n < ESKEL_NODES(made->level_count); n++, row += row_size)
		for (size_t i = 0; i < ESKEL_SIGNATURE_NUMBERS; i++)
			made->rows[n][i] = (double)esk_bytes_get_f32(row + 4 * i);
	if (esk_signature_check(made, error) != ESKEL_OK) {
		eskel_signature_free(made);
		if (error)
			error->status = ESKEL_MALFORMED;
		return ESKEL_MALFORMED;
	}
	*signature = made;
	return ESKEL_OK;
}
