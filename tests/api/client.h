/* Requests to an eskel_api in the same process, made as a transport makes them. For tests; whatever fails here ends the
 * program.
 *
 * When the environment names a file in ESKEL_ANSWERS, each request and its answer is appended to it as a line of JSON:
 * check_answers.py holds them against openapi.yaml. */
#ifndef CLIENT_H
#define CLIENT_H

#include "eskel_api.h"
#include "volumes.h"

#include <jansson.h>

typedef struct {
	char *folder, *path;
	eskel_api *api;
} api_fixture;

/* An api over a new database, in *state: for cmocka. */
int api_set_up(void **state);
int api_tear_down(void **state);
void api_reopen(api_fixture *f);

#define api_test(name) cmocka_unit_test_setup_teardown(name, api_set_up, api_tear_down)

typedef struct {
	const char *method; /* NULL: GET, or POST with a body */
	const char *target; /* as in a request line: "/shapes?limit=3" */
	const void *body;
	size_t size;
	size_t piece;           /* bytes fed at a time; 0: all at once */
	bool chunked;           /* the size is not told ahead */
	eskel_field headers[4]; /* up to the first without a name */
	eskel_role role;        /* 0 is admin; nobody below: nobody */
	bool nobody;
} question;

typedef struct {
	int status;
	const char *route;                                                        /* static */
	char *type, *location, *etag, *link, *allow, *challenge, *part, *caching; /* headers; NULL without */
	char *body;                                                               /* with a terminating 0 */
	size_t size;
	json_t *json; /* the body, NULL if it is not JSON */
	bool early;   /* settled before the body was fed */
	bool streamed;
} answer;

answer ask(eskel_api *api, const question *q);
void answer_free(answer *a);

/* The usual ones. The format makes the target. */
answer get(eskel_api *api, const char *format, ...) __attribute__((format(printf, 2, 3)));
answer post_volume(eskel_api *api, const volume_file *file, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* A member by path, "shapes.0.id"; ends the program without it. Borrowed. */
json_t *at(const answer *a, const char *path);
const char *text_at(const answer *a, const char *path); /* NULL for null */
double number_at(const answer *a, const char *path);

/* Fails the test, with what was answered, unless the status is this one and the body has the fragment. */
void assert_answer(const char *file, int line, const answer *a, int status, const char *fragment);
#define assert_status(a, status) assert_answer(__FILE__, __LINE__, (a), (status), "")
#define assert_says(a, status, fragment) assert_answer(__FILE__, __LINE__, (a), (status), (fragment))

/* Enrolls blob member of family with a query; its id. */
void enroll_blob(
	eskel_api *api, unsigned family, unsigned member, int mirrored, const char *query, char id[ESKEL_ID_SIZE]);

#endif
