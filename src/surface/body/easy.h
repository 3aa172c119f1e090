// SPDX-License-Identifier: MIT
/* easy.h - rays and surfaces of the second degree in closed form, without a branch: a lane and a single ray
 * alike.
 *
 * The parabola is that of quadratic.h: g = A tau^2 + 2 B tau + C from the point of the ray nearest the
 * centre.  Its roots are a guess, t1 + left, of which no bound is asked.  From o + t1 d, which is right to an
 * ulp of each coordinate, `left` leads to the point p.  There F, its gradient and the bound on its rounding
 * are worked out.  All that is told of the root rests on them.
 *
 * THE ROOT.  Along the ray from p, F is f + s v + K v^2 with K = UNIT A, and the exact ray passes p at a
 * distance of at most e in each coordinate.  The point X at t1 is right to u |X|, and p is made of it by one
 * fma: e_x = u (|X_x| + |p_x|) <= u (2 |p_x| + 2.01 |left|), as |d| < 2 in each component.  So |f - F| <= r,
 * the rounding of F + sum e |F_x| + H (sum e)^2, where H is at least the sum of the magnitudes of all second
 * derivatives of F.  Let s be the slope as computed.  Its products are off by less than 8 u of what they are
 * made of.  That is at most 8 u (H E + L) in all, with E = sum e / u and L twice the sum of the linear
 * terms' magnitudes; and e moves it by 2 u H E.  Where |s| > 2^-38 (H E + L) it is right to 2^-11 of itself.
 * K is right to 2^-12 of itself where |A| > 2^-36 Aa (E of quadratic.h is 2^-49).  Let G = |F| + r, and 2^12
 * K G <= s^2.  With w = 1.01 G / |s|,
 *     |s| (1 - 2^-11) w - 1.01 K w^2 > 1.009 G - 0.001 G > |f|,
 * so F has unlike signs at both ends of p +- w: a root lies between.  The other one is as far from it as the
 * slope there is above K: at least 0.99 |s| / K.  So it is not in between.
 *
 * THE STEP.  At the root f + (s + K v) v = 0, so v + F / s is at most r / |s|, and 2^-10 |F / s| for what K v
 * and s are off (K w is below 2^-11 |s|), and a rounding.  So t is taken a step of Newton's from p, at no
 * further evaluation, and the point is told where it is.  1 / |s| is taken from the guess, 1 / 2 S, where the
 * computed slope says that it is right to 2^-10: `inverse` is that, made greater.  The step is then off by
 * another 2^-9 of itself.  In all, t is off by at most (1.02 r + 2^-8 |F|) `inverse`.  Where |F| > 32 r the
 * guess is bad, and the ray is hard; any number would be sound.
 *
 * WHICH OF THE TWO.  F falls toward the vertex from both roots.  So if s and A have unlike signs, the other
 * root is behind this one: it is the first.  If they have like signs, it is the second, and the first lies
 * at least 0.99 |s| / K before it.  If that is before tmin, no root comes before the second.  If Aa = 0, no
 * term of A but what underflows is left: with H < 2^100, |A| < 2^-950, as d is off by 2^-1074.  So with |s|
 * > 2^-400 the other root is 2^550 away, and where tmin > -2^400 it is not before this one.  A start is
 * the only root where H = 0, or where the ray ends before 2^400.  (Near the seed a root 2^550 away is not
 * looked for.)
 *
 * A START ON THE SURFACE is judged as in quadratic.h: by F at the start, K and the slope there, all of them
 * as above.  If it is the second root or the only one, no root is accepted.  If it is the first, that is not
 * accepted, and the second is looked for.  (No ray is both met and on the surface.  A root that is met lies
 * END_ERRORS t_err and more behind the start.  A start on the surface is within 1.2 roundings of F and half
 * of the rule.  So it does not matter which is tried first.)
 *
 * ACCEPTED is a root by the rule of acceptance_of (solve/step.h) with its END_ERRORS.
 *
 * A MISS.  D < -De (quadratic.h), where no coefficient is made of what underflows; or D > 2^-10 N, N = Ba^2 +
 * Aa Ca, and |A| > 2^-10 Aa: then both roots are known to less than 2^-20 (|tau| + their distance).  The
 * bound is 32 u spread / S (quadratic.h), S > 2^-5 Ba and S^2 > 2^-10 Aa Ca.  So Ca / S < 2^10 S / Aa <=
 * 2^9 times the distance 2 S / |A|; 2 Ba |tau| / S < 2^6 |tau|; |A tau| <= |B| + S < 2^6 S, so Aa tau^2 / S <
 * 2^16 |tau|.  A root is not accepted where it lies beyond an end by more than that.
 *
 * UNDERFLOW.  The scaled d has a component in [1, 2), and is off by 2^-1074 where others underflow.  No sum
 * of squares or products is off by more than 2^-1070 (1 + |x| + |y| + |z|) beyond what is said above, and
 * where a miss asks for their bounds they are above 2^-900 of that.  F's own bound knows of it; for the
 * point (2^-993 + 2^-1053 |t1|) |grad F| is added to r.  As |s| < 2 |grad F|, t_err is then above 2^-998
 * lengths of the scaled d, and a root within START_LEAST of the start is not accepted.  A t or a bound beyond
 * the doubles is hard.
 *
 * All else is hard: rays that graze, that start within a part in 50 of the chord behind the first root and
 * not on the surface, ends beside a root, numbers out of range.  quadratic.h answers them, through `first`.
 *
 * THREE LOOPS, as sag/lanes.h says why: the parabola, its roots, the place.  Misses and starts have loops of
 * their own, for tiles that seem to have any: that of misses asks for the magnitudes of all terms.
 *
 * WHY APART.  By `first` and the lanes of ray/lanes.c a batch costs 2.9 and 3.3 times the instructions
 * (quadric, ellipsoid; by callgrind, AVX2). */
