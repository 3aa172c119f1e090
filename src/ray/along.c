// SPDX-License-Identifier: MIT
/* along.c - a departure P(x, y) of a polynomial, along a ray without a rim (along.h).
 *
 * Along a ray P is a polynomial of one variable, whose degree n the type knows.  So some n + 1 values of P
 * say everything about it, all the way to where the base ends or beyond all bounds.  What is left is a
 * question about one polynomial, which takes no further look.
 *
 * THE LINE.  Let x and y be w (l, m) / sqrt(l^2 + m^2) from the point nearest the axis, z = z0 + g w, w = W
 * v. W is at least 1.02 times the ray's distance from the axis, so that r <= W sqrt(1 + v^2).
 *
 * THE PROJECTIVE LINE.  (1 + v^2)^(-n/2) P is the value at a unit vector (h, k), v = k / h, of a
 * homogeneous polynomial of degree n.  By `size` the greatest such value is meant.  With v = tan phi it is
 * a sum of the cosines and sines of n phi, (n - 2) phi, ...  So n is made odd, N = n + 1 = 2 m, and P is
 * asked for at the N nodes v = +-tan((j + 1/2) pi / N), which are evenly spaced in phi.
 *
 * THE COEFFICIENTS p(v) = sum of c_k v^k interpolate these values.  Even and odd powers are apart: each is
 * a polynomial of v^2 with m nodes, by Lagrange's formula.  The product of v^2 - node is, up to its scale,
 * the real part of (1 + i v)^N, whose coefficients are binomial ones.  A factor is divided out from
 * whichever end is stable.
 *
 * HOW FAR p IS OFF is not derived from how it was made.  p - P is a polynomial of degree n, of which a
 * bound at each node is computed: |p - P| there as computed, with the rounding of both.  The polynomial
 * that interpolates at N evenly spaced nodes of the circle is nowhere greater than 1 + (2 / pi) log N times
 * what it interpolates (Gronwall 1921; Rivlin, The Chebyshev Polynomials, 1974): at most 3.4 here; SPREAD
 * is above that.  That gives the size E of p - P.
 *
 * THE ROUNDING OF P at a node at r: its noise within r, and its gradient within r times how far the point
 * asked for is from the node.  Both are those of the whole circle of that radius, so one number holds for
 * all rays that have the same W.  Terms that differ much between directions have a noise of their own along
 * each line (departure.h).  There the gradient is that at the nodes, and 2^-24 of the circle's, which is more
 * than it may differ in 128 u of r: a polynomial of degree n has at most n^(3/2) times its size per r, next
 * to the edge of the circle.
 *
 * BERNSTEIN'S FORM over [va, vb]: coefficient i is the polar form of p with n - i arguments (1, va) and i
 * arguments (1, vb), so P is a mean of them.  For unit vectors the polar form of a homogeneous polynomial
 * is at most its size (Banach 1938, Studia Math. 7, 36).  So p - P changes coefficient i by at most E (1 +
 * va^2)^((n - i)/2) (1 + vb^2)^(i/2).  In this form the step from [0, infinity), where the coefficients are
 * b_k = c_k over the binomial coefficient, to [va, vb] is two triangles of sums:
 *
 *     (1, vb) = (1, 0) + vb (0, 1),    (1, va) = (1 - va / vb) (1, 0) + (va / vb) (1, vb).
 *
 * A row of the two rounds an entry by at most 1 and 4 u of what the triangle makes of the magnitudes, and
 * there are n rows.  With |b_k| <= B the magnitudes are at most B (1 + va)^(n - i) (1 + vb)^i, and at most
 * the sum of |c_k| vb^k, which is asked of many terms.  Where vb is infinite, (0, 1) stays as it is, and
 * its weight is 1.
 *
 * THE BASE along a line is convex if c > 0 (its second derivative lies between c and c / phi^3),
 * concave if c < 0.  So it is on one side of its chord, and on the other side of its tangent in the middle.
 * Both are linear, as z is.  Over a stretch without an end it is between 0 and c r^2.  What z and the base
 * are rounded by is less than 2^-40 of their terms, or where the base ends 2^-20; so much is added.
 *
 * CLEAR.  If all coefficients of z - base - P have the same sign, with all that is added, F has it all over
 * [va, vb].  If those of its derivative have, there is one root at most, and F at the ends tells whether.
 * Else the stretch is halved, in phi, and its nearer half is asked first.  If F has unlike signs at its ends,
 * it is cut next to where p has a root instead.
 *
 * THE ROOT is looked for on p, and what is reported is a short stretch about it, well inside of that in
 * which F is monotone.  (Newton's steps may end at no other root than the only one.)
 *
 * COST.  N values of P, some 2 N^2 operations for the coefficients, and N^2 for each stretch.  A stretch
 * counts as one evaluation, as an enclosure does. */
#include "along.h"

#include "../surface/departure/departure.h"
#include "wings.h"

#include <sagitta/interval.h>

/* At least half of the greatest number of nodes; rays at a time; stretches of one ray; those that wait. */
enum {
    ALONG_HALF = 20,
    ALONG_MOST = 2 * ALONG_HALF,
    WIDE = ALONG_ROWS,
    ALONG_TRIALS = 48,
    ALONG_DEEP = 16,
    ALONG_SEEKS = 40,
    ALONG_ROOMS = 4,
    ALONG_GUESSES = 3,
    ALONG_FEW = 20 /* fewer terms round by little */
};
static const double SPREAD = 4;

/* (Loops of eight and four lanes are no kernels of exact.h: four do not fill the widest registers.) */
typedef double lane_row[WIDE];
#define EACH LANES for (size_t u = 0; u < WIDE; u++)

/* Stretches at a time: as the rays need one or many, a ray that is done gives its place to the next. */
enum { ABREAST = 4 };
typedef double look_row[ABREAST];
#define EACH_LOOK LANES for (size_t u = 0; u < ABREAST; u++)

