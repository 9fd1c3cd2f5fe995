#include "sha256.h"

#include "eskel_store.h"

#include <nettle/base16.h>
#include <nettle/sha2.h>

void esk_sha256(const void *bytes, size_t size, uint8_t digest[ESK_SHA256_BYTES])
{
	struct sha256_ctx context;
	sha256_init(&context);
	sha256_update(&context, size, bytes);
	sha256_digest(&context, ESK_SHA256_BYTES, digest);
}

void esk_hex(const uint8_t *bytes, size_t size, char *text)
{
	base16_encode_update(text, size, bytes);
	text[2 * size] = '\0';
}

void eskel_digest(const void *bytes, size_t size, char text[ESKEL_SHA256_SIZE])
{
	uint8_t digest[ESK_SHA256_BYTES];
	esk_sha256(bytes, size, digest);
	esk_hex(digest, sizeof digest, text);
}
