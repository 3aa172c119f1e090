// SPDX-License-Identifier: MIT
/* reader.h - what the readers of catalogues share: memory, lines, words, numbers, errors. */
#ifndef SGT_LENS_READER_H
#define SGT_LENS_READER_H
#include "arena.h"

/* A stretch of text, without a zero at its end. */
typedef struct piece { const char *begin, *end; } piece;

/* Texts and coefficients stay where they are until the catalogue is freed, so that glasses may
 * point to them. */
struct sgt_catalogue {
    arena         arena;
    sgt_glass    *glass;
    unsigned     *addition; /* of each glass: which call added it */
    size_t        count, room;
    unsigned      additions;
};

typedef struct reader {
    sgt_catalogue  *catalogue;
    const char     *file;
    sgt_error *error; /* never NULL */
    const char     *at, *end;
    size_t          line;  /* of the last that was read, from 1 */
    bool            whole; /* it has an end of line */
} reader;

enum { READER_COEFFICIENTS = 64 };

/* Fills in r->error; false. */
#ifdef __GNUC__
__attribute__((format(printf, 4, 5)))
#endif
bool sgt_reader_fail(const reader *r, size_t line, const char *key, const char *words, ...);

/* A copy that lasts as long as the catalogue; NULL: no memory. */
char *sgt_reader_text(sgt_catalogue *c, piece text);

/* A copy of text as UTF-8, whatever its encoding, of which *length is set; NULL: no memory. */
char *sgt_reader_decoded(arena *a, const char *text, size_t *length);

/* All of a file, in memory of the allocator: true if it could be read.  Else e says why. */
bool sgt_reader_file(const sgt_allocator *a, const char *path, char **text, size_t *length,
                     sgt_error *e);

/* The next line, without its end and the blanks after it; false: there is none. */
bool sgt_reader_line(reader *r, piece *line);

/* The first word of *rest, which is moved behind it; empty: there is none. */
piece sgt_reader_word(piece *rest);

bool sgt_reader_is(piece text, const char *word);

/* A capital letter of ASCII as a small one. */
char sgt_lower(char c);

/* Whether the name of a file has that ending, in either case of letters. */
bool sgt_reader_ends_in(const char *name, const char *ending);

/* Levenshtein's distance of two names, whatever the case of letters; long ones are cut. */
size_t sgt_reader_distance(piece a, piece b);

/* How much of it a message shows: for %.*s. */
int sgt_reader_width(piece text);

/* A finite decimal number, whatever the locale: sign, digits, point, exponent. */
bool sgt_reader_number(piece word, double *value);

/* A line that must be whole is; false: told, the file may be cut off. */
bool sgt_reader_whole(const reader *r, const char *key);

/* Numbers to the end of the line, at most READER_COEFFICIENTS; false: told. */
bool sgt_reader_numbers(const reader *r, const char *key, piece rest, double value[], size_t *count);

#endif
