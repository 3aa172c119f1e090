// SPDX-License-Identifier: MIT
/* test_own.c - do this program's own surfaces keep their word?
 *
 * The triplex power is worked out here by angles, in long double, which is not how the program does it.
 * SAGITTA_TEST_SEED chooses other cases, SAGITTA_TEST_SCALE
 * multiplies how many. */
#include "model.h"
#include "own.h"

#include <float.h>
#include <sagitta/diagnose.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t state;
static long failed, looked_at;

static double uniform(double lo, double hi) /* splitmix64 (Steele, Lea and Flood 2014) */
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return lo + (hi - lo) * ldexp((double)((z ^ (z >> 31)) >> 11), -53);
}

static vec3 direction(void)
{
    double z = uniform(-1, 1), a = uniform(0, 6.283185307179586), r = sqrt(1 - z * z);
    return (vec3){r * cos(a), r * sin(a), z};
}

static void require(bool good, const char *what, vec3 p, double a, double b)
{
    looked_at++;
    if (good || failed++ > 20) return;
    printf("FAILED %s at (%a, %a, %a): %.17g, %.17g\n", what, p.x, p.y, p.z, a, b);
}

static bool same(double a, double b) { return (isnan(a) && isnan(b)) || memcmp(&a, &b, sizeof a) == 0; }

/* ---------------------------------------------------------------- the bulb */

/* F by angles; *radius is |v_N|. */
static long double bulb_by_angles(const mandelbulb *s, vec3 at, long double dx, long double dy,
                                  long double dz)
{
    long double x = at.x + dx, y = at.y + dy, z = at.z + dz, cx = x, cy = y, cz = z;
    for (int n = 1; n < s->iterations; n++) {
        long double r = sqrtl(x * x + y * y + z * z), theta = 8 * atan2l(sqrtl(x * x + y * y), z),
                    phi = 8 * atan2l(y, x);
        if (r > 1e15L) return 1;
        r = powl(r, 8);
        x = r * sinl(theta) * cosl(phi) + cx, y = r * sinl(theta) * sinl(phi) + cy, z = r * cosl(theta) + cz;
    }
    long double u = (x * x + y * y + z * z) / ((long double)s->escape * s->escape);
    return isfinite(u) ? (u - 1) / (u + 1) : 1;
}

/* A point near the surface, by halving between inside and outside until |F| is small, and a little off. */
static vec3 near_bulb(const mandelbulb *s)
{
    vec3 d = direction();
    double lo = 0, hi = 1.4;
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (lo + hi);
        if (mandelbulb_ops.value(s, scaled(d, middle), NULL) > 0) hi = middle;
        else lo = middle;
    }
    return along(scaled(d, lo), pow(10, uniform(-7, -0.3)), direction());
}

static void test_bulb(long count)
{
    for (long i = 0; i < count; i++) {
        const mandelbulb s = {.escape = uniform(1.2, 1) < 1.1 ? 2 : uniform(1.2, 4),
                              .iterations = 1 + (int)uniform(1, 6)};
        vec3 p = near_bulb(&s), n;
        if (i % 50 == 0) p.x = p.y = 0; /* the axis, where the power has no derivative, and near it */
        if (i % 10 == 1) p = (vec3){p.x * pow(10, uniform(-4, 0)), p.y * pow(10, uniform(-4, 0)), p.z};
        double f = mandelbulb_ops.value(&s, p, &n), rounding = mandelbulb_ops.rounding(&s, p);
        long double wanted = bulb_by_angles(&s, p, 0, 0, 0);
        require(fabs((double)(f - wanted)) <= rounding + 1e-17, "bulb, value", p, f, (double)wanted);

        long double h = 1e-8L, q[3] = {bulb_by_angles(&s, p, h, 0, 0) - bulb_by_angles(&s, p, -h, 0, 0),
                                       bulb_by_angles(&s, p, 0, h, 0) - bulb_by_angles(&s, p, 0, -h, 0),
                                       bulb_by_angles(&s, p, 0, 0, h) - bulb_by_angles(&s, p, 0, 0, -h)};
        vec3 m = {(double)(q[0] / (2 * h)), (double)(q[1] / (2 * h)), (double)(q[2] / (2 * h))};
        /* the third derivatives times h^2 / 6 are below this where the gradient is moderate and the axis is
         * away */
        if (length(m) < 1e3 && p.x * p.x + p.y * p.y > 1e-3)
            require(length(subtract(m, n)) <= 1e-5 * (1 + length(m) * length(m)), "bulb, gradient", p,
                    length(n), length(m));
    }
    printf("bulb: %ld points\n", count);
}

/* A function of tau that a model stands for, and one that it does. */
static model any_model(long double tau, long double *value)
{
    double c = uniform(-2, 2), s = uniform(-1, 1) * pow(10, uniform(-16, 0)),
           e = uniform(0, 1) * pow(10, uniform(-18, 0));
    model a = {c, uniform(0, 1) < 0.3 ? 0 : s, uniform(0, 1) < 0.3 ? 0 : e};
    *value = a.c + a.s * tau + a.e * (uniform(0, 1) < 0.5 ? 1 : -1);
    return a;
}

