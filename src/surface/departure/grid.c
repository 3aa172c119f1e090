// SPDX-License-Identifier: MIT
/* grid.c - heights on a rectangular grid, and bicubic convolution between them.
 *
 * ONE DIRECTION (Keys 1981, a = -1/2).  Take v in [0, 1] in a cell between two heights.  Let D_0, D_1, D_2
 * be the steps from each of four heights to the next, and S_0 = D_1 - D_0, S_1 = D_2 - D_1 the second
 * differences at the two.  The convolution is
 *     p = z_0 + v D_1 - v (1 - v) / 2 B,     B = (1 - v) S_0 + v S_1:
 * the chord, less its bending by the blend of the second differences.  p' at a height is the mean of the
 * steps beside it, seen from either cell: p is C1.  Keys' boundary condition, c(-1) = 3 c(0) - 3 c(1) +
 * c(2), means S_0 = S_1 at the first height, and at the last.
 *
 * TWO DIRECTIONS.  The four rows are interpolated by x, and their results by y.  The heights at the left
 * of the cell are kept apart from what is added to them.  So a height common to all costs no difference
 * any digits.
 *
 * THE CELL.  v is that of x - (j - (columns - 1) / 2) step_x, rounded once (fma).  Its sign tells whether
 * j is right.  So a point is never extrapolated from the neighbouring cell, except within rounding of the
 * border.  The edge is the double nearest (columns - 1) / 2 step_x, so a point computed to lie there is
 * inside.
 *
 * ROUNDING.  Let w = 2^-53, d the greatest |D_i| and s the greatest |S_i| of a piece, with D_i off by w d.
 * Then S is off by w (2 d + s), and B by w (2 d + 12 s), as v is off by at most 3 w v.  The weight of B,
 * at most 1/8, is off by 2 w.  So what is added to z_0 is off by w (7 d + 5 s), and p' by w (5 d + 17 s).
 * A further error e in each D_i adds at most 5/4 e to the first and 2 e to the second.
 *
 * d and s are those of the rows; d_y and s_y are those of the steps between their results.  These have a
 * further w (d_y + 16 d + 11 s), so
 *     P         is off by w (28 d + 20 s + 10 d_y + 6 s_y + |P|),
 *     P_y step_y       by w (32 d + 22 s + 7 d_y + 17 s_y + 3 |P_y step_y|),
 *     P_x step_x       by w (7 d + 22 s + 7 d_q + 5 s_q + 4 |P_x step_x|).
 * d_q and s_q are those of the steps between the rows' slopes.  Their own error is weighted as heights
 * are: by 5/4 at most.
 *
 * BOUNDS.  With T = S_1 - S_0, |p'| <= max |D| + max(|S|, |T|) / 2 and |p''| <= max |S| + max |T|.  For p'
 * is a parabola with the Bezier heights D_1 - S_0 / 2, D_1 - T / 2, D_1 + S_1 / 2, and p'' is linear from
 * S_0 - T to S_1 + T.  Let M_pq be the greatest p-th difference by y of q-th differences by x, in the
 * cells of the region and beside them.  Then
 *     |P_x| step_x <= 5/4 (M_01 + max(M_02, M_03) / 2),     |P_xx| step_x^2 <= 5/4 (M_02 + M_03),
 *     |P_xy| step_x step_y <= M_11 + M_12 + M_21 + M_22.
 * The last is the bound on |p'| for the differences by y, with T <= 2 S.  For smooth heights all but the
 * first term of each are small. */
#include "bend.h"
#include "departure.h"

enum { GRID_LEAST = 4, GRID_MOST = 4096 };

/* A piece of a cubic: what is added to the first height, the derivatives by v, and d and s of the head. */
typedef struct grid_piece { double rise, slope, bend, d, s; } grid_piece;

SGT_INLINE double greater(double a, double b) { return larger(fabs(a), fabs(b)); }

