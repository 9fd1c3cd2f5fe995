#include "svg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EDGE = 24, LABEL_CHARACTERS = 40, LEGEND_LINE = 18, LEGEND_FONT = 12, LEGEND_MARK = 5, LEGEND_GAP = 24 };

void esk_svg_begin(esk_text *svg, double width, double height, const char *title, const char *subtitle)
{
	width = fmax(width, 2 * EDGE + esk_svg_text_width(13, subtitle));
	esk_text_print(svg,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
		"font-family=\"system-ui, 'Helvetica Neue', Arial, sans-serif\" fill=\"" ESK_SVG_INK
		"\" role=\"img\">\n<title>",
		width, height, width, height);
	esk_svg_append_escaped(svg, title);
	esk_text_print(svg, "</title>\n<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n");
	esk_svg_text(svg, EDGE, 36, 20, "font-weight=\"600\"", title);
	esk_svg_text(svg, EDGE, 57, 13, "fill=\"" ESK_SVG_PALE "\"", subtitle);
}

void esk_svg_end(esk_text *svg)
{
	esk_text_print(svg, "</svg>\n");
}

void esk_svg_append_escaped(esk_text *svg, const char *text)
{
	while (*text) {
		const size_t plain = strcspn(text, "&<>\"");
		esk_text_append(svg, text, plain);
		text += plain;
		if (*text) {
			esk_text_print(svg, "%s",
				*text == '&'   ? "&amp;"
				: *text == '<' ? "&lt;"
				: *text == '>' ? "&gt;"
					       : "&quot;");
			text++;
		}
	}
}

void esk_svg_text(esk_text *svg, double x, double y, double size, const char *attributes, const char *text)
{
	esk_text_print(svg, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.1f\" %s>", x, y, size, attributes);
	esk_svg_append_escaped(svg, text);
	esk_text_print(svg, "</text>\n");
}

static bool begins_character(char byte)
{
	return ((unsigned char)byte & 0xc0) != 0x80;
}

/* Of the widest of common fonts, DejaVu Sans, Latin letters are 0.62 as wide as high on average; what is encoded in three
 * bytes or more may be as wide as high. */
double esk_svg_text_width(double size, const char *text)
{
	double width = 0;
	for (; *text; text++)
		if (begins_character(*text))
			width += (unsigned char)*text >= 0xe0 ? 1 : 0.62;
	return width * size;
}

void esk_svg_label(const esk_selected *shape, char label[ESK_SVG_LABEL_SIZE])
{
	const char *whole = shape->name && shape->name[0] ? shape->name : shape->id;
	const size_t most = whole == shape->id ? 8 : LABEL_CHARACTERS;
	size_t size = 0;
	for (size_t characters = 0; whole[size]; size++)
		if (begins_character(whole[size]) && characters++ == most)
			break;
	memcpy(label, whole, size);
	strcpy(label + size, whole[size] ? "…" : "");
}

/* ---------------------------------------------------------------------------------------------- classes */

static const char *name_of(const esk_selected *shape)
{
	return shape->class ? shape->class : "";
}

static const esk_selected *shape_at(const esk_matrix *matrix, size_t index)
{
	return index < matrix->rows.count ? &matrix->rows.shapes[index]
					  : &matrix->others.shapes[index - matrix->rows.count];
}

