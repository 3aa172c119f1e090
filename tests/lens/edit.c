// SPDX-License-Identifier: MIT
/* edit.c - an edited lens is the lens of its written file: test_edit LENS...
 *
 *   - every number of every lens: asked, it is the number that is listed; set to itself it leaves every bit;
 *     set to another and back, too; written and read again the lens is the same;
 *   - random edits: after each the lens is that of its written file read anew, to the bit, or there is one
 *     clear error that names the path, and the lens is as it was;
 *   - the same with an allocator that fails at each place in turn: no memory is told, none is lost, and the
 *     lens is as it was;
 *   - what a path means, and what is said of one that means nothing;
 *   - a configuration is the lens with its values set, to the bit, and what edits do to its paths. */
#include "counted.h"

#include "require.h"
#include "same.h"

#include <math.h>
#include <stdlib.h>

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

typedef struct generator {
    uint64_t state;
} generator;

static uint64_t generate(generator *g) /* splitmix64 (Steele, Lea & Flood 2014) */
{
    uint64_t z = (g->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static double uniform(generator *g, double lo, double hi)
{
    return lo + (hi - lo) * ldexp((double)(generate(g) >> 11), -53);
}

static const sgt_lens_options options = {.allocator = &counted};

/* The lens is that of its written file. */
static void require_written(sgt_lens *lens, const char *what)
{
    size_t length, again;
    sgt_error e = {0};
    const char *text = sgt_lens_yaml(lens, &length);
    REQUIRE(text, "%s: %s", lens->file, what);
    if (!text) return;
    sgt_lens *anew = sgt_lens_read_text(lens->file, text, length, &options, &e);
    if (!anew) { /* its folder and name are those of the file, but a .zmx is no YAML */
        char name[300];
        snprintf(name, sizeof name, "%s.yaml", lens->file);
        anew = sgt_lens_read_text(name, text, length, &options, &e);
    }
    REQUIRE(anew, "%s: %s: line %zu: %s: %s", lens->file, what, e.line, e.key, e.words);
    if (!anew) return;
    const char *apart = difference(lens, anew);
    REQUIRE(!apart, "%s: %s: read anew, it differs in %s", lens->file, what, apart);
    const char *second = sgt_lens_yaml(anew, &again);
    REQUIRE(second && again == length && memcmp(text, second, length) == 0, "%s: %s: written again:\n%s\n%s",
            lens->file, what, text, second ? second : "");
    sgt_lens *third = second ? sgt_lens_copy(anew, &e) : NULL;
    apart = third ? difference(anew, third) : "all";
    REQUIRE(!apart, "%s: %s: a copy differs in %s", lens->file, what, apart);
    sgt_lens_free(third);
    sgt_lens_free(anew);
}

static void require_same(sgt_lens *a, const sgt_lens *b, const char *path, const char *what)
{
    const char *apart = difference(a, b);
    REQUIRE(!apart, "%s: %s: %s: it differs in %s", a->file, path, what, apart);
}

static char *written(sgt_lens *lens)
{
    size_t length;
    const char *text = sgt_lens_yaml(lens, &length);
    char *copy = text ? malloc(length + 1) : NULL;
    if (copy) memcpy(copy, text, length + 1);
    return copy;
}

static sgt_lens_path *paths_of(const sgt_lens *lens, size_t *count)
{
    *count = sgt_lens_paths(lens, 0, NULL);
    sgt_lens_path *all = malloc(*count * sizeof *all);
    if (!all) exit(2);
    REQUIRE(sgt_lens_paths(lens, *count, all) == *count, "%zu", *count);
    return all;
}

/* ------------------------------------------------------------- every number */

static void try_number(sgt_lens *lens, const sgt_lens *original, const sgt_lens_path *p)
{
    sgt_error e = {0};
    char text[80];
    double x;
    bool fine = sgt_lens_get(lens, p->path, &x, &e);
    REQUIRE(fine && alike(x, p->value), "%s: %s: %a and %a: %s", lens->file, p->path, x, p->value, e.words);
    REQUIRE(sgt_lens_get_text(lens, p->path, sizeof text, text, &e) < sizeof text, "%s: %s", p->path, text);
    fine = sgt_lens_set(lens, p->path, p->value, &e);
    REQUIRE(fine, "%s: %s: %s: %s", lens->file, p->path, e.key, e.words);
    require_same(lens, original, p->path, "set to itself");
    /* by its text in other digits */
    snprintf(text, sizeof text, isinf(x) ? x > 0 ? ".inf" : "-.inf" : "%.17g", x);
    fine = sgt_lens_set_text(lens, p->path, text, &e);
    REQUIRE(fine, "%s: %s: %s: %s", lens->file, p->path, e.key, e.words);
    require_same(lens, original, p->path, "set to its text");
    /* elsewhere, and back */
    const double other = x == 0 ? 1e-7 : x * (1 + 0x1p-30);
    if (sgt_lens_set(lens, p->path, other, &e)) {
        REQUIRE(sgt_lens_get(lens, p->path, &x, &e) && alike(x, other), "%s: %a", p->path, x);
        require_written(lens, p->path);
        fine = sgt_lens_set(lens, p->path, p->value, &e);
        REQUIRE(fine, "%s: %s: %s: %s", lens->file, p->path, e.key, e.words);
    } else {
        REQUIRE(strcmp(e.key, p->path) == 0 && *e.words, "%s: %s: %s: %s", lens->file, p->path, e.key,
                e.words);
    }
    require_same(lens, original, p->path, "set to another and back");
    /* what is no number of the file */
    fine = sgt_lens_set(lens, p->path, NAN, &e);
    REQUIRE(!fine && strcmp(e.key, p->path) == 0 && *e.words, "%s: %s: %s", p->path, e.key, e.words);
    require_same(lens, original, p->path, "refused");
}

static void test_numbers(const sgt_lens *original)
{
    size_t count;
    sgt_lens_path *all = paths_of(original, &count);
    REQUIRE(count >= original->count - 1, "%s: %zu numbers", original->file, count);
    sgt_lens *lens = sgt_lens_copy(original, NULL);
    if (!lens) exit(2);
    require_written(lens, "as it is");
    for (size_t i = 0; i < count; i++) try_number(lens, original, &all[i]);
    /* all at once */
    sgt_edit *edit = calloc(count, sizeof *edit);
    if (!edit) exit(2);
    for (size_t i = 0; i < count; i++) edit[i] = (sgt_edit){.path = all[i].path, .number = all[i].value};
    sgt_error e;
    REQUIRE(sgt_lens_edit(lens, count, edit, &e), "%s: %s: %s", lens->file, e.key, e.words);
    require_same(lens, original, "all", "set to themselves");
    require_written(lens, "all set to themselves");
    free(edit);
    free(all);
    sgt_lens_free(lens);
}

/* ------------------------------------------------------------- random edits */

static const char *const values[] = {"0",
                                     "-1",
                                     "1",
                                     "2.5",
                                     ".inf",
                                     "1e300",
                                     "-1e-300",
                                     "true",
                                     "false",
                                     "N-BK7",
                                     "air",
                                     "same",
                                     "SCHOTT N-SF6",
                                     "no such glass",
                                     "[1, 2]",
                                     "[0, 0, 1]",
                                     "[]",
                                     "{}",
                                     "{nd: 1.5, vd: 60}",
                                     "{type: sphere, radius: 30}",
                                     "{type: break, tilt: [1, 0, 0], thickness: 0}",
                                     "\"a text\"",
                                     "[[0, 1], [2, 3]]",
                                     "{a: [b",
                                     "",
                                     "d",
                                     "F",
                                     "{semi_diameter: 1}",
                                     "plane",
                                     "conic",
                                     "even_asphere",
                                     "&a [*a]",
                                     "{solve: paraxial_focus}",
                                     "{solve: paraxial_focus, offset: -0.5}",
                                     "{pickup: \"surfaces[1].radius\"}",
                                     "{pickup: \"surfaces[2].thickness\", scale: 0.5, offset: 1}",
                                     "{pickup: \"surfaces[3].glass\"}",
                                     "{pickup: \"surfaces[2].radius\", scale: -1}",
                                     "{pickup: \"surfaces[1].curvature\"}",
                                     "{pickup: \"breaks[1].tilt[1]\"}",
                                     "{pickup: \"no path\"}",
                                     "{solve: no_such}",
                                     "517642",
                                     "angle",
                                     "object_height"};
static const char *const keys[] = {"thickness", "radius",   "curvature",  "conic", "coefficients",
                                   "glass",     "index",    "mirror",     "stop",  "semi_diameter",
                                   "tilt",      "decenter", "type",       "name",  "apertures",
                                   "draw_to",   "origin",   "no_such_key"};
static const char *const places[] = {"fields",
                                     "fields[1]",
                                     "fields[2]",
                                     "field_type",
                                     "wavelengths",
                                     "wavelengths[1]",
                                     "primary",
                                     "pupil.f_number",
                                     "pupil.semi_diameter",
                                     "pupil",
                                     "object.distance",
                                     "object.index",
                                     "object",
                                     "aim",
                                     "afocal",
                                     "makers",
                                     "makers[1]",
                                     "units",
                                     "name",
                                     "surfaces",
                                     "surfaces[1]",
                                     "surfaces[2]",
                                     "breaks[1]",
                                     "vignetting",
                                     "wavelength_weights",
                                     "field_weights[1]",
                                     "surfaces[99]",
                                     "surfaces[\"no such name\"]",
                                     "",
                                     ".",
                                     "[1]",
                                     "surfaces[0]",
                                     "surfaces[1",
                                     "surfaces..x",
                                     "surfaces[1].terms[1].x.y"};

static const char *const entries[] = {
    "{type: plane, thickness: 1, glass: air}",
    "{type: sphere, radius: 40, thickness: 3, glass: N-BK7, semi_diameter: 5}",
    "{type: conic, radius: {pickup: \"surfaces[1].radius\", scale: -2}, thickness: 2, glass: air}",
    "{type: plane, thickness: {solve: paraxial_focus}, glass: air}",
    "{type: break, tilt: [0, 3, 0], thickness: {pickup: \"surfaces[1].thickness\"}}",
    ("{type: sum, radius: 90, thickness: 1, glass: {pickup: \"surfaces[1].glass\"}, "
     "terms: [{type: odd_asphere, coefficients: [0, 0, 1e-4]}]}"),
    "{type: formula, sag: \"0.01*r^2\", thickness: 1, glass: same, semi_diameter: 4}",
    "{type: ideal, focal_length: 50, thickness: 1, glass: air}"};

static double random_number(generator *g, double x)
{
    switch (generate(g) % 6) {
    case 0:
        return x * uniform(g, 0.5, 2);
    case 1:
        return x + uniform(g, -1, 1);
    case 2:
        return -x;
    case 3:
        return uniform(g, -100, 100);
    case 4:
        return ldexp(uniform(g, -1, 1), (int)(generate(g) % 2000) - 1000);
    default:
        return x * (1 + uniform(g, -1e-3, 1e-3));
    }
}

static const char *random_of(generator *g, size_t count, const char *const of[])
{
    return of[generate(g) % count];
}

/* One edit of a lens; its paths go to `room` and `other`. */
static sgt_edit random_edit(generator *g, const sgt_lens *lens, size_t count, const sgt_lens_path all[],
                            char room[SGT_PATH_SIZE], char other[SGT_PATH_SIZE])
{
    const unsigned kind = (unsigned)(generate(g) % 12);
    const size_t place = 1 + generate(g) % lens->count;
    if (kind < 4 && count) { /* a number that is there */
        const sgt_lens_path *p = &all[generate(g) % count];
        snprintf(room, SGT_PATH_SIZE, "%s", p->path);
        return (sgt_edit){.path = room, .number = random_number(g, p->value)};
    }
    if (kind == 8) {
        snprintf(room, SGT_PATH_SIZE, "surfaces[%zu]", place + generate(g) % 2);
        return (sgt_edit){
            .kind = SGT_EDIT_INSERT, .path = room, .text = random_of(g, COUNT_OF(entries), entries)};
    }
    if (kind == 9) {
        snprintf(room, SGT_PATH_SIZE, generate(g) % 4 ? "surfaces[%zu]" : "surfaces[%zu].semi_diameter",
                 place);
        return (sgt_edit){.kind = SGT_EDIT_REMOVE, .path = room};
    }
    if (kind == 10) {
        snprintf(room, SGT_PATH_SIZE, "surfaces[%zu]", place);
        snprintf(other, SGT_PATH_SIZE, "surfaces[%zu]", place + generate(g) % (lens->count - place + 1));
        return (sgt_edit){.kind = SGT_EDIT_REVERSE, .path = room, .text = other};
    }
    if (kind == 11) {
        *room = 0;
        return (sgt_edit){
            .kind = SGT_EDIT_SCALE, .path = room, .number = ldexp(1, (int)(generate(g) % 5) - 2)};
    }
    if (kind < 6)
        snprintf(room, SGT_PATH_SIZE, "surfaces[%zu].%s", place, random_of(g, COUNT_OF(keys), keys));
    else if (kind < 7 || !count)
        snprintf(room, SGT_PATH_SIZE, "%s", random_of(g, COUNT_OF(places), places));
    else
        snprintf(room, SGT_PATH_SIZE, "%s", all[generate(g) % count].path);
    if (generate(g) % 4 == 0) return (sgt_edit){.path = room, .number = random_number(g, 10)};
    return (sgt_edit){
        .kind = SGT_EDIT_SET_TEXT, .path = room, .text = random_of(g, COUNT_OF(values), values)};
}

/* What undoes an edit to the bit: a reversal is its own inverse, and a scale by a power of two has one. */
static void require_undone(sgt_lens *lens, const sgt_lens *was, const sgt_edit *edit)
{
    sgt_edit back = *edit;
    sgt_error e;
    if (edit->kind != SGT_EDIT_REVERSE && edit->kind != SGT_EDIT_SCALE) return;
    if (edit->kind == SGT_EDIT_SCALE) back.number = 1 / edit->number;
    sgt_lens *copy = sgt_lens_copy(lens, NULL);
    if (!copy) exit(2);
    REQUIRE(sgt_lens_edit(copy, 1, &back, &e), "%s: %s: %s", lens->file, edit->path, e.words);
    const char *apart = difference(copy, was);
    size_t length;
    if (apart && strcmp(apart, "a glass") == 0)
        apart = NULL; /* `same` has been said by its name; all indices agree */
    REQUIRE(!apart, "%s: %s ... %s: undone, it differs in %s\n%s", lens->file, edit->path,
            edit->text ? edit->text : "", apart, sgt_lens_yaml(lens, &length));
    sgt_lens_free(copy);
}

static void test_random(generator *g, const sgt_lens *original, long edits)
{
    long accepted = 0;
    sgt_lens *lens = sgt_lens_copy(original, NULL);
    if (!lens) exit(2);
    for (long i = 0; i < edits; i++) {
        if (i % 20 == 0) {
            sgt_lens_free(lens);
            lens = sgt_lens_copy(original, NULL);
            if (!lens) exit(2);
        }
        size_t count;
        sgt_lens_path *all = paths_of(lens, &count);
        char room[2][SGT_PATH_SIZE], other[2][SGT_PATH_SIZE];
        const size_t several = 1 + generate(g) % 8 / 7;
        const sgt_edit edit[] = {random_edit(g, lens, count, all, room[0], other[0]),
                                 random_edit(g, lens, count, all, room[1], other[1])};
        sgt_lens *was = sgt_lens_copy(lens, NULL);
        char *text = written(lens);
        if (!was || !text) exit(2);
        sgt_error e = {0};
        if (sgt_lens_edit(lens, several, edit, &e)) {
            accepted++;
            if (several == 1) require_undone(lens, was, edit);
            require_written(lens, room[0]);
        } else {
            REQUIRE(*e.words &&
                        (strcmp(e.key, room[0]) == 0 || (several == 2 && strcmp(e.key, room[1]) == 0)),
                    "%s: %s: \"%s\": \"%s\"", lens->file, room[0], e.key, e.words);
            require_same(lens, was, room[0], "refused");
            char *after = written(lens);
            REQUIRE(after && strcmp(after, text) == 0, "%s: %s: written differently", lens->file, room[0]);
            free(after);
        }
        free(text);
        free(all);
        sgt_lens_free(was);
    }
    REQUIRE(edits < 30 || accepted * 10 > edits, "%s: %ld of %ld", original->file, accepted, edits);
    sgt_lens_free(lens);
}

/* ---------------------------------------------------------------- no memory */

static void test_no_memory(const sgt_lens *original)
{
    size_t count;
    sgt_lens_path *all = paths_of(original, &count);
    sgt_lens *lens = sgt_lens_copy(original, NULL);
    if (!lens) exit(2);
    const sgt_edit edit = {.path = all[count / 2].path, .number = all[count / 2].value};
    sgt_error e;
    for (long n = 0;; n++) {
        const long kept = held;
        before_failure = n;
        bool fine = sgt_lens_edit(lens, 1, &edit, &e);
        bool all_of_it = before_failure > 0;
        before_failure = -1;
        if (fine && all_of_it) break;
        REQUIRE(fine || strstr(e.words, "no memory"), "%s: %ld: %s", lens->file, n, e.words);
        REQUIRE(fine || held == kept, "%s: %ld: %ld blocks", lens->file, n, held - kept);
        require_same(lens, original, "", "no memory");
    }
    for (long n = 0;; n++) {
        const long kept = held;
        before_failure = n;
        sgt_lens *copy = sgt_lens_copy(lens, &e);
        before_failure = -1;
        if (copy) {
            sgt_lens_free(copy);
            REQUIRE(held == kept, "%ld blocks", held - kept);
            break;
        }
        REQUIRE(strstr(e.words, "no memory") && held == kept, "%ld: %s", n, e.words);
    }
    before_failure = 0;
    char text[40];
    REQUIRE(sgt_lens_get_text(lens, all[0].path, sizeof text, text, &e) == SIZE_MAX, "%s", text);
    before_failure = -1;
    free(all);
    sgt_lens_free(lens);
}

/* ------------------------------------------------------------ what paths mean */

static const char doublet[] =
    "name: doublet\n"
    "wavelengths: [F, d, 0.6563]\nprimary: 2\npupil: {semi_diameter: 5}\nfields: [0, [1, 2]]\n"
    "surfaces:\n"
    "  - {type: sphere, radius: 60, thickness: 6, glass: N-BK7, name: front, stop: true}\n"
    "  - {type: break, tilt: [1, 2, 3], thickness: 0}\n"
    "  - {type: sphere, curvature: -0.02, thickness: 3, glass: N-SF5}\n"
    "  - {type: even_asphere, radius: -120, coefficients: [0, 1e-6], thickness: 90, glass: air, "
    "name: \"a.b]\"}\n"
    "  - {type: break, thickness: 1}\n"
    "  - {type: plane, name: front2}\n";

static void test_meaning(void)
{
    sgt_error e = {0};
    sgt_lens *l = sgt_lens_read_text("doublet", doublet, sizeof doublet - 1, &options, &e);
    REQUIRE(l, "%s: %s", e.key, e.words);
    if (!l) return;
    static const struct {
        const char *path;
        double value;
    } numbers[] = {{"surfaces[1].radius", 60},
                   {"surfaces[\"front\"].radius", 60},
                   {"surfaces['front'].radius", 60},
                   {"surfaces[front].radius", 60},
                   {"surfaces[2].thickness", 3},
                   {"surfaces[2].curvature", -0.02},
                   {"surfaces[2].radius", -50},
                   {"surfaces[1].curvature", 1.0 / 60},
                   {"breaks[1].tilt[2]", 2},
                   {"breaks[2].thickness", 1},
                   {"surfaces[3].coefficients[2]", 1e-6},
                   {"surfaces['a.b]'].radius", -120},
                   {"fields[1]", 0},
                   {"fields[2][2]", 2},
                   {"wavelengths[3]", 0.6563},
                   {"primary", 2},
                   {"pupil.semi_diameter", 5}};
    double x;
    for (size_t i = 0; i < COUNT_OF(numbers); i++)
        REQUIRE(sgt_lens_get(l, numbers[i].path, &x, &e) && alike(x, numbers[i].value), "%s: %a: %s",
                numbers[i].path, x, e.words);
    REQUIRE(sgt_lens_get(l, "wavelengths[2]", &x, &e) && alike(x, sgt_spectral_line("d")), "%a", x);
    static const struct {
        const char *path, *words;
    } wrong[] = {{"surfaces[5].radius", "there is no surface 5; there are 4"},
                 {"breaks[3].radius", "there is no break 3; there are 2"},
                 {"fields[3]", "there is no entry 3; there are 2"},
                 {"surfaces[0].radius", "no path: places count from 1, and [0].radius is none"},
                 {"surfaces[back].radius", "no surface is called \"back\""},
                 {"surfaces[1].conic", "not given in the file"},
                 {"surfaces[1].glass", "is no number"},
                 {"object.distance", "object is not given"},
                 {"surfaces.radius", "radius is no key here: a place in the list is missing, as [1]"},
                 {"name[1]", "no list, so it has no place in brackets"},
                 {"primary.x", "x is no key here: a single value stands in front of it"},
                 {"surfaces[1", "no path: [1 is no place and no name in brackets"},
                 {"", "no path: a key is missing at \"\"; write it as surfaces[3].thickness"}};
    for (size_t i = 0; i < COUNT_OF(wrong); i++)
        REQUIRE(!sgt_lens_get(l, wrong[i].path, &x, &e) && isnan(x) && strcmp(e.words, wrong[i].words) == 0 &&
                    strcmp(e.key, wrong[i].path) == 0 && strcmp(e.file, "doublet") == 0,
                "%s: %s: %s", wrong[i].path, e.key, e.words);
    /* rivals make room, and maps on the way are made */
    char text[200];
    REQUIRE(sgt_lens_set(l, "surfaces[2].radius", -50, &e) &&
                sgt_lens_get(l, "surfaces[2].curvature", &x, &e) && alike(x, -0.02),
            "%a: %s", x, e.words);
    REQUIRE(sgt_lens_get_text(l, "surfaces[2]", sizeof text, text, &e) < sizeof text &&
                strcmp(text, "{type: sphere, radius: -50, thickness: 3, glass: N-SF5}") == 0,
            "%s", text);
    REQUIRE(sgt_lens_set(l, "pupil.f_number", 4, &e) && l->pupil == SGT_PUPIL_F_NUMBER, "%s", e.words);
    REQUIRE(sgt_lens_set(l, "object.distance", 100, &e) && alike(l->object_distance, 100), "%s", e.words);
    REQUIRE(sgt_lens_set_text(l, "surfaces[1].index", "[1.6, 1.5, 1.4]", &e) &&
                alike(l->element[0].index, 1.5),
            "%s", e.words);
    REQUIRE(sgt_lens_set_text(l, "surfaces[1].glass", "N-SF6", &e), "%s", e.words);
    REQUIRE(sgt_lens_set(l, "surfaces[1].draw_to", 7, &e) && alike(l->surface[0].size, 7), "%s", e.words);
    require_written(l, "doublet");
    REQUIRE(!sgt_lens_set(l, "surfaces[2].thickness", NAN, &e) && e.line == 9 &&
                strcmp(e.key, "surfaces[2].thickness") == 0 &&
                strcmp(e.words, "must be finite, not .nan") == 0,
            "%zu: %s: %s", e.line, e.key, e.words);
    REQUIRE(!sgt_lens_set(l, "surfaces[2].conic", 1, &e) && strcmp(e.key, "surfaces[2].conic") == 0 &&
                strstr(e.words, "unknown key"),
            "%s: %s", e.key, e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].mirror", "true", &e) &&
                strncmp(e.words, "glass: must be left out", 23) == 0,
            "%s: %s", e.key, e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].glass", "N-BK8", &e) && strstr(e.words, "N-BK7"), "%s",
            e.words);
    sgt_glass glass; /* a name that several makers have */
    REQUIRE(sgt_lens_set_text(l, "surfaces[1].glass", "F2", &e) && sgt_lens_glass(l, 1, &glass, NULL) &&
                strcmp(glass.maker, "schott") == 0 && sgt_lens_set_text(l, "makers", "[CDGM]", &e) &&
                sgt_lens_glass(l, 1, &glass, NULL) && strcmp(glass.maker, "cdgm") == 0,
            "%s: %s", glass.maker, e.words);
    require_written(l, "another maker");
    const sgt_edit two[] = {{.kind = SGT_EDIT_SET_TEXT, .path = "surfaces[2].type", .text = "conic"},
                            {.path = "surfaces[2].conic", .number = -1}};
    REQUIRE(sgt_lens_edit(l, 2, two, &e) && strcmp(l->surface[1].type, "conic") == 0, "%s", e.words);
    sgt_lens_free(l);
    l = sgt_lens_read_surface("one", "{type: sphere, radius: 20}", &options, &e);
    REQUIRE(l && sgt_lens_get(l, "radius", &x, &e) && x == 20 && sgt_lens_set(l, "radius", 30, &e) &&
                sgt_lens_get(l, "radius", &x, &e) && x == 30 && !sgt_lens_set(l, "radius", 0, &e),
            "%a", x);
    sgt_lens_free(l);
}

