/* A heat map with its trees. From left to right: the tree of the rows, their marks, the cells, their names, the legend;
 * from top to bottom: titles, the tree of the columns, their marks, the cells, their names. */
#include "picture.h"
#include "svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	MARGIN = 24,
	HEADING = 80,
	SCALE = 110,
	GAP = 6,
	COLOUR_STEPS = 64,
	MOST_TITLED_CELLS = 1 << 14, /* each with a title: 2 MB. Beyond it only rows have one */
};

/* The width and height of a cell: a side of about 760 pixels, but never so small that names of 500 shapes cannot be read,
 * and beyond that 4000 pixels without names. */
static const double side = 760, least_cell = 8, most_cell = 40, most_side = 4000, least_named_cell = 7;
static const double least_numbered_cell = 30;
/* Of the trees, as a share of the cells. */
static const double tree_share = 0.07, least_tree = 120;

/* Rows or columns as they are drawn. */
typedef struct {
	const esk_selection *shapes;
	size_t offset; /* of the first one among all */
	eskel_merge *merges;
	uint32_t *order;
	double label_width;
} axis;

typedef struct {
	esk_text *svg;
	const double *distances;
	size_t count; /* of distances, a side */
	axis rows, columns;
	esk_classes classes;
	double nearest, farthest;        /* of different shapes */
	double cell, font, mark, tree;   /* pixels; tree: from root to leaves */
	double left, top, width, height; /* of the cells */
} heatmap;

/* ---------------------------------------------------------------------------------------------- layout */

static eskel_status order_axis(axis *a, const double *distances, size_t stride)
{
	const size_t count = a->shapes->count;
	double *own = calloc(count * count + 1, sizeof *own);
	a->merges = calloc(count + 1, sizeof *a->merges);
	a->order = calloc(count + 1, sizeof *a->order);
	eskel_status status = own && a->merges && a->order ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t i = 0; status == ESKEL_OK && i < count; i++)
		memcpy(own + i * count, distances + (a->offset + i) * stride + a->offset, count * sizeof *own);
	if (status == ESKEL_OK)
		status = eskel_clustering(own, count, a->merges);
	if (status == ESKEL_OK)
		status = eskel_clustering_order(a->merges, count, a->order);
	free(own);
	return status;
}

static double distance_at(const heatmap *h, size_t row, size_t column)
{
	return h->distances[(h->rows.offset + h->rows.order[row]) * h->count + h->columns.offset +
			    h->columns.order[column]];
}

static double widest_label(const axis *a, double font)
{
	double widest = 0;
	char label[ESK_SVG_LABEL_SIZE];
	for (size_t i = 0; i < a->shapes->count; i++) {
		esk_svg_label(&a->shapes->shapes[i], label);
		widest = fmax(widest, esk_svg_text_width(font, label));
	}
	return font > 0 ? widest + GAP : 0;
}

static void lay_out(heatmap *h)
{
	const size_t rows = h->rows.shapes->count, columns = h->columns.shapes->count;
	const double longer = (double)(rows > columns ? rows : columns);
	h->cell = fmin(fmax(side / fmax(longer, 1), least_cell), most_cell);
	if (h->cell * longer > most_side)
		h->cell = most_side / longer;
	h->font = h->cell < least_named_cell ? 0 : fmin(0.85 * h->cell, 12);
	h->mark = fmin(0.36 * h->cell, 5);
	h->rows.label_width = widest_label(&h->rows, h->font);
	h->columns.label_width = widest_label(&h->columns, h->font);
	h->tree = fmax(tree_share * h->cell * longer, least_tree);
	h->left = MARGIN + h->tree + 2 * GAP + 2 * h->mark;
	h->top = HEADING + h->tree + 2 * GAP + 2 * h->mark;
	h->width = h->cell * (double)columns;
	h->height = h->cell * (double)rows;
}

static bool is_itself(const heatmap *h, size_t row, size_t column)
{
	return h->rows.offset + h->rows.order[row] == h->columns.offset + h->columns.order[column];
}

