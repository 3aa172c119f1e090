// SPDX-License-Identifier: MIT
/* tolerance.c - what each tolerance does, and what all do together.
 *
 * Lenses are built and judged in tasks, each with a copy of the lens of its own; results have their place
 * before the tasks begin.  So bits depend on no thread.  Trials go in tasks of BATCH, and in rounds of ROUND
 * of them: memory does not grow with their number. */
#include "tolerance.h"

#include "../read/lens.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BATCH = 16, BATCHES = 64, ROUND_OF = BATCH * BATCHES };

static bool refuse(const sgt_lens *lens, sgt_error *error, const char *key, const char *words)
{
    *error = (sgt_error){.line = lens->line};
    snprintf(error->file, sizeof error->file, "%s", lens->file);
    snprintf(error->key, sizeof error->key, "%s", key);
    snprintf(error->words, sizeof error->words, "%s", words);
    return false;
}

/* Lenses to be built and judged, the value of each beside its figure. */
typedef struct jobs {
    const sgt_tolerancing *t;
    size_t count, batch;
    double *value;  /* [count * t->count] */
    double *figure; /* [count] */
    bool *failed;   /* [batches]: each with its error */
    sgt_error *error;
} jobs;

static void do_batch(void *data, size_t k)
{
    jobs *j = data;
    const size_t first = k * j->batch, left = j->count - first, n = left < j->batch ? left : j->batch;
    sgt_lens *lens = sgt_lens_copy(j->t->base, &j->error[k]);
    j->failed[k] = !lens;
    for (size_t i = first; i < first + n && !j->failed[k]; i++)
        j->failed[k] = !sgt_figure_at(j->t, lens, j->value + i * j->t->count, &j->figure[i], &j->error[k]);
    sgt_lens_free(lens);
}

/* false: the first that failed. */
static bool do_jobs(jobs *j, sgt_error *error)
{
    const sgt_tolerancing *t = j->t;
    const size_t batches = (j->count + j->batch - 1) / j->batch;
    if (t->run && batches > 1)
        t->run(t->context, batches, do_batch, j);
    else
        for (size_t k = 0; k < batches; k++) do_batch(j, k);
    for (size_t k = 0; k < batches; k++)
        if (j->failed[k]) {
            *error = j->error[k];
            return false;
        }
    return true;
}

/* Room for them: freed with what is returned.  NULL: no memory. */
static void *jobs_room(const sgt_tolerancing *t, size_t count, size_t batch, jobs *j, sgt_error *error)
{
    const sgt_allocator a = t->memory.allocator;
    const size_t batches = (count + batch - 1) / batch, values = count * t->count;
    char *room = a.resize(a.context, NULL,
                          batches * sizeof *j->error + (values + count) * sizeof(double) +
                              batches * sizeof *j->failed);
    if (!room) {
        refuse(t->of, error, "", "no memory");
        return NULL;
    }
    *j = (jobs){.t = t, .count = count, .batch = batch, .value = (double *)(void *)room};
    j->figure = j->value + values;
    j->error = (sgt_error *)(void *)(j->figure + count);
    j->failed = (bool *)(j->error + batches);
    memset(room, 0, values * sizeof(double));
    return room;
}

/* ------------------------------------------------------------------------ beginning */

static bool plain_options(const sgt_tolerancing *t, const sgt_tolerancing_options *o, sgt_error *error)
{
    if ((int)o->figure < SGT_TOLERANCING_SPOT || o->figure > SGT_TOLERANCING_BORESIGHT)
        return refuse(t->of, error, "figure", "there is none of this number");
    for (size_t i = 0; i < sizeof o->reserved_ / sizeof *o->reserved_; i++)
        if (o->reserved_[i])
            return refuse(t->of, error, "sgt_tolerancing_options",
                          "the program asks for a member that this "
                          "version of sagitta has not");
    return true;
}

/* Is there a pupil, to launch rays on the axis? */
static bool can_launch(const sgt_tolerancing *t, const sgt_lens *lens, sgt_error *why)
{
    static const sgt_lens_field axis = {.weight = 1};
    const sgt_launcher_options opt = {.allocator = t->study.allocator, .aim = t->study.aim};
    sgt_launcher *from = sgt_launcher_new(lens, &opt, why);
    sgt_field_beam beam;
    const bool fine = from && sgt_launch_field(from, SGT_FIELD_ANGLE, &axis, &beam, why);
    sgt_launcher_free(from);
    return fine;
}

