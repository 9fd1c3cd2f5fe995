#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static eskel_token add(
	store_fixture *f, const char *name, eskel_role role, int64_t expires, char text[ESKEL_TOKEN_TEXT_SIZE])
{
	eskel_token token;
	assert_ok(eskel_store_token_add(f->store, name, role, expires, text, &token, &f->error), f);
	return token;
}

static eskel_store_status verify(store_fixture *f, const char *text, int64_t now, eskel_token *token)
{
	return eskel_store_token_verify(f->store, text, now, token, &f->error);
}

static void a_token_is_known_by_its_text_alone(void **state)
{
	store_fixture *f = *state;
	char first[ESKEL_TOKEN_TEXT_SIZE], second[ESKEL_TOKEN_TEXT_SIZE];
	eskel_token made = add(f, "scanner", ESKEL_ROLE_WRITE, 0, first), read;
	add(f, "admin", ESKEL_ROLE_ADMIN, 0, second);
	assert_int_equal(strspn(first, "0123456789abcdef"), 64);
	assert_string_not_equal(first, second);
	store_reopen(f);
	assert_ok(verify(f, first, time(NULL), &read), f);
	assert_int_equal(read.number, made.number);
	assert_string_equal(read.name, "scanner");
	assert_int_equal(read.role, ESKEL_ROLE_WRITE);
	assert_ok(verify(f, second, time(NULL), &read), f);
	assert_int_equal(read.role, ESKEL_ROLE_ADMIN);
}

static void any_other_text_is_no_token(void **state)
{
	store_fixture *f = *state;
	char text[ESKEL_TOKEN_TEXT_SIZE], changed[ESKEL_TOKEN_TEXT_SIZE];
	eskel_token read = {.number = -1};
	assert_int_equal(verify(f, "", 0, &read), ESKEL_STORE_NOT_FOUND);
	add(f, "one", ESKEL_ROLE_READ, 0, text);
	for (int i = 0; i < 64; i++) {
		strcpy(changed, text);
		changed[i] = changed[i] == '0' ? '1' : '0';
		assert_int_equal(verify(f, changed, 0, &read), ESKEL_STORE_NOT_FOUND);
	}
	strcpy(changed, text);
	changed[63] = '\0';
	assert_int_equal(verify(f, changed, 0, &read), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(verify(f, "", 0, &read), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(read.number, -1);
}

static void a_token_ends_when_it_expires(void **state)
{
	store_fixture *f = *state;
	char text[ESKEL_TOKEN_TEXT_SIZE];
	eskel_token read;
	add(f, "brief", ESKEL_ROLE_READ, 2000, text);
	assert_ok(verify(f, text, 1999, &read), f);
	assert_int_equal(read.expires, 2000);
	assert_int_equal(verify(f, text, 2000, &read), ESKEL_STORE_NOT_FOUND);
}

static void a_revoked_token_is_refused_and_is_revoked_once(void **state)
{
	store_fixture *f = *state;
	char text[ESKEL_TOKEN_TEXT_SIZE], other[ESKEL_TOKEN_TEXT_SIZE];
	eskel_token made = add(f, "lost", ESKEL_ROLE_READ, 0, text), read;
	add(f, "kept", ESKEL_ROLE_READ, 0, other);
	assert_ok(eskel_store_token_revoke(f->store, made.number, &f->error), f);
	assert_int_equal(verify(f, text, time(NULL) + 1, &read), ESKEL_STORE_NOT_FOUND);
	assert_ok(verify(f, other, time(NULL), &read), f);
	assert_int_equal(eskel_store_token_revoke(f->store, made.number, &f->error), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_token_revoke(f->store, 99, &f->error), ESKEL_STORE_NOT_FOUND);
}

static void the_list_shows_every_token_and_when_it_ended(void **state)
{
	store_fixture *f = *state;
	char text[ESKEL_TOKEN_TEXT_SIZE];
	eskel_token *tokens = NULL;
	size_t count = 9;
	assert_ok(eskel_store_tokens(f->store, &tokens, &count, &f->error), f);
	assert_int_equal(count, 0);
	free(tokens);
	eskel_token first = add(f, "a", ESKEL_ROLE_READ, 0, text);
	add(f, "b", ESKEL_ROLE_ADMIN, 5, text);
	assert_ok(eskel_store_token_revoke(f->store, first.number, &f->error), f);
	assert_ok(eskel_store_tokens(f->store, &tokens, &count, &f->error), f);
	assert_int_equal(count, 2);
	assert_string_equal(tokens[0].name, "a");
	assert_true(tokens[0].revoked >= tokens[0].created);
	assert_int_equal(tokens[0].expires, 0);
	assert_int_equal(tokens[1].role, ESKEL_ROLE_ADMIN);
	assert_int_equal(tokens[1].expires, 5);
	assert_int_equal(tokens[1].revoked, 0);
	free(tokens);
}

static void the_text_of_a_token_is_nowhere_in_the_file(void **state)
{
	store_fixture *f = *state;
	char text[ESKEL_TOKEN_TEXT_SIZE];
	uint8_t raw[32];
	add(f, "secret", ESKEL_ROLE_READ, 0, text);
	for (int i = 0; i < 32; i++) {
		const char byte[3] = {text[2 * i], text[2 * i + 1], '\0'};
		raw[i] = (uint8_t)strtoul(byte, NULL, 16);
	}
	eskel_store_close(f->store);
	f->store = NULL;
	size_t size;
	uint8_t *file = file_read(f->path, &size);
	assert_non_null(memmem(file, size, "secret", 6));
	assert_null(memmem(file, size, text, 64));
	assert_null(memmem(file, size, raw, 32));
	free(file);
}

static void a_name_of_1_to_64_bytes_and_a_known_role_are_demanded(void **state)
{
	store_fixture *f = *state;
	char name[66], text[ESKEL_TOKEN_TEXT_SIZE] = "untouched";
	eskel_token token;
	memset(name, 'n', 65);
	name[65] = '\0';
	eskel_store *s = f->store;
	assert_int_equal(eskel_store_token_add(s, name, ESKEL_ROLE_READ, 0, text, &token, NULL), ESKEL_STORE_INVALID);
	assert_int_equal(eskel_store_token_add(s, "", ESKEL_ROLE_READ, 0, text, &token, NULL), ESKEL_STORE_INVALID);
	assert_int_equal(eskel_store_token_add(s, "n", 0, 0, text, &token, NULL), ESKEL_STORE_INVALID);
	assert_int_equal(eskel_store_token_add(s, "n", 4, 0, text, &token, NULL), ESKEL_STORE_INVALID);
	assert_string_equal(text, "untouched");
	name[64] = '\0';
	eskel_token made = add(f, name, ESKEL_ROLE_READ, 0, text), read;
	assert_ok(verify(f, text, 0, &read), f);
	assert_string_equal(read.name, made.name);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(a_token_is_known_by_its_text_alone),
		store_test(any_other_text_is_no_token),
		store_test(a_token_ends_when_it_expires),
		store_test(a_revoked_token_is_refused_and_is_revoked_once),
		store_test(the_list_shows_every_token_and_when_it_ended),
		store_test(the_text_of_a_token_is_nowhere_in_the_file),
		store_test(a_name_of_1_to_64_bytes_and_a_known_role_are_demanded),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
