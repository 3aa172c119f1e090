// SPDX-License-Identifier: MIT
/* The arithmetic of src/num/exact.h and src/num/expansion.h, against sums of integers.
 *
 *   two_sum, two_product   hi + lo is a + b, or a b, to the last bit;
 *   a twofold              sum, difference, product, quotient and root are off by no more than the head of
 *                          exact.h says;
 *   an expansion           its err holds what an operation has left out, and what its operands may be off
 *                          by, each of them to either side.
 *
 * The sums of integers have room for doubles between 2^-500 and 2^300, and for the product of any two. */
#include "unit.h"

#include "../../src/num/expansion.h"

/* ------------------------------------------------------------------- exact sums */

enum { LIMBS = 60, BOTTOM = -1200 }; /* limb i counts 2^(BOTTOM + 32 i) */

typedef struct number { int64_t limb[LIMBS]; } number;

static void add_integer(number *to, int sign, uint64_t m, int exponent)
{
    int place = exponent - BOTTOM;
    REQUIRE(place >= 0 && place / 32 + 2 < LIMBS, "2^%d is out of range", exponent);
    const uint64_t part[2] = {m & 0xffffffffu, m >> 32};
    for (int i = 0; i < 2; i++) {
        uint64_t shifted = part[i] << (place % 32);
        to->limb[place / 32 + i] += sign * (int64_t)(shifted & 0xffffffffu);
        to->limb[place / 32 + i + 1] += sign * (int64_t)(shifted >> 32);
    }
}

/* |x| = m 2^e. */
static uint64_t mantissa(double x, int *e)
{
    uint64_t m = (uint64_t)ldexp(frexp(fabs(x), e), 53);
    *e -= 53;
    return m;
}

static void add(number *to, double x)
{
    int e;
    uint64_t m = mantissa(x, &e);
    if (m) add_integer(to, x < 0 ? -1 : 1, m, e);
}

static void add_product(number *to, double a, double b)
{
    int e, f, sign = (a < 0) != (b < 0) ? -1 : 1;
    uint64_t m = mantissa(a, &e), n = mantissa(b, &f), low = (1u << 27) - 1;
    if (!m || !n) return;
    const uint64_t x[2] = {m & low, m >> 27}, y[2] = {n & low, n >> 27};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            if (x[i] > 0 && y[j] > 0) add_integer(to, sign, x[i] * y[j], e + f + 27 * (i + j));
}

/* Its magnitude, to a few roundings. */
static long double size_of(number x)
{
    int64_t carry = 0;
    for (int i = 0; i < LIMBS; i++) {
        int64_t all = x.limb[i] + carry;
        x.limb[i] = (int64_t)((uint64_t)all & 0xffffffffu);
        carry = (all - x.limb[i]) / 0x100000000;
    }
    if (carry < 0) { /* the complement */
        for (int i = 0; i < LIMBS; i++) x.limb[i] = -x.limb[i];
        x.limb[LIMBS - 1] += 0x100000000;
        return size_of(x);
    }
    long double sum = 0;
    for (int i = 0; i < LIMBS; i++) sum += ldexpl((long double)x.limb[i], BOTTOM + 32 * i);
    return sum;
}

/* ---------------------------------------------------------------------- twofold */

static double random_double(generator *g)
{
    double x = ldexp(uniform(g, 1, 2), below(g, 40) - 20);
    double few = 1 + below(g, 8) * (chance(g, 0.5) ? 0.125 : 0x1p-52);
    if (chance(g, 0.3)) x = ldexp(few, below(g, 40) - 20); /* few bits, or most of them zero */
    return either_sign(g) * x;
}

static twofold random_twofold(generator *g)
{
    double hi = random_double(g);
    double lo = uniform(g, -1, 1) * fabs(hi) * SGT_U * (chance(g, 0.2) ? 0x1p-40 : 1);
    return two_sum(hi, chance(g, 0.2) ? 0 : lo);
}

static void add_twofold(number *to, twofold a, double by)
{
    add_product(to, a.hi, by), add_product(to, a.lo, by);
}

static void add_twofold_product(number *to, twofold a, twofold b)
{
    add_twofold(to, a, b.hi), add_twofold(to, a, b.lo);
}

/* of: what the error is relative to. */
static void require_within(long i, const char *what, const number *off, const number *of, double most,
                           double *worst)
{
    long double error = size_of(*off), size = size_of(*of);
    *worst = fmax(*worst, size > 0 ? (double)(error / size / 0x1p-106L) : 0);
    REQUIRE(error <= most * size * (1 + 0x1p-50L), "case %ld: a %s is off by %Lg of itself, not %g", i, what,
            error / size, most);
}

