// SPDX-License-Identifier: MIT
/* first_order.c - paraxial data of a lens, and its Seidel sums.
 *
 * A RAY is (y, w) with w = n u.  A surface of power F = C (n' - n) takes w to w - y F, a
 * thickness t takes y to y + t w / n.  Behind a mirror n changes its sign.  Both are linear, so
 * two rays tell all: (1, 0) and (0, 1) at the first vertex.
 *
 * THE VERTEX CURVATURE of any sag F = z - s(x, y) is C = -F_y / (F_z h) at y = h, to a relative
 * (C h)^2; h is so small that this is below rounding, and the gradient is the surface's formula,
 * no difference.  If the surface has second derivatives, C is the one at the vertex, and the
 * gradient only says whether there is a vertex: on a cone it is not C h.
 *
 * SEIDEL SUMS (Welford 1986, 8.2).  With A = n (u + y C), and a bar for the chief ray,
 * H = A ybar - Abar y, and D(x) = x' - x,
 *
 *     S1 = -A^2 y D(u/n)     S2 = -A Abar y D(u/n)     S3 = -Abar^2 y D(u/n)
 *     S4 = -H^2 C D(1/n)     S5 = Abar/A (S3 + S4)
 *
 * and as D(u/n) = A D(1/n^2) - y C D(1/n), A can be divided out of the last:
 *
 *     S5 = Abar (-Abar^2 y D(1/n^2) - ybar (A ybar - 2 Abar y) C D(1/n)).
 *
 * An ideal lens images every plane without aberration, and has none of these.  One of two powers counts with
 * that along y, as any surface that is not round.  Its part of the colour
 * is what the media do: y (w' dn'/n' - w dn/n), and with ybar and wbar.
 *
 * A PHASE of W waves changes n u by S_y, S = per_wave W (system.h), in reflection as in transmission.  So it
 * adds -S_yy at the vertex to the power of its surface.  Its slope there, S_y, turns the light of a grating
 * aside, and with it the axis: as other programs do, the data are those along the straight axis, as if there
 * were no lines.  (sgt_field_parabasal has data along real rays.)
 *
 * FACETS have the power of the sag whose slopes they have.  Where the surface is flat, the image is bent by
 * another law than Petzval's (Delano 1974), so that radius is not told.
 *
 * A surface z = C r^2/2 + (C^3/8 + g) r^4 + ... adds 8 g D(n) y^4 to S1, and to S2, S3, S5 the
 * same with one, two, three of the y replaced by ybar.  Colour: A y D(dn/n), Abar y D(dn/n).
 *
 * WHAT IS ZERO.  The power of an afocal lens, made from its doubles, is hardly ever 0: radii, thicknesses
 * and indices are rounded, and so is each step.  So each number has a bound of its error beside it (`number`;
 * Higham 2002, 3.3): what it takes over from those it is made of, and u = 2^-53 of itself.  The rounding
 * of the bounds is in the factor of `settled`.  The input is off by
 *
 *     4 u of a curvature    half an ulp of the radius, that of 1 / R, and two more for a surface that adds
 *                           terms
 *     2 u of a place z      half an ulp of the thickness, and that of the sum
 *     4 u of an index       half an ulp if it was given; a glass adds terms.  1 is exact
 *
 * A quantity within its bound of 0 is 0: rounding alone may have made it.  One beyond it is never made 0. */
#include "objects.h"

#include "../base/reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double SMOOTH = 0x1p-10, FLAT = 0x1p-40; /* of C; of the slope at y = h */
static const double RADIAN = 0.017453292519943295;    /* pi / 180 */
static const double U = 0x1p-53;

/* A number and a bound of its error. */
typedef struct number { double x, err; } number;

static number exactly(double x) { return (number){x, 0}; }
static number within(double x, double units) { return (number){x, units * U * fabs(x)}; }

static number sum(number a, number b)
{
    double x = a.x + b.x;
    return (number){x, a.err + b.err + U * fabs(x)};
}

static number difference(number a, number b) { return sum(a, (number){-b.x, b.err}); }

static number product(number a, number b)
{
    double x = a.x * b.x;
    return (number){x, fabs(a.x) * b.err + fabs(b.x) * a.err + a.err * b.err + U * fabs(x)};
}

