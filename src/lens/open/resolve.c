// SPDX-License-Identifier: MIT
/* resolve.c - pickups and solves: values of a lens file that follow from others.
 *
 *     {pickup: PATH, scale: s, offset: o}   s x + o, where x is the number at PATH; without scale and
 *                                           offset whatever stands there, such as the name of a glass
 *     {solve: paraxial_focus, offset: o}    the thickness from this surface to the paraxial image of
 *                                           the axial object point at the primary wavelength, plus o
 *
 * THE VALUE is a function of the tree alone, and not of what it was before: so a written file read anew has
 * the same bits.  A pickup needs what it picks up.  A solve needs the expressions of the entries of
 * `surfaces` up to its own, and of what is not in `surfaces`: its light comes from there.  An expression is
 * evaluated when all it needs are; those that wait are on a stack, each once, and one that is needed by
 * itself is a circle, which is told.  Time is linear in the expressions, but a solve reads all in front.
 *
 * A SOLVE makes a lens of the surfaces up to its own, with a plane behind it, and asks for its paraxial
 * image: that is no more to do than to read them, and any surface of a lens is taken by the same rules.
 *
 * WHILE THE LENS IS MADE the values stand in the tree in the place of the expressions; no reader knows of
 * them.
 *
 * IMPORTED ones have beside them the value that the other program has stored.  If they give another, the
 * meaning was not understood or the file is not up to date, and the stored value is taken for good, with a
 * remark; but one that rules is taken itself, as the other program would, with a remark beyond TOLD.  Pickups
 * have to give the same number; a solve within AGREES, since its last digits are those of another program's
 * arithmetic. */
#include "resolve.h"

#include "../read/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double AGREES = 1e-9, TOLD = 1e-6; /* relative */
enum { SOLVES_MOST = 64 }; /* each reads all in front of it */

typedef struct expression {
    node *map, **place;
    const char *path;
    size_t entry;              /* the entry of `surfaces` it is in, from 1; 0: of none */
    bool thickness, done, waits;
    size_t next;               /* of a solve: all expressions before this one are evaluated or not needed */
} expression;

struct resolution { size_t count, room; expression *at; places known; };

/* -------------------------------------------------------------- which there are */

static const node *of_key(const node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++)
        if (map->key[i]->kind == NODE_SCALAR && strcmp(map->key[i]->text, key) == 0) return map->item[i];
    return NULL;
}

/* A formula may have a parameter called solve; but then the map has a type. */
static bool is_expression(const node *n)
{
    bool is = false;
    for (size_t i = 0; n->kind == NODE_MAP && i < n->count; i++) {
        const char *key = n->key[i]->kind == NODE_SCALAR ? n->key[i]->text : "";
        if (*key == 't' && strcmp(key, "type") == 0) return false;
        is = is || (*key == 'p' && strcmp(key, "pickup") == 0) || (*key == 's' && strcmp(key, "solve") == 0);
    }
    return is;
}

/* Marks what holds an expression.  Each list and map is seen once, though aliases may name it often. */
static bool mark_holders(node *n, int depth)
{
    enum { DEPTH = 64 };
    if (n->kind == NODE_SCALAR || n->seen || depth >= DEPTH) return n->kind != NODE_SCALAR && n->holds;
    n->seen = true;
    for (size_t i = 0; i < n->count; i++)
        if (is_expression(n->item[i]) || mark_holders(n->item[i], depth + 1)) n->holds = true;
    return n->holds;
}

typedef struct search { source *s; resolution *found; char text[SGT_PATH_SIZE]; size_t entry; } search;

static void look(search *l, node *n, size_t length, int depth);

/* Looks at what stands in one place of n.  breaks: how many stood before, in the list of surfaces. */
static void look_at(search *l, node *n, size_t i, size_t *breaks, size_t length, int depth)
{
    node *item = n->item[i];
    if (item->kind == NODE_SCALAR) return;
    const bool surfaces = depth == 1 && n->kind == NODE_LIST && strcmp(l->text, "surfaces") == 0;
    const node *type = surfaces && item->kind == NODE_MAP ? of_key(item, "type") : NULL;
    const bool lies = type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
    char *end = l->text + length;
    const size_t room = sizeof l->text - length;
    if (surfaces) l->entry = i + 1;
    if (lies) length = (size_t)snprintf(l->text, sizeof l->text, "breaks[%zu]", ++*breaks);
    else if (n->kind == NODE_LIST) length += (size_t)snprintf(end, room, "[%zu]", i + 1 - *breaks);
    else length += (size_t)snprintf(end, room, "%s%s", depth ? "." : "", n->key[i]->text);
    if (length >= sizeof l->text) length = sizeof l->text - 1;
    const bool thickness = depth == 2 && l->entry && n->kind == NODE_MAP &&
                           strcmp(n->key[i]->text, "thickness") == 0;
    if (is_expression(item)) {
        resolution *r = l->found;
        r->at = tree_grow(l->s, r->at, r->count, &r->room, sizeof *r->at);
        r->at[r->count++] = (expression){.map = item, .place = &n->item[i], .entry = l->entry,
                                         .path = tree_text(l->s, l->text, strlen(l->text)),
                                         .thickness = thickness};
        item->expression = (uint32_t)r->count;
    } else {
        look(l, item, length, depth + 1);
    }
    if (surfaces) memcpy(l->text, "surfaces", 9), l->entry = 0;
    else *end = 0;
}

