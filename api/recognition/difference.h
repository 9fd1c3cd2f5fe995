/* In what two matched shapes differ, class by class and as a whole: in numbers and, where it is worth a word, in a
 * sentence. */
#ifndef ESK_DIFFERENCE_H
#define ESK_DIFFERENCE_H

#include "eskel.h"

/* A shape to be told apart from another one, borrowed. */
typedef struct {
	const eskel_signature *signature;
	const eskel_skeleton *skeleton;
} esk_compared;

/* Ratios are query over neighbour, NaN where the neighbour's number is 0; differences are query minus neighbour. */
typedef struct {
	uint32_t class_index, other; /* of the query and of the neighbour */
	double length_ratio[3];      /* of each axis */
	double elongation_ratio;     /* of the first axis over the second */
	double flatness_ratio;       /* of the second axis over the third */
	double share_ratio;          /* of the share in the volume of the whole */
	double solidity_difference;
	double rho_difference; /* mm: > 0 is farther out */
	double importance;     /* the greatest of all these, in multiples of what is notable */
	bool remarkable;       /* notable, and twice as important as the median class of the match */
	char text[200];        /* "class 3: 12 % longer, 4.1 mm farther out"; "" when nothing is notable */
} esk_difference;

/* Those of all classes of a match, the most important first, then by class. Where size is free, the neighbour is first
 * brought to the query's volume. */
void esk_differences_of_classes(const esk_compared *query, const esk_compared *neighbour, const eskel_match *match,
	eskel_size size, esk_difference *differences);

typedef struct {
	double volume_ratio, length_ratio[3]; /* lengths where size is free: at the same volume */
	char text[200];                       /* "12 % larger, 5 % longer; class 3 stands out" */
} esk_whole_difference;

void esk_difference_of_wholes(const esk_compared *query, const esk_compared *neighbour, eskel_size size,
	const esk_difference *differences, uint32_t count, esk_whole_difference *whole);

#endif
