// SPDX-License-Identifier: MIT
/* What is no root, and what never ends: a user's surface with poles and jumps, one that answers at random,
 * and one whose enclosure decides little.  Poles and steep roots look alike to a search by signs; all ways
 * to a root are tried: the first and the one near the seed, single or not, with each thing that a surface
 * can offer, alone, all of them, and in a batch. */
#include "../ends.h"
#include "unit.h"

#include <sagitta/interval.h>

/* ------------------------------------------------- poles, jumps, steep roots */

/* F of w = z - a: */
typedef enum kind {
    POLE,
    POLE_3,
    POLE_WEAK,
    POLE_HIGH,
    POLE_STRONG,
    POLE_FALLING,
    POLE_EVEN,
    POLE_COT,
    POLE_WALLED, /* infinite but next to the pole */
    POLES,       /* no root where F changes sign */
    SIGN = POLES,
    FLOOR,
    JUMP_UP,
    JUMP_DOWN,
    JUMPS, /* F jumps over zero */
    CUBE_ROOT = JUMPS,
    ATAN,
    STEEP,
    STEEPER,
    RUNGE,
    LINE,
    KINDS /* a root */
} kind;
static const char *const names[KINDS] = {"1/w",
                                         "1/w^3",
                                         "w^(-1/3)",
                                         "1e20/w",
                                         "1e-20/w",
                                         "-1/w",
                                         "1/w^2",
                                         "cot w",
                                         "1/w up to 1e-14, infinite beyond",
                                         "sign w",
                                         "floor w + 1/2",
                                         "sign w (1 + |w|)",
                                         "sign w (6 - |w|)",
                                         "w^(1/3)",
                                         "atan 1e12 w",
                                         "1e200 w",
                                         "1e280 w, above 1e-300",
                                         "w / (w^2 + 1e-20)",
                                         "w"};

typedef enum lie { HONEST, REVERSED, ZERO, NO_NUMBER, STEEP_LIE, FLAT_LIE, LIES } lie;
typedef enum limit { NO_LIMIT, RELATIVE, WHOLE } limit; /* of rounding */

typedef struct shape {
    kind kind;
    lie lie;
    limit bound;
    double a, lo, hi, seed; /* lo, hi, seed: in z */
    bool single;
} shape;

static double of_w(kind k, double w, double *slope)
{
    double size = fabs(w), sign = w < 0 ? -1 : 1, c;
    switch (k) {
    case POLE: return *slope = -1 / (w * w), 1 / w;
    case POLE_3: return *slope = -3 / (w * w * w * w), 1 / (w * w * w);
    case POLE_WEAK: return *slope = -1 / (3 * size * cbrt(size)), 1 / cbrt(w);
    case POLE_HIGH: return *slope = -1e20 / (w * w), 1e20 / w;
    case POLE_STRONG: return *slope = -1e-20 / (w * w), 1e-20 / w;
    case POLE_FALLING: return *slope = 1 / (w * w), -1 / w;
    case POLE_EVEN: return *slope = -2 / (w * w * w), 1 / (w * w);
    case POLE_COT: return c = tan(0.25 * w), *slope = -0.25 * (1 + 1 / (c * c)), 1 / c;
    case POLE_WALLED:
        return *slope = -1 / (w * w), size <= 1e-14 ? 1 / w : sign * HUGE_VAL;
    case SIGN: return *slope = 0, sign;
    case FLOOR: return *slope = 0, floor(w) + 0.5;
    case JUMP_UP: return *slope = 1, sign * (1 + size);
    case JUMP_DOWN: return *slope = -1, sign * (6 - size);
    case CUBE_ROOT: return *slope = w == 0 ? NOT : 1 / (3 * cbrt(w * w)), cbrt(w);
    case ATAN: return *slope = 1e12 / (1 + 1e24 * w * w), atan(1e12 * w);
    case STEEP: return *slope = 1e200, 1e200 * w;
    case STEEPER: return *slope = 1e280, w < 0 ? 1e280 * w : w > 0 ? 1e-300 + 1e280 * w : 0;
    case RUNGE: c = w * w + 1e-20; return *slope = (1e-20 - w * w) / (c * c), w / c;
    default: return *slope = 1, w;
    }
}

static double value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    static const double by[LIES] = {1, -1, 0, NAN, 1e10, 1e-10};
    const shape *s = self;
    double slope, f = of_w(s->kind, p.z - s->a, &slope);
    if (grad) *grad = (sgt_vec3){0, 0, slope * by[s->lie]};
    return f;
}

static void values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = value(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static double rounding(const void *self, sgt_vec3 p)
{
    const shape *s = self;
    double slope, f = of_w(s->kind, p.z - s->a, &slope);
    return s->bound == WHOLE ? 0x1p-52 * (fabs(f) + fabs(p.z * slope)) : 0x1p-52 * fabs(f);
}

static sgt_span span(const void *self, const sgt_ray *ray)
{
    const shape *s = self;
    double lo = (s->lo - ray->o.z) / ray->d.z, hi = (s->hi - ray->o.z) / ray->d.z;
    return (sgt_span){
        .lo = fmin(lo, hi), .hi = fmax(lo, hi), .seed = (s->seed - ray->o.z) / ray->d.z, .single = s->single};
}

static double clearance(const void *self, sgt_vec3 p) { return 0.99 * fabs(p.z - ((const shape *)self)->a); }
static double guess(const void *self, sgt_vec3 p) { return 0.1 * fabs(p.z - ((const shape *)self)->a); }

/* Every kind is monotone on either side of w = 0, Runge's between its extremes, and all but the poles are
 * across it. */
static sgt_interval enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const shape *s = self;
    double a = ray->o.z + t.lo * ray->d.z - s->a, b = ray->o.z + t.hi * ray->d.z - s->a, lo = fmin(a, b),
           hi = fmax(a, b), unused;
    double room = 0x1p-50 * (fabs(ray->o.z) + fabs(s->a) + fabs(lo) + fabs(hi));
    *slope = sgt_interval_all();
    lo -= room, hi += room;
    if (s->kind == JUMP_DOWN && lo <= 0 && hi >= 0) return (sgt_interval){-6, 6};
    if (lo <= 0 && hi >= 0 && s->kind < POLES) return sgt_interval_all();
    double f = of_w(s->kind, lo, &unused), g = of_w(s->kind, hi, &unused),
           more = 0x1p-45 * fmax(fabs(f), fabs(g));
    if (!(more < HUGE_VAL)) return sgt_interval_all();
    bool least = s->kind == RUNGE && lo <= -1e-10 && hi >= -1e-10,
         most = s->kind == RUNGE && lo <= 1e-10 && hi >= 1e-10;
    return (sgt_interval){least ? -5.1e9 : fmin(f, g) - more, most ? 5.1e9 : fmax(f, g) + more};
}

