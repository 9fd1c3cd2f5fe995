#include "manifest.h"

#include "arguments.h"
#include "label_names.h"

#include "eskel_rows.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef enum { PATH, LABEL, OF_LABEL, OF_ALL, OF_FILE, TOLD, NOT_TOLD } column_kind;

/* The rest of an export's columns (eskel_rows.h) is TOLD. */
static const struct {
	const char *name;
	column_kind kind;
} kinds[] = {
	{"path", PATH},
	{"label", LABEL},
	{"name", OF_LABEL},
	{"class", OF_LABEL},
	{"side", OF_LABEL},
	{"subject", OF_ALL},
	{"age", OF_ALL},
	{"sex", OF_ALL},
	{"levels", OF_ALL},
	{"weights", OF_FILE},
	{"created", NOT_TOLD},
	{"warnings", NOT_TOLD},
};

/* eskeld takes 128 KiB of head and 5,000 parameters a request; a label has up to four. */
enum { most_query_bytes = 64 << 10, most_labels = 1000 };

static bool find_kind(const char *column, column_kind *kind)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		*kind = kinds[i].kind;
		if (!strcmp(kinds[i].name, column))
			return true;
	}
	*kind = strncmp(column, "attr.", 5) ? TOLD : OF_ALL;
	if (*kind == OF_ALL)
		return column[5];
	for (size_t n = 0; eskel_rows_column(n); n++)
		if (!strcmp(eskel_rows_column(n), column))
			return true;
	return false;
}

static column_kind kind_of(const char *column)
{
	column_kind kind;
	find_kind(column, &kind);
	return kind;
}

/* ---- reading */

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
	column_kind kind;
	if (!find_kind(name, &kind))
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

/* The words of eskeld for what people write in tables. */
static const char *word_for(const char *column, const char *value)
{
	static const char *const sides[][2] = {{"L", "left"}, {"R", "right"}, {"N", "none"}};
	for (size_t i = 0; i < 3 && !strcmp(column, "side"); i++)
		if (!strcasecmp(value, sides[i][0]))
			return sides[i][1];
	return value;
}

static void write_parameter(const char *prefix, const char *column, const char *value, FILE *out)
{
	fprintf(out, "&%s", prefix);
	esk_arguments_write_escaped(column, out);
	fputc('=', out);
	esk_arguments_write_escaped(word_for(column, value), out);
}

static char *shared_query(const esk_manifest *manifest, const esk_manifest_row *row)
{
	char *query = NULL;
	size_t size;
	FILE *out = open_memstream(&query, &size);
	for (size_t c = 0; out && c < manifest->column_count; c++) {
		const column_kind kind = kind_of(manifest->columns[c]);
		if (*row->cells[c] && (kind == OF_ALL || kind == OF_FILE || (kind == OF_LABEL && row->label == 0)))
			write_parameter("", manifest->columns[c], row->cells[c], out);
	}
	return esk_session_close_text(out, &query);
}

