/* Many files posted over several connections at once.
 *
 * Whatever ends it early, the same postings can be posted again: shapes that are there already are left as they are, and
 * answered without being computed. */
#ifndef ESK_BULK_H
#define ESK_BULK_H

#include "manifest.h"
#include "session.h"

typedef enum {
	ESK_POSTING_LEFT,  /* not tried, or without an answer */
	ESK_POSTING_ADDED, /* at least one shape was added */
	ESK_POSTING_THERE, /* all were there already */
	ESK_POSTING_REFUSED
} esk_posting_state;

typedef struct {
	esk_posting_state state;
	size_t added, there; /* shapes */
	char *reason;        /* of a refusal, one sentence; NULL when memory ran out */
} esk_posting_result;

typedef struct {
	const esk_postings *postings;
	const esk_manifest *verified; /* answers must say the same as it; NULL: whatever they say */
	size_t connections;           /* 0: as --parallel says */
	esk_posting_result *results;  /* [postings->count]; free them with esk_bulk_clear */
	bool interrupted;             /* by Ctrl-C */
	char *ended_by;               /* the sentence of what made the rest hopeless; NULL for nothing */
} esk_bulk;

/* Posts them all to /shapes, in their order but for what is under way at once. Waits where the server says 429 or 503, and
 * gives a file up after five minutes of that. Ctrl-C lets what is under way finish; a second one ends the program. The
 * outcome is the worst of a file's, ESK_REFUSED also when files are left. */
esk_outcome esk_bulk_post(esk_session *session, esk_bulk *bulk);
void esk_bulk_clear(esk_bulk *bulk);

#endif
