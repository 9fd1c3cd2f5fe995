/* The plots of an evaluation as SVG, see report_evaluation.h. Each says in words what it shows (title, desc), and says with
 * shapes, dashes or numbers what it says with colours, so that it can be read in grey print. */
#include "report_evaluation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char ink[] = "#1f2933", faint[] = "#cbd2d9", blue[] = "#1f5fa8", orange[] = "#c2571a";

/* The id makes those of title and description unique on a page. What follows is the description. */
static void begin(FILE *out, const char *id, int width, int height, const char *title)
{
	fprintf(out,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
		"role=\"img\" "
		"aria-labelledby=\"%s-title %s-desc\">\n<title id=\"%s-title\">%s</title>\n<desc id=\"%s-desc\">",
		width, height, width, height, id, id, id, title, id);
}

static void text_at(FILE *out, double x, double y, const char *anchor, const char *text)
{
	fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
	esk_html_write(out, text);
	fputs("</text>\n", out);
}

static void number_at(FILE *out, double x, double y, const char *anchor, int decimals, double number)
{
	char text[32];
	snprintf(text, sizeof text, "%.*f", decimals, number);
	text_at(out, x, y, anchor, isfinite(number) ? text : "-");
}

static void line(FILE *out, double x0, double y0, double x1, double y1, const char *colour)
{
	fprintf(out, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n", x0, y0, x1, y1, colour);
}

static void box(FILE *out, double x, double y, double width, double height, const char *colour, double opacity)
{
	fprintf(out,
		"<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" fill-opacity=\"%.2f\" "
		"stroke=\"%s\" stroke-width=\"0.5\"/>\n",
		x, y, width, height, colour, opacity, ink);
}

/* ---- measures, a pair of bars a distance */

void esk_plot_measures(const json_t *const *answers, size_t count, FILE *out)
{
	enum { left = 230, width = 400, row = 38, top = 30 };
	static const struct {
		const char *path, *title, *colour;
		double opacity;
	} bars[] = {{"measures.nearest_neighbour", "NN", blue, 0.9}, {"measures.dcg", "DCG", orange, 0.4}};
	begin(out, "measures", left + width + 80, top + row * (int)count + 10,
		"Nearest neighbour and DCG of each distance");
	for (size_t i = 0; i < count; i++) {
		char name[ESK_EVALUATION_NAME_SIZE];
		esk_evaluation_name(answers[i], name);
		esk_html_write(out, name);
		fprintf(out, ": NN %.3f, DCG %.3f. ", esk_evaluation_number(answers[i], bars[0].path),
			esk_evaluation_number(answers[i], bars[1].path));
	}
	fputs("</desc>\n", out);
	for (int i = 0; i <= 10; i++)
		line(out, left + width * i / 10., top - 6, left + width * i / 10., top + row * (double)count, faint);
	for (int i = 0; i <= 10; i += 2)
		number_at(out, left + width * i / 10., top - 12, "middle", 1, i / 10.);
	for (size_t i = 0; i < count; i++) {
		char name[ESK_EVALUATION_NAME_SIZE];
		const double y = top + row * (double)i;
		esk_evaluation_name(answers[i], name);
		text_at(out, left - 8, y + 20, "end", name);
		for (size_t b = 0; b < 2; b++) {
			const double value = esk_evaluation_number(answers[i], bars[b].path),
				     at = y + 3 + 15 * (double)b;
			char label[32];
			if (!isfinite(value))
				continue;
			snprintf(label, sizeof label, "%s %.3f", bars[b].title, value);
			box(out, left, at, width * value, 13, bars[b].colour, bars[b].opacity);
			fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"11\">%s</text>\n",
				left + width * value + 4, at + 11, label);
		}
	}
	fputs("</svg>\n", out);
}

/* ---- precision over recall */

enum { plot_left = 50, plot_top = 20, plot_width = 420, plot_height = 300 };

static double plot_x(double share)
{
	return plot_left + plot_width * share;
}

static double plot_y(double share)
{
	return plot_top + plot_height * (1 - share);
}

static void axes(FILE *out, const char *x_title, const char *y_title)
{
	for (int i = 0; i <= 10; i += 2) {
		line(out, plot_x(0), plot_y(i / 10.), plot_x(1), plot_y(i / 10.), faint);
		number_at(out, plot_x(0) - 6, plot_y(i / 10.) + 4, "end", 1, i / 10.);
	}
	line(out, plot_x(0), plot_y(0), plot_x(1), plot_y(0), ink);
	line(out, plot_x(0), plot_y(0), plot_x(0), plot_y(1), ink);
	text_at(out, plot_x(0.5), plot_y(0) + 36, "middle", x_title);
	fprintf(out, "<text transform=\"translate(14 %.1f) rotate(-90)\" text-anchor=\"middle\">%s</text>\n",
		plot_y(0.5), y_title);
}

