/* Texts as numbers, so that comparing two of them is comparing numbers: equal texts have the same symbol. A symbol is counted
 * as often as it was taken, and is used again for another text when nobody has it any more. */
#ifndef ESK_SYMBOLS_H
#define ESK_SYMBOLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ESK_SYMBOL_NONE = 0 }; /* of no text */

typedef struct {
	char *text; /* owned; NULL: the symbol is free */
	size_t size;
	uint32_t uses;
	uint32_t next; /* in the bucket, or the next free one */
} esk_symbol;

/* All zero: empty. Symbols are indices of items, of which the first is none. */
typedef struct {
	uint32_t count, capacity, free;
	esk_symbol *items;
	uint32_t *buckets; /* as many as the capacity, a power of two */
} esk_symbols;

void esk_symbols_clear(esk_symbols *symbols);

/* False when memory ran out. */
bool esk_symbol_take(esk_symbols *symbols, const char *text, size_t size, uint32_t *symbol);
void esk_symbol_drop(esk_symbols *symbols, uint32_t symbol);
/* NONE when nobody has taken it. */
uint32_t esk_symbol_find(const esk_symbols *symbols, const char *text, size_t size);

#endif
