/* julia.c - level sets of Q^p + c as surfaces: the quaternion Julia and Mandelbrot sets.
 *
 * value.c has F at a point.  level.c and level_batch.c have the roots along a ray.
 *
 * Tests: tests/oracle/test_levels.cpp, test_brute.cpp, test_ceres.cpp, tests/unit/test_levels.c. */
#include "level.h"

#include "course.h"

/* Encloses about the middle of t, along the scaled direction: if d is very short, squares would be lost.
 * If the ray is so far away that squares overflow, nothing is known. */
static sgt_interval enclose_by(const orbit *o, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    path w;
    double scale = scale_of(ray->d), lo = t.lo / scale, hi = t.hi / scale, m = 0.5 * lo + 0.5 * hi;
    double h = larger(hi - m, m - lo) * (1 + 4 * SGT_U) + 0x1p-1070; /* for underflow */
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (t.lo > t.hi) return *slope = (sgt_interval){HUGE_VAL, -HUGE_VAL};
    local q = local_at(ray, m, 0);
    double far = (fabs(q.x) + fabs(q.y) + fabs(q.z)) + 2 * h;
    if (!(far < 0x1p480)) return (sgt_interval){-1, 1};
    set_of(o, &w);
    path_of(o, (sgt_vec3){q.x, q.y, q.z}, q.l, q.m, q.n, &w);
    sgt_interval g = sgt_orbit_enclose(&w, 0, h, slope);
    slope->lo = slope->lo / scale - 0x1p-1074, slope->hi = slope->hi / scale + 0x1p-1074;
    return g;
}

/* ------------------------------------------------------- the two surfaces */

/* The parameters of a set read as an orbit; an objection with a param where they are invalid. */
typedef sgt_objection orbit_of(const void *self, orbit *o);

SGT_INLINE double value_by(orbit_of *read, const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    orbit o;
    if (!read(self, &o).param) return sgt_level_value(&o, p, grad);
    if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
    return NAN;
}

SGT_INLINE sgt_span span_by(orbit_of *read, const void *self, const sgt_ray *ray)
{
    orbit o;
    if (read(self, &o).param) return (sgt_span){.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};
    return sgt_level_span(&o, ray);
}

SGT_INLINE double rounding_by(orbit_of *read, const void *self, sgt_vec3 p)
{
    orbit o;
    return read(self, &o).param ? (double)NAN : sgt_level_rounding(&o, p);
}

SGT_INLINE double estimate_by(orbit_of *read, const void *self, sgt_vec3 p)
{
    orbit o;
    double f;
    return read(self, &o).param ? (double)NAN : sgt_level_estimate(&o, p, &f);
}

SGT_INLINE sgt_interval enclosure_by(orbit_of *read, const void *self, const sgt_ray *ray, sgt_interval t,
                                     sgt_interval *slope)
{
    orbit o;
    *slope = (sgt_interval){NAN, NAN};
    return read(self, &o).param ? *slope : enclose_by(&o, ray, t, slope);
}

SGT_INLINE sgt_hit meet_by(orbit_of *read, const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    orbit o;
    sgt_list list = {.cap = 0, .count = 0};
    if (read(self, &o).param) return hit_without(SGT_INVALID, ray, 0);
    int evals = sgt_level_march(&o, ray, opt, false, &list);
    return first_entry(&list, ray, evals);
}

SGT_INLINE sgt_status all_by(orbit_of *read, const void *self, const sgt_ray *ray, const sgt_options *opt,
                             sgt_list *list)
{
    orbit o;
    if (read(self, &o).param) return SGT_INVALID;
    sgt_level_march(&o, ray, opt, true, list);
    return 0;
}

SGT_INLINE size_t lanes_by(orbit_of *read, const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    orbit o;
    if (!read(self, &o).param) return sgt_level_lanes(&o, tile, opt);
    memset(tile->hits.status, SGT_HARD, tile->n);
    return tile->n;
}

SGT_INLINE double potential_by(orbit_of *read, const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    orbit o;
    if (!read(self, &o).param) return sgt_level_potential(&o, p, grad);
    if (grad) *grad = (sgt_vec3){NAN, NAN, NAN};
    return NAN;
}

