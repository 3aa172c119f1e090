// SPDX-License-Identifier: MIT
/* references.c - pickups, tolerances and configurations go on meaning the same surface when others come,
 * go or change places.
 *
 * They name a surface by its number.  Before the list changes the entry that is meant is noted, and
 * behind it the number is written anew; so its other words stay as they are.  A name goes on meaning what is
 * called so.  What is picked up and removed is a fault: another surface would take its number. */
#include "edit.h"

#include "../../text/number.h"

#include <stdio.h>
#include <string.h>

typedef struct gathering {
    const editing *e;
    references found;
    node *in;
    size_t base; /* where the path behind `in` begins */
    places known;
    char text[SGT_PATH_SIZE];
} gathering;

static bool lies(const node *entry)
{
    for (size_t i = 0; entry->kind == NODE_MAP && i < entry->count; i++)
        if (strcmp(entry->key[i]->text, "type") == 0)
            return entry->item[i]->kind == NODE_SCALAR && strcmp(entry->item[i]->text, "break") == 0;
    return false;
}

/* A pickup that names an entry of `surfaces` by its number. */
static void gather_pickup(gathering *g, node *map, size_t key)
{
    const editing *e = g->e;
    const node *from = map->item[key];
    char why[PATH_WHY];
    way p;
    spot at;
    if (from->kind != NODE_SCALAR || !sgt_path_read(&p, from->text, why) || p.count < 2) return;
    if (!(sgt_step_is(&p.step[0], "surfaces") || sgt_step_is(&p.step[0], "breaks"))) return;
    p.known = &g->known;
    if (!sgt_path_find(e->s->root, &p, 2, &at, why)) return;
    references *r = &g->found;
    const char *rest = strchr(from->text, ']');
    if (p.step[1].text) rest = NULL; /* by its name: nothing to write anew */
    r->at = tree_grow(e->s, r->at, r->count, &r->room, sizeof *r->at);
    r->at[r->count++] = (reference){.map = map,
                                    .pickup = key,
                                    .entry = at.is,
                                    .in = g->in,
                                    .rest = rest ? rest + 1 : NULL,
                                    .own = tree_text(e->s, g->text + g->base, strlen(g->text + g->base)),
                                    .path = tree_text(e->s, g->text, strlen(g->text))};
}

static void gather(gathering *g, node *n, size_t length, int depth)
{
    enum { DEPTH = 32 };
    if (n->kind == NODE_SCALAR || depth > DEPTH) return;
    const bool surfaces = depth == 1 && n->kind == NODE_LIST && strcmp(g->text, "surfaces") == 0;
    for (size_t i = 0, breaks = 0; i < n->count; i++) {
        const size_t room = sizeof g->text - length;
        const bool key = n->kind == NODE_MAP, is_break = surfaces && lies(n->item[i]);
        size_t more = length;
        if (is_break)
            more = (size_t)snprintf(g->text, sizeof g->text, "breaks[%zu]", ++breaks);
        else if (key)
            more += (size_t)snprintf(g->text + length, room, "%s%s", depth ? "." : "", n->key[i]->text);
        else
            more += (size_t)snprintf(g->text + length, room, "[%zu]", i + 1 - breaks);
        if (more >= sizeof g->text) more = sizeof g->text - 1;
        if (surfaces) g->in = n->item[i], g->base = more;
        if (key && strcmp(n->key[i]->text, "pickup") == 0) {
            g->text[length] = 0;
            gather_pickup(g, n, i);
        } else {
            gather(g, n->item[i], more, depth + 1);
        }
        if (surfaces)
            memcpy(g->text, "surfaces", 9), g->in = NULL, g->base = 0;
        else
            g->text[length] = 0;
    }
}

/* A surface that a tolerance names, in place i of `in`. */
static void gather_surface(gathering *g, node *in, size_t i, const char *path)
{
    const editing *e = g->e;
    const node *n = in->item[i];
    if (n->kind != NODE_SCALAR) return;
    char why[PATH_WHY];
    way p = {.count = 2, .step = {{.text = "surfaces", .length = 8}, {.text = n->text, .name = true}}};
    long number;
    spot at;
    p.step[1].length = strlen(n->text);
    const bool by_number = !n->quoted && number_read_integer(n->text, 1, INT32_MAX, &number);
    if (by_number) p.step[1] = (path_step){.place = (size_t)number};
    if (!sgt_path_find(e->s->root, &p, 2, &at, why)) return;
    references *r = &g->found;
    r->at = tree_grow(e->s, r->at, r->count, &r->room, sizeof *r->at);
    r->at[r->count++] = (reference){.map = in, .pickup = i, .entry = at.is, .rest = by_number ? "" : NULL,
                                    .path = path, .word = n};
}

static void gather_tolerances(gathering *g)
{
    const editing *e = g->e;
    const node *root = e->s->root, *list = NULL;
    for (size_t i = 0; root->kind == NODE_MAP && i < root->count; i++)
        if (strcmp(root->key[i]->text, "tolerances") == 0) list = root->item[i];
    for (size_t i = 0; list && list->kind == NODE_LIST && i < list->count; i++) {
        node *map = list->item[i];
        const char *path = tree_print(e->s, "tolerances[%zu]", i + 1);
        for (size_t k = 0; map->kind == NODE_MAP && k < map->count; k++) {
            node *value = map->item[k];
            if (strcmp(map->key[k]->text, "surface") == 0) gather_surface(g, map, k, path);
            if (strcmp(map->key[k]->text, "surfaces") == 0 && value->kind == NODE_LIST)
                for (size_t j = 0; j < value->count; j++) gather_surface(g, value, j, path);
        }
    }
}

