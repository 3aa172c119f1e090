// SPDX-License-Identifier: MIT
/* Of a million random operations of interval.h, a sum over the bits of what they give: for
 * builds.py, which builds this as C and as C++.
 *
 *     checksum [COUNT]   a part of COUNT / 16 operations and the sum so far on each line */
#include <sagitta/interval.h>

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t state, sum;

static uint64_t bits(void) /* splitmix64 */
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* A double of any exponent, or of one about 1, or one that has few digits. */
static double number(void)
{
    uint64_t b = bits(), kind = bits() % 8;
    double x;
    if (kind < 5) b = (b & 0x800fffffffffffff) | (1023 - 30 + bits() % 60) << 52;
    if (kind == 5) b &= 0x801fffffffffffff; /* subnormal, or nearly */
    if (kind == 4) b &= 0xffffff0000000000;
    memcpy(&x, &b, sizeof x);
    return x;
}

static void add(double x)
{
    uint64_t b = 1; /* any NaN */
    if (x == x) memcpy(&b, &x, sizeof b);
    sum = (sum ^ b) * 0x9e3779b97f4a7c15u;
    sum ^= sum >> 29;
}

static void add_interval(sgt_interval x) { add(x.lo), add(x.hi); }

static sgt_interval interval(void)
{
    double a = number(), b = number();
    switch (bits() % 8) {
    case 0: return sgt_interval_of(a);
    case 1: return sgt_interval_between(a, b); /* in half of them empty */
    case 2: return sgt_interval_about(a, fabs(b));
    default: return a <= b ? sgt_interval_between(a, b) : sgt_interval_between(b, a);
    }
}

/* Of numbers that most functions are defined for, and do not take to infinity. */
static sgt_interval narrow(sgt_interval x)
{
    double a = fabs(x.lo) / (1 + fabs(x.lo)), b = fabs(x.hi) / (1 + fabs(x.hi));
    return a <= b ? sgt_interval_between(a, b) : sgt_interval_between(b, a);
}

static void add_function(sgt_interval x, sgt_interval y, int which)
{
    static sgt_interval (*const functions[])(sgt_interval) = {
        sgt_interval_cube_root, sgt_interval_exponential, sgt_interval_logarithm, sgt_interval_sine,
        sgt_interval_cosine, sgt_interval_tangent, sgt_interval_arc_sine, sgt_interval_arc_cosine,
        sgt_interval_arc_tangent, sgt_interval_hyperbolic_sine, sgt_interval_hyperbolic_cosine,
        sgt_interval_hyperbolic_tangent};
    if (which < 12) add_interval(functions[which](x));
    else if (which == 12) add_interval(sgt_interval_angle(x, y));
    else if (which == 13) add_interval(sgt_interval_hypotenuse(x, y));
    else add_interval(sgt_interval_real_power(x, y));
}

static void add_pair(sgt_pair x) { add(x.hi), add(x.lo); }

/* Of x > 0, at most 1: rounding outward would hide most of what differs. */
static void add_pairs(double x)
{
    int k;
    if (!(x > 0)) return;
    add_pair(sgt_pair_exponential(sgt_pair_of(700 * x), &k)), add_pair(sgt_pair_logarithm(x));
    add_pair(sgt_pair_sine(sgt_pair_of(x), -1)), add_pair(sgt_pair_cosine(sgt_pair_of(x), 1));
    add_pair(sgt_turn_of(1e7 * x).rest), add_pair(sgt_pair_cube_root(1 + x));
    if (x > 1e-19) add_pair(sgt_pair_arc_tangent(sgt_pair_of(x)));
}

int main(int count, char **words)
{
    long i, n = count > 1 ? strtol(words[1], NULL, 10) : 1000000;
    for (i = 0; i < n; i++) {
        sgt_interval x = interval(), y = interval();
        switch (i % 14) {
        case 0: add_interval(sgt_interval_sum(x, y)); break;
        case 1: add_interval(sgt_interval_difference(x, y)); break;
        case 2: add_interval(sgt_interval_product(x, y)); break;
        case 3: add_interval(sgt_interval_quotient(x, y)); break;
        case 4: add_interval(sgt_interval_square(x)); break;
        case 5: add_interval(sgt_interval_square_root(x)); break;
        case 6: add_interval(sgt_interval_power(x, (int)(bits() % 22) - 9)); break;
        case 7:
            add_interval(sgt_interval_hull(sgt_interval_absolute(x), sgt_interval_intersection(x, y)));
            break;
        case 8: add(sgt_interval_middle(x)), add(sgt_interval_width(x)), add(sgt_interval_greatest(x)); break;
        case 9: add_function(x, y, (int)(bits() % 15)); break;
        case 10: add_function(narrow(x), narrow(y), (int)(bits() % 15)); break;
        case 11: add_function(sgt_interval_of(x.lo), sgt_interval_of(y.lo), (int)(bits() % 15)); break;
        case 12: add_pairs(narrow(x).hi); break;
        default: /* what C++ users and C users call by hand: a small expression */
            add_interval(sgt_interval_sum(sgt_interval_product(x, y),
                                          sgt_interval_scaled(sgt_interval_square(y), 0.75)));
            add(sgt_interval_is_in(x, y)), add(sgt_interval_has(x, y.lo));
        }
        if ((i + 1) % (n / 16 > 0 ? n / 16 : 1) == 0) printf("%ld %016" PRIx64 "\n", i + 1, sum);
    }
    return 0;
}
