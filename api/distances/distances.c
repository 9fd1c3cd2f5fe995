/* GET /distances: the distances of rows to columns, each side the shapes that are named or that a filter leaves.
 *
 * A matrix is computed and written a piece at a time. A small one is answered whole; of a larger one the body is
 * streamed, so that neither side of it needs to fit into memory: what is kept are the names and the piece. A picture
 * (picture.h) needs the whole matrix and has a limit. */
#include "exchange.h"
#include "matrix.h"
#include "picture.h"
#include "resources.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum {
	PIECE = 1 << 15, /* cells: a third of a second of one processor, so that a client that is gone is soon noticed
				  and others get their turn */
	MOST_SHAPES = 100000, /* on a side: 20 MB of names */
};

/* ---------------------------------------------------------------------------------------------- the format */

static const struct {
	const char *media_type;
	unsigned format;
} media_types[] = {
	{"application/json", ESK_FORMAT_JSON},
	{"text/csv", ESK_FORMAT_CSV},
	{"application/x-npy", ESK_FORMAT_NPY},
	{"application/octet-stream", ESK_FORMAT_NPY},
	{"image/svg+xml", ESK_FORMAT_SVG},
};

/* The format that is asked for, else the first above that the client mentions. */
static unsigned choose_format(const eskel_exchange *exchange)
{
	const char *accept = esk_exchange_request_header(exchange, "Accept");
	if (exchange->query.format != ESK_FORMAT_UNSAID)
		return exchange->query.format;
	for (size_t i = 0; accept && i < sizeof media_types / sizeof *media_types; i++)
		if (strstr(accept, media_types[i].media_type))
			return media_types[i].format;
	return ESK_FORMAT_JSON;
}

static bool check_columns(eskel_exchange *exchange)
{
	const esk_parameters *columns = exchange->query.columns;
	if (!columns)
		return true;
	const eskel_filter filter = esk_parameters_filter(columns);
	if (!eskel_filter_is_none(&filter) + (columns->id_count > 0) + columns->all <= 1)
		return true;
	return esk_problem_set(&exchange->problem, 400,
		"columns are chosen in two ways, expected one of columns=all, columns.id and a filter");
}

bool esk_distances_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	const eskel_filter filter = esk_parameters_filter(query);
	if (query->id_count > 0 && !eskel_filter_is_none(&filter))
		return esk_problem_set(&exchange->problem, 400, "id is given beside a filter, expected one of the two");
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level beside it", query->level);
	if (query->plot != ESK_PLOT_UNSAID && choose_format(exchange) != ESK_FORMAT_SVG)
		return esk_problem_set(
			&exchange->problem, 400, "plot is given without a use, expected format=svg beside it");
	return check_columns(exchange);
}

/* ---------------------------------------------------------------------------------------------- the matrix */

typedef struct {
	esk_matrix matrix;
	eskel_distance_table *table;
	const esk_matrix_format *format;
	size_t cell, cell_count; /* written so far; in all */
	bool begun, ended;
	double *distances; /* [PIECE] */
} source;

static void clear_matrix(source *s)
{
	eskel_distance_table_free(s->table);
	esk_selection_clear(&s->matrix.rows);
	esk_selection_clear(&s->matrix.others);
	s->table = NULL;
	s->matrix = (esk_matrix){0};
}

static void free_source(void *context)
{
	source *s = context;
	clear_matrix(s);
	free(s->distances);
	free(s);
}

static bool read_matrix(eskel_exchange *exchange, esk_matrix *matrix)
{
	const esk_parameters *query = &exchange->query;
	matrix->square = !query->columns;
	return esk_selection_read(exchange, query, MOST_SHAPES, &matrix->rows) &&
	       (matrix->square || esk_selection_read(exchange, query->columns, MOST_SHAPES, &matrix->others));
}

static eskel_status open_table(const eskel_exchange *exchange, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, eskel_distance_table **table)
{
	const eskel_distance_table_options options = {
		.distance = esk_parameters_distance(&exchange->query), .threads = ESKEL_THREADS_ONLINE};
	return eskel_distance_table_new(
		exchange->api->library, rows, row_count, columns, column_count, &options, table);
}

/* For a picture every two of rows and columns together. */
static eskel_status open_drawn_table(const eskel_exchange *exchange, source *s)
{
	const esk_selection *rows = &s->matrix.rows, *others = &s->matrix.others;
	const size_t count = rows->count + others->count;
	int64_t *keys = calloc(count + 1, sizeof *keys);
	if (!keys)
		return ESKEL_NO_MEMORY;
	if (rows->count > 0)
		memcpy(keys, rows->keys, rows->count * sizeof *keys);
	if (others->count > 0)
		memcpy(keys + rows->count, others->keys, others->count * sizeof *keys);
	eskel_status status = open_table(exchange, keys, count, keys, count, &s->table);
	free(keys);
	s->cell_count = count * count;
	return status;
}

static eskel_status open_written_table(const eskel_exchange *exchange, source *s)
{
	const esk_selection *rows = &s->matrix.rows, *columns = esk_matrix_columns(&s->matrix);
	s->cell_count = rows->count * columns->count;
	return open_table(exchange, rows->keys, rows->count, columns->keys, columns->count, &s->table);
}

