/* A matrix of distances as JSON and as CSV. Written straight into a string: as JSON values a matrix would take ten times
 * its size. Numbers have the 15 digits of all answers (json.c). */
#include "matrix.h"

#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void append_number(esk_text *text, double value, const char *otherwise)
{
	if (isfinite(value))
		esk_text_print(text, "%.15g", value);
	else
		esk_text_print(text, "%s", otherwise);
}

/* ---------------------------------------------------------------------------------------------- JSON */

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

static void append_json_names(esk_text *text, const esk_selection *shapes)
{
	esk_text_print(text, "{\"ids\":[");
	for (size_t i = 0; i < shapes->count; i++)
		esk_text_print(text, "%s\"%s\"", i > 0 ? "," : "", shapes->shapes[i].id);
	esk_text_print(text, "],\"names\":[");
	for (size_t i = 0; i < shapes->count; i++) {
		esk_text_print(text, "%s", i > 0 ? "," : "");
		append_json_string(text, shapes->shapes[i].name);
	}
	esk_text_print(text, "]");
}

static void begin_json(esk_text *text, const esk_matrix *matrix)
{
	append_json_names(text, &matrix->rows);
	if (!matrix->square) {
		esk_text_print(text, ",\"columns\":");
		append_json_names(text, &matrix->others);
		esk_text_print(text, "}");
	}
	esk_text_print(text, ",\"distances\":[");
	for (size_t i = 0; i < matrix->rows.count && esk_matrix_columns(matrix)->count == 0; i++)
		esk_text_print(text, "%s", i > 0 ? ",[]" : "[]");
}

static void json_cells(esk_text *text, const esk_matrix *matrix, size_t number, const double *distances, size_t count)
{
	const size_t columns = esk_matrix_columns(matrix)->count;
	for (size_t i = 0; i < count; i++, number++) {
		const bool first = number % columns == 0, last = number % columns == columns - 1;
		esk_text_print(text, "%s", !first ? "," : number > 0 ? ",\n[" : "\n[");
		append_number(text, distances[i], "null");
		esk_text_print(text, "%s", last ? "]" : "");
	}
}

static void end_json(esk_text *text, const esk_matrix *matrix)
{
	(void)matrix;
	esk_text_print(text, "]}\n");
}

const esk_matrix_format esk_matrix_json = {"application/json", begin_json, json_cells, end_json, 0};

/* ---------------------------------------------------------------------------------------------- CSV */

static void append_csv_text(esk_text *text, const char *value)
{
	esk_text_print(text, "\"%s", strchr("=+-@", value[0]) && value[0] ? "'" : "");
	for (; *value; value++)
		esk_text_append(text, *value == '"' ? "\"\"" : value, *value == '"' ? 2 : 1);
	esk_text_print(text, "\"");
}

static void begin_csv_row(esk_text *text, const esk_selected *shape)
{
	esk_text_print(text, "%s,", shape->id);
	append_csv_text(text, shape->name ? shape->name : "");
}

static void begin_csv(esk_text *text, const esk_matrix *matrix)
{
	const esk_selection *columns = esk_matrix_columns(matrix);
	esk_text_print(text, "id,name");
	for (size_t i = 0; i < columns->count; i++)
		esk_text_print(text, ",%s", columns->shapes[i].id);
	esk_text_print(text, "\r\n");
	for (size_t i = 0; i < matrix->rows.count && columns->count == 0; i++) {
		begin_csv_row(text, &matrix->rows.shapes[i]);
		esk_text_print(text, "\r\n");
	}
}

static void csv_cells(esk_text *text, const esk_matrix *matrix, size_t number, const double *distances, size_t count)
{
	const size_t columns = esk_matrix_columns(matrix)->count;
	for (size_t i = 0; i < count; i++, number++) {
		if (number % columns == 0)
			begin_csv_row(text, &matrix->rows.shapes[number / columns]);
		esk_text_print(text, ",");
		append_number(text, distances[i], "");
		if (number % columns == columns - 1)
			esk_text_print(text, "\r\n");
	}
}

static void end_csv(esk_text *text, const esk_matrix *matrix)
{
	(void)text;
	(void)matrix;
}

const esk_matrix_format esk_matrix_csv = {"text/csv; charset=utf-8", begin_csv, csv_cells, end_csv, 0};
