// SPDX-License-Identifier: MIT
/* put.c - places for values in a tree. */
#include "put.h"

#include <string.h>

/* Makes the maps on the way to a key that are missing. */
static void add_maps(source *s, const way *p)
{
    char why[PATH_WHY];
    for (size_t i = 1; i < p->count; i++) {
        spot at;
        const path_step *step = &p->step[i];
        if (!sgt_path_find(s->root, p, i, &at, why)) return;
        if (at.is) continue;
        if (step->name || !step->text) return;
        tree_put(s, at.in, tree_scalar(s, at.in->line, p->step[i - 1].text, p->step[i - 1].length),
                 tree_node(s, NODE_MAP, at.in->line));
    }
}

/* A place for a key that the map has not: that of a key which says the same in another way, or a new one. */
static node **new_place(source *s, node *map, const way *p, size_t *line, node **old)
{
    const path_step *step = &p->step[p->count - 1];
    const bool in_pupil = p->count == 2 && sgt_step_is(&p->step[0], "pupil");
    char room[PATH_KEY];
    const char *rival;
    node *key = tree_scalar(s, *line ? *line : map->line, step->text, step->length);
    for (int i = 0; (rival = sgt_path_rival(key->text, in_pupil, i, room)); i++)
        for (size_t k = 0; k < map->count; k++) {
            if (strcmp(map->key[k]->text, rival) != 0) continue;
            if (!*line) *line = key->line = map->key[k]->line;
            map->key[k] = key, *old = map->item[k], map->item[k] = NULL;
            return &map->item[k];
        }
    tree_put(s, map, key, NULL);
    if (!*line) *line = map->line;
    return &map->item[map->count - 1];
}

node **sgt_put_place(source *s, const way *p, const char *path, size_t *line, node **old)
{
    char why[PATH_WHY];
    spot at;
    add_maps(s, p);
    if (!sgt_path_find(s->root, p, p->count, &at, why)) tree_fail(s, *line, path, "%s", why);
    *old = at.is;
    if (!at.is) return new_place(s, at.in, p, line, old);
    if (!*line) *line = at.is->line;
    return &at.in->item[at.at];
}
