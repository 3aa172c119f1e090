// SPDX-License-Identifier: MIT
/* zmx_elements.c - the surfaces of a .zmx file become surfaces and breaks of the lens file; their shapes:
 * zmx_shape.c.
 *
 * MEDIA.  A surface without GLAS is followed by air, whatever was before it.  MIRROR leaves the medium as it
 * was, and a break has none.  A pickup is the medium of another surface, which may be a pickup, too: each
 * chain is walked once, so that all of them together take linear time. */
#include "zmx.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Numbers that stand in the file though the type has no use for them. */
static void tally_unused(zmx *z, const zmx_surface *f)
{
    const zmx_type *t = f->type;
    if (f->grid.line && !t->heights) sgt_zmx_tally(z, ZMX_UNUSED, f->grid.line, "GDAT");
    if (f->parm[0] != 0 && !t->zeroth) sgt_zmx_tally(z, ZMX_UNUSED, f->parm_line, "PARM");
    for (size_t i = t->parms + 1; i <= ZMX_PARMS; i++)
        if (f->parm[i] != 0) sgt_zmx_tally(z, ZMX_UNUSED, f->parm_line, "PARM");
    for (size_t i = 0; i < f->extras && !t->extras; i++)
        if (f->extra[i].value != 0) sgt_zmx_tally(z, ZMX_UNUSED, f->extra[i].line, "XDAT");
    if (!t->round && f->curvature != 0) sgt_zmx_tally(z, ZMX_UNUSED, f->curvature_line, "CURV");
    if (!t->round && f->conic != 0) sgt_zmx_tally(z, ZMX_UNUSED, f->conic_line, "CONI");
}

/* ------------------------------------------------------------------- media */

/* Each pickup becomes the glass at the end of its chain.  mark: which walk came by. */
static void resolve_pickups(zmx *z)
{
    size_t *mark = tree_room(z->s, z->count, sizeof *mark);
    for (size_t i = 0; i < z->count; i++) {
        size_t at = i;
        for (; z->surface[at].glass.medium == ZMX_PICKUP; at = z->surface[at].glass.from) {
            const zmx_glass *g = &z->surface[at].glass;
            if (g->from >= z->count)
                tree_fail(z->s, g->line, "GLAS",
                          "surface %zu takes its glass from surface %zu, which is not there", at, g->from);
            if (!z->surface[g->from].type->write)
                tree_fail(z->s, g->line, "GLAS",
                          "surface %zu takes its glass from surface %zu, a coordinate break", at, g->from);
            if (mark[at] == i + 1)
                tree_fail(z->s, g->line, "GLAS", "surface %zu takes its glass from itself, in a circle", at);
            mark[at] = i + 1;
        }
        zmx_glass found = z->surface[at].glass;
        for (size_t j = i, next; z->surface[j].glass.medium == ZMX_PICKUP; j = next) {
            size_t line = z->surface[j].glass.line;
            next = z->surface[j].glass.from;
            z->surface[j].glass = found, z->surface[j].glass.line = line;
            z->surface[j].glass.picked = true, z->surface[j].glass.from = next;
        }
    }
}

/* What is behind a surface; that of the object is air if it is not said. */
static void set_medium(zmx *z, node *map, const zmx_surface *f)
{
    const zmx_glass *g = &f->glass;
    if (g->medium == ZMX_MIRROR) {
        sgt_zmx_set_word(z, map, "mirror", g->line, "true");
        return;
    }
    const bool object = sgt_zmx_number_of(z, f) == 0;
    if (g->medium == ZMX_AIR && !object) sgt_zmx_set_word(z, map, "glass", f->line, "air");
    if (g->medium == ZMX_GLASS) sgt_zmx_set_word(z, map, "glass", g->line, g->name);
    if (g->medium == ZMX_MODEL && g->vd == 0) sgt_zmx_set_number(z, map, "index", g->line, g->nd);
    if (g->medium == ZMX_MODEL && g->vd != 0) {
        node *model = tree_node(z->s, NODE_MAP, g->line);
        sgt_zmx_set_number(z, model, "nd", g->line, g->nd);
        sgt_zmx_set_number(z, model, "vd", g->line, g->vd);
        if (g->dPgF != 0) sgt_zmx_set_number(z, model, "dPgF", g->line, g->dPgF);
        tree_set(z->s, map, "glass", model);
    }
}

