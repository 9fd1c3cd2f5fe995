/* In what two matched classes differ, in numbers and, where it is worth a word, in a sentence. */
#ifndef ESK_DIFFERENCE_H
#define ESK_DIFFERENCE_H

#include "eskel.h"

typedef struct {
	uint32_t class_index, other; /* of the query and of the neighbour */
	double length_ratio[3];      /* of each axis, query over neighbour; NaN where the neighbour's is 0 */
	double rho_difference;       /* mm, query minus neighbour: > 0 is farther out */
	char text[160];              /* "class 3: 12 % longer, 4.1 mm farther out"; "" when nothing is notable */
} esk_difference;

/* The difference of class i of a match. Where size is free, the neighbour is first brought to the query's volume. */
void esk_difference_of_class(const eskel_signature *query, const eskel_signature *neighbour, const eskel_match *match,
	eskel_size size, uint32_t i, esk_difference *difference);

#endif
