/* document.c - makes a tree from libyaml's events, and reads the values in it.
 *
 * The tree is built as the events come, so too deep a nesting is refused at once: libyaml's own
 * time grows with the square of the depth.  An alias (*name) is the same node a second time, so
 * a file of aliases to aliases stays small, however large it would be written out.  Time and
 * memory grow linearly with the length of the text. */
#include "document.h"

#include "../base/memory.h"
#include "../base/number.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

void document_fail(const document *d, const node *at, const char *key, const char *format, ...)
{
    char text[1400];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    fail_input("%s:%zu: %s%s%s", d->source, at->line, key ? key : "", key ? ": " : "", text);
}

enum { FAULT_SIZE = 300 };

/* A zero byte (YAML can write one as "\0") must not end a word early: it becomes a ?. */
static const char *text_of(const char *value, size_t length)
{
    char *text = memory_text(value, length);
    for (size_t i = 0; i < length; i++)
        if (text[i] == 0) text[i] = '?';
    return text;
}

/* The line of a byte of the text, counted from 1.  A lone \r ends a line too. */
static size_t line_of(const char *text, size_t at)
{
    size_t line = 1;
    for (size_t i = 0; i < at; i++) line += text[i] == '\n' || (text[i] == '\r' && text[i + 1] != '\n');
    return line;
}

/* The line of a libyaml mark.  libyaml counts the end of the text as a line of its own. */
static size_t line_at(yaml_mark_t mark, size_t last) { return mark.line + 1 < last ? mark.line + 1 : last; }

/* ------------------------------------------------------------------- names */

/* A hash table of names and their nodes.  It is at most half full.  A name is in the first free place at or
 * after the place of its hash. */
typedef struct named_node { const char *text; node *of; } named_node;
typedef struct names { named_node *place; size_t count, capacity; } names;

static named_node *place_of(const names *all, const char *text)
{
    size_t hash = 14695981039346656037u & SIZE_MAX; /* FNV-1a: Fowler, Noll, Vo */
    for (const char *c = text; *c; c++) hash = (hash ^ (unsigned char)*c) * (1099511628211u & SIZE_MAX);
    named_node *place;
    do place = &all->place[hash++ & (all->capacity - 1)];
    while (place->text && strcmp(place->text, text) != 0);
    return place;
}

static node *document_named(const names *all, const char *text)
{
    return all->count ? place_of(all, text)->of : NULL;
}

/* Adds a name; false: it is there already. */
static bool add_name(names *all, const char *text, node *of)
{
    if (2 * all->count >= all->capacity) {
        names more = {.capacity = all->capacity ? 2 * all->capacity : 64, .count = all->count};
        more.place = memory_take(more.capacity, sizeof *more.place);
        for (size_t i = 0; i < all->capacity; i++)
            if (all->place[i].text) *place_of(&more, all->place[i].text) = all->place[i];
        *all = more;
    }
    named_node *place = place_of(all, text);
    if (place->text) return false;
    *place = (named_node){text, of};
    all->count++;
    return true;
}

/* ---------------------------------------------------------------- the tree */

enum { DEPTH_MOST = 64, NODES_AT_ONCE = 64 };

/* A list or map that is not yet closed, and the capacity of its arrays. */
typedef struct opened { node *of; size_t keys, room, key_room; } opened;

typedef struct builder {
    size_t last;                    /* the last line of the text */
    node *root, *fresh;             /* fresh: nodes allocated but not yet used */
    size_t left;                    /* how many of these */
    opened open[DEPTH_MOST];
    size_t depth;
    names anchors;
} builder;

static node *node_at(builder *b, yaml_mark_t mark, node_kind kind)
{
    if (b->left == 0) b->fresh = memory_take(b->left = NODES_AT_ONCE, sizeof *b->fresh);
    node *n = b->fresh++;
    b->left--;
    n->line = line_at(mark, b->last), n->kind = kind;
    return n;
}

/* Adds a node: to the innermost list, to the innermost map as key or value, or as the root. */
static void put_node(builder *b, node *n)
{
    if (b->depth == 0) {
        b->root = n;
        return;
    }
    opened *in = &b->open[b->depth - 1];
    node *of = in->of;
    if (of->kind == NODE_MAP && in->keys == of->count) {
        of->key = memory_room(of->key, in->keys, &in->key_room, sizeof *of->key);
        of->key[in->keys++] = n;
    } else {
        of->item = memory_room(of->item, of->count, &in->room, sizeof *of->item);
        of->item[of->count++] = n;
    }
}

static void close_node(builder *b)
{
    node *n = b->open[--b->depth].of;
    if (n->count == 0) return;
    n->item = memory_grow(n->item, n->count, sizeof *n->item);
    if (n->kind == NODE_LIST) return;
    n->key = memory_grow(n->key, n->count, sizeof *n->key);
    n->taken = memory_take(n->count, sizeof *n->taken);
}

