// SPDX-License-Identifier: MIT
/* batch_f.c - many rays in single precision: sgt_intersect_batch_f of sagitta.h.
 *
 * A tile of rays is first asked in float arithmetic, with a bound on every rounding.  A ray that is not
 * certainly met there is asked in double by sgt_intersect_batch, and its answer is rounded to float with the
 * bound made wider by that.  So the status is always that of the double ray; only t and its bound, the
 * point and the gradient are coarser.
 *
 * u = 2^-24.  There is no fma: a set of instructions without it would have to make it of doubles.  A float
 * product is exact in double.  c, 1 + k and the coefficients are rounded to float once: by u of themselves.
 * Aa, Ba, |C| are the sums of the magnitudes of the terms; a = l^2 + m^2.
 *
 * TO THE VERTEX PLANE.  t0 = -oz / n in float, off by 3 u |t0|.  The rest oz + t0 n is exact in double but
 * for 2^-53 of oz, and t0_lo = -rest / n takes t0 + t0_lo to 9 u^2 |t0| (three roundings of a t0_lo that is
 * at most 3 u |t0|).  x = (ox + t0 l) + t0_lo l is rounded twice.
 *
 * A CONIC has A tau^2 - 2 B tau + C = 0 and tau = C / b, b = B + sign(B) S, S = sqrt D (conic/conic.c).  The
 * errors are, each counted as in conic/easy.h:
 *     x      2 u |x|
 *     A      6 u Aa     c and k1 one each, k1 n n three in all, a two, the sum and the product one each
 *     B      7 u Ba     x two, x l one, the sum one, c and its product two, the sum one
 *     C      8 u |C|    x^2 five, the sum one, c and its product two
 *     D      2 u (D + |A C|) beyond these: B^2, A C and the difference
 * To first order
 *     |dtau| <= u ((4 Aa tau^2 + 7 Ba |tau| + 4 |C|) / S + 4 |tau|),
 * and with Ba^2 + Aa |C| <= q D that is at most u |tau| (4 q + 7 sqrt q + 4 (1 + sqrt q) + 4): 26.1 for q =
 * 4/3, where 28 is taken, and 46 for q = 4, where 50 is.  D is then off by at most 2^-17 of itself, and what
 * is beyond first order is below a thousandth of this.
 *
 * The root is on the sheet if |(1 + k) c z| < 1 - 2^-3 (beyond, the gradient loses digits).  It is the only
 * one in t +- t_err if 2 Aa t_err < S.
 * The other root is b / A, of greater magnitude: it is behind if b A > 0.  Else it has to be off the sheet or
 * before tmin, both by a part in 2^6, if the first root is asked for; |A| > 2^-10 Aa makes it known to a
 * part in 2^11.  (x, y) is off by 3 |x| + 2 |X| u and by 50 u |tau| sqrt a; as in conic/easy.h, PROVEN,
 * 2 sqrt(12) r and 4.47 r bound these, 236 u r in all, and r^2 is off by 475 u of itself; 512 are taken.
 *
 * AN EVEN ASPHERE WITHIN ITS RIM.  Let kappa = |c| / phi + sum 2 (i + 1) |a_i| rho^i at the rim, with phi the
 * least sqrt(1 - (1 + k) c^2 rho) there, at most 1.  The slope at r is at most kappa r.  So along the ray, as
 * long as it is within the rim, F = z - sag has
 *     |F'| >= G = |n| - kappa rim sqrt a.
 * If G > 0, F is monotone on the chord: one root is within the rim, or none.  It is the first, that near the
 * seed, and the only one.  Let F at tau be f to er.  Then the root is within E = (|f| + er) / G of tau, if
 * that stretch is within the rim (mean value).  Newton's step f / g from there, with g = F' there to
 * 2^-17 |n|, leaves
 *     |root - (tau - f / g)| <= (er + |f / g| (M a E + 2^-17 |n|)) / G,
 * where M >= |sag''|: |c| / phi^3 + sum 2 (i + 1) (2 i + 1) |a_i| rho^i.
 *
 *     er = u (kappa (28 rho + 2 rho0) + 3 |z|), where the ray meets the vertex plane at rho0:
 *         the point is off by u (3 r0 + 2 r), which is at most u kappa (3.5 rho + 1.5 rho0) in F;
 *         rho by 2 u; phi^2 >= 1/16 by 7 u, so phi by 15 u and c rho / (1 + phi) by 19 u |c| rho;
 *         P by 38 u sum |a_i| rho^(i+1), which is below 19 u kappa rho less the conic's part;
 *         the sum and z by u of themselves, and |sag| <= kappa rho.
 *
 * 9 u^2 |t0| moves a root by at most 64 times as much in a conic (sag/lanes.h), and by 23 times in an asphere
 * (G >= |n| / 16): below u |t0| / 100, and t_err has that to spare, as |t0| <= |t| + |tau|.  It moves (x, y)
 * by less than 2^-27 rims, as |t0| (|l| + |m|) is at most 2^17 rims; so the side of the rim stays.
 *
 * ACCEPTED (solve/accept.h) has to be certain by much: the start is farther than 2^-18 |t|, of which the rule
 * of the start takes 2^-48 of the terms; tmax is behind; r is within the rim.
 *
 * RANGE.  |c| and |1 + k| are 0 or within 2^+-20, a[i] within 2^+-100; |n| > 2^-20 and |t| > 2^-60.  So what
 * underflows, 2^-149 a product, is below 2^-100 in tau.  What overflows makes a condition false. */
