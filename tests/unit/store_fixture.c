#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <sqlite3.h>
#include <stdlib.h>

int store_set_up(void **state)
{
	store_fixture *f = calloc(1, sizeof *f);
	f->folder = scratch_new();
	f->path = scratch_path(f->folder, "shapes.db");
	*state = f;
	assert_ok(eskel_store_open(f->path, NULL, &f->store, &f->error), f);
	return 0;
}

int store_tear_down(void **state)
{
	store_fixture *f = *state;
	eskel_store_close(f->store);
	scratch_free(f->folder);
	free(f->path);
	free(f);
	return 0;
}

void store_reopen(store_fixture *f)
{
	eskel_store_close(f->store);
	f->store = NULL;
	assert_ok(eskel_store_open(f->path, NULL, &f->store, &f->error), f);
}

void database_edit(const char *path, const char *sql)
{
	sqlite3 *db = NULL;
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	if (sqlite3_exec(db, sql, NULL, NULL, NULL) != SQLITE_OK)
		fail_msg("%s: %s", sql, sqlite3_errmsg(db));
	sqlite3_close(db);
}

void store_edit(store_fixture *f, const char *sql)
{
	eskel_store_close(f->store);
	f->store = NULL;
	database_edit(f->path, sql);
	assert_ok(eskel_store_open(f->path, NULL, &f->store, &f->error), f);
}

typedef struct {
	bool (*each)(void *context, int64_t key, uint32_t level_count);
	void *context;
} visit;

static void *copy_level_count(void *context, const eskel_signature *signature)
{
	uint32_t *copy = malloc(sizeof *copy);
	(void)context;
	if (copy)
		*copy = signature->level_count;
	return copy;
}

static bool call_each(void *context, int64_t key, void *made)
{
	const visit *v = context;
	const uint32_t level_count = *(uint32_t *)made;
	free(made);
	return v->each(v->context, key, level_count);
}

eskel_store_status store_each_signature(eskel_store *store,
	bool (*each)(void *context, int64_t key, uint32_t level_count), void *context, eskel_store_error *error)
{
	visit v = {each, context};
	const eskel_signature_visitor visitor = {
		.make = copy_level_count, .take = call_each, .drop = free, .context = &v};
	return eskel_store_each_signature(store, &visitor, error);
}
