#include "report.h"

#include "eskel_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct eskel_report {
	eskel_report_kind kind;
	json_t *answers;
};

typedef struct {
	const char *member; /* every answer of the kind has it ... */
	json_type type;     /* ... of this type */
	bool (*write)(const json_t *answers, FILE *out, bool colour);
} layout;

static const layout layouts[] = {
	[ESKEL_REPORT_SHAPES] = {"shapes", JSON_ARRAY, esk_report_shapes},
	[ESKEL_REPORT_SHAPE] = {"id", JSON_STRING, esk_report_shape},
	[ESKEL_REPORT_SKELETON] = {"levels", JSON_ARRAY, esk_report_skeleton},
	[ESKEL_REPORT_RECOGNITION] = {"results", JSON_ARRAY, esk_report_recognition},
	[ESKEL_REPORT_EVALUATION] = {"measures", JSON_OBJECT, esk_report_evaluation},
	[ESKEL_REPORT_CHECK] = {"labels", JSON_ARRAY, esk_report_check},
	[ESKEL_REPORT_RECONSTRUCTION] = {"primitives", JSON_ARRAY, esk_report_reconstruction},
	[ESKEL_REPORT_JOBS] = {"jobs", JSON_ARRAY, esk_report_jobs},
	[ESKEL_REPORT_JOB] = {"state", JSON_STRING, esk_report_jobs},
	[ESKEL_REPORT_DISTANCES] = {"distances", JSON_ARRAY, esk_report_distances},
};

const char *esk_report_member(const json_t *object, const char *member)
{
	const char *text = json_string_value(json_object_get(object, member));
	return text && *text ? text : "-";
}

bool esk_report_each(
	bool (*write)(const json_t *answer, FILE *out, bool colour), const json_t *answers, FILE *out, bool colour)
{
	size_t i;
	json_t *entry;
	bool whole = true;
	json_array_foreach (answers, i, entry)
		whole = write(json_object_get(entry, "answer"), out, colour) && whole;
	return whole;
}

void esk_report_number(esk_table *table, const json_t *object, const char *member, int decimals)
{
	const json_t *value = json_object_get(object, member);
	if (json_is_number(value))
		esk_table_format(table, "%.*f", decimals, json_number_value(value));
	else
		esk_table_cell(table, "-");
}

void esk_report_score(esk_table *table, const json_t *verdict, const char *member)
{
	const json_t *score = json_object_get(verdict, member);
	if (json_is_number(score))
		esk_table_format(table, "%.0f %%", fmin(100 * json_number_value(score), 99));
	else
		esk_table_cell(table, "-");
}

void esk_report_class(esk_table *table, const json_t *verdict)
{
	const char *class = json_string_value(json_object_get(verdict, "class"));
	const bool unknown = json_is_string(json_object_get(verdict, "nearest_class"));
	esk_table_cell(table, class ? class : unknown ? "unknown" : "-");
	if (class)
		esk_report_score(table, verdict, "class_score");
	else
		esk_table_cell(table, "-");
}

void esk_report_name(esk_table *table, const json_t *shape, const char *source)
{
	const char *name = json_string_value(json_object_get(shape, "name"));
	const json_t *label = json_object_get(shape, "label");
	if (name && *name)
		esk_table_cell(table, name);
	else if (json_is_integer(label))
		esk_table_format(table, "%s:%lld", source, (long long)json_integer_value(label));
	else
		esk_table_cell(table, source);
}

eskel_status eskel_report_new(eskel_report_kind kind, eskel_report **report)
{
	eskel_report *made = calloc(1, sizeof *made);
	json_t *answers = json_array();
	if (!made || !answers) {
		free(made);
		json_decref(answers);
		return ESKEL_NO_MEMORY;
	}
	*made = (eskel_report){kind, answers};
	*report = made;
	return ESKEL_OK;
}

void eskel_report_free(eskel_report *report)
{
	if (!report)
		return;
	json_decref(report->answers);
	free(report);
}

eskel_status eskel_report_add(eskel_report *report, const char *source, const char *json, size_t size)
{
	const layout *expected = &layouts[report->kind];
	json_t *answer = json_loadb(json, size, 0, NULL);
	const json_t *member = json_object_get(answer, expected->member);
	if (!member || json_typeof(member) != expected->type) {
		json_decref(answer);
		return ESKEL_MALFORMED;
	}
	json_t *entry = json_object();
	/* Unchecked: a file's name need not be UTF-8. */
	bool whole = !json_object_set_new(entry, "source", json_string_nocheck(source)) &&
		     !json_object_set(entry, "answer", answer) && !json_array_append(report->answers, entry);
	json_decref(entry);
	json_decref(answer);
	return whole ? ESKEL_OK : ESKEL_NO_MEMORY;
}

char *eskel_report_text(const eskel_report *report, bool colour)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return NULL;
	bool whole = json_array_size(report->answers) == 0 || layouts[report->kind].write(report->answers, out, colour);
	if (fclose(out) || !whole) {
		free(text);
		return NULL;
	}
	return text;
}

/* Of evaluations only. */
static char *text_of(const eskel_report *report, bool (*write)(const json_t *answers, FILE *out))
{
	char *text = NULL;
	size_t size;
	FILE *out = report->kind == ESKEL_REPORT_EVALUATION ? open_memstream(&text, &size) : NULL;
	if (!out)
		return NULL;
	bool whole = json_array_size(report->answers) == 0 || write(report->answers, out);
	if (fclose(out) || !whole) {
		free(text);
		return NULL;
	}
	return text;
}

char *eskel_report_csv(const eskel_report *report)
{
	return text_of(report, esk_report_evaluation_csv);
}

char *eskel_report_html(const eskel_report *report)
{
	return text_of(report, esk_report_evaluation_html);
}

size_t eskel_report_unrecognized(const eskel_report *report)
{
	size_t count = 0, i, j;
	json_t *entry, *result;
	json_array_foreach (report->answers, i, entry) {
		json_t *results = json_object_get(json_object_get(entry, "answer"), "results");
		json_array_foreach (results, j, result)
			count += json_array_size(json_object_get(result, "neighbours")) == 0;
	}
	return count;
}

size_t eskel_report_findings(const eskel_report *report)
{
	json_int_t count = 0;
	size_t i;
	json_t *entry;
	json_array_foreach (report->answers, i, entry) {
		const json_t *findings = json_object_get(json_object_get(entry, "answer"), "findings");
		count += json_integer_value(json_object_get(findings, "error")) +
			 json_integer_value(json_object_get(findings, "warning"));
	}
	return (size_t)count;
}

char *eskel_report_url(const char *json, size_t size)
{
	json_t *answer = json_loadb(json, size, 0, NULL);
	const char *url = json_string_value(json_object_get(answer, "url"));
	char *text = url && url[0] == '/' ? esk_table_plain(url) : NULL;
	json_decref(answer);
	return text;
}

char *eskel_report_problem(const char *json, size_t size)
{
	json_t *problem = json_loadb(json, size, 0, NULL);
	const char *detail = json_string_value(json_object_get(problem, "detail"));
	if (!detail)
		detail = json_string_value(json_object_get(problem, "title"));
	char *text = detail ? esk_table_plain(detail) : NULL;
	json_decref(problem);
	return text;
}
