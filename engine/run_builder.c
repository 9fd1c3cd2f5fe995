/* Voxels in file order, turned into runs per label.
 *
 * Nearly all voxels equal their neighbour. So the bytes are scanned for the end of a stretch of equal stored voxels,
 * 64 bytes a step and whatever the datatype, because equal bytes mean equal labels; only then is one stored voxel of
 * the stretch decoded and its label looked up. Background runs on through the ends of rows and slices. Different bytes
 * may mean one label too (0.0 and -0.0), and a stretch breaks where the caller's piece ends: a run that continues the
 * label's last one is therefore joined to it.
 */
#include "run_builder.h"

#include "byte_order.h"
#include "bytes.h"
#include "error.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

struct esk_run_builder {
	esk_voxel_format format;
	uint32_t extent[3];
	uint32_t x, y, z; /* of the next voxel */
	esk_run_limits limits;
	esk_label_table table;
	bool only_listed; /* the table holds the wanted labels, others are dropped */
	size_t last;      /* place in the table of the label found last */
	size_t run_count;
};

/* The place of label in the table, or the place where it belongs. */
static size_t lower_bound(const esk_label_table *table, int32_t label)
{
	size_t low = 0, high = table->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (table->items[middle].label < label)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

const esk_label_runs *esk_label_table_find(const esk_label_table *table, int32_t label)
{
	size_t place = lower_bound(table, label);
	return place < table->count && table->items[place].label == label ? &table->items[place] : NULL;
}

static eskel_status insert_label(esk_label_table *table, size_t place, int32_t label)
{
	void *items = table->items;
	if (!esk_memory_reserve(&items, &table->capacity, table->count + 1, sizeof table->items[0]))
		return ESKEL_NO_MEMORY;
	table->items = items;
	esk_label_runs *at = table->items + place;
	memmove(at + 1, at, (table->count - place) * sizeof *at);
	*at = (esk_label_runs){.label = label};
	table->count++;
	return ESKEL_OK;
}

eskel_status esk_run_builder_new(
	const esk_run_limits *limits, const int32_t *labels, size_t label_count, esk_run_builder **builder)
{
	esk_run_builder *b = esk_memory_zeroed_array(1, sizeof *b);
	if (!b)
		return ESKEL_NO_MEMORY;
	b->limits = *limits;
	b->only_listed = label_count > 0;
	for (size_t i = 0; i < label_count; i++) {
		if (esk_label_table_find(&b->table, labels[i]))
			continue;
		if (insert_label(&b->table, lower_bound(&b->table, labels[i]), labels[i]) != ESKEL_OK) {
			esk_run_builder_free(b);
			return ESKEL_NO_MEMORY;
		}
	}
	*builder = b;
	return ESKEL_OK;
}

void esk_run_builder_free(esk_run_builder *builder)
{
	if (!builder)
		return;
	for (size_t i = 0; i < builder->table.count; i++)
		free(builder->table.items[i].runs);
	free(builder->table.items);
	free(builder);
}

void esk_run_builder_set_grid(esk_run_builder *builder, const esk_voxel_format *format, const uint32_t extent[3])
{
	builder->format = *format;
	memcpy(builder->extent, extent, sizeof builder->extent);
}

/* Not 0 when any of 32 bytes differs from the pattern. */
static uint64_t difference(const uint8_t *b, uint64_t pattern)
{
	return (esk_bytes_get_u64(b) ^ pattern) | (esk_bytes_get_u64(b + 8) ^ pattern) |
	       (esk_bytes_get_u64(b + 16) ^ pattern) | (esk_bytes_get_u64(b + 24) ^ pattern);
}

/* How many of the first size bytes repeat the first voxel, in whole voxels. voxel_size is 1, 2, 4 or 8. */
static size_t equal_bytes(const uint8_t *bytes, size_t size, unsigned voxel_size)
{
	uint64_t pattern = esk_byte_order_unsigned(bytes, voxel_size, false);
	for (unsigned bits = 8 * voxel_size; bits < 64; bits *= 2)
		pattern |= pattern << bits;
	const size_t whole_voxels = ~(size_t)(voxel_size - 1); /* rounds down */
	size_t n = voxel_size;
	while (size - n >= 64 && (difference(bytes + n, pattern) | difference(bytes + n + 32, pattern)) == 0)
		n += 64;
	for (; size - n >= 8; n += 8) {
		uint64_t differing = esk_bytes_get_u64(bytes + n) ^ pattern;
		if (differing != 0) {
			n += (unsigned)__builtin_ctzll(differing) / 8; /* the lowest bits are the first byte */
			return n & whole_voxels;
		}
	}
	while (n < size && bytes[n] == bytes[n - voxel_size])
		n++;
	return n & whole_voxels;
}

/* The runs of a label; NULL in *found when it is not wanted. */
static eskel_status find_label(esk_run_builder *b, int32_t label, esk_label_runs **found, eskel_error *error)
{
	esk_label_table *table = &b->table;
	if (b->last >= table->count || table->items[b->last].label != label) {
		size_t place = lower_bound(table, label);
		bool known = place < table->count && table->items[place].label == label;
		if (!known && b->only_listed) {
			*found = NULL;
			return ESKEL_OK;
		}
		if (!known && table->count == b->limits.most_labels)
			return esk_error_set(error, ESKEL_TOO_LARGE,
				"the volume has more than %u labels: is it an image rather than a label map?",
				b->limits.most_labels);
		if (!known && insert_label(table, place, label) != ESKEL_OK)
			return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu labels", table->count + 1);
		b->last = place;
	}
	*found = &table->items[b->last];
	return ESKEL_OK;
}

static eskel_status add_run(esk_run_builder *b, esk_label_runs *label, eskel_run run, eskel_error *error)
{
	eskel_run *last = label->count ? &label->runs[label->count - 1] : NULL;
	if (last && last->z == run.z && last->y == run.y && last->x_last + 1 == run.x_first) {
		last->x_last = run.x_last;
		return ESKEL_OK;
	}
	if (b->run_count == b->limits.most_runs)
		return esk_error_set(
			error, ESKEL_TOO_LARGE, "the labels have more than %zu runs of voxels", b->limits.most_runs);
	void *runs = label->runs;
	if (!esk_memory_reserve(&runs, &label->capacity, label->count + 1, sizeof run))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu runs", b->run_count + 1);
	label->runs = runs;
	label->runs[label->count++] = run;
	b->run_count++;
	return ESKEL_OK;
}

static void advance(esk_run_builder *b, size_t voxels)
{
	size_t x = b->x + voxels;
	if (x < b->extent[0]) {
		b->x = (uint32_t)x;
		return;
	}
	size_t y = b->y + x / b->extent[0];
	b->x = (uint32_t)(x % b->extent[0]);
	b->y = (uint32_t)(y % b->extent[1]);
	b->z += (uint32_t)(y / b->extent[1]);
}

/* The next count voxels have this label: one run for each row that they reach into. */
static eskel_status add_stretch(esk_run_builder *b, int32_t label, size_t count, eskel_error *error)
{
	esk_label_runs *runs = NULL;
	eskel_status status = ESKEL_OK;
	if (label != 0)
		status = find_label(b, label, &runs, error);
	if (status != ESKEL_OK || !runs) {
		advance(b, count);
		return status;
	}
	while (count > 0 && status == ESKEL_OK) {
		size_t rest_of_row = b->extent[0] - b->x;
		size_t length = count < rest_of_row ? count : rest_of_row;
		eskel_run run = {(uint16_t)b->x, (uint16_t)(b->x + length - 1), (uint16_t)b->y, (uint16_t)b->z};
		status = add_run(b, runs, run, error);
		advance(b, length);
		count -= length;
	}
	return status;
}

eskel_status esk_run_builder_add(esk_run_builder *builder, const uint8_t *voxels, size_t count, eskel_error *error)
{
	const unsigned voxel_size = builder->format.size;
	const uint8_t *end = voxels + count * voxel_size;
	while (voxels < end) {
		int32_t label;
		double value;
		if (!esk_voxel_label(&builder->format, voxels, &label, &value))
			return esk_error_set(error, ESKEL_BAD_VALUE,
				"voxel (%u, %u, %u) is %.10g, expected an integer between -2^31 and 2^31", builder->x,
				builder->y, builder->z, value);
		size_t bytes = equal_bytes(voxels, (size_t)(end - voxels), voxel_size);
		eskel_status status = add_stretch(builder, label, bytes / voxel_size, error);
		if (status != ESKEL_OK)
			return status;
		voxels += bytes;
	}
	return ESKEL_OK;
}

const esk_label_table *esk_run_builder_finish(esk_run_builder *builder)
{
	esk_label_table *table = &builder->table;
	size_t kept = 0;
	for (size_t i = 0; i < table->count; i++)
		if (table->items[i].count > 0)
			table->items[kept++] = table->items[i]; /* a listed label without voxels has nothing to free */
	table->count = kept;
	return table;
}
