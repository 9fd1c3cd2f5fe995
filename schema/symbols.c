#include "symbols.h"

#include <stdlib.h>
#include <string.h>

enum { LEAST_CAPACITY = 64 };

/* FNV-1a. Who may write chooses the texts, and can only make his own filters slow. */
static uint32_t hash(const char *text, size_t size)
{
	uint32_t h = 2166136261u;
	for (size_t i = 0; i < size; i++)
		h = (h ^ (unsigned char)text[i]) * 16777619u;
	return h;
}

static uint32_t *bucket_of(const esk_symbols *symbols, const char *text, size_t size)
{
	return &symbols->buckets[hash(text, size) & (symbols->capacity - 1)];
}

static void put_in_bucket(esk_symbols *symbols, uint32_t symbol)
{
	esk_symbol *s = &symbols->items[symbol];
	uint32_t *bucket = bucket_of(symbols, s->text, s->size);
	s->next = *bucket;
	*bucket = symbol;
}

static bool grow(esk_symbols *symbols)
{
	if (symbols->capacity > UINT32_MAX / 2)
		return false;
	uint32_t capacity = symbols->capacity ? 2 * symbols->capacity : LEAST_CAPACITY;
	esk_symbol *items = realloc(symbols->items, capacity * sizeof *items);
	if (!items)
		return false;
	symbols->items = items;
	uint32_t *buckets = calloc(capacity, sizeof *buckets);
	if (!buckets)
		return false;
	free(symbols->buckets);
	symbols->buckets = buckets;
	symbols->capacity = capacity;
	if (symbols->count == 0)
		items[symbols->count++] = (esk_symbol){.text = NULL};
	for (uint32_t s = 1; s < symbols->count; s++)
		if (items[s].text)
			put_in_bucket(symbols, s);
	return true;
}

void esk_symbols_clear(esk_symbols *symbols)
{
	for (uint32_t s = 1; s < symbols->count; s++)
		free(symbols->items[s].text);
	free(symbols->items);
	free(symbols->buckets);
	*symbols = (esk_symbols){.count = 0};
}

uint32_t esk_symbol_find(const esk_symbols *symbols, const char *text, size_t size)
{
	if (!symbols->count)
		return ESK_SYMBOL_NONE;
	uint32_t s = *bucket_of(symbols, text, size);
	while (s && (symbols->items[s].size != size || memcmp(symbols->items[s].text, text, size) != 0))
		s = symbols->items[s].next;
	return s;
}

static bool add(esk_symbols *symbols, const char *text, size_t size, uint32_t *symbol)
{
	if (!symbols->free && symbols->count == symbols->capacity && !grow(symbols))
		return false;
	char *copy = malloc(size + 1);
	if (!copy)
		return false;
	memcpy(copy, text, size);
	uint32_t s = symbols->free;
	if (s)
		symbols->free = symbols->items[s].next;
	else
		s = symbols->count++;
	symbols->items[s] = (esk_symbol){.text = copy, .size = size, .uses = 1};
	put_in_bucket(symbols, s);
	*symbol = s;
	return true;
}

bool esk_symbol_take(esk_symbols *symbols, const char *text, size_t size, uint32_t *symbol)
{
	uint32_t found = esk_symbol_find(symbols, text, size);
	if (!found)
		return add(symbols, text, size, symbol);
	symbols->items[found].uses++;
	*symbol = found;
	return true;
}

void esk_symbol_drop(esk_symbols *symbols, uint32_t symbol)
{
	if (symbol == ESK_SYMBOL_NONE)
		return;
	esk_symbol *s = &symbols->items[symbol];
	if (--s->uses > 0)
		return;
	uint32_t *link = bucket_of(symbols, s->text, s->size);
	while (*link != symbol)
		link = &symbols->items[*link].next;
	*link = s->next;
	free(s->text);
	*s = (esk_symbol){.next = symbols->free};
	symbols->free = symbol;
}
