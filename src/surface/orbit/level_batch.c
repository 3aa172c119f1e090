// SPDX-License-Identifier: MIT
/* level_batch.c - first hits of many rays on a level set with p = 2: the march of level.c, one ray in each
 * lane.
 *
 * IN FLOATS the march begins (march_f.h).  Each lane carries the current cell of one ray at its own level of
 * the orbit, with its own E_k.  One step takes every lane one level further.  An outside cell is followed by
 * the next, an open one by a shorter one, in vector code without a branch.  Where floats end, the ray
 * leaves its lane, and the lane takes the next ray.  A decided cell waits until its lane's pulse of levels
 * ends.  A longer pulse leaves more lanes idle; a shorter one needs more control.  Three levels take 2 to
 * 6 % less time than two.
 *
 * THE STREAM is the same march in double, with pulses of two levels.  It takes rays that come back from the
 * surface.  It goes on when all its lanes are taken, or no ray is left in floats.
 *
 * Measured for c = (-0.083, 0, -0.83, -0.025), N = 7, 320 x 240 rays, beside the same march all in double:
 * 0.77 of the time with AVX-512 and 0.74 with AVX2 (Zen 4).  At N = 11 it is 0.70 and 0.67, for c = i and
 * N = 16 0.69 and 0.66.  floats_julia takes 34 % of it, look_near_julia 14, stream_settle 12.
 *
 * WHY APART.  Without it (lanes = NULL) each ray goes to level.c by itself: 2.3 and 2.7 times the
 * instructions with AVX2 (a picture of a Julia set and of a Mandelbrot set).
 *
 * THE FAST WAY.  An estimate is a short orbit with much work after it, so the lanes take whole orbits
 * together.  A change of sign goes to `near`.
 *
 * NEAR THE SURFACE.  Cells that may be inside or monotone go on to level N, all lanes of `near` together,
 * with the bound d of orbit.h on the way.  The same lanes narrow the bracket of a root.  decide and narrow
 * of course.h settle them one by one.
 *
 * HITS.  The point and the gradient are computed in vector code over hits.
 *
 * If a root is not accepted, such as that at the start of a ray that begins on the surface, its ray goes
 * back to the stream.
 *
 * What decide calls RARE (an undecided stretch) is left to the single ray.  The answers are those of the
 * single ray, bit for bit: both use the formulas of cell.h and course.h. */
#include "level.h"

#include "march_f.h"
#include "../../solve/root.h"

/* LANES: of the march in floats.  WIDTH: of that in double. */
enum { LANES = 32, WIDTH = 16, WAITING = 8, HITS = 8 };

/* A ray in its march.  Each number is a row. */
enum field {
    SA, SB, SC, SD, LA, LB, LC, LD, START_SIZE, ALONG_SIZE, TAU, HI, H, GROWTH, SIDE, EVALS, T_TOL, LEAST,
    LEAST_STEP, RAY, FIELDS
};

/* Copies a ray to a column of another width. */
SGT_INLINE void move_ray(double *to, int to_width, const double *from, int width)
{
    for (int i = 0; i < FIELDS; i += 4, to += 4 * to_width, from += 4 * width) {
        double a = from[0], b = from[width], c = from[2 * width], d = from[3 * width];
        to[0] = a, to[to_width] = b, to[2 * to_width] = c, to[3 * to_width] = d;
    }
}

/* On the fast way: where F was last evaluated, F there, and 1 over the length of a unit of tau. */
enum { LAST = H, LAST_F = GROWTH, PER_LENGTH = SIDE };

typedef struct set {
    const orbit *o;
    path path;
    escape escape;
    double E2, budget, dt_min;
    bool proof;
    march_f floats;
} set;

/* A ray in floats (ray_f).  Each number is a row. */
enum field_f {
    FSA, FSB, FSC, FSD, FLA, FLB, FLC, FLD, FSTART_SIZE, FALONG_SIZE, FTAU, FHI, FSTEP, FGROWTH, FSIDE,
    FEVALS, FT_TOL, FLEAST, FIELDS_F
};

/* The march in floats (march_f.h).  f: the ray as double takes it over. */
typedef struct stream_f {
    double f[FIELDS][LANES];
    float r[FIELDS_F][LANES];
    float a[LANES], b[LANES], c[LANES], d[LANES], pa[LANES], pb[LANES], pc[LANES], pd[LANES], e[LANES],
        over[LANES], left[LANES], verdict[LANES];
    float m[LANES], h[LANES], end[LANES], leave[LANES];
} stream_f;

/* m, h, end: the cell.  verdict: see LIVE below.  leave: see go_on. */
typedef struct stream {
    double f[FIELDS][WIDTH];
    double a[WIDTH], b[WIDTH], c[WIDTH], d[WIDTH], va[WIDTH], vb[WIDTH], vc[WIDTH], vd[WIDTH], e[WIDTH],
        over[WIDTH], left[WIDTH];
    double m[WIDTH], h[WIDTH], end[WIDTH], verdict[WIDTH], leave[WIDTH];
} stream;

/* What a lane near the surface wants: the verdict of a cell, a narrower bracket, or the sign of F in the
 * middle of a cell. */
typedef enum errand { MARCH, POLISH, CROSS } errand;

typedef struct near {
    double f[FIELDS][WIDTH];
    double m[WIDTH], h[WIDTH];
    double a[WIDTH], b[WIDTH], c[WIDTH], d[WIDTH], va[WIDTH], vb[WIDTH], vc[WIDTH], vd[WIDTH], e[WIDTH];
    double A2[WIDTH], V2[WIDTH], qv[WIDTH], A[WIDTH], slope[WIDTH], center[WIDTH], live[WIDTH], out[WIDTH];
    double verdict[WIDTH], W[WIDTH], g_err[WIDTH], lo[WIDTH], hi[WIDTH], newton[WIDTH], wide[WIDTH];
    bracket root[WIDTH];
    cell_place at[WIDTH];
    errand task[WIDTH];
    int count;
    unsigned free; /* a bit for each lane without a ray */
} near;

typedef struct waiting {
    double f[FIELDS][WAITING];
    float r[FIELDS_F][WAITING];
    int order[WAITING], count;
} waiting;

/* Rays on their way back to the stream.  They are at most those near the surface and among the hits. */
enum { MOST_BACK = WIDTH + HITS };
typedef struct returned { double f[FIELDS][MOST_BACK]; int count; } returned;

typedef struct hits {
    double o[3][HITS], d[3][HITS], tmin[HITS], tmax[HITS], tau[HITS], tau_err[HITS];
    double t[HITS], t_err[HITS], t_lo[HITS], p[3][HITS], p_err[HITS], l[HITS], m[HITS], n[HITS], scale[HITS];
    /* Q at each level. */
    double a[MOST_LEVELS + 1][HITS], b[MOST_LEVELS + 1][HITS], c[MOST_LEVELS + 1][HITS],
        d_[MOST_LEVELS + 1][HITS];
    /* In the end y is the gradient.  accepted < 0: not to be reported here. */
    double y[4][HITS], sum[4][HITS], far[HITS], accepted[HITS];
    double f[FIELDS][HITS]; /* the ray, for going on if the root is not accepted */
    size_t ray[HITS], count;
} hits;

typedef struct job {
    set *set; /* the ray of its path changes */
    const sgt_tile *tile;
    size_t next, hard;
    int busy; /* lanes of the stream with a ray */
    waiting *waiting;
    returned *back;
    near *near;
    stream_f *floats;
    stream *stream;
    hits *hits;
} job;

/* ------------------------------------------------------------------ the stream */

