/* Trials of a sample of the library, kept up to date; see calibration.h. */
#include "calibration.h"

#include "fit.h"
#include "sample.h"
#include "trial.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Enough for a standard error of 2 % in a share of a tenth; a trial takes some 2 ms among 100,000 shapes. */
#define MOST_TRIALS 256
/* Beyond so many changes since the last look all trials are held again. */
#define MOST_CHANGES 256
/* Ways of measuring distances whose trials are kept. */
#define MOST_COURSES 4

/* The trials of one way of measuring. */
typedef struct {
	eskel_distance_options distance;
	bool made;
	uint64_t used;    /* when last */
	uint64_t changes; /* of the library that it has followed */
	size_t count;
	esk_trial *trials; /* ascending keys */
	esk_fit fit;
} course;

struct esk_calibration {
	eskel_api *api;
	pthread_mutex_t lock; /* of the courses */
	uint64_t uses;
	course courses[MOST_COURSES];
	pthread_mutex_t change_lock;
	uint64_t changes;              /* so far */
	int64_t changed[MOST_CHANGES]; /* the last of them, in a ring */
};

/* ---- changes of the library */

void esk_calibration_note(esk_calibration *calibration, int64_t key)
{
	pthread_mutex_lock(&calibration->change_lock);
	calibration->changed[calibration->changes++ % MOST_CHANGES] = key;
	pthread_mutex_unlock(&calibration->change_lock);
}

/* The keys that changed since so many changes; false when they are no longer known. */
static bool changes_since(
	esk_calibration *calibration, uint64_t since, uint64_t *now, int64_t keys[MOST_CHANGES], size_t *count)
{
	pthread_mutex_lock(&calibration->change_lock);
	*now = calibration->changes;
	bool known = *now - since <= MOST_CHANGES;
	*count = 0;
	for (uint64_t n = since; known && n < *now; n++)
		keys[(*count)++] = calibration->changed[n % MOST_CHANGES];
	pthread_mutex_unlock(&calibration->change_lock);
	return known;
}

/* ---- one course */

static void clear_trials(esk_trial *trials, size_t count)
{
	for (size_t i = 0; trials && i < count; i++)
		esk_trial_clear(&trials[i]);
	free(trials);
}

static void clear_course(course *c)
{
	clear_trials(c->trials, c->count);
	esk_fit_clear(&c->fit);
	*c = (course){0};
}

static bool mentions(const esk_trial *trial, int64_t key)
{
	bool found = trial->key == key || (!isnan(trial->fellow) && trial->fellow_key == key);
	for (size_t i = 0; i < trial->voter_count; i++)
		found = found || trial->voters[i] == key;
	return found;
}

/* A shape that has come, or is now said to be something else, matters to a trial whose class it has, and where it is
 * nearer than the last voter. */
static bool could_join(const esk_trial *trial, const eskel_description *said, double distance)
{
	if (!trial->class)
		return false;
	return trial->voter_count < ESK_VOTERS || distance <= trial->farthest ||
	       (said->class && strcmp(said->class, trial->class) == 0);
}

static void spoil_all(course *c)
{
	for (size_t i = 0; i < c->count; i++)
		c->trials[i].stale = true;
}

/* Marks the trials that a changed shape could have changed. */
static bool spoil(esk_calibration *calibration, course *c, int64_t key, esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	int64_t rows[MOST_TRIALS];
	double distances[MOST_TRIALS];
	for (size_t i = 0; i < c->count; i++) {
		c->trials[i].stale = c->trials[i].stale || mentions(&c->trials[i], key);
		rows[i] = c->trials[i].key;
	}
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(calibration->api->known, key, &known, &error);
	if (status == ESKEL_STORE_NOT_FOUND)
		return true;
	if (!esk_problem_store(problem, status, &error))
		return false;
	eskel_status measured =
		eskel_library_distances(calibration->api->library, rows, c->count, &key, 1, &c->distance, distances);
	for (size_t i = 0; measured == ESKEL_OK && i < c->count; i++)
		c->trials[i].stale =
			c->trials[i].stale || could_join(&c->trials[i], &known->shape.description, distances[i]);
	esk_known_release(calibration->api->known, known);
	if (measured == ESKEL_NOT_FOUND) /* one of them is about to go, which will be noted */
		spoil_all(c);
	return measured == ESKEL_NOT_FOUND || esk_problem_engine(problem, measured, NULL);
}

