// SPDX-License-Identifier: MIT
/* The items of an aperture: each shape against one worked out in long double (turns by complex products,
 * polygons by the angle they wind), on its edges and next to them, in lists, and items that are not sound. */
#include "unit.h"

#include <complex.h>
#include <limits.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

typedef long double complex point;

static const long double PI = 3.14159265358979323846264338327950288L;
static const sgt_conic flat = {0};

static point unit(long double degrees)
{
    long double a = fmodl(degrees, 360) * (PI / 180);
    return cosl(a) + I * sinl(a);
}
static point of(sgt_vec2 a) { return (long double)a.x + I * (long double)a.y; }

/* ------------------------------------------------------------- the other way */

/* The angle that the sides wind about the point, in turns; odd: inside. */
static bool winds_about(const sgt_aperture_item *i, point q)
{
    long double angle = 0;
    for (size_t k = 0; k < i->count; k++)
        angle += cargl((of(i->vertices[(k + 1) % i->count]) - q) / (of(i->vertices[k]) - q));
    return lroundl(angle / (2 * PI)) % 2 != 0;
}

static bool is_in(const sgt_aperture_item *i, point p)
{
    point q = (p - of(i->centre)) * conjl(unit(i->degrees)), step;
    switch (i->shape) {
    case SGT_CIRCLE: return cabsl(q) <= i->radius;
    case SGT_ANNULUS: return cabsl(q) <= i->radius && cabsl(q) >= i->inner;
    case SGT_RECTANGLE: return fabsl(creall(q)) <= i->half.x && fabsl(cimagl(q)) <= i->half.y;
    case SGT_ELLIPSE: return cabsl(creall(q) / i->half.x + I * (cimagl(q) / i->half.y)) <= 1;
    case SGT_POLYGON: return winds_about(i, q);
    case SGT_SPIDER:
        step = conjl(unit(360.0L / i->arms));
        for (int k = 0; k < i->arms; k++, q *= step)
            if (creall(q) >= 0 && (i->length == 0 || creall(q) <= i->length) &&
                fabsl(cimagl(q)) <= i->width / 2.0L)
                return true;
        return false;
    }
    return false;
}

/* 1, 0; -1 if the point is so near an edge that neither is certain. */
static int is_clipped(const sgt_aperture_item *i, long double x, long double y, long double near)
{
    bool in = is_in(i, x + I * y);
    for (int k = 0; k < 8; k++)
        if (is_in(i, x + I * y + near * unit(45 * k + 1)) != in) return -1;
    return in == i->obscuring;
}

/* ------------------------------------------------------------------ the library */

static sgt_element element_of(const sgt_aperture *a)
{
    return (sgt_element){.surface = {&sgt_conic_ops, &flat}, .aperture = a};
}

/* Whether the items clip a ray through (x, y), by a trace, a batch and sgt_clipped_by, which agree; which. */
static int asked(const sgt_element *e, double x, double y)
{
    sgt_ray ray = {.o = {x, y, -1}, .d = {0, 0, 1}};
    if (fabs(x) > 1e150 || fabs(y) > 1e150) return sgt_clipped_by(e, ray.o).by; /* too far for a trace */
    sgt_fate fate;
    sgt_passage p;
    double ox[3], oy[3], oz[3] = {-1, -1, -1}, dx[3] = {0}, dz[3] = {1, 1, 1};
    sgt_fate fates[3];
    for (int k = 0; k < 3; k++) ox[k] = x, oy[k] = y;
    sgt_trace(1, e, 1, &ray, &p, &fate, NULL);
    sgt_trace_batch(1, e, 1, 3, (sgt_rays){{ox, oy, oz}, {dx, dx, dz}, NULL, NULL},
                    (sgt_traced){.fate = fates}, NULL, NULL);
    sgt_clipping c = sgt_clipped_by(e, p.hit.p);
    REQUIRE(fate == SGT_PASSED || fate == SGT_CLIPPED, "fate %s", sgt_fate_text(fate));
    REQUIRE(same_bits(p.hit.p.x, x + 0.0) && same_bits(p.hit.p.y, y + 0.0), "met elsewhere");
    REQUIRE((c.by == SGT_BY_NONE) == (fate == SGT_PASSED), "by %d, %s", c.by, sgt_fate_text(fate));
    REQUIRE(fates[0] == fate && fates[1] == fate && fates[2] == fate, "a batch has another fate than %s",
            sgt_fate_text(fate));
    if (c.by == SGT_BY_NONE) assert_true(c.size == 0 && c.limit == 0);
    return c.by;
}

static bool clips(const sgt_aperture_item *i, double x, double y)
{
    const sgt_aperture a = {.count = 1, .items = i};
    const sgt_element e = element_of(&a);
    return asked(&e, x, y) == 0;
}

