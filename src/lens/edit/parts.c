// SPDX-License-Identifier: MIT
/* parts.c - what the changes of a tree share: what is refused, and the parts of it that they look at. */
#include "edit.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void sgt_edit_refuse(const editing *e, const char *words, ...)
{
    char text[600];
    va_list more;
    va_start(more, words);
    vsnprintf(text, sizeof text, words, more);
    va_end(more);
    tree_fail(e->s, 0, e->edit->path ? e->edit->path : "", "%s", text);
}

void sgt_edit_refuse_file(const editing *e, const node *n, const char *key)
{
    tree_fail(e->s, n->line, e->edit->path ? e->edit->path : "",
              "the numbers of %s stand in a file, %.200s, which is not changed; write them here", key,
              n->text);
}

way sgt_edit_way(const editing *e, const char *text)
{
    char why[PATH_WHY];
    way p;
    if (!sgt_path_read(&p, text ? text : "", why)) sgt_edit_refuse(e, "%s", why);
    return p;
}

node *sgt_edit_surfaces(const editing *e)
{
    const node *root = e->s->root;
    for (size_t i = 0; root->kind == NODE_MAP && i < root->count; i++)
        if (strcmp(root->key[i]->text, "surfaces") == 0 && root->item[i]->kind == NODE_LIST)
            return root->item[i];
    sgt_edit_refuse(e, "there are no surfaces");
}

const sgt_builtin *sgt_edit_type(const editing *e, const node *map)
{
    const sgt_builtin *const several[] = {sgt_builtins(), e->s->options->types};
    const char *name = "";
    for (size_t i = 0; map->kind == NODE_MAP && i < map->count; i++)
        if (strcmp(map->key[i]->text, "type") == 0 && map->item[i]->kind == NODE_SCALAR)
            name = map->item[i]->text;
    for (int i = 0; i < 2; i++)
        for (const sgt_builtin *b = several[i]; b && b->type; b++)
            if (strcmp(b->type, name) == 0) return b;
    return NULL;
}
