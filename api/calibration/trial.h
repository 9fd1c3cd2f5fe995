/* A stored shape recognised as if nothing were known of it: what leave-one-out calibration is made of (calibration.h).
 *
 * What is left out is as a new specimen would find the library: the whole subject where other subjects have the shape's
 * class as well, else the shape alone. */
#ifndef ESK_TRIAL_H
#define ESK_TRIAL_H

#include "api.h"
#include "problem.h"
#include "verdict.h"

typedef struct {
	int64_t key;
	bool stale;            /* to be held again: the library around it has changed */
	char *class;           /* recorded; NULL: nothing to learn from it */
	eskel_side side;       /* recorded */
	char *told;            /* the class of the nearest; NULL: none */
	esk_evidence evidence; /* its class is told */
	double fellow;         /* distance of the nearest of the recorded class; NaN: there is none */
	int64_t fellow_key;
	bool twin; /* the fellow is of the same subject: others have none */
	size_t voter_count;
	int64_t voters[ESK_VOTERS]; /* nearest first */
	double farthest;            /* distance of the last voter */
} esk_trial;

/* The trial of the shape with a key; of one that is no longer stored nothing is recorded. */
bool esk_trial_hold(
	eskel_api *api, const eskel_distance_options *distance, int64_t key, esk_trial *trial, esk_problem *problem);
void esk_trial_clear(esk_trial *trial);

/* Whether the recorded class is the nearest's. */
bool esk_trial_is_right(const esk_trial *trial);

#endif
