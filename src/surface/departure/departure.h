// SPDX-License-Identifier: MIT
/* departure.h - sags that are a departure P(x, y) on a conic base: F = z - (conic(r^2) + P).
 *
 * A type of this kind writes P alone, as a `departure`.  departure/departure.c makes all operations of a
 * surface from it: value, values, span, spans, rounding, enclose, second, parameters and by_parameter.  It
 * needs four things for that:
 * - P and its gradient at many points;
 * - how far these can be off;
 * - bounds on P, its gradient and its second derivative over a region;
 * - the second derivatives.
 *
 * A bound B on the second derivative gives the enclosure
 *     P(m + v) in P(m) + grad P(m) . v +- B |v|^2 / 2,     grad P(m + v) in grad P(m) +- B |v|.
 * A bound on the gradient within the rim, together with that of the conic, shows that a ray meets the
 * surface at most once.
 *
 * A sag whose whole formula is its own (a toroid) is a departure from a plane: it has no base.
 *
 * To add a type: write its `departure`, then use DEPARTURE_ON_CONIC or DEPARTURE_OPS at the end of the file.
 * Lengths have any one unit.  P has the unit of z. */
#ifndef SGT_SURFACE_DEPARTURE_DEPARTURE_H
#define SGT_SURFACE_DEPARTURE_DEPARTURE_H

#include "../../num/lanes.h"
#include "../sag/poly.h"
#include "profile.h"

#include <sagitta/interval.h>

enum { DEPARTURE_BLOCK = 64 };

/* In norm radii: farther out the polynomials themselves are worked out for a bound.  A rim at the norm
 * radius, made wider by rounding, is nearer, and what costs less is as good there. */
static const double FAR_BEYOND = 1 + 0x1p-16;

/* The points with x and y in these intervals and r = sqrt(x^2 + y^2) in [r_lo, r_hi]. */
typedef struct region { sgt_interval x, y; double r_lo, r_hi; } region;

/* Bounds over a region.  Each is rounded upward, or exceeds the true value by far more than rounding.
 * HUGE_VAL: no bound is known.
 *
 *   size   >= |P|
 *   steep  >= |grad P|
 *   bend   >= the norm of the second derivative: |grad P(a) - grad P(b)| <= bend |a - b| within a convex
 *          region.  Infinite if grad P jumps in the region. */
typedef struct bounds { double size, steep, bend; } bounds;

/* P, dP/dx, dP/dy of n points, n <= DEPARTURE_BLOCK.  No array is NULL, and no two overlap. */
typedef struct sag_values { double *p, *px, *py; } sag_values;

/* The degree of P along a line, at most; is P a polynomial of r^2?  home: a radius (length) within which all
 * terms are of one size, as those of orthogonal polynomials are; 0: not known. */
typedef struct sgt_course { size_t degree; bool even; double home; } sgt_course;

struct departure_sag;

