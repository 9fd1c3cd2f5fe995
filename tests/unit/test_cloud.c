#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A small weighted voxel image: the brute-force counterpart of a run list. Index (x, y, z) is at x + 9 (y + 9 z). */
#define SIDE 9
#define CELLS (SIDE * SIDE * SIDE)

typedef struct {
	uint32_t weight[CELLS];
	eskel_affine affine;
} image;

static uint32_t random_number(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}

static size_t cell(int x, int y, int z)
{
	return (size_t)(x + SIDE * (y + SIDE * z));
}

/* Multiples of 1/64, so that flips and shifts of it are exact. Oblique, sheared, left-handed. */
static const eskel_affine oblique = {{{0.75, 0.25, 0.125, -40.5}, {-0.25, 1.5, 0.25, 96.25}, {0.125, 0.25, -2, 7.75}}};

/* Voxels in the inner 5 x 5 x 5 cells, so that the image can be shifted by up to 2. Every third image is sparse, with
 * rows and slices that have no voxel. */
static image random_image(uint64_t *seed, unsigned weights)
{
	unsigned sparse = random_number(seed) % 3 == 0;
	image im = {.affine = oblique};
	for (int z = 2; z < 7; z++)
		for (int y = 2; y < 7; y++)
			for (int x = 2; x < 7; x++)
				if (random_number(seed) % 8 < (sparse ? 1 : 5))
					im.weight[cell(x, y, z)] = 1 + random_number(seed) % weights;
	im.weight[cell(4, 4, 4)] = weights;
	return im;
}

/* The same object in the same place, in a grid with other axes and shifted by shift[] cells. */
static image stored_otherwise(const image *im, const int axis[3], int reversed, const int shift[3])
{
	image out = {.affine = im->affine};
	for (int r = 0; r < 3; r++)
		for (int a = 0; a < 3; a++) {
			double column = im->affine.m[r][axis[a]];
			bool back = reversed >> a & 1;
			out.affine.m[r][a] = back ? -column : column;
			/* Former index i is at new index i + shift or SIDE - 1 - i + shift. */
			out.affine.m[r][3] += back ? column * (SIDE - 1 + shift[a]) : -column * shift[a];
		}
	for (int z = 0; z < SIDE; z++)
		for (int y = 0; y < SIDE; y++)
			for (int x = 0; x < SIDE; x++) {
				int from[3] = {x, y, z}, to[3];
				if (!im->weight[cell(x, y, z)])
					continue;
				for (int a = 0; a < 3; a++)
					to[a] = (reversed >> a & 1 ? SIDE - 1 - from[axis[a]] : from[axis[a]]) +
						shift[a];
				out.weight[cell(to[0], to[1], to[2])] = im->weight[cell(x, y, z)];
			}
	return out;
}

/* One run a voxel, in an arbitrary order: the canonical form must not depend on how the caller cut the rows. */
static eskel_status cloud_of_image(const image *im, bool weighted, eskel_cloud **cloud, eskel_error *error)
{
	static eskel_run runs[CELLS];
	static uint32_t weights[CELLS];
	size_t count = 0;
	for (int x = SIDE - 1; x >= 0; x--)
		for (int z = 0; z < SIDE; z++)
			for (int y = 0; y < SIDE; y++)
				if (im->weight[cell(x, y, z)]) {
					weights[count] = im->weight[cell(x, y, z)];
					runs[count++] = (eskel_run){(uint16_t)x, (uint16_t)x, (uint16_t)y, (uint16_t)z};
				}
	return eskel_cloud_new(runs, weighted ? weights : NULL, count, &im->affine, cloud, error);
}

static void assert_equal_clouds(const eskel_cloud *a, const eskel_cloud *b)
{
	assert_int_equal(a->run_count, b->run_count);
	assert_memory_equal(a->runs, b->runs, a->run_count * sizeof *a->runs);
	assert_int_equal(!a->weights, !b->weights);
	if (a->weights)
		assert_memory_equal(a->weights, b->weights, a->run_count * sizeof *a->weights);
	assert_memory_equal(&a->affine, &b->affine, sizeof a->affine);
	assert_memory_equal(a->extent, b->extent, sizeof a->extent);
	assert_int_equal(a->voxels, b->voxels);
	assert_int_equal(a->weight, b->weight);
}

static void world_of(const eskel_affine *a, int x, int y, int z, double world[3])
{
	for (int r = 0; r < 3; r++)
		world[r] = a->m[r][0] * x + a->m[r][1] * y + a->m[r][2] * z + a->m[r][3];
}

