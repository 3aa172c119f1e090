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
 * to the line has a line for a shadow, which no step would hit; its distance is |z|. */
#include "nearest.h"

#include "frame.h"
#include "profile.h"
#include "undecided.h"

#include <math.h>

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
    moved.o = vector_along(vector_along(moved.o, q->u, by * cos(angle)), q->v, by * sin(angle));
    *hit = sgt_intersect(q->surface, moved, NULL);
    return hit->status > 0;
}

/* Takes the shortest move at this angle, if it is shorter than that of *best.  Returns whether it is. */
static bool nearer(const shadow *q, double angle, double reach, nearest *best)
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
    *best = (nearest){.known = true, .distance = hi, .t = found.t, .p = found.p};
    return true;
}

/* The frame across the line; *reach: how far it may have to be moved. */
static shadow shadow_of(sgt_surface s, const sgt_ray *ray, double *reach)
{
    shadow q = {.surface = s, .line = {.o = ray->o, .d = ray->d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL}};
    double length = vector_length(ray->d);
    const bool sag = profile_is_sag(s);
    const sgt_vec3 no = {0, 0, 0}, d = vector_along(no, ray->d, 1 / length);
    const sgt_vec3 vertex = {0, 0, sag ? -s.ops->value(s.self, no, NULL) : 0};
    const sgt_vec3 all = vector_minus(vertex, ray->o);
    const sgt_vec3 to = vector_along(all, d, -vector_dot(all, d));
    const sgt_vec3 aside = fabs(d.x) < 0.5 ? (sgt_vec3){1, 0, 0} : (sgt_vec3){0, 1, 0};
    const sgt_vec3 any = vector_along(aside, d, -vector_dot(aside, d));
    *reach = vector_length(to);
    q.u = *reach > 0 ? vector_along(no, to, 1 / *reach) : vector_along(no, any, 1 / vector_length(any));
    q.v = (sgt_vec3){d.y * q.u.z - d.z * q.u.y, d.z * q.u.x - d.x * q.u.z, d.x * q.u.y - d.y * q.u.x};
    if (sag || !s.ops->span) return q;
    sgt_span span = s.ops->span(s.self, &(sgt_ray){.d = q.u, .tmin = -HUGE_VAL, .tmax = HUGE_VAL});
    if (span.lo <= span.hi && isfinite(span.hi - span.lo)) *reach += fmax(-span.lo, span.hi);
    return q;
}

nearest nearest_approach(sgt_surface s, const sgt_ray *ray)
{
    nearest best = {.known = false};
    double reach;
    const bare_surface b = undecided_without_rim(s);
    if (b.c == 0 && !b.terms) /* a plane is missed only by a parallel to it */
        return (nearest){.known = true, .distance = fabs(ray->o.z), .p = {ray->o.x, ray->o.y, 0}};
    const shadow q = shadow_of(s, ray, &reach);
    double angle = 0, turn = CIRCLE / DIRECTIONS;
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
