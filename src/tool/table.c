/* table.c - text, csv and json from one stream of cells. */
#include "table.h"

#include "input.h"
#include "memory.h"
#include "number.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char SPACE_BETWEEN[] = "  ";

struct table {
    table_target to;
    FILE *file;
    size_t columns, cells;      /* cells so far, of all rows */
    const column *column;
    const char **kept;          /* the cells of the text block that is not yet written; NULL: a gap */
    size_t kept_count, kept_capacity;
    bool block_written;
};

table *table_begin(const table_target *target, size_t columns, const column *head)
{
    table *t = memory_take(1, sizeof *t);
    *t = (table){.to = *target, .file = stdout, .columns = columns, .column = head};
    if (t->to.path) output_check("output", t->to.path);
    if (t->to.path && !(t->file = fopen(t->to.path, "w"))) fail_input("%s: %s", t->to.path, strerror(errno));
    if (t->to.format == TABLE_JSON) fputs("[", t->file);
    for (size_t i = 0; i < columns && t->to.format == TABLE_CSV; i++)
        fprintf(t->file, "%s%s", head[i].name, i + 1 < columns ? "," : "\n");
    return t;
}

/* ------------------------------------------------------------ csv and json */

static void write_json_string(FILE *file, const char *text)
{
    fputc('"', file);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\') fprintf(file, "\\%c", *c);
        else if ((unsigned char)*c < 32) fprintf(file, "\\u%04x", (unsigned)*c);
        else fputc(*c, file);
    }
    fputc('"', file);
}

static void write_csv_field(FILE *file, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (const char *c = text; *c; c++) fprintf(file, "%s%c", *c == '"' ? "\"" : "", *c);
    fputc('"', file);
}

/* bare: json may have it without quotes. */
static void write_cell(table *t, const char *text, bool bare)
{
    size_t i = t->cells++ % t->columns;
    if (t->to.format == TABLE_CSV) {
        write_csv_field(t->file, text);
        fputc(i + 1 < t->columns ? ',' : '\n', t->file);
        return;
    }
    fprintf(t->file, "%s\"%s\": ", i ? ", " : t->cells == 1 ? "\n{" : ",\n{", t->column[i].name);
    if (bare) fputs(text, t->file);
    else write_json_string(t->file, text);
    if (i + 1 == t->columns) fputc('}', t->file);
}

/* ------------------------------------------------------------------- text */

static void keep(table *t, const char *text)
{
    t->kept = memory_room(t->kept, t->kept_count, &t->kept_capacity, sizeof *t->kept);
    t->kept[t->kept_count++] = text;
}

static void keep_cell(table *t, const char *text)
{
    keep(t, memory_text(text, strlen(text)));
    t->cells++;
}

/* Numbers stand with their points under each other: so many characters before it, so
 * many from it on.  What has no point ends where the point would be. */
typedef struct width { size_t before, after; } width;

static width width_of(const char *cell, column_kind kind)
{
    size_t length = strlen(cell), before = kind == COLUMN_NUMBER || kind == COLUMN_EXACT ? strcspn(cell, ".e") : length;
    return (width){before, length - before};
}

static void write_row(const table *t, const char *const *cell, const width *w, bool header)
{
    for (size_t i = 0; i < t->columns; i++) {
        column_kind kind = t->column[i].kind;
        bool words = kind == COLUMN_WORD;
        width own = header ? (width){strlen(cell[i]), 0} : width_of(cell[i], kind);
        size_t all = w[i].before + w[i].after;
        size_t left = words ? 0 : header ? all - own.before : w[i].before - own.before;
        size_t right = all - left - own.before - own.after;
        if (i + 1 == t->columns) right = 0;
        fprintf(t->file, "%s%*s%s%*s", i ? SPACE_BETWEEN : "", (int)left, "", cell[i], (int)right, "");
    }
    fputc('\n', t->file);
}

