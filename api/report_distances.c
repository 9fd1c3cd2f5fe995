/* A matrix of distances: rows by name, columns by the number of the row that they stand for. */
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

/* Exactly count cells, whatever the answer holds. */
static void add_row(esk_table *table, const json_t *answer, size_t row, size_t count)
{
	const char *name = json_string_value(json_array_get(json_object_get(answer, "names"), row));
	const char *id = json_string_value(json_array_get(json_object_get(answer, "ids"), row));
	const json_t *distances = json_array_get(json_object_get(answer, "distances"), row);
	esk_table_format(table, "%zu", row + 1);
	esk_table_cell(table, name && *name ? name : id ? id : "-");
	for (size_t c = 0; c < count; c++)
		esk_table_format(table, "%.3f", json_number_value(json_array_get(distances, c)));
}

static bool write_matrix(const json_t *answer, FILE *out, bool colour)
{
	size_t count = json_array_size(json_object_get(answer, "distances"));
	esk_column *columns = number_columns(count);
	esk_table *table = columns ? esk_table_new(columns, count + 2) : NULL;
	for (size_t r = 0; r < count; r++)
		add_row(table, answer, r, count);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	free(columns);
	return whole;
}

bool esk_report_distances(const json_t *answers, FILE *out, bool colour)
{
	size_t i;
	json_t *entry;
	bool whole = true;
	json_array_foreach (answers, i, entry)
		whole = write_matrix(json_object_get(entry, "answer"), out, colour) && whole;
	return whole;
}
