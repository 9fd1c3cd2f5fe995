#include "window.h"

#include "refusal.h"

#include <string.h>

/* One get. *got is 0 at the end. */
static eskel_status fill(esk_window *window, size_t *got, eskel_error *error)
{
	if (window->begin > 0) {
		memmove(window->bytes, window->bytes + window->begin, window->end - window->begin);
		window->end -= window->begin;
		window->begin = 0;
	}
	eskel_status status =
		window->get(window->source, window->bytes + window->end, ESK_WINDOW_SIZE - window->end, got, error);
	if (status == ESKEL_OK)
		window->end += *got;
	return status;
}

eskel_status esk_window_look(esk_window *window, size_t size, const uint8_t **bytes, eskel_error *error)
{
	while (window->end - window->begin < size) {
		size_t got = 0;
		eskel_status status = fill(window, &got, error);
		if (status != ESKEL_OK)
			return status;
		if (got == 0)
			return esk_refuse(error, ESKEL_TRUNCATED, "the DICOM file breaks off");
	}
	*bytes = window->bytes + window->begin;
	return ESKEL_OK;
}

void esk_window_take(esk_window *window, size_t size)
{
	window->begin += size;
	window->taken += size;
}

eskel_status esk_window_skip(esk_window *window, uint64_t size, eskel_error *error)
{
	while (size > 0) {
		const uint8_t *bytes;
		eskel_status status = esk_window_look(window, 1, &bytes, error);
		if (status != ESKEL_OK)
			return status;
		const size_t there = window->end - window->begin, step = size < there ? (size_t)size : there;
		esk_window_take(window, step);
		size -= step;
	}
	return ESKEL_OK;
}

eskel_status esk_window_at_end(esk_window *window, bool *at_end, eskel_error *error)
{
	size_t got = 0;
	eskel_status status = window->begin < window->end ? ESKEL_OK : fill(window, &got, error);
	*at_end = window->begin == window->end;
	return status;
}