/* Tries each end of each entry, so that what cannot be is told with its name. */
static bool try_ends(const sgt_tolerancing *t, sgt_lens *lens, double value[], sgt_error *error)
{
    sgt_error why;
    const bool pupil = can_launch(t, t->base, &why);
    for (size_t i = 0; i < 2 * t->count; i++) {
        const sgt_tolerance *e = &t->entry[i / 2];
        value[i / 2] = i % 2 ? e->upper : e->lower;
        /* (a lens without a pupil would only have no figure, and no word would tell why) */
        if (!sgt_build_at(t, lens, value, &why) || (pupil && !can_launch(t, lens, &why))) {
            char about[SGT_TOLERANCE_SIZE];
            sgt_tolerance_text(e, about);
            *error = (sgt_error){.line = e->line};
            snprintf(error->file, sizeof error->file, "%s", t->of->file);
            snprintf(error->key, sizeof error->key, "tolerances[%zu]", i / 2 + 1);
            snprintf(error->words, sizeof error->words, "%s at %g: %s: %.800s", about, value[i / 2], why.key,
                     why.words);
            return false;
        }
        value[i / 2] = 0;
    }
    return true;
}

/* A pickup or solve becomes the number that it was when the lens was designed. */
static void keep_values(node *n, int depth)
{
    enum { DEEP = 64 };
    for (size_t i = 0; n->kind != NODE_SCALAR && depth < DEEP && i < n->count; i++) {
        node *one = n->item[i];
        if (one->kind != NODE_SCALAR && one->is && one->is->value) n->item[i] = one->is->value;
        else keep_values(one, depth + 1);
    }
}

static bool begin(sgt_tolerancing *t, const sgt_tolerancing_options *o, sgt_error *error)
{
    if (o) t->opt = *o;
    if (o && !plain_options(t, o, error)) return false;
    if (t->opt.study) t->study = *t->opt.study;
    t->run = t->study.run, t->context = t->study.context;
    t->study.run = NULL, t->opt.study = NULL;
    t->base = sgt_lens_copy(t->of, error);
    if (!t->base) return false;
    if (sgt_lens_configurations(t->base) && !sgt_lens_remove(t->base, "configurations", error)) return false;
    t->count = sgt_lens_tolerances(t->of, &t->entry);
    keep_values(((whole_lens *)(void *)t->base)->root, 0);
    /* a lens that is built has none: what may be off has been so */
    if (t->count && !sgt_lens_remove(t->base, "tolerances", error)) return false;
    t->um = sgt_lens_unit(t->base);
    double *value = sgt_arena_take(&t->memory, (t->count + 1) * sizeof *value);
    refuse(t->of, error, "", "no memory"); /* stands, if that is why the next fail */
    if (!value || !sgt_off_surfaces(t, error)) return false;
    memset(value, 0, t->count * sizeof *value);
    sgt_first_order data;
    if (!sgt_lens_first_order(t->base, (double)NAN, &data, NULL, error)) return false;
    t->image = data.image;
    sgt_lens *lens = sgt_lens_copy(t->base, error);
    if (!lens) return false;
    double built; /* a fault of the figure of a lens that is built: later it would only be without one */
    bool fine = try_ends(t, lens, value, error) && sgt_figure_begin(t, error) &&
                sgt_build_at(t, lens, value, error) && sgt_figure_of(t, lens, &built, error);
    sgt_lens_free(lens);
    for (size_t i = 0; i < t->count && fine; i++)
        if (t->entry[i].compensator == SGT_COMPENSATE_PARAXIAL && !isfinite(t->image))
            fine =
                refuse(t->of, error, "tolerances", "compensator: paraxial, but there is no paraxial image");
    if (fine && isnan(t->nominal))
        return refuse(t->of, error, "tolerances",
                      "the lens as designed has no figure: no ray of a field, or "
                      "not its chief ray, gets through");
    return fine;
}

sgt_tolerancing *sgt_tolerancing_new(const sgt_lens *lens, const sgt_tolerancing_options *opt,
                                     sgt_error *error)
{
    sgt_error unread;
    const sgt_allocator a = sgt_allocator_or(opt && opt->study ? opt->study->allocator : NULL);
    sgt_tolerancing *t = a.resize(a.context, NULL, sizeof *t);
    if (!error) error = &unread;
    if (!t) {
        refuse(lens, error, "", "no memory");
        return NULL;
    }
    *t = (sgt_tolerancing){.of = lens, .memory = {.allocator = a}};
    if (begin(t, opt, error)) return t;
    sgt_tolerancing_free(t);
    return NULL;
}

void sgt_tolerancing_free(sgt_tolerancing *t)
{
    if (!t) return;
    const sgt_allocator a = t->memory.allocator;
    sgt_lens_free(t->base);
    sgt_arena_free(&t->memory);
    a.resize(a.context, t, 0);
}

double sgt_tolerancing_nominal(const sgt_tolerancing *t) { return t->nominal; }

/* -------------------------------------------------------------------------- a point */

sgt_lens *sgt_tolerancing_lens(const sgt_tolerancing *t, const double value[], sgt_error *error)
{
    sgt_error unread;
    if (!error) error = &unread;
    sgt_lens *lens = sgt_lens_copy(t->base, error);
    if (lens && sgt_build_at(t, lens, value, error)) return lens;
    sgt_lens_free(lens);
    return NULL;
}

