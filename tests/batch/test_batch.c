// SPDX-License-Identifier: MIT
/* A batch gives every ray the answer that it gets alone, bit for bit, and writes nothing else.
 *
 * For each type of sgt_builtins: surfaces, rays, options and ends as hostile.h has them; the rays in one
 * array in a random mixture, or one hostile kind at one place among ordinary rays (every kind at every lane
 * of a register and at the edges of a tile), or one ray in every other place; arrays that begin anywhere,
 * of every length from none to several tiles; outputs all or some.  Each set of rays is asked for twice, in
 * two orders with other outputs and other places: what a lane's neighbours are must not matter.  Around
 * each array lie words that nobody may write to.
 *
 *     test_batch [TYPE]      SAGITTA_TEST_SCALE=100: 10^7 rays of each type; SAGITTA_TEST_SEED
 * */
#include "../ends.h"
#include "hostile.h"
#include "soil.h"

/* What is put to a batch, and the answers of each ray alone. */
static sgt_ray rays[MOST];
static sgt_hit hits[MOST];
static ray_kind kinds[MOST];

enum { SHOWN = 5, STATUSES = SGT_GRAZE - SGT_INVALID + 1 };
static long failures, shown, compared, told[STATUSES];

/* ------------------------------------------------------------- one question */

typedef struct question {
    const specimen *s;
    const sgt_options *opt;      /* may be NULL */
    size_t n;
    bool no_tmin, no_tmax;       /* these arrays are left out */
    bool shown;
} question;

static void report(question *q, size_t i, const char *what, const sgt_hit *batch)
{
    failures++;
    if (q->shown || ++shown > SHOWN) return; /* one of a batch is enough */
    q->shown = true;
    printf("FAIL %s: ray %zu of %zu, %s\n", what, i, q->n, i < q->n ? ray_kinds[kinds[i]] : "none");
    print_specimen(q->s);
    print_options(q->opt ? q->opt : &(sgt_options){0});
    if (i < q->n) print_ray(&rays[i]);
    if (i < q->n) print_answer("alone", &hits[i]);
    if (batch) print_answer("batch", batch);
}

/* Number j of a ray, as a batch has it. */
static double batch_number(sgt_ray *ray, int j) { return j == 7 ? end_of(ray) : *component(ray, j); }

/* Asks for the rays in this order, with some outputs, and compares. */
static void ask(question *q, generator *g, const size_t order[])
{
    static guarded given[8], out[10], out_status, out_evals;
    size_t n = q->n, positive = 0;
    bool all = chance(g, 0.4), some[10], status_wanted = all || chance(g, 0.7),
         evals_wanted = all || chance(g, 0.5);
    double *in[8], *to[10]; /* t t_err t_lo p_err p[3] n[3] */
    for (int j = 0; j < 10; j++) some[j] = all || chance(g, 0.5);
    some[5] = some[6] = some[4], some[8] = some[9] = some[7];

    for (int j = 0; j < 8; j++) in[j] = guarded_array(&given[j], g, true);
    for (int j = 0; j < 10; j++) to[j] = guarded_array(&out[j], g, some[j]);
    double *status_room = guarded_array(&out_status, g, status_wanted),
           *evals_room = guarded_array(&out_evals, g, evals_wanted);
    size_t shift = (size_t)below(g, 8), half = (size_t)below(g, 2); /* bytes and ints begin anywhere */
    sgt_hits h = {.status = status_room ? (sgt_status *)status_room + shift : NULL,
                  .evals = evals_room ? (int *)(void *)evals_room + half : NULL,
                  .t = to[0],
                  .t_err = to[1],
                  .t_lo = to[2],
                  .p_err = to[3],
                  .p = {to[4], to[5], to[6]},
                  .n = {to[7], to[8], to[9]}};
    for (size_t i = 0; i < n; i++)
        for (int j = 0; j < 8; j++) in[j][i] = batch_number(&rays[order[i]], j);
    sgt_rays r = {
        {in[0], in[1], in[2]}, {in[3], in[4], in[5]}, q->no_tmin ? NULL : in[6], q->no_tmax ? NULL : in[7]};

    soil_stack(random_bits(g));
    size_t met = sgt_intersect_batch(surface_of(q->s), n, r, h, q->opt);

    for (size_t k = 0; k < n; k++) {
        size_t i = order[k];
        const sgt_hit *a = &hits[i];
        sgt_hit b = *a; /* what was not asked for is as it should be */
        if (h.status) b.status = (sgt_status)h.status[k];
        if (h.evals) b.evals = h.evals[k];
        if (h.t) b.t = h.t[k];
        if (h.t_err) b.t_err = h.t_err[k];
        if (h.t_lo) b.t_lo = h.t_lo[k];
        if (h.p_err) b.p_err = h.p_err[k];
        if (h.p[0]) b.p = (sgt_vec3){h.p[0][k], h.p[1][k], h.p[2][k]};
        if (h.n[0]) b.n = (sgt_vec3){h.n[0][k], h.n[1][k], h.n[2][k]};
        if (!same_answer(a, &b))
            report(q, i, all ? "another answer" : "another answer, some outputs left out", &b);
        for (int j = 0; j < 8; j++)
            if (bits_of(in[j][k]) != bits_of(batch_number(&rays[i], j)))
                report(q, i, "a ray was written to", NULL);
        positive += a->status > 0;
        compared++;
    }
    if (met != positive) report(q, n, "the count returned", NULL);
    for (int j = 0; j < 8; j++)
        if (!untouched(&given[j], n * sizeof(double))) report(q, n, "written around the rays", NULL);
    for (int j = 0; j < 10; j++)
        if (!untouched(&out[j], n * sizeof(double))) report(q, n, "written around an output", NULL);
    const unsigned char *byte = (const unsigned char *)(out_status.room + out_status.from),
                        *expected = (const unsigned char *)&CANARY;
    bool before = true;
    for (size_t i = 0; i < shift; i++) before &= byte[i] == expected[i];
    byte = (const unsigned char *)(out_evals.room + out_evals.from);
    for (size_t i = 0; i < half * sizeof(int); i++) before &= byte[i] == expected[i];
    if (!before || !untouched(&out_status, n + shift) || !untouched(&out_evals, (n + half) * sizeof(int)))
        report(q, n, "written around status or evals", NULL);
}

