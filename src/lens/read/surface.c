// SPDX-License-Identifier: MIT
/* surface.c - reads a surface from its YAML map, by the library's table.
 *
 * The keys are the names of the parameters in sgt_builtins, with their places and limits.  So a
 * type added there can be read here at once.  One convenience is added: instead of a `curvature`
 * the map may give the `radius`.  The parameter is then 1/radius, rounded once (0 for an
 * infinite radius).  In the same way `radius_x` stands for `curvature_x`.
 *
 * Two parameters of a type may lie in the same memory.  Then one is a short name for a part of
 * the other, and to give both is an error.  Conditions on several parameters are checked by the
 * type's `object` when all have been read.
 *
 * A table of numbers is a list of rows, or the name of a file (matrix.h), which is looked for
 * beside the lens file.  Rows of `coefficients` may end early: what is left out is 0.  In other
 * tables all rows are equally long. */
#include "surface.h"

#include "../../text/number.h"
#include "formula.h"
#include "matrix.h"
#include "../base/reader.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char CURVATURE[] = "curvature", RADIUS[] = "radius", COEFFICIENTS[] = "coefficients",
                  FORMULA[] = "formula";
enum { NAME_SIZE = 64, UNIT_SIZE = 64 };

/* The name of the radius that may stand for a curvature; "" for other parameters. */
static void radius_name(char name[NAME_SIZE], const char *parameter)
{
    size_t stem = strlen(CURVATURE);
    if (strncmp(parameter, CURVATURE, stem) == 0) snprintf(name, NAME_SIZE, "%s%s", RADIUS, parameter + stem);
    else name[0] = 0;
}

static bool not_read(const sgt_param *p, surface_rim rim)
{
    if (strcmp(p->name, "semi_diameter") == 0) return rim != SURFACE_OWN_RIM;
    return rim == SURFACE_TERM && (strcmp(p->name, CURVATURE) == 0 || strcmp(p->name, "conic") == 0);
}

/* "; types that have it: conic, even_asphere ..."; nothing if there is none. */
static void print_types_with(char text[], size_t size, const char *key, const char *own)
{
    enum { SHOWN = 3 };
    int count = 0;
    size_t length = 0;
    *text = 0;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        for (const sgt_param *p = b->params; p->name; p++) {
            if (strcmp(p->name, key) != 0 || strcmp(b->type, own) == 0) continue;
            if (count < SHOWN && length < size)
                length += (size_t)snprintf(text + length, size - length, "%s%s",
                                           count ? ", " : "; types that have it: ", b->type);
            count++;
        }
    if (count > SHOWN && length < size) snprintf(text + length, size - length, " ...");
}

static void refuse_key_of_others(source *s, const node *key, const char *own, const char *known)
{
    char types[200];
    print_types_with(types, sizeof types, key->text, own);
    if (*types) tree_fail(s, key->line, key->text, "unknown key%s; known here: %s", types, known);
}

static void check_keys(source *s, const node *map, const sgt_builtin *type, surface_rim rim,
                       const char *more, const char *others)
{
    char text[900];
    size_t left = 0;
    while (left < map->count && map->taken[left]) left++;
    if (left == map->count) return;
    size_t length = (size_t)snprintf(text, sizeof text, "type");
    for (const sgt_param *p = type->params; p->name && length < sizeof text; p++) {
        if (not_read(p, rim)) continue;
        char radius[NAME_SIZE];
        radius_name(radius, p->name);
        const char *or = *radius ? " or " : "";
        length += (size_t)snprintf(text + length, sizeof text - length, ", %s%s%s", p->name, or, radius);
    }
    if (length < sizeof text) snprintf(text + length, sizeof text - length, "%s%s", more, others);
    for (size_t i = 0; i < map->count; i++)
        if (!map->taken[i]) refuse_key_of_others(s, map->key[i], type->type, text);
    tree_finish(s, map, text);
}

