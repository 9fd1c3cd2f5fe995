/* The columns of a manifest, and how a cell of one becomes a query parameter. */
#ifndef ESK_MANIFEST_COLUMN_H
#define ESK_MANIFEST_COLUMN_H

#include <stdbool.h>
#include <stdio.h>

typedef enum {
	ESK_COLUMN_PATH,
	ESK_COLUMN_LABEL,
	ESK_COLUMN_OF_LABEL, /* said of one label, or of all */
	ESK_COLUMN_OF_ALL,   /* said of all labels that are posted together */
	ESK_COLUMN_OF_FILE,  /* how the file is to be read: no answer tells it */
	ESK_COLUMN_TOLD,     /* not posted, but told by the answer */
	ESK_COLUMN_NOT_TOLD  /* neither: it belongs to the server or the file that it comes from */
} esk_column_kind;

/* False for a name that is no column of a manifest. */
bool esk_manifest_column_find(const char *name, esk_column_kind *kind);
/* Of a column that a manifest has. */
esk_column_kind esk_manifest_column_kind(const char *name);

/* "&", the prefix, the column, "=" and the value; of sides also L, R and N. */
void esk_manifest_write_parameter(const char *prefix, const char *column, const char *value, FILE *out);

#endif
