// SPDX-License-Identifier: MIT
/* sgt_intersect on a user's surface: what each answer of the surface buys, and what is
 * promised with no answer but `value`.  The truth is worked out in long double: by signs on
 * both sides of a hit, by dense samples where all roots are wanted. */
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>

/* ------------------------------------------------------------- a torus */

typedef struct torus { double major, minor; } torus;

static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y, w = q + p.z * p.z + R2 - s->minor * s->minor;
    if (grad) *grad = (sgt_vec3){4 * p.x * (w - 2 * R2), 4 * p.y * (w - 2 * R2), 4 * p.z * w};
    return w * w - 4 * R2 * q;
}

/* w carries at most 6 roundings of terms that add up to W, w^2 twice that and one more, the
 * last product 4, the difference 1. */
static double torus_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y, W = q + p.z * p.z + R2 + s->minor * s->minor;
    return 0x1p-53 * (14 * W * W + 24 * R2 * q);
}

static sgt_span torus_span(const void *self, const sgt_ray *ray)
{
    const torus *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    double R = (s->major + s->minor) * (1 + 1e-12), a = d.x * d.x + d.y * d.y + d.z * d.z;
    double t = -(o.x * d.x + o.y * d.y + o.z * d.z) / a, x = o.x + t * d.x, y = o.y + t * d.y,
           z = o.z + t * d.z;
    double half2 = (R * R - x * x - y * y - z * z) / a;
    if (half2 < 0) return (sgt_span){.lo = 1, .hi = -1, .seed = NOT};
    return (sgt_span){.lo = t - sqrt(half2) * (1 + 1e-12), .hi = t + sqrt(half2) * (1 + 1e-12), .seed = NOT};
}

static long double torus_exact(const void *self, const sgt_ray *ray, long double t)
{
    const torus *s = self;
    wide p = wide_sum(widen(ray->o), wide_times(t, widen(ray->d)));
    long double R2 = (long double)s->major * s->major, q = p.x * p.x + p.y * p.y,
                w = q + p.z * p.z + R2 - (long double)s->minor * s->minor;
    return w * w - 4 * R2 * q;
}

static const sgt_surface_ops torus_value_only = {.name = "torus", .value = torus_value},
                             torus_with_span = {.name = "torus", .value = torus_value, .span = torus_span},
                             torus_ops = {.name = "torus",
                                          .value = torus_value,
                                          .span = torus_span,
                                          .rounding = torus_rounding};

static sgt_ray torus_ray(generator *g)
{
    sgt_vec3 d = random_direction(g),
             at = {uniform(g, -1.4, 1.4), uniform(g, -1.4, 1.4), uniform(g, -0.4, 0.4)};
    double away = uniform(g, 3, 20), length = chance(g, 0.3) ? log_uniform(g, 1e-3, 1e3) : 1;
    return (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                     .d = {length * d.x, length * d.y, length * d.z}};
}

/* All roots of the exact torus in [lo, hi], by 4000 samples; those closer together than a
 * sample are not seen. */
enum { ROOTS = 8, DENSE = 4000 };

static int dense_roots(const torus *s, const sgt_ray *ray, long double lo, long double hi,
                       long double root[ROOTS])
{
    int n = 0;
    long double a = lo, fa = torus_exact(s, ray, a);
    for (int i = 1; i <= DENSE; i++) {
        long double b = lo + (hi - lo) * i / DENSE, fb = torus_exact(s, ray, b), l = a, r = b;
        if (fa * fb < 0) {
            for (int j = 0; j < 80; j++) {
                long double m = (l + r) / 2, fm = torus_exact(s, ray, m);
                if ((fm < 0) == (fa < 0)) l = m;
                else r = m;
            }
            if (n < ROOTS) root[n++] = (l + r) / 2;
        }
        a = b, fa = fb;
    }
    return n;
}

