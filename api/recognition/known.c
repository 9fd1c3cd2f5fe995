/* Shapes in memory, see known.h: a list in the order of use and two hash tables, under one lock. A shape in use outlives
 * its place in the list. */
#include "known.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct entry {
	esk_known_shape known; /* first: an entry is its shape */
	size_t size;
	size_t users;
	bool listed;
	struct entry *older, *newer;
	struct entry *next_of_key, *next_of_id; /* in a bucket */
} entry;

struct esk_known {
	eskel_store *store;
	pthread_mutex_t lock;
	uint64_t most_bytes, bytes;
	uint64_t drops; /* so far */
	entry *newest, *oldest;
	size_t mask; /* the number of buckets less 1 */
	entry **of_key, **of_id;
};

/* ---- one entry */

static void free_entry(entry *e)
{
	if (!e)
		return;
	eskel_position_signature_free(e->known.positions);
	eskel_placement_free(e->known.placement);
	eskel_signature_free(e->known.signature);
	eskel_shape_clear(&e->known.shape);
	free(e);
}

static size_t text_size(const char *text)
{
	return text ? strlen(text) + 1 : 0;
}

static size_t size_of(const entry *e)
{
	const eskel_shape *shape = &e->known.shape;
	const eskel_description *said = &shape->description;
	const eskel_signature *signature = e->known.signature;
	size_t size = sizeof *e + eskel_placement_size(e->known.placement) +
		      eskel_position_signature_size(e->known.positions) + sizeof *signature +
		      ESKEL_NODES(signature->level_count) * sizeof *signature->rows;
	size += text_size(said->name) + text_size(said->class) + text_size(said->subject);
	size += shape->warning_count * sizeof *shape->warnings + said->attribute_count * sizeof *said->attributes;
	for (size_t i = 0; i < said->attribute_count; i++)
		size += text_size(said->attributes[i].key) + text_size(said->attributes[i].value);
	return size;
}

static eskel_store_status read_objects(eskel_store *store, entry *e, eskel_store_error *error)
{
	eskel_skeleton *skeleton = NULL;
	eskel_store_status status = eskel_store_signature(store, e->known.shape.key, &e->known.signature, error);
	if (status == ESKEL_STORE_OK)
		status = eskel_store_skeleton(store, e->known.shape.key, &skeleton, error);
	if (status == ESKEL_STORE_OK &&
		(eskel_placement_new(skeleton, &e->known.placement) != ESKEL_OK ||
			eskel_position_signature_new(skeleton, &e->known.positions) != ESKEL_OK))
		status = ESKEL_STORE_NO_MEMORY;
	eskel_skeleton_free(skeleton);
	return status;
}

/* By the id, or by the key when that is NULL. */
static eskel_store_status read_entry(
	eskel_store *store, const char *id, int64_t key, entry **e, eskel_store_error *error)
{
	entry *made = calloc(1, sizeof *made);
	if (!made)
		return ESKEL_STORE_NO_MEMORY;
	eskel_store_status status = id ? eskel_store_shape(store, id, &made->known.shape, error)
				       : eskel_store_shape_by_key(store, key, &made->known.shape, error);
	if (status == ESKEL_STORE_OK)
		status = read_objects(store, made, error);
	if (status != ESKEL_STORE_OK) {
		free_entry(made);
		return status;
	}
	made->size = size_of(made);
	*e = made;
	return ESKEL_STORE_OK;
}

/* ---- the list and the tables; the caller has the lock */

static entry **bucket_of_key(const esk_known *known, int64_t key)
{
	return &known->of_key[(size_t)key & known->mask];
}

/* An id is the hex text of a digest: any part of it is as good as the rest. */
static entry **bucket_of_id(const esk_known *known, const char *id)
{
	uint64_t part;
	memcpy(&part, id, sizeof part);
	return &known->of_id[part * UINT64_C(0x9e3779b97f4a7c15) >> 32 & known->mask];
}

static entry *find(const esk_known *known, const char *id, int64_t key)
{
	entry *e = id ? *bucket_of_id(known, id) : *bucket_of_key(known, key);
	if (id)
		while (e && strcmp(e->known.shape.id, id) != 0)
			e = e->next_of_id;
	else
		while (e && e->known.shape.key != key)
			e = e->next_of_key;
	return e;
}

static void unlink_from_list(esk_known *known, entry *e)
{
	*(e->newer ? &e->newer->older : &known->newest) = e->older;
	*(e->older ? &e->older->newer : &known->oldest) = e->newer;
}

