// SPDX-License-Identifier: MIT
/* along.c - a departure P(x, y) of a polynomial, along a ray without a rim (along.h).
 *
 * Along a ray P is a polynomial of one variable, whose degree n the type knows.  So some n + 1 values of P say
 * everything about it, all the way to where the base ends or beyond all bounds.  What is left is a question
 * about one polynomial, which takes no further look.
 *
 * THE LINE.  Let x and y be w (l, m) / sqrt(l^2 + m^2) from the point nearest the axis, z = z0 + g w, w = W v.
 * W is at least 1.02 times the ray's distance from the axis, so that r <= W sqrt(1 + v^2).
 *
 * THE PROJECTIVE LINE.  (1 + v^2)^(-n/2) P is the value at a unit vector (h, k), v = k / h, of a homogeneous
 * polynomial of degree n.  By `size` the greatest such value is meant.  With v = tan phi it is a sum of the
 * cosines and sines of n phi, (n - 2) phi, ...  So n is made odd, N = n + 1 = 2 m, and P is asked for at the N
 * nodes v = +-tan((j + 1/2) pi / N), which are evenly spaced in phi.
 *
 * THE COEFFICIENTS p(v) = sum of c_k v^k interpolate these values.  Even and odd powers are apart: each is a
 * polynomial of v^2 with m nodes, by Lagrange's formula.  The product of v^2 - node is, up to its scale, the
 * real part of (1 + i v)^N, whose coefficients are binomial ones.  A factor is divided out from whichever end
 * is stable.
 *
 * HOW FAR p IS OFF is not derived from how it was made.  p - P is a polynomial of degree n, of which a bound
 * at each node is computed: |p - P| there as computed, with the rounding of both.  The polynomial that
 * interpolates at N evenly spaced nodes of the circle is nowhere greater than 1 + (2 / pi) log N times what it
 * interpolates (Gronwall 1921; Rivlin, The Chebyshev Polynomials, 1974): at most 3.4 here; SPREAD is above
 * that.  That gives the size E of p - P.
 *
 * THE ROUNDING OF P at a node at r: its noise within r, and its gradient within r times how far the point
 * asked for is from the node.  Both are those of the whole circle of that radius, so one number holds for all
 * rays that have the same W.
 *
 * BERNSTEIN'S FORM over [va, vb]: coefficient i is the polar form of p with n - i arguments (1, va) and i
 * arguments (1, vb), so P is a mean of them.  For unit vectors the polar form of a homogeneous polynomial is
 * at most its size (Banach 1938, Studia Math. 7, 36).  So p - P changes coefficient i by at most
 * E (1 + va^2)^((n - i)/2) (1 + vb^2)^(i/2).  In this form the step from [0, infinity), where the coefficients
 * are b_k = c_k over the binomial coefficient, to [va, vb] is two triangles of sums:
 *
 *     (1, vb) = (1, 0) + vb (0, 1),    (1, va) = (1 - va / vb) (1, 0) + (va / vb) (1, vb).
 *
 * A row of the two rounds an entry by at most 1 and 4 u of what the triangle makes of the magnitudes, and there
 * are n rows.  With |b_k| <= B the magnitudes are at most B (1 + va)^(n - i) (1 + vb)^i.  Where vb is infinite, (0, 1)
 * stays as it is, and its weight is 1.
 *
 * THE BASE along a line is convex if c > 0 (F.  its second derivative lies between c and c / phi^3), concave
 * if c < 0.  So it is on one side of its chord, and on the other side of its tangent in the middle.  Both are
 * linear, as z is.  Over a stretch without an end it is between 0 and c r^2.  What z and the base are rounded
 * by is less than 2^-40 of their terms, or where the base ends 2^-20; so much is added.
 *
 * CLEAR.  If all coefficients of z - base - P have the same sign, with all that is added, F has it all over
 * [va, vb].  If those of its derivative have, there is one root at most, and F at the ends tells whether.
 * Else the over is halved, in phi, and its nearer half is asked first.
 *
 * THE ROOT is looked for on p, and what is reported is a short stretch about it, well inside of that in which F
 * is monotone.  (Newton's steps may end at no other root than the only one.)
 *
 * COST.  N values of P, some 2 N^2 operations for the coefficients, and N^2 for each stretch.  A stretch counts as
 * one evaluation, as an enclosure does. */
