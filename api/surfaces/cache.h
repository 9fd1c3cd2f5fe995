/* Files that can be made again, kept as long as there is room: those that were not used for longest go first.
 *
 * A name is the digest of all that the bytes follow from, so a file never needs to change; one that is damaged is
 * dropped. */
#ifndef ESK_CACHE_H
#define ESK_CACHE_H

#include "eskel_store.h"

typedef struct esk_cache esk_cache;

/* In the store's folder of that name, of at most so many bytes; error is left alone when memory ran out. */
eskel_store_status esk_cache_open(
	eskel_store *store, const char *folder, uint64_t most_bytes, esk_cache **cache, eskel_store_error *error);
void esk_cache_close(esk_cache *cache);

/* A descriptor to read size bytes from, to be closed; false when it is not there. The file is verified. */
bool esk_cache_find(esk_cache *cache, const char *name, int *descriptor, uint64_t *size);
/* Drops all files whose names begin so. */
void esk_cache_drop(esk_cache *cache, const char *beginning);
/* Keeps bytes. That may fail, for want of room on the disk for one: then the next who needs them makes them again. */
void esk_cache_put(esk_cache *cache, const char *name, const void *bytes, size_t size);

/* Making a file, so that it is made once: who finds it missing begins it, or waits for who has begun it before, once.
 * True: begun, to be ended however it went. False: the other has ended, mostly with the file in the cache; where it failed
 * each of those who waited makes its own. name and turn stay until the end. */
typedef struct esk_cache_turn {
	const char *name;
	uint64_t number; /* none is used again */
	struct esk_cache_turn *next;
} esk_cache_turn;

bool esk_cache_begin(esk_cache *cache, const char *name, esk_cache_turn *turn);
void esk_cache_end(esk_cache *cache, const esk_cache_turn *turn);

#endif