enum { OFFERS = 8 };
static const sgt_surface_ops offers[OFFERS] = {
    {.name = "value", .value = value, .values = values},
    {.name = "rounding", .value = value, .values = values, .rounding = rounding},
    {.name = "span", .value = value, .values = values, .span = span},
    {.name = "span, rounding", .value = value, .values = values, .span = span, .rounding = rounding},
    {.name = "first", .value = value, .values = values, .span = span, .first = span},
    {.name = "clearance", .value = value, .values = values, .clearance = clearance},
    {.name = "estimate", .value = value, .values = values, .estimate = guess},
    {.name = "enclose", .value = value, .values = values, .span = span, .enclose = enclose},
};

/* The hit holds the place where w = 0. */
static bool is_there(const shape *s, const sgt_ray *ray, const sgt_hit *hit)
{
    /* 5: the local origin */
    long double t = ((long double)s->a - ray->o.z) / ray->d.z,
                slack = 4 * DBL_EPSILON *
                        (fabsl(t) + fabs(s->a / ray->d.z) + fabs(ray->o.z / ray->d.z) + 5 / fabs(ray->d.z));
    return fabsl(hit->t - t) <= hit->t_err + slack;
}

static void test_poles_and_jumps(void **state)
{
    (void)state;
    generator g = seeded("poles, jumps and steep roots");
    long n = scaled(20000), met[KINDS] = {0}, asked[KINDS] = {0};
    for (long i = 0; i < n; i++) {
        shape s = {.kind = (kind)below(&g, KINDS),
                   .lie = chance(&g, 0.5) ? HONEST : (lie)below(&g, LIES),
                   .bound = (limit)below(&g, 3),
                   .single = chance(&g, 0.5)};
        sgt_ray ray = {.o = {uniform(&g, -1, 1), 0, uniform(&g, -2, 2)},
                       .d = {0, chance(&g, 0.5) ? 0 : 0.3,
                             chance(&g, 0.5) ? 1 : either_sign(&g) * log_uniform(&g, 1e-3, 1e3)}};
        double length = fabs(ray.d.z);
        ray.d.y *= ray.d.z;
        ray.tmax = 5 / length;
        s.a = ray.o.z + ray.d.z * (uniform(&g, 0.05, 4.9) / length);
        if (chance(&g, 0.2)) s.a = nearbyint(64 * s.a) / 64; /* a point of the march may be the pole itself */
        double to = ray.o.z + ray.d.z * ray.tmax;
        s.lo = fmin(ray.o.z, to), s.hi = fmax(ray.o.z, to);
        s.seed = uniform(&g, s.lo, s.hi);
        if (chance(&g, 0.3)) s.seed = s.a * (1 + below(&g, 17) * 0x1p-52 - 0x1p-49);
        if (chance(&g, 0.1)) s.seed = NOT;
        /* a pole with such a slope is a root, as far as the quick form goes */
        if (fabs(s.seed - s.a) < 1e-6 && s.lie == REVERSED) s.lie = HONEST;
        /* nearer 0 the slope of w^(1/3) is infinite */
        if (!(s.a - s.lo > 0.02 && s.hi - s.a > 0.02 && fabs(s.a) > 0.01)) continue;
        sgt_options opt = {.pick = chance(&g, 0.5) ? SGT_NEAR_SEED : SGT_FIRST,
                           .t_tol = chance(&g, 0.6) ? 0 : log_uniform(&g, 1e-15, 1e-3) / length,
                           .dt_min = chance(&g, 0.7) ? 0 : log_uniform(&g, 1e-2, 1) / length};
        /* Within more than its walls it is as good as a jump. */
        if (s.kind == POLE_WALLED) opt.t_tol = 0, s.lie = HONEST;
        const sgt_surface_ops *ops = &offers[below(&g, OFFERS)];
        sgt_hit hit[8], h = sgt_intersect((sgt_surface){ops, &s}, ray, &opt);
        int count = sgt_intersect_all((sgt_surface){ops, &s}, ray, 8, hit, &opt);
        bool pole = s.kind < POLES;
#define WHERE "case %ld: %s, %s, slope %d, pick %d, t_tol %g, dt_min %g, single %d"
#define HERE i, names[s.kind], ops->name, s.lie, opt.pick, opt.t_tol, opt.dt_min, s.single
        REQUIRE(!pole || h.status <= 0, WHERE ": a pole is a %s, t %.17g +- %g, f %g", HERE,
                sgt_status_text(h.status), h.t, h.t_err, h.f);
        for (int j = 0; j < count && j < 8; j++) {
            REQUIRE(!pole || hit[j].status <= 0, WHERE ": of all, a pole is a %s, t %.17g +- %g, f %g", HERE,
                    sgt_status_text(hit[j].status), hit[j].t, hit[j].t_err, hit[j].f);
            REQUIRE(hit[j].status <= 0 || is_there(&s, &ray, &hit[j]) || s.kind == FLOOR,
                    WHERE ": t %.17g +- %g is no root", HERE, hit[j].t, hit[j].t_err);
        }
        REQUIRE(h.status <= 0 || is_there(&s, &ray, &h), WHERE ": t %.17g +- %g is no root", HERE, h.t,
                h.t_err);
        /* by rounding, as the slope tells it */
        bool hidden = s.lie == STEEP_LIE || (s.kind == RUNGE && s.lie != HONEST);
        /* cells at the local origin have no least size */
        hidden = hidden || (h.status == SGT_EXHAUSTED && ops->enclose);
        REQUIRE(pole || hidden || h.status > 0, WHERE ": %s, and F changes sign at z = %.17g", HERE,
                sgt_status_text(h.status), s.a);
        met[s.kind] += h.status > 0, asked[s.kind]++;
        enum { RAYS = 3 };
        double o[3][RAYS], d[3][RAYS], tmin[RAYS], tmax[RAYS], t[RAYS], t_err[RAYS];
        sgt_status status[RAYS];
        int evals[RAYS];
        for (int k = 0; k < RAYS; k++) {
            o[0][k] = ray.o.x + (k == 0), o[1][k] = ray.o.y, o[2][k] = ray.o.z;
            d[0][k] = ray.d.x, d[1][k] = ray.d.y, d[2][k] = ray.d.z, tmin[k] = ray.tmin,
            tmax[k] = end_of(&ray);
        }
        sgt_intersect_batch((sgt_surface){ops, &s}, RAYS,
                            (sgt_rays){{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, tmin, tmax},
                            (sgt_hits){.status = status, .evals = evals, .t = t, .t_err = t_err}, &opt);
        for (int k = 1; k < RAYS; k++)
            REQUIRE(status[k] == h.status && evals[k] == h.evals &&
                        (h.status <= 0 || (same_bits(t[k], h.t) && same_bits(t_err[k], h.t_err))),
                    WHERE ": %s after %d in a batch, %s after %d alone", HERE,
                    sgt_status_text((sgt_status)status[k]), evals[k], sgt_status_text(h.status), h.evals);
    }
    for (int k = 0; k < KINDS; k++) print_message("%s: %ld of %ld met\n", names[k], met[k], asked[k]);
}

/* --------------------------------------------------------- noise at a pole */

/* G = w + noise, w = z - a.  F is 1 / G, 1 / G^3, G or sign G (1 + |w| + noise).  The noise reaches
 * far beyond the neighbours of w = 0.  No bound on it is offered, or an honest one. */
typedef enum noisy_kind {
    NOISY_POLE,
    NOISY_POLE_3,
    NOISY_POLES,
    NOISY_ROOT = NOISY_POLES,
    NOISY_JUMP,
    NOISY_KINDS
} noisy_kind;
static const char *const noisy_names[NOISY_KINDS] = {"1/G", "1/G^3", "G", "sign G"};

typedef struct noisy {
    noisy_kind kind;
    double a, noise, lo, hi, seed, slope; /* slope: what that of F is told to be, times its own */
    bool steps, single;                   /* steps: G is a multiple of the noise */
} noisy;

/* In [-1, 1), of z alone. */
static double noise_at(double z)
{
    uint64_t bits;
    memcpy(&bits, &z, sizeof bits);
    generator g = {bits * 0x9e3779b97f4a7c15u};
    random_bits(&g);
    return uniform(&g, -1, 1);
}

static double noisy_G(const noisy *s, double z)
{
    double G = z - s->a + s->noise * noise_at(z);
    return s->steps ? s->noise * nearbyint(G / s->noise) : G;
}

static double noisy_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const noisy *s = self;
    double w = p.z - s->a, n = s->noise * noise_at(p.z), G = noisy_G(s, p.z), slope = 1, f = G;
    if (s->kind == NOISY_POLE) slope = -1 / (G * G), f = 1 / G;
    if (s->kind == NOISY_POLE_3) slope = -3 / (G * G * G * G), f = 1 / (G * G * G);
    if (s->kind == NOISY_JUMP) f = copysign(1 + fabs(w) + n, G);
    if (grad) *grad = (sgt_vec3){0, 0, slope * s->slope};
    return f;
}

