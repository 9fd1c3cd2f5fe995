/* What the pictures are made of: texts, marks of classes, a legend. Lengths are in pixels. */
#ifndef ESK_SVG_H
#define ESK_SVG_H

#include "matrix.h"

#define ESK_SVG_INK "#222222"
#define ESK_SVG_PALE "#666666"

void esk_svg_begin(esk_text *svg, double width, double height, const char *title, const char *subtitle);
void esk_svg_end(esk_text *svg);

/* For the text of an element, or the value of an attribute. */
void esk_svg_append_escaped(esk_text *svg, const char *text);

/* A text of that size with its beginning, middle or end at x, as attributes say: "fill=\"...\"". */
void esk_svg_text(esk_text *svg, double x, double y, double size, const char *attributes, const char *text);
/* About how wide that text is. */
double esk_svg_text_width(double size, const char *text);

/* The name, shortened to what a label shows, or else the beginning of the id. */
enum { ESK_SVG_LABEL_SIZE = 128 };
void esk_svg_label(const esk_selected *shape, char label[ESK_SVG_LABEL_SIZE]);

/* The classes of some shapes, by name. */
typedef struct {
	size_t count, shape_count;
	const char **names; /* [count] borrowed, ascending; "" first if a shape has none */
	uint32_t *of_shape; /* [shape_count] */
} esk_classes;

/* Of the rows, then of the others. False when memory ran out. */
bool esk_classes_init(esk_classes *classes, const esk_matrix *matrix);
void esk_classes_clear(esk_classes *classes);

/* The colour and form of a class. Forty-eight differ. */
void esk_svg_mark(
	esk_text *svg, const esk_classes *classes, uint32_t class, double x, double y, double radius, bool hollow);

/* Marks and names one below the other, in as many columns as the height needs. */
void esk_svg_legend(esk_text *svg, const esk_classes *classes, double x, double y, double height);
double esk_svg_legend_width(const esk_classes *classes, double height);

#endif
