#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A library in which every value of every field meets the others, and the filters that the tests ask; each answer is
 * compared with a plain walk over all descriptions. */
enum { library_size = 240 };

static const char *const names[] = {NULL, "Left femur", "femur 100%", "FEMUR_x", "a_b", ""};
static const char *const classes[] = {NULL, "femur", "tibia", "Talus"};
static const char *const subjects[] = {NULL, "s1", "s2", "S1"};
static const double ages[] = {NAN, 0, 30, 30.5, 80};
static eskel_attribute site_1[] = {{"scanner", "ct"}, {"site", "1"}};
static eskel_attribute site_2[] = {{"site", "2"}};
static eskel_attribute many[] = {{"a", "1"}, {"b", "1"}, {"c", "1"}, {"scanner", "ct"}, {"site", "2"}, {"t", "1"}};

static const struct {
	size_t count;
	eskel_attribute *attributes;
} attribute_sets[] = {{0, NULL}, {2, site_1}, {1, site_2}, {6, many}};

#define PICK(array, number) (array)[(number) % (sizeof(array) / sizeof((array)[0]))]

static uint32_t random_number(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}

static eskel_description random_description(uint64_t *seed)
{
	uint32_t set = random_number(seed) % 4;
	return (eskel_description){
		.name = (char *)PICK(names, random_number(seed)),
		.class = (char *)PICK(classes, random_number(seed)),
		.subject = (char *)PICK(subjects, random_number(seed)),
		.side = (eskel_side)(random_number(seed) % 4),
		.sex = (eskel_sex)(random_number(seed) % 3),
		.age = PICK(ages, random_number(seed)),
		.attribute_count = attribute_sets[set].count,
		.attributes = attribute_sets[set].attributes,
	};
}

typedef struct {
	store_fixture *store;
	int64_t keys[library_size];
	eskel_description descriptions[library_size];
	char ids[library_size][ESKEL_ID_SIZE];
	bool deleted[library_size];
} library;

/* When the store begins to keep descriptions in memory: each test finds the same by SQL alone, by what was loaded, and by
 * what was put there by enrollments. */
typedef enum { NEVER, AFTER_ENROLLMENT, BEFORE_ENROLLMENT } keeping;

static void keep(library *l)
{
	assert_ok(eskel_store_keep_descriptions(l->store->store, &l->store->error), l->store);
}

static int set_up_library(void **state, keeping when)
{
	library *l = calloc(1, sizeof *l);
	store_set_up((void **)&l->store);
	if (when == BEFORE_ENROLLMENT)
		keep(l);
	uint64_t seed = 7;
	sample samples[library_size];
	eskel_enrollment enrollments[library_size];
	eskel_shape shapes[library_size];
	bool created[library_size];
	for (uint32_t i = 0; i < library_size; i++) {
		l->descriptions[i] = random_description(&seed);
		samples[i] = sample_new(i);
		samples[i].description = l->descriptions[i];
		enrollments[i] = sample_enrollment(&samples[i], 1);
	}
	assert_ok(
		eskel_store_enroll(l->store->store, NULL, enrollments, library_size, shapes, created, &l->store->error),
		l->store);
	for (int i = 0; i < library_size; i++) {
		l->keys[i] = shapes[i].key;
		memcpy(l->ids[i], shapes[i].id, sizeof l->ids[i]);
		eskel_shape_clear(&shapes[i]);
		sample_free(&samples[i]);
	}
	if (when == AFTER_ENROLLMENT)
		keep(l);
	*state = l;
	return 0;
}

static int set_up(void **state)
{
	return set_up_library(state, NEVER);
}

static int set_up_kept(void **state)
{
	return set_up_library(state, AFTER_ENROLLMENT);
}

static int set_up_put(void **state)
{
	return set_up_library(state, BEFORE_ENROLLMENT);
}

static int tear_down(void **state)
{
	library *l = *state;
	store_tear_down((void **)&l->store);
	free(l);
	return 0;
}

static bool equal(const char *wanted, const char *value)
{
	return !wanted || (value && strcmp(wanted, value) == 0);
}

static bool contains(const char *part, const char *text)
{
	size_t length = strlen(part);
	for (; text && *text; text++)
		if (strncasecmp(text, part, length) == 0)
			return true;
	return text && length == 0;
}

