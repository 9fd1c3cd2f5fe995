#include "arena.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/* The huge pages of x86-64, and of ARM with pages of 4 kB. Elsewhere pieces are merely large. */
enum { piece_size = 1 << 21, line = 64 };

struct esk_piece {
	_Alignas(line) atomic_size_t holders; /* what lies in it, and its arena while it is filled */
	size_t used;
};

static void release(esk_piece *piece)
{
	if (piece && atomic_fetch_sub_explicit(&piece->holders, 1, memory_order_acq_rel) == 1)
		free(piece);
}

static esk_piece *new_piece(void)
{
	esk_piece *piece = aligned_alloc(piece_size, piece_size);
	if (!piece)
		return NULL;
	/* Only advice: a refusal costs speed. */
	(void)madvise(piece, piece_size, MADV_HUGEPAGE);
	atomic_init(&piece->holders, 1);
	piece->used = sizeof *piece;
	return piece;
}

void *esk_arena_take(esk_arena *arena, size_t size)
{
	if (size > piece_size - sizeof(esk_piece))
		return NULL;
	size = (size + line - 1) / line * line;
	if (!arena->current || size > piece_size - arena->current->used) {
		esk_piece *piece = new_piece();
		if (!piece)
			return NULL;
		release(arena->current);
		arena->current = piece;
	}
	void *taken = (char *)arena->current + arena->current->used;
	arena->current->used += size;
	atomic_fetch_add_explicit(&arena->current->holders, 1, memory_order_relaxed);
	return taken;
}

/* Pieces are aligned to their size. */
void esk_arena_give_back(const void *memory)
{
	if (memory)
		release((esk_piece *)((uintptr_t)memory & ~(uintptr_t)(piece_size - 1)));
}

void esk_arena_clear(esk_arena *arena)
{
	release(arena->current);
	arena->current = NULL;
}