#ifndef SGT_SURFACE_BODY_EASY_H
#define SGT_SURFACE_BODY_EASY_H

#include "../../solve/step.h"
#include "../sag/lanes.h"
#include "quadratic.h"

/* What the first loop leaves for the second, and what that makes of it.
 *
 *   t0 A B C      the parabola, from t0
 *   t1 left       a root, as nearly as closed forms tell: the first, or the second if the first is before
 *                 tmin or at the start (on)
 *   inverse       that of the magnitude of its slope there
 * on: the ray starts at the first root, so the second is wanted. */
typedef struct easy_parabola { double t0, A, B, C; } easy_parabola;
typedef struct easy_aim { double t1, left, inverse; } easy_aim;

SGT_INLINE easy_aim easy_aim_of(const easy_parabola *p, double from, mask on)
{
    const double A = p->A, B = p->B, D = B * B - A * p->C, S = sqrt(larger(D, 0)), q = -(B + copysign(S, B)),
                 by = 1 / (S * q), near = p->C * (S * by), away = q / A, half = (0.5 * q) * by;
    const mask up = MASK(A * copysign(1, B) > 0);
    const double first = chosen(up, away, near), second = chosen(up, near, away);
    const mask ahead = MASK(p->t0 + first > from) & ~on;
    const twofold t = two_sum(p->t0, chosen(ahead, first, second));
    return (easy_aim){t.hi, t.lo, fabs(half)};
}

/* Does the ray certainly miss?  (A MISS.) */
SGT_INLINE mask easy_misses(const parabola *p, const near_ray *r, double tmin, double tmax)
{
    const double A = p->A, B = p->B, D = B * B - A * p->C, size = p->Ba * p->Ba + p->Aa * p->Ca,
                 S = sqrt(larger(D, 0)), half = S / fabs(A), mid = -B / A, first = mid - half,
                 second = mid + half, from = tmin * r->inverse, to = tmax * r->inverse, t0 = r->t0,
                 least = 0x1p-900 * (1 + (fabs(r->x.x) + fabs(r->x.y) + fabs(r->x.z))),
                 slack = 0x1p-20 * (fabs(t0) + fabs(mid) + half);
    const mask known = MASK(D > 0x1p-10 * size) & MASK(fabs(A) > 0x1p-10 * p->Aa),
               fine = MASK(p->Aa > least) & MASK(p->Ca > least) & MASK(size > 0x1p-900) &
                      MASK(size < HUGE_VAL),
               valid = MASK(tmin <= tmax) & MASK(tmin < HUGE_VAL) & MASK(tmax > -HUGE_VAL);
    const mask past = MASK(t0 + second + slack < from), later = MASK(t0 + first - slack > to),
               both = MASK(t0 + first + slack < from) & MASK(t0 + second - slack > to);
    return fine & valid & (MASK(D < -DISCRIMINANT * size) | (known & (past | later | both)));
}