/* STAY: the ray stays in its lane.  MISSED: the end of the ray is reached.  NEAR: the cell at tau has to be
 * looked at near the surface.  SPENT: the budget is. */
enum { STAY, MISSED, NEAR, SPENT };

/* Lays the next cell if the last is decided, and takes it three levels further. */
SGT_INLINE void fly_f(stream_f *s, int l, const march_f *w, bool mandelbrot)
{
    const ray_f r = {.sa = s->r[FSA][l], .sb = s->r[FSB][l], .sc = s->r[FSC][l], .sd = s->r[FSD][l],
                     .la = s->r[FLA][l], .lb = s->r[FLB][l], .lc = s->r[FLC][l], .ld = s->r[FLD][l],
                     .start_size = s->r[FSTART_SIZE][l], .along_size = s->r[FALONG_SIZE][l]};
    flight_f f = {s->a[l], s->b[l], s->c[l], s->d[l], s->pa[l], s->pb[l], s->pc[l], s->pd[l], s->e[l],
                  s->over[l], s->left[l], s->verdict[l]};
    const cell_f next = lay_f(s->r[FTAU][l], s->r[FHI][l], s->r[FSTEP][l]);
    bool live = f.verdict <= LIVE;
    float old_m = s->m[l], old_h = s->h[l], old_end = s->end[l], m = live ? old_m : next.m,
          h = live ? old_h : next.h, end = live ? old_end : next.end;
    const flight_f n = begin_f(&r, w, m, h, next.odd);
    f.a = live ? f.a : n.a, f.b = live ? f.b : n.b, f.c = live ? f.c : n.c, f.d = live ? f.d : n.d;
    f.pa = live ? f.pa : n.pa, f.pb = live ? f.pb : n.pb, f.pc = live ? f.pc : n.pc,
    f.pd = live ? f.pd : n.pd;
    f.e = live ? f.e : n.e, f.over = live ? f.over : n.over, f.left = live ? f.left : n.left,
    f.verdict = live ? f.verdict : n.verdict;
    on_a_level_f(&f, &n, w, mandelbrot);
    on_a_level_f(&f, &n, w, mandelbrot);
    on_a_level_f(&f, &n, w, mandelbrot);
    s->a[l] = f.a, s->b[l] = f.b, s->c[l] = f.c, s->d[l] = f.d, s->pa[l] = f.pa, s->pb[l] = f.pb,
    s->pc[l] = f.pc, s->pd[l] = f.pd;
    s->e[l] = f.e, s->over[l] = f.over, s->left[l] = f.left, s->verdict[l] = f.verdict, s->m[l] = m,
    s->h[l] = h, s->end[l] = end;
}

/* What follows for decided cells. */
SGT_INLINE float settle_f(stream_f *s, int l, const march_f w)
{
    float verdict = s->verdict[l], h = s->h[l], end = s->end[l], tau = s->r[FTAU][l], hi = s->r[FHI][l],
          step = s->r[FSTEP][l], growth = s->r[FGROWTH][l], side = s->r[FSIDE][l],
          evals = s->r[FEVALS][l], longer = grown_f(growth), shorter = shrunk_f(growth),
          shortest = shortest_f(verdict, side, s->r[FT_TOL][l], s->r[FLEAST][l], w.E2);
    float fine = h > shortest ? verdict : CLOSE;
    verdict = verdict <= CLOSE ? verdict : fine;
    bool out = verdict == OUT, shut = !(verdict <= CLOSE);
    step = shut ? h * 0.5f : step, growth = shut ? shorter : growth, evals = shut ? evals + 1 : evals;
    step = out ? h * longer : step, growth = out ? longer : growth, evals = out ? evals + 1 : evals;
    tau = out ? end : tau, side = out ? 1 : side;
    float leave = evals >= w.budget ? NEAR : STAY, last = tau < hi ? leave : MISSED;
    leave = verdict == CLOSE ? NEAR : leave, leave = out ? last : leave;
    leave = verdict <= LIVE ? STAY : leave;
    s->r[FTAU][l] = tau, s->r[FSTEP][l] = step, s->r[FGROWTH][l] = growth, s->r[FSIDE][l] = side;
    s->r[FEVALS][l] = evals, s->leave[l] = leave;
    return leave;
}

/* A bit for each lane that leaves. */
SGT_INLINE unsigned leaving_of(const float *leave)
{
    unsigned which = 0;
    for (int l = 0; l < LANES; l++) which |= (leave[l] > 0 ? 1U : 0U) << l;
    return which;
}

/* Advances all lanes until one leaves. */
SGT_INLINE unsigned advance_floats(stream_f *s, const set *o, bool mandelbrot)
{
    const march_f w = o->floats;
    float leaving = 0;
    do {
#pragma omp simd
        for (int l = 0; l < LANES; l++) fly_f(s, l, &w, mandelbrot);
        leaving = 0;
#pragma omp simd reduction(+ : leaving)
        for (int l = 0; l < LANES; l++) leaving += settle_f(s, l, w);
    } while (leaving == 0);
    return leaving_of(s->leave);
}

SGT_KERNEL static unsigned floats_julia(stream_f *s, const set *w) { return advance_floats(s, w, false); }
SGT_KERNEL static unsigned floats_mandelbrot(stream_f *s, const set *w) { return advance_floats(s, w, true); }

/* What all lanes share. */
typedef struct shared { quaternion c; circle near; double limit, over, growth, E2, levels, budget; } shared;

/* A cell on its way, and what is known of it. */
typedef struct flight { one q; double over, left, verdict; } flight;

/* Takes a cell one level further, and judges the level before.  (By pointers: on Windows a structure
 * passed by value is in memory, and clang does not vectorise that.) */
SGT_INLINE void on_a_level(flight *s, double h, double h2, const one_constant *c, const quaternion *along,
                           const shared *w, bool mandelbrot)
{
    SGT_COUNT_LEVEL(s->verdict == LIVE && s->left < HUGE_VAL);
    one q = s->q;
    one_norms(&q);
    double A, y = h2 * q.V2, x = fabs(q.qv) * h, E = w->limit + s->over, room;
    one_twice_root(&q.A2, &A);
    one_room(&q, w->near.keep, &E, &x, &y, &room);
    /* What `judge` has to look at, and slightly more: it may be inside, or monotone, or g may be near its
     * rounding. */
    double last = larger(x, 0x1p-29 * q.A2) > STEEP * (1 - 0x1p-40) * y ? CLOSE : q.A2;
    last = (q.A2 + y) + (x + x) < w->E2 ? CLOSE : last;
    double verdict = q.A2 > w->near.far ? HUGE_VAL : LIVE;
    verdict = s->left > 0 ? verdict : last;
    verdict = room > 0 ? OUT : verdict;
    s->verdict = s->verdict == LIVE ? verdict : s->verdict;
    one_step(&q, &A, &y, w->near.round, c, mandelbrot);
    if (mandelbrot) q.va += along->a, q.vb += along->b, q.vc += along->c, q.vd += along->d;
    s->q = q, s->over *= w->growth, s->left -= 1;
}

