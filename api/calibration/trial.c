/* One leave-one-out recognition, see trial.h. */
#include "trial.h"

#include "recognition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool keys_of(eskel_api *api, const eskel_filter *filter, esk_choice *choice, esk_problem *problem)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_store_keys(api->store, filter, &choice->keys, &choice->block_count, &error);
	return esk_problem_store(problem, status, &error);
}

/* Whom the shape may meet: fellows are those of its class, others all that are left in. A shape whose class only its own
 * subject has meets everybody but itself. */
static bool choose(eskel_api *api, const eskel_description *said, esk_choice *fellows, esk_choice *others, bool *twin,
	esk_problem *problem)
{
	eskel_filter filter = eskel_filter_none();
	filter.class = said->class;
	filter.not_subject = said->subject;
	if (!keys_of(api, &filter, fellows, problem))
		return false;
	*twin = said->subject && fellows->block_count == 0;
	if (*twin) {
		filter.not_subject = NULL;
		esk_choice_clear(fellows);
		if (!keys_of(api, &filter, fellows, problem))
			return false;
	}
	filter.class = NULL;
	return !filter.not_subject || keys_of(api, &filter, others, problem);
}

static bool note_told(const esk_recognition *met, esk_trial *trial, esk_problem *problem)
{
	esk_recognition_evidence(met, &trial->evidence);
	for (size_t i = 0; i < met->count; i++) {
		trial->voters[i] = met->neighbours[i].known->shape.key;
		trial->farthest = met->neighbours[i].found->distance;
	}
	trial->voter_count = met->count;
	if (!trial->evidence.class)
		return true;
	trial->told = strdup(trial->evidence.class);
	trial->evidence.class = trial->told;
	return trial->told || esk_problem_no_memory(problem);
}

static bool find_fellow(eskel_api *api, const eskel_signature *signature, const eskel_distance_options *distance,
	const esk_choice *fellows, esk_trial *trial, esk_problem *problem)
{
	const eskel_search_options options = {
		.distance = *distance,
		.limit = 1,
		.keys = fellows->keys,
		.key_block_count = fellows->block_count,
		.leave_out = true,
		.left_out_key = trial->key,
	};
	eskel_search_result *found = NULL;
	if (!esk_problem_engine(problem, eskel_library_search(api->library, signature, &options, &found), NULL))
		return false;
	if (found->count > 0) {
		trial->fellow = found->neighbours[0].distance;
		trial->fellow_key = found->neighbours[0].key;
	}
	eskel_search_result_free(found);
	return true;
}

static bool hold(eskel_api *api, const eskel_distance_options *distance, const esk_known_shape *known, esk_trial *trial,
	esk_problem *problem)
{
	const esk_unknown unknown = {&known->shape, known->placement, known->signature, NULL};
	eskel_search_options options = {.distance = *distance, .limit = ESK_VOTERS};
	const eskel_description *said = &known->shape.description;
	esk_choice fellows = {0}, others = {0};
	esk_recognition met = {0};
	if (!said->class)
		return true;
	trial->class = strdup(said->class);
	trial->side = said->side;
	bool good = trial->class || esk_problem_no_memory(problem);
	good = good && choose(api, said, &fellows, &others, &trial->twin, problem) &&
	       find_fellow(api, known->signature, distance, &fellows, trial, problem) &&
	       esk_recognition_find(api, &unknown, &others, 0, &options, &met, problem) &&
	       note_told(&met, trial, problem);
	esk_recognition_clear(api, &met);
	esk_choice_clear(&fellows);
	esk_choice_clear(&others);
	return good;
}

bool esk_trial_hold(
	eskel_api *api, const eskel_distance_options *distance, int64_t key, esk_trial *trial, esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	eskel_store_error error = {0};
	esk_trial held = {.key = key, .fellow = NAN};
	eskel_store_status status = esk_known_by_key(api->known, key, &known, &error);
	bool good = status == ESKEL_STORE_NOT_FOUND || esk_problem_store(problem, status, &error);
	if (status == ESKEL_STORE_OK)
		good = hold(api, distance, known, &held, problem);
	esk_known_release(api->known, known);
	if (good)
		*trial = held;
	else
		esk_trial_clear(&held);
	return good;
}

void esk_trial_clear(esk_trial *trial)
{
	free(trial->class);
	free(trial->told);
	*trial = (esk_trial){0};
}

bool esk_trial_is_right(const esk_trial *trial)
{
	return trial->class && trial->told && strcmp(trial->class, trial->told) == 0;
}
