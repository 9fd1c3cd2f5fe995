#include "voxel.h"

#include "byte_order.h"

#include <math.h>

static double stored_value(const esk_voxel_format *f, const uint8_t *stored)
{
	switch (f->kind) {
	case ESK_VOXEL_UNSIGNED:
		return (double)esk_byte_order_unsigned(stored, f->size, f->big_endian);
	case ESK_VOXEL_SIGNED:
		return (double)esk_byte_order_signed(stored, f->size, f->big_endian);
	case ESK_VOXEL_FLOAT:
		break;
	}
	return esk_byte_order_float(stored, f->size, f->big_endian);
}

double esk_voxel_value(const esk_voxel_format *format, const uint8_t *stored)
{
	const double value = stored_value(format, stored);
	return format->slope != 0 ? format->slope * value + format->intercept : value;
}

bool esk_voxel_label(const esk_voxel_format *format, const uint8_t *stored, int32_t *label, double *value)
{
	/* A slope such as 1/255 is stored as a float, off by up to 6e-8 of itself: labels up to 16000 come out well
	 * within this of an integer, and probabilities or intensities in physical units do not. */
	static const double slope_tolerance = 1e-3;
	const double v = esk_voxel_value(format, stored);
	*value = v;
	if (!(fabs(v) < 2147483648.0))
		return false;
	*label = (int32_t)v; /* the usual case, an integer already, spares a call of rint */
	if ((double)*label == v)
		return true;
	double nearest = rint(v);
	if (format->slope == 0 || fabs(v - nearest) > slope_tolerance || fabs(nearest) >= 2147483648.0)
		return false;
	*label = (int32_t)nearest;
	return true;
}
