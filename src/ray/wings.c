// SPDX-License-Identifier: MIT
/* wings.c - the wings of a sag, however steep: finds the first root on the way in from afar, or proves
 * that there is none on the way out (vicinity.h).  The same along a chord within the rim, however near to the
 * surface the ray runs.
 *
 * THE MARCH looks at F again and again, from where the search begins.  Take two points of the ray, h apart
 * in t, where F is certainly at least a and at least b on the same side of zero.  Let |F''| <= B all the
 * way between.  Then F is above the parabola through (0, a) and (h, b) of second derivative B,
 *
 *     a (1 - w) + b w - B h^2 w (1 - w) / 2,   0 <= w <= 1.
 *
 * That is > 0 everywhere if h sqrt(B / 2) < sqrt a + sqrt b (where the two are equal, its least value is
 * zero).  So no root is between the points, and the march moves to the second.
 *
 * THE ROOT.  Now let the signs be unlike, with |F| at least a and b.  Somewhere F' is the mean slope, at
 * least (a + b) / h, and nowhere it is more than B h from that.  If (a + b) / h is above 3 B h, F is
 * monotone between the two, with (a + b) / h - B h as lower bound on |F'|, and Newton's steps will do.
 * Else a shorter step is tried.
 *
 * When the ray is made local, the stretch is made longer by 2^-50 of t at either end (step.h).  That is
 * less than a sixteenth of h, which is why the bound uses 1.125 B h.  B holds on the longer stretch, too:
 * it is a bound for r <= radius (1 + 2^-19) (departure.c), and a root is taken as found only if the longer
 * stretch reaches less than 2^-20 radius farther out (wings_judge).
 *
 * B.  F is z less the sag.  So F'' is the second derivative of the sag along (d_x, d_y).  It is at most
 * its norm within a radius that holds both points, times d_x^2 + d_y^2.  As r^2 is convex, that radius
 * holds all points between.  It is an eighth of a power of two.  On the way in it becomes smaller with r,
 * and B with it.
 *
 * BY AXIS.  Where bounds on the entries of the second derivative are known (departure.c), that along the ray
 * is also at most s_xx d_x^2 + 2 s_xy |d_x d_y| + s_yy d_y^2.  For a mirror that is bent across the rays and
 * nearly flat along them this is a small part of the norm.
 *
 * WITHIN A RIM one bound B holds for the whole chord, and so do the noise and the slope.  The march begins
 * where the chord does, or the ray, and ends behind the chord or the ray.  There it is a miss: a root is
 * accepted within the rim only.
 *
 * IN A BOX |x| <= X, |y| <= Y, with X and Y the rungs next above what the stretch needs, the same is known
 * of a surface that is steeper along one axis.  The rounding is asked point by point, as what is known of
 * it is known within circles.  The march ends behind the seed, or behind the vertex plane, by a quarter of
 * the way to it.  There is none if F is monotone all along that stretch: then a root in it is the first.
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
 *                                that of the seed, if it is greater
 *
 * STEPS.  A step of 0.98 sqrt(2 a / B) is never refused while the sign stays.  Far out, F is a power of r,
 * and the next b is to a as the last was; so the step may be longer.
 *
 * Each lane is by itself.  A lane that is done is replaced by the last.  A march that has taken half of
 * max_evals leaves the rest to the search through enclosures, which begins anew. */
#include "wings.h"

#include "../num/bits.h"

#include <sagitta/interval.h>

enum { MOST_STEPS = 1024, EDGE_RUNGS = 9, LEAVING = 32 };

