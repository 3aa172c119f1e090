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
 * THE START.  K = 1.  The gradient at the root differs from that at the start by no more than the second
 * derivative times the way. */
#include "../../num/bits.h"
#include "ahead.h"

typedef struct grid_way {
    const sgt_grid *g;
    departure_sag sag;
    sgt_vec3 o, d;
    double edge_x, edge_y, l2; /* l2: of the direction across the axis */
    ahead_poly r2, z;
} grid_way;

/* The greatest factor of c in the second derivative of the conic, and the least, over a range of r^2;
 * false: there is none. */
static bool conic_bends(const sgt_grid *g, sgt_interval r2, sgt_interval *bends)
{
    const double k1c2 = (1 + g->k) * g->c * g->c, a = 1 - k1c2 * larger(r2.lo, 0), b = 1 - k1c2 * r2.hi,
                 lo = smaller(a, b) - 0x1p-40, hi = larger(a, b) + 0x1p-40;
    if (!(lo > 0x1p-10)) return false;
    const double low = sqrt(lo), high = sqrt(hi);
    *bends =
        (sgt_interval){smaller(1 / high, 1 / (high * high * high)), larger(1 / low, 1 / (low * low * low))};
    return true;
}

/* At least the slope of s + P at r^2, and about it. */
static double grid_slope(const sgt_grid *g, double r2, double bends)
{
    return (g->steep + fabs(g->c) * bends * sqrt(r2)) * (1 + 0x1p-20);
}

static ahead_look grid_way_at(const void *self, double t)
{
    const grid_way *w = self;
    const sgt_vec3 o = w->o, d = w->d;
    double x = o.x + t * d.x, y = o.y + t * d.y, z = o.z + t * d.z;
    const double in_x = larger(smaller(x, w->edge_x), -w->edge_x),
                 in_y = larger(smaller(y, w->edge_y), -w->edge_y),
                 run = larger(x != in_x ? fabs((x - in_x) / d.x) : 0, y != in_y ? fabs((y - in_y) / d.y) : 0),
                 off = run > 0 ? 2 * run * (fabs(d.x) + fabs(d.y)) : 0,
                 lost = 0x1p-50 * (fabs(o.x) + fabs(t * d.x) + fabs(o.y) + fabs(t * d.y));
    sgt_interval bends, r2 = {0, x * x + y * y};
    if (!conic_bends(w->g, r2, &bends)) return (ahead_look){0, 0, HUGE_VAL, HUGE_VAL};
    const double steep = grid_slope(w->g, r2.hi, bends.hi), bend = fabs(w->g->c) * bends.hi + w->g->bend,
                 length = sqrt(w->l2);
    sgt_vec3 n, p = {in_x, in_y, z};
    const double f = sgt_departure_value(&w->sag, p, &n);
    return (ahead_look){f, n.x * d.x + n.y * d.y + n.z * d.z,
                        sgt_departure_rounding(&w->sag, p) + 1.01 * steep * (off + lost) +
                            0x1p-50 * (fabs(o.z) + fabs(t * d.z)) + AHEAD_LEAST,
                        2 * bend * (off + lost) * length + AHEAD_LOST * (steep * length + fabs(d.z)) +
                            AHEAD_LEAST};
}

/* Is one coordinate beyond the edge all along, or r beyond the conic? */
static bool grid_way_off(const void *self, double from, double to)
{
    const grid_way *w = self;
    const double edge[2] = {w->edge_x, w->edge_y}, o[2] = {w->o.x, w->o.y}, d[2] = {w->d.x, w->d.y};
    for (int j = 0; j < 2; j++) {
        double a = o[j] + from * d[j], b = o[j] + to * d[j],
               lost = 0x1p-40 * (fabs(o[j]) + larger(fabs(from), fabs(to)) * fabs(d[j]));
        if (smaller(a, b) - lost > edge[j] || larger(a, b) + lost < -edge[j]) return true;
    }
    const double least2 = larger(sgt_ahead_poly_over(&w->r2, from, to).lo, 0); /* 1 + k may be below 0 */
    return (1 + w->g->k) * w->g->c * w->g->c * least2 > 1 + 0x1p-20;
}

