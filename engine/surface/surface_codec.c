/* Surfaces as bytes: what section 2.5 stores with a skeleton, eps, u and alpha. Numbers are little-endian, doubles their IEEE
 * 754 bits, so the round trip is exact.
 *
 *	offset  bytes  what
 *	0       1      version, 1
 *	1       1      0 blend, 1 union
 *	2       1      k, the number of classes, 1 to 64
 *	3              k classes:
 *	0       1      kind: 0 ellipsoid, 1 superquadric, 2 deformed, 3 algebraic
 *	1       128    centre x y z, axes row by row, radii a b c, alpha
 *	129     16     but of an ellipsoid and algebraic: e1, e2
 *	145     168    of a deformed one: the modes
 *	129     1      of an algebraic one: degree, 2, 4 or 6
 *	130     8 n    its n = 10, 35 or 84 coefficients (algebraic.h) */
#include "bytes.h"
#include "error.h"
#include "memory.h"
#include "surface.h"

#include <stdlib.h>
#include <string.h>

enum { VERSION = 1, HEADER = 3, COMMON = 129, EXPONENTS = 16, MODES = 8 * ESKEL_MODE_COUNT };

static size_t primitive_size(eskel_primitive_kind kind, unsigned degree)
{
	switch (kind) {
	case ESKEL_PRIMITIVE_ELLIPSOID:
		return COMMON;
	case ESKEL_PRIMITIVE_SUPERQUADRIC:
		return COMMON + EXPONENTS;
	case ESKEL_PRIMITIVE_DEFORMED:
		return COMMON + EXPONENTS + MODES;
	case ESKEL_PRIMITIVE_ALGEBRAIC:
		break;
	}
	return COMMON + 1 + 8 * esk_algebraic_term_count(degree);
}

static uint8_t *put_numbers(uint8_t *b, const double *numbers, size_t count)
{
	for (size_t i = 0; i < count; i++)
		esk_bytes_put_f64(b + 8 * i, numbers[i]);
	return b + 8 * count;
}

static const uint8_t *get_numbers(const uint8_t *b, double *numbers, size_t count)
{
	for (size_t i = 0; i < count; i++)
		numbers[i] = esk_bytes_get_f64(b + 8 * i);
	return b + 8 * count;
}

static uint8_t *put_class(uint8_t *b, const eskel_primitive *p, const esk_algebraic *algebraic)
{
	*b++ = (uint8_t)p->kind;
	b = put_numbers(b, p->centre, 3);
	for (int i = 0; i < 3; i++)
		b = put_numbers(b, p->axes[i], 3);
	b = put_numbers(b, p->radii, 3);
	b = put_numbers(b, &p->alpha, 1);
	if (p->kind == ESKEL_PRIMITIVE_SUPERQUADRIC || p->kind == ESKEL_PRIMITIVE_DEFORMED)
		b = put_numbers(b, p->exponents, 2);
	if (p->kind == ESKEL_PRIMITIVE_DEFORMED)
		b = put_numbers(b, p->modes, ESKEL_MODE_COUNT);
	if (p->kind == ESKEL_PRIMITIVE_ALGEBRAIC) {
		*b++ = (uint8_t)algebraic->degree;
		b = put_numbers(b, algebraic->coefficients, esk_algebraic_term_count(algebraic->degree));
	}
	return b;
}

eskel_status eskel_surface_encode(const eskel_surface *surface, uint8_t **bytes, size_t *size)
{
	const uint32_t count = surface->composition.count;
	size_t total = HEADER;
	for (uint32_t i = 0; i < count; i++)
		total += primitive_size(
			surface->primitives[i].kind, surface->algebraic[i] ? surface->algebraic[i]->degree : 0);
	uint8_t *out = esk_memory_array(total, 1);
	if (!out)
		return ESKEL_NO_MEMORY;
	out[0] = VERSION;
	out[1] = (uint8_t)surface->composition.compose;
	out[2] = (uint8_t)count;
	uint8_t *b = out + HEADER;
	for (uint32_t i = 0; i < count; i++)
		b = put_class(b, &surface->primitives[i], surface->algebraic[i]);
	*bytes = out;
	*size = total;
	return ESKEL_OK;
}

/* ------------------------------------------------------------------------------------ decoding */

/* What is left to read. */
typedef struct {
	const uint8_t *at, *end;
} reader;

static eskel_status is_short(const reader *r, uint32_t class_index, size_t expected, eskel_error *error)
{
	return esk_error_set(error, ESKEL_TRUNCATED, "class %u of a surface has %zu bytes, expected %zu", class_index,
		(size_t)(r->end - r->at), expected);
}

