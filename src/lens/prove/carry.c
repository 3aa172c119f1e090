// SPDX-License-Identifier: MIT
/* carry.c - a box of the pupil through the lens (beam.h), and what is bounded of its rays.
 *
 * WHERE THEY START is what launch.c of optics does to one point, with models in place of numbers: vignetting,
 * then a ray from the object through the pupil, or from the wavefront, or of the cone.
 *
 * WHERE THEY END is judged as spot.c and wavefront.c of study do: distances from the chief ray, and
 *
 *     OPD = L - L0 + n (h^2 / (R + sqrt(R^2 - h^2)) - b),   b = v . d,   h^2 = |v - b d|^2,   v = p - c.
 *
 * The point p may be any of the ray: it is that in front of the last element (p, L), where rests have not
 * been
 * carried all the way to the image.  There b is about -V, V = |v|, and a product v . d would have the rest of
 * d
 * V times.  But d is of unit length, and so is e = -+v / V, the direction to or from c; so with q = d - e,
 * which is small as the ray nearly goes through c,
 *
 *     d . e = 1 - q^2 / 2,   b = -+ V (1 - q^2 / 2),   h^2 = V^2 q^2 (1 - q^2 / 4).
 *
 * The rest of d comes in times q only.  The slopes of L and of n b are large and cancel in the models, number
 * by number; what is left is of the size of the aberrations, and the rests.
 *
 * OF A BOX THAT IS CUT at the edge of an aperture, some rays pass and some do not.  It is carried once more
 * through a lens whose apertures are wider (WIDER_EDGES) and have no items.  If all its rays pass that, the
 * bounds
 * hold for those that pass the lens itself, for these go the same way: each meets each surface inside the
 * clear aperture a, at a root that is the only one inside the wider one.  (beam.h has that of all sags but
 * conics.  Of these it takes the near root, whatever the other is; but sgt_trace takes the other one, if that
 * is
 * inside a and the near one is not.  Let the near roots have r <= R.  On a chord of the cylinder r <= R the
 * slope of F = z - s is n - grad s . (l, m).  If |n| > S |(l, m)|, S the largest slope of s there, F is
 * monotone,
 * and there is one root at most.)  Otherwise all that is known of it is that rays which pass end inside the
 * clear
 * aperture of the last element, and meet each element inside its own. */
#include "carry.h"

#include <sagitta/surfaces.h>

static const double WIDER_EDGES = 1.0625;

/* All rays of a box: those of beam.h, and p, d and opl in front of the last element, in its frame. */
typedef struct ends { sgt_box_end end; sgt_model p[3], d[3], opl; } ends;

struct carry_room {
    sgt_box_room *kept, *kept_wide;   /* [count] each */
    sgt_box_at *at;
    sgt_element *wide;
    sgt_passage *passages;
    bool front_known;                 /* the last element bends nothing */
    double index;                     /* in front of it */
};

carry_room *sgt_carry_room_new(const prove_cell *of)
{
    const size_t n = of->count;
    carry_room *r = sgt_launch_take(of->from, 1, sizeof *r);
    if (!r) return NULL;
    *r = (carry_room){.kept = sgt_launch_take(of->from, 2 * n, sizeof *r->kept),
                      .at = sgt_launch_take(of->from, n, sizeof *r->at),
                      .wide = sgt_launch_take(of->from, n, sizeof *r->wide),
                      .passages = sgt_launch_take(of->from, n, sizeof *r->passages)};
    if (!r->kept || !r->at || !r->wide || !r->passages) {
        sgt_carry_room_free(of, r);
        return NULL;
    }
    r->kept_wide = r->kept + n;
    for (size_t i = 0; i < 2 * n; i++) r->kept[i] = (sgt_box_room){{0}};
    for (size_t i = 0; i < n; i++) {
        r->wide[i] = of->e[i], r->wide[i].aperture = NULL;
        r->wide[i].semi_diameter *= WIDER_EDGES;
    }
    double index = of->before == 0 ? 1 : of->before;
    for (size_t i = 0; i + 1 < n; i++)
        if (of->e[i].index != SGT_MIRROR && of->e[i].index != 0) index = of->e[i].index;
    r->index = index, r->front_known = of->e[n - 1].index == 0 || of->e[n - 1].index == index;
    return r;
}

