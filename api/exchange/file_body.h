/* A body that is sent from a file. */
#ifndef ESK_FILE_BODY_H
#define ESK_FILE_BODY_H

#include "exchange.h"

/* Answers with so many bytes of the file from first on. Takes the descriptor in any case, copies the type. */
bool esk_exchange_answer_file(
	eskel_exchange *exchange, int status, const char *content_type, int descriptor, uint64_t first, uint64_t size);

#endif
