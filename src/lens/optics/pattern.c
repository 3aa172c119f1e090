// SPDX-License-Identifier: MIT
/* pattern.c - points in the unit circle of a pupil, the same bits on every system.
 *
 * What makes them is integers, sums, products and quotients; the cosines of a hexapolar pattern
 * are those of sgt_turns, whose bits are the library's own.
 *
 * RANDOM.  Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, Parallel random numbers: as easy as
 * 1, 2, 3, SC'11, section 5.3) turns a counter and a key into 128 bits that look random.  The
 * counter is the number of the point and of the attempt, the key is the seed: so a point depends
 * on no other.  Two numbers in [-1, 1] make a point of the square; if it lies outside the circle
 * the next attempt is made.  128 attempts fail with a chance of 2^-285.
 *
 * SOBOL.  The first two dimensions of Sobol's sequence (1967): the digits of the number reversed,
 * and that with the direction numbers of the polynomial x + 1, v_i = v_{i-1} xor v_{i-1} / 2.
 * The points of the square that lie in the circle are taken in their order.  They are made in runs of 512
 * numbers that begin at a multiple of it: the point of number 512 r + i is that of 512 r with the bits of i's
 * point turned over.  A run has one point in each cell of 1/32 x 1/16 of the square (a net, Sobol 1967), and
 * 344 of these cells lie in the circle.  The numbers have 32 bits, so after 3.37e9 points they begin again.
 *
 * HEXAPOLAR.  Ring j of n has the radius j / n and 6 j points.  Weights are areas: a ring stands
 * for what is nearer to it than to the next.
 *
 * PARTS.  A point is made from its number, so that any part of a pattern can be made by itself.  Of a grid
 * that needs the number of each row's first point, of Sobol's sequence how many points go before each run: to
 * count them takes some two nanoseconds a point.  In a row the points in the circle are neighbours, symmetric
 * about the middle, and x^2 + y^2 as it is rounded falls nowhere from the middle on: so bisection finds the
 * last of them. */
#include "pattern.h"

#include <math.h>

/* -------------------------------------------------------------- generators */

typedef struct philox_words { uint32_t at[4]; } philox_words;

static inline philox_words philox(philox_words x, uint32_t k0, uint32_t k1)
{
    enum { ROUNDS = 10 };
    for (int i = 0; i < ROUNDS; i++) {
        const uint64_t a = (uint64_t)0xD2511F53u * x.at[0], b = (uint64_t)0xCD9E8D57u * x.at[2];
        x = (philox_words){{(uint32_t)(b >> 32) ^ x.at[1] ^ k0, (uint32_t)b,
                            (uint32_t)(a >> 32) ^ x.at[3] ^ k1, (uint32_t)a}};
        k0 += 0x9E3779B9u, k1 += 0xBB67AE85u; /* Weyl's sequences */
    }
    return x;
}

void sgt_philox(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
    const philox_words first = {{counter[0], counter[1], counter[2], counter[3]}},
                       x = philox(first, key[0], key[1]);
    for (int j = 0; j < 4; j++) out[j] = x.at[j];
}

/* [-1, 1), symmetric about 0: the middles of 2^53 parts.  The two words become doubles each by itself, as
 * signed numbers: for these there are lanes.  The number of the part is exact. */
static inline double symmetric(uint32_t high, uint32_t low)
{
    const double upper = (double)(int32_t)(high ^ 0x80000000u), lower = (double)(int32_t)(low >> 11);
    const double part = upper * 0x1p21 + 0x1p52 + lower;
    return (part + 0.5) * 0x1p-52 - 1;
}

static bool in_circle(double x, double y) { return x * x + y * y <= 1; }

/* An attempt of `count` points, those of the numbers base + open[i], which differ in their lower 32 bits. */
static void attempt_points(uint64_t seed, uint64_t base, uint32_t attempt, size_t count,
                           const uint32_t open[], double x[], double y[])
{
    const uint32_t k0 = (uint32_t)seed, k1 = (uint32_t)(seed >> 32);
    for (size_t i = 0; i < count; i++) {
        const philox_words first = {{(uint32_t)base + open[i], (uint32_t)(base >> 32), attempt, 0}},
                           w = philox(first, k0, k1);
        x[i] = symmetric(w.at[0], w.at[1]), y[i] = symmetric(w.at[2], w.at[3]);
    }
}

/* Points first ... first + count - 1, of that weight.  All of a part that have no point yet make an attempt
 * together. */
