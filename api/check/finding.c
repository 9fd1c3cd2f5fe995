/* Findings, see finding.h: a function a finding, and one list of thresholds, tried on the feet of two people, on twelve
 * hippocampi and on the AAL atlas. */
#include "finding.h"

#include "label_name.h"
#include "value.h"
#include "verdict.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Probabilities that contradict a label: one that a person should look at, one that hardly errs. Most labels are right, so
 * an even chance is not enough. */
#define DOUBTFUL_SCORE 0.8
#define CERTAIN_SCORE 0.95
#define DOUBTFUL_SIDE_SCORE 0.9
#define CERTAIN_SIDE_SCORE 0.98

/* A shape that is hardly farther from its own class than from another may well be of its own: metatarsals 2 to 4 and small
 * cuneiforms differ less among themselves than between people. */
#define NOTABLE_MARGIN 1.15

/* Of ln distance, the two shapes of an exchange together. Of the 1,431 pairs of left regions of the AAL atlas, named rightly
 * beside the right ones, none reaches it; exchanged, 91 of 100 do, and all pairs of unlike bones of two people's feet. */
#define NOTABLE_GAIN 0.4
/* Copies are at distance 0. */
#define LEAST_PRODUCT 1e-12

/* Deviations from the mean of its class. Ln distance is skewed to the far side; volumes of adults are not. */
#define USUAL_Z 1.5
#define IMPLAUSIBLE_Z ESK_FARTHEST
#define FAR_Z 2
#define IMPLAUSIBLE_VOLUME_Z 3

/* A class of few shapes, or of one person, looks more alike than it is: bones of a man and a woman differ by ln 1.3 or so. */
#define LEAST_VOLUME_DEVIATION 0.25
/* Of the nearest in volume, in a class of one or two. */
#define IMPLAUSIBLE_RATIO 2.5

/* What two neighbours under one label are at least: a third larger than the class, or two pieces of a similar size. */
#define MERGED_RATIO 1.35
#define SIMILAR_SIZE 0.2

/* Specks that a cleaning would remove change nothing. */
#define WHOLE_SHARE 0.98
#define NOTABLE_CAVITY 0.01
#define FEW_VOXELS 1000
#define TOO_FEW_VOXELS 100

static esk_finding *add(esk_findings *findings, esk_finding_code code, esk_severity severity, const char *format, ...)
	__attribute__((format(printf, 4, 5)));

static esk_finding *add(esk_findings *findings, esk_finding_code code, esk_severity severity, const char *format, ...)
{
	esk_finding *finding = &findings->items[findings->count++];
	*finding = (esk_finding){.code = code, .severity = severity};
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(finding->text, sizeof finding->text, format, arguments);
	va_end(arguments);
	return finding;
}

/* ---- class and side */

static bool differs_in_class(const esk_checked_label *label)
{
	return label->said_class && label->told_class && !label->is_unknown &&
	       !esk_label_same_class(label->said_class, label->told_class);
}

/* Of a class that the library has not, a shape is contradicted only by one that it is as like as can be. */
static bool contradicts_class(const esk_checked_label *label)
{
	if (!differs_in_class(label))
		return false;
	if (!label->class_is_known)
		return label->class_score >= CERTAIN_SCORE && label->z < USUAL_Z;
	return label->class_score >= DOUBTFUL_SCORE && !(label->said_distance < NOTABLE_MARGIN * label->told_distance);
}

static bool is_sided(eskel_side side)
{
	return side == ESKEL_SIDE_LEFT || side == ESKEL_SIDE_RIGHT;
}

/* Told by the class said: the shape may be nearer to another, but not so much that the name is wrong. What is unlike its
 * class, as two bones in one are, has no side that can be told by it. */
static bool contradicts_side(const esk_checked_label *label)
{
	return label->class_is_known && is_sided(label->said_side) && is_sided(label->side_in_class) &&
	       label->said_side != label->side_in_class && label->side_in_class_score >= DOUBTFUL_SIDE_SCORE &&
	       !(label->z > FAR_Z) && !contradicts_class(label);
}

