// SPDX-License-Identifier: MIT
/* Why a call is SGT_INVALID: each argument that makes no sense is named, and nothing else is
 * (sgt_explain_intersect, sgt_explain_leave, sgt_explain_trace, sgt_explain_aim).  What they say is held to
 * what the functions answer. */
#include "unit.h"

#include <sagitta/aim.h>
#include <sagitta/surfaces.h>

static const sgt_conic bowl = {.c = 0.1, .semi_diameter = 5};
static const sgt_ray along = {.o = {0, 0, -9}, .d = {0, 0, 1}};

static void require_key(bool sound, bool answered, const char *key, const sgt_error *e)
{
    REQUIRE(sound == answered, "%s: %s", key, sound ? "nothing is said" : e->key);
    if (!sound) REQUIRE(strcmp(e->key, key) == 0 && *e->words, "%s: %s, %s", key, e->key, e->words);
}

static void test_rays_and_options(void **state)
{
    (void)state;
    const double nan = (double)NAN;
    const struct { const char *key; sgt_ray ray; sgt_options opt; } row[] = {
        {.key = "", .ray = along},
        {.key = "ray.o", .ray = {.o = {nan, 0, 0}, .d = {0, 0, 1}}},
        {.key = "ray.d", .ray = {.d = {0, 0, HUGE_VAL}}},
        {.key = "ray.d", .ray = {.d = {0, 0, 0x1p-1074}}},
        {.key = "ray.tmin", .ray = {.d = {0, 0, 1}, .tmin = nan}},
        {.key = "ray.tmax", .ray = {.d = {0, 0, 1}, .tmax = nan}},
        {.key = "ray.tmax", .ray = {.d = {0, 0, 1}, .tmin = 1}},
        {.key = "ray.tmin", .ray = {.d = {0, 0, 1}, .tmin = HUGE_VAL, .tmax = HUGE_VAL}},
        {.key = "ray.tmax", .ray = {.d = {0, 0, 1}, .tmin = -HUGE_VAL, .tmax = -HUGE_VAL}},
        {"opt.t_tol", along, {.t_tol = -1}},
        {"opt.f_tol", along, {.f_tol = nan}},
        {"opt.dt_min", along, {.dt_min = -1}},
        {"opt.max_evals", along, {.max_evals = -1}},
        {"opt.proof", along, {.proof = (sgt_proof)7}},
        {"opt.reserved_[0]", along, {.reserved_ = {1}}},
        {"opt.reserved_[1]", along, {.reserved_ = {0, 1ULL << 63}}},
    };
    const sgt_surface s = {&sgt_conic_ops, &bowl};
    for (size_t i = 0; i < COUNT_OF(row); i++) {
        sgt_error e;
        require_key(sgt_explain_intersect(s, &row[i].ray, &row[i].opt, NULL, &e),
                    sgt_intersect(s, row[i].ray, &row[i].opt).status != SGT_INVALID, row[i].key, &e);
        assert_true(sgt_explain_intersect(s, &row[i].ray, &row[i].opt, NULL, NULL) == !*row[i].key);
    }
    const sgt_hits later = {.reserved_ = {0, 5}};
    sgt_error e;
    REQUIRE(!sgt_explain_intersect(s, &along, NULL, &later, &e) && !strcmp(e.key, "hits.reserved_[1]"), "%s",
            e.key);
    REQUIRE(strstr(e.words, sgt_version()), "which version runs: %s", e.words);
}

static void test_starts(void **state)
{
    (void)state;
    const double nan = (double)NAN;
    const sgt_vec3 up = {0, 0, 1};
    const struct { const char *key; sgt_start from; } row[] = {
        {"", {.d = up}},
        {"", {.d = up, .p_err = 1e-9, .tmax = -0.0}},
        {"from.p", {.p = {0, nan, 0}, .d = up}},
        {"from.p_err", {.d = up, .p_err = -1e-9}},
        {"from.p_err", {.d = up, .p_err = HUGE_VAL}},
        {"from.d", {.d = {0, 0, nan}}},
        {"from.d", {.d = {0, 0, 0}}},
        {"from.tmax", {.d = up, .tmax = -1}},
        {"from.tmax", {.d = up, .tmax = nan}},
        {"from.reserved_[1]", {.d = up, .reserved_ = {0, 1}}},
    };
    const sgt_surface s = {&sgt_conic_ops, &bowl};
    const sgt_options opt = {.t_tol = -1};
    const sgt_hits later = {.reserved_ = {1}};
    sgt_error e;
    for (size_t i = 0; i < COUNT_OF(row); i++)
        require_key(sgt_explain_leave(s, &row[i].from, NULL, NULL, &e),
                    sgt_leave(s, &row[i].from, NULL).hit.status != SGT_INVALID, row[i].key, &e);
    require_key(sgt_explain_leave(s, &row[0].from, &opt, NULL, &e), false, "opt.t_tol", &e);
    require_key(sgt_explain_leave(s, &row[0].from, NULL, &later, &e), false, "hits.reserved_[0]", &e);
}

