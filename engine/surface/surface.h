#ifndef ESK_SURFACE_H
#define ESK_SURFACE_H

#include "composition.h"

struct eskel_surface {
	eskel_primitive primitives[ESKEL_LEVELS_MAX];
	esk_algebraic *algebraic[ESKEL_LEVELS_MAX]; /* owned; NULL but for algebraic primitives */
	esk_composition composition;                /* of these */
};

/* count classes without primitives; ESKEL_NO_MEMORY. */
eskel_status esk_surface_allocate(uint32_t count, eskel_compose compose, eskel_surface **surface);
/* As eskel_surface_set_algebraic. */
eskel_status esk_surface_set_algebraic(
	eskel_surface *surface, uint32_t class_index, unsigned degree, const esk_algebraic_points *points);
/* After its primitives have changed. */
void esk_surface_refresh(eskel_surface *surface);

#endif
