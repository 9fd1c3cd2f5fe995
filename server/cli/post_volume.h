/* Posts a volume, with what a label table says of its labels.
 *
 * Such a table often has more rows than a volume has labels, but the server refuses words for a label that is not
 * there. So the volume is decoded here first, and its labels are posted one by one with their rows. One file is one
 * request, all of its labels or none, unless that grows too long: then the file is posted several times, each time for
 * the next few of its labels. To repeat such an enrollment after a failure is harmless: a shape's id is its content.
 */
#ifndef ESK_POST_VOLUME_H
#define ESK_POST_VOLUME_H

#include "label_names.h"
#include "session.h"

/* path: "/shapes" or "/recognize". table: empty for none. */
esk_outcome esk_post_volume(esk_session *session, const char *path, const char *file, const esk_label_names *table);

/* The table of --labels; empty when it was not given. */
esk_outcome esk_post_read_labels(const esk_session *session, esk_label_names *table);

#endif
