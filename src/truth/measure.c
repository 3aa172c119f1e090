// SPDX-License-Identifier: MIT
/* measure.c - how long a setting takes, and how large its errors are.
 *
 * ERRORS are measured for every ray against its truth.  The library's answer at full accuracy says which root
 * is meant; Newton's method in 113 bits (quad.c) says where it is.  A ray that is undecided even at full
 * accuracy, or on which that method does not settle (a graze), has no truth and is in no error.
 *
 * TIMES are processor times of the thread, for calls with the rays in memory.  Each setting runs so often in
 * a row that it fills its share of the seconds.  All settings take turns, in another order each round, so
 * that a busy moment of the machine does not fall on one setting only.  The result is the median of the
 * rounds.  Its range holds the true median with 95 % probability, for any distribution of the times, and
 * reaches from one of the sorted times to another (order statistics, David and Nagaraja 2003, section 7.1):
 * of 31 rounds from the 10th to the 22nd; of few rounds it is all of them.  Two times differ only if their
 * ranges do not touch. */
#include "measure.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 31, ROUNDS_LEAST = 5 };

/* --------------------------------------------------------------- one call */

/* Room for every output of a surface or a lens. */
typedef struct answers {
    sgt_hits hits;
    sgt_hits_f floats;
    sgt_traced traced;
    sgt_passages *element;   /* [elements] */
    sgt_passage *passage;    /* [elements], of one ray */
} answers;

static double *numbers(const trade_case *c) { return c->take(c->rays, sizeof(double)); }

static sgt_hits room_for_hits(const trade_case *c)
{
    sgt_hits h = {.status = c->take(c->rays, 1), .evals = c->take(c->rays, sizeof(int)), .t = numbers(c),
                  .t_err = numbers(c), .t_lo = numbers(c), .p_err = numbers(c)};
    for (int k = 0; k < 3; k++) h.p[k] = numbers(c), h.n[k] = numbers(c);
    return h;
}

static float *floats(const trade_case *c) { return c->take(c->rays, sizeof(float)); }

static answers measure_room_for(const trade_case *c)
{
    answers a = {.element = NULL};
    if (!c->lens) {
        a.hits = room_for_hits(c);
        if (!c->columns_f.o[0]) return a;
        a.floats = (sgt_hits_f){
            .status = a.hits.status, .t = floats(c), .t_err = floats(c), .p_err = floats(c)};
        for (int k = 0; k < 3; k++) a.floats.p[k] = floats(c), a.floats.n[k] = floats(c);
        return a;
    }
    a.traced = (sgt_traced){.fate = c->take(c->rays, 1), .passed = c->take(c->rays, sizeof(int)),
                            .opl = numbers(c)};
    for (int k = 0; k < 3; k++) a.traced.o[k] = numbers(c), a.traced.d[k] = numbers(c);
    a.element = c->take(c->lens->count, sizeof *a.element);
    a.passage = c->take(c->lens->count, sizeof *a.passage);
    for (size_t i = 0; i < c->lens->count; i++) {
        a.element[i] = (sgt_passages){.hits = room_for_hits(c), .opl = numbers(c)};
        for (int k = 0; k < 3; k++) a.element[i].direction[k] = numbers(c);
    }
    return a;
}

static void measure_put(double *const to[3], size_t i, sgt_vec3 v)
{
    if (to[0]) to[0][i] = v.x, to[1][i] = v.y, to[2][i] = v.z;
}

static void put_hit(const sgt_hits *to, size_t i, const sgt_hit *h)
{
    if (to->status) to->status[i] = h->status;
    if (to->evals) to->evals[i] = h->evals;
    if (to->t) to->t[i] = h->t;
    if (to->t_err) to->t_err[i] = h->t_err;
    if (to->t_lo) to->t_lo[i] = h->t_lo;
    if (to->p_err) to->p_err[i] = h->p_err;
    measure_put(to->p, i, h->p);
    measure_put(to->n, i, h->n);
}

static void meet_surface(const trade_case *c, const setting *s, const sgt_hits *to)
{
    if (!s->single) {
        sgt_intersect_batch(s->surface, c->rays, c->columns, *to, &s->options);
        return;
    }
    for (size_t i = 0; i < c->rays; i++) {
        sgt_hit h = sgt_intersect(s->surface, c->ray[i], &s->options);
        put_hit(to, i, &h);
    }
}

