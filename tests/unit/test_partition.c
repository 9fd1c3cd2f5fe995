#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "levels.h"
#include "morton.h"
#include "partition.h"
#include "real_data.h"
#include "shapes.h"
#include "synthetic.h"
#include "voxel_clustering.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const eskel_affine oblique = {{{0.75, -0.25, 0.125, 20}, {0.25, 1, 0.5, -3}, {0.0625, 0.125, -2.5, 7}}};

/* A cloud ready to be partitioned. */
typedef struct {
	eskel_cloud *cloud;
	esk_segment *segments;
	esk_metric metric;
	eskel_affine world;
} subject;

static void *allocate(size_t count, size_t size)
{
	void *p = calloc(count, size);
	assert_non_null(p);
	return p;
}

/* Takes the cloud. */
static subject prepare(eskel_cloud *cloud, eskel_partition_metric metric)
{
	subject s = {.cloud = cloud, .segments = allocate(cloud->run_count, sizeof *s.segments)};
	esk_segments_from_cloud(cloud, s.segments);
	s.world = esk_segments_world(cloud);
	esk_moments whole = {0};
	for (size_t i = 0; i < cloud->run_count; i++)
		esk_moments_add(&whole, &s.segments[i]);
	if (metric == ESKEL_PARTITION_EUCLIDEAN)
		esk_metric_euclidean(cloud, &s.metric);
	else
		assert_int_equal(esk_metric_mahalanobis(cloud, &whole, &s.metric), ESKEL_OK);
	return s;
}

static void dispose(subject *s)
{
	eskel_cloud_free(s->cloud);
	free(s->segments);
}

static shapes_solid scaled(const shapes_solid *solid, double factor)
{
	shapes_solid small = *solid;
	small.scale *= factor;
	return small;
}

static subject small_hamate(const eskel_affine *affine)
{
	const shapes_solid solid = scaled(&shapes_hamate, 0.6);
	return prepare(shapes_cloud(&solid, affine), ESKEL_PARTITION_EUCLIDEAN);
}

static esk_levels *levels_of(const subject *s, uint32_t levels)
{
	esk_levels *found = allocate(1, sizeof *found);
	const esk_levels_input input = {.segments = s->segments,
		.segment_count = s->cloud->run_count,
		.metric = &s->metric,
		.root_map = &s->world,
		.levels = levels};
	assert_int_equal(esk_levels_compute(&input, found), ESKEL_OK);
	return found;
}

static voxel_set voxels_of(const subject *s)
{
	double map[3][3], root_map[3][3];
	for (int r = 0; r < 3; r++) {
		memcpy(map[r], s->metric.map.m[r], sizeof map[r]);
		memcpy(root_map[r], s->world.m[r], sizeof root_map[r]);
	}
	voxel_set set;
	voxel_set_init(&set, s->cloud, (const int64_t(*)[3])s->metric.form, s->metric.shift, (const double(*)[3])map,
		(const double(*)[3])root_map);
	return set;
}

/* In the order of the runs. */
static void read_labels(const esk_partition *partition, uint8_t *labels)
{
	esk_labelling labelling = {0};
	assert_int_equal(esk_partition_label(partition, &labelling), ESKEL_OK);
	size_t v = 0;
	for (size_t i = 0; i < labelling.count; i++)
		for (uint64_t n = esk_segment_voxels(&labelling.parts[i].segment); n > 0; n--)
			labels[v++] = (uint8_t)labelling.parts[i].class_index;
	esk_labelling_clear(&labelling);
}

static void assert_same_labels(
	const uint8_t *found, const uint8_t *expected, size_t count, const char *where, uint32_t k)
{
	for (size_t v = 0; v < count; v++)
		if (found[v] != expected[v])
			fail_msg("%s, level %u: voxel %zu has class %u, expected %u", where, k, v, found[v],
				expected[v]);
}

/* Every level, voxel by voxel. */
static void check_levels(subject s, uint32_t levels, const char *where)
{
	esk_levels *found = levels_of(&s, levels);
	voxel_set set = voxels_of(&s);
	uint8_t *expected = allocate(set.count, levels), *labels = allocate(set.count, 1);
	assert_int_equal(voxel_clustering(&set, levels, expected), levels);
	assert_int_equal(found->count, levels);
	esk_partition partition;
	assert_int_equal(esk_partition_init(&partition, s.segments, s.cloud->run_count, &s.metric, NULL), ESKEL_OK);
	for (uint32_t k = 1; k <= levels; k++) {
		esk_sums centres[ESKEL_LEVELS_MAX];
		for (uint32_t j = 0; j < k; j++)
			centres[j] = found->classes[ESKEL_NODES(k - 1) + j].sums;
		assert_int_equal(esk_partition_converge(&partition, centres, k), ESKEL_OK);
		read_labels(&partition, labels);
		assert_same_labels(labels, expected + (k - 1) * set.count, set.count, where, k);
	}
	esk_partition_clear(&partition);
	voxel_set_clear(&set);
	free(expected);
	free(labels);
	free(found);
	dispose(&s);
}

