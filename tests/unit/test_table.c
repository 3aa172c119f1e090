// SPDX-License-Identifier: MIT
/* What every row of sgt_builtins owes, from the row alone: a new surface is tested here the day
 * it is in the table. */
#include "unit.h"

#include <sagitta/diagnose.h>
#include <sagitta/surfaces.h>

/* A struct of parameters, and what it points to. */
enum { LARGEST = 4096, ROOM = 400, MOST_TERMS = 3 };
typedef struct parameters {
    union { double number[LARGEST / sizeof(double)]; char bytes[LARGEST]; } is;
    double room[ROOM];
    size_t used;
    sgt_surface terms[MOST_TERMS];
    struct parameters *of_term; /* MOST_TERMS of them, where the row has terms */
} parameters;

static void *member(parameters *p, const sgt_param *param) { return p->is.bytes + param->offset; }
static double *number_at(parameters *p, const sgt_param *param, int i)
{
    return (double *)member(p, param) + i;
}

static bool is_whole(sgt_param_kind kind)
{
    return kind == SGT_PARAM_WHOLE || kind == SGT_PARAM_WORD || kind == SGT_PARAM_TRUTH;
}

/* In the struct: of one, and of all. */
static size_t alignment_of(const sgt_param *p) { return is_whole(p->kind) ? sizeof(int) : sizeof(double); }
static size_t size_of(const sgt_param *p)
{
    switch (p->kind) {
    case SGT_PARAM_LIST: case SGT_PARAM_TABLE: return sizeof(sgt_numbers);
    case SGT_PARAM_TERMS: return sizeof(sgt_surface *) + sizeof(size_t);
    case SGT_PARAM_WHOLE: case SGT_PARAM_WORD: case SGT_PARAM_TRUTH: return (size_t)p->count * sizeof(int);
    default: return (size_t)p->count * sizeof(double);
    }
}

/* They have tests of their own (test_levels.c). */
static bool is_level_set(const sgt_builtin *row) { return row->family == SGT_FAMILY_LEVEL_SET; }

/* The first thing wrong, said of a key of the row. */
static bool objected(const sgt_builtin *row, const parameters *p)
{
    sgt_objection o = row->object ? row->object(&p->is) : (sgt_objection){NULL, NULL};
    if (!o.param) return false;
    bool known = false, has_terms = false;
    for (const sgt_param *param = row->params; param->name; param++)
        known |= !strcmp(param->name, o.param), has_terms |= param->kind == SGT_PARAM_TERMS;
    REQUIRE(known || has_terms, "%s: an objection to %s, which is no key of it", row->type, o.param);
    REQUIRE(o.reason && *o.reason, "%s: an objection to %s without a reason", row->type, o.param);
    return true;
}

