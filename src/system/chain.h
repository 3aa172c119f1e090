// SPDX-License-Identifier: MIT
/* chain.h - the chain rule at one element: forward, and backward.
 *
 * All is in the element's frame.  o, d is the ray in front, t the length to the point p = o + t d that is
 * met, n the gradient of F there, d' the direction behind, a the parameters of the surface.
 *
 * THE POINT.  F = 0 stays so (ray/sensitivity.c).  With q = do + t dd and s = n . d,
 *
 *     dt = -(n . q + F_a da) / s,   dp = q + d dt,   dn = H dp + grad F_a da,   dL = n1 dt + t dn1.
 *
 * THE DIRECTION.  d' = r d + f n, |d'| = 1, r = n1 / n2.  So G f^2 + 2 r g f = 1 - r^2, where G = n . n and
 * g = d . n.  Half of its differential is
 *
 *     (G f + r g) df = -f (f n . dn + r d . dn + r n . dd) - dr (r + g f).
 *
 * S = G f + r g is d' . n, f n + r d is d', and r + g f is d . d'.  Hence
 *
 *     df = -(f / S) (d' . dn + r n . dd) - dr (d . d') / S,   dd' = r dd + f dn + n df + dr d.
 *
 * A mirror is r = 1, S = -g: the same formula.  f = (1 - r^2) / (r g + S) is a quotient of numbers that do
 * not cancel, as S has the sign of g (trace.h).  Between equal indices f = 0, and n has no say but by dr.
 *
 * BACKWARD.  Let A_x be the derivative of the one number at the end by x.  Transposed, the above is, with
 * a = A_d', b = a . n / S:
 *
 *     A_n = f (a - b d'),   A_d = r (a - f b n),   A_r = a . d - b (d . d'),
 *     A_p' = A_p + H A_n,   w = -(A_p' . d + n1 A_L) / s,
 *     A_a = w F_a + A_n . grad F_a,   A_o = A_p' + w n,   A_d += t A_o.
 *
 * Nothing but the ray itself is needed: no tape.
 *
 * AN IDEAL LENS has d' and W with derivatives of its own (phase.h) by p, d and the indices, and n has no say:
 *
 *     dd' = D_p dp + D_d dd + D_n1 dn1 + D_n2 dn2,   and W the same, added to L.
 *
 * Transposed, A_L of W comes beside A_d' of d'.  If the ray has not passed, there is no W in its path.
 *
 * A PHASE IN WAVES is like a surface that bends (waves.h), with G and its derivatives besides; facets are one
 * with a normal of their own. */
#ifndef SGT_SYSTEM_CHAIN_H
#define SGT_SYSTEM_CHAIN_H
#include "phase.h"

#include <sagitta/aim.h>

/* W of a phase in waves and its gradient, G = per_wave grad W, and the derivatives of G: xx, xy, xz, yy, yz,
 * zz.  m: the normal that light is bent by.  Of facets G is 0, and h has the derivatives of m. */
typedef struct waves_slopes {
    waves_here at;
    sgt_vec3 G, m;
    double h[6];
} waves_slopes;

/* An element as a ray met it.  bends: n has a say in d'. */
typedef struct chain_link {
    sgt_vec3 d, p, n, after;
    double t, inverse, r, f, by_S, n1, n2; /* inverse = 1 / s, by_S = 1 / S */
    double passed;                         /* 1; NaN: there is no d' */
    double h[6];                           /* H: xx, xy, xz, yy, yz, zz */
    bool bends, own_index;                 /* own_index: behind it the index is its own */
    bool phased;                           /* it has a phase, whose derivatives are in by_phase */
    const sgt_phase *waves;                /* or in by_waves; NULL: it is not in waves */
    union {
        phase_slopes by_phase;
        waves_slopes by_waves;
    };
} chain_link;

SGT_INLINE sgt_vec3 plus_times(sgt_vec3 a, double f, sgt_vec3 b)
{
    return (sgt_vec3){a.x + f * b.x, a.y + f * b.y, a.z + f * b.z};
}

/* The operations of the set; none if the table is not whole. */
SGT_INLINE sgt_surface chain_surface(sgt_surface s)
{
    static const sgt_surface_ops nothing = {0};
    s = in_set(s);
    if (!s.ops || !is_whole(s.ops)) s.ops = &nothing;
    return s;
}

SGT_INLINE size_t chain_parameters(sgt_surface s)
{
    return s.ops->parameters && s.ops->by_parameter ? s.ops->parameters(s.self) : 0;
}

SGT_INLINE bool has_own_index(const sgt_element *e) { return e->index != 0 && e->index != SGT_MIRROR; }

/* The direction of a launch ray, of unit length, and its length before. */
typedef struct unit_launch { sgt_vec3 d; double length; } unit_launch;

