/* Skeletons as bytes, for the store. Numbers are little-endian, doubles their IEEE 754 bits, so the round trip is exact.
 *
 *	offset     bytes  what
 *	0          1      version, 1
 *	1          1      metric: 0 Euclidean, 1 Mahalanobis
 *	2          1      1 when the coarse cloud gave the starts, else 0
 *	3          1      K, the number of levels, 1 to 64
 *	4          8      volume, double
 *	12         18 K   levels: split class (1 byte, 255 at level 1), degenerate (1 byte), split ratio and intraclass
 *	                  ratio (doubles)
 *	12 + 18 K  88 n   n = K (K + 1) / 2 nodes, level by level: voxels (8 bytes), weight, centre x y z, covariance
 *	                  xx xy xz yy yz zz (doubles)
 *
 * Eigenvalues, axes, rho, parents and the level of 5 % follow from these (tree.h) and are not stored. */
#include "bytes.h"
#include "error.h"
#include "memory.h"
#include "tree.h"

#include <math.h>
#include <stdlib.h>

enum { VERSION = 1, HEADER = 12, LEVEL = 18, NODE = 88, NO_CLASS = 255 };

static const struct {
	int row, column;
} upper[6] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

static size_t encoded_size(uint32_t levels)
{
	return HEADER + LEVEL * (size_t)levels + NODE * ESKEL_NODES(levels);
}

static void put_node(uint8_t *b, const eskel_node *node)
{
	esk_bytes_put_u64(b, node->voxels);
	esk_bytes_put_f64(b + 8, node->weight);
	for (int i = 0; i < 3; i++)
		esk_bytes_put_f64(b + 16 + 8 * i, node->centre[i]);
	for (int i = 0; i < 6; i++)
		esk_bytes_put_f64(b + 40 + 8 * i, node->covariance[upper[i].row][upper[i].column]);
}

static void get_node(const uint8_t *b, eskel_node *node)
{
	node->voxels = esk_bytes_get_u64(b);
	node->weight = esk_bytes_get_f64(b + 8);
	for (int i = 0; i < 3; i++)
		node->centre[i] = esk_bytes_get_f64(b + 16 + 8 * i);
	for (int i = 0; i < 6; i++) {
		double value = esk_bytes_get_f64(b + 40 + 8 * i);
		node->covariance[upper[i].row][upper[i].column] = value;
		node->covariance[upper[i].column][upper[i].row] = value;
	}
}

static void put_level(uint8_t *b, const eskel_level *level)
{
	b[0] = level->split_class < 0 ? NO_CLASS : (uint8_t)level->split_class;
	b[1] = level->degenerate;
	esk_bytes_put_f64(b + 2, level->split_ratio);
	esk_bytes_put_f64(b + 10, level->intraclass_ratio);
}

static void get_level(const uint8_t *b, eskel_level *level)
{
	level->split_class = b[0] == NO_CLASS ? -1 : b[0];
	level->degenerate = b[1] != 0;
	level->split_ratio = esk_bytes_get_f64(b + 2);
	level->intraclass_ratio = esk_bytes_get_f64(b + 10);
}

eskel_status eskel_skeleton_encode(const eskel_skeleton *skeleton, uint8_t **bytes, size_t *size)
{
	const size_t total = encoded_size(skeleton->level_count);
	uint8_t *out = esk_memory_array(total, 1);
	if (!out)
		return ESKEL_NO_MEMORY;
	out[0] = VERSION;
	out[1] = (uint8_t)skeleton->metric;
	out[2] = skeleton->coarse_start;
	out[3] = (uint8_t)skeleton->level_count;
	esk_bytes_put_f64(out + 4, skeleton->volume);
	uint8_t *b = out + HEADER;
	for (uint32_t k = 0; k < skeleton->level_count; k++, b += LEVEL)
		put_level(b, &skeleton->levels[k]);
	for (size_t n = 0; n < ESKEL_NODES(skeleton->level_count); n++, b += NODE)
		put_node(b, &skeleton->nodes[n]);
	*bytes = out;
	*size = total;
	return ESKEL_OK;
}

static bool is_ratio(double value)
{
	return value >= 0 && value <= 1 + 1e-9; /* also refuses NaN */
}

