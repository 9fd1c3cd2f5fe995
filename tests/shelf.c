#include "shelf.h"

#include <stdio.h>
#include <stdlib.h>

static void require(eskel_status status)
{
	if (status == ESKEL_OK)
		return;
	fprintf(stderr, "shelf: %s\n", eskel_status_text(status));
	exit(1);
}

void shelf_init(shelf *s, uint32_t room)
{
	*s = (shelf){.count = 0};
	require(esk_columns_init(&s->columns, room, &s->arena));
}

void shelf_put(shelf *s, eskel_signature *signature)
{
	require(esk_shape_new(signature, &s->shapes[s->count]));
	esk_shape_codes codes;
	esk_columns_encode(s->shapes[s->count], &codes);
	esk_columns_put(&s->columns, s->count, &codes);
	s->count++;
	eskel_signature_free(signature);
}

void shelf_clear(shelf *s)
{
	for (uint32_t n = 0; n < s->count; n++)
		esk_shape_release(s->shapes[n]);
	esk_columns_clear(&s->columns);
	esk_arena_clear(&s->arena);
}