/* ------------------------------------------------------------------- random items */

enum { CORNERS = 12 };

/* A star about the origin, not convex: no two sides cross.  Either way round. */
static size_t random_polygon(generator *g, sgt_vec2 v[])
{
    size_t n = 3 + (size_t)below(g, CORNERS - 2);
    bool back = chance(g, 0.5);
    for (size_t k = 0; k < n; k++) {
        double r = uniform(g, 0.3, 2), a = 6.283185307179586 * ((double)k + uniform(g, 0, 0.9)) / (double)n;
        v[back ? n - 1 - k : k] = (sgt_vec2){r * cos(a), r * sin(a)};
    }
    if (chance(g, 0.3)) /* a square grid: sides along the axes, vertices level with points */
        for (size_t k = 0; k < n; k++) v[k].x = round(4 * v[k].x) / 4, v[k].y = round(4 * v[k].y) / 4;
    return n;
}

static sgt_aperture_item random_item(generator *g, sgt_vec2 v[])
{
    sgt_aperture_item i = {.shape = (sgt_aperture_shape)(SGT_CIRCLE + below(g, SGT_SPIDER)),
                           .obscuring = chance(g, 0.5)};
    if (chance(g, 0.6)) i.centre = (sgt_vec2){uniform(g, -2, 2), uniform(g, -2, 2)};
    if (chance(g, 0.6)) i.degrees = chance(g, 0.3) ? 90.0 * below(g, 8) - 180 : uniform(g, -400, 400);
    i.radius = uniform(g, 0.2, 2), i.inner = chance(g, 0.2) ? 0 : uniform(g, 0, i.radius);
    i.half = (sgt_vec2){uniform(g, 0.1, 2), uniform(g, 0.1, 2)};
    if (i.shape == SGT_POLYGON) i.vertices = v, i.count = random_polygon(g, v);
    i.arms = 1 + below(g, chance(g, 0.1) ? 64 : 7), i.width = uniform(g, 0.05, 0.6);
    if (chance(g, 0.5)) i.length = chance(g, 0.1) ? FAR : uniform(g, 0.2, 2);
    return i;
}

static const char *name_of(const sgt_aperture_item *i)
{
    static const char *const names[] = {"none",    "circle",  "annulus", "rectangle",
                                        "ellipse", "polygon", "spider"};
    return names[i->shape];
}

static void test_shapes(void **state)
{
    (void)state;
    generator g = seeded("shapes");
    long n = scaled(40000), passed[SGT_SPIDER + 1] = {0}, clipped[SGT_SPIDER + 1] = {0}, unclear = 0;
    for (long j = 0; j < n; j++) {
        sgt_vec2 v[CORNERS];
        sgt_aperture_item i = random_item(&g, v);
        for (int k = 0; k < 4; k++) {
            double x = i.centre.x + uniform(&g, -2.2, 2.2), y = i.centre.y + uniform(&g, -2.2, 2.2);
            if (chance(&g, 0.2)) x = i.centre.x; /* level with what may be there */
            if (chance(&g, 0.2)) y = round(4 * y) / 4;
            int right = is_clipped(&i, x, y, 0x1p-40L);
            unclear += right < 0;
            if (right < 0) continue;
            REQUIRE(clips(&i, x, y) == right, "%s %ld at (%a, %a), %s: it should be %d", name_of(&i), j, x, y,
                    i.obscuring ? "obscuring" : "passing", right);
            ++*(right ? &clipped[i.shape] : &passed[i.shape]);
        }
    }
    for (int s = SGT_CIRCLE; s <= SGT_SPIDER; s++)
        REQUIRE(passed[s] > n / 20 && clipped[s] > n / 20, "shape %d: %ld, %ld", s, passed[s], clipped[s]);
    REQUIRE(unclear < n / 20, "%ld unclear", unclear);
}

/* ------------------------------------------------------------------------ edges */

static long double from_side(point q, point a, point b)
{
    point s = b - a, along = (q - a) / s; /* in its real part */
    long double t = fminl(1, fmaxl(0, creall(along)));
    return s == 0 ? cabsl(q - a) : cabsl(q - a - t * s);
}

/* From q to the nearest side, seen from the centre and not turned. */
static long double from_sides(const sgt_aperture_item *i, point q)
{
    long double nearest = FAR;
    for (size_t k = 0; k < i->count; k++)
        nearest = fminl(nearest, from_side(q, of(i->vertices[k]), of(i->vertices[(k + 1) % i->count])));
    return nearest;
}

/* A point of an edge, seen from the centre and not turned, its normal outward, and in *more what is added to
 * the softness for a polygon. */