static void write_block(table *t)
{
    const char **name = memory_take(t->columns, sizeof *name);
    width *w = memory_take(t->columns, sizeof *w);
    for (size_t i = 0, c = 0; i < t->kept_count; i++) {
        if (!t->kept[i]) continue;
        width own = width_of(t->kept[i], t->column[c].kind);
        if (own.before > w[c].before) w[c].before = own.before;
        if (own.after > w[c].after) w[c].after = own.after;
        c = (c + 1) % t->columns;
    }
    for (size_t c = 0; c < t->columns; c++) {
        name[c] = t->column[c].name;
        size_t length = strlen(name[c]), all = w[c].before + w[c].after;
        if (length > all) w[c].before += length - all;
    }
    if (t->block_written) fputc('\n', t->file);
    write_row(t, name, w, true);
    for (size_t i = 0; i < t->kept_count; i += t->kept[i] ? t->columns : 1) {
        if (t->kept[i]) write_row(t, &t->kept[i], w, false);
        else if (i + 1 < t->kept_count) fputc('\n', t->file);
    }
    t->kept_count = 0;
    t->block_written = true;
}

/* ------------------------------------------------------------------ cells */

void table_number(table *t, double value)
{
    char text[NUMBER_SIZE];
    if (t->to.format == TABLE_TEXT && !t->to.hexadecimal) {
        column_kind kind = t->column[t->cells % t->columns].kind;
        if (kind != COLUMN_EXACT || isnan(value)) {
            number_print_short(text, value, kind == COLUMN_ERROR ? 2 : 9);
            keep_cell(t, text);
            return;
        }
    }
    number_print(text, value, t->to.hexadecimal);
    if (t->to.format == TABLE_TEXT) keep_cell(t, isnan(value) ? "-" : text);
    else if (t->to.format == TABLE_JSON && isnan(value)) write_cell(t, "null", true);
    else write_cell(t, text, isfinite(value) && !t->to.hexadecimal);
}

/* The bound is for the double, and the decimal may be half an ulp beside it: who takes the
 * decimal at its word shall find it within the bound as well.  More than three digits of a
 * bound say nothing; it is rounded up to them. */
void table_number_within(table *t, double value, double error)
{
    char text[NUMBER_SIZE];
    table_number(t, value);
    if (t->to.format != TABLE_TEXT && !t->to.hexadecimal && error > 0) {
        double sum = error + number_print_gap(value);
        snprintf(text, sizeof text, "%.2e", sum * 1.005);
        error = fmax(sum, strtod(text, NULL));
    }
    table_number(t, error);
}

void table_count(table *t, long long value)
{
    char text[NUMBER_SIZE];
    snprintf(text, sizeof text, "%lld", value);
    if (t->to.format == TABLE_TEXT) keep_cell(t, text);
    else write_cell(t, text, true);
}

void table_word(table *t, const char *text)
{
    if (t->to.format == TABLE_TEXT) keep_cell(t, text);
    else write_cell(t, text, false);
}

void table_gap(table *t)
{
    if (t->to.format == TABLE_TEXT) keep(t, NULL);
}

void table_line(table *t, const char *format, ...)
{
    if (t->to.format != TABLE_TEXT) return;
    if (t->kept_count) write_block(t), fputc('\n', t->file);
    va_list values;
    va_start(values, format);
    vfprintf(t->file, format, values);
    va_end(values);
    fputc('\n', t->file);
    t->block_written = true;
}

void table_end(table *t)
{
    if (t->kept_count) write_block(t);
    if (t->to.format == TABLE_JSON) fputs(t->cells ? "\n]\n" : "]\n", t->file);
    bool bad = fflush(t->file) != 0 || ferror(t->file);
    if (t->file != stdout) bad = fclose(t->file) != 0 || bad;
    if (bad) fail_input("%s: could not be written", t->to.path ? t->to.path : "standard output");
}
