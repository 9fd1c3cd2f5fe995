/* A shape as JSON, the same wherever one is answered. */
#ifndef ESK_SHAPE_JSON_H
#define ESK_SHAPE_JSON_H

#include "eskel_store.h"
#include "json.h"

/* A shape that is not stored (created is "") has neither url nor time. */
json_t *esk_shape_json(const eskel_shape *shape);
json_t *esk_shapes_json(const eskel_shape *shapes, size_t count);

json_t *esk_warnings_json(const eskel_warning *warnings, size_t count);

#endif