void sgt_carry_room_free(const prove_cell *of, carry_room *r)
{
    if (!r) return;
    sgt_launch_forget(of->from, r->kept), sgt_launch_forget(of->from, r->at);
    sgt_launch_forget(of->from, r->wide), sgt_launch_forget(of->from, r->passages);
    sgt_launch_forget(of->from, r);
}

/* ------------------------------------------------------------------------ the launch */

/* x k + y */
static sgt_model plus_scaled(const sgt_model *x, double k, const sgt_model *y)
{
    sgt_model scaled, sum;
    sgt_model_scaled(x, k, &scaled);
    sgt_model_sum(&scaled, y, &sum);
    return sum;
}

/* k x + by */
static sgt_model line(const sgt_model *x, double k, double by)
{
    sgt_model out;
    sgt_model_scaled(x, k, &out);
    sgt_model_plus(&out, by, &out);
    return out;
}

static sgt_box_launch launch_of(const sgt_field_beam *b, const sector *of)
{
    sgt_box_launch l = {.parameters = 2};
    sgt_model x, y, u, v;
    sgt_sector_models(of, &x, &y);
    x = line(&x, b->scale.x, b->shift.x), y = line(&y, b->scale.y, b->shift.y);
    u = x, v = y;
    if (b->turn.y != 0 || b->turn.x != 1) {
        const sgt_model cy = line(&y, -b->turn.y, 0), cx = line(&y, b->turn.x, 0);
        u = plus_scaled(&x, b->turn.x, &cy), v = plus_scaled(&x, b->turn.y, &cx);
    }
    if (b->cone > 0 || b->finite) {
        /* light runs along +z even if the pupil lies in front of the object */
        const sgt_vec3 o = b->object;
        const double ahead = b->cone > 0 ? 1 : copysign(1, b->pupil - o.z);
        l.o[0] = sgt_model_of(o.x), l.o[1] = sgt_model_of(o.y), l.o[2] = sgt_model_of(o.z);
        l.d[0] = b->cone > 0 ? line(&u, b->cone, 0) : line(&u, ahead * b->radius, -ahead * o.x);
        l.d[1] = b->cone > 0 ? line(&v, b->cone, 0) : line(&v, ahead * b->radius, -ahead * o.y);
        l.d[2] = sgt_model_of(b->pupil);
        sgt_model_plus(&l.d[2], -o.z, &l.d[2]), sgt_model_scaled(&l.d[2], ahead, &l.d[2]);
        if (b->cone > 0) l.d[2] = sgt_model_of(1);
        return l;
    }
    /* p + (wave - p . d) d */
    const sgt_vec3 d = b->direction;
    const sgt_model px = line(&u, b->radius, 0), py = line(&v, b->radius, 0), pz = sgt_model_of(b->pupil);
    sgt_model s = line(&px, -d.x, b->wave);
    s = plus_scaled(&py, -d.y, &s), s = plus_scaled(&pz, -d.z, &s);
    l.o[0] = plus_scaled(&s, d.x, &px), l.o[1] = plus_scaled(&s, d.y, &py);
    l.o[2] = plus_scaled(&s, d.z, &pz);
    l.d[0] = sgt_model_of(d.x), l.d[1] = sgt_model_of(d.y), l.d[2] = sgt_model_of(d.z);
    return l;
}

/* ------------------------------------------------------------------------- the ends */

static sgt_model dot_model(const sgt_model a[3], const sgt_model b[3])
{
    sgt_model sum = sgt_model_of(0), product;
    for (int k = 0; k < 3; k++) sgt_model_product(&a[k], &b[k], &product), sgt_model_sum(&sum, &product,
            &sum);
    return sum;
}

static sgt_model dot_fixed(const sgt_model a[3], sgt_vec3 b)
{
    const double by[3] = {b.x, b.y, b.z};
    sgt_model sum = sgt_model_of(0);
    for (int k = 0; k < 3; k++) sum = plus_scaled(&a[k], by[k], &sum);
    return sum;
}

