/* Where a PLY file is being read. */
#ifndef ESK_SOLID_PLY_H
#define ESK_SOLID_PLY_H

#include <stdbool.h>
#include <stdint.h>

enum { esk_ply_most_elements = 16, esk_ply_most_properties = 64 };

typedef enum { ESK_PLY_OTHER, ESK_PLY_X, ESK_PLY_Y, ESK_PLY_Z, ESK_PLY_CORNERS } esk_ply_role;

typedef struct {
	uint8_t size; /* bytes */
	bool is_signed, is_float;
} esk_ply_type;

typedef struct {
	esk_ply_role role;
	bool is_list;
	esk_ply_type count_type, type; /* of a list's length; of a value */
} esk_ply_property;

typedef struct {
	bool is_vertex, is_face;
	uint64_t count; /* rows */
	unsigned property_count;
	esk_ply_property properties[esk_ply_most_properties];
} esk_ply_element;

typedef struct {
	enum { ESK_PLY_UNKNOWN, ESK_PLY_ASCII, ESK_PLY_LITTLE_ENDIAN, ESK_PLY_BIG_ENDIAN } encoding;
	unsigned element_count;
	esk_ply_element elements[esk_ply_most_elements];

	/* The value that comes next. */
	unsigned element, property;
	uint64_t row;
	bool in_list;
	uint64_t list_left;

	double at[3];        /* of the vertex being read */
	unsigned corner;     /* of the face being read, to be taken next; 2 stands for all after it */
	uint32_t corners[3]; /* the first of the face, the last one taken, the next */
} esk_solid_ply;

#endif
