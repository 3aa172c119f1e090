// SPDX-License-Identifier: MIT
/* tree.c - building the tree of a lens file, and reading the values in it. */
#include "tree.h"

#include "../../text/number.h"
#include "../base/reader.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------- errors and memory */

void tree_fail(source *s, size_t line, const char *key, const char *words, ...)
{
    sgt_error *e = s->error;
    *e = (sgt_error){.line = line};
    size_t length = strlen(s->file), cut = length < sizeof e->file ? 0 : length - sizeof e->file + 1;
    memcpy(e->file, s->file + cut, length - cut);
    snprintf(e->key, sizeof e->key, "%s", key ? key : "");
    va_list more;
    va_start(more, words);
    vsnprintf(e->words, sizeof e->words, words, more);
    va_end(more);
    longjmp(*s->refused, 1);
}

void *tree_room(source *s, size_t count, size_t size)
{
    void *data = size && count > SIZE_MAX / 2 / size ? NULL : sgt_arena_take(s->arena, count * size);
    if (!data) tree_fail(s, 0, NULL, "no memory");
    memset(data, 0, count * size);
    return data;
}

void *tree_grow(source *s, void *old, size_t count, size_t *room, size_t size)
{
    if (count < *room) return old;
    size_t more = *room ? 2 * *room : 4;
    void *grown = tree_room(s, more, size);
    if (count) memcpy(grown, old, count * size);
    *room = more;
    return grown;
}

char *tree_text(source *s, const char *text, size_t length)
{
    char *copy = tree_room(s, length + 1, 1);
    if (length) memcpy(copy, text, length);
    return copy;
}

enum { SENTENCE = 1200 };

SGT_PRINTF(2, 0) static const char *sentence(source *s, const char *words, va_list more)
{
    char text[SENTENCE];
    vsnprintf(text, sizeof text, words, more);
    return tree_text(s, text, strlen(text));
}

char *tree_print(source *s, const char *words, ...)
{
    char text[SENTENCE];
    va_list more;
    va_start(more, words);
    vsnprintf(text, sizeof text, words, more);
    va_end(more);
    return tree_text(s, text, strlen(text));
}

void tree_remark(source *s, sgt_remark_kind kind, size_t line, const char *key, const char *words, ...)
{
    static const char *const begins[] = {[SGT_REMARK_NOTE] = "", [SGT_REMARK_TURNED] = "taken as ",
                                         [SGT_REMARK_LEFT_OUT] = "left out: "};
    va_list more;
    va_start(more, words);
    s->remark = tree_grow(s, s->remark, s->remarks, &s->remark_room, sizeof *s->remark);
    s->remark[s->remarks++] = (sgt_lens_remark){.kind = kind, .line = line,
                                                .key = tree_text(s, key ? key : "", key ? strlen(key) : 0),
                                                .words = tree_print(s, "%s%s", begins[kind],
                                                                    sentence(s, words, more))};
    va_end(more);
}

void tree_remark_again(source *s, const sgt_lens_remark *r, size_t line, const char *key)
{
    s->remark = tree_grow(s, s->remark, s->remarks, &s->remark_room, sizeof *s->remark);
    s->remark[s->remarks++] = (sgt_lens_remark){.kind = r->kind, .line = line,
                                                .key = tree_text(s, key, strlen(key)),
                                                .words = tree_text(s, r->words, strlen(r->words))};
}

void tree_comment(source *s, const char *text)
{
    s->comment = tree_grow(s, s->comment, s->comments, &s->comment_room, sizeof *s->comment);
    s->comment[s->comments++] = text;
}

/* ---------------------------------------------------------------- building */

/* The tree stays as long as its lens, and that of a long lens is most of its memory.  So nodes are packed:
 * a scalar has no more than it needs, with its text behind it, or the text of one before. */
static void *packed(source *s, size_t count, size_t size)
{
    void *data = count > SIZE_MAX / 2 / size ? NULL : sgt_arena_pack(s->arena, count * size);
    if (!data) tree_fail(s, 0, NULL, "no memory");
    memset(data, 0, count * size);
    return data;
}

node *tree_node(source *s, node_kind kind, size_t line)
{
    node *n = packed(s, 1, sizeof *n);
    n->kind = kind, n->line = (uint32_t)line;
    return n;
}

/* The place of a text among those that were met. */
static met_text *met_at(source *s, const char *text, size_t length)
{
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < length; i++) hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return &s->met[(hash ^ hash >> 16) % TEXTS_MET];
}

