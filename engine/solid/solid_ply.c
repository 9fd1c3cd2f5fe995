/* PLY: a header of lines that name elements and their properties, then rows of values, one after the other in one of three
 * encodings. The values are taken one by one, wherever they come from; of the element vertex the properties x, y and z are
 * kept, of the element face the list vertex_indices or vertex_index, a polygon that is fanned about its first corner.
 */
#include "byte_order.h"
#include "error.h"
#include "solid_format.h"

#include <math.h>
#include <string.h>

static bool find_type(const char *name, esk_ply_type *type)
{
	static const struct {
		const char *names[2];
		esk_ply_type type;
	} types[] = {
		{{"char", "int8"}, {1, true, false}},
		{{"uchar", "uint8"}, {1, false, false}},
		{{"short", "int16"}, {2, true, false}},
		{{"ushort", "uint16"}, {2, false, false}},
		{{"int", "int32"}, {4, true, false}},
		{{"uint", "uint32"}, {4, false, false}},
		{{"float", "float32"}, {4, true, true}},
		{{"double", "float64"}, {8, true, true}},
	};
	for (size_t i = 0; name && i < sizeof types / sizeof *types; i++)
		if (strcmp(name, types[i].names[0]) == 0 || strcmp(name, types[i].names[1]) == 0) {
			*type = types[i].type;
			return true;
		}
	return false;
}

/* ---------------------------------------------------------------------------------------------- values */

static const esk_ply_property *present(const esk_solid_ply *ply)
{
	return &ply->elements[ply->element].properties[ply->property];
}

/* Whether the cursor stands on a value: elements without rows or properties have none. */
static bool settle(esk_solid_ply *ply)
{
	while (ply->element < ply->element_count) {
		const esk_ply_element *element = &ply->elements[ply->element];
		if (ply->row < element->count && ply->property < element->property_count)
			return true;
		ply->property = 0;
		ply->row++;
		if (ply->row < element->count && element->property_count > 0)
			return true;
		ply->row = 0;
		ply->element++;
	}
	return false;
}

/* A list's length has been taken, or a value. */
static void step(esk_solid_ply *ply)
{
	if (ply->in_list && ply->list_left > 0)
		return;
	ply->in_list = false;
	ply->property++;
}

static eskel_status begin_list(esk_solid_ply *ply, double length, eskel_error *error)
{
	if (!(length >= 0 && length <= ESK_SOLID_MOST_TRIANGLES) || length != rint(length))
		return esk_error_set(error, ESKEL_MALFORMED, "a list in row %llu has %g values, expected 0 to %u",
			(unsigned long long)ply->row, length, ESK_SOLID_MOST_TRIANGLES);
	ply->in_list = true;
	ply->list_left = (uint64_t)length;
	ply->corner = 0;
	return ESKEL_OK;
}

static eskel_status take_corner(esk_solid_reader *reader, double value, eskel_error *error)
{
	esk_solid_ply *ply = &reader->ply;
	if (!(value >= 0 && value <= UINT32_MAX) || value != rint(value))
		return esk_error_set(error, ESKEL_MALFORMED, "face %llu names vertex %g, expected a number from 0 on",
			(unsigned long long)ply->row, value);
	ply->corners[ply->corner] = (uint32_t)value;
	if (ply->corner < 2) {
		ply->corner++;
		return ESKEL_OK;
	}
	eskel_status status = esk_solid_add_triangle(&reader->solid, ply->corners, error);
	ply->corners[1] = ply->corners[2];
	return status;
}

static eskel_status take_value(esk_solid_reader *reader, double value, eskel_error *error)
{
	esk_solid_ply *ply = &reader->ply;
	const esk_ply_property *property = present(ply);
	const bool ends_row = !ply->in_list && ply->property + 1 == ply->elements[ply->element].property_count;
	eskel_status status = ESKEL_OK;
	if (property->is_list && !ply->in_list) {
		status = begin_list(ply, value, error);
	} else {
		ply->list_left -= ply->in_list;
		if (property->role == ESK_PLY_CORNERS)
			status = take_corner(reader, value, error);
		else if (property->role != ESK_PLY_OTHER)
			ply->at[property->role - ESK_PLY_X] = value;
	}
	/* A vertex has no list, see end_header. */
	if (status == ESKEL_OK && ends_row && ply->elements[ply->element].is_vertex)
		status = esk_solid_add_vertex(&reader->solid, ply->at, error);
	step(ply);
	return status;
}

