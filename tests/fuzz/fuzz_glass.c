// SPDX-License-Identifier: MIT
/* fuzz_glass.c - bytes as a catalogue of glasses.
 *
 * The first byte says which form: .agf, .csv or .yml.  What is accepted is a catalogue of glasses without a
 * fault, each of which is found by its name and maker, and whose indices are positive or NaN.  What is
 * refused is refused with a line of the text, and leaves no glass.  All memory comes back. */
#include "fuzz.h"

#include <sagitta/lens.h>

static long blocks_held;

static void *counted_resize(void *context, void *block, size_t size)
{
    (void)context;
    blocks_held += (size != 0) - (block != NULL);
    if (size) return realloc(block, size);
    free(block);
    return NULL;
}

static void require_glass(const sgt_catalogue *c, size_t place)
{
    sgt_glass g, same;
    REQUIRE(sgt_catalogue_glass(c, place, &g), "%zu", place);
    sgt_error fault;
    REQUIRE(sgt_glass_sound(&g, &fault), "%s: %s", g.name, fault.words);
    REQUIRE(g.line > 0 && g.from > 0 && g.to >= g.from, "%s: line %zu, %a %a", g.name, g.line, g.from, g.to);
    const double um[] = {g.from, g.to, 0.5875618, 1e-300, 1e300};
    for (size_t i = 0; i < COUNT_OF(um); i++) {
        double n = sgt_glass_index(&g, um[i]);
        REQUIRE(isnan(n) || (n > 0 && isfinite(n)), "%s at %a: %a", g.name, um[i], n);
    }
    REQUIRE(sgt_glass_covers(&g, g.from) && !sgt_glass_covers(&g, -1), "%s", g.name);
    REQUIRE(sgt_catalogue_find(c, g.name, 1, &g.maker, &same, NULL), "%s", g.name);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const name[] = {"maker.agf", "a.csv", "maker/a.yml"};
    if (size == 0) return 0;
    const char *file = name[data[0] % COUNT_OF(name)];
    sgt_error e = {0};
    sgt_catalogue *c = sgt_catalogue_new(&(sgt_allocator){counted_resize, NULL});
    if (!c) return 0;
    size_t length = size - 1;
    char *text = malloc(length ? length : 1); /* so that a sanitizer sees a step too far */
    if (text) {
        memcpy(text, data + 1, length);
        if (sgt_catalogue_add_text(c, file, text, length, &e)) {
            size_t count = sgt_catalogue_count(c);
            REQUIRE(count > 0, "%s", file);
            for (size_t i = 0; i < count && i < 20; i++) require_glass(c, i);
        } else {
            REQUIRE(*e.words && strcmp(e.file, file) == 0 && e.line <= length, "%s:%zu: %s", e.file, e.line,
                    e.words);
            REQUIRE(sgt_catalogue_count(c) == 0, "%s", e.words);
        }
        sgt_glass g;
        REQUIRE(!sgt_catalogue_find(c, "no such glass", 0, NULL, &g, &e) && *e.words, "%s", e.words);
    }
    free(text);
    sgt_catalogue_free(c);
    REQUIRE(blocks_held == 0, "%ld blocks", blocks_held);
    return 0;
}
