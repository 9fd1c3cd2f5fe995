/* Posts a volume, with what a label table says of its labels.
 *
 * One file is one request, all of its labels or none, unless the names of the table make the request longer than a
 * server takes. Then the file is posted several times, each time with the next few of its labels chosen, and all or
 * none holds for each part; to repeat such an enrollment after a failure is harmless, for a shape's id is its content.
 */
#ifndef ESK_POST_VOLUME_H
#define ESK_POST_VOLUME_H

#include "label_csv.h"
#include "session.h"

/* path: "/shapes" or "/recognize". An empty table says nothing. */
esk_outcome esk_post_volume(esk_session *session, const char *path, const char *file, const esk_label_csv *table);

/* The table of --labels; empty when it was not given. */
esk_outcome esk_post_read_labels(const esk_session *session, esk_label_csv *table);

#endif
