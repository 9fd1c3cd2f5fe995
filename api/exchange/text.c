/* UTF-8 text, see text.h. */
#include "text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The size of the plain character at text, 0 if it is none. Overlong forms, surrogates and code points past U+10FFFF
 * are not UTF-8 (RFC 3629). */
static size_t plain_size(const unsigned char *text)
{
	static const uint32_t least[] = {0, 0x20, 0xa0, 0x800, 0x10000};
	size_t size = text[0] < 0x80 ? 1 : text[0] >> 5 == 6 ? 2 : text[0] >> 4 == 14 ? 3 : text[0] >> 3 == 30 ? 4 : 0;
	if (size == 0)
		return 0;
	uint32_t point = size == 1 ? text[0] : text[0] & (0x7fu >> size);
	for (size_t i = 1; i < size; i++) {
		if (text[i] >> 6 != 2)
			return 0;
		point = point << 6 | (text[i] & 0x3f);
	}
	if (point < least[size] || point > 0x10ffff || point == 0x7f || (point >= 0xd800 && point <= 0xdfff))
		return 0;
	return size;
}

bool esk_text_is_plain(const char *text)
{
	while (*text) {
		size_t size = plain_size((const unsigned char *)text);
		if (size == 0)
			return false;
		text += size;
	}
	return true;
}

void esk_text_clean(char *text)
{
	while (*text) {
		size_t size = plain_size((const unsigned char *)text);
		if (size == 0)
			*text = '?';
		text += size ? size : 1;
	}
}

/* Room for more bytes and the terminating 0. */
static bool reserve(esk_text *text, size_t more)
{
	if (text->failed || more > SIZE_MAX / 4 - text->size)
		return !(text->failed = true);
	size_t needed = text->size + more + 1;
	if (needed <= text->capacity)
		return true;
	size_t capacity = needed + needed / 2;
	char *bytes = realloc(text->bytes, capacity);
	if (!bytes)
		return !(text->failed = true);
	text->bytes = bytes;
	text->capacity = capacity;
	return true;
}

void esk_text_append(esk_text *text, const char *bytes, size_t size)
{
	if (!reserve(text, size))
		return;
	memcpy(text->bytes + text->size, bytes, size);
	text->size += size;
	text->bytes[text->size] = 0;
}

void esk_text_print(esk_text *text, const char *format, ...)
{
	char line[512];
	va_list arguments;
	va_start(arguments, format);
	int size = vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	if (size < 0 || (size_t)size >= sizeof line)
		text->failed = true;
	else
		esk_text_append(text, line, (size_t)size);
}

void esk_text_append_escaped(esk_text *text, const char *value)
{
	static const char unreserved[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
	for (; *value; value++) {
		if (strchr(unreserved, *value))
			esk_text_append(text, value, 1);
		else
			esk_text_print(text, "%%%02X", (unsigned)(unsigned char)*value);
	}
}
