// SPDX-License-Identifier: MIT
/* error_batch.c - the errors of the ends of many rays: aim_bound.c says what they are, end_error.h has the
 * formulas.
 *
 * A tile of rays goes backward through the elements.  At each the links of all its rays are made, then what
 * the bending and the gradient are off by, then the rows go through: x and y together, and the path if there
 * is a phase.  Each step is a loop over rays.  The path is a sweep of its own, forward. */
#include "chain_batch.h"
#include "end_error.h"
#include "aim.h"

#include <string.h>

enum { ROWS = 3, OF_PATH = 2 };

/* An adjoint of the end. */
typedef struct error_row {
    chain_vectors p, d;
    double opl;
} error_row;

/* With the errors that have been gathered. */
typedef struct error_tile {
    chain_tile link;
    chain_row bent_off, gradient, ok;
    error_row row[ROWS];
    chain_row point, path;
} error_tile;

/* -------------------------------------------------------------------- the point */

SGT_INLINE void link_off_by(gradient_kind kind, chain_tile *b, const sgt_even_asphere *asphere,
                            double *bent_off, double *gradient)
{
    const chain_view v = b->view;
    const size_t n = b->n;
    static const sgt_even_asphere none;
    const sgt_even_asphere a = kind == GRADIENT_OF_ASPHERE ? *asphere : none;
    LANES for (size_t i = 0; i < n; i++)
    {
        const chain_link c = chain_link_of(&v, true, i);
        const bend_off off = bend_off_of(kind, &a, c);
        bent_off[i] = off.bending, gradient[i] = off.gradient;
    }
}

SGT_KERNEL
static void link_off(chain_tile *b, double *bent_off, double *gradient)
{
    const gradient_kind kind = gradient_kind_of(b->s);
    if (kind == GRADIENT_OF_CONIC)
        link_off_by(GRADIENT_OF_CONIC, b, NULL, bent_off, gradient);
    else if (kind == GRADIENT_OF_ASPHERE)
        link_off_by(GRADIENT_OF_ASPHERE, b, b->s.self, bent_off, gradient);
    else
        link_off_by(GRADIENT_OF_OTHER, b, NULL, bent_off, gradient);
}

static void kinks_off(const chain_tile *b, const double *p_err, double *gradient)
{
    for (size_t i = 0; i < b->n; i++) {
        const double off =
            sgt_kink_off(b->s, chain_from(b->view.p, i), p_err[i], chain_from(b->view.normal, i));
        gradient[i] = larger(gradient[i], off);
    }
}

/* clang 14 makes no vector code of the loop below, and would warn of the mark. */
#ifdef __clang__
#define LANES_BY_GCC
#else
#define LANES_BY_GCC LANES
#endif

/* What an element decides for all rays, constants where a loop is written: rows x and y go through it, or if
 * not `two`, x alone; it bends; the direction behind has a say; its frame is turned. */
typedef struct error_case { bool two, bends, turns, turned; } error_case;

SGT_INLINE void error_back_by(error_case of, const error_tile *w, const double *p_err, error_row *x,
                              error_row *y, double *error)
{
    const chain_view v = w->link.view;
    const double opl = x->opl;
    const size_t n = w->link.n;
    LANES_BY_GCC for (size_t i = 0; i < n; i++)
    {
        const chain_link c = chain_link_of(&v, of.bends, i);
        const chain_back back = {chain_get(&x->p, i), chain_get(&x->d, i), opl, 0};
        const chain_back other = {chain_get(&y->p, i), chain_get(&y->d, i), 0, 0};
        error_steps s;
        s.two = of.two, s.direction[0] = back.d, s.direction[1] = other.d;
        s.by[0] = chain_backward_by(of.bends, false, c, of.turns, back);
        s.by[1] = chain_backward_by(of.bends, false, c, of.turns, other);
        const bend_off off = {of.bends ? w->bent_off[i] : 0, of.bends ? w->gradient[i] : 0};
        error[i] += of_element(of.bends, false, c, of.turns, of.turned, p_err[i], off, s);
        chain_put(&x->p, i, s.by[0].x.p), chain_put(&x->d, i, s.by[0].x.d);
        if (of.two) chain_put(&y->p, i, s.by[1].x.p), chain_put(&y->d, i, s.by[1].x.d);
    }
}

