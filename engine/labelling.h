/* Which class every voxel of a cloud belongs to, held as pieces of segments, with the sums of every class. */
#ifndef ESK_LABELLING_H
#define ESK_LABELLING_H

#include "moments.h"

/* Pieces of a segment follow each other: each begins 2 after the last x of the one before. */
typedef struct {
	int32_t x_last;
	uint32_t class_index;
} esk_piece;

/* Where the pieces of a segment are. There is room for two at least, initialised; a segment that needs more moves. */
enum { ESK_SLOT_PIECES = 2 };

typedef struct {
	size_t first;
	uint16_t count, capacity;
} esk_slot;

typedef struct {
	const esk_segment *segments; /* borrowed */
	size_t segment_count;
	esk_slot *slots; /* [segment_count] */
	esk_piece *pieces;
	size_t piece_count, piece_capacity;
	uint32_t class_count;
	esk_sums sums[ESKEL_LEVELS_MAX]; /* always those of the pieces */
	bool touched[ESKEL_LEVELS_MAX];  /* the class has won or lost voxels since the caller cleared this */
} esk_labelling;

/* All voxels in class 0, of 1. Borrows segments. */
eskel_status esk_labelling_init(esk_labelling *labelling, const esk_segment *segments, size_t segment_count);
void esk_labelling_clear(esk_labelling *labelling);

/* Gives a segment these pieces. ESKEL_NO_MEMORY leaves it as it was. */
eskel_status esk_labelling_replace(esk_labelling *labelling, size_t segment, const esk_piece *pieces, uint32_t count);

/* Walks the pieces in the order of the segments:
 *	for (esk_piece_cursor c = esk_labelling_first(l); c.valid; esk_labelling_next(l, &c)) ... c.part, c.class_index */
typedef struct {
	size_t segment;
	uint32_t piece;
	bool valid;
	uint32_t class_index;
	esk_segment part;
} esk_piece_cursor;

esk_piece_cursor esk_labelling_first(const esk_labelling *labelling);
void esk_labelling_next(const esk_labelling *labelling, esk_piece_cursor *cursor);

/* The moments of the classes that are wanted. */
void esk_labelling_moments(const esk_labelling *labelling, const bool wanted[ESKEL_LEVELS_MAX], esk_moments *moments);

/* The pieces as segments, class after class: those of class j are (*segments)[first[j]] up to first[j + 1]. free()
 * them. */
eskel_status esk_labelling_collect(
	const esk_labelling *labelling, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1]);

#endif
