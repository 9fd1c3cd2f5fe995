#include "neighbourhood.h"

#include "memory.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { neighbours = 8 };
/* Of a shape with as many copies: what it is nearest to stays so. */
static const double least_size = 1e-6;

struct esk_neighbourhoods {
	pthread_mutex_t lock;
	esk_snapshot snapshot; /* whose directory it holds; none at first */
	eskel_distance_options options;
	double *sizes; /* by id; 0 where not known */
};

esk_neighbourhoods *esk_neighbourhoods_new(void)
{
	esk_neighbourhoods *known = esk_memory_zeroed_array(1, sizeof *known);
	if (known)
		pthread_mutex_init(&known->lock, NULL);
	return known;
}

static void forget(esk_neighbourhoods *known)
{
	esk_directory_release(known->snapshot.directory);
	free(known->sizes);
	known->snapshot = (esk_snapshot){0};
	known->sizes = NULL;
}

void esk_neighbourhoods_free(esk_neighbourhoods *known)
{
	if (!known)
		return;
	forget(known);
	pthread_mutex_destroy(&known->lock);
	free(known);
}

/* ---- what is known */

/* A directory is another one as long as it is held, and one directory shows what was added and removed by these two. */
static bool is_of(const esk_neighbourhoods *known, const esk_snapshot *snapshot, const eskel_distance_options *options)
{
	return known->snapshot.directory == snapshot->directory && known->snapshot.moment == snapshot->moment &&
	       known->snapshot.last_count == snapshot->last_count && known->options.signature == options->signature &&
	       known->options.distance == options->distance && known->options.level == options->level &&
	       known->options.metric == options->metric && known->options.size == options->size;
}

static double recall(
	esk_neighbourhoods *known, const esk_snapshot *snapshot, const eskel_distance_options *options, uint32_t id)
{
	pthread_mutex_lock(&known->lock);
	const double size = is_of(known, snapshot, options) ? known->sizes[id] : 0;
	pthread_mutex_unlock(&known->lock);
	return size;
}

/* Without memory nothing is known afterwards, and sizes are computed again. */
static void begin(esk_neighbourhoods *known, const esk_snapshot *snapshot, const eskel_distance_options *options)
{
	forget(known);
	known->sizes = esk_memory_zeroed_array(snapshot->directory->chunk_count, ESK_CHUNK_SLOTS * sizeof(double));
	if (!known->sizes)
		return;
	atomic_fetch_add_explicit(&snapshot->directory->references, 1, memory_order_relaxed);
	known->snapshot = *snapshot;
	known->options = *options;
}

static void remember(esk_neighbourhoods *known, const esk_snapshot *snapshot, const eskel_distance_options *options,
	uint32_t id, double size)
{
	pthread_mutex_lock(&known->lock);
	if (!is_of(known, snapshot, options))
		begin(known, snapshot, options);
	if (known->sizes)
		known->sizes[id] = size;
	pthread_mutex_unlock(&known->lock);
}

/* ---- sizes */

static double mean_distance(const esk_nearest *nearest)
{
	double sum = 0;
	esk_ranked_sort(nearest->items, nearest->count);
	for (size_t n = 0; n < nearest->count; n++)
		sum += nearest->items[n].distance;
	return fmax(sum / (double)nearest->count, least_size);
}

/* 1 where there is no other shape. */
static eskel_status measure(const esk_snapshot *snapshot, const esk_shape *shape, const eskel_distance_options *options,
	const int64_t *left_out, double *size)
{
	eskel_search_result steps = {0};
	const eskel_search_options chosen = {.distance = *options,
		.limit = neighbours,
		.leave_out = left_out != NULL,
		.left_out_key = left_out ? *left_out : 0};
	esk_search search = {.snapshot = *snapshot, .result = &steps};
	eskel_status status = esk_search_run(&search, shape, &chosen);
	if (status == ESKEL_OK)
		*size = search.answer.count ? mean_distance(&search.answer) : 1;
	esk_search_clear(&search);
	return status;
}

static eskel_status size_of(esk_neighbourhoods *known, const esk_snapshot *snapshot,
	const eskel_distance_options *options, const esk_ranked *found, double *size)
{
	*size = recall(known, snapshot, options, found->id);
	if (*size > 0)
		return ESKEL_OK;
	eskel_status status = measure(snapshot, esk_snapshot_shape(snapshot, found->id), options, &found->key, size);
	if (status == ESKEL_OK)
		remember(known, snapshot, options, found->id, *size);
	return status;
}

eskel_status esk_neighbourhoods_scale(
	esk_neighbourhoods *known, const eskel_search_options *options, esk_search *search)
{
	double mine, theirs;
	esk_nearest *answer = &search->answer;
	search->unscaled = esk_memory_array(answer->wanted, sizeof *search->unscaled);
	if (!search->unscaled)
		return ESKEL_NO_MEMORY;
	eskel_status status = measure(&search->snapshot, search->query.shape, &options->distance,
		options->leave_out ? &options->left_out_key : NULL, &mine);
	for (size_t n = 0; status == ESKEL_OK && n < answer->count; n++) {
		esk_ranked *found = &answer->items[n];
		status = size_of(known, &search->snapshot, &options->distance, found, &theirs);
		search->unscaled[found->row] = found->distance;
		if (status == ESKEL_OK)
			found->distance /= sqrt(mine * theirs);
	}
	return status;
}
