// SPDX-License-Identifier: MIT
/* study.c - fields x wavelengths x points of the pupil, and tasks in threads.
 *
 * WHAT A STUDY IS stands in one place, here: which fields, wavelengths and points there are if nothing is
 * said.  Pupil and fields are defined at the primary wavelength of the lens, so all wavelengths share a
 * launcher.
 *
 * ROUNDS.  Tasks go in rounds of ROUND at least, and of as many as ROUND_BYTES hold: memory does not grow
 * with their number, and threads rarely wait for each other.  TAKING goes on beside the work: the thread
 * that asks takes the tasks of a round while the others are at the next.  So what comes in order, such as
 * rows that are printed, does not keep them waiting. */
#include "study.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---------------------------------------------------------------- small things */

void *sgt_ask_room(sgt_asking *a, size_t count, size_t size)
{
    void *room =
        count <= SIZE_MAX / 2 / size ? sgt_arena_take(&a->memory, count ? count * size : size) : NULL;
    if (room) memset(room, 0, count ? count * size : size);
    else sgt_ask_fail(a, "", "no memory");
    return room;
}

bool sgt_ask_fail(sgt_asking *a, const char *key, const char *words, ...)
{
    char text[sizeof a->error->words];
    if (a->failed) return false;
    a->failed = true;
    va_list more;
    va_start(more, words);
    vsnprintf(text, sizeof text, words, more);
    va_end(more);
    return sgt_launch_fail(a->from, a->error, key, "%s", text);
}

bool sgt_ask_refuse(sgt_asking *a, const char *setting, const char *words, ...)
{
    if (a->failed) return false;
    a->failed = true;
    *a->error = (sgt_error){.line = 0};
    snprintf(a->error->key, sizeof a->error->key, "%s", setting);
    va_list more;
    va_start(more, words);
    vsnprintf(a->error->words, sizeof a->error->words, words, more);
    va_end(more);
    return false;
}

void sgt_ask_row(const sgt_asking *a, const void *row)
{
    if (a->sink->row && !sgt_ask_shards(a)) a->sink->row(a->sink->context, row);
}

void sgt_ask_say(const sgt_asking *a, sgt_remark_of_study kind, const char *words, ...)
{
    char text[1000];
    va_list more;
    if (!a->sink->say || sgt_ask_shards(a)) return;
    va_start(more, words);
    vsnprintf(text, sizeof text, words, more);
    va_end(more);
    a->sink->say(a->sink->context, kind, text);
}

const char *sgt_ask_units(const sgt_asking *a)
{
    return *a->lens->units ? a->lens->units : "that of the lens";
}

size_t sgt_digits(double value, double error)
{
    enum { MOST = 16 };
    if (!(error >= 0) || isnan(value) || isinf(error)) return 0;
    const double digits = error > 0 ? floor(log10(fabs(value) / error)) : MOST;
    return digits > MOST ? MOST : digits > 0 ? (size_t)digits : 0;
}

const sgt_lens_field *sgt_ask_farthest(const sgt_asking *a)
{
    const sgt_lens_field *far = &a->at[0];
    for (size_t i = 1; i < a->fields; i++)
        if (hypot(a->at[i].x, a->at[i].y) > hypot(far->x, far->y)) far = &a->at[i];
    return far;
}

sgt_element *sgt_ask_moved(sgt_asking *a, const band *b, double z)
{
    const size_t count = a->lens->count;
    if (z == 0) return b->element;
    sgt_element *e = sgt_ask_room(a, count, sizeof *e);
    if (!e) return NULL;
    memcpy(e, b->element, count * sizeof *e);
    sgt_pose *pose = &e[count - 1].pose;
    const bool straight = dot3(pose->ex, pose->ex) == 0;
    pose->origin = along3(pose->origin, z, straight ? (sgt_vec3){0, 0, 1} : pose->ez);
    return e;
}

/* ---------------------------------------------------------------------- fates */

int sgt_fate_of(const sgt_ray_end *end)
{
    return end->aimed == SGT_NO_SUCH_RAY ? SGT_NO_RAY : (int)end->fate;
}

