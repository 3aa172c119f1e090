// SPDX-License-Identifier: MIT
/* same.h - are two lenses the same in every bit that a ray or an analysis can see?  Lines of the file, by
 * which messages say where something stands, are not compared. */
#ifndef TESTS_LENS_SAME_H
#define TESTS_LENS_SAME_H
#include <sagitta/edit.h>

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* The same bits; of NaN, any. */
static bool alike(double a, double b) { return memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

static bool same_numbers(size_t count, const double a[], const double b[])
{
    bool same = true;
    for (size_t i = 0; same && i < count; i++) same = alike(a[i], b[i]);
    return same;
}

static bool same_words(const char *a, const char *b) { return a && b ? strcmp(a, b) == 0 : a == b; }

static bool same_surface(sgt_surface a, sgt_surface b, const char *type)
{
    const sgt_builtin *row = sgt_builtins();
    while (row->type && row->ops != a.ops) row++;
    if (a.ops != b.ops) return false;
    if (!row->type) return strcmp(type, "formula") == 0; /* compared by its text */
    bool same = true;
    for (const sgt_param *p = row->params; same && p->name; p++) {
        const char *x = (const char *)a.self + p->offset, *y = (const char *)b.self + p->offset;
        if (p->kind == SGT_PARAM_TERMS) {
            struct {
                const sgt_surface *of;
                size_t count;
            } s, t;
            memcpy(&s, x, sizeof s), memcpy(&t, y, sizeof t);
            same = s.count == t.count;
            for (size_t i = 0; same && i < s.count; i++) same = same_surface(s.of[i], t.of[i], "");
        } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            sgt_numbers s, t;
            memcpy(&s, x, sizeof s), memcpy(&t, y, sizeof t);
            same = s.rows == t.rows && s.columns == t.columns && same_numbers(s.rows * s.columns, s.x, t.x);
        } else if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR) {
            double s[8], t[8];
            const size_t count = p->count < 8 ? (size_t)p->count : 8;
            memcpy(s, x, count * sizeof *s), memcpy(t, y, count * sizeof *t);
            same = same_numbers(count, s, t);
        } else {
            same = memcmp(x, y, sizeof(int)) == 0;
        }
    }
    return same;
}

static bool same_aperture(const sgt_aperture *a, const sgt_aperture *b)
{
    if (!a || !b) return a == b;
    bool same = a->count == b->count;
    for (size_t i = 0; same && i < a->count; i++) {
        const sgt_aperture_item *p = &a->items[i], *q = &b->items[i];
        const double x[] = {p->centre.x, p->centre.y, p->degrees, p->radius, p->inner,
                            p->half.x,   p->half.y,   p->width,   p->length},
                     y[] = {q->centre.x, q->centre.y, q->degrees, q->radius, q->inner,
                            q->half.x,   q->half.y,   q->width,   q->length};
        same = p->shape == q->shape && p->obscuring == q->obscuring && p->count == q->count &&
               p->arms == q->arms && same_numbers(9, x, y);
        for (size_t k = 0; same && p->vertices && k < p->count; k++)
            same = alike(p->vertices[k].x, q->vertices[k].x) && alike(p->vertices[k].y, q->vertices[k].y);
    }
    return same;
}

/* The same phase, in waves by what it is at some points. */
static bool same_phase(const sgt_phase *a, const sgt_phase *b)
{
    if (!a || !b) return a == b;
    bool same = a->kind == b->kind && alike(a->focal_length, b->focal_length) &&
                alike(a->focal_length_y, b->focal_length_y) &&
                alike(a->object_distance, b->object_distance) && alike(a->per_wave, b->per_wave) &&
                a->waves.ops == b->waves.ops;
    for (int i = 0; same && a->waves.ops && i < 9; i++) {
        const sgt_vec3 p = {0.7 * (i % 3), 1.3 * (i / 3) - 0.4, 0.1 * i};
        sgt_vec3 g = {0, 0, 0}, h = {0, 0, 0};
        same = alike(a->waves.ops->value(a->waves.self, p, &g), b->waves.ops->value(b->waves.self, p, &h)) &&
               same_numbers(3, &g.x, &h.x);
    }
    return same;
}

