/* UTF-8 text: what may be stored, and strings that grow. */
#ifndef ESK_TEXT_H
#define ESK_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Valid UTF-8 without control characters (C0, DEL, C1). */
bool esk_text_is_plain(const char *text);

/* Puts '?' for each byte that would make the text not plain: for echoing what somebody sent. */
void esk_text_clean(char *text);

/* A string that grows. All-zero is empty; after a failed append it stays failed. free() bytes. */
typedef struct {
	char *bytes;
	size_t size, capacity;
	bool failed;
} esk_text;

void esk_text_append(esk_text *text, const char *bytes, size_t size);
void esk_text_print(esk_text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Percent-encodes all but the unreserved characters of RFC 3986. */
void esk_text_append_escaped(esk_text *text, const char *value);

#endif
