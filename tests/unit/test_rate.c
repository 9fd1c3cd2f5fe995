#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/rate.h"

static size_t taken(esk_rate *rate, uint64_t key, double cost, int64_t now)
{
	size_t n = 0;
	while (n < 100000 && esk_rate_take(rate, key, cost, now))
		n++;
	return n;
}

static void a_bucket_holds_a_second_and_refills_steadily(void **state)
{
	(void)state;
	esk_rate *rate = esk_rate_new(100);
	assert_int_equal(taken(rate, 7, 1, 1000), 100);
	assert_int_equal(taken(rate, 7, 1, 1005), 0);
	assert_int_equal(taken(rate, 7, 1, 1500), 50);
	assert_int_equal(taken(rate, 7, 1, 1000000), 100);
	esk_rate_free(rate);
}

static void clients_do_not_use_each_others_requests(void **state)
{
	(void)state;
	esk_rate *rate = esk_rate_new(10);
	assert_int_equal(taken(rate, 1, 1, 1000), 10);
	assert_int_equal(taken(rate, 2, 1, 1000), 10);
	assert_int_equal(taken(rate, 1, 1, 1000), 0);
	esk_rate_free(rate);
}

static void a_dear_request_is_waited_for(void **state)
{
	(void)state;
	esk_rate *rate = esk_rate_new(10);
	assert_true(esk_rate_take(rate, 1, 30, 1000));
	assert_false(esk_rate_take(rate, 1, 1, 2900));
	assert_true(esk_rate_take(rate, 1, 1, 3200));
	esk_rate_free(rate);
}

static void many_strangers_do_not_displace_who_is_busy(void **state)
{
	(void)state;
	esk_rate *rate = esk_rate_new(10);
	for (int64_t now = 1000; now < 1100; now++) {
		for (uint64_t k = 0; k < 30; k++)
			esk_rate_take(rate, 1000 + (uint64_t)now * 30 + k, 1, now);
		assert_int_equal(taken(rate, 1, 1, now), now == 1000 ? 10 : 0);
	}
	esk_rate_free(rate);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bucket_holds_a_second_and_refills_steadily),
		cmocka_unit_test(clients_do_not_use_each_others_requests),
		cmocka_unit_test(a_dear_request_is_waited_for),
		cmocka_unit_test(many_strangers_do_not_displace_who_is_busy),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
