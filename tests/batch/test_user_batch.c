// SPDX-License-Identifier: MIT
/* Surfaces of a user in batches: every ray gets the answer that it gets alone, bit for bit, evaluations
 * included.
 *
 * The surfaces are those of people who keep their word and of people who do not: with every choice of what
 * can be offered, with slopes that lie, noise, islands of NaN, poles, spans that are nonsense.  `values`
 * and `spans` are loops over `value` and `span`, so that what they promise is true, and whatever differs is
 * the batch's.
 *
 *     test_user_batch     SAGITTA_TEST_SCALE multiplies the number of batches, SAGITTA_TEST_SEED chooses
 *                         others
 * */
#include "../ends.h"
#include "hostile.h"
#include "soil.h"

#include <sagitta/interval.h>

/* ---------------------------------------------------------------- surfaces */

typedef enum form { TORUS, ELLIPSOID, SPHERE_DISTANCE, CONIC, POLE, PLANE, FORMS } form;
typedef enum fault {
    HONEST,
    NORMALISED,
    RANDOM_SLOPE,
    ZERO_SLOPE,
    NAN_SLOPE,
    NOISY,
    ISLANDS,
    NOWHERE,
    FAULTS
} fault;
typedef enum reach { CHORD, NO_SEED, RANDOM_SEED, HALF_LINE, ANY_SPAN, REACHES } reach;

typedef struct shape {
    form form;
    fault fault;
    reach reach;
    double a, b, c;
    long *calls, *rays; /* of values, and the points asked for in them; NULL: not counted */
} shape;

/* A number in [0, 1) that depends on every bit of p. */
static double hash(sgt_vec3 p)
{
    generator g = {bits_of(p.x) ^ (bits_of(p.y) * 3) ^ (bits_of(p.z) * 7)};
    return uniform(&g, 0, 1);
}

static double formula(const shape *s, sgt_vec3 p, sgt_vec3 *n)
{
    double q = p.x * p.x + p.y * p.y, w;
    switch (s->form) {
    case TORUS:
        w = q + p.z * p.z + s->a * s->a - s->b * s->b;
        *n = (sgt_vec3){4 * p.x * (w - 2 * s->a * s->a), 4 * p.y * (w - 2 * s->a * s->a), 4 * p.z * w};
        return w * w - 4 * s->a * s->a * q;
    case ELLIPSOID:
        *n = (sgt_vec3){2 * p.x / (s->a * s->a), 2 * p.y / (s->b * s->b), 2 * p.z / (s->c * s->c)};
        return p.x * p.x / (s->a * s->a) + p.y * p.y / (s->b * s->b) + p.z * p.z / (s->c * s->c) - 1;
    case SPHERE_DISTANCE:
        w = sqrt(q + p.z * p.z);
        *n = (sgt_vec3){p.x / w, p.y / w, p.z / w};
        return w - s->a;
    case CONIC: return sgt_conic_ops.value(&(sgt_conic){.c = s->c, .k = -0.6}, p, n);
    case POLE:
        *n = (sgt_vec3){0, 0, 1 / (p.z * p.z)};
        return 1 - 1 / p.z;
    default:
        *n = (sgt_vec3){0.1, 0.2, 1};
        return 0.1 * p.x + 0.2 * p.y + p.z;
    }
}

static double user_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const shape *s = self;
    sgt_vec3 n;
    double f = formula(s, p, &n), length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z), by = 1;
    switch (s->fault) {
    case NORMALISED: by = 1 / length; break;
    case RANDOM_SLOPE: by = pow(10, 4 * hash(p) - 2); break;
    case ZERO_SLOPE: by = hash(p) < 0.3 ? 0 : 1; break;
    case NAN_SLOPE: by = hash(p) < 0.3 ? NOT : 1; break;
    case NOISY: f += 1e-13 * length * (hash(p) - 0.5); break;
    case ISLANDS: f = sin(40 * p.x) * sin(30 * p.y + p.z) > 0.6 ? NOT : f; break;
    case NOWHERE: f = NOT; break;
    default: break;
    }
    if (grad) *grad = (sgt_vec3){by * n.x, by * n.y, by * n.z};
    return f;
}

