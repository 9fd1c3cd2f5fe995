#include "primitive.h"

#include "elementary.h"
#include "triple.h"

#include <math.h>
#include <string.h>

void esk_primitive_from_node(const eskel_node *node, double gamma, double least_variance, eskel_primitive *primitive)
{
	*primitive = (eskel_primitive){.exponents = {1, 1}, .alpha = 1};
	for (int i = 0; i < 3; i++) {
		const int axis = (i + 1) % 3; /* the longest comes last, and the frame stays right-handed */
		primitive->centre[i] = node->centre[i];
		memcpy(primitive->axes[i], node->axes[axis], sizeof primitive->axes[i]);
		primitive->radii[i] = gamma * sqrt(fmax(node->eigenvalues[axis], least_variance));
	}
}

static bool is_within(double value, double least, double most)
{
	return value >= least && value <= most; /* also refuses NaN */
}

static bool is_frame(const double axes[3][3])
{
	double third[3];
	bool good = true;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j <= i; j++)
			good = good && fabs(esk_triple_dot(axes[i], axes[j]) - (i == j)) < 1e-9;
	esk_triple_cross(axes[0], axes[1], third);
	return good && esk_triple_dot(third, axes[2]) > 0;
}

/* A kind has nothing that it is not encoded with. */
static bool is_of_its_kind(const eskel_primitive *primitive)
{
	const bool round = primitive->exponents[0] == 1 && primitive->exponents[1] == 1;
	bool straight = true;
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		straight = straight && primitive->modes[i] == 0;
	switch (primitive->kind) {
	case ESKEL_PRIMITIVE_ELLIPSOID:
	case ESKEL_PRIMITIVE_ALGEBRAIC:
		return round && straight;
	case ESKEL_PRIMITIVE_SUPERQUADRIC:
		return straight;
	case ESKEL_PRIMITIVE_DEFORMED:
		return true;
	}
	return false;
}

bool esk_primitive_is_valid(const eskel_primitive *primitive)
{
	bool good = is_of_its_kind(primitive) && is_frame(primitive->axes) &&
		    is_within(primitive->alpha, ESKEL_ALPHA_MIN, ESKEL_ALPHA_MAX);
	for (int i = 0; i < 3; i++)
		good = good && isfinite(primitive->centre[i]) &&
		       is_within(primitive->radii[i], ESKEL_RADIUS_MIN, ESKEL_RADIUS_MAX);
	for (int i = 0; i < 2; i++)
		good = good && is_within(primitive->exponents[i], ESKEL_EXPONENT_MIN, ESKEL_EXPONENT_MAX);
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		good = good && is_within(primitive->modes[i], -ESKEL_MODE_MAX, ESKEL_MODE_MAX);
	return good;
}

/* v turned about the rotation vector (Rodrigues). */
static void rotate(const double vector[3], double v[3])
{
	const double angle = esk_triple_length(vector);
	double sine, cosine, axis[3], side[3];
	if (!(angle > 0))
		return;
	esk_elementary_sine_cosine(angle, &sine, &cosine);
	for (int i = 0; i < 3; i++)
		axis[i] = vector[i] / angle;
	esk_triple_cross(axis, v, side);
	const double along = esk_triple_dot(axis, v) * (1 - cosine);
	for (int i = 0; i < 3; i++)
		v[i] = v[i] * cosine + side[i] * sine + axis[i] * along;
}

/* Many small rotations would leave a frame that is not one. */
static void straighten(double axes[3][3])
{
	const double length = esk_triple_length(axes[2]);
	for (int i = 0; i < 3; i++)
		axes[2][i] /= length;
	const double lean = esk_triple_dot(axes[0], axes[2]);
	for (int i = 0; i < 3; i++)
		axes[0][i] -= lean * axes[2][i];
	const double left = esk_triple_length(axes[0]);
	for (int i = 0; i < 3; i++)
		axes[0][i] /= left;
	esk_triple_cross(axes[2], axes[0], axes[1]);
}

/* The first six: along the axes as they are before. */
static void move(const eskel_primitive *from, const double *step, eskel_primitive *to)
{
	double vector[3] = {0};
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++) {
			to->centre[i] += step[ESK_TRANSLATION + k] * from->axes[k][i];
			vector[i] += step[ESK_ROTATION + k] * from->axes[k][i];
		}
	for (int k = 0; k < 3; k++)
		rotate(vector, to->axes[k]);
	straighten(to->axes);
}

void esk_primitive_step(const eskel_primitive *from, const double *step, size_t count, eskel_primitive *to)
{
	const eskel_primitive before = *from;
	double all[ESK_PARAMETERS_ALL] = {0};
	memcpy(all, step, count * sizeof *step);
	*to = before;
	move(&before, all, to);
	for (int i = 0; i < 3; i++)
		to->radii[i] *= esk_elementary_exp_double(all[ESK_LOG_RADII + i]);
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		to->modes[i] += all[i < ESK_FIRST_MODE_COUNT ? ESK_FIRST_MODES + i
							     : ESK_FURTHER_MODES + i - ESK_FIRST_MODE_COUNT];
	to->alpha += all[ESK_ALPHA];
	for (int i = 0; i < 2; i++)
		to->exponents[i] += all[ESK_EXPONENTS + i];
}

uint32_t esk_primitive_nearest(const eskel_primitive *primitives, uint32_t count, const double point[3])
{
	uint32_t nearest = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		double square = 0;
		for (int r = 0; r < 3; r++)
			square += (point[r] - primitives[i].centre[r]) * (point[r] - primitives[i].centre[r]);
		if (square < least) {
			least = square;
			nearest = i;
		}
	}
	return nearest;
}
