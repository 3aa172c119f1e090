// SPDX-License-Identifier: MIT
/* sgt_check finds each planted fault and no other: sound surfaces of every kind, steep ones and
 * edges among them, are SOUND on random rays. */
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/interval.h>
#include <sagitta/surfaces.h>

/* ------------------------------------------------- a torus with faults in it */

typedef enum fault {
    NO_FAULT,
    NEGATED,
    NORMALISED,
    COMPONENT_X,
    COMPONENT_Y,
    COMPONENT_Z,
    ZERO_GRADIENT,
    INFINITE_GRADIENT,
    TINY_FAULT, /* of the gradient */
    SHORT_SPAN,
    EARLY_SPAN,
    NO_PASSING_BY,
    NAN_SPAN,
    FALSE_SINGLE, /* of the span */
    NAN_ROUNDING,
    NEGATIVE_ROUNDING,
    INFINITE_ROUNDING,
    LAST_BIT,
    LAST_SLOPE,
    LAST_POINT,
    NO_NULL,
    TOO_MANY,
    NOT_NAN, /* of values */
    LAST_SEED,
    OTHER_SINGLE,
    LAST_RAY, /* of spans */
    FAULTS
} fault;

typedef struct faulty { double R, r; fault what; } faulty;

static double faulty_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const faulty *s = self;
    double R2 = s->R * s->R, q = p.x * p.x + p.y * p.y, w = q + p.z * p.z + R2 - s->r * s->r, by = 1;
    sgt_vec3 n = {4 * p.x * (w - 2 * R2), 4 * p.y * (w - 2 * R2), 4 * p.z * w};
    if (grad) {
        switch (s->what) {
        case NEGATED: by = -1; break;
        case NORMALISED: by = 1 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z); break;
        case ZERO_GRADIENT: by = 0; break;
        case COMPONENT_X: n.x *= 1.001; break;
        case COMPONENT_Y: n.y *= 0.999; break;
        case COMPONENT_Z: n.z *= 1.001; break;
        case TINY_FAULT: n.z *= 1 + 1e-6; break;
        default: break;
        }
        *grad = (sgt_vec3){by * n.x, by * n.y, by * n.z};
        if (s->what == INFINITE_GRADIENT) grad->z = FAR;
    }
    return s->what == NOT_NAN && p.x < 0 ? NOT : w * w - 4 * R2 * q;
}

/* What is wrong, if anything, is wrong at one point of many. */
static void faulty_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    const faulty *s = self;
    for (size_t i = 0; i < n + (s->what == TOO_MANY && n > 40 ? 1 : 0); i++) {
        size_t k = i < n ? i : n - 1;
        sgt_vec3 at = {p.p[0][k], p.p[1][k], p.p[2][k]}, grad;
        double f = faulty_value(self, at, &grad);
        if (s->what == LAST_BIT && i == 31) f = nextafter(f, FAR);
        if (s->what == LAST_SLOPE && i == 60) grad.y = nextafter(grad.y, FAR);
        if (s->what == LAST_POINT && n < 8 && i == n - 1) f = 0;
        if (s->what == NO_NULL && !out.grad[0]) f += f;
        if (s->what == NOT_NAN && isnan(f)) f = 0;
        out.f[i] = f;
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static sgt_span faulty_span(const void *self, const sgt_ray *ray)
{
    const faulty *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    double a = d.x * d.x + d.y * d.y + d.z * d.z, t = -(o.x * d.x + o.y * d.y + o.z * d.z) / a,
           R = (s->R + s->r) * (1 + 1e-12);
    double x = o.x + t * d.x, y = o.y + t * d.y, z = o.z + t * d.z, h2 = (R * R - x * x - y * y - z * z) / a;
    sgt_span span = {.lo = t - sqrt(h2), .hi = t + sqrt(h2), .seed = t};
    if (h2 < 0) span = (sgt_span){.lo = 1, .hi = -1};
    if (s->what == SHORT_SPAN) span.hi = t + 0.2 * sqrt(h2);
    if (s->what == EARLY_SPAN) span.hi = t - 0.2 * sqrt(h2);
    if (s->what == NO_PASSING_BY) span = (sgt_span){.lo = 1, .hi = -1};
    if (s->what == NAN_SPAN) span.lo = NOT;
    if (s->what == FALSE_SINGLE) span.single = true;
    return span;
}

static void faulty_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    const faulty *s = self;
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {r.o[0][i], r.o[1][i], r.o[2][i]}, .d = {r.d[0][i], r.d[1][i], r.d[2][i]}};
        sgt_span span = faulty_span(self, &ray);
        bool passes = span.lo > span.hi;
        if (s->what == LAST_SEED && i % 7 == 6) span.seed = nextafter(span.seed, FAR);
        if (s->what == OTHER_SINGLE && i % 9 == 0) span.single = !span.single;
        if (s->what == LAST_RAY && i == n - 1 && !passes) span.hi = 2 * span.hi;
        if (passes) span = (sgt_span){.lo = 3, .hi = -FAR, .seed = NOT}; /* nobody reads those */
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