static sgt_span user_span(const void *self, const sgt_ray *ray)
{
    const shape *s = self;
    if (s->form == CONIC) return sgt_conic_ops.span(&(sgt_conic){.c = s->c, .k = -0.6}, ray);
    sgt_vec3 o = ray->o, d = ray->d;
    double R = 1.001 * (s->form == TORUS             ? s->a + s->b
                        : s->form == ELLIPSOID       ? fmax(s->a, fmax(s->b, s->c))
                        : s->form == SPHERE_DISTANCE ? s->a
                                                     : 3 * s->a);
    double t = -dot(o, d) / dot(d, d),
           half2 = (R * R - dot(sum(o, times(t, d)), sum(o, times(t, d)))) / dot(d, d), half = sqrt(half2),
           any = hash(o);
    if (s->form == PLANE)
        return (sgt_span){.lo = -FAR, .hi = FAR, .seed = any < 0.1 ? NOT : 0, .single = true};
    sgt_span span = {.lo = t - half, .hi = t + half, .seed = t - half};
    if (half2 < 0) return (sgt_span){.lo = 1, .hi = -1, .seed = NOT};
    switch (s->reach) {
    case NO_SEED: span.seed = NOT; break;
    case RANDOM_SEED: span.seed = t + (3 * any - 1.5) * half; break;
    case HALF_LINE: span.hi = FAR; break;
    case ANY_SPAN:
        if (any < 0.1) span.lo = NOT;
        else if (any < 0.2) span.hi = -FAR;
        else if (any < 0.3) span.seed = FAR;
        else if (any < 0.4) span.lo = span.hi = span.seed = t;
        else if (any < 0.5) span.lo = t, span.single = true; /* true of a convex one */
        else if (any < 0.7) span.single = true;              /* a lie */
        break;
    default: break;
    }
    return span;
}

static double user_rounding(const void *self, sgt_vec3 p)
{
    const shape *s = self;
    sgt_vec3 n;
    double f = formula(s, p, &n), any = hash(p);
    if (s->fault == ISLANDS && any < 0.1) return any < 0.03 ? NOT : any < 0.06 ? -1 : FAR;
    return 0x1p-50 * (fabs(f) + fabs(p.x * n.x) + fabs(p.y * n.y) + fabs(p.z * n.z)) +
           (s->fault == NOISY ? 1e-13 * sqrt(dot(n, n)) : 0);
}

/* Of the distance to a sphere; of the others, what says nothing. */
static double user_clearance(const void *self, sgt_vec3 p)
{
    const shape *s = self;
    return s->form == SPHERE_DISTANCE ? fabs(user_value(self, p, NULL)) * (1 - 1e-9) : 0;
}
static double user_estimate(const void *self, sgt_vec3 p) { return 0.1 * fabs(user_value(self, p, NULL)); }

