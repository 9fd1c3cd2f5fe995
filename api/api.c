/* Opening and closing: the store, and the library filled from it. */
#include "api.h"

#include "cache.h"
#include "calibration.h"
#include "job.h"
#include "pruning.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BODY_BYTES ((uint64_t)1 << 30)
#define MOST_VOXELS ((uint64_t)1 << 31)
#define MOST_RUNS ((uint64_t)1 << 24)
#define MOST_LABELS 1024
#define MOST_DISTANCES 4000000
#define MOST_KNOWN_BYTES ((uint64_t)2 << 30)
#define MOST_RESULT_BYTES ((uint64_t)16 << 30)
#define MOST_MESH_BYTES ((uint64_t)1 << 30)

/* Signatures between two calls of loading: a progress bar needs no more, and a call may draw one. */
#define LOADING_STEP 4096

typedef struct {
	eskel_api *api;
	uint64_t loaded, total;
	eskel_status status;
} loader;

static void *prepare_signature(void *context, const eskel_signature *signature)
{
	const loader *loading = context;
	eskel_prepared *prepared = NULL;
	return eskel_library_prepare(loading->api->library, signature, &prepared) == ESKEL_OK ? prepared : NULL;
}

static void drop_prepared(void *prepared)
{
	eskel_prepared_free(prepared);
}

static bool add_prepared(void *context, int64_t key, void *prepared)
{
	loader *loading = context;
	const eskel_api_options *options = &loading->api->options;
	bool told = options->loading && loading->loaded % LOADING_STEP == 0;
	loading->status = eskel_library_add_prepared(loading->api->library, key, prepared);
	if (loading->status == ESKEL_OK && told && !options->loading(options->context, loading->loaded, loading->total))
		loading->status = ESKEL_CANCELLED;
	loading->loaded++;
	return loading->status == ESKEL_OK;
}

static eskel_store_status refuse(eskel_store_error *error, eskel_store_status status, const char *text)
{
	if (error) {
		error->status = status;
		snprintf(error->text, sizeof error->text, "the library of signatures is not filled: %s", text);
	}
	return status;
}

static eskel_store_status fill_library(eskel_api *api, eskel_store_error *error)
{
	loader loading = {.api = api, .status = eskel_library_new(&api->library)};
	if (loading.status != ESKEL_OK)
		return refuse(error, ESKEL_STORE_NO_MEMORY, eskel_status_text(loading.status));
	const eskel_signature_visitor visitor = {
		.make = prepare_signature, .take = add_prepared, .drop = drop_prepared, .context = &loading};
	eskel_store_status status = eskel_store_count(api->store, &loading.total, error);
	if (status == ESKEL_STORE_OK)
		status = eskel_store_each_signature(api->store, &visitor, error);
	if (status != ESKEL_STORE_OK || loading.status == ESKEL_OK)
		return status;
	status = loading.status == ESKEL_NO_MEMORY ? ESKEL_STORE_NO_MEMORY : ESKEL_STORE_INVALID;
	return refuse(error, status, eskel_status_text(loading.status));
}

/* What is done in a thread of its own, while the library is filled. */
typedef struct {
	eskel_store_status (*work)(eskel_store *store, eskel_store_error *error);
	eskel_store *store;
	bool has_thread;
	pthread_t thread;
	eskel_store_status status;
	eskel_store_error error;
} task;

static void *run(void *context)
{
	task *t = context;
	t->status = t->work(t->store, &t->error);
	return NULL;
}

static void begin(task *t)
{
	t->has_thread = pthread_create(&t->thread, NULL, run, t) == 0;
}

static void end(task *t)
{
	if (t->has_thread)
		pthread_join(t->thread, NULL);
	else
		run(t);
}

