/* scene.c - finds the outlines of the elements, and cuts the paths of the rays to what a page shows. */
#include "scene.h"

#include "../show/frame.h"
#include "../base/memory.h"
#include "../read/surface.h"
#include "../show/profile.h"

#include <math.h>

static const double LEAD = 0.08;       /* of the lens's extent: the length of rays in front of it */
static const double NEAR_OBJECT = 1.5; /* of the lens's length: an object at most so far away is shown */
static const double BEYOND_LENS = 3;   /* of the lens's extent: a ray that met nothing is drawn so far */
/* a surface without a clear aperture is drawn so many times as wide as the rays */
static const double BEYOND_RAYS = 1.1;

enum { BLOCKED_STEPS = 512 };

static spot spot_of(sgt_vec3 p) { return (spot){p.z, p.y}; }

scene scene_begin(const job *j)
{
    return (scene){.job = j, .reach = memory_take(j->lens.count, sizeof(double)),
                   .outline = memory_take(j->lens.count, sizeof(outline))};
}

void scene_add(scene *s, size_t field, size_t points, const sgt_vec3 point[], sgt_fate fate,
               sgt_vec3 direction)
{
    bool astray = fate == SGT_MISSED || fate == SGT_LOST;
    path p = {.field = field, .count = points, .fate = fate, .at = memory_take(points + 1, sizeof *p.at)};
    for (size_t i = 0; i < points; i++) {
        p.at[i] = spot_of(point[i]);
        if (i == 0) continue;
        sgt_vec3 own = frame_point_in(&s->job->element[i - 1].pose, point[i]);
        s->reach[i - 1] = fmax(s->reach[i - 1], hypot(own.x, own.y));
    }
    if (astray) p.at[p.count++] = spot_of(direction); /* scene_finish makes it a point */
    s->path = memory_room(s->path, s->paths, &s->capacity, sizeof *s->path);
    s->path[s->paths++] = p;
}

/* --------------------------------------------------------------- outlines */

/* The largest half height up to `wanted` at which the surface exists on both sides, by bisection. */
static double half_height(const sgt_element *e, double wanted)
{
    double low = 0, high = wanted;
    if (!isnan(profile_sag(e, 0, high) + profile_sag(e, 0, -high))) return high;
    for (int i = 0; i < 40; i++) {
        double middle = (low + high) / 2;
        if (isnan(profile_sag(e, 0, middle) + profile_sag(e, 0, -middle))) high = middle;
        else low = middle;
    }
    return low;
}

/* The section of a body.  A level set is not drawn: its details are finer than the net. */
static void add_section(outline *o, const sgt_element *e, double reach)
{
    sgt_vec3(*own)[2] = NULL;
    o->strokes = surface_is_level_set(e->surface) ? 0 : profile_section(e, reach, &own);
    o->stroke = memory_take(o->strokes, sizeof *o->stroke);
    for (size_t i = 0; i < o->strokes; i++)
        for (int k = 0; k < 2; k++) o->stroke[i][k] = spot_of(frame_point_out(&e->pose, own[i][k]));
    for (int k = 0; k < OUTLINE_POINTS; k++)
        o->at[k] = spot_of(frame_point_out(&e->pose, (sgt_vec3){0, 0, 0}));
}

/* Finds the pieces of the section that the apertures clip, to a part in BLOCKED_STEPS of the height. */
static void add_blocked(outline *o, const sgt_element *e)
{
    size_t room = 0;
    spot last = {0, 0};
    bool open = false;
    if (!e->aperture || !(o->half > 0)) return;
    for (int k = 0; k <= BLOCKED_STEPS; k++) {
        sgt_vec3 own = {0, o->middle + o->half * (2 * k - BLOCKED_STEPS) / BLOCKED_STEPS, 0};
        bool blocks = sgt_clipped_by(e, own).by >= 0;
        own.z = profile_sag(e, 0, own.y);
        spot here = spot_of(frame_point_out(&e->pose, own));
        if (blocks && open) {
            o->blocked = memory_room(o->blocked, o->blocked_count, &room, sizeof *o->blocked);
            o->blocked[o->blocked_count][0] = last, o->blocked[o->blocked_count++][1] = here;
        }
        open = blocks, last = here;
    }
}

