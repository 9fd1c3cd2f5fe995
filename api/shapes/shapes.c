/* GET /shapes: the shapes that a filter leaves, page by page in the order of their keys. */
#include "exchange.h"
#include "resources.h"
#include "shape_json.h"

#include <stdlib.h>
#include <string.h>

#define LIMIT_DEFAULT 50
#define LIMIT_MOST 1000

bool esk_shapes_check(eskel_exchange *exchange)
{
	if (exchange->query.limit <= LIMIT_MOST)
		return true;
	return esk_problem_set(
		&exchange->problem, 400, "limit is %u, expected 1 to %d", exchange->query.limit, LIMIT_MOST);
}

/* The same request with another cursor (RFC 8288). Every byte that is not plain is escaped, so that nothing sent can end
 * the URL. */
static bool add_link(eskel_exchange *exchange, const char *cursor)
{
	esk_text url = {0};
	esk_text_print(&url, "</shapes?");
	for (size_t i = 0; i < exchange->query_count; i++) {
		const eskel_field *field = &exchange->query_fields[i];
		if (strcmp(field->name, "cursor") == 0)
			continue;
		esk_text_append_escaped(&url, field->name);
		esk_text_print(&url, "=");
		esk_text_append_escaped(&url, field->value);
		esk_text_print(&url, "&");
	}
	esk_text_print(&url, "cursor=%s>; rel=\"next\"", cursor);
	bool good = url.failed ? esk_problem_no_memory(&exchange->problem)
			       : esk_exchange_add_header(exchange, "Link", "%s", url.bytes);
	free(url.bytes);
	return good;
}

bool esk_shapes_list(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	const eskel_filter filter = esk_parameters_filter(query);
	eskel_store_error error = {0};
	eskel_shape *shapes = NULL;
	size_t count = 0;
	bool more = false;
	eskel_store_status status = eskel_store_list(exchange->api->store, &filter, query->cursor,
		query->limit ? query->limit : LIMIT_DEFAULT, &shapes, &count, &more, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	char cursor[ESK_CURSOR_SIZE];
	if (more)
		esk_parameters_cursor_text(shapes[count - 1].key, cursor);
	bool good = (!more || add_link(exchange, cursor)) &&
		    esk_exchange_answer_json(exchange, 200,
			    json_pack("{s:o, s:s?}", "shapes", esk_shapes_json(shapes, count), "next",
				    more ? cursor : NULL));
	eskel_shapes_free(shapes, count);
	return good;
}
