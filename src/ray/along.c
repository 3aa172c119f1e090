// SPDX-License-Identifier: MIT
/* along.c - a departure P(x, y) of a polynomial, along a ray without a rim (along.h).
 *
 * Along a ray P is a polynomial of one variable, whose degree n the type knows.  So some n + 1 values of P
 * say everything about it, all the way to where the base ends or beyond all bounds (along_terms.c: its
 * coefficients c_k, and the size E of what they are off by).  What is left is a question about one
 * polynomial, which takes no further look.  p is the polynomial that stands for P, N = n + 1 the number of
 * its values, and a size the greatest value at a unit vector (along_terms.c).
 *
 * THE LINE.  Let x and y be w (l, m) / sqrt(l^2 + m^2) from the point nearest the axis, z = z0 + g w, w = W
 * v. W is at least 1.02 times the ray's distance from the axis, so that r <= W sqrt(1 + v^2).
 *
 * BERNSTEIN'S FORM over [va, vb]: coefficient i is the polar form of p with n - i arguments (1, va) and i
 * arguments (1, vb), so P is a mean of them.  For unit vectors the polar form of a homogeneous polynomial
 * is at most its size (Banach 1938, Studia Math. 7, 36).  So p - P changes coefficient i by at most E (1 +
 * va^2)^((n - i)/2) (1 + vb^2)^(i/2).  In this form the step from [0, infinity), where the coefficients are
 * b_k = c_k over the binomial coefficient, to [va, vb] is two triangles of sums:
 *
 *     (1, vb) = (1, 0) + vb (0, 1),    (1, va) = (1 - va / vb) (1, 0) + (va / vb) (1, vb).
 *
 * A row of the two rounds an entry by at most 1 and 5 u of what the triangle makes of the magnitudes, and
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

#include "along_terms.h"
#include "wings.h"

#include <sagitta/interval.h>

/* Stretches of one ray; those that wait; looks at a root. */
enum {
    ALONG_TRIALS = 48,
    ALONG_DEEP = 16,
    ALONG_SEEKS = 12, /* each leaves a seventh */
    ALONG_ROOMS = 4,
    ALONG_GUESSES = 3,
    ALONG_FEW = 20 /* fewer terms round by little */
};

/* Stretches at a time: as the rays need one or many, a ray that is done gives its place to the next. */
enum { ABREAST = 4 };
typedef double look_row[ABREAST];
#define EACH_LOOK LANES for (size_t u = 0; u < ABREAST; u++)

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

/* One entry of a triangle, from what it was and the next: k own + h next.  exact: h is 0 or 1. */
SGT_INLINE double row_entry(bool exact, double k, double own, double h, double next)
{
    return exact ? sgt_fma(k, own, h * next) : sgt_fma(h, next, k * own);
}

/* Row r of a triangle: each entry before r.  The entries are at p[0], p[step], ...  */
SGT_INLINE void one_row(bool exact, look_row *p, ptrdiff_t step, size_t r, const look_row k,
                        const look_row h)
{
    for (size_t i = 0; i < r; i++, p += step)
        EACH_LOOK p[0][u] = row_entry(exact, k[u], p[0][u], h[u], p[step][u]);
}

/* Rows r to r - 3 at once, r >= 4: each entry is read and written once.  a, b, c and d are the last entries
 * known before these rows, and behind the first three of them. */
SGT_INLINE void four_rows(bool exact, look_row *p, ptrdiff_t step, size_t r, const look_row by,
                          const look_row over)
{
    look_row a, b, c, d;
    EACH_LOOK
    {
        double k = by[u], h = over[u], a0 = p[0][u], a1 = p[step][u], a2 = p[2 * step][u],
               a3 = p[3 * step][u], b0 = row_entry(exact, k, a0, h, a1),
               b1 = row_entry(exact, k, a1, h, a2), b2 = row_entry(exact, k, a2, h, a3),
               c0 = row_entry(exact, k, b0, h, b1), c1 = row_entry(exact, k, b1, h, b2);
        a[u] = a3, b[u] = b2, c[u] = c1, d[u] = row_entry(exact, k, c0, h, c1);
    }
    for (size_t i = 4; i <= r; i++, p += step) EACH_LOOK
        {
            double k = by[u], h = over[u], a1 = p[4 * step][u], b1 = row_entry(exact, k, a[u], h, a1),
                   c1 = row_entry(exact, k, b[u], h, b1), d1 = row_entry(exact, k, c[u], h, c1);
            p[0][u] = row_entry(exact, k, d[u], h, d1);
            a[u] = a1, b[u] = b1, c[u] = c1, d[u] = d1;
        }
    EACH_LOOK p[0][u] = d[u], p[step][u] = c[u], p[2 * step][u] = b[u], p[3 * step][u] = a[u];
}

