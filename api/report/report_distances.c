/* A matrix of distances: rows by name, columns by the number of the row that they stand for, or else in a list below. */
#include "report.h"

#include <stdlib.h>

/* Titles "1", "2" ... for count columns after the row's number and name; free() the columns, which hold the titles. */
static esk_column *number_columns(size_t count)
{
	enum { title_size = 21 };
	esk_column *columns = calloc(count + 2, sizeof *columns + title_size);
	if (!columns)
		return NULL;
	char *titles = (char *)(columns + count + 2);
	columns[0] = (esk_column){"#", true};
	columns[1] = (esk_column){"name", false};
	for (size_t c = 0; c < count; c++) {
		snprintf(titles, title_size, "%zu", c + 1);
		columns[c + 2] = (esk_column){titles, true};
		titles += title_size;
	}
	return columns;
}

/* Of the rows in the answer, or of the columns in its member of that name. */
static const char *name_of(const json_t *names, size_t index)
{
	const char *name = json_string_value(json_array_get(json_object_get(names, "names"), index));
	const char *id = json_string_value(json_array_get(json_object_get(names, "ids"), index));
	return name && *name ? name : id ? id : "-";
}

/* Exactly count cells, whatever the answer holds. */
static void add_row(esk_table *table, const json_t *answer, size_t row, size_t count)
{
	const json_t *distances = json_array_get(json_object_get(answer, "distances"), row);
	esk_table_format(table, "%zu", row + 1);
	esk_table_cell(table, name_of(answer, row));
	for (size_t c = 0; c < count; c++)
		esk_table_format(table, "%.3f", json_number_value(json_array_get(distances, c)));
}

/* What the numbers above the columns stand for, when they are not the rows. */
static bool write_columns(const json_t *names, size_t count, FILE *out, bool colour)
{
	esk_column columns[] = {{"#", true}, {"column", false}};
	esk_table *table = esk_table_new(columns, 2);
	for (size_t c = 0; c < count; c++) {
		esk_table_format(table, "%zu", c + 1);
		esk_table_cell(table, name_of(names, c));
	}
	fputc('\n', out);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

static bool write_matrix(const json_t *answer, FILE *out, bool colour)
{
	const json_t *names = json_object_get(answer, "columns");
	size_t rows = json_array_size(json_object_get(answer, "distances"));
	size_t count = names ? json_array_size(json_object_get(names, "ids")) : rows;
	esk_column *columns = number_columns(count);
	esk_table *table = columns ? esk_table_new(columns, count + 2) : NULL;
	for (size_t r = 0; r < rows; r++)
		add_row(table, answer, r, count);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	free(columns);
	if (names && rows > 0)
		whole = write_columns(names, count, out, colour) && whole;
	return whole;
}

bool esk_report_distances(const json_t *answers, FILE *out, bool colour)
{
	return esk_report_each(write_matrix, answers, out, colour);
}
