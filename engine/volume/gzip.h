/* A gzip stream inflated as it arrives. */
#ifndef ESK_GZIP_H
#define ESK_GZIP_H

#include "eskel.h"

typedef struct esk_gzip esk_gzip;

/* The first byte of every gzip stream; the formats of volumes begin with other bytes. */
#define ESK_GZIP_FIRST_BYTE 0x1f

eskel_status esk_gzip_new(esk_gzip **gzip);
void esk_gzip_free(esk_gzip *gzip);

/* Inflates some of the *in_size bytes at *in, which it moves past what it took, into out; *out_used receives how many
 * bytes it wrote, also on failure. All is inflated once *in_size is 0 and *out_used < out_size. */
eskel_status esk_gzip_inflate(esk_gzip *gzip, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error);

/* Whether the last member is complete and its checksum was right. */
bool esk_gzip_is_complete(const esk_gzip *gzip);

#endif
