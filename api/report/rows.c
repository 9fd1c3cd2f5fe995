/* Shapes as rows of text, see eskel_rows.h. */
#include "eskel_rows.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct eskel_rows {
	json_t *answer, *shapes; /* shapes: the answer's */
};

/* index: of an array's element; -1: the member itself. */
static const struct {
	const char *name, *member;
	int index;
} columns[] = {
	{"id", "id", -1},
	{"label", "label", -1},
	{"name", "name", -1},
	{"class", "class", -1},
	{"side", "side", -1},
	{"subject", "subject", -1},
	{"age", "age", -1},
	{"sex", "sex", -1},
	{"levels", "levels", -1},
	{"voxels", "voxels", -1},
	{"volume_mm3", "volume_mm3", -1},
	{"centre_x_mm", "centre_mm", 0},
	{"centre_y_mm", "centre_mm", 1},
	{"centre_z_mm", "centre_mm", 2},
	{"sha256", "sha256", -1},
	{"created", "created", -1},
	{"warnings", "warnings", -1},
};

enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

eskel_status eskel_rows_read(const char *json, size_t size, eskel_rows **rows)
{
	json_t *answer = json_loadb(json, size, 0, NULL), *shapes = json_object_get(answer, "shapes");
	eskel_rows *read = json_is_array(shapes) ? calloc(1, sizeof *read) : NULL;
	if (!read) {
		eskel_status status = json_is_array(shapes) ? ESKEL_NO_MEMORY : ESKEL_MALFORMED;
		json_decref(answer);
		return status;
	}
	*read = (eskel_rows){answer, shapes};
	*rows = read;
	return ESKEL_OK;
}

void eskel_rows_free(eskel_rows *rows)
{
	if (!rows)
		return;
	json_decref(rows->answer);
	free(rows);
}

size_t eskel_rows_count(const eskel_rows *rows)
{
	return json_array_size(rows->shapes);
}

const char *eskel_rows_cursor(const eskel_rows *rows)
{
	return json_string_value(json_object_get(rows->answer, "next"));
}

const char *eskel_rows_column(size_t number)
{
	return number < COLUMN_COUNT ? columns[number].name : NULL;
}

static const json_t *value_of(const json_t *shape, const char *column)
{
	if (strncmp(column, "attr.", 5) == 0)
		return json_object_get(json_object_get(shape, "attributes"), column + 5);
	for (size_t c = 0; c < COLUMN_COUNT; c++) {
		const json_t *member = json_object_get(shape, columns[c].member);
		if (strcmp(columns[c].name, column) == 0)
			return columns[c].index < 0 ? member : json_array_get(member, (size_t)columns[c].index);
	}
	return NULL;
}

/* An age is a query parameter too, which takes neither an exponent nor more than 18 digits. */
static void write_real(double value, FILE *out)
{
	char text[32];
	snprintf(text, sizeof text, "%.15g", value);
	if (strchr(text, 'e') && value > 0 && value < 1)
		fprintf(out, "%.18f", value);
	else
		fputs(text, out);
}

/* Of warnings the codes, spaces between. */
static void write_value(const json_t *value, FILE *out)
{
	size_t i;
	const json_t *warning;
	if (json_is_string(value))
		fputs(json_string_value(value), out);
	else if (json_is_integer(value))
		fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
	else if (json_is_real(value))
		write_real(json_real_value(value), out);
	json_array_foreach (value, i, warning) {
		const char *code = json_string_value(json_object_get(warning, "code"));
		fprintf(out, "%s%s", i > 0 ? " " : "", code ? code : "");
	}
}

char *eskel_rows_cell(const eskel_rows *rows, size_t row, const char *column)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	if (out)
		write_value(value_of(json_array_get(rows->shapes, row), column), out);
	if (out && !fclose(out))
		return text;
	free(text);
	return NULL;
}

const char *eskel_rows_attribute(const eskel_rows *rows, size_t row, size_t number)
{
	json_t *attributes = json_object_get(json_array_get(rows->shapes, row), "attributes");
	void *at = json_object_iter(attributes);
	for (; at && number > 0; number--)
		at = json_object_iter_next(attributes, at);
	return at ? json_object_iter_key(at) : NULL;
}
