/* eskel rows: the shapes of the API's answers as rows of text, for tables that other programs read.
 *
 * A cell is "" where nothing is recorded. Numbers have the digits of the answer, so that a cell of a shape is the same text
 * whichever server answers it.
 */
#ifndef ESKEL_ROWS_H
#define ESKEL_ROWS_H

#include "eskel.h"

typedef struct eskel_rows eskel_rows;

/* Of GET /shapes or POST /shapes. ESKEL_MALFORMED when the bytes are no such answer. */
ESKEL_API eskel_status eskel_rows_read(const char *json, size_t size, eskel_rows **rows);
ESKEL_API void eskel_rows_free(eskel_rows *rows);
ESKEL_API size_t eskel_rows_count(const eskel_rows *rows);

/* The cursor of the page that follows; NULL for none. */
ESKEL_API const char *eskel_rows_cursor(const eskel_rows *rows);

/* The columns that every shape has, in their order; NULL after the last. */
ESKEL_API const char *eskel_rows_column(size_t number);

/* The cell in one of these columns, or in "attr.KEY". free() it; NULL when memory ran out. */
ESKEL_API char *eskel_rows_cell(const eskel_rows *rows, size_t row, const char *column);

/* The keys of a shape's attributes; NULL after the last. */
ESKEL_API const char *eskel_rows_attribute(const eskel_rows *rows, size_t row, size_t number);

#endif
