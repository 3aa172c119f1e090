// SPDX-License-Identifier: MIT
/* beam_sags.h - departures (departure.h) over a box of points, by models.
 *
 * A departure says how large its second derivative is, and no more.  So P(m + v) is P(m) + grad P(m) . v
 * +- bend |v|^2 / 2, and what is left out is of second order.  Most types are worked out here by their
 * formulas instead, with the gradient beside the value: then it is of third order.  It is so for toroids,
 * biconics, polynomials of x and y, of Chebyshev and of Zernike, odd aspheres, Q_con, Q_bfs, even terms, and
 * sums of these.  Of a formula the second derivatives are enclosed all over the box, and that one by one:
 * grad P(m + v) is grad P(m) + H v, off by second order.  A grid is a polynomial in each cell.  Between cells
 * its second derivatives jump: a box of four cells at most leaves out what these jumps make.  A larger one
 * goes by the bend, and its gradient by bend |v|: first order.
 *
 * NUMBERS THAT ARE ROUNDED.  A coefficient of a recurrence is off by a few u of itself: GRAIN of what it is
 * multiplied with is added to the rest. */
#ifndef SGT_SYSTEM_BEAM_SAGS_H
#define SGT_SYSTEM_BEAM_SAGS_H
#include "beam.h"
#include "model.h"

#include "../num/bits.h"
#include "../surface/departure/departure.h"
#include "../surface/departure/q.h"
#include "../surface/formula/formula.h"

#define GRAIN 0x1p-48

/* A value and its derivatives by x and y. */
typedef struct sag_jet {
    model v, x, y;
} sag_jet;

SGT_COLD static sag_jet jet_of(double c)
{
    return (sag_jet){model_number(c), model_number(0), model_number(0)};
}
SGT_COLD static sag_jet jet_sum(const sag_jet *a, const sag_jet *b)
{
    return (sag_jet){model_sum(a->v, b->v), model_sum(a->x, b->x), model_sum(a->y, b->y)};
}
SGT_COLD static sag_jet jet_plus(sag_jet a, double k)
{
    a.v = model_plus(a.v, k);
    return a;
}
/* Times a number that is off by 4 u of itself at most. */
SGT_COLD static sag_jet jet_scaled(const sag_jet *a, double k)
{
    sag_jet b = {model_scaled(a->v, k), model_scaled(a->x, k), model_scaled(a->y, k)};
    b.v = model_wider(b.v, GRAIN * model_size(&b.v));
    b.x = model_wider(b.x, GRAIN * model_size(&b.x)), b.y = model_wider(b.y, GRAIN * model_size(&b.y));
    return b;
}
SGT_COLD static sag_jet jet_product(const sag_jet *a, const sag_jet *b)
{
    return (sag_jet){model_product(a->v, b->v),
                     model_sum(model_product(a->v, b->x), model_product(a->x, b->v)),
                     model_sum(model_product(a->v, b->y), model_product(a->y, b->v))};
}
SGT_COLD static sag_jet jet_by(const sag_jet *a, model v, model slope)
{
    return (sag_jet){v, model_product(slope, a->x), model_product(slope, a->y)};
}
SGT_COLD static sag_jet jet_root(const sag_jet *a)
{
    const model s = model_root(a->v);
    return jet_by(a, s, model_scaled(model_inverse(s), 0.5));
}
SGT_COLD static sag_jet jet_inverse(const sag_jet *a)
{
    const model i = model_inverse(a->v);
    return jet_by(a, i, model_negative(model_square(i)));
}
SGT_COLD static sag_jet jet_quotient(const sag_jet *a, const sag_jet *b)
{
    const sag_jet i = jet_inverse(b);
    return jet_product(a, &i);
}

/* x^2 + y^2, times a number. */
SGT_COLD static sag_jet jet_rho(const sag_jet *x, const sag_jet *y, double by)
{
    const sag_jet xx = jet_product(x, x), yy = jet_product(y, y), rho = jet_sum(&xx, &yy);
    return jet_scaled(&rho, by);
}

