#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "bytes.h"
#include "partition.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const eskel_affine sheared = {{{0.75, -0.25, 0.125, 20}, {0.25, 1, 0.5, -3}, {0.0625, 0.125, -2.5, 7}}};

static eskel_skeleton *skeleton_of(const eskel_cloud *cloud, const eskel_skeleton_options *options)
{
	eskel_skeleton *skeleton = NULL;
	eskel_error error = {0};
	if (eskel_skeleton_new(cloud, options, &skeleton, &error))
		fail_msg("no skeleton: %s", error.text);
	return skeleton;
}

/* Takes the cloud. */
static eskel_skeleton *skeleton_from(eskel_cloud *cloud, uint32_t levels)
{
	eskel_skeleton *skeleton = skeleton_of(cloud, &(eskel_skeleton_options){.levels = levels});
	eskel_cloud_free(cloud);
	return skeleton;
}

static eskel_cloud *small_hamate(const eskel_affine *affine)
{
	shapes_solid solid = shapes_hamate;
	solid.scale *= 0.6;
	return shapes_cloud(&solid, affine);
}

static eskel_cloud *box(unsigned nx, unsigned ny, unsigned nz, const eskel_affine *affine)
{
	uint16_t(*voxels)[3] = calloc(nx * ny * nz, sizeof *voxels);
	assert_non_null(voxels);
	size_t count = 0;
	for (unsigned z = 0; z < nz; z++)
		for (unsigned y = 0; y < ny; y++)
			for (unsigned x = 0; x < nx; x++, count++) {
				voxels[count][0] = (uint16_t)x;
				voxels[count][1] = (uint16_t)y;
				voxels[count][2] = (uint16_t)z;
			}
	eskel_cloud *cloud = shapes_voxels((const uint16_t(*)[3])voxels, count, affine);
	free(voxels);
	return cloud;
}

static void assert_near(double found, double expected, double tolerance, const char *what)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%s is %.17g, expected %.17g", what, found, expected);
}

static double trace(const eskel_node *node)
{
	return node->covariance[0][0] + node->covariance[1][1] + node->covariance[2][2];
}

/* What holds for every skeleton in the world metric. */
static void check(const eskel_skeleton *s)
{
	const eskel_node *root = &s->nodes[0];
	assert_int_equal(root->voxels, s->voxels);
	for (uint32_t k = 1; k <= s->level_count; k++) {
		const eskel_level *level = &s->levels[k - 1];
		uint64_t voxels = 0;
		double weight = 0, inside = 0, between = 0;
		assert_int_equal(level->level, k);
		for (uint32_t c = 0; c < k; c++) {
			const eskel_node *node = eskel_skeleton_node(s, k, c);
			assert_int_equal(node->level, k);
			assert_int_equal(node->class_index, c);
			assert_true(node->voxels > 0 && node->weight > 0);
			assert_true(node->eigenvalues[0] >= node->eigenvalues[1]);
			assert_true(node->eigenvalues[1] >= node->eigenvalues[2] && node->eigenvalues[2] >= 0);
			assert_near(node->eigenvalues[0] + node->eigenvalues[1] + node->eigenvalues[2], trace(node),
				1e-12 * trace(root), "the sum of eigenvalues");
			double squared = 0;
			for (int r = 0; r < 3; r++)
				squared += (node->centre[r] - root->centre[r]) * (node->centre[r] - root->centre[r]);
			assert_near(node->rho, sqrt(squared), 1e-12 * sqrt(trace(root)), "rho");
			voxels += node->voxels;
			weight += node->weight;
			inside += node->weight * trace(node);
			between += node->weight * squared;
			if (k == 1)
				assert_int_equal(node->parent, -1);
			else {
				uint32_t children[2];
				unsigned n = eskel_skeleton_children(s, k - 1, (uint32_t)node->parent, children);
				assert_true(n >= 1 && (children[0] == c || (n == 2 && children[1] == c)));
			}
		}
		assert_int_equal(voxels, s->voxels);
		assert_near(weight, s->weight, 0, "the weight of a level");
		assert_near(inside + between, s->weight * trace(root), 1e-10 * s->weight * trace(root),
			"inertia within classes and between them");
		if (trace(root) > 0)
			assert_near(level->intraclass_ratio, inside / (s->weight * trace(root)), 2e-6,
				"the intraclass ratio");
		if (k > 1) {
			assert_true(level->split_class >= 0 && level->split_class < (int)k - 1);
			assert_true(level->split_ratio >= 0 && level->split_ratio < 1);
		}
	}
	const uint32_t five = s->level_of_5_percent;
	for (uint32_t k = 1; k <= s->level_count; k++)
		assert_int_equal(s->levels[k - 1].intraclass_ratio <= 0.05, five != 0 && k >= five);
}

