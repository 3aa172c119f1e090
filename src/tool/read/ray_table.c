// SPDX-License-Identifier: MIT
/* ray_table.c - rays from arrays of NumPy: one structured array, or one of N x 6 numbers, or a folder with an
 * array for each column.
 *
 * The columns have the names of those of csv, and the numbers are all doubles, '<f8', or all floats, '<f4',
 * of which each is a double too.  All rays are looked at before the first is traced, so that a bad one is
 * told before anything is written.  Then they are read again, some at a time; only ids are kept. */
#include "ray_table.h"

#include "../base/fail.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "array.h"

#include <dirent.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Where a column is; file NULL: there is none. */
typedef struct ray_column { const array *file; size_t offset; const array_field *field; } ray_column;

struct ray_table {
    const char *path;
    size_t rows, files, bad; /* bad: how many of the rows are */
    bool ended;              /* there is tmin or tmax */
    bool floats;             /* the numbers are floats */
    bool share, skip_bad;    /* share: this run reads only some rows, and looks only at these */
    array file[RAY_COLUMNS];
    ray_column column[RAY_COLUMNS];
    char *id;          /* [rows], each of id_room bytes */
    size_t id_room;
};

static bool ends_in_npy(const char *name)
{
    const size_t length = strlen(name);
    return length > 4 && strcmp(name + length - 4, ".npy") == 0;
}

static bool is_folder(const char *path)
{
    struct stat is;
    return stat(path, &is) == 0 && S_ISDIR(is.st_mode);
}

bool ray_table_is(const char *path) { return ends_in_npy(path) || is_folder(path); }

static void set_column(ray_table *t, int c, const array *file, const array_field *field, size_t offset)
{
    const char *type = field->type, *name = ray_column_name[c];
    if (t->column[c].file) fail_input("%s: %s: this column is given twice", t->path, name);
    const bool integer = strcmp(type, "<i8") == 0 || strcmp(type, "<i4") == 0;
    const bool floats = strcmp(type, "<f4") == 0;
    if (c < RAY_ID && !floats && strcmp(type, "<f8") != 0)
        fail_input("%s: %s: of the type '%s'; only '<f8' and '<f4' can be read, float64 and float32 with the "
                   "lower byte first",
                   file->path, name, type);
    for (int b = 0; b < RAY_ID && c < RAY_ID; b++)
        if (t->column[b].file && t->floats != floats)
            fail_input("%s: %s: of the type '%s', but %s is '%s'; the numbers must be of one type",
                       file->path, name, type, ray_column_name[b], t->column[b].field->type);
    if (c < RAY_ID) t->floats = floats;
    if (c == RAY_ID && !integer && (type[0] != '|' || type[1] != 'S'))
        fail_input("%s: id: of the type '%s'; only bytes, '|S', and integers, '<i4' and '<i8', can be read",
                   file->path, type);
    t->column[c] = (ray_column){file, offset, field};
}

static int column_named(const array *file, const char *name, size_t length)
{
    for (int c = 0; c < RAY_COLUMNS; c++)
        if (strncmp(ray_column_name[c], name, length) == 0 && !ray_column_name[c][length]) return c;
    const bool place = length == 3 && (memcmp(name, "lat", 3) == 0 || memcmp(name, "lon", 3) == 0);
    fail_input("%s: %.*s: unknown column; %sknown columns: ox, oy, oz, dx, dy, dz, tmin, tmax, id",
               file ? file->path : "--rays", (int)length, name,
               place ? "places are read from csv, or made rays in Python by sagitta.earth.rays; " : "");
}

/* One array: its fields are the columns, or its six numbers a row. */
static void open_file(ray_table *t, const char *path)
{
    array *a = &t->file[t->files++];
    *a = array_open(path);
    t->rows = a->rows;
    const bool plain = a->fields == 1 && !*a->field->name;
    if (plain && a->columns != RAY_REQUIRED)
        fail_input("%s: a plain array must be N x 6: ox, oy, oz, dx, dy, dz", path);
    for (int c = 0; plain && c < RAY_REQUIRED; c++) set_column(t, c, a, a->field, (size_t)c * a->field->size);
    for (size_t i = 0; !plain && i < a->fields; i++) {
        const array_field *f = &a->field[i];
        if (!*f->name && f->type[1] == 'V') continue; /* padding */
        set_column(t, column_named(a, f->name, strlen(f->name)), a, f, f->offset);
    }
}

