// SPDX-License-Identifier: MIT
/* formula.c - reads a surface that is a formula (sagitta/formula.h) from its YAML map.
 *
 *     {type: formula, f: "x^4 + y^4 + z^4 = a", a: 1, inside: {ball: 1.6}}
 *     {type: formula, sag: "c*r^2/(1 + sqrt(1 - c^2*r^2))", c: 0.02, semi_diameter: 10}
 *
 * Every key that is not one of these is a parameter.  So a key that is misspelled would be taken for one: a
 * parameter that the formula does not name is refused, and so are the names of keys of lens files.  The same
 * holds of a function that is no surface, the `waves` of a phase. */
#include "formula.h"

#include "../base/reader.h"

#include <sagitta/formula.h>

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char KNOWN[] =
    "type, f or sag, inside, semi_diameter, and the parameters that the formula names",
    KNOWN_OF_WAVES[] = "order, waves, and the parameters that the formula names";

static bool is_reserved(const char *name)
{
    static const char *const keys[] = {"type", "f", "sag", "inside", "semi_diameter", "apertures", "draw_to",
                                       "name", "thickness", "index", "glass", "mirror", "stop", "decenter",
                                       "tilt", "origin", "phase"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (strcmp(keys[i], name) == 0) return true;
    return false;
}

static bool is_of_name(char c) { return isalnum((unsigned char)c) || c == '_'; }

/* Is the name a word of the text? */
static bool is_named(const char *text, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = text; length && (at = strstr(at, name)); at++)
        if (!(at > text && is_of_name(at[-1])) && !is_of_name(at[length])) return true;
    return false;
}

/* The corner `key` of the box: three numbers. */
static sgt_vec3 read_corner(source *s, const node *n, const char *key)
{
    double v[3] = {0, 0, 0};
    if (n->kind != NODE_LIST || tree_read_numbers(s, n, key, 3, v) != 3)
        tree_fail(s, n->line, key, "must be a list of three numbers");
    return (sgt_vec3){v[0], v[1], v[2]};
}

static void read_box(source *s, const node *n, sgt_formula *of)
{
    if (n->kind == NODE_LIST && n->count == 2) {
        of->lo = read_corner(s, n->item[0], "inside: box[0]"),
        of->hi = read_corner(s, n->item[1], "inside: box[1]");
    } else {
        if (n->kind != NODE_LIST || n->count != 3)
            tree_fail(s, n->line, "inside: box",
                      "must be the three half sides, [1, 1, 2], or two corners, [[-1, -1, 0], [1, 1, 4]]");
        of->hi = read_corner(s, n, "inside: box"), of->lo = (sgt_vec3){-of->hi.x, -of->hi.y, -of->hi.z};
    }
    if (!(of->lo.x < of->hi.x && of->lo.y < of->hi.y && of->lo.z < of->hi.z))
        tree_fail(s, n->line, "inside: box", "must be larger than 0 in each direction");
}

static void read_inside(source *s, const node *n, sgt_formula *of)
{
    if (n->kind != NODE_MAP) tree_fail(s, n->line, "inside", "must be a map: {ball: 2} or {box: [1, 1, 2]}");
    tree_map(s, n, "inside");
    const node *ball = tree_take(n, "ball"), *box = tree_take(n, "box");
    if (!ball && !box)
        tree_fail(s, n->line, "inside", "must have a ball or a box: {ball: 2} or {box: [1, 1, 2]}");
    if (ball) {
        of->ball = tree_read_number(s, ball, "inside: ball", NUMBER_FINITE);
        if (!(of->ball > 0))
            tree_fail(s, ball->line, "inside: ball", "must be above 0, not %.60s", ball->text);
    }
    if (box) read_box(s, box, of);
    tree_finish(s, n, "ball, box");
}

/* All keys that are left. */
static size_t read_parameters(source *s, const node *map, const char *text, const char *known,
                              sgt_named **out)
{
    size_t n = 0;
    sgt_named *named = tree_room(s, map->count + 1, sizeof *named);
    for (size_t i = 0; i < map->count; i++) {
        const char *key = map->key[i]->text;
        if (map->taken[i]) continue;
        if (known == KNOWN && is_reserved(key))
            tree_fail(s, map->key[i]->line, key, "is a key of lens files, and no parameter");
        if (!is_named(text, key))
            tree_fail(s, map->key[i]->line, key, "the formula does not name it; known here: %s", known);
        map->taken[i] = true;
        named[n++] = (sgt_named){key, tree_read_number(s, map->item[i], key, NUMBER_FINITE)};
    }
    *out = named;
    return n;
}

