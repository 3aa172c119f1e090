// SPDX-License-Identifier: MIT
/* part.c - the part of a sag that is in use: the edge of an aperture, or what rays show.  shape.h says
 * which. */
#include <sagitta/shape.h>

#include <math.h>

/* a surface without a clear aperture is taken to be so many times as wide as the rays */
static const double BEYOND_RAYS = 1.1;

static sgt_part ellipse(sgt_vec2 middle, double half_x, double half_y)
{
    const double step = 8 * atan(1) / SGT_RIM_POINTS;
    sgt_part p = {.middle = middle};
    for (int k = 0; k < SGT_RIM_POINTS; k++)
        p.rim[k] = (sgt_vec2){middle.x + half_x * cos(k * step), middle.y + half_y * sin(k * step)};
    return p;
}

/* The point at k of SGT_RIM_POINTS steps round a polygon.  Sides have the same number of steps, or one more;
 * so corners are points, if there are no more than SGT_RIM_POINTS. */
static sgt_vec2 round_polygon(const sgt_vec2 *corner, size_t count, int k)
{
    size_t side = (size_t)k * count / SGT_RIM_POINTS,
           first = (side * SGT_RIM_POINTS + count - 1) / count,
           next = ((side + 1) * SGT_RIM_POINTS + count - 1) / count;
    sgt_vec2 a = corner[side % count], b = corner[(side + 1) % count];
    double u = next > first ? (double)((size_t)k - first) / (double)(next - first) : 0;
    return (sgt_vec2){a.x + u * (b.x - a.x), a.y + u * (b.y - a.y)};
}

sgt_part sgt_part_of_item(const sgt_aperture_item *item, double most, bool inner)
{
    const double step = 8 * atan(1) / SGT_RIM_POINTS, turn = item->degrees * atan(1) / 45, c = cos(turn),
                 s = sin(turn);
    bool disc = item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS;
    double r = fmin(inner ? item->inner : item->radius, most);
    sgt_vec2 half = disc ? (sgt_vec2){r, r} : (sgt_vec2){fmin(item->half.x, most), fmin(item->half.y, most)};
    const sgt_vec2 box[] = {{half.x, half.y}, {-half.x, half.y}, {-half.x, -half.y}, {half.x, -half.y}};
    sgt_part p = {.middle = item->centre, .item = item};
    for (int k = 0; k < SGT_RIM_POINTS; k++) {
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

double sgt_half_height(const sgt_element *e, const sgt_lens_surface *given, const sgt_footprint *met,
                       double otherwise)
{
    const sgt_aperture_item *item = opening(e);
    double size = item ? item_size(item) : 0;
    if (e->semi_diameter > 0 && e->semi_diameter < 0x1p500) return e->semi_diameter;
    if (size > 0) return size;
    if (given && given->size > 0) return given->size;
    return met && met->radius > 0 ? BEYOND_RAYS * met->radius : otherwise;
}

/* Are the rays that met an element clear of its axis, by more than the half of their width? */
static bool clear_of_axis(const sgt_footprint *met, sgt_vec2 *middle, sgt_vec2 *half)
{
    *middle = (sgt_vec2){(met->low.x + met->high.x) / 2, (met->low.y + met->high.y) / 2};
    *half = (sgt_vec2){(met->high.x - met->low.x) / 2, (met->high.y - met->low.y) / 2};
    double size = fmax(half->x, half->y);
    *half = (sgt_vec2){fmax(half->x, size / 2), fmax(half->y, size / 2)}; /* a fan has no width */
    return size > 0 && hypot(middle->x, middle->y) > 2 * size;
}

sgt_part sgt_part_in_use(const sgt_element *e, const sgt_lens_surface *given, const sgt_footprint *met,
                         double otherwise)
{
    const sgt_aperture_item *item = opening(e);
    bool beside = item && (item->centre.x != 0 || item->centre.y != 0), mirror = given && given->mirror;
    sgt_vec2 middle, half;
    if (item && (beside || mirror || !(e->semi_diameter > 0)))
        return sgt_part_of_item(item, sgt_half_height(e, given, NULL, otherwise), false);
    if (mirror && met && sgt_half_height(e, given, NULL, 0) == 0 && clear_of_axis(met, &middle, &half))
        return ellipse(middle, BEYOND_RAYS * half.x, BEYOND_RAYS * half.y);
    double radius = sgt_whole_radius(e->surface, sgt_half_height(e, given, met, otherwise));
    return ellipse((sgt_vec2){0, 0}, radius, radius);
}

bool sgt_part_along(const sgt_part *p, sgt_vec2 u, double *low, double *high)
{
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (int k = 0; k < SGT_RIM_POINTS; k++) {
        sgt_vec2 a = p->rim[k], b = p->rim[(k + 1) % SGT_RIM_POINTS];
        double f = u.x * (a.y - p->middle.y) - u.y * (a.x - p->middle.x);
        double g = u.x * (b.y - p->middle.y) - u.y * (b.x - p->middle.x);
        if ((f > 0) == (g > 0) || !isfinite(f + g)) continue;
        double w = f / (f - g);
        double t = u.x * (a.x + w * (b.x - a.x) - p->middle.x) + u.y * (a.y + w * (b.y - a.y) - p->middle.y);
        *low = fmin(*low, t), *high = fmax(*high, t);
    }
    return *low < *high;
}
