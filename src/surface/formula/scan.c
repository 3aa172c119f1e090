// SPDX-License-Identifier: MIT
/* scan.c - the text of a formula as words.
 *
 * Blanks, tabs and ends of lines separate words and mean nothing.  Everything else is ASCII: whoever copies a
 * formula from a page brings a minus, a dot for a product or a raised 2 that only look right, and is told
 * what to write instead.
 *
 * Test: tests/unit/test_formula.c. */
#include "scan.h"

#include "num/decimal.h"

#include <math.h>

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
static bool is_of_name(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }
static bool is_sign(char c)
{
    return c == '+' || c == '-' || c == '*' || c == '/' || c == '^' || c == '(' || c == ')' || c == ',' ||
           c == '=';
}
static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

size_t sgt_scan_column(const formula_scan *s) { return s->start + 1; }

bool sgt_scan_is(const char *text, size_t length, const char *name)
{
    for (size_t i = 0; i < length; i++)
        if (text[i] != name[i]) return false; /* also at the end of the name */
    return name[length] == 0;
}

bool sgt_scan_is_name(const char *text)
{
    if (!is_letter(*text)) return false;
    while (is_of_name(*text)) text++;
    return *text == 0;
}

/* A character that no formula has. */
static void scan_foreign(const formula_scan *s, char c)
{
    formula_fault *f = sgt_formula_blame(s->fault, sgt_scan_column(s));
    unsigned char byte = (unsigned char)c;
    if (byte >= 0x80) {
        sgt_formula_say(f, "only ASCII characters: write - for minus, * for times, ^2 for a square, pi");
    } else if (byte < ' ' || byte == 0x7f) {
        sgt_formula_say(f, "a control character has no meaning here");
    } else {
        f = sgt_formula_say(sgt_formula_say_part(f, &c, 1), " has no meaning in a formula");
        if (c == '|') sgt_formula_say(f, ": write abs(u)");
        if (c == '[' || c == '{' || c == ']' || c == '}') sgt_formula_say(f, ": use ( and )");
    }
}

static void scan_number(formula_scan *s)
{
    s->word = WORD_NUMBER;
    s->number = decimal_read(s->text + s->start, NULL, &s->length);
    s->at = s->start + s->length;
    if (s->length == 0) {
        sgt_formula_say(sgt_formula_blame(s->fault, sgt_scan_column(s)), "a point alone is no number");
    } else if (isinf(s->number)) {
        sgt_formula_say(sgt_formula_blame(s->fault, sgt_scan_column(s)),
                        "this number is larger than the largest double, 1.8e308");
    } else if (s->text[s->at] == '.') {
        s->start = s->at;
        sgt_formula_say(sgt_formula_blame(s->fault, sgt_scan_column(s)), "a number has one point");
    }
}

void sgt_scan_next(formula_scan *s)
{
    if (s->fault->found) {
        s->word = WORD_END;
        return;
    }
    while (is_blank(s->text[s->at])) s->at++;
    s->start = s->at;
    char c = s->text[s->at];
    if (c == 0) {
        s->word = WORD_END, s->length = 0;
    } else if ((c >= '0' && c <= '9') || c == '.') {
        scan_number(s);
    } else if (is_letter(c) || c == '_') {
        s->word = WORD_NAME;
        while (is_of_name(s->text[s->at])) s->at++;
        s->length = s->at - s->start;
    } else if (is_sign(c)) {
        s->word = c, s->at++, s->length = 1;
    } else {
        scan_foreign(s, c);
    }
    if (s->fault->found) s->word = WORD_END;
}

void sgt_scan_expected(const formula_scan *s, const char *expected)
{
    formula_fault *f = sgt_formula_say(sgt_formula_blame(s->fault, sgt_scan_column(s)), "expected ");
    f = sgt_formula_say(sgt_formula_say(f, expected), ", not ");
    if (s->word == WORD_END)
        sgt_formula_say(f, "the end");
    else
        sgt_formula_say_part(f, s->text + s->start, s->length);
}
