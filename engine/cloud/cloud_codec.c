/* Clouds as bytes, lossless, typically 3 a run. All numbers little-endian; a varint is LEB128: seven bits a byte from
 * the lowest, the top bit set on every byte but the last.
 *
 *   offset  bytes  what
 *   0       1      version, 1
 *   1       1      1 when weights follow the runs, 0 when every voxel weighs 1
 *   2       96     affine, twelve f64, row by row
 *   98      6      extent, three u16: x, y, z
 *   104     ...    varint number of runs
 *           ...    runs, in their order, three varints each
 *           ...    weights, a varint each, when byte 1 says so
 *
 * Row (y, z) has number y + extent_y z. A run's varints are the number of rows since the run before it, and then
 *   in the same row (0):   the voxels between the two runs, its length less 1;
 *   in a later row:        its x_first and x_last less those of the run before it, zigzag (0, -1, 1, -2 as 0, 1, 2, 3):
 *                          small, because the rows of a smooth object begin and end near those of their neighbours.
 * The first run counts from (0, 0) in row -1.
 *
 * The bytes' digest is the identity of a shape, so one cloud must not have two encodings. Decoding therefore makes the
 * canonical cloud of what it read, encodes that and demands the same bytes.
 */
#include "bytes.h"
#include "error.h"
#include "memory.h"
#include "orientation.h"

#include <stdlib.h>
#include <string.h>

enum { version = 1, affine_offset = 2, extent_offset = 98, header_size = 104 };
enum { varint_size = 5, least_run_size = 3, most_run_size = varint_size + 3 + 3 + 3 /* x_first, x_last, weight */ };

static uint8_t *put_varint(uint8_t *b, uint32_t value)
{
	for (; value >= 0x80; value >>= 7)
		*b++ = (uint8_t)(value | 0x80);
	*b++ = (uint8_t)value;
	return b;
}

static uint32_t zigzag(int32_t value)
{
	return value < 0 ? 2 * (uint32_t)(-(value + 1)) + 1 : 2 * (uint32_t)value;
}

static int64_t unzigzag(uint32_t code)
{
	return code & 1 ? -(int64_t)(code >> 1) - 1 : (int64_t)(code >> 1);
}

static uint8_t *put_header(uint8_t *b, const eskel_cloud *cloud)
{
	b[0] = version;
	b[1] = cloud->weights != NULL;
	for (int i = 0; i < 12; i++)
		esk_bytes_put_f64(b + affine_offset + 8 * i, cloud->affine.m[i / 4][i % 4]);
	for (int a = 0; a < 3; a++)
		esk_bytes_put_u16(b + extent_offset + 2 * a, cloud->extent[a]);
	return put_varint(b + header_size, (uint32_t)cloud->run_count);
}

static uint8_t *put_runs(uint8_t *b, const eskel_cloud *cloud)
{
	int64_t row_before = -1;
	eskel_run before = {0, 0, 0, 0};
	for (size_t i = 0; i < cloud->run_count; i++) {
		eskel_run run = cloud->runs[i];
		int64_t row = run.y + (int64_t)cloud->extent[1] * run.z;
		b = put_varint(b, (uint32_t)(row - row_before));
		if (row == row_before) {
			b = put_varint(b, (uint32_t)(run.x_first - before.x_last - 1));
			b = put_varint(b, (uint32_t)(run.x_last - run.x_first));
		} else {
			b = put_varint(b, zigzag(run.x_first - before.x_first));
			b = put_varint(b, zigzag(run.x_last - before.x_last));
		}
		row_before = row;
		before = run;
	}
	return b;
}

eskel_status eskel_cloud_encode(const eskel_cloud *cloud, uint8_t **bytes, size_t *size)
{
	/* A cloud has at most 2^27 runs, so the product fits. */
	uint8_t *start = esk_memory_array(header_size + varint_size + cloud->run_count * most_run_size, 1);
	if (!start)
		return ESKEL_NO_MEMORY;
	uint8_t *b = put_runs(put_header(start, cloud), cloud);
	if (cloud->weights)
		for (size_t i = 0; i < cloud->run_count; i++)
			b = put_varint(b, cloud->weights[i]);
	size_t used = (size_t)(b - start);
	uint8_t *shrunk = realloc(start, used);
	*bytes = shrunk ? shrunk : start;
	*size = used;
	return ESKEL_OK;
}

/* After a failure every further number reads as 0, and status tells. */
typedef struct {
	const uint8_t *next, *end;
	eskel_status status;
} reader;

static uint32_t get_varint(reader *r)
{
	uint64_t value = 0;
	for (int i = 0; i < varint_size && r->status == ESKEL_OK; i++) {
		if (r->next == r->end) {
			r->status = ESKEL_TRUNCATED;
			break;
		}
		uint8_t byte = *r->next++;
		value |= (uint64_t)(byte & 0x7f) << (7 * i);
		if (!(byte & 0x80) && value <= UINT32_MAX)
			return (uint32_t)value;
	}
	if (r->status == ESKEL_OK)
		r->status = ESKEL_MALFORMED;
	return 0;
}

