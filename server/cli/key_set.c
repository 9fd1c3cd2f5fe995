#include "key_set.h"

#include <stdlib.h>
#include <string.h>

/* Where the key is, or would be. */
static size_t find(const esk_key_set *set, const char *key)
{
	size_t low = 0;
	for (size_t high = set->count; low < high;) {
		const size_t middle = low + (high - low) / 2;
		if (strcmp(set->keys[middle], key) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

bool esk_key_set_has(const esk_key_set *set, const char *key)
{
	const size_t place = find(set, key);
	return place < set->count && !strcmp(set->keys[place], key);
}

esk_outcome esk_key_set_add(esk_key_set *set, const char *key)
{
	if (esk_key_set_has(set, key))
		return ESK_DONE;
	const size_t place = find(set, key);
	char **keys = reallocarray(set->keys, set->count + 1, sizeof *keys), *copy = strdup(key);
	if (keys)
		set->keys = keys;
	if (!keys || !copy) {
		free(copy);
		return esk_complain(ESK_REFUSED, "memory ran out");
	}
	memmove(&keys[place + 1], &keys[place], (set->count - place) * sizeof *keys);
	keys[place] = copy;
	set->count++;
	return ESK_DONE;
}

void esk_key_set_clear(esk_key_set *set)
{
	for (size_t i = 0; i < set->count; i++)
		free(set->keys[i]);
	free(set->keys);
	*set = (esk_key_set){0};
}
