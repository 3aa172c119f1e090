/* outline.c - finds the shape of an element, by asking the library for its sag and its apertures.
 *
 * THE PART IN USE of a sag is a closed line about a middle in its own x, y: its rim.  It is
 *
 *   - the first aperture that does not obscure: beside the axis, of a mirror, or without a semi_diameter; no
 *     side of it is farther out than a semi_diameter
 *   - else the circle of semi_diameter, or else of what the file gives for drawings
 *   - where the file gives nothing, what the rays that met it show: a circle about the axis, or an ellipse
 *     about them, if they meet a mirror clear of its axis
 *
 * A SECTION is a straight line in x, y through that middle.  In a plane of the picture it is the line that
 * lies in the plane, in the element's own frame; so a cylinder that is turned by 90 degrees shows its other
 * profile.  It is cut where an aperture begins to clip, or the surface ends:
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
#include "../show/profile.h"

#include <math.h>

/* a surface without a clear aperture is drawn so many times as wide as the rays */
static const double BEYOND_RAYS = 1.1;
/* the sine of an angle to the plane of the picture below which an element's rim is not drawn */
static const double OUT_OF_PLANE = 0.02;

/* steps of a section that is looked through for clipped parts; points of a piece are STRIDE of them apart */
enum { CUT_STEPS = 1024, STRIDE = 16, ALL_ROUND = RIM_POINTS };

typedef struct part {
    sgt_vec2 middle, rim[RIM_POINTS];
    const sgt_aperture_item *item; /* whose edge it is; NULL: none */
} part;

/* ---------------------------------------------------------- the part in use */

static sgt_vec3 on_surface(const sgt_element *e, double x, double y)
{
    return (sgt_vec3){x, y, profile_sag(e, x, y)};
}

static part part_ellipse(sgt_vec2 middle, double half_x, double half_y)
{
    const double step = 8 * atan(1) / ALL_ROUND;
    part p = {.middle = middle};
    for (int k = 0; k < ALL_ROUND; k++)
        p.rim[k] = (sgt_vec2){middle.x + half_x * cos(k * step), middle.y + half_y * sin(k * step)};
    return p;
}

/* The largest radius up to `wanted` at which the surface exists on all sides, by bisection. */
static double whole_radius(const sgt_element *e, double wanted)
{
    double low = 0, high = wanted;
    for (int i = 0; i < 40; i++) {
        double r = i ? (low + high) / 2 : high;
        bool fine = !isnan(profile_sag(e, 0, r) + profile_sag(e, 0, -r) + profile_sag(e, r, 0) +
                           profile_sag(e, -r, 0));
        if (fine && i == 0) return high;
        if (fine)
            low = r;
        else
            high = r;
    }
    return low;
}

/* The point at k of ALL_ROUND steps round a polygon, of which each side has the same number of steps. */
static sgt_vec2 round_polygon(const sgt_vec2 *corner, size_t count, int k)
{
    double u = (double)k * (double)count / ALL_ROUND;
    size_t side = (size_t)u;
    sgt_vec2 a = corner[side % count], b = corner[(side + 1) % count];
    u -= (double)side;
    return (sgt_vec2){a.x + u * (b.x - a.x), a.y + u * (b.y - a.y)};
}

/* The edge of an item of an aperture; sides without end are as far out as `most`.  inner: of an annulus. */
static part part_of_item(const sgt_aperture_item *item, double most, bool inner)
{
    const double step = 8 * atan(1) / ALL_ROUND, turn = item->degrees * atan(1) / 45, c = cos(turn),
                 s = sin(turn);
    bool disc = item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS;
    double r = fmin(inner ? item->inner : item->radius, most);
    sgt_vec2 half = disc ? (sgt_vec2){r, r} : (sgt_vec2){fmin(item->half.x, most), fmin(item->half.y, most)};
    const sgt_vec2 box[] = {{half.x, half.y}, {-half.x, half.y}, {-half.x, -half.y}, {half.x, -half.y}};
    part p = {.middle = item->centre, .item = item};
    for (int k = 0; k < ALL_ROUND; k++) {
        sgt_vec2 at = item->shape == SGT_POLYGON ? round_polygon(item->vertices, item->count, k)
                      : item->shape == SGT_RECTANGLE
                          ? round_polygon(box, 4, k)
                          : (sgt_vec2){half.x * cos(k * step), half.y * sin(k * step)};
        p.rim[k] = (sgt_vec2){item->centre.x + c * at.x - s * at.y, item->centre.y + s * at.x + c * at.y};
    }
    return p;
}

/* The first item that lets light through its inside; NULL: there is none. */
static const sgt_aperture_item *opening(const sgt_element *e)
{
    for (size_t i = 0; e->aperture && i < e->aperture->count; i++) {
        const sgt_aperture_item *item = &e->aperture->items[i];
        if (!item->obscuring && item->shape != SGT_SPIDER) return item;
    }
    return NULL;
}

/* The farthest that a side of finite items is from the axis; for sides without end. */
static double item_size(const sgt_aperture_item *item)
{
    double size = hypot(item->centre.x, item->centre.y), most = 0;
    const double sides[] = {item->radius, item->half.x, item->half.y};
    if (item->shape == SGT_POLYGON)
        for (size_t k = 0; k < item->count; k++)
            most = fmax(most, hypot(item->vertices[k].x, item->vertices[k].y));
    for (int k = 0; item->shape != SGT_POLYGON && k < 3; k++)
        if (isfinite(sides[k])) most = fmax(most, sides[k]);
    return size + most;
}

