/* Binary glTF 2.0: a header of 12 bytes, a chunk of JSON, and a chunk of vertices, normals and indices.
 *
 * The numbers are in the frame asked for and in mm, exactly as in the mesh; glTF has metres, Y up, and the front of a thing
 * to Z, so its left is to X. The node's matrix brings them there: in RAS (x, y, z) mm is (-x, z, y) / 1000, in LPS it is
 * (x, z, -y) / 1000; both are rotations, so triangles stay counterclockwise. Viewers apply it; who wants the frame of the scan
 * reads the numbers as they are, and the extras of the asset. */
#include "mesh_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum {
	MAGIC = 0x46546c67,        /* "glTF" */
	JSON_CHUNK = 0x4e4f534a,   /* "JSON" */
	BINARY_CHUNK = 0x004e4942, /* "BIN" */
	VERSION = 2,
};

static const char ras_to_gltf[] = "-0.001,0,0,0, 0,0,0.001,0, 0,0.001,0,0, 0,0,0,1"; /* by columns */
static const char lps_to_gltf[] = "0.001,0,0,0, 0,0,-0.001,0, 0,0.001,0,0, 0,0,0,1";

/* The material is matt and of the colour of bone: without one, glTF's is of metal. 5126 is float, 5125 is uint32; 34962 and
 * 34963 are vertices and indices. */
static const char json_format[] =
	"{\"asset\":{\"version\":\"2.0\",\"generator\":\"eskel\",\"extras\":{\"space\":\"%s\",\"unit\":\"mm\"}},"
	"\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"matrix\":[%s]}],"
	"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":0}]}],"
	"\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.74,0.6,1],\"metallicFactor\":0,"
	"\"roughnessFactor\":0.7}}],"
	"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\","
	"\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]},"
	"{\"bufferView\":1,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\"},"
	"{\"bufferView\":2,\"componentType\":5125,\"count\":%zu,\"type\":\"SCALAR\"}],"
	"\"bufferViews\":[{\"buffer\":0,\"byteLength\":%" PRIu64 ",\"target\":34962},"
	"{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 ",\"target\":34962},"
	"{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 ",\"target\":34963}],"
	"\"buffers\":[{\"byteLength\":%" PRIu64 "}]}";

typedef struct {
	float least[3], greatest[3];
} box;

static box box_of(const esk_mesh_writer *w, const eskel_mesh *mesh)
{
	box b;
	esk_mesh_to_frame(w, mesh->vertices[0], b.least);
	esk_mesh_to_frame(w, mesh->vertices[0], b.greatest);
	for (size_t v = 1; v < mesh->vertex_count; v++) {
		float p[3];
		esk_mesh_to_frame(w, mesh->vertices[v], p);
		for (int a = 0; a < 3; a++) {
			b.least[a] = p[a] < b.least[a] ? p[a] : b.least[a];
			b.greatest[a] = p[a] > b.greatest[a] ? p[a] : b.greatest[a];
		}
	}
	return b;
}

/* Padded with blanks to a multiple of four. */
static uint32_t make_json(const esk_mesh_writer *w, const eskel_mesh *mesh, char *json, size_t room)
{
	const box b = box_of(w, mesh);
	const uint64_t vectors = mesh->vertex_count * (uint64_t)sizeof *mesh->vertices;
	const uint64_t indices = mesh->triangle_count * (uint64_t)sizeof *mesh->triangles;
	const int length = snprintf(json, room, json_format, esk_mesh_frame_name(w->frame),
		w->frame == ESKEL_FRAME_LPS ? lps_to_gltf : ras_to_gltf, mesh->vertex_count, (double)b.least[0],
		(double)b.least[1], (double)b.least[2], (double)b.greatest[0], (double)b.greatest[1],
		(double)b.greatest[2], mesh->vertex_count, 3 * mesh->triangle_count, vectors, vectors, vectors,
		2 * vectors, indices, 2 * vectors + indices);
	const uint32_t padded = ((uint32_t)length + 3) / 4 * 4;
	memset(json + length, ' ', padded - (uint32_t)length);
	return padded;
}

static void put_vectors(esk_mesh_writer *w, const float (*vectors)[3], size_t count)
{
	for (size_t v = 0; v < count && !w->stopped; v++)
		esk_mesh_put_vector(w, vectors[v]);
}

eskel_status esk_mesh_write_glb(esk_mesh_writer *w, const eskel_mesh *mesh)
{
	if (mesh->triangle_count == 0)
		return ESKEL_EMPTY;
	char json[2048]; /* the format above and 20 numbers of up to 20 digits */
	const uint32_t json_size = make_json(w, mesh, json, sizeof json);
	const uint64_t binary_size = 2 * (uint64_t)sizeof *mesh->vertices * mesh->vertex_count +
				     (uint64_t)sizeof *mesh->triangles * mesh->triangle_count;
	const uint64_t size = 12 + 8 + json_size + 8 + binary_size;
	if (size > UINT32_MAX)
		return ESKEL_TOO_LARGE;
	const uint32_t head[5] = {MAGIC, VERSION, (uint32_t)size, json_size, JSON_CHUNK};
	for (int i = 0; i < 5; i++)
		esk_mesh_put_u32(w, head[i]);
	esk_mesh_put(w, json, json_size);
	esk_mesh_put_u32(w, (uint32_t)binary_size);
	esk_mesh_put_u32(w, BINARY_CHUNK);
	put_vectors(w, (const float(*)[3])mesh->vertices, mesh->vertex_count);
	put_vectors(w, (const float(*)[3])mesh->normals, mesh->vertex_count);
	for (size_t t = 0; t < mesh->triangle_count && !w->stopped; t++)
		for (int c = 0; c < 3; c++)
			esk_mesh_put_u32(w, mesh->triangles[t][c]);
	return ESKEL_OK;
}
