#include "post_volume.h"

#include "volume_file.h"

#include <stdlib.h>

/* eskeld takes 128 KiB of head and 4,096 parameters a request; a label has up to four. */
enum { most_query_bytes = 64 << 10, most_labels = 1000 };

/* As many of the volume's labels from the one at *next as fit (the last may go past most_query_bytes). */
static char *part_query(
	const esk_session *session, const esk_label_names *table, const eskel_volume *volume, size_t *next)
{
	char *query = NULL;
	size_t size, first = *next, count = eskel_volume_label_count(volume);
	FILE *out = open_memstream(&query, &size);
	if (out)
		esk_arguments_write_query(session->arguments, "label", out);
	while (out && *next < count && *next - first < most_labels && !fflush(out) && size < most_query_bytes) {
		int32_t label = eskel_volume_label(volume, (*next)++);
		const esk_label_name *row = esk_label_names_find(table, label);
		fprintf(out, "&label=%d", (int)label);
		if (row)
			esk_label_names_write_query(row, out);
	}
	return esk_session_close_text(out, &query);
}

static esk_outcome post(esk_session *session, const char *path, const char *file, char *query)
{
	const esk_request request = {.path = path, .query = query, .file = file};
	return query ? esk_session_ask(session, &request, file) : ESK_REFUSED;
}

/* A table of another volume is a mistake. */
static esk_outcome check_table(const char *file, const eskel_volume *volume, const esk_label_names *table)
{
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++) {
		if (esk_label_names_find(table, eskel_volume_label(volume, i)))
			return ESK_DONE;
	}
	return esk_complain(ESK_MISUSED, "%s: %s names none of its labels", file, table->csv.path);
}

static esk_outcome post_with_table(
	esk_session *session, const char *path, const char *file, const esk_label_names *table)
{
	eskel_volume *volume = NULL;
	esk_outcome outcome = esk_volume_file_read(file, session->arguments, &volume);
	if (outcome)
		return outcome;
	outcome = check_table(file, volume, table);
	for (size_t next = 0; next < eskel_volume_label_count(volume) && !outcome;) {
		session->progress.items += next > 0;
		char *query = part_query(session, table, volume, &next);
		outcome = post(session, path, file, query);
		free(query);
	}
	eskel_volume_free(volume);
	return outcome;
}

esk_outcome esk_post_volume(esk_session *session, const char *path, const char *file, const esk_label_names *table)
{
	if (table->count > 0)
		return post_with_table(session, path, file, table);
	char *query = esk_session_query(session, "");
	esk_outcome outcome = post(session, path, file, query);
	free(query);
	return outcome;
}

esk_outcome esk_post_read_labels(const esk_session *session, esk_label_names *table)
{
	const char *path = esk_arguments_value(session->arguments, "labels");
	return path ? esk_label_names_read(path, table) : ESK_DONE;
}
