/* Evaluations for people: a row a distance, and of one evaluation its details. Text and CSV are in report_evaluation.c, the
 * page in report_evaluation_html.c, its plots in report_evaluation_plots.c. */
#ifndef ESK_REPORT_EVALUATION_H
#define ESK_REPORT_EVALUATION_H

#include "report.h"

/* A column of the table of distances. */
typedef struct {
	esk_column column;
	const char *csv;                       /* its name in CSV */
	const char *path;                      /* of members, "milliseconds.exact.median" */
	int decimals;                          /* of a number; -1: a text or whole number */
	double (*value)(const json_t *answer); /* in place of the path; NaN: none */
	bool csv_only;
} esk_evaluation_column;

extern const esk_evaluation_column esk_evaluation_columns[];
extern const size_t esk_evaluation_column_count;

/* The cell as text; "" if there is none. */
#define ESK_EVALUATION_CELL_SIZE 64
void esk_evaluation_cell(const esk_evaluation_column *column, const json_t *answer, int decimals, char *text);

/* NaN when there is no such number. */
double esk_evaluation_number(const json_t *answer, const char *path);

/* The distance in words, "log sum manhattan fixed". */
#define ESK_EVALUATION_NAME_SIZE 128
void esk_evaluation_name(const json_t *answer, char *text);

/* The rows of the confusion with mistakes, those with most first; *rows is freed. False when memory ran out. */
bool esk_evaluation_mistaken(const json_t *answer, const json_t ***rows, size_t *count);

/* Text in HTML, whatever it holds. */
void esk_html_write(FILE *out, const char *text);

/* Plots, each one SVG element: answers of several distances, or one answer. */
void esk_plot_measures(const json_t *const *answers, size_t count, FILE *out);
void esk_plot_precision(const json_t *const *answers, size_t count, FILE *out);
void esk_plot_side(const json_t *answer, FILE *out);
bool esk_plot_confusion(const json_t *answer, FILE *out); /* false when memory ran out */

#endif
