// SPDX-License-Identifier: MIT
/* The bound of an even asphere by constants of a disc (BY CONSTANTS in src/surface/asphere/easy.h), against
 * what the constants stand for, in long double, at points and rays of the disc that come near to them: a
 * constant a tenth too small fails.  Of random surfaces, with a rim and without:
 *
 *     F       the magnitudes of the terms of P', summed, at the edge of the disc
 *     kappa   (1 + k) c w on the sheet, where it is greatest
 *     N2      (|n| + (2 F + |c|) R sqrt a)^2, for rays where the two squares of N2 are as 4 to 1
 *     2 M     2 |G''|, by the chain rule at points of the edge; beside it the sum that M is
 *     e       the sum of the head, for rho, rho0, z, w of rays of the disc
 *     first   the square of the slope at the edge
 *
 * And none of them is much greater: t_err would be.
 *
 * Then batches that are long enough for the loops from memory, against their parts. */
#include "unit.h"

#pragma GCC diagnostic ignored "-Wshadow" /* unit.h has a type `wide` */

#include "../../src/surface/asphere/easy.h"

static generator drawn;

static double of_size(double least, double most)
{
    double size = exp2(uniform(&drawn, log2(least), log2(most)));
    return uniform(&drawn, 0, 1) < 0.5 ? size : -size;
}

/* P' by magnitudes; 2 P' + 4 rho P'', which (x l + y m)^2 = rho a makes w'' / a. */
typedef struct of_terms { long double first, second; } of_terms;

static of_terms terms_at(const shape *s, long double rho)
{
    of_terms t = {0, 0};
    long double power = 1;
    for (int i = 0; i < s->terms; i++, power *= rho) {
        long double a = (i + 1) * (long double)s->a[i] * power;
        t.first += fabsl(a), t.second += 2 * (2 * i + 1) * a;
    }
    return t;
}

static void at_least(const char *what, long double constant, long double meant, long double most)
{
    REQUIRE(constant >= meant * (1 - 0x1p-45L), "%s: %.17Lg, and it stands for %.17Lg", what, constant,
            meant);
    REQUIRE(constant <= meant * most, "%s: %.17Lg is far more than %.17Lg", what, constant, meant);
}

static void check_surface(const shape *s, const wavy *v)
{
    const long double u = 0x1p-53L, D = v->disc, c = fabsl((long double)s->c), ck = fabsl((long double)s->ck),
                      chi = (long double)s->ck * s->c * D, F = terms_at(s, D).first, R = sqrtl(D),
                      on_sheet = fabsl(1 - sqrtl(1 - chi)), V = 1 + on_sheet, wide = 2 * F + c;
    REQUIRE(D <= 1.125L * s->rim2 * (1 + 0x1p-50L), "D %Lg, beyond the rim", D);
    REQUIRE(fabsl(chi) <= 0.5L * (1 + 0x1p-45L), "chi %Lg", chi);
    REQUIRE(F <= c / 8 * (1 + 0x1p-30L), "F %Lg, c %Lg", F, c);
    at_least("2 F + |c|", v->wide, wide, 1.0001L);
    if (s->ck != 0) at_least("kappa", v->kappa, on_sheet, 1.35L);
    for (int i = 0; i < 20; i++) {
        /* A ray: N2 is the square where q sqrt a = |n| / 4. */
        double along = i < 5 ? 0.25 / (double)(wide * R) : of_size(1e-3, 10), n = 1 / hypot(1, along),
               a = 1 - n * n;
        long double root_a = sqrtl(a), B = n + wide * R * root_a, N2 = v->n1 * (long double)a + 1.25L * n * n;
        at_least("N2", N2, B * B, i < 5 ? 1.0001L : 5);
        long double two_m = v->m1 * (long double)a + v->m2 * N2,
                    sum = 2 * ((c + (1.1L + on_sheet) * v->bend * F) * a + ck * N2);
        at_least("2 M", two_m, sum, 1.08L);
        /* G'' at a point of the edge, z on the surface: the ray goes outward there, or inward. */
        long double out = i % 2 ? 1 : -1, dp = 0, power = 1,
                    w = chi == 0 ? s->c * D / 2 : (1 - sqrtl(1 - chi)) / s->ck;
        for (int j = 0; j < s->terms; j++, power *= D) dp += (j + 1) * (long double)s->a[j] * power;
        long double dw = n - 2 * dp * R * root_a * out, ddw = -terms_at(s, D).second * a,
                    G2 = ddw - (s->c * (long double)a + s->ck * (dw * dw + w * ddw));
        REQUIRE(two_m >= 2 * fabsl(G2) * (1 - 0x1p-40L), "M %Lg, G'' %Lg", two_m / 2, G2);
        /* e */
        double rho = (double)D * uniform(&drawn, 0, 1), rho0 = rho * uniform(&drawn, 0, 4),
               z = of_size(1e-3, 1),
               at_w = of_size(1e-3, 1);
        long double Q = 9.0L * rho + 2.0L * rho0, az = fabs(z), aw = fabs(at_w),
                    e = v->q1 * Q + v->q2 * az + v->q3 * aw,
                    meant = 1.01L * u * (V * (F * Q + az + aw) + c / 2 * Q + 3 * aw * V);
        at_least("e", e, meant, 1.08L);
        at_least("q1", v->q1, 1.01L * u * (V * F + c / 2), 1.08L);
        at_least("q2", v->q2, 1.01L * u * V, 1.08L), at_least("q3", v->q3, 4.04L * u * V, 1.08L);
    }
    long double steep = c / sqrtl(1 - chi) + 2 * F;
    at_least("first", v->first, steep * steep * D, 3.5L);
}

