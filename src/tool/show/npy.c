// SPDX-License-Identifier: MIT
/* npy.c - writes the npy format, version 1.0 (NEP 1): a header that is a Python literal, then the bytes.
 *
 * How many rows there are is known last.  So a header has room for the largest number, and is written twice:
 * first with no rows, so that a file of a command that was stopped is an empty array, and last with all.
 *
 * PLACED ROWS.  If it is known before, rank 0 makes the file as long as it will be, and all ranks write rows
 * where they belong, by MPI-IO.  With --resume the file is taken as it is, if it has that length. */
#include "npy.h"

#include "../base/bytes.h"
#include "../base/input.h"
#include "../base/ranks.h"
#include "../base/shard.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct npy_file {
    char *path;
    const char *name; /* while it is written */
    FILE *file;
    ranks_file *shared; /* of rows that are placed */
    size_t row_size, header;
} npy_file;

/* Where a column is: in a file, at so many bytes of its rows. */
typedef struct npy_place { size_t file, offset; } npy_place;

struct npy_output {
    size_t word_size;  /* of a WORD: bytes */
    bool floats;       /* a number is written as a float, which it is */
    const column *head;
    size_t columns, rows, placed;
    bool folder;
    npy_file *file;    /* one, or one for each column */
    npy_place *place;  /* [columns] */
};

/* The bytes of a cell. */
static size_t npy_size(const npy_output *n, column_kind kind)
{
    switch (kind) {
    case COLUMN_INTEGER: return sizeof(int32_t);
    case COLUMN_CODE: return 1;
    case COLUMN_WORD: return n->word_size;
    case COLUMN_NUMBER:
    case COLUMN_ERROR: return n->floats ? sizeof(float) : sizeof(double);
    default: return 8;
    }
}

/* "<f8": order, letter and size. */
static void put_type(bytes *b, const npy_output *n, size_t place)
{
    const column_kind kind = n->head[place].kind;
    const size_t size = npy_size(n, kind);
    const uint16_t one = 1;
    const bool little = *(const uint8_t *)&one == 1, single = size == 1 || kind == COLUMN_WORD;
    const char letter = kind == COLUMN_WORD ? 'S' : kind < COLUMN_COUNT ? 'f' : 'i';
    char text[40];
    snprintf(text, sizeof text, "'%c%c%zu'", single ? '|' : little ? '<' : '>', letter, size);
    bytes_text(b, text);
}

/* The columns first ... first + count - 1 of a file; one in a folder is an array of numbers. */
static void npy_write_header(npy_output *n, size_t place)
{
    enum { START = 10, DIGITS = 20, MULTIPLE = 64 };
    bytes b = {.length = 0};
    char shape[80];
    bytes_put(&b, "\x93NUMPY\x01\x00..", START);
    bytes_text(&b, "{'descr': ");
    for (size_t i = 0; i < n->columns && !n->folder; i++) {
        bytes_text(&b, i ? ", ('" : "[('");
        bytes_text(&b, n->head[i].name);
        bytes_text(&b, "', ");
        put_type(&b, n, i);
        bytes_one(&b, ')');
    }
    if (n->folder) put_type(&b, n, place);
    bytes_text(&b, n->folder ? ", 'fortran_order': False" : "], 'fortran_order': False");
    bytes_text(&b, ", 'shape': (");
    const int digits = snprintf(shape, sizeof shape, "%zu,), }", n->rows);
    const size_t spaces = (size_t)DIGITS + 5 - (size_t)digits;
    bytes_text(&b, shape);
    memset(bytes_room(&b, spaces + MULTIPLE), ' ', spaces + MULTIPLE);
    b.length += spaces;
    b.length += MULTIPLE - b.length % MULTIPLE;
    b.at[b.length - 1] = '\n';
    b.at[8] = (char)((b.length - START) & 255), b.at[9] = (char)((b.length - START) >> 8);
    n->file[place].header = b.length;
    if (n->file[place].file) fwrite(b.at, 1, b.length, n->file[place].file);
}