static double faulty_rounding(const void *self, sgt_vec3 p)
{
    const faulty *s = self;
    double R2 = s->R * s->R, q = p.x * p.x + p.y * p.y, W = q + p.z * p.z + R2 + s->r * s->r;
    if (s->what == NAN_ROUNDING) return NOT;
    if (s->what == NEGATIVE_ROUNDING) return -1e-20;
    if (s->what == INFINITE_ROUNDING) return FAR;
    return 0x1p-53 * (14 * W * W + 24 * R2 * q);
}

static const sgt_surface_ops faulty_ops = {.name = "torus",
                                           .value = faulty_value,
                                           .span = faulty_span,
                                           .rounding = faulty_rounding,
                                           .values = faulty_values,
                                           .spans = faulty_spans},
                             bare_ops = {.name = "torus", .value = faulty_value},
                             spanned_ops = {.name = "torus", .value = faulty_value, .span = faulty_span};

/* Rays through the torus of size 1, far beyond it at both ends. */
static void rays_through(generator *g, double size, size_t n, sgt_ray rays[])
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 d = random_direction(g), at = random_point(g, 0.6 * size);
        double away = uniform(g, 3, 6) * size, length = log_uniform(g, 0.1, 10);
        rays[i] = (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                            .d = {d.x * length, d.y * length, d.z * length},
                            .tmin = 0,
                            .tmax = 2 * away / length};
    }
}

static void test_planted(void **state)
{
    (void)state;
    generator g = seeded("planted faults");
    for (int what = NO_FAULT; what < FAULTS; what++)
        for (int again = 0; again < 8; again++) {
            double size = log_uniform(&g, 1e-4, 1e4);
            faulty s = {size, 0.4 * size, (fault)what};
            sgt_ray rays[24];
            rays_through(&g, size, COUNT_OF(rays), rays);
            sgt_fault want = what == NO_FAULT            ? SGT_SOUND
                             : what <= TINY_FAULT        ? SGT_WRONG_GRADIENT
                             : what <= FALSE_SINGLE      ? SGT_WRONG_SPAN
                             : what <= INFINITE_ROUNDING ? SGT_WRONG_ROUNDING
                             : what <= NOT_NAN           ? SGT_WRONG_VALUES
                                                         : SGT_WRONG_SPANS;
            sgt_vec3 where;
            sgt_fault got = sgt_check((sgt_surface){&faulty_ops, &s}, COUNT_OF(rays), rays, &where);
            REQUIRE(got == want, "fault %d, size %g: %s at %g %g %g", what, size, sgt_fault_text(got),
                    where.x, where.y, where.z);
            REQUIRE((got == SGT_SOUND) == isnan(where.x), "fault %d: where is %g", what, where.x);
            REQUIRE(sgt_check((sgt_surface){&faulty_ops, &s}, COUNT_OF(rays), rays, NULL) == got,
                    "fault %d: another answer without `where`", what);
            /* with less on offer, what is on offer is checked */
            got = sgt_check((sgt_surface){&bare_ops, &s}, COUNT_OF(rays), rays, NULL);
            REQUIRE(got == (want == SGT_WRONG_GRADIENT ? want : SGT_SOUND), "fault %d, bare: %s", what,
                    sgt_fault_text(got));
            got = sgt_check((sgt_surface){&spanned_ops, &s}, COUNT_OF(rays), rays, NULL);
            REQUIRE(got == (want == SGT_WRONG_GRADIENT || want == SGT_WRONG_SPAN ? want : SGT_SOUND),
                    "fault %d, no more than a span: %s", what, sgt_fault_text(got));
        }
}