bool sgt_tolerancing_at(const sgt_tolerancing *t, double value[], double *figure, sgt_error *error)
{
    sgt_error unread;
    if (!error) error = &unread;
    sgt_lens *lens = sgt_lens_copy(t->base, error);
    *figure = (double)NAN;
    const bool fine = lens && sgt_figure_at(t, lens, value, figure, error);
    sgt_lens_free(lens);
    return fine;
}

/* ---------------------------------------------------------------------- sensitivity */

static bool is_worse(const sgt_sensitivity *a, const sgt_sensitivity *b)
{
    if (isnan(a->worse) || isnan(b->worse)) return isnan(a->worse) && !isnan(b->worse);
    return a->worse > b->worse;
}

static void put_row(sgt_sensitivity row[], size_t n, sgt_sensitivity one)
{
    size_t at = n;
    for (; at > 0 && is_worse(&one, &row[at - 1]); at--) row[at] = row[at - 1];
    row[at] = one;
}

bool sgt_tolerancing_sensitivity(const sgt_tolerancing *t, size_t *count, sgt_sensitivity row[],
                                 sgt_sensitivity_sum *sum, sgt_error *error)
{
    const sgt_allocator a = t->memory.allocator;
    sgt_error unread;
    jobs j;
    if (!error) error = &unread;
    *count = 0;
    void *room = jobs_room(t, 2 * t->count + 1, 1, &j, error);
    if (!room) return false;
    size_t first = t->count; /* the first compensator */
    for (size_t i = t->count; i-- > 0;) {
        const sgt_tolerance *e = &t->entry[i];
        if (e->compensator)
            first = i;
        else
            j.value[2 * i * t->count + i] = e->lower, j.value[(2 * i + 1) * t->count + i] = e->upper;
    }
    slopes slope = {.figure = a.resize(a.context, NULL, (2 * t->count + 1) * sizeof *slope.figure)};
    if (!slope.figure) refuse(t->of, error, "", "no memory");
    if (slope.figure) slope.compensator = slope.figure + t->count;
    const bool fine = slope.figure && do_jobs(&j, error) &&
                      sgt_slopes_at(t, j.value + 2 * t->count * t->count, &slope, error);
    const double zero = j.figure[2 * t->count];
    double squares_of = 0;
    for (size_t i = 0; i < t->count && fine; i++) {
        const double *low = j.value + 2 * i * t->count, *high = low + t->count;
        if (t->entry[i].compensator) continue;
        sgt_sensitivity one = {
            .entry = i, .figure_lower = j.figure[2 * i], .figure_upper = j.figure[2 * i + 1]};
        one.change_lower = one.figure_lower - zero, one.change_upper = one.figure_upper - zero;
        one.worse = one.change_lower > one.change_upper ? one.change_lower : one.change_upper;
        if (isnan(one.change_lower) || isnan(one.change_upper)) one.worse = (double)NAN;
        one.compensator_lower = first < t->count ? low[first] : (double)NAN;
        one.compensator_upper = first < t->count ? high[first] : (double)NAN;
        one.derivative = slope.figure[i], one.compensator_derivative = slope.compensator[i];
        one.linear_lower = one.derivative * (slope.even ? fabs(t->entry[i].lower) : t->entry[i].lower);
        one.linear_upper = one.derivative * (slope.even ? fabs(t->entry[i].upper) : t->entry[i].upper);
        squares_of += (one.change_lower * one.change_lower + one.change_upper * one.change_upper) / 2;
        put_row(row, (*count)++, one);
    }
    if (fine && sum)
        *sum = (sgt_sensitivity_sum){
            .nominal = t->nominal, .compensated = zero, .estimate = zero + sqrt(squares_of)};
    if (slope.figure) a.resize(a.context, slope.figure, 0);
    a.resize(a.context, room, 0);
    return fine;
}

/* ---------------------------------------------------------------------- Monte Carlo */

bool sgt_tolerancing_trials(const sgt_tolerancing *t, uint64_t seed, uint64_t first, uint64_t count,
                            void (*take)(void *context, const sgt_trial *trial), void *context,
                            sgt_error *error)
{
    const sgt_allocator a = t->memory.allocator;
    sgt_error unread;
    jobs j;
    if (!error) error = &unread;
    void *room = jobs_room(t, ROUND_OF, BATCH, &j, error);
    bool fine = room != NULL;
    for (uint64_t done = 0; done < count && fine; done += j.count) {
        j.count = count - done < ROUND_OF ? (size_t)(count - done) : ROUND_OF;
        for (size_t i = 0; i < j.count; i++)
            sgt_tolerancing_draw(t, seed, first + done + i, j.value + i * t->count);
        fine = do_jobs(&j, error);
        for (size_t i = 0; i < j.count && fine; i++)
            take(context, &(sgt_trial){.number = first + done + i,
                                       .figure = j.figure[i],
                                       .value = j.value + i * t->count});
    }
    if (room) a.resize(a.context, room, 0);
    return fine;
}
