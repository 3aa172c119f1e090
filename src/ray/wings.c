// SPDX-License-Identifier: MIT
/* wings.c - the wings of a sag, however steep: finds the first root on the way in from afar, or proves
 * that there is none on the way out (vicinity.h).  The same along a chord within the rim, however near to the
 * surface the ray runs, and through a box about it.
 *
 * THE MARCH looks at F again and again, from where the search begins.  Take two points of the ray, h apart
 * in t, where F is certainly at least a and at least b on the same side of zero.  F is z less the sag, so F''
 * is minus the second derivative of the sag along (d_x, d_y).  Let F'' on that side of zero be at most B all
 * the way between.  Then |F| is above the parabola through (0, a) and (h, b) of second derivative B,
 *
 *     a (1 - w) + b w - B h^2 w (1 - w) / 2,   0 <= w <= 1.
 *
 * That is > 0 everywhere if h sqrt(B / 2) < sqrt a + sqrt b (where the two are equal, its least value is
 * zero).  So no root is between the points, and the march moves to the second.  B has a sign: where the
 * surface bends toward the ray (B <= 0), |F| is above its chord, and any step will do.
 *
 * BENT AWAY.  If F'' on that side is certainly not negative, |F| is convex.  Then a point ahead where F has
 * the other sign says as much: let |F| be a' > 0 at t, and F have the other sign at a later point.  Before
 * t a convex function is above the line through these two, which falls.  So it was above a' all the way.
 *
 * THE ROOT.  Let F have unlike signs at two points h apart, with |F| at least a and b, and let |F''| <= B.
 * The mean slope is at least (a + b) / h.  It is the mean of F' over the stretch, from which F' at one point
 * differs by at most the mean of B times the distance: B h / 2 at the ends, and less between.  If (a + b) / h
 * is above 2 B h, F is monotone between the two, and Newton's steps will do.  Else the march looks again, on
 * the side of the root that is farther from it.
 *
 * When the ray is made local, the stretch is made longer by 2^-50 of t at either end (step.h).  That is
 * less than a sixteenth of h, which is why the lower bound on |F'| is (a + b) / h - 0.5625 B h.  B holds on
 * the longer stretch, too: it is a bound for r <= radius (1 + 2^-19) (departure.c), and a root is taken as
 * found only if the longer stretch reaches less than 2^-20 radius farther out (wings_judge).
 *
 * STEPS.  A step of 0.98 sqrt(2 a / B) is never refused while the sign stays.  Far out, F is a power of r,
 * and the next b is to a as the last was; so the step may be longer.  If the bend allows, or |F| is convex,
 * the first step goes beyond the seed, by so little that F is monotone there, and the next stops as little
 * before it: the start and these two are all that is looked at, if the seed is good.
 *
 * THE BEND within a radius that holds both points, which is an eighth of a power of two: as r^2 is convex,
 * it holds all points between.  On the way in it becomes smaller with r.
 *
 * BY AXIS.  Where the entries of the second derivative are known (departure.c), that along the ray lies also
 * in s_xx d_x^2 + s_yy d_y^2 +- 2 |s_xy d_x d_y|.  For a mirror that is bent across the rays and nearly flat
 * along them this is a small part of the norm.  Of a sag that is convex it is not negative, however much the
 * entries may mix.
 *
 * WITHIN A RIM what is known holds for the whole chord, and so do the noise and the slope.  The march begins
 * where the chord does, or the ray, and ends behind the chord or the ray.  There it is a miss: a root is
 * accepted within the rim only.
 *
 * IN A BOX |x| <= X, |y| <= Y the same is known of a surface that is steeper along one axis.  The march ends
 * behind the seed, or behind the vertex plane, by a quarter of the way to it.  There is none if F is monotone
 * all along that stretch: then a root in it is the first.
 *
 * LEAVING.  A ray that starts on the surface begins with a root that does not count.  F is looked at a step
 * h farther on, too.  If |F| is at most a at the start and at least b there, the mean slope is at least (b
 * - a) / h.  If that is above B h / 2, F is monotone: the start's root is the only one, and within a / |F'|
 * of the start.  It is not accepted if that is less than the reach of the rule of the start (accept.h),
 * whose terms are known there.  Then the march goes on from h.  A wide bound on what is rounded makes a
 * great: then nothing is dropped by this.  If |F| is convex, it rises from h on: nothing is met as far as
 * what is known reaches.  That is a miss if the chord or the ray ends there, or the ray is then below or
 * above all of the surface.
 *
 * HIDDEN.  Near the axis a sum of many terms rounds by more than the reach of the rule.  Then a search by
 * cells finds the start's root to t_err, the width of F's enclosure there over the slope, and drops it if it
 * is nearer than that (accept.h).  So one enclosure, at the very start, is asked for.  If it holds 0, and |F|
 * is at most an eighth of its width on either side, the search's t is at most an eighth of its t_err: a point
 * as near as that has an enclosure that is about as wide.  (More than an eighth as wide is all that is
 * needed.)  The root is the only one up to h, as above.  It is not dropped if it may be farther from the
 * start than eight reaches, by `rounding` at the very point: such a one is left to the search, which may call
 * it undecided.
 *
 * Without a rim the same is done in the circle that is known about the start: r^2 is convex along the ray, so
 * what is known there holds between two points that are both in it.  Then the ray is a miss if it is above or
 * below all rings that are ahead of it (vicinity.h, A MISS).  At the start itself it never is, as the ring it
 * starts in holds the start.
 *
 * BETWEEN RINGS.  Where the heights say that a stretch ahead is above or below all that it passes, the march
 * begins anew at its end.
 *
 * THE TAIL of the sag (tail.h): a ray from afar begins where nothing is certainly met before, and a ray that
 * goes out is a miss from where nothing is met beyond.
 *
 * THE ROUNDING of F is that of the surface at the computed point, plus the gradient within the radius
 * times the error of that point.
 *
 * THE EDGE.  Where the base ends, its slope has no bound.
 *
 *     a ray that begins outside  is first asked by the enclosure, as far as a part in 256 inside the edge
 *     the edge, or next to it
 *     a ray that leaves          is asked by the enclosure from as near to the edge on; without a root it
 *                                is a miss
 *     a ray that ends before     is a miss
 *     a surface without an edge  a ray that leaves is followed to four times the radius where it began, or
 *                                that of the seed, or to the last ring, whichever is the greatest
 *
 * ALONG.  A departure that is a polynomial along the ray is looked at as a whole first (along.c): from where
 * the march would begin, and from where it has left a start.  What that leaves open is marched along from
 * where it has come to.  A sag of r alone is answered by a table of its profile (profile.c).
 *
 * Each lane is by itself.  A lane that is done is replaced by the last.  A march that has taken half of
 * max_evals leaves the rest to the search through enclosures, which begins anew. */
#include "wings.h"

#include "along.h"
#include "tail.h"

#include "../num/bits.h"
#include "../surface/departure/departure.h"
#include "../solve/step.h"

#include <sagitta/interval.h>

enum { MOST_STEPS = 256, EDGE_RUNGS = 9, LEAVING = 32 };

