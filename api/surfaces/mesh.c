/* GET /shapes/{id}/mesh: a shape's surface as triangles, in a file that other programs read.
 *
 * A mesh follows from the shape's content, the query and the engine alone. So its entity tag is a digest of these, known before
 * the mesh is made; a client that has it is told so without; and files are kept under that name (cache.h), that
 * of the shape in front so that they go with it. */
#include "mesh.h"

#include "byte_range.h"
#include "cache.h"
#include "detail.h"
#include "etag.h"
#include "file_body.h"
#include "resources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Raised whenever the engine makes another mesh, or another file, of the same question. */
#define MESHES "meshes 2"

enum { MOST_TRIANGLES = 1 << 20 }; /* 70 MB as OBJ, which is the largest */

static const struct {
	const char *content_type;
	eskel_mesh_format format;
} formats[] = {
	[ESK_MESH_GLB] = {"model/gltf-binary", ESKEL_MESH_GLB},
	[ESK_MESH_STL] = {"model/stl", ESKEL_MESH_STL},
	[ESK_MESH_PLY] = {"application/ply", ESKEL_MESH_PLY},
	[ESK_MESH_OBJ] = {"model/obj", ESKEL_MESH_OBJ},
};

typedef struct {
	esk_drawn drawn;
	uint32_t level;
	double step;
	eskel_fitted fitted;                          /* bytes NULL: best ellipsoids */
	char name[ESKEL_ID_SIZE + ESKEL_SHA256_SIZE]; /* of the file: id-digest */
	char etag[ESKEL_ID_SIZE + 2];
} request;

bool esk_mesh_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	const bool composed = query->compose != ESK_COMPOSE_UNSAID,
		   primitive = query->primitive != ESK_PRIMITIVE_UNSAID;
	const bool far = !isnan(query->eye_distance), fine = query->level || query->step > 0;
	if (composed && primitive && query->primitive != ESK_PRIMITIVE_ELLIPSOID)
		return esk_problem_set(&exchange->problem, 400,
			"compose is given beside a primitive that is fitted, expected none: it is composed as it "
			"was fitted");
	if (far && fine)
		return esk_problem_set(&exchange->problem, 400,
			"distance is given beside level or step, expected none of these: it chooses both");
	return query->source != ESK_SOURCE_VOXELS || !(fine || far || composed || primitive) ||
	       esk_problem_set(&exchange->problem, 400,
		       "level, step, distance, primitive or compose is given beside source=voxels, expected none: "
		       "voxels are what they are");
}

/* ---- the question */

static void write_name(eskel_exchange *exchange, request *r)
{
	const esk_parameters *query = &exchange->query;
	char question[300], digest[ESKEL_SHA256_SIZE];
	const int size = snprintf(question, sizeof question, MESHES " %s level %u step %.17g fitted %s %s %s %s %s",
		exchange->id, r->level, r->step, r->fitted.sha256,
		query->compose == ESK_COMPOSE_UNION ? "union" : "blend", esk_parameters_choice(query, "source"),
		esk_parameters_choice(query, "format/mesh"), esk_parameters_choice(query, "frame"));
	eskel_digest(question, (size_t)size, digest);
	snprintf(r->name, sizeof r->name, "%s-%s", exchange->id, digest);
	snprintf(r->etag, sizeof r->etag, "\"%.32s\"", digest);
}

/* The level and the step that are asked for, those for a distance, or else the finest. */
static bool choose_detail(eskel_exchange *exchange, request *r)
{
	const esk_parameters *query = &exchange->query;
	if (!isnan(query->eye_distance)) {
		const esk_detail detail = esk_detail_at(r->drawn.skeleton, query->eye_distance);
		r->level = detail.level;
		r->step = detail.step;
		return true;
	}
	r->step = query->step > 0 ? query->step : esk_detail_step(r->drawn.skeleton);
	return esk_drawn_level(exchange, &r->drawn, &r->level);
}

