// SPDX-License-Identifier: MIT
/* test_range.c - what an answer's numbers owe each other, whatever the exponents of a question are.
 *
 *   random      parameters, rays and options of any exponents, now and then zero, subnormal or the largest
 *               there are, of every
 *               row of sgt_builtins: of a hit t is finite and within [lo, hi] and the ray's ends, t_err and
 *                   p_err are at
 *               least 0, the point is a number, and inside the rim; of what is undecided [lo, hi] is a part
 *                   of the ray; of an
 *               entry of a list t is a number, and t +- t_err covers [lo, hi].  A batch says the same bits.
 *   in it       a ray that lies in a surface that is flat, of each type: a graze whose t is where it begins
 *               to count,
 *               inside the rim; a miss where it passes the rim by; else undecided; at lengths of d from
 *                   2^-800
 *               to 2^1000.
 *   along       rays along the axis whose t in lengths of d is beyond the largest double: UNPROVEN.
 *   stretched   F = z - P(x, y) with z, the ray's z and the coefficients times 2^-k has the roots it had:
 *               what underflows as k
 *               grows to 1060 is in t_err.  Rays that have two roots or none, a double one between. */
#include "../ends.h"
#include "unit.h"

#include <sagitta/surfaces.h>

enum { MOST = 4, NUMBERS = 64 };

static double pool[NUMBERS];
static size_t pooled;

/* A number of any exponent, now and then one of the ends of what there is. */
static double any(generator *g)
{
    static const double ends[] = {0, 1, DBL_MAX, DBL_MIN, 0x1p-1074, 0x1p1023, 1e150, 1e155, 1e-160, 0.5, 3};
    double x = chance(g, 0.25) ? ends[below(g, COUNT_OF(ends))]
                               : ldexp(uniform(g, 1, 2), below(g, 2098) - 1074);
    if (chance(g, 0.3)) x = ldexp(uniform(g, 1, 2), below(g, 40) - 20);
    return either_sign(g) * x;
}

typedef union parameters { double number[128]; sgt_biconic biconic; } parameters;

static sgt_surface term;
static sgt_odd_asphere of_term;

/* Each parameter by `make`, of those that are not lists. */
static void fill(generator *g, const sgt_builtin *b, parameters *with, double (*make)(generator *))
{
    memset(with, 0, sizeof *with);
    pooled = 0;
    for (const sgt_param *p = b->params; p->name; p++) {
        unsigned char *to = (unsigned char *)with + p->offset;
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            size_t rows = p->kind == SGT_PARAM_LIST ? 1 : 4, columns = 4;
            sgt_numbers n = {&pool[pooled], rows, columns};
            for (size_t i = 0; i < rows * columns; i++) pool[pooled++] = chance(g, 0.5) ? 0 : make(g);
            memcpy(to, &n, sizeof n);
        } else if (p->kind == SGT_PARAM_TERMS) {
            of_term = (sgt_odd_asphere){.a = {0, make(g), chance(g, 0.5) ? 0 : make(g), make(g)}};
            term = (sgt_surface){&sgt_odd_asphere_ops, &of_term};
            sgt_sum *sum = (sgt_sum *)(void *)with;
            sum->terms = &term, sum->count = 1;
        } else if (p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
            int whole = p->kind == SGT_PARAM_WORD ? 1 + below(g, 2) : below(g, 2);
            memcpy(to, &whole, sizeof whole);
        } else if (p->kind == SGT_PARAM_WHOLE) {
            continue;
        } else if (strcmp(p->name, "slice") != 0) {
            for (int i = 0; i < p->count; i++) {
                double x = chance(g, 0.3) ? 0 : make(g);
                if (p->lo >= 0) x = fabs(x);
                if (p->lo > 0 || strncmp(p->name, "norm", 4) == 0 || strncmp(p->name, "step", 4) == 0)
                    x = fabs(make(g));
                memcpy(to + (size_t)i * sizeof x, &x, sizeof x);
            }
        }
    }
}

static double rim_of(const sgt_builtin *b, const parameters *with)
{
    double rim = 0;
    for (const sgt_param *p = b->params; p->name; p++)
        if (strcmp(p->name, "semi_diameter") == 0)
            memcpy(&rim, (const unsigned char *)with + p->offset, sizeof rim);
    return rim < 0x1p500 ? rim : 0; /* that is none */
}

static void print_case(const sgt_builtin *b, const parameters *with, const sgt_ray *r, const sgt_options *o)
{
    print_message("%s:", b->type);
    for (size_t i = 0; i < b->size / sizeof(double); i++) print_message(" %a", with->number[i]);
    for (size_t i = 0; i < pooled; i++) print_message(" [%a]", pool[i]);
    print_message("\nray {{%a, %a, %a}, {%a, %a, %a}, %a, %a} ", r->o.x, r->o.y, r->o.z, r->d.x, r->d.y,
                  r->d.z, r->tmin, r->tmax);
    print_message("t_tol %a proof %d pick %d\n", o->t_tol, (int)o->proof, (int)o->pick);
}

