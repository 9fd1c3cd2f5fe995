#include "partition.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

eskel_status esk_partition_init(
	esk_partition *partition, const esk_segment *segments, size_t segment_count, const esk_metric *metric)
{
	size_t *first_piece = esk_memory_zeroed_array(segment_count + 1, sizeof *first_piece);
	if (!first_piece)
		return ESKEL_NO_MEMORY;
	*partition = (esk_partition){
		.metric = metric,
		.segments = segments,
		.segment_count = segment_count,
		.first_piece = first_piece,
	};
	return ESKEL_OK;
}

void esk_partition_clear(esk_partition *partition)
{
	free(partition->first_piece);
	free(partition->pieces);
	*partition = (esk_partition){0};
}

static uint32_t best_class(const esk_scores *scores, double x, const esk_segment *s)
{
	uint32_t best = 0;
	double least = esk_scores_at(scores, 0, x, s->y, s->z);
	for (uint32_t j = 1; j < scores->count; j++) {
		double score = esk_scores_at(scores, j, x, s->y, s->z);
		if (score < least) {
			least = score;
			best = j;
		}
	}
	return best;
}

/* The last x of the segment at which class a, which wins at x, still beats class b, which wins at x_last. */
static int32_t crossing(const esk_scores *scores, const esk_segment *s, int32_t x, uint32_t a, uint32_t b)
{
	int64_t lead = (int64_t)(esk_scores_at(scores, b, x, s->y, s->z) - esk_scores_at(scores, a, x, s->y, s->z));
	int64_t loss = (int64_t)(2 * (scores->slope[0][a] - scores->slope[0][b])); /* per voxel; > 0 as b overtakes a */
	int64_t steps = lead / loss;
	if (a > b && lead % loss == 0)
		steps--; /* a tie goes to the lower index */
	return x + 2 * (int32_t)steps;
}

static void emit(esk_partition *partition, const esk_segment *s, int32_t x_first, int32_t x_last, uint32_t class_index,
	size_t *count)
{
	esk_segment part = {x_first, x_last, s->y, s->z, s->weight};
	partition->pieces[(*count)++] = (esk_piece){x_last, class_index};
	esk_sums_add(&partition->sums[class_index], &part);
}

static void cut(esk_partition *partition, const esk_scores *scores, const esk_segment *s, size_t *count)
{
	int32_t x = s->x_first;
	uint32_t a = best_class(scores, x, s);
	for (;;) {
		int32_t end = s->x_last;
		uint32_t b = best_class(scores, end, s);
		while (b != a) {
			end = crossing(scores, s, x, a, b);
			b = best_class(scores, end, s);
		}
		emit(partition, s, x, end, a, count);
		if (end == s->x_last)
			return;
		x = end + 2;
		a = best_class(scores, x, s);
	}
}

eskel_status esk_partition_assign(esk_partition *partition, const esk_scores *scores)
{
	size_t count = 0;
	partition->class_count = scores->count;
	memset(partition->sums, 0, sizeof partition->sums);
	for (size_t i = 0; i < partition->segment_count; i++) {
		if (!esk_memory_reserve((void **)&partition->pieces, &partition->piece_capacity, count + scores->count,
			    sizeof *partition->pieces))
			return ESKEL_NO_MEMORY;
		partition->first_piece[i] = count;
		cut(partition, scores, &partition->segments[i], &count);
	}
	partition->first_piece[partition->segment_count] = count;
	return ESKEL_OK;
}

/* Walks the pieces in the order of the segments. */
typedef struct {
	size_t segment, piece;
	bool valid;
	uint32_t class_index;
	esk_segment part;
} piece_cursor;

static void next_piece(const esk_partition *partition, piece_cursor *c)
{
	int32_t x_first = c->part.x_last + 2;
	if (++c->piece == partition->first_piece[c->segment + 1]) {
		if (++c->segment == partition->segment_count) {
			c->valid = false;
			return;
		}
		x_first = partition->segments[c->segment].x_first;
	}
	c->part = partition->segments[c->segment];
	c->part.x_first = x_first;
	c->part.x_last = partition->pieces[c->piece].x_last;
	c->class_index = partition->pieces[c->piece].class_index;
}

static piece_cursor first_piece(const esk_partition *partition)
{
	piece_cursor c = {.valid = partition->segment_count > 0, .part = partition->segments[0]};
	c.part.x_last = partition->pieces[0].x_last;
	c.class_index = partition->pieces[0].class_index;
	return c;
}

