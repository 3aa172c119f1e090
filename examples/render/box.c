// SPDX-License-Identifier: MIT
/* box.c - a surface of one's own with corners: a box.
 *
 *     F = max(|x| - a, |y| - b, |z| - c)
 *
 * F is continuous, and convex along every ray.  The ray is within the slab |x| <= a from t1 to t2, and so for
 * y and z; it is in the box from the last t1 to the first t2.  Those are its two roots, or, if the last t1 is
 * greater, it has none.  `first` gives a bracket about the one that is asked for: beyond the middle F is
 * convex, so it changes its sign once.  The ends are moved outward by what rounding can do to them.  A ray
 * that passes an edge so near that rounding hides whether it meets it, is left to `enclose`.
 *
 * Over an interval of t each |x| - a is enclosed by its values at the ends and by -a, if x is 0 between.
 * F is the largest of the three.  Its slope is that of any of the three that can be the largest.  Where
 * two are so, F has a kink, but is continuous, and the slopes on both sides are among those: a mean value
 * theorem holds. */
#include "own.h"

#include "vector.h"

static const double U = 0x1p-53;

static inline double formula(const box *s, vec3 p, vec3 *grad)
{
    double x = fabs(p.x) - s->half[0], y = fabs(p.y) - s->half[1], z = fabs(p.z) - s->half[2];
    double most = x > y ? x : y;
    most = most > z ? most : z;
    double gx = x == most ? 1 : 0, gy = x == most ? 0 : y == most ? 1 : 0, gz = 1 - gx - gy;
    *grad = (vec3){p.x < 0 ? -gx : gx, p.y < 0 ? -gy : gy, p.z < 0 ? -gz : gz};
    return x + y + z == x + y + z ? most : (double)NAN;
}

static double box_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    vec3 unwanted;
    return formula(self, p, grad ? grad : &unwanted);
}

static void box_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        vec3 grad;
        out.f[i] = formula(self, own_at(p.p, i), &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

/* A difference each. */
static double box_rounding(const void *self, sgt_vec3 p)
{
    const box *s = self;
    return U * (fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) + fmax(s->half[0], fmax(s->half[1], s->half[2])));
}

/* The stretch in the box, and how far its ends may be off.  That is drawn far larger than rounding is: the
 * sign of F is to be certain at the ends of a span, also where a ray starts on a face and leaves. */
typedef struct passage { double in, out, off; } passage;
static const double WIDER = 0x1p-34;

static inline passage passage_of(const box *s, vec3 at, vec3 along)
{
    double o[3] = {at.x, at.y, at.z}, d[3] = {along.x, along.y, along.z};
    passage p = {-HUGE_VAL, HUGE_VAL, 0};
    for (int i = 0; i < 3; i++) {
        double t1 = (-s->half[i] - o[i]) / d[i], t2 = (s->half[i] - o[i]) / d[i], lo = t1 < t2 ? t1 : t2,
               hi = t1 < t2 ? t2 : t1, size = (s->half[i] + fabs(o[i])) / fabs(d[i]) * WIDER;
        bool level = d[i] == 0, beside = fabs(o[i]) > s->half[i];
        lo = level ? (beside ? HUGE_VAL : -HUGE_VAL) : lo, hi = level ? HUGE_VAL : hi,
        size = level ? 0 : size;
        p.in = lo > p.in ? lo : p.in, p.out = hi < p.out ? hi : p.out, p.off = size > p.off ? size : p.off;
    }
    return p;
}

/* Of both roots. */
static sgt_span box_span(const void *self, const sgt_ray *ray)
{
    passage p = passage_of(self, ray->o, ray->d);
    bool passes = p.in > p.out + 2 * p.off || p.in == HUGE_VAL;
    return (sgt_span){
        .lo = passes ? 1 : p.in - p.off, .hi = passes ? -1 : p.out + p.off, .seed = (double)NAN};
}

static void box_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = own_at(rays.o, i), .d = own_at(rays.d, i)};
        sgt_span span = box_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = false;
    }
}

/* The root where it goes in, if that is behind tmin; if tmin is in the box for certain, that where it goes
 * out. */
static sgt_span box_first(const void *self, const sgt_ray *ray)
{
    passage p = passage_of(self, ray->o, ray->d);
    double middle = 0.5 * (p.in + p.out), apart = 4 * p.off;
    double tmax = ray->tmax;
    sgt_span none = {.lo = 1, .hi = -1, .seed = (double)NAN, .single = true},
             in = {.lo = p.in - p.off, .hi = middle, .seed = p.in, .single = true},
             out = {.lo = middle, .hi = p.out + p.off, .seed = p.out, .single = true};
    if (p.in > p.out + 2 * p.off || p.in == HUGE_VAL || ray->tmin > p.out + apart || tmax < p.in - apart)
        return none;
    if (p.out - p.in > 4 * apart && ray->tmin < p.in - apart) return in;
    if (p.out - p.in > 4 * apart && ray->tmin > p.in + apart && ray->tmin < p.out - apart) return out;
    none.lo = -HUGE_VAL, none.hi = HUGE_VAL, none.single = false;
    return none;
}

static void box_firsts(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = own_at(rays.o, i), .d = own_at(rays.d, i)};
        ray.tmin = rays.tmin ? rays.tmin[i] : 0, ray.tmax = rays.tmax ? rays.tmax[i] : HUGE_VAL;
        sgt_span span = box_first(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

/* |x| - a over t, where x = o + t d; and its slope. */
static sgt_interval wall(double half, double o, double d, sgt_interval t, sgt_interval *slope)
{
    double a = o + t.lo * d, b = o + t.hi * d,
           off = 4 * U * (fabs(o) + fmax(fabs(t.lo), fabs(t.hi)) * fabs(d) + half);
    double least = fmin(a, b) - off, most = fmax(a, b) + off, size = fmax(fabs(least), fabs(most));
    bool turns = least <= 0 && most >= 0;
    *slope = turns       ? (sgt_interval){-fabs(d), fabs(d)}
             : least > 0 ? (sgt_interval){d, d}
                         : (sgt_interval){-d, -d};
    return (sgt_interval){(turns ? 0 : fmin(fabs(least), fabs(most))) - half - off, size - half + off};
}

static sgt_interval box_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const box *s = self;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    sgt_interval f[3], g[3], all = {-HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < 3; i++) {
        f[i] = wall(s->half[i], o[i], d[i], t, &g[i]);
        all.lo = fmax(all.lo, f[i].lo), all.hi = fmax(all.hi, f[i].hi);
    }
    *slope = (sgt_interval){HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < 3; i++)
        if (f[i].hi >= all.lo) slope->lo = fmin(slope->lo, g[i].lo), slope->hi = fmax(slope->hi, g[i].hi);
    return all;
}

const sgt_surface_ops box_ops = {.name = "box",
                                 .value = box_value,
                                 .span = box_span,
                                 .rounding = box_rounding,
                                 .enclose = box_enclose,
                                 .values = box_values,
                                 .spans = box_spans,
                                 .first = box_first,
                                 .firsts = box_firsts};
