/* Shapes in the columns that a search would read, for tests of scans and bounds. */
#ifndef SHELF_H
#define SHELF_H

#include "columns.h"

enum { SHELF_MOST = 128 };

typedef struct {
	uint32_t count;
	esk_shape *shapes[SHELF_MOST];
	esk_columns columns;
	esk_arena arena;
} shelf;

/* With room for so many. Exits when memory ran out. */
void shelf_init(shelf *s, uint32_t room);
/* Takes the signature. */
void shelf_put(shelf *s, eskel_signature *signature);
void shelf_clear(shelf *s);

#endif