/* The arrays in a folder. */
typedef struct array_names { size_t count, capacity; char **name; } array_names;

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static array_names names_in(const char *path)
{
    array_names all = {.count = 0};
    DIR *folder = opendir(path);
    if (!folder) fail_input("%s: cannot be read", path);
    for (struct dirent *e; (e = readdir(folder));) {
        if (!ends_in_npy(e->d_name)) continue;
        all.name = memory_room(all.name, all.count, &all.capacity, sizeof *all.name);
        all.name[all.count++] = memory_text(e->d_name, strlen(e->d_name));
    }
    closedir(folder);
    /* a folder has no order of its own */
    if (all.count) qsort(all.name, all.count, sizeof *all.name, by_name);
    return all;
}

static void open_folder(ray_table *t, const char *path)
{
    const array_names all = names_in(path);
    for (size_t i = 0; i < all.count; i++) {
        const size_t size = strlen(path) + strlen(all.name[i]) + 2;
        char *name = memory_take(size, 1);
        snprintf(name, size, "%s/%s", path, all.name[i]);
        array is = {.path = path};
        const int c = column_named(&is, all.name[i], strlen(all.name[i]) - 4);
        array *a = &t->file[t->files++];
        *a = array_open(name);
        if (a->columns || *a->field->name)
            fail_input("%s: a column must have one dimension, and no fields", name);
        if (t->files > 1 && a->rows != t->rows)
            fail_input("%s: %zu rows, and %s has %zu", name, a->rows, t->file[0].path, t->rows);
        t->rows = a->rows;
        set_column(t, c, a, a->field, 0);
    }
}

/* The columns of numbers from a row on (NULL: there is none), and how many rows are left.  In one array all
 * are as far apart, and so are those of a folder. */
typedef struct cells { const unsigned char *at[RAY_ID]; size_t apart, rows; } cells;

static cells cells_of(const ray_table *t, size_t first)
{
    cells r = {.apart = t->column[0].file->row_size, .rows = t->rows - first};
    for (int c = 0; c < RAY_ID; c++)
        if (t->column[c].file) r.at[c] = array_row(t->column[c].file, first) + t->column[c].offset;
    return r;
}

/* The number of a column in the i-th row, and its bits as a double. */
static inline double double_at(const cells *r, int c, size_t i, bool floats)
{
    const unsigned char *at = r->at[c] + i * r->apart;
    return floats ? array_float(at) : array_double(at);
}

