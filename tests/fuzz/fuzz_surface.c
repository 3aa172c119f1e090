// SPDX-License-Identifier: MIT
/* fuzz_surface.c - bytes as a surface of any parameters, rays of any numbers, and options.
 *
 * The surface is a row of sgt_builtins with any doubles and ints in it; or the same seen as a user's
 * surface that offers some of its answers; or one whose answers are bytes of the input, and lie.  What is
 * required of every answer:
 *
 *   - a status of the header, and SGT_INVALID exactly where the header says so;
 *   - of a hit, numbers: t finite, in (tmin, tmax] and [lo, hi], t_err and p_err at least 0, the point
 *       inside the rim, F there as
 *     `value` has it;
 *   - a batch gives the bits of the single ray; a list of any cap those of any other; a watcher sees as
 *       many evaluations
 *     as are counted, and changes no bit.
 *
 * And of a built-in surface, against F in long double (of a conic or an even asphere) or F and its bound
 * `rounding` (of others):
 *
 *   - F is 0 within p_err of p; it does not have one certain sign all over [t - t_err, t + t_err].  (At
 *       both ends it may: what is
 *     promised is that a root is nowhere farther than t_err, and without a proof, or where t_tol or an ulp
 *         of t is wider than
 *     what parts two roots, both may be within it);
 *   - where a miss is told, or before a first hit, or between the entries of a list, no two points have
 *       certain signs that
 *     differ; where there is a hit, `enclose` over [lo, hi] does not exclude 0;
 *   - `enclose` contains F where it is known;
 *   - one ray's answers do not contradict each other: under each proof, in the list, under each pick. */
#include "../ends.h"
#include "fuzz.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

typedef long double wide;

typedef union parameters {
    sgt_conic conic;
    sgt_even_asphere asphere;
    sgt_julia julia;
    sgt_mandelbrot mandelbrot;
    unsigned char byte[512];
} parameters;

typedef struct term_list { const sgt_surface *of; size_t count; } term_list; /* as SGT_PARAM_TERMS has it */

typedef enum kind { OWN, USER, LIAR } kind;

typedef struct subject {
    const sgt_builtin *row;
    kind kind;
    parameters with;
    sgt_surface_ops ops;      /* of a user's */
    sgt_surface surface;
    bool sag, valid;          /* sag: a conic or an even asphere, of which long doubles are known here */
    /* one of those that `value` and `rounding` are asked of; rises: F = z - s(x, y) */
    bool catalogue, rises;
    double rim;
    sgt_even_asphere sag_with;     /* of a sag, as long doubles read it */
} subject;

enum { MOST_RAYS = 4, MOST_LANES = 24, MOST_HITS = 24 };

/* ---------------------------------------------------------------- printing */

static const subject *now;
static sgt_ray now_ray;
static sgt_options now_opt;

static const sgt_builtin *row_of(const sgt_surface_ops *ops)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->ops != ops) b++;
    return b;
}

static void print_parameters(const sgt_builtin *row, const unsigned char *with)
{
    for (const sgt_param *p = row->params; p->name; p++) {
        const void *at = with + p->offset;
        sgt_numbers numbers = {at, 1, (size_t)p->count};
        if (p->kind == SGT_PARAM_WHOLE || p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
            fprintf(stderr, "  %s %d", p->name, *(const int *)at);
        } else if (p->kind == SGT_PARAM_TERMS) {
            const term_list *terms = at;
            for (size_t i = 0; i < terms->count; i++) {
                fprintf(stderr, "  term %s", terms->of[i].ops->name);
                print_parameters(row_of(terms->of[i].ops), terms->of[i].self);
            }
        } else {
            if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE)
                numbers = *(const sgt_numbers *)at,
                fprintf(stderr, "  %s %zu x %zu", p->name, numbers.rows, numbers.columns);
            for (size_t i = 0; numbers.x && i < numbers.rows * numbers.columns; i++)
                if (numbers.x[i] != 0) fprintf(stderr, "  %s[%zu] %a", p->name, i, numbers.x[i]);
        }
    }
}

static void print_now(void)
{
    fprintf(stderr, "    %s%s", now->row->type,
            now->kind == OWN    ? ""
            : now->kind == USER ? " as a user's"
                                : " that lies");
    print_parameters(now->row, now->with.byte);
    fprintf(stderr, "\n    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", now_ray.o.x, now_ray.o.y, now_ray.o.z,
            now_ray.d.x, now_ray.d.y, now_ray.d.z, now_ray.tmin, now_ray.tmax);
    fprintf(
        stderr,
        "    options {.t_tol = %a, .f_tol = %a, .dt_min = %a, .max_evals = %d, .pick = %d, .proof = %d}\n",
        now_opt.t_tol, now_opt.f_tol, now_opt.dt_min, now_opt.max_evals, (int)now_opt.pick,
        (int)now_opt.proof);
}

static void print_hit(const char *name, const sgt_hit *h)
{
    fprintf(stderr,
            "    %s: %s, evals %d, t %.17g = %a, t_err %a, t_lo %a, [%a, %a]\n        f %a, p %a %a %a +- "
            "%a, n %a %a %a\n",
            name, sgt_status_text(h->status), h->evals, h->t, h->t, h->t_err, h->t_lo, h->lo, h->hi, h->f,
            h->p.x, h->p.y, h->p.z, h->p_err, h->n.x, h->n.y, h->n.z);
}

#define HOLDS(condition, hit, ...)        \
    do {                                  \
        if (!(condition)) {               \
            print_now();                  \
            print_hit("answer", hit);     \
            REQUIRE(condition, __VA_ARGS__); \
        }                                 \
    } while (0)

/* ------------------------------------------------------------ F, by itself */

/* F on the ray, and how far it may be off; NaN: not known. */
typedef struct known { wide f, err; } known;

static known sag_at(const sgt_even_asphere *s, wide x, wide y, wide z, wide x_err, wide y_err, wide z_err)
{
    const wide u = 0x1p-62L;
    wide c = s->c, k1 = 1 + (wide)s->k, rho = x * x + y * y,
         drho = 2 * fabsl(x) * x_err + 2 * fabsl(y) * y_err + x_err * x_err + y_err * y_err + u * rho;
    wide q = k1 * c * c, v = 1 - q * rho, dv = fabsl(q) * (drho + 4 * u * rho) + 2 * u;
    if (!(rho + drho < 0x1p16000L) || !(v > 4 * dv)) return (known){NAN, NAN};
    wide root = sqrtl(v), droot = dv / root, sag = c * rho / (1 + root), f, err = 0, power = 1, far = 1;
    wide dsag = fabsl(c) * drho + fabsl(sag) * (droot + 8 * u);
    f = sag;
    for (int i = 0; i < 8; i++) {
        power *= rho;
        f += (wide)s->a[i] * power;
        /* the slope where it is greatest */
        err += fabsl((wide)s->a[i]) * (power * 40 * u + (i + 1) * far * drho);
        far *= rho + drho;
    }
    wide F = z - f;
    return (known){F, (dsag + err + z_err + (fabsl(z) + fabsl(f) + fabsl(sag)) * 4 * u) * 1.01L};
}

