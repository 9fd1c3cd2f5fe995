/* An order of segments that keeps neighbours together. */
#ifndef ESK_MORTON_H
#define ESK_MORTON_H

#include "moments.h"

/* Sorts segments, which are in the order of z, y, x, by the Morton code of their rows (y, z), those of a row by x; or leaves
 * them where their order is the better one. What is computed from them does not depend on it, only the time. */
eskel_status esk_morton_sort(esk_segment *segments, size_t count);

#endif
