/* STL: facets of three corners each, in binary and as text.
 *
 *   binary, little endian: 80 bytes of anything, uint32 number of facets; each float32 normal[3], corners[3][3], 2 bytes
 *   text: solid NAME, { facet normal x y z, outer loop, 3 times vertex x y z, endloop, endfacet }, endsolid NAME
 *
 * Normals are not read: the order of the corners says the same, and more programs get it right.
 */
#include "bytes.h"
#include "error.h"
#include "solid_format.h"

#include <string.h>

enum { facet_size = 50, facet_corners = 12 };

static eskel_status add_facet(esk_solid *solid, double corners[3][3], eskel_error *error)
{
	uint32_t first = (uint32_t)solid->vertex_count;
	eskel_status status = esk_solid_add_triangle(solid, (uint32_t[3]){first, first + 1, first + 2}, error);
	for (int c = 0; c < 3 && status == ESKEL_OK; c++)
		status = esk_solid_add_vertex(solid, corners[c], error);
	return status;
}

static eskel_status refuse_more(esk_solid_reader *reader, const uint8_t *item, eskel_error *error)
{
	(void)reader, (void)item;
	return esk_error_set(error, ESKEL_MALFORMED, "the file goes on after its last triangle");
}

static eskel_status take_facet(esk_solid_reader *reader, const uint8_t *item, eskel_error *error)
{
	double corners[3][3];
	for (int c = 0; c < 3; c++)
		for (int r = 0; r < 3; r++)
			corners[c][r] = (double)esk_bytes_get_f32(item + facet_corners + 12 * c + 4 * r);
	if (--reader->triangles_left == 0) {
		reader->complete = true;
		reader->item_size = 1;
		reader->take_item = refuse_more;
	}
	return add_facet(&reader->solid, corners, error);
}

static void note_header(esk_solid_reader *reader, const uint8_t *header)
{
	char comment[esk_stl_comment_size + 1] = "";
	memcpy(comment, header, esk_stl_comment_size);
	for (int i = 0; i < esk_stl_comment_size; i++)
		comment[i] = comment[i] ? comment[i] : ' ';
	esk_solid_note_space(reader, comment);
}

eskel_status esk_stl_begin_binary(esk_solid_reader *reader, const uint8_t *header, eskel_error *error)
{
	uint32_t count = esk_bytes_get_u32(header + esk_stl_comment_size);
	if (count == 0 || count >> 24 >= '\t') /* four characters of a text */
		return ESKEL_NOT_VOLUME;
	reader->format = "STL";
	if (count > ESK_SOLID_MOST_TRIANGLES)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the mesh has %u triangles, expected at most %u", count,
			ESK_SOLID_MOST_TRIANGLES);
	note_header(reader, header);
	reader->triangles_left = count;
	reader->item_size = facet_size;
	reader->take_item = take_facet;
	return ESKEL_OK;
}

static eskel_status take_vertex(esk_solid_reader *r, char *rest, eskel_error *error)
{
	double at[3];
	if (r->corners == 3 || !esk_solid_coordinates(r, &rest, at))
		return esk_solid_refuse_line(r, "vertex", "three of these in a loop, with three numbers each", error);
	r->corners++;
	return esk_solid_add_vertex(&r->solid, at, error);
}

static eskel_status end_loop(esk_solid_reader *r, eskel_error *error)
{
	uint32_t end = (uint32_t)r->solid.vertex_count;
	if (r->corners != 3)
		return esk_solid_refuse_line(r, "endloop", "it after three vertices", error);
	r->corners = 0;
	return esk_solid_add_triangle(&r->solid, (uint32_t[3]){end - 3, end - 2, end - 1}, error);
}

/* A file may hold several solids. */
eskel_status esk_stl_take_line(esk_solid_reader *reader, char *line, eskel_error *error)
{
	static const char *const ignored[] = {"facet", "outer", "endfacet"};
	char *rest = line, *word = esk_solid_word(&rest);
	if (!word)
		return ESKEL_OK;
	if (strcmp(word, "vertex") == 0)
		return take_vertex(reader, rest, error);
	if (strcmp(word, "endloop") == 0)
		return end_loop(reader, error);
	for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
		if (strcmp(word, ignored[i]) == 0)
			return ESKEL_OK;
	bool begins = strcmp(word, "solid") == 0;
	if (!begins && strcmp(word, "endsolid") != 0)
		return esk_solid_refuse_line(reader, word, "a line of an ASCII STL", error);
	if (begins)
		esk_solid_note_space(reader, rest);
	reader->complete = !begins && reader->corners == 0;
	return ESKEL_OK;
}