static void curve(const json_t *answer, size_t number, FILE *out)
{
	static const char *const colours[] = {blue, orange, "#2f7d4f", "#7a3e9d", "#8a6d00", ink};
	static const char *const dashes[] = {"none", "8 3", "2 3", "10 3 2 3", "14 4", "5 5"};
	char name[ESK_EVALUATION_NAME_SIZE];
	size_t i;
	json_t *point;
	fprintf(out, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" stroke-dasharray=\"%s\" points=\"",
		colours[number], dashes[number]);
	json_array_foreach (json_object_get(answer, "precision_recall"), i, point)
		if (json_is_number(json_object_get(point, "precision")))
			fprintf(out, "%.1f,%.1f ", plot_x(esk_evaluation_number(point, "recall")),
				plot_y(esk_evaluation_number(point, "precision")));
	const double y = plot_top + 12 + 20 * (double)number;
	fprintf(out,
		"\"/>\n<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"%s\" stroke-width=\"2\" "
		"stroke-dasharray=\"%s\"/>\n",
		plot_left + plot_width + 20, y - 4, plot_left + plot_width + 56, y - 4, colours[number],
		dashes[number]);
	esk_evaluation_name(answer, name);
	text_at(out, plot_left + plot_width + 62, y, "start", name);
}

void esk_plot_precision(const json_t *const *answers, size_t count, FILE *out)
{
	enum { most_curves = 6 };
	if (count > most_curves)
		count = most_curves;
	begin(out, "precision", plot_left + plot_width + 290, plot_top + plot_height + 50, "Precision over recall");
	for (size_t c = 0; c < count; c++) {
		char name[ESK_EVALUATION_NAME_SIZE];
		size_t i;
		json_t *point;
		esk_evaluation_name(answers[c], name);
		esk_html_write(out, name);
		fputs(", precision at recall", out);
		json_array_foreach (json_object_get(answers[c], "precision_recall"), i, point)
			if (i % 4 == 3)
				fprintf(out, " %.1f: %.3f", esk_evaluation_number(point, "recall"),
					esk_evaluation_number(point, "precision"));
		fputs(". ", out);
	}
	fputs("</desc>\n", out);
	axes(out, "recall", "precision");
	for (int i = 0; i <= 10; i += 2)
		number_at(out, plot_x(i / 10.), plot_y(0) + 18, "middle", 1, i / 10.);
	for (size_t c = 0; c < count; c++)
		curve(answers[c], c, out);
	fputs("</svg>\n", out);
}

/* ---- sides */

/* Between two thresholds, how many are decided and the share of these that is right. */
static double bin_of(const json_t *thresholds, size_t i, double *right)
{
	const json_t *here = json_array_get(thresholds, i), *next = json_array_get(thresholds, i + 1);
	double decided = esk_evaluation_number(here, "decided"), good = esk_evaluation_number(here, "right");
	if (next) {
		decided -= esk_evaluation_number(next, "decided");
		good -= esk_evaluation_number(next, "right");
	}
	*right = decided > 0 ? good / decided : NAN;
	return decided;
}

void esk_plot_side(const json_t *answer, FILE *out)
{
	const json_t *thresholds = json_object_get(json_object_get(answer, "side"), "thresholds");
	const size_t count = json_array_size(thresholds);
	begin(out, "side", plot_left + plot_width + 20, plot_top + plot_height + 50,
		"Share of right sides by the chirality's score");
	for (size_t i = 0; i < count; i++) {
		double right, decided = bin_of(thresholds, i, &right);
		fprintf(out, "|score| from %.2f: %.0f pairs",
			esk_evaluation_number(json_array_get(thresholds, i), "threshold"), decided);
		if (decided > 0)
			fprintf(out, ", %.3f right", right);
		fputs(". ", out);
	}
	fputs("</desc>\n", out);
	axes(out, "|score| from", "share that is right");
	const double width = (double)plot_width / (double)(count + !count);
	for (size_t i = 0; i < count; i++) {
		double right, decided = bin_of(thresholds, i, &right), x = plot_left + width * (double)i;
		char pairs[32];
		snprintf(pairs, sizeof pairs, "%.0f", decided);
		number_at(out, x + 2, plot_y(0) + 18, "middle", 2,
			esk_evaluation_number(json_array_get(thresholds, i), "threshold"));
		if (decided > 0)
			box(out, x + 3, plot_y(right), width - 6, plot_height * right, blue, 0.4);
		text_at(out, x + width / 2, plot_y(decided > 0 ? right : 0) - 4, "middle", pairs);
	}
	fputs("</svg>\n", out);
}

