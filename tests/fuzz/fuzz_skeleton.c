/* Any bytes as an encoded skeleton: what is accepted must be what encode gives. */
#include "eskel.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

static void expect_encoding(const eskel_skeleton *skeleton, const uint8_t *bytes, size_t size)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	if (eskel_skeleton_encode(skeleton, &again, &again_size) != ESKEL_OK)
		abort();
	if (again_size != size || memcmp(again, bytes, size) != 0)
		abort();
	free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	eskel_skeleton *skeleton = NULL;
	eskel_error error = {0};
	if (eskel_skeleton_decode(data, size, &skeleton, &error) != ESKEL_OK) {
		if (skeleton || error.text[0] == '\0')
			abort();
		return 0;
	}
	expect_encoding(skeleton, data, size);
	eskel_skeleton_free(skeleton);
	return 0;
}
