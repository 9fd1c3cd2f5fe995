/* Any bytes as what DCMTK's program writes, in one piece and in pieces: the same status and sentence, or the same
 * labels, of clouds that encode. */
#include "../../api/dicom/data_set.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

/* Small, so that no input takes long. */
static const eskel_volume_options limits = {.most_voxels = 1 << 18, .most_runs = 1 << 14, .most_labels = 64};

typedef struct {
	const uint8_t *bytes;
	size_t size, piece;
} input;

static eskel_status get(void *source, uint8_t *bytes, size_t most, size_t *got, eskel_error *error)
{
	input *in = source;
	(void)error;
	*got = in->piece < most ? in->piece : most;
	if (*got > in->size)
		*got = in->size;
	memcpy(bytes, in->bytes, *got);
	in->bytes += *got;
	in->size -= *got;
	return ESKEL_OK;
}

static eskel_volume *decode(const uint8_t *data, size_t size, size_t piece, eskel_error *error)
{
	eskel_volume *volume = NULL;
	input in = {data, size, piece};
	if (eskel_volume_new(&limits, &volume) != ESKEL_OK)
		abort();
	eskel_status status = esk_data_set_read(get, &in, volume, error);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(volume, error);
	if (status == ESKEL_OK)
		return volume;
	if (error->status != status || error->text[0] == '\0' || status == ESKEL_INVALID)
		abort();
	eskel_volume_free(volume);
	return NULL;
}

static void encode(const eskel_volume *volume, size_t index, uint8_t **bytes, size_t *size)
{
	eskel_cloud *cloud = NULL;
	eskel_error error = {0};
	*bytes = NULL;
	*size = 0;
	const char *name = eskel_volume_label_name(volume, eskel_volume_label(volume, index));
	if (name && (!name[0] || strlen(name) > 200))
		abort();
	/* An affine at the edge of what is allowed may be refused here, but never runs that overlap. */
	if (eskel_volume_cloud(volume, eskel_volume_label(volume, index), &cloud, &error) == ESKEL_INVALID)
		abort();
	if (cloud && eskel_cloud_encode(cloud, bytes, size) != ESKEL_OK)
		abort();
	eskel_cloud_free(cloud);
}

static void compare(const eskel_volume *a, const eskel_volume *b)
{
	if (eskel_volume_label_count(a) == 0 || eskel_volume_label_count(a) != eskel_volume_label_count(b))
		abort();
	for (size_t i = 0; i < eskel_volume_label_count(a); i++) {
		uint8_t *bytes, *other_bytes;
		size_t size, other_size;
		encode(a, i, &bytes, &size);
		encode(b, i, &other_bytes, &other_size);
		if (size != other_size || (size > 0 && memcmp(bytes, other_bytes, size) != 0))
			abort();
		free(bytes);
		free(other_bytes);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	eskel_error error = {0}, other_error = {0};
	eskel_volume *whole = decode(data, size, size + 1, &error);
	eskel_volume *pieces = decode(data, size, 1 + size % 61, &other_error);
	if (error.status != other_error.status || strcmp(error.text, other_error.text) != 0)
		abort();
	if (whole)
		compare(whole, pieces);
	eskel_volume_free(whole);
	eskel_volume_free(pieces);
	return 0;
}