/* Lays the next cell if the last is decided, and takes it two levels further. */
SGT_INLINE void fly(stream *s, int l, const shared *w, bool mandelbrot)
{
    flight f = {{.a = s->a[l], .b = s->b[l], .c = s->c[l], .d = s->d[l], .va = s->va[l], .vb = s->vb[l],
                 .vc = s->vc[l], .vd = s->vd[l], .e = s->e[l]},
                s->over[l], s->left[l], s->verdict[l]};
    double tau = s->f[TAU][l], rest = s->f[HI][l] - tau, step = s->f[H][l],
           laid = 2 * step > rest ? 0.5 * rest : step, old_m = s->m[l], old_h = s->h[l], old_end = s->end[l];
    double new_m = tau + laid, new_end = new_m + laid, new_h = larger(new_m - tau, new_end - new_m),
           odd = new_m > tau ? LIVE : CLOSE;
    odd = new_end > new_m ? odd : CLOSE;
    bool live = f.verdict == LIVE;
    double m = live ? old_m : new_m, h = live ? old_h : new_h, end = live ? old_end : new_end;
    quaternion v = {s->f[LA][l], s->f[LB][l], s->f[LC][l], s->f[LD][l]};
    quaternion q = {s->f[SA][l] + m * v.a, s->f[SB][l] + m * v.b, s->f[SC][l] + m * v.c,
                    s->f[SD][l] + m * v.d};
    double e = place_error(s->f[START_SIZE][l], s->f[ALONG_SIZE][l], m, h);
    f.q.a = live ? f.q.a : q.a, f.q.b = live ? f.q.b : q.b, f.q.c = live ? f.q.c : q.c,
    f.q.d = live ? f.q.d : q.d;
    f.q.va = live ? f.q.va : v.a, f.q.vb = live ? f.q.vb : v.b, f.q.vc = live ? f.q.vc : v.c,
    f.q.vd = live ? f.q.vd : v.d;
    f.q.e = live ? f.q.e : e, f.over = live ? f.over : w->over, f.left = live ? f.left : w->levels;
    f.verdict = live ? LIVE : odd;
    one_constant c = {w->c.a, w->c.b, w->c.c, w->c.d, 0};
    if (mandelbrot) c = (one_constant){q.a, q.b, q.c, q.d, e};
    double h2 = h * h;
    on_a_level(&f, h, h2, &c, &v, w, mandelbrot);
    on_a_level(&f, h, h2, &c, &v, w, mandelbrot);
    s->a[l] = f.q.a, s->b[l] = f.q.b, s->c[l] = f.q.c, s->d[l] = f.q.d, s->va[l] = f.q.va, s->vb[l] = f.q.vb,
    s->vc[l] = f.q.vc, s->vd[l] = f.q.vd;
    s->e[l] = f.q.e, s->over[l] = f.over, s->left[l] = f.left, s->verdict[l] = f.verdict, s->m[l] = m,
    s->h[l] = h, s->end[l] = end;
}

/* What follows for decided cells.  MISSED: the end of the ray is reached.  NEAR: the cell at tau has to be
 * looked at near the surface, because it may be inside or monotone, it may meet t_tol, or it is too short. */
SGT_INLINE double go_on(stream *s, int l, const shared w)
{
    double verdict = s->verdict[l], h = s->h[l], m = s->m[l], end = s->end[l];
    double tau = s->f[TAU][l], hi = s->f[HI][l], step = s->f[H][l], growth = s->f[GROWTH][l],
           side = s->f[SIDE][l], evals = s->f[EVALS][l];
    double longer = grown(growth), shorter = shrunk(growth);
    /* `decide` may call it ACROSS. */
    double across = side * (w.E2 - verdict), t_tol = across > 0 ? s->f[T_TOL][l] : 0;
    double fine = h <= larger(t_tol, 2 * SGT_U * fabs(m)) ? CLOSE : verdict;
    verdict = verdict <= CLOSE ? verdict : fine;
    bool out = verdict == OUT, shut = !(verdict <= CLOSE);
    step = shut ? h * 0.5 : step, growth = shut ? shorter : growth, evals = shut ? evals + 1 : evals;
    step = out ? h * longer : step, growth = out ? longer : growth, evals = out ? evals + 1 : evals;
    tau = out ? end : tau, side = out ? 1 : side;
    double leave = evals >= w.budget ? NEAR : STAY, last = tau < hi ? leave : MISSED;
    leave = verdict == CLOSE ? NEAR : leave, leave = out ? last : leave,
    leave = verdict == LIVE ? STAY : leave;
    s->f[TAU][l] = tau, s->f[H][l] = step, s->f[GROWTH][l] = growth, s->f[SIDE][l] = side,
    s->f[EVALS][l] = evals;
    s->verdict[l] = verdict, s->leave[l] = leave;
    return leave;
}

/* A bit for each lane that leaves. */
SGT_INLINE unsigned leaving_lanes(const stream *s)
{
    unsigned which = 0;
    for (int l = 0; l < WIDTH; l++) which |= (s->leave[l] > 0 ? 1U : 0U) << l;
    return which;
}

SGT_INLINE unsigned advance(stream *s, const set *o, bool mandelbrot)
{
    const shared w = {.c = o->path.c, .near = circle_of(&o->path), .limit = o->escape.limit,
                      .over = o->escape.over, .growth = o->escape.growth, .E2 = o->E2,
                      .levels = o->path.iterations - (mandelbrot ? 1 : 0), .budget = o->budget};
    double leaving = 0;
    do {
#pragma omp simd
        for (int l = 0; l < WIDTH; l++) fly(s, l, &w, mandelbrot);
        leaving = 0;
#pragma omp simd reduction(+ : leaving)
        for (int l = 0; l < WIDTH; l++) leaving += go_on(s, l, w);
    } while (leaving == 0);
    return leaving_lanes(s);
}

/* Advances all lanes until one leaves. */
SGT_KERNEL static unsigned advance_julia(stream *s, const set *w) { return advance(s, w, false); }
SGT_KERNEL static unsigned advance_mandelbrot(stream *s, const set *w) { return advance(s, w, true); }

/* ---------------------------------------------------------------- the fast way */

/* Uses of the rows on the fast way: a, b, va, e, over: the orbit in its slice (va |rest|^2, e A2, over
 * growth^2).  c, d: Re c and |Im c|.  end: F. */
SGT_INLINE void begin_estimate(stream *s, int l, const estimator fixed, const orbit o, bool mandelbrot)
{
    double tau = s->f[TAU][l];
    quaternion q = {s->f[SA][l] + s->f[LA][l] * tau, s->f[SB][l] + s->f[LB][l] * tau,
                    s->f[SC][l] + s->f[LC][l] * tau, s->f[SD][l] + s->f[LD][l] * tau};
    estimator e = fixed;
    if (mandelbrot) e = estimator_of(&o, q);
    slice_orbit at = slice_orbit_at(&e, q);
    s->a[l] = at.a, s->b[l] = at.b, s->va[l] = at.rest, s->e[l] = at.A2, s->over[l] = 1;
    s->c[l] = e.along_c.a, s->d[l] = e.im;
}

SGT_INLINE void estimate_level(stream *s, int l, const estimator fixed, bool mandelbrot)
{
    estimator e = fixed;
    e.along_c.a = s->c[l], e.im = s->d[l];
    slice_orbit at = {s->a[l], s->b[l], s->va[l], s->e[l], s->over[l]},
                next = slice_orbit_squared(at, &e, mandelbrot);
    SGT_COUNT_LEVEL(at.A2 < FAR_ENOUGH * e.E2);
    bool on = at.A2 < FAR_ENOUGH * e.E2;
    s->a[l] = on ? next.a : at.a, s->b[l] = on ? next.b : at.b, s->va[l] = on ? next.rest : at.rest;
    s->e[l] = on ? next.A2 : at.A2, s->over[l] = on ? next.growth2 : at.growth2;
}

/* MISSED: the end is reached without a change of sign.  NEAR: a change of sign between LAST and TAU, where
 * F is s->end. */
