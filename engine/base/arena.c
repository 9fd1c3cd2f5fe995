#include "arena.h"

#include <stdatomic.h>
#include <stdint.h>
#include <sys/mman.h>

/* The huge pages of x86-64, and of ARM with pages of 4 kB. Elsewhere pieces are merely large. */
enum { piece_size = 1 << 21, line = 64 };

struct esk_piece {
	_Alignas(line) atomic_size_t holders; /* what lies in it, and its arena while that fills it */
	size_t used;
};

static void release(esk_piece *piece)
{
	if (piece && atomic_fetch_sub_explicit(&piece->holders, 1, memory_order_acq_rel) == 1)
		munmap(piece, piece_size);
}

/* The C library's aligned memory would touch a page before each piece, and never give back the rest around it. */
static esk_piece *new_piece(void)
{
	char *mapped = mmap(NULL, 2 * piece_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (mapped == MAP_FAILED)
		return NULL;
	const size_t before = -(uintptr_t)mapped % piece_size;
	esk_piece *piece = (esk_piece *)(void *)(mapped + before);
	if (before > 0)
		munmap(mapped, before);
	munmap(mapped + before + piece_size, piece_size - before);
	/* Only advice: a refusal costs speed. */
	(void)madvise(piece, piece_size, MADV_HUGEPAGE);
	atomic_init(&piece->holders, 1);
	piece->used = sizeof *piece;
	return piece;
}

/* The first piece of the two with room, or a new one in place of the older. */
static esk_piece *piece_with_room(esk_arena *arena, size_t size)
{
	for (int p = 0; p < 2; p++)
		if (arena->filled[p] && size <= piece_size - arena->filled[p]->used)
			return arena->filled[p];
	esk_piece *piece = new_piece();
	if (piece) {
		release(arena->filled[0]);
		arena->filled[0] = arena->filled[1];
		arena->filled[1] = piece;
	}
	return piece;
}

void *esk_arena_take(esk_arena *arena, size_t size)
{
	if (size > piece_size - sizeof(esk_piece))
		return NULL;
	size = (size + line - 1) / line * line;
	esk_piece *piece = piece_with_room(arena, size);
	if (!piece)
		return NULL;
	void *taken = (char *)piece + piece->used;
	piece->used += size;
	atomic_fetch_add_explicit(&piece->holders, 1, memory_order_relaxed);
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
	release(arena->filled[0]);
	release(arena->filled[1]);
	*arena = (esk_arena){0};
}
