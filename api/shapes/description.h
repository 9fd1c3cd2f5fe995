/* What people say of a shape: taken from a query when it is posted, changed by a merge patch (RFC 7396) later. */
#ifndef ESK_DESCRIPTION_H
#define ESK_DESCRIPTION_H

#include "parameters.h"

/* What a query says of one label. Without a name there, the label has the one that its file gives it (NULL: none). Where
 * the query gives no class or no side, the name may (esk_label_split). Where it says as_said, neither file nor name tells. The description must be clear
 * (eskel_description_clear); false when memory ran out. */
bool esk_description_of_label(
	const esk_parameters *query, int32_t label, const char *name_in_file, eskel_description *description);

/* Applies a JSON merge patch; a null removes. Types and members are strict; 400 for text that is no JSON object, 422 for
 * one that is no patch. After a failure the description is to be cleared, not used. */
bool esk_description_patch(eskel_description *description, const char *json, size_t size, esk_problem *problem);

#endif
