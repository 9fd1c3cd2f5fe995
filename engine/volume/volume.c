/* The push decoder: bytes in pieces of any size -> decompressed -> header -> voxels, decompressed or read as text -> runs
 * per label.
 *
 * Each stage keeps only what it cannot yet pass on: a decompressor a fixed window, the header stage the header's bytes,
 * the voxel stage (voxel_runs.h) the broken-off voxel, or number, at the end of a piece. So memory is bounded by the
 * runs, and the result, including which error a bad file gives, does not depend on how the file was cut: each stage sees
 * every byte before the fault and none after it. (But for two bytes where gzip data break off: see inflater.h.)
 *
 * A further format is one more esk_header_reader (volume_format.h) in the list below. What none of them knows may be a mesh
 * (solid_reader.h): its triangles are gathered, and become runs at the end (solid_volume.h).
 */
#include "decompressor.h"
#include "error.h"
#include "gzip.h"
#include "memory.h"
#include "number_text.h"
#include "solid_volume.h"
#include "voxel_runs.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t default_most_voxels = (uint64_t)1 << 33;
static const size_t default_most_runs = (size_t)1 << 27;
static const uint32_t default_most_labels = 4096;

/* What a few kilobytes can unfold to is decoded in seconds, whatever it is: inflating runs at gigabytes a second, but
 * bzip2 and text (number_text.c) do not. */
static const uint64_t most_bzip2_bytes = (uint64_t)1 << 30;

enum { shortest_header = 4, largest_footer = 1 << 20 };

static const struct {
	esk_header_reader *read;
	bool in_lines;
} header_readers[] = {
	{esk_nifti_read_header, false},
	{esk_nrrd_read_header, true},
	{esk_metaimage_read_header, true},
	{esk_mgh_read_header, false},
};

typedef enum { IN_HEADER, BEFORE_VOXELS, IN_VOXELS, IN_MESH, IN_RUNS, FINISHED } phase;

struct eskel_volume {
	phase phase;
	eskel_error error; /* status other than ESKEL_OK: every further call returns it */
	esk_solid_volume_limits limits;
	double spacing; /* of a mesh's voxels; 0: to be chosen */

	bool begun;             /* the first byte has come */
	esk_decompressor *file; /* NULL: the file is not gzipped */

	uint8_t *header_bytes;
	size_t header_size, header_capacity, header_needed;
	size_t reader; /* of header_readers: those before it have said that the header is not theirs */
	esk_volume_header header;

	esk_decompressor *voxels; /* NULL: the voxels are not compressed behind the header */
	esk_number_text text;
	uint64_t bytes_left; /* of the present phase: before the voxels, of the voxels as they are decoded */
	esk_voxel_runs *runs;
	uint8_t *footer_bytes;
	size_t footer_size, footer_capacity;
	esk_solid_reader *solid; /* NULL: no mesh */
	const esk_label_table *labels;
};

eskel_status eskel_volume_new(const eskel_volume_options *options, eskel_volume **volume)
{
	const eskel_volume_options none = {0}, *o = options ? options : &none;
	for (size_t i = 0; i < o->label_count; i++)
		if (o->labels[i] == 0)
			return ESKEL_INVALID;
	if (!(o->spacing >= 0))
		return ESKEL_INVALID;
	eskel_volume *v = esk_memory_zeroed_array(1, sizeof *v);
	if (!v)
		return ESKEL_NO_MEMORY;
	v->spacing = o->spacing;
	v->header_needed = shortest_header;
	const esk_run_limits limits = {
		.most_runs = o->most_runs ? o->most_runs : default_most_runs,
		.most_labels = o->most_labels ? o->most_labels : default_most_labels,
	};
	v->limits = (esk_solid_volume_limits){
		.voxels = o->most_voxels ? o->most_voxels : default_most_voxels,
		.runs = limits.most_runs,
	};
	eskel_status status = esk_voxel_runs_new(&limits, o->labels, o->label_count, o->weights, &v->runs);
	if (status != ESKEL_OK) {
		eskel_volume_free(v);
		return status;
	}
	*volume = v;
	return ESKEL_OK;
}

