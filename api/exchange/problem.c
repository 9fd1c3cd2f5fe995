/* Refusals, see problem.h, and the one table that says which HTTP status an engine or store status becomes. */
#include "problem.h"

#include "eskel_api.h"
#include "json.h"
#include "text.h"

#include <stdarg.h>
#include <stdio.h>

/* A body is 415 when it is no volume that is read here, 422 when it is one with something wrong in it. */
static const int engine_statuses[ESKEL_STATUS_COUNT] = {
	[ESKEL_INVALID] = 500,
	[ESKEL_NO_MEMORY] = 503,
	[ESKEL_NOT_VOLUME] = 415,
	[ESKEL_TRUNCATED] = 422,
	[ESKEL_MALFORMED] = 422,
	[ESKEL_UNSUPPORTED] = 415,
	[ESKEL_TOO_LARGE] = 413,
	[ESKEL_BAD_GEOMETRY] = 422,
	[ESKEL_BAD_VALUE] = 422,
	[ESKEL_EMPTY] = 422,
	[ESKEL_NOT_FOUND] = 404,
	[ESKEL_NUMERIC] = 500,
	[ESKEL_CANCELLED] = 503,
};

static int store_http_status(eskel_store_status status)
{
	switch (status) {
	case ESKEL_STORE_NOT_FOUND:
		return 404;
	case ESKEL_STORE_CONFLICT:
		return 412;
	case ESKEL_STORE_NO_MEMORY:
	case ESKEL_STORE_BUSY:
	case ESKEL_STORE_READ_ONLY:
		return 503;
	case ESKEL_STORE_FULL:
		return 507;
	default:
		return 500;
	}
}

static const struct {
	int status;
	const char *text;
} titles[] = {
	{400, "Bad Request"},
	{401, "Unauthorized"},
	{403, "Forbidden"},
	{404, "Not Found"},
	{405, "Method Not Allowed"},
	{408, "Request Timeout"},
	{409, "Conflict"},
	{411, "Length Required"},
	{412, "Precondition Failed"},
	{413, "Content Too Large"},
	{414, "URI Too Long"},
	{415, "Unsupported Media Type"},
	{416, "Range Not Satisfiable"},
	{421, "Misdirected Request"},
	{422, "Unprocessable Content"},
	{429, "Too Many Requests"},
	{431, "Request Header Fields Too Large"},
	{500, "Internal Server Error"},
	{501, "Not Implemented"},
	{503, "Service Unavailable"},
	{507, "Insufficient Storage"},
};

static const char *title_of(int status)
{
	for (size_t i = 0; i < sizeof titles / sizeof *titles; i++)
		if (titles[i].status == status)
			return titles[i].text;
	return "Error";
}

bool esk_problem_set(esk_problem *problem, int status, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(problem->text, sizeof problem->text, format, arguments);
	va_end(arguments);
	esk_text_clean(problem->text);
	problem->status = status;
	return false;
}

bool esk_problem_no_memory(esk_problem *problem)
{
	return esk_problem_set(problem, 503, "memory ran out; try again later");
}

bool esk_problem_no_shape(esk_problem *problem, const char *id)
{
	return esk_problem_set(problem, 404, "there is no shape %s", id);
}

bool esk_problem_no_job(esk_problem *problem, const char *id)
{
	return esk_problem_set(problem, 404, "there is no job %s", id);
}

bool esk_problem_engine(esk_problem *problem, eskel_status status, const eskel_error *error)
{
	if (status == ESKEL_OK)
		return true;
	const char *text = error && error->text[0] ? error->text : eskel_status_text(status);
	return esk_problem_set(problem, engine_statuses[status], "%s", text);
}

bool esk_problem_store(esk_problem *problem, eskel_store_status status, const eskel_store_error *error)
{
	if (status == ESKEL_STORE_OK)
		return true;
	const char *text = error && error->text[0] ? error->text : eskel_store_status_text(status);
	return esk_problem_set(problem, store_http_status(status), "%s", text);
}

char *eskel_problem_text(int status, const char *detail)
{
	json_t *body = json_pack("{s:s, s:s, s:i, s:s}", "type", "about:blank", "title", title_of(status), "status",
		status, "detail", detail);
	return esk_json_text(body);
}
