/* From a manifest to what is posted, and from the answers back to the manifest. */
#include "manifest.h"

#include "arguments.h"
#include "manifest_column.h"

#include "eskel_rows.h"

#include <stdlib.h>
#include <string.h>

/* eskeld takes 128 KiB of head and 5,000 parameters a request; a label has up to four. */
enum { most_query_bytes = 64 << 10, most_labels = 1000 };

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
		if (*row->cells[c] && esk_manifest_column_kind(manifest->columns[c]) == ESK_COLUMN_OF_LABEL)
			esk_manifest_write_parameter(prefix, manifest->columns[c], row->cells[c], out);
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
		const esk_column_kind kind = esk_manifest_column_kind(column);
		if (kind == ESK_COLUMN_PATH || kind == ESK_COLUMN_OF_FILE || kind == ESK_COLUMN_NOT_TOLD ||
			(kind == ESK_COLUMN_LABEL && row->label == 0))
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
