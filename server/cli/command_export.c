/* eskel export: the library as files that other programs read, and that eskel import reads back.
 *
 *     DIR/shapes.csv           a row a shape: where its file is, what is said of it, what was measured
 *     DIR/signatures.csv       a row a class of a level of a shape
 *     DIR/clouds/ID.nii.gz     its voxels, or ID.nrrd; ID.weights.nii.gz where they are weights
 *
 * The library is read twice, page by page: the attributes' keys become columns, and must be known before the first row.
 * A file is written beside its place and then put there, so one that is there is whole, and, its name being its content, is
 * not asked for again. */
#include "command.h"
#include "csv.h"
#include "key_set.h"

#include "eskel_report.h"
#include "eskel_rows.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

typedef struct {
	esk_session *session;
	esk_client *client;
	const char *folder, *format, *suffix;
	esk_key_set keys;
	FILE *shapes, *signatures;
	size_t count, done, written, there, gone, refused; /* shapes; written and there: of their files */
	bool weights;                                      /* of the shape at hand */
} export;

/* What became of a shape that the list named: GONE when it was deleted meanwhile. */
typedef enum { FOUND, GONE, REFUSED } found_shape;

/* ---- requests */

/* The answer, or the body in the file at path, once the server has time. What it refuses is an answer too. */
static esk_outcome ask(export *e, const esk_request *request, const char *path, esk_answer *answer)
{
	for (long waited = 0;;) {
		esk_outcome outcome = path ? esk_client_download(e->client, request, path, answer)
					   : esk_client_send(e->client, request, answer);
		if (outcome)
			return esk_complain(outcome, "%s", esk_client_complaint(e->client));
		const long seconds = esk_answer_wait(answer);
		if (seconds == 0 || waited >= ESK_WAIT_MOST)
			return ESK_DONE;
		free(answer->body);
		*answer = (esk_answer){0};
		nanosleep(&(struct timespec){.tv_sec = seconds}, NULL);
		waited += seconds;
	}
}

static esk_outcome complain_of(const char *what, const esk_answer *answer)
{
	char *detail = eskel_report_problem(answer->body, answer->size);
	esk_complain(ESK_REFUSED, "%s: %s", what, detail ? detail : "the server gave no reason");
	free(detail);
	return ESK_REFUSED;
}

static char *page_query(const export *e, const char *cursor)
{
	char *front = NULL;
	if (asprintf(&front, "&limit=1000%s%s", *cursor ? "&cursor=" : "", cursor) < 0)
		return NULL;
	char *query = esk_session_query(e->session, front);
	free(front);
	return query;
}

static esk_outcome read_page(export *e, const char *cursor, eskel_rows **rows)
{
	char *query = page_query(e, cursor);
	const esk_request request = {.path = "/shapes", .query = query};
	esk_answer answer = {0};
	esk_outcome outcome = query ? ask(e, &request, NULL, &answer) : ESK_REFUSED;
	free(query);
	if (!outcome && answer.status != 200)
		outcome = complain_of("shapes", &answer);
	if (!outcome && eskel_rows_read(answer.body, answer.size, rows))
		outcome = esk_complain(ESK_UNREACHABLE, "shapes: the answer is not one of eskeld's");
	free(answer.body);
	return outcome;
}

/* Takes every shape of the library that the filters let through. */
static esk_outcome each_shape(export *e, esk_outcome (*take)(export *e, const eskel_rows *rows, size_t row))
{
	esk_outcome outcome = ESK_DONE;
	char *cursor = strdup("");
	while (!outcome && cursor) {
		eskel_rows *rows = NULL;
		outcome = read_page(e, cursor, &rows);
		free(cursor);
		cursor = NULL;
		if (outcome)
			break;
		for (size_t i = 0; i < eskel_rows_count(rows) && !outcome; i++)
			outcome = take(e, rows, i);
		if (eskel_rows_cursor(rows) && !(cursor = strdup(eskel_rows_cursor(rows))))
			outcome = esk_complain(ESK_REFUSED, "memory ran out");
		eskel_rows_free(rows);
	}
	free(cursor);
	return outcome;
}

/* ---- one shape */

/* folder/clouds/ID[.weights].SUFFIX; NULL when memory ran out. */
static char *cloud_path(const export *e, const char *id, bool weights)
{
	char *path = NULL;
	const char *mark = weights ? ".weights" : "";
	return asprintf(&path, "%s/clouds/%s%s%s", e->folder, id, mark, e->suffix) < 0 ? NULL : path;
}

static bool is_there(const export *e, const char *id, bool weights)
{
	char *path = cloud_path(e, id, weights);
	const bool there = path && !access(path, F_OK);
	free(path);
	return there;
}

