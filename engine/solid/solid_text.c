/* Words and numbers of the formats that are text, see solid_format.h. */
#include "error.h"
#include "solid_format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char spaces[] = " \t\v\f";

eskel_status esk_solid_refuse_line(
	const esk_solid_reader *reader, const char *word, const char *expected, eskel_error *error)
{
	return esk_error_set(error, ESKEL_MALFORMED, "line %llu begins with \"%.60s\", expected %s",
		(unsigned long long)reader->line, word, expected);
}

char *esk_solid_word(char **text)
{
	char *word = *text + strspn(*text, spaces);
	size_t size = strcspn(word, spaces);
	if (size == 0)
		return NULL;
	*text = word + size;
	if (word[size])
		*(*text)++ = 0;
	return word;
}

bool esk_solid_number(const esk_solid_reader *reader, const char *word, double *number)
{
	char *end;
	if (!word || word[strspn(word, "0123456789+-.eE")])
		return false;
	*number = strtod_l(word, &end, reader->locale);
	return end != word && *end == 0;
}

bool esk_solid_coordinates(const esk_solid_reader *reader, char **text, double at[3])
{
	for (int r = 0; r < 3; r++)
		if (!esk_solid_number(reader, esk_solid_word(text), &at[r]))
			return false;
	return true;
}

void esk_solid_note_space(esk_solid_reader *reader, const char *comment)
{
	const char *space = strstr(comment, "SPACE=");
	if (!space || reader->space != ESK_SPACE_UNSAID)
		return;
	if (strncmp(space, "SPACE=RAS", 9) == 0)
		reader->space = ESK_SPACE_RAS;
	if (strncmp(space, "SPACE=LPS", 9) == 0)
		reader->space = ESK_SPACE_LPS;
}