static double noisy_rounding(const void *self, sgt_vec3 p)
{
    const noisy *s = self;
    double G = fabs(noisy_G(s, p.z)), off = 2 * s->noise, least = G - off, bound = off;
    if (s->kind == NOISY_ROOT) return off;
    if (s->kind == NOISY_POLE) bound = 1 / least - 1 / G;
    if (s->kind == NOISY_POLE_3) bound = 1 / (least * least * least) - 1 / (G * G * G);
    if (s->kind == NOISY_JUMP && !(least > 0)) return 3 * (1 + fabs(p.z - s->a)); /* of either sign */
    return least > 0 ? bound : FAR;
}

static sgt_span noisy_span(const void *self, const sgt_ray *ray)
{
    const noisy *s = self;
    return (sgt_span){s->lo - ray->o.z, s->hi - ray->o.z, s->seed - ray->o.z, s->single};
}

/* In noise nothing is certain: a few may be told by chance.  Not asked is what the quick form may take for a
 * root from a seed inside the noise (ray/walk.c). */
static void test_noisy_poles(void **state)
{
    (void)state;
    static const double slopes[] = {1, 1, 1, 0, NAN, -1, 1e10, 1e-10};
    static const sgt_surface_ops ops[] = {{.name = "value", .value = noisy_value},
                                          {.name = "span", .value = noisy_value, .span = noisy_span},
                                          {.name = "rounding", .value = noisy_value, .span = noisy_span,
                                           .rounding = noisy_rounding}};
    generator g = seeded("noise at poles, roots and jumps");
    long n = scaled(20000), met[NOISY_KINDS] = {0}, asked[NOISY_KINDS] = {0};
    for (long i = 0; i < n; i++) {
        sgt_ray ray = {.o = {0, 0, uniform(&g, -2, 2)}, .d = {0, 0, 1}, .tmax = 5};
        noisy s = {.kind = (noisy_kind)below(&g, NOISY_KINDS),
                   .a = ray.o.z + uniform(&g, 0.1, 4.9),
                   .noise = log_uniform(&g, 1e-16, 1e-6),
                   .lo = ray.o.z,
                   .hi = ray.o.z + 5,
                   .slope = slopes[below(&g, 8)],
                   .steps = chance(&g, 0.5),
                   .single = chance(&g, 0.5)};
        s.seed = chance(&g, 0.4) ? s.a : chance(&g, 0.3) ? NOT : uniform(&g, s.lo, s.hi);
        if (chance(&g, 0.2)) s.seed = s.a + s.noise * uniform(&g, -2, 2);
        sgt_options opt = {.pick = chance(&g, 0.5) ? SGT_NEAR_SEED : SGT_FIRST,
                           .t_tol = chance(&g, 0.6) ? 0 : log_uniform(&g, 1e-15, 1e-3),
                           .dt_min = chance(&g, 0.7) ? 0 : log_uniform(&g, 1e-2, 1)};
        bool newton = s.slope != 0 && !isnan(s.slope),
             quick = newton && !(s.kind == NOISY_POLE && s.slope == 1 && opt.t_tol == 0);
        if (s.kind < NOISY_POLES && quick && fabs(s.seed - s.a) <= 2 * s.noise + 1e-14) continue;
        sgt_surface surface = {&ops[below(&g, 3)], &s};
        sgt_hit hit[9];
        hit[8] = sgt_intersect(surface, ray, &opt);
        int count = sgt_intersect_all(surface, ray, 8, hit, &opt);
        bool first = hit[8].status > 0, any = false;
        double slack = 1e-14 * (s.slope > 1 ? s.slope : 1); /* rounding, as the slope tells it */
        for (int j = 0; j < 9; j++) {
            if ((j >= count && j < 8) || hit[j].status <= 0) continue;
            any = any || j < 8;
            REQUIRE(fabs(hit[j].t + ray.o.z - s.a) <= hit[j].t_err + 4 * s.noise + slack,
                    "case %ld: %s, noise %g, slope %g: t is off by %g, t_err %g", i, noisy_names[s.kind],
                    s.noise, s.slope, hit[j].t + ray.o.z - s.a, hit[j].t_err);
        }
        met[s.kind] += first + any, asked[s.kind] += 2;
    }
    for (int k = 0; k < NOISY_KINDS; k++) {
        print_message("%s: %ld of %ld met\n", noisy_names[k], met[k], asked[k]);
        if (k < NOISY_POLES)
            REQUIRE(met[k] <= 2 + asked[k] / 5000, "%s: %ld of %ld poles are told as roots", noisy_names[k],
                    met[k], asked[k]);
        else
            REQUIRE(met[k] >= asked[k] - 4 - asked[k] / 200, "%s: only %ld of %ld are met", noisy_names[k],
                    met[k], asked[k]);
    }
}

