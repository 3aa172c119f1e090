// SPDX-License-Identifier: MIT
/* takeoff.c - rays that start on a sag within its rim: is the start's root the only one, and does the ray
 * meet the surface again?  Two looks tell, mostly, for many rays in step.  A march along the chord (wings.c)
 * is for the rays that are left.
 *
 * Lengths are those of t, for a direction scaled to 1 ... 2.  F'' is in [low, high] all along the chord, by
 * the bounds on the second derivative (wings.c, THE BEND, BY AXIS), and B is the greater of |low| and |high|.
 *
 * THE START.  Let |F| be at most a at t = 0, with all that is rounded, and at least b > 0 at t = h.  The mean
 * slope between is at least (b - a) / h, and at most (b' + a) / h, where b' is the most that |F| may be at h.
 * F' differs from it by B h / 2 at most.  So with g = (b - a) / h - B h / 2 > 0, F is monotone up to h.  It
 * has one root there at most; that is within a / g of the start, and not accepted if this is less than the
 * reach of the rule of the start, START_ULPS of the terms at the start over the greatest |F'| (accept.h,
 * vicinity.h).  A computed slope chooses h, and proves nothing.
 *
 * BEHIND IT.  Let G be F or -F, so that G is positive at h.  There G >= b, G' >= g, and in these directions
 * low <= G''.  So at h + d
 *     G >= b + g d + low d^2 / 2.
 * That is above 0 if low >= 0: the ray bends away from the surface.  Else it is concave in d, and above 0 up
 * to the end of the chord, or of the ray, if it is above 0 there.  Then the ray meets nothing more.
 *
 * THE END.  Else, where a parabola through the start says that the ray does not come back before the end, F
 * is looked at there.  If G is at least c > 0 at h + D, it is above 0 between by the two values alone if
 * high <= 0 (it is concave), or if D sqrt(high / 2) < sqrt b + sqrt c (wings.c, THE MARCH).
 *
 * AGAIN.  The other rays are left to glance.c, which begins at h, with the seed where that parabola has the
 * root.
 *
 * NEAR THE AXIS the terms vanish, and one bound on rounding for the whole rim is too wide.  There the surface
 * is asked for the rounding at the start itself.  If that is not enough, an enclosure of F at the start may
 * hide the root, as in wings.c (HIDDEN).  A search by cells drops a root at t if t is at most t_err and the
 * reach.  It does so if F computed there is at most an eighth of the width that makes t_err, and half of the
 * reach.
 *
 * ROUNDING.  As in glance.c.  h is far greater than the rounding of t: the start is t = 0.
 *
 * Each row is by itself, whatever its neighbours do. */
#include "takeoff.h"
#include "glance.h"
#include "wings.h"

#include "../num/bits.h"
#include "../num/lanes.h"
#include "../solve/step.h"

enum { LOOKS = 4 };

/* The rows of a ray.
 *
 *     OX ... DZ      the ray; its direction is scaled to 1 ... 2 by a power of two, and t with it
 *     TO, H          where the chord or the ray ends; where F is looked at behind the start
 *     LOW, HIGH      F'' is between them
 *     A, B           |F|: at most at the start; at least at H
 *     REACH, PLACE   at the start: the reach of its rule times a slope; what rounding of the point does to F
 *     S0, F0, S1, F1 F' and F as computed, at the start and at H
 *     STATE          STARTS ... NOT_ON
 *     PX ... OWN     the point, F and its gradient there, and its rounding */
enum {
    OX,
    OY,
    OZ,
    DX,
    DY,
    DZ,
    TO,
    H,
    LOW,
    HIGH,
    A,
    B,
    S0,
    F0,
    S1,
    F1,
    REACH,
    PLACE,
    STATE,
    PX,
    PY,
    PZ,
    F,
    FX,
    FY,
    FZ,
    OWN,
    ROWS
};
_Static_assert((int)ROWS <= (int)VICINITY_ROWS, "the rows of vicinity.h");

/* STARTS: starts on the surface, perhaps.  ENDS: looks at the end.  GONE: nothing is met.  AGAIN: has left
 * the start.  NEAR_AXIS: has, if rounding at the very start is small.  NOT_ON: nothing is said. */
enum { STARTS, ENDS, GONE, AGAIN, NEAR_AXIS, NOT_ON };