SGT_INLINE grid_piece grid_piece_of(double d0, double d1, double d2, double v, mask first, mask last)
{
    double before = d1 - d0, after = d2 - d1, s0 = chosen(first, after, before),
           s1 = chosen(last, before, after), turn = s1 - s0;
    double blend = s0 + v * turn, lens = 0.5 * (v * (1 - v)), lean = 1 - 2 * v;
    return (grid_piece){v * d1 - lens * blend, d1 - (0.5 * lean * blend + lens * turn), blend - lean * turn,
                        greater(d1, greater(d0, d2)), greater(s0, s1)};
}

/* One direction of the grid.  grid_cell: the cell in which x is, and v. */
typedef struct axis { double step, inverse, half, edge, last; } axis;
typedef struct grid_cell { double j, v; } grid_cell;

static axis axis_of(double step, size_t count)
{
    double half = 0.5 * (double)(count - 1);
    return (axis){step, 1 / step, half, half * step, (double)(count - 2)};
}

/* NaN gives last. */
SGT_INLINE double clamped(double j, double last) { return chosen(MASK(j < last), larger(j, 0), last); }

/* j is a whole number in 0 ... count - 2, wherever x is. */
SGT_INLINE grid_cell cell_of(axis a, double x)
{
    double j = (double)(int)clamped(x * a.inverse + a.half, a.last), off = sgt_fma(a.half - j, a.step, x);
    j = clamped(j + (chosen(MASK(off >= a.step), 1, 0) - chosen(MASK(off < 0), 1, 0)), a.last);
    return (grid_cell){j, sgt_fma(a.half - j, a.step, x) * a.inverse};
}

/* A row between four heights. */
typedef struct grid_row { double z; grid_piece of; } grid_row;

SGT_INLINE grid_row grid_row_of(const double *z, int a, int b, int c, int d, double v, mask first, mask last)
{
    return (grid_row){z[b], grid_piece_of(z[b] - z[a], z[c] - z[b], z[d] - z[c], v, first, last)};
}

/* All that is known in a cell, in steps of the grid.  P = z + rise.  rise_off, x_off and y_off are the
 * errors of P, P_x and P_y in w, without those of their own size. */
typedef struct patch { double z, rise, x, y, xx, xy, yy, rise_off, x_off, y_off; } patch;

SGT_INLINE patch patch_at(const double *z, int columns, axis ax, axis ay, double x, double y)
{
    grid_cell cx = cell_of(ax, x), cy = cell_of(ay, y);
    mask left = MASK(cx.j == 0), right = MASK(cx.j == ax.last), low = MASK(cy.j == 0),
         high = MASK(cy.j == ay.last);
    int b = (int)cx.j + (int)cy.j * columns, a = b - (int)chosen(left, 0, 1), c = b + 1,
        d = c + (int)chosen(right, 0, 1);
    int down = (int)chosen(low, 0, columns), up = columns + (int)chosen(high, 0, columns);
    grid_row r0 = grid_row_of(z, a - down, b - down, c - down, d - down, cx.v, left, right),
             r1 = grid_row_of(z, a, b, c, d, cx.v, left, right);
    grid_row r2 = grid_row_of(z, a + columns, b + columns, c + columns, d + columns, cx.v, left, right),
             r3 = grid_row_of(z, a + up, b + up, c + up, d + up, cx.v, left, right);
    double z0 = r1.z - r0.z, z1 = r2.z - r1.z, z2 = r3.z - r2.z;
    double d0 = z0 + (r1.of.rise - r0.of.rise), d1 = z1 + (r2.of.rise - r1.of.rise),
           d2 = z2 + (r3.of.rise - r2.of.rise);
    double q0 = r1.of.slope - r0.of.slope, q1 = r2.of.slope - r1.of.slope, q2 = r3.of.slope - r2.of.slope;
    grid_piece p = grid_piece_of(d0, d1, d2, cy.v, low, high), q = grid_piece_of(q0, q1, q2, cy.v, low, high);
    grid_piece bend = grid_piece_of(r1.of.bend - r0.of.bend, r2.of.bend - r1.of.bend, r3.of.bend - r2.of.bend,
                                    cy.v, low, high);
    double inside = chosen(MASK(fabs(x) <= ax.edge) & MASK(fabs(y) <= ay.edge), 0, (double)NAN);
    double dx = greater(greater(r0.of.d, r1.of.d), greater(r2.of.d, r3.of.d)),
           sx = greater(greater(r0.of.s, r1.of.s), greater(r2.of.s, r3.of.s));
    double dy = greater(p.d, greater(z0, greater(z1, z2)));
    return (patch){r1.z + inside, r1.of.rise + p.rise, r1.of.slope + q.rise + inside, p.slope + inside,
                   r1.of.bend + bend.rise, q.slope, p.bend,
                   28 * dx + 20 * sx + 10 * dy + 6 * p.s,
                   7 * dx + 22 * sx + 7 * q.d + 5 * q.s,
                   32 * dx + 22 * sx + 7 * dy + 17 * p.s};
}

