/* Numbers in byte strings, one byte at a time: no casts to structs, no alignment, no host order. */
#ifndef ESK_BYTES_H
#define ESK_BYTES_H

#include <stdint.h>
#include <string.h>

static inline uint16_t esk_bytes_get_u16(const uint8_t *b)
{
	return (uint16_t)(b[0] | (unsigned)b[1] << 8);
}

static inline uint32_t esk_bytes_get_u32(const uint8_t *b)
{
	return (uint32_t)esk_bytes_get_u16(b) | (uint32_t)esk_bytes_get_u16(b + 2) << 16;
}

static inline uint64_t esk_bytes_get_u64(const uint8_t *b)
{
	return (uint64_t)esk_bytes_get_u32(b) | (uint64_t)esk_bytes_get_u32(b + 4) << 32;
}

static inline double esk_bytes_get_f64(const uint8_t *b)
{
	uint64_t bits = esk_bytes_get_u64(b);
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline float esk_bytes_get_f32(const uint8_t *b)
{
	uint32_t bits = esk_bytes_get_u32(b);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline void esk_bytes_put_u16(uint8_t *b, uint16_t v)
{
	b[0] = (uint8_t)v;
	b[1] = (uint8_t)(v >> 8);
}

static inline void esk_bytes_put_u32(uint8_t *b, uint32_t v)
{
	esk_bytes_put_u16(b, (uint16_t)v);
	esk_bytes_put_u16(b + 2, (uint16_t)(v >> 16));
}

static inline void esk_bytes_put_u64(uint8_t *b, uint64_t v)
{
	esk_bytes_put_u32(b, (uint32_t)v);
	esk_bytes_put_u32(b + 4, (uint32_t)(v >> 32));
}

static inline void esk_bytes_put_f64(uint8_t *b, double v)
{
	uint64_t bits;
	memcpy(&bits, &v, sizeof bits);
	esk_bytes_put_u64(b, bits);
}

static inline void esk_bytes_put_f32(uint8_t *b, float v)
{
	uint32_t bits;
	memcpy(&bits, &v, sizeof bits);
	esk_bytes_put_u32(b, bits);
}

#endif
