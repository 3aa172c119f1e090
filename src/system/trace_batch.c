// SPDX-License-Identifier: MIT
/* trace_batch.c - many rays through a row of surfaces.
 *
 * A TILE OF RAYS goes through all elements before the next tile starts.  So what it needs stays in the
 * first cache.  At each element three loops run over the tile, all of them vector code:
 *
 *     1. the rays are placed in the element's frame; without turns that is a sum
 *     2. the surface's lanes meet them (ray/batch.c)
 *     3. they are bent, on to the next element; between equal indices nothing is bent.  Of an ideal lens
 *        that is a loop of its own, and one more if paths are wanted.  A phase in waves is first worked out
 *        for all of them, by the operations of its surface
 *
 * The formulas are those of the single ray (trace.h), the same operations in the same order, and so the
 * same bits.
 *
 * THE ITEMS OF AN APERTURE are asked after the bending, of rays that the loops have answered for.  What they
 * clip stops with the hit that has been found, and is asked nothing more (aperture.c).
 *
 * WHAT THE LOOPS LEAVE.  They answer for a ray that is met within the clear aperture and goes on.  Any
 * other ray is looked at by itself: missed, outside, totally reflected, or with a normal or a direction
 * out of range.  If it goes on, sgt_pass takes it through that one element.  A launch ray that may not be
 * valid goes to sgt_launch.  An aperture may well put half of the rays outside.  These are asked a few at
 * a time whether they meet the surface inside, too.  Rays that have stopped leave the tile, and the others
 * move up.
 *
 * WHY APART.  Ray by ray (sgt_trace) a lens of spheres costs 18 times the instructions, of even aspheres 15,
 * of odd aspheres 7.6 ("a trace" over "a trace batch" in tests/cost/cost.csv).
 *
 * If there is a watcher, or the options are not valid, tiles have one ray, and sgt_pass does everything. */
#include "trace.h"

#include "../ray/unique.h"
#include "../ray/vicinity.h"
#include "../ray/batch.h"
#include "../solve/root.h"
#include "phase.h"

/* The rays of a tile.  128 of them are 30 KiB, of which a third is for paths and records only.  So with
 * what the surface's lanes need they stay in a first cache of 32 KiB, and with its stack they are below
 * 64.  They are enough to make the work between the loops small (with 96 a scan lens costs 6 % more). */
enum { TILE = 128 };

/* The ends of rays that are whole lines. */
#define FOUR(x) x, x, x, x
#define ALL(x) FOUR(FOUR(FOUR(x))), FOUR(FOUR(FOUR(x)))
static const double line_begins[TILE] = {ALL(-HUGE_VAL)}, line_ends[TILE] = {ALL(HUGE_VAL)};

typedef struct vectors { double x[TILE], y[TILE], z[TILE]; } vectors;
typedef struct paths { double hi[TILE], lo[TILE]; } paths;
enum { KEPT = 2 * sizeof(paths) / sizeof(slopes_known) };

SGT_INLINE sgt_vec3 get(const vectors *v, size_t i) { return (sgt_vec3){v->x[i], v->y[i], v->z[i]}; }
SGT_INLINE void put(vectors *v, size_t i, sgt_vec3 a) { v->x[i] = a.x, v->y[i] = a.y, v->z[i] = a.z; }

/* Where the rays are, and their paths, as in a state. */
typedef struct bundle_place { vectors *offset, *d; paths *path; } bundle_place;

typedef struct tile {
    size_t first, n;        /* the first of its rays; how many are still on their way, */
    size_t whole;           /* of how many */
    int index[TILE];        /* and which, from `first` on; -1: it has stopped just now */
    sgt_vec3 base;          /* see state */
    double medium, t0[TILE]; /* t0: first element only, if a launch may have been moved */
    bool moved;
    bundle_place now, next;        /* before an element, and behind it */
    vectors *o, *p, *d;     /* in its frame: start, hit, and the direction before */
    _Alignas(64) vectors n_; /* 64: a cache line */
    vectors offsets[3], ds[2]; /* what the pointers above point to */
    union { /* there is no more room in 80 KiB of stack */
        paths some_paths[2];     /* if paths are wanted */
        slopes_known kept[KEPT]; /* else: of the first elements, what is known near the seeds, in all tiles */
    };
    double t[TILE], t_lo[TILE], t_err[TILE], p_err[TILE];
    /* t_tol is given to the surface's lanes.  After that good: 1, the loops have answered; 0, they have not;
     * below 0, a verdict (judge_rest). */
    union {
        double t_tol[TILE], good[TILE];
    };
    int evals[TILE];
    sgt_status status[TILE];
} tile;

/* What was asked for. */
typedef struct bundle_work {
    size_t elements;
    const sgt_element *e;
    const sgt_rays *rays;
    const sgt_traced *out;
    const sgt_passages *passages;
    sgt_options opt;
    double index;
    bool by_hand, path;     /* sgt_pass does everything; some path is wanted */
} bundle_work;

/* -------------------------------------------------------------- the loops */

/* Each returns how many rays it answered for.  Structs are given by pointer: a copy of one that was just set
 * member by member would be read in wider pieces than it was written, and so wait for all that has been
 * stored before. */

/* The launch, where it takes a sum only. */
SGT_KERNEL
static double launch_near(tile *w, const sgt_rays *from, sgt_vec3 origin)
{
    const size_t n = w->n, first = w->first;
    vectors *restrict offset = w->now.offset, *restrict out_d = w->now.d;
    double *restrict good = w->good;
    const double *restrict ox = from->o[0] + first, *restrict oy = from->o[1] + first,
                           *restrict oz = from->o[2] + first;
    const double *restrict dx = from->d[0] + first, *restrict dy = from->d[1] + first,
                           *restrict dz = from->d[2] + first;
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {ox[i], oy[i], oz[i]}, d = {dx[i], dy[i], dz[i]};
        put(offset, i, plus(minus(o, origin), (sgt_vec3){0, 0, 0}));
        put(out_d, i, d);
        good[i] = stays(o, d, origin, false) ? 1 : 0;
        count += good[i];
    }
    return count;
}