static int by_name(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

bool esk_classes_init(esk_classes *classes, const esk_matrix *matrix)
{
	esk_classes made = {.shape_count = matrix->rows.count + matrix->others.count};
	made.names = calloc(made.shape_count + 1, sizeof *made.names);
	made.of_shape = calloc(made.shape_count + 1, sizeof *made.of_shape);
	if (!made.names || !made.of_shape) {
		esk_classes_clear(&made);
		return false;
	}
	for (size_t i = 0; i < made.shape_count; i++)
		made.names[i] = name_of(shape_at(matrix, i));
	qsort(made.names, made.shape_count, sizeof *made.names, by_name);
	for (size_t i = 0; i < made.shape_count; i++)
		if (i == 0 || strcmp(made.names[i], made.names[made.count - 1]) != 0)
			made.names[made.count++] = made.names[i];
	for (size_t i = 0; i < made.shape_count; i++) {
		const char *name = name_of(shape_at(matrix, i));
		const char **found = bsearch(&name, made.names, made.count, sizeof *made.names, by_name);
		made.of_shape[i] = (uint32_t)(found - made.names);
	}
	*classes = made;
	return true;
}

void esk_classes_clear(esk_classes *classes)
{
	free(classes->names);
	free(classes->of_shape);
	*classes = (esk_classes){0};
}

/* ---------------------------------------------------------------------------------------------- marks */

/* Okabe and Ito's colours, which the colour-blind tell apart. */
static const char *const colours[] = {
	"#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#f0e442", "#595959"};

/* Of radius about 1, at the origin. */
static const char *const forms[] = {
	"M-1 0a1 1 0 1 0 2 0a1 1 0 1 0 -2 0z",
	"M-.88-.88h1.76v1.76h-1.76z",
	"M0-1.15 1.1.8-1.1.8z",
	"M0-1.25 1.25 0 0 1.25-1.25 0z",
	"M0 1.15 1.1-.8-1.1-.8z",
	"M-.4-1.15h.8v.75h.75v.8h-.75v.75h-.8v-.75h-.75v-.8h.75z",
};

enum { COLOURS = sizeof colours / sizeof *colours, FORMS = sizeof forms / sizeof *forms };

void esk_svg_mark(
	esk_text *svg, const esk_classes *classes, uint32_t class, double x, double y, double radius, bool hollow)
{
	const bool unknown = classes->names[class][0] == '\0';
	const uint32_t number = class - (classes->names[0][0] == '\0' && !unknown); /* among the known */
	const char *colour = unknown ? "#bbbbbb" : colours[number % COLOURS];
	const char *form = forms[unknown ? 0 : (number % COLOURS + number / COLOURS) % FORMS];
	esk_text_print(svg,
		"<path transform=\"translate(%.1f %.1f) scale(%.2f)\" fill=\"%s\" stroke=\"%s\" stroke-width=\"%.2f\" "
		"d=\"%s\"/>",
		x, y, radius, hollow ? "#ffffff" : colour, hollow ? colour : ESK_SVG_INK, (hollow ? 1.8 : 0.6) / radius,
		form);
}

static size_t legend_rows(double height)
{
	return height < LEGEND_LINE ? 1 : (size_t)(height / LEGEND_LINE);
}

static const char *legend_name(const esk_classes *classes, size_t class)
{
	return classes->names[class][0] ? classes->names[class] : "no class";
}

static double column_width(const esk_classes *classes, size_t first, size_t rows)
{
	double widest = 0;
	for (size_t i = first; i < classes->count && i < first + rows; i++) {
		const double width = esk_svg_text_width(LEGEND_FONT, legend_name(classes, i));
		widest = width > widest ? width : widest;
	}
	return widest + 3 * LEGEND_MARK + LEGEND_GAP;
}

double esk_svg_legend_width(const esk_classes *classes, double height)
{
	double width = 0;
	for (size_t i = 0; i < classes->count; i += legend_rows(height))
		width += column_width(classes, i, legend_rows(height));
	return width;
}

void esk_svg_legend(esk_text *svg, const esk_classes *classes, double x, double y, double height)
{
	const size_t rows = legend_rows(height);
	for (size_t i = 0; i < classes->count; i++) {
		const double line = y + LEGEND_LINE * ((double)(i % rows) + 0.5);
		if (i > 0 && i % rows == 0)
			x += column_width(classes, i - rows, rows);
		esk_svg_mark(svg, classes, (uint32_t)i, x + LEGEND_MARK, line, LEGEND_MARK, false);
		esk_svg_text(svg, x + 3 * LEGEND_MARK, line + 4, LEGEND_FONT, "", legend_name(classes, i));
	}
}
