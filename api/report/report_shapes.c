/* Enrolled shapes: a row each, or one shape in full. */
#include "report.h"

#include <stdlib.h>
#include <string.h>

static const esk_column columns[] = {{"id", false}, {"name", false}, {"class", false}, {"side", false},
	{"subject", false}, {"label", true}, {"voxels", true}, {"volume mm³", true}, {"levels", true}};

static void add_row(esk_table *table, const json_t *shape, const char *source)
{
	esk_table_cell(table, esk_report_member(shape, "id"));
	esk_report_name(table, shape, source);
	esk_table_cell(table, esk_report_member(shape, "class"));
	esk_table_cell(table, esk_report_member(shape, "side"));
	esk_table_cell(table, esk_report_member(shape, "subject"));
	esk_report_number(table, shape, "label", 0);
	esk_report_number(table, shape, "voxels", 0);
	esk_report_number(table, shape, "volume_mm3", 1);
	esk_report_number(table, shape, "levels", 0);
}

/* Counts a shape's warnings in seen: the text, then how often it was seen and the first that it was said of. */
static bool collect_warnings(const json_t *shape, const char *source, json_t *seen)
{
	size_t i;
	json_t *warning;
	bool whole = true;
	const char *name = json_string_value(json_object_get(shape, "name"));
	json_array_foreach (json_object_get(shape, "warnings"), i, warning) {
		const char *text = esk_report_member(warning, "text");
		json_t *count = json_array_get(json_object_get(seen, text), 0);
		if (count)
			whole = !json_integer_set(count, json_integer_value(count) + 1) && whole;
		else
			whole = !json_object_set_new(seen, text,
					json_pack("[i, o]", 1, json_string_nocheck(name && *name ? name : source))) &&
				whole;
	}
	return whole;
}

/* A volume's warning is one of each of its labels: it is said once. */
static void write_warnings(json_t *seen, FILE *out)
{
	const char *text;
	json_t *entry;
	fputs(json_object_size(seen) > 0 ? "\n" : "", out);
	json_object_foreach (seen, text, entry) {
		json_int_t count = json_integer_value(json_array_get(entry, 0));
		fputs("warning: ", out);
		if (count == 1) {
			esk_table_write_plain(out, json_string_value(json_array_get(entry, 1)));
			fputs(": ", out);
		} else {
			fprintf(out, "%lld shapes: ", (long long)count);
		}
		esk_table_write_plain(out, text);
		fputc('\n', out);
	}
}

bool esk_report_shapes(const json_t *answers, FILE *out, bool colour)
{
	size_t i, j;
	json_t *entry, *shape, *warnings = json_object();
	const char *next = NULL;
	bool whole = warnings;
	esk_table *table = esk_table_new(columns, sizeof columns / sizeof *columns);
	json_array_foreach (answers, i, entry) {
		const char *source = esk_report_member(entry, "source");
		json_t *answer = json_object_get(entry, "answer");
		json_array_foreach (json_object_get(answer, "shapes"), j, shape) {
			add_row(table, shape, source);
			whole = whole && collect_warnings(shape, source, warnings);
		}
		next = json_string_value(json_object_get(answer, "next"));
	}
	whole = esk_table_write(table, out, colour) && whole;
	esk_table_free(table);
	write_warnings(warnings, out);
	json_decref(warnings);
	if (next) {
		fputs("\nmore follow: add --cursor ", out);
		esk_table_write_plain(out, next);
		fputc('\n', out);
	}
	return whole;
}

/* A string as it is, anything else as compact JSON. */
static void add_member(esk_table *table, const char *member, const json_t *value)
{
	char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(6));
	esk_table_cell(table, member);
	if (json_is_null(value))
		esk_table_cell(table, "-");
	else
		esk_table_cell(table, json_is_string(value) ? json_string_value(value) : text ? text : "?");
	free(text);
}

bool esk_report_shape(const json_t *answers, FILE *out, bool colour)
{
	static const esk_column members[] = {{"member", false}, {"value", false}};
	size_t i;
	json_t *entry, *value, *warnings = json_object();
	const char *member;
	bool whole = warnings;
	json_array_foreach (answers, i, entry) {
		json_t *shape = json_object_get(entry, "answer");
		esk_table *table = esk_table_new(members, 2);
		json_object_foreach (shape, member, value) {
			if (strcmp(member, "warnings"))
				add_member(table, member, value);
		}
		whole = esk_table_write(table, out, colour) && whole;
		esk_table_free(table);
		whole = whole && collect_warnings(shape, esk_report_member(entry, "source"), warnings);
	}
	write_warnings(warnings, out);
	json_decref(warnings);
	return whole;
}
