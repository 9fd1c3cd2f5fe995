/* Refusals: an HTTP status and one sentence with the offending and the expected value (RFC 9457). */
#ifndef ESK_PROBLEM_H
#define ESK_PROBLEM_H

#include "eskel_store.h"

typedef struct {
	int status;
	char text[640];
} esk_problem;

/* Always false, so that a refusal is one line:
 *   return esk_problem_set(problem, 400, "limit is %s, expected 1 to %u", value, most); */
bool esk_problem_set(esk_problem *problem, int status, const char *format, ...) __attribute__((format(printf, 3, 4)));
bool esk_problem_no_memory(esk_problem *problem);
bool esk_problem_no_shape(esk_problem *problem, const char *id);
bool esk_problem_no_job(esk_problem *problem, const char *id);

/* False unless status is OK. error->text is used if it says anything. */
bool esk_problem_engine(esk_problem *problem, eskel_status status, const eskel_error *error);
bool esk_problem_store(esk_problem *problem, eskel_store_status status, const eskel_store_error *error);

#endif
