/* How well a distance finds classes and sides among stored shapes, each compared with all others but those left out. */
#ifndef ESK_EVALUATION_H
#define ESK_EVALUATION_H

#include "api.h"
#include "json.h"
#include "parameters.h"
#include "problem.h"

enum { ESK_LEAVE_OUT_SHAPE, ESK_LEAVE_OUT_SUBJECT };

#define ESK_NO_SHAPE SIZE_MAX
#define ESK_SIDE_THRESHOLDS 8
#define ESK_LEVEL_DEFAULT 10 /* of a distance of one level (eskel_skeleton.h) */

/* Of a shape, as a query. */
typedef struct {
	size_t nearest; /* its nearest shape, of equals the oldest; ESK_NO_SHAPE: all are left out */
	size_t sided;   /* the nearest of its class that is left or right, if it is so itself; else ESK_NO_SHAPE */
} esk_nearest_shapes;

/* Chirality beside the nearest sided shape of the class: at each threshold of |score|, how many are decided, and how many of
 * these are the same where the recorded sides are equal and mirrored where they are not. */
typedef struct {
	size_t compared;
	struct {
		size_t decided, right;
	} at[ESK_SIDE_THRESHOLDS];
} esk_side_accuracy;

extern const double esk_side_thresholds[ESK_SIDE_THRESHOLDS];

/* Searches by every shape, in both modes. */
typedef struct {
	size_t searches;
	double exact[3], pruned[3]; /* milliseconds: mean, median, 95th percentile */
	uint32_t step_count;        /* of the longest pruned search; one with fewer stays as it ended */
	struct {
		size_t kept;     /* shapes, summed over the searches */
		size_t outlived; /* searches whose true nearest was still in */
	} steps[ESKEL_LEVELS_MAX];
	size_t found; /* by pruned: the true nearest */
} esk_search_accuracy;

typedef struct {
	size_t count;
	eskel_shape *shapes;
	uint32_t class_count;
	const char **class_names; /* ascending; borrowed from shapes */
	uint32_t *classes,
		*subjects; /* of each shape; ESKEL_UNNUMBERED without. No subjects: nothing but itself is left out */
	eskel_retrieval *retrievals; /* of each shape */
	esk_nearest_shapes *nearest; /* of each shape */
	size_t query_count;          /* shapes that have a shape of their class to be found */
	eskel_retrieval mean;        /* of these */
	esk_side_accuracy side;
	esk_search_accuracy search;
} esk_evaluation;

/* Of the evaluation's shapes, in place before. *status is ESKEL_NOT_FOUND, without a problem, when one of them has gone
 * meanwhile. Clear it also after a failure. */
bool esk_evaluation_make(eskel_api *api, const esk_parameters *query, esk_evaluation *evaluation, eskel_status *status,
	esk_problem *problem);
void esk_evaluation_clear(esk_evaluation *evaluation);

/* Its last part (evaluation_search.c). */
bool esk_evaluation_search(
	eskel_api *api, const esk_parameters *query, esk_evaluation *evaluation, esk_problem *problem);

/* The answer (evaluation_json.c). */
json_t *esk_evaluation_json(const esk_evaluation *evaluation, const esk_parameters *query);

#endif