static void random_points(uint64_t seed, uint64_t first, size_t count, sgt_pupil_point at[], double weight)
{
    enum { ATTEMPTS = 128, TOGETHER = 128 };
    uint32_t open[TOGETHER];
    double x[TOGETHER], y[TOGETHER];
    for (size_t begin = 0, part; begin < count; begin += part) {
        const uint64_t upto = UINT64_C(0x100000000) - (uint32_t)(first + begin);
        part = count - begin < TOGETHER ? count - begin : TOGETHER;
        if (part > upto) part = (size_t)upto;
        size_t left = part;
        for (size_t i = 0; i < left; i++) open[i] = (uint32_t)i;
        for (uint32_t attempt = 0; attempt < ATTEMPTS && left; attempt++) {
            size_t still = 0;
            attempt_points(seed, first + begin, attempt, left, open, x, y);
            for (size_t i = 0; i < left; i++) {
                const uint32_t k = open[i];
                at[begin + k] = (sgt_pupil_point){x[i], y[i], weight};
                open[still] = k, still += !in_circle(x[i], y[i]);
            }
            left = still;
        }
        for (size_t i = 0; i < left; i++) at[begin + open[i]] = (sgt_pupil_point){0, 0, weight};
    }
}

enum { SOBOL_RUN = 512, SOBOL_LEAST = 344, SOBOL_RUNS = 1 << 23 };
typedef struct sobol_run { double x[SOBOL_RUN], y[SOBOL_RUN]; } sobol_run;

/* All points of a run, in the circle or not.  A word w is w 2^-31 - 1, exactly. */
static void sobol_run_of(size_t run, sobol_run *out)
{
    uint32_t x[SOBOL_RUN] = {0}, y[SOBOL_RUN] = {0}, one = 1u << 31, two = 1u << 31;
    for (size_t have = 1; have < SOBOL_RUN; have *= 2, one >>= 1, two ^= two >> 1)
        for (size_t i = 0; i < have; i++) x[have + i] = x[i] ^ one, y[have + i] = y[i] ^ two;
    uint32_t high_x = 0x80000000u, high_y = 0x80000000u;
    for (uint32_t k = run % SOBOL_RUNS; k; k >>= 1, one >>= 1, two ^= two >> 1)
        if (k & 1) high_x ^= one, high_y ^= two;
    for (size_t i = 0; i < SOBOL_RUN; i++) {
        out->x[i] = (double)(int32_t)(x[i] ^ high_x) * 0x1p-31;
        out->y[i] = (double)(int32_t)(y[i] ^ high_y) * 0x1p-31;
    }
}

static size_t sobol_inside(size_t run)
{
    sobol_run p;
    size_t inside = 0;
    sobol_run_of(run, &p);
    for (size_t i = 0; i < SOBOL_RUN; i++) inside += in_circle(p.x[i], p.y[i]);
    return inside;
}

/* `count` points of that weight: those of the circle from a run on, without the first `skip`. */
static void sobol_points(size_t run, size_t skip, size_t count, sgt_pupil_point at[], double weight)
{
    for (size_t done = 0; done < count; run++) {
        sobol_run p;
        sobol_run_of(run, &p);
        for (size_t i = 0; i < SOBOL_RUN && done < count; i++) {
            if (!in_circle(p.x[i], p.y[i])) continue;
            if (skip) skip--;
            else at[done++] = (sgt_pupil_point){p.x[i], p.y[i], weight};
        }
    }
}

/* ---------------------------------------------------------------- patterns */

/* Quotients of whole numbers: the points are symmetric to the last bit. */
static double step_of_grid(size_t i, size_t n)
{
    double last = (double)(n - 1);
    return n > 1 ? (2 * (double)i - last) / last : 0;
}

static bool is_net(sgt_pattern pattern)
{
    return pattern == SGT_PATTERN_GRID || pattern == SGT_PATTERN_CELLS;
}

/* The i-th place of n along a side of the square. */
static double net_place(sgt_pattern pattern, size_t i, size_t n)
{
    if (pattern == SGT_PATTERN_GRID) return step_of_grid(i, n);
    return (2 * (double)i + 1 - (double)n) / (double)n;
}

static bool net_inside(sgt_pattern pattern, double x, double y)
{
    const double soft = 1 + 0x1p-44; /* of r^2, as for the library's rims */
    return x * x + y * y <= (pattern == SGT_PATTERN_GRID ? soft : 1);
}