/* ---- confusion */

enum { most_classes = 48 };

typedef struct {
	const char *names[most_classes];
	size_t count;
	bool full;
} class_list;

static size_t find_class(const class_list *list, const char *name)
{
	size_t i = 0;
	while (i < list->count && strcmp(list->names[i], name) != 0)
		i++;
	return i;
}

static void add_class(class_list *list, const char *name)
{
	if (find_class(list, name) < list->count)
		return;
	if (list->count < most_classes)
		list->names[list->count++] = name;
	else
		list->full = true;
}

/* Those of mistakes, each followed by those that it is taken for. */
static void list_classes(const json_t *const *rows, size_t count, class_list *list)
{
	size_t i;
	json_t *one;
	for (size_t r = 0; r < count; r++) {
		add_class(list, esk_report_member(rows[r], "class"));
		json_array_foreach (json_object_get(rows[r], "nearest"), i, one)
			add_class(list, esk_report_member(one, "class"));
	}
}

/* The cells of a row of the confusion. */
static void draw_row(const json_t *row, const class_list *list, double left, double top, double side, FILE *out)
{
	size_t i;
	json_t *one;
	const char *class = esk_report_member(row, "class");
	const size_t r = find_class(list, class);
	const double queries = esk_evaluation_number(row, "queries");
	json_array_foreach (json_object_get(row, "nearest"), i, one) {
		const char *other = esk_report_member(one, "class");
		const size_t c = find_class(list, other);
		const double times = esk_evaluation_number(one, "queries");
		if (r == list->count || c == list->count)
			continue;
		box(out, left + side * (double)c, top + side * (double)r, side, side, r == c ? blue : orange,
			0.1 + 0.6 * times / queries);
		number_at(out, left + side * ((double)c + 0.5), top + side * ((double)r + 0.5) + 4, "middle", 0, times);
	}
}

static void describe(const json_t *const *rows, size_t count, FILE *out)
{
	size_t i;
	json_t *one;
	for (size_t r = 0; r < count; r++) {
		const char *class = esk_report_member(rows[r], "class");
		esk_html_write(out, class);
		fprintf(out, ", %.0f of %.0f right, is taken for", esk_evaluation_number(rows[r], "right"),
			esk_evaluation_number(rows[r], "queries"));
		json_array_foreach (json_object_get(rows[r], "nearest"), i, one) {
			const char *other = esk_report_member(one, "class");
			if (strcmp(other, class) == 0)
				continue;
			fputc(' ', out);
			esk_html_write(out, other);
			fprintf(out, " %.0f", esk_evaluation_number(one, "queries"));
		}
		fputs(". ", out);
	}
	fputs("</desc>\n", out);
}

bool esk_plot_confusion(const json_t *answer, FILE *out)
{
	enum { left = 190, top = 170, side = 24 };
	class_list list = {0};
	const json_t **rows = NULL;
	size_t count = 0, i;
	json_t *row;
	if (!esk_evaluation_mistaken(answer, &rows, &count))
		return false;
	list_classes(rows, count, &list);
	const int extent = side * (int)list.count;
	begin(out, "confusion", left + extent + 20, top + extent + 30,
		"Confusion: the class of each query (rows) by that of its nearest shape (columns)");
	describe(rows, count, out);
	for (size_t c = 0; c < list.count; c++) {
		const double middle = side * ((double)c + 0.5);
		text_at(out, left - 6, top + middle + 4, "end", list.names[c]);
		fprintf(out, "<text transform=\"translate(%.1f %d) rotate(-60)\">", left + middle + 4, top - 6);
		esk_html_write(out, list.names[c]);
		fputs("</text>\n", out);
		line(out, left, top + side * (double)c, left + extent, top + side * (double)c, faint);
		line(out, left + side * (double)c, top, left + side * (double)c, top + extent, faint);
	}
	json_array_foreach (json_object_get(answer, "confusion"), i, row)
		draw_row(row, &list, left, top, side, out);
	if (list.full)
		text_at(out, left, top + extent + 20, "start", "Classes with fewer mistakes are left out.");
	fputs("</svg>\n", out);
	free(rows);
	return true;
}
