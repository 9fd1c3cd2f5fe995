/* Time and memory of a volume's bytes to runs, fed 64 KB at a time as an upload is: bench_decode FIGURE FILE */
#include "eskel.h"
#include "measure.h"

#include <stdint.h>
#include <stdlib.h>

static eskel_volume *volume;

static void decode(void *path)
{
	static uint8_t piece[65536];
	eskel_volume_free(volume);
	volume = NULL;
	FILE *file = fopen(path, "rb");
	if (!file || eskel_volume_new(NULL, &volume))
		exit(1);
	for (size_t n; (n = fread(piece, 1, sizeof piece, file)) > 0;)
		if (eskel_volume_feed(volume, piece, n, NULL))
			exit(1);
	fclose(file);
	if (eskel_volume_finish(volume, NULL))
		exit(1);
}

static double megabytes_of_runs(void)
{
	size_t runs = 0;
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++) {
		eskel_cloud *cloud = NULL;
		if (eskel_volume_cloud(volume, eskel_volume_label(volume, i), &cloud, NULL))
			exit(1);
		runs += cloud->run_count;
		eskel_cloud_free(cloud);
	}
	return (double)(runs * sizeof(eskel_run)) / 1048576;
}

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	const double before = measure_peak_megabytes();
	decode(argv[2]);
	const double peak = measure_peak_megabytes();
	measure_print(argv[1], "eskel to runs", measure_least(decode, argv[2]), "ms");
	measure_print(argv[1], "eskel to runs", peak, "MB");
	measure_print(argv[1], "eskel's memory beyond the runs", peak - before - megabytes_of_runs(), "MB");
	eskel_volume_free(volume);
	return 0;
}
