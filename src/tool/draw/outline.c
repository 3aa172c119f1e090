// SPDX-License-Identifier: MIT
/* outline.c - finds the shape of an element, by asking the library for its sag and its apertures.
 *
 * A SECTION is a straight line in x, y through the middle of the part in use (sgt_part_in_use).  In a plane
 * of the picture it is the line that lies in the plane, in the element's own frame; so a cylinder that is
 * turned by 90 degrees shows its other profile.  It is cut where an aperture begins to clip, or the surface
 * ends:
 *
 *     clipped by an obscuring item         something is there: a bold line
 *     clipped by another item, a mirror    there is no mirror: a gap
 *     clipped by another item, else        a mask, or the jaws of a stop: a bold line
 *
 * THE RIM is drawn in the view in space, and in a plane by a fine line if the element is turned out of the
 * plane: then points of its section are not all that light meets. */
#include "outline.h"

#include "../base/memory.h"
#include "../read/surface.h"
#include "../show/frame.h"

#include <math.h>

/* the sine of an angle to the plane of the picture below which an element's rim is not drawn */
static const double OUT_OF_PLANE = 0.02;

/* steps of a section that is looked through for clipped parts; points of a piece are STRIDE of them apart */
enum { CUT_STEPS = 1024, STRIDE = 16 };

static sgt_vec3 on_surface(const sgt_element *e, double x, double y)
{
    return (sgt_vec3){x, y, sgt_sag_at(e->surface, x, y)};
}

double outline_known(const job *j, size_t i)
{
    return sgt_half_height(&j->element[i], &j->lens.surface[i], NULL, 0);
}

/* ------------------------------------------------------------------- pieces */

typedef enum open_kind { OPEN, GAP, BLOCKED } open_kind;

static open_kind open_at(const sgt_element *e, bool mirror, sgt_vec3 p)
{
    if (isnan(p.z)) return GAP;
    int by = e->aperture ? sgt_clipped_by(e, p).by : SGT_BY_NONE;
    if (by == SGT_BY_NONE || by == SGT_BY_UNSOUND) return OPEN;
    return mirror && (by < 0 || !e->aperture->items[by].obscuring) ? GAP : BLOCKED;
}

/* Adds a piece of `count` points, that are then to be set. */
static sgt_vec3 *add_piece(outline *o, piece_kind kind, size_t count)
{
    o->piece = memory_room(o->piece, o->pieces, &o->piece_room, sizeof *o->piece);
    o->piece[o->pieces] = (outline_piece){kind, false, count, memory_take(count, sizeof(sgt_vec3))};
    return o->piece[o->pieces++].at;
}

/* Adds a line of `count` points of the element's own frame in pieces, as it is clipped.  open: for those that
 * are not. */
static void add_cut(outline *o, const sgt_element *e, const sgt_vec3 own[], int count, int stride,
                    piece_kind open)
{
    for (int first = 0, k = 1; first < count; first = k, k++) {
        open_kind kind = open_at(e, o->mirror, own[first]);
        while (k < count && open_at(e, o->mirror, own[k]) == kind) k++;
        int last = k < count ? k : count - 1; /* pieces meet */
        if (kind == GAP) continue;
        if (isnan(own[last].z)) last--;
        sgt_vec3 *to =
            add_piece(o, kind == BLOCKED ? PIECE_BLOCKED : open, (size_t)((last - first) / stride + 2));
        size_t n = 0;
        for (int m = first; m < last; m += stride) to[n++] = frame_point_out(&e->pose, own[m]);
        to[n++] = frame_point_out(&e->pose, own[last]);
        o->piece[o->pieces - 1].count = n;
    }
}