static void look(search *l, node *n, size_t length, int depth)
{
    if (!n->holds || !n->seen) return;
    n->seen = false;
    for (size_t i = 0, breaks = 0; i < n->count; i++)
        if (n->kind == NODE_LIST || n->key[i]->kind == NODE_SCALAR)
            look_at(l, n, i, &breaks, length, depth);
}

/* ------------------------------------------------------------------ values */

static double number_or(source *s, const expression *e, const char *key, double otherwise)
{
    const node *n = tree_take(e->map, key);
    return n ? tree_read_number(s, n, key, NUMBER_FINITE) : otherwise;
}

/* s x + o of what stands at the path; NULL: why.  *needs: an expression that has to be evaluated first. */
static node *pick_up(source *s, const places *known, const expression *e, uint32_t *needs, char why[PATH_WHY])
{
    tree_map(s, e->map, "pickup");
    const node *from = tree_take(e->map, "pickup");
    const char *text = tree_read_text(s, from, "pickup");
    const bool same = !of_key(e->map, "scale") && !of_key(e->map, "offset");
    const double scale = number_or(s, e, "scale", 1), offset = number_or(s, e, "offset", 0);
    tree_finish(s, e->map, "pickup, scale, offset");
    way p;
    bool inverse;
    double x;
    char what[PATH_WHY];
    const bool is_path = sgt_path_read(&p, text, what);
    p.known = known;
    const node *n = is_path ? sgt_path_value(s->root, &p, &inverse, what) : NULL;
    if (!n) {
        snprintf(why, PATH_WHY, "picks up %.60s: %.150s", text, what);
        return NULL;
    }
    if (n->kind != NODE_SCALAR && (*needs = n->expression)) return NULL;
    if (n->kind != NODE_SCALAR && n->holds) {
        snprintf(why, PATH_WHY, "picks up %.60s, which has a pickup or solve in it", text);
        return NULL;
    }
    if (same && !inverse) {
        node *copy = tree_copy(s, n);
        copy->line = e->map->line;
        return copy;
    }
    if (!sgt_path_number(n, &x)) {
        snprintf(why, PATH_WHY, "picks up %.60s, which is no number", text);
        return NULL;
    }
    x = inverse ? 1 / x : x;
    return tree_number(s, e->map->line, same ? x : scale * x + offset);
}

/* A lens of the entries up to the solve's own. */
static void read_front(whole_lens *front, whole_lens *w, source *s, const expression *e)
{
    static const char *const keys[] = {"units", "wavelengths", "primary", "makers", "object"};
    const source kept = *s;
    node *list = tree_node(s, NODE_LIST, e->map->line), *image = tree_node(s, NODE_MAP, e->map->line);
    node *root = tree_node(s, NODE_MAP, kept.root->line), *all = NULL;
    for (size_t i = 0; i < kept.root->count; i++) {
        if (strcmp(kept.root->key[i]->text, "surfaces") == 0) all = kept.root->item[i];
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            if (strcmp(kept.root->key[i]->text, keys[k]) == 0)
                tree_set(s, root, keys[k], kept.root->item[i]);
    }
    for (size_t i = 0; i < e->entry; i++) tree_append(s, list, all->item[i]);
    tree_set(s, image, "type", tree_word(s, e->map->line, "plane"));
    tree_append(s, list, image);
    tree_set(s, root, "surfaces", list);
    s->root = root;
    *front = (whole_lens){.memory = {.allocator = s->arena->allocator}, .make = w->make,
                          .media = {.source = s, .before = w->media.before}};
    front->lens.file = s->file;
    sgt_read_lens(front, s);
    s->root = kept.root, s->remarks = kept.remarks, s->formula = kept.formula, s->in_lens = kept.in_lens;
    media *known = tree_room(s, 1, sizeof *known);
    *known = front->media;
    w->media.before = known; /* what was told of them will be told again */
}

