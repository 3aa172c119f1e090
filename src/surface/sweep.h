/* sweep.h - a tile of rays met quickly: what the sweeps of the sags share.
 *
 * A sweep has two loops.  The first goes from the ray to its root near the vertex plane, the second from there to the
 * point, the gradient, and whether it counts; between the two a ray is a `near_root`, in arrays that stay in the
 * first cache.  One loop would do, but a root, three quotients and what is between them are a chain of more than a
 * hundred cycles, as long as a processor can look ahead: in two loops it has several rays' chains at work (a conic:
 * 5.5 ns a ray in one loop, 3.2 in two). */
#ifndef SGT_SURFACE_SWEEP_H
#define SGT_SURFACE_SWEEP_H

#include "../num/lanes.h"
#include "sag.h"

/* The ray at its root: t = t0 + small, the point (x, y, 0) + tau d.  tau_err bounds the error of tau; t_err is NaN where
 * the quick form gives no answer. */
typedef struct near_root { double x, y, tau, t, t_err, tau_err, t0, small; } near_root;

/* The ray met; hit: certainly, and it counts. */
typedef struct lane { double t, t_err, t_lo, px, py, pz, nx, ny, p_err; mask hit; } lane;

/* (x, y, 0) where the ray meets the vertex plane, in t0 + t0_lo: each coordinate is rounded twice, and t0 + t0_lo is off
 * by 9 u^2 |t0|. */
SGT_INLINE void to_vertex_plane(double ox, double oy, double oz, double l, double m, double n, double *t0, double *t0_lo, double *x, double *y)
{
    double inverse = 1 / n;
    *t0 = -oz * inverse;
    *t0_lo = fma(-*t0, n, -oz) * inverse;
    *x = fma(*t0_lo, l, fma(*t0, l, ox));
    *y = fma(*t0_lo, m, fma(*t0, m, oy));
}

/* Does the root count?  The rules of sag.h, where they are certain by far: the start is farther from the root than any
 * rounding, t is as sharp as it can be.  g is what takes (px, py) to the gradient (g px, g py, 1). */
SGT_INLINE lane lane_of(const near_root *r, double l, double m, double n, double tmin, double tmax, double t_tol, double pz, double g, double rim2, mask also)
{
    double px = fma(r->tau, l, r->x), py = fma(r->tau, m, r->y), at = fabs(r->t), r2 = px * px + py * py, none = (double)NAN;
    mask hit = also & MASK(r->t_err <= larger(40 * SGT_U * at, t_tol)) & MASK(r->t - tmin > 0x1p-42 * (at + fabs(r->tau)))
             & MASK(r2 <= rim2) & MASK(r->t <= tmax);
    lane e = {.hit = hit, .t = chosen(hit, r->t, none), .t_err = chosen(hit, r->t_err, none),
              .px = chosen(hit, px, none), .py = chosen(hit, py, none), .pz = chosen(hit, pz, none),
              .nx = chosen(hit, px * g, none), .ny = chosen(hit, py * g, none)};
    e.t_lo = chosen(hit, two_sum(r->t0, r->small).lo, none);
    double length = fabs(l) + fabs(m) + fabs(n), place = (2 * (fabs(r->x) + fabs(r->y)) + (fabs(px) + fabs(py))) + fabs(pz);
    e.p_err = chosen(hit, 1.01 * fma(length, r->tau_err + 16 * SGT_U * SGT_U * fabs(r->t0), SGT_U * place), none);
    return e;
}

/* A hit of a single ray, as a tile has it. */
SGT_INLINE sgt_hit hit_of_lane(const lane *e, int evals, double f)
{
    return (sgt_hit){.status = SGT_HIT, .evals = evals, .t = e->t, .t_err = e->t_err, .t_lo = e->t_lo, .lo = e->t - e->t_err,
                     .hi = e->t + e->t_err, .f = f, .p = {e->px, e->py, e->pz}, .n = {e->nx, e->ny, 1}, .p_err = e->p_err};
}

