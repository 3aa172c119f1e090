// SPDX-License-Identifier: MIT
/* sgt_trace against a tracer of twenty lines in long double, and its promises one by one:
 * fates, apertures and what they have to say in the choice of a root, paths, far launches. */
#include "unit.h"

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

/* ------------------------------------------------- the tracer to compare with */

typedef struct wide_ray { wide o, d; } wide_ray;

static wide local_of(const sgt_pose *p, wide a)
{
    if (p->ex.x == 0 && p->ex.y == 0 && p->ex.z == 0) return a;
    return (wide){wide_dot(a, widen(p->ex)), wide_dot(a, widen(p->ey)), wide_dot(a, widen(p->ez))};
}

static wide global_of(const sgt_pose *p, wide a)
{
    if (p->ex.x == 0 && p->ex.y == 0 && p->ex.z == 0) return a;
    return wide_sum(wide_times(a.x, widen(p->ex)),
                    wide_sum(wide_times(a.y, widen(p->ey)), wide_times(a.z, widen(p->ez))));
}

/* The conic's root near the vertex plane that lies on the sheet; false: none, or too close to
 * call. */
static bool wide_conic(const sgt_conic *s, wide_ray r, long double *t, wide *normal)
{
    long double c = s->c, k1 = 1 + (long double)s->k, t0 = -r.o.z / r.d.z;
    wide p = wide_sum(r.o, wide_times(t0, r.d));
    long double A = c * (r.d.x * r.d.x + r.d.y * r.d.y + k1 * r.d.z * r.d.z),
                B = r.d.z - c * (p.x * r.d.x + p.y * r.d.y), C = c * (p.x * p.x + p.y * p.y),
                D = B * B - A * C;
    if (!(D > 1e-3L * B * B)) return false;
    long double q = B + copysignl(sqrtl(D), B), root[2] = {C / q, q / A};
    for (int i = 0; i < (A != 0 ? 2 : 1); i++) {
        wide at = wide_sum(p, wide_times(root[i], r.d));
        long double v = 1 - k1 * c * at.z;
        if (fabsl(v) < 1e-3L) return false;
        if (v < 0) continue;
        *t = t0 + root[i];
        *normal = wide_unit((wide){-c * at.x, -c * at.y, v});
        return true;
    }
    return false;
}

/* As far as it can: how many it passed; point, direction (both local) and path at each. */
static size_t wide_trace(size_t n, const sgt_element e[], long double index, wide_ray r, wide p[], wide d[],
                         long double opl[], bool *sure)
{
    long double path = 0;
    *sure = true;
    for (size_t i = 0; i < n; i++) {
        wide_ray q = {local_of(&e[i].pose, wide_difference(r.o, widen(e[i].pose.origin))),
                      wide_unit(local_of(&e[i].pose, r.d))};
        long double t;
        wide N;
        *sure = wide_conic(e[i].surface.self, q, &t, &N);
        if (!*sure) return i;
        p[i] = wide_sum(q.o, wide_times(t, q.d));
        path += index * t;
        /* at grazing incidence, or from far away, an error measures the problem */
        *sure = fabsl(wide_dot(q.d, N)) > 0.2L && wide_length(p[i]) < 40 && fabsl(t) < 100;
        if (!*sure) return i;
        long double behind = e[i].index == 0 || e[i].index == SGT_MIRROR ? index : (long double)e[i].index,
                    ratio = index / behind, c = wide_dot(q.d, N);
        if (e[i].index == SGT_MIRROR) {
            d[i] = wide_difference(q.d, wide_times(2 * c, N));
        } else {
            long double Q = 1 - ratio * ratio * (1 - c * c);
            *sure = fabsl(Q) > 1e-3L;
            if (!*sure || Q < 0) return i;
            d[i] = wide_sum(wide_times(ratio, q.d), wide_times(copysignl(sqrtl(Q), c) - ratio * c, N));
        }
        opl[i] = path;
        r.o = wide_sum(global_of(&e[i].pose, p[i]), widen(e[i].pose.origin));
        r.d = wide_unit(global_of(&e[i].pose, d[i]));
        index = behind;
    }
    return n;
}

/* ------------------------------------------------------------ random lenses */

enum { ELEMENTS = 8 };
typedef struct lens { sgt_conic shape[ELEMENTS]; sgt_element e[ELEMENTS]; double length; } lens;

static void random_lens(generator *g, lens *l)
{
    double z = 0, step = 1;
    *l = (lens){.length = 1};
    for (int i = 0; i < ELEMENTS; i++) {
        l->shape[i] = (sgt_conic){.c = chance(g, 0.2) ? 0 : either_sign(g) / log_uniform(g, 8, 1000),
                                  .k = chance(g, 0.5) ? 0 : uniform(g, -2, 1)};
        sgt_vec3 origin = {uniform(g, -0.2, 0.2), uniform(g, -0.2, 0.2), z};
        l->e[i] = (sgt_element){.surface = {&sgt_conic_ops, &l->shape[i]}, .pose = {.origin = origin}};
        if (chance(g, 0.5)) l->e[i].pose = sgt_pose_tilted(origin, random_point(g, chance(g, 0.5) ? 5 : 30));
        if (chance(g, 0.1)) l->e[i].index = SGT_MIRROR, step = -step;
        else l->e[i].index = chance(g, 0.1) ? 0 : i & 1 ? 1 : uniform(g, 1.3, 2);
        z += step * uniform(g, 0.5, 6);
        l->length = fmax(l->length, fabs(z));
    }
}

static sgt_ray random_launch(generator *g)
{
    sgt_ray ray = {.o = {uniform(g, -2, 2), uniform(g, -2, 2), -uniform(g, 1, 20)},
                   .d = {uniform(g, -0.2, 0.2), uniform(g, -0.2, 0.2), 1}};
    double by = chance(g, 0.3) ? log_uniform(g, 1e-150, 1e150) : 1;
    ray.d = (sgt_vec3){by * ray.d.x, by * ray.d.y, by * ray.d.z};
    return ray;
}