/* How much nearer, in ln distance, two shapes are to each other's class than to their own. */
static double gain_of_exchange(const esk_checked_label *a, const esk_checked_label *b)
{
	if (!a->class_distances || !b->class_distances || !a->class_is_known || !b->class_is_known ||
		a->class_number == b->class_number)
		return -INFINITY;
	const double own = a->class_distances[a->class_number] * b->class_distances[b->class_number];
	const double other = a->class_distances[b->class_number] * b->class_distances[a->class_number];
	if (isnan(own) || isnan(other))
		return -INFINITY;
	return log(fmax(own, LEAST_PRODUCT)) - log(fmax(other, LEAST_PRODUCT));
}

/* The label with which an exchange gains most, enough to be believed; NULL without. */
static const esk_checked_label *best_exchange(
	const esk_checked_label *labels, size_t count, const esk_checked_label *label)
{
	const esk_checked_label *best = NULL;
	double most = NOTABLE_GAIN;
	for (size_t i = 0; i < count; i++) {
		double gain = gain_of_exchange(label, &labels[i]);
		if (gain > most) {
			most = gain;
			best = &labels[i];
		}
	}
	return best;
}

/* Of one class, and each of the other's side. */
static bool have_exchanged_sides(const esk_checked_label *a, const esk_checked_label *b)
{
	return contradicts_side(a) && contradicts_side(b) && esk_label_same_class(a->said_class, b->said_class) &&
	       a->said_side != b->said_side;
}

static const esk_checked_label *partner_of(
	const esk_checked_label *labels, size_t count, const esk_checked_label *label)
{
	const esk_checked_label *best = best_exchange(labels, count, label);
	if (best && best_exchange(labels, count, best) == label)
		return best;
	for (size_t i = 0; contradicts_side(label) && i < count; i++)
		if (have_exchanged_sides(label, &labels[i]))
			return &labels[i];
	return NULL;
}

static void find_exchange(const esk_checked_label *label, const esk_checked_label *partner, esk_findings *findings)
{
	esk_finding *finding;
	if (have_exchanged_sides(label, partner))
		finding = add(findings, ESK_FINDING_SWAPPED_LABELS, ESK_SEVERITY_ERROR,
			"the shape says %s, that of label %" PRId32 " says %s: the two names are exchanged",
			esk_value_side_text(label->told_side), partner->label, esk_value_side_text(partner->told_side));
	else
		finding = add(findings, ESK_FINDING_SWAPPED_LABELS, ESK_SEVERITY_ERROR,
			"%s and %s (label %" PRId32
			") are exchanged: the two shapes are at distances %.3f and %.3f from "
			"what each other's label says, at %.3f and %.3f from what their own says",
			label->said_class, partner->said_class, partner->label,
			label->class_distances[partner->class_number], partner->class_distances[label->class_number],
			label->class_distances[label->class_number], partner->class_distances[partner->class_number]);
	finding->partner = partner->label;
}

/* What is cut off may look like something else. */
static esk_severity severity_of(const esk_checked_label *label, bool certain)
{
	return certain && !label->border ? ESK_SEVERITY_ERROR : ESK_SEVERITY_WARNING;
}

/* No calibration shows more. */
static double shown(double score)
{
	return fmin(score, 0.99);
}

static void find_wrong_class(const esk_checked_label *label, esk_findings *findings)
{
	if (label->class_is_known)
		add(findings, ESK_FINDING_WRONG_CLASS, severity_of(label, label->class_score >= CERTAIN_SCORE),
			"the label says %s, the shape says %s (score %.2f): the nearest of that is at distance %.3f, "
			"of "
			"the class said at %.3f",
			label->said_class, label->told_class, shown(label->class_score), label->told_distance,
			label->said_distance);
	else
		add(findings, ESK_FINDING_WRONG_CLASS, ESK_SEVERITY_WARNING,
			"the label says %s, of which the library has none, the shape says %s (score %.2f): at distance "
			"%.3f it is as near as those of that class are to each other (z %.1f)",
			label->said_class, label->told_class, shown(label->class_score), label->told_distance,
			label->z);
}

static void find_wrong_side(const esk_checked_label *label, esk_findings *findings)
{
	add(findings, ESK_FINDING_SWAPPED_SIDE, severity_of(label, label->side_in_class_score >= CERTAIN_SIDE_SCORE),
		"the label says %s, the shape says %s (score %.2f)", esk_value_side_text(label->said_side),
		esk_value_side_text(label->side_in_class), shown(label->side_in_class_score));
}

static void find_wrong_name(const esk_checked_label *label, esk_findings *findings)
{
	if (contradicts_class(label))
		find_wrong_class(label, findings);
	else if (contradicts_side(label))
		find_wrong_side(label, findings);
}