static void find_range(heatmap *h)
{
	h->nearest = INFINITY;
	for (size_t r = 0; r < h->rows.shapes->count; r++)
		for (size_t c = 0; c < h->columns.shapes->count; c++)
			if (!is_itself(h, r, c)) {
				h->nearest = fmin(h->nearest, distance_at(h, r, c));
				h->farthest = fmax(h->farthest, distance_at(h, r, c));
			}
	h->nearest = fmin(h->nearest, h->farthest);
}

/* ---------------------------------------------------------------------------------------------- colours */

/* Viridis (Smith and van der Walt, 2015): even to the eye, also to a colour-blind one and in print without colours. Near is
 * dark. */
static unsigned colour_of_step(int step)
{
	static const unsigned char stops[][3] = {{68, 1, 84}, {72, 40, 120}, {62, 73, 137}, {49, 104, 142},
		{38, 130, 142}, {31, 158, 137}, {53, 183, 121}, {110, 206, 88}, {181, 222, 43}, {253, 231, 37}};
	const int last = sizeof stops / sizeof *stops - 1;
	const double position = (double)step / (COLOUR_STEPS - 1) * last;
	const int stop = position < last ? (int)position : last - 1;
	unsigned colour = 0;
	for (int i = 0; i < 3; i++) {
		const double value = stops[stop][i] + (position - stop) * (stops[stop + 1][i] - stops[stop][i]);
		colour = colour << 8 | (unsigned)(value + 0.5);
	}
	return colour;
}

/* By the square root: what is near is told apart more finely, and one far shape does not make all others dark. */
static int step_of(const heatmap *h, double distance)
{
	const double range = h->farthest - h->nearest;
	const double share = range > 0 ? (distance - h->nearest) / range : distance > 0;
	return (int)(sqrt(fmin(fmax(share, 0), 1)) * (COLOUR_STEPS - 1) + 0.5);
}

static void draw_tick(const heatmap *h, double share, const char *anchor)
{
	char value[32];
	snprintf(value, sizeof value, "%.2g", h->nearest + share * share * (h->farthest - h->nearest));
	esk_svg_text(h->svg, MARGIN + share * SCALE, HEADING + 42, 11, anchor, value);
}

static void draw_scale(const heatmap *h)
{
	esk_svg_text(h->svg, MARGIN, HEADING + 11, 12, "", "distance");
	for (int i = 0; i < COLOUR_STEPS; i++) { /* each over the rest of the one before */
		const double x = (double)i / COLOUR_STEPS * SCALE;
		esk_text_print(h->svg, "<rect x=\"%.2f\" y=\"%d\" width=\"%.2f\" height=\"10\" fill=\"#%06x\"/>",
			MARGIN + x, HEADING + 18, SCALE - x, colour_of_step(i));
	}
	draw_tick(h, 0, "");
	draw_tick(h, 0.5, "text-anchor=\"middle\"");
	draw_tick(h, 1, "text-anchor=\"end\"");
}

/* ---------------------------------------------------------------------------------------------- cells */

static void append_title(const heatmap *h, size_t row, size_t column)
{
	char a[ESK_SVG_LABEL_SIZE], b[ESK_SVG_LABEL_SIZE];
	esk_svg_label(&h->rows.shapes->shapes[h->rows.order[row]], a);
	esk_svg_label(&h->columns.shapes->shapes[h->columns.order[column]], b);
	esk_text_print(h->svg, "<title>");
	esk_svg_append_escaped(h->svg, a);
	esk_text_print(h->svg, " – ");
	esk_svg_append_escaped(h->svg, b);
	esk_text_print(h->svg, ": %.4g</title>", distance_at(h, row, column));
}

static void draw_titled_row(const heatmap *h, size_t row)
{
	for (size_t c = 0; c < h->columns.shapes->count; c++) {
		esk_text_print(h->svg, "<rect x=\"%zu\" y=\"%zu\" width=\"1\" height=\"1\" fill=\"#%06x\">", c, row,
			colour_of_step(step_of(h, distance_at(h, row, c))));
		append_title(h, row, c);
		esk_text_print(h->svg, "</rect>\n");
	}
}