void eskel_volume_free(eskel_volume *volume)
{
	if (!volume)
		return;
	esk_decompressor_free(volume->file);
	esk_decompressor_free(volume->voxels);
	free(volume->header_bytes);
	free(volume->footer_bytes);
	esk_segments_clear(&volume->header.segments);
	esk_voxel_runs_free(volume->runs);
	esk_solid_reader_free(volume->solid);
	free(volume);
}

static eskel_status take_footer(eskel_volume *v, const uint8_t *bytes, size_t size, eskel_error *error)
{
	if (!v->header.read_footer)
		return esk_error_set(error, ESKEL_MALFORMED, "the file goes on after its last voxel");
	if (size > largest_footer - v->footer_size)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the file goes on after its last voxel, expected a footer of at most %d bytes", largest_footer);
	void *footer_bytes = v->footer_bytes;
	if (!esk_memory_reserve(&footer_bytes, &v->footer_capacity, v->footer_size + size, 1))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out in the footer");
	v->footer_bytes = footer_bytes;
	memcpy(v->footer_bytes + v->footer_size, bytes, size);
	v->footer_size += size;
	return ESKEL_OK;
}

static eskel_status take_voxels(void *volume, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_volume *v = volume;
	size_t taken = v->bytes_left < size ? (size_t)v->bytes_left : size;
	v->bytes_left -= taken;
	eskel_status status = esk_voxel_runs_add(v->runs, bytes, taken, error);
	if (status == ESKEL_OK && taken < size)
		status = take_footer(v, bytes + taken, size - taken, error);
	return status;
}

static eskel_status begin_decompression(
	esk_compression compression, esk_decompressor **decompressor, eskel_error *error)
{
	if (esk_decompressor_new(compression, decompressor) != ESKEL_OK)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for decompressing");
	return ESKEL_OK;
}

static eskel_status begin_voxels(eskel_volume *v, eskel_error *error)
{
	const uint32_t *extent = v->header.info.extent; /* at most 65535 each, so the product fits */
	v->phase = IN_VOXELS;
	v->bytes_left = (uint64_t)extent[0] * extent[1] * extent[2] * esk_volume_voxel_size(&v->header);
	return v->header.compressed ? begin_decompression(v->header.compression, &v->voxels, error) : ESKEL_OK;
}

/* From the first byte of the file on: what lies before the voxels, the voxels, nothing. */
static eskel_status take_body(eskel_volume *v, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	if (v->phase == BEFORE_VOXELS) {
		size_t skipped = v->bytes_left < size ? (size_t)v->bytes_left : size;
		v->bytes_left -= skipped;
		bytes += skipped;
		size -= skipped;
		if (v->bytes_left == 0)
			status = begin_voxels(v, error);
	}
	if (status != ESKEL_OK || size == 0)
		return status;
	if (v->voxels)
		return esk_decompressor_feed(v->voxels, bytes, size, take_voxels, v, error);
	if (v->header.text)
		return esk_number_text_feed(&v->text, bytes, size, take_voxels, v, error);
	return take_voxels(v, bytes, size, error);
}

static eskel_status refuse_format(const eskel_volume *v, eskel_error *error)
{
	const uint8_t *bytes = v->header_bytes;
	return esk_error_set(error, ESKEL_NOT_VOLUME,
		"the file begins with %02x %02x %02x %02x, expected a NIfTI-1, NIfTI-2, NRRD, MetaImage or MGH "
		"file, or an STL, PLY or OBJ mesh",
		bytes[0], bytes[1], bytes[2], bytes[3]);
}

static eskel_status take_mesh(eskel_volume *v, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_status status = esk_solid_reader_feed(v->solid, bytes, size, error);
	return status == ESKEL_NOT_VOLUME ? refuse_format(v, error) : status;
}

static eskel_status begin_mesh(eskel_volume *v, eskel_error *error)
{
	if (esk_solid_reader_new(&v->solid) != ESKEL_OK)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a mesh");
	v->phase = IN_MESH;
	return take_mesh(v, v->header_bytes, v->header_size, error);
}

