// SPDX-License-Identifier: MIT
/* bridge.c - what Python cannot do by itself when it calls the library.
 *
 * ONE ARGUMENT A CALL.  ctypes spends its time on arguments.  So a call is a struct, a `sagitta_call`, that
 * Python fills once and hands over by one pointer.  Many rays are given with the part [begin, end) of them:
 * threads share the arrays.
 *
 * ARITHMETIC is asked before each call, in the thread that calls: some hosts set "flush to zero" (a library
 * that was compiled by -ffast-math does, as it is loaded), and then no bound of the library holds.
 *
 * ANSWERS IN ONE BLOCK.  A struct with a pointer for each array costs Python more than a few rays do.  So the
 * answers to a call by one thread are columns in one block of memory.  Python tells the block and which
 * columns it wants; the pointers are made here (`columns_of`), and there by the same rule when a column is
 * read.
 *
 * A FUNCTION OF PYTHON AS A SURFACE.  The library asks F at some dozen points at a time, and numpy needs
 * thousands to be worth its overhead.  The rays are independent, so many blocks of them can be under way at
 * once, each on a stack of its own (makecontext: a coroutine).  Where a block asks F, it is left with its
 * question.  When all blocks have one, Python is asked once for all, and each goes on with its answers.  The
 * library sees nothing of it, and every answer is what it would be without, bit for bit, if the function's
 * are.  Where there is no makecontext, and below 65 rays, each question goes to Python by itself.
 *
 * A QUESTION THAT FAILS (Python has raised) ends it: from then on every answer is NaN at once, and blocks
 * that have not begun do not begin.  Python raises again when the call returns. */
#include <sagitta/aim.h>
#include <sagitta/analysis.h>
#include <sagitta/diagnose.h>
#include <sagitta/figure.h>
#include <sagitta/edit.h>
#include <sagitta/formula.h>
#include <sagitta/sensitivity.h>
#include <sagitta/study.h>
#include <sagitta/tolerance.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#ifdef SAGITTA_FIBRES
#include <setjmp.h>
#include <sys/mman.h>
#include <ucontext.h>
#endif

/* ------------------------------------------------- a function of Python as a surface */

/* What is asked: how many rows of numbers go in, and come out. */
typedef enum question { VALUE, VALUE_GRAD, ROUNDING, CLEARANCE, ESTIMATE, ENCLOSE, QUESTIONS } question;
static const struct { size_t in, out; } rows_of[QUESTIONS] = {
    [VALUE] = {3, 1}, [VALUE_GRAD] = {3, 4}, [ROUNDING] = {3, 1}, [CLEARANCE] = {3, 1}, [ESTIMATE] = {3, 1},
    [ENCLOSE] = {8, 4},
};
enum { MOST_ROWS = 8, BLOCK = 64 };

/* Answers n questions: in[row * stride + i], out[row * stride + i].  Not 0: Python has raised. */
typedef int asker(int what, size_t n, size_t stride, const double *in, double *out);

/* The `self` of such a surface.  Any number of threads may share it. */
typedef struct sagitta_function {
    sgt_surface_ops ops;
    asker  *ask;
    double  ball;        /* radius about the origin; 0: none */
    double  lo[3], hi[3]; /* a box; all zero: none */
    double  rounding;    /* the same everywhere; below 0: it is asked */
} sagitta_function;

/* A question as it was asked. */
typedef struct asked {
    const sagitta_function *of;
    question      what;
    size_t        n;        /* at most BLOCK */
    const double *in[MOST_ROWS];
    double       *out[4];
} asked;

/* Questions of one kind that Python is asked at once. */
typedef struct together {
    const sagitta_function *of;
    question what;
    size_t   n, stride;
    double  *in, *out;
} together;

#ifdef SAGITTA_FIBRES
/* A stack of its own.  makecontext begins it.  After that _setjmp and _longjmp go to and fro: swapcontext
 * would ask the kernel for the mask of signals each time. */
typedef struct fibre {
    jmp_buf     place;
    const char *top;        /* of its stack, where it was left */
    ucontext_t  context;
    bool        begun, done;
} fibre;
enum { STACK = 160 * 1024, KINDS = 4, AHEAD = 2 };
#endif

/* What is under way in this thread. */
typedef struct run {
    bool failed, no_memory;
    struct sagitta_call *call;
    size_t next;    /* the next ray that no block has */
#ifdef SAGITTA_FIBRES
    jmp_buf  home;
    fibre   *now;   /* NULL: not in a fibre */
    together kind[KINDS];
#endif
} run;
static _Thread_local run *current;

/* Puts a question behind the others of its kind, while its rows are in the nearest cache. */
static size_t put(together *all, const asked *q)
{
    size_t at = all->n;
    all->of = q->of, all->what = q->what, all->n += q->n;
    for (size_t row = 0; row < rows_of[q->what].in; row++)
        memcpy(all->in + row * all->stride + at, q->in[row], q->n * sizeof(double));
    return at;
}

static void take(const together *all, size_t at, const asked *q)
{
    for (size_t row = 0; row < rows_of[q->what].out; row++)
        memcpy(q->out[row], all->out + row * all->stride + at, q->n * sizeof(double));
}

static bool ask_python(const together *all)
{
    return all->of->ask((int)all->what, all->n, all->stride, all->in, all->out) == 0;
}

