// SPDX-License-Identifier: MIT
/* zernike_fit.h - Zernike polynomials fitted to more points than are kept (zernike_fit.c). */
#ifndef SGT_STUDY_ZERNIKE_FIT_H
#define SGT_STUDY_ZERNIKE_FIT_H
#include "../optics/pattern.h"

#include <sagitta/analysis.h>

/* As sgt_zernike has them. */
enum { ZERNIKE_TERMS_MOST = 5151 };

/* A block of points: [terms] columns of PUPIL_PART numbers, and the values; what is beyond `rows` is 0. */
typedef struct zernike_block { size_t rows; double weight, *column, value[PUPIL_PART];
} zernike_block;

/* What is kept of all blocks: R, right, and the sums of squares that are left and of weights. */
typedef struct zernike_triangle { size_t terms, rows; double *r, *right, left, weight;
} zernike_triangle;

/* How many numbers the columns of a block, a triangle, and sums take. */
size_t sgt_zernike_block_room(size_t terms);
size_t sgt_zernike_triangle_room(size_t terms);
size_t sgt_zernike_sums_room(size_t terms);

/* Sets the block (its column is room); points with a NaN or without a weight are left out. */
void sgt_zernike_block_of(sgt_zernike_order order, size_t terms, size_t count, const double x[],
                          const double y[], const double value[], const double weight[], zernike_block *out);

/* An empty triangle. */
zernike_triangle sgt_zernike_triangle_in(size_t terms, double room[]);

/* Adds a block, which is used up. */
void sgt_zernike_absorb(zernike_triangle *t, zernike_block *b);

/* false: the points do not determine all coefficients. */
bool sgt_zernike_solve(const zernike_triangle *t, double coefficient[], double *residual);

/* The sums of a block, about a triangle of other points and the coefficients that these have.  The block is
 * used up. */
void sgt_zernike_sums(const zernike_triangle *about, const double coefficient[], zernike_block *b,
                      double sums[]);

/* From the sums of all blocks, which are used up, and the coefficients that they are about to those of all
 * points.  false: the triangle is not like them, and nothing is told. */
bool sgt_zernike_joined(const zernike_triangle *about, double sums[], double coefficient[],
                        double *residual);

#endif