SGT_KERNEL
static double launch_all(tile *w, const sgt_rays *from, sgt_vec3 origin, bool turned)
{
    const size_t n = w->n, first = w->first;
    vectors *restrict offset = w->now.offset, *restrict out_d = w->now.d;
    double *restrict t0 = w->t0, *restrict good = w->good;
    const double *restrict ox = from->o[0] + first, *restrict oy = from->o[1] + first,
                           *restrict oz = from->o[2] + first;
    const double *restrict dx = from->d[0] + first, *restrict dy = from->d[1] + first,
                           *restrict dz = from->d[2] + first;
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {ox[i], oy[i], oz[i]}, d = {dx[i], dy[i], dz[i]}, q = minus(o, origin);
        launched l = launch_from(o, d, origin, turned);
        put(offset, i, l.offset);
        put(out_d, i, l.d);
        t0[i] = l.t0;
        double odd = (q.x - q.x) + (q.y - q.y) + (q.z - q.z) + (d.x - d.x) + (d.y - d.y) + (d.z - d.z) +
                     (l.t0 - l.t0);
        good[i] = odd == 0 /* all are finite */ && largest(d) >= DBL_MIN ? 1 : 0;
        count += good[i];
    }
    return count;
}

SGT_INLINE void place_by(bool open, tile *w, sgt_vec3 shift, double semi_diameter)
{
    const size_t n = w->n;
    const vectors *restrict offset = w->now.offset, *restrict d = w->now.d;
    vectors *restrict out = w->o;
    double *restrict tol = w->t_tol;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = plus(shift, get(offset, i));
        put(out, i, o);
        tol[i] = tolerance(open, semi_diameter, o, get(d, i));
    }
}

SGT_KERNEL
static void place_all(tile *w, const sgt_vec3 *shift, double semi_diameter)
{
    if (is_open(semi_diameter)) place_by(true, w, *shift, semi_diameter);
    else place_by(false, w, *shift, semi_diameter);
}

/* If a direction comes out far from unit length (the axes are not what they should be), it is set to NaN:
 * no surface is met. */
SGT_INLINE void turn_by(bool open, tile *w, const sgt_pose *pose, sgt_vec3 shift, double semi_diameter)
{
    const size_t n = w->n;
    const vectors *restrict offset = w->now.offset, *restrict d = w->now.d;
    vectors *restrict out_o = w->o, *restrict out_d = w->d;
    double *restrict tol = w->t_tol;
    sgt_pose p = *pose;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = to_local(&p, plus(shift, get(offset, i))), turned = to_local(&p, get(d, i));
        double e = excess(turned);
        turned = kept_unit(turned, e);
        turned.x = fabs(e) <= NEAR_UNIT ? turned.x : (double)NAN;
        put(out_o, i, o);
        put(out_d, i, turned);
        tol[i] = tolerance(open, semi_diameter, o, turned);
    }
}

SGT_KERNEL
static void turn_all(tile *w, const sgt_pose *pose, const sgt_vec3 *shift, double semi_diameter)
{
    if (is_open(semi_diameter)) turn_by(true, w, pose, *shift, semi_diameter);
    else turn_by(false, w, pose, *shift, semi_diameter);
}

SGT_INLINE double bend_by(bend_kind kind, tile *w, bending by, double aperture2)
{
    const size_t n = w->n;
    const vectors *restrict p = w->p, *restrict normal = &w->n_, *d = w->d;
    vectors *out = w->next.d; /* d and out may be the same */
    double *restrict good = w->good;
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        /* false for NaN: it was not met */
        double inside = p->x[i] * p->x[i] + p->y[i] * p->y[i] <= aperture2 ? 1 : 0;
        if (kind != STRAIGHT) {
            bent b = bent_by(kind, by.r, by.k, get(d, i), get(normal, i));
            put(out, i, b.d);
            inside = where_good(b, inside);
        }
        good[i] = inside;
        count += inside;
    }
    return count;
}

SGT_KERNEL
static double bend_all(tile *w, const bending *by, double aperture2)
{
    switch (by->kind) {
    case STRAIGHT: return bend_by(STRAIGHT, w, *by, aperture2);
    case BACK: return bend_by(BACK, w, *by, aperture2);
    case ON: return bend_by(ON, w, *by, aperture2);
    case ON_BY_SINE: return bend_by(ON_BY_SINE, w, *by, aperture2);
    case BY_PHASE:
    case BY_WAVES: break; /* focus_all, kick_all */
    }
    return 0;
}

/* bend_all of an ideal lens. */
SGT_KERNEL
static double focus_all(size_t n, const thin_lens *by, double aperture2, const vectors *restrict p,
                        const vectors *d, vectors *out, double *restrict good)
{
    thin_lens lens = *by;
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        double inside = p->x[i] * p->x[i] + p->y[i] * p->y[i] <= aperture2 ? 1 : 0;
        focused b = focus_by(lens, get(p, i), get(d, i));
        put(out, i, b.d);
        good[i] = where_focused(b, inside);
        count += good[i];
    }
    return count;
}

/* Adds the path of an ideal lens; d: the direction in front. */
SGT_KERNEL
static void add_phase_all(size_t n, const thin_lens *by, const vectors *restrict p, const vectors *restrict d,
                          paths *restrict path)
{
    thin_lens lens = *by;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        twofold before = {path->hi[i], path->lo[i]};
        twofold l = twofold_sum(before, twofold_of(phase_path(lens, get(p, i), get(d, i))));
        path->hi[i] = l.hi, path->lo[i] = l.lo;
    }
}

