/* The query of a URL, see parameters.h. A parameter is a row of the table below and a function that takes its value. */
#include "parameters.h"

#include "label_name.h"
#include "text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 1024 labels with three words each, and the rest; each is compared with all before it. */
#define MOST_PARAMETERS 5000

/* One parameter as sent. name may say more than the row's own: "attr.scanner" of "attr.KEY". */
typedef struct {
	const struct parameter *row;
	const char *name, *value;
} argument;

/* target: the member of esk_parameters that the row names, the query itself if it names none. */
typedef bool take_argument(void *target, const argument *given, esk_problem *problem);

struct parameter {
	const char *name;
	take_argument *take;
	size_t field;               /* offset in esk_parameters */
	int64_t most;               /* of a number */
	const char *const *choices; /* of a choice, in the order of its enum */
	bool repeatable;
};

static bool take_text(void *target, const argument *given, esk_problem *problem)
{
	if (!esk_value_text(given->name, given->value, ESK_TEXT_MOST, problem))
		return false;
	*(const char **)target = given->value;
	return true;
}

static bool take_class(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_class(given->name, given->value, target, problem);
}

static bool take_side(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_side(given->name, given->value, target, problem);
}

static bool take_sex(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_sex(given->name, given->value, target, problem);
}

static bool take_years(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_years(given->name, given->value, target, problem);
}

static bool take_share(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_share(given->name, given->value, target, problem);
}

static bool take_spacing(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_spacing(given->name, given->value, target, problem);
}

static bool take_eye_distance(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_eye_distance(given->name, given->value, target, problem);
}

static bool take_number(void *target, const argument *given, esk_problem *problem)
{
	int64_t number;
	if (!esk_value_integer(given->name, given->value, 1, given->row->most, &number, problem))
		return false;
	*(unsigned *)target = (unsigned)number;
	return true;
}

static bool take_seed(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_integer(given->name, given->value, 0, given->row->most, target, problem);
}

static bool take_choice(void *target, const argument *given, esk_problem *problem)
{
	return esk_value_choice(given->name, given->value, given->row->choices, target, problem);
}

static bool take_attribute(void *target, const argument *given, esk_problem *problem)
{
	esk_parameters *query = target;
	const char *key = strstr(given->name, "attr.") + strlen("attr.");
	if (!esk_value_text("an attribute's key", key, ESK_ATTRIBUTE_KEY_MOST, problem) ||
		!esk_value_text(given->name, given->value, ESK_TEXT_MOST, problem))
		return false;
	if (query->attribute_count == ESK_ATTRIBUTES_MOST)
		return esk_problem_set(problem, 400, "%s is one attribute too many, expected at most %d", given->name,
			ESK_ATTRIBUTES_MOST);
	eskel_attribute *grown = realloc(query->attributes, (query->attribute_count + 1) * sizeof *grown);
	if (!grown)
		return esk_problem_no_memory(problem);
	query->attributes = grown;
	eskel_attribute attribute = {strdup(key), strdup(given->value)};
	query->attributes[query->attribute_count++] = attribute;
	return attribute.key && attribute.value ? true : esk_problem_no_memory(problem);
}

static bool take_label(void *target, const argument *given, esk_problem *problem)
{
	esk_parameters *query = target;
	bool all = strcmp(given->value, "all") == 0;
	if (query->all_labels || (all && query->label_count > 0))
		return esk_problem_set(problem, 400, "label=all means every label, expected no other label beside it");
	if (all)
		return query->all_labels = true;
	int64_t label;
	if (!esk_value_integer("label", given->value, -INT32_MAX, INT32_MAX, &label, problem) || label == 0)
		return esk_problem_set(
			problem, 400, "label is \"%.60s\", expected all or a whole number that is not 0", given->value);
	for (size_t i = 0; i < query->label_count; i++)
		if (query->labels[i] == label)
			return esk_problem_set(problem, 400, "label %" PRId64 " is given twice, expected once", label);
	int32_t *grown = realloc(query->labels, (query->label_count + 1) * sizeof *grown);
	if (!grown)
		return esk_problem_no_memory(problem);
	query->labels = grown;
	query->labels[query->label_count++] = (int32_t)label;
	return true;
}

static esk_label_words *words_of(esk_parameters *query, int32_t label)
{
	for (size_t i = 0; i < query->words_count; i++)
		if (query->words[i].label == label)
			return &query->words[i];
	esk_label_words *grown = realloc(query->words, (query->words_count + 1) * sizeof *grown);
	if (!grown)
		return NULL;
	query->words = grown;
	query->words[query->words_count] = (esk_label_words){.label = label};
	return &query->words[query->words_count++];
}

