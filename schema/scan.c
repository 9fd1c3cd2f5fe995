/* The scan of all signatures with which a library is filled.
 *
 * Shapes are stored one after the other, so the pages of the signatures lie scattered among those of clouds and
 * skeletons, and a scan of a file that is not in memory waits for the disk at each of them; and every signature is
 * verified, decoded and made into what the visitor wants. So a few threads take the keys stride by stride and read ahead of
 * the caller, who takes the strides in their order: the disk has many pages to look for at a time, and all processors work.
 *
 * Stride n lies in slot n % SLOTS from the time that a thread has taken it until the caller has passed it. */
#include "array.h"
#include "object.h"
#include "read.h"
#include "statement.h"
#include "status.h"

#include <stdlib.h>

enum {
	THREADS = 8,
	STRIDE = 256, /* keys */
	SLOTS = 32    /* read ahead at most: what is made of 8,192 signatures */
};

typedef struct {
	int64_t key;
	void *made;
} row;

typedef struct {
	bool ready;
	size_t count;
	row *rows;
	eskel_store_status status; /* of reading them */
	eskel_store_error error;
} stride;

typedef struct {
	const eskel_signature_visitor *visitor;
	int64_t last;         /* the last key that there is */
	pthread_mutex_t lock; /* of all below */
	pthread_cond_t changed;
	int64_t next, passed; /* strides taken by threads, passed by the caller */
	bool stop;
	stride slots[SLOTS];
} scan;

typedef struct {
	scan *scan;
	sqlite3 *db;
	pthread_t thread;
} reader;

/* ---- one stride */

static eskel_store_status read_row(
	esk_statement *s, const eskel_signature_visitor *visitor, row *out, eskel_store_error *error)
{
	esk_object_row object;
	eskel_signature *signature = NULL;
	eskel_store_status status = esk_object_read(s, ESK_OBJECT_SIGNATURE, &object, error);
	if (status != ESKEL_STORE_OK)
		return status;
	eskel_status decoded = eskel_signature_decode(object.bytes, object.size, &signature, NULL);
	if (decoded != ESKEL_OK)
		return esk_object_decoded(decoded, ESK_OBJECT_SIGNATURE, object.shape, error);
	*out = (row){.key = object.shape, .made = visitor->make(visitor->context, signature)};
	eskel_signature_free(signature);
	return out->made ? ESKEL_STORE_OK : esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
}

static void clear(const scan *of, stride *s)
{
	for (size_t i = 0; i < s->count; i++)
		if (s->rows[i].made)
			of->visitor->drop(s->rows[i].made);
	free(s->rows);
	*s = (stride){.ready = false};
}

/* Reads what is stored under the keys of stride n, into an empty one: those before a failure, and the failure. */
static void read_stride(const scan *of, sqlite3 *db, int64_t n, stride *out)
{
	eskel_store_status status = ESKEL_STORE_OK;
	esk_statement s = esk_statement_begin(
		db, "SELECT shape, sha256, bytes FROM signature WHERE shape > ? AND shape <= ? ORDER BY shape");
	esk_bind_int64(&s, n * STRIDE);
	esk_bind_int64(&s, (n + 1) * STRIDE);
	while (status == ESKEL_STORE_OK && esk_statement_row(&s)) {
		row read = {0};
		if (!esk_array_grow((void **)&out->rows, out->count, sizeof out->rows[0]))
			status = esk_status_fail(&out->error, ESKEL_STORE_NO_MEMORY, "memory ran out");
		else
			status = read_row(&s, of->visitor, &read, &out->error);
		if (status == ESKEL_STORE_OK)
			out->rows[out->count++] = read;
	}
	eskel_store_status ended = esk_statement_end(&s, status == ESKEL_STORE_OK ? &out->error : NULL);
	out->status = status == ESKEL_STORE_OK ? ended : status;
}

/* ---- threads that read ahead */

/* The next stride that there is room for, -1 when there will be none. */
static int64_t take_stride(scan *s)
{
	int64_t n = -1;
	pthread_mutex_lock(&s->lock);
	while (!s->stop && s->next >= s->passed + SLOTS)
		pthread_cond_wait(&s->changed, &s->lock);
	if (!s->stop && s->next * STRIDE < s->last)
		n = s->next++;
	pthread_mutex_unlock(&s->lock);
	return n;
}

