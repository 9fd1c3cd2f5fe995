/* NIfTI files made in memory for tests, field by field, so that any of them can be wrong. */
#ifndef NIFTI_FILE_H
#define NIFTI_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
	int version; /* 1 or 2 */
	bool big_endian;
	int datatype, bitpix;
	int64_t dim[8];
	double pixdim[8], vox_offset, slope, inter;
	int qform_code, sform_code, units;
	double quatern[3], qoffset[3], srow[3][4];
} nifti_file;

/* A single file of version 1 or 2 with an identity sform in mm. */
nifti_file nifti_file_new(int version, bool big_endian, int datatype, int nx, int ny, int nz);

/* The header, zeros up to vox_offset, and the values stored as datatype. free() the bytes. */
uint8_t *nifti_file_write(const nifti_file *file, const double *values, size_t count, size_t *size);

/* The bytes as one gzip member. free() them. */
uint8_t *nifti_file_gzip(const uint8_t *bytes, size_t size, size_t *gzip_size);

#endif