/* The rows of a lane.
 *
 *     OX ... DZ          the ray; its direction is scaled to 1 ... 2 by a power of two, and t with it
 *     T, H, A, SIGN      where the march is; the next step (0: not yet chosen); a lower bound on |F| there;
 *                        its sign (0: not yet known)
 *     RATIO              sqrt(b / a) of the last step, at most 1
 *     RADIUS ... E1      the radius, and what is known of the surface within it
 *     SEED, LIMIT        the seed; the r to which the ray is followed
 *     END                the t where a march along a chord ends; else infinite
 *     LANE, EVALS        its row in the caller's arrays; its evaluations
 *     NEXT ... OWN       the next point, F there and its rounding
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
    RATIO,
    RADIUS,
    STEEP,
    BEND,
    E0,
    E1,
    SEED,
    LIMIT,
    END,
    LANE,
    EVALS,
    NEXT,
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

enum { GOES_ON, MOVED, FOUND, GIVEN_UP };

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

/* The next point.  The length of the step is h if a step has been refused, else it is chosen here. */
SGT_KERNEL
static void wings_step(size_t n, const double *restrict ox, const double *restrict oy,
                       const double *restrict oz, const double *restrict dx, const double *restrict dy,
                       const double *restrict dz, const double *restrict at, const double *restrict h,
                       const double *restrict a, const double *restrict sign, const double *restrict ratio,
                       const double *restrict radius, const double *restrict bend,
                       const double *restrict seed, const double *restrict end, double *restrict next,
                       double *restrict px, double *restrict py, double *restrict pz)
{
    LANES for (size_t i = 0; i < n; i++) {
        double l = dx[i], m = dy[i], t = at[i], x = ox[i] + t * l, y = oy[i] + t * m, along = l * l + m * m;
        double nearest = -(x * l + y * m) / along, cross = (x * m - y * l), R = radius[i];
        double leaves = nearest + sqrt(larger(R * R - cross * cross / along, 0) / along);
        double by_bend = 0.98 * sqrt(2 * a[i] / bend[i]) * (1 + 0.8 * ratio[i]), ahead = seed[i] - t,
               past = 1.25 * ahead;
        double most = chosen(MASK(end[i] < HUGE_VAL), end[i] - t, 0.98 * leaves),
               length = chosen(MASK(by_bend < most), by_bend, most);
        length = chosen(MASK(ahead > 0) & MASK(past < length), past, length);
        length = chosen(MASK(h[i] > 0), h[i], length);
        t = chosen(MASK(sign[i] != 0), t + length, t);
        next[i] = t;
        px[i] = ox[i] + t * l, py[i] = oy[i] + t * m, pz[i] = oz[i] + t * dz[i];
    }
}

