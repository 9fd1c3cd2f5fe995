/* What all requests share. */
#ifndef ESK_API_H
#define ESK_API_H

#include "eskel_api.h"
#include "known.h"

#include <pthread.h>

/* The store is the truth, the library its signatures in memory under the same keys, and known what recognitions have
 * read of it, calibration what its shapes teach about verdicts, pruning what they
 * teach about pruned searches. A change of both is not one step:
 * whoever enrolls shares the lock changing from its last look at the store until the library follows, whoever patches or
 * deletes has it alone. So an enrollment and a deletion of one shape cannot cross, and enrollments still meet in one
 * commit of the store. Nobody who only reads takes it: a reader may see a key of the library that the store has just
 * dropped, and leaves it out. */
struct eskel_api {
	eskel_store *store;
	eskel_library *library;
	esk_known *known;
	struct esk_calibration *calibration;
	struct esk_pruning *pruning;
	struct esk_jobs *jobs;
	struct esk_cache *meshes;
	pthread_rwlock_t changing;
	eskel_api_options options;
};

/* For those who read keys of the store and look for them in the library: while a change is under way a shape may be in one
 * of the two. Each such change is waited for; so many in a row do not happen to an honest client. */
#define ESK_MOST_ATTEMPTS 8
void esk_api_wait_for_changes(eskel_api *api);

#endif
