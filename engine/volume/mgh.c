/* The header of FreeSurfer's MGH files (.mgz when gzipped), always of big-endian byte order.
 *
 *   0  version, 1        4  width, height, depth, frames       20  type       24  degrees of freedom
 *  28  16 bits: whether what follows is valid                  30  spacing of each axis, mm
 *  42  direction of each axis, RAS                             78  RAS of the grid's middle, where index = extent / 2
 * 284  the voxels, and behind them a footer (mgh_footer.h)
 *
 * FreeSurfer's own reader and writer define the format. As there, a header whose geometry is not valid has voxels of 1 mm in
 * coronal slices: the axes go left, down and to the front, about the origin.
 */
#include "byte_order.h"
#include "error.h"
#include "mgh_footer.h"
#include "volume_format.h"

#include <string.h>

enum { version_size = 4, header_size = 284, longest_axis = 65535 };

static int32_t get_i32(const uint8_t *bytes, size_t at)
{
	return (int32_t)esk_byte_order_signed(bytes + at, 4, true);
}

static void get_floats(const uint8_t *bytes, size_t at, int count, double *values)
{
	for (int i = 0; i < count; i++)
		values[i] = esk_byte_order_float(bytes + at + 4 * (size_t)i, 4, true);
}

static eskel_status read_extent(const uint8_t *bytes, uint32_t extent[3], eskel_error *error)
{
	static const char *const names[] = {"width", "height", "depth", "number of frames"};
	for (size_t a = 0; a < 4; a++) {
		const int32_t length = get_i32(bytes, 4 + 4 * a);
		if (length < 1)
			return esk_error_set(error, ESKEL_MALFORMED, "the MGH header's %s is %d, expected at least 1",
				names[a], length);
		if (a == 3 && length > 1)
			return esk_error_set(error, ESKEL_UNSUPPORTED,
				"the MGH file is a series of %d frames, expected one 3-D volume", length);
		if (length > longest_axis)
			return esk_error_set(error, ESKEL_TOO_LARGE, "the MGH header's %s is %d, expected at most %d",
				names[a], length, longest_axis);
		if (a < 3)
			extent[a] = (uint32_t)length;
	}
	return ESKEL_OK;
}

static eskel_status read_type(const uint8_t *bytes, esk_voxel_format *voxels, eskel_error *error)
{
	static const struct {
		int type;
		esk_voxel_kind kind;
		unsigned size;
	} types[] = {
		{0, ESK_VOXEL_UNSIGNED, 1},
		{1, ESK_VOXEL_SIGNED, 4},
		{3, ESK_VOXEL_FLOAT, 4},
		{4, ESK_VOXEL_SIGNED, 2},
		{10, ESK_VOXEL_UNSIGNED, 2},
	};
	const int32_t type = get_i32(bytes, 20);
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		if (types[i].type == type) {
			*voxels = (esk_voxel_format){.kind = types[i].kind, .size = types[i].size, .big_endian = true};
			return ESKEL_OK;
		}
	return esk_error_set(error, ESKEL_UNSUPPORTED,
		"the MGH header's type is %d, expected 0 (uchar), 1 (int), 3 (float), 4 (short) or 10 (ushort)", type);
}

static eskel_status read_affine(const uint8_t *bytes, eskel_volume_info *info, eskel_error *error)
{
	double spacing[3] = {1, 1, 1}, directions[9] = {-1, 0, 0, 0, 0, -1, 0, 1, 0}, middle[3] = {0, 0, 0};
	if (esk_byte_order_signed(bytes + 28, 2, true) > 0) {
		get_floats(bytes, 30, 3, spacing);
		get_floats(bytes, 42, 9, directions);
		get_floats(bytes, 78, 3, middle);
	} else {
		eskel_volume_warn(info, ESKEL_WARNING_NO_ORIENTATION,
			"the file does not say how it lies: its axes are taken as left, down and front, so left "
			"and right may be exchanged");
		eskel_volume_warn(info, ESKEL_WARNING_UNIT_ASSUMED,
			"the file does not say how large its voxels are; voxels of 1 mm are assumed");
	}
	for (int a = 0; a < 3; a++)
		if (!(spacing[a] > 0))
			return esk_error_set(error, ESKEL_BAD_GEOMETRY,
				"the MGH header's spacing of axis %d is %g, expected a positive one", a, spacing[a]);
	for (int r = 0; r < 3; r++) {
		double *row = info->affine.m[r];
		row[3] = middle[r];
		for (int c = 0; c < 3; c++) {
			row[c] = directions[3 * c + r] * spacing[c];
			row[3] -= row[c] * info->extent[c] / 2;
		}
	}
	return eskel_affine_check(&info->affine, error);
}

eskel_status esk_mgh_read_header(
	const uint8_t *bytes, size_t size, size_t *needed, esk_volume_header *header, eskel_error *error)
{
	if (memcmp(bytes, "\0\0\0\1", version_size) != 0)
		return ESKEL_NOT_VOLUME;
	*needed = header_size;
	if (size < header_size)
		return ESKEL_OK;
	esk_volume_header h = {
		.info.format = "MGH", .layer_count = 1, .data_offset = header_size, .read_footer = esk_mgh_footer_read};
	eskel_status status = read_extent(bytes, h.info.extent, error);
	if (status == ESKEL_OK)
		status = read_type(bytes, &h.voxels, error);
	if (status == ESKEL_OK)
		status = read_affine(bytes, &h.info, error);
	if (status == ESKEL_OK)
		*header = h;
	return status;
}