#include "along.h"

#include "../surface/departure/departure.h"
#include "wings.h"

#include <sagitta/interval.h>

/* A multiple of 4 at least half of the greatest number of nodes. */
enum { ALONG_HALF = 20, ALONG_MOST = 2 * ALONG_HALF, ALONG_TRIALS = 48, ALONG_SEEKS = 24 };
static const double SPREAD = 4;

/* The line about its point nearest the axis, counted in v, and P along it. */
typedef struct along {
    size_t half, n;          /* nodes on either side; the degree, 2 half - 1 */
    double W, c, k1;         /* the base */
    double x, y, l, m;       /* dx/dv = l, dy/dv = m */
    double z, g;             /* z = z0 + g v */
    double E, B;             /* the size of p - P; the greatest |b_k| */
    double p[ALONG_MOST], b[ALONG_MOST]; /* c_k and b_k */
} along;

/* The nodes v > 0 and their squares, and (1 + v^2)^(-n/2); rows are filled up to a multiple of 4. */
typedef struct nodes { double v[ALONG_HALF], v2[ALONG_HALF], weight[ALONG_HALF]; } nodes;

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
        e->v[j] = in ? s / c : 0, e->v2[j] = e->v[j] * e->v[j], e->weight[j] = in ? along_power(c, 2 * half - 1) : 0;
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

