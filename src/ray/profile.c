// SPDX-License-Identifier: MIT
/* profile.c - a sag of revolution along a ray without a rim, by a table of its profile (along.h).
 *
 * THE PROFILE.  Let q = r^2, and the sag s(q) = base + P.  Along a ray q = q0 + a w^2, with w counted from
 * the point nearest the axis, where the height is z; F(w) = z + g w - s(q).  So what is known of s over rings
 * of q is known of every ray, and is worked out once for all of them.
 *
 * A RING from q_j to q_(j+1) is passed by w from w_j to w_(j+1), w_j = sqrt((q_j - q0) / a), on the way out,
 * and by the same on the way in.  The ring that holds q0 is passed in one piece, from -w to w.  With s' and
 * s'' the derivatives by q,
 *
 *     F' = g - 2 a w s',    F'' = -2 a s' - 4 a^2 w^2 s'',    a w^2 = q - q0.
 *
 * So their ranges over a piece follow from those of s' and s'' over the ring.
 *
 * CLEAR.  Let |F| be at least A and B at the ends of a piece of length h, with one sign, and its second
 * derivative at most K on that side.  No root is between them if h sqrt(K / 2) < sqrt A + sqrt B (wings.c).
 * (sqrt A + sqrt B)^2 is at least max(A, B) + 3 min(A, B), so no square root is needed.  The rings that a
 * ray passes are asked in lanes.  What is left is asked piece by piece, in the order of the way.  There a
 * piece is also clear if F' has one sign in it.
 *
 * THE ROOT.  A piece that has unlike signs at its ends, and in which F' keeps its sign, has one root.  F' is
 * at least what its range says, and at least (A + B) / h - K h / 2, K >= |F''| (wings.c, THE ROOT).  The
 * piece is reported, and where a parabola in q has the root.
 *
 * Else F is asked in the middle of the piece, and its halves are looked at in turn.  After PROFILE_LOOKS of
 * these the look ends: the ray is clear as far as it was shown.
 *
 * THE TABLE.  P is a polynomial of degree n in x = r^2 / norm^2, times (1 - c^2 r^2)^(-1/2) of a q_bfs, or in
 * r.
 * - Of a polynomial in x the coefficients t_k about the middle of a ring of half-width h are taken.  The
 *   second derivative there is 2 t_2 within the sum over k > 2 of k (k - 1) |t_k| h^(k - 2).  If it has one
 *   sign, the first derivative is between those at the ends; else it is t_1 within the sum of k |t_k|
 *   h^(k-1).
 * - Each term of one in r is monotone in r, and so are its derivatives by q: the rising ones at one end and
 *   the falling ones at the other bound the sum.  At the axis they have none.  So the first ring is the
 *   `core`, where the slope of the sag and its second derivative in any direction are bounded instead.
 * - The base is c q / (1 + phi), phi^2 = 1 - (1 + k) c^2 q; its derivatives c / (2 phi) and (1 + k) c^3 / (4
 *   phi^3) are monotone, as are those of the factor.
 *
 * ROUNDING.  Let M be the polynomial of the `size`s.  All its derivatives are positive.  The coefficients are
 * off by 2^-45 of theirs; a step of Horner's rule, or of the shift to another point, rounds by u of what the
 * same steps make of the magnitudes, and there are 2 n of them, n < 24.  So a derivative at a point within x1
 * is off by at most 2^-42 times that of M at x1; OFF is above that.
 *
 * A NODE of a ray is the w that is computed.  There q is within 2^-48 of q_j, relatively: x and y of the
 * nearest point, a, the quotient and the root are rounded by a few u.  That moves s by at most 2^-48 q s'.
 * Of the departure q s' is at most n + 128 times M f, f the factor, as 1 - c^2 q >= 2^-8 in the table; of the
 * base 8 |c| q.  f itself is off by 2^-44 of it.  Together that is less than 2^-40 M f + 2^-40 |c| q.  Nearer
 * to the axis than the first node, q is off by 2^-50 of q there, and what holds for that node is more.
 *
 * THE NODES are as dense as the polynomial bends: evenly in theta, r = norm sin(theta), within the norm, and
 * r = norm cosh(theta) beyond; of powers of r, in equal ratios.  Toward the edge of a base 1 - (r / edge)^2
 * falls by a factor of 4 at most.  The last node is where the sag is 64 times as high as it is wide, and its
 * tail known (tail.h), or next to the edge.  Beyond it the tail says whether anything is met.
 *
 * THE START.  F is asked where the look begins.  If its sign is not certain there, nothing is said. */
#include "profile_table.h"

#include "along.h"
#include "wings.h"

#include "../num/bits.h"
#include "../surface/departure/departure.h"

#include <sagitta/interval.h>

enum { BLOCK = 8, PROFILE_LOOKS = 24, PROFILE_DEEP = 12 };
static const double OFF = 0x1p-41, OFF_NODE = 0x1p-40, EDGE = 0x1p-8, STEEPLY = 64;

typedef double block_row[BLOCK];
#define EACH_RING LANES for (size_t i = 0; i < BLOCK; i++)

/* --------------------------------------------------------------------------------- the table */

typedef struct sag_at {
    double s, off;
} sag_at;

