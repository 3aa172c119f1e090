// SPDX-License-Identifier: MIT
/* aim_field.c - fields aimed at the image.
 *
 * A FIELD BY ITS REAL IMAGE HEIGHT is a chief ray, as the lens itself aims.  At the paraxial pupil it
 * goes through the pupil's centre: another family of two parameters, the slopes (from afar) or
 * the object point, aimed at the image.  Aimed at the stop each of these has its own
 * chief ray; then Newton's method finds the parameters, with differences for derivatives: they
 * are good to about 1e-5, and each step gains as much. */
#include "aim.h"

static const double RADIANS = 0.017453292519943295; /* a degree */
static const double SLOPES = 50; /* a direction of 88.9 degrees */
static const double WIDER = 10;  /* times the paraxial height of the object */
enum { STEPS = 12 };

/* The chief rays through the centre of the paraxial pupil, by their slopes or by their object point.
 * b->object is the one on the axis. */
static sgt_beam chiefs_of(const sgt_lens *l, const sgt_field_beam *b)
{
    if (b->finite) {
        const sgt_vec2 tilt = l->object_slope;
        sgt_beam f = {.o = {0, 0, b->object.z}, .ou = {1, 0, tilt.x}, .ov = {0, 1, tilt.y}, .d = {0, 0, 1}};
        const double ahead = b->cone > 0 ? 0 : copysign(1, b->pupil - b->object.z); /* 0: telecentric */
        if (ahead != 0) {
            f.d.z = fabs(b->pupil - b->object.z), f.du.x = f.dv.y = -ahead;
            f.du.z = -ahead * tilt.x, f.dv.z = -ahead * tilt.y;
        }
        return f;
    }
    double way = b->pupil - b->front;
    return (sgt_beam){.o = {0, 0, b->front}, .ou = {-way, 0, 0}, .ov = {0, -way, 0}, .d = {0, 0, 1},
                      .du = {1, 0, 0}, .dv = {0, 1, 0}, .u = {-SLOPES, SLOPES}, .v = {-SLOPES, SLOPES}};
}

static void set_point(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 at)
{
    if (b->finite) sgt_beam_point(from, b, at.x, at.y);
    else sgt_beam_point(from, b, atan(at.x) / RADIANS, atan(at.y) / RADIANS);
}

/* What a search for a field works with. */
typedef struct field_search {
    const sgt_launcher *from;
    sgt_element *open;       /* room for the lens without what clips a ray */
    sgt_passage *passages;
    size_t count;
} field_search;

/* Where the chief ray through the centre of the stop meets the image, for a field at `at`. */
static bool image_of(const field_search *s, sgt_field_beam b, sgt_vec2 at, sgt_vec2 *image, sgt_vec2 *pupil)
{
    set_point(s->from, &b, at);
    const sgt_beam f = sgt_aim_family(&b);
    sgt_fate fate;
    int where;
    aim_search one = {s->from->lens->stop, s->from->element, s->from->before, s->passages, .starts = 1,
                      .start = {*pupil}, .chief = true};
    sgt_aiming a = sgt_aim_in_family(&one, &f, (sgt_vec2){0, 0}, &where);
    if (a.status != SGT_MET) return false;
    *pupil = (sgt_vec2){a.u, a.v};
    size_t passed = sgt_trace_through(s->count, s->from->element, s->from->before, &a.ray, s->open,
                                      s->passages, &fate);
    if (passed < s->count) return false;
    *image = (sgt_vec2){s->passages[s->count - 1].hit.p.x, s->passages[s->count - 1].hit.p.y};
    return true;
}