static void trace_lens(const trade_case *c, const setting *s, const sgt_traced *to,
                       const sgt_passages *element, sgt_passage *passage)
{
    const measured_lens *j = c->lens;
    if (!s->single) {
        sgt_trace_batch(j->count, j->element, j->index_before, c->rays, c->columns, *to, element,
                        &s->options);
        return;
    }
    for (size_t i = 0; i < c->rays; i++) {
        sgt_ray ray = c->ray[i];
        sgt_fate fate;
        size_t passed = sgt_trace(j->count, j->element, j->index_before, &ray, passage, &fate,
                                  &s->options);
        if (to->fate) to->fate[i] = fate;
        if (to->passed) to->passed[i] = (int)passed;
        if (to->opl) to->opl[i] = passed ? passage[passed - 1].opl : 0;
        measure_put(to->o, i, ray.o);
        measure_put(to->d, i, ray.d);
        size_t reached = passed + (fate != SGT_PASSED);
        for (size_t e = 0; element && e < j->count; e++)
            put_hit(&element[e].hits, i, e < reached ? &passage[e].hit : &(sgt_hit){.status = SGT_MISS});
    }
}

static void meet_in_floats(const trade_case *c, const setting *s, outputs wanted, const sgt_hits_f *all)
{
    sgt_hits_f to = *all;
    if (wanted == OUTPUTS_LEAST) to = (sgt_hits_f){.t = to.t};
    else if (wanted != OUTPUTS_ALL) to.p_err = NULL;
    sgt_intersect_batch_f(s->surface, c->rays, c->columns_f, to, &s->options);
}

/* Makes the call, with only the wanted outputs. */
static void call(const trade_case *c, const setting *s, outputs wanted, answers *a)
{
    bool all = wanted == OUTPUTS_ALL, least = wanted == OUTPUTS_LEAST;
    if (c->lens) {
        sgt_traced to = a->traced;
        if (least) to = (sgt_traced){.o = {to.o[0], to.o[1], to.o[2]}};
        else if (!all) to.passed = NULL;
        trace_lens(c, s, &to, all ? a->element : NULL, a->passage);
    } else if (s->floats) {
        meet_in_floats(c, s, wanted, &a->floats);
    } else {
        sgt_hits to = a->hits;
        if (least) to = (sgt_hits){.t = to.t};
        else if (!all) to.evals = NULL, to.t_lo = NULL, to.p_err = NULL;
        meet_surface(c, s, &to);
    }
}

/* ------------------------------------------------------------------ truth */

static truth truth_of_hit(sgt_surface s, const sgt_ray *ray, const sgt_hit *h)
{
    truth is = {.known = h->status >= 0, .met = h->status > 0};
    if (!is.met) return is;
    is.t = (quad)h->t + h->t_lo;
    is.known = quad_meet(s, ray, &is.t);
    return is;
}

static truth truth_of_trace(const measured_lens *j, const sgt_ray *ray, const sgt_options *opt,
                            sgt_passage *seen)
{
    sgt_ray end = *ray;
    sgt_fate fate;
    size_t passed = sgt_trace(j->count, j->element, j->index_before, &end, seen, &fate, opt);
    truth is = {
        .known = fate >= 0, .met = fate == SGT_PASSED, .kind = fate, .passed = (int)passed};
    if (is.met)
        is.known = quad_trace(passed, j->element, j->index_before, ray, seen, &is.point, &is.path);
    return is;
}

/* The ray that the setting asks about. */
static sgt_ray ray_asked(const trade_case *c, const setting *s, size_t i)
{
    const sgt_rays_f *f = &c->columns_f;
    if (!s->floats) return c->ray[i];
    return sgt_ray_between((sgt_vec3){(double)f->o[0][i], (double)f->o[1][i], (double)f->o[2][i]},
                           (sgt_vec3){(double)f->d[0][i], (double)f->d[1][i], (double)f->d[2][i]},
                           f->tmin ? (double)f->tmin[i] : 0, f->tmax ? (double)f->tmax[i] : HUGE_VAL);
}

const truth *measure_truth(const trade_case *c, const setting *s)
{
    truth *is = c->take(c->rays, sizeof *is);
    sgt_passage *seen = c->lens ? c->take(c->lens->count, sizeof *seen) : NULL;
    for (size_t i = 0; i < c->rays; i++) {
        if (c->lens) {
            is[i] = truth_of_trace(c->lens, &c->ray[i], &s->options, seen);
        } else {
            const sgt_ray ray = ray_asked(c, s, i);
            sgt_hit h = sgt_intersect(s->surface, ray, &s->options);
            is[i] = truth_of_hit(s->surface, &ray, &h);
        }
    }
    return is;
}

/* ----------------------------------------------------------------- errors */

static double distance(quad a, double b)
{
    double d = (double)(a - b);
    return fabs(d);
}