/* known: to what the long doubles here are; the numbers are of 1 to 100. */
static void require_model(model a, long double tau, long double value, const char *what)
{
    const long double known = 100 * LDBL_EPSILON * (1 + fabsl(value));
    long double off = fabsl(value - (a.c + a.s * tau)) - known;
    require(off <= a.e && value + known >= lowest(a) && value - known <= highest(a), what,
            (vec3){a.c, a.s, a.e}, (double)off, a.e);
}

static void test_models(long count)
{
    for (long i = 0; i < count; i++) {
        long double tau = i % 3 ? uniform(-1, 1) : uniform(0, 1) < 0.5 ? 1 : -1, x, y;
        model a = any_model(tau, &x), b = any_model(tau, &y);
        require_model(plus(a, b), tau, x + y, "model, sum");
        require_model(minus(a, b), tau, x - y, "model, difference");
        require_model(product(a, b), tau, x * y, "model, product");
        require_model(product(a, a), tau, x * x, "model, square");
        double o = uniform(-9, 9), d = uniform(-2, 2), m = uniform(-9, 9), h = pow(10, uniform(-9, 1));
        require_model(on_ray(o, d, m, h), tau, o + (m + h * tau) * d, "model, a ray");
        if (!(lowest(a) > 0)) continue;
        require_model(inverse_of(a), tau, 1 / x, "model, inverse");
        require_model(root_of(a), tau, sqrtl(x), "model, root");
    }
}

/* A ray at a point near the surface; some in a plane of symmetry, where the orbit meets the axis again and
 * again, some through the axis, and some along it. */
static sgt_ray ray_at_bulb(const mandelbulb *s, long kind)
{
    vec3 at = near_bulb(s), d = direction();
    if (kind % 10 == 1) at.x = d.x = 0;
    if (kind % 10 == 2) at.x = at.y = 0;
    if (kind % 10 == 3) at.x = at.y = d.x = d.y = 0;
    double back = uniform(0, 4), size = pow(10, uniform(-1, 1));
    return (sgt_ray){.o = along(at, -back, d), .d = scaled(d, size), .tmin = back / size,
                     .tmax = HUGE_VAL};
}

static long double bulb_on_ray(const mandelbulb *s, const sgt_ray *ray, long double t)
{
    return bulb_by_angles(s, ray->o, t * ray->d.x, t * ray->d.y, t * ray->d.z);
}

/* F by angles is in the enclosure at points of the cell, and what it rises between two of them is in that
 * of the slope (the mean value theorem).  And it is narrow: by how much it is too wide falls with the
 * square of the cell. */
static void test_bulb_enclosure(long count)
{
    long sloped = 0, small = 0, square = 0;
    for (long i = 0; i < count; i++) {
        const mandelbulb s = {.escape = uniform(1.2, 4), .iterations = 1 + (int)uniform(0, 6)};
        sgt_ray ray = ray_at_bulb(&s, i);
        double width = pow(10, uniform(-7, 0.3)) / length(ray.d), from = ray.tmin - uniform(0, width);
        if (i % 4 == 0) width = 1e-5 / length(ray.d);
        sgt_interval t = {from, from + width}, slope, g = mandelbulb_ops.enclose(&s, &ray, t, &slope);
        long double f[17], lowest = HUGE_VALL, highest = -HUGE_VALL;
        for (int k = 0; k <= 16; k++) {
            f[k] = bulb_on_ray(&s, &ray, k == 16 ? t.hi : t.lo + (t.hi - t.lo) * (k / 16.0L));
            lowest = fminl(lowest, f[k]), highest = fmaxl(highest, f[k]);
            require(g.lo <= f[k] && f[k] <= g.hi, "bulb, enclosure", ray.o, (double)f[k], g.lo);
        }
        bool known = fabs(slope.lo) < HUGE_VAL && fabs(slope.hi) < HUGE_VAL;
        sloped += known;
        for (int k = 0; k < 16 && known && width * length(ray.d) > 1e-5; k++)
            for (int j = k + 1; j <= 16; j += 5) {
                long double rise = (f[j] - f[k]) / ((j - k) / 16.0L * (t.hi - t.lo)),
                            off = 1e-9L * (1 + fabsl(rise));
                require(slope.lo <= rise + off && rise - off <= slope.hi, "bulb, slope", ray.o, (double)rise,
                        slope.lo);
            }
        if (i % 4 || !known || lowest > 0.5L || highest < -0.5L) continue;
        sgt_interval part = {from + 0.45 * width, from + 0.55 * width},
                     narrow = mandelbulb_ops.enclose(&s, &ray, part, &slope);
        double too_wide = g.hi - g.lo - (double)(highest - lowest),
               then = narrow.hi - narrow.lo -
                      fabs((double)(bulb_on_ray(&s, &ray, part.hi) - bulb_on_ray(&s, &ray, part.lo)));
        small++, square += then < 0.02 * too_wide + 1e-11;
    }
    printf("bulb: %ld of %ld cells have a slope; of %ld small ones %ld are narrower by the square\n", sloped,
           count, small, square);
    require(small > count / 200 && square > small * 9 / 10, "bulb, narrow cells", (vec3){0}, (double)small,
            (double)square);
}