static bool has_same_sums(const esk_sums *a, const esk_sums *b, uint32_t count)
{
	for (uint32_t j = 0; j < count; j++)
		if (a[j].weight != b[j].weight || memcmp(a[j].first, b[j].first, sizeof a[j].first) != 0)
			return false;
	return true;
}

static double squared_distance(const esk_metric *metric, const esk_sums *sums, const double u[3])
{
	double d[3], sum = 0;
	for (int r = 0; r < 3; r++)
		d[r] = u[r] - (double)sums->first[r] / (double)sums->weight;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			sum += (double)metric->form[r][c] * d[r] * d[c];
	return sum;
}

/* Moves the voxel farthest from its centre, among classes of two voxels or more, to the empty class. Only the sums
 * change: the voxel is now the centre of that class, so the next pass moves it. Distance is convex along a piece, so
 * its ends suffice. */
static void fill_empty_class(esk_partition *partition, uint32_t empty)
{
	uint64_t voxels[ESKEL_LEVELS_MAX] = {0};
	for (piece_cursor c = first_piece(partition); c.valid; next_piece(partition, &c))
		voxels[c.class_index] += esk_segment_voxels(&c.part);
	double farthest = -1;
	esk_segment voxel = {0};
	uint32_t from = 0;
	for (piece_cursor c = first_piece(partition); c.valid; next_piece(partition, &c))
		for (int end = 0; end < 2; end++) {
			int32_t x = end ? c.part.x_last : c.part.x_first;
			double d = squared_distance(
				partition->metric, &partition->sums[c.class_index], (double[3]){x, c.part.y, c.part.z});
			if (voxels[c.class_index] >= 2 && d > farthest) {
				farthest = d;
				from = c.class_index;
				voxel = (esk_segment){x, x, c.part.y, c.part.z, c.part.weight};
			}
		}
	esk_sums_add(&partition->sums[empty], &voxel);
	partition->sums[from].weight -= voxel.weight;
	for (int r = 0; r < 3; r++)
		partition->sums[from].first[r] -= partition->sums[empty].first[r];
}

/* Every pass lowers sum w V over the classes, or keeps it and moves tied voxels to lower indices, so that no partition
 * returns and the iteration ends: but for the rounding of the scores, where two partitions equally good to 2^-30 of
 * the object's size could take turns. So the sums are also compared with a snapshot, taken again after 1, 2, 4, 8 ...
 * passes (Brent's cycle detection): an end is certain. */
eskel_status esk_partition_converge(esk_partition *partition, const esk_sums *starts, uint32_t count)
{
	esk_sums sums[ESKEL_LEVELS_MAX], snapshot[ESKEL_LEVELS_MAX];
	memcpy(sums, starts, count * sizeof *sums);
	memcpy(snapshot, starts, count * sizeof *sums);
	for (uint64_t pass = 1;; pass++) {
		esk_scores scores = {.count = count};
		for (uint32_t j = 0; j < count; j++)
			esk_scores_set(&scores, j, partition->metric, &sums[j]);
		eskel_status status = esk_partition_assign(partition, &scores);
		if (status)
			return status;
		for (uint32_t j = 0; j < count; j++)
			if (!partition->sums[j].weight)
				fill_empty_class(partition, j);
		if (has_same_sums(partition->sums, sums, count) || has_same_sums(partition->sums, snapshot, count))
			return ESKEL_OK;
		memcpy(sums, partition->sums, count * sizeof *sums);
		if ((pass & (pass - 1)) == 0)
			memcpy(snapshot, sums, count * sizeof *sums);
	}
}

void esk_partition_moments(const esk_partition *partition, esk_moments *moments)
{
	memset(moments, 0, partition->class_count * sizeof *moments);
	for (piece_cursor c = first_piece(partition); c.valid; next_piece(partition, &c))
		esk_moments_add(&moments[c.class_index], &c.part);
}

eskel_status esk_partition_collect(
	const esk_partition *partition, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1])
{
	size_t next[ESKEL_LEVELS_MAX + 1] = {0};
	const size_t pieces = partition->first_piece[partition->segment_count];
	esk_segment *out = esk_memory_array(pieces, sizeof *out);
	if (!out)
		return ESKEL_NO_MEMORY;
	for (size_t p = 0; p < pieces; p++)
		next[partition->pieces[p].class_index + 1]++;
	for (uint32_t j = 0; j < partition->class_count; j++)
		next[j + 1] += next[j];
	memcpy(first, next, sizeof next);
	for (piece_cursor c = first_piece(partition); c.valid; next_piece(partition, &c))
		out[next[c.class_index]++] = c.part;
	*segments = out;
	return ESKEL_OK;
}
