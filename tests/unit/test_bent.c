// SPDX-License-Identifier: MIT
/* What the second derivative of a sag within its rim lies in, along any direction (`bent` of
 * src/surface/builtin.h), against mean values of it: (g(p + e d) - g(p - e d)) . d / 2 e, with g the
 * gradient of the sag, is the mean of its second derivative along d between these two points.  So it lies in
 * the range, whatever e is, but for rounding of g.  Points are drawn often at the rim and near the axis.
 *
 * What is seen of a q_con also has to fill half of what its departure is given, or more.
 *
 * And what toroids and biconics say of themselves about the axis (extent_within, extent_in_box), by sums of
 * magnitudes or by intervals: slopes, second derivatives and heights, against the surface in as many points,
 * corners of the box and the rim among them. */
#include "unit.h"

#include "../../src/surface/builtin.h"

#include <sagitta/surfaces.h>

static generator drawn;
static double numbers[300];

static double one_of(double a, double b) { return uniform(&drawn, 0, 1) < 0.5 ? a : b; }

/* Coefficients of both signs, in four cases of ten all of one, that fall or not. */
static sgt_numbers draw_numbers(size_t n, double size)
{
    double fall = uniform(&drawn, -2, 0.5);
    bool alike = uniform(&drawn, 0, 1) < 0.4;
    for (size_t i = 0; i < n; i++)
        numbers[i] = size * pow((double)i + 1, fall) * (alike ? 1 : uniform(&drawn, -1, 1));
    return (sgt_numbers){numbers, 1, n};
}

static sgt_vec3 gradient_at(sgt_surface s, double x, double y)
{
    sgt_vec3 grad;
    s.ops->value(s.self, (sgt_vec3){x, y, 0}, &grad);
    return grad;
}

typedef struct seen { double least, most; } seen;

/* scale: of the second derivatives of all terms.  A gradient rounds by 2^-40 of that times rim, or less. */
static seen look_all_over(sgt_surface s, double rim, sgt_interval range, double scale)
{
    seen all = {HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < 400; i++) {
        double where = uniform(&drawn, 0, 1), about = uniform(&drawn, 0, 6.2832),
               to = uniform(&drawn, 0, 3.1416), e = rim * exp2(uniform(&drawn, -12, -6)),
               most = rim - 1.01 * e, part = uniform(&drawn, 0, 1),
               r = where < 0.3 ? most : where < 0.4 ? 0x1p-6 * rim * part : most * sqrt(part);
        if (where > 0.2 && where < 0.3) to = about;
        double x = r * cos(about), y = r * sin(about), l = cos(to), m = sin(to);
        sgt_vec3 a = gradient_at(s, x + e * l, y + e * m), b = gradient_at(s, x - e * l, y - e * m);
        double mean = -((a.x - b.x) * l + (a.y - b.y) * m) / (2 * e), off = 0x1p-38 * scale * rim / e;
        REQUIRE(mean >= range.lo - off && mean <= range.hi + off,
                "%s: the second derivative is %.17g at %g, not in [%.17g, %.17g]", s.ops->name, mean, r / rim,
                range.lo, range.hi);
        all.least = fmin(all.least, mean), all.most = fmax(all.most, mean);
    }
    return all;
}

static bool range_of(sgt_surface s, sgt_interval *range, sgt_shared *shared)
{
    const struct sgt_builtin_ops *own = s.ops->own_->in_set[0]->own_;
    own->share(s.self, shared);
    return own->bent && own->bent(s.self, range);
}

static void second_derivatives_are_within(void **unused)
{
    (void)unused;
    drawn = seeded("bent");
    long said = 0, narrower = 0, count = scaled(400), filled = 0, of_q = 0;
    for (long i = 0; i < count; i++) {
        double norm = exp2(uniform(&drawn, -10, 10)), rim = norm * one_of(1, exp2(uniform(&drawn, -2, 1))),
               c = one_of(0, uniform(&drawn, -0.5, 0.5) / rim), k = uniform(&drawn, -2, 1);
        const size_t most = i % 2 ? 231 : 16;
        sgt_numbers a = draw_numbers(1 + (size_t)uniform(&drawn, 0, (double)most - 1e-9),
                                     norm * exp2(uniform(&drawn, -20, -3)));
        sgt_q_con q = {.c = c, .k = k, .semi_diameter = rim, .norm = norm, .a = a};
        sgt_zernike z = {.c = c, .k = k, .semi_diameter = rim, .norm = norm, .a = a,
                         .order = i % 4 == 1 ? SGT_NOLL : SGT_FRINGE, .normalised = i % 8 < 4};
        sgt_surface s = i % 2 ? (sgt_surface){&sgt_zernike_ops, &z} : (sgt_surface){&sgt_q_con_ops, &q};
        sgt_interval range;
        sgt_shared shared;
        if (!range_of(s, &range, &shared)) continue;
        said++;
        double before = shared.bent.hi - shared.bent.lo, after = range.hi - range.lo;
        seen all = look_all_over(s, rim, range, fmax(fabs(shared.bent.lo), fabs(shared.bent.hi)));
        narrower += after < 0.5 * before;
        if (c == 0 && i % 2 == 0) of_q++, filled += all.most - all.least > 0.5 * after;
    }
    print_message("%ld of %ld have a range, %ld half as wide as by terms or less; %ld of %ld q_con fill it\n",
                  said, count, narrower, filled, of_q);
    REQUIRE((double)said > 0.8 * (double)count, "%ld of %ld have a range", said, count);
    REQUIRE((double)narrower > 0.3 * (double)said, "only %ld of %ld are half as wide as by terms", narrower,
            said);
    REQUIRE((double)filled > 0.9 * (double)of_q, "only %ld of %ld q_con fill half of it", filled, of_q);
}

