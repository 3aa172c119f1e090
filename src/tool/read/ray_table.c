/* ray_table.c - rays from arrays of NumPy: one structured array, or one of N x 6 numbers, or a folder with an
 * array for each column.
 *
 * The columns have the names of those of csv, and the numbers are doubles, '<f8'.  All rays are looked at
 * before the first is traced, so that a bad one is told before anything is written.  Then they are read
 * again, some at a time; only ids are kept. */
#include "ray_table.h"

#include "../base/fail.h"
#include "../base/memory.h"
#include "array.h"

#include <dirent.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

/* Where a column is; file NULL: there is none. */
typedef struct ray_column { const array *file; size_t offset; const array_field *field; } ray_column;

struct ray_table {
    const char *path;
    size_t rows, files, bad; /* bad: how many of the rows are */
    array file[RAY_COLUMNS];
    ray_column column[RAY_COLUMNS];
    char *id;          /* [rows], each of id_room bytes */
    size_t id_room;
};

enum { PART_BYTES = 1 << 16, ROW_MOST = 512 }; /* read at once; of a row */

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
    if (c < RAY_ID && strcmp(type, "<f8") != 0)
        fail_input("%s: %s: of the type '%s'; only '<f8' can be read, float64 with the lower byte first",
                   file->path, name, type);
    if (c == RAY_ID && !integer && (type[0] != '|' || type[1] != 'S'))
        fail_input("%s: id: of the type '%s'; only bytes, '|S', and integers, '<i4' and '<i8', can be read",
                   file->path, type);
    t->column[c] = (ray_column){file, offset, field};
}

static int column_named(const array *file, const char *name, size_t length)
{
    for (int c = 0; c < RAY_COLUMNS; c++)
        if (strncmp(ray_column_name[c], name, length) == 0 && !ray_column_name[c][length]) return c;
    fail_input("%s: %.*s: unknown column; known columns: ox, oy, oz, dx, dy, dz, tmin, tmax, id",
               file ? file->path : "--rays", (int)length, name);
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

/* Reads the columns of rows, whatever stands in them. */
static void read_columns(const ray_table *t, size_t first, size_t count, ray_block *to)
{
    unsigned char room[PART_BYTES];
    for (size_t f = 0; f < t->files; f++) {
        const array *a = &t->file[f];
        const size_t size = a->row_size, most = PART_BYTES / size;
        for (size_t done = 0, part; done < count; done += part) {
            part = count - done < most ? count - done : most;
            array_read(a, first + done, part, room);
            for (int c = 0; c < RAY_ID; c++) {
                double *number = to->number[c] + done;
                const unsigned char *from = room + t->column[c].offset;
                for (size_t i = 0; i < part && t->column[c].file == a; i++)
                    number[i] = array_double(from + i * size);
            }
        }
    }
    for (size_t i = 0; i < count; i++) to->ray[i] = (long long)(first + i);
    for (size_t i = 0; i < count && !t->column[RAY_TMIN].file; i++) to->number[RAY_TMIN][i] = 0;
    for (size_t i = 0; i < count && !t->column[RAY_TMAX].file; i++) to->number[RAY_TMAX][i] = HUGE_VAL;
    for (size_t i = 0; i < count && t->id; i++) to->id[i] = t->id + (first + i) * t->id_room;
    to->count = count;
}

/* Is there a bad one among them?  In sums of truth values, so that compilers make lanes of the loops. */
static bool any_bad(const ray_block *b)
{
    int bad = 0;
    for (int c = 0; c < RAY_TMIN; c++)
        for (size_t i = 0; i < b->count; i++) bad |= !(fabs(b->number[c][i]) <= DBL_MAX);
    const double *x = b->number[3], *y = b->number[4], *z = b->number[5];
    for (size_t i = 0; i < b->count; i++)
        bad |= (fabs(x[i]) < DBL_MIN) & (fabs(y[i]) < DBL_MIN) & (fabs(z[i]) < DBL_MIN);
    const double *lo = b->number[RAY_TMIN], *hi = b->number[RAY_TMAX];
    for (size_t i = 0; i < b->count; i++) bad |= !(lo[i] <= hi[i]) | (lo[i] > DBL_MAX) | (hi[i] < -DBL_MAX);
    return bad;
}

/* Leaves only the good ones.  Returns how many were bad; the first of them, and why. */
static size_t leave_good(ray_block *b, long long *first_bad, char first_why[RAY_WHY])
{
    const size_t all = b->count;
    size_t good = 0;
    if (!any_bad(b)) return 0;
    for (size_t i = 0; i < all; i++) {
        sgt_ray unused;
        double value[8];
        char why[RAY_WHY];
        for (int c = 0; c < 8; c++) value[c] = b->number[c][i];
        if (!ray_of(value, true, true, &unused, why)) {
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
    if (t->bad) leave_good(to, &first_bad, why);
}

/* Looks at every ray. */
static void check_rows(ray_table *t, bool skip_bad)
{
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
    if (t->bad)
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
    unsigned char *row = memory_take(1, c->file->row_size);
    for (size_t i = 0; i < t->rows; i++) {
        char *to = t->id + i * t->id_room;
        array_read(c->file, i, 1, row);
        if (text) memcpy(to, row + c->offset, c->field->size);
        else snprintf(to, INTEGER_ROOM, "%lld", array_integer(row + c->offset, c->field->size));
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
    for (size_t f = 0; f < t->files; f++)
        if (t->file[f].row_size > ROW_MOST) fail_input("%s: a row has more than %d bytes", path, ROW_MOST);
    if (!t->rows) fail_input("%s: no rays: the array is empty", path);
    check_rows(t, skip_bad);
    if (t->column[RAY_ID].file) read_ids(t, list);
    list->ended = t->column[RAY_TMIN].file || t->column[RAY_TMAX].file;
    list->table = t, list->count = t->rows;
}
