/* One sentence for a person: the offending value, the expected one. */
#ifndef ESK_ERROR_H
#define ESK_ERROR_H

#include "eskel.h"

/* Fills error (which may be NULL) and returns status, so that a refusal is one line:
 *   return esk_error_set(error, ESKEL_MALFORMED, "bitpix is %d, datatype %d needs %d", ...); */
eskel_status esk_error_set(eskel_error *error, eskel_status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
