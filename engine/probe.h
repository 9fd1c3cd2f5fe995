/* Which class wins at both ends of many pieces, and by how much: the inner loop of clustering, in vectors. */
#ifndef ESK_PROBE_H
#define ESK_PROBE_H

#include "scores.h"

enum { ESK_PROBES = 256, ESK_PROBE_LANES = 8, ESK_PROBE_ROOM = ESK_PROBES + ESK_PROBE_LANES };

typedef struct {
	int32_t x_first[ESK_PROBE_ROOM];
	int32_t x_last[ESK_PROBE_ROOM];
	int32_t y[ESK_PROBE_ROOM];
	int32_t z[ESK_PROBE_ROOM];
	int32_t expected[ESK_PROBE_ROOM]; /* the class that should win at both ends */
	int32_t winner_first[ESK_PROBE_ROOM];
	int32_t winner_last[ESK_PROBE_ROOM];
	double slack[ESK_PROBE_ROOM]; /* the lesser lead over the second best class; -1 if expected is wrong */
} esk_probes;

/* Fills in winners and slacks of the first count entries, at most ESK_PROBES. Reads, and writes, on to the next
 * multiple of ESK_PROBE_LANES. */
void esk_probes_run(esk_probes *probes, size_t count, const esk_scores *scores);

#endif