/* b is beyond its bound. */
static number quotient(number a, number b)
{
    double x = a.x / b.x;
    return (number){x, (a.err + fabs(x) * b.err) / (fabs(b.x) - b.err) + U * fabs(x)};
}

/* 0 where it cannot be told from 0; NaN stays. */
static double settled(number a) { return fabs(a.x) <= a.err * (1 + 0x1p-10) ? 0 : a.x; }

/* NaN: there is no vertex, or its normal is not along z. */
static double vertex_curvature(sgt_surface s, double h)
{
    sgt_vec3 low, high, slope;
    s.ops->value(s.self, (sgt_vec3){0, 0, 0}, &low);
    s.ops->value(s.self, (sgt_vec3){0, 0, 1}, &high);
    if (low.z != 1 || high.z != 1) return (double)NAN; /* no sag */
    double f = s.ops->value(s.self, (sgt_vec3){0, h, 0}, &slope), c = -slope.y / (slope.z * h);
    if (!isfinite(f) || !isfinite(c)) return (double)NAN;
    if (!s.ops->second) return c;
    const double zero = 0;
    double second[6], *to[6];
    for (int i = 0; i < 6; i++) to[i] = &second[i];
    s.ops->second(s.self, 1, (sgt_points){{&zero, &zero, &zero}}, to);
    double vertex = -second[3];
    return fabs(c - vertex) <= SMOOTH * fabs(vertex) || fabs(c - vertex) * h < FLAT ? vertex : (double)NAN;
}

/* Has W a kink at the vertex, seen by the gradients at y = h and -h?  Their difference falls with h where W
 * is smooth, and does not at a kink.  One that turns light by less than 2^-40 is none. */
static bool is_kinked(const sgt_phase *p, double h)
{
    enum { NEARER = 16 };
    double jump[2];
    for (int k = 0; k < 2; k++, h /= NEARER) {
        sgt_vec3 up = {0, 0, 0}, down = {0, 0, 0};
        p->waves.ops->value(p->waves.self, (sgt_vec3){0, h, 0}, &up);
        p->waves.ops->value(p->waves.self, (sgt_vec3){0, -h, 0}, &down);
        jump[k] = fabs(p->per_wave * (up.y - down.y));
    }
    return jump[1] > 0x1p-40 && jump[1] > 0.5 * jump[0];
}

/* W_yy of a phase in waves at the vertex of a surface of the curvature c: with F(x, y, z) it is that along
 * the surface.  NaN: it has none.  h: of is_kinked. */
static double vertex_bend(const sgt_phase *p, double c, double h)
{
    if (is_kinked(p, h)) return (double)NAN;
    const sgt_surface waves = p->waves;
    const bool sag = p->kind == SGT_PHASE_SAG;
    const double zero = 0, sign = sag ? -1 : 1;
    sgt_vec3 slope;
    const double f = waves.ops->value(waves.self, (sgt_vec3){0, 0, 0}, &slope);
    double second[6], *to[6];
    if (!waves.ops->second || !isfinite(f) || !isfinite(slope.y)) return (double)NAN;
    for (int i = 0; i < 6; i++) to[i] = &second[i];
    waves.ops->second(waves.self, 1, (sgt_points){{&zero, &zero, &zero}}, to);
    return sign * second[3] + (sag ? 0 : slope.z * c);
}

static bool is_faceted(const sgt_phase *p) { return p && p->kind == SGT_FACETS; }
static bool is_in_waves(const sgt_phase *p) { return p && p->kind != SGT_IDEAL_LENS && !is_faceted(p); }

static bool has_two_powers(const sgt_phase *p)
{
    return p && p->focal_length_y != 0 && p->focal_length_y != p->focal_length;
}

/* A surface as paraxial rays meet it. */
typedef struct vertex {
    number z, n, power; /* n: behind it, with sign */
    number bent;        /* what of the power bends the image: not that of a phase in waves, which is as if
                           of an infinite index (Sweatt 1977) */
    double c;
} vertex;

typedef struct paraxial {
    const sgt_lens *lens;
    number before;        /* the index in front */
    size_t last;          /* the place of the image */
    vertex *at;           /* [lens->count] */
} paraxial;

