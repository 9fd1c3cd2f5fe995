/* How near the shapes of one class of the library are to each other, and how large they are: what a distance and a volume
 * are held against.
 *
 * Distances and volumes are compared by their logarithms, whose spreads are alike in classes of any size. */
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
/* As if all numbers of other had been added. */
void esk_spread_merge(esk_spread *spread, const esk_spread *other);
/* The standard deviation of the population; NaN of none. */
double esk_spread_deviation(const esk_spread *spread);

typedef struct {
	int64_t *keys; /* of the class, ascending, those that the query's filter leaves */
	size_t count;
	int64_t *sample; /* at most 256 of them, evenly spaced */
	size_t sample_count;
	esk_spread
		distances; /* ln of the distance from a shape to the nearest one of another subject, where there is one */
	esk_spread volumes; /* ln mm^3 */
} esk_class_statistics;

/* Of at most 32 shapes of the class, evenly spaced by key: 32 numbers tell a deviation to 12 %. A shape's nearest is looked
 * for among all of its class. Twins, the left and the right bone of one person, are nearer than bones of two people; where
 * a class is of one subject alone, or subjects are not recorded, they have to do. */
bool esk_class_statistics_make(eskel_api *api, const esk_parameters *query, const char *class,
	esk_class_statistics *statistics, esk_problem *problem);
void esk_class_statistics_clear(esk_class_statistics *statistics);

/* The distance of an unknown from the nearest shape of the class, or of its sample; NaN when there is none. */
typedef enum { ESK_AMONG_ALL, ESK_AMONG_SAMPLE } esk_among;

bool esk_class_statistics_distance(eskel_api *api, const esk_parameters *query, const esk_class_statistics *statistics,
	esk_among among, const eskel_signature *signature, double *distance, esk_problem *problem);

/* How many deviations ln distance lies above the mean of its class. A class of a few shapes hardly has a deviation of its
 * own, so its numbers are joined by three that are spread as those of the whole library are: with n numbers of mean m and
 * variance v in the class, M and V in the library,
 *
 *	mean = (n m + 3 M) / (n + 3),   variance = (n (v + (m - mean)^2) + 3 (V + (M - mean)^2)) / (n + 3).
 *
 * NaN when the distance is, or when nothing is known of the library. */
double esk_class_statistics_z(const esk_spread *class, const esk_spread *library, double distance);

#endif
