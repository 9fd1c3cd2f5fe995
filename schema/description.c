#include "description.h"

#include "array.h"
#include "status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const sides[] = {
	[ESKEL_SIDE_UNKNOWN] = NULL,
	[ESKEL_SIDE_LEFT] = "left",
	[ESKEL_SIDE_RIGHT] = "right",
	[ESKEL_SIDE_NONE] = "none",
};
enum { side_count = sizeof sides / sizeof sides[0] };

static const char *const sexes[] = {
	[ESKEL_SEX_UNKNOWN] = NULL,
	[ESKEL_SEX_FEMALE] = "female",
	[ESKEL_SEX_MALE] = "male",
};
enum { sex_count = sizeof sexes / sizeof sexes[0] };

const char *esk_side_name(eskel_side side)
{
	return (unsigned)side < side_count ? sides[side] : NULL;
}

const char *esk_sex_name(eskel_sex sex)
{
	return (unsigned)sex < sex_count ? sexes[sex] : NULL;
}

eskel_store_status esk_description_check(const eskel_description *description, eskel_store_error *error)
{
	const eskel_description *d = description;
	if ((unsigned)d->side >= side_count)
		return esk_status_fail(
			error, ESKEL_STORE_INVALID, "the side is %d, expected 0 to %d", (int)d->side, side_count - 1);
	if ((unsigned)d->sex >= sex_count)
		return esk_status_fail(
			error, ESKEL_STORE_INVALID, "the sex is %d, expected 0 to %d", (int)d->sex, sex_count - 1);
	if (isinf(d->age) || d->age < 0)
		return esk_status_fail(error, ESKEL_STORE_INVALID, "the age is %g years, expected at least 0", d->age);
	for (size_t i = 0; i < d->attribute_count; i++) {
		const eskel_attribute *a = &d->attributes[i];
		if (!a->key || !a->value)
			return esk_status_fail(error, ESKEL_STORE_INVALID, "attribute %zu has no key or no value", i);
		if (i && strcmp(a[-1].key, a->key) >= 0)
			return esk_status_fail(error, ESKEL_STORE_INVALID,
				"the key of attribute %zu does not come after the one before it", i);
	}
	return ESKEL_STORE_OK;
}

void esk_description_bind(esk_statement *s, const eskel_description *description)
{
	esk_bind_text(s, description->name);
	esk_bind_text(s, description->class);
	esk_bind_text(s, description->subject);
	esk_bind_text(s, esk_side_name(description->side));
	esk_bind_text(s, esk_sex_name(description->sex));
	esk_bind_double(s, description->age);
}

void esk_description_read(esk_statement *s, eskel_description *description)
{
	description->name = esk_column_text(s);
	description->class = esk_column_text(s);
	description->subject = esk_column_text(s);
	description->side = (eskel_side)esk_column_name(s, sides, side_count);
	description->sex = (eskel_sex)esk_column_name(s, sexes, sex_count);
	description->age = esk_column_double(s);
}

static eskel_store_status write_attribute(
	sqlite3 *db, int64_t shape, const eskel_attribute *attribute, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "INSERT INTO attribute (shape, key, value) VALUES (?, ?, ?)");
	esk_bind_int64(&s, shape);
	esk_bind_text(&s, attribute->key);
	esk_bind_text(&s, attribute->value);
	return esk_statement_run(&s, error);
}

eskel_store_status esk_attributes_write(
	sqlite3 *db, int64_t shape, const eskel_description *description, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "DELETE FROM attribute WHERE shape = ?");
	esk_bind_int64(&s, shape);
	eskel_store_status status = esk_statement_run(&s, error);
	for (size_t i = 0; i < description->attribute_count && status == ESKEL_STORE_OK; i++)
		status = write_attribute(db, shape, &description->attributes[i], error);
	return status;
}

void esk_attribute_read(esk_statement *s, eskel_description *description)
{
	eskel_description *d = description;
	if (!esk_array_grow((void **)&d->attributes, d->attribute_count, sizeof d->attributes[0])) {
		esk_statement_fail(s, SQLITE_NOMEM);
		return;
	}
	eskel_attribute *a = &d->attributes[d->attribute_count++];
	a->key = esk_column_text(s);
	a->value = esk_column_text(s);
}

eskel_store_status esk_attributes_read(
	sqlite3 *db, int64_t shape, eskel_description *description, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT key, value FROM attribute WHERE shape = ? ORDER BY key");
	esk_bind_int64(&s, shape);
	while (esk_statement_row(&s))
		esk_attribute_read(&s, description);
	return esk_statement_end(&s, error);
}

void eskel_description_clear(eskel_description *description)
{
	for (size_t i = 0; i < description->attribute_count; i++) {
		free(description->attributes[i].key);
		free(description->attributes[i].value);
	}
	free(description->attributes);
	free(description->name);
	free(description->class);
	free(description->subject);
	*description = (eskel_description){.age = NAN};
}