SGT_INLINE double end_estimate(stream *s, int l, const estimator fixed, double budget)
{
    double f, away = estimate_of(&fixed, s->e[l], s->over[l], &f) * s->f[PER_LENGTH][l];
    double tau = s->f[TAU][l], hi = s->f[HI][l], last = s->f[LAST][l], last_f = s->f[LAST_F][l],
           evals = s->f[EVALS][l] + 1, ray = s->f[RAY][l];
    double next = tau + larger(away, s->f[LEAST_STEP][l]), leave = next > tau ? STAY : SPENT;
    next = next > hi ? hi : next;
    leave = evals >= budget ? SPENT : leave, leave = tau < hi ? leave : MISSED;
    bool crossed = last_f * f < 0;
    leave = crossed ? NEAR : leave, leave = ray < 0 ? STAY : leave;
    bool stays = leave == STAY, moved = f != 0;
    double new_last = moved ? tau : last, new_f = moved ? f : last_f;
    s->f[LAST][l] = stays ? new_last : last, s->f[LAST_F][l] = stays ? new_f : last_f,
    s->f[TAU][l] = stays ? next : tau;
    s->f[EVALS][l] = evals, s->end[l] = f, s->leave[l] = leave;
    return leave;
}

SGT_INLINE unsigned advance_fast(stream *s, const set *w, bool mandelbrot)
{
    const orbit o = *w->o;
    const estimator e = estimator_of(&o, o.c);
    const double budget = w->budget;
    const int n = o.iterations;
    double leaving = 0;
    do {
#pragma omp simd
        for (int l = 0; l < WIDTH; l++) begin_estimate(s, l, e, o, mandelbrot);
        for (int k = mandelbrot ? 1 : 0; k < n; k++) {
#pragma omp simd
            for (int l = 0; l < WIDTH; l++) estimate_level(s, l, e, mandelbrot);
        }
        leaving = 0;
#pragma omp simd reduction(+ : leaving)
        for (int l = 0; l < WIDTH; l++) leaving += end_estimate(s, l, e, budget);
    } while (leaving == 0);
    return leaving_lanes(s);
}

SGT_KERNEL static unsigned fast_julia(stream *s, const set *w) { return advance_fast(s, w, false); }
SGT_KERNEL static unsigned fast_mandelbrot(stream *s, const set *w) { return advance_fast(s, w, true); }

/* ------------------------------------------------------------- near the surface */

SGT_INLINE void begin_near(near *s, int l)
{
    double m = s->m[l], start_size = s->f[START_SIZE][l], along_size = s->f[ALONG_SIZE][l];
    double la = s->f[LA][l], lb = s->f[LB][l], lc = s->f[LC][l], ld = s->f[LD][l];
    s->a[l] = s->f[SA][l] + m * la, s->b[l] = s->f[SB][l] + m * lb, s->c[l] = s->f[SC][l] + m * lc,
    s->d[l] = s->f[SD][l] + m * ld;
    s->va[l] = la, s->vb[l] = lb, s->vc[l] = lc, s->vd[l] = ld;
    s->e[l] = place_error(start_size, along_size, m, s->h[l]);
    s->slope[l] = 8 * SGT_U * along_size;
    s->center[l] = 8 * SGT_U * (start_size + fabs(m) * along_size);
    s->live[l] = 1, s->out[l] = 0;
}

/* What can be said at a level, except for the verdict at level N.  far: beyond it a cell is of no use;
 * infinite at level N. */
SGT_INLINE void look_at_level(near *s, int l, double E, double far, const circle o)
{
    SGT_COUNT_LEVEL((s->free >> l & 1) == 0 && s->live[l] > 0);
    double h = s->h[l], live = s->live[l], out = s->out[l], A, room;
    one q = {.a = s->a[l], .b = s->b[l], .c = s->c[l], .d = s->d[l], .va = s->va[l], .vb = s->vb[l],
             .vc = s->vc[l], .vd = s->vd[l], .e = s->e[l]};
    one_norms(&q);
    double y = h * h * q.V2, x = fabs(q.qv) * h;
    one_twice_root(&q.A2, &A);
    one_room(&q, o.keep, &E, &x, &y, &room);
    out = room > 0 ? out + live : out;
    live = q.A2 > far ? 0 : live, live = room > 0 ? 0 : live;
    s->live[l] = live, s->out[l] = out, s->A[l] = A, s->A2[l] = q.A2, s->V2[l] = q.V2, s->qv[l] = q.qv;
}

SGT_INLINE void next_level(near *s, int l, const quaternion set_c, const circle o, bool mandelbrot)
{
    double h = s->h[l], m = s->m[l], A = s->A[l], slope = s->slope[l], center = s->center[l], first = 0,
           own = 0;
    double start_size = s->f[START_SIZE][l], along_size = s->f[ALONG_SIZE][l];
    double la = s->f[LA][l], lb = s->f[LB][l], lc = s->f[LC][l], ld = s->f[LD][l];
    one q = {.a = s->a[l], .b = s->b[l], .c = s->c[l], .d = s->d[l], .va = s->va[l], .vb = s->vb[l],
             .vc = s->vc[l], .vd = s->vd[l], .e = s->e[l], .A2 = s->A2[l], .V2 = s->V2[l], .qv = s->qv[l]};
    double y = h * h * q.V2;
    one_constant c = {set_c.a, set_c.b, set_c.c, set_c.d, 0};
    if (mandelbrot) {
        c = (one_constant){s->f[SA][l] + m * la, s->f[SB][l] + m * lb, s->f[SC][l] + m * lc,
                           s->f[SD][l] + m * ld, place_error(start_size, along_size, m, h)};
        first = 8 * SGT_U * along_size, own = 8 * SGT_U * (start_size + fabs(m) * along_size);
    }
    one_slope(&A, &q.V2, &q.e, &h, o.round, &slope, &center);
    one_step(&q, &A, &y, o.round, &c, mandelbrot);
    if (mandelbrot) slope += first, center += own, q.va += la, q.vb += lb, q.vc += lc, q.vd += ld;
    s->a[l] = q.a, s->b[l] = q.b, s->c[l] = q.c, s->d[l] = q.d, s->va[l] = q.va, s->vb[l] = q.vb,
    s->vc[l] = q.vc, s->vd[l] = q.vd;
    s->e[l] = q.e, s->slope[l] = slope, s->center[l] = center;
}

/* The verdict at level N. */
SGT_INLINE void judge_near(near *s, int l, double E, double E_err, double E2)
{
    double V2 = s->V2[l], V = sqrt(V2), A = 0.5 * s->A[l], e = s->e[l], h = s->h[l], live = s->live[l],
           out = s->out[l];
    pair_norms n = {s->A2[l], V2, s->qv[l]};
    double told = judge(E, E_err, n, V, e, h);
    orbit_bounds b = judge_slope(E, E_err, n, A, V, (orbit_errors){e, s->slope[l], s->center[l]}, h);
    double verdict = fabs(n.qv) > b.W ? CELL_MONOTONE : CELL_OPEN, W = told == 2 ? b.W : HUGE_VAL,
           g_err = told == 2 ? b.g_err : HUGE_VAL;
    verdict = told == 2 ? verdict : CELL_OPEN, verdict = told == 1 ? CELL_INSIDE : verdict;
    verdict = live > 0 ? verdict : CELL_OPEN, verdict = out > 0 ? CELL_OUTSIDE : verdict;
    sighting at = sight(E2, n.A2, n.qv, W, g_err, h);
    s->verdict[l] = verdict, s->W[l] = W, s->g_err[l] = g_err;
    s->lo[l] = at.lo, s->hi[l] = at.hi, s->newton[l] = at.newton, s->wide[l] = at.wide;
}

