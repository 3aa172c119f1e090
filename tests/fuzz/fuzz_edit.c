// SPDX-License-Identifier: MIT
/* fuzz_edit.c - bytes as edits of a lens.
 *
 * Each line is an edit: a letter for its kind, a path, and behind the first = what it needs: a value, or the
 * last surface of a reversal.  What is in front of a byte 0xff is a lens file; without one the lens is that
 * below.
 *
 * After an edit that is accepted the lens is finite and legal, written as YAML it reads back as the same
 * elements, and is written again byte for byte.  One that is refused says why, and the lens is written as
 * before. All memory comes back. */
#include "lens.h"

#include <sagitta/edit.h>

static const char lens_text[] =
    "wavelengths: [F, 0.5876]\nprimary: 2\npupil: {semi_diameter: 5}\nfields: [0, [1, 2]]\nsurfaces:\n"
    "  - {type: sphere, radius: 60, thickness: 6, index: 1.5, name: front, stop: true}\n"
    "  - {type: break, tilt: [1, 2, 3], thickness: 0}\n"
    "  - {type: conic, radius: {pickup: \"surfaces[1].radius\", scale: -1}, thickness: 3, index: [1.6, "
    "1.7]}\n"
    "  - {type: sum, curvature: -0.01, terms: [{type: odd_asphere, coefficients: [0, 0, 1e-6]}], thickness: "
    "{solve: paraxial_focus}, index: 1}\n"
    "  - {type: plane}\n";

static const sgt_lens_options options = {.allocator = &counted};

static char *copy_of(const char *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text) exit(2);
    memcpy(text, data, size), text[size] = 0;
    return text;
}

static char *written(sgt_lens *l)
{
    size_t length;
    const char *text = sgt_lens_yaml(l, &length);
    REQUIRE(text, "%zu surfaces", l->count);
    return copy_of(text, length);
}

static void require_refused(sgt_lens *l, const char *before, const sgt_error *e, const char *path)
{
    char *after = written(l);
    REQUIRE(*e->words && e->words[strlen(e->words) - 1] != '.', "%s: %s", path, e->words);
    REQUIRE(strcmp(before, after) == 0, "%s\n%s", before, after);
    free(after);
}

static void require_accepted(sgt_lens *l)
{
    sgt_error e;
    char *text = written(l);
    require_lens(l);
    require_again(l, "text", &options);
    sgt_lens *again = sgt_lens_read_text("text", text, strlen(text), &options, &e);
    char *second = again ? written(again) : NULL;
    REQUIRE(second && strcmp(text, second) == 0, "%s\n%s", text, second ? second : e.words);
    sgt_lens_free(again);
    free(second);
    free(text);
}

static void apply(sgt_lens *l, char *line)
{
    static const char kinds[] = "stirvx";
    const char *kind = *line ? strchr(kinds, *line) : NULL;
    if (!kind) return;
    char *value = strchr(line, '=');
    if (value) *value++ = 0;
    sgt_edit edit = {.kind = (sgt_edit_kind)(kind - kinds), .path = line + 1, .text = value ? value : ""};
    edit.number = strtod(edit.text, NULL);
    sgt_error e = {0};
    char *before = written(l);
    double x;
    size_t size = sgt_lens_get_text(l, edit.path, 0, NULL, &e);
    REQUIRE(!sgt_lens_get(l, edit.path, &x, &e) || size != SIZE_MAX || strstr(edit.path, "r"), "%s",
            edit.path);
    if (sgt_lens_edit(l, 1, &edit, &e))
        require_accepted(l);
    else
        require_refused(l, before, &e, edit.path);
    free(before);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *behind = size ? memchr(data, 0xff, size) : NULL;
    const size_t length = behind ? (size_t)(behind - data) : 0, from = behind ? length + 1 : 0;
    char *text = behind ? copy_of((const char *)data, length) : copy_of(lens_text, sizeof lens_text - 1);
    char *edits = copy_of((const char *)data + from, size - from);
    sgt_lens *l = sgt_lens_read_text("text", text, strlen(text), &options, NULL);
    for (char *line = edits, *end; l && line; line = end ? end + 1 : NULL) {
        end = strchr(line, '\n');
        if (end) *end = 0;
        apply(l, line);
    }
    sgt_lens_free(l);
    free(edits);
    free(text);
    REQUIRE(blocks_held == 0, "%ld blocks", blocks_held);
    return 0;
}