static known f_at(const subject *s, const sgt_ray *r, wide t)
{
    const wide u = 0x1p-62L;
    wide x = (wide)r->o.x + t * (wide)r->d.x, y = (wide)r->o.y + t * (wide)r->d.y,
         z = (wide)r->o.z + t * (wide)r->d.z;
    if (s->sag)
        return sag_at(&s->sag_with, x, y, z, u * (fabsl((wide)r->o.x) + fabsl(t * (wide)r->d.x)),
                      u * (fabsl((wide)r->o.y) + fabsl(t * (wide)r->d.y)),
                      u * (fabsl((wide)r->o.z) + fabsl(t * (wide)r->d.z)));
    sgt_vec3 p = {(double)x, (double)y, (double)z}, n = {0, 0, 0};
    double f = s->row->ops->value(&s->with, p, &n), own = s->row->ops->rounding(&s->with, p);
    wide far = 0x1p-52L * (fabsl(x) + fabsl((wide)r->o.x)) * fabsl((wide)n.x) +
               0x1p-52L * (fabsl(y) + fabsl((wide)r->o.y)) * fabsl((wide)n.y) +
               0x1p-52L * (fabsl(z) + fabsl((wide)r->o.z)) * fabsl((wide)n.z);
    wide err = (wide)own + 4 * far;
    /* and what the gradient changes by on the way there, which is to be small beside it */
    if (s->catalogue) {
        sgt_vec3 q = p, m = {0, 0, 0};
        q.x += 0x1p-52 * (fabs(p.x) + fabs(r->o.x));
        q.y += 0x1p-52 * (fabs(p.y) + fabs(r->o.y));
        q.z += 0x1p-52 * (fabs(p.z) + fabs(r->o.z));
        s->row->ops->value(&s->with, q, &m);
        wide change = fabsl((wide)q.x - p.x) * fabsl((wide)m.x - n.x) +
                      fabsl((wide)q.y - p.y) * fabsl((wide)m.y - n.y) +
                      fabsl((wide)q.z - p.z) * fabsl((wide)m.z - n.z);
        if (!(change <= err)) return (known){NAN, NAN};
    }
    if (s->catalogue)
        return !(fabs(n.x) < 1e8 && fabs(n.y) < 1e8 && fabs(n.z) < 1e8) || !(own < 1e150)
                   ? (known){NAN, NAN}
                   : (known){(wide)f, err};
    /* a gradient that the step itself changes says little */
    const double *ex = s->row->ops == &sgt_julia_ops ? s->with.julia.ex : s->with.mandelbrot.ex, *ey = ex + 4,
                 *ez = ex + 8;
    wide longest = 1, step = 0x1p-52L * (fabsl(x) + fabsl(y) + fabsl(z) + fabsl((wide)r->o.x) +
                                         fabsl((wide)r->o.y) + fabsl((wide)r->o.z));
    for (int i = 0; i < 4; i++)
        longest = fmaxl(longest, fmaxl(fabsl((wide)ex[i]), fmaxl(fabsl((wide)ey[i]), fabsl((wide)ez[i]))));
    if (!(step * longest < 1e-9L)) return (known){NAN, NAN};
    if (!(err < 0x1p-10L) || !(fabs(n.x) < 1e30 && fabs(n.y) < 1e30 && fabs(n.z) < 1e30))
        return (known){NAN, NAN};
    return (known){(wide)f, err};
}

static int sign_of(known k) { return k.f > k.err ? 1 : k.f < -k.err ? -1 : 0; }

/* Certainly inside the rim: r^2 <= a^2. */
static bool inside(const subject *s, const sgt_ray *r, wide t)
{
    if (!(s->rim > 0)) return true;
    wide x = (wide)r->o.x + t * (wide)r->d.x, y = (wide)r->o.y + t * (wide)r->d.y, a = s->rim;
    wide off = 0x1p-60L * (fabsl((wide)r->o.x) + fabsl((wide)r->o.y) +
                           fabsl(t) * (fabsl((wide)r->d.x) + fabsl((wide)r->d.y)));
    return hypotl(x, y) + 2 * off < a;
}

/* Two points in (from, to) where F has certain signs that differ, both inside the rim (the domain and the
 * rim's cylinder are convex, so all between them is): then there is a root between. */
static bool crosses(const subject *s, const sgt_ray *r, double from, double to, wide *left, wide *right)
{
    enum { SAMPLES = 24 };
    int last = 0;
    wide before = 0;
    if (!(from < to)) return false;
    if (!isfinite(from) || !isfinite(to)) {
        wide d = fabsl((wide)r->d.x) + fabsl((wide)r->d.y) + fabsl((wide)r->d.z),
             o = fabsl((wide)r->o.x) + fabsl((wide)r->o.y) + fabsl((wide)r->o.z) + 1;
        wide reach = 2 * o / d;
        if (!(reach < 1e300L)) return false;
        if (!isfinite(from)) from = isfinite(to) ? to - (double)reach : -(double)reach;
        if (!isfinite(to)) to = from + 2 * (double)reach;
    }
    for (int i = 1; i < SAMPLES; i++) {
        wide t = (wide)from + ((wide)to - (wide)from) * i / SAMPLES;
        int sign = inside(s, r, t) ? sign_of(f_at(s, r, t)) : 0;
        if (!sign) continue;
        if (last && sign != last) return *left = before, *right = t, true;
        last = sign, before = t;
    }
    return false;
}

/* ------------------------------------------------------------- the subject */

static bool finite_all(const subject *s)
{
    for (const sgt_param *p = s->row->params; p->name; p++)
        for (int i = 0; i < p->count && (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR); i++) {
            double x;
            memcpy(&x, s->with.byte + p->offset + (size_t)i * sizeof x, sizeof x);
            if (!isfinite(x)) return false;
        }
    return true;
}

/* The answers of one that lies: any number, the same for the same question. */
static double lie(const void *self, const double *x, int n, unsigned salt)
{
    uint64_t h = 0x9e3779b97f4a7c15u * (salt + 1), seed;
    memcpy(&seed, self, sizeof seed);
    for (int i = 0; i < n; i++) {
        h = (h ^ bits_of(x[i]) ^ seed) * 0xbf58476d1ce4e5b9u;
        h ^= h >> 29;
    }
    switch (h & 15) {
    case 0: return from_bits(h * 0x94d049bb133111ebu);
    case 1: return NAN;
    case 2: return 0;
    case 3: return (double)INFINITY;
    case 4: return -(double)INFINITY;
    case 5: return x[0];
    default: return (double)(int64_t)(h >> 8 << 8) * 0x1p-63 + (salt < 4 ? x[2] * (double)(seed & 7) : 0);
    }
}
static double lying_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const double x[] = {p.x, p.y, p.z};
    if (grad) *grad = (sgt_vec3){lie(self, x, 3, 1), lie(self, x, 3, 2), lie(self, x, 3, 3)};
    return lie(self, x, 3, 0);
}
static double lying_number(const void *self, sgt_vec3 p)
{
    const double x[] = {p.x, p.y, p.z};
    return lie(self, x, 3, 4);
}
static sgt_span lying_span(const void *self, const sgt_ray *ray)
{
    const double x[] = {ray->o.x, ray->o.y, ray->o.z, ray->d.x, ray->d.y, ray->d.z};
    return (sgt_span){lie(self, x, 6, 5), lie(self, x, 6, 6), lie(self, x, 6, 7), lie(self, x, 6, 8) > 0};
}
static sgt_interval lying_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const double x[] = {t.lo, t.hi, ray->o.x, ray->d.z};
    *slope = (sgt_interval){lie(self, x, 4, 9), lie(self, x, 4, 10)};
    return (sgt_interval){lie(self, x, 4, 11), lie(self, x, 4, 12)};
}
static void lying_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = lying_value(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}
static void lying_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_span s = lying_span(self, &ray);
        out.lo[i] = s.lo, out.hi[i] = s.hi, out.seed[i] = s.seed, out.single[i] = s.single;
    }
}
static const sgt_surface_ops liar = {.name = "liar",
                                     .value = lying_value,
                                     .span = lying_span,
                                     .rounding = lying_number,
                                     .clearance = lying_number,
                                     .estimate = lying_number,
                                     .enclose = lying_enclose,
                                     .values = lying_values,
                                     .spans = lying_spans};