/* Has the direction been scaled exactly? */
SGT_INLINE mask easy_whole(const near_ray *r, sgt_vec3 d)
{
    return MASK(r->d.x * r->inverse == d.x) & MASK(r->d.y * r->inverse == d.y) &
           MASK(r->d.z * r->inverse == d.z) & MASK(r->scale < 0x1p1000) & MASK(r->scale > 0x1p-1000);
}

/* What is worked out at p: F, its gradient, and the bound on its rounding. */
typedef struct easy_place { double f, x, y, z, own; } easy_place;

/* What all rays share: UNIT, H and L + 2^-860. */
typedef struct easy_shared { double unit, inverse_unit, bent, linear; } easy_shared;

/* Does the ray start on the surface?  first: at the first root of two; gone: at the last of its roots. */
typedef struct easy_outset { mask first, gone; } easy_outset;

/* p: the start, `from` of the scaled direction (NaN: the ends of the ray are not valid); it ends at `to`. */
SGT_INLINE easy_outset easy_outset_of(const easy_shared *s, const near_ray *r, bool round, double A,
                                      double Aa, sgt_vec3 p, easy_place at, double from, double to)
{
    const double px = fabs(p.x), py = fabs(p.y), pz = fabs(p.z), gx = fabs(at.x), gy = fabs(at.y),
                 gz = fabs(at.z), terms = px * gx + py * gy + pz * gz, E = 2 * (px + py + pz),
                 bent = s->bent * E,
                 slope = at.x * r->d.x + at.y * r->d.y + at.z * r->d.z, steep = fabs(slope), f = fabs(at.f),
                 err = at.own + SGT_U * ((4 * terms + 0x1p-940 * (gx + gy + gz)) + bent * (SGT_U * E)),
                 K = fabs(A) * s->unit, width = START_ULPS * terms;
    const mask linear = round ? 0
                              : MASK(Aa == 0) & MASK(steep > 0x1p-400) &
                                    (MASK(s->bent == 0) | (MASK(s->bent < 0x1p100) & MASK(to < 0x1p400))),
               bends = MASK(fabs(A) > 0x1p-900) & (round ? MASK(true) : MASK(fabs(A) > 0x1p-36 * Aa)),
               falls = MASK((round ? slope : slope * copysign(1, A)) < 0);
    const mask on = MASK(f <= 0.5 * width + 0.125 * err) & MASK(err <= 16 * width) & MASK(width > TINY) &
                    MASK(fabs(from) < 0x1p400) & MASK(steep > 0x1p-38 * (bent + s->linear)) &
                    MASK(0x1p12 * K * (f + err) <= steep * steep) & MASK(steep * steep < HUGE_VAL) &
                    MASK(steep * steep > 0x1p-1000) & MASK(r->scale < 0x1p1000);
    return (easy_outset){on & ~linear & bends & falls, on & (linear | (bends & ~falls))};
}

/* The answer.  hit: met; leads: it is the first root of the whole line. */
typedef struct easy_root { double t, t_err, t_lo, p_err; mask hit, leads; } easy_root;

/* p: the point at t1 + left; on: the first root is the start.  The numbers up to the last lines are of the
 * scaled direction. */
