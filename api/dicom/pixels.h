/* The pixels of frames, turned into runs. */
#ifndef ESK_PIXELS_H
#define ESK_PIXELS_H

#include "segmentation.h"

/* Reads the frames from the window, which is at the first of them, and adds their runs to the volume. ESKEL_BAD_VALUE
 * for a fraction between 0 and 1. */
eskel_status esk_pixels_read(
	esk_window *window, const esk_segmentation *segmentation, eskel_volume *volume, eskel_error *error);

#endif
