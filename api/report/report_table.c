#include "report_table.h"

#include "text.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

typedef struct {
	char *text;
	size_t width;
	esk_tone tone;
} table_cell;

static const char end_escape[] = "\033[0m";

struct esk_table {
	const esk_column *columns;
	size_t column_count;
	size_t cell_count, capacity;
	table_cell *cells;
	bool failed;
};

static const char *const tone_escapes[] = {[ESK_TONE_PLAIN] = "",
	[ESK_TONE_GOOD] = "\033[32m",
	[ESK_TONE_BAD] = "\033[31m",
	[ESK_TONE_HEADING] = "\033[1m"};

void esk_table_free(esk_table *table)
{
	if (!table)
		return;
	for (size_t i = 0; i < table->cell_count; i++)
		free(table->cells[i].text);
	free(table->cells);
	free(table);
}

/* The code point at text, which is UTF-8, and how many bytes it takes. */
static wchar_t code_point(const char *text, size_t *size)
{
	const unsigned char *bytes = (const unsigned char *)text;
	size_t length = bytes[0] >= 0xf0 ? 4 : bytes[0] >= 0xe0 ? 3 : bytes[0] >= 0xc0 ? 2 : 1;
	unsigned code = length == 1 ? bytes[0] : bytes[0] & (0xffu >> (length + 1));
	for (size_t i = 1; i < length; i++)
		code = code << 6 | (bytes[i] & 0x3f);
	*size = length;
	return (wchar_t)code;
}

/* Terminal columns of UTF-8 text; 1 for a character that the locale does not know. */
static size_t display_width(const char *text)
{
	size_t width = 0, size;
	for (; *text; text += size) {
		int columns = wcwidth(code_point(text, &size));
		width += columns < 0 ? 1 : (size_t)columns;
	}
	return width;
}

char *esk_table_plain(const char *text)
{
	char *copy = strdup(text);
	if (copy)
		esk_text_clean(copy);
	return copy;
}

void esk_table_write_plain(FILE *out, const char *text)
{
	char *copy = esk_table_plain(text);
	fputs(copy ? copy : "?", out);
	free(copy);
}

static bool reserve(esk_table *table)
{
	if (table->cell_count < table->capacity)
		return true;
	size_t capacity = table->capacity ? 2 * table->capacity : 64;
	table_cell *cells = reallocarray(table->cells, capacity, sizeof *cells);
	if (!cells)
		return false;
	table->cells = cells;
	table->capacity = capacity;
	return true;
}

void esk_table_toned_cell(esk_table *table, esk_tone tone, const char *text)
{
	if (!table || table->failed)
		return;
	char *copy = esk_table_plain(text);
	if (!copy || !reserve(table)) {
		free(copy);
		table->failed = true;
		return;
	}
	table->cells[table->cell_count++] = (table_cell){copy, display_width(copy), tone};
}

void esk_table_cell(esk_table *table, const char *text)
{
	esk_table_toned_cell(table, ESK_TONE_PLAIN, text);
}

/* The titles are the first row of cells. */
esk_table *esk_table_new(const esk_column *columns, size_t column_count)
{
	esk_table *table = calloc(1, sizeof *table);
	if (!table)
		return NULL;
	*table = (esk_table){.columns = columns, .column_count = column_count};
	for (size_t c = 0; c < column_count; c++)
		esk_table_toned_cell(table, ESK_TONE_HEADING, columns[c].title);
	return table;
}

void esk_table_format(esk_table *table, const char *format, ...)
{
	char *text = NULL;
	va_list arguments;
	va_start(arguments, format);
	int length = vasprintf(&text, format, arguments);
	va_end(arguments);
	if (length >= 0) {
		esk_table_cell(table, text);
		free(text);
	} else if (table) {
		table->failed = true;
	}
}

static size_t column_width(const esk_table *table, size_t column)
{
	size_t widest = 0;
	for (size_t i = column; i < table->cell_count; i += table->column_count) {
		if (table->cells[i].width > widest)
			widest = table->cells[i].width;
	}
	return widest;
}

/* The last column is not padded on its right, so no line ends in spaces. */
static void write_cell(const esk_table *table, size_t index, const size_t *widths, FILE *out, bool colour)
{
	size_t column = index % table->column_count;
	const table_cell *cell = &table->cells[index];
	const char *escape = colour ? tone_escapes[cell->tone] : "";
	bool right = table->columns[column].right;
	int space = (int)(widths[column] - cell->width);
	fprintf(out, "%*s%s%s%s", right ? space : 0, "", escape, cell->text, *escape ? end_escape : "");
	if (column + 1 == table->column_count)
		fputc('\n', out);
	else
		fprintf(out, "%*s", right ? 2 : space + 2, "");
}

bool esk_table_write(const esk_table *table, FILE *out, bool colour)
{
	if (!table || table->failed)
		return false;
	if (table->cell_count == table->column_count)
		return true;
	size_t *widths = calloc(table->column_count, sizeof *widths);
	if (!widths)
		return false;
	for (size_t c = 0; c < table->column_count; c++)
		widths[c] = column_width(table, c);
	for (size_t i = 0; i < table->cell_count; i++)
		write_cell(table, i, widths, out, colour);
	free(widths);
	return true;
}