/* sum of a[j] b[j], four partial sums, in one order on every processor. */
SGT_INLINE double dot4(size_t n, const double *restrict a, const double *restrict b)
{
    double sum[4] = {0, 0, 0, 0};
    for (size_t j = 0; j < n; j += 4)
        LANES for (size_t u = 0; u < 4; u++) sum[u] = sgt_fma(a[j + u], b[j + u], sum[u]);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* c_k of the polynomial that has these even and odd parts at the nodes; the odd ones are divided by v. */
SGT_KERNEL
static void interpolate(size_t half, const nodes *e, const double *even, const double *odd, double *c)
{
    const size_t wide = (half + 3) / 4 * 4, N = 2 * half;
    double of[ALONG_HALF + 1], q[ALONG_HALF][ALONG_HALF], sum[ALONG_HALF], by[ALONG_HALF], first[ALONG_HALF],
        second[ALONG_HALF];
    double binomial = 1;
    for (size_t k = 0; k <= half; k++) { /* of[k]: that of v^2k in the real part of (1 + i v)^N */
        of[k] = k % 2 ? -binomial : binomial;
        double i = (double)(2 * k), top = (double)N;
        binomial = binomial * ((top - i) * (top - i - 1)) / ((i + 1) * (i + 2));
    }
    const size_t low = half / 2; /* the nodes before are below 1 */
    LANES for (size_t j = 0; j < low; j++) q[half - 1][j] = of[half];
    for (size_t k = half - 1; k > 0; k--)
        LANES for (size_t j = 0; j < low; j++) q[k - 1][j] = sgt_fma(e->v2[j], q[k][j], of[k]);
    LANES for (size_t j = low; j < wide; j++) by[j] = 1 / (j < half ? e->v2[j] : 1), q[0][j] = -of[0] * by[j];
    for (size_t k = 1; k < half; k++)
        LANES for (size_t j = low; j < wide; j++) q[k][j] = (q[k - 1][j] - of[k]) * by[j];
    LANES for (size_t j = 0; j < wide; j++) sum[j] = 0;
    for (size_t k = half; k-- > 0;)
        LANES for (size_t j = 0; j < wide; j++) sum[j] = sgt_fma(e->v2[j], sum[j], q[k][j]);
    LANES for (size_t j = 0; j < wide; j++) {
        double in = j < half ? 1.0 : 0.0, over = in != 0 ? 1 / sum[j] : 0;
        first[j] = even[j] * over, second[j] = odd[j] * over;
    }
    for (size_t k = 0; k < half; k++)
        c[2 * k] = dot4(wide, q[k], first), c[2 * k + 1] = dot4(wide, q[k], second);
}

/* The greatest weighted |p - P| at the nodes. */
SGT_KERNEL
static double misses_by(size_t half, const nodes *e, const double *c, const double *at, const double *behind)
{
    double even[ALONG_HALF], odd[ALONG_HALF], most = 0;
    LANES for (size_t j = 0; j < half; j++) even[j] = odd[j] = 0;
    for (size_t k = half; k-- > 0;)
        LANES for (size_t j = 0; j < half; j++)
            even[j] = sgt_fma(e->v2[j], even[j], c[2 * k]), odd[j] = sgt_fma(e->v2[j], odd[j], c[2 * k + 1]);
#pragma omp simd reduction(max : most)
    for (size_t j = 0; j < half; j++) {
        double o = e->v[j] * odd[j], off = larger(fabs(even[j] + o - at[j]), fabs(even[j] - o - behind[j])),
               by = off * e->weight[j];
        most = by > most ? by : most;
    }
    return most;
}

/* b_k; returns the greatest magnitude. */
static double scaled_by_binomial(size_t n, const double *c, double *b)
{
    double binomial = 1, most = 0;
    for (size_t k = 0; k <= n; k++) {
        b[k] = c[k] / binomial, most = larger(most, fabs(b[k]));
        binomial = binomial * (double)(n - k) / (double)(k + 1);
    }
    return most;
}

/* P along the line: asks for it.  false: it is not known. */
static bool ask_along(sgt_surface s, bool even, double rounding, along *e)
{
    const departure *of = s.ops->own_->departure;
    const size_t half = e->half, count = even ? half : 2 * half;
    nodes at;
    double x[ALONG_MOST], y[ALONG_MOST], p[ALONG_MOST], px[ALONG_MOST], py[ALONG_MOST], ev[ALONG_HALF],
        od[ALONG_HALF];
    nodes_of(half, &at);
    for (size_t j = 0; j < half; j++) {
        x[j] = e->x + at.v[j] * e->l, y[j] = e->y + at.v[j] * e->m;
        x[half + j] = e->x - at.v[j] * e->l, y[half + j] = e->y - at.v[j] * e->m;
    }
    of->at(s.self, count, x, y, (sag_values){p, px, py});
    for (size_t j = 0; j < ALONG_HALF; j++) ev[j] = od[j] = 0;
    for (size_t j = 0; j < half; j++) {
        double one = p[j], other = even ? p[j] : p[half + j];
        p[half + j] = other;
        ev[j] = 0.5 * (one + other), od[j] = 0.5 * (one - other) / at.v[j];
    }
    interpolate(half, &at, ev, od, e->p);
    const double u = SGT_U, n = (double)e->n;
    e->B = scaled_by_binomial(e->n, e->p, e->b);
    /* P for an even one is asked at w^2 alone; Horner's rule on magnitudes of at most B (1 + v)^n */
    double off = misses_by(half, &at, e->p, p, p + half) * (1 + 0x1p-40) + rounding +
                 (2 * n + 8) * u * e->B * along_power(1.41421357, e->n);
    e->E = SPREAD * off;
    return e->E < HUGE_VAL && e->B < HUGE_VAL;
}

/* -------------------------------------------------------------------------- a stretch */

/* The coefficients over [va, vb], vb > va >= 0, of P of side * v. */
SGT_KERNEL
static void bernstein(const along *e, double side, double va, double vb, double *restrict out)
{
    const size_t n = e->n;
    double from[ALONG_MOST];
    if (vb < HUGE_VAL) {
        for (size_t k = 0; k <= n; k++) from[n - k] = side < 0 && k % 2 ? -e->b[k] : e->b[k];
        for (size_t r = n; r > 0; r--)
            LANES for (size_t i = 0; i < r; i++) from[i] = sgt_fma(vb, from[i], from[i + 1]);
        for (size_t k = 0; k <= n; k++) out[k] = from[n - k];
        if (!(va > 0)) return;
        const double part = va / vb, rest = (vb - va) / vb;
        for (size_t r = n; r > 0; r--)
            LANES for (size_t i = 0; i < r; i++) out[i] = sgt_fma(part, out[i + 1], rest * out[i]);
    } else {
        for (size_t k = 0; k <= n; k++) out[k] = side < 0 && k % 2 ? -e->b[k] : e->b[k];
        for (size_t r = n; r > 0; r--)
            LANES for (size_t i = 0; i < r; i++) out[i] = sgt_fma(va, out[i + 1], out[i]);
    }
}

/* How far each may be off. */
static void bernstein_errors(const along *e, double va, double vb, double *err)
{
    const bool ends = vb < HUGE_VAL;
    double wa = sqrt(1 + va * va), wb = ends ? sqrt(1 + vb * vb) : 1, sa = 1 + va, sb = ends ? 1 + vb : 1,
           round = 6.06 * (double)(e->n + 1) * SGT_U * e->B;
    double first = 1.01 * e->E * along_power(wa, e->n), by = wb / wa, second = 1.01 * round * along_power(sa, e->n),
           more = sb / sa;
    for (size_t i = 0; i <= e->n; i++, first *= by, second *= more) err[i] = first + second;
}

/* The base at side * v: bounds on it, and on its slope by v; `sharp` if the latter is bounded. */
typedef struct base_along { double lo, hi, slope, slope_off; bool sharp; } base_along;

static base_along base_at_v(const along *e, double v)
{
    double x = e->x + v * e->l, y = e->y + v * e->m, r2 = x * x + y * y, cr2 = e->c * r2,
           phi2 = 1 - e->k1 * e->c * cr2, off = 0x1p-40 * (1 + fabs(e->k1 * e->c * cr2));
    double low = cr2 / (1 + sqrt(larger(phi2 + off, 0))), high = cr2 / (1 + sqrt(larger(phi2 - off, 0)));
    base_along b = {low, high, 0, 0, phi2 > 0x1p-10};
    if (e->c < 0) b.lo = high, b.hi = low;
    double slack = (phi2 > 0x1p-10 ? 0x1p-40 : 0x1p-20) * larger(fabs(b.lo), fabs(b.hi));
    b.lo -= slack, b.hi += slack;
    b.slope = b.sharp ? e->c / sqrt(phi2) * (x * e->l + y * e->m) : 0;
    b.slope_off = b.sharp ? 0x1p-28 * fabs(e->c) / sqrt(phi2) * (fabs(x * e->l) + fabs(y * e->m)) : 0;
    return b;
}

/* Bounds on z - base at the ends of two lines, above and below it over the whole stretch. */
typedef struct rest { double low_a, low_b, high_a, high_b, slope_lo, slope_hi; } rest;

static rest rest_over(const along *e, double side, double va, double vb)
{
    double a = side * va, b = side * vb, za = e->z + e->g * a, zb = e->z + e->g * b,
           off = 0x1p-40 * (fabs(e->z) + fabs(e->g) * vb);
    rest r;
    if (e->c == 0) r = (rest){za - off, zb - off, za + off, zb + off, e->g, e->g};
    else {
        base_along sa = base_at_v(e, a), sb = base_at_v(e, b), sm = base_at_v(e, 0.5 * (a + b));
        double half = 0.5 * (b - a), bent = fabs(half) * (sm.slope_off + 0x1p-40 * fabs(sm.slope)),
               ta = sm.slope * -half, tb = sm.slope * half;
        if (e->c > 0) { /* above its tangent, or 0; below its chord */
            double la = sm.sharp ? sm.lo + ta - bent : 0, lb = sm.sharp ? sm.lo + tb - bent : 0;
            r = (rest){za - sa.hi - off, zb - sb.hi - off, za - la + off, zb - lb + off, 0, 0};
        } else {
            double ha = sm.sharp ? sm.hi + ta + bent : 0, hb = sm.sharp ? sm.hi + tb + bent : 0;
            r = (rest){za - ha - off, zb - hb - off, za - sa.lo + off, zb - sb.lo + off, 0, 0};
        }
        if (sa.sharp && sb.sharp) {
            double least = -larger(-(sa.slope - sa.slope_off), -(sb.slope - sb.slope_off)),
                   most = larger(sa.slope + sa.slope_off, sb.slope + sb.slope_off);
            r.slope_lo = e->g - most, r.slope_hi = e->g - least;
        } else r.slope_lo = -HUGE_VAL, r.slope_hi = HUGE_VAL;
    }
    double lost = 0x1p-40 * fabs(e->g);
    r.slope_lo -= lost, r.slope_hi += lost;
    return r;
}

/* The least of z - base - P from below, and the greatest from above, with each coefficient. */
SGT_KERNEL
static sgt_interval range_of(size_t n, rest r, const double *p, const double *err)
{
    const double step = 1 / (double)n, low_b = (r.low_b - r.low_a) * step, high_b = (r.high_b - r.high_a) * step,
                 off = 0x1p-48 * (fabs(r.low_a) + fabs(r.low_b) + fabs(r.high_a) + fabs(r.high_b));
    double least = -HUGE_VAL, most = -HUGE_VAL;
#pragma omp simd reduction(max : least, most)
    for (size_t i = 0; i <= n; i++) {
        double at = (double)i, low = p[i] - (r.low_a + low_b * at) + err[i], high = (r.high_a + high_b * at) - p[i] + err[i];
        least = low > least ? low : least, most = high > most ? high : most;
    }
    return sgt_interval_between(-(least + off), most + off);
}

/* That of the derivative by v, on this side: r's is by v itself. */
SGT_KERNEL
static sgt_interval slope_of(size_t n, double side, double width, rest r, const double *p, const double *err)
{
    const double by = (double)n / width * (1 + 0x1p-50);
    double least = -HUGE_VAL, most = -HUGE_VAL;
#pragma omp simd reduction(max : least, most)
    for (size_t i = 0; i < n; i++) {
        double d = side * (p[i + 1] - p[i]), off = err[i + 1] + err[i] + SGT_U * (fabs(p[i + 1]) + fabs(p[i]));
        double low = d + off, high = off - d;
        least = low > least ? low : least, most = high > most ? high : most;
    }
    least *= by, most *= by;
    return sgt_interval_between(r.slope_lo - least - 0x1p-48 * fabs(least), r.slope_hi + most + 0x1p-48 * fabs(most));
}

/* The range of F over a stretch without an end: the coefficients of z, and of c r^2, beside those of P. */
static sgt_interval range_to_infinity(const along *e, double side, double va, const double *p, const double *err)
{
    const double n = (double)e->n, a = side * va, x = e->x + a * e->l, y = e->y + a * e->m, r2 = x * x + y * y,
                 W2 = e->l * e->l + e->m * e->m;
    double z[3] = {e->z + e->g * a, side * e->g / n, 0},
           s[3] = {e->c * r2, e->c * 2 * (W2 * va + fabs(x * e->l + y * e->m - a * W2)) / n,
                   e->c * 2 * W2 / (n * (n - 1))},
           least = HUGE_VAL, most = -HUGE_VAL;
    for (size_t i = 0; i <= e->n; i++) {
        double at = i < 3 ? z[i] : 0, base = i < 3 ? s[i] * (1 + 0x1p-20) : 0,
               off = err[i] + (i == 0 ? 0x1p-40 * (fabs(e->z) + fabs(e->g * a)) : 0x1p-40 * fabs(at));
        double low = at - larger(base, 0) - p[i] - off, high = at - (base < 0 ? base : 0) - p[i] + off;
        low -= 0x1p-48 * (fabs(at) + fabs(base) + fabs(p[i])), high += 0x1p-48 * (fabs(at) + fabs(base) + fabs(p[i]));
        least = low < least ? low : least, most = larger(most, high);
    }
    return sgt_interval_between(least, most);
}

/* What a stretch says of F. */
typedef struct over { bool clear, root; sgt_interval f, slope; } over;

static over look_over(const along *e, double side, double va, double vb)
{
    double p[ALONG_MOST], err[ALONG_MOST];
    over is = {false, false, SGT_ANY_NUMBER, SGT_ANY_NUMBER};
    bernstein(e, side, va, vb, p);
    bernstein_errors(e, va, vb, err);
    if (!(vb < HUGE_VAL)) {
        if (!(err[0] < 0x1p900 && err[e->n] < 0x1p900)) return is;
        is.f = range_to_infinity(e, side, va, p, err);
        is.clear = is.f.lo > 0 || is.f.hi < 0;
        return is;
    }
    rest r = rest_over(e, side, va, vb);
    /* no number below is NaN */
    double all = fabs(r.low_a) + fabs(r.low_b) + fabs(r.high_a) + fabs(r.high_b);
    if (!(all < 0x1p900 && err[0] < 0x1p900 && err[e->n] < 0x1p900)) return is;
    is.f = range_of(e->n, r, p, err);
    is.clear = is.f.lo > 0 || is.f.hi < 0;
    if (is.clear) return is;
    is.slope = slope_of(e->n, side, vb - va, r, p, err);
    if (!(is.slope.lo > 0 || is.slope.hi < 0)) return is;
    /* monotone: F at the ends, where the lines that are its chord are the base */
    size_t n = e->n;
    double off = 0x1p-48 * (fabs(r.low_a) + fabs(r.low_b) + fabs(r.high_a) + fabs(r.high_b));
    double a_lo = r.low_a - p[0] - err[0] - off, a_hi = r.high_a - p[0] + err[0] + off,
           b_lo = r.low_b - p[n] - err[n] - off, b_hi = r.high_b - p[n] + err[n] + off;
    is.clear = (a_lo > 0 && b_lo > 0) || (a_hi < 0 && b_hi < 0);
    is.root = (a_lo > 0 && b_hi < 0) || (a_hi < 0 && b_lo > 0);
    return is;
}

/* Half-way in phi; vb may be infinite. */
static double half_way(double va, double vb)
{
    double a = 1 / sqrt(1 + va * va), b = vb < HUGE_VAL ? 1 / sqrt(1 + vb * vb) : 0;
    return (va * a + (vb < HUGE_VAL ? vb * b : 1)) / (a + b);
}

/* F as p has it. */
static double value_along(const along *e, double v)
{
    base_along s = base_at_v(e, v);
    double p = 0;
    for (size_t k = e->n + 1; k-- > 0;) p = sgt_fma(p, v, e->p[k]);
    return e->z + e->g * v - 0.5 * (s.lo + s.hi) - p;
}

/* Where p has the root between, roughly: regula falsi, with the end that stays halved (Illinois). */
static double root_between(const along *e, double a, double b)
{
    double fa = value_along(e, a), fb = value_along(e, b), v = 0.5 * (a + b);
    for (int i = 0; i < ALONG_SEEKS && !(fabs(b - a) <= 0x1p-30 * fabs(b)); i++) {
        double was = v;
        v = b - fb * ((b - a) / (fb - fa));
        if (!(fabs(v - 0.5 * (a + b)) < 0.5 * fabs(b - a))) v = 0.5 * (a + b);
        double f = value_along(e, v);
        if (signbit(f) == signbit(fb)) fa *= 0.5;
        else a = b, fa = fb;
        b = v, fb = f;
        if (fabs(v - was) <= 0x1p-20 * fabs(v)) break;
    }
    return v;
}

/* ------------------------------------------------------------------------------ the way */

static void tell_trial(const vicinity *v, double lo, double hi, const over *is, double by, double scale)
{
    sgt_interval slope = sgt_interval_between(is->slope.lo / (by * scale), is->slope.hi / (by * scale));
    tell_cell(v->told, SGT_MARCH, lo, hi, is->f, slope);
}

/* The row's answer: F is monotone between the two, on this side, and has a root there. */
static bool tell_stretch(const along *e, double side, double va, double vb, double t0, double by, double scale,
                         const vicinity *v, size_t i)
{
    double root = fabs(root_between(e, side * va, side * vb)), room = (1 + root) / (8 * (double)e->n);
    for (int k = 0; k < 4; k++, room *= 0.25) {
        double a = larger(root - room, va), b = root + room < vb ? root + room : vb;
        if (!(a < b)) return false;
        over is = look_over(e, side, a, b);
        v->evals[i] += 1;
        if (v->told) tell_trial(v, (t0 + side * a * by) * scale, (t0 + side * b * by) * scale, &is, by, scale);
        double least = is.slope.lo > 0 ? is.slope.lo : -is.slope.hi;
        if (!(least > 0 && least < HUGE_VAL)) continue;
        double inside = 0x1p-10 * (b - a), one = side > 0 ? a : -b, other = side > 0 ? b : -a;
        double lo = t0 + (one + inside) * by, hi = t0 + (other - inside) * by,
               lost = 0x1p-44 * (fabs(t0) + fabs(one * by) + fabs(other * by) + by);
        if (!(lo + lost < hi - lost && inside * by > lost)) continue;
        v->lo[i] = lo * scale, v->hi[i] = hi * scale, v->seed[i] = (t0 + side * root * by) * scale;
        if (!(v->seed[i] > v->lo[i] && v->seed[i] < v->hi[i])) v->seed[i] = 0.5 * (v->lo[i] + v->hi[i]);
        v->least[i] = least / by * (1 - 0x1p-20), v->asked[i] = 0;
        return true;
    }
    return false;
}

/* From `from` to `to` in v.  Returns 1 if all is clear, 2 if a root is told, else 0; *reached: how far it is
 * clear. */
static int go_along(const along *e, double from, double to, double t0, double by, double scale,
                    const vicinity *v, size_t i, double *reached)
{
    double at = from, pending[ALONG_TRIALS];
    int waiting = 0, trials = 0;
    *reached = from;
    while (at < to) {
        const double side = at < 0 ? -1 : 1, end = at < 0 && to > 0 ? 0 : to;
        double probe = waiting ? pending[waiting - 1] : end;
        for (;;) {
            double va = side > 0 ? at : -probe, vb = side > 0 ? probe : -at;
            if (trials++ == ALONG_TRIALS || waiting == ALONG_TRIALS || v->evals[i] >= 0.5 * v->budget) return 0;
            over is = look_over(e, side, va, vb);
            v->evals[i] += 1;
            if (v->told) tell_trial(v, (t0 + at * by) * scale, (t0 + probe * by) * scale, &is, by, scale);
            if (v->told && v->told->stopped) return 0;
            if (is.clear) {
                *reached = at = probe;
                if (waiting) waiting--;
                break;
            }
            if (is.root) return tell_stretch(e, side, va, vb, t0, by, scale, v, i) ? 2 : 0;
            if (!(vb - va > 0x1p-16 * (1 + va))) return 0;
            if (!waiting || pending[waiting - 1] != probe) pending[waiting++] = probe;
            double mid = half_way(va, vb);
            probe = side * mid;
            if (!(mid > va && mid < vb)) return 0;
        }
    }
    return 1;
}

along_says sgt_look_along(sgt_surface s, const sgt_ray *ray, double from, vicinities *kept, const vicinity *v,
                          size_t i, double *clear)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    sgt_course course = {0, false, 0};
    if (!builtin->departure || !builtin->departure->along || !builtin->base || builtin->rim(s.self) > 0)
        return ALONG_SILENT;
    if (!builtin->departure->noise || !builtin->departure->along(s.self, &course)) return ALONG_SILENT;
    along e;
    e.half = course.degree / 2 + 1, e.half = e.half < 2 ? 2 : e.half, e.n = 2 * e.half - 1;
    if (e.half > ALONG_HALF) return ALONG_SILENT;
    double k, scale = scale_of(ray->d), inverse = inverse_of_scale(ray->d);
    builtin->base(s.self, &e.c, &k), e.k1 = 1 + k;
    double l = ray->d.x * scale, m = ray->d.y * scale, n = ray->d.z * scale, a = l * l + m * m;
    if (!(a > 0x1p-60)) return ALONG_SILENT;
    double t0 = -(ray->o.x * l + ray->o.y * m) / a;
    e.x = moved_along(ray->o.x, t0, l), e.y = moved_along(ray->o.y, t0, m);
    t0 -= (e.x * l + e.y * m) / a;
    e.x = moved_along(ray->o.x, t0, l), e.y = moved_along(ray->o.y, t0, m);
    e.z = moved_along(ray->o.z, t0, n);
    /* From afar an ulp of t0 is long.  What is left to the nearest point is less than what is lost of t. */
    double left = (e.x * l + e.y * m) / a;
    e.x -= left * l, e.y -= left * m, e.z -= left * n;
    double near = sqrt(e.x * e.x + e.y * e.y);
    e.W = rung_above(larger(course.home, 1.02 * near), FINE);
    double aside = fabs(e.x * l + e.y * m) / sqrt(a);
    bool fine = e.W > 0x1p-300 && e.W < 0x1p300 && aside <= 0x1p-48 * e.W && fabs(left) <= 0x1p-48 * (fabs(t0) + e.W / sqrt(a));
    if (!fine || !(fabs(e.z) < 0x1p500)) return ALONG_SILENT;
    double by = e.W / sqrt(a); /* dt/dv */
    e.l = by * l, e.m = by * m, e.g = by * n;
    /* where it begins and ends */
    double lost = 0x1p-45 * (fabs(from * inverse) + fabs(t0) + by), begin = (from * inverse - t0 - lost) / by,
           end = HUGE_VAL, kappa = e.k1 * e.c * e.c;
    if (from == -HUGE_VAL) begin = -HUGE_VAL;
    if (ray->tmax < HUGE_VAL) {
        double t = ray->tmax * inverse;
        end = (t - t0 + 0x1p-45 * (fabs(t) + fabs(t0) + by)) / by;
    }
    if (kappa > 0) {
        double reach2 = 1 / kappa * (1 + 0x1p-30) - near * near;
        if (!(reach2 > 0)) return ALONG_MISS; /* it passes by the base */
        double reach = sqrt(reach2) / e.W * (1 + 0x1p-30) + 0x1p-30;
        begin = larger(begin, -reach), end = end < reach ? end : reach;
    }
    if (!(begin < end)) return end <= begin ? ALONG_MISS : ALONG_SILENT;
    double far = larger(begin > -HUGE_VAL ? -begin : 0, end < HUGE_VAL ? end : 0);
    if (!(far < 0x1p20 && along_power(1 + far, e.n) < 0x1p900)) return ALONG_SILENT;
    double rounding = rounding_about(s, e.half, e.W, kept);
    if (!(rounding < HUGE_VAL) || !ask_along(s, course.even, rounding, &e)) return ALONG_SILENT;
    double reached;
    int said = go_along(&e, begin, end, t0, by, scale, v, i, &reached);
    if (said == 1) return ALONG_MISS;
    if (said == 2) return ALONG_ROOT;
    if (!(reached > begin)) return ALONG_SILENT;
    double t = t0 + reached * by;
    t = (t - 0x1p-44 * (fabs(t0) + fabs(reached * by) + by)) * scale;
    if (!(t > from)) return ALONG_SILENT;
    *clear = t;
    return ALONG_CLEAR;
}