/* The lines of some rays, each about its point nearest the axis, counted in v, and P along it. */
typedef struct lines {
    size_t half, n;                        /* nodes on either side; the degree, 2 half - 1 */
    double c, k1;                          /* the base */
    lane_row x, y, l, m;                   /* dx/dv = l, dy/dv = m */
    lane_row z, g;                         /* z = z0 + g v */
    lane_row W, t0, by, scale;             /* t = (t0 + by v) scale */
    lane_row E, B;                         /* the size of p - P; the greatest |b_k| */
    lane_row p[ALONG_MOST], b[ALONG_MOST]; /* c_k and b_k */
} lines;

/* The nodes v > 0 and their squares, and (1 + v^2)^(-n/2); rows are filled up to a multiple of 4. */
typedef struct nodes {
    double v[ALONG_HALF], v2[ALONG_HALF], weight[ALONG_HALF];
} nodes;

SGT_INLINE double along_power(double x, size_t n)
{
    double power = 1;
    for (; n; n >>= 1, x *= x)
        if (n & 1) power *= x;
    return power;
}

/* sin and cos of pi / N, N >= 4, by their series; then the nodes by turning. */
static void nodes_of(size_t half, nodes *e)
{
    const double pi = 0x1.921fb54442d18p+1, a = 0.25 * pi / (double)half, a2 = a * a;
    double s = 0, c = 0;
    for (int k = 10; k > 0; k--) {
        double i = 2 * k;
        s = (1 - s) * a2 / (i * (i + 1)), c = (1 - c) * a2 / (i * (i - 1));
    }
    s = a * (1 - s), c = 1 - c;
    const double turn_s = 2 * s * c, turn_c = (c - s) * (c + s);
    for (size_t j = 0; j < ALONG_HALF; j++) {
        bool in = j < half;
        e->v[j] = in ? s / c : 0, e->v2[j] = e->v[j] * e->v[j],
        e->weight[j] = in ? along_power(c, 2 * half - 1) : 0;
        double next = c * turn_c - s * turn_s;
        s = s * turn_c + c * turn_s, c = next;
    }
}

/* At most how far P may be off within a radius, by its own rounding and by 2^-46 of the radius in x and y. */
static double off_within(const departure *of, const void *self, double radius)
{
    if (of->along_off) return of->along_off(self, radius);
    region where = {{-radius, radius}, {-radius, radius}, 0, radius};
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    double noise[2] = {(double)NAN, (double)NAN};
    of->noise(self, radius, noise);
    if (of->bounds(self, &where, &b) != 1) return HUGE_VAL;
    return noise[0] + noise[1] * radius * radius + 0x1p-46 * radius * b.steep;
}

/* At most how far P may be off at the nodes for a line of this W, by its own rounding and by that of the
 * points, times their weights.  These are off by 12 u of r at most.  For an even P those on the other side
 * are not asked, and the nearest point may be 2^-48 W from where it is taken to be. */
static double rounding_at_nodes(sgt_surface s, size_t half, double W, bool *known)
{
    const departure *of = s.ops->own_->departure;
    nodes e;
    nodes_of(half, &e);
    double most = 0, within = 0, off = 0;
    const double room = 1 + 1 / (double)(2 * half);
    for (size_t j = 0; j < half; j++) {
        double r = W * sqrt(1 + e.v2[j]) * (1 + 0x1p-10);
        if (!(r <= within)) {
            within = r * room;
            off = off_within(of, s.self, within);
        }
        most = larger(most, off * e.weight[j]);
        if (!(off < HUGE_VAL)) most = HUGE_VAL;
    }
    *known = most < HUGE_VAL;
    return 1.01 * most + 0x1p-1000;
}

/* The same from its place. */
static double rounding_about(sgt_surface s, size_t half, double W, vicinities *kept)
{
    if (!kept->any_along)
        for (int i = 0; i < ALONGS; i++) kept->along[i][0] = 0;
    kept->any_along = true;
    double *e = kept->along[place_of(W, FINE, ALONGS)];
    if (e[0] != W) {
        bool known;
        e[0] = W, e[1] = rounding_at_nodes(s, half, W, &known);
        if (!known) e[1] = HUGE_VAL;
    }
    return e[1];
}

/* --------------------------------------------------------------------------- coefficients */

/* q[k][j]: the coefficient of v^2k in the polynomial of v^2 that is 1 at node j and 0 at the others. */
SGT_NOINLINE
static void lagrange(size_t half, const nodes *e, double q[ALONG_HALF][ALONG_HALF])
{
    double of[ALONG_HALF + 1], by[ALONG_HALF], sum[ALONG_HALF], binomial = 1;
    for (size_t k = 0; k <= half; k++) { /* that of v^2k in the real part of (1 + i v)^N */
        double i = (double)(2 * k), top = (double)(2 * half);
        of[k] = k % 2 ? -binomial : binomial;
        binomial = binomial * ((top - i) * (top - i - 1)) / ((i + 1) * (i + 2));
    }
    const size_t low = half / 2; /* the nodes before are below 1 */
    LANES for (size_t j = 0; j < low; j++) q[half - 1][j] = of[half];
    for (size_t k = half - 1; k > 0; k--)
        LANES for (size_t j = 0; j < low; j++) q[k - 1][j] = sgt_fma(e->v2[j], q[k][j], of[k]);
    LANES for (size_t j = low; j < half; j++) by[j] = 1 / e->v2[j], q[0][j] = -of[0] * by[j];
    for (size_t k = 1; k < half; k++)
        LANES for (size_t j = low; j < half; j++) q[k][j] = (q[k - 1][j] - of[k]) * by[j];
    LANES for (size_t j = 0; j < half; j++) sum[j] = 0;
    for (size_t k = half; k-- > 0;)
        LANES for (size_t j = 0; j < half; j++) sum[j] = sgt_fma(e->v2[j], sum[j], q[k][j]);
    LANES for (size_t j = 0; j < half; j++) sum[j] = 1 / sum[j];
    for (size_t k = 0; k < half; k++) LANES for (size_t j = 0; j < half; j++) q[k][j] *= sum[j];
}

