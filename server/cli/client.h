/* HTTP requests to one eskeld. */
#ifndef ESK_CLIENT_H
#define ESK_CLIENT_H

#include "complain.h"
#include "progress.h"

#include <stdbool.h>

#define ESK_DEFAULT_SERVER "http://127.0.0.1:8467" /* where eskeld listens when nothing else is said */

typedef struct esk_client esk_client;

/* server: a URL with or without a path; token_file: its first line is the bearer token, NULL for none. The strings are
 * copied, the progress is borrowed. Without progress (NULL) the client is one of several that work at once: what goes wrong
 * while it sends is no complaint but is told by esk_client_complaint. */
esk_outcome esk_client_new(const char *server, const char *token_file, esk_progress *progress, esk_client **client);
void esk_client_free(esk_client *client);

/* Of the last request that failed. */
const char *esk_client_complaint(const esk_client *client);

typedef struct {
	const char *path;   /* "/shapes" */
	const char *query;  /* "&a=b&c=d", "" for none */
	const char *file;   /* POST this file's bytes; NULL: none */
	const char *method; /* without a file; NULL: GET */
} esk_request;

typedef struct {
	long status;
	char *body; /* NUL-terminated; free() it */
	size_t size;
	long retry_after; /* seconds; 0: not said */
	size_t added;     /* shapes, says an enrollment */
	bool weights;     /* it is a volume whose voxels are weights */
} esk_answer;

/* Seconds to wait before asking again what the server had no time for (429, 503), as it says; 0: it has answered. */
long esk_answer_wait(const esk_answer *answer);
enum { ESK_WAIT_MOST = 300 }; /* seconds; a server that is busy for longer is given up by those who wait */

/* Any HTTP answer is ESK_DONE; ESK_MISUSED for a file that cannot be read, ESK_UNREACHABLE without an answer, both with
 * a complaint. */
esk_outcome esk_client_send(esk_client *client, const esk_request *request, esk_answer *answer);

/* The same, but the body of a success goes to the file at path (NULL: standard output) as it comes, and the answer's is
 * empty. A file that cannot be written is ESK_REFUSED; one that is not whole stays as it is, with a complaint. */
esk_outcome esk_client_download(esk_client *client, const esk_request *request, const char *path, esk_answer *answer);

/* The same, but each line of the body of a success is shown as it comes, without its end. */
esk_outcome esk_client_listen(esk_client *client, const esk_request *request,
	void (*line)(void *context, const char *line), void *context, esk_answer *answer);

#endif
