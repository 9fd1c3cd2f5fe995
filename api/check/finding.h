/* What is wrong with the labels of a map: findings from plain numbers, told in sentences.
 *
 * Nothing here asks a library: what a label says, what its shape says and how it is made come as a struct a label. A finding
 * has a code that programs may rely on, and a severity: an error contradicts the label, a warning is something that a
 * person should look at, a note explains and condemns nothing. */
#ifndef ESK_FINDING_H
#define ESK_FINDING_H

#include "eskel_store.h"

#define ESK_FINDINGS(X) \
	X(ESK_FINDING_WRONG_CLASS, "wrong_class") \
	X(ESK_FINDING_SWAPPED_SIDE, "swapped_side") \
	X(ESK_FINDING_SWAPPED_LABELS, "swapped_labels") \
	X(ESK_FINDING_UNRECOGNIZED, "unrecognized") \
	X(ESK_FINDING_MERGED, "merged") \
	X(ESK_FINDING_FRAGMENTED, "fragmented") \
	X(ESK_FINDING_IMPLAUSIBLE_VOLUME, "implausible_volume") \
	X(ESK_FINDING_TOUCHES_BORDER, "touches_border") \
	X(ESK_FINDING_HOLES, "holes") \
	X(ESK_FINDING_FEW_VOXELS, "few_voxels") \
	X(ESK_FINDING_UNKNOWN_CLASS, "unknown_class")

#define ESK_FINDING_CODE(code, name) code,
typedef enum { ESK_FINDINGS(ESK_FINDING_CODE) ESK_FINDING_COUNT } esk_finding_code;
#undef ESK_FINDING_CODE

typedef enum { ESK_SEVERITY_NOTE, ESK_SEVERITY_WARNING, ESK_SEVERITY_ERROR, ESK_SEVERITY_COUNT } esk_severity;

typedef struct {
	esk_finding_code code;
	esk_severity severity;
	int32_t partner; /* the other label of swapped_labels; 0: none */
	char text[640];
} esk_finding;

/* Each code at most once, in the order of the codes. */
typedef struct {
	size_t count;
	esk_finding items[ESK_FINDING_COUNT];
} esk_findings;

/* One label. Distances and z are NaN where they cannot be told. */
typedef struct {
	int32_t label;

	/* what the label says */
	const char *said_class; /* NULL: nothing */
	eskel_side said_side;
	bool class_is_known;      /* the library has shapes of the class said */
	eskel_side side_in_class; /* what the nearest of them say of the side */
	double side_in_class_score;
	double said_distance; /* to the nearest of them */
	const double
		*class_distances; /* to the nearest of each class that the labels say and the library has; or NULL */
	size_t class_number;      /* of the class said among these; means nothing where it is not known */
	double z; /* of that distance in its class; of told_distance in the class told where said_distance is NaN */

	/* what the shape says */
	const char *told_class; /* of the nearest shape that has one; NULL: none has */
	bool is_unknown;        /* that is too far away to be believed (verdict.h) */
	eskel_side told_side;
	double class_score, side_score, told_distance;

	/* volumes of the class said, in the library: of ln mm^3 */
	size_t volume_count;
	double volume_mean, volume_deviation;

	/* how it is made */
	uint64_t voxels;
	double volume; /* mm^3 */
	unsigned border;
	size_t component_count;
	uint64_t largest, second; /* voxels of components; second is 0 when there is one */
	size_t cavity_count;
	uint64_t cavity_voxels;
} esk_checked_label;

/* findings[i] of labels[i]. Labels are looked at together: two may be exchanged, and all bones of a small person are small. */
void esk_findings_of_map(const esk_checked_label *labels, size_t count, esk_findings *findings);

/* How many deviations ln volume is from the mean of its class; NaN for fewer than 3 of the class. */
double esk_finding_volume_z(const esk_checked_label *label);

const char *esk_finding_name(esk_finding_code code);
const char *esk_severity_name(esk_severity severity);

#endif
