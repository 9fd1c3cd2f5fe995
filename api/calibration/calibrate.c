/* GET /calibration: what the scores of verdicts rest on, and how reliable they are. */
#include "calibration.h"
#include "exchange.h"
#include "resources.h"

#include <math.h>

bool esk_calibrate_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level beside it", query->level);
	return true;
}

static json_t *share(size_t part, size_t count)
{
	return esk_json_real(count ? (double)part / (double)count : NAN);
}

static json_t *bins_json(const esk_reliability *reliability)
{
	json_t *array = json_array();
	for (size_t i = 0; i < ESK_BINS; i++) {
		const esk_bin *bin = &reliability->bins[i];
		json_t *row = json_pack("{s:f, s:f, s:I, s:o, s:o}", "from", (double)i / ESK_BINS, "to",
			(double)(i + 1) / ESK_BINS, "count", (json_int_t)bin->count, "mean_score",
			esk_json_real(bin->count ? bin->scores / (double)bin->count : NAN), "right",
			share(bin->right, bin->count));
		if (json_array_append_new(array, row) != 0) {
			json_decref(array);
			return NULL;
		}
	}
	return array;
}

static json_t *class_json(const esk_calibration_report *report)
{
	const esk_reliability *class = &report->class;
	return json_pack("{s:I, s:o, s:o, s:o, s:o}", "count", (json_int_t) class->count, "right",
		share(class->right, class->count), "brier", esk_json_real(class->count ? class->brier : NAN), "weights",
		esk_json_reals(report->class_weights, 3), "reliability", bins_json(class));
}

static json_t *side_json(const esk_calibration_report *report)
{
	const esk_reliability *side = &report->side;
	return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "count", (json_int_t)side->count, "right",
		share(side->right, side->count), "decided", share(report->sides_decided, side->count), "decided_right",
		share(report->decided_right, report->sides_decided), "brier",
		esk_json_real(side->count ? side->brier : NAN), "weight", esk_json_real(report->side_weight),
		"reliability", bins_json(side));
}

bool esk_calibrate_get(eskel_exchange *exchange)
{
	const eskel_distance_options distance = esk_parameters_distance(&exchange->query);
	esk_calibration_report report;
	if (!esk_calibration_get_report(exchange->api->calibration, &distance, &report, &exchange->problem))
		return false;
	return esk_exchange_answer_json(exchange, 200,
		json_pack("{s:I, s:o, s:o, s:{s:I, s:o, s:o}}", "trials", (json_int_t)report.trials, "class",
			class_json(&report), "side", side_json(&report), "log_distance", "fellows",
			(json_int_t)report.fellows, "mean", esk_json_real(report.fellows ? report.mean : NAN),
			"deviation", esk_json_real(report.deviation)));
}
