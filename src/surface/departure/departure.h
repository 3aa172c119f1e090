/* departure.h - sags that are a departure P(x, y) on a conic base: F = z - (conic(r^2) + P).
 *
 * A surface of this kind writes P alone, as the `departure` below; departure/departure.c makes of it all
 * that a surface answers: value, values, span, spans, rounding, enclose, second, parameters and
 * by_parameter.  What it needs for that are four things: P and its gradient at many points; how far these
 * can be off; bounds on P, its gradient and its second derivative over a region; and the second
 * derivatives.  From a bound B on the second derivative follows the enclosure
 *     P(m + v) in P(m) + grad P(m) . v +- B |v|^2 / 2,     grad P(m + v) in grad P(m) +- B |v|,
 * and from a bound on the gradient within the rim, together with the conic's, that a ray meets the surface
 * once at most.
 *
 * A sag whose whole formula is its own (a toroid) is a departure from a plane: no base. */
#ifndef SGT_SURFACE_DEPARTURE_DEPARTURE_H
#define SGT_SURFACE_DEPARTURE_DEPARTURE_H

#include "../../num/lanes.h"
#include "../sag/poly.h"

#include <sagitta/interval.h>

enum { FREEFORM_BLOCK = 64 };

/* The points with x and y in these intervals and r = sqrt(x^2 + y^2) in [r_lo, r_hi]. */
typedef struct region { sgt_interval x, y; double r_lo, r_hi; } region;

/* size >= |P|, steep >= |grad P|, bend >= the norm of the second derivative (so that |grad P(a) - grad
 * P(b)| <= bend |a - b| within a region that is convex; where grad P jumps it is infinite): HUGE_VAL where
 * no bound is known.  All are rounded upward, or well above what rounding could do. */
typedef struct bounds { double size, steep, bend; } bounds;

/* P, dP/dx, dP/dy of n points, n <= FREEFORM_BLOCK; no array is NULL, and no two overlap. */
typedef struct sag_values { double *p, *px, *py; } sag_values;

typedef struct departure {
    /* P and its gradient.  In every lane the same operations in the same order, whatever n is (lanes.h):
     * one point by itself has the bits it has among others.  NaN where P is not defined; where P is and its
     * gradient is not (the tip of a cone) one of the gradients beside it, or their mean. */
    void (*at)(const void *self, size_t n, const double *x, const double *y, sag_values out);

    /* How far `at` can be off: *p_err >= |computed P - exact P|, *grad_err >= that of each of its two
     * derivatives, for the given x and y taken as exact (running error analysis; derive it in the head of
     * the file). */
    void (*rounding)(const void *self, double x, double y, double *p_err, double *grad_err);

    /* Bounds over the region.  1: P is defined all over it; 0: nowhere in it; -1: perhaps in a part of it:
     * `where` is then made the (convex) part outside of which it is not, and the bounds hold where P is
     * defined. */
    int (*bounds)(const void *self, region *where, bounds *out);

    /* What P can be over the region, where it is defined: asked near the edge of the domain, where the
     * gradient has no bound.  NULL: +- size. */
    sgt_interval (*range)(const void *self, const region *where);

    /* The second derivatives: pxx, pxy, pyy. */
    void (*second)(const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
                   double *pyy);

    /* The parameters of P, and dP / d(parameter j) with its gradient. */
    size_t (*parameters)(const void *self);
    void (*by_parameter)(const void *self, size_t j, size_t n, const double *x, const double *y,
                         sag_values out);

    /* {NULL, NULL} where the parameters of P are valid (those of the base are not asked for).  The name is
     * that of the parameter in the table (builtins.c), the reason goes behind it: "must be above 0". */
    sgt_objection (*object)(const void *self);

    /* Within `radius` of the axis |computed P - exact P| <= e[0] + e[1] r^2: coarser than `rounding`, and
     * the same for all points, so that many rays share the work.  Terms that vanish with r^2 should be in
     * e[1].  NULL: not known. */
    void (*noise)(const void *self, double radius, double e[2]);

    /* The same at less cost, perhaps wider: asked for many radii.  NULL: noise. */
    void (*noise_about)(const void *self, double radius, double e[2]);

    /* P is defined within a rectangle and nowhere else, and where it is defined `bounds` says so much of it
     * although it is not all over the region. */
    bool framed;

    /* dP/dc with its gradient, where P depends on the curvature of its base; NULL: it does not. */
    void (*by_curvature)(const void *self, size_t n, const double *x, const double *y, sag_values out);
} departure;