static point edge_of(generator *g, const sgt_aperture_item *i, point *normal, long double *more)
{
    long double a = uniform(g, 0, 360), half = i->width / 2.0L, along;
    bool inner = i->shape == SGT_ANNULUS && i->inner > 0 && chance(g, 0.5);
    point u = chance(g, 0.2) ? unit(90 * below(g, 4)) : unit(a), p, s;
    *normal = u, *more = 0;
    switch (i->shape) {
    case SGT_CIRCLE: return i->radius * u;
    case SGT_ANNULUS:
        *normal = inner ? -u : u;
        return (inner ? i->inner : i->radius) * u;
    case SGT_RECTANGLE:
        along = uniform(g, -0.99, 0.99);
        u = unit(90 * below(g, 4)), *normal = u;
        return fabsl(creall(u)) > 0.5L ? i->half.x * creall(u) + I * along * i->half.y
                                       : along * i->half.x + I * (i->half.y * cimagl(u));
    case SGT_ELLIPSE:
        s = creall(u) / i->half.x + I * (cimagl(u) / i->half.y), *normal = s / cabsl(s);
        return creall(u) * i->half.x + I * (cimagl(u) * i->half.y);
    case SGT_POLYGON: {
        size_t k = (size_t)below(g, (int)i->count);
        point from = of(i->vertices[k]), to = of(i->vertices[(k + 1) % i->count]);
        s = to - from, p = from + uniform(g, 0.01, 0.99) * s;
        *normal = 0;
        if (s == 0) return from; /* two vertices in one place */
        *normal = -I * s / cabsl(s), *more = cabsl(s) + 1e-3L;
        if (is_in(i, (p + 1e-9L * *normal) * unit(i->degrees) + of(i->centre))) *normal = -*normal;
        return p;
    }
    default: { /* a spider, on a side of an arm, away from the others; or at its end */
        u = unit(360.0L * below(g, i->arms) / i->arms);
        bool end = i->length > 0 && i->length < HUGE_VAL && chance(g, 0.4);
        long double side = chance(g, 0.5) ? half : -half;
        *normal = end ? u : u * I * (side > 0 ? 1 : -1);
        along = (i->length > 0 && i->length < HUGE_VAL ? i->length : 5) * (long double)uniform(g, 0, 0.99);
        return end ? u * (i->length + I * side * (long double)uniform(g, 0, 0.99)) : u * (along + I * side);
    }
    }
}

/* On the edge it passes, from whichever side; a little beyond it does not.  The doubles next to a point of
 * the edge are beyond it by 2^-53 of their size. */
static void test_edges(void **state)
{
    (void)state;
    generator g = seeded("edges");
    long n = scaled(60000), looked[SGT_SPIDER + 1] = {0};
    for (long j = 0; j < n; j++) {
        sgt_vec2 v[CORNERS];
        sgt_aperture_item i = random_item(&g, v);
        point normal;
        long double more;
        double scale = log_uniform(&g, 1e-3, 1e3);
        if (chance(&g, 0.3)) i.centre.x *= scale, i.centre.y *= scale; /* far beside its size, or near */
        bool thin = i.shape == SGT_ELLIPSE && chance(&g, 0.2);
        if (thin) i.half.x *= log_uniform(&g, 1e-14, 1);
        point from = edge_of(&g, &i, &normal, &more), turned = unit(i.degrees), c = of(i.centre);
        long double size = fabsl(creall(from)) + fabsl(cimagl(from)) + fabsl(creall(c)) + fabsl(cimagl(c));
        const long double beyond = 0x1p-43L * (1.5L * size + more); /* 1.5: along either axes */
        /* is it an edge, and nothing else of the item near?  (of a thin ellipse's end, a corner) */
        bool out = is_in(&i, (from + 4 * beyond * normal) * turned + c),
             in = is_in(&i, (from - 4 * beyond * normal) * turned + c);
        point away = (from + beyond * normal) * turned + c, inward = (from - beyond * normal) * turned + c,
              on = from * turned + c;
        REQUIRE(clips(&i, (double)creall(on), (double)cimagl(on)) == false || (out && in),
                "%s %ld: on its edge (%La, %La), %s", name_of(&i), j, creall(on), cimagl(on),
                i.obscuring ? "obscuring" : "passing");
        if (out || !in) continue;
        if (thin) continue;
        if (is_clipped(&i, creall(away), cimagl(away), 0.7L * beyond) < 0) continue; /* beside another */
        if (is_clipped(&i, creall(inward), cimagl(inward), 0.7L * beyond) < 0) continue;
        if (i.shape == SGT_POLYGON && from_sides(&i, from + beyond * normal) < 0.7L * beyond) continue;
        if (i.shape == SGT_POLYGON && from_sides(&i, from - beyond * normal) < 0.7L * beyond) continue;
        looked[i.shape]++;
        REQUIRE(clips(&i, (double)creall(away), (double)cimagl(away)) == !i.obscuring,
                "%s %ld: outside its edge (%La, %La)", name_of(&i), j, creall(on), cimagl(on));
        REQUIRE(clips(&i, (double)creall(inward), (double)cimagl(inward)) == i.obscuring,
                "%s %ld: inside its edge (%La, %La)", name_of(&i), j, creall(on), cimagl(on));
    }
    for (int s = SGT_CIRCLE; s <= SGT_SPIDER; s++) REQUIRE(looked[s] > n / 20, "shape %d: %ld", s, looked[s]);
}

