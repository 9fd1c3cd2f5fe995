/* Pictures of a matrix as SVG that stands alone: it has no scripts, no styles (a server's policy may forbid them) and asks
 * for nothing else. What a mark or a cell is, a <title> tells the pointer. Colours are told apart by the colour-blind, and
 * classes differ in the form of their marks as well.
 *
 * distances are those of every two of rows and others together, rows first. Both append the whole picture to text. */
#ifndef ESK_PICTURE_H
#define ESK_PICTURE_H

#include "matrix.h"

/* Rows x columns, each ordered by average linkage, with the trees. */
eskel_status esk_picture_heatmap(esk_text *text, const esk_matrix *matrix, const double *distances);

/* Rows and columns in a plane, where near marks are like shapes; of two sets those of the columns are hollow. */
eskel_status esk_picture_map(esk_text *text, const esk_matrix *matrix, const double *distances);

#endif
