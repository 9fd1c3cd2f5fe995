#include "volume_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static esk_outcome feed(const char *path, FILE *file, eskel_volume *volume)
{
	enum { piece_size = 1 << 16 };
	char *piece = malloc(piece_size);
	eskel_error error = {.status = piece ? ESKEL_OK : ESKEL_NO_MEMORY};
	eskel_status status = error.status;
	size_t size;
	if (!piece)
		snprintf(error.text, sizeof error.text, "memory ran out");
	while (!status && (size = fread(piece, 1, piece_size, file)) > 0)
		status = eskel_volume_feed(volume, piece, size, &error);
	free(piece);
	if (ferror(file))
		return esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	if (!status)
		status = eskel_volume_finish(volume, &error);
	return status ? esk_complain(ESK_REFUSED, "%s: %s", path, error.text) : ESK_DONE;
}

esk_outcome esk_volume_file_read(const char *path, const int32_t *labels, size_t label_count, eskel_volume **volume)
{
	const eskel_volume_options options = {.labels = labels, .label_count = label_count};
	eskel_volume *made = NULL;
	FILE *file = fopen(path, "re");
	if (!file)
		return esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	eskel_status status = eskel_volume_new(&options, &made);
	esk_outcome outcome =
		status ? esk_complain(ESK_REFUSED, "%s: %s", path, eskel_status_text(status)) : feed(path, file, made);
	fclose(file);
	if (outcome)
		eskel_volume_free(made);
	else
		*volume = made;
	return outcome;
}