/* What a surface is called elsewhere, in lower case, and what to write here; NULL: no such name is known. */
static const char *other_name(const char *name)
{
    static const struct { const char *names, *words; } other[] = {
        {" mirror ", "a mirror is a surface of any type, as {type: sphere, radius: -100, mirror: true}"},
        {" spherical ", "write sphere"},
        {" flat planar ", "write plane"},
        {" standard ", "write sphere, or conic"},
        {" parabola paraboloid parabolic hyperbola hyperboloid ellipse ellipsoidal conicoid ",
         "write conic, with `radius` and `conic`"},
        {" asphere aspheric aspherical evenasph ", "write even_asphere, or odd_asphere"},
        {" freeform xy polynomial xpolynom ", "write polynomial_xy, chebyshev or zernike"},
        {" cylindrical ", "write cylinder"},
        {" lens thin_lens thinlens paraxial perfect ", "an ideal lens is {type: ideal, focal_length: 50}"},
        {" stop aperture ", "a stop is a surface of any type, as {type: plane, stop: true}"},
        {" image object ", "it is a plane; the object is a key of the lens, object: {distance: 100}"},
        {" coordbrk coordinate_break ", "write break"},
        {" wgs84 earth globe ", "WGS84's ellipsoid is {type: geodetic_height}"},
        {" implicit equation gyroid sdf ",
         "any F(x, y, z) = 0 is {type: formula, f: \"...\"}, docs/formula.md"},
    };
    char word[34];
    const size_t length = strlen(name);
    if (length + 3 > sizeof word) return NULL;
    word[0] = word[length + 1] = ' ', word[length + 2] = 0;
    for (size_t i = 0; i < length; i++) {
        if (name[i] == ' ') return NULL;
        word[i + 1] = sgt_lower(name[i]);
    }
    for (size_t i = 0; length && i < sizeof other / sizeof *other; i++)
        if (strstr(other[i].names, word)) return other[i].words;
    return NULL;
}

static const sgt_builtin *type_of(source *s, const node *map)
{
    const node *n = tree_take(map, "type");
    if (!n)
        tree_fail(s, map->line, "type",
                      "missing; it says which surface this is, as {type: sphere, radius: 20}");
    const char *name = tree_read_text(s, n, "type");
    char known[900];
    size_t length = 0;
    const sgt_builtin *const several[] = {sgt_builtins(), s->options->types};
    for (int i = 0; i < 2; i++)
        for (const sgt_builtin *b = several[i]; b && b->type; b++) {
            if (strcmp(b->type, name) == 0) return b;
            if (length < sizeof known)
                length += (size_t)snprintf(known + length, sizeof known - length, "%s%s", length ? ", " : "",
                                           b->type);
        }
    static const char *const earth[] = {"geodetic_height", "level_gravity", "geoid"};
    for (int i = 0; i < 3; i++)
        if (strcmp(name, earth[i]) == 0)
            tree_fail(s, n->line, "type",
                      "%s: not available; it is one of sagitta_geo, which needs GeographicLib.  Install "
                      "libgeographiclib-dev (for a geoid proj-data, too), then meson setup --reconfigure and "
                      "build again", name);
    const char *const meant = other_name(name);
    if (meant)
        tree_fail(s, n->line, "type", "no surface is called \"%.60s\"; %s", name, meant);
    const char *near = "", *words = "";
    size_t least = strlen(name) / 3 + 1;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++) {
        piece own = {name, name + strlen(name)}, other = {b->type, b->type + strlen(b->type)};
        size_t apart = sgt_reader_distance(own, other);
        if (apart < least) near = b->type, words = "did you mean ", least = apart;
    }
    const size_t length_of_name = strlen(name); /* the beginning of a name: "geodetic" */
    for (const sgt_builtin *b = sgt_builtins(); b->type && !*near && length_of_name > 2; b++)
        if (strncmp(b->type, name, length_of_name) == 0) near = b->type, words = "did you mean ";
    for (int i = 0; i < 3 && !*near && length_of_name > 2; i++)
        if (strncmp(earth[i], name, length_of_name) == 0) near = earth[i], words = "did you mean ";
    tree_fail(s, n->line, "type", "no surface is called \"%.60s\"; %s%s%sthere are: %s, formula%s", name,
              words, near, *near ? "?  " : "", known, s->in_lens ? ", break, ideal" : "");
}

static double curvature_of(source *s, const node *n, const char *key)
{
    double radius = tree_read_number(s, n, key, NUMBER_MAYBE_INFINITE);
    if (isinf(radius)) return 0;
    if (radius == 0) tree_fail(s, n->line, key, "must not be zero; for a flat surface write .inf");
    if (isinf(1 / radius)) tree_fail(s, n->line, key, "too small: %.60s", n->text);
    return 1 / radius;
}

