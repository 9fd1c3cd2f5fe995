/* Counters for GET /metrics, in the Prometheus text format. */
#ifndef ESK_METRICS_H
#define ESK_METRICS_H

#include <stddef.h>
#include <stdint.h>

typedef struct esk_metrics esk_metrics;

/* NULL when memory ran out. */
esk_metrics *esk_metrics_new(void);
void esk_metrics_free(esk_metrics *metrics);

/* A request that was answered. route is static text, one of few. */
void esk_metrics_request(esk_metrics *metrics, const char *route, const char *method, int status, double seconds,
	uint64_t received, uint64_t sent);

/* A request or connection that was refused before the resources saw it, by reason. */
#define ESK_REJECTIONS(X) \
	X(FRAMING, "framing") \
	X(TARGET, "target") \
	X(HOST, "host") \
	X(SITE, "site") \
	X(TOKEN, "token") \
	X(RATE, "rate") \
	X(QUEUE, "queue") \
	X(STOPPING, "stopping") \
	X(SLOW, "slow")

#define ESK_REJECTION_CODE(code, text) ESK_REJECT_##code,
typedef enum { ESK_REJECTIONS(ESK_REJECTION_CODE) ESK_REJECTION_COUNT } esk_rejection;
#undef ESK_REJECTION_CODE

void esk_metrics_reject(esk_metrics *metrics, esk_rejection reason);

/* A value that is known elsewhere at the moment of asking. */
typedef struct {
	const char *name, *help;
	double value;
} esk_gauge;

/* The whole exposition. free() it; NULL when memory ran out. */
char *esk_metrics_text(esk_metrics *metrics, const esk_gauge *gauges, size_t count, size_t *size);

#endif
