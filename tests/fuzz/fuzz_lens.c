// SPDX-License-Identifier: MIT
/* fuzz_lens.c - bytes as a lens file, and as one surface.
 *
 * What is accepted is finite and legal: a lens of it can be traced, and no surface of it is SGT_INVALID; it
 * is written as YAML, which reads back as the same elements.  What is refused is refused in words that name
 * a line of the text.  All memory comes back.  A file that the text names (a grid's) holds what stands in
 * the input behind its first byte 0xff, which no text has. */
#include "lens.h"

static const char SOURCE[] = "text";
static struct { char *data; size_t size; } file;

static const char *read_given(void *context, const char *path, char **text, size_t *length)
{
    (void)context, (void)path;
    if (!file.data) return "there is none";
    *text = file.data, *length = file.size;
    return NULL;
}

static const sgt_lens_options options = {.allocator = &counted, .read = read_given};

/* At most so many lines: YAML ends one at \r, at U+0085, U+2028 and U+2029 too. */
static size_t lines_of(const uint8_t *data, size_t size)
{
    size_t lines = 1;
    for (size_t i = 0; i + 1 < size; i++)
        lines += data[i] == '\n' || data[i] == '\r' || data[i] == 0x85 || data[i] == 0xa8 ||
                 data[i] == 0xa9 || data[i] == 0x28 || data[i] == 0x29;
    return lines;
}

static void require_message(const sgt_error *e, const uint8_t *data, size_t size)
{
    REQUIRE(*e->words && strcmp(e->file, SOURCE) == 0, "%s: %s", e->file, e->words);
    REQUIRE(e->line >= 1 && e->line <= lines_of(data, size), "line %zu of %zu: \"%s\"", e->line,
            lines_of(data, size), e->words);
    if (strcmp(e->words, "control characters are not allowed") != 0) return;
    size_t before = 1, i = 0;
    while (i < size && (data[i] >= 32 || data[i] == '\n' || data[i] == '\t') && data[i] < 127)
        before += data[i++] == '\n';
    REQUIRE(i == size || data[i] >= 127 || data[i] == '\r' || e->line == before, "line %zu", before);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *behind = size ? memchr(data, 0xff, size) : NULL;
    size_t length = behind ? (size_t)(behind - data) : size;
    char *text = malloc(length + 1);
    file.data = NULL;
    if (behind) {
        file.size = size - length - 1;
        file.data = malloc(file.size + 1);
        if (file.data) memcpy(file.data, behind + 1, file.size);
    }
    if (text) {
        memcpy(text, data, length), text[length] = 0;
        sgt_error e = {0};
        sgt_lens *l = sgt_lens_read_text(SOURCE, text, length, &options, &e);
        if (l) require_lens(l), require_again(l, SOURCE, &options);
        else require_message(&e, data, length);
        sgt_lens_free(l);
        l = sgt_lens_read_surface(SOURCE, text, &options, &e);
        if (l) require_surface(l->element[0].surface, l->surface[0].type, 0.1);
        else require_message(&e, data, length);
        sgt_lens_free(l);
    }
    free(text);
    free(file.data);
    REQUIRE(blocks_held == 0, "%ld blocks", blocks_held);
    return 0;
}
