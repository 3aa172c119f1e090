// SPDX-License-Identifier: MIT
/* waves.h - a phase in waves: gratings, diffractive lenses, holograms; and facets (system.h has what it is).
 *
 * THE RULE.  The eikonal jumps by S = per_wave W on the surface.  Its gradient along the surface is
 * continuous but for that of S (Welford 1975, Opt. Commun. 14, 322).  With u = n1 d + G, G = per_wave grad W,
 * and N the unit normal,
 *
 *     t = u - (u . N) N,    n2 d' = t + sigma sqrt(q) N,    q = n2^2 - |t|^2,
 *
 * sigma being the sign of d . N, and of -d . N for a mirror.  It is not that of u . N: on a steep surface G
 * may turn u over.  q <= 0 is the evanescent order.
 *
 * ROUNDING.  With v = 2^-53, u is off by v (n1 |d| + |u|).  t = fma(-k, N, u) rounds once more.  What
 * k = u . N is off by moves t along N, which does not change |t| to first order.  |t| itself takes 2.5 v of
 * it.  Together |t| is off by less than 8 v (n1 + |G|), for W as its surface gives it; 2.2 v is the most that
 * tests have seen.  q is (n2 - |t|) (n2 + |t|), where the difference is exact when it is small.  So the fate
 * is right if |t| is farther than that from n2.  The part that is left along N changes the length of n2 d',
 * which one Newton step mends.  If it is too large for that, as G is along the normal and 2^25 n2 and more,
 * the ray is lost.
 *
 * THE DERIVATIVES.  Let n be the gradient as it comes, and p' = n2 d' = u + f n2 n.  From |p'| = n2, and with
 * s = d' . n,
 *
 *     du = n1 dd + d dn1 + per_wave H_W dp,    dd' = (du - d' dn2) / n2 + f dn + n df,
 *     s df = dn2 / n2 - (d' . du) / n2 - f d' . dn.
 *
 * Transposed, with a the adjoint of d', b = a . n / s and c = a - b d':
 *
 *     A_u = c / n2,    A_n = f c,    A_n1 = A_u . d,    A_n2 = (b - a . d') / n2.
 *
 * And dS = G . dp (chain.h).  f is ((d' . n) - (u . n) / n2) / (n . n).
 *
 * ERRORS.  d' is off by what t is off by, over n2 and the cosine behind, and by some roundings.  W is off by
 * `rounding` of its surface.  The gradient of W:
 *
 *     conics, even aspheres    as aim_bound.c has it of their normals
 *     departures               as they tell (departure.h), and the conic base
 *     formulas                 how far it is from its enclosure at the point; with kinks, from that of all
 *                              points that may have been met
 *     a user's                 64 v of it, a guess
 *
 * BUNDLES.  G is a form: waves.c.
 *
 * FACETS (a Fresnel surface) are the same with G = 0 and, for N, the normal of the sag s that is described,
 * m = (-s_x, -s_y, 1).  So t = n1 d - (n1 d . m) m / m^2, and q <= 0 is total reflection.  Light has to come
 * to the front of the facet and to leave on the side of the surface that it is meant for: d . m and d . n are
 * of one sign, and so are d' . n and d . n (of a mirror: not).  Else no facet does that, and the ray is lost.
 * In the derivatives n is m, and dn = -s_xy dp; the gradient of the surface has a say in the point only.  S
 * is NaN. An error e of the slopes turns m and moves d' by |f| e (1 + |m| / |s|), s = d' . m.
 *
 * Test: tests/unit/test_waves.c, tests/batch/test_trace_batch.c, tests/oracle/test_waves.py (50 digits),
 * tests/sensitivity/test_evanescent.cpp (the limit); derivatives, errors and bundles:
 * tests/sensitivity/test_ideal.cpp. */
#ifndef SGT_SYSTEM_WAVES_H
#define SGT_SYSTEM_WAVES_H

#include "form.h"
#include "trace.h"

SGT_INLINE bool is_in_waves(const sgt_phase *a)
{
    return a->kind == SGT_PHASE_SAG || a->kind == SGT_PHASE_FUNCTION || a->kind == SGT_FACETS;
}

SGT_INLINE bool is_faceted(const sgt_phase *a) { return a->kind == SGT_FACETS; }

/* Is the function of `waves` a sag? */
SGT_INLINE bool has_sag(const sgt_phase *a) { return a->kind == SGT_PHASE_SAG || is_faceted(a); }

/* S per wave. */
SGT_INLINE double path_per_wave(const sgt_phase *a) { return is_faceted(a) ? (double)NAN : a->per_wave; }

/* What the second derivatives of W are of in the chain rule: of G, or of the normal of facets. */
SGT_INLINE double second_factor(const sgt_phase *a) { return is_faceted(a) ? -1 : a->per_wave; }

