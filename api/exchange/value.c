/* Strict values, see value.h. No strtod or strtol: they skip spaces, take hexadecimal and follow the locale. */
#include "value.h"

#include "label_name.h"
#include "text.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* In the order of eskel_side and eskel_sex, from their value 1. */
static const char *const sides[] = {"left", "right", "none", NULL};
static const char *const sexes[] = {"female", "male", "F", "M", NULL};

#define SIDE_COUNT 3
#define SEX_COUNT 2

bool esk_value_text(const char *name, const char *value, size_t most, esk_problem *problem)
{
	size_t size = strlen(value);
	if (size == 0)
		return esk_problem_set(problem, 400, "%s is empty, expected 1 to %zu bytes of text", name, most);
	if (size > most)
		return esk_problem_set(problem, 400, "%s has %zu bytes, expected at most %zu", name, size, most);
	if (!esk_text_is_plain(value))
		return esk_problem_set(
			problem, 400, "%s is \"%s\", expected UTF-8 text without control characters", name, value);
	return true;
}

bool esk_value_class(const char *name, const char *value, char class[ESK_TEXT_MOST + 1], esk_problem *problem)
{
	if (!esk_value_text(name, value, ESK_TEXT_MOST, problem))
		return false;
	esk_label_class(value, class);
	if (!class[0])
		return esk_problem_set(problem, 400, "%s is \"%s\", expected a word", name, value);
	return true;
}

/* Decimal digits up to a value of 10^15, far beyond every range here. Returns where they end. */
static const char *digits(const char *text, int64_t *number)
{
	int64_t value = 0;
	for (; *text >= '0' && *text <= '9' && value < INT64_C(100000000000000); text++)
		value = 10 * value + (*text - '0');
	*number = value;
	return text;
}

bool esk_value_integer(
	const char *name, const char *value, int64_t least, int64_t most, int64_t *number, esk_problem *problem)
{
	int64_t size;
	const char *first = value + (*value == '-');
	const char *end = digits(first, &size);
	int64_t signed_value = *value == '-' ? -size : size;
	if (end == first || *end || signed_value < least || signed_value > most)
		return esk_problem_set(problem, 400,
			"%s is \"%.60s\", expected a whole number from %" PRId64 " to %" PRId64, name, value, least,
			most);
	*number = signed_value;
	return true;
}

/* Digits with an optional fraction; false for anything else. */
static bool decimal(const char *value, double *number)
{
	int64_t whole = 0, fraction = 0;
	double scale = 1;
	const char *end = digits(value, &whole);
	bool good = end > value;
	if (*end == '.') {
		const char *first = end + 1;
		end = digits(first, &fraction);
		good = good && end > first;
		for (const char *digit = first; digit < end; digit++)
			scale *= 10;
	}
	*number = (double)whole + (double)fraction / scale;
	return good && !*end;
}

bool esk_value_years(const char *name, const char *value, double *years, esk_problem *problem)
{
	double sum;
	if (!decimal(value, &sum) || sum > ESK_YEARS_MOST)
		return esk_problem_set(
			problem, 400, "%s is \"%.60s\", expected years from 0 to %d", name, value, ESK_YEARS_MOST);
	*years = sum;
	return true;
}

bool esk_value_share(const char *name, const char *value, double *share, esk_problem *problem)
{
	double number;
	if (!decimal(value, &number) || number <= 0 || number > 1)
		return esk_problem_set(
			problem, 400, "%s is \"%.60s\", expected a number above 0, at most 1", name, value);
	*share = number;
	return true;
}

bool esk_value_spacing(const char *name, const char *value, double *spacing, esk_problem *problem)
{
	double number;
	if (!decimal(value, &number) || number < 0.001 || number > 1000)
		return esk_problem_set(
			problem, 400, "%s is \"%.60s\", expected millimetres, 0.001 to 1000", name, value);
	*spacing = number;
	return true;
}

bool esk_value_eye_distance(const char *name, const char *value, double *distance, esk_problem *problem)
{
	double number;
	if (!decimal(value, &number) || number > 1e9)
		return esk_problem_set(
			problem, 400, "%s is \"%.60s\", expected millimetres, 0 to 1000000000", name, value);
	*distance = number;
	return true;
}

bool esk_value_choice(
	const char *name, const char *value, const char *const *choices, unsigned *index, esk_problem *problem)
{
	char expected[200] = "";
	for (unsigned i = 0; choices[i]; i++) {
		if (strcmp(choices[i], value) == 0) {
			*index = i;
			return true;
		}
		size_t used = strlen(expected);
		snprintf(expected + used, sizeof expected - used, "%s%s",
			i == 0           ? ""
			: choices[i + 1] ? ", "
					 : " or ",
			choices[i]);
	}
	return esk_problem_set(problem, 400, "%s is \"%.60s\", expected %s", name, value, expected);
}

bool esk_value_side(const char *name, const char *value, eskel_side *side, esk_problem *problem)
{
	unsigned index;
	if (!esk_value_choice(name, value, sides, &index, problem))
		return false;
	*side = (eskel_side)(index + 1);
	return true;
}

bool esk_value_sex(const char *name, const char *value, eskel_sex *sex, esk_problem *problem)
{
	unsigned index;
	if (!esk_value_choice(name, value, sexes, &index, problem))
		return false;
	*sex = (eskel_sex)(index % SEX_COUNT + 1);
	return true;
}

bool esk_value_is_id(const char *value)
{
	return strlen(value) == ESKEL_ID_SIZE - 1 && strspn(value, "0123456789abcdef") == ESKEL_ID_SIZE - 1;
}

const char *esk_value_side_text(eskel_side side)
{
	return side >= 1 && side <= SIDE_COUNT ? sides[side - 1] : NULL;
}

const char *esk_value_sex_text(eskel_sex sex)
{
	return sex >= 1 && sex <= SEX_COUNT ? sexes[sex - 1] : NULL;
}