/* Puts what was written beside its place there. */
static esk_outcome put_in_place(const export *e, const char *part, const char *id, bool weights)
{
	esk_outcome outcome = ESK_DONE;
	char *path = cloud_path(e, id, weights);
	if (!path)
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	else if (rename(part, path))
		outcome = esk_complain(ESK_REFUSED, "%s: %s", path, strerror(errno));
	free(path);
	return outcome;
}

/* Asks for the file. found is FOUND, or why there is none. */
static esk_outcome download(export *e, const char *id, found_shape *found)
{
	char *part = NULL, *from = NULL, *query = NULL;
	esk_answer answer = {0};
	esk_outcome outcome = ESK_DONE;
	if (asprintf(&part, "%s/clouds/%s.part", e->folder, id) < 0 || asprintf(&from, "/shapes/%s/volume", id) < 0 ||
		asprintf(&query, "&format=%s", e->format) < 0)
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	else
		outcome = ask(e, &(esk_request){.path = from, .query = query}, part, &answer);
	if (!outcome && answer.status == 200) {
		outcome = put_in_place(e, part, id, answer.weights);
		e->weights = answer.weights;
		e->written++;
	} else if (!outcome) {
		*found = answer.status == 404 ? GONE : REFUSED;
		if (*found == REFUSED)
			complain_of(id, &answer);
	}
	free(answer.body);
	free(query);
	free(from);
	free(part);
	return outcome;
}

/* The file of its voxels, unless it is there. */
static esk_outcome fetch_cloud(export *e, const char *id, found_shape *found)
{
	e->weights = is_there(e, id, true);
	if (!e->weights && !is_there(e, id, false))
		return download(e, id, found);
	e->there++;
	return ESK_DONE;
}