/* self: of the surface.  The text and the parameters are kept beside it, since a tape cannot be read. */
static const sgt_tape *read_text(source *s, const node *map, const node *n, const char *key,
                                 sgt_formula_kind kind, const char *known, const void *self)
{
    const char *text = tree_read_text(s, n, key);
    sgt_named *named;
    size_t count = read_parameters(s, map, text, known, &named), size = sgt_formula_room(text, count);
    void *room = tree_room(s, (size + 7) / 8 + 1, 8);
    sgt_error e = {0};
    const sgt_tape *tape = sgt_formula_read(text, kind, count, named, room, size, &e);
    if (tape) {
        formula_text *kept = tree_room(s, 1, sizeof *kept);
        *kept = (formula_text){self, text, named, count, s->formula};
        s->formula = kept;
        return tape;
    }
    const char *hint = strstr(e.words, " is not known; there are ") ? "; a parameter is a key beside " : NULL;
    if (hint) tree_fail(s, n->line, key, "column %zu: %s%s%s, as in a: 1", e.column, e.words, hint, key);
    if (e.column) tree_fail(s, n->line, key, "column %zu: %s", e.column, e.words);
    tree_fail(s, n->line, key, "%s", e.words);
}

sgt_surface sgt_read_function(source *s, const node *map, const node *n, const char *key)
{
    const char *text = tree_read_text(s, n, key);
    if (is_named(text, "z")) {
        sgt_formula *self = tree_room(s, 1, sizeof *self);
        self->tape = read_text(s, map, n, key, SGT_FORMULA_XYZ, KNOWN_OF_WAVES, self);
        return (sgt_surface){&sgt_formula_ops, self};
    }
    sgt_formula_sag *self = tree_room(s, 1, sizeof *self);
    self->tape = read_text(s, map, n, key, SGT_FORMULA_XY, KNOWN_OF_WAVES, self);
    if (!is_named(text, "x") && !is_named(text, "y") && !is_named(text, "r"))
        tree_fail(s, n->line, key, "%.60s is the same everywhere: it names none of x, y, z and r", text);
    return (sgt_surface){&sgt_formula_sag_ops, self};
}

sgt_surface sgt_read_formula(source *s, const node *map, surface_rim rim, const sgt_builtin **type)
{
    static const sgt_builtin
        implicit = {.type = "formula", .ops = &sgt_formula_ops, .size = sizeof(sgt_formula),
                    .family = SGT_FAMILY_BODY},
        sag = {.type = "formula", .ops = &sgt_formula_sag_ops, .size = sizeof(sgt_formula_sag),
               .family = SGT_FAMILY_DEPARTURE};
    const node *f = tree_take(map, "f"), *of_sag = tree_take(map, "sag"), *inside = tree_take(map, "inside"),
               *semi = rim == SURFACE_OWN_RIM ? tree_take(map, "semi_diameter") : NULL;
    if (!f && !of_sag)
        tree_fail(s, map->line, "f", "missing; give f: \"x^2 + y^2 + z^2 = 1\", or sag: \"0.01*r^2\"");
    if (f && of_sag) tree_fail(s, of_sag->line, "sag", "given beside f; give one of the two");
    if (of_sag && inside) tree_fail(s, inside->line, "inside", "is for f; a sag has a semi_diameter");
    if (f && semi) tree_fail(s, semi->line, "semi_diameter", "is for a sag; with f give inside");
    if (f) {
        sgt_formula *self = tree_room(s, 1, sizeof *self);
        if (inside) read_inside(s, inside, self);
        self->tape = read_text(s, map, f, "f", SGT_FORMULA_XYZ, KNOWN, self);
        *type = &implicit;
        return (sgt_surface){&sgt_formula_ops, self};
    }
    sgt_formula_sag *self = tree_room(s, 1, sizeof *self);
    if (semi) self->semi_diameter = tree_read_number(s, semi, "semi_diameter", NUMBER_FINITE);
    if (!(self->semi_diameter >= 0))
        tree_fail(s, semi->line, "semi_diameter", "must be 0 or more, not %.60s", semi->text);
    self->tape = read_text(s, map, of_sag, "sag", SGT_FORMULA_XY, KNOWN, self);
    *type = &sag;
    return (sgt_surface){&sgt_formula_sag_ops, self};
}
