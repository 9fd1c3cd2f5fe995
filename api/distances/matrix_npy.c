/* A matrix of distances for numpy.load (NumPy's format 1.0): the magic number, the size of the header in 16 bits, the
 * header as Python's text of a dictionary, padded so that the cells begin at a multiple of 64, and the cells. */
#include "matrix.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

static void begin(esk_text *text, const esk_matrix *matrix)
{
	enum { PREFIX = 10, ALIGNMENT = 64 };
	char header[2 * ALIGNMENT];
	const int used =
		snprintf(header, sizeof header, "{'descr': '<f8', 'fortran_order': False, 'shape': (%zu, %zu), }",
			matrix->rows.count, esk_matrix_columns(matrix)->count);
	const int size = (PREFIX + used + 1 + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT - PREFIX;
	esk_text_append(text, "\x93NUMPY\x01\x00", 8);
	esk_text_append(text, (const char[]){(char)(size & 0xff), (char)(size >> 8)}, 2);
	esk_text_print(text, "%-*s\n", size - 1, header);
}

static void cells(esk_text *text, const esk_matrix *matrix, size_t number, const double *distances, size_t count)
{
	(void)matrix;
	(void)number;
	for (size_t i = 0; i < count; i++) {
		uint64_t bits;
		char bytes[sizeof bits];
		memcpy(&bits, &distances[i], sizeof bits);
		for (size_t b = 0; b < sizeof bits; b++)
			bytes[b] = (char)(bits >> 8 * b & 0xff);
		esk_text_append(text, bytes, sizeof bytes);
	}
}

static void end(esk_text *text, const esk_matrix *matrix)
{
	(void)text;
	(void)matrix;
}

const esk_matrix_format esk_matrix_npy = {"application/x-npy", begin, cells, end, sizeof(double)};
