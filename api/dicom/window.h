/* Bytes from somewhere, through a window. */
#ifndef ESK_WINDOW_H
#define ESK_WINDOW_H

#include "eskel.h"

/* Gets 1 to most bytes, or none at the end. */
typedef eskel_status esk_window_source(void *source, uint8_t *bytes, size_t most, size_t *got, eskel_error *error);

#define ESK_WINDOW_SIZE ((size_t)1 << 18)
/* Behind the bytes that are looked at there are as many more that may be loaded, of no meaning. */
#define ESK_WINDOW_SLACK 8

typedef struct {
	esk_window_source *get;
	void *source;
	uint64_t taken;
	size_t begin, end; /* of what is in the window */
	uint8_t bytes[ESK_WINDOW_SIZE + ESK_WINDOW_SLACK];
} esk_window;

/* The next size bytes, at most a window, without taking them; ESKEL_TRUNCATED when there are not so many. They stay
 * until the next look. */
eskel_status esk_window_look(esk_window *window, size_t size, const uint8_t **bytes, eskel_error *error);
/* Takes bytes that were looked at. */
void esk_window_take(esk_window *window, size_t size);
eskel_status esk_window_skip(esk_window *window, uint64_t size, eskel_error *error);
/* Whether no byte is left. */
eskel_status esk_window_at_end(esk_window *window, bool *at_end, eskel_error *error);

#endif