SGT_INLINE unit_launch unit_of(sgt_vec3 d)
{
    double scale = scale_of(d);
    sgt_vec3 v = times(scale, d);
    double length = sqrt(dot(v, v)), inverse = 1 / length;
    return (unit_launch){times(inverse, v), length / scale};
}

SGT_INLINE sgt_vec3 into(const sgt_pose *pose, sgt_vec3 a) { return is_turned(pose) ? to_local(pose, a) : a; }
SGT_INLINE sgt_vec3 out_of(const sgt_pose *pose, sgt_vec3 a)
{
    return is_turned(pose) ? to_global(pose, a) : a;
}

/* The index in front of element i. */
SGT_INLINE double chain_index(const sgt_element e[], size_t i, double before)
{
    while (i-- > 0)
        if (has_own_index(&e[i])) return e[i].index;
    return before == 0 ? 1 : before;
}

/* The direction in front of element i, in its frame. */
SGT_INLINE sgt_vec3 chain_direction(const sgt_element e[], size_t i, const sgt_ray *launch,
                                    const sgt_passage passages[])
{
    sgt_vec3 d = i > 0 ? out_of(&e[i - 1].pose, passages[i - 1].direction) : unit_of(launch->d).d;
    return into(&e[i].pose, d);
}

/* Sets f of a phase in waves, and by_S of facets.  If the ray has not passed, there is no S. */
SGT_INLINE void chain_waves(const sgt_phase *a, chain_link *c)
{
    waves_slopes *s = &c->by_waves;
    const bool facets = is_faceted(a), passed = c->passed == 1;
    s->G = passed && !facets ? times(a->per_wave, s->at.g) : (sgt_vec3){0, 0, 0};
    s->m = passed && facets ? facet_normal(s->at.g) : c->n;
    if (facets) c->by_S = c->passed / dot(c->after, s->m);
    const double by = dot(s->m, plus_times(s->G, c->n1, c->d)) / c->n2;
    c->f = (dot(c->after, s->m) - by) / dot(s->m, s->m);
}

/* The derivatives of an element with a phase; NaN behind it and without W if the ray has not passed. */
SGT_INLINE void chain_phase(const sgt_element *e, chain_link *c)
{
    const double none = (double)NAN;
    if (c->waves) {
        if (c->passed == 1) c->by_waves.at = sgt_waves_at(e->phase, c->p);
        chain_waves(e->phase, c);
        return;
    }
    const sgt_vec3 nothing = {none, none, none};
    if (c->passed == 1) {
        phase_slopes_of(e->phase, c->n1, c->n2, c->p, c->d, c->after, &c->by_phase);
        return;
    }
    c->by_phase = (phase_slopes){.by_n1 = {none, none, none, 0}, .by_n2 = {none, none, none, 0}};
    for (int i = 0; i < PHASE_PATH; i++) c->by_phase.by_p[i] = c->by_phase.by_d[i] = nothing;
}

/* Sets what is the same for all rays, with n1 in front.  Returns how they are bent. */
SGT_INLINE bending chain_set(const sgt_element *e, double n1, chain_link *c)
{
    bending by = bending_of(n1, index_behind(e, n1), e->index == SGT_MIRROR);
    c->n1 = n1, c->n2 = index_behind(e, n1), c->r = by.kind == BACK ? 1 : by.r;
    c->own_index = has_own_index(e), c->phased = e->phase != NULL;
    c->waves = c->phased && is_in_waves(e->phase) ? e->phase : NULL;
    c->bends = (by.kind != STRAIGHT && !c->phased) || c->waves;
    if (c->phased) by.kind = c->waves ? BY_WAVES : BY_PHASE;
    return by;
}

/* What the quotients of a link are, for d in front, the gradient n, and the direction `after`.  f of a phase
 * in waves is set later (chain_waves). */
typedef struct chain_slope { double inverse, by_S, f, passed; } chain_slope;

SGT_INLINE chain_slope chain_slope_of(bending by, sgt_vec3 d, sgt_vec3 n, sgt_vec3 after, double met)
{
    const double g = dot(d, n), passed = is_zero(after) ? (double)NAN : 1;
    const bool straight = by.kind == STRAIGHT || by.kind == BY_PHASE;
    double S = straight ? g : dot(after, n), f = 0;
    if (by.kind == BACK) f = -2 * g / dot(n, n);
    else if (!straight && by.kind != BY_WAVES) f = by.k / (by.r * g + S);
    return (chain_slope){met / g, passed / S, f, passed};
}

