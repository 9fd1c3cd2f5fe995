#include "post_volume.h"

#include "volume_file.h"

#include <stdlib.h>

/* eskeld keeps a request's head in the 128 KiB of its connection: the line itself and, of libmicrohttpd, a record of 56
 * bytes for each parameter. A quarter is left for the header fields and for the names of one label too many. It takes
 * 1,024 labels a request. */
enum { parameter_record = 56, most_query_cost = 96 << 10, most_labels = 1024 };

static bool fits(const char *query)
{
	size_t cost = 0;
	for (; *query; query++)
		cost += *query == '&' ? 1 + parameter_record : 1;
	return cost <= most_query_cost;
}

/* A label that --label names, or any where it names none. */
static bool is_chosen(const esk_arguments *arguments, int32_t label)
{
	size_t position = 0;
	int32_t chosen = 0;
	const char *text = NULL;
	while (chosen != label && (text = esk_arguments_next(arguments, "label", &position)))
		(void)esk_label_parse(text, &chosen);
	return chosen == label || !esk_arguments_value(arguments, "label");
}

/* Every chosen row of the table. */
static char *whole_query(const esk_session *session, const esk_label_csv *table)
{
	char *query = NULL;
	size_t size;
	FILE *out = open_memstream(&query, &size);
	if (out)
		esk_arguments_write_query(session->arguments, NULL, out);
	for (size_t i = 0; i < table->count && out; i++) {
		if (is_chosen(session->arguments, table->rows[i].label))
			esk_label_csv_write_query(&table->rows[i], out);
	}
	return esk_session_close_text(out, &query);
}

/* As many of the volume's labels from the one at *next as fit, each chosen and with its row. */
static char *part_query(
	const esk_session *session, const esk_label_csv *table, const eskel_volume *volume, size_t *next)
{
	char *query = NULL;
	size_t size, count = eskel_volume_label_count(volume), end = *next + most_labels;
	FILE *out = open_memstream(&query, &size);
	if (out)
		esk_arguments_write_query(session->arguments, "label", out);
	while (out && *next < count && *next < end && !fflush(out) && fits(query)) {
		int32_t label = eskel_volume_label(volume, (*next)++);
		const esk_label_csv_row *row = esk_label_csv_find(table, label);
		fprintf(out, "&label=%d", (int)label);
		if (row)
			esk_label_csv_write_query(row, out);
	}
	return esk_session_close_text(out, &query);
}

static esk_outcome post_in_parts(esk_session *session, const char *path, const char *file, const esk_label_csv *table)
{
	eskel_volume *volume = NULL;
	esk_outcome outcome = esk_volume_file_read(file, session->arguments, &volume);
	if (outcome)
		return outcome;
	for (size_t next = 0; next < eskel_volume_label_count(volume) && !outcome;) {
		session->progress.items += next > 0;
		char *query = part_query(session, table, volume, &next);
		const esk_request request = {path, query, file};
		outcome = query ? esk_session_ask(session, &request, file) : ESK_REFUSED;
		free(query);
	}
	eskel_volume_free(volume);
	return outcome;
}

esk_outcome esk_post_volume(esk_session *session, const char *path, const char *file, const esk_label_csv *table)
{
	esk_outcome outcome = ESK_REFUSED;
	char *query = whole_query(session, table);
	const esk_request request = {path, query, file};
	if (query && !fits(query))
		outcome = post_in_parts(session, path, file, table);
	else if (query)
		outcome = esk_session_ask(session, &request, file);
	free(query);
	return outcome;
}

esk_outcome esk_post_read_labels(const esk_session *session, esk_label_csv *table)
{
	const char *path = esk_arguments_value(session->arguments, "labels");
	return path ? esk_label_csv_read(path, table) : ESK_DONE;
}
