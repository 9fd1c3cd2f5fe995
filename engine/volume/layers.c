/* A run builder for each layer that has a segment; a window of voxels is taken apart for them, layer by layer.
 *
 * So a later layer may meet a bad voxel that comes first in the file. Of all errors in a window the one of the first
 * voxel is told, whatever piece the window is of: the result does not depend on how the file was cut. For that the
 * layers cannot count their runs together either.
 */
#include "layers.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

enum { window_voxels = 1 << 12 };

struct esk_layers {
	size_t count;
	unsigned size; /* of a value, in bytes */
	const esk_segments *segments;
	esk_run_builder **builders; /* NULL: no segment of the layer is wanted */
	const esk_label_table **tables;
	esk_label_table table;
	uint8_t window[8 * window_voxels];
};

/* values has room for all segments. */
static size_t wanted_values(const esk_run_builder *whole, const esk_segments *segments, size_t layer, int32_t *values)
{
	size_t count = 0;
	for (size_t i = 0; i < segments->count; i++)
		if (segments->items[i].layer == layer && esk_run_builder_wants(whole, segments->items[i].label))
			values[count++] = segments->items[i].value;
	return count;
}

static eskel_status new_builders(esk_layers *l, const esk_run_builder *whole, int32_t *values,
	const esk_voxel_format *format, const uint32_t extent[3])
{
	eskel_status status = ESKEL_OK;
	for (size_t i = 0; i < l->count && status == ESKEL_OK; i++) {
		const size_t wanted = wanted_values(whole, l->segments, i, values);
		if (wanted == 0)
			continue;
		status = esk_run_builder_new_share(whole, l->count, values, wanted, &l->builders[i]);
		if (status == ESKEL_OK)
			esk_run_builder_set_grid(l->builders[i], format, extent);
	}
	return status;
}

eskel_status esk_layers_new(const esk_run_builder *whole, const esk_segments *segments, size_t layer_count,
	const esk_voxel_format *format, const uint32_t extent[3], esk_layers **layers)
{
	eskel_status status = ESKEL_NO_MEMORY;
	int32_t *values = esk_memory_array(segments->count, sizeof *values);
	esk_layers *l = esk_memory_zeroed_array(1, sizeof *l);
	if (l) {
		l->count = layer_count;
		l->size = format->size;
		l->segments = segments;
		l->builders = esk_memory_zeroed_array(layer_count, sizeof *l->builders);
		l->tables = esk_memory_zeroed_array(layer_count, sizeof *l->tables);
	}
	if (values && l && l->builders && l->tables)
		status = new_builders(l, whole, values, format, extent);
	free(values);
	if (status == ESKEL_OK)
		*layers = l;
	else
		esk_layers_free(l);
	return status;
}

void esk_layers_free(esk_layers *layers)
{
	if (!layers)
		return;
	for (size_t i = 0; i < layers->count && layers->builders; i++)
		esk_run_builder_free(layers->builders[i]);
	free(layers->builders);
	free(layers->tables);
	free(layers->table.items);
	free(layers);
}

static void take_apart(esk_layers *l, size_t layer, const uint8_t *voxels, size_t count)
{
	const size_t stride = l->count * l->size;
	const uint8_t *from = voxels + layer * l->size;
	for (size_t i = 0; i < count; i++)
		for (unsigned b = 0; b < l->size; b++)
			l->window[i * l->size + b] = from[i * stride + b];
}

static eskel_status add_window(esk_layers *l, const uint8_t *voxels, size_t count, eskel_error *error)
{
	eskel_status first = ESKEL_OK;
	uint64_t place_of_first = UINT64_MAX;
	for (size_t i = 0; i < l->count; i++) {
		if (!l->builders[i])
			continue;
		eskel_error other = {0};
		take_apart(l, i, voxels, count);
		const eskel_status status = esk_run_builder_add(l->builders[i], l->window, count, &other);
		const uint64_t place = esk_run_builder_place(l->builders[i]);
		if (status == ESKEL_OK || place >= place_of_first)
			continue;
		first = status;
		place_of_first = place;
		if (error)
			*error = other;
	}
	return first;
}

eskel_status esk_layers_add(esk_layers *layers, const uint8_t *voxels, size_t count, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	while (status == ESKEL_OK && count > 0) {
		const size_t taken = count < window_voxels ? count : window_voxels;
		status = add_window(layers, voxels, taken, error);
		voxels += taken * layers->count * layers->size;
		count -= taken;
	}
	return status;
}

static int compare_labels(const void *a, const void *b)
{
	const int32_t p = ((const esk_label_runs *)a)->label, q = ((const esk_label_runs *)b)->label;
	return (p > q) - (p < q);
}

eskel_status esk_layers_finish(esk_layers *layers, const esk_label_table **table)
{
	const esk_segments *segments = layers->segments;
	esk_label_table *all = &layers->table;
	all->items = esk_memory_array(segments->count, sizeof *all->items);
	if (!all->items)
		return ESKEL_NO_MEMORY;
	for (size_t i = 0; i < layers->count; i++)
		layers->tables[i] = layers->builders[i] ? esk_run_builder_finish(layers->builders[i]) : NULL;
	for (size_t i = 0; i < segments->count; i++) {
		const esk_segment *s = &segments->items[i];
		const esk_label_table *layer = layers->tables[s->layer];
		const esk_label_runs *found = layer ? esk_label_table_find(layer, s->value) : NULL;
		if (!found)
			continue;
		all->items[all->count] = *found;
		all->items[all->count++].label = s->label;
	}
	qsort(all->items, all->count, sizeof *all->items, compare_labels);
	*table = all;
	return ESKEL_OK;
}