static void make_newest(esk_known *known, entry *e)
{
	e->newer = NULL;
	e->older = known->newest;
	*(e->older ? &e->older->newer : &known->oldest) = e;
	known->newest = e;
}

static void list(esk_known *known, entry *e)
{
	entry **of_key = bucket_of_key(known, e->known.shape.key), **of_id = bucket_of_id(known, e->known.shape.id);
	e->next_of_key = *of_key;
	e->next_of_id = *of_id;
	*of_key = *of_id = e;
	make_newest(known, e);
	e->listed = true;
	known->bytes += e->size;
}

static void unlist(esk_known *known, entry *e)
{
	entry **of_key = bucket_of_key(known, e->known.shape.key), **of_id = bucket_of_id(known, e->known.shape.id);
	while (*of_key != e)
		of_key = &(*of_key)->next_of_key;
	*of_key = e->next_of_key;
	while (*of_id != e)
		of_id = &(*of_id)->next_of_id;
	*of_id = e->next_of_id;
	unlink_from_list(known, e);
	e->listed = false;
	known->bytes -= e->size;
	if (!e->users)
		free_entry(e);
}

/* ---- use */

static entry *take(esk_known *known, const char *id, int64_t key, uint64_t *drops)
{
	pthread_mutex_lock(&known->lock);
	entry *e = find(known, id, key);
	if (e) {
		unlink_from_list(known, e);
		make_newest(known, e);
		e->users++;
	}
	*drops = known->drops;
	pthread_mutex_unlock(&known->lock);
	return e;
}

/* Takes a new entry, which is kept unless somebody else has read the same shape meanwhile, or dropped any. */
static void keep(esk_known *known, entry *e, uint64_t drops)
{
	e->users = 1;
	pthread_mutex_lock(&known->lock);
	if (known->drops == drops && !find(known, NULL, e->known.shape.key))
		list(known, e);
	while (known->bytes > known->most_bytes)
		unlist(known, known->oldest);
	pthread_mutex_unlock(&known->lock);
}

static eskel_store_status get(
	esk_known *known, const char *id, int64_t key, const esk_known_shape **shape, eskel_store_error *error)
{
	uint64_t drops = 0;
	entry *e = take(known, id, key, &drops);
	if (!e) {
		eskel_store_status status = read_entry(known->store, id, key, &e, error);
		if (status != ESKEL_STORE_OK)
			return status;
		keep(known, e, drops);
	}
	*shape = &e->known;
	return ESKEL_STORE_OK;
}

eskel_store_status esk_known_by_id(
	esk_known *known, const char *id, const esk_known_shape **shape, eskel_store_error *error)
{
	return get(known, id, 0, shape, error);
}

eskel_store_status esk_known_by_key(
	esk_known *known, int64_t key, const esk_known_shape **shape, eskel_store_error *error)
{
	return get(known, NULL, key, shape, error);
}

void esk_known_release(esk_known *known, const esk_known_shape *shape)
{
	entry *e = (entry *)shape;
	if (!e)
		return;
	pthread_mutex_lock(&known->lock);
	bool last = --e->users == 0 && !e->listed;
	pthread_mutex_unlock(&known->lock);
	if (last)
		free_entry(e);
}

void esk_known_drop(esk_known *known, int64_t key)
{
	pthread_mutex_lock(&known->lock);
	entry *e = find(known, NULL, key);
	if (e)
		unlist(known, e);
	known->drops++;
	pthread_mutex_unlock(&known->lock);
}

/* ---- life */

esk_known *esk_known_new(eskel_store *store, uint64_t most_bytes)
{
	enum { BYTES_A_BUCKET = 16384 }; /* less than an entry */
	size_t buckets = 1;
	while (buckets < most_bytes / BYTES_A_BUCKET)
		buckets *= 2;
	esk_known *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	made->store = store;
	made->most_bytes = most_bytes;
	made->mask = buckets - 1;
	made->of_key = calloc(buckets, sizeof *made->of_key);
	made->of_id = calloc(buckets, sizeof *made->of_id);
	pthread_mutex_init(&made->lock, NULL);
	if (made->of_key && made->of_id)
		return made;
	esk_known_free(made);
	return NULL;
}

void esk_known_free(esk_known *known)
{
	if (!known)
		return;
	while (known->newest)
		unlist(known, known->newest);
	pthread_mutex_destroy(&known->lock);
	free(known->of_key);
	free(known->of_id);
	free(known);
}
