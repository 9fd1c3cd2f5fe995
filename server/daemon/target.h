/* The request target: "/shapes?label=1&name=left%20talus" split and percent-decoded.
 *
 * It is read from the raw bytes of the request line, since libmicrohttpd's decoded path ends at a %00. Refused, each
 * with a sentence: what does not start with '/', control characters raw or escaped, incomplete escapes, text that is
 * not UTF-8, more than ESK_MOST_QUERY query fields.
 */
#ifndef ESK_TARGET_H
#define ESK_TARGET_H

#include "eskel_api.h"

#define ESK_MOST_QUERY 4096 /* 1,024 labels with a name, a class and a side each fit */

typedef struct {
	char *text; /* what the members point into */
	const char *path;
	eskel_field *query;
	size_t query_count;
} esk_target;

/* NULL, or why it is refused (static text), the target then untouched. */
const char *esk_target_parse(const char *raw, esk_target *target);
void esk_target_clear(esk_target *target);

#endif