typedef double *const *rows;

/* From the rays as they are. */
SGT_INLINE void takeoff_begins(bool by_axis, rows w, size_t n, const sgt_shared *whole)
{
    const bends of = bends_of(whole);
    double *restrict dx = w[DX], *restrict dy = w[DY], *restrict dz = w[DZ], *restrict to = w[TO],
           *restrict low = w[LOW], *restrict high = w[HIGH], *restrict px = w[PX], *restrict py = w[PY],
           *restrict pz = w[PZ];
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ];
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), l = d.x * scale, m = d.y * scale;
        sgt_interval bent = bent_along(by_axis, &of, l, m);
        dx[i] = l, dy[i] = m, dz[i] = d.z * scale, to[i] *= inverse;
        low[i] = -bent.hi, high[i] = -bent.lo;
        px[i] = ox[i], py[i] = oy[i], pz[i] = oz[i];
    }
}

#define TAKEOFF_BEGIN(NAME, BY_AXIS)                                                                         \
    SGT_KERNEL                                                                                               \
    static void NAME(rows w, size_t n, const sgt_shared *whole)                                              \
    {                                                                                                        \
        takeoff_begins(BY_AXIS, w, n, whole);                                                                \
    }
TAKEOFF_BEGIN(takeoff_begin, false)
TAKEOFF_BEGIN(takeoff_begin_by_axis, true)

/* A point of a ray, the gradient there, and the terms of the point. */
typedef struct takeoff_at { sgt_vec3 p, grad; double tx, ty, tz; } takeoff_at;

/* What rounding of the point does to F, as around_of has it (step.h). */
SGT_INLINE double takeoff_place(sgt_vec3 o, takeoff_at e)
{
    double ex = fabs(o.x) + fabs(e.tx) + fabs(e.p.x), ey = fabs(o.y) + fabs(e.ty) + fabs(e.p.y),
           ez = fabs(o.z) + fabs(e.tz) + fabs(e.p.z);
    return SGT_U * (ex * fabs(e.grad.x) + ey * fabs(e.grad.y) + ez);
}

/* What F at the start has shown, and where it is looked at behind it. */
SGT_KERNEL
static void takeoff_first(rows w, size_t n, double R)
{
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *dx = w[DX], *dy = w[DY], *dz = w[DZ], *to = w[TO],
                 *low = w[LOW], *high = w[HIGH], *f = w[F], *fx = w[FX], *fy = w[FY], *own = w[OWN];
    double *restrict a = w[A], *restrict reach = w[REACH], *restrict slope = w[S0], *restrict h = w[H],
           *restrict f0 = w[F0], *restrict place = w[PLACE], *restrict state = w[STATE], *restrict px = w[PX],
           *restrict py = w[PY], *restrict pz = w[PZ];
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {ox[i], oy[i], oz[i]}, grad = {fx[i], fy[i], 1};
        double l = dx[i], m = dy[i], terms = fabs(o.x * grad.x) + fabs(o.y * grad.y) + fabs(o.z),
               moved = takeoff_place(o, (takeoff_at){o, grad, 0, 0, 0}), err = own[i] + 1.01 * moved,
               falls = grad.x * l + grad.y * m + dz[i], bend = larger(-low[i], high[i]);
        double by_bend = 0.2 * fabs(falls) / bend, most = 0.5 * to[i],
               step = chosen(MASK(by_bend < most), by_bend, most);
        mask on = MASK(fabs(f[i]) <= 32 * err) & MASK(step > 0) & MASK(step < HUGE_VAL) &
                  MASK(bend < HUGE_VAL) & glance_within(R, o.x, o.y, 0, 0);
        step = chosen(on, step, 0);
        a[i] = fabs(f[i]) + err, reach[i] = START_ULPS * terms, slope[i] = falls, h[i] = step;
        f0[i] = f[i], place[i] = moved, state[i] = chosen(on, (double)STARTS, (double)NOT_ON);
        px[i] = o.x + step * l, py[i] = o.y + step * m, pz[i] = o.z + step * dz[i];
    }
}

/* What is known of a ray after the look behind the start: h, where that was; to, where the chord or the ray
 * ends; lo, hi, the bounds on G''; size and err, |F| there and its error; before, |F| at the start at most;
 * reach, that of the rule times a slope; s0, s1, G' at both as computed. */
