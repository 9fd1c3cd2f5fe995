/* Where a surface cuts edges whose ends lie on both sides of it: many at once. */
#ifndef ESK_ROOTS_H
#define ESK_ROOTS_H

#include "field.h"

enum { ESK_ROOTS_MOST = 256 }; /* so that all of them fit into the nearest caches */

/* An edge, and the values of the field at its ends: below 0, and at least 0. */
typedef struct {
	double inside[3], outside[3];
	double inside_value, outside_value;
} esk_root;

/* Of at most ESK_ROOTS_MOST edges, a point on each where the field is 0, to about 1e-4 of its length where the field is smooth. */
void esk_roots_find(const esk_field *field, size_t count, const esk_root *roots, double (*points)[3]);

#endif
