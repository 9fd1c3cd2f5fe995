/* A body that is sent from a file, piece by piece, see file_body.h. */
#include "file_body.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { PIECE = 1 << 16 };

typedef struct {
	int descriptor;
	uint64_t next, end;
	char content_type[65];
	char bytes[PIECE];
} reader;

/* An esk_stream's; false when the file has become shorter, too. */
static bool read_piece(void *context, esk_text *piece)
{
	reader *r = context;
	const uint64_t left = r->end - r->next;
	const size_t wanted = left < PIECE ? (size_t)left : PIECE;
	const ssize_t size = wanted > 0 ? pread(r->descriptor, r->bytes, wanted, (off_t)r->next) : 0;
	if (size < 0 || (size == 0 && wanted > 0))
		return false;
	esk_text_append(piece, r->bytes, (size_t)size);
	r->next += (uint64_t)size;
	return true;
}

static void free_reader(void *context)
{
	reader *r = context;
	close(r->descriptor);
	free(r);
}

bool esk_exchange_answer_file(
	eskel_exchange *exchange, int status, const char *content_type, int descriptor, uint64_t first, uint64_t size)
{
	reader *r = calloc(1, sizeof *r);
	if (!r) {
		close(descriptor);
		return esk_problem_no_memory(&exchange->problem);
	}
	r->descriptor = descriptor;
	r->next = first;
	r->end = first + size;
	snprintf(r->content_type, sizeof r->content_type, "%s", content_type);
	const esk_stream stream = {.next = read_piece, .free = free_reader, .source = r};
	return esk_exchange_answer_stream(exchange, status, r->content_type, size, &stream);
}