static bool fits_run(int64_t x_first, int64_t x_last, int64_t row, uint16_t extent_y)
{
	return x_first >= 0 && x_first <= x_last && x_last <= UINT16_MAX && row / extent_y <= UINT16_MAX;
}

static eskel_status get_runs(reader *r, uint16_t extent_y, eskel_run *runs, size_t count)
{
	int64_t row = -1;
	int64_t first = 0, last = 0;
	for (size_t i = 0; i < count; i++) {
		uint32_t step = get_varint(r), a = get_varint(r), b = get_varint(r);
		row += step;
		if (step == 0) {
			first = last + 1 + a;
			last = first + b;
		} else {
			first += unzigzag(a);
			last += unzigzag(b);
		}
		if (r->status != ESKEL_OK)
			return r->status;
		if (row < 0 || !fits_run(first, last, row, extent_y))
			return ESKEL_MALFORMED;
		runs[i] = (eskel_run){
			(uint16_t)first, (uint16_t)last, (uint16_t)(row % extent_y), (uint16_t)(row / extent_y)};
	}
	return ESKEL_OK;
}

static eskel_status read_header(
	const uint8_t *bytes, size_t size, eskel_affine *affine, uint16_t *extent_y, eskel_error *error)
{
	if (size < header_size)
		return esk_error_set(
			error, ESKEL_TRUNCATED, "the cloud has %zu bytes, expected at least %d", size, header_size);
	if (bytes[0] != version)
		return esk_error_set(
			error, ESKEL_MALFORMED, "the cloud has version %d, expected %d", bytes[0], version);
	for (int i = 0; i < 12; i++)
		affine->m[i / 4][i % 4] = esk_bytes_get_f64(bytes + affine_offset + 8 * i);
	/* Another orientation would be turned into this one later, at a cost that the bytes do not bound. */
	if (!esk_orientation_is_canonical(affine))
		return esk_error_set(error, ESKEL_MALFORMED, "the cloud's affine is not canonical");
	*extent_y = esk_bytes_get_u16(bytes + extent_offset + 2);
	if (*extent_y == 0)
		return esk_error_set(error, ESKEL_MALFORMED, "the cloud's extent along y is 0");
	return ESKEL_OK;
}

/* Made of whatever was read, so it may differ from what the bytes said. */
static eskel_status read_cloud(const uint8_t *bytes, size_t size, eskel_cloud **cloud, eskel_error *error)
{
	eskel_affine affine;
	uint16_t extent_y;
	eskel_status status = read_header(bytes, size, &affine, &extent_y, error);
	if (status != ESKEL_OK)
		return status;
	reader r = {bytes + header_size, bytes + size, ESKEL_OK};
	uint32_t count = get_varint(&r);
	if (count > (size_t)(r.end - r.next) / least_run_size)
		r.status = ESKEL_TRUNCATED;
	if (r.status != ESKEL_OK)
		return esk_error_set(error, r.status, "the cloud's %u runs do not fit in its %zu bytes", count, size);
	eskel_run *runs = esk_memory_array(count, sizeof *runs);
	uint32_t *weights = bytes[1] ? esk_memory_array(count, sizeof *weights) : NULL;
	status = ESKEL_NO_MEMORY;
	if (!runs || (bytes[1] && !weights)) {
		esk_error_set(error, status, "memory ran out for %u runs", count);
		goto done;
	}
	status = get_runs(&r, extent_y, runs, count);
	for (size_t i = 0; weights && i < count; i++)
		weights[i] = get_varint(&r);
	if (status == ESKEL_OK)
		status = r.status;
	if (status != ESKEL_OK)
		esk_error_set(error, status, "the cloud's runs break off or leave the grid");
	else
		status = eskel_cloud_new(runs, weights, count, &affine, cloud, error);
done:
	free(runs);
	free(weights);
	return status;
}

static eskel_status check_canonical(const eskel_cloud *cloud, const uint8_t *bytes, size_t size, eskel_error *error)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	eskel_status status = eskel_cloud_encode(cloud, &again, &again_size);
	if (status != ESKEL_OK)
		return esk_error_set(error, status, "memory ran out for a cloud of %zu bytes", size);
	if (again_size != size || memcmp(again, bytes, size) != 0)
		status = esk_error_set(
			error, ESKEL_MALFORMED, "the cloud's %zu bytes are not a canonical encoding", size);
	free(again);
	return status;
}

eskel_status eskel_cloud_decode(const uint8_t *bytes, size_t size, eskel_cloud **cloud, eskel_error *error)
{
	eskel_cloud *read = NULL;
	eskel_status status = read_cloud(bytes, size, &read, error);
	if (status == ESKEL_OK)
		status = check_canonical(read, bytes, size, error);
	/* Runs that overlap, an unusable affine and so on are, here, bytes that no encode made. */
	if (status == ESKEL_INVALID || status == ESKEL_EMPTY || status == ESKEL_BAD_GEOMETRY) {
		status = ESKEL_MALFORMED;
		if (error)
			error->status = status;
	}
	if (status == ESKEL_OK)
		*cloud = read;
	else
		eskel_cloud_free(read);
	return status;
}
