/* Files of a mesh in the making: what each format's writer needs. */
#ifndef ESK_MESH_WRITE_H
#define ESK_MESH_WRITE_H

#include "eskel.h"

#include <stdbool.h>

typedef struct {
	eskel_mesh_sink sink;
	void *context;
	eskel_frame frame;
	bool stopped; /* by the sink: nothing more is written */
	size_t size;
	uint8_t bytes[8192];
} esk_mesh_writer;

void esk_mesh_put(esk_mesh_writer *writer, const void *bytes, size_t size);
void esk_mesh_put_u32(esk_mesh_writer *writer, uint32_t value);
void esk_mesh_put_f32(esk_mesh_writer *writer, float value);
/* At most 1023 characters. */
void esk_mesh_put_text(esk_mesh_writer *writer, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* "RAS" or "LPS". */
const char *esk_mesh_frame_name(eskel_frame frame);
/* A vertex or normal in the writer's frame. Both frames have the same hand, so triangles stay as they are. */
void esk_mesh_to_frame(const esk_mesh_writer *writer, const float vector[3], float out[3]);
/* The same, written in binary. */
void esk_mesh_put_vector(esk_mesh_writer *writer, const float vector[3]);

void esk_mesh_write_stl(esk_mesh_writer *writer, const eskel_mesh *mesh);
void esk_mesh_write_ply(esk_mesh_writer *writer, const eskel_mesh *mesh);
void esk_mesh_write_obj(esk_mesh_writer *writer, const eskel_mesh *mesh);
/* The one that can fail: as eskel_mesh_write. */
eskel_status esk_mesh_write_glb(esk_mesh_writer *writer, const eskel_mesh *mesh);

#endif