/* bend_all of a phase in waves, or of facets; g: the gradient of W. */
SGT_INLINE double kick_by_all(bool facets, bool back, const tile *w, kick by, double aperture2,
                              const vectors *restrict g, const vectors *d, vectors *out,
                              double *restrict good)
{
    const size_t n = w->n;
    const vectors *restrict p = w->p, *restrict normal = &w->n_;
    double count = 0;
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) {
        double inside = p->x[i] * p->x[i] + p->y[i] * p->y[i] <= aperture2 ? 1 : 0;
        kicked b = facets ? facet_by(back, by, get(g, i), get(d, i), get(normal, i))
                          : kick_by(back, by, get(g, i), get(d, i), get(normal, i));
        put(out, i, b.d);
        good[i] = where_kicked(b, inside);
        count += good[i];
    }
    return count;
}

SGT_KERNEL
static double kick_all(const tile *w, const kick *by, double aperture2, const vectors *g, const vectors *d,
                       vectors *out, double *good)
{
    if (by->back) return kick_by_all(false, true, w, *by, aperture2, g, d, out, good);
    return kick_by_all(false, false, w, *by, aperture2, g, d, out, good);
}

SGT_KERNEL
static double face_all(const tile *w, const kick *by, double aperture2, const vectors *g, const vectors *d,
                       vectors *out, double *good)
{
    if (by->back) return kick_by_all(true, true, w, *by, aperture2, g, d, out, good);
    return kick_by_all(true, false, w, *by, aperture2, g, d, out, good);
}

/* Adds S; w: W. */
SGT_KERNEL
static void add_waves_all(size_t n, double per_wave, const double *restrict w, paths *restrict path)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        twofold l = kick_path(per_wave, w[i], (twofold){path->hi[i], path->lo[i]});
        path->hi[i] = l.hi, path->lo[i] = l.lo;
    }
}

/* Bends the rays by a phase in waves.  Where they started in the element's frame is of no use any more.  So
 * the gradient of W is kept there, and W in good. */
SGT_NOINLINE static double kick_tile(const bundle_work *job, tile *w, const sgt_element *e, double n2)
{
    vectors *g = w->o;
    const kick by = kick_of(e->phase, w->medium, n2, e->index == SGT_MIRROR);
    sgt_waves_tile(e->phase, w->n, (sgt_points){{w->p->x, w->p->y, w->p->z}}, w->good,
                   (double *const[3]){g->x, g->y, g->z});
    if (job->path) add_waves_all(w->n, path_per_wave(e->phase), w->good, w->next.path);
    const double aperture2 = aperture2_of(e->semi_diameter);
    return is_faceted(e->phase) ? face_all(w, &by, aperture2, g, w->d, w->next.d, w->good)
                                : kick_all(w, &by, aperture2, g, w->d, w->next.d, w->good);
}

/* Back to global axes; also d, in place, if d_too. */
SGT_KERNEL
static double return_all(size_t n, const sgt_pose *pose, bool d_too, const vectors *restrict p,
                         vectors *restrict offset, vectors *restrict d, double *restrict good)
{
    sgt_pose axes = *pose;
    double count = 0;
#pragma omp simd
    for (size_t i = 0; i < n; i++) put(offset, i, to_global(&axes, get(p, i)));
    if (d_too) {
#pragma omp simd
        for (size_t i = 0; i < n; i++) {
            sgt_vec3 back = to_global(&axes, get(d, i));
            double e = excess(back);
            put(d, i, kept_unit(back, e));
            good[i] = fabs(e) <= NEAR_UNIT ? good[i] : 0;
        }
    }
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) count += good[i];
    return count;
}

/* Makes the errors of the hits those of the rays as given, in place.  sent: some launch was moved.  t_too:
 * not p_err alone, which may then hold garbage if it was not asked for. */
SGT_INLINE void widen_by(tile *w, aside a, bool first, bool turns, bool sent, bool t_too)
{
    const size_t n = w->n;
    const vectors *restrict offset = w->now.offset, *restrict normal = &w->n_, *o = w->o, *d = w->d;
    const double *restrict t0 = w->t0, *restrict t = w->t;
    double *restrict t_err = w->t_err, *restrict p_err = w->p_err;
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        double moved = first ? 0 : 1;
        if (sent) moved = was_moved(t0[i]) ? 1 : 0;
        const met_ray met = {get(offset, i), get(o, i), get(d, i), get(normal, i), t[i]};
        widening by = widening_by(a, first, turns, moved, met);
        if (t_too) t_err[i] += by.t;
        p_err[i] += by.p;
    }
}

SGT_KERNEL
static void widen_all(tile *w, const aside *a, bool first, bool turns, bool t_too)
{
    if (first && turns && w->moved) widen_by(w, *a, true, true, true, true);
    else if (first && turns) widen_by(w, *a, true, true, false, true);
    else if (first && w->moved) widen_by(w, *a, true, false, true, true);
    else if (first) widen_by(w, *a, true, false, false, true);
    else if (turns) widen_by(w, *a, false, true, false, true);
    else if (t_too) widen_by(w, *a, false, false, false, true);
    else widen_by(w, *a, false, false, false, false);
}

/* Makes t of the hits count from the launch again, where that was moved. */
SGT_KERNEL
static void shift_all(size_t n, const double *restrict t0, double *restrict t, double *restrict t_lo,
                      double *restrict t_err)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        hit_place h = from_launch(t0[i], (hit_place){t[i], t_lo[i], t_err[i]});
        t[i] = t0[i] != 0 ? h.t : t[i];
        t_lo[i] = t0[i] != 0 ? h.t_lo : t_lo[i];
        t_err[i] = t0[i] != 0 ? h.t_err : t_err[i];
    }
}

