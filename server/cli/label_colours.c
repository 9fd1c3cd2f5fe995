#include "label_colours.h"

#include <string.h>

static const char blanks[] = " \t\r";

enum { snap_numbers = 6, colour_numbers = 4 };

/* The line at text without the blanks before it; whether it is a row. */
static bool is_row(const char **text)
{
	*text += strspn(*text, blanks);
	return **text != '\0' && **text != '\n' && **text != '#';
}

bool esk_label_colours_recognize(const char *text)
{
	while (*text && !is_row(&text)) {
		text += strcspn(text, "\n");
		text += *text == '\n';
	}
	size_t digits = strspn(text, "-0123456789");
	return digits > 0 && (text[digits] == ' ' || text[digits] == '\t');
}

static void trim_end(char *text)
{
	size_t size = strlen(text);
	while (size > 0 && strchr(blanks, text[size - 1]))
		size--;
	text[size] = '\0';
}

/* Takes count numbers off the text's end. */
static bool drop_numbers(char *text, int count)
{
	for (; count > 0; count--) {
		trim_end(text);
		size_t before = strlen(text);
		while (before > 0 && !strchr(blanks, text[before - 1]))
			before--;
		const char *number = text + before;
		if (*number == '\0' || number[strspn(number, "0123456789.")] != '\0')
			return false;
		text[before] = '\0';
	}
	trim_end(text);
	return true;
}

/* Cuts a trimmed line, which it overwrites, into the texts of label and name. */
static bool split_row(char *line, const char **label, const char **name)
{
	char *first = line + strcspn(line, blanks), *last = line + strlen(line) - 1;
	*label = line;
	if (*last == '"') {
		char *quote = strchr(line, '"');
		if (quote == last)
			return false;
		*last = *quote = '\0';
		*name = quote + 1;
		return drop_numbers(line, snap_numbers) && *line && !strpbrk(line, blanks);
	}
	if (!drop_numbers(line, colour_numbers) || *first == '\0')
		return false;
	*first = '\0';
	first++;
	*name = first + strspn(first, blanks);
	return true;
}

static esk_outcome read_row(esk_label_names *names, char *line)
{
	esk_label_name row = {.line = names->csv.line, .name = "", .class = "", .side = ""};
	const char *label;
	trim_end(line);
	if (!split_row(line, &label, &row.name))
		return esk_complain(ESK_MISUSED,
			"%s, line %u: expected a label, its name, red, green, blue and opacity, or a label, six "
			"numbers and a quoted name",
			names->csv.path, row.line);
	if (strcmp(label, "0") == 0)
		return ESK_DONE;
	if (!esk_label_parse(label, &row.label))
		return esk_complain(
			ESK_MISUSED, "%s, line %u: \"%s\" is not a whole number", names->csv.path, row.line, label);
	return esk_label_names_add(names, &row);
}

esk_outcome esk_label_colours_read(esk_label_names *names)
{
	esk_csv *csv = &names->csv;
	esk_outcome outcome = ESK_DONE;
	while (!outcome && csv->next < csv->end) {
		char *line = csv->next, *end = line + strcspn(line, "\n");
		const char *first = line;
		csv->next = end < csv->end ? end + 1 : end;
		csv->line++;
		*end = '\0';
		if (is_row(&first))
			outcome = read_row(names, line + (first - line));
	}
	return outcome;
}