/* Is it one, with a function that can be asked?  (waves.c) */
bool sgt_waves_sound(const sgt_phase *a);

/* W and its gradient at a point; NaN where they are not defined.  The phase is sound.  (waves.c) */
typedef struct waves_here { double w; sgt_vec3 g; } waves_here;
waves_here sgt_waves_at(const sgt_phase *a, sgt_vec3 p);

/* The same of n points, n <= WAVES_MOST.  No array is NULL, and none is one of p. */
enum { WAVES_MOST = 128 };
void sgt_waves_tile(const sgt_phase *a, size_t n, sgt_points p, double *w, double *const g[3]);

/* The second derivatives of W: xx, xy, xz, yy, yz, zz.  false: there are none, all are NaN. */
bool sgt_waves_second(const sgt_phase *a, size_t n, sgt_points p, double *const out[6]);

/* How far W and its gradient as computed are off at p (a vector: its length), for a point that is met within
 * p_err of it. */
typedef struct waves_off { double w, g; } waves_off;
waves_off sgt_waves_off(const sgt_phase *a, sgt_vec3 p, double p_err, waves_here here);

/* Is it a formula with |a|, min, max or hypot, so that its gradient may jump? */
bool sgt_has_kinks(sgt_surface s);

/* Of such a formula: how far n, its gradient as computed, may be from that of a point within p_err of p. */
double sgt_kink_off(sgt_surface s, sgt_vec3 p, double p_err, sgt_vec3 n);

/* What is the same for all rays. */
typedef struct kick { double n1, n2, by_n2, per_wave; bool back; } kick;

SGT_INLINE kick kick_of(const sgt_phase *a, double n1, double n2, bool mirror)
{
    return (kick){n1, n2, 1 / n2, is_faceted(a) ? 0 : a->per_wave, mirror};
}

/* The direction behind, and n . n, q, |t| and the excess it was made with. */
typedef struct kicked { sgt_vec3 d; double G, q, t, e; } kicked;

SGT_INLINE sgt_vec3 kick_momentum(kick by, sgt_vec3 g, sgt_vec3 d)
{
    return (sgt_vec3){sgt_fma(by.per_wave, g.x, by.n1 * d.x), sgt_fma(by.per_wave, g.y, by.n1 * d.y),
                      sgt_fma(by.per_wave, g.z, by.n1 * d.z)};
}

/* back: that of the kick, a constant in loops. */
SGT_INLINE kicked kick_by(bool back, kick by, sgt_vec3 g, sgt_vec3 d, sgt_vec3 n)
{
    const sgt_vec3 u = kick_momentum(by, g, d);
    const double G = dot(n, n), inverse = 1 / G, slope = dot(d, n), k = dot(u, n) * inverse;
    const sgt_vec3 t = {sgt_fma(-k, n.x, u.x), sgt_fma(-k, n.y, u.y), sgt_fma(-k, n.z, u.z)};
    const double size = sqrt(dot(t, t)), q = (by.n2 - size) * (by.n2 + size);
    const double along = copysign(sqrt(q * inverse), back ? -slope : slope);
    kicked b = {.G = G, .q = q, .t = size};
    b.d = (sgt_vec3){sgt_fma(along, n.x, t.x) * by.by_n2, sgt_fma(along, n.y, t.y) * by.by_n2,
                     sgt_fma(along, n.z, t.z) * by.by_n2};
    b.e = excess(b.d);
    b.d = corrected(b.d, b.e);
    return b;
}

SGT_INLINE sgt_vec3 facet_normal(sgt_vec3 g) { return (sgt_vec3){-g.x, -g.y, 1}; }

/* The same by facets of the slopes g, on a surface with the gradient n.  q is NaN if light does not come to
 * their front, and e infinite if it does not go on as it should. */
SGT_INLINE kicked facet_by(bool back, kick by, sgt_vec3 g, sgt_vec3 d, sgt_vec3 n)
{
    const sgt_vec3 m = facet_normal(g), none = {0, 0, 0};
    kicked b = kick_by(back, by, none, d, m);
    const double in = dot(d, n), out = dot(b.d, n);
    b.q = in * dot(d, m) > 0 ? b.q : (double)NAN;
    b.e = (back ? -out * in : out * in) > 0 ? b.e : HUGE_VAL;
    return b;
}

/* `if_so` if there is such a direction, else 0; 0 for NaN.  Selects only, no branches. */
SGT_INLINE double where_kicked(kicked b, double if_so)
{
    double a = b.G >= 0x1p-200 ? if_so : 0, c = b.G <= 0x1p200 ? a : 0, q = b.q > 0 ? c : 0;
    return fabs(b.e) <= NEAR_UNIT ? q : 0;
}

/* The path with S.  per_wave: path_per_wave. */
SGT_INLINE twofold kick_path(double per_wave, double w, twofold path)
{
    return twofold_sum(path, two_product(per_wave, w));
}

#endif
