// SPDX-License-Identifier: MIT
/* scan.h - the text of a formula as words: numbers, names and signs. */
#ifndef SGT_SURFACE_FORMULA_SCAN_H
#define SGT_SURFACE_FORMULA_SCAN_H

#include "fault.h"

/* Which word; a sign is its own character. */
enum { WORD_END = 0, WORD_NUMBER = 'n', WORD_NAME = 'a' };

typedef struct formula_scan {
    const char *text;
    size_t at;            /* behind the word */
    int word;             /* that is looked at */
    size_t start, length; /* of it */
    double number;        /* its value */
    formula_fault *fault;
} formula_scan;

/* Goes to the next word.  After a fault it is WORD_END. */
void sgt_scan_next(formula_scan *s);

/* The column of the word. */
size_t sgt_scan_column(const formula_scan *s);

/* Is the word, or another text of that length, this name? */
bool sgt_scan_is(const char *text, size_t length, const char *name);

/* Is it a name: a letter, then letters, digits and _? */
bool sgt_scan_is_name(const char *text);

/* Says that something else was expected than the word: `expected`, "not" and the word. */
void sgt_scan_expected(const formula_scan *s, const char *expected);

#endif