/* ------------------------------------------------------------------- julia */

static double julia_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return value_by(sgt_orbit_of_julia, self, p, grad);
}

static sgt_span julia_span(const void *self, const sgt_ray *ray)
{
    return span_by(sgt_orbit_of_julia, self, ray);
}

static double julia_rounding(const void *self, sgt_vec3 p)
{
    return rounding_by(sgt_orbit_of_julia, self, p);
}

static double julia_estimate(const void *self, sgt_vec3 p)
{
    return estimate_by(sgt_orbit_of_julia, self, p);
}

static sgt_interval julia_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    return enclosure_by(sgt_orbit_of_julia, self, ray, t, slope);
}

static sgt_hit julia_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    return meet_by(sgt_orbit_of_julia, self, ray, opt);
}

static sgt_status julia_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    return all_by(sgt_orbit_of_julia, self, ray, opt, list);
}

static size_t julia_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    return lanes_by(sgt_orbit_of_julia, self, tile, opt);
}

static sgt_objection julia_object(const void *self)
{
    orbit o;
    return sgt_orbit_of_julia(self, &o);
}

static const struct sgt_builtin_ops julia_builtin = {
    .object = julia_object,
    .meet = julia_meet, .all = julia_all, .lanes = julia_lanes, .tile = SGT_MOST_TILE};

const sgt_surface_ops sgt_julia_ops = {.name = "julia",
                                      .own_ = &julia_builtin,
                                      .value = julia_value,
                                      .span = julia_span,
                                      .rounding = julia_rounding,
                                      .estimate = julia_estimate,
                                      .enclose = julia_enclose};

double sgt_julia_potential(const sgt_julia *s, sgt_vec3 p, sgt_vec3 *grad)
{
    return potential_by(sgt_orbit_of_julia, s, p, grad);
}

/* ------------------------------------------------------------------- mandelbrot */

static double mandelbrot_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return value_by(sgt_orbit_of_mandelbrot, self, p, grad);
}

static sgt_span mandelbrot_span(const void *self, const sgt_ray *ray)
{
    return span_by(sgt_orbit_of_mandelbrot, self, ray);
}

static double mandelbrot_rounding(const void *self, sgt_vec3 p)
{
    return rounding_by(sgt_orbit_of_mandelbrot, self, p);
}

static double mandelbrot_estimate(const void *self, sgt_vec3 p)
{
    return estimate_by(sgt_orbit_of_mandelbrot, self, p);
}

static sgt_interval mandelbrot_enclose(const void *self, const sgt_ray *ray, sgt_interval t,
                                       sgt_interval *slope)
{
    return enclosure_by(sgt_orbit_of_mandelbrot, self, ray, t, slope);
}

static sgt_hit mandelbrot_meet(const void *self, const sgt_ray *ray, const sgt_options *opt)
{
    return meet_by(sgt_orbit_of_mandelbrot, self, ray, opt);
}

static sgt_status mandelbrot_all(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    return all_by(sgt_orbit_of_mandelbrot, self, ray, opt, list);
}

static size_t mandelbrot_lanes(const void *self, const sgt_tile *tile, const sgt_options *opt)
{
    return lanes_by(sgt_orbit_of_mandelbrot, self, tile, opt);
}

static sgt_objection mandelbrot_object(const void *self)
{
    orbit o;
    return sgt_orbit_of_mandelbrot(self, &o);
}

static const struct sgt_builtin_ops mandelbrot_builtin = {
    .object = mandelbrot_object,
    .meet = mandelbrot_meet, .all = mandelbrot_all, .lanes = mandelbrot_lanes, .tile = SGT_MOST_TILE};

const sgt_surface_ops sgt_mandelbrot_ops = {.name = "mandelbrot",
                                      .own_ = &mandelbrot_builtin,
                                      .value = mandelbrot_value,
                                      .span = mandelbrot_span,
                                      .rounding = mandelbrot_rounding,
                                      .estimate = mandelbrot_estimate,
                                      .enclose = mandelbrot_enclose};

double sgt_mandelbrot_potential(const sgt_mandelbrot *s, sgt_vec3 p, sgt_vec3 *grad)
{
    return potential_by(sgt_orbit_of_mandelbrot, s, p, grad);
}
