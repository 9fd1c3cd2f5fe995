/* Progressive dynamic clustering (section 2.4.2): the partitions of levels 1, 2, 3 ... of one cloud. */
#ifndef ESK_LEVELS_H
#define ESK_LEVELS_H

#include "metric.h"
#include "team.h"

typedef struct {
	uint32_t count; /* levels reached: fewer than asked when no class can be split */
	eskel_level about[ESKEL_LEVELS_MAX];
	esk_moments classes[ESKEL_NODES(ESKEL_LEVELS_MAX)]; /* class c of level k at ESKEL_NODES(k - 1) + c */
} esk_levels;

typedef struct {
	const esk_segment *segments;
	size_t segment_count;
	const esk_metric *metric;
	const eskel_affine *root_map; /* space of the first split's major axis */
	const esk_levels *starts;     /* centres that start each level, as far as they go; NULL: splits do */
	uint32_t levels;              /* asked for */
	esk_team *team;
	bool (*progress)(void *context, uint32_t level, uint32_t levels); /* may be NULL */
	void *context;
} esk_levels_input;

eskel_status esk_levels_compute(const esk_levels_input *input, esk_levels *levels);

#endif