static inline uint64_t bits_at(const cells *r, int c, size_t i, bool floats)
{
    const double x = floats ? array_float(r->at[c] + i * r->apart) : 0;
    uint64_t bits;
    if (!floats) return array_bits(r->at[c] + i * r->apart);
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Asks for a row some 3 KB behind the i-th: what foresees a stream by itself stops at the end of a page. */
#define FETCH(r, i) __builtin_prefetch(r.at[0] + (r.rows - i > 64 ? i + 64 : i) * r.apart)

/* Reads the columns of rows, whatever stands in them. */
static void read_columns(const ray_table *t, size_t first, size_t count, ray_block *to)
{
    const cells r = cells_of(t, first);
    for (size_t i = 0; i < count; i++) {
        FETCH(r, i);
        for (int c = 0; c < RAY_REQUIRED; c++) to->number[c][i] = double_at(&r, c, i, t->floats);
    }
    for (int c = RAY_TMIN; c <= RAY_TMAX && t->ended; c++)
        for (size_t i = 0; i < count; i++)
            to->number[c][i] = r.at[c] ? double_at(&r, c, i, t->floats) : c == RAY_TMIN ? 0 : HUGE_VAL;
    for (size_t i = 0; i < count; i++) to->ray[i] = (long long)(first + i);
    for (size_t i = 0; i < count && t->id; i++) to->id[i] = t->id + (first + i) * t->id_room;
    to->count = count, to->ended = t->ended;
    for (size_t f = 0; f < t->files; f++) array_leave(&t->file[f], first, count);
}

/* Leaves only the good ones.  Returns how many were bad; the first of them, and why. */
static size_t leave_good(ray_block *b, long long *first_bad, char first_why[RAY_WHY])
{
    const size_t all = b->count;
    size_t good = 0;
    for (size_t i = 0; i < all; i++) {
        sgt_ray unused;
        double value[8];
        char why[RAY_WHY];
        for (int c = 0; c < 8; c++) value[c] = b->number[c][i];
        if (!ray_of(value, b->ended, b->ended, &unused, why)) {
            if (i == good) *first_bad = b->ray[i], memcpy(first_why, why, RAY_WHY);
            continue;
        }
        for (int c = 0; c < 8; c++) b->number[c][good] = value[c];
        b->ray[good] = b->ray[i], b->id[good] = b->id[i];
        good++;
    }
    b->count = good;
    return all - good;
}

void ray_table_part(const ray_table *t, size_t first, size_t count, ray_block *to)
{
    long long first_bad;
    char why[RAY_WHY];
    read_columns(t, first, count, to);
    if (!t->bad && !t->share) return;
    if (leave_good(to, &first_bad, why) && !t->skip_bad)
        fail_input("%s: row %lld, counted from 0: %s", t->path, first_bad, why);
}

/* Is there a bad one among these rows?  By the bits of the exponents: all set, a number is not finite; none
 * set in dx, dy and dz, all three are below 2^-1022. */
static bool any_bad(const ray_table *t, size_t first, size_t count)
{
    static const uint64_t exponent = (uint64_t)0x7ff << 52, one = (uint64_t)1 << 52;
    const cells r = cells_of(t, first);
    uint64_t top = 0; /* its highest bit */
    for (size_t i = 0; i < count; i++) {
        uint64_t bits[RAY_REQUIRED];
        FETCH(r, i);
        for (int c = 0; c < RAY_REQUIRED; c++) bits[c] = bits_at(&r, c, i, t->floats) & exponent;
        for (int c = 0; c < RAY_REQUIRED; c++) top |= bits[c] + one;
        top |= (bits[3] | bits[4] | bits[5]) - one;
    }
    for (size_t i = 0; i < count && t->ended; i++) {
        double end[2] = {0, HUGE_VAL};
        for (int c = RAY_TMIN; c <= RAY_TMAX; c++)
            if (r.at[c]) end[c - RAY_TMIN] = double_at(&r, c, i, t->floats);
        if (!(end[0] <= end[1]) || end[0] > DBL_MAX || end[1] < -DBL_MAX) return true;
    }
    for (size_t f = 0; f < t->files; f++) array_leave(&t->file[f], first, count);
    return top >> 63;
}

/* Looks at every ray. */
static void check_rows(ray_table *t, bool skip_bad, int threads)
{
    enum { ROWS = 1 << 14 };
    bool any = false;
    (void)threads; /* unused without OpenMP */
    THREADS(omp parallel for reduction(|| : any) num_threads(threads > 1 ? threads : 1))
    for (size_t first = 0; first < t->rows; first += ROWS)
        any = any_bad(t, first, t->rows - first < ROWS ? t->rows - first : ROWS) || any;
    if (!any) return;
    long long first_bad = 0;
    char first_why[RAY_WHY];
    ray_block *b = memory_take(1, sizeof *b);
    for (size_t first = 0; first < t->rows; first += TILE_RAYS) {
        long long bad_row;
        char why[RAY_WHY];
        read_columns(t, first, t->rows - first < TILE_RAYS ? t->rows - first : TILE_RAYS, b);
        const size_t bad = leave_good(b, &bad_row, why);
        if (bad && !skip_bad) fail_input("%s: row %lld, counted from 0: %s", t->path, bad_row, why);
        if (bad && !t->bad) first_bad = bad_row, memcpy(first_why, why, RAY_WHY);
        t->bad += bad;
    }
    note("%s: %zu bad row%s skipped, the first is row %lld, counted from 0: %s", t->path, t->bad,
         t->bad == 1 ? "" : "s", first_bad, first_why);
}

static void read_ids(ray_table *t, ray_list *list)
{
    enum { INTEGER_ROOM = 24 };
    const ray_column *c = &t->column[RAY_ID];
    const bool text = c->field->type[1] == 'S';
    t->id_room = text ? c->field->size + 1 : INTEGER_ROOM;
    t->id = memory_take(t->rows, t->id_room);
    for (size_t i = 0; i < t->rows; i++) {
        char *to = t->id + i * t->id_room;
        const unsigned char *from = array_row(c->file, i) + c->offset;
        if (text) memcpy(to, from, c->field->size);
        else snprintf(to, INTEGER_ROOM, "%lld", array_integer(from, c->field->size));
        const size_t length = strlen(to);
        if (length > list->longest_id) list->longest_id = length;
    }
    list->named = true;
}

void ray_table_open(ray_list *list, const char *path, bool skip_bad)
{
    ray_table *t = memory_take(1, sizeof *t);
    t->path = path;
    if (is_folder(path)) open_folder(t, path);
    else open_file(t, path);
    for (int c = 0; c < RAY_REQUIRED; c++)
        if (!t->column[c].file)
            fail_input("%s: %s: this column is missing; ox, oy, oz, dx, dy, dz are needed", path,
                       ray_column_name[c]);
    if (!t->rows) fail_input("%s: no rays: the array is empty", path);
    t->ended = list->ended = t->column[RAY_TMIN].file || t->column[RAY_TMAX].file;
    t->share = list->some, t->skip_bad = skip_bad;
    if (!t->share) check_rows(t, skip_bad, list->threads);
    if (t->column[RAY_ID].file && !t->share) read_ids(t, list);
    list->table = t, list->count = t->rows;
}
