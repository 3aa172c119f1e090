/* table.c - text, csv and json from one stream of cells.
 *
 * Rows are kept as bytes until they are written.  For csv and json these are the bytes of the
 * file.  For text they are a mark for each row or gap, followed by the row's cells, each with a
 * zero byte at its end. */
#include "table.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../../text/number.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char TABLE_ROW = 'r', GAP = 'g';
enum {
    SPACE_BETWEEN = 2,
    WRITE_AT = 1 << 16   /* csv and json are written when so many bytes are kept */
};

/* Numbers are aligned at their decimal points: the characters before the point, and those from
 * it on.  A number without a point ends where the point would be. */
typedef struct width { size_t before, after; } width;

struct table {
    table_target to;
    FILE *file;                 /* NULL: a part of another table */
    size_t columns, cells;      /* cells so far, of all rows */
    const column *column;
    char *kept;                 /* what is not yet written */
    size_t length, capacity;
    width *width;               /* [columns], of the text that is kept */
    bool block_written;
};

static void write_kept(table *t)
{
    fwrite(t->kept, 1, t->length, t->file);
    t->length = 0;
}

/* Makes room for `more` bytes; returns where they go. */
static char *table_room(table *t, size_t more)
{
    if (t->capacity - t->length < more) {
        t->capacity = 2 * t->capacity + more;
        t->kept = memory_grow(t->kept, t->capacity, 1);
    }
    return t->kept + t->length;
}

static void table_put(table *t, const char *text, size_t length)
{
    memcpy(table_room(t, length), text, length);
    t->length += length;
}

static void put_text(table *t, const char *text) { table_put(t, text, strlen(text)); }

static void put_byte(table *t, char c) { table_put(t, &c, 1); }

static table *table_new(const table_target *target, size_t columns, const column *head)
{
    table *t = memory_take(1, sizeof *t);
    *t = (table){
        .to = *target, .columns = columns, .column = head, .width = memory_take(columns, sizeof *t->width)};
    return t;
}

table *table_begin(const table_target *target, size_t columns, const column *head)
{
    table *t = table_new(target, columns, head);
    t->file = stdout;
    if (t->to.path) output_check("output", t->to.path);
    if (t->to.path && !(t->file = fopen(t->to.path, "w")))
        fail_input("--output %s: %s", t->to.path, strerror(errno));
    if (t->to.format == TABLE_JSON) put_byte(t, '[');
    for (size_t i = 0; i < columns && t->to.format == TABLE_CSV; i++) {
        put_text(t, head[i].name);
        put_byte(t, i + 1 < columns ? ',' : '\n');
    }
    return t;
}

/* ------------------------------------------------------------ csv and json */

static void put_json_string(table *t, const char *text)
{
    char code[8];
    put_byte(t, '"');
    for (const char *c = text; *c; c++) {
        if ((unsigned char)*c < 32) {
            snprintf(code, sizeof code, "\\u%04x", (unsigned)*c);
            put_text(t, code);
            continue;
        }
        if (*c == '"' || *c == '\\') put_byte(t, '\\');
        put_byte(t, *c);
    }
    put_byte(t, '"');
}

static void put_csv_field(table *t, const char *text)
{
    size_t plain = strcspn(text, ",\"\r\n");
    if (!text[plain]) {
        table_put(t, text, plain);
        return;
    }
    put_byte(t, '"');
    for (const char *c = text; *c; c++) {
        if (*c == '"') put_byte(t, '"');
        put_byte(t, *c);
    }
    put_byte(t, '"');
}

/* A part does not know whether its first row is the first of the table, so it begins with a comma; table_join
 * leaves it out if it is. */
static void cell_begin(table *t)
{
    if (t->to.format != TABLE_JSON) return;
    size_t i = t->cells % t->columns;
    put_text(t, i ? ", \"" : t->cells == 0 && t->file ? "\n{\"" : ",\n{\"");
    put_text(t, t->column[i].name);
    table_put(t, "\": ", 3);
}

static void cell_end(table *t)
{
    bool last = ++t->cells % t->columns == 0;
    if (t->to.format == TABLE_CSV) put_byte(t, last ? '\n' : ',');
    else if (last) put_byte(t, '}');
    if (last && t->file && t->length >= WRITE_AT) write_kept(t);
}

/* ------------------------------------------------------------------- text */

static width table_width_of(const char *cell, size_t length, column_kind kind)
{
    size_t before = kind == COLUMN_NUMBER || kind == COLUMN_EXACT ? strcspn(cell, ".e") : length;
    return (width){before, length - before};
}

static void widen(width *w, width by)
{
    if (by.before > w->before) w->before = by.before;
    if (by.after > w->after) w->after = by.after;
}

static void keep_cell(table *t, const char *text, size_t length)
{
    size_t i = t->cells++ % t->columns;
    if (i == 0) put_byte(t, TABLE_ROW);
    table_put(t, text, length + 1);
    widen(&t->width[i], table_width_of(text, length, t->column[i].kind));
}

static char *fill(char *to, size_t count) { return memset(to, ' ', count), to + count; }

