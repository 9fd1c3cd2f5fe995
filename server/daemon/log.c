#include "log.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static void append(esk_log_line *line, const char *text, size_t size)
{
	size_t room = sizeof line->text - 1 - line->size; /* the last byte is kept for the newline */
	if (size > room)
		size = room;
	memcpy(line->text + line->size, text, size);
	line->size += size;
}

static void append_format(esk_log_line *line, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void append_format(esk_log_line *line, const char *format, ...)
{
	char text[128];
	va_list arguments;
	va_start(arguments, format);
	int size = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	if (size > 0)
		append(line, text, (size_t)size < sizeof text ? (size_t)size : sizeof text - 1);
}

void esk_log_begin(esk_log_line *line, const char *event)
{
	struct timespec now;
	struct tm utc;
	char time[24];
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%S", &utc);
	line->size = 0;
	append_format(line, "time=%s.%03ldZ event=%s", time, now.tv_nsec / 1000000, event);
}

static bool is_control(char c)
{
	return (unsigned char)c < ' ' || c == 0x7f;
}

static bool is_plain(const char *value)
{
	for (; *value; value++)
		if (is_control(*value) || strchr(" \"=\\", *value))
			return false;
	return true;
}

static void append_quoted(esk_log_line *line, const char *value)
{
	append(line, "\"", 1);
	for (; *value; value++) {
		if (is_control(*value))
			append_format(line, "\\x%02x", (unsigned)*value);
		else if (*value == '"' || *value == '\\')
			append(line, (const char[]){'\\', *value}, 2);
		else
			append(line, value, 1);
	}
	append(line, "\"", 1);
}

void esk_log_text(esk_log_line *line, const char *key, const char *value)
{
	if (!value || !*value)
		return;
	append_format(line, " %s=", key);
	if (is_plain(value))
		append(line, value, strlen(value));
	else
		append_quoted(line, value);
}

void esk_log_number(esk_log_line *line, const char *key, uint64_t value)
{
	append_format(line, " %s=%llu", key, (unsigned long long)value);
}

void esk_log_milliseconds(esk_log_line *line, const char *key, double value)
{
	append_format(line, " %s=%.1f", key, value);
}

void esk_log_end(esk_log_line *line)
{
	line->text[line->size] = '\n';
	/* A log that cannot be written has nowhere to say so. */
	ssize_t written = write(STDERR_FILENO, line->text, line->size + 1);
	(void)written;
}

void esk_log_message(const char *event, const char *format, ...)
{
	char text[512];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	esk_log_line line;
	esk_log_begin(&line, event);
	esk_log_text(&line, "message", text);
	esk_log_end(&line);
}