typedef struct beam_ray { number y, w, n, z; } beam_ray;

static void go_to(beam_ray *r, number z)
{
    if (z.x != r->z.x) r->y = sum(r->y, quotient(product(difference(z, r->z), r->w), r->n));
    r->z = z;
}

/* From the first vertex through the surfaces first ... end - 1. */
static void go_through(const paraxial *p, beam_ray *r, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        const vertex *v = &p->at[i];
        go_to(r, v->z);
        r->w = difference(r->w, product(r->y, v->power)), r->n = v->n;
    }
}

static beam_ray ray_at_first(const paraxial *p, number y, number w)
{
    return (beam_ray){y, w, p->before, p->at[0].z};
}

static beam_ray at_image(const paraxial *p, number y, number w)
{
    beam_ray r = ray_at_first(p, y, w);
    go_through(p, &r, 0, p->last);
    go_to(&r, p->at[p->last].z);
    return r;
}

static number at_stop(const paraxial *p, number y, number w)
{
    beam_ray r = ray_at_first(p, y, w);
    go_through(p, &r, 0, p->lens->stop);
    go_to(&r, p->at[p->lens->stop].z);
    return r.y;
}

static const number no_number = {(double)NAN, 0};

/* a / b; NaN: b is 0. */
static number ratio(number a, number b) { return settled(b) == 0 ? no_number : quotient(a, b); }

/* Where a ray crosses the axis, from where it is. */
static number crossing(const beam_ray *r)
{
    return ratio(product((number){-r->y.x, r->y.err}, r->n), r->w);
}

/* The ray from the axis point of an object. */
static beam_ray axial_ray(const paraxial *p)
{
    return at_image(p, within(p->lens->object_distance, 1), p->before);
}

/* --------------------------------------------------------------- the pupil */

/* The slope of the cone of an aperture at the object; NaN: the aperture is another. */
static double cone_slope(const paraxial *p)
{
    const sgt_lens *l = p->lens;
    return l->pupil == SGT_PUPIL_OBJECT_NA      ? tan(asin(l->pupil_size / p->before.x))
           : l->pupil == SGT_PUPIL_OBJECT_ANGLE ? tan(l->pupil_size * RADIAN)
                                                : (double)NAN;
}

/* The semi-diameter of the entrance pupil; p.entrance_pupil and the power are known. */
static double entrance_radius(const paraxial *p, const sgt_first_order *o)
{
    const sgt_lens *l = p->lens;
    const double d = l->object_distance, size = l->pupil_size, pupil = o->entrance_pupil;
    double slope = (double)NAN;
    switch (l->pupil) {
    case SGT_PUPIL_NONE: return (double)NAN;
    case SGT_PUPIL_RADIUS: return size;
    case SGT_PUPIL_F_NUMBER: return fabs(o->efl) / (2 * size);
    case SGT_PUPIL_WORKING_F_NUMBER:
        if (!isfinite(d)) return fabs(o->efl) / (2 * size);
        slope = settled(axial_ray(p).w);
        slope = slope == 0 ? (double)NAN : 1 / (2 * size * fabs(slope));
        break;
    case SGT_PUPIL_OBJECT_NA:
    case SGT_PUPIL_OBJECT_ANGLE: slope = cone_slope(p); break;
    case SGT_PUPIL_STOP_SIZE:
        return l->surface[l->stop].size / fabs(settled(at_stop(p, exactly(1), exactly(0))));
    }
    return isfinite(d) ? slope * fabs(d + pupil) : (double)NAN;
}

/* The marginal ray at the first vertex: toward the edge of the entrance pupil. */
static beam_ray marginal_ray(const paraxial *p, const sgt_first_order *o)
{
    const double d = p->lens->object_distance, pupil = o->entrance_pupil;
    if (!isfinite(d) && !p->lens->telecentric)
        return ray_at_first(p, exactly(o->entrance_radius), exactly(0));
    number u = exactly(p->lens->telecentric ? cone_slope(p) : o->entrance_radius / (d + pupil));
    return ray_at_first(p, product(within(d, 1), u), product(p->before, u));
}

/* The chief ray, at the first vertex, of the field that is farthest from the axis.  o: of the primary
 * wavelength, at which image heights say a field; its rays are the same at every other. */