static void test_where(void **state)
{
    (void)state;
    /* a gradient that is wrong on one side only */
    generator g = seeded("where");
    faulty s = {1, 0.4, SHORT_SPAN};
    sgt_ray rays[24];
    rays_through(&g, 1, COUNT_OF(rays), rays);
    sgt_vec3 where;
    assert_int_equal(sgt_check((sgt_surface){&faulty_ops, &s}, COUNT_OF(rays), rays, &where), SGT_WRONG_SPAN);
    /* the point is the root that the span leaves out */
    REQUIRE(fabs(faulty_value(&s, where, NULL)) < 1e-9, "F is %g at the root that shows it",
            faulty_value(&s, where, NULL));
}

/* An end of a span that is no number is a fault, either of them. */
static sgt_span half_told(const void *self, const sgt_ray *ray)
{
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL};
    (void)ray;
    *(*(const int *)self ? &span.hi : &span.lo) = (double)NAN;
    return span;
}
static double flat(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad) *grad = (sgt_vec3){0, 0, 1};
    return p.z;
}
static void test_span_of_nan(void **state)
{
    (void)state;
    generator g = seeded("a span with a NaN");
    sgt_ray rays[24];
    rays_through(&g, 1, COUNT_OF(rays), rays);
    for (int hi = 0; hi < 2; hi++)
        assert_int_equal(sgt_check((sgt_surface){&(sgt_surface_ops){.value = flat, .span = half_told}, &hi},
                                   COUNT_OF(rays), rays, NULL),
                         SGT_WRONG_SPAN);
}

/* A number written behind the last, in any of the arrays. */
static void one_more(const void *self, size_t n, sgt_points p, sgt_values out)
{
    int which = *(const int *)self;
    for (size_t i = 0; i < n; i++) {
        out.f[i] = p.p[2][i];
        for (int j = 0; out.grad[0] && j < 3; j++) out.grad[j][i] = j == 2;
    }
    if (which == 0) out.f[n] = 7;
    else if (which < 4 && out.grad[0]) out.grad[which - 1][n] = 7;
}
static void test_beyond(void **state)
{
    (void)state;
    generator g = seeded("beyond the end");
    sgt_ray rays[3];
    rays_through(&g, 1, COUNT_OF(rays), rays);
    for (int which = 0; which <= 4; which++)
        assert_int_equal(
            sgt_check((sgt_surface){&(sgt_surface_ops){.value = flat, .values = one_more}, &which},
                      COUNT_OF(rays), rays, NULL),
            which < 4 ? SGT_WRONG_VALUES : SGT_SOUND);
}

static void test_no_value(void **state)
{
    (void)state;
    sgt_ray ray = {.d = {0, 0, 1}};
    assert_int_equal(sgt_check((sgt_surface){NULL, NULL}, 1, &ray, NULL), SGT_NO_VALUE);
    assert_int_equal(sgt_check((sgt_surface){&(sgt_surface_ops){.span = faulty_span}, NULL}, 1, &ray, NULL),
                     SGT_NO_VALUE);
    assert_int_equal(sgt_check((sgt_surface){NULL, NULL}, 0, NULL, NULL), SGT_NO_VALUE);
}

static void test_spans_alone(void **state)
{
    (void)state;
    generator g = seeded("spans alone");
    faulty s = {1, 0.4, NO_FAULT};
    sgt_ray rays[3];
    rays_through(&g, 1, COUNT_OF(rays), rays);
    sgt_vec3 where;
    assert_int_equal(
        sgt_check((sgt_surface){&(sgt_surface_ops){.value = faulty_value, .spans = faulty_spans}, &s},
                  COUNT_OF(rays), rays, &where),
        SGT_WRONG_SPANS);
    assert_true(same_vector(where, rays[0].o));
    assert_int_equal(
        sgt_check((sgt_surface){&(sgt_surface_ops){.value = faulty_value, .values = faulty_values}, &s},
                  COUNT_OF(rays), rays, NULL),
        SGT_SOUND);
}

