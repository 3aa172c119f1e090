// SPDX-License-Identifier: MIT
/* sgt_intersect_all: every root in its place, what could not be decided in its place too, and no
 * more claimed than what the surface offers.  The truth is a closed form or dense samples, in
 * long double. */
#include "unit.h"

#include <sagitta/surfaces.h>

enum { MOST = 64 };

/* Entries in order; what each says of itself. */
static void require_list(const char *what, long i, int n, const sgt_hit hit[])
{
    for (int j = 0; j < n; j++) {
        const sgt_hit *h = &hit[j];
        REQUIRE(h->status != SGT_MISS && h->status != SGT_INVALID, "%s %ld: entry %d of %d is %s", what, i, j,
                n, sgt_status_text(h->status));
        REQUIRE(!j || h->t + h->t_err >= hit[j - 1].t - hit[j - 1].t_err,
            "%s %ld: entry %d at %.17g, the one before at %.17g", what, i, j, h->t, hit[j - 1].t);
        REQUIRE(h->evals >= 0, "%s %ld: entry %d: %d evaluations", what, i, j, h->evals);
        if (h->status > 0) REQUIRE(h->lo <= h->t && h->t <= h->hi && h->t_err >= 0 && h->p_err >= 0,
            "%s %ld: entry %d: %g in [%g, %g] +- %g", what, i, j, h->t, h->lo, h->hi, h->t_err);
        else {
            REQUIRE(isnan(h->f) && isnan(h->p.x) && isnan(h->n.x), "%s %ld: entry %d, %s, has a point", what,
                    i, j, sgt_status_text(h->status));
            REQUIRE(h->lo <= h->hi, "%s %ld: entry %d: the stretch [%g, %g]", what, i, j, h->lo, h->hi);
            if (isfinite(h->lo) && isfinite(h->hi))
                REQUIRE(h->t - h->t_err <= h->lo && h->t + h->t_err >= h->hi,
                        "%s %ld: entry %d: %.17g +- %.17g is not all of [%.17g, %.17g]", what, i, j, h->t,
                        h->t_err, h->lo, h->hi);
        }
    }
}

static double along(const sgt_hit *h, const sgt_ray *r)
{
    return h->n.x * r->d.x + h->n.y * r->d.y + h->n.z * r->d.z;
}

/* Is the root, known to +- slack, in some entry? */
static bool reported(long double root, long double slack, int n, const sgt_hit hit[])
{
    for (int j = 0; j < n; j++)
        if (hit[j].status > 0 ? fabsl(root - hit[j].t) <= hit[j].t_err + slack
                              : root >= hit[j].lo - slack && root <= hit[j].hi + slack)
            return true;
    return false;
}

/* ----------------------------------------------------------------- conics */

/* The bowl z = 1 - sqrt(1 - r^2), seen along x at z = 1/2: F rises at x = -sqrt(3)/2 and falls
 * at sqrt(3)/2. */
static const sgt_conic bowl = {.c = 1};
static const sgt_surface bowl_surface = {&sgt_conic_ops, &bowl};
static const sgt_ray across = {.o = {-5, 0, 0.5}, .d = {1, 0, 0}};

static void test_bowl(void **state)
{
    (void)state;
    long double half = sqrtl(3) / 2;
    sgt_hit hit[3];
    assert_int_equal(sgt_intersect_all(bowl_surface, across, 3, hit, NULL), 2);
    for (int i = 0; i < 2; i++) {
        long double root = i ? 5 + half : 5 - half;
        REQUIRE(hit[i].status == SGT_HIT && fabsl(hit[i].t - root) <= hit[i].t_err + 1e-18L &&
                    hit[i].t_err < 1e-14,
                "root %d: %s at %.17g +- %g", i, sgt_status_text(hit[i].status), hit[i].t, hit[i].t_err);
        REQUIRE(i ? along(&hit[i], &across) < 0 : along(&hit[i], &across) > 0, "root %d: n . d is %g", i,
                along(&hit[i], &across));
        REQUIRE(fabsl(hit[i].p.x - (root - 5)) <= hit[i].p_err && fabs(hit[i].p.z - 0.5) <= hit[i].p_err &&
                    hit[i].p_err < 1e-14,
                "root %d: the point %.17g 0 %.17g +- %g", i, hit[i].p.x, hit[i].p.z, hit[i].p_err);
    }
    require_list("bowl", 0, 2, hit);
    /* a sphere's far side is no part of its sag: at z = 3/2 there is nothing */
    assert_int_equal(
        sgt_intersect_all(bowl_surface, (sgt_ray){.o = {-5, 0, 1.5}, .d = {1, 0, 0}}, 3, hit, NULL), 0);
}

static void test_cap(void **state)
{
    (void)state;
    sgt_hit hit[4], full[2];
    assert_int_equal(sgt_intersect_all(bowl_surface, across, 0, NULL, NULL), 2);
    assert_int_equal(sgt_intersect_all(bowl_surface, across, 2, full, NULL), 2);
    for (int cap = 0; cap <= 4; cap++) {
        memset(hit, 0x5a, sizeof hit);
        assert_int_equal(sgt_intersect_all(bowl_surface, across, cap, hit, &(sgt_options){0}), 2);
        for (int i = 0; i < 4; i++) {
            const unsigned char *byte = (const unsigned char *)&hit[i];
            if (i < cap && i < 2)
                REQUIRE(hit[i].status == full[i].status && same_bits(hit[i].t, full[i].t) &&
                            same_bits(hit[i].t_err, full[i].t_err),
                        "cap %d: entry %d is another", cap, i);
            else
                REQUIRE(byte[0] == 0x5a && byte[sizeof(sgt_hit) - 1] == 0x5a,
                        "cap %d: entry %d is written to", cap, i);
        }
    }
}

static void test_ends(void **state)
{
    (void)state;
    sgt_hit full[2], hit[2];
    sgt_intersect_all(bowl_surface, across, 2, full, NULL);
    sgt_ray ray = across;
    ray.tmin = full[0].t, ray.tmax = FAR; /* on the first: it does not count */
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 1);
    assert_true(same_bits(hit[0].t, full[1].t) || fabs(hit[0].t - full[1].t) <= hit[0].t_err + full[1].t_err);
    ray.tmin = full[0].t - 1e-9; /* a little less: it does */
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 2);
    ray.tmin = full[1].t;
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 0);
    ray.tmin = 0, ray.tmax = full[1].t; /* at tmax it counts */
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 2);
    ray.tmax = full[1].t - 1e-9;
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 1);
    ray.tmax = full[0].t - 1e-9;
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 0);
    ray.tmin = -FAR, ray.tmax = FAR, ray.o.x = 3; /* both behind the origin */
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 2);
    ray.tmin = 0;
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 0);
    /* the point met, as the origin of the rest of the ray */
    ray = (sgt_ray){.o = full[0].p, .d = {1, 0, 0}};
    assert_int_equal(sgt_intersect_all(bowl_surface, ray, 2, hit, NULL), 1);
    REQUIRE(fabsl(hit[0].t - sqrtl(3)) <= hit[0].t_err + full[0].p_err, "from the first to the second: %.17g",
            hit[0].t);
}

static void test_rim(void **state)
{
    (void)state;
    sgt_conic shape = {.c = 1, .semi_diameter = 0.8};
    sgt_surface s = {&sgt_conic_ops, &shape};
    sgt_hit hit[2];
    assert_int_equal(sgt_intersect_all(s, across, 2, hit, NULL), 0); /* both at r = 0.866 */
    shape.semi_diameter = 0.9;
    assert_int_equal(sgt_intersect_all(s, across, 2, hit, NULL), 2);
    /* tilted: one at a larger radius than the other */
    sgt_ray tilted = {.o = {-1, 0, 0.4}, .d = {1, 0, -0.3}};
    shape.semi_diameter = 0;
    assert_int_equal(sgt_intersect_all(s, tilted, 2, hit, NULL), 2);
    shape.semi_diameter = 0.5 * (fabs(hit[0].p.x) + fabs(hit[1].p.x));
    bool first = fabs(hit[0].p.x) < fabs(hit[1].p.x);
    double inner = hit[!first].t;
    assert_int_equal(sgt_intersect_all(s, tilted, 2, hit, NULL), 1);
    REQUIRE(fabs(hit[0].t - inner) <= 2 * hit[0].t_err, "the root inside: %.17g, without a rim %.17g",
            hit[0].t, inner);
}

