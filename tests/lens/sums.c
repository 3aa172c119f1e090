// SPDX-License-Identifier: MIT
/* sums.c - exact sums of hostile summands, in any partition and order: sums SETS PARTITIONS
 *
 * A set has numbers, products w x and squares w x x, of exponents from -1074 to 1023, which cancel, repeat,
 * lie in the middle between two doubles, or are infinite or NaN.  It is summed up in random orders, divided
 * among one to nine accumulators which are merged in a random order; rays of one weight go by run.h or not.
 * All of that has to end in the same bits.
 * They are printed, and test_sums.py compares them with mpmath.
 *
 * Then the same with rays of sgt_sums, whose bytes have to be the same; and bytes that are cut off or damaged
 * in any place have to be refused. */
#include "../../src/lens/study/run.h"

#include <sagitta/analysis.h>

#include <stdio.h>
#include <stdlib.h>

enum { MOST = 60, PLACES = 9 };

static uint64_t state = 1;

static uint64_t draw(void)
{
    uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15); /* splitmix64 */
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9), z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static size_t below(size_t n) { return (size_t)(draw() % n); }

/* A double whose exponent is anywhere from low to high. */
static double number(int low, int high)
{
    const double m = (double)(draw() >> 11 | 1) * 0x1p-53;
    return ldexp(below(2) ? m : -m, low + (int)below((size_t)(high - low + 1)));
}

static void fail(const char *what)
{
    printf("fails: %s\n", what);
    exit(1);
}

/* factors: 1 of x, 2 of w x, 3 of w x x */
typedef struct summand { int factors; double w, x; } summand;

static size_t make_set(summand s[MOST], size_t kind)
{
    const size_t count = kind % 5 == 2 ? 2 : 1 + below(MOST);
    const int high = kind % 4 == 0 ? 1023 : kind % 4 == 1 ? 30 : 400, low = kind % 4 == 0 ? -1074 : -high;
    for (size_t i = 0; i < count; i++) {
        s[i] = (summand){1 + (int)below(3), number(low, high), number(low, high)};
        if (kind % 4 == 2) s[i].factors = 1, s[i].x = number(-1, 1) * (below(2) ? 0x1p1000 : 0x1p-1000);
        if (i && below(3) == 0) s[i] = s[i - 1], s[i].w = -s[i].w; /* cancels */
        if (i && s[i].factors == 1 && below(3) == 0) s[i].x = -s[i - 1].x;
        if (i && below(2)) s[i].w = s[i - 1].w;
        if (below(20) == 0) s[i].x = 0;
        if (kind % 5 == 2) /* a number of 53 bits, and half its last one */
            s[i] = (summand){1, 1, i ? 1 : (double)(UINT64_C(1) << 52 | draw() >> 12) * 2};
    }
    if (kind % 7 == 3) s[below(count)].x = HUGE_VAL;
    if (kind % 7 == 4) s[below(count)].x = below(2) ? -HUGE_VAL : HUGE_VAL, s[below(count)].w = HUGE_VAL;
    if (kind % 7 == 5) s[below(count)].x = (double)NAN;
    return count;
}

static void add(exact *to, const summand *s)
{
    if (s->factors == 1) exact_add(to, s->x);
    else if (s->factors == 2) exact_add_product(to, s->w, s->x);
    else exact_add_square(to, s->w, s->x);
}

/* By runs: as spot.c has it. */
static void add_by_runs(exact *to, size_t count, const summand s[])
{
    exact_run first = RUN_OF_FIRST, second = RUN_OF_SQUARE;
    double w = 0;
    for (size_t i = 0; i < count; i++) {
        if (s[i].factors == 1 || !isfinite(s[i].w)) {
            add(to, &s[i]);
            continue;
        }
        if (s[i].w != w) sgt_exact_run_end(&first, to, w), sgt_exact_run_end(&second, to, w), w = s[i].w;
        if (s[i].factors == 2) exact_run_add(&first, to, w, s[i].x);
        else exact_run_square(&second, to, w, s[i].x);
    }
    sgt_exact_run_end(&first, to, w), sgt_exact_run_end(&second, to, w);
}

