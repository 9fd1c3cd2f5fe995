/* A cloud written as the file of a volume, piece by piece: the voxels are made out of the runs as they are deflated, so
 * memory is bounded whatever the grid's size.
 *
 * The file's grid is the cloud's own, with one empty voxel around (a reader that sees voxels on the border must fear that
 * the object was cut off). Its affine is made of floats where reading them gives the cloud back bit for bit, so that
 * NIfTI-1 holds it: the linear part of a canonical affine is, and the offset is rounded to a multiple of about a
 * thousandth of a voxel on reading (orientation.h), which forgives the float's error unless the object lies thousands of
 * voxels from the origin. */
#include "volume_writer.h"

#include "bytes.h"
#include "memory.h"
#include "orientation.h"
#include "weight_builder.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { piece_size = 1 << 15, longest_axis = UINT16_MAX };

/* Nearly all voxels are equal to their neighbours: higher levels take twice as long for a tenth of the size. */
static const int compression = Z_BEST_SPEED;
static const int gzip_window_bits = 15 + 16, memory_level = 8;

struct eskel_volume_writer {
	const eskel_cloud *cloud;
	esk_volume_grid grid;
	unsigned margin[3]; /* empty voxels before the cloud, and after it, along each axis */
	int32_t label;
	uint8_t head[ESK_VOLUME_HEAD_MOST];
	size_t head_size, head_taken;
	bool head_is_plain;          /* not part of the gzip data */
	uint64_t place, voxel_count; /* voxels made so far; in all */
	size_t run;                  /* the first that is not yet made whole */
	uint8_t piece[piece_size];
	z_stream deflating;
	bool ended;
};

/* ---------------------------------------------------------------------------------------------- the grid */

/* Whether a reader of the grid's affine finds the cloud's. */
static bool gives_cloud_back(const eskel_volume_writer *w, const eskel_affine *affine)
{
	const esk_orientation as_is = {{0, 1, 2}, {false, false, false}};
	const double origin[3] = {w->margin[0], w->margin[1], w->margin[2]};
	const eskel_affine read = esk_orientation_apply(&as_is, affine, origin);
	return memcmp(&read, &w->cloud->affine, sizeof read) == 0;
}

static void choose_affine(eskel_volume_writer *w)
{
	eskel_affine *affine = &w->grid.affine, rounded;
	*affine = w->cloud->affine;
	for (int r = 0; r < 3; r++)
		for (int a = 0; a < 3; a++)
			affine->m[r][3] -= w->margin[a] * affine->m[r][a];
	rounded = *affine;
	for (int r = 0; r < 3; r++)
		rounded.m[r][3] = (float)rounded.m[r][3];
	if (gives_cloud_back(w, &rounded))
		*affine = rounded;
}

/* What a voxel of a run is: the label, or the run's weight. */
static int32_t value_of(const eskel_volume_writer *w, size_t run)
{
	return w->cloud->weights ? (int32_t)w->cloud->weights[run] : w->label;
}

static unsigned voxel_size(const eskel_volume_writer *w)
{
	int32_t least = value_of(w, 0), greatest = least;
	for (size_t i = 1; w->cloud->weights && i < w->cloud->run_count; i++) {
		const int32_t value = value_of(w, i);
		least = value < least ? value : least;
		greatest = value > greatest ? value : greatest;
	}
	if (least >= 0 && greatest <= UINT8_MAX)
		return 1;
	return least >= INT16_MIN && greatest <= INT16_MAX ? 2 : 4;
}

static void choose_grid(eskel_volume_writer *w)
{
	w->voxel_count = 1;
	for (int a = 0; a < 3; a++) {
		w->margin[a] = w->cloud->extent[a] + 2u <= longest_axis;
		w->grid.extent[a] = w->cloud->extent[a] + 2 * w->margin[a];
		w->voxel_count *= w->grid.extent[a];
	}
	w->grid.voxel_size = voxel_size(w);
	choose_affine(w);
}

/* ---------------------------------------------------------------------------------------------- the voxels */

static uint64_t place_of(const eskel_volume_writer *w, const eskel_run *run, unsigned x)
{
	const uint64_t row = (run->z + w->margin[2]) * (uint64_t)w->grid.extent[1] + run->y + w->margin[1];
	return row * w->grid.extent[0] + x + w->margin[0];
}

