/* Surfaces of real bones against the label maps of the same bones. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "real_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[] = {"VHF_cuboid_L", "VHF_cuboid_R", "VHF_talus_L", "VHF_talus_R", "VHM_cuboid_L",
	"VHM_cuboid_R", "VHM_talus_L", "VHM_talus_R"};
enum { count = sizeof names / sizeof *names };

static double distance(const real_shape *a, const real_shape *b)
{
	double d;
	assert_int_equal(eskel_distance(a->signature, b->signature, NULL, &d, NULL, NULL), ESKEL_OK);
	return d;
}

static void a_surface_is_the_bone_of_its_label_map(void **state)
{
	(void)state;
	static real_shape maps[count];
	char path[256];
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof path, REAL_DATA "VisibleHuman_Denver/%s.nii.gz", names[i]);
		real_shape_read(&maps[i], path);
	}
	for (int i = 0; i < count; i++) {
		real_shape mesh = {0};
		int nearest = 0;
		snprintf(path, sizeof path, REAL_DATA "meshes/%s.stl", names[i]);
		real_shape_read(&mesh, path);
		double volume = eskel_cloud_volume(mesh.cloud), expected = eskel_cloud_volume(maps[i].cloud);
		assert_in_range(mesh.cloud->voxels, 99500, 100500); /* of the mesh's own volume, within 0.5 % */
		if (fabs(volume - expected) > 0.01 * expected)
			fail_msg("%s: the volume is %g, expected %g", names[i], volume, expected);
		for (int r = 0; r < 3; r++)
			assert_true(
				fabs(mesh.skeleton->nodes[0].centre[r] - maps[i].skeleton->nodes[0].centre[r]) < 0.2);
		for (int j = 1; j < count; j++)
			if (distance(&mesh, &maps[j]) < distance(&mesh, &maps[nearest]))
				nearest = j;
		assert_string_equal(names[nearest], names[i]);
		real_shape_clear(&mesh);
	}
	for (int i = 0; i < count; i++)
		real_shape_clear(&maps[i]);
}

int main(void)
{
	if (!real_file_exists(REAL_DATA "manifest.csv")) {
		printf("skipped: there is no " REAL_DATA "manifest.csv\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(a_surface_is_the_bone_of_its_label_map)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
