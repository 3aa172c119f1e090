// SPDX-License-Identifier: MIT
/* figure.c - figures of a lens, residuals and derivatives: how one begins, is evaluated, and ends. */
#include "asked.h"

#include <stdio.h>
#include <string.h>

static bool fail(sgt_error *error, const char *key, const char *words)
{
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    snprintf(error->key, sizeof error->key, "%s", key);
    snprintf(error->words, sizeof error->words, "%s", words);
    return false;
}

/* How many there are, of a lens as it is looked at. */
static sgt_figure_count figure_count(const sgt_figure *f, const look_of_lens *l)
{
    const sgt_asking *a = &l->ask;
    const size_t cells = a->fields * a->bands;
    sgt_figure_count c = {.paths = f->by.count, .residuals = cells, .values = cells};
    switch (f->opt.kind) {
    case SGT_FIGURE_SPOT:
        c.residuals = 2 * cells * a->fine.count, c.values = a->fields + 1;
        break;
    case SGT_FIGURE_OPD:
        c.residuals = cells * a->fine.count, c.values = cells + 1;
        break;
    case SGT_FIGURE_CHIEF:
        c.residuals = c.values = 2 * cells;
        break;
    case SGT_FIGURE_EFL:
        c.residuals = c.values = a->bands;
        break;
    case SGT_FIGURE_DISTORTION:
        break;
    }
    return c;
}

static bool find_motions(asked *a)
{
    const sgt_figure *f = a->of;
    double *has = sgt_asked_room(a, a->paths);
    sgt_lens *copy = a->paths && has ? sgt_lens_copy(f->lens, a->error) : NULL;
    bool fine = copy || !a->paths;
    const moved_lens moved = {&f->by, copy, has, f->x, &f->how, &a->in, &a->at};
    if (copy) memcpy(has, f->x, a->paths * sizeof *has);
    for (size_t m = 0; m < a->paths && fine; m++) {
        motion *to = &a->motion[m];
        to->by = sgt_asked_room(a, a->in.end), to->error = sgt_asked_room(a, a->in.end);
        if (sgt_asked_failed(a)) break;
        fine = sgt_motion_of(&moved, m, to, a->error);
        if (fine || !f->none || strcmp(a->error->words, "no memory") == 0) continue;
        f->none[m] = fine = true, to->beams = false; /* it moves nothing */
        memset(to->by, 0, a->in.end * sizeof *to->by), memset(to->error, 0, a->in.end * sizeof *to->error);
    }
    sgt_lens_free(copy);
    return fine && !sgt_asked_failed(a);
}

static bool prepare(asked *a)
{
    const sgt_figure_out *out = a->out;
    sgt_figure *f = a->of;
    const bool slopes = out->jacobian || out->gradient || out->gradient_err;
    a->paths = slopes ? f->by.count : 0;
    if (!sgt_look_begin(&a->at, f->lens, &f->how, true, a->error)) return false;
    if (figure_count(f, &a->at).residuals != f->size.residuals)
        return fail(a->error, "", "the lens has other residuals than at first");
    if (!sgt_look_list(&a->at, &a->in, true)) return sgt_ask_fail(&a->at.ask, "", "no memory");
    const size_t residuals = f->size.residuals;
    a->motion = sgt_ask_room(&a->at.ask, a->paths, sizeof *a->motion);
    a->residual = out->residual ? out->residual : sgt_asked_room(a, residuals);
    a->jacobian = out->jacobian && a->paths ? out->jacobian : sgt_asked_room(a, residuals * a->paths);
    a->chief = sgt_asked_room(a, FLOCK_ROWS * a->paths);
    a->chief_error = sgt_asked_room(a, FLOCK_ROWS * a->paths);
    a->sum = sgt_asked_room(a, a->paths), a->sum_error = sgt_asked_room(a, a->paths);
    a->moved = sgt_asked_room(a, a->paths), a->bounds = out->value_err || (out->gradient_err && a->paths);
    if (sgt_asked_failed(a)) return false;
    if (!find_motions(a)) return false;
    return sgt_flock_begin(&a->rays, &a->at, &a->in, a->paths, a->motion);
}