/* The rows of a lane.
 *
 *     OX ... DZ          the ray; its direction is scaled to 1 ... 2 by a power of two, and t with it
 *     T, A, SIGN         where the march is; a lower bound on |F| there; its sign (0: not yet known)
 *     H                  the next step; 0: it is to be chosen
 *     PAST, B            the nearest point ahead that has the other sign; a lower bound on |F| there
 *     RATIO              sqrt(b / a) of the last step, at most 1
 *     RADIUS ... E1      the radius, and what is known within it; F'' is between BENT_LO and BENT_HI
 *     SEED               where a root is thought to be
 *     END                the t where a march along a chord ends; in rings the r to which a ray is followed
 *     LANE               its row in the caller's arrays
 *     PX ... OWN         the next point, F there and its rounding
 *     VERDICT, WANTED    what the step has shown; the radius wanted next */
enum {
    OX,
    OY,
    OZ,
    DX,
    DY,
    DZ,
    T,
    H,
    A,
    SIGN,
    PAST,
    B,
    RATIO,
    RADIUS,
    STEEP,
    BENT_LO,
    BENT_HI,
    E0,
    E1,
    SEED,
    END,
    LANE,
    PX,
    PY,
    PZ,
    F,
    OWN,
    VERDICT,
    WANTED,
    ROWS
};
_Static_assert((int)ROWS == (int)WINGS_ROWS, "the rows of vicinity.h");

enum { GOES_ON, MOVED, FOUND, GIVEN_UP, HIDDEN, OFF, LEFT };

typedef double *const *rows;

SGT_INLINE double radius_of(double x, double y) { return sqrt(x * x + y * y); }

/* The radius wanted about a point at r.  High powers of r make much of a radius that is too wide.  So if
 * steps are short, it is a finer rung.  On the way out there is room for a few steps like the last, but no
 * more.  outward: d(r^2 / 2) in that step. */
SGT_INLINE double radius_wanted(double r, double outward)
{
    double step = outward / (r * r), room = chosen(MASK(step < 0x1p-4), 3 * step, 0.25);
    room = chosen(MASK(step > 0), larger(room, 0x1p-7), 0x1p-20);
    double wide = rung_above(r * (1 + room), FINE), narrow = rung_above(r * (1 + room), FINER);
    return chosen(MASK(fabs(step) < 0x1p-6), narrow, wide);
}

/* ------------------------------------------------------------------------- a step */

/* F'' of |F|: the greatest value, at least 0, and the least. */
typedef struct bow { double most, least; } bow;

SGT_INLINE bow bow_of(double sign, double lo, double hi)
{
    mask above = MASK(sign > 0);
    return (bow){larger(chosen(above, hi, -lo), 0), chosen(above, lo, -hi)};
}

/* Steps beside a root are so near to it that F is monotone from there to as far on the other side. */
SGT_INLINE double room_of(double slope, bow F2) { return fabs(slope) / (5 * larger(F2.most, -F2.least)); }

/* The length of the next step, if no point ahead has the other sign: as far as the bend allows, or to
 * somewhat beyond the seed, which is `ahead` of here. */
SGT_INLINE double step_ahead(double a, double ahead, double most, double by_bend, bow F2)
{
    double room = room_of(a / ahead - 0.25 * (F2.most + F2.least) * ahead, F2);
    room = chosen(MASK(room < 0.25 * ahead), larger(room, 0x1p-8 * ahead), 0.25 * ahead);
    double beyond = ahead + room, length = chosen(MASK(by_bend < most), by_bend, most);
    mask leaps = MASK(ahead > 0) & (MASK(beyond < length) | (MASK(F2.least >= 0) & MASK(beyond < most)));
    return chosen(leaps, beyond, length);
}

/* The same if one has, `width` away: to beside the root, on the side that is farther from it.  The root is
 * where the seed is, if that is between, or where a parabola of the mean F'' has it: by one of Newton's steps
 * from the secant. */
SGT_INLINE double step_between(double a, double b, double width, double ahead, double by_bend, bow F2)
{
    double middle = 0.5 * (F2.most + F2.least), mean = (a + b) / width, at = a / mean;
    double drop = 0.5 * middle * at * (width - at),
           better = at - drop / (mean + 0.5 * middle * (width - 2 * at));
    at = chosen(MASK(better > 0) & MASK(better < width), better, at);
    at = chosen(MASK(ahead > 0) & MASK(ahead < width), ahead, at);
    double room = room_of(mean + 0.5 * middle * (width - 2 * at), F2), behind = width - at;
    mask left = MASK(at >= behind);
    double side = 0.5 * chosen(left, at, behind), off = chosen(MASK(room < side), room, side),
           beside = chosen(left, at - off, at + off);
    return chosen(MASK(F2.least < 0) & MASK(by_bend < beside), by_bend, beside);
}

/* The next point.  The length of the step is h if a step has been refused, else it is chosen here.  ahead: no
 * row knows of a point ahead with the other sign. */
SGT_INLINE void wings_steps(bool ahead, rows a, size_t n, bool in_rings)
{
    const double *ox = a[OX], *oy = a[OY], *oz = a[OZ], *dx = a[DX], *dy = a[DY], *dz = a[DZ], *at = a[T],
                 *room = a[A], *sign = a[SIGN], *past = a[PAST], *beyond = a[B], *ratio = a[RATIO],
                 *radius = a[RADIUS], *bent_lo = a[BENT_LO], *bent_hi = a[BENT_HI], *seed = a[SEED],
                 *end = a[END];
    double *restrict h = a[H], *restrict px = a[PX], *restrict py = a[PY], *restrict pz = a[PZ];
    const mask rung = MASK(in_rings);
    LANES for (size_t i = 0; i < n; i++) {
        double l = dx[i], m = dy[i], t = at[i], x = ox[i] + t * l, y = oy[i] + t * m,
               over = 1 / (l * l + m * m);
        double nearest = -(x * l + y * m) * over, cross = (x * m - y * l), R = radius[i];
        double leaves = nearest + sqrt(larger(R * R - cross * cross * over, 0) * over);
        double most = chosen(rung, 0.98 * leaves, end[i] - t), to_seed = seed[i] - t, width = past[i] - t;
        bow F2 = bow_of(sign[i], bent_lo[i], bent_hi[i]);
        double by_bend = 0.98 * sqrt(2 * room[i] / F2.most) * (1 + 0.8 * ratio[i]),
               length = step_ahead(room[i], to_seed, most, by_bend, F2);
        if (!ahead) {
            double between = step_between(room[i], beyond[i], width, to_seed, by_bend, F2);
            length = chosen(MASK(width < HUGE_VAL), between, length);
        }
        length = chosen(MASK(h[i] > 0), h[i], length);
        t = chosen(MASK(sign[i] != 0), t + length, t);
        h[i] = length;
        px[i] = ox[i] + t * l, py[i] = oy[i] + t * m, pz[i] = oz[i] + t * dz[i];
    }
}

SGT_KERNEL
static void wings_step(rows a, size_t n, bool in_rings) { wings_steps(false, a, n, in_rings); }

SGT_KERNEL
static void wings_step_ahead(rows a, size_t n, bool in_rings) { wings_steps(true, a, n, in_rings); }

/* Not below the distance of a point from the axis; tx, ty: its terms. */
SGT_INLINE double radius_by(double x, double y, double tx, double ty)
{
    return radius_of(x, y) + 0x1p-51 * (tx + ty + fabs(x) + fabs(y));
}

