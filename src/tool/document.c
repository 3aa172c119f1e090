/* document.c - from libyaml's document to our tree, and the values in it.
 *
 * libyaml hands over an array of nodes, in which an alias (*name) is a node met twice.
 * Ours has a node for each of theirs, so that a file of aliases to aliases stays small
 * however large it would be written out. */
#include "document.h"

#include "memory.h"
#include "number.h"

#include <math.h>
#include <stdarg.h>
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

/* A zero byte, that YAML can write as "\0", is not to end a word early. */
static const char *text_of(const char *value, size_t length)
{
    char *text = memory_text(value, length);
    for (size_t i = 0; i < length; i++)
        if (text[i] == 0) text[i] = '?';
    return text;
}

/* The line of a byte of the text, counts from 1; a \r alone ends one too. */
static size_t line_of(const char *text, size_t at)
{
    size_t line = 1;
    for (size_t i = 0; i < at; i++) line += text[i] == '\n' || (text[i] == '\r' && text[i + 1] != '\n');
    return line;
}

/* Where a mark of libyaml stands; libyaml takes the end of the text for a line of its own. */
static size_t line_at(yaml_mark_t mark, size_t last) { return mark.line + 1 < last ? mark.line + 1 : last; }

static node *nodes_of(yaml_document_t *from, size_t last)
{
    size_t count = (size_t)(from->nodes.top - from->nodes.start);
    node *all = memory_take(count, sizeof *all);
    for (size_t i = 0; i < count; i++) {
        const yaml_node_t *y = &from->nodes.start[i];
        node *n = &all[i];
        n->line = line_at(y->start_mark, last);
        if (y->type == YAML_SEQUENCE_NODE) {
            n->kind = NODE_LIST;
            n->count = (size_t)(y->data.sequence.items.top - y->data.sequence.items.start);
            n->item = memory_take(n->count, sizeof *n->item);
            for (size_t j = 0; j < n->count; j++) n->item[j] = &all[y->data.sequence.items.start[j] - 1];
        } else if (y->type == YAML_MAPPING_NODE) {
            n->kind = NODE_MAP;
            n->count = (size_t)(y->data.mapping.pairs.top - y->data.mapping.pairs.start);
            n->item = memory_take(n->count, sizeof *n->item);
            n->key = memory_take(n->count, sizeof *n->key);
            n->taken = memory_take(n->count, sizeof *n->taken);
            for (size_t j = 0; j < n->count; j++) {
                n->key[j] = &all[y->data.mapping.pairs.start[j].key - 1];
                n->item[j] = &all[y->data.mapping.pairs.start[j].value - 1];
            }
        } else {
            n->kind = NODE_SCALAR;
            n->text = text_of((const char *)y->data.scalar.value, y->data.scalar.length);
            n->quoted = y->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        }
    }
    return all;
}

/* What libyaml found wrong: its words, and the line.  Of a byte that is no text it tells the place and not the line. */
static size_t syntax_fault(const yaml_parser_t *parser, const char *text, size_t length, size_t last, char fault[FAULT_SIZE])
{
    snprintf(fault, FAULT_SIZE, "%s", parser->problem ? parser->problem : "not YAML");
    if (parser->context) {
        size_t so_far = strlen(fault);
        snprintf(fault + so_far, FAULT_SIZE - so_far, ", %s that begins in line %zu", parser->context,
                 line_at(parser->context_mark, last));
    }
    if (parser->error != YAML_READER_ERROR) return line_at(parser->problem_mark, last);
    return line_of(text, parser->problem_offset < length ? parser->problem_offset : length);
}

document document_parse(const char *source, const char *text, size_t length)
{
    document d = {.source = source, .folder = ""};
    yaml_parser_t parser;
    yaml_document_t loaded, more;
    char fault[FAULT_SIZE] = "empty";
    size_t line = 1, last = line_of(text, length ? length - 1 : 0);
    if (!yaml_parser_initialize(&parser)) fail_input("out of memory");
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);

    if (!yaml_parser_load(&parser, &loaded)) {
        line = syntax_fault(&parser, text, length, last, fault);
    } else {
        if (yaml_document_get_root_node(&loaded)) d.root = nodes_of(&loaded, last);
        yaml_document_delete(&loaded);
    }
    if (d.root) {
        line = 0;
        if (!yaml_parser_load(&parser, &more)) {
            line = syntax_fault(&parser, text, length, last, fault);
        } else {
            const yaml_node_t *second = yaml_document_get_root_node(&more);
            if (second) line = line_at(second->start_mark, last);
            snprintf(fault, sizeof fault, "a second document; only one is read");
            yaml_document_delete(&more);
        }
    }
    yaml_parser_delete(&parser);
    if (line) document_fail(&d, &(node){.line = line}, NULL, "%s", fault);
    return d;
}

void document_map(const document *d, const node *n, const char *key)
{
    if (n->kind != NODE_MAP) document_fail(d, n, key, "must be a map, as {key: value}");
    for (size_t i = 0; i < n->count; i++) {
        const node *k = n->key[i];
        if (k->kind != NODE_SCALAR) document_fail(d, k, key, "a key must be a word");
        for (size_t j = 0; j < i; j++)
            if (strcmp(n->key[j]->text, k->text) == 0) document_fail(d, k, k->text, "given twice");
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
                          digits ? "a decimal point is wanted, not a comma?  " : "", known);
        }
}

double document_number(const document *d, const node *n, const char *key, number_range range)
{
    if (n->kind != NODE_SCALAR) document_fail(d, n, key, "must be a number");
    double value;
    bool good = number_read(n->text, &value);
    /* JSON has no infinity but as a string */
    if (!good && !n->quoted && n->text[strspn(n->text, "+-0123456789")] == ',')
        document_fail(d, n, key, "must be a number, and \"%.60s\" is none; a decimal point is wanted, not a comma", n->text);
    if (!good || (n->quoted && !isinf(value))) document_fail(d, n, key, "must be a number, and \"%.60s\" is none", n->text);
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
    if (n->kind != NODE_LIST) document_fail(d, n, key, "must be a list of numbers, as [1, 2]");
    if (n->count == 0) document_fail(d, n, key, "must hold at least one number");
    if (n->count > most) document_fail(d, n, key, "has %zu numbers, and %zu are the most", n->count, most);
    for (size_t i = 0; i < n->count; i++) {
        char name[120];
        snprintf(name, sizeof name, "%.90s[%zu]", key, i);
        value[i] = document_number(d, n->item[i], name, NUMBER_FINITE);
    }
    return n->count;
}
