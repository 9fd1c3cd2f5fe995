#include "distances_oracle.h"

#include "synthetic.h"

#include <math.h>
#include <stdlib.h>

void random_distances(uint64_t *seed, size_t count, int dimensions, double *distances)
{
	double *points = calloc(count * (size_t)dimensions, sizeof *points);
	for (size_t i = 0; points && i < count * (size_t)dimensions; i++)
		points[i] = synthetic_uniform(seed);
	for (size_t i = 0; points && i < count; i++)
		for (size_t j = 0; j < count; j++) {
			double sum = 0;
			for (int d = 0; d < dimensions; d++) {
				const double step = points[i * (size_t)dimensions + (size_t)d] -
						    points[j * (size_t)dimensions + (size_t)d];
				sum += step * step;
			}
			distances[i * count + j] = sqrt(sum);
		}
	free(points);
}

void write_matrix(FILE *file, size_t count, const double *distances)
{
	fprintf(file, "%zu\n", count);
	for (size_t i = 0; i < count * count; i++)
		fprintf(file, "%.17g\n", distances[i]);
}

FILE *ask_oracle(const char *what, const char *path)
{
	char command[200];
	snprintf(command, sizeof command, "/usr/bin/python3 tests/unit/pictures_oracle.py %s %s 2>/dev/null", what,
		path);
	return popen(command, "r");
}