static void test_torus(void **state)
{
    (void)state;
    generator g = seeded("torus");
    torus shape = {1, 0.4};
    long n = scaled(3000), hits = 0, evals = 0, unproven = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        sgt_span span = torus_span(&shape, &ray);
        sgt_hit hit = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray, NULL);
        long double root[ROOTS];
        double from = fmax(span.lo, ray.tmin); /* of a short d the ray may begin inside */
        int roots = from > span.hi ? 0 : dense_roots(&shape, &ray, from, span.hi, root);
        if (from > span.hi) {
            REQUIRE(hit.status == SGT_MISS, "ray %ld passes by: %s", i, sgt_status_text(hit.status));
            continue;
        }
        REQUIRE(hit.status > 0 || hit.status == SGT_UNPROVEN, "ray %ld: %s", i, sgt_status_text(hit.status));
        if (hit.status == SGT_GRAZE) continue;
        double step = (span.hi - from) / 64;
        bool plain = roots >= 2 && root[1] - root[0] > 1.01L * step; /* a march cannot step over it */
        REQUIRE(hit.status > 0 || !plain, "ray %ld: unproven, a root at %.17Lg", i, root[0]);
        if (hit.status < 0) {
            unproven++;
            continue;
        }
        hits++, evals += hit.evals;
        long double off = 1e300L;
        for (int j = 0; j < roots; j++) off = fminl(off, fabsl(root[j] - hit.t));
        if (roots)
            REQUIRE(off <= hit.t_err, "ray %ld: t %.17g is %Lg off, t_err %g", i, hit.t, off, hit.t_err);
        if (plain)
            REQUIRE(fabsl(root[0] - hit.t) <= hit.t_err, "ray %ld: t %.17g, the first is %.17Lg", i, hit.t,
                    root[0]);
        /* a change of sign of the exact F, within t_err */
        long double l = torus_exact(&shape, &ray, hit.t - (long double)hit.t_err),
                    r = torus_exact(&shape, &ray, hit.t + (long double)hit.t_err);
        REQUIRE(l * r <= 0, "ray %ld: no change of sign at %.17g +- %g: %Lg %Lg", i, hit.t, hit.t_err, l, r);
        REQUIRE(hit.t_err <= 1e-6 * fabs(hit.t), "ray %ld: t_err %g", i, hit.t_err);
        /* the point: on the surface within p_err, on the line */
        wide p = widen(hit.p),
             on_line = wide_sum(widen(ray.o), wide_times((long double)hit.t + hit.t_lo, widen(ray.d)));
        long double aside = wide_length(wide_difference(p, on_line));
        REQUIRE(aside <= hit.p_err + (long double)hit.t_err * wide_length(widen(ray.d)) + 1e-14L,
                "ray %ld: p %Lg off the line", i, aside);
        long double f = torus_exact(&shape, &(sgt_ray){.o = hit.p}, 0), slope = wide_length(widen(hit.n));
        REQUIRE(fabsl(f) <= slope * hit.p_err + 16 * torus_rounding(&shape, hit.p),
                "ray %ld: F %Lg at p, p_err %g", i, f, hit.p_err);
        sgt_vec3 n2;
        double f2 = torus_value(&shape, hit.p, &n2);
        REQUIRE(same_bits(f2, hit.f) && same_vector(n2, hit.n), "ray %ld: f and n are not those of p", i);
    }
    print_message("%ld hits in %ld rays, %.1f evaluations a hit, %ld unproven\n", hits, n,
                  (double)evals / (double)hits, unproven);
}

/* A march in steps of dt_min sees what is thicker than that. */
static void test_march_step(void **state)
{
    (void)state;
    generator g = seeded("march step");
    torus shape = {1, 0.05};
    long n = scaled(500);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        ray.d = wide_length(widen(ray.d)) > 2 ? (sgt_vec3){0, 0, 1} : ray.d;
        sgt_span span = torus_span(&shape, &ray);
        if (span.lo > span.hi) continue;
        long double root[ROOTS];
        int roots = dense_roots(&shape, &ray, span.lo, span.hi, root);
        double dt = (span.hi - span.lo) / 1000;
        if (roots < 2 || !(root[1] - root[0] > 1.01L * dt)) continue;
        sgt_hit hit = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray,
                                    &(sgt_options){.dt_min = dt, .max_evals = 100000});
        REQUIRE(hit.status == SGT_HIT && fabsl(root[0] - hit.t) <= hit.t_err,
                "ray %ld: %s at %.17g, the first root is %.17Lg, step %g", i, sgt_status_text(hit.status),
                hit.t, root[0], dt);
    }
}

