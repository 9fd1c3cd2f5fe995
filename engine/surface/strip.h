/* A form at a strip of points at once: values and gradients as those of form.h, bit for bit. */
#ifndef ESK_STRIP_H
#define ESK_STRIP_H

#include "form.h"

enum { ESK_STRIP_BLOCKS = 8, ESK_STRIP = ESK_STRIP_BLOCKS * ESK_LANES };

typedef double esk_strip[ESK_STRIP] __attribute__((aligned(64)));

#define ESK_EACH_OF_STRIP(l) _Pragma("omp simd") for (int l = 0; l < ESK_STRIP; l++)

/* Points, where they are in the unit superquadric, and what they turn by on the way there. */
typedef struct {
	const esk_strip *point; /* [axis][lane] */
	esk_strip unit[3], sine, cosine, x_taper, y_taper;
	esk_strip floor; /* not above the potential, but for rounding */
} esk_strip_place;

/* Costs a fraction of the potential. Borrows the points. */
void esk_strip_locate(const esk_form *form, const esk_strip point[3], esk_strip_place *place);
void esk_strip_gradients(const esk_form *form, const esk_strip_place *place, esk_strip values, esk_strip gradients[3]);

#endif
