/* Closed meshes by formula, and the files that hold them. */
#ifndef MESH_FILE_H
#define MESH_FILE_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
	size_t vertex_count, face_count;
	double (*vertices)[3];
	unsigned (*faces)[4]; /* quadrilaterals, counterclockwise from outside; the last two are equal in a triangle */
} mesh_file;

/* All of these exit when memory runs out. */

/* Of 6 quadrilaterals. */
mesh_file mesh_box(const double least[3], const double greatest[3]);
/* About the origin, of steps by 2 steps quadrilaterals. */
mesh_file mesh_sphere(double radius, unsigned steps);
mesh_file mesh_torus(double ring, double tube, unsigned steps);
/* Four corners: positively oriented, whatever their order. */
mesh_file mesh_tetrahedron(double corners[4][3]);

/* Both together, which are freed. */
mesh_file mesh_join(mesh_file a, mesh_file b);
/* x = M x + t. */
void mesh_move(mesh_file *mesh, const double map[3][4]);
void mesh_free(mesh_file *mesh);

typedef enum {
	MESH_STL_BINARY,
	MESH_STL_ASCII,
	MESH_PLY_ASCII,
	MESH_PLY_LITTLE_ENDIAN,
	MESH_PLY_BIG_ENDIAN,
	MESH_OBJ,
	MESH_FORMAT_COUNT
} mesh_format;

/* comment: at most 79 characters. free() the bytes. */
uint8_t *mesh_write(const mesh_file *mesh, mesh_format format, const char *comment, size_t *size);

#endif