SGT_KERNEL
static void grid_sag(const sgt_grid *self, size_t n, const double *restrict px, const double *restrict py,
                     double *restrict p, double *restrict gx, double *restrict gy)
{
    const axis ax = axis_of(self->step_x, self->z.columns), ay = axis_of(self->step_y, self->z.rows);
    const double *z = self->z.x;
    const int columns = (int)self->z.columns;
    LANES for (size_t i = 0; i < n; i++) {
        patch at = patch_at(z, columns, ax, ay, px[i], py[i]);
        p[i] = at.z + at.rise;
        gx[i] = at.x * ax.inverse;
        gy[i] = at.y * ay.inverse;
    }
}

static void grid_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    grid_sag(self, n, x, y, out.p, out.px, out.py);
}

static void grid_off(const void *self, double x, double y, double *p_err, double *grad_err)
{
    const sgt_grid *g = self;
    const axis ax = axis_of(g->step_x, g->z.columns), ay = axis_of(g->step_y, g->z.rows);
    const double least = 0x1p-1060, more = 1 + 0x1p-20;
    patch at = patch_at(g->z.x, (int)g->z.columns, ax, ay, x, y);
    *p_err = *grad_err = HUGE_VAL;
    if (!(fabs(at.z) < HUGE_VAL)) return;
    *p_err = SGT_U * (at.rise_off + fabs(at.z + at.rise)) * more + least;
    double x_err = SGT_U * (at.x_off + 4 * fabs(at.x)) * ax.inverse,
           y_err = SGT_U * (at.y_off + 3 * fabs(at.y)) * ay.inverse;
    *grad_err = larger(x_err, y_err) * more + least;
}

SGT_KERNEL
static void grid_bent(const sgt_grid *self, size_t n, const double *restrict px, const double *restrict py,
                      double *restrict pxx, double *restrict pxy, double *restrict pyy)
{
    const axis ax = axis_of(self->step_x, self->z.columns), ay = axis_of(self->step_y, self->z.rows);
    const double *z = self->z.x;
    const int columns = (int)self->z.columns;
    LANES for (size_t i = 0; i < n; i++) {
        patch at = patch_at(z, columns, ax, ay, px[i], py[i]);
        pxx[i] = at.xx * ax.inverse * ax.inverse;
        pxy[i] = at.xy * ax.inverse * ay.inverse;
        pyy[i] = at.yy * ay.inverse * ay.inverse;
    }
}

SGT_NARROW(void, sgt_grid_second,
           (const void *self, size_t n, const double *x, const double *y, double *pxx, double *pxy,
            double *pyy))
{
    grid_bent(self, n, x, y, pxx, pxy, pyy);
}

/* Has sgt_grid_measure looked at the numbers? */
static bool measured(const sgt_grid *g) { return g->height > 0; }

static sgt_objection grid_objection(const void *self)
{
    const sgt_grid *g = self;
    if (!(g->step_x > 0 && g->step_x < HUGE_VAL))
        return (sgt_objection){"step_x", "must be finite and above 0"};
    if (!(g->step_y > 0 && g->step_y < HUGE_VAL))
        return (sgt_objection){"step_y", "must be finite and above 0"};
    bool sized = g->z.rows >= GRID_LEAST && g->z.rows <= GRID_MOST && g->z.columns >= GRID_LEAST &&
                 g->z.columns <= GRID_MOST;
    if (!g->z.x || !sized) return (sgt_objection){"sag", "must have 4 to 4096 rows and columns"};
    if (!(g->height >= 0 && g->steep >= 0 && g->bend >= 0))
        return (sgt_objection){"sag", "is not measured as sgt_grid_measure does"};
    if (!measured(g) && !numbers_finite(g->z.rows * g->z.columns, g->z.x))
        return (sgt_objection){"sag", "must not have a hole (a height that is not finite)"};
    return (sgt_objection){NULL, NULL};
}