static ahead_over grid_way_over(const void *self, double from, double to)
{
    const grid_way *w = self;
    const double c = w->g->c;
    const ahead_over open = {SGT_ANY_NUMBER, SGT_ANY_NUMBER, false};
    sgt_interval r2 = sgt_ahead_poly_over(&w->r2, from, to), z = sgt_ahead_poly_over(&w->z, from, to), bends;
    if (grid_way_off(w, from, to)) return (ahead_over){SGT_ANY_NUMBER, SGT_ANY_NUMBER, true};
    if (!conic_bends(w->g, r2, &bends)) return open;
    const double k1c2 = (1 + w->g->k) * c * c,
                 in = c * larger(r2.lo, 0) / (1 + sqrt(1 - k1c2 * larger(r2.lo, 0))),
                 out = c * r2.hi / (1 + sqrt(1 - k1c2 * r2.hi)),
                 off = w->g->height * (1 + 0x1p-20) +
                       0x1p-40 * (fabs(in) + fabs(out) + fabs(z.lo) + fabs(z.hi)) + AHEAD_LEAST,
                 bend = w->g->bend * (1 + 0x1p-20), least = smaller(c * bends.lo, c * bends.hi),
                 most = larger(c * bends.lo, c * bends.hi),
                 lost = 0x1p-30 * (fabs(most) + fabs(least)) + AHEAD_LEAST;
    /* a part of the stretch may be beyond the edge, where P is no number: G has those bounds if it went on */
    return (ahead_over){{z.lo - larger(in, out) - off, z.hi - smaller(in, out) + off},
                        {-w->l2 * (most + bend + lost), w->l2 * (bend + lost - least)},
                        false};
}

/* The ray goes along the axis. */
static bool grid_way_tail(const void *self, double t, double sign)
{
    const grid_way *w = self;
    (void)t;
    return w->l2 == 0 && sign * w->d.z > 0;
}

static bool grid_way_start(const void *self, double t, double f, double least, ahead_start *out)
{
    const grid_way *w = self;
    const sgt_vec3 o = {w->o.x + t * w->d.x, w->o.y + t * w->d.y, w->o.z + t * w->d.z}, d = w->d;
    out->width = f / least * (1 + 0x1p-20), out->ratio = 1;
    sgt_vec3 n = {0, 0, 0};
    sgt_interval bends, r2 = sgt_ahead_poly_over(&w->r2, t, t + out->width);
    if (!conic_bends(w->g, r2, &bends) || !(out->width < HUGE_VAL)) return false;
    (void)sgt_departure_value(&w->sag, o, &n);
    const double off = (fabs(w->g->c) * bends.hi + w->g->bend) * sqrt(w->l2) * out->width * (1 + 0x1p-20) +
                       AHEAD_LOST * grid_slope(w->g, r2.hi, bends.hi);
    const double x = larger(fabs(o.x) * (1 - 0x1p-40) - fabs(d.x) * out->width, 0),
                 y = larger(fabs(o.y) * (1 - 0x1p-40) - fabs(d.y) * out->width, 0),
                 z = larger(fabs(o.z) * (1 - 0x1p-40) - fabs(d.z) * out->width, 0);
    out->terms = x * larger(fabs(n.x) - off, 0) + y * larger(fabs(n.y) - off, 0) + z;
    return true;
}

sgt_ahead_kind sgt_grid_ahead(const departure_sag *s, const sgt_ray *ray, sgt_ahead *ahead)
{
    static const ahead_ops ops = {grid_way_at, grid_way_over, grid_way_off, grid_way_tail, grid_way_start};
    const sgt_grid *g = s->self;
    if (!(g->height > 0) || !ahead_usual(ray, g->c, g->step_x)) return AHEAD_OPEN;
    const ahead_poly x = ahead_linear(ray->o.x, ray->d.x), y = ahead_linear(ray->o.y, ray->d.y);
    grid_way w = {.g = g,
                  .sag = *s,
                  .o = ray->o,
                  .d = ray->d,
                  .edge_x = 0.5 * (double)(g->z.columns - 1) * g->step_x,
                  .edge_y = 0.5 * (double)(g->z.rows - 1) * g->step_y,
                  .l2 = (ray->d.x * ray->d.x + ray->d.y * ray->d.y) * (1 + 0x1p-40),
                  .r2 = ahead_sum(ahead_product(&x, &x), ahead_product(&y, &y)),
                  .z = ahead_linear(ray->o.z, ray->d.z)};
    const double edge[2] = {w.edge_x, w.edge_y}, o[2] = {ray->o.x, ray->o.y}, d[2] = {ray->d.x, ray->d.y};
    for (int j = 0; j < 2; j++) {
        double end = (copysign(edge[j], d[j]) - o[j]) / d[j];
        end += 0x1p-20 * (end - ahead->from) + 0x1p-40 * (fabs(end) + fabs(o[j] / d[j]));
        if (d[j] != 0 && end > ahead->from && end < ahead->to && grid_way_off(&w, end, end)) ahead->to = end;
    }
    ahead->part = 1;
    return sgt_look_ahead(&ops, &w, ahead);
}
