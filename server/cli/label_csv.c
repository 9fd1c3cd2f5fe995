#include "label_csv.h"

#include "arguments.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { LABEL, NAME, CLASS, SIDE, MEMBERS };
static const char *const members[MEMBERS] = {"label", "name", "class", "side"};

/* Where the members stand: places[m] is the column of members[m] from 0, or -1. */
static esk_outcome read_header(esk_csv *csv, int places[MEMBERS], size_t *column_count)
{
	const char *fields[ESK_CSV_MOST_COLUMNS];
	esk_outcome outcome = esk_csv_read_line(csv, fields, column_count);
	for (size_t m = 0; m < MEMBERS && !outcome; m++) {
		places[m] = -1;
		for (size_t c = 0; c < *column_count; c++) {
			if (strcasecmp(fields[c], members[m]))
				continue;
			if (places[m] >= 0)
				return esk_complain(ESK_MISUSED, "%s, line %u, column %zu: %s is a column already",
					csv->path, csv->line, c + 1, members[m]);
			places[m] = (int)c;
		}
	}
	if (!outcome && places[LABEL] < 0)
		return esk_complain(ESK_MISUSED, "%s, line 1: there is no column called label", csv->path);
	return outcome;
}

bool esk_label_parse(const char *text, int32_t *label)
{
	char *end = NULL;
	errno = 0;
	long value = strtol(text, &end, 10);
	bool digits = (text[0] >= '0' && text[0] <= '9') || (text[0] == '-' && text[1] >= '0' && text[1] <= '9');
	if (!digits || *end || errno || value == 0 || value < INT32_MIN || value > INT32_MAX)
		return false;
	*label = (int32_t)value;
	return true;
}

/* The side in the server's words; NULL for what is none. */
static const char *side_of(const char *text)
{
	static const char *const sides[][2] = {{"", ""}, {"left", "L"}, {"right", "R"}, {"none", "N"}};
	for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
		if (!strcasecmp(text, sides[i][0]) || !strcasecmp(text, sides[i][1]))
			return sides[i][0];
	}
	return NULL;
}

static esk_outcome fill_row(
	const esk_csv *csv, const char *const fields[], const int places[MEMBERS], esk_label_csv_row *row)
{
	const char *texts[MEMBERS];
	for (size_t m = 0; m < MEMBERS; m++)
		texts[m] = places[m] >= 0 ? fields[places[m]] : "";
	int32_t label;
	if (!esk_label_parse(texts[LABEL], &label))
		return esk_complain(ESK_MISUSED,
			"%s, line %u, column %d (label): \"%s\" is not a whole number other than 0", csv->path,
			csv->line, places[LABEL] + 1, texts[LABEL]);
	const char *side = side_of(texts[SIDE]);
	if (!side)
		return esk_complain(ESK_MISUSED, "%s, line %u, column %d (side): \"%s\" is not left, right or none",
			csv->path, csv->line, places[SIDE] + 1, texts[SIDE]);
	*row = (esk_label_csv_row){label, csv->line, texts[NAME], texts[CLASS], side};
	return ESK_DONE;
}

static esk_outcome add_row(
	const esk_csv *csv, const char *const fields[], const int places[MEMBERS], esk_label_csv *table)
{
	/* Grows at each power of two. */
	if ((table->count & (table->count - 1)) == 0) {
		size_t capacity = table->count > 0 ? 2 * table->count : 1;
		esk_label_csv_row *rows = reallocarray(table->rows, capacity, sizeof *rows);
		if (!rows)
			return esk_complain(ESK_REFUSED, "memory ran out");
		table->rows = rows;
	}
	esk_outcome outcome = fill_row(csv, fields, places, &table->rows[table->count]);
	table->count += !outcome;
	return outcome;
}

static esk_outcome read_rows(esk_csv *csv, esk_label_csv *table)
{
	int places[MEMBERS];
	size_t column_count = 0, count;
	const char *fields[ESK_CSV_MOST_COLUMNS];
	esk_outcome outcome = read_header(csv, places, &column_count);
	while (!outcome && csv->next < csv->end) {
		outcome = esk_csv_read_line(csv, fields, &count);
		if (outcome || count == 0)
			continue;
		if (count != column_count)
			outcome = esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu: %zu fields, expected %zu as in the header", csv->path,
				csv->line, count, count, column_count);
		else
			outcome = add_row(csv, fields, places, table);
	}
	return outcome;
}

static int by_label(const void *a, const void *b)
{
	const esk_label_csv_row *left = a, *right = b;
	if (left->label != right->label)
		return left->label < right->label ? -1 : 1;
	return left->line < right->line ? -1 : left->line > right->line;
}

static esk_outcome sort_rows(const char *path, esk_label_csv *table)
{
	if (table->count > 0)
		qsort(table->rows, table->count, sizeof *table->rows, by_label);
	for (size_t i = 1; i < table->count; i++) {
		const esk_label_csv_row *row = &table->rows[i];
		if (row->label == row[-1].label)
			return esk_complain(ESK_MISUSED, "%s, line %u: the label %d stands in line %u already", path,
				row->line, (int)row->label, row[-1].line);
	}
	return ESK_DONE;
}

esk_outcome esk_label_csv_read(const char *path, esk_label_csv *table)
{
	esk_label_csv read = {0};
	esk_outcome outcome = esk_csv_open(path, &read.csv);
	if (!outcome)
		outcome = read_rows(&read.csv, &read);
	if (!outcome)
		outcome = sort_rows(path, &read);
	if (outcome)
		esk_label_csv_clear(&read);
	else
		*table = read;
	return outcome;
}

void esk_label_csv_clear(esk_label_csv *table)
{
	free(table->rows);
	esk_csv_close(&table->csv);
	*table = (esk_label_csv){0};
}

const esk_label_csv_row *esk_label_csv_find(const esk_label_csv *table, int32_t label)
{
	for (size_t low = 0, high = table->count; low < high;) {
		size_t middle = low + (high - low) / 2;
		const esk_label_csv_row *row = &table->rows[middle];
		if (row->label == label)
			return row;
		if (row->label < label)
			low = middle + 1;
		else
			high = middle;
	}
	return NULL;
}

static void write_member(const esk_label_csv_row *row, const char *member, const char *value, FILE *out)
{
	if (!*value)
		return;
	fprintf(out, "&label.%d.%s=", (int)row->label, member);
	esk_arguments_write_escaped(value, out);
}

void esk_label_csv_write_query(const esk_label_csv_row *row, FILE *out)
{
	write_member(row, "name", row->name, out);
	write_member(row, "class", row->class, out);
	write_member(row, "side", row->side, out);
}
