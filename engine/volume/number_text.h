/* Numbers written as text, read as they arrive. */
#ifndef ESK_NUMBER_TEXT_H
#define ESK_NUMBER_TEXT_H

#include "decompressor.h"

/* All-zero at the start. */
typedef struct {
	char broken
		[48]; /* of the number that a piece broke off: longer than any double needs, and with a terminating 0 */
	size_t size;
	uint64_t taken; /* bytes */
} esk_number_text;

/* Reads all numbers, between blanks, and hands them on as doubles. ESKEL_MALFORMED for a word that is no number, after the
 * numbers before it; ESKEL_TOO_LARGE past 2^28 bytes. */
eskel_status esk_number_text_feed(esk_number_text *text, const uint8_t *bytes, size_t size,
	esk_decompressor_taker *take, void *taker, eskel_error *error);
/* The text ends here. */
eskel_status esk_number_text_finish(
	esk_number_text *text, esk_decompressor_taker *take, void *taker, eskel_error *error);

#endif
