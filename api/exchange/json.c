/* JSON values, see json.h. */
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *esk_json_real(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

json_t *esk_json_reals(const double *values, size_t count)
{
	json_t *array = json_array();
	for (size_t i = 0; array && i < count; i++)
		if (json_array_append_new(array, esk_json_real(values[i])) != 0) {
			json_decref(array);
			array = NULL;
		}
	return array;
}

char *esk_json_text(json_t *value)
{
	if (!value)
		return NULL;
	char *text = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(15));
	json_decref(value);
	if (!text)
		return NULL;
	size_t size = strlen(text);
	char *line = realloc(text, size + 2);
	if (!line) {
		free(text);
		return NULL;
	}
	memcpy(line + size, "\n", 2);
	return line;
}
