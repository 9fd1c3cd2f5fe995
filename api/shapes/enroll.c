/* POST /shapes: the labels of a volume become shapes, all or none.
 *
 * A label whose cloud is stored already is left as it is, so its skeleton is not computed again. Whether it is stored
 * is asked before the long computation and once more under the lock that keeps deletions out; if a shape was deleted
 * between the two, its missing skeleton is computed and the lock taken again. */
#include "calibration.h"
#include "exchange.h"
#include "resources.h"
#include "shape_json.h"
#include "specimen.h"

#include <stdlib.h>

/* Arrays have specimens.count elements. */
typedef struct {
	esk_specimens specimens;
	eskel_shape *shapes;           /* as stored, in the order of the specimens */
	bool *missing;                 /* not stored */
	size_t analysed_count;         /* specimens with a skeleton, to be enrolled; the others are stored already */
	eskel_enrollment *enrollments; /* [analysed_count], as the next two */
	eskel_shape *enrolled;
	bool *created;
	bool done;
	size_t created_count;
} enrolling;

static bool make_room(enrolling *work)
{
	size_t count = work->specimens.count;
	work->shapes = calloc(count, sizeof *work->shapes);
	work->missing = calloc(count, sizeof *work->missing);
	work->enrollments = calloc(count, sizeof *work->enrollments);
	work->enrolled = calloc(count, sizeof *work->enrolled);
	work->created = calloc(count, sizeof *work->created);
	return work->shapes && work->missing && work->enrollments && work->enrolled && work->created;
}

static void clear(enrolling *work)
{
	for (size_t i = 0; work->shapes && i < work->specimens.count; i++)
		eskel_shape_clear(&work->shapes[i]);
	free(work->shapes);
	free(work->missing);
	free(work->enrollments);
	free(work->enrolled);
	free(work->created);
	esk_specimens_clear(&work->specimens);
}

/* Reads a specimen's shape, again if it was read before; stored says whether it is there. */
static bool read_stored(
	eskel_api *api, const esk_specimen *specimen, eskel_shape *shape, bool *stored, esk_problem *problem)
{
	eskel_store_error error = {0};
	eskel_shape_clear(shape);
	eskel_store_status status = eskel_store_shape(api->store, specimen->shape.id, shape, &error);
	*stored = status == ESKEL_STORE_OK;
	return status == ESKEL_STORE_NOT_FOUND || esk_problem_store(problem, status, &error);
}

static bool analyse_missing(eskel_exchange *exchange, enrolling *work)
{
	uint32_t levels = exchange->query.levels ? exchange->query.levels : ESKEL_LEVELS_DEFAULT;
	for (size_t i = 0; i < work->specimens.count; i++) {
		bool stored = false;
		if (work->specimens.items[i].skeleton)
			continue;
		if (!read_stored(
			    exchange->api, &work->specimens.items[i], &work->shapes[i], &stored, &exchange->problem))
			return false;
		work->missing[i] = !stored;
	}
	return esk_specimens_analyse(&work->specimens, work->missing, levels, &exchange->problem);
}

/* Lists what is to be enrolled; *complete is false when a shape that was stored is no longer. */
static bool list_enrollments(eskel_exchange *exchange, enrolling *work, bool *complete)
{
	work->analysed_count = 0;
	*complete = true;
	for (size_t i = 0; i < work->specimens.count && *complete; i++) {
		const esk_specimen *specimen = &work->specimens.items[i];
		if (specimen->skeleton)
			work->enrollments[work->analysed_count++] = (eskel_enrollment){
				.cloud = specimen->cloud,
				.skeleton = specimen->skeleton,
				.signature = specimen->signature,
				.description = &specimen->shape.description,
				.label = specimen->shape.label,
				.warnings = specimen->shape.warnings,
				.warning_count = specimen->shape.warning_count,
			};
		else if (!read_stored(exchange->api, specimen, &work->shapes[i], complete, &exchange->problem))
			return false;
	}
	return true;
}

/* Takes back the first count enrollments, when the library had no memory for the one after. */
static void take_back(eskel_exchange *exchange, enrolling *work, size_t count)
{
	for (size_t i = 0; i < work->analysed_count; i++) {
		int64_t key;
		if (!work->created[i])
			continue;
		if (i < count)
			eskel_library_remove(exchange->api->library, work->enrolled[i].key);
		eskel_store_delete(exchange->api->store, exchange->actor, work->enrolled[i].id, 0, &key, NULL);
		esk_known_drop(exchange->api->known, work->enrolled[i].key);
		esk_calibration_note(exchange->api->calibration, work->enrolled[i].key);
	}
}

static bool add_to_library(eskel_exchange *exchange, enrolling *work)
{
	for (size_t i = 0; i < work->analysed_count; i++) {
		if (!work->created[i])
			continue;
		eskel_status status = eskel_library_add(
			exchange->api->library, work->enrolled[i].key, work->enrollments[i].signature);
		if (status != ESKEL_OK) {
			take_back(exchange, work, i);
			return esk_problem_engine(&exchange->problem, status, NULL);
		}
		esk_calibration_note(exchange->api->calibration, work->enrolled[i].key);
		work->created_count++;
	}
	return true;
}

/* Moves the shapes as stored to their specimens' places. */
static void collect(enrolling *work)
{
	for (size_t i = 0, next = 0; i < work->specimens.count; i++)
		if (work->specimens.items[i].skeleton)
			work->shapes[i] = work->enrolled[next++];
}

/* Under the shared lock. work->done stays false when a skeleton has become missing. */
static bool commit(eskel_exchange *exchange, enrolling *work)
{
	eskel_store_error error = {0};
	bool complete = false;
	if (!list_enrollments(exchange, work, &complete))
		return false;
	if (!complete)
		return true;
	if (work->analysed_count > 0) {
		eskel_store_status status = eskel_store_enroll(exchange->api->store, exchange->actor, work->enrollments,
			work->analysed_count, work->enrolled, work->created, &error);
		if (!esk_problem_store(&exchange->problem, status, &error))
			return false;
		collect(work);
	}
	return work->done = add_to_library(exchange, work);
}

static bool enroll(eskel_exchange *exchange, enrolling *work)
{
	if (!esk_specimens_take(exchange, &exchange->query, &work->specimens))
		return false;
	if (!make_room(work))
		return esk_problem_no_memory(&exchange->problem);
	while (!work->done) {
		if (!analyse_missing(exchange, work))
			return false;
		pthread_rwlock_rdlock(&exchange->api->changing);
		bool good = commit(exchange, work);
		pthread_rwlock_unlock(&exchange->api->changing);
		if (!good)
			return false;
	}
	if (work->specimens.count == 1 &&
		!esk_exchange_add_header(exchange, "Location", "/shapes/%s", work->shapes[0].id))
		return false;
	if (!esk_exchange_add_header(exchange, "Eskel-Added", "%zu", work->created_count))
		return false;
	return esk_exchange_answer_json(exchange, work->created_count > 0 ? 201 : 200,
		json_pack("{s:o}", "shapes", esk_shapes_json(work->shapes, work->specimens.count)));
}

bool esk_enroll(eskel_exchange *exchange)
{
	enrolling work = {0};
	bool good = enroll(exchange, &work);
	clear(&work);
	return good;
}
