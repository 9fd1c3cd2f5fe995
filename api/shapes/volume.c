/* GET /shapes/{id}/volume: the voxels of a shape as a file that can be posted again, and is then the same shape. The file
 * is made as it is sent. */
#include "exchange.h"
#include "resources.h"

#include <stdlib.h>

/* Of a file, in one piece of the answer: some milliseconds of one processor. */
enum { PIECE = 1 << 16 };

static const struct {
	const char *content_type, *suffix;
} formats[] = {
	[ESKEL_VOLUME_NIFTI] = {"application/gzip", ".nii.gz"},
	[ESKEL_VOLUME_NRRD] = {"application/octet-stream", ".nrrd"},
};

typedef struct {
	eskel_cloud *cloud;
	eskel_volume_writer *writer;
	char bytes[PIECE];
} source;

static void free_source(void *context)
{
	source *s = context;
	eskel_volume_writer_free(s->writer);
	eskel_cloud_free(s->cloud);
	free(s);
}

/* An esk_stream's. */
static bool next(void *context, esk_text *piece)
{
	source *s = context;
	const size_t size = eskel_volume_writer_next(s->writer, s->bytes, sizeof s->bytes);
	esk_text_append(piece, s->bytes, size);
	return !piece->failed;
}

static bool open_source(eskel_exchange *exchange, eskel_volume_format format, source *s)
{
	eskel_shape shape = {0};
	eskel_store_error error = {0};
	if (!esk_shape_of_id(exchange, exchange->id, &shape))
		return false;
	const int32_t label = shape.label;
	eskel_store_status status = eskel_store_cloud(exchange->api->store, shape.key, &s->cloud, &error);
	eskel_shape_clear(&shape);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	eskel_status written = eskel_volume_writer_new(s->cloud, label, format, &s->writer);
	if (written == ESKEL_UNSUPPORTED)
		return esk_problem_set(&exchange->problem, 501,
			"shape %s has weights that no volume would give back when it is read", exchange->id);
	return esk_problem_engine(&exchange->problem, written, NULL);
}

bool esk_volume_get(eskel_exchange *exchange)
{
	const eskel_volume_format format = (eskel_volume_format)exchange->query.volume_format;
	source *s = calloc(1, sizeof *s);
	if (!s)
		return esk_problem_no_memory(&exchange->problem);
	if (!open_source(exchange, format, s) ||
		!esk_exchange_add_header(exchange, "Content-Disposition", "attachment; filename=\"%s%s%s\"",
			exchange->id, s->cloud->weights ? ".weights" : "", formats[format].suffix)) {
		free_source(s);
		return false;
	}
	const esk_stream stream = {.next = next, .free = free_source, .source = s};
	return esk_exchange_answer_stream(exchange, 200, formats[format].content_type, ESKEL_SIZE_UNKNOWN, &stream);
}
