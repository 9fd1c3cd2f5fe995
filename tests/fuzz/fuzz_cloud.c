/* Any bytes as an encoded cloud: what is accepted must be what encode gives. And any bytes as an affine and runs: the
 * cloud made of them must survive encoding and be its own canonical form. */
#include "eskel.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

static void expect_encoding(const eskel_cloud *cloud, const uint8_t *bytes, size_t size)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	if (eskel_cloud_encode(cloud, &again, &again_size) != ESKEL_OK)
		abort();
	if (again_size != size || memcmp(again, bytes, size) != 0)
		abort();
	free(again);
}

static void decode_and_encode(const uint8_t *data, size_t size)
{
	eskel_cloud *cloud = NULL;
	eskel_error error = {0};
	if (eskel_cloud_decode(data, size, &cloud, &error) != ESKEL_OK) {
		if (cloud || error.text[0] == '\0')
			abort();
		return;
	}
	expect_encoding(cloud, data, size);
	eskel_cloud_free(cloud);
}

static void make_twice(const eskel_run *runs, const uint32_t *weights, size_t count, const eskel_affine *affine)
{
	eskel_cloud *cloud = NULL, *canonical = NULL, *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	if (eskel_cloud_new(runs, weights, count, affine, &cloud, NULL) != ESKEL_OK)
		return;
	if (eskel_cloud_encode(cloud, &bytes, &size) != ESKEL_OK ||
		eskel_cloud_decode(bytes, size, &decoded, NULL) != ESKEL_OK ||
		eskel_cloud_new(cloud->runs, cloud->weights, cloud->run_count, &cloud->affine, &canonical, NULL) !=
			ESKEL_OK)
		abort();
	expect_encoding(decoded, bytes, size);
	expect_encoding(canonical, bytes, size);
	free(bytes);
	eskel_cloud_free(decoded);
	eskel_cloud_free(canonical);
	eskel_cloud_free(cloud);
}

/* 12 signed bytes of affine in sixteenths, then 5 bytes a run; small indices, so that runs meet. */
static void make_cloud(const uint8_t *data, size_t size)
{
	enum { affine_size = 12, run_size = 5, most_runs = 200 };
	eskel_run runs[most_runs];
	uint32_t weights[most_runs];
	eskel_affine affine;
	size_t count = 0;
	if (size < affine_size)
		return;
	for (int i = 0; i < affine_size; i++)
		affine.m[i / 4][i % 4] = (int8_t)data[i] / 16.0;
	for (size_t at = affine_size; at + run_size <= size && count < most_runs; at += run_size, count++) {
		const uint8_t *b = data + at;
		runs[count] = (eskel_run){b[0], (uint16_t)(b[0] + b[1] % 16), b[2] % 16, b[3] % 16};
		weights[count] = b[4];
	}
	make_twice(runs, NULL, count, &affine);
	make_twice(runs, weights, count, &affine);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	decode_and_encode(data, size);
	make_cloud(data, size);
	return 0;
}