static void rest_more(sgt_model *m, double by) { m->rest = sgt_sum_above(m->rest, by); }

/* The arc tangent of a small model, times 1000: q - q^3 atan's own rest, |atan q - q + q^3 / 3| <= |q|^5 / 5.
 * */
static sgt_model milli_angle(const sgt_model *q)
{
    const double most = sgt_interval_greatest(sgt_model_range(q)), square = sgt_product_above(most, most);
    sgt_model cube, out;
    if (!(most <= 0.5)) {
        const sgt_interval all = sgt_interval_arc_tangent(sgt_model_range(q));
        out = sgt_model_between(all);
    } else {
        sgt_model_product(q, q, &cube), sgt_model_product(&cube, q, &cube);
        out = plus_scaled(&cube, -1.0 / 3, q);
        rest_more(&out, sgt_product_above(sgt_product_above(square, square), most) / 5 * (1 + 0x1p-50) +
                        sgt_product_above(square, most) * 0x1p-52);
    }
    sgt_model_scaled(&out, 1e3, &out);
    return out;
}

/* Distances from the reference; afocal: angles in milliradians, as sgt_ends_as_angles has them. */
static void errors_of(const prove_cell *c, const sgt_box_end *end, sgt_model *ex, sgt_model *ey)
{
    const sgt_vec3 at = c->reference;
    if (!c->afocal) {
        *ex = end->p[0], *ey = end->p[1];
        sgt_model_plus(ex, -at.x, ex), sgt_model_plus(ey, -at.y, ey);
        return;
    }
    const sgt_vec3 y = unit3(cross3(at, (sgt_vec3){1, 0, 0})), x = cross3(y, at);
    sgt_model off[3] = {end->d[0], end->d[1], end->d[2]};
    sgt_model ahead = dot_fixed(end->d, at), by;
    sgt_model_plus(&off[0], -at.x, &off[0]), sgt_model_plus(&off[1], -at.y, &off[1]);
    sgt_model_plus(&off[2], -at.z, &off[2]);
    sgt_model_inverse(&ahead, &by);
    sgt_model along_x = dot_fixed(off, x), along_y = dot_fixed(off, y);
    sgt_model_product(&along_x, &by, ex), sgt_model_product(&along_y, &by, ey);
    *ex = milli_angle(ex), *ey = milli_angle(ey);
    rest_more(ex, 0x1p-40), rest_more(ey, 0x1p-40); /* x and y are unit vectors to rounding */
}

/* d . e less 1, of the unit vectors d and e: -q^2 / 2, q = d - e; *square: q^2. */
static sgt_model less_than_one(const sgt_model d[3], const sgt_model e[3], sgt_model *square)
{
    sgt_model q[3], out;
    for (int k = 0; k < 3; k++) sgt_model_difference(&d[k], &e[k], &q[k]);
    *square = dot_model(q, q);
    sgt_model_scaled(square, -0.5, &out);
    return out;
}

/* b and h^2 of the head, of v = p - c and d. */
static void foot_of(const sgt_model v[3], const sgt_model d[3], sgt_model *b, sgt_model *h2)
{
    sgt_model V = dot_model(v, v), by, e[3], q2, less, quarter, V2 = V;
    const double sign = v[0].c * d[0].c + v[1].c * d[1].c + v[2].c * d[2].c < 0 ? -1 : 1;
    sgt_model_root(&V, &V), sgt_model_inverse(&V, &by), sgt_model_scaled(&by, sign, &by);
    for (int k = 0; k < 3; k++) sgt_model_product(&v[k], &by, &e[k]);
    less = less_than_one(d, e, &q2);
    sgt_model_product(&V, &less, b), sgt_model_sum(b, &V, b), sgt_model_scaled(b, sign, b);
    sgt_model_scaled(&q2, -0.25, &quarter), sgt_model_plus(&quarter, 1, &quarter);
    sgt_model_product(&V2, &q2, h2), sgt_model_product(h2, &quarter, h2);
    if (isfinite(b->rest + h2->rest)) return;
    /* the point is at the centre itself */
    sgt_model across[3];
    *b = dot_model(v, d);
    for (int k = 0; k < 3; k++) {
        sgt_model_product(b, &d[k], &across[k]);
        sgt_model_difference(&v[k], &across[k], &across[k]);
    }
    *h2 = dot_model(across, across);
}