static void a_skeleton_has_sixteen_levels_that_decompose_the_variance(void **state)
{
	(void)state;
	eskel_cloud *cloud = small_hamate(&sheared);
	eskel_skeleton *s = skeleton_of(cloud, NULL);
	assert_int_equal(s->level_count, 16);
	assert_near(s->volume, eskel_cloud_volume(cloud), 0, "the volume");
	check(s);
	eskel_skeleton_free(s);
	eskel_cloud_free(cloud);
}

static void a_tube_reaches_five_percent_and_a_bulky_shape_does_not(void **state)
{
	(void)state;
	shapes_solid femur = shapes_femur;
	femur.scale *= 0.4;
	eskel_skeleton *s = skeleton_from(shapes_cloud(&femur, &shapes_identity), 10);
	check(s);
	assert_int_equal(s->level_of_5_percent, 5);
	eskel_skeleton_free(s);
	s = skeleton_from(small_hamate(&shapes_identity), 10);
	check(s);
	assert_int_equal(s->level_of_5_percent, 0);
	eskel_skeleton_free(s);
}

static void one_voxel_has_one_level(void **state)
{
	(void)state;
	eskel_skeleton *s = skeleton_from(box(1, 1, 1, &sheared), 16);
	check(s);
	assert_int_equal(s->level_count, 1);
	assert_int_equal(s->level_of_5_percent, 1);
	assert_true(s->levels[0].intraclass_ratio == 0);
	assert_true(s->nodes[0].eigenvalues[0] == 0 && s->nodes[0].rho == 0);
	eskel_skeleton_free(s);
}

static void two_voxels_have_two_levels(void **state)
{
	(void)state;
	const uint16_t voxels[2][3] = {{0, 3, 1}, {2, 0, 0}};
	eskel_skeleton *s = skeleton_from(shapes_voxels(voxels, 2, &shapes_identity), 16);
	check(s);
	assert_int_equal(s->level_count, 2);
	assert_near(s->nodes[0].eigenvalues[0], 14. / 4, 1e-14, "the variance of two points");
	assert_true(s->nodes[0].eigenvalues[1] == 0);
	assert_near(s->nodes[1].rho, sqrt(14) / 2, 1e-14, "rho");
	assert_true(s->levels[1].split_ratio == 0 && s->levels[1].intraclass_ratio == 0);
	eskel_skeleton_free(s);
}

static void n_voxels_have_n_levels(void **state)
{
	(void)state;
	eskel_skeleton *s = skeleton_from(box(3, 2, 2, &shapes_identity), ESKEL_LEVELS_MAX);
	check(s);
	assert_int_equal(s->level_count, 12);
	for (uint32_t c = 0; c < 12; c++)
		assert_int_equal(eskel_skeleton_node(s, 12, c)->voxels, 1);
	eskel_skeleton_free(s);
}

static void a_line_has_one_direction_and_splits_in_halves(void **state)
{
	(void)state;
	eskel_skeleton *s = skeleton_from(box(1, 64, 1, &sheared), 4);
	check(s);
	assert_true(s->nodes[0].eigenvalues[1] == 0 && s->nodes[0].eigenvalues[2] == 0);
	assert_false(s->levels[1].degenerate);
	for (uint32_t c = 0; c < 2; c++)
		assert_int_equal(eskel_skeleton_node(s, 2, c)->voxels, 32);
	eskel_skeleton_free(s);
}

