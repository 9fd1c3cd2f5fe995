/* A shape as JSON, see shape_json.h. What is not recorded is null. */
#include "shape_json.h"

#include "value.h"

#include <stdio.h>

static json_t *attributes_json(const eskel_description *description)
{
	json_t *object = json_object();
	for (size_t i = 0; i < description->attribute_count; i++) {
		const eskel_attribute *attribute = &description->attributes[i];
		if (json_object_set_new(object, attribute->key, json_string(attribute->value)) != 0) {
			json_decref(object);
			return NULL;
		}
	}
	return object;
}

json_t *esk_warnings_json(const eskel_warning *warnings, size_t count)
{
	json_t *array = json_array();
	for (size_t i = 0; i < count; i++) {
		const eskel_warning *warning = &warnings[i];
		json_t *object =
			json_pack("{s:s, s:s}", "code", eskel_warning_name(warning->code), "text", warning->text);
		if (json_array_append_new(array, object) != 0) {
			json_decref(array);
			return NULL;
		}
	}
	return array;
}

json_t *esk_shape_json(const eskel_shape *shape)
{
	const eskel_description *said = &shape->description;
	bool stored = shape->created[0];
	char url[sizeof "/shapes/" + ESKEL_ID_SIZE];
	snprintf(url, sizeof url, "/shapes/%s", shape->id);
	return json_pack("{s:s, s:s?, s:s?, s:s?, s:s?, s:s?, s:o, s:s?, s:o,"
			 " s:i, s:I, s:o, s:o, s:i, s:s, s:s?, s:o}",
		"id", shape->id, "url", stored ? url : NULL, "name", said->name, "class", said->class, "side",
		esk_value_side_text(said->side), "subject", said->subject, "age", esk_json_real(said->age), "sex",
		esk_value_sex_text(said->sex), "attributes", attributes_json(said), "label", (int)shape->label,
		"voxels", (json_int_t)shape->voxels, "volume_mm3", esk_json_real(shape->volume), "centre_mm",
		esk_json_reals(shape->centre, 3), "levels", (int)shape->levels, "sha256", shape->sha256, "created",
		stored ? shape->created : NULL, "warnings", esk_warnings_json(shape->warnings, shape->warning_count));
}

json_t *esk_shapes_json(const eskel_shape *shapes, size_t count)
{
	json_t *array = json_array();
	for (size_t i = 0; i < count; i++)
		if (json_array_append_new(array, esk_shape_json(&shapes[i])) != 0) {
			json_decref(array);
			return NULL;
		}
	return array;
}
