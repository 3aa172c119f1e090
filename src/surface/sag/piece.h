// SPDX-License-Identifier: MIT
/* piece.h - a ray cut into pieces by rings about the axis.
 *
 * A ring reaches from `in` to `out` of the axis.  It cuts two pieces from a ray, one before the point
 * nearest the axis and one behind it.  With s counted from that point they are [-s_out, -s_in] and [s_in,
 * s_out].  With tau counted from the vertex plane, z = n tau on the ray.  If all z of a piece are above the
 * sag in the ring, or all below, F has no root on the piece.
 *
 * x and y in the vertex plane are right to a few u of themselves, however far away the ray starts
 * (to_vertex_plane).  The margins are 2^-40 of what they are added to, far more than rounding. */
#ifndef SGT_SURFACE_SAG_PIECE_H
#define SGT_SURFACE_SAG_PIECE_H
#include "lanes.h"

SGT_INLINE double lesser(double a, double b) { return chosen(MASK(a < b), a, b); }

/* A ray about the vertex plane, for tau from `from` to `to`.  tau is counted in lengths of d scaled by a
 * power of two, so that its largest component is in [1, 2).  s = tau - foot is 0 at the point nearest the
 * axis, where r = nearest.  s is off by at most `off`, r by at most `aside`. */
typedef struct line { double a, n, foot, nearest, from, to, off, aside; } line;

SGT_INLINE line line_of(sgt_vec3 o, sgt_vec3 way, double tmin, double tmax)
{
    double scale = scale_of(way), inverse = inverse_of_scale(way);
    sgt_vec3 d = {way.x * scale, way.y * scale, way.z * scale};
    line w = {.a = d.x * d.x + d.y * d.y, .n = d.z};
    const vertex_place at = to_vertex_plane(&(sgt_ray){.o = o, .d = d});
    const double t0 = at.t0, x = at.x, y = at.y;
    w.foot = -(x * d.x + y * d.y) / w.a, w.nearest = fabs(x * d.y - y * d.x) / sqrt(w.a);
    w.aside = 0x1p-40 * (fabs(x) + fabs(y)), w.off = 2 * w.aside / sqrt(w.a);
    w.from = tmin * inverse - t0 - 0x1p-40 * fabs(t0);
    w.to = tmax * inverse - t0 + 0x1p-40 * fabs(t0);
    return w;
}

/* Are the numbers in range? */
SGT_INLINE mask line_in_range(const line *w)
{
    return MASK(w->a > 0x1p-400) & MASK(w->a < 0x1p400) & MASK(w->n * w->n > 0x1p-200)
           & MASK(w->n * w->n < 0x1p400) & MASK(fabs(w->foot) < 0x1p400) & MASK(w->nearest < 0x1p400)
           & MASK(w->from <= w->to);
}

typedef struct piece { double s_in, s_out; mask passed_by; } piece;

SGT_INLINE piece piece_of(const line *w, double in, double out)
{
    double far = w->nearest + w->aside, near = larger(w->nearest - w->aside, 0);
    double more = 1 + 0x1p-40, less = 1 - 0x1p-40;
    piece p = {.passed_by = MASK(out < near)};
    p.s_in = sqrt(larger(in * in * less - far * far * more, 0) / w->a) * less - w->off;
    p.s_out = sqrt(larger(out * out * more - near * near * less, 0) / w->a) * more + w->off;
    return p;
}

/* True if the ray has no root where s is in [begins, ends]: the sag is in [bottom, top] there, and the ray
 * is above or below it, or does not reach there.  A NaN in one of them tells nothing. */
SGT_INLINE mask is_apart(const line *w, double begins, double ends, double bottom, double top)
{
    double from = larger(w->foot + begins, w->from), to = lesser(w->foot + ends, w->to);
    double z1 = w->n * from, z2 = w->n * to, slack = 0x1p-40 * (fabs(z1) + fabs(z2));
    return MASK(from > to) | MASK(lesser(z1, z2) - slack > top) | MASK(larger(z1, z2) + slack < bottom);
}

#endif
