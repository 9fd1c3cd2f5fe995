/* JSON values as this API writes them. A NULL json_t means that memory ran out: jansson passes it on to the top. */
#ifndef ESK_JSON_H
#define ESK_JSON_H

#include <jansson.h>

/* null for NaN and infinities, which JSON has not. */
json_t *esk_json_real(double value);
json_t *esk_json_reals(const double *values, size_t count);

/* One line of compact text, ended as terminals like it; numbers have 15 digits; takes value. NULL when memory ran out.
 * free() it. */
char *esk_json_text(json_t *value);

#endif
