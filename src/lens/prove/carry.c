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
 * been carried all the way to the image.  There b is about -V, V = |v|, and a product v . d would have the
 * rest of d V times.  But d is of unit length, and so is e = -+v / V, the direction to or from c; so with
 * q = d - e, which is small as the ray nearly goes through c,
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
 * monotone, and there is one root at most.)  Otherwise all that is known of it is that rays which pass end
 * inside the clear aperture of the last element, and meet each element inside its own.
 *
 * THE PARTS OF SUCH A BOX.  Those of its rays that are inside all edges, if these are circles, as the wider
 * lens is met, pass; one that is outside of some ends there or in front: the areas are those on either side
 * of curves (edge.h).  If all its rays end behind a wider edge of the one element in doubt, none passes. */
#include "carry.h"
#include "edge.h"

#include <sagitta/surfaces.h>

static const double WIDER_EDGES = 1.0625;

/* All rays of a box: at the last element, and in front of it, in its frame. */
typedef struct ends { sgt_box_end end; sgt_series_ray at, front; } ends;

struct carry_room {
    sgt_box_room *kept, *kept_wide;   /* [count] each */
    sgt_box_at *at;
    sgt_element *wide, *one;          /* with wider edges; with one such edge */
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
                      .wide = sgt_launch_take(of->from, 2 * n, sizeof *r->wide),
                      .passages = sgt_launch_take(of->from, n, sizeof *r->passages)};
    if (!r->kept || !r->at || !r->wide || !r->passages) {
        sgt_carry_room_free(of, r);
        return NULL;
    }
    r->kept_wide = r->kept + n, r->one = r->wide + n;
    for (size_t i = 0; i < 2 * n; i++) r->kept[i] = (sgt_box_room){{0}};
    for (size_t i = 0; i < n; i++) {
        r->wide[i] = r->one[i] = of->e[i], r->wide[i].aperture = NULL;
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
static sgt_series plus_scaled(const sgt_series *x, double k, const sgt_series *y)
{
    sgt_series scaled, sum;
    sgt_series_scaled(x, k, &scaled);
    sgt_series_sum(&scaled, y, &sum);
    return sum;
}

/* k x + by */
static sgt_series line(const sgt_series *x, double k, double by)
{
    sgt_series out;
    sgt_series_scaled(x, k, &out);
    sgt_series_plus(&out, by, &out);
    return out;
}

static sgt_series_ray launch_of(const sgt_field_beam *b, const sector *of)
{
    sgt_series_ray l = {.opl = {.rest = 0}};
    sgt_series x, y, u, v;
    sgt_sector_series(of, &x, &y);
    x = line(&x, b->scale.x, b->shift.x), y = line(&y, b->scale.y, b->shift.y);
    u = x, v = y;
    if (b->turn.y != 0 || b->turn.x != 1) {
        const sgt_series cy = line(&y, -b->turn.y, 0), cx = line(&y, b->turn.x, 0);
        u = plus_scaled(&x, b->turn.x, &cy), v = plus_scaled(&x, b->turn.y, &cx);
    }
    if (b->cone > 0 || b->finite) {
        /* light runs along +z even if the pupil lies in front of the object */
        const sgt_vec3 o = b->object;
        const double ahead = b->cone > 0 ? 1 : copysign(1, b->pupil - o.z);
        l.p[0] = sgt_series_of(o.x), l.p[1] = sgt_series_of(o.y), l.p[2] = sgt_series_of(o.z);
        l.d[0] = b->cone > 0 ? line(&u, b->cone, 0) : line(&u, ahead * b->radius, -ahead * o.x);
        l.d[1] = b->cone > 0 ? line(&v, b->cone, 0) : line(&v, ahead * b->radius, -ahead * o.y);
        l.d[2] = sgt_series_of(b->pupil);
        sgt_series_plus(&l.d[2], -o.z, &l.d[2]), sgt_series_scaled(&l.d[2], ahead, &l.d[2]);
        if (b->cone > 0) l.d[2] = sgt_series_of(1);
        return l;
    }
    /* p + (wave - p . d) d */
    const sgt_vec3 d = b->direction;
    const sgt_series px = line(&u, b->radius, 0), py = line(&v, b->radius, 0), pz = sgt_series_of(b->pupil);
    sgt_series s = line(&px, -d.x, b->wave);
    s = plus_scaled(&py, -d.y, &s), s = plus_scaled(&pz, -d.z, &s);
    l.p[0] = plus_scaled(&s, d.x, &px), l.p[1] = plus_scaled(&s, d.y, &py);
    l.p[2] = plus_scaled(&s, d.z, &pz);
    l.d[0] = sgt_series_of(d.x), l.d[1] = sgt_series_of(d.y), l.d[2] = sgt_series_of(d.z);
    return l;
}

/* ------------------------------------------------------------------------- the ends */

static sgt_series dot_model(const sgt_series a[3], const sgt_series b[3])
{
    sgt_series sum = sgt_series_of(0), product;
    for (int k = 0; k < 3; k++) sgt_series_product(&a[k], &b[k], &product), sgt_series_sum(&sum, &product,
            &sum);
    return sum;
}

static sgt_series dot_fixed(const sgt_series a[3], sgt_vec3 b)
{
    const double by[3] = {b.x, b.y, b.z};
    sgt_series sum = sgt_series_of(0);
    for (int k = 0; k < 3; k++) sum = plus_scaled(&a[k], by[k], &sum);
    return sum;
}

static void rest_more(sgt_series *m, double by) { m->rest = sgt_sum_above(m->rest, by); }

/* The arc tangent of a small model, times 1000: q - q^3 atan's own rest, |atan q - q + q^3 / 3| <= |q|^5 / 5.
 * */
static sgt_series milli_angle(const sgt_series *q)
{
    const double most = sgt_interval_greatest(sgt_series_range(q)), square = sgt_product_above(most, most);
    sgt_series cube, out;
    if (!(most <= 0.5)) {
        const sgt_interval all = sgt_interval_arc_tangent(sgt_series_range(q));
        out = sgt_series_between(all);
    } else {
        sgt_series_product(q, q, &cube), sgt_series_product(&cube, q, &cube);
        out = plus_scaled(&cube, -1.0 / 3, q);
        rest_more(&out, sgt_product_above(sgt_product_above(square, square), most) / 5 * (1 + 0x1p-50) +
                        sgt_product_above(square, most) * 0x1p-52);
    }
    sgt_series_scaled(&out, 1e3, &out);
    return out;
}

/* Distances from the reference; afocal: angles in milliradians, as sgt_ends_as_angles has them. */
static void errors_of(const prove_cell *c, const sgt_series_ray *end, sgt_series *ex, sgt_series *ey)
{
    const sgt_vec3 at = c->reference;
    if (!c->afocal) {
        *ex = end->p[0], *ey = end->p[1];
        sgt_series_plus(ex, -at.x, ex), sgt_series_plus(ey, -at.y, ey);
        return;
    }
    const sgt_vec3 y = unit3(cross3(at, (sgt_vec3){1, 0, 0})), x = cross3(y, at);
    sgt_series off[3] = {end->d[0], end->d[1], end->d[2]};
    sgt_series ahead = dot_fixed(end->d, at), by;
    sgt_series_plus(&off[0], -at.x, &off[0]), sgt_series_plus(&off[1], -at.y, &off[1]);
    sgt_series_plus(&off[2], -at.z, &off[2]);
    sgt_series_inverse(&ahead, &by);
    sgt_series along_x = dot_fixed(off, x), along_y = dot_fixed(off, y);
    sgt_series_product(&along_x, &by, ex), sgt_series_product(&along_y, &by, ey);
    *ex = milli_angle(ex), *ey = milli_angle(ey);
    rest_more(ex, 0x1p-40), rest_more(ey, 0x1p-40); /* x and y are unit vectors to rounding */
}

/* d . e less 1, of the unit vectors d and e: -q^2 / 2, q = d - e; *square: q^2. */
static sgt_series less_than_one(const sgt_series d[3], const sgt_series e[3], sgt_series *square)
{
    sgt_series q[3], out;
    for (int k = 0; k < 3; k++) sgt_series_difference(&d[k], &e[k], &q[k]);
    *square = dot_model(q, q);
    sgt_series_scaled(square, -0.5, &out);
    return out;
}

/* b and h^2 of the head, of v = p - c and d. */
static void foot_of(const sgt_series v[3], const sgt_series d[3], sgt_series *b, sgt_series *h2)
{
    sgt_series V = dot_model(v, v), by, e[3], q2, less, quarter, V2 = V;
    const double sign = v[0].k[0] * d[0].k[0] + v[1].k[0] * d[1].k[0] + v[2].k[0] * d[2].k[0] < 0 ? -1 : 1;
    sgt_series_root(&V, &V), sgt_series_inverse(&V, &by), sgt_series_scaled(&by, sign, &by);
    for (int k = 0; k < 3; k++) sgt_series_product(&v[k], &by, &e[k]);
    less = less_than_one(d, e, &q2);
    sgt_series_product(&V, &less, b), sgt_series_sum(b, &V, b), sgt_series_scaled(b, sign, b);
    sgt_series_scaled(&q2, -0.25, &quarter), sgt_series_plus(&quarter, 1, &quarter);
    sgt_series_product(&V2, &q2, h2), sgt_series_product(h2, &quarter, h2);
    if (isfinite(b->rest + h2->rest)) return;
    /* the point is at the centre itself */
    sgt_series across[3];
    *b = dot_model(v, d);
    for (int k = 0; k < 3; k++) {
        sgt_series_product(b, &d[k], &across[k]);
        sgt_series_difference(&v[k], &across[k], &across[k]);
    }
    *h2 = dot_model(across, across);
}

/* The path difference, in waves. */
static sgt_series difference_of(const prove_cell *c, const ends *w)
{
    const sgt_reference *of = &c->about;
    const double n = of->index, R = of->radius;
    sgt_series v[3] = {w->front.p[0], w->front.p[1], w->front.p[2]}, path = w->front.opl, add, b, h2;
    sgt_series_plus(&v[0], -of->centre.x, &v[0]), sgt_series_plus(&v[1], -of->centre.y, &v[1]);
    sgt_series_plus(&v[2], -of->centre.z, &v[2]);
    sgt_series_plus(&path, -of->opl, &path);
    if (of->kind == SGT_REFERENCE_PLANE) { /* v . d0 / d . d0 */
        const sgt_series above = dot_fixed(v, of->along),
                        fixed[3] = {sgt_series_of(of->along.x), sgt_series_of(of->along.y),
                                sgt_series_of(of->along.z)};
        sgt_series square, below = less_than_one(w->front.d, fixed, &square);
        rest_more(&below, 0x1p-50); /* the length of d0 is 1 to rounding */
        sgt_series_plus(&below, 1, &below), sgt_series_inverse(&below, &below);
        sgt_series_product(&above, &below, &add), sgt_series_scaled(&add, -n, &add);
    } else {
        foot_of(v, w->front.d, &b, &h2);
        sgt_series_scaled(&b, -n, &add);
        if (of->kind == SGT_REFERENCE_SPHERE) {
            sgt_series root = line(&h2, -1, R * R);
            rest_more(&root, 0x1p-52 * R * R); /* R * R rounds */
            sgt_series_root(&root, &root), sgt_series_scaled(&root, copysign(1, R), &root);
            sgt_series_plus(&root, R, &root), sgt_series_inverse(&root, &root);
            sgt_series_product(&h2, &root, &h2);
            add = plus_scaled(&h2, n, &add);
        }
    }
    sgt_series_sum(&path, &add, &path);
    sgt_series_scaled(&path, c->waves, &path);
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

static sgt_interval square_range(const sgt_series *m, const sgt_series *squared)
{
    return sgt_interval_intersection(sgt_interval_square(sgt_series_range(m)), sgt_series_range(squared));
}

static void bound_ends(const prove_cell *c, const carry_room *r, const ends *of, prove_box *box,
                       double bound[])
{
    const sgt_interval all = {-HUGE_VAL, HUGE_VAL};
    box->f = box->ww = (sgt_interval){0, HUGE_VAL}, box->w = all;
    box->f_sum = box->w_sum = box->ww_sum = all;
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) bound[q] = HUGE_VAL;
    if (c->has_reference && !(c->afocal && !r->front_known)) {
        sgt_series ex, ey, xx, yy;
        const double err = c->afocal ? 1e3 * (c->reference_err + 0x1p-50) : c->reference_err;
        errors_of(c, &of->at, &ex, &ey);
        rest_more(&ex, err), rest_more(&ey, err);
        sgt_series_product(&ex, &ex, &xx), sgt_series_product(&ey, &ey, &yy);
        const sgt_interval x2 = square_range(&ex, &xx), y2 = square_range(&ey, &yy);
        sgt_series_sum(&xx, &yy, &xx);
        box->f = sgt_interval_intersection(sgt_interval_sum(x2, y2), sgt_series_range(&xx));
        box->f_sum = sgt_sector_integral(&box->of, &xx);
        bound[Q_EX] = sgt_interval_greatest(sgt_series_range(&ex));
        bound[Q_EY] = sgt_interval_greatest(sgt_series_range(&ey));
        bound[Q_SPOT] = sgt_square_root_above(box->f.hi);
    }
    if (c->has_opd && r->front_known) {
        sgt_series w = difference_of(c, of), ww;
        const sgt_interval range = sgt_series_range(&w);
        bound[Q_HIGH] = range.hi, bound[Q_LOW] = -range.lo;
        sgt_series_plus(&w, -c->middle, &w);
        sgt_series_product(&w, &w, &ww);
        box->w = sgt_series_range(&w), box->ww = square_range(&w, &ww);
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

static sgt_box_verdict carried_through(const prove_cell *c, const sgt_element *e, size_t count,
                                       sgt_box_room *kept, sgt_box_at *at, const sgt_series_ray *launch,
                                       ends *out)
{
    const sgt_box_lens lens = {.elements = count, .e = e, .index_before = c->before};
    return sgt_series_trace(&lens, launch, kept, at, &out->front, &out->at, &out->end);
}

/* Rays that meet the conic e within r <= R, whose directions in its frame are d: is there one root only? */
static bool meets_once(const sgt_conic *q, double R, const sgt_series d[3])
{
    const sgt_interval n = sgt_interval_absolute(sgt_series_range(&d[2]));
    const sgt_interval l = sgt_series_range(&d[0]), m = sgt_series_range(&d[1]);
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
static bool same_roots(const prove_cell *c, const carry_room *r, size_t count, const sgt_series_ray *launch)
{
    ends w;
    for (size_t i = 0; i < count; i++) {
        const sgt_element *e = &c->e[i];
        const double R = sgt_interval_hypotenuse(r->at[i].x, r->at[i].y).hi;
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        if (e->surface.ops != &sgt_conic_ops || !round || R < e->semi_diameter * (1 - 0x1p-40)) continue;
        if (carried_through(c, r->wide, i + 1, r->kept_wide, NULL, launch, &w) != SGT_BOX_PASSED)
            return false;
        if (!meets_once(e->surface.self, R, w.front.d)) return false;
    }
    return true;
}

static bool is_round(const sgt_element *e) { return e->semi_diameter > 0 && e->semi_diameter < 0x1p500; }

/* The edges that go through a box, as edge.h has them. */
typedef struct edges_of { size_t count; sgt_series g[EDGES]; double slack[EDGES]; } edges_of;

/* A circle of the radius a about `at`: rays inside pass, or if `obscures` those outside.  false: there is no
 * room. */
static bool add_circle(edges_of *to, const sgt_series *x, const sgt_series *y, sgt_vec2 at, double a,
                       bool obscures)
{
    sgt_series u, v, g;
    const double size = fabs(at.x) + fabs(at.y) + a, slack = 0x1p-36 * size * size;
    sgt_series_plus(x, -at.x, &u), sgt_series_product(&u, &u, &u);
    sgt_series_plus(y, -at.y, &v), sgt_series_product(&v, &v, &v);
    sgt_series_sum(&u, &v, &g), sgt_series_plus(&g, -a * a, &g);
    if (obscures) sgt_series_scaled(&g, -1, &g);
    if (sgt_series_range(&g).hi < -slack) return true; /* it is not near */
    if (to->count == EDGES) return false;
    to->g[to->count] = g, to->slack[to->count++] = slack;
    return true;
}

/* Those of element i of the lens, where rays meet it in the wider one.  false: not all meet it, or they are
 * not round. */
static bool add_edges(const prove_cell *c, const carry_room *r, size_t i, const sgt_series_ray *launch,
                      edges_of *to)
{
    ends w;
    const sgt_element *e = &c->e[i];
    if (carried_through(c, r->wide, i + 1, r->kept_wide, NULL, launch, &w) != SGT_BOX_PASSED) return false;
    const sgt_series *x = &w.at.p[0], *y = &w.at.p[1];
    if (is_round(e) && !add_circle(to, x, y, (sgt_vec2){0, 0}, e->semi_diameter, false)) return false;
    for (size_t k = 0; e->aperture && k < e->aperture->count; k++) {
        const sgt_aperture_item *item = &e->aperture->items[k];
        const bool ring = item->shape == SGT_ANNULUS;
        if (item->shape != SGT_CIRCLE && !(ring && !item->obscuring)) return false;
        if (!add_circle(to, x, y, item->centre, item->radius, item->obscuring) ||
            (ring && !add_circle(to, x, y, item->centre, item->inner, true)))
            return false;
    }
    return true;
}

/* The parts of a box that is cut at the edge of its element.  passes: all its rays pass the wider lens, as
 * r->at has it. */
static void set_parts(const prove_cell *c, const carry_room *r, const sgt_series_ray *launch, bool passes,
                      prove_box *box)
{
    edges_of all = {.count = 0};
    double none;
    size_t own = 0;
    for (size_t i = box->element; i < c->count && (i == box->element || passes); i++) {
        const sgt_element *e = &c->e[i];
        const bool items = e->aperture && e->aperture->count > 0;
        const bool inside = !is_round(e) || r->wide[i].semi_diameter - r->at[i].margin.lo <
                                            e->semi_diameter * (1 - 0x1p-38);
        if (i > box->element && inside && !items) continue;
        passes = add_edges(c, r, i, launch, &all) && passes;
        if (i == box->element && !(own = all.count)) return;
    }
    sgt_edge_parts(&box->of, own, all.g, all.slack, &none, &box->out_here);
    box->out = box->out_here;
    if (passes) sgt_edge_parts(&box->of, all.count, all.g, all.slack, &box->in, &box->out);
    box->out = fmax(box->out, box->out_here);
}

/* All rays of the box are clipped: at its element, or behind it if that had a wider edge. */
static bool ends_anyway(const prove_cell *c, carry_room *r, const sgt_series_ray *launch,
                        const prove_box *box)
{
    ends w;
    sgt_element *e = &r->one[box->element];
    *e = r->wide[box->element];
    const bool end = carried_through(c, r->one, c->count, NULL, NULL, launch, &w) == SGT_BOX_STOPPED &&
                      w.end.element > box->element && ended_by(&w.end) == SGT_CLIPPED;
    *e = c->e[box->element];
    return end;
}

/* No ray passes: there is nothing to bound. */
static void set_ended(const prove_cell *c, prove_box *box, double bound[])
{
    for (size_t q = 0; q < prove_quantities(c->count); q++) bound[q] = -HUGE_VAL;
    box->f = box->ww = box->w = (sgt_interval){0, 0};
    box->bounded = true, box->in = 0, box->out = sgt_sector_area(&box->of);
}

/* Where an edge of items goes through a box: the round item whose edge is nearest to a point of it. */
static const sgt_aperture_item *round_item(const sgt_aperture *a, double x, double y)
{
    const sgt_aperture_item *best = NULL;
    double least = HUGE_VAL;
    for (size_t k = 0; a && k < a->count; k++) {
        const sgt_aperture_item *i = &a->items[k];
        const double r = hypot(x - i->centre.x, y - i->centre.y);
        const bool ring = i->shape == SGT_ANNULUS;
        if (i->shape != SGT_CIRCLE && !ring) continue;
        const double off = fmin(fabs(r - i->radius), ring ? fabs(r - i->inner) : HUGE_VAL);
        if (off < least) least = off, best = i;
    }
    return best;
}

/* Of a ray through this part of a box that is not decided: the cosine of its angle of incidence, if it is in
 * doubt whether it is bent; else how far from the axis of the element, or of the item, it meets that, or the
 * one in front if it may miss it. */
static double value_at(const prove_cell *c, const carry_room *r, const prove_box *box,
                       const sgt_aperture_item *item, double p, double q)
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
    if (item) return hypot(hit->p.x - item->centre.x, hit->p.y - item->centre.y);
    if (box->why != SGT_BOX_AT_BENDING) return hypot(hit->p.x, hit->p.y);
    if (k) d = out_of3(&c->e[k - 1].pose, r->passages[k - 1].direction);
    d = into3(&c->e[k].pose, d);
    return fabs(dot3(d, hit->n)) / (length3(d) * length3(hit->n));
}

/* Which way a box that lies across an edge is best halved: along which that value changes most.  An edge that
 * rays of one radius follow needs boxes that are thin and long.  But if the value is enclosed far wider than
 * it changes, it is what the series leave out: of that the longer side has more.  Where nothing is known of
 * it no box gets very long.  (Items that are not round: boxes as deep as they are long.) */
static int across_edge(const prove_cell *c, const carry_room *r, const prove_box *box, int otherwise)
{
    enum { THIN = 8, THINNEST = 64 };
    const double depth = box->of.r1 - box->of.r0,
                 arc = 3.141592653589793 * (box->of.turn1 - box->of.turn0) * (box->of.r0 + box->of.r1);
    const bool edge = box->why == SGT_BOX_AT_EDGE, surface = box->why == SGT_BOX_AT_SURFACE;
    const sgt_box_at *at = &r->at[box->element];
    const sgt_interval known = edge ? at->margin : at->cosine;
    const sgt_aperture_item *item = NULL;
    if (edge && known.lo > 0) { /* inside the semi_diameter */
        item = round_item(c->e[box->element].aperture, (at->x.lo + at->x.hi) / 2, (at->y.lo + at->y.hi) / 2);
        if (!item) return otherwise;
    }
    const double middle = value_at(c, r, box, item, 0.5, 0.5);
    double along[2];
    for (int side = 0; side < 2; side++) {
        const double one = value_at(c, r, box, item, side ? 0.5 : 0, side ? 0 : 0.5) - middle;
        const double other = value_at(c, r, box, item, side ? 0.5 : 1, side ? 1 : 0.5) - middle;
        along[side] = fmax(fmax(fabs(one), fabs(other)), fabs(one - other));
    }
    const bool traced = !isnan(along[0] + along[1]);
    const double thinnest = item ? THINNEST : THIN;
    if (!traced || surface || item)
        return arc > thinnest * depth   ? 1
               : depth > thinnest * arc ? 0
               : traced                 ? along[1] > along[0]
                                        : otherwise;
    if (!(known.hi - known.lo <= 2 * (along[0] + along[1]))) return arc > depth;
    return along[1] > along[0];
}

void sgt_carry(const prove_cell *c, carry_room *r, prove_box *box, double bound[])
{
    const sgt_series_ray launch = launch_of(c->beam, &box->of);
    ends w;
    const sgt_box_verdict verdict = carried_through(c, c->e, c->count, r->kept, r->at, &launch, &w);
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
    const bool all =
        carried_through(c, r->wide, c->count, r->kept_wide, r->at, &launch, &w) == SGT_BOX_PASSED;
    /* (cut or not, at[] is known up to where it came to) */
    if (!all && !(w.end.element > box->element)) return;
    if (!same_roots(c, r, all ? c->count : box->element + 1, &launch)) return;
    set_parts(c, r, &launch, all, box);
    if (all) {
        box->bounded = true;
        bound_ends(c, r, &w, box, bound), bound_elements(c, c->count, r->wide, r->at, bound);
    }
    if (!(box->in > 0) && ends_anyway(c, r, &launch, box)) set_ended(c, box, bound);
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
