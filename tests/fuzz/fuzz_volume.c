/* Any bytes of a file of FUZZ_FORMAT, which is one of those below, decoded whole and in pieces: the same status and sentence,
 * or the same clouds, whose encoding decodes, and names. What is not gzipped and can be read but for its values is read as
 * weights too, and a mesh with a spacing. And the bytes of
 * MGH files as voxels: their changes are the same with vectors and without. */
#include "../../engine/volume/changes.h"
#include "eskel.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

typedef enum { NIFTI, NRRD, METAIMAGE, MGH, MESH, GZIP } file_format;

/* A mesh is what is nothing else. */
static file_format format_of(const uint8_t *data, size_t size)
{
	static const struct {
		file_format format;
		size_t size;
		char bytes[4];
	} beginnings[] = {
		{GZIP, 1, "\x1f"},
		{NIFTI, 4, "\x5c\1\0"},
		{NIFTI, 4, "\0\0\1\x5c"},
		{NIFTI, 4, "\x1c\2\0"},
		{NIFTI, 4, "\0\0\2\x1c"},
		{MGH, 4, "\0\0\0\1"},
		{NRRD, 2, "NR"},
		{METAIMAGE, 1, "O"},
		{METAIMAGE, 1, "N"},
		{METAIMAGE, 1, "C"},
	};
	for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
		if (size >= beginnings[i].size && memcmp(data, beginnings[i].bytes, beginnings[i].size) == 0)
			return beginnings[i].format;
	return MESH;
}

typedef struct {
	bool weights;
	double spacing;
} reading;

/* In pieces: three of a byte and a longer one in turn. */
static eskel_volume *decode(const uint8_t *data, size_t size, reading how, size_t longest, eskel_error *error)
{
	/* Small, so that no input takes long. */
	const eskel_volume_options limits = {.most_voxels = 1 << 18,
		.most_runs = 1 << 14,
		.most_labels = 16,
		.weights = how.weights,
		.spacing = how.spacing};
	eskel_volume *volume = NULL;
	if (eskel_volume_new(&limits, &volume) != ESKEL_OK)
		abort();
	eskel_status status = ESKEL_OK;
	size_t pieces = 0;
	for (size_t at = 0, piece; at < size && status == ESKEL_OK; at += piece, pieces++) {
		piece = longest == size || pieces % 4 == 3 ? longest : 1;
		piece = piece < size - at ? piece : size - at;
		status = eskel_volume_feed(volume, data + at, piece, error);
	}
	if (status == ESKEL_OK)
		status = eskel_volume_finish(volume, error);
	if (status == ESKEL_OK)
		return volume;
	if (error->status != status || error->text[0] == '\0')
		abort();
	eskel_volume_free(volume);
	return NULL;
}

static void encode(const eskel_volume *volume, size_t index, uint8_t **bytes, size_t *size)
{
	int32_t label = eskel_volume_label(volume, index);
	eskel_cloud *cloud = NULL;
	unsigned sides;
	*bytes = NULL;
	*size = 0;
	if (!eskel_volume_get_info(volume)->format)
		abort();
	if (eskel_volume_border(volume, label, &sides) != ESKEL_OK)
		abort();
	/* An affine at the edge of what is allowed, or a huge offset, may be refused here. */
	if (eskel_volume_cloud(volume, label, &cloud, NULL) != ESKEL_OK)
		return;
	if (eskel_cloud_encode(cloud, bytes, size) != ESKEL_OK)
		abort();
	eskel_cloud_free(cloud);
}

static void expect_cloud(const uint8_t *bytes, size_t size)
{
	eskel_cloud *cloud = NULL;
	if (eskel_cloud_decode(bytes, size, &cloud, NULL) != ESKEL_OK)
		abort();
	eskel_cloud_free(cloud);
}

static void compare(const eskel_volume *a, const eskel_volume *b)
{
	if (eskel_volume_label_count(a) == 0 || eskel_volume_label_count(a) != eskel_volume_label_count(b))
		abort();
	for (size_t i = 0; i < eskel_volume_label_count(a); i++) {
		const char *name = eskel_volume_label_name(a, eskel_volume_label(a, i));
		const char *other_name = eskel_volume_label_name(b, eskel_volume_label(b, i));
		if (!name != !other_name || (name && (strcmp(name, other_name) != 0 || strlen(name) > 200)))
			abort();
		uint8_t *bytes, *other_bytes;
		size_t size, other_size;
		encode(a, i, &bytes, &size);
		encode(b, i, &other_bytes, &other_size);
		if (size != other_size || (size > 0 && memcmp(bytes, other_bytes, size) != 0))
			abort();
		if (bytes)
			expect_cloud(bytes, size);
		free(bytes);
		free(other_bytes);
	}
}

static eskel_status decode_twice(const uint8_t *data, size_t size, reading how)
{
	eskel_error error = {0}, other_error = {0};
	eskel_volume *whole = decode(data, size, how, size, &error);
	eskel_volume *pieces = decode(data, size, how, 1 + size / 8, &other_error);
	if (error.status != other_error.status || strcmp(error.text, other_error.text) != 0)
		abort();
	if (whole)
		compare(whole, pieces);
	eskel_volume_free(whole);
	eskel_volume_free(pieces);
	return error.status;
}

static void expect_beginning(const uint8_t *data, size_t size)
{
	uint8_t begin[132];
	if (eskel_gzip_begin(data, size, begin, sizeof begin) > sizeof begin)
		abort();
}

static void expect_changes(const uint8_t *data, size_t size)
{
	enum { largest_voxel = 8, most_bytes = 1 << 12 };
	static uint16_t offsets[most_bytes], other_offsets[most_bytes];
	size = size < most_bytes ? size : most_bytes;
	for (unsigned voxel = 1; voxel <= largest_voxel && 2 * voxel <= size; voxel *= 2) {
		const size_t whole = (size / voxel - 1) * voxel; /* all but the first */
		const size_t count = esk_changes_find(data + voxel, whole, voxel, offsets);
		if (count != esk_changes_find_plainly(data + voxel, whole, voxel, other_offsets) ||
			memcmp(offsets, other_offsets, count * sizeof *offsets) != 0)
			abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const file_format format = format_of(data, size);
	if (format != FUZZ_FORMAT)
		return 0;
	const eskel_status status = decode_twice(data, size, (reading){0});
	if (format != GZIP && (status == ESKEL_OK || status == ESKEL_BAD_VALUE))
		decode_twice(data, size, (reading){.weights = true});
	if (format == MESH)
		decode_twice(data, size, (reading){.spacing = 1});
	if (format == MGH)
		expect_changes(data, size);
	if (format == GZIP)
		expect_beginning(data, size);
	return 0;
}
