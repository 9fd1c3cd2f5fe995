/* GET and POST /shapes/{id}/reconstruction: surfaces fitted to a shape's cloud (section 3.6), which are stored.
 *
 * A fit takes long. So POST makes a job, and the job is the same POST once more, in which the fit is made, stored and
 * answered as GET answers it. What it is asked for, it makes anew. */
#include "detail.h"
#include "job_json.h"
#include "mesh.h"
#include "resources.h"

#include <math.h>
#include <stdio.h>

static const eskel_fit_freedom freedoms[] = {
	[ESK_PRIMITIVE_SUPERQUADRIC] = ESKEL_FIT_SUPERQUADRIC,
	[ESK_PRIMITIVE_DEFORMED] = ESKEL_FIT_DEFORMED,
	[ESK_PRIMITIVE_ALGEBRAIC] = ESKEL_FIT_DEFORMED, /* which says nothing of it */
};

/* Of these alone the outcome depends on a seed. */
static bool is_random(const esk_parameters *query)
{
	return query->method == ESKEL_FIT_TABU || query->method == ESKEL_FIT_HOPPING;
}

static uint64_t seed_of(const esk_parameters *query)
{
	return query->seed > 0 ? (uint64_t)query->seed : 0;
}

static void settle(esk_parameters *query)
{
	if (query->primitive == ESK_PRIMITIVE_UNSAID)
		query->primitive = ESK_PRIMITIVE_DEFORMED;
	if (query->method == ESK_METHOD_UNSAID)
		query->method = query->primitive == ESK_PRIMITIVE_ALGEBRAIC ? ESKEL_FIT_LEAST_SQUARES : ESKEL_FIT_JOINT;
}

bool esk_reconstruction_check(eskel_exchange *exchange)
{
	esk_parameters *query = &exchange->query;
	settle(query);
	const bool algebraic = query->primitive == ESK_PRIMITIVE_ALGEBRAIC;
	if (query->primitive == ESK_PRIMITIVE_ELLIPSOID)
		return esk_problem_set(&exchange->problem, 400,
			"primitive is ellipsoid, expected superquadric, deformed or algebraic: best ellipsoids are "
			"not fitted");
	if (algebraic != (query->method == ESKEL_FIT_LEAST_SQUARES))
		return esk_problem_set(&exchange->problem, 400, "method is %s and primitive is %s, expected %s",
			esk_parameters_choice(query, "method"), esk_parameters_choice(query, "primitive"),
			algebraic ? "least_squares, which alone fits algebraic surfaces"
				  : "joint, tabu or hopping: least_squares fits algebraic surfaces");
	return query->seed < 0 || is_random(query) ||
	       esk_problem_set(&exchange->problem, 400,
		       "seed is given beside method %s, expected tabu or hopping: nothing else is random",
		       esk_parameters_choice(query, "method"));
}

/* ---- answering */

static json_t *primitive_json(const eskel_surface *surface, uint32_t class_index)
{
	const eskel_primitive *p = eskel_surface_primitive(surface, class_index);
	unsigned degree;
	const double *polynomial = eskel_surface_polynomial(surface, class_index, &degree);
	json_t *json = json_pack("{s:o, s:[o, o, o], s:o, s:f}", "centre_mm", esk_json_reals(p->centre, 3), "axes",
		esk_json_reals(p->axes[0], 3), esk_json_reals(p->axes[1], 3), esk_json_reals(p->axes[2], 3), "radii_mm",
		esk_json_reals(p->radii, 3), "alpha", p->alpha);
	const size_t terms = polynomial ? (degree + 1) * (degree + 2) * (degree + 3) / 6 : 0;
	const bool whole =
		polynomial
			? json_object_set_new(json, "coefficients", esk_json_reals(polynomial, terms)) == 0
			: json_object_set_new(json, "exponents", esk_json_reals(p->exponents, 2)) == 0 &&
				  json_object_set_new(json, "modes", esk_json_reals(p->modes, ESKEL_MODE_COUNT)) == 0;
	if (whole)
		return json;
	json_decref(json);
	return NULL;
}

/* The summary with the surface's own members. */
static json_t *fitted_json(const eskel_fitted *fitted, const eskel_surface *surface)
{
	json_t *body = json_loads(fitted->summary, 0, NULL), *array = json_array();
	for (uint32_t i = 0; i < eskel_surface_count(surface); i++)
		json_array_append_new(array, primitive_json(surface, i));
	const bool whole = json_array_size(array) == eskel_surface_count(surface);
	const char *compose = eskel_surface_composition(surface) == ESKEL_COMPOSE_UNION ? "union" : "blend";
	if (body && whole && json_object_set(body, "primitives", array) == 0 &&
		json_object_set_new(body, "compose", json_string(compose)) == 0 &&
		json_object_set_new(body, "level", json_integer(fitted->level)) == 0 &&
		json_object_set_new(body, "primitive", json_string(fitted->primitive)) == 0) {
		json_decref(array);
		return body;
	}
	json_decref(array);
	json_decref(body);
	return NULL;
}

static bool answer_fitted(eskel_exchange *exchange, const eskel_fitted *fitted)
{
	eskel_error error = {0};
	eskel_surface *surface = NULL;
	const bool good = esk_problem_engine(&exchange->problem,
				  eskel_surface_decode(fitted->bytes, fitted->size, &surface, &error), &error) &&
			  esk_exchange_answer_json(exchange, 200, fitted_json(fitted, surface));
	eskel_surface_free(surface);
	return good;
}

