/* What a label's name says: class and side. */
#ifndef ESK_LABEL_NAME_H
#define ESK_LABEL_NAME_H

#include "eskel_store.h"

/* The class as it is stored and compared: ASCII letters in lower case, words joined by one underscore; words are
 * separated by spaces and by _ - . , / ( ) [ ]. class has room for strlen(name) + 1; it is empty when there is no
 * word. "Os coxae" gives "os_coxae". */
void esk_label_class(const char *name, char *class);

/* Splits femur_left, Hippocampus_L, "left talus", Left-Hippocampus and "hamate bone (right)" into class and side.
 * left, right, lh and rh count anywhere; l and r as the first or last word only ("vertebra L 4" is no left vertebra). Without a side word, with both sides, or with nothing else, the class is the whole name and the side
 * ESKEL_SIDE_UNKNOWN. */
void esk_label_split(const char *name, char *class, eskel_side *side);

#endif
