// SPDX-License-Identifier: MIT
/* along_terms.c - the coefficients of a departure P(x, y) along a line, and how far they are off.
 *
 * Along a line P is a polynomial p of v, about the point nearest the axis (along.c, THE LINE), whose degree
 * n the type knows.  So some n + 1 values of P say everything about it.
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
 * to the edge of the circle. */
#include "along_terms.h"

#include "wings.h"

static const double SPREAD = 4;

/* The nodes v > 0 and their squares, and (1 + v^2)^(-n/2); rows are filled up to a multiple of 4. */
typedef struct nodes {
    double v[ALONG_HALF], v2[ALONG_HALF], weight[ALONG_HALF];
} nodes;

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

double sgt_rounding_along(sgt_surface s, size_t half, double W, vicinities *kept)
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

void sgt_ask_along(sgt_surface s, bool both, size_t count, const lane_row rounding, lines *e)
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
        if (of->along_noise || !of->alone) of->at(s.self, few * count, x, y, (sag_values){p, px, py});
        else of->alone(s.self, few * count, x, y, p);
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