/* What is no ray says nothing; and no ray at all, nothing either. */
static void test_bad_rays(void **state)
{
    (void)state;
    faulty s = {1, 0.4, NO_FAULT};
    const sgt_ray rays[] = {
        {.d = {0, 0, 0}},
        {.d = {NOT, 0, 1}},
        {.d = {FAR, 0, 1}},
        {.o = {NOT, 0, 0}, .d = {0, 0, 1}},
        {.o = {FAR, 0, 0}, .d = {0, 0, 1}},
        {.d = {0, 0, 1}, .tmin = NOT},
        {.d = {0, 0, 1}, .tmax = NOT},
        {.d = {0, 0, 1}, .tmin = 2, .tmax = 1},
        {.d = {0, 0, 1}, .tmin = FAR, .tmax = FAR},
    };
    assert_int_equal(sgt_check((sgt_surface){&faulty_ops, &s}, COUNT_OF(rays), rays, NULL), SGT_SOUND);
    assert_int_equal(sgt_check((sgt_surface){&faulty_ops, &s}, 0, NULL, NULL), SGT_SOUND);
    const sgt_ray ends[] = {
        {.o = {1, 0.1, 0}, .d = {0, 0, 1}},
        {.o = {1, 0.1, 0}, .d = {0, 0, 1}, .tmin = -FAR, .tmax = FAR},
        {.o = {1, 0.1, 0}, .d = {0, 0, 1}, .tmin = -FAR, .tmax = -0.1},
        {.o = {1, 0.1, 0}, .d = {0, 0, 1}, .tmin = 5, .tmax = 5},
        {.o = {1, 0.1, 0}, .d = {0, 0, 1}, .tmin = 5, .tmax = FAR},
        {.o = {9, 9, 9}, .d = {0, 0, 1}},
        {.o = {9, 9, 9}, .d = {0, 0, 1}, .tmin = -FAR, .tmax = FAR},
    };
    assert_int_equal(sgt_check((sgt_surface){&faulty_ops, &s}, COUNT_OF(ends), ends, NULL), SGT_SOUND);
    assert_int_equal(sgt_check((sgt_surface){&bare_ops, &s}, COUNT_OF(ends), ends, NULL), SGT_SOUND);
}

/* --------------------------------- an enclosure and a clearance with faults in them */

typedef enum promise {
    KEPT,
    NOTHING_SAID,
    NAN_SAID,
    NAN_SLOPE,
    NO_SLOPE,
    WIDER,
    SMALLER_CLEARANCE,
    NO_CLEARANCE,
    NAN_CLEARANCE, /* true */
    NARROW,
    NARROW_BELOW,
    NARROW_SLOPE,
    TURNED_SLOPE,
    WRONG_WAY,
    EMPTY,
    EMPTY_SLOPE,
    OF_THE_MIDDLE,
    WITHOUT_D,
    TOO_SHORT,
    SHARP, /* not */
    LARGER_CLEARANCE,
    ENDLESS_CLEARANCE,
    TO_THE_AXIS,
    PROMISES
} promise;

typedef struct ball { double R; promise what; } ball;

/* |p| - R, or |p|^2 - R^2: what keeps to the square has tight intervals. */
static double ball_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const ball *s = self;
    if (grad) *grad = (sgt_vec3){2 * p.x, 2 * p.y, 2 * p.z};
    return p.x * p.x + p.y * p.y + p.z * p.z - s->R * s->R;
}
static double ball_rounding(const void *self, sgt_vec3 p)
{
    const ball *s = self;
    return 0x1p-51 * (p.x * p.x + p.y * p.y + p.z * p.z + s->R * s->R);
}
static sgt_interval ball_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const ball *s = self;
    sgt_interval g = sgt_interval_of(0), half = g, t_own = t;
    if (s->what == OF_THE_MIDDLE) t = sgt_interval_of(sgt_interval_middle(t));
    if (s->what == TOO_SHORT) t = sgt_interval_between(t.lo, t.lo + 0.7 * (t.hi - t.lo));
    const double o[] = {ray->o.x, ray->o.y, ray->o.z}, d[] = {ray->d.x, ray->d.y, ray->d.z};
    for (int i = 0; i < 3; i++) {
        sgt_interval x = sgt_interval_sum(sgt_interval_of(o[i]), sgt_interval_scaled(t, d[i]));
        g = sgt_interval_sum(g, sgt_interval_square(x)),
        half = sgt_interval_sum(half, sgt_interval_scaled(x, s->what == WITHOUT_D ? 1 : d[i]));
    }
    g = sgt_interval_difference(g, sgt_interval_square(sgt_interval_of(s->R)));
    *slope = sgt_interval_scaled(half, 2);
    double width = 1e-6 * (g.hi - g.lo), steep = slope->hi - slope->lo;
    switch (s->what) {
    case NOTHING_SAID: return *slope = sgt_interval_all(), *slope;
    case NAN_SAID: return *slope = (sgt_interval){NOT, NOT}, *slope;
    case NAN_SLOPE: *slope = (sgt_interval){NOT, NOT}; break;
    case NO_SLOPE: *slope = sgt_interval_all(); break;
    case WIDER: g.lo -= width, g.hi += 3 * width; break;
    case NARROW: g.lo += width, g.hi -= width; break;
    case NARROW_BELOW: g.lo += width; break;
    case NARROW_SLOPE: slope->lo += 1e-6 * steep, slope->hi -= 1e-6 * steep; break;
    case TURNED_SLOPE: *slope = sgt_interval_negative(*slope); break;
    case WRONG_WAY: g = sgt_interval_negative(g); break;
    case EMPTY: g = sgt_interval_empty(); break;
    case EMPTY_SLOPE: *slope = sgt_interval_empty(); break;
    case SHARP: if (t_own.lo < t_own.hi) g = sgt_interval_of(0.5 * g.lo + 0.5 * g.hi); break;
    default: break;
    }
    return g;
}
static double ball_clearance(const void *self, sgt_vec3 p)
{
    const ball *s = self;
    double r = sqrt(p.x * p.x + p.y * p.y + p.z * p.z), off = fabs(r - s->R) - 0x1p-50 * (r + s->R);
    switch (s->what) {
    case SMALLER_CLEARANCE: return 0.5 * off;
    case NO_CLEARANCE: return -1;
    case NAN_CLEARANCE: return NOT;
    case LARGER_CLEARANCE: return 1.0001 * off;
    case ENDLESS_CLEARANCE: return FAR;
    case TO_THE_AXIS: return sqrt(p.x * p.x + p.y * p.y);
    default: return off;
    }
}