/* The part of y that the first aperture beside the axis lets through, from its middle; false: there is
 * none. */
static bool part_in_use(const sgt_element *e, double *middle, double *half)
{
    const sgt_aperture *a = e->aperture;
    for (size_t i = 0; a && i < a->count; i++) {
        const sgt_aperture_item *item = &a->items[i];
        if (item->obscuring || item->centre.y == 0 || item->shape == SGT_POLYGON || item->shape == SGT_SPIDER)
            continue;
        *middle = item->centre.y;
        *half = item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS ? item->radius
                                                                        : hypot(item->half.x, item->half.y);
        if (item->degrees == 0 && (item->shape == SGT_RECTANGLE || item->shape == SGT_ELLIPSE))
            *half = item->half.y;
        return true;
    }
    return false;
}

static outline outline_of(const scene *s, size_t i, double back)
{
    const lens *l = &s->job->lens;
    const sgt_element *e = &l->element[i];
    double before = i ? l->index[i - 1] : l->index_before;
    bool mirror = l->surface[i].mirror;
    outline o = {
        .up = spot_of(frame_direction_out(&e->pose, (sgt_vec3){0, 1, 0})),
        .ahead = spot_of(frame_direction_out(&e->pose, (sgt_vec3){0, 0, 1})),
        .mirror = mirror, .stop = l->of->stop_marked && l->of->stop == i, .back = back,
        .lens = e->phase ? copysign(1, e->phase->focal_length) : 0,
        .dummy = !mirror && !e->phase && l->index[i] == before && i + 1 < l->count,
    };
    double wanted = e->semi_diameter > 0       ? e->semi_diameter
                    : l->surface[i].size > 0 ? l->surface[i].size
                                             : BEYOND_RAYS * s->reach[i];
    if (wanted == 0 && l->of->pupil == SGT_PUPIL_RADIUS) wanted = l->of->pupil_size;
    if (!profile_is_sag(e->surface)) {
        add_section(&o, e, wanted);
        return o;
    }
    double middle = 0;
    if (part_in_use(e, &middle, &wanted)) o.half = wanted;
    else o.half = half_height(e, wanted);
    o.middle = middle;
    for (int k = 0; k < OUTLINE_POINTS; k++) {
        double y = middle + o.half * (2 * k - (OUTLINE_POINTS - 1)) / (OUTLINE_POINTS - 1);
        double sag = profile_sag(e, 0, y);
        if (isnan(sag)) o.half = 0; /* a hole in the middle: a line cannot show it */
        o.at[k] = spot_of(frame_point_out(&e->pose, (sgt_vec3){0, y, isnan(sag) ? 0 : sag}));
    }
    add_blocked(&o, e);
    return o;
}

bool scene_glass_behind(const scene *s, size_t i)
{
    const lens *l = &s->job->lens;
    return i + 1 < l->count && l->index[i] != 1 && s->outline[i].half > 0 &&
           s->outline[i + 1].half > 0;
}

spot scene_corner(const outline *o, int side, double half)
{
    spot rim = o->at[side ? OUTLINE_POINTS - 1 : 0];
    double more = (side ? 1 : -1) * (half - o->half);
    return (spot){rim.z + more * o->up.z, rim.y + more * o->up.y};
}

/* ----------------------------------------------------------------- extent */

static void include(scene *s, spot p)
{
    if (!isfinite(p.z) || !isfinite(p.y)) return;
    s->low = (spot){fmin(s->low.z, p.z), fmin(s->low.y, p.y)};
    s->high = (spot){fmax(s->high.z, p.z), fmax(s->high.y, p.y)};
}

