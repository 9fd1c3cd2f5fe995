/* The blend of tests/fields.h, many points at once: as the engine's own surfaces compute it. */
#ifndef BLEND_LANES_H
#define BLEND_LANES_H

#include "fields.h"

/* The field of fields_blend, whose context it takes; with gradients. */
esk_field blend_lanes(const ellipsoids *e);

#endif