node *tree_scalar(source *s, size_t line, const char *text, size_t length)
{
    enum { FIRST = offsetof(node, count), SHORT = 32 };
    met_text none = {.text = NULL}, *met = length <= SHORT ? met_at(s, text, length) : &none;
    const bool known = met->text && met->length == length && memcmp(met->text, text, length) == 0;
    char *all = packed(s, known ? FIRST : FIRST + length + 1, 1);
    node *n = (void *)all;
    if (!known && length) memcpy(all + FIRST, text, length);
    if (!known) *met = (met_text){all + FIRST, length};
    n->kind = NODE_SCALAR, n->line = (uint32_t)line, n->text = met->text;
    return n;
}

/* Makes room for `more` in all in a list or map. */
static void widen(source *s, node *n, size_t more)
{
    node **item = packed(s, more, sizeof *item);
    node **key = n->kind == NODE_MAP ? packed(s, more, sizeof *key) : NULL;
    if (n->count) memcpy(item, n->item, n->count * sizeof *item);
    if (n->count && key) memcpy(key, n->key, n->count * sizeof *key);
    if (key) n->taken = packed(s, more, sizeof *n->taken);
    n->item = item, n->key = key, n->room = (uint32_t)more;
}

void tree_expect(source *s, node *n, size_t more)
{
    if (n->room < n->count + more) widen(s, n, n->count + more);
}

/* Makes room for one more in a list or map. */
static void grow(source *s, node *n)
{
    enum { SMALL = 6 }; /* the keys of most surfaces */
    if (n->count == n->room) widen(s, n, n->room ? 2 * (size_t)n->room : SMALL);
}

void tree_append(source *s, node *list, node *item)
{
    grow(s, list);
    list->item[list->count++] = item;
}

void tree_put(source *s, node *map, node *key, node *value)
{
    grow(s, map);
    map->key[map->count] = key;
    map->item[map->count++] = value;
}

void tree_remove(node *from, size_t place)
{
    for (size_t i = place; i + 1 < from->count; i++) {
        from->item[i] = from->item[i + 1];
        if (from->kind == NODE_MAP) from->key[i] = from->key[i + 1];
    }
    from->count--;
}

void tree_set(source *s, node *map, const char *key, node *value)
{
    tree_put(s, map, tree_word(s, value->line, key), value);
}

node *tree_word(source *s, size_t line, const char *text)
{
    return tree_scalar(s, line, text, strlen(text));
}

node *tree_number(source *s, size_t line, double x)
{
    char text[NUMBER_SIZE];
    number_print(text, x, false);
    return tree_word(s, line, isnan(x) ? ".nan" : isinf(x) ? (x > 0 ? ".inf" : "-.inf") : text);
}

node *tree_numbers(source *s, size_t line, size_t count, const double x[])
{
    node *list = tree_node(s, NODE_LIST, line);
    list->inline_ = true;
    for (size_t i = 0; i < count; i++) tree_append(s, list, tree_number(s, line, x[i]));
    return list;
}

/* An alias of YAML becomes a node of its own.  A reader visits a node as often as the file names it, so the
 * copy of a lens that was read takes no longer than its reading. */
node *tree_copy(source *s, const node *n)
{
    node *copy;
    if (n->kind == NODE_SCALAR) {
        copy = tree_scalar(s, n->line, n->text, strlen(n->text));
    } else {
        copy = tree_node(s, n->kind, n->line);
        tree_expect(s, copy, n->count);
        for (; copy->count < n->count; copy->count++) {
            copy->item[copy->count] = tree_copy(s, n->item[copy->count]);
            if (n->kind == NODE_MAP) copy->key[copy->count] = tree_copy(s, n->key[copy->count]);
        }
    }
    copy->quoted = n->quoted, copy->inline_ = n->inline_, copy->number = n->number;
    return copy;
}

void tree_forget_numbers(node *n)
{
    n->number = false;
    for (size_t i = 0; n->kind != NODE_SCALAR && i < n->count; i++) tree_forget_numbers(n->item[i]);
}

/* ----------------------------------------------------------------- reading */

/* A set of words, by hashing: open addressing, at most half full. */
typedef struct words { const char **place; size_t count, room; } words;

static const char **word_place(const words *all, const char *text)
{
    size_t hash = 14695981039346656037u & SIZE_MAX; /* FNV-1a: Fowler, Noll, Vo */
    for (const char *c = text; *c; c++) hash = (hash ^ (unsigned char)*c) * (1099511628211u & SIZE_MAX);
    const char **place;
    do place = &all->place[hash++ & (all->room - 1)];
    while (*place && strcmp(*place, text) != 0);
    return place;
}

/* Adds a word; false: it is there already. */
static bool add_word(source *s, words *all, const char *text)
{
    if (2 * all->count >= all->room) {
        words more = {.room = all->room ? 2 * all->room : 64, .count = all->count};
        more.place = tree_room(s, more.room, sizeof *more.place);
        for (size_t i = 0; i < all->room; i++)
            if (all->place[i]) *word_place(&more, all->place[i]) = all->place[i];
        *all = more;
    }
    const char **place = word_place(all, text);
    if (*place) return false;
    *place = text;
    all->count++;
    return true;
}