/* The sum of a[i] v^(i + 1). */
SGT_COLD static sag_jet jet_terms(const double *a, int n, const sag_jet *v)
{
    sag_jet sum = jet_of(0);
    while (n > 0 && a[n - 1] == 0) n--;
    for (int i = n - 1; i >= 0; i--) {
        const sag_jet next = jet_plus(sum, a[i]);
        sum = i == n - 1 ? jet_scaled(v, a[i]) : jet_product(&next, v);
    }
    return sum;
}

SGT_COLD static sag_jet toroidal_jet(const sgt_toroidal *s, const sag_jet *x, const sag_jet *y)
{
    const sag_jet yy = jet_product(y, y), xx = jet_product(x, x);
    sag_jet profile = jet_terms(s->a, 8, &yy);
    if (s->c != 0) {
        const sag_jet less2 = jet_scaled(&yy, -(1 + s->k) * s->c * s->c), phi2 = jet_plus(less2, 1),
                      phi = jet_root(&phi2);
        const sag_jet down = jet_plus(phi, 1), up = jet_scaled(&yy, s->c), base = jet_quotient(&up, &down);
        profile = jet_sum(&profile, &base);
    }
    if (s->c_x == 0) return profile;
    const sag_jet less = jet_scaled(&profile, -s->c_x), q = jet_plus(less, 1), q2 = jet_product(&q, &q);
    const sag_jet across = jet_scaled(&xx, -s->c_x * s->c_x), D = jet_sum(&q2, &across), root = jet_root(&D);
    const sag_jet down = jet_sum(&q, &root), up = jet_scaled(&xx, s->c_x), more = jet_quotient(&up, &down);
    return jet_sum(&profile, &more);
}

SGT_COLD static sag_jet biconic_jet(const sgt_biconic *s, const sag_jet *x, const sag_jet *y)
{
    const sag_jet xx = jet_product(x, x), yy = jet_product(y, y);
    const sag_jet ux = jet_scaled(&xx, s->c_x), uy = jet_scaled(&yy, s->c_y), up = jet_sum(&ux, &uy);
    const sag_jet bx = jet_scaled(&xx, -(1 + s->k_x) * s->c_x * s->c_x),
                  by = jet_scaled(&yy, -(1 + s->k_y) * s->c_y * s->c_y);
    const sag_jet less = jet_sum(&bx, &by), phi2 = jet_plus(less, 1), phi = jet_root(&phi2),
                  down = jet_plus(phi, 1);
    return jet_quotient(&up, &down);
}

SGT_COLD static sag_jet odd_jet(const sgt_odd_asphere *s, const sag_jet *x, const sag_jet *y)
{
    const sag_jet rho = jet_rho(x, y, 1);
    double even[8], odd[8];
    bool any = false;
    for (int i = 0; i < 8; i++) odd[i] = s->a[2 * i], even[i] = s->a[2 * i + 1], any = any || odd[i] != 0;
    sag_jet sum = jet_terms(even, 8, &rho);
    if (!any) return sum;
    const sag_jet r = jet_root(&rho); /* of what has the vertex in it nothing is known */
    const sag_jet more = jet_terms(odd, 8, &rho), by = jet_quotient(&more, &r);
    return jet_sum(&sum, &by);
}

SGT_COLD static sag_jet polynomial_jet(const sgt_numbers *a, const sag_jet *x, const sag_jet *y)
{
    sag_jet sum = jet_of(0);
    for (size_t i = a->rows; i-- > 0;) {
        sag_jet row = jet_of(0);
        bool any = false;
        for (size_t j = a->columns; j-- > 0;) {
            const double k = a->x[i * a->columns + j];
            if (any) row = jet_product(&row, y);
            row = jet_plus(row, k), any = any || k != 0;
        }
        sum = jet_product(&sum, x);
        sum = jet_sum(&sum, &row);
    }
    return sum;
}

/* t_(n + 1) = 2 x t_n - t_(n - 1). */
SGT_COLD static void chebyshev_next(const sag_jet *x, sag_jet *now, sag_jet *before)
{
    const sag_jet up = jet_product(now, x), twice = jet_scaled(&up, 2), less = jet_scaled(before, -1);
    *before = *now, *now = jet_sum(&twice, &less);
}

