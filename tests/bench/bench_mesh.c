/* Time of the surface of ten ellipsoids, blended and united: bench_mesh FIGURE STEPS [FILE]
 *
 * The step is the longest side of their box over STEPS. With FILE, writes the values on a cubic grid of that step, as
 * floats after three 32-bit extents: what the peers take. */
#include "composition.h"
#include "fields.h"
#include "measure.h"
#include "polygonise.h"
#include "union_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	eskel_primitive primitives[10];
	esk_composition composition;
	esk_field field;
	double seeds[10][3];
	esk_polygonise_options options;
	eskel_mesh *mesh;
} scene;

static void fail(const char *what)
{
	fprintf(stderr, "bench_mesh: %s\n", what);
	exit(1);
}

static eskel_primitive primitive_of(const ellipsoid *e)
{
	eskel_primitive made = {.kind = ESKEL_PRIMITIVE_ELLIPSOID, .exponents = {1, 1}, .alpha = 1};
	for (int a = 0; a < 3; a++) {
		made.centre[a] = e->centre[a];
		made.radii[a] = e->radii[a];
		made.axes[a][a] = 1;
	}
	return made;
}

/* The blend reaches further than its parts: by a factor of 1.7 at most here. */
static void set_up(scene *s, double steps)
{
	ellipsoids ten;
	fields_ten(&ten);
	for (int i = 0; i < 10; i++)
		s->primitives[i] = primitive_of(&ten.items[i]);
	esk_composition_make(s->primitives, 10, ESKEL_COMPOSE_BLEND, &s->composition);
	s->field = esk_composition_field(&s->composition);
	double longest = 0;
	for (int a = 0; a < 3; a++) {
		double least = 1e300, greatest = -1e300;
		for (int i = 0; i < 10; i++) {
			const ellipsoid *e = &ten.items[i];
			const double low = e->centre[a] - 1.7 * e->radii[a], high = e->centre[a] + 1.7 * e->radii[a];
			least = low < least ? low : least;
			greatest = high > greatest ? high : greatest;
			s->seeds[i][a] = e->centre[a];
		}
		s->options.least[a] = least;
		s->options.greatest[a] = greatest;
		longest = greatest - least > longest ? greatest - least : longest;
	}
	s->options.step = longest / steps;
	s->options.seeds = (const double(*)[3])s->seeds;
	s->options.seed_count = 10;
}

static void polygonise(void *context)
{
	scene *s = context;
	eskel_mesh_free(s->mesh);
	s->mesh = NULL;
	if (esk_polygonise(&s->field, &s->options, &s->mesh, NULL) != ESKEL_OK)
		fail("no mesh");
}

static void unite(void *context)
{
	scene *s = context;
	eskel_mesh_free(s->mesh);
	s->mesh = NULL;
	if (esk_union_mesh(s->primitives, 10, s->options.step, ESK_TRIANGLES_MAX, &s->mesh) != ESKEL_OK)
		fail("no mesh of the union");
}

/* How far the triangles' centres are from the surface, to the first order: to standard error. */
static void print_distances(const scene *s, const char *figure, const char *what)
{
	eskel_mesh_check_result r;
	if (eskel_mesh_check(s->mesh, &r) != ESKEL_OK || !r.is_manifold)
		fail("the mesh is no closed manifold");
	double sum = 0, most = 0;
	for (size_t t = 0; t < s->mesh->triangle_count; t++) {
		double centre[3] = {0, 0, 0}, g[3];
		for (int k = 0; k < 3; k++)
			for (int a = 0; a < 3; a++)
				centre[a] += (double)s->mesh->vertices[s->mesh->triangles[t][k]][a] / 3;
		const double value = s->field.gradient(s->field.context, centre, g);
		const double distance = fabs(value) / sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
		sum += distance;
		most = distance > most ? distance : most;
	}
	fprintf(stderr, "%s: %s, %zu triangles, %.1f degrees at least, off by %.4f steps, %.3f at most\n", figure, what,
		s->mesh->triangle_count, r.least_angle, sum / (double)s->mesh->triangle_count / s->options.step,
		most / s->options.step);
}

/* The same ellipsoids, not blended: from their own triangles, and marched. */
static void measure_union(scene *s, const char *figure)
{
	esk_composition_make(s->primitives, 10, ESKEL_COMPOSE_UNION, &s->composition);
	measure_print(figure, "eskel, union of ellipsoids", measure_least(unite, s), "ms");
	print_distances(s, figure, "union of ellipsoids");
	measure_print(figure, "the same union, marched", measure_least(polygonise, s), "ms");
	print_distances(s, figure, "the same union, marched");
}

static void evaluate_grid(scene *s, FILE *file)
{
	uint32_t extents[3];
	for (int a = 0; a < 3; a++)
		extents[a] = (uint32_t)((s->options.greatest[a] - s->options.least[a]) / s->options.step) + 2;
	double(*points)[3] = calloc(extents[0], sizeof *points), *values = calloc(extents[0], sizeof *values);
	if (!points || !values || (file && fwrite(extents, sizeof extents, 1, file) != 1))
		fail("no memory or disk for a grid");
	for (uint32_t z = 0; z < extents[2]; z++)
		for (uint32_t y = 0; y < extents[1]; y++) {
			const uint32_t at[3] = {0, y, z};
			for (uint32_t x = 0; x < extents[0]; x++)
				for (int a = 0; a < 3; a++)
					points[x][a] = s->options.least[a] + s->options.step * (a ? at[a] : x);
			s->field.values(s->field.context, extents[0], (const double(*)[3])points, values);
			for (uint32_t x = 0; x < extents[0] && file; x++) {
				const float value = (float)values[x];
				if (fwrite(&value, sizeof value, 1, file) != 1)
					fail("the disk is full");
			}
		}
	free(points);
	free(values);
}

static void evaluate_all(void *context)
{
	evaluate_grid(context, NULL);
}

int main(int argc, char **argv)
{
	if (argc < 3)
		fail("usage: bench_mesh FIGURE STEPS [FILE]");
	static scene s;
	set_up(&s, strtod(argv[2], NULL));
	measure_print(argv[1], "eskel, field and surface", measure_least(polygonise, &s), "ms");
	measure_print(argv[1], "eskel, field and surface", measure_peak_megabytes(), "MB");
	measure_print(argv[1], "the same field on the whole grid, no surface", measure_least(evaluate_all, &s), "ms");
	print_distances(&s, argv[1], "blend");
	if (argc > 3) {
		FILE *file = fopen(argv[3], "wb");
		if (!file)
			fail("cannot write the grid");
		evaluate_grid(&s, file);
		if (fclose(file) != 0)
			fail("the disk is full");
	}
	char figure[256];
	snprintf(figure, sizeof figure, "%s/union", argv[1]);
	measure_union(&s, figure);
	eskel_mesh_free(s.mesh);
	return 0;
}