/* The edge of the glass behind element i; it is as wide as the wider of its two faces. */
static void include_edges(scene *s, size_t i)
{
    const outline *a = &s->outline[i], *b = a + 1;
    for (int side = 0; side < 2; side++) {
        include(s, scene_corner(a, side, fmax(a->half, b->half)));
        include(s, scene_corner(b, side, fmax(a->half, b->half)));
    }
}

/* The part (0 ... 1) of the way from `a` to `b` after which a coordinate is inside [low, high]. */
static double scene_enters(double a, double b, double low, double high)
{
    if (a < low && b > a) return (low - a) / (b - a);
    if (a > high && b < a) return (a - high) / (a - b);
    return 0;
}

/* Moves a along the line to b until it is inside the lens and its lead.  A lead's length of the line is
 * always kept, so that a ray clipped far outside is still drawn as a line. */
static spot brought_in(const scene *s, spot a, spot b, spot low, spot high)
{
    double u = fmax(scene_enters(a.z, b.z, low.z - s->lead, high.z + s->lead),
                    scene_enters(a.y, b.y, low.y - s->lead, high.y + s->lead));
    double length = hypot(b.z - a.z, b.y - a.y);
    u = fmax(0, fmin(u, length > 0 ? 1 - s->lead / length : 0));
    return (spot){a.z + u * (b.z - a.z), a.y + u * (b.y - a.y)};
}

/* Where a ray begins in the picture.  Rays of a distant field begin at a common line in front of the lens.  A
 * ray of a file begins at its own start, or where it enters the picture. */
static void cut_start(const scene *s, path *p, spot low, spot high)
{
    const lens *l = &s->job->lens;
    double left = low.z - s->lead;
    bool beam = s->job->fields > 0;
    if (p->count < 2 || (beam && l->of->object_distance <= NEAR_OBJECT * (high.z - low.z))) return;
    spot a = p->at[0], b = p->at[1];
    if (beam && b.z > a.z && b.z > left) {
        double u = (a.z - left) / (b.z - a.z);
        a = (spot){left, a.y - u * (b.y - a.y)};
    }
    p->at[0] = brought_in(s, a, b, low, high);
}

void scene_finish(scene *s)
{
    const lens *l = &s->job->lens;
    double back = 1; /* light along +z falls on the -z side of a mirror */
    s->low = (spot){HUGE_VAL, HUGE_VAL}, s->high = (spot){-HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < l->count; i++) {
        s->outline[i] = outline_of(s, i, back);
        for (int k = 0; k < OUTLINE_POINTS; k++) include(s, s->outline[i].at[k]);
        for (size_t k = 0; k < s->outline[i].strokes; k++)
            include(s, s->outline[i].stroke[k][0]), include(s, s->outline[i].stroke[k][1]);
        if (l->surface[i].mirror) back = -back;
    }
    for (size_t i = 0; i < l->count; i++)
        if (scene_glass_behind(s, i)) include_edges(s, i);
    double size = fmax(s->high.z - s->low.z, s->high.y - s->low.y);
    s->lead = LEAD * (size > 0 ? size : 1);
    spot low = s->low, high = s->high;
    for (size_t i = 0; i < s->paths; i++) {
        path *p = &s->path[i];
        if (p->fate == SGT_MISSED || p->fate == SGT_LOST) {
            spot from = p->at[p->count - 2], d = p->at[p->count - 1];
            double far = s->lead, first = (l->surface[0].z - from.z) / d.z;
            /* it met nothing at all: draw it to the first surface and on */
            if (p->count == 2 && first > 0 && first < BEYOND_LENS * size) far += first;
            p->at[p->count - 1] = (spot){from.z + far * d.z, from.y + far * d.y};
        }
        cut_start(s, p, low, high);
        if (p->fate == SGT_CLIPPED)
            p->at[p->count - 1] = brought_in(s, p->at[p->count - 1], p->at[p->count - 2], low, high);
        for (size_t k = 0; k < p->count; k++) include(s, p->at[k]);
    }
}