SGT_INLINE void look_near(near *s, const set *w, bool mandelbrot)
{
    const quaternion c = w->path.c;
    const circle o = circle_of(&w->path);
    const int n = w->path.iterations;
#pragma omp simd
    for (int l = 0; l < WIDTH; l++) begin_near(s, l);
    for (int k = mandelbrot ? 1 : 0; k < n; k++) {
        double E = w->path.escape[k];
#pragma omp simd
        for (int l = 0; l < WIDTH; l++) {
            look_at_level(s, l, E, o.far, o);
            next_level(s, l, c, o, mandelbrot);
        }
    }
    double E = w->path.escape[n];
#pragma omp simd
    for (int l = 0; l < WIDTH; l++) look_at_level(s, l, E, HUGE_VAL, o);
    double E_n = w->path.E, E_err = w->path.E_err, E2 = w->E2;
#pragma omp simd
    for (int l = 0; l < WIDTH; l++) judge_near(s, l, E_n, E_err, E2);
}

SGT_KERNEL static void look_near_julia(near *s, const set *w) { look_near(s, w, false); }
SGT_KERNEL static void look_near_mandelbrot(near *s, const set *w) { look_near(s, w, true); }

/* --------------------------------------------------------------- from here to there */

static void write_without(const sgt_hits *out, size_t i, sgt_status status, int evals)
{
    static const sgt_ray any = {.tmin = 0}; /* its ends, lo and hi, are not written */
    sgt_hit hit = hit_without(status, &any, evals);
    put_hit(out, i, &hit);
}

static void give_up(job *j, size_t i) { j->tile->hits.status[i] = SGT_HARD, j->hard++; }

SGT_INLINE sgt_ray ray_at(const sgt_rays *r, size_t i)
{
    return (sgt_ray){{r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]},
                     r->tmin[i], r->tmax[i]};
}

/* Makes ray `at` of the tile ready as number i of those that wait.  Returns 1 if it is ready, 0 if it
 * misses, -1 if it is invalid or out of range. */
SGT_INLINE double make_ready(waiting *s, size_t i, const sgt_rays *rays, const double *t_tol, size_t at,
                             const orbit *o, double radius, double dt_min)
{
    sgt_ray ray = ray_at(rays, at);
    double finite = ((ray.o.x - ray.o.x) + (ray.o.y - ray.o.y) + (ray.o.z - ray.o.z)) +
                    ((ray.d.x - ray.d.x) + (ray.d.y - ray.d.y) + (ray.d.z - ray.d.z));
    double big = larger(fabs(ray.d.x), larger(fabs(ray.d.y), fabs(ray.d.z)));
    local q;
    path w;
    double lo, hi, half = chord_of(o, radius, &ray, &q, &w, &lo, &hi), tmin = ray.tmin / q.scale - q.t0,
                   tmax = ray.tmax / q.scale - q.t0;
    double long_as_is = hi - lo, least = 0x1p-48 * (larger(fabs(lo), fabs(hi)) + w.start_size / w.along_size);
    double start = lo;
    cut_to_ends(&q, tmin, tmax, &lo, &hi);
    course k = first_course(start, lo, hi);
    double verdict = lo < hi ? 1 : 0;
    verdict = tmin > hi ? 0 : verdict, verdict = tmax < lo ? 0 : verdict;
    double fits = long_as_is > 0 ? verdict : -1;
    fits = long_as_is < HUGE_VAL ? fits : -1, fits = half < 0 ? 0 : fits;
    fits = finite == 0 ? fits : -1, fits = big >= DBL_MIN ? fits : -1,
    fits = ray.tmin <= ray.tmax ? fits : -1;
    fits = ray.tmin < HUGE_VAL ? fits : -1, fits = ray.tmax > -HUGE_VAL ? fits : -1;
    /* On the fast way a ray that is not met is UNPROVEN, if any of it is between its ends. */
    bool fast = dt_min > 0;
    double between = (q.t0 + 0.5 * (lo + hi)) * q.scale,
           per_length = 1 / sqrt(q.l * q.l + q.m * q.m + q.n * q.n);
    double doubt = between >= ray.tmin ? 1 : -1;
    doubt = between <= ray.tmax ? doubt : -1, doubt = fast ? doubt : 1, fits = fits > 0 ? doubt : fits;
    s->f[SA][i] = w.start.a, s->f[SB][i] = w.start.b, s->f[SC][i] = w.start.c, s->f[SD][i] = w.start.d;
    s->f[LA][i] = w.along.a, s->f[LB][i] = w.along.b, s->f[LC][i] = w.along.c, s->f[LD][i] = w.along.d;
    s->f[START_SIZE][i] = w.start_size, s->f[ALONG_SIZE][i] = w.along_size;
    s->f[TAU][i] = lo, s->f[HI][i] = hi, s->f[EVALS][i] = 0;
    s->f[H][i] = fast ? lo : k.h, s->f[GROWTH][i] = fast ? (double)NAN : k.growth,
    s->f[SIDE][i] = fast ? per_length : 0, s->f[LEAST_STEP][i] = dt_min / q.scale;
    s->f[T_TOL][i] = t_tol[at] / q.scale, s->f[LEAST][i] = least;
    return fits;
}

SGT_KERNEL static void make_all_ready(waiting *s, size_t n, const sgt_tile *tile, size_t from, const set *w,
                                      double verdict[])
{
    const orbit o = *w->o;
    const sgt_rays rays = tile->rays;
    const double radius = w->escape.limit + w->escape.over, *t_tol = tile->t_tol, dt_min = w->dt_min;
#pragma omp simd
    for (size_t i = 0; i < n; i++) verdict[i] = make_ready(s, i, &rays, t_tol, from + i, &o, radius, dt_min);
}

/* Then for floats. */
SGT_INLINE void make_ready_f(waiting *s, size_t i, const march_f *w)
{
    const quaternion at[2] = {{s->f[SA][i], s->f[SB][i], s->f[SC][i], s->f[SD][i]},
                              {s->f[LA][i], s->f[LB][i], s->f[LC][i], s->f[LD][i]}};
    const double size[2] = {s->f[START_SIZE][i], s->f[ALONG_SIZE][i]};
    const course k = {s->f[TAU][i], s->f[HI][i], s->f[H][i], s->f[GROWTH][i], 0};
    const ray_f r = ray_f_of(w, at, size, k, s->f[T_TOL][i], s->f[LEAST][i]);
    s->r[FSA][i] = r.sa, s->r[FSB][i] = r.sb, s->r[FSC][i] = r.sc, s->r[FSD][i] = r.sd;
    s->r[FLA][i] = r.la, s->r[FLB][i] = r.lb, s->r[FLC][i] = r.lc, s->r[FLD][i] = r.ld;
    s->r[FSTART_SIZE][i] = r.start_size, s->r[FALONG_SIZE][i] = r.along_size;
    s->r[FTAU][i] = r.tau, s->r[FHI][i] = r.hi, s->r[FSTEP][i] = r.step, s->r[FGROWTH][i] = r.growth;
    s->r[FSIDE][i] = r.side, s->r[FEVALS][i] = r.evals, s->r[FT_TOL][i] = r.t_tol;
    s->r[FLEAST][i] = r.least;
}

SGT_KERNEL static void make_all_ready_f(waiting *s, const march_f *w)
{
    const march_f own = *w;
#pragma omp simd
    for (size_t i = 0; i < WAITING; i++) make_ready_f(s, i, &own);
}

