/* Any bytes as an encoded surface: what is accepted must be what encode gives, and a field that can be evaluated. */
#include "eskel.h"
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void expect_encoding(const eskel_surface *surface, const uint8_t *bytes, size_t size)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	if (eskel_surface_encode(surface, &again, &again_size) != ESKEL_OK)
		abort();
	if (again_size != size || memcmp(again, bytes, size) != 0)
		abort();
	free(again);
}

static void expect_values(const eskel_surface *surface)
{
	for (uint32_t i = 0; i < eskel_surface_count(surface); i++) {
		double gradient[3];
		const double *centre = eskel_surface_primitive(surface, i)->centre;
		if (!(eskel_surface_gradient(surface, centre, gradient) < INFINITY))
			abort();
		if (!isfinite(eskel_surface_distance(surface, centre, NULL)))
			abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	eskel_surface *surface = NULL;
	eskel_error error = {0};
	if (eskel_surface_decode(data, size, &surface, &error) != ESKEL_OK) {
		if (surface || error.text[0] == '\0')
			abort();
		return 0;
	}
	expect_encoding(surface, data, size);
	expect_values(surface);
	eskel_surface_free(surface);
	return 0;
}
