// SPDX-License-Identifier: MIT
/* missed.c - why a ray misses a surface, and why a place on which another method has settled is no root.
 *
 * A MISS is certain; its reason is looked for from the outside in.  Without the ends of the ray: is there a
 * root on the line?  Without the rim?  Does the line come near enough to the axis for a sag to be there?  On
 * which side of the quadric, of which a conic is one sheet, does it pass?  Where no answer is clear beyond
 * rounding, nothing is said. */
#include <sagitta/why.h>

#include <float.h>

#include "bare.h"
#include "say.h"
#include "../base/vec3.h"

static written short_number(double x) { return sgt_written(x, 6); }

/* A level set lies inside a ball, and its span is the ray's chord of that ball.  A torus or an ellipsoid has
 * a span of the same kind. */
static void say_missed_set(saying *to, sgt_surface s, const sgt_ray *ray)
{
    if (!s.ops->span) return;
    const char *what = sgt_builtin_of(s)->family == SGT_FAMILY_LEVEL_SET ? "the ball that holds the set"
                                                                         : "the surface";
    sgt_span span = s.ops->span(s.self, ray);
    if (span.lo > span.hi) sgt_say(to, "it passes beside %s", what);
    else if (span.hi < ray->tmin || span.lo > sgt_end_of(ray))
        sgt_say(to, "it reaches %s only %soutside tmin ... tmax%s", what,
                span.hi < ray->tmin && ray->tmin == 0 ? "behind its start (" : "",
                span.hi < ray->tmin && ray->tmin == 0 ? ")" : "");
}

/* On the whole quadric A t^2 - 2 B t + C = 0.  Its sheet is where (1 + k) c z < 1. */
static void say_missed_quadric(saying *to, const rimless *b, sgt_vec3 o, sgt_vec3 d)
{
    const char other[] = "the other sheet of the quadric (of a sphere, the far half)";
    /* from no farther than a radius before the place nearest to the vertex: B*B and A*C of afar cancel */
    const double near = -dot3(o, d) / dot3(d, d), back = 1 / (fabs(b->c) * length3(d));
    if (fabs(near) > back) o = along3(o, near - copysign(back, near), d);
    double k1 = 1 + b->k, A = b->c * (d.x * d.x + d.y * d.y + k1 * d.z * d.z);
    double B = d.z - b->c * (o.x * d.x + o.y * d.y + k1 * o.z * d.z);
    double C = b->c * (o.x * o.x + o.y * o.y + k1 * o.z * o.z) - 2 * o.z;
    double slack = (B * B + fabs(A * C)) * 0x1p-20;
    if (B * B > A * C + slack) sgt_say(to, "it meets only %s", other);
    else if (B * B < A * C - slack) sgt_say(to, "it passes beside the whole quadric");
    else if (k1 * b->c * along3(o, B / A, d).z > 1) sgt_say(to, "it comes near, but only to %s", other);
    else
        sgt_say(to, "it only just misses: it nearly touches the surface.  A small shift of the ray can make "
                    "it a hit");
}

/* Of a line that meets neither the surface nor, without its rim, the rest of it. */
static void say_missed_all(saying *to, const rimless *b, sgt_surface s, const sgt_ray *ray)
{
    const double domain = b->k > -1 && b->c != 0 ? 1 / (fabs(b->c) * sqrt(1 + b->k)) : HUGE_VAL;
    const double nearest = axis_distance3(ray->o, ray->d);
    /* far more than rounding, also of a start far away: say it only if it is clear */
    const double margin = 1 + 0x1p-30 + 0x1p-48 * length3(ray->o) / fmin(domain, fmax(nearest, DBL_MIN));
    const written at = short_number(domain);
    if (nearest > domain * margin) {
        sgt_say(to, "it never comes within r = %s of the axis, and the surface ends there", at.text);
    } else if (nearest * margin > domain && b->rim > 0 && nearest > b->rim * margin) {
        sgt_say(to, "it comes no nearer to the axis than r = %s, outside semi_diameter", at.text);
    } else if (nearest * margin > domain) {
        sgt_say(to, "it passes the very edge of the surface.  It comes no nearer to the axis than r = %s,\n"
                    "and there the surface ends, to within rounding.  A nearer ray can meet it", at.text);
    } else if (b->c == 0 && !b->terms && ray->d.z == 0) {
        sgt_say(to, "it is parallel to the surface");
    } else if (b->c != 0 && !b->terms) {
        say_missed_quadric(to, b, ray->o, ray->d);
    } else if (b->terms && ray->d.z != 0) {
        sgt_vec3 plane = along3(ray->o, -ray->o.z / ray->d.z, ray->d);
        plane.z = 0;
        if (isnan(s.ops->value(s.self, plane, NULL)))
            sgt_say(to, "there is no surface where it crosses the vertex plane");
    }
}

