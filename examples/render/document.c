// SPDX-License-Identifier: MIT
/* document.c - libyaml's document, and the values in it. */
#include "document.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FAULT_SIZE = 300 };

LIKE_PRINTF(4, 0)
static _Noreturn void fail_at(const document *d, size_t line, const char *key, const char *format,
                              va_list values)
{
    char text[2 * FAULT_SIZE];
    vsnprintf(text, sizeof text, format, values);
    fail_input("%s:%zu: %.60s%s%s", d->file, line, key ? key : "", key ? ": " : "", text);
}

void document_fail(const document *d, const node *at, const char *key, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    fail_at(d, at->start_mark.line + 1, key, format, values);
}

LIKE_PRINTF(3, 4) static _Noreturn void fail_syntax(const document *d, size_t line, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    fail_at(d, line, NULL, format, values);
}

/* Looks through all events before the document is made: the time that libyaml takes to make one grows with
 * the square of its depth and of its anchors.  What else is wrong the making tells. */
static void check_events(const document *d, FILE *in)
{
    enum { DEPTH_MOST = 64, ANCHORS_MOST = 1000 };
    yaml_parser_t parser;
    yaml_event_t e;
    size_t line = 0;
    int depth = 0, anchors = 0;
    if (!yaml_parser_initialize(&parser)) fail_input("out of memory");
    yaml_parser_set_input_file(&parser, in);
    for (bool more = true; more && !line && yaml_parser_parse(&parser, &e); yaml_event_delete(&e)) {
        more = e.type != YAML_STREAM_END_EVENT;
        depth += e.type == YAML_SEQUENCE_START_EVENT || e.type == YAML_MAPPING_START_EVENT;
        depth -= e.type == YAML_SEQUENCE_END_EVENT || e.type == YAML_MAPPING_END_EVENT;
        anchors += (e.type == YAML_SCALAR_EVENT && e.data.scalar.anchor) ||
                   (e.type == YAML_SEQUENCE_START_EVENT && e.data.sequence_start.anchor) ||
                   (e.type == YAML_MAPPING_START_EVENT && e.data.mapping_start.anchor);
        if (depth > DEPTH_MOST || anchors > ANCHORS_MOST) line = e.start_mark.line + 1;
    }
    yaml_parser_delete(&parser);
    if (line && depth > DEPTH_MOST)
        fail_syntax(d, line, "lists and maps within each other more than %d deep", DEPTH_MOST);
    if (line) fail_syntax(d, line, "more than %d anchors", ANCHORS_MOST);
    rewind(in);
}

void document_read(document *d, const char *file)
{
    yaml_parser_t parser;
    yaml_document_t second;
    char fault[FAULT_SIZE] = "";
    size_t line = 1;
    *d = (document){.file = file};
    FILE *in = fopen(file, "rb");
    if (!in || getc(in) == EOF) fail_input("%s: %s", file, !in || ferror(in) ? strerror(errno) : "empty");
    rewind(in);
    check_events(d, in);
    if (!yaml_parser_initialize(&parser)) fail_input("out of memory");
    yaml_parser_set_input_file(&parser, in);
    bool good = yaml_parser_load(&parser, &d->yaml) &&
                (!document_root(d) || yaml_parser_load(&parser, &second));
    if (!good) {
        line = parser.problem_mark.line + 1;
        snprintf(fault, sizeof fault, "%s", parser.problem ? parser.problem : "not YAML");
    } else if (!document_root(d)) {
        snprintf(fault, sizeof fault, "empty");
    } else {
        const node *root = yaml_document_get_root_node(&second);
        if (root)
            line = root->start_mark.line + 1,
            snprintf(fault, sizeof fault, "a second document; only one is read");
        yaml_document_delete(&second);
    }
    yaml_parser_delete(&parser);
    fclose(in);
    if (*fault) fail_syntax(d, line, "%s", fault);
}

void document_close(document *d) { yaml_document_delete(&d->yaml); }

node *document_root(document *d) { return yaml_document_get_root_node(&d->yaml); }

static node *node_of(document *d, int index) { return yaml_document_get_node(&d->yaml, index); }

static const char *text_of(const node *n)
{
    return n->type == YAML_SCALAR_NODE ? (const char *)n->data.scalar.value : NULL;
}

static bool is_text(const node *n, const char *text) { return text_of(n) && strcmp(text_of(n), text) == 0; }