/* ------------------------------------------------- pickups, solves, groups */

static const char relay[] =
    "wavelengths: [0.55]\nobject: {distance: 100}\npupil: {object_na: 0.05}\nfield_type: object_height\n"
    "fields: [0, 3]\nsurfaces:\n"
    "  - {type: sphere, radius: 60, thickness: 6, glass: N-BK7, name: front, stop: true}\n"
    "  - {type: conic, radius: {pickup: \"surfaces[1].radius\", scale: -1}, conic: -0.5, thickness: 4, "
    "glass: air}\n"
    "  - {type: even_asphere, radius: 80, coefficients: [0, 1e-6], thickness: "
    "{pickup: \"surfaces[1].thickness\"}, glass: {pickup: \"surfaces['front'].glass\"}}\n"
    "  - {type: sphere, curvature: {pickup: \"surfaces[2].radius\", scale: 2, offset: 60}, thickness: "
    "{solve: paraxial_focus, offset: 0.25}, glass: air}\n"
    "  - {type: plane}\n";

static double number_at(const sgt_lens *l, const char *path)
{
    sgt_error e;
    double x;
    REQUIRE(sgt_lens_get(l, path, &x, &e), "%s: %s", path, e.words);
    return x;
}

static void require_text(const sgt_lens *l, const char *path, const char *words)
{
    sgt_error e;
    char text[400];
    const size_t length = sgt_lens_get_text(l, path, sizeof text, text, &e);
    REQUIRE(length != SIZE_MAX && strcmp(text, words) == 0, "%s: %s, not %s", path, text, words);
}

