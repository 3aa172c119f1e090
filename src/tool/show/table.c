// SPDX-License-Identifier: MIT
/* table.c - text, csv, json and npy, from a stream of cells or from blocks of columns.
 *
 * The cells of a row are kept as values until the row is whole.  Then those that are wanted are printed, in
 * the order they are wanted in.  A number that stands in its column as before is not printed again but
 * copied: a wavelength, or a point of the pupil, is the same in many rows. */
#include "table.h"

#include "../base/bytes.h"
#include "../base/input.h"
#include "../../text/number.h"
#include "block.h"
#include "npy.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

enum { WRITE_AT = 1 << 16 }; /* csv, json and npy are written when so many bytes are kept */

enum { CELL_EMPTY, CELL_NUMBER, CELL_BOUND, CELL_COUNT, CELL_WORD, CELL_CODE };
typedef struct cell {
    int kind;
    double number;     /* of a BOUND: on the error of the number in the cell before; of an EMPTY: NaN */
    long long count;   /* or the code; of a WORD: where in `words` it begins */
    const char *word;  /* of a CODE; of a WORD of npy, itself */
    int integer;       /* of npy: the count, as a column of INTEGER or CODE has it */
    signed char code;
} cell;

/* What was printed in a column last, and where. */
typedef struct printed {
    uint64_t bits;
    double gap;        /* of a number with a bound: at least how far off its decimal is */
    size_t start;      /* in `kept` */
    int length;        /* 0: nothing that is still kept */
    bool again;        /* it came again, and is in `text`, too */
    char text[NUMBER_SIZE];
    int kind;          /* twice that of the cell, and 1 if a bound on it follows */
} printed;

struct table {
    table_target to;
    FILE *file;                 /* NULL: a part of another table, or npy */
    const char *name;           /* where it is while it is written */
    npy_output *npy;
    bytes *out;                 /* [npy_files()]: of npy, instead of `kept` */
    table_values *chosen_values; /* [chosen] */
    size_t columns, filled, rows;
    const column *column;
    cell *cell;                 /* [columns], and one that stays empty, of the row that is being filled */
    printed *last;              /* [columns] */
    size_t chosen;
    const size_t *choice;       /* [chosen]: which cells are written */
    column *head;               /* [chosen] */
    const char **unit;          /* [chosen]; NULL: none */
    bytes kept, words;
    block *block;               /* of text */
    bool part, block_written;
    bool plain;                 /* csv, and not hexadecimal */
    long long lead;             /* of a table that leads */
};

/* ------------------------------------------------------------ the choice */

_Noreturn static void fail_column(const table *t, const char *name, int length, const char *what)
{
    char all[1000] = "";
    for (size_t i = 0, n = 0; i < t->columns && n < sizeof all; i++)
        n += (size_t)snprintf(all + n, sizeof all - n, "%s%s", i ? ", " : "", t->column[i].name);
    fail_usage("--columns: \"%.*s\" %s; there are %s", length < 60 ? length : 60, name, what, all);
}

/* The place of a column by its name; t->columns: there is none. */
static size_t place_of(const table *t, const char *name, size_t length)
{
    for (size_t i = 0; i < t->columns; i++)
        if (strncmp(t->column[i].name, name, length) == 0 && !t->column[i].name[length]) return i;
    return t->columns;
}

static void choose(table *t)
{
    size_t *choice = memory_take(t->columns, sizeof *choice), count = 0;
    for (size_t i = 0; i < t->columns && !t->to.columns; i++) choice[count++] = i;
    for (const char *name = t->to.columns, *next; name; name = *next ? next + 1 : NULL) {
        const size_t length = strcspn(name, ","), place = place_of(t, name, length);
        next = name + length;
        if (place == t->columns) fail_column(t, name, (int)length, "is no column");
        for (size_t i = 0; i < count; i++)
            if (choice[i] == place) fail_column(t, name, (int)length, "is named twice");
        choice[count++] = place;
    }
    t->choice = choice, t->chosen = count;
    t->head = memory_take(count, sizeof *t->head);
    for (size_t i = 0; i < count; i++) t->head[i] = t->column[choice[i]];
    if (!t->to.unit) return;
    t->unit = memory_take(count, sizeof *t->unit);
    for (size_t i = 0; i < count; i++) t->unit[i] = t->to.unit[choice[i]];
}

