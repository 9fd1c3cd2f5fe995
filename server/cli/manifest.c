#include "manifest.h"

#include "label_names.h"
#include "manifest_column.h"

#include <stdlib.h>
#include <string.h>

bool esk_manifest_is_one(const char *path)
{
	const char *fields[ESK_CSV_MOST_COLUMNS];
	size_t count = 0;
	bool found = false;
	esk_csv csv;
	if (esk_csv_open(path, &csv))
		return false;
	if (!esk_csv_read_line(&csv, fields, &count))
		for (size_t c = 0; c < count; c++)
			found |= !strcmp(fields[c], "path");
	esk_csv_close(&csv);
	return found;
}

static esk_outcome check_column(const esk_manifest *manifest, size_t column)
{
	const char *name = manifest->columns[column];
	esk_column_kind kind;
	if (!esk_manifest_column_find(name, &kind))
		return esk_complain(ESK_MISUSED,
			"%s, line 1, column %zu: there is no column \"%s\", expected path, label, name, class, side, "
			"subject, age, sex, levels, weights or attr.KEY",
			manifest->csv.path, column + 1, name);
	for (size_t c = 0; c < column; c++)
		if (!strcmp(manifest->columns[c], name))
			return esk_complain(ESK_MISUSED, "%s, line 1, column %zu: %s is a column already",
				manifest->csv.path, column + 1, name);
	return ESK_DONE;
}

static esk_outcome read_header(esk_manifest *manifest)
{
	const char *fields[ESK_CSV_MOST_COLUMNS];
	bool has_path = false;
	esk_outcome outcome = esk_csv_read_line(&manifest->csv, fields, &manifest->column_count);
	if (outcome)
		return outcome;
	manifest->columns = calloc(manifest->column_count + 1, sizeof *manifest->columns);
	if (!manifest->columns)
		return esk_complain(ESK_REFUSED, "memory ran out");
	for (size_t c = 0; c < manifest->column_count && !outcome; c++) {
		manifest->columns[c] = fields[c];
		has_path |= !strcmp(fields[c], "path");
		outcome = check_column(manifest, c);
	}
	if (!outcome && !has_path)
		outcome = esk_complain(ESK_MISUSED, "%s, line 1: there is no column called path", manifest->csv.path);
	return outcome;
}

/* A relative path that stays below its folder. */
static bool stays_inside(const char *path)
{
	if (!*path || *path == '/')
		return false;
	for (size_t size; *path; path += size + (path[size] == '/')) {
		size = strcspn(path, "/");
		if (size == 2 && !strncmp(path, "..", 2))
			return false;
	}
	return true;
}

static char *shared_query(const esk_manifest *manifest, const esk_manifest_row *row)
{
	char *query = NULL;
	size_t size;
	FILE *out = open_memstream(&query, &size);
	for (size_t c = 0; out && c < manifest->column_count; c++) {
		const esk_column_kind kind = esk_manifest_column_kind(manifest->columns[c]);
		if (*row->cells[c] && (kind == ESK_COLUMN_OF_ALL || kind == ESK_COLUMN_OF_FILE ||
					      (kind == ESK_COLUMN_OF_LABEL && row->label == 0)))
			esk_manifest_write_parameter("", manifest->columns[c], row->cells[c], out);
	}
	return esk_session_close_text(out, &query);
}

static esk_outcome fill_row(const esk_manifest *manifest, const char *const fields[], esk_manifest_row *row)
{
	const esk_csv *csv = &manifest->csv;
	for (size_t c = 0; c < manifest->column_count; c++) {
		const esk_column_kind kind = esk_manifest_column_kind(manifest->columns[c]);
		row->cells[c] = fields[c];
		if (kind == ESK_COLUMN_PATH && !stays_inside(row->path = fields[c]))
			return esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu (path): \"%s\" is not a path below the folder", csv->path,
				csv->line, c + 1, fields[c]);
		if (kind == ESK_COLUMN_LABEL && *fields[c] && !esk_label_parse(fields[c], &row->label))
			return esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu (label): \"%s\" is not a whole number other than 0", csv->path,
				csv->line, c + 1, fields[c]);
	}
	row->shared = shared_query(manifest, row);
	return row->shared ? ESK_DONE : ESK_REFUSED;
}