#ifdef SAGITTA_FIBRES
/* Leaves the fibre that is under way, until it is called again. */
static void leave(run *r)
{
    r->now->top = __builtin_frame_address(0);
    if (_setjmp(r->now->place) == 0) _longjmp(r->home, 1);
}

/* Where questions of this kind are put together.  If there are too many kinds, this one waits for a round. */
static together *kind_of(run *r, const asked *q)
{
    for (;; leave(r)) {
        if (r->failed) return NULL;
        for (int k = 0; k < KINDS; k++) {
            together *all = &r->kind[k];
            if (all->n == 0 || (all->of == q->of && all->what == q->what)) return all;
        }
    }
}
#endif

/* Answers a question now.  (By itself: this room would push apart what a fibre needs to go on.) */
static __attribute__((noinline)) bool answer_now(const asked *q)
{
    double room[(MOST_ROWS + 4) * BLOCK];
    together all = {.stride = BLOCK, .in = room, .out = room + MOST_ROWS * BLOCK};
    put(&all, q);
    if (!ask_python(&all)) return false;
    take(&all, 0, q);
    return true;
}

/* Answers a question, now or together with others. */
static void answer(const asked *q)
{
    run *r = current;
    bool done = false;
    if (!r || !r->failed) {
#ifdef SAGITTA_FIBRES
        if (r && r->now) {
            together *all = kind_of(r, q);
            size_t at = all ? put(all, q) : 0;
            if (all) leave(r);
            done = !r->failed;
            if (done) take(all, at, q);
        } else
#endif
        {
            done = answer_now(q);
            if (r) r->failed = !done;
        }
    }
    for (size_t row = 0; !done && row < rows_of[q->what].out; row++)
        for (size_t i = 0; i < q->n; i++) q->out[row][i] = (double)NAN;
}

static void function_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    for (size_t from = 0; from < n; from += BLOCK) {
        asked q = {.of = self, .what = out.grad[0] ? VALUE_GRAD : VALUE, .n = n - from};
        if (q.n > BLOCK) q.n = BLOCK;
        q.out[0] = out.f + from;
        for (size_t k = 0; k < 3; k++) {
            q.in[k] = p.p[k] + from;
            if (out.grad[0]) q.out[k + 1] = out.grad[k] + from;
        }
        answer(&q);
    }
}

static double function_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double f, g[3];
    sgt_values out = {&f, {NULL, NULL, NULL}};
    for (int k = 0; k < 3 && grad; k++) out.grad[k] = &g[k];
    function_values(self, 1, (sgt_points){{&p.x, &p.y, &p.z}}, out);
    if (grad) *grad = (sgt_vec3){g[0], g[1], g[2]};
    return f;
}

static double at_point(const sagitta_function *of, question what, sgt_vec3 p)
{
    double x;
    answer(&(asked){of, what, 1, {&p.x, &p.y, &p.z}, {&x}});
    return x;
}

static double function_rounding(const void *self, sgt_vec3 p)
{
    const sagitta_function *of = self;
    return of->rounding >= 0 ? of->rounding : at_point(of, ROUNDING, p);
}
static double function_clearance(const void *self, sgt_vec3 p) { return at_point(self, CLEARANCE, p); }
static double function_estimate(const void *self, sgt_vec3 p) { return at_point(self, ESTIMATE, p); }

static sgt_interval function_enclose(const void *self, const sgt_ray *ray, sgt_interval t,
                                     sgt_interval *slope)
{
    sgt_interval f;
    answer(&(asked){self, ENCLOSE, 1,
                    {&ray->o.x, &ray->o.y, &ray->o.z, &ray->d.x, &ray->d.y, &ray->d.z, &t.lo, &t.hi},
                    {&f.lo, &f.hi, &slope->lo, &slope->hi}});
    return f;
}

static void function_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                              sgt_enclosures out)
{
    double unwanted[2][BLOCK];
    for (size_t from = 0; from < n; from += BLOCK) {
        asked q = {.of = self, .what = ENCLOSE, .n = n - from < BLOCK ? n - from : BLOCK,
                   .in = {[6] = t_lo + from, [7] = t_hi + from},
                   .out = {out.lo + from, out.hi + from, unwanted[0], unwanted[1]}};
        for (size_t k = 0; k < 3; k++) q.in[k] = rays.o[k] + from, q.in[3 + k] = rays.d[k] + from;
        if (out.slope_lo) q.out[2] = out.slope_lo + from, q.out[3] = out.slope_hi + from;
        answer(&q);
    }
}

/* Where the ray is in a ball or a box, made wider by more than all roundings of these few steps: a part in
 * 2^40 of the lengths at hand.  A ray that only just misses is said to pass. */
