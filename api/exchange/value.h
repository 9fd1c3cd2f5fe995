/* Strict values as text: each is taken whole or refused (400) with its name, what was given and what is expected. */
#ifndef ESK_VALUE_H
#define ESK_VALUE_H

#include "problem.h"

#define ESK_TEXT_MOST 200         /* bytes of a name, class, subject, attribute value */
#define ESK_ATTRIBUTE_KEY_MOST 64 /* bytes */
#define ESK_ATTRIBUTES_MOST 64    /* of one shape */
#define ESK_YEARS_MOST 150

/* 1 to most bytes of plain UTF-8 (text.h). */
bool esk_value_text(const char *name, const char *value, size_t most, esk_problem *problem);

/* A text with a word in it, normalised (label_name.h). */
bool esk_value_class(const char *name, const char *value, char class[ESK_TEXT_MOST + 1], esk_problem *problem);

/* Decimal digits with an optional leading minus, least to most. */
bool esk_value_integer(
	const char *name, const char *value, int64_t least, int64_t most, int64_t *number, esk_problem *problem);

/* 0 to ESK_YEARS_MOST, digits with an optional fraction. */
bool esk_value_years(const char *name, const char *value, double *years, esk_problem *problem);

/* Above 0, at most 1, digits with an optional fraction. */
bool esk_value_share(const char *name, const char *value, double *share, esk_problem *problem);

/* Of voxels, mm: 0.001 to 1000, well within what an affine may have. */
bool esk_value_spacing(const char *name, const char *value, double *spacing, esk_problem *problem);

/* Between an eye and what it sees, mm: 0 to 1000000000. */
bool esk_value_eye_distance(const char *name, const char *value, double *distance, esk_problem *problem);

/* One of a NULL-terminated list; *index is its place. */
bool esk_value_choice(
	const char *name, const char *value, const char *const *choices, unsigned *index, esk_problem *problem);

bool esk_value_side(const char *name, const char *value, eskel_side *side, esk_problem *problem);
bool esk_value_sex(const char *name, const char *value, eskel_sex *sex, esk_problem *problem);

#define ESK_ID_EXPECTED "an id of 32 lower-case hexadecimal digits"

/* Exactly 32 lower-case hexadecimal digits. */
bool esk_value_is_id(const char *value);

/* "left", "female" and so on; NULL for unknown. */
const char *esk_value_side_text(eskel_side side);
const char *esk_value_sex_text(eskel_sex sex);

#endif