SGT_COLD static sag_jet chebyshev_jet(const sgt_chebyshev *s, const sag_jet *x, const sag_jet *y)
{
    const sag_jet u = jet_scaled(x, 1 / s->norm_x), v = jet_scaled(y, 1 / s->norm_y);
    sag_jet sum = jet_of(0), tx = jet_of(1), tx_before = u; /* T_-1 = T_1 */
    for (size_t i = 0; i < s->a.rows; i++) {
        sag_jet row = jet_of(0), ty = jet_of(1), ty_before = v;
        bool any = false;
        for (size_t j = 0; j < s->a.columns; j++) {
            const double k = s->a.x[i * s->a.columns + j];
            const sag_jet term = jet_scaled(&ty, k);
            if (k != 0) row = jet_sum(&row, &term), any = true;
            if (j + 1 < s->a.columns) chebyshev_next(&v, &ty, &ty_before);
        }
        if (any) row = jet_product(&row, &tx), sum = jet_sum(&sum, &row);
        if (i + 1 < s->a.rows) chebyshev_next(&u, &tx, &tx_before);
    }
    return sum;
}

/* P_k of Jacobi's P_k^(0, b)(2 v - 1), the next of them: DLMF 18.9.1, 18.9.2. */
SGT_COLD static void jacobi_next(double b, double k, const sag_jet *v, sag_jet *now, sag_jet *before)
{
    const double n = 2 * k + b, first = 2 * (k + 1) * (k + b + 1) * n;
    double A, B, C;
    if (k == 0)
        A = b + 2, B = -(b + 1), C = 0; /* P_1 = (b + 2) v - (b + 1) */
    else
        A = 2 * (n + 1) * (n + 2) * n / first, B = -(n + 1) * (b * b + (n + 2) * n) / first,
        C = 2 * k * (k + b) * (n + 2) / first;
    const sag_jet by = jet_scaled(v, A);
    sag_jet factor = jet_plus(by, B);
    factor.v = model_wider(factor.v, GRAIN * fabs(B));
    const sag_jet up = jet_product(now, &factor), less = jet_scaled(before, -C);
    *before = *now, *now = jet_sum(&up, &less);
}

SGT_COLD static sag_jet q_con_jet(const sgt_q_con *s, const sag_jet *x, const sag_jet *y)
{
    const sag_jet v = jet_rho(x, y, 1 / s->norm / s->norm), v2 = jet_product(&v, &v);
    const size_t terms = s->a.rows * s->a.columns;
    sag_jet sum = jet_of(0), now = jet_of(1), before = jet_of(0);
    for (size_t m = 0; m < terms; m++) {
        const sag_jet term = jet_scaled(&now, s->a.x[m]);
        sum = jet_sum(&sum, &term);
        if (m + 1 < terms) jacobi_next(4, (double)m, &v, &now, &before);
    }
    return jet_product(&v2, &sum);
}

SGT_COLD static sag_jet q_bfs_jet(const sgt_q_bfs *s, const sag_jet *x, const sag_jet *y)
{
    double b[Q_TERMS], b_err[Q_TERMS];
    const size_t terms = sgt_q_bfs_basis(s, b, b_err);
    const sag_jet v = jet_rho(x, y, 1 / s->norm / s->norm), fall = jet_scaled(&v, -4),
                  two = jet_plus(fall, 2);
    const sag_jet bent2 = jet_rho(x, y, -s->c * s->c), w = jet_plus(bent2, 1), root = jet_root(&w);
    sag_jet sum = jet_of(0), now = jet_of(1), before = jet_of(0);
    for (size_t m = 0; m < terms; m++) {
        sag_jet term = jet_scaled(&now, b[m]);
        term.v = model_wider(term.v, b_err[m] * (model_size(&now.v) + now.v.e));
        term.x = model_wider(term.x, b_err[m] * (model_size(&now.x) + now.x.e));
        term.y = model_wider(term.y, b_err[m] * (model_size(&now.y) + now.y.e));
        sum = jet_sum(&sum, &term);
        const sag_jet by = m == 0 ? jet_plus(fall, 3) : two, up = jet_product(&by, &now),
                      less = jet_scaled(&before, -1);
        before = now, now = jet_sum(&up, &less);
    }
    const sag_jet minus = jet_scaled(&v, -1), left = jet_plus(minus, 1), hump = jet_product(&v, &left);
    const sag_jet all = jet_product(&hump, &sum);
    return jet_quotient(&all, &root);
}