/* A centred circle is a semi_diameter, to the last bits of the softness. */
static void test_circle_as_semi_diameter(void **state)
{
    (void)state;
    generator g = seeded("circle as semi_diameter");
    long n = scaled(20000), near = 0;
    for (long j = 0; j < n; j++) {
        double r = log_uniform(&g, 1e-100, 1e100), a = uniform(&g, 0, 7);
        double far = r * (1 + uniform(&g, -8, 8) * 0x1p-46), x = far * cos(a), y = far * sin(a);
        long double is = hypotl(x, y), soft = r * (1 + 0x1p-45L);
        if (fabsl(is / soft - 1) < 4 * 0x1p-53L) continue;
        const sgt_aperture_item i = {.shape = SGT_CIRCLE, .radius = r};
        const sgt_element bare = {.surface = {&sgt_conic_ops, &flat}, .semi_diameter = r};
        bool by_semi_diameter = asked(&bare, x, y) == SGT_BY_SEMI_DIAMETER;
        bool right = is > soft;
        REQUIRE(by_semi_diameter == right && clips(&i, x, y) == right, "r %a at (%a, %a)", r, x, y);
        near += is > r && is < soft;
    }
    REQUIRE(near > n / 20, "%ld", near);
}

/* Sizes that are 0, infinite or at the ends of the range, places that are as far. */
static void test_ends_of_the_range(void **state)
{
    (void)state;
    sgt_aperture_item i = {.shape = SGT_CIRCLE};
    assert_true(!clips(&i, 0, 0) && clips(&i, 1e-300, 0) && clips(&i, 0, 5e-324) && clips(&i, 1e300, 0));
    i.obscuring = true;
    assert_true(!clips(&i, 0, 0) && !clips(&i, 1, 0));
    i.radius = FAR;
    assert_true(clips(&i, 0, 0) && clips(&i, 1e300, 1e300));
    i.obscuring = false;
    assert_true(!clips(&i, 0, 0) && !clips(&i, 1e300, 1e300));
    i = (sgt_aperture_item){.shape = SGT_ANNULUS, .radius = 1, .centre = {2, 1}, .obscuring = true};
    assert_true(clips(&i, 2, 1) && clips(&i, 2.5, 1) && !clips(&i, 3, 1)); /* without a hole: a disc */
    i = (sgt_aperture_item){.shape = SGT_CIRCLE};
    for (int e = -1060; e <= 1022; e += 2) {
        double r = ldexp(1, e);
        sgt_aperture_item ring = {.shape = SGT_ANNULUS, .radius = r, .inner = r / 2};
        for (int k = 0; k < 4; k++) { /* also far beyond: squares that overflow, and underflow */
            i.radius = r, i.obscuring = ring.obscuring = k & 1;
            double in = k & 2 ? r * 0x1p-12 : 0.4375 * r, between = 0.75 * r;
            double out = k & 2 ? DBL_MAX : 1.25 * r;
            REQUIRE(clips(&i, 0, between) == i.obscuring && clips(&i, out, 0) == !i.obscuring,
                    "circle 2^%d", e);
            REQUIRE(clips(&ring, in, 0) == !ring.obscuring && clips(&ring, 0, -between) == ring.obscuring &&
                        clips(&ring, -out, 0) == !ring.obscuring, "annulus 2^%d", e);
        }
        if (e > 400 || e < -450) continue;
        const sgt_vec2 v[] = {{-r, -r}, {r, -r}, {r, r}, {0, 0}, {-r, r}};
        sgt_aperture_item polygon = {.shape = SGT_POLYGON, .count = 5, .vertices = v};
        REQUIRE(!clips(&polygon, 0, -r / 4) && clips(&polygon, 0, r / 4) && clips(&polygon, DBL_MAX, r / 4) &&
                    clips(&polygon, 1e200, 0) && !clips(&polygon, r, r) && !clips(&polygon, 0, 0),
                "polygon 2^%d", e);
        polygon.obscuring = true, polygon.degrees = 180;
        REQUIRE(clips(&polygon, 0, r / 4) && !clips(&polygon, 0, -r / 4) && !clips(&polygon, 1e200, 0),
                "obscuring polygon 2^%d", e);
    }
    const sgt_aperture_item slit = {.shape = SGT_RECTANGLE, .half = {1, FAR}, .degrees = 90},
                            band = {.shape = SGT_ELLIPSE, .half = {1, FAR}, .obscuring = true},
                            line = {.shape = SGT_ELLIPSE, .half = {0, 2}, .centre = {1, 1}},
                            hair = {.shape = SGT_RECTANGLE, .half = {0, 2}, .obscuring = true};
    assert_true(!clips(&slit, 1e300, 1) && clips(&slit, 1e300, 2 + 1e300) && clips(&slit, 0, 1.0001));
    assert_true(clips(&band, 0.5, 1e300) == false); /* beside 1e300 its width is nothing */
    assert_true(clips(&band, 0.5, 1e12) && clips(&band, 0, 0) && !clips(&band, 1, 0) && !clips(&band, 2, 0));
    assert_true(!clips(&line, 1, 2.5) && clips(&line, 1, 3.5) && clips(&line, 1.001, 1));
    assert_true(!clips(&hair, 0, 0) && !clips(&hair, 0, 1));
    /* the centre of a spider is inside of it */
    for (int arms = 1; arms <= 64; arms++) {
        sgt_aperture_item spider = {.shape = SGT_SPIDER, .arms = arms, .width = 0.1, .obscuring = true,
                                    .centre = {0.25, -3}, .degrees = 20};
        assert_true(clips(&spider, 0.25, -3));
        for (int k = 0; k < 360 && arms > 1; k++) { /* all about it too */
            point p = 0.03 * unit(k + 20);
            REQUIRE(clips(&spider, 0.25 + (double)creall(p), -3 + (double)cimagl(p)), "%d arms, %d degrees",
                    arms, k);
        }
    }
}