/* The sag at q, and how far it may be off, q taken as exact; `off_by` of M f and |c| q. */
static sag_at profile_sag(const sgt_profile_table *e, double q, double off_by)
{
    const sgt_profile *of = &e->of;
    double x = of->norm2 > 0 ? q / of->norm2 : sqrt(q), p = 0, most = 0, phi2 = 1 - e->k1 * e->c * (e->c * q),
           w = 1 - of->bent * q;
    for (size_t k = of->terms; k-- > 0;) p = sgt_fma(p, x, of->c[k]), most = sgt_fma(most, x, of->size[k]);
    double f = of->bent > 0 ? 1 / sqrt(w) : 1, cq = e->c * q;
    return (sag_at){cq / (1 + sqrt(phi2)) + p * f, off_by * (most * f + fabs(cq))};
}

/* The greatest r^2 of the table, by where the base ends; HUGE_VAL: nowhere. */
static double last_by_edge(const sgt_profile_table *e)
{
    double kappa = e->k1 * e->c * e->c, most = larger(kappa, e->of.bent);
    return most > 0 ? (1 - EDGE) / most : HUGE_VAL;
}

/* The radius of the last node: where the sag is far higher than wide, and has a tail; 0: there is none. */
static double last_radius(sgt_surface s, const sgt_profile_table *e)
{
    double r = e->of.from, edge = sqrt(last_by_edge(e));
    for (int i = 0, tried = 0; i < 64 && tried < 4; i++, r *= 1.125) {
        if (!(r < edge)) return edge;
        if (!(fabs(profile_sag(e, r * r, 0).s) >= STEEPLY * r)) continue;
        tried++;
        if (fabs(s.ops->own_->tail(s.self, r)) >= 0.5 * STEEPLY * r) return r;
    }
    return 0;
}

/* Lays the nodes, up to `last`, `step` apart in theta, or in log r.  Returns how many there are; more than
 * there is room for: the step is too short. */
static size_t lay_nodes(sgt_profile_table *e, double last, double step)
{
    const sgt_profile *of = &e->of;
    const double norm = sqrt(of->norm2), kappa = larger(e->k1 * e->c * e->c, of->bent);
    double r = norm > 0 ? 0 : of->core;
    size_t n = 0;
    e->q[n++] = 0;
    if (!(norm > 0)) e->q[n++] = r * r;
    while (r < last * (1 - 0x1p-20)) {
        double u = r / norm,
               next = norm > 0 ? r + step * norm * (sqrt(fabs(1 - u * u)) + 0.5 * step) : r + step * r;
        if (kappa > 0) { /* phi^2 falls by a factor of 4 at most */
            double most = sqrt((0.75 + 0.25 * kappa * r * r) / kappa);
            next = next < most ? next : most;
        }
        if (next > last - 0.25 * (next - r)) next = last;
        if (n == PROFILE_NODES) return n + 1;
        r = next, e->q[n++] = r * r;
    }
    e->nodes = n;
    return n;
}

/* What a number lies in. */
typedef struct range {
    double lo, hi;
} range;

SGT_INLINE range sum_of(range a, range b) { return (range){a.lo + b.lo, a.hi + b.hi}; }
SGT_INLINE range between(double a, double b) { return (range){smaller(a, b), larger(a, b)}; }

/* a times a number in b, b.lo >= 0. */
SGT_INLINE range range_times(range a, range b)
{
    return (range){a.lo * chosen(MASK(a.lo > 0), b.lo, b.hi), a.hi * chosen(MASK(a.hi > 0), b.hi, b.lo)};
}

SGT_INLINE range range_wider(range a, double by)
{
    double off = by * (fabs(a.lo) + fabs(a.hi));
    return (range){a.lo - off, a.hi + off};
}

/* The ends of a block of rings, a little outside of them. */
typedef struct ring_ends {
    block_row q0, q1;
} ring_ends;

/* P and its first two derivatives by q over each ring of a block. */
typedef struct ring_ranges {
    block_row p_lo, p_hi, d_lo, d_hi, dd_lo, dd_hi;
} ring_ranges;