/* c_k of the polynomials of these values at +v, and behind them at -v. */
SGT_NOINLINE
static void interpolate(const nodes *at, double q[ALONG_HALF][ALONG_HALF], lane_row *value, lines *e)
{
    const size_t half = e->half;
    lane_row *even = e->b, *odd = e->b + half;
    for (size_t j = 0; j < half; j++) {
        const double *one = value[j], *other = value[half + j], by = 0.5 / at->v[j];
        EACH even[j][u] = 0.5 * (one[u] + other[u]), odd[j][u] = by * (one[u] - other[u]);
    }
    for (size_t k = 0; k < half; k++) {
        lane_row a, b;
        EACH a[u] = b[u] = 0;
        for (size_t j = 0; j < half; j++) {
            const double w = q[k][j];
            EACH a[u] = sgt_fma(w, even[j][u], a[u]), b[u] = sgt_fma(w, odd[j][u], b[u]);
        }
        EACH e->p[2 * k][u] = a[u], e->p[2 * k + 1][u] = b[u];
    }
}

/* The greatest weighted |p - P| at the nodes, with the rounding of Horner's rule. */
SGT_NOINLINE
static void misses_by(const nodes *at, lane_row *value, const lines *e, lane_row most)
{
    const size_t half = e->half;
    const double rounded = (double)(2 * e->n + 8) * SGT_U;
    EACH most[u] = 0;
    for (size_t j = 0; j < half; j++) {
        const double v2 = at->v2[j], v = at->v[j], weight = at->weight[j], *one = value[j],
                     *other = value[half + j];
        lane_row even, odd, size, more;
        EACH even[u] = odd[u] = size[u] = more[u] = 0;
        for (size_t k = half; k-- > 0;) EACH
            {
                double a = e->p[2 * k][u], b = e->p[2 * k + 1][u];
                even[u] = sgt_fma(v2, even[u], a), odd[u] = sgt_fma(v2, odd[u], b);
                size[u] = sgt_fma(v2, size[u], fabs(a)), more[u] = sgt_fma(v2, more[u], fabs(b));
            }
        EACH
        {
            double o = v * odd[u], a = fabs(even[u] + o - one[u]), b = fabs(even[u] - o - other[u]),
                   off = (a > b ? a : b) + rounded * (size[u] + v * more[u]), by = off * weight;
            most[u] = chosen(MASK(by <= most[u]), most[u], by); /* NaN stays */
        }
    }
}

/* b_k, and the greatest magnitude. */
SGT_NOINLINE
static void scale_by_binomial(lines *e)
{
    double binomial = 1;
    EACH e->B[u] = 0;
    for (size_t k = 0; k <= e->n; k++) {
        const double by = 1 / binomial;
        EACH
        {
            double b = e->p[k][u] * by, size = fabs(b);
            e->b[k][u] = b, e->B[u] = chosen(MASK(size <= e->B[u]), e->B[u], size);
        }
        binomial = binomial * (double)(e->n - k) / (double)(k + 1);
    }
}

/* Adds to the greatest weighted gradient, times r / W, at this node. */
static void gradients(const nodes *at, size_t node, size_t count, const double *px, const double *py,
                      double *most)
{
    const double by = at->weight[node] * sqrt(1 + at->v2[node]);
    for (size_t u = 0; u < count; u++) {
        double here = by * (fabs(px[u]) + fabs(py[u]));
        if (!(here <= most[u])) most[u] = here;
    }
}

/* The greatest weighted noise along each line by itself.  A node where r is not much greater than before is
 * taken to be as far as the next that is asked for. */
static void noise_along(const departure *of, const void *self, const nodes *at, const lines *e, lane_row most)
{
    const double room = 1 + 1 / (double)(2 * e->half);
    EACH most[u] = 0;
    for (size_t j = 0, next; j < e->half; j = next) {
        lane_row x, y, noise;
        const double least = 1 + at->v2[j];
        for (next = j + 1; next < e->half && 1 + at->v2[next] < least * room * room; next++) {
        }
        const double v = at->v[next - 1] * (1 + 0x1p-40), weight = at->weight[j];
        EACH x[u] = fabs(e->x[u]) + v * fabs(e->l[u]), y[u] = fabs(e->y[u]) + v * fabs(e->m[u]);
        of->along_noise(self, x, y, noise);
        EACH
        {
            double here = weight * noise[u];
            most[u] = chosen(MASK(here <= most[u]), most[u], here);
        }
    }
}

/* P along the lines. */
SGT_NOINLINE static void ask_along(sgt_surface s, bool both, size_t count, const lane_row rounding, lines *e)
{
    const size_t group = DEPARTURE_BLOCK / count;
    const departure *of = s.ops->own_->departure;
    const size_t half = e->half;
    nodes at;
    lane_row value[ALONG_MOST], off, turned;
    nodes_of(half, &at);
    EACH turned[u] = 0;
    for (size_t i = 0, few; i < (both ? 2 * half : half); i += few) {
        double x[DEPARTURE_BLOCK], y[DEPARTURE_BLOCK], p[DEPARTURE_BLOCK], px[DEPARTURE_BLOCK],
            py[DEPARTURE_BLOCK];
        few = (both ? 2 * half : half) - i;
        few = few < group ? few : group;
        for (size_t j = 0; j < few; j++) {
            const double v = i + j < half ? at.v[i + j] : -at.v[i + j - half];
            double *a = x + j * count, *b = y + j * count;
            LANES for (size_t u = 0; u < count; u++) a[u] = e->x[u] + v * e->l[u],
                                                     b[u] = e->y[u] + v * e->m[u];
        }
        of->at(s.self, few * count, x, y, (sag_values){p, px, py});
        for (size_t j = 0; j < few; j++)
            for (size_t u = 0; u < WIDE; u++) value[i + j][u] = p[j * count + (u < count ? u : 0)];
        if (of->along_noise)
            for (size_t j = 0; j < few; j++)
                gradients(&at, (i + j) % half, count, px + j * count, py + j * count, turned);
    }
    if (!both) memcpy(value + half, value, half * sizeof *value);
    double q[ALONG_HALF][ALONG_HALF];
    lagrange(half, &at, q);
    interpolate(&at, q, value, e);
    scale_by_binomial(e);
    misses_by(&at, value, e, off);
    if (of->along_noise) {
        lane_row noise;
        noise_along(of, s.self, &at, e, noise);
        EACH off[u] += noise[u] + 0x1.1p-46 * e->W[u] * turned[u] + 0x1p-24 * rounding[u];
    } else
        EACH off[u] += rounding[u];
    EACH e->E[u] = SPREAD * (1 + 0x1p-40) * off[u];
}