/* `values` and `spans` of a built-in seen as a user's: one by one. */
static const subject *seen;
static void one_by_one(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = seen->row->ops->value(self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (out.grad[0]) out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}
static void spans_one_by_one(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{r.o[0][i], r.o[1][i], r.o[2][i]}, {r.d[0][i], r.d[1][i], r.d[2][i]}, 0, 0};
        sgt_span s = seen->row->ops->span(self, &ray);
        out.lo[i] = s.lo, out.hi[i] = s.hi, out.seed[i] = s.seed, out.single[i] = s.single;
    }
}

static double tame(double x, double most)
{
    if (!isfinite(x)) return 0;
    return fabs(x) <= most ? x : fmod(x, most);
}

/* The numbers of lists and tables, and the terms of sums: of one subject. */
static double pool[6000];
static size_t pooled;
enum { MOST_TERMS = 3 };
static parameters term_with[MOST_TERMS];
static sgt_surface term[MOST_TERMS];

static sgt_numbers take_numbers(bytes *b, const sgt_param *p, bool tamed)
{
    size_t few = strcmp(p->name, "sag") == 0 ? 4 : 0,
           rows = p->kind == SGT_PARAM_LIST ? 1 : few + take_byte(b) % 7, columns = few + take_byte(b) % 9;
    if (rows * columns == 0) return (sgt_numbers){NULL, rows, columns};
    if (!tamed && (take_byte(b) & 15) == 0) return (sgt_numbers){NULL, rows, columns};
    sgt_numbers n = {&pool[pooled], rows, columns};
    for (size_t i = 0; i < rows * columns; i++) {
        double x = take_number(b);
        pool[pooled++] = tamed ? tame(x, 1) : x;
    }
    if (!tamed && (take_byte(b) & 15) == 0) n.columns = 5200; /* too many, most often */
    return pooled + 5200 < COUNT_OF(pool) ? n : (sgt_numbers){pool, 1, 1};
}

static void take_catalogue(bytes *b, const sgt_builtin *row, unsigned char *with, bool tamed)
{
    for (const sgt_param *p = row->params; p->name; p++) {
        void *to = with + p->offset;
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            *(sgt_numbers *)to = take_numbers(b, p, tamed);
        } else if (p->kind == SGT_PARAM_TERMS) {
            static const sgt_surface_ops *const kinds[] = {
                &sgt_odd_asphere_ops, &sgt_polynomial_xy_ops, &sgt_chebyshev_ops,
                &sgt_zernike_ops,     &sgt_q_con_ops,         &sgt_q_bfs_ops,
                &sgt_grid_ops,        &sgt_even_asphere_ops,       &sgt_torus_ops};
            size_t count = take_byte(b) % (MOST_TERMS + 1);
            for (size_t i = 0; i < count; i++) {
                memset(&term_with[i], 0, sizeof term_with[i]);
                term[i] = (sgt_surface){kinds[take_byte(b) % (COUNT_OF(kinds) - tamed)], &term_with[i]};
                const sgt_builtin *of = row_of(term[i].ops);
                take_catalogue(b, of, term_with[i].byte, tamed);
                double flat = 0; /* the base is the sum's */
                if (tamed && strcmp(of->params[0].name, "curvature") == 0)
                    memcpy(term_with[i].byte + of->params[0].offset, &flat, sizeof flat);
            }
            *(term_list *)to = (term_list){term, count};
        } else if (p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
            int whole = (int)(int8_t)take_byte(b);
            *(int *)to = tamed ? (int)p->lo + abs(whole) % (int)(p->hi - p->lo + 1) : whole;
        } else {
            bool positive = strncmp(p->name, "norm", 4) == 0 || strncmp(p->name, "step", 4) == 0 ||
                            strcmp(p->name, "semi_diameter") == 0;
            for (int i = 0; i < p->count; i++) {
                double x = take_number(b);
                if (tamed) x = tame(x, 1e6);
                if (tamed && (positive || row->ops == &sgt_torus_ops)) x = fabs(x);
                ((double *)to)[i] = x;
            }
        }
    }
}

/* tamed: numbers that are brought to where most surfaces are legal. */
static subject take_subject(bytes *b)
{
    enum { FIRST = 6 }; /* the rows that there were when the corpus was made */
    subject s = {0};
    unsigned which = take_byte(b), flags = take_byte(b), rows = 0;
    while (sgt_builtins()[rows].type) rows++;
    s.catalogue = 0x1188u >> (flags >> 4) & 1;
    s.row = &sgt_builtins()[s.catalogue ? FIRST + which % (rows - FIRST) : which % FIRST];
    bool tamed = flags & 1;
    s.kind = (flags >> 1 & 7) == 6 ? USER : (flags >> 1 & 7) == 7 ? LIAR : OWN;
    s.sag = s.row->ops == &sgt_conic_ops || s.row->ops == &sgt_even_asphere_ops;
    pooled = 0;
    if (s.catalogue) take_catalogue(b, s.row, s.with.byte, tamed);
    for (const sgt_param *p = s.row->params; p->name; p++)
        for (int i = 0; i < p->count && !s.catalogue; i++) {
            unsigned char *to = s.with.byte + p->offset;
            if (p->kind == SGT_PARAM_WHOLE) {
                int whole = (int)(int8_t)take_byte(b);
                if (tamed) whole = abs(whole) % (p->hi > 20 ? 13 : (int)p->hi + 1);
                if (tamed && strcmp(p->name, "power") == 0 && whole == 1) whole = 0;
                memcpy(to, &whole, sizeof whole);
            } else if (strcmp(p->name, "slice") != 0) { /* another name of a number that is given */
                double x = take_number(b);
                if (tamed) x = tame(x, s.sag ? 1e6 : 1);
                if (tamed && p->lo == 0) x = fabs(x);
                if (tamed && strcmp(p->name, "escape") == 0 && x != 0) x = 2.5 + fabs(x);
                memcpy(to + (size_t)i * sizeof x, &x, sizeof x);
            }
        }
    s.valid = finite_all(&s) && !(s.row->object && s.row->object(&s.with).reason);
    if (s.sag) memcpy(&s.sag_with, &s.with, s.row->size);
    for (const sgt_param *p = s.row->params; p->name; p++)
        if (strcmp(p->name, "semi_diameter") == 0)
            memcpy(&s.rim, s.with.byte + p->offset, sizeof s.rim), s.rises = true;
    s.valid = s.valid && !(s.rim < 0);
    if (s.rim >= 0x1p500) s.rim = 0; /* no limit: surfaces.h */
    if (s.valid && tamed && s.row->prepare) s.row->prepare(&s.with);
    if (s.catalogue && !s.valid) s.kind = OWN; /* a list that is longer than said is not for its operations */
    if (s.kind == USER) {
        unsigned offers = take_byte(b);
        s.ops = *s.row->ops, s.ops.own_ = NULL;
        if (offers & 1) s.ops.span = NULL;
        if (offers & 2) s.ops.rounding = NULL;
        if (offers & 4) s.ops.enclose = NULL;
        if (offers & 8) s.ops.estimate = NULL;
        if (offers & 16) s.ops.values = one_by_one;
        if (offers & 32 && s.ops.span) s.ops.spans = spans_one_by_one;
    } else if (s.kind == LIAR) {
        unsigned offers = take_byte(b);
        s.ops = liar;
        if (offers & 1) s.ops.span = NULL, s.ops.spans = NULL;
        if (offers & 2) s.ops.rounding = NULL;
        if (offers & 4) s.ops.enclose = NULL;
        if (offers & 8) s.ops.estimate = NULL;
        if (offers & 16) s.ops.values = NULL, s.ops.spans = NULL;
        if (offers & 32) s.ops.spans = NULL;
        if (offers & 64) s.ops.clearance = NULL;
    }
    return s;
}