static sgt_span function_span(const void *self, const sgt_ray *ray)
{
    const sagitta_function *of = self;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    const double soft = 1.0 / ((size_t)1 << 40);
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = (double)NAN};
    if (of->ball > 0) {
        double size = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))), dd = 0, od = 0, cc = 0, u[3];
        for (int k = 0; k < 3; k++) u[k] = d[k] / size, dd += u[k] * u[k], od += o[k] * u[k];
        double nearest = -od / dd, reach = fabs(nearest) * sqrt(dd);
        for (int k = 0; k < 3; k++) {
            double x = o[k] + nearest * u[k];
            cc += x * x;
        }
        double wide = of->ball + soft * (of->ball + reach + sqrt(cc)), left = wide * wide - cc;
        if (left < 0) return (sgt_span){.lo = 1, .hi = 0, .seed = (double)NAN};
        double half = sqrt(left / dd) + soft * (reach + of->ball);
        span.lo = (nearest - half) / size, span.hi = (nearest + half) / size;
    }
    for (int k = 0; k < 3 && (of->lo[k] < of->hi[k]); k++) {
        double wide = soft * (fabs(of->lo[k]) + fabs(of->hi[k]) + fabs(o[k])),
               lo = of->lo[k] - wide, hi = of->hi[k] + wide;
        if (d[k] == 0) {
            if (o[k] < lo || o[k] > hi) return (sgt_span){.lo = 1, .hi = 0, .seed = (double)NAN};
            continue;
        }
        double a = (lo - o[k]) / d[k], b = (hi - o[k]) / d[k];
        span.lo = fmax(span.lo, fmin(a, b)), span.hi = fmin(span.hi, fmax(a, b));
    }
    return span;
}

/* How many bytes such a surface has, aligned as a double. */
SGT_API size_t sagitta_function_size(void);
size_t sagitta_function_size(void) { return sizeof(sagitta_function); }

/* Makes one.  The table of its operations begins where it begins.  rounding: the same everywhere; below 0: it
 * is asked.  with: which questions it answers, the sum of 1 << question. */
SGT_API void sagitta_function_begin(sagitta_function *of, asker *ask, double ball, const double lo[3],
                                    const double hi[3], double rounding, int with);
void sagitta_function_begin(sagitta_function *of, asker *ask, double ball, const double lo[3],
                            const double hi[3], double rounding, int with)
{
    *of = (sagitta_function){.ask = ask, .ball = ball, .rounding = rounding};
    for (int k = 0; k < 3; k++) of->lo[k] = lo[k], of->hi[k] = hi[k];
    of->ops = (sgt_surface_ops){
        .name = "python",
        .size = sizeof(sgt_surface_ops),
        .value = function_value,
        .span = ball > 0 || lo[0] < hi[0] ? function_span : NULL,
        .rounding = rounding >= 0 || (with & 1 << ROUNDING) ? function_rounding : NULL,
        .clearance = with & 1 << CLEARANCE ? function_clearance : NULL,
        .estimate = with & 1 << ESTIMATE ? function_estimate : NULL,
        .enclose = with & 1 << ENCLOSE ? function_enclose : NULL,
        .encloses = with & 1 << ENCLOSE ? function_encloses : NULL,
        .values = function_values,
    };
}

/* --------------------------------------------------------------------- the calls */

typedef enum task { INTERSECT, ALL, TRACE, GRADIENT, AIM, CHECK, LEAVE, VALUES, SINGLE } task;

typedef struct sagitta_call {
    int    task;
    int    python;             /* some surface is a function of Python */
    size_t begin, end;         /* which rays */
    size_t met;                /* out: how many were met, passed or aimed */
    size_t blocks;             /* under way at once; 0 and 1: no fibres */
    const sgt_options *opt;
    sgt_surface surface;
    sgt_rays rays;
    sgt_hits hits;
    /* ALL: hit[ray * cap ...], and how many there are, which may be more than cap */
    int      cap;
    int     *count;
    sgt_hit *hit;
    /* TRACE, GRADIENT, AIM */
    size_t elements;
    const sgt_element  *element;
    double              index_before;
    sgt_traced          traced;
    const sgt_passages *passages;  /* NULL, or one for each element */
    /* GRADIENT: rows of weights; gradient[(ray * rows + row) * parameters + j]; ends[ray].  lacks: out */
    size_t rows, parameters;
    const sgt_ray_change *weight;
    double         *gradient;
    sgt_ray_change *ends;
    int             lacks;
    /* by the numbers of phases; [(ray * rows + row) * phases + j], if there are any */
    size_t  phases;
    double *phase_gradient;
    /* AIM: point[ray] on element number `elements` */
    const sgt_beam *beam;
    const sgt_vec2 *point;
    const sgt_aim_options *aim;
    sgt_aiming     *aiming;
    /* CHECK */
    const sgt_ray *ray;
    sgt_vec3      *where;
    int            fault;
    /* LEAVE */
    sgt_starts   starts;
    signed char *side;
    /* SINGLE */
    sgt_rays_f rays_f;
    sgt_hits_f hits_f;
} sagitta_call;

static const double *plus(const double *x, size_t from) { return x ? x + from : NULL; }
static double *offset(double *x, size_t from) { return x ? x + from : NULL; }

static sgt_rays rays_at(const sgt_rays *all, size_t from)
{
    sgt_rays rays = {.tmin = plus(all->tmin, from), .tmax = plus(all->tmax, from)};
    for (int k = 0; k < 3; k++) rays.o[k] = plus(all->o[k], from), rays.d[k] = plus(all->d[k], from);
    return rays;
}