static void a_plane_is_flat_at_every_level(void **state)
{
	(void)state;
	eskel_skeleton *s = skeleton_from(box(40, 25, 1, &sheared), 8);
	check(s);
	for (size_t n = 0; n < ESKEL_NODES(8); n++)
		assert_true(s->nodes[n].eigenvalues[1] > 0 && s->nodes[n].eigenvalues[2] == 0);
	eskel_skeleton_free(s);
}

static void a_ball_is_degenerate_and_splits_along_x(void **state)
{
	(void)state;
	const shapes_rod ball = {{12, 12, 12}, {12, 12, 12}, 11.3, 11.3};
	const shapes_solid solid = {&ball, 1, 1, {25, 25, 25}};
	eskel_skeleton *s = skeleton_from(shapes_cloud(&solid, &shapes_identity), 2);
	check(s);
	assert_true(s->levels[1].degenerate);
	assert_near(s->nodes[0].eigenvalues[2], s->nodes[0].eigenvalues[0], 1e-12, "the least eigenvalue");
	for (int c = 1; c <= 2; c++) {
		assert_near(s->nodes[c].centre[1], s->nodes[0].centre[1], 0.5, "y of a half");
		assert_near(s->nodes[c].centre[2], s->nodes[0].centre[2], 0.5, "z of a half");
	}
	eskel_skeleton_free(s);
}

/* An even cube is full of ties: in axes, in ratios and in voxels between classes. */
static void a_cube_has_the_same_skeleton_from_every_side(void **state)
{
	(void)state;
	static const eskel_affine turned = {{{0, 0, 1, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}}};
	eskel_cloud *a = box(8, 8, 8, &shapes_identity), *b = box(8, 8, 8, &turned);
	eskel_skeleton *p = skeleton_from(a, 12), *q = skeleton_from(b, 12);
	check(p);
	assert_int_equal(p->level_count, q->level_count);
	assert_memory_equal(p->levels, q->levels, p->level_count * sizeof *p->levels);
	eskel_skeleton_free(p);
	eskel_skeleton_free(q);
}

static void a_cloud_far_from_the_origin_has_the_same_covariances(void **state)
{
	(void)state;
	eskel_affine far = shapes_identity;
	far.m[0][3] = 1048576;
	far.m[1][3] = -524288;
	eskel_skeleton *near = skeleton_from(small_hamate(&shapes_identity), 8);
	eskel_skeleton *away = skeleton_from(small_hamate(&far), 8);
	for (size_t n = 0; n < ESKEL_NODES(8); n++) {
		assert_memory_equal(
			near->nodes[n].covariance, away->nodes[n].covariance, sizeof near->nodes[n].covariance);
		assert_near(away->nodes[n].rho, near->nodes[n].rho, 1e-8, "rho");
		assert_near(away->nodes[n].centre[0] - 1048576, near->nodes[n].centre[0], 1e-8, "x");
	}
	eskel_skeleton_free(near);
	eskel_skeleton_free(away);
}

static void a_left_handed_file_of_the_same_object_gives_the_same_skeleton(void **state)
{
	(void)state;
	eskel_cloud *cloud = small_hamate(&shapes_identity);
	eskel_run *runs = calloc(cloud->run_count, sizeof *runs);
	assert_non_null(runs);
	const uint16_t last = (uint16_t)(cloud->extent[0] - 1);
	for (size_t i = 0; i < cloud->run_count; i++) {
		runs[i] = cloud->runs[i];
		runs[i].x_first = (uint16_t)(last - cloud->runs[i].x_last);
		runs[i].x_last = (uint16_t)(last - cloud->runs[i].x_first);
	}
	eskel_affine left = cloud->affine;
	left.m[0][0] = -left.m[0][0];
	left.m[0][3] += last;
	eskel_cloud *other = NULL;
	assert_int_equal(eskel_cloud_new(runs, NULL, cloud->run_count, &left, &other, NULL), ESKEL_OK);
	eskel_skeleton *p = skeleton_from(cloud, 8), *q = skeleton_from(other, 8);
	for (size_t n = 0; n < ESKEL_NODES(8); n++)
		assert_memory_equal(&p->nodes[n], &q->nodes[n], sizeof p->nodes[n]);
	free(runs);
	eskel_skeleton_free(p);
	eskel_skeleton_free(q);
}

