/* What all requests share. */
#ifndef ESK_API_H
#define ESK_API_H

#include "eskel_api.h"

#include <pthread.h>

/* The store is the truth and the library its signatures in memory, under the same keys. changing is held over each
 * change of the store together with that of the library, so that an enrollment and a deletion of one shape cannot
 * cross. Nobody who only reads takes it: a reader may see a key of the library that the store has just dropped, and
 * leaves it out. */
struct eskel_api {
	eskel_store *store;
	eskel_library *library;
	pthread_mutex_t changing;
	eskel_api_options options;
};

#endif
