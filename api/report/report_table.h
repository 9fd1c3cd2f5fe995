/* Aligned columns of text.
 *
 * Cells are added row by row; a column is as wide as its widest cell. Widths count terminal columns, not bytes:
 * what is UTF-8 and wide in the caller's locale is laid out as such. Running out of memory is remembered and told by
 * esk_table_write. */
#ifndef ESK_REPORT_TABLE_H
#define ESK_REPORT_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct {
	const char *title;
	bool right; /* numbers align to the right */
} esk_column;

typedef enum { ESK_TONE_PLAIN, ESK_TONE_GOOD, ESK_TONE_BAD, ESK_TONE_HEADING } esk_tone;

typedef struct esk_table esk_table;

/* Borrows the columns. NULL when memory ran out. */
esk_table *esk_table_new(const esk_column *columns, size_t column_count);
void esk_table_free(esk_table *table);

/* The next cell of the row; control characters, and what is not UTF-8, become '?'. Takes a NULL table (one whose _new failed). */
void esk_table_cell(esk_table *table, const char *text);
void esk_table_toned_cell(esk_table *table, esk_tone tone, const char *text);
void esk_table_format(esk_table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Nothing when there is no row. False when memory ran out, here or earlier. */
bool esk_table_write(const esk_table *table, FILE *out, bool colour);

/* Text with the same replaced: written, or copied (free() it; NULL when memory ran out). */
void esk_table_write_plain(FILE *out, const char *text);
char *esk_table_plain(const char *text);

#endif
