/* Evaluations as text and as CSV, see report_evaluation.h. */
#include "report_evaluation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- columns */

/* Of the comparisons of sides, those at the threshold from which a chirality is told. */
static const json_t *told_sides(const json_t *answer)
{
	static const double threshold = 0.05;
	size_t i;
	json_t *one;
	json_array_foreach (json_object_get(json_object_get(answer, "side"), "thresholds"), i, one)
		if (fabs(json_number_value(json_object_get(one, "threshold")) - threshold) < 1e-9)
			return one;
	return NULL;
}

static double share(double part, double whole)
{
	return whole > 0 ? part / whole : NAN;
}

static double sides_decided(const json_t *answer)
{
	return share(
		esk_evaluation_number(told_sides(answer), "decided"), esk_evaluation_number(answer, "side.compared"));
}

static double sides_right(const json_t *answer)
{
	const json_t *told = told_sides(answer);
	return share(esk_evaluation_number(told, "right"), esk_evaluation_number(told, "decided"));
}

const esk_evaluation_column esk_evaluation_columns[] = {
	{{"signature", false}, "signature", "distance.signature", -1, NULL, false},
	{{"distance", false}, "distance", "distance.distance", -1, NULL, false},
	{{"level", true}, "level", "distance.level", -1, NULL, false},
	{{"metric", false}, "metric", "distance.metric", -1, NULL, false},
	{{"size", false}, "size", "distance.size", -1, NULL, false},
	{{"leave out", false}, "leave_out", "leave_out", -1, NULL, true},
	{{"shapes", true}, "shapes", "shapes", -1, NULL, true},
	{{"classes", true}, "classes", "classes", -1, NULL, true},
	{{"queries", true}, "queries", "queries", -1, NULL, true},
	{{"NN", true}, "nearest_neighbour", "measures.nearest_neighbour", 3, NULL, false},
	{{"FT", true}, "first_tier", "measures.first_tier", 3, NULL, false},
	{{"ST", true}, "second_tier", "measures.second_tier", 3, NULL, false},
	{{"E", true}, "e_measure", "measures.e_measure", 3, NULL, false},
	{{"DCG", true}, "dcg", "measures.dcg", 3, NULL, false},
	{{"sided", true}, "sides_compared", "side.compared", -1, NULL, true},
	{{"decided", true}, "sides_decided", NULL, 3, sides_decided, false},
	{{"right", true}, "sides_right", NULL, 3, sides_right, false},
	{{"recall", true}, "pruned_recall", "pruned.recall", 3, NULL, false},
	{{"exact mean ms", true}, "exact_mean_ms", "milliseconds.exact.mean", 3, NULL, true},
	{{"exact ms", true}, "exact_median_ms", "milliseconds.exact.median", 3, NULL, false},
	{{"exact p95 ms", true}, "exact_p95_ms", "milliseconds.exact.p95", 3, NULL, true},
	{{"pruned mean ms", true}, "pruned_mean_ms", "milliseconds.pruned.mean", 3, NULL, true},
	{{"pruned ms", true}, "pruned_median_ms", "milliseconds.pruned.median", 3, NULL, false},
	{{"pruned p95 ms", true}, "pruned_p95_ms", "milliseconds.pruned.p95", 3, NULL, true},
};

const size_t esk_evaluation_column_count = sizeof esk_evaluation_columns / sizeof *esk_evaluation_columns;

static const json_t *member_at(const json_t *answer, const char *path)
{
	char name[32];
	while (answer && *path) {
		size_t size = strcspn(path, ".");
		snprintf(name, sizeof name, "%.*s", (int)size, path);
		answer = json_object_get(answer, name);
		path += size + (path[size] == '.');
	}
	return answer;
}

double esk_evaluation_number(const json_t *answer, const char *path)
{
	const json_t *member = member_at(answer, path);
	return json_is_number(member) ? json_number_value(member) : NAN;
}

void esk_evaluation_cell(const esk_evaluation_column *column, const json_t *answer, int decimals, char *text)
{
	const json_t *member = column->value ? NULL : member_at(answer, column->path);
	const double number = column->value            ? column->value(answer)
			      : json_is_number(member) ? json_number_value(member)
						       : NAN;
	*text = 0;
	if (json_is_string(member))
		snprintf(text, ESK_EVALUATION_CELL_SIZE, "%s", json_string_value(member));
	else if (isfinite(number))
		snprintf(text, ESK_EVALUATION_CELL_SIZE, "%.*f", column->decimals < 0 ? 0 : decimals, number);
}