static eskel_cloud *weighted(const eskel_cloud *cloud, uint32_t weight)
{
	uint32_t *weights = calloc(cloud->run_count, sizeof *weights);
	assert_non_null(weights);
	for (size_t i = 0; i < cloud->run_count; i++)
		weights[i] = weight;
	eskel_cloud *made = NULL;
	assert_int_equal(
		eskel_cloud_new(cloud->runs, weights, cloud->run_count, &cloud->affine, &made, NULL), ESKEL_OK);
	free(weights);
	return made;
}

static void doubling_every_weight_changes_only_weights(void **state)
{
	(void)state;
	eskel_cloud *cloud = small_hamate(&sheared);
	eskel_skeleton *twice = skeleton_from(weighted(cloud, 2), 10), *once = skeleton_from(cloud, 10);
	assert_memory_equal(once->levels, twice->levels, 10 * sizeof *once->levels);
	for (size_t n = 0; n < ESKEL_NODES(10); n++) {
		assert_near(twice->nodes[n].weight, 2 * once->nodes[n].weight, 0, "a weight");
		twice->nodes[n].weight = once->nodes[n].weight;
		assert_memory_equal(&once->nodes[n], &twice->nodes[n], sizeof once->nodes[n]);
	}
	eskel_skeleton_free(once);
	eskel_skeleton_free(twice);
}

/* 1 1 and 2 at x = 0, 1 and 3, against the points 0 1 3 3. */
static void weight_two_is_two_voxels_in_one_place(void **state)
{
	(void)state;
	const eskel_run runs[2] = {{0, 1, 0, 0}, {3, 3, 0, 0}};
	const uint32_t weights[2] = {1, 2};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(runs, weights, 2, &shapes_identity, &cloud, NULL), ESKEL_OK);
	eskel_skeleton *s = skeleton_from(cloud, 5);
	check(s);
	assert_int_equal(s->level_count, 3);
	assert_near(s->weight, 4, 0, "the weight");
	assert_near(s->nodes[0].centre[0], 7. / 4, 1e-15, "the centre");
	assert_near(s->nodes[0].eigenvalues[0], (0 + 1 + 9 + 9) / 4. - 49. / 16, 1e-14, "the variance");
	assert_near(s->nodes[1].weight, 2, 0, "the weight of a half");
	assert_near(
		s->levels[1].split_ratio, 0.5 / 6.75, 2e-10, "the ratio of the split"); /* of 2 * 1/4 to 4 * 27/16 */
	eskel_skeleton_free(s);
}