static void test_touching(void **state)
{
    (void)state;
    sgt_hit hit[4];
    /* tangent at the vertex: one entry (on a line: by the letter of sgt_ray no finite tmin is far enough
     * from a root of slope zero) */
    const sgt_ray tangent = {.o = {-5, 0, 0}, .d = {1, 0, 0}, .tmin = -FAR, .tmax = FAR};
    assert_int_equal(sgt_intersect_all(bowl_surface, tangent, 4, hit, NULL), 1);
    REQUIRE(hit[0].status == SGT_GRAZE && fabs(hit[0].t - 5) <= hit[0].t_err && hit[0].t_err < 1e-6,
        "tangent: %s at %.17g +- %g", sgt_status_text(hit[0].status), hit[0].t, hit[0].t_err);
    assert_int_equal(
        sgt_intersect_all(bowl_surface, (sgt_ray){.o = {-5, 0, -1e-9}, .d = {1, 0, 0}}, 4, hit, NULL), 0);
    assert_int_equal(
        sgt_intersect_all(bowl_surface, (sgt_ray){.o = {-5, 0, 1e-9}, .d = {1, 0, 0}}, 4, hit, NULL), 2);

    /* a plane: met once, or passed by, or the ray lies in it, and then as sgt_intersect has it */
    const sgt_conic flat = {0};
    const sgt_surface plane = {&sgt_conic_ops, &flat};
    assert_int_equal(sgt_intersect_all(plane, (sgt_ray){.o = {1, 2, -3}, .d = {0, 0.5, 2}}, 4, hit, NULL), 1);
    REQUIRE(hit[0].status == SGT_HIT && hit[0].t == 1.5 && hit[0].n.z == 1, "plane: %s at %g",
            sgt_status_text(hit[0].status), hit[0].t);
    assert_int_equal(sgt_intersect_all(plane, (sgt_ray){.o = {1, 2, -3}, .d = {1, 1, 0}}, 4, hit, NULL), 0);
    const double starts[][2] = {{0, 0}, {-1, 7}, {-FAR, FAR}, {-FAR, 3}, {2, FAR}};
    for (size_t i = 0; i < COUNT_OF(starts); i++) {
        sgt_ray in = {.o = {1, 2, 0}, .d = {1, 1, 0}, .tmin = starts[i][0], .tmax = starts[i][1]};
        sgt_hit first = sgt_intersect(plane, in, NULL);
        int n = sgt_intersect_all(plane, in, 4, hit, NULL);
        REQUIRE(n == (first.status != SGT_MISS), "in the plane from %g: %d entries, alone %s", in.tmin, n,
                sgt_status_text(first.status));
        if (n) REQUIRE(hit[0].status == first.status && (same_bits(hit[0].t, first.t) || first.status < 0),
            "in the plane from %g: %s at %g, alone %s at %g",
            in.tmin, sgt_status_text(hit[0].status), hit[0].t, sgt_status_text(first.status), first.t);
    }
}

/* Both roots of A t^2 - 2 B t + C, those on the sheet and inside the rim; -1: too close to tell. */
static int conic_roots(const sgt_conic *s, const sgt_ray *ray, long double root[2])
{
    wide o = widen(ray->o), d = widen(ray->d);
    long double c = s->c, e = 1 + (long double)s->k, A = c * (d.x * d.x + d.y * d.y + e * d.z * d.z);
    long double B = d.z - c * (o.x * d.x + o.y * d.y + e * o.z * d.z),
                C = c * (o.x * o.x + o.y * o.y + e * o.z * o.z) - 2 * o.z;
    long double D = B * B - A * C, size = fabsl(B * B) + fabsl(A * C);
    int n = 0;
    if (fabsl(D) < 1e-9L * size) return -1;
    if (D < 0) return 0;
    long double q = B < 0 ? B - sqrtl(D) : B + sqrtl(D), t[2] = {C / q, q / A};
    if (t[0] > t[1]) t[0] = t[1], t[1] = C / q;
    for (int i = 0; i < 2; i++) {
        if (!isfinite(t[i])) continue;
        wide p = wide_sum(o, wide_times(t[i], d));
        long double side = 1 - e * c * p.z, r2 = p.x * p.x + p.y * p.y,
                    rim2 = (long double)s->semi_diameter * s->semi_diameter;
        if (fabsl(side) < 1e-6L || (rim2 > 0 && fabsl(r2 - rim2) < 1e-6L * rim2)) return -1;
        if (fabsl(t[i] - ray->tmin) < 1e-6L || fabsl(t[i] - ray->tmax) < 1e-6L) return -1;
        if (side > 0 && (rim2 == 0 || r2 < rim2) && t[i] > ray->tmin && t[i] < ray->tmax) root[n++] = t[i];
    }
    return n;
}

static void test_conics(void **state)
{
    (void)state;
    generator g = seeded("conics");
    long n = scaled(20000), two = 0;
    for (long i = 0; i < n; i++) {
        sgt_conic s = {.c = chance(&g, 0.1) ? 0 : either_sign(&g) * log_uniform(&g, 1e-2, 1),
                       .k = chance(&g, 0.3)   ? 0
                            : chance(&g, 0.2) ? -1
                                              : uniform(&g, -4, 3),
                       .semi_diameter = chance(&g, 0.5) ? 0 : uniform(&g, 0.2, 2)};
        sgt_ray ray = {.o = random_point(&g, 3), .d = random_direction(&g)};
        ray.tmin = chance(&g, 0.5) ? -FAR : uniform(&g, -5, 1),
        ray.tmax = chance(&g, 0.5) ? FAR : uniform(&g, 2, 6);
        long double root[2];
        int want = conic_roots(&s, &ray, root);
        if (want < 0) continue;
        sgt_hit hit[MOST];
        int got = sgt_intersect_all((sgt_surface){&sgt_conic_ops, &s}, ray, MOST, hit, NULL);
        REQUIRE(got == want, "ray %ld: %d roots, %d in closed form (c %g k %g)", i, got, want, s.c, s.k);
        require_list("conic", i, got, hit);
        two += got == 2;
        for (int j = 0; j < got; j++) {
            REQUIRE(hit[j].status == SGT_HIT, "ray %ld: %s", i, sgt_status_text(hit[j].status));
            REQUIRE(fabsl(hit[j].t - root[j]) <= hit[j].t_err + 1e-15L * (0.1L + fabsl(root[j])),
                    "ray %ld: root %d at %.17g +- %g, %.19Lg in closed form", i, j, hit[j].t, hit[j].t_err,
                    root[j]);
        }
        if (got == 2) REQUIRE(along(&hit[0], &ray) * along(&hit[1], &ray) < 0, "ray %ld: enters twice", i);
    }
    REQUIRE(two > n / 50, "%ld rays with two roots", two);
}

/* --------------------------------------------------------------- aspheres */

/* z = r^2 (r^2 - 1) (r^2 - 4) / 8, cut by z = h along y: for h = 0 the roots are -2, -1, 1, 2 and a
 * touch at 0; for a small h > 0 the touch is two roots at about +- sqrt(2 h), for h < 0 it is none. */
static const sgt_even_asphere sextic = {.a = {0.5, -0.625, 0.125}};
static const sgt_surface sextic_surface = {&sgt_even_asphere_ops, &sextic};

static void test_four_and_a_touch(void **state)
{
    (void)state;
    sgt_hit hit[MOST];
    sgt_ray ray = {.o = {0, -3, 0}, .d = {0, 1, 0}};
    int n = sgt_intersect_all(sextic_surface, ray, MOST, hit, NULL);
    require_list("sextic", 0, n, hit);
    assert_int_equal(n, 5);
    static const double want[] = {1, 2, 3, 4, 5};
    for (int i = 0; i < 5; i++) {
        REQUIRE(i == 2 || hit[i].status == SGT_HIT, "root %d is %s", i, sgt_status_text(hit[i].status));
        REQUIRE(i != 2 || hit[i].status == SGT_GRAZE || hit[i].status == SGT_UNPROVEN, "the touch is %s",
                sgt_status_text(hit[i].status));
        REQUIRE(reported(want[i], 0, 1, &hit[i]) && (i == 2 || hit[i].t_err < 1e-13), "root %d: %.17g +- %g",
                i, hit[i].t, hit[i].t_err);
    }
    /* s is positive for |y| > 2, negative from 1 to 2, positive again */
    static const double slope[] = {1, -1, 0, 1, -1};
    for (int i = 0; i < 5; i++)
        REQUIRE(i == 2 || along(&hit[i], &ray) * slope[i] > 0, "root %d: slope %g", i, along(&hit[i], &ray));
}

/* The root of z = s near y, by Newton. */
static long double sextic_root(long double y, long double h)
{
    for (int k = 0; k < 60; k++) {
        long double q = y * y;
        y += (h - q * (q - 1) * (q - 4) / 8) / (y * (3 * q * q - 10 * q + 4) / 4);
    }
    return y;
}