/* Two lenses of the same numbers, one of which says some of them by others. */
static void test_expressions(void)
{
    sgt_error e = {0};
    sgt_first_order first;
    sgt_lens *l = sgt_lens_read_text("relay", relay, sizeof relay - 1, &options, &e);
    REQUIRE(l, "%s: %s", e.key, e.words);
    if (!l) return;
    REQUIRE(alike(number_at(l, "surfaces[2].radius"), -60) &&
                alike(number_at(l, "surfaces[3].thickness"), 6) &&
                alike(number_at(l, "surfaces[4].curvature"), 2 * -60 + 60),
            "%a", number_at(l, "surfaces[4].curvature"));
    REQUIRE(sgt_lens_set_text(l, "surfaces[4].radius", "{pickup: \"surfaces[3].radius\", scale: -1}", &e),
            "%s", e.words);
    REQUIRE(sgt_lens_first_order(l, NAN, &first, NULL, &e) && fabs(first.image + 0.25) < 1e-10, "%g: %s",
            first.image, e.words);
    REQUIRE(sgt_lens_set(l, "surfaces[1].radius", 55, &e) && alike(number_at(l, "surfaces[2].radius"), -55) &&
                sgt_lens_first_order(l, NAN, &first, NULL, &e) && fabs(first.image + 0.25) < 1e-10,
            "%g: %s", first.image, e.words);
    require_written(l, "relay");
    /* the numbers themselves give the same lens */
    sgt_lens *plain = sgt_lens_copy(l, &e);
    if (!plain) exit(2);
    static const char *const said[] = {"surfaces[2].radius", "surfaces[3].thickness", "surfaces[4].radius",
                                       "surfaces[4].thickness"};
    for (size_t i = 0; i < COUNT_OF(said); i++)
        REQUIRE(sgt_lens_set(plain, said[i], number_at(l, said[i]), &e), "%s", e.words);
    REQUIRE(sgt_lens_set_text(plain, "surfaces[3].glass", "N-BK7", &e), "%s", e.words);
    require_same(plain, l, "relay", "by its numbers");
    require_text(plain, "surfaces[2].radius", "-55");
    require_text(l, "surfaces[2].radius", "{pickup: \"surfaces[1].radius\", scale: -1}");
    sgt_lens_free(plain);
    /* surfaces come and go, and are meant as before */
    REQUIRE(sgt_lens_insert(l, "surfaces[1]", "{type: plane, thickness: 2, glass: air}", &e), "%s", e.words);
    require_text(l, "surfaces[3].radius", "{pickup: \"surfaces[2].radius\", scale: -1}");
    require_text(l, "surfaces[4].glass", "{pickup: \"surfaces['front'].glass\"}");
    REQUIRE(sgt_lens_insert(l, "surfaces[3]", "{type: break, thickness: 0}", &e), "%s", e.words);
    require_text(l, "surfaces[3].radius", "{pickup: \"surfaces[2].radius\", scale: -1}");
    REQUIRE(sgt_lens_remove(l, "surfaces[1]", &e) && sgt_lens_remove(l, "breaks[1]", &e), "%s", e.words);
    require_text(l, "surfaces[2].radius", "{pickup: \"surfaces[1].radius\", scale: -1}");
    REQUIRE(!sgt_lens_remove(l, "surfaces[1]", &e) &&
                strstr(e.words, "picks up surfaces[1].radius, which would"),
            "%s", e.words);
    REQUIRE(
        !sgt_lens_set_text(l, "surfaces[1].radius", "{pickup: \"surfaces[2].radius\"}", &e) &&
            strcmp(e.words, "needs itself: it needs surfaces[2].radius, which needs surfaces[1].radius") == 0,
        "%s", e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].radius", "{pickup: \"surfaces[1].radius\"}", &e) &&
                strcmp(e.words, "needs itself: it needs itself") == 0,
            "%s", e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].radius", "{pickup: \"surfaces[4].thickness\"}", &e) &&
                strstr(e.words, "needs itself"),
            "%s", e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].radius", "{solve: paraxial_focus}", &e) &&
                strcmp(e.words, "paraxial_focus is for a thickness") == 0,
            "%s", e.words);
    REQUIRE(!sgt_lens_set_text(l, "surfaces[1].conic", "{pickup: \"surfaces[9].conic\"}", &e) &&
                strcmp(e.words, "picks up surfaces[9].conic: there is no surface 9; there are 5") == 0,
            "%s", e.words);
    /* twice as large, all is */
    const double efl = first.efl;
    sgt_lens_path paths[40];
    const size_t count = sgt_lens_paths(l, 40, paths);
    REQUIRE(sgt_lens_scale(l, 2, &e) && sgt_lens_first_order(l, NAN, &first, NULL, &e) &&
                fabs(first.efl - 2 * efl) < 1e-12 * fabs(efl) && fabs(first.image + 0.5) < 1e-10 &&
                alike(number_at(l, "surfaces[3].coefficients[2]"), 1e-6 / 8) && alike(l->field[1].y, 6) &&
                alike(l->object_distance, 200) && alike(l->pupil_size, 0.05),
            "%g %g: %s", first.efl, efl, e.words);
    REQUIRE(sgt_lens_paths(l, 40, paths) == count, "%zu", count);
    require_written(l, "relay, twice as large");
    /* a group in air has its focal length both ways, and twice is as it was */
    sgt_lens *was = sgt_lens_copy(l, &e);
    if (!was) exit(2);
    REQUIRE(sgt_lens_set(l, "object.distance", INFINITY, &e) || true, "%s", e.words);
    REQUIRE(sgt_lens_reverse(l, "surfaces['front']", "surfaces[4]", &e) &&
                sgt_lens_first_order(l, NAN, &first, NULL, &e) &&
                fabs(first.efl - 2 * efl) < 1e-12 * fabs(efl) && strcmp(l->surface[3].name, "front") == 0 &&
                alike(number_at(l, "surfaces[4].radius"), -110),
            "%g %g: %s", first.efl, efl, e.words);
    require_text(l, "surfaces[3].radius", "{pickup: \"surfaces[4].radius\", scale: -1}");
    require_written(l, "relay, reversed");
    REQUIRE(sgt_lens_reverse(l, "surfaces[1]", "surfaces['front']", &e), "%s", e.words);
    require_same(l, was, "relay", "reversed twice");
    sgt_lens_free(was);
    sgt_lens_free(l);
}