/* A database that is damaged is called so, whatever else that has brought about. */
static eskel_store_status fill_memory(eskel_api *api, eskel_store_error *error)
{
	task check = {.work = eskel_store_check, .store = api->store};
	task keep = {.work = eskel_store_keep_descriptions, .store = api->store};
	eskel_store_error filling;
	begin(&check);
	begin(&keep);
	eskel_store_status filled = fill_library(api, &filling);
	end(&check);
	end(&keep);
	const eskel_store_error *failed = check.status != ESKEL_STORE_OK  ? &check.error
					  : filled != ESKEL_STORE_OK      ? &filling
					  : keep.status != ESKEL_STORE_OK ? &keep.error
									  : NULL;
	if (failed && error)
		*error = *failed;
	return failed ? failed->status : ESKEL_STORE_OK;
}

static void set_defaults(eskel_api_options *options)
{
	if (options->most_body_bytes == 0)
		options->most_body_bytes = MOST_BODY_BYTES;
	if (options->most_voxels == 0)
		options->most_voxels = MOST_VOXELS;
	if (options->most_runs == 0)
		options->most_runs = MOST_RUNS;
	if (options->most_labels == 0)
		options->most_labels = MOST_LABELS;
	if (options->most_distances == 0)
		options->most_distances = MOST_DISTANCES;
	if (options->most_known_bytes == 0)
		options->most_known_bytes = MOST_KNOWN_BYTES;
	if (options->most_result_bytes == 0)
		options->most_result_bytes = MOST_RESULT_BYTES;
	if (options->most_mesh_bytes == 0)
		options->most_mesh_bytes = MOST_MESH_BYTES;
}

/* A deletion that waits goes before enrollments that come later, or it might wait for ever. */
static void init_lock(pthread_rwlock_t *lock)
{
	pthread_rwlockattr_t attributes;
	pthread_rwlockattr_init(&attributes);
	pthread_rwlockattr_setkind_np(&attributes, PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP);
	pthread_rwlock_init(lock, &attributes);
	pthread_rwlockattr_destroy(&attributes);
}

eskel_store_status eskel_api_open(
	const char *database, const eskel_api_options *options, eskel_api **api, eskel_store_error *error)
{
	eskel_api *opened = calloc(1, sizeof *opened);
	if (!opened)
		return refuse(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	init_lock(&opened->changing);
	if (options)
		opened->options = *options;
	set_defaults(&opened->options);
	opened->options.store.check_later = true;
	eskel_store_status status = eskel_store_open(database, &opened->options.store, &opened->store, error);
	if (status == ESKEL_STORE_OK)
		status = fill_memory(opened, error);
	if (status == ESKEL_STORE_OK)
		opened->known = esk_known_new(opened->store, opened->options.most_known_bytes);
	if (status == ESKEL_STORE_OK) {
		opened->calibration = esk_calibration_new(opened);
		opened->pruning = esk_pruning_new(opened);
		if (!opened->known || !opened->calibration || !opened->pruning)
			status = ESKEL_STORE_NO_MEMORY;
	}
	if (status == ESKEL_STORE_OK)
		status = esk_jobs_new(opened, &opened->jobs, error);
	if (status == ESKEL_STORE_OK)
		status = esk_cache_open(
			opened->store, "meshes", opened->options.most_mesh_bytes, &opened->meshes, error);
	if (status == ESKEL_STORE_NO_MEMORY)
		refuse(error, status, "memory ran out");
	if (status != ESKEL_STORE_OK) {
		eskel_api_close(opened);
		return status;
	}
	esk_jobs_begin(opened->jobs);
	*api = opened;
	return status;
}

void eskel_api_close(eskel_api *api)
{
	if (!api)
		return;
	esk_jobs_free(api->jobs);
	esk_cache_close(api->meshes);
	esk_pruning_free(api->pruning);
	esk_calibration_free(api->calibration);
	esk_known_free(api->known);
	eskel_library_free(api->library);
	eskel_store_close(api->store);
	pthread_rwlock_destroy(&api->changing);
	free(api);
}

/* Whoever holds the lock alone knows that no change is under way. */
void esk_api_wait_for_changes(eskel_api *api)
{
	pthread_rwlock_wrlock(&api->changing);
	pthread_rwlock_unlock(&api->changing);
}

size_t eskel_api_shape_count(const eskel_api *api)
{
	return eskel_library_count(api->library);
}

eskel_store *eskel_api_store(eskel_api *api)
{
	return api->store;
}