static esk_trial *find_trial(course *c, int64_t key)
{
	for (size_t low = 0, high = c->count; low < high;) {
		size_t middle = low + (high - low) / 2;
		if (c->trials[middle].key == key)
			return &c->trials[middle];
		if (c->trials[middle].key < key)
			low = middle + 1;
		else
			high = middle;
	}
	return NULL;
}

/* Moves what is still good into trials[], holds the rest. */
static bool hold_trials(esk_calibration *calibration, course *c, const int64_t *keys, size_t count, esk_trial *trials,
	esk_problem *problem)
{
	for (size_t i = 0; i < count; i++) {
		esk_trial *old = find_trial(c, keys[i]);
		if (old && !old->stale) {
			trials[i] = *old;
			*old = (esk_trial){.key = keys[i], .stale = true};
		} else if (!esk_trial_hold(calibration->api, &c->distance, keys[i], &trials[i], problem)) {
			return false;
		}
	}
	return true;
}

static bool renew(esk_calibration *calibration, course *c, esk_problem *problem)
{
	const eskel_filter all = eskel_filter_none();
	eskel_store_error error = {0};
	eskel_key_block *stored = NULL;
	size_t block_count = 0;
	eskel_store_status status = eskel_store_keys(calibration->api->store, &all, &stored, &block_count, &error);
	if (!esk_problem_store(problem, status, &error))
		return false;
	int64_t keys[MOST_TRIALS];
	const size_t count = esk_sample_choose(stored, block_count, MOST_TRIALS, keys);
	free(stored);
	esk_trial *trials = calloc(count + 1, sizeof *trials);
	bool good = trials ? hold_trials(calibration, c, keys, count, trials, problem) : esk_problem_no_memory(problem);
	if (!good) {
		clear_trials(trials, count);
		return false;
	}
	clear_trials(c->trials, c->count);
	c->trials = trials;
	c->count = count;
	esk_fit_clear(&c->fit);
	return esk_fit_make(c->trials, c->count, ESK_NO_FOLD, &c->fit) || esk_problem_no_memory(problem);
}

/* After a failure nothing of the course is good any more. */
static bool follow(esk_calibration *calibration, course *c, esk_problem *problem)
{
	int64_t keys[MOST_CHANGES];
	size_t count;
	uint64_t now;
	bool known = changes_since(calibration, c->changes, &now, keys, &count), good = true;
	if (c->made && now == c->changes)
		return true;
	if (!known)
		spoil_all(c);
	for (size_t i = 0; c->made && good && i < count; i++)
		good = spoil(calibration, c, keys[i], problem);
	good = good && renew(calibration, c, problem);
	c->made = good;
	c->changes = now;
	if (!good)
		spoil_all(c);
	return good;
}

static bool same_distance(const eskel_distance_options *a, const eskel_distance_options *b)
{
	return a->signature == b->signature && a->distance == b->distance && a->level == b->level &&
	       a->metric == b->metric && a->size == b->size;
}

/* The course of a way of measuring, in the place of the one least recently used if it is new. */
static course *course_of(esk_calibration *calibration, const eskel_distance_options *distance)
{
	course *oldest = &calibration->courses[0], *found = NULL;
	for (size_t i = 0; i < MOST_COURSES && !found; i++) {
		course *c = &calibration->courses[i];
		if (c->used && same_distance(&c->distance, distance))
			found = c;
		else if (c->used < oldest->used)
			oldest = c;
	}
	if (!found) {
		clear_course(oldest);
		oldest->distance = *distance;
		found = oldest;
	}
	found->used = ++calibration->uses;
	return found;
}