SGT_INLINE void error_back_of(bool two, bool turns, const error_tile *w, const double *p_err, error_row *x,
                              error_row *y, double *error)
{
    const bool turned = w->link.turned, bends = w->link.bends;
    if (!turns && turned)
        error_back_by((error_case){two, false, false, true}, w, p_err, x, y, error);
    else if (!turns)
        error_back_by((error_case){two, false, false, false}, w, p_err, x, y, error);
    else if (bends && turned)
        error_back_by((error_case){two, true, true, true}, w, p_err, x, y, error);
    else if (bends)
        error_back_by((error_case){two, true, true, false}, w, p_err, x, y, error);
    else if (turned)
        error_back_by((error_case){two, false, true, true}, w, p_err, x, y, error);
    else
        error_back_by((error_case){two, false, true, false}, w, p_err, x, y, error);
}

SGT_KERNEL
static void error_back(bool turns, const error_tile *w, const double *p_err, error_row *x, error_row *y,
                       double *error)
{
    error_back_of(true, turns, w, p_err, x, y, error);
}

SGT_KERNEL
static void error_back_path(bool turns, const error_tile *w, const double *p_err, error_row *x, double *error)
{
    error_back_of(false, turns, w, p_err, x, x, error);
}

/* The same at a phase, of one row or of two. */
static void error_back_phased(bool two, bool turns, const error_tile *w, const double *p_err, error_row row[],
                              double *error)
{
    const chain_tile *b = &w->link;
    for (size_t i = 0; i < b->n; i++) {
        const chain_link c = chain_phased_link(b, i);
        error_steps s = {.two = two};
        for (int k = 0; k <= two; k++) {
            const chain_back x = {chain_get(&row[k].p, i), chain_get(&row[k].d, i), row[k].opl, 0};
            s.direction[k] = x.d, s.by[k] = chain_backward(&c, turns, x);
            chain_put(&row[k].p, i, s.by[k].x.p), chain_put(&row[k].d, i, s.by[k].x.d);
        }
        const double more = of_phase(b->e, &c, turns, p_err[i], s);
        error[i] += of_element(false, true, c, turns, b->turned, p_err[i], (bend_off){0, 0}, s) + more;
    }
}

static void begin_row(const error_tile *w, int k, error_row *row)
{
    const size_t n = w->link.n;
    const double n1 = w->link.view.n1;
    row->opl = k == OF_PATH;
    for (size_t i = 0; i < n; i++) {
        chain_put(&row->d, i, (sgt_vec3){0, 0, 0});
        chain_put(&row->p, i,
                  k == OF_PATH ? times(-n1, chain_from(w->link.view.d, i)) : (sgt_vec3){k == 0, k == 1, 0});
    }
}

/* The errors of the point and, if `path`, of the path, and the adjoints of the launch ray. */
static void sweep_back(const chain_work *work, bool path, size_t first, size_t n, error_tile *w)
{
    error_row *const x = &w->row[0], *const y = &w->row[1], *const z = &w->row[OF_PATH];
    const int rows = path ? ROWS : OF_PATH;
    for (size_t i = 0; i < n; i++) w->point[i] = w->path[i] = 0;
    for (size_t i = work->elements; i-- > 0;) {
        const sgt_element *e = &work->e[i];
        const double *p_err = work->passages[i].hits.p_err + first;
        const bool turns = i + 1 < work->elements;
        chain_tile *b = &w->link;
        sgt_chain_tile_at(work, i, first, n, b);
        if (b->bends && turns) sgt_chain_tile_second(b);
        if (b->bends && turns && !b->phased) link_off(b, w->bent_off, w->gradient);
        if (b->bends && turns && !b->phased && sgt_has_kinks(b->s)) kinks_off(b, p_err, w->gradient);
        for (int k = 0; k < rows; k++) {
            error_row *row = &w->row[k];
            if (!turns)
                begin_row(w, k, row);
            else
                sgt_chain_into(&e->pose, n, &row->p), sgt_chain_into(&e->pose, n, &row->d);
        }
        if (b->phased)
            error_back_phased(true, turns, w, p_err, x, w->point);
        else
            error_back(turns, w, p_err, x, y, w->point);
        if (path && b->phased)
            error_back_phased(false, turns, w, p_err, z, w->path);
        else if (path)
            error_back_path(turns, w, p_err, z, w->path);
        for (int k = 0; k < rows; k++)
            sgt_chain_out_of(&e->pose, n, &w->row[k].p), sgt_chain_out_of(&e->pose, n, &w->row[k].d);
    }
}

/* What an ulp of each number of the launch ray does to the numbers at the end of which x and y are rows; if
 * not `two`, y does not count.  (w->link.n: as many as in the sweep.) */