/* Voxels first to last of the piece. */
static void put_value(eskel_volume_writer *w, int32_t value, size_t first, size_t last)
{
	uint8_t bytes[4];
	esk_bytes_put_u32(bytes, (uint32_t)value);
	for (size_t i = first; i <= last; i++)
		memcpy(&w->piece[i * w->grid.voxel_size], bytes, w->grid.voxel_size);
}

/* The next voxels, as many as fit into the piece. */
static size_t make_piece(eskel_volume_writer *w)
{
	const uint64_t left = w->voxel_count - w->place, fitting = piece_size / w->grid.voxel_size;
	const uint64_t begin = w->place, end = begin + (left < fitting ? left : fitting);
	const size_t size = (size_t)(end - begin) * w->grid.voxel_size;
	memset(w->piece, 0, size);
	for (; w->run < w->cloud->run_count; w->run++) {
		const eskel_run *run = &w->cloud->runs[w->run];
		const uint64_t first = place_of(w, run, run->x_first), last = place_of(w, run, run->x_last);
		if (first >= end)
			break;
		put_value(w, value_of(w, w->run), (size_t)((first > begin ? first : begin) - begin),
			(size_t)((last < end ? last : end - 1) - begin));
		if (last >= end)
			break;
	}
	w->place = end;
	return size;
}

/* ---------------------------------------------------------------------------------------------- the file */

eskel_status eskel_volume_writer_new(
	const eskel_cloud *cloud, int32_t label, eskel_volume_format format, eskel_volume_writer **writer)
{
	const bool kept = !cloud->weights || (label == 1 && esk_weight_builder_keeps(cloud->weights, cloud->run_count));
	if (!kept || label == 0)
		return ESKEL_UNSUPPORTED;
	eskel_volume_writer *w = esk_memory_zeroed_array(1, sizeof *w);
	if (!w || deflateInit2(&w->deflating, compression, Z_DEFLATED, gzip_window_bits, memory_level,
			  Z_DEFAULT_STRATEGY) != Z_OK) {
		free(w);
		return ESKEL_NO_MEMORY;
	}
	w->cloud = cloud;
	w->label = label;
	choose_grid(w);
	w->head_is_plain = format == ESKEL_VOLUME_NRRD;
	w->head_size = (w->head_is_plain ? esk_nrrd_write_head : esk_nifti_write_head)(&w->grid, w->head);
	*writer = w;
	return ESKEL_OK;
}

void eskel_volume_writer_free(eskel_volume_writer *writer)
{
	if (!writer)
		return;
	deflateEnd(&writer->deflating);
	free(writer);
}

/* What is to be deflated next. */
static void refill(eskel_volume_writer *w)
{
	z_stream *s = &w->deflating;
	if (w->head_taken < w->head_size) {
		s->next_in = w->head;
		s->avail_in = (uInt)w->head_size;
		w->head_taken = w->head_size;
	} else {
		s->next_in = w->piece;
		s->avail_in = (uInt)make_piece(w);
	}
}

static size_t take_plain_head(eskel_volume_writer *w, uint8_t *bytes, size_t capacity)
{
	const size_t left = w->head_size - w->head_taken, taken = left < capacity ? left : capacity;
	memcpy(bytes, w->head + w->head_taken, taken);
	w->head_taken += taken;
	return taken;
}

size_t eskel_volume_writer_next(eskel_volume_writer *writer, void *bytes, size_t capacity)
{
	z_stream *s = &writer->deflating;
	const size_t most = capacity < piece_size ? capacity : piece_size;
	if (writer->head_is_plain && writer->head_taken < writer->head_size)
		return take_plain_head(writer, bytes, most);
	s->next_out = bytes;
	s->avail_out = (uInt)most;
	while (s->avail_out > 0 && !writer->ended) {
		if (s->avail_in == 0)
			refill(writer);
		const bool last = writer->place == writer->voxel_count;
		writer->ended = deflate(s, last ? Z_FINISH : Z_NO_FLUSH) == Z_STREAM_END;
	}
	return most - s->avail_out;
}