static void check(const sgt_builtin *b, const parameters *with, const sgt_ray *r, const sgt_options *o,
                  const sgt_hit *h, bool listed)
{
    const char *wrong = NULL;
    long double rim = rim_of(b, with), r2 = (long double)h->p.x * h->p.x + (long double)h->p.y * h->p.y;
    bool number = fabs(h->t) < FAR && h->t_err >= 0;
    if (h->status > 0) {
        bool begins = h->t > r->tmin || r->tmin == -FAR || (h->status == SGT_GRAZE && h->t == r->tmin);
        if (!(number && h->t >= h->lo && h->t <= h->hi)) wrong = "t, t_err";
        else if (!(begins && h->t <= r->tmax)) wrong = "not on the ray";
        else if (!(fabs(h->p.x) < FAR && fabs(h->p.y) < FAR && fabs(h->p.z) < FAR && h->p_err >= 0))
            wrong = "p, p_err";
        else if (rim > 0 && !(r2 <= rim * rim * (1 + 0x1p-44L + 0x1p-50L) + 1e-320L))
            wrong = "outside the rim";
    } else if (h->status < 0 && h->status != SGT_INVALID) {
        if (!(h->lo <= h->hi && h->lo >= r->tmin && h->hi <= r->tmax))
            wrong = "what is undecided is not on the ray";
        else if (listed && !(number && h->t - h->t_err <= h->lo && h->t + h->t_err >= h->hi))
            wrong = "no stretch";
    }
    if (!wrong) return;
    print_case(b, with, r, o);
    fail_msg("%s: %s%s: t %a +- %a in [%a, %a], p %a %a %a", wrong, listed ? "an entry that is " : "",
             sgt_status_text(h->status), h->t, h->t_err, h->lo, h->hi, h->p.x, h->p.y, h->p.z);
}

/* Alone, of all roots and in a batch. */
static sgt_hit ask(const sgt_builtin *b, const parameters *with, sgt_ray r, const sgt_options *o)
{
    sgt_hit list[MOST], h = sgt_intersect((sgt_surface){b->ops, with}, r, o);
    int n = sgt_intersect_all((sgt_surface){b->ops, with}, r, MOST, list, o), evals;
    double t, t_err;
    sgt_status status;
    r.tmax = end_of(&r);
    sgt_intersect_batch((sgt_surface){b->ops, with}, 1,
                        (sgt_rays){{&r.o.x, &r.o.y, &r.o.z}, {&r.d.x, &r.d.y, &r.d.z}, &r.tmin, &r.tmax},
                        (sgt_hits){.status = &status, .evals = &evals, .t = &t, .t_err = &t_err}, o);
    check(b, with, &r, o, &h, false);
    for (int i = 0; i < n && i < MOST; i++) check(b, with, &r, o, &list[i], true);
    if (status != h.status || evals != h.evals ||
        (h.status > 0 && !(same_bits(t, h.t) && same_bits(t_err, h.t_err)))) {
        print_case(b, with, &r, o);
        fail_msg("%s, t %a +- %a; in a batch %s, t %a +- %a", sgt_status_text(h.status), h.t, h.t_err,
                 sgt_status_text((sgt_status)status), t, t_err);
    }
    return h;
}

static void test_random(void **state)
{
    (void)state;
    generator g = seeded("random");
    long told[7] = {0};
    for (long i = 0, n = scaled(100); i < n; i++)
        for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
            parameters with;
            fill(&g, b, &with, any);
            sgt_ray r = {{any(&g), any(&g), any(&g)}, {any(&g), any(&g), any(&g)}, 0, FAR};
            if (chance(&g, 0.3))
                r.o.z = chance(&g, 0.5) ? 0 : ldexp(r.o.z, -1000), r.d.z = chance(&g, 0.5) ? 0 : r.d.z;
            if (chance(&g, 0.2)) r.d.x = r.d.y = 0;
            if (chance(&g, 0.3)) r.tmin = -FAR;
            else if (chance(&g, 0.3)) r.tmin = -fabs(any(&g));
            if (chance(&g, 0.3)) r.tmax = any(&g);
            sgt_options o = {
                .pick = (sgt_pick)below(&g, 3), .proof = (sgt_proof)below(&g, 3), .max_evals = 300};
            if (chance(&g, 0.3)) o.t_tol = fabs(any(&g));
            sgt_hit h = ask(b, &with, r, &o);
            told[h.status + 4 > 0 ? h.status + 4 : 0]++;
        }
    printf("%ld hits, %ld grazes, %ld misses, %ld unproven\n", told[5], told[6], told[4], told[3]);
}