static long double apart(wide a, sgt_vec3 b) { return wide_length(wide_difference(a, widen(b))); }

static void test_against_wide(void **state)
{
    (void)state;
    generator g = seeded("random lenses");
    long n = scaled(20000), rows = 0, through = 0;
    long double worst_p = 0, worst_d = 0, worst_path = 0;
    for (long i = 0; i < n; i++) {
        lens l;
        random_lens(&g, &l);
        sgt_ray ray = random_launch(&g), launch = ray;
        sgt_passage passage[ELEMENTS];
        sgt_fate fate;
        double before = chance(&g, 0.5) ? 0 : uniform(&g, 1, 1.5);
        size_t passed = sgt_trace(ELEMENTS, l.e, before, &ray, passage, &fate, NULL);
        wide p[ELEMENTS], d[ELEMENTS];
        long double opl[ELEMENTS], scale = fmax(l.length, fabs(launch.o.z));
        bool sure;
        size_t want = wide_trace(ELEMENTS, l.e, before == 0 ? 1 : before,
                                 (wide_ray){widen(launch.o), wide_unit(widen(launch.d))}, p, d, opl, &sure);
        REQUIRE(passed >= want, "lens %ld: %s at %zu, %zu passed", i, sgt_fate_text(fate), passed, want);
        REQUIRE(!sure || passed == want, "lens %ld: passed %zu, stopped at %zu", i, passed, want);
        for (size_t j = 0; j < want; j++, rows++) {
            worst_p = fmaxl(worst_p, apart(p[j], passage[j].hit.p) / scale);
            worst_d = fmaxl(worst_d, apart(wide_unit(d[j]), passage[j].direction));
            worst_path = fmaxl(worst_path, fabsl(opl[j] - passage[j].opl) / scale);
        }
        if (passed == ELEMENTS) {
            through++;
            if (want == passed) {
                wide end = wide_sum(global_of(&l.e[ELEMENTS - 1].pose, p[ELEMENTS - 1]),
                                    widen(l.e[ELEMENTS - 1].pose.origin));
                REQUIRE(apart(end, ray.o) <= 1e-12L * scale &&
                            apart(wide_unit(global_of(&l.e[ELEMENTS - 1].pose, d[ELEMENTS - 1])), ray.d) <=
                                1e-12L,
                        "lens %ld: the ray handed back is not the last", i);
            }
        }
        REQUIRE((passed == ELEMENTS) == (fate == SGT_PASSED), "lens %ld: passed %zu, %s", i, passed,
                sgt_fate_text(fate));
    }
    print_message(
        "%ld passages, %ld of %ld rays through; point %.2Lg of the length, direction %.2Lg, path %.2Lg\n",
        rows, through, n, worst_p, worst_d, worst_path);
    REQUIRE(worst_p < 1e-12L && worst_d < 1e-12L && worst_path < 1e-12L, "point %Lg, direction %Lg, path %Lg",
            worst_p, worst_d, worst_path);
}

/* There and back again. */
static void test_reversed(void **state)
{
    (void)state;
    generator g = seeded("reversed");
    long n = scaled(5000), back = 0;
    for (long i = 0; i < n; i++) {
        lens l;
        random_lens(&g, &l);
        bool mirrors = false;
        double index[ELEMENTS + 1] = {1};
        for (int j = 0; j < ELEMENTS; j++) {
            mirrors = mirrors || l.e[j].index == SGT_MIRROR;
            index[j + 1] = l.e[j].index == 0 ? index[j] : l.e[j].index;
        }
        if (mirrors) continue;
        sgt_ray ray = random_launch(&g), launch = ray;
        sgt_passage there[ELEMENTS], here[ELEMENTS];
        sgt_trace(0, NULL, 1, &launch, NULL, NULL, NULL);
        if (sgt_trace(ELEMENTS, l.e, 1, &ray, there, NULL, NULL) < ELEMENTS) continue;
        sgt_element reversed[ELEMENTS];
        bool steep = false;
        for (int j = 0; j < ELEMENTS; j++) {
            reversed[j] = l.e[ELEMENTS - 1 - j], reversed[j].index = index[ELEMENTS - 1 - j];
            wide in = wide_unit(widen(there[j].hit.n));
            steep = steep || fabsl(wide_dot(in, widen(there[j].direction))) < 0.2L;
        }
        if (steep) continue;
        ray.d = (sgt_vec3){-ray.d.x, -ray.d.y, -ray.d.z};
        sgt_fate fate;
        size_t passed = sgt_trace(ELEMENTS, reversed, index[ELEMENTS], &ray, here, &fate, NULL);
        bool other = false; /* a line may meet a surface twice; the seed is another from the other side */
        for (size_t j = 0; j < passed; j++)
            other = other || apart(widen(there[ELEMENTS - 1 - j].hit.p), here[j].hit.p) > 1e-6L;
        if (other) continue;
        REQUIRE(passed == ELEMENTS, "lens %ld: %s on the way back", i, sgt_fate_text(fate));
        REQUIRE(apart(widen(launch.d), (sgt_vec3){-ray.d.x, -ray.d.y, -ray.d.z}) < 1e-11L,
                "lens %ld: another direction", i);
        back++;
    }
    print_message("%ld rays back\n", back);
    assert_true(back > 0);
}

/* ------------------------------------------------------------------- fates */

static sgt_element flat_at(const sgt_conic *flat, double z, double index)
{
    return (sgt_element){.surface = {&sgt_conic_ops, flat}, .pose = {.origin = {0, 0, z}}, .index = index};
}

