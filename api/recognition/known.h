/* Shapes that recognitions have met, kept in memory: what is said of them, their signatures and their placement. Reading
 * these from the store costs more than a search among 100,000 shapes.
 *
 * The least recently used go first when there is no more room. Whoever has changed a shape in the store drops it here
 * before the change is answered; what was read from the store while a shape was dropped is used once and not kept. */
#ifndef ESK_KNOWN_H
#define ESK_KNOWN_H

#include "eskel_store.h"

typedef struct esk_known esk_known;

/* Never changes. */
typedef struct {
	eskel_shape shape;
	eskel_signature *signature;
	eskel_position_signature *positions;
	eskel_placement *placement;
} esk_known_shape;

/* NULL when memory ran out. Shapes of 16 levels take 24 kB each. */
esk_known *esk_known_new(eskel_store *store, uint64_t most_bytes);
void esk_known_free(esk_known *known);

/* The shape with an id or a key, NOT_FOUND if the store has none. Release it. */
eskel_store_status esk_known_by_id(
	esk_known *known, const char *id, const esk_known_shape **shape, eskel_store_error *error);
eskel_store_status esk_known_by_key(
	esk_known *known, int64_t key, const esk_known_shape **shape, eskel_store_error *error);
/* NULL is fine. */
void esk_known_release(esk_known *known, const esk_known_shape *shape);

void esk_known_drop(esk_known *known, int64_t key);

#endif
