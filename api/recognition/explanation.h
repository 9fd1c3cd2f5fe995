/* What explain=true adds to a recognition: how the query and a neighbour correspond, and in what they differ. */
#ifndef ESK_EXPLANATION_H
#define ESK_EXPLANATION_H

#include "difference.h"
#include "json.h"
#include "parameters.h"

/* The level asked for or 10, which a person can still look at, or the deepest one of the skeleton if that is less. */
uint32_t esk_explanation_level(const eskel_skeleton *skeleton, const esk_parameters *query);

/* The classes of a level, as ellipsoids for a viewer. */
json_t *esk_explanation_classes(const eskel_skeleton *skeleton, uint32_t level);

/* Adds classes, match, summary, differences, isomorphism, partition and superposition to a neighbour. False when memory ran
 * out. */
bool esk_explanation_add(json_t *json, const esk_compared *query, const esk_compared *neighbour,
	const eskel_chirality *chirality, const esk_parameters *parameters);

#endif
