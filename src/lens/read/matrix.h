// SPDX-License-Identifier: MIT
/* matrix.h - reads a table of numbers from a file: csv, or npy as NumPy writes it. */
#ifndef SGT_LENS_MATRIX_H
#define SGT_LENS_MATRIX_H
#include "tree.h"

/* Does the name end in .csv or .npy? */
bool sgt_matrix_is_file(const char *name);

/* Reads a file.  All rows must be equally long and every number finite, with at most `most` rows and `most`
 * columns.  false: `why` says what is wrong, as "grid.csv:3: column 4: empty". */
enum { MATRIX_WHY_SIZE = 600 };
bool sgt_matrix_read(source *of, sgt_numbers *to, const char *path, size_t most, char why[MATRIX_WHY_SIZE]);

#endif