static sgt_vec3 take_vector(bytes *b)
{
    double x = take_number(b), y = take_number(b), z = take_number(b);
    return (sgt_vec3){x, y, z};
}

static sgt_ray take_ray(bytes *b, const subject *s, const sgt_ray *before)
{
    unsigned how = take_byte(b);
    sgt_ray ray = {.tmin = 0, .tmax = (double)INFINITY};
    sgt_vec3 n = {0, 0, 1}, p, d;
    double away;
    switch (how & 7) {
    default: /* any numbers */
        ray.o = take_vector(b), ray.d = take_vector(b);
        break;
    case 1: case 2: case 3: /* at a point, of the surface if that is a sag; across it, or along it */
        p.x = take_number(b), p.y = take_number(b), p.z = 0;
        d = take_vector(b), away = take_number(b);
        if (s->rises && s->valid) {
            double f = s->row->ops->value(&s->with, p, &n);
            if (isfinite(f)) p.z = -f;
        }
        if ((how & 7) > 1) {
            double by = (d.x * n.x + d.y * n.y + d.z * n.z) / (n.x * n.x + n.y * n.y + n.z * n.z);
            if (isfinite(by)) d = (sgt_vec3){d.x - by * n.x, d.y - by * n.y, d.z - by * n.z};
        }
        if ((how & 7) > 2) { /* and a little beside it */
            double off = take_number(b);
            off = ldexp(off, -(int)take_byte(b) / 4);
            if (isfinite(off)) p.x += off * n.x, p.y += off * n.y, p.z += off * n.z;
        }
        ray.d = d, ray.o = (sgt_vec3){p.x - away * d.x, p.y - away * d.y, p.z - away * d.z};
        break;
    case 4: { /* the one before, one number of it another */
        ray = *before;
        double *const number[] = {&ray.o.x, &ray.o.y, &ray.o.z,  &ray.d.x,
                                  &ray.d.y, &ray.d.z, &ray.tmin, &ray.tmax};
        unsigned which = take_byte(b);
        *number[which & 7] = take_number(b);
        return ray;
    }
    case 5: /* along the axis */
        ray.o.x = take_number(b), ray.o.z = take_number(b), ray.d = (sgt_vec3){0, 0, 1};
        break;
    }
    if (how & 8) ray.tmin = -(double)INFINITY;
    if (how & 16) ray.tmin = take_number(b);
    if (how & 32) ray.tmax = take_number(b);
    return ray;
}

static bool ray_is_valid(const sgt_ray *r)
{
    double big = fmax(fabs(r->d.x), fmax(fabs(r->d.y), fabs(r->d.z)));
    bool ends = r->tmin <= end_of(r);
    /* a ray that begins at infinity or ends at -infinity has no points */
    return isfinite(r->o.x) && isfinite(r->o.y) && isfinite(r->o.z) && isfinite(r->d.x) && isfinite(r->d.y) &&
           isfinite(r->d.z) && big >= DBL_MIN && ends && r->tmin < HUGE_VAL && r->tmax > -HUGE_VAL;
}

static sgt_options take_options(bytes *b)
{
    static const int budgets[] = {0, 1, 2, 3, 5, 8, 13, 20, 30, 50, 100, 200, 300, 500, 1000, -1};
    unsigned how = take_byte(b), more = take_byte(b);
    sgt_options opt = {.pick = (sgt_pick)((how & 3) % 3),
                       .proof = (sgt_proof)(how >> 2 & 3),
                       .max_evals = budgets[how >> 4]};
    if (more & 1) opt.t_tol = take_number(b);
    if (more & 2) opt.f_tol = take_number(b);
    if (more & 4) opt.dt_min = take_number(b);
    /* one that is none, now and then */
    if ((more & 8) == 0 && opt.proof > SGT_PROVE_FIRST) opt.proof = SGT_ESTIMATE;
    return opt;
}

static bool options_are_valid(const sgt_options *o)
{
    return o->t_tol >= 0 && o->f_tol >= 0 && o->dt_min >= 0 && o->max_evals >= 0 && (int)o->proof >= 0 &&
           o->proof <= SGT_PROVE_FIRST;
}

/* -------------------------------------------------------------- one answer */