static bool has_attribute(const eskel_description *d, const eskel_attribute *wanted)
{
	for (size_t i = 0; i < d->attribute_count; i++)
		if (strcmp(d->attributes[i].key, wanted->key) == 0)
			return strcmp(d->attributes[i].value, wanted->value) == 0;
	return false;
}

static bool accepts(const eskel_filter *f, const eskel_description *d)
{
	for (size_t i = 0; i < f->attribute_count; i++)
		if (!has_attribute(d, &f->attributes[i]))
			return false;
	return equal(f->class, d->class) && equal(f->subject, d->subject) &&
	       !(f->not_subject && d->subject && strcmp(f->not_subject, d->subject) == 0) &&
	       (!f->side || f->side == d->side) && (!f->sex || f->sex == d->sex) &&
	       (isnan(f->age_min) || d->age >= f->age_min) && (isnan(f->age_max) || d->age <= f->age_max) &&
	       (!f->text || contains(f->text, d->name) || contains(f->text, d->class) || contains(f->text, d->subject));
}

/* One by one. */
static int64_t *find_keys(library *l, const eskel_filter *f, size_t *count)
{
	eskel_key_block *blocks = NULL;
	size_t block_count = 9;
	assert_ok(eskel_store_keys(l->store->store, f, &blocks, &block_count, &l->store->error), l->store);
	assert_non_null(blocks);
	int64_t *keys = malloc((64 * block_count + 1) * sizeof *keys);
	assert_non_null(keys);
	*count = 0;
	for (size_t b = 0; b < block_count; b++)
		for (int i = 0; i < 64; i++)
			if (blocks[b].members >> i & 1)
				keys[(*count)++] = blocks[b].first + i;
	free(blocks);
	return keys;
}

static void assert_answer_is_that_of_a_plain_walk(library *l, const eskel_filter *f, int number)
{
	size_t count, expected = 0;
	int64_t *keys = find_keys(l, f, &count);
	for (int i = 0; i < library_size; i++) {
		if (l->deleted[i] || !accepts(f, &l->descriptions[i]))
			continue;
		if (expected >= count || keys[expected] != l->keys[i])
			fail_msg("filter %d: key %d is missing or out of order", number, (int)l->keys[i]);
		expected++;
	}
	if (count != expected)
		fail_msg("filter %d: %zu keys, expected %zu", number, count, expected);
	free(keys);
}

static eskel_filter random_filter(uint64_t *seed)
{
	static const char *const texts[] = {"femur", "FEMUR", "%", "_", "s1", "zzz", "100%"};
	eskel_filter f = eskel_filter_none();
	uint32_t which = random_number(seed);
	if (which & 1)
		f.class = PICK(classes, random_number(seed));
	if (which & 2)
		f.subject = PICK(subjects, random_number(seed));
	if (which & 4)
		f.not_subject = PICK(subjects, random_number(seed));
	if (which & 8)
		f.side = (eskel_side)(random_number(seed) % 4);
	if (which & 16)
		f.sex = (eskel_sex)(random_number(seed) % 3);
	if (which & 32)
		f.age_min = PICK(ages, random_number(seed));
	if (which & 64)
		f.age_max = PICK(ages, random_number(seed));
	if (which & 128)
		f.text = PICK(texts, random_number(seed));
	uint32_t set = which & 256 ? random_number(seed) % 4 : 0;
	f.attribute_count = attribute_sets[set].count;
	f.attributes = attribute_sets[set].attributes;
	return f;
}

static void a_thousand_random_filters_find_what_a_plain_walk_finds(void **state)
{
	uint64_t seed = 11;
	for (int i = 0; i < 1000; i++) {
		eskel_filter f = random_filter(&seed);
		assert_answer_is_that_of_a_plain_walk(*state, &f, i);
	}
}

static void each_condition_alone_finds_what_a_plain_walk_finds(void **state)
{
	eskel_filter f[10];
	for (int i = 0; i < 10; i++)
		f[i] = eskel_filter_none();
	f[0].class = "femur";
	f[1].subject = "s1";
	f[2].not_subject = "s1";
	f[3].side = ESKEL_SIDE_NONE;
	f[4].sex = ESKEL_SEX_MALE;
	f[5].age_min = 30.5;
	f[6].age_max = 30;
	f[7].text = "left F";
	f[8].attribute_count = 2;
	f[8].attributes = site_1;
	f[9].text = "";
	for (int i = 0; i < 10; i++) {
		assert_false(eskel_filter_is_none(&f[i]));
		assert_answer_is_that_of_a_plain_walk(*state, &f[i], i);
	}
}