/* ------------------------------------------------------------------------ lists */

static void test_lists(void **state)
{
    (void)state;
    generator g = seeded("lists");
    enum { MOST = 5 };
    long n = scaled(20000), passed = 0;
    for (long j = 0; j < n; j++) {
        static sgt_vec2 v[MOST][CORNERS];
        sgt_aperture_item items[MOST];
        const sgt_aperture a = {.count = (size_t)below(&g, MOST + 1), .items = items};
        sgt_element e = element_of(&a);
        if (chance(&g, 0.5)) e.semi_diameter = uniform(&g, 1, 3);
        if (chance(&g, 0.5)) e.index = chance(&g, 0.5) ? SGT_MIRROR : 1.5;
        for (size_t k = 0; k < a.count; k++) items[k] = random_item(&g, v[k]);
        double x = uniform(&g, -2, 2), y = uniform(&g, -2, 2);
        int first = SGT_BY_NONE;
        if (e.semi_diameter > 0 && hypotl(x, y) > e.semi_diameter) first = SGT_BY_SEMI_DIAMETER;
        for (size_t k = 0; k < a.count && first == SGT_BY_NONE; k++)
            if (clips(&items[k], x, y)) first = (int)k;
        int by = asked(&e, x, y);
        REQUIRE(by == first, "list %ld of %zu: %d, by each alone %d", j, a.count, by, first);
        passed += by == SGT_BY_NONE;
    }
    REQUIRE(passed > n / 20, "%ld passed", passed);
}

/* -------------------------------------------------------------- the passage told */

/* What is clipped has the point and the path of the ray as it is without items; and items do not change which
 * root is meant, nor save from a second one. */