/* What is seen of a surface that is flat along neither axis, over what it says. */
typedef struct filled { double steep, xx, yy; } filled;

static double part_of(double met, double said) { return said > 0 ? met / said : 0; }

/* In the box |x| <= X, |y| <= Y, and within r.  A bound rounds by less than 2^-30 of itself. */
static filled look_about(sgt_surface s, double X, double Y, double r, double steep, const sgt_by_axis *axis,
                         const sgt_extent *whole)
{
    filled all = {0, 0, 0};
    const double more = 1 + 0x1p-30, e = 0x1p-8 * fmin(X, Y),
                 xx_most = fmax(axis->xx.hi, -axis->xx.lo), yy_most = fmax(axis->yy.hi, -axis->yy.lo),
                 off = 0x1p-30 * (steep / e + xx_most + yy_most);
    for (int i = 0; i < 200; i++) {
        double x = (X - e) * (i % 3 ? uniform(&drawn, -1, 1) : one_of(1, -1)),
               y = (Y - e) * (i % 5 ? uniform(&drawn, -1, 1) : one_of(1, -1)), far = sqrt(x * x + y * y);
        if (far > r - 2 * e) x *= (r - 2 * e) / far, y *= (r - 2 * e) / far;
        sgt_vec3 g;
        double sag = -s.ops->value(s.self, (sgt_vec3){x, y, 0}, &g);
        if (isnan(sag)) continue;
        sgt_vec3 right = gradient_at(s, x + e, y), left = gradient_at(s, x - e, y),
                 up = gradient_at(s, x, y + e), down = gradient_at(s, x, y - e);
        double xx = -(right.x - left.x) / (2 * e), yy = -(up.y - down.y) / (2 * e),
               xy = -(up.x - down.x) / (2 * e);
        double slope = sqrt(g.x * g.x + g.y * g.y);
        bool inside = slope <= steep * more && fabs(g.x) <= axis->x * more && fabs(g.y) <= axis->y * more;
        bool bent = xx >= axis->xx.lo - off && xx <= axis->xx.hi + off && yy >= axis->yy.lo - off &&
                    yy <= axis->yy.hi + off && fabs(xy) <= axis->xy + off;
        bool held = !whole || (sag >= whole->z.lo && sag <= whole->z.hi && xx >= whole->bent.lo - off &&
                               xx <= whole->bent.hi + off && yy >= whole->bent.lo - off &&
                               yy <= whole->bent.hi + off);
        REQUIRE(inside && bent && held,
                "%s at (%g, %g): slopes %.17g, %.17g, second derivatives %.17g, %.17g, %.17g, sag %.17g; "
                "said %.17g, %.17g, [%.17g, %.17g], [%.17g, %.17g], %.17g",
                s.ops->name, x, y, g.x, g.y, xx, yy, xy, sag, axis->x, axis->y, axis->xx.lo, axis->xx.hi,
                axis->yy.lo, axis->yy.hi, axis->xy);
        all.steep = fmax(all.steep, part_of(slope, steep));
        all.xx = fmax(all.xx, part_of(fabs(xx), xx_most));
        all.yy = fmax(all.yy, part_of(fabs(yy), yy_most));
    }
    return all;
}

static void toroids_and_biconics_are_within(void **unused)
{
    (void)unused;
    drawn = seeded("about the axis");
    long said = 0, count = scaled(600);
    double steep = 0, bend = 0;
    for (long i = 0; i < count; i++) {
        double r = exp2(uniform(&drawn, -10, 10)), slope = exp2(uniform(&drawn, -12, 1)),
               c = one_of(1, -1) * slope / r, other = c * one_of(uniform(&drawn, -1, 1), one_of(0, 1));
        sgt_toroidal t = {.c = other, .k = uniform(&drawn, -3, 2), .c_x = c, .semi_diameter = 2 * r};
        for (int j = 0; j < 3 && i % 4 == 0; j++)
            t.a[j] = uniform(&drawn, -0.2, 0.2) * slope / pow(r, 2 * j + 1);
        sgt_biconic b = {.c_x = one_of(c, other), .c_y = one_of(c, other), .k_x = uniform(&drawn, -3, 2),
                         .k_y = uniform(&drawn, -3, 2), .semi_diameter = 2 * r};
        sgt_surface s = i % 2 ? (sgt_surface){&sgt_biconic_ops, &b} : (sgt_surface){&sgt_toroidal_ops, &t};
        const struct sgt_builtin_ops *own = s.ops->own_->in_set[0]->own_;
        sgt_extent whole;
        own->extent_within(s.self, r, true, &whole);
        if (whole.steep < HUGE_VAL) {
            filled all = look_about(s, r, r, r, whole.steep, &whole.axis, &whole);
            said++, steep += all.steep, bend += fmax(all.xx, all.yy);
        }
        double x = r * exp2(uniform(&drawn, -6, 0)), y = r * exp2(uniform(&drawn, -6, 0)), in_box;
        sgt_by_axis axis;
        own->extent_in_box(s.self, x, y, &in_box, &axis);
        if (in_box < HUGE_VAL) look_about(s, x, y, 2 * (x + y), in_box, &axis, NULL);
    }
    steep /= (double)said, bend /= (double)said;
    print_message("%ld of %ld say how steep they are within a radius; seen of that in the mean: %.2f of the "
                  "slope, %.2f of the bend\n", said, count, steep, bend);
    REQUIRE((double)said > 0.8 * (double)count, "%ld of %ld know of a slope", said, count);
    REQUIRE(steep > 0.8 && bend > 0.75, "they say too much: %.2f and %.2f are seen", steep, bend);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(second_derivatives_are_within),
                                       cmocka_unit_test(toroids_and_biconics_are_within)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