/* How many points the row at x has (rows run along y), and the place of the first of them. */
static size_t net_row(sgt_pattern pattern, double x, size_t n, size_t *first)
{
    size_t in = n / 2, out = n; /* from the middle up */
    *first = 0;
    if (n == 0 || !net_inside(pattern, x, net_place(pattern, in, n))) return 0;
    while (out - in > 1) {
        const size_t middle = in + (out - in) / 2;
        *(net_inside(pattern, x, net_place(pattern, middle, n)) ? &in : &out) = middle;
    }
    *first = n - 1 - in;
    return in - *first + 1;
}

/* Of two more than twice as many the middle of the row stands alone. */
static size_t cross_count(size_t n) { return n ? 2 * n - n % 2 : 0; }

static size_t hexapolar_count(size_t n) { return 1 + 3 * n * (n + 1); }

static double hexapolar_weight(size_t j, size_t n)
{
    if (j == 0) return 0.25;
    double inner = (double)j - 0.5, outer = j < n ? (double)j + 0.5 : (double)j;
    return (outer * outer - inner * inner) / (6 * (double)j);
}

/* The ring of a point, of which 3 j (j - 1) + 1 have gone before. */
static size_t ring_of(size_t i)
{
    if (i == 0) return 0;
    size_t j = (size_t)sqrt((double)i / 3);
    while (j > 0 && 3 * j * (j - 1) >= i) j--;
    while (3 * j * (j + 1) < i) j++;
    return j;
}

/* The points first ... first + count - 1, at most PUPIL_PART of them. */
static void hexapolar_points(size_t first, size_t count, size_t n, sgt_pupil_point at[])
{
    double degrees[PUPIL_PART] = {0}, cosine[PUPIL_PART], sine[PUPIL_PART];
    size_t ring = ring_of(first);
    for (size_t k = 0, i = first; k < count; k++, i++) {
        if (i > 3 * ring * (ring + 1)) ring++;
        degrees[k] = ring ? 60 * (double)(i - 1 - 3 * ring * (ring - 1)) / (double)ring : 0;
    }
    sgt_turns(count, degrees, cosine, sine);
    ring = ring_of(first);
    double weight = hexapolar_weight(ring, n);
    for (size_t k = 0, i = first; k < count; k++, i++) {
        if (i > 3 * ring * (ring + 1)) ring++, weight = hexapolar_weight(ring, n);
        const double j = (double)ring, last = (double)n;
        at[k] = (sgt_pupil_point){cosine[k] * j / last, sine[k] * j / last, weight};
    }
}

static sgt_pupil_point cross_point(size_t i, size_t n)
{
    if (i < n) return (sgt_pupil_point){0, step_of_grid(i, n), 1};
    i -= n;
    return (sgt_pupil_point){step_of_grid(i + (n % 2 && i >= n / 2), n), 0, 1};
}

/* How many points a pattern has that is no net. */
static size_t count_of(sgt_pattern pattern, size_t n)
{
    return pattern == SGT_PATTERN_HEXAPOLAR ? hexapolar_count(n)
           : pattern == SGT_PATTERN_CROSS   ? cross_count(n)
                                            : n;
}

/* The sum of all weights, in their order. */
static double weight_of(sgt_pattern pattern, size_t n, size_t count)
{
    double sum = 0;
    if (pattern != SGT_PATTERN_HEXAPOLAR) return (double)count;
    for (size_t i = 0, j = 0; i < count; i++) {
        while (j < n && i > 3 * j * (j + 1)) j++;
        sum += hexapolar_weight(j, n);
    }
    return sum;
}

/* The i-th point of a pattern of which any point is as easy as any other, but for random ones. */
static sgt_pupil_point point_of(sgt_pattern pattern, size_t i, size_t n)
{
    switch (pattern) {
    case SGT_PATTERN_CROSS: return cross_point(i, n);
    default: return (sgt_pupil_point){0, step_of_grid(i, n), 1};
    }
}

