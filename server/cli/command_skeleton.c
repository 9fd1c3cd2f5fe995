/* eskel skeleton: decodes a volume and computes the skeletons of its objects here, without a server, some objects at a
 * time on all processors: answers come as it goes on, and memory does not grow with the number of objects. */
#include "command.h"
#include "label_names.h"
#include "volume_file.h"

#include "eskel_api.h"

#include <stdlib.h>
#include <string.h>

/* Enough that processors are busy until the last few objects; at 64 levels a skeleton takes half a megabyte. */
enum { TOGETHER = 64 };

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

/* Labels first .. first + count - 1 of the volume. */
typedef struct {
	const eskel_volume *volume;
	size_t first, count;
	eskel_cloud *clouds[TOGETHER];
	eskel_skeleton *skeletons[TOGETHER];
} batch;

static void clear(batch *b)
{
	for (size_t i = 0; i < b->count; i++) {
		eskel_cloud_free(b->clouds[i]);
		eskel_skeleton_free(b->skeletons[i]);
	}
}

/* What people call a label; free() it. NULL, with a complaint, when memory ran out. */
static char *name_label(const esk_session *session, int32_t label)
{
	char *name = NULL;
	if (asprintf(&name, "%s:%d", session->arguments->operands[0], (int)label) >= 0)
		return name;
	esk_complain(ESK_REFUSED, "memory ran out");
	return NULL;
}

static esk_outcome compute(esk_session *session, batch *b, uint32_t levels, const char *name)
{
	eskel_error error = {0};
	const eskel_skeleton_options options = {.levels = levels,
		.threads = ESKEL_THREADS_ONLINE,
		.progress = show_level,
		.context = &session->progress};
	esk_progress_next(&session->progress, name);
	eskel_status status = ESKEL_OK;
	for (size_t i = 0; i < b->count && !status; i++)
		status = eskel_volume_cloud(
			b->volume, eskel_volume_label(b->volume, b->first + i), &b->clouds[i], &error);
	if (!status)
		status = eskel_skeletons_new(
			(const eskel_cloud *const *)b->clouds, b->count, &options, b->skeletons, &error);
	esk_progress_end(&session->progress, !status);
	return status ? esk_complain(ESK_REFUSED, "%s: %s", name, error.text) : ESK_DONE;
}

static esk_outcome show(esk_session *session, const eskel_skeleton *skeleton, const char *name)
{
	char *json = eskel_skeleton_text(skeleton);
	if (!json)
		return esk_complain(ESK_REFUSED, "memory ran out");
	const esk_outcome outcome = esk_session_take(session, name, json, strlen(json));
	free(json);
	return outcome;
}

static esk_outcome add_skeletons(
	esk_session *session, const eskel_volume *volume, size_t first, size_t count, uint32_t levels)
{
	batch b = {.volume = volume, .first = first, .count = count};
	char *name = name_label(session, eskel_volume_label(volume, first));
	esk_outcome outcome = ESK_REFUSED;
	if (name)
		outcome = compute(session, &b, levels, count > 1 ? session->arguments->operands[0] : name);
	for (size_t i = 0; i < count && !outcome; i++) {
		free(name);
		name = name_label(session, eskel_volume_label(volume, first + i));
		outcome = name ? show(session, b.skeletons[i], name) : ESK_REFUSED;
	}
	free(name);
	clear(&b);
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
	const size_t count = eskel_volume_label_count(volume);
	session->progress.items = (count + TOGETHER - 1) / TOGETHER;
	for (size_t first = 0; first < count && !outcome; first += TOGETHER)
		outcome = add_skeletons(
			session, volume, first, count - first < TOGETHER ? count - first : TOGETHER, levels);
	eskel_volume_free(volume);
	return outcome;
}
