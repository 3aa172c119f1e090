// SPDX-License-Identifier: MIT
/* aperture.c - which points the items of an aperture clip, and by how much.
 *
 * An item clips what is beyond its edge: outside of it, or inside if it is obscuring.  Its edge is soft: a
 * point that is beyond by no more than a length `soft` passes.  So every test below moves the point by
 * `soft` toward where it passes, and clips it if it is beyond even then.  With u = 2^-53:
 *
 *     CIRCLE, ANNULUS.  d = p - centre.  Beyond is |d| > R + soft, or |d| < R - soft, with
 *     soft = 256 u (R + |centre|), |.| being the sum of the absolute components.  At the edge d is off by u
 *     |d|, its square by 5 u of itself, and so |d| by 2.5 u R.  The doubles next to a point of the edge are
 *     off by u (R + |centre|) in each coordinate.  That is 5 u (R + |centre|) in all, a fiftieth of soft.
 *     Both sides are compared as squares, scaled by a power of two that takes the limit to [1, 2).  Then
 *     no square that matters underflows or overflows.
 *
 *     RECTANGLE, ELLIPSE, an ARM.  q = d, turned.  soft = 256 u (|d| + |centre|).  The cosine and the sine
 *     are off by 1.3 u, d by u of itself, the two products and their sum by 2 u: in all each coordinate of q
 *     is off by 5 u |d|, of an arm, which is turned twice, by 12 u |d|.  With the doubles next to the edge
 *     it is 14 u (|d| + |centre|) at most, an eighteenth of soft.  Of a box of half width soft about q, the
 *     corner is compared that is nearest to where the ray passes.  So it does not matter how thin an ellipse
 *     is.  The sum of squares is off by 5 u of 1, and soft changes it by 512 u at least, as soft >=
 *     256 u |q|.
 *
 *     POLYGON.  A line from q along x crosses the sides an odd number of times if q is inside.  Side a b
 *     has an end above q and one that is not: that is exact.  It is crossed right of q if x is left of
 *     both ends, and not if it is right of both: exact too.  Else the sign of
 *
 *         (b.x - a.x) (q.y - a.y) - (q.x - a.x) (b.y - a.y)
 *
 *     decides, which is off by 4 u of each product.  If it is wrong, q is within 8 u |b.x - a.x| of the
 *     side, along x; if a product has underflowed, within 2^-536 along x or along y.  So the number of
 *     crossings is right for every q that is farther than that from all sides.  If it says that q is
 *     clipped, q passes all the same if it is within soft of a side, with
 *     soft = 256 u (|d| + |centre| + |b - a|) + 2^-500.  The distance is off by 8 u of |q - a| + |b - a|.
 *     A wrong number of crossings that says that q passes is no fault: q is on the edge.
 *
 * THE ARMS of a spider begin at its centre, and that end is not soft.  Else between two opposite arms, and at
 * the centre itself, there would be a gap.  Opposite arms have exactly opposite directions if there are two.
 * If there are more, others cover what a rounding leaves between them.
 *
 * IN A TILE circles and annuli are a vector loop, and so are the crossings of a polygon, side by side, by
 * the same comparisons.  Points that these would clip, and all of the other shapes, are asked one by one
 * for rays that are still good.  What does not depend on the point (the turn, the directions of the arms) is
 * worked out once.
 *
 * Test: tests/unit/test_aperture.c, tests/batch/test_trace_batch.c. */
#include "aperture.h"

#include "trace.h"
#include "turn.h"
#include <limits.h>

static const double EDGE = 0x1p-45;        /* 256 u: see above */
static const double EDGE_LEAST = 0x1p-500; /* of a polygon */
static const double FARTHEST = 0x1p500;    /* a centre, a vertex: their squares and products are finite */
enum { MOST_ARMS = 64 };

/* --------------------------------------------------------------------- sound */

static bool is_near_enough(sgt_vec2 a) { return fabs(a.x) <= FARTHEST && fabs(a.y) <= FARTHEST; }

