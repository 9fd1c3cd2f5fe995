/* Numbers of a file that may have been written in either byte order. */
#ifndef ESK_BYTE_ORDER_H
#define ESK_BYTE_ORDER_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* The unsigned number in 1 to 8 bytes. */
static inline uint64_t esk_byte_order_unsigned(const uint8_t *b, unsigned size, bool big_endian)
{
	uint64_t value = 0;
	for (unsigned i = 0; i < size; i++)
		value = value << 8 | b[big_endian ? i : size - 1 - i];
	return value;
}

/* The two's complement number in 1 to 8 bytes. */
static inline int64_t esk_byte_order_signed(const uint8_t *b, unsigned size, bool big_endian)
{
	/* Flipping the sign bit and subtracting it again extends it to 64 bits. */
	uint64_t sign = (uint64_t)1 << (8 * size - 1);
	return (int64_t)((esk_byte_order_unsigned(b, size, big_endian) ^ sign) - sign);
}

/* The IEEE 754 number in 4 or 8 bytes. */
static inline double esk_byte_order_float(const uint8_t *b, unsigned size, bool big_endian)
{
	uint64_t bits = esk_byte_order_unsigned(b, size, big_endian);
	if (size == sizeof(float)) {
		uint32_t bits32 = (uint32_t)bits;
		float value;
		memcpy(&value, &bits32, sizeof value);
		return value;
	}
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

#endif