/* Rows n to 1. */
SGT_INLINE void triangle(bool exact, look_row *p, ptrdiff_t step, size_t n, const look_row k,
                         const look_row h)
{
    size_t r = n;
    for (; r % 4 > 0; r--) one_row(exact, p, step, r, k, h);
    for (; r > 0; r -= 4) four_rows(exact, p, step, r, k, h);
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
    triangle(true, s->p, 1, n, k, h);
    triangle(false, s->p + n, -1, n, rest, part);
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

/* Half the length of a stretch in which the slope is nearly what it is at its middle. */
static double room_about(const lines *e, double root) { return (1 + fabs(root)) / (8 * (double)e->n); }

/* F as p has it at side * v for some v = 1 / q - 1. */
SGT_NOINLINE
static void values_between(const lines *e, size_t ray, double side, const lane_row q, lane_row f)
{
    const double c = e->c, k1 = e->k1, x = e->x[ray], y = e->y[ray], l = e->l[ray], m = e->m[ray],
                 z = e->z[ray], g = e->g[ray];
    lane_row v, p;
    EACH v[u] = side * (1 / q[u] - 1), p[u] = 0;
    for (size_t k = e->n + 1; k-- > 0;) {
        const double of = e->p[k][ray];
        EACH p[u] = sgt_fma(p[u], v[u], of);
    }
    EACH
    {
        base_along b = base_at_v(c, k1, x, y, l, m, v[u]);
        f[u] = z + g * v[u] - 0.5 * (b.lo + b.hi) - p[u];
    }
}

/* Where p has the root between, at which F changes its sign first; v has one sign all the way.  In q = 1 / (1
 * + |v|) stretches of 10^6 are no longer than others; until it is as short as a root's room it is cut by
 * WIDE points, of which only the signs of F are read.  What is left is interpolated. */
static double root_between(const lines *e, size_t ray, double from, double to)
{
    const double side = from < 0 || to < 0 ? -1 : 1, room = 1 / (8 * (double)e->n);
    double a = 1 / (1 + fabs(from)), b = 1 / (1 + fabs(to)), fa = 0, fb = 0;
    for (int i = 0; i < ALONG_SEEKS; i++) {
        lane_row q, f;
        const double step = (b - a) * (1 / (double)(WIDE - 1));
        EACH q[u] = a + (double)u * step;
        q[WIDE - 1] = b;
        values_between(e, ray, side, q, f);
        size_t k = 1;
        while (k + 1 < WIDE && signbit(f[k]) == signbit(f[0])) k++;
        a = q[k - 1], b = q[k], fa = f[k - 1], fb = f[k];
        if (!(fabs(b - a) > room * (a < b ? a : b))) break;
    }
    double at = signbit(fa) != signbit(fb) ? b - fb * ((b - a) / (fb - fa)) : 0.5 * (a + b);
    return side * (1 / at - 1);
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
        rounding[some] = sgt_rounding_along(s, e.half, e.W[some], kept);
        if (rounding[some] < HUGE_VAL) of[some++] = j;
    }
    if (some == 0) return;
    for (size_t u = some; u < WIDE; u++) { /* as the first */
        e.W[u] = e.W[0], e.x[u] = e.x[0], e.y[u] = e.y[0], e.l[u] = e.l[0], e.m[u] = e.m[0], e.z[u] = e.z[0],
        e.g[u] = e.g[0];
        walk[u].done = true, rounding[u] = rounding[0];
    }
    sgt_ask_along(s, !course.even, some, rounding, &e);
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
