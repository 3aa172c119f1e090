// SPDX-License-Identifier: MIT
/* grid_ahead.c - grid.c on its conic, looked along by bounds of the whole grid (ahead.c).
 *
 * G is F = z - s(r^2) - P itself.  |P| is at most `height`, and its second derivative at most `bend`, as
 * sgt_grid_measure has them.  With phi^2 = 1 - (1 + k) c^2 r^2 the second derivative of the conic along a
 * unit vector is between c / phi and c / phi^3.  So both G and G'' have bounds over a stretch, from the
 * range of r^2.
 *
 * OUTSIDE the rectangle F is not defined.  There P is thought to go on linearly in t, from where the ray
 * crosses the edge: G is as smooth, and has the same bounds on G''.  P at the nearest point of the rectangle
 * is off from that by at most the slope times twice the way from the edge.  The way ends where the ray has
 * left the rectangle by 2^-20.
 *
 * A LOOK is F by departure.c, with one bound on the rounding of P for all of the grid (grid.c).
 *
 * THE START.  K = 1.  The gradient at the root differs from that at the start by no more than the second
 * derivative times the way. */
#include "ahead.h"

typedef struct grid_way {
    const sgt_grid *g;
    departure_sag sag;
    sgt_shared shared; /* the base, and the rounding of P */
    const sgt_ahead *ray;
    double edge_x, edge_y;
    ahead_row l2; /* of the direction across the axis */
    ahead_quadratics r2;
} grid_way;

/* The greatest factor of c in the second derivative of the conic, and the least, over a range of r^2; the
 * greatest is infinite if there is none. */
SGT_INLINE sgt_interval conic_bends(double k1c2, sgt_interval r2)
{
    const double a = 1 - k1c2 * larger(r2.lo, 0), b = 1 - k1c2 * r2.hi, lo = smaller(a, b) - 0x1p-40,
                 hi = larger(a, b) + 0x1p-40, low = sqrt(larger(lo, 0)), high = sqrt(larger(hi, 0));
    return (sgt_interval){smaller(1 / high, 1 / (high * high * high)),
                          chosen(MASK(lo > 0x1p-10), larger(1 / low, 1 / (low * low * low)), HUGE_VAL)};
}

/* At least the slope of s + P at r^2, and about it. */
SGT_INLINE double grid_slope(double steep, double c, double r2, double bends)
{
    return (steep + fabs(c) * bends * sqrt(larger(r2, 0))) * (1 + 0x1p-20);
}

/* The nearest points of the rectangle, and how far G may be off from F there, because of that and rounding.
 */
SGT_KERNEL
static void grid_points_at(const grid_way *w, size_t first, size_t n, const double *t, double *restrict px,
                           double *restrict py, double *restrict pz, double *restrict off)
{
    const sgt_ahead *e = w->ray;
    const double X = w->edge_x, Y = w->edge_y;
    LANES for (size_t i = first; i < n; i++)
    {
        const double at = t[i], dx = e->d[0][i], dy = e->d[1][i], tx = at * dx, ty = at * dy,
                     x = e->o[0][i] + tx, y = e->o[1][i] + ty, in_x = larger(smaller(x, X), -X),
                     in_y = larger(smaller(y, Y), -Y), over_x = fabs(x - in_x), over_y = fabs(y - in_y),
                     run_x = chosen(MASK(over_x > 0), over_x / fabs(dx), 0),
                     run_y = chosen(MASK(over_y > 0), over_y / fabs(dy), 0), run = larger(run_x, run_y);
        const double away = chosen(MASK(run > 0), 2 * run * (fabs(dx) + fabs(dy)), 0);
        px[i] = in_x, py[i] = in_y, pz[i] = e->o[2][i] + at * e->d[2][i];
        off[i] = away + 0x1p-50 * (fabs(e->o[0][i]) + fabs(tx) + fabs(e->o[1][i]) + fabs(ty));
    }
}