/* -------------------------------------------------------------------------- stretches */

/* A stretch of each line: side * v, v in [va, vb], and what it says of F. */
typedef struct stretches {
    size_t ray[ABREAST];
    look_row x, y, l, m, z, g, E, B; /* of that ray */
    look_row side, va, vb;
    look_row low_a, low_b, high_a, high_b, slope_lo, slope_hi; /* z - base */
    look_row f_lo, f_hi, lo, hi;                               /* F, and its slope by v */
    look_row a_lo, a_hi, b_lo, b_hi;                           /* F at the ends */
    look_row p[ALONG_MOST];                                    /* coefficient i at n - i */
} stretches;

/* How far coefficient i may be off: first * by^i + second * more^i. */
typedef struct fade {
    double first, by, second, more;
} fade;

SGT_INLINE fade fade_of(const lines *e, const stretches *s, size_t u)
{
    const double va = s->va[u], vb = s->vb[u];
    const bool ends = vb < HUGE_VAL;
    double wa = sqrt(1 + va * va), wb = ends ? sqrt(1 + vb * vb) : 1, sa = 1 + va, sb = ends ? 1 + vb : 1,
           round = 6.06 * (double)(e->n + 1) * SGT_U * s->B[u];
    return (fade){1.01 * s->E[u] * along_power(wa, e->n), wb / wa, 1.01 * round * along_power(sa, e->n),
                  sb / sa};
}

SGT_NOINLINE
static void bernstein(const lines *e, stretches *s)
{
    const size_t n = e->n;
    look_row h, k, rest, part;
    EACH_LOOK
    {
        double va = s->va[u], vb = s->vb[u];
        mask ends = MASK(vb < HUGE_VAL);
        h[u] = chosen(ends, 1, 0), k[u] = chosen(ends, vb, 1);
        double over = 1 / vb, some = va * over, others = (vb - va) * over;
        part[u] = chosen(ends, some, va), rest[u] = chosen(ends, others, 1);
    }
    for (size_t i = 0; i <= n; i++) {
        double *a = s->p[n - i];
        const double *b = e->b[i];
        for (size_t u = 0; u < ABREAST; u++) a[u] = b[s->ray[u]];
        if (i % 2) EACH_LOOK a[u] *= s->side[u];
    }
    for (size_t r = n; r > 0; r--)
        for (size_t i = 0; i < r; i++)
            EACH_LOOK s->p[i][u] = sgt_fma(k[u], s->p[i][u], h[u] * s->p[i + 1][u]);
    for (size_t r = n; r > 0; r--)
        for (size_t i = n; i > n - r; i--)
            EACH_LOOK s->p[i][u] = sgt_fma(part[u], s->p[i - 1][u], rest[u] * s->p[i][u]);
}

/* The most that rounding does to a coefficient: 6 (n + 1) u of the sum of |c_k| vb^k. */
SGT_NOINLINE
static void rounding_caps(const lines *e, const stretches *s, look_row cap)
{
    const double most = 6.13 * (double)(e->n + 1) * SGT_U;
    EACH_LOOK cap[u] = 0;
    for (size_t k = e->n + 1; k-- > 0;) {
        const double *p = e->p[k];
        look_row size;
        for (size_t u = 0; u < ABREAST; u++) size[u] = fabs(p[s->ray[u]]);
        EACH_LOOK cap[u] = sgt_fma(cap[u], s->vb[u], size[u]);
    }
    EACH_LOOK cap[u] = chosen(MASK(s->vb[u] < HUGE_VAL), cap[u] * most, HUGE_VAL);
}

/* The base at side * v: bounds on it, and on its slope by v; `sharp` if the latter is bounded. */
typedef struct base_along {
    double lo, hi, slope, off;
    mask sharp;
} base_along;

SGT_INLINE base_along base_at_v(double c, double k1, double x0, double y0, double l, double m, double v)
{
    double x = x0 + v * l, y = y0 + v * m, cr2 = c * (x * x + y * y), in = k1 * c * cr2, phi2 = 1 - in,
           off = 0x1p-40 * (1 + fabs(in));
    double a = cr2 / (1 + sqrt(larger(phi2 + off, 0))), b = cr2 / (1 + sqrt(larger(phi2 - off, 0)));
    mask sharp = MASK(phi2 > 0x1p-10), hollow = MASK(c < 0);
    double slack = chosen(sharp, 0x1p-40, 0x1p-20) * fabs(b), over = c / sqrt(larger(phi2, 0x1p-10));
    return (base_along){chosen(hollow, b, a) - slack, chosen(hollow, a, b) + slack, over * (x * l + y * m),
                        0x1p-28 * fabs(over) * (fabs(x * l) + fabs(y * m)), sharp};
}

/* Bounds on z - base at the ends of two lines, above and below it over the whole stretch, and on its slope.
 */