static sgt_ray ray_at(const sgt_rays *all, size_t i)
{
    return sgt_ray_between((sgt_vec3){all->o[0][i], all->o[1][i], all->o[2][i]},
                           (sgt_vec3){all->d[0][i], all->d[1][i], all->d[2][i]},
                           all->tmin ? all->tmin[i] : 0, all->tmax ? all->tmax[i] : HUGE_VAL);
}

static sgt_hits hits_at(const sgt_hits *all, size_t from)
{
    sgt_hits hits = {.status = all->status ? all->status + from : NULL,
                     .evals = all->evals ? all->evals + from : NULL,
                     .t = offset(all->t, from), .t_err = offset(all->t_err, from),
                     .t_lo = offset(all->t_lo, from), .p_err = offset(all->p_err, from)};
    for (int k = 0; k < 3; k++) hits.p[k] = offset(all->p[k], from), hits.n[k] = offset(all->n[k], from);
    return hits;
}

static const float *plus_f(const float *x, size_t from) { return x ? x + from : NULL; }
static float *offset_f(float *x, size_t from) { return x ? x + from : NULL; }

static size_t single_part(const sagitta_call *c, size_t from, size_t n)
{
    const sgt_rays_f *in = &c->rays_f;
    const sgt_hits_f *to = &c->hits_f;
    sgt_rays_f rays = {.tmin = plus_f(in->tmin, from), .tmax = plus_f(in->tmax, from)};
    sgt_hits_f hits = {.status = to->status ? to->status + from : NULL, .t = offset_f(to->t, from),
                       .t_err = offset_f(to->t_err, from), .p_err = offset_f(to->p_err, from)};
    for (int k = 0; k < 3; k++) {
        rays.o[k] = plus_f(in->o[k], from), rays.d[k] = plus_f(in->d[k], from);
        hits.p[k] = offset_f(to->p[k], from), hits.n[k] = offset_f(to->n[k], from);
    }
    return sgt_intersect_batch_f(c->surface, n, rays, hits, c->opt);
}

static sgt_starts starts_at(const sgt_starts *all, size_t from)
{
    sgt_starts starts = {.p_err = plus(all->p_err, from), .tmax = plus(all->tmax, from)};
    for (int k = 0; k < 3; k++)
        starts.p[k] = plus(all->p[k], from), starts.n[k] = plus(all->n[k], from),
        starts.d[k] = plus(all->d[k], from);
    return starts;
}

/* Traces rays; passages are told anew for the part, `room` of them. */
static size_t trace_part(const sagitta_call *c, size_t from, size_t n, sgt_passages *room)
{
    const sgt_traced *all = &c->traced;
    sgt_traced traced = {.fate = all->fate ? all->fate + from : NULL,
                         .passed = all->passed ? all->passed + from : NULL, .opl = offset(all->opl, from)};
    for (int k = 0; k < 3; k++) traced.o[k] = offset(all->o[k], from), traced.d[k] = offset(all->d[k], from);
    for (size_t e = 0; e < c->elements && room; e++) {
        const sgt_passages *p = &c->passages[e];
        room[e] = (sgt_passages){.hits = hits_at(&p->hits, from), .opl = offset(p->opl, from)};
        for (int k = 0; k < 3; k++) room[e].direction[k] = offset(p->direction[k], from);
    }
    return sgt_trace_batch(c->elements, c->element, c->index_before, n, rays_at(&c->rays, from), traced, room,
                           c->opt);
}

/* The ends of one ray and their gradients. */
static size_t gradient_of(sagitta_call *c, size_t i, sgt_passage *passage)
{
    sgt_ray launch = ray_at(&c->rays, i), ray = launch;
    sgt_fate fate;
    size_t n = c->elements, numbers = c->rows * c->parameters;
    size_t passed = sgt_trace(n, c->element, c->index_before, &ray, passage, &fate, c->opt);
    double *gradient = c->gradient + i * numbers;
    const size_t waves = c->rows * c->phases;
    double *by_phase = waves ? c->phase_gradient + i * waves : NULL;
    const double none = (double)NAN;
    c->traced.fate[i] = fate, c->traced.passed[i] = (int)passed;
    c->ends[i] = (sgt_ray_change){{none, none, none}, {none, none, none}, none};
    if (passed < n) {
        for (size_t j = 0; j < numbers; j++) gradient[j] = none;
        for (size_t j = 0; j < waves; j++) by_phase[j] = none;
        return 0;
    }
    const sgt_passage *last = &passage[n - 1];
    c->ends[i] = (sgt_ray_change){last->hit.p, last->direction, last->opl};
    c->lacks |= sgt_trace_gradient(n, c->element, c->index_before, &launch, passage, c->rows, c->weight,
                                   gradient);
    if (waves)
        c->lacks |= sgt_phase_gradient(n, c->element, c->index_before, &launch, passage, c->rows, c->weight,
                                       by_phase);
    return 1;
}

/* F at the points rays.o, to hits.t, and its gradient, to hits.n. */
static void values_at(const sagitta_call *c, size_t from, size_t n)
{
    const sgt_surface_ops *ops = c->surface.ops;
    for (size_t i = from; i < from + n; i += BLOCK) {
        size_t many = from + n - i < BLOCK ? from + n - i : BLOCK;
        sgt_points at;
        sgt_values out = {.f = c->hits.t + i};
        for (int k = 0; k < 3; k++) at.p[k] = c->rays.o[k] + i, out.grad[k] = c->hits.n[k] + i;
        if (ops->values) ops->values(c->surface.self, many, at, out);
        for (size_t j = 0; j < many && !ops->values; j++) {
            sgt_vec3 p = {at.p[0][j], at.p[1][j], at.p[2][j]}, gradient;
            out.f[j] = ops->value(c->surface.self, p, &gradient);
            out.grad[0][j] = gradient.x, out.grad[1][j] = gradient.y, out.grad[2][j] = gradient.z;
        }
    }
}

