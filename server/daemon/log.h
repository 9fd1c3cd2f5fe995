/* The log: one line an event on standard error, in logfmt.
 *
 *     time=2026-01-31T12:34:56.789Z event=request method=GET route=/shapes/{id} status=200 bytes=812 ms=1.9
 *
 * A line is built on the caller's stack and leaves in one write, so that lines of different threads never mix. Values
 * are quoted where they need it and control characters escaped, so that no value can forge a line. Callers log no
 * names, file contents or query values: they may be a patient's.
 */
#ifndef ESK_LOG_H
#define ESK_LOG_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
	size_t size;
	char text[1024];
} esk_log_line;

void esk_log_begin(esk_log_line *line, const char *event);
/* Nothing for a NULL or empty value. Keys are plain words. A value that does not fit is cut. */
void esk_log_text(esk_log_line *line, const char *key, const char *value);
void esk_log_number(esk_log_line *line, const char *key, uint64_t value);
void esk_log_milliseconds(esk_log_line *line, const char *key, double value);
void esk_log_end(esk_log_line *line);

/* An event with one sentence. */
void esk_log_message(const char *event, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
