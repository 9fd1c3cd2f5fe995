#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <math.h>
#include <nettle/sha2.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t stored_count(store_fixture *f)
{
	uint64_t count = 0;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	return count;
}

static eskel_shape enrolled(store_fixture *f, uint32_t number)
{
	eskel_shape shape;
	assert_ok(sample_enroll(f->store, number, &shape, &f->error), f);
	return shape;
}

static eskel_attribute attributes[] = {{"empty", ""}, {"scanner", "CT \"7\"; DROP TABLE shape"}, {"Ω", "μέγα"}};
static const eskel_description full = {
	.name = "Fémur gauche 左",
	.class = "femur",
	.subject = "O'Neill; --",
	.side = ESKEL_SIDE_LEFT,
	.sex = ESKEL_SEX_FEMALE,
	.age = 41.5,
	.attribute_count = 3,
	.attributes = attributes,
};

static void assert_same_text(const char *a, const char *b)
{
	if (!a || !b)
		assert_ptr_equal(a, b);
	else
		assert_string_equal(a, b);
}

static void assert_same_description(const eskel_description *a, const eskel_description *b)
{
	assert_same_text(a->name, b->name);
	assert_same_text(a->class, b->class);
	assert_same_text(a->subject, b->subject);
	assert_int_equal(a->side, b->side);
	assert_int_equal(a->sex, b->sex);
	assert_true(a->age == b->age || (isnan(a->age) && isnan(b->age)));
	assert_int_equal(a->attribute_count, b->attribute_count);
	for (size_t i = 0; i < a->attribute_count; i++) {
		assert_string_equal(a->attributes[i].key, b->attributes[i].key);
		assert_string_equal(a->attributes[i].value, b->attributes[i].value);
	}
}

static void an_enrolled_shape_comes_back_as_it_went_in(void **state)
{
	store_fixture *f = *state;
	const eskel_warning warnings[2] = {{ESKEL_WARNING_TOUCHES_BORDER, "touches x low"}, {ESKEL_WARNING_FLAT, "é"}};
	sample s = sample_new(77);
	s.description = full;
	eskel_enrollment enrollment = sample_enrollment(&s, -9);
	enrollment.warnings = warnings;
	enrollment.warning_count = 2;
	eskel_shape made, read;
	bool created = false;
	assert_ok(eskel_store_enroll(f->store, "me", &enrollment, 1, &made, &created, &f->error), f);
	assert_true(created);
	store_reopen(f);
	assert_ok(eskel_store_shape(f->store, made.id, &read, &f->error), f);
	assert_int_equal(read.key, made.key);
	assert_string_equal(read.created, made.created);
	assert_int_equal(strlen(read.created), 20);
	assert_int_equal(read.revision, 1);
	assert_int_equal(read.label, -9);
	assert_int_equal(read.voxels, s.cloud->voxels);
	assert_true(read.volume == eskel_cloud_volume(s.cloud));
	assert_memory_equal(read.centre, s.skeleton->nodes[0].centre, sizeof read.centre);
	assert_int_equal(read.levels, 3);
	assert_int_equal(read.warning_count, 2);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(read.warnings[i].code, warnings[i].code);
		assert_string_equal(read.warnings[i].text, warnings[i].text);
	}
	assert_same_description(&read.description, &full);
	eskel_shape by_key;
	assert_ok(eskel_store_shape_by_key(f->store, made.key, &by_key, &f->error), f);
	assert_string_equal(by_key.id, made.id);
	eskel_shape_clear(&made);
	eskel_shape_clear(&read);
	eskel_shape_clear(&by_key);
	sample_free(&s);
}

static void what_is_not_recorded_comes_back_as_not_recorded(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 5);
	assert_same_description(&shape.description, &(eskel_description){.age = NAN});
	assert_int_equal(shape.warning_count, 0);
	eskel_shape_clear(&shape);
}