typedef struct takeoff { double h, to, lo, hi, size, err, before, reach, s0, s1; } takeoff;

/* Where a parabola through the start is 0 again; infinite: it is not. */
SGT_INLINE double comes_back(takeoff e)
{
    double shown = (e.s1 - e.s0) / e.h;
    shown = -larger(-larger(shown, e.lo), -e.hi);
    return chosen(MASK(shown < 0), -2 * e.s0 / shown, HUGE_VAL);
}

/* The state that follows. */
SGT_INLINE double state_behind(takeoff e)
{
    double b = e.size - e.err, curve = 0.5625 * larger(-e.lo, e.hi) * e.h,
           least = (b - e.before) / e.h - curve, most = (e.size + e.err + e.before) / e.h + curve;
    /* THE START */
    mask left = MASK(b > 0) & MASK(least > 0), known = MASK(e.before * most < e.reach * least);
    /* BEHIND IT */
    double D = e.to - e.h, above = (1 - 0x1p-20) * (b + least * D), below = -0.5 * e.lo * (D * D);
    mask free = MASK(e.lo >= 0) | MASK(above > below);
    double is = chosen(MASK(comes_back(e) < 1.03125 * e.to), (double)AGAIN, (double)ENDS);
    is = chosen(free, (double)GONE, is);
    return chosen(left, chosen(known, is, (double)NEAR_AXIS), (double)NOT_ON);
}

/* What F behind the start has shown. */
SGT_KERNEL
static void takeoff_second(rows w, size_t n, double R)
{
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *dx = w[DX], *dy = w[DY], *dz = w[DZ], *to = w[TO],
                 *low = w[LOW], *high = w[HIGH], *f = w[F], *fx = w[FX], *fy = w[FY], *own = w[OWN],
                 *reach = w[REACH], *h = w[H], *slope = w[S0], *a = w[A], *px = w[PX], *py = w[PY],
                 *pz = w[PZ];
    double *restrict b = w[B], *restrict slope1 = w[S1], *restrict f1 = w[F1], *restrict state = w[STATE];
    LANES for (size_t i = 0; i < n; i++) {
        double l = dx[i], m = dy[i], t = h[i];
        takeoff_at e = {{px[i], py[i], pz[i]}, {fx[i], fy[i], 1}, t * l, t * m, t * dz[i]};
        double err = own[i] + 1.01 * takeoff_place((sgt_vec3){ox[i], oy[i], oz[i]}, e),
               falls = e.grad.x * l + e.grad.y * m + dz[i];
        mask rises = MASK(f[i] > 0);
        takeoff of = {.h = t, .to = to[i], .lo = chosen(rises, low[i], -high[i]),
                     .hi = chosen(rises, high[i], -low[i]), .size = fabs(f[i]), .err = err, .before = a[i],
                     .reach = 0.98 * reach[i], .s0 = chosen(rises, slope[i], -slope[i]),
                     .s1 = chosen(rises, falls, -falls)};
        double is = chosen(glance_within(R, e.p.x, e.p.y, e.tx, e.ty), state_behind(of), (double)NOT_ON);
        state[i] = chosen(MASK(state[i] == STARTS), is, (double)NOT_ON);
        b[i] = of.size - err, slope1[i] = falls, f1[i] = f[i];
    }
}

/* The points at which the rays end. */
SGT_KERNEL
static void takeoff_ends(rows w, size_t n)
{
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *dx = w[DX], *dy = w[DY], *dz = w[DZ], *to = w[TO];
    double *restrict px = w[PX], *restrict py = w[PY], *restrict pz = w[PZ];
    LANES for (size_t i = 0; i < n; i++) {
        double t = to[i];
        px[i] = ox[i] + t * dx[i], py[i] = oy[i] + t * dy[i], pz[i] = oz[i] + t * dz[i];
    }
}

