// SPDX-License-Identifier: MIT
/* aim_rims.c - bounds on the launch rays of a family that the rims in front let through (aim.h).
 *
 * A launch ray is straight up to the first element that bends it.  So each element up to that one tells
 * where the LINE of the ray runs: through the points of its surface that its rim and its aperture let
 * through.  Let p be in a box that holds these.  With one origin o = b.o and q = p - o,
 * d + u du + v dv is along q, so
 *
 *     u = q . (dv x d) / q . (du x dv),    v = q . (d x du) / q . (du x dv).
 *
 * With one direction d = b.d and q = p - b.o, u ou + v ov is q but for a part along d, so
 *
 *     u = q . (ov x d) / ou . (ov x d),    v = q . (d x ou) / ov . (d x ou).
 *
 * In intervals these are bounds.  The stop has no rim here, but a point that has to be met.
 *
 * THE BOX.  x and y are within the least of the rims (aperture, surface, edge of the conic base); z is in
 * the sag over that circle (bundle_sag.c).  Rims are soft, axes are orthonormal to 2^-50 only, and what
 * bends no ray moves its points by roundings: SLACK of all sizes is more. */
#include "bundle.h"

#define SLACK 0x1p-40

typedef struct box3 { sgt_interval x, y, z; } box3;

static box3 box_around(sgt_vec3 a)
{
    return (box3){sgt_interval_of(a.x), sgt_interval_of(a.y), sgt_interval_of(a.z)};
}

static sgt_interval box_dot(box3 a, box3 b)
{
    return sgt_interval_sum(sgt_interval_product(a.x, b.x),
                            sgt_interval_sum(sgt_interval_product(a.y, b.y), sgt_interval_product(a.z, b.z)));
}

static sgt_interval minor(double a, double b, double c, double d) /* a d - b c */
{
    return sgt_interval_difference(sgt_interval_product(sgt_interval_of(a), sgt_interval_of(d)),
                                   sgt_interval_product(sgt_interval_of(b), sgt_interval_of(c)));
}

static box3 box_cross(sgt_vec3 a, sgt_vec3 b)
{
    return (box3){minor(a.y, a.z, b.y, b.z), minor(a.z, a.x, b.z, b.x), minor(a.x, a.y, b.x, b.y)};
}

/* The farthest in x and in y that an item lets through; HUGE_VAL: no bound. */
static double item_reach(const sgt_aperture_item *i)
{
    double most = HUGE_VAL;
    if (i->obscuring) return most;
    if (i->shape == SGT_CIRCLE || i->shape == SGT_ANNULUS) most = i->radius;
    if (i->shape == SGT_RECTANGLE || i->shape == SGT_ELLIPSE) most = i->half.x + i->half.y;
    if (i->shape == SGT_POLYGON) {
        most = 0;
        for (size_t k = 0; k < i->count; k++)
            most = larger(most, fabs(i->vertices[k].x) + fabs(i->vertices[k].y));
    }
    return most + fabs(i->centre.x) + fabs(i->centre.y);
}

static double reach_of(const sgt_element *e)
{
    double most = is_open(e->semi_diameter) ? HUGE_VAL : e->semi_diameter;
    for (size_t k = 0; e->aperture && k < e->aperture->count; k++) {
        double reach = item_reach(&e->aperture->items[k]);
        if (reach < most) most = reach;
    }
    return most;
}

