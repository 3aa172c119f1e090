/* quad.c - Newton's method in 113 bits, on forms of its own.
 *
 * SAGS.  With w = z - P(r^2), the conic and the asphere are G = w - (c r^2 + (1 + k) c w^2) / 2 = 0, a
 * polynomial in x, y, z: no square root, and no equator to fall off.  grad G = ((1 - (1 + k) c w) times
 * (-2 x P', -2 y P', 1)) - (c x, c y, 0) is along that of F at a root.
 *
 * LEVEL SETS.  G = |Q_N|^2 - E^2, the orbit carried with its three derivatives: of Q^p by
 * (Q^m Q)' = (Q^m)' Q + Q^m Q'.  E as the library means it where 0 is given: the positive root of
 * x^p = x + |c|, of a mandelbrot that of x^(p - 1) = 2, by Newton from above, where both are convex.
 *
 * The start is right to 50 bits and more, so two steps reach the last bits, and a third sees that
 * they have.  That it does, to 2^-96 of the coordinates, is what `quad_meet` asks; a double root does
 * not come to rest so.
 *
 * A TRACE takes axes of a pose to be at right angles, as they are meant: the doubles are so to
 * 2^-50, and are made so here. */
#include "quad.h"

#include "fail.h"

#include <math.h>

void quad_check(void)
{
#ifdef QUAD_MISSING
    fail_usage("this sagitta was built without a number type of 113 bits, by which errors are told");
#endif
}

static quad magnitude(quad x) { return x < 0 ? -x : x; }
static quad larger(quad a, quad b) { return a > b ? a : b; }

/* Newton from the double's root: 53 bits, 105, 113.  0 of what a double cannot tell from it. */
static quad root(quad x)
{
    quad y = sqrt((double)x);
    if (!(y > 0)) return 0;
    y = (y + x / y) / 2;
    return (y + x / y) / 2;
}