/* ------------------------------------------------------------ configurations */

static const char zoom[] = "wavelengths: [F, d, C]\nprimary: 2\npupil: {semi_diameter: 3}\nfields: [0, 2]\n"
                           "surfaces:\n"
                           "  - {type: conic, radius: 60, thickness: 3, glass: N-BK7, conic: 0.1}\n"
                           "  - {name: gap, type: sphere, radius: -50, thickness: 5, glass: air}\n"
                           "  - {type: break, tilt: [1, 0, 0], thickness: 0}\n"
                           "  - {type: sphere, radius: -30, thickness: 2, glass: N-SF6}\n"
                           "  - {type: plane, thickness: {pickup: \"surfaces[2].thickness\", scale: 4},\n"
                           "     glass: air}\n"
                           "  - {type: plane}\n"
                           "configurations:\n"
                           "  - {name: one}\n"
                           "  - name: two\n"
                           "    \"surfaces[gap].thickness\": 7\n"
                           "    surfaces[3].curvature: -0.04\n"
                           "    breaks[1].tilt: [2, 0, 0]\n"
                           "    fields[2]: 3\n"
                           "    surfaces[1].conic: null\n"
                           "    pupil.f_number: 9\n"
                           "  - {\"surfaces[1].glass\": N-SF6}\n";

