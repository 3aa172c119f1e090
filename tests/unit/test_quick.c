// SPDX-License-Identifier: MIT
/* What one step of the quick form claims (src/solve/step.h), by itself: a root that is certified is inside
 * of the stretch for which the slope is bounded, and a root is told not to count only where no point within
 * its error does.  And what an entry of a list covers that takes in another one (src/solve/entries.h). */
#include "unit.h"

#include "../../src/solve/entries.h"
#include "../../src/solve/step.h"

static void test_certified(void **state)
{
    (void)state;
    generator g = seeded("certified");
    long n = scaled(100000), inside = 0;
    for (long i = 0; i < n; i++) {
        double least = chance(&g, 0.1) ? 0 : log_uniform(&g, 1e-6, 1e6),
               g_err = log_uniform(&g, 1e-18, 1e-12), value = uniform(&g, -4, 4) * g_err;
        double tau = chance(&g, 0.2) ? 0 : uniform(&g, -2, 2), off = (fabs(value) + g_err) / least;
        double lo = tau - off * log_uniform(&g, 1e-2, 1e2), hi = tau + off * log_uniform(&g, 1e-2, 1e2);
        if (chance(&g, 0.1)) lo = tau;
        if (chance(&g, 0.1)) hi = tau;
        certified c = certified_of(tau, value, g_err, (searched){lo, hi, least});
        if (!c.inside) continue;
        /* g - g_err and g + g_err have unlike signs at tau +- off; there `least` holds in the stretch alone
         */
        long double far = (fabsl((long double)value) + g_err) / least;
        REQUIRE(least > 0 && tau - far > lo && tau + far < hi,
                "case %ld: certified within %Lg of %.17g in [%.17g, %.17g]", i, far, tau, lo, hi);
        REQUIRE(c.tau_err >= far, "case %ld: a root within %g, it may be %Lg away", i, c.tau_err, far);
        inside++;
    }
    REQUIRE(inside > n / 10, "only %ld are certified", inside);
    print_message("%ld of %ld certified\n", inside, n);
}

static void test_certain_to_be_off(void **state)
{
    (void)state;
    generator g = seeded("certain not to count");
    long n = scaled(100000), off = 0, counted = 0;
    for (long i = 0; i < n; i++) {
        double rim = log_uniform(&g, 1e-3, 1e3), tau_err = rim * log_uniform(&g, 1e-17, 1e-3),
               about = uniform(&g, 0, 6.283185307179586);
        double r = rim + uniform(&g, -4, 4) * tau_err, rim2 = rim * rim, t0 = uniform(&g, -3, 3), tmin = -FAR,
               tmax = FAR;
        sgt_vec3 d = random_direction(&g), p = {r * cos(about), r * sin(about), uniform(&g, -1, 1)};
        double scale = scale_of(d);
        local q = {.x = p.x,
                   .y = p.y,
                   .z = p.z,
                   .l = d.x * scale,
                   .m = d.y * scale,
                   .n = d.z * scale,
                   .t0 = t0,
                   .scale = scale};
        if (chance(&g, 0.3)) tmax = t0 * scale + uniform(&g, -4, 4) * tau_err * scale;
        sgt_vec3 grad = {uniform(&g, -0.3, 0.3), uniform(&g, -0.3, 0.3), 1};
        around at = around_of(&q, 0, p, grad, 0);
        double margin = chance(&g, 0.5) ? 0 : END_ERRORS;
        acceptance h = acceptance_of(&q, 0, tau_err, at, (limits){tmin, tmax, rim2, margin});
        REQUIRE(!(h.accepted && h.off), "case %ld: it counts, and certainly not", i);
        off += h.off, counted += h.accepted;
        if (h.off && !(tmax < FAR))
            for (int k = -8; k <= 8; k++) { /* where the root may be */
                long double s = k / 8.0L * tau_err, x = p.x + s * q.l, y = p.y + s * q.m;
                REQUIRE(x * x + y * y > (long double)rim2,
                        "case %ld: certainly beyond the rim, and %Lg inside at %Lg of %g", i,
                        rim2 - x * x - y * y, s, tau_err);
            }
        if (h.off && r + 2 * tau_err < rim && tmax < FAR)
            REQUIRE(h.t > tmax, "case %ld: certainly behind tmax at %.17g, which is %.17g", i, h.t, tmax);
        if (margin > 0 && fabs(h.t - tmax) < 15 * h.t_err && r + 2 * tau_err < rim)
            REQUIRE(!h.off && !h.accepted, "case %ld: told next to tmax", i);
    }
    REQUIRE(off > n / 20 && counted > n / 20, "%ld off and %ld counted", off, counted);
    print_message("%ld certainly off, %ld counted\n", off, counted);
}

/* [lo, hi] of an entry has all that it had, all that it takes in, and t with its error to both sides. */
static void test_covered(void **state)
{
    (void)state;
    generator g = seeded("covered");
    long n = scaled(100000), right = 0, left = 0;
    for (long i = 0; i < n; i++) {
        const double t = uniform(&g, -1, 1) * log_uniform(&g, 1e-6, 1e6), err = log_uniform(&g, 1e-20, 1e-3);
        const sgt_interval was = sgt_about(t, err);
        sgt_hit hits[1] = {{.status = SGT_HIT, .t = t, .t_err = err, .lo = was.lo, .hi = was.hi}};
        sgt_list list = {.hits = hits, .cap = 1};
        sgt_list_add(&list, &hits[0]);
        const double from = t - log_uniform(&g, 1e-20, 1e-2), to = t + log_uniform(&g, 1e-20, 1e-2);
        sgt_list_cover(&list, from, to);
        const sgt_hit *h = &hits[0];
        REQUIRE(h->lo <= was.lo && h->lo <= from && h->hi >= was.hi && h->hi >= to && h->t == t,
                "case %ld: [%.17g, %.17g] and [%.17g, %.17g] are not in [%.17g, %.17g]", i, was.lo, was.hi,
                from, to, h->lo, h->hi);
        REQUIRE((long double)h->t - h->t_err >= h->lo && (long double)h->t + h->t_err <= h->hi,
                "case %ld: t %.17g, t_err %g, [%.17g, %.17g]", i, h->t, h->t_err, h->lo, h->hi);
        REQUIRE(list.last.lo == h->lo && list.last.hi == h->hi && list.last.t_err == h->t_err, "case %ld", i);
        right += t - from < to - t, left += t - from > to - t;
    }
    REQUIRE(right > n / 4 && left > n / 4, "%ld to the right, %ld to the left", right, left);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_certified),
                                       cmocka_unit_test(test_certain_to_be_off),
                                       cmocka_unit_test(test_covered)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
