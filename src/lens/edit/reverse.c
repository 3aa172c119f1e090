// SPDX-License-Identifier: MIT
/* reverse.c - a group of surfaces turned front to back.
 *
 * The group is mirrored in a plane z = const: surface k of m becomes surface m + 1 - k, each sag its
 * negative, each tilt (a, b, c) becomes (-a, -b, c) and each decentre (x, y, z) becomes (x, y, -z).  For
 * surfaces that are symmetric in x it is the group turned about the y axis; others become their mirror image.
 * Twice is the group as it was.
 *
 * What lies between two surfaces, thickness and medium, is mirrored with them; what lies behind the group
 * stays behind it.  A medium that is said by that in front of it (`same`, or left out) is said by itself
 * first.
 *
 * PICKUPS follow their surfaces.  With x picked up, s x + o has to stay as it is outside of the group, and to
 * become its negative inside: if x changes its sign then s does, and inside both s and o do once more. */
#include "edit.h"

#include "../../text/number.h"

#include <stdio.h>
#include <string.h>

typedef struct group {
    const editing *e;
    node *list;
    size_t first, last;
} group;

static node **slot(node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++)
        if (strcmp(map->key[i]->text, key) == 0) return &map->item[i];
    return NULL;
}

static const char *word_at(node *map, const char *key)
{
    node **n = slot(map, key);
    return n && (*n)->kind == NODE_SCALAR ? (*n)->text : "";
}

static bool picks_up(const node *n)
{
    bool found = false;
    for (size_t i = 0; n->kind == NODE_MAP && i < n->count; i++)
        found = found || strcmp(n->key[i]->text, "pickup") == 0 || strcmp(n->key[i]->text, "solve") == 0;
    return found;
}

/* -------------------------------------------------------------------- signs */

static node *negative(const editing *e, const node *n)
{
    double x;
    if (n->kind != NODE_SCALAR || !number_read(n->text, &x))
        sgt_edit_refuse(e, "\"%.60s\" is no number", n->kind == NODE_SCALAR ? n->text : "");
    if (x == 0) return tree_copy(e->s, n);
    const char *bare = n->text + (*n->text == '-' || *n->text == '+');
    node *minus = tree_word(e->s, n->line, *n->text == '-' ? bare : tree_print(e->s, "-%s", bare));
    minus->quoted = n->quoted;
    return minus;
}

static void negate_key(const editing *e, node *map, const char *key, double otherwise)
{
    node **at = slot(map, key);
    if (at)
        *at = negative(e, *at);
    else if (otherwise != 0)
        tree_set(e->s, map, key, tree_number(e->s, map->line, -otherwise));
}

/* A number, or each of a list. */
static void negate(const editing *e, node **place)
{
    node *n = *place;
    if (picks_up(n)) return; /* with its reference, below */
    if (n->kind == NODE_SCALAR) {
        *place = negative(e, n);
        return;
    }
    if (n->kind == NODE_MAP) sgt_edit_refuse(e, "a map where a number is expected");
    for (size_t i = 0; i < n->count; i++) negate(e, &n->item[i]);
}

/* Keys of sags that change their sign with the sag. */
static bool turns_sign(const char *key)
{
    return strncmp(key, "radius", 6) == 0 || strncmp(key, "curvature", 9) == 0 ||
           strcmp(key, "coefficients") == 0 || strcmp(key, "sag") == 0;
}

/* The same of the path behind an entry: ".radius", ".terms[1].coefficients[2]", ".tilt[1]". */
static bool turns_path(const char *rest)
{
    const char *key = *rest == '.' ? rest + 1 : rest;
    if (strncmp(key, "tilt[", 5) == 0) return key[5] == '1' || key[5] == '2';
    if (strncmp(key, "decenter[", 9) == 0) return key[9] == '3';
    if (strncmp(key, "phase.", 6) == 0)
        return strncmp(key, "phase.points[", 13) == 0 && strcmp(key + strlen(key) - 3, "[3]") == 0;
    if (strncmp(key, "facets.", 7) == 0) return turns_path(key + 6);
    if (strncmp(key, "terms[", 6) == 0) return turns_path(strchr(key, '.') ? strchr(key, '.') : "");
    char word[40];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(key, ".["), key);
    return turns_sign(word);
}

/* -(text), or without that. */
static void turn_formula(const editing *e, node **text)
{
    if (!text) sgt_edit_refuse(e, "a formula f = 0 cannot be reversed; a sag can");
    const char *t = (*text)->text;
    const size_t length = strlen(t);
    int open = 0;
    bool whole = length > 3 && t[0] == '-' && t[1] == '(' && t[length - 1] == ')';
    for (size_t i = 1; whole && i + 1 < length; i++) {
        open += (t[i] == '(') - (t[i] == ')');
        whole = open > 0;
    }
    node *word = whole ? tree_scalar(e->s, (*text)->line, t + 2, length - 3)
                       : tree_word(e->s, (*text)->line, tree_print(e->s, "-(%s)", t));
    word->quoted = true;
    *text = word;
}

