/* Which class every voxel of a cloud belongs to, as parts of segments. */
#ifndef ESK_LABELLING_H
#define ESK_LABELLING_H

#include "moments.h"

typedef struct {
	esk_segment segment;
	uint32_t class_index;
} esk_part;

/* In the order of the cloud's segments, and along x within one. */
typedef struct {
	esk_part *parts;
	size_t count, capacity;
} esk_labelling;

void esk_labelling_clear(esk_labelling *labelling);

/* Appends parts. False when memory ran out. */
bool esk_labelling_add(esk_labelling *labelling, const esk_part *parts, size_t count);

/* Gives the voxel of a part at x to another class. */
eskel_status esk_labelling_give(esk_labelling *labelling, size_t part, int32_t x, uint32_t class_index);

/* The parts class after class: those of class j are (*segments)[first[j]] up to first[j + 1]. free() them. */
eskel_status esk_labelling_collect(
	const esk_labelling *labelling, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1]);

#endif