/* The index in the list of the first polynomial of order n = m + 2 k (zernike.c). */
SGT_COLD static size_t zernike_index(const sgt_zernike *z, size_t m, size_t k)
{
    const size_t n = m + 2 * k, half = m + k;
    if (z->order == SGT_NOLL) return n * (n + 1) / 2 + (m > 0 ? m - 1 : 0);
    return (half + 1) * (half + 1) - 2 * m - 1;
}

/* The sum over m of Re zeta^m C_m + Im zeta^m S_m, C and S sums over k of P_k^(0, m). */
SGT_COLD static sag_jet zernike_jet(const sgt_zernike *z, const sag_jet *x, const sag_jet *y)
{
    const size_t terms = z->a.rows * z->a.columns;
    const sag_jet u = jet_scaled(x, 1 / z->norm), v = jet_scaled(y, 1 / z->norm), rho = jet_rho(&u, &v, 1);
    sag_jet sum = jet_of(0), re = jet_of(1), im = jet_of(0);
    for (size_t m = 0; zernike_index(z, m, 0) < terms; m++) {
        sag_jet C = jet_of(0), S = jet_of(0), now = jet_of(1), before = jet_of(0);
        for (size_t k = 0; zernike_index(z, m, k) < terms; k++) {
            const size_t first = zernike_index(z, m, k);
            const bool cosine_first = z->order != SGT_NOLL || m == 0 || first % 2 == 1;
            const size_t cosine = cosine_first ? first : first + 1, sine = cosine_first ? first + 1 : first;
            const double by = z->normalised ? sqrt((double)(m + 2 * k + 1) * (m > 0 ? 2 : 1)) : 1;
            const double c = cosine < terms ? by * z->a.x[cosine] : 0,
                         s = m > 0 && sine < terms ? by * z->a.x[sine] : 0;
            const sag_jet tc = jet_scaled(&now, c), ts = jet_scaled(&now, s);
            if (c != 0) C = jet_sum(&C, &tc);
            if (s != 0) S = jet_sum(&S, &ts);
            jacobi_next((double)m, (double)k, &rho, &now, &before);
        }
        const sag_jet c = jet_product(&re, &C), s = jet_product(&im, &S);
        sum = jet_sum(&sum, &c);
        if (m > 0) sum = jet_sum(&sum, &s);
        const sag_jet a = jet_product(&re, &u), b = jet_product(&im, &v), less = jet_scaled(&b, -1);
        const sag_jet d = jet_product(&re, &v), e = jet_product(&im, &u);
        re = jet_sum(&a, &less), im = jet_sum(&d, &e);
    }
    return sum;
}

/* The cells of one direction of a grid that a range has points in: first, and two at most.  false: more, or
 * it goes beyond the grid. */
static bool grid_cells(double step, size_t count, sgt_interval x, int *first, int *cells)
{
    const double half = 0.5 * (double)(count - 1), last = (double)(count - 2), soft = 0x1p-30;
    if (!(x.lo >= -half * step && x.hi <= half * step)) return false;
    /* (cut off is rounded down: below 0 both are 0) */
    const int lo = (int)smaller(larger(x.lo / step + half - soft, 0), last);
    const int hi = (int)smaller(larger(x.hi / step + half + soft, 0), last);
    *first = lo, *cells = hi - lo + 1;
    return *cells <= 2;
}

/* Along four heights: of a height beside the grid the third difference is 0 (grid.c). */
static void grid_beside(double z[4], bool first, bool last)
{
    if (first) z[0] = 3 * z[1] - 3 * z[2] + z[3];
    if (last) z[3] = 3 * z[2] - 3 * z[1] + z[0];
}

