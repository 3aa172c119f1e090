// SPDX-License-Identifier: MIT
/* quad.c - Newton's method in 113 bits, on the formulas of formulas.hpp and text.hpp.
 *
 * For a sag on a conic base the function is the polynomial in z - P with the same zeros.  It has no square
 * root, so it is defined beyond the equator too.
 *
 * The start is right to at least 50 bits, so two steps reach the last bits, and the third confirms it.
 * `quad_meet` asks that a step is at most 2^-96 of the coordinates.  If the many terms of a polynomial
 * cancel, 2^-72 after all steps will do: that still measures the errors of doubles.  At a double root this
 * fails, because each step is half the last.
 *
 * A PHASE IN WAVES is a sag, found in the same way along z, or the value of a formula.
 *
 * A TRACE makes the axes of a pose exactly orthogonal, as they are meant to be.  In doubles they are so only
 * to 2^-50. */
#include "quad.h"

#include <math.h>

bool quad_there(void)
{
#ifdef QUAD_MISSING
    return false;
#else
    return true;
#endif
}

static quad magnitude(quad x) { return x < 0 ? -x : x; }
static quad larger(quad a, quad b) { return a > b ? a : b; }

/* The square root, by Newton from the double's: 53 bits, 105, 113.  0 if x <= 0 as a double. */
static quad root(quad x)
{
    quad y = sqrt((double)x);
    if (!(y > 0)) return 0;
    y = (y + x / y) / 2;
    return (y + x / y) / 2;
}

