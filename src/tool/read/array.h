// SPDX-License-Identifier: MIT
/* array.h - an array of NumPy's npy format: its rows, as they stand in the file. */
#ifndef TOOL_ARRAY_H
#define TOOL_ARRAY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A field of a structured array, or the numbers of one that is not: then the name is "". */
typedef struct array_field {
    char name[24], type[12];  /* type: as NumPy writes it, '<f8' without the quotes */
    size_t offset, size;      /* bytes, in a row */
} array_field;

typedef struct array {
    const char *path;         /* for messages */
    const unsigned char *row; /* the first */
    bool mapped;              /* they are in the file, not in memory */
    size_t *left;             /* up to where array_leave has left them; threads set it */
    size_t rows, row_size, columns; /* columns: of a plain array of two dimensions; 0: it has one */
    size_t fields;
    array_field *field;
} array;

/* Opens a file; path: as long as the command.  A file that cannot be read, that is not what its header says,
 * or whose header is not understood, ends the command. */
array array_open(const char *path);

/* Its i-th row. */
static inline const unsigned char *array_row(const array *a, size_t i) { return a->row + i * a->row_size; }

/* These rows are read, and those before them: they need not stay in memory.  They can be read again. */
void array_leave(const array *a, size_t first, size_t count);

/* A number of 8 bytes, the lower first. */
static inline uint64_t array_bits(const unsigned char *at)
{
    uint64_t bits;
    memcpy(&bits, at, sizeof bits);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    bits = __builtin_bswap64(bits);
#endif
    return bits;
}

static inline double array_double(const unsigned char *at)
{
    const uint64_t bits = array_bits(at);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* A float of 4 bytes, the lower first. */
static inline double array_float(const unsigned char *at)
{
    const uint32_t bits = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    float x;
    memcpy(&x, &bits, sizeof x);
    return (double)x;
}

/* One of `size` bytes, at most 8. */
long long array_integer(const unsigned char *at, size_t size);

#endif
