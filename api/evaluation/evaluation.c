/* One evaluation, see evaluation.h: a pass over the rows of distances, each of which is judged and forgotten; then what
 * handedness says of the pairs that the rows have named. */
#include "evaluation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 0.05 is where a chirality decides, 0.2 where a verdict is certain of a side (verdict.c). */
const double esk_side_thresholds[ESK_SIDE_THRESHOLDS] = {0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4};

/* ---- numbers for texts */

typedef struct {
	const char *text; /* NULL: none */
	size_t position;
} numbered_text;

static int by_text(const void *a, const void *b)
{
	const numbered_text *x = a, *y = b;
	if (!x->text || !y->text)
		return !x->text - !y->text;
	return strcmp(x->text, y->text);
}

/* Sorts texts[count]; equal ones have the same number, in ascending order. names, unless NULL, receives each once. */
static uint32_t number_texts(numbered_text *texts, size_t count, uint32_t *numbers, const char **names)
{
	uint32_t number = 0;
	qsort(texts, count, sizeof *texts, by_text);
	for (size_t i = 0; i < count; i++) {
		const char *text = texts[i].text;
		bool is_new = text && (i == 0 || strcmp(texts[i - 1].text, text) != 0);
		if (is_new && names)
			names[number] = text;
		number += is_new;
		numbers[texts[i].position] = text ? number - 1 : ESKEL_UNNUMBERED;
	}
	return number;
}

static bool number_shapes(esk_evaluation *e, bool by_subject)
{
	numbered_text *texts = calloc(e->count + 1, sizeof *texts);
	e->classes = calloc(e->count + 1, sizeof *e->classes);
	e->class_names = calloc(e->count + 1, sizeof *e->class_names);
	if (by_subject)
		e->subjects = calloc(e->count + 1, sizeof *e->subjects);
	bool good = texts && e->classes && e->class_names && (e->subjects || !by_subject);
	for (size_t i = 0; good && i < e->count; i++)
		texts[i] = (numbered_text){e->shapes[i].description.class, i};
	if (good)
		e->class_count = number_texts(texts, e->count, e->classes, e->class_names);
	for (size_t i = 0; good && by_subject && i < e->count; i++)
		texts[i] = (numbered_text){e->shapes[i].description.subject, i};
	if (good && by_subject)
		number_texts(texts, e->count, e->subjects, NULL);
	free(texts);
	return good;
}

/* ---- rows */

static eskel_evaluation numbers_of(const esk_evaluation *e)
{
	return (eskel_evaluation){e->count, e->classes, e->subjects};
}

static bool is_sided(const esk_evaluation *e, size_t shape)
{
	eskel_side side = e->shapes[shape].description.side;
	return e->classes[shape] != ESKEL_UNNUMBERED && (side == ESKEL_SIDE_LEFT || side == ESKEL_SIDE_RIGHT);
}

static esk_nearest_shapes find_nearest(const esk_evaluation *e, size_t query, const double *distances)
{
	const eskel_evaluation numbers = numbers_of(e);
	esk_nearest_shapes found = {ESK_NO_SHAPE, ESK_NO_SHAPE};
	for (size_t i = 0; i < e->count; i++) {
		if (eskel_evaluation_leaves_out(&numbers, query, i))
			continue;
		if (found.nearest == ESK_NO_SHAPE || distances[i] < distances[found.nearest])
			found.nearest = i;
		bool fits = is_sided(e, query) && is_sided(e, i) && e->classes[i] == e->classes[query];
		if (fits && (found.sided == ESK_NO_SHAPE || distances[i] < distances[found.sided]))
			found.sided = i;
	}
	return found;
}

static eskel_status judge_row(esk_evaluation *e, size_t row, const double *distances)
{
	const eskel_evaluation numbers = numbers_of(e);
	e->nearest[row] = find_nearest(e, row, distances);
	return eskel_evaluation_judge(&numbers, row, distances, &e->retrievals[row]);
}

/* The next so many distances, or those that are left. */
static eskel_status fill(eskel_distance_table *table, double *distances, size_t most, size_t *filled)
{
	eskel_status status = ESKEL_OK;
	size_t count = 1;
	for (*filled = 0; status == ESKEL_OK && count > 0; *filled += count) {
		count = 0;
		status = eskel_distance_table_next(table, most - *filled, distances + *filled, &count);
	}
	return status;
}

