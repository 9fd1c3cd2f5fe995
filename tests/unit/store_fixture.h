/* A test with a store of its own: store_set_up and store_tear_down are cmocka's, *state is the fixture. */
#ifndef STORE_FIXTURE_H
#define STORE_FIXTURE_H

#include "eskel_store.h"

typedef struct {
	char *folder, *path;
	eskel_store *store;
	eskel_store_error error;
} store_fixture;

int store_set_up(void **state);
int store_tear_down(void **state);

void store_reopen(store_fixture *f);
/* Closes the store, runs SQL as somebody behind its back would, and opens it again. */
void store_edit(store_fixture *f, const char *sql);
/* The same for a database that no store has open. */
void database_edit(const char *path, const char *sql);

/* Every signature, in the order of keys, until each says false. */
eskel_store_status store_each_signature(eskel_store *store,
	bool (*each)(void *context, int64_t key, uint32_t level_count), void *context, eskel_store_error *error);

#define store_test(name) cmocka_unit_test_setup_teardown(name, store_set_up, store_tear_down)

/* Fails with the store's own sentence. */
#define assert_ok(status, f) \
	do { \
		if ((status) != ESKEL_STORE_OK) \
			fail_msg("%s", (f)->error.text); \
	} while (0)

#endif
