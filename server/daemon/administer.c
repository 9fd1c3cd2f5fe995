#include "administer.h"

#include "eskel_store.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const roles[] = {
	[ESKEL_ROLE_READ] = "read", [ESKEL_ROLE_WRITE] = "write", [ESKEL_ROLE_ADMIN] = "admin"};

static int fail(const char *text)
{
	fprintf(stderr, "eskeld: %s\n", text);
	return 1;
}

static bool parse_role(const char *text, eskel_role *role)
{
	for (int r = ESKEL_ROLE_READ; r <= ESKEL_ROLE_ADMIN; r++)
		if (!strcmp(text, roles[r])) {
			*role = (eskel_role)r;
			return true;
		}
	return false;
}

/* "2026-01-31 12:34 UTC", or instead for 0. */
static const char *moment(int64_t seconds, const char *instead, char text[32])
{
	struct tm utc;
	time_t at = (time_t)seconds;
	if (!seconds || !gmtime_r(&at, &utc) || !strftime(text, 32, "%Y-%m-%d %H:%M UTC", &utc))
		snprintf(text, 32, "%s", instead);
	return text;
}

/* The token alone goes to standard output, so that `> file` keeps it and nothing else. */
static int add_token(eskel_store *store, const esk_options *options)
{
	char secret[ESKEL_TOKEN_TEXT_SIZE], expires[32];
	eskel_role role;
	eskel_token token;
	eskel_store_error error;
	if (!parse_role(options->role, &role))
		return fail("--role is none of read, write and admin");
	int64_t end = options->days ? time(NULL) + (int64_t)options->days * 86400 : 0;
	if (eskel_store_token_add(store, options->argument, role, end, secret, &token, &error) != ESKEL_STORE_OK)
		return fail(error.text);
	fprintf(stderr, "token %" PRId64 ": %s, role %s, expires %s. It is shown only now:\n", token.number, token.name,
		roles[token.role], moment(token.expires, "never", expires));
	printf("%s\n", secret);
	return 0;
}

static int list_tokens(eskel_store *store)
{
	eskel_token *tokens = NULL;
	size_t count = 0;
	char created[32], expires[32], revoked[32];
	eskel_store_error error;
	if (eskel_store_tokens(store, &tokens, &count, &error) != ESKEL_STORE_OK)
		return fail(error.text);
	printf("%6s  %-5s  %-20s  %-20s  %-20s  %s\n", "number", "role", "created", "expires", "revoked", "name");
	for (size_t t = 0; t < count; t++)
		printf("%6" PRId64 "  %-5s  %-20s  %-20s  %-20s  %s\n", tokens[t].number, roles[tokens[t].role],
			moment(tokens[t].created, "", created), moment(tokens[t].expires, "never", expires),
			moment(tokens[t].revoked, "", revoked), tokens[t].name);
	free(tokens);
	return 0;
}

static int revoke_token(eskel_store *store, const esk_options *options)
{
	char *end;
	eskel_store_error error;
	int64_t number = strtoll(options->argument, &end, 10);
	if (*end || number < 1)
		return fail("the NUMBER of the token is none; see eskeld token list");
	if (eskel_store_token_revoke(store, number, &error) != ESKEL_STORE_OK)
		return fail(error.text);
	return 0;
}

static int verify_audit(eskel_store *store)
{
	uint64_t rows = 0;
	eskel_store_error error;
	if (eskel_store_audit_verify(store, &rows, &error) != ESKEL_STORE_OK)
		return fail(error.text);
	printf("%" PRIu64 " changes, each following from the one before\n", rows);
	return 0;
}

/* Only token add may make a database: a first token before the first start. */
static bool database_is_there(const esk_options *options)
{
	return options->command == ESK_TOKEN_ADD || access(options->database, F_OK) == 0;
}

static int run(eskel_store *store, const esk_options *options)
{
	switch (options->command) {
	case ESK_TOKEN_ADD:
		return add_token(store, options);
	case ESK_TOKEN_LIST:
		return list_tokens(store);
	case ESK_TOKEN_REVOKE:
		return revoke_token(store, options);
	case ESK_AUDIT_VERIFY:
		return verify_audit(store);
	case ESK_SERVE:
		break;
	}
	return 1;
}

int esk_administer(const esk_options *options)
{
	const eskel_store_options store_options = {.beside_server = true};
	eskel_store *store = NULL;
	eskel_store_error error;
	if (!database_is_there(options))
		return fail("there is no such database");
	if (eskel_store_open(options->database, &store_options, &store, &error) != ESKEL_STORE_OK)
		return fail(error.text);
	int status = run(store, options);
	eskel_store_close(store);
	return status;
}