/* Makes a file of placed rows as long as it will be, or takes the one that is there. */
static void npy_make_room(npy_output *n, size_t place)
{
    npy_file *f = &n->file[place];
    struct stat is;
    npy_write_header(n, place);
    const size_t size = f->header + n->placed * f->row_size;
    if (shard_keeps() && stat(f->name, &is) == 0) {
        f->file = (size_t)is.st_size == size ? fopen(f->name, "r+b") : NULL;
        if (f->file) return;
        note("--resume: %s: not as long as it was; all is made anew", f->name);
    }
    shard_forget();
    if (!(f->file = fopen(f->name, "wb"))) fail_input("--output %s: %s", f->path, strerror(errno));
    npy_write_header(n, place);
    if (fflush(f->file) != 0 || ftruncate(fileno(f->file), (off_t)size) != 0)
        fail_input("--output %s: could not be written: %s", f->path, strerror(errno));
}

static void npy_open(npy_output *n, size_t place, char *path)
{
    struct stat is;
    npy_file *f = &n->file[place];
    f->path = path;
    output_check("output", path);
    if (stat(path, &is) == 0 && !S_ISREG(is.st_mode))
        fail_input("--output %s: not a file, and an npy file is written from its beginning again", path);
    output_check("output", f->name = output_name(path));
    if (n->placed) {
        output_stays(f->name);
        if (ranks_here()) npy_write_header(n, place); /* how long it is */
        else npy_make_room(n, place);
        return;
    }
    if (!(f->file = fopen(f->name, "wb"))) fail_input("--output %s: %s", path, strerror(errno));
    setvbuf(f->file, NULL, _IONBF, 0); /* what is written is long */
    npy_write_header(n, place);
}

static char *path_of(const char *folder, const char *name)
{
    bytes b = {.length = 0};
    bytes_text(&b, folder);
    if (b.length && b.at[b.length - 1] != '/') bytes_one(&b, '/');
    bytes_text(&b, name);
    bytes_put(&b, ".npy", 5);
    return b.at;
}

static bool is_column_file(const npy_output *n, const char *name)
{
    for (size_t i = 0; i < n->columns; i++) {
        const size_t length = strlen(n->head[i].name);
        if (strncmp(name, n->head[i].name, length) != 0) continue;
        if (strcmp(name + length, ".npy") == 0 || strcmp(name + length, ".npy.unfinished") == 0) return true;
    }
    return false;
}

/* Makes the folder; one that is there may hold the columns of this table, and nothing else. */
static void npy_open_folder(npy_output *n, const char *path)
{
    DIR *folder = NULL;
    if (!ranks_here() && mkdir(path, 0777) != 0 && (errno != EEXIST || !(folder = opendir(path))))
        fail_input("--output %s: %s; npy goes into a folder, or a file NAME.npy", path, strerror(errno));
    const char *other = NULL;
    for (struct dirent *e; folder && !other && (e = readdir(folder));)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 && !is_column_file(n, e->d_name))
            other = memory_text(e->d_name, strlen(e->d_name));
    if (folder) closedir(folder);
    if (other)
        fail_input("--output %s: it holds %s, which is no column of this table; give a folder that is "
                   "empty or not there yet, or a file NAME.npy",
                   path, other);
    for (size_t i = 0; i < n->columns; i++) npy_open(n, i, path_of(path, n->head[i].name));
}

npy_output *npy_begin(const table_target *target, size_t columns, const column *head)
{
    const char *path = target->path;
    if (!path || strcmp(path, "-") == 0)
        fail_usage("--format npy: give --output NAME.npy or --output FOLDER; it cannot go to standard "
                   "output, since the number of rows is written last, at the beginning");
    if (target->hexadecimal) fail_usage("--hex: not with --format npy, where numbers are bytes");
    const size_t length = strlen(path);
    npy_output *n = memory_take(1, sizeof *n);
    *n = (npy_output){.head = head, .columns = columns,
                      .word_size = target->word_size ? target->word_size : 1, .placed = target->placed,
                      .floats = target->single,
                      .file = memory_take(columns, sizeof *n->file),
                      .place = memory_take(columns, sizeof *n->place),
                      .folder = length < 4 || strcmp(path + length - 4, ".npy") != 0};
    for (size_t i = 0; i < columns; i++) {
        npy_file *f = &n->file[n->folder ? i : 0];
        n->place[i] = (npy_place){(size_t)(f - n->file), f->row_size};
        f->row_size += npy_size(n, head[i].kind);
    }
    if (target->nowhere && !n->placed) return n;
    if (n->folder) npy_open_folder(n, path);
    else npy_open(n, 0, memory_text(path, length));
    for (size_t f = 0; f < npy_files(n) && n->placed; f++)
        n->file[f].shared = ranks_open(n->file[f].path, n->file[f].name);
    return n;
}