/* What F at the next point has shown. */
SGT_KERNEL
static void wings_judge(size_t n, const double *restrict dx, const double *restrict dy,
                        const double *restrict dz, double *restrict at, double *restrict h,
                        double *restrict a, double *restrict sign, double *restrict ratio,
                        const double *restrict radius, const double *restrict steep,
                        const double *restrict bend, const double *restrict e0, const double *restrict e1,
                        double *restrict limit, double *restrict evals, const double *restrict next,
                        const double *restrict px, const double *restrict py, const double *restrict pz,
                        const double *restrict f, const double *restrict own, double *restrict verdict,
                        double *restrict wanted)
{
    LANES for (size_t i = 0; i < n; i++) {
        double t = next[i], was = at[i], s = sign[i], before = a[i], x = px[i], y = py[i], z = pz[i],
               r2 = x * x + y * y, B = bend[i];
        double tx = fabs(t * dx[i]), ty = fabs(t * dy[i]), tz = fabs(t * dz[i]),
               off = steep[i] * (tx + fabs(x) + ty + fabs(y)) + tz + fabs(z);
        double err = own[i] + 1.01 * (sgt_fma(e1[i], r2, e0[i]) + SGT_U * off + 0x1p-1000 * (1 + steep[i]));
        double b = fabs(f[i]) - err, is = copysign(1, f[i]), length = t - was;
        double r = sqrt(r2) + 0x1p-51 * (tx + ty + fabs(x) + fabs(y));
        mask certain = MASK(b > 0), like = certain & MASK(is == s), unlike = certain & MASK(is == -s),
             first = MASK(s == 0), in = MASK(r <= radius[i]);
        /* h sqrt(B / 2) < sqrt a + sqrt b, divided by sqrt a: so no root is taken of what has an odd power
         * of a length, and would be rounded otherwise in another unit.  2^-1000 is for underflow. */
        double part = sqrt(larger(b, 0) / before),
               curved = length * sqrt(0.5 * B / before + 0x1p-1000) * (1 + 0x1p-20);
        mask moves = (first & certain & in) | (like & in & MASK(curved < 1 + part) & MASK(t > was));
        mask found = unlike & in & MASK(3 * (1 + 0x1p-20) * B * length * length < before + b);
        found &= MASK(length >= 0x1p-44 * larger(fabs(t), fabs(was))) &
                 MASK(0x1p-48 * (tx + ty) <= 0x1p-20 * radius[i]);
        double safe = 0.98 * sqrt(2 * before / B),
               longer = 1.7 * length; /* over a root that rounding hides, if one step can */
        double shorter = chosen(unlike | like, 0.5 * length,
                                chosen(in & MASK(4 * B * longer * longer < before), longer, 0.3 * length));
        shorter = chosen(like & in & MASK(safe < length), safe, shorter);
        double k = evals[i] + 1, outward = x * dx[i] + y * dy[i];
        mask over =
            (first & ~moves) | ~(first | MASK(length > 0)) | (moves & MASK(outward > 0) & MASK(r > limit[i]));
        over |= MASK(k >= MOST_STEPS) | MASK(!(b == b)); /* NaN: it leaves the domain */
        double v = chosen(moves, (double)MOVED, chosen(found, (double)FOUND, (double)GOES_ON));
        verdict[i] = chosen(over & ~found, (double)GIVEN_UP, v);
        h[i] = chosen(moves, 0, chosen(found, length, shorter));
        ratio[i] = chosen(moves & ~first, part, ratio[i]);
        ratio[i] = chosen(MASK(ratio[i] < 1), ratio[i], 1);
        at[i] = chosen(moves, t, was);
        a[i] = chosen(moves | found, b, before);
        sign[i] = chosen(first & moves, is, s);
        evals[i] = k;
        wanted[i] = radius_wanted(r, outward * larger(length, 0x1p-1000));
        /* the |F| before the root, in a row that is not needed any more */
        limit[i] = chosen(found, before, limit[i]);
    }
}

/* --------------------------------------------------------------------------- the lanes */

/* What is known within a radius: bounds on the gradient and on the norm of the second derivative of the
 * sag, infinite or NaN if unknown; and noise[0] + noise[1] r^2, which the departure adds to the rounding. */
static const ring *ring_about(sgt_surface s, double rung, rings *kept)
{
    if (!kept->any)
        for (int i = 0; i < RINGS; i++) kept->of[i].radius = 0;
    kept->any = true;
    /* The rungs of two octaves have a place each; so has every fourth rung of eight octaves. */
    ring *e = &kept->of[place_of(rung, FINER, RINGS) ^ place_of(rung, FINER + 6, 4)];
    if (e->radius == rung) return e;
    *e = (ring){rung, HUGE_VAL, HUGE_VAL, {(double)NAN, (double)NAN}};
    double rim = s.ops->own_->rim(s.self);
    if (!(rung < HUGE_VAL) || (rim > 0 && !(rung <= rim))) return e;
    sgt_extent extent;
    s.ops->own_->extent_within(s.self, rung, &extent);
    s.ops->own_->noise_within(s.self, rung * (1 + 0x1p-20), e->noise);
    e->steep = extent.steep, e->bend = extent.bend;
    return e;
}

/* Sets the lane's radius to the one wanted, and what is known within it.  edge: of the domain, where the
 * slope of the base has no bound. */
static void enclose_in(sgt_surface s, double edge, rings *kept, rows a, size_t i)
{
    double rung = a[WANTED][i];
    for (int k = 1; k <= EDGE_RUNGS && rung > edge * (1 - 0x1p-10); k++) {
        double t = a[T][i], level = edge * (1 - power_of_two(-k));
        if (radius_at(a[OX][i], a[OY][i], a[DX][i], a[DY][i], t) * (1 + 0x1p-20) < level) rung = level;
    }
    if (rung == a[RADIUS][i]) return;
    a[RADIUS][i] = rung;
    const ring *e = ring_about(s, rung, kept);
    a[STEEP][i] = e->steep, a[E0][i] = e->noise[0], a[E1][i] = e->noise[1];
    a[BEND][i] = e->bend * (a[DX][i] * a[DX][i] + a[DY][i] * a[DY][i]) * (1 + 0x1p-20);
}

