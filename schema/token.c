/* Bearer tokens. The text is 32 random bytes in hex, so a fast hash of it is as good as the text is long; only the
 * hash is stored. A text is checked against every token in constant time, whichever it is, if any. */
#include "array.h"
#include "audit.h"
#include "read.h"
#include "sha256.h"
#include "statement.h"
#include "status.h"
#include "write.h"

#include <inttypes.h>
#include <nettle/memops.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

static const char select_tokens[] =
	"SELECT number, name, role, created, expires, revoked, sha256 FROM token ORDER BY number";

static const char *const roles[] = {
	[ESKEL_ROLE_READ] = "read",
	[ESKEL_ROLE_WRITE] = "write",
	[ESKEL_ROLE_ADMIN] = "admin",
};
enum { role_count = sizeof roles / sizeof roles[0] };

/* A token and what is stored of its text. */
typedef struct {
	eskel_token token;
	uint8_t sha256[ESK_SHA256_BYTES];
} row;

static void bind_time(esk_statement *s, int64_t seconds)
{
	if (seconds)
		esk_bind_int64(s, seconds);
	else
		esk_bind_text(s, NULL);
}

static eskel_store_status insert(sqlite3 *writer, void *context, eskel_store_error *error)
{
	row *a = context;
	esk_statement s = esk_statement_begin(
		writer, "INSERT INTO token (sha256, name, role, created, expires) VALUES (?, ?, ?, ?, ?)");
	esk_bind_blob(&s, a->sha256, sizeof a->sha256);
	esk_bind_text(&s, a->token.name);
	esk_bind_text(&s, roles[a->token.role]);
	esk_bind_int64(&s, a->token.created);
	bind_time(&s, a->token.expires);
	eskel_store_status status = esk_statement_run(&s, error);
	if (status != ESKEL_STORE_OK)
		return status;
	a->token.number = sqlite3_last_insert_rowid(writer);
	return esk_audit_append(writer, &(esk_audit_entry){.action = "token add", .token = a->token.number}, error);
}

eskel_store_status eskel_store_token_add(eskel_store *store, const char *name, eskel_role role, int64_t expires,
	char text[ESKEL_TOKEN_TEXT_SIZE], eskel_token *token, eskel_store_error *error)
{
	row a = {.token = {.role = role, .created = (int64_t)time(NULL), .expires = expires}};
	size_t length = strlen(name);
	if (length == 0 || length >= sizeof a.token.name)
		return esk_status_fail(error, ESKEL_STORE_INVALID,
			"the name of the token has %zu bytes, expected 1 to %zu", length, sizeof a.token.name - 1);
	if (role < ESKEL_ROLE_READ || role > ESKEL_ROLE_ADMIN)
		return esk_status_fail(error, ESKEL_STORE_INVALID, "the role is %d, expected %d to %d", (int)role,
			ESKEL_ROLE_READ, ESKEL_ROLE_ADMIN);
	memcpy(a.token.name, name, length);
	uint8_t random[(ESKEL_TOKEN_TEXT_SIZE - 1) / 2];
	if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random)
		return esk_status_fail(error, ESKEL_STORE_IO, "the system has no random bytes");
	char made[ESKEL_TOKEN_TEXT_SIZE];
	esk_hex(random, sizeof random, made);
	esk_sha256(made, strlen(made), a.sha256);
	eskel_store_status status = esk_write(store, insert, &a, error);
	if (status != ESKEL_STORE_OK)
		return status;
	memcpy(text, made, sizeof made);
	*token = a.token;
	return ESKEL_STORE_OK;
}

static eskel_store_status revoke(sqlite3 *writer, void *context, eskel_store_error *error)
{
	int64_t number = *(const int64_t *)context;
	esk_statement s =
		esk_statement_begin(writer, "UPDATE token SET revoked = ? WHERE number = ? AND revoked IS NULL");
	esk_bind_int64(&s, (int64_t)time(NULL));
	esk_bind_int64(&s, number);
	eskel_store_status status = esk_statement_run(&s, error);
	if (status != ESKEL_STORE_OK)
		return status;
	if (sqlite3_changes(writer) == 0)
		return esk_status_fail(
			error, ESKEL_STORE_NOT_FOUND, "there is no token %" PRId64 " that is not revoked yet", number);
	return esk_audit_append(writer, &(esk_audit_entry){.action = "token revoke", .token = number}, error);
}

eskel_store_status eskel_store_token_revoke(eskel_store *store, int64_t number, eskel_store_error *error)
{
	return esk_write(store, revoke, &number, error);
}

static row read_row(esk_statement *s)
{
	row r = {.token.number = esk_column_int64(s)};
	esk_column_copy(s, r.token.name, sizeof r.token.name);
	r.token.role = (eskel_role)esk_column_name(s, roles, role_count);
	r.token.created = esk_column_int64(s);
	r.token.expires = esk_column_int64(s);
	r.token.revoked = esk_column_int64(s);
	const void *digest;
	size_t size;
	esk_column_blob(s, &digest, &size);
	if (size == sizeof r.sha256)
		memcpy(r.sha256, digest, size);
	else
		esk_statement_fail(s, SQLITE_CORRUPT);
	return r;
}

eskel_store_status eskel_store_tokens(eskel_store *store, eskel_token **tokens, size_t *count, eskel_store_error *error)
{
	eskel_token *read = NULL;
	size_t read_count = 0;
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(db, select_tokens);
	while (esk_statement_row(&s)) {
		if (!esk_array_grow((void **)&read, read_count, sizeof read[0])) {
			esk_statement_fail(&s, SQLITE_NOMEM);
			break;
		}
		read[read_count++] = read_row(&s).token;
	}
	status = esk_statement_end(&s, error);
	esk_read_end(store, db);
	if (status != ESKEL_STORE_OK) {
		free(read);
		return status;
	}
	*tokens = read;
	*count = read_count;
	return ESKEL_STORE_OK;
}

static bool is_valid(const eskel_token *token, int64_t now)
{
	return !(token->revoked && token->revoked <= now) && !(token->expires && token->expires <= now);
}

eskel_store_status eskel_store_token_verify(
	eskel_store *store, const char *text, int64_t now, eskel_token *token, eskel_store_error *error)
{
	uint8_t presented[ESK_SHA256_BYTES];
	esk_sha256(text, strlen(text), presented);
	row known = {.token.number = 0};
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(db, select_tokens);
	while (esk_statement_row(&s)) {
		row r = read_row(&s);
		if (memeql_sec(r.sha256, presented, sizeof presented))
			known = r;
	}
	status = esk_statement_end(&s, error);
	esk_read_end(store, db);
	if (status != ESKEL_STORE_OK)
		return status;
	if (!known.token.number || !is_valid(&known.token, now))
		return esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "the token is not valid");
	*token = known.token;
	return ESKEL_STORE_OK;
}
