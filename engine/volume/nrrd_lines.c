#include "nrrd_lines.h"

#include "error.h"

#include <string.h>
#include <strings.h>

static const struct {
	const char *name;
	esk_nrrd_field field;
} field_names[] = {
	{"type", ESK_NRRD_TYPE},
	{"dimension", ESK_NRRD_DIMENSION},
	{"sizes", ESK_NRRD_SIZES},
	{"encoding", ESK_NRRD_ENCODING},
	{"endian", ESK_NRRD_ENDIAN},
	{"kinds", ESK_NRRD_KINDS},
	{"space", ESK_NRRD_SPACE},
	{"space dimension", ESK_NRRD_SPACE_DIMENSION},
	{"space directions", ESK_NRRD_SPACE_DIRECTIONS},
	{"space origin", ESK_NRRD_SPACE_ORIGIN},
	{"space units", ESK_NRRD_SPACE_UNITS},
	{"spacings", ESK_NRRD_SPACINGS},
	{"axis mins", ESK_NRRD_AXIS_MINS},
	{"axismins", ESK_NRRD_AXIS_MINS},
	{"centers", ESK_NRRD_CENTERINGS},
	{"centerings", ESK_NRRD_CENTERINGS},
	{"units", ESK_NRRD_UNITS},
	{"line skip", ESK_NRRD_LINE_SKIP},
	{"lineskip", ESK_NRRD_LINE_SKIP},
	{"byte skip", ESK_NRRD_BYTE_SKIP},
	{"byteskip", ESK_NRRD_BYTE_SKIP},
	{"data file", ESK_NRRD_DATA_FILE},
	{"datafile", ESK_NRRD_DATA_FILE},
	{"content", ESK_NRRD_IGNORED},
	{"number", ESK_NRRD_IGNORED},
	{"block size", ESK_NRRD_IGNORED},
	{"blocksize", ESK_NRRD_IGNORED},
	{"min", ESK_NRRD_IGNORED},
	{"max", ESK_NRRD_IGNORED},
	{"old min", ESK_NRRD_IGNORED},
	{"oldmin", ESK_NRRD_IGNORED},
	{"old max", ESK_NRRD_IGNORED},
	{"oldmax", ESK_NRRD_IGNORED},
	{"sample units", ESK_NRRD_IGNORED},
	{"sampleunits", ESK_NRRD_IGNORED},
	{"thicknesses", ESK_NRRD_IGNORED},
	{"axis maxs", ESK_NRRD_IGNORED},
	{"axismaxs", ESK_NRRD_IGNORED},
	{"labels", ESK_NRRD_IGNORED},
	{"measurement frame", ESK_NRRD_IGNORED},
};

bool esk_nrrd_span_is(esk_nrrd_span span, const char *word)
{
	return strlen(word) == span.size && strncasecmp(word, span.text, span.size) == 0;
}

bool esk_nrrd_next_line(esk_nrrd_span *text, esk_nrrd_span *line)
{
	if (text->size == 0)
		return false;
	const char *end = memchr(text->text, '\n', text->size);
	size_t size = end ? (size_t)(end - text->text) : text->size, taken = end ? size + 1 : size;
	*line = (esk_nrrd_span){text->text, size > 0 && text->text[size - 1] == '\r' ? size - 1 : size};
	text->text += taken;
	text->size -= taken;
	return true;
}

static esk_nrrd_span trimmed(esk_nrrd_span span)
{
	while (span.size > 0 && (span.text[0] == ' ' || span.text[0] == '\t')) {
		span.text++;
		span.size--;
	}
	while (span.size > 0 && (span.text[span.size - 1] == ' ' || span.text[span.size - 1] == '\t'))
		span.size--;
	return span;
}

esk_nrrd_line_kind esk_nrrd_split(esk_nrrd_span line, esk_nrrd_span *name, esk_nrrd_span *value)
{
	if (line.size > 0 && line.text[0] == '#')
		return ESK_NRRD_COMMENT;
	for (size_t i = 0; i < line.size; i++) {
		const char next = i + 1 < line.size ? line.text[i + 1] : ' ';
		if (line.text[i] != ':' || (next != ' ' && next != '='))
			continue;
		const size_t begin = i + 2 < line.size ? i + 2 : line.size;
		*name = (esk_nrrd_span){line.text, i};
		*value = (esk_nrrd_span){line.text + begin, line.size - begin};
		return next == ' ' ? ESK_NRRD_FIELD : ESK_NRRD_PAIR;
	}
	return ESK_NRRD_NEITHER;
}

esk_nrrd_field esk_nrrd_field_named(esk_nrrd_span name)
{
	for (size_t i = 0; i < sizeof field_names / sizeof *field_names; i++)
		if (esk_nrrd_span_is(name, field_names[i].name))
			return field_names[i].field;
	return ESK_NRRD_UNKNOWN;
}

void esk_nrrd_print(esk_nrrd_span span, char *to, size_t room)
{
	size_t size = span.size < room ? span.size : room - 1;
	for (size_t i = 0; i < size; i++)
		to[i] = span.text[i] >= ' ' && span.text[i] < 0x7f ? span.text[i] : '?';
	to[size] = 0;
}

static eskel_status refuse(size_t number, esk_nrrd_span line, const char *why, eskel_error *error)
{
	char shown[80];
	esk_nrrd_print(line, shown, sizeof shown);
	return esk_error_set(error, ESKEL_MALFORMED, "line %zu of the NRRD header, \"%s\", %s", number, shown, why);
}

static eskel_status take_line(esk_nrrd_fields *fields, size_t number, esk_nrrd_span line, eskel_error *error)
{
	esk_nrrd_span name, value;
	const esk_nrrd_line_kind kind = esk_nrrd_split(line, &name, &value);
	if (kind == ESK_NRRD_NEITHER)
		return refuse(number, line, "is no field, expected \"name: value\" or \"key:=value\"", error);
	if (kind != ESK_NRRD_FIELD)
		return ESKEL_OK;
	const esk_nrrd_field field = esk_nrrd_field_named(name);
	if (field == ESK_NRRD_UNKNOWN)
		return refuse(number, line, "is a field that NRRD does not define", error);
	if (field == ESK_NRRD_IGNORED)
		return ESKEL_OK;
	value = trimmed(value);
	if (fields->values[field][0])
		return refuse(number, line, "says what another line says already", error);
	if (value.size >= sizeof fields->values[field])
		return refuse(number, line, "is too long", error);
	esk_nrrd_print(value, fields->values[field], sizeof fields->values[field]);
	return ESKEL_OK;
}

eskel_status esk_nrrd_fields_read(esk_nrrd_span header, esk_nrrd_fields *fields, eskel_error *error)
{
	esk_nrrd_span line;
	eskel_status status = ESKEL_OK;
	memset(fields, 0, sizeof *fields);
	esk_nrrd_next_line(&header, &line);
	for (size_t number = 2; status == ESKEL_OK && esk_nrrd_next_line(&header, &line) && line.size > 0; number++)
		status = take_line(fields, number, line, error);
	return status;
}