static void test_twofold(void **state)
{
    (void)state;
    generator g = seeded("twofold");
    long n = scaled(30000);
    double worst[4] = {0};
    for (long i = 0; i < n; i++) {
        const double u2 = SGT_U * SGT_U;
        double x = random_double(&g), y = random_double(&g);
        if (chance(&g, 0.3)) y = -x * (1 + uniform(&g, -4, 4) * 0x1p-52);
        twofold s = two_sum(x, y), p = two_product(x, y), a = random_twofold(&g), b = random_twofold(&g);
        number off = {{0}}, of = {{0}};
        add(&off, x), add(&off, y), add(&off, -s.hi), add(&off, -s.lo);
        REQUIRE(size_of(off) == 0 && s.hi == x + y, "case %ld: two_sum of %a and %a", i, x, y);
        off = of;
        add_product(&off, x, y), add(&off, -p.hi), add(&off, -p.lo);
        REQUIRE(size_of(off) == 0 && p.hi == x * y, "case %ld: two_product of %a and %a", i, x, y);
        if (chance(&g, 0.3)) b = two_sum(-a.hi, a.lo * uniform(&g, -2, 2)); /* these cancel */

        number zero = {{0}};
        s = twofold_sum(a, b), off = of = zero;
        add_twofold(&of, a, 1), add_twofold(&of, b, 1), off = of, add_twofold(&off, s, -1);
        require_within(i, "sum", &off, &of, 3 * u2 + 13 * SGT_U * u2, &worst[0]);
        s = twofold_difference(a, b), off = of = zero;
        add_twofold(&of, a, 1), add_twofold(&of, b, -1), off = of, add_twofold(&off, s, -1);
        require_within(i, "difference", &off, &of, 3 * u2 + 13 * SGT_U * u2, &worst[0]);
        p = twofold_product(a, b), off = of = zero;
        add_twofold_product(&of, a, b), off = of, add_twofold(&off, p, -1);
        require_within(i, "product", &off, &of, 5 * u2, &worst[1]);
        p = twofold_quotient(a, b), off = of = zero;
        add_twofold(&of, a, 1), off = of, add_twofold_product(&off, p, twofold_negative(b));
        require_within(i, "quotient", &off, &of, 15 * u2 + 56 * SGT_U * u2, &worst[2]);
        if (a.hi < 0) a = twofold_negative(a);
        p = twofold_root(a), off = of = zero;
        /* twice the root's */
        add_twofold(&of, a, 1), off = of, add_twofold_product(&off, p, twofold_negative(p));
        require_within(i, "root", &off, &of, 2 * 25 * u2 / 8, &worst[3]);
    }
    print_message("in units of 2^-106: sum %.2f, product %.2f, quotient %.2f, square of the root %.2f\n",
                  worst[0], worst[1], worst[2], worst[3]);
}

/* -------------------------------------------------------------------- expansion */

static expansion random_expansion(generator *g)
{
    double x[8], size = fabs(random_double(g)), now = size;
    double falling = chance(g, 0.5) ? 0x1p-53 : ldexp(1, -below(g, 60));
    int n = 1 + below(g, 8);
    for (int i = n - 1; i >= 0; i--, now *= falling) x[i] = chance(g, 0.1) ? 0 : now * uniform(g, -1, 1);
    double err = chance(g, 0.4) ? 0 : size * ldexp(uniform(g, 1, 2), -below(g, 300));
    return expansion_of_list(n, x, err);
}

static void add_expansion(number *to, const expansion *a, double by)
{
    for (int i = 0; i < PARTS; i++) add_product(to, a->part[i], by);
}

static long double value_of(const expansion *a)
{
    number x = {{0}};
    add_expansion(&x, a, 1);
    return size_of(x);
}

/* The operands may be off by `carried` together: is err no less than that and what is left out? */
static void require_held(long i, const char *what, const number *left_out, long double carried, double err)
{
    long double off = size_of(*left_out) + carried;
    REQUIRE(off <= err * (1 + 0x1p-60L), "case %ld: a %s may be off by %La, of which %La carried, not %a", i,
            what, off, carried, err);
}

static void test_expansion(void **state)
{
    (void)state;
    generator g = seeded("expansion");
    long n = scaled(10000), inexact = 0, carried = 0;
    for (long i = 0; i < n; i++) {
        expansion a = random_expansion(&g), b = random_expansion(&g), c;
        if (chance(&g, 0.2)) { /* these cancel, but for what they may be off by */
            b = expansion_negative(a);
            b.err = chance(&g, 0.5) ? 0 : fabs(a.part[0]) * ldexp(1, -below(&g, 300));
        }
        number off = {{0}}, zero = {{0}};
        long double size_a = value_of(&a), size_b = value_of(&b);
        double scale = random_double(&g), err, v;

        c = expansion_sum(a, b);
        add_expansion(&off, &a, 1), add_expansion(&off, &b, 1), add_expansion(&off, &c, -1);
        require_held(i, "sum", &off, (long double)a.err + b.err, c.err);

        c = expansion_product(a, b), off = zero;
        for (int j = 0; j < PARTS; j++) add_expansion(&off, &a, b.part[j]);
        add_expansion(&off, &c, -1);
        require_held(i, "product", &off, size_a * b.err + size_b * a.err + (long double)a.err * b.err, c.err);
        inexact += size_of(off) > 0, carried += a.err > 0 && b.err > 0;

        c = expansion_scaled(a, scale), off = zero;
        add_expansion(&off, &a, scale), add_expansion(&off, &c, -1);
        require_held(i, "multiple", &off, (long double)a.err * fabs(scale), c.err);

        v = expansion_value(&a, &err), off = zero;
        add_expansion(&off, &a, 1), add(&off, -v);
        require_held(i, "value", &off, a.err, err);
        REQUIRE(expansion_size(&a) >= size_a + a.err, "case %ld: the size %a", i, expansion_size(&a));

        double o = random_double(&g), d = random_double(&g), t0 = random_double(&g);
        double t = chance(&g, 0.3) ? -t0 : random_double(&g) * SGT_U;
        c = expansion_along(o, d, t0, t), off = zero;
        add(&off, o), add_product(&off, t0, d), add_product(&off, t, d), add_expansion(&off, &c, -1);
        REQUIRE(size_of(off) == 0 && c.err == 0, "case %ld: %a + (%a + %a) %a", i, o, t0, t, d);
    }
    REQUIRE(inexact > n / 4 && carried > n / 4, "%ld products are not exact, in %ld both factors are off",
            inexact, carried);
    print_message("%ld products are not exact, in %ld both factors are off\n", inexact, carried);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_twofold), cmocka_unit_test(test_expansion)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
