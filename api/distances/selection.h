/* The shapes that a query names, or that its filter leaves: one side of a matrix. */
#ifndef ESK_SELECTION_H
#define ESK_SELECTION_H

#include "exchange.h"

/* What a matrix says of a shape, which is little beside all that is stored of it. */
typedef struct {
	char id[ESKEL_ID_SIZE];
	char *name, *class; /* NULL: not recorded */
	eskel_side side;
} esk_selected;

typedef struct {
	size_t count, capacity;
	esk_selected *shapes;
	int64_t *keys;
} esk_selection;

/* Adds those that the ids name, in that order, or else those that the filter leaves, oldest first. 404 for an id that
 * there is not, 413 for more than most in all. Clear it also after a failure. */
bool esk_selection_read(eskel_exchange *exchange, const esk_parameters *query, size_t most, esk_selection *selection);
void esk_selection_clear(esk_selection *selection);

#endif
