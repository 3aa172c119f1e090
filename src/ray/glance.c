// SPDX-License-Identifier: MIT
/* glance.c - rays that graze a sag within its rim, or enter it from the side: is the root near the seed the
 * first one?  Two looks beside that root tell, mostly.  A march along the chord (wings.c) looks where the
 * chord begins, too, and at each step on the way.  It is for the rays that are left.
 *
 * Let G be F or -F, so that G falls at the root that is asked for, and let G'' lie in [low, high] all along
 * the chord, as the bounds on the second derivative have it (wings.c, THE BEND, BY AXIS).  Let B be the
 * greater of |low| and |high|.
 *
 * THE ROOT.  Let G be at least a > 0 at `left`, and at most -b < 0 at `right`, h later.  Its mean slope
 * between is at most -(a + b) / h, from which G' differs by at most B h / 2 at the ends, and by less between.
 * So if (a + b) / h > 2 B h, G falls all the way, and there is one root (wings.c, THE ROOT).  Neither the
 * slope that was computed nor the guess at the root is trusted: they choose where F is looked at.
 *
 * THE FIRST.  At `left`, -G' is at least g = (a + b) / h - B h / 2.  So d before it
 *     G >= a + g d + low d^2 / 2.
 * That is above a where low >= 0: the surface bends away from the ray.  Else it is concave in d.  So it is
 * above 0 from the beginning of the chord, or of the ray, D before `left`, to `left`, if it is above 0 at d =
 * D.  Where it is not, F is looked at once more, at that beginning.  If G is at least c > 0 there, it is
 * above 0 between by the two values alone if high <= 0 (it is concave), or if D sqrt(high / 2) < sqrt a +
 * sqrt c (wings.c, THE MARCH).  A root before the beginning is not accepted.
 *
 * THE LOOKS.  The first is at the seed.  F, its slope and its bend there say which sign F has where the chord
 * begins, and so which of two roots is the first; and by a quadratic equation where that is.  (One that is
 * nearly touched has another one beside it, and Newton's steps take long to tell them apart.)  The bend is
 * the middle of what is known, or what the last two slopes have shown.  With the slope s at the root, the
 * next look is s / 8 B beyond.  So the two are on either side of the root if the guess is off by less, and
 * they are as near to each other as the rule asks for if the first was within s / 3 B.  Else the third look
 * is as far on this side.  Rays for which THE FIRST would fail by these numbers are left at once.
 *
 * ROUNDING.  The points and the bound on F there are as in wings.c (THE ROUNDING), and so are the factors on
 * these conditions, each of a part in 2^20 for the few roundings that they are made of.  Bounds hold as far
 * as r = radius (1 + 2^-20); r^2 is convex, so they hold between two points within that.
 *
 * A ray that starts low, with its seed next to the start, leaves the surface as a rule.  It is not looked at,
 * unless takeoff.c has moved its beginning off the start.
 *
 * Each row is by itself, whatever its neighbours do. */
#include "glance.h"
#include "wings.h"

#include "../num/lanes.h"
#include "../solve/step.h"

enum { LOOKS = 5 };

/* The rows of a ray.
 *
 *     OX ... DZ          the ray; its direction is scaled to 1 ... 2 by a power of two, and t with it
 *     FROM, TO           what is searched; NaN: nothing is
 *     T                  where F is looked at
 *     LEFT, A, RIGHT, B  the nearest points on either side of the root, and at least |F| there
 *     SIGN               F before the root has this sign; 0: not yet known
 *     LOW, HIGH          F'' is between them
 *     GUESS              where the root is thought to be
 *     BEFORE, SLOPE      the last point, and the slope there
 *     STATE              SEEKS ... TOLD
 *     PX ... OWN         the point, F and its gradient there, and its rounding */
