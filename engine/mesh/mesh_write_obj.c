/* Wavefront OBJ: text; vertices are numbered from 1. Nine digits tell every float from the next. */
#include "mesh_write.h"

static void put_vector(esk_mesh_writer *w, const char *name, int digits, const float vector[3])
{
	float turned[3];
	esk_mesh_to_frame(w, vector, turned);
	esk_mesh_put_text(w, "%s %.*g %.*g %.*g\n", name, digits, (double)turned[0], digits, (double)turned[1], digits,
		(double)turned[2]);
}

void esk_mesh_write_obj(esk_mesh_writer *w, const eskel_mesh *mesh)
{
	enum { EXACT = 9, OF_NORMALS = 5 };
	esk_mesh_put_text(w, "# eskel; UNIT=mm\n# SPACE=%s\n", esk_mesh_frame_name(w->frame));
	for (size_t v = 0; v < mesh->vertex_count && !w->stopped; v++)
		put_vector(w, "v", EXACT, mesh->vertices[v]);
	for (size_t v = 0; v < mesh->vertex_count && !w->stopped; v++)
		put_vector(w, "vn", OF_NORMALS, mesh->normals[v]);
	for (size_t t = 0; t < mesh->triangle_count && !w->stopped; t++) {
		const uint32_t *v = mesh->triangles[t];
		const unsigned long a = v[0] + 1ul, b = v[1] + 1ul, c = v[2] + 1ul;
		esk_mesh_put_text(w, "f %lu//%lu %lu//%lu %lu//%lu\n", a, a, b, b, c, c);
	}
}