SGT_NOINLINE
static void rest_over(const lines *e, stretches *s)
{
    const double c = e->c, k1 = e->k1;
    EACH_LOOK
    {
        double x = s->x[u], y = s->y[u], l = s->l[u], m = s->m[u], g = s->g[u], z = s->z[u],
               a = s->side[u] * s->va[u], b = s->side[u] * s->vb[u], za = z + g * a, zb = z + g * b,
               off = 0x1p-40 * (fabs(z) + fabs(g) * s->vb[u]);
        base_along sa = base_at_v(c, k1, x, y, l, m, a), sb = base_at_v(c, k1, x, y, l, m, b),
                   sm = base_at_v(c, k1, x, y, l, m, 0.5 * (a + b));
        double half = 0.5 * (b - a), bent = fabs(half) * (sm.off + 0x1p-40 * fabs(sm.slope)),
               rise = sm.slope * half;
        /* c > 0: above its tangent, or 0, below its chord; c < 0: the other way; c == 0: both are 0 */
        mask up = MASK(c > 0), there = sm.sharp & MASK(c != 0);
        double edge = chosen(up, sm.lo - bent, sm.hi + bent), ta = chosen(there, edge - rise, 0),
               tb = chosen(there, edge + rise, 0), ca = chosen(up, sa.hi, sa.lo),
               cb = chosen(up, sb.hi, sb.lo);
        s->low_a[u] = za - chosen(up, ca, ta) - off, s->low_b[u] = zb - chosen(up, cb, tb) - off;
        s->high_a[u] = za - chosen(up, ta, ca) + off, s->high_b[u] = zb - chosen(up, tb, cb) + off;
        double a_lo = sa.slope - sa.off, b_lo = sb.slope - sb.off, a_hi = sa.slope + sa.off,
               b_hi = sb.slope + sb.off, lost = 0x1p-40 * fabs(g);
        mask sharp = sa.sharp & sb.sharp;
        s->slope_lo[u] = chosen(sharp, g - larger(a_hi, b_hi) - lost, -HUGE_VAL);
        s->slope_hi[u] = chosen(sharp, g + larger(-a_lo, -b_lo) + lost, HUGE_VAL);
    }
}

/* The range of the coefficients of z - base - P and of its derivative, each with all that it may be off. */
SGT_NOINLINE
static void ranges(const lines *e, stretches *s)
{
    const size_t n = e->n;
    const double step = 1 / (double)n;
    look_row first, by, second, more, least, most, least_d, most_d, was, was_off, a, b, da, db, at_a, cap;
    EACH_LOOK cap[u] = HUGE_VAL;
    if (n > ALONG_FEW) rounding_caps(e, s, cap);
    for (size_t u = 0; u < ABREAST; u++) {
        fade w = fade_of(e, s, u);
        first[u] = w.first, by[u] = w.by, second[u] = w.second, more[u] = w.more;
        at_a[u] = w.first + (w.second < cap[u] ? w.second : cap[u]);
    }
    EACH_LOOK
    {
        least[u] = most[u] = least_d[u] = most_d[u] = -HUGE_VAL, was[u] = s->p[n][u], was_off[u] = 0;
        a[u] = s->low_a[u], da[u] = (s->low_b[u] - s->low_a[u]) * step, b[u] = s->high_a[u],
        db[u] = (s->high_b[u] - s->high_a[u]) * step;
    }
    for (size_t i = 0; i <= n; i++) {
        const double at = (double)i, *p = s->p[n - i], not_yet = i ? 0 : HUGE_VAL;
        EACH_LOOK
        {
            double err = first[u] + (second[u] < cap[u] ? second[u] : cap[u]),
                   low = p[u] - (a[u] + da[u] * at) + err, high = (b[u] + db[u] * at) - p[u] + err,
                   d = s->side[u] * (p[u] - was[u]),
                   off = err + was_off[u] + SGT_U * (fabs(p[u]) + fabs(was[u])) - not_yet;
            double d_low = d + off, d_high = off - d;
            least[u] = low > least[u] ? low : least[u], most[u] = high > most[u] ? high : most[u];
            least_d[u] = d_low > least_d[u] ? d_low : least_d[u],
            most_d[u] = d_high > most_d[u] ? d_high : most_d[u];
            was[u] = p[u], was_off[u] = err, first[u] *= by[u], second[u] *= more[u];
        }
    }
    EACH_LOOK
    {
        double all = fabs(s->low_a[u]) + fabs(s->low_b[u]) + fabs(s->high_a[u]) + fabs(s->high_b[u]),
               off = 0x1p-48 * all, width = s->vb[u] - s->va[u], scale = (double)n / width;
        double ends = was_off[u], begins = at_a[u] + off;
        s->f_lo[u] = -(least[u] + off), s->f_hi[u] = most[u] + off;
        double lo = least_d[u] * scale, hi = most_d[u] * scale;
        s->lo[u] = s->slope_lo[u] - lo - 0x1p-46 * fabs(lo),
        s->hi[u] = s->slope_hi[u] + hi + 0x1p-46 * fabs(hi);
        s->b_lo[u] = s->low_b[u] - s->p[0][u] - ends - off,
        s->b_hi[u] = s->high_b[u] - s->p[0][u] + ends + off;
        /* no number above is NaN */
        mask fine = MASK(all < 0x1p900) & MASK(ends < 0x1p900) & MASK(fabs(s->p[n][u]) < 0x1p900);
        s->f_lo[u] = chosen(fine, s->f_lo[u], -HUGE_VAL), s->f_hi[u] = chosen(fine, s->f_hi[u], HUGE_VAL);
        s->lo[u] = chosen(fine, s->lo[u], -HUGE_VAL), s->hi[u] = chosen(fine, s->hi[u], HUGE_VAL);
        s->a_lo[u] = s->low_a[u] - s->p[n][u] - begins, s->a_hi[u] = s->high_a[u] - s->p[n][u] + begins;
    }
}