/* Sets all but H.  d: in front, in the element's frame. */
SGT_INLINE void chain_at(const sgt_element *e, sgt_vec3 d, double n1, const sgt_passage *passage,
                         chain_link *c)
{
    const bending by = chain_set(e, n1, c);
    const double met = passage->hit.status > 0 ? 1 : (double)NAN;
    const chain_slope s = chain_slope_of(by, d, passage->hit.n, passage->direction, met);
    c->p = passage->hit.p, c->n = passage->hit.n, c->t = passage->hit.t, c->d = d;
    c->after = passage->direction;
    c->inverse = s.inverse, c->by_S = s.by_S, c->f = s.f, c->passed = s.passed;
    if (c->phased) chain_phase(e, c);
}

/* Sets H, and that of a phase in waves; NaN if there is none, and false. */
SGT_INLINE bool chain_second(sgt_surface s, chain_link *c)
{
    double *const out[6] = {c->h, c->h + 1, c->h + 2, c->h + 3, c->h + 4, c->h + 5};
    const sgt_points p = {{&c->p.x, &c->p.y, &c->p.z}};
    bool has = s.ops->second;
    if (has) s.ops->second(s.self, 1, p, out);
    for (int i = 0; !has && i < 6; i++) c->h[i] = (double)NAN;
    if (c->waves) {
        double *g = c->by_waves.h, *const second[6] = {g, g + 1, g + 2, g + 3, g + 4, g + 5};
        has = sgt_waves_second(c->waves, 1, p, second) && has;
        for (int i = 0; i < 6; i++) g[i] *= second_factor(c->waves);
    }
    return has;
}

/* The matrix of xx, xy, xz, yy, yz, zz times a. */
SGT_INLINE sgt_vec3 symmetric_product(const double h[6], sgt_vec3 a)
{
    return (sgt_vec3){h[0] * a.x + h[1] * a.y + h[2] * a.z, h[1] * a.x + h[3] * a.y + h[4] * a.z,
                      h[2] * a.x + h[4] * a.y + h[5] * a.z};
}

SGT_INLINE sgt_vec3 chain_bend(chain_link c, sgt_vec3 a) { return symmetric_product(c.h, a); }

/* What of a is across a direction of unit length. */
SGT_INLINE sgt_vec3 across(sgt_vec3 a, sgt_vec3 unit)
{
    const double along = dot(unit, a);
    return (sgt_vec3){a.x - along * unit.x, a.y - along * unit.y, a.z - along * unit.z};
}

