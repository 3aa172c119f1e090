// SPDX-License-Identifier: MIT
/* ended.c - why a ray ended at an element, in words of optics. */
#include <sagitta/surfaces.h>
#include <sagitta/why.h>

#include "say.h"
#include "../base/vec3.h"

static const double DEGREES = 57.295779513082321; /* in a radian */

/* By the tangent, since the cosine of a small angle is 1 to within rounding. */
double sgt_incidence(const sgt_element *e, const sgt_arrival *a)
{
    sgt_vec3 n = {(double)NAN, (double)NAN, (double)NAN};
    const bool facets = e->phase && e->phase->kind == SGT_FACETS;
    const sgt_surface bends = facets ? e->phase->waves : e->surface;
    bends.ops->value(bends.self, facets ? (sgt_vec3){a->p.x, a->p.y, 0} : a->p, &n);
    return atan2(length3(cross3(n, a->direction)), fabs(dot3(n, a->direction))) * DEGREES;
}

double sgt_critical_angle(const sgt_arrival *a) { return asin(fmin(1, a->behind / a->index)) * DEGREES; }

static void say_clipped(saying *to, const sgt_element *e, sgt_vec3 p)
{
    static const char *const shapes[] = {"",        "circle",  "annulus", "rectangle",
                                         "ellipse", "polygon", "spider"};
    const sgt_clipping by = sgt_clipped_by(e, p);
    const written size = sgt_written(by.size, 9), limit = sgt_written(by.limit, 9);
    if (by.by == SGT_BY_SEMI_DIAMETER)
        sgt_say(to, "clipped by its semi_diameter: r = %s is beyond %s", size.text, limit.text);
    else if (by.by < 0) sgt_say(to, "clipped at its edge");
    if (by.by < 0) return;
    const sgt_aperture_item *item = &e->aperture->items[by.by];
    sgt_say(to, "clipped by aperture %d (%s%s): ", by.by + 1, shapes[item->shape],
            item->obscuring ? ", obscuring" : "");
    if (item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS)
        sgt_say(to, "r = %s is %s %s", size.text, by.size > by.limit ? "beyond" : "within", limit.text);
    else
        sgt_say(to, "%s %s its edge", sgt_written(by.size, 3).text, item->obscuring ? "within" : "beyond");
}

static void say_missed(saying *to, const sgt_element *e, const sgt_arrival *a)
{
    const sgt_vec3 at_vertex = along3(a->from, -a->from.z / a->direction.z, a->direction);
    sgt_say(to, "missed it");
    if (!sgt_is_sag(e->surface)) return;
    if (a->direction.z == 0) sgt_say(to, ": it runs parallel to the vertex plane");
    else
        sgt_say(to, ": its line crosses the vertex plane %s from the axis",
                sgt_written(hypot(at_vertex.x, at_vertex.y), 4).text);
}

static void say_evanescent(saying *to, const sgt_element *e, const sgt_arrival *a)
{
    sgt_hit hit = {.p = a->p};
    e->surface.ops->value(e->surface.self, a->p, &hit.n);
    const sgt_phased p = sgt_phase_at(e, a->index, a->direction, &hit);
    sgt_say(to, "evanescent: its phase asks for %s along the surface, and the index is %s there",
            sgt_written(p.along, 6).text, sgt_written(p.limit, 6).text);
}

size_t sgt_why_ended(const sgt_element *e, sgt_fate fate, const sgt_arrival *a, size_t size, char text[])
{
    saying to = {.size = size, .text = text};
    if (sgt_say_unknown(&to, a->reserved_, "sgt_arrival")) return to.length;
    sgt_say(&to, "%s", "");
    switch (fate) {
    case SGT_CLIPPED: say_clipped(&to, e, a->p); break;
    case SGT_TIR:
        sgt_say(&to, "totally reflected: incidence %s degrees, critical angle %s",
                sgt_written(sgt_incidence(e, a), 4).text, sgt_written(sgt_critical_angle(a), 4).text);
        break;
    case SGT_MISSED: say_missed(&to, e, a); break;
    case SGT_EVANESCENT: say_evanescent(&to, e, a); break;
    case SGT_PASSED:
    case SGT_LOST: break;
    }
    return to.length;
}
