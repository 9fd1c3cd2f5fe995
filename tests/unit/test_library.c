#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "library.h"
#include "synthetic.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

static eskel_library *new_library(void)
{
	eskel_library *library = NULL;
	assert_int_equal(eskel_library_new(&library), ESKEL_OK);
	return library;
}

/* The key at distance 0 from a signature, or -1. */
static int64_t find(const eskel_library *library, const eskel_signature *signature)
{
	eskel_search_result *result = NULL;
	const eskel_search_options options = {.mode = ESKEL_SEARCH_EXACT, .limit = 1};
	assert_int_equal(eskel_library_search(library, signature, &options, &result), ESKEL_OK);
	int64_t key = result->count && result->neighbours[0].distance == 0 ? result->neighbours[0].key : -1;
	eskel_search_result_free(result);
	return key;
}

static void a_shape_is_found_between_its_addition_and_its_removal(void **state)
{
	(void)state;
	eskel_library *library = new_library();
	eskel_signature *a = synthetic_signature(1, 1, 0.1, 8), *b = synthetic_signature(1, 2, 0.1, 8);
	assert_int_equal(find(library, a), -1);
	assert_int_equal(eskel_library_add(library, 70, a), ESKEL_OK);
	assert_int_equal(eskel_library_add(library, -3, b), ESKEL_OK);
	assert_int_equal(eskel_library_count(library), 2);
	assert_int_equal(find(library, a), 70);
	assert_int_equal(find(library, b), -3);
	assert_int_equal(eskel_library_remove(library, 70), ESKEL_OK);
	assert_int_equal(eskel_library_count(library), 1);
	assert_int_equal(find(library, a), -1);
	assert_int_equal(find(library, b), -3);
	eskel_signature_free(a);
	eskel_signature_free(b);
	eskel_library_free(library);
}

static void a_key_is_unique_until_it_is_removed(void **state)
{
	(void)state;
	eskel_library *library = new_library();
	eskel_signature *a = synthetic_signature(1, 1, 0.1, 8), *b = synthetic_signature(1, 2, 0.1, 8);
	assert_int_equal(eskel_library_remove(library, 5), ESKEL_NOT_FOUND);
	assert_int_equal(eskel_library_add(library, 5, a), ESKEL_OK);
	assert_int_equal(eskel_library_add(library, 5, b), ESKEL_INVALID);
	assert_int_equal(find(library, b), -1);
	assert_int_equal(eskel_library_remove(library, 5), ESKEL_OK);
	assert_int_equal(eskel_library_remove(library, 5), ESKEL_NOT_FOUND);
	assert_int_equal(eskel_library_add(library, 5, b), ESKEL_OK);
	assert_int_equal(find(library, b), 5);
	assert_int_equal(eskel_library_count(library), 1);
	eskel_signature_free(a);
	eskel_signature_free(b);
	eskel_library_free(library);
}

static size_t slots_held(const eskel_library *library)
{
	esk_snapshot snapshot = esk_library_snapshot(library);
	size_t slots = 0;
	for (uint32_t c = 0; c < snapshot.directory->chunk_count; c++)
		slots += snapshot.directory->chunks[c]->capacity;
	esk_directory_release(snapshot.directory);
	return slots;
}