/* Is F monotone over this length, at the ends of which it is at least a and b away from zero? */
SGT_INLINE mask is_monotone(double a, double b, double length, bow F2)
{
    return MASK(2 * (1 + 0x1p-20) * larger(F2.most, -F2.least) * length * length < a + b);
}

/* What F at the next point has shown.  Returns how many rows know of a point ahead with the other sign. */
SGT_KERNEL
static double wings_judge(rows w, size_t n, bool in_rings)
{
    const double *dx = w[DX], *dy = w[DY], *dz = w[DZ], *radius = w[RADIUS], *steep = w[STEEP],
                 *bent_lo = w[BENT_LO], *bent_hi = w[BENT_HI], *e0 = w[E0], *e1 = w[E1], *end = w[END],
                 *px = w[PX], *py = w[PY], *pz = w[PZ], *f = w[F], *own = w[OWN];
    double *restrict at = w[T], *restrict h = w[H], *restrict a = w[A], *restrict sign = w[SIGN],
           *restrict past = w[PAST], *restrict beyond = w[B], *restrict ratio = w[RATIO],
           *restrict seed = w[SEED], *restrict verdict = w[VERDICT], *restrict wanted = w[WANTED];
    const mask rung = MASK(in_rings);
    double known = 0;
#pragma omp simd reduction(+ : known)
    for (size_t i = 0; i < n; i++) {
        double was = at[i], s = sign[i], before = a[i], x = px[i], y = py[i], z = pz[i], r2 = x * x + y * y,
               R = radius[i], ahead = past[i], behind = beyond[i], limit = chosen(rung, end[i], HUGE_VAL);
        mask first = MASK(s == 0);
        double t = chosen(first, was, was + h[i]), length = t - was;
        bow F2 = bow_of(s, bent_lo[i], bent_hi[i]);
        double tx = fabs(t * dx[i]), ty = fabs(t * dy[i]), tz = fabs(t * dz[i]),
               off = steep[i] * (tx + fabs(x) + ty + fabs(y)) + tz + fabs(z);
        double err = own[i] + 1.01 * (sgt_fma(e1[i], r2, e0[i]) + SGT_U * off + 0x1p-1000 * (1 + steep[i]));
        double b = fabs(f[i]) - err, is = copysign(1, f[i]), r = radius_by(x, y, tx, ty);
        mask in = MASK(r <= R), certain = MASK(b > 0), like = certain & MASK(is == s),
             unlike = certain & MASK(is == -s) & in;
        double rest = ahead - t, px2 = x + rest * dx[i], py2 = y + rest * dy[i],
               hidden = 0x1p-50 * (fabs(ahead) * (fabs(dx[i]) + fabs(dy[i])) + fabs(px2) + fabs(py2)),
               inner = larger(R - hidden, 0);
        mask between = in & MASK(rest > 0) & MASK(ahead < HUGE_VAL) &
                       MASK(px2 * px2 + py2 * py2 < inner * inner);
        /* h sqrt(F2 / 2) < sqrt a + sqrt b, divided by sqrt a: so no root is taken of what has an odd power
         * of a length, and would be rounded otherwise in another unit.  2^-1000 is for underflow. */
        double over = 1 / before, part = sqrt(larger(b, 0) * over),
               curved = length * sqrt(0.5 * F2.most * over + 0x1p-1000) * (1 + 0x1p-20);
        mask clear = MASK(curved < 1 + part) | (between & MASK(F2.least >= 0));
        mask moves = (first & certain & in) | (like & in & clear & MASK(t > was));
        mask found = unlike & in & is_monotone(before, b, length, F2),
             closed = moves & like & between & is_monotone(b, behind, rest, F2);
        double far = larger(fabs(t), larger(fabs(was), chosen(closed, fabs(ahead), 0)));
        double width = chosen(closed, rest, length);
        found = (found | closed) & MASK(width >= 0x1p-44 * far) &
                MASK(0x1p-48 * (far * (fabs(dx[i]) + fabs(dy[i]))) <= 0x1p-20 * R);
        double safe = 0.98 * sqrt(2 * before / F2.most),
               longer = 1.7 * length; /* over a root that rounding hides, if one step can */
        mask over_it = in & MASK(4 * F2.most * longer * longer < before) & MASK(was + longer < ahead);
        double shorter = chosen(certain, 0.5 * length, chosen(over_it, longer, 0.3 * length));
        shorter = chosen(like & in & MASK(safe < length), safe, shorter);
        double outward = x * dx[i] + y * dy[i];
        mask ends = (first & ~moves) | ~(first | MASK(length > 0)) | MASK(!(b == b)); /* NaN: no F there */
        ends |= moves & MASK(outward > 0) & MASK(r > limit);
        double v = chosen(moves, (double)MOVED, (double)GOES_ON);
        v = chosen(ends, (double)GIVEN_UP, v);
        v = chosen(first & MASK(fabs(f[i]) <= 32 * err), (double)HIDDEN, v);
        verdict[i] = chosen(found, (double)FOUND, v);
        h[i] = chosen(moves | unlike, 0, shorter);
        h[i] = chosen(found, width, h[i]);
        ratio[i] = chosen(moves & ~first, part, ratio[i]);
        ratio[i] = chosen(MASK(ratio[i] < 1), ratio[i], 1);
        /* a leap past the seed has met no other sign: farther on */
        double farther = was + length * (before / (before - b));
        mask short_of = like & ~moves & MASK(seed[i] < t) & MASK(F2.least >= 0);
        seed[i] = chosen(short_of, chosen(MASK(b < before), farther, -HUGE_VAL), seed[i]);
        at[i] = chosen(moves, t, was);
        past[i] = chosen(unlike, t, ahead);
        known += chosen(unlike | MASK(ahead < HUGE_VAL), 1, 0);
        beyond[i] = chosen(unlike, b, behind);
        a[i] = chosen(moves, b, before);
        sign[i] = chosen(first & moves, is, s);
        wanted[i] = radius_wanted(r, outward * larger(length, 0x1p-1000));
    }
    return known;
}

/* --------------------------------------------------------------------------- the lanes */

/* What is known within a radius: bounds on the gradient and on the second derivative of the sag, infinite or
 * NaN if unknown; and noise[0] + noise[1] r^2, which the departure adds to the rounding. */
static const ring *ring_about(sgt_surface s, double rung, rings *kept)
{
    const departure *of = s.ops->own_->departure;
    const int places = of && of->profile ? RINGS_FEW : RINGS; /* the others are its table's */
    if (!kept->any)
        for (int i = 0; i < places; i++) kept->of[i].radius = 0;
    kept->any = true;
    /* The rungs of two octaves have a place each; of few places, those of seven eighths of one. */
    ring *e = &kept->of[place_of(rung, FINER, places)];
    if (e->radius == rung) return e;
    *e = (ring){rung, HUGE_VAL, SGT_ANY_NUMBER, {(double)NAN, (double)NAN}};
    double rim = s.ops->own_->rim(s.self);
    if (!(rung < HUGE_VAL) || (rim > 0 && !(rung <= rim))) return e;
    sgt_extent extent;
    s.ops->own_->extent_within(s.self, rung, true, &extent);
    e->steep = extent.steep, e->bent = extent.bent;
    if (e->steep < HUGE_VAL) s.ops->own_->noise_within(s.self, rung * (1 + 0x1p-20), e->noise);
    return e;
}

/* What F'' along row k lies in, from what is known of the second derivative.  by_axis: NULL if that is not
 * known by axis. */