size_t npy_files(const npy_output *n) { return n->folder ? n->columns : 1; }

/* Copies a column of cells of a size that the compiler knows, four at a time. */
#define COPY(SIZE)                                                                    \
    for (; rows >= 4; rows -= 4, to += 4 * apart, from += 4 * step) {                 \
        memcpy(to, from, SIZE);                                                       \
        memcpy(to + apart, from + step, SIZE);                                        \
        memcpy(to + 2 * apart, from + 2 * step, SIZE);                                \
        memcpy(to + 3 * apart, from + 3 * step, SIZE);                                \
    }                                                                                 \
    for (; rows > 0; rows--, to += apart, from += step) memcpy(to, from, SIZE)

/* size: of a cell; apart: from one to the next. */
static void copy_column(char *to, size_t apart, size_t size, column_kind kind, const table_values *v,
                        size_t rows)
{
    static const double nan = (double)NAN;
    static const long long zero;
    const bool word = kind == COLUMN_WORD;
    const char *from = v->at ? v->at : kind < COLUMN_COUNT ? (const char *)&nan : (const char *)&zero;
    const size_t step = v->at ? v->step : 0;
    if (word) {
        for (size_t i = 0; i < rows; i++, to += apart, from += step) {
            const char *const *text = v->at ? (const void *)from : NULL;
            const size_t length = text ? strlen(*text) : 0;
            if (length) memcpy(to, *text, length);
            memset(to + length, 0, size - length);
        }
    } else if (size == sizeof(float) && kind < COLUMN_COUNT) {
        for (size_t i = 0; i < rows; i++, to += apart, from += step) {
            double value;
            memcpy(&value, from, sizeof value);
            memcpy(to, &(float){(float)value}, sizeof(float));
        }
    } else if (size == 8) {
        COPY(8);
    } else if (size == 4) {
        COPY(4);
    } else {
        COPY(1);
    }
}

enum { ROWS_AT_ONCE = 128 }; /* they stay in the cache until all their columns are there */

void npy_block(const npy_output *n, size_t rows, const table_values values[], bytes out[])
{
    for (size_t f = 0; f < npy_files(n); f++) bytes_room(&out[f], rows * n->file[f].row_size);
    for (size_t first = 0, count; first < rows; first += count) {
        count = rows - first < ROWS_AT_ONCE ? rows - first : ROWS_AT_ONCE;
        for (size_t c = 0; c < n->columns; c++) {
            const npy_place *p = &n->place[c];
            const size_t apart = n->file[p->file].row_size;
            const table_values v = {values[c].at ? (const char *)values[c].at + first * values[c].step : NULL,
                                    values[c].step, NULL};
            copy_column(out[p->file].at + out[p->file].length + first * apart + p->offset, apart,
                        npy_size(n, n->head[c].kind), n->head[c].kind, &v, count);
        }
    }
    for (size_t f = 0; f < npy_files(n); f++) out[f].length += rows * n->file[f].row_size;
}

void npy_write(npy_output *n, bytes out[])
{
    n->rows += out[0].length / n->file[0].row_size;
    for (size_t f = 0; f < npy_files(n); f++) {
        if (out[f].length) fwrite(out[f].at, 1, out[f].length, n->file[f].file);
        out[f].length = 0;
    }
}

void npy_place_rows(npy_output *n, size_t first, bytes out[])
{
    for (size_t i = 0; i < npy_files(n); i++) {
        const npy_file *f = &n->file[i];
        ranks_write(f->shared, f->header + first * f->row_size, out[i].at, out[i].length);
        out[i].length = 0;
    }
}

void npy_placed(npy_output *n)
{
    for (size_t i = 0; i < npy_files(n); i++) ranks_close(n->file[i].shared);
    n->rows = n->placed;
}

void npy_end(npy_output *n)
{
    for (size_t i = 0; i < npy_files(n); i++) {
        npy_file *f = &n->file[i];
        bool bad = ferror(f->file) || fseek(f->file, 0, SEEK_SET) != 0;
        if (!bad) npy_write_header(n, i);
        bad = bad || ferror(f->file);
        if (fclose(f->file) != 0 || bad) fail_input("--output %s: could not be written", f->path);
        output_whole("output", f->name, f->path);
    }
}
