/* GET /shapes/{id}/ellipsoids and /shapes/{id}/levels-of-detail, and what they have in common with the mesh (mesh.h). */
#include "detail.h"
#include "mesh.h"
#include "resources.h"

#include <stdio.h>

bool esk_drawn_read(eskel_exchange *exchange, esk_drawn *drawn)
{
	eskel_store_error error = {0};
	if (!esk_shape_of_id(exchange, exchange->id, &drawn->shape))
		return false;
	return esk_problem_store(&exchange->problem,
		eskel_store_skeleton(exchange->api->store, drawn->shape.key, &drawn->skeleton, &error), &error);
}

void esk_drawn_clear(esk_drawn *drawn)
{
	eskel_skeleton_free(drawn->skeleton);
	eskel_shape_clear(&drawn->shape);
}

bool esk_drawn_level(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t *level)
{
	const uint32_t deepest = drawn->skeleton->level_count;
	*level = exchange->query.level ? exchange->query.level : deepest;
	return *level <= deepest ||
	       esk_problem_set(&exchange->problem, 400, "level is %u, expected 1 to %u: shape %s has no more", *level,
		       deepest, exchange->id);
}

bool esk_drawn_surface(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, eskel_surface **surface)
{
	const eskel_surface_options options = {
		.compose = exchange->query.compose == ESK_COMPOSE_UNION ? ESKEL_COMPOSE_UNION : ESKEL_COMPOSE_BLEND};
	return esk_problem_engine(
		&exchange->problem, eskel_surface_new(drawn->skeleton, level, &options, surface), NULL);
}

bool esk_drawn_fitted(eskel_exchange *exchange, const esk_drawn *drawn, uint32_t level, eskel_fitted *fitted)
{
	eskel_store_error error = {0};
	const char *primitive = esk_parameters_choice(&exchange->query, "primitive");
	const eskel_store_status status =
		eskel_store_surface(exchange->api->store, drawn->shape.key, level, primitive, fitted, &error);
	if (status != ESKEL_STORE_NOT_FOUND)
		return esk_problem_store(&exchange->problem, status, &error);
	return esk_problem_set(&exchange->problem, 404,
		"no surface of the primitive %s was fitted to level %u of shape %s, expected a POST to its "
		"reconstruction "
		"before",
		primitive, level, exchange->id);
}

/* ---- ellipsoids */

static json_t *ellipsoid_json(const eskel_primitive *p)
{
	return json_pack("{s:o, s:[o, o, o], s:o, s:f}", "centre_mm", esk_json_reals(p->centre, 3), "axes",
		esk_json_reals(p->axes[0], 3), esk_json_reals(p->axes[1], 3), esk_json_reals(p->axes[2], 3), "radii_mm",
		esk_json_reals(p->radii, 3), "alpha", p->alpha);
}

static json_t *ellipsoids_json(const eskel_surface *surface, uint32_t level)
{
	json_t *array = json_array();
	for (uint32_t i = 0; i < eskel_surface_count(surface); i++)
		if (json_array_append_new(array, ellipsoid_json(eskel_surface_primitive(surface, i))) != 0) {
			json_decref(array);
			return NULL;
		}
	return json_pack("{s:i, s:s, s:o}", "level", (int)level, "compose",
		eskel_surface_composition(surface) == ESKEL_COMPOSE_UNION ? "union" : "blend", "ellipsoids", array);
}

bool esk_ellipsoids_get(eskel_exchange *exchange)
{
	esk_drawn drawn = {0};
	eskel_surface *surface = NULL;
	uint32_t level;
	const bool good = esk_drawn_read(exchange, &drawn) && esk_drawn_level(exchange, &drawn, &level) &&
			  esk_drawn_surface(exchange, &drawn, level, &surface) &&
			  esk_exchange_answer_json(exchange, 200, ellipsoids_json(surface, level));
	eskel_surface_free(surface);
	esk_drawn_clear(&drawn);
	return good;
}

/* ---- levels of detail */

static json_t *detail_json(const char *id, const esk_detail *detail)
{
	char url[160];
	snprintf(url, sizeof url, "/shapes/%s/mesh?level=%u&step=%.15g", id, detail->level, detail->step);
	return json_pack("{s:o, s:i, s:o, s:s}", "from_mm", esk_json_real(detail->from), "level", (int)detail->level,
		"step_mm", esk_json_real(detail->step), "url", url);
}

bool esk_details_get(eskel_exchange *exchange)
{
	esk_drawn drawn = {0};
	esk_detail details[ESK_DETAILS];
	bool good = esk_drawn_read(exchange, &drawn);
	if (good) {
		json_t *array = json_array();
		esk_detail_table(drawn.skeleton, details);
		for (size_t i = 0; i < ESK_DETAILS; i++)
			json_array_append_new(array, detail_json(exchange->id, &details[i]));
		if (json_array_size(array) < ESK_DETAILS) {
			json_decref(array);
			array = NULL;
		}
		good = esk_exchange_answer_json(exchange, 200, json_pack("{s:o}", "details", array));
	}
	esk_drawn_clear(&drawn);
	return good;
}
