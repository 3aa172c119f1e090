/* npy.h - a table as NumPy reads it: one structured array, or a folder with an array for each column. */
#ifndef TOOL_NPY_H
#define TOOL_NPY_H
#include "table.h"

typedef struct npy_output npy_output;

/* The bytes of a cell. */
size_t npy_size(const table_target *target, column_kind kind);

/* Opens the file target->path, if its name ends in .npy, or makes the folder.  NULL, standard output, a file
 * that has no beginning to go back to, or a folder with other things in it end the command.  target, head: as
 * long as the output. */
npy_output *npy_begin(const table_target *target, size_t columns, const column *head);

/* Appends whole rows: their cells, one behind another. */
void npy_write(npy_output *n, size_t length, const char *rows);

/* Tells each file how many rows it has.  If one cannot be written the command ends. */
void npy_end(npy_output *n);

#endif