/* Every parameter of every built-in type, made a NaN. */
static void test_surfaces(void **state)
{
    (void)state;
    const sgt_surface_ops empty = {.name = "nothing"}, little = {.size = 8, .value = sgt_conic_ops.value};
    sgt_error e;
    require_key(sgt_explain_intersect((sgt_surface){NULL, NULL}, &along, NULL, NULL, &e), false, "s.ops", &e);
    require_key(sgt_explain_intersect((sgt_surface){&empty, NULL}, &along, NULL, NULL, &e), false,
                "s.ops->value", &e);
    require_key(sgt_explain_intersect((sgt_surface){&little, &bowl}, &along, NULL, NULL, &e),
                sgt_intersect((sgt_surface){&little, &bowl}, along, NULL).status != SGT_INVALID,
                "s.ops->size", &e);
    int broken = 0;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        REQUIRE(sgt_explain_intersect((sgt_surface){row->ops, row->specimen}, &along, NULL, NULL, &e),
                "%s: %s", row->type, e.key);
        for (const sgt_param *p = row->params; p->name; p++) {
            if (p->kind != SGT_PARAM_REAL && p->kind != SGT_PARAM_VECTOR) continue;
            union { double number[64]; char byte[512]; } with;
            const double nan = (double)NAN;
            memcpy(with.byte, row->specimen, row->size);
            memcpy(with.byte + p->offset, &nan, sizeof nan);
            const sgt_surface s = {row->ops, &with};
            const bool answered = sgt_intersect(s, along, NULL).status != SGT_INVALID;
            REQUIRE(sgt_explain_intersect(s, &along, NULL, NULL, &e) == answered, "%s, %s", row->type,
                    p->name);
            REQUIRE(answered || !strncmp(e.key, "s.self.", 7), "%s, %s: %s", row->type, p->name, e.key);
            broken += !answered;
        }
    }
    REQUIRE(broken > 60, "%d parameters", broken);
}

static void test_lenses(void **state)
{
    (void)state;
    const sgt_surface s = {&sgt_conic_ops, &bowl};
    const sgt_phase phase = {.kind = SGT_IDEAL_LENS},
                    flat_phase = {.kind = SGT_IDEAL_LENS,
                                  .focal_length = HUGE_VAL,
                                  .focal_length_y = HUGE_VAL},
                    nan_phase = {.kind = SGT_IDEAL_LENS, .focal_length = 1, .focal_length_y = NAN},
                    later_phase = {.kind = SGT_IDEAL_LENS, .focal_length = 1, .reserved_ = {1}};
    const sgt_aperture_item item = {.shape = SGT_CIRCLE, .radius = -1};
    const sgt_aperture none = {.count = 1}, bad = {.count = 1, .items = &item}, later = {.reserved_ = {1}};
    const struct { const char *key; sgt_element e; double before;
    } row[] = {
        {"", {.surface = s, .index = 1.5}, 1},
        {"", {.surface = s, .index = SGT_MIRROR}, 0},
        {"index_before", {.surface = s}, -1},
        {"e[0].index", {.surface = s, .index = -2}, 1},
        {"e[0].semi_diameter", {.surface = s, .semi_diameter = -1}, 1},
        {"e[0].aperture", {.surface = s, .aperture = &none}, 1},
        {"e[0].aperture->items[0].shape", {.surface = s, .aperture = &bad}, 1},
        {"e[0].aperture.reserved_[0]", {.surface = s, .aperture = &later}, 1},
        {"e[0].phase.focal_length", {.surface = s, .phase = &phase}, 1},
        {"e[0].phase.focal_length_y", {.surface = s, .phase = &flat_phase}, 1},
        {"e[0].phase.focal_length_y", {.surface = s, .phase = &nan_phase}, 1},
        {"e[0].phase.reserved_[0]", {.surface = s, .phase = &later_phase}, 1},
        {"e[0].element.reserved_[5]", {.surface = s, .reserved_ = {0, 0, 0, 0, 0, 1}}, 1},
        {"e[0].s.ops", {.index = 1.5}, 1},
    };
    for (size_t i = 0; i < COUNT_OF(row); i++) {
        sgt_error e;
        sgt_passage passage;
        sgt_fate fate;
        sgt_ray ray = along;
        sgt_trace(1, &row[i].e, row[i].before, &ray, &passage, &fate, NULL);
        require_key(sgt_explain_trace(1, &row[i].e, row[i].before, &along, NULL, NULL, NULL, &e),
                    !(fate == SGT_LOST && passage.hit.status == SGT_INVALID), row[i].key, &e);
    }
}

