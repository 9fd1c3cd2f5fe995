/* GET /jobs/{id}/events: what becomes of a job, as server-sent events
 * (https://html.spec.whatwg.org/multipage/server-sent-events.html).
 *
 *	event: state       when it is first looked at and whenever its state changes
 *	event: progress    when another thousandth is done
 *	event: gone        when it is there no more
 *
 * The data of the first two is what GET /jobs/{id} answers, so that nothing need be told again to who comes late or comes
 * back: a Last-Event-ID changes nothing, but that of the last event of a job, which has the only id that is given. Who
 * sends that has seen all, and is answered 204, which keeps an EventSource from coming back for ever.
 *
 * A stream is looked at a few times a second, without a thread of its own. A comment is sent when there was nothing to say
 * for some seconds, so that a client that is gone is noticed. It ends after ten minutes, which is no loss, for a
 * client comes back at once: lest a token that was revoked in the meantime be good for as long as a job lasts. */
#include "job_json.h"
#include "resources.h"

#include "clock.h"

#include <stdlib.h>
#include <string.h>

static const double heartbeat_ms = 5000, longest_ms = 600000;
static const char last_id[] = "end";

typedef struct {
	esk_jobs *jobs;
	char id[ESKEL_ID_SIZE];
	double begun, spoken;
	bool told; /* something, which was: */
	esk_job_state state;
	int thousandths;
	bool ended;
} watcher;

static bool write_event(esk_text *piece, const char *event, json_t *data)
{
	char *text = esk_json_text(data); /* with the line's end */
	if (!text)
		return false;
	esk_text_print(piece, "event: %s\ndata: %s\n", event, text);
	free(text);
	return true;
}

static bool write_job(watcher *w, esk_text *piece, const esk_job *job)
{
	const int thousandths = (int)(1e3 * job->progress);
	const bool changed = !w->told || job->state != w->state;
	if (!changed && thousandths == w->thousandths)
		return true;
	w->told = true;
	w->state = job->state;
	w->thousandths = thousandths;
	w->ended = job->state >= ESK_JOB_DONE;
	if (w->ended)
		esk_text_print(piece, "id: %s\n", last_id);
	return write_event(piece, changed ? "state" : "progress", esk_job_json(job));
}

/* An esk_stream's; appends nothing when there is nothing to say. */
static bool next(void *context, esk_text *piece)
{
	watcher *w = context;
	esk_job job;
	const double now = esk_clock_milliseconds();
	bool good = true;
	if (w->ended)
		return true;
	if (esk_jobs_find(w->jobs, w->id, &job))
		good = write_job(w, piece, &job);
	else if ((w->ended = true))
		good = write_event(piece, "gone", json_pack("{s:s}", "id", w->id));
	if (now - w->begun > longest_ms)
		w->ended = true;
	if (piece->size == 0 && now - w->spoken > heartbeat_ms)
		esk_text_print(piece, ":\n\n");
	if (piece->size > 0)
		w->spoken = now;
	return good && !piece->failed;
}

static bool has_ended(const void *context)
{
	return ((const watcher *)context)->ended;
}

static void free_watcher(void *context)
{
	watcher *w = context;
	esk_jobs_unwatch(w->jobs);
	free(w);
}

static watcher *make_watcher(eskel_exchange *exchange)
{
	watcher *w = calloc(1, sizeof *w);
	if (!w) {
		esk_problem_no_memory(&exchange->problem);
		return NULL;
	}
	w->jobs = exchange->api->jobs;
	w->begun = w->spoken = esk_clock_milliseconds();
	memcpy(w->id, exchange->id, sizeof w->id);
	if (esk_jobs_watch(w->jobs, &exchange->problem))
		return w;
	free(w);
	return NULL;
}

bool esk_job_get_events(eskel_exchange *exchange)
{
	esk_job job;
	if (!esk_jobs_find(exchange->api->jobs, exchange->id, &job))
		return esk_problem_no_job(&exchange->problem, exchange->id);
	const char *seen = esk_exchange_request_header(exchange, "Last-Event-ID");
	if (seen && strcmp(seen, last_id) == 0 && job.state >= ESK_JOB_DONE)
		return esk_exchange_answer_nothing(exchange, 204);
	/* a proxy that waits for more before it passes on what there is makes events useless; nginx asks for this */
	if (!esk_exchange_add_header(exchange, "X-Accel-Buffering", "no"))
		return false;
	watcher *w = make_watcher(exchange);
	const esk_stream stream = {.next = next, .ended = has_ended, .free = free_watcher, .source = w};
	return w && esk_exchange_answer_stream(exchange, 200, "text/event-stream", ESKEL_SIZE_UNKNOWN, &stream);
}