/* The points of element i that a ray may go through, in global axes.  false: nothing bounds them. */
static bool points_met(const aim_task *task, size_t i, box3 *out)
{
    const sgt_element *e = &task->e[i];
    double reach = reach_of(e);
    box3 p;
    if (i == task->stop) reach = (fabs(task->wanted.x) + fabs(task->wanted.y)) * (1 + SLACK) + FORM_LEAST;
    if (!sgt_bundle_sag_points(in_set(e->surface), reach * (1 + SLACK), &p.x, &p.z)) return false;
    p.y = p.x;
    if (i == task->stop) p.x = sgt_interval_of(task->wanted.x), p.y = sgt_interval_of(task->wanted.y);
    const sgt_pose *pose = &e->pose;
    const double size = sgt_interval_greatest(p.x) + sgt_interval_greatest(p.y) + sgt_interval_greatest(p.z) +
                        absolute(pose->origin) + absolute(task->beam->o);
    if (!(size < 0x1p500)) return false;
    if (is_turned(pose)) {
        const sgt_vec3 ex = pose->ex, ey = pose->ey, ez = pose->ez;
        const box3 q = p;
        p = (box3){box_dot(q, box_around((sgt_vec3){ex.x, ey.x, ez.x})),
                   box_dot(q, box_around((sgt_vec3){ex.y, ey.y, ez.y})),
                   box_dot(q, box_around((sgt_vec3){ex.z, ey.z, ez.z}))};
    }
    const sgt_interval off = {-SLACK * size - FORM_LEAST, SLACK * size + FORM_LEAST};
    const box3 to = box_around(pose->origin);
    out->x = sgt_interval_sum(sgt_interval_sum(p.x, to.x), off);
    out->y = sgt_interval_sum(sgt_interval_sum(p.y, to.y), off);
    out->z = sgt_interval_sum(sgt_interval_sum(p.z, to.z), off);
    return true;
}

/* All w with y w = x for some x and y of theirs: any w if both may be 0. */
static sgt_interval multiple(sgt_interval x, sgt_interval y)
{
    const bool any = x.lo <= 0 && x.hi >= 0 && y.lo <= 0 && y.hi >= 0;
    return any ? sgt_interval_all() : sgt_interval_quotient(x, y);
}

/* Cuts u and v down to the rays whose line meets the box. */
static void lines_through(const sgt_beam *b, box3 p, sgt_interval *u, sgt_interval *v)
{
    const box3 o = box_around(b->o);
    const box3 q = {sgt_interval_difference(p.x, o.x), sgt_interval_difference(p.y, o.y),
                    sgt_interval_difference(p.z, o.z)};
    sgt_interval by_u, by_v, at_u, at_v;
    if (is_zero(b->ou) && is_zero(b->ov)) {
        by_u = by_v = box_dot(q, box_cross(b->du, b->dv));
        at_u = box_dot(q, box_cross(b->dv, b->d)), at_v = box_dot(q, box_cross(b->d, b->du));
    } else {
        const box3 across_u = box_cross(b->ov, b->d), across_v = box_cross(b->d, b->ou);
        by_u = box_dot(box_around(b->ou), across_u), by_v = box_dot(box_around(b->ov), across_v);
        at_u = box_dot(q, across_u), at_v = box_dot(q, across_v);
    }
    *u = sgt_interval_intersection(*u, multiple(at_u, by_u));
    *v = sgt_interval_intersection(*v, multiple(at_v, by_v));
}

bool sgt_beam_bounds(size_t stop, const sgt_element e[], double index_before, const sgt_beam *beam,
                     sgt_vec2 wanted, sgt_interval *u, sgt_interval *v)
{
    const aim_task task = {.stop = stop, .e = e, .index_before = index_before, .beam = beam,
                           .wanted = wanted};
    const bool from_point = is_zero(beam->ou) && is_zero(beam->ov),
               along = is_zero(beam->du) && is_zero(beam->dv);
    double index = index_before == 0 ? 1 : index_before;
    *u = *v = sgt_interval_all();
    for (size_t i = 0; i <= stop && from_point != along; i++) {
        box3 p;
        if (!is_plain(&e[i]) || !is_aperture_sound(&e[i]) || !is_sound(&e[i], index)) break;
        if (points_met(&task, i, &p)) lines_through(beam, p, u, v);
        const double behind = index_behind(&e[i], index);
        if (e[i].phase || bending_of(index, behind, e[i].index == SGT_MIRROR).kind != STRAIGHT) break;
        index = behind;
    }
    if (sgt_interval_is_empty(*u) || sgt_interval_is_empty(*v)) {
        *u = *v = sgt_interval_empty();
        return true;
    }
    return isfinite(u->lo) && isfinite(u->hi) && isfinite(v->lo) && isfinite(v->hi);
}