/* Between the loops; a register's load does not straddle two lines of the cache. */
typedef struct sweep_room {
    _Alignas(64) double x[SGT_TILE];
    double y[SGT_TILE], tau[SGT_TILE], t[SGT_TILE], t_err[SGT_TILE], tau_err[SGT_TILE], t0[SGT_TILE], small[SGT_TILE];
    double unwanted[SGT_TILE], tmax[SGT_TILE];
    mask hit[SGT_TILE];
} sweep_room;

SGT_INLINE double *wanted(double *a, sweep_room *room) { return a ? a : room->unwanted; }

/* tmax = 0 with tmin >= 0 stands for infinity. */
SGT_INLINE const double *far_ends(const sgt_tile *tile, sweep_room *room)
{
    const double *tmin = tile->rays.tmin, *tmax = tile->rays.tmax;
    mask any = 0;
    for (size_t i = 0; i < tile->n; i++) any |= MASK(tmax[i] == 0);
    if (!any) return tmax;
    for (size_t i = 0; i < tile->n; i++) room->tmax[i] = tmax[i] == 0 && tmin[i] >= 0 ? HUGE_VAL : tmax[i];
    return room->tmax;
}

/* Status and evals of the hits; the rest is hard. */
SGT_INLINE size_t sweep_told(const sgt_tile *tile, const sweep_room *room, int evals, mask all)
{
    signed char *status = tile->hits.status;
    long long hard = 0;
    if (all) memset(status, SGT_HIT, tile->n);
    for (size_t i = 0; !all && i < tile->n; i++) {
        status[i] = (signed char)((room->hit[i] & (SGT_HIT - SGT_HARD)) + SGT_HARD);
        hard += 1 + room->hit[i];
    }
    for (size_t i = 0; tile->hits.evals && i < tile->n; i++) tile->hits.evals[i] = evals;
    return (size_t)hard;
}

/* The two loops around START(i), a near_root, and END(i, root), a lane.  rich: t_lo and p_err are wanted.  all, -1 before, is
 * 0 if not all rays have met. */
#define SWEEP(tile, room, rich, START, END, all)                                                                                   \
    do {                                                                                                                      \
        const size_t n_ = (tile)->n;                                                                                          \
        const sgt_hits *h_ = &(tile)->hits;                                                                                   \
        double *t_ = wanted(h_->t, room), *t_err_ = wanted(h_->t_err, room), *px_ = wanted(h_->p[0], room),                   \
               *py_ = wanted(h_->p[1], room), *pz_ = wanted(h_->p[2], room), *nx_ = wanted(h_->n[0], room),                   \
               *ny_ = wanted(h_->n[1], room), *nz_ = wanted(h_->n[2], room), *t_lo_ = wanted(h_->t_lo, room),                 \
               *p_err_ = wanted(h_->p_err, room);                                                                             \
        LANES for (size_t i = 0; i < n_; i++)                                                                                 \
        {                                                                                                                     \
            near_root r_ = START(i);                                                                                          \
            (room)->x[i] = r_.x, (room)->y[i] = r_.y, (room)->tau[i] = r_.tau, (room)->t[i] = r_.t, (room)->t_err[i] = r_.t_err; \
            if (rich) (room)->tau_err[i] = r_.tau_err, (room)->t0[i] = r_.t0, (room)->small[i] = r_.small;                    \
        }                                                                                                                     \
        _Pragma("omp simd reduction(& : all)") for (size_t i = 0; i < n_; i++)                                                \
        {                                                                                                                     \
            near_root r_ = {(room)->x[i], (room)->y[i], (room)->tau[i], (room)->t[i], (room)->t_err[i],                       \
                            rich ? (room)->tau_err[i] : 0, rich ? (room)->t0[i] : 0, rich ? (room)->small[i] : 0};            \
            lane e_ = END(i, &r_);                                                                                            \
            t_[i] = e_.t, t_err_[i] = e_.t_err, px_[i] = e_.px, py_[i] = e_.py, pz_[i] = e_.pz;                               \
            nx_[i] = e_.nx, ny_[i] = e_.ny, nz_[i] = chosen(e_.hit, 1, (double)NAN), (room)->hit[i] = e_.hit, all &= e_.hit; \
            if (rich) t_lo_[i] = e_.t_lo, p_err_[i] = e_.p_err;                                                               \
        }                                                                                                                     \
    } while (0)

#endif
