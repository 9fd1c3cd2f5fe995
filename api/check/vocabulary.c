/* The classes of the library, see vocabulary.h. */
#include "vocabulary.h"

#include <stdlib.h>
#include <string.h>

bool esk_vocabulary_open(esk_vocabulary *v, eskel_exchange *exchange)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_store_classes(exchange->api->store, &v->names, &v->count, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	v->keys = calloc(v->count + 1, sizeof *v->keys);
	v->statistics = calloc(v->count + 1, sizeof *v->statistics);
	v->counted = calloc(v->count + 1, sizeof *v->counted);
	if (!v->keys || !v->statistics || !v->counted)
		return esk_problem_no_memory(&exchange->problem);
	for (size_t i = 0; i < v->count; i++)
		if (!esk_label_key(v->names[i], v->keys[i]))
			v->keys[i][0] = 0;
	return true;
}

void esk_vocabulary_close(esk_vocabulary *v)
{
	for (size_t i = 0; v->statistics && i < v->count; i++)
		esk_class_statistics_clear(&v->statistics[i]);
	free(v->statistics);
	free(v->counted);
	free(v->keys);
	eskel_store_classes_free(v->names, v->count);
	*v = (esk_vocabulary){0};
}

size_t esk_vocabulary_find(const esk_vocabulary *v, const char *class)
{
	char key[ESK_LABEL_KEY_SIZE];
	for (size_t i = 0; class && i < v->count; i++)
		if (strcmp(v->names[i], class) == 0)
			return i;
	if (class && esk_label_key(class, key))
		for (size_t i = 0; i < v->count; i++)
			if (strcmp(v->keys[i], key) == 0)
				return i;
	return SIZE_MAX;
}

bool esk_vocabulary_count(esk_vocabulary *v, eskel_exchange *exchange, size_t index)
{
	if (v->counted[index])
		return true;
	v->counted[index] = true;
	return esk_class_statistics_make(
		exchange->api, &exchange->query, v->names[index], &v->statistics[index], &exchange->problem);
}