static bool is_shape_sound(const sgt_aperture_item *i)
{
    switch (i->shape) {
    case SGT_CIRCLE: return i->radius >= 0;
    case SGT_ANNULUS: return i->inner >= 0 && i->inner <= i->radius;
    case SGT_RECTANGLE:
    case SGT_ELLIPSE: return i->half.x >= 0 && i->half.y >= 0;
    case SGT_SPIDER: return i->arms >= 1 && i->arms <= MOST_ARMS && i->width >= 0 && i->length >= 0;
    case SGT_POLYGON:
        if (i->count < 3 || !i->vertices) return false;
        for (size_t k = 0; k < i->count; k++)
            if (!is_near_enough(i->vertices[k])) return false;
        return true;
    }
    return false;
}

bool sgt_aperture_sound(const sgt_aperture *a)
{
    if (!ROOM_IS_ZERO(a) || a->count > INT_MAX || (a->count && !a->items)) return false;
    for (size_t k = 0; k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        if (!ROOM_IS_ZERO(i) || !(fabs(i->degrees) <= DBL_MAX)) return false;
        if (!is_near_enough(i->centre) || !is_shape_sound(i)) return false;
    }
    return true;
}

/* ------------------------------------------------------- circles and annuli */

/* A limit of |d|: |scale d|^2 is compared with limit2. */
typedef struct ring_limit { double scale, limit2; } ring_limit;

/* Clipped is a point that is beyond `outer` or within `inner`; if `both`, one that is both. */
typedef struct circles { double x, y; ring_limit outer, inner; bool both; } circles;

static const ring_limit NEVER_BEYOND = {1, HUGE_VAL}, NEVER_WITHIN = {1, -1}, ALWAYS_BEYOND = {1, -1};

/* A limit below 2^-1000 is at least 2^-74 when scaled by 2^1000, or 0. */
static ring_limit ring_limit_of(double r)
{
    int e = r > 0 ? r <= DBL_MAX ? binary_exponent(r) : 1000 : -1000;
    double scale = power_of_two(e > 1000 ? -1000 : e < -1000 ? 1000 : -e), limit = scale * r;
    return (ring_limit){scale, limit * limit};
}

static double ring_soft(const sgt_aperture_item *i, double r)
{
    return EDGE * r + (EDGE * fabs(i->centre.x) + EDGE * fabs(i->centre.y));
}

static ring_limit beyond_ring(const sgt_aperture_item *i, double r)
{
    return r < HUGE_VAL ? ring_limit_of(r + ring_soft(i, r)) : NEVER_BEYOND;
}

static ring_limit within_ring(const sgt_aperture_item *i, double r)
{
    double limit = r < HUGE_VAL ? r - ring_soft(i, r) : r;
    return limit > 0 ? ring_limit_of(limit) : NEVER_WITHIN;
}

/* A hole of radius 0 has no edge. */
static circles circles_of(const sgt_aperture_item *i)
{
    circles r = {i->centre.x, i->centre.y, NEVER_BEYOND, NEVER_WITHIN, false};
    bool hole = i->shape == SGT_ANNULUS && i->inner > 0;
    if (i->obscuring) {
        r.inner = within_ring(i, i->radius);
        r.both = i->shape == SGT_ANNULUS;
        if (r.both) r.outer = hole ? beyond_ring(i, i->inner) : ALWAYS_BEYOND;
    } else {
        r.outer = beyond_ring(i, i->radius);
        if (hole) r.inner = within_ring(i, i->inner);
    }
    return r;
}

/* 1 or 0; 0 for NaN. */
SGT_INLINE double ring_clips(bool both, circles r, double x, double y)
{
    double dx = x - r.x, dy = y - r.y;
    double ox = dx * r.outer.scale, oy = dy * r.outer.scale, ix = dx * r.inner.scale, iy = dy * r.inner.scale;
    double beyond = ox * ox + oy * oy > r.outer.limit2 ? 1 : 0;
    double within = ix * ix + iy * iy < r.inner.limit2 ? 1 : 0;
    return both ? beyond * within : beyond + within;
}