static eskel_status check_size(const eskel_volume *v, eskel_error *error)
{
	const uint32_t *extent = v->header.info.extent;
	const uint64_t voxels = (uint64_t)extent[0] * extent[1] * extent[2];
	if (v->spacing > 0)
		return esk_error_set(error, ESKEL_BAD_GEOMETRY,
			"the spacing of %g mm is for meshes, a %s file has its own: expected none", v->spacing,
			v->header.info.format);
	eskel_status status = esk_volume_check_extent(extent, v->limits.voxels, error);
	if (status != ESKEL_OK)
		return status;
	if (voxels * v->header.layer_count > v->limits.voxels)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the grid has %llu voxels in %u layers, expected at most %llu in all",
			(unsigned long long)voxels, v->header.layer_count, (unsigned long long)v->limits.voxels);
	const uint64_t bytes = voxels * esk_volume_voxel_size(&v->header);
	if (v->header.compressed && v->header.compression == ESK_COMPRESSION_BZIP2 && bytes > most_bzip2_bytes)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the voxels take %llu bytes, expected at most %llu in bzip2 and another encoding for more",
			(unsigned long long)bytes, (unsigned long long)most_bzip2_bytes);
	return ESKEL_OK;
}

static eskel_status begin_body(eskel_volume *v, eskel_error *error)
{
	eskel_status status = check_size(v, error);
	if (status == ESKEL_OK)
		status = esk_voxel_runs_begin(v->runs, &v->header, error);
	if (status != ESKEL_OK)
		return status;
	v->header.info.gzipped = v->file != NULL;
	v->phase = BEFORE_VOXELS;
	v->bytes_left = v->header.data_offset;
	return take_body(v, v->header_bytes, v->header_size, error);
}

/* Once the header is complete, what follows it. */
static eskel_status read_header(eskel_volume *v, eskel_error *error)
{
	const uint8_t *bytes = v->header_bytes;
	eskel_status status = ESKEL_NOT_VOLUME;
	for (size_t i = v->reader; i < sizeof header_readers / sizeof *header_readers && status == ESKEL_NOT_VOLUME;
		i++) {
		status = header_readers[i].read(bytes, v->header_size, &v->header_needed, &v->header, error);
		v->reader = i;
	}
	if (status == ESKEL_NOT_VOLUME)
		return esk_solid_may_begin(bytes) ? begin_mesh(v, error) : refuse_format(v, error);
	if (status == ESKEL_OK && v->header_size >= v->header_needed)
		status = begin_body(v, error);
	return status;
}

/* Takes what is needed, or its next line. *looked_for: there is what the reader waits for. */
static eskel_status take_header(
	eskel_volume *v, const uint8_t **bytes, size_t *size, bool *looked_for, eskel_error *error)
{
	const size_t missing = v->header_needed - v->header_size, most = *size < missing ? *size : missing;
	const uint8_t *end = header_readers[v->reader].in_lines ? memchr(*bytes, '\n', most) : NULL;
	const size_t taken = end ? (size_t)(end - *bytes) + 1 : most;
	void *header_bytes = v->header_bytes;
	if (!esk_memory_reserve(&header_bytes, &v->header_capacity, v->header_size + taken, 1))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out in the header");
	v->header_bytes = header_bytes;
	memcpy(v->header_bytes + v->header_size, *bytes, taken);
	v->header_size += taken;
	*bytes += taken;
	*size -= taken;
	*looked_for = end || taken == missing;
	return ESKEL_OK;
}

static eskel_status take_file(void *volume, const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_volume *v = volume;
	while (v->phase == IN_HEADER && size > 0) {
		bool looked_for = false;
		eskel_status status = take_header(v, &bytes, &size, &looked_for, error);
		if (status == ESKEL_OK && looked_for)
			status = read_header(v, error);
		if (status != ESKEL_OK)
			return status;
	}
	return v->phase == IN_MESH ? take_mesh(v, bytes, size, error) : take_body(v, bytes, size, error);
}

/* The first byte tells gzip from everything else. */
static eskel_status begin(eskel_volume *v, uint8_t first_byte, eskel_error *error)
{
	v->begun = true;
	return first_byte == ESK_GZIP_FIRST_BYTE ? begin_decompression(ESK_COMPRESSION_GZIP, &v->file, error)
						 : ESKEL_OK;
}

/* The error of every failed call is kept in the volume first. */
static eskel_status report(const eskel_volume *v, eskel_error *error)
{
	if (v->error.status != ESKEL_OK && error)
		*error = v->error;
	return v->error.status;
}