/* F and its slope, by intervals; of the distance, which changes by no more than the length of the way. */
static sgt_interval user_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const shape *s = self;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z},
                 size[3] = {s->a, s->b, s->c}, normal[3] = {0.1, 0.2, 1};
    double length = sqrt(dot(ray->d, ray->d)), m = 0.5 * t.lo + 0.5 * t.hi,
           far = (t.hi - t.lo) * 0.51 * length + 1e-14 * (1 + fabs(m));
    if (s->form != TORUS && s->form != ELLIPSOID && s->form != PLANE) {
        double f = user_value(self, sum(ray->o, times(m, ray->d)), NULL);
        *slope = (sgt_interval){-length, length};
        if (s->form != SPHERE_DISTANCE) return (sgt_interval){-FAR, FAR};
        return (sgt_interval){f - far, f + far};
    }
    sgt_interval x[3], two[3], by[3], a2 = sgt_interval_square(sgt_interval_of(s->a));
    for (int k = 0; k < 3; k++) {
        x[k] = sgt_interval_sum(sgt_interval_of(o[k]), sgt_interval_scaled(t, d[k]));
        two[k] = sgt_interval_square(x[k]);
        by[k] = sgt_interval_scaled(sgt_interval_scaled(x[k], d[k]), 2);
        if (s->form == PLANE) two[k] = sgt_interval_scaled(x[k], normal[k]);
        if (s->form == PLANE) by[k] = sgt_interval_scaled(sgt_interval_of(normal[k]), d[k]);
        if (s->form != ELLIPSOID) continue;
        sgt_interval r2 = sgt_interval_square(sgt_interval_of(size[k]));
        two[k] = sgt_interval_quotient(two[k], r2), by[k] = sgt_interval_quotient(by[k], r2);
    }
    sgt_interval q = sgt_interval_sum(two[0], two[1]), q_by = sgt_interval_sum(by[0], by[1]),
                 w = sgt_interval_sum(q, two[2]), w_by = sgt_interval_sum(q_by, by[2]);
    if (s->form != TORUS) {
        *slope = w_by;
        return s->form == PLANE ? w : sgt_interval_difference(w, sgt_interval_of(1));
    }
    sgt_interval b2 = sgt_interval_square(sgt_interval_of(s->b)), four = sgt_interval_scaled(a2, 4);
    w = sgt_interval_sum(w, sgt_interval_difference(a2, b2));
    *slope = sgt_interval_difference(sgt_interval_scaled(sgt_interval_product(w, w_by), 2),
                                     sgt_interval_product(four, q_by));
    return sgt_interval_difference(sgt_interval_square(w), sgt_interval_product(four, q));
}

/* The same, wider, and of some cells nothing is said, by the bits of the cell alone. */
static void user_encloses(const void *self, size_t n, sgt_rays r, const double *lo, const double *hi,
                          sgt_enclosures out)
{
    const shape *s = self;
    if (s->calls) ++*s->calls, *s->rays += (long)n;
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, NOT, NOT};
        sgt_interval slope = {NOT, NOT}, g = user_enclose(self, &ray, (sgt_interval){lo[i], hi[i]}, &slope);
        double any = hash((sgt_vec3){lo[i], hi[i], r.o[0][i]}), by = any * 0x1p-48;
        g.lo -= by * fabs(g.lo), g.hi += by * fabs(g.hi);
        if (s->fault != HONEST && any < 0.1) slope = (sgt_interval){any < 0.05 ? -FAR : NOT, FAR};
        if (s->fault != HONEST && any < 0.03)
            g = (sgt_interval){any < 0.02 ? -FAR : 1, any < 0.01 ? NOT : -1};
        out.lo[i] = g.lo, out.hi[i] = g.hi;
        if (out.slope_lo) out.slope_lo[i] = slope.lo, out.slope_hi[i] = slope.hi;
    }
}

static void user_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    const shape *s = self;
    if (s->calls) ++*s->calls, *s->rays += (long)n;
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = user_value(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

static void user_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, NOT, NOT};
        sgt_span span = user_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

/* Any choice of offers. */
static sgt_surface_ops random_offer(generator *g)
{
    sgt_surface_ops ops = {.name = "of a user", .value = user_value};
    if (chance(g, 0.85)) ops.values = user_values;
    if (chance(g, 0.8)) ops.span = user_span;
    if (chance(g, 0.7)) ops.spans = user_spans;
    if (chance(g, 0.3)) ops.rounding = user_rounding;
    if (chance(g, 0.1)) ops.clearance = user_clearance;
    if (chance(g, 0.1)) ops.estimate = user_estimate;
    if (chance(g, 0.3)) ops.enclose = user_enclose;
    if (chance(g, 0.5)) ops.encloses = user_encloses;
    if (chance(g, 0.8)) ops.size = sizeof ops; /* else `encloses` is not read */
    return ops;
}

