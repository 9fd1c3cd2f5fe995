/* What people say of a shape, as rows: six columns of its own and its attributes. */
#ifndef ESK_DESCRIPTION_H
#define ESK_DESCRIPTION_H

#include "statement.h"

/* In the order of bind and read. */
#define ESK_DESCRIPTION_COLUMNS "name, class, subject, side, sex, age"

/* INVALID for a side, sex or age outside its range, or attribute keys that do not ascend. */
eskel_store_status esk_description_check(const eskel_description *description, eskel_store_error *error);

void esk_description_bind(esk_statement *s, const eskel_description *description);
/* Into a zeroed description; what it owns is to be cleared, also after a failure. */
void esk_description_read(esk_statement *s, eskel_description *description);

const char *esk_side_name(eskel_side side);
const char *esk_sex_name(eskel_sex sex);

/* Replaces those of the shape. */
eskel_store_status esk_attributes_write(
	sqlite3 *db, int64_t shape, const eskel_description *description, eskel_store_error *error);
/* Adds that of the row. */
void esk_attribute_read(esk_statement *s, eskel_description *description);
eskel_store_status esk_attributes_read(
	sqlite3 *db, int64_t shape, eskel_description *description, eskel_store_error *error);

#endif
