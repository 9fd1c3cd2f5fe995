/* print_segments FILE [TOOL]: reads a file as the server and the command line do, with TOOL in place of dcmdrle, and
 * prints extent X Y Z affine (twelve numbers, row by row) warning CODE TEXT label voxels volume_mm3 centroid_x
 * centroid_y centroid_z digest name where equal clouds, and no others, have the same digest, or a line "refused
 * STATUS SENTENCE", for the tests in Python. */
#include "eskel_dicom.h"

#include <stdio.h>
#include <stdlib.h>

/* FNV-1a of the cloud's bytes. */
static unsigned long long digest(const eskel_cloud *cloud)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	unsigned long long hash = 0xcbf29ce484222325;
	if (eskel_cloud_encode(cloud, &bytes, &size) != ESKEL_OK)
		abort();
	for (size_t i = 0; i < size; i++)
		hash = (hash ^ bytes[i]) * 0x100000001b3;
	free(bytes);
	return hash;
}

static void print_label(const eskel_volume *volume, int32_t label)
{
	eskel_cloud *cloud = NULL;
	if (eskel_volume_cloud(volume, label, &cloud, NULL) != ESKEL_OK)
		abort();
	double sum[3] = {0, 0, 0};
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *r = &cloud->runs[i];
		const double length = r->x_last - r->x_first + 1, middle = (r->x_first + r->x_last) / 2.0;
		sum[0] += length * middle;
		sum[1] += length * r->y;
		sum[2] += length * r->z;
	}
	printf("%d %llu %.17g", label, (unsigned long long)cloud->voxels, eskel_cloud_volume(cloud));
	for (int r = 0; r < 3; r++) {
		double centroid = cloud->affine.m[r][3];
		for (int c = 0; c < 3; c++)
			centroid += cloud->affine.m[r][c] * sum[c] / (double)cloud->voxels;
		printf(" %.17g", centroid);
	}
	const char *name = eskel_volume_label_name(volume, label);
	printf(" %016llx %s\n", digest(cloud), name ? name : "");
	eskel_cloud_free(cloud);
}

static void print_info(const eskel_volume_info *info)
{
	printf("extent %u %u %u\naffine", info->extent[0], info->extent[1], info->extent[2]);
	for (int i = 0; i < 12; i++)
		printf(" %.17g", info->affine.m[i / 4][i % 4]);
	printf("\n");
	for (size_t i = 0; i < info->warning_count; i++)
		printf("warning %s %s\n", eskel_warning_name(info->warnings[i].code), info->warnings[i].text);
}

int main(int argc, char **argv)
{
	FILE *file = argc > 1 ? fopen(argv[1], "rb") : NULL;
	eskel_intake *intake = NULL;
	eskel_volume *volume = NULL;
	eskel_error error = {0};
	if (!file || eskel_intake_new(NULL, argc > 2 ? argv[2] : NULL, &intake) != ESKEL_OK) {
		fprintf(stderr, "usage: print_segments FILE [TOOL]\n");
		return 2;
	}
	static char buffer[50000];
	eskel_status status = ESKEL_OK;
	for (size_t n; status == ESKEL_OK && (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
		status = eskel_intake_feed(intake, buffer, n, &error);
	if (status == ESKEL_OK)
		status = eskel_intake_finish(intake, &volume, &error);
	if (status == ESKEL_OK) {
		print_info(eskel_volume_get_info(volume));
		for (size_t i = 0; i < eskel_volume_label_count(volume); i++)
			print_label(volume, eskel_volume_label(volume, i));
	} else {
		printf("refused %d %s\n", status, error.text);
	}
	eskel_volume_free(volume);
	eskel_intake_free(intake);
	fclose(file);
	return 0;
}
