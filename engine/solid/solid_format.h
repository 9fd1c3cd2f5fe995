/* What the formats of meshes share: a file is lines, or items of a known size, that are taken one after the other. */
#ifndef ESK_SOLID_FORMAT_H
#define ESK_SOLID_FORMAT_H

#include "solid_reader.h"
#include "solid_ply.h"

#include <locale.h>

/* A line comes without its end, and may be written to. Item: item_size bytes. */
typedef eskel_status esk_solid_take_line(esk_solid_reader *reader, char *line, eskel_error *error);
typedef eskel_status esk_solid_take_item(esk_solid_reader *reader, const uint8_t *item, eskel_error *error);

struct esk_solid_reader {
	const char *format; /* NULL: not known yet */
	esk_solid solid;
	esk_solid_space space;
	bool complete;   /* the file may end here */
	locale_t locale; /* "C": numbers have a point whatever the process's locale is */

	size_t item_size; /* of the next item; 0: the next is a line */
	esk_solid_take_item *take_item;
	esk_solid_take_line *take_line;
	uint64_t line; /* number of the last line that was taken, from 1 */
	uint64_t work; /* bytes of text and items that were taken */

	uint8_t *pending; /* of the item or line that the last piece broke off */
	size_t pending_size, pending_capacity;

	uint32_t triangles_left; /* of a binary STL */
	unsigned corners;        /* of the facet that an ASCII STL is in */
	esk_solid_ply ply;
};

/* ESKEL_MALFORMED, "line 7 begins with "word", expected ...". */
eskel_status esk_solid_refuse_line(
	const esk_solid_reader *reader, const char *word, const char *expected, eskel_error *error);

/* The next word of *text, which moves past it and is written to; NULL at the end. */
char *esk_solid_word(char **text);
/* A whole word as a decimal number. */
bool esk_solid_number(const esk_solid_reader *reader, const char *word, double *number);
/* The next three words as coordinates. */
bool esk_solid_coordinates(const esk_solid_reader *reader, char **text, double at[3]);
/* Notes what a comment or header says: SPACE=RAS or SPACE=LPS, as 3D Slicer writes; the first counts. */
void esk_solid_note_space(esk_solid_reader *reader, const char *comment);

/* The size in bytes of the header that begins a binary STL: any 80 bytes, and the number of triangles. */
enum { esk_stl_header_size = 84, esk_stl_comment_size = 80 };
/* Begins a binary STL if this is its header: its number of triangles is one, but not that of any text. */
eskel_status esk_stl_begin_binary(esk_solid_reader *reader, const uint8_t *header, eskel_error *error);

/* The first line of an ASCII STL, a PLY and (for want of another) an OBJ. */
esk_solid_take_line esk_stl_take_line, esk_ply_take_line, esk_obj_take_line;

#endif
