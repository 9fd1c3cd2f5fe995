/* eskel evaluate: one distance on the stored shapes, or all distances, a request each. */
#include "command.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* What distances differ in, and the ways that --all tries: all combinations. An option that is given stays as it is. */
static const struct axis {
	const char *options[3];
	const char *ways[5];
} axes[] = {
	{{"signature"}, {"&signature=log", "&signature=paper"}},
	{{"distance", "level"}, {"&distance=sum", "&distance=level&level=4", "&distance=level&level=10"}},
	{{"metric"}, {"&metric=manhattan", "&metric=euclidean", "&metric=root"}},
	{{"size"}, {"&size=fixed", "&size=free"}},
};

enum { AXIS_COUNT = sizeof axes / sizeof *axes };

static bool is_given(const esk_arguments *arguments, const struct axis *axis)
{
	for (const char *const *option = axis->options; *option; option++)
		if (esk_arguments_value(arguments, *option))
			return true;
	return false;
}

static size_t way_count(const esk_arguments *arguments, const struct axis *axis)
{
	size_t count = 0;
	if (!esk_arguments_value(arguments, "all") || is_given(arguments, axis))
		return 1;
	while (axis->ways[count])
		count++;
	return count;
}

static size_t combination_count(const esk_arguments *arguments)
{
	size_t count = 1;
	for (size_t a = 0; a < AXIS_COUNT; a++)
		count *= way_count(arguments, &axes[a]);
	return count;
}

/* The last axis changes fastest. free() it; NULL, with a complaint, when memory ran out. */
static char *combination(const esk_arguments *arguments, size_t number)
{
	char *text = NULL;
	size_t size, left = combination_count(arguments);
	FILE *out = open_memstream(&text, &size);
	for (size_t a = 0; out && a < AXIS_COUNT; a++) {
		const size_t ways = way_count(arguments, &axes[a]);
		left /= ways;
		fputs(ways > 1 ? axes[a].ways[number / left % ways] : "", out);
	}
	return esk_session_close_text(out, &text);
}

static esk_outcome evaluate(esk_session *session, size_t number)
{
	char *chosen = combination(session->arguments, number);
	char *query = chosen ? esk_session_query(session, chosen) : NULL;
	const esk_request request = {.path = "/evaluation", .query = query};
	esk_outcome outcome =
		query ? esk_session_ask(session, &request, *chosen ? chosen + 1 : "evaluation") : ESK_REFUSED;
	free(query);
	free(chosen);
	return outcome;
}

static esk_outcome evaluate_all(esk_session *session)
{
	const size_t count = combination_count(session->arguments);
	esk_outcome worst = ESK_DONE;
	session->progress.items = count;
	for (size_t i = 0; i < count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(worst, evaluate(session, i));
	return worst;
}

static esk_outcome write_text(char *text, FILE *out)
{
	if (!text)
		return esk_complain(ESK_REFUSED, "memory ran out");
	fputs(text, out);
	free(text);
	return ESK_DONE;
}

/* In place of the tables, which the session would print. */
static esk_outcome write_csv(esk_session *session)
{
	esk_outcome outcome = write_text(eskel_report_csv(session->report), stdout);
	eskel_report_free(session->report);
	session->report = NULL;
	return outcome;
}

static esk_outcome close_page(const esk_session *session, const char *path, FILE *page)
{
	esk_outcome outcome = write_text(eskel_report_html(session->report), page);
	if (fclose(page))
		outcome = esk_outcome_worse(outcome, esk_complain(ESK_REFUSED, "%s: %s", path, strerror(errno)));
	return outcome;
}

esk_outcome esk_command_evaluate(esk_session *session)
{
	const char *path = esk_arguments_value(session->arguments, "html");
	FILE *page = NULL;
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_EVALUATION);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (!outcome && path) {
		page = fopen(path, "we");
		if (!page)
			outcome = esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	}
	if (!outcome)
		outcome = evaluate_all(session);
	if (page)
		outcome = esk_outcome_worse(outcome, close_page(session, path, page));
	if (esk_arguments_value(session->arguments, "csv") && session->report)
		outcome = esk_outcome_worse(outcome, write_csv(session));
	return outcome;
}
