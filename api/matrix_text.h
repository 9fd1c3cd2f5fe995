/* A matrix of distances between shapes as text. Written straight into a string: as JSON values a matrix of millions
 * would take ten times its size. */
#ifndef ESK_MATRIX_TEXT_H
#define ESK_MATRIX_TEXT_H

#include "eskel_store.h"
#include "text.h"

typedef struct {
	eskel_shape *shapes;
	size_t count;
	double *distances; /* [count * count] */
} esk_matrix;

/* {"ids":[...],"names":[...],"distances":[[...]...]} */
void esk_matrix_json(esk_text *text, const esk_matrix *matrix);

/* RFC 4180: a heading "id,name" and the ids, then a row for each shape. A name that a spreadsheet would take for a formula
 * is given a leading apostrophe. */
void esk_matrix_csv(esk_text *text, const esk_matrix *matrix);

#endif