/* ---------------------------------------------------------------------- in a flat one */

static double nothing(generator *g)
{
    (void)g;
    return 0;
}

static void test_in_it(void **state)
{
    (void)state;
    generator g = seeded("in it");
    long grazes = 0, misses = 0, open = 0;
    for (long i = 0, n = scaled(40); i < n; i++)
        for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
            parameters with;
            double rim = chance(&g, 0.2) ? 0 : ldexp(uniform(&g, 1, 2), below(&g, 200) - 100), one = 1;
            bool sag = false;
            fill(&g, b, &with, nothing);
            for (const sgt_param *p = b->params; p->name; p++) {
                if (strcmp(p->name, "semi_diameter") == 0)
                    sag = true, memcpy((unsigned char *)&with + p->offset, &rim, sizeof rim);
                if (strncmp(p->name, "norm", 4) == 0 && p->kind == SGT_PARAM_REAL)
                    memcpy((unsigned char *)&with + p->offset, &one, sizeof one);
                if (strncmp(p->name, "step", 4) == 0) sag = false; /* a grid ends */
            }
            if (strcmp(b->type, "grid") == 0 || !sag) continue;
            double size = rim > 0 ? rim : ldexp(1, below(&g, 200) - 100), by = uniform(&g, 0, 2) * size;
            double a = uniform(&g, 0, 7), length = ldexp(1, chance(&g, 0.3) ? below(&g, 1800) - 800 : 0);
            if (chance(&g, 0.3)) by = 0;
            if (chance(&g, 0.2)) a = 0;
            double from = uniform(&g, -5, 2) * size;
            sgt_ray r = {{from * cos(a) - by * sin(a), from * sin(a) + by * cos(a), 0},
                         {cos(a) * length, sin(a) * length, 0},
                         0,
                         FAR};
            if (chance(&g, 0.3)) r.tmin = -FAR;
            else if (chance(&g, 0.3)) r.tmin = uniform(&g, 0, 5) * size / length;
            if (!(r.tmin < FAR)) r.tmin = 0;
            sgt_options o = {.pick = (sgt_pick)below(&g, 3), .proof = (sgt_proof)below(&g, 3)};
            sgt_hit h = ask(b, &with, r, &o);
            bool by_it = rim > 0 && by > rim * (1 + 1e-9), into = rim == 0 || by < rim * (1 - 1e-9);
            bool behind = rim > 0 && r.tmin > -FAR && by < rim &&
                          from + r.tmin * length > sqrt(rim * rim - by * by) * (1 - 1e-9);
            if (h.status == SGT_MISS ? into && !behind : h.status == SGT_HIT || (by_it && h.status > 0)) {
                print_case(b, &with, &r, &o);
                fail_msg("%s, t %a, p %a %a", sgt_status_text(h.status), h.t, h.p.x, h.p.y);
            }
            if (h.status > 0 && rim > 0 && into && by < 0.9 * rim && length == 1) { /* where it begins */
                double enters = -from - sqrt(rim * rim - by * by), begins = r.tmin > enters ? r.tmin : enters;
                if (!(fabs(h.t - begins) <= 1e-6 * size)) {
                    print_case(b, &with, &r, &o);
                    fail_msg("graze at %a, and it begins at %a", h.t, begins);
                }
            }
            grazes += h.status > 0, misses += h.status == 0, open += h.status < 0;
        }
    printf("%ld grazes, %ld misses, %ld open\n", grazes, misses, open);
    REQUIRE(grazes > open, "%ld grazes, %ld open", grazes, open);
}

/* --------------------------------------------------------------------- along the axis */

static double moderate(generator *g) { return ldexp(uniform(g, 1, 2), below(g, 6) - 8); }

static void test_along(void **state)
{
    (void)state;
    generator g = seeded("along");
    for (long i = 0, n = scaled(40); i < n; i++)
        for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
            parameters with;
            fill(&g, b, &with, moderate);
            double far = ldexp(uniform(&g, 1, 2), 10 + below(&g, 20)),
                   length = ldexp(uniform(&g, 1, 2), below(&g, 8) - 1022);
            sgt_ray r = {{chance(&g, 0.5) ? 0 : 0x1p-20, 0, either_sign(&g) * far},
                         {0, 0, either_sign(&g) * length},
                         0,
                         FAR};
            if (chance(&g, 0.5)) r.tmin = -FAR;
            if (chance(&g, 0.3)) r.d.x = length;
            for (int proof = 0; proof < 3; proof++)
                ask(b, &with, r, &(sgt_options){.proof = (sgt_proof)proof, .pick = (sgt_pick)below(&g, 3)});
        }
}

/* ------------------------------------------------------------------------- stretched */

/* Few bits, so that times 2^-k it is exact as long as there is one. */
static double round_number(generator *g) { return either_sign(g) * ldexp(1 + below(g, 8), -4); }