/* Reports the stretch that holds the root, and the seed of Newton's steps. */
static void tell_root(rows a, size_t i, double scale, const vicinity *v)
{
    size_t k = (size_t)a[LANE][i];
    double lo = a[T][i], h = a[H][i], before = a[LIMIT][i], b = a[A][i];
    v->lo[k] = lo * scale, v->hi[k] = a[NEXT][i] * scale, v->asked[k] = 0;
    v->least[k] = ((before + b) / h - 1.125 * a[BEND][i] * h) * (1 - 0x1p-20);
    if (!(v->seed[k] > v->lo[k] && v->seed[k] < v->hi[k]))
        v->seed[k] = (lo + h * (before / (before + b))) * scale;
}

/* The t at which the ray is inside the edge by a part in 256, if there is certainly no root before it.
 * (At its edge a base has a slope without bound.)  NaN: that is not known.  *evals grows by what it took. */
static double inside_edge(sgt_surface s, const sgt_ray *ray, double from, double edge, const vicinity *v,
                          double *evals)
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
    sgt_interval slope, t = {0, sgt_sum_above(lo, -begin)},
                        g = builtin->enclose(s.self, ray, begin, t, &slope);
    *evals += 1;
    if (v->told)
        tell_cell(v->told, SGT_MARCH, begin, lo, g, slope);
    return g.lo > 0 || g.hi < 0 ? lo : (double)NAN; /* also an empty one */
}

/* The ray is past the last rung.  Does it certainly leave the surface, or end, without a root?  It is
 * asked in pieces if the enclosure knows too little of the whole. */
static bool leaves_by_edge(sgt_surface s, const sgt_ray *ray, double edge, rows a, size_t i, double scale,
                           const vicinity *v)
{
    if (!(a[RADIUS][i] > edge * (1 - 0x1p-10))) return false;
    sgt_rays one = rays_of(ray);
    double outer2 = edge * edge * (1 + 0x1p-40), steep = 0, lo, end, least, from = a[T][i] * scale;
    s.ops->own_->chords(1, one, &outer2, &steep, NULL, &lo, &end, &least);
    if (end > ray->tmax) end = ray->tmax;
    if (!(from < end && end < HUGE_VAL)) return false;
    double width = end - from;
    for (int k = 0; k < LEAVING && from < end; k++) {
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
    return !(from < end);
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
    a[SEED][k] = seed * inverse, a[END][k] = a[LIMIT][k] = HUGE_VAL;
    a[LANE][k] = (double)i, a[EVALS][k] = 0;
}

static sgt_ray row_ray(const sgt_rays *r, const vicinity *v, size_t i)
{
    return (sgt_ray){
        {r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]}, v->tmin[i], v->tmax[i]};
}

typedef enum march_mode { IN_RINGS, IN_CHORD, IN_BOX } march_mode;

static void march_rows(sgt_surface s, size_t left, sgt_rays r, march_mode mode, const sgt_shared *known,
                       double edge, rings *kept, const vicinity *v, rows a);

/* A bound on |F''| in row k, from what is known of the second derivative. */
static double bend_along(rows a, size_t k, double bend, bool by_axis, sgt_by_axis e)
{
    double l = fabs(a[DX][k]), m = fabs(a[DY][k]), all = bend * (l * l + m * m),
           apart = e.xx * (l * l) + 2 * e.xy * (l * m) + e.yy * (m * m);
    return (by_axis && apart < all ? apart : all) * (1 + 0x1p-20);
}

static const sgt_extent *box_about(sgt_surface s, double x, double y, vicinities *kept)
{
    if (!kept->any_boxes)
        for (int i = 0; i < BOXES; i++) kept->boxes[i].x = kept->boxes[i].y = 0;
    kept->any_boxes = true;
    box *b = &kept->boxes[4 * place_of(x, x < y ? COARSE : FINE, 4) + place_of(y, x < y ? FINE : COARSE, 4)];
    if (b->x != x || b->y != y) b->x = x, b->y = y, s.ops->own_->extent_in_box(s.self, x, y, &b->extent);
    return &b->extent;
}