/* Less is offered, less is promised: yet a hit is a hit. */
static void test_offers(void **state)
{
    (void)state;
    generator g = seeded("offers");
    torus shape = {1, 0.4};
    const sgt_surface_ops *ops[] = {&torus_value_only, &torus_with_span, &torus_ops};
    long n = scaled(3000);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        for (size_t k = 0; k < COUNT_OF(ops); k++)
            for (int ends = 0; ends < 3; ends++)
                for (sgt_pick pick = SGT_PICK_DEFAULT; pick <= SGT_NEAR_SEED; pick++) {
                    double length = (double)wide_length(widen(ray.d));
                    ray.tmin = ends == 2 ? -FAR : 0, ray.tmax = ends == 0 ? 30 / length : FAR;
                    sgt_hit hit = sgt_intersect((sgt_surface){ops[k], &shape}, ray,
                                                &(sgt_options){.pick = pick});
                    /* no root of a line without a beginning can be called its first */
                    if (k == 0 && ends == 2 && pick != SGT_NEAR_SEED)
                        REQUIRE(hit.status == SGT_UNPROVEN, "ray %ld: a first of the whole line: %s", i,
                                sgt_status_text(hit.status));
                    if (hit.status <= 0) {
                        REQUIRE(hit.status == SGT_UNPROVEN || (k > 0 && hit.status == SGT_MISS),
                                "ray %ld, offer %zu: %s", i, k, sgt_status_text(hit.status));
                        REQUIRE(isnan(hit.t), "ray %ld: t %g", i, hit.t);
                        continue;
                    }
                    REQUIRE(hit.t >= ray.tmin && hit.t <= ray.tmax, "ray %ld: t %g outside", i, hit.t);
                    if (hit.status == SGT_GRAZE) continue;
                    /* without `rounding` all is said of F as computed: what that may be off, on top */
                    double slack = k == 2
                                       ? 0
                                       : torus_rounding(&shape, hit.p) /
                                             fabs(hit.n.x * ray.d.x + hit.n.y * ray.d.y + hit.n.z * ray.d.z);
                    long double e = (long double)hit.t_err + 4 * slack;
                    long double l = torus_exact(&shape, &ray, hit.t - e),
                                r = torus_exact(&shape, &ray, hit.t + e);
                    REQUIRE(l * r <= 0, "ray %ld, offer %zu: no change of sign at %.17g +- %g: %Lg %Lg", i, k,
                            hit.t, hit.t_err, l, r);
                }
    }
}

/* The root just left is not met again; the next one is. */
static void test_start_on_surface(void **state)
{
    (void)state;
    generator g = seeded("start on the surface");
    torus shape = {1, 0.4};
    sgt_surface s = {&torus_ops, &shape};
    long n = scaled(2000), next = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        sgt_hit first = sgt_intersect(s, ray, NULL);
        if (first.status != SGT_HIT) continue;
        double slope = fabs(first.n.x * ray.d.x + first.n.y * ray.d.y + first.n.z * ray.d.z);
        double cosine = slope / (double)(wide_length(widen(first.n)) * wide_length(widen(ray.d)));
        if (cosine < 1e-3) continue; /* a graze: the next root is as near as rounding */
        sgt_ray again = {.o = first.p, .d = ray.d, .tmin = 0};
        sgt_hit second = sgt_intersect(s, again, NULL);
        long double root[ROOTS];
        sgt_span span = torus_span(&shape, &ray);
        int roots = dense_roots(&shape, &ray, span.lo, span.hi, root), k = 0;
        while (k < roots && root[k] <= first.t + (long double)first.t_err) k++;
        bool plain = k + 1 <= roots &&
                     (k + 1 == roots || root[k + 1] - root[k] > 1.01L * (span.hi - span.lo) / 64);
        if (second.status == SGT_HIT) {
            REQUIRE(k < roots, "ray %ld: a second hit %g behind the last root", i, second.t);
            /* the start is off the line by p_err, which moves the next root by p_err over its own cosine */
            double slope2 = fabs(second.n.x * ray.d.x + second.n.y * ray.d.y + second.n.z * ray.d.z),
                   moved = 1e-12 * (double)wide_length(widen(second.n)) / slope2;
            long double off = 1e300L;
            for (int j = k; j < roots; j++) off = fminl(off, fabsl(root[j] - first.t - second.t));
            REQUIRE(off <= second.t_err + first.t_err + (long double)moved, "ray %ld: next at %.17g, %Lg off",
                    i, second.t, off);
            next++;
        } else {
            REQUIRE(!plain || second.status == SGT_GRAZE, "ray %ld: %s, the next root is %.17Lg on", i,
                    sgt_status_text(second.status), root[k] - first.t);
        }
    }
    print_message("%ld next roots\n", next);
}

/* ------------------------------------------- a conic, dressed as a user's */

static double forward_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return sgt_conic_ops.value(self, p, grad);
}
static sgt_span forward_span(const void *self, const sgt_ray *ray) { return sgt_conic_ops.span(self, ray); }
static double forward_rounding(const void *self, sgt_vec3 p) { return sgt_conic_ops.rounding(self, p); }
static const sgt_surface_ops forward = {
    .name = "conic", .value = forward_value, .span = forward_span, .rounding = forward_rounding};

