/* GET /shapes/{id}/signature: the rows of one level, by default the deepest, or as CSV of all. */
#include "exchange.h"
#include "resources.h"

#include <stdlib.h>

static json_t *signature_json(const eskel_signature *signature, uint32_t level)
{
	json_t *rows = json_array();
	for (size_t i = 0; i < level; i++) {
		const double *row = signature->rows[ESKEL_NODES(level - 1) + i];
		if (json_array_append_new(rows, esk_json_reals(row, ESKEL_SIGNATURE_NUMBERS)) != 0) {
			json_decref(rows);
			return NULL;
		}
	}
	return json_pack("{s:i, s:o}", "level", (int)level, "rows", rows);
}

/* 9 digits tell a 32-bit float from its neighbours. */
static void append_csv_level(esk_text *text, const char *id, const eskel_signature *signature, uint32_t level)
{
	for (uint32_t class = 0; class < level; class ++) {
		const double *row = signature->rows[ESKEL_NODES(level - 1) + class];
		esk_text_print(text, "%s,%u,%u", id, level, class);
		for (size_t n = 0; n < ESKEL_SIGNATURE_NUMBERS; n++)
			esk_text_print(text, ",%.9g", row[n]);
		esk_text_print(text, "\r\n");
	}
}

static bool answer_csv(eskel_exchange *exchange, const eskel_signature *signature, uint32_t first, uint32_t last)
{
	esk_text text = {0};
	esk_text_print(&text, "id,level,class,sqrt_lambda_1_mm,sqrt_lambda_2_mm,sqrt_lambda_3_mm,rho_mm,solidity\r\n");
	for (uint32_t level = first; level <= last; level++)
		append_csv_level(&text, exchange->id, signature, level);
	if (!text.failed)
		return esk_exchange_answer(exchange, 200, "text/csv; charset=utf-8", text.bytes, text.size);
	free(text.bytes);
	return esk_problem_no_memory(&exchange->problem);
}

static bool answer_level(eskel_exchange *exchange, const eskel_signature *signature)
{
	uint32_t level = exchange->query.level ? exchange->query.level : signature->level_count;
	if (level > signature->level_count)
		return esk_problem_set(&exchange->problem, 400, "level is %u, expected 1 to %u: shape %s has no more",
			level, signature->level_count, exchange->id);
	if (exchange->query.format == ESK_FORMAT_CSV)
		return answer_csv(exchange, signature, exchange->query.level ? level : 1, level);
	return esk_exchange_answer_json(exchange, 200, signature_json(signature, level));
}

bool esk_signature_get(eskel_exchange *exchange)
{
	eskel_shape shape = {0};
	eskel_signature *signature = NULL;
	eskel_store_error error = {0};
	if (!esk_shape_of_id(exchange, exchange->id, &shape))
		return false;
	eskel_store_status status = eskel_store_signature(exchange->api->store, shape.key, &signature, &error);
	bool good = esk_problem_store(&exchange->problem, status, &error) && answer_level(exchange, signature);
	eskel_signature_free(signature);
	eskel_shape_clear(&shape);
	return good;
}