static void *read_ahead(void *context)
{
	reader *r = context;
	scan *s = r->scan;
	int64_t n;
	while ((n = take_stride(s)) >= 0) {
		stride *slot = &s->slots[n % SLOTS];
		read_stride(s, r->db, n, slot);
		pthread_mutex_lock(&s->lock);
		slot->ready = true;
		pthread_cond_broadcast(&s->changed);
		pthread_mutex_unlock(&s->lock);
	}
	return NULL;
}

static void pass_stride(scan *s)
{
	pthread_mutex_lock(&s->lock);
	s->passed++;
	pthread_cond_broadcast(&s->changed);
	pthread_mutex_unlock(&s->lock);
}

/* ---- the caller */

/* Sets *stopped when the visitor wants no more. */
static eskel_store_status take_rows(const scan *of, stride *s, bool *stopped, eskel_store_error *error)
{
	const eskel_signature_visitor *v = of->visitor;
	for (size_t i = 0; i < s->count && !*stopped; i++) {
		void *made = s->rows[i].made;
		s->rows[i].made = NULL;
		*stopped = !v->take(v->context, s->rows[i].key, made);
	}
	if (*stopped || s->status == ESKEL_STORE_OK)
		return ESKEL_STORE_OK;
	return esk_status_fail(error, s->status, "%s", s->error.text);
}

static void wait_for(scan *s, const stride *slot)
{
	pthread_mutex_lock(&s->lock);
	while (!slot->ready)
		pthread_cond_wait(&s->changed, &s->lock);
	pthread_mutex_unlock(&s->lock);
}

/* Without threads the caller reads. */
static eskel_store_status take_all(scan *s, sqlite3 *db, bool threads, eskel_store_error *error)
{
	eskel_store_status status = ESKEL_STORE_OK;
	bool stopped = false;
	for (int64_t n = 0; status == ESKEL_STORE_OK && !stopped && n * STRIDE < s->last; n++) {
		stride *slot = &s->slots[n % SLOTS];
		if (threads)
			wait_for(s, slot);
		else
			read_stride(s, db, n, slot);
		status = take_rows(s, slot, &stopped, error);
		clear(s, slot);
		pass_stride(s);
	}
	return status;
}

static eskel_store_status read_last_key(sqlite3 *db, int64_t *last, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT max(shape) FROM signature");
	if (esk_statement_row(&s))
		*last = esk_column_int64(&s);
	return esk_statement_end(&s, error);
}

static int start(scan *s, sqlite3 *const *dbs, size_t count, reader readers[THREADS])
{
	int started = 0;
	for (size_t i = 0; i < count; i++) {
		readers[started] = (reader){.scan = s, .db = dbs[i]};
		if (pthread_create(&readers[started].thread, NULL, read_ahead, &readers[started]) == 0)
			started++;
	}
	return started;
}

static void stop(scan *s, const reader *readers, int count)
{
	pthread_mutex_lock(&s->lock);
	s->stop = true;
	pthread_cond_broadcast(&s->changed);
	pthread_mutex_unlock(&s->lock);
	for (int i = 0; i < count; i++)
		pthread_join(readers[i].thread, NULL);
	for (int n = 0; n < SLOTS; n++)
		clear(s, &s->slots[n]);
}

eskel_store_status eskel_store_each_signature(
	eskel_store *store, const eskel_signature_visitor *visitor, eskel_store_error *error)
{
	scan s = {.visitor = visitor, .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
	reader readers[THREADS];
	sqlite3 *dbs[THREADS];
	size_t count = THREADS;
	eskel_store_status status = esk_read_begin_together(store, dbs, &count, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = read_last_key(dbs[0], &s.last, error);
	if (status == ESKEL_STORE_OK) {
		/* A few strides are read before threads would be there. */
		int threads = s.last > THREADS * STRIDE ? start(&s, dbs, count, readers) : 0;
		status = take_all(&s, dbs[0], threads > 0, error);
		stop(&s, readers, threads);
	}
	for (size_t i = 0; i < count; i++)
		esk_read_end(store, dbs[i]);
	return status;
}