/* Makes the next rays ready. */
static void set_up(job *j)
{
    waiting *s = j->waiting;
    size_t n = j->tile->n - j->next < WAITING ? j->tile->n - j->next : WAITING;
    double verdict[WAITING];
    make_all_ready(s, n, j->tile, j->next, j->set, verdict);
    make_all_ready_f(s, &j->set->floats);
    s->count = 0;
    for (size_t i = 0; i < n; i++) {
        s->f[RAY][i] = (double)(j->next + i);
        if (verdict[i] > 0) s->order[s->count++] = (int)i;
        else if (verdict[i] < 0) give_up(j, j->next + i);
        else write_without(&j->tile->hits, j->next + i, SGT_MISS, 0);
    }
    j->next += n;
}

/* Is there a ray that waits for its march to begin? */
static bool one_waits(job *j)
{
    while (j->waiting->count == 0 && j->next < j->tile->n) set_up(j);
    return j->waiting->count > 0;
}

/* Gives the next ray to lane l of the march in floats.  Returns false if there is none. */
static bool floats_fill(job *j, int l)
{
    stream_f *s = j->floats;
    waiting *w = j->waiting;
    s->verdict[l] = IDLE;
    if (!one_waits(j)) return false;
    int from = w->order[--w->count];
    move_ray(s->f[0] + l, LANES, w->f[0] + from, WAITING);
    for (int i = 0; i < FIELDS_F; i += 3) {
        float a = w->r[i][from], b = w->r[i + 1][from], c = w->r[i + 2][from];
        s->r[i][l] = a, s->r[i + 1][l] = b, s->r[i + 2][l] = c;
    }
    s->verdict[l] = OUT;
    return true;
}

/* Gives the next ray to lane l of the stream: one that comes back or, on the fast way, one that waits.
 * Returns false if there is none: the lane is idle. */
static bool stream_fill(job *j, int l)
{
    stream *s = j->stream;
    s->verdict[l] = OUT;
    if (j->back->count) {
        move_ray(s->f[0] + l, WIDTH, j->back->f[0] + --j->back->count, MOST_BACK);
        return true;
    }
    if (!(j->set->dt_min > 0) || !one_waits(j)) {
        for (int i = 0; i < FIELDS; i++) s->f[i][l] = i == RAY ? -1 : 1;
        s->verdict[l] = LIVE, s->left[l] = HUGE_VAL, s->a[l] = s->b[l] = s->c[l] = s->d[l] = NAN;
        return false;
    }
    move_ray(s->f[0] + l, WIDTH, j->waiting->f[0] + j->waiting->order[--j->waiting->count], WAITING);
    return true;
}

/* ------------------------------------------------------------------------ hits */

/* Roots found, and what is reported of them: add_root of level.c and the gradient of value.c, in vector
 * code. */
SGT_INLINE void meet_at(hits *s, size_t l, const orbit *o, double radius)
{
    sgt_ray ray = {
        {s->o[0][l], s->o[1][l], s->o[2][l]}, {s->d[0][l], s->d[1][l], s->d[2][l]}, s->tmin[l], s->tmax[l]};
    local q;
    path w;
    double lo, hi;
    meeting h;
    chord_of(o, radius, &ray, &q, &w, &lo, &hi);
    meeting_place(&h, &q, s->tau[l], s->tau_err[l]);
    s->t[l] = h.t, s->t_err[l] = h.t_err, s->t_lo[l] = h.t_lo, s->p_err[l] = h.p_err;
    s->p[0][l] = h.p.x, s->p[1][l] = h.p.y, s->p[2][l] = h.p.z;
    s->l[l] = q.l, s->m[l] = q.m, s->n[l] = q.n, s->scale[l] = q.scale;
    quaternion at = quaternion_at(o, h.p.x, h.p.y, h.p.z);
    int first = o->mandelbrot ? 1 : 0;
    s->a[first][l] = at.a, s->b[first][l] = at.b, s->c[first][l] = at.c, s->d_[first][l] = at.d;
    s->far[l] = 0;
}

SGT_INLINE void on_to(hits *s, size_t l, int k, const orbit *o, double most, bool mandelbrot)
{
    SGT_COUNT_LEVEL(l < s->count);
    quaternion q = {s->a[k][l], s->b[k][l], s->c[k][l], s->d_[k][l]}, c = o->c;
    if (mandelbrot) c = (quaternion){s->a[1][l], s->b[1][l], s->c[1][l], s->d_[1][l]};
    double far = s->far[l];
    power_of r = power_only(q, 2);
    s->far[l] = quaternion_dot(q, q) < most ? far : 1;
    s->a[k + 1][l] = r.s + c.a, s->b[k + 1][l] = r.f * q.b + c.b, s->c[k + 1][l] = r.f * q.c + c.c,
             s->d_[k + 1][l] = r.f * q.d + c.d;
}

SGT_INLINE void turn_back(hits *s, size_t l, int n, double E2)
{
    quaternion q = {s->a[n][l], s->b[n][l], s->c[n][l], s->d_[n][l]};
    double A2 = quaternion_dot(q, q), inverse = 1 / (A2 + E2), far = s->far[l];
    quaternion y = quaternion_times(quaternion_times(q, inverse), 4 * (E2 * inverse));
    s->far[l] = A2 < HUGE_VAL ? far : 1;
    s->y[0][l] = y.a, s->y[1][l] = y.b, s->y[2][l] = y.c, s->y[3][l] = y.d;
    s->sum[0][l] = y.a, s->sum[1][l] = y.b, s->sum[2][l] = y.c, s->sum[3][l] = y.d;
}

SGT_INLINE void back_to(hits *s, size_t l, int k, bool mandelbrot)
{
    quaternion conjugate = {s->a[k][l], -s->b[k][l], -s->c[k][l], -s->d_[k][l]}, none = {0, 0, 0, 0};
    quaternion y = {s->y[0][l], s->y[1][l], s->y[2][l], s->y[3][l]},
               sum = {s->sum[0][l], s->sum[1][l], s->sum[2][l], s->sum[3][l]};
    orbit_step(&conjugate, &y, none, none, 2, false);
    sum = mandelbrot ? quaternion_sum(sum, y) : y;
    s->y[0][l] = y.a, s->y[1][l] = y.b, s->y[2][l] = y.c, s->y[3][l] = y.d;
    s->sum[0][l] = sum.a, s->sum[1][l] = sum.b, s->sum[2][l] = sum.c, s->sum[3][l] = sum.d;
}

SGT_INLINE void count_at(hits *s, size_t l, const orbit *o)
{
    quaternion sum = {s->sum[0][l], s->sum[1][l], s->sum[2][l], s->sum[3][l]};
    double nx = quaternion_dot(o->x, sum), ny = quaternion_dot(o->y, sum), nz = quaternion_dot(o->z, sum);
    s->y[0][l] = nx, s->y[1][l] = ny, s->y[2][l] = nz;
    meeting h = {
        .t = s->t[l], .t_err = s->t_err[l], .p = {s->p[0][l], s->p[1][l], s->p[2][l]}, .n = {nx, ny, nz}};
    local q = {.l = s->l[l], .m = s->m[l], .n = s->n[l], .scale = s->scale[l]};
    double far = s->far[l], good = root_accepted(&h, &q, s->tmin[l], s->tmax[l]) ? 1 : 0,
           fits = root_in_range(&h) ? good : -1;
    s->accepted[l] = far > 0 ? -1 : fits;
}