size_t sgt_pupil_points(sgt_pattern pattern, size_t n, uint64_t seed, size_t most, sgt_pupil_point at[])
{
    size_t count = 0;
    for (size_t i = 0; i < n && is_net(pattern); i++) {
        const double x = net_place(pattern, i, n);
        size_t first, many = net_row(pattern, x, n, &first);
        for (size_t j = 0; j < many && count + j < most; j++)
            at[count + j] = (sgt_pupil_point){x, net_place(pattern, first + j, n), 1};
        count += many;
    }
    if (!is_net(pattern)) count = count_of(pattern, n);
    const size_t kept = count < most ? count : most;
    const bool random = pattern == SGT_PATTERN_RANDOM, hexapolar = pattern == SGT_PATTERN_HEXAPOLAR;
    const bool sobol = pattern == SGT_PATTERN_SOBOL;
    if (random) random_points(seed, 0, kept, at, 1 / (double)kept);
    for (size_t i = 0; i < kept && hexapolar; i += PUPIL_PART)
        hexapolar_points(i, kept - i < PUPIL_PART ? kept - i : PUPIL_PART, n, at + i);
    if (sobol) sobol_points(0, 0, kept, at, 1);
    for (size_t i = 0; i < kept && !is_net(pattern) && !random && !hexapolar && !sobol; i++) {
        at[i] = point_of(pattern, i, n);
        at[i].weight = 1;
    }
    const double sum = weight_of(pattern, n, kept);
    for (size_t i = 0; i < kept && !random; i++) at[i].weight /= sum;
    return count;
}

/* ------------------------------------------------------------------ in parts */

void sgt_pupil_random(size_t n, uint64_t seed, size_t first, size_t count, sgt_pupil_point at[])
{
    random_points(seed, first, count, at, 1 / (double)n);
}

size_t sgt_pupil_rows(sgt_pattern pattern, size_t n)
{
    return is_net(pattern) ? n + 1 : pattern == SGT_PATTERN_SOBOL ? n / SOBOL_LEAST + 2 : 0;
}

sgt_pupil sgt_pupil_of(sgt_pattern pattern, size_t n, uint64_t seed, size_t row[])
{
    sgt_pupil p = {.pattern = pattern, .n = n, .seed = seed, .count = count_of(pattern, n), .row = row};
    const size_t rows = sgt_pupil_rows(pattern, n);
    if (is_net(pattern)) {
        p.count = 0;
        for (size_t i = 0, first; i < n; i++)
            row[i] = p.count, p.count += net_row(pattern, net_place(pattern, i, n), n, &first);
        row[n] = p.count;
    }
    for (size_t i = 0, before = 0; i < rows && pattern == SGT_PATTERN_SOBOL; i++) {
        row[i] = before;
        if (before < n) before += sobol_inside(i);
    }
    p.sum = weight_of(pattern, n, p.count);
    return p;
}

/* At most PUPIL_PART of them (of the random ones and Sobol's any number). */
static void part_of(const sgt_pupil *p, size_t first, size_t count, sgt_pupil_point at[])
{
    size_t low = 0, high = sgt_pupil_rows(p->pattern, p->n), row_first = 0, row_end = 0, begin = 0;
    double x = 0;
    if (p->given) {
        for (size_t i = 0; i < count; i++) at[i] = p->given[first + i];
        return;
    }
    if (p->pattern == SGT_PATTERN_RANDOM) {
        random_points(p->seed, first, count, at, 1 / p->sum);
        return;
    }
    if (high) high--;
    while (high - low > 1) { /* row[low] <= first < row[high] */
        const size_t middle = low + (high - low) / 2;
        *(p->row[middle] <= first ? &low : &high) = middle;
    }
    if (p->pattern == SGT_PATTERN_SOBOL) {
        sobol_points(low, first - p->row[low], count, at, 1 / p->sum);
        return;
    }
    if (p->pattern == SGT_PATTERN_HEXAPOLAR) {
        hexapolar_points(first, count, p->n, at);
        for (size_t i = 0; i < count; i++) at[i].weight /= p->sum;
        return;
    }
    for (size_t i = first; i < first + count; i++) {
        sgt_pupil_point *to = &at[i - first];
        if (is_net(p->pattern)) {
            if (i >= row_end) {
                while (p->row[low + 1] <= i) low++;
                x = net_place(p->pattern, low, p->n), row_first = p->row[low], row_end = p->row[low + 1];
                net_row(p->pattern, x, p->n, &begin);
            }
            *to = (sgt_pupil_point){x, net_place(p->pattern, begin + (i - row_first), p->n), 1};
        } else {
            *to = point_of(p->pattern, i, p->n);
        }
        to->weight = 1 / p->sum;
    }
}

void sgt_pupil_part(const sgt_pupil *p, size_t first, size_t count, sgt_pupil_point at[])
{
    for (size_t done = 0, part; done < count; done += part) {
        const size_t left = PUPIL_PART - (first + done) % PUPIL_PART;
        part = count - done < left ? count - done : left;
        part_of(p, first + done, part, at + done);
    }
    for (size_t i = 0; i < count && p->equal; i++) at[i].weight = 1 / (double)p->count;
}