/* " (unit: 1/length^3)", of number i, j; nothing if it has no unit. */
static void print_unit(char text[UNIT_SIZE], sgt_param_unit u, int i, int j)
{
    int power = u.length + i * u.by_i + j * u.by_j;
    char exponent[12] = "", time[16] = "";
    if (abs(power) > 1) snprintf(exponent, sizeof exponent, "^%d", abs(power));
    if (u.time) snprintf(time, sizeof time, "/s^%d", -u.time);
    *text = 0;
    if (power) snprintf(text, UNIT_SIZE, " (unit: %slength%s%s)", power < 0 ? "1/" : "", exponent, time);
}

/* Checks the limits of the table; the message has them in words: "a whole number from 1 to 100". */
static void check_range(source *s, const node *n, const char *key, const sgt_param *p, int i, int j,
                        double x)
{
    bool whole = p->kind == SGT_PARAM_WHOLE;
    if (x >= p->lo && x <= p->hi && !(whole && x != floor(x))) return;
    char range[120], given[NUMBER_SIZE], unit[UNIT_SIZE];
    number_print(given, x, false);
    if (p->hi < DBL_MAX)
        snprintf(range, sizeof range, "%sfrom %.10g to %.10g", whole ? "a whole number " : "", p->lo, p->hi);
    else if (p->lo > -DBL_MAX) snprintf(range, sizeof range, "finite and at least %.10g", p->lo);
    else snprintf(range, sizeof range, "finite");
    print_unit(unit, p->unit, i, j);
    tree_fail(s, n->line, key, "must be %s%s, not %s", range, unit, given);
}

static double read_number(source *s, const node *n, const char *key, const sgt_param *p, int i, int j)
{
    double x = tree_read_number(s, n, key, NUMBER_ANY);
    check_range(s, n, key, p, i, j, x);
    return x;
}

/* "coefficients[3]" */
enum { KEY_SIZE = NAME_SIZE + 60 };
static void print_item(char key[KEY_SIZE], const char *list, size_t i)
{
    snprintf(key, KEY_SIZE, "%.*s[%zu]", NAME_SIZE + 24, list, i);
}

static void check_count(source *s, const node *n, const char *key, const char *what, size_t most)
{
    if (n->count == 0) tree_fail(s, n->line, key, "must hold at least one %s", what);
    if (n->count > most)
        tree_fail(s, n->line, key, "has %zu %ss; at most %zu are allowed", n->count, what, most);
}

/* A list, or row number `row` of a table. */
static void read_list(source *s, const node *n, const char *key, const sgt_param *p, size_t row,
                      double value[])
{
    size_t most = (size_t)p->count;
    bool exact = p->kind == SGT_PARAM_VECTOR;
    if (n->kind != NODE_LIST)
        tree_fail(s, n->line, key, "must be a list of %s%zu numbers", exact ? "" : "up to ", most);
    if (exact && n->count > 0 && n->count != most)
        tree_fail(s, n->line, key, "has %zu number%s; it must have %zu", n->count, n->count == 1 ? "" : "s",
                      most);
    check_count(s, n, key, "number", most);
    for (size_t i = 0; i < n->count; i++) {
        char item[KEY_SIZE];
        print_item(item, key, i);
        int at = (int)i;
        value[i] = p->kind == SGT_PARAM_TABLE ? read_number(s, n->item[i], item, p, (int)row, at)
                                        : read_number(s, n->item[i], item, p, at, 0);
    }
}

static sgt_numbers read_file(source *s, const node *n, const sgt_param *p)
{
    char why[MATRIX_WHY_SIZE];
    sgt_numbers t;
    if (!sgt_matrix_read(s, &t, tree_read_path(s, n, p->name), (size_t)p->count, why))
        tree_fail(s, n->line, p->name, "%s", why);
    for (size_t i = 0; i < t.rows * t.columns; i++)
        check_range(s, n, p->name, p, (int)(i / t.columns), (int)(i % t.columns), t.x[i]);
    return t;
}

static sgt_numbers read_table(source *s, const node *n, const sgt_param *p)
{
    if (n->kind == NODE_SCALAR && sgt_matrix_is_file(n->text)) return read_file(s, n, p);
    if (n->kind != NODE_LIST)
        tree_fail(s, n->line, p->name,
                      "must be a list of rows, like [[1, 2], [3, 4]], or a file, NAME.csv or NAME.npy");
    check_count(s, n, p->name, "row", (size_t)p->count);
    bool may_end_early = strcmp(p->name, COEFFICIENTS) == 0;
    sgt_numbers t = {.rows = n->count};
    char key[KEY_SIZE];
    for (size_t i = 0; i < n->count; i++) {
        const node *row = n->item[i];
        print_item(key, p->name, i);
        if (row->kind != NODE_LIST) tree_fail(s, row->line, key, "must be a row, a list of numbers");
        if (i > 0 && !may_end_early && row->count != t.columns)
            tree_fail(s, row->line, key, "has %zu number%s, but the rows before have %zu", row->count,
                          row->count == 1 ? "" : "s", t.columns);
        if (row->count > t.columns) t.columns = row->count;
        check_count(s, row, key, "number", (size_t)p->count);
    }
    double *x = tree_room(s, t.rows * t.columns, sizeof *x);
    for (size_t i = 0; i < n->count; i++) {
        print_item(key, p->name, i);
        read_list(s, n->item[i], key, p, i, x + i * t.columns);
    }
    t.x = x;
    return t;
}