#include "batch.h"

#include "../num/lanes.h"
#include "../solve/root.h"
#include "general.h"

#include <float.h>

static const float U = 0x1p-24f;

typedef unsigned int mask_f;
#define MASK_F(condition) ((condition) ? ~0U : 0U)

SGT_INLINE float chosen_f(mask_f m, float yes, float no) { return m != 0 ? yes : no; }

enum { TILE_F = 128, TERMS_F = 8 };

/* What all rays of a surface share: the numbers of the head.  rim2 is that within which a root is certain. */
typedef struct sag_f {
    float c, abs_c, k1, ck, extra, rim2, reach;
    float kk, a[TERMS_F], slope[TERMS_F], kappa, steep, bend, rim;
    bool first;
} sag_f;

/* Where a tile is written.  Rows that are not wanted go to one array in the first-level cache. */
typedef struct rows_f { float *t, *t_err, *p[3], *n[3], *p_err; mask_f *hit; } rows_f;

/* The columns of a tile.  (By value, so that no output can alias them.) */
typedef struct columns_f { const float *o[3], *d[3], *tmin, *tmax; float t_tol; } columns_f;

/* o + t d, rounded once but for 2^-53 of its terms. */
SGT_INLINE float along_f(float o, float t, float d) { return (float)((double)t * (double)d + (double)o); }

typedef struct place_f { float t0, t0_lo, x, y; } place_f;

SGT_INLINE place_f place_f_of(float ox, float oy, float oz, float l, float m, float n)
{
    float inverse = 1 / n, t0 = -oz * inverse, t0_lo = -along_f(oz, t0, n) * inverse;
    return (place_f){t0, t0_lo, along_f(ox, t0, l) + t0_lo * l, along_f(oy, t0, m) + t0_lo * m};
}

/* Is the root accepted, and sharp? */
SGT_INLINE mask_f accepted_f(float t, float t_err, float tmin, float tmax, float t_tol)
{
    float at = fabsf(t), sharp = 64 * U * at;
    sharp = sharp > t_tol ? sharp : t_tol;
    return MASK_F(t_err <= sharp) & MASK_F(t - 2 * t_err - tmin > 0x1p-18f * at)
           & MASK_F(t + 16 * t_err <= tmax) & MASK_F(at > 0x1p-60f) & MASK_F(at < 0x1p60f);
}

/* How far the point is off: by tau_err along the ray, by rounding, and by the error of t0 + t0_lo. */
SGT_INLINE float place_err(float length, float tau_err, float t0, float x, float y, float px, float py,
                           float pz)
{
    float place = 3 * (fabsf(x) + fabsf(y)) + 2 * (fabsf(px) + fabsf(py)) + fabsf(pz);
    return 1.01f * (length * (tau_err + 1024 * U * U * fabsf(t0)) + U * place);
}

