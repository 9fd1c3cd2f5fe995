#include "voxel_clustering.h"

#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __int128 wide;

static void *allocate(size_t count, size_t size)
{
	void *p = calloc(count ? count : 1, size);
	if (!p) {
		fprintf(stderr, "memory ran out for %zu voxels\n", count);
		exit(1);
	}
	return p;
}

void voxel_set_init(voxel_set *set, const eskel_cloud *cloud, const int64_t form[3][3], int shift,
	const double map[3][3], const double root_map[3][3])
{
	*set = (voxel_set){.count = cloud->voxels, .shift = shift};
	memcpy(set->form, form, sizeof set->form);
	memcpy(set->map, map, sizeof set->map);
	memcpy(set->root_map, root_map, sizeof set->root_map);
	set->u = allocate(set->count, sizeof *set->u);
	set->weight = allocate(set->count, sizeof *set->weight);
	size_t v = 0;
	for (size_t i = 0; i < cloud->run_count; i++)
		for (int x = cloud->runs[i].x_first; x <= cloud->runs[i].x_last; x++, v++) {
			set->u[v][0] = 2 * x + 1 - cloud->extent[0];
			set->u[v][1] = 2 * cloud->runs[i].y + 1 - cloud->extent[1];
			set->u[v][2] = 2 * cloud->runs[i].z + 1 - cloud->extent[2];
			set->weight[v] = cloud->weights ? cloud->weights[i] : 1;
		}
}

void voxel_set_clear(voxel_set *set)
{
	free(set->u);
	free(set->weight);
}

static wide nearest_integer(wide p, wide q)
{
	wide sign = p < 0 ? -1 : 1;
	return sign * ((2 * sign * p + q) / (2 * q));
}

/* s(u) = c - 2 b.u, b = T g and c = b.g to multiples of 2^-shift. */
void voxel_score(const voxel_set *set, const voxel_centre *g, int64_t score[4])
{
	wide up = (wide)1 << (set->shift > 0 ? set->shift : 0), down = (wide)1 << (set->shift < 0 ? -set->shift : 0);
	wide c = 0;
	for (int r = 0; r < 3; r++) {
		wide t = (wide)set->form[r][0] * g->first[0] + (wide)set->form[r][1] * g->first[1] +
			 (wide)set->form[r][2] * g->first[2];
		wide b = nearest_integer(t * up, g->weight * down);
		score[r + 1] = (int64_t)(-2 * b);
		c += b * g->first[r];
	}
	score[0] = (int64_t)nearest_integer(c, g->weight);
}

static void assign(voxel_set *set, int64_t scores[][4], unsigned count, uint8_t *labels)
{
	for (size_t v = 0; v < set->count; v++) {
		const int32_t *u = set->u[v];
		unsigned best = 0;
		int64_t least = INT64_MAX;
		for (unsigned j = 0; j < count; j++) {
			int64_t score = scores[j][0] + scores[j][1] * u[0] + scores[j][2] * u[1] + scores[j][3] * u[2];
			if (score < least) {
				least = score;
				best = j;
			}
		}
		labels[v] = (uint8_t)best;
	}
	set->passes++;
}

static void centres_of(const voxel_set *set, const uint8_t *labels, voxel_centre *centres, unsigned count)
{
	memset(centres, 0, count * sizeof *centres);
	for (size_t v = 0; v < set->count; v++) {
		voxel_centre *g = &centres[labels[v]];
		g->weight += set->weight[v];
		for (int r = 0; r < 3; r++)
			g->first[r] += set->weight[v] * set->u[v][r];
	}
}

bool voxel_lloyd(voxel_set *set, voxel_centre *centres, unsigned count, uint8_t *labels)
{
	for (;;) {
		int64_t scores[ESKEL_LEVELS_MAX][4];
		voxel_centre before[ESKEL_LEVELS_MAX];
		memcpy(before, centres, count * sizeof *centres);
		for (unsigned j = 0; j < count; j++)
			voxel_score(set, &centres[j], scores[j]);
		assign(set, scores, count, labels);
		centres_of(set, labels, centres, count);
		for (unsigned j = 0; j < count; j++)
			if (!centres[j].weight)
				return false;
		if (!memcmp(before, centres, count * sizeof *centres))
			return true;
	}
}

/* Sum of w (u - g)(u - g)^T, from differences. */
static void scatter_of(const voxel_set *set, double scatter[3][3])
{
	voxel_centre g = {0};
	memset(scatter, 0, 9 * sizeof(double));
	for (size_t v = 0; v < set->count; v++) {
		g.weight += set->weight[v];
		for (int r = 0; r < 3; r++)
			g.first[r] += set->weight[v] * set->u[v][r];
	}
	for (size_t v = 0; v < set->count; v++)
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				scatter[r][c] += (double)set->weight[v] *
						 (set->u[v][r] - (double)g.first[r] / (double)g.weight) *
						 (set->u[v][c] - (double)g.first[c] / (double)g.weight);
}

static double inertia_of(const voxel_set *set)
{
	double scatter[3][3], sum = 0;
	scatter_of(set, scatter);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			sum += scatter[r][c] * (double)set->form[r][c];
	return sum;
}