/* A sag as departure/departure.c sees it.  base: c and k are parameters of F; without, the base is a plane,
 * and c and k are those of a conic that leads to a good seed. */
typedef struct departure_sag {
    double c, k, semi_diameter;
    bool base;
    const departure *of;
    const void *self;
    bool fixed_k; /* k is no parameter */
    double reach; /* farther than this from the axis P is not defined; 0: not known */
} departure_sag;

/* With a rim no wider than `most`. */
SGT_INLINE departure_sag sgt_departure_narrowed(departure_sag s, double most)
{
    if (!(s.semi_diameter > 0 && s.semi_diameter <= most))
        s.semi_diameter = most < HUGE_VAL ? most : s.semi_diameter;
    return s;
}

double sgt_departure_value(const departure_sag *s, sgt_vec3 p, sgt_vec3 *grad);
void sgt_departure_values(const departure_sag *s, size_t n, sgt_points p, sgt_values out);
double sgt_departure_rounding(const departure_sag *s, sgt_vec3 p);
void sgt_departure_share(const departure_sag *s, sgt_shared *shared);
void sgt_departure_heights(const departure_sag *s, sgt_heights *out);
void sgt_departure_within(const departure_sag *s, sgt_extent *extent);
void sgt_departure_chords(size_t n, sgt_rays rays, const double *radius2, const double *steep, double *lo,
                         double *hi, double *least);
void sgt_departure_noise(const departure_sag *s, double radius, double e[2]);
void sgt_departure_noise_about(const departure_sag *s, double radius, double e[2]);
sgt_span sgt_departure_span(const sgt_shared *shared, const sgt_ray *ray, double *least);
void sgt_departure_spans(const sgt_shared *shared, size_t n, sgt_rays rays, sgt_spans out, double *least);
sgt_interval sgt_departure_enclose(const departure_sag *s, const sgt_ray *ray, double t0, sgt_interval t,
                                   sgt_interval *slope);
bool sgt_departure_roundings(const sgt_shared *shared, size_t n, sgt_points p, const double f[],
                             double out[]);
void sgt_departure_second(const departure_sag *s, size_t n, sgt_points p, double *const out[6]);
size_t sgt_departure_parameters(const departure_sag *s);
void sgt_departure_by_parameter(const departure_sag *s, size_t j, size_t n, sgt_points p, sgt_values out);
sgt_objection sgt_departure_object(const departure_sag *s);

/* What the objects of several share: the first number of a list that is not finite, or too many of them. */
SGT_INLINE bool numbers_finite(size_t n, const double *x)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += x[i] - x[i];
    return sum == 0;
}

/* A list of at most `most` numbers; none at all is a list. */
SGT_INLINE sgt_objection object_to_list(const char *name, sgt_numbers a, size_t most, const char *too_long)
{
    if (a.rows == 0 || a.columns == 0) return (sgt_objection){NULL, NULL};
    if (!a.x) return (sgt_objection){name, "has no numbers"};
    if (a.rows != 1 || a.columns > most) return (sgt_objection){name, too_long};
    if (!numbers_finite(a.columns, a.x)) return (sgt_objection){name, "must be finite"};
    return (sgt_objection){NULL, NULL};
}