SGT_INLINE void grains_by(bool two, const chain_work *work, size_t first, const error_tile *w,
                          const error_row *x, const error_row *y, double *out)
{
    const sgt_rays *rays = work->rays;
    const double opl = x->opl, index = work->index_before == 0 ? 1 : work->index_before, *ok = w->ok;
    const double *ox = rays->o[0] + first, *oy = rays->o[1] + first, *oz = rays->o[2] + first;
    const double *dx = rays->d[0] + first, *dy = rays->d[1] + first, *dz = rays->d[2] + first;
    const size_t n = w->link.n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const sgt_vec3 o = {ox[i], oy[i], oz[i]}, d = {dx[i], dy[i], dz[i]};
        const unit_launch from = unit_of(d);
        const chain_back back = {chain_get(&x->p, i), chain_get(&x->d, i), opl, 0};
        const chain_back other = {chain_get(&y->p, i), chain_get(&y->d, i), 0, 0};
        double grain = of_launch(back, index, o, d, from);
        if (two) grain += of_launch(other, index, o, d, from);
        out[i] = ok[i] != 0 ? grain : (double)NAN;
    }
}

SGT_KERNEL
static void point_grains(const chain_work *work, size_t first, const error_tile *w, double *out)
{
    grains_by(true, work, first, w, &w->row[0], &w->row[1], out);
}

SGT_KERNEL
static void path_grains(const chain_work *work, size_t first, const error_tile *w, double *out)
{
    grains_by(false, work, first, w, &w->row[OF_PATH], &w->row[OF_PATH], out);
}

SGT_KERNEL
static void point_errors(size_t n, const double *error, const double *ok, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = ok[i] != 0 ? of_point(error[i]) : (double)NAN;
}

/* --------------------------------------------------------------------- the path */

/* The path of the polygon through the points, and the error of it.  at: the last point, in global axes. */
typedef struct error_path {
    chain_row hi, lo, off, at[6];
} error_path;

SGT_INLINE far_point far_get(const error_path *w, size_t i)
{
    return (far_point){{w->at[0][i], w->at[1][i]}, {w->at[2][i], w->at[3][i]}, {w->at[4][i], w->at[5][i]}};
}

SGT_INLINE void far_put(error_path *w, size_t i, far_point p)
{
    w->at[0][i] = p.x.hi, w->at[1][i] = p.x.lo, w->at[2][i] = p.y.hi;
    w->at[3][i] = p.y.lo, w->at[4][i] = p.z.hi, w->at[5][i] = p.z.lo;
}

SGT_KERNEL
static void path_begins(size_t n, const double *x, const double *y, const double *z, error_path *w)
{
    static const sgt_pose global = {0};
    LANES for (size_t i = 0; i < n; i++)
    {
        w->hi[i] = w->lo[i] = w->off[i] = 0;
        far_put(w, i, far_point_of(&global, false, (sgt_vec3){x[i], y[i], z[i]}));
    }
}

SGT_INLINE void path_by(bool turned, bool kicks, const chain_tile *b, const double *p_err, error_path *w)
{
    const sgt_pose pose = b->e->pose;
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const sgt_vec3 p = chain_from(v.p, i);
        const far_point from = far_get(w, i), to = far_point_of(&pose, turned, p);
        const twofold before = {w->hi[i], w->lo[i]}, by = length_between(from, to);
        const twofold path = path_with(before, by, v.n1, v.t[i]);
        double off = w->off[i] + of_sum(before, by, v.n1, to);
        if (kicks) off += of_kick(v.n1, v.n2, chain_from(v.d, i), chain_from(v.after, i), p_err[i]);
        if (turned) off += of_axes(p, v.n1, v.n2);
        w->hi[i] = path.hi, w->lo[i] = path.lo, w->off[i] = off;
        far_put(w, i, to);
    }
}

SGT_KERNEL
static void path_all(bool kicks, const chain_tile *b, const double *p_err, error_path *w)
{
    if (b->turned && kicks)
        path_by(true, true, b, p_err, w);
    else if (b->turned)
        path_by(true, false, b, p_err, w);
    else if (kicks)
        path_by(false, true, b, p_err, w);
    else
        path_by(false, false, b, p_err, w);
}

/* With what a phase adds. */
SGT_KERNEL
static void path_in_waves(const chain_tile *b, error_path *w)
{
    const double per_wave = path_per_wave(b->e->phase), *more = b->waves[0];
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const twofold before = {w->hi[i], w->lo[i]}, path = kick_path(per_wave, more[i], before);
        const double passed = v.passed[i];
        w->hi[i] = passed == 1 ? path.hi : before.hi, w->lo[i] = passed == 1 ? path.lo : before.lo;
    }
}

