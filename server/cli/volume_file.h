/* Volumes from files, decoded here and not by the server. */
#ifndef ESK_VOLUME_FILE_H
#define ESK_VOLUME_FILE_H

#include "arguments.h"

#include "eskel.h"

/* Reads and decodes the file, keeping the labels that --label names, or all. ESK_REFUSED, with a complaint, for one that
 * no voxel has. Free the volume with eskel_volume_free. */
esk_outcome esk_volume_file_read(const char *path, const esk_arguments *arguments, eskel_volume **volume);

#endif
