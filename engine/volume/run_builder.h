/* Voxels in file order, turned into runs per label. */
#ifndef ESK_RUN_BUILDER_H
#define ESK_RUN_BUILDER_H

#include "voxel.h"

typedef struct {
	int32_t label;
	eskel_run *runs; /* sorted, disjoint and maximal where voxels came in file order */
	size_t count, capacity;
} esk_label_runs;

typedef struct {
	esk_label_runs *items; /* ascending labels */
	size_t count, capacity;
} esk_label_table;

/* NULL when the table has no such label. */
const esk_label_runs *esk_label_table_find(const esk_label_table *table, int32_t label);

typedef struct {
	size_t most_runs;
	uint32_t most_labels;
} esk_run_limits;

typedef struct esk_run_builder esk_run_builder;

/* labels: keep these only, all non-zero; none: keep every label. */
eskel_status esk_run_builder_new(
	const esk_run_limits *limits, const int32_t *labels, size_t label_count, esk_run_builder **builder);
/* A part of whole's limit of runs, for these labels. */
eskel_status esk_run_builder_new_share(const esk_run_builder *whole, size_t parts, const int32_t *labels,
	size_t label_count, esk_run_builder **builder);
void esk_run_builder_free(esk_run_builder *builder);

/* Before the first voxel. */
void esk_run_builder_set_grid(esk_run_builder *builder, const esk_voxel_format *format, const uint32_t extent[3]);

/* The next count voxels; never more in all than the grid has. */
eskel_status esk_run_builder_add(esk_run_builder *builder, const uint8_t *voxels, size_t count, eskel_error *error);

/* In place of voxels: the next run of a label, by (z, y, x_first). */
eskel_status esk_run_builder_add_run(esk_run_builder *builder, int32_t label, eskel_run run, eskel_error *error);

/* Whether the builder keeps voxels of this label. */
bool esk_run_builder_wants(const esk_run_builder *builder, int32_t label);
/* How many voxels came before the one that the last add failed at, or that comes next. */
uint64_t esk_run_builder_place(const esk_run_builder *builder);

/* The labels that have runs. Owned by the builder. */
const esk_label_table *esk_run_builder_finish(esk_run_builder *builder);

#endif