/* other: asks where the other root is, which a bowl that opens toward the start needs.  rich: p_err, too. */
SGT_INLINE mask_f conic_in_lanes(const sag_f *shared, bool other, bool rich, size_t count, columns_f r,
                                 rows_f to)
{
    const sag_f own = *shared, *s = &own;
    mask_f all = ~0U;
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const float ox = r.o[0][i], oy = r.o[1][i], oz = r.o[2][i], l = r.d[0][i], m = r.d[1][i],
                    n = r.d[2][i], tmin = r.tmin[i], tmax = r.tmax[i];
        const place_f at = place_f_of(ox, oy, oz, l, m, n);
        float xl = at.x * l, ym = at.y * m, n2 = n * n, a = l * l + m * m;
        float A = s->c * (s->k1 * n2 + a), Aa = s->extra * n2 + fabsf(A), B = n - s->c * (xl + ym),
              Ba = s->abs_c * (fabsf(xl) + fabsf(ym)) + fabsf(n), C = s->c * (at.x * at.x + at.y * at.y);
        float D = B * B - A * C, size = Ba * Ba + Aa * fabsf(C), S = sqrtf(D), b = B + copysignf(S, B),
              tau = C / b, small = at.t0_lo + tau, t = at.t0 + small;
        float tau_err = (4 * D >= 3 * size ? 28 * U : 50 * U) * fabsf(tau),
              t_err = 1.01f * U * (fabsf(t) + fabsf(small)) + tau_err;
        float px = tau * l + at.x, py = tau * m + at.y, pz = tau * n, w = s->ck * pz, g = -s->c / (1 - w),
              length = fabsf(l) + fabsf(m) + fabsf(n);
        mask_f alone = MASK_F(copysignf(1, b) * A > 0x1p-16f * Aa) | MASK_F(!s->first);
        if (other) {
            float far = b / A, w2 = s->ck * (far * n), t2 = at.t0 + far;
            alone |= MASK_F(fabsf(A) > 0x1p-10f * Aa)
                     & (MASK_F(w2 > 1 + 0x1p-6f)
                        | MASK_F(t2 + 0x1p-6f * (fabsf(at.t0) + fabsf(far)) < tmin));
        }
        mask_f hit = accepted_f(t, t_err, tmin, tmax, r.t_tol) & MASK_F(4 * D > size) & MASK_F(D <= 16 * n2)
                     & MASK_F(fabsf(w) < 1 - 0x1p-3f) & MASK_F(n2 > 0x1p-40f) & MASK_F(2 * Aa * t_err < S)
                     & MASK_F(px * px + py * py <= s->rim2)
                     & MASK_F(fabsf(at.t0) * (fabsf(l) + fabsf(m)) <= s->reach)
                     & alone;
        to.t[i] = t, to.t_err[i] = t_err, to.p[0][i] = px, to.p[1][i] = py, to.p[2][i] = pz;
        to.n[0][i] = px * g, to.n[1][i] = py * g, to.n[2][i] = 1;
        if (rich) to.p_err[i] = place_err(length, tau_err, at.t0, at.x, at.y, px, py, pz);
        to.hit[i] = hit, all &= hit;
    }
    return all;
}

SGT_KERNEL
static mask_f conic_in_floats(const sag_f *s, bool other, size_t count, columns_f r, rows_f to)
{
    return other ? conic_in_lanes(s, true, false, count, r, to)
                 : conic_in_lanes(s, false, false, count, r, to);
}

SGT_KERNEL
SGT_NARROW(mask_f, sgt_conic_in_floats_rich,
           (const sag_f *s, bool other, size_t count, columns_f r, rows_f to))
{
    return other ? conic_in_lanes(s, true, true, count, r, to)
                 : conic_in_lanes(s, false, true, count, r, to);
}