/* Selects only, no branches. */
SGT_INLINE void ring_by(bool both, size_t n, circles r, const double *restrict x, const double *restrict y,
                        double verdict, double *restrict good)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double clipped = good[i] > 0 ? verdict : good[i];
        good[i] = ring_clips(both, r, x[i], y[i]) > 0 ? clipped : good[i];
    }
}

SGT_KERNEL
static void ring_all(size_t n, const circles *r, const double *x, const double *y, double verdict,
                     double *good)
{
    if (r->both) ring_by(true, n, *r, x, y, verdict, good);
    else ring_by(false, n, *r, x, y, verdict, good);
}

/* ---------------------------------------------------------------- the others */

/* An item, with what does not depend on the point; arm: of a spider. */
typedef struct figure {
    const sgt_aperture_item *item;
    double soft;
    unit_turn turned, arm[MOST_ARMS];
} figure;

static bool is_ring(const sgt_aperture_item *i) { return i->shape == SGT_CIRCLE || i->shape == SGT_ANNULUS; }

static void figure_of(const sgt_aperture_item *i, figure *f)
{
    f->item = i;
    f->soft = EDGE * fabs(i->centre.x) + EDGE * fabs(i->centre.y);
    f->turned = turn_of(i->degrees);
    for (int k = 0; i->shape == SGT_SPIDER && k < i->arms; k++) f->arm[k] = turn_of(360.0 * k / i->arms);
}

SGT_INLINE sgt_vec2 turned_back(unit_turn by, sgt_vec2 d)
{
    return (sgt_vec2){by.c * d.x + by.s * d.y, by.c * d.y - by.s * d.x};
}

/* The point seen from the item, and its softness. */
typedef struct seen { sgt_vec2 q; double soft; } seen;

static seen seen_from(const figure *f, double x, double y)
{
    sgt_vec2 d = {x - f->item->centre.x, y - f->item->centre.y};
    return (seen){turned_back(f->turned, d), EDGE * fabs(d.x) + EDGE * fabs(d.y) + f->soft};
}

static bool rectangle_clips(const sgt_aperture_item *i, seen p)
{
    double x = fabs(p.q.x), y = fabs(p.q.y);
    if (i->obscuring) return x + p.soft < i->half.x && y + p.soft < i->half.y;
    return x - p.soft > i->half.x || y - p.soft > i->half.y;
}

/* Within the box about the ellipse the quotients are at most 1.  If a half axis is 0 and the point on the
 * other one, the level is NaN: it passes, as it should. */
static bool ellipse_clips(const sgt_aperture_item *i, seen p)
{
    double soft = i->obscuring ? p.soft : -p.soft;
    double x = larger(fabs(p.q.x) + soft, 0), y = larger(fabs(p.q.y) + soft, 0), a = i->half.x, b = i->half.y;
    bool outside = x > a || y > b, within = x < a && y < b;
    double u = a < HUGE_VAL ? x / a : 0, v = b < HUGE_VAL ? y / b : 0, level = u * u + v * v;
    return i->obscuring ? within && level < 1 : outside || level > 1;
}

/* Does the line from q along x, to the right, cross the side from a to b? */
static bool side_is_crossed(sgt_vec2 a, sgt_vec2 b, sgt_vec2 q)
{
    if ((a.y > q.y) == (b.y > q.y)) return false;
    if (q.x < a.x && q.x < b.x) return true;
    if (q.x >= a.x && q.x >= b.x) return false;
    double side = (b.x - a.x) * (q.y - a.y) - (q.x - a.x) * (b.y - a.y);
    return b.y > a.y ? side > 0 : side < 0;
}

static bool is_in_polygon(const sgt_aperture_item *i, sgt_vec2 q)
{
    bool inside = false;
    for (size_t k = 0, before = i->count - 1; k < i->count; before = k++)
        inside ^= side_is_crossed(i->vertices[before], i->vertices[k], q);
    return inside;
}

