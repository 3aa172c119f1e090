/* table.h - what the command writes: one table, as text, csv or json.
 *
 * Cells are given row by row, in the order of the columns; csv and json go out as they
 * come, text when the table ends, for its columns are as wide as their widest cell. */
#ifndef TOOL_TABLE_H
#define TOOL_TABLE_H
#include "../base/fail.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum table_format { TABLE_TEXT, TABLE_CSV, TABLE_JSON } table_format;

typedef struct table_target {
    table_format format;
    const char *path;     /* NULL: standard output */
    bool hexadecimal;     /* numbers as 0x1.8p+1; in json as strings, for it knows none */
} table_target;

/* How a column looks as text: a number with 9 digits, with as many as it has, or with 2; a
 * whole number; words. */
typedef enum column_kind { COLUMN_NUMBER, COLUMN_EXACT, COLUMN_ERROR, COLUMN_COUNT, COLUMN_WORD } column_kind;
typedef struct column { const char *name; column_kind kind; } column;

typedef struct table table;

table *table_begin(const table_target *target, size_t columns, const column *head);
void table_number(table *t, double value);
void table_number_within(table *t, double value, double error); /* two cells: it, and a bound on its error */
void table_count(table *t, long long value);
void table_word(table *t, const char *text);

/* For people only, nothing in csv and json: a rule between two rows, and a line of text
 * under the rows so far; rows after it start a new block with its own header. */
void table_gap(table *t);
void table_line(table *t, const char *format, ...) LIKE_PRINTF(2, 3);

/* Whole rows that are made apart, by another thread it may be: a part takes cells and gaps
 * as the table does, and its rows are put behind the table's own by table_join, which leaves
 * it empty for the next. */
table *table_part(const table *t);
void table_join(table *t, table *part);

/* Writes what is left.  A file that cannot be written ends the command. */
void table_end(table *t);

#endif
