/* What a pruned search risks: how often stored shapes lose their true nearest to it (section 5.3 discards 90 % a level). */
#ifndef ESK_PRUNING_H
#define ESK_PRUNING_H

#include "api.h"
#include "problem.h"

typedef struct esk_pruning esk_pruning;

/* NULL when memory ran out. */
esk_pruning *esk_pruning_new(eskel_api *api);
void esk_pruning_free(esk_pruning *pruning);

typedef struct {
	double dropped_nearest; /* (lost + 1/2) / (trials + 1) */
	size_t trials;          /* stored shapes, each searched for exactly and pruned; at most 64 */
	size_t library;         /* shapes when these were held */
} esk_risk;

/* Of a pruned search by these options, whatever its query and keys. Trials are kept for the last few ways to search, and
 * held anew when the library has grown or shrunk by a tenth since: the risk depends on its size and kind, not on single
 * shapes. */
bool esk_pruning_risk(esk_pruning *pruning, const eskel_search_options *options, esk_risk *risk, esk_problem *problem);

#endif
