/* The headers of the NIfTI files that are written: little-endian single files with an sform in mm and no qform, which
 * could not hold a sheared grid. The fields are those that nifti.c reads, at the same places. */
#include "bytes.h"
#include "volume_writer.h"

#include <math.h>
#include <string.h>

/* Four bytes after the header say that no extension follows. */
enum { nifti1_offset = 348 + 4, nifti2_offset = 540 + 4, longest_nifti1_axis = INT16_MAX };
enum { uint8_code = 2, int16_code = 4, int32_code = 8, scanner_code = 1, millimetre = 2 };

static unsigned datatype(const esk_volume_grid *grid)
{
	return grid->voxel_size == 1 ? uint8_code : grid->voxel_size == 2 ? int16_code : int32_code;
}

static double spacing(const esk_volume_grid *grid, int axis)
{
	double squared = 0;
	for (int r = 0; r < 3; r++)
		squared += grid->affine.m[r][axis] * grid->affine.m[r][axis];
	return sqrt(squared);
}

static bool fits_nifti1(const esk_volume_grid *grid)
{
	for (int r = 0; r < 3; r++) {
		if (grid->extent[r] > longest_nifti1_axis)
			return false;
		for (int c = 0; c < 4; c++)
			if ((double)(float)grid->affine.m[r][c] != grid->affine.m[r][c])
				return false;
	}
	return true;
}

static size_t write_nifti1(const esk_volume_grid *grid, uint8_t *head)
{
	esk_bytes_put_u32(head, 348);
	esk_bytes_put_u16(head + 40, 3);
	esk_bytes_put_f32(head + 76, 1);
	for (int a = 0; a < 7; a++) {
		esk_bytes_put_u16(head + 42 + 2 * a, a < 3 ? (uint16_t)grid->extent[a] : 1);
		esk_bytes_put_f32(head + 80 + 4 * a, a < 3 ? (float)spacing(grid, a) : 1);
	}
	esk_bytes_put_u16(head + 70, (uint16_t)datatype(grid));
	esk_bytes_put_u16(head + 72, (uint16_t)(8 * grid->voxel_size));
	esk_bytes_put_f32(head + 108, nifti1_offset);
	esk_bytes_put_f32(head + 112, 1); /* scl_slope */
	head[123] = millimetre;
	esk_bytes_put_u16(head + 254, scanner_code);
	for (int i = 0; i < 12; i++)
		esk_bytes_put_f32(head + 280 + 4 * i, (float)grid->affine.m[i / 4][i % 4]);
	memcpy(head + 344, "n+1", 4);
	return nifti1_offset;
}

static size_t write_nifti2(const esk_volume_grid *grid, uint8_t *head)
{
	esk_bytes_put_u32(head, 540);
	memcpy(head + 4, "n+2\0\r\n\032\n", 8);
	esk_bytes_put_u16(head + 12, (uint16_t)datatype(grid));
	esk_bytes_put_u16(head + 14, (uint16_t)(8 * grid->voxel_size));
	esk_bytes_put_u64(head + 16, 3);
	esk_bytes_put_f64(head + 104, 1);
	for (int a = 0; a < 7; a++) {
		esk_bytes_put_u64(head + 24 + 8 * a, a < 3 ? grid->extent[a] : 1);
		esk_bytes_put_f64(head + 112 + 8 * a, a < 3 ? spacing(grid, a) : 1);
	}
	esk_bytes_put_u64(head + 168, nifti2_offset);
	esk_bytes_put_f64(head + 176, 1); /* scl_slope */
	esk_bytes_put_u32(head + 348, scanner_code);
	for (int i = 0; i < 12; i++)
		esk_bytes_put_f64(head + 400 + 8 * i, grid->affine.m[i / 4][i % 4]);
	esk_bytes_put_u32(head + 500, millimetre);
	return nifti2_offset;
}

size_t esk_nifti_write_head(const esk_volume_grid *grid, uint8_t head[ESK_VOLUME_HEAD_MOST])
{
	memset(head, 0, ESK_VOLUME_HEAD_MOST);
	return fits_nifti1(grid) ? write_nifti1(grid, head) : write_nifti2(grid, head);
}
