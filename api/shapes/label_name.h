/* What a label's name says: class and side. */
#ifndef ESK_LABEL_NAME_H
#define ESK_LABEL_NAME_H

#include "eskel_store.h"

/* The class as it is stored and compared: ASCII letters in lower case, words joined by one underscore; words are
 * separated by spaces, quotes and by _ - . , / ( ) [ ]. class has room for strlen(name) + 1; it is empty when there is no
 * word. "Os coxae" gives "os_coxae". */
void esk_label_class(const char *name, char *class);

/* Splits names as TotalSegmentator (femur_left, rib_left_7), 3D Slicer ("left talus"), FreeSurfer (Left-Hippocampus,
 * ctx-lh-precentral), atlases (Hippocampus_L) and people ("hamate bone (right)", "talus sinister", LeftFemur) write them
 * into class and side. left, right, lh, rh, links, rechts and the Latin words count anywhere; l, r, lt, rt, sin and dex as
 * the first or last word only ("vertebra L 4" is no left vertebra). Without a side word, with both sides, with nothing else,
 * or beside "heart", whose halves are no mirror images, the class is the whole name and the side ESKEL_SIDE_UNKNOWN. class
 * has room for strlen(name) + 1. */
void esk_label_split(const char *name, char *class, eskel_side *side);

/* Whether two classes, as esk_label_class makes them, differ at most in the habits of vocabularies: the order of words,
 * "bone", an underscore before a number, "1st" for 1, "vertebrae". So vertebrae_l1 is l1_vertebra, and hamate_bone is
 * hamate. */
bool esk_label_same_class(const char *a, const char *b);

/* What such classes have in common: their words in alphabetical order. False for a class of fillers alone, or of more than
 * 200 bytes. */
#define ESK_LABEL_KEY_SIZE 402
bool esk_label_key(const char *class, char key[ESK_LABEL_KEY_SIZE]);

#endif