static const eskel_run *run_at(const eskel_cloud *cloud, const double world[3])
{
	for (size_t i = 0; i < cloud->run_count; i++)
		for (int x = cloud->runs[i].x_first; x <= cloud->runs[i].x_last; x++) {
			double w[3];
			world_of(&cloud->affine, x, cloud->runs[i].y, cloud->runs[i].z, w);
			if (w[0] == world[0] && w[1] == world[1] && w[2] == world[2])
				return &cloud->runs[i];
		}
	return NULL;
}

static void a_cloud_has_the_voxels_of_its_image_in_their_places(void **state)
{
	(void)state;
	uint64_t seed = 1;
	for (int trial = 0; trial < 20; trial++) {
		image im = random_image(&seed, 1 + (unsigned)trial % 3);
		eskel_cloud *cloud = NULL;
		assert_int_equal(cloud_of_image(&im, true, &cloud, NULL), ESKEL_OK);
		uint64_t voxels = 0, weight = 0;
		for (int z = 0; z < SIDE; z++)
			for (int y = 0; y < SIDE; y++)
				for (int x = 0; x < SIDE; x++) {
					uint32_t w = im.weight[cell(x, y, z)];
					double world[3];
					if (!w)
						continue;
					world_of(&im.affine, x, y, z, world);
					const eskel_run *run = run_at(cloud, world);
					if (!run)
						fail_msg("voxel %d %d %d of trial %d is not in the cloud", x, y, z,
							trial);
					assert_int_equal(cloud->weights ? cloud->weights[run - cloud->runs] : 1, w);
					voxels++;
					weight += w;
				}
		assert_int_equal(cloud->voxels, voxels);
		assert_int_equal(cloud->weight, weight);
		eskel_cloud_free(cloud);
	}
}

static void runs_are_sorted_disjoint_maximal_and_fill_their_box(void **state)
{
	(void)state;
	uint64_t seed = 2;
	image im = random_image(&seed, 2);
	eskel_cloud *cloud = NULL;
	assert_int_equal(cloud_of_image(&im, true, &cloud, NULL), ESKEL_OK);
	unsigned least[3] = {99, 99, 99}, greatest[3] = {0, 0, 0};
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *r = &cloud->runs[i];
		const unsigned low[3] = {r->x_first, r->y, r->z}, high[3] = {r->x_last, r->y, r->z};
		assert_true(r->x_first <= r->x_last);
		for (int a = 0; a < 3; a++) {
			least[a] = low[a] < least[a] ? low[a] : least[a];
			greatest[a] = high[a] > greatest[a] ? high[a] : greatest[a];
		}
		if (i == 0)
			continue;
		const eskel_run *p = r - 1;
		if (p->z == r->z && p->y == r->y) {
			assert_true(p->x_last < r->x_first);
			assert_true(p->x_last + 1 < r->x_first || cloud->weights[i] != cloud->weights[i - 1]);
		} else {
			assert_true(p->z < r->z || (p->z == r->z && p->y < r->y));
		}
	}
	for (int a = 0; a < 3; a++) {
		assert_int_equal(least[a], 0);
		assert_int_equal(greatest[a] + 1, cloud->extent[a]);
	}
	eskel_cloud_free(cloud);
}

static void every_axis_order_direction_and_crop_gives_the_same_cloud(void **state)
{
	(void)state;
	static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
	uint64_t seed = 3;
	for (unsigned trial = 0; trial < 12; trial++) {
		image im = random_image(&seed, 1 + trial % 3);
		eskel_cloud *expected = NULL;
		assert_int_equal(cloud_of_image(&im, true, &expected, NULL), ESKEL_OK);
		for (int variant = 0; variant < 48; variant++) {
			int shift[3];
			for (int a = 0; a < 3; a++)
				shift[a] = (int)(random_number(&seed) % 5) - 2;
			image other = stored_otherwise(&im, orders[variant / 8], variant % 8, shift);
			eskel_cloud *cloud = NULL;
			assert_int_equal(cloud_of_image(&other, true, &cloud, NULL), ESKEL_OK);
			assert_equal_clouds(cloud, expected);
			eskel_cloud_free(cloud);
		}
		eskel_cloud_free(expected);
	}
}