static int ascending(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* The quantile: the smallest x that `part` of them do not exceed; NaN of none.  Sorts x. */
static double quantile(size_t n, double *x, double part)
{
    if (n == 0) return (double)NAN;
    qsort(x, n, sizeof *x, ascending);
    size_t below = (size_t)ceil(part * (double)n);
    return x[below > 0 ? below - 1 : 0];
}

double measure_rounded(double x, int digits)
{
    char text[40];
    snprintf(text, sizeof text, "%.*e", digits - 1, x);
    return strtod(text, NULL);
}

static void find_quantiles(setting *s, size_t n, double *error)
{
    s->error_median = quantile(n, error, 0.5);
    s->error_99 = quantile(n, error, 0.99);
    s->error_worst = quantile(n, error, 1);
}

/* A root is wrong if the truth is farther away than t_err. */
static void judge_hits(const trade_case *c, setting *s, const answers *a, double *error)
{
    size_t n = 0;
    long long evals = 0;
    for (size_t i = 0; i < c->rays; i++) {
        int status = a->hits.status[i];
        const truth *is = &s->truth[i];
        evals += a->hits.evals[i];
        if (status < 0) s->undecided++;
        if (status < 0 || !is->known) continue;
        if ((status > 0) != is->met) {
            s->wrong++;
        } else if (is->met) {
            error[n] = distance(is->t, a->hits.t[i]);
            if (!s->other_model && !(error[n] <= a->hits.t_err[i])) s->wrong++;
            n++;
        }
    }
    s->evals = measure_rounded((double)evals / (double)c->rays, 4);
    find_quantiles(s, n, error);
}

/* A trace is wrong if the ray ends at another element, or with another fate, than it should. */
static void judge_traces(const trade_case *c, setting *s, const answers *a, double *error)
{
    const measured_lens *j = c->lens;
    size_t n = 0;
    long long evals = 0;
    double path = 0;
    for (size_t i = 0; i < c->rays; i++) {
        const truth *is = &s->truth[i];
        int fate = a->traced.fate[i];
        for (size_t e = 0; e < j->count; e++) evals += a->element[e].hits.evals[i];
        if (fate < 0) s->undecided++;
        if (fate < 0 || !is->known) continue;
        if (fate != is->kind || a->traced.passed[i] != is->passed) {
            s->wrong++;
        } else if (is->met) {
            sgt_vec3 end = {a->traced.o[0][i], a->traced.o[1][i], a->traced.o[2][i]};
            error[n++] = (double)quad_distance(is->point, end);
            path = fmax(path, distance(is->path, a->traced.opl[i]));
        }
    }
    s->evals = measure_rounded((double)evals / (double)c->rays, 4);
    s->path_worst = n ? path : (double)NAN;
    s->waves_worst = s->path_worst * j->length / j->wavelength;
    find_quantiles(s, n, error);
}

static void find_errors(trade_case *c, answers *room)
{
    double *error = numbers(c);
    for (size_t i = 0; i < c->settings; i++) {
        call(c, &c->setting[i], OUTPUTS_ALL, room);
        for (size_t k = 0; c->setting[i].floats && k < c->rays; k++)
            room->hits.t[k] = (double)room->floats.t[k], room->hits.t_err[k] = (double)room->floats.t_err[k],
            room->hits.evals[k] = 0; /* not told */
        (c->lens ? judge_traces : judge_hits)(c, &c->setting[i], room, error);
    }
}

int measure_most_evals(const trade_case *c, const setting *s)
{
    answers a = measure_room_for(c);
    int most = 0;
    call(c, s, OUTPUTS_ALL, &a);
    for (size_t e = 0; e < (c->lens ? c->lens->count : 1); e++) {
        const int *evals = c->lens ? a.element[e].hits.evals : a.hits.evals;
        for (size_t i = 0; i < c->rays; i++)
            if (evals[i] > most) most = evals[i];
    }
    return most;
}

/* ------------------------------------------------------------------ times */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct timed {
    const trade_case *c;
    setting *s;
    answers *room;       /* the case's */
    double repeats, round[ROUNDS];
} timed;

static double seconds_of(const timed *x)
{
    double begin = now();
    for (double i = 0; i < x->repeats; i++) call(x->c, x->s, x->s->outputs, x->room);
    return (now() - begin) / x->repeats;
}

static void shuffle(size_t n, timed *list[])
{
    static uint32_t state = 1; /* Marsaglia 2003, Journal of Statistical Software 8(14) */
    for (size_t i = n; i > 1; i--) {
        state ^= state << 13, state ^= state >> 17, state ^= state << 5;
        size_t k = state % i;
        timed *swapped = list[i - 1];
        list[i - 1] = list[k], list[k] = swapped;
    }
}

static void find_times(trade *t, answers room[], double seconds)
{
    size_t n = 0;
    for (size_t i = 0; i < t->count; i++) n += t->list[i].settings;
    timed *all = t->list->take(n, sizeof *all), **order = t->list->take(n, sizeof *order);
    n = 0;
    for (size_t i = 0; i < t->count; i++) {
        trade_case *c = &t->list[i];
        for (size_t k = 0; k < c->settings; k++, n++) {
            all[n] = (timed){.c = c, .s = &c->setting[k], .room = &room[i], .repeats = 1};
            order[n] = &all[n];
        }
    }
    double begin = now(), share = seconds / (double)(ROUNDS * n);
    for (size_t i = 0; i < n; i++) {
        /* the first call brings the rays into the cache */
        double first = seconds_of(&all[i]), again = seconds_of(&all[i]);
        all[i].repeats = fmax(1, ceil(share / fmax(fmin(first, again), 1e-9)));
    }
    int rounds = 0;
    for (; rounds < ROUNDS && (rounds < ROUNDS_LEAST || now() < begin + seconds); rounds++) {
        shuffle(n, order);
        for (size_t i = 0; i < n; i++) order[i]->round[rounds] = seconds_of(order[i]);
    }
    for (size_t i = 0; i < n; i++) {
        setting *s = all[i].s;
        double each = 1e9 / (double)all[i].c->rays;
        int cut = (int)fmax(0, floor((rounds - 1) / 2.0 - 0.98 * sqrt(rounds)));
        s->ns = measure_rounded(each * quantile((size_t)rounds, all[i].round, 0.5), 3); /* and sorts them */
        s->ns_low = measure_rounded(each * all[i].round[cut], 3);
        s->ns_high = measure_rounded(each * all[i].round[rounds - 1 - cut], 3);
    }
}

const setting *measure_base(const trade_case *c)
{
    for (size_t i = 0; i < c->settings; i++)
        if (c->setting[i].turned == KNOB_NONE ||
            (c->setting[i].turned == KNOB_ITERATIONS && !c->setting[i].other_model))
            return &c->setting[i];
    return NULL;
}

/* --------------------------------------------------------------- the best */

bool measure_slower(const setting *a, const setting *b)
{
    return a->ns > MEASURE_SAME_TIME * b->ns && a->ns_low > b->ns_high;
}

/* Is it worse in something?  A larger error is not worse if the other has more undecided rays: its error is
 * of fewer rays. */
static bool worse(const setting *a, const setting *b)
{
    bool far = a->error_99 > MEASURE_SAME_ERROR * b->error_99 && b->undecided <= a->undecided;
    return measure_slower(a, b) || far || a->undecided > b->undecided || a->wrong > b->wrong;
}

bool measure_same(const setting *a, const setting *b)
{
    return isnan(a->error_99) == isnan(b->error_99) && !worse(a, b) && !worse(b, a);
}

bool measure_gives(const setting *a, const setting *b)
{
    return a->outputs >= b->outputs && a->options.proof >= b->options.proof;
}

static bool beats(const setting *a, const setting *b)
{
    return measure_gives(a, b) && worse(b, a) && !worse(a, b);
}

typedef enum standing { OPEN, BEST, BEATEN } standing;

static standing standing_of(const trade_case *c, size_t i, const standing now[])
{
    bool open = false;
    for (size_t k = 0; k < c->settings; k++) {
        if (now[k] == BEATEN || !beats(&c->setting[k], &c->setting[i])) continue;
        if (now[k] == BEST) return BEATEN;
        open = true;
    }
    return open ? OPEN : BEST;
}

/* A setting is best if no best setting beats it.  Of several that are the same only the first is best: the
 * default, or the one that is turned least.  A setting that changes nothing against the default is not best.
 * Since nearly equal values are the same, "beats" is not transitive: A may beat B, and B beat C, while A does
 * not beat C.  So settings are decided round by round, until nothing changes. */
static void find_best(trade_case *c)
{
    standing *now = c->take(c->settings, sizeof *now);
    const setting *base = measure_base(c);
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        bool nothing = base && s != base && measure_gives(base, s) && measure_same(base, s);
        if (nothing || isnan(s->error_99)) now[i] = BEATEN; /* it meets nothing: its speed is worthless */
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < c->settings; i++)
            if (now[i] == OPEN && (now[i] = standing_of(c, i, now)) != OPEN) changed = true;
    }
    for (size_t i = 0; i < c->settings; i++) {
        setting *s = &c->setting[i];
        s->best = now[i] != BEATEN;
        for (const setting *k = c->setting; k < s && s->best; k++)
            if (k->best && measure_gives(k, s) && measure_same(k, s)) s->best = false;
    }
}

void measure_all(trade *t, double seconds)
{
    if (t->count == 0) return;
    answers *room = t->list->take(t->count, sizeof *room);
    for (size_t i = 0; i < t->count; i++)
        room[i] = measure_room_for(&t->list[i]), find_errors(&t->list[i], &room[i]);
    find_times(t, room, seconds);
    for (size_t i = 0; i < t->count; i++) find_best(&t->list[i]);
}