/* ---------------------------------------------------------------- watched */

/* Stops some rays, and remembers all it was told. */
typedef struct watcher { uint64_t memory; size_t ray; bool batch, in_order; } watcher;

static void remember(watcher *w, uint64_t bits)
{
    w->memory = (w->memory ^ bits) * 0x9e3779b97f4a7c15u + (w->memory >> 29);
}

static int watch(void *data, const sgt_step *step)
{
    watcher *w = data;
    if (w->batch) w->in_order &= step->ray >= w->ray, w->ray = step->ray;
    const double told_of[] = {step->t, step->f, step->slope, step->lo, step->hi};
    remember(w, (uint64_t)w->ray << 32 | (uint64_t)step->eval << 8 | (uint64_t)step->move);
    for (int i = 0; i < 5; i++) remember(w, told_of[i] == told_of[i] ? bits_of(told_of[i]) : 0x7ff8u);
    return w->ray % 5 == 2 && step->eval == 1 + (int)(w->ray % 3);
}

static void ask_watched(question *q, generator *g, const size_t order[], const sgt_options *opt)
{
    watcher one = {.in_order = true}, many = {.in_order = true, .batch = true};
    sgt_options own = *opt;
    own.watch = watch, own.watch_data = &one;
    for (size_t i = 0; i < q->n; i++) one.ray = i, hits[i] = sgt_intersect(surface_of(q->s), rays[i], &own);
    own.watch_data = &many;
    q->opt = &own;
    ask(q, g, order);
    if (one.memory != many.memory || !many.in_order)
        report(q, q->n, "the watcher of a batch was told otherwise", NULL);
}

/* Looks on. */
static int look_on(void *data, const sgt_step *step)
{
    (void)data, (void)step;
    return 0;
}

/* Where a watcher looks on, a ray goes the long way: conics and even aspheres ask their quick forms first,
 * before the ray is checked.  The answer is the same. */
static void ask_the_long_way(question *q, const sgt_options *opt)
{
    sgt_options own = *opt;
    own.watch = look_on;
    for (size_t i = 0; i < q->n; i++) {
        sgt_hit hit = sgt_intersect(surface_of(q->s), rays[i], &own);
        if (!same_answer(&hits[i], &hit)) report(q, i, "another answer where a watcher looks on", &hit);
    }
}

/* ------------------------------------------------------------------- rounds */

/* A place to put a hostile ray at, small enough to meet each lane of a register, and the edges of tiles. */
static size_t any_place(generator *g, size_t n)
{
    size_t edge[] = {63, 64, 127, 128, 255, 256, 257, 511, 512, n - 1};
    size_t place = chance(g, 0.7) ? (size_t)below(g, 32) : edge[below(g, COUNT_OF(edge))];
    return place < n ? place : n - 1;
}

static size_t any_length(generator *g)
{
    static const int edge[] = {0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 255, 256, 257, 511, 512, 513, MOST};
    if (chance(g, 0.2)) return (size_t)edge[below(g, COUNT_OF(edge))];
    return (size_t)below(g, chance(g, 0.5) ? 70 : chance(g, 0.3) ? MOST + 1 : 300);
}

