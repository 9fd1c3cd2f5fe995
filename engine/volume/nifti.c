/* The headers of NIfTI-1 and NIfTI-2 single files, in either byte order.
 *
 * sizeof_hdr, the first four bytes, tells the version and the byte order. Both headers are read into one struct of the
 * fields that matter, which then has one meaning (nifti1.h and nifti2.h by the NIfTI Data Format Working Group).
 *
 * Stricter than the usual readers: bitpix must fit the datatype, axes beyond the third must have extent 1, vox_offset
 * must lie behind the header, and ANALYZE 7.5 files and header/image pairs are refused. More tolerant in one place:
 * the slope that means "none" may be NaN as well as 0, because common writers store that.
 */
#include "affine.h"
#include "byte_order.h"
#include "error.h"
#include "nifti_labels.h"
#include "volume_format.h"

#include <math.h>
#include <string.h>

enum { nifti1_size = 348, nifti2_size = 540, longest_axis = 65535 };

/* Extensions lie between header and voxels; real ones (label names, histories, XML) have kilobytes. */
static const double largest_offset = 16 << 20;
/* Of the file, the first that are searched for label names. */
static const size_t most_name_bytes = (size_t)1 << 20;

/* Where the sform and the qform put a corner of the grid may differ by this part of a voxel before we say so: both are
 * stored as floats, often of different origin, and nothing that a shape tells changes by less. */
static const double form_tolerance_voxels = 0.1;

typedef struct {
	int64_t dim[8];
	int datatype, bitpix;
	double pixdim[8];
	double vox_offset, scl_slope, scl_inter;
	int qform_code, sform_code, xyzt_units;
	double quatern[3], qoffset[3], srow[3][4];
	int version;
	char magic[4];
} fields;

typedef struct {
	const uint8_t *bytes;
	bool big_endian;
} source;

static size_t header_size(const fields *f)
{
	return f->version == 1 ? nifti1_size : nifti2_size;
}

static int get_i16(source s, size_t at)
{
	return (int)esk_byte_order_signed(s.bytes + at, 2, s.big_endian);
}

static int get_i32(source s, size_t at)
{
	return (int)esk_byte_order_signed(s.bytes + at, 4, s.big_endian);
}

static void get_floats(source s, size_t at, unsigned size, int count, double *values)
{
	for (int i = 0; i < count; i++)
		values[i] = esk_byte_order_float(s.bytes + at + (size_t)i * size, size, s.big_endian);
}

static void get_nifti1(source s, fields *f)
{
	for (size_t i = 0; i < 8; i++)
		f->dim[i] = get_i16(s, 40 + 2 * i);
	f->datatype = get_i16(s, 70);
	f->bitpix = get_i16(s, 72);
	get_floats(s, 76, 4, 8, f->pixdim);
	get_floats(s, 108, 4, 1, &f->vox_offset);
	get_floats(s, 112, 4, 1, &f->scl_slope);
	get_floats(s, 116, 4, 1, &f->scl_inter);
	f->xyzt_units = s.bytes[123];
	f->qform_code = get_i16(s, 252);
	f->sform_code = get_i16(s, 254);
	get_floats(s, 256, 4, 3, f->quatern);
	get_floats(s, 268, 4, 3, f->qoffset);
	get_floats(s, 280, 4, 12, f->srow[0]);
	memcpy(f->magic, s.bytes + 344, 4);
	f->version = 1;
}

static void get_nifti2(source s, fields *f)
{
	memcpy(f->magic, s.bytes + 4, 4);
	f->datatype = get_i16(s, 12);
	f->bitpix = get_i16(s, 14);
	for (size_t i = 0; i < 8; i++)
		f->dim[i] = esk_byte_order_signed(s.bytes + 16 + 8 * i, 8, s.big_endian);
	get_floats(s, 104, 8, 8, f->pixdim);
	f->vox_offset = (double)esk_byte_order_signed(s.bytes + 168, 8, s.big_endian);
	get_floats(s, 176, 8, 1, &f->scl_slope);
	get_floats(s, 184, 8, 1, &f->scl_inter);
	f->qform_code = get_i32(s, 344);
	f->sform_code = get_i32(s, 348);
	get_floats(s, 352, 8, 3, f->quatern);
	get_floats(s, 376, 8, 3, f->qoffset);
	get_floats(s, 400, 8, 12, f->srow[0]);
	f->xyzt_units = get_i32(s, 500);
	f->version = 2;
}

