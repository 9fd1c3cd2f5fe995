/* From trials to scores: how evidence has turned out in a library, as a few numbers (calibration.h).
 *
 * The class score is logistic in the share of votes and in z, how far the nearest is for its class. The side score is
 * logistic in |rightness|, without a constant: at 0 it is a half. The priors are what the bones of several subjects and
 * brain atlases gave together; they decide while a library is small.
 *
 * z measures ln distance to the nearest fellow in standard deviations. The mean of a class is drawn to that of all by
 * DRAWN fellows' weight, so that a class with one or two has a mean as well; the deviation is that within classes. How near
 * two bones of one person are says little of other people: a class of one subject has the mean of all, and adds only to
 * that and to the deviation. */
#ifndef ESK_FIT_H
#define ESK_FIT_H

#include "logistic.h"
#include "trial.h"

typedef struct {
	const char *class; /* borrowed from a trial */
	double mean;       /* of ln fellow */
} esk_class_mean;

typedef struct {
	double class_weights[ESK_FEATURES]; /* of 1, share, z */
	double side_weights[ESK_FEATURES];  /* of |rightness|, 0, 0 */
	size_t fellows;                     /* that the mean and the deviation are of */
	double mean;                        /* of ln fellow over all classes */
	double deviation;                   /* from the means of classes */
	size_t class_count;
	esk_class_mean *classes; /* ascending names */
} esk_fit;

enum { ESK_FOLDS = 5, ESK_NO_FOLD = -1 };

/* Trial i belongs to fold i % ESK_FOLDS; those of the omitted fold are not learned from. Borrows from the trials. False
 * when memory ran out. */
bool esk_fit_make(const esk_trial *trials, size_t count, int omitted, esk_fit *fit);
void esk_fit_clear(esk_fit *fit);

void esk_fit_scores(const esk_fit *fit, const esk_evidence *evidence, esk_scores *scores);

/* The z of a distance to a shape of a class; NaN with fewer than 5 fellows. */
double esk_fit_z(const esk_fit *fit, const char *class, double distance);

/* What a trial says: whether a class, or a side, was told that can be compared with the recorded one. */
bool esk_fit_learns_class(const esk_trial *trial);
bool esk_fit_learns_side(const esk_trial *trial);
/* Of one that a side is learned from. */
bool esk_fit_side_is_right(const esk_trial *trial);

#endif
