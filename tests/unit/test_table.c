/* What every row of sgt_builtins owes, from the row alone: a new surface is tested here the day
 * it is in the table. */
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

enum { LARGEST = 4096 };
typedef union parameters { double number[LARGEST / sizeof(double)]; char bytes[LARGEST]; } parameters;

static double *number_at(parameters *p, const sgt_param *param, int i) { return (double *)(void *)(p->bytes + param->offset) + i; }

static void test_rows(void **state)
{
    (void)state;
    size_t rows = 0;
    for (const sgt_builtin *row = sgt_builtins; row->type; row++, rows++) {
        assert_non_null(row->ops);
        assert_non_null(row->ops->name);
        assert_non_null(row->ops->value);
        assert_non_null(row->ops->span);
        assert_non_null(row->ops->rounding);
        assert_non_null(row->params);
        REQUIRE(row->size > 0 && row->size <= LARGEST, "%s: %zu bytes", row->type, row->size);
        for (const char *c = row->type; *c; c++) REQUIRE((*c >= 'a' && *c <= 'z') || *c == '_' || (*c >= '0' && *c <= '9'), "%s: not a key", row->type);
        for (const sgt_builtin *other = sgt_builtins; other != row; other++) assert_string_not_equal(row->type, other->type);
        for (const sgt_param *p = row->params; p->name; p++) {
            REQUIRE(p->unit && *p->unit, "%s.%s has no unit", row->type, p->name);
            size_t each = p->kind == SGT_WHOLE ? sizeof(int) : sizeof(double);
            REQUIRE(p->count >= 1 && p->offset % each == 0 && p->offset + (size_t)p->count * each <= row->size, "%s.%s lies outside the struct", row->type, p->name);
            REQUIRE(p->lo <= p->hi && isfinite(p->lo) && isfinite(p->hi), "%s.%s: legal from %g to %g", row->type, p->name, p->lo, p->hi);
            REQUIRE(row->object || (p->lo <= 0 && p->hi >= 0), "%s.%s: zero is the default, and not legal", row->type, p->name);
            for (const sgt_param *other = row->params; other != p; other++) {
                assert_string_not_equal(p->name, other->name);
                bool short_name = !strcmp(p->name, "slice") && !strcmp(other->name, "at"); /* the one overlap there is */
                size_t other_each = other->kind == SGT_WHOLE ? sizeof(int) : sizeof(double);
                REQUIRE(short_name || p->offset + (size_t)p->count * each <= other->offset || other->offset + (size_t)other->count * other_each <= p->offset, "%s: %s and %s overlap", row->type, p->name, other->name);
            }
        }
    }
    assert_true(rows >= 4);
    const sgt_builtin *end = &sgt_builtins[rows];
    assert_true(!end->type && !end->ops && !end->size && !end->params);
    static const char *const wanted[] = {"plane", "sphere", "conic", "even_asphere"};
    for (size_t i = 0; i < COUNT_OF(wanted); i++) {
        const sgt_builtin *row = sgt_builtins;
        while (row->type && strcmp(row->type, wanted[i])) row++;
        REQUIRE(row->type, "no row for %s", wanted[i]);
    }
}

/* Zero is a plane for every sag. */
static void test_zero(void **state)
{
    (void)state;
    generator g = seeded("zero is a plane");
    for (const sgt_builtin *row = sgt_builtins; row->type; row++) {
        if (row->object) continue; /* a level set: test_levels.c */
        parameters zero = {{0}};
        for (int i = 0; i < 1000; i++) {
            sgt_vec3 p = random_point(&g, log_uniform(&g, 1e-6, 1e6)), n;
            REQUIRE(row->ops->value(&zero, p, &n) == p.z && n.x == 0 && n.y == 0 && n.z == 1, "%s of zeros is no plane", row->type);
            sgt_ray ray = {.o = p, .d = random_direction(&g), .tmin = -FAR, .tmax = FAR};
            sgt_hit hit = sgt_intersect((sgt_surface){row->ops, &zero}, ray, NULL);
            long double t = -(long double)p.z / ray.d.z;
            REQUIRE(hit.status == SGT_HIT && fabsl(hit.t - t) <= hit.t_err + 0x1p-62L * fabsl(t), "%s of zeros: %s at %.17g, %.17Lg wanted", row->type, sgt_status_text(hit.status), hit.t, t);
        }
    }
}

/* Parameters as a lens would have them, for a part of size h.  What the unit says is all that
 * is known of them. */
static void random_parameters(generator *g, const sgt_builtin *row, double h, parameters *out)
{
    *out = (parameters){{0}};
    for (const sgt_param *p = row->params; p->name; p++)
        for (int i = 0; i < p->count; i++) {
            double x;
            if (!strcmp(p->unit, "1")) x = chance(g, 0.3) ? -1 : uniform(g, -3, 2);
            else if (!strcmp(p->unit, "length")) x = chance(g, 0.5) ? 0 : h * uniform(g, 0.1, 1);
            else if (!strcmp(p->unit, "1/length")) x = chance(g, 0.1) ? 0 : either_sign(g) / (h * log_uniform(g, 1.2, 1e3));
            else if (!strcmp(p->unit, "1/length^(2i+1)")) x = chance(g, 0.5) ? 0 : uniform(g, -0.05, 0.05) * pow(h, -(2 * i + 1));
            else {
                fail_msg("%s.%s: no values are known for the unit %s", row->type, p->name, p->unit);
                return;
            }
            if (x >= p->lo && x <= p->hi) *number_at(out, p, i) = x;
        }
}