static void test_rows(void **state)
{
    (void)state;
    size_t rows = 0;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++, rows++) {
        assert_non_null(row->ops);
        assert_non_null(row->ops->name);
        assert_non_null(row->ops->value);
        assert_non_null(row->ops->span);
        assert_non_null(row->ops->rounding);
        assert_non_null(row->params);
        assert_int_not_equal(row->family, SGT_FAMILY_OTHER);
        assert_int_equal(row->family == SGT_FAMILY_LEVEL_SET, row->ops->estimate != NULL);
        REQUIRE(row->size > 0 && row->size <= LARGEST, "%s: %zu bytes", row->type, row->size);
        for (const char *c = row->type; *c; c++)
            REQUIRE((*c >= 'a' && *c <= 'z') || *c == '_' || (*c >= '0' && *c <= '9'), "%s: not a key",
                    row->type);
        for (const sgt_builtin *other = sgt_builtins(); other != row; other++)
            assert_string_not_equal(row->type, other->type);
        for (const sgt_param *p = row->params; p->name; p++) {
            REQUIRE(p->count >= 1 && p->offset % alignment_of(p) == 0 && p->offset + size_of(p) <= row->size,
                    "%s.%s lies outside the struct", row->type, p->name);
            if (p->kind == SGT_PARAM_WORD) {
                int words = 1;
                for (const char *c = p->words; *c; c++) words += *c == '|';
                REQUIRE(p->lo == 1 && p->hi == words, "%s.%s: %d words, legal from %g to %g", row->type,
                        p->name, words, p->lo, p->hi);
            }
            REQUIRE(p->lo <= p->hi && isfinite(p->lo) && isfinite(p->hi), "%s.%s: legal from %g to %g",
                    row->type, p->name, p->lo, p->hi);
            REQUIRE(row->object || (p->lo <= 0 && p->hi >= 0), "%s.%s: zero is the default, and not legal",
                    row->type, p->name);
            for (const sgt_param *other = row->params; other != p; other++) {
                assert_string_not_equal(p->name, other->name);
                /* the one overlap there is */
                bool short_name = !strcmp(p->name, "slice") && !strcmp(other->name, "at");
                REQUIRE(short_name || p->offset + size_of(p) <= other->offset ||
                            other->offset + size_of(other) <= p->offset,
                        "%s: %s and %s overlap", row->type, p->name, other->name);
            }
        }
    }
    assert_true(rows >= 4);
    const sgt_builtin *end = &sgt_builtins()[rows];
    assert_true(!end->type && !end->ops && !end->size && !end->params);
    static const char *const wanted[] = {"plane", "sphere", "conic", "even_asphere"};
    for (size_t i = 0; i < COUNT_OF(wanted); i++) {
        const sgt_builtin *row = sgt_builtins();
        while (row->type && strcmp(row->type, wanted[i])) row++;
        REQUIRE(row->type, "no row for %s", wanted[i]);
    }
}

/* Zero is a plane for every sag, but where it is objected to. */
static void test_zero(void **state)
{
    (void)state;
    generator g = seeded("zero is a plane");
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        if (is_level_set(row)) continue;
        static parameters all_zero;
        const void *zero = &all_zero.is;
        if (objected(row, &all_zero)) {
            sgt_hit hit = sgt_intersect((sgt_surface){row->ops, zero},
                                        (sgt_ray){.o = {0.1, 0.2, -3}, .d = {0, 0, 1}}, NULL);
            REQUIRE(hit.status == SGT_INVALID, "%s of zeros is objected to, and %s", row->type,
                    sgt_status_text(hit.status));
            continue;
        }
        for (int i = 0; i < 1000; i++) {
            sgt_vec3 p = random_point(&g, log_uniform(&g, 1e-6, 1e6)), n;
            REQUIRE(row->ops->value(zero, p, &n) == p.z && n.x == 0 && n.y == 0 && n.z == 1,
                    "%s of zeros is no plane", row->type);
            sgt_ray ray = {.o = p, .d = random_direction(&g), .tmin = -FAR, .tmax = FAR};
            sgt_hit hit = sgt_intersect((sgt_surface){row->ops, zero}, ray, NULL);
            long double t = -(long double)p.z / ray.d.z;
            REQUIRE(hit.status == SGT_HIT && fabsl(hit.t - t) <= hit.t_err + 0x1p-62L * fabsl(t),
                    "%s of zeros: %s at %.17g, %.17Lg wanted", row->type, sgt_status_text(hit.status), hit.t,
                    t);
        }
    }
}

static bool is_listed(sgt_param_unit u) { return u.by_i != 0 || u.by_j != 0; }