/* ----------------------------------------------------------------------------------------- bounds */

/* Raises most[p][q] to the greatest p-th difference by row of q-th differences by column, in n columns of
 * the rows from a on. */
SGT_KERNEL
static void differences(const double *a, size_t columns, size_t rows, size_t n, double most[4][4])
{
    static const size_t orders[4] = {4, 3, 3, 1};
    double w[4][DEPARTURE_BLOCK];
    for (size_t p = 0; p < rows; p++)
        LANES for (size_t k = 0; k < n; k++) w[p][k] = a[p * columns + k];
    for (size_t p = 1; p < rows; p++)
        for (size_t r = rows - 1; r >= p; r--)
            LANES for (size_t k = 0; k < n; k++) w[r][k] -= w[r - 1][k];
    for (size_t p = 0; p < rows; p++) {
        double *v = w[p];
        for (size_t q = 0, left = n; q < orders[p] && left > 0; q++, left--) {
            double greatest_yet = most[p][q];
            for (size_t k = 0; k < left; k++) greatest_yet = larger(fabs(v[k]), greatest_yet);
            most[p][q] = greatest_yet;
            for (size_t k = 0; k + 1 < left; k++) v[k] = v[k + 1] - v[k];
        }
    }
}

/* The heights that the cells of an interval are made of: *first, and how many (at least four).  0: the
 * interval has no cell. */
static size_t heights_of(axis a, sgt_interval x, size_t *first)
{
    if (!(x.lo <= a.edge && x.hi >= -a.edge)) return 0;
    double count = a.last + 2, lo = clamped(x.lo * a.inverse + a.half - 0x1p-20, a.last),
           hi = clamped(x.hi * a.inverse + a.half + 0x1p-20, a.last);
    size_t from = (size_t)larger((double)(int)lo - 1, 0),
           to = (size_t)hi + 2 < (size_t)count - 1 ? (size_t)hi + 2 : (size_t)count - 1;
    if (to - from < 3) {
        if (from == 0) to = 3;
        else from = to - 3;
    }
    *first = from;
    return to - from + 1;
}

/* M of the head over the region.  Returns false if the region has no cell of the grid. */
static bool table_of(const sgt_grid *g, axis ax, axis ay, const region *where, double most[4][4])
{
    size_t j = 0, i = 0, columns = heights_of(ax, where->x, &j), rows = heights_of(ay, where->y, &i);
    memset(most, 0, sizeof(double[4][4]));
    if (columns == 0 || rows == 0) return false;
    for (size_t r = 0; r < rows; r++)
        /* Pieces share three columns, so that no difference is missed. */
        for (size_t c = 0; c + 1 < columns; c += DEPARTURE_BLOCK - 3) {
            size_t n = columns - c < DEPARTURE_BLOCK ? columns - c : DEPARTURE_BLOCK;
            differences(g->z.x + (i + r) * g->z.columns + (j + c), g->z.columns, rows - r < 4 ? rows - r : 4,
                        n, most);
        }
    double off = 64 * SGT_U * most[0][0]; /* differences of up to 16 heights, each rounded at most 4 times */
    for (int p = 0; p < 4; p++)
        for (int q = 0; q < 4; q++) most[p][q] += off;
    return true;
}

enum { SMALL = 12 };

/* NaN means no bound: 0 of a flat grid times the infinite inverse of a step below 2^-1024. */
static double bound_of(double most) { return most >= 0 ? most * (1 + 0x1p-40) : HUGE_VAL; }

