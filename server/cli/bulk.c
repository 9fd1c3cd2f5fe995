/* Workers take the next posting each, until none is left or something stops them; the first thread watches, draws the
 * progress and joins them. */
#include "bulk.h"

#include "arguments.h"

#include "eskel_report.h"
#include "eskel_rows.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

/* Enough that the server computes while files are read and rows are written; its processors are shared anyway. */
enum { default_connections = 4, most_connections = 64 };
static const double watch_seconds = 0.1;

typedef struct {
	esk_session *session;
	esk_bulk *bulk;
	pthread_mutex_t lock; /* over all below, results, and standard output */
	pthread_cond_t changed;
	size_t next, ended, running;
	uint64_t bytes, bytes_ended;
	bool stopping;
	esk_outcome worst;
} pool;

static volatile sig_atomic_t interrupts;

static void count_interrupt(int signal_number)
{
	(void)signal_number;
	interrupts++;
}

/* The next Ctrl-C is counted, the one after it ends the program. */
static void catch_interrupt(struct sigaction *before)
{
	struct sigaction action = {.sa_handler = count_interrupt, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
	sigemptyset(&action.sa_mask);
	interrupts = 0;
	sigaction(SIGINT, &action, before);
}

/* ---- one posting */

static struct timespec moment_in(double seconds)
{
	struct timespec t;
	clock_gettime(CLOCK_REALTIME, &t);
	t.tv_sec += (time_t)seconds;
	t.tv_nsec += (long)(1e9 * (seconds - (double)(time_t)seconds));
	t.tv_sec += t.tv_nsec / 1000000000;
	t.tv_nsec %= 1000000000;
	return t;
}

/* False when the pool stops meanwhile. */
static bool wait_for(pool *p, long seconds)
{
	const struct timespec end = moment_in((double)seconds);
	int result = 0;
	pthread_mutex_lock(&p->lock);
	while (!p->stopping && result != ETIMEDOUT)
		result = pthread_cond_timedwait(&p->changed, &p->lock, &end);
	const bool waited = !p->stopping;
	pthread_mutex_unlock(&p->lock);
	return waited;
}

/* Sends it until the server has time for it. False when the pool stops while it waits. */
static bool send_patiently(
	pool *p, esk_client *client, const esk_posting *posting, esk_answer *answer, esk_outcome *outcome)
{
	const esk_request request = {.path = "/shapes", .query = posting->query, .file = posting->file};
	long waited = 0;
	for (;;) {
		*outcome = esk_client_send(client, &request, answer);
		const long seconds = *outcome ? 0 : esk_answer_wait(answer);
		if (seconds == 0 || waited >= ESK_WAIT_MOST)
			return true;
		free(answer->body);
		*answer = (esk_answer){0};
		if (!wait_for(p, seconds))
			return false;
		waited += seconds;
	}
}

static char *reason_of(const esk_answer *answer)
{
	char *reason = eskel_report_problem(answer->body, answer->size);
	if (!reason && asprintf(&reason, "the server answered %ld without a reason", answer->status) < 0)
		reason = NULL;
	return reason;
}

/* The client's complaint, which begins with the file's name. */
static char *complaint_of(const esk_client *client, const char *file)
{
	const char *complaint = esk_client_complaint(client);
	const size_t size = strlen(file);
	const bool named = !strncmp(complaint, file, size) && !strncmp(complaint + size, ": ", 2);
	return strdup(named ? complaint + size + 2 : complaint);
}

/* A success counts its shapes, and must be what the manifest says. */
static void judge_success(
	const esk_bulk *bulk, const esk_posting *posting, const esk_answer *answer, esk_posting_result *result)
{
	eskel_rows *rows = NULL;
	if (eskel_rows_read(answer->body, answer->size, &rows) || eskel_rows_count(rows) < answer->added) {
		*result = (esk_posting_result){ESK_POSTING_REFUSED, 0, 0, strdup("the answer is not one of eskeld's")};
		eskel_rows_free(rows);
		return;
	}
	result->added = answer->added;
	result->there = eskel_rows_count(rows) - answer->added;
	result->state = answer->added > 0 ? ESK_POSTING_ADDED : ESK_POSTING_THERE;
	eskel_rows_free(rows);
	result->reason = bulk->verified ? esk_manifest_compare(bulk->verified, posting, answer) : NULL;
	if (result->reason)
		result->state = ESK_POSTING_REFUSED;
}

/* What is refused for reasons that are not the file's will be refused for every file. */
static bool is_hopeless(long status)
{
	return status == 401 || status == 403 || status == 404 || status == 507;
}

/* ---- the workers */

static const esk_posting *take(pool *p, size_t *number)
{
	const esk_posting *posting = NULL;
	pthread_mutex_lock(&p->lock);
	if (!p->stopping && p->next < p->bulk->postings->count) {
		*number = p->next++;
		posting = &p->bulk->postings->items[*number];
	}
	pthread_mutex_unlock(&p->lock);
	return posting;
}

/* Takes reason. */
static void stop(pool *p, esk_outcome outcome, char *reason)
{
	pthread_mutex_lock(&p->lock);
	p->stopping = true;
	p->worst = esk_outcome_worse(p->worst, outcome);
	if (p->bulk->ended_by)
		free(reason);
	else
		p->bulk->ended_by = reason;
	pthread_cond_broadcast(&p->changed);
	pthread_mutex_unlock(&p->lock);
}

static void settle(pool *p, size_t number, const esk_posting_result *result, const esk_answer *answer)
{
	pthread_mutex_lock(&p->lock);
	p->bulk->results[number] = *result;
	p->ended++;
	p->bytes_ended += p->bulk->postings->items[number].bytes;
	if (result->state == ESK_POSTING_REFUSED)
		p->worst = esk_outcome_worse(p->worst, ESK_REFUSED);
	else if (esk_arguments_value(p->session->arguments, "json"))
		fwrite(answer->body, 1, answer->size, stdout);
	pthread_mutex_unlock(&p->lock);
}

static void post(pool *p, esk_client *client, const esk_posting *posting, size_t number)
{
	esk_answer answer = {0};
	esk_posting_result result = {0};
	esk_outcome outcome = ESK_DONE;
	if (!send_patiently(p, client, posting, &answer, &outcome))
		return;
	if (outcome == ESK_UNREACHABLE) {
		stop(p, outcome, strdup(esk_client_complaint(client)));
		return;
	}
	if (!outcome && answer.status >= 200 && answer.status < 300)
		judge_success(p->bulk, posting, &answer, &result);
	else
		result = (esk_posting_result){
			ESK_POSTING_REFUSED, 0, 0, outcome ? complaint_of(client, posting->file) : reason_of(&answer)};
	settle(p, number, &result, &answer);
	if (!outcome && is_hopeless(answer.status))
		stop(p, ESK_REFUSED, reason_of(&answer));
	free(answer.body);
}

static void *work(void *context)
{
	pool *p = context;
	esk_client *client = NULL;
	size_t number = 0;
	esk_outcome outcome = esk_session_new_client(p->session, &client);
	if (outcome)
		stop(p, outcome, NULL);
	for (const esk_posting *posting; !outcome && (posting = take(p, &number));)
		post(p, client, posting, number);
	esk_client_free(client);
	pthread_mutex_lock(&p->lock);
	p->running--;
	pthread_cond_broadcast(&p->changed);
	pthread_mutex_unlock(&p->lock);
	return NULL;
}

/* ---- the watch */

static void watch(pool *p)
{
	esk_progress *progress = &p->session->progress;
	pthread_mutex_lock(&p->lock);
	while (p->running > 0) {
		const struct timespec end = moment_in(watch_seconds);
		pthread_cond_timedwait(&p->changed, &p->lock, &end);
		if (interrupts > 0 && !p->stopping) {
			p->stopping = p->bulk->interrupted = true;
			pthread_cond_broadcast(&p->changed);
		}
		const size_t ended = p->ended;
		const double share = (double)p->bytes_ended / (double)p->bytes;
		pthread_mutex_unlock(&p->lock);
		esk_progress_counted(progress, ended, share);
		pthread_mutex_lock(&p->lock);
	}
	pthread_mutex_unlock(&p->lock);
	esk_progress_end(progress, false);
}

static esk_outcome connection_count(const esk_session *session, const esk_bulk *bulk, size_t *count)
{
	const char *text = esk_arguments_value(session->arguments, "parallel");
	char *end = NULL;
	const unsigned long number = text ? strtoul(text, &end, 10) : default_connections;
	if (text && (*text < '0' || *text > '9' || *end || number < 1 || number > most_connections))
		return esk_complain(ESK_MISUSED, "--parallel is %s, expected 1 to %d", text, most_connections);
	*count = number < bulk->postings->count ? number : bulk->postings->count;
	return ESK_DONE;
}

static esk_outcome run(pool *p, pthread_t *threads, size_t count)
{
	size_t started = 0;
	pthread_mutex_lock(&p->lock);
	for (; started < count && !pthread_create(&threads[started], NULL, work, p); started++)
		p->running++;
	pthread_mutex_unlock(&p->lock);
	if (started == 0 && count > 0)
		return esk_complain(ESK_REFUSED, "no thread could be started");
	watch(p);
	for (size_t i = 0; i < started; i++)
		pthread_join(threads[i], NULL);
	if (p->ended < p->bulk->postings->count)
		p->worst = esk_outcome_worse(p->worst, ESK_REFUSED);
	return p->worst;
}

esk_outcome esk_bulk_post(esk_session *session, esk_bulk *bulk)
{
	pool p = {.session = session, .bulk = bulk, .bytes = 1};
	size_t count = 0;
	pthread_t threads[most_connections];
	struct sigaction before;
	esk_outcome outcome = connection_count(session, bulk, &count);
	if (outcome)
		return outcome;
	bulk->results = calloc(bulk->postings->count + 1, sizeof *bulk->results);
	if (!bulk->results)
		return esk_complain(ESK_REFUSED, "memory ran out");
	for (size_t i = 0; i < bulk->postings->count; i++)
		p.bytes += bulk->postings->items[i].bytes;
	session->progress.items = bulk->postings->count;
	esk_progress_next(&session->progress, "files");
	pthread_mutex_init(&p.lock, NULL);
	pthread_cond_init(&p.changed, NULL);
	catch_interrupt(&before);
	outcome = run(&p, threads, count);
	sigaction(SIGINT, &before, NULL);
	pthread_cond_destroy(&p.changed);
	pthread_mutex_destroy(&p.lock);
	return outcome;
}

void esk_bulk_clear(esk_bulk *bulk)
{
	for (size_t i = 0; bulk->results && i < bulk->postings->count; i++)
		free(bulk->results[i].reason);
	free(bulk->results);
	free(bulk->ended_by);
	bulk->results = NULL;
	bulk->ended_by = NULL;
}