static bool same_vector(sgt_vec3 a, sgt_vec3 b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

static bool same_hit(const sgt_hit *a, const sgt_hit *b)
{
    return a->status == b->status && a->evals == b->evals && same(a->t, b->t) && same(a->t_err, b->t_err) &&
           same(a->t_lo, b->t_lo) && same(a->lo, b->lo) && same(a->hi, b->hi) && same(a->f, b->f) &&
           same_vector(a->p, b->p) && same_vector(a->n, b->n) && same(a->p_err, b->p_err);
}

/* The ends made explicit. */
static sgt_ray plain(sgt_ray r)
{
    r.tmax = end_of(&r);
    return r;
}

static void check_point(const subject *s, const sgt_hit *h)
{
    sgt_vec3 n = {0, 0, 0};
    double f = s->surface.ops->value(s->surface.self, h->p, &n);
    bool far = fabs(h->p.x) > 1e150 || fabs(h->p.y) > 1e150; /* r^2 overflows in `value` */
    HOLDS(same(f, h->f) || (f == 0 && h->f == 0) || far, h, "value says %a at p", f);
    double a = s->rim;
    HOLDS(s->kind != OWN || !(a > 0) ||
              (wide)h->p.x * (wide)h->p.x + (wide)h->p.y * (wide)h->p.y <=
                  (wide)a * (wide)a * (1 + 0x1p-44L + 0x1p-50L) + 1e-320L,
          h, "outside the rim");
    if (!s->sag) return;
    known k = sag_at(&s->sag_with, (wide)h->p.x, (wide)h->p.y, (wide)h->p.z, (wide)h->p_err, (wide)h->p_err,
                     (wide)h->p_err);
    if (isfinite((double)k.err)) HOLDS(fabsl(k.f) <= 2 * k.err, h, "F is %Lg +- %Lg there", k.f, k.err);
}

/* Somewhere in [from, to], at whose ends F has one certain sign, it does not: at the minimum of its
 * magnitude, by thirds. */
static bool turns(const subject *s, const sgt_ray *r, wide from, wide to, int sign)
{
    for (int i = 0; i < 1000; i++) {
        wide a = from + (to - from) / 3, b = to - (to - from) / 3;
        known at_a = f_at(s, r, a), at_b = f_at(s, r, b);
        if (sign_of(at_a) != sign || sign_of(at_b) != sign) return true;
        if (sign * at_a.f < sign * at_b.f) to = b;
        else from = a;
    }
    return false;
}

static void check_hit(const subject *s, const sgt_ray *ray, const sgt_hit *h, const sgt_options *opt,
                      bool listed)
{
    sgt_ray r = plain(*ray);
    HOLDS(h->evals >= 0, h, "evals");
    HOLDS(h->status >= SGT_INVALID && h->status <= SGT_GRAZE, h, "status %d", (int)h->status);
    HOLDS(h->status != SGT_STOPPED || opt->watch, h, "stopped by nobody");
    HOLDS(h->status != SGT_EXHAUSTED || listed || !opt->proof, h, "exhausted, where a proof is asked for");
    if (h->status <= 0) {
        if (!listed) HOLDS(isnan(h->t) && isnan(h->t_err), h, "t of no hit");
        HOLDS(isnan(h->f) && isnan(h->p.x) && isnan(h->n.z), h, "p, n or f of no hit");
        if (listed) {
            HOLDS(h->status < 0 && h->lo <= h->hi && h->t >= h->lo && h->t <= h->hi, h,
                  "an entry that is no stretch");
            HOLDS(h->t_err >= 0 && (wide)h->t - (wide)h->t_err <= (wide)h->lo &&
                      (wide)h->t + (wide)h->t_err >= (wide)h->hi,
                  h, "t +- t_err does not cover it");
        }
        if (h->status == SGT_UNPROVEN || h->status == SGT_EXHAUSTED)
            HOLDS(h->lo <= h->hi, h, "nothing is undecided");
        if (h->status < 0 && h->status > SGT_INVALID)
            HOLDS(!(h->lo < r.tmin) && !(h->hi > r.tmax), h, "more than the ray is undecided");
        return;
    }
    HOLDS(isfinite(h->t) && h->t_err >= 0 && h->t >= h->lo && h->t <= h->hi, h, "t");
    /* in a list without a proof one hit may stand for two roots that cannot be told apart */
    bool one = h->status == SGT_HIT && (!listed || opt->proof);
    HOLDS(!one ||
              (!((wide)h->lo > (wide)h->t - (wide)h->t_err) && !((wide)h->hi < (wide)h->t + (wide)h->t_err)),
          h, "t +- t_err is not in [lo, hi]");
    HOLDS(fabs(h->t_lo) <= h->t_err * (1 + 1e-9) || fabs(h->t_lo) <= 2 * fabs(h->t) * DBL_EPSILON, h, "t_lo");
    HOLDS(h->t <= r.tmax &&
              (h->t > r.tmin || r.tmin == -HUGE_VAL || (h->status == SGT_GRAZE && h->t >= r.tmin - 1e-300)),
          h, "t is not on the ray");
    HOLDS(isfinite(h->p.x) && isfinite(h->p.y) && isfinite(h->p.z) && h->p_err >= 0, h, "p");
    HOLDS(!isnan(h->f) || s->rises || s->kind != OWN, h, "f");
    if (s->kind == OWN && (s->sag || s->catalogue)) check_point(s, h);
    if (s->kind != OWN) return;
    double from = h->t - h->t_err, to = h->t + h->t_err;
    if (isfinite(h->t_err) && s->row->ops->enclose) {
        sgt_interval slope, g = s->row->ops->enclose(&s->with, &r,
                                                     (sgt_interval){nextafter(fmin(from, h->lo), -HUGE_VAL),
                                                                    nextafter(fmax(to, h->hi), HUGE_VAL)},
                                                     &slope);
        HOLDS(h->status == SGT_GRAZE || !(g.lo > 0 || g.hi < 0 || g.lo > g.hi), h,
              "enclose says [%a, %a] over t +- t_err", g.lo, g.hi);
    }
    /* F is not known so far below the smallest normal number */
    if (one && isfinite(h->t_err) && h->t_err > 1e-300) {
        int left = sign_of(f_at(s, &r, (wide)h->t - (wide)h->t_err)),
            right = sign_of(f_at(s, &r, (wide)h->t + (wide)h->t_err));
        if (left * right > 0 && sign_of(f_at(s, &r, (wide)h->t + (wide)h->t_lo)) == left) {
            bool turned = turns(s, &r, (wide)h->t - (wide)h->t_err, (wide)h->t + (wide)h->t_err, left);
            HOLDS(turned, h, "F has one certain sign, %d, from t - t_err to t + t_err", left);
        }
    }
}

/* Where roots certainly count: behind tmin by more than the start may hide. */
static double behind_start(const sgt_ray *r, double t)
{
    return r->tmin == -HUGE_VAL ? r->tmin
                                : r->tmin + 1e-6 * (fabs(r->tmin) + (isfinite(t) ? fabs(t) : 0)) + 1e-300;
}

static void check_absence(const subject *s, const sgt_ray *ray, const sgt_hit *h, double from, double to,
                          const char *what)
{
    wide left, right;
    sgt_ray r = plain(*ray);
    if (crosses(s, &r, from, to, &left, &right)) {
        /* the start may hide a root next to it: how far depends on the slope */
        known a = f_at(s, &r, left), b = f_at(s, &r, right);
        wide terms = 0x1p-46L *
                     (fabsl((wide)r.o.x) + fabsl((wide)r.o.y) + fabsl((wide)r.o.z) +
                      fabsl(right) * (fabsl((wide)r.d.x) + fabsl((wide)r.d.y) + fabsl((wide)r.d.z)));
        if (r.tmin != -HUGE_VAL && !(fabsl(a.f) > 1e3L * terms && fabsl(b.f) > 1e3L * terms)) return;
        HOLDS(false, h, "%s, and F is %Lg +- %Lg at t = %La, %Lg +- %Lg at %La", what, a.f, a.err, left, b.f,
              b.err, right);
    }
}

/* ---------------------------------------------------------- answers together */

static int watched;
static int count_steps(void *data, const sgt_step *step)
{
    const int *stop = data;
    watched++;
    REQUIRE(step->eval == watched, "evaluation %d is told as %d", watched, step->eval);
    REQUIRE(sgt_move_text(step->move)[0] != '?', "move %d", (int)step->move);
    return *stop > 0 && watched >= *stop;
}

static void check_watcher(const subject *s, const sgt_ray *ray, const sgt_hit *h, sgt_options opt, int stop)
{
    opt.watch = count_steps, opt.watch_data = &stop;
    watched = 0;
    sgt_hit other = sgt_intersect(s->surface, *ray, &opt);
    HOLDS(other.evals == watched, &other, "%d evaluations were watched", watched);
    if (stop > 0 && watched >= stop)
        HOLDS(other.status == SGT_STOPPED && watched == stop, &other, "stopped after %d, and it is not",
              stop);
    else if (!same_hit(h, &other)) {
        print_hit("watched", &other);
        HOLDS(false, h, "a watcher changes the answer");
    }
}

static bool counts_surely(const subject *s, const sgt_ray *r, const sgt_hit *h)
{
    if (!(h->t - h->t_err > behind_start(r, h->t)) || !(h->t + h->t_err < r->tmax - 1e-6 * fabs(h->t)))
        return false;
    double a = s->rim;
    return !(a > 0) || hypot(h->p.x, h->p.y) + h->p_err < a * (1 - 1e-6);
}

/* Two answers to one ray, where both are certain of themselves. */
static void check_pair(const subject *s, const sgt_ray *ray, const sgt_hit *a, const sgt_hit *b,
                       bool same_root, const char *what)
{
    sgt_ray r = plain(*ray);
    if (a->status == SGT_MISS || b->status == SGT_MISS) {
        const sgt_hit *hit = a->status == SGT_MISS ? b : a;
        if (hit->status == SGT_HIT && counts_surely(s, &r, hit)) {
            print_hit("the other", b);
            HOLDS(false, a, "a hit and a miss: %s", what);
        }
        return;
    }
    if (!same_root || a->status != SGT_HIT || b->status != SGT_HIT || !counts_surely(s, &r, a) ||
        !counts_surely(s, &r, b))
        return;
    if (fabsl((wide)a->t - (wide)b->t) <= ((wide)a->t_err + (wide)b->t_err) * (1 + 1e-15L)) return;
    print_hit("the other", b);
    HOLDS(false, a, "two roots: %s", what);
}

static void check_list(const subject *s, const sgt_ray *ray, const sgt_hit *first, const sgt_options *opt,
                       int cap)
{
    static sgt_hit all[MOST_HITS], some[MOST_HITS];
    sgt_ray r = plain(*ray);
    int count = sgt_intersect_all(s->surface, *ray, MOST_HITS, all, opt),
        again = sgt_intersect_all(s->surface, *ray, cap, cap ? some : NULL, opt);
    HOLDS(count == again, first, "%d hits, and with room for %d, %d", count, cap, again);
    if (count < 0) {
        HOLDS(count == SGT_INVALID && first->status == SGT_INVALID, first, "the list says %d", count);
        return;
    }
    HOLDS(first->status != SGT_INVALID, first, "the list says %d", count);
    int kept = count < MOST_HITS ? count : MOST_HITS;
    for (int i = 0; i < kept && i < cap; i++)
        if (!same_hit(&all[i], &some[i])) {
            print_hit("of a short list", &some[i]);
            HOLDS(false, &all[i], "entry %d depends on the room", i);
        }
    double from = behind_start(&r, first->t);
    bool certain = s->kind == OWN && !(opt->dt_min > 0 && s->row->ops->estimate);
    for (int i = 0; i < kept; i++) {
        check_hit(s, ray, &all[i], opt, true);
        if (i > 0 && (all[i].status == SGT_EXHAUSTED || all[i].status == SGT_STOPPED))
            HOLDS(i + 1 == count && all[i].lo >= all[i - 1].t, &all[i],
                  "what is left of the ray begins before %a, or is not the last of %d", all[i - 1].t, count);
        if (i > 0)
            HOLDS(all[i].t >= all[i - 1].t || all[i].status < 0 || all[i - 1].status < 0, &all[i],
                  "entry %d comes before the one before, at %a", i, all[i - 1].t);
        if (certain) check_absence(s, ray, &all[i], from, all[i].lo, "a list has nothing before this");
        from = fmax(all[i].hi, from); /* t + t_err as a double may be t */
    }
    if (!certain) return;
    if (count == kept &&
        !(count > 0 && (all[count - 1].status == SGT_EXHAUSTED || all[count - 1].status == SGT_STOPPED)))
        check_absence(s, ray, first, from, r.tmax, "a list has nothing behind");
    if (count == 0) {
        check_pair(s, ray, first, &(sgt_hit){.status = SGT_MISS}, false, "the list is empty");
        return;
    }
    if (first->status == SGT_MISS) {
        for (int i = 0; i < kept; i++)
            if (all[i].status == SGT_HIT) check_pair(s, ray, first, &all[i], false, "an entry of the list");
    } else if (first->status == SGT_HIT && counts_surely(s, &r, first)) {
        bool told = count > kept;
        for (int i = 0; i < kept; i++)
            told = told || ((wide)all[i].lo <= (wide)first->t + (wide)first->t_err &&
                            (wide)all[i].hi >= (wide)first->t - (wide)first->t_err);
        if (!told) print_hit("the list's first", &all[0]);
        HOLDS(told, first, "the list of %d does not have it", count);
        if (opt->pick != SGT_NEAR_SEED && all[0].status == SGT_HIT && counts_surely(s, &r, &all[0]))
            check_pair(s, ray, first, &all[0], true, "the first, and the list's first");
    }
}

static sgt_hit check_ray(const subject *s, const sgt_ray *ray, sgt_options opt, unsigned how)
{
    now_ray = *ray, now_opt = opt;
    bool good = ray_is_valid(ray) && options_are_valid(&opt);
    sgt_ray r = plain(*ray);
    sgt_hit hit = sgt_intersect(s->surface, *ray, &opt);
    if (s->kind == OWN)
        HOLDS((hit.status == SGT_INVALID) == !(good && s->valid), &hit,
              "is it valid?  ray %d, options %d, surface %d", ray_is_valid(ray), options_are_valid(&opt),
              s->valid);
    else
        HOLDS((hit.status == SGT_INVALID) == !good, &hit, "is it valid?  ray %d, options %d",
              ray_is_valid(ray), options_are_valid(&opt));
    check_hit(s, ray, &hit, &opt, false);
    if (hit.status == SGT_INVALID) {
        HOLDS(sgt_intersect_all(s->surface, *ray, 0, NULL, &opt) == SGT_INVALID, &hit, "of a list it is not");
        return hit;
    }
    if (opt.max_evals && s->kind == OWN && opt.pick != SGT_NEAR_SEED)
        HOLDS(hit.status != SGT_EXHAUSTED || hit.evals >= opt.max_evals, &hit, "exhausted too soon");
    bool certain = s->kind == OWN && !(opt.dt_min > 0 && s->row->ops->estimate);
    if (certain && hit.status == SGT_MISS) check_absence(s, ray, &hit, behind_start(&r, 0), r.tmax, "a miss");
    if (certain && hit.status == SGT_HIT && opt.pick != SGT_NEAR_SEED)
        check_absence(s, ray, &hit, behind_start(&r, hit.t), hit.lo, "it is the first");
    check_watcher(s, ray, &hit, opt, how & 1 ? (int)(how >> 1 & 15) : 0);
    check_list(s, ray, &hit, &opt, (int)(how >> 5 & 3));
    if (certain) {
        sgt_options other = opt;
        /* of several near the seed the seed leads to one */
        bool leads = opt.pick != SGT_NEAR_SEED || (s->rises && ray->d.z != 0);
        for (int proof = SGT_ESTIMATE; proof <= (int)SGT_PROVE_FIRST; proof++) {
            other.proof = (sgt_proof)proof;
            sgt_hit o = sgt_intersect(s->surface, *ray, &other);
            check_hit(s, ray, &o, &other, false);
            check_pair(s, ray, &hit, &o, leads, "under another proof");
        }
        other = opt, other.pick = opt.pick == SGT_NEAR_SEED ? SGT_FIRST : SGT_NEAR_SEED;
        sgt_hit o = sgt_intersect(s->surface, *ray, &other);
        check_hit(s, ray, &o, &other, false);
        check_pair(s, ray, &hit, &o, false, "of another pick");
        now_opt = opt;
    }
    return hit;
}

static void check_batch(const subject *s, size_t n, const sgt_ray ray[], const sgt_hit alone[], int distinct,
                        const sgt_options *opt, unsigned how)
{
    static double in[8][MOST_LANES], out[10][MOST_LANES];
    static sgt_status status[MOST_LANES];
    static int evals[MOST_LANES];
    size_t positive = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_ray *r = &ray[i % (size_t)distinct];
        const double numbers[8] = {r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z, r->tmin, end_of(r)};
        for (int k = 0; k < 8; k++) in[k][i] = numbers[k];
        positive += alone[i % (size_t)distinct].status > 0;
    }
    sgt_rays rays = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, in[6], in[7]};
    sgt_hits hits = {.status = how & 1 ? NULL : status,
                     .evals = how & 2 ? NULL : evals,
                     .t = out[0],
                     .t_err = how & 4 ? NULL : out[1],
                     .t_lo = how & 8 ? NULL : out[2],
                     .p = {out[3], out[4], out[5]},
                     .n = {out[6], out[7], out[8]},
                     .p_err = how & 8 ? NULL : out[9]};
    if (how & 16) hits.p[0] = hits.p[1] = hits.p[2] = NULL;
    if (how & 32) hits.n[0] = hits.n[1] = hits.n[2] = NULL;
    size_t told = sgt_intersect_batch(s->surface, n, rays, hits, opt);
    for (size_t i = 0; i < n; i++) {
        const sgt_hit *a = &alone[i % (size_t)distinct];
        sgt_hit b = *a; /* but for what was asked for */
        if (hits.status) b.status = (sgt_status)status[i];
        if (hits.evals) b.evals = evals[i];
        b.t = out[0][i];
        if (hits.t_err) b.t_err = out[1][i];
        if (hits.t_lo) b.t_lo = out[2][i], b.p_err = out[9][i];
        if (hits.p[0]) b.p = (sgt_vec3){out[3][i], out[4][i], out[5][i]};
        if (hits.n[0]) b.n = (sgt_vec3){out[6][i], out[7][i], out[8][i]};
        if (!same_hit(a, &b)) {
            now_ray = ray[i % (size_t)distinct];
            print_hit("in a batch", &b);
            HOLDS(false, a, "ray %zu of %zu differs in a batch, outputs %x", i, n, how & 63);
        }
    }
    REQUIRE(told == positive, "%zu positive, and %zu are told", positive, told);
}

