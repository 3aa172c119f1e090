// SPDX-License-Identifier: MIT
/* edge.c - the area of a box on either side of curves g(s, t) = 0.
 *
 * Let x be the one of s, t along which the first g changes most, y the other.  Over the box |g_x| >= m > 0,
 * by the coefficients: all |s|, |t| <= 1.  The box is divided into STRIPS of y = y0 + v, |v| <= h.  At y0 a
 * curve is at x0.  As |g_y| <= M', in the strip it is nearer to x0 than M' h / m.  So a strip is in at least
 * up to the nearest curve, and out beyond one of them.
 *
 * OF ONE CURVE in a strip more is known.  Along the line x = x0 + k v, k = -g_y / g_x at (x0, y0),
 *
 *     |g| <= |g(x0, y0)| + M (1 + |k|)^2 h^2 / 2,
 *
 * M a bound on second derivatives; so the curve is nearer to the line, in x, than that over m.
 *
 * AREAS have the weight 1 + w s of s.  With F(x) the integral of the weight up to x, an area at a line of
 * slope k is F(x0) to second order, for F is a parabola: what is left out is |w| k^2 h^2 / 12.  If the line
 * is t = x0 + k v, the weight changes along it, and the mean of v is not 0, but below w h^2 / 3 of the strip.
 */
#include "edge.h"

#include <string.h>

enum { STRIPS = 16, STEPS = 8 };

/* g and its derivatives, with x and y in place of s and t; and over the box: the least |g_x|, the largest
 * |g_y|, of all second derivatives, and of |g|; what g is off by. */
typedef struct edge_curve {
    double k[SGT_SERIES_ORDER + 1][SGT_SERIES_ORDER + 1];
    double least, across, bend, size, off;
} edge_curve;

static edge_curve curve_of(const sgt_series *g, double slack, bool turned)
{
    edge_curve c = {.k = {{0}}};
    for (int i = 0; i <= SGT_SERIES_ORDER; i++)
        for (int j = 0; i + j <= SGT_SERIES_ORDER; j++)
            c.k[turned ? j : i][turned ? i : j] = g->k[SGT_SERIES_PLACE(i, j)];
    c.least = fabs(c.k[1][0]);
    for (int i = 0; i <= SGT_SERIES_ORDER; i++)
        for (int j = 0; i + j <= SGT_SERIES_ORDER; j++) {
            const double k = fabs(c.k[i][j]);
            if (i > 1 || j > 0) c.least -= i * k;
            c.across += j * k, c.size += k;
            c.bend += fmax(i * (i - 1), fmax(i * j, j * (j - 1))) * k;
        }
    c.off = (g->rest + slack + 0x1p-44 * c.size) * (1 + 0x1p-40);
    return c;
}

/* g, g_x and g_y. */
static void curve_at(const edge_curve *c, double x, double y, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (int i = SGT_SERIES_ORDER; i >= 0; i--) {
        double row = 0, slope = 0;
        for (int j = SGT_SERIES_ORDER - i; j >= 0; j--) slope = slope * y + row, row = row * y + c->k[i][j];
        out[1] = out[1] * x + out[0], out[0] = out[0] * x + row, out[2] = out[2] * x + slope;
    }
}

static double inside_one(double x) { return fmin(fmax(x, -1), 1); }

/* A strip along x: in from `from` to `to`; out below `below` and above `above`. */
typedef struct stretch {
    double from, to, below, above;
} stretch;

/* Where a curve leaves a strip in and out.  The line of the head: x0, its slope and how near the curve is to
 * it; false: there is none, as the strip is in, or out, or the line is not inside the box. */
