/* Time of a skeleton's levels over runs, beside plain clustering over voxels that finds the same labels.
 *
 *	bench_partition [FILE ...]
 *
 * Without files: three shapes by formula. A file is a volume; its first label is taken. */
#include "levels.h"
#include "measure.h"
#include "partition.h"
#include "shapes.h"
#include "voxel_clustering.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *what)
{
	fprintf(stderr, "%s\n", what);
	exit(1);
}

typedef struct {
	const eskel_cloud *cloud;
	eskel_skeleton_options options;
} work;

static void compute(void *context)
{
	const work *w = context;
	eskel_skeleton *skeleton = NULL;
	if (eskel_skeleton_new(w->cloud, &w->options, &skeleton, NULL))
		fail("no skeleton");
	eskel_skeleton_free(skeleton);
}

static double time_skeleton(const eskel_cloud *cloud, eskel_skeleton_options options)
{
	return measure_least(compute, &(work){cloud, options});
}

/* The label of every voxel, in the order of the runs, in the partition that these centres are a fixed point of. */
static void label_voxels(esk_partition *partition, const esk_moments *classes, uint32_t count, uint8_t *labels)
{
	esk_sums starts[ESKEL_LEVELS_MAX];
	for (uint32_t j = 0; j < count; j++)
		starts[j] = classes[j].sums;
	if (esk_partition_converge(partition, starts, count))
		fail("no partition");
	esk_labelling labelling = {0};
	if (esk_partition_label(partition, &labelling))
		fail("no labels");
	size_t v = 0;
	for (size_t i = 0; i < labelling.count; i++)
		for (uint64_t n = esk_segment_voxels(&labelling.parts[i].segment); n > 0; n--)
			labels[v++] = (uint8_t)labelling.parts[i].class_index;
	esk_labelling_clear(&labelling);
}

/* The levels of the engine, checked voxel by voxel against plain clustering; its milliseconds. */
static double time_plain(const eskel_cloud *cloud, uint32_t levels)
{
	esk_segment *segments = malloc(cloud->run_count * sizeof *segments);
	esk_levels *found = malloc(sizeof *found);
	uint8_t *labels = malloc(cloud->voxels), *plain = malloc(cloud->voxels * levels);
	if (!segments || !found || !labels || !plain)
		fail("memory ran out");
	esk_segments_from_cloud(cloud, segments);
	esk_metric metric;
	esk_metric_euclidean(cloud, &metric);
	const esk_levels_input input = {.segments = segments,
		.segment_count = cloud->run_count,
		.metric = &metric,
		.root_map = &metric.map,
		.levels = levels};
	esk_partition partition;
	if (esk_levels_compute(&input, found) ||
		esk_partition_init(&partition, segments, cloud->run_count, &metric, NULL))
		fail("no levels");

	double map[3][3];
	for (int r = 0; r < 3; r++)
		memcpy(map[r], metric.map.m[r], sizeof map[r]);
	voxel_set set;
	voxel_set_init(&set, cloud, (const int64_t(*)[3])metric.form, metric.shift, (const double(*)[3])map,
		(const double(*)[3])map);
	double start = measure_milliseconds();
	if (voxel_clustering(&set, levels, plain) != levels)
		fail("plain clustering did not reach all levels");
	double spent = measure_milliseconds() - start;
	for (uint32_t k = 1; k <= levels; k++) {
		label_voxels(&partition, &found->classes[ESKEL_NODES(k - 1)], k, labels);
		if (memcmp(labels, plain + (k - 1) * set.count, set.count) != 0)
			fail("labels differ");
	}
	voxel_set_clear(&set);
	esk_partition_clear(&partition);
	free(segments);
	free(found);
	free(labels);
	free(plain);
	return spent;
}

static void report(const char *name, const eskel_cloud *cloud)
{
	char figure[256];
	snprintf(figure, sizeof figure, "partition/%s", name);
	measure_print(figure, "eskel 1..10", time_skeleton(cloud, (eskel_skeleton_options){.levels = 10}), "ms");
	measure_print(figure, "eskel 1..10", measure_peak_megabytes(), "MB");
	measure_print(figure, "eskel 1..16", time_skeleton(cloud, (eskel_skeleton_options){.levels = 16}), "ms");
	measure_print(figure, "eskel 1..10, 2 threads",
		time_skeleton(cloud, (eskel_skeleton_options){.levels = 10, .threads = 2}), "ms");
	const eskel_skeleton_options coarse = {.levels = 16, .coarse_start = true};
	measure_print(figure, "eskel 1..16, coarse start", time_skeleton(cloud, coarse), "ms");
	measure_print(figure, "plain Lloyd in C 1..10", time_plain(cloud, 10), "ms");
	measure_print(figure, "plain Lloyd in C 1..10", measure_peak_megabytes(), "MB");
}

static eskel_cloud *read_cloud(const char *path)
{
	static uint8_t piece[65536];
	eskel_volume *volume = NULL;
	eskel_cloud *cloud = NULL;
	eskel_error error = {0};
	FILE *file = fopen(path, "rb");
	if (!file || eskel_volume_new(NULL, &volume))
		fail(path);
	for (size_t n; (n = fread(piece, 1, sizeof piece, file)) > 0;)
		if (eskel_volume_feed(volume, piece, n, &error))
			fail(error.text);
	fclose(file);
	if (eskel_volume_finish(volume, &error) ||
		eskel_volume_cloud(volume, eskel_volume_label(volume, 0), &cloud, &error))
		fail(error.text);
	eskel_volume_free(volume);
	return cloud;
}

int main(int argc, char **argv)
{
	static const struct {
		const char *name;
		const shapes_solid *solid;
	} shapes[] = {{"hamate", &shapes_hamate}, {"femur", &shapes_femur}, {"large", &shapes_large}};
	for (size_t i = 0; argc == 1 && i < sizeof shapes / sizeof *shapes; i++) {
		eskel_cloud *cloud = shapes_cloud(shapes[i].solid, &shapes_identity);
		report(shapes[i].name, cloud);
		eskel_cloud_free(cloud);
	}
	for (int i = 1; i < argc; i++) {
		char name[200];
		const char *base = strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i];
		snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
		eskel_cloud *cloud = read_cloud(argv[i]);
		report(name, cloud);
		eskel_cloud_free(cloud);
	}
	return 0;
}
