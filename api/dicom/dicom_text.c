#include "dicom_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_blank(uint8_t byte)
{
	return byte == ' ' || byte == 0;
}

void esk_dicom_text(const uint8_t *bytes, size_t size, const char *character_set, char *text, size_t room)
{
	const bool latin = strcmp(character_set, "ISO_IR 100") == 0;
	size_t used = 0;
	for (; size > 0 && is_blank(*bytes); size--)
		bytes++;
	while (size > 0 && is_blank(bytes[size - 1]))
		size--;
	for (size_t i = 0; i < size && bytes[i]; i++) {
		const bool two = latin && bytes[i] >= 0x80;
		if (used + two + 1 >= room) {
			while (!latin && used > 0 && (bytes[i] & 0xc0) == 0x80) {
				i--;
				used--;
			}
			break;
		}
		if (two)
			text[used++] = (char)(0xc0 | bytes[i] >> 6);
		text[used++] = (char)(two ? 0x80 | (bytes[i] & 0x3f) : bytes[i]);
	}
	text[used] = 0;
}

/* A decimal string has at most 16 bytes; some writers do not know that. */
enum { longest_number = 32, most_numbers = 6 };

/* What strtod takes beyond a decimal string begins with other characters: inf, nan, 0x. A point is a point because no
 * program here sets a locale for numbers. */
static bool take_decimal(const char *text, double *number)
{
	char *end;
	if (strspn(text, " +-.0123456789eE") != strlen(text))
		return false;
	*number = strtod(text, &end);
	return end != text && end[strspn(end, " ")] == 0 && isfinite(*number);
}

bool esk_dicom_decimals(const uint8_t *bytes, size_t size, double *numbers, size_t count)
{
	double taken[most_numbers];
	size_t found = 0, used = 0;
	char text[longest_number + 1];
	while (size > 0 && bytes[size - 1] == 0)
		size--;
	for (size_t i = 0; i <= size; i++) {
		if (i < size && bytes[i] != '\\') {
			if (used == longest_number || !bytes[i])
				return false;
			text[used++] = (char)bytes[i];
			continue;
		}
		text[used] = 0;
		if (found == count || !take_decimal(text, &taken[found++]))
			return false;
		used = 0;
	}
	if (found != count)
		return false;
	memcpy(numbers, taken, count * sizeof *numbers);
	return true;
}