static void test_fates(void **state)
{
    (void)state;
    static const char *const text[] = {"lost", "missed", "passed", "clipped", "tir"};
    for (int i = SGT_LOST; i <= SGT_TIR; i++)
        assert_string_equal(sgt_fate_text((sgt_fate)i), text[i - SGT_LOST]);
    assert_string_equal(sgt_fate_text((sgt_fate)99), "?");

    sgt_conic flat = {0}, ball = {.c = 1};
    const sgt_ray launch = {.o = {0, 0.3, -1}, .d = {0, 0, 2}};
    sgt_passage p[3];
    sgt_fate fate;
    sgt_ray ray = launch;

    /* clipped: met, with a path, no direction; the ray stays at the element before */
    sgt_element e[3] = {flat_at(&flat, 0, 1.5), flat_at(&flat, 1, 1), flat_at(&flat, 2, 0)};
    e[1].semi_diameter = 0.25;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 1);
    assert_int_equal(fate, SGT_CLIPPED);
    assert_true(p[1].hit.status == SGT_HIT && p[1].opl == 2.5 && p[1].direction.z == 0 &&
                p[1].hit.p.y == 0.3);
    assert_true(ray.o.z == 0 && ray.o.y == 0.3 && ray.d.z == 1);

    /* on the rim, and soft by a part in 2^44 of r^2 */
    e[1].semi_diameter = 0.3;
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 3);
    e[1].semi_diameter = 0.3 * (1 - 0x1p-47);
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 3);
    e[1].semi_diameter = 0.3 * (1 - 0x1p-43);
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 1);
    assert_int_equal(fate, SGT_CLIPPED);
    e[1].semi_diameter = FAR;
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 3);

    /* missed: the line passes the sphere by */
    e[1] = (sgt_element){.surface = {&sgt_conic_ops, &ball}, .pose = {.origin = {0, 5, 1}}, .index = 1.5};
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 1);
    assert_int_equal(fate, SGT_MISSED);
    assert_true(p[1].hit.status == SGT_MISS && isnan(p[1].hit.t) && isnan(p[1].opl));
    e[1].semi_diameter = 2;
    ray = launch;
    assert_int_equal(sgt_trace(3, e, 1, &ray, p, &fate, NULL), 1);
    assert_int_equal(fate, SGT_MISSED);

    /* total reflection */
    e[0] = flat_at(&flat, 0, 0);
    e[1] = flat_at(&flat, 1, 1);
    ray = (sgt_ray){.o = {0, 0, -1}, .d = {0, 0.8, 0.6}};
    assert_int_equal(sgt_trace(2, e, 1.5, &ray, p, &fate, NULL), 1);
    assert_int_equal(fate, SGT_TIR);
    assert_true(p[1].hit.status == SGT_HIT && p[1].direction.y == 0 &&
                fabs(p[1].opl - 1.5 * 2 / 0.6) < 1e-14);

    /* backwards: a negative stretch counts negative */
    e[0] = flat_at(&flat, 3, 1.5), e[1] = flat_at(&flat, 1, 1);
    ray = launch;
    assert_int_equal(sgt_trace(2, e, 1, &ray, p, &fate, NULL), 2);
    assert_true(p[0].opl == 4 && p[1].opl == 1 && p[1].hit.t == -2 && ray.d.z == 1 && ray.o.z == 1);
}

