// SPDX-License-Identifier: MIT
/* vary.c - configurations as the differences of trees.
 *
 * A reader of another format makes the tree of one configuration, as it always has.  So the text is read once
 * for each, and what the tree of a configuration has otherwise than that of the base becomes a path and a
 * value (../open/configure.c): no second way is needed to say what a record means in a configuration.
 *
 * WHY IT IS EXACT.  The paths are made so that the base with these values put into it has the same
 * values at the same places as the tree that was read:
 *   - of two maps, a key that only the new one has is set, and one that only the old one has is set to null,
 *     which removes it; if the types of two surfaces differ the whole map is set;
 *   - of two lists of the same length the entries are compared; of others the whole list is set;
 *   - of two words the new one is set.
 * Only the order of keys within a map may differ, and none means anything.  The test `configurations`
 * compares each with the lens that the reader makes of it alone.
 *
 * Time and memory are those of reading the text `count` times; so a text that is too long for that is left
 * with its base (TEXT_MOST), and so are more configurations than a lens file may have. */
#include "vary.h"

#include <stdio.h>
#include <string.h>

enum { CONFIGURATIONS_MOST = 1000, TEXT_MOST = 1 << 25 };

typedef struct varying { source *s; node *map; } varying;

static bool same(const node *a, const node *b)
{
    if (a == b) return true;
    if (a->kind != b->kind) return false;
    if (a->kind == NODE_SCALAR) return a->quoted == b->quoted && strcmp(a->text, b->text) == 0;
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++)
        if ((a->kind == NODE_MAP && strcmp(a->key[i]->text, b->key[i]->text) != 0) ||
            !same(a->item[i], b->item[i]))
            return false;
    return true;
}

static node *value_at_key(const node *map, const char *key)
{
    for (size_t i = 0; map->kind == NODE_MAP && i < map->count; i++)
        if (strcmp(map->key[i]->text, key) == 0) return map->item[i];
    return NULL;
}

static bool same_word(const node *a, const node *b)
{
    if (!a || !b) return a == b;
    return a->kind == NODE_SCALAR && b->kind == NODE_SCALAR && strcmp(a->text, b->text) == 0;
}

static bool varies_break(const node *entry)
{
    const node *type = value_at_key(entry, "type");
    return type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
}

static void put_other(varying *v, const char *path, size_t line, node *value)
{
    node *key = tree_word(v->s, line, path);
    tree_put(v->s, v->map, key, value);
}

static void vary_map(varying *v, const char *path, const node *a, const node *b);
static void vary_list(varying *v, const char *path, const node *a, node *b);

static void vary_value(varying *v, const char *path, const node *a, node *b)
{
    if (same(a, b)) return;
    const bool maps = a->kind == NODE_MAP && b->kind == NODE_MAP;
    if (maps && same_word(value_at_key(a, "type"), value_at_key(b, "type")))
        vary_map(v, path, a, b);
    else if (a->kind == NODE_LIST && b->kind == NODE_LIST && a->count == b->count)
        vary_list(v, path, a, b);
    else put_other(v, path, b->line, b);
}

static void vary_map(varying *v, const char *path, const node *a, const node *b)
{
    for (size_t i = 0; i < a->count; i++)
        if (!value_at_key(b, a->key[i]->text))
            put_other(v, tree_print(v->s, "%s%s%s", path, *path ? "." : "", a->key[i]->text), b->line,
                tree_word(v->s, b->line, "null"));
    for (size_t i = 0; i < b->count; i++) {
        const char *key = b->key[i]->text;
        node *was = value_at_key(a, key), *is = b->item[i];
        if (!*path && strcmp(key, "name") == 0) continue; /* that is the name of a configuration */
        const char *at = tree_print(v->s, "%s%s%s", path, *path ? "." : "", key);
        if (was) vary_value(v, at, was, is);
        else put_other(v, at, is->line, is);
    }
}

/* A list of words is set as a whole where more than one differs: it is easier to read. */
static bool is_plain(const node *a, const node *b)
{
    size_t other = 0;
    for (size_t i = 0; i < a->count; i++) {
        if (a->item[i]->kind != NODE_SCALAR || b->item[i]->kind != NODE_SCALAR) return false;
        other += !same(a->item[i], b->item[i]);
    }
    return other > 1;
}

static void vary_list(varying *v, const char *path, const node *a, node *b)
{
    const bool surfaces = strcmp(path, "surfaces") == 0;
    for (size_t i = 0; surfaces && i < a->count; i++)
        if (varies_break(a->item[i]) != varies_break(b->item[i])) { /* others have their numbers then */
            put_other(v, path, b->line, b);
            return;
        }
    if (is_plain(a, b)) {
        put_other(v, path, b->line, b);
        return;
    }
    for (size_t i = 0, breaks = 0; i < a->count; i++) {
        const bool is_break = surfaces && varies_break(a->item[i]);
        if (is_break) vary_value(v, tree_print(v->s, "breaks[%zu]", ++breaks), a->item[i], b->item[i]);
        else vary_value(v, tree_print(v->s, "%s[%zu]", path, i + 1 - breaks), a->item[i], b->item[i]);
    }
}

static bool read_aside(source *own, void (*read)(source *s))
{
    jmp_buf here;
    own->refused = &here;
    if (setjmp(here) != 0) return false;
    read(own);
    return true;
}

/* The tree of a configuration; a fault ends the reading. */
static node *read_configuration(source *s, size_t number, const char *what, void (*read)(source *s))
{
    sgt_lens_options options = *s->options;
    source own = *s;
    options.configuration = (int)number;
    own.options = &options, own.root = NULL, own.varies = true;
    own.remark = NULL, own.remarks = own.remark_room = 0;
    own.comment = NULL, own.comments = own.comment_room = 0;
    if (!read_aside(&own, read)) {
        char words[sizeof s->error->words];
        snprintf(words, sizeof words, "%s %zu: %.1200s", what, number, s->error->words);
        memcpy(s->error->words, words, sizeof words);
        longjmp(*s->refused, 1);
    }
    return own.root;
}

bool sgt_vary(source *s, size_t count, size_t line, const char *key, const char *what,
              void (*read)(source *s))
{
    if (count > CONFIGURATIONS_MOST || s->length > TEXT_MOST / count) {
        tree_remark(s, SGT_REMARK_LEFT_OUT, line, key,
                    "the others of %zu: at most %d are read, and not of a file so long; --configuration N "
                    "reads another", count, CONFIGURATIONS_MOST);
        return false;
    }
    node *list = tree_node(s, NODE_LIST, line);
    for (size_t k = 1; k <= count; k++) {
        varying v = {.s = s, .map = tree_node(s, NODE_MAP, line)};
        vary_map(&v, "", s->root, read_configuration(s, k, what, read));
        tree_append(s, list, v.map);
    }
    tree_set(s, s->root, "configurations", list);
    return true;
}
