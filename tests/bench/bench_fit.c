/* Time of fits of a femur of eight classes: bench_fit FILE
 *
 * Of one superquadric a class to that class's boundary, which FILE has for peers/fitting.py with where they start and end,
 * and of the whole. */
#include "measure.h"
#include "normal_equations.h"
#include "shapes.h"
#include "surface.h"
#include "tabu_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVEL = 8, POINTS = 4796 };

typedef struct {
	eskel_cloud *cloud;
	eskel_skeleton *skeleton;
	esk_boundary *boundary;
	eskel_surface *plain; /* where superquadrics start */
	esk_fit_points *points[LEVEL];
	eskel_primitive fitted[LEVEL];
	uint32_t threads; /* of the whole */
} scene;

static void require(bool holds)
{
	if (holds)
		return;
	fputs("bench_fit: no fit\n", stderr);
	exit(1);
}

static void set_up(scene *s)
{
	static const eskel_affine affine = {{{1.5, 0, 0, 0}, {0, 1.5, 0, 0}, {0, 0, 1.5, 0}}};
	const eskel_surface_options options = {.primitive = ESKEL_PRIMITIVE_SUPERQUADRIC};
	s->cloud = shapes_cloud(&shapes_femur, &affine);
	require(!eskel_skeleton_new(s->cloud, NULL, &s->skeleton, NULL));
	require(!esk_boundary_new(s->cloud, &s->boundary, NULL));
	require(!eskel_surface_new(s->skeleton, LEVEL, &options, &s->plain));
}

/* The boundary points of each class, POINTS on an average. */
static void share_points(scene *s)
{
	esk_fit_points *all = NULL;
	require(!esk_fit_points_new(s->boundary, LEVEL * POINTS, &all));
	while (all->group_count > 0 && all->groups[all->group_count - 1].kind != ESK_FIT_BOUNDARY)
		all->group_count--;
	uint32_t *classes = calloc(all->group_count, ESK_LANES * sizeof *classes);
	require(classes != NULL);
	for (size_t i = 0; i < all->group_count * ESK_LANES; i++) {
		double least = 1e300;
		for (uint32_t c = 0; c < LEVEL; c++) {
			double square = 0;
			for (int r = 0; r < 3; r++) {
				const double off = all->groups[i / ESK_LANES].points[r][i % ESK_LANES] -
						   s->plain->primitives[c].centre[r];
				square += off * off;
			}
			if (square < least) {
				least = square;
				classes[i] = c;
			}
		}
	}
	for (uint32_t c = 0; c < LEVEL; c++)
		require(!esk_fit_points_select(all, classes, c, &s->points[c]));
	free(classes);
	esk_fit_points_free(all);
}

static void fit_superquadrics(void *context)
{
	scene *s = context;
	const esk_tabu_options options = {.joint = {.freedom = ESKEL_FIT_SUPERQUADRIC, .spacing = s->boundary->spacing},
		.neighbours = 5,
		.memory = 10,
		.steps = 200,
		.threshold = s->boundary->spacing / 4};
	memcpy(s->fitted, s->plain->primitives, sizeof s->fitted);
	for (uint32_t c = 0; c < LEVEL; c++)
		require(!esk_tabu_fit(s->points[c], &options, 1, &s->plain->primitives[c], &s->fitted[c]));
}

/* Microseconds for the residuals of one primitive, the mean over classes. */
static double measure_residuals(const scene *s, const eskel_primitive *primitives)
{
	double sum = 0;
	for (uint32_t c = 0; c < LEVEL; c++) {
		esk_normal_equations *equations = NULL;
		esk_composition one;
		double least = 1e300;
		esk_composition_make(&primitives[c], 1, ESKEL_COMPOSE_BLEND, &one);
		require(!esk_normal_equations_new(s->points[c], 1, 1, NULL, &equations));
		for (int i = 0; i < 200; i++) {
			const double start = measure_milliseconds();
			esk_normal_equations_measure(equations, &one, s->points[c]->length);
			least = fmin(least, measure_milliseconds() - start);
		}
		sum += least;
		esk_normal_equations_free(equations);
	}
	return 1e3 * sum / LEVEL;
}

static void fit_whole(void *context)
{
	const scene *s = context;
	const eskel_fit_options options = {.threads = s->threads};
	eskel_reconstruction *made = NULL;
	require(!eskel_surface_fit(s->cloud, s->skeleton, LEVEL, &options, &made, NULL));
	eskel_reconstruction_free(made);
}

/* Milliseconds of processor time, which other work on the machine changes less. */
static double measure_processor(void (*run)(void *context), void *context)
{
	const clock_t start = clock();
	run(context);
	return 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC;
}

static void write_primitive(FILE *file, const char *name, const eskel_primitive *p)
{
	fprintf(file, "%s %.17g %.17g %.17g", name, p->centre[0], p->centre[1], p->centre[2]);
	for (int i = 0; i < 9; i++)
		fprintf(file, " %.17g", p->axes[i / 3][i % 3]);
	fprintf(file, " %.17g %.17g %.17g", p->radii[0], p->radii[1], p->radii[2]);
	fprintf(file, " %.17g %.17g\n", p->exponents[0], p->exponents[1]);
}

static void write_all(const scene *s, const char *path)
{
	FILE *file = fopen(path, "w");
	require(file != NULL);
	for (uint32_t c = 0; c < LEVEL; c++) {
		fprintf(file, "class %.17g %.17g\n", s->points[c]->length, s->boundary->spacing);
		write_primitive(file, "start", &s->plain->primitives[c]);
		write_primitive(file, "end", &s->fitted[c]);
		for (size_t i = 0; i < s->points[c]->group_count * ESK_LANES; i++) {
			const esk_fit_group *g = &s->points[c]->groups[i / ESK_LANES];
			const size_t l = i % ESK_LANES;
			if (g->weights[l] > 0)
				fprintf(file, "point %.17g %.17g %.17g\n", g->points[0][l], g->points[1][l],
					g->points[2][l]);
		}
	}
	require(fclose(file) == 0);
}

int main(int argc, char **argv)
{
	static scene s;
	require(argc == 2);
	set_up(&s);
	share_points(&s);
	const double fit = measure_least(fit_superquadrics, &s) / LEVEL;
	measure_print("fit/residual", "eskel", measure_residuals(&s, s.fitted), "us");
	measure_print("fit/residual", "eskel, ellipsoid", measure_residuals(&s, s.plain->primitives), "us");
	measure_print("fit/class", "eskel, Tabu and polish", fit, "ms");
	measure_print("fit/class", "eskel, Tabu and polish", measure_processor(fit_superquadrics, &s) / LEVEL,
		"ms of processor");
	write_all(&s, argv[1]);
	for (s.threads = 1; s.threads <= 2; s.threads++) {
		const char *program = s.threads == 1 ? "eskel" : "eskel, 2 threads";
		measure_print("fit/femur-8", program, measure_least(fit_whole, &s), "ms");
		measure_print("fit/femur-8", program, measure_processor(fit_whole, &s), "ms of processor");
	}
	return 0;
}