static void all_levels_label_voxels_as_plain_clustering_does(void **state)
{
	(void)state;
	const shapes_solid hamate = scaled(&shapes_hamate, 0.6), femur = scaled(&shapes_femur, 0.5);
	check_levels(prepare(shapes_cloud(&hamate, &shapes_identity), ESKEL_PARTITION_EUCLIDEAN), 16, "hamate");
	check_levels(prepare(shapes_cloud(&femur, &shapes_identity), ESKEL_PARTITION_EUCLIDEAN), 12, "femur");
}

static void an_oblique_left_handed_anisotropic_cloud_is_no_different(void **state)
{
	(void)state;
	check_levels(small_hamate(&oblique), 10, "oblique");
}

static void whitened_clouds_are_no_different(void **state)
{
	(void)state;
	const shapes_solid femur = scaled(&shapes_femur, 0.4);
	check_levels(prepare(shapes_cloud(&femur, &oblique), ESKEL_PARTITION_MAHALANOBIS), 10, "whitened");
}

static void weighted_clouds_are_no_different(void **state)
{
	(void)state;
	subject plain = small_hamate(&oblique);
	uint32_t *weights = allocate(plain.cloud->run_count, sizeof *weights);
	for (size_t i = 0; i < plain.cloud->run_count; i++)
		weights[i] = 1 + (plain.cloud->runs[i].z + 1000u * plain.cloud->runs[i].y) % 7 * 1000;
	eskel_cloud *cloud = NULL;
	assert_int_equal(
		eskel_cloud_new(plain.cloud->runs, weights, plain.cloud->run_count, &plain.cloud->affine, &cloud, NULL),
		ESKEL_OK);
	check_levels(prepare(cloud, ESKEL_PARTITION_EUCLIDEAN), 8, "weighted");
	free(weights);
	dispose(&plain);
}

/* Two rows as long as can be, of the greatest weight: sums pass 2^53. */
static void clouds_too_heavy_for_doubles_are_no_different(void **state)
{
	(void)state;
	enum { ROWS = 3 };
	eskel_run runs[ROWS];
	uint32_t weights[ROWS];
	for (uint16_t i = 0; i < ROWS; i++) {
		runs[i] = (eskel_run){.x_first = 0, .x_last = 65534, .y = i, .z = 0};
		weights[i] = (1u << 20) - i;
	}
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(runs, weights, ROWS, &oblique, &cloud, NULL), ESKEL_OK);
	check_levels(prepare(cloud, ESKEL_PARTITION_EUCLIDEAN), 5, "heavy");
}

static void real_bones_are_no_different(void **state)
{
	(void)state;
	static const char *const paths[] = {
		REAL_DATA "MyoSimHand/generic_lunate_R.nii.gz", REAL_DATA "VisibleHuman_Denver/VHF_patella_L.nii.gz"};
	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
		if (!real_file_exists(paths[i])) {
			printf("skipped: %s is not there\n", paths[i]);
			skip();
		}
		eskel_volume *volume = real_volume(paths[i]);
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_volume_cloud(volume, eskel_volume_label(volume, 0), &cloud, NULL), ESKEL_OK);
		eskel_volume_free(volume);
		check_levels(prepare(cloud, ESKEL_PARTITION_EUCLIDEAN), 7, paths[i]);
	}
}

