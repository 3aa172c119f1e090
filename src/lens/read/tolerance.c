// SPDX-License-Identifier: MIT
/* tolerance.c - reads `tolerances` of a lens file: what is off, of which surfaces, and by how much.
 *
 * An entry has one of the keys of `kinds`, which says what is off.  Its value is the box: d for -d to d, or
 * [lower, upper].  What cannot be off is refused here, where the line is known: the radius of a flat surface,
 * the thickness behind the last one. */
#include "tolerance.h"

#include "../../text/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double GREEN = 0.5461; /* um, of the mercury line by which surfaces are tested */

static const char *const kinds[] = {[SGT_TOLERANCE_RADIUS] = "radius",
                                    [SGT_TOLERANCE_FRINGES] = "fringes",
                                    [SGT_TOLERANCE_THICKNESS] = "thickness",
                                    [SGT_TOLERANCE_DECENTER_X] = "decenter_x",
                                    [SGT_TOLERANCE_DECENTER_Y] = "decenter_y",
                                    [SGT_TOLERANCE_DECENTER_Z] = "decenter_z",
                                    [SGT_TOLERANCE_TILT_X] = "tilt_x",
                                    [SGT_TOLERANCE_TILT_Y] = "tilt_y",
                                    [SGT_TOLERANCE_TILT_Z] = "tilt_z",
                                    [SGT_TOLERANCE_INDEX] = "index",
                                    [SGT_TOLERANCE_IRREGULARITY] = "irregularity"};
enum { KINDS = sizeof kinds / sizeof *kinds };

static bool is_pose(sgt_tolerance_kind k)
{
    return k >= SGT_TOLERANCE_DECENTER_X && k <= SGT_TOLERANCE_TILT_Z;
}

static bool in_fringes(sgt_tolerance_kind k)
{
    return k == SGT_TOLERANCE_FRINGES || k == SGT_TOLERANCE_IRREGULARITY;
}

/* The map of a surface, from 1, among breaks. */
static const node *surface_map(const node *list, size_t number)
{
    for (size_t i = 0, k = 0; i < list->count; i++) {
        const node *type = tree_take(list->item[i], "type");
        const bool is_break = type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
        if (!is_break && ++k == number) return list->item[i];
    }
    return NULL;
}

/* A surface by its number, from 1, or by its name. */
static size_t surface_of(const whole_lens *w, source *s, const node *n, const char *key)
{
    const char *text = tree_read_text(s, n, key);
    long number;
    size_t found = 0;
    if (!n->quoted && number_read_integer(text, 1, (long)w->lens.count, &number)) return (size_t)number;
    for (size_t i = 0; i < w->lens.count; i++) {
        if (strcmp(w->about[i].name, text) != 0) continue;
        if (found)
            tree_fail(s, n->line, key, "surfaces %zu and %zu have the name \"%.60s\"", found, i + 1, text);
        found = i + 1;
    }
    if (!found)
        tree_fail(s, n->line, key, "must be a surface, from 1 to %zu or by its name, not \"%.60s\"",
                  w->lens.count, text);
    return found;
}

static void read_surfaces_of(const whole_lens *w, source *s, const node *map, sgt_tolerance *t)
{
    const node *one = tree_take(map, "surface"), *group = tree_take(map, "surfaces");
    if (one && group) tree_fail(s, group->line, "surfaces", "given beside surface; one of them is enough");
    if (one)
        t->first = t->last = surface_of(w, s, one, "surface");
    else if (!group)
        tree_fail(s, map->line, "surface", "missing; it says which surface is off");
    else {
        if (group->kind != NODE_LIST || group->count != 2)
            tree_fail(s, group->line, "surfaces", "must be the first and the last surface, like [2, 3]");
        t->first = surface_of(w, s, group->item[0], "surfaces");
        t->last = surface_of(w, s, group->item[1], "surfaces");
        if (t->first > t->last)
            tree_fail(s, group->line, "surfaces", "must be the first and the last, in order");
    }
    if (t->first != t->last && !is_pose(t->kind))
        tree_fail(s, group->line, "surfaces",
                  "%s is of one surface; several are decentred or tilted together", kinds[t->kind]);
}

