#include "session.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

esk_outcome esk_outcome_worse(esk_outcome a, esk_outcome b)
{
	return a > b ? a : b;
}

esk_outcome esk_session_open(esk_session *session, eskel_report_kind kind)
{
	const esk_arguments *arguments = session->arguments;
	esk_progress_begin(&session->progress, esk_arguments_value(arguments, "quiet"),
		arguments->operand_count > 0 ? arguments->operand_count : 1);
	if (eskel_report_new(kind, &session->report))
		return esk_complain(ESK_REFUSED, "memory ran out");
	return ESK_DONE;
}

/* The option, or else the environment, or else the default. */
static const char *setting(
	const esk_arguments *arguments, const char *option, const char *variable, const char *otherwise)
{
	const char *value = esk_arguments_value(arguments, option);
	if (!value)
		value = getenv(variable);
	return value && *value ? value : otherwise;
}

static esk_outcome connect_client(const esk_arguments *arguments, esk_progress *progress, esk_client **client)
{
	const char *server = setting(arguments, "server", "ESKEL_SERVER", ESK_DEFAULT_SERVER);
	const char *token_file = setting(arguments, "token-file", "ESKEL_TOKEN_FILE", NULL);
	return esk_client_new(server, token_file, progress, client);
}

esk_outcome esk_session_connect(esk_session *session)
{
	return connect_client(session->arguments, &session->progress, &session->client);
}

esk_outcome esk_session_new_client(const esk_session *session, esk_client **client)
{
	return connect_client(session->arguments, NULL, client);
}

/* https://no-color.org */
static bool wants_colour(void)
{
	const char *no_color = getenv("NO_COLOR");
	return isatty(STDOUT_FILENO) == 1 && !(no_color && *no_color);
}

static esk_outcome print(const esk_session *session)
{
	if (!session->report || esk_arguments_value(session->arguments, "json"))
		return ESK_DONE;
	char *text = eskel_report_text(session->report, wants_colour());
	if (!text)
		return esk_complain(ESK_REFUSED, "memory ran out");
	fputs(text, stdout);
	free(text);
	return ESK_DONE;
}

esk_outcome esk_session_close(esk_session *session, esk_outcome outcome)
{
	outcome = esk_outcome_worse(outcome, print(session));
	if (fflush(stdout))
		outcome = esk_outcome_worse(outcome, esk_complain(ESK_REFUSED, "standard output: %s", strerror(errno)));
	eskel_report_free(session->report);
	esk_client_free(session->client);
	session->report = NULL;
	session->client = NULL;
	return outcome;
}

/* Complains of a refusal, with the server's reason, and frees it. */
static esk_outcome judge(const char *source, esk_answer *got)
{
	if (got->status >= 200 && got->status < 300)
		return ESK_DONE;
	char *detail = eskel_report_problem(got->body, got->size);
	if (detail)
		esk_complain(ESK_REFUSED, "%s: %s", source, detail);
	else
		esk_complain(ESK_REFUSED, "%s: the server answered %ld without a reason", source, got->status);
	free(detail);
	free(got->body);
	return ESK_REFUSED;
}

esk_outcome esk_session_send(esk_session *session, const esk_request *request, const char *source, esk_answer *answer)
{
	esk_answer got = {0};
	esk_progress_next(&session->progress, source);
	esk_outcome outcome = esk_client_send(session->client, request, &got);
	if (!outcome)
		outcome = judge(source, &got);
	if (!outcome)
		*answer = got;
	return outcome;
}

/* The end of a request whose answer went elsewhere. */
static esk_outcome judge_sent(const char *source, esk_outcome outcome, esk_answer *got)
{
	if (!outcome)
		outcome = judge(source, got);
	if (!outcome)
		free(got->body);
	return outcome;
}

esk_outcome esk_session_download(esk_session *session, const esk_request *request, const char *source, const char *path)
{
	esk_answer got = {0};
	esk_progress_next(&session->progress, source);
	const esk_outcome outcome = esk_client_download(session->client, request, path, &got);
	return judge_sent(source, outcome, &got);
}

esk_outcome esk_session_listen(esk_session *session, const esk_request *request, const char *source,
	void (*line)(void *context, const char *line), void *context)
{
	esk_answer got = {0};
	esk_progress_next(&session->progress, source);
	const esk_outcome outcome = esk_client_listen(session->client, request, line, context, &got);
	return judge_sent(source, outcome, &got);
}

esk_outcome esk_session_take(esk_session *session, const char *source, const char *json, size_t size)
{
	switch (eskel_report_add(session->report, basename(source), json, size)) {
	case ESKEL_OK:
		break;
	case ESKEL_NO_MEMORY:
		return esk_complain(ESK_REFUSED, "memory ran out");
	default:
		return esk_complain(ESK_UNREACHABLE, "%s: the answer is not one of eskeld's", source);
	}
	if (esk_arguments_value(session->arguments, "json")) {
		fwrite(json, 1, size, stdout);
		fputs(size > 0 && json[size - 1] == '\n' ? "" : "\n", stdout);
		fflush(stdout);
	}
	return ESK_DONE;
}

esk_outcome esk_session_ask(esk_session *session, const esk_request *request, const char *source)
{
	esk_answer answer = {0};
	esk_outcome outcome = esk_session_send(session, request, source, &answer);
	if (!outcome)
		outcome = esk_session_take(session, source, answer.body, answer.size);
	free(answer.body);
	return outcome;
}

char *esk_session_close_text(FILE *out, char **text)
{
	if (out && !fclose(out))
		return *text;
	free(*text);
	esk_complain(ESK_REFUSED, "memory ran out");
	return NULL;
}

char *esk_session_path(const char *in_front, const char *operand)
{
	char *path = NULL;
	size_t size;
	FILE *out = open_memstream(&path, &size);
	if (out) {
		fputs(in_front, out);
		esk_arguments_write_escaped(operand, out);
	}
	return esk_session_close_text(out, &path);
}

char *esk_session_query(const esk_session *session, const char *in_front)
{
	char *query = NULL;
	size_t size;
	FILE *out = open_memstream(&query, &size);
	if (out) {
		fputs(in_front, out);
		esk_arguments_write_query(session->arguments, NULL, out);
	}
	return esk_session_close_text(out, &query);
}
