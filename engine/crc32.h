/* The checksum of gzip. */
#ifndef ESK_CRC32_H
#define ESK_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* The CRC-32 of some bytes followed by size more, given that of the former (0 for none). As zlib's crc32, whose time is
 * half of what inflating a label map takes. */
uint32_t esk_crc32(uint32_t crc, const uint8_t *bytes, size_t size);

#endif