/* *x times 2^-k; false: not exactly. */
static bool stretch(double *x, int k)
{
    double before = *x;
    *x = ldexp(before, -k);
    return ldexp(*x, k) == before;
}

static void test_stretched(void **state)
{
    (void)state;
    generator g = seeded("stretched");
    static const char *const kinds[] = {"even_asphere", "odd_asphere", "polynomial_xy", "chebyshev",
                                        "zernike", "q_con", "grid", "sum"};
    long hits = 0, open = 0;
    for (long i = 0, n = scaled(100); i < n; i++)
        for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
            bool wanted = false;
            for (size_t j = 0; j < COUNT_OF(kinds); j++) wanted = wanted || strcmp(b->type, kinds[j]) == 0;
            if (!wanted) continue;
            parameters with, stretched;
            fill(&g, b, &with, round_number);
            int k = 900 + below(&g, 165);
            double kept[NUMBERS], rim = chance(&g, 0.5) ? 0 : 4;
            sgt_odd_asphere kept_term = of_term;
            for (const sgt_param *p = b->params; p->name; p++) {
                double *at = (double *)(void *)((unsigned char *)&with + p->offset), minus = -1;
                if (strcmp(p->name, "conic") == 0) *at = minus;
                if (strcmp(p->name, "semi_diameter") == 0) *at = rim;
                if (strncmp(p->name, "norm", 4) == 0 && p->kind == SGT_PARAM_REAL) *at = 8;
                if (strncmp(p->name, "step", 4) == 0) *at = 4;
            }
            stretched = with;
            sgt_vec3 o = {uniform(&g, -3, 3), uniform(&g, -3, 3), round_number(&g)};
            sgt_vec3 d = {uniform(&g, -1, 1), uniform(&g, -1, 1), chance(&g, 0.3) ? 0 : round_number(&g)};
            if (chance(&g, 0.5)) o.x = d.x = 0; /* so that c or a term meets z alone */
            sgt_ray r = {o, d, 0, chance(&g, 0.5) ? 8 : FAR}, low = r;
            low.o.z = ldexp(r.o.z, -k), low.d.z = ldexp(r.d.z, -k);
            sgt_options opt = {.proof = (sgt_proof)below(&g, 3)};
            if (strcmp(b->type, "grid") == 0 && r.tmax == FAR) r.tmax = low.tmax = 8;
            sgt_hit all[MOST], h;
            int count = sgt_intersect_all((sgt_surface){b->ops, &with}, r, MOST, all, &opt);
            memcpy(kept, pool, sizeof kept);
            bool exact = true;
            for (size_t j = 0; j < pooled; j++) exact = stretch(&pool[j], k) && exact;
            for (int j = 0; j < 16; j++) exact = stretch(&of_term.a[j], k) && exact;
            for (const sgt_param *p = b->params; p->name; p++)
                if (strcmp(p->name, "curvature") == 0 ||
                    (strcmp(p->name, "coefficients") == 0 && p->kind == SGT_PARAM_REAL))
                    for (int j = 0; j < p->count; j++)
                        exact = stretch((double *)(void *)((unsigned char *)&stretched + p->offset) + j, k) &&
                                exact;
            exact = exact && ldexp(low.o.z, k) == r.o.z && ldexp(low.d.z, k) == r.d.z;
            if (exact && count >= 0 && count <= MOST) {
                h = ask(b, &stretched, low, &opt);
                bool told = h.status != SGT_HIT, doubt = false;
                for (int j = 0; j < count; j++) {
                    long double off = fabsl((long double)all[j].t - h.t),
                                allowed = (long double)all[j].t_err + h.t_err;
                    doubt = doubt || all[j].status < 0;
                    told = told || off <= allowed + 1e-15L * fabsl((long double)h.t);
                }
                bool met = count > 0 && all[0].status == SGT_HIT && all[0].t > 1e-3 && all[0].t < 7.9;
                bool lost = k < 1000 && h.status == SGT_MISS && met &&
                            (rim == 0 || hypot(all[0].p.x, all[0].p.y) < 3.9);
                hits += h.status == SGT_HIT, open += h.status < 0;
                if ((!told && !doubt) || lost) {
                    print_case(b, &stretched, &low, &opt);
                    for (int j = 0; j < count; j++)
                        print_message("unstretched: %s %.17g +- %g\n", sgt_status_text(all[j].status),
                                      all[j].t, all[j].t_err);
                    fail_msg("stretched by 2^-%d: %s, t %.17g +- %g", k, sgt_status_text(h.status), h.t,
                             h.t_err);
                }
            }
            memcpy(pool, kept, sizeof kept), of_term = kept_term;
        }
    printf("%ld hits, %ld open\n", hits, open);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_in_it),
        cmocka_unit_test(test_along),
        cmocka_unit_test(test_stretched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