/* Classes around random voxels, and every voxel compared with all of them in integers. */
static void any_number_of_classes_anywhere_is_assigned_by_least_score(void **state)
{
	(void)state;
	subject s = small_hamate(&oblique);
	voxel_set set = voxels_of(&s);
	uint8_t *labels = allocate(set.count, 1), *expected = allocate(set.count, 1);
	esk_partition partition;
	assert_int_equal(esk_partition_init(&partition, s.segments, s.cloud->run_count, &s.metric, NULL), ESKEL_OK);
	uint64_t random = 5;
	for (uint32_t k = 2; k <= ESKEL_LEVELS_MAX; k += 1 + k / 3) {
		esk_scores scores = {.count = k};
		int64_t slow[ESKEL_LEVELS_MAX][4];
		for (uint32_t j = 0; j < k; j++) {
			const int32_t *u = set.u[synthetic_random(&random) % set.count];
			const esk_sums sums = {3, {3 * u[0] + 1, 3 * u[1] - 1, 3 * u[2]}};
			const voxel_centre centre = {3, {sums.first[0], sums.first[1], sums.first[2]}};
			esk_scores_set(&scores, j, &s.metric, &sums);
			voxel_score(&set, &centre, slow[j]);
			assert_true(scores.constant[j] == (double)(64 * slow[j][0] + j));
			for (int r = 0; r < 3; r++)
				assert_true(scores.slope[r][j] == (double)(64 * slow[j][r + 1]));
		}
		for (size_t v = 0; v < set.count; v++) {
			int64_t least = INT64_MAX;
			for (uint32_t j = 0; j < k; j++) {
				int64_t score = slow[j][0] + slow[j][1] * set.u[v][0] + slow[j][2] * set.u[v][1] +
						slow[j][3] * set.u[v][2];
				if (score < least) {
					least = score;
					expected[v] = (uint8_t)j;
				}
			}
		}
		esk_partition_assign(&partition, &scores);
		read_labels(&partition, labels);
		assert_same_labels(labels, expected, set.count, "random classes", k);
	}
	esk_partition_clear(&partition);
	voxel_set_clear(&set);
	free(labels);
	free(expected);
	dispose(&s);
}

static void scores_stay_below_2_51_in_the_largest_box(void **state)
{
	(void)state;
	const uint16_t corners[4][3] = {{0, 0, 0}, {65534, 0, 0}, {0, 65534, 0}, {65534, 65534, 65534}};
	subject s = prepare(shapes_voxels(corners, 4, &oblique), ESKEL_PARTITION_EUCLIDEAN);
	const int64_t w = (int64_t)1 << 44;
	double most = 0;
	for (int corner = 0; corner < 8; corner++) {
		const int64_t u[3] = {
			corner & 1 ? 65534 : -65534, corner & 2 ? 65534 : -65534, corner & 4 ? 65534 : -65534};
		const esk_sums sums = {(uint64_t)w, {w * u[0], w * u[1], w * u[2]}};
		esk_scores scores;
		esk_scores_set(&scores, 0, &s.metric, &sums);
		double bound = fabs(scores.constant[0]);
		for (int r = 0; r < 3; r++) {
			assert_true(scores.slope[r][0] == rint(scores.slope[r][0]));
			bound += fabs(scores.slope[r][0]) * 65534;
		}
		most = fmax(most, bound);
	}
	if (!(most < 0x1p51 && most > 0x1p46))
		fail_msg("scores reach 2^%.2f, expected 2^46 to 2^51", log2(most));
	dispose(&s);
}

static void an_empty_class_takes_the_farthest_voxel_of_another(void **state)
{
	(void)state;
	uint16_t row[9][3] = {{0}};
	for (uint16_t i = 0; i < 9; i++)
		row[i][0] = i;
	subject s = prepare(shapes_voxels((const uint16_t(*)[3])row, 9, &shapes_identity), ESKEL_PARTITION_EUCLIDEAN);
	esk_partition partition;
	assert_int_equal(esk_partition_init(&partition, s.segments, s.cloud->run_count, &s.metric, NULL), ESKEL_OK);
	/* Two classes with one centre: ties go to class 0, so class 1 comes out empty and takes the voxel at u = -8. */
	const esk_sums starts[2] = {{1, {2, 0, 0}}, {1, {2, 0, 0}}};
	assert_int_equal(esk_partition_converge(&partition, starts, 2), ESKEL_OK);
	uint8_t labels[9];
	read_labels(&partition, labels);
	for (int i = 0; i < 9; i++) /* the middle voxel ties in the end, and goes to class 0 */
		assert_int_equal(labels[i], i < 4);
	esk_partition_clear(&partition);
	dispose(&s);
}

static void as_many_classes_as_voxels_get_one_each(void **state)
{
	(void)state;
	uint16_t row[12][3] = {{0}};
	for (uint16_t i = 0; i < 12; i++) {
		row[i][0] = i % 4;
		row[i][1] = i / 4;
	}
	subject s = prepare(shapes_voxels((const uint16_t(*)[3])row, 12, &shapes_identity), ESKEL_PARTITION_EUCLIDEAN);
	esk_partition partition;
	assert_int_equal(esk_partition_init(&partition, s.segments, s.cloud->run_count, &s.metric, NULL), ESKEL_OK);
	esk_sums starts[12];
	for (int j = 0; j < 12; j++)
		starts[j] = (esk_sums){1, {0, 0, 0}};
	assert_int_equal(esk_partition_converge(&partition, starts, 12), ESKEL_OK);
	for (int j = 0; j < 12; j++)
		assert_int_equal(partition.sums[j].weight, 1);
	esk_partition_clear(&partition);
	dispose(&s);
}

