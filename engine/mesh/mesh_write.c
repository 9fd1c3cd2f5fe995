#include "mesh_write.h"

#include "bytes.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void flush(esk_mesh_writer *w)
{
	if (w->size > 0 && !w->stopped)
		w->stopped = !w->sink(w->context, w->bytes, w->size);
	w->size = 0;
}

void esk_mesh_put(esk_mesh_writer *w, const void *bytes, size_t size)
{
	if (size > sizeof w->bytes - w->size)
		flush(w);
	memcpy(w->bytes + w->size, bytes, size);
	w->size += size;
}

void esk_mesh_put_u32(esk_mesh_writer *w, uint32_t value)
{
	uint8_t bytes[4];
	esk_bytes_put_u32(bytes, value);
	esk_mesh_put(w, bytes, sizeof bytes);
}

void esk_mesh_put_f32(esk_mesh_writer *w, float value)
{
	uint8_t bytes[4];
	esk_bytes_put_f32(bytes, value);
	esk_mesh_put(w, bytes, sizeof bytes);
}

void esk_mesh_put_text(esk_mesh_writer *w, const char *format, ...)
{
	char text[1024];
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	esk_mesh_put(w, text, (size_t)length < sizeof text ? (size_t)length : sizeof text - 1);
}

const char *esk_mesh_frame_name(eskel_frame frame)
{
	return frame == ESKEL_FRAME_LPS ? "LPS" : "RAS";
}

void esk_mesh_to_frame(const esk_mesh_writer *w, const float vector[3], float out[3])
{
	const float sign = w->frame == ESKEL_FRAME_LPS ? -1 : 1;
	/* + 0: no negative zero. */
	out[0] = sign * vector[0] + 0;
	out[1] = sign * vector[1] + 0;
	out[2] = vector[2];
}

void esk_mesh_put_vector(esk_mesh_writer *w, const float vector[3])
{
	float turned[3];
	esk_mesh_to_frame(w, vector, turned);
	for (int a = 0; a < 3; a++)
		esk_mesh_put_f32(w, turned[a]);
}

eskel_status eskel_mesh_write(
	const eskel_mesh *mesh, eskel_mesh_format format, eskel_frame frame, eskel_mesh_sink sink, void *context)
{
	esk_mesh_writer w = {.sink = sink, .context = context, .frame = frame};
	eskel_status status = ESKEL_OK;
	switch (format) {
	case ESKEL_MESH_STL:
		esk_mesh_write_stl(&w, mesh);
		break;
	case ESKEL_MESH_PLY:
		esk_mesh_write_ply(&w, mesh);
		break;
	case ESKEL_MESH_OBJ:
		esk_mesh_write_obj(&w, mesh);
		break;
	case ESKEL_MESH_GLB:
		status = esk_mesh_write_glb(&w, mesh);
		break;
	default:
		return ESKEL_INVALID;
	}
	flush(&w);
	return status == ESKEL_OK && w.stopped ? ESKEL_CANCELLED : status;
}
