// SPDX-License-Identifier: MIT
/* list.c - the list `configurations` of a tree: where it stands, and what must be so before one is made. */
#include "list.h"

#include "../../text/number.h"

#include <string.h>

static const char LIST_KEY[] = "configurations";

node **sgt_configurations_place(const node *root)
{
    for (size_t i = 0; root && root->kind == NODE_MAP && i < root->count; i++)
        if (root->key[i]->kind == NODE_SCALAR &&
            strcmp(root->key[i]->text, LIST_KEY) == 0)
            return &root->item[i];
    return NULL;
}

node *sgt_set_aside(source *s, node **place)
{
    node *list = *place;
    *place = tree_word(s, list->line, "");
    return list;
}

bool sgt_is_configuration_name(const node *key) { return strcmp(key->text, "name") == 0; }

/* "" where not given. */
const char *sgt_name_of_configuration(const node *map)
{
    for (size_t i = 0; map->kind == NODE_MAP && i < map->count; i++)
        if (sgt_is_configuration_name(map->key[i]) && map->item[i]->kind == NODE_SCALAR)
            return map->item[i]->text;
    return "";
}

static void check_name(source *s, const node *list, size_t place)
{
    const node *map = list->item[place], *n = NULL;
    for (size_t i = 0; i < map->count; i++)
        if (sgt_is_configuration_name(map->key[i])) n = map->item[i];
    if (!n) return;
    const char *key = tree_print(s, "%s[%zu].name", LIST_KEY, place + 1), *name = tree_read_text(s, n, key);
    if (!*name) tree_fail(s, n->line, key, "empty; leave it out, and the configuration has its number");
    double x;
    if (strcmp(name, "all") == 0 || strcmp(name, "null") == 0 || strcmp(name, "~") == 0 ||
        number_read(name, &x))
        tree_fail(s, n->line, key, "\"%.60s\" would be read as a number, as none or as all of them; give "
                  "another name",
                  name);
    for (size_t i = 0; i < place; i++)
        if (strcmp(sgt_name_of_configuration(list->item[i]), name) == 0)
            tree_fail(s, n->line, key, "configuration %zu is called \"%.60s\", too", i + 1, name);
}

static void check_shape(source *s, const node *list)
{
    if (list->kind != NODE_LIST || !list->count)
        tree_fail(s, list->line, LIST_KEY,
                  "must be a list with a map for each, from paths to values, like "
                  "[{name: wide, \"surfaces[4].thickness\": 2.5}]");
    if (list->count > CONFIGURATIONS_MOST)
        tree_fail(s, list->line, LIST_KEY,
                  "there are %zu; at most %d are read", list->count, CONFIGURATIONS_MOST);
    for (size_t i = 0; i < list->count; i++) {
        const node *map = list->item[i];
        if (map->kind != NODE_MAP)
            tree_fail(s, map->line, tree_print(s, "%s[%zu]", LIST_KEY, i + 1),
                      "must be a map from paths to values, like {\"surfaces[4].thickness\": 2.5}");
        tree_map(s, map, tree_print(s, "%s[%zu]", LIST_KEY, i + 1)); /* no key stands twice */
        check_name(s, list, i);
    }
}

void sgt_tell_configurations(source *s, const node *list)
{
    enum { NAMED = 12 };
    check_shape(s, list);
    const char *names = "";
    for (size_t i = 0; i < list->count && i < NAMED; i++) {
        const char *name = sgt_name_of_configuration(list->item[i]);
        names = tree_print(s, "%s%s%.60s", names, i ? ", " : "", *name ? name : tree_print(s, "%zu", i + 1));
    }
    tree_remark(s, SGT_REMARK_NOTE, list->line, LIST_KEY,
                "the file has %zu (%s%s), and this is the lens of its own values; a configuration is asked "
                "for by its number or name", list->count, names, list->count > NAMED ? ", ..." : "");
}