/* The lens of zoom's second configuration, by edits. */
static sgt_lens *by_edits(const sgt_lens *base)
{
    static const sgt_edit edits[] = {
        {.kind = SGT_EDIT_REMOVE, .path = "configurations"},
        {.path = "surfaces[2].thickness", .number = 7},
        {.path = "surfaces[3].curvature", .number = -0.04},
        {.kind = SGT_EDIT_SET_TEXT, .path = "breaks[1].tilt", .text = "[2, 0, 0]"},
        {.path = "fields[2]", .number = 3},
        {.kind = SGT_EDIT_REMOVE, .path = "surfaces[1].conic"},
        {.path = "pupil.f_number", .number = 9},
    };
    sgt_error e = {0};
    sgt_lens *lens = sgt_lens_copy(base, NULL);
    if (!lens) exit(2);
    REQUIRE(sgt_lens_edit(lens, COUNT_OF(edits), edits, &e), "%s: %s", e.key, e.words);
    return lens;
}

static void require_holds(const sgt_lens *l, const char *path, const char *text)
{
    char is[400];
    sgt_error e = {0};
    REQUIRE(sgt_lens_get_text(l, path, sizeof is, is, &e) < sizeof is && strstr(is, text),
            "%s: %s, not %s: %s", path, is, text, e.words);
}

