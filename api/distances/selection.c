#include "selection.h"

#include "resources.h"

#include <stdlib.h>
#include <string.h>

/* Shapes read at a time: each takes 500 bytes until what a matrix says of it is taken. */
enum { PAGE = 1000 };

static bool reserve(esk_selection *selection, size_t more)
{
	const size_t needed = selection->count + more;
	if (needed <= selection->capacity)
		return true;
	const size_t capacity = needed + needed / 2;
	esk_selected *shapes = realloc(selection->shapes, capacity * sizeof *shapes);
	if (shapes)
		selection->shapes = shapes;
	int64_t *keys = shapes ? realloc(selection->keys, capacity * sizeof *keys) : NULL;
	if (!keys)
		return false;
	selection->keys = keys;
	selection->capacity = capacity;
	return true;
}

/* Takes texts from the shape. */
static void add(esk_selection *selection, eskel_shape *shape)
{
	esk_selected *added = &selection->shapes[selection->count];
	*added = (esk_selected){
		.name = shape->description.name, .class = shape->description.class, .side = shape->description.side};
	memcpy(added->id, shape->id, sizeof added->id);
	shape->description.name = shape->description.class = NULL;
	selection->keys[selection->count++] = shape->key;
}

static bool check_count(eskel_exchange *exchange, const char *more, size_t count, size_t most)
{
	return count <= most ||
	       esk_problem_set(&exchange->problem, 413, "the matrix has %s%zu shapes on a side, expected at most %zu",
		       more, count, most);
}

static bool read_named(eskel_exchange *exchange, const esk_parameters *query, size_t most, esk_selection *selection)
{
	if (!check_count(exchange, "", selection->count + query->id_count, most))
		return false;
	if (!reserve(selection, query->id_count))
		return esk_problem_no_memory(&exchange->problem);
	for (size_t i = 0; i < query->id_count; i++) {
		eskel_shape shape = {0};
		if (!esk_shape_of_id(exchange, query->ids[i], &shape))
			return false;
		add(selection, &shape);
		eskel_shape_clear(&shape);
	}
	return true;
}

static bool read_page(
	eskel_exchange *exchange, const eskel_filter *filter, int64_t *after, esk_selection *selection, bool *more)
{
	eskel_store_error error = {0};
	eskel_shape *shapes = NULL;
	size_t count = 0;
	eskel_store_status status =
		eskel_store_list(exchange->api->store, filter, *after, PAGE, &shapes, &count, more, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	const bool room = reserve(selection, count);
	for (size_t i = 0; room && i < count; i++)
		add(selection, &shapes[i]);
	if (room && count > 0)
		*after = shapes[count - 1].key;
	eskel_shapes_free(shapes, count);
	return room || esk_problem_no_memory(&exchange->problem);
}

static bool read_filtered(eskel_exchange *exchange, const esk_parameters *query, size_t most, esk_selection *selection)
{
	const eskel_filter filter = esk_parameters_filter(query);
	int64_t after = 0;
	for (bool more = true; more;)
		if (!read_page(exchange, &filter, &after, selection, &more) ||
			!check_count(exchange, more ? "at least " : "", selection->count, most))
			return false;
	return true;
}

bool esk_selection_read(eskel_exchange *exchange, const esk_parameters *query, size_t most, esk_selection *selection)
{
	return query->id_count > 0 ? read_named(exchange, query, most, selection)
				   : read_filtered(exchange, query, most, selection);
}

void esk_selection_clear(esk_selection *selection)
{
	for (size_t i = 0; i < selection->count; i++) {
		free(selection->shapes[i].name);
		free(selection->shapes[i].class);
	}
	free(selection->shapes);
	free(selection->keys);
	*selection = (esk_selection){0};
}