/* A number of such a unit, for a part of size h, the i-th and j-th of its kind. */
static double random_number(generator *g, sgt_param_unit u, double h, int i, int j)
{
    int power = u.length + i * u.by_i + j * u.by_j;
    if (!is_listed(u) && power == 0) return chance(g, 0.3) ? -1 : uniform(g, -3, 2);
    if (!is_listed(u) && power == 1) return chance(g, 0.5) ? 0 : h * uniform(g, 0.1, 1);
    if (!is_listed(u) && power == 2) return chance(g, 0.2) ? 0 : h * h * uniform(g, -1, 1);
    if (!is_listed(u) && power == -1)
        return chance(g, 0.1) ? 0 : either_sign(g) / (h * log_uniform(g, 1.2, 1e3));
    double most = u.by_j ? 0.02 : 0.05;
    return chance(g, 0.5) ? 0 : uniform(g, -most, most) * pow(h, power);
}

/* Some numbers, a part of h together. */
static sgt_numbers random_numbers(generator *g, const sgt_param *p, double h, parameters *out)
{
    int most = p->count < 9 ? p->count : 9, rows = p->kind == SGT_PARAM_LIST ? 1 : below(g, most + 1),
        columns = below(g, most + 1);
    sgt_numbers a = {out->room + out->used, (size_t)rows, (size_t)columns};
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            double *x = &out->room[out->used++];
            if (!is_listed(p->unit) && p->unit.length == 1) *x = h * uniform(g, -0.1, 0.1) / (rows * columns);
            else *x = p->kind == SGT_PARAM_LIST ? random_number(g, p->unit, h, j, 0)
                                          : random_number(g, p->unit, h, i, j);
        }
    if (rows * columns == 0) a = (sgt_numbers){NULL, 0, 0};
    return a;
}

/* Parameters as a lens would have them, for a part of size h, that nobody objects to.  What the unit says
 * is all that is known of them. */
static void random_parameters(generator *g, const sgt_builtin *row, double h, parameters *out);

static void random_terms(generator *g, const sgt_builtin *row, const sgt_param *p, double h, parameters *out)
{
    size_t count = (size_t)below(g, MOST_TERMS + 1), rows = 0;
    while (sgt_builtins()[rows].type) rows++;
    if (!out->of_term) out->of_term = calloc(MOST_TERMS, sizeof *out->of_term);
    for (size_t i = 0; i < count;) {
        const sgt_builtin *of = &sgt_builtins()[below(g, (int)rows)];
        if (of == row || is_level_set(of)) continue;
        random_parameters(g, of, h, &out->of_term[i]);
        out->terms[i] = (sgt_surface){of->ops, &out->of_term[i].is};
        const sgt_surface *terms = out->terms;
        size_t now = i + 1;
        memcpy(member(out, p), &terms, sizeof terms);
        memcpy((char *)member(out, p) + sizeof terms, &now, sizeof now);
        i += !row->object(&out->is).param; /* some surfaces are no terms */
    }
    memcpy((char *)member(out, p) + sizeof(sgt_surface *), &count, sizeof count);
}

static void random_parameters(generator *g, const sgt_builtin *row, double h, parameters *out)
{
    for (int tries = 0; tries < 10000; tries++) {
        parameters *of_term = out->of_term;
        memset(out, 0, sizeof *out);
        out->of_term = of_term;
        for (const sgt_param *p = row->params; p->name; p++) {
            if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
                sgt_numbers a = random_numbers(g, p, h, out);
                memcpy(member(out, p), &a, sizeof a);
            } else if (p->kind == SGT_PARAM_TERMS) random_terms(g, row, p, h, out);
            else if (is_whole(p->kind)) {
                int whole = (int)p->lo + below(g, (int)(p->hi - p->lo) + 1);
                memcpy(member(out, p), &whole, sizeof whole);
            } else
                for (int i = 0; i < p->count; i++) {
                    double x = random_number(g, p->unit, h, i, 0);
                    /* far beyond it polynomials are wild */
                    if (!strncmp(p->name, "norm", 4)) x = chance(g, 0.1) ? 0 : h * uniform(g, 0.8, 1.5);
                    if (x >= p->lo && x <= p->hi) *number_at(out, p, i) = x;
                }
        }
        if (!objected(row, out)) return;
    }
    fail_msg("%s: all parameters are objected to", row->type);
}