/* Each is as it is read alone, and without memory nothing is lost. */
static void test_each(sgt_lens *l, const char *text, size_t length)
{
    for (size_t n = 1; n <= sgt_lens_configurations(l); n++) {
        sgt_lens_options own = options;
        sgt_error e = {0};
        own.configuration = (int)n;
        sgt_lens *read = sgt_lens_read_text("zoom", text, length, &own, &e), *made = NULL;
        REQUIRE(read, "%zu: %s: %s", n, e.key, e.words);
        for (long k = 0; !made; k++) {
            const long kept = held;
            before_failure = k;
            made = sgt_lens_configured(l, n, &e);
            before_failure = -1;
            REQUIRE(made || (held == kept && strstr(e.words, "no memory")), "%zu: %ld: %s", n, k, e.words);
        }
        if (read) require_same(read, made, "configuration", "read alone");
        require_written(made, "a configuration");
        REQUIRE(sgt_lens_configurations(made) == 0, "%zu", n);
        sgt_lens_free(read);
        sgt_lens_free(made);
    }
}

static void require_no_edit(sgt_lens *l, sgt_edit_kind kind, const char *path, const char *text,
                            const char *words)
{
    const sgt_edit edit = {.kind = kind, .path = path, .text = text, .number = 2};
    sgt_error e = {0};
    REQUIRE(!sgt_lens_edit(l, 1, &edit, &e) && strstr(e.words, words), "%s: %s, not %s", path, e.words,
            words);
}