/* The cubic between z[1] and z[2]: its coefficients, in place of z. */
static void grid_cubic(double z[4])
{
    const double D = z[2] - z[1], S0 = D - (z[1] - z[0]), S1 = (z[3] - z[2]) - D, T = S1 - S0, z0 = z[1];
    z[0] = z0, z[1] = D - 0.5 * S0, z[2] = 0.5 * (S0 - T), z[3] = 0.5 * T;
}

/* The polynomial of the cell j of row i, wherever the points are.  Coefficients are sums of heights with
 * weights of 6 x 6 at most together, those beside the grid of 7 x 7: off by 2^-42 of the largest. */
static sag_jet grid_cell_jet(const sgt_grid *g, int i, int j, const sag_jet *x, const sag_jet *y)
{
    const int rows = (int)g->z.rows, columns = (int)g->z.columns;
    double z[4][4], power[16], most = 0;
    for (int r = 0; r < 4; r++) {
        const int row = i + r - 1 < 0 ? 0 : i + r - 1 >= rows ? rows - 1 : i + r - 1;
        for (int c = 0; c < 4; c++) {
            const int column = j + c - 1 < 0 ? 0 : j + c - 1 >= columns ? columns - 1 : j + c - 1;
            z[r][c] = g->z.x[(size_t)row * g->z.columns + (size_t)column];
        }
        grid_beside(z[r], j == 0, j + 2 == columns);
    }
    for (int c = 0; c < 4; c++) { /* along y, then x */
        double along[4] = {z[0][c], z[1][c], z[2][c], z[3][c]};
        grid_beside(along, i == 0, i + 2 == rows);
        for (int r = 0; r < 4; r++) most = larger(most, fabs(along[r]));
        grid_cubic(along);
        for (int r = 0; r < 4; r++) z[r][c] = along[r];
    }
    for (int r = 0; r < 4; r++) {
        grid_cubic(z[r]);
        for (int c = 0; c < 4; c++) power[4 * c + r] = z[r][c];
    }
    const sag_jet u = jet_plus(*x, -((double)j - 0.5 * (columns - 1)) * g->step_x),
                  v = jet_plus(*y, -((double)i - 0.5 * (rows - 1)) * g->step_y);
    const sag_jet in_x = jet_scaled(&u, 1 / g->step_x), in_y = jet_scaled(&v, 1 / g->step_y);
    sag_jet P = polynomial_jet(&(sgt_numbers){power, 4, 4}, &in_x, &in_y);
    const double U = 1 + larger(sgt_interval_greatest(model_range(in_x.v)),
                                sgt_interval_greatest(model_range(in_y.v)));
    const double off = 0x1p-42 * most * U * U * U * U * U * U; /* powers up to 3 each way */
    P.v = model_wider(P.v, off);
    P.x = model_wider(P.x, 3 * off / g->step_x), P.y = model_wider(P.y, 3 * off / g->step_y);
    return P;
}

/* What lies between 0 and the range of a model, too. */
static void reach_over(sgt_interval *all, const model *x)
{
    const sgt_interval range = model_range(*x);
    all->lo = smaller(all->lo, range.lo), all->hi = larger(all->hi, range.hi);
    if (!(range.hi - range.lo < HUGE_VAL)) *all = sgt_interval_all();
}

/* Bicubic convolution (grid.c) in four cells at most: the polynomial of the first, and how far those of the
 * others are from it over the box.  As values and slopes agree at their borders, that is of second order in
 * the value, and of first in the slopes; inside of a cell nothing is left out. */
static bool grid_jet(const sgt_grid *g, const sag_jet *x, const sag_jet *y, sag_jet *out)
{
    int i, j, rows, columns;
    sgt_interval v = {0, 0}, dx = {0, 0}, dy = {0, 0};
    if (!grid_cells(g->step_x, g->z.columns, model_range(x->v), &j, &columns) ||
        !grid_cells(g->step_y, g->z.rows, model_range(y->v), &i, &rows))
        return false;
    *out = grid_cell_jet(g, i, j, x, y);
    for (int k = 1; k < rows * columns; k++) {
        const sag_jet other = grid_cell_jet(g, i + k / columns, j + k % columns, x, y),
                      less = jet_scaled(out, -1), apart = jet_sum(&other, &less);
        reach_over(&v, &apart.v), reach_over(&dx, &apart.x), reach_over(&dy, &apart.y);
    }
    if (rows * columns == 1) return true;
    out->v = model_sum(out->v, model_between(v));
    out->x = model_sum(out->x, model_between(dx)), out->y = model_sum(out->y, model_between(dy));
    return true;
}