/* Of a polynomial of x = q / norm2. */
SGT_KERNEL
static void ranges_by_square(const sgt_profile *of, const ring_ends *at, ring_ranges *out)
{
    const size_t n = of->terms;
    const double by = 1 / of->norm2;
    block_row t[PROFILE_TERMS], x, h, most, steep, bend, end, value, first, second, low, high;
    EACH_RING
    {
        double x0 = at->q0[i] * by, x1 = at->q1[i] * by;
        x[i] = 0.5 * (x0 + x1), h[i] = 0.5 * (x1 - x0) * (1 + 0x1p-40), end[i] = x1 * (1 + 0x1p-40);
        most[i] = steep[i] = bend[i] = 0;
    }
    for (size_t k = 0; k < n; k++) EACH_RING t[k][i] = of->c[k];
    for (size_t k = 0; k + 1 < n; k++)
        for (size_t j = n - 1; j-- > k;) EACH_RING t[j][i] = sgt_fma(x[i], t[j + 1][i], t[j][i]);
    /* M and its derivatives at the end; 2 bend is the second */
    for (size_t k = n; k-- > 0;) EACH_RING
        {
            bend[i] = sgt_fma(bend[i], end[i], steep[i]), steep[i] = sgt_fma(steep[i], end[i], most[i]);
            most[i] = sgt_fma(most[i], end[i], of->size[k]);
        }
    /* the sums of magnitudes, and the first derivative at both ends */
    EACH_RING value[i] = first[i] = second[i] = low[i] = high[i] = 0;
    for (size_t k = n; k-- > 1;) {
        const double w = (double)k, v = k > 1 ? w * (w - 1) : 0;
        EACH_RING
        {
            double size = fabs(t[k][i]), more = k > 2 ? v * size : 0;
            value[i] = sgt_fma(value[i], h[i], size),
            first[i] = sgt_fma(first[i], h[i], k > 1 ? w * size : 0);
            second[i] = k > 1 ? sgt_fma(second[i], h[i], more) : second[i];
            low[i] = sgt_fma(low[i], -h[i], w * t[k][i]), high[i] = sgt_fma(high[i], h[i], w * t[k][i]);
        }
    }
    EACH_RING
    {
        double p = value[i] * h[i] * (1 + 0x1p-40) + OFF * most[i], d = first[i] * (1 + 0x1p-40),
               middle = n > 1 ? t[1][i] : 0, bent = n > 2 ? 2 * t[2][i] : 0,
               over = second[i] * (1 + 0x1p-40) + 2 * OFF * bend[i] * (1 + 0x1p-40), off = OFF * steep[i];
        out->p_lo[i] = t[0][i] - p, out->p_hi[i] = t[0][i] + p;
        out->dd_lo[i] = (bent - over) * by * by, out->dd_hi[i] = (bent + over) * by * by;
        mask monotone = MASK(bent > over) | MASK(-bent > over);
        double d_lo = chosen(monotone, smaller(low[i], high[i]), middle - d),
               d_hi = chosen(monotone, larger(low[i], high[i]), middle + d);
        out->d_lo[i] = (d_lo - off) * by, out->d_hi[i] = (d_hi + off) * by;
    }
}

/* Of a polynomial of r; q0 > 0. */
SGT_KERNEL
static void ranges_by_radius(const sgt_profile *of, const ring_ends *at, ring_ranges *out)
{
    block_row r0, r1, low, high, d_size, dd_size;
    EACH_RING
    {
        r0[i] = sqrt(at->q0[i]) * (1 - 0x1p-50), r1[i] = sqrt(at->q1[i]) * (1 + 0x1p-50);
        low[i] = 1 / (r0[i] * (r0[i] * r0[i])), high[i] = 1 / (r1[i] * (r1[i] * r1[i]));
        out->p_lo[i] = out->p_hi[i] = 0; /* not asked for */
        out->d_lo[i] = out->d_hi[i] = out->dd_lo[i] = out->dd_hi[i] = d_size[i] = dd_size[i] = 0;
    }
    for (size_t k = 1; k < of->terms; k++) { /* low, high: r^(k - 4) at the ends */
        const double n = (double)k, a = 0.5 * n * of->c[k], b = (0.5 * n - 1) * a;
        /* of powers that fall the greatest is at the near end */
        EACH_RING
        {
            double ll = low[i], hh = high[i], l = ll * (r0[i] * r0[i]), h = hh * (r1[i] * r1[i]);
            range d = between(a * l, a * h), dd = between(b * ll, b * hh);
            out->d_lo[i] += d.lo, out->d_hi[i] += d.hi, out->dd_lo[i] += dd.lo, out->dd_hi[i] += dd.hi;
            d_size[i] += larger(fabs(a * l), fabs(a * h)), dd_size[i] += larger(fabs(b * ll), fabs(b * hh));
            low[i] = ll * r0[i], high[i] = hh * r1[i];
        }
    }
    EACH_RING
    {
        double d = 0x1p-40 * d_size[i], dd = 0x1p-40 * dd_size[i];
        out->d_lo[i] -= d, out->d_hi[i] += d, out->dd_lo[i] -= dd, out->dd_hi[i] += dd;
    }
}

/* The base is added, and the factor. */
SGT_KERNEL
static void ranges_of_sag(const sgt_profile_table *e, const ring_ends *at, const ring_ranges *of,
                          double *d_lo, double *d_hi, double *dd_lo, double *dd_hi)
{
    const double c = e->c, kappa = e->k1 * c * c, bent = e->of.bent;
    EACH_RING
    {
        range d = {of->d_lo[i], of->d_hi[i]}, dd = {of->dd_lo[i], of->dd_hi[i]};
        double phi0 = 1 / sqrt(1 - kappa * at->q0[i]), phi1 = 1 / sqrt(1 - kappa * at->q1[i]);
        range slope = range_wider(between(0.5 * c * phi0, 0.5 * c * phi1), 0x1p-40);
        double bend = 0.25 * c * kappa;
        range bow =
            range_wider(between(bend * (phi0 * (phi0 * phi0)), bend * (phi1 * (phi1 * phi1))), 0x1p-40);
        if (bent > 0) {
            double f0 = 1 / sqrt(1 - bent * at->q0[i]), f1 = 1 / sqrt(1 - bent * at->q1[i]),
                   g0 = f0 * (f0 * f0), g1 = f1 * (f1 * f1);
            range p = {of->p_lo[i], of->p_hi[i]}, f = {f0 * (1 - 0x1p-40), f1 * (1 + 0x1p-40)},
                  df = {0.5 * bent * g0 * (1 - 0x1p-40), 0.5 * bent * g1 * (1 + 0x1p-40)},
                  ddf = {0.75 * bent * bent * (g0 * (f0 * f0)) * (1 - 0x1p-40),
                         0.75 * bent * bent * (g1 * (f1 * f1)) * (1 + 0x1p-40)},
                  mixed = range_times(d, df);
            dd = sum_of(range_times(dd, f), sum_of(sum_of(mixed, mixed), range_times(p, ddf)));
            d = sum_of(range_times(d, f), range_times(p, df));
            d = range_wider(d, 0x1p-40), dd = range_wider(dd, 0x1p-40);
        }
        d = range_wider(sum_of(d, slope), 0x1p-40), dd = range_wider(sum_of(dd, bow), 0x1p-40);
        d_lo[i] = d.lo, d_hi[i] = d.hi, dd_lo[i] = dd.lo, dd_hi[i] = dd.hi;
    }
}