/* Of many cells.  enclose keeps its promises, encloses may not. */
typedef enum company { IN_COMPANY, BY_COUNT, BY_PLACE, BY_SLOPE, BEYOND, BEYOND_ONE, COMPANIES } company;
typedef struct crowd {
    ball of;
    company how;
} crowd;
static double crowd_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return ball_value(&((const crowd *)self)->of, p, grad);
}
static sgt_interval crowd_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    ball honest = {((const crowd *)self)->of.R, KEPT};
    return ball_enclose(&honest, ray, t, slope);
}
static void crowd_encloses(const void *self, size_t n, sgt_rays r, const double *lo, const double *hi,
                           sgt_enclosures out)
{
    const crowd *s = self;
    bool slopes = out.slope_lo != NULL;
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, NOT, NOT};
        sgt_interval slope, g = ball_enclose(&s->of, &ray, (sgt_interval){lo[i], hi[i]}, &slope);
        bool wider = (s->how == BY_COUNT && n > 1) || (s->how == BY_PLACE && i % 2 == 1) ||
                     (s->how == BY_SLOPE && !slopes);
        out.lo[i] = g.lo - (wider ? 1e-15 * fabs(g.lo) : 0), out.hi[i] = g.hi;
        if (slopes) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
    if ((s->how == BEYOND && n > 1 && n < 20) || (s->how == BEYOND_ONE && n == 1)) out.hi[n] = 0;
}

static void test_many_enclosures(void **state)
{
    (void)state;
    generator g = seeded("many enclosures");
    sgt_surface_ops ops = {
        .size = sizeof ops, .value = crowd_value, .enclose = crowd_enclose, .encloses = crowd_encloses};
    for (int what = KEPT; what < LARGER_CLEARANCE; what++)
        for (int how = IN_COMPANY; how < (what == KEPT ? COMPANIES : 1); how++) {
            double size = log_uniform(&g, 1e-4, 1e4);
            crowd s = {{size, (promise)what}, (company)how};
            sgt_ray rays[12];
            rays_through(&g, size, COUNT_OF(rays), rays);
            sgt_fault want = what < NARROW && how == IN_COMPANY ? SGT_SOUND : SGT_WRONG_ENCLOSURES,
                      got = sgt_check((sgt_surface){&ops, &s}, COUNT_OF(rays), rays, NULL);
            REQUIRE(got == want, "promise %d, company %d, size %g: %s", what, how, size, sgt_fault_text(got));
            sgt_surface_ops before = ops, alone = ops;
            before.size = offsetof(sgt_surface_ops, encloses), alone.enclose = NULL;
            got = sgt_check((sgt_surface){&before, &s}, COUNT_OF(rays), rays, NULL);
            REQUIRE(got == SGT_SOUND, "a table that ends before: %s", sgt_fault_text(got));
            got = sgt_check((sgt_surface){&alone, &s}, COUNT_OF(rays), rays, NULL);
            REQUIRE(got == SGT_WRONG_ENCLOSURES, "without enclose: %s", sgt_fault_text(got));
        }
}