/* Of one departure.  false: there is no formula here, or it is not defined all over. */
SGT_COLD static bool departure_jet(sgt_surface surface, const sag_jet *x, const sag_jet *y, sag_jet *out)
{
    const void *self = surface.self;
    surface = in_set(surface);
    if (surface.ops == &sgt_toroidal_ops)
        *out = toroidal_jet(self, x, y);
    else if (surface.ops == &sgt_biconic_ops)
        *out = biconic_jet(self, x, y);
    else if (surface.ops == &sgt_odd_asphere_ops)
        *out = odd_jet(self, x, y);
    else if (surface.ops == &sgt_polynomial_xy_ops)
        *out = polynomial_jet(&((const sgt_polynomial_xy *)self)->a, x, y);
    else if (surface.ops == &sgt_chebyshev_ops)
        *out = chebyshev_jet(self, x, y);
    else if (surface.ops == &sgt_zernike_ops)
        *out = zernike_jet(self, x, y);
    else if (surface.ops == &sgt_q_con_ops)
        *out = q_con_jet(self, x, y);
    else if (surface.ops == &sgt_q_bfs_ops)
        *out = q_bfs_jet(self, x, y);
    else if (surface.ops == &sgt_grid_ops) {
        if (!grid_jet(self, x, y, out)) return false;
    } else if (surface.ops == &sgt_even_asphere_ops) {
        const sag_jet rho = jet_rho(x, y, 1);
        *out = jet_terms(((const sgt_even_asphere *)self)->a, 8, &rho);
    } else
        return false;
    return out->v.e < HUGE_VAL && out->x.e < HUGE_VAL && out->y.e < HUGE_VAL;
}

/* P and its slopes at the points of models, and how far a trace is off in P. */
typedef struct sag_models {
    model s, x, y;
    double off;
} sag_models;

/* By the bends, as the head has it. */
SGT_COLD static bool departure_bends(sgt_surface surface, const model *x, const model *y, sag_models *out)
{
    const departure *of = in_set(surface).ops->own_->departure;
    double p, px, py, p_err, grad_err;
    const double mx = x->c, my = y->c;
    bounds b = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    region where = {.x = model_range(*x), .y = model_range(*y)};
    const sgt_interval r = sgt_interval_square_root(
        sgt_interval_sum(sgt_interval_square(where.x), sgt_interval_square(where.y)));
    where.r_lo = r.lo, where.r_hi = r.hi;
    if (!(r.hi < 0x1p400) || of->bounds(surface.self, &where, &b) <= 0 || !(b.bend < HUGE_VAL)) return false;
    of->at(surface.self, 1, &mx, &my, (sag_values){&p, &px, &py});
    of->rounding(surface.self, mx, my, &p_err, &grad_err);
    const model vx = model_plus(*x, -mx), vy = model_plus(*y, -my);
    const double away = (model_away(&vx) + model_away(&vy) + fabs(vx.c) + fabs(vy.c)) * MODEL_MORE;
    const double off = (grad_err + (b.bend + MODEL_LEAST) * away) * MODEL_MORE;
    const double rest = p_err + grad_err * away + 0.5 * (b.bend + MODEL_LEAST) * away * away;
    out->s = model_sum(model_scaled(vx, px), model_scaled(vy, py));
    out->s = model_wider(model_plus(out->s, p), rest);
    out->x = model_wider(model_number(px), off), out->y = model_wider(model_number(py), off);
    return out->s.e < HUGE_VAL && out->x.e < HUGE_VAL && out->y.e < HUGE_VAL;
}