const char *sgt_study_fate_text(int fate)
{
    return fate == SGT_NO_RAY ? "none" : sgt_fate_text((sgt_fate)fate);
}

void sgt_fates_count(sgt_fates *f, const sgt_ray_end *end)
{
    f->rays++, f->folded += end->folded;
    if (end->aimed == SGT_AIMED_UNDECIDED) {
        f->within = f->unfound ? fmin(f->within, end->within) : end->within;
        f->unfound++;
    }
    if (end->aimed == SGT_NO_SUCH_RAY) f->none++;
    else if (end->fate == SGT_PASSED) f->passed++, f->proven += end->proven;
    else if (end->fate == SGT_MISSED) f->missed++;
    else if (end->fate == SGT_CLIPPED) f->clipped++;
    else if (end->fate == SGT_TIR) f->tir++;
    else if (end->fate == SGT_EVANESCENT) f->evanescent++;
    else f->lost++;
}

void sgt_fates_add(sgt_fates *f, const sgt_fates *more)
{
    if (more->unfound) f->within = f->unfound ? fmin(f->within, more->within) : more->within;
    f->rays += more->rays, f->passed += more->passed, f->missed += more->missed;
    f->clipped += more->clipped, f->tir += more->tir, f->lost += more->lost, f->none += more->none;
    f->unfound += more->unfound, f->folded += more->folded, f->proven += more->proven;
    f->evanescent += more->evanescent;
}

sgt_fate_counts sgt_fates_row(const sgt_fates *f)
{
    return (sgt_fate_counts){f->missed, f->clipped, f->tir, f->lost, f->none, f->proven, f->evanescent};
}

/* --------------------------------------------------------------------- rounds */

/* Of a round: its tasks, where their slots begin, and which failed. */
typedef struct round_of { size_t first, tasks; char *slots; bool failed[ROUND_MOST]; } round_of;

/* The round that is worked on, and the one before, of which `taken` have been taken. */
typedef struct two_rounds {
    sgt_asking *ask;
    const rounds *r;
    size_t step;
    round_of now, before;
    size_t taken;
    const char *asker;          /* own_thread of the thread that asks */
} two_rounds;

static _Thread_local char own_thread;

static void take_before(two_rounds *w)
{
    sgt_asking *a = w->ask;
    const round_of *b = &w->before;
    while (w->taken < b->tasks && !a->failed) {
        const size_t i = w->taken++;
        if (b->failed[i]) sgt_ask_fail(a, "", "no memory");
        else w->r->take(w->r->data, b->first + i, b->slots + i * w->step);
    }
}

/* The thread that asks takes before it works. */
static void round_task(void *data, size_t i)
{
    two_rounds *w = data;
    if (&own_thread == w->asker) take_before(w);
    w->now.failed[i] = !w->r->work(w->r->data, w->now.first + i, w->now.slots + i * w->step);
}

bool sgt_ask_rounds(sgt_asking *a, const rounds *r)
{
    const sgt_study_options *o = &a->study->opt;
    const size_t align = 64, step = (r->size + align) / align * align, fit = ROUND_BYTES / step;
    /* alone: what was made is taken before it leaves the cache */
    const size_t round = !o->run ? 1 : fit < ROUND ? ROUND : fit < ROUND_MOST ? fit : ROUND_MOST;
    const size_t most = r->tasks < round ? r->tasks : round;
    two_rounds w = {.ask = a, .r = r, .step = step, .asker = &own_thread};
    if (r->tasks == 0 || a->failed) return !a->failed;
    char *slots = sgt_launch_take(a->from, 2 * most, w.step);
    if (!slots) return sgt_ask_fail(a, "", "no memory");
    w.now.slots = slots, w.before.slots = slots + most * w.step;
    for (size_t first = 0; first < r->tasks && !a->failed; first += most) {
        const size_t left = r->tasks - first;
        w.now.first = r->first + first, w.now.tasks = left < most ? left : most;
        if (r->prepare && !r->prepare(r->data, w.now.first, w.now.tasks)) break;
        if (o->run && w.now.tasks > 1) o->run(o->context, w.now.tasks, round_task, &w);
        else
            for (size_t i = 0; i < w.now.tasks; i++) round_task(&w, i);
        take_before(&w);
        const round_of done = w.now;
        w.now = w.before, w.before = done, w.taken = 0;
    }
    take_before(&w);
    sgt_launch_forget(a->from, slots);
    return !a->failed;
}

