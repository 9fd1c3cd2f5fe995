/* Who asks, and what may they do.
 *
 * While the database has never had a token, everybody who reaches the server may do everything: it listens to
 * loopback only then (serve.c). From the first token on, also one made while the server runs, nobody is anybody
 * without one. Tokens are looked up for each request, so revocation and expiry hold at once.
 */
#ifndef ESK_AUTH_H
#define ESK_AUTH_H

#include "eskel_api.h"

#include <stdatomic.h>

typedef struct {
	eskel_store *store;
	atomic_bool needed; /* once true, true for ever: tokens are revoked, not removed */
} esk_auth;

typedef struct {
	eskel_role role;                               /* 0: nobody, who may still ask what needs no role */
	int64_t token;                                 /* its number, 0 without */
	char actor[sizeof((eskel_token *)NULL)->name]; /* the token's name, "" without */
} esk_caller;

/* authorization is the header's value or NULL. Returns 0, or the status that refuses: 401 for a token that is unknown,
 * expired, revoked or malformed, 503 while the database does not answer. */
int esk_auth_check(esk_auth *auth, const char *authorization, esk_caller *caller);

/* Tokens that are neither expired nor revoked. */
eskel_store_status esk_auth_count_valid(eskel_store *store, size_t *count, eskel_store_error *error);

#endif
