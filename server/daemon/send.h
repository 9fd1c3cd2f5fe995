/* An eskel_response as libmicrohttpd's, with the header fields that every response carries. */
#ifndef ESK_SEND_H
#define ESK_SEND_H

#include "eskel_api.h"

#include <microhttpd.h>

/* Queues it. The body is not copied: it must live until the request is over. Of a streamed one read(context) gives the
 * bytes. MHD_NO, which closes the connection, when memory ran out. */
enum MHD_Result esk_send(struct MHD_Connection *connection, const eskel_response *response, bool close,
	MHD_ContentReaderCallback read, void *context);

#endif