static const node *configuration_list(const editing *e)
{
    const node *root = e->s->root;
    for (size_t i = 0; root->kind == NODE_MAP && i < root->count; i++)
        if (strcmp(root->key[i]->text, "configurations") == 0 && root->item[i]->kind == NODE_LIST)
            return root->item[i];
    return NULL;
}

/* The keys of configurations that are paths to an entry of `surfaces`. */
static void gather_configurations(gathering *g)
{
    const editing *e = g->e;
    const node *list = configuration_list(e);
    for (size_t i = 0; list && i < list->count; i++) {
        node *map = list->item[i];
        const char *path = tree_print(e->s, "configurations[%zu]", i + 1);
        for (size_t k = 0; map->kind == NODE_MAP && k < map->count; k++) {
            const node *key = map->key[k];
            char why[PATH_WHY];
            way p;
            spot at;
            if (!sgt_path_read(&p, key->text, why) || p.count < 2) continue;
            if (!(sgt_step_is(&p.step[0], "surfaces") || sgt_step_is(&p.step[0], "breaks"))) continue;
            p.known = &g->known;
            if (!sgt_path_find(e->s->root, &p, 2, &at, why)) continue;
            references *r = &g->found;
            const char *rest = p.step[1].text ? NULL : strchr(key->text, ']');
            r->at = tree_grow(e->s, r->at, r->count, &r->room, sizeof *r->at);
            r->at[r->count++] =
                (reference){.map = map, .pickup = k, .entry = at.is, .path = path, .word = key,
                            .rest = rest ? rest + 1 : NULL, .key = true};
        }
    }
}

void sgt_edit_keep_places(const editing *e, const node *changed)
{
    const node *list = configuration_list(e);
    for (size_t i = 0; list && i < list->count; i++) {
        const node *map = list->item[i];
        for (size_t k = 0; map->kind == NODE_MAP && k < map->count; k++) {
            char why[PATH_WHY];
            way p;
            spot at;
            if (!sgt_path_read(&p, map->key[k]->text, why)) continue;
            const bool entry = sgt_step_is(&p.step[0], "surfaces") || sgt_step_is(&p.step[0], "breaks");
            for (size_t step = entry ? 2 : 1; step < p.count; step++)
                if (!p.step[step].text && sgt_path_find(e->s->root, &p, step, &at, why) && at.is == changed)
                    sgt_edit_refuse(e, "configurations[%zu] sets %.100s, a place in this list; remove that "
                                    "first", i + 1, map->key[k]->text);
        }
    }
}

references sgt_edit_references(const editing *e)
{
    gathering g = {.e = e, .known = sgt_path_places(e->s, e->s->root)};
    gather(&g, e->s->root, 0, 0);
    gather_tolerances(&g);
    gather_configurations(&g);
    return g.found;
}

/* Is it still in the tree? */
static bool stands(const node *n, const node *sought, int depth)
{
    enum { DEPTH_OF_TREE = 8 };
    if (n == sought) return true;
    for (size_t i = 0; n->kind != NODE_SCALAR && depth < DEPTH_OF_TREE && i < n->count; i++)
        if (stands(n->item[i], sought, depth + 1)) return true;
    return false;
}

/* The path of a configuration by the new number of its surface. */
static void refer_key(const editing *e, const reference *r)
{
    const node *was = r->word;
    if (!stands(e->s->root, r->map, 0)) return; /* it was removed itself */
    const unsigned place = r->entry->expression;
    if (!place) sgt_edit_refuse(e, "%s sets %.100s, which would be gone", r->path, was->text);
    if (!r->rest) return;
    const char *list = lies(r->entry) ? "breaks" : "surfaces";
    node *key = tree_word(e->s, was->line, tree_print(e->s, "%s[%u]%s", list, place, r->rest));
    key->quoted = was->quoted;
    r->map->key[r->pickup] = key;
}

/* The surface of a tolerance by its new number. */
static void refer_tolerance(const editing *e, const reference *r)
{
    const node *was = r->word;
    if (!stands(e->s->root, was, 0)) return; /* it was removed itself */
    const unsigned place = r->entry->expression;
    if (!place) sgt_edit_refuse(e, "%s is of surface %s, which would be gone", r->path, was->text);
    if (!r->rest) return;
    node *number = tree_word(e->s, was->line, tree_print(e->s, "%u", place));
    number->number = was->number;
    r->map->item[r->pickup] = number;
}

void sgt_edit_refer(const editing *e, const references *all)
{
    if (!all->count) return;
    const node *list = sgt_edit_surfaces(e);
    uint32_t surfaces = 0, breaks = 0;
    for (size_t i = 0; i < list->count; i++) /* its new number, for a while */
        if (list->item[i]->kind == NODE_MAP)
            list->item[i]->expression = lies(list->item[i]) ? ++breaks : ++surfaces;
    for (size_t i = 0; i < all->count; i++) {
        const reference *r = &all->at[i];
        if (r->word) {
            (r->key ? refer_key : refer_tolerance)(e, r);
            continue;
        }
        if (r->in && !r->in->expression) continue; /* it went with its own surface */
        if (!r->entry->expression)
            sgt_edit_refuse(e, "%s picks up %s, which would be gone", r->path, r->map->item[r->pickup]->text);
        if (!r->rest) continue;
        const char *text = tree_print(e->s, "%s[%u]%s", lies(r->entry) ? "breaks" : "surfaces",
                                      (unsigned)r->entry->expression, r->rest);
        node *word = tree_word(e->s, r->map->item[r->pickup]->line, text);
        word->quoted = true;
        r->map->item[r->pickup] = word;
    }
    for (size_t i = 0; i < list->count; i++) list->item[i]->expression = 0;
}
