/* Evaluations as one page that needs nothing else: no script, no font, no picture from elsewhere. */
#include "report_evaluation.h"

#include <math.h>
#include <stdlib.h>

void esk_html_write(FILE *out, const char *text)
{
	char *plain = esk_table_plain(text);
	for (const char *at = plain ? plain : "?"; *at; at++) {
		switch (*at) {
		case '&':
			fputs("&amp;", out);
			break;
		case '<':
			fputs("&lt;", out);
			break;
		case '>':
			fputs("&gt;", out);
			break;
		case '"':
			fputs("&quot;", out);
			break;
		default:
			fputc(*at, out);
		}
	}
	free(plain);
}

static const char head[] =
	"<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
	"<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
	"<title>Evaluation of shape distances</title>\n<style>\n"
	"body { font: 15px/1.5 sans-serif; color: #1f2933; background: #fff; max-width: 62rem; margin: 2rem auto; "
	"padding: 0 1rem }\n"
	"table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums }\n"
	"caption { text-align: left; white-space: nowrap; padding-bottom: .3rem }\n"
	"th, td { padding: .15rem .5rem; border-bottom: 1px solid #cbd2d9; text-align: right }\n"
	"th[scope=row], td.text, th.text { text-align: left }\n"
	"tr.best { font-weight: bold }\n"
	".wide { overflow-x: auto }\n"
	"svg { font: 12px sans-serif; fill: #1f2933; max-width: 100%; height: auto }\n"
	"dt { font-weight: bold; float: left; clear: left; width: 9rem } dd { margin: 0 0 .2rem 9.5rem }\n"
	"@media print { body { margin: 0; max-width: none; font-size: 11px } figure, table { break-inside: avoid } "
	"* { print-color-adjust: exact } }\n"
	"</style>\n</head>\n<body>\n<main>\n<h1>Evaluation of shape distances</h1>\n";

static const char explanations[] =
	"<section>\n<h2>What the measures mean</h2>\n<dl>\n"
	"<dt>NN</dt><dd>nearest neighbour: the nearest shape is of the query's class</dd>\n"
	"<dt>FT, ST</dt><dd>first and second tier: of the R shapes of the class, the share among the first R and 2 "
	"R</dd>\n"
	"<dt>E</dt><dd>E-measure: 2 / (1 / precision + 1 / recall) of the first 32 shapes</dd>\n"
	"<dt>DCG</dt><dd>discounted cumulative gain over the whole ranking, 1 for a perfect one</dd>\n"
	"<dt>decided, right</dt><dd>of the left and right shapes compared with the nearest such shape of their class, "
	"those "
	"with a handedness score of at least 0.05, and the share of these that fits the recorded sides</dd>\n"
	"<dt>recall</dt><dd>how often the pruned search finds the true nearest shape</dd>\n"
	"<dt>ms</dt><dd>milliseconds of a search, the median</dd>\n"
	"</dl>\n<p>NN, FT, ST, E and DCG are those of the Princeton Shape Benchmark (Shilane et al. 2004). Shapes at "
	"equal "
	"distance count as the mean over their orders.</p>\n</section>\n";

/* ---- tables */

static void write_heading(FILE *out)
{
	fputs("<thead><tr>", out);
	for (size_t c = 0; c < esk_evaluation_column_count; c++) {
		const esk_evaluation_column *column = &esk_evaluation_columns[c];
		if (!column->csv_only)
			fprintf(out, "<th scope=\"col\"%s>%s</th>", column->column.right ? "" : " class=\"text\"",
				column->column.title);
	}
	fputs("</tr></thead>\n", out);
}

static void write_row(const json_t *answer, bool best, FILE *out)
{
	fputs(best ? "<tr class=\"best\">" : "<tr>", out);
	for (size_t c = 0; c < esk_evaluation_column_count; c++) {
		char cell[ESK_EVALUATION_CELL_SIZE];
		const esk_evaluation_column *column = &esk_evaluation_columns[c];
		if (column->csv_only)
			continue;
		esk_evaluation_cell(column, answer, column->decimals, cell);
		fputs(column->column.right ? "<td>" : "<td class=\"text\">", out);
		esk_html_write(out, *cell ? cell : "-");
		fputs("</td>", out);
	}
	fputs("</tr>\n", out);
}

static void write_distances(const json_t *const *answers, size_t count, FILE *out)
{
	fputs("<div class=\"wide\"><table>\n<caption>By DCG, the best first</caption>\n", out);
	write_heading(out);
	fputs("<tbody>\n", out);
	for (size_t i = 0; i < count; i++)
		write_row(answers[i], i == 0 && count > 1, out);
	fputs("</tbody></table></div>\n", out);
}

