/* print_labels FILE: decodes a volume and prints a line "refused STATUS", or per label, exactly,
 *   label voxels volume_mm3 centroid_x centroid_y centroid_z border_sides name
 * for volume_oracle.py to compare with nibabel. */
#include "eskel.h"

#include <stdio.h>
#include <stdlib.h>

static void print_label(const eskel_volume *volume, int32_t label)
{
	eskel_cloud *cloud = NULL;
	unsigned sides = 0;
	if (eskel_volume_cloud(volume, label, &cloud, NULL) != ESKEL_OK ||
		eskel_volume_border(volume, label, &sides) != ESKEL_OK)
		abort();
	double sum[3] = {0, 0, 0};
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *r = &cloud->runs[i];
		double length = r->x_last - r->x_first + 1, middle = (r->x_first + r->x_last) / 2.0;
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
	printf(" %u %s\n", sides, name ? name : "");
	eskel_cloud_free(cloud);
}

int main(int argc, char **argv)
{
	FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
	eskel_volume *volume = NULL;
	if (!file || eskel_volume_new(NULL, &volume) != ESKEL_OK) {
		fprintf(stderr, "usage: print_labels FILE\n");
		return 2;
	}
	static char buffer[50000];
	eskel_status status = ESKEL_OK;
	for (size_t n; status == ESKEL_OK && (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
		status = eskel_volume_feed(volume, buffer, n, NULL);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(volume, NULL);
	if (status == ESKEL_OK)
		for (size_t i = 0; i < eskel_volume_label_count(volume); i++)
			print_label(volume, eskel_volume_label(volume, i));
	else
		printf("refused %d\n", status);
	eskel_volume_free(volume);
	fclose(file);
	return 0;
}
