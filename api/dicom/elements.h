/* The data elements of a DICOM data set in explicit VR little endian, in which every length is known: tags, lengths
 * and values, and sequences of items that hold elements again (PS3.5, section 7). */
#ifndef ESK_ELEMENTS_H
#define ESK_ELEMENTS_H

#include "window.h"

#define ESK_ELEMENTS_DEPTH 16
#define ESK_PIXEL_DATA 0x7fe00010u

/* Where an element is: 0 for none. */
typedef struct {
	uint32_t root;   /* the sequence of the data set that it is in */
	uint32_t parent; /* the innermost sequence that it is in */
	uint32_t tag;    /* group << 16 | element */
} esk_element_place;

typedef struct {
	bool (*wants)(void *reader, const esk_element_place *place);
	/* A value that is wanted. */
	eskel_status (*value)(
		void *reader, const esk_element_place *place, const uint8_t *bytes, size_t size, eskel_error *error);
	/* An item of a sequence of the data set begins or ends. */
	eskel_status (*item)(void *reader, uint32_t sequence, bool begins, eskel_error *error);
} esk_element_visitor;

/* Visits all elements before the pixel data, of which it tells the size in bytes. */
eskel_status esk_elements_read(esk_window *window, const esk_element_visitor *visitor, void *reader,
	uint32_t *pixel_bytes, eskel_error *error);

#endif