/* The operations of a surface whose parameters are a TYPE: VIEW(s) is an expression of type freeform for a
 * pointer s to one, and the surface is sgt_NAME_ops. */
#define FREEFORM_OPS(NAME, TYPE, VIEW)                                                                      \
    static departure_sag NAME##_view(const void *self)                                                      \
    {                                                                                                       \
        const TYPE *s = self;                                                                               \
        return VIEW(s);                                                                                     \
    }                                                                                                       \
    static double NAME##_ops_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)                            \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        return sgt_departure_value(&v, p, grad);                                                            \
    }                                                                                                       \
    static void NAME##_ops_values(const void *self, size_t n, sgt_points p, sgt_values out)                 \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_values(&v, n, p, out);                                                                \
    }                                                                                                       \
    static double NAME##_ops_rounding(const void *self, sgt_vec3 p)                                         \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        return sgt_departure_rounding(&v, p);                                                               \
    }                                                                                                       \
    static void NAME##_share(const void *self, sgt_shared *shared)                                          \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_share(&v, shared);                                                                    \
    }                                                                                                       \
    static void NAME##_share_within(const void *self, double most, sgt_shared *shared)                      \
    {                                                                                                       \
        departure_sag v = sgt_departure_narrowed(NAME##_view(self), most);                                  \
        sgt_departure_share(&v, shared);                                                                    \
    }                                                                                                       \
    static void NAME##_extent_within(const void *self, double most, sgt_extent *extent)                     \
    {                                                                                                       \
        departure_sag v = sgt_departure_narrowed(NAME##_view(self), most);                                  \
        sgt_departure_within(&v, extent);                                                                   \
    }                                                                                                       \
    static void NAME##_heights(const void *self, sgt_heights *out)                                          \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_heights(&v, out);                                                                     \
    }                                                                                                       \
    static void NAME##_noise_within(const void *self, double radius, double e[2])                           \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_noise_about(&v, radius, e);                                                           \
    }                                                                                                       \
    static sgt_span NAME##_own_span(const void *self, const sgt_shared *shared, const sgt_ray *ray,         \
                                    double *least)                                                          \
    {                                                                                                       \
        (void)self;                                                                                         \
        return sgt_departure_span(shared, ray, least);                                                      \
    }                                                                                                       \
    static void NAME##_own_spans(const void *self, const sgt_shared *shared, size_t n, sgt_rays r,          \
                                 sgt_spans out, double *least)                                              \
    {                                                                                                       \
        (void)self;                                                                                         \
        sgt_departure_spans(shared, n, r, out, least);                                                      \
    }                                                                                                       \
    static sgt_span NAME##_ops_span(const void *self, const sgt_ray *ray)                                   \
    {                                                                                                       \
        sgt_shared e;                                                                                       \
        NAME##_share(self, &e);                                                                             \
        return sgt_departure_span(&e, ray, NULL);                                                           \
    }                                                                                                       \
    static void NAME##_ops_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)                     \
    {                                                                                                       \
        sgt_shared e;                                                                                       \
        NAME##_share(self, &e);                                                                             \
        sgt_departure_spans(&e, n, r, out, NULL);                                                           \
    }                                                                                                       \
    static sgt_interval NAME##_own_enclose(const void *self, const sgt_ray *ray, double t0, sgt_interval t, \
                                           sgt_interval *slope)                                             \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        return sgt_departure_enclose(&v, ray, t0, t, slope);                                                \
    }                                                                                                       \
    static sgt_interval NAME##_ops_enclose(const void *self, const sgt_ray *ray, sgt_interval t,            \
                                           sgt_interval *slope)                                             \
    {                                                                                                       \
        return NAME##_own_enclose(self, ray, 0, t, slope);                                                  \
    }                                                                                                       \
    static void NAME##_ops_second(const void *self, size_t n, sgt_points p, double *const out[6])           \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_second(&v, n, p, out);                                                                \
    }                                                                                                       \
    static size_t NAME##_ops_parameters(const void *self)                                                   \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        return sgt_departure_parameters(&v);                                                                \
    }                                                                                                       \
    static void NAME##_ops_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out) \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        sgt_departure_by_parameter(&v, j, n, p, out);                                                       \
    }                                                                                                       \
    static bool NAME##_ops_roundings(const void *self, const sgt_shared *shared, size_t n, sgt_points p,    \
                                     const double f[], double out[])                                        \
    {                                                                                                       \
        (void)self;                                                                                         \
        return sgt_departure_roundings(shared, n, p, f, out);                                               \
    }                                                                                                       \
    sgt_objection sgt_##NAME##_object(const void *self)                                                     \
    {                                                                                                       \
        departure_sag v = NAME##_view(self);                                                                \
        return sgt_departure_object(&v);                                                                    \
    }                                                                                                       \
    static double NAME##_rim(const void *self)                                                              \
    {                                                                                                       \
        const TYPE *s = self;                                                                               \
        return s->semi_diameter;                                                                            \
    }                                                                                                       \
    static const struct sgt_builtin_ops NAME##_builtin = {.object = sgt_##NAME##_object,                    \
                                                          .tile = SGT_MOST_TILE,                            \
                                                          .share = NAME##_share,                            \
                                                          .share_within = NAME##_share_within,              \
                                                          .extent_within = NAME##_extent_within,            \
                                                          .heights = NAME##_heights,                        \
                                                          .chords = sgt_departure_chords,                   \
                                                          .noise_within = NAME##_noise_within,              \
                                                          .roundings = NAME##_ops_roundings,                \
                                                          .span = NAME##_own_span,                          \
                                                          .spans = NAME##_own_spans,                        \
                                                          .enclose = NAME##_own_enclose,                    \
                                                          .rim = NAME##_rim,                                \
                                                          .departure = &NAME##_departure};                  \
    const sgt_surface_ops sgt_##NAME##_ops = {.name = #NAME,                                                \
                                              .value = NAME##_ops_value,                                    \
                                              .span = NAME##_ops_span,                                      \
                                              .rounding = NAME##_ops_rounding,                              \
                                              .enclose = NAME##_ops_enclose,                                \
                                              .values = NAME##_ops_values,                                  \
                                              .spans = NAME##_ops_spans,                                    \
                                              .own_ = &NAME##_builtin,                                      \
                                              .second = NAME##_ops_second,                                  \
                                              .parameters = NAME##_ops_parameters,                          \
                                              .by_parameter = NAME##_ops_by_parameter};

