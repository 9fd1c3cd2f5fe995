/* One run of a command: what was asked for, the server, and the answers as they come in.
 *
 * Answers are collected in a report and printed as one table at the end; with --json each is printed as it came, on a
 * line of its own, as soon as it is there. */
#ifndef ESK_SESSION_H
#define ESK_SESSION_H

#include "arguments.h"
#include "client.h"
#include "progress.h"

#include "eskel_report.h"

#include <stdbool.h>

struct esk_session {
	const esk_arguments *arguments;
	esk_progress progress; /* an item an operand */
	esk_client *client;
	eskel_report *report;
};

/* For answers of this kind. The client is there only after esk_session_connect. Close it either way. */
esk_outcome esk_session_open(esk_session *session, eskel_report_kind kind);
esk_outcome esk_session_connect(esk_session *session);

/* A further client of the same server, without progress. */
esk_outcome esk_session_new_client(const esk_session *session, esk_client **client);

/* Prints the report and frees what the session holds; returns the outcome, or a worse one. */
esk_outcome esk_session_close(esk_session *session, esk_outcome outcome);

/* Sends the request; a refusal is a complaint with the server's reason, where source is what people call the thing
 * asked about. */
esk_outcome esk_session_send(esk_session *session, const esk_request *request, const char *source, esk_answer *answer);

/* Sends the request; the body of the answer goes to the file at path, or to standard output, as it comes. */
esk_outcome esk_session_download(
	esk_session *session, const esk_request *request, const char *source, const char *path);

/* Sends the request; each line of the answer is shown as it comes. */
esk_outcome esk_session_listen(esk_session *session, const esk_request *request, const char *source,
	void (*line)(void *context, const char *line), void *context);

/* Takes in JSON of the session's kind. */
esk_outcome esk_session_take(esk_session *session, const char *source, const char *json, size_t size);

/* Sends and takes in. */
esk_outcome esk_session_ask(esk_session *session, const esk_request *request, const char *source);

/* What is in front and the operand, percent-encoded. free() it; NULL, with a complaint, when memory ran out. */
char *esk_session_path(const char *in_front, const char *operand);

/* The query parameters among the arguments, after what is in front. free() it; NULL, with a complaint, when memory ran
 * out. */
char *esk_session_query(const esk_session *session, const char *in_front);

/* Closes what open_memstream opened on *text, or did not (out is NULL). The text; NULL, with a complaint, when memory
 * ran out. */
char *esk_session_close_text(FILE *out, char **text);

/* The worse of two. */
esk_outcome esk_outcome_worse(esk_outcome a, esk_outcome b);

#endif
