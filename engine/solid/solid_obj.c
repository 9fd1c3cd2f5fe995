/* Wavefront OBJ: "v x y z", and "f a b c ..." of vertices counted from 1, or from the last one backwards by negative
 * numbers; "a/b/c" names texture and normal as well. Polygons are fanned about their first corner. All else (normals, groups,
 * materials) says nothing of the solid. No file that it names is opened.
 */
#include "error.h"
#include "solid_format.h"

#include <math.h>
#include <string.h>

/* The first word outside comments, by which an OBJ is known. */
static bool is_keyword(const char *word)
{
	static const char *const keywords[] = {"v", "vt", "vn", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl"};
	for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
		if (strcmp(word, keywords[i]) == 0)
			return true;
	return false;
}

static bool read_corner(const esk_solid_reader *r, char *word, uint32_t *vertex)
{
	double number;
	word[strcspn(word, "/")] = 0;
	if (!esk_solid_number(r, word, &number) || number != rint(number) || number == 0 || fabs(number) > UINT32_MAX)
		return false;
	if (number < 0)
		number += (double)r->solid.vertex_count + 1;
	if (number < 1)
		return false;
	*vertex = (uint32_t)(number - 1);
	return true;
}

static eskel_status take_face(esk_solid_reader *r, char *rest, eskel_error *error)
{
	uint32_t corners[3];
	eskel_status status = ESKEL_OK;
	unsigned count = 0;
	for (char *word; status == ESKEL_OK && (word = esk_solid_word(&rest)); count++) {
		unsigned place = count < 2 ? count : 2;
		if (!read_corner(r, word, &corners[place]))
			return esk_solid_refuse_line(
				r, "f", "vertices, counted from 1 or backwards from -1, after it", error);
		if (place < 2)
			continue;
		status = esk_solid_add_triangle(&r->solid, corners, error);
		corners[1] = corners[2];
	}
	if (status == ESKEL_OK && count < 3)
		return esk_solid_refuse_line(r, "f", "three vertices or more after it", error);
	return status;
}

eskel_status esk_obj_take_line(esk_solid_reader *reader, char *line, eskel_error *error)
{
	double at[3];
	char *comment = strchr(line, '#');
	if (comment) {
		esk_solid_note_space(reader, comment);
		*comment = 0;
	}
	char *rest = line, *word = esk_solid_word(&rest);
	if (!word)
		return ESKEL_OK;
	if (!reader->format && !is_keyword(word))
		return ESKEL_NOT_VOLUME;
	reader->format = "OBJ";
	reader->complete = true;
	if (strcmp(word, "f") == 0)
		return take_face(reader, rest, error);
	if (strcmp(word, "v") != 0)
		return ESKEL_OK;
	if (!esk_solid_coordinates(reader, &rest, at))
		return esk_solid_refuse_line(reader, "v", "three numbers after it", error);
	return esk_solid_add_vertex(&reader->solid, at, error);
}