eskel_status eskel_volume_feed(eskel_volume *volume, const void *bytes, size_t size, eskel_error *error)
{
	eskel_error *kept = &volume->error;
	if (kept->status == ESKEL_OK && volume->phase >= IN_RUNS)
		return esk_error_set(error, ESKEL_INVALID, "the volume %s, no bytes were expected",
			volume->phase == FINISHED ? "is finished" : "is made of runs");
	if (kept->status != ESKEL_OK || size == 0)
		return report(volume, error);
	if (!volume->begun)
		begin(volume, *(const uint8_t *)bytes, kept);
	if (kept->status == ESKEL_OK && volume->file)
		esk_decompressor_feed(volume->file, bytes, size, take_file, volume, kept);
	else if (kept->status == ESKEL_OK)
		take_file(volume, bytes, size, kept);
	return report(volume, error);
}

/* ---- runs in place of bytes */

static eskel_status begin_runs(eskel_volume *v, const eskel_volume_info *info, eskel_error *error)
{
	if (v->begun)
		return esk_error_set(error, ESKEL_INVALID, "the volume has begun, no runs were expected");
	if (!esk_voxel_runs_builder(v->runs))
		return esk_error_set(
			error, ESKEL_UNSUPPORTED, "the file has segments of whole voxels, expected one weight a voxel");
	for (int c = 0; c < 3; c++)
		if (info->extent[c] < 1 || info->extent[c] > UINT16_MAX)
			return esk_error_set(error, ESKEL_TOO_LARGE, "the grid's extent is %u, expected 1 to 65535",
				info->extent[c]);
	eskel_status status = eskel_affine_check(&info->affine, error);
	v->begun = true;
	v->phase = IN_RUNS;
	v->header.info = *info;
	v->header.layer_count = 1;
	return status == ESKEL_OK ? check_size(v, error) : status;
}

eskel_status eskel_volume_begin_runs(eskel_volume *volume, const eskel_volume_info *info, eskel_error *error)
{
	if (volume->error.status == ESKEL_OK)
		begin_runs(volume, info, &volume->error);
	return report(volume, error);
}

eskel_status eskel_volume_name_label(eskel_volume *volume, int32_t label, const char *name, eskel_error *error)
{
	const esk_segment segment = {.label = label, .value = label, .name = (char *)name};
	if (volume->error.status == ESKEL_OK && esk_segments_add(&volume->header.segments, &segment) != ESKEL_OK)
		esk_error_set(&volume->error, ESKEL_NO_MEMORY, "memory ran out for the name of label %d", (int)label);
	return report(volume, error);
}

eskel_status eskel_volume_add_run(eskel_volume *volume, int32_t label, eskel_run run, eskel_error *error)
{
	const uint32_t *extent = volume->header.info.extent;
	if (volume->error.status != ESKEL_OK)
		return report(volume, error);
	if (volume->phase != IN_RUNS || run.x_first > run.x_last || run.x_last >= extent[0] || run.y >= extent[1] ||
		run.z >= extent[2])
		esk_error_set(&volume->error, ESKEL_INVALID, "the run of label %d at (%d, %d, %d) is outside the grid",
			(int)label, run.x_first, run.y, run.z);
	else
		esk_run_builder_add_run(esk_voxel_runs_builder(volume->runs), label, run, &volume->error);
	return report(volume, error);
}

/* ---- the end */

static eskel_status check_complete(const eskel_volume *v, eskel_error *error)
{
	if (!v->begun)
		return esk_error_set(error, ESKEL_TRUNCATED, "the file is empty");
	if (v->phase == IN_RUNS)
		return ESKEL_OK;
	if (v->file && !esk_decompressor_is_complete(v->file))
		return esk_error_set(error, ESKEL_TRUNCATED, "the gzip data breaks off");
	if (v->phase == IN_HEADER)
		return esk_error_set(
			error, ESKEL_TRUNCATED, "the file ends after %zu bytes, within its header", v->header_size);
	if (v->phase == BEFORE_VOXELS)
		return esk_error_set(error, ESKEL_TRUNCATED, "the file ends before byte %llu, its first voxel",
			(unsigned long long)v->header.data_offset);
	if (v->voxels && !esk_decompressor_is_complete(v->voxels))
		return esk_error_set(error, ESKEL_TRUNCATED, "the %s data of the voxels breaks off",
			esk_decompressor_name(v->voxels));
	if (v->bytes_left > 0 && v->header.text)
		return esk_error_set(error, ESKEL_TRUNCATED, "the file ends %llu voxels before the end of its text",
			(unsigned long long)(v->bytes_left / esk_volume_voxel_size(&v->header)));
	if (v->bytes_left > 0)
		return esk_error_set(error, ESKEL_TRUNCATED, "the file ends %llu bytes before the end of its voxels",
			(unsigned long long)v->bytes_left);
	return ESKEL_OK;
}