/* Behind the last node, where the last block of rings ends. */
SGT_INLINE size_t end_of(const sgt_profile_table *e) { return (e->nodes + BLOCK - 1) / BLOCK * BLOCK; }

static bool tell_rings(sgt_profile_table *e)
{
    const bool square = e->of.norm2 > 0;
    const size_t end = end_of(e);
    double all = 0;
    for (size_t j = 0; j < end; j += BLOCK) {
        ring_ends at;
        ring_ranges of;
        for (size_t i = 0; i < BLOCK; i++) {
            size_t k = j + i, next = k + 1 < end ? k + 1 : k;
            double q0 = e->q[k], q1 = e->q[next], more = 0x1p-10 * (q1 - q0);
            if (e->has_core && k == 0) q0 = q1; /* its own ranges are not read */
            at.q0[i] = larger(q0 - more, 0), at.q1[i] = q1 + more;
        }
        if (square)
            ranges_by_square(&e->of, &at, &of);
        else
            ranges_by_radius(&e->of, &at, &of);
        ranges_of_sag(e, &at, &of, e->slope_lo + j, e->slope_hi + j, e->bend_lo + j, e->bend_hi + j);
    }
    for (size_t j = 0; j < end; j++)
        all += fabs(e->slope_lo[j]) + fabs(e->slope_hi[j]) + fabs(e->bend_lo[j]) + fabs(e->bend_hi[j]) +
               fabs(e->sag[j]) + fabs(e->off[j]);
    return all < HUGE_VAL;
}

/* The sag from the last node to where the base ends. */
static void tell_rest(sgt_surface s, sgt_profile_table *e)
{
    const double kappa = larger(e->k1 * e->c * e->c, e->of.bent), q = e->q[e->nodes - 1],
                 r = sqrt(q) * (1 - 0x1p-40);
    e->edge = HUGE_VAL, e->low = -HUGE_VAL, e->high = HUGE_VAL;
    if (!(kappa > 0)) return;
    e->edge = (1 + 0x1p-20) / kappa;
    double end = sqrt(e->edge);
    region where = {{-end, end}, {-end, end}, r, end};
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    if (s.ops->own_->departure->bounds(s.self, &where, &b) == 0 || !(b.size < HUGE_VAL)) return;
    double base = e->c * q / (1 + sqrt(1 - e->k1 * e->c * (e->c * q))), rim = e->c * e->edge,
           there = e->sag[e->nodes - 1] - base, rise = b.steep * (end - r), off = e->off[e->nodes - 1];
    range of = range_wider(between(base, rim), 0x1p-20), p = {-b.size, b.size};
    if (rise < HUGE_VAL) p = (range){larger(p.lo, there - rise - off), smaller(p.hi, there + rise + off)};
    e->low = of.lo + p.lo, e->high = of.hi + p.hi;
}

SGT_NOINLINE
static bool make_table(sgt_surface s, sgt_profile_table *e)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    double k;
    if (!builtin->departure->profile(s.self, &e->of)) return false;
    builtin->base(s.self, &e->c, &k), e->k1 = 1 + k, e->has_core = !(e->of.norm2 > 0), e->steep = 0;
    if (e->has_core) {
        double base = 0.25 / fabs(e->c);
        e->of.core = e->of.core < base ? e->of.core : base;
    }
    const double last = last_radius(s, e), degree = (double)(e->of.terms - 1) * (e->has_core ? 1 : 2);
    if (!(last > 0x1p-300 && last < 0x1p300)) return false;
    if (e->has_core && !(last > e->of.core)) return false;
    double step = 1.2 / degree;
    while (lay_nodes(e, last, step) > PROFILE_NODES) step *= 1.25;
    const size_t end = end_of(e);
    for (size_t j = e->nodes; j <= end; j++) e->q[j] = e->q[e->nodes - 1];
    for (size_t j = 0; j < e->nodes; j++) {
        sag_at at = profile_sag(e, e->q[j], OFF_NODE);
        e->sag[j] = at.s, e->off[j] = at.off;
    }
    for (size_t j = e->nodes; j <= end; j++)
        e->sag[j] = e->sag[e->nodes - 1], e->off[j] = e->off[e->nodes - 1];
    if (e->has_core) {
        sgt_extent within = SGT_NO_EXTENT;
        builtin->extent_within(s.self, e->of.core * (1 + 0x1p-9), true, &within);
        e->steep = within.steep, e->bent = within.bent;
    }
    tell_rest(s, e);
    return tell_rings(e);
}

/* ----------------------------------------------------------------------------------- the ray */

/* Some rays about their points nearest the axis: w counts the scaled t from there, t = (t0 + w) scale; q0 =
 * r^2 there.  They begin and end at these w; the table ends at +-reach.  sag, off: where the ray begins. */
