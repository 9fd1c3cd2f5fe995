/* Isomorphism of two skeletons (section 5.4).
 *
 * At level 1 the whole matches the whole. Where one tree splits a class and the other splits the class that is matched
 * with it, the match goes on: the other classes keep their partners, and two parts match two parts in one of two ways.
 * It ends where one tree splits another class, or has no deeper level. A split keeps the numbers of all classes and gives
 * the next one to the lighter part, so the parts of class c of level k are classes c and k of level k + 1.
 *
 * Which class is split often hangs on a hair, and one difference ends all: a depth that is great says that two shapes
 * are alike, a small one says little. Of 126 pairs of bones of one class the mean depth is 3.9, and 18 reach level 6; of
 * 5880 pairs of different classes it is 3.0, and 112 do. */
#include "assignment.h"
#include "class_costs.h"
#include "distance.h"

#include <string.h>

/* A skeleton with the numbers of its classes. */
typedef struct {
	const eskel_skeleton *skeleton;
	esk_shape *shape;
	esk_query query;
} tree;

static void clear(tree *t)
{
	esk_query_clear(&t->query);
	esk_shape_release(t->shape);
}

static eskel_status init(tree *t, const eskel_skeleton *skeleton, const eskel_distance_options *options)
{
	eskel_signature *signature = NULL;
	*t = (tree){.skeleton = skeleton};
	eskel_status status = eskel_signature_new(skeleton, &signature);
	if (status == ESKEL_OK)
		status = esk_shape_new(signature, &t->shape);
	if (status == ESKEL_OK)
		status = esk_query_init(&t->query, t->shape, options);
	eskel_signature_free(signature);
	return status;
}

/* The class of a level that is split to make the next one, -1 at the deepest. */
static int32_t split_of(const tree *t, uint32_t level)
{
	return level < t->skeleton->level_count ? t->skeleton->levels[level].split_class : -1;
}

/* Matches the classes of level k + 1 from those of level k. */
static void extend(const tree *a, const tree *b, uint32_t k, eskel_isomorphism *found)
{
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float costs[ESK_ASSIGNMENT_COSTS_MAX];
	const uint8_t *above = &found->other[ESKEL_NODES(k - 1)];
	uint8_t *below = &found->other[ESKEL_NODES(k)];
	const uint32_t width = esk_assignment_width(k + 1), i = (uint32_t)split_of(a, k), j = above[i];
	esk_class_costs(
		a->query.metric, esk_numbers(a->query.signature), k + 1, a->query.rows[k], b->query.rows[k], costs);
	const float straight = costs[i * width + j] + costs[k * width + k];
	const float crossed = costs[i * width + k] + costs[k * width + j];
	memcpy(below, above, k);
	below[i] = (uint8_t)(straight <= crossed ? j : k);
	below[k] = (uint8_t)(straight <= crossed ? k : j);
}

static void find(const tree *a, const tree *b, eskel_isomorphism *found)
{
	uint32_t k = 1;
	int32_t split = split_of(a, k), other = split_of(b, k);
	found->other[0] = 0;
	while (split >= 0 && other >= 0 && found->other[ESKEL_NODES(k - 1) + (uint32_t)split] == other) {
		extend(a, b, k++, found);
		split = split_of(a, k);
		other = split_of(b, k);
	}
	found->depth = k;
	found->complete = split < 0 || other < 0;
	found->split_class[0] = split;
	found->split_class[1] = other;
}

eskel_status eskel_isomorphism_find(const eskel_skeleton *a, const eskel_skeleton *b,
	const eskel_distance_options *options, eskel_isomorphism *isomorphism)
{
	tree of_a = {0}, of_b = {0};
	eskel_status status = init(&of_a, a, options);
	if (status == ESKEL_OK)
		status = init(&of_b, b, options);
	if (status == ESKEL_OK)
		find(&of_a, &of_b, isomorphism);
	clear(&of_a);
	clear(&of_b);
	return status;
}
