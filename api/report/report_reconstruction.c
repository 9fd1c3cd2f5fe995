/* A fitted surface: its errors before and after, and how small it is. */
#include "report.h"

static const struct {
	const char *member, *title;
	int decimals;
} measures[] = {
	{"mean_error_mm", "boundary to surface, mean, mm", 3},
	{"greatest_error_mm", "boundary to surface, greatest, mm", 3},
	{"mean_distance_mm", "both ways, mean, mm", 3},
	{"hausdorff_95_mm", "both ways, 95th percentile, mm", 3},
	{"mean_delta_mm", "first-order distance, mean, mm", 3},
	{"greatest_delta_mm", "first-order distance, greatest, mm", 3},
	{"dice", "overlap (Dice)", 4},
	{"volume_ratio", "volume, of that of the voxels", 3},
};

static bool write_one(const json_t *answer, FILE *out, bool colour)
{
	static const esk_column columns[] = {{"error", false}, {"before", true}, {"after", true}};
	const json_t *bytes = json_object_get(answer, "bytes");
	const json_t *mesh_ratio = json_object_get(bytes, "mesh_ratio");
	esk_table *table = esk_table_new(columns, 3);
	for (size_t i = 0; i < sizeof measures / sizeof *measures; i++) {
		esk_table_cell(table, measures[i].title);
		esk_report_number(table, json_object_get(answer, "before"), measures[i].member, measures[i].decimals);
		esk_report_number(table, json_object_get(answer, "after"), measures[i].member, measures[i].decimals);
	}
	const bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	fprintf(out, "\nlevel %lld, %zu primitives, ", (long long)json_integer_value(json_object_get(answer, "level")),
		json_array_size(json_object_get(answer, "primitives")));
	esk_table_write_plain(out, esk_report_member(answer, "primitive"));
	fputs(", fitted by ", out);
	esk_table_write_plain(out, esk_report_member(answer, "method"));
	const json_t *seed = json_object_get(answer, "seed");
	if (seed)
		fprintf(out, ", seed %lld", (long long)json_integer_value(seed));
	fprintf(out, "\n%lld bytes: the voxels have %.0f times as many",
		(long long)json_integer_value(json_object_get(bytes, "surface")),
		json_number_value(json_object_get(bytes, "volume_ratio")));
	if (json_is_number(mesh_ratio))
		fprintf(out, ", a mesh of medium step %.0f times", json_number_value(mesh_ratio));
	fputc('\n', out);
	return whole;
}

bool esk_report_reconstruction(const json_t *answers, FILE *out, bool colour)
{
	return esk_report_each(write_one, answers, out, colour);
}