typedef struct courses {
    block_row o[3], d[3], t, tmax; /* given */
    block_row q0, a, z, g, t0, scale, lost, from, to, reach, sag, off;
    block_row fine; /* 1: all this is known well enough */
} courses;

typedef struct passage {
    double q0, a, z, g, t0, scale, lost;
    size_t first, begins;        /* the rings that hold q0, and the start */
    double w[PROFILE_NODES + 1]; /* at the nodes */
} passage;

/* Where F has been asked: at least |F|, 0 if its sign is not certain, and its sign. */
typedef struct glimpse {
    double w, least, sign;
} glimpse;

static glimpse seen_of(const passage *e, double w, double s, double off)
{
    double f = e->z + e->g * w - s, err = off + 0x1p-46 * (fabs(e->z) + fabs(e->g * w));
    return (glimpse){w, larger(fabs(f) - err, 0), copysign(1, f)};
}

/* F at any w. */
static glimpse ask(const sgt_profile_table *table, const passage *e, double w)
{
    const double q = e->q0 + e->a * (w * w);
    sag_at s = profile_sag(table, q, 2 * OFF); /* with what q is off, as at a node */
    return seen_of(e, w, s.s, q < table->q[1] ? larger(s.off, table->off[1]) : s.off);
}

/* F at a node on the way out (side 1), or in (-1). */
static glimpse node(const sgt_profile_table *table, const passage *e, size_t j, double side)
{
    return seen_of(e, side * e->w[j], table->sag[j], table->off[j]);
}

/* w at the nodes, and the rings; begins: q at the start.  What is behind the last node is read, to no end. */
SGT_KERNEL
static void pass_nodes(const sgt_profile_table *table, passage *e, double begins)
{
    const double q0 = e->q0, by = 1 / e->a;
    const size_t end = end_of(table);
    double first = 0, before = 0;
#pragma omp simd reduction(+ : first, before)
    for (size_t j = 0; j < end; j++) {
        double q = table->q[j];
        e->w[j] = sqrt(larger(q - q0, 0) * by);
        first += q <= q0 ? 1.0 : 0.0, before += q <= begins ? 1.0 : 0.0;
    }
    e->w[end] = 0;
    e->first = (size_t)first - 1, e->begins = (size_t)larger(before, first) - 1;
}

/* Is the piece of one sign clear?  a, b: at least |F| at its ends. */
SGT_INLINE mask is_clear(double a, double b, double length, double bend)
{
    double most = larger(a, b), least = smaller(a, b);
    return MASK(least > 0) & MASK((0.5 + 0x1p-20) * length * length * bend < most + 3 * least);
}

/* The rings from `low` on and below `high`. */
typedef struct ring_span {
    size_t low, high;
} ring_span;

/* Marks the rings of a block, of those among these, that are not clear for F of this sign, on one side.
 * Returns how many. */
SGT_KERNEL
static double pass_rings(const sgt_profile_table *table, const passage *e, size_t from,
                         const ring_span *among, double side, double sign, double open[BLOCK])
{
    static const block_row number = {0, 1, 2, 3, 4, 5, 6, 7};
    const double low = (double)among->low - (double)from, high = (double)among->high - (double)from;
    const double q0 = e->q0, a = 2 * e->a, z = sign * e->z, g = sign * side * e->g, size = fabs(z),
                 grows = fabs(g), turn = -sign;
    const double *w = e->w + from, *q = table->q + from, *sag = table->sag + from, *off = table->off + from,
                 *slope = (sign > 0 ? table->slope_lo : table->slope_hi) + from,
                 *bend = (sign > 0 ? table->bend_lo : table->bend_hi) + from;
    double left = 0;
#pragma omp simd reduction(+ : left)
    for (size_t i = 0; i < BLOCK; i++) {
        double w0 = w[i], w1 = w[i + 1], p0 = larger(q[i] * (1 - 0x1p-44) - q0, 0),
               p1 = q[i + 1] * (1 + 0x1p-44) - q0, err = 0x1p-46 * (size + grows * w1);
        double f0 = z + g * w0 - sign * sag[i] - (off[i] + err),
               f1 = z + g * w1 - sign * sag[i + 1] - (off[i + 1] + err), b = turn * bend[i];
        /* |F|'' is at most this */
        double most = larger(a * (turn * slope[i] + 2 * larger(b * p0, b * p1)), 0),
               marked = chosen(
                   is_clear(f0, f1, w1 - w0, most) | MASK(number[i] < low) | MASK(number[i] >= high), 0, 1);
        open[i] = marked, left += marked;
    }
    return left;
}

