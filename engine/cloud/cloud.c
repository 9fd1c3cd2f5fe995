/* The voxels of one object in canonical form.
 *
 * The same object can come from files that store the grid in another axis order, direction, crop or number format.
 * All of them give the same cloud here, byte for byte once encoded, which is what makes a digest of the cloud an
 * identity: the affine is brought to its canonical form (orientation.h), the runs follow its axes, and the box of the
 * object starts at index 0. Only the grid itself stays what it was: nothing is resampled.
 */
#include "error.h"
#include "memory.h"
#include "orientation.h"
#include "spans.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t most_voxels = (uint64_t)1 << 33;
static const uint64_t most_weight = (uint64_t)1 << 44;
static const uint32_t largest_weight = (uint32_t)1 << 20;
static const unsigned longest_extent = UINT16_MAX;

typedef struct {
	uint16_t least[3], greatest[3];
} box;

static eskel_status copy_runs(
	const eskel_run *runs, const uint32_t *weights, size_t count, esk_spans *spans, eskel_error *error)
{
	for (size_t i = 0; i < count; i++) {
		const eskel_run *r = &runs[i];
		uint32_t weight = weights ? weights[i] : 1;
		if (r->x_first > r->x_last)
			return esk_error_set(error, ESKEL_INVALID, "run %zu ends at %u, before its start at %u", i,
				r->x_last, r->x_first);
		if (weight < 1 || weight > largest_weight)
			return esk_error_set(error, ESKEL_INVALID, "run %zu has weight %u, expected 1 to %u", i, weight,
				largest_weight);
		eskel_status status =
			esk_spans_add(spans, (esk_span){r->x_first, r->x_last, r->y, r->z, weight}, error);
		if (status != ESKEL_OK)
			return status;
	}
	return ESKEL_OK;
}

static eskel_status check_totals(const esk_spans *spans, eskel_error *error)
{
	uint64_t voxels = 0, weight = 0;
	for (size_t i = 0; i < spans->count; i++) {
		uint64_t length = (uint64_t)spans->items[i].x_last - spans->items[i].x_first + 1;
		voxels += length;
		weight += length * spans->items[i].weight;
		if (voxels > most_voxels)
			return esk_error_set(error, ESKEL_TOO_LARGE, "the object has more than %llu voxels",
				(unsigned long long)most_voxels);
		if (weight > most_weight)
			return esk_error_set(error, ESKEL_TOO_LARGE, "the voxels weigh more than %llu together",
				(unsigned long long)most_weight);
	}
	return ESKEL_OK;
}

static void widen(uint16_t *least, uint16_t *greatest, uint16_t first, uint16_t last)
{
	if (first < *least)
		*least = first;
	if (last > *greatest)
		*greatest = last;
}

static box bounding_box(const esk_spans *spans)
{
	box b = {{UINT16_MAX, UINT16_MAX, UINT16_MAX}, {0, 0, 0}};
	for (size_t i = 0; i < spans->count; i++) {
		const esk_span *s = &spans->items[i];
		widen(&b.least[0], &b.greatest[0], s->x_first, s->x_last);
		widen(&b.least[1], &b.greatest[1], s->y, s->y);
		widen(&b.least[2], &b.greatest[2], s->z, s->z);
	}
	return b;
}

/* Any order of three axes is made of at most an exchange of y and z, one of x and y, and one of y and z. */
static eskel_status permute(esk_spans *spans, const int axis[3], eskel_error *error)
{
	int order[3] = {0, 1, 2}; /* the input axes that x, y and z now run along */
	if (axis[0] == 2) {
		esk_spans_swap_yz(spans);
		eskel_status status = esk_spans_sort(spans, error);
		if (status != ESKEL_OK)
			return status;
		order[1] = 2;
		order[2] = 1;
	}
	if (axis[0] != 0) {
		eskel_status status = esk_spans_swap_xy(spans, error);
		if (status != ESKEL_OK)
			return status;
		order[0] = order[1];
		order[1] = 0;
	}
	if (order[1] != axis[1])
		esk_spans_swap_yz(spans);
	return ESKEL_OK;
}

static uint16_t place(uint16_t index, int a, const esk_orientation *o, const box *b)
{
	int axis = o->axis[a];
	return (uint16_t)(o->reversed[a] ? b->greatest[axis] - index : index - b->least[axis]);
}