static bool read_request(eskel_exchange *exchange, request *r)
{
	if (!esk_drawn_read(exchange, &r->drawn) || !choose_detail(exchange, r))
		return false;
	const unsigned primitive = exchange->query.primitive;
	if (primitive != ESK_PRIMITIVE_UNSAID && primitive != ESK_PRIMITIVE_ELLIPSOID &&
		!esk_drawn_fitted(exchange, &r->drawn, r->level, &r->fitted))
		return false;
	if (exchange->query.source == ESK_SOURCE_VOXELS) {
		r->level = 0;
		r->step = 0;
	}
	write_name(exchange, r);
	return true;
}

/* ---- making it */

static bool mesh_voxels(eskel_exchange *exchange, const request *r, eskel_mesh **mesh)
{
	eskel_store_error store_error = {0};
	eskel_error error = {0};
	eskel_cloud *cloud = NULL;
	const bool good = esk_problem_store(&exchange->problem,
				  eskel_store_cloud(exchange->api->store, r->drawn.shape.key, &cloud, &store_error),
				  &store_error) &&
			  esk_problem_engine(&exchange->problem, eskel_cloud_mesh(cloud, mesh, &error), &error);
	eskel_cloud_free(cloud);
	return good;
}

static bool mesh_surface(eskel_exchange *exchange, const request *r, eskel_mesh **mesh)
{
	eskel_error error = {0};
	eskel_surface *surface = NULL;
	const bool made =
		r->fitted.bytes
			? esk_problem_engine(&exchange->problem,
				  eskel_surface_decode(r->fitted.bytes, r->fitted.size, &surface, &error), &error)
			: esk_drawn_surface(exchange, &r->drawn, r->level, &surface);
	const bool good = made && esk_problem_engine(&exchange->problem,
					  eskel_surface_mesh(surface, r->step, MOST_TRIANGLES, mesh, &error), &error);
	eskel_surface_free(surface);
	return good;
}

static bool take_bytes(void *context, const uint8_t *bytes, size_t size)
{
	esk_text *text = context;
	esk_text_append(text, (const char *)bytes, size);
	return !text->failed;
}

/* The whole file, in memory. */
static bool make_file(eskel_exchange *exchange, const request *r, esk_text *file)
{
	const esk_parameters *query = &exchange->query;
	const eskel_frame frame = query->frame == ESK_FRAME_LPS ? ESKEL_FRAME_LPS : ESKEL_FRAME_RAS;
	eskel_mesh *mesh = NULL;
	bool good =
		query->source == ESK_SOURCE_VOXELS ? mesh_voxels(exchange, r, &mesh) : mesh_surface(exchange, r, &mesh);
	if (good) {
		const eskel_status status =
			eskel_mesh_write(mesh, formats[query->mesh_format].format, frame, take_bytes, file);
		good = file->failed ? esk_problem_no_memory(&exchange->problem)
				    : esk_problem_engine(&exchange->problem, status, NULL);
	}
	eskel_mesh_free(mesh);
	return good;
}

/* ---- answering it */

/* How a mesh may be kept: by the client alone, for it is not everybody's, and for as long as it likes, for it never changes;
 * but that of a fitted surface, which may be fitted anew, has to be asked about. */
static bool add_headers(eskel_exchange *exchange, const request *r)
{
	return esk_exchange_add_header(exchange, "ETag", "%s", r->etag) &&
	       esk_exchange_add_header(exchange, "Cache-Control", "%s",
		       r->fitted.bytes ? "private, no-cache" : "private, max-age=31536000, immutable");
}