static esk_outcome fill_row(const esk_manifest *manifest, const char *const fields[], esk_manifest_row *row)
{
	const esk_csv *csv = &manifest->csv;
	for (size_t c = 0; c < manifest->column_count; c++) {
		const column_kind kind = kind_of(manifest->columns[c]);
		row->cells[c] = fields[c];
		if (kind == PATH && !stays_inside(row->path = fields[c]))
			return esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu (path): \"%s\" is not a path below the folder", csv->path,
				csv->line, c + 1, fields[c]);
		if (kind == LABEL && *fields[c] && !esk_label_parse(fields[c], &row->label))
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

/* ---- posting */

/* An option and a column would say two things. */
static esk_outcome check_options(const esk_manifest *manifest, const esk_arguments *arguments)
{
	if (esk_arguments_value(arguments, "label"))
		return esk_complain(ESK_MISUSED, "--label is given beside a manifest, which names the labels");
	for (size_t c = 0; c < manifest->column_count; c++) {
		const char *column = manifest->columns[c];
		const bool keyed = !strncmp(column, "attr.", 5);
		size_t position = 0;
		const char *value;
		while ((value = esk_arguments_next(arguments, keyed ? "attr" : column, &position)))
			if (!keyed ||
				(!strncmp(value, column + 5, strlen(column + 5)) && value[strlen(column + 5)] == '='))
				return esk_complain(ESK_MISUSED, "--%s is given, and %s has a column %s",
					keyed ? "attr" : column, manifest->csv.path, column);
	}
	return ESK_DONE;
}

static void write_label(const esk_manifest *manifest, const esk_manifest_row *row, FILE *out)
{
	char prefix[32];
	snprintf(prefix, sizeof prefix, "label.%d.", (int)row->label);
	fprintf(out, "&label=%d", (int)row->label);
	for (size_t c = 0; c < manifest->column_count; c++)
		if (*row->cells[c] && kind_of(manifest->columns[c]) == OF_LABEL)
			write_parameter(prefix, manifest->columns[c], row->cells[c], out);
}

/* The query of the rows from *next on that are posted together. */
static char *next_query(const esk_manifest *manifest, const char *given, size_t *next)
{
	char *query = NULL;
	size_t size, first = *next;
	const esk_manifest_row *row = &manifest->rows[first];
	FILE *out = open_memstream(&query, &size);
	if (out)
		fprintf(out, "%s%s", given, row->shared);
	do {
		if (out && row->label != 0)
			write_label(manifest, row, out);
		row = &manifest->rows[++*next];
	} while (*next < manifest->count && !strcmp(row->path, row[-1].path) && !strcmp(row->shared, row[-1].shared) &&
		 *next - first < most_labels && out && !fflush(out) && size < most_query_bytes);
	return esk_session_close_text(out, &query);
}

static char *join(const char *folder, const char *path)
{
	char *joined = NULL;
	return asprintf(&joined, "%s/%s", folder, path) < 0 ? NULL : joined;
}

esk_outcome esk_manifest_postings(const esk_manifest *manifest, const char *folder, const esk_session *session,
	const char *in_front, esk_postings *postings)
{
	esk_outcome outcome = check_options(manifest, session->arguments);
	char *given = outcome ? NULL : esk_session_query(session, in_front);
	if (!outcome && !given)
		outcome = ESK_REFUSED;
	for (size_t next = 0; next < manifest->count && !outcome;) {
		const size_t first = next;
		char *query = next_query(manifest, given, &next);
		outcome = esk_postings_add(postings, join(folder, manifest->rows[first].path), query);
		if (!outcome) {
			postings->items[postings->count - 1].first_row = first;
			postings->items[postings->count - 1].row_count = next - first;
		}
	}
	free(given);
	return outcome;
}

/* ---- comparing */

/* The row of the answer that a row of the manifest is about. */
static size_t find_label(const eskel_rows *rows, const esk_manifest_row *row)
{
	size_t i = 0;
	if (eskel_rows_count(rows) == 1)
		return 0;
	for (; row->label != 0 && i < eskel_rows_count(rows); i++) {
		char *label = eskel_rows_cell(rows, i, "label");
		const bool found = label && atol(label) == row->label;
		free(label);
		if (found)
			break;
	}
	return i;
}

static char *compare_row(const esk_manifest *manifest, const esk_manifest_row *row, const eskel_rows *rows)
{
	char *sentence = NULL;
	const size_t place = find_label(rows, row);
	for (size_t c = 0; c < manifest->column_count && !sentence; c++) {
		const char *column = manifest->columns[c];
		const column_kind kind = kind_of(column);
		if (kind == PATH || kind == OF_FILE || kind == NOT_TOLD || (kind == LABEL && row->label == 0))
			continue;
		char *cell = eskel_rows_cell(rows, place, column);
		if (cell && strcmp(cell, row->cells[c]) &&
			asprintf(&sentence, "the server's shape has %s \"%s\", the table says \"%s\"", column, cell,
				row->cells[c]) < 0)
			sentence = NULL;
		free(cell);
	}
	return sentence;
}

char *esk_manifest_compare(const esk_manifest *manifest, const esk_posting *posting, const esk_answer *answer)
{
	eskel_rows *rows = NULL;
	char *sentence = NULL;
	if (eskel_rows_read(answer->body, answer->size, &rows))
		return strdup("the answer is not one of eskeld's");
	for (size_t i = 0; i < posting->row_count && !sentence; i++)
		sentence = compare_row(manifest, &manifest->rows[posting->first_row + i], rows);
	eskel_rows_free(rows);
	return sentence;
}