/* The signature's rows without their heading. */
static esk_outcome fetch_signature(export *e, const char *id, found_shape *found)
{
	char *from = NULL;
	esk_answer answer = {0};
	if (asprintf(&from, "/shapes/%s/signature", id) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	esk_outcome outcome = ask(e, &(esk_request){.path = from, .query = "&format=csv"}, NULL, &answer);
	if (!outcome && answer.status == 404) {
		*found = GONE;
	} else if (!outcome && answer.status != 200) {
		outcome = complain_of(id, &answer);
	} else if (!outcome) {
		const char *heading_end = e->done > 0 ? strchr(answer.body, '\n') : NULL;
		fputs(heading_end ? heading_end + 1 : answer.body, e->signatures);
	}
	free(answer.body);
	free(from);
	return outcome;
}

static esk_outcome write_cell(export *e, const eskel_rows *rows, size_t row, const char *column)
{
	char *cell = eskel_rows_cell(rows, row, column);
	if (!cell)
		return esk_complain(ESK_REFUSED, "memory ran out");
	fputc(',', e->shapes);
	esk_csv_write_field(cell, e->shapes);
	free(cell);
	return ESK_DONE;
}

static esk_outcome write_row(export *e, const eskel_rows *rows, size_t row, const char *id)
{
	const char *key;
	esk_outcome outcome = ESK_DONE;
	for (size_t a = 0; (key = eskel_rows_attribute(rows, row, a)); a++)
		if (!esk_key_set_has(&e->keys, key))
			return esk_complain(ESK_REFUSED, "shapes were changed meanwhile: run the same command again");
	fprintf(e->shapes, "clouds/%s%s%s,%s", id, e->weights ? ".weights" : "", e->suffix, e->weights ? "true" : "");
	for (size_t c = 0; eskel_rows_column(c) && !outcome; c++)
		outcome = write_cell(e, rows, row, eskel_rows_column(c));
	for (size_t k = 0; k < e->keys.count && !outcome; k++) {
		char *column = NULL;
		if (asprintf(&column, "attr.%s", e->keys.keys[k]) < 0)
			return esk_complain(ESK_REFUSED, "memory ran out");
		outcome = write_cell(e, rows, row, column);
		free(column);
	}
	fputs("\r\n", e->shapes);
	return outcome;
}

/* For each_shape: the first time through. */
static esk_outcome take_keys(export *e, const eskel_rows *rows, size_t row)
{
	const char *key;
	esk_outcome outcome = ESK_DONE;
	for (size_t a = 0; (key = eskel_rows_attribute(rows, row, a)) && !outcome; a++)
		outcome = esk_key_set_add(&e->keys, key);
	e->count++;
	return outcome;
}

/* For each_shape: the second time. */
static esk_outcome take_shape(export *e, const eskel_rows *rows, size_t row)
{
	found_shape found = FOUND;
	char *id = eskel_rows_cell(rows, row, "id");
	esk_outcome outcome = id ? fetch_cloud(e, id, &found) : esk_complain(ESK_REFUSED, "memory ran out");
	if (!outcome && found == FOUND)
		outcome = fetch_signature(e, id, &found);
	if (!outcome && found == FOUND) {
		outcome = write_row(e, rows, row, id);
		e->done++;
	}
	e->gone += found == GONE;
	e->refused += found == REFUSED;
	free(id);
	esk_progress_counted(&e->session->progress, e->done, (double)e->done / (double)e->count);
	return outcome;
}

/* ---- the tables */

/* A table is written beside its place too, and takes it when it is whole. */
static FILE *open_table(const export *e, const char *name)
{
	char *part = NULL;
	if (asprintf(&part, "%s/%s.part", e->folder, name) < 0)
		return NULL;
	FILE *table = fopen(part, "we");
	if (!table)
		esk_complain(ESK_REFUSED, "%s: %s", part, strerror(errno));
	free(part);
	return table;
}

static esk_outcome close_table(const export *e, const char *name, FILE *table, esk_outcome outcome)
{
	char *path = NULL, *part = NULL;
	const bool whole = table && !ferror(table);
	if (!table)
		return ESK_REFUSED;
	if (asprintf(&path, "%s/%s", e->folder, name) < 0 || asprintf(&part, "%s.part", path) < 0)
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	if (fclose(table) || !whole || (!outcome && rename(part, path)))
		outcome = esk_outcome_worse(
			outcome, esk_complain(ESK_REFUSED, "%s/%s: %s", e->folder, name, strerror(errno)));
	free(part);
	free(path);
	return outcome;
}

static void write_heading(const export *e)
{
	fputs("path,weights", e->shapes);
	for (size_t c = 0; eskel_rows_column(c); c++)
		fprintf(e->shapes, ",%s", eskel_rows_column(c));
	for (size_t k = 0; k < e->keys.count; k++) {
		char *column = NULL;
		fputc(',', e->shapes);
		if (asprintf(&column, "attr.%s", e->keys.keys[k]) >= 0)
			esk_csv_write_field(column, e->shapes);
		free(column);
	}
	fputs("\r\n", e->shapes);
}

static esk_outcome write_all(export *e)
{
	e->shapes = open_table(e, "shapes.csv");
	e->signatures = open_table(e, "signatures.csv");
	esk_outcome outcome = e->shapes && e->signatures ? ESK_DONE : ESK_REFUSED;
	if (!outcome) {
		write_heading(e);
		outcome = each_shape(e, take_shape);
	}
	esk_progress_end(&e->session->progress, false);
	outcome = esk_outcome_worse(outcome, close_table(e, "signatures.csv", e->signatures, outcome));
	return esk_outcome_worse(outcome, close_table(e, "shapes.csv", e->shapes, outcome));
}

static esk_outcome make_folder(const char *path)
{
	if (!mkdir(path, 0777) || errno == EEXIST)
		return ESK_DONE;
	return esk_complain(ESK_REFUSED, "%s: %s", path, strerror(errno));
}

static esk_outcome make_folders(const export *e)
{
	char *clouds = NULL;
	if (asprintf(&clouds, "%s/clouds", e->folder) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	esk_outcome outcome = make_folder(e->folder);
	if (!outcome)
		outcome = make_folder(clouds);
	free(clouds);
	return outcome;
}

static esk_outcome choose_format(export *e)
{
	const char *format = esk_arguments_value(e->session->arguments, "format");
	e->format = format ? format : "nifti";
	e->suffix = strcmp(e->format, "nrrd") ? ".nii.gz" : ".nrrd";
	if (!strcmp(e->format, "nifti") || !strcmp(e->format, "nrrd"))
		return ESK_DONE;
	return esk_complain(ESK_MISUSED, "--format is %s, expected nifti or nrrd", format);
}

static esk_outcome run(export *e)
{
	esk_outcome outcome = each_shape(e, take_keys);
	if (!outcome)
		outcome = make_folders(e);
	e->session->progress.items = e->count;
	esk_progress_next(&e->session->progress, "shapes");
	if (!outcome)
		outcome = write_all(e);
	if (!outcome)
		printf("shapes  %zu: %zu files written, %zu there already%s\n", e->done, e->written, e->there,
			e->gone > 0 ? "; some were deleted meanwhile" : "");
	return outcome || e->refused == 0 ? outcome : ESK_REFUSED;
}

esk_outcome esk_command_export(esk_session *session)
{
	export e = {.session = session, .folder = session->arguments->operands[0]};
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SHAPES);
	if (!outcome)
		outcome = choose_format(&e);
	if (!outcome)
		outcome = esk_session_new_client(session, &e.client);
	if (!outcome)
		outcome = run(&e);
	esk_client_free(e.client);
	esk_key_set_clear(&e.keys);
	return outcome;
}