/* Whole rays: a hit is where F changes its sign, and before it, or all along where nothing is met, F by
 * angles keeps its sign at many points.  Of those that start on the surface, too. */
static void test_bulb_rays(long count)
{
    long undecided[2] = {0}, hits = 0;
    for (long i = 0; i < count; i++) {
        const mandelbulb s = {.escape = 2, .iterations = 1 + (int)uniform(0, 5)};
        bool plane = i % 4 == 0;
        sgt_surface surface = {&mandelbulb_ops, &s};
        sgt_ray ray = ray_at_bulb(&s, plane ? 1 : 0);
        ray.tmin = 0;
        sgt_hit hit = sgt_intersect(surface, ray, NULL);
        if (i % 2 && hit.status > 0) {
            ray = (sgt_ray){.o = hit.p, .d = direction()};
            hit = sgt_intersect(surface, ray, NULL);
        }
        undecided[plane] += hit.status < 0;
        hits += hit.status > 0;
        if (hit.status < 0) continue;
        double end = (hit.status > 0 ? hit.t : 7 / length(ray.d)), off = 1e-9 / length(ray.d);
        long double first = bulb_on_ray(&s, &ray, fmin(off, 0.5 * end));
        for (int k = 1; k < 400; k++) {
            long double here = bulb_on_ray(&s, &ray, off + (end - 2 * off) * (k / 400.0L));
            require(end < 3 * off || first * here > 0, "bulb, a root before the first", ray.o, end * k / 400,
                    end);
        }
        if (hit.status != SGT_HIT) continue;
        long double a = bulb_on_ray(&s, &ray, hit.t - hit.t_err - off),
                    b = bulb_on_ray(&s, &ray, hit.t + hit.t_err + off);
        require(a * b < 0 || end < 3 * off, "bulb, no change of sign at the hit", ray.o, (double)a,
                (double)b);
    }
    printf("bulb: %ld rays, %ld hits, %ld undecided, and %ld in a plane of symmetry\n", count, hits,
           undecided[0], undecided[1]);
    require(hits > count / 3 && undecided[0] <= count / 200 && undecided[1] <= count / 50,
            "bulb, undecided rays", (vec3){0}, (double)undecided[0], (double)undecided[1]);
}

/* ------------------------------------------------------------------ the box */

/* The roots are where the ray is on a wall and within the others. */
static void test_box(long count)
{
    long undecided = 0;
    for (long i = 0; i < count; i++) {
        const box s = {{uniform(0.1, 2), uniform(0.1, 2), uniform(0.1, 2)}};
        vec3 at = {uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}, d = direction();
        if (i % 5 == 0) d.x = 0, d = unit(d);
        if (i % 25 == 0) d = (vec3){0, 0, 1};
        sgt_ray ray = {.o = along(at, -uniform(0, 6), d), .d = scaled(d, pow(10, uniform(-1, 1)))};
        const double o[3] = {ray.o.x, ray.o.y, ray.o.z}, v[3] = {ray.d.x, ray.d.y, ray.d.z};
        long double in = -HUGE_VALL, out = HUGE_VALL, near = HUGE_VALL;
        for (int k = 0; k < 3; k++) {
            if (v[k] == 0 && fabs(o[k]) > s.half[k]) in = HUGE_VALL;
            if (v[k] == 0) continue;
            long double a = ((long double)-s.half[k] - o[k]) / v[k],
                        b = ((long double)s.half[k] - o[k]) / v[k];
            in = fmaxl(in, fminl(a, b)), out = fminl(out, fmaxl(a, b));
        }
        near = fabsl(in - out) * length(ray.d);
        sgt_hit hit[4];
        int met = sgt_intersect_all((sgt_surface){&box_ops, &s}, ray, 4, hit, NULL), wanted = 0;
        long double roots[2];
        if (in <= out && in > 0) roots[wanted++] = in;
        if (in <= out && out > 0) roots[wanted++] = out;
        if (near < 1e-9L || fabsl(in) < 1e-9L || fabsl(out) < 1e-9L) continue;
        require(met == wanted, "box, the number of roots", ray.o, met, wanted);
        for (int k = 0; k < wanted && met == wanted; k++) {
            bool good = hit[k].status == SGT_HIT &&
                        fabsl(hit[k].t - roots[k]) <= hit[k].t_err + 1e-15L * fabsl(roots[k]);
            require(good, "box, a root", ray.o, hit[k].t, (double)roots[k]);
        }
        sgt_hit first = sgt_intersect((sgt_surface){&box_ops, &s}, ray, NULL);
        require(first.status == (wanted ? SGT_HIT : SGT_MISS), "box, the first", ray.o, first.status, wanted);
        if (!wanted) continue;
        require(fabsl(first.t - roots[0]) <= first.t_err + 1e-15L * fabsl(roots[0]), "box, the first root",
                ray.o, first.t, (double)roots[0]);
        /* off the face it has met: out of it nothing is met, into it the other side */
        vec3 turn = direction();
        bool inward = dot(turn, first.n) < 0;
        sgt_hit next = sgt_intersect((sgt_surface){&box_ops, &s}, (sgt_ray){.o = first.p, .d = turn}, NULL);
        undecided += next.status < 0;
        require(next.status < 0 || next.status == (inward ? SGT_HIT : SGT_MISS), "box, from a face", first.p,
                next.status, inward);
    }
    printf("box: %ld rays, %ld from a face undecided\n", count, undecided);
    require(undecided <= count / 1000, "box, undecided rays", (vec3){0}, (double)undecided, 0);
}

