/* eskel skeleton: decodes a volume and computes the skeletons of its objects here, without a server. */
#include "command.h"
#include "label_csv.h"
#include "volume_file.h"

#include "eskel_api.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	size_t label_count;
	int32_t *labels; /* of --label; none: all */
	uint32_t levels; /* 0: the default */
} choice;

static esk_outcome read_levels(const char *text, uint32_t *levels)
{
	int32_t number = 0;
	if (text && (!esk_label_parse(text, &number) || number < 1 || number > ESKEL_LEVELS_MAX))
		return esk_complain(ESK_MISUSED, "--levels is %s, expected 1 to %d", text, ESKEL_LEVELS_MAX);
	*levels = (uint32_t)number;
	return ESK_DONE;
}

static esk_outcome read_choice(const esk_arguments *arguments, choice *wanted)
{
	size_t position = 0;
	const char *text;
	wanted->labels = calloc(arguments->given_count + 1, sizeof *wanted->labels);
	if (!wanted->labels)
		return esk_complain(ESK_REFUSED, "memory ran out");
	while ((text = esk_arguments_next(arguments, "label", &position))) {
		if (!esk_label_parse(text, &wanted->labels[wanted->label_count++]))
			return esk_complain(ESK_MISUSED, "--label is %s, expected a whole number other than 0", text);
	}
	return read_levels(esk_arguments_value(arguments, "levels"), &wanted->levels);
}

static bool show_level(void *context, uint32_t level, uint32_t levels)
{
	esk_progress_computed(context, level, levels);
	return true;
}

/* The skeleton of one label as JSON, taken in by the session. */
static esk_outcome add_skeleton(esk_session *session, const eskel_volume *volume, int32_t label, uint32_t levels)
{
	char *source = NULL, *json = NULL;
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_error error = {0};
	const eskel_skeleton_options options = {
		.levels = levels, .progress = show_level, .context = &session->progress};
	esk_outcome outcome = ESK_DONE;
	if (asprintf(&source, "%s:%d", session->arguments->operands[0], (int)label) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	esk_progress_next(&session->progress, source);
	eskel_status status = eskel_volume_cloud(volume, label, &cloud, &error);
	if (!status)
		status = eskel_skeleton_new(cloud, &options, &skeleton, &error);
	esk_progress_done(&session->progress);
	if (status)
		outcome = esk_complain(ESK_REFUSED, "%s: %s", source, error.text);
	else if (!(json = eskel_skeleton_text(skeleton)))
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
	else
		outcome = esk_session_take(session, source, json, strlen(json));
	free(json);
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
	free(source);
	return outcome;
}

esk_outcome esk_command_skeleton(esk_session *session)
{
	choice wanted = {0};
	eskel_volume *volume = NULL;
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SKELETON);
	if (!outcome)
		outcome = read_choice(session->arguments, &wanted);
	if (!outcome)
		outcome = esk_volume_file_read(
			session->arguments->operands[0], wanted.labels, wanted.label_count, &volume);
	session->progress.items = volume ? eskel_volume_label_count(volume) : 0;
	for (size_t i = 0; i < session->progress.items && !outcome; i++)
		outcome = add_skeleton(session, volume, eskel_volume_label(volume, i), wanted.levels);
	eskel_volume_free(volume);
	free(wanted.labels);
	return outcome;
}