static eskel_status refuse_more(esk_solid_reader *reader, const uint8_t *item, eskel_error *error)
{
	(void)reader, (void)item;
	return esk_error_set(error, ESKEL_MALFORMED, "the file goes on after its last element");
}

static eskel_status take_binary(esk_solid_reader *reader, const uint8_t *item, eskel_error *error);

/* Asks for the next value of a binary file. */
static void await(esk_solid_reader *reader)
{
	esk_solid_ply *ply = &reader->ply;
	reader->complete = !settle(ply);
	if (ply->encoding == ESK_PLY_ASCII)
		return;
	reader->item_size = 1;
	reader->take_item = reader->complete ? refuse_more : take_binary;
	if (!reader->complete)
		reader->item_size = present(ply)->is_list && !ply->in_list ? present(ply)->count_type.size
									   : present(ply)->type.size;
}

static eskel_status take_binary(esk_solid_reader *reader, const uint8_t *item, eskel_error *error)
{
	const esk_ply_property *property = present(&reader->ply);
	const esk_ply_type type = property->is_list && !reader->ply.in_list ? property->count_type : property->type;
	const bool big_endian = reader->ply.encoding == ESK_PLY_BIG_ENDIAN;
	double value = type.is_float    ? esk_byte_order_float(item, type.size, big_endian)
		       : type.is_signed ? (double)esk_byte_order_signed(item, type.size, big_endian)
					: (double)esk_byte_order_unsigned(item, type.size, big_endian);
	eskel_status status = take_value(reader, value, error);
	await(reader);
	return status;
}

static eskel_status take_row(esk_solid_reader *reader, char *line, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	for (char *word; status == ESKEL_OK && (word = esk_solid_word(&line)); await(reader)) {
		double value;
		if (reader->complete)
			return refuse_more(reader, NULL, error);
		if (!esk_solid_number(reader, word, &value))
			return esk_error_set(error, ESKEL_MALFORMED, "line %llu has \"%.60s\", expected numbers",
				(unsigned long long)reader->line, word);
		status = take_value(reader, value, error);
	}
	return status;
}

/* ---------------------------------------------------------------------------------------------- header */

static eskel_status take_format(esk_solid_reader *r, char *rest, eskel_error *error)
{
	static const char *const names[] = {
		[ESK_PLY_ASCII] = "ascii",
		[ESK_PLY_LITTLE_ENDIAN] = "binary_little_endian",
		[ESK_PLY_BIG_ENDIAN] = "binary_big_endian",
	};
	const char *name = esk_solid_word(&rest), *version = esk_solid_word(&rest);
	for (unsigned i = ESK_PLY_ASCII; name && i <= ESK_PLY_BIG_ENDIAN; i++)
		if (strcmp(name, names[i]) == 0 && version && strcmp(version, "1.0") == 0) {
			r->ply.encoding = i;
			return ESKEL_OK;
		}
	return esk_solid_refuse_line(
		r, "format", "ascii, binary_little_endian or binary_big_endian, and 1.0 after it", error);
}

static eskel_status take_element(esk_solid_reader *r, char *rest, eskel_error *error)
{
	esk_solid_ply *ply = &r->ply;
	const char *name = esk_solid_word(&rest);
	double count;
	if (!name || !esk_solid_number(r, esk_solid_word(&rest), &count) || !(count >= 0 && count <= UINT32_MAX) ||
		count != rint(count))
		return esk_solid_refuse_line(r, "element", "a name and a number of rows after it", error);
	if (ply->element_count == esk_ply_most_elements)
		return esk_solid_refuse_line(r, "element", "at most 16 of them", error);
	ply->elements[ply->element_count++] = (esk_ply_element){
		.is_vertex = strcmp(name, "vertex") == 0,
		.is_face = strcmp(name, "face") == 0,
		.count = (uint64_t)count,
	};
	return ESKEL_OK;
}

