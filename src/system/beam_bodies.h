// SPDX-License-Identifier: MIT
/* beam_bodies.h - F, its gradient and its second derivatives over a box of points: of bodies, formulas and
 * users'.
 *
 * Of a quadric and an ellipsoid the second derivatives are numbers.  Of a torus with r <= R, with rho^2 = x^2
 * + y^2, F = ((rho - R)^2 + z^2 - r^2) / 2 r has
 *
 *     F_x = x (1 - R / rho) / r,   F_xx = (1 - R y^2 / rho^3) / r,   F_xy = R x y / (rho^3 r),   F_zz = 1 /
 * r.
 *
 * A spindle (r > R) is not known here.  A formula is worked out from its tape (formula.h).
 *
 * With m the middle of the box and v = p - m, F(m + v) is F(m) + grad F(m) . v + v H v / 2, and each
 * component of the gradient F_i(m) + H_i . v, H enclosed all over the box.  So the gradient is off by second
 * order, and F by third. */
#ifndef SGT_SYSTEM_BEAM_BODIES_H
#define SGT_SYSTEM_BEAM_BODIES_H
#include "beam_sags.h"

SGT_COLD static sgt_interval box_part(sgt_interval a, double by)
{
    return sgt_interval_quotient(a, sgt_interval_of(by));
}
SGT_COLD static sgt_interval box_sum(sgt_interval a, sgt_interval b) { return sgt_interval_sum(a, b); }
SGT_COLD static sgt_interval box_scaled(sgt_interval a, double by) { return sgt_interval_scaled(a, by); }

SGT_COLD static bool quadric_box(const sgt_quadric *s, const sgt_interval at[3], sgt_interval *f,
                                 sgt_interval g[3], sgt_interval h[6])
{
    static const int pair[3] = {1, 4, 2}, first[3] = {0, 1, 0}, other[3] = {1, 2, 2}, square[3] = {0, 3, 5};
    *f = sgt_interval_of(s->constant);
    for (int i = 0; i < 3; i++) {
        const sgt_interval own = box_scaled(at[i], s->linear[i]),
                           curve = box_scaled(sgt_interval_square(at[i]), s->squares[i]);
        *f = box_sum(*f, box_sum(own, curve));
        g[i] = box_sum(sgt_interval_of(s->linear[i]), box_scaled(at[i], 2 * s->squares[i]));
        h[square[i]] = sgt_interval_of(2 * s->squares[i]);
    }
    for (int i = 0; i < 3; i++) { /* xy, yz, xz */
        const int a = first[i], b = other[i];
        *f = box_sum(*f, box_scaled(sgt_interval_product(at[a], at[b]), s->products[i]));
        g[a] = box_sum(g[a], box_scaled(at[b], s->products[i])),
        g[b] = box_sum(g[b], box_scaled(at[a], s->products[i]));
        h[pair[i]] = sgt_interval_of(s->products[i]);
    }
    return true;
}

/* a Q b, Q the symmetric matrix of the quadric. */
SGT_COLD static sgt_interval quadric_form(const sgt_quadric *s, const sgt_interval a[3],
                                          const sgt_interval b[3])
{
    static const int first[3] = {0, 1, 0}, other[3] = {1, 2, 2};
    sgt_interval sum = {0, 0};
    for (int i = 0; i < 3; i++) {
        const int m = first[i], n = other[i];
        const sgt_interval mixed =
            box_sum(sgt_interval_product(a[m], b[n]), sgt_interval_product(a[n], b[m]));
        sum = box_sum(sum, box_scaled(sgt_interval_product(a[i], b[i]), s->squares[i]));
        sum = box_sum(sum, box_scaled(mixed, 0.5 * s->products[i]));
    }
    return sum;
}

/* F of lines from o along d where |t| is large: F / t^2 = A + B / t + C / t^2, with 1 / t in u. */
SGT_COLD static sgt_interval quadric_beyond(const sgt_quadric *s, const sgt_interval o[3],
                                            const sgt_interval d[3], sgt_interval u)
{
    sgt_interval C, g[3], h[6], B = box_scaled(quadric_form(s, o, d), 2);
    for (int i = 0; i < 3; i++) B = box_sum(B, box_scaled(d[i], s->linear[i]));
    quadric_box(s, o, &C, g, h);
    return box_sum(quadric_form(s, d, d), sgt_interval_product(u, box_sum(B, sgt_interval_product(u, C))));
}

/* F = (x^2 + y^2 - a^2) / 2a + z^2 a / 2b^2. */
SGT_COLD static bool ellipsoid_box(const sgt_ellipsoid *s, const sgt_interval at[3], sgt_interval *f,
                          sgt_interval g[3], sgt_interval h[6])
{
    const sgt_interval a = sgt_interval_of(s->a), one = {1, 1}, zero = {0, 0};
    const sgt_interval left = sgt_interval_difference(one, sgt_interval_of(s->f)),
                       flat = sgt_interval_quotient(one, sgt_interval_square(left));
    const sgt_interval r2 = box_sum(sgt_interval_square(at[0]), sgt_interval_square(at[1]));
    const sgt_interval sum = box_sum(r2, sgt_interval_product(flat, sgt_interval_square(at[2])));
    *f = sgt_interval_quotient(sgt_interval_difference(sum, sgt_interval_square(a)), box_scaled(a, 2));
    g[0] = sgt_interval_quotient(at[0], a), g[1] = sgt_interval_quotient(at[1], a);
    h[0] = h[3] = sgt_interval_quotient(one, a), h[5] = sgt_interval_product(flat, h[0]);
    g[2] = sgt_interval_product(h[5], at[2]), h[1] = h[2] = h[4] = zero;
    return true;
}

