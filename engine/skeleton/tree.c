#include "tree.h"

#include "eigen.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double negligible_ratio = 0.05; /* section 2.4.3 */

eskel_status esk_tree_new(uint32_t level_count, eskel_skeleton **skeleton)
{
	eskel_skeleton *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->level_count = level_count;
	made->levels = esk_memory_zeroed_array(level_count, sizeof *made->levels);
	made->nodes = esk_memory_zeroed_array(ESKEL_NODES(level_count), sizeof *made->nodes);
	if (!made->levels || !made->nodes) {
		eskel_skeleton_free(made);
		return ESKEL_NO_MEMORY;
	}
	*skeleton = made;
	return ESKEL_OK;
}

void eskel_skeleton_free(eskel_skeleton *skeleton)
{
	if (!skeleton)
		return;
	free(skeleton->levels);
	free(skeleton->nodes);
	free(skeleton);
}

static double distance(const double a[3], const double b[3])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return sqrt(x * x + y * y + z * z);
}

static eskel_status derive_node(const eskel_node *root, eskel_node *node)
{
	esk_eigen eigen;
	eskel_status status = esk_eigen_symmetric((const double(*)[3])node->covariance, &eigen);
	if (status)
		return status;
	memcpy(node->eigenvalues, eigen.values, sizeof eigen.values);
	memcpy(node->axes, eigen.axes, sizeof eigen.axes);
	node->rho = distance(node->centre, root->centre);
	return isfinite(node->rho) ? ESKEL_OK : ESKEL_NUMERIC;
}

eskel_status esk_tree_derive(eskel_skeleton *skeleton)
{
	eskel_node *node = skeleton->nodes;
	skeleton->voxels = node->voxels;
	skeleton->weight = node->weight;
	skeleton->level_of_5_percent = 0;
	for (uint32_t k = 1; k <= skeleton->level_count; k++) {
		eskel_level *level = &skeleton->levels[k - 1];
		level->level = k;
		if (!skeleton->level_of_5_percent && level->intraclass_ratio <= negligible_ratio)
			skeleton->level_of_5_percent = k;
		for (uint32_t c = 0; c < k; c++, node++) {
			eskel_status status = derive_node(skeleton->nodes, node);
			if (status)
				return status;
			node->level = k;
			node->class_index = c;
			/* a class keeps its index, and the last one came out of the class that was split */
			node->parent = c + 1 == k ? level->split_class : (int32_t)c;
		}
	}
	return ESKEL_OK;
}

const eskel_node *eskel_skeleton_node(const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index)
{
	if (level < 1 || level > skeleton->level_count || class_index >= level)
		return NULL;
	return &skeleton->nodes[ESKEL_NODES(level - 1) + class_index];
}

unsigned eskel_skeleton_children(
	const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index, uint32_t children[2])
{
	if (level < 1 || level >= skeleton->level_count || class_index >= level)
		return 0;
	children[0] = class_index;
	if (skeleton->levels[level].split_class != (int32_t)class_index)
		return 1;
	children[1] = level;
	return 2;
}