SGT_KERNEL
static void grid_looks(const grid_way *w, size_t first, size_t n, const double *t, const double *off,
                       const double *const grad[3], const double *own, ahead_looks *restrict out)
{
    const sgt_ahead *e = w->ray;
    const double c = w->g->c, k1c2 = (1 + w->g->k) * c * c, steepest = w->g->steep, bent = w->g->bend;
    const double *nx = grad[0], *ny = grad[1], *nz = grad[2];
    LANES for (size_t i = first; i < n; i++)
    {
        const double at = t[i], dx = e->d[0][i], dy = e->d[1][i], dz = e->d[2][i], x = e->o[0][i] + at * dx,
                     y = e->o[1][i] + at * dy, r2 = x * x + y * y, far = off[i];
        const sgt_interval bends = conic_bends(k1c2, (sgt_interval){0, r2});
        const double steep = grid_slope(steepest, c, r2, bends.hi), bend = fabs(c) * bends.hi + bent,
                     length = sqrt(w->l2[i]),
                     err = own[i] + 1.01 * steep * far + 0x1p-50 * (fabs(e->o[2][i]) + fabs(at * dz)) +
                           AHEAD_LEAST;
        out->slope[i] = nx[i] * dx + ny[i] * dy + nz[i] * dz;
        out->err[i] = chosen(MASK(bends.hi < HUGE_VAL), err, HUGE_VAL);
        out->slope_err[i] = 2 * bend * far * length + AHEAD_LOST * (steep * length + fabs(dz)) + AHEAD_LEAST;
    }
}

static void grid_way_at(const void *self, size_t i, size_t n, const double *t, ahead_looks *out)
{
    const grid_way *w = self;
    ahead_row p[3], grad[3], off, own;
    grid_points_at(w, i, n, t, p[0], p[1], p[2], off);
    const sgt_points at = {{p[0] + i, p[1] + i, p[2] + i}};
    sgt_departure_values_rounded(&w->sag, &w->shared, NULL, n - i, at,
                                 (sgt_values){out->g + i, {grad[0] + i, grad[1] + i, grad[2] + i}}, own + i);
    const double *const of[3] = {grad[0], grad[1], grad[2]};
    grid_looks(w, i, n, t, off, of, own, out);
}

/* Is one coordinate beyond the edge all along? */
SGT_INLINE mask beyond_edge(double edge, double o, double d, double from, double to)
{
    const double a = o + from * d, b = o + to * d,
                 lost = 0x1p-40 * (fabs(o) + larger(fabs(from), fabs(to)) * fabs(d));
    return MASK(smaller(a, b) - lost > edge) | MASK(larger(a, b) + lost < -edge);
}

/* Nothing is there if a coordinate is beyond the edge all along, or r beyond the conic.  A part of the
 * stretch may be beyond the edge, where P is no number: G has those bounds if it went on. */
SGT_KERNEL
static void grid_way_over(const void *self, size_t first, size_t n, const double *from, const double *to,
                          ahead_overs *restrict out)
{
    const grid_way *w = self;
    const sgt_ahead *e = w->ray;
    const double c = w->g->c, k1c2 = (1 + w->g->k) * c * c, bent = w->g->bend * (1 + 0x1p-20),
                 height = w->g->height * (1 + 0x1p-20), X = w->edge_x, Y = w->edge_y;
    LANES for (size_t i = first; i < n; i++)
    {
        const double a = from[i], b = to[i], l2 = w->l2[i];
        const sgt_interval r2 = ahead_range(ahead_quadratic_of(&w->r2, i), a, b),
                           z = ahead_range(ahead_linear(e->o[2][i], e->d[2][i]), a, b),
                           bends = conic_bends(k1c2, r2);
        const double least2 = larger(r2.lo, 0), /* 1 + k may be below 0 */
            in = c * least2 / (1 + sqrt(1 - k1c2 * least2)), edge = c * r2.hi / (1 + sqrt(1 - k1c2 * r2.hi)),
                     off = height + 0x1p-40 * (fabs(in) + fabs(edge) + fabs(z.lo) + fabs(z.hi)) + AHEAD_LEAST,
                     least = smaller(c * bends.lo, c * bends.hi), most = larger(c * bends.lo, c * bends.hi),
                     lost = 0x1p-30 * (fabs(most) + fabs(least)) + AHEAD_LEAST;
        const mask none = beyond_edge(X, e->o[0][i], e->d[0][i], a, b) |
                          beyond_edge(Y, e->o[1][i], e->d[1][i], a, b) | MASK(k1c2 * least2 > 1 + 0x1p-20),
                   known = MASK(bends.hi < HUGE_VAL);
        out->none[i] = chosen(none, 1, 0);
        out->g_lo[i] = chosen(known, z.lo - larger(in, edge) - off, -HUGE_VAL);
        out->g_hi[i] = chosen(known, z.hi - smaller(in, edge) + off, HUGE_VAL);
        out->bend_lo[i] = chosen(known, -l2 * (most + bent + lost), -HUGE_VAL);
        out->bend_hi[i] = chosen(known, l2 * (bent + lost - least), HUGE_VAL);
    }
}

