/* Where each key of a library lies: a hash table with linear probing, at most half full. For the one writer; readers
 * walk the chunks. */
#ifndef ESK_KEY_INDEX_H
#define ESK_KEY_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
	int64_t key;
	void *chunk; /* NULL: an empty place */
	uint32_t slot;
} esk_key_place;

/* All zero is an empty index. */
typedef struct {
	esk_key_place *places;
	size_t capacity; /* a power of two, or 0 */
	size_t count;
} esk_key_index;

/* NULL when the key is not there. The answer stands until the next insertion or removal. */
esk_key_place *esk_key_index_find(const esk_key_index *index, int64_t key);
/* Makes room for one more; false when memory ran out. */
bool esk_key_index_reserve(esk_key_index *index);
/* The key is not there, and room is. */
void esk_key_index_insert(esk_key_index *index, esk_key_place place);
void esk_key_index_remove(esk_key_index *index, esk_key_place *place);
void esk_key_index_clear(esk_key_index *index);

#endif