/* From q to the side from a to b.  Of a point beyond 2^502 only that it is far is meant. */
static double distance_to_side(sgt_vec2 a, sgt_vec2 b, sgt_vec2 q)
{
    sgt_vec2 s = {b.x - a.x, b.y - a.y}, d = {q.x - a.x, q.y - a.y};
    if (!(fabs(q.x) < 4 * FARTHEST && fabs(q.y) < 4 * FARTHEST)) return larger(fabs(q.x), fabs(q.y));
    double t = (d.x * s.x + d.y * s.y) / (s.x * s.x + s.y * s.y);
    t = t > 0 ? t < 1 ? t : 1 : 0; /* NaN: a side of no length */
    d.x -= t * s.x, d.y -= t * s.y;
    return sqrt(d.x * d.x + d.y * d.y);
}

static bool polygon_clips(const sgt_aperture_item *i, seen p)
{
    if (is_in_polygon(i, p.q) != i->obscuring) return false;
    for (size_t k = 0, before = i->count - 1; k < i->count; before = k++) {
        sgt_vec2 a = i->vertices[before], b = i->vertices[k];
        double soft = EDGE * (fabs(b.x - a.x) + fabs(b.y - a.y)) + p.soft + EDGE_LEAST;
        if (distance_to_side(a, b, p.q) <= soft) return false;
    }
    return true;
}

/* side_is_crossed of many points, without a branch: the sign of inside[i] changes if it is crossed. */
SGT_KERNEL
static void cross_all(size_t n, sgt_vec2 a, sgt_vec2 b, const double *x, const double *y, double *inside)
{
    double left = smaller(a.x, b.x), right = larger(a.x, b.x), rises = b.y > a.y ? 1 : -1;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double side = (b.x - a.x) * (y[i] - a.y) - (x[i] - a.x) * (b.y - a.y);
        double begins = a.y > y[i] ? 1 : -1, ends = b.y > y[i] ? 1 : -1, crossed = rises * side;
        crossed = x[i] >= right ? -1 : crossed;
        crossed = x[i] < left ? 1 : crossed;
        crossed = begins == ends ? -1 : crossed;
        inside[i] = crossed > 0 ? -inside[i] : inside[i];
    }
}

SGT_KERNEL
static void see_all(size_t n, sgt_vec2 centre, unit_turn by, const double *x, const double *y, double *qx,
                    double *qy)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec2 q = turned_back(by, (sgt_vec2){x[i] - centre.x, y[i] - centre.y});
        qx[i] = q.x, qy[i] = q.y;
    }
}

/* inside[i] is set below 0 if the point is in the polygon. */
static void in_polygon_all(const figure *f, size_t n, const double *x, const double *y, double *inside)
{
    double qx[SGT_TILE], qy[SGT_TILE];
    see_all(n, f->item->centre, f->turned, x, y, qx, qy);
    for (size_t j = 0; j < n; j++) inside[j] = 1;
    for (size_t k = 0, before = f->item->count - 1; k < f->item->count; before = k++)
        cross_all(n, f->item->vertices[before], f->item->vertices[k], qx, qy, inside);
}

static double arm_length(const sgt_aperture_item *i) { return i->length == 0 ? HUGE_VAL : i->length; }

static bool spider_clips(const figure *f, seen p)
{
    const sgt_aperture_item *i = f->item;
    double half = 0.5 * i->width, length = arm_length(i);
    for (int k = 0; k < i->arms; k++) {
        sgt_vec2 q = turned_back(f->arm[k], p.q);
        double y = fabs(q.y);
        if (i->obscuring ? q.x >= 0 && q.x + p.soft < length && y + p.soft < half
                         : q.x + p.soft >= 0 && q.x - p.soft <= length && y - p.soft <= half)
            return i->obscuring;
    }
    return !i->obscuring;
}

/* false for NaN. */
static bool figure_clips(const figure *f, double x, double y)
{
    seen p = seen_from(f, x, y);
    if (isnan(p.q.x) || isnan(p.q.y)) return false;
    switch (f->item->shape) {
    case SGT_RECTANGLE: return rectangle_clips(f->item, p);
    case SGT_ELLIPSE: return ellipse_clips(f->item, p);
    case SGT_POLYGON: return polygon_clips(f->item, p);
    case SGT_SPIDER: return spider_clips(f, p);
    default: return false;
    }
}

/* ------------------------------------------------------------------- a point */

