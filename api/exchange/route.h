/* The flat table of routes: what may be asked of which path, by whom, and who answers. */
#ifndef ESK_ROUTE_H
#define ESK_ROUTE_H

#include "eskel_api.h"

typedef enum { ESK_BODY_NONE, ESK_BODY_VOLUME, ESK_BODY_JSON } esk_body;

typedef struct {
	const char *path;   /* template; {id} stands for one segment */
	const char *method; /* GET serves HEAD as well, and every path OPTIONS */
	eskel_role role;    /* least role; 0: nobody needs to be known */
	esk_body body;
	bool heavy;               /* computes, or waits for the disk (eskel_exchange_is_heavy) */
	const char *const *query; /* parameters allowed, NULL-terminated */
	bool (*check)(
		eskel_exchange *exchange); /* refuses by the head alone what the parameters' ranges do not; or NULL */
	bool (*handle)(eskel_exchange *exchange); /* answers and returns true, or sets the problem and returns false */
} esk_route;

const esk_route *esk_route_table(size_t *count);

/* Any route of a path, NULL when the path is unknown; *segment is where the path's {id} starts, NULL without one. */
const esk_route *esk_route_of_path(const char *path, const char **segment);
/* The route of the same path with a method, NULL if the path has it not. */
const esk_route *esk_route_of_method(const esk_route *route, const char *method);

/* The value of Allow: "GET, HEAD, OPTIONS". */
#define ESK_ALLOW_SIZE 64
void esk_route_allow(const esk_route *route, char allow[ESK_ALLOW_SIZE]);

#endif