static void write_steps(const json_t *answer, FILE *out)
{
	const json_t *steps = json_object_get(json_object_get(answer, "pruned"), "steps");
	size_t i;
	json_t *step;
	if (json_array_size(steps) == 0)
		return;
	fputs("<section>\n<h2>The pruned search</h2>\n<table>\n<caption>Shapes still in after each step, and how often "
	      "the "
	      "true nearest is</caption>\n<thead><tr><th scope=\"col\">level</th><th scope=\"col\">kept</th>"
	      "<th scope=\"col\">recall</th></tr></thead>\n<tbody>\n",
		out);
	json_array_foreach (steps, i, step)
		fprintf(out, "<tr><td>%.0f</td><td>%.1f</td><td>%.3f</td></tr>\n", esk_evaluation_number(step, "level"),
			esk_evaluation_number(step, "kept"), esk_evaluation_number(step, "recall"));
	fputs("</tbody></table>\n</section>\n", out);
}

/* ---- the page */

static bool write_classes(const json_t *answer, FILE *out)
{
	char name[ESK_EVALUATION_NAME_SIZE];
	const json_t **rows = NULL;
	size_t count = 0;
	if (!esk_evaluation_mistaken(answer, &rows, &count))
		return false;
	free(rows);
	esk_evaluation_name(answer, name);
	fputs("<section>\n<h2>Classes</h2>\n<p>By the distance ", out);
	esk_html_write(out, name);
	if (count == 0) {
		fputs(", the nearest shape of every query is of its class.</p>\n</section>\n", out);
		return true;
	}
	fputs(": the classes with a query whose nearest shape is of another class.</p>\n<figure class=\"wide\">\n",
		out);
	bool whole = esk_plot_confusion(answer, out);
	fputs("</figure>\n</section>\n", out);
	return whole;
}

static void write_sides(const json_t *answer, FILE *out)
{
	const double compared = esk_evaluation_number(answer, "side.compared");
	if (!(compared > 0))
		return;
	fprintf(out,
		"<section>\n<h2>Sides</h2>\n<p>Each left or right shape beside the nearest such shape of its class: "
		"%.0f "
		"pairs, the numbers above the bars say how many.</p>\n<figure class=\"wide\">\n",
		compared);
	esk_plot_side(answer, out);
	fputs("</figure>\n</section>\n", out);
}

/* Without a query there is no DCG: such an answer comes last. */
static double dcg_of(const void *answer)
{
	return fmax(esk_evaluation_number(*(const json_t *const *)answer, "measures.dcg"), -1);
}

static int best_first(const void *a, const void *b)
{
	const double x = dcg_of(a), y = dcg_of(b);
	return x > y ? -1 : x < y;
}

static bool write_page(const json_t *const *answers, size_t count, FILE *out)
{
	fputs(head, out);
	fprintf(out, "<p>Shapes: %.0f, classes: %.0f, queries: %.0f, each compared with all but its own ",
		esk_evaluation_number(answers[0], "shapes"), esk_evaluation_number(answers[0], "classes"),
		esk_evaluation_number(answers[0], "queries"));
	esk_html_write(out, esk_report_member(answers[0], "leave_out"));
	fputs(".</p>\n<section>\n<h2>Distances</h2>\n", out);
	write_distances(answers, count, out);
	fputs("<figure class=\"wide\">\n", out);
	esk_plot_measures(answers, count, out);
	fputs("</figure>\n<figure class=\"wide\">\n", out);
	esk_plot_precision(answers, count, out);
	fputs("</figure>\n</section>\n", out);
	bool whole = write_classes(answers[0], out);
	write_sides(answers[0], out);
	write_steps(answers[0], out);
	fputs(explanations, out);
	fputs("</main>\n</body>\n</html>\n", out);
	return whole;
}

bool esk_report_evaluation_html(const json_t *answers, FILE *out)
{
	const size_t count = json_array_size(answers);
	const json_t **sorted = calloc(count + 1, sizeof *sorted);
	size_t i;
	json_t *entry;
	if (!sorted)
		return false;
	json_array_foreach (answers, i, entry)
		sorted[i] = json_object_get(entry, "answer");
	qsort(sorted, count, sizeof *sorted, best_first);
	bool whole = write_page(sorted, count, out);
	free(sorted);
	return whole;
}