static sgt_numbers read_numbers(source *s, const node *n, const sgt_param *p)
{
    if (p->kind == SGT_PARAM_TABLE) return read_table(s, n, p);
    double *x = tree_room(s, n->kind == NODE_LIST ? n->count : 0, sizeof *x);
    read_list(s, n, p->name, p, 0, x);
    return (sgt_numbers){x, 1, n->count};
}

/* The number of the word, from 1; the words in the table are separated by |. */
static int read_word(source *s, const node *n, const sgt_param *p)
{
    const char *given = tree_read_text(s, n, p->name), *word = p->words;
    for (int number = 1;; number++) {
        size_t length = strcspn(word, "|");
        if (strlen(given) == length && strncmp(given, word, length) == 0) return number;
        if (!word[length]) break;
        word += length + 1;
    }
    tree_fail(s, n->line, p->name, "must be one of %s, not \"%.60s\"", p->words, given);
}

/* The value of a parameter; key: the name it is given by.  NULL: it is not given, and key is nothing. */
static node *given_as(source *s, const node *map, const sgt_param *p, char key[NAME_SIZE])
{
    radius_name(key, p->name);
    node *n = tree_take(map, p->name), *reciprocal = *key ? tree_take(map, key) : NULL;
    if (n && reciprocal) tree_fail(s, reciprocal->line, key, "given beside %s; give one of the two", p->name);
    if (n && !reciprocal) snprintf(key, NAME_SIZE, "%s", p->name);
    return reciprocal ? reciprocal : n;
}

/* The memory of a parameter of the kind SGT_PARAM_TERMS. */
typedef struct term_list { const sgt_surface *of; size_t count; } term_list;

static size_t end_of(const sgt_param *p)
{
    switch (p->kind) {
    case SGT_PARAM_WHOLE: case SGT_PARAM_WORD: case SGT_PARAM_TRUTH: return p->offset + sizeof(int);
    case SGT_PARAM_LIST: case SGT_PARAM_TABLE: return p->offset + sizeof(sgt_numbers);
    case SGT_PARAM_TERMS: return p->offset + sizeof(term_list);
    case SGT_PARAM_REAL: case SGT_PARAM_VECTOR: break;
    }
    return p->offset + (size_t)p->count * sizeof(double);
}

static bool share_memory(const sgt_param *a, const sgt_param *b)
{
    return a->offset < end_of(b) && b->offset < end_of(a);
}

static void read_terms(source *s, const node *n, const sgt_builtin *b, const sgt_param *p,
                       char *self);

static void read_parameter(source *s, const node *map, const sgt_builtin *b, const sgt_param *p,
                           char *self)
{
    char key[NAME_SIZE];
    const node *n = given_as(s, map, p, key);
    if (!n) return;
    for (const sgt_param *q = b->params; q < p; q++)
        if (share_memory(p, q) && tree_take(map, q->name))
            tree_fail(s, n->line, key, "given beside %s, of which it is a part; give one of the two",
                      q->name);
    void *to = self + p->offset;
    if (strcmp(key, p->name) != 0) {
        double *value = to;
        *value = curvature_of(s, n, key);
        check_range(s, n, key, p, 0, 0, *value);
    } else if (p->kind == SGT_PARAM_TERMS) {
        read_terms(s, n, b, p, self);
    } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
        sgt_numbers *value = to;
        *value = read_numbers(s, n, p);
    } else if (p->kind == SGT_PARAM_WORD || p->kind == SGT_PARAM_TRUTH) {
        int *value = to;
        *value = p->kind == SGT_PARAM_WORD ? read_word(s, n, p) : tree_read_truth(s, n, key);
    } else if (p->count > 1) {
        read_list(s, n, key, p, 0, to);
    } else if (p->kind == SGT_PARAM_WHOLE) {
        int *value = to;
        *value = (int)read_number(s, n, key, p, 0, 0);
    } else {
        double *value = to;
        *value = read_number(s, n, key, p, 0, 0);
    }
}