static void test_passage(void **state)
{
    (void)state;
    generator g = seeded("passage");
    long n = scaled(5000), clipped = 0;
    for (long j = 0; j < n; j++) {
        const sgt_conic ball = {.c = either_sign(&g) / uniform(&g, 2, 5)};
        sgt_vec2 v[CORNERS];
        const sgt_aperture_item i = random_item(&g, v);
        const sgt_aperture a = {.count = 1, .items = &i};
        sgt_element e = {.surface = {&sgt_conic_ops, &ball}, .index = 1.5};
        if (chance(&g, 0.5))
            e.pose = sgt_pose_tilted((sgt_vec3){uniform(&g, -1, 1), 0, uniform(&g, -1, 1)},
                                     (sgt_vec3){uniform(&g, -20, 20), 5, uniform(&g, -90, 90)});
        if (chance(&g, 0.5)) e.semi_diameter = 1.9;
        const sgt_ray launch = {.o = {uniform(&g, -1.5, 1.5), uniform(&g, -1.5, 1.5), -7},
                                .d = {uniform(&g, -0.2, 0.2), uniform(&g, -0.2, 0.2), 1}};
        sgt_passage bare, with;
        sgt_fate fate, bare_fate;
        sgt_ray ray = launch;
        sgt_trace(1, &e, 1.25, &ray, &bare, &bare_fate, NULL);
        ray = launch;
        e.aperture = &a;
        size_t passed = sgt_trace(1, &e, 1.25, &ray, &with, &fate, NULL);
        assert_memory_equal(&bare.hit, &with.hit, offsetof(sgt_hit, n)); /* behind it there may be padding */
        assert_true(same_vector(bare.hit.n, with.hit.n));
        if (bare_fate == SGT_PASSED && fate == SGT_CLIPPED) {
            assert_true(passed == 0 && same_bits(bare.opl, with.opl));
            assert_true(sgt_clipped_by(&e, with.hit.p).by == 0);
            assert_true(with.direction.x == 0 && with.direction.y == 0 && with.direction.z == 0);
            clipped++;
        } else {
            assert_true(fate == bare_fate && same_vector(bare.direction, with.direction));
            assert_true(bare_fate != SGT_PASSED || sgt_clipped_by(&e, with.hit.p).by == SGT_BY_NONE);
        }
    }
    REQUIRE(clipped > n / 20, "%ld clipped", clipped);
    /* a ball met at its front side, which a disc obscures; its back side is free, and not meant */
    const sgt_conic ball = {.c = 0.5};
    const sgt_aperture_item disc = {
        .shape = SGT_CIRCLE, .radius = 0.1, .centre = {0.5, 0}, .obscuring = true};
    const sgt_aperture stop = {.count = 1, .items = &disc};
    const sgt_element e = {.surface = {&sgt_conic_ops, &ball}, .aperture = &stop};
    sgt_ray ray = {.o = {0.5 - 0.2 * 5, 0, -5 + 0.06}, .d = {0.2, 0, 1}};
    sgt_passage p;
    sgt_fate fate;
    sgt_trace(1, &e, 1, &ray, &p, &fate, NULL);
    assert_true(fate == SGT_CLIPPED && p.hit.p.z < 1);
}

/* Clipped comes before what the bending would say: total reflection, no normal. */
static void test_clipped_before_bent(void **state)
{
    (void)state;
    const sgt_aperture_item disc = {.shape = SGT_RECTANGLE, .half = {1, 1}, .obscuring = true};
    const sgt_aperture stop = {.count = 1, .items = &disc};
    sgt_element e = element_of(&stop);
    e.index = 1;
    for (int k = 0; k < 2; k++) {
        sgt_ray ray = {.o = {k ? 3 : 0, 0, 0}, .d = {1, 0, 0.2}};
        sgt_fate fate, of_batch;
        sgt_rays rays = {{&ray.o.x, &ray.o.y, &ray.o.z}, {&ray.d.x, &ray.d.y, &ray.d.z}, NULL, NULL};
        sgt_trace_batch(1, &e, 1.9, 1, rays, (sgt_traced){.fate = &of_batch}, NULL, NULL);
        sgt_trace(1, &e, 1.9, &ray, NULL, &fate, NULL);
        assert_true(fate == (k ? SGT_TIR : SGT_CLIPPED) && of_batch == fate);
    }
}

/* --------------------------------------------------------------------- how far */

static sgt_clipping told(const sgt_aperture_item *i, point p)
{
    const sgt_aperture a = {.count = 1, .items = i};
    const sgt_element e = element_of(&a);
    return sgt_clipped_by(&e, (sgt_vec3){(double)creall(p), (double)cimagl(p), NOT});
}

