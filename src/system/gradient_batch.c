// SPDX-License-Identifier: MIT
/* gradient_batch.c - derivatives of the traces of many rays: gradient.c has the formulas of frames, launch
 * and indices, chain.h those of an element.
 *
 * A tile of rays goes through the elements, forward or backward, with up to COLUMNS changes or ROWS numbers
 * at the same time; more of them go again.  At each element the links of all rays are made, and what of the
 * surface they need, once.  Then each column or row is a loop over rays.
 *
 * ONE RAY AND MANY differ in nothing: a number of a ray does not depend on the other columns or rows either.
 * At the last element a direction may have a weight for some rays only, and where it has none, what is behind
 * has no say (chain_backward).  So that element is no vector code if directions have weights. */
#include "chain_batch.h"

#include <string.h>

enum { COLUMNS = 8, ROWS = 4, OF_LAUNCH = 7, OF_ELEMENT = 7 };

/* The n numbers of an array from `first` on; 0 if there is none. */
static void row_taken(const double *from, size_t first, size_t n, double *out)
{
    if (from)
        memcpy(out, from + first, n * sizeof *out);
    else
        for (size_t i = 0; i < n; i++) out[i] = 0;
}

static void rows_taken(const double *const from[3], size_t first, size_t n, chain_vectors *out)
{
    row_taken(from[0], first, n, out->x), row_taken(from[1], first, n, out->y),
        row_taken(from[2], first, n, out->z);
}

static void row_given(double *out, size_t first, size_t n, const double *from)
{
    if (out) memcpy(out + first, from, n * sizeof *out);
}

static void rows_given(double *const out[3], size_t first, size_t n, const chain_vectors *from)
{
    row_given(out[0], first, n, from->x), row_given(out[1], first, n, from->y),
        row_given(out[2], first, n, from->z);
}

/* What a launch of unit length has of a change or a weight of its direction, in place. */
SGT_KERNEL
static void across_launch(size_t n, const double *dx, const double *dy, const double *dz, chain_vectors *a)
{
    LANES for (size_t i = 0; i < n; i++)
    {
        const unit_launch from = unit_of((sgt_vec3){dx[i], dy[i], dz[i]});
        const sgt_vec3 x = chain_get(a, i);
        chain_put(a, i, times(1 / from.length, across(x, from.d)));
    }
}

/* -------------------------------------------------------------------- forward */

typedef struct change_row {
    chain_vectors p, d;
    chain_row opl;
} change_row;

SGT_INLINE void forward_by(bool bends, const chain_tile *b, change_row *row)
{
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const chain_link c = chain_link_of(&v, bends, i);
        const sgt_ray_change x = chain_forward_by(
            bends, c, (sgt_ray_change){chain_get(&row->p, i), chain_get(&row->d, i), row->opl[i]});
        chain_put(&row->p, i, x.p), chain_put(&row->d, i, x.d), row->opl[i] = x.opl;
    }
}

SGT_KERNEL
static void forward_all(const chain_tile *b, change_row *row)
{
    if (b->bends)
        forward_by(true, b, row);
    else
        forward_by(false, b, row);
}

static void forward_phased(const chain_tile *b, change_row *row)
{
    for (size_t i = 0; i < b->n; i++) {
        const chain_link c = chain_phased_link(b, i);
        const sgt_ray_change x =
            chain_forward(&c, (sgt_ray_change){chain_get(&row->p, i), chain_get(&row->d, i), row->opl[i]});
        chain_put(&row->p, i, x.p), chain_put(&row->d, i, x.d), row->opl[i] = x.opl;
    }
}

