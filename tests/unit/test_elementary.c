#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "elementary.h"
#include "synthetic.h"

#include <float.h>
#include <math.h>

static void assert_log(double x)
{
	const long double expected = logl(x);
	const double found = esk_elementary_log(x);
	if (!(fabsl(found - expected) <= 1e-15L * fmaxl(1, fabsl(expected))))
		fail_msg("ln %.17g is %.17g, expected %.17Lg", x, found, expected);
}

static void logarithms_are_those_of_long_doubles(void **state)
{
	(void)state;
	uint64_t random = 1;
	const double ends[] = {DBL_MIN, DBL_MAX, 1, nextafter(1, 0), nextafter(1, 2), sqrt(0.5),
		nextafter(sqrt(0.5), 0), nextafter(sqrt(0.5), 1), sqrt(2), nextafter(sqrt(2), 1),
		nextafter(sqrt(2), 2)};
	for (size_t n = 0; n < sizeof ends / sizeof *ends; n++)
		assert_log(ends[n]);
	for (int n = 0; n < 200000; n++) {
		const double mantissa = 1 + synthetic_uniform(&random);
		assert_log(ldexp(mantissa, n % 2 ? n / 2 % 2044 - 1022 : n / 2 % 3 - 2));
	}
}

static void sines_and_cosines_are_those_of_long_doubles(void **state)
{
	(void)state;
	uint64_t random = 2;
	for (int n = 0; n < 200000; n++) {
		const double x = (2 * synthetic_uniform(&random) - 1) * (n % 2 ? 4 : 1e5),
			     most = 1e-15 * fabs(x) + 1e-15;
		double sine, cosine;
		esk_elementary_sine_cosine(x, &sine, &cosine);
		if (!(fabsl(sine - sinl(x)) <= most && fabsl(cosine - cosl(x)) <= most))
			fail_msg("at %.17g: sine %.17g, cosine %.17g", x, sine, cosine);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(logarithms_are_those_of_long_doubles),
		cmocka_unit_test(sines_and_cosines_are_those_of_long_doubles),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
