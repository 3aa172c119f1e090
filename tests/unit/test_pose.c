// SPDX-License-Identifier: MIT
/* sgt_pose_tilted against a product of three matrices, worked out in long double. */
#include "unit.h"

#include <sagitta/system.h>

typedef struct matrix { long double a[3][3]; } matrix;

static matrix product(matrix l, matrix r)
{
    matrix m = {{{0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) m.a[i][j] += l.a[i][k] * r.a[k][j];
    return m;
}

/* About axis 0, 1, 2, right-handed: y toward z, z toward x, x toward y. */
static matrix turn(int axis, long double c, long double s)
{
    matrix m = {{{0}}};
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    m.a[axis][axis] = 1;
    m.a[i][i] = m.a[j][j] = c;
    m.a[j][i] = s, m.a[i][j] = -s;
    return m;
}

static matrix turn_degrees(int axis, double degrees)
{
    long double r = fmodl((long double)degrees, 360) * (acosl(-1.0L) / 180);
    return turn(axis, cosl(r), sinl(r));
}

/* The axes are the columns. */
static matrix matrix_of(const sgt_pose *p)
{
    return (matrix){{{p->ex.x, p->ey.x, p->ez.x}, {p->ex.y, p->ey.y, p->ez.y}, {p->ex.z, p->ey.z, p->ez.z}}};
}

static long double apart(matrix a, matrix b)
{
    long double most = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) most = fmaxl(most, fabsl(a.a[i][j] - b.a[i][j]));
    return most;
}

static matrix transpose(matrix a)
{
    matrix m;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m.a[i][j] = a.a[j][i];
    return m;
}

static void test_against_product(void **state)
{
    (void)state;
    generator g = seeded("poses");
    long n = scaled(20000);
    long double worst = 0, worst_square = 0;
    for (long i = 0; i < n; i++) {
        double size = chance(&g, 0.2) ? 1e6 : chance(&g, 0.2) ? 1e-6 : 400;
        sgt_vec3 degrees = random_point(&g, size), origin = random_point(&g, 100);
        sgt_pose pose = sgt_pose_tilted(origin, degrees);
        matrix got = matrix_of(&pose);
        matrix want = product(turn_degrees(2, degrees.z),
                              product(turn_degrees(1, degrees.y), turn_degrees(0, degrees.x)));
        matrix unit = turn(0, 1, 0);
        worst = fmaxl(worst, apart(got, want));
        worst_square = fmaxl(worst_square, apart(product(transpose(got), got), unit));
        REQUIRE(same_vector(pose.origin, origin), "case %ld: the origin has moved", i);
    }
    print_message("axes within %.2Lf, right angles within %.2Lf of 2^-53\n", worst * 0x1p53L,
                  worst_square * 0x1p53L);
    REQUIRE(worst <= 3 * 0x1p-53L, "an axis is %.2Lf times 2^-53 off", worst * 0x1p53L);
    REQUIRE(worst_square <= 0x1p-50L, "axes are %.2Lf times 2^-53 from orthonormal", worst_square * 0x1p53L);
}

/* About one axis the components are a cosine or a sine, within 0.65 ulp (and 0.01 for the oracle), of angles
 * of any size.  If pi/180 is a double, a sine is off by up to 1.45 ulps; the products of test_against_product
 * hide that. */
static void test_one_turn(void **state)
{
    (void)state;
    generator g = seeded("one turn");
    long double worst = 0;
    for (long i = 0, n = scaled(100000); i < n; i++) {
        int axis = below(&g, 3);
        double size = chance(&g, 0.2)   ? log_uniform(&g, 1e-300, 1)
                      : chance(&g, 0.2) ? log_uniform(&g, 1, DBL_MAX)
                                        : 45;
        double angle = 2 * uniform(&g, -size / 2, size / 2);
        sgt_vec3 degrees = {axis == 0 ? angle : 0, axis == 1 ? angle : 0, axis == 2 ? angle : 0};
        sgt_pose pose = sgt_pose_tilted((sgt_vec3){0}, degrees);
        int quarters;
        /* or a cosine near a quarter had lost what counts */
        long double rest = remquol(angle, 90, &quarters);
        matrix got = matrix_of(&pose), want = turn_degrees(axis, (double)rest);
        for (int j = quarters & 3; j > 0; j--) want = product(turn(axis, 0, 1), want);
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) {
                long double x = want.a[j][k], ulp = x == 0 ? 1 : ldexpl(1, ilogbl(x) - 52),
                            off = fabsl(got.a[j][k] - x) / ulp;
                worst = fmaxl(worst, off);
                REQUIRE(off <= 0.66L, "%.17g degrees about axis %d: %.17Lg, %.17Lg wanted, %.2Lf ulps off",
                        angle, axis, got.a[j][k], x, off);
            }
    }
    print_message("cosines and sines within %.3Lf ulps\n", worst);
}