static beam_ray chief_ray(const paraxial *p, const sgt_first_order *o)
{
    const sgt_lens *l = p->lens;
    const double d = l->object_distance;
    double most = 0;
    for (size_t i = 0; i < l->fields; i++) {
        double x = l->field[i].x, y = l->field[i].y;
        if (l->field_kind == SGT_FIELD_ANGLE) x = tan(x * RADIAN), y = tan(y * RADIAN);
        most = fmax(most, hypot(x, y));
    }
    bool image = l->field_kind == SGT_FIELD_PARAXIAL_IMAGE_HEIGHT ||
                 l->field_kind == SGT_FIELD_REAL_IMAGE_HEIGHT;
    if (image && isfinite(d)) most /= fabs(o->magnification); /* an object height */
    if (l->telecentric) return ray_at_first(p, exactly(-most), exactly(0));
    double slope = l->field_kind == SGT_FIELD_ANGLE ? most
                   : isfinite(d)                    ? most / (d + o->entrance_pupil)
                                                    : most / fabs(o->front_principal - o->ffd); /* P / n */
    return ray_at_first(p, within(-o->entrance_pupil * slope, 1), product(p->before, exactly(slope)));
}

/* ----------------------------------------------------------------- together */

/* The entrance pupil is that of the primary wavelength at every other, too: `primary`, or NULL if this is
 * it. */
static void set_pupils(const paraxial *p, const sgt_first_order *primary, sgt_first_order *o)
{
    const sgt_lens *l = p->lens;
    number pupil = ratio(at_stop(p, exactly(0), p->before), at_stop(p, exactly(1), exactly(0)));
    if (!isnan(l->pupil_distance)) pupil = within(l->pupil_distance, 1);
    if (primary) pupil = within(primary->entrance_pupil, 1);
    if (l->telecentric) pupil = no_number;
    o->entrance_pupil = settled(pupil);
    o->entrance_radius = primary ? primary->entrance_radius : entrance_radius(p, o);

    beam_ray chief = {exactly(0), p->before, p->before, p->at[l->stop].z}, marginal = marginal_ray(p, o);
    if (l->stop > 0) chief.w = chief.n = p->at[l->stop - 1].n;
    go_through(p, &chief, l->stop, p->last);
    go_to(&chief, p->at[p->last].z);
    o->exit_pupil = l->stop < p->last ? settled(crossing(&chief)) : (double)NAN;
    beam_ray from_pupil = at_image(p, (number){-pupil.x, pupil.err}, p->before);
    o->angular_magnification = settled(quotient(from_pupil.w, from_pupil.n));
    beam_ray end = at_image(p, marginal.y, marginal.w);
    const double slope = settled(end.w);
    o->stop_radius = fabs(at_stop(p, marginal.y, marginal.w).x);
    o->exit_radius = fabs(end.y.x + o->exit_pupil * slope / end.n.x);
    o->f_number_working = slope == 0 ? (double)NAN : 1 / (2 * fabs(slope));
    o->f_number = fabs(o->efl) / (2 * o->entrance_radius);
}

/* With (A, -P) what (1, 0) becomes, (B, D) what (0, 1) becomes, n in front and n' behind, from the first
 * vertex and from the image
 *
 *     foci             -D n / P,        A n' / P
 *     principal points (1 - D) n / P,   (A - 1) n' / P
 *     nodal points     (n' - D n) / P,  (A n' - n) / P. */
static void set_points(const paraxial *p, sgt_first_order *o)
{
    const number n = p->before, one = exactly(1), image_z = p->at[p->last].z;
    beam_ray from_afar = at_image(p, one, exactly(0)), other = at_image(p, exactly(0), one);
    const number behind = from_afar.n, a = from_afar.y, d = other.w;
    const number power = {-from_afar.w.x, from_afar.w.err};
    number focus = ratio(product(a, behind), power);
    o->power = settled(power);
    o->efl = ratio(one, power).x, o->efl_image = fabs(behind.x) * o->efl;
    o->focus = settled(focus);
    o->bfd = settled(sum(focus, difference(image_z, p->last ? p->at[p->last - 1].z : image_z)));
    o->ffd = settled(ratio(product((number){-d.x, d.err}, n), power));
    o->front_principal = settled(ratio(product(difference(one, d), n), power));
    o->rear_principal = settled(ratio(product(difference(a, one), behind), power));
    o->front_nodal = settled(ratio(difference(behind, product(d, n)), power));
    o->rear_nodal = settled(ratio(difference(product(a, behind), n), power));
    o->image = o->focus, o->magnification = (double)NAN;
    if (!isfinite(p->lens->object_distance)) return;
    beam_ray axial = axial_ray(p); /* w = 0: the object is at the front focus */
    o->image = settled(crossing(&axial));
    o->magnification = ratio(n, axial.w).x;
}

