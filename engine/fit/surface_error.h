/* Errors of a surface against the boundary of a cloud (section 3.7). */
#ifndef ESK_SURFACE_ERROR_H
#define ESK_SURFACE_ERROR_H

#include "boundary.h"
#include "team.h"

/* As eskel_surface_errors. */
eskel_status esk_surface_error_measure(
	const eskel_surface *surface, const esk_boundary *boundary, esk_team *team, eskel_surface_error *errors);

#endif
