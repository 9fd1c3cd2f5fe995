/* Weights are relative: a skeleton does not change when all are doubled. So they are brought to whole numbers up to 4080
 * for the largest of the file, which keeps the values of maps of 8 bits, for 4080 = 16 x 255, and states a probability to
 * .00025. What rounds to 0 is no part of the object. Which that is only the end of the file tells, but what would round to
 * 0 beside the largest value so far will, so it is left out at once, or when room is made: maps that a network wrote are
 * nowhere 0.
 */
#include "weight_builder.h"

#include "error.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double largest_weight = 4080;

/* Runs before room is made for the first time. */
enum { first_room = 1 << 16 };

struct esk_weight_builder {
	esk_voxel_format format;
	uint32_t extent[3];
	uint32_t x, y, z; /* of the next voxel */
	size_t most_runs;
	size_t room; /* runs to have before those that weigh nothing are left out again */
	double largest;
	esk_label_runs runs; /* label 1 */
	double *values;      /* one a run */
	size_t value_capacity;
	uint32_t *weights; /* one a run, once finished */
	esk_label_table table;
};

eskel_status esk_weight_builder_new(size_t most_runs, esk_weight_builder **builder)
{
	esk_weight_builder *b = esk_memory_zeroed_array(1, sizeof *b);
	if (!b)
		return ESKEL_NO_MEMORY;
	b->most_runs = most_runs;
	b->room = first_room;
	b->runs.label = 1;
	b->table.items = &b->runs;
	*builder = b;
	return ESKEL_OK;
}

void esk_weight_builder_free(esk_weight_builder *builder)
{
	if (!builder)
		return;
	free(builder->runs.runs);
	free(builder->values);
	free(builder->weights);
	free(builder);
}

void esk_weight_builder_set_grid(esk_weight_builder *builder, const esk_voxel_format *format, const uint32_t extent[3])
{
	builder->format = *format;
	memcpy(builder->extent, extent, sizeof builder->extent);
}

static double weight_of(const esk_weight_builder *b, double value)
{
	return rint(largest_weight * (value / b->largest));
}

static void drop_weightless(esk_weight_builder *b)
{
	size_t kept = 0;
	for (size_t i = 0; i < b->runs.count; i++)
		if (weight_of(b, b->values[i]) > 0) {
			b->runs.runs[kept] = b->runs.runs[i];
			b->values[kept++] = b->values[i];
		}
	b->runs.count = kept;
	b->room = kept < first_room / 2 ? first_room : 2 * kept;
}

static eskel_status add_run(esk_weight_builder *b, double value, eskel_error *error)
{
	const eskel_run run = {(uint16_t)b->x, (uint16_t)b->x, (uint16_t)b->y, (uint16_t)b->z};
	if (b->runs.count >= b->room || b->runs.count == b->most_runs)
		drop_weightless(b);
	if (b->runs.count == b->most_runs)
		return esk_error_set(
			error, ESKEL_TOO_LARGE, "the weights have more than %zu runs of voxels", b->most_runs);
	void *runs = b->runs.runs, *values = b->values;
	const bool reserved = esk_memory_reserve(&runs, &b->runs.capacity, b->runs.count + 1, sizeof run);
	b->runs.runs = runs;
	if (!reserved || !esk_memory_reserve(&values, &b->value_capacity, b->runs.count + 1, sizeof value))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu runs", b->runs.count + 1);
	b->values = values;
	b->runs.runs[b->runs.count] = run;
	b->values[b->runs.count++] = value;
	return ESKEL_OK;
}

static eskel_status add_voxel(esk_weight_builder *b, double value, eskel_error *error)
{
	if (!(value >= 0 && value < HUGE_VAL))
		return esk_error_set(error, ESKEL_BAD_VALUE,
			"voxel (%u, %u, %u) is %.10g, expected a weight: a finite number from 0", b->x, b->y, b->z,
			value);
	if (value > b->largest)
		b->largest = value;
	if (value == 0 || weight_of(b, value) == 0)
		return ESKEL_OK;
	eskel_run *last = b->runs.count ? &b->runs.runs[b->runs.count - 1] : NULL;
	if (last && last->z == b->z && last->y == b->y && last->x_last + 1U == b->x &&
		b->values[b->runs.count - 1] == value) {
		last->x_last = (uint16_t)b->x;
		return ESKEL_OK;
	}
	return add_run(b, value, error);
}

static void advance(esk_weight_builder *b)
{
	if (++b->x < b->extent[0])
		return;
	b->x = 0;
	if (++b->y < b->extent[1])
		return;
	b->y = 0;
	b->z++;
}

eskel_status esk_weight_builder_add(
	esk_weight_builder *builder, const uint8_t *voxels, size_t count, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	for (size_t i = 0; i < count && status == ESKEL_OK; i++) {
		const double value = esk_voxel_value(&builder->format, voxels + i * builder->format.size);
		status = add_voxel(builder, value, error);
		advance(builder);
	}
	return status;
}

static uint32_t greatest_common_divisor(uint32_t a, uint32_t b)
{
	while (b) {
		const uint32_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

eskel_status esk_weight_builder_finish(esk_weight_builder *builder, const esk_label_table **table)
{
	esk_weight_builder *b = builder;
	drop_weightless(b);
	b->table.count = b->runs.count > 0;
	b->weights = esk_memory_array(b->runs.count, sizeof *b->weights);
	if (!b->weights)
		return ESKEL_NO_MEMORY;
	uint32_t divisor = 0;
	for (size_t i = 0; i < b->runs.count; i++) {
		b->weights[i] = (uint32_t)weight_of(b, b->values[i]);
		divisor = greatest_common_divisor(b->weights[i], divisor);
	}
	for (size_t i = 0; i < b->runs.count; i++)
		b->weights[i] /= divisor;
	*table = &b->table;
	return ESKEL_OK;
}

const uint32_t *esk_weight_builder_weights(const esk_weight_builder *builder)
{
	return builder->weights;
}

bool esk_weight_builder_keeps(const uint32_t *weights, size_t count)
{
	uint32_t divisor = 0, largest = 0;
	for (size_t i = 0; i < count; i++) {
		divisor = greatest_common_divisor(weights[i], divisor);
		largest = weights[i] > largest ? weights[i] : largest;
	}
	/* All are then multiplied by 4080 / largest, which is whole, and divided by it again. */
	return divisor == 1 && (uint32_t)largest_weight % largest == 0;
}
