// SPDX-License-Identifier: MIT
/* nearest.c - how near a line that misses a surface comes to it, found by asking the library.
 *
 * THE SHADOW.  Seen along the line, the surface is a shadow in the plane across.  The line is one point of
 * that plane, outside the shadow.  A point of the surface is as far from the line as its shadow is from that
 * point.  So the nearest approach is the shortest move of the line, parallel to itself, that makes it meet
 * the surface.  The place t on the line is that on the moved one, since the move is across.  F is not asked
 * beside the surface: on a sag whose edge the line passes it is NaN there.
 *
 * THE SEARCH.  A first guess is the move that takes the line to the vertex of a sag, or a little farther if
 * it only touches there.  A body lies about the origin, perhaps with a hole there; it ends where its span
 * says, on a line through the origin.  Then DIRECTIONS all around are tried in STEPS from the line to the
 * best move so far.  Between the last step that misses and the first that meets, the edge is found by
 * bisection.  Last, the best direction is turned, by less and less.  Near the best one the move grows with
 * the square of the angle, so LEAST_TURN is enough.
 *
 * WHAT IT CANNOT SEE: a part of the shadow that lies between directions or steps.  A plane that is parallel
 * to the line has a line for a shadow, which no step would hit; its distance is worked out. */
#include <sagitta/why.h>

#include "bare.h"
#include "../base/vec3.h"

enum { DIRECTIONS = 48, STEPS = 48, HALVINGS = 50 };
static const double LEAST_TURN = 1e-7, CIRCLE = 6.283185307179586;

typedef struct shadow {
    sgt_surface surface;
    sgt_ray line;
    sgt_vec3 u, v;     /* across the line, of unit length and at right angles; u points at the vertex */
} shadow;

/* Does the line meet the surface if it is moved by `by`?  angle: from u. */
static bool meets(const shadow *q, double angle, double by, sgt_hit *hit)
{
    sgt_ray moved = q->line;
    moved.o = along3(along3(moved.o, by * cos(angle), q->u), by * sin(angle), q->v);
    *hit = sgt_intersect(q->surface, moved, NULL);
    return hit->status > 0;
}

/* Takes the shortest move at this angle, if it is shorter than that of *best.  Returns whether it is. */
static bool nearer(const shadow *q, double angle, double reach, sgt_nearest *best)
{
    double lo = 0, hi = 0;
    sgt_hit hit, found;
    for (int i = 1; i <= STEPS && hi == 0; i++) {
        double by = reach * i / STEPS;
        if (meets(q, angle, by, &found)) hi = by;
        else lo = by;
    }
    if (hi == 0) return false;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = lo + (hi - lo) / 2;
        if (meets(q, angle, middle, &hit)) hi = middle, found = hit;
        else lo = middle;
    }
    if (best->known && !(hi < best->distance * (1 - 0x1p-44))) return false; /* or only by rounding */
    *best = (sgt_nearest){.known = true, .distance = hi, .t = found.t, .p = found.p};
    return true;
}

/* The frame across the line; *reach: how far it may have to be moved. */
static shadow shadow_of(sgt_surface s, const sgt_ray *ray, double *reach)
{
    shadow q = {.surface = s, .line = {.o = ray->o, .d = ray->d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL}};
    const bool sag = sgt_is_sag(s);
    const sgt_vec3 no = {0, 0, 0}, d = along3(no, 1 / length3(ray->d), ray->d);
    const sgt_vec3 vertex = {0, 0, sag ? -s.ops->value(s.self, no, NULL) : 0};
    const sgt_vec3 all = minus3(vertex, ray->o);
    const sgt_vec3 to = along3(all, -dot3(all, d), d);
    const sgt_vec3 aside = fabs(d.x) < 0.5 ? (sgt_vec3){1, 0, 0} : (sgt_vec3){0, 1, 0};
    const sgt_vec3 any = along3(aside, -dot3(aside, d), d);
    *reach = length3(to);
    q.u = *reach > 0 ? along3(no, 1 / *reach, to) : along3(no, 1 / length3(any), any);
    q.v = cross3(d, q.u);
    if (sag || !s.ops->span) return q;
    sgt_span span = s.ops->span(s.self, &(sgt_ray){.d = q.u, .tmin = -HUGE_VAL, .tmax = HUGE_VAL});
    if (span.lo <= span.hi && isfinite(span.hi - span.lo)) *reach += fmax(-span.lo, span.hi);
    return q;
}

static sgt_nearest nearest_by_search(sgt_surface s, const sgt_ray *ray)
{
    sgt_nearest best = {.known = false};
    double reach, angle = 0, turn = CIRCLE / DIRECTIONS;
    const shadow q = shadow_of(s, ray, &reach);
    for (int k = 0; k < 2 && !best.known; k++, reach *= 1 + 0x1p-10)
        for (int i = 0; i < DIRECTIONS; i++)
            if (nearer(&q, i * turn, best.known ? best.distance : reach, &best)) angle = i * turn;
    while (best.known && turn > LEAST_TURN) {
        if (nearer(&q, angle + turn, best.distance, &best)) angle += turn;
        else if (nearer(&q, angle - turn, best.distance, &best)) angle -= turn;
        else turn /= 2;
    }
    return best;
}

/* Of a parallel to it.  A rim counts from where the line is nearest to the axis. */
static sgt_nearest nearest_to_plane(double rim, const sgt_ray *ray)
{
    const sgt_vec3 o = ray->o, d = ray->d;
    sgt_nearest n = {.known = true, .distance = fabs(o.z), .p = {o.x, o.y, 0}};
    if (!(rim > 0)) return n;
    n.t = -(o.x * d.x + o.y * d.y) / dot3(d, d);
    n.p = (sgt_vec3){o.x + n.t * d.x, o.y + n.t * d.y, 0};
    const double r = length3(n.p);
    if (r > rim) n.p = along3((sgt_vec3){0, 0, 0}, rim / r, n.p), n.distance = hypot(o.z, r - rim);
    return n;
}

sgt_nearest sgt_nearest_of(sgt_surface s, const sgt_ray *ray)
{
    rimless b = sgt_bare_of(s);
    const sgt_nearest n = b.c == 0 && !b.terms && ray->d.z == 0 ? nearest_to_plane(b.rim, ray)
                                                                : nearest_by_search(s, ray);
    sgt_bare_end(&b);
    return n;
}