static void test_nearly_touching(void **state)
{
    (void)state;
    generator g = seeded("nearly touching");
    long n = scaled(1000), undecided = 0, parted = 0;
    for (long i = 0; i < n; i++) {
        double h = either_sign(&g) * log_uniform(&g, 1e-40, 1e-2), start = uniform(&g, -4, -2.5);
        sgt_ray ray = {.o = {0, start, h}, .d = {0, 1, 0}};
        sgt_hit hit[MOST];
        int got = sgt_intersect_all(sextic_surface, ray, MOST, hit, NULL), middle = 0;
        require_list("nearly touching", i, got, hit);
        long double inner = sextic_root(sqrtl(2 * fabsl(h)), h), one = sextic_root(1, h),
                    two = sextic_root(2, h);
        long double root[] = {-two, -one, -inner, inner, one, two};
        for (int j = 0; j < got; j++) {
            long double off = 1;
            for (int k = 0; k < 6; k++)
                if (h > 0 || (k != 2 && k != 3)) off = fminl(off, fabsl(root[k] - start - hit[j].t));
            undecided += hit[j].status < 0, middle += fabs(hit[j].t + start) < 0.5;
            if (hit[j].status == SGT_HIT) REQUIRE(off <= hit[j].t_err + 1e-18L,
                /* long doubles tell no more */
                "ray %ld, z = %g: a hit at %.17g +- %g, %Lg from a root", i, h, hit[j].t, hit[j].t_err, off);
        }
        for (int k = 0; k < 6; k++) {
            if (h > 0 || (k != 2 && k != 3)) REQUIRE(reported(root[k] - start, 1e-18L, got, hit),
                "ray %ld, z = %g: the root at %.17Lg is in none of %d entries", i, h, root[k] - start, got);
        }
        parted += middle == 2;
        if (h > 1e-6) REQUIRE(middle == 2 && got == 6, "ray %ld, z = %g: %d entries", i, h, got);
        if (h < -1e-6) REQUIRE(middle == 0 && got == 4, "ray %ld, z = %g: %d entries", i, h, got);
    }
    REQUIRE(parted > n / 10, "%ld pairs parted", parted);
    print_message("%ld undecided stretches, %ld pairs told apart\n", undecided, parted);
}

/* Nearly flat aspheres, from a point on them: the rule of the start is then far less than an ulp of where
 * the ray begins or ends otherwise.  A root that the end of the ray is a little behind is found, and one
 * that its start is a little before, by some of that rule's widths. */
static void test_ends_beside(void **state)
{
    (void)state;
    generator g = seeded("ends beside a root");
    long n = scaled(4000), asked = 0;
    for (long i = 0; i < n; i++) {
        sgt_even_asphere s = {.c = 0,
                         .k = uniform(&g, -2, 1),
                         .a = {either_sign(&g) * log_uniform(&g, 1e-9, 1e-2), uniform(&g, -1, 1) * 1e-6,
                               uniform(&g, -1, 1) * 1e-7}};
        sgt_surface surface = {&sgt_even_asphere_ops, &s};
        sgt_vec3 p = {uniform(&g, -1, 1), uniform(&g, -1, 1), 0}, d = random_direction(&g);
        p.z = -surface.ops->value(&s, p, NULL);
        sgt_ray ray = {.o = p, .d = d, .tmin = -FAR, .tmax = FAR};
        sgt_hit on = sgt_intersect(surface, ray, &(sgt_options){.pick = SGT_NEAR_SEED});
        if (fabs(d.z) < 0.1 || on.status != SGT_HIT || fabs(on.t) > 1e-12) continue;
        double width = 0x1p-48 * (fabs(on.p.x * on.n.x) + fabs(on.p.y * on.n.y) + fabs(on.p.z)) /
                           fabs(along(&on, &ray)) +
                       2 * on.t_err,
               far = uniform(&g, 0.01, 3), steps = uniform(&g, 4, 20);
        for (int start = 0; start < 2; start++) {
            ray.tmin = start ? on.t - steps * width : -far, ray.tmax = start ? far : on.t + steps * width;
            if (ray.tmax == 0) continue;
            for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                sgt_hit hit[4], first = sgt_intersect(surface, ray, &(sgt_options){.pick = (sgt_pick)pick});
                int count = sgt_intersect_all(surface, ray, 4, hit, NULL);
                bool in = false;
                for (int j = 0; j < count && j < 4; j++)
                    in = in || (hit[j].lo <= on.t + on.t_err && hit[j].hi >= on.t - on.t_err);
                asked++;
                REQUIRE(in && first.status != SGT_MISS,
                        "case %ld: the root %.17g +- %g, %g widths from %s of [%.17g, %.17g], is in none of "
                        "%d entries, and pick %d says %s",
                        i, on.t, on.t_err, steps, start ? "the start" : "the end", ray.tmin, ray.tmax, count,
                        pick, sgt_status_text(first.status));
            }
        }
    }
    REQUIRE(asked > n, "%ld: these rays are no test", asked);
}

/* A ray that is tangent where the profile has no curvature meets it in three roots that are nearly one.
 * Where any is told, its normal is the gradient there. */
static void test_triple(void **state)
{
    (void)state;
    generator g = seeded("triple roots");
    long n = scaled(3000), told = 0;
    for (long i = 0; i < n; i++) {
        double c = chance(&g, 0.5) ? 0 : uniform(&g, -0.3, 0.3), k = uniform(&g, -2, 1),
               r = uniform(&g, 0.3, 1), a1 = either_sign(&g) * log_uniform(&g, 0.01, 0.5),
               about = uniform(&g, 0, 6.283185307179586);
        /* c r^2 / (1 + phi): its slope is c r / phi, and what that grows by c / phi^3 */
        double phi = sqrt(1 - (1 + k) * c * c * r * r), a0 = -6 * a1 * r * r - 0.5 * c / (phi * phi * phi);
        sgt_even_asphere s = {.c = c, .k = k, .a = {a0, a1}};
        double z = c * r * r / (1 + phi) + a0 * r * r + a1 * r * r * r * r,
               slope = c * r / phi + 2 * a0 * r + 4 * a1 * r * r * r, away = uniform(&g, 0.1, 3);
        sgt_vec3 d = {cos(about), sin(about), slope};
        sgt_ray ray = {
            .o = {(r - away) * d.x, (r - away) * d.y, z - away * slope}, .d = d, .tmax = away + 0.05};
        sgt_surface surface = {&sgt_even_asphere_ops, &s};
        sgt_hit hit[8];
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            int count = sgt_intersect_all(surface, ray, 7, hit, NULL);
            if (count > 7) count = 7;
            hit[count++] = sgt_intersect(surface, ray, &(sgt_options){.pick = (sgt_pick)pick});
            for (int j = 0; j < count; j++) {
                if (!(hit[j].status > 0)) continue;
                sgt_vec3 grad;
                surface.ops->value(&s, hit[j].p, &grad);
                wide off = wide_difference(widen(hit[j].n), widen(grad));
                REQUIRE(wide_length(off) < 1e-3L * wide_length(widen(grad)),
                        "ray %ld: n is {%g, %g, %g} where the gradient is {%g, %g, %g}; t %.17g +- %g", i,
                        hit[j].n.x, hit[j].n.y, hit[j].n.z, grad.x, grad.y, grad.z, hit[j].t, hit[j].t_err);
                told++;
            }
        }
    }
    print_message("%ld roots\n", told);
    REQUIRE(told > n, "%ld: these rays are no test", told);
}

/* ------------------------------------------------------ a torus of the user's */

/* F is the true distance: outside sqrt((sqrt(x^2 + y^2) - R)^2 + z^2) - r, and less inside. */
typedef struct torus {
    double major, minor;
    long *calls;     /* of value */
    int lie;         /* below */
    uint64_t *bits;
} torus;

static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double q = sqrt(p.x * p.x + p.y * p.y), w = q - s->major, m = sqrt(w * w + p.z * p.z);
    if (s->calls) ++*s->calls;
    if (grad) *grad = (sgt_vec3){w * p.x / (m * q), w * p.y / (m * q), p.z / m};
    return m - s->minor;
}
/* q is off by 2 u q, w by that and u w, m by no more than w and 3 u m, the difference by u. */
static double torus_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    return 0x1p-53 * 8 * (fabs(p.x) + fabs(p.y) + fabs(p.z) + s->major + s->minor);
}
static double torus_clearance(const void *self, sgt_vec3 p)
{
    sgt_vec3 unused;
    torus quiet = *(const torus *)self;
    quiet.calls = NULL;
    return fabs(torus_value(&quiet, p, &unused)) - torus_rounding(self, p);
}
/* a bold guess */
static double torus_estimate(const void *self, sgt_vec3 p) { return 2 * torus_clearance(self, p); }
static sgt_span torus_span(const void *self, const sgt_ray *ray)
{
    const torus *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    double R = (s->major + s->minor) * (1 + 1e-9), a = d.x * d.x + d.y * d.y + d.z * d.z;
    double t = -(o.x * d.x + o.y * d.y + o.z * d.z) / a, x = o.x + t * d.x, y = o.y + t * d.y,
           z = o.z + t * d.z;
    double half2 = (R * R - x * x - y * y - z * z) / a;
    if (half2 < 0) return (sgt_span){.lo = 1, .hi = -1, .seed = NOT};
    return (sgt_span){.lo = t - sqrt(half2), .hi = t + sqrt(half2), .seed = NOT};
}