/* The range of F over a stretch without an end: the coefficients of z, and of c r^2, beside those of P. */
static void range_to_infinity(const lines *e, stretches *s, size_t u)
{
    const double n = (double)e->n, va = s->va[u], side = s->side[u], a = side * va, l = s->l[u], m = s->m[u],
                 x = s->x[u] + a * l, y = s->y[u] + a * m, W2 = l * l + m * m,
                 z[3] = {s->z[u] + s->g[u] * a, side * s->g[u] / n, 0},
                 base[3] = {e->c * (x * x + y * y),
                            e->c * 2 * (W2 * va + fabs(s->x[u] * l + s->y[u] * m)) / n,
                            e->c * 2 * W2 / (n * (n - 1))};
    double least = HUGE_VAL, most = -HUGE_VAL, all = 0;
    fade w = fade_of(e, s, u);
    for (size_t i = 0; i <= e->n; i++, w.first *= w.by, w.second *= w.more) {
        double at = i < 3 ? z[i] : 0, more = i < 3 ? base[i] * (1 + 0x1p-20) : 0, p = s->p[e->n - i][u],
               terms = i == 0 ? fabs(s->z[u]) + fabs(s->g[u] * a) : fabs(at),
               off = w.first + w.second + 0x1p-40 * terms + 0x1p-48 * (fabs(more) + fabs(p));
        double low = at - larger(more, 0) - p - off, high = at + larger(-more, 0) - p + off;
        least = low < least ? low : least, most = larger(most, high), all += fabs(low) + fabs(high);
    }
    bool fine = all < 0x1p900;
    s->f_lo[u] = fine ? least : -HUGE_VAL, s->f_hi[u] = fine ? most : HUGE_VAL;
    s->lo[u] = -HUGE_VAL, s->hi[u] = HUGE_VAL;
}

static void look_over(const lines *e, stretches *s)
{
    bernstein(e, s);
    rest_over(e, s);
    ranges(e, s);
    for (size_t u = 0; u < ABREAST; u++)
        if (!(s->vb[u] < HUGE_VAL)) range_to_infinity(e, s, u);
}

static bool stretch_clear(const stretches *s, size_t u)
{
    if (s->f_lo[u] > 0 || s->f_hi[u] < 0) return true;
    bool monotone = s->lo[u] > 0 || s->hi[u] < 0;
    return monotone && ((s->a_lo[u] > 0 && s->b_lo[u] > 0) || (s->a_hi[u] < 0 && s->b_hi[u] < 0));
}

/* Has F one root over the stretch, certainly? */
static bool has_root(const stretches *s, size_t u)
{
    bool monotone = s->lo[u] > 0 || s->hi[u] < 0;
    return monotone && ((s->a_lo[u] > 0 && s->b_hi[u] < 0) || (s->a_hi[u] < 0 && s->b_lo[u] > 0));
}

/* Half-way in phi; vb may be infinite. */
static double half_way(double va, double vb)
{
    double a = 1 / sqrt(1 + va * va), b = vb < HUGE_VAL ? 1 / sqrt(1 + vb * vb) : 0;
    return (va * a + (vb < HUGE_VAL ? vb * b : 1)) / (a + b);
}

/* F as p has it. */
static double along_value(const lines *e, size_t u, double v)
{
    base_along s = base_at_v(e->c, e->k1, e->x[u], e->y[u], e->l[u], e->m[u], v);
    double p = 0;
    for (size_t k = e->n + 1; k-- > 0;) p = sgt_fma(p, v, e->p[k][u]);
    return e->z[u] + e->g[u] * v - 0.5 * (s.lo + s.hi) - p;
}

/* Half the length of a stretch in which the slope is nearly what it is at its middle. */
static double room_about(const lines *e, double root) { return (1 + fabs(root)) / (8 * (double)e->n); }

/* Where p has the root between, within a quarter of its room: regula falsi with the end that stays halved
 * (Illinois), and bisection where that does not halve the bracket in two steps. */
static double root_between(const lines *e, size_t u, double a, double b)
{
    double fa = along_value(e, u, a), fb = along_value(e, u, b), v = 0.5 * (a + b), width = fabs(b - a);
    for (int i = 0; i < ALONG_SEEKS && width > 0.25 * room_about(e, v); i++) {
        v = b - fb * ((b - a) / (fb - fa));
        if (i % 3 == 2 && fabs(b - a) > 0.5 * width) v = 0.5 * (a + b);
        if (i % 3 == 2) width = fabs(b - a);
        if (!(fabs(v - 0.5 * (a + b)) < 0.5 * fabs(b - a))) v = 0.5 * (a + b);
        double f = along_value(e, u, v);
        if (signbit(f) == signbit(fb))
            fa *= 0.5;
        else
            a = b, fa = fb;
        b = v, fb = f;
        /* a step on either side of the root */
        double beyond = v + copysign(0.125 * room_about(e, v), a - v);
        if (fabs(beyond - v) < fabs(a - v) && fabs(f) < HUGE_VAL) {
            double g = along_value(e, u, beyond);
            if (signbit(g) != signbit(f)) return v - f * ((beyond - v) / (g - f));
            b = beyond, fb = g;
        } else
            break;
    }
    return b - fb * ((b - a) / (fb - fa));
}

/* ------------------------------------------------------------------------------ the way */

/* A ray on its way from `at` to `to`, in v: at how many stretches it has been looked; the ends of those that
 * wait, the nearest last.  In the end a stretch [from, until] that has a root, and where p has it. */
typedef struct walker {
    bool done;
    int trials, waiting, rooms, guesses;
    double begin, at, to, probe, from, until, root; /* root: also one that is guessed */
    double pending[ALONG_DEEP];
} walker;

/* Sets the stretch that is looked at next. */
static void aim(const walker *w, size_t u, const lines *e, stretches *s)
{
    double one = w->at, other = w->probe;
    if (w->rooms) {
        double room = room_about(e, w->root);
        for (int k = 1; k < w->rooms; k++) room *= 0.25;
        one = larger(w->root - room, w->from), other = w->root + room < w->until ? w->root + room : w->until;
    }
    bool negative = one < 0 || other < 0;
    s->side[u] = negative ? -1 : 1, s->va[u] = negative ? -other : one, s->vb[u] = negative ? -one : other;
}

/* The ray of lane u from now on. */
static void place_ray(const lines *e, size_t ray, stretches *s, size_t u)
{
    s->ray[u] = ray, s->x[u] = e->x[ray], s->y[u] = e->y[ray], s->l[u] = e->l[ray], s->m[u] = e->m[ray];
    s->z[u] = e->z[ray], s->g[u] = e->g[ray], s->E[u] = e->E[ray], s->B[u] = e->B[ray];
}

