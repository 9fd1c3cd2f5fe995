/* eskel dicom: DICOM segmentations where volumes are read.
 *
 * A posted file is a volume of the engine's (eskel.h) or a DICOM segmentation, told apart by its content. DICOM has
 * three encodings of its elements, a dictionary of thousands of them, deflation and run lengths; nothing of that is read
 * here. DCMTK's program dcmdrle turns the file into its plainest form, in a process that has the file, a pipe, a share
 * of memory and time, and nothing else; what comes out of the pipe is read as if an attacker had written it.
 * A gzipped one is inflated in such a process first, by gzip.
 */
#ifndef ESKEL_DICOM_H
#define ESKEL_DICOM_H

#include "eskel.h"

/* Bytes in, a volume out. */
typedef struct eskel_intake eskel_intake;

/* options are those of the volume, as long-lived as the intake. tool is the program that decodes DICOM, static; NULL:
 * /usr/bin/dcmdrle. */
ESKEL_API eskel_status eskel_intake_new(const eskel_volume_options *options, const char *tool, eskel_intake **intake);
ESKEL_API void eskel_intake_free(eskel_intake *intake);

/* As eskel_volume_feed. DICOM is kept in a file without a name. */
ESKEL_API eskel_status eskel_intake_feed(eskel_intake *intake, const void *bytes, size_t size, eskel_error *error);

/* As eskel_volume_finish, once; the volume is the caller's then. DICOM is decoded here, which takes up to a minute.
 *
 * Reads segmentations that are binary, fractional with all fractions 0 or 1, or label maps; uncompressed, deflated
 * or, with pixels of whole bytes, run-length encoded. Frames may come in any order, lie anywhere in one grid and be
 * left out. A label is a segment's number, its name the segment's label or, where that says nothing, the meaning of
 * its region or type, with the side that their modifiers say. */
ESKEL_API eskel_status eskel_intake_finish(eskel_intake *intake, eskel_volume **volume, eskel_error *error);

#endif
