// SPDX-License-Identifier: MIT
/* gradient.c - derivatives of a whole trace: forward by the launch ray, backward by all parameters (aim.h).
 *
 * chain.h has the formulas of one element.  Between two the ray is turned from frame to frame.  With R the
 * axes of a pose as columns and c its origin, a point q of the frame is c + R q.  Let c move by dc, and the
 * element turn about its own axes by the small angles w, so that R becomes R (1 + [w]x).  Then
 *
 *     the ray in front, seen from the element   dq = -R^T dc - w x q,   dd = -w x d
 *     the ray behind, seen from outside         dc + R (w x p),         R (w x d')
 *
 * In front q may be any point of the line; taking p for it, the adjoints by w are -(p x A_o) - (d x A_d), and
 * +(p x A_p) + (d' x A_d') from behind.  The end is in the frame of the last element: nothing comes from
 * behind that.
 *
 * THE INDEX in front of an element is the one behind the last element before it that has an index of its
 * own.  Its adjoint gathers t A_L of each stretch in its medium, A_r / n2 of the surface that ends it, and
 * what the phases in it have of either index.
 *
 * THE LAUNCH.  d = D / |D|: dd = (dD - d (d . dD)) / |D|, and the same transposed.
 *
 * THE NUMBERS OF A PHASE have a say in d' and S where the ray is met, and nowhere else.  With A_u and A_L of
 * chain.h they have the adjoints
 *
 *     per_wave                    A_u . grad W + A_L W
 *     a parameter a of W          per_wave (A_u . grad W_a + A_L W_a)
 *     a parameter of facets       A_m . m_a, with m_a = grad F_a of F = z - s
 *     those of an ideal lens      phase.h
 *
 * WHAT IT COSTS.  An element needs its second derivatives once, whatever the columns or rows, one quotient
 * for s and one for f.  A parameter needs its F_a and their gradient once for up to eight rows. */
#include "chain.h"

#include <string.h>

enum { ROWS = 8, OF_LAUNCH = 7, OF_ELEMENT = 7 };

/* ------------------------------------------------------------------- forward */

int sgt_trace_sensitivity(size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
                          const sgt_passage passages[], size_t columns, const sgt_ray_change change[],
                          sgt_ray_change out[])
{
    int lacks = 0;
    unit_launch from = unit_of(launch->d);
    sgt_vec3 d = from.d;
    double index = index_before == 0 ? 1 : index_before;
    for (size_t j = 0; j < columns; j++) {
        sgt_ray_change x = change[j];
        x.d = times(1 / from.length, across(x.d, from.d));
        out[j] = x;
    }
    for (size_t i = 0; i < elements; i++) {
        const sgt_pose *pose = &e[i].pose;
        sgt_surface s = chain_surface(e[i].surface);
        chain_link c;
        bool turned = is_turned(pose), turned_before = i > 0 && is_turned(&e[i - 1].pose);
        chain_at(&e[i], into(pose, d), index, &passages[i], &c);
        if (c.bends && !chain_second(s, &c)) lacks |= SGT_LACKS_SECOND;
        for (size_t j = 0; j < columns; j++) {
            sgt_ray_change x = out[j];
            if (turned_before) x.p = to_global(&e[i - 1].pose, x.p), x.d = to_global(&e[i - 1].pose, x.d);
            if (turned) x.p = to_local(pose, x.p), x.d = to_local(pose, x.d);
            out[j] = chain_forward(&c, x);
        }
        d = out_of(pose, passages[i].direction);
        index = c.n2;
    }
    return lacks;
}

/* ------------------------------------------------------------------ backward */

size_t sgt_trace_parameters(size_t elements, const sgt_element e[])
{
    size_t count = OF_LAUNCH;
    for (size_t i = 0; i < elements; i++) count += OF_ELEMENT + chain_parameters(chain_surface(e[i].surface));
    return count;
}

SGT_INLINE void put_three(double *to, sgt_vec3 a) { to[0] = a.x, to[1] = a.y, to[2] = a.z; }
SGT_INLINE void add_three(double *to, sgt_vec3 a) { to[0] += a.x, to[1] += a.y, to[2] += a.z; }

/* A sweep: rows that go back together.  at: where the numbers of the element are. */
typedef struct sweep {
    const sgt_element *e;
    const sgt_ray *launch;
    const sgt_passage *passages;
    double index_before;
    size_t rows, stride;
    chain_back *back;
    double *at;
} sweep;