static void test_quarters_exact(void **state)
{
    (void)state;
    static const int cosine[] = {1, 0, -1, 0}, sine[] = {0, 1, 0, -1};
    for (int x = -8; x <= 8; x++)
        for (int y = -8; y <= 8; y++)
            for (int z = -8; z <= 8; z++) {
                sgt_pose pose = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){90.0 * x, 90.0 * y, 90.0 * z});
                matrix want = product(
                    turn(2, cosine[z & 3], sine[z & 3]),
                    product(turn(1, cosine[y & 3], sine[y & 3]), turn(0, cosine[x & 3], sine[x & 3])));
                REQUIRE(apart(matrix_of(&pose), want) == 0, "%d %d %d quarters are not exact", x, y, z);
            }
    sgt_pose pose = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){90 * 0x1p60, 0, 90 * (0x1p40 + 1)});
    REQUIRE(pose.ex.y == 1 && pose.ey.x == -1 && pose.ez.z == 1, "many quarters are not exact");
}

static void test_sense(void **state)
{
    (void)state;
    /* a surface tilted by a positive angle about x turns its y axis toward z, and so on */
    sgt_pose x = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){30, 0, 0}),
             y = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){0, 30, 0}),
             z = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){0, 0, 30});
    assert_true(x.ey.z > 0.49 && x.ey.z < 0.51 && x.ex.x == 1);
    assert_true(y.ez.x > 0.49 && y.ez.x < 0.51 && y.ey.y == 1);
    assert_true(z.ex.y > 0.49 && z.ex.y < 0.51 && z.ez.z == 1);
    /* Rz Ry Rx: about x first */
    sgt_pose both = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){90, 90, 0});
    assert_true(both.ey.x == 1 && both.ez.y == -1 && both.ex.z == -1);
}

static void test_whole_turns(void **state)
{
    (void)state;
    generator g = seeded("whole turns");
    for (long i = 0, n = scaled(2000); i < n; i++) {
        /* multiples of 2^-20 degrees, so that whole turns can be added without rounding */
        double a = (double)below(&g, 360 << 20) * 0x1p-20, more = 360.0 * (below(&g, 20000) - 10000);
        sgt_pose one = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){a, 0, 0}),
                 other = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){a + more, 0, 0});
        REQUIRE(apart(matrix_of(&one), matrix_of(&other)) == 0, "%.17g and %.17g degrees differ", a,
                a + more);
    }
}

static void test_not_finite(void **state)
{
    (void)state;
    const double bad[] = {NOT, FAR, -FAR};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        sgt_pose pose = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){bad[i], 0, 0});
        assert_true(isnan(pose.ey.y) && isnan(pose.ez.z));
    }
}

/* Many at once, among them zeros, quarters, what lies next to them or halfway, and angles of any size. */
static void test_many(void **state)
{
    enum { MOST = 37 };
    (void)state;
    generator g = seeded("many turns");
    for (long k = 0, rounds = scaled(4000); k < rounds; k++) {
        double degrees[MOST], cosine[MOST], sine[MOST];
        const size_t n = (size_t)below(&g, MOST + 1);
        for (size_t i = 0; i < n; i++) {
            const double place = 45.0 * (below(&g, 4000) - 2000), size = log_uniform(&g, 1e-300, DBL_MAX);
            degrees[i] = chance(&g, 0.4)   ? uniform(&g, -400, 400)
                         : chance(&g, 0.2) ? place
                         : chance(&g, 0.3) ? nextafter(place, chance(&g, 0.5) ? FAR : -FAR)
                         : chance(&g, 0.1) ? (chance(&g, 0.3) ? NOT : chance(&g, 0.5) ? FAR : -FAR)
                         : chance(&g, 0.1) ? -0.0
                                           : copysign(size, uniform(&g, -1, 1));
        }
        sgt_turns(n, degrees, cosine, sine);
        for (size_t i = 0; i < n; i++) {
            const sgt_vec3 one = sgt_pose_tilted((sgt_vec3){0}, (sgt_vec3){0, 0, degrees[i]}).ex;
            const bool none = isnan(one.x) && isnan(cosine[i]) && isnan(one.y) && isnan(sine[i]);
            REQUIRE(none || (same_bits(one.x, cosine[i]) && same_bits(one.y, sine[i])),
                    "%.17g degrees: %.17g %.17g, alone %.17g %.17g", degrees[i], cosine[i], sine[i], one.x,
                    one.y);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_product), cmocka_unit_test(test_one_turn),
        cmocka_unit_test(test_quarters_exact),  cmocka_unit_test(test_sense),
        cmocka_unit_test(test_whole_turns),     cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
