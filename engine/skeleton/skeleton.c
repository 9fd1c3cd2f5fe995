/* From a cloud to its skeleton: the levels of the partition, brought to world space (sections 2.4 and 2.5). */
#include "affine.h"
#include "coarse.h"
#include "error.h"
#include "levels.h"
#include "memory.h"
#include "morton.h"
#include "tree.h"

#include <stdlib.h>

/* The levels of the coarse cloud, their sums brought to voxel coordinates. Its metric is that of the cloud: the box is
 * smaller, but only the scaling of scores depends on that. */
static eskel_status coarse_levels(const eskel_cloud *cloud, const esk_levels_input *fine, esk_levels *levels)
{
	esk_segment *segments = NULL;
	esk_levels_input input = *fine;
	eskel_status status = esk_coarse_segments(cloud, &segments, &input.segment_count);
	if (status)
		return status;
	input.segments = segments;
	input.progress = NULL;
	status = esk_morton_sort(segments, input.segment_count);
	if (!status)
		status = esk_levels_compute(&input, levels);
	free(segments);
	for (size_t n = 0; !status && n < ESKEL_NODES(levels->count); n++)
		for (int r = 0; r < 3; r++)
			levels->classes[n].sums.first[r] *= 3;
	return status;
}

/* Below some thousand runs a pass takes less time than threads take to meet. */
static esk_team *team_for(const eskel_cloud *cloud, const eskel_skeleton_options *options)
{
	static const size_t few_runs = 8192;
	return cloud->run_count < few_runs ? NULL : esk_team_new(esk_team_threads(options->threads));
}

static eskel_status list_segments(const eskel_cloud *cloud, esk_segment **segments)
{
	esk_segment *made = esk_memory_array(cloud->run_count, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	esk_segments_from_cloud(cloud, made);
	eskel_status status = esk_morton_sort(made, cloud->run_count);
	if (status) {
		free(made);
		return status;
	}
	*segments = made;
	return ESKEL_OK;
}

static eskel_status make_levels(const eskel_cloud *cloud, const eskel_skeleton_options *options, esk_levels *levels)
{
	esk_levels *coarse = NULL;
	esk_segment *segments = NULL;
	eskel_status status = list_segments(cloud, &segments);
	if (status)
		return status;
	esk_moments whole = {0};
	for (size_t i = 0; i < cloud->run_count; i++)
		esk_moments_add(&whole, &segments[i]);

	esk_metric metric;
	const eskel_affine world = esk_segments_world(cloud);
	if (options->metric == ESKEL_PARTITION_MAHALANOBIS)
		status = esk_metric_mahalanobis(cloud, &whole, &metric);
	else
		esk_metric_euclidean(cloud, &metric);
	esk_levels_input input = {
		.segments = segments,
		.segment_count = cloud->run_count,
		.metric = &metric,
		.root_map = &world,
		.levels = options->levels,
		.team = team_for(cloud, options),
		.progress = options->progress,
		.context = options->context,
	};
	if (!status && options->coarse_start) {
		coarse = esk_memory_array(1, sizeof *coarse);
		status = coarse ? coarse_levels(cloud, &input, coarse) : ESKEL_NO_MEMORY;
		input.starts = coarse;
	}
	if (!status)
		status = esk_levels_compute(&input, levels);
	esk_team_free(input.team);
	free(coarse);
	free(segments);
	return status;
}

/* What a node stores; the rest is derived. */
static void fill_node(const esk_moments *moments, const eskel_affine *world, eskel_node *node)
{
	const double weight = (double)moments->sums.weight;
	double covariance[3][3], centre[3];
	esk_moments_scatter(moments, covariance);
	for (int r = 0; r < 3; r++) {
		centre[r] = (double)moments->sums.first[r] / weight;
		for (int c = 0; c < 3; c++)
			covariance[r][c] /= weight;
	}
	esk_affine_apply(world, centre, node->centre);
	esk_affine_congruence(world, (const double(*)[3])covariance, node->covariance);
	for (int r = 0; r < 3; r++)
		if (node->covariance[r][r] < 0)
			node->covariance[r][r] = 0; /* a flat class, but for rounding */
	node->voxels = moments->voxels;
	node->weight = weight;
}

static eskel_status make_skeleton(const eskel_cloud *cloud, const eskel_skeleton_options *options,
	const esk_levels *levels, eskel_skeleton **skeleton)
{
	eskel_skeleton *made = NULL;
	const eskel_affine world = esk_segments_world(cloud);
	eskel_status status = esk_tree_new(levels->count, &made);
	if (status)
		return status;
	made->metric = options->metric;
	made->coarse_start = options->coarse_start;
	made->volume = eskel_cloud_volume(cloud);
	for (uint32_t k = 0; k < levels->count; k++)
		made->levels[k] = levels->about[k];
	for (size_t n = 0; n < ESKEL_NODES(levels->count); n++)
		fill_node(&levels->classes[n], &world, &made->nodes[n]);
	status = esk_tree_derive(made);
	if (status) {
		eskel_skeleton_free(made);
		return status;
	}
	*skeleton = made;
	return ESKEL_OK;
}

eskel_status eskel_skeleton_new(
	const eskel_cloud *cloud, const eskel_skeleton_options *options, eskel_skeleton **skeleton, eskel_error *error)
{
	eskel_skeleton_options chosen = options ? *options : (eskel_skeleton_options){0};
	if (!chosen.levels)
		chosen.levels = ESKEL_LEVELS_DEFAULT;
	if (chosen.levels > ESKEL_LEVELS_MAX)
		return esk_error_set(error, ESKEL_INVALID, "%u levels were asked for, expected 1 to %d", chosen.levels,
			ESKEL_LEVELS_MAX);
	if (chosen.metric != ESKEL_PARTITION_EUCLIDEAN && chosen.metric != ESKEL_PARTITION_MAHALANOBIS)
		return esk_error_set(
			error, ESKEL_INVALID, "the partition metric is %d, expected 0 or 1", (int)chosen.metric);
	esk_levels *levels = esk_memory_array(1, sizeof *levels);
	eskel_status status = levels ? make_levels(cloud, &chosen, levels) : ESKEL_NO_MEMORY;
	if (!status)
		status = make_skeleton(cloud, &chosen, levels, skeleton);
	free(levels);
	if (status)
		return esk_error_set(error, status, "no skeleton was made: %s", eskel_status_text(status));
	return ESKEL_OK;
}