static void test_conic_forwarded(void **state)
{
    (void)state;
    generator g = seeded("conic, forwarded");
    long n = scaled(30000), both = 0, evals = 0, single = 0;
    for (long i = 0; i < n; i++) {
        sgt_conic shape = {.c = chance(&g, 0.1) ? 0 : either_sign(&g) / log_uniform(&g, 0.5, 1e3),
                           .k = chance(&g, 0.3) ? 0 : uniform(&g, -4, 3)};
        double reach = fmin(shape.c != 0 ? 0.9 / fabs(shape.c) / sqrt(fmax(1, 1 + shape.k)) : 10, 10),
               angle = uniform(&g, 0, 6.28), r = reach * sqrt(uniform(&g, 0, 1));
        sgt_vec3 at = {r * cos(angle), r * sin(angle), 0}, d = random_direction(&g);
        at.z = -forward_value(&shape, (sgt_vec3){at.x, at.y, 0}, NULL);
        double away = log_uniform(&g, 0.1, 100);
        sgt_ray ray = {.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                       .d = d,
                       .tmin = -FAR,
                       .tmax = FAR};
        sgt_options opt = {.pick = SGT_NEAR_SEED};
        sgt_hit own = sgt_intersect((sgt_surface){&sgt_conic_ops, &shape}, ray, &opt),
                user = sgt_intersect((sgt_surface){&forward, &shape}, ray, &opt);
        sgt_span span = forward_span(&shape, &ray);
        REQUIRE(own.status == SGT_HIT, "ray %ld: the built-in conic says %s", i, sgt_status_text(own.status));
        if (span.single) {
            REQUIRE(user.status > 0, "ray %ld: a single root, %s", i, sgt_status_text(user.status));
            single++;
        }
        REQUIRE(user.status != SGT_MISS, "ray %ld: a miss, there is a root at %.17g", i, own.t);
        if (user.status != SGT_HIT) continue;
        both++, evals += user.evals;
        /* a single one is that one; else one of the two */
        long double off = fabsl((long double)own.t + own.t_lo - user.t - user.t_lo),
                    e = (long double)own.t_err + user.t_err;
        if (off > e && !span.single)
            for (int side = 0; side < 2; side++) {
                sgt_ray rest = ray;
                if (side) rest.tmin = own.t;
                else rest.tmax = own.t - 2 * own.t_err;
                sgt_hit other = sgt_intersect((sgt_surface){&sgt_conic_ops, &shape}, rest, NULL);
                if (other.status > 0)
                    off = fminl(off, fabsl((long double)other.t + other.t_lo - user.t - user.t_lo));
            }
        REQUIRE(off <= e, "ray %ld: %.17g and %.17g are %Lg apart, t_err %g and %g, c %g k %g single %d", i,
                own.t, user.t, off, own.t_err, user.t_err, shape.c, shape.k, span.single);
        if (user.t_err > 1e-11 * (1 + fabs(user.t))) {
            double slope = fabs(user.n.x * d.x + user.n.y * d.y + user.n.z * d.z),
                   length = (double)wide_length(widen(user.n));
            REQUIRE(slope < 1e-3 * length, "ray %ld: t_err %g at a cosine of %g", i, user.t_err,
                    slope / length);
        }
    }
    print_message("%ld of %ld rays hit by both, %ld single, %.1f evaluations a hit\n", both, n, single,
                  (double)evals / (double)both);
}

/* ------------------------------------------------ surfaces with bad manners */

/* The torus, undefined in a slab, or everywhere. */
typedef struct holed { torus shape; double lo, hi; } holed;
static double holed_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const holed *s = self;
    if (p.x > s->lo && p.x < s->hi) {
        if (grad) *grad = (sgt_vec3){NOT, NOT, NOT};
        return NOT;
    }
    return torus_value(&s->shape, p, grad);
}
static sgt_span holed_span(const void *self, const sgt_ray *ray)
{
    return torus_span(&((const holed *)self)->shape, ray);
}
static const sgt_surface_ops holed_ops = {.name = "holed torus", .value = holed_value, .span = holed_span};