/* The ray goes along the axis. */
static void grid_way_tail(const void *self, size_t first, size_t n, const double *t, const double *sign,
                          double *none)
{
    const grid_way *w = self;
    (void)t;
    for (size_t i = first; i < n; i++) none[i] = w->l2[i] == 0 && sign[i] * w->ray->d[2][i] > 0 ? 1 : 0;
}

static void grid_way_start(const void *self, size_t first, size_t n, const double *t, const double *f,
                           const double *least, ahead_starts *out)
{
    const grid_way *w = self;
    const sgt_ahead *e = w->ray;
    const double c = w->g->c, k1c2 = (1 + w->g->k) * c * c;
    ahead_row p[3], grad[3], unread;
    for (size_t i = first; i < n; i++)
        for (int j = 0; j < 3; j++) p[j][i] = e->o[j][i] + t[i] * e->d[j][i];
    sgt_departure_values(&w->sag, n - first, (sgt_points){{p[0] + first, p[1] + first, p[2] + first}},
                         (sgt_values){unread, {grad[0] + first, grad[1] + first, grad[2] + first}});
    for (size_t i = first; i < n; i++) {
        const double width = f[i] / least[i] * (1 + 0x1p-20);
        const sgt_interval r2 = ahead_range(ahead_quadratic_of(&w->r2, i), t[i], t[i] + width),
                           bends = conic_bends(k1c2, r2);
        const double off = (fabs(c) * bends.hi + w->g->bend) * sqrt(w->l2[i]) * width * (1 + 0x1p-20) +
                           AHEAD_LOST * grid_slope(w->g->steep, c, r2.hi, bends.hi);
        double at[3];
        for (int j = 0; j < 3; j++)
            at[j] = larger(fabs(p[j][i]) * (1 - 0x1p-40) - fabs(e->d[j][i]) * width, 0);
        out->width[i] = bends.hi < HUGE_VAL && width < HUGE_VAL ? width : (double)NAN, out->ratio[i] = 1;
        out->terms[i] =
            at[0] * larger(fabs(grad[0][i]) - off, 0) + at[1] * larger(fabs(grad[1][i]) - off, 0) + at[2];
    }
}

/* Where the ray has left the rectangle. */
SGT_KERNEL
static void grid_way_begin(grid_way *restrict w, size_t n, sgt_ahead *restrict e)
{
    const double edge[2] = {w->edge_x, w->edge_y};
    LANES for (size_t i = 0; i < n; i++)
    {
        const double dx = e->d[0][i], dy = e->d[1][i];
        w->l2[i] = (dx * dx + dy * dy) * (1 + 0x1p-40);
        ahead_quadratic_put(&w->r2, i, ahead_sum(ahead_square(e->o[0][i], dx), ahead_square(e->o[1][i], dy)));
    }
    for (int j = 0; j < 2; j++) {
        const double far = edge[j];
        LANES for (size_t i = 0; i < n; i++)
        {
            const double o = e->o[j][i], d = e->d[j][i], there = (copysign(far, d) - o) / d,
                         end =
                             there + (0x1p-20 * (there - e->from[i]) + 0x1p-40 * (fabs(there) + fabs(o / d)));
            const mask ends = MASK(d != 0) & MASK(end > e->from[i]) & MASK(end < e->to[i]) &
                              beyond_edge(far, o, d, end, end);
            e->to[i] = chosen(ends, end, e->to[i]);
        }
    }
}

void sgt_grid_ahead(const departure_sag *s, size_t n, sgt_ahead *e)
{
    static const ahead_ops ops = {grid_way_at, grid_way_over, grid_way_tail, grid_way_start};
    const sgt_grid *g = s->self;
    const size_t rows = ahead_rows(n);
    if (!(g->height > 0)) return;
    grid_way w;
    w.g = g, w.sag = *s, w.ray = e;
    w.edge_x = 0.5 * (double)(g->z.columns - 1) * g->step_x;
    w.edge_y = 0.5 * (double)(g->z.rows - 1) * g->step_y;
    w.shared = (sgt_shared){.base_c = s->base ? s->c : 0, .base_k = s->base ? s->k : 0, .most2 = HUGE_VAL};
    s->of->noise(g, 0, w.shared.noise);
    if (!(w.shared.noise[0] < HUGE_VAL)) return;
    grid_way_begin(&w, rows, e);
    ahead_drop_unusual(g->c, g->step_x, rows, e);
    sgt_look_ahead(&ops, &w, n, 1, e);
}
