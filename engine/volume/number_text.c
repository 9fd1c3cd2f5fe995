#include "number_text.h"

#include "error.h"

#include <stdbool.h>
#include <stdlib.h>

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

eskel_status esk_number_text_read(esk_number_text *text, const uint8_t **bytes, size_t *size, double *numbers,
	size_t most, size_t *count, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	size_t read = 0;
	while (status == ESKEL_OK && read<most && * size> 0) {
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