/* Intervals, rounded outward. */
static sgt_interval outward(double lo, double hi)
{
    return (sgt_interval){nextafter(lo, -FAR), nextafter(hi, FAR)};
}
static sgt_interval plus(sgt_interval a, sgt_interval b) { return outward(a.lo + b.lo, a.hi + b.hi); }
static sgt_interval times(sgt_interval a, sgt_interval b)
{
    double w = a.lo * b.lo, x = a.lo * b.hi, y = a.hi * b.lo, z = a.hi * b.hi;
    return outward(fmin(fmin(w, x), fmin(y, z)), fmax(fmax(w, x), fmax(y, z)));
}
static sgt_interval square(sgt_interval a)
{
    double lo = a.lo > 0 ? a.lo : a.hi < 0 ? -a.hi : 0, hi = fmax(-a.lo, a.hi);
    return outward(lo * lo, hi * hi);
}
static sgt_interval root_of(sgt_interval a) { return outward(sqrt(fmax(a.lo, 0)), sqrt(a.hi)); }
static sgt_interval exactly(double x) { return (sgt_interval){x, x}; }
static sgt_interval over(sgt_interval a, sgt_interval b) /* b is not negative */
{
    if (!(b.lo > 0)) return (sgt_interval){-FAR, FAR};
    return times(a, outward(1 / b.hi, 1 / b.lo));
}
static sgt_interval torus_enclose(const void *self, const sgt_ray *r, sgt_interval t, sgt_interval *slope)
{
    const torus *s = self;
    sgt_interval x = plus(exactly(r->o.x), times(exactly(r->d.x), t)),
                 y = plus(exactly(r->o.y), times(exactly(r->d.y), t)),
                 z = plus(exactly(r->o.z), times(exactly(r->d.z), t));
    sgt_interval q = root_of(plus(square(x), square(y))), w = plus(q, exactly(-s->major)),
                 m = root_of(plus(square(w), square(z)));
    sgt_interval dq = over(plus(times(x, exactly(r->d.x)), times(y, exactly(r->d.y))), q);
    *slope = over(plus(times(w, dq), times(z, exactly(r->d.z))), m);
    return plus(m, exactly(-s->minor));
}

static long double torus_exact(const torus *s, const sgt_ray *ray, long double t)
{
    wide p = wide_sum(widen(ray->o), wide_times(t, widen(ray->d)));
    long double w = sqrtl(p.x * p.x + p.y * p.y) - s->major;
    return sqrtl(w * w + p.z * p.z) - s->minor;
}

static const sgt_surface_ops
    bare = {.name = "torus", .value = torus_value},
    spanned = {.name = "torus", .value = torus_value, .span = torus_span},
    rounded = {.name = "torus", .value = torus_value, .span = torus_span, .rounding = torus_rounding},
    cleared = {.name = "torus",
               .value = torus_value,
               .span = torus_span,
               .rounding = torus_rounding,
               .clearance = torus_clearance},
    enclosed = {.name = "torus",
                .value = torus_value,
                .span = torus_span,
                .rounding = torus_rounding,
                .enclose = torus_enclose},
    unbounded = {.name = "torus", .value = torus_value, .rounding = torus_rounding, .enclose = torus_enclose},
    complete = {.name = "torus",
                .value = torus_value,
                .span = torus_span,
                .rounding = torus_rounding,
                .clearance = torus_clearance,
                .enclose = torus_enclose},
    guessed = {.name = "torus",
               .value = torus_value,
               .span = torus_span,
               .rounding = torus_rounding,
               .estimate = torus_estimate};

static sgt_ray torus_ray(generator *g)
{
    sgt_vec3 d = random_direction(g),
             at = {uniform(g, -1.4, 1.4), uniform(g, -1.4, 1.4), uniform(g, -0.4, 0.4)};
    double away = uniform(g, 3, 20), length = chance(g, 0.3) ? log_uniform(g, 1e-3, 1e3) : 1;
    return (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z},
                     .d = {length * d.x, length * d.y, length * d.z}};
}

/* What dense samples in [lo, hi] show: the roots, the smallest gap between two, and how near to
 * zero |F| comes without changing its sign. */
enum { DENSE = 2000 };
typedef struct truth { int n; long double root[8], gap, near; } truth;

static truth dense(const torus *s, const sgt_ray *ray, long double lo, long double hi)
{
    truth r = {.gap = hi - lo, .near = 1e300L};
    long double a = lo, fa = torus_exact(s, ray, a), before = fa;
    for (int i = 1; i <= DENSE; i++) {
        long double b = lo + (hi - lo) * i / DENSE, fb = torus_exact(s, ray, b), l = a, m = b;
        if (fa * fb < 0) {
            for (int j = 0; j < 80; j++) {
                long double t = (l + m) / 2;
                if ((torus_exact(s, ray, t) < 0) == (fa < 0)) l = t;
                else m = t;
            }
            if (r.n) r.gap = fminl(r.gap, l - r.root[r.n - 1]);
            if (r.n < 8) r.root[r.n++] = l;
        } else if (i > 1 && fabsl(fa) <= fabsl(before) && fabsl(fa) <= fabsl(fb)
            && before * fa > 0) r.near = fminl(r.near, fabsl(fa)); /* a minimum of |F| */
        before = fa, a = b, fa = fb;
    }
    return r;
}

/* Each positive entry is a root of the exact torus; each root is in an entry, if it must be. */
static void require_truth(const char *what, long i, const torus *s, const sgt_ray *ray, int n,
                          const sgt_hit hit[], const truth *want, bool every)
{
    require_list(what, i, n, hit);
    for (int j = 0; j < n; j++) {
        if (hit[j].status != SGT_HIT) continue;
        /* where the surface does not tell its rounding */
        double slack = 4 * torus_rounding(s, hit[j].p) / fabs(along(&hit[j], ray));
        long double e = (long double)hit[j].t_err + slack, l = torus_exact(s, ray, hit[j].t - e),
                    r = torus_exact(s, ray, hit[j].t + e);
        REQUIRE(l * r <= 0, "%s %ld: no change of sign at %.17g +- %g: %Lg %Lg", what, i, hit[j].t,
                hit[j].t_err, l, r);
        REQUIRE(l == 0 || r == 0 || (along(&hit[j], ray) < 0) == (r < l),
                "%s %ld: enters where it leaves, at %.17g", what, i, hit[j].t);
        REQUIRE(hit[j].t_err <= 1e-5 * fabs(hit[j].t), "%s %ld: t_err %g", what, i, hit[j].t_err);
    }
    for (int k = 0; every && k < want->n; k++)
        REQUIRE(reported(want->root[k], 0, n, hit),
                "%s %ld: the root at %.17Lg, one of %d, is in none of %d entries", what, i, want->root[k],
                want->n, n);
}

/* sgt_intersect is the first of all. */
static void require_first(const char *what, long i, sgt_surface s, sgt_ray ray, const sgt_options *opt, int n,
                          const sgt_hit hit[])
{
    sgt_hit first = sgt_intersect(s, ray, opt);
    REQUIRE((n == 0) == (first.status == SGT_MISS), "%s %ld: %d entries, the first alone is %s", what, i, n,
            sgt_status_text(first.status));
    if (n && hit[0].status > 0)
        REQUIRE(first.status > 0 && fabs(first.t - hit[0].t) <= first.t_err + hit[0].t_err,
                "%s %ld: the first alone: %s at %.17g, of all %.17g", what, i, sgt_status_text(first.status),
                first.t, hit[0].t);
    if (n && hit[0].status < 0)
        REQUIRE(first.status < 0, "%s %ld: the first alone: %s, of all %s", what, i,
                sgt_status_text(first.status), sgt_status_text(hit[0].status));
}

/* Steps of 1/64 of the stretch: what is thicker than one is seen, a miss is never claimed. */
static void test_value_only(void **state)
{
    (void)state;
    generator g = seeded("value only");
    torus shape = {.major = 1, .minor = 0.4};
    const sgt_surface_ops *offers[] = {&bare, &spanned, &rounded};
    long n = scaled(2000), all = 0, four = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        const sgt_surface_ops *ops = offers[below(&g, 3)];
        sgt_surface s = {ops, &shape};
        double length = (double)wide_length(widen(ray.d));
        ray.tmax = 30 / length;
        sgt_span span = torus_span(&shape, &ray);
        bool by = span.lo > span.hi;
        double lo = ops->span && !by ? fmax(span.lo, 0) : 0,
               hi = ops->span && !by ? fmin(span.hi, ray.tmax) : ray.tmax;
        double dt = chance(&g, 0.5) ? 0 : (hi - lo) / uniform(&g, 100, 1000),
               step = dt > 0 ? dt : (hi - lo) / 64;
        truth want = dense(&shape, &ray, lo, hi);
        sgt_options opt = {.dt_min = dt, .max_evals = 100000};
        sgt_hit hit[MOST];
        int got = sgt_intersect_all(s, ray, MOST, hit, &opt);
        if (by && ops->span) {
            REQUIRE(got == 0, "ray %ld passes by: %d entries", i, got);
            continue;
        }
        bool thick = want.gap > 1.01L * step && want.n && want.root[0] - lo > 1.01L * step &&
                     hi - want.root[want.n - 1] > 1.01L * step;
        require_truth("value only", i, &shape, &ray, got, hit, &want, thick);
        require_first("value only", i, s, ray, &opt, got, hit);
        all += thick, four += want.n == 4;
        if (got == 0) fail_msg("ray %ld: a march is no proof of a miss", i);
        if (got == 1 && hit[0].status < 0) { /* found nothing: the whole stretch */
            REQUIRE(hit[0].status == SGT_UNPROVEN, "ray %ld: %s", i, sgt_status_text(hit[0].status));
            REQUIRE(hit[0].lo <= lo + 1e-9 * hi && hit[0].hi >= hi - 1e-9 * hi,
                "ray %ld: UNPROVEN in [%g, %g], all of [%g, %g] is", i, hit[0].lo, hit[0].hi, lo, hi);
            REQUIRE(want.n == 0 || !thick, "ray %ld: nothing seen", i);
        }
    }
    REQUIRE(all > n / 4 && four > n / 100, "%ld rays with all roots to be seen, %ld with four roots", all,
            four);
}