static void test_undefined(void **state)
{
    (void)state;
    generator g = seeded("undefined regions");
    long n = scaled(5000), hits = 0, undefined = 0;
    for (long i = 0; i < n; i++) {
        holed s = {{1, 0.4}, uniform(&g, -1.5, 1), 0};
        s.hi = s.lo + uniform(&g, 0, 1);
        if (chance(&g, 0.05)) s.lo = -1e9, s.hi = 1e9;
        sgt_ray ray = torus_ray(&g);
        sgt_hit hit = sgt_intersect((sgt_surface){&holed_ops, &s}, ray, NULL);
        if (s.lo < -1e8)
            REQUIRE(hit.status == SGT_UNDEFINED || hit.status == SGT_MISS,
                    "ray %ld: %s where F is nowhere defined", i, sgt_status_text(hit.status));
        undefined += hit.status == SGT_UNDEFINED;
        if (hit.status <= 0) continue;
        hits++;
        REQUIRE(!(hit.p.x > s.lo + 1e-9 && hit.p.x < s.hi - 1e-9), "ray %ld: a hit where F is not defined",
                i);
        if (hit.status == SGT_GRAZE) continue;
        double slack = 4 * torus_rounding(&s.shape, hit.p) /
                       fabs(hit.n.x * ray.d.x + hit.n.y * ray.d.y + hit.n.z * ray.d.z);
        long double e = (long double)hit.t_err + slack, l = torus_exact(&s.shape, &ray, hit.t - e),
                    r = torus_exact(&s.shape, &ray, hit.t + e);
        REQUIRE(l * r <= 0, "ray %ld: no change of sign at %.17g +- %g", i, hit.t, hit.t_err);
    }
    print_message("%ld hits, %ld undefined\n", hits, undefined);
}

/* F that lies about its gradient, in every way: slower, never wrong. */
typedef struct liar { torus shape; int lie; uint64_t *bits; } liar;
static double liar_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const liar *s = self;
    sgt_vec3 n;
    double f = torus_value(&s->shape, p, &n), length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z), by = 1;
    if (!grad) return f;
    switch (s->lie) {
    case 0: by = 1 / length; break;
    case 1: by = -1; break;
    case 2: by = 1e6; break;
    case 3: by = 1e-6; break;
    case 4: by = 0; break;
    case 5: by = FAR; break;
    case 6: by = NOT; break;
    default: {
        generator g = {*s->bits};
        by = either_sign(&g) * log_uniform(&g, 1e-6, 1e6);
        *s->bits = g.state;
    }
    }
    *grad = (sgt_vec3){by * n.x, by * n.y, by * n.z};
    return f;
}
static sgt_span liar_span(const void *self, const sgt_ray *ray)
{
    return torus_span(&((const liar *)self)->shape, ray);
}
static const sgt_surface_ops liar_ops = {.name = "liar", .value = liar_value, .span = liar_span};

static void test_lying_gradient(void **state)
{
    (void)state;
    generator g = seeded("lying gradient");
    uint64_t bits = random_bits(&g);
    long n = scaled(2000), hits = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        for (int lie = 0; lie < 8; lie++) {
            liar s = {{1, 0.4}, lie, &bits};
            sgt_span span = torus_span(&s.shape, &ray);
            if (span.lo > span.hi) continue;
            long double root[ROOTS];
            int roots = dense_roots(&s.shape, &ray, span.lo, span.hi, root);
            bool plain = roots >= 2 && root[1] - root[0] > 1.01L * (span.hi - span.lo) / 64;
            sgt_hit hit = sgt_intersect((sgt_surface){&liar_ops, &s}, ray, NULL);
            REQUIRE(hit.status != SGT_MISS || roots == 0, "ray %ld, lie %d: a miss", i, lie);
            if (plain)
                REQUIRE(hit.status > 0 || hit.status == SGT_UNPROVEN, "ray %ld, lie %d: %s", i, lie,
                        sgt_status_text(hit.status));
            if (hit.status != SGT_HIT) continue;
            hits++;
            sgt_vec3 n0;
            torus_value(&s.shape, hit.p, &n0); /* what rounding can do, by the true slope */
            long double off = 1e300L, slack = 4 * torus_rounding(&s.shape, hit.p) /
                                              fabs(n0.x * ray.d.x + n0.y * ray.d.y + n0.z * ray.d.z);
            for (int j = 0; j < roots; j++) off = fminl(off, fabsl(root[j] - hit.t));
            if (roots)
                REQUIRE(off <= hit.t_err + slack, "ray %ld, lie %d: t %.17g is %Lg off, t_err %g", i, lie,
                        hit.t, off, hit.t_err);
        }
    }
    print_message("%ld hits\n", hits);
}

