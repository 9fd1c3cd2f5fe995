/* Random matrices of distances, and what pictures_oracle.py says of them. */
#ifndef DISTANCES_ORACLE_H
#define DISTANCES_ORACLE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Between random points of so many dimensions: distances[count * count]. */
void random_distances(uint64_t *seed, size_t count, int dimensions, double *distances);

/* The oracle's answer about matrices that write_matrix wrote to the file, to be pclosed; the caller removes the file. */
void write_matrix(FILE *file, size_t count, const double *distances);
FILE *ask_oracle(const char *what, const char *path);

#endif