SGT_INLINE sgt_vec3 cross_product(sgt_vec3 a, sgt_vec3 b)
{
    return (sgt_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* The change of the point and of t by that of o and d. */
typedef struct chain_shift { sgt_vec3 p; double t; } chain_shift;

SGT_INLINE chain_shift chain_point(chain_link c, sgt_ray_change x)
{
    const sgt_vec3 q = plus_times(x.p, c.t, x.d);
    const double dt = dot(c.n, q) * -c.inverse;
    return (chain_shift){plus_times(q, dt, c.d), dt};
}

/* The change of p, d' and L by that of o, d and L.  There is no phase.  bends: that of the link.
 *
 * FOR LOOPS.  Here and below, links and the like are given by value: a variable whose address is taken inside
 * a loop keeps gcc 12 from making vector code of it.  bends and own_index are constants there. */
SGT_INLINE sgt_ray_change chain_forward_by(bool bends, chain_link c, sgt_ray_change x)
{
    const chain_shift by = chain_point(c, x);
    sgt_vec3 dd = times(c.passed, x.d);
    if (bends) {
        sgt_vec3 dn = chain_bend(c, by.p);
        double df = -c.f * c.by_S * (dot(c.after, dn) + c.r * dot(c.n, x.d));
        dd = plus_times(plus_times(times(c.r, dd), c.f, dn), df, c.n);
    }
    return (sgt_ray_change){by.p, dd, x.opl + c.n1 * by.t};
}

/* The same of a phase in waves (waves.h). */
SGT_INLINE sgt_ray_change waves_forward(const chain_link *c, sgt_ray_change x)
{
    const waves_slopes *s = &c->by_waves;
    const chain_shift at = chain_point(*c, x);
    const bool facets = is_faceted(c->waves);
    const double by = c->passed / c->n2;
    const sgt_vec3 second = symmetric_product(s->h, at.p), none = {0, 0, 0};
    const sgt_vec3 du = times(by, plus_times(facets ? none : second, c->n1, x.d));
    const sgt_vec3 dn = plus_times(du, c->f, facets ? second : chain_bend(*c, at.p));
    const double df = dot(c->after, dn) * c->by_S;
    return (sgt_ray_change){at.p, plus_times(dn, -df, s->m),
                            facets ? (double)NAN : x.opl + dot(s->G, at.p) + c->n1 * at.t};
}

/* The same with a phase or without. */
SGT_INLINE sgt_ray_change chain_forward(const chain_link *c, sgt_ray_change x)
{
    if (c->waves) return waves_forward(c, x);
    if (!c->phased) return chain_forward_by(c->bends, *c, x);
    const phase_slopes *s = &c->by_phase;
    const chain_shift at = chain_point(*c, x);
    double by[PHASE_ROWS];
    for (int i = 0; i < PHASE_ROWS; i++) by[i] = dot(s->by_p[i], at.p) + dot(s->by_d[i], x.d);
    return (sgt_ray_change){at.p, {by[0], by[1], by[2]}, x.opl + by[PHASE_PATH] + c->n1 * at.t};
}

/* What the end has of an element: the adjoints of the point and the direction, of the path, and of the index
 * of the medium there. */
typedef struct chain_back { sgt_vec3 p, d; double opl, index; } chain_back;

/* Of the step backward: the adjoints of the gradient n and of the point as it is met, w, and the adjoints of
 * the indices in front and behind by the direction and a phase. */
typedef struct chain_inside { sgt_vec3 n, p; double w, n1, n2; } chain_inside;

/* A step backward: the adjoints in front, those inside, and that of the direction in front without the share
 * that comes by way of the point (t A_o is not added). */
typedef struct chain_step { chain_back x; chain_inside in; sgt_vec3 front; } chain_step;

/* The rest of the step.  to_p: the adjoint of the point as it is met. */
SGT_INLINE chain_step chain_back_point(chain_link c, chain_inside in, sgt_vec3 to_p, sgt_vec3 front,
                                       chain_back x)
{
    in.p = to_p;
    in.w = (dot(to_p, c.d) + c.n1 * x.opl) * -c.inverse;
    x.p = plus_times(to_p, in.w, c.n);
    x.d = plus_times(front, c.t, x.p);
    return (chain_step){x, in, front};
}

/* From p, d', L and the index behind to o, d, L and the index in front.  turns: the direction behind has a
 * say.  There is no phase; bends and own_index: those of the link (chain_forward_by). */
SGT_INLINE chain_step chain_backward_by(bool bends, bool own_index, chain_link c, bool turns, chain_back x)
{
    chain_inside in = {.n = {0, 0, 0}};
    const sgt_vec3 a = x.d;
    sgt_vec3 to_p = x.p, front = a;
    if (turns) {
        double b = dot(a, c.n) * c.by_S;
        if (bends) {
            in.n = times(c.f, plus_times(a, -b, c.after));
            front = times(c.r, plus_times(a, -c.f * b, c.n));
            to_p = plus(to_p, chain_bend(c, in.n));
        }
        if (own_index) {
            const double r = dot(a, c.d) - b * dot(c.d, c.after);
            in.n1 = r / c.n2, in.n2 = -(c.r / c.n2 * r);
        }
    }
    return chain_back_point(c, in, to_p, front, x);
}

/* The same of a phase in waves (waves.h). */
SGT_INLINE chain_step waves_backward(const chain_link *c, bool turns, chain_back x)
{
    const waves_slopes *s = &c->by_waves;
    chain_inside in = {.n = {0, 0, 0}};
    const bool facets = is_faceted(c->waves);
    const double none = (double)NAN;
    sgt_vec3 to_p = plus_times(x.p, x.opl, s->G), front = {0, 0, 0};
    if (facets && x.opl != 0) to_p = (sgt_vec3){none, none, none};
    if (turns) {
        const double b = dot(x.d, s->m) * c->by_S;
        const sgt_vec3 across_after = plus_times(x.d, -b, c->after), to_u = times(1 / c->n2, across_after);
        const sgt_vec3 to_m = times(c->f, across_after);
        front = times(c->n1, to_u);
        if (facets)
            to_p = plus(to_p, symmetric_product(s->h, to_m));
        else
            in.n = to_m, to_p = plus(to_p, plus(symmetric_product(s->h, to_u), chain_bend(*c, in.n)));
        in.n1 = dot(to_u, c->d), in.n2 = (b - dot(x.d, c->after)) / c->n2;
    }
    return chain_back_point(*c, in, to_p, front, x);
}

/* The same with a phase or without. */
SGT_INLINE chain_step chain_backward(const chain_link *c, bool turns, chain_back x)
{
    if (c->waves) return waves_backward(c, turns, x);
    if (!c->phased) return chain_backward_by(c->bends, c->own_index, *c, turns, x);
    const phase_slopes *s = &c->by_phase;
    const double by[PHASE_ROWS] = {x.d.x, x.d.y, x.d.z, x.opl};
    chain_inside in = {.n = {0, 0, 0}};
    sgt_vec3 to_p = x.p, front = {0, 0, 0};
    for (int i = turns ? 0 : PHASE_PATH; i < PHASE_ROWS; i++) {
        to_p = plus_times(to_p, by[i], s->by_p[i]), front = plus_times(front, by[i], s->by_d[i]);
        in.n1 += by[i] * s->by_n1[i], in.n2 += by[i] * s->by_n2[i];
    }
    return chain_back_point(*c, in, to_p, front, x);
}

#endif
