/* Distances scaled by neighbourhoods: d / sqrt(s s'), where the size s of a shape's neighbourhood is the mean distance to
 * the eight shapes nearest to it in the whole library.
 *
 * Where shapes are dense, as among the many that differ little, a distance means more than where they are sparse; and a
 * shape that is near to everything ceases to be everyone's neighbour. Sizes depend on the library and the options alone,
 * never on what was searched before: they are computed when first needed and forgotten with any change of the library. */
#ifndef ESK_NEIGHBOURHOOD_H
#define ESK_NEIGHBOURHOOD_H

#include "search.h"

/* Sizes that are known, of the last snapshot and options asked for. It holds that snapshot: what is removed stays in memory
 * until sizes of another are asked for. Any number of threads may ask at once. */
typedef struct esk_neighbourhoods esk_neighbourhoods;

esk_neighbourhoods *esk_neighbourhoods_new(void);
void esk_neighbourhoods_free(esk_neighbourhoods *known);

/* Scales the distances of a search's answer, and keeps those that were as search->unscaled, by row. Fails only when memory
 * runs out. */
eskel_status esk_neighbourhoods_scale(
	esk_neighbourhoods *known, const eskel_search_options *options, esk_search *search);

#endif