static void read_ends(source *s, const node *n, const char *key, sgt_tolerance *t)
{
    double end[2];
    if (n->kind == NODE_LIST) {
        if (n->count != 2) tree_fail(s, n->line, key, "must be a number d, for -d to d, or [lower, upper]");
        tree_read_numbers(s, n, key, 2, end);
        if (!(end[0] < end[1])) tree_fail(s, n->line, key, "must rise, but is [%g, %g]", end[0], end[1]);
    } else {
        end[1] = tree_read_number(s, n, key, NUMBER_FINITE), end[0] = -end[1];
        if (!(end[1] > 0)) tree_fail(s, n->line, key, "must be positive, not %g", end[1]);
    }
    t->lower = end[0], t->upper = end[1];
}

static int choice_at(source *s, const node *n, const char *key, int count, const char *const word[])
{
    const char *given = tree_read_text(s, n, key);
    char all[100] = "";
    for (int i = 0; i < count; i++) {
        if (strcmp(given, word[i]) == 0) return i;
        const size_t at = strlen(all);
        snprintf(all + at, sizeof all - at, "%s%s", i ? i + 1 < count ? ", " : " or " : "", word[i]);
    }
    tree_fail(s, n->line, key, "must be %s, not \"%.60s\"", all, given);
}

static double positive_of(source *s, const node *n, const char *key)
{
    const double x = tree_read_number(s, n, key, NUMBER_FINITE);
    if (!(x > 0)) tree_fail(s, n->line, key, "must be positive, not %g", x);
    return x;
}

/* Keys that only some kinds have: NULL if it is not given. */
static const node *key_for(source *s, const node *map, const char *key, bool has, const char *which)
{
    const node *n = tree_take(map, key);
    if (n && !has) tree_fail(s, n->line, key, "goes with %s", which);
    return n;
}

static bool has_curvature(const source *s, const char *type)
{
    const sgt_builtin *const several[] = {sgt_builtins(), s->options->types};
    for (int i = 0; i < 2; i++)
        for (const sgt_builtin *b = several[i]; b && b->type; b++)
            for (const sgt_param *p = strcmp(b->type, type) == 0 ? b->params : NULL; p && p->name; p++)
                if (strcmp(p->name, "curvature") == 0) return true;
    return false;
}

static bool is_type(const char *type, const char *a, const char *b, const char *c)
{
    return strcmp(type, a) == 0 || strcmp(type, b) == 0 || strcmp(type, c) == 0;
}

/* The radius of a surface as its map gives it; infinite: flat. */
static double radius_of(source *s, const node *map)
{
    const node *radius = tree_take(map, "radius"), *curvature = tree_take(map, "curvature");
    if (radius) return tree_read_number(s, radius, "radius", NUMBER_MAYBE_INFINITE);
    return curvature ? 1 / tree_read_number(s, curvature, "curvature", NUMBER_FINITE) : HUGE_VAL;
}

