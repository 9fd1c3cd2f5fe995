#include "nrrd_lists.h"

#include "error.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void skip_blanks(const char **at)
{
	*at += strspn(*at, " \t");
}

bool esk_nrrd_read_number(const char **at, double *number)
{
	char *end;
	*number = strtod(*at, &end);
	const bool good = end != *at;
	*at = end;
	skip_blanks(at);
	return good;
}

static bool read_character(const char **at, char character)
{
	if (**at != character)
		return false;
	++*at;
	skip_blanks(at);
	return true;
}

bool esk_nrrd_read_word(const char **at, esk_nrrd_span *word)
{
	const bool quoted = **at == '"';
	const char *begin = *at + quoted;
	*word = (esk_nrrd_span){begin, strcspn(begin, quoted ? "\"" : " \t")};
	if (word->size == 0 && !quoted)
		return false;
	*at = begin + word->size + (quoted && begin[word->size] == '"');
	skip_blanks(at);
	return true;
}

bool esk_nrrd_read_vector(const char **at, double vector[3], bool *none)
{
	*none = strncasecmp(*at, "none", 4) == 0;
	if (*none) {
		*at += 4;
		skip_blanks(at);
		return true;
	}
	return read_character(at, '(') && esk_nrrd_read_number(at, &vector[0]) && read_character(at, ',') &&
	       esk_nrrd_read_number(at, &vector[1]) && read_character(at, ',') &&
	       esk_nrrd_read_number(at, &vector[2]) && read_character(at, ')');
}

eskel_status esk_nrrd_refuse_list(const esk_nrrd_axes *axes, esk_nrrd_field field, const char *name, const char *what,
	int count, eskel_error *error)
{
	return esk_error_set(error, ESKEL_MALFORMED, "the NRRD header's %s is \"%.100s\", expected %d %s", name,
		axes->fields->values[field], count, what);
}

eskel_status esk_nrrd_read_numbers(const esk_nrrd_axes *axes, esk_nrrd_field field, const char *name,
	double numbers[ESK_NRRD_AXES_MOST], eskel_error *error)
{
	const char *at = axes->fields->values[field];
	for (int a = 0; a < axes->count; a++)
		if (!esk_nrrd_read_number(&at, &numbers[a]))
			return esk_nrrd_refuse_list(axes, field, name, "numbers", axes->count, error);
	return *at ? esk_nrrd_refuse_list(axes, field, name, "numbers", axes->count, error) : ESKEL_OK;
}