/* --------------------------------------------------------------- apertures */

static void set_halves(zmx *z, node *map, const zmx_aperture *a, const char *type, const char *first,
                       const char *second)
{
    sgt_zmx_set_word(z, map, "type", a->line, type);
    sgt_zmx_set_number(z, map, first, a->line, a->a);
    sgt_zmx_set_number(z, map, second, a->line, a->b);
}

static void set_round(zmx *z, node *map, const zmx_aperture *a)
{
    if (a->a > 0) {
        set_halves(z, map, a, "annulus", "inner", "outer");
        return;
    }
    sgt_zmx_set_word(z, map, "type", a->line, "circle");
    sgt_zmx_set_number(z, map, "radius", a->line, a->b);
}

static void set_aperture(zmx *z, node *map, const zmx_surface *f)
{
    zmx_aperture a = f->aperture;
    if (!a.key) return;
    bool floating = strcmp(a.key, "FLAP") == 0, round = *a.key != 'S' && *a.key != 'E';
    if (floating) a.a = 0;
    if (floating && f->size > 0) a.b = f->size;
    if (!(a.b > 0 && (round ? a.a >= 0 && a.a < a.b : a.a > 0)) || !map) {
        sgt_zmx_tally(z, ZMX_APERTURES, a.line, a.key);
        return;
    }
    if (floating) sgt_zmx_tally(z, ZMX_FLAP, a.line, a.key);
    bool centred = a.offset[0] == 0 && a.offset[1] == 0;
    if (round && *a.key != 'O' && a.a == 0 && centred) {
        sgt_zmx_set_number(z, map, "semi_diameter", a.line, a.b);
        return;
    }
    node *list = tree_node(z->s, NODE_LIST, a.line), *item = tree_node(z->s, NODE_MAP, a.line);
    if (round)
        set_round(z, item, &a);
    else
        set_halves(z, item, &a, *a.key == 'S' ? "rectangle" : "ellipse", "half_width", "half_height");
    if (!centred) tree_set(z->s, item, "offset", tree_numbers(z->s, a.line, 2, a.offset));
    if (*a.key == 'O') sgt_zmx_set_word(z, item, "obscures", a.line, "true");
    tree_append(z->s, list, item);
    tree_set(z->s, map, "apertures", list);
}

/* -------------------------------------------------------- pickups and solves */

static node **key_place(node *map, const char *key)
{
    for (size_t i = 0; map && i < map->count; i++)
        if (strcmp(map->key[i]->text, key) == 0) return &map->item[i];
    return NULL;
}

static node **list_place(node *map, const char *key, size_t i)
{
    node **list = key_place(map, key);
    return list && (*list)->kind == NODE_LIST && i >= 1 && i <= (*list)->count ? &(*list)->item[i - 1] : NULL;
}

static bool is_coordinate_break(const zmx_surface *f) { return !f->type->write; }

/* The list and the place in it of a PARM; "": no such list. */
static const char *list_of_parm(const zmx_surface *f, size_t parm, size_t *i)
{
    *i = is_coordinate_break(f) && parm > 2 ? parm - 2 : parm;
    if (is_coordinate_break(f)) return parm <= 2 ? "decenter" : parm <= 5 ? "tilt" : "";
    return f->type->powers ? "coefficients" : "";
}

/* Breaks that pick each other up keep numbers that are 0. */
static void keep_lists(zmx *z)
{
    for (zmx_surface *f = z->surface; f < z->surface + z->count; f++)
        for (size_t k = 0; k < f->picks; k++) {
            zmx_surface *both[] = {f, &z->surface[f->pick[k].from]};
            if (f->pick[k].what != ZMX_PICK_PARM) continue;
            for (int j = 0; j < 2; j++) {
                if (f->pick[k].parm <= 2) both[j]->keeps_decenter = true;
                else both[j]->keeps_tilt = true;
            }
        }
}

/* Puts an expression where a number is, with the number beside it, which it has to give: see
 * ../open/resolve.c. */
