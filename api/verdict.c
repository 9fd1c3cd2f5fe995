/* The vote of the nearest shapes, see verdict.h. */
#include "verdict.h"

#include <math.h>
#include <string.h>

/* Copies of a shape are at distance 0, or at what the rounding to 32-bit floats leaves of it. */
#define LEAST_DISTANCE 1e-6

/* A chirality of this score was never wrong on the bones and atlases that it was measured on. */
#define CERTAIN_SCORE 0.2

static double weight_of(const esk_vote *vote)
{
	double distance = fmax(vote->distance, LEAST_DISTANCE);
	return pow(distance, -10);
}

static bool is_of_class(const esk_vote *vote, const char *class)
{
	return vote->said->class && strcmp(vote->said->class, class) == 0;
}

static double weight_of_class(const esk_vote *votes, size_t count, const char *class)
{
	double weight = 0;
	for (size_t i = 0; i < count; i++)
		if (is_of_class(&votes[i], class))
			weight += weight_of(&votes[i]);
	return weight;
}

static void vote_on_class(const esk_vote *votes, size_t count, esk_verdict *verdict)
{
	double all = 0;
	for (size_t i = 0; i < count; i++) {
		if (!votes[i].said->class)
			continue;
		if (!verdict->class)
			verdict->class = votes[i].said->class;
		all += weight_of(&votes[i]);
	}
	if (verdict->class)
		verdict->class_score = weight_of_class(votes, count, verdict->class) / all;
}

/* -1 to 1: how surely the query is a right one, by a neighbour that is left or right. */
static double rightness(const esk_vote *vote)
{
	double sign = vote->said->side == ESKEL_SIDE_RIGHT ? 1 : -1;
	if (vote->handed == ESKEL_CHIRALITY_MIRRORED)
		sign = -sign;
	return sign * fmin(fabs(vote->chirality_score) / CERTAIN_SCORE, 1);
}

static void vote_on_side(const esk_vote *votes, size_t count, esk_verdict *verdict)
{
	double sided = 0, right = 0, midline = 0;
	for (size_t i = 0; i < count; i++) {
		const esk_vote *vote = &votes[i];
		eskel_side side = vote->said->side;
		if (!is_of_class(vote, verdict->class) || side == ESKEL_SIDE_UNKNOWN)
			continue;
		if (side == ESKEL_SIDE_NONE) {
			midline += weight_of(vote);
		} else if (vote->handed != ESKEL_CHIRALITY_UNDECIDED) {
			sided += weight_of(vote);
			right += weight_of(vote) * rightness(vote);
		}
	}
	if (midline > sided) {
		verdict->side = ESKEL_SIDE_NONE;
		verdict->side_score = midline / (midline + sided);
	} else if (right != 0) {
		verdict->side = right > 0 ? ESKEL_SIDE_RIGHT : ESKEL_SIDE_LEFT;
		verdict->side_score = fabs(right) / (midline + sided);
	}
}

static esk_agreement compare(const esk_verdict *verdict, const eskel_description *recorded)
{
	bool has_class = recorded->class, has_side = recorded->side != ESKEL_SIDE_UNKNOWN;
	bool tells_class = verdict->class, tells_side = verdict->side != ESKEL_SIDE_UNKNOWN;
	if (has_class && tells_class && strcmp(recorded->class, verdict->class) != 0)
		return ESK_DISAGREES;
	if (has_side && tells_side && recorded->side != verdict->side)
		return ESK_DISAGREES;
	if ((!has_class && !has_side) || (has_class && !tells_class) || (has_side && !tells_side))
		return ESK_AGREES_UNKNOWN;
	return ESK_AGREES;
}

void esk_verdict_of_votes(const esk_vote *votes, size_t count, const eskel_description *recorded, esk_verdict *verdict)
{
	*verdict = (esk_verdict){.class_score = NAN, .side_score = NAN};
	vote_on_class(votes, count, verdict);
	if (verdict->class)
		vote_on_side(votes, count, verdict);
	verdict->agrees = compare(verdict, recorded);
}
