/* Time of the skeletons of all labels of a volume: bench_skeleton FIGURE FILE LEVELS THREADS [whole]
 *
 * whole: from the bytes of the file to signatures; else the skeletons alone. */
#include "eskel.h"
#include "measure.h"

#include <stdint.h>
#include <stdlib.h>

static void require(bool holds)
{
	if (holds)
		return;
	fputs("bench_skeleton: no skeletons\n", stderr);
	exit(1);
}

static eskel_volume *decode(const char *path)
{
	static uint8_t piece[65536];
	eskel_volume *volume = NULL;
	FILE *file = fopen(path, "rb");
	require(file && !eskel_volume_new(NULL, &volume));
	for (size_t n; (n = fread(piece, 1, sizeof piece, file)) > 0;)
		require(!eskel_volume_feed(volume, piece, n, NULL));
	fclose(file);
	require(!eskel_volume_finish(volume, NULL));
	return volume;
}

typedef struct {
	const char *path;
	uint32_t levels, threads;
	size_t count;
	eskel_cloud **clouds;
} work;

static void read_clouds(work *w)
{
	eskel_volume *volume = decode(w->path);
	w->count = eskel_volume_label_count(volume);
	w->clouds = calloc(w->count, sizeof *w->clouds);
	require(w->clouds != NULL);
	for (size_t i = 0; i < w->count; i++)
		require(!eskel_volume_cloud(volume, eskel_volume_label(volume, i), &w->clouds[i], NULL));
	eskel_volume_free(volume);
}

static void free_clouds(work *w)
{
	for (size_t i = 0; i < w->count; i++)
		eskel_cloud_free(w->clouds[i]);
	free(w->clouds);
}

static void compute(void *context)
{
	const work *w = context;
	const eskel_skeleton_options options = {.levels = w->levels, .threads = w->threads};
	eskel_skeleton **skeletons = calloc(w->count, sizeof *skeletons);
	require(skeletons &&
		!eskel_skeletons_new((const eskel_cloud *const *)w->clouds, w->count, &options, skeletons, NULL));
	for (size_t i = 0; i < w->count; i++) {
		eskel_signature *signature = NULL;
		require(!eskel_signature_new(skeletons[i], &signature));
		eskel_signature_free(signature);
		eskel_skeleton_free(skeletons[i]);
	}
	free(skeletons);
}

static void compute_from_file(void *context)
{
	work *w = context;
	read_clouds(w);
	compute(w);
	free_clouds(w);
}

int main(int argc, char **argv)
{
	if (argc < 5)
		return 2;
	work w = {.path = argv[2], .levels = (uint32_t)atoi(argv[3]), .threads = (uint32_t)atoi(argv[4])};
	char program[80], threads[24] = "";
	if (w.threads > 1)
		snprintf(threads, sizeof threads, ", %u threads", w.threads);
	snprintf(
		program, sizeof program, "eskel 1..%u%s%s", w.levels, argc > 5 ? ", bytes to signatures" : "", threads);
	if (argc > 5) {
		measure_print(argv[1], program, measure_least(compute_from_file, &w), "ms");
	} else {
		read_clouds(&w);
		measure_print(argv[1], program, measure_least(compute, &w), "ms");
		free_clouds(&w);
	}
	measure_print(argv[1], program, measure_peak_megabytes(), "MB");
	return 0;
}
