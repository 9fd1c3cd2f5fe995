#include "postings.h"

#include <stdlib.h>
#include <sys/stat.h>

static uint64_t size_of(const char *file)
{
	struct stat status;
	return stat(file, &status) ? 0 : (uint64_t)status.st_size;
}

esk_outcome esk_postings_add(esk_postings *postings, char *file, char *query)
{
	esk_posting *items = postings->items;
	/* Grows at each power of two. */
	if ((postings->count & (postings->count - 1)) == 0)
		items = reallocarray(items, postings->count > 0 ? 2 * postings->count : 1, sizeof *items);
	if (items)
		postings->items = items;
	if (!items || !file || !query) {
		free(file);
		free(query);
		return esk_complain(ESK_REFUSED, "memory ran out");
	}
	items[postings->count++] = (esk_posting){file, query, size_of(file), 0, 0};
	return ESK_DONE;
}

void esk_postings_clear(esk_postings *postings)
{
	for (size_t i = 0; i < postings->count; i++) {
		free(postings->items[i].file);
		free(postings->items[i].query);
	}
	free(postings->items);
	*postings = (esk_postings){0};
}