static bool is_level(const uint8_t *b, uint32_t k)
{
	eskel_level level;
	get_level(b, &level);
	bool split_fits = k == 1 ? b[0] == NO_CLASS && b[1] == 0 && level.split_ratio == 0 : (uint32_t)b[0] + 1 < k;
	return split_fits && b[1] <= 1 && is_ratio(level.split_ratio) && is_ratio(level.intraclass_ratio);
}

static bool is_node(const eskel_node *node)
{
	bool good = node->voxels > 0 && node->weight > 0 && isfinite(node->weight);
	for (int i = 0; i < 3; i++)
		good = good && isfinite(node->centre[i]) && node->covariance[i][i] >= 0;
	return good; /* deriving the eigenvalues refuses a covariance that is not finite */
}

static eskel_status check_header(const uint8_t *bytes, size_t size, eskel_error *error)
{
	if (size < HEADER)
		return esk_error_set(
			error, ESKEL_TRUNCATED, "a skeleton has %zu bytes, expected at least %d", size, HEADER);
	if (bytes[0] != VERSION)
		return esk_error_set(
			error, ESKEL_UNSUPPORTED, "a skeleton has version %d, expected %d", bytes[0], VERSION);
	if (bytes[1] > ESKEL_PARTITION_MAHALANOBIS || bytes[2] > 1)
		return esk_error_set(error, ESKEL_MALFORMED, "a skeleton has the options %d and %d, expected 0 or 1",
			bytes[1], bytes[2]);
	if (bytes[3] < 1 || bytes[3] > ESKEL_LEVELS_MAX)
		return esk_error_set(error, ESKEL_MALFORMED, "a skeleton has %d levels, expected 1 to %d", bytes[3],
			ESKEL_LEVELS_MAX);
	if (size != encoded_size(bytes[3]))
		return esk_error_set(error, size < encoded_size(bytes[3]) ? ESKEL_TRUNCATED : ESKEL_MALFORMED,
			"a skeleton of %d levels has %zu bytes, expected %zu", bytes[3], size, encoded_size(bytes[3]));
	double volume = esk_bytes_get_f64(bytes + 4);
	if (!(volume > 0 && isfinite(volume)))
		return esk_error_set(
			error, ESKEL_MALFORMED, "a skeleton has the volume %g, expected more than 0", volume);
	return ESKEL_OK;
}

/* Every level holds all voxels. */
static eskel_status get_body(const uint8_t *b, eskel_skeleton *skeleton, eskel_error *error)
{
	for (uint32_t k = 1; k <= skeleton->level_count; k++, b += LEVEL) {
		if (!is_level(b, k))
			return esk_error_set(error, ESKEL_MALFORMED, "level %u of a skeleton is out of range", k);
		get_level(b, &skeleton->levels[k - 1]);
	}
	eskel_node *node = skeleton->nodes;
	for (uint32_t k = 1; k <= skeleton->level_count; k++) {
		uint64_t left = skeleton->nodes->voxels;
		for (uint32_t c = 0; c < k; c++, b += NODE, node++) {
			get_node(b, node);
			if (k == 1)
				left = node->voxels;
			if (!is_node(node) || node->voxels > left)
				return esk_error_set(error, ESKEL_MALFORMED,
					"class %u of level %u of a skeleton is out of range", c, k);
			left -= node->voxels;
		}
		if (left)
			return esk_error_set(error, ESKEL_MALFORMED, "level %u of a skeleton lacks %llu voxels", k,
				(unsigned long long)left);
	}
	if (esk_tree_derive(skeleton))
		return esk_error_set(error, ESKEL_MALFORMED, "a node of a skeleton is not finite");
	return ESKEL_OK;
}

eskel_status eskel_skeleton_decode(const uint8_t *bytes, size_t size, eskel_skeleton **skeleton, eskel_error *error)
{
	eskel_skeleton *made = NULL;
	eskel_status status = check_header(bytes, size, error);
	if (status)
		return status;
	if (esk_tree_new(bytes[3], &made))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a skeleton of %d levels", bytes[3]);
	made->metric = bytes[1] ? ESKEL_PARTITION_MAHALANOBIS : ESKEL_PARTITION_EUCLIDEAN;
	made->coarse_start = bytes[2] != 0;
	made->volume = esk_bytes_get_f64(bytes + 4);
	status = get_body(bytes + HEADER, made, error);
	if (status) {
		eskel_skeleton_free(made);
		return status;
	}
	*skeleton = made;
	return ESKEL_OK;
}
