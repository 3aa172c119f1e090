// SPDX-License-Identifier: MIT
/* body_cells.h - what body_cells.c shows. */
#ifndef TESTS_CATALOGUE_BODY_CELLS_H
#define TESTS_CATALOGUE_BODY_CELLS_H
#include <sagitta/surfaces.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How many sets of instructions of the library this processor has. */
int body_sets(void);

/* The cells, by that set.  0: the surface is none of the three, and nothing is done. */
int body_cells(sgt_surface s, int set, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
               sgt_enclosures out);

/* `first` of sgt_builtin_ops, by the first of the sets.  0: as above. */
int body_first(sgt_surface s, const sgt_ray *ray, sgt_span *span, double *steep);

#ifdef __cplusplus
}
#endif
#endif
