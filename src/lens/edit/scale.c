// SPDX-License-Identifier: MIT
/* scale.c - a lens made larger or smaller: each number is multiplied by the factor to the power that its unit
 * has of length.
 *
 * The units of a type's parameters are those of its row in the table of types (sgt_param_unit); those of the
 * other keys are below.  What has no unit that is known (a parameter of a formula), stands in a file or is
 * one of a set whose size is its own (a level set) is refused: to leave it would be another lens.
 *
 * With a factor that is a power of two no number is rounded, and factor 1/f undoes f to the bit.
 *
 * A pickup s x + o has the unit of its own place: o is multiplied as that, and s by the quotient of the two
 * units, which is 1 where like picks up like. */
#include "edit.h"

#include "../../text/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NO_POWER = 1000 };

static bool is_key(const path_step *step, const char *const keys[])
{
    for (; *keys; keys++)
        if (sgt_step_is(step, *keys)) return true;
    return false;
}

static size_t place_of_step(const way *p, size_t i)
{
    return i < p->count && !p->step[i].text ? p->step[i].place - 1 : 0;
}

static const node *entry_type(const node *map)
{
    for (size_t i = 0; map->kind == NODE_MAP && i < map->count; i++)
        if (strcmp(map->key[i]->text, "type") == 0) return map->item[i];
    return NULL;
}

/* Of the parameter of a type that step i names. */
static int param_power(const editing *e, const node *map, const way *p, size_t i)
{
    const sgt_builtin *row = sgt_edit_type(e, map);
    char key[PATH_KEY], other[PATH_KEY];
    const path_step *step = &p->step[i];
    snprintf(key, sizeof key, "%.*s", step->length < PATH_KEY ? (int)step->length : PATH_KEY - 1, step->text);
    const char *curvature = strncmp(key, "radius", 6) == 0 ? sgt_path_rival(key, false, 0, other) : NULL;
    if (!row) return NO_POWER;
    for (const sgt_param *q = row->params; q->name; q++) {
        if (curvature && strcmp(q->name, curvature) == 0) return -q->unit.length;
        if (strcmp(q->name, key) != 0) continue;
        const int a = (int)place_of_step(p, i + 1), b = (int)place_of_step(p, i + 2);
        return q->unit.length + a * q->unit.by_i + b * q->unit.by_j;
    }
    return NO_POWER;
}

static int phase_power(const editing *e, const node *map, const way *p, size_t i);

/* Of a key of a surface or break, whose map is step i - 1; a term of a sum has a map of its own. */
static int entry_power(const editing *e, const node *map, const way *p, size_t i)
{
    static const char *const lengths[] = {"thickness",    "draw_to",        "semi_diameter",
                                          "decenter",     "origin",         "object_distance",
                                          "focal_length", "focal_length_y", NULL},
                             *const none[] = {"tilt", "index", "glass", NULL},
                             *const of_aperture[] = {"radius",      "inner", "outer",  "half_width",
                                                     "half_height", "width", "length", "points",
                                                     "offset",      NULL};
    const path_step *step = &p->step[i];
    if (i >= p->count || !step->text) return NO_POWER;
    if (sgt_step_is(step, "terms") && i + 2 < p->count) {
        way term = {.count = 2, .step = {p->step[i], p->step[i + 1]}};
        spot at;
        char why[PATH_WHY];
        if (map->kind != NODE_MAP || !sgt_path_find((node *)(uintptr_t)map, &term, 2, &at, why) || !at.is)
            return NO_POWER;
        return param_power(e, at.is, p, i + 2);
    }
    if (sgt_step_is(step, "facets")) {
        const way facets = {.count = 1, .step = {*step}};
        spot at;
        char why[PATH_WHY];
        if (!sgt_path_find((node *)(uintptr_t)map, &facets, 1, &at, why) || !at.is) return NO_POWER;
        return entry_power(e, at.is, p, i + 1);
    }
    if (sgt_step_is(step, "phase")) return phase_power(e, map, p, i + 1);
    if (sgt_step_is(step, "apertures"))
        return i + 2 < p->count && is_key(&p->step[i + 2], of_aperture) ? 1 : 0;
    if (is_key(step, lengths)) return 1;
    return is_key(step, none) ? 0 : param_power(e, map, p, i);
}