/* What the pose of an element does to the ray behind it; and that ray in the element's frame. */
static void behind(const sweep *w, size_t i, size_t m, chain_back *x, double *to)
{
    const sgt_pose *pose = &w->e[i].pose;
    const sgt_passage *passage = &w->passages[i];
    put_three(to + m, x->p);
    x->p = into(pose, x->p), x->d = into(pose, x->d);
    put_three(to + m + 3, plus(cross_product(passage->hit.p, x->p), cross_product(passage->direction, x->d)));
}

/* The derivatives of F by each parameter, and by the gradient of it for rows whose direction turns. */
static void by_surface(const sweep *w, sgt_surface s, const chain_link *c, size_t m,
                       const chain_inside in[ROWS], const bool turns[ROWS])
{
    bool any = false;
    for (size_t r = 0; r < w->rows; r++) any = any || turns[r];
    for (size_t j = 0; j < m; j++) {
        double f, x = 0, y = 0, z = 0;
        sgt_values out = {&f, {any ? &x : NULL, any ? &y : NULL, any ? &z : NULL}};
        s.ops->by_parameter(s.self, j, 1, (sgt_points){{&c->p.x, &c->p.y, &c->p.z}}, out);
        for (size_t r = 0; r < w->rows; r++) {
            const double by = in[r].w * f, more = in[r].n.x * x + in[r].n.y * y + in[r].n.z * z;
            w->at[r * w->stride + j] = turns[r] ? by + more : by;
        }
    }
}

/* One element.  last: the end is in its frame. */
static int element_back(const sweep *w, size_t i, bool last)
{
    const sgt_element *e = &w->e[i];
    sgt_surface s = chain_surface(e->surface);
    size_t m = chain_parameters(s);
    int lacks = s.ops->parameters && s.ops->by_parameter ? 0 : SGT_LACKS_PARAMETERS;
    chain_link c;
    chain_inside in[ROWS];
    bool turns = false, by_normal[ROWS];
    chain_at(e, chain_direction(w->e, i, w->launch, w->passages),
             chain_index(w->e, i, w->index_before), &w->passages[i], &c);
    for (size_t r = 0; r < w->rows; r++) turns = turns || !last || !is_zero(w->back[r].d);
    if (c.bends && turns && !chain_second(s, &c)) lacks |= SGT_LACKS_SECOND;
    for (size_t r = 0; r < w->rows; r++) {
        double *to = w->at + r * w->stride;
        chain_back *x = &w->back[r];
        if (last) memset(to + m, 0, 6 * sizeof(double));
        else behind(w, i, m, x, to);
        bool own = !last || !is_zero(x->d);
        const chain_step by = chain_backward(&c, own, *x);
        *x = by.x, in[r] = by.in, by_normal[r] = own && c.bends;
        add_three(to + m + 3, times(-1, plus(cross_product(c.p, x->p), cross_product(c.d, by.front))));
        to[m + 6] = c.own_index ? x->index + in[r].n2 : 0;
        x->index = (c.own_index ? in[r].n1 : x->index + in[r].n1 + in[r].n2) + c.t * x->opl;
        x->p = out_of(&e->pose, x->p), x->d = out_of(&e->pose, x->d);
        add_three(to + m, times(-1, x->p));
    }
    by_surface(w, s, &c, m, in, by_normal);
    return lacks;
}

int sgt_trace_gradient(size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
                       const sgt_passage passages[], size_t rows, const sgt_ray_change weight[],
                       double gradient[])
{
    const size_t count = sgt_trace_parameters(elements, e);
    unit_launch from = unit_of(launch->d);
    int lacks = 0;
    for (size_t done = 0; done < rows; done += ROWS) {
        chain_back back[ROWS];
        sweep w = {e, launch, passages, index_before, rows - done < ROWS ? rows - done : ROWS, count, back,
                   gradient + done * count + count};
        for (size_t r = 0; r < w.rows; r++)
            back[r] = (chain_back){weight[done + r].p, weight[done + r].d, weight[done + r].opl, 0};
        for (size_t i = elements; i-- > 0;) {
            w.at -= OF_ELEMENT + chain_parameters(chain_surface(e[i].surface));
            lacks |= element_back(&w, i, i == elements - 1);
        }
        for (size_t r = 0; r < w.rows; r++) {
            double *to = gradient + (done + r) * count;
            sgt_vec3 a = back[r].d;
            put_three(to, back[r].p);
            put_three(to + 3, times(1 / from.length, across(a, from.d)));
            to[6] = back[r].index;
        }
    }
    return lacks;
}

