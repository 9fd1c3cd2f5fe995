/* The lines of an NRRD header, and what stands in its fields. */
#ifndef ESK_NRRD_LINES_H
#define ESK_NRRD_LINES_H

#include "eskel.h"

typedef struct {
	const char *text; /* not terminated */
	size_t size;
} esk_nrrd_span;

/* Whether the span is this word, whatever the case of its letters. */
bool esk_nrrd_span_is(esk_nrrd_span span, const char *word);

/* As much of the span as fits into room, terminated, with '?' for what is not printable ASCII. */
void esk_nrrd_print(esk_nrrd_span span, char *to, size_t room);

/* Takes the next line from text, without its end (\n or \r\n). False when nothing is left. */
bool esk_nrrd_next_line(esk_nrrd_span *text, esk_nrrd_span *line);

/* "name: value" is a field, "name:=value" a pair, what begins with # a comment. */
typedef enum { ESK_NRRD_COMMENT, ESK_NRRD_FIELD, ESK_NRRD_PAIR, ESK_NRRD_NEITHER } esk_nrrd_line_kind;
esk_nrrd_line_kind esk_nrrd_split(esk_nrrd_span line, esk_nrrd_span *name, esk_nrrd_span *value);

/* The fields that say what the voxels are and where. */
typedef enum {
	ESK_NRRD_TYPE,
	ESK_NRRD_DIMENSION,
	ESK_NRRD_SIZES,
	ESK_NRRD_ENCODING,
	ESK_NRRD_ENDIAN,
	ESK_NRRD_KINDS,
	ESK_NRRD_SPACE,
	ESK_NRRD_SPACE_DIMENSION,
	ESK_NRRD_SPACE_DIRECTIONS,
	ESK_NRRD_SPACE_ORIGIN,
	ESK_NRRD_SPACE_UNITS,
	ESK_NRRD_SPACINGS,
	ESK_NRRD_AXIS_MINS,
	ESK_NRRD_CENTERINGS,
	ESK_NRRD_UNITS,
	ESK_NRRD_LINE_SKIP,
	ESK_NRRD_BYTE_SKIP,
	ESK_NRRD_DATA_FILE,
	ESK_NRRD_IGNORED, /* known, and of no meaning to labels in space */
	ESK_NRRD_UNKNOWN
} esk_nrrd_field;

esk_nrrd_field esk_nrrd_field_named(esk_nrrd_span name);

/* Values are printable ASCII, other bytes replaced by '?', without blanks at their ends; empty when the field is absent.
 * Three vectors of the longest doubles fit. */
typedef struct {
	char values[ESK_NRRD_IGNORED][512];
} esk_nrrd_fields;

/* Reads the lines after the first up to an empty one. ESKEL_MALFORMED for a line that is no field, pair or comment, an
 * unknown field, one that stands twice or has too long a value. */
eskel_status esk_nrrd_fields_read(esk_nrrd_span header, esk_nrrd_fields *fields, eskel_error *error);

#endif