/* Adds the section middle + t u, low <= t <= high. */
static void add_section(outline *o, const sgt_element *e, sgt_vec2 middle, sgt_vec2 u, double low,
                        double high, piece_kind open)
{
    sgt_vec3 own[CUT_STEPS + 1];
    int steps = e->aperture ? CUT_STEPS : CUT_STEPS / STRIDE;
    for (int k = 0; k <= steps; k++) {
        double t = low + (high - low) * k / steps;
        own[k] = on_surface(e, middle.x + t * u.x, middle.y + t * u.y);
    }
    add_cut(o, e, own, steps + 1, e->aperture ? STRIDE : 1, open);
}

/* Adds a closed line. */
static void add_rim(outline *o, const sgt_element *e, const sgt_part *p, piece_kind kind)
{
    sgt_vec3 *to = add_piece(o, kind, RIM_POINTS + 1);
    for (int k = 0; k <= RIM_POINTS; k++) {
        sgt_vec2 at = p->rim[k % RIM_POINTS];
        to[k] = frame_point_out(&e->pose, on_surface(e, at.x, at.y));
    }
}

/* A spider's arms, out to where they end or to a rim of radius `most`. */
static void add_arms(outline *o, const sgt_element *e, const sgt_aperture_item *item, double most)
{
    double length = item->length > 0 ? fmin(item->length, most) : most;
    for (int arm = 0; arm < item->arms; arm++) {
        double turn = item->degrees * atan(1) / 45 + arm * 8 * atan(1) / item->arms;
        sgt_vec3 *to = add_piece(o, PIECE_BLOCKED, OUTLINE_POINTS);
        for (int k = 0; k < OUTLINE_POINTS; k++) {
            double r = length * k / (OUTLINE_POINTS - 1);
            to[k] = frame_point_out(
                &e->pose, on_surface(e, item->centre.x + r * cos(turn), item->centre.y + r * sin(turn)));
        }
    }
}

/* The edges of all items of an aperture, apart from that which is the rim. */
static void add_items(outline *o, const sgt_element *e, const sgt_part *rim)
{
    const double most = 2 * o->half;
    for (size_t i = 0; e->aperture && i < e->aperture->count; i++) {
        const sgt_aperture_item *item = &e->aperture->items[i];
        piece_kind kind = o->mirror && !item->obscuring ? PIECE_SURFACE : PIECE_BLOCKED;
        if (item->shape == SGT_SPIDER) {
            add_arms(o, e, item, o->half);
            continue;
        }
        for (int inner = 0; inner < (item->shape == SGT_ANNULUS ? 2 : 1); inner++) {
            sgt_part edge = sgt_part_of_item(item, most, inner);
            if (!inner && item == rim->item) continue;
            add_rim(o, e, &edge, kind);
            o->piece[o->pieces - 1].solid = item->obscuring && item->shape != SGT_ANNULUS;
        }
    }
}

/* ----------------------------------------------------------------- outlines */

/* The direction in an element's own x, y that lies in the plane of a picture, and points upward. */
static sgt_vec2 section_direction(const view_axes *v, const sgt_pose *pose)
{
    sgt_vec3 n = frame_direction_in(pose, v->toward);
    double length = hypot(n.x, n.y);
    if (v->plane == VIEW_3D || length < OUT_OF_PLANE) return (sgt_vec2){0, 1};
    sgt_vec2 u = {-n.y / length, n.x / length};
    double rise = vector_dot(v->up, frame_direction_out(pose, (sgt_vec3){u.x, u.y, 0}));
    bool down = fabs(rise) > OUT_OF_PLANE ? rise < 0 : u.x + u.y < 0;
    return down ? (sgt_vec2){-u.x, -u.y} : u;
}

static void add_strokes(outline *o, const sgt_element *e, double size, sgt_vec3 across, sgt_vec3 along)
{
    size_t first = o->strokes;
    o->stroke = memory_grow(o->stroke, first + SGT_SECTION_MOST, sizeof *o->stroke);
    o->strokes += sgt_section(e, size, across, along, SGT_SECTION_MOST, o->stroke + first);
    for (size_t i = first; i < o->strokes; i++)
        for (int k = 0; k < 2; k++) o->stroke[i][k] = frame_point_out(&e->pose, o->stroke[i][k]);
}