static void set_field(const paraxial *p, const sgt_first_order *primary, sgt_first_order *o)
{
    const double d = p->lens->object_distance;
    number curvature = exactly(0), n = p->before;
    beam_ray marginal = marginal_ray(p, o), chief = chief_ray(p, primary ? primary : o);
    o->image_height = isfinite(d) ? fabs((chief.y.x - d * chief.w.x / n.x) * o->magnification)
                                  : fabs(chief.w.x * o->efl);
    o->lagrange = marginal.w.x * chief.y.x - chief.w.x * marginal.y.x;
    for (size_t i = 0; i < p->last; i++) {
        curvature = sum(curvature, quotient(p->at[i].bent, product(n, p->at[i].n)));
        n = p->at[i].n;
    }
    o->petzval_radius = -ratio(exactly(1), product(n, curvature)).x;
}

/* -------------------------------------------------------------- Seidel sums */

/* g of the head: how far the r^4 of a surface is from that of the sphere of its vertex curvature.  false: the
 * surface has no such symmetry, or is not known to. */
static bool fourth_order(const sgt_lens *l, size_t i, double c, double *g)
{
    const sgt_surface s = l->element[i].surface;
    *g = 0;
    if (s.ops == &sgt_conic_ops) {
        const sgt_conic *conic = s.self;
        *g = conic->k * c * c * c / 8;
        return true;
    }
    if (s.ops == &sgt_even_asphere_ops) {
        const sgt_even_asphere *a = s.self;
        *g = ((1 + a->k) * a->c * a->c * a->c - c * c * c) / 8 + a->a[1];
        return true;
    }
    return false;
}

static const char *lacks_symmetry(const sgt_lens *l)
{
    for (size_t i = 0; i < l->count; i++) {
        const sgt_lens_surface *s = &l->surface[i];
        const sgt_pose *pose = &l->element[i].pose;
        bool turned = pose->ex.x != 0 || pose->ex.y != 0 || pose->ex.z != 0;
        if (s->off_axis || s->folded || turned || pose->origin.x != 0 || pose->origin.y != 0)
            return "the lens is not centred: a surface is tilted, decentred or behind a break";
    }
    return NULL;
}

static const char *set_seidel(const paraxial *p, const sgt_first_order *primary, const sgt_first_order *o,
                              const double dn[], sgt_seidel seidel[])
{
    const sgt_lens *l = p->lens;
    const char *lacks = lacks_symmetry(l);
    if (lacks) return lacks;
    if (o->without_vertex) return "a surface has no vertex curvature";
    if (isnan(o->lagrange)) return "the pupil or the fields are not known";
    for (size_t i = 0; i < p->last; i++) {
        if (is_in_waves(l->element[i].phase)) return "a surface has a phase";
        if (is_faceted(l->element[i].phase)) return "a surface has facets";
        if (has_two_powers(l->element[i].phase)) return "an ideal lens has two powers";
    }
    beam_ray ray = marginal_ray(p, o), chief = chief_ray(p, primary ? primary : o);
    for (size_t i = 0; i <= p->last; i++) {
        const vertex *v = &p->at[i];
        double n = ray.n.x, g;
        go_to(&ray, v->z), go_to(&chief, v->z);
        if (!fourth_order(l, i, v->c, &g)) return "a surface is not a plane, sphere, conic or even asphere";
        double y = ray.y.x, ybar = chief.y.x, w = ray.w.x, wbar = chief.w.x;
        double a = w + n * y * v->c, abar = wbar + n * ybar * v->c;
        double u = w / n, h = a * ybar - abar * y, m = i < p->last ? v->n.x : n;
        go_through(p, &ray, i, i + (i < p->last)), go_through(p, &chief, i, i + (i < p->last));
        double by_n = 1 / m - 1 / n, by_n2 = 1 / (m * m) - 1 / (n * n), slopes = ray.w.x / (m * m) - u / n;
        double aspheric = 8 * g * (m - n), colour = dn[i + 1] / m - dn[i] / n;
        seidel[i] = (sgt_seidel){
            .spherical = -a * a * y * slopes + aspheric * y * y * y * y,
            .coma = -a * abar * y * slopes + aspheric * y * y * y * ybar,
            .astigmatism = -abar * abar * y * slopes + aspheric * y * y * ybar * ybar,
            .petzval = -h * h * v->c * by_n,
            .distortion = abar * (-abar * abar * y * by_n2 - ybar * (a * ybar - 2 * abar * y) * v->c * by_n) +
                          aspheric * y * ybar * ybar * ybar,
            .chromatic = {a * y * colour, abar * y * colour},
        };
        if (l->surface[i].focal_length != 0)
            seidel[i] = (sgt_seidel){.chromatic = {y * (ray.w.x * dn[i + 1] / m - w * dn[i] / n),
                                                   y * (chief.w.x * dn[i + 1] / m - wbar * dn[i] / n)}};
        if (i == p->last) seidel[i] = (sgt_seidel){0};
    }
    return NULL;
}

