/* Attribute keys, each once, in the order of their bytes. */
#ifndef ESK_KEY_SET_H
#define ESK_KEY_SET_H

#include "complain.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct {
	char **keys;
	size_t count;
} esk_key_set;

bool esk_key_set_has(const esk_key_set *set, const char *key);
esk_outcome esk_key_set_add(esk_key_set *set, const char *key);
void esk_key_set_clear(esk_key_set *set);

#endif