/* --------------------------------------------------------- folded fractals */

/* Inside the sponge, by digits: the point's cubes of 1/3, 1/9 ... of the edge are left at every step. */
static bool in_menger(int n, const long double x[3])
{
    long double y[3];
    for (int i = 0; i < 3; i++) {
        y[i] = (x[i] + 1) / 2;
        if (!(y[i] > 0 && y[i] < 1)) return false;
    }
    for (int k = 0; k < n; k++) {
        int middle = 0;
        for (int i = 0; i < 3; i++) {
            y[i] *= 3;
            const long double digit = floorl(y[i]);
            middle += digit == 1, y[i] -= digit;
        }
        if (middle >= 2) return false;
    }
    return true;
}

static int in_order(const void *a, const void *b)
{
    const long double x = *(const long double *)a, y = *(const long double *)b;
    return (x > y) - (x < y);
}

/* Every face lies in a plane x, y or z = 2 j / 3^n - 1.  Between neighbouring planes a ray is inside or is
 * not: that is asked in the middle.  The first t > 0 where it changes; infinite: nowhere. */
static long double menger_first(int n, const sgt_ray *ray)
{
    enum { MOST = 3 * 82 };
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    long double t[MOST + 2];
    int count = 0, cells = 1;
    for (int k = 0; k < n; k++) cells *= 3;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= cells && d[i] != 0; j++) {
            const long double at = (2.0L * j / cells - 1 - o[i]) / d[i];
            if (at > 0) t[count++] = at;
        }
    qsort(t, (size_t)count, sizeof *t, in_order);
    bool before = false;
    for (int k = 0; k <= count; k++) {
        const long double middle = k == count ? (count ? t[k - 1] + 1 : 1) : ((k ? t[k - 1] : 0) + t[k]) / 2;
        const long double x[3] = {o[0] + middle * d[0], o[1] + middle * d[1], o[2] + middle * d[2]};
        const bool here = in_menger(n, x);
        if (k > 0 && here != before) return t[k - 1];
        before = here;
    }
    return HUGE_VALL;
}

/* The least t > 0 where the ray enters, or leaves, one of the 4^n tetrahedra, each of size `half` about `at`.
 */
static long double sierpinski_first(int n, const sgt_ray *ray, const long double at[3], long double half)
{
    static const int corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    long double first = HUGE_VALL, in = -HUGE_VALL, out = HUGE_VALL;
    if (n > 0) {
        for (int k = 0; k < 4; k++) {
            long double to[3];
            for (int i = 0; i < 3; i++) to[i] = at[i] + half / 2 * corner[k][i];
            first = fminl(first, sierpinski_first(n - 1, ray, to, half / 2));
        }
        return first;
    }
    for (int k = 0; k < 4; k++) { /* the face against corner k: -corner . (p - at) <= half */
        long double height = -half, rise = 0;
        for (int i = 0; i < 3; i++)
            height -= corner[k][i] * (o[i] - at[i]), rise -= corner[k][i] * (long double)d[i];
        if (rise == 0 && height > 0) return HUGE_VALL;
        if (rise < 0) in = fmaxl(in, -height / rise);
        if (rise > 0) out = fminl(out, -height / rise);
    }
    return !(in < out) || out <= 0 ? HUGE_VALL : in > 0 ? in : out;
}

static void test_folded(long count)
{
    long undecided[2] = {0}, hits[2] = {0}, wrong = 0, evals[2] = {0};
    for (long i = 0; i < count; i++) {
        const int which = (int)(i % 2), n = 1 + (int)uniform(0, which ? 5 : 4);
        const menger sponge = {n};
        const sierpinski four = {n};
        const sgt_surface s =
            which ? (sgt_surface){&sierpinski_ops, &four} : (sgt_surface){&menger_ops, &sponge};
        vec3 at = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, d = direction();
        if (i % 10 < 2)
            d = unit((vec3){(int)uniform(-3, 3) + 0.0, (int)uniform(-3, 3) + 0.0, 1}); /* along cells */
        sgt_ray ray = {.o = along(at, -uniform(2, 6), d), .d = scaled(d, pow(10, uniform(-1, 1)))};
        if (which == 0 && i % 3 == 0) ray.o = at; /* of the sponge also from inside its cube */
        const long double centre[3] = {0, 0, 0};
        const long double first = which ? sierpinski_first(n, &ray, centre, 1) : menger_first(n, &ray);
        const sgt_hit hit = sgt_intersect(s, ray, NULL);
        undecided[which] += hit.status<0, hits[which] += hit.status> 0, evals[which] += hit.evals;
        if (hit.status < 0) continue;
        const bool met = hit.status > 0;
        const bool good = met == (first < HUGE_VALL) &&
                          (!met || fabsl(hit.t - first) <= hit.t_err + 1e-15L * (1 + fabsl(first)));
        wrong += !good;
        require(good, s.ops->name, ray.o, hit.t, (double)first);
    }
    printf(
        "sponge: %ld rays, %ld hits, %ld undecided, %.1f evaluations; tetrahedron: %ld hits, %ld undecided, "
        "%.1f evaluations; %ld wrong\n",
        count, hits[0], undecided[0], 2.0 * (double)evals[0] / (double)count, hits[1], undecided[1],
        2.0 * (double)evals[1] / (double)count, wrong);
    require(hits[0] > count / 10 && hits[1] > count / 20, "folded, hits", (vec3){0}, (double)hits[0],
            (double)hits[1]);
    require(undecided[0] + undecided[1] <= count / 50, "folded, undecided", (vec3){0}, (double)undecided[0],
            (double)undecided[1]);
}