SGT_KERNEL
static void lengthen_all(size_t n, double index, const double *restrict t, const double *restrict t_lo,
                         const paths *restrict path, paths *restrict out)
{
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        twofold l = longer((twofold){path->hi[i], path->lo[i]}, index, t[i], t_lo[i]);
        out->hi[i] = l.hi, out->lo[i] = l.lo;
    }
}

/* --------------------------------------------------------------- the record */

/* Writes one number of every ray that is on its way. */
static void tell_all(const tile *w, double *out, const double *from)
{
    if (!out) return;
    out += w->first;
    if (w->n == w->whole) memcpy(out, from, w->n * sizeof *from);
    else for (size_t i = 0; i < w->n; i++) out[w->index[i]] = from[i];
}

static void tell_statuses(const tile *w, signed char *out, const signed char *from)
{
    if (!out) return;
    out += w->first;
    if (w->n == w->whole) memcpy(out, from, w->n);
    else for (size_t i = 0; i < w->n; i++) out[w->index[i]] = from[i];
}

static void tell_counts(const tile *w, int *out, const int *from)
{
    if (!out) return;
    out += w->first;
    if (w->n == w->whole) memcpy(out, from, w->n * sizeof *from);
    else for (size_t i = 0; i < w->n; i++) out[w->index[i]] = from[i];
}

static void tell_vectors(const tile *w, double *const out[3], const vectors *from)
{
    if (!out[0]) return;
    tell_all(w, out[0], from->x), tell_all(w, out[1], from->y), tell_all(w, out[2], from->z);
}

/* Writes what has become of ray i of the batch; o, d: as it is at return. */
static void tell_fate(const sgt_traced *out, size_t i, sgt_fate fate, size_t passed, sgt_vec3 o, sgt_vec3 d,
                      double opl)
{
    if (out->fate) out->fate[i] = fate;
    if (out->passed) out->passed[i] = (int)passed;
    tell_vector(out->o, i, o);
    tell_vector(out->d, i, d);
    tell_number(out->opl, i, opl);
}

/* The i-th ray of the tile stops at element `passed`, which has been written.  The passages behind it are
 * written as not met. */
static void stop(const bundle_work *job, tile *w, size_t i, sgt_fate fate, size_t passed, sgt_vec3 o,
                 sgt_vec3 d, double opl)
{
    size_t ray = w->first + (size_t)w->index[i];
    if (job->passages && passed + 1 < job->elements) {
        const sgt_passage nothing = sgt_not_met(SGT_MISS);
        for (size_t j = passed + 1; j < job->elements; j++) tell_passage(&job->passages[j], ray, &nothing);
    }
    tell_fate(job->out, ray, fate, passed, o, d, opl);
    w->index[i] = -1;
}

/* Those that have not stopped move up.  Which they are cannot be predicted; so all are moved, without a
 * branch. */
static void close_ranks(const bundle_work *job, tile *w, const bundle_place *at)
{
    size_t k = 0;
    for (size_t i = 0; i < w->n; i++) {
        int index = w->index[i];
        w->index[k] = index;
        if (w->moved) w->t0[k] = w->t0[i];
        put(at->offset, k, get(at->offset, i));
        put(at->d, k, get(at->d, i));
        if (job->path) at->path->hi[k] = at->path->hi[i], at->path->lo[k] = at->path->lo[i];
        k += index >= 0 ? 1 : 0;
    }
    w->n = k;
}

/* The rays that the loops have not answered for, in order; also without a branch. */
typedef struct rest { size_t n; unsigned char of[TILE]; } rest;

static void rest_of(const tile *w, rest *r)
{
    r->n = 0;
    for (size_t i = 0; i < w->n; i++) {
        r->of[r->n] = (unsigned char)i;
        r->n += w->good[i] > 0 ? 0 : 1;
    }
}

/* -------------------------------------------------------------- one by one */

/* A launch ray; its tmin and tmax are not read. */
static sgt_ray bundle_ray_of(const sgt_rays *r, size_t i)
{
    return (sgt_ray){.o = {r->o[0][i], r->o[1][i], r->o[2][i]}, .d = {r->d[0][i], r->d[1][i], r->d[2][i]}};
}

/* This and other functions are not inlined, so that their stack is free while a surface's lanes run. */
SGT_NOINLINE static void launch_rest(const bundle_work *job, tile *w)
{
    size_t stopped = 0;
    for (size_t i = 0; i < w->n; i++) {
        if (w->good[i] > 0) continue;
        size_t r = w->first + (size_t)w->index[i];
        sgt_ray ray = bundle_ray_of(job->rays, r);
        state s;
        if (sgt_launch(&ray, job->elements ? job->e : NULL, job->index, &s)) {
            put(w->now.offset, i, s.offset);
            put(w->now.d, i, s.d);
            w->t0[i] = s.t0;
            continue;
        }
        if (job->passages && job->elements) {
            const sgt_passage invalid = sgt_not_met(SGT_INVALID);
            tell_passage(&job->passages[0], r, &invalid);
        }
        stop(job, w, i, SGT_LOST, 0, ray.o, ray.d, (double)NAN);
        stopped++;
    }
    if (stopped) close_ranks(job, w, &w->now);
}

/* Surfaces are asked for the root that is meant.  Whether it is the only one within the aperture is asked
 * afterwards. */
static sgt_options met_by(const sgt_options *opt)
{
    sgt_options own = *opt;
    if (asks_unique(opt)) own.proof = SGT_PROVE_ROOT;
    return own;
}

/* For rays that were met without a proof: those that the slope does not prove become hard.  Returns how
 * many are proven. */
