/* How far verdicts can be trusted in this library: leave-one-out calibration.
 *
 * Trials (trial.h) of a sample of the library's shapes say how evidence has turned out, a fit (fit.h) makes scores of
 * it. The sample are the MOST_TRIALS shapes with the least hashes of their keys: it depends on what is stored, not on
 * when that was stored, and changes little when the library does. It is brought up to date when scores are asked for
 * and shapes have come, changed or gone since: a trial is held again only if such a shape could have changed it. So
 * answers depend on the library alone. The first one after a start waits for all trials.
 *
 * Scores are calibrated for each way of measuring distances; the trials of the last few ways are kept. A filter or a
 * pruned search does not change them. */
#ifndef ESK_CALIBRATION_H
#define ESK_CALIBRATION_H

#include "api.h"
#include "problem.h"
#include "verdict.h"

typedef struct esk_calibration esk_calibration;

/* NULL when memory ran out. */
esk_calibration *esk_calibration_new(eskel_api *api);
void esk_calibration_free(esk_calibration *calibration);

/* A shape of the library has come, or has changed or gone. Never waits for trials. */
void esk_calibration_note(esk_calibration *calibration, int64_t key);

bool esk_calibration_score(esk_calibration *calibration, const eskel_distance_options *distance,
	const esk_evidence *evidence, esk_scores *scores, esk_problem *problem);

/* How far a distance is for a class, as distance_z of a verdict; NaN where that is not known. */
bool esk_calibration_z(esk_calibration *calibration, const eskel_distance_options *distance, const char *class,
	double value, double *z, esk_problem *problem);

/* ---- what GET /calibration shows */

enum { ESK_BINS = 10 };

/* Of the scores that trials get when the fit has not learned from them (cross-validated). */
typedef struct {
	size_t count, right;
	double scores; /* their sum */
} esk_bin;

typedef struct {
	size_t count, right;
	double brier;           /* mean of (score - right)^2 */
	esk_bin bins[ESK_BINS]; /* bin b: scores from b / ESK_BINS on */
} esk_reliability;

typedef struct {
	size_t trials; /* shapes sampled */
	esk_reliability class, side;
	size_t sides_decided, decided_right; /* with a score of at least ESK_LEAST_SIDE_SCORE */
	double class_weights[3], side_weight;
	size_t fellows;
	double mean, deviation; /* of ln distance to the nearest fellow (fit.h) */
} esk_calibration_report;

bool esk_calibration_get_report(esk_calibration *calibration, const eskel_distance_options *distance,
	esk_calibration_report *report, esk_problem *problem);

#endif