static bool along_strip(const edge_curve *c, double y0, double h, stretch *s, double line[3])
{
    double v[3], end[2][3], x0 = 0, low = -1, high = 1;
    const double up = c->k[1][0] > 0 ? 1 : -1, reach = c->off + c->across * h;
    curve_at(c, -1, y0, end[0]), curve_at(c, 1, y0, end[1]);
    const double first = up * end[0][0], last = up * end[1][0];
    *s = (stretch){-1, 1, -1, 1};
    if (up > 0 ? last + reach < 0 : first - reach > 0) return false; /* all in */
    if (up > 0 ? first - reach > 0 : last + reach < 0) {             /* all out */
        *s = (stretch){1, -1, 1, -1};
        return false;
    }
    const bool met = first < 0 && last > 0;
    if (!met) x0 = first >= 0 ? -1 : 1; /* it is beyond: nowhere nearer than at this end */
    for (int k = 0; k < STEPS && met; k++) {
        curve_at(c, x0, y0, v);
        *(up * v[0] < 0 ? &low : &high) = x0;
        x0 -= v[0] / v[1];
        if (!(x0 > low && x0 < high)) x0 = 0.5 * (low + high);
    }
    curve_at(c, x0, y0, v);
    const double left = met ? fabs(v[0]) : 0, near = (left + reach) / c->least * (1 + 0x1p-40);
    const double lo = inside_one(x0 - near), hi = inside_one(x0 + near);
    if (up > 0)
        s->to = lo, s->above = hi;
    else
        s->from = hi, s->below = lo;
    const double slope = -v[2] / v[1], by = 1 + fabs(slope);
    line[0] = x0, line[1] = slope;
    line[2] = (left + c->off + 0.5 * c->bend * by * by * h * h) / c->least * (1 + 0x1p-40);
    return met && fabs(x0) + fabs(slope) * h + line[2] < 1;
}

/* The part of the weight 1 + w s, of s from -1 to x. */
static double part_below(double x, double w) { return 0.5 * (x + 1) + 0.25 * w * (x * x - 1); }

void sgt_edge_parts(const sector *of, size_t edges, const sgt_series g[], const double slack[], double *in,
                    double *out)
{
    const double area = sgt_sector_area(of), w = (of->r1 - of->r0) / (of->r1 + of->r0), h = 1.0 / STRIPS;
    edge_curve c[EDGES];
    double inside = 0, outside = 0;
    *in = *out = 0;
    if (edges < 1 || edges > EDGES) return;
    const edge_curve one = curve_of(&g[0], slack[0], false), other = curve_of(&g[0], slack[0], true);
    const bool turned = other.least * (1e-300 + one.across) > one.least * (1e-300 + other.across);
    for (size_t i = 0; i < edges; i++) {
        c[i] = curve_of(&g[i], slack[i], turned);
        if (!(c[i].least > 0x1p-30 * c[i].size) || !(c[i].off + c[i].size < HUGE_VAL)) return;
    }
    for (int strip = 0; strip < STRIPS; strip++) {
        const double y0 = -1 + (2 * strip + 1) * h;
        stretch all = {-1, 1, -1, 1}, s;
        double line[3] = {0, 0, 0}, lean = 0;
        int there = 0, lines = 0;
        for (size_t i = 0; i < edges; i++) {
            double own[3];
            const bool straight = along_strip(&c[i], y0, h, &s, own);
            there += s.from > -1 || s.to < 1;
            if (straight && ++lines == 1) memcpy(line, own, sizeof line);
            all.from = fmax(all.from, s.from), all.to = fmin(all.to, s.to);
            all.below = fmax(all.below, s.below), all.above = fmin(all.above, s.above);
        }
        if (there == 1 && lines == 1 && (!turned || w < 0.5)) {
            lean = turned ? fabs(line[1]) * w * h * h : 0.1 * w * line[1] * line[1] * h * h;
            if (all.to < 1)
                all.to = line[0] - line[2], all.above = line[0] + line[2];
            else
                all.from = line[0] + line[2], all.below = line[0] - line[2];
        }
        const double weight = turned ? part_below(y0 + h, w) - part_below(y0 - h, w) : h;
        const double at[4] = {all.from, all.to, all.below, all.above};
        double F[4];
        for (int k = 0; k < 4; k++) F[k] = turned ? 0.5 * (at[k] + 1) : part_below(at[k], w);
        inside += weight * fmax(F[1] - F[0] - lean, 0);
        outside += weight * (all.below >= all.above ? 1 : fmax(F[2] - lean, 0) + fmax(1 - F[3] - lean, 0));
    }
    *in = area * fmax(inside - 0x1p-40, 0), *out = area * fmax(outside - 0x1p-40, 0);
}
