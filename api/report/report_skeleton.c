/* A skeleton: its levels, then the classes of the deepest one. */
#include "report.h"

#include <math.h>

static const esk_column level_columns[] = {{"level", true}, {"intraclass ratio", true}, {"split class", true},
	{"split ratio", true}, {"degenerate", false}};

static const esk_column class_columns[] = {{"class", true}, {"voxels", true}, {"x mm", true}, {"y mm", true},
	{"z mm", true}, {"√λ1 mm", true}, {"√λ2 mm", true}, {"√λ3 mm", true}, {"ρ mm", true}};

static void add_level(esk_table *table, const json_t *level)
{
	esk_report_number(table, level, "level", 0);
	esk_report_number(table, level, "intraclass_ratio", 4);
	esk_report_number(table, level, "split_class", 0);
	esk_report_number(table, level, "split_ratio", 4);
	esk_table_cell(table, json_is_true(json_object_get(level, "degenerate")) ? "yes" : "no");
}

static void add_class(esk_table *table, const json_t *node)
{
	const json_t *centre = json_object_get(node, "centre_mm"),
		     *eigenvalues = json_object_get(node, "eigenvalues_mm2");
	esk_report_number(table, node, "class", 0);
	esk_report_number(table, node, "voxels", 0);
	for (size_t i = 0; i < 3; i++)
		esk_table_format(table, "%.1f", json_number_value(json_array_get(centre, i)));
	for (size_t i = 0; i < 3; i++)
		esk_table_format(table, "%.2f", sqrt(json_number_value(json_array_get(eigenvalues, i))));
	esk_report_number(table, node, "rho_mm", 2);
}

static bool write_skeleton(const json_t *skeleton, FILE *out, bool colour)
{
	const json_t *levels = json_object_get(skeleton, "levels"), *nodes = json_object_get(skeleton, "nodes");
	json_int_t deepest = (json_int_t)json_array_size(levels);
	size_t i;
	json_t *item;
	esk_table *level_table = esk_table_new(level_columns, sizeof level_columns / sizeof *level_columns);
	esk_table *class_table = esk_table_new(class_columns, sizeof class_columns / sizeof *class_columns);
	json_array_foreach (levels, i, item)
		add_level(level_table, item);
	json_array_foreach (nodes, i, item) {
		if (json_integer_value(json_object_get(item, "level")) == deepest)
			add_class(class_table, item);
	}
	bool whole = esk_table_write(level_table, out, colour);
	fprintf(out, "\nthe classes of level %lld\n", (long long)deepest);
	whole = esk_table_write(class_table, out, colour) && whole;
	esk_table_free(level_table);
	esk_table_free(class_table);
	return whole;
}

bool esk_report_skeleton(const json_t *answers, FILE *out, bool colour)
{
	size_t i;
	json_t *entry;
	bool whole = true;
	json_array_foreach (answers, i, entry) {
		fputs(i > 0 ? "\n" : "", out);
		esk_table_write_plain(out, esk_report_member(entry, "source"));
		fputc('\n', out);
		whole = write_skeleton(json_object_get(entry, "answer"), out, colour) && whole;
	}
	return whole;
}