/* Of a key of a phase.  Wavelengths stay as they are, and with them the directions that light is sent to.  So
 * the waves of a phase become more as lengths do: as a sag they have its units.  Lines keep their distance.
 */
static int phase_power(const editing *e, const node *map, const way *p, size_t i)
{
    static const char *const none[] = {"order", "lines", "turn", "wavelength", NULL};
    const path_step *step = &p->step[i];
    const way waves = {.count = 2, .step = {{.text = "phase", .length = 5}, {.text = "waves", .length = 5}}};
    spot at;
    char why[PATH_WHY];
    if (i >= p->count || !step->text) return NO_POWER;
    if (sgt_step_is(step, "points")) return 1;
    if (is_key(step, none)) return 0;
    if (!sgt_step_is(step, "waves") || i + 1 >= p->count ||
        !sgt_path_find((node *)(uintptr_t)map, &waves, 2, &at, why) || !at.is)
        return NO_POWER;
    return entry_power(e, at.is, p, i + 1);
}

/* entry: of `surfaces` where the path leads, if it is known. */
static int power_of(const editing *e, const way *p, const node *entry)
{
    static const char *const pupil[] = {"semi_diameter", "diameter", "distance", NULL},
                             *const off[] = {"radius",     "thickness", "decenter_x", "decenter_y",
                                             "decenter_z", "over",      "pivot",      NULL};
    char why[PATH_WHY];
    spot at;
    const path_step *first = &p->step[0];
    if (p->count >= 3 && (sgt_step_is(first, "surfaces") || sgt_step_is(first, "breaks")))
        return entry                                                ? entry_power(e, entry, p, 2)
               : sgt_path_find(e->s->root, p, 2, &at, why) && at.is ? entry_power(e, at.is, p, 2)
                                                                    : NO_POWER;
    if (sgt_step_is(first, "object") && p->count > 1) return sgt_step_is(&p->step[1], "distance");
    if (sgt_step_is(first, "pupil") && p->count > 1) return is_key(&p->step[1], pupil);
    if (sgt_step_is(first, "tolerances") && p->count > 2) return is_key(&p->step[2], off);
    if (!sgt_step_is(first, "fields")) return 0;
    const node *root = e->s->root;
    for (size_t i = 0; i < root->count; i++)
        if (strcmp(root->key[i]->text, "field_type") == 0)
            return root->item[i]->kind == NODE_SCALAR && strstr(root->item[i]->text, "height") != NULL;
    return 0;
}

/* ------------------------------------------------------------------- the walk */

typedef struct scaling {
    const editing *e;
    double factor;
    const node *entry;
} scaling;

static double raised(double f, int power)
{
    double x = 1;
    for (int i = 0; i < (power < 0 ? -power : power); i++) x *= f;
    return power < 0 ? 1 / x : x;
}

static void multiply(const scaling *c, node **place, int power)
{
    double x;
    if (power == 0) return;
    if ((*place)->kind != NODE_SCALAR || !number_read((*place)->text, &x)) return;
    node *n = tree_number(c->e->s, (*place)->line, x * raised(c->factor, power));
    n->quoted = (*place)->quoted;
    *place = n;
}

static void scale_expression(const scaling *c, node *map, const way *p, int power)
{
    const editing *e = c->e;
    int other = power;
    bool scaled = false;
    for (size_t i = 0; i < map->count; i++) {
        const char *key = map->key[i]->text;
        if (strcmp(key, "offset") == 0) multiply(c, &map->item[i], power);
        if (strcmp(key, "pickup") == 0 && map->item[i]->kind == NODE_SCALAR) {
            const way from = sgt_edit_way(e, map->item[i]->text);
            other = power_of(e, &from, NULL);
        }
    }
    if (other == NO_POWER) sgt_edit_refuse(e, "it is not known how %.60s scales", p->step[p->count - 1].text);
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->key[i]->text, "scale") == 0) multiply(c, &map->item[i], power - other), scaled = true;
    if (!scaled && power != other)
        tree_set(e->s, map, "scale", tree_number(e->s, map->line, raised(c->factor, power - other)));
}

