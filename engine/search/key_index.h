/* Where each key of a library lies: a hash table with linear probing, at most half full. For the one writer; readers
 * walk the chunks.
 *
 * A place takes four bytes: the shape's number in the library (esk_snapshot_id). The key itself is read where it lies,
 * in the directory that the numbers are of. */
#ifndef ESK_KEY_INDEX_H
#define ESK_KEY_INDEX_H

#include "snapshot.h"

/* All zero is an empty index. */
typedef struct {
	uint32_t *places; /* 0: empty, else the number + 1 */
	size_t capacity;  /* a power of two, or 0 */
	size_t count;
} esk_key_index;

/* False when the key is not there. */
bool esk_key_index_find(const esk_key_index *index, const esk_directory *directory, int64_t key, uint32_t *id);
/* Makes room for one more; false when memory ran out. */
bool esk_key_index_reserve(esk_key_index *index, const esk_directory *directory);
/* The key is not there, and room is. */
void esk_key_index_insert(esk_key_index *index, int64_t key, uint32_t id);
/* The key is there, with the number from. */
void esk_key_index_move(esk_key_index *index, int64_t key, uint32_t from, uint32_t to);
void esk_key_index_remove(esk_key_index *index, const esk_directory *directory, int64_t key, uint32_t id);
void esk_key_index_clear(esk_key_index *index);

#endif