/* ------------------------------------------------------------------ begin */

/* The cell of the first column stays filled in. */
void table_lead(table *t, size_t number)
{
    t->lead = (long long)number;
    if (t->to.leads) t->cell[0] = (cell){.kind = CELL_COUNT, .number = (double)NAN, .count = t->lead};
}

static table *table_new(const table *like)
{
    table *t = memory_take(1, sizeof *t);
    *t = *like;
    t->cell = memory_take(t->columns + 1, sizeof *t->cell);
    t->last = memory_take(t->columns, sizeof *t->last);
    if (t->to.format == TABLE_TEXT) t->block = block_new(t->chosen, t->head, t->unit, t->part);
    if (t->npy) t->out = memory_take(npy_files(t->npy), sizeof *t->out);
    t->chosen_values = memory_take(t->chosen, sizeof *t->chosen_values);
    t->filled = t->to.leads;
    if (t->to.leads) table_lead(t, (size_t)t->lead);
    return t;
}

/* With a first column more. */
static table_target led(const table_target *target, size_t columns, const column **head)
{
    table_target to = *target;
    column *all = memory_take(columns + 1, sizeof *all);
    all[0] = (column){"configuration", COLUMN_COUNT};
    memcpy(all + 1, *head, columns * sizeof *all);
    *head = all;
    if (!to.unit) return to;
    const char **unit = memory_take(columns + 1, sizeof *unit);
    unit[0] = "";
    for (size_t i = 0; i < columns; i++) unit[i + 1] = to.unit[i];
    to.unit = unit;
    return to;
}

table *table_begin(const table_target *target, size_t columns, const column *head)
{
    const table_target to = target->leads ? led(target, columns, &head) : *target;
    columns += to.leads, target = &to;
    table blank = {.to = *target, .columns = columns, .column = head,
                   .plain = target->format == TABLE_CSV && !target->hexadecimal};
    if (target->nowhere && target->format != TABLE_NPY) blank.to.path = "/dev/null";
    choose(&blank);
    if (target->format == TABLE_NPY) blank.npy = npy_begin(target, blank.chosen, blank.head);
    table *t = table_new(&blank);
    if (t->npy) return t;
    t->file = stdout;
    if (t->to.path) output_check("output", t->to.path);
    if (t->to.path) output_check("output", t->name = output_name(t->to.path));
    if (t->to.path && !(t->file = fopen(t->name, "w")))
        fail_input("--output %s: %s", t->to.path, strerror(errno));
    if (t->to.format == TABLE_JSON) bytes_one(&t->kept, '[');
    for (size_t i = 0; i < t->chosen && t->to.format == TABLE_CSV; i++) {
        bytes_text(&t->kept, t->head[i].name);
        bytes_one(&t->kept, i + 1 < t->chosen ? ',' : '\n');
    }
    return t;
}

/* ------------------------------------------------------------ csv and json */

static void put_json_string(bytes *b, const char *text)
{
    char code[8];
    bytes_one(b, '"');
    for (const char *c = text; *c; c++) {
        if ((unsigned char)*c < 32) {
            snprintf(code, sizeof code, "\\u%04x", (unsigned)*c);
            bytes_text(b, code);
            continue;
        }
        if (*c == '"' || *c == '\\') bytes_one(b, '\\');
        bytes_one(b, *c);
    }
    bytes_one(b, '"');
}

static void put_csv_field(bytes *b, const char *text)
{
    size_t plain = strcspn(text, ",\"\r\n");
    if (!text[plain]) {
        bytes_put(b, text, plain);
        return;
    }
    bytes_one(b, '"');
    for (const char *c = text; *c; c++) {
        if (*c == '"') bytes_one(b, '"');
        bytes_one(b, *c);
    }
    bytes_one(b, '"');
}