/* A jump at x = 0, of a slope that is told as bounded; and where F ends at x = 0, told or not. */
static double step_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    int what = *(const int *)self;
    if (grad) *grad = (sgt_vec3){1, 0, 0};
    return p.x < 0 ? p.x - 1 : what < 2 ? p.x + 1 : NOT;
}
static sgt_interval step_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    int what = *(const int *)self;
    sgt_interval x = sgt_interval_sum(sgt_interval_of(ray->o.x), sgt_interval_scaled(t, ray->d.x)),
                 below = sgt_interval_between(x.lo, x.hi < 0 ? x.hi : 0),
                 above = sgt_interval_between(x.lo > 0 ? x.lo : 0, x.hi);
    *slope = what == 0 && x.lo <= 0 && x.hi >= 0 ? sgt_interval_all() : sgt_interval_of(ray->d.x);
    below = sgt_interval_difference(below, sgt_interval_of(1)),
    above = sgt_interval_sum(above, sgt_interval_of(1));
    if (what == 3 && x.lo > -0.2) return sgt_interval_empty(); /* too soon */
    return what < 2 ? sgt_interval_hull(below, above) : below;
}

static void test_promises(void **state)
{
    (void)state;
    generator g = seeded("enclosures and clearances");
    static const sgt_surface_ops ball_ops = {.value = ball_value,
                                             .rounding = ball_rounding,
                                             .enclose = ball_enclose,
                                             .clearance = ball_clearance},
                                 untold_ops = {.value = ball_value,
                                               .enclose = ball_enclose,
                                               .clearance = ball_clearance},
                                 step_ops = {.value = step_value, .enclose = step_enclose};
    for (int what = KEPT; what < PROMISES; what++)
        for (int again = 0; again < 10; again++) {
            double size = log_uniform(&g, 1e-4, 1e4);
            ball s = {size, (promise)what};
            sgt_ray rays[12];
            rays_through(&g, size, COUNT_OF(rays), rays);
            sgt_vec3 where;
            sgt_fault want = what < NARROW             ? SGT_SOUND
                             : what < LARGER_CLEARANCE ? SGT_WRONG_ENCLOSURE
                                                       : SGT_WRONG_CLEARANCE;
            sgt_fault got = sgt_check((sgt_surface){&ball_ops, &s}, COUNT_OF(rays), rays, &where);
            REQUIRE(got == want, "promise %d, size %g: %s at %g %g %g", what, size, sgt_fault_text(got),
                    where.x, where.y, where.z);
            REQUIRE((got == SGT_SOUND) == isnan(where.x), "promise %d: where is %g", what, where.x);
            got = sgt_check((sgt_surface){&untold_ops, &s}, COUNT_OF(rays), rays, &where);
            REQUIRE(got == want, "promise %d, size %g, without rounding: %s at %g %g %g", what, size,
                    sgt_fault_text(got), where.x, where.y, where.z);
        }
    for (int what = 0; what < 4; what++) {
        sgt_ray rays[12];
        rays_through(&g, 1, COUNT_OF(rays), rays);
        sgt_fault got = sgt_check((sgt_surface){&step_ops, &what}, COUNT_OF(rays), rays, NULL);
        REQUIRE(got == (what & 1 ? SGT_WRONG_ENCLOSURE : SGT_SOUND), "step %d: %s", what,
                sgt_fault_text(got));
    }
}

/* ---------------------------------------------- sound, and hard to believe */

