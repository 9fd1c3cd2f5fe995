#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/guard.h"

static const char *const ours[] = {"localhost", "127.0.0.1", "[::1]", "bones.example"};
static const size_t ours_count = sizeof ours / sizeof *ours;

static void check_framing(const eskel_field *headers, size_t count, const char *version, int expected)
{
	eskel_request head = {.method = "POST", .headers = headers, .header_count = count};
	esk_refusal refusal = esk_guard_framing(&head, version);
	if (refusal.status != expected)
		print_error("%s: %s ... gives %d\n", headers[0].name, headers[0].value, refusal.status);
	assert_int_equal(refusal.status, expected);
	assert_int_equal(refusal.close, expected != 0);
}

#define FRAMING(version, expected, ...) \
	check_framing((const eskel_field[]){__VA_ARGS__}, \
		sizeof((const eskel_field[]){__VA_ARGS__}) / sizeof(eskel_field), version, expected)

static void heads_that_two_servers_read_differently_are_refused(void **state)
{
	(void)state;
	FRAMING("HTTP/1.1", 400, {"Host", "a"}, {"host", "a"});
	FRAMING("HTTP/1.1", 400, {"Content-Length", "5"}, {"content-length", "5"});
	FRAMING("HTTP/1.1", 400, {"Content-Length", "5"}, {"Transfer-Encoding", "chunked"});
	FRAMING("HTTP/1.1", 400, {"Transfer-Encoding", "chunked"}, {"Transfer-Encoding", "chunked"});
	FRAMING("HTTP/1.1", 400, {"Authorization", "Bearer a"}, {"Authorization", "Bearer b"});
	FRAMING("HTTP/1.1", 400, {"Content-Length ", "5"});
	FRAMING("HTTP/1.1", 400, {"", "5"});
	FRAMING("HTTP/1.0", 400, {"Transfer-Encoding", "chunked"});
	FRAMING("HTTP/1.1", 501, {"Transfer-Encoding", "gzip, chunked"});
	FRAMING("HTTP/1.1", 501, {"Transfer-Encoding", "identity"});
}

static void ordinary_heads_pass(void **state)
{
	(void)state;
	FRAMING("HTTP/1.1", 0, {"Host", "a"}, {"Transfer-Encoding", "Chunked"}, {"Accept", "a"}, {"Accept", "b"});
	FRAMING("HTTP/1.0", 0, {"Host", "a"}, {"Content-Length", "5"});
}

static int host_status(const char *host)
{
	const eskel_field header = {"Host", host};
	eskel_request head = {.method = "GET", .headers = &header, .header_count = host ? 1 : 0};
	return esk_guard_host(&head, ours, ours_count).status;
}

static void only_hosts_of_the_list_are_served(void **state)
{
	(void)state;
	static const char *const good[] = {
		"localhost", "LOCALHOST:8467", "localhost:", "127.0.0.1:1", "[::1]", "[::1]:80", "bones.example"};
	static const char *const bad[] = {NULL, "", "evil.example", "localhost.evil.example", "evil:localhost",
		"localhost:80:90", "localhost:x", "::1", "[::1", "[::1]x", "[localhost]", "localhost "};
	for (size_t i = 0; i < sizeof good / sizeof *good; i++)
		assert_int_equal(host_status(good[i]), 0);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		if (host_status(bad[i]) != 421)
			fail_msg("the host \"%s\" was served", bad[i]);
}

static int site_status(const char *method, const char *name, const char *value)
{
	const eskel_field header = {name, value};
	eskel_request head = {.method = method, .headers = &header, .header_count = name ? 1 : 0};
	return esk_guard_site(&head, ours, ours_count).status;
}

static void pages_of_other_sites_change_nothing(void **state)
{
	(void)state;
	assert_int_equal(site_status("POST", NULL, NULL), 0);
	assert_int_equal(site_status("POST", "Sec-Fetch-Site", "same-origin"), 0);
	assert_int_equal(site_status("DELETE", "Sec-Fetch-Site", "none"), 0);
	assert_int_equal(site_status("POST", "Sec-Fetch-Site", "cross-site"), 403);
	assert_int_equal(site_status("POST", "Sec-Fetch-Site", "same-site"), 403);
	assert_int_equal(site_status("GET", "Sec-Fetch-Site", "cross-site"), 0);
	assert_int_equal(site_status("PATCH", "Origin", "http://localhost:8467"), 0);
	assert_int_equal(site_status("PATCH", "Origin", "https://evil.example"), 403);
	assert_int_equal(site_status("PATCH", "Origin", "null"), 403);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(heads_that_two_servers_read_differently_are_refused),
		cmocka_unit_test(ordinary_heads_pass),
		cmocka_unit_test(only_hosts_of_the_list_are_served),
		cmocka_unit_test(pages_of_other_sites_change_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
