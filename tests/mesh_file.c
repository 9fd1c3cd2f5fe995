#include "mesh_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static mesh_file new_mesh(size_t vertex_count, size_t face_count)
{
	mesh_file mesh = {vertex_count, face_count, calloc(vertex_count, sizeof(double[3])),
		calloc(face_count, sizeof(unsigned[4]))};
	if (!mesh.vertices || !mesh.faces)
		exit(1);
	return mesh;
}

void mesh_free(mesh_file *mesh)
{
	free(mesh->vertices);
	free(mesh->faces);
	*mesh = (mesh_file){0};
}

mesh_file mesh_box(const double least[3], const double greatest[3])
{
	/* Bit r of a vertex's number says on which end of axis r it lies. */
	static const unsigned faces[6][4] = {
		{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
	mesh_file mesh = new_mesh(8, 6);
	for (unsigned i = 0; i < 8; i++)
		for (unsigned r = 0; r < 3; r++)
			mesh.vertices[i][r] = i >> r & 1 ? greatest[r] : least[r];
	memcpy(mesh.faces, faces, sizeof faces);
	return mesh;
}

/* Quadrilaterals between rows of columns vertices each, closed along the row, and, if asked, from the last row to the first. */
static mesh_file new_grid(unsigned rows, unsigned columns, unsigned closed)
{
	mesh_file mesh = new_mesh((size_t)rows * columns, (size_t)(rows - !closed) * columns);
	for (unsigned i = 0; i < rows - !closed; i++)
		for (unsigned j = 0; j < columns; j++) {
			unsigned next = (i + 1) % rows, right = (j + 1) % columns;
			unsigned face[4] = {
				i * columns + j, i * columns + right, next * columns + right, next * columns + j};
			memcpy(mesh.faces[i * columns + j], face, sizeof face);
		}
	return mesh;
}

/* From the south pole to the north: all vertices of the first and last row are at the pole. */
mesh_file mesh_sphere(double radius, unsigned steps)
{
	unsigned columns = 2 * steps;
	mesh_file mesh = new_grid(steps + 1, columns, 0);
	for (unsigned i = 0; i <= steps; i++)
		for (unsigned j = 0; j < columns; j++) {
			double latitude = pi * (i / (double)steps - 0.5), longitude = 2 * pi * j / columns;
			double across = i == 0 || i == steps ? 0 : radius * cos(latitude);
			double at[3] = {across * cos(longitude), across * sin(longitude), radius * sin(latitude)};
			memcpy(mesh.vertices[i * columns + j], at, sizeof at);
		}
	return mesh;
}

mesh_file mesh_torus(double ring, double tube, unsigned steps)
{
	unsigned columns = 2 * steps;
	mesh_file mesh = new_grid(steps, columns, 1);
	for (unsigned i = 0; i < steps; i++)
		for (unsigned j = 0; j < columns; j++) {
			double around = 2 * pi * i / steps, longitude = 2 * pi * j / columns;
			double across = ring + tube * cos(around);
			double at[3] = {across * cos(longitude), across * sin(longitude), tube * sin(around)};
			memcpy(mesh.vertices[i * columns + j], at, sizeof at);
		}
	return mesh;
}

mesh_file mesh_tetrahedron(double corners[4][3])
{
	static const unsigned faces[2][4][4] = {{{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 3, 2, 2}},
		{{0, 1, 2, 2}, {0, 3, 1, 1}, {1, 3, 2, 2}, {0, 2, 3, 3}}};
	mesh_file mesh = new_mesh(4, 4);
	double e[3][3];
	memcpy(mesh.vertices, corners, 4 * sizeof *mesh.vertices);
	for (int i = 0; i < 3; i++)
		for (int r = 0; r < 3; r++)
			e[i][r] = corners[i + 1][r] - corners[0][r];
	double volume = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
			e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
			e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
	memcpy(mesh.faces, faces[volume < 0], sizeof faces[0]);
	return mesh;
}

mesh_file mesh_join(mesh_file a, mesh_file b)
{
	mesh_file mesh = new_mesh(a.vertex_count + b.vertex_count, a.face_count + b.face_count);
	memcpy(mesh.vertices, a.vertices, a.vertex_count * sizeof *a.vertices);
	memcpy(mesh.vertices + a.vertex_count, b.vertices, b.vertex_count * sizeof *b.vertices);
	memcpy(mesh.faces, a.faces, a.face_count * sizeof *a.faces);
	for (size_t f = 0; f < b.face_count; f++)
		for (int c = 0; c < 4; c++)
			mesh.faces[a.face_count + f][c] = b.faces[f][c] + (unsigned)a.vertex_count;
	mesh_free(&a);
	mesh_free(&b);
	return mesh;
}

void mesh_move(mesh_file *mesh, const double map[3][4])
{
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		double *v = mesh->vertices[i], moved[3];
		for (int r = 0; r < 3; r++)
			moved[r] = map[r][0] * v[0] + map[r][1] * v[1] + map[r][2] * v[2] + map[r][3];
		memcpy(v, moved, sizeof moved);
	}
}

/* ---------------------------------------------------------------------------------------------- files */

static void put(FILE *out, uint64_t bits, unsigned size, int big_endian)
{
	for (unsigned i = 0; i < size; i++)
		fputc((int)(bits >> 8 * (big_endian ? size - 1 - i : i) & 0xff), out);
}

static void put_float(FILE *out, double value, int big_endian)
{
	float number = (float)value;
	uint32_t bits;
	memcpy(&bits, &number, sizeof bits);
	put(out, bits, 4, big_endian);
}

static void write_stl_binary(FILE *out, const mesh_file *mesh, const char *comment)
{
	char header[81];
	snprintf(header, sizeof header, "%-80s", comment);
	fwrite(header, 1, 80, out);
	put(out, 2 * mesh->face_count, 4, 0);
	for (size_t t = 0; t < 2 * mesh->face_count; t++) {
		for (int i = 0; i < 3; i++)
			put_float(out, 0, 0);
		for (size_t c = 0; c < 3; c++)
			for (int r = 0; r < 3; r++)
				put_float(out, mesh->vertices[mesh->faces[t / 2][c ? c + t % 2 : 0]][r], 0);
		put(out, 0, 2, 0);
	}
}

static void write_stl_ascii(FILE *out, const mesh_file *mesh, const char *comment)
{
	fprintf(out, "solid %s\n", comment);
	for (size_t t = 0; t < 2 * mesh->face_count; t++) {
		fprintf(out, "  facet normal 0 0 0\r\n    outer loop\r\n");
		for (size_t c = 0; c < 3; c++) {
			const double *v = mesh->vertices[mesh->faces[t / 2][c ? c + t % 2 : 0]];
			fprintf(out, "      vertex %.9e %.9e %.9e\r\n", v[0], v[1], v[2]);
		}
		fprintf(out, "    endloop\r\n  endfacet\r\n");
	}
	fprintf(out, "endsolid\n");
}

static void write_ply_header(FILE *out, const mesh_file *mesh, const char *encoding, const char *comment)
{
	fprintf(out,
		"ply\nformat %s 1.0\ncomment %s\nelement vertex %zu\nproperty uchar red\nproperty float x\n"
		"property float y\nproperty float z\nelement edge 1\nproperty list uchar short ends\nelement face %zu\n"
		"property list uchar int vertex_indices\nproperty double area\nend_header\n",
		encoding, comment, mesh->vertex_count, mesh->face_count);
}

static void write_ply_ascii(FILE *out, const mesh_file *mesh, const char *comment)
{
	write_ply_header(out, mesh, "ascii", comment);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		fprintf(out, "255 %.9g %.9g %.9g\n", mesh->vertices[i][0], mesh->vertices[i][1], mesh->vertices[i][2]);
	fprintf(out, "2 0 -1\n");
	for (size_t f = 0; f < mesh->face_count; f++) {
		const unsigned *face = mesh->faces[f];
		fprintf(out, "4 %u %u %u %u 0.5\n", face[0], face[1], face[2], face[3]);
	}
}

static void write_ply_binary(FILE *out, const mesh_file *mesh, const char *comment, int big_endian)
{
	write_ply_header(out, mesh, big_endian ? "binary_big_endian" : "binary_little_endian", comment);
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		put(out, 255, 1, big_endian);
		for (int r = 0; r < 3; r++)
			put_float(out, mesh->vertices[i][r], big_endian);
	}
	put(out, 1, 1, big_endian);
	put(out, 0xffff, 2, big_endian);
	for (size_t f = 0; f < mesh->face_count; f++) {
		put(out, 4, 1, big_endian);
		for (int c = 0; c < 4; c++)
			put(out, mesh->faces[f][c], 4, big_endian);
		put(out, 0x3fe0000000000000, 8, big_endian);
	}
}

