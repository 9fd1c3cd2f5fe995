/* One request and its response, as the handlers see it. */
#ifndef ESK_EXCHANGE_H
#define ESK_EXCHANGE_H

#include "api.h"
#include "json.h"
#include "problem.h"
#include "parameters.h"
#include "route.h"
#include "text.h"

#include "eskel_dicom.h"

#define ESK_RESPONSE_HEADERS 4

/* What a body comes from that is not made at once. */
typedef struct {
	bool (*next)(
		void *source, esk_text *piece); /* appends the next piece, nothing at the end; false: memory ran out */
	bool (*ended)(const void *source); /* whether nothing is the end; NULL: it always is (eskel_response.live) */
	void (*free)(void *source);
	double (*progress)(const void *source); /* the share that is there, 0 to 1; NULL: not known */
	void *source;
} esk_stream;

struct eskel_exchange {
	eskel_api *api;
	const esk_route *route; /* NULL: the path is unknown */
	char *id;               /* the {id} of the path, well formed; NULL without one */
	size_t query_count, header_count;
	eskel_field *query_fields, *headers; /* copies */
	eskel_role role;
	char *actor;
	esk_parameters query; /* borrows from query_fields */
	esk_problem problem;  /* why a handler or check returned false */

	uint64_t body_size;   /* received */
	eskel_intake *intake; /* of ESK_BODY_VOLUME */
	esk_text json;        /* of ESK_BODY_JSON */

	/* Of a job: told the share that is done, false when nobody wants the rest. NULL: somebody waits. */
	bool (*progress)(void *context, double share);
	void *progress_context;

	bool settled;
	eskel_response response;
	eskel_field response_headers[ESK_RESPONSE_HEADERS];
	char *response_body;
	esk_stream stream; /* of a streamed body; all NULL without */
	esk_text piece;    /* of it, that was taken last */
};

/* Decides what the head alone can (admission.c): answers OPTIONS, refuses with the problem and false, or makes the exchange
 * ready for its body. */
bool esk_exchange_admit(eskel_exchange *exchange, const eskel_request *request);

/* 413 when the body is larger than the route takes. at_least is "" for a size that is known, "at least " for one that
 * still grows. */
bool esk_exchange_check_size(eskel_exchange *exchange, const char *at_least, uint64_t size);

/* NULL when it was not sent. */
const char *esk_exchange_request_header(const eskel_exchange *exchange, const char *name);

/* Settles the response; false, with the problem set, when body is NULL or memory ran out. Takes body. */
bool esk_exchange_answer(eskel_exchange *exchange, int status, const char *content_type, char *body, size_t size);
bool esk_exchange_answer_json(eskel_exchange *exchange, int status, json_t *body);
bool esk_exchange_answer_nothing(eskel_exchange *exchange, int status);

/* Settles the response with a body that is streamed. Takes the stream. */
bool esk_exchange_answer_stream(
	eskel_exchange *exchange, int status, const char *content_type, size_t size, const esk_stream *stream);

/* Adds a header to the response to come; name is static. */
bool esk_exchange_add_header(eskel_exchange *exchange, const char *name, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