static void bend_along(rows a, size_t k, sgt_interval bent, const sgt_by_axis *by_axis)
{
    double l = fabs(a[DX][k]), m = fabs(a[DY][k]), l2 = l * l, m2 = m * m, lo = -HUGE_VAL, hi = HUGE_VAL,
           off = 0x1p-40;
    if (bent.lo > -HUGE_VAL && bent.hi < HUGE_VAL) {
        double all = l2 + m2, rounded = off * sgt_interval_greatest(bent) * all;
        lo = bent.lo * all - rounded, hi = bent.hi * all + rounded;
    }
    if (by_axis && by_axis->xx.hi < HUGE_VAL && by_axis->yy.hi < HUGE_VAL && by_axis->xy < HUGE_VAL) {
        sgt_interval xx = by_axis->xx, yy = by_axis->yy;
        double mixed = 2 * by_axis->xy * (l * m), low = xx.lo * l2 + yy.lo * m2 - mixed,
               high = xx.hi * l2 + yy.hi * m2 + mixed;
        double rounded = off * (sgt_interval_greatest(xx) * l2 + sgt_interval_greatest(yy) * m2 + mixed);
        lo = larger(lo, low - rounded), hi = -larger(-hi, -(high + rounded));
        lo = by_axis->turn > 0 ? larger(lo, 0) : lo, hi = by_axis->turn < 0 ? -larger(-hi, 0) : hi;
    }
    a[BENT_LO][k] = -hi, a[BENT_HI][k] = -lo;
}

static sgt_outlook outlook_of(rows a, size_t k)
{
    return sgt_outlook_of((sgt_vec3){a[OX][k], a[OY][k], a[OZ][k]}, (sgt_vec3){a[DX][k], a[DY][k], a[DZ][k]});
}

/* Sets what is known of the part of row k within R.  |x| and |y| are greatest where it leaves the circle, as
 * r is.  false: the part is not narrower than the circle, or no more is known of it. */
static bool enclose_part(sgt_surface s, double R, rows a, size_t k)
{
    sgt_outlook e = outlook_of(a, k);
    double l = a[DX][k], m = a[DY][k], ox = a[OX][k], oy = a[OY][k], lost = 0x1p-46 * (fabs(ox) + fabs(oy)),
           w = R < HUGE_VAL && e.a > 0x1p-80 ? sgt_way_to(&e, R * R, e.near2) : HUGE_VAL;
    sgt_part part = {.radius = R, .l = l, .m = m};
    part.x = (fabs(ox + e.t * l) + w * fabs(l) + lost) * (1 + 0x1p-20);
    part.y = (fabs(oy + e.t * m) + w * fabs(m) + lost) * (1 + 0x1p-20);
    if (!(part.x < R || part.y < R) || !s.ops->own_->extent_in_part(s.self, &part)) return false;
    a[STEEP][k] = part.steep, a[BENT_LO][k] = -part.bent.hi, a[BENT_HI][k] = -part.bent.lo;
    a[E0][k] = part.noise[0], a[E1][k] = part.noise[1];
    return true;
}

/* Sets the lane's radius to the one wanted, and what is known within it.  edge: of the domain, where the
 * slope of the base has no bound. */
static void enclose_in(sgt_surface s, double edge, bool boxed, rings *kept, rows a, size_t i)
{
    double rung = a[WANTED][i];
    for (int k = 1; k <= EDGE_RUNGS && rung > edge * (1 - 0x1p-10); k++) {
        double t = a[T][i], level = edge * (1 - power_of_two(-k));
        if (radius_at(a[OX][i], a[OY][i], a[DX][i], a[DY][i], t) * (1 + 0x1p-20) < level) rung = level;
    }
    if (rung == a[RADIUS][i]) return;
    a[RADIUS][i] = rung;
    if (boxed && enclose_part(s, rung, a, i)) return;
    const ring *e = ring_about(s, rung, kept);
    a[STEEP][i] = e->steep, a[E0][i] = e->noise[0], a[E1][i] = e->noise[1];
    bend_along(a, i, e->bent, NULL);
}

/* Reports the stretch that holds the root, and the seed of Newton's steps. */
static void tell_root(rows a, size_t i, double scale, const vicinity *v)
{
    size_t k = (size_t)a[LANE][i];
    double lo = a[T][i], h = a[H][i], before = a[A][i], b = a[B][i],
           bend = larger(-a[BENT_LO][i], a[BENT_HI][i]);
    v->lo[k] = lo * scale, v->hi[k] = (lo + h) * scale, v->asked[k] = 0;
    v->least[k] = ((before + b) / h - 0.5625 * bend * h) * (1 - 0x1p-20);
    if (!(v->seed[k] > v->lo[k] && v->seed[k] < v->hi[k]))
        v->seed[k] = (lo + h * (before / (before + b))) * scale;
}

/* The t at which the ray is inside the edge by a part in 256, if there is certainly no root before it.
 * (At its edge a base has a slope without bound.)  NaN: that is not known.  *evals grows by what it took. */
static double inside_edge(sgt_surface s, const sgt_ray *ray, double from, double edge, vicinities *kept,
                          const vicinity *v, double *evals)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    double x = ray->o.x + from * ray->d.x, y = ray->o.y + from * ray->d.y;
    if (!(edge < HUGE_VAL) || radius_of(x, y) < edge * (1 - 0x1p-8)) return from;
    sgt_rays one = rays_of(ray);
    double outer2 = edge * edge * (1 + 0x1p-40), inner2 = outer2 * (1 - 0x1p-7), steep = 0, lo, hi, begin,
           least;
    builtin->chords(1, one, &inner2, &steep, NULL, &lo, &hi, &least);
    builtin->chords(1, one, &outer2, &steep, NULL, &begin, &hi, &least);
    begin = larger(begin, from);
    if (!(lo <= hi && begin < lo && fabs(lo) < HUGE_VAL)) return (double)NAN;
    /* Most rays from afar are below or above all that there is next to the edge. */
    const sgt_heights *h = heights_about(s, kept);
    double near = ray->o.z + begin * ray->d.z, far = ray->o.z + lo * ray->d.z, last = SGT_RINGS - 1,
           off = 0x1p-40 * (fabs(ray->o.z) + fabs(begin * ray->d.z) + fabs(lo * ray->d.z));
    bool outer = h->width > 0 && h->width * last < edge * (1 - 0x1p-6);
    if (outer && (larger(near, far) + off < h->low[SGT_RINGS - 1] ||
                  -larger(-near, -far) - off > h->high[SGT_RINGS - 1]))
        return lo;
    sgt_interval slope, t = {0, sgt_sum_above(lo, -begin)},
                        g = builtin->enclose(s.self, ray, begin, t, &slope);
    *evals += 1;
    if (v->told)
        tell_cell(v->told, SGT_MARCH, begin, lo, g, slope);
    return g.lo > 0 || g.hi < 0 ? lo : (double)NAN; /* also an empty one */
}

static bool leaves_by_tail(sgt_surface s, rows a, size_t i, sgt_tails *kept)
{
    if (!(a[PX][i] * a[DX][i] + a[PY][i] * a[DY][i] > 0)) return false;
    sgt_outlook e = outlook_of(a, i);
    return sgt_leaves_by_tail(s, &e, a[T][i], kept);
}

