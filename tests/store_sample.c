#include "store_sample.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void demand(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "%s failed\n", what);
	exit(2);
}

/* Two rows of voxels whose place in the world, and whose lengths, are the number's bits. */
static eskel_cloud *make_cloud(uint32_t number)
{
	const uint16_t last[2] = {(uint16_t)(2 + number % 8), (uint16_t)(2 + number / 8 % 8)};
	const eskel_run runs[2] = {{0, last[0], 0, 0}, {1, last[1], 1, 1}};
	const eskel_affine affine = {{{1, 0, 0, number / 64 % 128}, {0, 1.5, 0, number / 8192}, {0, 0, 2, -7}}};
	eskel_cloud *cloud = NULL;
	demand(eskel_cloud_new(runs, NULL, 2, &affine, &cloud, NULL) == ESKEL_OK, "eskel_cloud_new");
	return cloud;
}

sample sample_new(uint32_t number)
{
	sample s = {.cloud = make_cloud(number), .description.age = NAN};
	const eskel_skeleton_options options = {.levels = 3};
	demand(eskel_skeleton_new(s.cloud, &options, &s.skeleton, NULL) == ESKEL_OK, "eskel_skeleton_new");
	demand(eskel_signature_new(s.skeleton, &s.signature) == ESKEL_OK, "eskel_signature_new");
	return s;
}

void sample_free(sample *s)
{
	eskel_cloud_free(s->cloud);
	eskel_skeleton_free(s->skeleton);
	eskel_signature_free(s->signature);
}

eskel_enrollment sample_enrollment(const sample *s, int32_t label)
{
	return (eskel_enrollment){
		.cloud = s->cloud,
		.skeleton = s->skeleton,
		.signature = s->signature,
		.description = &s->description,
		.label = label,
	};
}

eskel_store_status sample_enroll(eskel_store *store, uint32_t number, eskel_shape *shape, eskel_store_error *error)
{
	sample s = sample_new(number);
	eskel_enrollment enrollment = sample_enrollment(&s, (int32_t)number);
	eskel_shape enrolled;
	bool created;
	eskel_store_status status = eskel_store_enroll(store, NULL, &enrollment, 1, &enrolled, &created, error);
	if (status == ESKEL_STORE_OK && shape)
		*shape = enrolled;
	else if (status == ESKEL_STORE_OK)
		eskel_shape_clear(&enrolled);
	sample_free(&s);
	return status;
}

char *scratch_path(const char *folder, const char *name)
{
	char *path = NULL;
	demand(asprintf(&path, "%s/%s", folder, name) >= 0, "asprintf");
	return path;
}

char *scratch_new(void)
{
	const char *parent = getenv("TMPDIR");
	char *folder = scratch_path(parent ? parent : "/tmp", "eskel-test-XXXXXX");
	demand(mkdtemp(folder) != NULL, "mkdtemp");
	return folder;
}

void scratch_free(char *folder)
{
	DIR *entries = opendir(folder);
	demand(entries != NULL, "opendir");
	for (struct dirent *entry; (entry = readdir(entries));) {
		if (entry->d_name[0] == '.')
			continue;
		char *path = scratch_path(folder, entry->d_name);
		if (unlink(path) == 0)
			free(path);
		else
			scratch_free(path);
	}
	closedir(entries);
	rmdir(folder);
	free(folder);
}

uint8_t *file_read(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	demand(file && fseek(file, 0, SEEK_END) == 0, path);
	*size = (size_t)ftell(file);
	rewind(file);
	uint8_t *bytes = malloc(*size + 1);
	demand(bytes && fread(bytes, 1, *size, file) == *size, path);
	fclose(file);
	return bytes;
}

void file_write(const char *path, const void *bytes, size_t size)
{
	FILE *file = fopen(path, "wb");
	demand(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0, path);
}
