/* aim.c - rays aimed at the stop, and fields aimed at the image.
 *
 * A RAY OF A BEAM is one of a family with two parameters, its coordinates u, v in the entrance
 * pupil: all numbers of origin and direction are linear in them.  sgt_aim finds the one that
 * meets a point of the stop, or proves that there is none in the box of u and v (BOX radii of the
 * pupil, on either side).  The search begins at the ray before, moved as far as the point is.
 *
 * A FIELD BY ITS REAL IMAGE HEIGHT is a chief ray, as the lens itself aims.  At the paraxial pupil it
 * goes through the pupil's centre: another family of two parameters, the slopes (from afar) or
 * the object point, aimed at the image.  Aimed at the stop each of these has its own
 * chief ray; then Newton's method finds the parameters, with differences for derivatives: they
 * are good to about 1e-5, and each step gains as much. */
#include "aim.h"

#include "../base/memory.h"
#include "../show/frame.h"

#include <math.h>
#include <sagitta/aim.h>

static const double RADIANS = 0.017453292519943295; /* a degree */
static const double BOX = 6, SLOPES = 50;           /* of the pupil; a direction of 88.9 degrees */
enum { TOLD = 4, STEPS = 12 };

/* The rays of a beam by their coordinates in the pupil. */
static sgt_beam family_of(const beam *b)
{
    const double a = b->radius;
    sgt_beam f = {.u = {-BOX, BOX}, .v = {-BOX, BOX}};
    if (b->finite) {
        f.o = b->object;
        f.d = vector_minus((sgt_vec3){0, 0, b->pupil}, b->object);
        f.du.x = f.dv.y = a;
        return f;
    }
    const sgt_vec3 d = b->direction;
    f.d = d;
    f.o = vector_along((sgt_vec3){0, 0, b->pupil}, d, b->wave - b->pupil * d.z);
    f.ou = vector_along((sgt_vec3){a, 0, 0}, d, -a * d.x);
    f.ov = vector_along((sgt_vec3){0, a, 0}, d, -a * d.y);
    return f;
}

static sgt_ray of_unit_length(sgt_ray ray)
{
    double length = vector_length(ray.d);
    ray.d = (sgt_vec3){ray.d.x / length, ray.d.y / length, ray.d.z / length};
    ray.tmin = ray.tmax = 0;
    return ray;
}

static sgt_aiming aim_at(const lens *l, size_t element, const sgt_beam *f, sgt_vec2 wanted, size_t starts,
                         const sgt_vec2 start[])
{
    sgt_passage *passage = memory_take(element + 1, sizeof *passage);
    sgt_aiming a;
    sgt_aim(element, l->element, l->index_before, f, wanted, passage,
            &(sgt_aim_options){.starts = starts, .start = start}, &a);
    return a;
}

double aim_stop_radius(const launch_how *how)
{
    const lens *l = &how->lens;
    if (how->aim == LAUNCH_AT_STOP) return how->data.stop_radius;
    const beam b = launch_axial_beam(how);
    sgt_ray ray = beam_ray(&b, 0, 1);
    size_t stop = l->of->stop;
    sgt_passage *passage = memory_take(stop + 1, sizeof *passage);
    if (sgt_trace(stop + 1, l->element, l->index_before, &ray, passage, NULL, NULL) < stop ||
        passage[stop].hit.status <= 0)
        lens_fail(l, "aim", "the real marginal ray on the axis does not reach the stop, element %zu",
                  stop + 1);
    return hypot(passage[stop].hit.p.x, passage[stop].hit.p.y);
}

bool aim_ray(launch_how *how, const lens *traced, const beam *b, sgt_vec2 q, launch *l, aim_start *start)
{
    const sgt_beam f = family_of(b);
    const sgt_vec2 wanted = {q.x * how->stop_radius, q.y * how->stop_radius};
    sgt_vec2 starts[2] = {q, q};
    if (start->known) {
        starts[0].x = start->at.x + q.x - start->pupil.x, starts[0].y = start->at.y + q.y - start->pupil.y;
    }
    sgt_aiming a = aim_at(traced, traced->of->stop, &f, wanted, 2, starts);
    if (a.status == SGT_MET) {
        *start = (aim_start){true, q, {a.u, a.v}};
        l->ray = of_unit_length(a.ray);
        return true;
    }
    bool none = a.status == SGT_NO_SUCH_RAY;
    if (how->none + how->undecided < TOLD)
        note("ray %zu (field %zu, px %g, py %g): %s through this point of the stop", l->number, l->field + 1,
             l->px, l->py, none ? "there is no ray, as is proven," : "no ray was found, nor excluded,");
    else if (how->none + how->undecided == TOLD) note("and more rays that are not there");
    *(none ? &how->none : &how->undecided) += 1;
    return false;
}

/* ------------------------------------------------------------ real image heights */