void esk_evaluation_name(const json_t *answer, char *text)
{
	size_t used = 0;
	*text = 0;
	for (size_t c = 0; c < esk_evaluation_column_count && used < ESK_EVALUATION_NAME_SIZE; c++) {
		char cell[ESK_EVALUATION_CELL_SIZE];
		const esk_evaluation_column *column = &esk_evaluation_columns[c];
		if (!column->path || strncmp(column->path, "distance.", 9) != 0)
			continue;
		esk_evaluation_cell(column, answer, 0, cell);
		used += (size_t)snprintf(
			text + used, ESK_EVALUATION_NAME_SIZE - used, "%s%s", used && *cell ? " " : "", cell);
	}
}

/* ---- confusion */

static json_int_t mistakes_of(const json_t *row)
{
	return json_integer_value(json_object_get(row, "queries")) - json_integer_value(json_object_get(row, "right"));
}

static int most_mistakes_first(const void *a, const void *b)
{
	const json_t *const *x = a, *const *y = b;
	const json_int_t more = mistakes_of(*y) - mistakes_of(*x);
	return more ? (more > 0 ? 1 : -1) : strcmp(esk_report_member(*x, "class"), esk_report_member(*y, "class"));
}

bool esk_evaluation_mistaken(const json_t *answer, const json_t ***rows, size_t *count)
{
	const json_t *confusion = json_object_get(answer, "confusion");
	const json_t **made = calloc(json_array_size(confusion) + 1, sizeof *made);
	size_t i, found = 0;
	json_t *row;
	if (!made)
		return false;
	json_array_foreach (confusion, i, row)
		if (mistakes_of(row) > 0)
			made[found++] = row;
	qsort(made, found, sizeof *made, most_mistakes_first);
	*rows = made;
	*count = found;
	return true;
}

/* "cuboid 2, talus". */
static void add_taken_for(esk_table *table, const json_t *row)
{
	char text[256];
	size_t i, used = 0;
	json_t *one;
	const char *class = esk_report_member(row, "class");
	*text = 0;
	json_array_foreach (json_object_get(row, "nearest"), i, one) {
		const char *other = esk_report_member(one, "class");
		const json_int_t queries = json_integer_value(json_object_get(one, "queries"));
		if (strcmp(other, class) == 0 || used >= sizeof text)
			continue;
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used ? ", " : "", other);
		if (queries > 1 && used < sizeof text)
			used += (size_t)snprintf(text + used, sizeof text - used, " %lld", (long long)queries);
	}
	esk_table_cell(table, text);
}

static const esk_column mistaken_columns[] = {
	{"class", false}, {"queries", true}, {"right", true}, {"taken for", false}};

static bool write_mistaken(const json_t *answer, FILE *out, bool colour)
{
	const json_t **rows = NULL;
	size_t count = 0;
	if (!esk_evaluation_mistaken(answer, &rows, &count))
		return false;
	esk_table *table = esk_table_new(mistaken_columns, sizeof mistaken_columns / sizeof *mistaken_columns);
	for (size_t i = 0; i < count; i++) {
		esk_table_cell(table, esk_report_member(rows[i], "class"));
		esk_report_number(table, rows[i], "queries", 0);
		esk_report_number(table, rows[i], "right", 0);
		add_taken_for(table, rows[i]);
	}
	fputs(count > 0 ? "\nclasses whose nearest shape is of another\n" : "", out);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	free(rows);
	return whole;
}

/* ---- the rest of one evaluation */

static const esk_column side_columns[] = {
	{"|score| from", true}, {"decided", true}, {"share", true}, {"right", true}, {"share", true}};

