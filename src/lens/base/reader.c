// SPDX-License-Identifier: MIT
/* reader.c - memory, lines, words, numbers, errors. */
#include "reader.h"

#include "../../text/number.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_MOST = 63 };

bool sgt_reader_fail(const reader *r, size_t line, const char *key, const char *words, ...)
{
    sgt_error *e = r->error;
    *e = (sgt_error){.line = line};
    size_t length = strlen(r->file), cut = length < sizeof e->file ? 0 : length - sizeof e->file + 1;
    memcpy(e->file, r->file + cut, length - cut);
    for (size_t i = 0; key[i] && i + 1 < sizeof e->key; i++) e->key[i] = key[i];
    va_list more;
    va_start(more, words);
    vsnprintf(e->words, sizeof e->words, words, more);
    va_end(more);
    return false;
}

char *sgt_reader_text(sgt_catalogue *c, piece text)
{
    return sgt_arena_text(&c->arena, text.begin, (size_t)(text.end - text.begin));
}

/* ------------------------------------------------------------------- text */

static bool blank(char c) { return c == ' ' || c == '\t'; }

/* Lines end with LF, CR LF or CR. */
bool sgt_reader_line(reader *r, piece *line)
{
    if (r->at == r->end) return false;
    const char *s = r->at;
    while (s < r->end && *s != '\n' && *s != '\r') s++;
    *line = (piece){r->at, s};
    r->whole = s < r->end;
    if (s + 1 < r->end && s[0] == '\r' && s[1] == '\n') s++;
    r->at = s < r->end ? s + 1 : s;
    r->line++;
    while (line->end > line->begin && blank(line->end[-1])) line->end--;
    return true;
}

piece sgt_reader_word(piece *rest)
{
    const char *s = rest->begin;
    while (s < rest->end && blank(*s)) s++;
    piece word = {s, s};
    while (word.end < rest->end && !blank(*word.end)) word.end++;
    rest->begin = word.end;
    return word;
}

bool sgt_reader_is(piece text, const char *word)
{
    size_t length = (size_t)(text.end - text.begin);
    return strlen(word) == length && memcmp(text.begin, word, length) == 0;
}

int sgt_reader_width(piece text)
{
    enum { SHOWN = 60 };
    if (text.end - text.begin <= SHOWN) return (int)(text.end - text.begin);
    int width = SHOWN;
    while (width > 0 && (text.begin[width] & 0xC0) == 0x80) width--; /* no half of a character */
    return width;
}

char sgt_lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c; }

bool sgt_reader_ends_in(const char *name, const char *ending)
{
    const size_t length = strlen(name), own = strlen(ending);
    if (length < own) return false;
    const char *at = name + length - own;
    while (*at && sgt_lower(*at) == *ending) at++, ending++;
    return !*at;
}

size_t sgt_reader_distance(piece a, piece b)
{
    size_t row[NAME_MOST + 1], m = (size_t)(a.end - a.begin), n = (size_t)(b.end - b.begin);
    if (m > NAME_MOST) m = NAME_MOST;
    if (n > NAME_MOST) n = NAME_MOST;
    for (size_t j = 0; j <= n; j++) row[j] = j;
    for (size_t i = 0; i < m; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t best = diagonal + (sgt_lower(a.begin[i]) != sgt_lower(b.begin[j]));
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j + 1] + 1 < best) best = row[j + 1] + 1;
            diagonal = row[j + 1], row[j + 1] = best;
        }
    }
    return row[n];
}

bool sgt_reader_number(piece word, double *value) { return number_read_decimal(word.begin, word.end, value); }

bool sgt_reader_whole(const reader *r, const char *key)
{
    static const char words[] = "the file ends in the middle of this line; is it cut off?";
    return r->whole || sgt_reader_fail(r, r->line, key, "%s", words);
}

bool sgt_reader_numbers(const reader *r, const char *key, piece rest, double value[], size_t *count)
{
    *count = 0;
    for (piece word = sgt_reader_word(&rest); word.begin < word.end; word = sgt_reader_word(&rest)) {
        if (*count == READER_COEFFICIENTS)
            return sgt_reader_fail(r, r->line, key, "more than %d numbers", READER_COEFFICIENTS);
        if (!sgt_reader_number(word, &value[*count]))
            return sgt_reader_fail(r, r->line, key, "\"%.*s\" is not a finite number",
                                   sgt_reader_width(word), word.begin);
        ++*count;
    }
    return sgt_reader_whole(r, key);
}