static sgt_ray ray_at(generator *g, double h)
{
    sgt_vec3 d = random_direction(g), at = random_point(g, 0.5 * h);
    double away = h * log_uniform(g, 1e-2, 1e3);
    return (sgt_ray){.o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, .d = d, .tmin = -FAR, .tmax = FAR};
}

static void test_conformance(void **state)
{
    (void)state;
    generator g = seeded("conformance");
    long n = scaled(2000);
    for (const sgt_builtin *row = sgt_builtins; row->type; row++) {
        if (row->object) continue; /* a level set: test_levels.c */
        long met = 0, missed = 0, undecided = 0;
        for (long i = 0; i < n; i++) {
            double h = log_uniform(&g, 1e-3, 1e3);
            parameters p;
            random_parameters(&g, row, h, &p);
            sgt_surface s = {row->ops, &p};
            sgt_vec3 vertex = {0}, grad = {NOT, NOT, NOT};
            double f = s.ops->value(s.self, vertex, &grad);
            REQUIRE(f == 0 && grad.z == 1 && grad.x == 0 && grad.y == 0, "%s, case %ld: F %g at the vertex", row->type, i, f);
            REQUIRE(same_bits(s.ops->value(s.self, vertex, NULL), f), "%s, case %ld: another F without the gradient", row->type, i);

            sgt_ray rays[3] = {ray_at(&g, h), ray_at(&g, h), ray_at(&g, h)};
            sgt_vec3 where;
            sgt_fault fault = sgt_check(s, COUNT_OF(rays), rays, &where);
            REQUIRE(fault == SGT_SOUND, "%s, case %ld: %s at %.17g %.17g %.17g", row->type, i, sgt_fault_text(fault), where.x, where.y, where.z);

            /* a copy by memcpy is as good: nothing is owned */
            parameters copy;
            memcpy(&copy, &p, row->size);
            for (size_t j = 0; j < COUNT_OF(rays); j++)
                for (sgt_pick pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                    sgt_hit hit = sgt_intersect(s, rays[j], &(sgt_options){.pick = pick}), again = sgt_intersect((sgt_surface){row->ops, &copy}, rays[j], &(sgt_options){.pick = pick});
                    REQUIRE(hit.status == again.status && same_bits(hit.t, again.t), "%s, case %ld: a copy differs", row->type, i);
                    REQUIRE(hit.status >= SGT_UNPROVEN, "%s, case %ld: %s", row->type, i, sgt_status_text(hit.status));
                    met += hit.status > 0, missed += hit.status == SGT_MISS, undecided += hit.status < 0;
                    if (hit.status != SGT_HIT) continue;
                    sgt_span span = s.ops->span(s.self, &rays[j]);
                    REQUIRE(hit.t + hit.t_err >= span.lo && hit.t - hit.t_err <= span.hi, "%s, case %ld: a root at %.17g outside the span [%g, %g]", row->type, i, hit.t, span.lo, span.hi);
                    double value = s.ops->value(s.self, hit.p, &grad), size = sqrt(grad.x * grad.x + grad.y * grad.y + grad.z * grad.z);
                    if (!isnan(value)) REQUIRE(fabs(value) <= 2 * size * hit.p_err + s.ops->rounding(s.self, hit.p), "%s, case %ld: F %g at the hit, p_err %g", row->type, i, value, hit.p_err);
                    REQUIRE(same_bits(value, hit.f) || (isnan(value) && isnan(hit.f)), "%s, case %ld: f %g, F %g", row->type, i, hit.f, value);
                }
        }
        print_message("%s: %ld met, %ld missed, %ld undecided\n", row->type, met, missed, undecided);
    }
}

/* A number that is none makes the surface invalid, wherever it stands. */
static void test_not_finite(void **state)
{
    (void)state;
    const double bad[] = {NOT, FAR, -FAR};
    for (const sgt_builtin *row = sgt_builtins; row->type; row++)
        for (const sgt_param *param = row->params; param->name; param++)
            for (int i = 0; param->kind != SGT_WHOLE && i < param->count; i++)
                for (size_t k = 0; k < COUNT_OF(bad); k++) {
                    parameters p = {{0}};
                    *number_at(&p, param, i) = bad[k];
                    sgt_hit hit = sgt_intersect((sgt_surface){row->ops, &p}, (sgt_ray){.o = {0.1, 0.2, -3}, .d = {0, 0, 1}}, NULL);
                    REQUIRE(hit.status == SGT_INVALID && isnan(hit.t), "%s with %s[%d] = %g: %s", row->type, param->name, i, bad[k], sgt_status_text(hit.status));
                }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows), cmocka_unit_test(test_zero), cmocka_unit_test(test_conformance), cmocka_unit_test(test_not_finite)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