SGT_INLINE void stream_meet(hits *s, const set *w, bool mandelbrot)
{
    const orbit o = *w->o;
    const double radius = w->escape.limit + w->escape.over, E2 = w->E2, most = 0x1p64 * (1 + E2);
    const int n = o.iterations, first = mandelbrot ? 1 : 0;
#pragma omp simd
    for (size_t l = 0; l < HITS; l++) meet_at(s, l, &o, radius);
    for (int k = first; k < n; k++) {
#pragma omp simd
        for (size_t l = 0; l < HITS; l++) on_to(s, l, k, &o, most, mandelbrot);
    }
#pragma omp simd
    for (size_t l = 0; l < HITS; l++) turn_back(s, l, n, E2);
    for (int k = n - 1; k >= first; k--) {
#pragma omp simd
        for (size_t l = 0; l < HITS; l++) back_to(s, l, k, mandelbrot);
    }
#pragma omp simd
    for (size_t l = 0; l < HITS; l++) count_at(s, l, &o);
}

SGT_KERNEL static void meet_julia(hits *s, const set *w) { stream_meet(s, w, false); }
SGT_KERNEL static void meet_mandelbrot(hits *s, const set *w) { stream_meet(s, w, true); }

/* Sends a ray back to the stream, if anything of it is left.  `apart` is the distance between its fields
 * in f. */
static void go_back(job *j, const double f[], int apart)
{
    size_t i = (size_t)f[RAY * apart];
    bool ends = !(f[TAU * apart] < f[HI * apart]), fast = j->set->dt_min > 0;
    if (fast || (!ends && f[EVALS * apart] >= j->set->budget)) {
        give_up(j, i);
    } else if (ends) {
        write_without(&j->tile->hits, i, SGT_MISS, (int)f[EVALS * apart]);
    } else {
        returned *back = j->back;
        move_ray(back->f[0] + back->count++, MOST_BACK, f, apart);
    }
}

/* For a hit so far outside that F = 1 to the last bit and its gradient is 0.  That happens with a coarse
 * t_tol on a steep set. */
static void count_far(hits *s, size_t l)
{
    meeting h = {.t = s->t[l], .t_err = s->t_err[l], .p = {s->p[0][l], s->p[1][l], s->p[2][l]}};
    local q = {.l = s->l[l], .m = s->m[l], .n = s->n[l], .scale = s->scale[l]};
    if (!(fabs(h.p.x) + fabs(h.p.y) + fabs(h.p.z) < HUGE_VAL) || !root_in_range(&h)) return;
    s->y[0][l] = s->y[1][l] = s->y[2][l] = 0;
    s->accepted[l] = root_accepted(&h, &q, s->tmin[l], s->tmax[l]) ? 1 : 0;
}

/* Reports all the hits there are. */
static void tell_hits(job *j)
{
    hits *s = j->hits;
    if (j->set->path.mandelbrot) meet_mandelbrot(s, j->set);
    else meet_julia(s, j->set);
    for (size_t l = 0; l < s->count; l++) {
        size_t i = s->ray[l];
        if (s->far[l] > 0) count_far(s, l);
        if (s->accepted[l] < 0) {
            give_up(j, i);
            continue;
        }
        if (s->accepted[l] == 0) {
            go_back(j, s->f[0] + l, HITS);
            continue;
        }
        if (j->set->proof) {
            sgt_ray ray = ray_at(&j->tile->rays, i);
            s->f[EVALS][l] += 1;
            if (!sgt_level_unique(j->set->o, &j->set->path, &ray, s->t[l], s->t_lo[l], s->t_err[l])) {
                give_up(j, i);
                continue;
            }
        }
        sgt_hit hit = {.status = SGT_HIT, .evals = (int)s->f[EVALS][l], .t = s->t[l], .t_err = s->t_err[l],
                       .t_lo = s->t_lo[l], .p = {s->p[0][l], s->p[1][l], s->p[2][l]},
                       .n = {s->y[0][l], s->y[1][l], s->y[2][l]}, .p_err = s->p_err[l]};
        put_hit(&j->tile->hits, i, &hit);
    }
    s->count = 0;
}

/* Takes the root within tau_err of tau, from lane `from` near the surface.  Its point costs one more
 * evaluation. */
static void add_hit_at(job *j, int from, double tau, double tau_err)
{
    const near *at = j->near;
    hits *s = j->hits;
    size_t l = s->count++, i = (size_t)at->f[RAY][from];
    sgt_ray ray = ray_at(&j->tile->rays, i);
    move_ray(s->f[0] + l, HITS, at->f[0] + from, WIDTH);
    s->f[EVALS][l] += 1;
    s->o[0][l] = ray.o.x, s->o[1][l] = ray.o.y, s->o[2][l] = ray.o.z, s->d[0][l] = ray.d.x,
    s->d[1][l] = ray.d.y, s->d[2][l] = ray.d.z;
    s->tmin[l] = ray.tmin, s->tmax[l] = ray.tmax, s->tau[l] = tau, s->tau_err[l] = tau_err, s->ray[l] = i;
    if (s->count == HITS) tell_hits(j);
}

static course course_of(const near *s, int l)
{
    return (course){s->f[TAU][l], s->f[HI][l], s->f[H][l], s->f[GROWTH][l], s->f[SIDE][l]};
}

static void set_course(near *s, int l, const course *k)
{
    s->f[TAU][l] = k->tau, s->f[H][l] = k->h, s->f[GROWTH][l] = k->growth, s->f[SIDE][l] = k->side;
}

/* Uses the look at the cell of lane l.  Returns false if the ray has left. */
static bool stream_settle(job *j, int l)
{
    near *s = j->near;
    const set *w = j->set;
    size_t i = (size_t)s->f[RAY][l];
    double E2 = w->E2, t_tol = s->f[T_TOL][l], least = s->f[LEAST][l], wanted = larger(t_tol, least);
    bracket *p = &s->root[l];
    cell e = {(cell_verdict)s->verdict[l], s->live[l] > 0 ? w->path.iterations : 0,
              s->A2[l], s->V2[l], s->qv[l], s->e[l], s->W[l], s->g_err[l]};
    sighting n = {s->lo[l], s->hi[l], s->newton[l], s->wide[l]};
    s->f[EVALS][l] += 1;
    bool on;
    if (s->task[l] == CROSS) {
        course k = course_of(s, l);
        double root, err;
        bool found = found_across(&k, &s->at[l], e.verdict, &s->f[T_TOL][l], &root, &err);
        set_course(s, l, &k);
        if (found) add_hit_at(j, l, root, err);
        else go_back(j, s->f[0] + l, WIDTH);
        return false;
    }
    if (s->task[l] == POLISH) {
        on = narrow(p, &e, &n, w->path.iterations, E2, wanted, least);
    } else {
        course k = course_of(s, l);
        const course_limits bounds = {w->path.iterations, E2, t_tol, least};
        turn what = decide(&k, &s->at[l], &e, &n, &bounds, p);
        if (what == RARE) {
            give_up(j, i);
            return false;
        }
        set_course(s, l, &k);
        if (what == ON) {
            go_back(j, s->f[0] + l, WIDTH);
            return false;
        }
        if (what == ACROSS) *p = (bracket){.m = s->at[l].m}; /* looked at next, with h = 0 */
        s->task[l] = what == ACROSS ? CROSS : POLISH;
        on = what == ACROSS || root_error(p) > wanted;
    }
    if (s->f[EVALS][l] >= w->budget) {
        give_up(j, i);
        return false;
    }
    s->m[l] = p->m, s->h[l] = p->h;
    if (on) return true;
    add_hit_at(j, l, p->m, root_error(p));
    return false;
}

