#include "csv.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t most_bytes = (size_t)1 << 30, first_bytes = (size_t)1 << 16;

/* All of the file, with room for one byte more, or most_bytes of it. */
static esk_outcome read_all(const char *path, FILE *file, char **text, size_t *size)
{
	size_t capacity = first_bytes, read;
	*size = 0;
	do {
		char *grown = realloc(*text, capacity + 1);
		if (!grown)
			return esk_complain(ESK_REFUSED, "memory ran out");
		*text = grown;
		read = fread(*text + *size, 1, capacity - *size, file);
		*size += read;
		capacity *= 2;
	} while (read > 0 && *size < most_bytes);
	return ferror(file) ? esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno)) : ESK_DONE;
}

esk_outcome esk_csv_open(const char *path, esk_csv *csv)
{
	FILE *file = fopen(path, "re");
	char *text = NULL;
	size_t size = 0;
	if (!file)
		return esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	esk_outcome outcome = read_all(path, file, &text, &size);
	if (!outcome && (size >= most_bytes || memchr(text, 0, size)))
		outcome = esk_complain(ESK_MISUSED, "%s: it is not a table of text below 1 GiB", path);
	if (outcome)
		goto cleanup;
	text[size] = '\0';
	size_t mark = strncmp(text, "\xef\xbb\xbf", 3) ? 0 : 3;
	*csv = (esk_csv){
		.path = path, .text = text, .next = text + mark, .end = text + size, .lines = 1, .separator = ','};
	text = NULL;
cleanup:
	free(text);
	fclose(file);
	return outcome;
}

void esk_csv_close(esk_csv *csv)
{
	free(csv->text);
	*csv = (esk_csv){0};
}

typedef enum { FIELD, LAST_FIELD, WRONG_FIELD } field_kind;

static field_kind wrong(const esk_csv *csv, const char *what)
{
	esk_complain(ESK_MISUSED, "%s, line %u, column %u: %s", csv->path, csv->line, csv->column, what);
	return WRONG_FIELD;
}

/* Takes the separator or the line end after a field whose text ends at out. */
static field_kind end_field(esk_csv *csv, char *out)
{
	char *at = csv->next;
	bool more = at < csv->end && *at == csv->separator;
	if (at < csv->end && *at == '\r' && at[1] == '\n')
		at++;
	if (at < csv->end && *at != csv->separator && *at != '\n')
		return wrong(csv, csv->separator == ',' ? "expected a comma or the line's end after the field"
							: "expected a tab or the line's end after the field");
	csv->lines += !more;
	csv->next = at < csv->end ? at + 1 : at;
	*out = '\0';
	return more ? FIELD : LAST_FIELD;
}

/* Unquotes the field where it stands: it is never longer than its source. */
static field_kind read_quoted(esk_csv *csv, const char **field)
{
	char *at = csv->next + 1, *out = at;
	*field = at;
	for (;; at++) {
		if (at == csv->end)
			return wrong(csv, "a quote is not closed");
		if (*at == '"' && *++at != '"')
			break;
		csv->lines += *at == '\n';
		*out++ = *at;
	}
	csv->next = at;
	return end_field(csv, out);
}

static field_kind read_plain(esk_csv *csv, const char **field)
{
	const char stops[] = {csv->separator, '\r', '\n', '"', '\0'};
	char *at = csv->next + strcspn(csv->next, stops);
	if (*at == '"')
		return wrong(csv, "a quote stands inside a field that does not begin with one");
	*field = csv->next;
	csv->next = at;
	return end_field(csv, at);
}

esk_outcome esk_csv_read_line(esk_csv *csv, const char *fields[ESK_CSV_MOST_COLUMNS], size_t *count)
{
	size_t read = 0;
	field_kind kind = FIELD;
	csv->line += csv->lines;
	csv->lines = 0;
	while (kind == FIELD) {
		csv->column = (unsigned)read + 1;
		if (read == ESK_CSV_MOST_COLUMNS) {
			wrong(csv, "there are more than 4096 columns");
			return ESK_MISUSED;
		}
		kind = *csv->next == '"' ? read_quoted(csv, &fields[read]) : read_plain(csv, &fields[read]);
		read++;
	}
	if (kind == WRONG_FIELD)
		return ESK_MISUSED;
	*count = read == 1 && !*fields[0] ? 0 : read;
	return ESK_DONE;
}

void esk_csv_write_field(const char *text, FILE *out)
{
	if (!strpbrk(text, ",\"\r\n")) {
		fputs(text, out);
		return;
	}
	fputc('"', out);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', out);
		fputc(*text, out);
	}
	fputc('"', out);
}