/* The path difference, in waves. */
static sgt_model difference_of(const prove_cell *c, const ends *w)
{
    const sgt_reference *of = &c->about;
    const double n = of->index, R = of->radius;
    sgt_model v[3] = {w->p[0], w->p[1], w->p[2]}, path = w->opl, add, b, h2;
    sgt_model_plus(&v[0], -of->centre.x, &v[0]), sgt_model_plus(&v[1], -of->centre.y, &v[1]);
    sgt_model_plus(&v[2], -of->centre.z, &v[2]);
    sgt_model_plus(&path, -of->opl, &path);
    if (of->kind == SGT_REFERENCE_PLANE) { /* v . d0 / d . d0 */
        const sgt_model above = dot_fixed(v, of->along),
                        fixed[3] = {sgt_model_of(of->along.x), sgt_model_of(of->along.y),
                                sgt_model_of(of->along.z)};
        sgt_model square, below = less_than_one(w->d, fixed, &square);
        rest_more(&below, 0x1p-50); /* the length of d0 is 1 to rounding */
        sgt_model_plus(&below, 1, &below), sgt_model_inverse(&below, &below);
        sgt_model_product(&above, &below, &add), sgt_model_scaled(&add, -n, &add);
    } else {
        foot_of(v, w->d, &b, &h2);
        sgt_model_scaled(&b, -n, &add);
        if (of->kind == SGT_REFERENCE_SPHERE) {
            sgt_model root = line(&h2, -1, R * R);
            rest_more(&root, 0x1p-52 * R * R); /* R * R rounds */
            sgt_model_root(&root, &root), sgt_model_scaled(&root, copysign(1, R), &root);
            sgt_model_plus(&root, R, &root), sgt_model_inverse(&root, &root);
            sgt_model_product(&h2, &root, &h2);
            add = plus_scaled(&h2, n, &add);
        }
    }
    sgt_model_sum(&path, &add, &path);
    sgt_model_scaled(&path, c->waves, &path);
    rest_more(&path, c->waves * (of->opl_err + 4 * n * of->p_err) * (1 + 0x1p-40));
    return path;
}

static double degrees_above(sgt_interval cosine)
{
    const double DEGREES = 57.29577951308233; /* 180 / pi, above it */
    return sgt_product_above(sgt_interval_arc_cosine((sgt_interval){cosine.lo, cosine.lo}).hi, DEGREES);
}

/* Of the first so many elements, met as `used` has them: those of the lens, or of the wider one. */
static void bound_elements(const prove_cell *c, size_t count, const sgt_element *used, const sgt_box_at at[],
                           double bound[])
{
    for (size_t i = 0; i < count; i++) {
        const sgt_element *e = &c->e[i];
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        const bool items = e->aperture && e->aperture->count > 0;
        double high = sgt_interval_hypotenuse(at[i].x, at[i].y).hi, inside = HUGE_VAL;
        if (round) {
            high = fmin(high, (used[i].semi_diameter - at[i].margin.lo) * (1 + 0x1p-48));
            high = fmin(high, e->semi_diameter * (1 + 0x1p-40));
            inside = fmax(e->semi_diameter - high - 0x1p-50 * e->semi_diameter, 0);
        }
        if (items) inside = used[i].aperture ? fmin(inside, fmax(at[i].items, 0)) : 0; /* else not asked */
        bound[prove_at_element(i, Q_INCIDENCE)] = degrees_above(at[i].cosine);
        bound[prove_at_element(i, Q_INSIDE)] = round || items ? -inside : -HUGE_VAL;
        bound[prove_at_element(i, Q_HEIGHT)] = high;
    }
}