/* What F at the end has shown. */
SGT_KERNEL
static void takeoff_third(rows w, size_t n, double R)
{
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *dx = w[DX], *dy = w[DY], *dz = w[DZ], *to = w[TO],
                 *low = w[LOW], *high = w[HIGH], *f = w[F], *fx = w[FX], *fy = w[FY], *own = w[OWN],
                 *h = w[H], *b = w[B], *f1 = w[F1], *px = w[PX], *py = w[PY], *pz = w[PZ];
    double *restrict state = w[STATE];
    LANES for (size_t i = 0; i < n; i++) {
        double t = to[i], D = t - h[i];
        takeoff_at e = {{px[i], py[i], pz[i]}, {fx[i], fy[i], 1}, t * dx[i], t * dy[i], t * dz[i]};
        double err = own[i] + 1.01 * takeoff_place((sgt_vec3){ox[i], oy[i], oz[i]}, e),
               g = chosen(MASK(f1[i] > 0), f[i], -f[i]), c = g - err,
               hi = chosen(MASK(f1[i] > 0), high[i], -low[i]), bend = 0.5 * larger(hi, 0) * (D * D);
        mask between = MASK(c > 0) & MASK((1 + 0x1p-19) * bend < b[i] + c + 2 * sqrt(larger(b[i] * c, 0))) &
                       glance_within(R, e.p.x, e.p.y, e.tx, e.ty);
        state[i] = chosen(between, (double)GONE, (double)AGAIN);
    }
}

static sgt_ray takeoff_ray(const sgt_rays *r, const vicinity *v, size_t i)
{
    return (sgt_ray){
        {r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]}, v->tmin[i], v->tmax[i]};
}

/* What is known of row k, but for err and before, which are 0; reach is the whole one. */
static takeoff takeoff_of(rows w, size_t k)
{
    bool rises = w[F1][k] > 0;
    return (takeoff){.h = w[H][k], .to = w[TO][k], .lo = rises ? w[LOW][k] : -w[HIGH][k],
                    .hi = rises ? w[HIGH][k] : -w[LOW][k], .size = fabs(w[F1][k]), .reach = w[REACH][k],
                    .s0 = rises ? w[S0][k] : -w[S0][k], .s1 = rises ? w[S1][k] : -w[S1][k]};
}

/* NEAR THE AXIS.  Sets the state, and B. */
SGT_NOINLINE
static void near_axis(sgt_surface s, rows w, size_t k, const sgt_ray *ray, const vicinity *v, size_t i)
{
    const takeoff_at at = {{w[PX][k], w[PY][k], w[PZ][k]}, {w[FX][k], w[FY][k], 1}, w[H][k] * w[DX][k],
                           w[H][k] * w[DY][k], w[H][k] * w[DZ][k]};
    takeoff e = takeoff_of(w, k);
    const double reach = e.reach;
    e.before = fabs(w[F0][k]) + 1.01 * (w[PLACE][k] + s.ops->rounding(s.self, ray->o));
    e.err = w[OWN][k] + 1.01 * takeoff_place(ray->o, at); /* is far less than |F| there, mostly */
    e.reach = 0.98 * reach;
    double is = state_behind(e);
    if (is == NEAR_AXIS) {
        sgt_interval slope, none = {0, 0}, g = s.ops->own_->enclose(s.self, ray, ray->tmin, none, &slope);
        v->evals[i] += 1;
        if (v->told) tell_cell(v->told, SGT_MARCH, ray->tmin, ray->tmin, g, slope);
        e.reach = 8 * reach;
        bool hidden = g.lo < 0 && g.hi > 0 && g.hi - g.lo < HUGE_VAL &&
                      fabs(w[F0][k]) <= 0.125 * smaller(-g.lo, g.hi) + 0.5 * reach;
        if (hidden) is = state_behind(e);
    }
    w[STATE][k] = is == NEAR_AXIS ? NOT_ON : is;
    w[B][k] = e.size - e.err;
}

/* The rows that leave the surface, as far as is known of them before F is asked. */
static size_t takeoff_rows(size_t n, const sgt_rays *r, const vicinity *v, unsigned char of[])
{
    rows w = v->work;
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        double to = smaller(v->hi[i], v->tmax[i]);
        sgt_vec3 o = {r->o[0][i], r->o[1][i], r->o[2][i]};
        if (v->asked[i] == 0 || !starts_low(o, v->tmin[i])) continue;
        if (!(v->lo[i] <= 0 && to > 0 && to < HUGE_VAL)) continue; /* nor NaN */
        if (v->evals[i] + LOOKS >= 0.5 * v->budget) continue;
        of[left] = (unsigned char)i, w[TO][left++] = to;
    }
    const double *const ray[6] = {r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2]};
    for (int c = 0; c < 6; c++)
        for (size_t k = 0; k < left; k++) w[OX + c][k] = ray[c][of[k]];
    return left;
}