static shape random_shape(generator *g)
{
    shape s = {.form = (form)below(g, FORMS),
               .fault = chance(g, 0.5) ? HONEST : (fault)below(g, FAULTS),
               .reach = chance(g, 0.5) ? CHORD : (reach)below(g, REACHES)};
    double size = chance(g, 0.7) ? 1 : any_scale(g, -6, 6);
    s.a = size, s.b = size * uniform(g, 0.05, 0.6),
    s.c = s.form == CONIC ? either_sign(g) * uniform(g, 0, 0.5) / size : size * uniform(g, 0.3, 2);
    return s;
}

/* -------------------------------------------------------------------- rays */

static sgt_ray user_ray(generator *g, sgt_surface s, const sgt_options *opt)
{
    const shape *of = s.self;
    sgt_vec3 d = random_direction(g), at = {uniform(g, -1.3, 1.3) * of->a, uniform(g, -1.3, 1.3) * of->a,
                                            uniform(g, -0.5, 0.5) * of->a};
    if (of->form == CONIC && chance(g, 0.8)) d = (sgt_vec3){uniform(g, -0.3, 0.3), uniform(g, -0.3, 0.3), 1};
    double away = of->a * (chance(g, 0.8) ? uniform(g, 2, 10) : any_scale(g, -3, 8)),
           length = chance(g, 0.6) ? 1 : any_scale(g, -5, 5);
    sgt_ray ray = {.o = difference(at, times(away, d)), .d = times(length, d)};
    int kind = below(g, 14);
    if (kind == 0) ray.tmin = -FAR, ray.tmax = FAR;
    if (kind == 1) ray.tmin = -1, ray.tmax = away / length;
    if (kind >= 2 && kind <= 5) { /* an end at a root, or a start there */
        sgt_hit hit = sgt_intersect(s, ray, opt);
        if (hit.status <= 0) return ray;
        double there = ulps(hit.t, below(g, 5) - 2);
        if (kind == 2) ray.tmin = there, ray.tmax = FAR;
        if (kind == 3) ray.tmax = there;
        if (kind == 4) ray.o = hit.p;
        if (kind == 5) ray.tmin = there - hit.t_err * below(g, 3), ray.tmax = hit.t + hit.t_err * below(g, 3);
    }
    if (kind == 6 && chance(g, 0.3)) {
        double *const any[] = {&ray.o.x, &ray.o.y, &ray.o.z,  &ray.d.x,
                               &ray.d.y, &ray.d.z, &ray.tmin, &ray.tmax};
        *any[below(g, 8)] = hostile_number(g);
    }
    return ray;
}

static sgt_options user_options(generator *g, const shape *s)
{
    sgt_options opt = {.pick = (sgt_pick)below(g, 3)};
    if (chance(g, 0.2)) opt.t_tol = s->a * any_scale(g, -15, -2);
    if (chance(g, 0.15)) opt.f_tol = any_scale(g, -15, -2);
    if (chance(g, 0.15)) opt.dt_min = s->a * any_scale(g, -2, 0);
    if (chance(g, 0.2)) opt.proof = (sgt_proof)(1 + below(g, 2));
    if (chance(g, 0.2)) opt.max_evals = 1 + below(g, chance(g, 0.5) ? 12 : 90);
    return opt;
}

/* -------------------------------------------------------------- one question */

static sgt_ray rays[MOST];
static sgt_hit hits[MOST];
static long failures, compared, told[9];

