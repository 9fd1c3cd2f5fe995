#include "label_names.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

eskel_status esk_label_names_add(esk_label_names *names, int32_t label, const char *name)
{
	if (esk_label_names_find(names, label))
		return ESKEL_OK;
	void *items = names->items;
	if (!esk_memory_reserve(&items, &names->capacity, names->count + 1, sizeof *names->items))
		return ESKEL_NO_MEMORY;
	names->items = items;
	const size_t size = strlen(name) + 1;
	char *copy = esk_memory_array(size, 1);
	if (!copy)
		return ESKEL_NO_MEMORY;
	memcpy(copy, name, size);
	names->items[names->count++] = (esk_label_name){label, copy};
	return ESKEL_OK;
}

const char *esk_label_names_find(const esk_label_names *names, int32_t label)
{
	for (size_t i = 0; i < names->count; i++)
		if (names->items[i].label == label)
			return names->items[i].name;
	return NULL;
}

void esk_label_names_clear(esk_label_names *names)
{
	for (size_t i = 0; i < names->count; i++)
		free(names->items[i].name);
	free(names->items);
	*names = (esk_label_names){0};
}
