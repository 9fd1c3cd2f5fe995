/* GET, PATCH and DELETE /shapes/{id}. The entity tag names the stored row and its revision, so that a shape which was
 * deleted and enrolled again has another one. */
#include "description.h"
#include "cache.h"
#include "calibration.h"
#include "etag.h"
#include "exchange.h"
#include "resources.h"
#include "shape_json.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define ETAG_SIZE 48

static void write_etag(const eskel_shape *shape, char etag[ETAG_SIZE])
{
	snprintf(etag, ETAG_SIZE, "\"%" PRId64 "-%" PRId64 "\"", shape->key, shape->revision);
}

static bool check_if_match(eskel_exchange *exchange, const char *etag)
{
	const char *wanted = esk_exchange_request_header(exchange, "If-Match");
	if (!wanted || esk_etag_is_listed(wanted, etag, false))
		return true;
	return esk_problem_set(&exchange->problem, 412,
		"If-Match is %.80s, expected %s: the shape has changed since it was read", wanted, etag);
}

bool esk_shape_of_id(eskel_exchange *exchange, const char *id, eskel_shape *shape)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_store_shape(exchange->api->store, id, shape, &error);
	if (status == ESKEL_STORE_NOT_FOUND)
		return esk_problem_no_shape(&exchange->problem, id);
	return esk_problem_store(&exchange->problem, status, &error);
}

static bool answer_shape(eskel_exchange *exchange, const eskel_shape *shape)
{
	char etag[ETAG_SIZE];
	write_etag(shape, etag);
	return esk_exchange_add_header(exchange, "ETag", "%s", etag) &&
	       esk_exchange_answer_json(exchange, 200, esk_shape_json(shape));
}

bool esk_shape_get(eskel_exchange *exchange)
{
	eskel_shape shape = {0};
	char etag[ETAG_SIZE];
	const char *known = esk_exchange_request_header(exchange, "If-None-Match");
	if (!esk_shape_of_id(exchange, exchange->id, &shape))
		return false;
	write_etag(&shape, etag);
	bool good = check_if_match(exchange, etag);
	if (good && known && esk_etag_is_listed(known, etag, true))
		good = esk_exchange_add_header(exchange, "ETag", "%s", etag) &&
		       esk_exchange_answer_nothing(exchange, 304);
	else if (good)
		good = answer_shape(exchange, &shape);
	eskel_shape_clear(&shape);
	return good;
}

/* Reads the shape that a change is about; its entity tag must be one that the client expects. */
static bool read_for_change(eskel_exchange *exchange, eskel_shape *shape)
{
	char etag[ETAG_SIZE];
	if (!esk_shape_of_id(exchange, exchange->id, shape))
		return false;
	write_etag(shape, etag);
	return check_if_match(exchange, etag);
}

/* Both changes have the lock alone from reading the shape on: nobody else can change it meanwhile. */

static bool patch(eskel_exchange *exchange, eskel_shape *shape, eskel_shape *patched)
{
	eskel_store_error error = {0};
	if (!read_for_change(exchange, shape) || !esk_description_patch(&shape->description, exchange->json.bytes,
							 exchange->json.size, &exchange->problem))
		return false;
	eskel_store_status status = eskel_store_describe(exchange->api->store, exchange->actor, exchange->id,
		shape->revision, &shape->description, patched, &error);
	if (status == ESKEL_STORE_OK) {
		esk_known_drop(exchange->api->known, shape->key);
		esk_calibration_note(exchange->api->calibration, shape->key);
	}
	return esk_problem_store(&exchange->problem, status, &error);
}

bool esk_shape_patch(eskel_exchange *exchange)
{
	eskel_shape shape = {0}, patched = {0};
	pthread_rwlock_wrlock(&exchange->api->changing);
	bool good = patch(exchange, &shape, &patched);
	pthread_rwlock_unlock(&exchange->api->changing);
	good = good && answer_shape(exchange, &patched);
	eskel_shape_clear(&shape);
	eskel_shape_clear(&patched);
	return good;
}

static bool delete_shape(eskel_exchange *exchange, eskel_shape *shape)
{
	eskel_store_error error = {0};
	int64_t key;
	if (!read_for_change(exchange, shape))
		return false;
	eskel_store_status status =
		eskel_store_delete(exchange->api->store, exchange->actor, exchange->id, shape->revision, &key, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	/* Without memory the library keeps the key; readers drop neighbours that the store has not. */
	eskel_library_remove(exchange->api->library, key);
	esk_known_drop(exchange->api->known, key);
	esk_calibration_note(exchange->api->calibration, key);
	return true;
}

bool esk_shape_delete(eskel_exchange *exchange)
{
	eskel_shape shape = {0};
	pthread_rwlock_wrlock(&exchange->api->changing);
	bool good = delete_shape(exchange, &shape);
	pthread_rwlock_unlock(&exchange->api->changing);
	if (good)
		esk_cache_drop(exchange->api->meshes, exchange->id);
	eskel_shape_clear(&shape);
	return good && esk_exchange_answer_nothing(exchange, 204);
}