/* No root is farther than dt_min from where a step was not certain: where roots are thicker and |F|
 * does not come near zero all are found, and a miss is MISS. */
static void test_clearance(void **state)
{
    (void)state;
    generator g = seeded("clearance");
    torus shape = {.major = 1, .minor = 0.4};
    long n = scaled(2000), misses = 0, roots = 0, evals = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        double length = (double)wide_length(widen(ray.d)), dt = chance(&g, 0.5) ? 0 : 1e-4 / length;
        sgt_span span = torus_span(&shape, &ray);
        truth want = dense(&shape, &ray, span.lo, span.hi);
        sgt_options opt = {.dt_min = dt};
        sgt_hit hit[MOST];
        int got = sgt_intersect_all((sgt_surface){&cleared, &shape}, ray, MOST, hit, &opt);
        if (span.lo > span.hi) {
            REQUIRE(got == 0, "ray %ld passes by: %d entries", i, got);
            continue;
        }
        bool plain = want.near > 1e-2L && want.gap > 1e-2L / length;
        require_truth("clearance", i, &shape, &ray, got, hit, &want, plain);
        require_first("clearance", i, (sgt_surface){&cleared, &shape}, ray, &opt, got, hit);
        if (!plain) continue;
        REQUIRE(got == want.n, "ray %ld: %d entries, %d roots", i, got, want.n);
        misses += got == 0, roots += got;
        for (int j = 0; j < got; j++) evals += hit[j].evals;
    }
    REQUIRE(misses > n / 50 && roots > n / 2, "%ld misses, %ld roots", misses, roots);
    print_message("%ld certain misses, %ld roots, %.1f evaluations each\n", misses, roots,
                  (double)evals / (double)roots);
}

static void test_enclose(void **state)
{
    (void)state;
    generator g = seeded("enclose");
    torus shape = {.major = 1, .minor = 0.4};
    const sgt_surface_ops *offers[] = {&enclosed, &unbounded, &complete};
    long n = scaled(1500), misses = 0, roots = 0, four = 0, undecided = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        double length = (double)wide_length(widen(ray.d));
        ray.tmax = 30 / length;
        const sgt_surface_ops *ops = offers[below(&g, 3)];
        truth want = dense(&shape, &ray, 0, ray.tmax);
        sgt_hit hit[MOST];
        int got = sgt_intersect_all((sgt_surface){ops, &shape}, ray, MOST, hit, NULL);
        require_truth("enclose", i, &shape, &ray, got, hit, &want, true);
        require_first("enclose", i, (sgt_surface){ops, &shape}, ray, NULL, got, hit);
        int unsure = 0;
        for (int j = 0; j < got; j++) unsure += hit[j].status != SGT_HIT;
        undecided += unsure;
        if (!(want.near > 1e-4L) || !(want.gap > 0.1L / length)) continue;
        REQUIRE(got == want.n && !unsure, "ray %ld: %d entries, %d of them undecided, %d roots", i, got,
                unsure, want.n);
        misses += got == 0, roots += got, four += got == 4;
    }
    REQUIRE(misses > n / 20 && roots > n / 2 && four > n / 100, "%ld misses, %ld roots, %ld times four",
            misses, roots, four);
    print_message("%ld certain misses, %ld roots, four of them %ld times, %ld undecided\n", misses, roots,
                  four, undecided);
}

/* A corrugated sheet, z = a cos(2 pi x): along x it has roots without end. */
static double sheet_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const double a = *(const double *)self, turn = 2 * 3.141592653589793;
    if (grad) *grad = (sgt_vec3){a * turn * sin(turn * p.x), 0, 1};
    return p.z - a * cos(turn * p.x);
}

static double sheet_rounding(const void *self, sgt_vec3 p)
{
    return 1e-15 * (fabs(p.z) + *(const double *)self * (1 + fabs(p.x)));
}

/* cos(2 pi x) over x in [lo, hi], with room for libm's error. */
static sgt_interval cosine_over(double lo, double hi)
{
    double turn = 2 * 3.141592653589793, a = cos(turn * lo), b = cos(turn * hi),
           off = 1e-14 * (1 + fabs(lo) + fabs(hi));
    if (!(hi - lo < 1 && off < 1)) return (sgt_interval){-1, 1};
    bool most = ceil(lo - off) <= hi + off, least = ceil(lo - off - 0.5) + 0.5 <= hi + off;
    return (sgt_interval){least ? -1 : fmin(a, b) - off, most ? 1 : fmax(a, b) + off};
}

static sgt_interval sheet_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    double a = *(const double *)self, x = ray->o.x + t.lo * ray->d.x, far = ray->o.x + t.hi * ray->d.x,
           lo = fmin(x, far), hi = fmax(x, far);
    sgt_interval c = cosine_over(lo, hi), s = cosine_over(lo - 0.25, hi - 0.25);
    double z = ray->o.z + t.lo * ray->d.z, end = ray->o.z + t.hi * ray->d.z,
           off = 1e-14 * (1 + fabs(z) + fabs(end)), steep = a * 6.283185307179586 * fabs(ray->d.x);
    bool turned = ray->d.x < 0;
    *slope = (sgt_interval){ray->d.z + steep * (turned ? -s.hi : s.lo) - 1e-12,
                            ray->d.z + steep * (turned ? -s.lo : s.hi) + 1e-12};
    return (sgt_interval){fmin(z, end) - a * c.hi - off, fmax(z, end) - a * c.lo + off};
}

/* With `enclose` the first root is the first on a ray without an end, too; none is left out of the list. */
static void test_without_an_end(void **state)
{
    (void)state;
    generator g = seeded("without an end");
    long n = scaled(8);
    const sgt_surface_ops ops = {
        .value = sheet_value, .rounding = sheet_rounding, .enclose = sheet_enclose};
    for (long i = 0; i < n; i++) {
        double a = log_uniform(&g, 0.1, 1), z = a * uniform(&g, 0.5, 1 - 1e-9), turn = 2 * 3.141592653589793,
               off = acos(z / a) / turn, scale = log_uniform(&g, 1e-3, 1e3);
        sgt_ray ray = {{-uniform(&g, 1, 400), uniform(&g, -1, 1), z}, {scale, 0, 0}, 0, FAR};
        sgt_hit hit[MOST], first = sgt_intersect((sgt_surface){&ops, &a}, ray, NULL);
        int got = sgt_intersect_all((sgt_surface){&ops, &a}, ray, MOST, hit, NULL);
        REQUIRE(got >= MOST, "ray %ld: %d entries", i, got);
        double x = floor(ray.o.x) - 1; /* of the crest; roots are at x - off and x + off */
        int side = -1;
        for (int j = 0; j < MOST; j++) {
            do {
                side = -side;
                if (side < 0) x += 1;
            } while (x + side * off <= ray.o.x);
            double t = (x + side * off - ray.o.x) / scale, room = (1e-11 + 1e-14 / (1e-9 + off)) / scale;
            REQUIRE(hit[j].status == SGT_HIT && fabs(hit[j].t - t) <= hit[j].t_err + room,
                    "ray %ld: entry %d is %s at %.17g +- %g, the root at %.17g", i, j,
                    sgt_status_text(hit[j].status), hit[j].t, hit[j].t_err, t);
        }
        REQUIRE(first.status == SGT_HIT && fabs(first.t - hit[0].t) <= first.t_err + hit[0].t_err,
                "ray %ld: the first is told at %.17g, and listed at %.17g", i, first.t, hit[0].t);
    }
}