/* What `at` is off by at the middle and at the corners of the box. */
SGT_COLD static double departure_off(sgt_surface surface, const model *x, const model *y)
{
    const departure *of = in_set(surface).ops->own_->departure;
    const sgt_interval bx = model_range(*x), by = model_range(*y);
    double most, grad, here;
    of->rounding(surface.self, x->c, y->c, &most, &grad);
    for (int i = 0; i < 4; i++) {
        of->rounding(surface.self, i & 1 ? bx.hi : bx.lo, i & 2 ? by.hi : by.lo, &here, &grad);
        if (here > most) most = here;
    }
    return 4 * most;
}

/* A number that is known to an interval, times a model. */
SGT_COLD static model model_by(sgt_interval k, model x) { return model_product(model_between(k), x); }

/* A formula: F and its gradient at the middle, and its second derivatives all over the box. */
SGT_COLD static bool formula_models(const sgt_tape *tape, const model *x, const model *y, sag_models *out)
{
    static const sgt_interval X[3] = {{1, 1}, {0, 0}, {0, 0}}, Y[3] = {{0, 0}, {1, 1}, {0, 0}};
    const sgt_interval at[3] = {model_range(*x), model_range(*y), {0, 0}},
                       middle[3] = {{x->c, x->c}, {y->c, y->c}, {0, 0}};
    const sgt_interval r = sgt_interval_hypotenuse(at[0], at[1]),
                       r0 = sgt_interval_hypotenuse(middle[0], middle[1]);
    const formula_jet here = sgt_formula_jet(tape, middle, r0, X, Y, false),
                      xx = sgt_formula_jet(tape, at, r, X, X, true),
                      xy = sgt_formula_jet(tape, at, r, X, Y, true),
                      yy = sgt_formula_jet(tape, at, r, Y, Y, true);
    const model vx = model_plus(*x, -x->c), vy = model_plus(*y, -y->c);
    if (sgt_interval_is_empty(here.f) || !xx.whole) return false;
    const model hx = model_sum(model_by(xx.uv, vx), model_by(xy.uv, vy)),
                hy = model_sum(model_by(xy.uv, vx), model_by(yy.uv, vy));
    out->x = model_sum(model_between(here.u), hx), out->y = model_sum(model_between(here.v), hy);
    const model first = model_sum(model_by(here.u, vx), model_by(here.v, vy)),
                second = model_scaled(model_sum(model_product(hx, vx), model_product(hy, vy)), 0.5);
    out->s = model_sum(model_between(here.f), model_sum(first, second));
    return out->s.e < HUGE_VAL && out->x.e < HUGE_VAL && out->y.e < HUGE_VAL;
}

SGT_COLD static bool departure_one(sgt_surface surface, const model *x, const model *y, sag_models *out)
{
    if (in_set(surface).ops == &sgt_formula_sag_ops && !((const sgt_formula_sag *)surface.self)->tape->radial)
        return formula_models(((const sgt_formula_sag *)surface.self)->tape, x, y, out);
    sag_jet X = {*x, model_number(1), model_number(0)}, Y = {*y, model_number(0), model_number(1)}, P;
    if (!departure_jet(surface, &X, &Y, &P)) return departure_bends(surface, x, y, out);
    out->s = P.v, out->x = P.x, out->y = P.y;
    return true;
}

SGT_COLD static bool departure_models(sgt_surface surface, const model *x, const model *y, sag_models *out)
{
    const double off = departure_off(surface, x, y);
    bool known = true;
    if (in_set(surface).ops == &sgt_sum_ops) {
        const sgt_sum *sum = surface.self;
        *out = (sag_models){model_number(0), model_number(0), model_number(0), 0};
        for (size_t i = 0; i < sum->count && known; i++) {
            sag_models one;
            known = departure_one(sum->terms[i], x, y, &one);
            if (known)
                out->s = model_sum(out->s, one.s), out->x = model_sum(out->x, one.x),
                out->y = model_sum(out->y, one.y);
        }
    } else {
        known = departure_one(surface, x, y, out);
    }
    out->off = off;
    return known && off < HUGE_VAL;
}

#endif
