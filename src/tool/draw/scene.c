// SPDX-License-Identifier: MIT
/* scene.c - collects the outlines of the elements, and cuts the paths of the rays to what a page shows. */
#include "scene.h"

#include "../base/memory.h"
#include "../show/frame.h"

#include <math.h>

static const double LEAD = 0.08;       /* of the lens's extent: the length of rays in front of it */
static const double NEAR_OBJECT = 1.5; /* of the lens's length: an object at most so far away is shown */
static const double BEYOND_LENS = 3;   /* of the lens's extent: a ray is drawn to what it missed within it */

scene scene_begin(const job *j, view_plane plane)
{
    scene s = {.job = j, .view = view_of(plane), .reach = memory_take(j->lens.count, sizeof(sgt_footprint)),
               .outline = memory_take(j->lens.count, sizeof(outline)),
               .by_wavelength = j->wavelengths > 1 && j->fields <= 1};
    for (size_t i = 0; i < j->lens.count; i++)
        s.reach[i] = (sgt_footprint){0, {HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    return s;
}

static void reach_widen(sgt_footprint *r, sgt_vec3 own)
{
    r->radius = fmax(r->radius, hypot(own.x, own.y));
    r->low = (sgt_vec2){fmin(r->low.x, own.x), fmin(r->low.y, own.y)};
    r->high = (sgt_vec2){fmax(r->high.x, own.x), fmax(r->high.y, own.y)};
}

static bool astray(sgt_fate fate) { return fate == SGT_MISSED || fate == SGT_LOST; }

void scene_add(scene *s, size_t field, size_t wavelength, size_t points, const sgt_vec3 point[],
               sgt_fate fate, sgt_vec3 direction)
{
    ray_path p = {.field = field, .wavelength = wavelength, .count = points, .fate = fate,
                  .at = memory_take(points + 1, sizeof *p.at)};
    for (size_t i = 0; i < points; i++) {
        p.at[i] = point[i];
        if (i > 0) reach_widen(&s->reach[i - 1], frame_point_in(&s->job->element[i - 1].pose, point[i]));
    }
    if (astray(fate)) p.at[p.count++] = direction; /* scene_finish makes it a point */
    s->path = memory_room(s->path, s->paths, &s->capacity, sizeof *s->path);
    s->path[s->paths++] = p;
}

bool scene_glass_behind(const scene *s, size_t i)
{
    const lens *l = &s->job->lens;
    return i + 1 < l->count && l->index[i] != 1 && s->outline[i].half > 0 && s->outline[i + 1].half > 0;
}

bool scene_straight(const scene *s)
{
    const lens *l = &s->job->lens;
    for (size_t i = 0; i < l->count; i++)
        if (l->surface[i].off_axis || l->surface[i].folded) return false;
    return true;
}

/* ------------------------------------------------------------------- extent */

static double *coordinate(sgt_vec3 *p, int k) { return k == 0 ? &p->x : k == 1 ? &p->y : &p->z; }

static void include(scene *s, sgt_vec3 p)
{
    spot at = view_spot(&s->view, p);
    if (!isfinite(at.right) || !isfinite(at.up)) return;
    s->least = (spot){fmin(s->least.right, at.right), fmin(s->least.up, at.up)};
    s->most = (spot){fmax(s->most.right, at.right), fmax(s->most.up, at.up)};
}

static void include_element(scene *s, sgt_vec3 p)
{
    include(s, p);
    for (int k = 0; k < 3; k++) {
        double *low = coordinate(&s->low, k), *high = coordinate(&s->high, k), at = *coordinate(&p, k);
        *low = fmin(*low, at), *high = fmax(*high, at);
    }
}

static void include_outline(scene *s, const outline *o)
{
    for (int k = 0; k < OUTLINE_POINTS; k++) include_element(s, o->at[k]);
    for (size_t i = 0; i < o->pieces; i++)
        for (size_t k = 0; k < o->piece[i].count; k++) include_element(s, o->piece[i].at[k]);
    for (size_t i = 0; i < o->strokes; i++)
        include_element(s, o->stroke[i][0]), include_element(s, o->stroke[i][1]);
}

/* The edge of the glass behind element i; it is as wide as the wider of its two faces. */
static void include_edges(scene *s, size_t i)
{
    const outline *a = &s->outline[i], *b = a + 1;
    for (int side = 0; side < 2; side++) {
        include_element(s, outline_corner(a, side, fmax(a->half, b->half)));
        include_element(s, outline_corner(b, side, fmax(a->half, b->half)));
    }
}

/* ---------------------------------------------------------------------- rays */

/* The part (0 ... 1) of the way from `a` to `b` after which a coordinate is inside [low, high]. */
static double scene_enters(double a, double b, double low, double high)
{
    if (a < low && b > a) return (low - a) / (b - a);
    if (a > high && b < a) return (a - high) / (a - b);
    return 0;
}

/* Moves a along the line to b until it is inside the lens and its lead.  A lead's length of the line is
 * always kept, so that a ray clipped far outside is still drawn as a line. */
static sgt_vec3 brought_in(const scene *s, sgt_vec3 a, sgt_vec3 b)
{
    const bool shown[] = {s->view.plane != VIEW_YZ, s->view.plane != VIEW_XZ, true};
    sgt_vec3 low = s->low, high = s->high;
    double u = 0;
    for (int k = 0; k < 3; k++)
        if (shown[k])
            u = fmax(u, scene_enters(*coordinate(&a, k), *coordinate(&b, k), *coordinate(&low, k) - s->lead,
                                     *coordinate(&high, k) + s->lead));
    double length = vector_length(vector_minus(b, a));
    u = fmax(0, fmin(u, length > 0 ? 1 - s->lead / length : 0));
    return vector_along(a, vector_minus(b, a), u);
}

/* Where a ray begins in the picture.  Rays of a distant field begin at a common plane in front of the lens. A
 * ray of a file begins at its own start, or where it enters the picture. */
static void cut_start(const scene *s, ray_path *p)
{
    const lens *l = &s->job->lens;
    double front = s->low.z - s->lead;
    bool beam = s->job->fields > 0;
    if (p->count < 2 || (beam && l->of->object_distance <= NEAR_OBJECT * (s->high.z - s->low.z))) return;
    sgt_vec3 a = p->at[0], b = p->at[1], d = vector_minus(b, a);
    if (beam && b.z > a.z && b.z > front) a = vector_along(b, d, (front - b.z) / d.z);
    p->at[0] = brought_in(s, a, b);
}

/* The end of a ray that missed an element, or is lost: as far on its way as the element is, and a lead's
 * length on.  If the element is behind it, or very far, only that. */
static void end_astray(const scene *s, ray_path *p, double size)
{
    sgt_vec3 from = p->at[p->count - 2], d = p->at[p->count - 1];
    sgt_vec3 to = vector_minus(s->job->element[p->count - 2].pose.origin, from);
    double length = vector_length(d), far = vector_dot(to, d) / length;
    far = far > 0 && far < BEYOND_LENS * size ? far + s->lead : s->lead;
    p->at[p->count - 1] = vector_along(from, d, far / length);
}

/* The largest height of any element: for those of which nothing is known. */
static double any_height(const scene *s)
{
    const lens *l = &s->job->lens;
    double all = 0;
    for (size_t i = 0; i < l->count; i++) all = fmax(all, fmax(outline_known(s->job, i), s->reach[i].radius));
    return all == 0 && l->of->pupil == SGT_PUPIL_RADIUS ? l->of->pupil_size : all;
}

/* The extent of another, too. */
static void include_scene(scene *s, const scene *other)
{
    s->least = (spot){fmin(s->least.right, other->least.right), fmin(s->least.up, other->least.up)};
    s->most = (spot){fmax(s->most.right, other->most.right), fmax(s->most.up, other->most.up)};
    s->low.z = fmin(s->low.z, other->low.z), s->high.z = fmax(s->high.z, other->high.z);
}

void scene_finish(scene *s)
{
    const lens *l = &s->job->lens;
    double back = 1, all = any_height(s); /* light along +z falls on the -z side of a mirror */
    s->low = (sgt_vec3){HUGE_VAL, HUGE_VAL, HUGE_VAL}, s->high = (sgt_vec3){-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    s->least = (spot){HUGE_VAL, HUGE_VAL}, s->most = (spot){-HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < l->count; i++) {
        s->outline[i] = outline_of(s->job, &s->view, i, &s->reach[i], all, back);
        include_outline(s, &s->outline[i]);
        if (l->surface[i].mirror) back = -back;
    }
    for (size_t i = 0; i < l->count; i++)
        if (scene_glass_behind(s, i)) include_edges(s, i);
    double size = fmax(s->most.right - s->least.right, s->most.up - s->least.up);
    s->lead = LEAD * (size > 0 ? size : 1);
    for (size_t i = 0; i < s->paths; i++) {
        ray_path *p = &s->path[i];
        if (astray(p->fate)) end_astray(s, p, size);
        cut_start(s, p);
        if (p->fate == SGT_CLIPPED)
            p->at[p->count - 1] = brought_in(s, p->at[p->count - 1], p->at[p->count - 2]);
        for (size_t k = 0; k < p->count; k++) include(s, p->at[k]);
    }
    for (size_t i = 0; i < s->other_count; i++) scene_finish(&s->others[i]), include_scene(s, &s->others[i]);
}