/* A root that is not the pole beside it. */
static double beside_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double a = *(const double *)self, w = p.z - 1;
    if (grad) *grad = (sgt_vec3){0, 0, -1 / (w * w)};
    return 1 / a + 1 / w; /* zero at w = -a */
}

static void test_root_beside_pole(void **state)
{
    (void)state;
    generator g = seeded("a root beside a pole");
    long n = scaled(3000), met = 0;
    for (long i = 0; i < n; i++) {
        double a = either_sign(&g) * log_uniform(&g, 1e-10, 0.5);
        sgt_surface s = {&(sgt_surface_ops){.name = "beside", .value = beside_value}, &a};
        sgt_ray ray = {.o = {0, 0, 0}, .d = {0, 0, 1}, .tmax = uniform(&g, 2, 5)};
        sgt_hit hit[4];
        int count = sgt_intersect_all(s, ray, 4, hit, NULL);
        for (int j = 0; j < count && j < 4; j++) {
            if (hit[j].status <= 0) continue;
            REQUIRE(fabs(hit[j].t - (1 - a)) <= hit[j].t_err + 4e-16,
                    "case %ld: the root is %.17g, told %.17g +- %g", i, 1 - a, hit[j].t, hit[j].t_err);
            met++;
        }
    }
    REQUIRE(met > n / 20, "only %ld roots were met", met);
    print_message("%ld met\n", met);
}

/* ------------------------------------------------------- answers at random */

/* Each answer is drawn; now and then one is honest, so that a search goes on. */
typedef struct gambler { generator g; double part; long calls; } gambler;

static double any_number(generator *g)
{
    switch (below(g, 12)) {
    case 0: return NOT;
    case 1: return either_sign(g) * FAR;
    case 2: return 0;
    case 3: return either_sign(g) * DBL_MAX;
    case 4: return either_sign(g) * DBL_TRUE_MIN;
    case 5: case 6: return either_sign(g) * log_uniform(g, 1e-300, 1e300);
    default: return uniform(g, -1, 1);
    }
}

static generator *drawing(const void *self)
{
    gambler *s = *(gambler *const *)self;
    s->calls++;
    return &s->g;
}
static bool honest(const void *self) { return chance(drawing(self), (*(gambler *const *)self)->part); }

static double gamble_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    generator *g = drawing(self);
    if (grad)
        *grad = honest(self) ? (sgt_vec3){0, 0, 1} : (sgt_vec3){any_number(g), any_number(g), any_number(g)};
    return honest(self) ? p.z : any_number(g);
}
static double gamble_number(const void *self, sgt_vec3 p)
{
    return (void)p, honest(self) ? 0 : any_number(drawing(self));
}
static sgt_span gamble_span(const void *self, const sgt_ray *ray)
{
    generator *g = drawing(self);
    if (honest(self)) return (sgt_span){.lo = -10, .hi = 10, .seed = -ray->o.z / ray->d.z};
    return (sgt_span){any_number(g), any_number(g), any_number(g), chance(g, 0.5)};
}
static sgt_interval gamble_interval(generator *g)
{
    double a = any_number(g), b = any_number(g);
    return chance(g, 0.9) && a > b ? (sgt_interval){b, a} : (sgt_interval){a, b};
}
static sgt_interval gamble_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    generator *g = drawing(self);
    *slope = honest(self) ? sgt_interval_of(ray->d.z) : gamble_interval(g);
    return honest(self) ? (sgt_interval){ray->o.z + t.lo * ray->d.z - 1e-9, ray->o.z + t.hi * ray->d.z + 1e-9}
                        : gamble_interval(g);
}

/* Every loop of the library has a budget, and all together one: 1024 max_evals, and what confirms the last
 * root. */