/* Some rays of a call.  false: no memory. */
static bool part(sagitta_call *c, size_t from, size_t n)
{
    size_t room = c->task == TRACE ? sizeof(sgt_passages) : sizeof(sgt_passage);
    bool needs = c->task == GRADIENT || c->task == AIM || (c->task == TRACE && c->passages);
    void *work = needs ? malloc((c->elements + 1) * room) : NULL;
    if (needs && !work) return false;
    switch ((task)c->task) {
    case INTERSECT:
        c->met += sgt_intersect_batch(c->surface, n, rays_at(&c->rays, from), hits_at(&c->hits, from),
                                      c->opt);
        break;
    case ALL:
        for (size_t i = from; i < from + n; i++) {
            c->count[i] = sgt_intersect_all(c->surface, ray_at(&c->rays, i), c->cap,
                                            c->hit + i * (size_t)c->cap, c->opt);
            c->met += c->count[i] > 0;
        }
        break;
    case TRACE: c->met += trace_part(c, from, n, work); break;
    case GRADIENT:
        for (size_t i = from; i < from + n; i++) c->met += gradient_of(c, i, work);
        break;
    case AIM:
        for (size_t i = from; i < from + n; i++)
            c->met += sgt_aim(c->elements, c->element, c->index_before, c->beam, c->point[i], work, c->aim,
                              &c->aiming[i]) == SGT_MET;
        break;
    case LEAVE:
        c->met += sgt_leave_batch(c->surface, n, starts_at(&c->starts, from), hits_at(&c->hits, from),
                                  c->side ? c->side + from : NULL, c->opt);
        break;
    case VALUES: values_at(c, from, n); break;
    case SINGLE: c->met += single_part(c, from, n); break;
    case CHECK: c->fault = (int)sgt_check(c->surface, n, c->ray + from, c->where); break;
    }
    free(work);
    return true;
}

#ifdef SAGITTA_FIBRES
static void fibre_main(void)
{
    run *r = current;
    fibre *f = r->now;
    while (!r->failed && r->next < r->call->end) {
        size_t from = r->next, n = r->call->end - from < BLOCK ? r->call->end - from : BLOCK;
        r->next += n;
        if (!part(r->call, from, n)) r->no_memory = r->failed = true;
    }
    f->done = true;
    _longjmp(r->home, 1);
}

/* (By itself: getcontext may come back twice, for all that the compiler knows.) */
static void give_stack(fibre *f, char *stack)
{
    getcontext(&f->context);
    f->context.uc_stack.ss_sp = stack, f->context.uc_stack.ss_size = STACK;
    makecontext(&f->context, fibre_main, 0);
}

/* Goes on with a fibre until it asks or is done. */
static void go_on(run *r, fibre *f)
{
    r->now = f;
    if (_setjmp(r->home) == 0) {
        if (f->begun) _longjmp(f->place, 1);
        f->begun = true;
        setcontext(&f->context);
    }
    r->now = NULL;
}

/* Fetches what a fibre needs first to go on: by its turn others have pushed it out of the nearer caches. */
static void fetch(const fibre *f)
{
    enum { LINE = 64, LINES = 16 };
    if (f->done || !f->begun) return;
    for (size_t i = 0; i < sizeof f->place; i += LINE) __builtin_prefetch((const char *)&f->place + i);
    for (size_t i = 0; i < LINES; i++) __builtin_prefetch(f->top + i * LINE);
}

/* Room for stacks.  Some pages of each are in use at a time: of 4096 bytes they are more than the processor
 * keeps addresses of (128 blocks: 25 % slower), so larger pages are asked for. */
static char *stacks_of(size_t count)
{
    const size_t large = (size_t)1 << 21;
    size_t size = count * STACK;
    if (size < large) return malloc(size);
    char *stacks = aligned_alloc(large, (size + large - 1) / large * large);
#ifdef MADV_HUGEPAGE
    if (stacks) (void)madvise(stacks, size / large * large, MADV_HUGEPAGE);
#endif
    return stacks;
}

/* Does all rays, `count` blocks at a time. */
static void in_fibres(run *r, size_t count)
{
    /* (24 more: rows at the same place modulo 4096 would push each other out of the cache.) */
    size_t stride = count * BLOCK + 24, rows = MOST_ROWS + 4;
    fibre *all = calloc(count, sizeof *all);
    char *stacks = stacks_of(count);
    double *room = malloc(KINDS * rows * stride * sizeof *room);
    size_t alive = all && stacks && room ? count : 0;
    r->no_memory = alive == 0;
    for (size_t k = 0; k < alive; k++) give_stack(&all[k], stacks + k * STACK);
    for (size_t k = 0; k < KINDS && alive; k++) {
        double *in = room + k * rows * stride;
        r->kind[k] = (together){.stride = stride, .in = in, .out = in + MOST_ROWS * stride};
    }
    while (alive > 0) {
        alive = 0;
        for (size_t k = 0; k < count; k++) {
            if (k + AHEAD < count) fetch(&all[k + AHEAD]);
            if (all[k].done) continue;
            go_on(r, &all[k]);
            alive += !all[k].done;
        }
        for (size_t k = 0; k < KINDS; k++) {
            if (r->kind[k].n && !r->failed && !ask_python(&r->kind[k])) r->failed = true;
            r->kind[k].n = 0;
        }
    }
    free(room), free(stacks), free(all);
}
#endif

