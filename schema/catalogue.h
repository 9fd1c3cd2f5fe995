/* What filters look at, of all shapes, in memory: columns that a filter passes over in the order of keys, a block at a time.
 * By SQL half of 100,000 shapes take 20 ms to find, much longer than the search among them that they save.
 *
 * The writer keeps it: it puts and removes what a transaction has changed when that is committed, before anybody is told,
 * and one transaction after the other, so that keys ascend. Readers and the writer lock each other out for as long as a
 * filter or a change takes. */
#ifndef ESK_CATALOGUE_H
#define ESK_CATALOGUE_H

#include "eskel_store.h"

typedef struct esk_catalogue esk_catalogue;

/* NULL when memory ran out. */
esk_catalogue *esk_catalogue_new(void);
void esk_catalogue_free(esk_catalogue *catalogue);

/* Adds a key above all others, or describes one that is there anew. Without memory the catalogue is of no use any more. */
void esk_catalogue_put(esk_catalogue *catalogue, int64_t key, const eskel_description *description);
void esk_catalogue_remove(esk_catalogue *catalogue, int64_t key);

/* The keys of the shapes that a filter leaves; free() them, not NULL when there are none. False for a filter that
 * looks for text, after memory ran out, and for NULL: ask the database. */
bool esk_catalogue_keys(
	esk_catalogue *catalogue, const eskel_filter *filter, eskel_key_block **keys, size_t *block_count);

/* False after memory ran out. */
bool esk_catalogue_is_whole(esk_catalogue *catalogue);

#endif