/* What holds of any ray that passes. */
static void bound_nothing(const prove_cell *c, const sgt_box_at at[], prove_box *box, double bound[])
{
    const double size = c->e[c->count - 1].semi_diameter, err = c->reference_err;
    const double x = fabs(c->reference.x), y = fabs(c->reference.y);
    const sgt_interval all = {-HUGE_VAL, HUGE_VAL};
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) bound[q] = HUGE_VAL;
    box->f = (sgt_interval){0, HUGE_VAL}, box->w = all, box->ww = box->f;
    if (size > 0 && size < 0x1p500 && !c->afocal && c->has_reference) {
        const double far = size * (1 + 0x1p-40) + err;
        bound[Q_EX] = sgt_sum_above(far, x), bound[Q_EY] = sgt_sum_above(far, y);
        bound[Q_SPOT] = sgt_sum_above(far, sgt_interval_hypotenuse(sgt_interval_of(x),
                sgt_interval_of(y)).hi);
        box->f.hi = sgt_product_above(bound[Q_SPOT], bound[Q_SPOT]);
    }
    for (size_t i = 0; i < c->count; i++) {
        const sgt_element *e = &c->e[i];
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        const bool items = e->aperture && e->aperture->count > 0;
        bound[prove_at_element(i, Q_INCIDENCE)] = 90;
        bound[prove_at_element(i, Q_INSIDE)] = round || items ? 0 : -HUGE_VAL;
        bound[prove_at_element(i, Q_HEIGHT)] = round ? e->semi_diameter * (1 + 0x1p-40) : HUGE_VAL;
    }
    bound_elements(c, box->element, c->e, at, bound); /* in front of where it is in doubt */
}

static sgt_interval square_range(const sgt_model *m, const sgt_model *squared)
{
    return sgt_interval_intersection(sgt_interval_square(sgt_model_range(m)), sgt_model_range(squared));
}

static void bound_ends(const prove_cell *c, const carry_room *r, const ends *of, prove_box *box,
                       double bound[])
{
    const sgt_interval all = {-HUGE_VAL, HUGE_VAL};
    box->f = box->ww = (sgt_interval){0, HUGE_VAL}, box->w = all;
    box->f_sum = box->w_sum = box->ww_sum = all;
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) bound[q] = HUGE_VAL;
    if (c->has_reference && !(c->afocal && !r->front_known)) {
        sgt_model ex, ey, xx, yy;
        const double err = c->afocal ? 1e3 * (c->reference_err + 0x1p-50) : c->reference_err;
        errors_of(c, &of->end, &ex, &ey);
        rest_more(&ex, err), rest_more(&ey, err);
        sgt_model_product(&ex, &ex, &xx), sgt_model_product(&ey, &ey, &yy);
        const sgt_interval x2 = square_range(&ex, &xx), y2 = square_range(&ey, &yy);
        sgt_model_sum(&xx, &yy, &xx);
        box->f = sgt_interval_intersection(sgt_interval_sum(x2, y2), sgt_model_range(&xx));
        box->f_sum = sgt_sector_integral(&box->of, &xx);
        bound[Q_EX] = sgt_interval_greatest(sgt_model_range(&ex));
        bound[Q_EY] = sgt_interval_greatest(sgt_model_range(&ey));
        bound[Q_SPOT] = sgt_square_root_above(box->f.hi);
    }
    if (c->has_opd && r->front_known) {
        sgt_model w = difference_of(c, of), ww;
        const sgt_interval range = sgt_model_range(&w);
        bound[Q_HIGH] = range.hi, bound[Q_LOW] = -range.lo;
        sgt_model_plus(&w, -c->middle, &w);
        sgt_model_product(&w, &w, &ww);
        box->w = sgt_model_range(&w), box->ww = square_range(&w, &ww);
        box->w_sum = sgt_sector_integral(&box->of, &w), box->ww_sum = sgt_sector_integral(&box->of, &ww);
    }
}

/* All rays end at one element; is it certain by what?  Those beyond an aperture may also miss the surface
 * there: they count as clipped. */
static int ended_by(const sgt_box_end *end)
{
    const unsigned clipped = 1u << SGT_CLIPPED, missed = 1u << SGT_MISSED;
    if (end->fate != SGT_LOST) return end->fate;
    return end->causes == (clipped | missed) ? SGT_CLIPPED : SGT_LOST;
}

