#include "metrics.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const methods[] = {"GET", "HEAD", "OPTIONS", "POST", "PATCH", "DELETE", "other"};
static const double bounds[] = {.001, .0025, .005, .01, .025, .05, .1, .25, .5, 1, 2.5, 5, 10, 30, 60};

enum {
	METHODS = sizeof methods / sizeof *methods,
	BOUNDS = sizeof bounds / sizeof *bounds,
	CLASSES = 5, /* 1xx to 5xx */
	MOST_ROUTES = 64,
};

typedef struct {
	const char *route;
	uint64_t requests[METHODS][CLASSES];
	uint64_t within[BOUNDS]; /* requests that took at most that bound, not cumulated */
	uint64_t count;
	double seconds;
} route_row;

struct esk_metrics {
	pthread_mutex_t lock;
	size_t route_count;
	route_row routes[MOST_ROUTES];
	uint64_t received, sent;
	atomic_ullong rejected[ESK_REJECTION_COUNT];
};

esk_metrics *esk_metrics_new(void)
{
	esk_metrics *metrics = calloc(1, sizeof *metrics);
	if (metrics)
		pthread_mutex_init(&metrics->lock, NULL);
	return metrics;
}

void esk_metrics_free(esk_metrics *metrics)
{
	if (!metrics)
		return;
	pthread_mutex_destroy(&metrics->lock);
	free(metrics);
}

static route_row *find(esk_metrics *metrics, const char *route)
{
	for (size_t r = 0; r < metrics->route_count; r++)
		if (!strcmp(metrics->routes[r].route, route))
			return &metrics->routes[r];
	if (metrics->route_count == MOST_ROUTES)
		return &metrics->routes[MOST_ROUTES - 1];
	metrics->routes[metrics->route_count].route = route;
	return &metrics->routes[metrics->route_count++];
}

static int method_index(const char *method)
{
	int m = 0;
	while (m < METHODS - 1 && strcmp(method, methods[m]) != 0)
		m++;
	return m;
}

void esk_metrics_request(esk_metrics *metrics, const char *route, const char *method, int status, double seconds,
	uint64_t received, uint64_t sent)
{
	pthread_mutex_lock(&metrics->lock);
	route_row *row = find(metrics, route);
	row->requests[method_index(method)][status / 100 - 1]++;
	row->count++;
	row->seconds += seconds;
	int b = 0;
	while (b < BOUNDS && seconds > bounds[b])
		b++;
	if (b < BOUNDS)
		row->within[b]++;
	metrics->received += received;
	metrics->sent += sent;
	pthread_mutex_unlock(&metrics->lock);
}

void esk_metrics_reject(esk_metrics *metrics, esk_rejection reason)
{
	atomic_fetch_add(&metrics->rejected[reason], 1);
}

/* ---- text */

static void write_head(FILE *out, const char *name, const char *type, const char *help)
{
	fprintf(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

static void write_counter(FILE *out, const char *name, const char *help, uint64_t value)
{
	write_head(out, name, "counter", help);
	fprintf(out, "%s %llu\n", name, (unsigned long long)value);
}

static void write_requests(FILE *out, const esk_metrics *metrics)
{
	write_head(out, "eskeld_http_requests_total", "counter", "Requests answered.");
	for (size_t r = 0; r < metrics->route_count; r++)
		for (int m = 0; m < METHODS; m++)
			for (int c = 0; c < CLASSES; c++)
				if (metrics->routes[r].requests[m][c])
					fprintf(out,
						"eskeld_http_requests_total{route=\"%s\",method=\"%s\",status=\"%dxx\"}"
						" %llu\n",
						metrics->routes[r].route, methods[m], c + 1,
						(unsigned long long)metrics->routes[r].requests[m][c]);
}

static void write_durations(FILE *out, const esk_metrics *metrics)
{
	static const char name[] = "eskeld_http_request_duration_seconds";
	write_head(out, name, "histogram", "From the end of the head to the end of the reply.");
	for (size_t r = 0; r < metrics->route_count; r++) {
		const route_row *row = &metrics->routes[r];
		uint64_t cumulated = 0;
		for (int b = 0; b < BOUNDS; b++) {
			cumulated += row->within[b];
			fprintf(out, "%s_bucket{route=\"%s\",le=\"%g\"} %llu\n", name, row->route, bounds[b],
				(unsigned long long)cumulated);
		}
		fprintf(out, "%s_bucket{route=\"%s\",le=\"+Inf\"} %llu\n", name, row->route,
			(unsigned long long)row->count);
		fprintf(out, "%s_sum{route=\"%s\"} %.6f\n", name, row->route, row->seconds);
		fprintf(out, "%s_count{route=\"%s\"} %llu\n", name, row->route, (unsigned long long)row->count);
	}
}

static void write_rejections(FILE *out, esk_metrics *metrics)
{
#define TEXT(code, text) text,
	static const char *const reasons[] = {ESK_REJECTIONS(TEXT)};
#undef TEXT
	write_head(out, "eskeld_rejected_total", "counter", "Requests and connections refused by the server itself.");
	for (int r = 0; r < ESK_REJECTION_COUNT; r++)
		fprintf(out, "eskeld_rejected_total{reason=\"%s\"} %llu\n", reasons[r],
			atomic_load(&metrics->rejected[r]));
}

char *esk_metrics_text(esk_metrics *metrics, const esk_gauge *gauges, size_t count, size_t *size)
{
	char *text = NULL;
	size_t written = 0;
	FILE *out = open_memstream(&text, &written);
	if (!out)
		return NULL;
	pthread_mutex_lock(&metrics->lock);
	write_requests(out, metrics);
	write_durations(out, metrics);
	write_counter(out, "eskeld_received_body_bytes_total", "Request bodies.", metrics->received);
	write_counter(out, "eskeld_sent_body_bytes_total", "Response bodies.", metrics->sent);
	pthread_mutex_unlock(&metrics->lock);
	write_rejections(out, metrics);
	for (size_t g = 0; g < count; g++) {
		write_head(out, gauges[g].name, "gauge", gauges[g].help);
		fprintf(out, "%s %.0f\n", gauges[g].name, gauges[g].value);
	}
	if (fclose(out) != 0) {
		free(text);
		return NULL;
	}
	*size = written;
	return text;
}