static double steep_value(const void *self, sgt_vec3 p, sgt_vec3 *grad) /* F = sinh(k z) - x */
{
    double k = *(const double *)self;
    if (grad) *grad = (sgt_vec3){-1, 0, k * cosh(k * p.z)};
    return sinh(k * p.z) - p.x;
}
static double cone_value(const void *self, sgt_vec3 p,
                         sgt_vec3 *grad) /* a kink on the axis, where the gradient is told as 0 */
{
    double r = sqrt(p.x * p.x + p.y * p.y);
    (void)self;
    if (grad) *grad = r > 0 ? (sgt_vec3){-p.x / r, -p.y / r, 1} : (sgt_vec3){0, 0, 1};
    return p.z - r;
}
static double fold_value(const void *self, sgt_vec3 p,
                         sgt_vec3 *grad) /* |x|: one gradient of several where x = 0 */
{
    (void)self;
    if (grad) *grad = (sgt_vec3){p.x < 0 ? -1 : 1, 0, -1};
    return fabs(p.x) - p.z;
}
static double hemisphere_value(const void *self, sgt_vec3 p,
                               sgt_vec3 *grad) /* undefined beyond r = 1, as steep as can be at it */
{
    double w = sqrt(1 - p.x * p.x - p.y * p.y);
    (void)self;
    if (grad) *grad = (sgt_vec3){-p.x / w, -p.y / w, 1};
    return p.z - 1 + w;
}
static double wave_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double k = *(const double *)self;
    if (grad)
        *grad = (sgt_vec3){-0.1 * k * cos(k * p.x) * sin(k * p.y), -0.1 * k * sin(k * p.x) * cos(k * p.y), 1};
    return p.z - 0.1 * sin(k * p.x) * sin(k * p.y);
}
static double pole_value(const void *self, sgt_vec3 p,
                         sgt_vec3 *grad) /* changes sign at a pole: no root; and at x = 1 */
{
    (void)self;
    if (grad) *grad = (sgt_vec3){1 / (p.x * p.x) + 0, 0, 0};
    return 1 - 1 / p.x;
}
static sgt_span pole_span(const void *self, const sgt_ray *ray) /* about x = 1, and not x = 0 */
{
    double t = (1 - ray->o.x) / ray->d.x, a = fabs(0.5 / ray->d.x);
    (void)self;
    return (sgt_span){.lo = t - a, .hi = t + a, .seed = t, .single = true};
}
static double undefined_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self, (void)p;
    if (grad) *grad = (sgt_vec3){1, 2, 3};
    return NOT;
}
static double nan_gradient_value(const void *self, sgt_vec3 p, sgt_vec3 *grad) /* none is offered */
{
    (void)self;
    if (grad) *grad = (sgt_vec3){NOT, NOT, NOT};
    return p.z - p.x * p.y;
}

static void test_sound(void **state)
{
    (void)state;
    generator g = seeded("sound surfaces");
    double soft = 1, steep = 30, fine = 50;
    static const sgt_surface_ops steep_ops = {.value = steep_value}, cone_ops = {.value = cone_value},
                                 fold_ops = {.value = fold_value},
                                 hemisphere_ops = {.value = hemisphere_value},
                                 wave_ops = {.value = wave_value},
                                 pole_ops = {.value = pole_value, .span = pole_span},
                                 undefined_ops = {.value = undefined_value},
                                 nan_gradient_ops = {.value = nan_gradient_value};
    const sgt_surface surfaces[] = {{&steep_ops, &soft},      {&steep_ops, &steep},    {&cone_ops, NULL},
                                    {&fold_ops, NULL},        {&hemisphere_ops, NULL}, {&wave_ops, &soft},
                                    {&wave_ops, &fine},       {&pole_ops, NULL},       {&undefined_ops, NULL},
                                    {&nan_gradient_ops, NULL}};
    long n = scaled(300);
    for (long i = 0; i < n; i++)
        for (size_t k = 0; k < COUNT_OF(surfaces); k++) {
            sgt_ray rays[4];
            rays_through(&g, 1, COUNT_OF(rays), rays);
            rays[0].o.x = 0, rays[0].d.x = 0; /* in the plane of symmetry: on the fold */
            if (k == 7) rays[0].d.x = 1;
            rays[1].o.x = rays[1].o.y = 0, rays[1].d = (sgt_vec3){k == 7, 0, 1}; /* on the axis */
            sgt_vec3 where;
            sgt_fault got = sgt_check(surfaces[k], COUNT_OF(rays), rays, &where);
            REQUIRE(got == SGT_SOUND, "case %ld, surface %zu: %s at %.17g %.17g %.17g", i, k,
                    sgt_fault_text(got), where.x, where.y, where.z);
        }
}