static void test_sizes(void **state)
{
    (void)state;
    generator g = seeded("sizes");
    long n = scaled(40000);
    for (long j = 0; j < n; j++) {
        sgt_vec2 v[CORNERS];
        sgt_aperture_item i = random_item(&g, v);
        point q = uniform(&g, -3, 3) + I * (long double)uniform(&g, -3, 3);
        point p = q * unit(i.degrees) + of(i.centre);
        sgt_clipping c = told(&i, p);
        if (c.by != 0) continue;
        long double x = fabsl(creall(q)), y = fabsl(cimagl(q)), r = cabsl(q), right = FAR;
        switch (i.shape) {
        case SGT_CIRCLE:
            REQUIRE(c.limit == i.radius && fabsl(c.size - r) < 1e-14L, "circle");
            REQUIRE((c.size > c.limit) == !i.obscuring, "circle");
            continue;
        case SGT_ANNULUS:
            REQUIRE((c.limit == i.radius || c.limit == i.inner) && fabsl(c.size - r) < 1e-14L, "annulus");
            if (!i.obscuring) REQUIRE((c.size > c.limit) == (c.limit == i.radius), "annulus, %g", c.limit);
            else REQUIRE(c.limit == i.radius ? r > (i.inner + i.radius) / 2.1L || i.inner == 0
                                             : r < (i.inner + i.radius) / 1.9L, "the nearer edge");
            continue;
        case SGT_RECTANGLE: right = fmaxl(x - i.half.x, y - i.half.y); break;
        case SGT_ELLIPSE: {
            /* within 1e-4 of the edge */
            long double level = cabsl(x / i.half.x + I * (y / i.half.y));
            long double slope = cabsl(x / i.half.x / i.half.x + I * (y / i.half.y / i.half.y)) / level;
            right = (level - 1) / slope;
            if (fabsl(right) < 1e-3L) { /* a step back along the gradient leads to the edge */
                point step = x / i.half.x / i.half.x + I * (y / i.half.y / i.half.y);
                point edge = x + I * y - right * step / cabsl(step);
                long double off = cabsl(creall(edge) / i.half.x + I * (cimagl(edge) / i.half.y)) - 1;
                REQUIRE(fabsl(off) < 400 * right * right, "ellipse: %Lg of %Lg", off, right);
            }
            break;
        }
        case SGT_POLYGON:
            right = from_sides(&i, q);
            if (i.obscuring) right = -right;
            break;
        case SGT_SPIDER:
            for (int k = 0; k < i.arms; k++) {
                point a = q * conjl(unit(360.0L * k / i.arms));
                long double beyond = fmaxl(fabsl(cimagl(a)) - i.width / 2.0L,
                                           i.length == 0 ? -FAR : creall(a) - i.length);
                right = fminl(right, creall(a) >= 0 ? beyond : fmaxl(beyond, -creall(a)));
            }
            break;
        }
        if (i.obscuring) right = -right;
        REQUIRE(c.limit == 0 && c.size > 0 && fabsl(c.size - right) < 1e-13L * (1 + fabsl(right)),
                "%s: %.17g, %.17Lg", name_of(&i), c.size, right);
    }
    const sgt_element e = {.surface = {&sgt_conic_ops, &flat}, .semi_diameter = 4};
    sgt_clipping c = sgt_clipped_by(&e, (sgt_vec3){3, 4, 7});
    assert_true(c.by == SGT_BY_SEMI_DIAMETER && c.size == 5 && c.limit == 4);
    c = sgt_clipped_by(&e, (sgt_vec3){0, 4, NOT});
    assert_true(c.by == SGT_BY_NONE && c.size == 0 && c.limit == 0);
    assert_int_equal(sgt_clipped_by(&e, (sgt_vec3){NOT, 9, 0}).by, SGT_BY_NONE);
    const sgt_aperture_item needle = {.shape = SGT_ELLIPSE, .half = {0, 1}},
                            ellipse = {.shape = SGT_ELLIPSE, .half = {2, 1}, .obscuring = true};
    assert_true(told(&needle, 2 + 0.5 * I).size == 2 && told(&ellipse, 0).size == 1);
}

/* ------------------------------------------------------------------------ unsound */

static void require_unsound(const sgt_aperture *a, const char *what)
{
    const sgt_element e[] = {element_of(NULL), element_of(a)};
    sgt_ray launch = {.o = {0.1, 0.2, -1}, .d = {0, 0, 1}}, ray = launch;
    sgt_passage p[2];
    sgt_fate fate, fates[2];
    sgt_status status[2];
    double x[2] = {0.1, 0.1}, y[2] = {0.2, 0.2}, z[2] = {-1, -1}, zero[2] = {0}, one[2] = {1, 1};
    const sgt_passages passages[2] = {{.opl = NULL}, {.hits = {.status = status}}};
    size_t passed = sgt_trace(2, e, 1, &ray, p, &fate, NULL);
    REQUIRE(passed == 1 && fate == SGT_LOST && p[1].hit.status == SGT_INVALID, "%s: %s", what,
            sgt_fate_text(fate));
    sgt_trace_batch(2, e, 1, 2, (sgt_rays){{x, y, z}, {zero, zero, one}, NULL, NULL},
                    (sgt_traced){.fate = fates}, passages, NULL);
    for (int k = 0; k < 2; k++)
        REQUIRE(fates[k] == SGT_LOST && status[k] == SGT_INVALID, "%s in a batch: %d", what, fates[k]);
    sgt_clipping c = sgt_clipped_by(&e[1], launch.o);
    REQUIRE(c.by == SGT_BY_UNSOUND && isnan(c.size) && isnan(c.limit), "%s: by %d", what, c.by);
}