/* Every other face counts its vertices backwards. */
static void write_obj(FILE *out, const mesh_file *mesh, const char *comment)
{
	fprintf(out, "# %s\nmtllib none.mtl\no solid\n", comment);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		fprintf(out, "v %.9g %.9g %.9g # %zu\n", mesh->vertices[i][0], mesh->vertices[i][1],
			mesh->vertices[i][2], i + 1);
	fprintf(out, "vn 0 0 1\n");
	for (size_t f = 0; f < mesh->face_count; f++) {
		fprintf(out, "f");
		for (int c = 0; c < 4; c++)
			if (f % 2 == 0)
				fprintf(out, " %u//1", mesh->faces[f][c] + 1);
			else
				fprintf(out, " -%zu", mesh->vertex_count - mesh->faces[f][c]);
		fprintf(out, "\n");
	}
}

uint8_t *mesh_write(const mesh_file *mesh, mesh_format format, const char *comment, size_t *size)
{
	char *bytes = NULL;
	FILE *out = open_memstream(&bytes, size);
	if (!out)
		exit(1);
	switch (format) {
	case MESH_STL_BINARY:
		write_stl_binary(out, mesh, comment);
		break;
	case MESH_STL_ASCII:
		write_stl_ascii(out, mesh, comment);
		break;
	case MESH_PLY_ASCII:
		write_ply_ascii(out, mesh, comment);
		break;
	case MESH_PLY_LITTLE_ENDIAN:
	case MESH_PLY_BIG_ENDIAN:
		write_ply_binary(out, mesh, comment, format == MESH_PLY_BIG_ENDIAN);
		break;
	default:
		write_obj(out, mesh, comment);
	}
	if (fclose(out) != 0)
		exit(1);
	return (uint8_t *)bytes;
}
