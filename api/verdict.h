/* What the nearest shapes say together: which class, which side, and whether the recorded label agrees. */
#ifndef ESK_VERDICT_H
#define ESK_VERDICT_H

#include "eskel_store.h"

/* How many neighbours have a vote, however many are answered: so that a verdict does not depend on the limit. */
#define ESK_VOTERS 5

typedef struct {
	double distance;                /* from the query, at least 0 */
	const eskel_description *said;  /* of the neighbour */
	eskel_chirality_verdict handed; /* the query's handedness beside the neighbour's */
	double chirality_score;
} esk_vote;

typedef enum { ESK_AGREES_UNKNOWN, ESK_AGREES, ESK_DISAGREES } esk_agreement;

typedef struct {
	const char *class;  /* borrowed from a vote; NULL: cannot be told */
	double class_score; /* 0 to 1; NaN without a class */
	eskel_side side;    /* ESKEL_SIDE_UNKNOWN: cannot be told */
	double side_score;  /* 0 to 1; NaN without a side */
	esk_agreement agrees;
} esk_verdict;

/* Votes are by ascending distance, recorded is what the query itself is said to be.
 *
 * The class is that of the nearest shape that has one (section 5.3). Its score is its share of the votes of all that
 * have one, a vote weighing 1/distance^10: with that power the mean score is about the share of right answers on sets
 * of very different difficulty, .59 for .58 on the AAL atlas (each region beside the other 115, its twin the only right
 * answer), .92 for .93 on the bones of two subjects and a few others. A stored copy decides alone.
 *
 * The side is voted on by the neighbours of that class. One that is left or right votes for its own side where it is of
 * the same handedness as the query, for the other where it is mirrored, and not at all where that is undecided; its
 * certainty is |chirality score| / 0.2, at most 1. The score is |sum of weight, certainty and sign| / sum of weight: 1
 * only when all voters are certain and agree. A class of the midline ("none") is told by the same weights.
 *
 * agrees is unknown unless something is recorded, false when a recorded class or side is another than the verdict's,
 * true when all that is recorded was told and is the same.
 *
 * Scores are shares, not probabilities: they are not calibrated. */
void esk_verdict_of_votes(const esk_vote *votes, size_t count, const eskel_description *recorded, esk_verdict *verdict);

#endif
