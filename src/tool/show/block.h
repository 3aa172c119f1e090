// SPDX-License-Identifier: MIT
/* block.h - a block of text: rows under a header, in columns as wide as their widest cell. */
#ifndef TOOL_BLOCK_H
#define TOOL_BLOCK_H
#include "table.h"

#include <stdio.h>

/* Rows that are not yet written: cells, and gaps between rows. */
typedef struct block block;

/* head, and the units below it (NULL: none): as long as the block.  part: it will be joined to another. */
block *block_new(size_t columns, const column *head, const char *const *unit, bool part);

/* Appends a cell, row by row; a gap. */
void block_cell(block *b, const char *text, size_t length);
void block_gap(block *b);

/* Appends the rows of another, and leaves it empty. */
void block_join(block *b, block *part);

bool block_empty(const block *b);

/* Writes header and rows, and leaves the block empty. */
void block_write(block *b, FILE *file);

#endif