int sgt_aperture_clips(const sgt_aperture *a, double x, double y)
{
    for (size_t k = 0; k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        if (is_ring(i)) {
            circles r = circles_of(i);
            if (ring_clips(r.both, r, x, y) > 0) return (int)k;
        } else {
            figure f;
            figure_of(i, &f);
            if (figure_clips(&f, x, y)) return (int)k;
        }
    }
    return SGT_BY_NONE;
}

SGT_NOINLINE size_t sgt_aperture_clips_tile(const sgt_aperture *a, size_t n, const double x[],
                                            const double y[], double verdict, double good[])
{
    for (size_t k = 0; k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        if (is_ring(i)) {
            circles r = circles_of(i);
            ring_all(n, &r, x, y, verdict, good);
        } else {
            figure f;
            figure_of(i, &f);
            double inside[SGT_TILE];
            bool polygon = i->shape == SGT_POLYGON && n <= SGT_TILE;
            if (polygon) in_polygon_all(&f, n, x, y, inside);
            for (size_t j = 0; j < n; j++) {
                if (polygon && (inside[j] < 0) != i->obscuring) continue;
                if (good[j] > 0 && figure_clips(&f, x[j], y[j])) good[j] = verdict;
            }
        }
    }
    size_t left = 0;
    for (size_t j = 0; j < n; j++) left += good[j] > 0 ? 1 : 0;
    return left;
}

/* --------------------------------------------------------------- by how much */

static double distance_of(sgt_vec2 d)
{
    double x = fabs(d.x), y = fabs(d.y), far = larger(x, y), less = far > 0 ? smaller(x, y) / far : 0;
    return far * sqrt(1 + less * less);
}

static double beyond_box(sgt_vec2 q, sgt_vec2 half) { return larger(fabs(q.x) - half.x, fabs(q.y) - half.y); }

/* With g^2 = (x / a)^2 + (y / b)^2 the edge is g = 1.  To first order it is (g - 1) / |grad g| away, and
 * |grad g| = |(x / a^2, y / b^2)| / g. */
static double beyond_ellipse(sgt_vec2 q, sgt_vec2 half)
{
    double least = smaller(half.x, half.y);
    sgt_vec2 at = {q.x / half.x, q.y / half.y},
             slope = {at.x * (least / half.x), at.y * (least / half.y)};
    double g = distance_of(at), away = least * (g - 1) * (g / distance_of(slope));
    return fabs(away) <= DBL_MAX && away != 0 ? away : beyond_box(q, half);
}

static double beyond_polygon(const sgt_aperture_item *i, sgt_vec2 q)
{
    double nearest = HUGE_VAL;
    for (size_t k = 0, before = i->count - 1; k < i->count; before = k++)
        nearest = smaller(distance_to_side(i->vertices[before], i->vertices[k], q), nearest);
    return is_in_polygon(i, q) ? -nearest : nearest;
}

static double beyond_spider(const figure *f, sgt_vec2 from)
{
    const sgt_aperture_item *i = f->item;
    double half = 0.5 * i->width, length = arm_length(i), nearest = HUGE_VAL;
    for (int k = 0; k < i->arms; k++) {
        sgt_vec2 q = turned_back(f->arm[k], from);
        double beyond = larger(fabs(q.y) - half, q.x - length);
        nearest = smaller(q.x >= 0 ? beyond : larger(beyond, -q.x), nearest);
    }
    return nearest;
}

/* The item clips the point. */
static sgt_clipping clipped_by_item(const sgt_aperture_item *i, int which, sgt_vec3 p)
{
    if (is_ring(i)) {
        double r = distance_of((sgt_vec2){p.x - i->centre.x, p.y - i->centre.y}), limit = i->radius;
        if (i->shape == SGT_ANNULUS && i->inner > 0) {
            bool inner = i->obscuring ? r - i->inner < i->radius - r : r < i->inner;
            limit = inner ? i->inner : i->radius;
        }
        return (sgt_clipping){.by = which, .size = r, .limit = limit};
    }
    figure f;
    figure_of(i, &f);
    sgt_vec2 q = seen_from(&f, p.x, p.y).q;
    double beyond = i->shape == SGT_RECTANGLE ? beyond_box(q, i->half)
                  : i->shape == SGT_ELLIPSE   ? beyond_ellipse(q, i->half)
                  : i->shape == SGT_POLYGON   ? beyond_polygon(i, q)
                                              : beyond_spider(&f, q);
    return (sgt_clipping){.by = which, .size = i->obscuring ? -beyond : beyond};
}