/* Does rays [begin, end) of a call.  0: done.  1 ... 7: the arithmetic is not as it has to be, and nothing
 * was done.  -1: Python has raised.  -2: no memory. */
SGT_API int sagitta_run(sagitta_call *call);
int sagitta_run(sagitta_call *call)
{
    int bad = sgt_arithmetic();
    if (bad) return bad;
    call->met = 0, call->lacks = 0;
    if (!call->python) return part(call, call->begin, call->end - call->begin) ? 0 : -2;
    run *outer = current, here = {.call = call, .next = call->begin}; /* a function may itself call */
    current = &here;
    bool done = true;
#ifdef SAGITTA_FIBRES
    size_t blocks = (call->end - call->begin + BLOCK - 1) / BLOCK;
    if (blocks > call->blocks) blocks = call->blocks;
    if (blocks > 1 && call->task != CHECK) {
        in_fibres(&here, blocks);
        done = !here.no_memory;
    } else
#endif
    if (call->task == CHECK) {
        done = part(call, call->begin, call->end - call->begin);
    } else {
        for (; done && !here.failed && here.next < call->end; here.next += BLOCK) {
            size_t left = call->end - here.next;
            done = part(call, here.next, left < BLOCK ? left : BLOCK);
        }
    }
    current = outer;
    return !done ? -2 : here.failed ? -1 : 0;
}

/* One ray, its ends as they stand, and all there is to say of it.  Returns as sagitta_run. */
SGT_API int sagitta_one(const sgt_surface *surface, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);
int sagitta_one(const sgt_surface *surface, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit)
{
    int bad = sgt_arithmetic();
    if (bad) return bad;
    run *outer = current, here = {0};
    current = &here;
    *hit = sgt_intersect(*surface, sgt_ray_between(ray->o, ray->d, ray->tmin, ray->tmax), opt);
    current = outer;
    return here.failed ? -1 : 0;
}

/* ------------------------------------------------------------ answers in one block */

/* The columns that a block may have.  Doubles stand first, in this order, then evals, then statuses.  Each
 * column is n numbers, a vector three times n: so each is aligned as the block is. */
enum { STATUS, EVALS, T, T_ERR, T_LO, P, N, P_ERR, DIRECTION, OPL, COLUMNS };

/* The columns `names`, the sum of 1 << column, for n rays. */
static sgt_passages columns_of(void *block, size_t n, size_t names)
{
    sgt_passages c = {.opl = NULL};
    const struct { double **to; int rows; } of[COLUMNS] = {
        [T] = {&c.hits.t, 1}, [T_ERR] = {&c.hits.t_err, 1}, [T_LO] = {&c.hits.t_lo, 1}, [P] = {c.hits.p, 3},
        [N] = {c.hits.n, 3}, [P_ERR] = {&c.hits.p_err, 1},
        [DIRECTION] = {c.direction, 3}, [OPL] = {&c.opl, 1},
    };
    double *next = block;
    for (size_t k = T; k < COLUMNS; k++)
        for (int row = 0; names >> k & 1 && row < of[k].rows; row++, next += n) of[k].to[row] = next;
    int *evals = (void *)next;
    if (names >> EVALS & 1) c.hits.evals = evals, evals += n;
    if (names >> STATUS & 1) c.hits.status = (void *)evals;
    return c;
}

/* The same of rays through a lens. */
enum { FATE, PASSED, END_O, END_D, END_OPL };
static sgt_traced ends_of(void *block, size_t n, size_t names)
{
    sgt_traced c = {.opl = NULL};
    double *next = block;
    for (size_t k = 0; names >> END_O & 1 && k < 3; k++, next += n) c.o[k] = next;
    for (size_t k = 0; names >> END_D & 1 && k < 3; k++, next += n) c.d[k] = next;
    if (names >> END_OPL & 1) c.opl = next, next += n;
    int *passed = (void *)next;
    if (names >> PASSED & 1) c.passed = passed, passed += n;
    if (names >> FATE & 1) c.fate = (void *)passed;
    return c;
}

/* Rays whose rows o[1], o[2], d[1], d[2] are NULL have them one behind another. */
static sgt_rays spread(sgt_rays rays, size_t n)
{
    for (size_t k = 1; k < 3 && !rays.o[2]; k++) rays.o[k] = rays.o[0] + k * n;
    for (size_t k = 1; k < 3 && !rays.d[2]; k++) rays.d[k] = rays.d[0] + k * n;
    return rays;
}

/* Rays that meet a surface. */
typedef struct sagitta_meeting {
    const sgt_surface *surface;
    const sgt_options *opt;
    size_t n;
    void  *hits;
    size_t names;
    sgt_rays rays;
} sagitta_meeting;

