/* print_skeleton FILE LEVELS euclidean|mahalanobis plain|coarse: the skeleton of a volume's first label, for
 * skeleton_oracle.py. A line "level K SPLIT_CLASS SPLIT_RATIO INTRACLASS_RATIO" and, for each of its classes, "node VOXELS
 * WEIGHT CENTRE(3) COVARIANCE(9) EIGENVALUES(3) AXES(9) RHO". */
#include "eskel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_numbers(const double *numbers, int count)
{
	for (int i = 0; i < count; i++)
		printf(" %.17g", numbers[i]);
}

static void print(const eskel_skeleton *s)
{
	for (uint32_t k = 1; k <= s->level_count; k++) {
		const eskel_level *level = &s->levels[k - 1];
		printf("level %u %d %.17g %.17g\n", k, level->split_class, level->split_ratio, level->intraclass_ratio);
		for (uint32_t c = 0; c < k; c++) {
			const eskel_node *node = eskel_skeleton_node(s, k, c);
			printf("node %llu %.17g", (unsigned long long)node->voxels, node->weight);
			print_numbers(node->centre, 3);
			print_numbers(node->covariance[0], 9);
			print_numbers(node->eigenvalues, 3);
			print_numbers(node->axes[0], 9);
			printf(" %.17g\n", node->rho);
		}
	}
}

static eskel_cloud *read_cloud(const char *path)
{
	static char buffer[50000];
	FILE *file = fopen(path, "rb");
	eskel_volume *volume = NULL;
	eskel_cloud *cloud = NULL;
	if (!file || eskel_volume_new(NULL, &volume))
		return NULL;
	eskel_status status = ESKEL_OK;
	for (size_t n; !status && (n = fread(buffer, 1, sizeof buffer, file)) > 0;)
		status = eskel_volume_feed(volume, buffer, n, NULL);
	if (!status)
		status = eskel_volume_finish(volume, NULL);
	if (!status)
		status = eskel_volume_cloud(volume, eskel_volume_label(volume, 0), &cloud, NULL);
	eskel_volume_free(volume);
	fclose(file);
	return cloud;
}

int main(int argc, char **argv)
{
	eskel_cloud *cloud = argc == 5 ? read_cloud(argv[1]) : NULL;
	if (!cloud) {
		fprintf(stderr, "usage: print_skeleton FILE LEVELS euclidean|mahalanobis plain|coarse\n");
		return 2;
	}
	const eskel_skeleton_options options = {
		.levels = (uint32_t)strtoul(argv[2], NULL, 10),
		.metric = strcmp(argv[3], "mahalanobis") ? ESKEL_PARTITION_EUCLIDEAN : ESKEL_PARTITION_MAHALANOBIS,
		.coarse_start = !strcmp(argv[4], "coarse"),
	};
	eskel_skeleton *skeleton = NULL;
	eskel_status status = eskel_skeleton_new(cloud, &options, &skeleton, NULL);
	if (!status)
		print(skeleton);
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
	return status != ESKEL_OK;
}