/* No valid map has more keys.  In a larger one, double keys are found by hashing and not pair by pair. */
enum { KEYS_MANY = 64 };

void tree_map(source *s, const node *n, const char *key)
{
    if (n->kind != NODE_MAP)
        tree_fail(s, n->line, key, "must be a map of keys and values, as {key: value}");
    words seen = {.count = 0};
    for (size_t i = 0; i < n->count; i++) {
        const node *k = n->key[i];
        if (k->kind != NODE_SCALAR) tree_fail(s, k->line, key, "a key must be a word");
        bool twice = n->count > KEYS_MANY && !add_word(s, &seen, k->text);
        for (size_t j = 0; j < i && n->count <= KEYS_MANY; j++)
            twice = twice || strcmp(n->key[j]->text, k->text) == 0;
        if (twice) tree_fail(s, k->line, k->text, "given twice");
        n->taken[i] = false;
    }
}

node *tree_take(const node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++) {
        if (strcmp(map->key[i]->text, key) != 0) continue;
        map->taken[i] = true;
        return map->item[i];
    }
    return NULL;
}

/* The word of a list such as "curvature or radius, conic; thickness" that is nearest to a key, if it is
 * near. */
static piece nearest_word(const char *key, const char *known)
{
    static const char between[] = ", ;";
    piece near = {NULL, NULL}, own = {key, key + strlen(key)};
    size_t least = (size_t)(own.end - own.begin) / 3 + 1;
    for (const char *at = known; *at;) {
        piece word = {at, at + strcspn(at, between)};
        size_t apart = sgt_reader_distance(own, word);
        if (word.end > word.begin && apart < least) near = word, least = apart;
        at = word.end + strspn(word.end, between);
    }
    return near;
}

/* The word of the list by which a lens file says what other programs, and people, say by this key. */
static piece usual_word(const char *key, const char *known)
{
    static const char *const usual[][2] = {
        {"n", "index"}, {"ior", "index"}, {"refractive_index", "index"}, {"material", "glass"},
        {"medium", "glass"}, {"r", "radius"}, {"roc", "radius"}, {"radius_of_curvature", "radius"},
        {"c", "curvature"}, {"k", "conic"}, {"kappa", "conic"}, {"conic_constant", "conic"},
        {"distance", "thickness"}, {"d", "thickness"}, {"t", "thickness"}, {"diameter", "semi_diameter"},
        {"aperture", "pupil"}, {"epd", "pupil"},
        {"entrance_pupil", "pupil"}, {"height", "h"}, {"altitude", "h"}, {"angles", "fields"},
        {"field_of_view", "fields"}, {"elements", "surfaces"}, {"system", "surfaces"},
        {"title", "name"}, {"f", "focal_length"}, {"focal", "focal_length"},
        {"order", "orders"}, {"tilt_x", "tilt"}, {"decenter_x", "decenter"}, {"reflective", "mirror"}};
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++) {
        const size_t length = strlen(usual[i][1]);
        const piece own = {key, key + strlen(key)}, other = {usual[i][0], usual[i][0] + strlen(usual[i][0])};
        if (sgt_reader_distance(own, other) > 0) continue;
        for (const char *at = known; *at;) {
            const size_t word = strcspn(at, ", ;");
            if (word == length && memcmp(at, usual[i][1], length) == 0) return (piece){at, at + word};
            at += word + strspn(at + word, ", ;");
        }
    }
    return (piece){NULL, NULL};
}

void tree_finish(source *s, const node *map, const char *known)
{
    for (size_t i = 0; i < map->count; i++)
        if (!map->taken[i]) {
            const char *key = map->key[i]->text;
            bool digits = *key && key[strspn(key, "0123456789")] == 0; /* {radius: 51,68} */
            piece near = usual_word(key, known);
            if (!near.begin) near = nearest_word(key, known);
            if (near.begin)
                tree_fail(s, map->key[i]->line, key, "unknown key; did you mean %.*s?  Known here: %s",
                          (int)(near.end - near.begin), near.begin, known);
            tree_fail(s, map->key[i]->line, key, "unknown key; %sknown here: %s",
                      digits ? "was a decimal comma written?  Use a decimal point; "
                      : strchr(key, ':') ? "is a blank missing behind its colon?  " : "", known);
        }
}

static const char INFINITE[] = "infinity";