/* Of the phase of a surface only what names z changes: light that goes through it the other way gets the same
 * momentum along the surface. */
static void turn_phase(const editing *e, node *phase)
{
    node **points = phase->kind == NODE_MAP ? slot(phase, "points") : NULL;
    node **waves = phase->kind == NODE_MAP ? slot(phase, "waves") : &phase;
    const bool text = waves && (*waves)->kind == NODE_SCALAR;
    if ((text && strchr((*waves)->text, 'z')) || (waves && !text && slot(*waves, "f")))
        sgt_edit_refuse(e, "a phase that is a formula of z cannot be reversed");
    for (size_t i = 0; points && (*points)->kind == NODE_LIST && i < (*points)->count; i++) {
        node *p = (*points)->item[i];
        if (p->kind == NODE_LIST && p->count == 3) negate(e, &p->item[2]);
    }
}

static void turn_shape(const editing *e, node *map)
{
    const char *type = word_at(map, "type");
    if (slot(map, "phase")) turn_phase(e, *slot(map, "phase"));
    if (slot(map, "facets")) turn_shape(e, *slot(map, "facets"));
    if (strcmp(type, "ideal") == 0) {
        if (slot(map, "object_distance")) sgt_edit_refuse(e, "an ideal lens has an object_distance");
        return;
    }
    if (strcmp(type, "formula") == 0) {
        turn_formula(e, slot(map, "sag"));
        return;
    }
    const sgt_builtin *row = sgt_edit_type(e, map);
    if (!row || (row->family != SGT_FAMILY_CONIC && row->family != SGT_FAMILY_ASPHERE &&
                 row->family != SGT_FAMILY_DEPARTURE))
        sgt_edit_refuse(e, "a surface of the type %.40s cannot be reversed", type);
    for (size_t i = 0; i < map->count; i++) {
        node *n = map->item[i];
        if (strcmp(map->key[i]->text, "terms") == 0)
            for (size_t k = 0; n->kind == NODE_LIST && k < n->count; k++) turn_shape(e, n->item[k]);
        else if (strcmp(map->key[i]->text, "coefficients") * strcmp(map->key[i]->text, "sag") == 0 &&
                 n->kind == NODE_SCALAR)
            sgt_edit_refuse_file(e, n, map->key[i]->text);
        else if (turns_sign(map->key[i]->text))
            negate(e, &map->item[i]);
    }
}

static void turn_place(const editing *e, node *map)
{
    node **tilt = slot(map, "tilt"), **decenter = slot(map, "decenter");
    for (size_t i = 0; tilt && (*tilt)->kind == NODE_LIST && i < 2 && i < (*tilt)->count; i++)
        negate(e, &(*tilt)->item[i]);
    if (decenter && (*decenter)->kind == NODE_LIST && (*decenter)->count == 3)
        negate(e, &(*decenter)->item[2]);
}

/* ------------------------------------------------------------ what is between */

/* A medium: `index` or `glass` and its node; key NULL: none is said. */
typedef struct said {
    const char *key;
    node *is;
} said;

static said medium_said(node *map)
{
    static const char *const keys[] = {"glass", "index"};
    for (int i = 0; i < 2; i++) {
        node **n = slot(map, keys[i]);
        if (n) return (said){keys[i], *n};
    }
    return (said){NULL, NULL};
}

static bool as_before(const said *m)
{
    const char *t = m->key && m->is->kind == NODE_SCALAR ? m->is->text : "";
    return !m->key || strcmp(t, "same") == 0 || strcmp(t, "Same") == 0 || strcmp(t, "SAME") == 0;
}

/* Puts a value, or none, where a key is, or one of two keys. */
static void put_key(source *s, node *map, const char *key, const char *other, node *value)
{
    for (size_t i = 0; i < map->count; i++) {
        if (strcmp(map->key[i]->text, key ? key : "") != 0 && strcmp(map->key[i]->text, other) != 0) continue;
        if (!value) {
            tree_remove(map, i);
            return;
        }
        map->key[i] = tree_word(s, map->key[i]->line, key), map->item[i] = value;
        return;
    }
    if (value) tree_set(s, map, key, value);
}

/* The medium in front of an entry. */
static said medium_before(const group *g)
{
    said now = {NULL, NULL};
    for (size_t i = g->first; i > 0 && as_before(&now); i--) now = medium_said(g->list->item[i - 1]);
    if (!as_before(&now)) return now;
    node **object = slot(g->e->s->root, "object");
    if (object && (*object)->kind == NODE_MAP) now = medium_said(*object);
    if (as_before(&now)) now = (said){"glass", tree_word(g->e->s, g->list->line, "air")};
    return now;
}

