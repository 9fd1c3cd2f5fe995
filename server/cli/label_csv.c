#include "label_csv.h"

#include "arguments.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { most_columns = 64 };
static const size_t most_bytes = (size_t)16 << 20;

/* Reads fields one by one, unquoting them where they stand: a field is never longer than its source. */
typedef struct {
	const char *path;
	char *next, *end;      /* end points at a NUL */
	unsigned line, column; /* of the field being read, from 1; a quoted line end stays in its line */
	unsigned lines;        /* that this line took so far */
} csv_reader;

typedef enum { FIELD, LAST_FIELD, WRONG_FIELD } field_kind;

static field_kind wrong(const csv_reader *reader, const char *what)
{
	esk_complain(ESK_MISUSED, "%s, line %u, column %u: %s", reader->path, reader->line, reader->column, what);
	return WRONG_FIELD;
}

/* Takes the comma or the line end after a field whose text ends at out. */
static field_kind end_field(csv_reader *reader, char *out)
{
	char *at = reader->next;
	bool comma = at < reader->end && *at == ',';
	if (at < reader->end && *at == '\r' && at[1] == '\n')
		at++;
	if (at < reader->end && *at != ',' && *at != '\n')
		return wrong(reader, "expected a comma or the line's end after the field");
	reader->lines += !comma;
	reader->next = at < reader->end ? at + 1 : at;
	*out = '\0';
	return comma ? FIELD : LAST_FIELD;
}

static field_kind read_quoted(csv_reader *reader, const char **field)
{
	char *at = reader->next + 1, *out = at;
	*field = at;
	for (;; at++) {
		if (at == reader->end)
			return wrong(reader, "a quote is not closed");
		if (*at == '"' && *++at != '"')
			break;
		reader->lines += *at == '\n';
		*out++ = *at;
	}
	reader->next = at;
	return end_field(reader, out);
}

static field_kind read_plain(csv_reader *reader, const char **field)
{
	char *at = reader->next + strcspn(reader->next, ",\r\n\"");
	if (*at == '"')
		return wrong(reader, "a quote stands inside a field that does not begin with one");
	*field = reader->next;
	reader->next = at;
	return end_field(reader, at);
}

/* One line's fields; *count is 0 for an empty line. */
static esk_outcome read_line(csv_reader *reader, const char *fields[most_columns], size_t *count)
{
	size_t read = 0;
	field_kind kind = FIELD;
	reader->line += reader->lines;
	reader->lines = 0;
	while (kind == FIELD) {
		reader->column = (unsigned)read + 1;
		if (read == most_columns) {
			wrong(reader, "there are more than 64 columns");
			return ESK_MISUSED;
		}
		kind = *reader->next == '"' ? read_quoted(reader, &fields[read]) : read_plain(reader, &fields[read]);
		read++;
	}
	if (kind == WRONG_FIELD)
		return ESK_MISUSED;
	*count = read == 1 && !*fields[0] ? 0 : read;
	return ESK_DONE;
}

enum { LABEL, NAME, CLASS, SIDE, MEMBERS };
static const char *const members[MEMBERS] = {"label", "name", "class", "side"};

/* Where the members stand: places[m] is the column of members[m] from 0, or -1. */
static esk_outcome read_header(csv_reader *reader, int places[MEMBERS], size_t *column_count)
{
	const char *fields[most_columns];
	esk_outcome outcome = read_line(reader, fields, column_count);
	for (size_t m = 0; m < MEMBERS && !outcome; m++) {
		places[m] = -1;
		for (size_t c = 0; c < *column_count; c++) {
			if (strcasecmp(fields[c], members[m]))
				continue;
			if (places[m] >= 0)
				return esk_complain(ESK_MISUSED, "%s, line %u, column %zu: %s is a column already",
					reader->path, reader->line, c + 1, members[m]);
			places[m] = (int)c;
		}
	}
	if (!outcome && places[LABEL] < 0)
		return esk_complain(ESK_MISUSED, "%s, line 1: there is no column called label", reader->path);
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
	const csv_reader *reader, const char *const fields[], const int places[MEMBERS], esk_label_csv_row *row)
{
	const char *texts[MEMBERS];
	for (size_t m = 0; m < MEMBERS; m++)
		texts[m] = places[m] >= 0 ? fields[places[m]] : "";
	int32_t label;
	if (!esk_label_parse(texts[LABEL], &label))
		return esk_complain(ESK_MISUSED,
			"%s, line %u, column %d (label): \"%s\" is not a whole number other than 0", reader->path,
			reader->line, places[LABEL] + 1, texts[LABEL]);
	const char *side = side_of(texts[SIDE]);
	if (!side)
		return esk_complain(ESK_MISUSED, "%s, line %u, column %d (side): \"%s\" is not left, right or none",
			reader->path, reader->line, places[SIDE] + 1, texts[SIDE]);
	*row = (esk_label_csv_row){label, reader->line, texts[NAME], texts[CLASS], side};
	return ESK_DONE;
}

static esk_outcome add_row(
	const csv_reader *reader, const char *const fields[], const int places[MEMBERS], esk_label_csv *table)
{
	/* Grows at each power of two. */
	if ((table->count & (table->count - 1)) == 0) {
		size_t capacity = table->count > 0 ? 2 * table->count : 1;
		esk_label_csv_row *rows = reallocarray(table->rows, capacity, sizeof *rows);
		if (!rows)
			return esk_complain(ESK_REFUSED, "memory ran out");
		table->rows = rows;
	}
	esk_outcome outcome = fill_row(reader, fields, places, &table->rows[table->count]);
	table->count += !outcome;
	return outcome;
}

static esk_outcome read_rows(csv_reader *reader, esk_label_csv *table)
{
	int places[MEMBERS];
	size_t column_count = 0, count;
	const char *fields[most_columns];
	esk_outcome outcome = read_header(reader, places, &column_count);
	while (!outcome && reader->next < reader->end) {
		outcome = read_line(reader, fields, &count);
		if (outcome || count == 0)
			continue;
		if (count != column_count)
			outcome = esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu: %zu fields, expected %zu as in the header", reader->path,
				reader->line, count, count, column_count);
		else
			outcome = add_row(reader, fields, places, table);
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

/* The whole file, NUL-terminated. */
static esk_outcome read_text(const char *path, char **text, size_t *size)
{
	FILE *file = fopen(path, "re");
	char *bytes = malloc(most_bytes + 1);
	esk_outcome outcome = ESK_DONE;
	if (!file || !bytes) {
		outcome = esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
		goto cleanup;
	}
	size_t got = fread(bytes, 1, most_bytes, file);
	if (ferror(file))
		outcome = esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	else if (got == most_bytes || memchr(bytes, 0, got))
		outcome = esk_complain(ESK_MISUSED, "%s: it is not a table of text below 16 MiB", path);
	if (!outcome) {
		bytes[got] = '\0';
		*text = bytes;
		*size = got;
		bytes = NULL;
	}
cleanup:
	free(bytes);
	if (file)
		fclose(file);
	return outcome;
}

esk_outcome esk_label_csv_read(const char *path, esk_label_csv *table)
{
	esk_label_csv read = {0};
	size_t size = 0;
	esk_outcome outcome = read_text(path, &read.text, &size);
	if (!outcome) {
		size_t mark = strncmp(read.text, "\xef\xbb\xbf", 3) ? 0 : 3;
		csv_reader reader = {.path = path, .next = read.text + mark, .end = read.text + size, .lines = 1};
		outcome = read_rows(&reader, &read);
	}
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
	free(table->text);
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