/* A part does not know whether its first row is the first of the table, so it begins with a comma; table_join
 * leaves it out if it is. */
static void put_json_key(table *t, size_t i)
{
    bytes_text(&t->kept, i ? ", \"" : t->rows == 0 && !t->part ? "\n{\"" : ",\n{\"");
    bytes_text(&t->kept, t->head[i].name);
    bytes_text(&t->kept, "\": ");
}

/* ------------------------------------------------------------------ cells */

/* Prints a number as the format has it; returns the length. */
static int print_number(const table *t, size_t place, double value, char text[NUMBER_SIZE], double *gap)
{
    const column_kind kind = t->column[place].kind;
    const table_format format = t->to.format;
    const bool hexadecimal = t->to.hexadecimal, json = format == TABLE_JSON;
    if (format == TABLE_TEXT && ((!hexadecimal && kind != COLUMN_EXACT) || isnan(value)))
        return number_print_short(text, value, kind == COLUMN_ERROR ? 2 : 9);
    if (json && isnan(value)) return snprintf(text, NUMBER_SIZE, "null");
    if (json && (hexadecimal || isinf(value))) {
        char bare[NUMBER_SIZE];
        number_print(bare, value, hexadecimal);
        return snprintf(text, NUMBER_SIZE, "\"%.36s\"", bare);
    }
    if (t->cell[place + 1].kind == CELL_BOUND && !hexadecimal) return number_print_with_gap(text, value, gap);
    return number_print(text, value, hexadecimal);
}

/* The bound is for the double, and the printed decimal may be half an ulp beside it.  So the bound is raised
 * to hold for the decimal too, and rounded up to three digits. */
static int print_bound(const table *t, size_t place, char text[NUMBER_SIZE])
{
    const double error = t->cell[place].number, value = t->cell[place - 1].number;
    const printed *p = &t->last[place - 1];
    double gap = p->gap;
    if (t->to.format == TABLE_TEXT || t->to.hexadecimal || !(error > 0) || !isfinite(error))
        return print_number(t, place, error, text, &gap);
    if (!p->length || memcmp(&p->bits, &value, sizeof value) != 0) number_print_with_gap(text, value, &gap);
    return number_print_up(text, error + gap);
}

/* Prints a cell that is no word; returns the length.  Words of codes are only letters, and shorter than
 * numbers. */
static int print_cell(const table *t, size_t place, char text[NUMBER_SIZE], double *gap)
{
    const cell *c = &t->cell[place];
    if (c->kind == CELL_NUMBER) return print_number(t, place, c->number, text, gap);
    if (c->kind == CELL_BOUND) return print_bound(t, place, text);
    if (c->kind == CELL_COUNT) return number_print_count(text, c->count);
    return snprintf(text, NUMBER_SIZE, t->to.format == TABLE_JSON ? "\"%s\"" : "%s", c->word);
}

static void put_word(table *t, const char *text)
{
    if (t->block) block_cell(t->block, text, strlen(text));
    else put_json_string(&t->kept, text);
}

static void put_empty(table *t)
{
    if (t->block) block_cell(t->block, "-", 1);
    else bytes_text(&t->kept, "null");
}

/* Prints a cell that is no word into `kept`, where NUMBER_SIZE characters have room; returns the length.  If
 * the column has the same as in the row before, that is copied; but a bound, which hangs on two cells. */
