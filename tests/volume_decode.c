#include "volume_decode.h"

eskel_status volume_decode(const void *bytes, size_t size, size_t piece, const eskel_volume_options *options,
	eskel_volume **volume, eskel_error *error)
{
	eskel_volume *v = NULL;
	eskel_status status = eskel_volume_new(options, &v);
	for (size_t at = 0; at < size && status == ESKEL_OK; at += piece)
		status =
			eskel_volume_feed(v, (const uint8_t *)bytes + at, piece < size - at ? piece : size - at, error);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(v, error);
	if (status != ESKEL_OK) {
		eskel_volume_free(v);
		v = NULL;
	}
	*volume = v;
	return status;
}