static eskel_status finish_mesh(eskel_volume *v, eskel_error *error)
{
	const esk_solid *solid;
	eskel_status status = esk_solid_reader_finish(v->solid, &solid, error);
	if (status == ESKEL_NOT_VOLUME)
		return refuse_format(v, error);
	esk_run_builder *builder = esk_voxel_runs_builder(v->runs);
	if (status == ESKEL_OK && !builder)
		return esk_error_set(error, ESKEL_UNSUPPORTED, "the file is a mesh, expected a volume of weights");
	v->header.info.format = esk_solid_reader_format(v->solid);
	v->header.info.gzipped = v->file != NULL;
	if (status == ESKEL_OK)
		status = esk_solid_volume(solid, esk_solid_reader_space(v->solid), v->spacing, &v->limits, builder,
			&v->header.info, error);
	return status;
}

static eskel_status finish_labels(eskel_volume *v, eskel_error *error)
{
	eskel_status status = esk_voxel_runs_finish(v->runs, &v->labels, error);
	if (status == ESKEL_OK && v->header.read_footer)
		status = v->header.read_footer(v->footer_bytes, v->footer_size, v->labels, &v->header, error);
	return status;
}

eskel_status eskel_volume_finish(eskel_volume *volume, eskel_error *error)
{
	if (volume->phase == FINISHED || volume->error.status != ESKEL_OK)
		return report(volume, error);
	if (volume->phase == IN_VOXELS && volume->header.text)
		esk_number_text_finish(&volume->text, take_voxels, volume, &volume->error);
	if (volume->error.status == ESKEL_OK)
		check_complete(volume, &volume->error);
	if (volume->error.status == ESKEL_OK && volume->solid)
		finish_mesh(volume, &volume->error);
	if (volume->error.status == ESKEL_OK) {
		finish_labels(volume, &volume->error);
		volume->phase = FINISHED;
	}
	return report(volume, error);
}

const char *eskel_volume_label_name(const eskel_volume *volume, int32_t label)
{
	return esk_segments_name(&volume->header.segments, label);
}

const eskel_volume_info *eskel_volume_get_info(const eskel_volume *volume)
{
	return &volume->header.info;
}

size_t eskel_volume_label_count(const eskel_volume *volume)
{
	return volume->labels ? volume->labels->count : 0;
}

int32_t eskel_volume_label(const eskel_volume *volume, size_t index)
{
	return volume->labels->items[index].label;
}

static const esk_label_runs *runs_of(const eskel_volume *v, int32_t label)
{
	return v->labels ? esk_label_table_find(v->labels, label) : NULL;
}

eskel_status eskel_volume_border(const eskel_volume *volume, int32_t label, unsigned *sides)
{
	const esk_label_runs *found = runs_of(volume, label);
	if (!found)
		return ESKEL_NOT_FOUND;
	const uint32_t *extent = volume->header.info.extent;
	unsigned touched = 0;
	for (size_t i = 0; i < found->count; i++) {
		const eskel_run *r = &found->runs[i];
		touched |= (unsigned)(r->x_first == 0) | (unsigned)(r->x_last == extent[0] - 1) << 1;
		touched |= (unsigned)(r->y == 0) << 2 | (unsigned)(r->y == extent[1] - 1) << 3;
		touched |= (unsigned)(r->z == 0) << 4 | (unsigned)(r->z == extent[2] - 1) << 5;
	}
	*sides = volume->solid ? 0 : touched; /* a mesh is whole */
	return ESKEL_OK;
}

eskel_status eskel_volume_cloud(const eskel_volume *volume, int32_t label, eskel_cloud **cloud, eskel_error *error)
{
	const esk_label_runs *found = runs_of(volume, label);
	if (!found)
		return esk_error_set(error, ESKEL_NOT_FOUND, "no voxel has label %d", label);
	const uint32_t *weights = esk_voxel_runs_weights(volume->runs);
	return eskel_cloud_new(found->runs, weights, found->count, &volume->header.info.affine, cloud, error);
}