/* A tile, with up to COLUMNS changes. */
static int forward_tile(const chain_work *work, size_t first, size_t n, size_t columns,
                        const sgt_ray_changes change[], const sgt_ray_changes out[])
{
    const double *const *d = work->rays->d;
    chain_tile b;
    change_row row[COLUMNS];
    int lacks = 0;
    for (size_t j = 0; j < columns; j++) {
        rows_taken((const double *const *)change[j].p, first, n, &row[j].p);
        rows_taken((const double *const *)change[j].d, first, n, &row[j].d);
        row_taken(change[j].opl, first, n, row[j].opl);
        across_launch(n, d[0] + first, d[1] + first, d[2] + first, &row[j].d);
    }
    for (size_t i = 0; i < work->elements; i++) {
        sgt_chain_tile_at(work, i, first, n, &b);
        if (b.bends && !sgt_chain_tile_second(&b)) lacks |= SGT_LACKS_SECOND;
        for (size_t j = 0; j < columns; j++) {
            if (i > 0) {
                const sgt_pose *before = &work->e[i - 1].pose;
                sgt_chain_out_of(before, n, &row[j].p), sgt_chain_out_of(before, n, &row[j].d);
            }
            sgt_chain_into(&b.e->pose, n, &row[j].p), sgt_chain_into(&b.e->pose, n, &row[j].d);
            if (b.phased)
                forward_phased(&b, &row[j]);
            else
                forward_all(&b, &row[j]);
        }
    }
    for (size_t j = 0; j < columns; j++) {
        rows_given(out[j].p, first, n, &row[j].p), rows_given(out[j].d, first, n, &row[j].d);
        row_given(out[j].opl, first, n, row[j].opl);
    }
    return lacks;
}

/* What is reserved for later versions has to be zero. */
static int lacks_member(size_t columns, const sgt_ray_changes of[])
{
    for (size_t j = 0; j < columns; j++)
        if (!ROOM_IS_ZERO(&of[j])) return SGT_LACKS_MEMBER;
    return 0;
}

int sgt_trace_sensitivity_batch(size_t elements, const sgt_element e[], double index_before,
                                const sgt_traces *traces, size_t columns, const sgt_ray_changes change[],
                                const sgt_ray_changes out[])
{
    const chain_work work = {elements, e, index_before, &traces->rays, traces->passages};
    const size_t n = traces->n;
    int lacks = lacks_member(columns, change) | lacks_member(columns, out);
    for (size_t first = 0; first < n; first += CHAIN_RAYS)
        for (size_t done = 0; done < columns; done += COLUMNS)
            lacks |=
                forward_tile(&work, first, n - first < CHAIN_RAYS ? n - first : CHAIN_RAYS,
                             columns - done < COLUMNS ? columns - done : COLUMNS, change + done, out + done);
    return lacks;
}

/* ------------------------------------------------------------------- backward */

/* The adjoints of one number, and what is inside of an element. */
typedef struct weight_row {
    chain_vectors p, d, n;
    chain_row opl, index, w, own; /* own: 0, the direction behind has no say; else 1 */
} weight_row;

/* The numbers of an element but for its surface's. */
typedef struct element_row {
    chain_vectors moved, turned;
    chain_row index;
} element_row;

typedef struct weight_tile {
    chain_tile link;
    weight_row row[ROWS];
    element_row out;
    chain_row f, by_p[3], by_a;
} weight_tile;

/* What the pose of an element does to the ray behind it. */
SGT_KERNEL
static void behind_all(const chain_tile *b, const weight_row *row, element_row *out)
{
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const sgt_vec3 p = chain_from(v.p, i), after = chain_from(v.after, i);
        chain_put(&out->turned, i,
                  plus(cross_product(p, chain_get(&row->p, i)), cross_product(after, chain_get(&row->d, i))));
    }
}

/* What a step backward leaves in the rows. */
SGT_INLINE void back_put(bool own_index, chain_link c, bool turns, chain_step by, size_t i, weight_row *row,
                         element_row *out)
{
    const sgt_vec3 turn = times(-1, plus(cross_product(c.p, by.x.p), cross_product(c.d, by.front)));
    const double index = by.x.index;
    chain_put(&out->turned, i, plus(chain_get(&out->turned, i), turn));
    out->index[i] = own_index ? index + by.in.n2 : 0;
    row->index[i] = (own_index ? by.in.n1 : index + by.in.n1 + by.in.n2) + c.t * by.x.opl;
    chain_put(&row->p, i, by.x.p), chain_put(&row->d, i, by.x.d), chain_put(&row->n, i, by.in.n);
    row->w[i] = by.in.w, row->own[i] = turns ? 1 : 0;
}

