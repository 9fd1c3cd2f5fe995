/* The signature of a skeleton (section 5.2.1): four lengths and a solidity for each class of each level.
 *
 * Solidity is ours: how much of the solid ellipsoid with the class's covariance M the class fills. A solid ellipsoid
 * with semi-axes a_i has lambda_i = a_i^2 / 5, so its volume is 4/3 pi 5^1.5 sqrt(det M). It tells a plate from a shell
 * and a compact class from a scattered one, which the four lengths cannot.
 *
 * Numbers are rounded to float here, once, so that a stored signature is the same signature. */
#include "signature.h"

#include "elementary.h"
#include "error.h"
#include "lanes.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double five_to_three_halves = 11.18033988749894848205;
/* The centres of a few voxels vary less than the solid that they fill; a quotient beyond this says no more. */
static const double most_solidity = 1.25;

static const double least_volume = 1e-20, most_volume = 1e25, most_number = 1e10;

eskel_signature *esk_signature_alloc(uint32_t level_count)
{
	eskel_signature *signature = esk_memory_zeroed_array(1, sizeof *signature);
	if (!signature)
		return NULL;
	signature->level_count = level_count;
	signature->rows = esk_memory_zeroed_array(ESKEL_NODES(level_count), sizeof *signature->rows);
	if (!signature->rows) {
		eskel_signature_free(signature);
		return NULL;
	}
	return signature;
}

void eskel_signature_free(eskel_signature *signature)
{
	if (!signature)
		return;
	free(signature->rows);
	free(signature);
}

/* A flat class has no ellipsoid: its quotient is infinite, and capped. */
static double solidity(const double eigenvalues[3], double class_volume)
{
	double determinant = eigenvalues[0] * eigenvalues[1] * eigenvalues[2];
	double ellipsoid = 4.0 / 3 * pi * five_to_three_halves * sqrt(determinant);
	return fmin(class_volume / ellipsoid, most_solidity);
}

eskel_status eskel_signature_new(const eskel_skeleton *skeleton, eskel_signature **signature)
{
	eskel_signature *made = esk_signature_alloc(skeleton->level_count);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->volume = skeleton->volume;
	for (size_t n = 0; n < ESKEL_NODES(skeleton->level_count); n++) {
		const eskel_node *node = &skeleton->nodes[n];
		double *row = made->rows[n];
		for (int i = 0; i < 3; i++)
			row[i] = esk_elementary_round_to_float(sqrt(node->eigenvalues[i]));
		row[3] = esk_elementary_round_to_float(node->rho);
		row[4] = esk_elementary_round_to_float(
			solidity(node->eigenvalues, skeleton->volume * (node->weight / skeleton->weight)));
	}
	*signature = made;
	return ESKEL_OK;
}

/* Without a branch: signatures are nearly always valid, and read by the million. */
ESK_EVERY_WIDTH static bool are_valid(const double *numbers, size_t count)
{
	int64_t wrong = 0;
	for (size_t n = 0; n < count; n++)
		wrong |= !((numbers[n] >= 0) & (numbers[n] <= most_number));
	return !wrong;
}

eskel_status esk_signature_check(const eskel_signature *signature, eskel_error *error)
{
	if (signature->level_count < 1 || signature->level_count > ESKEL_LEVELS_MAX)
		return esk_error_set(error, ESKEL_INVALID, "the signature has %u levels, expected 1 to %d",
			(unsigned)signature->level_count, ESKEL_LEVELS_MAX);
	if (!(signature->volume >= least_volume && signature->volume <= most_volume))
		return esk_error_set(error, ESKEL_INVALID, "the signature's volume is %g mm^3, expected %g to %g",
			signature->volume, least_volume, most_volume);
	if (are_valid(signature->rows[0], ESKEL_SIGNATURE_NUMBERS * ESKEL_NODES(signature->level_count)))
		return ESKEL_OK;
	for (size_t n = 0; n < ESKEL_NODES(signature->level_count); n++)
		for (int i = 0; i < ESKEL_SIGNATURE_NUMBERS; i++)
			if (!(signature->rows[n][i] >= 0 && signature->rows[n][i] <= most_number))
				return esk_error_set(error, ESKEL_INVALID,
					"number %d of class %zu in the signature is %g, expected 0 to %g", i, n,
					signature->rows[n][i], most_number);
	return ESKEL_OK;
}