static void check_enclosure(const subject *s, const sgt_ray *ray, sgt_interval t)
{
    if (!s->valid || !s->row->ops->enclose || !ray_is_valid(ray) || !isfinite(t.lo) || !isfinite(t.hi))
        return;
    if (t.lo > t.hi) t = (sgt_interval){t.hi, t.lo};
    sgt_interval slope = {0, 0}, g = s->row->ops->enclose(&s->with, ray, t, &slope);
    wide before = NAN, at_before = 0, before_err = 0;
    for (int i = 0; i <= 8; i++) {
        wide at = i == 0 ? (wide)t.lo : i == 8 ? (wide)t.hi : (wide)t.lo + ((wide)t.hi - (wide)t.lo) * i / 8;
        if (!s->sag) at = fminl(fmaxl((wide)(double)at, (wide)t.lo), (wide)t.hi);
        known k = f_at(s, ray, at);
        if (isnan(k.f) || !(k.err < HUGE_VAL)) {
            before = NAN;
            continue;
        }
        now_ray = *ray;
        if (g.lo > g.hi || k.f + k.err < (wide)g.lo || k.f - k.err > (wide)g.hi ||
            (!isnan(before) && (slope.lo > slope.hi))) {
            print_now();
            REQUIRE(false, "enclose says [%a, %a] over [%a, %a], and F is %Lg +- %Lg at %La", g.lo, g.hi,
                    t.lo, t.hi, k.f, k.err, at);
        }
        if (!isnan(before) && at > at_before && s->sag) { /* the mean value theorem: the domain is convex */
            wide mean = (k.f - before) / (at - at_before),
                 err = (k.err + before_err) / (at - at_before) + 0x1p-60L * fabsl(mean);
            if (mean + err < (wide)slope.lo || mean - err > (wide)slope.hi) {
                print_now();
                REQUIRE(
                    false,
                    "enclose has the slope [%a, %a] over [%a, %a], and it is %Lg +- %Lg on the way to %La",
                    slope.lo, slope.hi, t.lo, t.hi, mean, err, at);
            }
        }
        before = k.f, before_err = k.err, at_before = at;
    }
}

