// SPDX-License-Identifier: MIT
/* look.c - a lens as a row of numbers: all that its rays hang on.
 *
 * A ray's end is a function of the numbers of a trace (sgt_trace_parameters) and of the launch ray.  The
 * launch ray is one of the beam of its field, whose numbers follow from the lens, and of the size of the
 * stop.  A figure besides asks for focal length, exit pupil and ideal image.  No other number has a say.  So
 * if all are listed, a lens with other numbers in its file, of the same kind, is known by its row.
 *
 * THE PARAMETERS OF A SURFACE stand in its struct in the order of sgt_trace_parameters: those are the numbers
 * that the rows of its type have, without its rim, its normalisations and steps.  Where that gives another
 * count than the surface says, it is not one that we know.  Then nothing of it may move: what it is at some
 * points of space stands for it, and is one of the fixed numbers.  The waves of a phase are a
 * surface, too. */
#include "figure.h"

#include "../read/lens.h"

#include <stddef.h>
#include <string.h>

bool sgt_look_begin(look_of_lens *l, const sgt_lens *lens, const looking *how, bool points, sgt_error *error)
{
    static const sgt_sink nowhere;
    *l = (look_of_lens){.study = sgt_study_new(lens, how->options, error)};
    if (!l->study) return false;
    l->study->from->any_front = !points;
    l->ask = (sgt_asking){.study = l->study,
                          .lens = lens,
                          .from = l->study->from,
                          .of = how->of,
                          .sink = &nowhere,
                          .error = error,
                          .memory = {.allocator = l->study->from->allocator}};
    return sgt_ask_begin(&l->ask) && (!points || sgt_ask_pupil(&l->ask));
}

void sgt_look_end(look_of_lens *l)
{
    if (l->study) sgt_arena_free(&l->ask.memory);
    sgt_study_free(l->study);
    *l = (look_of_lens){.study = NULL};
}

/* ------------------------------------------------------------------------ the list */

/* number NULL: they are counted. */
typedef struct list {
    double *number;
    size_t count, room;
} list;

static void add_number(list *to, double x)
{
    if (to->number && to->count < to->room) to->number[to->count] = x;
    to->count++;
}

static void put_vector(list *to, sgt_vec3 v)
{
    add_number(to, v.x), add_number(to, v.y), add_number(to, v.z);
}

enum { PLACES = 32 }; /* of a surface, at most */

static size_t bytes_of(const sgt_param *p)
{
    switch (p->kind) {
    case SGT_PARAM_WHOLE:
    case SGT_PARAM_WORD:
    case SGT_PARAM_TRUTH:
        return sizeof(int);
    case SGT_PARAM_LIST:
    case SGT_PARAM_TABLE:
        return sizeof(sgt_numbers);
    case SGT_PARAM_TERMS:
        return sizeof(sgt_surface *);
    case SGT_PARAM_REAL:
    case SGT_PARAM_VECTOR:
        break;
    }
    return (size_t)p->count * sizeof(double);
}

/* Those of all rows with these operations, in the order of the struct, each once. */
static size_t places_of(sgt_surface s, place out[PLACES])
{
    size_t count = 0;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        for (const sgt_param *p = b->params; b->ops == s.ops && p->name; p++) {
            place one = {p->offset, p->offset + bytes_of(p), p};
            size_t i = 0, same = 0;
            for (; i < count && !same; i++) same = one.at >= out[i].at && one.end <= out[i].end;
            if (same || count == PLACES) continue;
            for (i = count; i > 0 && out[i - 1].at > one.at; i--) out[i] = out[i - 1];
            out[i] = one, count++;
        }
    return count;
}

static bool starts(const char *name, const char *with) { return strncmp(name, with, strlen(with)) == 0; }

static bool is_parameter(const sgt_param *p, bool term)
{
    return !starts(p->name, "semi_diameter") && !starts(p->name, "norm") && !starts(p->name, "step") &&
           strcmp(p->name, "sag") != 0 &&
           !(term && (strcmp(p->name, "curvature") == 0 || strcmp(p->name, "conic") == 0));
}

/* Parameters, or (fixed) what is none but may shape it.  known: the places of the surface; NULL: it is a
 * term. */