SGT_INLINE chain_back back_get(const weight_row *row, size_t i)
{
    return (chain_back){chain_get(&row->p, i), chain_get(&row->d, i), row->opl[i], row->index[i]};
}

SGT_INLINE void weights_back_by(bool bends, bool own_index, bool turns, const chain_tile *b, weight_row *row,
                                element_row *out)
{
    const chain_view v = b->view;
    const size_t n = b->n;
    LANES for (size_t i = 0; i < n; i++)
    {
        const chain_link c = chain_link_of(&v, bends, i);
        back_put(own_index, c, turns, chain_backward_by(bends, own_index, c, turns, back_get(row, i)), i, row,
                 out);
    }
}

SGT_KERNEL
static void weights_back(bool turns, const chain_tile *b, weight_row *row, element_row *out)
{
    const bool own_index = b->view.own_index;
    if (!turns && own_index)
        weights_back_by(false, true, false, b, row, out);
    else if (!turns)
        weights_back_by(false, false, false, b, row, out);
    else if (b->bends && own_index)
        weights_back_by(true, true, true, b, row, out);
    else if (b->bends)
        weights_back_by(true, false, true, b, row, out);
    else if (own_index)
        weights_back_by(false, true, true, b, row, out);
    else
        weights_back_by(false, false, true, b, row, out);
}

/* At a phase, and at the last element where directions have weights. */
static void weights_back_rest(bool last, const chain_tile *b, weight_row *row, element_row *out)
{
    for (size_t i = 0; i < b->n; i++) {
        const bool own = !last || !is_zero(chain_get(&row->d, i));
        const chain_link c = b->phased ? chain_phased_link(b, i) : chain_link_of(&b->view, b->bends, i);
        back_put(c.own_index, c, own, chain_backward(&c, own, back_get(row, i)), i, row, out);
    }
}

SGT_KERNEL
static void add_negative(size_t n, const chain_vectors *a, chain_vectors *to)
{
    LANES for (size_t i = 0; i < n; i++) chain_put(to, i, plus(chain_get(to, i), times(-1, chain_get(a, i))));
}

/* The derivative by a parameter of the surface; with the gradient where the direction turns. */
SGT_KERNEL
static void by_parameter_of(size_t n, bool turns, const weight_row *row, const double *f, const double *x,
                            const double *y, const double *z, double *out)
{
    if (!turns) {
        LANES for (size_t i = 0; i < n; i++) out[i] = row->w[i] * f[i];
        return;
    }
    LANES for (size_t i = 0; i < n; i++)
    {
        const double by = row->w[i] * f[i],
                     more = row->n.x[i] * x[i] + row->n.y[i] * y[i] + row->n.z[i] * z[i];
        out[i] = row->own[i] != 0 ? by + more : by;
    }
}

/* Rows that go through together: how many, how many numbers each has, and whether there are weights of
 * directions at the end, in any array. */
typedef struct gradient_rows { size_t count, stride; bool any; } gradient_rows;

/* m: parameters of the surface; gradient: of the first of them, and of the rows. */
static void surface_back(weight_tile *w, size_t m, gradient_rows of, bool turns, double *const gradient[])
{
    const chain_tile *b = &w->link;
    const size_t rows = of.count, stride = of.stride, first = b->first;
    for (size_t j = 0; j < m; j++) {
        bool wanted = false;
        for (size_t r = 0; r < rows; r++) wanted = wanted || gradient[r * stride + j];
        if (!wanted) continue;
        sgt_values out = {w->f, {NULL, NULL, NULL}};
        for (int k = 0; turns && k < 3; k++) out.grad[k] = w->by_p[k];
        b->s.ops->by_parameter(b->s.self, j, b->n, b->shown, out);
        for (size_t r = 0; r < rows; r++) {
            if (!gradient[r * stride + j]) continue;
            by_parameter_of(b->n, turns, &w->row[r], w->f, w->by_p[0], w->by_p[1], w->by_p[2], w->by_a);
            row_given(gradient[r * stride + j], first, b->n, w->by_a);
        }
    }
}

/* Has a direction at the end a weight, for any ray of the tile? */
static bool any_turns(const weight_tile *w, gradient_rows of)
{
    bool turns = false;
    for (size_t r = 0; of.any && r < of.count; r++)
        for (size_t i = 0; i < w->link.n; i++) turns = turns || !is_zero(chain_get(&w->row[r].d, i));
    return turns;
}