static void the_id_is_the_beginning_of_the_digest_of_the_encoded_cloud(void **state)
{
	store_fixture *f = *state;
	sample s = sample_new(3);
	eskel_shape shape = enrolled(f, 3);
	uint8_t *bytes = NULL, digest[32];
	size_t size = 0;
	char expected[65], id[ESKEL_ID_SIZE], sha256[ESKEL_SHA256_SIZE];
	assert_int_equal(eskel_cloud_encode(s.cloud, &bytes, &size), ESKEL_OK);
	struct sha256_ctx context;
	sha256_init(&context);
	sha256_update(&context, size, bytes);
	sha256_digest(&context, 32, digest);
	for (int i = 0; i < 32; i++)
		snprintf(expected + 2 * i, 3, "%02x", digest[i]);
	assert_string_equal(shape.sha256, expected);
	assert_int_equal(strlen(shape.id), 32);
	assert_memory_equal(shape.id, expected, 32);
	assert_int_equal(eskel_store_identify(s.cloud, id, sha256), ESKEL_STORE_OK);
	assert_string_equal(id, shape.id);
	assert_string_equal(sha256, shape.sha256);
	free(bytes);
	eskel_shape_clear(&shape);
	sample_free(&s);
}

static void stored_objects_are_those_that_were_enrolled(void **state)
{
	store_fixture *f = *state;
	sample s = sample_new(1000);
	eskel_shape shape = enrolled(f, 1000);
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	assert_ok(eskel_store_cloud(f->store, shape.key, &cloud, &f->error), f);
	assert_ok(eskel_store_skeleton(f->store, shape.key, &skeleton, &f->error), f);
	assert_ok(eskel_store_signature(f->store, shape.key, &signature, &f->error), f);
	assert_int_equal(cloud->run_count, s.cloud->run_count);
	assert_memory_equal(cloud->runs, s.cloud->runs, s.cloud->run_count * sizeof cloud->runs[0]);
	assert_memory_equal(&cloud->affine, &s.cloud->affine, sizeof cloud->affine);
	assert_int_equal(skeleton->level_count, 3);
	for (size_t n = 0; n < ESKEL_NODES(3); n++) {
		assert_memory_equal(skeleton->nodes[n].covariance, s.skeleton->nodes[n].covariance, 9 * sizeof(double));
		assert_memory_equal(signature->rows[n], s.signature->rows[n], sizeof signature->rows[n]);
	}
	eskel_cloud_free(cloud);
	eskel_skeleton_free(skeleton);
	eskel_signature_free(signature);
	eskel_shape_clear(&shape);
	sample_free(&s);
}

/* Enrolls five samples, with what the caller changes of the third one's description. */
static eskel_store_status enroll_five(
	store_fixture *f, uint32_t first, const eskel_description *third, eskel_shape shapes[5], bool created[5])
{
	sample samples[5];
	eskel_enrollment enrollments[5];
	for (uint32_t i = 0; i < 5; i++) {
		samples[i] = sample_new(first + i);
		if (i == 2 && third)
			samples[i].description = *third;
		enrollments[i] = sample_enrollment(&samples[i], (int32_t)i + 1);
	}
	eskel_store_status status = eskel_store_enroll(f->store, NULL, enrollments, 5, shapes, created, &f->error);
	for (int i = 0; i < 5; i++)
		sample_free(&samples[i]);
	return status;
}

static void a_refused_description_among_five_leaves_none_of_them(void **state)
{
	store_fixture *f = *state;
	eskel_shape shapes[5], before[5];
	bool created[5];
	memset(shapes, 0x5a, sizeof shapes);
	memcpy(before, shapes, sizeof before);
	eskel_attribute twice[] = {{"a", "1"}, {"a", "2"}};
	const eskel_description bad = {.age = NAN, .attribute_count = 2, .attributes = twice};
	assert_int_equal(enroll_five(f, 0, &bad, shapes, created), ESKEL_STORE_INVALID);
	assert_int_equal(stored_count(f), 0);
	assert_memory_equal(shapes, before, sizeof before);
}