static void shuffle(summand s[], size_t count)
{
    for (size_t i = count; i > 1; i--) {
        const size_t k = below(i);
        const summand t = s[k];
        s[k] = s[i - 1], s[i - 1] = t;
    }
}

/* One partition, in one order. */
static double sum_of(size_t count, summand s[], double *rest)
{
    static exact place[PLACES];
    size_t places = 1 + below(PLACES), first = 0;
    memset(place, 0, sizeof place);
    if (below(4)) shuffle(s, count);
    for (size_t p = 0; p < places; p++) {
        const size_t end = p + 1 == places ? count : first + below(count - first + 1);
        if (below(2)) add_by_runs(&place[p], end - first, s + first);
        else
            for (size_t i = first; i < end; i++) add(&place[p], &s[i]);
        if (below(8) == 0) sgt_exact_carry(&place[p]);
        first = end;
    }
    for (; places > 1; places--) { /* the last into any other */
        const size_t into = below(places - 1);
        sgt_exact_merge(&place[into], &place[places - 1]);
    }
    return sgt_exact_value(&place[0], rest);
}

static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

static void try_set(size_t kind, size_t partitions)
{
    summand s[MOST];
    double rest, again_rest;
    const size_t count = make_set(s, kind);
    const double value = sum_of(count, s, &rest);
    for (size_t i = 1; i < partitions; i++)
        if (!same(sum_of(count, s, &again_rest), value) || !same(again_rest, rest)) fail("another sum");
    printf("%a %a", value, rest);
    for (size_t i = 0; i < count; i++) printf(" %d %a %a", s[i].factors, s[i].w, s[i].x);
    putchar('\n');
}

/* ----------------------------------------------------------------- sums of rays */

enum { RAYS = 300, BYTES = 1 << 15 };

static const sgt_vec2 about = {0.125, -3};

/* The sums of the rays, in a random order, divided, written, read and merged at random. */
static sgt_sums *sums_of(sgt_sums_kind kind, size_t count, sgt_ray_end end[], double opd[],
                         const double error[])
{
    static unsigned char part[BYTES];
    sgt_sums *all = sgt_sums_new(kind, &about, NULL);
    for (size_t i = count; i > 1; i--) {
        const size_t k = below(i);
        const sgt_ray_end e = end[k];
        const double v = opd[k];
        end[k] = end[i - 1], end[i - 1] = e, opd[k] = opd[i - 1], opd[i - 1] = v;
    }
    for (size_t first = 0, more; first < count; first += more) {
        sgt_sums *some = sgt_sums_new(kind, &about, NULL);
        more = 1 + below(count - first);
        sgt_sums_add(some, more, end + first, opd + first, error + first);
        const bool swap = below(2);
        const size_t size = sgt_sums_write(swap ? all : some, BYTES, part);
        sgt_sums *read = sgt_sums_read("a part", size, part, NULL, NULL), *to = swap ? some : all;
        if (!read || !sgt_sums_merge(to, read)) fail("parts that do not merge");
        sgt_sums_free(read), sgt_sums_free(swap ? all : some);
        all = to;
    }
    return all;
}

/* Cut off, or with another byte anywhere: refused, with the name that was given. */
static void try_damage(size_t size, unsigned char bytes[])
{
    for (size_t i = 0; i < 500; i++) {
        sgt_error e;
        const size_t at = i < 64 ? i : below(size), cut = below(2) ? at : size;
        const unsigned char was = bytes[at];
        if (cut == size) bytes[at] ^= (unsigned char)(1 + below(255));
        if (sgt_sums_read("the part", cut, bytes, NULL, &e)) fail("damaged bytes were read");
        if (strcmp(e.file, "the part") != 0 || !*e.words) fail("no name of what is damaged");
        bytes[at] = was;
    }
}

