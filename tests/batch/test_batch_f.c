// SPDX-License-Identifier: MIT
/* sgt_intersect_batch_f against the same rays in double, and against the sign of F in 113 bits.
 *
 *   status   that of sgt_intersect_batch, of every ray
 *   t, p     t_err and p_err hold the double answer's root: |t - t'| <= t_err + t_err'
 *   113 bits F has different signs at the ends of t +- t_err (planes, conics, aspheres; t_err one part in
 *            2^40 wider, as the ends are rounded)
 *   bits     any part of a batch, any choice of outputs and a soiled stack give the same numbers
 *
 * The surfaces are even sags as they are made and hostile ones of every type; the rays ordinary ones, near
 * the rim, the start and the tangent, and hostile ones.  Sets of instructions: sets.py, by the part "floats"
 * of checksum.c.
 *
 *     test_batch_f     SAGITTA_TEST_SCALE multiplies the number of batches, SAGITTA_TEST_SEED chooses
 *                      others */
#include "../ends.h"
#include "hostile.h"
#include "soil.h"

enum { BATCH = 300, COLUMNS = 8, OF_HIT = 9 };

typedef struct answers_f { sgt_status status[BATCH]; float of[OF_HIT][BATCH]; } answers_f;
typedef struct answers { sgt_status status[BATCH]; double of[OF_HIT][BATCH]; } answers;

static float in_f[COLUMNS][BATCH];
static double in[COLUMNS][BATCH];
static long faults, rays_asked, met, in_floats, signs;
static double worst;

static sgt_rays_f rays_f(size_t from, bool ends)
{
    return (sgt_rays_f){{in_f[0] + from, in_f[1] + from, in_f[2] + from},
                        {in_f[3] + from, in_f[4] + from, in_f[5] + from},
                        ends ? in_f[6] + from : NULL,
                        ends ? in_f[7] + from : NULL};
}

static sgt_hits_f hits_f(answers_f *a, size_t from)
{
    float *of[OF_HIT];
    for (int j = 0; j < OF_HIT; j++) of[j] = a->of[j] + from;
    return (sgt_hits_f){.status = a->status + from, .t = of[0], .t_err = of[1], .p = {of[2], of[3], of[4]},
                        .n = {of[5], of[6], of[7]}, .p_err = of[8]};
}

static void fault(const char *what, size_t i, sgt_surface s, const sgt_options *opt)
{
    if (++faults > 20) return;
    printf("%s: %s, ray %zu: o %a %a %a d %a %a %a ends %a %a, pick %d proof %d\n", what, s.ops->name, i,
           in[0][i], in[1][i], in[2][i], in[3][i], in[4][i], in[5][i], in[6][i], in[7][i], opt->pick,
           opt->proof);
}

/* ------------------------------------------------------------------ 113 bits */

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 quad;

static quad root_of(quad x)
{
    quad y = (quad)sqrt((double)x);
    for (int i = 0; i < 3 && y > 0; i++) y = (y + x / y) / 2;
    return y;
}

/* The sign of F on the sheet; 0: outside the domain. */
static int sign_at(const sgt_even_asphere *s, size_t i, quad t)
{
    quad x = (quad)in[0][i] + t * (quad)in[3][i], y = (quad)in[1][i] + t * (quad)in[4][i],
         z = (quad)in[2][i] + t * (quad)in[5][i], r2 = x * x + y * y, p = 0;
    quad phi2 = 1 - (1 + (quad)s->k) * (quad)s->c * (quad)s->c * r2;
    for (int j = 7; j >= 0; j--) p = (p + (quad)s->a[j]) * r2;
    if (phi2 < 0) return 0;
    quad f = z - (quad)s->c * r2 / (1 + root_of(phi2)) - p;
    return (f > 0) - (f < 0);
}

static void check_signs(const sgt_even_asphere *s, size_t n, const answers_f *a, sgt_surface as,
                        const sgt_options *opt)
{
    for (size_t i = 0; i < n; i++) {
        if (a->status[i] <= 0 || !(a->of[1][i] > 0) || !((double)a->of[1][i] < 1e30)) continue;
        /* from very far t_err reaches far beyond the point, where F may have any sign */
        double wide = (double)a->of[1][i] * (fabs(in[3][i]) + fabs(in[4][i]));
        double r = s->semi_diameter;
        if (r == 0) r = fabs((double)a->of[2][i]) + fabs((double)a->of[3][i]);
        if (!(wide <= 0.01 * r)) continue;
        quad t = (quad)a->of[0][i], e = (quad)a->of[1][i] * (1 + (quad)0x1p-40);
        int lo = sign_at(s, i, t - e), hi = sign_at(s, i, t + e);
        signs++;
        if (lo && hi && lo == hi && a->status[i] == SGT_HIT) fault("no root within t_err", i, as, opt);
    }
}
#else
static void check_signs(const sgt_even_asphere *s, size_t n, const answers_f *a, sgt_surface as,
                        const sgt_options *opt)
{
    (void)s, (void)n, (void)a, (void)as, (void)opt;
}
#endif