/* Can it be off? */
static void check_kind(const whole_lens *w, source *s, const node *list, const node *n,
                       const sgt_tolerance *t)
{
    const sgt_lens_surface *about = &w->about[t->first - 1];
    const node *map = surface_map(list, t->first);
    const char *key = kinds[t->kind], *type = about->type;
    switch (t->kind) {
    case SGT_TOLERANCE_RADIUS: {
        if (!has_curvature(s, type)) tree_fail(s, n->line, key, "surface %zu (%s) has none", t->first, type);
        const double r = radius_of(s, map);
        if (isinf(r)) tree_fail(s, n->line, key, "surface %zu is flat; give fringes", t->first);
        if (!(r + t->lower > 0 || r + t->upper < 0))
            tree_fail(s, n->line, key, "the radius of surface %zu is %g, and would pass through 0", t->first,
                      r);
        return;
    }
    case SGT_TOLERANCE_FRINGES:
        if (!has_curvature(s, type) && strcmp(type, "plane") != 0)
            tree_fail(s, n->line, key, "surface %zu (%s) has no curvature", t->first, type);
        return;
    case SGT_TOLERANCE_IRREGULARITY:
        if (!is_type(type, "plane", "sphere", "conic"))
            tree_fail(s, n->line, key, "surface %zu is of type %s; it must be a plane, sphere or conic",
                      t->first, type);
        return;
    case SGT_TOLERANCE_THICKNESS:
        if (t->first == w->lens.count || tree_take(map, "origin"))
            tree_fail(s, n->line, key, "there is none behind surface %zu%s", t->first,
                      tree_take(map, "origin") ? ", which has an origin" : "");
        return;
    case SGT_TOLERANCE_INDEX:
        if (about->mirror || t->first == w->lens.count)
            tree_fail(s, n->line, key, "surface %zu is %s; the index is that behind a refracting surface",
                      t->first, about->mirror ? "a mirror" : "the last one");
        return;
    default:
        return; /* any surface has a place */
    }
}

static void read_fringes(const whole_lens *w, source *s, const node *map, const node *n, sgt_tolerance *t)
{
    const bool has = in_fringes(t->kind);
    const node *light = key_for(s, map, "wavelength", has, "fringes or irregularity");
    const node *over = key_for(s, map, "over", has, "fringes or irregularity");
    const node *term = key_for(s, map, "term", t->kind == SGT_TOLERANCE_IRREGULARITY, "irregularity");
    if (!has) return;
    t->wavelength = light ? positive_of(s, light, "wavelength") : GREEN;
    t->over = over ? positive_of(s, over, "over") : w->about[t->first - 1].size;
    if (!(t->over > 0))
        tree_fail(s, n->line, "over",
                  "missing; surface %zu has neither semi_diameter nor draw_to, so say over "
                  "which radius there are so many fringes",
                  t->first);
    if (isnan(sgt_lens_unit(&w->lens)))
        tree_fail(s, n->line, kinds[t->kind], "a fringe is a length: units must be mm, cm, m, um or in");
    if (t->kind != SGT_TOLERANCE_IRREGULARITY) return;
    long number = 0;
    if (!term)
        tree_fail(s, map->line, "term",
                  "missing; the number of a Zernike polynomial in the fringe order: "
                  "5 astigmatism, 9 spherical");
    if (term->kind != NODE_SCALAR || !number_read_integer(term->text, 4, 49, &number))
        tree_fail(s, term->line, "term", "must be a whole number from 4 to 49");
    tree_mark_number(term);
    t->term = (size_t)number;
}

static void read_compensator(const whole_lens *w, source *s, const node *map, sgt_tolerance *t)
{
    static const char *const words[] = {"figure", "paraxial"};
    const node *n = tree_take(map, "compensator");
    if (!n) return;
    t->compensator = (sgt_compensation)(SGT_COMPENSATE_FIGURE + choice_at(s, n, "compensator", 2, words));
    if (t->compensator == SGT_COMPENSATE_PARAXIAL &&
        (t->kind != SGT_TOLERANCE_THICKNESS || t->first + 1 != w->lens.count))
        tree_fail(s, n->line, "compensator", "paraxial is of the last thickness, of surface %zu",
                  w->lens.count - 1);
    if (!(t->lower <= 0 && t->upper >= 0))
        tree_fail(s, n->line, "compensator", "its range must contain 0, the value as designed");
}