/* A half-width that holds the coordinate from t to end. */
static double half_width(double o, double d, double t, double end)
{
    double a = fabs(o + t * d), b = fabs(o + end * d), far = fabs(o) + (fabs(t) + fabs(end)) * fabs(d);
    return 1.02 * larger(a, b) + 0x1p-40 * far;
}

void sgt_march_box(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *bare, vicinities *kept,
                   const vicinity *v, double *const a[WINGS_ROWS])
{
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        if (v->asked[i] == 0) continue;
        sgt_ray ray = row_ray(&r, v, i);
        double from = ray.tmin, flat = -ray.o.z / ray.d.z, aim = larger(v->seed[i], flat),
               end = aim + 0.25 * (aim - from);
        if (!(fabs(from) < HUGE_VAL && flat > from && end < ray.tmax && end < HUGE_VAL)) continue;
        double x = half_width(ray.o.x, ray.d.x, from, end), y = half_width(ray.o.y, ray.d.y, from, end);
        /* Few boxes: along the rays an eighth of a power of two, across them a power of two, not much
         * less. */
        double wide = larger(x, y);
        x = rung_above(larger(x, 0x1p-10 * wide), x < y ? COARSE : FINE);
        y = rung_above(larger(y, 0x1p-10 * wide), y < wide ? COARSE : FINE);
        const sgt_extent *e = x < HUGE_VAL && y < HUGE_VAL ? box_about(s, x, y, kept) : NULL;
        if (!e || !(e->bend < HUGE_VAL)) continue;
        size_t k = left;
        lay_row(a, k, &ray, i, from, flat);
        double least =
            fabs(a[DZ][k]) * (1 - 0x1p-40) - (e->axis.x * fabs(a[DX][k]) + e->axis.y * fabs(a[DY][k]));
        if (v->seed[i] > from && v->seed[i] < end && least > 0x1p-4 * fabs(a[DZ][k])) {
            v->lo[i] = from, v->hi[i] = end, v->least[i] = least, v->asked[i] = -1;
            continue;
        }
        left++;
        a[END][k] = end * inverse_of_scale(ray.d);
        a[BEND][k] = bend_along(a, k, e->bend, true, e->axis);
        a[RADIUS][k] = DBL_MAX, a[STEEP][k] = e->steep, a[E0][k] = a[E1][k] = 0;
    }
    march_rows(s, left, r, IN_BOX, bare, HUGE_VAL, NULL, v, a);
}

void sgt_march_chord(sgt_surface s, size_t n, sgt_rays r, const sgt_shared *whole, const vicinity *v,
                     double *const a[WINGS_ROWS])
{
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
        a[BEND][k] = bend_along(a, k, whole->bend, whole->by_axis, whole->axis);
        a[RADIUS][k] = radius, a[STEEP][k] = whole->steep, a[E0][k] = a[E1][k] = 0;
    }
    march_rows(s, left, r, IN_CHORD, whole, HUGE_VAL, NULL, v, a);
}

void sgt_march_wings(sgt_surface s, size_t n, sgt_rays r, const double *from, bool behind,
                      const sgt_shared *bare, rings *kept, const vicinity *v, double *const a[WINGS_ROWS])
{
    double edge = sqrt(bare->radius2);
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        double t = from[i]; /* perhaps one of the rows */
        if (!(v->asked[i] > 0) || !(fabs(t) < HUGE_VAL)) continue;
        if (edge < HUGE_VAL && behind != (v->seed[i] < v->tmin[i])) continue;
        sgt_ray ray = row_ray(&r, v, i);
        t = inside_edge(s, &ray, t, edge, v, &v->evals[i]);
        if (!(t <= ray.tmax) || (v->told && v->told->stopped)) continue; /* nor NaN */
        size_t k = left++;
        lay_row(a, k, &ray, i, t, v->seed[i]);
        double x = ray.o.x + t * ray.d.x, y = ray.o.y + t * ray.d.y;
        double outward = x * a[DX][k] + y * a[DY][k];
        double begins = radius_at(ray.o.x, ray.o.y, ray.d.x, ray.d.y, t);
        a[LIMIT][k] = 4 * larger(begins, radius_at(ray.o.x, ray.o.y, ray.d.x, ray.d.y, v->seed[i]));
        if (edge < HUGE_VAL) a[LIMIT][k] = HUGE_VAL;
        a[WANTED][k] = radius_wanted(begins, outward * 0x1p-1000); /* no step yet; as wings_judge has it */
        enclose_in(s, edge, kept, a, k);
    }
    march_rows(s, left, r, IN_RINGS, bare, edge, kept, v, a);
}