static inline size_t print_or_copy(table *t, size_t place, char *text)
{
    const cell *c = &t->cell[place];
    printed *p = &t->last[place];
    const int kind = 2 * c->kind + (t->cell[place + 1].kind == CELL_BOUND);
    uint64_t bits;
    memcpy(&bits, c->kind == CELL_NUMBER ? (const void *)&c->number : &c->count, sizeof bits);
    if (p->length && p->bits == bits && p->kind == kind && c->kind != CELL_BOUND) {
        /* copies of a known size are quicker, and so are those of what was not written just now */
        if (!p->again) memcpy(p->text, t->kept.at + p->start, NUMBER_SIZE), p->again = true;
        memcpy(text, p->text, NUMBER_SIZE);
        return (size_t)p->length;
    }
    p->gap = 0;
    p->length = kind == 2 * CELL_NUMBER && t->plain ? number_print(text, c->number, false)
                                                    : print_cell(t, place, text, &p->gap);
    p->bits = bits, p->kind = kind, p->start = (size_t)(text - t->kept.at), p->again = false;
    return (size_t)p->length;
}

static void put_cell(table *t, size_t place)
{
    const cell *c = &t->cell[place];
    char text[NUMBER_SIZE];
    double gap;
    if (c->kind == CELL_EMPTY) put_empty(t);
    else if (c->kind == CELL_WORD) put_word(t, t->words.at + c->count);
    else if (t->block) block_cell(t->block, text, (size_t)print_cell(t, place, text, &gap));
    else t->kept.length += print_or_copy(t, place, bytes_room(&t->kept, NUMBER_SIZE));
}

static void put_csv_row(table *t)
{
    const size_t most = t->chosen * (NUMBER_SIZE + 1);
    char *to = bytes_room(&t->kept, most);
    for (size_t i = 0; i < t->chosen; i++) {
        const size_t place = t->choice[i];
        const cell *c = &t->cell[place];
        if (c->kind == CELL_WORD) {
            t->kept.length = (size_t)(to - t->kept.at);
            put_csv_field(&t->kept, t->words.at + c->count);
            to = bytes_room(&t->kept, most);
        } else if (c->kind != CELL_EMPTY) {
            to += print_or_copy(t, place, to);
        }
        *to++ = ',';
    }
    to[-1] = '\n';
    t->kept.length = (size_t)(to - t->kept.at);
}

/* Appends the row as npy has it. */
static void put_binary_row(table *t)
{
    for (size_t i = 0; i < t->chosen; i++) {
        cell *c = &t->cell[t->choice[i]];
        const column_kind kind = t->head[i].kind;
        c->integer = (int)c->count, c->code = (signed char)c->count;
        if (kind == COLUMN_WORD) c->word = c->kind == CELL_WORD ? t->words.at + c->count : "";
        t->chosen_values[i].at = kind == COLUMN_COUNT     ? (const void *)&c->count
                                 : kind == COLUMN_INTEGER ? (const void *)&c->integer
                                 : kind == COLUMN_CODE    ? (const void *)&c->code
                                 : kind == COLUMN_WORD    ? (const void *)&c->word
                                                          : (const void *)&c->number;
        t->chosen_values[i].step = 0;
    }
    npy_block(t->npy, 1, t->chosen_values, t->out);
}

/* Forgets the bytes that are kept. */
static void drop_kept(table *t)
{
    t->kept.length = 0;
    for (size_t i = 0; i < t->columns; i++) t->last[i].length = 0;
}

static void write_bytes(table *t, const char *at, size_t length)
{
    if (length) fwrite(at, 1, length, t->file);
}

static void write_kept(table *t)
{
    if (t->npy) npy_write(t->npy, t->out);
    else write_bytes(t, t->kept.at, t->kept.length);
    drop_kept(t);
}

static void end_row(table *t)
{
    const table_format format = t->to.format;
    if (format == TABLE_NPY) put_binary_row(t);
    else if (format == TABLE_CSV) put_csv_row(t);
    for (size_t i = 0; i < t->chosen && (format == TABLE_TEXT || format == TABLE_JSON); i++) {
        if (format == TABLE_JSON) put_json_key(t, i);
        put_cell(t, t->choice[i]);
    }
    if (format == TABLE_JSON) bytes_one(&t->kept, '}');
    t->filled = t->to.leads, t->words.length = 0;
    t->rows++;
    if (!t->part && (t->npy ? t->out[0].length : t->kept.length) >= WRITE_AT) write_kept(t);
}

