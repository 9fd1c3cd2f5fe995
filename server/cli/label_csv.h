/* Names for the labels of a volume, from a CSV table (csv.h) that people keep beside it.
 *
 * The first line is the header. The columns label, name, class and side are found by name in any order; label must be
 * there, others are ignored, and so are empty lines. Everything else is strict: a complaint names the line and the
 * column. A side may also be L, R or N. */
#ifndef ESK_LABEL_CSV_H
#define ESK_LABEL_CSV_H

#include "csv.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct {
	int32_t label;
	unsigned line;                   /* of the table */
	const char *name, *class, *side; /* "" when not said; side is left, right or none */
} esk_label_csv_row;

typedef struct {
	size_t count;
	esk_label_csv_row *rows; /* ascending, unique labels */
	esk_csv csv;             /* holds the rows' text */
} esk_label_csv;

esk_outcome esk_label_csv_read(const char *path, esk_label_csv *table);
void esk_label_csv_clear(esk_label_csv *table);

/* NULL when the table does not name the label. */
const esk_label_csv_row *esk_label_csv_find(const esk_label_csv *table, int32_t label);

/* Writes "&label.N.name=..." and so on. */
void esk_label_csv_write_query(const esk_label_csv_row *row, FILE *out);

/* A label in strict digits, not 0. */
bool esk_label_parse(const char *text, int32_t *label);

#endif