SGT_INLINE mask_f plane_in_lanes(const sag_f *shared, bool rich, size_t count, columns_f r, rows_f to)
{
    const float rim2 = shared->rim2, reach = shared->reach;
    mask_f all = ~0U;
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const float ox = r.o[0][i], oy = r.o[1][i], oz = r.o[2][i], l = r.d[0][i], m = r.d[1][i],
                    n = r.d[2][i], tmin = r.tmin[i], tmax = r.tmax[i];
        const place_f at = place_f_of(ox, oy, oz, l, m, n);
        float t = at.t0 + at.t0_lo, t_err = 1.01f * U * (fabsf(t) + fabsf(at.t0_lo)),
              length = fabsf(l) + fabsf(m) + fabsf(n);
        mask_f hit = accepted_f(t, t_err, tmin, tmax, r.t_tol) & MASK_F(n * n > 0x1p-40f)
                     & MASK_F(at.x * at.x + at.y * at.y <= rim2)
                     & MASK_F(fabsf(at.t0) * (fabsf(l) + fabsf(m)) <= reach);
        to.t[i] = t, to.t_err[i] = t_err, to.p[0][i] = at.x, to.p[1][i] = at.y, to.p[2][i] = 0;
        to.n[0][i] = 0, to.n[1][i] = 0, to.n[2][i] = 1;
        if (rich) to.p_err[i] = place_err(length, 0, at.t0, at.x, at.y, at.x, at.y, 0);
        to.hit[i] = hit, all &= hit;
    }
    return all;
}

/* F at (x, y, z), its slope along the ray, g of its gradient (g x, g y, 1), and r^2.  Written out: a loop
 * inside the loop over rays would keep the compiler from vectorising that. */
typedef struct value_f { float f, slope, g, r2; } value_f;

#define NEXT_F(i) p = p * r2 + s->a[i], dp = dp * r2 + s->slope[i]
SGT_INLINE value_f sag_f_at(const sag_f *s, bool many, float x, float y, float z, float l, float m, float n)
{
    float r2 = x * x + y * y, phi = sqrtf(1 - s->kk * r2), p = 0, dp = 0;
    if (many) p = s->a[7], dp = s->slope[7], NEXT_F(6), NEXT_F(5), NEXT_F(4);
    NEXT_F(3), NEXT_F(2), NEXT_F(1), NEXT_F(0);
    float g = -(s->c / phi + dp);
    return (value_f){z - (s->c * r2 / (1 + phi) + r2 * p), n + g * (x * l + y * m), g, r2};
}

SGT_INLINE mask_f asphere_in_lanes(const sag_f *shared, bool many, bool rich, size_t count, columns_f r,
                                   rows_f to)
{
    const sag_f own = *shared, *s = &own;
    mask_f all = ~0U;
    _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++) {
        const float ox = r.o[0][i], oy = r.o[1][i], oz = r.o[2][i], l = r.d[0][i], m = r.d[1][i],
                    n = r.d[2][i], tmin = r.tmin[i], tmax = r.tmax[i];
        const place_f at = place_f_of(ox, oy, oz, l, m, n);
        float a = l * l + m * m, n2 = n * n, size = fabsf(n), rho0 = at.x * at.x + at.y * at.y;
        float A = s->c * (s->k1 * n2 + a), B = n - s->c * (at.x * l + at.y * m), C = s->c * rho0,
              tau = C / (B + copysignf(sqrtf(B * B - A * C), B)); /* the conic's root is the seed */
        value_f v = sag_f_at(s, many, tau * l + at.x, tau * m + at.y, tau * n, l, m, n);
        tau -= v.f / v.slope;
        float z = tau * n;
        v = sag_f_at(s, many, tau * l + at.x, tau * m + at.y, z, l, m, n);
        float side = sqrtf(a), G = size - s->steep * side,
              er = U * (s->kappa * (28 * v.r2 + 2 * rho0) + 3 * fabsf(z)),
              step = v.f / v.slope, E = 1.01f * (fabsf(v.f) + er) / G,
              off = 1.01f * (er + fabsf(step) * (s->bend * a * E + 0x1p-17f * size)) / G;
        mask_f hit = MASK_F(G > 0x1p-4f * size) & MASK_F(v.r2 <= s->rim2) & MASK_F(E * side <= s->rim)
                     & MASK_F(s->bend * side * fabsf(step) <= 0x1p-18f); /* so far the gradient is off */
        tau -= step;
        float small = at.t0_lo + tau, t = at.t0 + small, tau_err = off + U * fabsf(tau),
              t_err = 1.01f * U * (fabsf(t) + fabsf(small)) + tau_err;
        float px = tau * l + at.x, py = tau * m + at.y, pz = tau * n,
              length = fabsf(l) + fabsf(m) + fabsf(n);
        hit &= accepted_f(t, t_err, tmin, tmax, r.t_tol) & MASK_F(n2 > 0x1p-40f)
               & MASK_F(fabsf(at.t0) * (fabsf(l) + fabsf(m)) <= s->reach);
        to.t[i] = t, to.t_err[i] = t_err, to.p[0][i] = px, to.p[1][i] = py, to.p[2][i] = pz;
        to.n[0][i] = v.g * px, to.n[1][i] = v.g * py, to.n[2][i] = 1;
        if (rich) to.p_err[i] = place_err(length, tau_err, at.t0, at.x, at.y, px, py, pz);
        to.hit[i] = hit, all &= hit;
    }
    return all;
}