static quad dot(quad3 a, quad3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static quad3 along(quad3 o, quad t, quad3 d) { return (quad3){o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}; }
static quad3 times(quad k, quad3 a) { return (quad3){k * a.x, k * a.y, k * a.z}; }
static quad3 unit(quad3 a) { return times(1 / root(dot(a, a)), a); }
static quad3 widened(sgt_vec3 a) { return (quad3){a.x, a.y, a.z}; }
static quad size(quad3 a) { return larger(magnitude(a.x), larger(magnitude(a.y), magnitude(a.z))); }

quad quad_distance(quad3 a, sgt_vec3 b)
{
    quad3 between = along(a, -1, widened(b));
    return root(dot(between, between));
}

/* --------------------------------------------------------------- surfaces */

static quad sag_value(quad c, quad k, const double *a, quad3 p, quad3 *grad)
{
    quad r2 = p.x * p.x + p.y * p.y, sum = 0, slope = 0;
    for (int i = 7; a && i >= 0; i--) {
        slope = slope * r2 + (i + 1) * (quad)a[i];
        sum = (sum + a[i]) * r2;
    }
    quad w = p.z - sum, by_w = 1 - (1 + k) * c * w, by_r = -(2 * by_w * slope + c);
    *grad = (quad3){p.x * by_r, p.y * by_r, by_w};
    return w - (c * r2 + (1 + k) * c * w * w) / 2;
}

typedef struct quad4 { quad a, b, c, d; } quad4;

static quad4 sum4(quad4 x, quad4 y) { return (quad4){x.a + y.a, x.b + y.b, x.c + y.c, x.d + y.d}; }
static quad dot4(quad4 x, quad4 y) { return x.a * y.a + x.b * y.b + x.c * y.c + x.d * y.d; }
static quad4 product4(quad4 x, quad4 y)
{
    return (quad4){x.a * y.a - x.b * y.b - x.c * y.c - x.d * y.d, x.a * y.b + x.b * y.a + x.c * y.d - x.d * y.c,
                   x.a * y.c - x.b * y.d + x.c * y.a + x.d * y.b, x.a * y.d + x.b * y.c - x.c * y.b + x.d * y.a};
}

/* A julia; or a mandelbrot, whose c is the point. */
typedef struct orbit { quad4 c, at, axis[3]; quad escape; int iterations, power; bool mandelbrot; } orbit;

static quad4 widened4(const double v[4]) { return (quad4){v[0], v[1], v[2], v[3]}; }

static quad whole_power(quad x, int n)
{
    quad y = 1;
    while (n-- > 0) y *= x;
    return y;
}

/* From 2 + |c| down to the root of x^p = x + |c|; of a mandelbrot, where |c| = |x|, of x^p = 2 x. */
static quad safe_escape(quad c, int p, bool mandelbrot)
{
    quad x = 3 + c, next = 2 + c;
    while (next < x) {
        x = next;
        quad g = whole_power(x, p) - (mandelbrot ? 2 * x : x + c), slope = p * whole_power(x, p - 1) - (mandelbrot ? 2 : 1);
        next = x - g / slope;
    }
    return x;
}

static orbit orbit_of(const double *c, const double *at, const double *ex, const double *ey, const double *ez, double escape,
                      int iterations, int power)
{
    static const double own[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    const double *axes[3] = {ex, ey, ez};
    bool given = false;
    for (int i = 0; i < 12; i++) given = given || axes[i / 4][i % 4] != 0;
    orbit o = {.at = widened4(at), .iterations = iterations ? iterations : 10, .power = power ? power : 2, .mandelbrot = !c};
    for (int i = 0; i < 3; i++) o.axis[i] = widened4(given ? axes[i] : own[i]);
    if (c) o.c = widened4(c);
    o.escape = escape != 0 ? escape : safe_escape(root(dot4(o.c, o.c)), o.power, o.mandelbrot);
    return o;
}

static quad orbit_value(const orbit *o, quad3 p, quad3 *grad)
{
    const quad place[3] = {p.x, p.y, p.z};
    quad4 q = o->at, slope[3];
    for (int i = 0; i < 3; i++) {
        quad4 e = o->axis[i];
        q = sum4(q, (quad4){place[i] * e.a, place[i] * e.b, place[i] * e.c, place[i] * e.d});
        slope[i] = e;
    }
    quad4 c = o->mandelbrot ? q : o->c;
    for (int n = o->mandelbrot ? 1 : 0; n < o->iterations; n++) {
        quad4 power = q, by[3] = {slope[0], slope[1], slope[2]};
        for (int m = 1; m < o->power; m++) {
            for (int i = 0; i < 3; i++) by[i] = sum4(product4(by[i], q), product4(power, slope[i]));
            power = product4(power, q);
        }
        q = sum4(power, c);
        for (int i = 0; i < 3; i++) slope[i] = o->mandelbrot ? sum4(by[i], o->axis[i]) : by[i];
    }
    *grad = (quad3){2 * dot4(q, slope[0]), 2 * dot4(q, slope[1]), 2 * dot4(q, slope[2])};
    return dot4(q, q) - o->escape * o->escape;
}

typedef struct shape { const sgt_conic *conic; const sgt_asphere *asphere; orbit set; } shape;

bool quad_knows(sgt_surface s)
{
    return s.ops == &sgt_conic_ops || s.ops == &sgt_asphere_ops || s.ops == &sgt_julia_ops || s.ops == &sgt_mandelbrot_ops;
}

static shape shape_of(sgt_surface s)
{
    shape f = {.conic = NULL};
    if (s.ops == &sgt_conic_ops) f.conic = s.self;
    else if (s.ops == &sgt_asphere_ops) f.asphere = s.self;
    else if (s.ops == &sgt_julia_ops) {
        const sgt_julia *j = s.self;
        f.set = orbit_of(j->c, j->at, j->ex, j->ey, j->ez, j->escape, j->iterations, j->power);
    } else {
        const sgt_mandelbrot *m = s.self;
        f.set = orbit_of(NULL, m->at, m->ex, m->ey, m->ez, m->escape, m->iterations, m->power);
    }
    return f;
}

static quad value(const shape *f, quad3 p, quad3 *grad)
{
    if (f->conic) return sag_value(f->conic->c, f->conic->k, NULL, p, grad);
    if (f->asphere) return sag_value(f->asphere->c, f->asphere->k, f->asphere->a, p, grad);
    return orbit_value(&f->set, p, grad);
}

/* ------------------------------------------------------------------ roots */

static bool meet(const shape *f, quad3 o, quad3 d, quad *t, quad3 *grad)
{
    for (int i = 0; i < 8; i++) {
        quad g = value(f, along(o, *t, d), grad), step = -g / dot(*grad, d);
        if (!(magnitude(step) <= (quad)DBL_MAX)) return false; /* a NaN as well */
        *t += step;
        quad reach = magnitude(*t) * size(d);
        if (magnitude(step) * size(d) <= 0x1p-96 * larger(size(o), reach)) return true;
    }
    return false;
}

bool quad_meet(sgt_surface s, const sgt_ray *ray, quad *t)
{
    shape f = shape_of(s);
    quad3 grad;
    return meet(&f, widened(ray->o), widened(ray->d), t, &grad);
}

/* ----------------------------------------------------------------- traces */

static const double SAME_ROOT = 0x1p-26; /* of the lengths that are added up */

typedef struct frame { quad3 origin, x, y, z; } frame;

static frame frame_of(const sgt_pose *pose)
{
    frame f = {widened(pose->origin), widened(pose->ex), widened(pose->ey), widened(pose->ez)};
    if (dot(f.x, f.x) == 0) return (frame){f.origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    f.x = unit(f.x);
    f.y = unit(along(f.y, -dot(f.x, f.y), f.x));
    f.z = unit(along(along(f.z, -dot(f.x, f.z), f.x), -dot(f.y, f.z), f.y));
    return f;
}

static quad3 into(const frame *f, quad3 v) { return (quad3){dot(v, f->x), dot(v, f->y), dot(v, f->z)}; }
static quad3 out_of(const frame *f, quad3 v) { return along(along(times(v.x, f->x), v.y, f->y), v.z, f->z); }

/* d = r d + (sqrt(1 - r^2 (1 - cos^2)) - r cos) n with n on the side to which the light goes. */
static quad3 refracted(quad3 d, quad3 n, quad ratio)
{
    quad cosine = dot(d, n);
    if (cosine < 0) n = times(-1, n), cosine = -cosine;
    quad behind = root(1 - ratio * ratio * (1 - cosine * cosine));
    return unit(along(times(ratio, d), behind - ratio * cosine, n));
}

bool quad_trace(size_t passed, const sgt_element e[], double index_before, const sgt_ray *ray, const sgt_passage seen[],
                quad3 *point, quad *path)
{
    quad3 o = widened(ray->o), d = unit(widened(ray->d));
    quad index = index_before == 0 ? 1 : index_before;
    *path = 0;
    for (size_t i = 0; i < passed; i++) {
        frame f = frame_of(&e[i].pose);
        shape s = shape_of(e[i].surface);
        quad3 q = into(&f, along(o, -1, f.origin)), v = into(&f, d), grad;
        quad guess = (quad)seen[i].hit.t + seen[i].hit.t_lo, t = guess;
        if (!meet(&s, q, v, &t, &grad)) return false;
        if (!(magnitude(t - guess) <= SAME_ROOT * (size(q) + magnitude(guess)))) return false;
        o = along(o, t, d);
        *path += index * t;
        quad3 n = unit(out_of(&f, grad));
        if (e[i].index == SGT_MIRROR) {
            d = unit(along(d, -2 * dot(d, n), n));
        } else if (e[i].index != 0 && e[i].index != (double)index) {
            d = refracted(d, n, index / e[i].index);
            index = e[i].index;
        }
    }
    *point = o;
    return true;
}