static sgt_ray ray_at(generator *g, double h)
{
    sgt_vec3 d = random_direction(g), at = random_point(g, 0.5 * h);
    double away = h * log_uniform(g, 1e-2, 1e3);
    return (sgt_ray){
        .o = {at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, .d = d, .tmin = -FAR, .tmax = FAR};
}

static void test_conformance(void **state)
{
    (void)state;
    generator g = seeded("conformance");
    long n = scaled(100);
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        if (is_level_set(row)) continue;
        static parameters p;
        long met = 0, missed = 0, undecided = 0, past = 0;
        for (long i = 0; i < n; i++) {
            double h = log_uniform(&g, 1e-3, 1e3);
            random_parameters(&g, row, h, &p);
            bool endless = false; /* what has no rim, on a ray without ends, may be past deciding */
            for (const sgt_param *rim = row->params; rim->name; rim++)
                endless |= row->object && !strcmp(rim->name, "semi_diameter") && *number_at(&p, rim, 0) == 0;
            sgt_surface s = {row->ops, &p.is};
            sgt_vec3 vertex = {0}, grad = {NOT, NOT, NOT};
            double f = s.ops->value(s.self, vertex, &grad);
            if (!row->object)
                REQUIRE(f == 0 && grad.z == 1 && grad.x == 0 && grad.y == 0,
                        "%s, case %ld: F %g at the vertex", row->type, i, f);
            REQUIRE(same_bits(s.ops->value(s.self, vertex, NULL), f),
                    "%s, case %ld: another F without the gradient", row->type, i);

            sgt_ray rays[3] = {ray_at(&g, h), ray_at(&g, h), ray_at(&g, h)};
            sgt_vec3 where;
            sgt_fault fault = sgt_check(s, COUNT_OF(rays), rays, &where);
            REQUIRE(fault == SGT_SOUND, "%s, case %ld: %s at %.17g %.17g %.17g", row->type, i,
                    sgt_fault_text(fault), where.x, where.y, where.z);

            /* a copy by memcpy is as good: nothing is owned */
            static double copy[LARGEST / sizeof(double)];
            memcpy(copy, &p.is, row->size);
            for (size_t j = 0; j < COUNT_OF(rays); j++)
                for (sgt_pick pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
                    sgt_hit hit = sgt_intersect(s, rays[j], &(sgt_options){.pick = pick}),
                            again = sgt_intersect((sgt_surface){row->ops, copy}, rays[j],
                                                  &(sgt_options){.pick = pick});
                    REQUIRE(hit.status == again.status && same_bits(hit.t, again.t),
                            "%s, case %ld: a copy differs", row->type, i);
                    REQUIRE(hit.status >= (endless ? SGT_EXHAUSTED : SGT_UNPROVEN), "%s, case %ld: %s",
                            row->type, i, sgt_status_text(hit.status));
                    met += hit.status > 0, missed += hit.status == SGT_MISS,
                        undecided += hit.status < 0 && !endless, past += hit.status < 0 && endless;
                    if (hit.status != SGT_HIT) continue;
                    sgt_span span = s.ops->span(s.self, &rays[j]);
                    REQUIRE(hit.t + hit.t_err >= span.lo && hit.t - hit.t_err <= span.hi,
                            "%s, case %ld: a root at %.17g outside the span [%g, %g]", row->type, i, hit.t,
                            span.lo, span.hi);
                    double value = s.ops->value(s.self, hit.p, &grad),
                           size = sqrt(grad.x * grad.x + grad.y * grad.y + grad.z * grad.z);
                    if (!isnan(value))
                        REQUIRE(fabs(value) <= 2 * size * hit.p_err + s.ops->rounding(s.self, hit.p),
                                "%s, case %ld: F %g at the hit, p_err %g", row->type, i, value, hit.p_err);
                    REQUIRE(same_bits(value, hit.f) || (isnan(value) && isnan(hit.f)),
                            "%s, case %ld: f %g, F %g", row->type, i, hit.f, value);
                }
        }
        print_message("%s: %ld met, %ld missed, %ld undecided, %ld more where neither surface nor ray ends\n",
                      row->type, met, missed, undecided, past);
        REQUIRE((double)undecided <= 2 + 1e-3 * (double)(met + missed), "%s: %ld undecided", row->type,
                undecided);
    }
}