/* A guess is no proof: with it, no MISS but where the span says so; without dt_min it is not read. */
static void test_estimate(void **state)
{
    (void)state;
    generator g = seeded("estimate");
    torus shape = {.major = 1, .minor = 0.4};
    long n = scaled(2000), late = 0, nothing = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        double length = (double)wide_length(widen(ray.d));
        sgt_span span = torus_span(&shape, &ray);
        if (span.lo > span.hi) continue;
        truth want = dense(&shape, &ray, span.lo, span.hi);
        sgt_options opt = {.dt_min = log_uniform(&g, 1e-4, 1e-1) / length};
        sgt_hit hit[MOST], other[MOST];
        int unread = sgt_intersect_all((sgt_surface){&guessed, &shape}, ray, MOST, hit, NULL);
        REQUIRE(unread == sgt_intersect_all((sgt_surface){&rounded, &shape}, ray, MOST, other, NULL),
                "ray %ld: the guess is read without dt_min", i);
        for (int j = 0; j < unread; j++)
            REQUIRE(same_bits(hit[j].t, other[j].t), "ray %ld: the guess is read without dt_min", i);
        int got = sgt_intersect_all((sgt_surface){&guessed, &shape}, ray, MOST, hit, &opt);
        require_truth("estimate", i, &shape, &ray, got, hit, &want, false);
        require_first("estimate", i, (sgt_surface){&guessed, &shape}, ray, &opt, got, hit);
        REQUIRE(got > 0, "ray %ld: a guess is no proof of a miss", i);
        if (hit[0].status < 0) {
            REQUIRE(hit[0].status == SGT_UNPROVEN && got == 1, "ray %ld: %s, and %d entries", i,
                    sgt_status_text(hit[0].status), got);
            REQUIRE(hit[0].lo <= span.lo + 1e-9 && hit[0].hi >= span.hi - 1e-9,
                    "ray %ld: UNPROVEN in [%g, %g] only", i, hit[0].lo, hit[0].hi);
            nothing++;
        } else late += want.n && hit[0].t > want.root[0] + hit[0].t_err + 1e-12;
    }
    print_message("%ld late, %ld unproven\n", late, nothing);
}

/* One root at most, and F changes sign at it: so says the span. */
static double wave_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad) *grad = (sgt_vec3){-0.3 * cos(p.x), 0.3 * sin(p.y), 1};
    return p.z - 0.3 * sin(p.x) - 0.3 * cos(p.y);
}
static sgt_span wave_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double a = (-1 - ray->o.z) / ray->d.z, b = (1 - ray->o.z) / ray->d.z;
    return (sgt_span){.lo = fmin(a, b), .hi = fmax(a, b), .seed = -ray->o.z / ray->d.z, .single = true};
}

static void test_single(void **state)
{
    (void)state;
    generator g = seeded("single");
    const sgt_surface s = {&(sgt_surface_ops){.name = "waves", .value = wave_value, .span = wave_span}, NULL};
    long n = scaled(3000), missed = 0;
    for (long i = 0; i < n; i++) {
        sgt_vec3 o = random_point(&g, 5);
        sgt_ray ray = {.o = o,
                       .d = {uniform(&g, -1, 1), uniform(&g, -1, 1), either_sign(&g) * uniform(&g, 1, 2)},
                       .tmin = -FAR,
                       .tmax = FAR};
        if (chance(&g, 0.5)) ray.tmax = uniform(&g, -2, 2);
        long double lo = -20, hi = 20; /* F is monotone along all of these rays */
        for (int j = 0; j < 90; j++) {
            long double t = (lo + hi) / 2, x = o.x + t * ray.d.x, y = o.y + t * ray.d.y,
                        z = o.z + t * ray.d.z;
            if ((z - 0.3L * sinl(x) - 0.3L * cosl(y) < 0) == (ray.d.z > 0)) lo = t;
            else hi = t;
        }
        if (fabsl(lo - ray.tmax) < 1e-9L) continue;
        sgt_hit hit[MOST];
        int got = sgt_intersect_all(s, ray, MOST, hit, NULL);
        require_list("single", i, got, hit);
        REQUIRE(got == (lo < ray.tmax), "ray %ld: %d entries, the root is %Lg, tmax %g", i, got, lo,
                ray.tmax);
        missed += got == 0;
        if (got)
            REQUIRE(hit[0].status == SGT_HIT && fabsl(hit[0].t - lo) <= hit[0].t_err + 1e-14,
                    "ray %ld: %s at %.17g +- %g, the root is %.17Lg", i, sgt_status_text(hit[0].status),
                    hit[0].t, hit[0].t_err, lo);
    }
    REQUIRE(missed > n / 20, "%ld misses", missed);
}

/* A line without a beginning: the march does not start, unless the span begins it. */
static void test_no_beginning(void **state)
{
    (void)state;
    torus shape = {.major = 1, .minor = 0.4};
    sgt_ray line = {.o = {1.1, 0.1, 7}, .d = {0.01, 0.02, -1}, .tmin = -FAR, .tmax = FAR};
    sgt_hit hit[MOST];
    assert_int_equal(sgt_intersect_all((sgt_surface){&bare, &shape}, line, MOST, hit, NULL), 1);
    REQUIRE(hit[0].status == SGT_UNPROVEN && hit[0].lo == -FAR && hit[0].hi == FAR,
        "%s in [%g, %g]", sgt_status_text(hit[0].status), hit[0].lo, hit[0].hi);
    assert_int_equal(sgt_intersect_all((sgt_surface){&spanned, &shape}, line, MOST, hit, NULL), 2);
    assert_int_equal(sgt_intersect_all((sgt_surface){&complete, &shape}, line, MOST, hit, NULL), 2);
    /* and one without an end, which it looks along as far as its steps go */
    line.tmin = 0;
    int got = sgt_intersect_all((sgt_surface){&bare, &shape}, line, MOST, hit, NULL);
    truth want = dense(&shape, &line, 0, 30);
    require_truth("no end", 0, &shape, &line, got, hit, &want, true);
}

/* ------------------------------------------------- budget, watcher, misuse */

typedef struct counter { int calls, stop_at; } counter;
static int count(void *data, const sgt_step *step)
{
    counter *c = data;
    (void)step;
    return ++c->calls == c->stop_at;
}

static const struct { const sgt_surface_ops *ops; const void *self;
} watched[] = {
    {&rounded, &(torus){.major = 1, .minor = 0.4}},
    {&bare, &(torus){.major = 1, .minor = 0.4}},
    {&cleared, &(torus){.major = 1, .minor = 0.4}},
    {&complete, &(torus){.major = 1, .minor = 0.4}},
    {&sgt_conic_ops, &(sgt_conic){.c = -0.5}},
    {&sgt_even_asphere_ops, &(sgt_even_asphere){.a = {0.5, -0.625, 0.125}}},
    {&sgt_julia_ops, &(sgt_julia){.c = {-0.2, 0.8, 0, 0}, .iterations = 6}},
    {&sgt_mandelbrot_ops, &(sgt_mandelbrot){.iterations = 5}},
};

static void test_watcher(void **state)
{
    (void)state;
    generator g = seeded("watcher");
    long n = scaled(400);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        ray.tmax = 30 / (double)wide_length(widen(ray.d));
        for (size_t k = 0; k < COUNT_OF(watched); k++) {
            sgt_surface s = {watched[k].ops, watched[k].self};
            sgt_hit plain[MOST], hit[MOST];
            int alone = sgt_intersect_all(s, ray, MOST, plain, NULL);
            counter c = {0};
            int got = sgt_intersect_all(s, ray, MOST, hit, &(sgt_options){.watch = count, .watch_data = &c});
            long spent = 0;
            REQUIRE(got == alone, "ray %ld, surface %zu: %d entries, watched %d", i, k, alone, got);
            for (int j = 0; j < got; j++) {
                REQUIRE(hit[j].status == plain[j].status && hit[j].evals == plain[j].evals &&
                            (same_bits(hit[j].t, plain[j].t)),
                        "ray %ld, surface %zu: entry %d is another when watched", i, k, j);
                spent += hit[j].evals;
            }
            REQUIRE(spent <= c.calls, "ray %ld, surface %zu: %ld evaluations in the entries, %d seen", i, k,
                    spent, c.calls);
            if (c.calls == 0) continue;
            counter stopping = {.stop_at = 1 + below(&g, c.calls)};
            sgt_hit stopped[MOST];
            int left = sgt_intersect_all(s, ray, MOST, stopped,
                                         &(sgt_options){.watch = count, .watch_data = &stopping});
            require_list("stopped", i, left, stopped);
            REQUIRE(stopping.calls == stopping.stop_at,
                    "ray %ld, surface %zu: asked to stop at %d, went on to %d", i, k, stopping.stop_at,
                    stopping.calls);
            REQUIRE(left >= 1 && stopped[left - 1].status == SGT_STOPPED,
                    "ray %ld, surface %zu: the last of %d entries is %s", i, k, left,
                    left < 1 ? "none" : sgt_status_text(stopped[left - 1].status));
            spent = 0;
            for (int j = 0; j < left; j++) spent += stopped[j].evals;
            REQUIRE(spent == stopping.calls, "ray %ld, surface %zu: %ld evaluations in the entries, %d seen",
                    i, k, spent, stopping.calls);
            for (int j = 0; j < left - 1; j++)
                REQUIRE(j < got && stopped[j].status == hit[j].status && same_bits(stopped[j].t, hit[j].t),
                        "ray %ld, surface %zu: entry %d is another than without the stop", i, k, j);
            for (int j = left - 1; j < got; j++)
                if (hit[j].status > 0)
                    REQUIRE(stopped[left - 1].lo <= hit[j].t + hit[j].t_err &&
                                stopped[left - 1].hi >= hit[j].t - hit[j].t_err,
                            "ray %ld, surface %zu: stopped, [%g, %g] left, and a root at %g", i, k,
                            stopped[left - 1].lo, stopped[left - 1].hi, hit[j].t);
        }
    }
}