/* -------------------------------------------------------------------- a batch */

static void compare(size_t i, const answers_f *f, const answers *d, sgt_surface s, const sgt_options *opt)
{
    rays_asked++;
    if (f->status[i] != d->status[i]) {
        fault("status", i, s, opt);
        return;
    }
    for (int j = 0; j < OF_HIT && f->status[i] <= 0; j++)
        if (f->of[j][i] == f->of[j][i]) fault("a number of no hit", i, s, opt);
    if (f->status[i] <= 0) return;
    met++;
    double off = fabs((double)f->of[0][i] - d->of[0][i]), t_err = (double)f->of[1][i], p_off = 0;
    for (int j = 2; j < 5; j++) {
        double one = (double)f->of[j][i] - d->of[j][i];
        p_off += one * one;
    }
    if (!(off <= t_err + d->of[1][i])) fault("t", i, s, opt);
    if (!(sqrt(p_off) * (1 - 0x1p-50) <= (double)f->of[8][i] + d->of[8][i])) fault("p", i, s, opt);
    double n_off = 0, n_size = 0;
    for (int j = 5; j < 8; j++) {
        n_off += fabs((double)f->of[j][i] - d->of[j][i]), n_size += fabs(d->of[j][i]);
    }
    const bool usual = opt->t_tol == 0 && n_size < 1e30 && n_size > 1e-30;
    if (usual && !(n_off <= 0x1p-14 * n_size)) fault("n", i, s, opt);
    bool by_floats = t_err > 1.001 * (off + d->of[1][i]) && t_err < 1e30;
    in_floats += by_floats;
    if (by_floats && opt->t_tol == 0) worst = off / t_err > worst ? off / t_err : worst;
}

static void same_bits(size_t from, size_t n, const answers_f *a, const answers_f *b, bool some, sgt_surface s,
                      const sgt_options *opt)
{
    for (size_t i = from; i < from + n; i++) {
        bool same = a->status[i] == b->status[i];
        for (int j = 0; j < OF_HIT; j++) {
            bool asked = !some || j < 2 || j == 5 || j == 6 || j == 7;
            same &= !asked || a->of[j][i] == b->of[j][i]
                    || (a->of[j][i] != a->of[j][i] && b->of[j][i] != b->of[j][i]);
        }
        if (!same) fault("other bits in a part of the batch", i, s, opt);
    }
}

static void ask(generator *g, sgt_surface s, const sgt_even_asphere *sag, size_t n, const sgt_options *opt)
{
    static answers_f f, part;
    static answers d;
    const bool ends = chance(g, 0.7);
    double *of[OF_HIT];
    for (int j = 0; j < OF_HIT; j++) of[j] = d.of[j];
    const sgt_rays rays = {{in[0], in[1], in[2]}, {in[3], in[4], in[5]}, ends ? in[6] : NULL,
                            ends ? in[7] : NULL};
    const sgt_hits hits = {.status = d.status, .t = of[0], .t_err = of[1], .p = {of[2], of[3], of[4]},
                           .n = {of[5], of[6], of[7]}, .p_err = of[8]};
    soil_stack(random_bits(g));
    size_t count = sgt_intersect_batch_f(s, n, rays_f(0, ends), hits_f(&f, 0), opt);
    if (count != sgt_intersect_batch(s, n, rays, hits, opt)) fault("the number met", 0, s, opt);
    for (size_t i = 0; i < n; i++) compare(i, &f, &d, s, opt);
    if (sag && !ends) check_signs(sag, n, &f, s, opt);
    if (n == 0) return;
    size_t from = (size_t)below(g, (int)n), some = 1 + (size_t)below(g, (int)(n - from));
    sgt_hits_f to = hits_f(&part, from);
    const bool fewer = chance(g, 0.5);
    if (fewer) to.p[0] = to.p[1] = to.p[2] = NULL, to.p_err = NULL;
    soil_stack(random_bits(g));
    sgt_intersect_batch_f(s, some, rays_f(from, ends), to, opt);
    same_bits(from, some, &f, &part, fewer, s, opt);
}

static void set_ray(size_t i, const double of[COLUMNS])
{
    for (int j = 0; j < COLUMNS; j++) in_f[j][i] = (float)of[j], in[j][i] = (double)in_f[j][i];
}

static sgt_options some_options(generator *g)
{
    sgt_options opt = {.pick = chance(g, 0.5) ? SGT_NEAR_SEED : SGT_FIRST};
    if (chance(g, 0.3)) opt.proof = chance(g, 0.5) ? SGT_PROVE_ROOT : SGT_PROVE_FIRST;
    if (chance(g, 0.1)) opt.t_tol = any_scale(g, -9, -1);
    return opt;
}