static void a_failure_inside_the_transaction_leaves_none_of_five(void **state)
{
	store_fixture *f = *state;
	eskel_shape shapes[5];
	bool created[5];
	/* The table refuses the third one's name, which no check before the transaction looks at. */
	store_edit(f, "CREATE UNIQUE INDEX refuse ON shape (name) WHERE name = 'twice'; INSERT INTO shape (sha256, "
		      "label, voxels,"
		      " volume, centre_x, centre_y, centre_z, levels, name) VALUES (zeroblob(32), 1, 1, 1, 0, 0, 0, 1, "
		      "'twice')");
	const eskel_description bad = {.age = NAN, .name = "twice"};
	assert_int_equal(enroll_five(f, 0, &bad, shapes, created), ESKEL_STORE_INVALID);
	assert_int_equal(stored_count(f), 1);
	uint64_t rows = 9;
	assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
	assert_int_equal(rows, 0);
	assert_ok(enroll_five(f, 0, NULL, shapes, created), f);
	assert_int_equal(stored_count(f), 6);
	for (int i = 0; i < 5; i++)
		eskel_shape_clear(&shapes[i]);
}

static void the_same_cloud_again_stays_one_shape_as_it_was(void **state)
{
	store_fixture *f = *state;
	sample s = sample_new(12);
	s.description.name = "first";
	eskel_enrollment twice[2] = {sample_enrollment(&s, 1), sample_enrollment(&s, 2)};
	eskel_shape shapes[2], again;
	bool created[2];
	assert_ok(eskel_store_enroll(f->store, NULL, twice, 2, shapes, created, &f->error), f);
	assert_true(created[0]);
	assert_false(created[1]);
	assert_string_equal(shapes[0].id, shapes[1].id);
	s.description.name = "second";
	assert_ok(eskel_store_enroll(f->store, NULL, twice, 1, &again, created, &f->error), f);
	assert_false(created[0]);
	assert_int_equal(again.key, shapes[0].key);
	assert_string_equal(again.description.name, "first");
	assert_int_equal(again.label, 1);
	assert_int_equal(stored_count(f), 1);
	eskel_shape_clear(&shapes[0]);
	eskel_shape_clear(&shapes[1]);
	eskel_shape_clear(&again);
	sample_free(&s);
}

static void a_description_replaces_the_one_before_and_counts_up_the_revision(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 1), described;
	assert_ok(eskel_store_describe(f->store, "me", shape.id, 1, &full, &described, &f->error), f);
	assert_int_equal(described.revision, 2);
	assert_same_description(&described.description, &full);
	eskel_shape_clear(&described);
	const eskel_description less = {.age = NAN,
		.class = "tibia",
		.side = ESKEL_SIDE_NONE,
		.attribute_count = 1,
		.attributes = &(eskel_attribute){"site", "2"}};
	assert_ok(eskel_store_describe(f->store, "me", shape.id, 0, &less, &described, &f->error), f);
	assert_int_equal(described.revision, 3);
	assert_same_description(&described.description, &less);
	eskel_shape_clear(&described);
	eskel_shape_clear(&shape);
}

static void a_description_of_another_revision_is_a_conflict_and_changes_nothing(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 1), described = {.key = -5};
	assert_int_equal(
		eskel_store_describe(f->store, NULL, shape.id, 2, &full, &described, &f->error), ESKEL_STORE_CONFLICT);
	assert_non_null(strstr(f->error.text, "at revision 1, expected 2"));
	assert_int_equal(described.key, -5);
	eskel_shape read;
	assert_ok(eskel_store_shape(f->store, shape.id, &read, &f->error), f);
	assert_int_equal(read.revision, 1);
	assert_null(read.description.name);
	eskel_shape_clear(&read);
	eskel_shape_clear(&shape);
}

static void a_side_sex_or_age_outside_its_range_is_refused(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 1), described;
	const eskel_description bad[] = {
		{.age = NAN, .side = 4}, {.age = NAN, .sex = 3}, {.age = -1}, {.age = INFINITY}};
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		assert_int_equal(eskel_store_describe(f->store, NULL, shape.id, 0, &bad[i], &described, &f->error),
			ESKEL_STORE_INVALID);
	eskel_shape_clear(&shape);
}