/* Newton's method for the field whose aimed chief ray meets the image at `wanted`. */
static bool solve_field(const field_search *s, const sgt_field_beam *b, sgt_vec2 wanted, sgt_vec2 *at)
{
    const sgt_lens *l = s->from->lens;
    /* of a telecentric object the pupil is at infinity */
    double size = b->cone > 0 ? fabs(l->object_distance) : fabs(b->object.z - b->pupil);
    if (size == 0) size = hypot(wanted.x, wanted.y); /* such an object at the first vertex */
    const double scale = 1e-5 * (b->finite ? size : 1), radius = b->cone > 0 ? b->cone * size : b->radius;
    double least = HUGE_VAL;
    sgt_vec2 best = *at, pupil = {0, 0};
    for (int i = 0; i < STEPS; i++) {
        sgt_vec2 f, fx, fy, x = {at->x + scale, at->y}, y = {at->x, at->y + scale};
        if (!image_of(s, *b, *at, &f, &pupil)) break;
        double miss = hypot(f.x - wanted.x, f.y - wanted.y);
        if (!(miss < least)) break; /* as near as rounding allows, or off the way */
        least = miss, best = *at;
        if (!image_of(s, *b, x, &fx, &pupil) || !image_of(s, *b, y, &fy, &pupil)) break;
        double a = (fx.x - f.x) / scale, c = (fy.x - f.x) / scale, e = (fx.y - f.y) / scale,
               g = (fy.y - f.y) / scale, by = a * g - c * e, u = wanted.x - f.x, v = wanted.y - f.y;
        if (!(fabs(by) > 0)) break;
        at->x += (g * u - c * v) / by, at->y += (a * v - e * u) / by;
    }
    *at = best;
    return least <= 1e-9 * (hypot(wanted.x, wanted.y) + 1e-3 * radius);
}

/* *limit: how far slopes or objects were searched; 0: by steps from the paraxial one. */
static bool find_field(const field_search *s, const sgt_field_beam *b, sgt_vec2 wanted, sgt_vec2 *found,
                       double *limit)
{
    const sgt_lens *l = s->from->lens;
    if (l->aim != SGT_LENS_AIM_PUPIL) return solve_field(s, b, wanted, found);
    sgt_beam f = chiefs_of(l, b);
    if (b->finite) {
        double reach =
            WIDER * (hypot(found->x, found->y) + (b->cone > 0 ? hypot(wanted.x, wanted.y) : b->radius));
        f.u = f.v = (sgt_interval){-reach, reach};
    }
    aim_search one = {l->count - 1, s->from->element, s->from->before, s->passages, .starts = 1,
                      .start = {*found}};
    const sgt_aiming a = sgt_aim_in_box(&one, &f, wanted, 0, 0);
    *limit = b->finite ? f.u.hi : SLOPES;
    *found = (sgt_vec2){a.u, a.v};
    return a.status == SGT_MET;
}

bool sgt_aim_field(const sgt_launcher *from, sgt_field_beam *b, sgt_vec2 wanted, sgt_error *error)
{
    const sgt_lens *l = from->lens;
    if (b->finite) b->object.z = l->surface[0].z - l->object_distance;
    double by = b->finite ? 1 / from->data.magnification : from->data.power / from->before;
    sgt_vec2 found = {isfinite(by) ? wanted.x * by : 0, isfinite(by) ? wanted.y * by : 0};
    field_search s = {.from = from, .count = l->count};
    s.open = sgt_launch_take(from, l->count, sizeof *s.open);
    s.passages = sgt_launch_take(from, l->count, sizeof *s.passages);
    const bool room = s.open && s.passages;
    bool fine = room;
    double limit = 0;
    if (room) fine = find_field(&s, b, wanted, &found, &limit);
    sgt_launch_forget(from, s.open);
    sgt_launch_forget(from, s.passages);
    if (fine) {
        set_point(from, b, found);
        return true;
    }
    if (!room) return sgt_launch_memory(from, error);
    static const char way_out[] = "there may be one yet; give --field or --rays";
    if (limit == 0)
        return sgt_launch_fail(from, error, "fields",
                               "no chief ray was found that meets the image at [%g, %g] by %d steps of "
                               "Newton's method from the paraxial field; %s",
                               wanted.x, wanted.y, (int)STEPS, way_out);
    return sgt_launch_fail(from, error, "fields",
                           "no chief ray was found that meets the image at [%g, %g], with %s up to %g; %s",
                           wanted.x, wanted.y, b->finite ? "object heights" : "slopes", limit, way_out);
}