static void turn_between(const group *g)
{
    source *s = g->e->s;
    const size_t m = g->last - g->first;
    node **thickness = tree_room(s, m + 1, sizeof(node *));
    said *behind = tree_room(s, m + 1, sizeof *behind), now = medium_before(g);
    bool plain = true;
    for (size_t k = 0; k <= m; k++) {
        node *map = g->list->item[g->first + k], **t = slot(map, "thickness");
        thickness[k] = t ? *t : NULL, behind[k] = medium_said(map);
        plain = plain && (k == m || !as_before(&behind[k]));
    }
    for (size_t k = 0; k <= m; k++) {
        if (!as_before(&behind[k]))
            now = behind[k];
        else if (!plain)
            behind[k] = (said){now.key, tree_copy(s, now.is)};
    }
    for (size_t k = 0; k <= m; k++) {
        const size_t gap = k == m ? m : m - 1 - k;
        node *map = g->list->item[g->last - k]; /* it comes to the place of number k */
        put_key(s, map, "thickness", "thickness", thickness[gap]);
        put_key(s, map, behind[gap].key, behind[gap].key && *behind[gap].key == 'g' ? "index" : "glass",
                behind[gap].is);
        if (!behind[gap].key) put_key(s, map, NULL, "index", NULL);
    }
}

/* ------------------------------------------------------------------- the group */

static size_t entry_of(const editing *e, const char *text)
{
    char why[PATH_WHY];
    spot at;
    const way p = sgt_edit_way(e, text);
    if (!sgt_path_find(e->s->root, &p, p.count, &at, why)) sgt_edit_refuse(e, "%.60s: %s", text, why);
    if (!at.is || !at.surface || p.count != 2 || !sgt_step_is(&p.step[0], "surfaces"))
        sgt_edit_refuse(e, "%.60s is no surface; write it as surfaces[3]", text);
    return at.at;
}

static bool in_group(const group *g, const node *entry)
{
    bool is = false;
    for (size_t i = g->first; entry && i <= g->last; i++) is = is || g->list->item[i] == entry;
    return is;
}

static void turn_pickups(const group *g, const references *all)
{
    for (size_t i = 0; i < all->count; i++) {
        const reference *r = &all->at[i];
        if (r->word) continue; /* it is no pickup, and of no surface of the group */
        const bool own = in_group(g, r->in) && turns_path(r->own);
        const char *rest = strchr(r->map->item[r->pickup]->text, ']');
        const bool other = in_group(g, r->entry) && rest && turns_path(rest + 1);
        if (own != other) negate_key(g->e, r->map, "scale", 1);
        if (own) negate_key(g->e, r->map, "offset", 0);
    }
}

/* A thickness and a medium are no longer those of the surface that had them. */
static void follow_gaps(const group *g, const references *all)
{
    for (size_t i = 0; i < all->count; i++) {
        reference *r = &all->at[i];
        if (r->word) continue;
        const char *rest = strchr(r->map->item[r->pickup]->text, ']');
        if (!in_group(g, r->entry) || !rest ||
            !(strcmp(rest, "].thickness") == 0 || strncmp(rest, "].glass", 7) == 0 ||
              strncmp(rest, "].index", 7) == 0))
            continue;
        size_t at = g->first;
        while (g->list->item[at] != r->entry) at++;
        r->entry = g->list->item[at == g->last ? g->first : at + 1], r->rest = rest + 1;
    }
}

void sgt_edit_reverse(const editing *e)
{
    group g = {.e = e, .list = sgt_edit_surfaces(e)};
    g.first = entry_of(e, e->edit->path), g.last = entry_of(e, e->edit->text);
    if (g.first > g.last) sgt_edit_refuse(e, "the last surface stands before the first");
    for (size_t i = g.first; i <= g.last; i++) {
        node *map = g.list->item[i];
        if (strcmp(word_at(map, "type"), "break") == 0)
            sgt_edit_refuse(e, "there is a break among the surfaces");
        if (*word_at(map, "mirror") == 't' || *word_at(map, "mirror") == 'T')
            sgt_edit_refuse(e, "there is a mirror among the surfaces");
        if (slot(map, "origin")) sgt_edit_refuse(e, "surfaces are placed by origin");
        node **t = slot(map, "thickness");
        if (t && i < g.last && picks_up(*t) && slot(*t, "solve"))
            sgt_edit_refuse(e, "a thickness between the surfaces is a solve");
    }
    const references all = sgt_edit_references(e);
    for (size_t i = 0; i < all.count; i++)
        if (all.at[i].word && in_group(&g, all.at[i].entry))
            sgt_edit_refuse(e, "%s is of one of the surfaces; remove it first", all.at[i].path);
    follow_gaps(&g, &all);
    turn_between(&g);
    for (size_t i = g.first; i <= g.last; i++) turn_shape(e, g.list->item[i]), turn_place(e, g.list->item[i]);
    turn_pickups(&g, &all);
    for (size_t i = g.first, k = g.last; i < k; i++, k--) {
        node *other = g.list->item[i];
        g.list->item[i] = g.list->item[k], g.list->item[k] = other;
    }
    sgt_edit_refer(e, &all);
}