/* Two planes as one surface, and poles: what changes sign without being a root. */
static double poles_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    double c = cos(p.z);
    if (grad) *grad = (sgt_vec3){0, 0, 1 / (c * c)};
    return tan(p.z);
}
static sgt_span poles_span(const void *self, const sgt_ray *ray)
{
    (void)self, (void)ray;
    return (sgt_span){.lo = 0, .hi = 10, .seed = NOT};
}

static void test_poles(void **state)
{
    (void)state;
    sgt_surface s = {&(sgt_surface_ops){.name = "tangent", .value = poles_value, .span = poles_span}, NULL};
    for (int i = 0; i < 3; i++) {
        double start = 0.5 + 3.141592653589793 * i;
        sgt_hit hit = sgt_intersect(
            s, (sgt_ray){.o = {0.3, -0.2, 0}, .d = {0, 0, 1}, .tmin = start, .tmax = HUGE_VAL}, NULL);
        if (i < 2)
            REQUIRE(hit.status == SGT_HIT && fabs(hit.t - 3.141592653589793 * (i + 1)) <= hit.t_err + 2e-15 &&
                        hit.t_err < 1e-12,
                    "tan from %g: %s %.17g +- %g", start, sgt_status_text(hit.status), hit.t, hit.t_err);
        else
            REQUIRE(hit.status == SGT_HIT ? fabs(hit.t - 9.42477796076938) <= hit.t_err + 4e-15
                                          : hit.status < 0,
                    "tan from %g: %s %.17g", start, sgt_status_text(hit.status), hit.t);
    }
}

/* --------------------------------------------------- the call, its edges */

static void test_invalid(void **state)
{
    (void)state;
    torus shape = {1, 0.4};
    sgt_surface s = {&torus_ops, &shape};
    const sgt_ray good = {.o = {0, 0, -5}, .d = {0.3, 0, 1}};
    sgt_ray rays[24];
    size_t n = 0;
    for (size_t i = 0; i < COUNT_OF(rays); i++) rays[i] = good;
    rays[n++].d = (sgt_vec3){0, 0, 0};
    rays[n++].d = (sgt_vec3){0, 1e-310, 0};
    rays[n++].d.x = NOT;
    rays[n++].d.y = FAR;
    rays[n++].d.z = -FAR;
    rays[n++].o.x = NOT;
    rays[n++].o.y = FAR;
    rays[n++].o.z = -FAR;
    rays[n++].tmin = NOT;
    rays[n++].tmax = NOT;
    rays[n].tmin = 2, rays[n++].tmax = 1;
    rays[n].tmin = -1, rays[n++].tmax = -2;
    for (size_t i = 0; i < n; i++) {
        sgt_hit hit = sgt_intersect(s, rays[i], NULL);
        REQUIRE(hit.status == SGT_INVALID && isnan(hit.t) && hit.evals == 0, "bad ray %zu: %s, t %g", i,
                sgt_status_text(hit.status), hit.t);
    }
    const sgt_options bad[] = {{.t_tol = -1},  {.t_tol = NOT},  {.f_tol = -1},    {.f_tol = NOT},
                               {.dt_min = -1}, {.dt_min = NOT}, {.max_evals = -1}};
    for (size_t i = 0; i < COUNT_OF(bad); i++)
        REQUIRE(sgt_intersect(s, good, &bad[i]).status == SGT_INVALID, "bad option %zu", i);
    assert_int_equal(sgt_intersect((sgt_surface){NULL, NULL}, good, NULL).status, SGT_INVALID);
    assert_int_equal(
        sgt_intersect((sgt_surface){&(sgt_surface_ops){.name = "empty"}, NULL}, good, NULL).status,
        SGT_INVALID);
    assert_int_equal(
        sgt_intersect((sgt_surface){&(sgt_surface_ops){.span = torus_span}, &shape}, good, NULL).status,
        SGT_INVALID);
}

/* A table may be longer than this version's, as that of a program compiled with a later header is, or end
 * where that of 0.2 did; a shorter one is nowhere read beyond its name and value. */