static void put_surface(list *to, sgt_surface s, const places_in_struct *known, bool fixed)
{
    place own[PLACES];
    const bool term = !known;
    const size_t count = term ? places_of(s, own) : known->count;
    const place *at = term ? own : known->at;
    for (size_t i = 0; i < count; i++) {
        const sgt_param *p = at[i].of;
        const char *self = (const char *)s.self + p->offset;
        if (p->kind == SGT_PARAM_TERMS) {
            const sgt_surface *of;
            size_t terms;
            memcpy(&of, self, sizeof of), memcpy(&terms, self + sizeof of, sizeof terms);
            for (size_t k = 0; k < terms; k++) put_surface(to, of[k], NULL, fixed);
            continue;
        }
        if (is_parameter(p, term) == fixed || starts(p->name, "semi_diameter")) continue;
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            sgt_numbers n;
            memcpy(&n, self, sizeof n);
            for (size_t k = 0; k < n.rows * n.columns; k++) add_number(to, n.x[k]);
        } else if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR) {
            const double *x = (const void *)self;
            for (int k = 0; k < p->count; k++) add_number(to, x[k]);
        }
    }
}

/* The parameters of a surface.  false: they are not known. */
static bool put_parameters(list *to, const sgt_lens *lens, const places_in_struct *known, sgt_surface s)
{
    const size_t before = to->count, many = sgt_parameters(s);
    const formula_text *formula = sgt_formula_of(lens, s);
    if (formula) {
        for (; to->count < before + many - formula->count;)
            add_number(to, 0); /* of a sag: its base, which has no numbers */
        for (size_t k = 0; k < formula->count; k++) add_number(to, formula->parameter[k].value);
        return true;
    }
    put_surface(to, s, known, false);
    if (to->count == before + many) return true;
    to->count = before;
    for (size_t k = 0; k < many; k++) add_number(to, 0);
    return false;
}

static void put_trace(list *to, const sgt_lens *lens, const layout *in, const band *b)
{
    const sgt_element *e = b->element;
    for (int k = 0; k < 6; k++) add_number(to, 0);
    add_number(to, b->before == 0 ? 1 : b->before);
    for (size_t i = 0; i < lens->count; i++) {
        put_parameters(to, lens, &in->of[i], e[i].surface);
        put_vector(to, e[i].pose.origin);
        for (int k = 0; k < 3; k++) add_number(to, 0);
        add_number(to, e[i].index);
    }
}

/* In the order of sgt_phase_parameters. */
static void put_phases(list *to, const sgt_lens *lens, const layout *in, const sgt_element e[])
{
    for (size_t i = 0; i < lens->count; i++) {
        const sgt_phase *p = e[i].phase;
        if (p && p->kind == SGT_IDEAL_LENS) {
            const double length[] = {p->focal_length, p->focal_length_y, p->object_distance};
            for (int k = 0; k < 3; k++) add_number(to, isfinite(length[k]) ? length[k] : 0);
        } else if (p) {
            add_number(to, p->per_wave);
            put_parameters(to, lens, &in->of[lens->count + i], p->waves);
        }
    }
}

/* Of a surface: what must not move. */
static void put_fixed(list *to, const sgt_lens *lens, const places_in_struct *known, sgt_surface s)
{
    const double away[][3] = {{0.11, 0.07, 0.05}, {-1.3, 0.8, 0.3}, {4.1, 5.3, -0.7}, {-9.7, 2.9, 1.1}};
    list none = {.count = 0};
    if (put_parameters(&none, lens, known, s)) {
        put_surface(to, s, known, true);
        return;
    }
    for (size_t k = 0; k < sizeof away / sizeof *away; k++) {
        const sgt_vec3 p = {away[k][0], away[k][1], away[k][2]};
        const double f = s.ops->value(s.self, p, NULL);
        add_number(to, isfinite(f) ? f : 0);
    }
}

static bool has_waves(const sgt_element *e) { return e->phase && e->phase->kind != SGT_IDEAL_LENS; }

static void put_beam(list *to, const sgt_field_beam *b)
{
    put_vector(to, b->object), put_vector(to, b->direction);
    add_number(to, b->pupil), add_number(to, b->radius), add_number(to, b->cone), add_number(to, b->wave);
    add_number(to, b->shift.x), add_number(to, b->shift.y), add_number(to, b->scale.x),
        add_number(to, b->scale.y);
    add_number(to, b->turn.x), add_number(to, b->turn.y);
}

