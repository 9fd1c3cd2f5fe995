#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "route.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ID "0123456789abcdef0123456789abcdef"

static void every_path_answers_options_with_its_methods(void **state)
{
	api_fixture *f = *state;
	static const struct {
		const char *path, *allow;
	} cases[] = {
		{"/shapes", "GET, HEAD, POST, OPTIONS"},
		{"/shapes/" ID, "GET, HEAD, PATCH, DELETE, OPTIONS"},
		{"/shapes/" ID "/skeleton", "GET, HEAD, OPTIONS"},
		{"/shapes/" ID "/signature", "GET, HEAD, OPTIONS"},
		{"/recognize", "GET, HEAD, POST, OPTIONS"},
		{"/check", "POST, OPTIONS"},
		{"/distances", "GET, HEAD, POST, OPTIONS"},
		{"/shapes/" ID "/ellipsoids", "GET, HEAD, OPTIONS"},
		{"/shapes/" ID "/levels-of-detail", "GET, HEAD, OPTIONS"},
		{"/shapes/" ID "/mesh", "GET, HEAD, OPTIONS"},
		{"/shapes/" ID "/reconstruction", "GET, HEAD, POST, OPTIONS"},
		{"/jobs", "GET, HEAD, OPTIONS"},
		{"/jobs/" ID, "GET, HEAD, DELETE, OPTIONS"},
		{"/jobs/" ID "/events", "GET, HEAD, OPTIONS"},
		{"/jobs/" ID "/result", "GET, HEAD, OPTIONS"},
		{"/evaluation", "GET, HEAD, OPTIONS"},
		{"/healthz", "GET, HEAD, OPTIONS"},
		{"/readyz", "GET, HEAD, OPTIONS"},
		{"/openapi.json", "GET, HEAD, OPTIONS"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = ask(f->api, &(question){.method = "OPTIONS", .target = cases[i].path, .nobody = true});
		assert_status(&a, 204);
		assert_string_equal(a.allow, cases[i].allow);
		answer_free(&a);
		answer wrong = ask(f->api, &(question){.method = "PUT", .target = cases[i].path, .nobody = true});
		assert_says(&wrong, 405, "PUT is not allowed on ");
		assert_string_equal(wrong.allow, cases[i].allow);
		answer_free(&wrong);
	}
}

static void a_path_that_is_unknown_is_404(void **state)
{
	api_fixture *f = *state;
	static const char *const paths[] = {"", "/", "/shape", "/shapes/", "/shapes//skeleton", "/shapes/" ID "/",
		"/shapes/" ID "/skeleton/x", "/healthz/", "//shapes", "/SHAPES", "/shapes/" ID "/cloud"};
	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
		answer a = get(f->api, "%s", paths[i]);
		assert_says(&a, 404, "there is nothing at");
		assert_string_equal(a.route, "");
		assert_string_equal(a.type, "application/problem+json");
		answer_free(&a);
	}
}

static void an_id_is_strict(void **state)
{
	api_fixture *f = *state;
	static const char *const ids[] = {
		"1", "0123456789ABCDEF0123456789abcdef", ID "0", "%2e%2e", "a b", "%F0%9F%A6%B4"};
	for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
		answer a = get(f->api, "/shapes/%s", ids[i]);
		assert_says(&a, 404, "is no id, expected 32 lower-case hexadecimal digits");
		assert_string_equal(a.route, "/shapes/{id}");
		answer_free(&a);
	}
	answer missing = get(f->api, "/shapes/" ID);
	assert_says(&missing, 404, "there is no shape " ID);
	answer_free(&missing);
}

