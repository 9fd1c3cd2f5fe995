/* Names for the labels of a volume, from a table that people keep beside it.
 *
 * What kind of table it is its content tells, not its name: rows of colours as ITK-SNAP, FreeSurfer and 3D Slicer write
 * them (label_colours.h), or a header and rows in CSV or, as BIDS has it, separated by tabs (label_csv.h). Everything else
 * is strict: a complaint names the line. */
#ifndef ESK_LABEL_NAMES_H
#define ESK_LABEL_NAMES_H

#include "csv.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct {
	int32_t label;
	unsigned line;                   /* of the table */
	const char *name, *class, *side; /* "" when not said; side is left, right or none */
} esk_label_name;

typedef struct {
	size_t count;
	esk_label_name *items; /* once read: ascending, unique labels */
	esk_csv csv;           /* holds their text */
} esk_label_names;

esk_outcome esk_label_names_read(const char *path, esk_label_names *names);
void esk_label_names_clear(esk_label_names *names);

/* For the readers of tables. */
esk_outcome esk_label_names_add(esk_label_names *names, const esk_label_name *name);

/* NULL when the table does not name the label. */
const esk_label_name *esk_label_names_find(const esk_label_names *names, int32_t label);

/* Writes "&label.N.name=..." and so on. */
void esk_label_names_write_query(const esk_label_name *name, FILE *out);

/* A label in strict digits, not 0. */
bool esk_label_parse(const char *text, int32_t *label);

#endif