/* As ideal_of of ../study/curves.c, by the tangent. */
static double ideal_height(const sgt_field_beam *b, const band *at)
{
    const double before = at->before == 0 ? 1 : at->before;
    if (b->finite) return at->data.magnification * hypot(b->object.x, b->object.y);
    return at->data.efl * before * hypot(b->direction.x / b->direction.z, b->direction.y / b->direction.z);
}

static void put_all(list *to, const look_of_lens *l, layout *out)
{
    const sgt_asking *a = &l->ask;
    const sgt_lens *lens = a->lens;
    *out = (layout){.slots = a->bands + 1, .of = out->of};
    for (size_t s = 0; s < out->slots; s++) put_trace(to, lens, out, sgt_look_slot(l, s));
    out->trace = to->count / out->slots, out->phase = to->count;
    for (size_t s = 0; s < out->slots; s++) put_phases(to, lens, out, sgt_look_slot(l, s)->element);
    out->phases = (to->count - out->phase) / out->slots, out->axes = to->count;
    for (size_t i = 0; i < lens->count; i++) {
        const sgt_pose *p = &lens->element[i].pose;
        const bool straight = dot3(p->ex, p->ex) == 0;
        put_vector(to, straight ? (sgt_vec3){1, 0, 0} : p->ex);
        put_vector(to, straight ? (sgt_vec3){0, 1, 0} : p->ey);
        put_vector(to, straight ? (sgt_vec3){0, 0, 1} : p->ez);
    }
    out->beams = to->count;
    for (size_t f = 0; f < a->fields; f++) put_beam(to, &a->beam[f]);
    out->stop = to->count;
    add_number(to, a->from->aim == SGT_LENS_AIM_PUPIL ? 0 : a->from->stop_radius);
    out->first = to->count;
    for (size_t s = 0; s < out->slots; s++) {
        const sgt_first_order *o = &sgt_look_slot(l, s)->data;
        add_number(to, o->efl), add_number(to, o->exit_pupil), add_number(to, 1 / o->exit_pupil);
    }
    out->ideal = to->count;
    for (size_t f = 0; f < a->fields; f++)
        for (size_t s = 0; s < out->slots; s++)
            add_number(to, ideal_height(&a->beam[f], sgt_look_slot(l, s)));
    out->fixed = to->count;
    for (size_t i = 0; i < lens->count; i++) {
        const sgt_element *e = &lens->element[i];
        put_fixed(to, lens, &out->of[i], e->surface);
        if (has_waves(e)) put_fixed(to, lens, &out->of[lens->count + i], e->phase->waves);
    }
    out->weights = to->count;
    for (size_t b = 0; b < a->bands; b++) add_number(to, sgt_look_slot(l, b)->weight);
    for (size_t f = 0; f < a->fields; f++) add_number(to, a->at[f].weight);
    for (size_t s = 0; s < out->slots; s++) add_number(to, sgt_look_slot(l, s)->at.um);
    out->end = to->count;
}

/* The first list says how many there are, and where. */
static bool begin_list(look_of_lens *l, layout *out)
{
    const sgt_lens *lens = l->ask.lens;
    list to = {.count = 0};
    places_in_struct *of = sgt_ask_room(&l->ask, 2 * lens->count, sizeof *of);
    place *at = sgt_ask_room(&l->ask, 2 * lens->count * PLACES, sizeof *at);
    if (!of || !at) return false;
    for (size_t i = 0; i < lens->count; i++, at += 2 * PLACES) {
        const sgt_element *e = &lens->element[i];
        place *wave = at + PLACES;
        of[i] = (places_in_struct){.count = places_of(e->surface, at), .at = at};
        of[lens->count + i] =
            (places_in_struct){.count = has_waves(e) ? places_of(e->phase->waves, wave) : 0, .at = wave};
    }
    *out = (layout){.of = of};
    put_all(&to, l, out);
    return true;
}

/* (Types of surfaces are words of the file, which no number changes: places are those of the first list.) */
bool sgt_look_list(look_of_lens *l, layout *out, bool first)
{
    if (first && !begin_list(l, out)) return false;
    layout own = {.of = out->of};
    l->number = sgt_ask_room(&l->ask, out->end, sizeof *l->number);
    if (!l->number) return false;
    list to = {.number = l->number, .room = out->end};
    put_all(&to, l, &own);
    return memcmp(&own, out, offsetof(layout, of)) == 0;
}