/* Fills in the next cell, member by member: a whole one, copied, would cost as much as all the rest. */
static void add_cell(table *t, int kind, double number, long long count, const char *word)
{
    cell *c = &t->cell[t->filled];
    c->kind = kind, c->number = number, c->count = count, c->word = word;
    if (++t->filled == t->columns) end_row(t);
}

void table_number(table *t, double value) { add_cell(t, CELL_NUMBER, value, 0, NULL); }

void table_number_within(table *t, double value, double error)
{
    add_cell(t, CELL_NUMBER, value, 0, NULL);
    add_cell(t, CELL_BOUND, error, 0, NULL);
}

void table_count(table *t, long long value) { add_cell(t, CELL_COUNT, 0, value, NULL); }

void table_code(table *t, int code, const char *word) { add_cell(t, CELL_CODE, 0, code, word); }

void table_word(table *t, const char *text)
{
    const size_t start = t->words.length;
    bytes_put(&t->words, text, strlen(text) + 1);
    add_cell(t, CELL_WORD, 0, (long long)start, NULL);
}

void table_empty(table *t) { add_cell(t, CELL_EMPTY, (double)NAN, 0, NULL); }

/* A cell of a block of rows. */
static void block_value(table *t, const column *c, const table_values *v, size_t row)
{
    const char *at = v->at ? (const char *)v->at + row * v->step : NULL;
    if (!at) {
        table_empty(t);
        return;
    }
    switch (c->kind) {
    case COLUMN_NUMBER:
    case COLUMN_EXACT: table_number(t, *(const double *)(const void *)at); break;
    case COLUMN_ERROR: add_cell(t, CELL_BOUND, *(const double *)(const void *)at, 0, NULL); break;
    case COLUMN_COUNT: table_count(t, *(const long long *)(const void *)at); break;
    case COLUMN_INTEGER: table_count(t, *(const int *)(const void *)at); break;
    case COLUMN_CODE: table_code(t, *(const signed char *)at, v->word(*(const signed char *)at)); break;
    case COLUMN_WORD: table_word(t, *(const char *const *)(const void *)at);
    }
}

void table_block(table *t, size_t rows, const table_values values[])
{
    if (t->npy) {
        const size_t leads = t->to.leads;
        for (size_t i = 0; i < t->chosen; i++)
            t->chosen_values[i] = t->choice[i] < leads ? (table_values){.at = &t->lead}
                                                       : values[t->choice[i] - leads];
        npy_block(t->npy, rows, t->chosen_values, t->out);
        t->rows += rows;
        if (!t->part && t->out[0].length >= WRITE_AT) write_kept(t);
        return;
    }
    const column *own = t->column + t->to.leads;
    const size_t count = t->columns - t->to.leads;
    for (size_t row = 0; row < rows; row++)
        for (size_t c = 0; c < count; c++) block_value(t, &own[c], &values[c], row);
}

/* --------------------------------------------------------------- rows in memory */

static inline size_t put_text(char *to, const char *text)
{
    const size_t length = strlen(text);
    memcpy(to, text, length);
    return length;
}

/* Prints a member, where NUMBER_SIZE characters have room; returns the length. */
static inline size_t put_member(table *t, const table_member *m, printed *p, const char *row, char *to)
{
    uint64_t bits = 0;
    double number = 1;
    int code;
    if (m->kind == MEMBER_CODE) memcpy(&code, row + m->offset, sizeof code), bits = (uint32_t)code;
    else memcpy(&bits, row + m->offset, sizeof bits);
    if (m->kind == MEMBER_NUMBER || m->kind == MEMBER_WHOLE) memcpy(&number, &bits, sizeof number);
    if (isnan(number)) return 0;
    if (m->zero && (number == 0 || (m->kind == MEMBER_COUNT && bits == 0))) return put_text(to, m->zero);
    if (p->length && p->bits == bits) { /* as in print_or_copy */
        if (!p->again) memcpy(p->text, t->kept.at + p->start, NUMBER_SIZE), p->again = true;
        memcpy(to, p->text, NUMBER_SIZE);
        return (size_t)p->length;
    }
    p->length = m->kind == MEMBER_NUMBER  ? number_print(to, number, false)
                : m->kind == MEMBER_WHOLE ? number_print_count(to, (long long)number)
                : m->kind == MEMBER_COUNT ? number_print_count(to, (long long)bits)
                                          : (int)put_text(to, m->word((int)(uint32_t)bits));
    p->bits = bits, p->start = (size_t)(to - t->kept.at), p->again = false;
    return (size_t)p->length;
}