SGT_INLINE easy_root easy_root_of(const easy_shared *s, const near_ray *r, bool round, double A, double Aa,
                                  easy_aim aim, mask on, sgt_vec3 p, easy_place at, double tmin, double tmax)
{
    const double px = fabs(p.x), py = fabs(p.y), pz = fabs(p.z), gx = fabs(at.x), gy = fabs(at.y),
                 gz = fabs(at.z), left = fabs(aim.left);
    const double terms = px * gx + py * gy + pz * gz, E = 2 * (px + py + pz) + 6.1 * left, bent = s->bent * E,
                 slope = at.x * r->d.x + at.y * r->d.y + at.z * r->d.z, steep = fabs(slope), f = fabs(at.f),
                 missed = (2.02 * left + 0x1p-940) + 0x1p-1000 * fabs(aim.t1),
                 err = at.own + SGT_U * ((2.002 * terms + missed * (gx + gy + gz)) + bent * (SGT_U * E)),
                 G = f + err, K = fabs(A) * s->unit, by = aim.inverse * s->inverse_unit,
                 right = steep * by, inverse = 1.002 * by, tau = aim.left - at.f * copysign(by, slope);
    const twofold t = two_sum(aim.t1, tau);
    const double t_err = fabs(t.lo) + ((1.02 * err + 0x1p-8 * f) * inverse + 2 * SGT_U * fabs(tau)),
                 from = tmin * r->inverse, to = tmax * r->inverse, after = t.hi - from,
                 ulps = SGT_U * fabs(t.hi),
                 start = (END_ERRORS + 1) * t_err + (START_ULPS * terms * inverse + (END_ERRORS + 8) * ulps);
    const mask linear = round ? 0
                              : MASK(Aa == 0) & MASK(from > -0x1p400) & MASK(steep > 0x1p-400) &
                                    MASK(s->bent < 0x1p100),
               bends = MASK(fabs(A) > 0x1p-900) & (round ? MASK(true) : MASK(fabs(A) > 0x1p-36 * Aa)),
               falls = MASK((round ? slope : slope * copysign(1, A)) < 0),
               alone = on | MASK((after + t_err) * K < 0.98 * steep);
    const mask root = MASK(f <= 32 * err) & MASK(right > 1 - 0x1p-10) & MASK(right < 1 + 0x1p-10) &
                      MASK(steep > 0x1p-38 * (bent + s->linear)) & MASK(0x1p12 * K * G <= steep * steep) &
                      (linear | (bends & (falls | alone)));
    easy_root e;
    e.t = t.hi * r->scale, e.t_lo = t.lo * r->scale, e.t_err = t_err * (1 + 8 * SGT_U) * r->scale;
    e.p_err = (fabs(r->d.x) + fabs(r->d.y) + fabs(r->d.z)) * (1.02 * G * inverse) + 1.01 * SGT_U * E;
    e.hit = root & MASK(after > start) & MASK(t.hi + END_ERRORS * (t_err + ulps) <= to) &
            MASK(e.t_err > 0x1p-1000) & MASK(r->scale < 0x1p1000) & MASK(fabs(e.t) < HUGE_VAL) &
            MASK(e.t_err < HUGE_VAL) & MASK(e.p_err < HUGE_VAL);
    e.leads = linear | falls;
    return e;
}

/* What the loops leave for each other: t0, A, B, C, then t1, A, left, inverse; Aa; which rays start at the
 * first root. */
typedef struct easy_room {
    _Alignas(64) double t0[SGT_TILE];
    double A[SGT_TILE], B[SGT_TILE], C[SGT_TILE], Aa[SGT_TILE];
    mask on[SGT_TILE];
} easy_room;

/* NaN of rays that are not met. */
SGT_KERNEL
static void easy_unmet(const lane_to *to, size_t count)
{
    const lane_to own = *to;
    const double none = (double)NAN;
    LANES for (size_t i = 0; i < count; i++)
    {
        const mask hit = own.hit[i];
        own.t[i] = chosen(hit, own.t[i], none), own.t_err[i] = chosen(hit, own.t_err[i], none);
        own.px[i] = chosen(hit, own.px[i], none), own.py[i] = chosen(hit, own.py[i], none);
        own.pz[i] = chosen(hit, own.pz[i], none), own.nx[i] = chosen(hit, own.nx[i], none);
        own.ny[i] = chosen(hit, own.ny[i], none), own.nz[i] = chosen(hit, own.nz[i], none);
        own.t_lo[i] = chosen(hit, own.t_lo[i], none), own.p_err[i] = chosen(hit, own.p_err[i], none);
    }
}

/* Is there a ray that is neither met nor known to miss? */
SGT_NOINLINE static bool easy_left(size_t n, const mask *hit, const mask *none)
{
    mask all = MASK(true);
    for (size_t i = 0; i < n; i++) all &= hit[i] | none[i];
    return all == 0;
}