/* 206 or 200, and the part of the body. */
static bool choose_part(eskel_exchange *exchange, const request *r, uint64_t total, int *status, esk_byte_range *part)
{
	const char *condition = esk_exchange_request_header(exchange, "If-Range");
	const bool same = !condition || strcmp(condition, r->etag) == 0;
	const char *range = same ? esk_exchange_request_header(exchange, "Range") : NULL;
	if (!esk_byte_range_parse(range, total, part))
		return esk_exchange_add_header(exchange, "Content-Range", "bytes */%llu", (unsigned long long)total) &&
		       esk_problem_set(&exchange->problem, 416, "Range is %.60s, expected to begin before byte %llu",
			       range, (unsigned long long)total);
	*status = part->partial ? 206 : 200;
	if (!part->partial)
		return esk_exchange_add_header(exchange, "Accept-Ranges", "bytes");
	return esk_exchange_add_header(exchange, "Content-Range", "bytes %llu-%llu/%llu",
		(unsigned long long)part->first, (unsigned long long)(part->first + part->size - 1),
		(unsigned long long)total);
}

/* Takes the descriptor. */
static bool answer_file(eskel_exchange *exchange, const request *r, int descriptor, uint64_t size)
{
	const char *type = formats[exchange->query.mesh_format].content_type;
	int status;
	esk_byte_range part;
	if (add_headers(exchange, r) && choose_part(exchange, r, size, &status, &part))
		return esk_exchange_answer_file(exchange, status, type, descriptor, part.first, part.size);
	close(descriptor);
	return false;
}

/* Takes the bytes. */
static bool answer_bytes(eskel_exchange *exchange, const request *r, esk_text *file)
{
	const char *type = formats[exchange->query.mesh_format].content_type;
	int status;
	esk_byte_range part;
	if (!add_headers(exchange, r) || !choose_part(exchange, r, file->size, &status, &part)) {
		free(file->bytes);
		return false;
	}
	memmove(file->bytes, file->bytes + part.first, (size_t)part.size);
	return esk_exchange_answer(exchange, status, type, file->bytes, (size_t)part.size);
}

/* A shape that was deleted while its mesh was made leaves nothing: whichever comes last, the deletion or this, drops it. */
static void keep_file(const eskel_exchange *exchange, const request *r, const esk_text *file)
{
	eskel_shape shape = {0};
	esk_cache_put(exchange->api->meshes, r->name, file->bytes, file->size);
	if (eskel_store_shape(exchange->api->store, exchange->id, &shape, NULL) != ESKEL_STORE_OK)
		esk_cache_drop(exchange->api->meshes, exchange->id);
	eskel_shape_clear(&shape);
}

static bool answer_kept(eskel_exchange *exchange, const request *r, bool *good)
{
	int descriptor;
	uint64_t size;
	const bool kept = esk_cache_find(exchange->api->meshes, r->name, &descriptor, &size);
	if (kept)
		*good = answer_file(exchange, r, descriptor, size);
	return kept;
}

static bool answer_made(eskel_exchange *exchange, const request *r)
{
	esk_text file = {0};
	if (!make_file(exchange, r, &file)) {
		free(file.bytes);
		return false;
	}
	keep_file(exchange, r, &file);
	return answer_bytes(exchange, r, &file);
}

/* Looks once more in its turn: another's may have ended since. */
static bool answer_in_turn(eskel_exchange *exchange, const request *r)
{
	esk_cache *meshes = exchange->api->meshes;
	esk_cache_turn turn;
	bool good;
	const bool begun = esk_cache_begin(meshes, r->name, &turn);
	if (!answer_kept(exchange, r, &good))
		good = answer_made(exchange, r);
	if (begun)
		esk_cache_end(meshes, &turn);
	return good;
}

static bool answer(eskel_exchange *exchange, const request *r)
{
	const char *known = esk_exchange_request_header(exchange, "If-None-Match");
	bool good;
	if (known && esk_etag_is_listed(known, r->etag, true))
		return add_headers(exchange, r) && esk_exchange_answer_nothing(exchange, 304);
	return answer_kept(exchange, r, &good) ? good : answer_in_turn(exchange, r);
}

bool esk_mesh_get(eskel_exchange *exchange)
{
	request r = {0};
	const bool good = read_request(exchange, &r) && answer(exchange, &r);
	eskel_fitted_clear(&r.fitted);
	esk_drawn_clear(&r.drawn);
	return good;
}