static bool same_element(const sgt_lens *a, const sgt_lens *b, size_t i)
{
    const sgt_element *e = &a->element[i], *f = &b->element[i];
    const sgt_lens_surface *s = &a->surface[i], *t = &b->surface[i];
    const char *text = "", *other = "";
    const sgt_named *named = NULL, *others = NULL;
    size_t n = 0, m = 0;
    bool formula = sgt_lens_formula(a, i + 1, &text, &named, &n);
    bool same =
        formula == sgt_lens_formula(b, i + 1, &other, &others, &m) && strcmp(text, other) == 0 && n == m;
    for (size_t k = 0; same && k < n; k++)
        same = strcmp(named[k].name, others[k].name) == 0 && alike(named[k].value, others[k].value);
    return same && same_words(s->type, t->type) && same_words(s->name, t->name) && alike(s->z, t->z) &&
           s->mirror == t->mirror && s->off_axis == t->off_axis && s->folded == t->folded &&
           alike(s->size, t->size) && alike(s->focal_length, t->focal_length) && alike(e->index, f->index) &&
           alike(e->semi_diameter, f->semi_diameter) &&
           same_numbers(12, &e->pose.origin.x, &f->pose.origin.x) &&
           same_aperture(e->aperture, f->aperture) && same_phase(e->phase, f->phase) &&
           same_surface(e->surface, f->surface, s->type);
}

/* NULL: they are; else what differs. */
static const char *difference(const sgt_lens *a, const sgt_lens *b)
{
    if (!same_words(a->name, b->name) || !same_words(a->units, b->units)) return "name or units";
    if (a->wavelengths != b->wavelengths || !a->wavelength != !b->wavelength || a->primary != b->primary ||
        (a->wavelength && !same_numbers(a->wavelengths, a->wavelength, b->wavelength)) ||
        !same_numbers(a->wavelengths, a->wavelength_weight, b->wavelength_weight))
        return "wavelengths";
    if (!alike(a->object_distance, b->object_distance) || a->telecentric != b->telecentric ||
        a->afocal != b->afocal || !alike(a->index_before, b->index_before))
        return "object";
    if (a->pupil != b->pupil || !alike(a->pupil_size, b->pupil_size) || a->aim != b->aim ||
        !alike(a->pupil_distance, b->pupil_distance) || a->stop != b->stop ||
        a->stop_marked != b->stop_marked)
        return "pupil";
    if (a->field_kind != b->field_kind || a->fields != b->fields) return "fields";
    for (size_t i = 0; i < a->fields; i++) {
        const sgt_lens_field *f = &a->field[i], *g = &b->field[i];
        const double x[] = {f->x, f->y, f->weight, f->dx, f->dy, f->cx, f->cy, f->angle},
                     y[] = {g->x, g->y, g->weight, g->dx, g->dy, g->cx, g->cy, g->angle};
        if (!same_numbers(8, x, y)) return "fields";
    }
    if (a->count != b->count) return "count";
    for (size_t i = 0; i < a->count; i++)
        if (!same_element(a, b, i)) {
            static char which[60];
            snprintf(which, sizeof which, "surface %zu", i + 1);
            return which;
        }
    for (size_t k = 0; a->wavelength && k < a->wavelengths; k++)
        for (size_t i = 0; i <= a->count; i++) {
            sgt_glass g, h;
            const bool glass = sgt_lens_glass(a, i, &g, NULL);
            if (glass != sgt_lens_glass(b, i, &h, NULL)) return "a glass";
            if (glass &&
                (!same_words(g.name, h.name) || !same_words(g.maker, h.maker) ||
                 !alike(sgt_glass_index(&g, a->wavelength[k]), sgt_glass_index(&h, a->wavelength[k]))))
                return "a glass";
        }
    return NULL;
}

#endif
