/* The vote of the nearest shapes, see verdict.h. */
#include "verdict.h"

#include <math.h>
#include <string.h>

/* Copies of a shape are at distance 0, or at what the rounding to 32-bit floats leaves of it. */
#define LEAST_DISTANCE 1e-6

static double weight_of(const esk_vote *vote)
{
	return pow(fmax(vote->distance, LEAST_DISTANCE), -10);
}

static bool is_of_class(const esk_vote *vote, const char *class)
{
	return vote->said->class && strcmp(vote->said->class, class) == 0;
}

static void vote_on_class(const esk_vote *votes, size_t count, esk_evidence *evidence)
{
	double all = 0, agreed = 0;
	for (size_t i = 0; i < count; i++) {
		if (!votes[i].said->class)
			continue;
		if (!evidence->class) {
			evidence->class = votes[i].said->class;
			evidence->distance = votes[i].distance;
		}
		all += weight_of(&votes[i]);
		if (is_of_class(&votes[i], evidence->class))
			agreed += weight_of(&votes[i]);
	}
	if (evidence->class)
		evidence->share = agreed / all;
}

static void vote_on_side(const esk_vote *votes, size_t count, esk_evidence *evidence)
{
	double sided = 0, right = 0, midline = 0;
	for (size_t i = 0; i < count; i++) {
		const eskel_side side = votes[i].said->side;
		if (!is_of_class(&votes[i], evidence->class) || side == ESKEL_SIDE_UNKNOWN)
			continue;
		if (side == ESKEL_SIDE_NONE) {
			midline += weight_of(&votes[i]);
		} else {
			sided += weight_of(&votes[i]);
			right += weight_of(&votes[i]) * votes[i].chirality_score * (side == ESKEL_SIDE_RIGHT ? 1 : -1);
		}
	}
	if (midline + sided > 0)
		evidence->midline = midline / (midline + sided);
	if (sided > 0)
		evidence->rightness = right / sided;
}

void esk_evidence_of_votes(const esk_vote *votes, size_t count, esk_evidence *evidence)
{
	*evidence = (esk_evidence){.distance = NAN, .midline = NAN};
	vote_on_class(votes, count, evidence);
	if (evidence->class)
		vote_on_side(votes, count, evidence);
}

static void judge_side(const esk_evidence *evidence, const esk_scores *scores, esk_verdict *verdict)
{
	if (evidence->midline > 0.5) {
		verdict->side = ESKEL_SIDE_NONE;
		verdict->side_score = evidence->midline;
	} else if (evidence->rightness != 0 && scores->side_score >= ESK_LEAST_SIDE_SCORE) {
		verdict->side = evidence->rightness > 0 ? ESKEL_SIDE_RIGHT : ESKEL_SIDE_LEFT;
		verdict->side_score = scores->side_score;
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

void esk_verdict_of_evidence(
	const esk_evidence *evidence, const esk_scores *scores, const eskel_description *recorded, esk_verdict *verdict)
{
	*verdict = (esk_verdict){
		.nearest_class = evidence->class, .class_score = NAN, .distance_z = NAN, .side_score = NAN};
	if (evidence->class) {
		verdict->class_score = scores->class_score;
		verdict->distance_z = scores->distance_z;
	}
	if (evidence->class && !(scores->distance_z > ESK_FARTHEST)) {
		verdict->class = evidence->class;
		judge_side(evidence, scores, verdict);
	}
	verdict->agrees = compare(verdict, recorded);
}