static void a_refusal_never_quotes_what_people_wrote(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 1), described;
	eskel_attribute unordered[] = {{"secret-b", "x"}, {"secret-a", "x"}};
	eskel_description bad = full;
	bad.attributes = unordered;
	bad.attribute_count = 2;
	assert_int_equal(
		eskel_store_describe(f->store, NULL, shape.id, 0, &bad, &described, &f->error), ESKEL_STORE_INVALID);
	assert_null(strstr(f->error.text, "secret"));
	assert_null(strstr(f->error.text, "Neill"));
	eskel_shape_clear(&shape);
}

static int64_t rows_of(store_fixture *f, const char *table)
{
	char sql[64];
	snprintf(sql, sizeof sql, "SELECT count(*) FROM %s", table);
	sqlite3 *db = NULL;
	sqlite3_stmt *s = NULL;
	assert_int_equal(sqlite3_open_v2(f->path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &s, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_step(s), SQLITE_ROW);
	int64_t rows = sqlite3_column_int64(s, 0);
	sqlite3_finalize(s);
	sqlite3_close(db);
	return rows;
}

static void a_deleted_shape_leaves_no_row_and_its_key_is_not_used_again(void **state)
{
	static const char *const tables[] = {"shape", "attribute", "warning", "cloud", "skeleton", "signature"};
	store_fixture *f = *state;
	const eskel_warning warning = {ESKEL_WARNING_FLAT, "flat"};
	sample s = sample_new(8);
	s.description = full;
	eskel_enrollment enrollment = sample_enrollment(&s, 1);
	enrollment.warnings = &warning;
	enrollment.warning_count = 1;
	eskel_shape shape;
	bool created;
	int64_t key = 0;
	assert_ok(eskel_store_enroll(f->store, NULL, &enrollment, 1, &shape, &created, &f->error), f);
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
		assert_true(rows_of(f, tables[i]) >= 1);
	assert_int_equal(eskel_store_delete(f->store, NULL, shape.id, 2, &key, &f->error), ESKEL_STORE_CONFLICT);
	assert_ok(eskel_store_delete(f->store, NULL, shape.id, 1, &key, &f->error), f);
	assert_int_equal(key, shape.key);
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
		assert_int_equal(rows_of(f, tables[i]), 0);
	eskel_shape_clear(&shape);
	store_reopen(f);
	assert_ok(eskel_store_enroll(f->store, NULL, &enrollment, 1, &shape, &created, &f->error), f);
	assert_true(created);
	assert_true(shape.key > key);
	eskel_shape_clear(&shape);
	sample_free(&s);
}

static void what_is_not_there_is_not_found(void **state)
{
	store_fixture *f = *state;
	const char *id = "00000000000000000000000000000000";
	eskel_shape shape;
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	int64_t key;
	eskel_store_error *e = &f->error;
	assert_int_equal(eskel_store_shape(f->store, id, &shape, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_shape(f->store, "", &shape, NULL), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_shape_by_key(f->store, 1, &shape, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_describe(f->store, NULL, id, 0, &full, &shape, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_delete(f->store, NULL, id, 0, &key, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_cloud(f->store, 1, &cloud, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_skeleton(f->store, 1, &skeleton, e), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_signature(f->store, 1, &signature, e), ESKEL_STORE_NOT_FOUND);
}

static bool ignore(void *context, int64_t key, uint32_t level_count)
{
	(void)context;
	(void)key;
	(void)level_count;
	return true;
}

/* The last byte of each blob of each kind, with every bit turned. */
static void flip(store_fixture *f, const char *table)
{
	char sql[256];
	snprintf(sql, sizeof sql,
		"UPDATE %s SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) ||"
		" CASE substr(bytes, -1) WHEN x'00' THEN x'ff' ELSE x'00' END AS BLOB)",
		table);
	store_edit(f, sql);
}

static void a_flipped_byte_in_any_blob_is_found_when_it_is_read(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape = enrolled(f, 1);
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	flip(f, "cloud");
	assert_int_equal(eskel_store_cloud(f->store, shape.key, &cloud, &f->error), ESKEL_STORE_CORRUPT);
	assert_non_null(strstr(f->error.text, "cloud"));
	assert_null(cloud);
	assert_ok(eskel_store_skeleton(f->store, shape.key, &skeleton, &f->error), f);
	eskel_skeleton_free(skeleton);
	flip(f, "skeleton");
	assert_int_equal(eskel_store_skeleton(f->store, shape.key, &skeleton, &f->error), ESKEL_STORE_CORRUPT);
	assert_non_null(strstr(f->error.text, "skeleton"));
	assert_ok(eskel_store_signature(f->store, shape.key, &signature, &f->error), f);
	eskel_signature_free(signature);
	flip(f, "signature");
	assert_int_equal(eskel_store_signature(f->store, shape.key, &signature, &f->error), ESKEL_STORE_CORRUPT);
	assert_non_null(strstr(f->error.text, "signature"));
	assert_int_equal(store_each_signature(f->store, ignore, NULL, &f->error), ESKEL_STORE_CORRUPT);
	eskel_shape_clear(&shape);
}

typedef struct {
	int64_t keys[8];
	size_t count, stop_after;
} seen;

static bool note(void *context, int64_t key, uint32_t level_count)
{
	seen *s = context;
	assert_int_equal(level_count, 3);
	s->keys[s->count++] = key;
	return s->count < s->stop_after;
}

static void each_signature_comes_once_in_the_order_of_keys_until_stopped(void **state)
{
	store_fixture *f = *state;
	eskel_shape shapes[5];
	bool created[5];
	int64_t key;
	assert_ok(enroll_five(f, 20, NULL, shapes, created), f);
	assert_ok(eskel_store_delete(f->store, NULL, shapes[1].id, 0, &key, &f->error), f);
	seen s = {.stop_after = 8};
	assert_ok(store_each_signature(f->store, note, &s, &f->error), f);
	assert_int_equal(s.count, 4);
	const int expected[4] = {0, 2, 3, 4};
	for (int i = 0; i < 4; i++)
		assert_int_equal(s.keys[i], shapes[expected[i]].key);
	s = (seen){.stop_after = 2};
	assert_ok(store_each_signature(f->store, note, &s, &f->error), f);
	assert_int_equal(s.count, 2);
	for (int i = 0; i < 5; i++)
		eskel_shape_clear(&shapes[i]);
}

static void enrolling_nothing_is_fine(void **state)
{
	store_fixture *f = *state;
	assert_ok(eskel_store_enroll(f->store, NULL, NULL, 0, NULL, NULL, &f->error), f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(an_enrolled_shape_comes_back_as_it_went_in),
		store_test(what_is_not_recorded_comes_back_as_not_recorded),
		store_test(the_id_is_the_beginning_of_the_digest_of_the_encoded_cloud),
		store_test(stored_objects_are_those_that_were_enrolled),
		store_test(a_refused_description_among_five_leaves_none_of_them),
		store_test(a_failure_inside_the_transaction_leaves_none_of_five),
		store_test(the_same_cloud_again_stays_one_shape_as_it_was),
		store_test(a_description_replaces_the_one_before_and_counts_up_the_revision),
		store_test(a_description_of_another_revision_is_a_conflict_and_changes_nothing),
		store_test(a_side_sex_or_age_outside_its_range_is_refused),
		store_test(a_refusal_never_quotes_what_people_wrote),
		store_test(a_deleted_shape_leaves_no_row_and_its_key_is_not_used_again),
		store_test(what_is_not_there_is_not_found),
		store_test(a_flipped_byte_in_any_blob_is_found_when_it_is_read),
		store_test(each_signature_comes_once_in_the_order_of_keys_until_stopped),
		store_test(enrolling_nothing_is_fine),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