/* From the class that it is said to be of, or where that is not known from all that it could be. */
static bool is_far(const esk_checked_label *label)
{
	return label->class_is_known ? label->z > IMPLAUSIBLE_Z : label->is_unknown;
}

/* A class that the library has not is unlike all that it has; that is no finding. */
static void find_unrecognized(const esk_checked_label *label, esk_findings *findings)
{
	if (!label->told_class)
		add(findings, ESK_FINDING_UNRECOGNIZED, ESK_SEVERITY_WARNING,
			"no shape of the library says what this is");
	else if (is_far(label) && !contradicts_class(label) && (label->class_is_known || !label->said_class))
		add(findings, ESK_FINDING_UNRECOGNIZED, ESK_SEVERITY_WARNING,
			"the shape is unlike every %s: the nearest is at distance %.3f, %.1f deviations beyond what is "
			"usual "
			"in its class",
			label->class_is_known ? label->said_class : label->told_class,
			label->class_is_known ? label->said_distance : label->told_distance, label->z);
}

static void find_unknown_class(const esk_checked_label *label, esk_findings *findings)
{
	if (label->said_class && !label->class_is_known)
		add(findings, ESK_FINDING_UNKNOWN_CLASS, ESK_SEVERITY_NOTE,
			"the library has no %s: the name cannot be checked", label->said_class);
}

/* ---- volume and pieces */

static double deviation_of_volume(const esk_checked_label *label)
{
	return fmax(label->volume_deviation, LEAST_VOLUME_DEVIATION);
}

double esk_finding_volume_z(const esk_checked_label *label)
{
	if (label->volume_count < 3)
		return NAN;
	return (log(label->volume) - label->volume_mean) / deviation_of_volume(label);
}

/* Ln of the volume over that of its class; NaN without one. */
static double excess_of(const esk_checked_label *label)
{
	return label->volume_count > 0 ? log(label->volume) - label->volume_mean : NAN;
}

/* The median of the excesses: how much larger the person is than those of the library. 0 unless three labels tell. */
static double excess_of_map(const esk_checked_label *labels, size_t count)
{
	size_t known = 0;
	for (size_t i = 0; i < count; i++)
		known += labels[i].volume_count > 0;
	for (size_t i = 0; known >= 3 && i < count; i++) {
		size_t below = 0, equal = 0;
		for (size_t j = 0; j < count; j++) {
			below += excess_of(&labels[j]) < excess_of(&labels[i]);
			equal += excess_of(&labels[j]) == excess_of(&labels[i]);
		}
		if (below <= known / 2 && known / 2 < below + equal)
			return excess_of(&labels[i]);
	}
	return 0;
}

static bool has_similar_pieces(const esk_checked_label *label)
{
	return (double)label->second >= SIMILAR_SIZE * (double)label->largest;
}

static bool looks_merged(const esk_checked_label *label, double excess_of_others)
{
	return excess_of(label) - excess_of_others > log(MERGED_RATIO) &&
	       (has_similar_pieces(label) || label->z > FAR_Z || contradicts_class(label));
}

static void find_merged(const esk_checked_label *label, double excess_of_others, esk_findings *findings)
{
	double ratio = exp(excess_of(label) - excess_of_others);
	if (has_similar_pieces(label))
		add(findings, ESK_FINDING_MERGED, ESK_SEVERITY_WARNING,
			"%.1f times as large as a %s beside the rest of the map, in %zu components, the largest of "
			"%" PRIu64 " and %" PRIu64 " voxels: perhaps two neighbours",
			ratio, label->said_class, label->component_count, label->largest, label->second);
	else
		add(findings, ESK_FINDING_MERGED, ESK_SEVERITY_WARNING,
			"%.1f times as large as a %s beside the rest of the map, and of another shape: perhaps grown "
			"into a "
			"neighbour",
			ratio, label->said_class);
}

static void find_pieces(const esk_checked_label *label, double excess_of_others, esk_findings *findings)
{
	double share = (double)label->largest / (double)label->voxels;
	if (looks_merged(label, excess_of_others))
		find_merged(label, excess_of_others, findings);
	else if (label->component_count > 1)
		add(findings, ESK_FINDING_FRAGMENTED, share < WHOLE_SHARE ? ESK_SEVERITY_WARNING : ESK_SEVERITY_NOTE,
			"in %zu components, the largest has %.2f %% of the voxels", label->component_count,
			100 * share);
}

