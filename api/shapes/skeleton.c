/* GET /shapes/{id}/skeleton: the tree over all levels (section 2.5). A node's id is its place in nodes, level by level;
 * parent and children are ids. */
#include "exchange.h"
#include "resources.h"

#include <stdlib.h>

static int node_id(uint32_t level, uint32_t class_index)
{
	return (int)(ESKEL_NODES(level - 1) + class_index);
}

static json_t *matrix_json(const double matrix[3][3])
{
	return json_pack(
		"[o, o, o]", esk_json_reals(matrix[0], 3), esk_json_reals(matrix[1], 3), esk_json_reals(matrix[2], 3));
}

static json_t *children_json(const eskel_skeleton *skeleton, const eskel_node *node)
{
	uint32_t children[2];
	switch (eskel_skeleton_children(skeleton, node->level, node->class_index, children)) {
	case 1:
		return json_pack("[i]", node_id(node->level + 1, children[0]));
	case 2:
		return json_pack(
			"[i, i]", node_id(node->level + 1, children[0]), node_id(node->level + 1, children[1]));
	default:
		return json_array();
	}
}

static json_t *node_json(const eskel_skeleton *skeleton, const eskel_node *node)
{
	json_t *parent =
		node->parent < 0 ? json_null() : json_integer(node_id(node->level - 1, (uint32_t)node->parent));
	return json_pack("{s:i, s:i, s:i, s:o, s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "id",
		node_id(node->level, node->class_index), "level", (int)node->level, "class", (int)node->class_index,
		"parent", parent, "children", children_json(skeleton, node), "voxels", (json_int_t)node->voxels,
		"weight", esk_json_real(node->weight), "centre_mm", esk_json_reals(node->centre, 3), "covariance_mm2",
		matrix_json(node->covariance), "eigenvalues_mm2", esk_json_reals(node->eigenvalues, 3), "axes",
		matrix_json(node->axes), "rho_mm", esk_json_real(node->rho));
}

static json_t *level_json(const eskel_level *level)
{
	bool whole = level->split_class < 0;
	json_t *nodes = json_array();
	for (uint32_t i = 0; i < level->level; i++)
		if (json_array_append_new(nodes, json_integer(node_id(level->level, i))) != 0) {
			json_decref(nodes);
			return NULL;
		}
	return json_pack("{s:i, s:o, s:o, s:o, s:o, s:b}", "level", (int)level->level, "nodes", nodes,
		"intraclass_ratio", esk_json_real(level->intraclass_ratio), "split_class",
		whole ? json_null() : json_integer(level->split_class), "split_ratio",
		whole ? json_null() : esk_json_real(level->split_ratio), "degenerate", (int)level->degenerate);
}

static json_t *skeleton_json(const eskel_skeleton *skeleton)
{
	bool good = true;
	json_t *levels = json_array(), *nodes = json_array();
	for (uint32_t i = 0; i < skeleton->level_count && good; i++)
		good = json_array_append_new(levels, level_json(&skeleton->levels[i])) == 0;
	for (size_t i = 0; i < ESKEL_NODES(skeleton->level_count) && good; i++)
		good = json_array_append_new(nodes, node_json(skeleton, &skeleton->nodes[i])) == 0;
	uint32_t level = skeleton->level_of_5_percent;
	json_t *json = json_pack("{s:o, s:o, s:o}", "levels", levels, "nodes", nodes, "level_of_5_percent",
		level ? json_integer(level) : json_null());
	if (good)
		return json;
	json_decref(json);
	return NULL;
}

char *eskel_skeleton_text(const eskel_skeleton *skeleton)
{
	return esk_json_text(skeleton_json(skeleton));
}

bool esk_skeleton_get(eskel_exchange *exchange)
{
	eskel_shape shape = {0};
	eskel_skeleton *skeleton = NULL;
	eskel_store_error error = {0};
	if (!esk_shape_of_id(exchange, exchange->id, &shape))
		return false;
	eskel_store_status status = eskel_store_skeleton(exchange->api->store, shape.key, &skeleton, &error);
	bool good = esk_problem_store(&exchange->problem, status, &error) &&
		    esk_exchange_answer_json(exchange, 200, skeleton_json(skeleton));
	eskel_skeleton_free(skeleton);
	eskel_shape_clear(&shape);
	return good;
}