/* Takes an event into the tree.  Returns what is wrong with it, or NULL. */
static const char *take_event(builder *b, const yaml_event_t *e)
{
    const yaml_char_t *anchor = NULL;
    node *n = NULL;
    switch (e->type) {
    case YAML_SCALAR_EVENT:
        n = node_at(b, e->start_mark, NODE_SCALAR);
        n->text = text_of((const char *)e->data.scalar.value, e->data.scalar.length);
        n->quoted = e->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        anchor = e->data.scalar.anchor;
        put_node(b, n);
        break;
    case YAML_SEQUENCE_START_EVENT:
    case YAML_MAPPING_START_EVENT:
        if (b->depth == DEPTH_MOST) return "lists and maps nested more than 64 deep";
        n = node_at(b, e->start_mark, e->type == YAML_MAPPING_START_EVENT ? NODE_MAP : NODE_LIST);
        anchor = e->type == YAML_MAPPING_START_EVENT ? e->data.mapping_start.anchor
                                                     : e->data.sequence_start.anchor;
        put_node(b, n);
        b->open[b->depth++] = (opened){.of = n};
        break;
    case YAML_ALIAS_EVENT:
        n = document_named(&b->anchors, (const char *)e->data.alias.anchor);
        if (!n) return "not valid YAML: an alias (*name) without its anchor (&name)";
        put_node(b, n);
        break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: close_node(b); break;
    default: break;
    }
    if (anchor && !add_name(&b->anchors, memory_text((const char *)anchor, strlen((const char *)anchor)), n))
        return "not valid YAML: an anchor (&name) given twice";
    return NULL;
}

/* Counts the lines that begin with % at the start of the text.  libyaml compares each with all before it, so
 * its time grows with the square of their number. */
enum { DIRECTIVES_MOST = 64 };
static size_t directives(const char *text, size_t length)
{
    size_t count = 0;
    for (const char *at = text, *end = text + length; at < end && strchr("%# \t\r\n", *at);) {
        count += *at == '%';
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        at = stop ? stop + 1 : end;
    }
    return count;
}

/* Is there a tab among the blanks at the start of a line? */
static bool begins_with_tab(const char *text, size_t line)
{
    for (; line > 1 && (text = strchr(text, '\n')); line--) text++;
    return text && text[strspn(text, " ")] == '\t';
}

/* What libyaml found wrong, in its words; returns the line.  For a byte that is not UTF-8, libyaml gives the
 * byte's place and no line. */
static size_t syntax_fault(const yaml_parser_t *parser, const char *text, size_t length, size_t last,
                           char fault[FAULT_SIZE])
{
    snprintf(fault, FAULT_SIZE, "not valid YAML: %s", parser->problem ? parser->problem : "no reason given");
    if (parser->context) {
        size_t so_far = strlen(fault);
        snprintf(fault + so_far, FAULT_SIZE - so_far, ", %s that begins in line %zu", parser->context,
                 line_at(parser->context_mark, last));
    }
    if (parser->error != YAML_READER_ERROR) {
        size_t line = line_at(parser->problem_mark, last), so_far = strlen(fault);
        if (begins_with_tab(text, line))
            snprintf(fault + so_far, FAULT_SIZE - so_far, "; indent by blanks, not by tabs");
        return line;
    }
    return line_of(text, parser->problem_offset < length ? parser->problem_offset : length);
}

document document_parse(const char *source, const char *text, size_t length)
{
    document d = {.source = source, .folder = ""};
    builder b = {.last = line_of(text, length ? length - 1 : 0)};
    yaml_parser_t parser;
    char fault[FAULT_SIZE] = "";
    size_t line = 1;
    int documents = 0;
    if (directives(text, length) > DIRECTIVES_MOST)
        document_fail(&d, &(node){.line = 1}, NULL,
                      "more than %d lines that begin with %% (directives of YAML)", DIRECTIVES_MOST);
    if (!yaml_parser_initialize(&parser)) fail_input("out of memory");
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    for (bool more = true; more && !*fault;) {
        yaml_event_t e;
        if (!yaml_parser_parse(&parser, &e)) {
            line = syntax_fault(&parser, text, length, b.last, fault);
            break;
        }
        bool second = e.type == YAML_DOCUMENT_START_EVENT && documents++ > 0;
        const char *wrong = second ? NULL : take_event(&b, &e);
        if (wrong) snprintf(fault, sizeof fault, "%s", wrong);
        if (second) snprintf(fault, sizeof fault, "a second document begins here; there must be one only");
        line = line_at(e.start_mark, b.last);
        more = e.type != YAML_STREAM_END_EVENT;
        yaml_event_delete(&e);
    }
    yaml_parser_delete(&parser);
    if (!*fault && !b.root) line = 1, snprintf(fault, sizeof fault, "empty");
    if (*fault) document_fail(&d, &(node){.line = line}, NULL, "%s", fault);
    d.root = b.root;
    return d;
}