SGT_KERNEL
static void path_by_lens(const chain_tile *b, error_path *w)
{
    const thin_lens by = thin_lens_of(b->e->phase, b->view.n1, b->view.n2, b->e->index == SGT_MIRROR);
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const twofold before = {w->hi[i], w->lo[i]};
        const double more = phase_path(by, chain_from(v.p, i), chain_from(v.d, i));
        const twofold path = twofold_sum(before, twofold_of(more));
        const double passed = v.passed[i];
        w->hi[i] = passed == 1 ? path.hi : before.hi, w->lo[i] = passed == 1 ? path.lo : before.lo;
    }
}

SGT_KERNEL
static void path_ends(size_t n, const double *opl, const error_path *w, const double *more, const double *ok,
                      double *out)
{
    LANES for (size_t i = 0; i < n; i++)
    {
        const twofold path = {w->hi[i], w->lo[i]};
        double off = w->off[i] + fabs(twofold_difference(twofold_of(opl[i]), path).hi);
        off += more[i];
        out[i] = ok[i] != 0 ? told_path(off) : (double)NAN;
    }
}

SGT_NOINLINE static void sweep_path(const chain_work *work, bool phases, size_t first, size_t n,
                                    error_tile *w, double *out)
{
    error_path path;
    chain_row more;
    const sgt_rays *r = work->rays;
    path_begins(n, r->o[0] + first, r->o[1] + first, r->o[2] + first, &path);
    for (size_t i = 0; i < work->elements; i++) {
        if (work->e[i].phase) sgt_chain_tile_at(work, i, first, n, &w->link);
        else sgt_chain_tile_place(work, i, first, n, &w->link); /* no link has a say in the path */
        path_all(!phases, &w->link, work->passages[i].hits.p_err + first, &path);
        if (w->link.phased && w->link.bends) path_in_waves(&w->link, &path);
        else if (w->link.phased) path_by_lens(&w->link, &path);
    }
    for (size_t i = 0; i < n; i++) more[i] = phases ? 1.5 * w->path[i] : 0;
    path_ends(n, work->passages[work->elements - 1].opl + first, &path, more, w->ok, out);
}

/* ---------------------------------------------------------------------- the call */

/* Sets ok to 1 where all hits are positive, else to 0.  Returns how many are. */
SGT_KERNEL
static int which_ok(const chain_work *work, size_t first, size_t n, double *ok)
{
    int good[CHAIN_RAYS], count = 0;
    for (size_t i = 0; i < n; i++) good[i] = 1;
    for (size_t j = 0; j < work->elements; j++) {
        const sgt_status *status = work->passages[j].hits.status;
        if (!status) continue;
        status += first;
        LANES for (size_t i = 0; i < n; i++) good[i] = status[i] > 0 ? good[i] : 0;
    }
#pragma omp simd reduction(+ : count)
    for (size_t i = 0; i < n; i++) ok[i] = good[i], count += good[i];
    return count;
}

static void fill(size_t n, double value, double *out)
{
    for (size_t i = 0; out && i < n; i++) out[i] = value;
}

static void errors_of_tile(const chain_work *work, bool phases, size_t first, size_t n,
                           const sgt_end_errors *out, error_tile *w)
{
    const bool path = phases && (out->path || out->path_grain), point = out->point || out->grain;
    if (path || point) sweep_back(work, path, first, n, w);
    if (out->point) point_errors(n, w->point, w->ok, out->point + first);
    if (out->grain) point_grains(work, first, w, out->grain + first);
    if (out->path_grain && phases) path_grains(work, first, w, out->path_grain + first);
    for (size_t i = 0; out->path_grain && !phases && i < n; i++)
        out->path_grain[first + i] = w->ok[i] == 0 ? (double)NAN : 0;
    if (out->path) sweep_path(work, phases, first, n, w, out->path + first);
}

size_t sgt_trace_error_batch(size_t elements, const sgt_element e[], double index_before,
                             const sgt_traces *traces, sgt_end_errors out)
{
    const chain_work work = {elements, e, index_before, &traces->rays, traces->passages};
    const size_t n = traces->n;
    const bool phases = sgt_any_phase(elements, e);
    error_tile w;
    size_t all = 0;
    const bool plain = ROOM_IS_ZERO(&out);
    if (elements == 0 || !plain) {
        const double all_of = plain ? 0 : (double)NAN;
        fill(n, all_of, out.point), fill(n, all_of, out.path);
        fill(n, all_of, out.grain), fill(n, all_of, out.path_grain);
        return plain ? n : 0;
    }
    for (size_t first = 0; first < n; first += CHAIN_RAYS) {
        const size_t here = n - first < CHAIN_RAYS ? n - first : CHAIN_RAYS;
        all += (size_t)which_ok(&work, first, here, w.ok);
        errors_of_tile(&work, phases, first, here, &out, &w);
    }
    return all;
}
