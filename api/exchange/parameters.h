/* The query of a URL, parsed once for every route: one table of parameters (parameters.c) says how each value is taken, a
 * route names those that it allows. The parsed struct borrows text from the fields it was parsed from. */
#ifndef ESK_PARAMETERS_H
#define ESK_PARAMETERS_H

#include "eskel_api.h"
#include "problem.h"
#include "value.h"

/* What is said of one label: label.N.name, .class, .side. */
typedef struct {
	int32_t label;
	const char *name;              /* NULL: not said, as everywhere below */
	char class[ESK_TEXT_MOST + 1]; /* normalised (label_name.h); "": not said */
	eskel_side side;
} esk_label_words;

enum { ESK_FORMAT_JSON, ESK_FORMAT_CSV, ESK_FORMAT_NPY, ESK_FORMAT_SVG, ESK_FORMAT_UNSAID };
enum { ESK_MESH_GLB, ESK_MESH_STL, ESK_MESH_PLY, ESK_MESH_OBJ };
enum { ESK_FRAME_RAS, ESK_FRAME_LPS };
enum { ESK_SOURCE_SKELETON, ESK_SOURCE_VOXELS };
enum {
	ESK_PRIMITIVE_ELLIPSOID,
	ESK_PRIMITIVE_SUPERQUADRIC,
	ESK_PRIMITIVE_DEFORMED,
	ESK_PRIMITIVE_ALGEBRAIC,
	ESK_PRIMITIVE_UNSAID
};
enum { ESK_METHOD_UNSAID = ESKEL_FIT_LEAST_SQUARES + 1 };
enum { ESK_COMPOSE_BLEND, ESK_COMPOSE_UNION, ESK_COMPOSE_UNSAID };
enum { ESK_ORDER_DISTANCE, ESK_ORDER_POSITION };
enum { ESK_PLOT_HEATMAP, ESK_PLOT_MAP, ESK_PLOT_UNSAID };

typedef struct esk_parameters {
	/* said of shapes: a description where shapes are posted, a condition where they are chosen */
	const char *name, *subject, *not_subject, *text;
	char class[ESK_TEXT_MOST + 1];
	eskel_side side;
	eskel_sex sex;
	double age, age_min, age_max; /* NaN: not said */
	size_t attribute_count;
	eskel_attribute *attributes; /* ascending unique keys */

	/* labels of a posted volume; none given: all */
	size_t label_count;
	int32_t *labels;
	bool all_labels; /* label=all was given */
	size_t words_count;
	esk_label_words *words;
	unsigned weights; /* the voxels are weights */
	double spacing;   /* mm, of the voxels of a posted mesh; 0: not given */

	const char *shape; /* an id */
	size_t id_count;
	char (*ids)[ESKEL_ID_SIZE];
	int64_t cursor;                                          /* the key to go on after */
	unsigned limit, level, levels, minimum;                  /* 0: not given */
	double keep;                                             /* 0: not given */
	unsigned mode, scale, signature, distance, metric, size; /* of the enums of eskel.h */
	unsigned order;                                          /* ESK_ORDER_... */
	unsigned format;                                         /* ESK_FORMAT_... */
	unsigned volume_format;                                  /* eskel_volume_format */
	unsigned plot;                                           /* ESK_PLOT_... */
	double step;                                             /* mm; 0: not given */
	double eye_distance;                                     /* mm; NaN: not given */
	unsigned mesh_format, frame, source, compose, primitive; /* ESK_MESH_... and so on */
	unsigned method;                                         /* eskel_fit_method, or ESK_METHOD_UNSAID */
	int64_t seed;                                            /* -1: not given */
	unsigned explain;
	unsigned as_said;               /* names tell nothing */
	unsigned leave_out;             /* ESK_LEAVE_OUT_... (evaluation.h) */
	struct esk_parameters *columns; /* what columns.NAME says, as NAME does here; NULL: nothing */
	bool all;                       /* of columns: columns=all was given */
} esk_parameters;

/* allowed: NULL-terminated names as in the route table; attr.KEY and label.N.name stand for their families, a name
 * after "columns." is one of the parameters of columns, and what stands after a slash tells parameters of one name apart. A name
 * that is not allowed is refused with those that are, a value out of its range with the range, a second value of a
 * parameter that takes one. The query must be clear (all zero) before; clear it also after a failure. */
bool esk_parameters_parse(esk_parameters *query, const char *const *allowed, const eskel_field *fields, size_t count,
	esk_problem *problem);
void esk_parameters_clear(esk_parameters *query);

/* The conditions on shapes, borrowed from the query. */
eskel_filter esk_parameters_filter(const esk_parameters *query);

/* What is said of one label of a volume, NULL if nothing. */
const esk_label_words *esk_parameters_words(const esk_parameters *query, int32_t label);

eskel_distance_options esk_parameters_distance(const esk_parameters *query);

/* The word that was chosen, or is the default, for a parameter that has a choice: "log" for "signature". */
const char *esk_parameters_choice(const esk_parameters *query, const char *name);

/* The opaque text of a cursor, for the parameter of that name. */
#define ESK_CURSOR_SIZE 18
void esk_parameters_cursor_text(int64_t key, char text[ESK_CURSOR_SIZE]);

#endif