/* The march goes on from this t, and knows nothing of F there. */
static void begin_anew(rows a, size_t i, double t)
{
    a[T][i] = t, a[A][i] = a[SIGN][i] = a[H][i] = a[RATIO][i] = 0;
    double r = radius_at(a[OX][i], a[OY][i], a[DX][i], a[DY][i], t);
    a[WANTED][i] = radius_wanted(r, 0x1p-1000);
}

/* Is the ray above or below all that is ahead of it?  That costs more than a look.  So it is asked of rays
 * that have just left the surface, and of those on the way out after 4, 8, 16 and 32 looks.  If it is so of a
 * stretch ahead, the march moves to its end, where it begins anew. */
static bool leaves_by_heights(sgt_surface s, const sgt_ray *ray, rows a, size_t i, bool off, double t,
                              double evals, vicinities *kept)
{
    bool now = off || (a[PX][i] * a[DX][i] + a[PY][i] * a[DY][i] > 0 &&
                           (evals == 4 || evals == 8 || evals == 16 || evals == 32));
    if (!now) return false;
    double clear = sgt_clear_by_heights(heights_about(s, kept), ray, t), inverse = inverse_of_scale(ray->d);
    if (clear == HUGE_VAL || clear > ray->tmax) return true;
    if (clear * inverse > a[T][i] && a[PAST][i] == HUGE_VAL) begin_anew(a, i, clear * inverse);
    return false;
}

/* The ray is past the last rung.  Does it certainly leave the surface, or end, without a root?  The heights
 * of rings cost a twentieth of an enclosure.  That is asked in pieces if it knows too little of the whole,
 * until one in 2^-12 of the rest says no: a root is there, or nearly.  The march has come to that piece. */
static bool leaves_by_edge(sgt_surface s, const sgt_ray *ray, double edge, rows a, size_t i, double scale,
                           vicinities *kept, const vicinity *v)
{
    if (!(a[RADIUS][i] > edge * (1 - 0x1p-10))) return false;
    sgt_rays one = rays_of(ray);
    double outer2 = edge * edge * (1 + 0x1p-40), steep = 0, lo, end, least, from = a[T][i] * scale;
    s.ops->own_->chords(1, one, &outer2, &steep, NULL, &lo, &end, &least);
    if (end > ray->tmax) end = ray->tmax;
    if (!(from < end && end < HUGE_VAL)) return false;
    if (sgt_clear_by_heights(heights_about(s, kept), ray, from) >= end) return true;
    double width = end - from;
    for (int k = 0; k < LEAVING && from < end && width > 0x1p-12 * (end - from); k++) {
        double to = width < end - from ? from + width : end;
        sgt_interval slope, t = {0, sgt_sum_above(to, -from)},
                            g = s.ops->own_->enclose(s.self, ray, from, t, &slope);
        v->evals[(size_t)a[LANE][i]] += 1;
        if (v->told)
            tell_cell(v->told, SGT_MARCH, from, to, g, slope);
        bool certain = g.lo > 0 || g.hi < 0; /* also an empty one */
        from = certain ? to : from;
        width *= certain ? 2 : 0.25;
    }
    if (v->clear) v->clear[(size_t)a[LANE][i]] = larger(v->clear[(size_t)a[LANE][i]], from);
    return !(from < end);
}

static sgt_ray row_ray(const sgt_rays *r, const vicinity *v, size_t i)
{
    return (sgt_ray){
        {r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]}, v->tmin[i], v->tmax[i]};
}

/* Some rows that start on the surface: which, where F is asked, and what it is there. */
enum { STARTS = 32 };
typedef struct starts {
    size_t n, of[STARTS];
    double t[STARTS], p[3][STARTS], f[STARTS], grad[3][STARTS], own[STARTS];
} starts;

/* F at a point, the slope there, a bound on F's error from all that is rounded, its part that does not come
 * from the surface, and the terms of the rule of the start. */
typedef struct looked { double f, slope, err, place, terms; } looked;

/* Asks for F at e->t of all of them.  false: its rounding is not known. */
static bool look_at_starts(sgt_surface s, rows a, const sgt_rays *r, const sgt_shared *known,
                           const vicinity *v, starts *e)
{
    for (size_t j = 0; j < e->n; j++) {
        size_t k = e->of[j];
        for (int c = 0; c < 3; c++) e->p[c][j] = a[OX + c][k] + e->t[j] * a[DX + c][k];
        v->evals[(size_t)a[LANE][k]] += 1;
    }
    sgt_points at = {{e->p[0], e->p[1], e->p[2]}};
    s.ops->values(s.self, e->n, at, (sgt_values){e->f, {e->grad[0], e->grad[1], e->grad[2]}});
    if (!s.ops->own_->roundings(s.self, known, e->n, at, e->f, e->own)) return false;
    if (v->told && e->n > 0) { /* one ray, row 0 */
        double scale = scale_of((sgt_vec3){r->d[0][0], r->d[1][0], r->d[2][0]}), t = e->t[0] * scale,
               slope = e->grad[0][0] * r->d[0][0] + e->grad[1][0] * r->d[1][0] + e->grad[2][0] * r->d[2][0];
        tell(v->told, SGT_MARCH, t, e->f[0], slope, a[T][0] * scale, t);
    }
    return true;
}

static looked look_of(rows a, const starts *e, size_t j)
{
    size_t k = e->of[j];
    local q = {.x = a[OX][k], .y = a[OY][k], .z = a[OZ][k], .l = a[DX][k], .m = a[DY][k], .n = a[DZ][k]};
    sgt_vec3 p = {e->p[0][j], e->p[1][j], e->p[2][j]}, grad = {e->grad[0][j], e->grad[1][j], e->grad[2][j]};
    around at = around_of(&q, e->t[j], p, grad, HUGE_VAL);
    double noise = sgt_fma(a[E1][k], p.x * p.x + p.y * p.y, a[E0][k]);
    return (looked){e->f[j], at.slope, e->own[j] + 1.01 * (at.place + noise), at.place,
                    fabs(p.x * grad.x) + fabs(p.y * grad.y) + fabs(p.z * grad.z)};
}

/* How far from its start row k is looked at once more.  in_rings: what is known of F'' holds within the row's
 * radius; else up to its END.  NaN: nowhere. */
static double step_off(rows a, size_t k, bool in_rings, double bend, double slope)
{
    double t = a[T][k], ox = a[OX][k], oy = a[OY][k], l = a[DX][k], m = a[DY][k], R = a[RADIUS][k],
           h = 0.2 * fabs(slope) / bend, most = 0.5 * (a[END][k] - t);
    if (in_rings) most = 0.98 * (R - radius_of(ox + t * l, oy + t * m)) / radius_of(l, m);
    h = h < most ? h : most;
    if (!(h >= 0x1p-40 * fabs(t) && h > 0 && h < HUGE_VAL)) return (double)NAN;
    if (in_rings && !(radius_at(ox, oy, l, m, t) <= R && radius_at(ox, oy, l, m, t + h) <= R))
        return (double)NAN;
    return h;
}

/* Has row k left the start, h on, with a root that is nearer than this many reaches of the rule?  Then it
 * moves there. */