/* ------------------------------------------------------- fields and wavelengths */

bool sgt_place_study(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    const sgt_asking *a = p->ask;
    const band *b = &a->band[i % a->bands];
    (void)fault;
    out->beam = &a->beam[i / a->bands], out->element = b->element, out->before = b->before;
    return true;
}

void sgt_lost_study(const pass *p, size_t i, sgt_lost_ray *out)
{
    const sgt_asking *a = p->ask;
    const size_t f = i / a->bands;
    *out = (sgt_lost_ray){.field = a->of_lens ? a->number[f] : 0, .kind = a->kind, .at = a->at[f],
                          .wavelength = a->band[i % a->bands].at};
}

typedef struct chiefs { sgt_asking *ask; size_t surfaces; sgt_element *const *element; sgt_ray_end *end;
} chiefs;

static bool chief_of(void *data, size_t i, void *slot)
{
    const chiefs *c = data;
    const sgt_asking *a = c->ask;
    return sgt_trace_chief(a->from, &a->beam[i / c->surfaces], c->element[i % c->surfaces], a->primary.before,
                           slot, NULL);
}

static void keep_chief(void *data, size_t i, void *slot)
{
    const chiefs *c = data;
    memcpy(&c->end[i], slot, sizeof c->end[i]);
}

sgt_ray_end *sgt_ask_chiefs(sgt_asking *a, size_t surfaces, sgt_element *const element[])
{
    chiefs c = {.ask = a, .surfaces = surfaces, .element = element};
    c.end = sgt_ask_room(a, a->fields * surfaces, sizeof *c.end);
    const rounds r = {.tasks = a->fields * surfaces, .size = sizeof *c.end, .data = &c, .work = chief_of,
                      .take = keep_chief};
    return c.end && sgt_ask_rounds(a, &r) ? c.end : NULL;
}

/* ---------------------------------------------------------------- what is asked */

static bool set_band(sgt_asking *a, sgt_wavelength at, band *out)
{
    const sgt_lens *l = a->lens;
    if (at.number > l->wavelengths)
        return sgt_ask_fail(a, "wavelengths", "there is no number %zu: the lens has %zu wavelength%s",
                            at.number, l->wavelengths, l->wavelengths == 1 ? "" : "s");
    for (size_t i = 0; l->wavelength && i < l->wavelengths && !at.number; i++)
        if (l->wavelength[i] == at.um) at.number = i + 1;
    if (at.number) at.um = l->wavelength ? l->wavelength[at.number - 1] : (double)NAN;
    *out = (band){.at = at,
                  .weight = at.number && l->wavelength_weight ? l->wavelength_weight[at.number - 1] : 1};
    out->element = sgt_ask_room(a, l->count, sizeof *out->element);
    if (!out->element) return false;
    if (!sgt_lens_at(l, at.um, out->element, &out->before, a->error) ||
        !sgt_lens_first_order(l, at.um, &out->data, NULL, a->error)) {
        a->failed = true;
        return false;
    }
    for (size_t i = 0; a->study->opt.open && i < l->count; i++)
        out->element[i].semi_diameter = 0, out->element[i].aperture = NULL;
    return true;
}