static void express(zmx *z, node **place, node *map, size_t line, const char *key)
{
    map->is = tree_room(z->s, 1, sizeof *map->is);
    map->inline_ = true, map->is->stored = *place, map->is->record = key;
    map->is->stored->line = map->line = (uint32_t)line;
    *place = map;
}

static node *pickup_of(zmx *z, size_t line, const char *path, double scale, double offset)
{
    node *map = tree_node(z->s, NODE_MAP, line), *word = tree_word(z->s, line, path);
    word->quoted = true;
    tree_set(z->s, map, "pickup", word);
    if (scale != 1) sgt_zmx_set_number(z, map, "scale", line, scale);
    if (offset != 0) sgt_zmx_set_number(z, map, "offset", line, offset);
    return map;
}

/* false: the lens file has no such number. */
static bool express_pick(zmx *z, const zmx_surface *f, const zmx_pick *p)
{
    static const char *const bends[] = {"radius", "curvature", "radius_y", "curvature_y"};
    const zmx_surface *from = &z->surface[p->from];
    const char *path = NULL;
    node **place = NULL;
    double scale = p->scale;
    if (!from->map || !f->map) return false;
    if (p->what == ZMX_PICK_THICKNESS && from->step && key_place(from->step, "thickness")) {
        place = key_place(f->step, "thickness");
        path = tree_print(z->s, "%s.thickness", from->step_path);
    } else if (p->what == ZMX_PICK_PARM && f->type == from->type) {
        size_t i;
        const char *list = list_of_parm(f, p->parm, &i);
        place = list_place(f->map, list, i);
        if (!list_place(from->map, list, i)) return false;
        path = tree_print(z->s, "%s.%s[%zu]", from->path, list, i);
    } else if (p->what == ZMX_PICK_CURVATURE && p->offset == 0 && scale != 0) {
        for (size_t k = 0; k < sizeof bends / sizeof *bends && !place; k++) {
            if (!key_place(from->map, bends[k])) continue;
            place = key_place(f->map, bends[k]);
            path = tree_print(z->s, "%s.%s", from->path, bends[k]);
            if (*bends[k] == 'r') scale = 1 / scale;
        }
    }
    if (!place || !path) return false;
    express(z, place, pickup_of(z, p->line, path, scale, p->offset), p->line, p->key);
    return true;
}

/* Once all surfaces are written: what they picked up, and solved for, is said so. */
static void write_expressions(zmx *z)
{
    for (const zmx_surface *f = z->surface; f < z->surface + z->count; f++) {
        const zmx_glass *g = &f->glass;
        node **glass = f->map && g->picked && g->medium == ZMX_GLASS ? key_place(f->map, "glass") : NULL;
        const zmx_surface *from = g->picked ? &z->surface[g->from] : NULL;
        for (size_t k = 0; k < f->picks; k++)
            if (!express_pick(z, f, &f->pick[k]))
                sgt_zmx_tally(z, ZMX_SOLVES, f->pick[k].line, f->pick[k].key);
        node **step = f->focus_line && f->step ? key_place(f->step, "thickness") : NULL;
        if (step) {
            node *map = tree_node(z->s, NODE_MAP, f->focus_line);
            sgt_zmx_set_word(z, map, "solve", f->focus_line, "paraxial_focus");
            express(z, step, map, f->focus_line, "MAZH");
        } else if (f->focus_line) {
            sgt_zmx_tally(z, ZMX_SOLVES, f->focus_line, "MAZH");
        }
        if (glass && from->map && key_place(from->map, "glass"))
            express(z, glass, pickup_of(z, g->line, tree_print(z->s, "%s.glass", from->path), 1, 0), g->line,
                    "GLAS");
        else if (g->picked) sgt_zmx_tally(z, ZMX_PICKUPS, g->line, "GLAS");
    }
}

/* ---------------------------------------------------------------- surfaces */

