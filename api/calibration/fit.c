/* Means, deviations and logistic weights of trials, see fit.h. */
#include "fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_DISTANCE 1e-6 /* as that of copies, verdict.c */
#define LEAST_FELLOWS 5
#define DRAWN 2.0

/* Ln distance spreads by a third or so whatever the distance; 4 such fellows are supposed. */
#define SUPPOSED_DEVIATION 0.35
#define SUPPOSED 4.0

static const esk_logistic_prior class_prior = {.weights = {-1, 4, -0.5}, .spreads = {1, 1, 0.5}};
static const esk_logistic_prior side_prior = {.weights = {46, 0, 0}, .spreads = {15, 1, 1}};

static double log_of(double distance)
{
	return log(fmax(distance, LEAST_DISTANCE));
}

static bool is_omitted(size_t index, int omitted)
{
	return (int)(index % ESK_FOLDS) == omitted;
}

/* ---- classes */

typedef struct {
	const char *class;
	bool twin;
	double log_fellow;
} fellow;

static int compare_fellows(const void *a, const void *b)
{
	const fellow *x = a, *y = b;
	int order = strcmp(x->class, y->class);
	return order ? order : (x->log_fellow > y->log_fellow) - (x->log_fellow < y->log_fellow);
}

static size_t list_fellows(const esk_trial *trials, size_t count, int omitted, fellow *fellows)
{
	size_t listed = 0;
	for (size_t i = 0; i < count; i++)
		if (trials[i].class && !isnan(trials[i].fellow) && !is_omitted(i, omitted))
			fellows[listed++] = (fellow){trials[i].class, trials[i].twin, log_of(trials[i].fellow)};
	qsort(fellows, listed, sizeof *fellows, compare_fellows);
	return listed;
}

static double mean_of(const fellow *fellows, size_t count)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += fellows[i].log_fellow;
	return count ? sum / (double)count : 0;
}

/* The classes of sorted fellows, and the deviation from their drawn means. Of one class all are twins, or none: where
 * another subject has the class, no trial has a twin for its fellow. */
static void measure_classes(const fellow *fellows, esk_fit *fit)
{
	double squares = SUPPOSED * SUPPOSED_DEVIATION * SUPPOSED_DEVIATION;
	for (size_t begin = 0, end; begin < fit->fellows; begin = end) {
		for (end = begin; end < fit->fellows && strcmp(fellows[begin].class, fellows[end].class) == 0;)
			end++;
		const double members = (double)(end - begin), own = mean_of(fellows + begin, end - begin);
		const double mean = (members * own + DRAWN * fit->mean) / (members + DRAWN);
		for (size_t i = begin; i < end; i++)
			squares += (fellows[i].log_fellow - mean) * (fellows[i].log_fellow - mean);
		if (!fellows[begin].twin)
			fit->classes[fit->class_count++] = (esk_class_mean){fellows[begin].class, mean};
	}
	fit->deviation = sqrt(squares / (SUPPOSED + (double)fit->fellows));
}

static bool fit_distances(const esk_trial *trials, size_t count, int omitted, esk_fit *fit)
{
	fellow *fellows = calloc(count + 1, sizeof *fellows);
	fit->classes = calloc(count + 1, sizeof *fit->classes);
	if (fellows && fit->classes) {
		fit->fellows = list_fellows(trials, count, omitted, fellows);
		fit->mean = mean_of(fellows, fit->fellows);
		measure_classes(fellows, fit);
	}
	free(fellows);
	return fellows && fit->classes;
}

static int compare_class(const void *name, const void *row)
{
	return strcmp(name, ((const esk_class_mean *)row)->class);
}

double esk_fit_z(const esk_fit *fit, const char *class, double distance)
{
	if (fit->fellows < LEAST_FELLOWS)
		return NAN;
	const esk_class_mean *found = bsearch(class, fit->classes, fit->class_count, sizeof *found, compare_class);
	return (log_of(distance) - (found ? found->mean : fit->mean)) / fit->deviation;
}

/* ---- scores */

bool esk_fit_learns_class(const esk_trial *trial)
{
	return trial->class && trial->told && !isnan(trial->fellow);
}

bool esk_fit_learns_side(const esk_trial *trial)
{
	return esk_trial_is_right(trial) && (trial->side == ESKEL_SIDE_LEFT || trial->side == ESKEL_SIDE_RIGHT) &&
	       !(trial->evidence.midline > 0.5) && trial->evidence.rightness != 0;
}

bool esk_fit_side_is_right(const esk_trial *trial)
{
	return (trial->side == ESKEL_SIDE_RIGHT) == (trial->evidence.rightness > 0);
}

static void class_features(const esk_fit *fit, const esk_evidence *evidence, double features[ESK_FEATURES])
{
	double z = esk_fit_z(fit, evidence->class, evidence->distance);
	features[0] = 1;
	features[1] = evidence->share;
	features[2] = isnan(z) ? 0 : z;
}

static void side_features(const esk_evidence *evidence, double features[ESK_FEATURES])
{
	features[0] = fabs(evidence->rightness);
	features[1] = features[2] = 0;
}

static bool fit_weights(const esk_trial *trials, size_t count, int omitted, esk_fit *fit)
{
	size_t classes = 0, sides = 0;
	esk_example *of_class = calloc(count + 1, sizeof *of_class), *of_side = calloc(count + 1, sizeof *of_side);
	for (size_t i = 0; of_class && of_side && i < count; i++) {
		const esk_trial *trial = &trials[i];
		if (is_omitted(i, omitted))
			continue;
		if (esk_fit_learns_class(trial)) {
			class_features(fit, &trial->evidence, of_class[classes].features);
			of_class[classes++].right = esk_trial_is_right(trial);
		}
		if (esk_fit_learns_side(trial)) {
			side_features(&trial->evidence, of_side[sides].features);
			of_side[sides++].right = esk_fit_side_is_right(trial);
		}
	}
	bool good = of_class && of_side;
	if (good) {
		esk_logistic_fit(of_class, classes, &class_prior, fit->class_weights);
		esk_logistic_fit(of_side, sides, &side_prior, fit->side_weights);
	}
	free(of_class);
	free(of_side);
	return good;
}

bool esk_fit_make(const esk_trial *trials, size_t count, int omitted, esk_fit *fit)
{
	esk_fit made = {0};
	if (!fit_distances(trials, count, omitted, &made) || !fit_weights(trials, count, omitted, &made)) {
		esk_fit_clear(&made);
		return false;
	}
	*fit = made;
	return true;
}

void esk_fit_clear(esk_fit *fit)
{
	free(fit->classes);
	*fit = (esk_fit){0};
}

void esk_fit_scores(const esk_fit *fit, const esk_evidence *evidence, esk_scores *scores)
{
	double features[ESK_FEATURES];
	*scores = (esk_scores){NAN, NAN, NAN};
	if (!evidence->class)
		return;
	class_features(fit, evidence, features);
	scores->class_score = esk_logistic_probability(fit->class_weights, features);
	scores->distance_z = esk_fit_z(fit, evidence->class, evidence->distance);
	side_features(evidence, features);
	scores->side_score = esk_logistic_probability(fit->side_weights, features);
}