/* The batch of the rays in this order, against what they were told alone. */
static void ask(generator *g, const sgt_surface_ops *ops, const shape *s, const sgt_options *opt, size_t n,
                const size_t order[])
{
    static double in[8][MOST], out[10][MOST + 2];
    static sgt_status status[MOST + 2];
    static int evals[MOST + 2];
    bool some[12];
    for (int j = 0; j < 12; j++) some[j] = chance(g, 0.8);
    some[5] = some[6] = some[4], some[8] = some[9] = some[7];
    for (size_t i = 0; i < n; i++) {
        sgt_ray r = rays[order[i]];
        const double numbers[] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
        for (int j = 0; j < 8; j++) in[j][i] = numbers[j];
    }
    for (size_t i = 0; i < n + 2; i++) {
        status[i] = 77, evals[i] = -77;
        for (int j = 0; j < 10; j++) out[j][i] = 77;
    }
    double *to[10];
    for (int j = 0; j < 10; j++) to[j] = some[j] ? out[j] + 1 : NULL;
    sgt_hits h = {.status = some[10] ? status + 1 : NULL,
                  .evals = some[11] ? evals + 1 : NULL,
                  .t = to[0],
                  .t_err = to[1],
                  .t_lo = to[2],
                  .p_err = to[3],
                  .p = {to[4], to[5], to[6]},
                  .n = {to[7], to[8], to[9]}};
    soil_stack(random_bits(g));
    size_t met = sgt_intersect_batch((sgt_surface){ops, s}, n,
                                     (sgt_rays){{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]},
                                     h, opt),
           want = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_hit *hit = &hits[order[i]];
        const double wants[10] = {hit->t,   hit->t_err, hit->t_lo, hit->p_err, hit->p.x,
                                  hit->p.y, hit->p.z,   hit->n.x,  hit->n.y,   hit->n.z};
        bool good = (!some[10] || status[i + 1] == hit->status) && (!some[11] || evals[i + 1] == hit->evals);
        for (int j = 0; j < 10; j++) good = good && same(out[j][i + 1], some[j] ? wants[j] : 77);
        want += hit->status > 0;
        compared++;
        if (good || ++failures > 5) continue;
        printf("FAIL ray %zu of %zu: form %d fault %d reach %d a %a b %a c %a; span %d spans %d values %d "
               "rounding %d clearance %d estimate %d enclose %d encloses %d\n",
               i, n, s->form, s->fault, s->reach, s->a, s->b, s->c, !!ops->span, !!ops->spans, !!ops->values,
               !!ops->rounding, !!ops->clearance, !!ops->estimate, !!ops->enclose,
               ops->encloses && ops->size);
        print_options(opt), print_ray(&rays[order[i]]);
        printf("  alone: %s, %d evaluations, t %a +- %a; batch: %d, %d, %a +- %a\n",
               sgt_status_text(hit->status), hit->evals, hit->t, hit->t_err, status[i + 1], evals[i + 1],
               out[0][i + 1], out[1][i + 1]);
    }
    bool kept = status[0] == 77 && status[n + 1] == 77 && evals[0] == -77 && evals[n + 1] == -77;
    for (int j = 0; j < 10; j++) kept = kept && out[j][0] == 77 && out[j][n + 1] == 77;
    if (!kept && ++failures <= 5) printf("FAIL something was written beside the outputs of %zu rays\n", n);
    if (met != want && ++failures <= 5) printf("FAIL %zu met of %zu, %zu said\n", want, n, met);
}

static void random_batch(generator *g)
{
    shape s = random_shape(g);
    sgt_surface_ops ops = random_offer(g);
    sgt_options opt = user_options(g, &s);
    size_t n = (size_t)below(g, chance(g, 0.3) ? 20 : 400), order[MOST] = {0};
    for (size_t i = 0; i < n; i++) {
        rays[i] = user_ray(g, (sgt_surface){&ops, &s}, &opt);
        hits[i] = sgt_intersect((sgt_surface){&ops, &s}, rays[i], &opt);
        order[i] = i;
        told[hits[i].status - SGT_INVALID]++;
    }
    ask(g, &ops, &s, &opt, n, order);
    for (size_t i = n; i-- > 1;) { /* other neighbours */
        size_t j = (size_t)below(g, (int)i + 1), other = order[i];
        order[i] = order[j], order[j] = other;
    }
    ask(g, &ops, &s, &opt, n, order);
}

