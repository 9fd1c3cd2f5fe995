/* What the engine takes from a signature made by anyone. */
#ifndef ESK_SIGNATURE_H
#define ESK_SIGNATURE_H

#include "eskel.h"

/* Zeroed rows for 1 to ESKEL_LEVELS_MAX levels; NULL when memory ran out. */
eskel_signature *esk_signature_alloc(uint32_t level_count);

/* ESKEL_INVALID, with the offending number, unless the signature has 1 to ESKEL_LEVELS_MAX levels, a volume of 1e-20 to
 * 1e25 mm^3 and numbers of 0 to 1e10. A valid cloud stays far inside (its extents are below 1e9 mm), and within these
 * ranges no later sum of class costs can overflow a float. */
eskel_status esk_signature_check(const eskel_signature *signature, eskel_error *error);

#endif
