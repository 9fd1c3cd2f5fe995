#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "morton.h"
#include "shapes.h"
#include "synthetic.h"

#include <stdlib.h>
#include <string.h>

/* A bit of y, a bit of z, and so on from the lowest. */
static uint64_t interleaved(const esk_segment *s)
{
	uint64_t code = 0;
	for (int bit = 0; bit < 16; bit++) {
		code |= (uint64_t)((s->y + 65536) / 2 >> bit & 1) << (2 * bit);
		code |= (uint64_t)((s->z + 65536) / 2 >> bit & 1) << (2 * bit + 1);
	}
	return code;
}

static int compare(const void *a, const void *b)
{
	const esk_segment *p = a, *q = b;
	if (interleaved(p) != interleaved(q))
		return interleaved(p) < interleaved(q) ? -1 : 1;
	return (p->x_first > q->x_first) - (p->x_first < q->x_first);
}

static void segments_follow_their_codes_and_a_row_its_x(void **state)
{
	(void)state;
	eskel_cloud *cloud = shapes_cloud(&shapes_hamate, &shapes_identity);
	const size_t size = cloud->run_count * sizeof(esk_segment);
	esk_segment *segments = malloc(size), *expected = malloc(size);
	assert_true(segments && expected);
	esk_segments_from_cloud(cloud, segments);
	memcpy(expected, segments, size);
	qsort(expected, cloud->run_count, sizeof *expected, compare);
	assert_int_equal(esk_morton_sort(segments, cloud->run_count), ESKEL_OK);
	assert_memory_equal(segments, expected, size);
	free(segments);
	free(expected);
	eskel_cloud_free(cloud);
}

static void rows_anywhere_are_told_apart(void **state)
{
	(void)state;
	enum { COUNT = 3000 };
	static esk_segment segments[COUNT], expected[COUNT];
	uint64_t random = 1;
	for (int odd = 0; odd < 2; odd++) {
		for (int i = 0; i < COUNT; i++) {
			segments[i] = (esk_segment){.x_first = i,
				.x_last = i,
				.y = 2 * (int32_t)(synthetic_random(&random) % 65535) - 65534 + odd,
				.z = 2 * (int32_t)(synthetic_random(&random) % 65535) - 65534 + odd,
				.weight = 1};
			segments[i].y -= segments[i].y > 65535 ? 2 : 0;
		}
		segments[0].y = segments[1].y;
		segments[0].z = segments[1].z;
		memcpy(expected, segments, sizeof segments);
		qsort(expected, COUNT, sizeof *expected, compare);
		assert_int_equal(esk_morton_sort(segments, COUNT), ESKEL_OK);
		assert_memory_equal(segments, expected, sizeof segments);
	}
}

static void an_upright_shape_keeps_the_order_of_slices(void **state)
{
	(void)state;
	eskel_cloud *cloud = shapes_cloud(&shapes_femur, &shapes_identity);
	const size_t size = cloud->run_count * sizeof(esk_segment);
	esk_segment *segments = malloc(size), *before = malloc(size);
	assert_true(segments && before);
	esk_segments_from_cloud(cloud, segments);
	memcpy(before, segments, size);
	assert_int_equal(esk_morton_sort(segments, cloud->run_count), ESKEL_OK);
	assert_memory_equal(segments, before, size);
	free(segments);
	free(before);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(segments_follow_their_codes_and_a_row_its_x),
		cmocka_unit_test(rows_anywhere_are_told_apart),
		cmocka_unit_test(an_upright_shape_keeps_the_order_of_slices),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
