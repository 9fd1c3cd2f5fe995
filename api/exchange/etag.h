/* Lists of entity tags, as If-Match and If-None-Match have them. */
#ifndef ESK_ETAG_H
#define ESK_ETAG_H

#include <stdbool.h>

/* Whether a list of entity tags (RFC 9110, 8.8.3) has this one, or is "*". A weak tag equals ours only where weak
 * comparison will do. */
bool esk_etag_is_listed(const char *list, const char *etag, bool weak_will_do);

#endif
