/* The shapes of one class of the library: how large they are, and how near the nearest of them is. */
#ifndef ESK_CLASS_STATISTICS_H
#define ESK_CLASS_STATISTICS_H

#include "api.h"
#include "parameters.h"
#include "problem.h"

/* Of numbers that were added one by one; all zero: of none. */
typedef struct {
	size_t count;
	double mean, squares; /* sum of squared differences from the mean */
} esk_spread;

void esk_spread_add(esk_spread *spread, double number);
/* The standard deviation of the population; NaN of none. */
double esk_spread_deviation(const esk_spread *spread);

/* A set of keys. */
typedef struct {
	eskel_key_block *blocks;
	size_t block_count;
} esk_class_keys;

typedef struct {
	esk_class_keys all;    /* of the class, those that the query's filter leaves */
	esk_class_keys sample; /* at most 256 of them (sample.h) */
	esk_spread volumes;    /* ln mm^3, of at most 32 of them: these tell a deviation to 12 % */
} esk_class_statistics;

bool esk_class_statistics_make(eskel_api *api, const esk_parameters *query, const char *class,
	esk_class_statistics *statistics, esk_problem *problem);
void esk_class_statistics_clear(esk_class_statistics *statistics);

/* The distance of an unknown from the nearest shape of a set of keys; NaN when there is none. */
bool esk_class_statistics_distance(eskel_api *api, const esk_parameters *query, const esk_class_keys *keys,
	const eskel_signature *signature, double *distance, esk_problem *problem);

#endif
