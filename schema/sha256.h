/* SHA-256 (FIPS 180-4) and hex text, by nettle. */
#ifndef ESK_SHA256_H
#define ESK_SHA256_H

#include <stddef.h>
#include <stdint.h>

#define ESK_SHA256_BYTES 32

void esk_sha256(const void *bytes, size_t size, uint8_t digest[ESK_SHA256_BYTES]);

/* Lower case, 2 * size characters and a NUL. */
void esk_hex(const uint8_t *bytes, size_t size, char *text);

#endif