/* The name is "label.N.name", "label.N.class" or "label.N.side". */
static bool take_label_words(void *target, const argument *given, esk_problem *problem)
{
	const char *number = given->name + strlen("label."), *member = strchr(number, '.') + 1;
	char digits[16];
	int64_t label;
	snprintf(digits, sizeof digits, "%.*s", (int)(member - 1 - number), number);
	if (!esk_value_integer("the N of a label.N parameter", digits, -INT32_MAX, INT32_MAX, &label, problem))
		return false;
	esk_label_words *words = words_of(target, (int32_t)label);
	if (!words)
		return esk_problem_no_memory(problem);
	if (strcmp(member, "class") == 0)
		return esk_value_class(given->name, given->value, words->class, problem);
	if (strcmp(member, "side") == 0)
		return esk_value_side(given->name, given->value, &words->side, problem);
	words->name = given->value;
	return esk_value_text(given->name, given->value, ESK_TEXT_MOST, problem);
}

static bool take_shape(void *target, const argument *given, esk_problem *problem)
{
	if (!esk_value_is_id(given->value))
		return esk_problem_set(problem, 400, "shape is \"%.60s\", expected " ESK_ID_EXPECTED, given->value);
	*(const char **)target = given->value;
	return true;
}

static bool take_ids(void *target, const argument *given, esk_problem *problem)
{
	esk_parameters *query = target;
	query->ids = calloc(strlen(given->value) / ESKEL_ID_SIZE + 1, sizeof *query->ids);
	if (!query->ids)
		return esk_problem_no_memory(problem);
	for (const char *rest = given->value;; rest++) {
		size_t size = strcspn(rest, ",");
		char *id = query->ids[query->id_count];
		if (size == ESKEL_ID_SIZE - 1)
			memcpy(id, rest, size);
		if (!esk_value_is_id(id))
			return esk_problem_set(problem, 400,
				"%s has \"%.*s\", expected " ESK_ID_EXPECTED ", several with commas between",
				given->name, (int)(size < 60 ? size : 60), rest);
		query->id_count++;
		rest += size;
		if (!*rest)
			return true;
	}
}

static void set_unsaid(esk_parameters *query)
{
	query->age = query->age_min = query->age_max = query->eye_distance = NAN;
	query->format = ESK_FORMAT_UNSAID;
	query->plot = ESK_PLOT_UNSAID;
	query->compose = ESK_COMPOSE_UNSAID;
	query->primitive = ESK_PRIMITIVE_UNSAID;
	query->method = ESK_METHOD_UNSAID;
	query->seed = -1;
}

/* NULL when memory ran out. */
static esk_parameters *columns_of(esk_parameters *query)
{
	if (!query->columns && (query->columns = calloc(1, sizeof *query->columns)))
		set_unsaid(query->columns);
	return query->columns;
}

static bool take_columns(void *target, const argument *given, esk_problem *problem)
{
	esk_parameters *columns = columns_of(target);
	unsigned index;
	if (!columns)
		return esk_problem_no_memory(problem);
	columns->all = true;
	return esk_value_choice(given->name, given->value, given->row->choices, &index, problem);
}

static bool take_cursor(void *target, const argument *given, esk_problem *problem)
{
	uint64_t key = UINT64_MAX;
	const char *digits = given->value + 1;
	if (given->value[0] == 'k' && strspn(digits, "0123456789abcdef") == 16 && digits[16] == 0)
		key = strtoull(digits, NULL, 16);
	if (key > INT64_MAX)
		return esk_problem_set(
			problem, 400, "cursor is \"%.60s\", expected the next of an earlier answer", given->value);
	*(int64_t *)target = (int64_t)key;
	return true;
}

static const char *const modes[] = {"exact", "pruned", NULL};
static const char *const signatures[] = {"log", "paper", NULL};
static const char *const distances[] = {"sum", "level", NULL};
static const char *const metrics[] = {"manhattan", "euclidean", "root", NULL};
static const char *const scales[] = {"none", "neighbourhood", NULL};
static const char *const orders[] = {"distance", "position", NULL};
static const char *const sizes[] = {"fixed", "free", NULL};
static const char *const left_out[] = {"shape", "subject", NULL};
static const char *const formats[] = {"json", "csv", "npy", "svg", NULL};
static const char *const volume_formats[] = {"nifti", "nrrd", NULL};
static const char *const signature_formats[] = {"json", "csv", NULL};
static const char *const mesh_formats[] = {"glb", "stl", "ply", "obj", NULL};
static const char *const frames[] = {"ras", "lps", NULL};
static const char *const sources[] = {"skeleton", "voxels", NULL};
static const char *const compositions[] = {"blend", "union", NULL};
static const char *const primitives[] = {"ellipsoid", "superquadric", "deformed", "algebraic", NULL};
static const char *const methods[] = {"joint", "tabu", "hopping", "least_squares", NULL};
static const char *const plots[] = {"heatmap", "map", NULL};
static const char *const everything[] = {"all", NULL};
static const char *const answers[] = {"false", "true", NULL};

