/* Where a fit looks: points of a cloud's boundary, on which the potential should vanish, and points inside and outside, on
 * which it should have the right sign. Points of one kind are in groups of eight neighbours (lanes.h). */
#ifndef ESK_FIT_POINTS_H
#define ESK_FIT_POINTS_H

#include "boundary.h"
#include "lanes.h"

typedef enum { ESK_FIT_BOUNDARY, ESK_FIT_INSIDE, ESK_FIT_OUTSIDE } esk_fit_kind;

typedef struct {
	esk_fit_kind kind;
	esk_lanes points[3]; /* mm, by axis */
	esk_lanes margins;   /* mm: how far from the surface the point should be at least; 0 on the boundary */
	esk_lanes weights;   /* of the squares of residuals: those of a kind add up to 1; 0 for a lane that only pads */
} esk_fit_group;

typedef struct {
	double length; /* mm: at which residuals saturate, a tenth of the cube root of the volume */
	size_t group_count;
	esk_fit_group *groups; /* aligned to lanes */
} esk_fit_points;

/* About so many points of the boundary, and as many again in all of each other kind. Deterministic. */
eskel_status esk_fit_points_new(const esk_boundary *boundary, size_t boundary_count, esk_fit_points **points);
/* The points whose class, [group][lane], is the one asked for. */
eskel_status esk_fit_points_select(
	const esk_fit_points *points, const uint32_t *classes, uint32_t class_index, esk_fit_points **selected);
void esk_fit_points_free(esk_fit_points *points);

#endif
