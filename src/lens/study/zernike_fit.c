// SPDX-License-Identifier: MIT
/* zernike_fit.c - least squares of Zernike polynomials over many points, of which none is kept.
 *
 * The rows of the matrix A are the polynomials at the points, each times the root of its weight; v are the
 * values, times the same.  Wanted is the c with the least |A c - v|.
 *
 * BY BLOCKS.  Householder's reflections turn a block of rows that is put below the triangle R of all rows
 * before it into the triangle of both, and leave zeros in the block (Golub & Van Loan 2013, Matrix
 * Computations, section 6.5).  In column j the triangle has one number only that has a part in it, R_jj.
 * What is left of v in the block is the part of v that no c reaches: its squares add up to those of the
 * residual.
 * So memory is that of R.  The condition of A counts once.  But blocks come one after the other.
 *
 * BY SUMS, for many points in threads.  Some points of the same pupil give R and c0 by blocks.  The columns
 * of Q = A R^-1, of all points, are then nearly orthogonal: they would be if both sets of points had the same
 * mean products of polynomials.  With v' = v - A c0 the normal equations are
 *
 *     Q^T Q d = Q^T v',   c = c0 + R^-1 d,   |v - A c|^2 = |v'|^2 - d . Q^T v',
 *
 * and the condition of Q counts twice, which is near 1.  It is looked at: with Q^T Q = L L^T, a diagonal of L
 * below LIKE times the largest means that the points are not alike, and the fit is made by blocks.
 * v' is about as small as what the fit leaves, so that little cancels in the last formula.
 * The sums of blocks are made in any thread, and added in a tree of their numbers (tree.h). */
#include "zernike_fit.h"

#include <math.h>
#include <string.h>

static const double ALIKE = 1e-12; /* of a column, what is left of it: else it is made of those before */
static const double LIKE = 0x1p-5;

typedef double two_rows __attribute__((vector_size(2 * sizeof(double))));
enum { SUMS_AT_ONCE = 4 }; /* sums that do not wait for each other */
_Static_assert((int)PUPIL_PART % (2 * (int)SUMS_AT_ONCE) == 0, "whole groups");

static double dot_of(const double a[], const double b[])
{
    two_rows sum[SUMS_AT_ONCE] = {{0}};
    for (size_t i = 0; i < PUPIL_PART; i += 2 * SUMS_AT_ONCE)
        for (size_t q = 0; q < SUMS_AT_ONCE; q++) {
            const double *x = a + i + 2 * q, *y = b + i + 2 * q;
            sum[q] += (two_rows){x[0], x[1]} * (two_rows){y[0], y[1]};
        }
    const two_rows all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    return all[0] + all[1];
}

/* to -= f a */
static void less(double f, const double *restrict a, double *restrict to)
{
    for (size_t i = 0; i < PUPIL_PART; i++) to[i] -= f * a[i];
}

size_t sgt_zernike_block_room(size_t terms) { return terms * PUPIL_PART; }
size_t sgt_zernike_triangle_room(size_t terms) { return terms * terms + terms; }

void sgt_zernike_block_of(sgt_zernike_order order, size_t terms, size_t count, const double x[],
                          const double y[], const double value[], const double weight[], zernike_block *out)
{
    enum { OF_BASE = 2 }; /* c and k are the first parameters */
    static double none[ZERNIKE_TERMS_MOST]; /* never written: what stays 0 takes no room in the file */
    double at[3][PUPIL_PART] = {{0}}, root[PUPIL_PART] = {0};
    const sgt_zernike z = {.norm = 1, .order = (int)order, .normalised = order == SGT_NOLL,
                           .a = {none, 1, terms}};
    size_t rows = 0;
    out->weight = 0;
    memset(out->value, 0, sizeof out->value);
    for (size_t i = 0; i < count; i++) {
        if (isnan(value[i] + x[i] + y[i]) || !(weight[i] > 0)) continue;
        at[0][rows] = x[i], at[1][rows] = y[i], root[rows] = sqrt(weight[i]);
        out->value[rows] = root[rows] * value[i], out->weight += weight[i];
        rows++;
    }
    out->rows = rows;
    for (size_t j = 0; j < terms; j++) {
        double *column = out->column + j * PUPIL_PART;
        sgt_zernike_ops.by_parameter(&z, OF_BASE + j, PUPIL_PART, (sgt_points){{at[0], at[1], at[2]}},
                                     (sgt_values){.f = column});
        for (size_t i = 0; i < PUPIL_PART; i++) column[i] *= -root[i]; /* F is z less the sag */
    }
}

/* ----------------------------------------------------------------------- by blocks */

zernike_triangle sgt_zernike_triangle_in(size_t terms, double room[])
{
    memset(room, 0, sgt_zernike_triangle_room(terms) * sizeof *room);
    return (zernike_triangle){.terms = terms, .r = room, .right = room + terms * terms};
}

