// SPDX-License-Identifier: MIT
/* lens.h - what the fuzz targets share that read lenses: memory that is counted, and what a lens that was
 * accepted is. */
#ifndef TESTS_FUZZ_LENS_H
#define TESTS_FUZZ_LENS_H
#include "fuzz.h"

#include <sagitta/formula.h>
#include <sagitta/lens.h>

static long blocks_held;

static void *counted_resize(void *context, void *block, size_t size)
{
    (void)context;
    blocks_held += (size != 0) - (block != NULL);
    if (size) return realloc(block, size);
    free(block);
    return NULL;
}

static const sgt_allocator counted = {counted_resize, NULL};

/* It is met or not, and no fault of the call. */
static void require_met(sgt_surface s, const char *type, double size)
{
    sgt_hit hit = sgt_intersect(s, (sgt_ray){{0, size, -1}, {0, 0.1, 1}, 0, 0},
                                &(sgt_options){.max_evals = 50});
    REQUIRE(hit.status != SGT_INVALID, "%s", type);
}

static void require_surface(sgt_surface s, const char *type, double size)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->type && strcmp(b->type, type) != 0) b++;
    if (strcmp(type, "formula") == 0) {
        REQUIRE(s.ops == &sgt_formula_ops || s.ops == &sgt_formula_sag_ops, "%s", type);
        require_met(s, type, size);
        return;
    }
    REQUIRE(b->type && b->ops == s.ops, "%s", type);
    for (const sgt_param *p = b->params; p->name; p++) {
        const void *at = (const char *)s.self + p->offset;
        const sgt_numbers *table = at;
        const double *x = at;
        size_t count = (size_t)p->count;
        double whole;
        if (p->kind == SGT_PARAM_TERMS) {
            size_t terms;
            memcpy(&terms, (const char *)at + sizeof(sgt_surface *), sizeof terms);
            REQUIRE(terms <= count, "%s: %zu terms", type, terms);
            continue;
        }
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            REQUIRE((table->rows <= count || p->kind == SGT_PARAM_LIST) && table->columns <= count &&
                        (!table->rows || table->x),
                    "%s: %s: %zu rows, %zu columns", type, p->name, table->rows, table->columns);
            x = table->x, count = table->rows * table->columns;
        } else if (p->kind != SGT_PARAM_REAL && p->kind != SGT_PARAM_VECTOR) {
            whole = *(const int *)at, x = &whole;
        }
        for (size_t i = 0; i < count; i++)
            REQUIRE(isfinite(x[i]) && (x[i] == 0 || (x[i] >= p->lo && x[i] <= p->hi)), "%s: %s[%zu] = %a",
                    type, p->name, i, x[i]);
    }
    if (b->object)
        REQUIRE(!b->object(s.self).reason, "%s: %s: %s", type, b->object(s.self).param,
                b->object(s.self).reason);
    require_met(s, type, size);
}

/* NULL, or what an element may have beside an ideal lens. */
static void require_phase(const sgt_phase *p)
{
    if (!p || p->kind == SGT_IDEAL_LENS) return;
    REQUIRE(p->kind == SGT_PHASE_SAG || p->kind == SGT_PHASE_FUNCTION || p->kind == SGT_FACETS, "%d",
            (int)p->kind);
    REQUIRE(p->waves.ops && p->waves.self && isfinite(p->per_wave), "%a", p->per_wave);
}