/* The chief rays through the centre of the paraxial pupil, by their slopes or by their object point. */
static sgt_beam chiefs_of(const beam *b)
{
    if (b->finite)
        return (sgt_beam){.o = {0, 0, b->object.z}, .ou = {1, 0, 0}, .ov = {0, 1, 0},
                          .d = {0, 0, b->pupil - b->object.z}, .du = {-1, 0, 0}, .dv = {0, -1, 0}};
    double way = b->pupil - b->front;
    return (sgt_beam){.o = {0, 0, b->front}, .ou = {-way, 0, 0}, .ov = {0, -way, 0}, .d = {0, 0, 1},
                      .du = {1, 0, 0}, .dv = {0, 1, 0}, .u = {-SLOPES, SLOPES}, .v = {-SLOPES, SLOPES}};
}

static void set_point(beam *b, const lens *l, sgt_vec2 at)
{
    if (b->finite) beam_point(b, l, at.x, at.y);
    else beam_point(b, l, atan(at.x) / RADIANS, atan(at.y) / RADIANS);
}

/* Where the chief ray through the centre of the stop meets the image, for a field at `at`. */
static bool image_of(const lens *l, beam b, sgt_vec2 at, sgt_vec2 *image, sgt_vec2 *pupil)
{
    set_point(&b, l, at);
    const sgt_beam f = family_of(&b);
    sgt_aiming a = aim_at(l, l->of->stop, &f, (sgt_vec2){0, 0}, 1, pupil);
    if (a.status != SGT_MET) return false;
    *pupil = (sgt_vec2){a.u, a.v};
    sgt_element *open = memory_take(l->count, sizeof *open);
    for (size_t i = 0; i < l->count; i++) {
        open[i] = l->element[i];
        open[i].semi_diameter = 0, open[i].aperture = NULL;
    }
    sgt_passage *passage = memory_take(l->count, sizeof *passage);
    size_t passed = sgt_trace(l->count, open, l->index_before, &a.ray, passage, NULL, NULL);
    if (passed < l->count) return false;
    *image = (sgt_vec2){passage[l->count - 1].hit.p.x, passage[l->count - 1].hit.p.y};
    return true;
}

/* Newton's method for the field whose aimed chief ray meets the image at `wanted`. */
static bool solve_field(const lens *l, const beam *b, sgt_vec2 wanted, sgt_vec2 *at)
{
    const double scale = 1e-5 * (b->finite ? fabs(b->object.z - b->pupil) : 1);
    double least = HUGE_VAL;
    sgt_vec2 best = *at, pupil = {0, 0};
    for (int i = 0; i < STEPS; i++) {
        sgt_vec2 f, fx, fy, x = {at->x + scale, at->y}, y = {at->x, at->y + scale};
        if (!image_of(l, *b, *at, &f, &pupil)) break;
        double miss = hypot(f.x - wanted.x, f.y - wanted.y);
        if (!(miss < least)) break; /* as near as rounding allows, or off the way */
        least = miss, best = *at;
        if (!image_of(l, *b, x, &fx, &pupil) || !image_of(l, *b, y, &fy, &pupil)) break;
        double a = (fx.x - f.x) / scale, c = (fy.x - f.x) / scale, e = (fx.y - f.y) / scale,
               g = (fy.y - f.y) / scale, by = a * g - c * e, u = wanted.x - f.x, v = wanted.y - f.y;
        if (!(fabs(by) > 0)) break;
        at->x += (g * u - c * v) / by, at->y += (a * v - e * u) / by;
    }
    *at = best;
    return least <= 1e-9 * (hypot(wanted.x, wanted.y) + 1e-3 * fabs(b->pupil - b->front));
}

void aim_field(const launch_how *how, beam *b, sgt_lens_field at)
{
    const lens *l = &how->lens;
    const sgt_vec2 wanted = {at.x, at.y};
    if (b->finite) b->object.z = l->surface[0].z - l->of->object_distance;
    double by = b->finite ? 1 / how->data.magnification : how->data.power / l->index_before;
    sgt_vec2 found = {isfinite(by) ? at.x * by : 0, isfinite(by) ? at.y * by : 0};
    sgt_beam f = chiefs_of(b);
    if (b->finite) {
        double reach = 10 * (hypot(found.x, found.y) + b->radius);
        f.u = f.v = (sgt_interval){-reach, reach};
    }
    bool fine = false;
    if (l->of->aim == SGT_AIM_PUPIL || b->cone > 0) {
        sgt_aiming a = aim_at(l, l->count - 1, &f, wanted, 1, &found);
        fine = a.status == SGT_MET, found = (sgt_vec2){a.u, a.v};
    } else {
        fine = solve_field(l, b, wanted, &found);
    }
    if (!fine)
        lens_fail(l, "fields",
                  "no chief ray was found that meets the image at [%g, %g]; give --field or --rays", at.x,
                  at.y);
    set_point(b, l, found);
}
