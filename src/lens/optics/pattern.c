/* pattern.c - points in the unit circle of a pupil, the same bits on every system.
 *
 * What makes them is integers, sums, products and quotients; the cosines of a hexapolar pattern
 * are those of sgt_pose_tilted, whose bits are the library's own.
 *
 * RANDOM.  Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, Parallel random numbers: as easy as
 * 1, 2, 3, SC'11, section 5.3) turns a counter and a key into 128 bits that look random.  The
 * counter is the number of the point and of the attempt, the key is the seed: so a point depends
 * on no other.  Two numbers in [-1, 1] make a point of the square; if it lies outside the circle
 * the next attempt is made.  128 attempts fail with a chance of 2^-285.
 *
 * SOBOL.  The first two dimensions of Sobol's sequence (1967): the digits of the number reversed,
 * and that with the direction numbers of the polynomial x + 1, v_i = v_{i-1} xor v_{i-1} / 2.
 * The points of the square that lie in the circle are taken in their order.
 *
 * HEXAPOLAR.  Ring j of n has the radius j / n and 6 j points.  Weights are areas: a ring stands
 * for what is nearer to it than to the next. */
#include <sagitta/lens.h>

#include <math.h>
#include <stdint.h>

/* -------------------------------------------------------------- generators */

void sgt_philox(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
    enum { ROUNDS = 10 };
    const uint32_t first = 0xD2511F53u, second = 0xCD9E8D57u, weyl[2] = {0x9E3779B9u, 0xBB67AE85u};
    uint32_t x[4] = {counter[0], counter[1], counter[2], counter[3]}, k[2] = {key[0], key[1]};
    for (int i = 0; i < ROUNDS; i++) {
        uint64_t a = (uint64_t)first * x[0], b = (uint64_t)second * x[2];
        const uint32_t next[4] = {(uint32_t)(b >> 32) ^ x[1] ^ k[0], (uint32_t)b,
                                  (uint32_t)(a >> 32) ^ x[3] ^ k[1], (uint32_t)a};
        for (int j = 0; j < 4; j++) x[j] = next[j];
        k[0] += weyl[0], k[1] += weyl[1];
    }
    for (int j = 0; j < 4; j++) out[j] = x[j];
}

/* [-1, 1), symmetric about 0: the middles of 2^53 parts. */
static double symmetric(uint32_t high, uint32_t low)
{
    uint64_t bits = ((uint64_t)high << 32 | low) >> 11;
    return ((double)bits + 0.5) * 0x1p-52 - 1;
}

static bool in_circle(double x, double y) { return x * x + y * y <= 1; }

static sgt_pupil_point random_point(uint64_t seed, size_t i)
{
    enum { ATTEMPTS = 128 };
    const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    for (uint32_t attempt = 0; attempt < ATTEMPTS; attempt++) {
        const uint32_t counter[4] = {(uint32_t)i, (uint32_t)((uint64_t)i >> 32), attempt, 0};
        uint32_t bits[4];
        sgt_philox(counter, key, bits);
        double x = symmetric(bits[0], bits[1]), y = symmetric(bits[2], bits[3]);
        if (in_circle(x, y)) return (sgt_pupil_point){x, y, 0};
    }
    return (sgt_pupil_point){0, 0, 0};
}

/* The k-th of the square, k < 2^32. */
static sgt_pupil_point sobol_point(uint32_t k)
{
    uint32_t x = 0, y = 0, one = 1u << 31, two = 1u << 31;
    for (; k; k >>= 1, one >>= 1, two ^= two >> 1)
        if (k & 1) x ^= one, y ^= two;
    return (sgt_pupil_point){x * 0x1p-31 - 1, y * 0x1p-31 - 1, 0};
}

/* ---------------------------------------------------------------- patterns */

typedef struct points { sgt_pupil_point *at; size_t most, count; } points;

static void add_point(points *p, double x, double y, double weight)
{
    if (p->count < p->most) p->at[p->count] = (sgt_pupil_point){x, y, weight};
    p->count++;
}

/* Quotients of whole numbers: the points are symmetric to the last bit. */
static double step_of_grid(size_t i, size_t n)
{
    double last = (double)(n - 1);
    return n > 1 ? (2 * (double)i - last) / last : 0;
}

static void add_grid(points *p, size_t n)
{
    const double soft = 1 + 0x1p-44; /* of r^2, as for the library's rims */
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double x = step_of_grid(i, n), y = step_of_grid(j, n);
            if (x * x + y * y <= soft) add_point(p, x, y, 1);
        }
}

static void add_cells(points *p, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double x = (2 * (double)i + 1 - (double)n) / (double)n,
                   y = (2 * (double)j + 1 - (double)n) / (double)n;
            if (x * x + y * y <= 1) add_point(p, x, y, 1);
        }
}

static void add_cross(points *p, size_t n)
{
    for (size_t i = 0; i < n; i++) add_point(p, 0, step_of_grid(i, n), 1);
    for (size_t i = 0; i < n; i++)
        if (step_of_grid(i, n) != 0) add_point(p, step_of_grid(i, n), 0, 1);
}

static void add_hexapolar(points *p, size_t n)
{
    add_point(p, 0, 0, 0.25);
    for (size_t j = 1; j <= n; j++) {
        double inner = (double)j - 0.5, outer = j < n ? (double)j + 0.5 : (double)j;
        double weight = (outer * outer - inner * inner) / (6 * (double)j);
        for (size_t k = 0; k < 6 * j; k++) {
            sgt_vec3 turn = {0, 0, 60 * (double)k / (double)j};
            sgt_vec3 ex = sgt_pose_tilted((sgt_vec3){0, 0, 0}, turn).ex;
            if (k == 0) ex = (sgt_vec3){1, 0, 0};
            add_point(p, ex.x * (double)j / (double)n, ex.y * (double)j / (double)n, weight);
        }
    }
}

static void add_sobol(points *p, size_t n)
{
    uint32_t k = 0;
    while (p->count < n && k < UINT32_MAX) {
        sgt_pupil_point s = sobol_point(++k);
        if (in_circle(s.x, s.y)) add_point(p, s.x, s.y, 1);
    }
}

size_t sgt_pupil_points(sgt_pattern pattern, size_t n, uint64_t seed, size_t most, sgt_pupil_point at[])
{
    points p = {.at = at, .most = most};
    switch (pattern) {
    case SGT_PATTERN_FAN:
        for (size_t i = 0; i < n; i++) add_point(&p, 0, step_of_grid(i, n), 1);
        break;
    case SGT_PATTERN_GRID: add_grid(&p, n); break;
    case SGT_PATTERN_HEXAPOLAR: add_hexapolar(&p, n); break;
    case SGT_PATTERN_RANDOM:
        for (size_t i = 0; i < n; i++) {
            sgt_pupil_point r = i < most ? random_point(seed, i) : (sgt_pupil_point){0};
            add_point(&p, r.x, r.y, 1);
        }
        break;
    case SGT_PATTERN_SOBOL: add_sobol(&p, n); break;
    case SGT_PATTERN_CELLS: add_cells(&p, n); break;
    case SGT_PATTERN_CROSS: add_cross(&p, n); break;
    }
    double sum = 0;
    size_t kept = p.count < most ? p.count : most;
    for (size_t i = 0; i < kept; i++) sum += at[i].weight;
    for (size_t i = 0; i < kept; i++) at[i].weight /= sum;
    return p.count;
}
