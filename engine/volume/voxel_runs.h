/* The voxels of a file, turned into runs per label: by a run builder; by one for each layer where segments overlap; or by a
 * weight builder where voxels say how much of an object they hold. */
#ifndef ESK_VOXEL_RUNS_H
#define ESK_VOXEL_RUNS_H

#include "volume_format.h"

typedef struct esk_voxel_runs esk_voxel_runs;

/* labels: as for a run builder; of no meaning with weights. */
eskel_status esk_voxel_runs_new(
	const esk_run_limits *limits, const int32_t *labels, size_t label_count, bool weights, esk_voxel_runs **runs);
void esk_voxel_runs_free(esk_voxel_runs *runs);

/* Before the first voxel. The header must outlive the runs. ESKEL_UNSUPPORTED for weights in layers. */
eskel_status esk_voxel_runs_begin(esk_voxel_runs *runs, const esk_volume_header *header, eskel_error *error);

/* The next bytes of voxels, cut anywhere; never more in all than the grid has. */
eskel_status esk_voxel_runs_add(esk_voxel_runs *runs, const uint8_t *bytes, size_t size, eskel_error *error);

/* What takes runs in place of voxels; NULL where voxels are weights. */
esk_run_builder *esk_voxel_runs_builder(esk_voxel_runs *runs);

/* The labels that have runs, at least one, or ESKEL_EMPTY. Owned by the runs. */
eskel_status esk_voxel_runs_finish(esk_voxel_runs *runs, const esk_label_table **table, eskel_error *error);

/* One a run, once finished; NULL where voxels are labels. */
const uint32_t *esk_voxel_runs_weights(const esk_voxel_runs *runs);

#endif