static void require_invalid(const sgt_builtin *row, const parameters *p, const sgt_param *param, int i,
                            double bad)
{
    sgt_hit hit = sgt_intersect((sgt_surface){row->ops, &p->is},
                                (sgt_ray){.o = {0.1, 0.2, -3}, .d = {0, 0, 1}}, NULL);
    REQUIRE(hit.status == SGT_INVALID && isnan(hit.t), "%s with %s[%d] = %g: %s", row->type, param->name, i,
            bad, sgt_status_text(hit.status));
    if (!row->object || is_level_set(row)) return;
    sgt_objection o = row->object(&p->is);
    REQUIRE(o.param && o.reason && !strcmp(o.param, param->name), "%s with %s[%d] = %g: objected to is %s",
            row->type, param->name, i, bad, o.param ? o.param : "nothing");
}

/* A number that is none makes the surface invalid, wherever it stands. */
static void test_not_finite(void **state)
{
    (void)state;
    generator g = seeded("not finite");
    const double bad[] = {NOT, FAR, -FAR};
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++)
        for (const sgt_param *param = row->params; param->name; param++)
            for (size_t k = 0; k < COUNT_OF(bad); k++) {
                static parameters p;
                bool level = is_level_set(row);
                /* tests/catalogue has those */
                if (is_whole(param->kind) || param->kind == SGT_PARAM_TERMS) continue;
                if (param->kind == SGT_PARAM_LIST || param->kind == SGT_PARAM_TABLE) {
                    sgt_numbers a = {0};
                    while (a.rows * a.columns == 0)
                        random_parameters(&g, row, 1, &p), memcpy(&a, member(&p, param), sizeof a);
                    for (size_t i = 0; i < a.rows * a.columns; i++) {
                        double good = a.x[i], *x = p.room + (a.x - p.room) + i;
                        *x = bad[k];
                        require_invalid(row, &p, param, (int)i, bad[k]);
                        *x = good;
                    }
                    continue;
                }
                for (int i = 0; i < param->count; i++) {
                    if (level) memset(&p, 0, sizeof p);
                    else random_parameters(&g, row, 1, &p);
                    *number_at(&p, param, i) = bad[k];
                    require_invalid(row, &p, param, i, bad[k]);
                }
            }
}

/* The specimen is valid, and rays down upon it meet it; of a sag, within its rim. */
static void test_specimens(void **state)
{
    (void)state;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        static double with[LARGEST / sizeof(double)];
        REQUIRE(row->specimen, "%s has no specimen", row->type);
        memcpy(with, row->specimen, row->size);
        if (row->object) REQUIRE(!row->object(with).reason, "%s: %s", row->type, row->object(with).reason);
        if (row->prepare) row->prepare(with);
        int met = 0;
        for (int i = 0; i < 100; i++) {
            sgt_ray ray = {.o = {0.4 * (i % 10) - 1.9, 0.4 * (i / 10) - 1.7, -9}, .d = {0, 0, 1}};
            met += sgt_intersect((sgt_surface){row->ops, with}, ray, NULL).status == SGT_HIT;
        }
        REQUIRE(met > (row->family == SGT_FAMILY_LEVEL_SET || row->family == SGT_FAMILY_BODY ? 10 : 99),
                "%s: %d of 100 rays meet the specimen", row->type, met);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows), cmocka_unit_test(test_zero),
                                       cmocka_unit_test(test_conformance), cmocka_unit_test(test_not_finite),
                                       cmocka_unit_test(test_specimens)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
