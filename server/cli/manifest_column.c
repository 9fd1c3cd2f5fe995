#include "manifest_column.h"

#include "arguments.h"

#include "eskel_rows.h"

#include <string.h>
#include <strings.h>

/* The rest of an export's columns (eskel_rows.h) is ESK_COLUMN_TOLD. */
static const struct {
	const char *name;
	esk_column_kind kind;
} kinds[] = {
	{"path", ESK_COLUMN_PATH},
	{"label", ESK_COLUMN_LABEL},
	{"name", ESK_COLUMN_OF_LABEL},
	{"class", ESK_COLUMN_OF_LABEL},
	{"side", ESK_COLUMN_OF_LABEL},
	{"subject", ESK_COLUMN_OF_ALL},
	{"age", ESK_COLUMN_OF_ALL},
	{"sex", ESK_COLUMN_OF_ALL},
	{"levels", ESK_COLUMN_OF_ALL},
	{"weights", ESK_COLUMN_OF_FILE},
	{"created", ESK_COLUMN_NOT_TOLD},
	{"warnings", ESK_COLUMN_NOT_TOLD},
};

bool esk_manifest_column_find(const char *column, esk_column_kind *kind)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		*kind = kinds[i].kind;
		if (!strcmp(kinds[i].name, column))
			return true;
	}
	*kind = strncmp(column, "attr.", 5) ? ESK_COLUMN_TOLD : ESK_COLUMN_OF_ALL;
	if (*kind == ESK_COLUMN_OF_ALL)
		return column[5];
	for (size_t n = 0; eskel_rows_column(n); n++)
		if (!strcmp(eskel_rows_column(n), column))
			return true;
	return false;
}

esk_column_kind esk_manifest_column_kind(const char *column)
{
	esk_column_kind kind;
	esk_manifest_column_find(column, &kind);
	return kind;
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

void esk_manifest_write_parameter(const char *prefix, const char *column, const char *value, FILE *out)
{
	fprintf(out, "&%s", prefix);
	esk_arguments_write_escaped(column, out);
	fputc('=', out);
	esk_arguments_write_escaped(word_for(column, value), out);
}
