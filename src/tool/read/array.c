// SPDX-License-Identifier: MIT
/* array.c - reads the npy format, versions 1 to 3 (NEP 1).
 *
 * The header is a Python dictionary with three keys: descr, a type or a list of ('name', 'type');
 * fortran_order; and shape.  Here it is read as what NumPy writes, strictly: what is not understood is an
 * error.  A file is mapped, so memory does not hold its rows; what comes through a pipe is kept whole. */
#include "array.h"

#include "../base/fail.h"
#include "../base/input.h"
#include "../base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct header_text { const char *path, *at; } header_text;

_Noreturn static void fail_header(const header_text *w, const char *what)
{
    fail_input("%s: %s, at \"%.20s\" of its header", w->path, what, w->at);
}

/* Skips blanks, and a sign if it is there. */
static bool take(header_text *w, char sign)
{
    w->at += strspn(w->at, " \n");
    if (*w->at != sign) return false;
    w->at++;
    w->at += strspn(w->at, " \n");
    return true;
}

static void expect(header_text *w, char sign)
{
    char what[] = "? expected";
    what[0] = sign;
    if (!take(w, sign)) fail_header(w, what);
}

/* A text in quotes, shorter than size. */
static void take_text(header_text *w, char *to, size_t size)
{
    const char quote = *w->at;
    const size_t length = quote == '\'' || quote == '"' ? strcspn(w->at + 1, "'\"\\") : 0;
    if ((quote != '\'' && quote != '"') || w->at[length + 1] != quote) fail_header(w, "a text expected");
    if (length >= size) fail_header(w, "a text too long");
    memcpy(to, w->at + 1, length);
    to[length] = 0;
    w->at += length + 2;
}

static size_t take_whole(header_text *w)
{
    size_t n = 0;
    const char *first = w->at;
    for (; *w->at >= '0' && *w->at <= '9' && w->at - first < 16; w->at++) n = 10 * n + (size_t)(*w->at - '0');
    if (w->at == first || (*w->at >= '0' && *w->at <= '9')) fail_header(w, "a whole number expected");
    return n;
}

/* '<f8': the bytes are the digits behind the letter. */
static void take_type(header_text *w, array *a)
{
    array_field *f = &a->field[a->fields++];
    take_text(w, f->type, sizeof f->type);
    header_text digits = {w->path, f->type + (*f->type ? 1 + (f->type[1] != 0) : 0)};
    f->size = take_whole(&digits);
    if (*digits.at || !strchr("<>|=", *f->type)) fail_header(&digits, "a type expected");
    f->offset = a->row_size;
    if (f->type[1] == 'U') f->size *= 4;
    a->row_size += f->size;
}

static void take_structure(header_text *w, array *a)
{
    size_t capacity = 0;
    expect(w, '[');
    while (!take(w, ']')) {
        a->field = memory_room(a->field, a->fields, &capacity, sizeof *a->field);
        a->field[a->fields] = (array_field){.size = 0};
        expect(w, '(');
        take_text(w, a->field[a->fields].name, sizeof a->field->name);
        expect(w, ',');
        take_type(w, a);
        if (take(w, ',') && *w->at != ')') fail_header(w, "a field that is itself an array");
        expect(w, ')');
        take(w, ',');
    }
}

/* (N,) or (N, M) */
static void take_shape(header_text *w, array *a)
{
    expect(w, '(');
    a->rows = take_whole(w);
    expect(w, ',');
    if (take(w, ')')) return;
    a->columns = take_whole(w);
    take(w, ',');
    expect(w, ')');
    if (!a->columns) fail_header(w, "no columns");
}