enum {
    OX,
    OY,
    OZ,
    DX,
    DY,
    DZ,
    FROM,
    TO,
    T,
    LEFT,
    A,
    RIGHT,
    B,
    SIGN,
    LOW,
    HIGH,
    GUESS,
    BEFORE,
    SLOPE,
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

/* SEEKS: looks beside the root.  BEGIN: looks where the chord begins.  TOLD: was KNOWN or LOST. */
enum { SEEKS, BEGIN, KNOWN, LOST, TOLD };

typedef double *const *rows;

/* From the rays as they are.  GUESS: the seed. */
SGT_INLINE void glance_begins(bool by_axis, rows w, size_t n, const sgt_shared *whole, double R)
{
    double *restrict dx = w[DX], *restrict dy = w[DY], *restrict dz = w[DZ], *restrict from = w[FROM],
           *restrict to = w[TO], *restrict t = w[T], *restrict left = w[LEFT], *restrict right = w[RIGHT],
           *restrict a = w[A], *restrict b = w[B], *restrict sign = w[SIGN], *restrict low = w[LOW],
           *restrict high = w[HIGH], *restrict before = w[BEFORE], *restrict slope = w[SLOPE],
           *restrict state = w[STATE], *restrict px = w[PX], *restrict py = w[PY], *restrict pz = w[PZ];
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *seed = w[GUESS];
    const bends of = bends_of(whole);
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = {dx[i], dy[i], dz[i]};
        double scale = scale_of(d), inverse = inverse_of_scale(d), l = d.x * scale, m = d.y * scale;
        sgt_interval bent = bent_along(by_axis, &of, l, m);
        double first = from[i] * inverse, last = to[i] * inverse, tx = first * l, ty = first * m;
        mask in = glance_within(R, ox[i] + tx, oy[i] + ty, tx, ty);
        double at = larger(seed[i] * inverse, first);
        at = -larger(-at, -last);
        dx[i] = l, dy[i] = m, dz[i] = d.z * scale;
        from[i] = chosen(in, first, (double)NAN), to[i] = last, t[i] = at;
        left[i] = -HUGE_VAL, right[i] = HUGE_VAL, a[i] = b[i] = 0;
        sign[i] = 0, low[i] = -bent.hi, high[i] = -bent.lo;
        before[i] = (double)NAN, slope[i] = 0, state[i] = SEEKS;
        px[i] = ox[i] + at * l, py[i] = oy[i] + at * m, pz[i] = oz[i] + at * dz[i];
    }
}

#define GLANCE_BEGIN(NAME, BY_AXIS)                                                                          \
    SGT_KERNEL                                                                                               \
    static void NAME(rows w, size_t n, const sgt_shared *whole, double R)                                    \
    {                                                                                                        \
        glance_begins(BY_AXIS, w, n, whole, R);                                                              \
    }
GLANCE_BEGIN(glance_begin, false)
GLANCE_BEGIN(glance_begin_by_axis, true)

/* What F at the point has shown; and the next point, if STATE is below KNOWN.  last: there is none but the
 * beginning of the chord. */
