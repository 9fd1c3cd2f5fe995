/* What fits gain on real bones, as a table, and the paper's table 1. Every STEP-th bone of ../shared/data, or all:
 *
 *	build/tests/unit/test_real_fits [STEP] */
#include "real_data.h"
#include "shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { LEVELS = 3, STEP = 8 };
static const uint32_t levels[LEVELS] = {4, 8, 16};
/* Means over bones of before / after: of the mean and of the greatest first-order distance. Near
 * level 16 voxels end what can be gained: a perfect fit has 0.17 voxel (eskel_surface.h). */
static const double mean_goals[LEVELS] = {3.2, 4.5, 5.5}, greatest_goals[LEVELS] = {2, 3, 3.5};

static double seconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static eskel_reconstruction *fit(
	const eskel_cloud *cloud, const eskel_skeleton *skeleton, uint32_t level, eskel_fit_method method)
{
	eskel_reconstruction *r = NULL;
	eskel_error error = {0};
	const eskel_fit_options options = {.method = method, .threads = ESKEL_THREADS_ONLINE};
	if (eskel_surface_fit(cloud, skeleton, level, &options, &r, &error)) {
		fprintf(stderr, "%s\n", error.text);
		exit(1);
	}
	return r;
}

static void print_errors(const char *name, const eskel_reconstruction *r, double spacing, double time)
{
	const eskel_surface_error *b = &r->before, *a = &r->after;
	printf("%-30.30s %2u %4.2f  %5.3f %5.3f %5.2f  %5.2f %5.2f %5.2f  %5.3f %5.3f  %5.2f %5.2f  %5.3f %5.3f  %5.2f "
	       "%5.2f  "
	       "%.3f %.3f  %.3f %.3f  %4.1f\n",
		name, r->level, spacing, b->mean_delta, a->mean_delta, b->mean_delta / a->mean_delta, b->greatest_delta,
		a->greatest_delta, b->greatest_delta / a->greatest_delta, b->mean_error, a->mean_error,
		b->greatest_error, a->greatest_error, b->mean_distance, a->mean_distance, b->hausdorff_95,
		a->hausdorff_95, b->dice, a->dice, b->volume_ratio, a->volume_ratio, time);
	fflush(stdout);
}

static void print_heads(void)
{
	printf("%-30s %2s %4s  %-17s  %-17s  %-11s  %-11s  %-11s  %-11s  %-11s  %-11s  %s\n", "mm, before and after",
		"k", "h", "mean delta, ratio", "greatest delta", "e_me", "e_max", "symmetric", "HD95", "Dice", "volume",
		"CPU s, errors too");
}

typedef struct {
	int count;
	double delta, greatest, error, greatest_error, distance, hausdorff, voxels, least_dice_gain;
} gain;

static void add_gain(gain *g, const eskel_reconstruction *r, double spacing)
{
	const eskel_surface_error *b = &r->before, *a = &r->after;
	g->delta += log(b->mean_delta / a->mean_delta);
	g->greatest += log(b->greatest_delta / a->greatest_delta);
	g->error += log(b->mean_error / a->mean_error);
	g->greatest_error += log(b->greatest_error / a->greatest_error);
	g->distance += log(b->mean_distance / a->mean_distance);
	g->hausdorff += log(b->hausdorff_95 / a->hausdorff_95);
	g->voxels += a->mean_error / spacing;
	g->least_dice_gain = g->count++ ? fmin(g->least_dice_gain, a->dice - b->dice) : a->dice - b->dice;
}

static double mean_of(double logarithms, const gain *g)
{
	return exp(logarithms / g->count);
}

