// SPDX-License-Identifier: MIT
/* matrix.c - reads a table of numbers from a file.
 *
 * CSV: each line is a row of numbers with commas between them.  Allowed are blanks around a
 * number, CR LF or LF, a byte order mark, a last line without an end, and empty lines at the end
 * of the file.  There are no headers, comments or quotes: a field that is not a finite number is
 * an error, and so is an empty one.
 *
 * NPY, format 1.0 to 3.0 of NumPy: "\x93NUMPY", the version in two bytes, the length of the
 * header in 2 bytes (1.0) or 4, the header (a Python dictionary as text), then the numbers, row
 * by row or, in Fortran order, column by column.  Two dimensions of '<f8' or '<f4' are read.
 * Source: NumPy's enhancement proposal 1 and numpy.lib.format. */
#include "matrix.h"

#include "../../text/number.h"
#include "../base/reader.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct table_file { const char *name; char *text; size_t length; } table_file;

static bool is_npy(const char *name) { return sgt_reader_ends_in(name, ".npy"); }

bool sgt_matrix_is_file(const char *name) { return sgt_reader_ends_in(name, ".csv") || is_npy(name); }

SGT_PRINTF(2, 3) static bool bad(char why[MATRIX_WHY_SIZE], const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(why, MATRIX_WHY_SIZE, format, values);
    va_end(values);
    return false;
}

/* -------------------------------------------------------------------- csv */

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Reads the number in [s, end); writes a zero byte at its end. */
static bool read_field(char *s, char *end, size_t line, size_t column, const char *name, double *x,
                       char why[MATRIX_WHY_SIZE])
{
    while (s < end && is_blank(*s)) s++;
    while (end > s && is_blank(end[-1])) end--;
    *end = 0;
    if (s == end)
        return bad(why, "%s:%zu: column %zu: empty; every field needs a number", name, line, column);
    if (strlen(s) != (size_t)(end - s))
        return bad(why, "%s:%zu: column %zu: a zero byte", name, line, column);
    if (!number_read(s, x)) {
        const char *hint = strpbrk(s, " \t;")         ? "; put commas between numbers"
                           : line == 1 && column == 1 ? "; the file must have no header row"
                                                      : "";
        return bad(why, "%s:%zu: column %zu: \"%.60s\" is not a number%s", name, line, column, s, hint);
    }
    if (!isfinite(*x))
        return bad(why, "%s:%zu: column %zu: %.60s; every number must be finite", name, line, column, s);
    return true;
}

static bool read_csv(source *of, sgt_numbers *to, const table_file *in, size_t most,
                     char why[MATRIX_WHY_SIZE])
{
    char *s = in->text, *last = in->text + in->length;
    if (in->length >= 3 && memcmp(s, "\xef\xbb\xbf", 3) == 0) s += 3;
    while (last > s && (is_blank(last[-1]) || last[-1] == '\n')) last--;
    if (s == last) return bad(why, "%s: empty", in->name);
    double *x = NULL;
    size_t rows = 0, columns = 0, count = 0, room = 0;
    for (bool more = true; more; rows++) {
        char *stop = memchr(s, '\n', (size_t)(last - s));
        more = stop != NULL;
        if (!stop) stop = last;
        if (rows == most) return bad(why, "%s:%zu: more than %zu rows", in->name, rows + 1, most);
        size_t column = 0;
        for (bool within = true; within; column++) {
            char *comma = memchr(s, ',', (size_t)(stop - s));
            within = comma != NULL;
            if (column == most) return bad(why, "%s:%zu: more than %zu columns", in->name, rows + 1, most);
            x = tree_grow(of, x, count, &room, sizeof *x);
            if (!read_field(s, within ? comma : stop, rows + 1, column + 1, in->name, &x[count], why))
                return false;
            count++;
            s = (within ? comma : stop) + 1;
        }
        if (rows == 0) columns = column;
        if (column != columns)
            return bad(why, "%s:%zu: %zu number%s, but the rows above have %zu", in->name, rows + 1, column,
                       column == 1 ? "" : "s", columns);
    }
    *to = (sgt_numbers){x, rows, columns};
    return true;
}

/* -------------------------------------------------------------------- npy */

/* The text behind a key of the header and its colon; NULL: there is no such key. */
static const char *header_value(const char *header, const char *key)
{
    const char *s = strstr(header, key);
    if (!s) return NULL;
    s += strlen(key);
    s += strspn(s, " ");
    if (*s != ':') return NULL;
    return s + 1 + strspn(s + 1, " ");
}

