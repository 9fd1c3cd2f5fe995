/* A map of shapes: classical scaling in the plane, both axes in one scale. Up to MOST_NAMED shapes have their names
 * beside them; of more, each class has its own beside its middle. A name that would cover another is left out: titles and
 * the legend have it. */
#include "picture.h"
#include "svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MARGIN = 24, HEADING = 80, WIDTH = 820, LEAST_HEIGHT = 320, MOST_HEIGHT = 820, PADDING = 48, FONT = 12 };
enum { FOOT = 40, MOST_NAMED = 40 };
enum { CROWD = 8 }; /* members of a class whose name may cover some */

typedef struct {
	double x0, y0, x1, y1;
} box;

typedef struct {
	esk_text *svg;
	const esk_matrix *matrix;
	const double *distances;
	size_t count;
	esk_classes classes;
	double (*points)[2];   /* in distances, then in pixels */
	double pixels, radius; /* of a distance of 1; of a mark */
	double height;
	box *taken;
	size_t taken_count;
} map;

static const esk_selected *shape_at(const map *m, size_t index)
{
	const size_t rows = m->matrix->rows.count;
	return index < rows ? &m->matrix->rows.shapes[index] : &m->matrix->others.shapes[index - rows];
}

/* How well distances in the plane stand for the given ones: the square of Pearson's correlation. */
static double faithfulness(const map *m)
{
	double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
	for (size_t i = 0; i < m->count; i++)
		for (size_t j = 0; j < i; j++) {
			const double x = m->distances[i * m->count + j];
			const double y = hypot(m->points[i][0] - m->points[j][0], m->points[i][1] - m->points[j][1]);
			n++;
			sx += x;
			sy += y;
			sxx += x * x;
			syy += y * y;
			sxy += x * y;
		}
	const double covariance = n * sxy - sx * sy, spread = (n * sxx - sx * sx) * (n * syy - sy * sy);
	return spread > 0 ? covariance * covariance / spread : 1;
}

/* ---------------------------------------------------------------------------------------------- layout */

/* The widest spread fills the frame. */
static void lay_out(map *m)
{
	double low[2] = {0, 0}, high[2] = {0, 0};
	for (size_t i = 0; i < m->count; i++)
		for (int axis = 0; axis < 2; axis++) {
			low[axis] = fmin(low[axis], m->points[i][axis]);
			high[axis] = fmax(high[axis], m->points[i][axis]);
		}
	const double wide = high[0] - low[0], tall = high[1] - low[1];
	m->pixels = wide > 0 ? fmin((WIDTH - 2 * PADDING) / wide, (MOST_HEIGHT - 2 * PADDING) / fmax(tall, 1e-9)) : 1;
	m->height = fmax(tall * m->pixels + 2 * PADDING, LEAST_HEIGHT);
	m->radius = m->count <= 100 ? 6 : m->count <= 300 ? 4.5 : 3;
	const double x = MARGIN + WIDTH / 2.0 - (low[0] + high[0]) / 2 * m->pixels;
	const double y = HEADING + m->height / 2 + (low[1] + high[1]) / 2 * m->pixels; /* up is positive */
	for (size_t i = 0; i < m->count; i++) {
		m->points[i][0] = x + m->points[i][0] * m->pixels;
		m->points[i][1] = y - m->points[i][1] * m->pixels;
	}
}

static void begin(const map *m, double faithful)
{
	char title[100], subtitle[200];
	const size_t rows = m->matrix->rows.count, others = m->matrix->others.count;
	if (m->matrix->square)
		snprintf(title, sizeof title, "Map of %zu shape%s", rows, rows == 1 ? "" : "s");
	else
		snprintf(title, sizeof title, "Map of %zu and %zu other (hollow) shapes", rows, others);
	snprintf(subtitle, sizeof subtitle,
		"Near marks are like shapes (classical scaling). The plane shows %.0f %% of how distances vary.",
		100 * faithful);
	const double legend = esk_svg_legend_width(&m->classes, m->height);
	esk_svg_begin(m->svg, MARGIN + WIDTH + MARGIN + legend + MARGIN, HEADING + m->height + FOOT, title, subtitle);
	esk_svg_legend(m->svg, &m->classes, MARGIN + WIDTH + MARGIN, HEADING, m->height);
	esk_text_print(m->svg,
		"<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%.1f\" rx=\"4\" fill=\"#fafafa\" stroke=\"#dddddd\"/>\n",
		MARGIN, HEADING, WIDTH, m->height);
}

/* 1, 2 or 5 times a power of ten, 60 to 150 pixels long. */
static void draw_scale(const map *m)
{
	char name[40];
	double length = pow(10, floor(log10(150 / m->pixels)));
	length *= 5 * length * m->pixels <= 150 ? 5 : 2 * length * m->pixels <= 150 ? 2 : 1;
	const double y = HEADING + m->height + 16, x = MARGIN + length * m->pixels;
	esk_text_print(m->svg, "<path d=\"M%d %.1fv8m0-4H%.1fm0-4v8\" fill=\"none\" stroke=\"" ESK_SVG_INK "\"/>\n",
		MARGIN, y - 4, x);
	snprintf(name, sizeof name, "distance %g", length);
	esk_svg_text(m->svg, x + 8, y + 4, FONT, "", name);
}

/* ---------------------------------------------------------------------------------------------- marks and names */