static void say_missed_sag(saying *to, const rimless *b, sgt_surface s, const sgt_ray *ray)
{
    const sgt_ray line = {.o = ray->o, .d = ray->d, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    const sgt_hit whole = sgt_intersect(s, line, NULL);
    if (whole.status > 0)
        sgt_say(to, "there is a root at t = %s, but it is outside tmin ... tmax, or the ray's own start",
                short_number(whole.t).text);
    else if (whole.status < 0)
        sgt_say(to, "there is no root between tmin and tmax.  Outside of them one is in doubt");
    if (whole.status != SGT_MISS) return;
    const sgt_hit beyond = sgt_intersect(b->surface, line, NULL);
    if (beyond.status > 0)
        sgt_say(to, "it meets the surface only outside semi_diameter, first at r = %s",
                short_number(hypot(beyond.p.x, beyond.p.y)).text);
    else if (beyond.status < 0)
        sgt_say(to, "there is no root within semi_diameter.  Outside of it one is in doubt");
    else say_missed_all(to, b, s, ray);
}

size_t sgt_why_missed(sgt_surface s, const sgt_ray *ray, size_t size, char text[])
{
    saying to = {.size = size, .text = text};
    rimless b = sgt_bare_of(s);
    sgt_say(&to, "%s", "");
    if (b.has_rim) say_missed_sag(&to, &b, s, ray);
    else say_missed_set(&to, s, ray);
    sgt_bare_end(&b);
    return to.length;
}

size_t sgt_why_refused(const sgt_search *s, double t, size_t size, char text[])
{
    saying to = {.size = size, .text = text};
    if (sgt_say_unknown(&to, s->reserved_, "sgt_search")) return to.length;
    const sgt_ray *ray = &s->ray;
    const double tmin = ray->tmin, tmax = sgt_end_of(ray), close = 0x1p-40 * (fabs(t) + fabs(tmin));
    const sgt_vec3 p = along3(ray->o, t, ray->d);
    const double radius = hypot(p.x, p.y), *rim = sgt_number_of(s->surface, "semi_diameter");
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL};
    if (s->surface.ops->span) span = s->surface.ops->span(s->surface.self, ray);
    sgt_say(&to, "%s", "");
    if (t > tmax) sgt_say(&to, "lies beyond the ray's end, tmax = %s", short_number(tmax).text);
    else if (t < tmin && tmin - t > close)
        sgt_say(&to, "lies before the ray's start, tmin = %s", short_number(tmin).text);
    else if (isfinite(tmin) && fabs(t - tmin) <= close)
        sgt_say(&to, "is the ray's own start, which is not accepted");
    else if (rim && *rim > 0 && radius > *rim)
        sgt_say(&to, "lies outside semi_diameter, at r = %s", short_number(radius).text);
    else if (t < span.lo || t > span.hi)
        sgt_say(&to, "lies outside the part of space that holds the surface");
    else if (s->hit->status == SGT_MISS)
        sgt_say(&to, "is no root: F only comes near 0 there, or jumps");
    else if (t > s->hit->t) sgt_say(&to, "lies behind the library's answer");
    return to.length;
}