/* The least role of each route, as everybody below it is refused. */
static void roles_open_what_they_name(void **state)
{
	api_fixture *f = *state;
	size_t count;
	const esk_route *routes = esk_route_table(&count);
	for (size_t i = 0; i < count; i++) {
		bool changes = strcmp(routes[i].method, "GET") != 0 && strncmp(routes[i].path, "/shapes", 7) == 0;
		bool open = strcmp(routes[i].path, "/healthz") == 0 || strcmp(routes[i].path, "/readyz") == 0 ||
			    strcmp(routes[i].path, "/openapi.json") == 0;
		assert_int_equal(routes[i].role, open ? 0 : changes ? ESKEL_ROLE_WRITE : ESKEL_ROLE_READ);
		char target[100];
		const char *brace = strstr(routes[i].path, "{id}");
		snprintf(target, sizeof target, "%.*s%s%s", brace ? (int)(brace - routes[i].path) : 100, routes[i].path,
			brace ? ID : "", brace ? brace + 4 : "");
		answer nobody = ask(f->api, &(question){.method = routes[i].method, .target = target, .nobody = true});
		if (open) {
			assert_status(&nobody, 200);
		} else {
			assert_says(&nobody, 401, "needs a token of the role");
			assert_string_equal(nobody.challenge, "Bearer");
			assert_true(nobody.early);
		}
		answer_free(&nobody);
		answer reader =
			ask(f->api, &(question){.method = routes[i].method, .target = target, .role = ESKEL_ROLE_READ});
		if (changes)
			assert_says(&reader, 403, "the token has the role read");
		else
			assert_true(reader.status != 401 && reader.status != 403);
		answer_free(&reader);
	}
}

static void head_is_get_without_its_body(void **state)
{
	api_fixture *f = *state;
	answer got = get(f->api, "/shapes");
	answer head = ask(f->api, &(question){.method = "HEAD", .target = "/shapes"});
	assert_int_equal(head.status, got.status);
	assert_int_equal(head.size, got.size);
	assert_string_equal(head.type, got.type);
	answer_free(&got);
	answer_free(&head);
}

static void forms_of_other_sites_are_refused(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(0, 0, 0);
	static const struct {
		const char *type, *site;
		int status;
	} cases[] = {
		{"application/x-www-form-urlencoded", NULL, 200},
		{"application/x-www-form-urlencoded", "same-origin", 200},
		{"application/x-www-form-urlencoded", "none", 200},
		{"application/x-www-form-urlencoded", "cross-site", 415},
		{"Application/X-WWW-Form-Urlencoded ; charset=utf-8", "cross-site", 415},
		{"text/plain", NULL, 200},
		{"text/plain", "same-site", 415},
		{NULL, NULL, 200},
		{NULL, "cross-site", 415},
		{"application/octet-stream", "cross-site", 200},
		{"application/gzip", NULL, 200},
		{"multipart/form-data; boundary=x", NULL, 415},
		{"multipart/form-data; boundary=x", "same-origin", 415},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		question q = {.target = "/recognize", .body = file.bytes, .size = file.size};
		size_t count = 0;
		if (cases[i].type)
			q.headers[count++] = (eskel_field){"Content-Type", cases[i].type};
		if (cases[i].site)
			q.headers[count++] = (eskel_field){"Sec-Fetch-Site", cases[i].site};
		answer a = ask(f->api, &q);
		assert_says(&a, cases[i].status, cases[i].status == 415 ? "expected" : "");
		answer_free(&a);
	}
	volume_free(&file);
}

static void a_patch_has_a_json_type(void **state)
{
	api_fixture *f = *state;
	static const struct {
		const char *type;
		int status;
	} cases[] = {
		{"application/merge-patch+json", 404},
		{"application/json; charset=utf-8", 404},
		{"application/x-www-form-urlencoded", 404},
		{NULL, 404},
		{"application/json-patch+json", 415},
		{"text/plain", 415},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = ask(f->api, &(question){.method = "PATCH",
					       .target = "/shapes/" ID,
					       .body = "{}",
					       .size = 2,
					       .headers = {{cases[i].type ? "Content-Type" : NULL, cases[i].type}}});
		assert_status(&a, cases[i].status);
		answer_free(&a);
	}
}