/* Points and directions from one frame into another. */
static void moved(const sgt_pose *from, const sgt_pose *to, sgt_model p[3], sgt_model d[3])
{
    const sgt_vec3 o = from->origin, q = to->origin;
    const sgt_vec3 axis[3] = {from->ex, from->ey, from->ez};
    for (int point = 0; point < 2; point++) {
        sgt_model *m = point ? p : d, out[3];
        if (dot3(from->ex, from->ex) != 0) {
            const sgt_vec3 row[3] = {{axis[0].x, axis[1].x, axis[2].x}, {axis[0].y, axis[1].y, axis[2].y},
                                     {axis[0].z, axis[1].z, axis[2].z}};
            for (int k = 0; k < 3; k++) out[k] = dot_fixed(m, row[k]);
            for (int k = 0; k < 3; k++) m[k] = out[k];
        }
        if (point) {
            sgt_model_plus(&m[0], o.x, &m[0]), sgt_model_plus(&m[1], o.y, &m[1]);
            sgt_model_plus(&m[2], o.z, &m[2]);
            sgt_model_plus(&m[0], -q.x, &m[0]), sgt_model_plus(&m[1], -q.y, &m[1]);
            sgt_model_plus(&m[2], -q.z, &m[2]);
        }
        if (dot3(to->ex, to->ex) == 0) continue;
        out[0] = dot_fixed(m, to->ex), out[1] = dot_fixed(m, to->ey), out[2] = dot_fixed(m, to->ez);
        for (int k = 0; k < 3; k++) m[k] = out[k];
    }
    /* axes are orthonormal to 2^-50 only */
    for (int k = 0; k < 3; k++) rest_more(&d[k], 0x1p-48);
}

/* The box through all elements: first to the one in front of the last, then from there.  A ray of what the
 * models of the first part hold is a ray of the second part. */
static sgt_box_verdict carried_through(const prove_cell *c, const carry_room *r, const sgt_element *e,
        sgt_box_room *kept,
                               const sgt_box_launch *launch, ends *out)
{
    static const sgt_pose global;
    const size_t last = c->count - 1;
    sgt_box_lens lens = {.elements = c->count, .e = e, .index_before = c->before};
    if (last == 0) {
        const sgt_box_verdict only = sgt_box_trace(&lens, launch, kept, r->at, &out->end);
        if (only != SGT_BOX_PASSED) return only;
        sgt_model length = dot_model(launch->d, launch->d), by, unused[3];
        sgt_model_root(&length, &length), sgt_model_inverse(&length, &by);
        for (int k = 0; k < 3; k++) {
            unused[k] = out->p[k] = out->end.p[k];
            sgt_model_product(&launch->d[k], &by, &out->d[k]);
        }
        moved(&global, &e[0].pose, unused, out->d);
        out->opl = out->end.opl;
        return only;
    }
    lens.elements = last;
    const sgt_box_verdict first = sgt_box_trace(&lens, launch, kept, r->at, &out->end);
    if (first != SGT_BOX_PASSED) return first;
    sgt_box_launch then = {.parameters = 2};
    for (int k = 0; k < 3; k++) {
        out->p[k] = then.o[k] = out->end.p[k];
        out->d[k] = then.d[k] = out->end.d[k];
    }
    out->opl = out->end.opl;
    moved(&e[last - 1].pose, &global, then.o, then.d);
    moved(&e[last - 1].pose, &e[last].pose, out->p, out->d);
    lens = (sgt_box_lens){.elements = 1, .e = &e[last], .index_before = r->index};
    const sgt_box_verdict verdict = sgt_box_trace(&lens, &then, kept + last, r->at + last, &out->end);
    out->end.element += last;
    return verdict;
}

/* Rays that meet the conic e within r <= R, whose directions in its frame are d: is there one root only? */
static bool meets_once(const sgt_conic *q, double R, const sgt_model d[3])
{
    const sgt_interval n = sgt_interval_absolute(sgt_model_range(&d[2]));
    const sgt_interval l = sgt_model_range(&d[0]), m = sgt_model_range(&d[1]);
    const sgt_interval c = sgt_interval_of(fabs(q->c)), cr = sgt_interval_product(c, sgt_interval_of(R));
    const sgt_interval k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(q->k));
    const sgt_interval left = sgt_interval_difference(sgt_interval_of(1),
                                                      sgt_interval_product(k1, sgt_interval_square(cr)));
    if (q->c == 0) return true;
    if (!(left.lo > 0) || !(n.lo > 0)) return false;
    const sgt_interval slope = sgt_interval_quotient(cr, sgt_interval_square_root(left));
    return n.lo > sgt_interval_product(slope, sgt_interval_hypotenuse(l, m)).hi;
}

