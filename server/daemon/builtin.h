/* The paths that are the server's own: the page and its files, and /metrics. All others are the API's. */
#ifndef ESK_BUILTIN_H
#define ESK_BUILTIN_H

#include "server.h"

typedef struct {
	eskel_response response;
	const char *route; /* static */
	char *text;        /* what the response owns, or NULL */
} esk_builtin_response;

/* False when the path is none of them. */
bool esk_builtin_answer(
	esk_server *server, const char *method, const char *path, eskel_role role, esk_builtin_response *answer);

/* A refusal as problem+json with the headers that its status asks for. The route is untouched. */
void esk_builtin_refuse(int status, const char *detail, esk_builtin_response *answer);

#endif
