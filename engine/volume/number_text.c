#include "number_text.h"

#include "error.h"

#include <stdbool.h>
#include <stdlib.h>

/* Read in seconds; a few kilobytes can unfold to more. */
static const uint64_t most_bytes = (uint64_t)1 << 28;

enum { most_numbers = 512 };

static bool is_blank(uint8_t byte)
{
	return byte == ' ' || (byte >= '\t' && byte <= '\r');
}

static eskel_status convert(esk_number_text *text, double *number, eskel_error *error)
{
	char *end;
	text->broken[text->size] = 0;
	*number = strtod(text->broken, &end);
	if (end != text->broken + text->size)
		return esk_error_set(
			error, ESKEL_MALFORMED, "the voxels have \"%s\" among them, expected numbers", text->broken);
	text->size = 0;
	return ESKEL_OK;
}

/* What is not printable would spoil a sentence. */
static eskel_status append(esk_number_text *text, uint8_t byte, eskel_error *error)
{
	text->broken[text->size++] = (char)(byte > ' ' && byte < 0x7f ? byte : '?');
	if (text->size < sizeof text->broken)
		return ESKEL_OK;
	text->broken[sizeof text->broken - 1] = 0;
	return esk_error_set(
		error, ESKEL_MALFORMED, "the voxels have \"%s...\" among them, expected numbers", text->broken);
}

/* Reads numbers from the *size bytes at *bytes, which it moves past what it took. All is taken once *count < most_numbers,
 * which counts those before a fault too. */
static eskel_status read_numbers(esk_number_text *text, const uint8_t **bytes, size_t *size,
	double numbers[most_numbers], size_t *count, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	size_t read = 0;
	while (status == ESKEL_OK && read<most_numbers && * size> 0) {
		const uint8_t byte = *(*bytes)++;
		(*size)--;
		if (!is_blank(byte)) {
			status = append(text, byte, error);
		} else if (text->size > 0) {
			status = convert(text, &numbers[read], error);
			read += status == ESKEL_OK;
		}
	}
	*count = read;
	return status;
}

static eskel_status read_all(esk_number_text *text, const uint8_t *bytes, size_t size, esk_decompressor_taker *take,
	void *taker, eskel_error *error)
{
	double numbers[most_numbers];
	eskel_status read;
	size_t count;
	do {
		read = read_numbers(text, &bytes, &size, numbers, &count, error);
		eskel_status status = take(taker, (const uint8_t *)numbers, count * sizeof *numbers, error);
		if (status != ESKEL_OK)
			return status;
	} while (read == ESKEL_OK && count == most_numbers);
	return read;
}

eskel_status esk_number_text_feed(esk_number_text *text, const uint8_t *bytes, size_t size,
	esk_decompressor_taker *take, void *taker, eskel_error *error)
{
	const uint64_t left = most_bytes - text->taken;
	const size_t taken = left < size ? (size_t)left : size;
	eskel_status status = read_all(text, bytes, taken, take, taker, error);
	text->taken += taken;
	if (status == ESKEL_OK && taken < size)
		status = esk_error_set(error, ESKEL_TOO_LARGE,
			"the voxels take more than %llu bytes of text, expected another encoding for so many",
			(unsigned long long)most_bytes);
	return status;
}

eskel_status esk_number_text_finish(
	esk_number_text *text, esk_decompressor_taker *take, void *taker, eskel_error *error)
{
	return read_all(text, (const uint8_t *)"\n", 1, take, taker, error); /* a blank ends the last number */
}
