/* array.h - an array of NumPy's npy format, read by rows. */
#ifndef TOOL_ARRAY_H
#define TOOL_ARRAY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* A field of a structured array, or the numbers of one that is not: then the name is "". */
typedef struct array_field {
    char name[24], type[12];  /* type: as NumPy writes it, '<f8' without the quotes */
    size_t offset, size;      /* bytes, in a row */
} array_field;

typedef struct array {
    const char *path;         /* for messages */
    FILE *file;
    long start;               /* of the first row, in the file */
    size_t rows, row_size, columns; /* columns: of a plain array of two dimensions; 0: it has one */
    size_t fields;
    array_field *field;
} array;

/* Opens a file; path: as long as the command.  A file that cannot be read, that is not what its header says,
 * or whose header is not understood, ends the command. */
array array_open(const char *path);

/* Reads rows.  May be called from any thread. */
void array_read(const array *a, size_t first, size_t count, unsigned char *to);

/* A number of 8 bytes, the lower first.  (In one expression: so compilers make one load of it.) */
static inline double array_double(const unsigned char *at)
{
    const uint64_t bits = at[0] | (uint64_t)at[1] << 8 | (uint64_t)at[2] << 16 | (uint64_t)at[3] << 24 |
                          (uint64_t)at[4] << 32 | (uint64_t)at[5] << 40 | (uint64_t)at[6] << 48 |
                          (uint64_t)at[7] << 56;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* One of `size` bytes, at most 8. */
long long array_integer(const unsigned char *at, size_t size);

#endif
