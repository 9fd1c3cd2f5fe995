/* Distances row by row, in threads, for those who need each row once: memory is a row a thread, whatever the count.
 *
 * A row is a table of one row (distance_table.c). Both halves of a symmetric matrix are computed, which is the price of
 * not keeping it. */
#include "eskel.h"

#include "memory.h"
#include "team.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct {
	const eskel_library *library;
	const int64_t *keys;
	size_t count;
	const eskel_rows_options *options;
	atomic_int status; /* the first that was not ESKEL_OK; nothing is begun after it */
} rows;

static eskel_status do_row(const rows *all, size_t row)
{
	double *distances = esk_memory_array(all->count, sizeof *distances);
	if (!distances)
		return ESKEL_NO_MEMORY;
	eskel_status status = eskel_library_distances(
		all->library, &all->keys[row], 1, all->keys, all->count, &all->options->distance, distances);
	if (status == ESKEL_OK && !all->options->each(all->options->context, row, distances))
		status = ESKEL_CANCELLED;
	free(distances);
	return status;
}

static void take_row(void *context, size_t row)
{
	rows *all = context;
	if (atomic_load(&all->status) != ESKEL_OK)
		return;
	int good = ESKEL_OK;
	eskel_status status = do_row(all, row);
	if (status != ESKEL_OK)
		atomic_compare_exchange_strong(&all->status, &good, (int)status);
}

eskel_status eskel_library_rows(
	const eskel_library *library, const int64_t *keys, size_t count, const eskel_rows_options *options)
{
	rows all = {.library = library, .keys = keys, .count = count, .options = options};
	atomic_init(&all.status, ESKEL_OK);
	const uint32_t threads = esk_team_threads(options->threads);
	esk_team *team = esk_team_new(count < threads ? (uint32_t)count : threads);
	esk_team_run(team, count, take_row, &all);
	esk_team_free(team);
	return (eskel_status)atomic_load(&all.status);
}