bool table_put_members(table *t, const table_member member[], const void *row)
{
    if (!t->plain || t->to.leads) return false;
    char *to = bytes_room(&t->kept, t->chosen * (NUMBER_SIZE + 1));
    for (size_t i = 0; i < t->chosen; i++) {
        const size_t place = t->choice[i];
        to += put_member(t, &member[place], &t->last[place], row, to);
        *to++ = ',';
    }
    to[-1] = '\n';
    t->kept.length = (size_t)(to - t->kept.at);
    t->rows++;
    if (!t->part && t->kept.length >= WRITE_AT) write_kept(t);
    return true;
}

/* ------------------------------------------------------------------- text */

static void write_block(table *t)
{
    if (t->block_written) fputc('\n', t->file);
    block_write(t->block, t->file);
    t->block_written = true;
}

void table_gap(table *t)
{
    if (t->block) block_gap(t->block);
}

void table_line(table *t, const char *format, ...)
{
    if (!t->block) return;
    if (!block_empty(t->block)) write_block(t), fputc('\n', t->file);
    va_list values;
    va_start(values, format);
    vfprintf(t->file, format, values);
    va_end(values);
    fputc('\n', t->file);
    t->block_written = true;
}

/* ------------------------------------------------------------------ parts */

table *table_part(const table *t)
{
    table like = *t;
    like.file = NULL, like.part = true;
    like.kept = like.words = (bytes){.length = 0};
    like.filled = like.rows = 0;
    return table_new(&like);
}

void table_join(table *t, table *part)
{
    if (t->block) {
        block_join(t->block, part->block);
    } else if (t->npy) {
        npy_write(t->npy, t->out);
        npy_write(t->npy, part->out);
    } else if (part->rows) {
        const size_t comma = t->to.format == TABLE_JSON && t->rows == 0;
        write_kept(t);
        write_bytes(t, part->kept.at + comma, part->kept.length - comma);
    }
    t->rows += part->rows;
    part->rows = 0;
    drop_kept(part);
}

size_t table_arrays(const table *t) { return t->npy ? npy_files(t->npy) : 1; }
bytes *table_printed(table *part, size_t i) { return part->npy ? &part->out[i] : &part->kept; }
size_t *table_rows(table *part) { return &part->rows; }

void table_drop(table *part)
{
    for (size_t i = 0; i < table_arrays(part); i++) table_printed(part, i)->length = 0;
    part->rows = 0;
    drop_kept(part);
}

void table_place(table *t, table *part, size_t first)
{
    npy_place_rows(t->npy, first, part->out);
    part->rows = 0;
}

void table_placed(table *t)
{
    if (t->to.placed) npy_placed(t->npy);
}

void table_end(table *t)
{
    if (t->block && !block_empty(t->block)) write_block(t);
    if (t->to.format == TABLE_JSON) bytes_text(&t->kept, t->rows ? "\n]\n" : "]\n");
    if (!t->block) write_kept(t);
    if (t->npy) {
        npy_end(t->npy);
        return;
    }
    bool bad = fflush(t->file) != 0 || ferror(t->file);
    if (t->file != stdout) bad = fclose(t->file) != 0 || bad;
    if (bad)
        fail_input("%s%s: could not be written", t->to.path ? "--output " : "",
                   t->to.path ? t->to.path : "standard output");
    if (t->to.path) output_whole("output", t->name, t->to.path);
}