static void read_tolerance(const whole_lens *w, source *s, const node *list, const node *map,
                           sgt_tolerance *t)
{
    static const char *const distributions[] = {"uniform", "normal", "ends"};
    const node *value = NULL;
    tree_map(s, map, "tolerances");
    for (int i = 0; i < KINDS; i++) {
        const node *n = tree_take(map, kinds[i]);
        if (n && value)
            tree_fail(s, n->line, kinds[i], "given beside %s; an entry is about one of them", kinds[t->kind]);
        if (n) value = n, t->kind = (sgt_tolerance_kind)i;
    }
    const node *name = tree_take(map, "name"), *distribution = tree_take(map, "distribution");
    t->line = map->line, t->name = name ? tree_read_text(s, name, "name") : "";
    if (value) {
        read_surfaces_of(w, s, map, t);
        read_ends(s, value, kinds[t->kind], t);
        check_kind(w, s, list, value, t);
        read_fringes(w, s, map, value, t);
        const bool tilts = t->kind >= SGT_TOLERANCE_TILT_X && t->kind <= SGT_TOLERANCE_TILT_Z;
        const node *pivot = key_for(s, map, "pivot", tilts, "tilt_x, tilt_y and tilt_z");
        if (pivot) t->pivot = tree_read_number(s, pivot, "pivot", NUMBER_FINITE);
        read_compensator(w, s, map, t);
        if (distribution && t->compensator)
            tree_fail(s, distribution->line, "distribution", "a compensator has none: it is set, not drawn");
        if (distribution)
            t->distribution = (sgt_distribution)choice_at(s, distribution, "distribution", 3, distributions);
        tree_finish(s, map,
                    "surface or surfaces, name, distribution, compensator, pivot, wavelength, over, term; "
                    "radius, fringes, thickness, decenter_x ..., tilt_x ..., index, irregularity");
        return;
    }
    tree_fail(s, map->line, "tolerances",
              "must say what is off: radius, fringes, thickness, decenter_x, "
              "decenter_y, decenter_z, tilt_x, tilt_y, tilt_z, index or "
              "irregularity");
}

void sgt_read_tolerances(whole_lens *w, source *s, const node *n)
{
    if (!n) return;
    if (n->kind != NODE_LIST)
        tree_fail(s, n->line, "tolerances", "must be a list, like [{surface: 1, radius: 0.02}]");
    const node *list = tree_take(s->root, "surfaces");
    sgt_tolerance *t = tree_room(s, n->count, sizeof *t);
    for (size_t i = 0; i < n->count; i++) read_tolerance(w, s, list, n->item[i], &t[i]);
    w->tolerance = t, w->tolerances = n->count;
}

/* ------------------------------------------------------------------ for users */

size_t sgt_lens_tolerances(const sgt_lens *lens, const sgt_tolerance **list)
{
    const whole_lens *w = (const void *)lens;
    if (list) *list = w->tolerance;
    return w->tolerances;
}

void sgt_tolerance_text(const sgt_tolerance *t, char text[SGT_TOLERANCE_SIZE])
{
    char of[60], term[30] = "";
    if (*t->name) {
        snprintf(text, SGT_TOLERANCE_SIZE, "%s", t->name);
        return;
    }
    if (t->first == t->last)
        snprintf(of, sizeof of, "surface %zu", t->first);
    else
        snprintf(of, sizeof of, "surfaces %zu to %zu", t->first, t->last);
    if (t->kind == SGT_TOLERANCE_IRREGULARITY) snprintf(term, sizeof term, " %zu", t->term);
    snprintf(text, SGT_TOLERANCE_SIZE, "%s %s%s", of, kinds[t->kind], term);
}

const char *sgt_tolerance_unit(const sgt_lens *lens, const sgt_tolerance *t)
{
    if (in_fringes(t->kind)) return "fringe";
    if (t->kind == SGT_TOLERANCE_INDEX) return "";
    return t->kind >= SGT_TOLERANCE_TILT_X && t->kind <= SGT_TOLERANCE_TILT_Z ? "degree" : lens->units;
}
