// SPDX-License-Identifier: MIT
/* fuzz_formula.c - any bytes as a formula (sagitta/formula.h), in rooms of exact size and in shorter ones.
 *
 * The first bytes choose the kind, how many parameters there are, and how much shorter the other room is. The
 * rest is the text.  Whatever it is, reading writes nothing beyond the room (which is a block of its own, so
 * a sanitizer sees it), and there is a tape or an error: a sentence, and a column of the text.  A room of
 * sgt_formula_room is never too small.  A tape is what tape.h says of one.  At points, F in intervals
 * contains F in long double, but for the rounding of that.  The same values set again change nothing. */
#include "fuzz.h"

#include "../unit/tape_run.h"

enum { NAMES = 3, POINTS = 4 };
static const char *const names[NAMES] = {"a", "b", "k2"};

/* Reads in a room that is shorter by `less`.  NULL: there was an error, and it is one. */
static sgt_tape *read_in(const char *text, sgt_formula_kind kind, size_t n, const sgt_named given[],
                         size_t less, void **block, sgt_error *error)
{
    size_t size = sgt_formula_room(text, n), length = 0;
    size = size > less ? size - less : 0;
    *block = malloc(size ? size : 1);
    REQUIRE(*block, "out of memory");
    memset(error, 0xa5, sizeof *error);
    sgt_tape *tape = sgt_formula_read(text, kind, n, given, *block, size, error);
    if (tape) {
        REQUIRE((void *)tape == *block, "the tape is elsewhere");
        tape_check(tape);
        return tape;
    }
    while (length < sizeof error->words && error->words[length] >= ' ' && error->words[length] <= '~')
        length++;
    REQUIRE(length > 5 && length < sizeof error->words && error->words[length] == 0, "no sentence");
    REQUIRE(error->column <= strlen(text) + 1, "column %zu of %zu", error->column, strlen(text));
    return NULL;
}

/* F at a point, in intervals and in long double. */
static void judge(const sgt_tape *tape, const char *text, sgt_vec3 p)
{
    const long double point[3] = {(long double)p.x, (long double)p.y, (long double)p.z};
    if (tape->uniforms > TAPE_UNIFORMS) return;
    long double v = tape_value(tape, point);
    sgt_interval r = tape_interval(tape, p);
    long double width = (long double)r.hi - (long double)r.lo;
    if (isnan(v) || isinf(v)) return;
    /* what is empty, long double takes for defined by its rounding; and both ends may be at one infinity */
    if (!(r.lo <= r.hi) || isnan(width)) return;
    REQUIRE(v >= (long double)r.lo - 0.1L * width - 0x1p-1074L &&
                v <= (long double)r.hi + 0.1L * width + 0x1p-1074L,
            "%s at %a, %a, %a: %.20Lg is not in [%a, %a]", text, p.x, p.y, p.z, v, r.lo, r.hi);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double values[NAMES] = {0.5, -3, 2}, at[POINTS] = {0, 1, -0.7, 2.25};
    bytes b = {.at = data, .left = size};
    unsigned what = take_byte(&b);
    size_t n = what >> 1 & 3, less = 1 + take_bits(&b, 2) % 8192;
    sgt_formula_kind kind = what & 1 ? SGT_FORMULA_XY : SGT_FORMULA_XYZ;
    sgt_named given[NAMES];
    sgt_error error, other_error;
    void *room, *short_room;
    for (size_t i = 0; i < n; i++) given[i] = (sgt_named){names[i], what & 8 ? take_number(&b) : values[i]};
    bool finite = true;
    for (size_t i = 0; i < n; i++) finite = finite && isfinite(given[i].value);
    char *text = malloc(b.left + 1);
    REQUIRE(text, "out of memory");
    memcpy(text, b.at, b.left), text[b.left] = 0;
    sgt_tape *tape = read_in(text, kind, n, given, 0, &room, &error);
    REQUIRE(tape || !strstr(error.words, "the room is too small"), "%s: %s", text, error.words);
    REQUIRE(tape == NULL || finite, "a parameter is not finite");
    sgt_tape *other = read_in(text, kind, n, given, less, &short_room, &other_error);
    if (other) {
        REQUIRE(tape && other->steps == tape->steps && other->uniforms == tape->uniforms, "%s: another tape",
                text);
        REQUIRE(memcmp(other->step, tape->step, (size_t)tape->steps * sizeof *tape->step) == 0,
                "other steps");
    } else if (tape) {
        REQUIRE(other_error.column == 0 && strstr(other_error.words, "the room is too small"), "%s: %s", text,
                other_error.words);
    }
    if (tape) {
        double set[NAMES];
        for (size_t i = 0; i < n; i++) set[i] = given[i].value;
        for (int i = 0; i < POINTS * POINTS; i++) {
            double z = kind == SGT_FORMULA_XY ? 0 : at[(i + i / POINTS) % POINTS];
            judge(tape, text, (sgt_vec3){at[i % POINTS], at[i / POINTS], z});
        }
        size_t bytes_of = (size_t)tape->uniforms * sizeof *tape->value;
        sgt_interval *before = malloc(bytes_of + 1);
        REQUIRE(before, "out of memory");
        memcpy(before, tape->value, bytes_of);
        REQUIRE(sgt_formula_set(tape, set, NULL), "the same values are refused");
        REQUIRE(memcmp(before, tape->value, bytes_of) == 0, "%s: the same values, and other uniforms", text);
        for (size_t i = 0; i < n; i++) set[i] = 1.5 * (double)i - 1;
        REQUIRE(sgt_formula_set(tape, set, NULL), "other values are refused");
        tape_check(tape);
        judge(tape, text, (sgt_vec3){at[1], at[2], at[3]});
        free(before);
    }
    free(text), free(room), free(short_room);
    return 0;
}
