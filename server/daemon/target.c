#include "target.h"

#include <stdlib.h>
#include <string.h>

static const char no_memory[] = "memory ran out";

static int hex(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

static bool is_control(int c)
{
	return (c >= 0 && c < ' ') || c == 0x7f;
}

/* The length of the well-formed UTF-8 sequence (RFC 3629) at text, 0 when there is none. */
static size_t utf8_length(const unsigned char *text)
{
	static const struct {
		unsigned char first, last, second_least, second_most;
		size_t length;
	} forms[] = {
		{0x00, 0x7f, 0, 0, 1}, {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3}, /* no overlong form */
		{0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3},                        /* no surrogate */
		{0xee, 0xef, 0x80, 0xbf, 3}, {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4},
		{0xf4, 0xf4, 0x80, 0x8f, 4}, /* nothing past U+10FFFF */
	};
	for (size_t f = 0; f < sizeof forms / sizeof *forms; f++) {
		if (text[0] < forms[f].first || text[0] > forms[f].last)
			continue;
		for (size_t i = 1; i < forms[f].length; i++) {
			unsigned char least = i == 1 ? forms[f].second_least : 0x80;
			unsigned char most = i == 1 ? forms[f].second_most : 0xbf;
			if (text[i] < least || text[i] > most)
				return 0;
		}
		return forms[f].length;
	}
	return 0;
}

static bool is_utf8(const char *text)
{
	const unsigned char *at = (const unsigned char *)text;
	while (*at) {
		size_t length = utf8_length(at);
		if (!length)
			return false;
		at += length;
	}
	return true;
}

/* Decodes in place; a '+' of the query is a space, as forms and URLSearchParams write it. */
static const char *decode(char *text, bool in_query)
{
	char *out = text;
	for (const char *in = text; *in; in++) {
		int c = *in == '+' && in_query ? ' ' : (unsigned char)*in;
		if (*in == '%') {
			int high = hex(in[1]), low = high < 0 ? -1 : hex(in[2]);
			if (low < 0)
				return "the request target has a '%' that no two hexadecimal digits follow";
			c = high * 16 + low;
			in += 2;
		}
		if (is_control(c))
			return "the request target has a control character";
		*out++ = (char)c;
	}
	*out = '\0';
	return is_utf8(text) ? NULL : "the request target is not UTF-8";
}

static size_t count_fields(const char *query)
{
	size_t count = 1;
	for (; *query; query++)
		count += *query == '&';
	return count;
}

/* Cuts query at its '&' and '=' into fields of names and values; empty pieces are left out. */
static const char *split_query(char *query, esk_target *target)
{
	size_t most = count_fields(query);
	if (most > ESK_MOST_QUERY)
		return "the query has more than 4096 fields";
	target->query = calloc(most, sizeof *target->query);
	if (!target->query)
		return no_memory;
	char *rest = query, *piece;
	while ((piece = strsep(&rest, "&"))) {
		if (!*piece)
			continue;
		char *value = strchr(piece, '=');
		if (value)
			*value++ = '\0';
		else
			value = piece + strlen(piece);
		const char *wrong = decode(piece, true);
		if (!wrong && *value)
			wrong = decode(value, true);
		if (wrong)
			return wrong;
		target->query[target->query_count++] = (eskel_field){piece, value};
	}
	return NULL;
}

const char *esk_target_parse(const char *raw, esk_target *target)
{
	if (*raw != '/')
		return "the request target does not start with '/'";
	for (const char *c = raw; *c; c++)
		if (*c == ' ' || is_control(*c))
			return "the request target has a space or a control character";
	esk_target out = {.text = strdup(raw)};
	if (!out.text)
		return no_memory;
	char *query = strchr(out.text, '?');
	if (query)
		*query++ = '\0';
	out.path = out.text;
	const char *wrong = decode(out.text, false);
	if (!wrong && query)
		wrong = split_query(query, &out);
	if (wrong) {
		esk_target_clear(&out);
		return wrong;
	}
	*target = out;
	return NULL;
}

void esk_target_clear(esk_target *target)
{
	free(target->query);
	free(target->text);
	*target = (esk_target){0};
}
