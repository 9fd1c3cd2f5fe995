/* What a label's name says, see label_name.h. One table of side words; a name is taken word by word. */
#include "label_name.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char separators[] = " _-.,/()[]\"";

static const struct {
	const char *word;
	eskel_side side;
	bool anywhere; /* short words mean a side only at an end of the name */
} side_words[] = {
	{"left", ESKEL_SIDE_LEFT, true},
	{"right", ESKEL_SIDE_RIGHT, true},
	{"l", ESKEL_SIDE_LEFT, false},
	{"r", ESKEL_SIDE_RIGHT, false},
	{"lt", ESKEL_SIDE_LEFT, false},
	{"rt", ESKEL_SIDE_RIGHT, false},
	{"lh", ESKEL_SIDE_LEFT, true},
	{"rh", ESKEL_SIDE_RIGHT, true},
	{"sinister", ESKEL_SIDE_LEFT, true},
	{"sinistra", ESKEL_SIDE_LEFT, true},
	{"sinistrum", ESKEL_SIDE_LEFT, true},
	{"sin", ESKEL_SIDE_LEFT, false},
	{"dexter", ESKEL_SIDE_RIGHT, true},
	{"dextra", ESKEL_SIDE_RIGHT, true},
	{"dextrum", ESKEL_SIDE_RIGHT, true},
	{"dex", ESKEL_SIDE_RIGHT, false},
	{"links", ESKEL_SIDE_LEFT, true},
	{"rechts", ESKEL_SIDE_RIGHT, true},
};

/* The left atrium is no mirror image of the right one: beside these words, left and right tell classes apart. */
static const char *const unpaired_words[] = {"heart", "cardiac"};

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

/* The next word of a name, and what stands behind it. In LeftFemur and femurRight the case alone ends a side word. */
static size_t word_size(const char *word)
{
	static const char *const sides[] = {"left", "right"};
	size_t size = strcspn(word, separators);
	for (size_t i = 0; i < 2; i++) {
		size_t side = strlen(sides[i]);
		if (size <= side)
			continue;
		if (strncasecmp(word, sides[i], side) == 0 && islower((unsigned char)word[side - 1]) &&
			isupper((unsigned char)word[side]))
			return side;
		const char *end = word + size - side;
		if (strncasecmp(end, sides[i], side) == 0 && isupper((unsigned char)end[0]) &&
			islower((unsigned char)end[1]) && islower((unsigned char)end[-1]))
			return size - side;
	}
	return size;
}

static bool is_unpaired(const char *word, size_t size)
{
	for (size_t i = 0; i < sizeof unpaired_words / sizeof *unpaired_words; i++)
		if (strlen(unpaired_words[i]) == size && strncasecmp(unpaired_words[i], word, size) == 0)
			return true;
	return false;
}

void esk_label_split(const char *name, char *class, eskel_side *side)
{
	eskel_side found = ESKEL_SIDE_UNKNOWN;
	bool whole = false;
	char *end = class;
	*end = 0;
	const char *first = name + strspn(name, separators);
	for (const char *word = first; *word;) {
		size_t size = word_size(word);
		const char *next = word + size + strspn(word + size, separators);
		eskel_side said = side_of(word, size, word == first || !*next);
		if (said == ESKEL_SIDE_UNKNOWN)
			end = append_word(class, end, word, size);
		whole = whole || is_unpaired(word, size) ||
			(said != ESKEL_SIDE_UNKNOWN && found != ESKEL_SIDE_UNKNOWN && said != found);
		if (said != ESKEL_SIDE_UNKNOWN)
			found = said;
		word = next;
	}
	if (whole || end == class) {
		esk_label_class(name, class);
		found = ESKEL_SIDE_UNKNOWN;
	}
	*side = found;
}

/* ---- the same class in other words */

/* Words that one vocabulary has and another has not: "hamate bone", "metatarsal 1st". */
static bool is_filler(const char *word, size_t size, bool after_number)
{
	static const char *const fillers[] = {"bone", "bones", "os"}, *const ordinals[] = {"st", "nd", "rd", "th"};
	for (size_t i = 0; i < sizeof fillers / sizeof *fillers; i++)
		if (strlen(fillers[i]) == size && strncmp(fillers[i], word, size) == 0)
			return true;
	for (size_t i = 0; after_number && i < sizeof ordinals / sizeof *ordinals; i++)
		if (size == 2 && strncmp(ordinals[i], word, size) == 0)
			return true;
	return false;
}

static int compare_words(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

enum { MOST_WORDS = 32 };

/* The words of a class without fillers, each of letters or of digits alone, in the singular where that is irregular; those
 * after the MOST_WORDS-th do not count. text, which holds them, has room for 2 strlen(class) + 1. */
static size_t words_of(const char *class, char *text, const char *words[MOST_WORDS])
{
	size_t count = 0;
	bool number = false;
	while (*class && count < MOST_WORDS) {
		const char *word = class;
		bool digits = isdigit((unsigned char)*class);
		while (*class && *class != '_' && !isdigit((unsigned char)*class) == !digits)
			class ++;
		size_t size = (size_t)(class - word);
		if (size > 0 && !is_filler(word, size, number)) {
			words[count++] = memcpy(text, word, size);
			text[size] = 0;
			if (strcmp(text, "vertebrae") == 0)
				words[count - 1] = "vertebra";
			text += size + 1;
		}
		number = digits && *class != '_';
		class += *class == '_';
	}
	return count;
}

bool esk_label_key(const char *class, char key[ESK_LABEL_KEY_SIZE])
{
	char text[ESK_LABEL_KEY_SIZE];
	const char *words[MOST_WORDS];
	if (2 * strlen(class) + 1 > sizeof text)
		return false;
	size_t count = words_of(class, text, words);
	qsort(words, count, sizeof *words, compare_words);
	for (size_t i = 0; i < count; i++) {
		size_t size = strlen(words[i]);
		memcpy(key, words[i], size);
		key += size;
		*key++ = i + 1 < count ? '_' : 0;
	}
	return count > 0;
}

bool esk_label_same_class(const char *a, const char *b)
{
	char keys[2][ESK_LABEL_KEY_SIZE];
	if (strcmp(a, b) == 0)
		return true;
	return esk_label_key(a, keys[0]) && esk_label_key(b, keys[1]) && strcmp(keys[0], keys[1]) == 0;
}