static esk_ply_role role_of(const esk_ply_element *element, bool is_list, const char *name)
{
	static const char *const coordinates[] = {"x", "y", "z"};
	for (unsigned r = 0; r < 3 && element->is_vertex && !is_list; r++)
		if (strcmp(name, coordinates[r]) == 0)
			return ESK_PLY_X + r;
	bool corners = strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0;
	return element->is_face && is_list && corners ? ESK_PLY_CORNERS : ESK_PLY_OTHER;
}

static eskel_status take_property(esk_solid_reader *r, char *rest, eskel_error *error)
{
	esk_solid_ply *ply = &r->ply;
	esk_ply_property property = {0};
	char *type = esk_solid_word(&rest);
	property.is_list = type && strcmp(type, "list") == 0;
	bool known = !property.is_list || find_type(esk_solid_word(&rest), &property.count_type);
	known = known && find_type(property.is_list ? esk_solid_word(&rest) : type, &property.type);
	const char *name = esk_solid_word(&rest);
	if (!known || !name)
		return esk_solid_refuse_line(r, "property", "[list TYPE] TYPE NAME after it", error);
	if (ply->element_count == 0)
		return esk_solid_refuse_line(r, "property", "an element before", error);
	esk_ply_element *element = &ply->elements[ply->element_count - 1];
	if (element->property_count == esk_ply_most_properties)
		return esk_solid_refuse_line(r, "property", "at most 64 of them in an element", error);
	property.role = role_of(element, property.is_list, name);
	element->properties[element->property_count++] = property;
	return ESKEL_OK;
}

/* Counts an element's properties of a role, or its lists. */
static unsigned count_role(const esk_ply_element *element, esk_ply_role role, bool is_list)
{
	unsigned count = 0;
	for (unsigned p = 0; p < element->property_count; p++)
		count += element->properties[p].role == role && element->properties[p].is_list == is_list;
	return count;
}

static eskel_status end_header(esk_solid_reader *r, eskel_error *error)
{
	esk_solid_ply *ply = &r->ply;
	unsigned vertices = 0, faces = 0;
	if (ply->encoding == ESK_PLY_UNKNOWN)
		return esk_solid_refuse_line(r, "end_header", "a format before it", error);
	for (unsigned e = 0; e < ply->element_count; e++) {
		const esk_ply_element *element = &ply->elements[e];
		vertices += element->is_vertex;
		faces += element->is_face;
		if (element->is_vertex &&
			(count_role(element, ESK_PLY_X, false) != 1 || count_role(element, ESK_PLY_Y, false) != 1 ||
				count_role(element, ESK_PLY_Z, false) != 1 ||
				count_role(element, ESK_PLY_OTHER, true) > 0))
			return esk_solid_refuse_line(r, "end_header", "x, y and z, and no list, in vertex", error);
		if (element->is_face && count_role(element, ESK_PLY_CORNERS, true) != 1)
			return esk_solid_refuse_line(r, "end_header", "one list vertex_indices in face", error);
	}
	if (vertices != 1 || faces != 1)
		return esk_solid_refuse_line(
			r, "end_header", "one element vertex and one element face before it", error);
	r->take_line = take_row;
	await(r);
	return ESKEL_OK;
}

/* A line of the header; the rows have a function of their own. */
eskel_status esk_ply_take_line(esk_solid_reader *reader, char *line, eskel_error *error)
{
	static const char *const ignored[] = {"ply", "obj_info"};
	char *rest = line, *word = esk_solid_word(&rest);
	if (!word)
		return ESKEL_OK;
	if (strcmp(word, "format") == 0)
		return take_format(reader, rest, error);
	if (strcmp(word, "element") == 0)
		return take_element(reader, rest, error);
	if (strcmp(word, "property") == 0)
		return take_property(reader, rest, error);
	if (strcmp(word, "end_header") == 0)
		return end_header(reader, error);
	if (strcmp(word, "comment") == 0)
		esk_solid_note_space(reader, rest);
	else if (strcmp(word, ignored[0]) != 0 && strcmp(word, ignored[1]) != 0)
		return esk_solid_refuse_line(reader, word, "a line of a PLY header", error);
	return ESKEL_OK;
}
