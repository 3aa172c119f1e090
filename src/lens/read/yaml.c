// SPDX-License-Identifier: MIT
/* yaml.c - a lens file in YAML: libyaml's events become a tree.
 *
 * The tree is built as the events come, so too deep a nesting is refused at once: libyaml's own
 * time grows with the square of the depth.  An alias (*name) is the same node a second time, so
 * a file of aliases to aliases stays small, however large it would be written out.  Time and
 * memory grow linearly with the length of the text.
 *
 * libyaml's memory is not the arena's.  So a fault ends the parser first, and only then the
 * reading. */
#include "tree.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

enum { FAULT_SIZE = 300 };

/* A zero byte (YAML can write one as "\0") must not end a word early: it becomes a ?. */
static void replace_zeros(char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (text[i] == 0) text[i] = '?';
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

static node *node_named(const names *all, const char *text)
{
    return all->count ? place_of(all, text)->of : NULL;
}

/* Adds a name; false: it is there already. */
static bool add_name(source *s, names *all, const char *text, node *of)
{
    if (2 * all->count >= all->capacity) {
        names more = {.capacity = all->capacity ? 2 * all->capacity : 64, .count = all->count};
        more.place = tree_room(s, more.capacity, sizeof *more.place);
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

enum { DEPTH_MOST = 64 };

/* A list or map that is not yet closed; key: of a map, the one whose value is awaited.  The first that come
 * are held here until it is known how many they are: then room is made for no more.  line: of its mark, from
 * 0; flow: it is in brackets. */
enum { HELD = 16 };
typedef struct opened {
    node *of, *key, *keys[HELD], *values[HELD];
    size_t held, line;
    bool flow;
} opened;

typedef struct builder {
    source *s;
    size_t last;                    /* the last line of the text */
    opened open[DEPTH_MOST];
    size_t depth;
    names anchors;
} builder;

static void put_pair(source *s, node *in, node *key, node *value)
{
    if (in->kind == NODE_LIST) tree_append(s, in, value);
    else tree_put(s, in, key, value);
}

/* Puts what is held into the list or map. */
static void put_held(source *s, opened *in)
{
    tree_expect(s, in->of, in->held);
    for (size_t i = 0; i < in->held; i++) put_pair(s, in->of, in->keys[i], in->values[i]);
    in->held = 0;
}

/* Adds a node: to the innermost list, to the innermost map as key or value, or as the root. */
static void put_node(builder *b, node *n)
{
    if (b->depth == 0) {
        b->s->root = n;
        return;
    }
    opened *in = &b->open[b->depth - 1];
    if (in->of->kind == NODE_MAP && !in->key) {
        in->key = n;
        return;
    }
    if (in->held == HELD) put_held(b->s, in);
    if (in->of->count) put_pair(b->s, in->of, in->key, n);
    else in->keys[in->held] = in->key, in->values[in->held++] = n;
    in->key = NULL;
}

static size_t line_of_node(const builder *b, yaml_mark_t mark)
{
    return b->s->only_line ? b->s->only_line : line_at(mark, b->last);
}

static node *node_at(builder *b, yaml_mark_t mark, node_kind kind)
{
    return tree_node(b->s, kind, line_of_node(b, mark));
}

static bool in_brackets(const yaml_event_t *e)
{
    return e->type == YAML_MAPPING_START_EVENT ? e->data.mapping_start.style == YAML_FLOW_MAPPING_STYLE
                                               : e->data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE;
}

/* Closes a list or map.  One that stands in brackets in one line is written so again. */
static void end_node(source *s, opened *o, size_t line)
{
    put_held(s, o);
    o->of->inline_ = o->flow && line == o->line;
}

/* Takes an event into the tree.  Returns what is wrong with it, or NULL. */
static const char *take_event(builder *b, const yaml_event_t *e)
{
    const yaml_char_t *anchor = NULL;
    node *n = NULL;
    switch (e->type) {
    case YAML_SCALAR_EVENT:
        replace_zeros((char *)e->data.scalar.value, e->data.scalar.length);
        n = tree_scalar(b->s, line_of_node(b, e->start_mark), (const char *)e->data.scalar.value,
                        e->data.scalar.length);
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
        b->open[b->depth].of = n, b->open[b->depth].key = NULL, b->open[b->depth].held = 0;
        b->open[b->depth].line = e->start_mark.line, b->open[b->depth].flow = in_brackets(e);
        b->depth++;
        break;
    case YAML_ALIAS_EVENT:
        if (b->s->only_line) return "not a value by itself: it has an alias (*name)";
        n = node_named(&b->anchors, (const char *)e->data.alias.anchor);
        if (!n) return "not valid YAML: an alias (*name) without its anchor (&name)";
        put_node(b, n);
        break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: end_node(b->s, &b->open[--b->depth], e->end_mark.line); break;
    default: break;
    }
    if (!anchor) return NULL;
    const char *name = (const char *)anchor;
    if (!add_name(b->s, &b->anchors, tree_text(b->s, name, strlen(name)), n))
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

/* Is there a path of a pickup without quotes?  In a map in braces YAML takes its brackets for a list. */
static bool has_bare_path(const char *text, size_t line)
{
    for (; line > 1 && (text = strchr(text, '\n')); line--) text++;
    const char *end = text ? text + strcspn(text, "\n") : NULL, *key = text ? strstr(text, "pickup: ") : NULL;
    return key && key < end && key[8] != '"' && key[8] != '\'';
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
        else if (has_bare_path(text, line))
            snprintf(fault + so_far, FAULT_SIZE - so_far, "; put the path of a pickup in quotes");
        return line;
    }
    return line_of(text, parser->problem_offset < length ? parser->problem_offset : length);
}

/* What libyaml holds while it parses. */
typedef struct parsing {
    yaml_parser_t parser;
    yaml_event_t event;
    bool has_event;
    char fault[FAULT_SIZE]; /* of the YAML, with its line; "": none */
    size_t line;
} parsing;

/* Builds the tree. */
static void parse_events(parsing *p, builder *b)
{
    int documents = 0;
    for (bool more = true; more && !*p->fault;) {
        if (!yaml_parser_parse(&p->parser, &p->event)) {
            p->line = syntax_fault(&p->parser, b->s->text, b->s->length, b->last, p->fault);
            return;
        }
        p->has_event = true;
        bool second = p->event.type == YAML_DOCUMENT_START_EVENT && documents++ > 0;
        const char *wrong = second ? "a second document begins here; there must be one only"
                                   : take_event(b, &p->event);
        if (wrong) snprintf(p->fault, FAULT_SIZE, "%s", wrong);
        p->line = line_at(p->event.start_mark, b->last);
        more = p->event.type != YAML_STREAM_END_EVENT;
        yaml_event_delete(&p->event);
        p->has_event = false;
    }
}

/* true: a fault of the tree's ended it. */
static bool parse_guarded(parsing *p, builder *b)
{
    jmp_buf here;
    b->s->refused = &here;
    if (setjmp(here) != 0) return true;
    parse_events(p, b);
    return false;
}

/* Keeps the lines of comment at the head of the text, as UTF-8 has them. */
static void keep_comments(source *s)
{
    const char *at = s->text;
    if (strncmp(at, "\xEF\xBB\xBF", 3) == 0) at += 3;
    for (size_t length;; at += length) {
        at += strspn(at, "\r\n");
        length = strcspn(at, "\r\n");
        if (*at != '#') return;
        const char *text = at + 1 + (at[1] == ' ');
        tree_comment(s, tree_text(s, text, (size_t)(at + length - text)));
    }
}

void sgt_read_yaml(source *s)
{
    builder b = {.s = s, .last = line_of(s->text, s->length ? s->length - 1 : 0)};
    static const parsing nothing;
    parsing p = nothing;
    jmp_buf *outer = s->refused;
    if (directives(s->text, s->length) > DIRECTIVES_MOST)
        tree_fail(s, 1, NULL, "more than %d lines that begin with %% (directives of YAML)", DIRECTIVES_MOST);
    if (!yaml_parser_initialize(&p.parser)) tree_fail(s, 0, NULL, "no memory");
    yaml_parser_set_input_string(&p.parser, (const unsigned char *)s->text, s->length);
    bool refused = parse_guarded(&p, &b);
    s->refused = outer;
    if (p.has_event) yaml_event_delete(&p.event);
    yaml_parser_delete(&p.parser);
    if (refused) longjmp(*outer, 1);
    if (*p.fault) tree_fail(s, p.line, NULL, "%s", p.fault);
    if (!s->root) tree_fail(s, 1, NULL, "empty");
    keep_comments(s);
}
