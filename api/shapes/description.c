/* What people say of a shape when it is posted, see description.h. */
#include "description.h"

#include "label_name.h"
#include "text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* True when there is nothing to copy or it was copied. */
static bool copy(const char *text, char **copied)
{
	if (!text || !text[0])
		return true;
	*copied = strdup(text);
	return *copied;
}

static bool copy_attributes(const esk_parameters *query, eskel_description *description)
{
	if (query->attribute_count == 0)
		return true;
	description->attributes = calloc(query->attribute_count, sizeof *description->attributes);
	if (!description->attributes)
		return false;
	description->attribute_count = query->attribute_count;
	for (size_t i = 0; i < query->attribute_count; i++)
		if (!copy(query->attributes[i].key, &description->attributes[i].key) ||
			!copy(query->attributes[i].value, &description->attributes[i].value))
			return false;
	return true;
}

/* A copy that may be stored; NULL for no name. */
static const char *plain_name(const char *name, char plain[ESK_TEXT_MOST + 1])
{
	if (!name)
		return NULL;
	snprintf(plain, ESK_TEXT_MOST + 1, "%s", name);
	esk_text_clean(plain);
	return plain;
}

bool esk_description_of_label(
	const esk_parameters *query, int32_t label, const char *name_in_file, eskel_description *description)
{
	char plain[ESK_TEXT_MOST + 1];
	const esk_label_words none = {.label = label}, *found = esk_parameters_words(query, label);
	const esk_label_words *words = found ? found : &none;
	const char *name = words->name      ? words->name
			   : query->name    ? query->name
			   : query->as_said ? NULL
					    : plain_name(name_in_file, plain);
	char class_of_name[ESK_TEXT_MOST + 1] = "";
	eskel_side side_of_name = ESKEL_SIDE_UNKNOWN;
	if (name && !query->as_said)
		esk_label_split(name, class_of_name, &side_of_name);
	const char *class = words->class[0] ? words->class : query->class[0] ? query->class : class_of_name;
	description->side = words->side ? words->side : query->side ? query->side : side_of_name;
	description->sex = query->sex;
	description->age = query->age;
	return copy(name, &description->name) && copy(class, &description->class) &&
	       copy(query->subject, &description->subject) && copy_attributes(query, description);
}