/* The rays about their nearest points. */
SGT_KERNEL
static void lay_courses(const sgt_profile_table *table, size_t n, courses *e)
{
    const double across2 = table->q[1], last = table->q[table->nodes - 1];
    LANES for (size_t i = 0; i < n; i++)
    {
        double ox = e->o[0][i], oy = e->o[1][i], oz = e->o[2][i];
        const sgt_vec3 d = {e->d[0][i], e->d[1][i], e->d[2][i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), l = d.x * scale, m = d.y * scale,
               g = d.z * scale, a = l * l + m * m, by = 1 / a, t0 = -(ox * l + oy * m) * by;
        double x = moved_along(ox, t0, l), y = moved_along(oy, t0, m);
        t0 -= (x * l + y * m) * by;
        x = moved_along(ox, t0, l), y = moved_along(oy, t0, m);
        double z = moved_along(oz, t0, g), left = (x * l + y * m) * by;
        /* From afar an ulp of t0 is long.  What is left to the nearest point is less than what is lost of t.
         */
        x -= left * l, y -= left * m, z -= left * g;
        double q0 = x * x + y * y, reach = sqrt(larger(last - q0, 0) * by), aside = x * l + y * m,
               lost = 0x1p-45 * (fabs(t0) + sqrt(last * by)), t = e->t[i] * inverse,
               end = e->tmax[i] * inverse, from = t - t0 - (lost + 0x1p-45 * fabs(t)),
               to = end - t0 + (lost + 0x1p-45 * fabs(end));
        mask begins = MASK(fabs(t) < HUGE_VAL), ends = MASK(fabs(end) < HUGE_VAL);
        from = chosen(begins, from, -HUGE_VAL), to = chosen(ends, to, HUGE_VAL);
        mask fine = MASK(a > 0x1p-60) & MASK(q0 < last * (1 - 0x1p-20)) & MASK(fabs(z) < 0x1p500) &
                    MASK(left * left * a <= 0x1p-10 * across2) & MASK(fabs(left) <= lost) &
                    MASK(aside * aside <= 0x1p-100 * a * larger(q0, across2)) & MASK(from < to) &
                    MASK(from < reach * (1 - 0x1p-20));
        e->q0[i] = q0, e->a[i] = a, e->z[i] = z, e->g[i] = g, e->t0[i] = t0, e->scale[i] = scale,
        e->lost[i] = lost, e->from[i] = from, e->to[i] = to, e->reach[i] = reach,
        e->fine[i] = chosen(fine, 1, 0);
    }
}

/* The sag where they begin, and how far it may be off, as in `ask`. */
SGT_KERNEL
static void ask_starts(const sgt_profile_table *table, size_t n, courses *e)
{
    const sgt_profile *of = &table->of;
    const bool square = of->norm2 > 0, bent = of->bent > 0;
    const double by = square ? 1 / of->norm2 : 0, c = table->c, k1 = table->k1;
    block_row q, x, p, most;
    LANES for (size_t i = 0; i < n; i++)
    {
        double w = e->from[i], at = e->q0[i] + e->a[i] * (w * w);
        q[i] = at, x[i] = square ? at * by : sqrt(at), p[i] = most[i] = 0;
    }
    for (size_t k = of->terms; k-- > 0;) {
        const double a = of->c[k], size = of->size[k];
        LANES for (size_t i = 0; i < n; i++) p[i] = sgt_fma(p[i], x[i], a),
                                             most[i] = sgt_fma(most[i], x[i], size);
    }
    LANES for (size_t i = 0; i < n; i++)
    {
        double cq = c * q[i], phi2 = 1 - k1 * c * cq, f = bent ? 1 / sqrt(1 - of->bent * q[i]) : 1,
               off = 2 * OFF * (most[i] * f + fabs(cq));
        e->sag[i] = cq / (1 + sqrt(phi2)) + p[i] * f;
        e->off[i] = chosen(MASK(q[i] < table->q[1]), larger(off, table->off[1]), off);
    }
}

/* ----------------------------------------------------------------------------------- pieces */

typedef enum piece_says { PIECE_STUCK, PIECE_CLEAR, PIECE_ROOT } piece_says;

/* A root between two points, where a line has it, and at least |F'|. */
typedef struct piece_root {
    double from, to, guess, least;
    size_t ring;
} piece_root;

/* What F' and F'' lie in, from w to w in this ring. */
static void derivatives(const sgt_profile_table *table, const passage *e, size_t j, double from, double to,
                        range *first, range *second)
{
    const double a = e->a, f2 = from * from, t2 = to * to;
    range s = {table->slope_lo[j], table->slope_hi[j]}, b = {table->bend_lo[j], table->bend_hi[j]};
    double near = from * to <= 0 ? 0 : a * smaller(f2, t2), far = a * larger(f2, t2);
    if (table->has_core && j == 0) {
        double most = table->steep * sqrt(a) * (1 + 0x1p-20);
        *first = (range){e->g - most, e->g + most};
        *second = range_wider((range){-a * table->bent.hi, -a * table->bent.lo}, 0x1p-40);
        return;
    }
    double v0 = -2 * a * from, v1 = -2 * a * to, off = 0x1p-40 * fabs(e->g);
    range one = between(v0 * s.lo, v0 * s.hi), other = between(v1 * s.lo, v1 * s.hi),
          both = range_wider((range){smaller(one.lo, other.lo), larger(one.hi, other.hi)}, 0x1p-40);
    *first = (range){e->g + both.lo - off, e->g + both.hi + off};
    range turn = range_times(b, (range){near, far});
    *second = range_wider((range){-2 * a * (s.hi + 2 * turn.hi), -2 * a * (s.lo + 2 * turn.lo)}, 0x1p-40);
}

/* What a piece says, by F at its ends. */
static piece_says judge_piece(const sgt_profile_table *table, const passage *e, size_t j, const glimpse *a,
                              const glimpse *b, piece_root *root)
{
    range first, second;
    const double length = b->w - a->w, room = 0x1p-12 * length;
    derivatives(table, e, j, a->w - room, b->w + room, &first, &second);
    const double by_range = larger(first.lo, -first.hi);
    if (!(a->least > 0 && b->least > 0 && length > 0)) return PIECE_STUCK;
    if (a->sign == b->sign) {
        double bend = larger(a->sign > 0 ? second.hi : -second.lo, 0);
        return by_range > 0 || is_clear(a->least, b->least, length, bend) ? PIECE_CLEAR : PIECE_STUCK;
    }
    double bend = larger(second.hi, -second.lo),
           least = larger(by_range, (a->least + b->least) / length - 0.51 * bend * length);
    if (!(least > 0)) return PIECE_STUCK;
    *root = (piece_root){a->w, b->w, a->w + length * (a->least / (a->least + b->least)), least, j};
    return PIECE_ROOT;
}

/* The same; where it says nothing, F is asked inside.  *clear: up to there no root is. */
static piece_says look_at(const sgt_profile_table *table, const passage *e, size_t j, glimpse a, glimpse b,
                          int *looks, piece_root *root, double *clear)
{
    glimpse pending[PROFILE_DEEP];
    int waiting = 0;
    for (;;) {
        piece_says says = judge_piece(table, e, j, &a, &b, root);
        if (says == PIECE_ROOT) return says;
        if (says == PIECE_CLEAR) {
            *clear = b.w;
            if (waiting == 0) return says;
            a = b, b = pending[--waiting];
            continue;
        }
        if (!(a.least > 0) || waiting == PROFILE_DEEP || --*looks < 0) return PIECE_STUCK;
        pending[waiting++] = b;
        b = ask(table, e, 0.5 * (a.w + b.w));
    }
}

/* Where the root is: a parabola in q through the nodes of the ring. */
static double root_in(const sgt_profile_table *table, const passage *e, const piece_root *f)
{
    const size_t j = f->ring;
    const double qa = table->q[j], qb = table->q[j + 1], sa = table->sag[j],
                 slope = (table->sag[j + 1] - sa) / (qb - qa),
                 bend = table->has_core && j == 0 ? 0 : 0.25 * (table->bend_lo[j] + table->bend_hi[j]);
    double w = f->guess, a = f->from, b = f->to;
    for (int i = 0; i < 3; i++) {
        double q = e->q0 + e->a * (w * w), s = sa + (q - qa) * (slope - bend * (qb - q)),
               ds = slope - bend * (qa + qb - 2 * q), g = e->z + e->g * w - s, dg = e->g - 2 * e->a * w * ds,
               next = w - g / dg;
        if (!(next > a)) next = 0.5 * (a + w);
        if (!(next < b)) next = 0.5 * (w + b);
        w = next;
    }
    return w;
}

/* ---------------------------------------------------------------------------------- the way */

/* The way of a ray: from where, and to where; up to where it is clear. */
typedef struct way {
    double from, to, clear;
    glimpse start; /* where it begins, or at the last node */
    bool outside, root;
    piece_root at;
    int looks;
} way;

/* One piece of the way.  false: the way ends here. */
static bool pass_piece(const sgt_profile_table *table, const passage *e, size_t j, glimpse a, glimpse b,
                       way *w)
{
    w->clear = larger(w->clear, a.w);
    if (a.w >= w->to) return false;
    piece_says says = look_at(table, e, j, a, b, &w->looks, &w->at, &w->clear);
    w->root = says == PIECE_ROOT;
    return says == PIECE_CLEAR;
}

/* The rings from `low` on and below `high`, on the way in or out. */
static bool pass_side(const sgt_profile_table *table, const passage *e, size_t low, size_t high, double side,
                      double sign, way *w)
{
    double open[BLOCK];
    const ring_span among = {low, high};
    const size_t begin = low / BLOCK, end = (high + BLOCK - 1) / BLOCK;
    for (size_t k = begin; k < end; k++) {
        const size_t from = BLOCK * (side > 0 ? k : begin + end - 1 - k);
        if (!(pass_rings(table, e, from, &among, side, sign, open) > 0)) continue;
        for (size_t i = 0; i < BLOCK; i++) {
            size_t at = side > 0 ? i : BLOCK - 1 - i, j = from + at;
            if (open[at] == 0) continue;
            glimpse one = node(table, e, side > 0 ? j : j + 1, side),
                    other = node(table, e, side > 0 ? j + 1 : j, side);
            if (!pass_piece(table, e, j, one, other, w)) return false;
        }
    }
    w->clear = larger(w->clear, side * e->w[side > 0 ? high : low]);
    return true;
}

/* Follows the way as far as the last node on the way out.  false: it has ended before. */
static bool follow(const sgt_profile_table *table, const passage *e, way *w)
{
    const size_t last = table->nodes - 1, first = e->first;
    const double nearest = e->w[first + 1];
    glimpse start = w->start;
    size_t at = w->outside ? last : e->begins, low = first + 1;
    const double sign = start.sign;
    if (w->from < -nearest) {
        if (at < first + 1) at = first + 1; /* r^2 at the start may round into the ring before its own */
        if (!w->outside && !pass_piece(table, e, at, start, node(table, e, at, -1), w)) return false;
        if (first + 1 < at && !pass_side(table, e, first + 1, at, -1, sign, w)) return false;
        start = node(table, e, first + 1, -1), at = first;
    }
    if (w->from < nearest)
        at = first;
    else
        low = at + 1;
    if (!pass_piece(table, e, at, start, node(table, e, at + 1, 1), w)) return false;
    return low == last || pass_side(table, e, low, last, 1, sign, w);
}

static bool tell_profile_root(const passage *e, const way *w, double seed, const vicinity *v, size_t i)
{
    double room = 0x1p-13 * (w->at.to - w->at.from), lo = w->at.from - room, hi = w->at.to + room,
           lost = 0x1p-44 * (fabs(e->t0) + fabs(lo) + fabs(hi));
    if (!(lost + e->lost < 0.5 * room)) return false;
    v->lo[i] = (e->t0 + lo) * e->scale, v->hi[i] = (e->t0 + hi) * e->scale;
    v->seed[i] = (e->t0 + seed) * e->scale;
    v->least[i] = w->at.least * (1 - 0x1p-20), v->asked[i] = 0;
    return v->lo[i] < v->hi[i];
}

/* Is the ray above or below the sag from the last node to the edge of the base? */
static bool past_rest(const sgt_profile_table *table, const passage *e, double side)
{
    if (!(table->edge < HUGE_VAL)) return false;
    const double g = side * e->g, near = e->w[table->nodes - 1] * (1 - 0x1p-20),
                 far = sqrt(larger(table->edge - e->q0, 0) / e->a) * (1 + 0x1p-20), one = e->z + g * near,
                 other = e->z + g * far, off = 0x1p-40 * (fabs(e->z) + fabs(g) * far);
    return (one - off > table->high && other - off > table->high) ||
           (one + off < table->low && other + off < table->low);
}

/* Is nothing met beyond the table? */
static bool beyond(sgt_surface s, const sgt_ray *ray, const passage *c, double side, vicinities *kept)
{
    if (past_rest(&kept->table, c, side)) return true;
    const double edge = sqrt(kept->table.q[kept->table.nodes - 1]);
    const double scale = scale_of(ray->d);
    const sgt_outlook e =
        sgt_outlook_of(ray->o, (sgt_vec3){ray->d.x * scale, ray->d.y * scale, ray->d.z * scale});
    return sgt_clear_beyond(s, &e, edge, side, &kept->tails);
}

/* Ray j of these, which is row i of v. */
static along_says look_along_profile(sgt_surface s, const courses *of, size_t j, double *t, vicinities *kept,
                                     const vicinity *v, size_t i)
{
    const sgt_profile_table *table = &kept->table;
    const sgt_ray ray = {
        {of->o[0][j], of->o[1][j], of->o[2][j]}, {of->d[0][j], of->d[1][j], of->d[2][j]}, 0, 0};
    const double reach = of->reach[j], from = of->from[j];
    const size_t last = table->nodes - 1;
    passage e; /* its w are laid below */
    e.q0 = of->q0[j], e.a = of->a[j], e.z = of->z[j], e.g = of->g[j], e.t0 = of->t0[j],
    e.scale = of->scale[j], e.lost = of->lost[j];
    way w = {.from = from, .to = of->to[j], .looks = PROFILE_LOOKS};
    if (of->fine[j] == 0) return ALONG_SILENT;
    w.outside = from <= -reach * (1 - 0x1p-20);
    pass_nodes(table, &e, w.outside ? 0 : e.q0 + e.a * (from * from));
    if (w.outside) {
        if (!(from <= -reach * (1 + 0x1p-20) && beyond(s, &ray, &e, -1, kept))) return ALONG_SILENT;
        w.start = node(table, &e, last, -1);
    } else {
        w.start = seen_of(&e, from, of->sag[j], of->off[j]);
        if (!(w.start.least > 0)) return ALONG_SILENT;
    }
    w.clear = w.outside ? -HUGE_VAL : from;
    v->evals[i] += 1;
    const bool through = follow(table, &e, &w);
    double seen_to = (e.t0 + w.clear - e.lost - 0x1p-45 * fabs(w.clear)) * e.scale;
    if (v->told)
        tell_cell(v->told, SGT_MARCH, *t, larger(*t, seen_to),
                  sgt_interval_between(w.start.sign > 0 ? 0 : -HUGE_VAL, w.start.sign > 0 ? HUGE_VAL : 0),
                  sgt_interval_between(-HUGE_VAL, HUGE_VAL));
    if (w.clear >= w.to) return ALONG_MISS;
    if (w.root && tell_profile_root(&e, &w, root_in(table, &e, &w.at), v, i)) return ALONG_ROOT;
    if (through && beyond(s, &ray, &e, 1, kept)) return ALONG_MISS;
    if (!(seen_to > *t)) return ALONG_SILENT;
    *t = seen_to;
    return ALONG_CLEAR;
}

bool sgt_look_by_profile(sgt_surface s, const sgt_rays *r, size_t count, const size_t row[], double t[],
                         along_says said[], vicinities *kept, const vicinity *v)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    courses of;
    if (!builtin->departure || !builtin->departure->profile || !builtin->base) return false;
    if (!kept->any_table) kept->has_table = make_table(s, &kept->table);
    kept->any_table = true;
    if (!kept->has_table) return true;
    for (size_t j = 0; j < count; j++) {
        size_t i = row[j];
        for (int c = 0; c < 3; c++) of.o[c][j] = r->o[c][i], of.d[c][j] = r->d[c][i];
        of.t[j] = t[j], of.tmax[j] = v->tmax[i];
    }
    lay_courses(&kept->table, count, &of);
    ask_starts(&kept->table, count, &of);
    for (size_t j = 0; j < count; j++) {
        said[j] = look_along_profile(s, &of, j, &t[j], kept, v, row[j]);
        if (v->told && v->told->stopped) break;
    }
    return true;
}