SGT_NOINLINE static size_t prove_by_slope(const sgt_element *e, const sgt_tile *rays, double aperture2,
                                          const vectors *p)
{
    bool proven[TILE];
    for (size_t i = 0; i < rays->n; i++)
        if (rays->hits.status[i] != SGT_HIT || !is_inside(get(p, i), aperture2))
            rays->hits.status[i] = SGT_HARD;
    size_t left = sgt_unique_by_slope(in_set(e->surface), rays, aperture2, proven);
    for (size_t i = 0; left < rays->n && i < rays->n; i++)
        if (!proven[i]) rays->hits.status[i] = SGT_HARD;
    return left;
}

/* Rays that were met inside the aperture and may have another root there become hard.  Is there any? */
SGT_NOINLINE static bool hide_others(const sgt_element *e, const sgt_tile *rays, double aperture2,
                                     const vectors *p)
{
    unsigned long long unique[TILE];
    if (sgt_unique_tile(in_set(e->surface), rays, aperture2_around(aperture2), unique, NULL)) return false;
    bool any = false;
    for (size_t i = 0; i < rays->n; i++)
        if (~unique[i] && rays->hits.status[i] > 0 && is_inside(get(p, i), aperture2))
            rays->hits.status[i] = SGT_HARD, any = true;
    return any;
}

/* What the surface's lanes have found; outputs that were not asked for are not read. */
static sgt_hit hit_of(const tile *w, size_t i, const sgt_hits *asked)
{
    sgt_hit hit = sgt_not_met((sgt_status)w->status[i]).hit;
    if (asked->evals) hit.evals = w->evals[i];
    if (asked->t) hit.t = w->t[i];
    if (asked->t_lo) hit.t_lo = w->t_lo[i];
    if (asked->t_err) hit.t_err = w->t_err[i];
    if (asked->p_err) hit.p_err = w->p_err[i];
    if (asked->n[0]) hit.n = get(&w->n_, i);
    hit.p = get(w->p, i);
    return hit;
}

/* The fate of a ray that was not met inside. */
SGT_INLINE sgt_fate stopped_by(sgt_status status)
{
    return status == SGT_MISS ? SGT_MISSED : status > 0 ? SGT_CLIPPED : SGT_LOST;
}

/* What becomes of the i-th ray at element j, which the loops have left:
 *
 *     ASK            it is inside, and sgt_pass is to bend it
 *     ASK_ANEW       another hit is meant, or the lanes were given no valid ray
 *     ASK_INSIDE     it stops, unless *ray meets the surface within the aperture
 *     STOPS + fate   it stops with the hit that the lanes have found, which has been written; most do */
typedef enum bundle_verdict { ASK = 1, ASK_ANEW, ASK_INSIDE, STOPS = 8 } bundle_verdict;