static void test_budget(void **state)
{
    (void)state;
    generator g = seeded("budget");
    long n = scaled(300), exhausted = 0;
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        ray.tmax = 30 / (double)wide_length(widen(ray.d));
        for (size_t k = 0; k < COUNT_OF(watched); k++) {
            sgt_surface s = {watched[k].ops, watched[k].self};
            sgt_hit full[MOST], hit[MOST];
            int all = sgt_intersect_all(s, ray, MOST, full, NULL),
                budget = 1 + below(&g, chance(&g, 0.5) ? 10 : 100);
            counter c = {0};
            int got = sgt_intersect_all(
                s, ray, MOST, hit, &(sgt_options){.max_evals = budget, .watch = count, .watch_data = &c});
            require_list("budget", i, got, hit);
            for (int j = 0; j < got; j++) {
                REQUIRE(hit[j].evals <= budget + 1,
                        /* one more confirms a root */
                        "ray %ld, surface %zu: entry %d took %d evaluations of %d", i, k, j, hit[j].evals,
                        budget);
                REQUIRE(hit[j].status != SGT_EXHAUSTED || j == got - 1,
                        "ray %ld, surface %zu: entry %d of %d is exhausted, and the search went on", i, k, j,
                        got);
            }
            REQUIRE(c.calls <= (got + 1) * (budget + 1),
                    "ray %ld, surface %zu: %d evaluations for %d entries, %d allowed for each", i, k, c.calls,
                    got, budget);
            exhausted += got && hit[got - 1].status == SGT_EXHAUSTED;
            for (int j = 0; j < all; j++)
                if (full[j].status == SGT_HIT && k != 0 && k != 1)
                    REQUIRE(reported(full[j].t, full[j].t_err, got, hit),
                            "ray %ld, surface %zu, %d evaluations: the root at %.17g is in none of %d "
                            "entries, the last of them %s in [%.17g, %.17g]",
                            i, k, budget, full[j].t, got, got ? sgt_status_text(hit[got - 1].status) : "none",
                            got ? hit[got - 1].lo : 0, got ? hit[got - 1].hi : 0);
            if (got && hit[got - 1].status == SGT_EXHAUSTED) /* what is left, to its end */
                for (int j = 0; j < all; j++)
                    REQUIRE(full[j].t <= hit[got - 1].hi || full[j].lo <= hit[got - 1].hi,
                            "ray %ld, surface %zu: [%g, %g] left, an entry at %g", i, k, hit[got - 1].lo,
                            hit[got - 1].hi, full[j].t);
        }
    }
    REQUIRE(exhausted > n / 4, "%ld searches exhausted", exhausted);
}

static void test_invalid(void **state)
{
    (void)state;
    torus shape = {.major = 1, .minor = 0.4};
    const sgt_surface s = {&complete, &shape};
    const sgt_ray good = {.o = {0, 0, -5}, .d = {0.3, 0, 1}};
    sgt_ray rays[16];
    size_t n = 0;
    for (size_t i = 0; i < COUNT_OF(rays); i++) rays[i] = good;
    rays[n++].d = (sgt_vec3){0, 0, 0};
    rays[n++].d = (sgt_vec3){0, 1e-310, 0};
    rays[n++].d.x = NOT;
    rays[n++].d.z = -FAR;
    rays[n++].o.x = NOT;
    rays[n++].o.y = FAR;
    rays[n++].tmin = NOT;
    rays[n++].tmax = NOT;
    rays[n].tmin = 2, rays[n++].tmax = 1;
    const sgt_conic broken = {.c = NOT};
    const sgt_julia lost = {.power = 9};
    const sgt_julia plain_set = {.power = 2};
    const sgt_surface surfaces[] = {s, bowl_surface, {&sgt_julia_ops, &plain_set}};
    sgt_hit hit[2];
    memset(hit, 0x5a, sizeof hit);
    for (size_t k = 0; k < COUNT_OF(surfaces); k++) {
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(sgt_intersect_all(surfaces[k], rays[i], 2, hit, NULL), SGT_INVALID);
            assert_int_equal(sgt_intersect_all(surfaces[k], rays[i], 0, NULL, NULL), SGT_INVALID);
        }
        const sgt_options bad[] = {{.t_tol = -1},  {.t_tol = NOT},  {.f_tol = -1},    {.f_tol = NOT},
                                   {.dt_min = -1}, {.dt_min = NOT}, {.max_evals = -1}};
        for (size_t i = 0; i < COUNT_OF(bad); i++)
            assert_int_equal(sgt_intersect_all(surfaces[k], good, 2, hit, &bad[i]), SGT_INVALID);
    }
    assert_int_equal(sgt_intersect_all((sgt_surface){NULL, NULL}, good, 2, hit, NULL), SGT_INVALID);
    assert_int_equal(
        sgt_intersect_all((sgt_surface){&(sgt_surface_ops){.span = torus_span}, &shape}, good, 2, hit, NULL),
        SGT_INVALID);
    assert_int_equal(sgt_intersect_all((sgt_surface){&sgt_conic_ops, &broken}, good, 2, hit, NULL),
                     SGT_INVALID);
    assert_int_equal(sgt_intersect_all((sgt_surface){&sgt_julia_ops, &lost}, good, 2, hit, NULL),
                     SGT_INVALID);
    /* pick is not read */
    sgt_hit plain[2];
    assert_int_equal(sgt_intersect_all(bowl_surface, across, 2, plain, NULL), 2);
    for (sgt_pick pick = SGT_PICK_DEFAULT; pick <= SGT_NEAR_SEED; pick++) {
        assert_int_equal(sgt_intersect_all(bowl_surface, across, 2, hit, &(sgt_options){.pick = pick}), 2);
        assert_true(same_bits(hit[0].t, plain[0].t) && same_bits(hit[1].t, plain[1].t));
    }
}

/* The direction's length is a unit of t, no more. */
static void test_scale_of_direction(void **state)
{
    (void)state;
    generator g = seeded("scale of the direction");
    static const int powers[] = {1, -1, 40, -40, 300, -300};
    long n = scaled(200);
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        for (size_t k = 0; k < COUNT_OF(watched); k++) {
            sgt_surface s = {watched[k].ops, watched[k].self};
            sgt_hit plain[MOST], hit[MOST];
            int alone = sgt_intersect_all(s, ray, MOST, plain, NULL);
            for (size_t j = 0; j < COUNT_OF(powers); j++) {
                sgt_ray other = ray;
                double by = ldexp(1, powers[j]);
                other.d = (sgt_vec3){by * ray.d.x, by * ray.d.y, by * ray.d.z};
                int got = sgt_intersect_all(s, other, MOST, hit, NULL);
                REQUIRE(got == alone, "ray %ld, surface %zu, d times 2^%d: %d entries, were %d", i, k,
                        powers[j], got, alone);
                for (int e = 0; e < got; e++)
                    REQUIRE(hit[e].status == plain[e].status &&
                                (same_bits(hit[e].t * by, plain[e].t) || !isfinite(plain[e].t)) &&
                                (hit[e].t_err * by == plain[e].t_err || !isfinite(plain[e].t_err)),
                            "ray %ld, surface %zu, d times 2^%d: entry %d: %s at %.17g, was %s at %.17g", i,
                            k, powers[j], e, sgt_status_text(hit[e].status), hit[e].t * by,
                            sgt_status_text(plain[e].status), plain[e].t);
            }
        }
    }
}

/* ---------------------------------------------------- surfaces with bad manners */

enum {
    NAN_ISLANDS,
    NAN_EVERYWHERE,
    INFINITE_ISLANDS,
    NO_SLOPE,
    NAN_SLOPE,
    WRONG_SLOPE,
    RANDOM_SLOPE, /* value */
    NAN_SPAN,
    INFINITE_SPAN,
    NAN_SEED,
    NO_ROUNDING,
    HUGE_ROUNDING,
    CLEARANCE_NAN,
    CLEARANCE_NEGATIVE,
    CLEARANCE_INFINITE,
    CLEARANCE_HUGE,
    CLEARANCE_TINY,
    CLEARANCE_RANDOM,
    ENCLOSE_NAN,
    ENCLOSE_ALL,
    ENCLOSE_NOTHING,
    ENCLOSE_POSITIVE,
    ENCLOSE_POINT,
    ENCLOSE_NAN_SLOPE,
    ENCLOSE_WRONG_SLOPE,
    ENCLOSE_RANDOM,
    ESTIMATE_NAN,
    ESTIMATE_NEGATIVE,
    ESTIMATE_INFINITE,
    ESTIMATE_TINY,
    ESTIMATE_RANDOM,
    LIES
};