static void tell_trial(const vicinity *v, const lines *e, const stretches *s, size_t u)
{
    const size_t k = s->ray[u];
    double a = s->side[u] * s->va[u], b = s->side[u] * s->vb[u], one = e->t0[k] + (a < b ? a : b) * e->by[k],
           other = e->t0[k] + (a < b ? b : a) * e->by[k], by = 1 / (e->by[k] * e->scale[k]);
    tell_cell(v->told, SGT_MARCH, one * e->scale[k], other * e->scale[k],
              sgt_interval_between(s->f_lo[u], s->f_hi[u]),
              sgt_interval_between(s->lo[u] * by, s->hi[u] * by));
}

/* The answer for a stretch about the root: false: too little is known of it. */
static bool tell_stretch(const lines *e, const stretches *s, size_t u, double root, const vicinity *v,
                         size_t i)
{
    double least = s->lo[u] > 0 ? s->lo[u] : -s->hi[u], a = s->side[u] > 0 ? s->va[u] : -s->vb[u],
           b = s->side[u] > 0 ? s->vb[u] : -s->va[u], by = e->by[s->ray[u]], t0 = e->t0[s->ray[u]],
           scale = e->scale[s->ray[u]];
    if (!(least > 0 && least < HUGE_VAL)) return false;
    double inside = 0x1p-10 * (b - a), lo = t0 + (a + inside) * by, hi = t0 + (b - inside) * by,
           lost = 0x1p-44 * (fabs(t0) + fabs(a * by) + fabs(b * by) + by);
    if (!(lo + lost < hi - lost && inside * by > lost)) return false;
    v->lo[i] = lo * scale, v->hi[i] = hi * scale, v->seed[i] = (t0 + root * by) * scale;
    if (!(v->seed[i] > v->lo[i] && v->seed[i] < v->hi[i])) v->seed[i] = 0.5 * (v->lo[i] + v->hi[i]);
    v->least[i] = least / by * (1 - 0x1p-20), v->asked[i] = 0;
    return true;
}

/* Guesses where the root is that the last stretch has, as F has unlike signs at its ends: the next stretch
 * ends before it, or else behind it. */
static void guess_root(walker *w, const lines *e, const stretches *s, size_t u)
{
    w->root = root_between(e, s->ray[u], w->at, w->probe);
    double room = room_about(e, w->root);
    w->guesses++;
    if (w->root - room > w->at && w->root - room < w->probe)
        w->probe = w->root - room;
    else if (w->root + room > w->at && w->root + room < w->probe)
        w->probe = w->root + room;
    else
        w->probe = 0.5 * (w->at + w->probe);
}

/* What the last look says: the walker goes on, or is done. */
static along_says walk_on(walker *w, const lines *e, const stretches *s, size_t u, const vicinity *v,
                          size_t i)
{
    const along_says so_far = w->at > w->begin ? ALONG_CLEAR : ALONG_SILENT;
    if (w->rooms) {
        if (tell_stretch(e, s, u, w->root, v, i)) return w->done = true, ALONG_ROOT;
        w->done = ++w->rooms > ALONG_ROOMS;
        return so_far;
    }
    if (stretch_clear(s, u)) {
        w->at = w->probe;
        while (w->waiting && w->pending[w->waiting - 1] <= w->at) w->waiting--;
        if (!(w->at < w->to)) return w->done = true, ALONG_MISS;
        w->probe = w->waiting ? w->pending[w->waiting - 1] : w->at < 0 && w->to > 0 ? 0 : w->to;
        double behind = w->root + room_about(e, w->root);
        if (w->guesses && w->at < w->root && behind < w->probe) w->probe = behind;
        return ALONG_CLEAR;
    }
    if (has_root(s, u)) {
        bool known = w->guesses && w->root > w->at && w->root < w->probe;
        w->from = w->at, w->until = w->probe, w->rooms = 1;
        if (!known) w->root = root_between(e, s->ray[u], w->from, w->until);
        bool near = w->until - w->from <= 2.5 * room_about(e, w->root);
        if (near && tell_stretch(e, s, u, w->root, v, i)) return w->done = true, ALONG_ROOT;
        return so_far;
    }
    if (!w->waiting || w->pending[w->waiting - 1] > w->probe) {
        if (w->waiting == ALONG_DEEP) return w->done = true, so_far;
        w->pending[w->waiting++] = w->probe;
    }
    double va = s->va[u], vb = s->vb[u], mid = half_way(va, vb);
    bool unlike = (s->a_lo[u] > 0 && s->b_hi[u] < 0) || (s->a_hi[u] < 0 && s->b_lo[u] > 0);
    if (unlike && w->guesses < ALONG_GUESSES)
        guess_root(w, e, s, u);
    else
        w->probe = s->side[u] * mid;
    bool spent = ++w->trials == ALONG_TRIALS || v->evals[i] >= 0.5 * v->budget;
    w->done = spent || !(vb - va > 0x1p-16 * (1 + va)) || !(w->probe > w->at);
    return so_far;
}