static void scale_node(scaling *c, node **place, way *p)
{
    node *n = *place;
    bool expression = false;
    for (size_t i = 0; n->kind == NODE_MAP && i < n->count; i++)
        expression =
            expression || strcmp(n->key[i]->text, "pickup") == 0 || strcmp(n->key[i]->text, "solve") == 0;
    if ((n->kind == NODE_SCALAR && n->number) || (expression && !entry_type(n))) {
        const int power = power_of(c->e, p, c->entry);
        if (power == NO_POWER)
            sgt_edit_refuse(c->e, "it is not known how %.*s scales", (int)p->step[p->count - 1].length,
                            p->step[p->count - 1].text);
        if (n->kind == NODE_SCALAR)
            multiply(c, place, power);
        else
            scale_expression(c, n, p, power);
        return;
    }
    if (n->kind == NODE_SCALAR || p->count == PATH_STEPS) return;
    const bool surfaces = p->count == 1 && sgt_step_is(&p->step[0], "surfaces");
    const path_step kept = p->step[0];
    size_t breaks = 0;
    for (size_t i = 0; i < n->count; i++) {
        path_step *step = &p->step[p->count];
        const node *type = surfaces ? entry_type(n->item[i]) : NULL;
        const bool is_break = type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
        *step = n->kind == NODE_MAP ? (path_step){.text = n->key[i]->text, .length = strlen(n->key[i]->text)}
                                    : (path_step){.place = is_break ? ++breaks : i + 1 - breaks};
        if (surfaces) c->entry = n->item[i];
        if (is_break) p->step[0] = (path_step){.text = "breaks", .length = 6};
        p->count++;
        scale_node(c, &n->item[i], p);
        p->count--;
        p->step[0] = kept;
    }
    if (surfaces) c->entry = NULL;
}

static const node *value_in(const node *map, const char *key)
{
    for (size_t i = 0; map && map->kind == NODE_MAP && i < map->count; i++)
        if (strcmp(map->key[i]->text, key) == 0) return map->item[i];
    return NULL;
}

/* Has the surface a phase whose waves are a formula? */
static bool has_formula(const node *map)
{
    const node *phase = value_in(map, "phase"), *waves = value_in(phase, "waves"),
               *type = value_in(waves, "type");
    if (phase && phase->kind == NODE_SCALAR) return true;
    return waves && (waves->kind == NODE_SCALAR || (type && type->kind == NODE_SCALAR &&
                                                    strcmp(type->text, "formula") == 0));
}

/* What cannot be scaled though its numbers may be: of a surface, its terms, and the waves of its phase. */
static void refuse_types(const editing *e, const node *map)
{
    const node *type = entry_type(map), *terms = value_in(map, "terms"),
               *waves = value_in(value_in(map, "phase"), "waves");
    const char *name = type && type->kind == NODE_SCALAR ? type->text : "";
    const sgt_builtin *row = sgt_edit_type(e, map);
    if (has_formula(map)) sgt_edit_refuse(e, "a phase that is a formula cannot be scaled");
    if (strcmp(name, "formula") == 0 || (row && row->family == SGT_FAMILY_LEVEL_SET))
        sgt_edit_refuse(e, "a surface of the type %.40s cannot be scaled", name);
    for (const sgt_param *p = row ? row->params : NULL; p && p->name; p++) {
        const node *n = p->kind == SGT_PARAM_TABLE ? value_in(map, p->name) : NULL;
        if (n && n->kind == NODE_SCALAR) sgt_edit_refuse_file(e, n, p->name);
    }
    for (size_t i = 0; terms && terms->kind == NODE_LIST && i < terms->count; i++)
        refuse_types(e, terms->item[i]);
    if (waves) refuse_types(e, waves);
}

void sgt_edit_scale(const editing *e)
{
    scaling c = {.e = e, .factor = e->edit->number};
    if (!(c.factor > 0) || !isfinite(c.factor)) sgt_edit_refuse(e, "a factor must be positive and finite");
    if (value_in(e->s->root, "configurations"))
        sgt_edit_refuse(e, "the lens has configurations, whose values would stay; scale one of them");
    const node *list = sgt_edit_surfaces(e);
    for (size_t i = 0; i < list->count; i++) refuse_types(e, list->item[i]);
    way p = {.count = 0};
    node *root = e->s->root;
    scale_node(&c, &root, &p);
}