static void constants_are_what_they_stand_for(void **unused)
{
    (void)unused;
    drawn = seeded("disc");
    long count = scaled(20000), discs = 0, rims = 0;
    for (long i = 0; i < count; i++) {
        double unit = exp2(uniform(&drawn, -20, 20)), c = of_size(0.001, 1) / unit,
               r = unit * fabs(of_size(0.3, 30)),
               k = uniform(&drawn, 0, 1) < 0.2 ? -1 : uniform(&drawn, -3, 2), a[8] = {0}, r2 = r * r,
               power = r2;
        int terms = 1 + (int)uniform(&drawn, 0, 7.99);
        a[0] = uniform(&drawn, 0, 1) < 0.7 ? 0 : 0.1 * c * uniform(&drawn, -1, 1);
        for (int j = 1; j < terms; j++, power *= r2) a[j] = of_size(1e-6, 1) * c / power;
        const bool rim = uniform(&drawn, 0, 1) < 0.5;
        const shape s = {.c = c, .k = k, .ck = (1 + k) * c, .terms = terms, .a = a,
                         .rim2 = rim ? r2 : HUGE_VAL,
                         .domain2 = domain2_of(c, k, rim ? r : 0)};
        wavy v;
        REQUIRE(wavy_of(&s, false, &v), "c %g", c);
        wavy_constants(&s, &v);
        if (!(v.disc > 0)) continue;
        discs++, rims += v.disc == 1.125 * r2;
        check_surface(&s, &v);
    }
    print_message("%ld of %ld surfaces have a disc, %ld up to the rim\n", discs, count, rims);
    REQUIRE((double)discs > 0.5 * (double)count, "only %ld of %ld have a disc", discs, count);
}

/* A batch from memory has other loops (`far` of sgt_tile): the same bits as in parts. */
enum { MANY = SGT_FAR + 130, ROWS = 10, PART = 1000 };

static sgt_hits hits_at(double rows[ROWS][MANY], sgt_status *status, size_t i, bool all)
{
    sgt_hits h = {.status = status + i, .t = rows[0] + i, .t_err = rows[1] + i};
    for (int k = 0; k < 3; k++) h.p[k] = rows[2 + k] + i, h.n[k] = rows[5 + k] + i;
    if (all) h.t_lo = rows[8] + i, h.p_err = rows[9] + i;
    return h;
}

static void a_long_batch_is_its_parts(void **unused)
{
    (void)unused;
    static double o[3][MANY], d[3][MANY], whole[ROWS][MANY], parts[ROWS][MANY];
    static sgt_status status[2][MANY];
    const sgt_conic plane = {.semi_diameter = 4}, conic = {.c = 0.1, .k = -0.6, .semi_diameter = 4};
    const sgt_even_asphere asphere = {.c = 0.1, .k = -0.6, .semi_diameter = 4, .a = {0, 1e-4, -2e-6, 1e-8}};
    const sgt_surface of[] = {{&sgt_conic_ops, &plane}, {&sgt_conic_ops, &conic},
                              {&sgt_even_asphere_ops, &asphere}};
    drawn = seeded("long batch");
    for (size_t i = 0; i < MANY; i++) { /* some go past the rim */
        for (int k = 0; k < 2; k++)
            o[k][i] = uniform(&drawn, -3.2, 3.2), d[k][i] = uniform(&drawn, -0.2, 0.2);
        o[2][i] = -5, d[2][i] = 1;
    }
    for (size_t j = 0; j < COUNT_OF(of) * 4; j++) {
        const sgt_options near = {.pick = j & 1 ? SGT_NEAR_SEED : SGT_FIRST};
        const bool all = j & 2;
        const sgt_rays rays = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, NULL, NULL};
        sgt_intersect_batch(of[j / 4], MANY, rays, hits_at(whole, status[0], 0, all), &near);
        for (size_t i = 0; i < MANY; i += PART) {
            const size_t n = MANY - i < PART ? MANY - i : PART;
            const sgt_rays part = rays_from(&rays, i);
            sgt_intersect_batch(of[j / 4], n, part, hits_at(parts, status[1], i, all), &near);
        }
        REQUIRE(memcmp(status[0], status[1], sizeof status[0]) == 0, "case %zu: status", j);
        for (int k = 0; k < (all ? ROWS : 8); k++)
            for (size_t i = 0; i < MANY; i++)
                REQUIRE(memcmp(&whole[k][i], &parts[k][i], sizeof(double)) == 0 ||
                            (isnan(whole[k][i]) && isnan(parts[k][i])),
                        "case %zu, row %d, ray %zu: %a, in parts %a", j, k, i, whole[k][i], parts[k][i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(constants_are_what_they_stand_for),
                                       cmocka_unit_test(a_long_batch_is_its_parts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
