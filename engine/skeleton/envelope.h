/* The lower envelope of the classes' scores along segments, eight at a time: the inner loop of clustering, in vectors. */
#ifndef ESK_ENVELOPE_H
#define ESK_ENVELOPE_H

#include "pack.h"
#include "scores.h"

/* The scores by rank: the order in which classes follow each other along x, which is that of falling slopes. */
typedef struct {
	uint32_t count;
	uint8_t class_index[ESKEL_LEVELS_MAX], rank[ESKEL_LEVELS_MAX];
	uint8_t successor[ESKEL_LEVELS_MAX]; /* the rank now of the class that had this rank before */
	double constant[ESKEL_LEVELS_MAX], slope[3][ESKEL_LEVELS_MAX];
	/* of ranks a < b: by how much the lead of a over b changes from a voxel to the next, and the inverse of its fall */
	double change[ESKEL_LEVELS_MAX][ESKEL_LEVELS_MAX], inverse[ESKEL_LEVELS_MAX][ESKEL_LEVELS_MAX];
} esk_envelope;

/* The voxels of each segment that a class wins, from first up to end, counted from the segment's first one. None when end
 * is not above first. */
typedef struct {
	double first[ESK_PACK], end[ESK_PACK];
} esk_stretch;

/* The sums of every rank, summed up lane by lane. */
typedef struct {
	double weight[ESKEL_LEVELS_MAX][ESK_PACK], first[ESKEL_LEVELS_MAX][3][ESK_PACK];
} esk_tally;

/* Writes the scores by rank. False when the ranks are other classes than before. */
bool esk_envelope_set(esk_envelope *envelope, const esk_scores *scores);

/* The ranks now of the classes that had these ranks before the last set, which had as many classes. */
uint64_t esk_envelope_follow(const esk_envelope *envelope, uint64_t ranks);

/* The ranks that may win somewhere in a box, or come within the margin of winning: all, as far as a comparison with the
 * winner at its centre tells. *least_lead is lowered to the least that the winner leads one of the others by. Centre and
 * half are multiples of 1/2. */
uint64_t esk_envelope_candidates(const esk_envelope *envelope, const esk_box *box, double margin, double *least_lead);

/* The stretch of every candidate, a bit a rank, in the order of ranks. Other classes must not win anywhere. */
void esk_envelope_divide(const esk_envelope *envelope, const esk_pack *pack, uint64_t candidates,
	esk_stretch stretches[ESKEL_LEVELS_MAX]);

/* Adds the candidates' sums in packs[count] that have two candidates or more. Exact while the sum of w |u_r| over all that
 * was added stays below 2^53. */
void esk_envelope_tally(const esk_envelope *envelope, const esk_pack *packs, const uint64_t *candidates, size_t count,
	esk_tally *tally);

#endif
