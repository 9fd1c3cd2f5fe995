/* A DICOM data set, made a volume. */
#ifndef ESK_DATA_SET_H
#define ESK_DATA_SET_H

#include "window.h"

/* Reads a segmentation in explicit VR little endian, in which every length is known, into a volume that has not
 * begun. */
eskel_status esk_data_set_read(esk_window_source *get, void *source, eskel_volume *volume, eskel_error *error);

#endif