static void the_result_does_not_depend_on_the_labels_before(void **state)
{
	(void)state;
	subject s = small_hamate(&shapes_identity);
	esk_levels *levels = levels_of(&s, 9);
	esk_sums from_8[9], result[9];
	for (uint32_t j = 0; j < 8; j++)
		from_8[j] = levels->classes[ESKEL_NODES(7) + j].sums;
	from_8[8] = (esk_sums){1, {3, 5, 7}};
	for (int round = 0; round < 2; round++) {
		esk_partition partition;
		assert_int_equal(
			esk_partition_init(&partition, s.segments, s.cloud->run_count, &s.metric, NULL), ESKEL_OK);
		if (round) { /* reversed classes first */
			esk_sums others[9];
			for (uint32_t j = 0; j < 9; j++)
				others[j] = levels->classes[ESKEL_NODES(8) + 8 - j].sums;
			assert_int_equal(esk_partition_converge(&partition, others, 9), ESKEL_OK);
		}
		assert_int_equal(esk_partition_converge(&partition, from_8, 9), ESKEL_OK);
		if (round)
			assert_memory_equal(partition.sums, result, sizeof result);
		memcpy(result, partition.sums, sizeof result);
		esk_partition_clear(&partition);
	}
	free(levels);
	dispose(&s);
}

/* The moments of both, axis source[r] of a being axis r of b, times sign[r]. */
static void assert_images(const esk_levels *a, const esk_levels *b, const int source[3], const int sign[3])
{
	assert_int_equal(a->count, b->count);
	for (size_t n = 0; n < ESKEL_NODES(a->count); n++) {
		const esk_moments *p = &a->classes[n], *q = &b->classes[n];
		assert_int_equal(p->sums.weight, q->sums.weight);
		for (int r = 0; r < 3; r++) {
			if (q->sums.first[r] != sign[r] * p->sums.first[source[r]])
				fail_msg("node %zu: sum %d is %lld, expected %lld", n, r, (long long)q->sums.first[r],
					(long long)(sign[r] * p->sums.first[source[r]]));
			assert_true(q->second[r][r] == p->second[source[r]][source[r]]);
		}
	}
}

static eskel_cloud *image_of(const eskel_cloud *cloud, const int source[3], const int sign[3])
{
	uint16_t(*voxels)[3] = allocate(cloud->voxels, sizeof *voxels);
	size_t v = 0;
	for (size_t i = 0; i < cloud->run_count; i++)
		for (unsigned x = cloud->runs[i].x_first; x <= cloud->runs[i].x_last; x++, v++) {
			const unsigned p[3] = {x, cloud->runs[i].y, cloud->runs[i].z};
			for (int r = 0; r < 3; r++)
				voxels[v][r] = (uint16_t)(sign[r] > 0 ? p[source[r]]
								      : cloud->extent[source[r]] - 1u - p[source[r]]);
		}
	eskel_cloud *image = shapes_voxels((const uint16_t(*)[3])voxels, cloud->voxels, &shapes_identity);
	free(voxels);
	return image;
}

