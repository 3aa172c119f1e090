// SPDX-License-Identifier: MIT
/* The forms of src/system/form.h contain what they say: random forms, random members of them, each operation
 * in long double.  A member of a form is c + a U + b V + s e at a random (U, V), with s in [-1, 1]; ends of
 * all are drawn often. */
#include "unit.h"

#include "../../src/system/form.h"

static generator drawn;

/* From -1 to 1, one of the ends in a quarter of cases. */
static double share_of(void)
{
    double x = uniform(&drawn, -1, 1);
    return x > 0.75 ? 1 : x < -0.75 ? -1 : x;
}

static linear random_form(double small)
{
    double size = exp2(uniform(&drawn, -20, 20));
    linear x = {size * uniform(&drawn, -1, 1), size * small * uniform(&drawn, -1, 1),
                size * small * uniform(&drawn, -1, 1), 0};
    if (uniform(&drawn, 0, 1) < 0.7) x.e = size * small * uniform(&drawn, 0, 0.5);
    return x;
}

static long double member(linear x, double u, double v)
{
    return (long double)x.c + (long double)x.a * u + (long double)x.b * v + (long double)x.e * share_of();
}

/* Is y within the form, at (u, v)? */
static void require_in(const char *what, linear f, long double y, double u, double v)
{
    long double off = fabsl(y - ((long double)f.c + (long double)f.a * u + (long double)f.b * v));
    if (isnan(f.c) || isnan(f.e)) return; /* nothing is said */
    REQUIRE(off <= (long double)f.e, "%s: off by %Lg, not within %g", what, off, f.e);
    sgt_interval range = form_range(f);
    REQUIRE(y >= (long double)range.lo && y <= (long double)range.hi, "%s: not in its range", what);
}

static void operations_contain(void **unused)
{
    (void)unused;
    long said = 0, asked = 0, count = scaled(100000);
    drawn = seeded("form");
    for (long i = 0; i < count; i++) {
        double small = exp2(uniform(&drawn, -30, 1)), u = share_of(), v = share_of(),
               k = uniform(&drawn, -10, 10);
        linear x = random_form(small), y = random_form(small);
        long double a = member(x, u, v), b = member(y, u, v);
        require_in("sum", form_sum(x, y), a + b, u, v);
        require_in("difference", form_difference(x, y), a - b, u, v);
        require_in("plus", form_plus(x, k), a + k, u, v);
        require_in("scaled", form_scaled(x, k), a * k, u, v);
        require_in("product", form_product(x, y), a * b, u, v);
        require_in("square", form_square(x), a * a, u, v);
        if (a >= 0) require_in("root", form_root(x), sqrtl(a), u, v);
        linear inverse = form_inverse(x);
        asked++, said += !isnan(inverse.e);
        if (a != 0) require_in("inverse", inverse, 1 / a, u, v);
        if (b != 0) require_in("quotient", form_quotient(x, y), a / b, u, v);
        sgt_interval range = form_range(x);
        require_in("between", form_between(range), a, u, v);
    }
    REQUIRE(said > asked / 2, "%ld inverses of %ld", said, asked);
}

/* What is not known stays so: no test is true of it. */
static void unknown_stays(void **unused)
{
    (void)unused;
    linear none = form_inverse((linear){0.1, 0.2, 0, 0});
    sgt_interval range = form_range(form_sum(none, form_of(1)));
    assert_false(range.lo > 0 || range.hi < 0);
    range = form_range(form_root(none));
    assert_false(range.lo > 0 || range.hi < 0);
    range = form_range(form_product(none, form_of(0)));
    assert_false(range.lo > 0 || range.hi < 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(operations_contain), cmocka_unit_test(unknown_stays)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
