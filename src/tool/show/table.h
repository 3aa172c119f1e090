// SPDX-License-Identifier: MIT
/* table.h - the output of the command: one table, as text, csv, json or npy.
 *
 * Cells are given row by row, in the order of the columns, or many rows by column.  csv, json and npy are
 * written as they come.  Text is written when the table ends, because a column is as wide as its widest
 * cell.  Memory does not grow with the rows. */
#ifndef TOOL_TABLE_H
#define TOOL_TABLE_H
#include "../base/fail.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum table_format { TABLE_TEXT, TABLE_CSV, TABLE_JSON, TABLE_NPY } table_format;

typedef struct table_target {
    table_format format;
    const char *path;     /* NULL: standard output */
    bool single;          /* NUMBER and ERROR are floats, and npy writes them so */
    bool nowhere;         /* what would be printed is of no use */
    size_t placed;        /* 0; or how many rows of npy there will be, which ranks write by table_place */
    bool hexadecimal;     /* numbers as 0x1.8p+1; in json as strings, since json has no such numbers */
    const char *columns;  /* of --columns: names with commas, in the order they are wanted; NULL: all */
    size_t word_size;     /* of the longest word in a column of WORD, for npy */
    bool leads;           /* a first column `configuration`, which table_lead fills: it is no cell of a row */
    const char *const *unit; /* of each column, below its name in text, "" for none; NULL: of no column */
} table_target;

/* How a column looks as text, and in npy: NUMBER with 9 digits, EXACT with as many as it needs, ERROR with 2,
 * a double; COUNT a whole number of 8 bytes, INTEGER one of 4; CODE a word that has a number, of 1 byte; WORD
 * words, of target.word_size bytes. */
typedef enum column_kind {
    COLUMN_NUMBER, COLUMN_EXACT, COLUMN_ERROR, COLUMN_COUNT, COLUMN_INTEGER, COLUMN_CODE, COLUMN_WORD
} column_kind;
typedef struct column { const char *name; column_kind kind; } column;

/* A column of a block of rows: row i has its value at `at` + i `step` (0: all the same).  It is a double;
 * COUNT: long long; INTEGER: int; CODE: signed char, whose word `word` tells; WORD: const char *.  NULL: each
 * is empty.  An ERROR is a bound on the column before. */
typedef struct table_values { const void *at; size_t step; const char *(*word)(int code); } table_values;
#define TABLE_VALUES(array) {.at = (array), .step = sizeof *(array)}

typedef struct table table;

/* An unknown name in target->columns ends with a usage error. */
table *table_begin(const table_target *target, size_t columns, const column *head);
void table_number(table *t, double value);
void table_number_within(table *t, double value, double error); /* two cells: it, a bound on its error */
void table_count(table *t, long long value);
void table_word(table *t, const char *text);
void table_code(table *t, int code, const char *word); /* word: as long as the table */
void table_empty(table *t); /* nothing in csv, null in json, - in text; NaN, 0 or no letters in npy */

/* Whole rows, by column: what a table or part is quickest with. */
void table_block(table *t, size_t rows, const table_values values[]);

/* A column as rows in memory have it, at an offset: a double, of which a NaN is nothing; a size_t; a double
 * that is a whole number; an int that is a code.  zero: NULL, or what 0 stands for. */
typedef enum member_kind { MEMBER_NUMBER, MEMBER_COUNT, MEMBER_WHOLE, MEMBER_CODE } member_kind;
typedef struct table_member {
    member_kind kind;
    size_t offset;
    const char *zero;           /* without a mark of csv */
    const char *(*word)(int code);
} table_member;

/* A whole row, of csv: the same bytes as by cells, but quicker.  false: the format is another one. */
bool table_put_members(table *t, const table_member member[], const void *row);

/* Of a table that leads: the number that the rows which follow begin with.  Of the parts, too, that are made
 * from now on. */
void table_lead(table *t, size_t number);

/* Only in text.  table_gap: an empty line, if it is between two rows.  table_line: a line of text under the
 * rows so far; later rows start a new block with its own header. */
void table_gap(table *t);
void table_line(table *t, const char *format, ...) LIKE_PRINTF(2, 3);

/* A part collects whole rows, perhaps in another thread: it takes cells and gaps as the table does.
 * table_join appends its rows to the table and leaves the part empty. */
table *table_part(const table *t);
void table_join(table *t, table *part);

/* The rows of a part as they are printed, of another format than text: how many arrays of bytes they are, and
 * the i-th; how many rows.  Both may be set.  table_drop leaves the part empty. */
size_t table_arrays(const table *t);
struct bytes *table_printed(table *part, size_t i);
size_t *table_rows(table *part);
void table_drop(table *part);

/* Of rows that are placed: writes those of a part where they belong, from row `first` on.  In any thread, one
 * at a time.  table_placed: all ranks have done so. */
void table_place(table *t, table *part, size_t first);
void table_placed(table *t);

/* Writes what is left.  If the file cannot be written the command ends. */
void table_end(table *t);

#endif
