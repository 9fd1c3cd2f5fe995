/* What is to be posted: files, each with what is said of it. */
#ifndef ESK_POSTINGS_H
#define ESK_POSTINGS_H

#include "complain.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
	char *file;
	char *query;                 /* "&label=1&label.1.name=talus", "" for none */
	uint64_t bytes;              /* of the file; 0 when it cannot be read */
	size_t first_row, row_count; /* of the manifest that told it */
} esk_posting;

typedef struct {
	esk_posting *items;
	size_t count;
} esk_postings;

/* Takes file and query, also on failure, and NULL, with a complaint, for either. The posting is the last until the next
 * one is added. */
esk_outcome esk_postings_add(esk_postings *postings, char *file, char *query);
void esk_postings_clear(esk_postings *postings);

#endif
