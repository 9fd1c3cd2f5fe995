/* print_partition SEED LEVEL: two skeletons of random blobs and their partition signatures, for partition_oracle.py. Lines
 * "centres A|B VOLUME X Y Z ...", "order ...", "distances A|B ...", "tetrahedra A|B ...", "fixed ..." and "free ..." (the four
 * means). */
#include "eskel.h"
#include "skeletons.h"

#include <stdio.h>
#include <stdlib.h>

enum { BLOBS = 64 };

static void print_numbers(const char *word, const char *of, const double *numbers, size_t count)
{
	printf("%s %s", word, of);
	for (size_t i = 0; i < count; i++)
		printf(" %.17g", numbers[i]);
	putchar('\n');
}

static void print_skeleton(const char *of, const eskel_skeleton *s, uint32_t level)
{
	printf("centres %s %.17g", of, s->volume);
	for (uint32_t c = 0; c < level; c++) {
		const double *centre = eskel_skeleton_node(s, level, c)->centre;
		printf(" %.17g %.17g %.17g", centre[0], centre[1], centre[2]);
	}
	putchar('\n');
}

static void print_signature(const char *of, const eskel_partition_signature *s)
{
	print_numbers("distances", of, s->distances, s->distance_count);
	print_numbers("tetrahedra", of, s->tetrahedra, s->tetrahedron_count);
}

static void print_difference(
	const char *word, eskel_size size, const eskel_partition_signature *a, const eskel_partition_signature *b)
{
	eskel_partition_difference d;
	if (eskel_partition_signature_compare(a, b, size, &d))
		exit(1);
	print_numbers(word, "-", (double[]){d.distances, d.tetrahedra, d.same_tetrahedra, d.mirrored_tetrahedra}, 4);
}

static eskel_skeleton *random_skeleton(uint64_t seed, uint32_t level, double voxel_volume)
{
	static skeletons_blob blobs[BLOBS];
	skeletons_scatter(seed, blobs, BLOBS);
	return skeletons_new(blobs, BLOBS, level, voxel_volume);
}

int main(int argc, char **argv)
{
	if (argc != 3)
		return 2;
	const uint64_t seed = strtoull(argv[1], NULL, 10);
	const uint32_t level = (uint32_t)strtoul(argv[2], NULL, 10);
	uint32_t order[ESKEL_LEVELS_MAX];
	for (uint32_t i = 0; i < level; i++)
		order[i] = (i * 5 + 3) % level; /* a bijection unless 5 divides the level */
	eskel_skeleton *a = random_skeleton(seed, level, 1), *b = random_skeleton(seed + 1, level, 2.5);
	eskel_partition_signature *of_a, *of_b;
	if (eskel_partition_signature_new(a, level, NULL, &of_a) ||
		eskel_partition_signature_new(b, level, order, &of_b))
		return 1;
	print_skeleton("A", a, level);
	print_skeleton("B", b, level);
	printf("order -");
	for (uint32_t i = 0; i < level; i++)
		printf(" %u", order[i]);
	putchar('\n');
	print_signature("A", of_a);
	print_signature("B", of_b);
	print_difference("fixed", ESKEL_SIZE_FIXED, of_a, of_b);
	print_difference("free", ESKEL_SIZE_FREE, of_a, of_b);
	eskel_partition_signature_free(of_a);
	eskel_partition_signature_free(of_b);
	eskel_skeleton_free(a);
	eskel_skeleton_free(b);
	return 0;
}