#define FIELD(member) .field = offsetof(esk_parameters, member)

/* Where no member is named the whole query is the target. */
static const struct parameter parameters[] = {
	{.name = "age", .take = take_years, FIELD(age)},
	{.name = "age_max", .take = take_years, FIELD(age_max)},
	{.name = "age_min", .take = take_years, FIELD(age_min)},
	{.name = "as_said", .take = take_choice, FIELD(as_said), .choices = answers},
	{.name = "attr.KEY", .take = take_attribute},
	{.name = "class", .take = take_class, FIELD(class)},
	{.name = "columns", .take = take_columns, .choices = everything},
	{.name = "compose", .take = take_choice, FIELD(compose), .choices = compositions},
	{.name = "cursor", .take = take_cursor, FIELD(cursor)},
	{.name = "distance", .take = take_choice, FIELD(distance), .choices = distances},
	{.name = "distance/mesh", .take = take_eye_distance, FIELD(eye_distance)},
	{.name = "explain", .take = take_choice, FIELD(explain), .choices = answers},
	{.name = "format", .take = take_choice, FIELD(format), .choices = formats},
	{.name = "format/signature", .take = take_choice, FIELD(format), .choices = signature_formats},
	{.name = "format/volume", .take = take_choice, FIELD(volume_format), .choices = volume_formats},
	{.name = "format/mesh", .take = take_choice, FIELD(mesh_format), .choices = mesh_formats},
	{.name = "frame", .take = take_choice, FIELD(frame), .choices = frames},
	{.name = "id", .take = take_ids},
	{.name = "keep", .take = take_share, FIELD(keep)},
	{.name = "label", .take = take_label, .repeatable = true},
	{.name = "label.N.class", .take = take_label_words},
	{.name = "label.N.name", .take = take_label_words},
	{.name = "label.N.side", .take = take_label_words},
	{.name = "leave_out", .take = take_choice, FIELD(leave_out), .choices = left_out},
	{.name = "level", .take = take_number, FIELD(level), .most = ESKEL_LEVELS_MAX},
	{.name = "levels", .take = take_number, FIELD(levels), .most = ESKEL_LEVELS_MAX},
	{.name = "limit", .take = take_number, FIELD(limit), .most = INT32_MAX},
	{.name = "method", .take = take_choice, FIELD(method), .choices = methods},
	{.name = "metric", .take = take_choice, FIELD(metric), .choices = metrics},
	{.name = "minimum", .take = take_number, FIELD(minimum), .most = INT32_MAX},
	{.name = "mode", .take = take_choice, FIELD(mode), .choices = modes},
	{.name = "name", .take = take_text, FIELD(name)},
	{.name = "not.subject", .take = take_text, FIELD(not_subject)},
	{.name = "order", .take = take_choice, FIELD(order), .choices = orders},
	{.name = "plot", .take = take_choice, FIELD(plot), .choices = plots},
	{.name = "primitive", .take = take_choice, FIELD(primitive), .choices = primitives},
	{.name = "q", .take = take_text, FIELD(text)},
	{.name = "scale", .take = take_choice, FIELD(scale), .choices = scales},
	{.name = "seed", .take = take_seed, FIELD(seed), .most = INT32_MAX},
	{.name = "sex", .take = take_sex, FIELD(sex)},
	{.name = "shape", .take = take_shape, FIELD(shape)},
	{.name = "side", .take = take_side, FIELD(side)},
	{.name = "signature", .take = take_choice, FIELD(signature), .choices = signatures},
	{.name = "size", .take = take_choice, FIELD(size), .choices = sizes},
	{.name = "spacing", .take = take_spacing, FIELD(spacing)},
	{.name = "source", .take = take_choice, FIELD(source), .choices = sources},
	{.name = "step", .take = take_spacing, FIELD(step)},
	{.name = "subject", .take = take_text, FIELD(subject)},
	{.name = "weights", .take = take_choice, FIELD(weights), .choices = answers},
};

/* attr.KEY fits any key, label.N.name any number in place of N. */
static bool name_fits(const char *pattern, const char *name)
{
	const char *key = strstr(pattern, "KEY");
	if (key)
		return strncmp(name, pattern, (size_t)(key - pattern)) == 0;
	if (strncmp(pattern, "label.N.", 8) != 0)
		return strlen(name) == strcspn(pattern, "/") && strncmp(pattern, name, strlen(name)) == 0;
	if (strncmp(name, "label.", 6) != 0)
		return false;
	const char *number = name + 6 + (name[6] == '-');
	size_t size = strspn(number, "0123456789");
	return size > 0 && size <= 10 && strcmp(number + size, pattern + 7) == 0;
}

static const struct parameter *find_parameter(const char *pattern)
{
	for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++)
		if (strcmp(parameters[i].name, pattern) == 0)
			return &parameters[i];
	return NULL;
}

