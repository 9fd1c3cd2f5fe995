/* A check as JSON, see check.h. */
#include "check.h"

#include "shape_json.h"
#include "value.h"

#include <math.h>

static json_t *finding_json(const esk_finding *finding)
{
	return json_pack("{s:s, s:s, s:s, s:o}", "code", esk_finding_name(finding->code), "severity",
		esk_severity_name(finding->severity), "text", finding->text, "partner",
		finding->partner ? json_integer(finding->partner) : json_null());
}

static json_t *findings_json(const esk_findings *findings)
{
	json_t *array = json_array();
	for (size_t i = 0; i < findings->count; i++)
		if (json_array_append_new(array, finding_json(&findings->items[i])) != 0) {
			json_decref(array);
			return NULL;
		}
	return array;
}

static json_t *nearest_json(const esk_recognition *recognition)
{
	if (recognition->count == 0)
		return json_null();
	const eskel_shape *shape = &recognition->neighbours[0].known->shape;
	return json_pack("{s:s, s:s?, s:o}", "id", shape->id, "name", shape->description.name, "distance",
		esk_json_real(recognition->neighbours[0].found->distance));
}

static json_t *verdict_json(const esk_check_row *row)
{
	const esk_verdict *verdict = &row->recognition.verdict;
	return json_pack("{s:s?, s:o, s:s?, s:s?, s:o, s:o}", "class", verdict->class, "class_score",
		esk_json_real(verdict->class_score), "nearest_class", verdict->nearest_class, "side",
		esk_value_side_text(verdict->side), "side_score", esk_json_real(verdict->side_score), "nearest",
		nearest_json(&row->recognition));
}

/* 0 deviations, not -0.000003, with as many digits as mean something. */
static json_t *z_json(double z)
{
	return esk_json_real(round(100 * z) / 100 + 0.0);
}

static json_t *label_json(const esk_check_row *row, const esk_checked_label *label, const esk_findings *findings)
{
	const eskel_description *said = &row->specimen->shape.description;
	json_t *made = json_pack("{s:i, s:s?, s:s?, s:s?, s:I, s:o}", "label", (int)label->label, "name", said->name,
		"class", said->class, "side", esk_value_side_text(said->side), "voxels", (json_int_t)label->voxels,
		"volume_mm3", esk_json_real(label->volume));
	json_t *measured = json_pack("{s:o, s:o, s:o, s:o, s:{s:I, s:I}, s:{s:I, s:I}, s:o}", "verdict",
		verdict_json(row), "distance", esk_json_real(label->said_distance), "distance_z", z_json(label->z),
		"volume_z", z_json(esk_finding_volume_z(label)), "components", "count",
		(json_int_t)label->component_count, "largest_voxels", (json_int_t)label->largest, "cavities", "count",
		(json_int_t)label->cavity_count, "voxels", (json_int_t)label->cavity_voxels, "findings",
		findings_json(findings));
	if (json_object_update(made, measured) != 0) {
		json_decref(made);
		made = NULL;
	}
	json_decref(measured);
	return made;
}

static json_t *labels_json(const esk_check *check)
{
	json_t *array = json_array();
	for (size_t i = 0; i < check->count; i++)
		if (json_array_append_new(array, label_json(&check->rows[i], &check->labels[i], &check->findings[i])) !=
			0) {
			json_decref(array);
			return NULL;
		}
	return array;
}

json_t *esk_check_json(const esk_check *check, const esk_specimens *specimens)
{
	json_int_t severities[ESK_SEVERITY_COUNT] = {0};
	for (size_t i = 0; i < check->count; i++)
		for (size_t j = 0; j < check->findings[i].count; j++)
			severities[check->findings[i].items[j].severity]++;
	return json_pack("{s:o, s:{s:I, s:I, s:I}, s:o}", "labels", labels_json(check), "findings", "error",
		severities[ESK_SEVERITY_ERROR], "warning", severities[ESK_SEVERITY_WARNING], "note",
		severities[ESK_SEVERITY_NOTE], "warnings",
		esk_warnings_json(specimens->warnings, specimens->warning_count));
}
