/* The route table, see route.h. openapi.yaml says the same to people; a test compares the two. */
#include "route.h"

#include "resources.h"

#include <stdio.h>
#include <string.h>

#define FILTER "class", "side", "subject", "sex", "age_min", "age_max", "attr.KEY", "q"
#define DISTANCE "signature", "distance", "level", "metric", "size"
#define SEARCH "limit", "mode", "keep", "minimum", "scale", "order", DISTANCE, "not.subject", "explain", FILTER
#define LABELS "label", "label.N.name", "label.N.class", "label.N.side"
#define VOLUME LABELS, "weights", "spacing", "name"

static const char *const nothing[] = {NULL};
static const char *const list[] = {FILTER, "limit", "cursor", NULL};
static const char *const enroll[] = {
	VOLUME, "class", "side", "subject", "age", "sex", "attr.KEY", "levels", "as_said", NULL};
static const char *const signature[] = {"level", "format/signature", NULL};
static const char *const volume[] = {"format/volume", NULL};
static const char *const mesh[] = {
	"level", "step", "distance/mesh", "primitive", "compose", "format/mesh", "frame", "source", NULL};
static const char *const ellipsoids[] = {"level", "compose", NULL};
static const char *const reconstruction[] = {"level", "primitive", NULL};
static const char *const reconstruct[] = {"level", "primitive", "method", "seed", NULL};
static const char *const recognize_shape[] = {"shape", SEARCH, NULL};
static const char *const recognize_volume[] = {VOLUME, SEARCH, NULL};
static const char *const calibration[] = {DISTANCE, NULL};
static const char *const evaluation[] = {FILTER, DISTANCE, "leave_out", NULL};
static const char *const check[] = {VOLUME, "mode", DISTANCE, "not.subject", FILTER, NULL};
#define COLUMNS \
	"columns", "columns.id", "columns.class", "columns.side", "columns.subject", "columns.sex", "columns.age_min", \
		"columns.age_max", "columns.attr.KEY", "columns.q"
static const char *const distances[] = {"id", FILTER, COLUMNS, DISTANCE, "format", "plot", NULL};

#define READ ESKEL_ROLE_READ
#define WRITE ESKEL_ROLE_WRITE

static const esk_route routes[] = {
	{"/calibration", "GET", READ, ESK_BODY_NONE, true, calibration, esk_calibrate_check, esk_calibrate_get},
	{"/check", "POST", READ, ESK_BODY_VOLUME, true, check, esk_check_check, esk_check_volume},
	{"/distances", "GET", READ, ESK_BODY_NONE, true, distances, esk_distances_check, esk_distances_get},
	{"/distances", "POST", READ, ESK_BODY_NONE, true, distances, esk_distances_check, esk_distances_post},
	{"/evaluation", "GET", READ, ESK_BODY_NONE, true, evaluation, esk_distances_check, esk_evaluation_get},
	{"/healthz", "GET", 0, ESK_BODY_NONE, false, nothing, NULL, esk_health_live},
	{"/jobs", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_jobs_get},
	{"/jobs/{id}", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_job_get},
	{"/jobs/{id}", "DELETE", READ, ESK_BODY_NONE, true, nothing, NULL, esk_job_delete},
	{"/jobs/{id}/events", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_job_get_events},
	{"/jobs/{id}/result", "GET", READ, ESK_BODY_NONE, true, nothing, NULL, esk_job_get_result},
	{"/openapi.json", "GET", 0, ESK_BODY_NONE, false, nothing, NULL, esk_openapi_get},
	{"/readyz", "GET", 0, ESK_BODY_NONE, false, nothing, NULL, esk_health_ready},
	{"/recognize", "GET", READ, ESK_BODY_NONE, true, recognize_shape, esk_recognize_check, esk_recognize_shape},
	{"/recognize", "POST", READ, ESK_BODY_VOLUME, true, recognize_volume, esk_recognize_check,
		esk_recognize_volume},
	{"/shapes", "GET", READ, ESK_BODY_NONE, false, list, esk_shapes_check, esk_shapes_list},
	{"/shapes", "POST", WRITE, ESK_BODY_VOLUME, true, enroll, NULL, esk_enroll},
	{"/shapes/{id}", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_shape_get},
	{"/shapes/{id}", "PATCH", WRITE, ESK_BODY_JSON, true, nothing, NULL, esk_shape_patch},
	{"/shapes/{id}", "DELETE", WRITE, ESK_BODY_NONE, true, nothing, NULL, esk_shape_delete},
	{"/shapes/{id}/ellipsoids", "GET", READ, ESK_BODY_NONE, false, ellipsoids, NULL, esk_ellipsoids_get},
	{"/shapes/{id}/levels-of-detail", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_details_get},
	{"/shapes/{id}/mesh", "GET", READ, ESK_BODY_NONE, true, mesh, esk_mesh_check, esk_mesh_get},
	{"/shapes/{id}/reconstruction", "GET", READ, ESK_BODY_NONE, false, reconstruction, esk_reconstruction_check,
		esk_reconstruction_get},
	{"/shapes/{id}/reconstruction", "POST", WRITE, ESK_BODY_NONE, true, reconstruct, esk_reconstruction_check,
		esk_reconstruction_post},
	{"/shapes/{id}/signature", "GET", READ, ESK_BODY_NONE, false, signature, NULL, esk_signature_get},
	{"/shapes/{id}/skeleton", "GET", READ, ESK_BODY_NONE, false, nothing, NULL, esk_skeleton_get},
	{"/shapes/{id}/volume", "GET", READ, ESK_BODY_NONE, true, volume, NULL, esk_volume_get},
};

#define ROUTE_COUNT (sizeof routes / sizeof *routes)

const esk_route *esk_route_table(size_t *count)
{
	*count = ROUTE_COUNT;
	return routes;
}

static bool path_fits(const char *template, const char *path, const char **segment)
{
	const char *found = NULL;
	while (*template) {
		if (*template == '{') {
			found = path;
			template += strlen("{id}");
			path += strcspn(path, "/");
			if (path == found)
				return false;
		} else if (*template ++ != *path++) {
			return false;
		}
	}
	if (*path)
		return false;
	*segment = found;
	return true;
}

const esk_route *esk_route_of_path(const char *path, const char **segment)
{
	for (size_t i = 0; i < ROUTE_COUNT; i++)
		if (path_fits(routes[i].path, path, segment))
			return &routes[i];
	return NULL;
}

const esk_route *esk_route_of_method(const esk_route *route, const char *method)
{
	for (size_t i = 0; i < ROUTE_COUNT; i++)
		if (strcmp(routes[i].path, route->path) == 0 && strcmp(routes[i].method, method) == 0)
			return &routes[i];
	return NULL;
}

void esk_route_allow(const esk_route *route, char allow[ESK_ALLOW_SIZE])
{
	size_t used = 0;
	for (size_t i = 0; i < ROUTE_COUNT; i++)
		if (strcmp(routes[i].path, route->path) == 0)
			used += (size_t)snprintf(allow + used, ESK_ALLOW_SIZE - used, "%s%s, ", routes[i].method,
				strcmp(routes[i].method, "GET") == 0 ? ", HEAD" : "");
	snprintf(allow + used, ESK_ALLOW_SIZE - used, "OPTIONS");
}
