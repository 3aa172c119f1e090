// SPDX-License-Identifier: MIT
/* zmx_field.c - the fields of a record of a .zmx file.  What is missing or wrong is told, with its number. */
#include "zmx.h"

#include <math.h>
#include <string.h>

piece sgt_zmx_field(zmx *z)
{
    z->field++;
    return sgt_reader_word(&z->rest);
}

piece sgt_zmx_needed(zmx *z)
{
    piece word = sgt_zmx_field(z);
    if (word.begin == word.end) tree_fail(z->s, z->lines.line, z->row->key, "field %u is missing", z->field);
    return word;
}

double sgt_zmx_number_in(zmx *z, piece word)
{
    double x;
    if (!sgt_reader_number(word, &x))
        tree_fail(z->s, z->lines.line, z->row->key, "field %u: \"%.*s\" is not a finite number", z->field,
                  sgt_reader_width(word), word.begin);
    return x;
}

double sgt_zmx_number(zmx *z) { return sgt_zmx_number_in(z, sgt_zmx_needed(z)); }

double sgt_zmx_number_or(zmx *z, double otherwise)
{
    piece word = sgt_zmx_field(z);
    return word.begin == word.end ? otherwise : sgt_zmx_number_in(z, word);
}

static size_t whole_in(zmx *z, piece word)
{
    double x = sgt_zmx_number_in(z, word);
    if (!(x >= 0 && x <= 1e9 && x == floor(x)))
        tree_fail(z->s, z->lines.line, z->row->key, "field %u: \"%.*s\" is no whole number from 0", z->field,
                  sgt_reader_width(word), word.begin);
    return (size_t)x;
}

size_t sgt_zmx_whole(zmx *z) { return whole_in(z, sgt_zmx_needed(z)); }

size_t sgt_zmx_whole_or(zmx *z, size_t otherwise)
{
    piece word = sgt_zmx_field(z);
    return word.begin == word.end ? otherwise : whole_in(z, word);
}

char *sgt_zmx_copy(zmx *z, piece text)
{
    return tree_text(z->s, text.begin, (size_t)(text.end - text.begin));
}

char *sgt_zmx_text(zmx *z)
{
    piece first = sgt_reader_word(&z->rest);
    return first.begin == first.end ? NULL : sgt_zmx_copy(z, (piece){first.begin, z->rest.end});
}

void sgt_zmx_tally(zmx *z, zmx_tally which, size_t line, const char *key)
{
    zmx_count *t = z->tally[which], *last = t + ZMX_KEYS - 1;
    while (t < last && t->count && strcmp(t->key, key) != 0) t++;
    if (t->count++ == 0) t->line = line, t->key = key;
}
