/* Checks of label maps: a row a label, what it says beside what its shape says; then the findings in words. */
#include "report.h"

#include <string.h>

static const esk_column columns[] = {{"label", true}, {"name", false}, {"says", false}, {"side", false},
	{"looks like", false}, {"sure", true}, {"side", false}, {"sure", true}, {"z", true}, {"findings", false}};

static esk_tone tone_of(const char *severity)
{
	return strcmp(severity, "error") == 0 ? ESK_TONE_BAD : ESK_TONE_PLAIN;
}

/* "swapped_side, holes", notes in parentheses; in the tone of the worst. */
static void add_findings(esk_table *table, const json_t *findings)
{
	char text[400] = "";
	size_t i, used = 0;
	json_t *finding;
	esk_tone tone = ESK_TONE_PLAIN;
	json_array_foreach (findings, i, finding) {
		const char *severity = esk_report_member(finding, "severity");
		bool note = strcmp(severity, "note") == 0;
		if (tone_of(severity) == ESK_TONE_BAD)
			tone = ESK_TONE_BAD;
		int size = snprintf(text + used, sizeof text - used, "%s%s%s%s", used ? ", " : "", note ? "(" : "",
			esk_report_member(finding, "code"), note ? ")" : "");
		if (size < 0 || (size_t)size >= sizeof text - used)
			break;
		used += (size_t)size;
	}
	if (used > 0)
		esk_table_toned_cell(table, tone, text);
	else
		esk_table_toned_cell(table, ESK_TONE_GOOD, "-");
}

static void add_label(esk_table *table, const json_t *label, const char *source)
{
	const json_t *verdict = json_object_get(label, "verdict");
	esk_report_number(table, label, "label", 0);
	esk_report_name(table, label, source);
	esk_table_cell(table, esk_report_member(label, "class"));
	esk_table_cell(table, esk_report_member(label, "side"));
	esk_report_class(table, verdict);
	esk_table_cell(table, esk_report_member(verdict, "side"));
	esk_report_score(table, verdict, "side_score");
	esk_report_number(table, label, "distance_z", 1);
	add_findings(table, json_object_get(label, "findings"));
}

static void write_finding(const json_t *label, const json_t *finding, FILE *out)
{
	const char *name = json_string_value(json_object_get(label, "name"));
	fprintf(out, "label %lld", (long long)json_integer_value(json_object_get(label, "label")));
	if (name) {
		fputs(" (", out);
		esk_table_write_plain(out, name);
		fputc(')', out);
	}
	fputs(": ", out);
	esk_table_write_plain(out, esk_report_member(finding, "severity"));
	fputc(' ', out);
	esk_table_write_plain(out, esk_report_member(finding, "code"));
	fputs(": ", out);
	esk_table_write_plain(out, esk_report_member(finding, "text"));
	fputc('\n', out);
}

static void write_warnings(const json_t *answer, const char *source, FILE *out)
{
	size_t i;
	json_t *warning;
	json_array_foreach (json_object_get(answer, "warnings"), i, warning) {
		esk_table_write_plain(out, source);
		fputs(": ", out);
		esk_table_write_plain(out, esk_report_member(warning, "text"));
		fputc('\n', out);
	}
}

/* The findings of one answer in words, after a line that counts them. */
static void write_words(const json_t *entry, FILE *out)
{
	size_t i, j;
	json_t *label, *finding;
	const json_t *answer = json_object_get(entry, "answer"), *counts = json_object_get(answer, "findings");
	const char *source = esk_report_member(entry, "source");
	fputc('\n', out);
	esk_table_write_plain(out, source);
	fprintf(out, ": labels %zu, errors %lld, warnings %lld, notes %lld\n",
		json_array_size(json_object_get(answer, "labels")),
		(long long)json_integer_value(json_object_get(counts, "error")),
		(long long)json_integer_value(json_object_get(counts, "warning")),
		(long long)json_integer_value(json_object_get(counts, "note")));
	write_warnings(answer, source, out);
	json_array_foreach (json_object_get(answer, "labels"), i, label)
		json_array_foreach (json_object_get(label, "findings"), j, finding)
			write_finding(label, finding, out);
}

bool esk_report_check(const json_t *answers, FILE *out, bool colour)
{
	size_t i, j;
	json_t *entry, *label;
	esk_table *table = esk_table_new(columns, sizeof columns / sizeof *columns);
	json_array_foreach (answers, i, entry)
		json_array_foreach (json_object_get(json_object_get(entry, "answer"), "labels"), j, label)
			add_label(table, label, esk_report_member(entry, "source"));
	bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	json_array_foreach (answers, i, entry)
		write_words(entry, out);
	return whole;
}