/* Nothing moves when clustering goes on from the centres of a level. */
static void coarse_starts_end_in_fixed_points_of_the_full_cloud(void **state)
{
	(void)state;
	const eskel_partition_metric metrics[2] = {ESKEL_PARTITION_EUCLIDEAN, ESKEL_PARTITION_MAHALANOBIS};
	eskel_cloud *cloud = small_hamate(&sheared);
	esk_segment *segments = calloc(cloud->run_count, sizeof *segments);
	assert_non_null(segments);
	esk_segments_from_cloud(cloud, segments);
	esk_moments whole = {0};
	for (size_t i = 0; i < cloud->run_count; i++)
		esk_moments_add(&whole, &segments[i]);
	for (int m = 0; m < 2; m++) {
		eskel_skeleton *s = skeleton_of(
			cloud, &(eskel_skeleton_options){.levels = 10, .metric = metrics[m], .coarse_start = true});
		assert_true(s->coarse_start && s->metric == metrics[m]);
		if (metrics[m] == ESKEL_PARTITION_EUCLIDEAN)
			check(s);
		esk_metric metric;
		if (metrics[m] == ESKEL_PARTITION_EUCLIDEAN)
			esk_metric_euclidean(cloud, &metric);
		else
			assert_int_equal(esk_metric_mahalanobis(cloud, &whole, &metric), ESKEL_OK);
		esk_partition partition;
		assert_int_equal(esk_partition_init(&partition, segments, cloud->run_count, &metric, NULL), ESKEL_OK);
		/* a node's centre gives back its integer sums */
		const eskel_affine *a = &cloud->affine;
		double det = eskel_affine_determinant(a);
		for (uint32_t k = 1; k <= 10; k++) {
			esk_sums sums[10];
			for (uint32_t c = 0; c < k; c++) {
				const eskel_node *node = eskel_skeleton_node(s, k, c);
				double d[3], x[3];
				for (int r = 0; r < 3; r++)
					d[r] = node->centre[r] - a->m[r][3];
				for (int r = 0; r < 3; r++) { /* Cramer's rule */
					eskel_affine swapped = *a;
					for (int i = 0; i < 3; i++)
						swapped.m[i][r] = d[i];
					x[r] = eskel_affine_determinant(&swapped) / det;
				}
				sums[c].weight = node->voxels;
				for (int r = 0; r < 3; r++)
					sums[c].first[r] =
						llround((2 * x[r] - (cloud->extent[r] - 1)) * (double)node->voxels);
			}
			assert_int_equal(esk_partition_converge(&partition, sums, k), ESKEL_OK);
			for (uint32_t c = 0; c < k; c++) {
				assert_int_equal(partition.sums[c].weight, sums[c].weight);
				assert_memory_equal(
					partition.sums[c].first, sums[c].first, sizeof sums[c].first);
			}
		}
		esk_partition_clear(&partition);
		eskel_skeleton_free(s);
	}
	free(segments);
	eskel_cloud_free(cloud);
}

static void a_coarse_start_goes_on_by_splitting_where_cells_run_out(void **state)
{
	(void)state;
	eskel_cloud *cloud = box(4, 3, 2, &shapes_identity);
	eskel_skeleton *s = skeleton_of(cloud, &(eskel_skeleton_options){.levels = 64, .coarse_start = true});
	check(s);
	assert_int_equal(s->level_count, 24);
	eskel_skeleton_free(s);
	eskel_cloud_free(cloud);
}

static void a_flat_cloud_can_be_whitened(void **state)
{
	(void)state;
	eskel_cloud *cloud = box(20, 10, 1, &sheared);
	const eskel_skeleton_options options = {.levels = 6, .metric = ESKEL_PARTITION_MAHALANOBIS};
	eskel_skeleton *s = skeleton_of(cloud, &options);
	assert_int_equal(s->level_count, 6);
	eskel_skeleton_free(s);
	eskel_cloud_free(cloud);
}

typedef struct {
	uint32_t calls, stop_at;
} watcher;

static bool watch(void *context, uint32_t level, uint32_t levels)
{
	watcher *w = context;
	w->calls++;
	assert_int_equal(level, w->calls);
	assert_int_equal(levels, 6);
	return level != w->stop_at;
}

static void progress_is_told_of_every_level_and_can_stop(void **state)
{
	(void)state;
	eskel_cloud *cloud = small_hamate(&shapes_identity);
	watcher all = {0, 0}, some = {0, 3};
	eskel_skeleton_options options = {.levels = 6, .progress = watch, .context = &all};
	eskel_skeleton_free(skeleton_of(cloud, &options));
	assert_int_equal(all.calls, 6);
	eskel_skeleton *skeleton = NULL;
	options.context = &some;
	assert_int_equal(eskel_skeleton_new(cloud, &options, &skeleton, NULL), ESKEL_CANCELLED);
	assert_int_equal(some.calls, 3);
	assert_null(skeleton);
	eskel_cloud_free(cloud);
}

