/* Jobs: a row each; and what of one a progress bar shows. */
#include "report.h"

#include "eskel_report.h"

#include <string.h>

static const esk_column columns[] = {{"id", false}, {"path", false}, {"created", false}, {"state", false},
	{"done", true}, {"seconds", true}, {"bytes", true}, {"problem", false}};

static void add_row(esk_table *table, const json_t *job)
{
	static const char *const texts[] = {"id", "path", "created", "state"};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		esk_table_cell(table, esk_report_member(job, texts[i]));
	esk_table_format(table, "%.1f %%", 100 * json_number_value(json_object_get(job, "progress")));
	esk_report_number(table, job, "seconds", 1);
	esk_report_number(table, job, "size", 0);
	esk_table_cell(table, esk_report_member(job, "problem"));
}

bool esk_report_jobs(const json_t *answers, FILE *out, bool colour)
{
	size_t i, j;
	json_t *entry, *job;
	esk_table *table = esk_table_new(columns, sizeof columns / sizeof *columns);
	json_array_foreach (answers, i, entry) {
		json_t *answer = json_object_get(entry, "answer");
		json_array_foreach (json_object_get(answer, "jobs"), j, job)
			add_row(table, job);
		if (!json_object_get(answer, "jobs"))
			add_row(table, answer);
	}
	const bool whole = esk_table_write(table, out, colour);
	esk_table_free(table);
	return whole;
}

bool eskel_report_job_read(const char *json, size_t size, eskel_report_job *job)
{
	json_t *answer = json_loadb(json, size, 0, NULL);
	const char *state = json_string_value(json_object_get(answer, "state"));
	if (state)
		*job = (eskel_report_job){
			.progress = json_number_value(json_object_get(answer, "progress")),
			.seconds = json_number_value(json_object_get(answer, "seconds")),
			.failed = strcmp(state, "failed") == 0,
			.ended = strcmp(state, "failed") == 0 || strcmp(state, "done") == 0,
		};
	const bool known = state != NULL;
	json_decref(answer);
	return known;
}