/* The solve's value; NULL: why. */
static node *solve(whole_lens *w, source *s, const expression *e, char why[PATH_WHY])
{
    tree_map(s, e->map, "solve");
    const char *name = tree_read_text(s, tree_take(e->map, "solve"), "solve");
    if (strcmp(name, "paraxial_focus") != 0)
        tree_fail(s, e->map->line, e->path, "no solve is called \"%.60s\"; there is: paraxial_focus", name);
    const double offset = number_or(s, e, "offset", 0);
    tree_finish(s, e->map, "solve, offset");
    if (!e->thickness) tree_fail(s, e->map->line, e->path, "paraxial_focus is for a thickness");
    whole_lens *front = tree_room(s, 1, sizeof *front);
    sgt_first_order paraxial;
    sgt_error fault;
    *e->place = tree_number(s, e->map->line, 0);
    read_front(front, w, s, e);
    if (!sgt_lens_first_order(&front->lens, (double)NAN, &paraxial, NULL, &fault)) {
        snprintf(why, PATH_WHY, "paraxial_focus: %.200s", fault.words);
        return NULL;
    }
    if (!isfinite(paraxial.image)) {
        snprintf(why, PATH_WHY, "paraxial_focus: there is no paraxial image behind this surface");
        return NULL;
    }
    return tree_number(s, e->map->line, paraxial.image + offset);
}

/* ------------------------------------------------------------------- order */

static bool is_solve(const expression *e) { return !of_key(e->map, "pickup"); }

/* The first expression that a solve needs and that is not evaluated; NULL: none. */
static expression *first_needed(const resolution *r, expression *e)
{
    for (; e->next < r->count; e->next++) {
        expression *other = &r->at[e->next];
        if (other != e && !other->done && other->entry <= e->entry) return other;
    }
    return NULL;
}

_Noreturn static void tell_circle(source *s, expression *const stack[], size_t depth, const expression *e)
{
    enum { SHOWN = 6 };
    size_t from = 0;
    while (stack[from] != e) from++;
    const char *text = "";
    for (size_t i = from + 1; i < depth && i < from + SHOWN; i++)
        text = tree_print(s, "%s%s, which needs ", text, stack[i]->path);
    tree_fail(s, e->map->line, e->path, "needs itself: it needs %s%s%s", text,
              depth > from + SHOWN ? "others, which need " : "", depth == from + 1 ? "itself" : e->path);
}

static bool agrees(const expression *e, const node *value)
{
    const node *stored = e->map->is->stored;
    double x, y;
    if (!sgt_path_number(value, &x) || !sgt_path_number(stored, &y))
        return value->kind == NODE_SCALAR && stored->kind == NODE_SCALAR &&
               strcmp(value->text, stored->text) == 0;
    return is_solve(e) ? fabs(x - y) <= (e->map->is->rules ? TOLD : AGREES) * fabs(y) : x == y;
}

static void settle(source *s, expression *e, node *value, const char *why)
{
    e->done = true;
    expressed *is = e->map->is;
    const bool differs = is && is->stored && (!value || !agrees(e, value));
    if (differs && value && is->rules) {
        tree_remark(s, SGT_REMARK_TURNED, is->stored->line, is->record,
                    "%s, which its solve gives: the number that is stored is %s", value->text,
                    is->stored->text);
    } else if (differs) {
        tree_remark(s, SGT_REMARK_TURNED, is->stored->line, is->record,
                    "the number that is stored: its solve or pickup gives another");
        *e->place = is->stored, e->map = NULL;
        return;
    }
    if (!value) tree_fail(s, e->map->line, e->path, "%s", why);
    if (!is) e->map->is = is = tree_room(s, 1, sizeof *is);
    *e->place = is->value = value;
}

static void evaluate(whole_lens *w, source *s, resolution *r, expression *stack[], expression *first)
{
    size_t depth = 0;
    for (expression *next = first; next || depth;) {
        if (next) {
            if (next->waits) tell_circle(s, stack, depth, next);
            next->waits = true;
            stack[depth++] = next;
        }
        expression *e = stack[depth - 1];
        char why[PATH_WHY] = "";
        uint32_t needs = 0;
        node *value = NULL;
        if (is_solve(e)) {
            if ((next = first_needed(r, e))) continue;
            value = solve(w, s, e, why);
        } else {
            value = pick_up(s, &r->known, e, &needs, why);
            next = needs ? &r->at[needs - 1] : NULL;
            if (next) continue;
        }
        settle(s, e, value, why);
        depth--;
    }
}

const resolution *sgt_resolve(whole_lens *w, source *s)
{
    if (s->root->kind != NODE_MAP || !mark_holders(s->root, 0)) return NULL;
    resolution *r = tree_room(s, 1, sizeof *r);
    search l = {.s = s, .found = r};
    look(&l, s->root, 0, 0);
    r->known = sgt_path_places(s, s->root);
    for (size_t i = 0, solves = 0; i < r->count; i++)
        if (is_solve(&r->at[i]) && ++solves > SOLVES_MOST)
            tree_fail(s, r->at[i].map->line, r->at[i].path, "more than %d solves in one lens", SOLVES_MOST);
    expression **stack = tree_room(s, r->count, sizeof *stack);
    for (size_t i = 0; i < r->count; i++)
        if (!r->at[i].done) evaluate(w, s, r, stack, &r->at[i]);
    return r;
}

void sgt_end_resolution(const resolution *r)
{
    for (size_t i = 0; r && i < r->count; i++)
        if (r->at[i].map) *r->at[i].place = r->at[i].map;
}
