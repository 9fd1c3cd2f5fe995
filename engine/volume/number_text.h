/* Numbers written as text, read as they arrive. */
#ifndef ESK_NUMBER_TEXT_H
#define ESK_NUMBER_TEXT_H

#include "eskel.h"

/* The first characters of a number that a piece broke off; all-zero at the start. */
typedef struct {
	char broken[48]; /* longer than any double needs, and with a terminating 0 */
	size_t size;
} esk_number_text;

/* Reads at most most numbers, between blanks, from the *size bytes at *bytes, which it moves past what it took. All is
 * taken once *count < most. ESKEL_MALFORMED for a word that is no number, after the *count before it. */
eskel_status esk_number_text_read(esk_number_text *text, const uint8_t **bytes, size_t *size, double *numbers,
	size_t most, size_t *count, eskel_error *error);

#endif
