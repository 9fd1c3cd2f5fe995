/* A matrix of distances on its way to a client: written in pieces, so that it need not fit into memory. */
#ifndef ESK_MATRIX_H
#define ESK_MATRIX_H

#include "selection.h"
#include "text.h"

typedef struct {
	esk_selection rows, others; /* others: columns, when they are not the rows */
	bool square;                /* the columns are the rows */
} esk_matrix;

static inline const esk_selection *esk_matrix_columns(const esk_matrix *matrix)
{
	return matrix->square ? &matrix->rows : &matrix->others;
}

/* Each appends to text: first what comes before the cells, then the cells, row by row, in any pieces (number is that of
 * the first one), then what comes after them. */
typedef struct {
	const char *content_type;
	void (*begin)(esk_text *text, const esk_matrix *matrix);
	void (*cells)(esk_text *text, const esk_matrix *matrix, size_t number, const double *distances, size_t count);
	void (*end)(esk_text *text, const esk_matrix *matrix);
	size_t cell_size; /* 0: it differs */
} esk_matrix_format;

/* {"ids":[...],"names":[...],"columns":{"ids","names"},"distances":[[...]...]}, a row a line; columns unless square. */
extern const esk_matrix_format esk_matrix_json;

/* RFC 4180: a heading "id,name" and the ids of the columns, then a row for each shape. A name that a spreadsheet would
 * take for a formula is given a leading apostrophe. */
extern const esk_matrix_format esk_matrix_csv;

/* NumPy's format 1.0: float64, little-endian, C order. */
extern const esk_matrix_format esk_matrix_npy;

#endif