static double any_number(uint64_t *bits)
{
    static const double special[] = {0, -0.0, 1, -1, 1e-300, -1e-300, 1e300, -1e300, DBL_MIN / 4};
    generator g = {*bits};
    int k = below(&g, 14);
    double x = k < 9     ? special[k]
               : k == 9  ? NOT
               : k == 10 ? FAR
               : k == 11 ? -FAR
                         : either_sign(&g) * log_uniform(&g, 1e-12, 1e3);
    *bits = g.state;
    return x;
}

static double lying_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double f = torus_value(self, p, grad), by = 1;
    switch (s->lie) {
    case NAN_ISLANDS: if (sin(9 * p.x) > 0.5) f = by = NOT; break;
    case INFINITE_ISLANDS: if (sin(9 * p.y) > 0.5) f = copysign(FAR, f); break;
    case NAN_EVERYWHERE: f = by = NOT; break;
    case NO_SLOPE: by = 0; break;
    case NAN_SLOPE: by = NOT; break;
    case WRONG_SLOPE: by = -3; break;
    case RANDOM_SLOPE: by = any_number(s->bits); break;
    default: break;
    }
    if (grad && by != 1) *grad = (sgt_vec3){by * grad->x, by * grad->y, by * grad->z};
    return f;
}
static double lying_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    return s->lie == NO_ROUNDING ? -1 : s->lie == HUGE_ROUNDING ? FAR : torus_rounding(self, p);
}
static sgt_span lying_span(const void *self, const sgt_ray *ray)
{
    const torus *s = self;
    sgt_span span = torus_span(self, ray);
    if (s->lie == NAN_SPAN) span.lo = span.hi = NOT;
    if (s->lie == INFINITE_SPAN) span.lo = -FAR, span.hi = FAR, span.seed = FAR;
    if (s->lie == NAN_SEED) span.seed = -NOT;
    return span;
}
static double lying_clearance(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    switch (s->lie) {
    case CLEARANCE_NAN: return NOT;
    case CLEARANCE_NEGATIVE: return -1;
    case CLEARANCE_INFINITE: return FAR;
    case CLEARANCE_HUGE: return 1e300;
    case CLEARANCE_TINY: return 1e-300;
    case CLEARANCE_RANDOM: return any_number(s->bits);
    default: return torus_clearance(self, p);
    }
}
static double lying_estimate(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    switch (s->lie) {
    case ESTIMATE_NAN: return NOT;
    case ESTIMATE_NEGATIVE: return -1;
    case ESTIMATE_INFINITE: return FAR;
    case ESTIMATE_TINY: return 1e-300;
    case ESTIMATE_RANDOM: return any_number(s->bits);
    default: return torus_estimate(self, p);
    }
}
static sgt_interval lying_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const torus *s = self;
    sgt_interval g = torus_enclose(self, ray, t, slope), all = {-FAR, FAR}, not = {NOT, NOT};
    switch (s->lie) {
    case ENCLOSE_NAN: return *slope = not, not;
    case ENCLOSE_ALL: return *slope = all, all;
    case ENCLOSE_NOTHING: return *slope = all, (sgt_interval){1, -1};
    case ENCLOSE_POSITIVE: return (sgt_interval){1, 2};
    case ENCLOSE_POINT: return *slope = exactly(1), exactly(0);
    case ENCLOSE_NAN_SLOPE: return *slope = not, g;
    case ENCLOSE_WRONG_SLOPE: return *slope = (sgt_interval){1, 2}, g;
    case ENCLOSE_RANDOM:
        slope->lo = any_number(s->bits), slope->hi = any_number(s->bits);
        return (sgt_interval){any_number(s->bits), any_number(s->bits)};
    default: return g;
    }
}

static double random_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    (void)p;
    ++*s->calls;
    if (grad) *grad = (sgt_vec3){any_number(s->bits), any_number(s->bits), any_number(s->bits)};
    return any_number(s->bits);
}

/* Every lie, with every offer beside it that is true: never a hang, nor a hit without a change of
 * sign; what is spent is bounded by the budget. */
static void test_lies(void **state)
{
    (void)state;
    generator g = seeded("lies");
    uint64_t bits = random_bits(&g);
    long n = scaled(60), hits = 0, calls = 0;
    const sgt_surface_ops offers[] = {
        {.value = lying_value},
        {.value = lying_value, .clearance = lying_clearance},
        {.value = lying_value, .enclose = lying_enclose},
        {.value = lying_value, .span = lying_span, .estimate = lying_estimate},
        {.value = lying_value, .span = lying_span, .rounding = lying_rounding},
        {.value = lying_value, .span = lying_span, .rounding = lying_rounding, .clearance = lying_clearance},
        {.value = lying_value, .span = lying_span, .rounding = lying_rounding, .enclose = lying_enclose},
        {.value = lying_value,
         .span = lying_span,
         .rounding = lying_rounding,
         .clearance = lying_clearance,
         .estimate = lying_estimate,
         .enclose = lying_enclose},
    };
    for (long i = 0; i < n; i++) {
        sgt_ray ray = torus_ray(&g);
        double length = (double)wide_length(widen(ray.d));
        if (chance(&g, 0.5)) ray.tmax = 30 / length;
        if (chance(&g, 0.2)) ray.tmin = -FAR, ray.tmax = FAR;
        for (int lie = 0; lie < LIES; lie++)
            for (size_t k = 0; k < COUNT_OF(offers); k++) {
                torus shape = {.major = 1, .minor = 0.4, .calls = &calls, .lie = lie, .bits = &bits};
                sgt_options opt = {.max_evals = chance(&g, 0.5) ? 0 : 100,
                                   .dt_min = chance(&g, 0.5) ? 0 : log_uniform(&g, 1e-3, 1) / length};
                sgt_hit hit[MOST];
                long before = calls, budget = opt.max_evals ? opt.max_evals : 2000;
                int got = sgt_intersect_all((sgt_surface){&offers[k], &shape}, ray, MOST, hit, &opt),
                    kept = got < MOST ? got : MOST;
                REQUIRE(got >= 0, "ray %ld, lie %d, offer %zu: %d", i, lie, k, got);
                REQUIRE(calls - before <= (got + 1) * (budget + 1),
                        "ray %ld, lie %d, offer %zu: %ld evaluations for %d entries", i, lie, k,
                        calls - before, got);
                require_list("lie", i, kept, hit);
                for (int j = 0; j < kept; j++) {
                    if (hit[j].status != SGT_HIT) continue;
                    hits++;
                    sgt_vec3 n0;
                    torus honest = {.major = 1, .minor = 0.4};
                    torus_value(&honest, hit[j].p, &n0);
                    double slack = 4 * torus_rounding(&honest, hit[j].p) /
                                   fabs(n0.x * ray.d.x + n0.y * ray.d.y + n0.z * ray.d.z);
                    long double e = (long double)hit[j].t_err + slack,
                                l = torus_exact(&honest, &ray, hit[j].t - e),
                                r = torus_exact(&honest, &ray, hit[j].t + e);
                    REQUIRE(l * r <= 0,
                            "ray %ld, lie %d, offer %zu: a hit at %.17g +- %g, and no change of sign", i, lie,
                            k, hit[j].t, hit[j].t_err);
                }
                sgt_hit first = sgt_intersect((sgt_surface){&offers[k], &shape}, ray, &opt);
                REQUIRE(first.status != SGT_INVALID, "ray %ld, lie %d, offer %zu: invalid", i, lie, k);
            }
        /* an oracle of noise */
        torus shape = {.major = 1, .minor = 0.4, .calls = &calls, .lie = CLEARANCE_RANDOM, .bits = &bits};
        sgt_surface_ops noise = offers[below(&g, COUNT_OF(offers))];
        noise.value = random_value;
        sgt_hit hit[MOST];
        long before = calls;
        int got = sgt_intersect_all((sgt_surface){&noise, &shape}, ray, MOST, hit,
                                    &(sgt_options){.max_evals = 200});
        REQUIRE(got >= 0 && calls - before <= (long)(got + 1) * 201,
                "ray %ld: noise: %d entries, %ld evaluations", i, got, calls - before);
    }
    REQUIRE(hits > n * LIES, "%ld hits", hits);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bowl),
        cmocka_unit_test(test_cap),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_rim),
        cmocka_unit_test(test_touching),
        cmocka_unit_test(test_conics),
        cmocka_unit_test(test_four_and_a_touch),
        cmocka_unit_test(test_nearly_touching),
        cmocka_unit_test(test_ends_beside),
        cmocka_unit_test(test_triple),
        cmocka_unit_test(test_value_only),
        cmocka_unit_test(test_clearance),
        cmocka_unit_test(test_enclose),
        cmocka_unit_test(test_without_an_end),
        cmocka_unit_test(test_estimate),
        cmocka_unit_test(test_single),
        cmocka_unit_test(test_no_beginning),
        cmocka_unit_test(test_watcher),
        cmocka_unit_test(test_budget),
        cmocka_unit_test(test_invalid),
        cmocka_unit_test(test_scale_of_direction),
        cmocka_unit_test(test_lies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
