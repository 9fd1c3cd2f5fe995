/* PLY, binary little endian: vertices with normals, triangles as lists of three. */
#include "mesh_write.h"

static void put_header(esk_mesh_writer *w, const eskel_mesh *mesh)
{
	esk_mesh_put_text(w,
		"ply\nformat binary_little_endian 1.0\ncomment eskel; UNIT=mm\ncomment SPACE=%s\n"
		"element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
		"property float nx\nproperty float ny\nproperty float nz\n"
		"element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
		esk_mesh_frame_name(w->frame), mesh->vertex_count, mesh->triangle_count);
}

void esk_mesh_write_ply(esk_mesh_writer *w, const eskel_mesh *mesh)
{
	put_header(w, mesh);
	for (size_t v = 0; v < mesh->vertex_count && !w->stopped; v++) {
		esk_mesh_put_vector(w, mesh->vertices[v]);
		esk_mesh_put_vector(w, mesh->normals[v]);
	}
	for (size_t t = 0; t < mesh->triangle_count && !w->stopped; t++) {
		esk_mesh_put(w, "\3", 1);
		for (int c = 0; c < 3; c++)
			esk_mesh_put_u32(w, mesh->triangles[t][c]);
	}
}