static void a_library_equals_a_plain_list_after_any_additions_and_removals(void **state)
{
	(void)state;
	enum { keys = 1500, rounds = 12000 };
	eskel_library *library = new_library();
	eskel_signature *signatures[40];
	static int held[keys]; /* 0: not there, else 1 + the signature's number */
	uint64_t random = 11;
	size_t count = 0;
	for (uint64_t n = 0; n < 40; n++)
		signatures[n] = synthetic_signature(n, n, 0, 1 + (uint32_t)n % 5);
	for (int round = 0; round < rounds; round++) {
		/* Fills up, empties, fills up, empties. */
		const uint64_t additions_in_8 = round / 3000 % 2 ? 1 : 7;
		uint64_t key = synthetic_random(&random) % keys;
		bool add = synthetic_random(&random) % 8 < additions_in_8;
		int which = (int)(synthetic_random(&random) % 40);
		if (add) {
			assert_int_equal(eskel_library_add(library, (int64_t)key, signatures[which]),
				held[key] ? ESKEL_INVALID : ESKEL_OK);
			count += !held[key];
			held[key] = held[key] ? held[key] : 1 + which;
		} else {
			assert_int_equal(
				eskel_library_remove(library, (int64_t)key), held[key] ? ESKEL_OK : ESKEL_NOT_FOUND);
			count -= held[key] != 0;
			held[key] = 0;
		}
		assert_int_equal(eskel_library_count(library), count);
	}
	for (int64_t key = 0; key < keys; key++) {
		double distance;
		eskel_status status = eskel_library_distances(library, &key, 1, &key, 1, NULL, &distance);
		assert_int_equal(status, held[key] ? ESKEL_OK : ESKEL_NOT_FOUND);
	}
	/* Each shape is the one that was added: a search from it finds its key among those at distance 0. */
	for (int n = 0; n < 40; n++) {
		eskel_search_result *result = NULL;
		assert_int_equal(
			eskel_library_search(library, signatures[n], &(eskel_search_options){.limit = keys}, &result),
			ESKEL_OK);
		assert_int_equal(result->count, count);
		for (size_t i = 0; i < count; i++)
			if ((result->neighbours[i].distance == 0) != (held[result->neighbours[i].key] == 1 + n))
				fail_msg("key %d holds signature %d, at distance %g from %d",
					(int)result->neighbours[i].key, held[result->neighbours[i].key] - 1,
					result->neighbours[i].distance, n);
		eskel_search_result_free(result);
	}
	for (int n = 0; n < 40; n++)
		eskel_signature_free(signatures[n]);
	eskel_library_free(library);
}

static void removals_give_memory_back(void **state)
{
	(void)state;
	eskel_library *library = new_library();
	eskel_signature *signature = synthetic_signature(1, 1, 0.1, 3);
	for (int64_t key = 0; key < 5000; key++)
		assert_int_equal(eskel_library_add(library, key, signature), ESKEL_OK);
	for (int64_t key = 0; key < 4900; key++)
		assert_int_equal(eskel_library_remove(library, key), ESKEL_OK);
	if (slots_held(library) > 600)
		fail_msg("%zu slots for 100 shapes", slots_held(library));
	assert_int_equal(eskel_library_count(library), 100);
	for (int64_t key = 4900; key < 5000; key++)
		assert_int_equal(eskel_library_remove(library, key), ESKEL_OK);
	assert_int_equal(find(library, signature), -1);
	assert_int_equal(eskel_library_add(library, 1, signature), ESKEL_OK);
	assert_int_equal(find(library, signature), 1);
	eskel_signature_free(signature);
	eskel_library_free(library);
}

/* Whole chunks disappear from the middle, so that others take their places and their shapes get other numbers. */
static void keys_are_found_when_chunks_have_changed_places(void **state)
{
	(void)state;
	enum { chunks = 6, keys = chunks * ESK_CHUNK_SLOTS - 100 };
	eskel_library *library = new_library();
	eskel_signature *signature = synthetic_signature(1, 1, 0.1, 1);
	static bool held[keys];
	for (int64_t key = 0; key < keys; key++) {
		assert_int_equal(eskel_library_add(library, key, signature), ESKEL_OK);
		held[key] = true;
	}
	static const int gone[] = {1, 4, 3, 5, 0, 2};
	for (int g = 0; g < chunks; g++) {
		for (int64_t key = gone[g] * ESK_CHUNK_SLOTS; key < (gone[g] + 1) * ESK_CHUNK_SLOTS && key < keys;
			key++) {
			assert_int_equal(eskel_library_remove(library, key), ESKEL_OK);
			held[key] = false;
		}
		for (int64_t key = 0; key < keys; key++) {
			double distance;
			eskel_status status = eskel_library_distances(library, &key, 1, &key, 1, NULL, &distance);
			assert_int_equal(status, held[key] ? ESKEL_OK : ESKEL_NOT_FOUND);
			if (held[key])
				assert_int_equal(eskel_library_add(library, key, signature), ESKEL_INVALID);
			else
				assert_int_equal(eskel_library_remove(library, key), ESKEL_NOT_FOUND);
		}
	}
	assert_int_equal(eskel_library_count(library), 0);
	eskel_signature_free(signature);
	eskel_library_free(library);
}

