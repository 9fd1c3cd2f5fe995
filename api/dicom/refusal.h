/* Why DICOM is refused. */
#ifndef ESK_REFUSAL_H
#define ESK_REFUSAL_H

#include "eskel.h"

/* Sets the error, if there is one, and returns the status. */
eskel_status esk_refuse(eskel_error *error, eskel_status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