/* All cells of one colour are one path, of stretches along the rows. */
static void draw_step(const heatmap *h, int step)
{
	bool any = false;
	for (size_t r = 0; r < h->rows.shapes->count; r++)
		for (size_t c = 0, end; c < h->columns.shapes->count; c = end) {
			for (end = c; end < h->columns.shapes->count && step_of(h, distance_at(h, r, end)) == step;)
				end++;
			if (end == c) {
				end++;
				continue;
			}
			if (!any)
				esk_text_print(h->svg, "<path fill=\"#%06x\" d=\"", colour_of_step(step));
			any = true;
			esk_text_print(h->svg, "M%zu %zuh%zuv1h-%zuz", c, r, end - c, end - c);
		}
	if (any)
		esk_text_print(h->svg, "\"/>\n");
}

/* Says of a row what is nearest to it, but itself. */
static void draw_title_of_row(const heatmap *h, size_t row)
{
	const size_t columns = h->columns.shapes->count;
	size_t nearest = columns;
	for (size_t c = 0; c < columns; c++)
		if (!is_itself(h, row, c) &&
			(nearest == columns || distance_at(h, row, c) < distance_at(h, row, nearest)))
			nearest = c;
	if (nearest == columns)
		return;
	esk_text_print(h->svg, "<rect y=\"%zu\" width=\"%zu\" height=\"1\" fill=\"#ffffff\" fill-opacity=\"0\">", row,
		columns);
	append_title(h, row, nearest);
	esk_text_print(h->svg, "</rect>\n");
}

static void draw_number(const heatmap *h, size_t row, size_t column)
{
	char number[32];
	const double distance = distance_at(h, row, column);
	snprintf(number, sizeof number, "%.2f", distance);
	esk_svg_text(h->svg, h->left + h->cell * ((double)column + 0.5), h->top + h->cell * ((double)row + 0.5) + 4,
		h->cell < 36 ? 10 : 12,
		step_of(h, distance) < COLOUR_STEPS * 2 / 3
			? "text-anchor=\"middle\" pointer-events=\"none\" fill=\"#ffffff\""
			: "text-anchor=\"middle\" pointer-events=\"none\"",
		number);
}

static void draw_cells(const heatmap *h)
{
	const size_t rows = h->rows.shapes->count, columns = h->columns.shapes->count;
	const bool titled = rows * columns <= MOST_TITLED_CELLS;
	esk_text_print(h->svg, "<g transform=\"translate(%.2f %.2f) scale(%.4f)\" shape-rendering=\"crispEdges\">\n",
		h->left, h->top, h->cell);
	for (int step = 0; !titled && step < COLOUR_STEPS; step++)
		draw_step(h, step);
	for (size_t r = 0; r < rows; r++)
		(titled ? draw_titled_row : draw_title_of_row)(h, r);
	esk_text_print(h->svg, "</g>\n");
	for (size_t r = 0; h->cell >= least_numbered_cell && r < rows; r++)
		for (size_t c = 0; c < columns; c++)
			draw_number(h, r, c);
}

/* ---------------------------------------------------------------------------------------------- trees and names */

/* Of a horizontal tree with its root at 0 and its leaves at h->tree, one every cell; transform puts it in its place. */
static eskel_status draw_tree(const heatmap *h, const axis *a, const char *transform)
{
	const size_t count = a->shapes->count;
	double(*places)[2] = calloc(2 * count + 1, sizeof *places); /* of clusters */
	if (!places)
		return ESKEL_NO_MEMORY;
	for (size_t i = 0; i < count; i++) {
		places[a->order[i]][0] = h->tree;
		places[a->order[i]][1] = h->cell * ((double)i + 0.5);
	}
	const double highest = count > 1 ? a->merges[count - 2].height : 0;
	esk_text_print(h->svg, "<g transform=\"%s\" fill=\"none\" stroke=\"#444444\" stroke-width=\"1\">\n", transform);
	for (size_t s = 0; s + 1 < count; s++) {
		const eskel_merge *m = &a->merges[s];
		const double *p = places[m->first], *q = places[m->second];
		const double x = highest > 0 ? h->tree * (1 - m->height / highest) : 0;
		esk_text_print(h->svg,
			"<path d=\"M%.1f %.1fH%.1fV%.1fH%.1f\"><title>%u shapes, %.4g apart</title></path>\n", p[0],
			p[1], x, q[1], q[0], m->size, m->height);
		places[count + s][0] = x;
		places[count + s][1] = (p[1] + q[1]) / 2;
	}
	esk_text_print(h->svg, "</g>\n");
	free(places);
	return ESKEL_OK;
}