static bool write_sides(const json_t *answer, FILE *out, bool colour)
{
	size_t i;
	json_t *one;
	const double compared = esk_evaluation_number(answer, "side.compared");
	if (!(compared > 0))
		return true;
	fputs("\nsides, beside the nearest left or right shape of the class\n", out);
	esk_table *table = esk_table_new(side_columns, sizeof side_columns / sizeof *side_columns);
	json_array_foreach (json_object_get(json_object_get(answer, "side"), "thresholds"), i, one) {
		const double decided = esk_evaluation_number(one, "decided"),
			     right = esk_evaluation_number(one, "right");
		esk_report_number(table, one, "threshold", 2);
		esk_report_number(table, one, "decided", 0);
		esk_table_format(table, "%.3f", share(decided, compared));
		esk_report_number(table, one, "right", 0);
		if (decided > 0)
			esk_table_format(table, "%.3f", share(right, decided));
		else
			esk_table_cell(table, "-");
	}
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

static const esk_column step_columns[] = {{"level", true}, {"kept", true}, {"recall", true}};

static bool write_steps(const json_t *answer, FILE *out, bool colour)
{
	size_t i;
	json_t *one;
	const json_t *steps = json_object_get(json_object_get(answer, "pruned"), "steps");
	fputs(json_array_size(steps) > 0 ? "\nmode pruned: shapes still in, and how often the true nearest is\n" : "",
		out);
	esk_table *table = esk_table_new(step_columns, sizeof step_columns / sizeof *step_columns);
	json_array_foreach (steps, i, one) {
		esk_report_number(table, one, "level", 0);
		esk_report_number(table, one, "kept", 1);
		esk_report_number(table, one, "recall", 3);
	}
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

static const esk_column time_columns[] = {{"mode", false}, {"mean ms", true}, {"median ms", true}, {"p95 ms", true}};

static bool write_times(const json_t *answer, FILE *out, bool colour)
{
	static const char *const modes[] = {"exact", "pruned"};
	esk_table *table = esk_table_new(time_columns, sizeof time_columns / sizeof *time_columns);
	for (size_t i = 0; i < 2; i++) {
		const json_t *times = json_object_get(json_object_get(answer, "milliseconds"), modes[i]);
		esk_table_cell(table, modes[i]);
		esk_report_number(table, times, "mean", 3);
		esk_report_number(table, times, "median", 3);
		esk_report_number(table, times, "p95", 3);
	}
	fputc('\n', out);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

/* ---- the table of distances */

static esk_column *shown_columns(size_t *count)
{
	esk_column *columns = calloc(esk_evaluation_column_count, sizeof *columns);
	*count = 0;
	for (size_t c = 0; columns && c < esk_evaluation_column_count; c++)
		if (!esk_evaluation_columns[c].csv_only)
			columns[(*count)++] = esk_evaluation_columns[c].column;
	return columns;
}

static void add_row(esk_table *table, const json_t *answer)
{
	for (size_t c = 0; c < esk_evaluation_column_count; c++) {
		char cell[ESK_EVALUATION_CELL_SIZE];
		const esk_evaluation_column *column = &esk_evaluation_columns[c];
		if (column->csv_only)
			continue;
		esk_evaluation_cell(column, answer, column->decimals, cell);
		esk_table_cell(table, *cell ? cell : "-");
	}
}

static bool write_distances(const json_t *answers, FILE *out, bool colour)
{
	size_t count, i;
	json_t *entry;
	esk_column *columns = shown_columns(&count);
	esk_table *table = columns ? esk_table_new(columns, count) : NULL;
	json_array_foreach (answers, i, entry)
		add_row(table, json_object_get(entry, "answer"));
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	free(columns);
	return whole;
}

bool esk_report_evaluation(const json_t *answers, FILE *out, bool colour)
{
	const json_t *first = json_object_get(json_array_get(answers, 0), "answer");
	fprintf(out, "shapes: %.0f, classes: %.0f, queries: %.0f, left out: ", esk_evaluation_number(first, "shapes"),
		esk_evaluation_number(first, "classes"), esk_evaluation_number(first, "queries"));
	esk_table_write_plain(out, esk_report_member(first, "leave_out"));
	fputs("\n\n", out);
	bool whole = write_distances(answers, out, colour);
	if (json_array_size(answers) > 1)
		return whole;
	whole = write_mistaken(first, out, colour) && whole;
	whole = write_sides(first, out, colour) && whole;
	whole = write_steps(first, out, colour) && whole;
	return write_times(first, out, colour) && whole;
}

bool esk_report_evaluation_csv(const json_t *answers, FILE *out)
{
	static const int csv_decimals = 6;
	size_t i;
	json_t *entry;
	for (size_t c = 0; c < esk_evaluation_column_count; c++)
		fprintf(out, "%s%s", c > 0 ? "," : "", esk_evaluation_columns[c].csv);
	fputs("\r\n", out);
	json_array_foreach (answers, i, entry) {
		const json_t *answer = json_object_get(entry, "answer");
		for (size_t c = 0; c < esk_evaluation_column_count; c++) {
			char cell[ESK_EVALUATION_CELL_SIZE];
			esk_evaluation_cell(&esk_evaluation_columns[c], answer, csv_decimals, cell);
			for (char *at = cell; (at = strpbrk(at, ",\"\r\n")) != NULL;)
				*at = ' '; /* words of a choice have none of these */
			fprintf(out, "%s%s", c > 0 ? "," : "", cell);
		}
		fputs("\r\n", out);
	}
	return true;
}
