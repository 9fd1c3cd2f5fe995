/* The label names in the header extensions of a NIfTI file. */
#ifndef ESK_NIFTI_LABELS_H
#define ESK_NIFTI_LABELS_H

#include "segments.h"

/* Adds the names that the extensions tell; bytes are the file's from the extension flag to the voxels, or the first of them.
 * Where they break off or are no XML it is ESKEL_MALFORMED, and the names before stay. ESKEL_NO_MEMORY. */
eskel_status esk_nifti_labels_read(const uint8_t *bytes, size_t size, bool big_endian, esk_segments *segments);

#endif
