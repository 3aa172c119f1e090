// SPDX-License-Identifier: MIT
/* insert.c - what stands in lists and maps comes and goes. */
#include "edit.h"

#include <string.h>

/* A gap in a list: in front of what has the place, or behind all. */
void sgt_edit_insert(const editing *e, node *value)
{
    source *s = e->s;
    char why[PATH_WHY];
    way p = e->at;
    spot list, at;
    const path_step *last = &p.step[p.count - 1];
    if (p.count < 2 || !(last->name || !last->text))
        sgt_edit_refuse(e, "no place in a list; write it as surfaces[3]");
    if (!sgt_path_find(s->root, &p, p.count - 1, &list, why)) sgt_edit_refuse(e, "%s", why);
    if (!list.is || list.is->kind != NODE_LIST) sgt_edit_refuse(e, "no list is there");
    if (!sgt_path_find(s->root, &p, p.count, &at, why)) {
        way before = p;
        const bool first = !last->text && last->place == 1, end = !last->text && last->place > 1;
        if (end) before.step[p.count - 1].place--;
        if (!first && !(end && sgt_path_find(s->root, &before, p.count, &at, why)))
            sgt_edit_refuse(e, "%s", why);
        at.at = list.is->count;
    }
    const references all = sgt_edit_references(e);
    if (at.at < list.is->count) sgt_edit_keep_places(e, list.is);
    tree_append(s, list.is, value);
    memmove(list.is->item + at.at + 1, list.is->item + at.at,
            (list.is->count - 1 - at.at) * sizeof *list.is->item);
    list.is->item[at.at] = value;
    sgt_edit_refer(e, &all);
}

void sgt_edit_remove(const editing *e)
{
    char why[PATH_WHY];
    spot at;
    if (!sgt_path_find(e->s->root, &e->at, e->at.count, &at, why)) sgt_edit_refuse(e, "%s", why);
    if (!at.is) sgt_edit_refuse(e, "not given in the file");
    const references all = sgt_edit_references(e);
    if (at.in->kind == NODE_LIST) sgt_edit_keep_places(e, at.in);
    tree_remove(at.in, at.at);
    sgt_edit_refer(e, &all);
}