static double slope_at(sgt_surface s, const sgt_ray *ray, double t)
{
    vec3 grad;
    s.ops->value(s.self, along(ray->o, t, ray->d), &grad);
    return dot(grad, ray->d);
}

/* Where the slope changes between a and b, or near a. */
static double kink_between(sgt_surface s, const sgt_ray *ray, double a, double b)
{
    const double before = slope_at(s, ray, a);
    for (int i = 0; i < 50; i++) {
        const double middle = a + 0.5 * (b - a);
        if (slope_at(s, ray, middle) == before) a = middle;
        else b = middle;
    }
    return b;
}

/* F and slope of points of a stretch lie in its enclosure.  Half of the stretches hold a kink of F, which is
 * where an enclosure may forget a side. */
static void test_folded_enclosures(long count)
{
    for (long i = 0; i < count; i++) {
        const menger sponge = {1 + (int)uniform(0, 6)};
        const sierpinski four = {1 + (int)uniform(0, 10)};
        const sgt_surface s =
            i % 2 ? (sgt_surface){&sierpinski_ops, &four} : (sgt_surface){&menger_ops, &sponge};
        vec3 d = direction();
        if (i % 7 == 0) d = (vec3){0, 0, 1};
        const sgt_ray ray = {.o = along((vec3){uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, -3, d),
                             .d = d};
        const double width = pow(10, uniform(-12, 0.5)), from = uniform(1, 5);
        const bool kink = i / 2 % 2;
        const double lo = kink ? kink_between(s, &ray, from, from + 0.1) - uniform(0, width) : from;
        const sgt_interval t = {lo, lo + width};
        sgt_interval slope, f = s.ops->enclose(s.self, &ray, t, &slope);
        for (int k = 0; k <= 8; k++) {
            const double at = lo + width * k / 8 < t.hi ? lo + width * k / 8 : t.hi;
            const vec3 p = along(ray.o, at, ray.d);
            vec3 grad;
            const double value = s.ops->value(s.self, p, &grad), off = s.ops->rounding(s.self, p) + 1e-15;
            require(f.lo <= value + off && value - off <= f.hi, "folded, value outside", p, value, f.lo);
            const double along_ray = dot(grad, d);
            require(slope.lo <= along_ray + 1e-15 && along_ray - 1e-15 <= slope.hi, "folded, slope outside",
                    p, along_ray, slope.lo);
        }
    }
}

/* ------------------------------------------------------------ the Mandelbox */

/* F in long double: the folds by distances to the nearest mirror, the inversion by the radius. */
static long double mandelbox_on_ray(const mandelbox *s, const sgt_ray *ray, long double t)
{
    const long double p[3] = {ray->o.x + t * ray->d.x, ray->o.y + t * ray->d.y, ray->o.z + t * ray->d.z};
    long double v[3] = {p[0], p[1], p[2]}, r = sqrtl(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int n = 1; n < s->iterations && r < 1e8L; n++) {
        for (int i = 0; i < 3; i++)
            if (fabsl(v[i]) > 1) v[i] -= 2 * copysignl(fabsl(v[i]) - 1, v[i]);
        const long double w = sqrtl(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
                          away = w < 0.5L ? 4 * w : w < 1 ? 1 / w : w;
        for (int i = 0; i < 3; i++) v[i] = (w > 0 ? 2 * away / w * v[i] : 0) + p[i];
        r = sqrtl(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    return (r - 18) / (r + 18);
}

/* On a ray that meets it often: from outside, along a mirror, or from near the surface. */
static sgt_ray ray_at_mandelbox(long kind)
{
    vec3 at = {uniform(-6, 6), uniform(-6, 6), uniform(-6, 6)}, d = direction();
    if (kind % 8 == 1) at.x = 1, d.x = 0;
    if (kind % 8 == 2) at.x = at.y, d.x = d.y;
    if (kind % 8 == 3) at.x = at.y = d.x = d.y = 0;
    d = unit(d);
    return (sgt_ray){.o = along(at, kind % 3 ? -uniform(10, 20) : 0, d),
                     .d = scaled(d, pow(10, uniform(-1, 1)))};
}

static void test_mandelbox(long count)
{
    long undecided[2] = {0}, hits = 0, evals = 0;
    for (long i = 0; i < count; i++) {
        const mandelbox s = {1 + (int)uniform(0, 8)};
        const bool plane = i % 8 >= 1 && i % 8 <= 3; /* in a mirror there is a kink all along */
        const sgt_surface surface = {&mandelbox_ops, &s};
        sgt_ray ray = ray_at_mandelbox(i);
        sgt_hit hit = sgt_intersect(surface, ray, NULL);
        if (i % 2 && hit.status > 0) { /* from the surface */
            ray = (sgt_ray){.o = hit.p, .d = direction()};
            hit = sgt_intersect(surface, ray, NULL);
        }
        undecided[plane] += hit.status < 0, hits += hit.status > 0, evals += hit.evals;
        if (hit.status < 0) continue;
        const double end = hit.status > 0 ? hit.t : 80 / length(ray.d), off = 1e-9 / length(ray.d);
        const long double first = mandelbox_on_ray(&s, &ray, fmin(off, 0.5 * end));
        for (int k = 1; k < 400 && end > 3 * off; k++) { /* half of them where it may just have passed */
            const double part = k % 2 ? k / 400.0 : 1 - pow(10, uniform(-6, 0));
            const long double here = mandelbox_on_ray(&s, &ray, off + (end - 2 * off) * part);
            require(first * here > 0, "mandelbox, a root before the first", ray.o, end * part, end);
        }
        if (hit.status != SGT_HIT || end < 3 * off) continue;
        const long double a = mandelbox_on_ray(&s, &ray, hit.t - hit.t_err - off),
                          b = mandelbox_on_ray(&s, &ray, hit.t + hit.t_err + off);
        require(a * b < 0, "mandelbox, no change of sign at the hit", ray.o, (double)a, (double)b);
    }
    printf("mandelbox: %ld rays, %ld hits, %ld undecided, and %ld in mirrors; %.1f evaluations\n", count,
           hits, undecided[0], undecided[1], (double)evals / (double)count);
    require(hits > count / 3 && undecided[0] <= count / 100 && undecided[1] <= count / 10,
            "mandelbox, undecided rays", (vec3){0}, (double)undecided[0], (double)undecided[1]);
}

/* F of many points of a cell lies in its enclosure, and what it rises between two of them in that of the
 * slope.  Cells lie about a kink as often as not: the mirrors are dense. */
static void test_mandelbox_enclosure(long count)
{
    long sloped = 0, narrow = 0;
    for (long i = 0; i < count; i++) {
        const mandelbox s = {1 + (int)uniform(0, 9)};
        const sgt_ray ray = ray_at_mandelbox(i);
        const double width = pow(10, uniform(-9, 0)) / length(ray.d),
                     from = -dot(ray.o, ray.d) / dot(ray.d, ray.d) + uniform(-8, 8) / length(ray.d);
        sgt_interval t = {from, from + width}, slope, g = mandelbox_ops.enclose(&s, &ray, t, &slope);
        const bool known = slope.hi - slope.lo < HUGE_VAL;
        long double f[17], lowest = HUGE_VALL, highest = -HUGE_VALL;
        for (int k = 0; k <= 16; k++) {
            const long double at = k == 16 ? t.hi : t.lo + (t.hi - t.lo) * (k / 16.0L);
            /* F is of r here and of r^2 there: (r^2 - E^2) / (r^2 + E^2) */
            const long double x = mandelbox_on_ray(&s, &ray, at);
            f[k] = 2 * x / (1 + x * x);
            require(g.lo <= f[k] && f[k] <= g.hi, "mandelbox, enclosure", ray.o, (double)f[k], g.lo);
            lowest = fminl(lowest, f[k]), highest = fmaxl(highest, f[k]);
        }
        sloped += known, narrow += g.hi - g.lo < 1;
        for (int k = 0; k < 16 && known && width * length(ray.d) > 1e-6; k++) {
            const long double rise = (f[k + 1] - f[k]) / (width / 16), off = 1e-7L * (1 + fabsl(rise));
            require(slope.lo <= rise + off && rise - off <= slope.hi, "mandelbox, slope", ray.o, (double)rise,
                    slope.lo);
        }
        const vec3 p = along(ray.o, from, ray.d);
        const long double x = mandelbox_on_ray(&s, &(sgt_ray){.o = p, .d = ray.d}, 0),
                          off = fabsl(mandelbox_ops.value(&s, p, NULL) - 2 * x / (1 + x * x));
        require(off <= mandelbox_ops.rounding(&s, p), "mandelbox, rounding", p, (double)off,
                mandelbox_ops.rounding(&s, p));
    }
    printf("mandelbox: of %ld cells %ld say something, %ld have a slope\n", count, narrow, sloped);
    require(narrow > count / 4 && sloped > count / 20, "mandelbox, cells", (vec3){0}, (double)narrow,
            (double)sloped);
}

/* -------------------------------------------------- -------- the edge */

/* g and its slope, along a ray. */
static void edge_along(const void *self, const sgt_ray *ray, long double t, long double *g,
                       long double *slope)
{
    const edge *s = self;
    long double x = ray->o.x + t * ray->d.x, y = ray->o.y + t * ray->d.y, r = s->radius;
    *g = (x * x + y * y - r * r) / (2 * r), *slope = (x * ray->d.x + y * ray->d.y) / r;
}

static void box_along(const void *self, const sgt_ray *ray, long double t, long double *g, long double *slope)
{
    const box *s = self;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    *g = -HUGE_VALL;
    for (int i = 0; i < 3; i++) {
        long double x = o[i] + t * d[i], f = fabsl(x) - s->half[i];
        if (f > *g) *g = f, *slope = x > 0 ? d[i] : -d[i];
    }
}

typedef void along_a_ray(const void *self, const sgt_ray *ray, long double t, long double *g,
                         long double *slope);

static void test_enclosure(sgt_surface of, along_a_ray *exact, double degree)
{
    double size = pow(10, uniform(-2, 3)), width = pow(10, uniform(-9, 1)), stretch = pow(10, uniform(-1, 1));
    sgt_ray ray = {.o = scaled(direction(), size), .d = scaled(direction(), stretch)};
    double t0 = uniform(0, 1) < 0.5 ? uniform(-2, 1) * size / stretch
                                    : -dot(ray.o, ray.d) / (stretch * stretch) - uniform(0, width);
    sgt_interval t = {t0, t0 + width}, slope, g = of.ops->enclose(of.self, &ray, t, &slope);
    long double lowest = HUGE_VALL, highest = -HUGE_VALL, here, there;
    for (int k = 0; k <= 16; k++) {
        long double at = k == 16 ? t.hi : t.lo + (t.hi - t.lo) * (k / 16.0L);
        exact(of.self, &ray, at, &here, &there);
        require(g.lo <= here && here <= g.hi, of.ops->name, ray.o, (double)here, g.lo);
        require(slope.lo <= there && there <= slope.hi, of.ops->name, ray.o, (double)there, slope.lo);
        lowest = fminl(lowest, here), highest = fmaxl(highest, here);
    }
    /* narrow: by the slope, over a small width; what rounding makes of it at the distance */
    double reach = fmax(fabs(t.lo), fabs(t.hi)) * stretch + size + 3;
    double loose = 1e-11 * pow(reach, degree) + 3 * width * fmax(fabs(slope.lo), fabs(slope.hi));
    require(g.hi - g.lo <= (double)(highest - lowest) + loose, of.ops->name, ray.o, g.hi - g.lo,
            (double)(highest - lowest));
}

static void test_enclosures(long count)
{
    for (long i = 0; i < count; i++) {
        const edge rim = {.radius = uniform(0.1, 2), .from = -1, .to = 1};
        const box cube = {{uniform(0.1, 2), uniform(0.1, 2), uniform(0.1, 2)}};
        test_enclosure((sgt_surface){&edge_ops, &rim}, edge_along, 2);
        test_enclosure((sgt_surface){&box_ops, &cube}, box_along, 1);
    }
}

/* ------------------------------------------------- where the edge can be met */

/* The roots of the quadratic along a ray, in long double, against the span: none is outside, one that is
 * `single` has no more than one, with a seed that is near it, and of the rest only those near a border are
 * searched in vain. */
static void test_edge_spans(long count)
{
    long singles = 0, vain = 0;
    for (long i = 0; i < count; i++) {
        const edge rim = {.radius = uniform(0.1, 2), .from = uniform(-1, 0), .to = uniform(0.001, 1)};
        sgt_ray ray = {.o = scaled(direction(), pow(10, uniform(-2, 2))),
                       .d = scaled(direction(), pow(10, uniform(-1, 1)))};
        /* toward it */
        if (i % 3) ray.d = subtract((vec3){uniform(-2, 2), uniform(-2, 2), uniform(-1, 1)}, ray.o);
        if (i % 50 == 0) ray.d.z = 0;
        if (i % 50 == 1) ray.d.x = ray.d.y = 0;
        sgt_span span = edge_ops.span(&rim, &ray);
        long double ox = ray.o.x, oy = ray.o.y, dx = ray.d.x, dy = ray.d.y, r = rim.radius;
        long double a = dx * dx + dy * dy, b = ox * dx + oy * dy, c = ox * ox + oy * oy - r * r,
                    w = b * b - a * c;
        int met = 0;
        for (int sign = -1; sign <= 1 && w > 0 && a > 0; sign += 2) {
            long double root = sign * b > 0 ? -c / (b + sign * sqrtl(w)) : (-b + sign * sqrtl(w)) / a;
            long double z = ray.o.z + root * ray.d.z;
            if (!(z > rim.from + 1e-12L && z < rim.to - 1e-12L)) continue;
            met++;
            require(span.lo <= root && root <= span.hi, "edge, a root outside the span", ray.o, (double)root,
                    span.lo);
            bool near = !span.single || fabsl(span.seed - root) <= 1e-9L * fabsl(root) + 1e-7L;
            require(near, "edge, the seed", ray.o, span.seed, (double)root);
        }
        singles += span.single;
        if (span.single) require(met <= 1, "edge, one root", ray.o, met, span.seed);
        vain += span.lo <= span.hi && met == 0 && ray.d.z != 0;
    }
    require(singles > count / 20 && vain <= count / 1000, "edge, spans of some use", (vec3){0},
            (double)singles, (double)vain);
}

/* ------------------------------------------------------------ all of them */

static void test_conformance(long count)
{
    const mandelbulb bulb = {.escape = 2, .iterations = 4};
    const edge rim = {.radius = 1, .from = -0.5, .to = 0.5};
    const box cube = {{1, 0.7, 0.5}};
    const sgt_surface several[] = {{&mandelbulb_ops, &bulb}, {&edge_ops, &rim}, {&box_ops, &cube}};
    for (long i = 0; i < count; i++) {
        vec3 d = direction(), at = scaled(direction(), uniform(0, 1.2)), where = {0};
        sgt_ray ray = {.o = along(at, -4, d), .d = d, .tmin = 0, .tmax = 8};
        for (int k = 0; k < 3; k++) {
            sgt_fault fault = sgt_check(several[k], 1, &ray, &where);
            require(fault == SGT_SOUND, sgt_fault_text(fault), ray.o, k, where.z);
        }
    }
}

/* Many at once are one by one, to the last bit. */
static void test_many(long count)
{
    enum { MOST = 37 };
    const mandelbulb bulb = {.escape = 2, .iterations = 4};
    const edge rim = {.radius = 1, .from = -0.5, .to = 0.5};
    const box cube = {{1, 0.7, 0.5}};
    const sgt_surface several[] = {{&mandelbulb_ops, &bulb}, {&edge_ops, &rim}, {&box_ops, &cube}};
    for (long i = 0; i < count; i++) {
        double o[3][MOST], d[3][MOST], f[2][MOST], grad[3][MOST], lo[MOST], hi[MOST], seed[MOST];
        bool single[MOST];
        for (int k = 0; k < MOST; k++) {
            vec3 p = scaled(direction(), uniform(0, 3)), q = direction();
            if (k % 7 == 0) q.z = 0;
            o[0][k] = p.x, o[1][k] = p.y, o[2][k] = k % 5 ? p.z : (double)NAN, d[0][k] = q.x, d[1][k] = q.y,
            d[2][k] = q.z;
        }
        const sgt_rays rays = {.o = {o[0], o[1], o[2]}, .d = {d[0], d[1], d[2]}};
        const sgt_surface_ops *ops = several[i % 3].ops;
        const void *self = several[i % 3].self;
        size_t n = 1 + (size_t)uniform(0, MOST);
        if (ops->values) {
            ops->values(self, n, (sgt_points){{o[0], o[1], o[2]}},
                        (sgt_values){f[0], {grad[0], grad[1], grad[2]}});
            ops->values(self, n, (sgt_points){{o[0], o[1], o[2]}}, (sgt_values){.f = f[1]});
        }
        if (ops->spans) ops->spans(self, n, rays, (sgt_spans){lo, hi, seed, single});
        for (size_t k = 0; k < n; k++) {
            sgt_ray ray = {.o = {o[0][k], o[1][k], o[2][k]}, .d = {d[0][k], d[1][k], d[2][k]}};
            vec3 g;
            if (ops->values) {
                double wanted = ops->value(self, ray.o, &g);
                require(same(f[0][k], wanted) && same(f[1][k], wanted), ops->name, ray.o, f[0][k], wanted);
                bool all = same(grad[0][k], g.x) && same(grad[1][k], g.y) && same(grad[2][k], g.z);
                require(all, ops->name, ray.o, grad[0][k], g.x);
            }
            if (ops->spans) {
                sgt_span span = ops->span(self, &ray);
                bool all = same(lo[k], span.lo) && same(hi[k], span.hi) && same(seed[k], span.seed) &&
                           single[k] == span.single;
                require(all, ops->name, ray.o, lo[k], span.lo);
            }
        }
    }
}

int main(void)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    double times = scale ? atof(scale) : 0.5;
    state = seed ? strtoull(seed, NULL, 0) : 1;
    printf("SAGITTA_TEST_SEED=%llu, SAGITTA_TEST_SCALE=%g\n", (unsigned long long)state, times);
    test_bulb(1 + (long)(2000 * times));
    test_models(1 + (long)(300000 * times));
    test_bulb_enclosure(1 + (long)(20000 * times));
    test_bulb_rays(1 + (long)(2000 * times));
    test_box(1 + (long)(20000 * times));
    test_folded(1 + (long)(20000 * times));
    test_folded_enclosures(1 + (long)(20000 * times));
    test_mandelbox(1 + (long)(2000 * times));
    test_mandelbox_enclosure(1 + (long)(20000 * times));
    test_enclosures(1 + (long)(20000 * times));
    test_edge_spans(1 + (long)(20000 * times));
    test_many(1 + (long)(2000 * times));
    test_conformance(1 + (long)(200 * times));
    printf("%ld looked at, %ld failed\n", looked_at, failed);
    return failed > 0;
}
