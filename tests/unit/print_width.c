/* A sum over all bytes of the meshes of a blend and of a union: print_width. Compiled for each width of vectors that the
 * engine chooses from when it is loaded; 77 where the processor does not have this one. */
#include "composition.h"
#include "polygonise.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CLASSES = 7 };

/* Ellipsoids and superquadrics, some bent, that overlap. */
static void make_primitive(uint64_t *random, int i, eskel_primitive *p)
{
	double step[ESK_PARAMETERS_ALL] = {0};
	*p = (eskel_primitive){.kind = ESKEL_PRIMITIVE_DEFORMED,
		.centre = {4 * sin(i), 3 * cos(2 * i), 3 * i},
		.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
		.radii = {4, 5, 6},
		.exponents = {1, 1},
		.alpha = 1 + 0.2 * i};
	for (int t = ESK_ROTATION; t < ESK_LOG_RADII; t++)
		step[t] = synthetic_uniform(random) - 0.5;
	if (i % 3 == 1)
		step[ESK_EXPONENTS] = -0.4;
	if (i % 3 == 2)
		step[ESK_FIRST_MODES + 2] = 0.2;
	esk_primitive_step(p, step, ESK_PARAMETERS_ALL, p);
}

static uint64_t add_bytes(uint64_t sum, const void *bytes, size_t size)
{
	const unsigned char *b = bytes;
	for (size_t i = 0; i < size; i++)
		sum = (sum ^ b[i]) * 0x100000001b3; /* FNV-1a */
	return sum;
}

static bool print_mesh(const eskel_primitive *primitives, eskel_compose compose)
{
	esk_composition composition;
	double seeds[CLASSES][3];
	eskel_mesh *mesh;
	for (int i = 0; i < CLASSES; i++)
		memcpy(seeds[i], primitives[i].centre, sizeof seeds[i]);
	esk_composition_make(primitives, CLASSES, compose, &composition);
	const esk_field field = esk_composition_field(&composition);
	const esk_polygonise_options options = {.step = 0.4,
		.least = {-40, -40, -40},
		.greatest = {40, 40, 60},
		.seeds = (const double(*)[3])seeds,
		.seed_count = CLASSES};
	if (esk_polygonise(&field, &options, &mesh, NULL) != ESKEL_OK)
		return false;
	uint64_t sum = 0xcbf29ce484222325;
	sum = add_bytes(sum, mesh->vertices, mesh->vertex_count * sizeof *mesh->vertices);
	sum = add_bytes(sum, mesh->normals, mesh->vertex_count * sizeof *mesh->normals);
	sum = add_bytes(sum, mesh->triangles, mesh->triangle_count * sizeof *mesh->triangles);
	printf("%zu vertices, %zu triangles, %016llx\n", mesh->vertex_count, mesh->triangle_count,
		(unsigned long long)sum);
	eskel_mesh_free(mesh);
	return true;
}

int main(void)
{
#ifdef NEEDED
	if (!__builtin_cpu_supports(NEEDED))
		return 77;
#endif
	eskel_primitive primitives[CLASSES];
	uint64_t random = 1;
	for (int i = 0; i < CLASSES; i++)
		make_primitive(&random, i, &primitives[i]);
	return print_mesh(primitives, ESKEL_COMPOSE_BLEND) && print_mesh(primitives, ESKEL_COMPOSE_UNION) ? 0 : 1;
}
