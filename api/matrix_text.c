/* A matrix of distances as text, see matrix_text.h. Numbers have the 15 digits of all answers (json.c). */
#include "matrix_text.h"

#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void append_json_string(esk_text *text, const char *string)
{
	json_t *value = string ? json_string(string) : json_null();
	char *quoted = json_dumps(value, JSON_ENCODE_ANY);
	json_decref(value);
	if (quoted)
		esk_text_append(text, quoted, strlen(quoted));
	else
		text->failed = true;
	free(quoted);
}

static void append_number(esk_text *text, double value, const char *otherwise)
{
	if (isfinite(value))
		esk_text_print(text, "%.15g", value);
	else
		esk_text_print(text, "%s", otherwise);
}

void esk_matrix_json(esk_text *text, const esk_matrix *matrix)
{
	esk_text_print(text, "{\"ids\":[");
	for (size_t i = 0; i < matrix->count; i++)
		esk_text_print(text, "%s\"%s\"", i > 0 ? "," : "", matrix->shapes[i].id);
	esk_text_print(text, "],\"names\":[");
	for (size_t i = 0; i < matrix->count; i++) {
		esk_text_print(text, "%s", i > 0 ? "," : "");
		append_json_string(text, matrix->shapes[i].description.name);
	}
	esk_text_print(text, "],\"distances\":[");
	for (size_t i = 0; i < matrix->count; i++) {
		for (size_t j = 0; j < matrix->count; j++) {
			esk_text_print(text, "%s", j > 0 ? "," : i > 0 ? ",[" : "[");
			append_number(text, matrix->distances[i * matrix->count + j], "null");
		}
		esk_text_print(text, "]");
	}
	esk_text_print(text, "]}\n");
}

static void append_csv_text(esk_text *text, const char *value)
{
	esk_text_print(text, "\"%s", strchr("=+-@", value[0]) && value[0] ? "'" : "");
	for (; *value; value++)
		esk_text_append(text, *value == '"' ? "\"\"" : value, *value == '"' ? 2 : 1);
	esk_text_print(text, "\"");
}

void esk_matrix_csv(esk_text *text, const esk_matrix *matrix)
{
	esk_text_print(text, "id,name");
	for (size_t i = 0; i < matrix->count; i++)
		esk_text_print(text, ",%s", matrix->shapes[i].id);
	esk_text_print(text, "\r\n");
	for (size_t i = 0; i < matrix->count; i++) {
		const char *name = matrix->shapes[i].description.name;
		esk_text_print(text, "%s,", matrix->shapes[i].id);
		append_csv_text(text, name ? name : "");
		for (size_t j = 0; j < matrix->count; j++) {
			esk_text_print(text, ",");
			append_number(text, matrix->distances[i * matrix->count + j], "");
		}
		esk_text_print(text, "\r\n");
	}
}
