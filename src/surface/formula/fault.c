// SPDX-License-Identifier: MIT
/* fault.c - the sentence that says what is wrong with a formula.
 *
 * The library prints nothing, so it has no printf.  The few sentences of a reader are appended part by part.
 * A text that is quoted is the user's: it may have any bytes.  So what is not a printable ASCII character is
 * shown as a question mark, and what is long is cut. */
#include "fault.h"

enum { FAULT_QUOTED = 24 };

formula_fault *sgt_formula_blame(formula_fault *f, size_t column)
{
    if (f->found) return NULL;
    f->found = true, f->error.column = column;
    return f;
}

static void fault_append(formula_fault *f, char c)
{
    size_t at = 0;
    while (at + 1 < sizeof f->error.words && f->error.words[at]) at++;
    if (at + 1 < sizeof f->error.words) f->error.words[at] = c, f->error.words[at + 1] = 0;
}

formula_fault *sgt_formula_say(formula_fault *f, const char *text)
{
    if (f)
        for (; *text; text++) fault_append(f, *text);
    return f;
}

formula_fault *sgt_formula_say_part(formula_fault *f, const char *text, size_t length)
{
    size_t shown = length > FAULT_QUOTED ? FAULT_QUOTED - 3 : length;
    if (!f) return f;
    for (size_t i = 0; i < shown; i++) fault_append(f, text[i] >= ' ' && text[i] <= '~' ? text[i] : '?');
    return shown < length ? sgt_formula_say(f, "...") : f;
}

formula_fault *sgt_formula_say_number(formula_fault *f, size_t n)
{
    char digits[24], *at = digits + sizeof digits - 1;
    *at = 0;
    do *--at = (char)('0' + n % 10), n /= 10;
    while (n);
    return sgt_formula_say(f, at);
}
