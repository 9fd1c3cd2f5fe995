/* Tables of labels that give each a colour, a row a line:
 *   ITK-SNAP label descriptions           number  red green blue opacity  visible mesh  "name"
 *   FreeSurfer and 3D Slicer colour tables  number  name  red green blue opacity
 * The numbers but the first are not used. Empty lines and lines that begin with # are passed over, and so is label 0. */
#ifndef ESK_LABEL_COLOURS_H
#define ESK_LABEL_COLOURS_H

#include "label_names.h"

/* Whether a table's text is one of these: its first row begins with a number and a blank. */
bool esk_label_colours_recognize(const char *text);

/* Adds the rows of names->csv. */
esk_outcome esk_label_colours_read(esk_label_names *names);

#endif
