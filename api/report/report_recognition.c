/* Recognitions: a row each with the verdict and the nearest shape; a single one also with all its neighbours. */
#include "report.h"

static const esk_column verdict_columns[] = {{"query", false}, {"class", false}, {"sure", true}, {"side", false},
	{"sure", true}, {"nearest", false}, {"distance", true}, {"chirality", false}, {"agrees", false}, {"ms", true}};

static const esk_column neighbour_columns[] = {{"#", true}, {"name", false}, {"class", false}, {"side", false},
	{"subject", false}, {"distance", true}, {"chirality", false}, {"score", true}, {"id", false}};

static const esk_column scaled_columns[] = {{"#", true}, {"name", false}, {"class", false}, {"side", false},
	{"subject", false}, {"scaled", true}, {"distance", true}, {"chirality", false}, {"score", true}, {"id", false}};

static const esk_column position_columns[] = {{"#", true}, {"name", false}, {"class", false}, {"side", false},
	{"subject", false}, {"position", true}, {"distance", true}, {"chirality", false}, {"score", true},
	{"id", false}};

/* What neighbours are ordered by where it is not the distance: a member of each, and a column before the distance. */
typedef struct {
	const char *member;
	const esk_column *columns;
	size_t column_count;
	const char *unproven;
} neighbour_order;

static const neighbour_order orders[] = {
	{"scaled", scaled_columns, sizeof scaled_columns / sizeof *scaled_columns, "only the nearest were scaled"},
	{"position_distance", position_columns, sizeof position_columns / sizeof *position_columns,
		"only the nearest were put in order"},
};

/* NULL: by distance. */
static const neighbour_order *order_of(const json_t *neighbour)
{
	for (size_t i = 0; i < sizeof orders / sizeof *orders; i++)
		if (json_object_get(neighbour, orders[i].member))
			return &orders[i];
	return NULL;
}

/* Whether the verdict agrees with what is recorded of the query. */
static void add_agreement(esk_table *table, const json_t *verdict)
{
	const json_t *agrees = json_object_get(verdict, "agrees");
	if (json_is_true(agrees))
		esk_table_toned_cell(table, ESK_TONE_GOOD, "yes");
	else if (json_is_false(agrees))
		esk_table_toned_cell(table, ESK_TONE_BAD, "no");
	else
		esk_table_cell(table, "-");
}

static void add_chirality(esk_table *table, const json_t *neighbour)
{
	const json_t *chirality = json_object_get(neighbour, "chirality");
	esk_table_cell(table, esk_report_member(chirality, "verdict"));
	esk_report_number(table, chirality, "score", 2);
}

static void add_verdict(esk_table *table, const json_t *result, const char *source)
{
	const json_t *verdict = json_object_get(result, "verdict");
	const json_t *nearest = json_array_get(json_object_get(result, "neighbours"), 0);
	esk_report_name(table, json_object_get(result, "query"), source);
	esk_report_class(table, verdict);
	esk_table_cell(table, esk_report_member(verdict, "side"));
	esk_report_score(table, verdict, "side_score");
	esk_report_name(table, nearest, esk_report_member(nearest, "id"));
	esk_report_number(table, nearest, "distance", 4);
	esk_table_cell(table, esk_report_member(json_object_get(nearest, "chirality"), "verdict"));
	add_agreement(table, verdict);
	esk_report_number(table, json_object_get(result, "search"), "milliseconds", 1);
}

static void add_neighbour(esk_table *table, const neighbour_order *order, const json_t *neighbour, size_t rank)
{
	esk_table_format(table, "%zu", rank);
	esk_report_name(table, neighbour, "-");
	esk_table_cell(table, esk_report_member(neighbour, "class"));
	esk_table_cell(table, esk_report_member(neighbour, "side"));
	esk_table_cell(table, esk_report_member(neighbour, "subject"));
	if (order)
		esk_report_number(table, neighbour, order->member, 4);
	esk_report_number(table, neighbour, "distance", 4);
	add_chirality(table, neighbour);
	esk_table_cell(table, esk_report_member(neighbour, "id"));
}

static bool write_neighbours(const json_t *result, const neighbour_order *order, FILE *out, bool colour)
{
	size_t i;
	json_t *neighbour;
	esk_table *table =
		order ? esk_table_new(order->columns, order->column_count)
		      : esk_table_new(neighbour_columns, sizeof neighbour_columns / sizeof *neighbour_columns);
	json_array_foreach (json_object_get(result, "neighbours"), i, neighbour)
		add_neighbour(table, order, neighbour, i + 1);
	fputc('\n', out);
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

static void write_search(const json_t *result, const neighbour_order *order, FILE *out)
{
	const json_t *search = json_object_get(result, "search");
	fprintf(out, "\nsearched %lld shapes, mode ",
		(long long)json_integer_value(json_object_get(search, "library")));
	esk_table_write_plain(out, esk_report_member(search, "mode"));
	if (json_is_true(json_object_get(search, "proven")))
		fputs(": proven, no other shape is nearer\n", out);
	else
		fprintf(out, ": not proven, %s\n", order ? order->unproven : "a nearer shape may have been pruned");
}

/* The whole, how deep the trees agree, and how well one shape lies on the other. */
static void write_whole(const json_t *nearest, FILE *out)
{
	const json_t *superposition = json_object_get(nearest, "superposition");
	const json_t *isomorphism = json_object_get(nearest, "isomorphism");
	fputs("as a whole: ", out);
	esk_table_write_plain(out, esk_report_member(json_object_get(nearest, "summary"), "text"));
	fprintf(out, "\nthe trees agree down to level %lld; laid on it%s, class centres lie %.1f mm off (rms)\n",
		(long long)json_integer_value(json_object_get(isomorphism, "depth")),
		json_is_true(json_object_get(superposition, "mirrored")) ? " mirrored" : "",
		json_number_value(json_object_get(superposition, "rms_mm")));
}

/* In what the query differs from the nearest shape, where the answer explains it. */
static void write_differences(const json_t *nearest, FILE *out)
{
	size_t i;
	bool any = false;
	json_t *difference;
	const json_t *differences = json_object_get(nearest, "differences");
	if (!differences)
		return;
	fputs("\nbeside ", out);
	esk_table_write_plain(out, esk_report_member(nearest, "name"));
	fputs(", matched class by class:\n", out);
	json_array_foreach (differences, i, difference) {
		const char *text = json_string_value(json_object_get(difference, "text"));
		if (!text)
			continue;
		any = true;
		fputs("  ", out);
		esk_table_write_plain(out, text);
		fputs(json_is_true(json_object_get(difference, "remarkable")) ? " (stands out)\n" : "\n", out);
	}
	if (!any)
		fputs("  no class differs much\n", out);
	if (json_object_get(nearest, "superposition"))
		write_whole(nearest, out);
}

bool esk_report_recognition(const json_t *answers, FILE *out, bool colour)
{
	size_t i, j, count = 0;
	json_t *entry, *result, *only = NULL;
	esk_table *table = esk_table_new(verdict_columns, sizeof verdict_columns / sizeof *verdict_columns);
	json_array_foreach (answers, i, entry) {
		json_array_foreach (json_object_get(json_object_get(entry, "answer"), "results"), j, result) {
			add_verdict(table, result, esk_report_member(entry, "source"));
			count++;
			only = result;
		}
	}
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	if (count == 1) {
		const json_t *nearest = json_array_get(json_object_get(only, "neighbours"), 0);
		const neighbour_order *order = order_of(nearest);
		whole = write_neighbours(only, order, out, colour) && whole;
		write_search(only, order, out);
		write_differences(nearest, out);
	}
	return whole;
}