static bool set_bands(sgt_asking *a)
{
    const sgt_study_options *o = &a->study->opt;
    const sgt_lens *l = a->lens;
    const bool every = !o->wavelengths && (o->every_wavelength || !a->of->primary_alone);
    a->bands = o->wavelengths ? o->wavelengths : every ? l->wavelengths : 1;
    a->band = sgt_ask_room(a, a->bands, sizeof *a->band);
    for (size_t i = 0; i < a->bands && !a->failed; i++)
        set_band(a, o->wavelengths ? o->wavelength[i]
                                   : (sgt_wavelength){.number = every ? i + 1 : l->primary + 1},
                 &a->band[i]);
    if (a->failed) return false;
    if (l->wavelength) return set_band(a, (sgt_wavelength){.number = l->primary + 1}, &a->primary);
    a->primary = a->band[0];
    return true;
}

static bool set_fields(sgt_asking *a)
{
    const sgt_study_options *o = &a->study->opt;
    const sgt_lens *l = a->lens;
    sgt_lens_field *at = NULL;
    a->fields = o->fields ? o->fields : l->fields;
    a->of_lens = !o->fields || o->field;
    a->kind = a->of_lens || !o->field_kind ? l->field_kind : *o->field_kind;
    a->number = sgt_ask_room(a, a->fields, sizeof *a->number);
    a->at = at = sgt_ask_room(a, a->fields, sizeof *at);
    a->beam = sgt_ask_room(a, a->fields, sizeof *a->beam);
    for (size_t i = 0; i < a->fields && !a->failed; i++) {
        const size_t number = o->fields && o->field ? o->field[i] : i + 1;
        if (a->of_lens && (number < 1 || number > l->fields))
            return sgt_ask_fail(a, "fields",
                                "there is no number %zu: fields count from 1, as in the file, and "
                                "the lens has %zu",
                                number, l->fields);
        a->number[i] = number;
        at[i] = a->of_lens ? l->field[number - 1] : o->field_at[i];
        if (!sgt_launch_field(a->from, a->kind, &at[i], &a->beam[i], a->error)) a->failed = true;
    }
    return !a->failed;
}

static bool pick_points(sgt_asking *a, sgt_pattern pattern, size_t n, sgt_pupil *out)
{
    const uint64_t seed = a->study->opt.seed ? a->study->opt.seed : 1;
    size_t *row = sgt_ask_room(a, sgt_pupil_rows(pattern, n) + 1, sizeof *row);
    if (row) *out = sgt_pupil_of(pattern, n, seed, row), out->equal = a->study->opt.equal_weights;
    return row;
}

/* How many rays suit a pattern, if nothing is said. */
static size_t rays_of(sgt_pattern pattern)
{
    static const size_t suits[] = {
        [SGT_PATTERN_FAN] = 5, [SGT_PATTERN_GRID] = 11, [SGT_PATTERN_HEXAPOLAR] = 6,
        [SGT_PATTERN_RANDOM] = 100, [SGT_PATTERN_SOBOL] = 128, [SGT_PATTERN_CELLS] = 20,
        [SGT_PATTERN_CROSS] = 21,
    };
    return suits[pattern];
}

/* The n of a pattern that has so many rays across the pupil. */
static size_t rays_across(sgt_pattern pattern, size_t across)
{
    const double QUARTER = 0.785398163397448; /* pi / 4: a circle in its square */
    if (pattern == SGT_PATTERN_HEXAPOLAR) return across / 2 ? across / 2 : 1;
    if (pattern != SGT_PATTERN_RANDOM && pattern != SGT_PATTERN_SOBOL) return across;
    return (size_t)ceil(QUARTER * (double)across * (double)across);
}

bool sgt_ask_pupil(sgt_asking *a)
{
    const sgt_study_options *o = &a->study->opt;
    if (a->of->no_rays) return true;
    if (o->points) {
        a->fine = (sgt_pupil){.count = o->points, .given = o->point, .equal = o->equal_weights};
        return true;
    }
    const sgt_pattern pattern = o->pattern ? *o->pattern : a->of->pattern;
    const bool area = pattern == SGT_PATTERN_RANDOM || pattern == SGT_PATTERN_SOBOL;
    const size_t n = o->across    ? rays_across(pattern, o->across)
                     : o->rays    ? o->rays
                     : o->pattern ? rays_of(pattern)
                                  : a->of->rays;
    if (!pick_points(a, pattern, n, &a->fine)) return false;
    if (a->fine.count == 0)
        return sgt_ask_refuse(a, "rays", "no ray of the pattern lies inside the pupil's circle");
    if (a->study->rms_alone) return true;
    return n / (area ? 4 : 2) == 0 || pick_points(a, pattern, n / (area ? 4 : 2), &a->coarse);
}