static void require_lens(const sgt_lens *l)
{
    REQUIRE(l->name && l->units && l->wavelengths >= 1 && l->count >= 1 && l->fields >= 1, "%zu surfaces",
            l->count);
    REQUIRE(l->primary < l->wavelengths, "primary %zu", l->primary);
    for (size_t i = 0; i < l->wavelengths; i++) {
        REQUIRE(!l->wavelength || (l->wavelength[i] > 0 && isfinite(l->wavelength[i])), "%a",
                l->wavelength[i]);
        REQUIRE(l->wavelength_weight[i] >= 0, "%a", l->wavelength_weight[i]);
    }
    REQUIRE(l->object_distance >= 0 && !(l->index_before <= 0) && !isinf(l->index_before), "%a %a",
            l->object_distance, l->index_before);
    REQUIRE(isfinite(l->object_slope.x) && isfinite(l->object_slope.y), "%a %a", l->object_slope.x,
            l->object_slope.y);
    REQUIRE(isnan(l->pupil_size) || (l->pupil_size > 0 && isfinite(l->pupil_size)), "%a", l->pupil_size);
    REQUIRE(!isinf(l->pupil_distance), "%a", l->pupil_distance);
    for (size_t i = 0; i < l->fields; i++)
        REQUIRE(isfinite(l->field[i].x) && isfinite(l->field[i].y) &&
                    (l->field_kind != SGT_FIELD_ANGLE || fabs(l->field[i].y) < 90),
                "%a", l->field[i].y);
    REQUIRE(l->stop < l->count, "stop %zu", l->stop);
    for (size_t i = 0; i < l->count; i++) {
        const sgt_element *e = &l->element[i];
        const sgt_lens_surface *s = &l->surface[i];
        const sgt_pose *p = &e->pose;
        const double place[] = {p->origin.x, p->origin.y, p->origin.z, p->ex.x,         p->ex.y,
                                p->ex.z,     p->ey.x,     p->ey.y,     p->ey.z,         p->ez.x,
                                p->ez.y,     p->ez.z,     s->z,        e->semi_diameter};
        for (size_t j = 0; j < COUNT_OF(place); j++)
            REQUIRE(isfinite(place[j]), "element %zu: %zu: %a", i, j, place[j]);
        double turn = p->ex.x * p->ex.x + p->ex.y * p->ex.y + p->ex.z * p->ex.z;
        REQUIRE(turn == 0 || fabs(turn - 1) < 1e-14, "element %zu: an axis of length^2 %a", i, turn);
        REQUIRE(e->semi_diameter >= 0 && s->size >= 0, "element %zu: %a", i, e->semi_diameter);
        REQUIRE(s->mirror ? e->index == SGT_MIRROR : !(e->index <= 0), "element %zu: index %a", i, e->index);
        bool ideal = strcmp(s->type, "ideal") == 0;
        require_surface(e->surface, ideal ? "plane" : s->type, e->semi_diameter);
        REQUIRE(ideal == (e->phase && e->phase->kind == SGT_IDEAL_LENS) &&
                    s->focal_length == (!ideal                          ? 0
                                        : e->phase->focal_length_y == 0 ? e->phase->focal_length
                                                                        : e->phase->focal_length_y),
                "element %zu: %a", i, s->focal_length);
        require_phase(e->phase);
    }
    sgt_ray ray = {.d = {0, 0.01, 1}};
    sgt_passage met[4];
    size_t n = 0;
    while (n < 4 && n < l->count) n++;
    size_t passed = sgt_trace(n, l->element, l->index_before, &ray, met, NULL,
                              &(sgt_options){.max_evals = 50});
    for (size_t i = 0; i < n && i <= passed && !isnan(l->index_before); i++)
        REQUIRE(met[i].hit.status != SGT_INVALID || i > 0 || isnan(l->element[0].index), "element %zu", i);
}

/* The YAML of a lens, read under a name, is the same lens. */
static void require_again(sgt_lens *l, const char *name, const sgt_lens_options *options)
{
    size_t length;
    sgt_error e = {0};
    const char *text = sgt_lens_yaml(l, &length);
    REQUIRE(text, "%zu surfaces", l->count);
    sgt_lens *same_lens = sgt_lens_read_text(name, text, length, options, &e);
    REQUIRE(same_lens, "line %zu: %s: %s\n%s", e.line, e.key, e.words, text);
    REQUIRE(strcmp(same_lens->name, l->name) == 0 && strcmp(same_lens->units, l->units) == 0, "%s", text);
    REQUIRE(same_lens->count == l->count && same_lens->fields == l->fields && same_lens->stop == l->stop,
            "%s", text);
    for (size_t i = 0; i < l->count; i++) {
        const sgt_element *a = &l->element[i], *b = &same_lens->element[i];
        REQUIRE(same(a->index, b->index) && same(a->semi_diameter, b->semi_diameter) &&
                    memcmp(&a->pose, &b->pose, sizeof a->pose) == 0 && a->surface.ops == b->surface.ops &&
                    strcmp(l->surface[i].name, same_lens->surface[i].name) == 0,
                "element %zu\n%s", i, text);
        const sgt_phase *p = a->phase, *q = b->phase;
        REQUIRE((p != NULL) == (q != NULL) && (!p || (p->kind == q->kind && same(p->per_wave, q->per_wave))),
                "element %zu\n%s", i, text);
        if (!p || p->kind == SGT_IDEAL_LENS) continue;
        const sgt_vec3 at = {0.3, -0.7, 0.1};
        REQUIRE(
            same(p->waves.ops->value(p->waves.self, at, NULL), q->waves.ops->value(q->waves.self, at, NULL)),
            "element %zu\n%s", i, text);
    }
    sgt_lens_free(same_lens);
}

#endif