static void read_dictionary(array *a, const char *text)
{
    header_text w = {a->path, text};
    enum { DESCR = 1, ORDER = 2, SHAPE = 4 };
    int seen = 0;
    expect(&w, '{');
    while (!take(&w, '}')) {
        char key[24];
        take_text(&w, key, sizeof key);
        expect(&w, ':');
        const int now = strcmp(key, "descr") == 0 ? DESCR : strcmp(key, "fortran_order") == 0 ? ORDER
                      : strcmp(key, "shape") == 0 ? SHAPE : 0;
        if (!now || (seen & now)) fail_header(&w, "an unknown key, or one given twice, in front of it");
        seen |= now;
        if (now == SHAPE) {
            take_shape(&w, a);
        } else if (now == ORDER) {
            if (strncmp(w.at, "False", 5) != 0) fail_header(&w, "not in C order, row by row");
            w.at += 5;
        } else if (*w.at == '[') {
            take_structure(&w, a);
        } else {
            a->field = memory_take(1, sizeof *a->field);
            take_type(&w, a);
        }
        take(&w, ',');
    }
    if (*w.at || seen != (DESCR | ORDER | SHAPE)) fail_header(&w, "descr, fortran_order and shape expected");
    if (a->columns && (a->fields != 1 || *a->field->name))
        fail_header(&w, "a structured array of two dimensions");
    if (a->columns) a->row_size *= a->columns;
    if (!a->row_size) fail_header(&w, "rows without a byte");
}

/* Is the file as long as its header says? */
static void check_length(const array *a, size_t have)
{
    if (have / a->row_size < a->rows)
        fail_input("%s: cut off: %zu rows, but the header says %zu", a->path, have / a->row_size, a->rows);
    if (have != a->rows * a->row_size)
        fail_input("%s: %zu bytes behind the last row", a->path, have - a->rows * a->row_size);
}

/* Parts of a run are of the same rays: by the length of the file, and by its bytes.  Of one that is longer
 * than WHOLE, by SOME bytes in each of PLACES, evenly spread from its beginning to its end: a shard reads no
 * more than its rows. */
static void note_rays(const input *in)
{
    enum { WHOLE = 1 << 20, PLACES = 64, SOME = 1 << 12 };
    input_note(&in->length, sizeof in->length);
    if (in->length <= WHOLE) input_note(in->text, in->length);
    else
        for (size_t i = 0, rest = in->length - SOME, last = PLACES - 1; i < PLACES; i++)
            input_note(in->text + rest / last * i + rest % last * i / last, SOME);
}

array array_open(const char *path)
{
    enum { HEADER_MOST = 1 << 20, START = 10, START_LATER = 12 };
    bool mapped;
    const input in = input_map(path, &mapped);
    const unsigned char *all = (const unsigned char *)in.text;
    if (in.length < START || memcmp(all, "\x93NUMPY", 6) != 0) fail_input("%s: not an npy file", path);
    if (all[6] < 1 || all[6] > 3)
        fail_input("%s: version %d of the npy format; only 1 to 3 can be read", path, all[6]);
    const size_t start = all[6] > 1 ? START_LATER : START;
    if (in.length < start) fail_input("%s: cut off within its header", path);
    const size_t high = all[6] > 1 ? all[10] | (size_t)all[11] << 8 : 0;
    const size_t length = high << 16 | (size_t)all[9] << 8 | all[8];
    if (length > HEADER_MOST) fail_input("%s: a header of %zu bytes", path, length);
    if (in.length - start < length) fail_input("%s: cut off within its header", path);
    array a = {.path = path, .row = all + start + length, .mapped = mapped,
               .left = memory_take(1, sizeof(size_t))};
    read_dictionary(&a, memory_text(in.text + start, length));
    check_length(&a, in.length - start - length);
    note_rays(&in);
    return a;
}

void array_leave(const array *a, size_t first, size_t count)
{
    enum { WINDOW = 1 << 24 }; /* is left at once: each time costs as much as some thousand rows */
    const size_t end = (first + count) * a->row_size / WINDOW, begin = first * a->row_size / WINDOW;
    size_t left = __atomic_load_n(a->left, __ATOMIC_RELAXED); /* others may have read what lies between */
    if (begin + 1 < left) left = begin; /* it is read once more */
    if (!a->mapped || end <= left) return;
    input_leave(a->row + left * WINDOW, (end - left) * WINDOW);
    __atomic_store_n(a->left, end, __ATOMIC_RELAXED);
}

long long array_integer(const unsigned char *at, size_t size)
{
    uint64_t bits = at[size - 1] & 128 ? ~(uint64_t)0 : 0;
    for (size_t i = size; i-- > 0;) bits = bits << 8 | at[i];
    long long n;
    memcpy(&n, &bits, sizeof n);
    return n;
}