static bool ask(asked *a)
{
    switch (a->of->opt.kind) {
    case SGT_FIGURE_SPOT:
        return sgt_figure_spots(a);
    case SGT_FIGURE_OPD:
        return sgt_figure_fronts(a);
    case SGT_FIGURE_CHIEF:
        return sgt_figure_chiefs(a);
    case SGT_FIGURE_EFL:
        return sgt_figure_efl(a);
    case SGT_FIGURE_DISTORTION:
        return sgt_figure_distortion(a);
    }
    return false;
}

static bool put_numbers(sgt_figure *f, const double x[], sgt_error *error)
{
    if (!f->by.put(f->by.context, f->lens, f->x, x, error)) return false;
    memcpy(f->x, x, f->by.count * sizeof *x);
    return true;
}

bool sgt_figure_eval(sgt_figure *f, const double x[], sgt_figure_out *out, sgt_error *error)
{
    sgt_error unread;
    for (size_t i = 0; i < sizeof out->reserved_ / sizeof *out->reserved_; i++)
        if (out->reserved_[i])
            return fail(error, "sgt_figure_out.reserved_", "a member that this sagitta has not");
    out->rays = out->clipped = out->lost = out->backward = 0;
    asked a = {.of = f, .out = out, .error = error ? error : &unread};
    if (x && !put_numbers(f, x, a.error)) return false;
    const bool fine = prepare(&a) && ask(&a);
    sgt_look_end(&a.at);
    return fine;
}

/* ------------------------------------------------------------------------ begin, end */

static void *room_in(sgt_figure *f, size_t count, size_t size)
{
    void *room = sgt_arena_take(&f->memory, count * size + 1);
    if (room) memset(room, 0, count * size);
    return room;
}

/* Of paths: edits what differs. */
static bool put_at_paths(const void *context, sgt_lens *lens, const double from[], const double to[],
                         sgt_error *error)
{
    const sgt_figure *f = context;
    size_t count = 0;
    for (size_t m = 0; m < f->by.count; m++)
        if (from[m] != to[m])
            f->edit[count++] = (sgt_edit){.kind = SGT_EDIT_SET, .path = f->by.path[m], .number = to[m]};
    return count == 0 || sgt_lens_edit(lens, count, f->edit, error);
}

/* A pickup or solve at a path becomes its number: else the lens would hang on more than the numbers. */
static bool read_paths(sgt_figure *f, const char *const path[], sgt_error *error)
{
    const char **own = room_in(f, f->by.count, sizeof *own);
    f->x = room_in(f, f->by.count, sizeof *f->x), f->edit = room_in(f, f->by.count, sizeof *f->edit);
    f->by.path = own, f->by.context = f, f->by.put = put_at_paths;
    if (!own || !f->x || !f->edit) return fail(error, "", "no memory");
    for (size_t m = 0; m < f->by.count; m++) {
        char text[2];
        if (!sgt_lens_get(f->lens, path[m], &f->x[m], error)) return false;
        if (!(own[m] = sgt_arena_text(&f->memory, path[m], strlen(path[m]))))
            return fail(error, "", "no memory");
        for (size_t k = 0; k < m; k++)
            if (strcmp(path[k], path[m]) == 0) return fail(error, path[m], "this path is given twice");
        if (sgt_lens_get_text(f->lens, path[m], sizeof text, text, NULL) != SIZE_MAX && *text == '{' &&
            !sgt_lens_set(f->lens, path[m], f->x[m], error))
            return false;
    }
    return true;
}