bool esk_reconstruction_get(eskel_exchange *exchange)
{
	esk_drawn drawn = {0};
	eskel_fitted fitted = {0};
	uint32_t level;
	const bool good = esk_drawn_read(exchange, &drawn) && esk_drawn_level(exchange, &drawn, &level) &&
			  esk_drawn_fitted(exchange, &drawn, level, &fitted) && answer_fitted(exchange, &fitted);
	eskel_fitted_clear(&fitted);
	esk_drawn_clear(&drawn);
	return good;
}

/* ---- fitting */

static json_t *error_json(const eskel_surface_error *e)
{
	return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "mean_delta_mm", esk_json_real(e->mean_delta),
		"greatest_delta_mm", esk_json_real(e->greatest_delta), "mean_error_mm", esk_json_real(e->mean_error),
		"greatest_error_mm", esk_json_real(e->greatest_error), "mean_distance_mm",
		esk_json_real(e->mean_distance), "hausdorff_95_mm", esk_json_real(e->hausdorff_95), "dice",
		esk_json_real(e->dice), "volume_ratio", esk_json_real(e->volume_ratio));
}

/* Bytes of the surface, of the voxels' box at a byte each, and of a mesh of a medium step with normals. */
static json_t *bytes_json(const esk_drawn *drawn, const eskel_cloud *cloud, const eskel_surface *surface, size_t size)
{
	const double box = (double)cloud->extent[0] * cloud->extent[1] * cloud->extent[2];
	eskel_mesh *mesh = NULL;
	double mesh_size = NAN;
	if (eskel_surface_mesh(surface, 2 * esk_detail_step(drawn->skeleton), 0, &mesh, NULL) == ESKEL_OK)
		mesh_size = 24 * (double)mesh->vertex_count + 12 * (double)mesh->triangle_count;
	eskel_mesh_free(mesh);
	return json_pack("{s:I, s:o, s:o, s:o, s:o}", "surface", (json_int_t)size, "volume", esk_json_real(box), "mesh",
		esk_json_real(mesh_size), "volume_ratio", esk_json_real(box / (double)size), "mesh_ratio",
		esk_json_real(mesh_size / (double)size));
}

static bool tell(void *context, uint32_t step, uint32_t steps)
{
	const eskel_exchange *exchange = context;
	return exchange->progress(exchange->progress_context, steps > 0 ? (double)step / steps : 0);
}

static bool fit(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, const eskel_cloud *cloud,
	eskel_reconstruction **reconstruction)
{
	eskel_error error = {0};
	const eskel_fit_options options = {.method = (eskel_fit_method)exchange->query.method,
		.freedom = freedoms[exchange->query.primitive],
		.seed = seed_of(&exchange->query),
		.threads = ESKEL_THREADS_ONLINE,
		.progress = tell,
		.context = exchange};
	return esk_problem_engine(&exchange->problem,
		eskel_surface_fit(cloud, drawn->skeleton, level, &options, reconstruction, &error), &error);
}

static bool summarise(eskel_exchange *exchange, const esk_drawn *drawn, const eskel_cloud *cloud,
	const eskel_reconstruction *made, eskel_fitted *fitted)
{
	if (eskel_surface_encode(made->surface, &fitted->bytes, &fitted->size) != ESKEL_OK)
		return esk_problem_no_memory(&exchange->problem);
	fitted->level = made->level;
	fitted->primitive = esk_parameters_choice(&exchange->query, "primitive");
	json_t *seed = is_random(&exchange->query) ? json_integer((json_int_t)seed_of(&exchange->query)) : NULL;
	fitted->summary = esk_json_text(json_pack("{s:s, s:o*, s:o, s:o, s:o}", "method",
		esk_parameters_choice(&exchange->query, "method"), "seed", seed, "before", error_json(&made->before),
		"after", error_json(&made->after), "bytes", bytes_json(drawn, cloud, made->surface, fitted->size)));
	return fitted->summary || esk_problem_no_memory(&exchange->problem);
}

static bool make_fitted(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, eskel_fitted *fitted)
{
	eskel_store *store = exchange->api->store;
	eskel_store_error error = {0};
	eskel_cloud *cloud = NULL;
	eskel_reconstruction *made = NULL;
	const bool good = esk_problem_store(&exchange->problem,
				  eskel_store_cloud(store, drawn->shape.key, &cloud, &error), &error) &&
			  fit(exchange, drawn, level, cloud, &made) &&
			  summarise(exchange, drawn, cloud, made, fitted) &&
			  esk_problem_store(&exchange->problem,
				  eskel_store_surface_put(store, drawn->shape.key, fitted, &error), &error);
	eskel_reconstruction_free(made);
	eskel_cloud_free(cloud);
	return good;
}

static bool answer_job(eskel_exchange *exchange)
{
	esk_job job;
	char path[ESK_JOB_PATH_SIZE];
	snprintf(path, sizeof path, "/shapes/%s/reconstruction", exchange->id);
	return esk_jobs_add(exchange->api->jobs, exchange, "POST", path, &job) &&
	       esk_exchange_add_header(exchange, "Location", "/jobs/%s", job.id) &&
	       esk_exchange_answer_json(exchange, 202, esk_job_json(&job));
}

bool esk_reconstruction_post(eskel_exchange *exchange)
{
	esk_drawn drawn = {0};
	eskel_fitted fitted = {0};
	uint32_t level;
	bool good = esk_drawn_read(exchange, &drawn) && esk_drawn_level(exchange, &drawn, &level);
	if (good && !exchange->progress)
		good = answer_job(exchange);
	else if (good)
		good = make_fitted(exchange, &drawn, level, &fitted) && answer_fitted(exchange, &fitted);
	eskel_fitted_clear(&fitted);
	esk_drawn_clear(&drawn);
	return good;
}