/* Reads a whole number; returns what stands behind it, or NULL if there is none or it has over 12 digits. */
static const char *read_whole(const char *s, size_t *n)
{
    const char *first = s;
    for (*n = 0; *s >= '0' && *s <= '9' && s - first < 12; s++) *n = 10 * *n + (size_t)(*s - '0');
    return s == first || (*s >= '0' && *s <= '9') ? NULL : s + strspn(s, " ");
}

typedef struct npy { size_t rows, columns, size; bool fortran; } npy;

static bool matrix_read_header(npy *n, const char *header, const char *name, char why[MATRIX_WHY_SIZE])
{
    const char *type = header_value(header, "'descr'"), *order = header_value(header, "'fortran_order'"),
               *s = header_value(header, "'shape'");
    if (!type || !order || !s) return bad(why, "%s: no header of an npy file", name);
    n->size = strncmp(type, "'<f8'", 5) == 0 ? 8 : strncmp(type, "'<f4'", 5) == 0 ? 4 : 0;
    if (n->size == 0) {
        const char *behind = strpbrk(type, ",}");
        return bad(why, "%s: numbers of the type %.*s; only '<f8' and '<f4' can be read", name,
                   behind ? (int)(behind - type) % 60 : 0, type);
    }
    n->fortran = strncmp(order, "True", 4) == 0;
    if (!n->fortran && strncmp(order, "False", 5) != 0) return bad(why, "%s: no header of an npy file", name);
    s = *s == '(' ? read_whole(s + 1, &n->rows) : NULL;
    s = s && *s == ',' ? read_whole(s + 1 + strspn(s + 1, " "), &n->columns) : NULL;
    if (!s || *s != ')') return bad(why, "%s: the shape must have two dimensions, rows and columns", name);
    return true;
}

static double number_at(const unsigned char *at, size_t size)
{
    uint64_t bits = 0;
    for (size_t i = size; i-- > 0;) bits = bits << 8 | at[i];
    if (size == 8) {
        double x;
        memcpy(&x, &bits, sizeof x);
        return x;
    }
    uint32_t half = (uint32_t)bits;
    float x;
    memcpy(&x, &half, sizeof x);
    return (double)x;
}

static bool read_npy(source *of, sgt_numbers *to, const table_file *in, size_t most,
                     char why[MATRIX_WHY_SIZE])
{
    const unsigned char *text = (const unsigned char *)in->text;
    if (in->length < 10 || memcmp(text, "\x93NUMPY", 6) != 0)
        return bad(why, "%s: not an npy file", in->name);
    if (text[6] < 1 || text[6] > 3)
        return bad(why, "%s: version %d of the npy format; only 1 to 3 can be read", in->name, text[6]);
    size_t start = text[6] == 1 ? 10 : 12, header = text[8] | (size_t)text[9] << 8;
    if (start == 12 && in->length >= 12) header |= (size_t)text[10] << 16 | (size_t)text[11] << 24;
    if (in->length < start || in->length - start < header)
        return bad(why, "%s: cut off within its header", in->name);
    npy n = {.size = 0};
    if (!matrix_read_header(&n, tree_text(of, in->text + start, header), in->name, why)) return false;
    if (n.rows == 0 || n.columns == 0) return bad(why, "%s: empty", in->name);
    if (n.rows > most || n.columns > most)
        return bad(why, "%s: %zu rows and %zu columns; at most %zu of either are allowed", in->name, n.rows,
                   n.columns, most);
    size_t count = n.rows * n.columns, have = in->length - start - header;
    if (have < count * n.size)
        return bad(why, "%s: cut off: %zu numbers, but the header says %zu", in->name, have / n.size, count);
    if (have > count * n.size)
        return bad(why, "%s: %zu bytes behind the last number", in->name, have - count * n.size);
    double *x = tree_room(of, count, sizeof *x);
    const unsigned char *at = text + start + header;
    for (size_t i = 0; i < count; i++, at += n.size) {
        size_t row = n.fortran ? i % n.rows : i / n.columns, column = n.fortran ? i / n.rows : i % n.columns;
        double value = x[row * n.columns + column] = number_at(at, n.size);
        if (!isfinite(value))
            return bad(why, "%s: row %zu, column %zu: %g; every number must be finite", in->name, row + 1,
                       column + 1, value);
    }
    *to = (sgt_numbers){x, n.rows, n.columns};
    return true;
}

bool sgt_matrix_read(source *of, sgt_numbers *to, const char *path, size_t most, char why[MATRIX_WHY_SIZE])
{
    table_file in = {.name = path};
    const char *fault = tree_file(of, path, &in.text, &in.length);
    if (fault) return bad(why, "%s: %s", path, fault);
    return is_npy(path) ? read_npy(of, to, &in, most, why) : read_csv(of, to, &in, most, why);
}
