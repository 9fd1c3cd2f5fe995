/* Any bytes as an encoded object of FUZZ_STORED, skeleton or signature: what is accepted must be what encode gives. */
#include "eskel.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

#define JOIN(a, b, c) a##b##c
#define NAME(stored, verb) JOIN(eskel_, stored, verb)

typedef NAME(FUZZ_STORED, ) object;

static void expect_encoding(const object *stored, const uint8_t *bytes, size_t size)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	if (NAME(FUZZ_STORED, _encode)(stored, &again, &again_size) != ESKEL_OK)
		abort();
	if (again_size != size || memcmp(again, bytes, size) != 0)
		abort();
	free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	object *stored = NULL;
	eskel_error error = {0};
	if (NAME(FUZZ_STORED, _decode)(data, size, &stored, &error) != ESKEL_OK) {
		if (stored || error.text[0] == '\0')
			abort();
		return 0;
	}
	expect_encoding(stored, data, size);
	NAME(FUZZ_STORED, _free)(stored);
	return 0;
}