SGT_KERNEL
static void glance_judge(rows w, size_t n, double steep, double R, bool last)
{
    const double *ox = w[OX], *oy = w[OY], *oz = w[OZ], *dx = w[DX], *dy = w[DY], *dz = w[DZ],
                 *from = w[FROM], *to = w[TO], *low = w[LOW], *high = w[HIGH], *f = w[F], *fx = w[FX],
                 *fy = w[FY], *own = w[OWN];
    double *restrict at = w[T], *restrict left = w[LEFT], *restrict a = w[A], *restrict right = w[RIGHT],
           *restrict b = w[B], *restrict sign = w[SIGN], *restrict guess = w[GUESS],
           *restrict before = w[BEFORE], *restrict slope = w[SLOPE], *restrict state = w[STATE],
           *restrict px = w[PX], *restrict py = w[PY], *restrict pz = w[PZ];
    const double seeks = last ? LOST : SEEKS;
    LANES for (size_t i = 0; i < n; i++) {
        double l = dx[i], m = dy[i], t = at[i], x = px[i], y = py[i], z = pz[i], tx = fabs(t * l),
               ty = fabs(t * m), tz = fabs(t * dz[i]), was = state[i];
        double off = steep * (tx + fabs(x) + ty + fabs(y)) + tz + fabs(z),
               err = own[i] + 1.01 * (SGT_U * off + 0x1p-1000 * (1 + steep)), certain = fabs(f[i]) - err,
               falls = fx[i] * l + fy[i] * m + dz[i];
        double D0 = t - from[i], guessed = f[i] - D0 * (falls - 0.25 * (low[i] + high[i]) * D0),
               side = chosen(MASK(sign[i] == 0), copysign(1, guessed), sign[i]);
        mask seeking = MASK(was == SEEKS), begins = MASK(was == BEGIN), at_begin = MASK(D0 <= 0),
             good = MASK(certain > 0) & glance_within(R, x, y, tx, ty),
             turns = seeking & good & at_begin & MASK(side * f[i] < 0);
        double s = chosen(turns, -side, side), g = s * f[i], g1 = -(s * falls);
        double l_before = chosen(turns, -HUGE_VAL, left[i]), r_before = chosen(turns, HUGE_VAL, right[i]);
        mask rises = MASK(s > 0), is_left = seeking & good & MASK(g > 0) & (MASK(g1 > 0) | at_begin) &
                                             MASK(t > l_before) & MASK(t < r_before),
             is_right = seeking & good & MASK(g < 0) & MASK(t < r_before);
        double L = chosen(is_left, t, l_before), la = chosen(is_left, certain, a[i]),
               N = chosen(is_right, t, r_before), nb = chosen(is_right, certain, b[i]);
        double lo = chosen(rises, low[i], -high[i]), hi = chosen(rises, high[i], -low[i]),
               most = larger(-lo, hi), h = N - L, curve = most * h;
        /* THE ROOT */
        double far = larger(fabs(L), fabs(N)), mean = (la + nb) / h;
        mask one = MASK(h > 0) & MASK(h < HUGE_VAL) & MASK(2 * (1 + 0x1p-20) * curve * h < la + nb) &
                   MASK(h >= 0x1p-44 * far) & MASK(0x1p-48 * (far * (fabs(l) + fabs(m))) <= 0x1p-20 * R);
        /* THE FIRST */
        double D = L - from[i], steepest = mean - 0.5 * (1 + 0x1p-20) * curve,
               above = (1 - 0x1p-20) * (la + steepest * D), below = -0.5 * lo * (D * D);
        mask first = MASK(D >= 0) & (MASK(lo >= 0) | MASK(above > below));
        double bend = 0.5 * larger(hi, 0) * (D * D);
        mask between = good & MASK(g > 0) & MASK(D >= 0) &
                       MASK((1 + 0x1p-19) * bend < la + certain + 2 * sqrt(larger(la * certain, 0)));
        /* THE LOOKS */
        double shown = s * (falls - slope[i]) / (t - before[i]);
        shown = chosen(MASK(shown == shown), shown, 0.5 * (lo + hi));
        shown = -larger(-larger(shown, lo), -hi);
        double square = g1 * g1 - 2 * shown * g, root = sqrt(larger(square, 0)),
               two = chosen(MASK(g1 > 0) & MASK(square > 0), 1, 0),
               way = chosen(MASK(two > 0), 2 * g, g1 - root) / chosen(MASK(two > 0), g1 + root, shown),
               width = to[i] - from[i], beside = 0.125 * root / larger(most, 0x1p-900);
        beside = chosen(MASK(beside < 0x1p-4 * width), beside, 0x1p-4 * width);
        /* way may be -0: the mirror image in z has to look on the same side */
        double aim = t + way, next = aim + copysign(beside, way + 0.0);
        next = -larger(-larger(next, from[i]), -to[i]);
        mask goes = (MASK(square > 0) | ~MASK(before[i] == before[i])) & MASK(fabs(way) < HUGE_VAL) &
                    (MASK(next < t) | MASK(next > t));
        /* what THE FIRST would say: if it is no, at the first look */
        double bow = 0.5 * (D0 * D0);
        goes &= MASK(sign[i] != 0) | MASK(-lo * bow < root * D0) | MASK(hi * bow < fabs(guessed));
        double is = chosen(goes, seeks, (double)LOST);
        is = chosen(one, chosen(first, (double)KNOWN, (double)BEGIN), is);
        is = chosen(one & ~MASK(D > 0), chosen(first, (double)KNOWN, (double)LOST), is);
        is = chosen(begins, chosen(between, (double)KNOWN, (double)LOST), is);
        is = chosen(MASK(was >= KNOWN), was, is);
        next = chosen(MASK(is == BEGIN), from[i], next);
        next = chosen(MASK(is >= KNOWN), t, next);
        guess[i] = chosen(seeking, aim, guess[i]), before[i] = chosen(seeking, t, before[i]);
        slope[i] = falls, sign[i] = s, state[i] = is, at[i] = next;
        left[i] = L, a[i] = la, right[i] = N, b[i] = nb;
        px[i] = ox[i] + next * l, py[i] = oy[i] + next * m, pz[i] = oz[i] + next * dz[i];
    }
}