/* Marches along the first rows.  known: what `roundings` is given.  edge, kept: in rings only. */
static void march_rows(sgt_surface s, size_t left, sgt_rays r, march_mode mode, const sgt_shared *known,
                       double edge, rings *kept, const vicinity *v, rows a)
{
    const struct sgt_builtin_ops *builtin = s.ops->own_;
    while (left > 0) {
        double grad[3], *g = v->told ? grad : NULL;
        wings_step(left, a[OX], a[OY], a[OZ], a[DX], a[DY], a[DZ], a[T], a[H], a[A], a[SIGN], a[RATIO],
                   a[RADIUS], a[BEND], a[SEED], a[END], a[NEXT], a[PX], a[PY], a[PZ]);
        sgt_points at = {{a[PX], a[PY], a[PZ]}};
        s.ops->values(s.self, left, at, (sgt_values){a[F], {g, g ? g + 1 : NULL, g ? g + 2 : NULL}});
        if (mode == IN_BOX)
            for (size_t i = 0; i < left; i++)
                a[OWN][i] = s.ops->rounding(s.self, (sgt_vec3){a[PX][i], a[PY][i], a[PZ][i]});
        else if (!builtin->roundings(s.self, known, left, at, a[F], a[OWN]))
            return;
        if (v->told) {
            double scale = scale_of((sgt_vec3){r.d[0][0], r.d[1][0], r.d[2][0]});
            double slope = grad[0] * r.d[0][0] + grad[1] * r.d[1][0] + grad[2] * r.d[2][0],
                   next = a[NEXT][0] * scale;
            tell(v->told, SGT_MARCH, next, a[F][0], slope, a[T][0] * scale, next);
        }
        wings_judge(left, a[DX], a[DY], a[DZ], a[T], a[H], a[A], a[SIGN], a[RATIO], a[RADIUS], a[STEEP],
                    a[BEND], a[E0], a[E1], a[LIMIT], a[EVALS], a[NEXT], a[PX], a[PY], a[PZ], a[F], a[OWN],
                    a[VERDICT], a[WANTED]);
        for (size_t i = left; i-- > 0;) {
            size_t k = (size_t)a[LANE][i];
            v->evals[k] += 1;
            double scale = scale_of((sgt_vec3){r.d[0][k], r.d[1][k], r.d[2][k]});
            bool spent = v->evals[k] >= 0.5 * v->budget || (v->told && v->told->stopped);
            if (a[VERDICT][i] == MOVED && !spent) {
                sgt_ray ray = row_ray(&r, v, k);
                double t = a[T][i] * scale;
                if (mode == IN_RINGS) enclose_in(s, edge, kept, a, i);
                if (mode == IN_BOX) {
                    if (!(a[T][i] < a[END][i] * (1 - 0x1p-40))) wings_leave(a, i, --left);
                } else if (t > ray.tmax || (mode == IN_RINGS ? leaves_by_edge(s, &ray, edge, a, i, scale, v)
                                                             : t > v->hi[k])) {
                    is_miss(v, k);
                    wings_leave(a, i, --left);
                }
            } else if (a[VERDICT][i] != GOES_ON || spent) {
                if (a[VERDICT][i] == FOUND && !spent) tell_root(a, i, scale, v);
                wings_leave(a, i, --left);
            }
        }
    }
}