static void mirrored_and_permuted_clouds_have_exactly_mirrored_and_permuted_classes(void **state)
{
	(void)state;
	static const int sources[5][3] = {{0, 1, 2}, {0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {1, 0, 2}};
	static const int signs[5][3] = {{-1, 1, 1}, {-1, -1, -1}, {1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
	subject s = small_hamate(&shapes_identity);
	esk_levels *levels = levels_of(&s, 16);
	for (int i = 0; i < 5; i++) {
		subject image = prepare(image_of(s.cloud, sources[i], signs[i]), ESKEL_PARTITION_EUCLIDEAN);
		esk_levels *others = levels_of(&image, 16);
		assert_images(levels, others, sources[i], signs[i]);
		free(others);
		dispose(&image);
	}
	free(levels);
	dispose(&s);
}

static void the_order_of_segments_does_not_matter(void **state)
{
	(void)state;
	subject a = small_hamate(&oblique), b = small_hamate(&oblique);
	assert_int_equal(esk_morton_sort(b.segments, b.cloud->run_count), ESKEL_OK);
	assert_memory_not_equal(a.segments, b.segments, a.cloud->run_count * sizeof *a.segments);
	esk_levels *levels[2] = {levels_of(&a, 16), levels_of(&b, 16)};
	assert_images(levels[0], levels[1], (const int[3]){0, 1, 2}, (const int[3]){1, 1, 1});
	free(levels[0]);
	free(levels[1]);
	dispose(&a);
	dispose(&b);
}

static void a_rotated_header_gives_the_same_labels(void **state)
{
	(void)state;
	const double spacing[3] = {0.7, 0.8, 2.1};
	eskel_affine straight = {{{0}}}, rotated = {{{0, 0, 0, 100}, {0, 0, 0, -50}, {0, 0, 0, 1000}}};
	const double c = cos(0.3), d = sin(0.3), rotation[3][3] = {{c, -d, 0}, {d * c, c * c, -d}, {d * d, d * c, c}};
	for (int r = 0; r < 3; r++) {
		straight.m[r][r] = (double)(float)spacing[r];
		for (int k = 0; k < 3; k++)
			rotated.m[r][k] = (double)(float)(rotation[r][k] * spacing[k]);
	}
	subject a = small_hamate(&straight), b = small_hamate(&rotated);
	esk_levels *levels[2] = {levels_of(&a, 12), levels_of(&b, 12)};
	assert_images(levels[0], levels[1], (const int[3]){0, 1, 2}, (const int[3]){1, 1, 1});
	free(levels[0]);
	free(levels[1]);
	dispose(&a);
	dispose(&b);
}

static void whitening_does_not_depend_on_the_affine(void **state)
{
	(void)state;
	const shapes_solid solid = scaled(&shapes_hamate, 0.6);
	subject a = prepare(shapes_cloud(&solid, &shapes_identity), ESKEL_PARTITION_MAHALANOBIS);
	subject b = prepare(shapes_cloud(&solid, &oblique), ESKEL_PARTITION_MAHALANOBIS);
	/* the oblique axes are stored left-handed, so its cloud is flipped along z */
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			const int64_t expected = a.metric.form[r][c] * ((r == 2) == (c == 2) ? 1 : -1);
			if (llabs(b.metric.form[r][c] - expected) > 1)
				fail_msg("form %d,%d is %lld, expected %lld", r, c, (long long)b.metric.form[r][c],
					(long long)expected);
		}
	dispose(&a);
	dispose(&b);
}

/* Rounded entries must not turn the form indefinite: a long thin diagonal line of voxels, two wide. */
static void the_form_of_a_whitened_needle_is_positive(void **state)
{
	(void)state;
	enum { LENGTH = 2000 };
	uint16_t(*voxels)[3] = allocate(2 * LENGTH, sizeof *voxels);
	for (uint16_t i = 0; i < LENGTH; i++)
		for (uint16_t side = 0; side < 2; side++) {
			voxels[2 * i + side][0] = (uint16_t)(i + side);
			voxels[2 * i + side][1] = i;
			voxels[2 * i + side][2] = i / 2;
		}
	subject s = prepare(
		shapes_voxels((const uint16_t(*)[3])voxels, 2 * LENGTH, &shapes_identity), ESKEL_PARTITION_MAHALANOBIS);
	const int64_t along[3] = {2, 2, 1};
	__extension__ __int128 squared = 0;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			squared += along[r] * (__extension__(__int128) s.metric.form[r][c]) * along[c];
	assert_true(squared > 0);
	esk_levels *levels = levels_of(&s, 6);
	assert_int_equal(levels->count, 6);
	free(levels);
	free(voxels);
	dispose(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_levels_label_voxels_as_plain_clustering_does),
		cmocka_unit_test(an_oblique_left_handed_anisotropic_cloud_is_no_different),
		cmocka_unit_test(whitened_clouds_are_no_different),
		cmocka_unit_test(weighted_clouds_are_no_different),
		cmocka_unit_test(clouds_too_heavy_for_doubles_are_no_different),
		cmocka_unit_test(real_bones_are_no_different),
		cmocka_unit_test(any_number_of_classes_anywhere_is_assigned_by_least_score),
		cmocka_unit_test(scores_stay_below_2_51_in_the_largest_box),
		cmocka_unit_test(an_empty_class_takes_the_farthest_voxel_of_another),
		cmocka_unit_test(as_many_classes_as_voxels_get_one_each),
		cmocka_unit_test(the_result_does_not_depend_on_the_labels_before),
		cmocka_unit_test(the_order_of_segments_does_not_matter),
		cmocka_unit_test(mirrored_and_permuted_clouds_have_exactly_mirrored_and_permuted_classes),
		cmocka_unit_test(a_rotated_header_gives_the_same_labels),
		cmocka_unit_test(whitening_does_not_depend_on_the_affine),
		cmocka_unit_test(the_form_of_a_whitened_needle_is_positive),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