static node *append_break(zmx *z, node *list, const zmx_break *b, double thickness, size_t line,
                          bool decenter, bool tilt)
{
    node *map = tree_node(z->s, NODE_MAP, b->line);
    z->breaks++;
    sgt_zmx_set_word(z, map, "type", b->line, "break");
    if (decenter || b->decenter[0] != 0 || b->decenter[1] != 0)
        tree_set(z->s, map, "decenter", tree_numbers(z->s, b->line, 2, b->decenter));
    if (tilt || b->tilt[0] != 0 || b->tilt[1] != 0 || b->tilt[2] != 0)
        tree_set(z->s, map, "tilt", tree_numbers(z->s, b->line, 3, b->tilt));
    if (b->tilt_first) sgt_zmx_set_word(z, map, "order", b->line, "tilt_first");
    sgt_zmx_set_number(z, map, "thickness", line, thickness);
    map->inline_ = true;
    tree_append(z->s, list, map);
    return map;
}

/* A stop has to be a surface: the plane z = 0 of the frame behind the break, in the medium that is there. */
static void write_stop_of_break(zmx *z, node *list, zmx_surface *f)
{
    node *map = tree_node(z->s, NODE_MAP, f->line);
    sgt_zmx_set_word(z, map, "type", f->line, "plane");
    sgt_zmx_set_number(z, map, "thickness", f->thickness_line, f->thickness);
    sgt_zmx_set_word(z, map, "glass", f->line, "same");
    sgt_zmx_set_word(z, map, "stop", z->stop_line, "true");
    if (f->size > 0) sgt_zmx_set_number(z, map, "draw_to", f->size_line, f->size);
    map->inline_ = true;
    tree_append(z->s, list, map);
    f->step = map, f->step_path = tree_print(z->s, "surfaces[%zu]", ++z->surfaces);
    tree_remark(z->s, SGT_REMARK_TURNED, z->stop_line, "STOP",
                "a plane behind the break: surface %zu is a coordinate break", z->stop);
}

static void write_break(zmx *z, node *list, zmx_surface *f)
{
    const double *p = f->parm;
    const bool stop = sgt_zmx_number_of(z, f) == z->stop;
    zmx_break b = {f->line, p[6] != 0, {p[1], p[2]}, {p[3], p[4], p[5]}};
    if (sgt_zmx_number_of(z, f) == z->count - 1)
        tree_fail(z->s, f->line, "TYPE", "the last surface is a coordinate break, and no image");
    if (f->before || f->behind)
        tree_fail(z->s, (f->before ? f->before : f->behind)->line, "SCBD",
                  "surface %zu is a coordinate break itself", sgt_zmx_number_of(z, f));
    f->map = f->step = append_break(z, list, &b, stop ? 0 : f->thickness, f->thickness_line,
                                    f->keeps_decenter, f->keeps_tilt);
    f->path = f->step_path = tree_print(z->s, "breaks[%zu]", z->breaks);
    sgt_zmx_tally(z, ZMX_BREAKS, f->line, "COORDBRK");
    if (stop) write_stop_of_break(z, list, f);
    if (f->glass.medium != ZMX_AIR) sgt_zmx_tally(z, ZMX_BREAK_GLASS, f->glass.line, "GLAS");
    set_aperture(z, NULL, f);
    tally_unused(z, f);
}

static zmx_break *new_break(zmx *z, zmx_break b)
{
    zmx_break *room = tree_room(z->s, 1, sizeof *room);
    *room = b;
    return room;
}

/* A break in front of the surface, and behind it one that undoes it. */
static void place_alone(zmx *z, zmx_surface *f)
{
    const double *p = f->parm;
    const zmx_break there = {f->parm_line, false, {p[1], p[2]}, {p[3], p[4], 0}},
                    back = {f->parm_line, true, {0 - p[1], 0 - p[2]}, {0 - p[3], 0 - p[4], 0}};
    if (p[1] == 0 && p[2] == 0 && p[3] == 0 && p[4] == 0) return;
    if (f->before || f->behind)
        tree_fail(z->s, (f->before ? f->before : f->behind)->line, "SCBD",
                  "surface %zu is moved by its parameters, too", sgt_zmx_number_of(z, f));
    f->before = new_break(z, there), f->behind = new_break(z, back);
    sgt_zmx_tally(z, ZMX_SCBD, f->parm_line, "PARM");
}