static void options_out_of_range_are_refused_by_value(void **state)
{
	(void)state;
	eskel_cloud *cloud = box(2, 2, 2, &shapes_identity);
	eskel_skeleton *skeleton = NULL;
	eskel_error error = {0};
	assert_int_equal(
		eskel_skeleton_new(cloud, &(eskel_skeleton_options){.levels = 65}, &skeleton, &error), ESKEL_INVALID);
	assert_non_null(strstr(error.text, "65 levels"));
	assert_int_equal(
		eskel_skeleton_new(cloud, &(eskel_skeleton_options){.metric = 2}, &skeleton, &error), ESKEL_INVALID);
	assert_null(skeleton);
	eskel_cloud_free(cloud);
}

/* ---------------------------------------------------------------------------------------------- bytes */

typedef struct {
	uint8_t *bytes;
	size_t size;
} encoding;

static encoding encode(const eskel_skeleton *s)
{
	encoding e = {NULL, 0};
	assert_int_equal(eskel_skeleton_encode(s, &e.bytes, &e.size), ESKEL_OK);
	return e;
}

static encoding sample(void)
{
	eskel_skeleton *s = skeleton_from(box(5, 4, 3, &sheared), 3);
	encoding e = encode(s);
	eskel_skeleton_free(s);
	return e;
}

static void a_decoded_skeleton_is_the_same_to_the_last_bit(void **state)
{
	(void)state;
	for (int m = 0; m < 2; m++) {
		eskel_cloud *cloud = small_hamate(&sheared);
		eskel_skeleton *s = skeleton_of(
			cloud, &(eskel_skeleton_options){
				       .levels = 16, .metric = (eskel_partition_metric)m, .coarse_start = m});
		encoding e = encode(s);
		eskel_skeleton *again = NULL;
		assert_int_equal(eskel_skeleton_decode(e.bytes, e.size, &again, NULL), ESKEL_OK);
		assert_int_equal(again->level_count, s->level_count);
		assert_int_equal(again->level_of_5_percent, s->level_of_5_percent);
		assert_int_equal(again->metric, s->metric);
		assert_int_equal(again->coarse_start, s->coarse_start);
		assert_int_equal(again->voxels, s->voxels);
		assert_true(again->weight == s->weight && again->volume == s->volume);
		assert_memory_equal(again->levels, s->levels, s->level_count * sizeof *s->levels);
		assert_memory_equal(again->nodes, s->nodes, ESKEL_NODES(s->level_count) * sizeof *s->nodes);
		encoding twice = encode(again);
		assert_int_equal(twice.size, e.size);
		assert_memory_equal(twice.bytes, e.bytes, e.size);
		free(e.bytes);
		free(twice.bytes);
		eskel_skeleton_free(s);
		eskel_skeleton_free(again);
		eskel_cloud_free(cloud);
	}
}

static void every_shorter_or_longer_encoding_is_refused(void **state)
{
	(void)state;
	encoding e = sample();
	eskel_skeleton *s = NULL;
	for (size_t size = 0; size < e.size; size++) {
		uint8_t *cut = malloc(size ? size : 1);
		assert_non_null(cut);
		memcpy(cut, e.bytes, size);
		assert_int_equal(eskel_skeleton_decode(cut, size, &s, NULL), ESKEL_TRUNCATED);
		free(cut);
	}
	e.bytes = realloc(e.bytes, e.size + 1);
	assert_non_null(e.bytes);
	e.bytes[e.size] = 0;
	assert_int_equal(eskel_skeleton_decode(e.bytes, e.size + 1, &s, NULL), ESKEL_MALFORMED);
	assert_null(s);
	free(e.bytes);
}

static void assert_refused(size_t offset, double value, eskel_status expected)
{
	encoding e = sample();
	eskel_skeleton *s = NULL;
	eskel_error error = {0};
	esk_bytes_put_f64(e.bytes + offset, value);
	eskel_status status = eskel_skeleton_decode(e.bytes, e.size, &s, &error);
	if (status != expected)
		fail_msg("%g at %zu: status %d (%s), expected %d", value, offset, status, error.text, expected);
	assert_null(s);
	free(e.bytes);
}