/* ------------------------------------------------------------------- the numbers of phases */

static size_t numbers_of(const sgt_phase *a)
{
    if (!a) return 0;
    return a->kind == SGT_IDEAL_LENS ? LENS_NUMBERS : 1 + chain_parameters(chain_surface(a->waves));
}

size_t sgt_phase_parameters(size_t elements, const sgt_element e[])
{
    size_t count = 0;
    for (size_t i = 0; i < elements; i++) count += numbers_of(e[i].phase);
    return count;
}

/* The adjoints of one phase, for the adjoint x of the ray behind it, in its frame. */
static void by_phase(const sgt_phase *a, const chain_link *c, chain_back x, double *to)
{
    const double none = (double)NAN;
    if (!c->waves) {
        double by[LENS_NUMBERS][PHASE_ROWS];
        phase_by_numbers(a, c->n1, c->n2, c->p, c->d, c->after, by);
        for (int k = 0; k < LENS_NUMBERS; k++)
            to[k] = c->passed != 1
                        ? none
                        : by[k][0] * x.d.x + by[k][1] * x.d.y + by[k][2] * x.d.z + by[k][3] * x.opl;
        return;
    }
    const waves_slopes *s = &c->by_waves;
    const sgt_surface of = chain_surface(a->waves);
    const bool facets = is_faceted(a);
    const double b = dot(x.d, s->m) * c->by_S, sign = has_sag(a) ? -1 : 1;
    const sgt_vec3 across_after = plus_times(x.d, -b, c->after), to_u = times(1 / c->n2, across_after);
    const sgt_vec3 to_m = times(c->f, across_after);
    sgt_vec3 p = c->p;
    if (has_sag(a)) p.z = 0;
    to[0] = facets ? 0 : dot(to_u, s->at.g) + x.opl * s->at.w;
    for (size_t j = 0; j < chain_parameters(of); j++) {
        double f;
        sgt_vec3 g = {0, 0, 0};
        of.ops->by_parameter(of.self, j, 1, (sgt_points){{&p.x, &p.y, &p.z}},
                             (sgt_values){&f, {&g.x, &g.y, &g.z}});
        to[1 + j] = facets ? dot(to_m, g) : sign * a->per_wave * (dot(to_u, g) + x.opl * f);
        if (facets && x.opl != 0) to[1 + j] = none;
    }
    for (size_t j = 0; c->passed != 1 && j <= chain_parameters(of); j++) to[j] = none;
}

int sgt_phase_gradient(size_t elements, const sgt_element e[], double index_before, const sgt_ray *launch,
                       const sgt_passage passages[], size_t rows, const sgt_ray_change weight[],
                       double gradient[])
{
    const size_t count = sgt_phase_parameters(elements, e);
    int lacks = 0;
    for (size_t r = 0; r < rows; r++) {
        chain_back x = {weight[r].p, weight[r].d, weight[r].opl, 0};
        size_t at = (r + 1) * count;
        for (size_t i = elements; i-- > 0;) {
            const bool last = i == elements - 1, turns = !last || !is_zero(x.d);
            const sgt_surface s = chain_surface(e[i].surface);
            chain_link c;
            if (!last) x.p = into(&e[i].pose, x.p), x.d = into(&e[i].pose, x.d);
            chain_at(&e[i], chain_direction(e, i, launch, passages), chain_index(e, i, index_before),
                     &passages[i], &c);
            if (c.bends && turns && !chain_second(s, &c)) lacks |= SGT_LACKS_SECOND;
            if (e[i].phase) {
                const sgt_surface_ops *of = c.waves ? chain_surface(c.waves->waves).ops : NULL;
                if (of && !(of->parameters && of->by_parameter)) lacks |= SGT_LACKS_PARAMETERS;
                by_phase(e[i].phase, &c, x, gradient + (at -= numbers_of(e[i].phase)));
            }
            x = chain_backward(&c, turns, x).x;
            x.p = out_of(&e[i].pose, x.p), x.d = out_of(&e[i].pose, x.d);
        }
    }
    return lacks;
}