static bool leaves_start(rows a, size_t k, const looked *start, const looked *next, double h, double reaches)
{
    double bend = larger(-a[BENT_LO][k], a[BENT_HI][k]), off = fabs(start->f) + start->err,
           b = fabs(next->f) - next->err, curve = 0.5625 * bend * h, least = (b - off) / h - curve,
           most = (fabs(next->f) + next->err + off) / h + curve;
    if (!(b > 0 && least > curve && off * most < reaches * START_ULPS * start->terms * least)) return false;
    a[T][k] += h, a[A][k] = b, a[SIGN][k] = copysign(1, next->f), a[H][k] = 0;
    return true;
}

/* HIDDEN: is F at the start of this ray 0 by far less than its enclosure there is wide? */
static bool start_is_hidden(sgt_surface s, const sgt_ray *ray, double f, const vicinity *v, size_t lane)
{
    sgt_interval slope, at = {0, 0}, g = s.ops->own_->enclose(s.self, ray, ray->tmin, at, &slope);
    v->evals[lane] += 1;
    if (v->told) tell_cell(v->told, SGT_MARCH, ray->tmin, ray->tmin, g, slope);
    return g.lo < 0 && g.hi > 0 && 8 * fabs(f) <= smaller(-g.lo, g.hi) && g.hi - g.lo < HUGE_VAL;
}

/* The bound for many points is a wide one where terms vanish on a line: that of the point itself. */
static void sharpen(sgt_surface s, rows a, size_t k, double t, looked *e)
{
    sgt_vec3 p = {a[OX][k] + t * a[DX][k], a[OY][k] + t * a[DY][k], a[OZ][k] + t * a[DZ][k]};
    e->err = 1.01 * (e->place + s.ops->rounding(s.self, p));
}

/* The rows that may start on the surface.  See LEAVING.  Their VERDICT is set: OFF: the march has left the
 * start; LEFT: nothing is met as far as what is known reaches; else as if they did not. */
static void leave_starts(sgt_surface s, rows a, size_t left, bool in_rings, const sgt_rays *r,
                         const sgt_shared *known, const vicinity *v)
{
    starts e;
    looked start[STARTS];
    double h[STARTS];
    for (size_t i = 0; i < left;) {
        size_t kept = 0;
        for (e.n = 0; i < left && e.n < STARTS; i++) {
            if (a[VERDICT][i] != HIDDEN) continue;
            a[VERDICT][i] = a[SIGN][i] != 0 ? MOVED : GIVEN_UP;
            sgt_ray ray = row_ray(r, v, (size_t)a[LANE][i]);
            if (a[T][i] * scale_of(ray.d) == ray.tmin) e.of[e.n] = i, e.t[e.n++] = a[T][i];
        }
        if (e.n == 0 || !look_at_starts(s, a, r, known, v, &e)) continue;
        for (size_t j = 0; j < e.n; j++) {
            size_t k = e.of[j];
            double bend = larger(-a[BENT_LO][k], a[BENT_HI][k]);
            looked one = look_of(a, &e, j);
            double off = bend < HUGE_VAL ? step_off(a, k, in_rings, bend, one.slope) : (double)NAN;
            if (off == off) start[kept] = one, h[kept] = off, e.of[kept] = k, e.t[kept++] = a[T][k] + off;
        }
        e.n = kept;
        if (e.n == 0 || !look_at_starts(s, a, r, known, v, &e)) continue;
        for (size_t j = 0; j < e.n; j++) {
            size_t k = e.of[j];
            looked next = look_of(a, &e, j);
            if (!leaves_start(a, k, &start[j], &next, h[j], 0.98)) {
                sharpen(s, a, k, a[T][k], &start[j]), sharpen(s, a, k, e.t[j], &next);
                const size_t lane = (size_t)a[LANE][k];
                const sgt_ray ray = row_ray(r, v, lane);
                if (!leaves_start(a, k, &start[j], &next, h[j], 0.98) &&
                    !(start_is_hidden(s, &ray, start[j].f, v, lane) &&
                      leaves_start(a, k, &start[j], &next, h[j], 8)))
                    continue;
            }
            bow F2 = bow_of(a[SIGN][k], a[BENT_LO][k], a[BENT_HI][k]);
            a[VERDICT][k] = F2.least >= 0 && !in_rings ? LEFT : OFF;
        }
    }
}

/* Is the ray at t, and from there on, above or below all of the surface? */
static bool is_past_all(sgt_surface s, const sgt_ray *ray, double t, vicinities *kept)
{
    double low = HUGE_VAL, high = -HUGE_VAL, z = ray->o.z + t * ray->d.z,
           off = 0x1p-40 * (fabs(ray->o.z) + fabs(t * ray->d.z));
    const sgt_heights *g = heights_about(s, kept);
    for (int j = 0; j < SGT_RINGS; j++) low = -larger(-low, -g->low[j]), high = larger(high, g->high[j]);
    return g->width > 0 && ((ray->d.z < 0 && z + off < low) || (ray->d.z > 0 && z - off > high));
}

static void is_miss(const vicinity *v, size_t k) { v->asked[k] = 0, v->lo[k] = 1, v->hi[k] = 0; }

static void wings_leave(rows a, size_t i, size_t last)
{
    for (int j = 0; j < ROWS; j++) a[j][i] = a[j][last];
}

/* The rows of ray i that depend on the ray and t alone. */
static void lay_row(rows a, size_t k, const sgt_ray *ray, size_t i, double t, double seed)
{
    double scale = scale_of(ray->d), inverse = inverse_of_scale(ray->d);
    a[OX][k] = ray->o.x, a[OY][k] = ray->o.y, a[OZ][k] = ray->o.z;
    a[DX][k] = ray->d.x * scale, a[DY][k] = ray->d.y * scale, a[DZ][k] = ray->d.z * scale;
    a[T][k] = t * inverse, a[H][k] = 0, a[A][k] = 0, a[SIGN][k] = 0, a[RATIO][k] = 0, a[RADIUS][k] = 0,
    a[PAST][k] = HUGE_VAL, a[B][k] = 0, a[SEED][k] = seed * inverse, a[LANE][k] = (double)i;
}

typedef enum march_mode { IN_RINGS, IN_CHORD, IN_BOX } march_mode;

static void march_rows(sgt_surface s, size_t left, sgt_rays r, march_mode mode, const sgt_shared *known,
                       double edge, vicinities *kept, const vicinity *v);

/* Of powers of two at one of the first places, else at one of the others. */
static box *box_about(sgt_surface s, double x, double y, bool coarse, vicinities *kept)
{
    if (!kept->any_boxes)
        for (int i = 0; i < BOXES; i++) kept->boxes[i].x = kept->boxes[i].y = 0;
    kept->any_boxes = true;
    int fine = place_of(x, FINER, BOXES / 2) ^ place_of(x, COARSE, BOXES / 2) ^ place_of(y, FINE, BOXES / 2) ^
               place_of(y, FINER, BOXES / 2);
    box *b = &kept->boxes[coarse ? 4 * place_of(y, COARSE, 2) + place_of(x, COARSE, 4) : BOXES / 2 + fine];
    if (b->x != x || b->y != y) {
        b->x = x, b->y = y, b->noisy = false;
        s.ops->own_->extent_in_box(s.self, x, y, &b->steep, &b->axis);
    }
    return b;
}

/* Sets what F'' along row k lies in, within a box that holds |x| and |y| of these.  To work a box out costs
 * more than a root, so there are few: powers of two, not too narrow.  Where the surface ends before those, or
 * F'' may have either sign: along the rays an eighth of a power of two, or in both directions a
 * thirty-second.  NULL: the surface ends in each. */