/* On a conic base of its own. */
#define FREEFORM_ON_CONIC(NAME, TYPE)                                                               \
    static departure_sag NAME##_on_conic(const TYPE *s)                                             \
    {                                                                                               \
        return (departure_sag){s->c, s->k, s->semi_diameter, true, &NAME##_departure, s, false, 0}; \
    }                                                                                               \
    FREEFORM_OPS(NAME, TYPE, NAME##_on_conic)

/* The objections of each (sgt_builtin, object). */
sgt_objection sgt_odd_asphere_object(const void *self);
sgt_objection sgt_polynomial_xy_object(const void *self);
sgt_objection sgt_chebyshev_object(const void *self);
sgt_objection sgt_zernike_object(const void *self);
sgt_objection sgt_q_con_object(const void *self);
sgt_objection sgt_q_bfs_object(const void *self);
sgt_objection sgt_grid_object(const void *self);
sgt_objection sgt_sum_object(const void *self);
sgt_objection sgt_toroidal_object(const void *self);
sgt_objection sgt_biconic_object(const void *self);
sgt_objection sgt_cylinder_object(const void *self);
sgt_objection sgt_quadric_object(const void *self);
sgt_objection sgt_ellipsoid_object(const void *self);
sgt_objection sgt_torus_object(const void *self);

void sgt_grid_prepare(void *self);

#endif
