/* The names that a file gives its labels. */
#ifndef ESK_LABEL_NAMES_H
#define ESK_LABEL_NAMES_H

#include "eskel.h"

typedef struct {
	int32_t label;
	char *name;
} esk_label_name;

/* All-zero is empty. */
typedef struct {
	size_t count, capacity;
	esk_label_name *items;
} esk_label_names;

/* Copies the name. A label that has one keeps it. ESKEL_NO_MEMORY. */
eskel_status esk_label_names_add(esk_label_names *names, int32_t label, const char *name);
/* NULL for a label without a name. */
const char *esk_label_names_find(const esk_label_names *names, int32_t label);
void esk_label_names_clear(esk_label_names *names);

#endif