typedef struct departure {
    /* P and its gradient at n points.  Every lane does the same operations in the same order, whatever n is
     * (num/lanes.h).  So a point gives the same bits by itself and among others.  NaN where P is not
     * defined.  Where P is defined and its gradient is not (the tip of a cone), give one of the gradients
     * nearby, or their mean. */
    void (*at)(const void *self, size_t n, const double *x, const double *y, sag_values out);

    /* The same P, to the bit, without its gradient.  n is above 1.  NULL: `at` is asked. */
    void (*alone)(const void *self, size_t n, const double *x, const double *y, double *p);

    /* How far `at` can be off at (x, y), with x and y taken as exact:
     *
     *   *p_err     >= |computed P - exact P|
     *   *grad_err  >= the error of each of the two derivatives
     *
     * Derive it by running error analysis in the head of the file. */
    void (*rounding)(const void *self, double x, double y, double *p_err, double *grad_err);

    /* *p_err of `rounding` alone, to the bit, at less cost.  NULL: `rounding` is asked. */
    double (*size_rounding)(const void *self, double x, double y);

    /* Bounds of P over the region.  Returns
     *
     *   1   P is defined all over the region
     *   0   P is nowhere defined in it
     *   -1  P may be defined in a part of it.  Then *where is cut to a convex part outside of which P is not
     *       defined.  The bounds hold where P is defined. */
    int (*bounds)(const void *self, region *where, bounds *out);

    /* As `bounds`, with the bend along (l, m) for that length: >= |l^2 P_xx + 2 l m P_xy + m^2 P_yy|.  Given
     * if that is much less in a narrow box than in a disc.  NULL: it is not. */
    int (*bounds_along)(const void *self, region *where, double l, double m, bounds *out);

    /* The range of P over the region, where it is defined.  Asked near the edge of the domain, where the
     * gradient has no bound.  NULL: +- size is taken. */
    sgt_interval (*range)(const void *self, const region *where);

    /* The range of the second derivative of P along any direction, of length 1, at r <= radius.  It says more
     * than `bend`, and costs some dozens of evaluations.  `most` is that bend.  false: no more is known.
     * NULL: never. */
    bool (*bent)(const void *self, double radius, double most, sgt_interval *out);

    /* The second derivatives of P at n points. */
    void (*second)(const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
                   double *pyy);

    /* The number of parameters of P, and dP / d(parameter j) with its gradient at n points. */
    size_t (*parameters)(const void *self);
    void (*by_parameter)(const void *self, size_t j, size_t n, const double *x, const double *y,
                         sag_values out);

    /* The first invalid parameter of P with the reason, or {NULL, NULL} if all are valid.  The parameters
     * of the base are not its task.  The name is that of the parameter in types.def.  The reason
     * is printed behind it: "must be above 0". */
    sgt_objection (*object)(const void *self);

    /* Within `radius` of the axis |computed P - exact P| <= e[0] + e[1] r^2.  This is coarser than
     * `rounding`, but the same for all points, so many rays share the work.  Terms that vanish with r^2
     * should go into e[1].  NULL: not known. */
    void (*noise)(const void *self, double radius, double e[2]);

    /* As `noise`, at less cost and perhaps wider.  It is asked for many radii.  NULL: `noise` is asked. */
    void (*noise_about)(const void *self, double radius, double e[2]);

    /* `noise` for n finite radii, to the bit.  NULL: one by one. */
    void (*noises)(const void *self, size_t n, const double *radius, double *e0, double *e1);

    /* As `noise`, where |x| and |y| are at most these, and P has by_axis or bounds_along. */
    void (*noise_in_box)(const void *self, double x, double y, double e[2]);

    /* Set if P is defined within a rectangle and nowhere else.  Then `bounds` holds where P is defined,
     * although P is not defined all over the region; departure.c relies on it there. */
    bool framed;

    /* As `bounds`, and the same along x and y, and the range of P.  Given if P may be much steeper along one
     * axis than along the other, and has no base.  Where P is not defined all over the region, *axis and
     * *heights need not be set.  NULL: not known. */
    int (*by_axis)(const void *self, region *where, bounds *out, sgt_by_axis *axis, sgt_interval *heights);

    /* At most |P| at r = radius (length), with the sign of P, if P keeps that sign from there on and is at
     * least (r / radius)^2 times that at each r >= radius where it is defined.  0: not known.  NULL:
     * never. */
    double (*tail)(const void *self, double radius);

    /* `ahead` of sgt_builtin_ops, of the sag without a rim and without a base of its own.  NULL: nothing is
     * known. */
    void (*ahead)(const struct departure_sag *s, size_t n, sgt_ahead *ahead);

    /* May P jump where it is defined?  NULL: it does not. */
    bool (*jumps)(const void *self);

    /* Along any line P is a polynomial of the length: what is known of it (ray/along.c).  false or NULL: it
     * is none.  `noise` is offered, and `bounds` holds everywhere. */
    bool (*along)(const void *self, sgt_course *out);

    /* With `along`: at most the noise within a radius, and 2^-46 times the radius and the gradient there.
     * NULL: `noise` and `bounds` are asked. */
    double (*along_off)(const void *self, double radius);

    /* With `along`, if P is much less in some directions than in others: at most the noise where |x| and |y|
     * are at most these, at eight points.  It increases with both.  Asked of degrees below 40.  NULL: it is
     * not. */
    void (*along_noise)(const void *self, const double x[], const double y[], double out[]);

    /* P as a function of r (ray/profile.c).  `tail` is offered.  false: too many terms; NULL: it is none. */
    bool (*profile)(const void *self, sgt_profile *out);

    /* With `profile`: set if the heights of rings are had for much less, and so are asked first. */
    bool heights_first;

    /* dP/dc with its gradient, if P depends on the curvature c of its base.  NULL: it does not. */
    void (*by_curvature)(const void *self, size_t n, const double *x, const double *y, sag_values out);
} departure;

/* A sag as departure/departure.c sees it.  If `base` is set, c and k are parameters of F.  If not, the base
 * is a plane, and c and k belong to a conic whose root is a good seed. */
typedef struct departure_sag {
    double c, k, semi_diameter;
    bool base;
    const departure *of;
    const void *self;
    bool fixed_k; /* k is no parameter */
    /* Half the curvature along x less that along y, for the seed; read if P has by_axis. */
    double lean;
    double reach; /* P is not defined farther than this from the axis (length); 0: not known */
} departure_sag;