/* ------------------------------------------------------------------ surfaces */

/* An even sag of usual shape in any unit of length, and rays at it. */
static void ordinary(generator *g)
{
    double unit = chance(g, 0.3) ? any_scale(g, -6, 6) : 1, rim = unit * uniform(g, 5, 15), a = rim;
    const bool flat = chance(g, 0.2), bare = chance(g, 0.5), open = chance(g, 0.2);
    sgt_even_asphere s = {.c = flat ? 0 : signed_scale(g, -3, 0) / rim, .semi_diameter = open ? 0 : rim};
    int kind = below(g, 4), terms = below(g, 9);
    s.k = flat || kind == 0 ? 0 : kind == 1 ? -1 : uniform(g, -3, 3);
    for (int i = 0; i < terms && !bare; i++) s.a[i] = signed_scale(g, -4, -0.5) / whole_power(a, 2 * i + 1);
    double away = rim * any_scale(g, -3, chance(g, 0.8) ? 3 : 14);
    double length = chance(g, 0.9) ? 1 : any_scale(g, -8, 8);
    for (size_t i = 0; i < BATCH; i++) {
        double steep = chance(g, 0.7) ? 0.3 : 3, edge = chance(g, 0.05) ? 1 + signed_scale(g, -8, -3) : 0;
        double l = steep * uniform(g, -1, 1), m = steep * uniform(g, -1, 1), n = either_sign(g);
        double x = rim * uniform(g, -1.1, 1.1), y = rim * uniform(g, -1.1, 1.1), q = away;
        if (edge > 0) y = 0, x = edge * rim;
        if (chance(g, 0.1)) q = 0;
        if (chance(g, 0.1)) q *= uniform(g, -1, 1);
        double tmin = chance(g, 0.5) ? 0 : chance(g, 0.3) ? -HUGE_VAL : away * uniform(g, -1, 2),
               tmax = chance(g, 0.5) ? HUGE_VAL : away * uniform(g, -1, 3);
        set_ray(i, (double[]){x - q * l, y - q * m, -q * n, l * length, m * length, n * length, tmin / length,
                              tmax / length});
    }
    sgt_options opt = some_options(g);
    const sgt_conic conic = {s.c, s.k, s.semi_diameter};
    const bool is_conic = bare && chance(g, 0.7);
    ask(g, is_conic ? (sgt_surface){&sgt_conic_ops, &conic} : (sgt_surface){&sgt_even_asphere_ops, &s}, &s,
        BATCH, &opt);
}

static void hostile(generator *g, const sgt_builtin *type)
{
    specimen s = random_specimen(g, type);
    size_t n = (size_t)below(g, answers_itself(type) ? BATCH + 1 : 30);
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = i % 2 ? hostile_ray(g, &s) : ordinary_ray(g, &s);
        double of[COLUMNS];
        for (int j = 0; j < COLUMNS; j++) of[j] = j == 7 ? end_of(&ray) : *component(&ray, j);
        set_ray(i, of);
    }
    sgt_options opt = chance(g, 0.6) ? some_options(g) : hostile_options(g);
    opt.watch = NULL;
    ask(g, surface_of(&s), NULL, n, &opt);
}

/* What later versions may ask for is refused, as in sgt_intersect_batch. */
static void reserved(void)
{
    const sgt_conic plane = {0};
    answers_f f;
    set_ray(0, (double[]){0, 0, -1, 0, 0, 1, 0, HUGE_VAL});
    sgt_hits_f to = hits_f(&f, 0);
    to.reserved_[0] = 1;
    sgt_surface s = {&sgt_conic_ops, &plane};
    sgt_options opt = {0};
    if (sgt_intersect_batch_f(s, 1, rays_f(0, false), to, NULL) != 0 || f.status[0] != SGT_INVALID)
        fault("reserved_", 0, s, &opt);
}

int main(void)
{
    generator g = {test_seed(1)};
    double scale = test_scale();
    printf("test_batch_f: SAGITTA_TEST_SEED=%llu\n", (unsigned long long)g.state);
    for (int i = 0; i < 2000 * scale; i++) ordinary(&g);
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        for (int i = 0; i < (answers_itself(b) ? 200 : 10) * scale; i++) hostile(&g, b);
    reserved();
    printf("%ld rays, %ld met, %ld of them by floats, worst error %.3f of t_err; %ld signs in 113 bits\n",
           rays_asked, met, in_floats, worst, signs);
    if (!in_floats) printf("no ray was met in floats\n"), faults++;
    if (faults) printf("%ld faults\n", faults);
    return faults != 0;
}