static eskel_status check_magic(const fields *f, const uint8_t *bytes, eskel_error *error)
{
	if (f->version == 2 && memcmp(bytes + 8, "\r\n\032\n", 4) != 0)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the NIfTI-2 magic ends in %02x %02x %02x %02x, expected 0d 0a 1a 0a: the file was changed in "
			"transfer",
			bytes[8], bytes[9], bytes[10], bytes[11]);
	if (memcmp(f->magic, f->version == 1 ? "n+1" : "n+2", 4) == 0)
		return ESKEL_OK;
	if (memcmp(f->magic, f->version == 1 ? "ni1" : "ni2", 4) == 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the NIfTI header names voxels in another file (magic \"ni%d\"), expected a single file "
			"\"n+%d\"",
			f->version, f->version);
	if (f->version == 1)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the header has no NIfTI magic: it is ANALYZE 7.5, which does not say where left is; expected "
			"\"n+1\"");
	return esk_error_set(error, ESKEL_MALFORMED, "the header has the size of NIfTI-2 but not its magic \"n+2\"");
}

static eskel_status read_extent(const fields *f, uint32_t extent[3], eskel_error *error)
{
	int64_t dimensions = f->dim[0];
	if (dimensions < 1 || dimensions > 7)
		return esk_error_set(error, ESKEL_MALFORMED, "dim[0] is %lld, expected 1 to 7", (long long)dimensions);
	for (int i = 1; i <= dimensions; i++) {
		long long length = f->dim[i];
		if (length < 1)
			return esk_error_set(error, ESKEL_MALFORMED, "dim[%d] is %lld, expected at least 1", i, length);
		if (i <= 3 && length > longest_axis)
			return esk_error_set(error, ESKEL_TOO_LARGE, "dim[%d] is %lld, expected at most %d", i, length,
				longest_axis);
		if (i > 3 && length != 1)
			return esk_error_set(error, ESKEL_UNSUPPORTED,
				"the image is a series, dim[%d] is %lld; expected one 3-D volume", i, length);
	}
	for (int a = 0; a < 3; a++)
		extent[a] = a < dimensions ? (uint32_t)f->dim[a + 1] : 1;
	return ESKEL_OK;
}

static const struct {
	int code;
	const char *name;
	esk_voxel_kind kind;
	unsigned size; /* 0: not a label */
} datatypes[] = {
	{2, "uint8", ESK_VOXEL_UNSIGNED, 1},
	{4, "int16", ESK_VOXEL_SIGNED, 2},
	{8, "int32", ESK_VOXEL_SIGNED, 4},
	{16, "float32", ESK_VOXEL_FLOAT, 4},
	{64, "float64", ESK_VOXEL_FLOAT, 8},
	{256, "int8", ESK_VOXEL_SIGNED, 1},
	{512, "uint16", ESK_VOXEL_UNSIGNED, 2},
	{768, "uint32", ESK_VOXEL_UNSIGNED, 4},
	{1024, "int64", ESK_VOXEL_SIGNED, 8},
	{1280, "uint64", ESK_VOXEL_UNSIGNED, 8},
	{1, "binary (one bit a voxel)", 0, 0},
	{32, "complex64", 0, 0},
	{128, "RGB24", 0, 0},
	{1536, "float128", 0, 0},
	{1792, "complex128", 0, 0},
	{2048, "complex256", 0, 0},
	{2304, "RGBA32", 0, 0},
};

static eskel_status read_datatype(const fields *f, esk_voxel_format *voxels, eskel_error *error)
{
	size_t i = 0, count = sizeof datatypes / sizeof datatypes[0];
	while (i < count && datatypes[i].code != f->datatype)
		i++;
	if (i == count)
		return esk_error_set(
			error, ESKEL_MALFORMED, "datatype is %d, which NIfTI does not define", f->datatype);
	if (datatypes[i].size == 0)
		return esk_error_set(error, ESKEL_UNSUPPORTED,
			"the voxels are %s (datatype %d), expected integers or reals", datatypes[i].name, f->datatype);
	if (f->bitpix != 8 * (int)datatypes[i].size)
		return esk_error_set(error, ESKEL_MALFORMED, "bitpix is %d, expected %u for %s", f->bitpix,
			8 * datatypes[i].size, datatypes[i].name);
	bool scaled = isfinite(f->scl_slope) && f->scl_slope != 0;
	if (scaled && !isfinite(f->scl_inter))
		return esk_error_set(error, ESKEL_MALFORMED, "scl_inter is %g, expected a finite number", f->scl_inter);
	voxels->kind = datatypes[i].kind;
	voxels->size = datatypes[i].size;
	voxels->slope = scaled && !(f->scl_slope == 1 && f->scl_inter == 0) ? f->scl_slope : 0;
	voxels->intercept = f->scl_inter;
	return ESKEL_OK;
}

