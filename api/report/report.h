/* The layouts of a report, one a kind of answer.
 *
 * Each takes all answers, an array of {"source": what was asked about, "answer": the API's body}, and writes them.
 * False when memory ran out. A member that is absent, or null, or not of its type is shown as "-": an older or newer
 * server's answer still makes a table. */
#ifndef ESK_REPORT_H
#define ESK_REPORT_H

#include "report_table.h"

#include <jansson.h>

bool esk_report_shapes(const json_t *answers, FILE *out, bool colour);
bool esk_report_shape(const json_t *answers, FILE *out, bool colour);
bool esk_report_skeleton(const json_t *answers, FILE *out, bool colour);
bool esk_report_recognition(const json_t *answers, FILE *out, bool colour);
bool esk_report_check(const json_t *answers, FILE *out, bool colour);
bool esk_report_distances(const json_t *answers, FILE *out, bool colour);
bool esk_report_evaluation(const json_t *answers, FILE *out, bool colour);
bool esk_report_jobs(const json_t *answers, FILE *out, bool colour);
bool esk_report_reconstruction(const json_t *answers, FILE *out, bool colour);

/* Evaluations for other programs, and as a page. */
bool esk_report_evaluation_csv(const json_t *answers, FILE *out);
bool esk_report_evaluation_html(const json_t *answers, FILE *out);

/* The member's text, or "-". */
const char *esk_report_member(const json_t *object, const char *member);

/* Writes one answer after another; false where one was not written whole. */
bool esk_report_each(
	bool (*write)(const json_t *answer, FILE *out, bool colour), const json_t *answers, FILE *out, bool colour);

/* A cell with the member's number, or "-". */
void esk_report_number(esk_table *table, const json_t *object, const char *member, int decimals);

/* Two cells of a verdict: its class, "unknown" where the nearest is too far away for its class, and how probable it is. */
void esk_report_class(esk_table *table, const json_t *verdict);
/* A cell with a probability: "98 %", at most "99 %", for no calibration shows more; "-" where nothing is told. */
void esk_report_score(esk_table *table, const json_t *verdict, const char *member);

/* What a person calls a shape: its name, or else the source with its label. */
void esk_report_name(esk_table *table, const json_t *shape, const char *source);

#endif
