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

static void write_warnings(const json_t *shape, const char *source, FILE *out)
{
	size_t i;
	json_t *warning;
	json_array_foreach(json_object_get(shape, "warnings"), i, warning)
	{
		const char *name = json_string_value(json_object_get(shape, "name"));
		fputs("warning: ", out);
		esk_table_write_plain(out, name && *name ? name : source);
		fputs(": ", out);
		esk_table_write_plain(out, esk_report_member(warning, "text"));
		fputc('\n', out);
	}
}

bool esk_report_shapes(const json_t *answers, FILE *out, bool colour)
{
	size_t i, j;
	json_t *entry, *shape;
	const char *next = NULL;
	esk_table *table = esk_table_new(columns, sizeof columns / sizeof *columns);
	json_array_foreach(answers, i, entry)
	{
		json_t *answer = json_object_get(entry, "answer");
		json_array_foreach(json_object_get(answer, "shapes"), j, shape)
			add_row(table, shape, esk_report_member(entry, "source"));
		next = json_string_value(json_object_get(answer, "next"));
	}
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	json_array_foreach(answers, i, entry)
	{
		json_array_foreach(json_object_get(json_object_get(entry, "answer"), "shapes"), j, shape)
			write_warnings(shape, esk_report_member(entry, "source"), out);
	}
	if (next) {
		fputs("more follow: add --cursor ", out);
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
	json_t *entry, *value;
	const char *member;
	bool whole = true;
	json_array_foreach(answers, i, entry)
	{
		json_t *shape = json_object_get(entry, "answer");
		esk_table *table = esk_table_new(members, 2);
		json_object_foreach(shape, member, value)
		{
			if (strcmp(member, "warnings"))
				add_member(table, member, value);
		}
		whole = esk_table_write(table, out, colour) && whole;
		esk_table_free(table);
		write_warnings(shape, esk_report_member(entry, "source"), out);
	}
	return whole;
}
