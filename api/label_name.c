/* What a label's name says, see label_name.h. One table of side words; a name is taken word by word. */
#include "label_name.h"

#include <string.h>
#include <strings.h>

static const char separators[] = " _-.,/()[]";

static const struct {
	const char *word;
	eskel_side side;
	bool anywhere; /* short words mean a side only at an end of the name */
} side_words[] = {
	{"left", ESKEL_SIDE_LEFT, true},
	{"right", ESKEL_SIDE_RIGHT, true},
	{"l", ESKEL_SIDE_LEFT, false},
	{"r", ESKEL_SIDE_RIGHT, false},
	{"lh", ESKEL_SIDE_LEFT, true},
	{"rh", ESKEL_SIDE_RIGHT, true},
};

static eskel_side side_of(const char *word, size_t size, bool at_an_end)
{
	for (size_t i = 0; i < sizeof side_words / sizeof *side_words; i++)
		if (strlen(side_words[i].word) == size && strncasecmp(side_words[i].word, word, size) == 0)
			return side_words[i].anywhere || at_an_end ? side_words[i].side : ESKEL_SIDE_UNKNOWN;
	return ESKEL_SIDE_UNKNOWN;
}

static char *append_word(char *class, char *end, const char *word, size_t size)
{
	if (end > class)
		*end++ = '_';
	for (size_t i = 0; i < size; i++)
		*end++ = word[i] >= 'A' && word[i] <= 'Z' ? (char)(word[i] - 'A' + 'a') : word[i];
	*end = 0;
	return end;
}

void esk_label_class(const char *name, char *class)
{
	char *end = class;
	*end = 0;
	for (name += strspn(name, separators); *name; name += strspn(name, separators)) {
		size_t size = strcspn(name, separators);
		end = append_word(class, end, name, size);
		name += size;
	}
}

void esk_label_split(const char *name, char *class, eskel_side *side)
{
	eskel_side found = ESKEL_SIDE_UNKNOWN;
	bool both = false;
	char *end = class;
	*end = 0;
	const char *first = name + strspn(name, separators);
	for (const char *word = first; *word;) {
		size_t size = strcspn(word, separators);
		const char *next = word + size + strspn(word + size, separators);
		eskel_side said = side_of(word, size, word == first || !*next);
		if (said == ESKEL_SIDE_UNKNOWN)
			end = append_word(class, end, word, size);
		both = both || (said != ESKEL_SIDE_UNKNOWN && found != ESKEL_SIDE_UNKNOWN && said != found);
		if (said != ESKEL_SIDE_UNKNOWN)
			found = said;
		word = next;
	}
	if (both || end == class) {
		esk_label_class(name, class);
		found = ESKEL_SIDE_UNKNOWN;
	}
	*side = found;
}