SGT_KERNEL
static mask_f few_terms_f(const sag_f *s, bool other, size_t count, columns_f r, rows_f to)
{
    (void)other;
    return asphere_in_lanes(s, false, false, count, r, to);
}

SGT_KERNEL
SGT_NARROW(mask_f, sgt_few_terms_rich_f, (const sag_f *s, bool other, size_t count, columns_f r, rows_f to))
{
    (void)other;
    return asphere_in_lanes(s, false, true, count, r, to);
}

SGT_KERNEL
static mask_f many_terms_f(const sag_f *s, bool other, size_t count, columns_f r, rows_f to)
{
    (void)other;
    return asphere_in_lanes(s, true, false, count, r, to);
}

SGT_KERNEL
SGT_NARROW(mask_f, sgt_many_terms_rich_f, (const sag_f *s, bool other, size_t count, columns_f r, rows_f to))
{
    (void)other;
    return asphere_in_lanes(s, true, true, count, r, to);
}

SGT_KERNEL
static mask_f plane_f(const sag_f *s, bool other, size_t count, columns_f r, rows_f to)
{
    (void)other;
    return plane_in_lanes(s, false, count, r, to);
}

SGT_KERNEL
SGT_NARROW(mask_f, sgt_plane_rich_f, (const sag_f *s, bool other, size_t count, columns_f r, rows_f to))
{
    (void)other;
    return plane_in_lanes(s, true, count, r, to);
}

/* ------------------------------------------------------------------- the surface */

/* The next float above a finite one.  Floats of one sign are in the order of their bits. */
static float next_above_f(float f)
{
    unsigned int bits;
    memcpy(&bits, &f, sizeof bits);
    bits = f == 0 ? 1 : f > 0 ? bits + 1 : bits - 1;
    memcpy(&f, &bits, sizeof bits);
    return f;
}

/* At least x, as a float. */
static float above_f(double x)
{
    float f = (float)x;
    return (double)f < x ? next_above_f(f) : f;
}

static float below_f(double x) { return -above_f(-x); }

typedef mask_f kernel_f(const sag_f *s, bool other, size_t count, columns_f r, rows_f to);