/* -------------------------------------------------------------------- traces */

static bool same_passage(const sgt_passage *a, const sgt_passage *b)
{
    return same_hit(&a->hit, &b->hit) && same_vector(a->direction, b->direction) && same(a->opl, b->opl);
}

static void check_trace(const subject *s, bytes *b, size_t n, const sgt_ray ray[], const sgt_options *opt)
{
    enum { MOST_ELEMENTS = 3 };
    static const double indices[] = {0,           1,   1.5,   SGT_MIRROR, 1.33, -2,
                                     (double)NAN, 0.5, 1e300, 1e-300,     4,    (double)INFINITY};
    sgt_conic other[MOST_ELEMENTS];
    sgt_element e[MOST_ELEMENTS];
    size_t elements = (size_t)take_int(b, 1, MOST_ELEMENTS);
    double before = indices[take_int(b, 0, 11)];
    for (size_t i = 0; i < elements; i++) {
        unsigned how = take_byte(b);
        e[i] = (sgt_element){.surface = s->surface, .index = indices[(how >> 4) % 12]};
        if (how & 1) {
            other[i] = (sgt_conic){.c = take_number(b)};
            other[i].k = take_number(b);
            e[i].surface = (sgt_surface){&sgt_conic_ops, &other[i]};
        }
        if (how & 2) e[i].pose.origin = take_vector(b);
        if (how & 4) e[i].pose = sgt_pose_tilted(e[i].pose.origin, take_vector(b));
        if (how & 8) e[i].semi_diameter = fabs(take_number(b));
    }
    static double in[6][MOST_RAYS], out[6][MOST_RAYS], opl[MOST_RAYS], met[MOST_ELEMENTS][15][MOST_RAYS];
    static sgt_fate fates[MOST_RAYS];
    static sgt_status status[MOST_ELEMENTS][MOST_RAYS];
    static int passed[MOST_RAYS], evals[MOST_ELEMENTS][MOST_RAYS];
    sgt_passages passages[MOST_ELEMENTS];
    for (size_t i = 0; i < n; i++) {
        const double numbers[6] = {ray[i].o.x, ray[i].o.y, ray[i].o.z, ray[i].d.x, ray[i].d.y, ray[i].d.z};
        for (int k = 0; k < 6; k++) in[k][i] = numbers[k];
    }
    for (size_t k = 0; k < elements; k++)
        passages[k] = (sgt_passages){
            .hits = {.status = status[k],
                     .evals = evals[k],
                     .t = met[k][0],
                     .t_err = met[k][1],
                     .t_lo = met[k][2],
                     .p = {met[k][3], met[k][4], met[k][5]},
                     .n = {met[k][6], met[k][7], met[k][8]},
                     .p_err = met[k][9]},
            .direction = {met[k][10], met[k][11], met[k][12]},
            .opl = met[k][13],
        };
    size_t all = sgt_trace_batch(
               elements, e, before, n, (sgt_rays){{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, NULL, NULL},
               (sgt_traced){fates, passed, {out[0], out[1], out[2]}, {out[3], out[4], out[5]}, opl, {0}},
               passages, opt),
           whole = 0;
    for (size_t i = 0; i < n; i++) {
        sgt_ray r = ray[i];
        sgt_passage one[MOST_ELEMENTS];
        sgt_fate fate;
        now_ray = r;
        size_t through = sgt_trace(elements, e, before, &r, one, &fate, opt);
        const sgt_hit *last = &one[through < elements ? through : elements - 1].hit;
        whole += through == elements;
        HOLDS(through <= elements && fate >= SGT_LOST && fate <= SGT_EVANESCENT &&
                  (fate == SGT_PASSED) == (through == elements),
              last, "passed %zu of %zu, fate %d", through, elements, (int)fate);
        HOLDS(fate == (sgt_fate)fates[i] && (int)through == passed[i], last,
              "passed %zu, fate %d; in a batch %d, %d", through, (int)fate, passed[i], (int)fates[i]);
        HOLDS(same_vector(r.o, (sgt_vec3){out[0][i], out[1][i], out[2][i]}) &&
                  same_vector(r.d, (sgt_vec3){out[3][i], out[4][i], out[5][i]}),
              last, "the ray at return differs in a batch");
        if (fate == SGT_MISSED) HOLDS(last->status == SGT_MISS, last, "missed");
        if (fate == SGT_LOST) HOLDS(last->status < 0, last, "lost");
        if (fate == SGT_CLIPPED || fate == SGT_TIR) HOLDS(last->status > 0, last, "fate %d", (int)fate);
        double index = before == 0 ? 1 : before;
        for (size_t k = 0; k < elements; k++) {
            bool reached = k <= through, sound = index > 0 && isfinite(index);
            sgt_passage many = {.hit = {.status = (sgt_status)status[k][i],
                                        .evals = evals[k][i],
                                        .t = met[k][0][i],
                                        .t_err = met[k][1][i],
                                        .t_lo = met[k][2][i],
                                        .p = {met[k][3][i], met[k][4][i], met[k][5][i]},
                                        .n = {met[k][6][i], met[k][7][i], met[k][8][i]},
                                        .p_err = met[k][9][i]},
                                .direction = {met[k][10][i], met[k][11][i], met[k][12][i]},
                                .opl = met[k][13][i]};
            if (!reached) {
                HOLDS(many.hit.status == SGT_MISS && many.hit.evals == 0 && isnan(many.hit.t) &&
                          isnan(many.opl) && many.direction.x == 0,
                      &many.hit, "element %zu was not reached", k);
                continue;
            }
            many.hit.lo = one[k].hit.lo, many.hit.hi = one[k].hit.hi, many.hit.f = one[k].hit.f;
            if (!same_passage(&one[k], &many)) {
                print_hit("in a batch", &many.hit);
                HOLDS(false, &one[k].hit, "element %zu differs in a batch: opl %a %a, direction %a %a %a", k,
                      one[k].opl, many.opl, one[k].direction.x, many.direction.x, one[k].direction.z);
            }
            double own = e[k].index;
            sound = sound && (own == SGT_MIRROR || own == 0 || (own > 0 && isfinite(own)));
            if (!sound)
                HOLDS(one[k].hit.status == SGT_INVALID, &one[k].hit, "element %zu, index %a behind %a", k,
                      own, index);
            if (k < through) {
                sgt_vec3 d = one[k].direction;
                HOLDS(one[k].hit.status > 0 && fabs(d.x * d.x + d.y * d.y + d.z * d.z - 1) < 1e-14,
                      &one[k].hit, "element %zu: direction %a %a %a", k, d.x, d.y, d.z);
                HOLDS(!(e[k].semi_diameter > 1e-140 && e[k].semi_diameter < 1e150) ||
                          !(hypot(one[k].hit.p.x, one[k].hit.p.y) > e[k].semi_diameter * (1 + 0x1p-40)),
                      &one[k].hit, "element %zu: passed outside %a", k, e[k].semi_diameter);
            }
            if (own != SGT_MIRROR && own != 0) index = own;
        }
    }
    REQUIRE(all == whole, "%zu passed, and %zu are told", whole, all);
}

/* ------------------------------------------------------------- the bare solver */

static void check_root(bytes *b)
{
    sgt_span span;
    span.lo = take_number(b), span.hi = take_number(b), span.seed = take_number(b),
    span.single = take_byte(b) & 1;
    sgt_options opt = take_options(b);
    unsigned how = take_byte(b);
    double g_err = fabs(take_number(b)), shift = take_number(b), slope_off = take_number(b);
    sgt_root r = sgt_root_begin(span, &opt);
    bool invalid = !(span.lo <= span.hi) || span.lo == HUGE_VAL || span.hi == -HUGE_VAL ||
                   !options_are_valid(&opt);
    REQUIRE((r.status == SGT_INVALID) == invalid, "[%a, %a], status %d", span.lo, span.hi, (int)r.status);
    r.g_err = g_err;
    int calls = 0, budget = opt.max_evals > 0 ? opt.max_evals : 2000;
    for (bool more = true; more && calls < budget + 8; calls++) {
        double t = r.t, g, slope;
        if (!invalid)
            REQUIRE(isfinite(t) && t >= span.lo && t <= span.hi, "asks for %a, outside [%a, %a]", t, span.lo,
                    span.hi);
        switch (how & 7) {
        case 0: g = t - shift, slope = 1; break;
        case 1: g = (t - shift) * (t - shift), slope = 2 * (t - shift); break;
        case 2: g = (t - shift) * (t - shift) * (t - shift), slope = 3 * (t - shift) * (t - shift); break;
        case 3: g = 1 / (t - shift), slope = -g * g; break;
        case 4: g = t < shift ? (double)NAN : sqrt(t - shift) - 1, slope = 0.5 / (g + 1); break;
        case 5: g = t < shift ? -1 : 1, slope = 0; break;
        case 6:
            g = lie(&shift, (const double[]){t, t, t}, 3, 0),
            slope = lie(&shift, (const double[]){t, t, t}, 3, 1);
            break;
        default: g = b->left ? take_number(b) : cos(t), slope = b->left ? take_number(b) : -sin(t); break;
        }
        if (how & 8) slope *= slope_off;
        if (how & 16) slope += slope_off;
        more = sgt_root_next(&r, g, slope);
    }
    REQUIRE(!invalid || calls == 1, "%d calls of an invalid one", calls);
    REQUIRE(calls <= budget + 1, "%d evaluations, and %d are the most", calls, budget);
    REQUIRE(r.status >= SGT_INVALID && r.status <= SGT_GRAZE && r.status != SGT_STOPPED, "status %d",
            (int)r.status);
    if (r.status > 0) {
        REQUIRE(isfinite(r.t) && r.t >= span.lo && r.t <= span.hi && r.t_err >= 0, "t %a, t_err %a", r.t,
                r.t_err);
        /* A function that does not lie, and its slope as it is: the root is where it is told (a pole is one
         * to this solver), but for where a power of t - shift underflows to zero, which g_err = 0 denies. */
        static const wide zero_within[] = {0x1p-1074L, 0x1p-537L, 0x1p-358L, 0x1p-1074L};
        if (r.status == SGT_HIT && opt.f_tol == 0 && g_err == 0 && (how & 7) < 4)
            REQUIRE(fabsl((wide)r.t - (wide)shift)
                        <= (wide)r.t_err + 2 * (wide)fabs(shift) * 0x1p-53L + zero_within[how & 7],
                    "t %a +- %a, and the root is %a", r.t, r.t_err, shift);
    }
}

/* ------------------------------------------------------------------------ all */

static sgt_surface surface_of(const subject *s)
{
    return (sgt_surface){s->kind == OWN ? s->row->ops : &s->ops, &s->with};
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes b = {.at = data, .left = size};
    if (size < 4) return 0;
    unsigned what = take_byte(&b);
    if ((what & 7) == 7) return check_root(&b), 0;
    static subject s;
    s = take_subject(&b);
    s.surface = surface_of(&s);
    now = seen = &s;
    sgt_options opt = take_options(&b);
    int distinct = 1 + (int)(what >> 3 & 3);
    unsigned how = take_byte(&b), outputs = take_byte(&b);
    sgt_ray ray[MOST_RAYS] = {{{0, 0, -5}, {0, 0, 1}, 0, (double)INFINITY}};
    sgt_hit alone[MOST_RAYS];
    for (int i = 0; i < distinct; i++) {
        ray[i] = take_ray(&b, &s, &ray[i ? i - 1 : 0]);
        alone[i] = check_ray(&s, &ray[i], opt, how);
    }
    check_batch(&s, (size_t)distinct + (what >> 5) * 2, ray, alone, distinct, &opt, outputs);
    if (s.kind == OWN)
        for (int i = 0; i < 2; i++) {
            double lo = take_number(&b), hi = take_number(&b);
            check_enclosure(&s, &ray[i % distinct], (sgt_interval){lo, hi});
        }
    if ((what & 3) == 1) check_trace(&s, &b, (size_t)distinct, ray, &opt);
    if ((what & 7) == 2 && (s.valid || !s.catalogue)) {
        sgt_vec3 where;
        sgt_fault fault = sgt_check(s.surface, (size_t)distinct, ray, &where);
        REQUIRE(sgt_fault_text(fault)[0] != '?', "fault %d", (int)fault);
    }
    return 0;
}
