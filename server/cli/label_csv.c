#include "label_csv.h"

#include <string.h>

enum { LABEL, NAME, CLASS, SIDE, MEMBERS };
static const char *const members[MEMBERS] = {"label", "name", "class", "side"};

static bool is_called(const char *field, size_t member)
{
	return !strcasecmp(field, members[member]) || (member == LABEL && !strcasecmp(field, "index"));
}

/* Where the members stand: places[m] is the column of members[m] from 0, or -1. */
static esk_outcome read_header(esk_csv *csv, int places[MEMBERS], size_t *column_count)
{
	const char *fields[ESK_CSV_MOST_COLUMNS];
	esk_outcome outcome = esk_csv_read_line(csv, fields, column_count);
	for (size_t m = 0; m < MEMBERS && !outcome; m++) {
		places[m] = -1;
		for (size_t c = 0; c < *column_count; c++) {
			if (!is_called(fields[c], m))
				continue;
			if (places[m] >= 0)
				return esk_complain(ESK_MISUSED, "%s, line %u, column %zu: %s is a column already",
					csv->path, csv->line, c + 1, members[m]);
			places[m] = (int)c;
		}
	}
	if (!outcome && places[LABEL] < 0)
		return esk_complain(ESK_MISUSED, "%s, line 1: there is no column called label or index", csv->path);
	return outcome;
}

/* The side in the server's words; NULL for what is none. */
static const char *side_of(const char *text)
{
	static const char *const sides[][2] = {{"", ""}, {"left", "L"}, {"right", "R"}, {"none", "N"}};
	for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
		if (!strcasecmp(text, sides[i][0]) || !strcasecmp(text, sides[i][1]))
			return sides[i][0];
	}
	return NULL;
}

/* BIDS's word for an empty field. */
static bool is_nothing(const esk_csv *csv, const char *field)
{
	return csv->separator == '\t' && strcmp(field, "n/a") == 0;
}

static esk_outcome read_row(const char *const fields[], const int places[MEMBERS], esk_label_names *names)
{
	const esk_csv *csv = &names->csv;
	const char *texts[MEMBERS];
	for (size_t m = 0; m < MEMBERS; m++)
		texts[m] = places[m] >= 0 && !is_nothing(csv, fields[places[m]]) ? fields[places[m]] : "";
	if (csv->separator == '\t' && strcmp(texts[LABEL], "0") == 0)
		return ESK_DONE;
	int32_t label;
	if (!esk_label_parse(texts[LABEL], &label))
		return esk_complain(ESK_MISUSED,
			"%s, line %u, column %d (label): \"%s\" is not a whole number other than 0", csv->path,
			csv->line, places[LABEL] + 1, texts[LABEL]);
	const char *side = side_of(texts[SIDE]);
	if (!side)
		return esk_complain(ESK_MISUSED, "%s, line %u, column %d (side): \"%s\" is not left, right or none",
			csv->path, csv->line, places[SIDE] + 1, texts[SIDE]);
	const esk_label_name row = {label, csv->line, texts[NAME], texts[CLASS], side};
	return esk_label_names_add(names, &row);
}

esk_outcome esk_label_csv_read(esk_label_names *names)
{
	int places[MEMBERS];
	size_t column_count = 0, count;
	const char *fields[ESK_CSV_MOST_COLUMNS];
	esk_csv *csv = &names->csv;
	if (memchr(csv->next, '\t', strcspn(csv->next, "\n")))
		csv->separator = '\t';
	esk_outcome outcome = read_header(csv, places, &column_count);
	while (!outcome && csv->next < csv->end) {
		outcome = esk_csv_read_line(csv, fields, &count);
		if (outcome || count == 0)
			continue;
		if (count != column_count)
			outcome = esk_complain(ESK_MISUSED,
				"%s, line %u, column %zu: %zu fields, expected %zu as in the header", csv->path,
				csv->line, count, count, column_count);
		else
			outcome = read_row(fields, places, names);
	}
	return outcome;
}