static void axes_at_45_degrees_do_not_depend_on_the_input_order(void **state)
{
	(void)state;
	static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
	const int no_shift[3] = {0, 0, 0};
	uint64_t seed = 4;
	image im = random_image(&seed, 1);
	im.affine = (eskel_affine){{{1, -1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}}};
	eskel_cloud *expected = NULL;
	assert_int_equal(cloud_of_image(&im, false, &expected, NULL), ESKEL_OK);
	for (int variant = 0; variant < 48; variant++) {
		image other = stored_otherwise(&im, orders[variant / 8], variant % 8, no_shift);
		eskel_cloud *cloud = NULL;
		assert_int_equal(cloud_of_image(&other, false, &cloud, NULL), ESKEL_OK);
		assert_equal_clouds(cloud, expected);
		eskel_cloud_free(cloud);
	}
	eskel_cloud_free(expected);
}

static void a_mirror_image_stays_mirrored(void **state)
{
	(void)state;
	uint64_t seed = 5;
	image im = random_image(&seed, 1);
	image mirrored = im;
	for (int c = 0; c < 4; c++)
		mirrored.affine.m[0][c] = -mirrored.affine.m[0][c];
	eskel_cloud *a = NULL, *b = NULL;
	assert_int_equal(cloud_of_image(&im, false, &a, NULL), ESKEL_OK);
	assert_int_equal(cloud_of_image(&mirrored, false, &b, NULL), ESKEL_OK);
	assert_true(eskel_affine_determinant(&a->affine) > 0);
	assert_true(eskel_affine_determinant(&b->affine) > 0);
	assert_false(a->run_count == b->run_count && memcmp(a->runs, b->runs, a->run_count * sizeof *a->runs) == 0);
	eskel_cloud_free(a);
	eskel_cloud_free(b);
}

static void the_affine_is_rounded_and_has_no_negative_zero(void **state)
{
	(void)state;
	const eskel_run run = {3, 3, 4, 5};
	const eskel_affine noisy = {{{-0.8, 1e-17, -0.0, 534.4}, {-1e-12, 0.8, 0, 0.3005}, {0, -1e-17, 0.8, -0.0001}}};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(&run, NULL, 1, &noisy, &cloud, NULL), ESKEL_OK);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			const double zero = 0, edge = (double)0.8f;
			assert_memory_equal(&cloud->affine.m[r][c], r == c ? &edge : &zero, sizeof zero);
		}
	/* The largest entry is in [1/2, 1), so offsets are rounded to 1/2048. */
	const double offset[3] = {534.4 - 3 * (double)0.8f, 0.3005 + 4 * (double)0.8f, -0.0001 + 5 * (double)0.8f};
	for (int r = 0; r < 3; r++)
		if (cloud->affine.m[r][3] != rint(offset[r] * 2048) / 2048)
			fail_msg("offset %d is %.17g, expected %.17g", r, cloud->affine.m[r][3], offset[r]);
	eskel_cloud_free(cloud);
	const eskel_run at_origin = {0, 0, 0, 0};
	const double zero = 0;
	assert_int_equal(eskel_cloud_new(&at_origin, NULL, 1, &noisy, &cloud, NULL), ESKEL_OK);
	assert_memory_equal(&cloud->affine.m[2][3], &zero, sizeof zero);
	eskel_cloud_free(cloud);
}

static void a_canonical_cloud_is_its_own_canonical_cloud(void **state)
{
	(void)state;
	uint64_t seed = 6;
	for (int trial = 0; trial < 200; trial++) {
		image im = random_image(&seed, 2);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 4; c++)
				im.affine.m[r][c] = random_number(&seed) / 2147483648.0 - 0.5;
		if (eskel_affine_check(&im.affine, NULL) != ESKEL_OK)
			continue;
		eskel_cloud *once = NULL, *twice = NULL;
		assert_int_equal(cloud_of_image(&im, true, &once, NULL), ESKEL_OK);
		assert_int_equal(
			eskel_cloud_new(once->runs, once->weights, once->run_count, &once->affine, &twice, NULL),
			ESKEL_OK);
		assert_equal_clouds(twice, once);
		eskel_cloud_free(once);
		eskel_cloud_free(twice);
	}
}

static int compare_runs(const void *a, const void *b)
{
	const eskel_run *p = a, *q = b;
	return p->z != q->z ? p->z - q->z : p->y != q->y ? p->y - q->y : p->x_first - q->x_first;
}

