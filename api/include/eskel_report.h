/* eskel report: the API's JSON answers as tables for people.
 *
 * A report collects the answers of one kind that a command received and lays them out together, so that fifty
 * recognitions are fifty rows under one heading. The text is UTF-8, one row a line; what came from files or people
 * (names, sentences) has its control characters replaced, so that no answer can drive a terminal.
 */
#ifndef ESKEL_REPORT_H
#define ESKEL_REPORT_H

#include "eskel.h"

typedef enum {
	ESKEL_REPORT_SHAPES,            /* POST /shapes, GET /shapes */
	ESKEL_REPORT_SHAPE,             /* GET /shapes/{id} */
	ESKEL_REPORT_SKELETON,          /* GET /shapes/{id}/skeleton, eskel_skeleton_text */
	ESKEL_REPORT_RECOGNITION,       /* GET and POST /recognize */
	ESKEL_REPORT_CHECK,             /* POST /check */
	ESKEL_REPORT_DISTANCES,         /* GET /distances */
	ESKEL_REPORT_EVALUATION,        /* GET /evaluation */
	ESKEL_REPORT_JOBS,              /* GET /jobs */
	ESKEL_REPORT_JOB,               /* GET /jobs/{id} */
	ESKEL_REPORT_RECONSTRUCTION     /* GET /shapes/{id}/reconstruction */
} eskel_report_kind;

typedef struct eskel_report eskel_report;

ESKEL_API eskel_status eskel_report_new(eskel_report_kind kind, eskel_report **report);
ESKEL_API void eskel_report_free(eskel_report *report);

/* Adds one answer. source says what was asked about (a file's name, an id) and stands in for a name that is missing.
 * ESKEL_MALFORMED when the bytes are not an answer of the report's kind. */
ESKEL_API eskel_status eskel_report_add(eskel_report *report, const char *source, const char *json, size_t size);

/* All answers so far, "" for none. colour: with ANSI escapes for headings and verdicts. free() it; NULL when memory ran
 * out. */
ESKEL_API char *eskel_report_text(const eskel_report *report, bool colour);

/* Evaluations so far, a row each: as CSV (RFC 4180), and as an HTML page with plots that needs nothing beside it. "" for
 * none; free() it; NULL when memory ran out, or for reports of another kind. */
ESKEL_API char *eskel_report_csv(const eskel_report *report);
ESKEL_API char *eskel_report_html(const eskel_report *report);

/* Recognitions so far to which nothing in the library was a neighbour. */
ESKEL_API size_t eskel_report_unrecognized(const eskel_report *report);

/* Findings of checks so far that are errors or warnings. */
ESKEL_API size_t eskel_report_findings(const eskel_report *report);

/* What a progress bar shows of a job. */
typedef struct {
	double progress, seconds;       /* share that is done; that it runs or ran */
	bool ended, failed;
} eskel_report_job;

/* False, and the job untouched, when the bytes are not the API's job. */
ESKEL_API bool eskel_report_job_read(const char *json, size_t size, eskel_report_job *job);

/* Where the job is that was begun. free() it; NULL when the bytes do not say or memory ran out. */
ESKEL_API char *eskel_report_url(const char *json, size_t size);

/* The detail, or else the title, of a problem+json body (RFC 9457), as one line. free() it; NULL when the bytes are no
 * such body or memory ran out. */
ESKEL_API char *eskel_report_problem(const char *json, size_t size);

#endif