/* Checks all parameters together, by the type's `object`.  The message has the line of the parameter to
 * blame, or, if that is missing, of the map. */
static void check_whole(source *s, const node *map, const sgt_builtin *b, const void *self)
{
    sgt_objection no = b->object ? b->object(self) : (sgt_objection){NULL, NULL};
    if (!no.reason) return;
    const sgt_param *p = b->params;
    while (p->name && strcmp(p->name, no.param) != 0) p++;
    char key[NAME_SIZE];
    const node *n = p->name ? given_as(s, map, p, key) : NULL;
    if (!n) snprintf(key, NAME_SIZE, "%s", no.param);
    /* the library says "not above 0", or "must be above 0" */
    bool negated = strncmp(no.reason, "not ", 4) == 0, must = negated || strncmp(no.reason, "must ", 5) == 0;
    const char *missing = n ? "" : must ? "missing; " : "missing, and so ";
    bool value = n && n->kind == NODE_SCALAR && (negated || strncmp(no.reason, "must be ", 8) == 0);
    const char *given = value && !strchr(no.reason, ':') ? n->text : "";
    tree_fail(s, (n ? n : map)->line, key, "%s%s%s%s%.60s", missing, negated ? "must be " : "",
                  no.reason + (negated ? 4 : 0), *given ? ", not " : "", given);
}

/* Checks the sum after each term, so that the message names the first term that the sum cannot have. */
static void read_terms(source *s, const node *n, const sgt_builtin *b, const sgt_param *p, char *self)
{
    if (n->kind != NODE_LIST)
        tree_fail(s, n->line, p->name,
                      "must be a list of surfaces, like [{type: odd_asphere, coefficients: [0, 1e-3]}]");
    check_count(s, n, p->name, "surface", (size_t)p->count);
    sgt_surface *term = tree_room(s, n->count, sizeof *term);
    term_list *terms = (void *)(self + p->offset);
    terms->of = term;
    for (size_t i = 0; i < n->count; i++) {
        const node *map = n->item[i];
        char key[KEY_SIZE];
        print_item(key, p->name, i);
        tree_map(s, map, key);
        const sgt_builtin *type = type_of(s, map);
        for (const sgt_param *q = type->params; q->name; q++)
            if (q->kind == SGT_PARAM_TERMS)
                tree_fail(s, map->line, key, "a %s cannot be a term of another", type->type);
        term[i] = sgt_read_surface(s, map, SURFACE_TERM, "", &type);
        terms->count = i + 1;
        sgt_objection no = b->object ? b->object(self) : (sgt_objection){NULL, NULL};
        if (no.reason && strcmp(no.param, p->name) == 0)
            tree_fail(s, map->line, key, "a surface of the type %s cannot be a term of a %s", type->type,
                          b->type);
    }
}

/* Some of the caller's types have a key `file` beside their numbers, and a call that completes them. */
static const char *complete(source *s, const node *map, const sgt_builtin *b, void *self)
{
    const sgt_lens_options *o = s->options;
    if (!o->complete || b->ops != o->file_ops) return "";
    const node *n = tree_take(map, "file");
    const char *path = n ? tree_read_path(s, n, "file") : NULL;
    const char *wrong = o->complete(o->context, b, self, path);
    if (wrong) tree_fail(s, (n ? n : map)->line, "file", "%s", wrong);
    return ", file";
}

sgt_surface sgt_read_surface(source *s, const node *map, surface_rim rim, const char *others,
                             const sgt_builtin **type)
{
    const node *named = tree_take(map, "type");
    if (named && named->kind == NODE_SCALAR && strcmp(named->text, FORMULA) == 0) {
        if (rim == SURFACE_TERM) tree_fail(s, named->line, "type", "a formula cannot be a term of a sum");
        return sgt_read_formula(s, map, rim, type);
    }
    const sgt_builtin *b = type_of(s, map);
    char *self = tree_room(s, 1, b->size);
    for (const sgt_param *p = b->params; p->name; p++) {
        if (not_read(p, rim)) continue;
        read_parameter(s, map, b, p, self);
    }
    check_keys(s, map, b, rim, complete(s, map, b, self), others);
    check_whole(s, map, b, self);
    if (b->prepare) b->prepare(self);
    *type = b;
    return (sgt_surface){.ops = b->ops, .self = self};
}