/* Lays lane u for this ray, from t on.  Returns ALONG_CLEAR if it is to be looked along. */
static along_says lay_line(const sgt_ray *ray, double from, double home, lines *e, size_t u, walker *w)
{
    double scale = scale_of(ray->d), inverse = inverse_of_scale(ray->d), l = ray->d.x * scale,
           m = ray->d.y * scale, n = ray->d.z * scale, a = l * l + m * m;
    if (!(a > 0x1p-60)) return ALONG_SILENT;
    double t0 = -(ray->o.x * l + ray->o.y * m) / a;
    double x = moved_along(ray->o.x, t0, l), y = moved_along(ray->o.y, t0, m);
    t0 -= (x * l + y * m) / a;
    x = moved_along(ray->o.x, t0, l), y = moved_along(ray->o.y, t0, m);
    double z = moved_along(ray->o.z, t0, n), left = (x * l + y * m) / a;
    /* From afar an ulp of t0 is long.  What is left to the nearest point is less than what is lost of t. */
    x -= left * l, y -= left * m, z -= left * n;
    double near = sqrt(x * x + y * y), root = sqrt(a), W = rung_above(larger(home, 1.02 * near), FINE);
    bool fine = W > 0x1p-300 && W < 0x1p300 && fabs(x * l + y * m) <= 0x1p-48 * W * root &&
                fabs(left) <= 0x1p-48 * (fabs(t0) + W / root) && fabs(z) < 0x1p500;
    if (!fine) return ALONG_SILENT;
    double by = W / root, lost = 0x1p-45 * (fabs(from * inverse) + fabs(t0) + by),
           begin = (from * inverse - t0 - lost) / by, end = HUGE_VAL, kappa = e->k1 * e->c * e->c;
    if (from == -HUGE_VAL) begin = -HUGE_VAL;
    if (ray->tmax < HUGE_VAL) {
        double t = ray->tmax * inverse;
        end = (t - t0 + 0x1p-45 * (fabs(t) + fabs(t0) + by)) / by;
    }
    if (kappa > 0) {
        double reach2 = 1 / kappa * (1 + 0x1p-30) - near * near;
        if (!(reach2 > 0)) return ALONG_MISS; /* it passes by the base */
        double reach = sqrt(reach2) / W * (1 + 0x1p-30) + 0x1p-30;
        begin = larger(begin, -reach), end = end < reach ? end : reach;
    }
    if (!(begin < end)) return end <= begin ? ALONG_MISS : ALONG_SILENT;
    double far = larger(begin > -HUGE_VAL ? -begin : 0, end < HUGE_VAL ? end : 0);
    if (!(far < 0x1p20 && along_power(1 + far, e->n) < 0x1p900)) return ALONG_SILENT;
    e->x[u] = x, e->y[u] = y, e->z[u] = z, e->l[u] = by * l, e->m[u] = by * m, e->g[u] = by * n;
    e->W[u] = W, e->t0[u] = t0, e->by[u] = by, e->scale[u] = scale;
    *w = (walker){.begin = begin, .at = begin, .to = end, .probe = begin < 0 && end > 0 ? 0 : end};
    return ALONG_CLEAR;
}

static double reached(const lines *e, size_t u, const walker *w)
{
    double t0 = e->t0[u], by = e->by[u], v = w->at;
    return (t0 + v * by - 0x1p-44 * (fabs(t0) + fabs(v * by) + by)) * e->scale[u];
}

SGT_INLINE bool along_offered(sgt_surface s, sgt_course *course)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    const departure *of = builtin->departure;
    if (!of || !of->along || !of->noise || !builtin->base) return false;
    return of->along(s.self, course) && course->degree < ALONG_MOST;
}

void sgt_look_along(sgt_surface s, const sgt_rays *r, size_t count, const size_t row[], double t[],
                    along_says said[], vicinities *kept, const vicinity *v)
{
    sgt_course course = {0, false, 0};
    for (size_t u = 0; u < count; u++) said[u] = ALONG_SILENT;
    if (count == 0 || rim2_of(s.ops->own_->rim(s.self)) < HUGE_VAL) return;
    if (sgt_look_by_profile(s, r, count, row, t, said, kept, v)) return;
    if (!along_offered(s, &course)) return;
    lines e;
    walker walk[WIDE];
    stretches at;
    size_t of[WIDE], some = 0;
    lane_row rounding;
    double k;
    e.half = course.degree / 2 + 1, e.half = e.half < 2 ? 2 : e.half, e.n = 2 * e.half - 1;
    s.ops->own_->base(s.self, &e.c, &k), e.k1 = 1 + k;
    for (size_t j = 0; j < count; j++) {
        size_t i = row[j];
        const sgt_ray ray = {{r->o[0][i], r->o[1][i], r->o[2][i]},
                             {r->d[0][i], r->d[1][i], r->d[2][i]},
                             v->tmin[i],
                             v->tmax[i]};
        said[j] = lay_line(&ray, t[j], course.home, &e, some, &walk[some]);
        if (said[j] != ALONG_CLEAR) continue;
        said[j] = ALONG_SILENT;
        rounding[some] = rounding_about(s, e.half, e.W[some], kept);
        if (rounding[some] < HUGE_VAL) of[some++] = j;
    }
    if (some == 0) return;
    for (size_t u = some; u < WIDE; u++) { /* as the first */
        e.W[u] = e.W[0], e.x[u] = e.x[0], e.y[u] = e.y[0], e.l[u] = e.l[0], e.m[u] = e.m[0], e.z[u] = e.z[0],
        e.g[u] = e.g[0];
        walk[u].done = true, rounding[u] = rounding[0];
    }
    ask_along(s, !course.even, some, rounding, &e);
    for (size_t u = 0; u < some; u++) walk[u].done = !(e.E[u] < 0x1p900 && e.B[u] < 0x1p900);
    for (size_t u = 0; u < ABREAST; u++) place_ray(&e, u < some ? u : 0, &at, u);
    for (size_t next = ABREAST;;) {
        size_t left = 0;
        for (size_t u = 0; u < ABREAST; u++) {
            while (walk[at.ray[u]].done && next < some) place_ray(&e, next++, &at, u);
            left += u < some && !walk[at.ray[u]].done;
            aim(&walk[at.ray[u]], u, &e, &at);
        }
        if (left == 0) break;
        look_over(&e, &at);
        for (size_t u = 0; u < ABREAST && u < some; u++) {
            walker *w = &walk[at.ray[u]];
            if (w->done) continue;
            size_t j = of[at.ray[u]], i = row[j];
            v->evals[i] += 1;
            if (v->told) tell_trial(v, &e, &at, u);
            said[j] = walk_on(w, &e, &at, u, v, i);
            if (v->told && v->told->stopped) w->done = true;
        }
    }
    for (size_t u = 0; u < some; u++) {
        size_t j = of[u];
        if (said[j] != ALONG_CLEAR) continue;
        double to = reached(&e, u, &walk[u]);
        if (to > t[j])
            t[j] = to;
        else
            said[j] = ALONG_SILENT;
    }
}
