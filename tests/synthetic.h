/* Signatures without voxels: plausible, clustered, the same on every machine. For tests and benchmarks of search. */
#ifndef SYNTHETIC_H
#define SYNTHETIC_H

#include "eskel.h"

/* splitmix64: the next of a stream of well mixed numbers. */
uint64_t synthetic_random(uint64_t *state);
/* Uniform in [0, 1). */
double synthetic_uniform(uint64_t *state);

/* A member of a cluster: a box split again and again as a skeleton splits a shape, the cluster fixing proportions and
 * cuts, the member moving each by a share noise of them. Exits when memory ran out. */
eskel_signature *synthetic_signature(uint64_t cluster, uint64_t member, double noise, uint32_t levels);

#endif
