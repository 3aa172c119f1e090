// SPDX-License-Identifier: MIT
/* numbers.h - the numbers of the elements, beside each of them. */
#ifndef TOOL_NUMBERS_H
#define TOOL_NUMBERS_H
#include "page.h"

typedef struct number {
    char text[24];
    page_dot at, from, to; /* its middle; a line from the element to it, if `led` */
    bool led;
} number;

typedef struct element_numbers {
    size_t count, left_out; /* left out: there was no room beside them */
    number *number;         /* [count] */
    double top, bottom;     /* the range of y that they need */
} element_numbers;

/* Finds their places: none covers another, or an element. */
element_numbers numbers_of(const page *p, double width);

void numbers_draw(const page *p, const element_numbers *n, double down);

#endif
