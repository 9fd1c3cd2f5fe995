/* {"method": "GET", "path": "/distances", "role": 1, "query": [["class", "femur"], ...], "accept": "text/csv"}, see
 * job_request.h. */
#include "job_request.h"

#include <stdlib.h>
#include <string.h>

char *esk_job_request_text(const eskel_exchange *exchange, const char *method, const char *path)
{
	json_t *query = json_array();
	for (size_t i = 0; i < exchange->query_count; i++) {
		const eskel_field *field = &exchange->query_fields[i];
		if (json_array_append_new(query, json_pack("[s, s]", field->name, field->value)) != 0) {
			json_decref(query);
			return NULL;
		}
	}
	return esk_json_text(json_pack("{s:s, s:s, s:i, s:o, s:s?}", "method", method, "path", path, "role",
		(int)exchange->route->role, "query", query, "accept", esk_exchange_request_header(exchange, "Accept")));
}

void esk_job_request_path(const char *text, char path[ESK_JOB_PATH_SIZE])
{
	const char *found = "";
	json_t *request = json_loads(text, 0, NULL);
	json_unpack(request, "{s:s}", "path", &found);
	snprintf(path, ESK_JOB_PATH_SIZE, "%s", found);
	json_decref(request);
}

/* The fields borrow from the query. */
static bool read_query(const json_t *query, eskel_field *fields)
{
	size_t i;
	json_t *pair;
	json_array_foreach (query, i, pair)
		if (json_unpack(pair, "[s, s]", &fields[i].name, &fields[i].value) != 0)
			return false;
	return true;
}

eskel_exchange *esk_job_request_begin(eskel_api *api, const char *text)
{
	eskel_exchange *exchange = NULL;
	const char *method, *path;
	int role;
	json_t *query, *accept, *request = json_loads(text, 0, NULL);
	if (json_unpack(request, "{s:s, s:s, s:i, s:o, s:o}", "method", &method, "path", &path, "role", &role, "query",
		    &query, "accept", &accept) == 0) {
		const eskel_field header = {"Accept", json_string_value(accept)};
		const size_t count = json_array_size(query);
		eskel_field *fields = calloc(count + 1, sizeof *fields);
		const eskel_request head = {
			.method = method,
			.path = path,
			.query = fields,
			.query_count = count,
			.headers = &header,
			.header_count = header.value != NULL,
			.role = (eskel_role)role,
		};
		if (fields && read_query(query, fields))
			exchange = eskel_api_begin(api, &head);
		free(fields);
	}
	json_decref(request);
	return exchange;
}