/* Rays through a lens.  passages: a block for each element, `pitch` bytes apart; told 0: none. */
typedef struct sagitta_passing {
    size_t elements;
    const sgt_element *element;
    double index_before;
    const sgt_options *opt;
    size_t n;
    void  *traced;
    size_t names;
    char  *passages;
    size_t pitch, told;
    sgt_rays rays;
} sagitta_passing;

/* Both are for surfaces that are no functions of Python, and return as sagitta_run. */
SGT_API int sagitta_meet(const sagitta_meeting *m);
int sagitta_meet(const sagitta_meeting *m)
{
    int bad = sgt_arithmetic();
    if (bad) return bad;
    sgt_intersect_batch(*m->surface, m->n, spread(m->rays, m->n), columns_of(m->hits, m->n, m->names).hits,
                        m->opt);
    return 0;
}

SGT_API int sagitta_pass(const sagitta_passing *s);
int sagitta_pass(const sagitta_passing *s)
{
    int bad = sgt_arithmetic();
    if (bad) return bad;
    sgt_passages *each = s->told ? malloc((s->elements + 1) * sizeof *each) : NULL;
    if (s->told && !each) return -2;
    for (size_t e = 0; e < s->elements && each; e++)
        each[e] = columns_of(s->passages + e * s->pitch, s->n, s->told);
    sgt_trace_batch(s->elements, s->element, s->index_before, s->n, spread(s->rays, s->n),
                    ends_of(s->traced, s->n, s->names), each, s->opt);
    free(each);
    return 0;
}

/* sagitta_one with nothing in it, to measure what a call costs by itself. */
SGT_API int sagitta_nothing(const sgt_surface *surface, const sgt_ray *ray, const sgt_options *opt,
                            sgt_hit *hit);
int sagitta_nothing(const sgt_surface *surface, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit)
{
    (void)surface, (void)ray, (void)opt, (void)hit;
    return 0;
}

/* --------------------------------------------------------------------- what a designer asks */

/* What one share of a study has written, and how much of it was read. */
typedef struct sagitta_part { const char *at; size_t size, taken; } sagitta_part;

/* The rows of an analysis, one behind another, and what was said: sentences, each with an 'n' (a note) or an
 * 'l' (a legend) in front and a zero byte at its end.
 *
 * of is not 0: share `number` of so many, which is written behind `part`; or, number 0, all of the study, read
 * from given[0 ... of - 1]. */
typedef struct sagitta_answer {
    char *row;
    size_t rows, room, size;
    char *words;
    size_t length, words_room;
    int threads;
    bool no_memory;
    sgt_fates fates;
    size_t number, of;
    sgt_shard *shard;
    char *part;
    size_t part_size, part_room;
    sagitta_part *given;
} sagitta_answer;

/* Room for `more` bytes behind `used`; NULL: none, and *at is as before. */
static char *more_room(sagitta_answer *a, char **at, size_t used, size_t *room, size_t more)
{
    if (used + more > *room) {
        char *grown = realloc(*at, 2 * *room + more);
        a->no_memory = a->no_memory || !grown;
        if (!grown) return NULL;
        *at = grown, *room = 2 * *room + more;
    }
    return *at + used;
}

static void keep_row(void *context, const void *row)
{
    sagitta_answer *a = context;
    char *to = more_room(a, &a->row, a->rows * a->size, &a->room, a->size);
    if (to) memcpy(to, row, a->size), a->rows++;
}

static void keep_words(void *context, sgt_remark_of_study kind, const char *sentence)
{
    sagitta_answer *a = context;
    const size_t length = strlen(sentence) + 2;
    char *to = more_room(a, &a->words, a->length, &a->words_room, length);
    if (!to) return;
    *to = kind == SGT_STUDY_NOTE ? 'n' : 'l';
    memcpy(to + 1, sentence, length - 1), a->length += length;
}

static bool write_part(void *context, size_t size, const void *bytes)
{
    sagitta_answer *a = context;
    char *to = more_room(a, &a->part, a->part_size, &a->part_room, size);
    if (to) memcpy(to, bytes, size), a->part_size += size;
    return to;
}

static bool read_part(void *context, size_t number, size_t size, void *bytes)
{
    const sagitta_answer *a = context;
    sagitta_part *p = &a->given[number - 1];
    if (size > p->size - p->taken) return false;
    memcpy(bytes, p->at + p->taken, size), p->taken += size;
    return true;
}

/* Tasks in threads: each takes the next that is left. */
typedef struct crew {
    void (*one)(void *data, size_t i);
    void *data;
    size_t tasks;
    atomic_size_t next;
} crew;

static void *work_on(void *of)
{
    crew *c = of;
    for (size_t i; (i = atomic_fetch_add(&c->next, 1)) < c->tasks;) c->one(c->data, i);
    return NULL;
}

static void in_threads(void *context, size_t tasks, void (*one)(void *data, size_t i), void *data)
{
    enum { MOST = 1024 };
    const sagitta_answer *a = context;
    pthread_t thread[MOST];
    crew c = {.one = one, .data = data, .tasks = tasks};
    size_t others = 0, wanted = (size_t)a->threads - 1;
    if (wanted >= tasks) wanted = tasks - 1;
    while (others < wanted && others < MOST && pthread_create(&thread[others], NULL, work_on, &c) == 0) others++;
    work_on(&c);
    for (size_t i = 0; i < others; i++) pthread_join(thread[i], NULL);
}