static void describe_anew(library *l, int i, uint64_t *seed)
{
	eskel_shape shape;
	l->descriptions[i] = random_description(seed);
	assert_ok(eskel_store_describe(
			  l->store->store, NULL, l->ids[i], 0, &l->descriptions[i], &shape, &l->store->error),
		l->store);
	eskel_shape_clear(&shape);
}

static void delete (library *l, int i)
{
	assert_ok(eskel_store_delete(l->store->store, NULL, l->ids[i], 0, NULL, &l->store->error), l->store);
	l->deleted[i] = true;
}

/* Until a few of all are left, so that what is kept in memory has been made smaller more than once. */
static void what_changed_is_found_as_it_is_now(void **state)
{
	library *l = *state;
	uint64_t seed = 17;
	for (int i = 0; i < library_size; i++) {
		eskel_filter f = random_filter(&seed);
		int changed = (int)(random_number(&seed) % library_size), gone = 7 * i % library_size;
		if (!l->deleted[changed])
			describe_anew(l, changed, &seed);
		if (gone % 20 != 0)
			delete (l, gone);
		assert_answer_is_that_of_a_plain_walk(l, &f, i);
	}
	for (int i = 0; i < 100; i++) {
		eskel_filter f = random_filter(&seed);
		assert_answer_is_that_of_a_plain_walk(l, &f, i);
	}
}

static void a_change_that_failed_changes_no_answer(void **state)
{
	library *l = *state;
	eskel_filter f = eskel_filter_none();
	eskel_shape shape;
	eskel_description other = l->descriptions[3];
	other.class = (char *)"unheard of";
	assert_int_equal(
		eskel_store_describe(l->store->store, NULL, l->ids[3], 77, &other, &shape, NULL), ESKEL_STORE_CONFLICT);
	assert_int_equal(eskel_store_delete(l->store->store, NULL, l->ids[3], 77, NULL, NULL), ESKEL_STORE_CONFLICT);
	assert_answer_is_that_of_a_plain_walk(l, &f, 0);
	f.class = other.class;
	assert_answer_is_that_of_a_plain_walk(l, &f, 1);
}

static void no_condition_finds_all(void **state)
{
	eskel_filter none = eskel_filter_none();
	assert_true(eskel_filter_is_none(&none));
	assert_answer_is_that_of_a_plain_walk(*state, &none, 0);
}

static void percent_and_underscore_in_a_text_are_themselves(void **state)
{
	library *l = *state;
	eskel_filter f = eskel_filter_none();
	f.text = "%";
	size_t count, with_percent = 0;
	int64_t *keys = find_keys(l, &f, &count);
	for (int i = 0; i < library_size; i++)
		with_percent += l->descriptions[i].name && strchr(l->descriptions[i].name, '%');
	assert_int_equal(count, with_percent);
	assert_true(count < library_size);
	free(keys);
}

static void no_answer_is_an_array_too(void **state)
{
	library *l = *state;
	eskel_filter f = eskel_filter_none();
	f.class = "no such class";
	size_t count;
	int64_t *keys = find_keys(l, &f, &count);
	assert_int_equal(count, 0);
	free(keys);
}

/* Pages through the list and counts; each page but the last is full. */
static void walk_pages(library *l, const eskel_filter *f, size_t limit, const int64_t *keys, size_t count)
{
	size_t seen = 0;
	int64_t after = 0;
	for (bool more = true; more;) {
		eskel_shape *shapes = NULL;
		size_t page = 0;
		assert_ok(eskel_store_list(l->store->store, f, after, limit, &shapes, &page, &more, &l->store->error),
			l->store);
		assert_true(more ? page == limit : page <= limit);
		for (size_t i = 0; i < page; i++) {
			assert_true(seen < count);
			assert_int_equal(shapes[i].key, keys[seen++]);
			assert_true(accepts(f, &shapes[i].description));
			after = shapes[i].key;
		}
		eskel_shapes_free(shapes, page);
	}
	assert_int_equal(seen, count);
}

