/* The check of a label map: every label of it beside the library, and what is wrong with them together. */
#ifndef ESK_CHECK_H
#define ESK_CHECK_H

#include "class_statistics.h"
#include "finding.h"
#include "recognition.h"
#include "specimen.h"

typedef struct {
	const esk_specimen *specimen;
	eskel_placement *placement;
	esk_recognition recognition;
	size_t class_index; /* of the library's class that is said; SIZE_MAX: it has none */
} esk_check_row;

typedef struct {
	size_t count; /* labels */
	esk_check_row *rows;
	esk_checked_label *labels;
	esk_findings *findings;
	double *distances; /* a row a label, a column a class that is said and known */
} esk_check;

/* The body of the answer (check_json.c), with the warnings of the volume. */
json_t *esk_check_json(const esk_check *check, const esk_specimens *specimens);

#endif