static void test_unsound(void **state)
{
    (void)state;
    const sgt_vec2 v[] = {{0, 0}, {1, 0}, {1, 1}, {NOT, 1}, {0, 0x1.1p500}, {1, FAR}};
    const sgt_aperture_item
        circle = {.shape = SGT_CIRCLE, .radius = 1},
        bad[] = {
            {.shape = (sgt_aperture_shape)0, .radius = 1},
            {.shape = (sgt_aperture_shape)7, .radius = 1},
            {.shape = (sgt_aperture_shape)-1, .radius = 1},
            {.shape = SGT_CIRCLE, .radius = -1},
            {.shape = SGT_CIRCLE, .radius = NOT},
            {.shape = SGT_CIRCLE, .radius = 1, .centre = {NOT, 0}},
            {.shape = SGT_CIRCLE, .radius = 1, .centre = {0, FAR}},
            {.shape = SGT_CIRCLE, .radius = 1, .centre = {0, -0x1.1p500}},
            {.shape = SGT_CIRCLE, .radius = 1, .degrees = NOT},
            {.shape = SGT_CIRCLE, .radius = 1, .degrees = FAR},
            {.shape = SGT_CIRCLE, .radius = 1, .reserved_ = {1, 0}},
            {.shape = SGT_CIRCLE, .radius = 1, .reserved_ = {0, 1}},
            {.shape = SGT_ANNULUS, .radius = 1, .inner = 1.1},
            {.shape = SGT_ANNULUS, .radius = 1, .inner = -0.1},
            {.shape = SGT_ANNULUS, .radius = 1, .inner = NOT},
            {.shape = SGT_ANNULUS, .radius = NOT},
            {.shape = SGT_RECTANGLE, .half = {-1, 1}},
            {.shape = SGT_RECTANGLE, .half = {1, NOT}},
            {.shape = SGT_ELLIPSE, .half = {1, -1}},
            {.shape = SGT_ELLIPSE, .half = {NOT, 1}},
            {.shape = SGT_POLYGON, .count = 2, .vertices = v},
            {.shape = SGT_POLYGON, .count = 0, .vertices = v},
            {.shape = SGT_POLYGON, .count = 3},
            {.shape = SGT_POLYGON, .count = 4, .vertices = v},
            {.shape = SGT_POLYGON, .count = 3, .vertices = v + 3},
            {.shape = SGT_POLYGON, .count = 3, .vertices = v + 2},
            {.shape = SGT_SPIDER, .width = 0.1},
            {.shape = SGT_SPIDER, .arms = -1, .width = 0.1},
            {.shape = SGT_SPIDER, .arms = 65, .width = 0.1},
            {.shape = SGT_SPIDER, .arms = 3, .width = -0.1},
            {.shape = SGT_SPIDER, .arms = 3, .width = NOT},
            {.shape = SGT_SPIDER, .arms = 3, .width = 0.1, .length = -1},
            {.shape = SGT_SPIDER, .arms = 3, .width = 0.1, .length = NOT},
        };
    for (size_t k = 0; k < COUNT_OF(bad); k++) {
        char what[32];
        snprintf(what, sizeof what, "item %zu", k);
        const sgt_aperture_item both[] = {circle, bad[k]};
        require_unsound(&(sgt_aperture){.count = 1, .items = &bad[k]}, what);
        require_unsound(&(sgt_aperture){.count = 2, .items = both}, what);
    }
    require_unsound(&(sgt_aperture){.count = 1}, "no items");
    require_unsound(&(sgt_aperture){.count = (size_t)INT_MAX + 1, .items = &circle}, "too many");
    require_unsound(&(sgt_aperture){.count = 1, .items = &circle, .reserved_ = {1, 0}}, "reserved");
    require_unsound(&(sgt_aperture){.reserved_ = {0, 1}}, "reserved");
    sgt_element e = element_of(NULL);
    e.semi_diameter = NOT;
    assert_int_equal(sgt_clipped_by(&e, (sgt_vec3){0, 0, 0}).by, SGT_BY_UNSOUND);
    /* what a shape has no use for is not read */
    const sgt_aperture_item free = {.shape = SGT_CIRCLE, .radius = 1, .inner = NOT, .half = {NOT, -1},
                                    .count = 1, .arms = -1, .width = NOT, .length = -1, .degrees = 30};
    const sgt_aperture none = {0};
    assert_true(!clips(&free, 0.5, 0.5) && clips(&free, 1, 0.5));
    e = element_of(&none);
    assert_int_equal(asked(&e, 7, 7), SGT_BY_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_circle_as_semi_diameter),
        cmocka_unit_test(test_ends_of_the_range),
        cmocka_unit_test(test_lists),
        cmocka_unit_test(test_passage),
        cmocka_unit_test(test_clipped_before_bent),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_unsound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
