/* Writes meshes into a folder, in every format and frame, for mesh_oracle.py to read: print_mesh FOLDER. */
#include "fields.h"
#include "polygonise.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[ESKEL_MESH_FORMAT_COUNT] = {"stl", "ply", "obj", "glb"};

static void fail(const char *what)
{
	fprintf(stderr, "print_mesh: %s\n", what);
	exit(1);
}

static bool append(void *context, const uint8_t *bytes, size_t size)
{
	return fwrite(bytes, 1, size, context) == size;
}

static void write_all(const char *folder, const char *name, const eskel_mesh *mesh)
{
	for (int format = 0; format < ESKEL_MESH_FORMAT_COUNT; format++)
		for (int frame = 0; frame < 2; frame++) {
			char path[4096];
			snprintf(path, sizeof path, "%s/%s-%s.%s", folder, name, frame ? "lps" : "ras", names[format]);
			FILE *file = fopen(path, "wb");
			if (!file ||
				eskel_mesh_write(mesh, (eskel_mesh_format)format, (eskel_frame)frame, append, file) ||
				fclose(file))
				fail("cannot write a mesh");
		}
	printf("%s %.17g %.17g %zu\n", name, eskel_mesh_volume(mesh), eskel_mesh_area(mesh), mesh->triangle_count);
}

static void write_ellipsoid(const char *folder)
{
	const ellipsoids one = {1, {{{20, -30, 40}, {8, 10, 14}}}};
	const esk_field field = fields_blend(&one);
	const esk_polygonise_options options = {.step = 1,
		.least = {10, -42, 24},
		.greatest = {30, -18, 56},
		.seeds = &one.items[0].centre,
		.seed_count = 1};
	eskel_mesh *mesh = NULL;
	if (esk_polygonise(&field, &options, &mesh, NULL) != ESKEL_OK)
		fail("no ellipsoid");
	write_all(folder, "ellipsoid", mesh);
	eskel_mesh_free(mesh);
}

/* Three that meet in two corners. */
static void write_union(const char *folder)
{
	eskel_primitive primitives[3];
	eskel_surface *surface = NULL;
	eskel_mesh *mesh = NULL;
	for (int i = 0; i < 3; i++)
		primitives[i] = (eskel_primitive){.centre = {7 * (i == 1), 6 * (i == 2), 3},
			.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
			.radii = {6 + i, 7, 8},
			.exponents = {1, 1},
			.alpha = 1};
	if (eskel_surface_compose(primitives, 3, ESKEL_COMPOSE_UNION, &surface) != ESKEL_OK ||
		eskel_surface_mesh(surface, 1, 0, &mesh, NULL) != ESKEL_OK)
		fail("no union");
	write_all(folder, "union", mesh);
	eskel_mesh_free(mesh);
	eskel_surface_free(surface);
}

static void write_voxels(const char *folder)
{
	const eskel_run runs[] = {{0, 3, 0, 0}, {2, 5, 1, 0}, {1, 2, 1, 1}, {4, 4, 2, 1}, {0, 0, 2, 2}};
	const eskel_affine affine = {{{1, 0.2, 0, -5}, {0, 2, 0.3, 7}, {0.1, 0, 3, 11}}};
	eskel_cloud *cloud = NULL;
	eskel_mesh *mesh = NULL;
	if (eskel_cloud_new(runs, NULL, 5, &affine, &cloud, NULL) != ESKEL_OK ||
		eskel_cloud_mesh(cloud, &mesh, NULL) != ESKEL_OK)
		fail("no voxels");
	write_all(folder, "voxels", mesh);
	eskel_mesh_free(mesh);
	eskel_cloud_free(cloud);
}

int main(int argc, char **argv)
{
	if (argc != 2)
		fail("usage: print_mesh FOLDER");
	write_ellipsoid(argv[1]);
	write_union(argv[1]);
	write_voxels(argv[1]);
	return 0;
}
