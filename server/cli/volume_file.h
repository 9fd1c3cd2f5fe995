/* Volumes from files, decoded here and not by the server. */
#ifndef ESK_VOLUME_FILE_H
#define ESK_VOLUME_FILE_H

#include "complain.h"

#include "eskel.h"

/* Reads and decodes the file, keeping only these labels (none: all). Free it with eskel_volume_free. */
esk_outcome esk_volume_file_read(const char *path, const int32_t *labels, size_t label_count, eskel_volume **volume);

#endif