static size_t round_of(generator *g, const sgt_builtin *type)
{
    specimen s = random_specimen(g, type);
    static size_t order[MOST];
    size_t n = any_length(g);
    sgt_options opt = chance(g, 0.5) ? (sgt_options){0} : hostile_options(g);
    bool none = chance(g, 0.1);
    if (none) opt = (sgt_options){0};
    question q = {
        .s = &s, .opt = none ? NULL : &opt, .n = n, .no_tmin = chance(g, 0.2), .no_tmax = chance(g, 0.2)};

    int mixture = below(g, 7), every = 2 + below(g, 3);
    ray_kind kind = (ray_kind)below(g, RAY_KINDS);
    sgt_ray poison = ray_of_kind(g, &s, kind);
    if (chance(g, 0.5)) kind = SPOILT, *component(&poison, below(g, 8)) = NOT;
    for (size_t i = 0; i < n; i++) {
        bool hostile = mixture == 0 || mixture == 1 || (mixture == 2 && i % 2);
        kinds[i] = mixture == 1 ? kind : hostile ? (ray_kind)below(g, RAY_KINDS) : ORDINARY;
        rays[i] = ray_of_kind(g, &s, kinds[i]);
        if (hostile && chance(g, 0.15)) hostile_ends(g, &s, &rays[i]);
        if (hostile && chance(g, 0.02)) *component(&rays[i], below(g, 8)) = hostile_number(g);
        if (mixture == 3 && i % (size_t)every) kinds[i] = kind, rays[i] = poison;
    }
    for (int some = mixture < 4 || !n ? 0 : 1 + below(g, 3); some > 0; some--) {
        size_t place = any_place(g, n);
        kinds[place] = kind;
        rays[place] = ray_of_kind(g, &s, kind);
        if (chance(g, 0.3)) hostile_ends(g, &s, &rays[place]);
    }
    for (size_t i = 0; i < n; i++) {
        if (q.no_tmin) rays[i].tmin = 0;
        if (q.no_tmax) rays[i].tmax = FAR;
        order[i] = i;
    }
    if (chance(g, 0.02)) {
        ask_watched(&q, g, order, &opt);
        return n;
    }
    for (size_t i = 0; i < n; i++) {
        hits[i] = sgt_intersect(surface_of(&s), rays[i], q.opt);
        told[hits[i].status - SGT_INVALID]++;
    }
    if (chance(g, 0.2)) ask_the_long_way(&q, &opt);
    ask(&q, g, order);
    for (size_t i = n; i > 1; i--) { /* in another order (Fisher and Yates) */
        size_t j = (size_t)below(g, (int)i), at = order[j];
        order[j] = order[i - 1], order[i - 1] = at;
    }
    ask(&q, g, order);
    return n;
}

/* ------------------------------------------------------------------ the door */

/* No surface, no value: as sgt_intersect says of them. */
static void test_door(void)
{
    static const sgt_surface_ops empty = {.name = "nothing"};
    const sgt_surface bad[] = {{NULL, NULL}, {&empty, NULL}};
    const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        sgt_status status[3] = {1, 1, 1};
        double t[3] = {0, 0, 0};
        sgt_rays r = {.o = {zero, zero, zero}, .d = {zero, zero, one}};
        size_t met = sgt_intersect_batch(bad[i], 3, r, (sgt_hits){.status = status, .t = t}, NULL);
        for (int j = 0; j < 3; j++) {
            if (met == 0 && status[j] == SGT_INVALID && isnan(t[j])) continue;
            failures++;
            printf("FAIL no surface %zu: ray %d, %s, t %g\n", i, j, sgt_status_text((sgt_status)status[j]),
                   t[j]);
        }
    }
}

int main(int argc, char **argv)
{
    uint64_t seed = test_seed(1);
    printf("SAGITTA_TEST_SEED=%llu SAGITTA_TEST_SCALE=%g\n", (unsigned long long)seed, test_scale());
    test_door();
    bool faulty = failures > 0;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
        if (argc > 1 && strcmp(argv[1], b->type)) continue;
        generator g = {seed ^ (uint64_t)(b - sgt_builtins()) << 40};
        bool known = !answers_itself(b);
        for (size_t i = 0; i < COUNT_OF(chosen); i++) known |= !strcmp(chosen[i].type, b->type);
        if (!known || b->size > sizeof(parameters))
            faulty = true, printf("FAIL %s: hostile.h has no sets of this type\n", b->type);
        /* the others march by intervals: dear */
        double wanted = (answers_itself(b) ? 4e4 : 1500) * test_scale(), asked = 0;
        failures = shown = compared = 0;
        memset(told, 0, sizeof told);
        while (asked < wanted && failures < 1000) asked += (double)round_of(&g, b);
        printf("%-12s %.0f rays, %ld answers compared, %ld faults;", b->type, asked, compared, failures);
        for (int i = STATUSES - 1; i >= 0; i--)
            printf(" %s %ld", sgt_status_text((sgt_status)(i + SGT_INVALID)), told[i]);
        printf("\n");
        fflush(stdout);
        const long *of = told - SGT_INVALID;
        double few = asked / 100;
        bool one_sided = asked >= 1e4 && ((double)of[SGT_HIT] < few || (double)of[SGT_MISS] < few ||
                                          (double)of[SGT_INVALID] < few || (asked > 1e5 && !of[SGT_GRAZE]));
        if (one_sided) printf("FAIL %s: these rays are not hostile enough\n", b->type);
        faulty |= failures > 0 || one_sided;
    }
    return faulty;
}
