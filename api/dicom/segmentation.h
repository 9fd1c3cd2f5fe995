/* What the head of a DICOM segmentation says (PS3.3, A.51 and C.8.20). */
#ifndef ESK_SEGMENTATION_H
#define ESK_SEGMENTATION_H

#include "window.h"

/* A name fits what the engine takes, with the word for a side behind it. */
#define ESK_SEGMENT_TEXT 192

typedef enum { ESK_CODED_NOTHING, ESK_CODED_LEFT, ESK_CODED_RIGHT } esk_coded_side;

typedef struct {
	uint16_t number;
	char label[ESK_SEGMENT_TEXT], type[ESK_SEGMENT_TEXT], region[ESK_SEGMENT_TEXT]; /* UTF-8 if the file's is */
	esk_coded_side type_side, region_side;                                          /* of their modifiers */
} esk_dicom_segment;

/* What a functional group says of planes, in mm and in the patient's space: left, posterior, superior. */
typedef struct {
	double orientation[6]; /* unit vectors along a row and along a column */
	double spacing[2];     /* between rows and between columns */
	double thickness;      /* of a slice; 0: not said */
	double between;        /* slices; 0: not said */
	double position[3];    /* of the centre of the first pixel */
	uint16_t segment;      /* its number; 0: not said */
	bool oriented, spaced, positioned;
} esk_plane;

typedef struct {
	double position[3];
	uint16_t segment;  /* 0 in a label map */
	uint16_t place[3]; /* of the first pixel in the grid (grid.h) */
} esk_frame;

typedef enum { ESK_BINARY, ESK_FRACTIONAL, ESK_LABEL_MAP } esk_segmentation_type;

typedef struct {
	char character_set[17];
	bool is_segmentation;
	esk_segmentation_type type;
	uint16_t rows, columns, samples, bits, most_fraction, background;
	uint32_t frames_announced;
	size_t segment_count, segment_capacity, frame_count, frame_capacity;
	esk_dicom_segment *segments;
	esk_frame *frames;
	esk_plane shared;  /* by all frames */
	esk_plane first;   /* frame, and what is shared */
	esk_plane current; /* frame, while it is read */
} esk_segmentation;

/* Reads up to the pixels, of which it tells the size in bytes; checks that they can be read here. The segmentation is
 * all-zero before, and the caller's to clear, also on failure. */
eskel_status esk_segmentation_read(
	esk_window *window, esk_segmentation *segmentation, uint32_t *pixel_bytes, eskel_error *error);
void esk_segmentation_clear(esk_segmentation *segmentation);

#endif
