// SPDX-License-Identifier: MIT
/* seq_field.c - the words of a command of a sequence file.  What is missing or wrong is told, with its
 * number. */
#include "seq.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

bool sgt_seq_is(piece word, const char *small)
{
    const char *at = word.begin;
    while (at < word.end && *small && sgt_lower(*at) == *small) at++, small++;
    return at == word.end && !*small;
}

unsigned sgt_seq_asked(const seq *q) { return q->row->which & (SEQ_Z - 1); }

size_t sgt_seq_line(const seq *q) { return q->words ? q->word[0].line : q->line; }

const seq_word *sgt_seq_more(seq *q) { return q->next < q->words ? &q->word[q->next++] : NULL; }

seq_word sgt_seq_needed(seq *q)
{
    const seq_word *w = sgt_seq_more(q);
    if (!w) tree_fail(q->s, sgt_seq_line(q), q->row->name, "a value is missing behind it");
    return *w;
}

bool sgt_seq_number_of(piece word, double *x)
{
    enum { LONGEST = 60 };
    char text[LONGEST];
    const size_t length = (size_t)(word.end - word.begin);
    if (sgt_reader_number(word, x)) return true;
    if (length >= sizeof text) return false;
    for (size_t i = 0; i < length; i++) text[i] = sgt_lower(word.begin[i]) == 'd' ? 'e' : word.begin[i];
    return sgt_reader_number((piece){text, text + length}, x);
}

double sgt_seq_number_in(seq *q, const seq_word *w)
{
    double x;
    if (w->quoted || !sgt_seq_number_of(w->text, &x))
        tree_fail(q->s, w->line, q->row->name, "\"%.*s\" is not a finite number", sgt_reader_width(w->text),
                  w->text.begin);
    return x + 0; /* -0 becomes 0 */
}

double sgt_seq_number(seq *q)
{
    const seq_word w = sgt_seq_needed(q);
    return sgt_seq_number_in(q, &w);
}

size_t sgt_seq_whole(seq *q, size_t least)
{
    const seq_word w = sgt_seq_needed(q);
    const double x = sgt_seq_number_in(q, &w);
    if (!(x >= (double)least && x <= 1e6 && x == floor(x)))
        tree_fail(q->s, w.line, q->row->name, "\"%.*s\" is no whole number from %zu",
                  sgt_reader_width(w.text), w.text.begin, least);
    return (size_t)x;
}

char *sgt_seq_copy(seq *q, piece text)
{
    return tree_text(q->s, text.begin, (size_t)(text.end - text.begin));
}

char *sgt_seq_text(seq *q)
{
    size_t length = 1;
    for (size_t i = q->next; i < q->words; i++)
        length += 1 + (size_t)(q->word[i].text.end - q->word[i].text.begin);
    char *text = tree_room(q->s, length, 1), *at = text;
    for (const seq_word *w = sgt_seq_more(q); w; w = sgt_seq_more(q)) {
        const size_t own = (size_t)(w->text.end - w->text.begin);
        if (at > text) *at++ = ' ';
        if (own) memcpy(at, w->text.begin, own);
        at += own;
    }
    return text;
}

/* 587.5618 and -3 becomes 587.5618e-3, so that the double is the one next to 0.5875618. */
double sgt_seq_scaled(seq *q, const seq_word *w, int power)
{
    enum { LONGEST = 60 };
    const double x = sgt_seq_number_in(q, w);
    const char *e = w->text.begin;
    char text[LONGEST + 20];
    int own = 0;
    double y;
    while (e < w->text.end && sgt_lower(*e) != 'e' && sgt_lower(*e) != 'd') e++;
    for (const char *c = e + 1; c < w->text.end && own < 10000; c++)
        if (*c >= '0' && *c <= '9') own = 10 * own + (*c - '0');
    if (e + 1 < w->text.end && e[1] == '-') own = -own;
    if (e - w->text.begin < LONGEST) {
        snprintf(text, sizeof text, "%.*se%d", (int)(e - w->text.begin), w->text.begin, own + power);
        if (sgt_reader_number((piece){text, text + strlen(text)}, &y)) return y;
    }
    return x * pow(10, power);
}

void sgt_seq_set_word(seq *q, node *map, const char *key, size_t line, const char *text)
{
    tree_set(q->s, map, key, tree_word(q->s, line, text));
}

void sgt_seq_set_number(seq *q, node *map, const char *key, size_t line, double x)
{
    tree_set(q->s, map, key, tree_number(q->s, line, x));
}