static void draw_mark(const map *m, size_t index)
{
	const esk_selected *shape = shape_at(m, index);
	static const char *const sides[] = {"", ", left", ", right", ""};
	esk_text_print(m->svg, "<g>");
	esk_svg_mark(m->svg, &m->classes, m->classes.of_shape[index], m->points[index][0], m->points[index][1],
		m->radius, index >= m->matrix->rows.count);
	esk_text_print(m->svg, "<title>");
	esk_svg_append_escaped(m->svg, shape->name && shape->name[0] ? shape->name : shape->id);
	if (shape->class) {
		esk_text_print(m->svg, " (");
		esk_svg_append_escaped(m->svg, shape->class);
		esk_text_print(m->svg, "%s)", sides[shape->side]);
	}
	esk_text_print(m->svg, "</title></g>\n");
}

/* Of what was taken from the first one on: marks, then names. */
static bool is_free(const map *m, const box *b, size_t first)
{
	if (b->x0 < MARGIN || b->x1 > MARGIN + WIDTH || b->y0 < HEADING || b->y1 > HEADING + m->height)
		return false;
	for (size_t i = first; i < m->taken_count; i++) {
		const box *t = &m->taken[i];
		if (b->x0 < t->x1 && t->x0 < b->x1 && b->y0 < t->y1 && t->y0 < b->y1)
			return false;
	}
	return true;
}

static void take_box(map *m, const box *b)
{
	m->taken[m->taken_count++] = *b;
}

/* To the right, to the left, above or below a place, whichever is free first; else, with covering, over marks. With a rim, so
 * that it is legible there. */
static void draw_name(map *m, const double *place, const char *name, const char *weight, bool covering)
{
	const double x = place[0], y = place[1], width = esk_svg_text_width(FONT, name), away = m->radius + 4;
	const struct {
		double x, y, start;
		const char *anchor;
	} spots[] = {
		{x + away, y + 4, x + away, "start"},
		{x - away, y + 4, x - away - width, "end"},
		{x, y - away, x - width / 2, "middle"},
		{x, y + away + 9, x - width / 2, "middle"},
	};
	const size_t count = sizeof spots / sizeof *spots;
	for (size_t i = 0; i < (covering ? 2 : 1) * count; i++) {
		const double left = spots[i % count].start, base = spots[i % count].y;
		const box b = {left, base - 10, left + width, base + 3};
		char attributes[120], rim[200];
		if (!is_free(m, &b, i < count ? 0 : m->count))
			continue;
		take_box(m, &b);
		snprintf(attributes, sizeof attributes, "text-anchor=\"%s\" %s", spots[i % count].anchor, weight);
		snprintf(rim, sizeof rim, "%s stroke=\"#fafafa\" stroke-width=\"3\" stroke-linejoin=\"round\"",
			attributes);
		esk_svg_text(m->svg, spots[i % count].x, base, FONT, rim, name);
		esk_svg_text(m->svg, spots[i % count].x, base, FONT, attributes, name);
		return;
	}
}

static void draw_names_of_shapes(map *m)
{
	char label[ESK_SVG_LABEL_SIZE];
	for (size_t i = 0; i < m->count; i++) {
		esk_svg_label(shape_at(m, i), label);
		draw_name(m, m->points[i], label, "", false);
	}
}

/* The member of a class nearest to its middle, and how many there are. */
static size_t central_member(const map *m, uint32_t class, size_t *count)
{
	double middle[2] = {0, 0}, best = INFINITY;
	size_t members = 0, central = 0;
	for (size_t i = 0; i < m->count; i++)
		if (m->classes.of_shape[i] == class) {
			middle[0] += m->points[i][0];
			middle[1] += m->points[i][1];
			members++;
		}
	for (size_t i = 0; i < m->count; i++) {
		const double away = hypot(
			m->points[i][0] - middle[0] / (double)members, m->points[i][1] - middle[1] / (double)members);
		if (m->classes.of_shape[i] == class && away < best) {
			best = away;
			central = i;
		}
	}
	*count = members;
	return central;
}

static void draw_names_of_classes(map *m)
{
	for (uint32_t class = 0; class < m->classes.count; class ++) {
		size_t members;
		const double *p = m->points[central_member(m, class, &members)];
		if (m->classes.names[class][0])
			draw_name(m, p, m->classes.names[class], "font-weight=\"600\"", members >= CROWD);
	}
}

static void draw(map *m)
{
	const double faithful = faithfulness(m);
	lay_out(m);
	begin(m, faithful);
	for (size_t i = 0; i < m->count; i++) {
		const double *p = m->points[i], r = m->radius;
		draw_mark(m, i);
		take_box(m, &(box){p[0] - r, p[1] - r, p[0] + r, p[1] + r});
	}
	if (m->count <= MOST_NAMED)
		draw_names_of_shapes(m);
	else
		draw_names_of_classes(m);
	draw_scale(m);
	esk_svg_end(m->svg);
}

eskel_status esk_picture_map(esk_text *text, const esk_matrix *matrix, const double *distances)
{
	map m = {.svg = text, .matrix = matrix, .distances = distances};
	m.count = matrix->rows.count + matrix->others.count;
	m.points = calloc(m.count + 1, sizeof *m.points);
	m.taken = calloc(2 * m.count + 1, sizeof *m.taken);
	eskel_status status = m.points && m.taken && esk_classes_init(&m.classes, matrix) ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (status == ESKEL_OK)
		status = eskel_scaling(distances, m.count, m.points);
	if (status == ESKEL_OK)
		draw(&m);
	free(m.points);
	free(m.taken);
	esk_classes_clear(&m.classes);
	return status;
}