/* At each element of the wider lens where rays may be outside the clear aperture of the lens itself. */
static bool same_roots(const prove_cell *c, const carry_room *r, const sgt_box_launch *launch)
{
    static const sgt_pose global;
    for (size_t i = 0; i < c->count; i++) {
        const sgt_element *e = &c->e[i];
        const double R = sgt_interval_hypotenuse(r->at[i].x, r->at[i].y).hi;
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        if (e->surface.ops != &sgt_conic_ops || !round || R < e->semi_diameter * (1 - 0x1p-40)) continue;
        sgt_model p[3] = {launch->o[0], launch->o[1], launch->o[2]};
        sgt_model d[3] = {launch->d[0], launch->d[1], launch->d[2]};
        if (i > 0) {
            const sgt_box_lens before = {.elements = i, .e = r->wide, .index_before = c->before};
            sgt_box_end end;
            if (sgt_box_trace(&before, launch, r->kept_wide, NULL, &end) != SGT_BOX_PASSED) return false;
            for (int k = 0; k < 3; k++) p[k] = end.p[k], d[k] = end.d[k];
        }
        moved(i ? &e[-1].pose : &global, &e->pose, p, d);
        if (!meets_once(e->surface.self, R, d)) return false;
    }
    return true;
}

/* Of a ray through this part of a box that is not decided: the cosine of its angle of incidence, if it is in
 * doubt whether it is bent; else how far from the axis of the element it meets that, or the one in front if
 * it
 * may miss it. */
static double value_at(const prove_cell *c, const carry_room *r, const prove_box *box, double p, double q)
{
    const size_t k = box->element, at_most = box->why == SGT_BOX_AT_SURFACE ? k : k + 1;
    double x, y;
    sgt_fate fate;
    sgt_sector_point(&box->of, p, q, &x, &y);
    const sgt_vec2 at = sgt_vignetted(c->beam, x, y);
    sgt_ray ray = sgt_field_ray(c->beam, at.x, at.y);
    if (at_most == 0) return hypot(x, y);
    sgt_vec3 d = ray.d;
    const size_t passed = sgt_trace(at_most, r->wide, c->before, &ray, r->passages, &fate, NULL);
    const sgt_hit *hit = &r->passages[at_most - 1].hit;
    if (passed + 1 < at_most || !(hit->status > 0)) return (double)NAN;
    if (box->why != SGT_BOX_AT_BENDING) return hypot(hit->p.x, hit->p.y);
    if (k) d = out_of3(&c->e[k - 1].pose, r->passages[k - 1].direction);
    d = into3(&c->e[k].pose, d);
    return fabs(dot3(d, hit->n)) / (length3(d) * length3(hit->n));
}

/* Which way a box that lies across an edge is best halved: along which that value changes most.  An edge that
 * rays of one radius follow needs boxes that are thin and long.  (Items are judged by ranges of x and y, so
 * there
 * boxes have to be as deep as they are long.) */
static int across_edge(const prove_cell *c, const carry_room *r, const prove_box *box, int otherwise)
{
    const double size = c->e[box->element].semi_diameter;
    if (box->why == SGT_BOX_AT_EDGE && !(size > 0 && size < 0x1p500)) return otherwise;
    if (box->of.turn1 - box->of.turn0 == 1) return otherwise;
    const double middle = value_at(c, r, box, 0.5, 0.5);
    double along[2];
    for (int side = 0; side < 2; side++) {
        const double one = value_at(c, r, box, side ? 0.5 : 0, side ? 0 : 0.5) - middle;
        const double other = value_at(c, r, box, side ? 0.5 : 1, side ? 1 : 0.5) - middle;
        along[side] = fmax(fmax(fabs(one), fabs(other)), fabs(one - other));
    }
    return isnan(along[0] + along[1]) ? otherwise : along[1] > along[0];
}