static void test_random_answers(void **state)
{
    (void)state;
    generator g = seeded("answers at random");
    long n = scaled(400), most = 0, spent[8] = {0};
    for (long i = 0; i < n; i++) {
        gambler s = {{random_bits(&g)}, chance(&g, 0.5) ? 0 : uniform(&g, 0, 1), 0}, *self = &s;
        sgt_surface_ops ops = {.name = "gambler", .value = gamble_value};
        if (chance(&g, 0.5)) ops.span = gamble_span;
        if (chance(&g, 0.3)) ops.rounding = gamble_number;
        if (chance(&g, 0.3)) ops.clearance = gamble_number;
        if (chance(&g, 0.3)) ops.estimate = gamble_number;
        if (chance(&g, 0.6)) ops.enclose = gamble_enclose;
        if (chance(&g, 0.2)) ops.first = gamble_span;
        const int budgets[] = {1, 7, 50, 300};
        sgt_options opt = {.max_evals = budgets[below(&g, 4)],
                           .pick = chance(&g, 0.5) ? SGT_FIRST : SGT_NEAR_SEED,
                           .proof = (sgt_proof)below(&g, 3),
                           .dt_min = chance(&g, 0.3) ? log_uniform(&g, 1e-12, 1) : 0,
                           .t_tol = chance(&g, 0.3) ? log_uniform(&g, 1e-15, 1) : 0};
        sgt_ray ray = {.o = {0, 0, uniform(&g, -3, 3)},
                       .d = {uniform(&g, -1, 1), 0, 1},
                       .tmin = chance(&g, 0.2) ? -FAR : 0,
                       .tmax = chance(&g, 0.3) ? FAR : uniform(&g, 1, 10)};
        sgt_hit hit[4], h = sgt_intersect((sgt_surface){&ops, &self}, ray, &opt);
        /* an evaluation is told once, with at most five calls; what is found is confirmed */
        REQUIRE(h.evals <= opt.max_evals + 32, "case %ld: %d evaluations of %d for one root", i, h.evals,
                opt.max_evals);
        REQUIRE(opt.proof == SGT_ESTIMATE || h.status != SGT_EXHAUSTED, "case %ld: exhausted under a proof",
                i);
        spent[h.status - SGT_INVALID]++;
        s.calls = 0;
        int count = sgt_intersect_all((sgt_surface){&ops, &self}, ray, 4, hit, &opt);
        long bound = 1024L * opt.max_evals + 64;
        REQUIRE(s.calls <= 8 * bound, "case %ld: %ld calls for all roots, max_evals %d", i, s.calls,
                opt.max_evals);
        REQUIRE(count >= 0, "case %ld: %d roots", i, count);
        for (int j = 0; j < count && j < 4; j++)
            REQUIRE(opt.proof == SGT_ESTIMATE || hit[j].status != SGT_EXHAUSTED,
                    "case %ld: exhausted under a proof", i);
        if (s.calls > most) most = s.calls;
    }
    for (int k = 7; k >= 0; k--)
        if (spent[k]) print_message("%s %ld  ", sgt_status_text((sgt_status)(k + SGT_INVALID)), spent[k]);
    print_message("\nat most %ld calls for all roots\n", most);
}

/* ------------------------------------------------- enclosures that decide little */

/* z = a; `value` may be off by `off`, the enclosure by `wide`. */
typedef struct vague { double a, off, wide; } vague;

static double vague_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    if (grad) *grad = (sgt_vec3){0, 0, 1};
    return p.z - ((const vague *)self)->a;
}
static double vague_rounding(const void *self, sgt_vec3 p) { return (void)p, ((const vague *)self)->off; }
static sgt_interval vague_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const vague *s = self;
    sgt_interval z = sgt_interval_sum(sgt_interval_of(ray->o.z),
                                      sgt_interval_product(t, sgt_interval_of(ray->d.z)));
    *slope = sgt_interval_of(ray->d.z);
    return sgt_interval_sum(sgt_interval_difference(z, sgt_interval_of(s->a)),
                            sgt_interval_between(-s->wide, s->wide));
}

/* What cannot be decided is told, wherever it lies: in a monotone cell, over the whole ray, at its end. */
static void test_undecided(void **state)
{
    (void)state;
    generator g = seeded("enclosures that decide little");
    const sgt_surface_ops ops = {
        .name = "vague", .value = vague_value, .rounding = vague_rounding, .enclose = vague_enclose};
    long n = scaled(20000), of[3] = {0}, at_end = 0;
    for (long i = 0; i < n; i++) {
        vague s = {.a = uniform(&g, -1, 1),
                   .off = chance(&g, 0.2) ? 0 : log_uniform(&g, 1e-12, 10),
                   .wide = chance(&g, 0.5) ? 0 : log_uniform(&g, 1e-12, 10)};
        double size = fmax(fmax(s.off, s.wide), 1e-9),
               before = chance(&g, 0.5) ? uniform(&g, 0.1, 3) : size * log_uniform(&g, 1e-2, 10),
               behind = chance(&g, 0.5) ? uniform(&g, 0.1, 3) : size * log_uniform(&g, 1e-2, 10);
        sgt_ray ray = {
            .o = {0, 0, s.a - before}, .d = {uniform(&g, -1, 1), 0, 1}, .tmin = 0, .tmax = before + behind};
        sgt_surface surface = {&ops, &s};
        if (before < 8 * (s.off + s.wide) + 1e-6) continue; /* by the rule of the start it may not count */
        for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++)
            for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                sgt_options opt = {.pick = (sgt_pick)pick, .proof = (sgt_proof)proof};
                sgt_hit hit[4], h = sgt_intersect(surface, ray, &opt);
                int count = sgt_intersect_all(surface, ray, 4, hit, &opt);
                REQUIRE(h.status != SGT_MISS && count > 0,
                        "case %ld, pick %d, proof %d: a miss, %d of all; rounding %g, enclosure +- %g, the "
                        "root at %g of [%g, %g]",
                        i, pick, proof, count, s.off, s.wide, before, ray.tmin, ray.tmax);
                of[h.status < 0 ? 0 : h.status == SGT_HIT ? 1 : 2]++;
                for (int j = 0; j < count && j < 4; j++)
                    REQUIRE(!(hit[j].status > 0) || (hit[j].lo <= hit[j].t - hit[j].t_err &&
                                                     hit[j].hi >= hit[j].t + hit[j].t_err),
                            "case %ld, pick %d, proof %d: %.17g +- %g is not all in [%.17g, %.17g]", i, pick,
                            proof, hit[j].t, hit[j].t_err, hit[j].lo, hit[j].hi);
                at_end += count == 1 && hit[0].status < 0 && hit[0].hi == ray.tmax && hit[0].lo > ray.tmin;
            }
    }
    print_message("undecided %ld, hits %ld, grazes %ld; at the end %ld\n", of[0], of[1], of[2], at_end);
    REQUIRE(of[0] > n / 100 && of[1] > n / 10 && at_end > n / 100, "these rays are no test");
}

/* The ball |p - c| < r, told with its rounding and by intervals, in a span; many roots are possible, as far
 * as the solver knows. */
typedef struct ball { sgt_vec3 c; double r; } ball;