/* Turns permuted spans so that the box starts at 0 and reversed axes run forwards. */
static eskel_status reposition(esk_spans *spans, const esk_orientation *o, const box *b, eskel_error *error)
{
	for (size_t i = 0; i < spans->count; i++) {
		esk_span *s = &spans->items[i];
		uint16_t first = place(s->x_first, 0, o, b), last = place(s->x_last, 0, o, b);
		s->x_first = o->reversed[0] ? last : first;
		s->x_last = o->reversed[0] ? first : last;
		s->y = place(s->y, 1, o, b);
		s->z = place(s->z, 2, o, b);
	}
	return esk_spans_sort(spans, error);
}

static eskel_status make_canonical(esk_spans *spans, eskel_affine *affine, uint16_t extent[3], eskel_error *error)
{
	esk_orientation o;
	esk_orientation_choose(affine, &o);
	box b = bounding_box(spans);
	double origin[3];
	for (int a = 0; a < 3; a++) {
		int axis = o.axis[a];
		unsigned length = b.greatest[axis] - b.least[axis] + 1u;
		if (length > longest_extent)
			return esk_error_set(error, ESKEL_TOO_LARGE,
				"the object is %u voxels long, expected at most %u", length, longest_extent);
		extent[a] = (uint16_t)length;
		origin[axis] = o.reversed[a] ? b.greatest[axis] : b.least[axis];
	}
	*affine = esk_orientation_apply(&o, affine, origin);
	eskel_status status = permute(spans, o.axis, error);
	if (status == ESKEL_OK)
		status = reposition(spans, &o, &b, error);
	return status;
}

static eskel_cloud *cloud_of(const esk_spans *spans, const eskel_affine *affine, const uint16_t extent[3])
{
	bool weighted = false;
	for (size_t i = 0; i < spans->count; i++)
		weighted |= spans->items[i].weight != 1;
	eskel_cloud *cloud = esk_memory_zeroed_array(1, sizeof *cloud);
	if (!cloud)
		return NULL;
	cloud->runs = esk_memory_array(spans->count, sizeof *cloud->runs);
	cloud->weights = weighted ? esk_memory_array(spans->count, sizeof *cloud->weights) : NULL;
	if (!cloud->runs || (weighted && !cloud->weights)) {
		eskel_cloud_free(cloud);
		return NULL;
	}
	cloud->affine = *affine;
	cloud->run_count = spans->count;
	for (int a = 0; a < 3; a++)
		cloud->extent[a] = extent[a];
	for (size_t i = 0; i < spans->count; i++) {
		const esk_span *s = &spans->items[i];
		uint64_t length = (uint64_t)s->x_last - s->x_first + 1;
		cloud->runs[i] = (eskel_run){s->x_first, s->x_last, s->y, s->z};
		cloud->voxels += length;
		cloud->weight += length * s->weight;
		if (weighted)
			cloud->weights[i] = s->weight;
	}
	return cloud;
}

eskel_status eskel_cloud_new(const eskel_run *runs, const uint32_t *weights, size_t run_count,
	const eskel_affine *affine, eskel_cloud **cloud, eskel_error *error)
{
	if (run_count == 0)
		return esk_error_set(error, ESKEL_EMPTY, "the object has no voxel");
	eskel_status status = eskel_affine_check(affine, error);
	if (status != ESKEL_OK)
		return status;
	esk_spans spans = {0};
	eskel_affine canonical = *affine;
	uint16_t extent[3];
	status = copy_runs(runs, weights, run_count, &spans, error);
	if (status == ESKEL_OK)
		status = check_totals(&spans, error);
	if (status == ESKEL_OK)
		status = esk_spans_join(&spans, error);
	if (status == ESKEL_OK)
		status = make_canonical(&spans, &canonical, extent, error);
	/* Again, because rounding may have moved an affine at the edge of what is allowed. */
	if (status == ESKEL_OK)
		status = eskel_affine_check(&canonical, error);
	if (status == ESKEL_OK) {
		eskel_cloud *made = cloud_of(&spans, &canonical, extent);
		if (made)
			*cloud = made;
		else
			status = esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu runs", spans.count);
	}
	esk_spans_free(&spans);
	return status;
}

void eskel_cloud_free(eskel_cloud *cloud)
{
	if (!cloud)
		return;
	free(cloud->runs);
	free(cloud->weights);
	free(cloud);
}

double eskel_cloud_volume(const eskel_cloud *cloud)
{
	return (double)cloud->voxels * fabs(eskel_affine_determinant(&cloud->affine));
}