static void numbers_out_of_range_are_refused(void **state)
{
	(void)state;
	const size_t level = 12, node = level + 3 * 18;
	assert_refused(4, -1, ESKEL_MALFORMED); /* the volume */
	assert_refused(4, INFINITY, ESKEL_MALFORMED);
	assert_refused(level + 18 + 2, -0.5, ESKEL_MALFORMED); /* ratios */
	assert_refused(level + 18 + 10, NAN, ESKEL_MALFORMED);
	assert_refused(level + 2, 0.5, ESKEL_MALFORMED); /* level 1 was not split */
	assert_refused(node + 8, 0, ESKEL_MALFORMED);    /* the weight */
	assert_refused(node + 16, NAN, ESKEL_MALFORMED); /* the centre */
	assert_refused(node + 40, -1, ESKEL_MALFORMED);  /* the covariance */
	assert_refused(node + 48, INFINITY, ESKEL_MALFORMED);
	assert_refused(node + 88 + 16, 1e300, ESKEL_MALFORMED); /* a rho that overflows */
}

static void flags_counts_and_versions_out_of_range_are_refused(void **state)
{
	(void)state;
	static const struct {
		size_t offset;
		uint8_t value;
		eskel_status status;
	} cases[] = {
		{0, 2, ESKEL_UNSUPPORTED},
		{1, 2, ESKEL_MALFORMED},
		{2, 2, ESKEL_MALFORMED},
		{3, 0, ESKEL_MALFORMED},
		{3, 65, ESKEL_MALFORMED},
		{12, 0, ESKEL_MALFORMED},
		{13, 1, ESKEL_MALFORMED},
		{30, 1, ESKEL_MALFORMED},
		{31, 2, ESKEL_MALFORMED},
		{66, 59, ESKEL_MALFORMED},
		{67, 1, ESKEL_MALFORMED},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		encoding e = sample();
		eskel_skeleton *s = NULL;
		e.bytes[cases[i].offset] = cases[i].value;
		eskel_status status = eskel_skeleton_decode(e.bytes, e.size, &s, NULL);
		if (status != cases[i].status)
			fail_msg("%u at %zu: status %d, expected %d", cases[i].value, cases[i].offset, status,
				cases[i].status);
		free(e.bytes);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_skeleton_has_sixteen_levels_that_decompose_the_variance),
		cmocka_unit_test(a_tube_reaches_five_percent_and_a_bulky_shape_does_not),
		cmocka_unit_test(one_voxel_has_one_level),
		cmocka_unit_test(two_voxels_have_two_levels),
		cmocka_unit_test(n_voxels_have_n_levels),
		cmocka_unit_test(a_line_has_one_direction_and_splits_in_halves),
		cmocka_unit_test(a_plane_is_flat_at_every_level),
		cmocka_unit_test(a_ball_is_degenerate_and_splits_along_x),
		cmocka_unit_test(a_cube_has_the_same_skeleton_from_every_side),
		cmocka_unit_test(a_cloud_far_from_the_origin_has_the_same_covariances),
		cmocka_unit_test(a_left_handed_file_of_the_same_object_gives_the_same_skeleton),
		cmocka_unit_test(doubling_every_weight_changes_only_weights),
		cmocka_unit_test(weight_two_is_two_voxels_in_one_place),
		cmocka_unit_test(coarse_starts_end_in_fixed_points_of_the_full_cloud),
		cmocka_unit_test(a_coarse_start_goes_on_by_splitting_where_cells_run_out),
		cmocka_unit_test(a_flat_cloud_can_be_whitened),
		cmocka_unit_test(progress_is_told_of_every_level_and_can_stop),
		cmocka_unit_test(options_out_of_range_are_refused_by_value),
		cmocka_unit_test(a_decoded_skeleton_is_the_same_to_the_last_bit),
		cmocka_unit_test(every_shorter_or_longer_encoding_is_refused),
		cmocka_unit_test(numbers_out_of_range_are_refused),
		cmocka_unit_test(flags_counts_and_versions_out_of_range_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
