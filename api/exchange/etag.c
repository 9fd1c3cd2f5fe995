/* Lists of entity tags, see etag.h. */
#include "etag.h"

#include <string.h>

bool esk_etag_is_listed(const char *list, const char *etag, bool weak_will_do)
{
	size_t size = strlen(etag);
	if (strcmp(list, "*") == 0)
		return true;
	for (list += strspn(list, ", \t"); *list; list += strspn(list, ", \t")) {
		bool weak = strncmp(list, "W/", 2) == 0;
		list += weak ? 2 : 0;
		size_t tag_size = strcspn(list, ", \t");
		if (tag_size == size && strncmp(list, etag, size) == 0 && (!weak || weak_will_do))
			return true;
		list += tag_size;
	}
	return false;
}
