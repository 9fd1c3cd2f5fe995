/* Binary STL: 80 bytes of header, the number of triangles, and 50 bytes for each: its normal, its corners, and 0.
 *
 * The format has neither unit nor frame; 3D Slicer reads the frame from the header. A header must not begin with "solid",
 * by which the text form is told. */
#include "mesh_write.h"

#include <math.h>
#include <stdio.h>

enum { HEADER = 80 };

static void put_header(esk_mesh_writer *w)
{
	char header[HEADER + 1] = {0};
	snprintf(header, sizeof header, "eskel; UNIT=mm; SPACE=%s", esk_mesh_frame_name(w->frame));
	esk_mesh_put(w, header, HEADER);
}

/* 0 of a triangle without area, as the format has it. */
static void normal_of(const float a[3], const float b[3], const float c[3], float normal[3])
{
	double cross[3], square = 0;
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		cross[i] =
			((double)b[j] - a[j]) * ((double)c[k] - a[k]) - ((double)b[k] - a[k]) * ((double)c[j] - a[j]);
		square += cross[i] * cross[i];
	}
	for (int i = 0; i < 3; i++)
		normal[i] = (float)(square > 0 ? cross[i] / sqrt(square) + 0 : 0);
}

void esk_mesh_write_stl(esk_mesh_writer *w, const eskel_mesh *mesh)
{
	put_header(w);
	esk_mesh_put_u32(w, (uint32_t)mesh->triangle_count);
	for (size_t t = 0; t < mesh->triangle_count && !w->stopped; t++) {
		float vectors[4][3];
		for (int c = 0; c < 3; c++)
			esk_mesh_to_frame(w, mesh->vertices[mesh->triangles[t][c]], vectors[c + 1]);
		normal_of(vectors[1], vectors[2], vectors[3], vectors[0]);
		for (int v = 0; v < 4; v++)
			for (int a = 0; a < 3; a++)
				esk_mesh_put_f32(w, vectors[v][a]);
		esk_mesh_put(w, "\0", 2);
	}
}