static quad quad_dot(quad3 a, quad3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static quad3 along(quad3 o, quad t, quad3 d) { return (quad3){o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}; }
static quad3 times(quad k, quad3 a) { return (quad3){k * a.x, k * a.y, k * a.z}; }
static quad3 unit(quad3 a) { return times(1 / root(quad_dot(a, a)), a); }
static quad3 widened(sgt_vec3 a) { return (quad3){a.x, a.y, a.z}; }
static quad size(quad3 a) { return larger(magnitude(a.x), larger(magnitude(a.y), magnitude(a.z))); }

quad quad_distance(quad3 a, sgt_vec3 b)
{
    quad3 between = along(a, -1, widened(b));
    return root(quad_dot(between, between));
}

/* ------------------------------------------------------------------ roots */

static bool meet(const quad_formula *f, quad3 o, quad3 d, quad *t, quad3 *grad)
{
    bool near = false;
    for (int i = 0; i < 8; i++) {
        quad g = quad_value(f, along(o, *t, d), grad), step = -g / quad_dot(*grad, d);
        if (!(magnitude(step) <= (quad)DBL_MAX)) return false; /* false for NaN too */
        *t += step;
        quad reach = magnitude(*t) * size(d);
        if (magnitude(step) * size(d) <= 0x1p-96 * larger(size(o), reach)) return true;
        near = magnitude(step) * size(d) <= 0x1p-72 * larger(size(o), reach);
    }
    return near;
}

bool quad_meet(sgt_surface s, const sgt_ray *ray, quad *t)
{
    quad3 grad;
    return meet(quad_formula_of(s), widened(ray->o), widened(ray->d), t, &grad);
}

/* ----------------------------------------------------------------- traces */

static const double SAME_ROOT = 0x1p-26; /* of the size of the numbers involved */

typedef struct frame { quad3 origin, x, y, z; } frame;

static frame frame_of(const sgt_pose *pose)
{
    frame f = {widened(pose->origin), widened(pose->ex), widened(pose->ey), widened(pose->ez)};
    if (quad_dot(f.x, f.x) == 0) return (frame){f.origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    f.x = unit(f.x);
    f.y = unit(along(f.y, -quad_dot(f.x, f.y), f.x));
    f.z = unit(along(along(f.z, -quad_dot(f.x, f.z), f.x), -quad_dot(f.y, f.z), f.y));
    return f;
}

static quad3 into(const frame *f, quad3 v)
{
    return (quad3){quad_dot(v, f->x), quad_dot(v, f->y), quad_dot(v, f->z)};
}
static quad3 out_of(const frame *f, quad3 v) { return along(along(times(v.x, f->x), v.y, f->y), v.z, f->z); }

/* Snell's law: d' = r d + (sqrt(1 - r^2 (1 - cos^2)) - r cos) n, with n on the side the light goes to. */
static quad3 refracted(quad3 d, quad3 n, quad ratio)
{
    quad cosine = quad_dot(d, n);
    if (cosine < 0) n = times(-1, n), cosine = -cosine;
    quad behind = root(1 - ratio * ratio * (1 - cosine * cosine));
    return unit(along(times(ratio, d), behind - ratio * cosine, n));
}

/* The direction behind an ideal lens, by slopes, and the path that it adds, as system.h defines them: p, d in
 * its frame. */
static quad3 focused(const sgt_element *e, quad n1, quad n2, quad3 p, quad3 d, quad *more)
{
    const sgt_phase *a = e->phase;
    quad to = d.z < 0 ? -1 : 1, x = p.x, y = p.y, fx = a->focal_length,
         fy = a->focal_length_y == 0 ? a->focal_length : a->focal_length_y;
    quad near = a->object_distance == 0 ? 0 : 1 / (quad)a->object_distance;
    quad u = d.x / (to * d.z), v = d.y / (to * d.z), u0 = u - near * x, v0 = v - near * y;
    quad u2 = (n1 * u - x / fx) / n2, v2 = (n1 * v - y / fy) / n2, u02 = n1 * u0 / n2, v02 = n1 * v0 / n2;
    quad in = root(1 + u * u + v * v) + root(1 + u0 * u0 + v0 * v0);
    quad out = root(1 + u2 * u2 + v2 * v2) + root(1 + u02 * u02 + v02 * v02);
    *more = n2 * (x * (u2 + u02) + y * (v2 + v02)) / out - n1 * (x * (u + u0) + y * (v + v0)) / in;
    return unit((quad3){u2, v2, e->index == SGT_MIRROR ? -to : to});
}

/* The direction behind a phase in waves, as system.h defines it, and the path that it adds: p, d and the
 * gradient n of the surface in its frame.  false: there is none, or no formula for W. */
static bool kicked(const sgt_element *e, quad n1, quad n2, quad3 p, quad3 n, quad3 *d, quad *more)
{
    const sgt_phase *a = e->phase;
    const quad_formula *f = quad_formula_of(a->waves);
    const bool facets = a->kind == SGT_FACETS, sag = facets || a->kind == SGT_PHASE_SAG,
               back = e->index == SGT_MIRROR;
    quad3 g = {0, 0, 0}, on_axis = {p.x, p.y, 0}, up_axis = {0, 0, 1};
    quad w, scale = a->per_wave;
    if (!f) return false;
    if (sag) { /* the z where F = 0, and its slopes */
        w = -a->waves.ops->value(a->waves.self, (sgt_vec3){(double)p.x, (double)p.y, 0}, NULL);
        if (!meet(f, on_axis, up_axis, &w, &g)) return false;
        g = (quad3){-g.x / g.z, -g.y / g.z, 0};
    } else {
        w = quad_value(f, p, &g);
    }
    if (facets) n = (quad3){-g.x, -g.y, 1}, g = (quad3){0, 0, 0}, scale = (quad)NAN;
    n = unit(n);
    quad3 u = along(times(n1, *d), scale, g), t = along(u, -quad_dot(u, n), n);
    quad q = n2 * n2 - quad_dot(t, t);
    if (!(q > 0)) return false;
    bool up = (quad_dot(*d, n) > 0) != back;
    *d = unit(along(t, up ? root(q) : -root(q), n));
    *more = scale * w;
    return true;
}

bool quad_trace(size_t passed, const sgt_element e[], double index_before, const sgt_ray *ray,
                const sgt_passage seen[], quad3 *point, quad *path)
{
    quad3 o = widened(ray->o), d = unit(widened(ray->d));
    quad index = index_before == 0 ? 1 : index_before;
    *path = 0;
    for (size_t i = 0; i < passed; i++) {
        frame f = frame_of(&e[i].pose);
        quad3 q = into(&f, along(o, -1, f.origin)), v = into(&f, d), grad;
        quad guess = (quad)seen[i].hit.t + seen[i].hit.t_lo, t = guess;
        if (!meet(quad_formula_of(e[i].surface), q, v, &t, &grad)) return false;
        if (!(magnitude(t - guess) <= SAME_ROOT * (size(q) + magnitude(guess)))) return false;
        o = along(o, t, d);
        *path += index * t;
        quad3 n = unit(out_of(&f, grad));
        if (e[i].phase && e[i].phase->kind != SGT_IDEAL_LENS) {
            quad behind = e[i].index == 0 || e[i].index == SGT_MIRROR ? index : (quad)e[i].index, more;
            if (!kicked(&e[i], index, behind, along(q, t, v), grad, &v, &more)) return false;
            d = out_of(&f, v);
            *path += more;
            index = behind;
        } else if (e[i].phase) {
            quad behind = e[i].index == 0 || e[i].index == SGT_MIRROR ? index : (quad)e[i].index, more;
            d = out_of(&f, focused(&e[i], index, behind, along(q, t, v), v, &more));
            *path += more;
            index = behind;
        } else if (e[i].index == SGT_MIRROR) {
            d = unit(along(d, -2 * quad_dot(d, n), n));
        } else if (e[i].index != 0 && e[i].index != (double)index) {
            d = refracted(d, n, index / e[i].index);
            index = e[i].index;
        }
    }
    *point = o;
    return true;
}