/* One element; gradient: of its first number.  */
static int element_back_tile(const chain_work *work, weight_tile *w, size_t i, size_t first, size_t n,
                             gradient_rows of, double *const gradient[])
{
    chain_tile *b = &w->link;
    const size_t rows = of.count;
    const bool last = i + 1 == work->elements;
    sgt_chain_tile_at(work, i, first, n, b);
    const sgt_pose *pose = &b->e->pose;
    const size_t m = chain_parameters(b->s);
    const bool turns = !last || any_turns(w, of);
    int lacks = b->s.ops->parameters && b->s.ops->by_parameter ? 0 : SGT_LACKS_PARAMETERS;
    if (b->bends && turns && !sgt_chain_tile_second(b)) lacks |= SGT_LACKS_SECOND;
    for (size_t r = 0; r < rows; r++) {
        weight_row *row = &w->row[r];
        element_row *out = &w->out;
        double *const *to = gradient + r * of.stride + m;
        if (last)
            memset(&out->moved, 0, sizeof out->moved), memset(&out->turned, 0, sizeof out->turned);
        else {
            out->moved = row->p;
            sgt_chain_into(pose, n, &row->p), sgt_chain_into(pose, n, &row->d);
            behind_all(b, row, out);
        }
        if (b->phased || (last && turns))
            weights_back_rest(last, b, row, out);
        else
            weights_back(turns, b, row, out);
        sgt_chain_out_of(pose, n, &row->p), sgt_chain_out_of(pose, n, &row->d);
        add_negative(n, &row->p, &out->moved);
        rows_given(to, first, n, &out->moved), rows_given(to + 3, first, n, &out->turned);
        row_given(to[6], first, n, out->index);
    }
    surface_back(w, m, of, turns && b->bends, gradient);
    return lacks;
}

/* A tile, with up to ROWS numbers; gradient: of the first of them. */
static int backward_tile(const chain_work *work, size_t first, size_t n, size_t rows, size_t stride,
                         const sgt_ray_changes weight[], double *const gradient[])
{
    const double *const *d = work->rays->d;
    weight_tile w;
    gradient_rows of = {rows, stride, false};
    size_t at = stride;
    int lacks = 0;
    for (size_t r = 0; r < rows; r++) {
        weight_row *row = &w.row[r];
        rows_taken((const double *const *)weight[r].p, first, n, &row->p);
        rows_taken((const double *const *)weight[r].d, first, n, &row->d);
        row_taken(weight[r].opl, first, n, row->opl), row_taken(NULL, 0, n, row->index);
        of.any = of.any || weight[r].d[0];
    }
    for (size_t i = work->elements; i-- > 0;) {
        at -= OF_ELEMENT + chain_parameters(chain_surface(work->e[i].surface));
        lacks |= element_back_tile(work, &w, i, first, n, of, gradient + at);
    }
    for (size_t r = 0; r < rows; r++) {
        weight_row *row = &w.row[r];
        double *const *to = gradient + r * stride;
        across_launch(n, d[0] + first, d[1] + first, d[2] + first, &row->d);
        rows_given(to, first, n, &row->p), rows_given(to + 3, first, n, &row->d);
        row_given(to[6], first, n, row->index);
    }
    return lacks;
}

int sgt_trace_gradient_batch(size_t elements, const sgt_element e[], double index_before,
                             const sgt_traces *traces, size_t rows, const sgt_ray_changes weight[],
                             double *const gradient[])
{
    const chain_work work = {elements, e, index_before, &traces->rays, traces->passages};
    const size_t n = traces->n, count = sgt_trace_parameters(elements, e);
    int lacks = lacks_member(rows, weight);
    for (size_t first = 0; first < n; first += CHAIN_RAYS)
        for (size_t done = 0; done < rows; done += ROWS)
            lacks |= backward_tile(&work, first, n - first < CHAIN_RAYS ? n - first : CHAIN_RAYS,
                                   rows - done < ROWS ? rows - done : ROWS, count, weight + done,
                                   gradient + done * count);
    return lacks;
}
