/* Voxels in file order, turned into runs per label.
 *
 * Nearly all voxels equal their neighbour. So the bytes are scanned for the places where voxels change (changes.h),
 * whatever the datatype, because equal bytes mean equal labels, and of each stretch between two changes one voxel is
 * decoded. What a stored voxel means is remembered: volumes have few labels. Background runs on through the ends of rows
 * and slices. Different bytes may mean one label too (0.0 and -0.0), and a stretch breaks where the caller's piece ends:
 * a run that continues the label's last one is therefore joined to it.
 */
#include "run_builder.h"

#include "changes.h"
#include "error.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

/* Bytes are scanned in pieces whose changes fit in the first-level cache, even when all voxels differ. */
enum { piece_size = 1 << 13 };

/* Room for the labels of an atlas, so that few share a slot. */
enum { meaning_bits = 10, meaning_count = 1 << meaning_bits };
static const uint32_t no_place = UINT32_MAX; /* background and labels that are not wanted */

/* What a stored voxel means. */
typedef struct {
	uint64_t stored; /* the voxel's bytes, as a number */
	uint32_t place;  /* of its label in the table */
	bool known;
} meaning;

struct esk_run_builder {
	esk_voxel_format format;
	uint32_t extent[3];
	uint32_t x, y, z; /* of the next voxel */
	esk_run_limits limits;
	esk_label_table table;
	bool only_listed; /* the table holds the wanted labels, others are dropped */
	size_t run_count;
	meaning meanings[meaning_count]; /* by hash; a new label, which moves others in the table, empties them */
	uint16_t changes[piece_size];
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

eskel_status esk_run_builder_new_share(const esk_run_builder *whole, size_t parts, const int32_t *labels,
	size_t label_count, esk_run_builder **builder)
{
	const size_t share = whole->limits.most_runs / parts;
	const esk_run_limits limits = {share > 0 ? share : 1, whole->limits.most_labels};
	return esk_run_builder_new(&limits, labels, label_count, builder);
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

/* The place of a label in the table; no_place when it is not wanted. */
static eskel_status find_label(esk_run_builder *b, int32_t label, uint32_t *found, eskel_error *error)
{
	esk_label_table *table = &b->table;
	size_t place = lower_bound(table, label);
	bool known = place < table->count && table->items[place].label == label;
	if (label == 0 || (!known && b->only_listed)) {
		*found = no_place;
		return ESKEL_OK;
	}
	if (!known && table->count == b->limits.most_labels)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the volume has more than %u labels: is it an image rather than a label map?",
			b->limits.most_labels);
	if (!known && insert_label(table, place, label) != ESKEL_OK)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu labels", table->count + 1);
	if (!known)
		memset(b->meanings, 0, sizeof b->meanings);
	*found = (uint32_t)place;
	return ESKEL_OK;
}

static eskel_status decode(esk_run_builder *b, const uint8_t *voxel, uint32_t *place, eskel_error *error)
{
	int32_t label;
	double value;
	if (!esk_voxel_label(&b->format, voxel, &label, &value))
		return esk_error_set(error, ESKEL_BAD_VALUE,
			"voxel (%u, %u, %u) is %.10g, expected an integer between -2^31 and 2^31", b->x, b->y, b->z,
			value);
	return find_label(b, label, place, error);
}

/* The bytes of a voxel as a number, in whichever order. */
static uint64_t stored_bits(const uint8_t *voxel, unsigned size)
{
	uint64_t bits = 0;
	switch (size) {
	case 1:
		return voxel[0];
	case 2:
		memcpy(&bits, voxel, 2);
		return bits;
	case 4:
		memcpy(&bits, voxel, 4);
		return bits;
	default:
		memcpy(&bits, voxel, 8);
		return bits;
	}
}

/* The place of the voxel's label in the table; no_place when the voxel is background or its label not wanted. */
static eskel_status look_up(esk_run_builder *b, const uint8_t *voxel, uint32_t *place, eskel_error *error)
{
	uint64_t stored = stored_bits(voxel, b->format.size);
	/* Multiplying by 2^64 over the golden ratio spreads numbers that follow one another, and what differs in any bit. */
	meaning *m = &b->meanings[stored * 0x9e3779b97f4a7c15 >> (64 - meaning_bits)];
	if (!m->known || m->stored != stored) {
		eskel_status status = decode(b, voxel, place, error);
		if (status == ESKEL_OK)
			*m = (meaning){stored, *place, true};
		return status;
	}
	*place = m->place;
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

/* The next count voxels are like this one: one run for each row that they reach into. */
static eskel_status add_stretch(esk_run_builder *b, const uint8_t *voxel, size_t count, eskel_error *error)
{
	uint32_t place;
	eskel_status status = look_up(b, voxel, &place, error);
	if (status != ESKEL_OK)
		return status;
	if (place == no_place) {
		advance(b, count);
		return ESKEL_OK;
	}
	while (count > 0) {
		size_t rest_of_row = b->extent[0] - b->x;
		size_t length = count < rest_of_row ? count : rest_of_row;
		eskel_run run = {(uint16_t)b->x, (uint16_t)(b->x + length - 1), (uint16_t)b->y, (uint16_t)b->z};
		status = add_run(b, &b->table.items[place], run, error);
		if (status != ESKEL_OK)
			return status;
		advance(b, length);
		count -= length;
	}
	return ESKEL_OK;
}

eskel_status esk_run_builder_add(esk_run_builder *b, const uint8_t *voxels, size_t count, eskel_error *error)
{
	const unsigned size = b->format.size, bits = (unsigned)__builtin_ctz(size); /* a shift divides by the size */
	const size_t end = count * size;
	size_t begin = 0; /* of the stretch */
	eskel_status status = ESKEL_OK;
	for (size_t piece = size; piece < end && status == ESKEL_OK; piece += piece_size) {
		size_t length = end - piece < piece_size ? end - piece : piece_size;
		size_t changes = esk_changes_find(voxels + piece, length, size, b->changes);
		for (size_t i = 0; i < changes && status == ESKEL_OK; i++) {
			size_t change = piece + b->changes[i];
			status = add_stretch(b, voxels + begin, (change - begin) >> bits, error);
			begin = change;
		}
	}
	if (status == ESKEL_OK && begin < end)
		status = add_stretch(b, voxels + begin, (end - begin) >> bits, error);
	return status;
}

eskel_status esk_run_builder_add_run(esk_run_builder *builder, int32_t label, eskel_run run, eskel_error *error)
{
	uint32_t place;
	eskel_status status = find_label(builder, label, &place, error);
	if (status != ESKEL_OK || place == no_place)
		return status;
	return add_run(builder, &builder->table.items[place], run, error);
}

bool esk_run_builder_wants(const esk_run_builder *builder, int32_t label)
{
	return !builder->only_listed || esk_label_table_find(&builder->table, label);
}

uint64_t esk_run_builder_place(const esk_run_builder *builder)
{
	return builder->x + builder->extent[0] * (builder->y + builder->extent[1] * (uint64_t)builder->z);
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
