/* Columns of descriptions, see catalogue.h. Row i of each column belongs to the i-th key. A removed row stays, without
 * life, until half of the rows are such. */
#include "catalogue.h"

#include "symbols.h"

#include <endian.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	uint32_t count;
	uint32_t symbols[]; /* of key and value together */
} attributes;

enum { FEW = 4 };
static const uint32_t MORE = UINT32_MAX; /* no symbol: so many texts do not fit into memory */

struct esk_catalogue {
	pthread_rwlock_t lock;
	bool whole;
	esk_symbols symbols;
	size_t count, capacity, dead; /* the capacity is a multiple of AT_ONCE; rows from count on have no life */
	int64_t *keys;
	bool *live;
	uint8_t *sides, *sexes;
	uint32_t *classes, *subjects;
	double *ages;
	uint32_t *few[FEW];      /* the attributes, if there are no more than these; else the last is MORE */
	attributes **attributes; /* NULL: none */
};

/* ---- rows */

/* New rows are zero. */
static bool grow_column(void *column, size_t count, size_t capacity, size_t size)
{
	void **items = column;
	char *moved = realloc(*items, capacity * size);
	if (!moved)
		return false;
	memset(moved + count * size, 0, (capacity - count) * size);
	*items = moved;
	return true;
}

static bool reserve(esk_catalogue *c)
{
	const size_t n = c->count, capacity = c->capacity ? 2 * c->capacity : 256;
	if (n < c->capacity)
		return true;
	if (!grow_column(&c->keys, n, capacity, sizeof *c->keys) ||
		!grow_column(&c->live, n, capacity, sizeof *c->live) ||
		!grow_column(&c->sides, n, capacity, sizeof *c->sides) ||
		!grow_column(&c->sexes, n, capacity, sizeof *c->sexes) ||
		!grow_column(&c->classes, n, capacity, sizeof *c->classes) ||
		!grow_column(&c->subjects, n, capacity, sizeof *c->subjects) ||
		!grow_column(&c->ages, n, capacity, sizeof *c->ages) ||
		!grow_column(&c->attributes, n, capacity, sizeof *c->attributes))
		return false;
	for (int i = 0; i < FEW; i++)
		if (!grow_column(&c->few[i], n, capacity, sizeof *c->few[i]))
			return false;
	c->capacity = capacity;
	return true;
}