void sgt_carry(const prove_cell *c, carry_room *r, prove_box *box, double bound[])
{
    const sgt_box_launch launch = launch_of(c->beam, &box->of);
    ends w;
    const sgt_box_verdict verdict = carried_through(c, r, c->e, r->kept, &launch, &w);
    const sgt_box_end *end = &w.end;
    box->fate = SGT_LOST, box->element = end->element, box->hopeless = false, box->divide = -1;
    if (verdict == SGT_BOX_PASSED) {
        box->fate = SGT_PASSED, box->element = 0;
        bound_ends(c, r, &w, box, bound), bound_elements(c, c->count, c->e, r->at, bound);
        return;
    }
    if (verdict == SGT_BOX_STOPPED && ended_by(end) != SGT_LOST) {
        box->fate = ended_by(end);
        return;
    }
    box->why = end->why, box->divide = verdict == SGT_BOX_CUT ? end->divide : 0;
    box->hopeless = verdict == SGT_BOX_CUT && end->divide < 0;
    if (!box->hopeless && (end->why == SGT_BOX_AT_EDGE || end->why == SGT_BOX_AT_BENDING ||
                           end->why == SGT_BOX_AT_SURFACE))
        box->divide = across_edge(c, r, box, box->divide);
    bound_nothing(c, r->at, box, bound);
    if (box->hopeless || end->why != SGT_BOX_AT_EDGE) return;
    if (carried_through(c, r, r->wide, r->kept_wide, &launch, &w) != SGT_BOX_PASSED || !same_roots(c, r,
            &launch)) return;
    box->bounded = true;
    bound_ends(c, r, &w, box, bound), bound_elements(c, c->count, r->wide, r->at, bound);
}

/* -------------------------------------------------------------------------- one ray */

sgt_fate sgt_carry_ray(const prove_cell *c, carry_room *r, double x, double y, double value[])
{
    const double none = (double)NAN, DEGREES = 57.29577951308232;
    const sgt_vec2 q = sgt_vignetted(c->beam, x, y);
    sgt_ray ray = sgt_field_ray(c->beam, q.x, q.y);
    sgt_vec3 d = ray.d; /* global, in front of the element */
    sgt_fate fate;
    for (size_t k = 0; k < prove_quantities(c->count); k++) value[k] = none;
    sgt_trace(c->count, c->e, c->before, &ray, r->passages, &fate, NULL);
    if (fate != SGT_PASSED) return fate;
    sgt_ray_end end = {.fate = fate};
    for (size_t i = 0; i < c->count; i++) {
        const sgt_passage *p = &r->passages[i];
        const sgt_vec3 own = into3(&c->e[i].pose, d), at = p->hit.p;
        const double cosine = fabs(dot3(own, p->hit.n)) / (length3(p->hit.n) * length3(own));
        const double high = hypot(at.x, at.y), size = c->e[i].semi_diameter;
        value[prove_at_element(i, Q_INCIDENCE)] = acos(fmin(cosine, 1)) * DEGREES;
        value[prove_at_element(i, Q_HEIGHT)] = high;
        if (size > 0 && size < 0x1p500 && !(c->e[i].aperture && c->e[i].aperture->count))
            value[prove_at_element(i, Q_INSIDE)] = high - size;
        end.p = at, end.d = own, end.opl = p->opl;
        d = out_of3(&c->e[i].pose, p->direction);
    }
    if (c->has_reference) {
        sgt_vec3 p = end.p, from = c->reference;
        if (c->afocal) {
            sgt_ray_end angles;
            sgt_ends_as_angles(&c->reference, 1, &end, &angles);
            p = angles.p, from = (sgt_vec3){0, 0, 0};
        }
        value[Q_EX] = fabs(p.x - from.x), value[Q_EY] = fabs(p.y - from.y);
        value[Q_SPOT] = hypot(value[Q_EX], value[Q_EY]);
    }
    if (c->has_opd) {
        const double opd = c->waves * c->opd(&c->about, &end, NULL);
        value[Q_HIGH] = opd, value[Q_LOW] = -opd;
    }
    return fate;
}
