/* matrix.h - reads a table of numbers from a file: csv, or npy as NumPy writes it. */
#ifndef TOOL_MATRIX_H
#define TOOL_MATRIX_H
#include "../base/fail.h"

#include <stdbool.h>

#include <sagitta/surfaces.h>

/* Does the name end in .csv or .npy? */
bool matrix_is_file(const char *name);

/* Reads a file.  All rows must be equally long and every number finite, with at most `most` rows and `most`
 * columns.  false: `why` says what is wrong, as "grid.csv:3: column 4: empty". */
enum { MATRIX_WHY_SIZE = 600 };
bool matrix_read(sgt_numbers *to, const char *path, size_t most, char why[MATRIX_WHY_SIZE]);

#endif
