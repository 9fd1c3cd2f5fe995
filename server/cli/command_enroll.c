/* eskel enroll: posts volumes, with what is known of their labels.
 *
 * One file is one request, all of its labels or none, unless the names of a label table make the request longer than a
 * server takes. Then the file is posted several times, each time with the next few of its labels chosen, and all or
 * none holds for each part; to repeat such an enrollment after a failure is harmless, for a shape's id is its content.
 */
#include "command.h"
#include "label_csv.h"
#include "volume_file.h"

#include <stdlib.h>
#include <string.h>

/* A server reads a request's head into 128 KiB, which also hold the parsed parameters: a pointer quadruple each beside
 * their text, about as much again. One label's names may go past it. */
static const size_t most_query_bytes = (size_t)32 << 10;

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

/* The query so far was written to out; NULL, with a complaint, when memory ran out. */
static char *finish_query(FILE *out, char **query)
{
	if (!fclose(out))
		return *query;
	free(*query);
	esk_complain(ESK_REFUSED, "memory ran out");
	return NULL;
}

/* Every chosen row of the table. */
static char *whole_query(const esk_session *session, const esk_label_csv *table)
{
	char *query = NULL;
	size_t size;
	FILE *out = open_memstream(&query, &size);
	if (!out)
		return NULL;
	esk_arguments_write_query(session->arguments, NULL, out);
	for (size_t i = 0; i < table->count; i++) {
		if (is_chosen(session->arguments, table->rows[i].label))
			esk_label_csv_write_query(&table->rows[i], out);
	}
	return finish_query(out, &query);
}

/* As many of the volume's labels from the one at *next as fit, each chosen and with its row. */
static char *part_query(
	const esk_session *session, const esk_label_csv *table, const eskel_volume *volume, size_t *next)
{
	char *query = NULL;
	size_t size, count = eskel_volume_label_count(volume);
	FILE *out = open_memstream(&query, &size);
	if (!out)
		return NULL;
	esk_arguments_write_query(session->arguments, "label", out);
	while (*next < count && !fflush(out) && size < most_query_bytes) {
		int32_t label = eskel_volume_label(volume, (*next)++);
		const esk_label_csv_row *row = esk_label_csv_find(table, label);
		if (!is_chosen(session->arguments, label))
			continue;
		fprintf(out, "&label=%d", (int)label);
		if (row)
			esk_label_csv_write_query(row, out);
	}
	return finish_query(out, &query);
}

static esk_outcome post(esk_session *session, const char *file, const char *query)
{
	const esk_request request = {"/shapes", query, file};
	return query ? esk_session_ask(session, &request, file) : ESK_REFUSED;
}

static esk_outcome enroll_in_parts(esk_session *session, const char *file, const esk_label_csv *table)
{
	eskel_volume *volume = NULL;
	esk_outcome outcome = esk_volume_file_read(file, NULL, 0, &volume);
	size_t next = 0;
	while (!outcome && next < eskel_volume_label_count(volume)) {
		session->progress.items += next > 0;
		char *query = part_query(session, table, volume, &next);
		outcome = post(session, file, query);
		free(query);
	}
	eskel_volume_free(volume);
	return outcome;
}

static esk_outcome enroll(esk_session *session, const char *file, const esk_label_csv *table)
{
	char *query = whole_query(session, table);
	esk_outcome outcome;
	if (query && strlen(query) > most_query_bytes)
		outcome = enroll_in_parts(session, file, table);
	else
		outcome = post(session, file, query);
	free(query);
	return outcome;
}

esk_outcome esk_command_enroll(esk_session *session)
{
	const esk_arguments *arguments = session->arguments;
	const char *table_path = esk_arguments_value(arguments, "labels");
	esk_label_csv table = {0};
	esk_outcome worst = esk_session_open(session, ESKEL_REPORT_SHAPES);
	if (!worst && table_path)
		worst = esk_label_csv_read(table_path, &table);
	if (!worst)
		worst = esk_session_connect(session);
	if (worst)
		return worst;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(worst, enroll(session, arguments->operands[i], &table));
	esk_label_csv_clear(&table);
	return worst;
}