/* The first row whose key is at least this one. */
static size_t find(const esk_catalogue *c, int64_t key)
{
	size_t low = 0, high = c->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (c->keys[middle] < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static void clear_row(esk_catalogue *c, size_t row)
{
	attributes *all = c->attributes[row];
	esk_symbol_drop(&c->symbols, c->classes[row]);
	esk_symbol_drop(&c->symbols, c->subjects[row]);
	for (uint32_t i = 0; all && i < all->count; i++)
		esk_symbol_drop(&c->symbols, all->symbols[i]);
	free(all);
	c->classes[row] = c->subjects[row] = ESK_SYMBOL_NONE;
	c->attributes[row] = NULL;
}

static bool take_text(esk_catalogue *c, const char *text, uint32_t *symbol)
{
	return !text || esk_symbol_take(&c->symbols, text, strlen(text), symbol);
}

/* The key and the value with the zero byte between: no other text has one. NULL when memory ran out. */
static char *join(const eskel_attribute *attribute, size_t *size)
{
	size_t key = strlen(attribute->key) + 1, value = strlen(attribute->value);
	char *joined = malloc(key + value + 1);
	if (!joined)
		return NULL;
	memcpy(joined, attribute->key, key);
	memcpy(joined + key, attribute->value, value);
	*size = key + value;
	return joined;
}

static bool take_attributes(esk_catalogue *c, const eskel_description *d, attributes **taken)
{
	if (!d->attribute_count)
		return true;
	attributes *all = malloc(sizeof *all + d->attribute_count * sizeof all->symbols[0]);
	if (!all)
		return false;
	*taken = all;
	for (all->count = 0; all->count < d->attribute_count; all->count++) {
		size_t size = 0;
		char *joined = join(&d->attributes[all->count], &size);
		bool good = joined && esk_symbol_take(&c->symbols, joined, size, &all->symbols[all->count]);
		free(joined);
		if (!good)
			return false;
	}
	return true;
}

static void set_few(esk_catalogue *c, size_t row)
{
	const attributes *all = c->attributes[row];
	for (uint32_t i = 0; i < FEW; i++)
		c->few[i][row] = all && i < all->count ? all->symbols[i] : ESK_SYMBOL_NONE;
	if (all && all->count > FEW)
		c->few[FEW - 1][row] = MORE;
}

/* Into an empty row. */
static bool set_row(esk_catalogue *c, size_t row, const eskel_description *d)
{
	c->sides[row] = (uint8_t)d->side;
	c->sexes[row] = (uint8_t)d->sex;
	c->ages[row] = d->age;
	const bool good = take_text(c, d->class, &c->classes[row]) && take_text(c, d->subject, &c->subjects[row]) &&
			  take_attributes(c, d, &c->attributes[row]);
	set_few(c, row);
	return good;
}

static void move_row(esk_catalogue *c, size_t from, size_t to)
{
	c->keys[to] = c->keys[from];
	c->live[to] = c->live[from];
	c->sides[to] = c->sides[from];
	c->sexes[to] = c->sexes[from];
	c->classes[to] = c->classes[from];
	c->subjects[to] = c->subjects[from];
	c->ages[to] = c->ages[from];
	for (int i = 0; i < FEW; i++)
		c->few[i][to] = c->few[i][from];
	c->attributes[to] = c->attributes[from];
}

static void bury(esk_catalogue *c)
{
	size_t kept = 0;
	for (size_t row = 0; row < c->count; row++)
		if (c->live[row])
			move_row(c, row, kept++);
	memset(c->live + kept, 0, (c->count - kept) * sizeof *c->live);
	c->count = kept;
	c->dead = 0;
}

/* ---- filters */

typedef struct {
	const eskel_filter *filter;
	uint32_t class, subject, not_subject;
	uint32_t attributes[]; /* attribute_count of the filter */
} condition;

/* False when a text that is asked for is in no row, so that no row fits. */
static bool find_text(const esk_catalogue *c, const char *text, uint32_t *symbol)
{
	*symbol = text ? esk_symbol_find(&c->symbols, text, strlen(text)) : ESK_SYMBOL_NONE;
	return !text || *symbol;
}

static bool find_attributes(const esk_catalogue *c, condition *made, bool *possible)
{
	for (size_t i = 0; i < made->filter->attribute_count; i++) {
		size_t size = 0;
		char *joined = join(&made->filter->attributes[i], &size);
		if (!joined)
			return false;
		made->attributes[i] = esk_symbol_find(&c->symbols, joined, size);
		*possible = *possible && made->attributes[i];
		free(joined);
	}
	return true;
}

/* NULL when memory ran out. */
static condition *make_condition(const esk_catalogue *c, const eskel_filter *filter, bool *possible)
{
	condition *made = calloc(1, sizeof *made + filter->attribute_count * sizeof made->attributes[0]);
	if (!made)
		return NULL;
	made->filter = filter;
	*possible = find_text(c, filter->class, &made->class) && find_text(c, filter->subject, &made->subject);
	find_text(c, filter->not_subject, &made->not_subject);
	if (find_attributes(c, made, possible))
		return made;
	free(made);
	return NULL;
}

static bool has(const attributes *all, uint32_t symbol)
{
	for (uint32_t i = 0; all && i < all->count; i++)
		if (all->symbols[i] == symbol)
			return true;
	return false;
}

enum { AT_ONCE = 64 };

static void keep_symbol(uint8_t *restrict fits, const uint32_t *restrict symbols, uint32_t symbol)
{
	for (size_t i = 0; i < AT_ONCE; i++)
		fits[i] &= symbols[i] == symbol;
}

static void keep_others(uint8_t *restrict fits, const uint32_t *restrict symbols, uint32_t symbol)
{
	for (size_t i = 0; i < AT_ONCE; i++)
		fits[i] &= symbols[i] != symbol;
}

static void keep_name(uint8_t *restrict fits, const uint8_t *restrict names, uint8_t name)
{
	for (size_t i = 0; i < AT_ONCE; i++)
		fits[i] &= names[i] == name;
}

static void keep_ages(uint8_t *restrict fits, const double *restrict ages, double least, double most)
{
	for (size_t i = 0; i < AT_ONCE; i++)
		fits[i] &= (uint8_t)((ages[i] >= least) & (ages[i] <= most));
}

static void keep_attribute(const esk_catalogue *c, uint8_t *restrict fits, size_t first, uint32_t symbol)
{
	const uint32_t *restrict a = c->few[0] + first, *restrict b = c->few[1] + first;
	const uint32_t *restrict d = c->few[2] + first, *restrict e = c->few[3] + first;
	for (size_t i = 0; i < AT_ONCE; i++)
		fits[i] &= (uint8_t)((a[i] == symbol) | (b[i] == symbol) | (d[i] == symbol) | (e[i] == symbol) |
				     (e[i] == MORE));
}

/* Which of AT_ONCE rows from first on may fit, a byte for each: a loop a condition, which compilers turn into vector code. */
static void test_columns(const esk_catalogue *c, const condition *of, size_t first, uint8_t fits[AT_ONCE])
{
	const eskel_filter *f = of->filter;
	memcpy(fits, c->live + first, AT_ONCE * sizeof *fits);
	if (f->class)
		keep_symbol(fits, c->classes + first, of->class);
	if (f->subject)
		keep_symbol(fits, c->subjects + first, of->subject);
	if (of->not_subject)
		keep_others(fits, c->subjects + first, of->not_subject);
	if (f->side)
		keep_name(fits, c->sides + first, (uint8_t)f->side);
	if (f->sex)
		keep_name(fits, c->sexes + first, (uint8_t)f->sex);
	if (!isnan(f->age_min) || !isnan(f->age_max))
		keep_ages(fits, c->ages + first, isnan(f->age_min) ? -INFINITY : f->age_min,
			isnan(f->age_max) ? INFINITY : f->age_max);
	for (size_t a = 0; a < f->attribute_count; a++)
		keep_attribute(c, fits, first, of->attributes[a]);
}

/* Bytes, each 0 or 1, as bits. Of eight at once: byte i, at 2^(8i), is moved to 2^(56 + i) by the factor's 2^(56 - 7i), and
 * no two of the products share a place. */
static uint64_t bits_of(const uint8_t bytes[AT_ONCE])
{
	uint64_t bits = 0;
	for (unsigned at = 0; at < AT_ONCE; at += 8) {
		uint64_t eight;
		memcpy(&eight, bytes + at, sizeof eight);
		bits |= (le64toh(eight) * 0x0102040810204080 >> 56) << at;
	}
	return bits;
}

/* Of these AT_ONCE rows those that do have the attributes: where there are more than columns, all are looked at. */
static uint64_t keep_attributes(const esk_catalogue *c, const condition *of, size_t first, uint64_t fits)
{
	uint8_t more[AT_ONCE];
	memset(more, 1, sizeof more);
	keep_symbol(more, c->few[FEW - 1] + first, MORE);
	for (uint64_t left = fits & bits_of(more); left; left &= left - 1) {
		const attributes *all = c->attributes[first + (size_t)__builtin_ctzll(left)];
		for (size_t a = 0; a < of->filter->attribute_count; a++)
			if (!has(all, of->attributes[a]))
				fits &= ~(left & -left);
	}
	return fits;
}

/* Adds the keys of count rows that fit; keys that follow one another, as they mostly do, at once. */
static size_t add_keys(const int64_t *row_keys, size_t count, uint64_t fits, eskel_key_block *keys, size_t block_count)
{
	if ((uint64_t)row_keys[count - 1] - (uint64_t)row_keys[0] == count - 1)
		return eskel_key_blocks_add(keys, block_count, row_keys[0], fits);
	for (uint64_t left = fits; left; left &= left - 1)
		block_count = eskel_key_blocks_add(keys, block_count, row_keys[__builtin_ctzll(left)], 1);
	return block_count;
}

static size_t collect(const esk_catalogue *c, const condition *of, eskel_key_block *keys)
{
	uint8_t bytes[AT_ONCE];
	size_t blocks = 0;
	for (size_t first = 0; first < c->count; first += AT_ONCE) {
		const size_t count = c->count - first < AT_ONCE ? c->count - first : AT_ONCE;
		test_columns(c, of, first, bytes);
		uint64_t fits = bits_of(bytes);
		if (fits && of->filter->attribute_count)
			fits = keep_attributes(c, of, first, fits);
		if (fits)
			blocks = add_keys(c->keys + first, count, fits, keys, blocks);
	}
	return blocks;
}

/* A key needs no more than a block, nor do 64 that might lie between the first and the last. Room for all of them could be so
 * much that it comes from the system anew, and goes back, with each filter. */
static size_t most_blocks(const esk_catalogue *c)
{
	if (c->count == 0)
		return 1;
	const uint64_t between = ((uint64_t)c->keys[c->count - 1] - (uint64_t)c->keys[0]) / 64 + 2;
	return between < c->count ? (size_t)between : c->count;
}

/* The caller has the lock. */
static bool find_keys(const esk_catalogue *c, const eskel_filter *filter, eskel_key_block **keys, size_t *block_count)
{
	bool possible = true;
	condition *of = make_condition(c, filter, &possible);
	eskel_key_block *found = of ? malloc(most_blocks(c) * sizeof *found) : NULL;
	if (found) {
		*block_count = possible ? collect(c, of, found) : 0;
		*keys = found;
	}
	free(of);
	return found;
}

bool esk_catalogue_keys(
	esk_catalogue *catalogue, const eskel_filter *filter, eskel_key_block **keys, size_t *block_count)
{
	if (!catalogue || filter->text)
		return false;
	pthread_rwlock_rdlock(&catalogue->lock);
	bool good = catalogue->whole && find_keys(catalogue, filter, keys, block_count);
	pthread_rwlock_unlock(&catalogue->lock);
	return good;
}

/* ---- changes */

void esk_catalogue_put(esk_catalogue *catalogue, int64_t key, const eskel_description *description)
{
	esk_catalogue *c = catalogue;
	pthread_rwlock_wrlock(&c->lock);
	size_t row = find(c, key);
	if (row < c->count && c->keys[row] == key) {
		clear_row(c, row);
	} else if (row == c->count && reserve(c)) {
		c->keys[c->count++] = key;
		c->live[row] = true;
		c->classes[row] = c->subjects[row] = ESK_SYMBOL_NONE;
		c->attributes[row] = NULL;
	} else {
		c->whole = false;
	}
	if (c->whole && !set_row(c, row, description))
		c->whole = false;
	pthread_rwlock_unlock(&c->lock);
}

void esk_catalogue_remove(esk_catalogue *catalogue, int64_t key)
{
	esk_catalogue *c = catalogue;
	pthread_rwlock_wrlock(&c->lock);
	size_t row = find(c, key);
	if (row < c->count && c->keys[row] == key && c->live[row]) {
		clear_row(c, row);
		c->live[row] = false;
		if (++c->dead > c->count / 2)
			bury(c);
	}
	pthread_rwlock_unlock(&c->lock);
}

bool esk_catalogue_is_whole(esk_catalogue *catalogue)
{
	pthread_rwlock_rdlock(&catalogue->lock);
	bool whole = catalogue->whole;
	pthread_rwlock_unlock(&catalogue->lock);
	return whole;
}

/* ---- life */

/* A change that waits goes before filters that come later, or it might wait for ever. */
static void init_lock(pthread_rwlock_t *lock)
{
	pthread_rwlockattr_t options;
	pthread_rwlockattr_init(&options);
	pthread_rwlockattr_setkind_np(&options, PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP);
	pthread_rwlock_init(lock, &options);
	pthread_rwlockattr_destroy(&options);
}

esk_catalogue *esk_catalogue_new(void)
{
	esk_catalogue *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	init_lock(&made->lock);
	made->whole = true;
	return made;
}

void esk_catalogue_free(esk_catalogue *catalogue)
{
	esk_catalogue *c = catalogue;
	if (!c)
		return;
	for (size_t row = 0; row < c->count; row++)
		free(c->attributes[row]);
	esk_symbols_clear(&c->symbols);
	free(c->keys);
	free(c->live);
	free(c->sides);
	free(c->sexes);
	free(c->classes);
	free(c->subjects);
	free(c->ages);
	for (int i = 0; i < FEW; i++)
		free(c->few[i]);
	free(c->attributes);
	pthread_rwlock_destroy(&c->lock);
	free(c);
}