static int bundle_judge(const bundle_work *job, const tile *w, size_t i, size_t j, const bending *by,
                        sgt_ray *ray)
{
    const sgt_element *e = &job->e[j];
    sgt_status status = (sgt_status)w->status[i];
    double aperture2 = aperture2_of(e->semi_diameter);
    *ray = (sgt_ray){.d = get(w->now.d, i), .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    ray->o = plus(minus(w->base, e->pose.origin), get(w->now.offset, i));
    if (is_turned(&e->pose)) {
        ray->o = to_local(&e->pose, ray->o), ray->d = to_local(&e->pose, ray->d);
        double off = excess(ray->d);
        if (!(fabs(off) <= NEAR_UNIT)) return ASK_ANEW;
        ray->d = kept_unit(ray->d, off);
    }
    if (status > 0 && is_inside(get(w->p, i), aperture2)) { /* it goes on, or is clipped or reflected */
        if (is_obstructed(e, get(w->p, i))) return STOPS + SGT_CLIPPED;
        if (by->kind == BY_WAVES) {
            const kick k = kick_of(e->phase, w->medium, index_behind(e, w->medium), e->index == SGT_MIRROR);
            const waves_here here = sgt_waves_at(e->phase, get(w->p, i));
            const bool facets = is_faceted(e->phase);
            const kicked b = facets ? facet_by(k.back, k, here.g, ray->d, get(&w->n_, i))
                                    : kick_by(k.back, k, here.g, ray->d, get(&w->n_, i));
            return in_range(b.G) && b.q <= 0 ? STOPS + (facets ? SGT_TIR : SGT_EVANESCENT) : ASK;
        }
        if (by->kind == STRAIGHT || by->kind == BY_PHASE) return ASK;
        bent b = bent_by(by->kind, by->r, by->k, ray->d, get(&w->n_, i));
        return in_range(b.G) && b.D < 0 ? STOPS + SGT_TIR : ASK;
    }
    if (w->status[i] == SGT_HARD) return ASK_ANEW;
    return aperture2 < HUGE_VAL && is_worth_more(status) ? ASK_INSIDE : STOPS + stopped_by(status);
}

/* Rays that are asked together whether they meet the surface inside; of: their places in the tile. */
typedef double few[SGT_FEW];
typedef struct chords {
    size_t n, of[SGT_FEW];
    few ox, oy, oz, dx, dy, dz, tmin, tmax, t_tol, x, y, z;
    int evals[SGT_FEW];
    sgt_status status[SGT_FEW];
    sgt_extents kept;
} chords;

static void put_chord(chords *c, size_t k, size_t of, const sgt_ray *ray)
{
    c->of[k] = of, c->tmin[k] = ray->tmin, c->tmax[k] = ray->tmax;
    c->ox[k] = ray->o.x, c->oy[k] = ray->o.y, c->oz[k] = ray->o.z;
    c->dx[k] = ray->d.x, c->dy[k] = ray->d.y, c->dz[k] = ray->d.z;
}

static sgt_ray bundle_chord_of(const chords *c, size_t k)
{
    return (sgt_ray){{c->ox[k], c->oy[k], c->oz[k]}, {c->dx[k], c->dy[k], c->dz[k]}, c->tmin[k], c->tmax[k]};
}

static void stops(const bundle_work *job, tile *w, size_t j, size_t i, int evals)
{
    int *told = job->passages ? job->passages[j].hits.evals : NULL;
    if (told) told[w->first + (size_t)w->index[i]] += evals;
    w->good[i] = -(STOPS + stopped_by((sgt_status)w->status[i]));
}

/* Asks what sgt_pass would ask, each question for all rays that are left.  A hit outside, where the chord
 * is longer than the aperture, is looked at by itself. */
static void ask_inside(const bundle_work *job, tile *w, size_t j, chords *c)
{
    const sgt_element *e = &job->e[j];
    double aperture2 = aperture2_of(e->semi_diameter);
    sgt_options own = met_by(&job->opt);
    unsigned long long none[SGT_FEW];
    sgt_tile rays = {.n = c->n, .t_tol = c->t_tol,
                     .rays = {{c->ox, c->oy, c->oz}, {c->dx, c->dy, c->dz}, c->tmin, c->tmax},
                     .hits = {.status = c->status, .evals = c->evals, .p = {c->x, c->y, c->z}}};
    sgt_none_nearer(in_set(e->surface), &rays, &c->kept, none);
    size_t left = 0;
    for (size_t k = 0; k < c->n; k++) {
        size_t i = c->of[k];
        bool nearest = none[k] && is_near((sgt_status)w->status[i], &own);
        sgt_ray ray = bundle_chord_of(c, k);
        if (nearest || !cut_to_chord(&ray, aperture2)) {
            stops(job, w, j, i, 0);
            continue;
        }
        c->t_tol[left] = own.t_tol != 0 ? own.t_tol : tolerance(false, e->semi_diameter, ray.o, ray.d);
        put_chord(c, left++, i, &ray);
    }
    rays.n = left, c->n = 0;
    if (!left) return;
    sgt_intersect_tile(in_set(e->surface), &rays, &own);
    for (size_t k = 0; k < left; k++) {
        bool inside = c->status[k] > 0 && is_inside((sgt_vec3){c->x[k], c->y[k], c->z[k]}, aperture2);
        if (c->status[k] > 0 && !inside) {
            own.t_tol = c->t_tol[k];
            sgt_hit other = sgt_ask_inside(in_set(e->surface), bundle_chord_of(c, k), aperture2, &own,
                                           &inside);
            c->status[k] = other.status, c->evals[k] = other.evals;
        }
        if (inside || may_be_inside(in_set(e->surface), &own, (sgt_status)c->status[k]))
            w->good[c->of[k]] = -ASK_ANEW;
        else stops(job, w, j, c->of[k], c->evals[k]);
    }
}

/* Sets good to a verdict, which is negative, for the rays that the loops have left, where it is not one. */
SGT_NOINLINE static void judge_rest(const bundle_work *job, tile *w, size_t j, const bending *by)
{
    chords c = {.n = 0, .kept = {.radius2 = {0}}};
    rest all;
    rest_of(w, &all);
    for (size_t k = 0; k < all.n; k++) {
        size_t i = all.of[k];
        sgt_ray ray;
        if (w->good[i] < 0) continue; /* an item of the aperture has stopped it */
        int what = bundle_judge(job, w, i, j, by, &ray);
        w->good[i] = -what;
        if (what != ASK_INSIDE) continue;
        c.x[c.n] = w->p->x[i], c.y[c.n] = w->p->y[i];
        put_chord(&c, c.n++, i, &ray);
        if (c.n == SGT_FEW) ask_inside(job, w, j, &c);
    }
    if (c.n) ask_inside(job, w, j, &c);
}

/* Takes the rays that the loops have left through element j.  sound: as in sgt_pass.  If asked is not NULL,
 * the surface's lanes have met them, and there are verdicts. */
SGT_NOINLINE static void pass_rest(const bundle_work *job, tile *w, size_t j, bool sound,
                                   const sgt_hits *asked)
{
    const sgt_element *e = &job->e[j];
    const sgt_passages *told = job->passages ? &job->passages[j] : NULL;
    sgt_options opt = job->opt;
    numbered watched = {opt.watch, opt.watch_data, w->first};
    if (opt.watch) opt.watch = sgt_watch_numbered, opt.watch_data = &watched;
    size_t stopped = 0;
    rest all;
    rest_of(w, &all);
    for (size_t k = 0; k < all.n; k++) {
        size_t i = all.of[k], r = w->first + (size_t)w->index[i];
        sgt_vec3 offset = get(w->now.offset, i), d = get(w->now.d, i);
        twofold path = job->path ? (twofold){w->now.path->hi[i], w->now.path->lo[i]} : twofold_of(0);
        sgt_fate fate;
        int what = asked ? -(int)w->good[i] : ASK_ANEW;
        if (what >= STOPS + SGT_LOST) {
            fate = (sgt_fate)(what - STOPS);
            if (told) tell_vector(told->direction, r, (sgt_vec3){0, 0, 0});
            if (told && w->status[i] <= 0) tell_number(told->opl, r, (double)NAN);
            else if (told && told->opl && e->phase) /* without what the phase adds */
                told->opl[r] = longer(path, w->medium, w->t[i], w->t_lo[i]).hi;
        } else {
            state s = {.base = w->base, .offset = offset, .d = d, .index = w->medium, .path = path};
            s.first = j == 0, s.turned = j > 0 && is_turned(&job->e[j - 1].pose);
            if (what == ASK_ANEW && j == 0) s.t0 = w->moved ? w->t0[i] : -0.0; /* else t is shifted already */
            sgt_passage passage;
            sgt_hit hit;
            if (what == ASK) hit = hit_of(w, i, asked);
            fate = sgt_pass(e, sound, &s, &opt, what == ASK ? &hit : NULL, &passage);
            if (told) tell_passage(told, r, &passage);
            if (fate == SGT_PASSED) {
                put(w->next.offset, i, s.offset);
                put(w->next.d, i, s.d);
                if (job->path) w->next.path->hi[i] = s.path.hi, w->next.path->lo[i] = s.path.lo;
                continue;
            }
        }
        stop(job, w, i, fate, j, j ? plus(w->base, offset) : bundle_ray_of(job->rays, r).o, d, path.hi);
        stopped++;
    }
    if (stopped) close_ranks(job, w, &w->next);
}

/* --------------------------------------------------------------- an element */

/* Takes the rays through element j by the loops, and returns for how many that was all.  n2: the index
 * behind; *asked: what the lanes were asked for, if that was not all rays. */
static double pass_most(const bundle_work *job, tile *w, size_t j, const bending *by, double n2,
                        sgt_hits *asked)
{
    const sgt_element *e = &job->e[j];
    static const sgt_passages none = {0};
    const sgt_passages *told = job->passages ? &job->passages[j] : &none;
    const sgt_hits *h = &told->hits;
    bool turned = is_turned(&e->pose);
    sgt_vec3 shift = minus(w->base, e->pose.origin);
    if (turned) turn_all(w, &e->pose, &shift, e->semi_diameter);
    else place_all(w, &shift, e->semi_diameter);
    for (size_t i = 0; job->opt.t_tol != 0 && i < w->n; i++) w->t_tol[i] = job->opt.t_tol;

    sgt_tile rays = {.n = w->n, .t_tol = w->t_tol,
                     .hits = {.status = w->status, .p = {w->p->x, w->p->y, w->p->z}},
                     .whole = job->opt.t_tol < HUGE_VAL,
                     .slopes = j < KEPT && !job->path ? &w->kept[j] : NULL,
                     .rays = {.o = {w->o->x, w->o->y, w->o->z}, .d = {w->d->x, w->d->y, w->d->z},
                              .tmin = line_begins, .tmax = line_ends}};
    sgt_hits *const ask = &rays.hits;
    if ((by->kind != STRAIGHT && by->kind != BY_PHASE) || h->n[0])
        ask->n[0] = w->n_.x, ask->n[1] = w->n_.y, ask->n[2] = w->n_.z;
    bool shifted = j == 0 && w->moved && (job->path || h->t || h->t_lo || h->t_err);
    bool widened = h->t_err || h->p_err;
    if (job->path || h->t || shifted || widened) ask->t = w->t;
    if (job->path || h->t_lo || shifted) ask->t_lo = w->t_lo;
    if (h->t_err || shifted) ask->t_err = w->t_err;
    if (h->p_err) ask->p_err = w->p_err;
    if (widened) ask->n[0] = w->n_.x, ask->n[1] = w->n_.y, ask->n[2] = w->n_.z;
    bool slopes = aperture2_of(e->semi_diameter) > 0 && proves_by_slope(in_set(e->surface), &job->opt);
    if (h->evals || slopes) ask->evals = w->evals;
    if (slopes) ask->t = w->t, ask->t_lo = w->t_lo, ask->t_err = w->t_err, ask->p_err = w->p_err;
    sgt_options opt = met_by(&job->opt);
    if (slopes) opt.proof = SGT_ESTIMATE;
    size_t met = sgt_intersect_tile(in_set(e->surface), &rays, &opt);
    if (slopes) met = prove_by_slope(e, &rays, aperture2_of(e->semi_diameter), w->p);
    else if (met && asks_unique(&job->opt) && hide_others(e, &rays, aperture2_of(e->semi_diameter), w->p))
        met = 0;
    for (size_t i = 0; met < w->n && i < w->n; i++)
        if (w->status[i] <= 0) w->p->x[i] = (double)NAN; /* not met; the loops test for it */
    if (widened) {
        bool before = j > 0 && is_turned(&job->e[j - 1].pose);
        aside a = aside_of(w->base, e->pose.origin, turned, j == 0, before);
        widen_all(w, &a, j == 0, turned || before, h->t_err);
    }
    if (shifted) shift_all(w->n, w->t0, w->t, w->t_lo, w->t_err);

    tell_statuses(w, h->status, w->status), tell_counts(w, h->evals, w->evals);
    tell_all(w, h->t, w->t), tell_all(w, h->t_lo, w->t_lo), tell_all(w, h->t_err, w->t_err),
        tell_all(w, h->p_err, w->p_err);
    tell_vectors(w, h->p, w->p);
    tell_vectors(w, h->n, &w->n_);

    if (job->path) lengthen_all(w->n, w->medium, w->t, w->t_lo, w->now.path, w->next.path);
    double aperture2 = aperture2_of(e->semi_diameter), good;
    if (by->kind == BY_WAVES) {
        good = kick_tile(job, w, e, n2);
    } else if (e->phase) {
        thin_lens lens = thin_lens_of(e->phase, w->medium, n2, e->index == SGT_MIRROR);
        if (job->path) add_phase_all(w->n, &lens, w->p, w->d, w->next.path);
        good = focus_all(w->n, &lens, aperture2, w->p, w->d, w->next.d, w->good);
    } else {
        good = bend_all(w, by, aperture2);
    }
    tell_vectors(w, told->direction, by->kind == STRAIGHT ? w->d : w->next.d);
    tell_all(w, told->opl, w->next.path->hi);
    if (turned)
        good = return_all(w->n, &e->pose, by->kind != STRAIGHT, w->p, w->next.offset, w->next.d, w->good);
    if (e->aperture) {
        const double verdict = -(double)(STOPS + SGT_CLIPPED);
        good = (double)sgt_aperture_clips_tile(e->aperture, w->n, w->p->x, w->p->y, verdict, w->good);
    }
    if (good < (double)w->n) *asked = rays.hits;
    return good;
}

static void pass_all(const bundle_work *job, tile *w, size_t j)
{
    const sgt_element *e = &job->e[j];
    bool sound = is_plain(e) && is_aperture_sound(e) && is_phase_sound(e), turned = is_turned(&e->pose);
    bool loops = !job->by_hand && sound && is_sound(e, w->medium);
    double n2 = index_behind(e, w->medium), good = 0;
    bending by = bending_of(w->medium, n2, e->index == SGT_MIRROR);
    if (e->phase) by.kind = is_in_waves(e->phase) ? BY_WAVES : BY_PHASE;
    vectors *other = w->now.d == &w->ds[0] ? &w->ds[1] : &w->ds[0];
    w->d = turned ? other : w->now.d; /* bent in place, or left there */
    w->next.offset = turned ? w->o : w->p;
    w->next.d = by.kind == STRAIGHT ? w->now.d : other;
    sgt_hits asked;
    if (loops) good = pass_most(job, w, j, &by, n2, &asked);
    else memset(w->good, 0, sizeof w->good);
    bool some = good < (double)w->n;
    if (some && loops) judge_rest(job, w, j, &by);
    if (some) pass_rest(job, w, j, sound, loops ? &asked : NULL);

    /* one pointer at a time, as with the loops */
    vectors *const free_offset = w->now.offset;
    paths *const free_path = w->now.path;
    w->now.offset = w->next.offset, w->now.d = w->next.d, w->now.path = w->next.path;
    w->next.path = free_path;
    if (turned) w->o = free_offset;
    else w->p = free_offset;
    w->base = e->pose.origin, w->medium = n2;
}

/* ---------------------------------------------------------------- together */

static void trace_tile(const bundle_work *job, tile *w)
{
    const sgt_element *first = job->elements ? job->e : NULL;
    double good = 0;
    w->n = w->whole;
    w->medium = job->index == 0 ? 1 : job->index;
    w->now = (bundle_place){&w->offsets[0], &w->ds[0], &w->some_paths[0]};
    w->next.path = &w->some_paths[1];
    w->o = &w->offsets[1], w->p = &w->offsets[2];
    for (size_t i = 0; i < w->n; i++) w->index[i] = (int)i;
    if (job->path) memset(w->now.path, 0, sizeof *w->now.path);
    if (first) w->base = first->pose.origin;
    bool turned = first && is_turned(&first->pose), loops = first && !job->by_hand;
    if (loops && !turned)
        good = launch_near(w, job->rays, w->base);
    w->moved = good < (double)w->n;
    if (w->moved && loops)
        good = launch_all(w, job->rays, w->base, turned);
    if (!loops) memset(w->good, 0, sizeof w->good);
    if (good < (double)w->n) launch_rest(job, w);
    for (size_t j = 0; j < job->elements && w->n; j++) pass_all(job, w, j);
}

/* Writes the rays that have passed all elements, as they are at return. */
static void tell_passed(const bundle_work *job, tile *w)
{
    const sgt_traced *out = job->out;
    if (!out->o[0]) {
    } else if (job->elements)
        for (size_t i = 0; i < w->n; i++) put(w->o, i, plus(w->base, get(w->now.offset, i)));
    else
        for (size_t i = 0; i < w->n; i++)
            put(w->o, i, bundle_ray_of(job->rays, w->first + (size_t)w->index[i]).o);
    tell_vectors(w, out->o, w->o);
    tell_vectors(w, out->d, w->now.d);
    if (job->path) tell_all(w, out->opl, w->now.path->hi);
    memset(w->status, SGT_PASSED, w->n);
    tell_statuses(w, out->fate, w->status);
    for (size_t i = 0; out->passed && i < w->n; i++) w->evals[i] = (int)job->elements;
    tell_counts(w, out->passed, w->evals);
}

/* Is nothing asked for that a later version may have? */
static bool is_plain_output(size_t elements, const sgt_traced *out, const sgt_passages passages[])
{
    bool plain = ROOM_IS_ZERO(out);
    for (size_t j = 0; passages && j < elements; j++)
        plain = plain && ROOM_IS_ZERO(&passages[j]) && ROOM_IS_ZERO(&passages[j].hits);
    return plain;
}

size_t sgt_trace_batch(size_t elements, const sgt_element e[], double index_before, size_t n, sgt_rays rays,
                       sgt_traced out, const sgt_passages passages[], const sgt_options *opt)
{
    bundle_work job = {.elements = elements, .e = e, .rays = &rays, .out = &out, .passages = passages,
                .index = index_before, .path = out.opl};
    if (opt) job.opt = *opt;
    if (job.opt.pick == SGT_PICK_DEFAULT) job.opt.pick = SGT_NEAR_SEED;
    for (size_t j = 0; passages && j < elements; j++) job.path = job.path || passages[j].opl;
    if (!is_plain_output(elements, &out, passages)) job.opt = sgt_options_invalid;
    job.by_hand = job.opt.watch || !sgt_options_valid(&job.opt);
    tile w;
    for (size_t j = 0; j < KEPT && j < elements && !job.path; j++) slopes_begin(&w.kept[j]);
    size_t most = job.by_hand ? 1 : TILE, all = 0;
    for (w.first = 0; w.first < n; w.first += w.whole) {
        w.whole = n - w.first < most ? n - w.first : most;
        trace_tile(&job, &w);
        tell_passed(&job, &w);
        all += w.n;
    }
    return all;
}
