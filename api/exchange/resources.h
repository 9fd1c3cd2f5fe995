/* The handlers of the route table, one file a resource (the comment says which). Each answers the exchange and returns
 * true, or sets its problem and returns false; the checks of the head alone are as esk_route.check. */
#ifndef ESK_RESOURCES_H
#define ESK_RESOURCES_H

#include "eskel_api.h"

bool esk_shapes_check(eskel_exchange *exchange); /* shapes.c */
bool esk_shapes_list(eskel_exchange *exchange);
bool esk_enroll(eskel_exchange *exchange);    /* enroll.c */
bool esk_shape_get(eskel_exchange *exchange); /* shape.c */
bool esk_shape_patch(eskel_exchange *exchange);
bool esk_shape_delete(eskel_exchange *exchange);
bool esk_skeleton_get(eskel_exchange *exchange);    /* skeleton.c */
bool esk_signature_get(eskel_exchange *exchange);   /* signature.c */
bool esk_volume_get(eskel_exchange *exchange);      /* volume.c */
bool esk_ellipsoids_get(eskel_exchange *exchange);  /* surface.c */
bool esk_details_get(eskel_exchange *exchange);
bool esk_mesh_check(eskel_exchange *exchange); /* mesh.c */
bool esk_mesh_get(eskel_exchange *exchange);
bool esk_reconstruction_check(eskel_exchange *exchange); /* reconstruct.c */
bool esk_reconstruction_get(eskel_exchange *exchange);
bool esk_reconstruction_post(eskel_exchange *exchange);
bool esk_recognize_check(eskel_exchange *exchange); /* recognize.c */
bool esk_recognize_shape(eskel_exchange *exchange);
bool esk_recognize_volume(eskel_exchange *exchange);
bool esk_calibrate_check(eskel_exchange *exchange); /* calibrate.c */
bool esk_calibrate_get(eskel_exchange *exchange);
bool esk_check_check(eskel_exchange *exchange); /* check.c */
bool esk_check_volume(eskel_exchange *exchange);
bool esk_distances_check(eskel_exchange *exchange); /* distances.c */
bool esk_distances_get(eskel_exchange *exchange);
bool esk_evaluation_get(eskel_exchange *exchange); /* evaluate.c */
bool esk_distances_post(eskel_exchange *exchange); /* jobs.c */
bool esk_jobs_get(eskel_exchange *exchange);
bool esk_job_get(eskel_exchange *exchange);
bool esk_job_delete(eskel_exchange *exchange);
bool esk_job_get_result(eskel_exchange *exchange);
bool esk_job_get_events(eskel_exchange *exchange); /* job_events.c */
bool esk_health_live(eskel_exchange *exchange);    /* health.c */
bool esk_health_ready(eskel_exchange *exchange);
bool esk_openapi_get(eskel_exchange *exchange); /* openapi.c */

/* Reads a stored shape, 404 naming the id that there is not (shape.c). The shape is to be cleared. */
bool esk_shape_of_id(eskel_exchange *exchange, const char *id, eskel_shape *shape);

#endif