static void test_builtin(void **state)
{
    (void)state;
    generator g = seeded("built-in surfaces");
    long n = scaled(1000);
    for (long i = 0; i < n; i++) {
        double R = either_sign(&g) * log_uniform(&g, 1e-3, 1e6);
        sgt_even_asphere s = {.c = chance(&g, 0.1) ? 0 : 1 / R,
                         .k = chance(&g, 0.2)   ? 0
                              : chance(&g, 0.2) ? -1
                              : chance(&g, 0.2) ? either_sign(&g) * log_uniform(&g, 1e-3, 1e3)
                                                : uniform(&g, -3, 3)};
        double room = fabs(R) / sqrt(fmax(1e-3, 1 + s.k)), h = fmin(room, 2 * fabs(R));
        bool conic = chance(&g, 0.5);
        if (!conic)
            for (int j = 0, terms = 1 + below(&g, 8); j < terms; j++)
                s.a[j] = either_sign(&g) * uniform(&g, 0, 0.1) * h / pow(h, 2 * j + 2);
        if (chance(&g, 0.4)) s.semi_diameter = h * uniform(&g, 0.1, 1);
        sgt_ray rays[4];
        for (size_t j = 0; j < COUNT_OF(rays); j++) {
            double r = h * (chance(&g, 0.2) ? 1 - log_uniform(&g, 1e-12, 1) : uniform(&g, 0, 1.1)),
                   a = uniform(&g, 0, 6.28);
            sgt_vec3 d = random_direction(&g), at = {r * cos(a), r * sin(a), 0};
            at.z = -sgt_even_asphere_ops.value(&s, at, NULL);
            if (isnan(at.z)) at.z = uniform(&g, -h, h);
            double away = h * log_uniform(&g, 1e-2, 1e3), length = log_uniform(&g, 1e-2, 1e2);
            rays[j] = (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                                .d = {length * d.x, length * d.y, length * d.z}};
            int ends = below(&g, 3);
            if (ends == 1) rays[j].tmin = -FAR, rays[j].tmax = FAR;
            if (ends == 2) rays[j].tmax = 2 * away / length;
        }
        sgt_conic as_conic = {s.c, s.k, s.semi_diameter};
        sgt_vec3 where;
        sgt_fault got = sgt_check(conic ? (sgt_surface){&sgt_conic_ops, &as_conic}
                                        : (sgt_surface){&sgt_even_asphere_ops, &s},
                                  COUNT_OF(rays), rays, &where);
        REQUIRE(got == SGT_SOUND, "case %ld, %s: %s at %.17g %.17g %.17g; R %.17g k %.17g rim %.17g a %g %g",
                i, conic ? "conic" : "asphere", sgt_fault_text(got), where.x, where.y, where.z, 1 / s.c, s.k,
                s.semi_diameter, s.a[0], s.a[1]);
    }
}

/* Their enclosures among the rest. */
static void test_level_sets(void **state)
{
    (void)state;
    generator g = seeded("level sets");
    long n = scaled(60);
    for (long i = 0; i < n; i++) {
        sgt_julia s = {.c = {uniform(&g, -0.8, 0.4), uniform(&g, -0.6, 0.6), uniform(&g, -0.4, 0.4), 0},
                       .ex = {1},
                       .ey = {0, 1},
                       .ez = {0, 0, 1},
                       .escape = 4,
                       .iterations = 2 + below(&g, 5),
                       .power = 2};
        sgt_mandelbrot m = {.ex = {1},
                            .ey = {0, 1},
                            .ez = {0, 0, 1},
                            .escape = 4,
                            .iterations = 2 + below(&g, 5),
                            .power = 2};
        sgt_ray rays[3];
        rays_through(&g, 1, COUNT_OF(rays), rays);
        sgt_vec3 where;
        sgt_fault got = sgt_check((sgt_surface){&sgt_julia_ops, &s}, COUNT_OF(rays), rays, &where);
        REQUIRE(got == SGT_SOUND, "case %ld, julia: %s at %.17g %.17g %.17g", i, sgt_fault_text(got), where.x,
                where.y, where.z);
        got = sgt_check((sgt_surface){&sgt_mandelbrot_ops, &m}, COUNT_OF(rays), rays, &where);
        REQUIRE(got == SGT_SOUND, "case %ld, mandelbrot: %s at %.17g %.17g %.17g", i, sgt_fault_text(got),
                where.x, where.y, where.z);
    }
}

static void test_texts(void **state)
{
    (void)state;
    for (int i = SGT_SOUND; i <= SGT_WRONG_ARITHMETIC; i++) {
        const char *text = sgt_fault_text((sgt_fault)i);
        assert_true(text && strlen(text) > 5 && !strchr(text, '\n'));
        for (int j = SGT_SOUND; j < i; j++) assert_string_not_equal(text, sgt_fault_text((sgt_fault)j));
    }
    assert_string_equal(sgt_fault_text((sgt_fault)99), "?");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planted),         cmocka_unit_test(test_where),
        cmocka_unit_test(test_promises),        cmocka_unit_test(test_spans_alone),
        cmocka_unit_test(test_many_enclosures), cmocka_unit_test(test_span_of_nan),
        cmocka_unit_test(test_beyond),          cmocka_unit_test(test_no_value),
        cmocka_unit_test(test_bad_rays),        cmocka_unit_test(test_sound),
        cmocka_unit_test(test_builtin),         cmocka_unit_test(test_level_sets),
        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