/* Of other numbers: x of the lens. */
static bool take_numbers(sgt_figure *f, const lens_numbers *by, const double x[], sgt_error *error)
{
    f->by = *by;
    f->x = room_in(f, by->count, sizeof *x), f->none = room_in(f, by->count, sizeof *f->none);
    if (!f->x || !f->none) return fail(error, "", "no memory");
    memcpy(f->x, x, by->count * sizeof *x);
    return true;
}

static bool begin_figure(sgt_figure *f, const sgt_lens *lens, const lens_numbers *by, const double x[],
                         sgt_error *error)
{
    static const sgt_analysis *const of[] = {&sgt_spot_analysis, &sgt_wavefront_analysis, &sgt_field_analysis,
                                             &sgt_field_analysis, &sgt_field_analysis};
    if ((unsigned)f->opt.kind >= sizeof of / sizeof *of)
        return fail(error, "kind", "there is no such figure");
    if (f->opt.reference < 0 || f->opt.reference > 1) return fail(error, "reference", "must be 0 or 1");
    for (size_t i = 0; i < sizeof f->opt.reserved_ / sizeof *f->opt.reserved_; i++)
        if (f->opt.reserved_[i])
            return fail(error, "sgt_figure_options.reserved_", "a member that this sagitta has not");
    if (lens->afocal) return fail(error, "afocal", "no figures of an afocal lens");
    const bool rays = f->opt.kind == SGT_FIGURE_SPOT || f->opt.kind == SGT_FIGURE_CHIEF;
    f->how = (looking){&f->study, of[f->opt.kind], f->opt.kind == SGT_FIGURE_OPD, !rays};
    f->by.count = by->count;
    if (!(f->lens = sgt_lens_copy(lens, error))) return false;
    /* (else each edit would make them all) */
    if (sgt_lens_configurations(lens) && !sgt_lens_remove(f->lens, "configurations", error)) return false;
    if (!(by->put ? take_numbers(f, by, x, error) : read_paths(f, by->path, error))) return false;
    look_of_lens l;
    const bool fine = sgt_look_begin(&l, f->lens, &f->how, true, error);
    if (fine) f->size = figure_count(f, &l);
    sgt_look_end(&l);
    return fine;
}

sgt_figure *sgt_figure_by(const sgt_lens *lens, const sgt_study_options *study, const sgt_figure_options *opt,
                          const lens_numbers *by, const double x[], sgt_error *error)
{
    const sgt_allocator a = sgt_allocator_or(study ? study->allocator : NULL);
    sgt_error unread;
    sgt_figure *f = a.resize(a.context, NULL, sizeof *f);
    if (!f) {
        fail(error, "", "no memory");
        return NULL;
    }
    *f = (sgt_figure){.allocator = a, .memory = {.allocator = a}};
    if (study) f->study = *study;
    if (opt) f->opt = *opt;
    f->study.run = NULL;
    if (begin_figure(f, lens, by, x, error ? error : &unread)) return f;
    sgt_figure_free(f);
    return NULL;
}

sgt_figure *sgt_figure_new(const sgt_lens *lens, const sgt_study_options *study,
                           const sgt_figure_options *opt, size_t paths, const char *const path[],
                           sgt_error *error)
{
    return sgt_figure_by(lens, study, opt, &(lens_numbers){.count = paths, .path = path}, NULL, error);
}

bool sgt_figure_has_none(const sgt_figure *f, size_t m) { return f->none && f->none[m]; }

void sgt_figure_free(sgt_figure *f)
{
    if (!f) return;
    const sgt_allocator a = f->allocator;
    sgt_lens_free(f->lens);
    sgt_arena_free(&f->memory);
    a.resize(a.context, f, 0);
}

sgt_figure_count sgt_figure_size(const sgt_figure *f) { return f->size; }

void sgt_figure_start(const sgt_figure *f, double x[]) { memcpy(x, f->x, f->by.count * sizeof *x); }

sgt_lens *sgt_figure_lens(sgt_figure *f) { return f->lens; }