static void test_size_of_table(void **state)
{
    (void)state;
    torus shape = {1, 0.4};
    sgt_ray ray = {{0.9, 0.1, -5}, {0, 0, 1}, 0, 0};
    struct { sgt_surface_ops ops; void (*later[4])(void); } longer = {.ops = torus_ops};
    sgt_hit expected = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray, NULL);
    assert_int_equal(expected.status, SGT_HIT);
    assert_int_equal(torus_ops.size, 0);
    const size_t whole[] = {0, offsetof(sgt_surface_ops, encloses), sizeof(sgt_surface_ops) - 1,
                            sizeof(sgt_surface_ops), sizeof longer};
    for (size_t i = 0; i < COUNT_OF(whole); i++) {
        longer.ops.size = whole[i];
        sgt_surface s = {&longer.ops, &shape};
        sgt_hit hit = sgt_intersect(s, ray, NULL);
        REQUIRE(hit.status == expected.status && same_bits(hit.t, expected.t), "size %zu: %s", whole[i],
                sgt_status_text(hit.status));
        assert_int_equal(sgt_check(s, 1, &ray, NULL), SGT_SOUND);
    }
    const size_t cut[] = {1, offsetof(sgt_surface_ops, span), offsetof(sgt_surface_ops, encloses) - 1};
    for (size_t i = 0; i < COUNT_OF(cut); i++) {
        longer.ops.size = cut[i];
        sgt_surface s = {&longer.ops, &shape};
        sgt_hit hit = sgt_intersect(s, ray, NULL), entry;
        REQUIRE(hit.status == SGT_INVALID && isnan(hit.t), "size %zu: %s", cut[i],
                sgt_status_text(hit.status));
        assert_int_equal(sgt_intersect_all(s, ray, 1, &entry, NULL), SGT_INVALID);
        sgt_status status = 9;
        sgt_rays rays = {.o = {&ray.o.x, &ray.o.y, &ray.o.z}, .d = {&ray.d.x, &ray.d.y, &ray.d.z}};
        assert_int_equal(sgt_intersect_batch(s, 1, rays, (sgt_hits){.status = &status}, NULL), 0);
        assert_int_equal(status, SGT_INVALID);
        assert_int_equal(sgt_check(s, 1, &ray, NULL), SGT_NO_VALUE);
        assert_int_equal(sgt_parameters(s), 0);
        sgt_change by_o[3];
        assert_int_equal(sgt_differentiate(s, &ray, &expected, by_o, NULL), SGT_LACKS_SECOND);
    }
}

typedef struct counter { int calls, stop_at, last; bool in_order; } counter;
static int count(void *data, const sgt_step *step)
{
    counter *c = data;
    c->calls++;
    c->in_order = c->in_order && step->eval == c->last + 1 && step->ray == 0;
    c->last = step->eval;
    return c->stop_at && c->calls >= c->stop_at;
}

static bool same_hit(const sgt_hit *a, const sgt_hit *b)
{
    return a->status == b->status && a->evals == b->evals && same_bits(a->t, b->t) &&
           same_bits(a->t_err, b->t_err) && same_bits(a->t_lo, b->t_lo) && same_bits(a->lo, b->lo) &&
           same_bits(a->hi, b->hi) && same_bits(a->f, b->f) && same_vector(a->p, b->p) &&
           same_vector(a->n, b->n) && same_bits(a->p_err, b->p_err);
}

static void test_watch(void **state)
{
    (void)state;
    generator g = seeded("watch");
    torus shape = {1, 0.4};
    sgt_conic conic = {.c = -1 / 2.2136};
    sgt_even_asphere asphere = {.c = 0.1, .k = -0.5, .a = {0, 1e-4, -2e-6}};
    const sgt_surface surfaces[] = {{&torus_ops, &shape},
                                    {&torus_value_only, &shape},
                                    {&forward, &conic},
                                    {&sgt_conic_ops, &conic},
                                    {&sgt_even_asphere_ops, &asphere}};
    long n = scaled(1000);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        for (size_t k = 0; k < COUNT_OF(surfaces); k++) {
            sgt_hit plain = sgt_intersect(surfaces[k], ray, NULL);
            counter c = {.in_order = true};
            sgt_hit watched = sgt_intersect(surfaces[k], ray,
                                            &(sgt_options){.watch = count, .watch_data = &c});
            REQUIRE(same_hit(&plain, &watched), "ray %ld, surface %zu: another path when watched", i, k);
            REQUIRE(c.calls == watched.evals && c.in_order,
                    "ray %ld, surface %zu: %d steps seen, %d evaluations", i, k, c.calls, watched.evals);
            if (watched.evals == 0) continue;
            int stop = 1 + below(&g, watched.evals);
            c = (counter){.stop_at = stop, .in_order = true};
            sgt_hit stopped = sgt_intersect(surfaces[k], ray,
                                            &(sgt_options){.watch = count, .watch_data = &c});
            REQUIRE(stopped.status == SGT_STOPPED && c.calls == stop,
                    "ray %ld, surface %zu: stopped at %d of %d: %s after %d", i, k, stop, watched.evals,
                    sgt_status_text(stopped.status), c.calls);
            REQUIRE(stopped.evals == stop, "ray %ld, surface %zu: stopped at %d, says %d", i, k, stop,
                    stopped.evals);
        }
    }
}