static void try_rays(sgt_sums_kind kind, size_t partitions)
{
    static unsigned char bytes[BYTES], again[BYTES];
    static sgt_ray_end end[RAYS];
    double opd[RAYS], error[RAYS];
    for (size_t i = 0; i < RAYS; i++) {
        end[i] = (sgt_ray_end){.fate = below(9) ? SGT_PASSED : SGT_CLIPPED, .weight = (double)(1 + below(3)),
                               .p = {number(-30, 8), number(-30, 8), 0}, .p_err = 1e-12};
        opd[i] = below(9) ? number(-30, 8) : (double)NAN, error[i] = 1e-9;
    }
    sgt_sums *s = sums_of(kind, RAYS, end, opd, error);
    const size_t size = sgt_sums_write(s, BYTES, bytes);
    if (size > BYTES) fail("more bytes than there is room");
    for (size_t i = 0; i < partitions; i++) {
        sgt_sums *other = sums_of(kind, RAYS, end, opd, error);
        if (sgt_sums_write(other, BYTES, again) != size || memcmp(bytes, again, size) != 0)
            fail("other bytes");
        sgt_sums_free(other);
    }
    try_damage(size, bytes);
    sgt_sums *elsewhere = sgt_sums_new(SGT_SUMS_SPOT, NULL, NULL);
    if (sgt_sums_merge(s, elsewhere)) fail("sums about another point, or of another kind, merge");
    const sgt_spot spot = sgt_sums_spot(s, true);
    const sgt_wavefront front = sgt_sums_wavefront(s);
    if (kind == SGT_SUMS_SPOT) printf("spot %a %a %a %a", spot.rms_x, spot.rms_y, spot.rms, spot.error);
    else printf("wavefront %a %a %a", front.mean, front.rms, front.error);
    for (size_t i = 0; i < RAYS; i++) {
        if (kind == SGT_SUMS_SPOT && end[i].fate == SGT_PASSED)
            printf(" %a %a %a", end[i].weight, end[i].p.x, end[i].p.y);
        if (kind == SGT_SUMS_WAVEFRONT && !isnan(opd[i])) printf(" %a %a", end[i].weight, opd[i]);
    }
    putchar('\n');
    sgt_sums_free(s), sgt_sums_free(elsewhere);
}

/* Of path differences that are not finite, or whose squares are not, there is no rms: never 0.  Zeros of both
 * signs make the same bits in either order. */
static void try_odd(void)
{
    static const double odd[][2] = {{1, HUGE_VAL}, {-HUGE_VAL, HUGE_VAL}, {1e160, 3e160}, {1e300, -HUGE_VAL}};
    static unsigned char bytes[BYTES], again[BYTES];
    sgt_ray_end end[2] = {{.fate = SGT_PASSED, .weight = 1}, {.fate = SGT_PASSED, .weight = 1}};
    const double error[2] = {0, 0};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        double two[2] = {odd[i][0], odd[i][1]};
        sgt_sums *s = sums_of(SGT_SUMS_WAVEFRONT, 2, end, two, error);
        if (sgt_sums_wavefront(s).rms == 0) fail("an rms of 0 of what has none");
        sgt_sums_free(s);
    }
    for (size_t i = 0; i < 3; i++) {
        sgt_ray_end far[2] = {end[0], end[1]};
        far[0].p.x = 1, far[1].p.x = odd[i][1];
        sgt_sums *s = sums_of(SGT_SUMS_SPOT, 2, far, (double[]){0, 0}, error);
        if (sgt_sums_spot(s, true).rms_x == 0) fail("an rms_x of 0 of what has none");
        sgt_sums_free(s);
    }
    sgt_sums *a = sums_of(SGT_SUMS_WAVEFRONT, 2, end, (double[]){0.0, -0.0}, error);
    sgt_sums *b = sums_of(SGT_SUMS_WAVEFRONT, 2, end, (double[]){-0.0, 0.0}, error);
    const size_t size = sgt_sums_write(a, BYTES, bytes);
    if (sgt_sums_write(b, BYTES, again) != size || memcmp(bytes, again, size) != 0) fail("two zeros");
    sgt_sums_free(a), sgt_sums_free(b);
}

int main(int count, char *argv[])
{
    if (count != 3) return 2;
    try_odd();
    const size_t sets = (size_t)atol(argv[1]), partitions = (size_t)atol(argv[2]);
    const char *seed = getenv("SAGITTA_TEST_SEED");
    if (seed) state = (uint64_t)atoll(seed);
    for (size_t i = 0; i < sets; i++) try_set(i, partitions);
    try_rays(SGT_SUMS_SPOT, sets), try_rays(SGT_SUMS_WAVEFRONT, sets);
    return 0;
}