static box *box_for(sgt_surface s, rows a, size_t k, double x, double y, vicinities *kept)
{
    double wide = larger(x, y);
    box *found = NULL;
    for (int i = 0; i < 3; i++) {
        double least = wide * (i ? 0x1p-10 : 0x3p-7), X = larger(x, least), Y = larger(y, least);
        X = rung_above(X, i == 2 ? FINER : i && x == wide ? FINE : COARSE);
        Y = rung_above(Y, i == 2 ? FINER : i && y == wide ? FINE : COARSE);
        if (!(X < HUGE_VAL && Y < HUGE_VAL)) return NULL;
        box *b = box_about(s, X, Y, i == 0, kept);
        if (!(b->axis.xx.hi < HUGE_VAL && b->axis.yy.hi < HUGE_VAL)) continue;
        bend_along(a, k, (sgt_interval)SGT_ANY_NUMBER, &b->axis);
        found = b;
        if (a[BENT_LO][k] >= 0 || a[BENT_HI][k] <= 0) break;
    }
    return found;
}

/* A half-width that holds the coordinate from t to end. */
static double half_width(double o, double d, double t, double end)
{
    double a = fabs(o + t * d), b = fabs(o + end * d), far = fabs(o) + (fabs(t) + fabs(end)) * fabs(d);
    return 1.02 * larger(a, b) + 0x1p-40 * far;
}

void sgt_march_box(sgt_surface s, size_t n, sgt_rays r, const double *begin, const sgt_shared *bare,
                   vicinities *kept, const vicinity *v)
{
    rows a = v->work;
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        double from = begin[i]; /* perhaps one of the rows */
        if (v->asked[i] == 0) continue;
        sgt_ray ray = row_ray(&r, v, i);
        double flat = -ray.o.z / ray.d.z, ahead = v->seed[i] - from,
               aim = ahead > 0.25 * (flat - from) && ahead > 0 ? v->seed[i] : flat,
               end = aim + 0.25 * (aim - from);
        if (!(fabs(from) < HUGE_VAL && aim > from && end < ray.tmax && end < HUGE_VAL)) continue;
        double x = half_width(ray.o.x, ray.d.x, from, end), y = half_width(ray.o.y, ray.d.y, from, end);
        size_t k = left;
        lay_row(a, k, &ray, i, from, aim);
        box *e = box_for(s, a, k, x, y, kept);
        if (!e) continue;
        double least =
            fabs(a[DZ][k]) * (1 - 0x1p-40) - (e->axis.x * fabs(a[DX][k]) + e->axis.y * fabs(a[DY][k]));
        if (aim == v->seed[i] && least > 0x1p-4 * fabs(a[DZ][k])) {
            v->lo[i] = from, v->hi[i] = end, v->least[i] = least, v->asked[i] = -1;
            continue;
        }
        left++;
        if (!e->noisy) s.ops->own_->noise_in_box(s.self, e->x, e->y, e->noise);
        e->noisy = true;
        a[END][k] = end * inverse_of_scale(ray.d);
        a[RADIUS][k] = DBL_MAX, a[STEEP][k] = e->steep, a[E0][k] = e->noise[0], a[E1][k] = e->noise[1];
    }
    march_rows(s, left, r, IN_BOX, bare, HUGE_VAL, kept, v);
}

void sgt_march_chord(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, const vicinity *v)
{
    rows a = v->work;
    double radius = sqrt(whole->radius2) * (1 + 0x1p-21);
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        if (v->asked[i] == 0) continue;
        sgt_ray ray = row_ray(&r, v, i);
        double from = larger(v->lo[i], ray.tmin), to = smaller(v->hi[i], ray.tmax);
        if (!(from < to && fabs(from) < HUGE_VAL && to < HUGE_VAL)) continue;
        size_t k = left++;
        lay_row(a, k, &ray, i, from, v->seed[i]);
        double end = to * inverse_of_scale(ray.d);
        a[END][k] = end + 0x1p-48 * (fabs(end) + fabs(a[T][k]));
        bend_along(a, k, whole->bent, whole->by_axis ? &whole->axis : NULL);
        a[RADIUS][k] = radius, a[STEEP][k] = whole->steep, a[E0][k] = a[E1][k] = 0;
    }
    march_rows(s, left, r, IN_CHORD, whole, HUGE_VAL, NULL, v);
}

/* The rows that the march is to begin with: of all that are asked, or of those on one side of the edge. */
static bool is_marched(const vicinity *v, double edge, bool behind, double t, size_t i)
{
    if (!(v->asked[i] > 0) || !(fabs(t) < HUGE_VAL)) return false;
    return !(edge < HUGE_VAL) || behind == (v->seed[i] < v->tmin[i]);
}

/* Looks along these rows, from their t on.  Those that begin where they may start on the surface are left to
 * the march, which knows how to leave it (as stays_off of vicinity.c has it). */
static void begin_along(sgt_surface s, const sgt_rays *r, size_t count, const size_t row[], double *begin,
                       vicinities *kept, const vicinity *v)
{
    double p[3][ALONG_ROWS], f[ALONG_ROWS], g[3][ALONG_ROWS], t[ALONG_ROWS];
    size_t some = 0, off[ALONG_ROWS] = {0};
    along_says said[ALONG_ROWS];
    bool any = false;
    for (size_t j = 0; j < count; j++) {
        for (int c = 0; c < 3; c++) p[c][j] = r->o[c][row[j]];
        any |= begin[row[j]] == v->tmin[row[j]] &&
               starts_low((sgt_vec3){p[0][j], p[1][j], p[2][j]}, begin[row[j]]);
        f[j] = g[0][j] = g[1][j] = g[2][j] = 0; /* of none that is low */
    }
    if (any)
        s.ops->values(s.self, count, (sgt_points){{p[0], p[1], p[2]}},
                      (sgt_values){f, {g[0], g[1], g[2]}});
    for (size_t j = 0; j < count; j++) {
        size_t i = row[j];
        double terms = fabs(p[0][j] * g[0][j]) + fabs(p[1][j] * g[1][j]) + fabs(p[2][j]);
        bool low = begin[i] == v->tmin[i] && starts_low((sgt_vec3){p[0][j], p[1][j], p[2][j]}, begin[i]);
        if (!low || fabs(f[j]) > 0x1p-32 * terms) off[some] = i, t[some++] = begin[i];
    }
    sgt_look_along(s, r, some, off, t, said, kept, v);
    for (size_t j = 0; j < some; j++) {
        size_t i = off[j];
        if (said[j] == ALONG_MISS) is_miss(v, i);
        if (said[j] == ALONG_CLEAR && v->clear) v->clear[i] = larger(v->clear[i], t[j]);
        begin[i] = t[j];
    }
}

/* The same for all rows that are to be marched along. */
SGT_NOINLINE
static void begin_along_all(sgt_surface s, size_t n, const sgt_rays *r, double edge, bool behind,
                            double *begin, vicinities *kept, const vicinity *v)
{
    size_t row[ALONG_ROWS], count = 0;
    for (size_t i = 0; i <= n; i++) {
        if (i < n && is_marched(v, edge, behind, begin[i], i)) row[count++] = i;
        if (count < ALONG_ROWS && i < n) continue;
        if (count > 0) begin_along(s, r, count, row, begin, kept, v);
        count = 0;
    }
}