static void health_and_readiness_are_told(void **state)
{
	api_fixture *f = *state;
	answer live = get(f->api, "/healthz");
	assert_status(&live, 200);
	assert_string_equal(text_at(&live, "status"), "ok");
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 0, 0, 0, "levels=2", id);
	answer ready = get(f->api, "/readyz");
	assert_status(&ready, 200);
	assert_string_equal(text_at(&ready, "status"), "ready");
	assert_true(number_at(&ready, "shapes") == 1);
	answer_free(&live);
	answer_free(&ready);
}

/* ---------------------------------------------------------------------------------------------- openapi.yaml */

/* What follows a slash tells parameters of one name apart. */
static bool is_listed(const char *const *names, const char *name)
{
	while (*names && (strlen(name) != strcspn(*names, "/") || strncmp(*names, name, strlen(name)) != 0))
		names++;
	return *names;
}

static json_t *resolved(const answer *openapi, json_t *value)
{
	const char *reference = json_string_value(json_object_get(value, "$ref"));
	if (!reference)
		return value;
	char path[100];
	snprintf(path, sizeof path, "%s", reference + strlen("#/"));
	for (char *c = path; *c; c++)
		*c = *c == '/' ? '.' : *c;
	return at(openapi, path);
}

/* Query parameters of an operation that the route has, and how many it describes. */
static size_t described_parameters(const answer *openapi, const json_t *operation, const esk_route *route)
{
	size_t i, count = 0;
	json_t *item;
	json_array_foreach (json_object_get(operation, "parameters"), i, item) {
		const json_t *parameter = resolved(openapi, item);
		const char *name = json_string_value(json_object_get(parameter, "name"));
		if (strcmp(json_string_value(json_object_get(parameter, "in")), "query") != 0)
			continue;
		if (!is_listed(route->query, name))
			fail_msg("%s %s: %s is described and not taken", route->method, route->path, name);
		count++;
	}
	return count;
}

static void the_description_and_the_routes_are_the_same(void **state)
{
	api_fixture *f = *state;
	answer a = get(f->api, "/openapi.json");
	assert_status(&a, 200);
	size_t count, described = 0;
	const esk_route *routes = esk_route_table(&count);
	for (size_t i = 0; i < count; i++) {
		char method[8] = "";
		for (size_t c = 0; routes[i].method[c]; c++)
			method[c] = (char)tolower(routes[i].method[c]);
		const json_t *path = json_object_get(at(&a, "paths"), routes[i].path);
		const json_t *operation = json_object_get(path, method);
		if (!operation)
			fail_msg("%s %s is not described", routes[i].method, routes[i].path);
		size_t taken = 0;
		while (routes[i].query[taken])
			taken++;
		size_t told = described_parameters(&a, operation, &routes[i]);
		if (taken != told)
			fail_msg("%s %s takes %zu parameters, %zu are described", routes[i].method, routes[i].path,
				taken, told);
		if (!json_object_get(operation, "requestBody") != (routes[i].body == ESK_BODY_NONE))
			fail_msg("%s %s: its body is not described as it is", routes[i].method, routes[i].path);
		/* unless it says otherwise, an operation needs a token */
		if (json_is_array(json_object_get(operation, "security")) != (routes[i].role == 0))
			fail_msg("%s %s: its role is not described as it is", routes[i].method, routes[i].path);
	}
	const char *path, *method;
	json_t *methods, *operation;
	json_object_foreach (at(&a, "paths"), path, methods) {
		json_object_foreach (methods, method, operation) {
			described += strcmp(method, "parameters") != 0 && strcmp(path, "/") != 0 &&
				     strcmp(path, "/metrics") != 0;
		}
	}
	assert_int_equal(described, count);
	answer_free(&a);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(every_path_answers_options_with_its_methods),
		api_test(a_path_that_is_unknown_is_404),
		api_test(an_id_is_strict),
		api_test(roles_open_what_they_name),
		api_test(head_is_get_without_its_body),
		api_test(forms_of_other_sites_are_refused),
		api_test(a_patch_has_a_json_type),
		api_test(health_and_readiness_are_told),
		api_test(the_description_and_the_routes_are_the_same),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