/* Writes a row; cell: its cells, one behind another.  Returns where they end. */
static const char *table_write_row(const table *t, const char *cell, char *line, bool header)
{
    char *to = line;
    for (size_t i = 0; i < t->columns; i++) {
        column_kind kind = t->column[i].kind;
        bool words = kind == COLUMN_WORD;
        if (header) cell = t->column[i].name;
        const width *w = &t->width[i];
        size_t length = strlen(cell);
        width own = header ? (width){length, 0} : table_width_of(cell, length, kind);
        size_t all = w->before + w->after;
        size_t left = words ? 0 : header ? all - own.before : w->before - own.before;
        size_t right = i + 1 < t->columns ? all - left - length : 0;
        if (i) to = fill(to, SPACE_BETWEEN);
        to = fill(to, left);
        memcpy(to, cell, length);
        to = fill(to + length, right);
        cell += length + 1;
    }
    *to++ = '\n';
    fwrite(line, 1, (size_t)(to - line), t->file);
    return cell;
}

static void write_block(table *t)
{
    size_t longest = 1;
    for (size_t c = 0; c < t->columns; c++) {
        width *w = &t->width[c];
        size_t length = strlen(t->column[c].name), all = w->before + w->after;
        if (length > all) w->before += length - all;
        longest += w->before + w->after + SPACE_BETWEEN;
    }
    char *line = memory_grow(NULL, longest, 1);
    if (t->block_written) fputc('\n', t->file);
    table_write_row(t, NULL, line, true);
    for (const char *at = t->kept, *end = at + t->length; at < end;) {
        if (*at++ == TABLE_ROW) at = table_write_row(t, at, line, false);
        else if (at < end) fputc('\n', t->file);
    }
    t->length = 0;
    memset(t->width, 0, t->columns * sizeof *t->width);
    t->block_written = true;
}

/* ------------------------------------------------------------------ cells */

/* bare: csv and json may have it as it is. */
static void put_cell(table *t, const char *text, size_t length, bool bare)
{
    if (t->to.format == TABLE_TEXT) {
        keep_cell(t, text, length);
        return;
    }
    cell_begin(t);
    if (bare) table_put(t, text, length);
    else if (t->to.format == TABLE_CSV) put_csv_field(t, text);
    else put_json_string(t, text);
    cell_end(t);
}

void table_number(table *t, double value)
{
    char text[NUMBER_SIZE];
    column_kind kind = t->column[t->cells % t->columns].kind;
    int length;
    if (t->to.format == TABLE_TEXT && ((!t->to.hexadecimal && kind != COLUMN_EXACT) || isnan(value)))
        length = number_print_short(text, value, kind == COLUMN_ERROR ? 2 : 9);
    else if (t->to.format == TABLE_JSON && isnan(value))
        length = snprintf(text, sizeof text, "null");
    else
        length = number_print(text, value, t->to.hexadecimal);
    put_cell(t, text, (size_t)length,
             t->to.format == TABLE_CSV || isnan(value) || (isfinite(value) && !t->to.hexadecimal));
}

/* The bound is for the double, and the printed decimal may be half an ulp beside it.  So the bound is raised
 * to hold for the decimal too, and rounded up to three digits. */
void table_number_within(table *t, double value, double error)
{
    char text[NUMBER_SIZE];
    double gap;
    table_number(t, value);
    if (t->to.format != TABLE_TEXT && !t->to.hexadecimal && error > 0)
        number_print_with_gap(text, value, &gap), error = number_round_up(error + gap);
    table_number(t, error);
}

void table_count(table *t, long long value)
{
    char text[NUMBER_SIZE];
    int length = number_print_count(text, value);
    put_cell(t, text, (size_t)length, true);
}

void table_word(table *t, const char *text) { put_cell(t, text, strlen(text), false); }

void table_empty(table *t)
{
    const char *text = t->to.format == TABLE_TEXT ? "-" : t->to.format == TABLE_JSON ? "null" : "";
    put_cell(t, text, strlen(text), true);
}

void table_gap(table *t)
{
    if (t->to.format == TABLE_TEXT) put_byte(t, GAP);
}

void table_line(table *t, const char *format, ...)
{
    if (t->to.format != TABLE_TEXT) return;
    if (t->length) write_block(t), fputc('\n', t->file);
    va_list values;
    va_start(values, format);
    vfprintf(t->file, format, values);
    va_end(values);
    fputc('\n', t->file);
    t->block_written = true;
}

/* ------------------------------------------------------------------ parts */

table *table_part(const table *t) { return table_new(&t->to, t->columns, t->column); }

void table_join(table *t, table *part)
{
    if (part->length == 0) return;
    size_t comma = t->to.format == TABLE_JSON && t->cells == 0;
    table_put(t, part->kept + comma, part->length - comma);
    for (size_t c = 0; c < t->columns; c++) widen(&t->width[c], part->width[c]);
    if (t->to.format != TABLE_TEXT && t->length >= WRITE_AT) write_kept(t);
    t->cells += part->cells;
    part->cells = part->length = 0;
    memset(part->width, 0, part->columns * sizeof *part->width);
}

void table_end(table *t)
{
    if (t->to.format == TABLE_TEXT && t->length) write_block(t);
    if (t->to.format == TABLE_JSON) put_text(t, t->cells ? "\n]\n" : "]\n");
    if (t->to.format != TABLE_TEXT) write_kept(t);
    bool bad = fflush(t->file) != 0 || ferror(t->file);
    if (t->file != stdout) bad = fclose(t->file) != 0 || bad;
    if (bad)
        fail_input("%s%s: could not be written", t->to.path ? "--output " : "",
                   t->to.path ? t->to.path : "standard output");
}