/* Rows are computed together, so that threads have enough to do. */
static eskel_status judge_table(esk_evaluation *e, eskel_distance_table *table)
{
	enum { rows_at_a_time = 64 };
	const size_t most = rows_at_a_time * e->count;
	double *distances = calloc(most + 1, sizeof *distances);
	eskel_status status = distances ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t row = 0; status == ESKEL_OK && row < e->count;) {
		size_t filled = 0;
		status = fill(table, distances, most, &filled);
		for (size_t at = 0; status == ESKEL_OK && at < filled; at += e->count)
			status = judge_row(e, row++, distances + at);
	}
	free(distances);
	return status;
}

static eskel_status judge_rows(eskel_api *api, const esk_parameters *query, esk_evaluation *e)
{
	const eskel_distance_table_options options = {
		.distance = esk_parameters_distance(query),
		.threads = ESKEL_THREADS_ONLINE,
	};
	eskel_distance_table *table = NULL;
	int64_t *keys = calloc(e->count + 1, sizeof *keys);
	e->retrievals = calloc(e->count + 1, sizeof *e->retrievals);
	e->nearest = calloc(e->count + 1, sizeof *e->nearest);
	eskel_status status = ESKEL_NO_MEMORY;
	for (size_t i = 0; keys && i < e->count; i++)
		keys[i] = e->shapes[i].key;
	if (keys && e->retrievals && e->nearest)
		status = eskel_distance_table_new(api->library, keys, e->count, keys, e->count, &options, &table);
	if (status == ESKEL_OK)
		status = judge_table(e, table);
	eskel_distance_table_free(table);
	free(keys);
	return status;
}

/* ---- sides */

static void count_side(esk_side_accuracy *side, double score, bool same)
{
	side->compared++;
	for (size_t t = 0; t < ESK_SIDE_THRESHOLDS; t++) {
		bool decided = score != 0 && fabs(score) >= esk_side_thresholds[t];
		side->at[t].decided += decided;
		side->at[t].right += decided && (score > 0) == same;
	}
}

/* *known stays NULL when the shape has gone. */
static bool know(eskel_api *api, int64_t key, const esk_known_shape **known, esk_problem *problem)
{
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(api->known, key, known, &error);
	return status == ESKEL_STORE_NOT_FOUND || esk_problem_store(problem, status, &error);
}

static bool compare_sides(eskel_api *api, esk_evaluation *e, size_t query, esk_problem *problem)
{
	const eskel_shape *shape = &e->shapes[query], *other = &e->shapes[e->nearest[query].sided];
	const esk_known_shape *mine = NULL, *theirs = NULL;
	eskel_chirality chirality;
	bool good = know(api, shape->key, &mine, problem) && know(api, other->key, &theirs, problem);
	if (good && mine && theirs) {
		eskel_status status = eskel_chirality_compare(mine->placement, theirs->placement, &chirality);
		good = esk_problem_engine(problem, status, NULL);
		if (good)
			count_side(&e->side, chirality.score, shape->description.side == other->description.side);
	}
	esk_known_release(api->known, mine);
	esk_known_release(api->known, theirs);
	return good;
}

/* ---- the whole */

bool esk_evaluation_make(eskel_api *api, const esk_parameters *query, esk_evaluation *evaluation, eskel_status *status,
	esk_problem *problem)
{
	bool numbered = number_shapes(evaluation, query->leave_out == ESK_LEAVE_OUT_SUBJECT);
	*status = numbered ? judge_rows(api, query, evaluation) : ESKEL_NO_MEMORY;
	if (*status != ESKEL_OK)
		return *status == ESKEL_NOT_FOUND || esk_problem_engine(problem, *status, NULL);
	evaluation->query_count = eskel_retrieval_mean(evaluation->retrievals, evaluation->count, &evaluation->mean);
	for (size_t i = 0; i < evaluation->count; i++)
		if (evaluation->nearest[i].sided != ESK_NO_SHAPE && !compare_sides(api, evaluation, i, problem))
			return false;
	return esk_evaluation_search(api, query, evaluation, problem);
}

void esk_evaluation_clear(esk_evaluation *evaluation)
{
	eskel_shapes_free(evaluation->shapes, evaluation->count);
	free(evaluation->class_names);
	free(evaluation->classes);
	free(evaluation->subjects);
	free(evaluation->retrievals);
	free(evaluation->nearest);
	*evaluation = (esk_evaluation){0};
}
