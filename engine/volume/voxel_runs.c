#include "voxel_runs.h"

#include "error.h"
#include "layers.h"
#include "memory.h"
#include "weight_builder.h"

#include <stdlib.h>
#include <string.h>

enum { largest_value = 8 };

struct esk_voxel_runs {
	esk_run_builder *builder;    /* NULL: voxels are weights */
	esk_weight_builder *weights; /* NULL: voxels are labels */
	esk_layers *layers;          /* NULL: one, the builder's */
	size_t voxel_size;
	uint8_t broken[largest_value * ESK_LAYERS_MOST]; /* the first bytes of a voxel that the last piece broke off */
	size_t broken_size;
};

eskel_status esk_voxel_runs_new(
	const esk_run_limits *limits, const int32_t *labels, size_t label_count, bool weights, esk_voxel_runs **runs)
{
	esk_voxel_runs *r = esk_memory_zeroed_array(1, sizeof *r);
	if (!r)
		return ESKEL_NO_MEMORY;
	eskel_status status = weights ? esk_weight_builder_new(limits->most_runs, &r->weights)
				      : esk_run_builder_new(limits, labels, label_count, &r->builder);
	if (status == ESKEL_OK)
		*runs = r;
	else
		free(r);
	return status;
}

void esk_voxel_runs_free(esk_voxel_runs *runs)
{
	if (!runs)
		return;
	esk_layers_free(runs->layers);
	esk_run_builder_free(runs->builder);
	esk_weight_builder_free(runs->weights);
	free(runs);
}

eskel_status esk_voxel_runs_begin(esk_voxel_runs *runs, const esk_volume_header *header, eskel_error *error)
{
	const uint32_t *extent = header->info.extent, layer_count = header->layer_count;
	if (runs->weights && layer_count > 1)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the file has %u layers of segments, expected one weight a voxel", layer_count);
	runs->voxel_size = esk_volume_voxel_size(header);
	if (runs->weights)
		esk_weight_builder_set_grid(runs->weights, &header->voxels, extent);
	else
		esk_run_builder_set_grid(runs->builder, &header->voxels, extent);
	if (layer_count > 1 && esk_layers_new(runs->builder, &header->segments, layer_count, &header->voxels, extent,
				       &runs->layers) != ESKEL_OK)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %u layers", layer_count);
	return ESKEL_OK;
}

static eskel_status add_whole(esk_voxel_runs *r, const uint8_t *voxels, size_t count, eskel_error *error)
{
	if (r->weights)
		return esk_weight_builder_add(r->weights, voxels, count, error);
	return r->layers ? esk_layers_add(r->layers, voxels, count, error)
			 : esk_run_builder_add(r->builder, voxels, count, error);
}

eskel_status esk_voxel_runs_add(esk_voxel_runs *runs, const uint8_t *bytes, size_t size, eskel_error *error)
{
	const size_t voxel_size = runs->voxel_size;
	if (runs->broken_size > 0) {
		size_t missing = voxel_size - runs->broken_size, taken = size < missing ? size : missing;
		memcpy(runs->broken + runs->broken_size, bytes, taken);
		runs->broken_size += taken;
		bytes += taken;
		size -= taken;
		if (runs->broken_size < voxel_size)
			return ESKEL_OK;
		runs->broken_size = 0;
		eskel_status status = add_whole(runs, runs->broken, 1, error);
		if (status != ESKEL_OK)
			return status;
	}
	size_t whole = size / voxel_size;
	runs->broken_size = size % voxel_size;
	memcpy(runs->broken, bytes + whole * voxel_size, runs->broken_size);
	return add_whole(runs, bytes, whole, error);
}

esk_run_builder *esk_voxel_runs_builder(esk_voxel_runs *runs)
{
	return runs->builder;
}

eskel_status esk_voxel_runs_finish(esk_voxel_runs *runs, const esk_label_table **table, eskel_error *error)
{
	const esk_label_table *found = NULL;
	eskel_status status = ESKEL_OK;
	if (runs->weights)
		status = esk_weight_builder_finish(runs->weights, &found);
	else if (runs->layers)
		status = esk_layers_finish(runs->layers, &found);
	else
		found = esk_run_builder_finish(runs->builder);
	if (status != ESKEL_OK)
		return esk_error_set(error, status, "memory ran out for the runs of labels");
	if (found->count == 0)
		return esk_error_set(error, ESKEL_EMPTY,
			runs->weights ? "no voxel has a weight above 0" : "no voxel has a wanted label");
	*table = found;
	return ESKEL_OK;
}

const uint32_t *esk_voxel_runs_weights(const esk_voxel_runs *runs)
{
	return runs->weights ? esk_weight_builder_weights(runs->weights) : NULL;
}