static void draw_row_names(const heatmap *h)
{
	char label[ESK_SVG_LABEL_SIZE];
	for (size_t i = 0; i < h->rows.shapes->count; i++) {
		const uint32_t shape = h->rows.order[i];
		const double y = h->top + h->cell * ((double)i + 0.5);
		esk_svg_mark(h->svg, &h->classes, h->classes.of_shape[h->rows.offset + shape], h->left - GAP - h->mark,
			y, h->mark, false);
		esk_svg_label(&h->rows.shapes->shapes[shape], label);
		if (h->font > 0)
			esk_svg_text(h->svg, h->left + h->width + GAP, y + 0.35 * h->font, h->font, "", label);
	}
}

static void draw_column_names(const heatmap *h)
{
	char label[ESK_SVG_LABEL_SIZE];
	for (size_t i = 0; i < h->columns.shapes->count; i++) {
		const uint32_t shape = h->columns.order[i];
		const double x = h->left + h->cell * ((double)i + 0.5);
		esk_svg_mark(h->svg, &h->classes, h->classes.of_shape[h->columns.offset + shape], x,
			h->top - GAP - h->mark, h->mark, false);
		esk_svg_label(&h->columns.shapes->shapes[shape], label);
		if (h->font == 0)
			continue;
		esk_text_print(h->svg, "<g transform=\"translate(%.1f %.1f) rotate(-90)\">", x + 0.35 * h->font,
			h->top + h->height + GAP);
		esk_svg_text(h->svg, 0, 0, h->font, "text-anchor=\"end\"", label);
		esk_text_print(h->svg, "</g>");
	}
}

static void begin(const heatmap *h)
{
	char title[100];
	const double bottom = h->top + h->height + GAP + h->columns.label_width + MARGIN;
	const double legend = h->left + h->width + GAP + h->rows.label_width + MARGIN;
	const double width = legend + esk_svg_legend_width(&h->classes, bottom - HEADING - MARGIN) + MARGIN;
	if (h->rows.shapes == h->columns.shapes)
		snprintf(title, sizeof title, "Distances between %zu shape%s", h->rows.shapes->count,
			h->rows.shapes->count == 1 ? "" : "s");
	else
		snprintf(title, sizeof title, "Distances of %zu to %zu shapes", h->rows.shapes->count,
			h->columns.shapes->count);
	esk_svg_begin(h->svg, width, fmax(bottom, HEADING + h->tree + 80), title,
		"Dark is near. Like shapes stand together: the trees join them at their mean distance.");
	esk_svg_legend(h->svg, &h->classes, legend, HEADING, bottom - HEADING - MARGIN);
}

static eskel_status draw(heatmap *h)
{
	char transform[80];
	lay_out(h);
	find_range(h);
	begin(h);
	draw_scale(h);
	draw_cells(h);
	draw_row_names(h);
	draw_column_names(h);
	snprintf(transform, sizeof transform, "translate(%d %.2f)", MARGIN, h->top);
	eskel_status status = draw_tree(h, &h->rows, transform);
	snprintf(transform, sizeof transform, "matrix(0 1 1 0 %.2f %d)", h->left, HEADING);
	if (status == ESKEL_OK)
		status = draw_tree(h, &h->columns, transform);
	esk_svg_end(h->svg);
	return status;
}

eskel_status esk_picture_heatmap(esk_text *text, const esk_matrix *matrix, const double *distances)
{
	heatmap h = {.svg = text, .distances = distances, .count = matrix->rows.count + matrix->others.count};
	h.rows.shapes = &matrix->rows;
	h.columns.shapes = esk_matrix_columns(matrix);
	h.columns.offset = matrix->square ? 0 : matrix->rows.count;
	eskel_status status = esk_classes_init(&h.classes, matrix) ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (status == ESKEL_OK)
		status = order_axis(&h.rows, distances, h.count);
	if (status == ESKEL_OK)
		status = order_axis(&h.columns, distances, h.count);
	if (status == ESKEL_OK)
		status = draw(&h);
	free(h.rows.merges);
	free(h.rows.order);
	free(h.columns.merges);
	free(h.columns.order);
	esk_classes_clear(&h.classes);
	return status;
}