/* The sections of a body.  A level set is not drawn: its details are finer than the net. */
static void draw_body(outline *o, const sgt_element *e, const view_axes *v, double size)
{
    const sgt_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    sgt_vec2 u = section_direction(v, &e->pose);
    if (surface_is_level_set(e->surface)) return;
    add_strokes(o, e, size, (sgt_vec3){u.x, u.y, 0}, z);
    if (v->plane != VIEW_3D) return;
    add_strokes(o, e, size, x, z);
    add_strokes(o, e, size, x, y);
}

/* The section of a sag in the plane of the picture, and its rim. */
static void draw_sag(outline *o, const sgt_element *e, const view_axes *v, const sgt_part *p)
{
    sgt_vec2 u = section_direction(v, &e->pose);
    double low, high;
    if (!sgt_part_along(p, u, &low, &high)) return;
    for (int k = 0; k < OUTLINE_POINTS; k++) {
        double t = low + (high - low) * k / (OUTLINE_POINTS - 1);
        o->at[k] = frame_point_out(&e->pose, on_surface(e, p->middle.x + t * u.x, p->middle.y + t * u.y));
    }
    for (int k = 0; k < RIM_POINTS; k++)
        o->rim[k] = frame_point_out(&e->pose, on_surface(e, p->rim[k].x, p->rim[k].y));
    o->half = (high - low) / 2;
    o->up = frame_direction_out(&e->pose, (sgt_vec3){u.x, u.y, 0});
    if (v->plane != VIEW_3D) {
        add_section(o, e, p->middle, u, low, high, PIECE_SURFACE);
        if (fabs(vector_dot(o->ahead, v->toward)) > OUT_OF_PLANE) add_rim(o, e, p, PIECE_FINE);
        return;
    }
    add_rim(o, e, p, PIECE_SURFACE);
    add_section(o, e, p->middle, u, low, high, PIECE_FINE);
    sgt_vec2 other = {1, 0};
    if (sgt_part_along(p, other, &low, &high)) add_section(o, e, p->middle, other, low, high, PIECE_FINE);
    add_items(o, e, p);
}

/* The sign of the focal length of an ideal lens in the section that is drawn; 0: it has no power there. */
static double lens_sign(const sgt_phase *p, view_plane plane)
{
    if (!p || p->kind != SGT_IDEAL_LENS) return 0;
    const double f = plane == VIEW_XZ || p->focal_length_y == 0 ? p->focal_length : p->focal_length_y;
    return isinf(f) ? 0 : copysign(1, f);
}

outline outline_of(const job *j, const view_axes *v, size_t i, const sgt_footprint *met, double all,
                   double back)
{
    const lens *l = &j->lens;
    const sgt_element *e = &j->element[i];
    double before = i ? l->index[i - 1] : l->index_before;
    bool mirror = l->surface[i].mirror;
    outline o = {
        .ahead = frame_direction_out(&e->pose, (sgt_vec3){0, 0, 1}),
        .mirror = mirror,
        .stop = l->of->stop_marked && l->of->stop == i,
        .back = back,
        .lens = lens_sign(e->phase, v->plane),
        .phase = e->phase && e->phase->kind != SGT_IDEAL_LENS,
        .dummy = !mirror && !e->phase && l->index[i] == before && i + 1 < l->count,
    };
    for (int k = 0; k < OUTLINE_POINTS; k++) o.at[k] = e->pose.origin;
    if (sgt_is_sag(e->surface)) {
        sgt_part p = sgt_part_in_use(e, &l->surface[i], met, all);
        draw_sag(&o, e, v, &p);
        return o;
    }
    draw_body(&o, e, v, sgt_half_height(e, &l->surface[i], met, all));
    return o;
}

sgt_vec3 outline_corner(const outline *o, int side, double half)
{
    return vector_along(o->at[side ? OUTLINE_POINTS - 1 : 0], o->up, (side ? 1 : -1) * (half - o->half));
}