/* F, its gradient and its rounding at the points of all rows.  false: not known, or stopped. */
static bool takeoff_look(sgt_surface s, size_t n, const sgt_shared *whole, const unsigned char *of, double t,
                         const sgt_rays *r, const vicinity *v)
{
    rows w = v->work;
    for (size_t k = 0; k < n; k++) v->evals[of[k]] += 1;
    if (!s.ops->own_->values_rounded(s.self, whole, NULL, n, (sgt_points){{w[PX], w[PY], w[PZ]}},
                                     (sgt_values){w[F], {w[FX], w[FY], w[FZ]}}, w[OWN]))
        return false;
    if (!v->told) return true;
    double scale = scale_of((sgt_vec3){r->d[0][0], r->d[1][0], r->d[2][0]}),
           slope = w[FX][0] * r->d[0][0] + w[FY][0] * r->d[1][0] + r->d[2][0];
    tell(v->told, SGT_MARCH, t * scale, w[F][0], slope, 0, t * scale);
    return !v->told->stopped;
}

/* Reports row k.  Returns whether the ray has left the start, and may come back. */
static bool takeoff_tell(rows w, size_t k, const sgt_ray *ray, const vicinity *v, size_t i)
{
    if (w[STATE][k] == GONE) v->asked[i] = 0, v->lo[i] = 1, v->hi[i] = 0;
    if (w[STATE][k] != AGAIN) return false;
    const double scale = scale_of(ray->d), back = comes_back(takeoff_of(w, k));
    v->lo[i] = w[H][k] * scale, v->seed[i] = (back > w[H][k] && back < w[TO][k] ? back : w[TO][k]) * scale;
    return true;
}

/* Drops the rows that do not start on the surface.  Returns how many do. */
static size_t takeoff_starts(rows w, size_t n, unsigned char of[])
{
    size_t left = 0;
    for (size_t k = 0; k < n; k++) {
        if (w[STATE][k] == NOT_ON) continue;
        for (int j = 0; left < k && j <= PZ; j++) w[j][left] = w[j][k];
        of[left++] = of[k];
    }
    return left;
}

unsigned long long sgt_take_off(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole,
                                const vicinity *v)
{
    rows w = v->work;
    const double R = sqrt(whole->radius2) * (1 + 0x1p-21);
    unsigned char of[VICINITY_MOST];
    unsigned long long again = 0;
    if (!s.ops->own_->values_rounded) return 0;
    size_t left = takeoff_rows(n, &r, v, of), ends = 0;
    if (left == 0) return 0;
    (bends_by_axis(whole) ? takeoff_begin_by_axis : takeoff_begin)(w, left, whole);
    if (!takeoff_look(s, left, whole, of, 0, &r, v)) return 0;
    takeoff_first(w, left, R);
    left = takeoff_starts(w, left, of);
    if (left == 0) return 0;
    if (!takeoff_look(s, left, whole, of, w[H][0], &r, v)) return 0;
    takeoff_second(w, left, R);
    for (size_t k = 0; k < left; k++) {
        const size_t i = of[k];
        const sgt_ray ray = takeoff_ray(&r, v, i);
        if (w[STATE][k] == NEAR_AXIS) near_axis(s, w, k, &ray, v, i);
        if (v->told && v->told->stopped) return 0;
        if (w[STATE][k] == ENDS) {
            for (int j = 0; ends < k && j < PX; j++) w[j][ends] = w[j][k];
            of[ends++] = (unsigned char)i;
        } else if (takeoff_tell(w, k, &ray, v, i))
            again |= 1ULL << i;
    }
    if (ends == 0) return again;
    takeoff_ends(w, ends);
    if (!takeoff_look(s, ends, whole, of, w[TO][0], &r, v)) return again;
    takeoff_third(w, ends, R);
    for (size_t k = 0; k < ends; k++) {
        const sgt_ray ray = takeoff_ray(&r, v, of[k]);
        if (takeoff_tell(w, k, &ray, v, of[k])) again |= 1ULL << of[k];
    }
    return again;
}
