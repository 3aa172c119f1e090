// SPDX-License-Identifier: MIT
/* npy.h - a table as NumPy reads it: one structured array, or a folder with an array for each column. */
#ifndef TOOL_NPY_H
#define TOOL_NPY_H
#include "../base/bytes.h"
#include "table.h"

typedef struct npy_output npy_output;

/* Opens the file target->path, if its name ends in .npy, or makes the folder.  NULL, standard output, a file
 * that has no beginning to go back to, or a folder with other things in it end the command.  head: as long as
 * the output.  If target->nowhere and nothing is placed, nothing is opened. */
npy_output *npy_begin(const table_target *target, size_t columns, const column *head);

/* How many files there are. */
size_t npy_files(const npy_output *n);

/* Appends rows, given by column, to out[npy_files()]: the bytes of each file.  May run in any thread. */
void npy_block(const npy_output *n, size_t rows, const table_values values[], bytes out[]);

/* Writes these bytes, and leaves `out` empty. */
void npy_write(npy_output *n, bytes out[]);

/* If target->placed: writes these bytes from row `first` on, and leaves `out` empty; one thread at a time.
 * npy_placed: all ranks have. */
void npy_place_rows(npy_output *n, size_t first, bytes out[]);
void npy_placed(npy_output *n);

/* Tells each file how many rows it has.  If one cannot be written the command ends. */
void npy_end(npy_output *n);

#endif
