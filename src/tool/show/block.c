// SPDX-License-Identifier: MIT
/* block.c - a block of text, in columns as wide as their widest cell.
 *
 * A row is kept as a mark and its cells, each with a zero byte at its end; a gap is a mark.  The widths
 * are known when the last row is.  So that memory does not grow with the rows, those that are more than
 * ASIDE bytes go to a temporary file, in portions of whole rows: the length of a portion, then its bytes. */
#include "block.h"

#include "../base/bytes.h"

#include <stdio.h>

static const char BLOCK_ROW = 'r', BLOCK_GAP = 'g';
enum { SPACE_BETWEEN = 2 };
#ifndef ASIDE
#define ASIDE (1 << 22) /* a test may set it lower */
#endif

/* Numbers are aligned at their decimal points: the characters before the point, and those from
 * it on.  A number without a point ends where the point would be. */
typedef struct width { size_t before, after; } width;

struct block {
    size_t columns, cells;      /* cells so far, of all rows */
    const column *column;
    const char *const *unit;    /* [columns]; NULL: none */
    width *width;               /* [columns] */
    bytes kept;
    FILE *aside;                /* NULL: nothing, and all is kept */
    bool in_memory;             /* a part, or there are no temporary files */
};

block *block_new(size_t columns, const column *head, const char *const *unit, bool part)
{
    block *b = memory_take(1, sizeof *b);
    *b = (block){
        .columns = columns, .column = head, .unit = unit, .in_memory = part,
        .width = memory_take(columns, sizeof *b->width)};
    return b;
}

bool block_empty(const block *b) { return !b->kept.length && !b->aside; }

static bool is_word(column_kind kind) { return kind == COLUMN_WORD || kind == COLUMN_CODE; }

static width width_of(const char *cell, size_t length, column_kind kind)
{
    size_t before = kind == COLUMN_NUMBER || kind == COLUMN_EXACT ? strcspn(cell, ".e") : length;
    return (width){before, length - before};
}

static void widen(width *w, width by)
{
    if (by.before > w->before) w->before = by.before;
    if (by.after > w->after) w->after = by.after;
}

_Noreturn static void fail_aside(const char *what)
{
    fail_input("the temporary file for the rows of the table could not be %s", what);
}

static void put_aside(block *b)
{
    if (!b->aside && !(b->aside = tmpfile())) {
        b->in_memory = true;
        return;
    }
    if (fwrite(&b->kept.length, sizeof b->kept.length, 1, b->aside) != 1 ||
        fwrite(b->kept.at, 1, b->kept.length, b->aside) != b->kept.length)
        fail_aside("written");
    b->kept.length = 0;
}

void block_cell(block *b, const char *text, size_t length)
{
    size_t i = b->cells++ % b->columns;
    if (i == 0 && b->kept.length >= ASIDE && !b->in_memory) put_aside(b);
    if (i == 0) bytes_one(&b->kept, BLOCK_ROW);
    bytes_put(&b->kept, text, length + 1);
    widen(&b->width[i], width_of(text, length, b->column[i].kind));
}

void block_gap(block *b) { bytes_one(&b->kept, BLOCK_GAP); }

void block_join(block *b, block *part)
{
    bytes_put(&b->kept, part->kept.at, part->kept.length);
    for (size_t c = 0; c < b->columns; c++) widen(&b->width[c], part->width[c]);
    part->kept.length = part->cells = 0;
    memset(part->width, 0, part->columns * sizeof *part->width);
    if (b->kept.length >= ASIDE && !b->in_memory) put_aside(b);
}

static char *fill(char *to, size_t count) { return memset(to, ' ', count), to + count; }

/* The lines of the header: names, then units. */
typedef enum block_line { LINE_NAMES, LINE_UNITS, LINE_CELLS } block_line;

/* Writes a row; cell: its cells, one behind another.  Returns where they end. */
static const char *block_write_row(const block *b, const char *cell, char *line, block_line which, FILE *file)
{
    const bool header = which != LINE_CELLS;
    char *to = line;
    for (size_t i = 0; i < b->columns; i++) {
        column_kind kind = b->column[i].kind;
        bool words = is_word(kind);
        if (header) cell = which == LINE_NAMES ? b->column[i].name : b->unit[i];
        const width *w = &b->width[i];
        size_t length = strlen(cell);
        width own = header ? (width){length, 0} : width_of(cell, length, kind);
        size_t all = w->before + w->after;
        size_t left = words ? 0 : header ? all - own.before : w->before - own.before;
        size_t right = i + 1 < b->columns ? all - left - length : 0;
        if (i) to = fill(to, SPACE_BETWEEN);
        to = fill(to, left);
        memcpy(to, cell, length);
        to = fill(to + length, right);
        cell += length + 1;
    }
    while (which == LINE_UNITS && to > line && to[-1] == ' ') to--;
    *to++ = '\n';
    fwrite(line, 1, (size_t)(to - line), file);
    return cell;
}

/* What was written last; a gap is written only between rows, when the next one follows. */
typedef enum written { WRITTEN_HEADER, WRITTEN_ROW, GAP_PENDING } written;

static void write_rows(const block *b, const bytes *rows, char *line, written *last, FILE *file)
{
    for (const char *at = rows->at, *end = at + rows->length; at < end;) {
        if (*at++ != BLOCK_ROW) {
            if (*last == WRITTEN_ROW) *last = GAP_PENDING;
            continue;
        }
        if (*last == GAP_PENDING) fputc('\n', file);
        *last = WRITTEN_ROW;
        at = block_write_row(b, at, line, LINE_CELLS, file);
    }
}

/* Writes the rows that were put aside. */
static void write_aside(block *b, char *line, written *last, FILE *file)
{
    bytes rows = {.length = 0};
    if (fflush(b->aside) != 0) fail_aside("written");
    rewind(b->aside);
    while (fread(&rows.length, sizeof rows.length, 1, b->aside) == 1) {
        const size_t length = rows.length;
        rows.length = 0;
        if (fread(bytes_room(&rows, length), 1, length, b->aside) != length) fail_aside("read");
        rows.length = length;
        write_rows(b, &rows, line, last, file);
    }
    if (ferror(b->aside)) fail_aside("read");
    fclose(b->aside);
    b->aside = NULL;
}

void block_write(block *b, FILE *file)
{
    size_t longest = 1;
    written last = WRITTEN_HEADER;
    for (size_t c = 0; c < b->columns; c++) {
        width *w = &b->width[c];
        size_t length = strlen(b->column[c].name), all = w->before + w->after;
        size_t unit = b->unit ? strlen(b->unit[c]) : 0;
        if (unit > length) length = unit;
        if (length > all) w->before += length - all;
        longest += w->before + w->after + SPACE_BETWEEN;
    }
    char *line = memory_grow(NULL, longest, 1);
    block_write_row(b, NULL, line, LINE_NAMES, file);
    if (b->unit) block_write_row(b, NULL, line, LINE_UNITS, file);
    if (b->aside) write_aside(b, line, &last, file);
    write_rows(b, &b->kept, line, &last, file);
    b->kept.length = b->cells = 0;
    memset(b->width, 0, b->columns * sizeof *b->width);
}
