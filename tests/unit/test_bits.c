// SPDX-License-Identifier: MIT
/* src/num/bits.h against the C library, whose frexp, ldexp, ilogb, nearbyint and nextafter are exact. */
#include "unit.h"

#include "../../src/num/bits.h"


#include <sagitta/interval.h>

#include <limits.h>

static const double special[] = {
    0, 0x1p-1074, 0x1.8p-1073, 0x1p-1022, 0x0.fffffffffffffp-1022, 0.5, 1, 1.5, 2.5, 0x1p51, 0x1.8p51,
    0x1.fffffffffffffp51, 0x1p52, 0x1.0000000000001p52, 0x1p53, 0x1p1023, DBL_MAX, HUGE_VAL};

/* Any bits, or a special number. */
static double any(generator *g)
{
    uint64_t bits = random_bits(g);
    double x;
    memcpy(&x, &bits, sizeof x);
    if (isnan(x)) return NOT; /* fmax of a signalling one is NaN */
    if (chance(g, 0.2)) x = special[below(g, COUNT_OF(special))] * either_sign(g);
    if (chance(g, 0.2)) x = uniform(g, -100, 100);
    if (chance(g, 0.1)) x = below(g, 1000) * 0.5 * either_sign(g);
    return x;
}

static bool alike(double a, double b) { return (isnan(a) && isnan(b)) || same_bits(a, b); }

static void test_against_library(void **unused)
{
    (void)unused;
    generator g = seeded("bits");
    for (long i = 0, n = scaled(1000000); i < n; i++) {
        double x = any(&g), y = any(&g);
        int by = chance(&g, 0.1) ? (below(&g, 2) ? INT_MAX : INT_MIN) : below(&g, 4400) - 2200, e, want;
        double got = times_power_of_two(x, by), above = isinf(x) && x > 0 ? x : nextafter(x, FAR);
        REQUIRE(alike(got, ldexp(x, by)), "%a 2^%d: %a, not %a", x, by, got, ldexp(x, by));
        REQUIRE(alike(power_of_two(by), ldexp(1, by)), "2^%d: %a", by, power_of_two(by));
        REQUIRE(alike(nearest_integer(x), nearbyint(x)), "%a to an integer: %a", x, nearest_integer(x));
        REQUIRE(alike(sgt_next_above(x), above), "above %a: %a", x, sgt_next_above(x));
        double m = binary_mantissa(x, &e), want_m = frexp(x, &want);
        REQUIRE(alike(m, want_m) && e == (isfinite(x) ? want : 0), "%a = %a 2^%d", x, m, e);
        if (x != 0 && isfinite(x))
            REQUIRE(binary_exponent(x) == ilogb(x), "%a: exponent %d", x, binary_exponent(x));
        if (x == y) continue; /* of zeros any sign will do */
        double most = fmax(x, y), least = fmin(x, y);
        REQUIRE(alike(maximum_number(x, y), most), "of %a and %a: %a", x, y, maximum_number(x, y));
        REQUIRE(alike(minimum_number(x, y), least), "of %a and %a: %a", x, y, minimum_number(x, y));
        if (isnan(x) || isnan(y)) continue;
        REQUIRE(same_bits(larger(x, y), most) && same_bits(smaller(x, y), least), "%a and %a", x, y);
    }
}

static void test_all_powers(void **unused)
{
    (void)unused;
    for (int n = -3000; n <= 3000; n++) {
        REQUIRE(same_bits(power_of_two(n), ldexp(1, n)), "2^%d: %a", n, power_of_two(n));
        for (size_t i = 0; i < COUNT_OF(special); i++) {
            double got = times_power_of_two(special[i], n);
            REQUIRE(alike(got, ldexp(special[i], n)), "%a 2^%d: %a", special[i], n, got);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_library),
        cmocka_unit_test(test_all_powers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