/* Looks at all cells near the surface. */
static void look_and_settle(job *j)
{
    near *s = j->near;
    if (j->set->path.mandelbrot) look_near_mandelbrot(s, j->set);
    else look_near_julia(s, j->set);
    for (int l = 0; l < WIDTH; l++)
        if (!(s->free >> l & 1) && !stream_settle(j, l)) s->free |= 1U << l, s->count--;
}

static int lowest(unsigned bits)
{
#if defined(__GNUC__)
    return __builtin_ctz(bits);
#else
    int l = 0;
    while (!(bits >> l & 1)) l++;
    return l;
#endif
}

/* Gives a lane near the surface to a ray. */
static int take_lane(near *s, const double f[], int apart)
{
    int l = lowest(s->free);
    s->free &= s->free - 1, s->count++;
    move_ray(s->f[0] + l, WIDTH, f, apart);
    return l;
}

/* Lays the cell of lane l near the surface. */
static void lay_near(near *s, int l)
{
    course k = course_of(s, l);
    s->at[l] = lay(&k), s->m[l] = s->at[l].m, s->h[l] = s->at[l].h, s->task[l] = MARCH;
}

/* Moves the ray of a lane of the stream near the surface. */
static void come_near(job *j, int at)
{
    const stream *from = j->stream;
    near *s = j->near;
    if (from->f[EVALS][at] >= j->set->budget) {
        give_up(j, (size_t)from->f[RAY][at]);
        return;
    }
    lay_near(s, take_lane(s, from->f[0] + at, WIDTH));
}

/* Takes the ray of lane `at` out of the march in floats. */
static void floats_leave(job *j, int at)
{
    const stream_f *from = j->floats;
    near *s = j->near;
    size_t i = (size_t)from->f[RAY][at];
    if ((double)from->r[FTAU][at] >= from->f[HI][at] * unit_f_of(from->f[ALONG_SIZE][at]).of) {
        write_without(&j->tile->hits, i, SGT_MISS, (int)from->r[FEVALS][at]);
    } else if ((double)from->r[FEVALS][at] >= j->set->budget) {
        give_up(j, i);
    } else {
        int l = take_lane(s, from->f[0] + at, LANES);
        course k = course_of(s, l);
        const ray_f r = {.tau = from->r[FTAU][at], .step = from->r[FSTEP][at],
                         .growth = from->r[FGROWTH][at], .side = from->r[FSIDE][at],
                         .evals = from->r[FEVALS][at]};
        k = course_after(k, &r, s->f[ALONG_SIZE][l]);
        set_course(s, l, &k), s->f[EVALS][l] = (double)from->r[FEVALS][at];
        lay_near(s, l);
    }
    while (s->count == WIDTH) look_and_settle(j);
}

/* On the fast way F has changed its sign in a lane of the stream: makes the bracket. */
static void cross(job *j, int at)
{
    const stream *from = j->stream;
    near *s = j->near;
    int l = take_lane(s, from->f[0] + at, WIDTH);
    double last = s->f[LAST][l], last_f = s->f[LAST_F][l], tau = s->f[TAU][l], f = from->end[at];
    bracket *p = &s->root[l];
    *p = (bracket){.lo = last, .hi = tau, .a = last, .b = tau, .falls = last_f > 0 ? 1 : -1};
    step_to(p, tau, f * (tau - last) / (f - last_f), 0, 0.125 * (tau - last));
    s->m[l] = p->m, s->h[l] = p->h, s->task[l] = POLISH;
    if (root_error(p) > larger(s->f[T_TOL][l], s->f[LEAST][l]) && s->f[EVALS][l] < j->set->budget) return;
    s->free |= 1U << l, s->count--;
    if (s->f[EVALS][l] < j->set->budget) add_hit_at(j, l, p->m, root_error(p));
    else give_up(j, (size_t)s->f[RAY][l]);
}

/* Takes the ray of lane l out of the stream. */
static void stream_leave(job *j, int l)
{
    const stream *s = j->stream;
    bool fast = j->set->dt_min > 0;
    size_t i = (size_t)s->f[RAY][l];
    if (s->leave[l] == SPENT) give_up(j, i);
    else if (s->leave[l] == MISSED)
        write_without(&j->tile->hits, i, fast ? SGT_UNPROVEN : SGT_MISS, (int)s->f[EVALS][l]);
    else if (fast) cross(j, l);
    else come_near(j, l);
    while (j->near->count == WIDTH) look_and_settle(j);
}

/* Takes the march in double on until some lanes leave, and fills those. */
static void step_stream(job *j)
{
    const set *w = j->set;
    unsigned leaving = (w->dt_min > 0 ? w->path.mandelbrot ? fast_mandelbrot : fast_julia
                        : w->path.mandelbrot ? advance_mandelbrot : advance_julia)(j->stream, w);
    for (; leaving; leaving &= leaving - 1) {
        int l = lowest(leaving);
        stream_leave(j, l);
        j->busy -= !stream_fill(j, l);
    }
}

/* Gives rays to the idle lanes of the stream.  anew: all are idle. */
static void fill_idle(job *j, bool anew)
{
    for (int l = 0; l < WIDTH && (anew || j->back->count || j->set->dt_min > 0); l++)
        if (anew || j->stream->f[RAY][l] < 0) j->busy += stream_fill(j, l);
}

#if defined(__GNUC__)
enum { SAME_CELLS = true };
#else
enum { SAME_CELLS = false }; /* the single ray has no vectors there, and uses other formulas */
#endif

size_t sgt_level_lanes(const orbit *o, const sgt_tile *tile, const sgt_options *opt)
{
    static const double rounding_only[SGT_MOST_TILE]; /* the t_tol of a proof */
    set w = {.o = o, .proof = opt->proof != SGT_ESTIMATE};
    sgt_tile own = *tile;
    stream s;
    stream_f floats;
    near close;
    waiting waits;
    returned back;
    hits met;
    job j = {&w, &own, 0, 0, 0, &waits, &back, &close, &floats, &s, &met};
    if (!SAME_CELLS || o->power != 2 || o->iterations > MOST_LEVELS) {
        memset(tile->hits.status, SGT_HARD, tile->n);
        return tile->n;
    }
    set_of(o, &w.path);
    w.escape = escape_of(o), w.E2 = o->E * o->E,
    w.budget = opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS, w.dt_min = w.proof ? 0 : opt->dt_min;
    if (w.proof) own.t_tol = rounding_only;
    w.floats = march_f_of(o, &w.path, w.budget);
    memset(&close, 0, sizeof close);
    memset(&waits, 0, sizeof waits);
    close.free = (1U << WIDTH) - 1;
    memset(&s, 0, sizeof s);
    memset(&floats, 0, sizeof floats);
    memset(&met, 0, sizeof met);
    back.count = 0;
    int afloat = 0;
    for (int l = 0; l < LANES && !(w.dt_min > 0); l++) afloat += floats_fill(&j, l);
    fill_idle(&j, true);
    while (afloat || j.busy || close.count || met.count) {
        if (afloat) {
            unsigned leaving = (w.path.mandelbrot ? floats_mandelbrot : floats_julia)(&floats, &w);
            for (; leaving; leaving &= leaving - 1) {
                int l = lowest(leaving);
                floats_leave(&j, l);
                afloat -= !floats_fill(&j, l);
                fill_idle(&j, false);
                while (back.count) step_stream(&j); /* all lanes are busy */
            }
            continue;
        }
        bool drains = 2 * j.busy <= close.count; /* rays that come back from the surface fill the lanes */
        if (j.busy && !drains) {
            step_stream(&j);
            continue;
        }
        if (close.count) look_and_settle(&j);
        else tell_hits(&j);
        fill_idle(&j, false);
    }
    return j.hard;
}