/* Is the goal reached? */
static bool judge(int l, const gain *g)
{
	printf("== level %u, %d bones, geometric means of ratios: delta %.2f (goal %.1f), greatest %.2f (%.1f), e_me "
	       "%.2f, e_max "
	       "%.2f, symmetric %.2f, HD95 %.2f; least gain of Dice %.3f; e_me %.3f voxels\n",
		levels[l], g->count, mean_of(g->delta, g), mean_goals[l], mean_of(g->greatest, g), greatest_goals[l],
		mean_of(g->error, g), mean_of(g->greatest_error, g), mean_of(g->distance, g), mean_of(g->hausdorff, g),
		g->least_dice_gain, g->voxels / g->count);
	fflush(stdout);
	return mean_of(g->delta, g) >= mean_goals[l] && mean_of(g->greatest, g) >= greatest_goals[l] &&
	       g->least_dice_gain > 0;
}

/* Of every bone the overlap grows. */
static bool judge_algebraic(const gain *g)
{
	printf("   algebraic: e_me %.2f, e_max %.2f, symmetric %.2f, HD95 %.2f; least gain of Dice %.3f; e_me %.3f "
	       "voxels\n",
		mean_of(g->error, g), mean_of(g->greatest_error, g), mean_of(g->distance, g), mean_of(g->hausdorff, g),
		g->least_dice_gain, g->voxels / g->count);
	fflush(stdout);
	return g->least_dice_gain > 0 && mean_of(g->error, g) > 2 && mean_of(g->distance, g) > 2;
}

static bool fit_bones(size_t step)
{
	bool reached = true;
	real_set bones = real_bones();
	for (int l = 0; l < LEVELS; l++) {
		gain g = {0}, algebraic = {0};
		for (size_t i = 0; i < bones.count; i += step) {
			const real_shape *bone = &bones.shapes[i];
			const double start = seconds();
			const double spacing = cbrt(bone->skeleton->volume / (double)bone->skeleton->voxels);
			eskel_reconstruction *r = fit(bone->cloud, bone->skeleton, levels[l], ESKEL_FIT_JOINT);
			print_errors(bone->name, r, spacing, seconds() - start);
			add_gain(&g, r, spacing);
			eskel_reconstruction_free(r);
			r = fit(bone->cloud, bone->skeleton, levels[l], ESKEL_FIT_LEAST_SQUARES);
			add_gain(&algebraic, r, spacing);
			eskel_reconstruction_free(r);
		}
		reached &= judge(l, &g) && judge_algebraic(&algebraic);
	}
	real_set_clear(&bones);
	return reached;
}

/* Table 1: e_me and e_max, mm. */
static bool fit_paper(
	const char *name, const shapes_solid *solid, double spacing, uint32_t level, double mean, double greatest)
{
	const eskel_affine affine = {{{spacing, 0, 0, 0}, {0, spacing, 0, 0}, {0, 0, spacing, 0}}};
	eskel_cloud *cloud = shapes_cloud(solid, &affine);
	eskel_skeleton *skeleton = NULL;
	if (eskel_skeleton_new(cloud, &(eskel_skeleton_options){.levels = level}, &skeleton, NULL))
		exit(1);
	const double start = seconds();
	eskel_reconstruction *r = fit(cloud, skeleton, level, ESKEL_FIT_JOINT);
	print_errors(name, r, spacing, seconds() - start);
	const bool reached = r->after.mean_error <= mean && r->after.greatest_error <= greatest;
	printf("   the paper: e_me %.1f, e_max %.1f mm\n", mean, greatest);
	eskel_reconstruction_free(r);
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
	return reached;
}

int main(int count, char **arguments)
{
	const int step = count > 1 ? atoi(arguments[1]) : STEP;
	print_heads();
	bool reached = fit_paper("hamate-like", &shapes_hamate, 0.5, 4, 1.1, 3.2);
	reached &= fit_paper("hamate-like", &shapes_hamate, 0.5, 5, 0.8, 2.8);
	reached &= fit_paper("femur-like", &shapes_femur, 1.5, 6, 2.4, 5);
	reached &= fit_paper("femur-like", &shapes_femur, 1.5, 8, 2, 4.7);
	if (!real_file_exists(REAL_DATA "manifest.csv")) {
		printf("no bones: there is no " REAL_DATA "manifest.csv\n");
		return reached ? 77 : 1;
	}
	reached &= fit_bones(step > 0 ? (size_t)step : STEP);
	return reached ? 0 : 1;
}