/* A study that works in answer->threads; the answer lasts as long as it, and is forgotten after it. */
SGT_API sgt_study *sagitta_study(const sgt_lens *lens, sgt_study_options *opt, sagitta_answer *answer,
                                 sgt_error *error);
sgt_study *sagitta_study(const sgt_lens *lens, sgt_study_options *opt, sagitta_answer *answer,
                         sgt_error *error)
{
    if (answer->threads > 1) opt->run = in_threads, opt->context = answer;
    if (answer->of) {
        opt->shard = answer->shard = malloc(sizeof *answer->shard);
        answer->no_memory = !answer->shard;
        if (!answer->shard) return NULL;
        *answer->shard = (sgt_shard){.number = answer->number, .of = answer->of, .context = answer,
                                     .write = write_part, .read = read_part};
    }
    return sgt_study_new(lens, opt, error);
}

SGT_API bool sagitta_ask(const sgt_study *study, const sgt_analysis *analysis, const void *options,
                         sagitta_answer *answer, sgt_error *error);
bool sagitta_ask(const sgt_study *study, const sgt_analysis *analysis, const void *options,
                 sagitta_answer *answer, sgt_error *error)
{
    const sgt_sink sink = {.context = answer, .row = keep_row, .say = keep_words};
    sgt_study_total total;
    answer->size = analysis->row_size;
    if (!sgt_study_run(study, analysis, options, &sink, &total, error)) return false;
    answer->fates = total.fates;
    return true;
}

/* Tolerances that are asked about in answer->threads; the answer lasts as long as they. */
SGT_API sgt_tolerancing *sagitta_tolerancing(const sgt_lens *lens, sgt_tolerancing_options *opt,
                                             sgt_study_options *study, sagitta_answer *answer,
                                             sgt_error *error);
sgt_tolerancing *sagitta_tolerancing(const sgt_lens *lens, sgt_tolerancing_options *opt,
                                     sgt_study_options *study, sagitta_answer *answer, sgt_error *error)
{
    if (answer->threads > 1) study->run = in_threads, study->context = answer;
    opt->study = study;
    return sgt_tolerancing_new(lens, opt, error);
}

/* Where trials go: the figure of each, and `entries` numbers. */
typedef struct trials_to { double *figure, *value; size_t entries; } trials_to;

static void keep_trial(void *context, const sgt_trial *trial)
{
    trials_to *to = context;
    *to->figure++ = trial->figure;
    if (to->entries) memcpy(to->value, trial->value, to->entries * sizeof *to->value);
    to->value += to->entries;
}

SGT_API bool sagitta_trials(const sgt_tolerancing *t, size_t entries, uint64_t seed, uint64_t first,
                            uint64_t count, double figure[], double value[], sgt_error *error);
bool sagitta_trials(const sgt_tolerancing *t, size_t entries, uint64_t seed, uint64_t first, uint64_t count,
                    double figure[], double value[], sgt_error *error)
{
    trials_to to = {figure, value, entries};
    return sgt_tolerancing_trials(t, seed, first, count, keep_trial, &to, error);
}

SGT_API void sagitta_forget(sagitta_answer *answer);
void sagitta_forget(sagitta_answer *answer)
{
    free(answer->row), free(answer->words), free(answer->part), free(answer->shard);
    answer->row = answer->words = answer->part = NULL, answer->shard = NULL;
}

/* Adds rays to sums by columns: the points x, y (NULL: of a wavefront) and the bounds of their errors, or path
 * differences and theirs; weights; which of the rays count as passed. */
typedef struct sagitta_summands {
    size_t n;
    const double *x, *y, *opd, *error, *weight;
    const bool *passed;
} sagitta_summands;

SGT_API void sagitta_sums_add(sgt_sums *sums, const sagitta_summands *of);
void sagitta_sums_add(sgt_sums *sums, const sagitta_summands *of)
{
    sgt_ray_end end[BLOCK];
    for (size_t first = 0, n; first < of->n; first += n) {
        n = of->n - first < BLOCK ? of->n - first : BLOCK;
        memset(end, 0, sizeof end);
        for (size_t i = 0; i < n; i++) {
            end[i].fate = of->passed[first + i] ? SGT_PASSED : SGT_MISSED;
            end[i].weight = of->weight[first + i], end[i].p_err = of->error[first + i];
            if (of->x) end[i].p.x = of->x[first + i], end[i].p.y = of->y[first + i];
        }
        sgt_sums_add(sums, n, end, of->opd ? of->opd + first : NULL, of->opd ? of->error + first : NULL);
    }
}

/* ------------------------------------------------ what the structs of Python are held to */

typedef struct layout { const char *type, *member; size_t at, size; } layout;
#define WHOLE(type) {#type, "", 0, sizeof(type)}
#define MEMBER(type, member) {#type, #member, offsetof(type, member), sizeof(((type *)0)->member)}
#include "layouts.h"

/* The members of the structs that Python mirrors.  Ends with a row of zeros. */
SGT_API const layout *sagitta_layouts(void);
const layout *sagitta_layouts(void) { return layouts; }
