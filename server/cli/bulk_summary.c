#include "bulk_summary.h"

#include <errno.h>
#include <string.h>

typedef struct {
	size_t files[ESK_POSTING_REFUSED + 1], added, there; /* files by state; shapes */
	int widest;                                          /* name of a refused file */
} totals;

static totals add_up(const esk_bulk *bulk)
{
	totals t = {0};
	for (size_t i = 0; i < bulk->postings->count; i++) {
		const esk_posting_result *result = &bulk->results[i];
		t.files[result->state]++;
		t.added += result->added;
		t.there += result->there;
		const int width = (int)strlen(bulk->postings->items[i].file);
		if (result->state == ESK_POSTING_REFUSED && width > t.widest)
			t.widest = width;
	}
	return t;
}

static const char *reason(const esk_posting_result *result)
{
	return result->reason ? result->reason : "memory ran out for the reason";
}

void esk_bulk_summary_write(const esk_bulk *bulk, FILE *out)
{
	const totals t = add_up(bulk);
	for (size_t i = 0; i < bulk->postings->count; i++) {
		if (bulk->results[i].state == ESK_POSTING_REFUSED)
			fprintf(out, "refused  %-*s  %s\n", t.widest, bulk->postings->items[i].file,
				reason(&bulk->results[i]));
	}
	fputs(t.files[ESK_POSTING_REFUSED] > 0 ? "\n" : "", out);
	fprintf(out, "files   %zu: %zu added, %zu there already, %zu refused", bulk->postings->count,
		t.files[ESK_POSTING_ADDED], t.files[ESK_POSTING_THERE], t.files[ESK_POSTING_REFUSED]);
	if (t.files[ESK_POSTING_LEFT] > 0)
		fprintf(out, ", %zu left", t.files[ESK_POSTING_LEFT]);
	fprintf(out, "\nshapes  %zu: %zu added, %zu there already\n", t.added + t.there, t.added, t.there);
	if (t.files[ESK_POSTING_LEFT] > 0)
		fprintf(out, "%s; the same command goes on where this ended\n",
			bulk->interrupted ? "interrupted" : "broken off");
}

esk_outcome esk_bulk_summary_write_refused(const esk_bulk *bulk, const char *path)
{
	FILE *out = fopen(path, "we");
	if (!out)
		return esk_complain(ESK_REFUSED, "%s: %s", path, strerror(errno));
	fputs("path,reason\r\n", out);
	for (size_t i = 0; i < bulk->postings->count; i++) {
		if (bulk->results[i].state != ESK_POSTING_REFUSED)
			continue;
		esk_csv_write_field(bulk->postings->items[i].file, out);
		fputc(',', out);
		esk_csv_write_field(reason(&bulk->results[i]), out);
		fputs("\r\n", out);
	}
	const bool whole = !ferror(out);
	return fclose(out) || !whole ? esk_complain(ESK_REFUSED, "%s: %s", path, strerror(errno)) : ESK_DONE;
}