static esk_outcome add_row(esk_manifest *manifest, const char *const fields[])
{
	/* Grows at each power of two. */
	if ((manifest->count & (manifest->count - 1)) == 0) {
		const size_t capacity = manifest->count > 0 ? 2 * manifest->count : 1;
		esk_manifest_row *rows = reallocarray(manifest->rows, capacity, sizeof *rows);
		if (!rows)
			return esk_complain(ESK_REFUSED, "memory ran out");
		manifest->rows = rows;
	}
	esk_manifest_row *row = &manifest->rows[manifest->count++];
	*row = (esk_manifest_row){.line = manifest->csv.line};
	row->cells = calloc(manifest->column_count, sizeof *row->cells);
	return row->cells ? fill_row(manifest, fields, row) : esk_complain(ESK_REFUSED, "memory ran out");
}

static esk_outcome read_rows(esk_manifest *manifest)
{
	esk_csv *csv = &manifest->csv;
	const char *fields[ESK_CSV_MOST_COLUMNS];
	size_t count;
	esk_outcome outcome = read_header(manifest);
	while (!outcome && csv->next < csv->end) {
		outcome = esk_csv_read_line(csv, fields, &count);
		if (outcome || count == 0)
			continue;
		if (count != manifest->column_count)
			outcome = esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu: %zu fields, expected %zu as in the header", csv->path,
				csv->line, count, count, manifest->column_count);
		else
			outcome = add_row(manifest, fields);
	}
	return outcome;
}

static int by_path_and_label(const void *a, const void *b)
{
	const esk_manifest_row *left = *(const esk_manifest_row *const *)a,
			       *right = *(const esk_manifest_row *const *)b;
	const int order = strcmp(left->path, right->path);
	if (order)
		return order;
	if (left->label != right->label)
		return left->label < right->label ? -1 : 1;
	return left->line < right->line ? -1 : left->line > right->line;
}

/* A row without a label is about all of them. */
static esk_outcome check_neighbours(const esk_manifest *manifest, const esk_manifest_row *a, const esk_manifest_row *b)
{
	if (strcmp(a->path, b->path) || (a->label != b->label && a->label != 0 && b->label != 0))
		return ESK_DONE;
	const unsigned first = a->line < b->line ? a->line : b->line, second = a->line < b->line ? b->line : a->line;
	return esk_complain(ESK_MISUSED,
		"%s, line %u: %s stands in line %u already, expected each label once, or no label", manifest->csv.path,
		second, a->path, first);
}

static esk_outcome check_twice(const esk_manifest *manifest)
{
	const esk_manifest_row **sorted = calloc(manifest->count + 1, sizeof *sorted);
	esk_outcome outcome = ESK_DONE;
	if (!sorted)
		return esk_complain(ESK_REFUSED, "memory ran out");
	for (size_t i = 0; i < manifest->count; i++)
		sorted[i] = &manifest->rows[i];
	qsort(sorted, manifest->count, sizeof *sorted, by_path_and_label);
	const esk_manifest_row *whole = NULL; /* the last row without a label */
	for (size_t i = 1; i < manifest->count && !outcome; i++) {
		if (sorted[i - 1]->label == 0)
			whole = sorted[i - 1];
		outcome = check_neighbours(manifest, sorted[i - 1], sorted[i]);
		if (!outcome && whole)
			outcome = check_neighbours(manifest, whole, sorted[i]);
	}
	free(sorted);
	return outcome;
}

esk_outcome esk_manifest_read(const char *path, esk_manifest *manifest)
{
	esk_manifest read = {0};
	esk_outcome outcome = esk_csv_open(path, &read.csv);
	if (!outcome)
		outcome = read_rows(&read);
	if (!outcome)
		outcome = check_twice(&read);
	if (outcome)
		esk_manifest_clear(&read);
	else
		*manifest = read;
	return outcome;
}

void esk_manifest_clear(esk_manifest *manifest)
{
	for (size_t i = 0; i < manifest->count; i++) {
		free(manifest->rows[i].cells);
		free(manifest->rows[i].shared);
	}
	free(manifest->rows);
	free(manifest->columns);
	esk_csv_close(&manifest->csv);
	*manifest = (esk_manifest){0};
}
