#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "distances_oracle.h"
#include "eskel.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 200 };
static double distances[MOST * MOST];

/* Heights ascend, every cluster is merged once, into one that comes later, sizes add up, and leaves come out as an order
 * in which every cluster is a stretch. */
static void check_tree(const eskel_merge *merges, size_t count)
{
	bool merged[2 * MOST] = {false};
	uint32_t order[MOST], low[2 * MOST], high[2 * MOST];
	assert_int_equal(eskel_clustering_order(merges, count, order), ESKEL_OK);
	for (uint32_t i = 0; i < count; i++)
		low[order[i]] = high[order[i]] = i;
	for (size_t s = 0; s + 1 < count; s++) {
		const uint32_t a = merges[s].first, b = merges[s].second;
		assert_true(a < b && b < count + s && !merged[a] && !merged[b]);
		merged[a] = merged[b] = true;
		assert_true(s == 0 || merges[s].height >= merges[s - 1].height);
		low[count + s] = low[a] < low[b] ? low[a] : low[b];
		high[count + s] = high[a] > high[b] ? high[a] : high[b];
		assert_int_equal(merges[s].size, high[count + s] - low[count + s] + 1);
	}
}

static void trees_are_those_of_scipy(void **state)
{
	(void)state;
	static const size_t counts[] = {2, 3, 4, 7, 20, 61, 150};
	enum { TREES = sizeof counts / sizeof *counts };
	static eskel_merge merges[TREES][MOST];
	uint64_t seed = 11;
	char path[] = "/tmp/eskel-clustering-XXXXXX", line[200];
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	for (size_t t = 0; t < TREES; t++) {
		random_distances(&seed, counts[t], 3, distances);
		write_matrix(file, counts[t], distances);
		assert_int_equal(eskel_clustering(distances, counts[t], merges[t]), ESKEL_OK);
		check_tree(merges[t], counts[t]);
	}
	fclose(file);
	FILE *oracle = ask_oracle("clustering", path);
	size_t read = 0;
	for (size_t t = 0; t < TREES; t++)
		for (size_t s = 0; s + 1 < counts[t] && fgets(line, sizeof line, oracle); s++, read++) {
			unsigned first, second, size;
			double height;
			assert_int_equal(sscanf(line, "%u %u %lf %u", &first, &second, &height, &size), 4);
			const eskel_merge *m = &merges[t][s];
			if (m->first != first || m->second != second || m->size != size ||
				fabs(m->height - height) > 1e-12 * height)
				fail_msg("%zu shapes, step %zu: %u %u %.17g %u, SciPy %s", counts[t], s, m->first,
					m->second, m->height, m->size, line);
		}
	pclose(oracle);
	remove(path);
	if (read == 0)
		skip();
	assert_int_equal(read, 240);
}

/* Merging the nearest of all pairs again and again, each mean taken anew over all pairs of shapes. */
static void heights_are_those_of_merging_the_nearest_pair(void **state)
{
	(void)state;
	enum { N = 40 };
	uint64_t seed = 5;
	int cluster[N];
	eskel_merge merges[N];
	random_distances(&seed, N, 4, distances);
	assert_int_equal(eskel_clustering(distances, N, merges), ESKEL_OK);
	for (int i = 0; i < N; i++)
		cluster[i] = i;
	for (size_t s = 0; s + 1 < N; s++) {
		double best = INFINITY;
		int from = 0, to = 0;
		for (int a = 0; a < N; a++)
			for (int b = a + 1; b < N; b++) {
				double sum = 0, pairs = 0;
				for (int i = 0; i < N; i++)
					for (int j = 0; j < N; j++)
						if (cluster[i] == a && cluster[j] == b) {
							sum += distances[i * N + j];
							pairs++;
						}
				if (pairs > 0 && sum / pairs < best) {
					best = sum / pairs;
					from = b;
					to = a;
				}
			}
		assert_true(fabs(merges[s].height - best) < 1e-12);
		for (int i = 0; i < N; i++)
			cluster[i] = cluster[i] == from ? to : cluster[i];
	}
}

static void ties_give_a_tree_and_always_the_same(void **state)
{
	(void)state;
	uint64_t seed = 3;
	for (size_t n = 2; n <= 60; n++) {
		eskel_merge merges[MOST], again[MOST];
		for (size_t i = 0; i < n; i++)
			for (size_t j = 0; j <= i; j++)
				distances[i * n + j] = distances[j * n + i] =
					i == j       ? 0
					: n % 3 == 0 ? 0.1
						     : (double)(1 + synthetic_random(&seed) % 3) / 10;
		assert_int_equal(eskel_clustering(distances, n, merges), ESKEL_OK);
		assert_int_equal(eskel_clustering(distances, n, again), ESKEL_OK);
		check_tree(merges, n);
		for (size_t s = 0; s + 1 < n; s++) {
			assert_int_equal(merges[s].first, again[s].first);
			assert_int_equal(merges[s].second, again[s].second);
			assert_true(merges[s].height == again[s].height);
			assert_true(n % 3 != 0 || merges[s].height == 0.1);
		}
	}
}

static void the_tighter_cluster_comes_first(void **state)
{
	(void)state;
	const double pairs[16] = {0, 9, 9, 2, 9, 0, 1, 9, 9, 1, 0, 9, 2, 9, 9, 0};
	eskel_merge merges[3];
	uint32_t order[4];
	assert_int_equal(eskel_clustering(pairs, 4, merges), ESKEL_OK);
	assert_int_equal(eskel_clustering_order(merges, 4, order), ESKEL_OK);
	assert_memory_equal(order, ((uint32_t[4]){1, 2, 0, 3}), sizeof order);
	assert_int_equal(merges[2].first, 4);
	assert_true(merges[0].height == 1 && merges[1].height == 2 && merges[2].height == 9);
}

static void none_and_one_have_no_tree(void **state)
{
	(void)state;
	uint32_t order = 7;
	assert_int_equal(eskel_clustering(NULL, 0, NULL), ESKEL_OK);
	assert_int_equal(eskel_clustering_order(NULL, 0, &order), ESKEL_OK);
	assert_int_equal(order, 7);
	assert_int_equal(eskel_clustering(&(double){0}, 1, NULL), ESKEL_OK);
	assert_int_equal(eskel_clustering_order(NULL, 1, &order), ESKEL_OK);
	assert_int_equal(order, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(trees_are_those_of_scipy),
		cmocka_unit_test(heights_are_those_of_merging_the_nearest_pair),
		cmocka_unit_test(ties_give_a_tree_and_always_the_same),
		cmocka_unit_test(the_tighter_cluster_comes_first),
		cmocka_unit_test(none_and_one_have_no_tree),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