static eskel_status read_offset(const fields *f, uint64_t *offset, eskel_error *error)
{
	const int least = (int)header_size(f);
	if (!(f->vox_offset >= least && f->vox_offset <= largest_offset) || f->vox_offset != rint(f->vox_offset))
		return esk_error_set(error, ESKEL_MALFORMED,
			"vox_offset is %g, expected a whole number from %d to %.0f", f->vox_offset, least,
			largest_offset);
	*offset = (uint64_t)f->vox_offset;
	return ESKEL_OK;
}

static eskel_status check_pixdim(const fields *f, eskel_error *error)
{
	for (int i = 1; i <= 3; i++)
		if (!(f->pixdim[i] > 0))
			return esk_error_set(error, ESKEL_BAD_GEOMETRY, "pixdim[%d] is %g, expected a positive spacing",
				i, f->pixdim[i]);
	return ESKEL_OK;
}

/* Method 2 of nifti1.h: the unit quaternion (a, b, c, d), a >= 0, turns index axes scaled by pixdim; qfac, pixdim[0],
 * is -1 when the third axis is reversed first. */
static eskel_status qform_affine(const fields *f, eskel_affine *affine, eskel_error *error)
{
	double b = f->quatern[0], c = f->quatern[1], d = f->quatern[2];
	double squared = b * b + c * c + d * d;
	/* Floats of a half turn (a = 0) may sum to a little over 1. */
	if (!(squared < 1.001))
		return esk_error_set(error, ESKEL_BAD_GEOMETRY,
			"the qform's quaternion (%g, %g, %g) has squared length %g, expected at most 1", b, c, d,
			squared);
	eskel_status status = check_pixdim(f, error);
	if (status != ESKEL_OK)
		return status;
	double a = 0;
	if (squared < 1 - 1e-7) {
		a = sqrt(1 - squared);
	} else {
		double length = sqrt(squared);
		b /= length;
		c /= length;
		d /= length;
	}
	const double rotation[3][3] = {
		{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
		{2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
		{2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c},
	};
	for (int r = 0; r < 3; r++) {
		for (int column = 0; column < 3; column++)
			affine->m[r][column] = rotation[r][column] * f->pixdim[column + 1];
		if (f->pixdim[0] < 0)
			affine->m[r][2] = -affine->m[r][2];
		affine->m[r][3] = f->qoffset[r];
	}
	return ESKEL_OK;
}

/* The largest distance between the places that two affines give a voxel. It is a convex function of the index, so it
 * is largest at a corner of the grid. */
static double largest_distance(const eskel_affine *a, const eskel_affine *b, const uint32_t extent[3])
{
	double largest = 0;
	for (int corner = 0; corner < 8; corner++) {
		double index[3], p[3], q[3], squared = 0;
		for (int i = 0; i < 3; i++)
			index[i] = corner >> i & 1 ? extent[i] - 1 : 0;
		esk_affine_apply(a, index, p);
		esk_affine_apply(b, index, q);
		for (int i = 0; i < 3; i++)
			squared += (p[i] - q[i]) * (p[i] - q[i]);
		if (!isfinite(squared))
			return INFINITY;
		largest = fmax(largest, sqrt(squared));
	}
	return largest;
}

static double smallest_spacing(const eskel_affine *a)
{
	double smallest = INFINITY;
	for (int c = 0; c < 3; c++)
		smallest = fmin(
			smallest, sqrt(a->m[0][c] * a->m[0][c] + a->m[1][c] * a->m[1][c] + a->m[2][c] * a->m[2][c]));
	return smallest;
}

static void compare_forms(const fields *f, eskel_volume_info *info)
{
	eskel_affine qform;
	if (qform_affine(f, &qform, NULL) != ESKEL_OK) {
		eskel_volume_warn(info, ESKEL_WARNING_SFORM_QFORM_DISAGREE, "the qform is unusable; the sform is used");
		return;
	}
	double voxels = largest_distance(&info->affine, &qform, info->extent) / smallest_spacing(&info->affine);
	if (!(voxels <= form_tolerance_voxels))
		eskel_volume_warn(info, ESKEL_WARNING_SFORM_QFORM_DISAGREE,
			"the sform and the qform place a corner of the grid %.3g voxels apart; the sform is used",
			voxels);
}

static void convert_unit(int xyzt_units, eskel_volume_info *info)
{
	enum { metre = 1, millimetre = 2, micron = 3 };
	int unit = xyzt_units & 7;
	double factor = unit == metre ? 1000 : unit == micron ? 0.001 : 1;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			info->affine.m[r][c] *= factor;
	if (unit != metre && unit != millimetre && unit != micron)
		eskel_volume_warn(info, ESKEL_WARNING_UNIT_ASSUMED,
			"the unit of length is not recorded (%d); mm is assumed", unit);
}

static eskel_status read_affine(const fields *f, eskel_volume_info *info, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	if (f->sform_code > 0) {
		memcpy(info->affine.m, f->srow, sizeof f->srow);
		if (f->qform_code > 0)
			compare_forms(f, info);
	} else if (f->qform_code > 0) {
		status = qform_affine(f, &info->affine, error);
	} else {
		/* Method 1 of nifti1.h, which says nothing of left and right. */
		status = check_pixdim(f, error);
		for (int a = 0; a < 3; a++)
			info->affine.m[a][a] = f->pixdim[a + 1];
		eskel_volume_warn(info, ESKEL_WARNING_NO_ORIENTATION,
			"the file has neither sform nor qform: its axes are taken as right, front and head, "
			"so left and right may be exchanged");
	}
	if (status != ESKEL_OK)
		return status;
	convert_unit(f->xyzt_units, info);
	return eskel_affine_check(&info->affine, error);
}

/* The bytes of the file, from its first, in which label names are: all before the voxels, if there may be an extension. */
static size_t size_with_names(const fields *f, uint64_t data_offset)
{
	const size_t extension_flag_end = header_size(f) + 4;
	if (data_offset <= extension_flag_end)
		return header_size(f);
	return data_offset < most_name_bytes ? (size_t)data_offset : most_name_bytes;
}

/* A volume is as good without the names of its labels, so what cannot be read of them is no reason to refuse it. */
static eskel_status read_names(source s, const fields *f, size_t size, esk_volume_header *h, eskel_error *error)
{
	const size_t first = header_size(f);
	eskel_status status = esk_nifti_labels_read(s.bytes + first, size - first, s.big_endian, &h->segments);
	if (status == ESKEL_OK && size < h->data_offset && s.bytes[first] != 0)
		status = ESKEL_MALFORMED;
	if (status == ESKEL_MALFORMED) {
		eskel_volume_warn(&h->info, ESKEL_WARNING_NAMES_INCOMPLETE,
			"the header extensions break off, are damaged or go on past %zu bytes; %zu label names were "
			"read",
			most_name_bytes, h->segments.count);
		return ESKEL_OK;
	}
	if (status == ESKEL_OK)
		return status;
	esk_segments_clear(&h->segments);
	return esk_error_set(error, status, "memory ran out for the names of labels");
}

eskel_status esk_nifti_read_header(
	const uint8_t *bytes, size_t size, size_t *needed, esk_volume_header *header, eskel_error *error)
{
	uint64_t little = esk_byte_order_unsigned(bytes, 4, false), big = esk_byte_order_unsigned(bytes, 4, true);
	bool first = little == nifti1_size || big == nifti1_size, second = little == nifti2_size || big == nifti2_size;
	if (!first && !second)
		return ESKEL_NOT_VOLUME;
	*needed = first ? nifti1_size : nifti2_size;
	if (size < *needed)
		return ESKEL_OK;
	source s = {bytes, big == *needed};
	fields f;
	if (first)
		get_nifti1(s, &f);
	else
		get_nifti2(s, &f);
	esk_volume_header h = {
		.info.format = first ? "NIfTI-1" : "NIfTI-2", .layer_count = 1, .voxels.big_endian = s.big_endian};
	eskel_status status = check_magic(&f, bytes, error);
	if (status == ESKEL_OK)
		status = read_extent(&f, h.info.extent, error);
	if (status == ESKEL_OK)
		status = read_datatype(&f, &h.voxels, error);
	if (status == ESKEL_OK)
		status = read_offset(&f, &h.data_offset, error);
	if (status == ESKEL_OK)
		status = read_affine(&f, &h.info, error);
	if (status != ESKEL_OK)
		return status;
	*needed = size_with_names(&f, h.data_offset);
	if (size < *needed)
		return ESKEL_OK;
	if (size > header_size(&f))
		status = read_names(s, &f, size, &h, error);
	if (status == ESKEL_OK)
		*header = h;
	return status;
}