double outline_known(const job *j, size_t i)
{
    const sgt_element *e = &j->element[i];
    const sgt_aperture_item *item = opening(e);
    double size = item ? item_size(item) : 0;
    if (e->semi_diameter > 0 && e->semi_diameter < 0x1p500) return e->semi_diameter;
    return size > 0 ? size : j->lens.surface[i].size;
}

/* Are the rays that met an element clear of its axis, by more than the half of their width? */
static bool clear_of_axis(const reach *met, sgt_vec2 *middle, sgt_vec2 *half)
{
    *middle = (sgt_vec2){(met->low.x + met->high.x) / 2, (met->low.y + met->high.y) / 2};
    *half = (sgt_vec2){(met->high.x - met->low.x) / 2, (met->high.y - met->low.y) / 2};
    double size = fmax(half->x, half->y);
    *half = (sgt_vec2){fmax(half->x, size / 2), fmax(half->y, size / 2)}; /* a fan has no width */
    return size > 0 && hypot(middle->x, middle->y) > 2 * size;
}

static part part_in_use(const job *j, size_t i, const reach *met, double all)
{
    const sgt_element *e = &j->element[i];
    const sgt_aperture_item *item = opening(e);
    double known = outline_known(j, i);
    bool beside = item && (item->centre.x != 0 || item->centre.y != 0), mirror = j->lens.surface[i].mirror;
    sgt_vec2 middle, half;
    if (item && (beside || mirror || !(e->semi_diameter > 0)))
        return part_of_item(item, known > 0 ? known : all, false);
    if (known == 0 && mirror && clear_of_axis(met, &middle, &half))
        return part_ellipse(middle, BEYOND_RAYS * half.x, BEYOND_RAYS * half.y);
    double radius = known > 0 ? known : met->radius > 0 ? BEYOND_RAYS * met->radius : all;
    radius = whole_radius(e, radius);
    return part_ellipse((sgt_vec2){0, 0}, radius, radius);
}

/* The largest stretch of the line middle + t u inside the rim: from *low to *high, if the rim crosses the
 * line. */
static bool part_along(const part *p, sgt_vec2 u, double *low, double *high)
{
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (int k = 0; k < ALL_ROUND; k++) {
        sgt_vec2 a = p->rim[k], b = p->rim[(k + 1) % ALL_ROUND];
        double f = u.x * (a.y - p->middle.y) - u.y * (a.x - p->middle.x);
        double g = u.x * (b.y - p->middle.y) - u.y * (b.x - p->middle.x);
        if ((f > 0) == (g > 0) || !isfinite(f + g)) continue;
        double w = f / (f - g);
        double t = u.x * (a.x + w * (b.x - a.x) - p->middle.x) + u.y * (a.y + w * (b.y - a.y) - p->middle.y);
        *low = fmin(*low, t), *high = fmax(*high, t);
    }
    return *low < *high;
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
static void add_rim(outline *o, const sgt_element *e, const part *p, piece_kind kind)
{
    sgt_vec3 *to = add_piece(o, kind, ALL_ROUND + 1);
    for (int k = 0; k <= ALL_ROUND; k++) {
        sgt_vec2 at = p->rim[k % ALL_ROUND];
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
static void add_items(outline *o, const sgt_element *e, const part *rim)
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
            part edge = part_of_item(item, most, inner);
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
    sgt_vec3(*own)[2] = NULL;
    size_t more = profile_section(e, size, across, along, &own);
    o->stroke = memory_grow(o->stroke, o->strokes + more + 1, sizeof *o->stroke);
    for (size_t i = 0; i < more; i++, o->strokes++)
        for (int k = 0; k < 2; k++) o->stroke[o->strokes][k] = frame_point_out(&e->pose, own[i][k]);
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
static void draw_sag(outline *o, const sgt_element *e, const view_axes *v, const part *p)
{
    sgt_vec2 u = section_direction(v, &e->pose);
    double low, high;
    if (!part_along(p, u, &low, &high)) return;
    for (int k = 0; k < OUTLINE_POINTS; k++) {
        double t = low + (high - low) * k / (OUTLINE_POINTS - 1);
        o->at[k] = frame_point_out(&e->pose, on_surface(e, p->middle.x + t * u.x, p->middle.y + t * u.y));
    }
    for (int k = 0; k < ALL_ROUND; k++)
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
    if (part_along(p, other, &low, &high)) add_section(o, e, p->middle, other, low, high, PIECE_FINE);
    add_items(o, e, p);
}

outline outline_of(const job *j, const view_axes *v, size_t i, const reach *met, double all, double back)
{
    const lens *l = &j->lens;
    const sgt_element *e = &j->element[i];
    double before = i ? l->index[i - 1] : l->index_before;
    bool mirror = l->surface[i].mirror;
    outline o = {
        .ahead = frame_direction_out(&e->pose, (sgt_vec3){0, 0, 1}), .mirror = mirror,
        .stop = l->of->stop_marked && l->of->stop == i, .back = back,
        .lens = e->phase ? copysign(1, e->phase->focal_length) : 0,
        .dummy = !mirror && !e->phase && l->index[i] == before && i + 1 < l->count,
    };
    for (int k = 0; k < OUTLINE_POINTS; k++) o.at[k] = e->pose.origin;
    if (sgt_is_sag(e->surface)) {
        part p = part_in_use(j, i, met, all);
        draw_sag(&o, e, v, &p);
        return o;
    }
    double known = outline_known(j, i);
    draw_body(&o, e, v, known > 0 ? known : met->radius > 0 ? BEYOND_RAYS * met->radius : all);
    return o;
}

sgt_vec3 outline_corner(const outline *o, int side, double half)
{
    return vector_along(o->at[side ? OUTLINE_POINTS - 1 : 0], o->up, (side ? 1 : -1) * (half - o->half));
}
