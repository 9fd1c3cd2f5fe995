/* eskel api: the REST resources, without a socket.
 *
 * An exchange is one request and its response. The transport begins it with the request's head, feeds it the body as
 * the bytes arrive, finishes it (the work is done here) and sends the response:
 *
 *     eskel_api_begin -> [eskel_exchange_response early?] -> eskel_exchange_feed* -> eskel_exchange_finish -> response
 *     [-> eskel_exchange_next* when its body is streamed]
 *
 * A volume is decoded while it is fed; nothing keeps a whole body but the small JSON ones. Every refusal is
 * application/problem+json (RFC 9457) with one sentence that names the offending and the expected value.
 * Functions may be called from any thread, those of one exchange from one thread at a time.
 */
#ifndef ESKEL_API_H
#define ESKEL_API_H

#include "eskel_store.h"

typedef struct eskel_api eskel_api;

typedef struct {
	uint64_t most_body_bytes;        /* of a posted volume as sent; default 1 GiB */
	uint64_t most_voxels;            /* of its grid; default 2^31 */
	uint64_t most_runs;              /* of all its labels together; default 2^24: work takes up to 150 bytes a run */
	uint32_t most_labels;            /* in one request; default 1024 */
	uint64_t most_distances;         /* cells of a matrix that is drawn; default 4 million */
	uint64_t most_known_bytes;       /* of shapes that recognitions have read, 24 kB each; default 2 GiB */
	uint64_t most_result_bytes;      /* of all jobs' results together, on disk; default 16 GiB */
	uint64_t most_mesh_bytes;        /* of meshes that are kept, on disk; default 1 GiB */
	eskel_store_options store;
	/* Told now and then while the library fills; false stops, and open fails with ESKEL_STORE_INVALID. */
	bool (*loading)(void *context, uint64_t loaded, uint64_t total);
	void *context;
} eskel_api_options;

/* Opens the store and fills the library of signatures from it. */
ESKEL_API eskel_store_status eskel_api_open(const char *database, const eskel_api_options *options, eskel_api **api,
	eskel_store_error *error);
ESKEL_API void eskel_api_close(eskel_api *api);

/* Shapes in the library, for /metrics. */
ESKEL_API size_t eskel_api_shape_count(const eskel_api *api);

/* For the transport to verify bearer tokens, and for the program's token command. */
ESKEL_API eskel_store *eskel_api_store(eskel_api *api);

/* ---------------------------------------------------------------------------------------------- request */

typedef struct {
	const char *name, *value;
} eskel_field;

typedef struct {
	const char *method;              /* as sent, "GET" */
	const char *path;                /* percent-decoded, without the query, "/shapes/0123..." */
	size_t query_count;
	const eskel_field *query;        /* percent-decoded, in the order sent; value "" for a bare name */
	size_t header_count;
	const eskel_field *headers;
	int64_t body_size;               /* Content-Length; 0 without a body, -1 when unknown (chunked) */
	eskel_role role;                 /* what the caller may do; 0: not authenticated */
	const char *actor;               /* who, for the audit; NULL when no token was needed */
} eskel_request;

typedef struct {
	int status;
	const char *content_type;        /* NULL without a body */
	size_t header_count;
	const eskel_field *headers;      /* Location, ETag, Link, Allow, Retry-After ... */
	const void *body;
	size_t size;                     /* ESKEL_SIZE_UNKNOWN: of a streamed body that shows its size at its end */
	bool streamed;                   /* the body comes from eskel_exchange_next */
	bool live;                       /* in pieces as there is news, each made at once and in any thread */
} eskel_response;

#define ESKEL_SIZE_UNKNOWN SIZE_MAX

typedef struct eskel_exchange eskel_exchange;

/* Copies what it keeps of the request. NULL only when memory ran out. */
ESKEL_API eskel_exchange *eskel_api_begin(eskel_api *api, const eskel_request *request);
ESKEL_API void eskel_exchange_free(eskel_exchange *exchange);

/* "/shapes/{id}": for logs and metrics, static; "" for a path without a route. */
ESKEL_API const char *eskel_exchange_route(const eskel_exchange *exchange);

/* The response if it is settled, NULL before. Settled after begin: a refusal by the head alone (route, method, role,
 * query, size); during feed: a refusal of the body, the rest of which may be discarded; after finish: always. Owned by
 * the exchange. A HEAD response has the body of the GET; the transport leaves it out. */
ESKEL_API const eskel_response *eskel_exchange_response(const eskel_exchange *exchange);

/* Ignored once the response is settled. */
ESKEL_API void eskel_exchange_feed(eskel_exchange *exchange, const void *bytes, size_t size);

/* True when finish computes (skeletons, searches, matrices) or waits for the disk, and belongs into a worker, not a
 * network thread. */
ESKEL_API bool eskel_exchange_is_heavy(const eskel_exchange *exchange);
ESKEL_API void eskel_exchange_finish(eskel_exchange *exchange);

/* The next piece of a streamed body, which computes and belongs into a worker; *size is 0 after the last one. Of a live one
 * it is 0 also when there is nothing to say yet: ask again in a while, until it has ended. The bytes stay until the next
 * call. False when memory ran out: the transport breaks the connection off, lest the client take a
 * part for the whole. Nothing is left to be undone when the transport asks no more. */
ESKEL_API bool eskel_exchange_next(eskel_exchange *exchange, const void **bytes, size_t *size);
/* Whether the last piece was empty because it was the last. */
ESKEL_API bool eskel_exchange_ended(const eskel_exchange *exchange);

/* The same problem+json body for refusals by the transport itself (401, 413, 429, 503 ...). free() it; NULL when
 * memory ran out. */
ESKEL_API char *eskel_problem_text(int status, const char *detail);

/* ---------------------------------------------------------------------------------------------- without a server */

/* The JSON of GET /shapes/{id}/skeleton. free() it. */
ESKEL_API char *eskel_skeleton_text(const eskel_skeleton *skeleton);

#endif
