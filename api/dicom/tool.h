/* Another program, as a filter: a file in, a pipe out, confined (confine.h) and within a minute. */
#ifndef ESK_TOOL_H
#define ESK_TOOL_H

#include "window.h"

#include <sys/types.h>
#include <time.h>

typedef struct {
	const char *program;
	pid_t process; /* 0: none */
	int ending;    /* that tells the process's end */
	int output;    /* the pipe */
	struct timespec deadline;
} esk_tool;

/* Starts program with arguments (arguments[0] is its name) and the file at its first byte as its input.
 * ESKEL_UNSUPPORTED when it is not installed. */
eskel_status esk_tool_start(
	const char *program, const char *const *arguments, int file, esk_tool *tool, eskel_error *error);

/* What it writes, as the source of a window. At the end the program has ended too, and well: else ESKEL_MALFORMED, or
 * ESKEL_TOO_LARGE when it took too long. */
esk_window_source esk_tool_read;

/* Ends it if it still runs. */
void esk_tool_end(esk_tool *tool);

#endif