static void runs_of_a_large_grid_may_come_in_any_order(void **state)
{
	(void)state;
	enum { count = 3000 };
	eskel_run runs[count], sorted[count];
	const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	uint64_t seed = 9;
	for (size_t i = 0; i < count; i++) {
		uint16_t x = (uint16_t)(20 * i); /* apart from one another */
		uint16_t y = (uint16_t)(random_number(&seed) % 60000), z = (uint16_t)(random_number(&seed) % 300);
		runs[i] = sorted[i] = (eskel_run){x, (uint16_t)(x + 9), y, z};
	}
	qsort(sorted, count, sizeof sorted[0], compare_runs);
	eskel_cloud *cloud = NULL, *expected = NULL;
	assert_int_equal(eskel_cloud_new(runs, NULL, count, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_new(sorted, NULL, count, &identity, &expected, NULL), ESKEL_OK);
	assert_equal_clouds(cloud, expected);
	eskel_cloud_free(expected);
	eskel_cloud_free(cloud);
}

static void touching_runs_join_when_they_weigh_the_same(void **state)
{
	(void)state;
	const eskel_run runs[] = {{5, 6, 0, 0}, {2, 4, 0, 0}, {7, 7, 0, 0}};
	const uint32_t weights[] = {2, 2, 3};
	const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(runs, weights, 3, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(cloud->run_count, 2);
	assert_int_equal(cloud->runs[0].x_last, 4);
	assert_int_equal(cloud->weights[1], 3);
	assert_int_equal(cloud->weight, 13);
	assert_true(cloud->affine.m[0][3] == 2);
	eskel_cloud_free(cloud);
}

static void unusable_runs_are_refused_with_their_values(void **state)
{
	(void)state;
	const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	const eskel_run overlapping[] = {{2, 4, 7, 8}, {4, 5, 7, 8}}, backwards = {4, 3, 0, 0};
	const eskel_run apart[] = {{0, 0, 0, 0}, {0, 0, 0, 65535}};
	eskel_run *many = calloc(1 << 18, sizeof *many);
	eskel_cloud *cloud = NULL;
	eskel_error error;
	assert_int_equal(eskel_cloud_new(overlapping, NULL, 0, &identity, &cloud, NULL), ESKEL_EMPTY);
	assert_int_equal(eskel_cloud_new(overlapping, NULL, 2, &identity, &cloud, &error), ESKEL_INVALID);
	assert_string_equal(error.text, "two runs hold voxel (4, 7, 8), expected disjoint runs");
	assert_int_equal(eskel_cloud_new(&backwards, NULL, 1, &identity, &cloud, &error), ESKEL_INVALID);
	assert_string_equal(error.text, "run 0 ends at 3, before its start at 4");
	assert_int_equal(eskel_cloud_new(apart, (uint32_t[]){1, 0}, 2, &identity, &cloud, &error), ESKEL_INVALID);
	assert_string_equal(error.text, "run 1 has weight 0, expected 1 to 1048576");
	assert_int_equal(eskel_cloud_new(apart, NULL, 2, &identity, &cloud, &error), ESKEL_TOO_LARGE);
	assert_string_equal(error.text, "the object is 65536 voxels long, expected at most 65535");
	assert_non_null(many);
	for (size_t i = 0; i < 1 << 18; i++)
		many[i] = (eskel_run){0, 65534, (uint16_t)(i % 1024), (uint16_t)(i / 1024)};
	assert_int_equal(eskel_cloud_new(many, NULL, 1 << 18, &identity, &cloud, &error), ESKEL_TOO_LARGE);
	assert_string_equal(error.text, "the object has more than 8589934592 voxels");
	assert_null(cloud);
	free(many);
}

static void volume_is_voxels_times_determinant(void **state)
{
	(void)state;
	const eskel_run run = {0, 9, 0, 0};
	const eskel_affine left_handed = {{{-0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 2, 0}}};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(&run, NULL, 1, &left_handed, &cloud, NULL), ESKEL_OK);
	assert_true(eskel_cloud_volume(cloud) == 5);
	eskel_cloud_free(cloud);
}

static void encoding_and_decoding_is_lossless(void **state)
{
	(void)state;
	uint64_t seed = 7;
	for (unsigned trial = 0; trial < 50; trial++) {
		image im = random_image(&seed, 1 + trial % 4 * 300);
		eskel_cloud *cloud = NULL, *decoded = NULL;
		uint8_t *bytes = NULL;
		size_t size = 0;
		assert_int_equal(cloud_of_image(&im, true, &cloud, NULL), ESKEL_OK);
		assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
		assert_int_equal(eskel_cloud_decode(bytes, size, &decoded, NULL), ESKEL_OK);
		assert_equal_clouds(decoded, cloud);
		free(bytes);
		eskel_cloud_free(cloud);
		eskel_cloud_free(decoded);
	}
}

static void the_largest_grid_survives_encoding(void **state)
{
	(void)state;
	const eskel_run runs[] = {{0, 65534, 0, 0}, {65534, 65534, 65534, 65534}};
	const uint32_t weights[] = {1 << 20, 1};
	const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	eskel_cloud *cloud = NULL, *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	assert_int_equal(eskel_cloud_new(runs, weights, 2, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
	assert_int_equal(eskel_cloud_decode(bytes, size, &decoded, NULL), ESKEL_OK);
	assert_equal_clouds(decoded, cloud);
	free(bytes);
	eskel_cloud_free(cloud);
	eskel_cloud_free(decoded);
}

/* Whatever decode accepts, encode gives back: so no two byte strings are one cloud. */
static bool accepts_only_its_own_encoding(const uint8_t *bytes, size_t size)
{
	eskel_cloud *cloud = NULL;
	if (eskel_cloud_decode(bytes, size, &cloud, NULL) != ESKEL_OK) {
		assert_null(cloud);
		return false;
	}
	uint8_t *again = NULL;
	size_t again_size = 0;
	assert_int_equal(eskel_cloud_encode(cloud, &again, &again_size), ESKEL_OK);
	assert_int_equal(again_size, size);
	assert_memory_equal(again, bytes, size);
	free(again);
	eskel_cloud_free(cloud);
	return true;
}

static void damaged_bytes_never_decode_to_another_encoding(void **state)
{
	(void)state;
	uint64_t seed = 8;
	size_t accepted = 0;
	for (unsigned trial = 0; trial < 8; trial++) {
		image im = random_image(&seed, 1 + trial % 2);
		eskel_cloud *cloud = NULL;
		uint8_t *bytes = NULL, *damaged = NULL;
		size_t size = 0;
		assert_int_equal(cloud_of_image(&im, true, &cloud, NULL), ESKEL_OK);
		assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
		damaged = malloc(size + 1);
		assert_non_null(damaged);
		for (int change = 0; change < 4000; change++) {
			memcpy(damaged, bytes, size);
			damaged[size] = (uint8_t)random_number(&seed);
			for (uint32_t n = 1 + random_number(&seed) % 3; n > 0; n--)
				damaged[random_number(&seed) % size] ^= (uint8_t)(1u << random_number(&seed) % 8);
			accepted += accepts_only_its_own_encoding(damaged, size + random_number(&seed) % 2);
		}
		free(damaged);
		free(bytes);
		eskel_cloud_free(cloud);
	}
	/* Some changes give another object, which is fine; if none did, this test would show little. */
	assert_true(accepted > 100);
}

static void every_truncation_is_refused(void **state)
{
	(void)state;
	uint64_t seed = 9;
	image im = random_image(&seed, 2);
	eskel_cloud *cloud = NULL, *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	assert_int_equal(cloud_of_image(&im, true, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
	for (size_t n = 0; n < size; n++) {
		uint8_t *exact = malloc(n ? n : 1); /* so that a sanitizer sees a read past the end */
		assert_non_null(exact);
		memcpy(exact, bytes, n);
		assert_int_equal(eskel_cloud_decode(exact, n, &decoded, NULL), ESKEL_TRUNCATED);
		free(exact);
	}
	assert_null(decoded);
	free(bytes);
	eskel_cloud_free(cloud);
}

/* The encoding of two voxels in one row, (0, 0, 0) and (2, 0, 0), spelled out from the format's description. */
static size_t two_voxels(uint8_t bytes[128])
{
	static const uint8_t head[] = {1, 0}, rest[] = {3, 0, 1, 0, 1, 0, 2, 1, 0, 0, 0, 1, 0};
	memset(bytes, 0, 128);
	memcpy(bytes, head, sizeof head);
	for (int entry = 0; entry < 12; entry += 5) /* the diagonal is 1, 0x3ff0000000000000 */
		memcpy(bytes + 2 + 8 * entry + 6, "\xf0\x3f", 2);
	memcpy(bytes + 98, rest, sizeof rest);
	return 98 + sizeof rest;
}

static void the_format_is_as_described(void **state)
{
	(void)state;
	const eskel_run runs[] = {{0, 0, 0, 0}, {2, 2, 0, 0}};
	const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	eskel_cloud *cloud = NULL;
	uint8_t *bytes = NULL, expected[128];
	size_t size = 0;
	assert_int_equal(eskel_cloud_new(runs, NULL, 2, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
	assert_int_equal(size, two_voxels(expected));
	assert_memory_equal(bytes, expected, size);
	free(bytes);
	eskel_cloud_free(cloud);
}

static void bytes_that_no_encode_made_are_refused_by_their_fault(void **state)
{
	(void)state;
	static const struct {
		const char *what;
		size_t at;
		uint8_t value;
		eskel_status status;
	} faults[] = {
		{"a later version", 0, 2, ESKEL_MALFORMED},
		{"an unknown flag", 1, 2, ESKEL_TRUNCATED}, /* it promises weights */
		{"a left-handed affine", 2 + 7, 0xbf, ESKEL_MALFORMED},
		{"an affine with more bits than a float", 2, 1, ESKEL_MALFORMED},
		{"a singular affine", 2 + 7, 0, ESKEL_MALFORMED},
		{"an offset off its grid", 2 + 24, 1, ESKEL_MALFORMED},
		{"an offset of -0", 2 + 31, 0x80, ESKEL_MALFORMED},
		{"an extent that is too long", 98, 4, ESKEL_MALFORMED},
		{"no extent along y", 100, 0, ESKEL_MALFORMED},
		{"no runs", 104, 0, ESKEL_MALFORMED},
		{"too few runs", 104, 1, ESKEL_MALFORMED},
		{"more runs than bytes", 104, 3, ESKEL_TRUNCATED},
		{"a first run before the first row", 105, 0, ESKEL_MALFORMED},
		{"a first row that is not 0", 105, 2, ESKEL_MALFORMED},
		{"a first voxel that is not 0", 106, 2, ESKEL_MALFORMED},
		{"a run before the grid", 106, 1, ESKEL_MALFORMED},
		{"runs that touch", 109, 0, ESKEL_MALFORMED},
		{"a run past its extent", 110, 1, ESKEL_MALFORMED},
	};
	uint8_t bytes[128];
	eskel_cloud *cloud = NULL;
	eskel_error error;
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
		size_t size = two_voxels(bytes);
		assert_true(accepts_only_its_own_encoding(bytes, size));
		bytes[faults[i].at] = faults[i].value;
		eskel_status status = eskel_cloud_decode(bytes, size, &cloud, &error);
		if (status != faults[i].status || error.status != status)
			fail_msg("%s: %s (%s)", faults[i].what, eskel_status_text(status), error.text);
	}
	size_t size = two_voxels(bytes);
	assert_int_equal(eskel_cloud_decode(bytes, size + 1, &cloud, NULL), ESKEL_MALFORMED);
	/* 0x80 0x00 is a longer way to write the last 0. */
	bytes[size - 1] = 0x80;
	assert_int_equal(eskel_cloud_decode(bytes, size + 1, &cloud, NULL), ESKEL_MALFORMED);
	assert_null(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_cloud_has_the_voxels_of_its_image_in_their_places),
		cmocka_unit_test(runs_are_sorted_disjoint_maximal_and_fill_their_box),
		cmocka_unit_test(every_axis_order_direction_and_crop_gives_the_same_cloud),
		cmocka_unit_test(axes_at_45_degrees_do_not_depend_on_the_input_order),
		cmocka_unit_test(a_mirror_image_stays_mirrored),
		cmocka_unit_test(the_affine_is_rounded_and_has_no_negative_zero),
		cmocka_unit_test(a_canonical_cloud_is_its_own_canonical_cloud),
		cmocka_unit_test(runs_of_a_large_grid_may_come_in_any_order),
		cmocka_unit_test(touching_runs_join_when_they_weigh_the_same),
		cmocka_unit_test(unusable_runs_are_refused_with_their_values),
		cmocka_unit_test(volume_is_voxels_times_determinant),
		cmocka_unit_test(encoding_and_decoding_is_lossless),
		cmocka_unit_test(the_largest_grid_survives_encoding),
		cmocka_unit_test(damaged_bytes_never_decode_to_another_encoding),
		cmocka_unit_test(every_truncation_is_refused),
		cmocka_unit_test(the_format_is_as_described),
		cmocka_unit_test(bytes_that_no_encode_made_are_refused_by_their_fault),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