/* The same sag with a rim no wider than `most`. */
SGT_INLINE departure_sag sgt_departure_narrowed(departure_sag s, double most)
{
    if (!(s.semi_diameter > 0 && s.semi_diameter <= most))
        s.semi_diameter = most < HUGE_VAL ? most : s.semi_diameter;
    return s;
}

/* A rim of the greatest numbers is none. */
SGT_INLINE bool looks_ahead(const departure_sag *s)
{
    return s->of->ahead && !(s->semi_diameter > 0 && s->semi_diameter < 0x1p400);
}

double sgt_departure_value(const departure_sag *s, sgt_vec3 p, sgt_vec3 *grad);
void sgt_departure_values(const departure_sag *s, size_t n, sgt_points p, sgt_values out);
double sgt_departure_rounding(const departure_sag *s, sgt_vec3 p);
void sgt_departure_share(const departure_sag *s, sgt_shared *shared);
void sgt_departure_heights(const departure_sag *s, sgt_heights *out);
void sgt_departure_within(const departure_sag *s, bool bent, sgt_extent *extent);
void sgt_departure_in_box(const departure_sag *s, double x, double y, double *steep, sgt_by_axis *axis);
void sgt_departure_noise_in_box(const departure_sag *s, double x, double y, double e[2]);
void sgt_departure_chords(size_t n, sgt_rays rays, const double *radius2, const double *steep,
                          const double *const axis[2], double *lo, double *hi, double *least);
void sgt_departure_noise(const departure_sag *s, double radius, double e[2]);
void sgt_departure_noise_about(const departure_sag *s, double radius, double e[2]);
bool sgt_departure_bent(const departure_sag *s, sgt_interval *bent);
bool sgt_departure_in_part(const departure_sag *s, sgt_part *part);
double sgt_departure_tail(const departure_sag *s, double radius);
bool sgt_departure_noises(const departure_sag *s, size_t n, const double radius[], double e0[], double e1[]);
sgt_span sgt_departure_span(const void *self, const sgt_shared *shared, const sgt_ray *ray, double *least);
void sgt_departure_spans(const void *self, const sgt_shared *shared, size_t n, sgt_rays rays, sgt_spans out,
                         double *least);
sgt_interval sgt_departure_enclose(const departure_sag *s, const sgt_ray *ray, double t0, sgt_interval t,
                                   sgt_interval *slope);
void sgt_departure_seeds(const void *self, const sgt_shared *shared, size_t n, sgt_rays rays, double seed[]);
bool sgt_departure_values_rounded(const departure_sag *s, const sgt_shared *shared,
                                  const double *const noise[3], size_t n, sgt_points p, sgt_values out,
                                  double own[]);
bool sgt_departure_roundings(const void *self, const sgt_shared *shared, size_t n, sgt_points p,
                             const double f[], double out[]);
void sgt_departure_second(const departure_sag *s, size_t n, sgt_points p, double *const out[6]);
size_t sgt_departure_parameters(const departure_sag *s);
void sgt_departure_by_parameter(const departure_sag *s, size_t j, size_t n, sgt_points p, sgt_values out);
sgt_objection sgt_departure_object(const departure_sag *s);

/* Of one type each (biconic_ahead.c, grid_ahead.c, toroidal_ahead.c). */
void sgt_biconic_ahead(const departure_sag *s, size_t n, sgt_ahead *ahead);
void sgt_grid_ahead(const departure_sag *s, size_t n, sgt_ahead *ahead);
void sgt_toroidal_ahead(const departure_sag *s, size_t n, sgt_ahead *ahead);

/* Helper for `object`: are all n numbers finite?  Asked for each ray that comes alone. */
SGT_INLINE bool numbers_finite(size_t n, const double *x)
{
    mask other = 0;
    _Pragma("omp simd reduction(| : other)") for (size_t i = 0; i < n; i++) {
        other |= ~MASK(fabs(x[i]) < HUGE_VAL);
    }
    return other == 0;
}

/* Objects to a list of more than `most` numbers, or with one that is not finite.  An empty list is valid. */
SGT_INLINE sgt_objection object_to_list(const char *name, sgt_numbers a, size_t most, const char *too_long)
{
    if (a.rows == 0 || a.columns == 0) return (sgt_objection){NULL, NULL};
    if (!a.x) return (sgt_objection){name, "has no numbers"};
    if (a.rows != 1 || a.columns > most) return (sgt_objection){name, too_long};
    if (!numbers_finite(a.columns, a.x)) return (sgt_objection){name, "must be finite"};
    return (sgt_objection){NULL, NULL};
}