static void write_surface(zmx *z, node *list, zmx_surface *f)
{
    if (f->type->alone) place_alone(z, f);
    bool last = sgt_zmx_number_of(z, f) == z->count - 1, behind = f->behind && !last;
    node *map = tree_node(z->s, NODE_MAP, f->line);
    if (f->before) append_break(z, list, f->before, 0, f->before->line, false, false);
    f->type->write(z, f, map);
    if (!last) sgt_zmx_set_number(z, map, "thickness", f->thickness_line, behind ? 0 : f->thickness);
    set_medium(z, map, f);
    if (sgt_zmx_number_of(z, f) == z->stop) sgt_zmx_set_word(z, map, "stop", z->stop_line, "true");
    bool tilted = f->type->aslant && (f->parm[1] != 0 || f->parm[2] != 0);
    set_aperture(z, tilted ? NULL : map, f);
    const node *rim = tree_take(map, "semi_diameter");
    double semi_diameter = rim ? tree_read_number(z->s, rim, "semi_diameter", NUMBER_FINITE) : 0;
    if (f->size > 0 && f->size != semi_diameter) sgt_zmx_set_number(z, map, "draw_to", f->size_line, f->size);
    if (f->comment) {
        node *name = tree_word(z->s, f->comment_line, f->comment);
        name->quoted = true;
        tree_set(z->s, map, "name", name);
    }
    /* such a list needs lines of its own */
    map->inline_ = !tree_take(map, "coefficients") && !tree_take(map, "phase");
    tree_append(z->s, list, map);
    f->map = f->step = map;
    f->path = f->step_path = tree_print(z->s, "surfaces[%zu]", ++z->surfaces);
    if (behind) {
        f->step = append_break(z, list, f->behind, f->thickness, f->thickness_line, false, false);
        f->step_path = tree_print(z->s, "breaks[%zu]", z->breaks);
    }
    tally_unused(z, f);
}

/* Surface 0: how far the object is from the first surface that is no break, and in what it stands. */
static void write_object(zmx *z, node *root)
{
    const zmx_surface *f = &z->surface[0];
    node *map = tree_node(z->s, NODE_MAP, f->line);
    if (f->glass.medium == ZMX_MIRROR)
        tree_fail(z->s, f->glass.line, "GLAS", "surface 0, the object, is a mirror");
    if (f->before || f->behind)
        tree_fail(z->s, (f->before ? f->before : f->behind)->line, "SCBD",
                  "surface 0, the object, is tilted");
    if (isfinite(f->thickness)) {
        double distance = f->thickness;
        for (size_t i = 1; i < z->count && !z->surface[i].type->write && i != z->stop; i++)
            distance += z->surface[i].thickness;
        if (!(distance >= 0))
            tree_fail(z->s, f->thickness_line, "DISZ", "the object stands behind the first surface");
        sgt_zmx_set_number(z, map, "distance", f->thickness_line, distance + 0);
        if (f->type->aslant && (f->parm[1] != 0 || f->parm[2] != 0))
            tree_set(z->s, map, "slope", tree_numbers(z->s, f->parm_line, 2, &f->parm[1]));
        if (f->curvature != 0)
            tree_remark(z->s, SGT_REMARK_LEFT_OUT, f->curvature_line, "CURV",
                        "the curvature of the object; rays start from a plane");
    } else if (f->parm[1] != 0 || f->parm[2] != 0) {
        tree_remark(z->s, SGT_REMARK_LEFT_OUT, f->parm_line, "PARM",
                    "the tilt of the object, which is at infinity");
    }
    set_medium(z, map, f);
    if (z->telecentric) tree_set(z->s, map, "telecentric", tree_word(z->s, z->ftyp_line, "true"));
    if (map->count) tree_set(z->s, root, "object", map);
    set_aperture(z, NULL, f);
    tally_unused(z, f);
}

void sgt_zmx_write_surfaces(zmx *z, node *root)
{
    node *list = tree_node(z->s, NODE_LIST, z->surface[1].line);
    resolve_pickups(z);
    keep_lists(z);
    write_object(z, root);
    for (size_t i = 1; i < z->count; i++) {
        zmx_surface *f = &z->surface[i];
        if (!isfinite(f->thickness) && i < z->count - 1)
            tree_fail(z->s, f->thickness_line, "DISZ", "surface %zu is infinitely far from the next", i);
        if (f->type->write)
            write_surface(z, list, f);
        else
            write_break(z, list, f);
    }
    tree_set(z->s, root, "surfaces", list);
    write_expressions(z);
}
