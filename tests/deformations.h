/* The map of eskel_surface.h from the unit superquadric to the world: its steps undone, the last one first. What a step depends on
 * is known when it is undone: x at once, then y, then z for the bends and tapers. */
#ifndef DEFORMATIONS_H
#define DEFORMATIONS_H

#include "form.h"

/* From a point before step 5 of eskel_surface.h to world mm. */
void deformations_undo(const esk_form *form, const double unit[3], double world[3]);

#endif