static void find_volume(const esk_checked_label *label, esk_findings *findings)
{
	double z = esk_finding_volume_z(label);
	if (fabs(z) > IMPLAUSIBLE_VOLUME_Z)
		add(findings, ESK_FINDING_IMPLAUSIBLE_VOLUME, ESK_SEVERITY_WARNING,
			"%.0f mm³, where %zu of its class have %.0f (z %.1f)", label->volume, label->volume_count,
			exp(label->volume_mean), z);
	if (label->volume_count == 0 || label->volume_count >= 3)
		return;
	/* One or two numbers lie at mean - deviation and mean + deviation. */
	double excess = excess_of(label), nearest = excess > 0 ? label->volume_deviation : -label->volume_deviation;
	if (fabs(excess - nearest) > log(IMPLAUSIBLE_RATIO))
		add(findings, ESK_FINDING_IMPLAUSIBLE_VOLUME, ESK_SEVERITY_WARNING,
			"%.0f mm³, %.2f times the nearest of its class, %.0f", label->volume, exp(excess - nearest),
			exp(label->volume_mean + nearest));
}

/* ---- the grid */

static void find_border(const esk_checked_label *label, esk_findings *findings)
{
	static const char *const sides[] = {
		"first low", "first high", "second low", "second high", "third low", "third high"};
	char text[100] = "";
	for (unsigned side = 0, used = 0; side < 6; side++)
		if (label->border >> side & 1)
			used += (unsigned)snprintf(
				text + used, sizeof text - used, "%s%s", used ? ", " : "", sides[side]);
	if (label->border)
		add(findings, ESK_FINDING_TOUCHES_BORDER, ESK_SEVERITY_WARNING,
			"touches the border of the grid (%s index): it may be cut off", text);
}

static void find_holes(const esk_checked_label *label, esk_findings *findings)
{
	double share = (double)label->cavity_voxels / (double)label->voxels;
	if (label->cavity_count > 0)
		add(findings, ESK_FINDING_HOLES, share >= NOTABLE_CAVITY ? ESK_SEVERITY_WARNING : ESK_SEVERITY_NOTE,
			"%zu cavit%s of %" PRIu64 " voxels together, %.2f %% of the object", label->cavity_count,
			label->cavity_count == 1 ? "y" : "ies", label->cavity_voxels, 100 * share);
}

static void find_few_voxels(const esk_checked_label *label, esk_findings *findings)
{
	if (label->voxels < FEW_VOXELS)
		add(findings, ESK_FINDING_FEW_VOXELS,
			label->voxels < TOO_FEW_VOXELS ? ESK_SEVERITY_WARNING : ESK_SEVERITY_NOTE,
			"%" PRIu64 " voxels, fewer than %d: the shape follows the grid", label->voxels, FEW_VOXELS);
}

/* excess_of_others: how much larger than the library the map is. */
static void find_all(const esk_checked_label *label, double excess_of_others, esk_findings *findings)
{
	find_unrecognized(label, findings);
	find_pieces(label, excess_of_others, findings);
	find_volume(label, findings);
	find_border(label, findings);
	find_holes(label, findings);
	find_few_voxels(label, findings);
	find_unknown_class(label, findings);
}

void esk_findings_of_map(const esk_checked_label *labels, size_t count, esk_findings *findings)
{
	const double excess = excess_of_map(labels, count);
	for (size_t i = 0; i < count; i++) {
		esk_checked_label label = labels[i];
		const esk_checked_label *partner = partner_of(labels, count, &labels[i]);
		findings[i].count = 0;
		if (partner) {
			find_exchange(&label, partner, &findings[i]);
			/* The class is another's, so neither distance nor volume are to be held against it. */
			label.z = NAN;
			label.volume_count = 0;
		} else {
			find_wrong_name(&label, &findings[i]);
		}
		find_all(&label, excess, &findings[i]);
	}
}

const char *esk_finding_name(esk_finding_code code)
{
#define ESK_FINDING_NAME(code, name) [code] = name,
	static const char *const names[] = {ESK_FINDINGS(ESK_FINDING_NAME)};
#undef ESK_FINDING_NAME
	return names[code];
}

const char *esk_severity_name(esk_severity severity)
{
	static const char *const names[] = {"note", "warning", "error"};
	return names[severity];
}
