/* Any bytes as an encoded signature: what is accepted must be what encode gives. */
#include "eskel.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

static void expect_encoding(const eskel_signature *signature, const uint8_t *bytes, size_t size)
{
	uint8_t *again = NULL;
	size_t again_size = 0;
	if (eskel_signature_encode(signature, &again, &again_size) != ESKEL_OK)
		abort();
	if (again_size != size || memcmp(again, bytes, size) != 0)
		abort();
	free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	eskel_signature *signature = NULL;
	eskel_error error = {0};
	if (eskel_signature_decode(data, size, &signature, &error) != ESKEL_OK) {
		if (signature || error.text[0] == '\0')
			abort();
		return 0;
	}
	expect_encoding(signature, data, size);
	eskel_signature_free(signature);
	return 0;
}