/* The change of the index of each medium, from in front on, over the wavelengths of the file; with the sign
 * of the index. */
static void set_changes(const paraxial *p, sgt_element e[], double dn[])
{
    const sgt_lens *l = p->lens;
    double least = HUGE_VAL, most = 0, before[2] = {0};
    for (size_t i = 0; l->wavelength && i < l->wavelengths; i++)
        least = fmin(least, l->wavelength[i]), most = fmax(most, l->wavelength[i]);
    for (size_t i = 0; i <= l->count; i++) dn[i] = 0;
    for (int k = 0; k < 2 && most > 0; k++) {
        if (!sgt_lens_at(l, k ? most : least, e, &before[k], NULL)) {
            for (size_t i = 0; i <= l->count; i++) dn[i] = (double)NAN;
            return;
        }
        double index = before[k], sign = 1;
        dn[0] += (k ? -1 : 1) * index;
        for (size_t i = 0; i < l->count; i++) {
            if (e[i].index == SGT_MIRROR) sign = -sign;
            else if (e[i].index != 0) index = e[i].index;
            dn[i + 1] += (k ? -1 : 1) * sign * index;
        }
    }
}

/* ---------------------------------------------------------------- the whole */

static number index_of(double n) { return within(n, fabs(n) == 1 ? 0 : 4); }

/* An element without a vertex has the power NaN, and so has what depends on it.  room: for the elements at
 * um; NULL: those of the lens are. */
static bool set_vertices(paraxial *p, sgt_element room[], double um, size_t *without_vertex,
                         sgt_error *error)
{
    const sgt_lens *l = p->lens;
    const sgt_element *e = room ? room : l->element;
    double before;
    if (!sgt_lens_at(l, um, room, &before, error)) return false;
    number n = p->before = index_of(before);
    double sign = 1;
    for (size_t i = 0; i < l->count; i++) {
        vertex *v = &p->at[i];
        v->z = within(l->surface[i].z, 2);
        double size = l->surface[i].size > 0 && l->surface[i].size < 1e100 ? l->surface[i].size : 0x1p-10;
        double focal_length = l->surface[i].focal_length;
        const sgt_surface bends = is_faceted(e[i].phase) ? e[i].phase->waves : e[i].surface;
        v->c = focal_length != 0 ? 0 : vertex_curvature(bends, size * 0x1p-30);
        if (e[i].index == SGT_MIRROR) sign = -sign;
        v->n = e[i].index == SGT_MIRROR ? (number){-n.x, n.err} : index_of(copysign(e[i].index, sign));
        if (l->surface[i].off_axis) v->c = (double)NAN;
        v->power = focal_length != 0    ? within(1 / focal_length, 2)
                   : v->n.x == n.x      ? exactly(0 * v->c) /* one medium */
                                        : product(within(v->c, 4), difference(v->n, n));
        v->bent = is_faceted(e[i].phase) ? no_number : v->power;
        if (is_in_waves(e[i].phase)) {
            const double bend = e[i].phase->per_wave * vertex_bend(e[i].phase, v->c, size * 0x1p-10);
            v->power = difference(v->power, isfinite(bend) ? within(bend, 8) : no_number);
        }
        if (l->surface[i].off_axis) v->power = v->bent = no_number;
        if ((isnan(v->c) || isnan(v->power.x)) && i < p->last && !*without_vertex) *without_vertex = i + 1;
        n = v->n;
    }
    return true;
}