static void test_invalid(void **state)
{
    (void)state;
    sgt_conic flat = {0}, broken = {.c = NOT};
    const sgt_element good = flat_at(&flat, 0, 1.5);
    const sgt_ray launch = {.o = {0, 0.3, -1}, .d = {0, 0, 1}};
    const double bad_index[] = {-0.5, -2, NOT, FAR, -FAR};
    sgt_passage p[2];
    sgt_fate fate;
    for (size_t i = 0; i < COUNT_OF(bad_index); i++) {
        sgt_element e[2] = {good, good};
        e[1].index = bad_index[i];
        sgt_ray ray = launch;
        REQUIRE(sgt_trace(2, e, 1, &ray, p, &fate, NULL) == 1 && fate == SGT_LOST &&
                    p[1].hit.status == SGT_INVALID,
                "index %g behind", bad_index[i]);
        ray = launch;
        REQUIRE(sgt_trace(2, e, bad_index[i], &ray, p, &fate, NULL) == 0 && fate == SGT_LOST &&
                    p[0].hit.status == SGT_INVALID && isnan(p[0].hit.t),
                "index %g in front", bad_index[i]);
    }
    sgt_ray ray = launch;
    assert_true(sgt_trace(1, &good, SGT_MIRROR, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST);
    const sgt_ray bad_ray[] = {
        {.d = {0, 0, 0}},
        {.d = {1e-310, 0, 0}},
        {.d = {NOT, 0, 1}},
        {.d = {0, 0, FAR}},
        {.o = {NOT, 0, 0}, .d = {0, 0, 1}},
        {.o = {0, FAR, 0}, .d = {0, 0, 1}},
    };
    for (size_t i = 0; i < COUNT_OF(bad_ray); i++)
        for (size_t n = 0; n < 2; n++) {
            ray = bad_ray[i];
            REQUIRE(sgt_trace(n, &good, 1, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST,
                    "bad ray %zu of %zu", i, n);
            REQUIRE(n == 0 || p[0].hit.status == SGT_INVALID, "bad ray %zu: %s", i,
                    sgt_status_text(p[0].hit.status));
            REQUIRE(same_vector(ray.o, bad_ray[i].o) && same_vector(ray.d, bad_ray[i].d),
                    "bad ray %zu is changed", i);
        }
    sgt_element e = good;
    e.surface.self = &broken;
    ray = launch;
    assert_true(sgt_trace(1, &e, 1, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST &&
                p[0].hit.status == SGT_INVALID);
    e = good, e.surface.ops = NULL;
    ray = launch;
    assert_true(sgt_trace(1, &e, 1, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST &&
                p[0].hit.status == SGT_INVALID);
    e = good, e.pose = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){NOT, 0, 0});
    ray = launch;
    assert_true(sgt_trace(1, &e, 1, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST &&
                p[0].hit.status == SGT_INVALID);
    for (int i = 0; i < 2; i++) {
        e = good, e.semi_diameter = i ? -1 : NOT;
        ray = launch;
        assert_true(sgt_trace(1, &e, 1, &ray, p, &fate, NULL) == 0 && fate == SGT_LOST &&
                    p[0].hit.status == SGT_INVALID);
    }
    /* what later versions may ask for */
    enum { RESERVED = sizeof e.reserved_ / sizeof e.reserved_[0] };
    static const sgt_phase unknown = {.focal_length = 1};
    for (size_t i = 0; i < RESERVED + 1; i++) {
        sgt_element two[2] = {good, good};
        if (i == RESERVED) two[1].phase = &unknown;
        else two[1].reserved_[i] = 1ULL << (i % 2 ? 63 : 0);
        ray = launch;
        REQUIRE(sgt_trace(2, two, 1, &ray, p, &fate, NULL) == 1 && fate == SGT_LOST &&
                    p[1].hit.status == SGT_INVALID && ray.o.z == 0,
                "reserved %zu", i);
        sgt_status status = SGT_HIT;
        sgt_fate lost = SGT_PASSED;
        int passed = -1;
        sgt_rays rays = {.o = {&launch.o.x, &launch.o.y, &launch.o.z},
                         .d = {&launch.d.x, &launch.d.y, &launch.d.z}};
        const sgt_passages passages[2] = {{.opl = NULL}, {.hits = {.status = &status}}};
        assert_int_equal(sgt_trace_batch(2, two, 1, 1, rays, (sgt_traced){.fate = &lost, .passed = &passed},
                                         passages, NULL),
                         0);
        assert_true(status == SGT_INVALID && lost == SGT_LOST && passed == 1);
    }
    ray = launch;
    assert_true(sgt_trace(1, &good, 1, &ray, p, &fate, &(sgt_options){.t_tol = NOT}) == 0 &&
                fate == SGT_LOST && p[0].hit.status == SGT_INVALID);
}

/* Outputs that nobody wants, and nothing to trace. */
static void test_nothing_wanted(void **state)
{
    (void)state;
    generator g = seeded("nothing wanted");
    for (int i = 0; i < 200; i++) {
        lens l;
        random_lens(&g, &l);
        sgt_ray launch = random_launch(&g), a = launch, b = launch, c = launch;
        sgt_passage p[ELEMENTS];
        sgt_fate fate;
        size_t n = sgt_trace(ELEMENTS, l.e, 1, &a, p, &fate, NULL);
        REQUIRE(sgt_trace(ELEMENTS, l.e, 0, &b, NULL, NULL, NULL) == n && same_vector(a.o, b.o) &&
                    same_vector(a.d, b.d),
                "lens %d: another trace without outputs", i);
        assert_int_equal(sgt_trace(0, l.e, 1, &c, NULL, &fate, NULL), 0);
        assert_int_equal(fate, SGT_PASSED);
        REQUIRE(same_vector(c.o, launch.o) && fabsl(wide_length(widen(c.d)) - 1) < 2e-16L,
                "lens %d: the launch", i);
        if (n == 0)
            REQUIRE(same_vector(a.o, launch.o) && same_vector(a.d, c.d), "lens %d: a ray that passed nothing",
                    i);
        /* again, from where it came out: of unit length already, so to the bit */
        sgt_ray d = c;
        sgt_trace(0, NULL, 1, &d, NULL, NULL, NULL);
        REQUIRE(same_vector(c.d, d.d), "lens %d: a unit direction is changed", i);
    }
}

/* ---------------------------------------------------------------- apertures */

/* A bowl whose own guess is a crossing of its caller's choice. */
typedef struct guided { sgt_even_asphere bowl; sgt_vec3 guess; } guided;

static double guided_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return sgt_even_asphere_ops.value(&((const guided *)self)->bowl, p, grad);
}
static double guided_rounding(const void *self, sgt_vec3 p)
{
    return sgt_even_asphere_ops.rounding(&((const guided *)self)->bowl, p);
}
static sgt_span guided_span(const void *self, const sgt_ray *ray)
{
    const guided *s = self;
    sgt_span span = sgt_even_asphere_ops.span(&s->bowl, ray);
    sgt_vec3 o = ray->o, d = ray->d;
    double a = d.x * d.x + d.y * d.y + d.z * d.z, nearest = -(o.x * d.x + o.y * d.y + o.z * d.z) / a;
    /* a hyperboloid has no end */
    span.lo = fmax(span.lo, nearest - 2 / sqrt(a)), span.hi = fmin(span.hi, nearest + 2 / sqrt(a));
    span.seed = ((s->guess.x - o.x) * d.x + (s->guess.y - o.y) * d.y + (s->guess.z - o.z) * d.z) / a;
    return span;
}
static const sgt_surface_ops guided_ops = {
    .name = "guided", .value = guided_value, .span = guided_span, .rounding = guided_rounding};

/* A bowl that a low ray meets twice, inside 0.5 and outside.  Whatever the pick leads to first,
 * with an aperture of 0.5 the crossing inside it is meant. */
static void test_aperture_chooses(void **state)
{
    (void)state;
    generator g = seeded("aperture chooses");
    long n = scaled(20000), chosen = 0;
    for (long i = 0; i < n; i++) {
        guided s = {.bowl = {.c = 1, .k = chance(&g, 0.5) ? 0 : uniform(&g, -1.5, 0.2)}};
        if (chance(&g, 0.5)) s.bowl.a[1] = 0.05;
        double ra = uniform(&g, 0.05, 0.4), rb = uniform(&g, 0.6, 0.85), a = uniform(&g, 0, 6.28),
               b = uniform(&g, 0, 6.28);
        sgt_vec3 inner = {ra * cos(a), ra * sin(a), 0}, outer = {rb * cos(b), rb * sin(b), 0};
        inner.z = -sgt_even_asphere_ops.value(&s.bowl, inner, NULL),
        outer.z = -sgt_even_asphere_ops.value(&s.bowl, outer, NULL);
        bool guess_outer = chance(&g, 0.7);
        s.guess = guess_outer ? outer : inner;
        sgt_vec3 d = {inner.x - outer.x, inner.y - outer.y, inner.z - outer.z};
        double way = either_sign(&g), away = uniform(&g, -3, 6);
        sgt_ray launch = {
            .o = {outer.x - way * away * d.x, outer.y - way * away * d.y, outer.z - way * away * d.z},
            .d = {way * d.x, way * d.y, way * d.z}};
        sgt_element e = {.index = 1};
        if (chance(&g, 0.3))
            e.pose = (sgt_pose){.ex = {0, 1, 0}, .ey = {-1, 0, 0}, .ez = {0, 0, 1}},
            launch.o = (sgt_vec3){-launch.o.y, launch.o.x, launch.o.z},
            launch.d = (sgt_vec3){-launch.d.y, launch.d.x, launch.d.z};
        const sgt_surface surfaces[] = {{&sgt_even_asphere_ops, &s.bowl}, {&guided_ops, &s}};
        for (size_t k = 0; k < COUNT_OF(surfaces); k++)
            for (sgt_pick pick = SGT_PICK_DEFAULT; pick <= SGT_NEAR_SEED; pick++) {
                /* the two are farther apart than dt_min; t_tol: else it follows from the aperture */
                sgt_options opt = {.pick = pick, .dt_min = 0.02, .max_evals = 100000, .t_tol = 1e-14};
                sgt_passage p, plain;
                sgt_fate fate;
                sgt_ray ray = launch;
                e.surface = surfaces[k];
                sgt_trace(1, &e, 1, &ray, &plain, &fate, &opt); /* no aperture: what the pick leads to */
                REQUIRE(fate == SGT_PASSED, "ray %ld without an aperture: %s", i, sgt_fate_text(fate));
                bool to_outer = pick == SGT_FIRST ? way > 0 : k == 1 && guess_outer;
                const sgt_vec3 *meant = to_outer ? &outer : &inner;
                REQUIRE(fabs(plain.hit.p.x - meant->x) < 1e-9 && fabs(plain.hit.p.y - meant->y) < 1e-9,
                        "ray %ld, surface %zu, pick %d: another crossing without an aperture", i, k,
                        (int)pick);
                e.semi_diameter = 0.5;
                ray = launch;
                sgt_trace(1, &e, 1, &ray, &p, &fate, &opt);
                REQUIRE(fate == SGT_PASSED,
                        "ray %ld, surface %zu, pick %d: %s (%s) at r %g, a crossing at %g", i, k, (int)pick,
                        sgt_fate_text(fate), sgt_status_text(p.hit.status), hypot(p.hit.p.x, p.hit.p.y), ra);
                REQUIRE(fabs(p.hit.p.x - inner.x) < 1e-9 && fabs(p.hit.p.y - inner.y) < 1e-9,
                        "ray %ld, surface %zu, pick %d: another crossing", i, k, (int)pick);
                if (to_outer) {
                    chosen++;
                    REQUIRE(p.hit.evals > plain.hit.evals,
                            "ray %ld: %d evaluations, %d for the first search alone", i, p.hit.evals,
                            plain.hit.evals);
                } else {
                    REQUIRE(p.hit.evals == plain.hit.evals, "ray %ld: the aperture costs evaluations", i);
                }
                e.semi_diameter = 0.02; /* holds neither */
                ray = launch;
                sgt_trace(1, &e, 1, &ray, &p, &fate, &opt);
                REQUIRE(fate == SGT_CLIPPED && p.hit.status > 0, "ray %ld, both outside: %s", i,
                        sgt_fate_text(fate));
                REQUIRE(fabs(p.hit.t - plain.hit.t) < 1e-9, "ray %ld, both outside: clipped at another root",
                        i);
                e.semi_diameter = 0;
            }
    }
    print_message("%ld times chosen by the aperture\n", chosen);
    assert_true(chosen > 0);
}

/* Proven in an aperture, so is a root proven in a smaller one, whose edge is next to it: the ray comes in
 * through the edge there, so that the start of its part inside is next to the root as well. */
static void test_edge_of_the_aperture(void **state)
{
    (void)state;
    generator g = seeded("edge of the aperture");
    long proven = 0;
    for (long i = 0, n = scaled(4000); i < n; i++) {
        sgt_even_asphere bowl = {.c = uniform(&g, 0.5, 1),
                                 .a = {0, uniform(&g, -0.3, 0.3), uniform(&g, -0.3, 0.3)}};
        sgt_odd_asphere odd = {.c = bowl.c, .a = {0, 0, uniform(&g, -0.1, 0.1)}};
        const sgt_torus torus = {.major = 0.4, .minor = 0.5};
        const sgt_surface surfaces[] = {
            {&sgt_even_asphere_ops, &bowl}, {&sgt_odd_asphere_ops, &odd}, {&sgt_torus_ops, &torus}};
        const double r = uniform(&g, 0.3, 0.8), a = uniform(&g, 0, 6.28), steep = log_uniform(&g, 0.05, 2),
                     gap = log_uniform(&g, 1e-15, 1e-11), away = uniform(&g, 0, 5);
        sgt_element e = {.index = 1, .surface = surfaces[below(&g, 3)]};
        sgt_vec3 p = {r * cos(a), r * sin(a), 0}, d = {-cos(a + 0.3), -sin(a + 0.3), steep};
        if (e.surface.self == &torus) p.z = -sqrt(0.25 - (r - 0.4) * (r - 0.4));
        else p.z = -e.surface.ops->value(e.surface.self, p, NULL);
        const sgt_ray launch = {.o = {p.x - away * d.x, p.y - away * d.y, p.z - away * d.z}, .d = d};
        const sgt_options opt = {.pick = SGT_NEAR_SEED, .proof = SGT_PROVE_FIRST};
        sgt_passage broad, narrow;
        sgt_fate fate;
        e.semi_diameter = r * (1 + 1e-4);
        sgt_ray ray = launch;
        sgt_trace(1, &e, 1, &ray, &broad, &fate, &opt);
        if (fate != SGT_PASSED) continue; /* another root is inside, too, or is the one that is near */
        const double at = hypot(broad.hit.p.x, broad.hit.p.y);
        if (fabs(at - r) > 1e-12) continue;
        e.semi_diameter = at * (1 + gap) + 4 * broad.hit.p_err;
        ray = launch;
        sgt_trace(1, &e, 1, &ray, &narrow, &fate, &opt);
        proven++;
        REQUIRE(fate == SGT_PASSED && fabs(narrow.hit.t - broad.hit.t) <= broad.hit.t_err + narrow.hit.t_err,
                "case %ld: %s (%s), r %.17g within %.17g; %s in a wider one", i, sgt_fate_text(fate),
                sgt_status_text(narrow.hit.status), at, e.semi_diameter, e.surface.ops->name);
    }
    print_message("%ld proven\n", proven);
    assert_true(proven > 0);
}

/* An aperture far larger than the lens stands for none, and costs no precision. */
static void test_wide_aperture(void **state)
{
    (void)state;
    generator g = seeded("wide aperture");
    const double wide_ones[] = {1e3, 1e10, 1e100, 1e300, FAR};
    for (long i = 0, n = scaled(500); i < n; i++) {
        sgt_even_asphere bowl = {.c = uniform(&g, -0.1, 0.1), .a = {0, uniform(&g, -1e-4, 1e-4)}};
        sgt_element e = {
            .surface = {&sgt_even_asphere_ops, &bowl}, .index = 1.5, .pose = {.origin = {0, 0, 0.01}}};
        sgt_ray launch = {.o = {uniform(&g, -2, 2), uniform(&g, -2, 2), -1},
                          .d = {uniform(&g, -0.1, 0.1), uniform(&g, -0.1, 0.1), 1}},
                ray = launch;
        sgt_passage plain, p;
        assert_int_equal(sgt_trace(1, &e, 1, &ray, &plain, NULL, NULL), 1);
        for (size_t k = 0; k < COUNT_OF(wide_ones); k++) {
            e.semi_diameter = wide_ones[k];
            ray = launch;
            assert_int_equal(sgt_trace(1, &e, 1, &ray, &p, NULL, NULL), 1);
            REQUIRE(fabs(p.hit.t - plain.hit.t) < 2e-14 && p.hit.t_err < 2e-14,
                    "ray %ld, aperture %g: t %.17g, %.17g without; t_err %g", i, wide_ones[k], p.hit.t,
                    plain.hit.t, p.hit.t_err);
        }
    }
}

/* ------------------------------------------------------------ near and far */

/* The lens at 2^30 from the origin of the world: the same to the bit, in its own frames. */
static void test_far_lens(void **state)
{
    (void)state;
    generator g = seeded("far lens");
    for (long i = 0, n = scaled(500); i < n; i++) {
        lens l;
        random_lens(&g, &l);
        sgt_vec3 shift = {0x1p30 * below(&g, 3), -0x1p30 * below(&g, 3), 0x1p30};
        sgt_ray near = random_launch(&g), far;
        /* on a grid of 2^-20, so that the shift is exact */
        near.o = (sgt_vec3){rint(near.o.x * 0x1p20) * 0x1p-20, rint(near.o.y * 0x1p20) * 0x1p-20,
                            rint(near.o.z * 0x1p20) * 0x1p-20};
        far = near, far.o = (sgt_vec3){near.o.x + shift.x, near.o.y + shift.y, near.o.z + shift.z};
        lens m = l;
        for (int j = 0; j < ELEMENTS; j++) {
            sgt_vec3 o = l.e[j].pose.origin;
            o = (sgt_vec3){rint(o.x * 0x1p20) * 0x1p-20, rint(o.y * 0x1p20) * 0x1p-20,
                           rint(o.z * 0x1p20) * 0x1p-20};
            l.e[j].pose.origin = o,
            m.e[j].pose.origin = (sgt_vec3){o.x + shift.x, o.y + shift.y, o.z + shift.z};
        }
        sgt_passage here[ELEMENTS], there[ELEMENTS];
        size_t a = sgt_trace(ELEMENTS, l.e, 1, &near, here, NULL, NULL),
               b = sgt_trace(ELEMENTS, m.e, 1, &far, there, NULL, NULL);
        REQUIRE(a == b, "lens %ld: passed %zu here and %zu there", i, a, b);
        for (size_t j = 0; j < a; j++)
            REQUIRE(same_vector(here[j].hit.p, there[j].hit.p) &&
                        same_vector(here[j].direction, there[j].direction) &&
                        same_bits(here[j].opl, there[j].opl),
                    "lens %ld: element %zu differs", i, j);
        REQUIRE(same_vector(near.d, far.d), "lens %ld: another direction", i);
    }
}

static int last_t(void *data, const sgt_step *step)
{
    *(double *)data = step->t;
    return 0;
}

/* A ray that meets the tube of a torus beyond the clear aperture, and then within it.  With few evaluations
 * it passes or is lost: what lies within the aperture and is undecided is not clipped. */
static void test_few_evaluations(void **state)
{
    (void)state;
    const sgt_torus torus = {.major = 3, .minor = 1};
    const sgt_element e = {.surface = {&sgt_torus_ops, &torus}, .semi_diameter = 2.5, .index = 1.5};
    int passed = 0, lost = 0;
    for (int proof = SGT_ESTIMATE; proof <= SGT_PROVE_FIRST; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++)
            for (int most = 1; most < 400; most++) {
                sgt_ray ray = {.o = {-9, 0.5, 0.2}, .d = {1, 0, 0}};
                sgt_fate fate;
                const sgt_options opt = {.pick = (sgt_pick)pick, .proof = (sgt_proof)proof,
                                         .max_evals = most};
                sgt_trace(1, &e, 1, &ray, NULL, &fate, &opt);
                REQUIRE(fate == SGT_PASSED || fate == SGT_LOST, "%d evaluations, pick %d, proof %d: %s", most,
                        pick, proof, sgt_fate_text(fate));
                passed += fate == SGT_PASSED, lost += fate == SGT_LOST;
            }
    REQUIRE(passed > 1000 && lost > 20, "%d passed, %d lost", passed, lost);
}

/* Launched from 2^30 lengths away, along a direction that doubles hold exactly: as from nearby. */
static void test_far_launch(void **state)
{
    (void)state;
    generator g = seeded("far launch");
    long double worst_p = 0, worst_d = 0;
    long n = scaled(5000);
    for (long i = 0; i < n; i++) {
        lens l;
        random_lens(&g, &l);
        sgt_vec3 d = {below(&g, 400) - 200, below(&g, 400) - 200, 1000},
                 q = {rint(uniform(&g, -1, 1) * 0x1p10) * 0x1p-10,
                      rint(uniform(&g, -1, 1) * 0x1p10) * 0x1p-10, -4};
        sgt_ray near = {.o = q, .d = d},
                far = {.o = {q.x - 0x1p30 * d.x, q.y - 0x1p30 * d.y, q.z - 0x1p30 * d.z}, .d = d};
        sgt_passage a[ELEMENTS], b[ELEMENTS];
        double seen = NOT;
        size_t na = sgt_trace(ELEMENTS, l.e, 1, &near, a, NULL, NULL),
               nb = sgt_trace(ELEMENTS, l.e, 1, &far, b, NULL, NULL);
        REQUIRE(na == nb, "ray %ld: %zu from nearby, %zu from afar", i, na, nb);
        bool steep = false;
        for (size_t j = 0; j < na; j++) {
            steep = steep || fabsl(wide_dot(wide_unit(widen(a[j].hit.n)), widen(a[j].direction))) < 0.1L ||
                    fabs(a[j].hit.t) > 100 || wide_length(widen(a[j].hit.p)) > 40;
            if (steep) break; /* from there on an error measures the problem */
            worst_p = fmaxl(worst_p, apart(widen(a[j].hit.p), b[j].hit.p) / l.length);
            worst_d = fmaxl(worst_d, apart(widen(a[j].direction), b[j].direction));
        }
        if (na == 0) continue;
        long double away = 0x1p30L * wide_length(widen(d)),
                    off = fabsl((long double)b[0].hit.t + b[0].hit.t_lo - a[0].hit.t - a[0].hit.t_lo - away);
        REQUIRE(off <= (long double)b[0].hit.t_err + a[0].hit.t_err, "ray %ld: t %Lg off, t_err %g", i, off,
                b[0].hit.t_err);
        REQUIRE(b[0].hit.t_err <= 8 * DBL_EPSILON * b[0].hit.t, "ray %ld: t_err %g", i, b[0].hit.t_err);
        far = (sgt_ray){.o = {q.x - 0x1p30 * d.x, q.y - 0x1p30 * d.y, q.z - 0x1p30 * d.z}, .d = d};
        sgt_trace(1, l.e, 1, &far, NULL, NULL, &(sgt_options){.watch = last_t, .watch_data = &seen});
        REQUIRE(fabs(seen - b[0].hit.t) <= b[0].hit.t_err,
                "ray %ld: the watcher sees t %.17g, the hit is at %.17g", i, seen, b[0].hit.t);
    }
    print_message("point %.2Lg of the length, direction %.2Lg\n", worst_p, worst_d);
    REQUIRE(worst_p < 1e-13L && worst_d < 1e-13L, "point %Lg, direction %Lg", worst_p, worst_d);
}

/* A launch that is moved, along an axis: its t0 is exact, and t + t_lo is the root to what is left of it,
 * though an ulp of t is long. */
static void test_far_launch_to_its_last_part(void **state)
{
    (void)state;
    generator g = seeded("far launch, t_lo");
    long double worst = 0;
    long n = scaled(20000), rounded = 0;
    for (long i = 0; i < n; i++) {
        const sgt_conic flat = {.c = 0};
        sgt_element e = {.surface = {&sgt_conic_ops, &flat},
                         .pose = sgt_pose_tilted(random_point(&g, 2), random_point(&g, 50)),
                         .index = 1.5};
        double away = either_sign(&g) * log_uniform(&g, 1e5, 1e12),
               side[3] = {uniform(&g, -1, 1), uniform(&g, -1, 1), uniform(&g, -1, 1)}, way[3] = {0};
        int axis = below(&g, 3);
        side[axis] -= away, way[axis] = 1;
        const sgt_vec3 o = {side[0], side[1], side[2]}, d = {way[0], way[1], way[2]}, ez = e.pose.ez,
                       at = e.pose.origin;
        double slope = way[0] * ez.x + way[1] * ez.y + way[2] * ez.z, t[2], t_lo[2], infinite = FAR,
               begin = -FAR;
        if (fabs(slope) < 0.1) continue;
        sgt_ray ray = {.o = o, .d = d};
        sgt_passage p;
        REQUIRE(sgt_trace(1, &e, 1, &ray, &p, NULL, NULL) == 1, "ray %ld is not traced", i);
        t[0] = p.hit.t, t_lo[0] = p.hit.t_lo;
        sgt_passages told = {.hits = {.t = &t[1], .t_lo = &t_lo[1]}};
        sgt_rays one = {.o = {&o.x, &o.y, &o.z}, .d = {&d.x, &d.y, &d.z}, .tmin = &begin, .tmax = &infinite};
        sgt_trace_batch(1, &e, 1, 1, one, (sgt_traced){0}, &told, NULL);
        for (int k = 0; k < 2; k++) {
            double left[3] = {o.x - at.x, o.y - at.y, o.z - at.z}, from = side[axis],
                   to = axis == 0   ? at.x
                        : axis == 1 ? at.y
                                    : at.z;
            /* from + t is exact where t is long: the two are near */
            left[axis] = ((from + t[k]) - to) + t_lo[k];
            if (fabs(from + t[k]) > 0.25 * fabs(from)) continue;
            long double off = fabsl((long double)left[0] * ez.x + (long double)left[1] * ez.y +
                                    (long double)left[2] * ez.z) /
                              fabs(slope);
            worst = fmaxl(worst, off);
            rounded += fabs(t_lo[k]) > 1e-13;
            REQUIRE(off < 1e-13L, "ray %ld from %g away%s: t + t_lo is %Lg off, t_lo %g", i, away,
                    k ? ", in a batch" : "", off, t_lo[k]);
        }
    }
    print_message("t + t_lo off by %Lg at most; t_lo is of account %ld times\n", worst, rounded);
    REQUIRE(rounded > n / 2, "these rays are no test");
}

/* The path is the sum of index times t + t_lo, rounded once, however long one part of it is. */
static void test_path_rounded_once(void **state)
{
    (void)state;
    generator g = seeded("path, rounded once");
    long n = scaled(5000), rows = 0;
    long double worst = 0;
    for (long i = 0; i < n; i++) {
        lens l;
        random_lens(&g, &l);
        sgt_ray ray = random_launch(&g);
        double away = chance(&g, 0.5) ? 0 : ldexp(1, below(&g, 40)), before = uniform(&g, 1, 1.9);
        ray.o = (sgt_vec3){ray.o.x - away * ray.d.x, ray.o.y - away * ray.d.y, ray.o.z - away * ray.d.z};
        sgt_passage passage[ELEMENTS];
        size_t passed = sgt_trace(ELEMENTS, l.e, before, &ray, passage, NULL, NULL);
        long double path = 0, size = 0, index = before;
        for (size_t j = 0; j < passed; j++, rows++) {
            const sgt_hit *h = &passage[j].hit;
            long double part = index * ((long double)h->t + h->t_lo), opl = passage[j].opl;
            path += part, size += fabsl(part);
            if (!(size < 1e300L)) break;
            long double ulp = nextafter(fabs(passage[j].opl), FAR) - fabsl(opl), off = fabsl(opl - path);
            worst = fmaxl(worst, (off - 0x1p-61L * size) / ulp);
            REQUIRE(off <= 0.502L * ulp + 0x1p-61L * size,
                    "ray %ld from %g away, element %zu: the path is off by %Lg of its ulp", i, away, j,
                    off / ulp);
            if (l.e[j].index != 0 && l.e[j].index != SGT_MIRROR) index = l.e[j].index;
        }
    }
    print_message("%ld paths, off by %.4Lf of an ulp at most\n", rows, worst);
    REQUIRE(rows > n, "%ld paths", rows);
}

/* ------------------------------------------------------------------ watching */

typedef struct counter { int calls, stop_at; } counter;
static int count(void *data, const sgt_step *step)
{
    counter *c = data;
    (void)step;
    return ++c->calls == c->stop_at;
}

static void test_watch(void **state)
{
    (void)state;
    generator g = seeded("watch");
    for (long i = 0, n = scaled(1000); i < n; i++) {
        lens l;
        random_lens(&g, &l);
        for (int j = 0; j < ELEMENTS; j++) l.e[j].semi_diameter = uniform(&g, 1, 4);
        sgt_ray launch = random_launch(&g), ray = launch, watched = launch;
        sgt_passage p[ELEMENTS], w[ELEMENTS];
        sgt_fate fate, same;
        size_t passed = sgt_trace(ELEMENTS, l.e, 1, &ray, p, &fate, NULL), met = passed + (passed < ELEMENTS);
        counter c = {0};
        REQUIRE(sgt_trace(ELEMENTS, l.e, 1, &watched, w, &same,
                          &(sgt_options){.watch = count, .watch_data = &c}) == passed &&
                    same == fate,
                "lens %ld: another fate when watched", i);
        REQUIRE(same_vector(ray.o, watched.o) && same_vector(ray.d, watched.d),
                "lens %ld: another ray when watched", i);
        int evals = 0;
        for (size_t j = 0; j < met; j++) evals += p[j].hit.evals;
        REQUIRE(evals == c.calls, "lens %ld: %d evaluations, %d steps seen", i, evals, c.calls);
        if (evals == 0) continue;
        c = (counter){.stop_at = 1 + below(&g, evals)};
        watched = launch;
        sgt_trace(ELEMENTS, l.e, 1, &watched, w, &same, &(sgt_options){.watch = count, .watch_data = &c});
        size_t at = 0;
        for (int left = c.stop_at; left > p[at].hit.evals; at++) left -= p[at].hit.evals;
        REQUIRE(same == SGT_LOST && w[at].hit.status == SGT_STOPPED && c.calls == c.stop_at,
                "lens %ld: stopped at %d: %s, %s after %d", i, c.stop_at, sgt_fate_text(same),
                sgt_status_text(w[at].hit.status), c.calls);
    }
}

/* The scan lens of Laikin's Lens Design, first surface: the ray that the normalised gradient
 * cannot follow (tests/unit/test_diagnose.c has its steps). */
static void test_scan_lens_ray(void **state)
{
    (void)state;
    sgt_conic shape = {.c = 1 / -2.2136};
    sgt_element e = {.surface = {&sgt_conic_ops, &shape}, .index = 1.84666};
    sgt_ray ray = {.o = {0, 0.5, -5}, .d = {0, 0.3420201433256687, 0.9396926207859084}};
    sgt_passage p;
    assert_int_equal(sgt_trace(1, &e, 1, &ray, &p, NULL, NULL), 1);
    REQUIRE(fabsl(p.hit.t - 4.143085073464611925784L) <= p.hit.t_err + 1e-16L && p.hit.t_err < 4e-15,
            "t %.17g +- %g", p.hit.t, p.hit.t_err);
    REQUIRE(fabs(p.hit.t - 4.143085073464612) <= 0x1p-50 && p.opl == p.hit.t, "t %.17g, opl %.17g", p.hit.t,
            p.opl);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_wide),
        cmocka_unit_test(test_reversed),
        cmocka_unit_test(test_fates),
        cmocka_unit_test(test_invalid),
        cmocka_unit_test(test_nothing_wanted),
        cmocka_unit_test(test_aperture_chooses),
        cmocka_unit_test(test_edge_of_the_aperture),
        cmocka_unit_test(test_wide_aperture),
        cmocka_unit_test(test_far_lens),
        cmocka_unit_test(test_far_launch),
        cmocka_unit_test(test_few_evaluations),
        cmocka_unit_test(test_far_launch_to_its_last_part),
        cmocka_unit_test(test_path_rounded_once),
        cmocka_unit_test(test_watch),
        cmocka_unit_test(test_scan_lens_ray),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