/* A function of departure.c as one of the type NAME: HEAD is its name and parameters, the first of which is
 * `self`; what it does is written of v, the sag. */
#define DEPARTURE_OF(NAME, HEAD, ...)                                                                        \
    static HEAD                                                                                              \
    {                                                                                                        \
        departure_sag v = NAME##_view(self);                                                                 \
        __VA_ARGS__;                                                                                         \
    }

/* Defines sgt_NAME_ops, for parameters of type TYPE.  VIEW(s) is an expression of type
 * departure_sag for a pointer s to a TYPE.  NAME_departure must exist, and TYPE must have a semi_diameter. */
#define DEPARTURE_OPS(NAME, TYPE, VIEW)                                                                      \
    static departure_sag NAME##_view(const void *self) { return VIEW((const TYPE *)self); }                  \
    static double NAME##_rim(const void *self) { return ((const TYPE *)self)->semi_diameter; }               \
    DEPARTURE_OF(NAME, double NAME##_ops_value(const void *self, sgt_vec3 p, sgt_vec3 *grad),                \
                 return sgt_departure_value(&v, p, grad))                                                    \
    DEPARTURE_OF(NAME, void NAME##_ops_values(const void *self, size_t n, sgt_points p, sgt_values out),     \
                 sgt_departure_values(&v, n, p, out))                                                        \
    DEPARTURE_OF(NAME,                                                                                       \
                 bool NAME##_values_rounded(const void *self, const sgt_shared *shared,                      \
                                            const double *const noise[3], size_t n, sgt_points p,            \
                                            sgt_values out, double own[]),                                   \
                 return sgt_departure_values_rounded(&v, shared, noise, n, p, out, own))                     \
    DEPARTURE_OF(NAME, double NAME##_ops_rounding(const void *self, sgt_vec3 p),                             \
                 return sgt_departure_rounding(&v, p))                                                       \
    DEPARTURE_OF(NAME, void NAME##_share(const void *self, sgt_shared *shared),                              \
                 sgt_departure_share(&v, shared))                                                            \
    DEPARTURE_OF(NAME, void NAME##_share_within(const void *self, double most, sgt_shared *shared),          \
                 v = sgt_departure_narrowed(v, most); sgt_departure_share(&v, shared))                       \
    DEPARTURE_OF(NAME,                                                                                       \
                 void NAME##_extent_within(const void *self, double most, bool bent, sgt_extent *extent),    \
                 v = sgt_departure_narrowed(v, most); sgt_departure_within(&v, bent, extent))                \
    DEPARTURE_OF(NAME,                                                                                       \
                 void NAME##_in_box(const void *self, double x, double y, double *steep,                     \
                                    sgt_by_axis *by_axis),                                                   \
                 sgt_departure_in_box(&v, x, y, steep, by_axis))                                             \
    DEPARTURE_OF(NAME, void NAME##_box_noise(const void *self, double x, double y, double e[2]),             \
                 sgt_departure_noise_in_box(&v, x, y, e))                                                    \
    DEPARTURE_OF(NAME, void NAME##_heights(const void *self, sgt_heights *out),                              \
                 sgt_departure_heights(&v, out))                                                             \
    DEPARTURE_OF(NAME, void NAME##_noise_within(const void *self, double radius, double e[2]),               \
                 sgt_departure_noise_about(&v, radius, e))                                                   \
    DEPARTURE_OF(NAME, bool NAME##_in_part(const void *self, sgt_part *part),                                \
                 return sgt_departure_in_part(&v, part))                                                     \
    DEPARTURE_OF(NAME, bool NAME##_bent_in_rim(const void *self, sgt_interval *bent),                        \
                 return sgt_departure_bent(&v, bent))                                                        \
    DEPARTURE_OF(NAME, double NAME##_ops_tail(const void *self, double radius),                              \
                 return sgt_departure_tail(&v, radius))                                                      \
    DEPARTURE_OF(NAME,                                                                                       \
                 void NAME##_ops_ahead(const void *self, size_t n, sgt_ahead *ahead),                        \
                 for (int i = 0; i < AHEAD_ROWS; i++)                                                        \
                     ahead->kind[i] = AHEAD_OPEN, ahead->clear[i] = ahead->from[i];                          \
                 if (looks_ahead(&v)) v.of->ahead(&v, n, ahead))                                             \
    DEPARTURE_OF(NAME,                                                                                       \
                 bool NAME##_noises_within(const void *self, size_t n, const double radius[], double e0[],   \
                                           double e1[]),                                                     \
                 return sgt_departure_noises(&v, n, radius, e0, e1))                                         \
    DEPARTURE_OF(NAME,                                                                                       \
                 sgt_interval NAME##_builtin_enclose(const void *self, const sgt_ray *ray, double t0,        \
                                                     sgt_interval t, sgt_interval *slope),                   \
                 return sgt_departure_enclose(&v, ray, t0, t, slope))                                        \
    DEPARTURE_OF(NAME,                                                                                       \
                 sgt_interval NAME##_ops_enclose(const void *self, const sgt_ray *ray, sgt_interval t,       \
                                                 sgt_interval *slope),                                       \
                 return sgt_departure_enclose(&v, ray, 0, t, slope))                                         \
    DEPARTURE_OF(NAME,                                                                                       \
                 void NAME##_ops_second(const void *self, size_t n, sgt_points p, double *const out[6]),     \
                 sgt_departure_second(&v, n, p, out))                                                        \
    DEPARTURE_OF(NAME, size_t NAME##_ops_parameters(const void *self), return sgt_departure_parameters(&v))  \
    DEPARTURE_OF(NAME,                                                                                       \
                 void NAME##_ops_by_parameter(const void *self, size_t j, size_t n, sgt_points p,            \
                                              sgt_values out),                                               \
                 sgt_departure_by_parameter(&v, j, n, p, out))                                               \
    DEPARTURE_OF(NAME, sgt_objection NAME##_ops_object(const void *self), return sgt_departure_object(&v))   \
    DEPARTURE_OF(NAME, bool NAME##_jumps(const void *self), return v.of->jumps && v.of->jumps(v.self))       \
    DEPARTURE_OF(NAME, void NAME##_base_of(const void *self, double *c, double *k),                          \
                 *c = v.base ? v.c : 0; *k = v.base ? v.k : 0)                                               \
    static sgt_span NAME##_ops_span(const void *self, const sgt_ray *ray)                                    \
    {                                                                                                        \
        sgt_shared e;                                                                                        \
        NAME##_share(self, &e);                                                                              \
        return sgt_departure_span(self, &e, ray, NULL);                                                      \
    }                                                                                                        \
    static void NAME##_ops_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)                      \
    {                                                                                                        \
        sgt_shared e;                                                                                        \
        NAME##_share(self, &e);                                                                              \
        sgt_departure_spans(self, &e, n, r, out, NULL);                                                      \
    }                                                                                                        \
    static const struct sgt_builtin_ops NAME##_builtin = {                                                   \
        .object = NAME##_ops_object, .tile = SGT_MOST_TILE, .share = NAME##_share,                           \
        .share_within = NAME##_share_within, .extent_within = NAME##_extent_within,                          \
        .extent_in_box = NAME##_in_box, .noise_in_box = NAME##_box_noise,                                    \
        .heights = NAME##_heights, .chords = sgt_departure_chords,                                           \
        .noise_within = NAME##_noise_within, .noises_within = NAME##_noises_within,                          \
        .roundings = sgt_departure_roundings, .values_rounded = NAME##_values_rounded,                       \
        .span = sgt_departure_span, .spans = sgt_departure_spans, .seeds = sgt_departure_seeds,              \
        .enclose = NAME##_builtin_enclose, .rim = NAME##_rim, .base = NAME##_base_of, .jumps = NAME##_jumps, \
        .departure = &NAME##_departure, .tail = NAME##_ops_tail, .ahead = NAME##_ops_ahead,                  \
        .extent_in_part = NAME##_in_part, .bent = NAME##_bent_in_rim};                                       \
    const sgt_surface_ops sgt_##NAME##_ops = {                                                               \
        .name = #NAME, .value = NAME##_ops_value, .span = NAME##_ops_span, .rounding = NAME##_ops_rounding,  \
        .enclose = NAME##_ops_enclose, .values = NAME##_ops_values, .spans = NAME##_ops_spans,               \
        .own_ = &NAME##_builtin, .second = NAME##_ops_second, .parameters = NAME##_ops_parameters,           \
        .by_parameter = NAME##_ops_by_parameter};

/* The same for a sag on a conic base with parameters c and k. */
#define DEPARTURE_ON_CONIC(NAME, TYPE)                                                               \
    static departure_sag NAME##_on_conic(const TYPE *s)                                             \
    {                                                                                               \
        return (departure_sag){s->c, s->k, s->semi_diameter, true, &NAME##_departure, s, false, 0, 0}; \
    }                                                                                               \
    DEPARTURE_OPS(NAME, TYPE, NAME##_on_conic)

#endif