/* The loop that answers for the surface; NULL: none does. */
static kernel_f *sag_f_of(const sgt_even_sag *e, bool first, bool rich, sag_f *s)
{
    const double c = e->c, k1 = 1 + e->k, rim = e->semi_diameter, r2 = rim > 0 ? rim * rim : 0x1p120;
    const bool usual = (c == 0 || (fabs(c) > 0x1p-20 && fabs(c) < 0x1p20)) && fabs(k1) < 0x1p20
                       && (k1 == 0 || fabs(k1) > 0x1p-20) && r2 > 0x1p-80 && r2 <= 0x1p120 && rim >= 0;
    if (!usual) return NULL;
    *s = (sag_f){.c = (float)c, .abs_c = (float)fabs(c), .k1 = (float)k1, .ck = (float)(k1 * c),
                 .extra = k1 < 0 ? above_f(2.01 * fabs(k1 * c)) : 0, .rim2 = below_f(r2 * (1 - 0x1p-15)),
                 .reach = below_f(0x1p17 * sqrt(r2)), .first = first};
    if (e->terms == 0 && c == 0) return rich ? sgt_plane_rich_f : plane_f;
    if (e->terms == 0) return rich ? sgt_conic_in_floats_rich : conic_in_floats;
    const double kk = k1 * c * c, phi2 = 1 - (kk > 0 ? kk * r2 : 0), phi = sqrt(phi2);
    if (!(rim > 0 && fabs(kk) * r2 < 1 - 0x1p-4)) return NULL;
    double slope = fabs(c) / phi, bend = fabs(c) / (phi * phi2), power = 1;
    for (int i = 0; i < e->terms; i++, power *= r2) {
        double size = 2 * (i + 1) * fabs(e->a[i]) * power;
        slope += size, bend += (2 * i + 1) * size;
        s->a[i] = (float)e->a[i], s->slope[i] = (float)(2 * (i + 1) * e->a[i]);
        const double of = fabs(e->a[i]);
        if (of != 0 && !(of > 0x1p-100 && of < 0x1p100)) return NULL; /* no float */
    }
    const double more = 1 + 0x1p-18;
    if (!(slope * rim < 4)) return NULL; /* the gradient is known to 70 u of this */
    s->kk = (float)kk, s->kappa = above_f(slope * more), s->steep = above_f(slope * rim * more);
    s->bend = above_f(bend * more), s->rim = below_f(0x1p-14 * rim), s->rim2 = below_f(r2 * (1 - 0x1p-12));
    if (e->terms > 4) return rich ? sgt_many_terms_rich_f : many_terms_f;
    return rich ? sgt_few_terms_rich_f : few_terms_f;
}

/* ----------------------------------------------------------------------- a tile */

static float *row_of(float *a, size_t from) { return a ? a + from : NULL; }

/* A number of a hit in double, and how far it is from it. */
static float rounded(double x, double *off)
{
    const bool fits = fabs(x) <= (double)FLT_MAX;
    float f = fits ? (float)x : copysignf(FLT_MAX, x < 0 ? -1.0f : 1.0f);
    *off += fits ? fabs(x - (double)f) : HUGE_VAL;
    return f;
}

static float outward(double err)
{
    return err > (double)FLT_MAX ? HUGE_VALF : above_f(err * (1 + 0x1p-50));
}

/* Writes ray i of the tile from an answer in double. */
static void put_double(const sgt_hits_f *h, size_t i, const sgt_hits *d, size_t k)
{
    const bool met = d->status[k] > 0;
    double t_off = d->t_err[k], p_off = d->p_err[k];
    float t = met ? rounded(d->t[k], &t_off) : NAN, p[3];
    for (int j = 0; j < 3; j++) p[j] = met ? rounded(d->p[j][k], &p_off) : NAN;
    if (h->status) h->status[i] = d->status[k];
    if (h->t) h->t[i] = t;
    if (h->t_err) h->t_err[i] = met ? outward(t_off) : NAN;
    if (h->p_err) h->p_err[i] = met ? outward(p_off) : NAN;
    for (int j = 0; j < 3; j++) {
        if (h->p[0]) h->p[j][i] = p[j];
        if (h->n[0]) h->n[j][i] = met ? (float)d->n[j][k] : NAN;
    }
}

enum { IN_DOUBLE = 64 };

