/* Fills a database for the measurements of a server: bench_fill DATABASE SHAPES [LEVELS], which prints the ids.
 *
 * Signatures are synthetic, in clusters of twenty; clouds and skeletons are those of a few small shapes, each at places
 * of its own, since a hundred thousand real ones would take an hour. Skeletons are most of the file, 20 kB a shape, and
 * a start does not read them: with LEVELS 1, in place of 16, they leave 4 kB. */
#include "eskel_store.h"
#include "shapes.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MODELS = 50, BATCH = 500, MEMBERS = 20, LEVELS = 16 };

typedef struct {
	eskel_cloud *cloud;
	eskel_skeleton *skeleton;
} model;

typedef struct {
	char class[32], subject[32], device[32];
	eskel_attribute attribute;
	eskel_description description;
} said;

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "bench_fill: %s\n", what);
	exit(1);
}

static void make_models(uint32_t levels, model models[MODELS])
{
	for (int m = 0; m < MODELS; m++) {
		shapes_solid solid = shapes_hamate;
		solid.scale = 0.3 + 0.004 * m;
		models[m].cloud = shapes_cloud(&solid, &shapes_identity);
		require(!eskel_skeleton_new(models[m].cloud, &(eskel_skeleton_options){.levels = levels},
				&models[m].skeleton, NULL),
			"no skeleton");
	}
}

/* Fifty classes, two sides, a subject for two hundred shapes, four devices. */
static const eskel_description *describe(size_t n, said *of)
{
	snprintf(of->class, sizeof of->class, "class%zu", n / MEMBERS % 50);
	snprintf(of->subject, sizeof of->subject, "subject%zu", n / 200);
	snprintf(of->device, sizeof of->device, "device%zu", n % 4);
	of->attribute = (eskel_attribute){.key = (char *)"device", .value = of->device};
	of->description = (eskel_description){.name = (char *)"synthetic",
		.class = of->class,
		.subject = of->subject,
		.side = n % 2 ? ESKEL_SIDE_LEFT : ESKEL_SIDE_RIGHT,
		.age = NAN,
		.attribute_count = 1,
		.attributes = &of->attribute};
	return &of->description;
}

static void store_batch(eskel_store *store, const model models[MODELS], size_t first, size_t count)
{
	static said descriptions[BATCH];
	static eskel_enrollment enrollments[BATCH];
	static eskel_cloud clouds[BATCH];
	static eskel_signature *signatures[BATCH];
	static eskel_shape shapes[BATCH];
	static bool created[BATCH];
	for (size_t i = 0; i < count; i++) {
		const size_t n = first + i;
		const model *m = &models[n % MODELS];
		clouds[i] = *m->cloud;
		clouds[i].affine.m[0][3] = (double)(n / MODELS);
		signatures[i] = synthetic_signature(n / MEMBERS, n, 0.15, LEVELS);
		enrollments[i] = (eskel_enrollment){.cloud = &clouds[i],
			.skeleton = m->skeleton,
			.signature = signatures[i],
			.description = describe(n, &descriptions[i]),
			.label = 1};
	}
	eskel_store_error error;
	if (eskel_store_enroll(store, NULL, enrollments, count, shapes, created, &error))
		require(false, error.text);
	for (size_t i = 0; i < count; i++) {
		require(created[i], "a shape was there already");
		puts(shapes[i].id);
		eskel_shape_clear(&shapes[i]);
		eskel_signature_free(signatures[i]);
	}
}

int main(int argc, char **argv)
{
	require(argc == 3 || argc == 4, "usage: bench_fill DATABASE SHAPES [LEVELS]");
	const size_t shapes = strtoull(argv[2], NULL, 10);
	static model models[MODELS];
	eskel_store *store = NULL;
	eskel_store_error error;
	if (eskel_store_open(argv[1], NULL, &store, &error))
		require(false, error.text);
	make_models(argc == 4 ? (uint32_t)atoi(argv[3]) : LEVELS, models);
	for (size_t n = 0; n < shapes; n += BATCH)
		store_batch(store, models, n, shapes - n < BATCH ? shapes - n : BATCH);
	eskel_store_close(store);
	for (int m = 0; m < MODELS; m++) {
		eskel_cloud_free(models[m].cloud);
		eskel_skeleton_free(models[m].skeleton);
	}
	return 0;
}