static void test_budget(void **state)
{
    (void)state;
    generator g = seeded("budget");
    torus shape = {1, 0.4};
    long n = scaled(300);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        sgt_hit plain = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray, NULL);
        for (int budget = 1; budget < plain.evals; budget += 1 + budget / 4) {
            sgt_hit hit = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray,
                                        &(sgt_options){.max_evals = budget});
            REQUIRE(hit.evals <= budget && hit.status == SGT_EXHAUSTED,
                    "ray %ld, %d of %d evaluations: %s after %d", i, budget, plain.evals,
                    sgt_status_text(hit.status), hit.evals);
        }
        sgt_hit hit = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray,
                                    &(sgt_options){.max_evals = plain.evals + 1});
        REQUIRE(hit.status == plain.status && same_bits(hit.t, plain.t), "ray %ld: enough is not enough", i);
    }
}

/* A looser tolerance: t_err is a bound all the same, and the work less. */
static void test_tolerance(void **state)
{
    (void)state;
    generator g = seeded("tolerance");
    torus shape = {1, 0.4};
    long n = scaled(500), full = 0, less = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        double tol = log_uniform(&g, 1e-14, 1e-2) / (double)wide_length(widen(ray.d));
        sgt_hit plain = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray, NULL),
                hit = sgt_intersect((sgt_surface){&torus_ops, &shape}, ray, &(sgt_options){.t_tol = tol});
        if (plain.status != SGT_HIT || hit.status != SGT_HIT) continue;
        full += plain.evals, less += hit.evals;
        long double l = torus_exact(&shape, &ray, hit.t - (long double)hit.t_err),
                    r = torus_exact(&shape, &ray, hit.t + (long double)hit.t_err);
        REQUIRE(l * r <= 0, "ray %ld, t_tol %g: no change of sign within %g", i, tol, hit.t_err);
        REQUIRE(hit.t_err <= 8 * tol + 4 * plain.t_err, "ray %ld, t_tol %g: t_err %g", i, tol, hit.t_err);
    }
    REQUIRE(less <= full, "%ld evaluations with a tolerance, %ld without", less, full);
}

/* The direction's length is a unit of t, no more. */
static void test_scale_of_direction(void **state)
{
    (void)state;
    generator g = seeded("scale of the direction");
    torus shape = {1, 0.4};
    sgt_conic conic = {.c = -0.4, .k = 0.3};
    const sgt_surface surfaces[] = {{&torus_ops, &shape}, {&torus_value_only, &shape}, {&forward, &conic}};
    static const int powers[] = {1, -1, 40, -40, 300, -300};
    long n = scaled(500);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        for (size_t k = 0; k < COUNT_OF(surfaces); k++) {
            sgt_hit plain = sgt_intersect(surfaces[k], ray, NULL);
            for (size_t j = 0; j < COUNT_OF(powers); j++) {
                sgt_ray other = ray;
                double by = ldexp(1, powers[j]);
                other.d = (sgt_vec3){by * ray.d.x, by * ray.d.y, by * ray.d.z};
                sgt_hit hit = sgt_intersect(surfaces[k], other, NULL);
                /* the torus's own span squares d: beyond 2^500 it would not be the same */
                REQUIRE(hit.status == plain.status &&
                            (plain.status <= 0 || (hit.t * by == plain.t && hit.t_err * by == plain.t_err)),
                        "ray %ld, surface %zu, d times 2^%d: %s at %.17g, was %s at %.17g", i, k, powers[j],
                        sgt_status_text(hit.status), hit.t * by, sgt_status_text(plain.status), plain.t);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_torus),           cmocka_unit_test(test_march_step),
        cmocka_unit_test(test_offers),          cmocka_unit_test(test_start_on_surface),
        cmocka_unit_test(test_conic_forwarded), cmocka_unit_test(test_undefined),
        cmocka_unit_test(test_lying_gradient),  cmocka_unit_test(test_poles),
        cmocka_unit_test(test_invalid),         cmocka_unit_test(test_size_of_table),
        cmocka_unit_test(test_watch),           cmocka_unit_test(test_budget),
        cmocka_unit_test(test_tolerance),       cmocka_unit_test(test_scale_of_direction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
