/* eskel skeleton: decodes a volume and computes the skeletons of its objects here, without a server. */
#include "command.h"
#include "label_csv.h"
#include "volume_file.h"

#include "eskel_api.h"

#include <stdlib.h>
#include <string.h>

/* 0 for the default when --levels was not given. */
static esk_outcome read_levels(const esk_arguments *arguments, uint32_t *levels)
{
	const char *text = esk_arguments_value(arguments, "levels");
	int32_t number = 0;
	if (text && (!esk_label_parse(text, &number) || number < 1 || number > ESKEL_LEVELS_MAX))
		return esk_complain(ESK_MISUSED, "--levels is %s, expected 1 to %d", text, ESKEL_LEVELS_MAX);
	*levels = (uint32_t)number;
	return ESK_DONE;
}

static bool show_level(void *context, uint32_t level, uint32_t levels)
{
	esk_progress_computed(context, level, levels);
	return true;
}

/* The skeleton of one label as JSON; free() it. */
static esk_outcome compute(esk_session *session, const char *source, const eskel_volume *volume, int32_t label,
	uint32_t levels, char **json)
{
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_error error = {0};
	const eskel_skeleton_options options = {
		.levels = levels, .progress = show_level, .context = &session->progress};
	esk_progress_next(&session->progress, source);
	eskel_status status = eskel_volume_cloud(volume, label, &cloud, &error);
	if (!status)
		status = eskel_skeleton_new(cloud, &options, &skeleton, &error);
	esk_progress_end(&session->progress, !status);
	char *text = skeleton ? eskel_skeleton_text(skeleton) : NULL;
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
	if (status)
		return esk_complain(ESK_REFUSED, "%s: %s", source, error.text);
	if (!text)
		return esk_complain(ESK_REFUSED, "memory ran out");
	*json = text;
	return ESK_DONE;
}

static esk_outcome add_skeleton(esk_session *session, const eskel_volume *volume, int32_t label, uint32_t levels)
{
	char *source = NULL, *json = NULL;
	if (asprintf(&source, "%s:%d", session->arguments->operands[0], (int)label) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	esk_outcome outcome = compute(session, source, volume, label, levels, &json);
	if (!outcome)
		outcome = esk_session_take(session, source, json, strlen(json));
	free(json);
	free(source);
	return outcome;
}

esk_outcome esk_command_skeleton(esk_session *session)
{
	uint32_t levels = 0;
	eskel_volume *volume = NULL;
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SKELETON);
	if (!outcome)
		outcome = read_levels(session->arguments, &levels);
	if (!outcome)
		outcome = esk_volume_file_read(session->arguments->operands[0], session->arguments, &volume);
	if (outcome)
		return outcome;
	session->progress.items = eskel_volume_label_count(volume);
	for (size_t i = 0; i < session->progress.items && !outcome; i++)
		outcome = add_skeleton(session, volume, eskel_volume_label(volume, i), levels);
	eskel_volume_free(volume);
	return outcome;
}