/* Reports the stretch that holds the root, and the seed of Newton's steps. */
static void tell_found(rows w, size_t k, const sgt_rays *r, const vicinity *v, size_t i)
{
    double scale = scale_of((sgt_vec3){r->d[0][i], r->d[1][i], r->d[2][i]}), lo = w[LEFT][k],
           hi = w[RIGHT][k], a = w[A][k], b = w[B][k], h = hi - lo, bend = larger(-w[LOW][k], w[HIGH][k]),
           seed = w[GUESS][k];
    if (!(seed > lo && seed < hi)) seed = lo + h * (a / (a + b));
    v->lo[i] = lo * scale, v->hi[i] = hi * scale, v->seed[i] = seed * scale, v->asked[i] = 0;
    v->least[i] = ((a + b) / h - 0.5625 * bend * h) * (1 - 0x1p-20);
}

void sgt_glance_chord(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, const vicinity *v)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    rows w = v->work;
    const double R = sqrt(whole->radius2) * (1 + 0x1p-21);
    size_t left = 0;
    if (!builtin->values_rounded) return;
    unsigned char of[VICINITY_MOST];
    const double *const ray[6] = {r.o[0], r.o[1], r.o[2], r.d[0], r.d[1], r.d[2]};
    for (size_t i = 0; i < n; i++) {
        double from = larger(v->lo[i], v->tmin[i]), to = v->hi[i] < v->tmax[i] ? v->hi[i] : v->tmax[i];
        if (v->asked[i] == 0 || !(from < to && fabs(from) < HUGE_VAL && to < HUGE_VAL)) continue;
        if (v->evals[i] + LOOKS + 1 >= 0.5 * v->budget) continue;
        if (from == v->tmin[i] && fabs(v->seed[i] - from) < 0x1p-5 * (to - from) &&
            starts_low((sgt_vec3){ray[0][i], ray[1][i], ray[2][i]}, v->tmin[i]))
            continue; /* its root is the start, mostly: a march knows how to leave */
        size_t k = left++;
        of[k] = (unsigned char)i;
        w[FROM][k] = from, w[TO][k] = to, w[GUESS][k] = v->seed[i];
    }
    if (left == 0) return;
    for (int c = 0; c < 6; c++)
        for (size_t k = 0; k < left; k++) w[OX + c][k] = ray[c][of[k]];
    (bends_by_axis(whole) ? glance_begin_by_axis : glance_begin)(w, left, whole, R);
    for (int looks = 1; left > 0; looks++) {
        sgt_points at = {{w[PX], w[PY], w[PZ]}};
        if (!builtin->values_rounded(s.self, whole, NULL, left, at, (sgt_values){w[F], {w[FX], w[FY], w[FZ]}},
                                     w[OWN]))
            return;
        if (v->told) { /* one ray, row 0 */
            double scale = scale_of((sgt_vec3){r.d[0][0], r.d[1][0], r.d[2][0]}), t = w[T][0] * scale,
                   slope = w[FX][0] * r.d[0][0] + w[FY][0] * r.d[1][0] + w[FZ][0] * r.d[2][0];
            tell(v->told, SGT_MARCH, t, w[F][0], slope, w[FROM][0] * scale, t);
        }
        glance_judge(w, left, whole->steep, R, looks >= LOOKS);
        size_t kept = 0;
        for (size_t k = 0; k < left; k++) {
            double state = w[STATE][k];
            if (state == TOLD) continue;
            v->evals[of[k]] += 1, kept += state < KNOWN;
            if (state == KNOWN) tell_found(w, k, &r, v, of[k]);
            if (state >= KNOWN) w[STATE][k] = TOLD;
        }
        if (v->told && v->told->stopped) return;
        if (2 * kept > left) continue; /* those that are done are looked at again, to no effect */
        kept = 0;
        for (size_t k = 0; k < left; k++) {
            if (w[STATE][k] == TOLD) continue;
            of[kept] = of[k];
            for (int j = 0; kept < k && j < PX + 3; j++) w[j][kept] = w[j][k];
            kept++;
        }
        left = kept;
    }
}