/* Writes what is known of a tile.  to: NULL if no ray is met.  Returns how many rays are hard. */
SGT_NOINLINE static size_t easy_told(const sgt_tile *tile, const lane_to *to, mask all, const mask *none,
                                     const mask *gone)
{
    const size_t n = tile->n;
    size_t hard = 0;
    if (all != 0) memset(tile->hits.status, SGT_HIT, n);
    else if (to) easy_unmet(to, n);
    for (size_t i = 0; all == 0 && i < n; i++) {
        const mask hit = to ? to->hit[i] : 0, left = ~(hit | none[i] | gone[i]);
        tile->hits.status[i] = (signed char)((int)(hit & SGT_HIT) | (int)(left & (mask)SGT_HARD));
        hard += left != 0;
    }
    for (size_t i = 0; tile->hits.evals && i < n; i++) tile->hits.evals[i] = tile->hits.status[i] == SGT_HIT;
    return hard;
}

/* The answer of a single ray.  false: it is hard. */
static bool easy_answer_of(const easy_root *e, mask none, sgt_vec3 p, easy_place at, const sgt_ray *ray,
                           const sgt_options *opt, sgt_hit *hit)
{
    if (e->hit == 0) *hit = hit_without(SGT_MISS, ray, 0);
    if (e->hit == 0) return none != 0;
    tally w = {.opt = opt};
    const meeting h = {.t = e->t, .t_lo = e->t_lo, .t_err = e->t_err, .p_err = e->p_err, .p = p,
                       .n = {at.x, at.y, at.z}};
    *hit = hit_at(&h, SGT_HIT, at.f, SGT_SEED, ray, &w);
    return true;
}

/* Defines NAME_easy and NAME_easy_one (`easy`, `easy_one` of sgt_builtin_ops) for a surface of this kind:
 *
 *   SELF, OBJECT               its type; is a parameter invalid?
 *   ROUND                      is A a sum of squares, right to 2^-12 of itself?
 *   SHARED, MADE(self)         what all rays share: with `self`, and `easy`, an easy_shared
 *   APPROACH(s, o, d, &p, &r)  makes the parabola and the local ray, from SELF
 *   PLACE(&a, p)               an easy_place
 *
 * near: only the first root of the whole line is wanted. */