void sgt_paraxial_objects(const sgt_lens *l, double um, source *s, double distance[])
{
    size_t without_vertex = 0;
    sgt_error unread;
    paraxial p = {.lens = l, .last = l->count - 1, .at = tree_room(s, l->count, sizeof *p.at)};
    for (size_t i = 0; i < l->count; i++) distance[i] = (double)NAN;
    if (!set_vertices(&p, tree_room(s, l->count, sizeof(sgt_element)), um, &without_vertex, &unread)) return;
    const double d = l->object_distance;
    beam_ray r = isfinite(d) ? ray_at_first(&p, within(d, 1), p.before)
                             : ray_at_first(&p, exactly(1), exactly(0));
    for (size_t i = 0; i < l->count; i++) {
        go_to(&r, p.at[i].z);
        distance[i] = settled(r.w) == 0 ? HUGE_VAL : r.y.x * fabs(r.n.x) / r.w.x;
        go_through(&p, &r, i, i + 1);
    }
}

/* At um, with the pupil of `primary` (NULL: its own). */
static bool first_order_at(const whole_lens *w, double um, const sgt_first_order *primary,
                           sgt_first_order *out, sgt_seidel seidel[], sgt_error *error)
{
    const sgt_lens *lens = &w->lens;
    const sgt_allocator *a = &w->memory.allocator;
    reader r = {.file = lens->file, .error = error};
    struct room { vertex *at; sgt_element *element; double *dn; } room = {.at = NULL};
    const bool own = isnan(um) || (lens->wavelength && um == lens->wavelength[lens->primary]);
    room.at = a->resize(a->context, NULL, lens->count * sizeof *room.at);
    if (!own || seidel) room.element = a->resize(a->context, NULL, lens->count * sizeof *room.element);
    if (seidel) room.dn = a->resize(a->context, NULL, (lens->count + 1) * sizeof *room.dn);
    paraxial p = {.lens = lens, .last = lens->count - 1, .at = room.at};
    bool fine = room.at && (own || room.element) && (!seidel || (room.element && room.dn));
    if (!fine) sgt_reader_fail(&r, 0, "", "no memory");
    *out = (sgt_first_order){.wavelength = um};
    fine = fine && set_vertices(&p, own ? NULL : room.element, um, &out->without_vertex, error);
    if (fine) {
        set_points(&p, out);
        set_pupils(&p, primary, out);
        set_field(&p, primary, out);
        if (seidel) set_changes(&p, room.element, room.dn);
        const char *lacks = seidel ? set_seidel(&p, primary, out, room.dn, seidel) : NULL;
        const double none = (double)NAN;
        for (size_t i = 0; lacks && i < lens->count; i++)
            seidel[i] = (sgt_seidel){none, none, none, none, none, {none, none}, {0}};
        out->without_seidel = lacks;
    }
    if (room.at) a->resize(a->context, room.at, 0);
    if (room.element) a->resize(a->context, room.element, 0);
    if (room.dn) a->resize(a->context, room.dn, 0);
    return fine;
}

bool sgt_lens_first_order(const sgt_lens *lens, double um, sgt_first_order *out, sgt_seidel seidel[],
                          sgt_error *error)
{
    const whole_lens *w = (const void *)lens;
    sgt_error unread;
    sgt_first_order primary;
    if (!error) error = &unread;
    const double reference = lens->wavelength ? lens->wavelength[lens->primary] : um;
    if (isnan(um)) um = reference;
    bool other = um != reference && !isnan(reference);
    if (other && !first_order_at(w, reference, NULL, &primary, NULL, error)) return false;
    return first_order_at(w, um, other ? &primary : NULL, out, seidel, error);
}
