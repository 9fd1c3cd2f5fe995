#include "label_names.h"

#include "arguments.h"
#include "label_colours.h"
#include "label_csv.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

bool esk_label_parse(const char *text, int32_t *label)
{
	char *end = NULL;
	errno = 0;
	long value = strtol(text, &end, 10);
	bool digits = (text[0] >= '0' && text[0] <= '9') || (text[0] == '-' && text[1] >= '0' && text[1] <= '9');
	if (!digits || *end || errno || value == 0 || value < INT32_MIN || value > INT32_MAX)
		return false;
	*label = (int32_t)value;
	return true;
}

esk_outcome esk_label_names_add(esk_label_names *names, const esk_label_name *name)
{
	/* Grows at each power of two. */
	if ((names->count & (names->count - 1)) == 0) {
		size_t capacity = names->count > 0 ? 2 * names->count : 1;
		esk_label_name *items = reallocarray(names->items, capacity, sizeof *items);
		if (!items)
			return esk_complain(ESK_REFUSED, "memory ran out");
		names->items = items;
	}
	names->items[names->count++] = *name;
	return ESK_DONE;
}

static int by_label(const void *a, const void *b)
{
	const esk_label_name *left = a, *right = b;
	if (left->label != right->label)
		return left->label < right->label ? -1 : 1;
	return left->line < right->line ? -1 : left->line > right->line;
}

static esk_outcome sort_names(const char *path, esk_label_names *names)
{
	if (names->count > 0)
		qsort(names->items, names->count, sizeof *names->items, by_label);
	for (size_t i = 1; i < names->count; i++) {
		const esk_label_name *row = &names->items[i];
		if (row->label == row[-1].label)
			return esk_complain(ESK_MISUSED, "%s, line %u: the label %d stands in line %u already", path,
				row->line, (int)row->label, row[-1].line);
	}
	return ESK_DONE;
}

esk_outcome esk_label_names_read(const char *path, esk_label_names *names)
{
	esk_label_names read = {0};
	esk_outcome outcome = esk_csv_open(path, &read.csv);
	if (!outcome)
		outcome = esk_label_colours_recognize(read.csv.next) ? esk_label_colours_read(&read)
								     : esk_label_csv_read(&read);
	if (!outcome)
		outcome = sort_names(path, &read);
	if (outcome)
		esk_label_names_clear(&read);
	else
		*names = read;
	return outcome;
}

void esk_label_names_clear(esk_label_names *names)
{
	free(names->items);
	esk_csv_close(&names->csv);
	*names = (esk_label_names){0};
}

const esk_label_name *esk_label_names_find(const esk_label_names *names, int32_t label)
{
	for (size_t low = 0, high = names->count; low < high;) {
		size_t middle = low + (high - low) / 2;
		const esk_label_name *row = &names->items[middle];
		if (row->label == label)
			return row;
		if (row->label < label)
			low = middle + 1;
		else
			high = middle;
	}
	return NULL;
}

static void write_member(const esk_label_name *row, const char *member, const char *value, FILE *out)
{
	if (!*value)
		return;
	fprintf(out, "&label.%d.%s=", (int)row->label, member);
	esk_arguments_write_escaped(value, out);
}

void esk_label_names_write_query(const esk_label_name *row, FILE *out)
{
	write_member(row, "name", row->name, out);
	write_member(row, "class", row->class, out);
	write_member(row, "side", row->side, out);
}