/* ------------------------------------------------------------------- the study */

sgt_study *sgt_study_new(const sgt_lens *lens, const sgt_study_options *opt, sgt_error *error)
{
    const sgt_study_options defaults = {.allocator = NULL};
    if (!opt) opt = &defaults;
    const sgt_wavelength *first = opt->wavelengths ? opt->wavelength : NULL;
    const sgt_launcher_options o = {
        .allocator = opt->allocator, .aim = opt->aim,
        .wavelength = first && !first->number && !isnan(first->um) ? first->um : 0};
    sgt_launcher *from = sgt_launcher_new(lens, &o, error);
    if (!from) return NULL;
    sgt_study *study = sgt_launch_take(from, 1, sizeof *study);
    if (study) *study = (sgt_study){.opt = *opt, .lens = lens, .from = from, .um = sgt_lens_unit(lens)};
    const sgt_shard *shard = opt->shard;
    const bool writes = shard && (shard->number || shard->next);
    const bool reads = shard && (!shard->number || shard->next);
    if (!study) sgt_launch_memory(from, error);
    else if (shard && (shard->of < 1 || shard->number > shard->of ||
                       (writes && !shard->write) || (reads && !shard->read)))
        sgt_launch_fail(from, error, "",
                        "sgt_shard: number %zu of %zu; 1 to `of` needs write, 0 needs read, next needs both",
                        shard->number, shard->of);
    else if (PLAIN(from, opt, "sgt_study_options", error) &&
             (!opt->shard || PLAIN(from, opt->shard, "sgt_shard", error)))
        return study;
    sgt_launch_forget(from, study);
    sgt_launcher_free(from);
    return NULL;
}

void sgt_study_free(sgt_study *study)
{
    if (!study) return;
    sgt_launcher *from = study->from;
    sgt_launch_forget(from, study);
    sgt_launcher_free(from);
}

bool sgt_ask_begin(sgt_asking *a) { return !a->failed && set_bands(a) && set_fields(a); }

/* Is what is reserved for later versions zero, in the sink and at the end of the options? */
static bool asks_plainly(const sgt_asking *a, sgt_error *error)
{
    const void *room = a->options ? (const char *)a->options + a->of->options_room : NULL;
    const size_t words = room ? (a->of->options_size - a->of->options_room) / sizeof(unsigned long long) : 0;
    return PLAIN(a->from, a->sink, "sgt_sink", error) &&
           sgt_launch_plain(a->from, room, words, "options", error);
}

bool sgt_study_run(const sgt_study *study, const sgt_analysis *analysis, const void *options,
                   const sgt_sink *sink, sgt_study_total *total, sgt_error *error)
{
    static const sgt_sink nowhere;
    sgt_error unread;
    sgt_asking a = {.study = study, .lens = study->lens, .from = study->from, .of = analysis,
                    .options = options, .sink = sink ? sink : &nowhere, .error = error ? error : &unread,
                    .counts = true, .memory = {.allocator = study->from->allocator}};
    if (!asks_plainly(&a, error)) return false;
    if (!a.options) a.options = sgt_ask_room(&a, analysis->options_size + 1, 1);
    const bool fine = sgt_ask_begin(&a) && sgt_ask_pupil(&a) && analysis->ask(&a) && !a.failed;
    if (fine && study->opt.equal_weights && !analysis->no_rays)
        sgt_ask_say(&a, SGT_STUDY_LEGEND, "Each ray counts alike, whatever area of the pupil it stands for.");
    if (total) *total = a.total;
    sgt_arena_free(&a.memory);
    return fine;
}
