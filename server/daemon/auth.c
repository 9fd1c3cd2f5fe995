#include "auth.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

static int check_nobody(esk_auth *auth, esk_caller *caller)
{
	if (!atomic_load(&auth->needed)) {
		eskel_token *tokens = NULL;
		size_t count = 0;
		if (eskel_store_tokens(auth->store, &tokens, &count, NULL) != ESKEL_STORE_OK)
			return 503;
		free(tokens);
		if (count)
			atomic_store(&auth->needed, true);
	}
	*caller = (esk_caller){.role = atomic_load(&auth->needed) ? 0 : ESKEL_ROLE_ADMIN};
	return 0;
}

int esk_auth_check(esk_auth *auth, const char *authorization, esk_caller *caller)
{
	static const char scheme[] = "Bearer ";
	if (!authorization)
		return check_nobody(auth, caller);
	if (strncasecmp(authorization, scheme, sizeof scheme - 1) != 0)
		return 401;
	eskel_token token;
	switch (eskel_store_token_verify(auth->store, authorization + sizeof scheme - 1, time(NULL), &token, NULL)) {
	case ESKEL_STORE_OK:
		break;
	case ESKEL_STORE_NOT_FOUND:
	case ESKEL_STORE_INVALID:
		return 401;
	default:
		return 503;
	}
	*caller = (esk_caller){.role = token.role, .token = token.number};
	memcpy(caller->actor, token.name, sizeof caller->actor);
	return 0;
}

eskel_store_status esk_auth_count_valid(eskel_store *store, size_t *count, eskel_store_error *error)
{
	eskel_token *tokens = NULL;
	size_t all = 0, valid = 0;
	eskel_store_status status = eskel_store_tokens(store, &tokens, &all, error);
	if (status != ESKEL_STORE_OK)
		return status;
	int64_t now = time(NULL);
	for (size_t t = 0; t < all; t++)
		valid += !tokens[t].revoked && (!tokens[t].expires || tokens[t].expires > now);
	free(tokens);
	*count = valid;
	return ESKEL_STORE_OK;
}