/* ----------------------------------------------------------------- watchers */

typedef struct witness { long steps, ray; int stop_at, eval; bool in_order; } witness;

static int watch(void *data, const sgt_step *step)
{
    witness *w = data;
    bool next = (long)step->ray == w->ray && step->eval == w->eval + 1,
         first = (long)step->ray > w->ray && step->eval == 1;
    w->in_order = w->in_order && (next || first);
    w->ray = (long)step->ray, w->eval = step->eval, w->steps++;
    return w->stop_at > 0 && step->eval == w->stop_at;
}

/* One by one, in order, each evaluation told; a watcher that stops, stops that ray. */
static void watched_batch(generator *g)
{
    enum { COUNT = 90 };
    static double in[8][COUNT], t[2][COUNT];
    static int evals[2][COUNT];
    static sgt_status status[2][COUNT];
    shape s = random_shape(g);
    sgt_surface_ops ops = random_offer(g);
    sgt_options opt = user_options(g, &s);
    for (size_t i = 0; i < COUNT; i++) {
        sgt_ray r = user_ray(g, (sgt_surface){&ops, &s}, &opt);
        const double numbers[] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
        for (int j = 0; j < 8; j++) in[j][i] = numbers[j];
    }
    sgt_rays all = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]};
    for (int stop = 0; stop <= 3; stop += 3) {
        witness w = {.ray = -1, .in_order = true, .stop_at = stop};
        sgt_options seen = opt;
        seen.watch = watch, seen.watch_data = &w;
        sgt_intersect_batch((sgt_surface){&ops, &s}, COUNT, all,
                            (sgt_hits){.status = status[0], .evals = evals[0], .t = t[0]}, &opt);
        sgt_intersect_batch((sgt_surface){&ops, &s}, COUNT, all,
                            (sgt_hits){.status = status[1], .evals = evals[1], .t = t[1]}, &seen);
        long spent = 0;
        for (size_t i = 0; i < COUNT; i++) {
            bool stopped = stop && evals[0][i] >= stop;
            spent += evals[1][i];
            bool good = stopped ? status[1][i] == SGT_STOPPED && evals[1][i] == stop
                                : status[0][i] == status[1][i] && evals[0][i] == evals[1][i] &&
                                      same(t[0][i], t[1][i]);
            if (!good && ++failures <= 5)
                printf("FAIL watched ray %zu, stop at %d: %d after %d, unwatched %d after %d; form %d fault "
                       "%d\n",
                       i, stop, status[1][i], evals[1][i], status[0][i], evals[0][i], s.form, s.fault);
        }
        if ((!w.in_order || spent != w.steps) && ++failures <= 5)
            printf("FAIL %ld steps seen of %ld, in order: %d\n", w.steps, spent, w.in_order);
    }
}

/* ------------------------------------------------------------- who is asked */

/* Points are asked for many at once, and hardly more of them than are counted. */
static void asked_together(generator *g)
{
    enum { COUNT = 1024 };
    static double in[6][COUNT];
    static int evals[COUNT];
    long calls = 0, points = 0, counted = 0;
    shape s = {.form = CONIC, .a = 1, .c = 0.1, .calls = &calls, .rays = &points};
    sgt_surface_ops ops = {
        .value = user_value, .span = user_span, .values = user_values, .spans = user_spans};
    for (size_t i = 0; i < COUNT; i++) {
        in[0][i] = uniform(g, -1, 1), in[1][i] = uniform(g, -1, 1), in[2][i] = -5;
        in[3][i] = uniform(g, -0.15, 0.15), in[4][i] = uniform(g, -0.15, 0.15), in[5][i] = 1;
    }
    size_t met = sgt_intersect_batch((sgt_surface){&ops, &s}, COUNT,
                                     (sgt_rays){.o = {in[0], in[1], in[2]}, .d = {in[3], in[4], in[5]}},
                                     (sgt_hits){.evals = evals}, NULL);
    for (size_t i = 0; i < COUNT; i++) counted += evals[i];
    printf("%zu of %d rays met, %ld evaluations, %ld points in %ld calls\n", met, COUNT, counted, points,
           calls);
    if ((met != COUNT || points < counted || points > counted + counted / 4 || calls * 32 > points) &&
        ++failures <= 5)
        printf("FAIL points are not asked for together\n");
}

