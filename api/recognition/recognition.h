/* One recognition: the nearest shapes of the library, their handedness beside the query's, and the verdict. */
#ifndef ESK_RECOGNITION_H
#define ESK_RECOGNITION_H

#include "api.h"
#include "json.h"
#include "problem.h"
#include "parameters.h"
#include "pruning.h"
#include "verdict.h"

/* What is recognised, borrowed. A stored shape leaves itself out. */
typedef struct {
	const eskel_shape *shape;
	const eskel_placement *placement;
	const eskel_signature *signature;
	const eskel_skeleton *skeleton; /* for explain and order=position only */
} esk_unknown;

/* What it is compared with: the keys that a filter leaves, or all. */
typedef struct {
	eskel_key_block *keys; /* NULL: all */
	size_t block_count;
} esk_choice;

typedef struct {
	const eskel_neighbour *found; /* of the search result */
	const esk_known_shape *known;
	bool is_compared; /* for its handedness: those that vote or are answered */
	eskel_chirality chirality;
	double position_distance; /* with order=position */
	eskel_skeleton *skeleton; /* of those explained, otherwise NULL */
} esk_neighbour;

typedef struct {
	eskel_search_result *search;
	double milliseconds; /* of the search */
	bool proven;         /* no shape that is left out comes before one of the neighbours */
	bool has_risk;       /* shapes were pruned */
	esk_risk risk;       /* that the nearest shape was pruned */
	size_t count;
	esk_neighbour *neighbours; /* found by the search and still stored, in the order asked for */
	esk_verdict verdict;
} esk_recognition;

bool esk_choice_make(eskel_api *api, const esk_parameters *query, esk_choice *choice, esk_problem *problem);
void esk_choice_clear(esk_choice *choice);

/* The neighbours, without a verdict: at least ESK_VOTERS, compared for their handedness, where there are so many, the first
 * so many with what explaining them takes. Sets the keys and what is left out in the options. Clear the recognition also
 * after a failure. */
bool esk_recognition_find(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice, size_t explained,
	eskel_search_options *options, esk_recognition *recognition, esk_problem *problem);
void esk_recognition_evidence(const esk_recognition *recognition, esk_evidence *evidence);

bool esk_recognition_make(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice,
	const esk_parameters *query, esk_recognition *recognition, esk_problem *problem);
void esk_recognition_clear(eskel_api *api, esk_recognition *recognition);

#define ESK_NEIGHBOURS_DEFAULT 5
#define ESK_NEIGHBOURS_MOST 100

/* One of the results of an answer; as many neighbours as the query's limit (recognition_json.c). */
json_t *esk_recognition_json(
	const esk_unknown *unknown, const esk_recognition *recognition, const esk_parameters *query);

#endif