static double ball_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const ball *s = self;
    double x = p.x - s->c.x, y = p.y - s->c.y, z = p.z - s->c.z;
    if (grad) *grad = (sgt_vec3){2 * x, 2 * y, 2 * z};
    return x * x + y * y + z * z - s->r * s->r;
}
static double ball_rounding(const void *self, sgt_vec3 p)
{
    const ball *s = self;
    double x = fabs(p.x) + fabs(s->c.x), y = fabs(p.y) + fabs(s->c.y), z = fabs(p.z) + fabs(s->c.z);
    return 0x1p-50 * (x * x + y * y + z * z + s->r * s->r);
}
static sgt_span ball_span(const void *self, const sgt_ray *ray)
{
    const ball *s = self;
    double x = s->c.x - ray->o.x, y = s->c.y - ray->o.y, z = s->c.z - ray->o.z,
           d2 = ray->d.x * ray->d.x + ray->d.y * ray->d.y + ray->d.z * ray->d.z;
    double middle = (x * ray->d.x + y * ray->d.y + z * ray->d.z) / d2, half = 1.01 * s->r / sqrt(d2);
    return (sgt_span){.lo = middle - half, .hi = middle + half, .seed = NOT};
}
static sgt_interval ball_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const ball *s = self;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z},
                 c[3] = {s->c.x, s->c.y, s->c.z};
    sgt_interval g = sgt_interval_scaled(sgt_interval_square(sgt_interval_of(s->r)), -1),
                 by = sgt_interval_of(0);
    for (int k = 0; k < 3; k++) {
        sgt_interval x = sgt_interval_difference(
            sgt_interval_sum(sgt_interval_of(o[k]), sgt_interval_product(t, sgt_interval_of(d[k]))),
            sgt_interval_of(c[k]));
        g = sgt_interval_sum(g, sgt_interval_square(x)),
        by = sgt_interval_sum(by, sgt_interval_product(x, sgt_interval_of(2 * d[k])));
    }
    *slope = by;
    return g;
}

/* From the surface outward nothing is met, inward the other side: decided, though the sign of F at the
 * start is not. */
static void test_from_surface(void **state)
{
    (void)state;
    generator g = seeded("from the surface, by intervals");
    const sgt_surface_ops ops = {.name = "ball",
                                 .value = ball_value,
                                 .rounding = ball_rounding,
                                 .span = ball_span,
                                 .enclose = ball_enclose};
    long n = scaled(10000), outward = 0, unknown = 0;
    for (long i = 0; i < n; i++) {
        ball s = {.c = random_point(&g, 2), .r = log_uniform(&g, 0.1, 10)};
        sgt_surface surface = {&ops, &s};
        sgt_vec3 u = random_direction(&g), d = random_direction(&g);
        double along = u.x * d.x + u.y * d.y + u.z * d.z,
               beside = chance(&g, 0.3) ? 0 : uniform(&g, -2, 2) * 0x1p-52;
        if (fabs(along) < 0.05) continue;
        sgt_ray ray = {.o = {s.c.x + s.r * (1 + beside) * u.x, s.c.y + s.r * (1 + beside) * u.y,
                             s.c.z + s.r * (1 + beside) * u.z},
                       .d = d};
        double f = ball_value(&s, ray.o, NULL);
        unknown += fabs(f) <= ball_rounding(&s, ray.o), outward += along > 0;
        /* Beside the surface by more than the rule of the start the root there may count. */
        double spread = 2 * s.r * (fabs(ray.o.x * u.x) + fabs(ray.o.y * u.y) + fabs(ray.o.z * u.z));
        if (fabs(f) > 0x1p-49 * spread) continue;
        for (int all = 0; all < 2; all++) {
            sgt_hit hit[4];
            int count = 1;
            if (all) count = sgt_intersect_all(surface, ray, 4, hit, NULL);
            else hit[0] = sgt_intersect(surface, ray, NULL), count = hit[0].status != SGT_MISS;
            if (along > 0)
                REQUIRE(count == 0, "case %ld, %s: outward, and %s at %.17g +- %g, r %g", i,
                        all ? "all" : "the first", sgt_status_text(hit[0].status), hit[0].t, hit[0].t_err,
                        s.r);
            else
                REQUIRE(count == 1 && hit[0].status == SGT_HIT &&
                            fabs(hit[0].t + 2 * s.r * along) < 1e-12 * (s.r + 4),
                        "case %ld, %s: inward, and %d entries; %s at %.17g, not %.17g", i,
                        all ? "all" : "the first", count, count ? sgt_status_text(hit[0].status) : "a miss",
                        hit[0].t, -2 * s.r * along);
        }
    }
    print_message("%ld of %ld outward, of %ld the start's sign is not known\n", outward, n, unknown);
    REQUIRE(outward > n / 4 && unknown > n / 4, "these rays are no test");
}

/* The ball from afar, and tmin next to its first root: within 4096 ulps of t either root is the first, else
 * the one that is on the ray, and it is found. */