/* The voxels of one class. */
static voxel_set subset(const voxel_set *set, const uint8_t *labels, unsigned j)
{
	voxel_set part = *set;
	part.u = allocate(set->count, sizeof *part.u);
	part.weight = allocate(set->count, sizeof *part.weight);
	part.count = 0;
	part.passes = 0;
	for (size_t v = 0; v < set->count; v++)
		if (labels[v] == j) {
			memcpy(part.u[part.count], set->u[v], sizeof part.u[0]);
			part.weight[part.count++] = set->weight[v];
		}
	return part;
}

static void split_normal(const voxel_set *set, const double map[3][3], int64_t normal[3])
{
	double scatter[3][3], half[3][3], matrix[9], values[3], work[64], n[3], greatest = 0;
	scatter_of(set, scatter);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			half[r][c] = map[r][0] * scatter[0][c] + map[r][1] * scatter[1][c] + map[r][2] * scatter[2][c];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			matrix[3 * c + r] = half[r][0] * map[c][0] + half[r][1] * map[c][1] + half[r][2] * map[c][2];
	if (LAPACKE_dsyev_work(LAPACK_COL_MAJOR, 'V', 'U', 3, matrix, 3, values, work, 64))
		exit(1);
	for (int i = 0; i < 3; i++) { /* values ascend: the last column is the major axis */
		n[i] = map[0][i] * matrix[6] + map[1][i] * matrix[7] + map[2][i] * matrix[8];
		greatest = fmax(greatest, fabs(n[i]));
	}
	for (int i = 0; i < 3; i++)
		normal[i] = llround(n[i] / greatest * 1048576);
}

/* Voxels below, on and above the plane through the centre; those on it join the lighter side, the heavier part comes
 * first. */
static void cut(const voxel_set *set, const int64_t normal[3], voxel_centre parts[2])
{
	voxel_centre whole = {0}, side[3] = {{0}};
	for (size_t v = 0; v < set->count; v++) {
		whole.weight += set->weight[v];
		for (int r = 0; r < 3; r++)
			whole.first[r] += set->weight[v] * set->u[v][r];
	}
	for (size_t v = 0; v < set->count; v++) {
		wide height = 0;
		for (int r = 0; r < 3; r++)
			height += normal[r] * ((wide)set->u[v][r] * whole.weight - whole.first[r]);
		voxel_centre *s = &side[(height > 0) - (height < 0) + 1];
		s->weight += set->weight[v];
		for (int r = 0; r < 3; r++)
			s->first[r] += set->weight[v] * set->u[v][r];
	}
	voxel_centre *lighter = side[2].weight < side[0].weight ? &side[2] : &side[0];
	lighter->weight += side[1].weight;
	for (int r = 0; r < 3; r++)
		lighter->first[r] += side[1].first[r];
	bool swap = side[2].weight > side[0].weight;
	parts[0] = side[swap ? 2 : 0];
	parts[1] = side[swap ? 0 : 2];
}

/* The ratio r of the split of class j, 2 when it cannot be split; its parts, the heavier first. */
static double split_class(voxel_set *set, const uint8_t *labels, unsigned j, bool root, voxel_centre parts[2])
{
	voxel_set part = subset(set, labels, j);
	double whole = inertia_of(&part), inertia[2], ratio = 2;
	if (part.count > 1 && whole > 0) {
		uint8_t *sides = allocate(part.count, 1);
		int64_t normal[3];
		split_normal(&part, (const double(*)[3])(root ? set->root_map : set->map), normal);
		cut(&part, normal, parts);
		voxel_lloyd(&part, parts, 2, sides);
		for (unsigned i = 0; i < 2; i++) {
			voxel_set half = subset(&part, sides, i);
			inertia[i] = inertia_of(&half);
			voxel_set_clear(&half);
		}
		if (parts[1].weight > parts[0].weight ||
			(parts[1].weight == parts[0].weight && inertia[1] > inertia[0])) {
			voxel_centre swap = parts[0];
			parts[0] = parts[1];
			parts[1] = swap;
		}
		ratio = round((inertia[0] + inertia[1]) / whole * 0x1p32) * 0x1p-32;
		free(sides);
	}
	set->passes += part.passes;
	voxel_set_clear(&part);
	return ratio;
}

unsigned voxel_clustering(voxel_set *set, unsigned levels, uint8_t *labels)
{
	memset(labels, 0, set->count);
	for (unsigned k = 1; k < levels; k++) {
		const uint8_t *now = labels + (k - 1) * set->count;
		voxel_centre centres[ESKEL_LEVELS_MAX], best[2];
		double least = 2;
		unsigned chosen = 0;
		for (unsigned j = 0; j < k; j++) {
			voxel_centre parts[2];
			double ratio = split_class(set, now, j, k == 1, parts);
			if (ratio < least) {
				least = ratio;
				chosen = j;
				memcpy(best, parts, sizeof best);
			}
		}
		if (least >= 2)
			return k;
		centres_of(set, now, centres, k);
		centres[chosen] = best[0];
		centres[k] = best[1];
		if (!voxel_lloyd(set, centres, k + 1, labels + k * set->count))
			return 0;
	}
	return levels;
}
