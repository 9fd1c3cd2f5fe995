/* What the nearest shapes say together: which class, which side, how sure, and whether the recorded label agrees.
 *
 * Votes become evidence, evidence becomes a verdict by what the library has taught of such evidence (calibration.h). */
#ifndef ESK_VERDICT_H
#define ESK_VERDICT_H

#include "eskel_store.h"

/* How many neighbours have a vote, however many are answered: so that a verdict does not depend on the limit. */
#define ESK_VOTERS 5

typedef struct {
	double distance;               /* from the query, at least 0 */
	const eskel_description *said; /* of the neighbour */
	double chirality_score;        /* of the query beside the neighbour */
} esk_vote;

typedef struct {
	const char *class; /* borrowed from a vote; NULL: no neighbour has one */
	double distance;   /* of the nearest of that class */
	double share;      /* of the votes of those with a class, 0 to 1 */
	double midline;    /* share of the votes of that class that are of the midline, 0 to 1; NaN: none says a side */
	double rightness;  /* -1 (left) to 1 (right); 0: nothing to tell */
} esk_evidence;

/* Votes are by ascending distance.
 *
 * The class is that of the nearest shape that has one (section 5.3). Its share is that of the votes of all that have one,
 * a vote weighing 1/distance^10. A stored copy decides alone.
 *
 * The side is voted on by the neighbours of that class, with the same weights. One that is left or right votes for its own
 * side with its chirality score, for the other where that is negative: rightness is the weighted mean. */
void esk_evidence_of_votes(const esk_vote *votes, size_t count, esk_evidence *evidence);

/* How likely evidence is right, and how far the nearest of the class is for its class (esk_fit_scores). */
typedef struct {
	double class_score; /* probability that the class is right, given that the library has the right one */
	double side_score;  /* probability that the side of the larger rightness is right, 0.5 to 1 */
	double distance_z;  /* standard deviations that ln distance is above the mean of its class; NaN: not known */
} esk_scores;

typedef enum { ESK_AGREES_UNKNOWN, ESK_AGREES, ESK_DISAGREES } esk_agreement;

typedef struct {
	const char *class;         /* borrowed; NULL: unknown */
	const char *nearest_class; /* borrowed; of the nearest that has one, however far it is */
	double class_score;        /* NaN without a nearest class */
	double distance_z;         /* NaN: not known */
	eskel_side side;           /* ESKEL_SIDE_UNKNOWN: undecided */
	double side_score;         /* NaN without a side */
	esk_agreement agrees;
} esk_verdict;

/* A class is unknown when the nearest shape is farther away than ESK_FARTHEST standard deviations above what is usual in
 * its class. A side is undecided when its probability is below ESK_LEAST_SIDE_SCORE.
 *
 * agrees is unknown unless something is recorded, false when a recorded class or side is another than the verdict's,
 * true when all that is recorded was told and is the same. */
#define ESK_FARTHEST 3.0
#define ESK_LEAST_SIDE_SCORE 0.9
void esk_verdict_of_evidence(const esk_evidence *evidence, const esk_scores *scores, const eskel_description *recorded,
	esk_verdict *verdict);

#endif