static void test_aims(void **state)
{
    (void)state;
    const double nan = (double)NAN;
    const sgt_element e[] = {{.surface = {&sgt_conic_ops, &bowl}, .index = 1.5}};
    const sgt_beam beam = {
        .o = {0, 0, -9}, .ou = {1, 0, 0}, .ov = {0, 1, 0}, .d = {0, 0, 1}, .u = {-1, 1}, .v = {-1, 1}};
    const sgt_vec2 no[] = {{nan, 0}};
    sgt_beam b[6] = {beam, beam, beam, beam, beam, beam};
    b[1].ou.y = nan, b[2].u.lo = 2, b[3].v.hi = HUGE_VAL, b[4].d.z = 0, b[5].reserved_[1] = 1;
    const struct { const char *key; const sgt_beam *beam; double wanted; sgt_aim_options opt; } row[] = {
        {.key = "", .beam = &b[0], .wanted = 0},
        {.key = "beam.ou", .beam = &b[1], .wanted = 0},
        {.key = "beam.u", .beam = &b[2], .wanted = 0},
        {.key = "beam.v", .beam = &b[3], .wanted = 0},
        {.key = "beam.d", .beam = &b[4], .wanted = 0},
        {.key = "beam.reserved_[1]", .beam = &b[5], .wanted = 0},
        {.key = "wanted", .beam = &b[0], .wanted = nan},
        {.key = "opt.tol", .beam = &b[0], .wanted = 0, .opt = {.tol = -1}},
        {.key = "opt.max_traces", .beam = &b[0], .wanted = 0, .opt = {.max_traces = -1}},
        {.key = "opt.start", .beam = &b[0], .wanted = 0, .opt = {.tol = 0, .starts = 1, .start = no}},
        {.key = "opt.reserved_[3]", .beam = &b[0], .opt = {.reserved_ = {0, 0, 0, 1}}},
    };
    for (size_t i = 0; i < COUNT_OF(row); i++) {
        sgt_error error;
        sgt_passage passage;
        const sgt_vec2 wanted = {row[i].wanted, 0.5};
        const bool answered =
            sgt_aim(0, e, 1, row[i].beam, wanted, &passage, &row[i].opt, NULL) != SGT_AIMED_INVALID;
        require_key(sgt_explain_aim(0, e, 1, row[i].beam, wanted, &row[i].opt, &error), answered, row[i].key,
                    &error);
    }
}

/* Ends as they stand: 0 to 0 is given by sgt_ray_between and in batches, and is the default in a struct. */
static void test_ends_as_they_stand(void **state)
{
    (void)state;
    const sgt_surface s = {&sgt_conic_ops, &bowl};
    const double o[3] = {0, 0, -9}, d[3] = {0, 0, 1}, zero = 0, minus = -1, ten = 10, far = HUGE_VAL;
    const struct { const double *lo, *hi; sgt_status status; } row[] = {
        {NULL, NULL, SGT_HIT},  {&zero, NULL, SGT_HIT}, {NULL, &zero, SGT_MISS}, {&zero, &zero, SGT_MISS},
        {&minus, &zero, SGT_MISS}, {NULL, &ten, SGT_HIT}, {&zero, &far, SGT_HIT}, {&ten, &zero, SGT_INVALID},
    };
    for (size_t i = 0; i < COUNT_OF(row); i++) {
        sgt_status status;
        const sgt_rays rays = {{&o[0], &o[1], &o[2]}, {&d[0], &d[1], &d[2]}, row[i].lo, row[i].hi};
        sgt_intersect_batch(s, 1, rays, (sgt_hits){.status = &status}, NULL);
        const sgt_ray ray = sgt_ray_between((sgt_vec3){o[0], o[1], o[2]}, (sgt_vec3){d[0], d[1], d[2]},
                                            row[i].lo ? *row[i].lo : 0, row[i].hi ? *row[i].hi : HUGE_VAL);
        const sgt_status alone = sgt_intersect(s, ray, NULL).status;
        REQUIRE(status == row[i].status && alone == status, "row %zu: %s, in a batch %s", i,
                sgt_status_text(alone), sgt_status_text(status));
        sgt_hit hit[2];
        const int all = sgt_intersect_all(s, ray, 2, hit, NULL);
        REQUIRE(alone == SGT_INVALID ? all == SGT_INVALID : (all > 0) == (alone == SGT_HIT),
                "row %zu: all %d", i, all);
    }
    assert_int_equal(sgt_intersect(s, along, NULL).status, SGT_HIT); /* {0} is the half-line */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays_and_options), cmocka_unit_test(test_starts),
        cmocka_unit_test(test_surfaces),
        cmocka_unit_test(test_lenses),
        cmocka_unit_test(test_aims),
        cmocka_unit_test(test_ends_as_they_stand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