static void test_start_beside_root(void **state)
{
    (void)state;
    generator g = seeded("a start beside a root, from afar");
    const sgt_surface_ops ops = {.name = "ball",
                                 .value = ball_value,
                                 .rounding = ball_rounding,
                                 .span = ball_span,
                                 .enclose = ball_enclose};
    long n = scaled(10000), undecided = 0, near = 0;
    for (long i = 0; i < n; i++) {
        ball s = {.c = random_point(&g, 2), .r = log_uniform(&g, 0.1, 10)};
        sgt_vec3 u = random_direction(&g), d = random_direction(&g);
        double along = u.x * d.x + u.y * d.y + u.z * d.z, far = s.r * log_uniform(&g, 1, 1e6);
        if (along > 0) along = -along, u = (sgt_vec3){-u.x, -u.y, -u.z};
        if (along > -0.2) continue;
        sgt_ray ray = {.o = {s.c.x + s.r * u.x - far * d.x, s.c.y + s.r * u.y - far * d.y,
                             s.c.z + s.r * u.z - far * d.z},
                       .d = d,
                       .tmax = HUGE_VAL};
        long double x = (long double)ray.o.x - s.c.x, y = (long double)ray.o.y - s.c.y,
                    z = (long double)ray.o.z - s.c.z,
                    d2 = (long double)d.x * d.x + (long double)d.y * d.y + (long double)d.z * d.z,
                    b = (x * d.x + y * d.y + z * d.z) / d2, px = x - b * d.x, py = y - b * d.y,
                    pz = z - b * d.z,
                    half = sqrtl(((long double)s.r * s.r - px * px - py * py - pz * pz) / d2),
                    root[2] = {-b - half, -b + half};
        double ulp = 0x1p-52 * (far + 8 * s.r + 4), by = either_sign(&g) * log_uniform(&g, 0.1, 1e6) * ulp;
        ray.tmin = (double)root[0] + by;
        sgt_hit hit = sgt_intersect((sgt_surface){&ops, &s}, ray, NULL);
        undecided += hit.status <= 0, near++;
        if (hit.status <= 0) continue;
        bool first = fabsl(hit.t - root[0]) < fabsl(hit.t - root[1]);
        REQUIRE(fabsl(hit.t - root[first ? 0 : 1]) <= hit.t_err + 64 * (long double)ulp,
                "case %ld: t %.17g +- %g is no root", i, hit.t, hit.t_err);
        REQUIRE(fabs(by) < 4096 * ulp || first == (by < 0),
                "case %ld: tmin is %g ulps behind the root, and the %s one is met", i, by / ulp,
                first ? "first" : "second");
    }
    print_message("%ld of %ld undecided\n", undecided, near);
    REQUIRE(undecided * 1000 <= near, "%ld of %ld are undecided", undecided, near);
}

/* --------------------------------------------------------- which searches ask `encloses` */

/* Of a ball that is met from outside, near its middle: the half of the chord in front has one root.  asked:
 * how many cells. */
typedef struct told_ball {
    ball ball;
    bool single;
    long *asked;
} told_ball;

static sgt_span told_span(const void *self, const sgt_ray *ray)
{
    sgt_span span = ball_span(self, ray);
    const told_ball *s = self;
    if (s->single) span.hi = 0.5 * (span.lo + span.hi), span.single = true;
    return span;
}
static void told_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                          sgt_enclosures out)
{
    const told_ball *s = self;
    *s->asked += (long)n;
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                       .d = {rays.d[0][i], rays.d[1][i], rays.d[2][i]}};
        sgt_interval slope, g;
        REQUIRE(t_lo[i] <= t_hi[i] && fabs(t_lo[i]) < HUGE_VAL && fabs(t_hi[i]) < HUGE_VAL, "the cell %g, %g",
                t_lo[i], t_hi[i]);
        g = ball_enclose(self, &ray, (sgt_interval){t_lo[i], t_hi[i]}, &slope);
        out.lo[i] = g.lo, out.hi[i] = g.hi;
        if (out.slope_lo) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
}

/* It is asked for first roots, but not where the surface has `first`, nor of single spans without a proof;
 * the root is the same, with no more evaluations than a single root takes. */
static void test_asked(void **state)
{
    (void)state;
    generator g = seeded("who asks encloses");
    for (long i = 0; i < 2000; i++) {
        long asked = 0;
        told_ball s = {{random_point(&g, 2), log_uniform(&g, 0.1, 10)}, chance(&g, 0.5), &asked};
        const bool first = chance(&g, 0.3), proof = chance(&g, 0.3), many = chance(&g, 0.5);
        const sgt_surface_ops ops = {.size = sizeof ops,
                                     .name = "told ball",
                                     .value = ball_value,
                                     .rounding = ball_rounding,
                                     .span = told_span,
                                     .enclose = ball_enclose,
                                     .encloses = told_encloses,
                                     .first = first ? told_span : NULL};
        sgt_vec3 d = random_direction(&g), b = random_point(&g, 0.3);
        sgt_ray ray = {.o = {s.ball.c.x + s.ball.r * (b.x - 3 * d.x), s.ball.c.y + s.ball.r * (b.y - 3 * d.y),
                             s.ball.c.z + s.ball.r * (b.z - 3 * d.z)},
                       .d = d,
                       .tmax = HUGE_VAL};
        const bool quick = s.single && !proof;
        sgt_options opt = {
            .pick = SGT_FIRST, .proof = proof ? SGT_PROVE_FIRST : SGT_ESTIMATE, .max_evals = quick ? 16 : 0};
        double t;
        sgt_status status;
        if (many) {
            sgt_rays rays = {
                {&ray.o.x, &ray.o.y, &ray.o.z}, {&ray.d.x, &ray.d.y, &ray.d.z}, &ray.tmin, &ray.tmax};
            sgt_intersect_batch((sgt_surface){&ops, &s}, 1, rays, (sgt_hits){.status = &status, .t = &t},
                                &opt);
        } else {
            sgt_hit hit = sgt_intersect((sgt_surface){&ops, &s}, ray, &opt);
            status = hit.status, t = hit.t;
        }
        REQUIRE((asked > 0) == !(first || quick), "case %ld: %ld cells; first %d, single %d, proof %d", i,
                asked, first, s.single, proof);
        double f = ball_value(&s, (sgt_vec3){ray.o.x + t * d.x, ray.o.y + t * d.y, ray.o.z + t * d.z}, NULL);
        REQUIRE(status == SGT_HIT && fabs(f) < 1e-12 * (1 + s.ball.r) * (1 + s.ball.r) && t < 3.3 * s.ball.r,
                "case %ld: %s at %g, F %g", i, sgt_status_text((sgt_status)status), t, f);
    }
}

/* ------------------------------------------------- a touch that rounding is to tell */

/* F = w^2, w = z - a.  Its rounding is told to be `wide`^2 within |w| < `wide`, and hardly anything beyond.
 */
typedef struct touch {
    double a, wide;
} touch;

static double touch_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double w = p.z - ((const touch *)self)->a;
    if (grad) *grad = (sgt_vec3){0, 0, 2 * w};
    return w * w;
}
static double touch_rounding(const void *self, sgt_vec3 p)
{
    const touch *s = self;
    return fabs(p.z - s->a) < s->wide ? s->wide * s->wide : 1e-40;
}
static sgt_span touch_span(const void *self, const sgt_ray *ray)
{
    double at = (((const touch *)self)->a - ray->o.z) / ray->d.z, half = 1 / fabs(ray->d.z);
    return (sgt_span){.lo = at - half, .hi = at + half, .seed = NOT};
}
static sgt_interval touch_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const touch *s = self;
    sgt_interval d = sgt_interval_of(ray->d.z),
                 w = sgt_interval_sum(sgt_interval_of(ray->o.z - s->a), sgt_interval_product(t, d)),
                 g = sgt_interval_square(w);
    *slope = sgt_interval_scaled(sgt_interval_product(w, d), 2);
    if (w.lo < s->wide && w.hi > -s->wide) g.lo -= s->wide * s->wide;
    return g;
}