sgt_clipping sgt_clipped_by(const sgt_element *e, sgt_vec3 p)
{
    if (!(e->semi_diameter >= 0) || !is_aperture_sound(e))
        return (sgt_clipping){.by = SGT_BY_UNSOUND, .size = (double)NAN, .limit = (double)NAN};
    if (!is_inside(p, aperture2_of(e->semi_diameter)))
        return (sgt_clipping){.by = SGT_BY_SEMI_DIAMETER, .size = distance_of((sgt_vec2){p.x, p.y}),
                              .limit = e->semi_diameter};
    int which = e->aperture ? sgt_aperture_clips(e->aperture, p.x, p.y) : SGT_BY_NONE;
    return which < 0 ? (sgt_clipping){.by = SGT_BY_NONE}
                     : clipped_by_item(&e->aperture->items[which], which, p);
}

/* ---------------------------------------------------------------- a box of points */

/* How far p is beyond the edge of the item, below 0 inside: a function that changes by no more than p is
 * moved, and is above 0 just outside. */
static double level_of(const sgt_aperture_item *i, bool hole, sgt_vec2 at)
{
    figure f;
    if (is_ring(i)) {
        const sgt_vec2 from = {at.x - i->centre.x, at.y - i->centre.y};
        return distance_of(from) - (hole ? i->inner : i->radius);
    }
    figure_of(i, &f);
    const sgt_vec2 q = seen_from(&f, at.x, at.y).q;
    switch (i->shape) {
    case SGT_RECTANGLE: return beyond_box(q, i->half);
    case SGT_POLYGON: return beyond_polygon(i, q);
    case SGT_ELLIPSE: {
        const double least = smaller(i->half.x, i->half.y), x = q.x / i->half.x, y = q.y / i->half.y;
        return least * (sqrt(x * x + y * y) - 1);
    }
    default: {
        const double half = 0.5 * i->width, length = arm_length(i);
        double nearest = HUGE_VAL;
        for (int k = 0; k < i->arms; k++) {
            const sgt_vec2 a = turned_back(f.arm[k], q);
            nearest = smaller(larger(larger(fabs(a.y) - half, a.x - length), -a.x), nearest);
        }
        return nearest;
    }
    }
}

/* Each level changes no faster than the point moves.  So what is true of the middle is true of the box if the
 * level there is more than half the diagonal; `soft` is a margin far more than any softness. */
int sgt_aperture_over(const sgt_aperture *a, sgt_interval x, sgt_interval y, double *away)
{
    const sgt_vec2 at = {0.5 * (x.lo + x.hi), 0.5 * (y.lo + y.hi)},
                   half = {larger(x.hi - at.x, at.x - x.lo), larger(y.hi - at.y, at.y - y.lo)};
    int all = 1;
    *away = HUGE_VAL;
    for (size_t k = 0; k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        const bool hole = i->shape == SGT_ANNULUS && i->inner > 0;
        double level = level_of(i, false, at);
        if (hole) level = larger(level, -level_of(i, true, at)); /* within the ring: below 0 */
        const double radius = is_ring(i) && i->radius < HUGE_VAL ? i->radius : 0; /* others need not set it */
        const double size = fabs(at.x) + fabs(at.y) + fabs(i->centre.x) + fabs(i->centre.y) + radius;
        const double soft = 0x1p-38 * size + 0x1p-490;
        const double reach = distance_of(half) * (1 + 0x1p-40) + soft;
        const double beyond = i->obscuring ? -level : level; /* above 0: clipped */
        if (beyond > reach) return -1;
        if (!(-beyond > reach)) all = 0;
        else *away = smaller(*away, -beyond - reach);
    }
    if (all == 0) *away = 0;
    return all;
}