/* No valid map has more keys.  In a larger one, double keys are found by hashing and not pair by pair. */
enum { KEYS_MANY = 64 };

void document_map(const document *d, const node *n, const char *key)
{
    if (n->kind != NODE_MAP) document_fail(d, n, key, "must be a map of keys and values, as {key: value}");
    names seen = {.count = 0};
    for (size_t i = 0; i < n->count; i++) {
        const node *k = n->key[i];
        if (k->kind != NODE_SCALAR) document_fail(d, k, key, "a key must be a word");
        bool twice = n->count > KEYS_MANY && !add_name(&seen, k->text, n->key[i]);
        for (size_t j = 0; j < i && n->count <= KEYS_MANY; j++)
            twice = twice || strcmp(n->key[j]->text, k->text) == 0;
        if (twice) document_fail(d, k, k->text, "given twice");
        n->taken[i] = false;
    }
}

node *document_take(const node *map, const char *key)
{
    for (size_t i = 0; i < map->count; i++) {
        if (strcmp(map->key[i]->text, key) != 0) continue;
        map->taken[i] = true;
        return map->item[i];
    }
    return NULL;
}

void document_finish(const document *d, const node *map, const char *known)
{
    for (size_t i = 0; i < map->count; i++)
        if (!map->taken[i]) {
            const char *key = map->key[i]->text;
            bool digits = *key && key[strspn(key, "0123456789")] == 0; /* {radius: 51,68} */
            document_fail(d, map->key[i], key, "unknown key; %sknown here: %s",
                          digits ? "was a decimal comma written?  Use a decimal point; " : "", known);
        }
}

/* What is probably wrong with a text that is not a number: 51,68 or 2mm. */
static const char *number_hint(const node *n)
{
    const char *behind = n->text + strspn(n->text, "+-.0123456789");
    if (n->quoted || behind == n->text || !*behind) return "";
    if (*behind == ',') return "; write a decimal point, not a comma";
    return *behind == ' ' || strchr("mciuf", *behind) ? "; write the number without its unit" : "";
}

double document_number(const document *d, const node *n, const char *key, number_range range)
{
    if (n->kind != NODE_SCALAR) document_fail(d, n, key, "must be a number");
    double value;
    bool good = number_read(n->text, &value);
    /* an infinity may be quoted, since JSON can write it only as a string */
    if (good && n->quoted && !isinf(value))
        document_fail(d, n, key, "must be a number without quotes, not \"%.60s\"", n->text);
    if (!good) document_fail(d, n, key, "must be a number, not \"%.60s\"%s", n->text, number_hint(n));
    if ((isnan(value) && range != NUMBER_ANY) || (isinf(value) && range == NUMBER_FINITE))
        document_fail(d, n, key, "must be finite, not %.60s", n->text);
    return value;
}

bool document_truth(const document *d, const node *n, const char *key)
{
    static const char *const words[] = {"false", "true", "False", "True", "FALSE", "TRUE"};
    if (n->kind == NODE_SCALAR && !n->quoted)
        for (int i = 0; i < 6; i++)
            if (strcmp(n->text, words[i]) == 0) return i % 2 == 1;
    if (n->kind == NODE_SCALAR) document_fail(d, n, key, "must be true or false, not \"%.60s\"", n->text);
    document_fail(d, n, key, "must be true or false");
}

const char *document_text(const document *d, const node *n, const char *key)
{
    if (n->kind != NODE_SCALAR) document_fail(d, n, key, "must be a word or a text");
    return n->text;
}

const char *document_path(const document *d, const node *n, const char *key)
{
    const char *name = document_text(d, n, key);
    size_t folder = *name == '/' ? 0 : strlen(d->folder);
    char *path = memory_grow(NULL, folder + strlen(name) + 1, 1);
    memcpy(path, d->folder, folder);
    strcpy(path + folder, name);
    return path;
}

size_t document_numbers(const document *d, const node *n, const char *key, size_t most, double value[])
{
    if (n->kind != NODE_LIST) document_fail(d, n, key, "must be a list of numbers, like [1, 2]");
    if (n->count == 0) document_fail(d, n, key, "must hold at least one number");
    if (n->count > most) document_fail(d, n, key, "has %zu numbers; at most %zu are allowed", n->count, most);
    for (size_t i = 0; i < n->count; i++) {
        char name[120];
        snprintf(name, sizeof name, "%.90s[%zu]", key, i);
        value[i] = document_number(d, n->item[i], name, NUMBER_FINITE);
    }
    return n->count;
}
