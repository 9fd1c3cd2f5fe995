/* The merge patch of a description (RFC 7396), see description.h: a table of members and how each takes a value. */
#include "description.h"

#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *type_of(const json_t *value)
{
	static const char *const types[] = {
		"an object", "an array", "a string", "a number", "a number", "true", "false", "null"};
	return types[json_typeof(value)];
}

static bool refuse_type(const char *name, const json_t *value, const char *expected, esk_problem *problem)
{
	return esk_problem_set(problem, 422, "%.80s is %s, expected %s or null", name, type_of(value), expected);
}

static bool replace(char **text, const char *with, esk_problem *problem)
{
	char *copy = with ? strdup(with) : NULL;
	if (with && !copy)
		return esk_problem_no_memory(problem);
	free(*text);
	*text = copy;
	return true;
}

static bool patch_text(const char *name, const json_t *value, char **text, esk_problem *problem)
{
	const char *string = json_string_value(value);
	if (!string && !json_is_null(value))
		return refuse_type(name, value, "a string", problem);
	if (string && !esk_value_text(name, string, ESK_TEXT_MOST, problem))
		return false;
	return replace(text, string, problem);
}

static bool patch_name(eskel_description *description, const json_t *value, esk_problem *problem)
{
	return patch_text("name", value, &description->name, problem);
}

static bool patch_subject(eskel_description *description, const json_t *value, esk_problem *problem)
{
	return patch_text("subject", value, &description->subject, problem);
}

static bool patch_class(eskel_description *description, const json_t *value, esk_problem *problem)
{
	char class[ESK_TEXT_MOST + 1];
	const char *string = json_string_value(value);
	if (!string && !json_is_null(value))
		return refuse_type("class", value, "a string", problem);
	if (string && !esk_value_class("class", string, class, problem))
		return false;
	return replace(&description->class, string ? class : NULL, problem);
}

static bool patch_side(eskel_description *description, const json_t *value, esk_problem *problem)
{
	description->side = ESKEL_SIDE_UNKNOWN;
	if (json_is_null(value))
		return true;
	if (!json_is_string(value))
		return refuse_type("side", value, "\"left\", \"right\", \"none\"", problem);
	return esk_value_side("side", json_string_value(value), &description->side, problem);
}

static bool patch_sex(eskel_description *description, const json_t *value, esk_problem *problem)
{
	description->sex = ESKEL_SEX_UNKNOWN;
	if (json_is_null(value))
		return true;
	if (!json_is_string(value))
		return refuse_type("sex", value, "\"female\", \"male\"", problem);
	return esk_value_sex("sex", json_string_value(value), &description->sex, problem);
}

static bool patch_age(eskel_description *description, const json_t *value, esk_problem *problem)
{
	double years = json_is_null(value) ? NAN : json_number_value(value);
	if (!json_is_number(value) && !json_is_null(value))
		return refuse_type("age", value, "a number", problem);
	if (years < 0 || years > ESK_YEARS_MOST)
		return esk_problem_set(problem, 422, "age is %g, expected years from 0 to %d", years, ESK_YEARS_MOST);
	description->age = years;
	return true;
}

/* The place of a key in the ascending attributes, or where it would be. */
static size_t place_of(const eskel_description *description, const char *key)
{
	size_t place = 0;
	while (place < description->attribute_count && strcmp(description->attributes[place].key, key) < 0)
		place++;
	return place;
}

static void remove_attribute(eskel_description *description, size_t place)
{
	eskel_attribute *attributes = description->attributes;
	free(attributes[place].key);
	free(attributes[place].value);
	description->attribute_count--;
	memmove(attributes + place, attributes + place + 1,
		(description->attribute_count - place) * sizeof *attributes);
}

static bool insert_attribute(
	eskel_description *description, size_t place, const char *key, const char *value, esk_problem *problem)
{
	if (description->attribute_count >= ESK_ATTRIBUTES_MOST)
		return esk_problem_set(problem, 422, "attribute \"%s\" is one too many, expected at most %d", key,
			ESK_ATTRIBUTES_MOST);
	eskel_attribute *grown = realloc(description->attributes, (description->attribute_count + 1) * sizeof *grown);
	if (!grown)
		return esk_problem_no_memory(problem);
	description->attributes = grown;
	memmove(grown + place + 1, grown + place, (description->attribute_count - place) * sizeof *grown);
	grown[place] = (eskel_attribute){strdup(key), strdup(value)};
	description->attribute_count++;
	return (grown[place].key && grown[place].value) || esk_problem_no_memory(problem);
}

static bool patch_attribute(eskel_description *description, const char *key, const json_t *value, esk_problem *problem)
{
	size_t place = place_of(description, key);
	bool there = place < description->attribute_count && strcmp(description->attributes[place].key, key) == 0;
	if (!esk_value_text("an attribute's key", key, ESK_ATTRIBUTE_KEY_MOST, problem))
		return false;
	if (there && json_is_null(value))
		remove_attribute(description, place);
	if (json_is_null(value))
		return true;
	if (there)
		return patch_text(key, value, &description->attributes[place].value, problem);
	if (!json_is_string(value))
		return refuse_type(key, value, "a string", problem);
	return esk_value_text(key, json_string_value(value), ESK_TEXT_MOST, problem) &&
	       insert_attribute(description, place, key, json_string_value(value), problem);
}

static bool patch_attributes(eskel_description *description, const json_t *value, esk_problem *problem)
{
	const char *key;
	json_t *member;
	if (json_is_null(value))
		while (description->attribute_count > 0)
			remove_attribute(description, description->attribute_count - 1);
	else if (!json_is_object(value))
		return refuse_type("attributes", value, "an object of strings", problem);
	json_object_foreach ((json_t *)value, key, member) {
		if (!patch_attribute(description, key, member, problem))
			return false;
	}
	return true;
}

static const struct {
	const char *name;
	bool (*patch)(eskel_description *description, const json_t *value, esk_problem *problem);
} members[] = {
	{"name", patch_name},
	{"class", patch_class},
	{"side", patch_side},
	{"subject", patch_subject},
	{"age", patch_age},
	{"sex", patch_sex},
	{"attributes", patch_attributes},
};

static bool patch_member(eskel_description *description, const char *name, const json_t *value, esk_problem *problem)
{
	for (size_t i = 0; i < sizeof members / sizeof *members; i++)
		if (strcmp(members[i].name, name) == 0)
			return members[i].patch(description, value, problem);
	return esk_problem_set(problem, 422,
		"\"%.80s\" cannot be changed, expected name, class, side, subject, age, sex or attributes", name);
}

static bool patch_members(eskel_description *description, json_t *patch, esk_problem *problem)
{
	const char *name;
	json_t *value;
	if (!json_is_object(patch))
		return esk_problem_set(
			problem, 400, "the body is %s, expected an object of the members to change", type_of(patch));
	json_object_foreach (patch, name, value) {
		if (patch_member(description, name, value, problem))
			continue;
		if (problem->status == 400) /* as value.h refuses what stands in a query */
			problem->status = 422;
		return false;
	}
	return true;
}

bool esk_description_patch(eskel_description *description, const char *json, size_t size, esk_problem *problem)
{
	json_error_t error;
	json_t *patch = json_loadb(json ? json : "", size, JSON_REJECT_DUPLICATES, &error);
	if (!patch && !error.text[0]) /* jansson has no word for it */
		return esk_problem_no_memory(problem);
	if (!patch)
		return esk_problem_set(problem, 400, "the body is not JSON at line %d, column %d: %s", error.line,
			error.column, error.text);
	bool good = patch_members(description, patch, problem);
	json_decref(patch);
	return good;
}