static bool open_source(eskel_exchange *exchange, source *s)
{
	eskel_status status = ESKEL_NOT_FOUND;
	for (int attempt = 0; attempt < ESK_MOST_ATTEMPTS && status == ESKEL_NOT_FOUND; attempt++) {
		clear_matrix(s);
		if (attempt > 0)
			esk_api_wait_for_changes(exchange->api);
		if (!read_matrix(exchange, &s->matrix))
			return false;
		status = s->format ? open_written_table(exchange, s) : open_drawn_table(exchange, s);
	}
	if (status == ESKEL_NOT_FOUND)
		return esk_problem_set(&exchange->problem, 503, "the shapes keep changing; try again later");
	return esk_problem_engine(&exchange->problem, status, NULL);
}

/* ---------------------------------------------------------------------------------------------- as text or numbers */

/* An esk_stream's. */
static bool next(void *context, esk_text *piece)
{
	source *s = context;
	size_t count = 0;
	if (!s->begun) {
		s->format->begin(piece, &s->matrix);
		s->begun = true;
	} else if (s->cell < s->cell_count) {
		if (eskel_distance_table_next(s->table, PIECE, s->distances, &count))
			return false;
		s->format->cells(piece, &s->matrix, s->cell, s->distances, count);
		s->cell += count;
	} else if (!s->ended) {
		s->format->end(piece, &s->matrix);
		s->ended = true;
	}
	return !piece->failed;
}

/* An esk_stream's. */
static double progress(const void *context)
{
	const source *s = context;
	return s->cell_count ? (double)s->cell / (double)s->cell_count : 1;
}

static bool answer_whole(eskel_exchange *exchange, source *s)
{
	esk_text body = {0};
	bool good = true;
	while (good && !s->ended)
		good = next(s, &body);
	if (good)
		return esk_exchange_answer(exchange, 200, s->format->content_type, body.bytes, body.size);
	free(body.bytes);
	return esk_problem_no_memory(&exchange->problem);
}

/* Takes the source. */
static bool answer_streamed(eskel_exchange *exchange, source *s)
{
	const esk_stream stream = {.next = next, .free = free_source, .progress = progress, .source = s};
	size_t size = ESKEL_SIZE_UNKNOWN;
	if (s->format->cell_size > 0) {
		esk_text head = {0};
		s->format->begin(&head, &s->matrix);
		size = head.size + s->cell_count * s->format->cell_size;
		free(head.bytes);
	}
	return esk_exchange_answer_stream(exchange, 200, s->format->content_type, size, &stream);
}

/* Takes the source in any case. */
static bool answer_written(eskel_exchange *exchange, source *s)
{
	const size_t columns = esk_matrix_columns(&s->matrix)->count;
	s->distances = calloc(PIECE, sizeof *s->distances);
	bool good = s->distances || esk_problem_no_memory(&exchange->problem);
	good = good && esk_exchange_add_header(exchange, "Eskel-Rows", "%zu", s->matrix.rows.count) &&
	       esk_exchange_add_header(exchange, "Eskel-Columns", "%zu", columns);
	if (good && s->cell_count > PIECE)
		return answer_streamed(exchange, s);
	good = good && answer_whole(exchange, s);
	free_source(s);
	return good;
}

/* ---------------------------------------------------------------------------------------------- as a picture */

static bool draw(eskel_exchange *exchange, source *s, esk_text *text)
{
	const size_t count = s->matrix.rows.count + s->matrix.others.count;
	const uint64_t most = exchange->api->options.most_distances;
	if (s->cell_count > most)
		return esk_problem_set(&exchange->problem, 413,
			"a picture of %zu shapes needs %zu distances, expected at most %" PRIu64, count, s->cell_count,
			most);
	double *distances = calloc(s->cell_count + 1, sizeof *distances);
	eskel_status status = distances ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t done = 0, more = 1; status == ESKEL_OK && more > 0; done += more)
		status = eskel_distance_table_next(s->table, SIZE_MAX, distances + done, &more);
	if (status == ESKEL_OK)
		status = (exchange->query.plot == ESK_PLOT_MAP ? esk_picture_map : esk_picture_heatmap)(
			text, &s->matrix, distances);
	free(distances);
	return esk_problem_engine(&exchange->problem, status, NULL);
}

/* Takes the source. */
static bool answer_drawn(eskel_exchange *exchange, source *s)
{
	esk_text text = {0};
	bool good = draw(exchange, s, &text) && (!text.failed || esk_problem_no_memory(&exchange->problem));
	free_source(s);
	if (good)
		return esk_exchange_answer(exchange, 200, "image/svg+xml", text.bytes, text.size);
	free(text.bytes);
	return false;
}

bool esk_distances_get(eskel_exchange *exchange)
{
	static const esk_matrix_format *const formats[] = {
		[ESK_FORMAT_JSON] = &esk_matrix_json,
		[ESK_FORMAT_CSV] = &esk_matrix_csv,
		[ESK_FORMAT_NPY] = &esk_matrix_npy,
		[ESK_FORMAT_SVG] = NULL,
	};
	source *s = calloc(1, sizeof *s);
	if (!s)
		return esk_problem_no_memory(&exchange->problem);
	s->format = formats[choose_format(exchange)];
	if (!open_source(exchange, s) || !esk_exchange_add_header(exchange, "Vary", "Accept")) {
		free_source(s);
		return false;
	}
	return s->format ? answer_written(exchange, s) : answer_drawn(exchange, s);
}