/* If the grid is measured, regions of more than a few cells get the bounds of the whole grid. */
static int grid_bounds(const void *self, region *where, bounds *out)
{
    const sgt_grid *g = self;
    const axis ax = axis_of(g->step_x, g->z.columns), ay = axis_of(g->step_y, g->z.rows);
    double m[4][4] = {{0}};
    bool small = (where->x.hi - where->x.lo) * ax.inverse <= SMALL &&
                 (where->y.hi - where->y.lo) * ay.inverse <= SMALL;
    if (measured(g) && !small) {
        size_t unused;
        if (!heights_of(ax, where->x, &unused) || !heights_of(ay, where->y, &unused)) return 0;
    } else if (!table_of(g, ax, ay, where, m)) {
        return 0;
    }
    bool whole = where->x.lo >= -ax.edge && where->x.hi <= ax.edge && where->y.lo >= -ay.edge &&
                 where->y.hi <= ay.edge;
    where->x = sgt_interval_intersection(where->x, sgt_interval_between(-ax.edge, ax.edge));
    where->y = sgt_interval_intersection(where->y, sgt_interval_between(-ay.edge, ay.edge));
    double sx = 1.25 * (m[0][1] + 0.5 * larger(m[0][2], m[0][3])) * ax.inverse,
           sy = 1.25 * (m[1][0] + 0.5 * larger(m[2][0], m[3][0])) * ay.inverse;
    double xx = 1.25 * (m[0][2] + m[0][3]) * ax.inverse * ax.inverse,
           yy = 1.25 * (m[2][0] + m[3][0]) * ay.inverse * ay.inverse;
    double xy = (m[1][1] + m[1][2] + m[2][1] + m[2][2]) * ax.inverse * ay.inverse;
    *out = (bounds){bound_of(1.5625 * m[0][0]), bound_of(length_of(sx, sy)), bound_of(norm_of(xx, xy, yy))};
    if (measured(g) && !small) *out = (bounds){g->height, g->steep, g->bend};
    return whole ? 1 : -1;
}

/* d, s, d_y, s_y of the head from the differences, or from the bounds made of them.  Between the heights a
 * result is at most 5/4 of the greatest. */
static void grid_noise(const void *self, double radius, double e[2])
{
    const sgt_grid *g = self;
    region where = {{-radius, radius}, {-radius, radius}, 0, radius};
    double m[4][4] = {{0}}, sx = g->step_x, sy = g->step_y;
    if (measured(g))
        m[0][0] = g->height, m[0][1] = g->steep * sx, m[0][2] = g->bend * (sx * sx), m[1][0] = g->steep * sy,
        m[2][0] = g->bend * (sy * sy);
    else table_of(g, axis_of(sx, g->z.columns), axis_of(sy, g->z.rows), &where, m);
    e[0] = SGT_U * (28 * m[0][1] + 20 * m[0][2] + 12.5 * m[1][0] + 7.5 * m[2][0] + 1.5625 * m[0][0]) *
               (1 + 0x1p-20) +
           0x1p-1060,
    e[1] = 0;
}

void sgt_grid_measure(sgt_grid *g)
{
    region all = {{-HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, HUGE_VAL}, 0, HUGE_VAL};
    bounds b = {(double)NAN, (double)NAN, (double)NAN};
    g->height = 0; /* not measured */
    if (!grid_objection(g).reason) grid_bounds(g, &all, &b);
    g->height = larger(b.size, DBL_MIN), g->steep = b.steep, g->bend = b.bend;
    if (isnan(b.size)) g->height = 0;
}

/* ------------------------------------------------------------------------------------- parameters */

static size_t grid_parameter_count(const void *self) { (void)self; return 0; }

static const departure grid_departure = {
    .at = grid_at, .rounding = grid_off, .bounds = grid_bounds, .second = sgt_grid_second,
    .parameters = grid_parameter_count, .object = grid_objection, .noise = grid_noise,
    .ahead = sgt_grid_ahead, .framed = true};

static departure_sag grid_on_conic(const sgt_grid *g)
{
    double across = axis_of(g->step_x, g->z.columns).edge, along = axis_of(g->step_y, g->z.rows).edge;
    return (departure_sag){.c = g->c, .k = g->k, .semi_diameter = g->semi_diameter, .base = true,
                           .of = &grid_departure, .self = g,
                           .reach = length_of(across, along) * (1 + 0x1p-50)};
}

DEPARTURE_OPS(grid, sgt_grid, grid_on_conic)