/* Asks in double the rays that are not met, some at a time.  Returns how many of all are met. */
SGT_NOINLINE static size_t by_double(sgt_surface s, size_t count, const columns_f *r, const mask_f *hit,
                                     const sgt_hits_f *h, const sgt_options *opt)
{
    double x[8][IN_DOUBLE], y[9][IN_DOUBLE];
    sgt_status status[IN_DOUBLE];
    size_t index[IN_DOUBLE], met = 0;
    const sgt_rays rays = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6], x[7]};
    const sgt_hits hits = {.status = status, .t = y[0], .t_err = y[1], .p = {y[2], y[3], y[4]},
                           .n = {y[5], y[6], y[7]}, .p_err = y[8]};
    for (size_t i = 0; i < count;) {
        size_t n = 0;
        for (; i < count && n < IN_DOUBLE; i++) {
            if (hit && hit[i]) { met++; continue; }
            for (int j = 0; j < 3; j++) x[j][n] = (double)r->o[j][i], x[3 + j][n] = (double)r->d[j][i];
            x[6][n] = (double)r->tmin[i], x[7][n] = (double)r->tmax[i], index[n++] = i;
        }
        if (n > 0) met += sgt_intersect_batch(s, n, rays, hits, opt);
        for (size_t k = 0; k < n; k++) put_double(h, index[k], &hits, k);
    }
    return met;
}

static sgt_hits_f hits_f_from(const sgt_hits_f *h, size_t from)
{
    sgt_hits_f to = {.status = h->status ? h->status + from : NULL, .t = row_of(h->t, from),
                     .t_err = row_of(h->t_err, from), .p_err = row_of(h->p_err, from)};
    for (int j = 0; j < 3; j++) to.p[j] = row_of(h->p[j], from), to.n[j] = row_of(h->n[j], from);
    return to;
}

/* The loop for these options; NULL: all rays are asked in double. */
static kernel_f *floats_loop_of(sgt_surface s, const sgt_options *opt, bool rich, sag_f *shared)
{
    sgt_even_sag sag;
    const bool both = opt->proof == SGT_PROVE_FIRST && opt->pick == SGT_NEAR_SEED,
               few = opt->max_evals > 0 && opt->max_evals < 64;
    if (opt->watch || both || few || !sgt_options_valid(opt)) return NULL;
    if (!s.ops || !s.ops->own_ || !s.ops->own_->even_sag || !s.ops->own_->even_sag(s.self, &sag)) return NULL;
    return sag_f_of(&sag, opt->pick != SGT_NEAR_SEED, rich, shared);
}

size_t sgt_intersect_batch_f(sgt_surface s, size_t n, sgt_rays_f rays, sgt_hits_f hits,
                             const sgt_options *opt)
{
    static const sgt_options none = {0};
    _Alignas(64) float unwanted[TILE_F];
    float ends[TILE_F], starts[TILE_F];
    mask_f hit[TILE_F];
    if (!opt) opt = &none;
    if (!ROOM_IS_ZERO(&hits)) opt = &sgt_options_invalid;
    s = in_set(s);
    sag_f shared;
    kernel_f *kernel = floats_loop_of(s, opt, hits.p_err != NULL, &shared);
    for (size_t i = 0; i < TILE_F && i < n; i++) starts[i] = 0, ends[i] = HUGE_VALF;
    size_t met = 0;
    bool other = false; /* was it asked of the last tile? */
    for (size_t from = 0; from < n; from += TILE_F) {
        const size_t count = n - from < TILE_F ? n - from : TILE_F;
        columns_f r = {.tmin = rays.tmin ? rays.tmin + from : starts,
                       .tmax = rays.tmax ? rays.tmax + from : ends, .t_tol = (float)opt->t_tol};
        for (int j = 0; j < 3; j++) r.o[j] = rays.o[j] + from, r.d[j] = rays.d[j] + from;
        const sgt_hits_f h = hits_f_from(&hits, from);
        rows_f to = {.t = h.t ? h.t : unwanted, .t_err = h.t_err ? h.t_err : unwanted,
                     .p_err = h.p_err ? h.p_err : unwanted, .hit = hit};
        for (int j = 0; j < 3; j++)
            to.p[j] = h.p[0] ? h.p[j] : unwanted, to.n[j] = h.n[0] ? h.n[j] : unwanted;
        /* the first root of a conic may be certain only by the other one, which costs a quotient */
        bool all = kernel && kernel(&shared, other, count, r, to) != 0;
        if (kernel && !all && !other && shared.first)
            other = true, all = kernel(&shared, other, count, r, to) != 0;
        if (kernel && h.status) memset(h.status, SGT_HIT, count);
        met += all ? count : by_double(s, count, &r, kernel ? hit : NULL, &h, opt);
    }
    return met;
}