static void pages_of_any_size_join_to_the_whole_answer(void **state)
{
	library *l = *state;
	uint64_t seed = 3;
	for (int i = 0; i < 20; i++) {
		eskel_filter f = i ? random_filter(&seed) : eskel_filter_none();
		size_t count;
		int64_t *keys = find_keys(l, &f, &count);
		const size_t limits[] = {1, 7, 60, library_size, 1000};
		for (size_t j = 0; j < sizeof limits / sizeof limits[0]; j++)
			walk_pages(l, &f, limits[j], keys, count);
		free(keys);
	}
}

static void a_shape_deleted_between_two_pages_shifts_nothing(void **state)
{
	library *l = *state;
	store_fixture *s = l->store;
	eskel_filter none = eskel_filter_none();
	eskel_shape *first = NULL, *second = NULL;
	size_t count = 0;
	bool more;
	int64_t key;
	assert_ok(eskel_store_list(s->store, &none, 0, 10, &first, &count, &more, &s->error), s);
	assert_ok(eskel_store_delete(s->store, NULL, first[4].id, 0, &key, &s->error), s);
	assert_ok(eskel_store_delete(s->store, NULL, first[9].id, 0, &key, &s->error), s);
	assert_ok(eskel_store_list(s->store, &none, first[9].key, 10, &second, &count, &more, &s->error), s);
	assert_int_equal(second[0].key, l->keys[10]);
	eskel_shapes_free(first, 10);
	eskel_shapes_free(second, count);
}

static void a_filter_of_too_many_attributes_is_refused(void **state)
{
	library *l = *state;
	eskel_attribute too_many[65];
	for (int i = 0; i < 65; i++)
		too_many[i] = site_2[0];
	eskel_filter f = eskel_filter_none();
	f.attributes = too_many;
	eskel_key_block *keys = NULL;
	size_t count;
	f.attribute_count = 64;
	assert_ok(eskel_store_keys(l->store->store, &f, &keys, &count, &l->store->error), l->store);
	free(keys);
	f.attribute_count = 65;
	assert_int_equal(eskel_store_keys(l->store->store, &f, &keys, &count, &l->store->error), ESKEL_STORE_INVALID);
}

static void the_classes_are_those_of_a_plain_walk(void **state)
{
	library *l = *state;
	char **found_classes = NULL;
	size_t count = 0;
	assert_ok(eskel_store_classes(l->store->store, &found_classes, &count, &l->store->error), l->store);
	for (size_t i = 0; i + 1 < count; i++)
		assert_true(strcmp(found_classes[i], found_classes[i + 1]) < 0);
	size_t matched = 0;
	for (int i = 0; i < library_size; i++) {
		const char *class = l->descriptions[i].class;
		bool found = false;
		for (size_t c = 0; class && c < count; c++)
			found = found || strcmp(found_classes[c], class) == 0;
		assert_true(found == (class != NULL));
		matched += found;
	}
	assert_true(matched > 0);
	assert_int_equal(count, 3); /* Talus, femur, tibia */
	eskel_store_classes_free(found_classes, count);
}

int main(void)
{
#define library_test(name) \
	cmocka_unit_test_setup_teardown(name, set_up, tear_down), \
		cmocka_unit_test_setup_teardown(name, set_up_kept, tear_down), \
		cmocka_unit_test_setup_teardown(name, set_up_put, tear_down)
	const struct CMUnitTest tests[] = {
		library_test(a_thousand_random_filters_find_what_a_plain_walk_finds),
		library_test(each_condition_alone_finds_what_a_plain_walk_finds),
		library_test(what_changed_is_found_as_it_is_now),
		library_test(a_change_that_failed_changes_no_answer),
		library_test(no_condition_finds_all),
		library_test(percent_and_underscore_in_a_text_are_themselves),
		library_test(no_answer_is_an_array_too),
		library_test(pages_of_any_size_join_to_the_whole_answer),
		library_test(a_shape_deleted_between_two_pages_shifts_nothing),
		library_test(a_filter_of_too_many_attributes_is_refused),
		library_test(the_classes_are_those_of_a_plain_walk),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