/* What is probably wrong with a text that is not a number: 51,68 or 2mm. */
static const char *number_hint(const node *n)
{
    const char *behind = n->text + strspn(n->text, "+-.0123456789"), *bare = n->text + (*n->text == '-');
    if (sgt_reader_distance((piece){bare, bare + strlen(bare)}, (piece){INFINITE, INFINITE + 8}) == 0)
        return "; write .inf";
    if (n->quoted || behind == n->text || !*behind) return "";
    if (*behind == ',') return "; write a decimal point, not a comma";
    return *behind == ' ' || strchr("mciuf", *behind) ? "; write the number without its unit" : "";
}

/* Readers have no business to change a tree, and so see it as const; what was read is noted all the same. */
void tree_mark_number(const node *n) { ((node *)(uintptr_t)n)->number = true; }

double tree_read_number(source *s, const node *n, const char *key, number_range range)
{
    if (n->kind != NODE_SCALAR) tree_fail(s, n->line, key, "must be a number");
    double value;
    bool good = number_read(n->text, &value);
    /* an infinity may be quoted, since JSON can write it only as a string */
    if (good && n->quoted && !isinf(value))
        tree_fail(s, n->line, key, "must be a number without quotes, not \"%.60s\"", n->text);
    const char first = sgt_lower(*n->text);
    if (!good && strcmp(key, "index") == 0 && first >= 'a' && first <= 'z')
        tree_fail(s, n->line, key, "must be a number, not \"%.60s\"; a glass by its name is `glass`",
                  n->text);
    if (!good)
        tree_fail(s, n->line, key, "must be a number, not \"%.60s\"%s", n->text, number_hint(n));
    if ((isnan(value) && range != NUMBER_ANY) || (isinf(value) && range == NUMBER_FINITE))
        tree_fail(s, n->line, key, "must be finite, not %.60s", n->text);
    tree_mark_number(n);
    return value;
}

bool tree_read_truth(source *s, const node *n, const char *key)
{
    static const char *const names[] = {"false", "true", "False", "True", "FALSE", "TRUE"};
    if (n->kind == NODE_SCALAR && !n->quoted)
        for (int i = 0; i < 6; i++)
            if (strcmp(n->text, names[i]) == 0) return i % 2 == 1;
    if (n->kind == NODE_SCALAR)
        tree_fail(s, n->line, key, "must be true or false, not \"%.60s\"", n->text);
    tree_fail(s, n->line, key, "must be true or false");
}

const char *tree_read_text(source *s, const node *n, const char *key)
{
    if (n->kind != NODE_SCALAR) tree_fail(s, n->line, key, "must be a word or a text");
    return n->text;
}

const char *tree_read_path(source *s, const node *n, const char *key)
{
    const char *name = tree_read_text(s, n, key);
    size_t folder = *name == '/' ? 0 : strlen(s->folder), length = strlen(name);
    char *path = tree_room(s, folder + length + 1, 1);
    memcpy(path, s->folder, folder);
    memcpy(path + folder, name, length);
    return path;
}

size_t tree_read_numbers(source *s, const node *n, const char *key, size_t most, double value[])
{
    if (n->kind != NODE_LIST) tree_fail(s, n->line, key, "must be a list of numbers, like [1, 2]");
    if (n->count == 0) tree_fail(s, n->line, key, "must hold at least one number");
    if (n->count > most)
        tree_fail(s, n->line, key, "has %zu numbers; at most %zu are allowed", n->count, most);
    for (size_t i = 0; i < n->count; i++) {
        char name[120];
        snprintf(name, sizeof name, "%.90s[%zu]", key, i);
        value[i] = tree_read_number(s, n->item[i], name, NUMBER_FINITE);
    }
    return n->count;
}

const char *tree_borrow(source *s, const char *path, char **text, size_t *length)
{
    const sgt_lens_options *o = s->options;
    const sgt_allocator *a = &s->arena->allocator;
    sgt_error why;
    char *read = NULL;
    *text = NULL;
    if (!o->read) {
        if (sgt_reader_file(a, path, &read, length, &why)) return *text = read, NULL;
        return tree_text(s, why.words, strlen(why.words));
    }
    const char *fault = o->read(o->context, path, &read, length);
    if (fault) return fault;
    if ((*text = a->resize(a->context, NULL, *length + 1))) {
        if (*length) memcpy(*text, read, *length);
        (*text)[*length] = 0;
    }
    if (o->forget) o->forget(o->context, read);
    return *text ? NULL : "no memory";
}

void tree_return(source *s, char *text)
{
    if (text) s->arena->allocator.resize(s->arena->allocator.context, text, 0);
}

const char *tree_file(source *s, const char *path, char **text, size_t *length)
{
    char *borrowed;
    const char *fault = tree_borrow(s, path, &borrowed, length);
    if (fault) return fault;
    *text = sgt_arena_text(s->arena, borrowed, *length);
    tree_return(s, borrowed);
    return *text ? NULL : "no memory";
}