static bool refuse_name(const char *const *allowed, const char *name, esk_problem *problem)
{
	char known[600] = "";
	for (size_t used = 0; *allowed; allowed++, used = strlen(known))
		snprintf(known + used, sizeof known - used, "%s%.*s", used ? ", " : "", (int)strcspn(*allowed, "/"),
			*allowed);
	if (!known[0])
		return esk_problem_set(problem, 400, "there is no query parameter \"%.60s\", expected none here", name);
	return esk_problem_set(problem, 400, "there is no query parameter \"%.60s\" here, expected %s", name, known);
}

static bool given_before(const eskel_field *fields, size_t index)
{
	for (size_t i = 0; i < index; i++)
		if (strcmp(fields[i].name, fields[index].name) == 0)
			return true;
	return false;
}

static int compare_attributes(const void *a, const void *b)
{
	return strcmp(((const eskel_attribute *)a)->key, ((const eskel_attribute *)b)->key);
}

#define COLUMNS "columns."

static bool take_field(
	esk_parameters *query, const char *const *allowed, const eskel_field *field, bool again, esk_problem *problem)
{
	const char *const *pattern = allowed;
	while (*pattern && !name_fits(*pattern, field->name))
		pattern++;
	if (!*pattern)
		return refuse_name(allowed, field->name, problem);
	const bool of_columns = strncmp(*pattern, COLUMNS, strlen(COLUMNS)) == 0;
	const struct parameter *row = find_parameter(*pattern + (of_columns ? strlen(COLUMNS) : 0));
	esk_parameters *target = of_columns ? columns_of(query) : query;
	if (!target)
		return esk_problem_no_memory(problem);
	if (again && !row->repeatable)
		return esk_problem_set(problem, 400, "%.60s is given twice, expected once", field->name);
	return row->take((char *)target + row->field, &(argument){row, field->name, field->value}, problem);
}

static bool settle(esk_parameters *query, const char *prefix, esk_problem *problem)
{
	if (query->attribute_count > 0)
		qsort(query->attributes, query->attribute_count, sizeof *query->attributes, compare_attributes);
	if (query->age_min > query->age_max)
		return esk_problem_set(problem, 400, "%sage_min is %g, expected at most %sage_max, %g", prefix,
			query->age_min, prefix, query->age_max);
	return true;
}

bool esk_parameters_parse(esk_parameters *query, const char *const *allowed, const eskel_field *fields, size_t count,
	esk_problem *problem)
{
	if (count > MOST_PARAMETERS)
		return esk_problem_set(
			problem, 400, "the query has %zu parameters, expected at most %d", count, MOST_PARAMETERS);
	set_unsaid(query);
	for (size_t i = 0; i < count; i++)
		if (!take_field(query, allowed, &fields[i], given_before(fields, i), problem))
			return false;
	return settle(query, "", problem) && (!query->columns || settle(query->columns, COLUMNS, problem));
}

void esk_parameters_clear(esk_parameters *query)
{
	for (size_t i = 0; i < query->attribute_count; i++) {
		free(query->attributes[i].key);
		free(query->attributes[i].value);
	}
	free(query->attributes);
	free(query->labels);
	free(query->words);
	free(query->ids);
	if (query->columns)
		esk_parameters_clear(query->columns);
	free(query->columns);
	*query = (esk_parameters){0};
}

eskel_filter esk_parameters_filter(const esk_parameters *query)
{
	return (eskel_filter){
		.class = query->class[0] ? query->class : NULL,
		.subject = query->subject,
		.not_subject = query->not_subject,
		.side = query->side,
		.sex = query->sex,
		.age_min = query->age_min,
		.age_max = query->age_max,
		.text = query->text,
		.attribute_count = query->attribute_count,
		.attributes = query->attributes,
	};
}

const esk_label_words *esk_parameters_words(const esk_parameters *query, int32_t label)
{
	for (size_t i = 0; i < query->words_count; i++)
		if (query->words[i].label == label)
			return &query->words[i];
	return NULL;
}

eskel_distance_options esk_parameters_distance(const esk_parameters *query)
{
	return (eskel_distance_options){
		.signature = (eskel_signature_kind)query->signature,
		.distance = (eskel_distance_kind)query->distance,
		.level = query->level,
		.metric = (eskel_metric)query->metric,
		.size = (eskel_size)query->size,
	};
}

const char *esk_parameters_choice(const esk_parameters *query, const char *name)
{
	const struct parameter *row = find_parameter(name);
	return row->choices[*(const unsigned *)((const char *)query + row->field)];
}

void esk_parameters_cursor_text(int64_t key, char text[ESK_CURSOR_SIZE])
{
	snprintf(text, ESK_CURSOR_SIZE, "k%016" PRIx64, (uint64_t)key);
}