SGT_COLD static bool torus_box(const sgt_torus *s, const sgt_interval at[3], sgt_interval *f,
                               sgt_interval g[3], sgt_interval h[6])
{
    const double R = s->major, r = s->minor;
    const sgt_interval one = {1, 1}, zero = {0, 0}, x2 = sgt_interval_square(at[0]),
                       y2 = sgt_interval_square(at[1]);
    const sgt_interval rho = sgt_interval_square_root(box_sum(x2, y2)),
                       away = sgt_interval_difference(rho, sgt_interval_of(R));
    const sgt_interval rest =
        sgt_interval_difference(sgt_interval_square(at[2]), sgt_interval_square(sgt_interval_of(r)));
    if (!(r <= R)) return false;
    *f = box_part(box_sum(sgt_interval_square(away), rest), 2 * r);
    const sgt_interval in = sgt_interval_quotient(away, rho);
    const sgt_interval by =
        sgt_interval_quotient(sgt_interval_of(R), sgt_interval_product(rho, box_sum(x2, y2)));
    g[0] = box_part(sgt_interval_product(at[0], in), r), g[1] = box_part(sgt_interval_product(at[1], in), r),
    g[2] = box_part(at[2], r);
    h[0] = box_part(sgt_interval_difference(one, sgt_interval_product(by, y2)), r);
    h[3] = box_part(sgt_interval_difference(one, sgt_interval_product(by, x2)), r);
    h[1] = box_part(sgt_interval_product(by, sgt_interval_product(at[0], at[1])), r);
    h[2] = h[4] = zero, h[5] = box_part(one, r);
    return rho.lo > 0;
}

SGT_COLD static bool formula_box(const sgt_tape *tape, const sgt_interval at[3], sgt_interval *f,
                                 sgt_interval g[3], sgt_interval h[6])
{
    static const sgt_interval axes[3][3] = {
        {{1, 1}, {0, 0}, {0, 0}}, {{0, 0}, {1, 1}, {0, 0}}, {{0, 0}, {0, 0}, {1, 1}}};
    const sgt_interval r = sgt_interval_hypotenuse(at[0], at[1]);
    bool whole = true;
    int k = 0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++) {
            const formula_jet here = sgt_formula_jet(tape, at, r, axes[i], axes[j], true);
            h[k] = here.uv, g[i] = here.u, g[j] = here.v, *f = here.f, whole = whole && here.whole;
        }
    return whole;
}

/* Is F known so?  `body`: its seed is the first crossing of the line. */
SGT_COLD static bool beam_has_box(sgt_surface s, bool *body)
{
    *body = s.ops == &sgt_quadric_ops || s.ops == &sgt_ellipsoid_ops || s.ops == &sgt_torus_ops;
    if (*body)
        return !s.ops->own_->object(s.self).param &&
               (s.ops != &sgt_torus_ops ||
                ((const sgt_torus *)s.self)->minor <= ((const sgt_torus *)s.self)->major);
    if (s.ops == &sgt_formula_ops) return !s.ops->own_->object(s.self).param;
    return !s.ops->own_ && box_of(s.ops);
}

SGT_COLD static bool box_over(sgt_surface s, const sgt_interval at[3], sgt_interval *f, sgt_interval g[3],
                     sgt_interval h[6])
{
    if (s.ops == &sgt_quadric_ops) return quadric_box(s.self, at, f, g, h);
    if (s.ops == &sgt_ellipsoid_ops) return ellipsoid_box(s.self, at, f, g, h);
    if (s.ops == &sgt_torus_ops) return torus_box(s.self, at, f, g, h);
    if (s.ops == &sgt_formula_ops) return formula_box(((const sgt_formula *)s.self)->tape, at, f, g, h);
    return box_of(s.ops)(s.self, at, f, g, h);
}

/* F and its gradient at the points of models.  off: of F as computed, at most about. */
SGT_COLD static bool body_models(sgt_surface s, const model3 *p, model *f, model3 *n, double *off)
{
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const sgt_interval at[3] = {model_range(p->x), model_range(p->y), model_range(p->z)},
                       middle[3] = {{p->x.c, p->x.c}, {p->y.c, p->y.c}, {p->z.c, p->z.c}};
    sgt_interval F, G[3], H[6], unread, all[3], here[6];
    if (!box_over(s, middle, &F, G, here) || !box_over(s, at, &unread, all, H)) return false;
    const model v[3] = {model_plus(p->x, -p->x.c), model_plus(p->y, -p->y.c), model_plus(p->z, -p->z.c)};
    model *const to[3] = {&n->x, &n->y, &n->z};
    *f = model_between(F);
    *off = 0;
    for (int i = 0; i < 3; i++) {
        model bent3 = model_number(0);
        for (int j = 0; j < 3; j++) bent3 = model_sum(bent3, model_by(H[place[i][j]], v[j]));
        *f = model_sum(*f, model_product(model_sum(model_between(G[i]), model_scaled(bent3, 0.5)), v[i]));
        *to[i] = model_sum(model_between(G[i]), bent3);
        if (!(to[i]->e < HUGE_VAL)) return false;
        *off += BUNDLE_SLACK * larger(fabs(G[i].lo), fabs(G[i].hi)) * (fabs(middle[i].lo) + 1);
    }
    const sgt_vec3 c = {p->x.c, p->y.c, p->z.c};
    if (s.ops->rounding) *off += 4 * fabs(s.ops->rounding(s.self, c));
    return f->e < HUGE_VAL;
}

#endif