static eskel_status get_algebraic(const uint8_t *b, const eskel_primitive *primitive, uint32_t class_index,
	esk_algebraic **made, eskel_error *error)
{
	esk_algebraic *algebraic = esk_memory_zeroed_array(1, sizeof *algebraic);
	if (!algebraic)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for class %u of a surface", class_index);
	*made = algebraic; /* the surface's now */
	algebraic->degree = *b;
	esk_algebraic_place(primitive, algebraic);
	get_numbers(b + 1, algebraic->coefficients, esk_algebraic_term_count(algebraic->degree));
	if (!esk_algebraic_is_bounded(algebraic))
		return esk_error_set(
			error, ESKEL_MALFORMED, "class %u of a surface is not a bounded polynomial", class_index);
	return ESKEL_OK;
}

static eskel_status get_class(reader *r, uint32_t class_index, eskel_surface *surface, eskel_error *error)
{
	eskel_primitive *p = &surface->primitives[class_index];
	*p = (eskel_primitive){.exponents = {1, 1}};
	if (r->end - r->at < COMMON)
		return is_short(r, class_index, COMMON, error);
	if (r->at[0] > ESKEL_PRIMITIVE_ALGEBRAIC)
		return esk_error_set(error, ESKEL_MALFORMED, "class %u of a surface is of kind %d, expected 0 to 3",
			class_index, r->at[0]);
	p->kind = (eskel_primitive_kind)r->at[0];
	unsigned degree = 0;
	if (p->kind == ESKEL_PRIMITIVE_ALGEBRAIC) {
		if (r->end - r->at < COMMON + 1)
			return is_short(r, class_index, COMMON + 1, error);
		degree = r->at[COMMON];
		if (degree != 2 && degree != 4 && degree != 6)
			return esk_error_set(error, ESKEL_MALFORMED,
				"class %u of a surface has the degree %u, expected 2, 4 or 6", class_index, degree);
	}
	const size_t size = primitive_size(p->kind, degree);
	if ((size_t)(r->end - r->at) < size)
		return is_short(r, class_index, size, error);
	const uint8_t *b = get_numbers(r->at + 1, p->centre, 3);
	for (int i = 0; i < 3; i++)
		b = get_numbers(b, p->axes[i], 3);
	b = get_numbers(b, p->radii, 3);
	b = get_numbers(b, &p->alpha, 1);
	if (p->kind == ESKEL_PRIMITIVE_SUPERQUADRIC || p->kind == ESKEL_PRIMITIVE_DEFORMED)
		b = get_numbers(b, p->exponents, 2);
	if (p->kind == ESKEL_PRIMITIVE_DEFORMED)
		get_numbers(b, p->modes, ESKEL_MODE_COUNT);
	r->at += size;
	if (!esk_primitive_is_valid(p))
		return esk_error_set(error, ESKEL_MALFORMED, "class %u of a surface is out of range", class_index);
	return p->kind == ESKEL_PRIMITIVE_ALGEBRAIC
		       ? get_algebraic(b, p, class_index, &surface->algebraic[class_index], error)
		       : ESKEL_OK;
}

static eskel_status check_header(const uint8_t *bytes, size_t size, eskel_error *error)
{
	if (size < HEADER)
		return esk_error_set(
			error, ESKEL_TRUNCATED, "a surface has %zu bytes, expected at least %d", size, HEADER);
	if (bytes[0] != VERSION)
		return esk_error_set(
			error, ESKEL_UNSUPPORTED, "a surface has version %d, expected %d", bytes[0], VERSION);
	if (bytes[1] > ESKEL_COMPOSE_UNION)
		return esk_error_set(
			error, ESKEL_MALFORMED, "a surface has the composition %d, expected 0 or 1", bytes[1]);
	if (bytes[2] < 1 || bytes[2] > ESKEL_LEVELS_MAX)
		return esk_error_set(error, ESKEL_MALFORMED, "a surface has %d classes, expected 1 to %d", bytes[2],
			ESKEL_LEVELS_MAX);
	return ESKEL_OK;
}

eskel_status eskel_surface_decode(const uint8_t *bytes, size_t size, eskel_surface **surface, eskel_error *error)
{
	eskel_surface *made = NULL;
	eskel_status status = check_header(bytes, size, error);
	if (status)
		return status;
	if (esk_surface_allocate(bytes[2], (eskel_compose)bytes[1], &made))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a surface of %d classes", bytes[2]);
	reader r = {bytes + HEADER, bytes + size};
	for (uint32_t i = 0; i < bytes[2] && !status; i++)
		status = get_class(&r, i, made, error);
	if (!status && r.at != r.end)
		status = esk_error_set(error, ESKEL_MALFORMED, "a surface of %d classes has %zu bytes too many",
			bytes[2], (size_t)(r.end - r.at));
	if (status) {
		eskel_surface_free(made);
		return status;
	}
	esk_surface_refresh(made);
	*surface = made;
	return ESKEL_OK;
}