/* It is told as a graze, although F is certain where the stretch begins in which it is not.  (A few stretches
 * are wider than what is told as rounding: unproven.) */
static void test_touch(void **state)
{
    (void)state;
    generator g = seeded("touches");
    const sgt_surface_ops ops = {.name = "touch",
                                 .value = touch_value,
                                 .rounding = touch_rounding,
                                 .span = touch_span,
                                 .enclose = touch_enclose};
    long n = 2000, grazes = 0;
    for (long i = 0; i < n; i++) {
        touch s = {uniform(&g, -1, 1), log_uniform(&g, 1e-6, 1e-2)};
        sgt_ray ray = {.o = {0, 0, -3}, .d = {0, 0, log_uniform(&g, 0.1, 10)}, .tmax = HUGE_VAL};
        sgt_hit hit = sgt_intersect((sgt_surface){&ops, &s}, ray, &(sgt_options){.pick = SGT_FIRST});
        REQUIRE(hit.status == SGT_GRAZE || hit.status == SGT_UNPROVEN, "case %ld: %s", i,
                sgt_status_text(hit.status));
        grazes += hit.status == SGT_GRAZE;
    }
    print_message("%ld of %ld are grazes\n", grazes, n);
    REQUIRE(grazes * 10 >= n * 9, "%ld of %ld are grazes", grazes, n);
}

/* -------------------------------------------- cells whose enclosures are at their limits */

/* `value` is F + by, the enclosure [F, F + 2 w] or [F - 2 w, F]: so the root is as far from that of `value`
 * as the enclosures allow, and the slope all over the way there has a say in the bound. */
typedef struct edge_ball {
    ball ball;
    double w, by;
} edge_ball;

static double edge_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return ball_value(self, p, grad) + ((const edge_ball *)self)->by;
}
static double edge_rounding(const void *self, sgt_vec3 p)
{
    return fabs(((const edge_ball *)self)->by) + ball_rounding(self, p);
}
static sgt_interval edge_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const edge_ball *s = self;
    sgt_interval g = ball_enclose(self, ray, t, slope);
    return sgt_interval_sum(g, s->by < 0 ? (sgt_interval){-2 * s->w, 0} : (sgt_interval){0, 2 * s->w});
}
static void edge_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                          sgt_enclosures out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                       .d = {rays.d[0][i], rays.d[1][i], rays.d[2][i]}};
        sgt_interval slope, g = edge_enclose(self, &ray, (sgt_interval){t_lo[i], t_hi[i]}, &slope);
        out.lo[i] = g.lo, out.hi[i] = g.hi;
        if (out.slope_lo) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
}

/* The root is within t_err, and t_err is what the enclosures leave, whatever t_tol allows. */
static void test_enclosures_at_their_limits(void **state)
{
    (void)state;
    generator g = seeded("enclosures at their limits");
    const sgt_surface_ops ops = {.size = sizeof ops,
                                 .name = "edge ball",
                                 .value = edge_value,
                                 .rounding = edge_rounding,
                                 .span = ball_span,
                                 .enclose = edge_enclose,
                                 .encloses = edge_encloses};
    double worst = 0, widest = 0;
    long n = scaled(5000), loose = 0;
    for (long i = 0; i < n; i++) {
        edge_ball s = {.ball = {random_point(&g, 2), log_uniform(&g, 0.1, 10)}};
        double r = s.ball.r;
        s.w = r * r * log_uniform(&g, 1e-12, 3e-3), s.by = either_sign(&g) * 2 * s.w;
        sgt_vec3 d = random_direction(&g), b = random_point(&g, 0.4);
        sgt_ray ray = {.o = {s.ball.c.x + r * (b.x - 3 * d.x), s.ball.c.y + r * (b.y - 3 * d.y),
                             s.ball.c.z + r * (b.z - 3 * d.z)},
                       .d = d,
                       .tmax = HUGE_VAL};
        sgt_hit hit = sgt_intersect((sgt_surface){&ops, &s}, ray, &(sgt_options){.t_tol = 0.1 * r});
        long double x = (long double)ray.o.x - s.ball.c.x, y = (long double)ray.o.y - s.ball.c.y,
                    z = (long double)ray.o.z - s.ball.c.z,
                    d2 = (long double)d.x * d.x + (long double)d.y * d.y + (long double)d.z * d.z,
                    m = (x * d.x + y * d.y + z * d.z) / d2, px = x - m * d.x, py = y - m * d.y,
                    pz = z - m * d.z, half = sqrtl(((long double)r * r - px * px - py * py - pz * pz) / d2),
                    t = -m - half;
        REQUIRE(hit.status == SGT_HIT, "case %ld: %s", i, sgt_status_text(hit.status));
        REQUIRE(fabsl(hit.t - t) <= hit.t_err, "case %ld: w %g, t is off by %Lg, more than %.17g", i, s.w,
                fabsl(hit.t - t), hit.t_err);
        double left = 2 * s.w / (double)(2 * half) + 1e-15 * (r + 8);
        worst = fmax(worst, (double)fabsl(hit.t - t) / hit.t_err), widest = fmax(widest, hit.t_err / left);
        loose += s.w < 1e-5 * r * r && hit.t_err > 4 * left;
    }
    print_message("worst %.6f of t_err, which is up to %.3g of what the enclosures leave; %ld looser\n",
                  worst, widest, loose);
    REQUIRE(loose * 1000 <= n, "%ld of %ld are looser than the enclosures", loose, n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_touch),
        cmocka_unit_test(test_enclosures_at_their_limits),
        cmocka_unit_test(test_start_beside_root),
        cmocka_unit_test(test_asked),
        cmocka_unit_test(test_poles_and_jumps),
        cmocka_unit_test(test_root_beside_pole),
        cmocka_unit_test(test_noisy_poles),
        cmocka_unit_test(test_random_answers),
        cmocka_unit_test(test_undecided),
        cmocka_unit_test(test_from_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