/* R_ik, i <= k. */
static double *entry(const zernike_triangle *t, size_t i, size_t k) { return &t->r[k * t->terms + i]; }

void sgt_zernike_absorb(zernike_triangle *t, zernike_block *b)
{
    for (size_t j = 0; j < t->terms; j++) {
        double *v = b->column + j * PUPIL_PART, *r = entry(t, j, j);
        const double norm = sqrt(*r * *r + dot_of(v, v));
        if (!(norm > 0)) continue;
        const double diagonal = *r > 0 ? -norm : norm, head = *r - diagonal;
        const double by = 1 / (norm * (norm + fabs(*r)));
        for (size_t k = j + 1; k <= t->terms; k++) {
            double *to = k < t->terms ? b->column + k * PUPIL_PART : b->value;
            double *top = k < t->terms ? entry(t, j, k) : &t->right[j];
            const double f = by * (head * *top + dot_of(v, to));
            *top -= f * head;
            less(f, v, to);
        }
        *r = diagonal;
    }
    t->left += dot_of(b->value, b->value), t->rows += b->rows, t->weight += b->weight;
}

/* x = R^-1 right */
static void back_substitute(const zernike_triangle *t, const double right[], double x[])
{
    for (size_t j = t->terms; j-- > 0;) {
        double sum = right[j];
        for (size_t k = j + 1; k < t->terms; k++) sum -= *entry(t, j, k) * x[k];
        x[j] = sum / *entry(t, j, j);
    }
}

bool sgt_zernike_solve(const zernike_triangle *t, double coefficient[], double *residual)
{
    if (t->rows < t->terms) return false;
    for (size_t k = 0; k < t->terms; k++) {
        double whole = 0;
        for (size_t i = 0; i <= k; i++) whole += *entry(t, i, k) * *entry(t, i, k);
        if (!(fabs(*entry(t, k, k)) > ALIKE * sqrt(whole))) return false;
    }
    back_substitute(t, t->right, coefficient);
    if (residual) *residual = sqrt(t->left / t->weight);
    return true;
}

/* ------------------------------------------------------------------------- by sums */

/* Sums: Q^T Q, row by row up to the diagonal; Q^T v'; |v'|^2, the weights. */
static size_t products(size_t terms) { return terms * (terms + 1) / 2; }
size_t sgt_zernike_sums_room(size_t terms) { return products(terms) + terms + 2; }

void sgt_zernike_sums(const zernike_triangle *about, const double coefficient[], zernike_block *b,
                      double sums[])
{
    const size_t terms = about->terms;
    double *to = sums;
    for (size_t j = 0; j < terms; j++) less(coefficient[j], b->column + j * PUPIL_PART, b->value);
    for (size_t j = 0; j < terms; j++) {
        double *q = b->column + j * PUPIL_PART;
        const double by = 1 / *entry(about, j, j);
        for (size_t i = 0; i < j; i++) less(*entry(about, i, j), b->column + i * PUPIL_PART, q);
        for (size_t i = 0; i < PUPIL_PART; i++) q[i] *= by;
        for (size_t i = 0; i <= j; i++) *to++ = dot_of(b->column + i * PUPIL_PART, q);
    }
    for (size_t j = 0; j < terms; j++) *to++ = dot_of(b->column + j * PUPIL_PART, b->value);
    to[0] = dot_of(b->value, b->value), to[1] = b->weight;
}

bool sgt_zernike_joined(const zernike_triangle *about, double sums[], double coefficient[], double *residual)
{
    const size_t terms = about->terms;
    double *l = sums, *d = sums + products(terms), *left = d + terms, *weight = left + 1, most = 0;
    for (size_t j = 0; j < terms; j++) { /* Cholesky's, and L y = Q^T v' */
        double *own = l + products(j);
        for (size_t k = 0; k <= j; k++) {
            const double *other = l + products(k);
            for (size_t i = 0; i < k; i++) own[k] -= own[i] * other[i];
            if (k < j) own[k] /= other[k];
        }
        if (!(own[j] > 0)) return false;
        own[j] = sqrt(own[j]), most = fmax(most, own[j]);
        for (size_t i = 0; i < j; i++) d[j] -= own[i] * d[i];
        d[j] /= own[j];
        *left -= d[j] * d[j];
    }
    for (size_t j = 0; j < terms; j++)
        if (!(l[products(j) + j] >= LIKE * most)) return false;
    for (size_t j = terms; j-- > 0;) { /* L^T d = y */
        for (size_t k = j + 1; k < terms; k++) d[j] -= l[products(k) + j] * d[k];
        d[j] /= l[products(j) + j];
    }
    back_substitute(about, d, d);
    for (size_t j = 0; j < terms; j++) coefficient[j] += d[j];
    *residual = sqrt(fmax(*left, 0) / *weight);
    return true;
}
