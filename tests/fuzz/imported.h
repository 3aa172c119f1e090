// SPDX-License-Identifier: MIT
/* imported.h - bytes as a file of another program's lens.
 *
 * What is accepted is a sound lens (lens.h), and is written as YAML, which reads back as the same elements.
 * What is refused is refused with a line of the text.  Each remark has a keyword or none, words, and a line
 * of the text.  All memory comes back. */
#ifndef TESTS_FUZZ_IMPORTED_H
#define TESTS_FUZZ_IMPORTED_H
#include "lens.h"

static const char GLASSES[] = "maker,glass,formula,from_um,to_um,coefficients\n"
                              "SCHOTT,N-BK7,2,0.3,2.5,0 1.03961212 0.00600069867 0.231792344 0.0200179144\n"
                              "SCHOTT,N-SK16,2,0.3,2.5,0 1.03961212 0.00600069867 0.231792344 0.0200179144\n"
                              "SCHOTT,N-LAK9,2,0.3,2.5,0 1.03961212 0.00600069867 0.231792344 0.0200179144\n"
                              "SCHOTT,N-F2,2,0.3,2.5,0 1.03961212 0.00600069867 0.231792344 0.0200179144\n"
                              "OHARA,S-LAH64,2,0.3,2.5,0 1.03961212 0.00600069867 0.231792344 0.0200179144\n"
                              "SCHOTT,F2,101,0.3,2.5,2.5 0 0.02 0 0 0\n";

static const sgt_catalogue *glasses(void)
{
    static sgt_catalogue *c;
    sgt_error e = {0};
    if (c) return c;
    c = sgt_catalogue_new(NULL);
    REQUIRE(c && sgt_catalogue_add_text(c, "glasses.csv", GLASSES, sizeof GLASSES - 1, &e), "%zu: %s", e.line,
            e.words);
    return c;
}

/* At most so many lines, in any encoding. */
static size_t lines_in(const uint8_t *data, size_t size)
{
    size_t lines = 1;
    for (size_t i = 0; i < size; i++) lines += data[i] == '\n' || data[i] == '\r';
    return lines;
}

static void read_imported(const char *source, const uint8_t *data, size_t size)
{
    const sgt_lens_options options = {.allocator = &counted, .glasses = glasses()};
    char *text = malloc(size ? size : 1); /* so that a sanitizer sees a step too far */
    sgt_error e = {0};
    if (!text) return;
    if (size) memcpy(text, data, size);
    sgt_lens *l = sgt_lens_read_text(source, text, size, &options, &e);
    size_t lines = lines_in(data, size);
    if (l) {
        require_lens(l);
        for (size_t i = 0; i < l->count; i++)
            REQUIRE(l->surface[i].line >= 1 && l->surface[i].line <= lines, "%zu", l->surface[i].line);
        for (size_t i = 0; i < l->remarks; i++) {
            const sgt_lens_remark *r = &l->remark[i];
            REQUIRE(r->key && *r->words && r->line >= 1 && r->line <= lines, "%s:%zu: %s", r->key, r->line,
                    r->words);
        }
        require_again(l, "a.yaml", &options);
    } else {
        REQUIRE(*e.words && strcmp(e.file, source) == 0 && e.line >= 1 && e.line <= lines, "%s:%zu: %s: %s",
                e.file, e.line, e.key, e.words);
    }
    sgt_lens_free(l);
    free(text);
    REQUIRE(blocks_held == 0, "%ld blocks", blocks_held);
}

#endif