void sgt_begin_by_profile(sgt_surface s, size_t n, const sgt_rays *r, double *from, vicinities *kept,
                          const vicinity *v)
{
    const bool far = !s.ops->own_->departure->heights_first;
    size_t row[ALONG_ROWS], count = 0;
    for (size_t i = 0; i <= n; i++) {
        if (i < n && fabs(from[i]) < HUGE_VAL && sgt_early(r, v, from, far, i)) row[count++] = i;
        if (count < ALONG_ROWS && i < n) continue;
        if (count > 0) begin_along(s, r, count, row, from, kept, v);
        count = 0;
    }
}

void sgt_march_wings(sgt_surface s, size_t n, sgt_rays r, const double *from, bool behind,
                     const sgt_shared *bare, vicinities *kept, const vicinity *v)
{
    rows a = v->work;
    double edge = sqrt(bare->radius2), begin[VICINITY_MOST];
    size_t left = 0;
    memcpy(begin, from, n * sizeof *begin);
    begin_along_all(s, n, &r, edge, behind, begin, kept, v);
    if (v->told && v->told->stopped) return;
    for (size_t i = 0; i < n; i++) {
        double t = begin[i];
        if (!is_marched(v, edge, behind, t, i)) continue;
        sgt_ray ray = row_ray(&r, v, i);
        size_t k = left;
        lay_row(a, k, &ray, i, t, v->seed[i]);
        double begins = radius_at(ray.o.x, ray.o.y, ray.d.x, ray.d.y, t);
        if (bare->tailed) {
            sgt_outlook out = outlook_of(a, k);
            double clear = sgt_past_tail(s, &out, a[T][k], smaller(begins, edge), &kept->tails);
            if (clear > a[T][k]) t = clear * scale_of(ray.d);
        }
        t = inside_edge(s, &ray, t, edge, kept, v, &v->evals[i]);
        if (!(t <= ray.tmax) || (v->told && v->told->stopped)) continue; /* nor NaN */
        lay_row(a, k, &ray, i, t, v->seed[i]);
        left++;
        double x = ray.o.x + t * ray.d.x, y = ray.o.y + t * ray.d.y;
        double outward = x * a[DX][k] + y * a[DY][k];
        begins = radius_at(ray.o.x, ray.o.y, ray.d.x, ray.d.y, t);
        a[END][k] = 4 * larger(begins, radius_at(ray.o.x, ray.o.y, ray.d.x, ray.d.y, v->seed[i]));
        if (edge < HUGE_VAL) a[END][k] = HUGE_VAL;
        else a[END][k] = larger(a[END][k], SGT_RINGS * heights_about(s, kept)->width);
        a[WANTED][k] = radius_wanted(begins, outward * 0x1p-1000); /* no step yet; as wings_judge has it */
        enclose_in(s, edge, bare->boxed, &kept->rings, a, k);
    }
    march_rows(s, left, r, IN_RINGS, bare, edge, kept, v);
}

/* Marches along the first rows.  known: what `roundings` is given.  edge: in rings only; kept: not in a
 * chord. */
static void march_rows(sgt_surface s, size_t left, sgt_rays r, march_mode mode, const sgt_shared *known,
                       double edge, vicinities *kept, const vicinity *v)
{
    rows a = v->work;
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    const bool in_rings = mode == IN_RINGS;
    double known_past = 0;
    while (left > 0) {
        double grad[3], *g = v->told ? grad : NULL;
        if (known_past == 0) wings_step_ahead(a, left, in_rings);
        else wings_step(a, left, in_rings);
        sgt_points at = {{a[PX], a[PY], a[PZ]}};
        s.ops->values(s.self, left, at, (sgt_values){a[F], {g, g ? g + 1 : NULL, g ? g + 2 : NULL}});
        if (!builtin->roundings(s.self, known, left, at, a[F], a[OWN])) return;
        if (v->told) {
            double scale = scale_of((sgt_vec3){r.d[0][0], r.d[1][0], r.d[2][0]});
            double slope = grad[0] * r.d[0][0] + grad[1] * r.d[1][0] + grad[2] * r.d[2][0],
                   next = (a[SIGN][0] != 0 ? a[T][0] + a[H][0] : a[T][0]) * scale;
            tell(v->told, SGT_MARCH, next, a[F][0], slope, a[T][0] * scale, next);
        }
        known_past = wings_judge(a, left, in_rings);
        size_t hidden = 0;
        for (size_t i = 0; i < left; i++) hidden += a[VERDICT][i] == HIDDEN;
        if (hidden) leave_starts(s, a, left, in_rings, &r, known, v);
        for (size_t i = left; i-- > 0;) {
            size_t k = (size_t)a[LANE][i];
            double verdict = a[VERDICT][i], evals = v->evals[k] += 1;
            bool spent = evals >= 0.5 * v->budget || evals >= MOST_STEPS || (v->told && v->told->stopped);
            if (verdict == GOES_ON && !spent) continue;
            sgt_ray ray = row_ray(&r, v, k);
            double scale = scale_of(ray.d);
            const bool off = verdict == OFF;
            if (off) verdict = MOVED;
            if (verdict == LEFT) {
                bool ends = a[END][i] * scale >= ray.tmax;
                if (mode == IN_CHORD || ends || is_past_all(s, &ray, a[END][i] * scale, kept)) is_miss(v, k);
                wings_leave(a, i, --left);
            } else if (verdict == MOVED && !spent) {
                double t = a[T][i] * scale;
                if (in_rings && off) {
                    along_says said;
                    sgt_look_along(s, &r, 1, &k, &t, &said, kept, v);
                    if (said == ALONG_MISS) is_miss(v, k);
                    if (said == ALONG_MISS || said == ALONG_ROOT || (v->told && v->told->stopped)) {
                        wings_leave(a, i, --left);
                        continue;
                    }
                    if (said == ALONG_CLEAR) begin_anew(a, i, t * inverse_of_scale(ray.d));
                }
                if (in_rings) enclose_in(s, edge, known->boxed, &kept->rings, a, i);
                if (mode == IN_BOX) {
                    if (!(a[T][i] < a[END][i] * (1 - 0x1p-40))) wings_leave(a, i, --left);
                } else if (t > ray.tmax
                           || (in_rings ? (known->tailed && leaves_by_tail(s, a, i, &kept->tails)) ||
                                            leaves_by_heights(s, &ray, a, i, off, t, evals, kept) ||
                                            leaves_by_edge(s, &ray, edge, a, i, scale, kept, v)
                                      : t > v->hi[k])) {
                    is_miss(v, k);
                    wings_leave(a, i, --left);
                } else if (in_rings && a[SIGN][i] == 0)
                    enclose_in(s, edge, known->boxed, &kept->rings, a, i);
            } else {
                double t = a[T][i] * scale;
                if (verdict == FOUND && !spent) {
                    /* the march has moved behind the end of the ray, and knows the root there at once */
                    if (t > ray.tmax || (mode == IN_CHORD && t > v->hi[k])) is_miss(v, k);
                    else tell_root(a, i, scale, v);
                }
                if (v->clear && v->asked[k] != 0) v->clear[k] = larger(v->clear[k], t);
                wings_leave(a, i, --left);
            }
        }
    }
}