static void test_configurations(void)
{
    sgt_error e = {0};
    sgt_lens *l = sgt_lens_read_text("zoom", zoom, sizeof zoom - 1, &options, &e);
    REQUIRE(l, "%s: %s", e.key, e.words);
    if (!l) return;
    REQUIRE(sgt_lens_configurations(l) == 3 && strcmp(sgt_lens_configuration_name(l, 2), "two") == 0 &&
                !*sgt_lens_configuration_name(l, 3) && !*sgt_lens_configuration_name(l, 4), "names");
    REQUIRE(sgt_lens_configuration_named(l, "two", &e) == 2 &&
                sgt_lens_configuration_named(l, "3", &e) == 3 &&
                !sgt_lens_configuration_named(l, "4", &e) && strstr(e.words, "2 two"),
            "%s", e.words);
    REQUIRE(!sgt_lens_configured(l, 0, &e) && !sgt_lens_configured(l, 4, &e) && strstr(e.words, "4"), "%s",
            e.words);
    sgt_lens *two = sgt_lens_configured(l, 2, &e), *other = by_edits(l);
    REQUIRE(two, "%s: %s", e.key, e.words);
    if (two) require_same(two, other, "configuration 2", "by edits");
    sgt_lens_free(two);
    sgt_lens_free(other);
    test_each(l, zoom, sizeof zoom - 1);
    require_written(l, "with configurations");
    require_no_edit(l, SGT_EDIT_REMOVE, "surfaces[3]", NULL, "which would be gone");
    require_no_edit(l, SGT_EDIT_REMOVE, "fields[1]", NULL, "sets fields[2]");
    require_no_edit(l, SGT_EDIT_SCALE, "", NULL, "scale one of them");
    require_no_edit(l, SGT_EDIT_REVERSE, "surfaces[3]", "surfaces[4]", "one of the surfaces");
    require_no_edit(l, SGT_EDIT_SET_TEXT, "surfaces[4].type", "break", "");
    require_no_edit(l, SGT_EDIT_SET_TEXT, "fields", "[0]", "configurations[2]: fields[2]: there is no");
    static const char plane[] = "{type: plane, thickness: 1, glass: air}";
    REQUIRE(sgt_lens_insert(l, "surfaces[3]", plane, &e), "%s", e.words);
    require_holds(l, "configurations[2]", "\"surfaces[4].curvature\": -0.04");
    require_holds(l, "configurations[2]", "\"surfaces[gap].thickness\": 7");
    require_holds(l, "configurations[3]", "\"surfaces[1].glass\": N-SF6");
    REQUIRE(sgt_lens_remove(l, "configurations[2]", &e) && sgt_lens_configurations(l) == 2, "%s", e.words);
    require_written(l, "with two configurations");
    sgt_lens_free(l);
}

int main(int count, char **files)
{
    const char *seed = getenv("SAGITTA_TEST_SEED"), *scale = getenv("SAGITTA_TEST_SCALE");
    generator g = {seed ? strtoull(seed, NULL, 0) : 1};
    const double edits = 1000 * (scale ? atof(scale) : 0.5) / (count > 1 ? count - 1 : 1);
    printf("SAGITTA_TEST_SEED=%llu, %.0f edits of each lens\n", (unsigned long long)g.state, ceil(edits));
    test_meaning();
    test_expressions();
    test_configurations();
    for (int i = 1; i < count; i++) {
        sgt_error e;
        sgt_lens *lens = sgt_lens_read(files[i], &options, &e);
        REQUIRE(lens, "%s:%zu: %s: %s", files[i], e.line, e.key, e.words);
        if (!lens) continue;
        test_numbers(lens);
        test_random(&g, lens, (long)ceil(edits));
        test_no_memory(lens);
        sgt_lens_free(lens);
    }
    REQUIRE(held == 0, "%ld blocks", held);
    printf("%d faults\n", faults);
    return faults != 0;
}