static void a_snapshot_stays_as_it_was(void **state)
{
	(void)state;
	eskel_library *library = new_library();
	eskel_signature *signature = synthetic_signature(1, 1, 0.1, 3);
	for (int64_t key = 0; key < 300; key++)
		assert_int_equal(eskel_library_add(library, key, signature), ESKEL_OK);
	assert_int_equal(eskel_library_remove(library, 17), ESKEL_OK);
	esk_snapshot snapshot = esk_library_snapshot(library);
	for (int64_t key = 0; key < 300; key++)
		if (key != 17)
			assert_int_equal(eskel_library_remove(library, key), ESKEL_OK);
	for (int64_t key = 1000; key < 1100; key++)
		assert_int_equal(eskel_library_add(library, key, signature), ESKEL_OK);
	size_t seen = 0;
	for (uint32_t c = 0; c < snapshot.directory->chunk_count; c++) {
		uint64_t visible[ESK_CHUNK_WORDS];
		esk_snapshot_visible(&snapshot, c, visible);
		for (uint32_t slot = 0; slot < ESK_CHUNK_SLOTS; slot++)
			if (visible[slot / 64] >> slot % 64 & 1) {
				int64_t key = esk_snapshot_key(&snapshot, esk_snapshot_id(c, slot));
				assert_true(key >= 0 && key < 300 && key != 17);
				seen++;
			}
	}
	assert_int_equal(seen, 299);
	assert_int_equal(snapshot.shape_count, 299);
	esk_directory_release(snapshot.directory);
	eskel_signature_free(signature);
	eskel_library_free(library);
}

static void a_prepared_shape_is_in_the_library_once_it_is_added(void **state)
{
	(void)state;
	eskel_library *library = new_library();
	eskel_signature *a = synthetic_signature(1, 1, 0.1, 8), *b = synthetic_signature(1, 2, 0.1, 8);
	eskel_prepared *first = NULL, *second = NULL, *unused = NULL;
	assert_int_equal(eskel_library_prepare(library, a, &first), ESKEL_OK);
	assert_int_equal(eskel_library_prepare(library, b, &second), ESKEL_OK);
	assert_int_equal(eskel_library_prepare(library, b, &unused), ESKEL_OK);
	assert_int_equal(eskel_library_count(library), 0);
	assert_int_equal(eskel_library_add_prepared(library, 9, second), ESKEL_OK);
	assert_int_equal(find(library, a), -1);
	assert_int_equal(find(library, b), 9);
	assert_int_equal(eskel_library_add_prepared(library, 9, first), ESKEL_INVALID);
	assert_int_equal(eskel_library_count(library), 1);
	eskel_prepared_free(unused);
	eskel_prepared_free(NULL);
	a->volume = -1;
	assert_int_equal(eskel_library_prepare(library, a, &unused), ESKEL_INVALID);
	eskel_signature_free(a);
	eskel_signature_free(b);
	eskel_library_free(library);
}

/* ---- writers and readers at once; run it with -DESKEL_SANITIZE=thread */

enum { adders = 3, added = 700 };

typedef struct {
	eskel_library *library;
	eskel_signature **signatures; /* [added] */
	int64_t first;
	int taken; /* keys that another had added */
} adder;

/* Adds keys of its own, each followed by one that all adders add, and takes every third of its own away again. */
static void *add_many(void *context)
{
	adder *a = context;
	for (int64_t n = 0; n < added; n++) {
		if (eskel_library_add(a->library, a->first + n, a->signatures[n]) != ESKEL_OK)
			a->taken = -adders * added;
		a->taken += eskel_library_add(a->library, n, a->signatures[n]) == ESKEL_INVALID;
		if (n % 3 == 0 && eskel_library_remove(a->library, a->first + n) != ESKEL_OK)
			a->taken = -adders * added;
	}
	return NULL;
}

static void threads_that_add_at_once_add_each_key_once(void **state)
{
	(void)state;
	static eskel_signature *signatures[added];
	eskel_library *library = new_library();
	pthread_t threads[adders];
	adder work[adders];
	int taken = 0;
	for (int n = 0; n < added; n++)
		signatures[n] = synthetic_signature((uint64_t)n, 1, 0.1, 1 + (uint32_t)n % 6);
	for (int t = 0; t < adders; t++) {
		work[t] = (adder){library, signatures, (t + 1) * 100000, 0};
		assert_int_equal(pthread_create(&threads[t], NULL, add_many, &work[t]), 0);
	}
	for (int t = 0; t < adders; t++) {
		pthread_join(threads[t], NULL);
		taken += work[t].taken;
	}
	assert_int_equal(taken, (adders - 1) * added);
	assert_int_equal(eskel_library_count(library), added + adders * (added - (added + 2) / 3));
	for (int n = 0; n < added; n++) {
		const int64_t keys[2] = {n, 100000 + n};
		double distance = -1;
		eskel_status status = eskel_library_distances(library, keys, 1, keys + 1, 1, NULL, &distance);
		assert_int_equal(status, n % 3 ? ESKEL_OK : ESKEL_NOT_FOUND);
		assert_true(distance == (n % 3 ? 0 : -1));
	}
	for (int n = 0; n < added; n++)
		eskel_signature_free(signatures[n]);
	eskel_library_free(library);
}

