/* What GET /shapes/{id}/mesh is asked for, and what else is said of surfaces. */
#ifndef ESK_MESH_H
#define ESK_MESH_H

#include "exchange.h"

/* A stored shape and its skeleton, of the exchange's id. Cleared by esk_drawn_clear also after a failure. */
typedef struct {
	eskel_shape shape;
	eskel_skeleton *skeleton;
} esk_drawn;

bool esk_drawn_read(eskel_exchange *exchange, esk_drawn *drawn);
void esk_drawn_clear(esk_drawn *drawn);

/* The level that is asked for, by default the deepest; 400 for one that the shape has not. */
bool esk_drawn_level(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t *level);
/* The surface of best ellipsoids of a level, composed as the query has it. */
bool esk_drawn_surface(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, eskel_surface **surface);
/* The surface that was fitted to a level with the query's kind of primitive; 404 when none was. */
bool esk_drawn_fitted(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, eskel_fitted *fitted);

#endif