bool document_is_among(const char *word, const char *list)
{
    size_t size = strlen(word);
    for (const char *at = list; size && (at = strstr(at, word)); at++)
        if ((at == list || at[-1] == ' ') && (at[size] == ' ' || !at[size]) && !strchr(word, ' '))
            return true;
    return false;
}

void document_keys(document *d, const node *map, const char *name)
{
    if (map->type != YAML_MAPPING_NODE) document_fail(d, map, name, "must be a map, as {key: value}");
    for (yaml_node_pair_t *p = map->data.mapping.pairs.start; p < map->data.mapping.pairs.top; p++) {
        const node *key = node_of(d, p->key);
        const char *text = text_of(key);
        if (!text) document_fail(d, key, name, "a key must be a word");
        for (yaml_node_pair_t *q = map->data.mapping.pairs.start; q < p; q++)
            if (is_text(node_of(d, q->key), text)) document_fail(d, key, text, "given twice");
    }
}

void document_map(document *d, const node *map, const char *name, const char *known)
{
    document_keys(d, map, name);
    const node *key, *value;
    for (int i = 0; (key = document_key(d, map, i, &value)); i++)
        if (!document_is_among(text_of(key), known))
            document_fail(d, key, text_of(key), "unknown key; known here: %s", known);
}

const node *document_key(document *d, const node *map, int i, const node **value)
{
    yaml_node_pair_t *p = map->data.mapping.pairs.start + i;
    if (p >= map->data.mapping.pairs.top) return NULL;
    *value = node_of(d, p->value);
    return node_of(d, p->key);
}

node *document_find(document *d, const node *map, const char *key)
{
    for (yaml_node_pair_t *p = map->data.mapping.pairs.start; p < map->data.mapping.pairs.top; p++)
        if (is_text(node_of(d, p->key), key)) return node_of(d, p->value);
    return NULL;
}

double document_number(const document *d, const node *n, const char *key, double lo, double hi)
{
    const char *text = text_of(n);
    char *end;
    if (!text || n->data.scalar.style != YAML_PLAIN_SCALAR_STYLE)
        document_fail(d, n, key, "must be a number");
    double x = strtod(text, &end);
    /* .inf, .NaN, nan */
    bool named = text[strcspn(text, "iInN")] && strcspn(text, "0123456789") == strlen(text);
    if (named || !isfinite(x)) document_fail(d, n, key, "must be a finite number, not %.60s", text);
    if (end == text || *end) document_fail(d, n, key, "must be a number, and \"%.60s\" is none", text);
    if (!(x >= lo && x <= hi)) document_fail(d, n, key, "must be from %g to %g, not %.60s", lo, hi, text);
    return x;
}

int document_whole(const document *d, const node *n, const char *key, int lo, int hi)
{
    double x = document_number(d, n, key, lo, hi);
    if (x != floor(x)) document_fail(d, n, key, "must be a whole number, not %.60s", text_of(n));
    return (int)x;
}

const char *document_word(const document *d, const node *n, const char *key)
{
    if (!text_of(n)) document_fail(d, n, key, "must be a word");
    return text_of(n);
}

int document_choice(const document *d, const node *n, const char *key, const char *const words[])
{
    const char *word = document_word(d, n, key);
    char known[FAULT_SIZE] = "";
    for (int i = 0; words[i]; i++) {
        if (strcmp(words[i], word) == 0) return i;
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", words[i]);
    }
    document_fail(d, n, key, "must be one of %s, not \"%.60s\"", known, word);
}

int document_list(const document *d, const node *n, const char *key, int least, int most)
{
    if (n->type != YAML_SEQUENCE_NODE) document_fail(d, n, key, "must be a list, as [1, 2]");
    long count = (long)(n->data.sequence.items.top - n->data.sequence.items.start);
    if (count < least || count > most) {
        if (least == most) document_fail(d, n, key, "has %ld items, and wants %d", count, most);
        document_fail(d, n, key, "has %ld items, and wants from %d to %d", count, least, most);
    }
    return (int)count;
}

node *document_item(document *d, const node *n, int i) { return node_of(d, n->data.sequence.items.start[i]); }

int document_numbers(document *d, const node *n, const char *key, int least, int most, double lo, double hi,
                     double value[])
{
    int count = document_list(d, n, key, least, most);
    for (int i = 0; i < count; i++) value[i] = document_number(d, document_item(d, n, i), key, lo, hi);
    return count;
}