enum { stable = 50, moving = 10, changes = 3000, movers_key = 1000 };

typedef struct {
	eskel_library *library;
	eskel_signature *signatures[stable + moving];
	atomic_bool done;
	atomic_int wrong;
} scene;

/* Gives every moving shape a new key again and again: the new one is added before the old one is removed, so at any
 * moment the shape is there once or twice. */
static void *write_changes(void *context)
{
	scene *s = context;
	int64_t key_of[moving];
	for (int m = 0; m < moving; m++)
		key_of[m] = movers_key + m;
	for (int64_t n = 0; n < changes; n++) {
		int m = (int)(n % moving);
		int64_t new_key = movers_key + moving + n;
		if (eskel_library_add(s->library, new_key, s->signatures[stable + m]) != ESKEL_OK ||
			eskel_library_remove(s->library, key_of[m]) != ESKEL_OK)
			atomic_fetch_add(&s->wrong, 1);
		key_of[m] = new_key;
	}
	atomic_store(&s->done, true);
	return NULL;
}

static bool sees_all(const scene *s, int which, eskel_search_mode mode, eskel_scale scale)
{
	eskel_search_result *result = NULL;
	const eskel_search_options options = {.mode = mode, .scale = scale, .limit = 3};
	if (eskel_library_search(s->library, s->signatures[which], &options, &result) != ESKEL_OK)
		return false;
	const int64_t key = result->neighbours[0].key;
	bool right = result->library == stable + moving || result->library == stable + moving + 1;
	right = right && result->neighbours[0].distance == 0;
	right = right && (which < stable ? key == which : key >= movers_key);
	eskel_search_result_free(result);
	return right;
}

static void *read_changes(void *context)
{
	scene *s = context;
	const int64_t keys[3] = {0, 20, 49};
	double distances[9];
	for (int n = 0; n < 10 || !atomic_load(&s->done); n++) {
		if (!sees_all(s, n % (stable + moving), (eskel_search_mode)(n % 2), (eskel_scale)(n % 3 == 0)))
			atomic_fetch_add(&s->wrong, 1);
		if (eskel_library_distances(s->library, keys, 3, keys, 3, NULL, distances) != ESKEL_OK)
			atomic_fetch_add(&s->wrong, 1);
	}
	return NULL;
}

static void searches_see_a_whole_library_while_it_changes(void **state)
{
	(void)state;
	static scene s;
	s.library = new_library();
	for (int n = 0; n < stable + moving; n++) {
		s.signatures[n] = synthetic_signature((uint64_t)n, 1, 0.1, 4);
		int64_t key = n < stable ? n : movers_key + n - stable;
		assert_int_equal(eskel_library_add(s.library, key, s.signatures[n]), ESKEL_OK);
	}
	pthread_t writer, readers[2];
	assert_int_equal(pthread_create(&writer, NULL, write_changes, &s), 0);
	for (int r = 0; r < 2; r++)
		assert_int_equal(pthread_create(&readers[r], NULL, read_changes, &s), 0);
	pthread_join(writer, NULL);
	for (int r = 0; r < 2; r++)
		pthread_join(readers[r], NULL);
	assert_int_equal(atomic_load(&s.wrong), 0);
	assert_int_equal(eskel_library_count(s.library), stable + moving);
	for (int n = 0; n < stable + moving; n++)
		eskel_signature_free(s.signatures[n]);
	eskel_library_free(s.library);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_shape_is_found_between_its_addition_and_its_removal),
		cmocka_unit_test(a_key_is_unique_until_it_is_removed),
		cmocka_unit_test(a_library_equals_a_plain_list_after_any_additions_and_removals),
		cmocka_unit_test(removals_give_memory_back),
		cmocka_unit_test(keys_are_found_when_chunks_have_changed_places),
		cmocka_unit_test(a_snapshot_stays_as_it_was),
		cmocka_unit_test(a_prepared_shape_is_in_the_library_once_it_is_added),
		cmocka_unit_test(threads_that_add_at_once_add_each_key_once),
		cmocka_unit_test(searches_see_a_whole_library_while_it_changes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