/* Cells are asked for many at once, each that is asked for is counted, and a table that ends before
 * `encloses` is not asked. */
static void cells_together(generator *g)
{
    enum { COUNT = 1000 };
    static double in[6][COUNT];
    static int evals[2][COUNT];
    long calls = 0, cells = 0, counted = 0;
    shape s = {.form = TORUS, .a = 1, .b = 0.4, .calls = &calls, .rays = &cells};
    sgt_surface_ops ops = {.size = sizeof ops,
                           .value = user_value,
                           .span = user_span,
                           .enclose = user_enclose,
                           .encloses = user_encloses};
    for (size_t i = 0; i < COUNT; i++) {
        sgt_vec3 d = random_direction(g), at = {uniform(g, -1, 1), uniform(g, -1, 1), uniform(g, -0.3, 0.3)};
        const double numbers[] = {at.x - 4 * d.x, at.y - 4 * d.y, at.z - 4 * d.z, d.x, d.y, d.z};
        for (int j = 0; j < 6; j++) in[j][i] = numbers[j];
    }
    sgt_rays all = {.o = {in[0], in[1], in[2]}, .d = {in[3], in[4], in[5]}};
    sgt_options opt = {.proof = SGT_PROVE_FIRST};
    size_t met =
        sgt_intersect_batch((sgt_surface){&ops, &s}, COUNT, all, (sgt_hits){.evals = evals[0]}, &opt);
    for (size_t i = 0; i < COUNT; i++) counted += evals[0][i];
    printf("%zu of %d rays met, %ld evaluations, %ld cells in %ld calls\n", met, COUNT, counted, cells,
           calls);
    if ((met < COUNT / 3 || cells > counted || cells * 5 < counted * 3 || calls * 8 > cells) &&
        ++failures <= 5)
        printf("FAIL cells are not asked for together\n");
    calls = 0;
    ops.size = offsetof(sgt_surface_ops, encloses);
    size_t same_met =
        sgt_intersect_batch((sgt_surface){&ops, &s}, COUNT, all, (sgt_hits){.evals = evals[1]}, &opt);
    if ((calls > 0 || same_met != met) && ++failures <= 5)
        printf("FAIL a table that ends before `encloses`: %ld calls, %zu met\n", calls, same_met);
}

int main(void)
{
    uint64_t seed = test_seed(20260);
    long batches = (long)(900 * test_scale()) + 1;
    printf("SAGITTA_TEST_SEED=%llu, %ld batches\n", (unsigned long long)seed, batches);
    generator g = {seed};
    for (long i = 0; i < batches; i++) random_batch(&g);
    for (long i = 0; i < batches / 10; i++) watched_batch(&g);
    asked_together(&g);
    cells_together(&g);
    printf("%ld answers compared;", compared);
    for (int i = 0; i < 8; i++) printf(" %s %ld", sgt_status_text((sgt_status)(i + SGT_INVALID)), told[i]);
    printf("\n%ld failures\n", failures);
    for (int i = 0; i < 8; i++)
        if (batches > 500 && i != SGT_STOPPED - SGT_INVALID && told[i] == 0)
            failures++, printf("FAIL no ray was %s\n", sgt_status_text((sgt_status)(i + SGT_INVALID)));
    return failures != 0;
}
