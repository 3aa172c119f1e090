/* matrix.h - a table of numbers from a file: csv, or npy as NumPy writes it. */
#ifndef TOOL_MATRIX_H
#define TOOL_MATRIX_H
#include "../base/fail.h"

#include <stdbool.h>

#include <sagitta/surfaces.h>

/* Is it a name of such a file: NAME.csv, NAME.npy? */
bool matrix_is_file(const char *name);

/* Reads it: rows that are equally long, every number finite, at most `most` rows and `most` columns.
 * false: it cannot, and `why` says so: "grid.csv:3: column 4: empty". */
enum { MATRIX_WHY_SIZE = 600 };
bool matrix_read(sgt_numbers *to, const char *path, size_t most, char why[MATRIX_WHY_SIZE]);

#endif
