/* Ranges of bytes, see byte_range.h. */
#include "byte_range.h"

#include <stdlib.h>
#include <string.h>

/* Digits up to end, at most 18 of them, for no file has more bytes; *number is UINT64_MAX without any. */
static bool read_number(const char *text, const char *end, uint64_t *number)
{
	const size_t size = strspn(text, "0123456789");
	if (text + size != end || size > 18)
		return false;
	*number = size > 0 ? strtoull(text, NULL, 10) : UINT64_MAX;
	return true;
}

bool esk_byte_range_parse(const char *header, uint64_t total, esk_byte_range *range)
{
	static const char unit[] = "bytes=";
	uint64_t first, last;
	*range = (esk_byte_range){0, total, false};
	const char *text = header && strncmp(header, unit, strlen(unit)) == 0 ? header + strlen(unit) : "";
	const char *dash = strchr(text, '-');
	if (!dash || !read_number(text, dash, &first) || !read_number(dash + 1, dash + strlen(dash), &last) ||
		(first == UINT64_MAX && last == UINT64_MAX) || (first != UINT64_MAX && first > last))
		return true;
	if (first == UINT64_MAX) { /* the last so many */
		first = last < total ? total - last : 0;
		last = last > 0 ? UINT64_MAX : 0;
		if (last == 0)
			return false;
	}
	if (first >= total)
		return false;
	range->first = first;
	range->size = (last < total ? last + 1 : total) - first;
	range->partial = true;
	return true;
}