bool esk_calibration_score(esk_calibration *calibration, const eskel_distance_options *distance,
	const esk_evidence *evidence, esk_scores *scores, esk_problem *problem)
{
	pthread_mutex_lock(&calibration->lock);
	course *c = course_of(calibration, distance);
	bool good = follow(calibration, c, problem);
	if (good)
		esk_fit_scores(&c->fit, evidence, scores);
	pthread_mutex_unlock(&calibration->lock);
	return good;
}

bool esk_calibration_z(esk_calibration *calibration, const eskel_distance_options *distance, const char *class,
	double value, double *z, esk_problem *problem)
{
	pthread_mutex_lock(&calibration->lock);
	course *c = course_of(calibration, distance);
	bool good = follow(calibration, c, problem);
	if (good)
		*z = esk_fit_z(&c->fit, class, value);
	pthread_mutex_unlock(&calibration->lock);
	return good;
}

/* ---- the report */

static void count_score(double score, bool right, esk_reliability *reliability)
{
	int bin = (int)(score * ESK_BINS);
	esk_bin *b = &reliability->bins[bin < ESK_BINS ? bin : ESK_BINS - 1];
	b->count++;
	b->right += right;
	b->scores += score;
	reliability->count++;
	reliability->right += right;
	reliability->brier += (score - right) * (score - right);
}

static void count_trial(const esk_fit *fit, const esk_trial *trial, esk_calibration_report *report)
{
	esk_scores scores;
	esk_fit_scores(fit, &trial->evidence, &scores);
	if (esk_fit_learns_class(trial))
		count_score(scores.class_score, esk_trial_is_right(trial), &report->class);
	if (!esk_fit_learns_side(trial))
		return;
	const bool right = esk_fit_side_is_right(trial), decided = scores.side_score >= ESK_LEAST_SIDE_SCORE;
	count_score(scores.side_score, right, &report->side);
	report->sides_decided += decided;
	report->decided_right += decided && right;
}

static bool report_course(const course *c, esk_calibration_report *report)
{
	*report = (esk_calibration_report){
		.trials = c->count, .fellows = c->fit.fellows, .mean = c->fit.mean, .deviation = c->fit.deviation};
	memcpy(report->class_weights, c->fit.class_weights, sizeof report->class_weights);
	report->side_weight = c->fit.side_weights[0];
	for (int fold = 0; fold < ESK_FOLDS; fold++) {
		esk_fit fit;
		if (!esk_fit_make(c->trials, c->count, fold, &fit))
			return false;
		for (size_t i = (size_t)fold; i < c->count; i += ESK_FOLDS)
			count_trial(&fit, &c->trials[i], report);
		esk_fit_clear(&fit);
	}
	report->class.brier /= fmax((double)report->class.count, 1);
	report->side.brier /= fmax((double)report->side.count, 1);
	return true;
}

bool esk_calibration_get_report(esk_calibration *calibration, const eskel_distance_options *distance,
	esk_calibration_report *report, esk_problem *problem)
{
	pthread_mutex_lock(&calibration->lock);
	course *c = course_of(calibration, distance);
	bool good = follow(calibration, c, problem) && (report_course(c, report) || esk_problem_no_memory(problem));
	pthread_mutex_unlock(&calibration->lock);
	return good;
}

/* ---- life */

esk_calibration *esk_calibration_new(eskel_api *api)
{
	esk_calibration *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	made->api = api;
	pthread_mutex_init(&made->lock, NULL);
	pthread_mutex_init(&made->change_lock, NULL);
	return made;
}

void esk_calibration_free(esk_calibration *calibration)
{
	if (!calibration)
		return;
	for (size_t i = 0; i < MOST_COURSES; i++)
		clear_course(&calibration->courses[i]);
	pthread_mutex_destroy(&calibration->lock);
	pthread_mutex_destroy(&calibration->change_lock);
	free(calibration);
}