#define EASY_LANES(NAME, SELF, OBJECT, ROUND, SHARED, MADE, APPROACH, PLACE)                                \
    SGT_KERNEL                                                                                              \
    static void NAME##_easy_begin(const SHARED *shared, size_t count, const sgt_rays *rays, easy_room *room) \
    {                                                                                                       \
        const SELF s = shared->self;                                                                        \
        const sgt_rays in = *rays;                                                                          \
        LANES for (size_t i = 0; i < count; i++)                                                            \
        {                                                                                                   \
            const sgt_ray ray = lane_ray_of(&in, i);                                                        \
            parabola q;                                                                                     \
            near_ray r;                                                                                     \
            APPROACH(&s, ray.o, ray.d, &q, &r);                                                             \
            room->t0[i] = r.t0, room->A[i] = q.A, room->B[i] = q.B, room->C[i] = q.C, room->Aa[i] = q.Aa;   \
        }                                                                                                   \
    }                                                                                                       \
    SGT_INLINE easy_root NAME##_easy_end(const SHARED *s, const sgt_ray *ray, double A, double Aa,          \
                                         easy_aim aim, mask on, sgt_vec3 *p, easy_place *at)                \
    {                                                                                                       \
        const near_ray r = near_ray_of(ray->d);                                                             \
        const double l = r.d.x, m = r.d.y, n = r.d.z, t = aim.t1, left = aim.left;                          \
        const sgt_vec3 x = {moved_along(ray->o.x, t, l), moved_along(ray->o.y, t, m),                       \
                            moved_along(ray->o.z, t, n)};                                                   \
        *p = (sgt_vec3){sgt_fma(left, l, x.x), sgt_fma(left, m, x.y), sgt_fma(left, n, x.z)};               \
        *at = PLACE(s, *p);                                                                                 \
        return easy_root_of(&s->easy, &r, ROUND, A, Aa, aim, on, *p, *at, ray->tmin, ray->tmax);            \
    }                                                                                                       \
    SGT_KERNEL                                                                                              \
    static mask NAME##_easy_lanes(const SHARED *shared, size_t count, const sgt_rays *rays,                 \
                                  const easy_room *room, const lane_to *rows_to, mask near)                 \
    {                                                                                                       \
        const SHARED own = *shared, *s = &own;                                                              \
        const sgt_rays in = *rays;                                                                          \
        const lane_to to = *rows_to;                                                                        \
        mask all = MASK(true);                                                                              \
        _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < count; i++)                           \
        {                                                                                                   \
            const sgt_ray ray = lane_ray_of(&in, i);                                                        \
            const easy_aim aim = {room->t0[i], room->B[i], room->C[i]};                                     \
            sgt_vec3 p;                                                                                     \
            easy_place at;                                                                                  \
            const mask on = room->on[i];                                                                    \
            const easy_root e = NAME##_easy_end(s, &ray, room->A[i], room->Aa[i], aim, on, &p, &at);        \
            const mask hit = e.hit & (e.leads | ~near);                                                     \
            to.t[i] = e.t, to.t_err[i] = e.t_err, to.t_lo[i] = e.t_lo, to.p_err[i] = e.p_err;               \
            to.px[i] = p.x, to.py[i] = p.y, to.pz[i] = p.z;                                                 \
            to.nx[i] = at.x, to.ny[i] = at.y, to.nz[i] = at.z;                                              \
            to.hit[i] = hit;                                                                                \
            all &= hit;                                                                                     \
        }                                                                                                   \
        return all;                                                                                         \
    }                                                                                                       \
    SGT_KERNEL                                                                                              \
    static void NAME##_easy_missed(const SHARED *shared, size_t count, const sgt_rays *rays, mask *none)    \
    {                                                                                                       \
        const SELF s = shared->self;                                                                        \
        const sgt_rays in = *rays;                                                                          \
        LANES for (size_t i = 0; i < count; i++)                                                            \
        {                                                                                                   \
            const sgt_ray ray = lane_ray_of(&in, i);                                                        \
            parabola q;                                                                                     \
            near_ray r;                                                                                     \
            APPROACH(&s, ray.o, ray.d, &q, &r);                                                             \
            none[i] = easy_misses(&q, &r, ray.tmin, ray.tmax) & easy_whole(&r, ray.d);                      \
        }                                                                                                   \
    }                                                                                                       \
    SGT_INLINE easy_outset NAME##_easy_begins(const SHARED *s, const sgt_ray *ray, double A, double Aa)      \
    {                                                                                                       \
        const near_ray r = near_ray_of(ray->d);                                                             \
        const double to = ray->tmax * r.inverse,                                                            \
                     from = chosen(MASK(ray->tmin <= ray->tmax), ray->tmin * r.inverse, (double)NAN);       \
        const sgt_vec3 p = outset_of(ray->o, r.d, from);                                                    \
        return easy_outset_of(&s->easy, &r, ROUND, A, Aa, p, PLACE(s, p), from, to);                        \
    }                                                                                                       \
    SGT_KERNEL                                                                                              \
    static mask NAME##_easy_starts(const SHARED *shared, size_t count, const sgt_rays *rays,                \
                                   easy_room *room, mask *gone)                                             \
    {                                                                                                       \
        const SHARED own = *shared, *s = &own;                                                              \
        const sgt_rays in = *rays;                                                                          \
        mask any = 0;                                                                                       \
        _Pragma("omp simd reduction(| : any)") for (size_t i = 0; i < count; i++)                           \
        {                                                                                                   \
            const sgt_ray ray = lane_ray_of(&in, i);                                                        \
            const easy_outset is = NAME##_easy_begins(s, &ray, room->A[i], room->Aa[i]);                     \
            room->on[i] = is.first, gone[i] = is.gone;                                                      \
            any |= is.first;                                                                                \
        }                                                                                                   \
        return any;                                                                                         \
    }                                                                                                       \
    SGT_NOINLINE static easy_outset NAME##_easy_begins_one(const SHARED *s, const sgt_ray *ray, double A,   \
                                                           double Aa)                                       \
    {                                                                                                       \
        return NAME##_easy_begins(s, ray, A, Aa);                                                           \
    }                                                                                                       \
    SGT_NOINLINE static easy_root NAME##_easy_met(const SHARED *s, const sgt_ray *ray, const parabola *q,   \
                                                  double t0, mask on, sgt_vec3 *p, easy_place *at)          \
    {                                                                                                       \
        const easy_parabola of = {t0, q->A, q->B, q->C};                                                    \
        const easy_aim aim = easy_aim_of(&of, ray->tmin * inverse_of_scale(ray->d), on);                    \
        return NAME##_easy_end(s, ray, q->A, q->Aa, aim, on, p, at);                                        \
    }                                                                                                       \
    static size_t NAME##_easy(const void *self, const sgt_tile *tile, bool near)                            \
    {                                                                                                       \
        easy_room room;                                                                                     \
        lane_ends ends;                                                                                     \
        mask gone[SGT_TILE], none[SGT_TILE];                                                                \
        const size_t n = tile->n;                                                                           \
        if (OBJECT(self).reason || n > SGT_TILE) {                                                          \
            memset(tile->hits.status, SGT_HARD, n);                                                         \
            return n;                                                                                       \
        }                                                                                                   \
        const SHARED s = MADE(self);                                                                        \
        const sgt_rays *rays = &tile->rays;                                                                 \
        const lane_to to = lane_to_of(tile, &ends);                                                         \
        const sgt_ray first = lane_ray_of(rays, 0);                                                         \
        memset(room.on, 0, sizeof room.on), memset(none, 0, sizeof none), memset(gone, 0, sizeof gone);     \
        NAME##_easy_begin(&s, n, rays, &room);                                                              \
        const easy_outset begins = NAME##_easy_begins_one(&s, &first, room.A[0], room.Aa[0]);               \
        const bool starts = !near && (begins.first | begins.gone) != 0;                                     \
        if (starts && NAME##_easy_starts(&s, n, rays, &room, gone) == 0 && !easy_left(n, gone, none))       \
            return lane_nothing(tile), easy_told(tile, NULL, 0, none, gone);                                \
        easy_aims(n, rays, &room);                                                                          \
        mask all = NAME##_easy_lanes(&s, n, rays, &room, &to, MASK(near));                                  \
        if (all == 0) NAME##_easy_missed(&s, n, rays, none);                                                \
        if (all == 0 && !near && !starts && easy_left(n, ends.hit, none) &&                                 \
            NAME##_easy_starts(&s, n, rays, &room, gone) != 0) {                                            \
            NAME##_easy_begin(&s, n, rays, &room); /* all: those that were met get the same answer */       \
            easy_aims(n, rays, &room);                                                                      \
            all = NAME##_easy_lanes(&s, n, rays, &room, &to, 0);                                            \
        }                                                                                                   \
        return easy_told(tile, &to, all, none, gone);                                                       \
    }                                                                                                       \
    static bool NAME##_easy_one(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit) \
    {                                                                                                       \
        const SHARED s = MADE(self);                                                                        \
        parabola q;                                                                                         \
        near_ray r;                                                                                         \
        sgt_vec3 p;                                                                                         \
        easy_place at;                                                                                      \
        APPROACH(&s.self, ray->o, ray->d, &q, &r);                                                          \
        const bool near = opt->pick == SGT_NEAR_SEED;                                                       \
        easy_root e = NAME##_easy_met(&s, ray, &q, r.t0, 0, &p, &at);                                       \
        mask none = 0;                                                                                      \
        if (near) e.hit &= e.leads;                                                                         \
        if (e.hit == 0) none = easy_misses(&q, &r, ray->tmin, ray->tmax) & easy_whole(&r, ray->d);          \
        if (e.hit == 0 && none == 0 && !near) {                                                             \
            const easy_outset is = NAME##_easy_begins_one(&s, ray, q.A, q.Aa);                              \
            none = is.gone;                                                                                 \
            if (is.first != 0) e = NAME##_easy_met(&s, ray, &q, r.t0, is.first, &p, &at);                   \
        }                                                                                                   \
        return easy_answer_of(&e, none, p, at, ray, opt, hit);                                              \
    }

/* The second loop. */
SGT_KERNEL
static void easy_aims(size_t count, const sgt_rays *rays, easy_room *room)
{
    const double *x = rays->d[0], *y = rays->d[1], *z = rays->d[2], *tmin = rays->tmin;
    LANES for (size_t i = 0; i < count; i++)
    {
        const easy_parabola p = {room->t0[i], room->A[i], room->B[i], room->C[i]};
        const double from = tmin[i] * inverse_of_scale((sgt_vec3){x[i], y[i], z[i]});
        const easy_aim a = easy_aim_of(&p, from, room->on[i]);
        room->t0[i] = a.t1, room->B[i] = a.left, room->C[i] = a.inverse;
    }
}

#endif
