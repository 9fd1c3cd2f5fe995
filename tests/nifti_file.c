#include "nifti_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void put(uint8_t *b, unsigned size, bool big_endian, uint64_t value)
{
	for (unsigned i = 0; i < size; i++)
		b[big_endian ? size - 1 - i : i] = (uint8_t)(value >> (8 * i));
}

static void put_float(uint8_t *b, unsigned size, bool big_endian, double value)
{
	uint64_t bits = 0;
	uint32_t bits32;
	float narrow = (float)value;
	memcpy(&bits, &value, sizeof bits);
	memcpy(&bits32, &narrow, sizeof bits32);
	put(b, size, big_endian, size == 4 ? bits32 : bits);
}

static bool is_float(int datatype)
{
	return datatype == 16 || datatype == 64;
}

static int bits_of(int datatype)
{
	switch (datatype) {
	case 2:
	case 256:
		return 8;
	case 4:
	case 512:
		return 16;
	case 8:
	case 16:
	case 768:
		return 32;
	default:
		return 64;
	}
}

nifti_file nifti_file_new(int version, bool big_endian, int datatype, int nx, int ny, int nz)
{
	nifti_file f = {
		.version = version,
		.big_endian = big_endian,
		.datatype = datatype,
		.bitpix = bits_of(datatype),
		.dim = {3, nx, ny, nz, 1, 1, 1, 1},
		.pixdim = {1, 1, 1, 1, 1, 1, 1, 1},
		.vox_offset = version == 1 ? 352 : 544,
		.sform_code = 1,
		.units = 2,
		.srow = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
	};
	return f;
}

/* Where the fields are: {NIfTI-1, NIfTI-2}. */
typedef struct {
	size_t at[2];
	unsigned size[2];
} place;

static const place at_dim = {{40, 16}, {2, 8}}, at_pixdim = {{76, 104}, {4, 8}}, at_slope = {{112, 176}, {4, 8}},
		   at_inter = {{116, 184}, {4, 8}}, at_datatype = {{70, 12}, {2, 2}}, at_bitpix = {{72, 14}, {2, 2}},
		   at_units = {{123, 500}, {1, 4}}, at_qform = {{252, 344}, {2, 4}}, at_sform = {{254, 348}, {2, 4}},
		   at_quatern = {{256, 352}, {4, 8}}, at_qoffset = {{268, 376}, {4, 8}}, at_srow = {{280, 400}, {4, 8}};

static void put_integers(uint8_t *b, const nifti_file *f, place p, size_t count, const int64_t *values)
{
	int v = f->version - 1;
	for (size_t i = 0; i < count; i++)
		put(b + p.at[v] + i * p.size[v], p.size[v], f->big_endian, (uint64_t)values[i]);
}

static void put_floats(uint8_t *b, const nifti_file *f, place p, size_t count, const double *values)
{
	int v = f->version - 1;
	for (size_t i = 0; i < count; i++)
		put_float(b + p.at[v] + i * p.size[v], p.size[v], f->big_endian, values[i]);
}

static void put_header(uint8_t *b, const nifti_file *f)
{
	const int64_t datatype = f->datatype, bitpix = f->bitpix, units = f->units;
	const int64_t qform = f->qform_code, sform = f->sform_code;
	put(b, 4, f->big_endian, f->version == 1 ? 348 : 540);
	if (f->version == 1) {
		memcpy(b + 344, "n+1", 4);
		put_float(b + 108, 4, f->big_endian, f->vox_offset);
	} else {
		memcpy(b + 4, "n+2\0\r\n\032\n", 8);
		put(b + 168, 8, f->big_endian, (uint64_t)(int64_t)f->vox_offset);
	}
	put_integers(b, f, at_dim, 8, f->dim);
	put_integers(b, f, at_datatype, 1, &datatype);
	put_integers(b, f, at_bitpix, 1, &bitpix);
	put_integers(b, f, at_units, 1, &units);
	put_integers(b, f, at_qform, 1, &qform);
	put_integers(b, f, at_sform, 1, &sform);
	put_floats(b, f, at_pixdim, 8, f->pixdim);
	put_floats(b, f, at_slope, 1, &f->slope);
	put_floats(b, f, at_inter, 1, &f->inter);
	put_floats(b, f, at_quatern, 3, f->quatern);
	put_floats(b, f, at_qoffset, 3, f->qoffset);
	put_floats(b, f, at_srow, 12, f->srow[0]);
}

uint8_t *nifti_file_write(const nifti_file *file, const double *values, size_t count, size_t *size)
{
	size_t offset = (size_t)file->vox_offset, voxel = (size_t)bits_of(file->datatype) / 8;
	*size = offset + count * voxel;
	uint8_t *b = calloc(*size, 1);
	if (!b)
		abort();
	put_header(b, file);
	for (size_t i = 0; i < count; i++) {
		uint8_t *at = b + offset + i * voxel;
		if (is_float(file->datatype))
			put_float(at, (unsigned)voxel, file->big_endian, values[i]);
		else
			put(at, (unsigned)voxel, file->big_endian, (uint64_t)(int64_t)values[i]);
	}
	return b;
}

uint8_t *nifti_file_gzip(const uint8_t *bytes, size_t size, size_t *gzip_size)
{
	z_stream z = {0};
	if (deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
		abort();
	size_t bound = deflateBound(&z, size);
	uint8_t *out = malloc(bound);
	if (!out)
		abort();
	z.next_in = (z_const Bytef *)bytes;
	z.avail_in = (uInt)size;
	z.next_out = out;
	z.avail_out = (uInt)bound;
	if (deflate(&z, Z_FINISH) != Z_STREAM_END)
		abort();
	*gzip_size = z.total_out;
	deflateEnd(&z);
	return out;
}
