/* Memory for what is read in passing over a whole library: pieces of the size of a huge page, filled from the front.
 *
 * A search jumps through gigabytes; on pages of 4 kB each jump would miss the processor's table of addresses as well as
 * its caches. What is taken is given back one by one, in any order and by any thread; a piece is freed with the last
 * of what lies in it. Taking is for one thread at a time. */
#ifndef ESK_ARENA_H
#define ESK_ARENA_H

#include <stddef.h>

typedef struct esk_piece esk_piece;

/* All zero is an empty arena. */
typedef struct {
	esk_piece *filled[2]; /* the older first: what is too large for its rest goes into the other */
} esk_arena;

/* Of a size that is not 0. Aligned to cache lines, not zeroed; NULL when memory ran out or for more than a piece. */
void *esk_arena_take(esk_arena *arena, size_t size);
/* What was taken, or NULL. */
void esk_arena_give_back(const void *memory);
/* What was taken stays until it is given back. */
void esk_arena_clear(esk_arena *arena);

#endif
