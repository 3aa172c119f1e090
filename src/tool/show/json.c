// SPDX-License-Identifier: MIT
/* json.c - a text that grows; one level for each bracket that is open. */
#include "json.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../../text/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DEEPEST = 8 };

typedef struct level { bool lines, filled; char end; } level;

struct json {
    table_target to;
    char *text;
    size_t length, room;
    level open[DEEPEST]; /* [0]: outside all brackets */
    size_t depth;
};

static void put_bytes(json *j, const char *text, size_t length)
{
    if (j->room - j->length < length) {
        j->room = 2 * j->room + length;
        j->text = memory_grow(j->text, j->room, 1);
    }
    memcpy(j->text + j->length, text, length);
    j->length += length;
}

static void put_string(json *j, const char *text)
{
    put_bytes(j, "\"", 1);
    for (const char *c = text; *c; c++) {
        char code[8];
        int length = (unsigned char)*c < 32     ? snprintf(code, sizeof code, "\\u%04x", (unsigned)*c)
                     : *c == '"' || *c == '\\' ? snprintf(code, sizeof code, "\\%c", *c)
                                               : snprintf(code, sizeof code, "%c", *c);
        put_bytes(j, code, (size_t)length);
    }
    put_bytes(j, "\"", 1);
}

static void new_line(json *j)
{
    put_bytes(j, "\n", 1);
    for (size_t i = 0; i < j->depth; i++) put_bytes(j, "  ", 2);
}

/* What stands in front of a value. */
static void put_key(json *j, const char *key)
{
    level *in = &j->open[j->depth];
    if (in->filled) put_bytes(j, ",", 1);
    if (in->lines) new_line(j);
    else if (in->filled) put_bytes(j, " ", 1);
    in->filled = true;
    if (!key) return;
    put_string(j, key);
    put_bytes(j, ": ", 2);
}

json *json_begin(const table_target *target)
{
    json *j = memory_take(1, sizeof *j);
    j->to = *target;
    return j;
}

void json_open(json *j, const char *key, char bracket, bool lines)
{
    put_key(j, key);
    put_bytes(j, &bracket, 1);
    j->open[++j->depth] = (level){.lines = lines, .end = bracket == '{' ? '}' : ']'};
}

void json_close(json *j)
{
    const level was = j->open[j->depth--];
    if (was.lines && was.filled) new_line(j);
    put_bytes(j, &was.end, 1);
}

void json_number(json *j, const char *key, double value)
{
    char text[NUMBER_SIZE];
    put_key(j, key);
    int length = number_print(text, value, j->to.hexadecimal);
    if (isnan(value)) put_bytes(j, "null", 4);
    else if (isfinite(value) && !j->to.hexadecimal) put_bytes(j, text, (size_t)length);
    else put_string(j, text);
}

void json_count(json *j, const char *key, size_t value)
{
    char text[NUMBER_SIZE];
    put_key(j, key);
    put_bytes(j, text, (size_t)number_print_count(text, (long long)value));
}

void json_word(json *j, const char *key, const char *text)
{
    put_key(j, key);
    if (text) put_string(j, text);
    else put_bytes(j, "null", 4);
}

void json_truth(json *j, const char *key, bool value)
{
    put_key(j, key);
    if (value) put_bytes(j, "true", 4);
    else put_bytes(j, "false", 5);
}

void json_end(json *j)
{
    put_bytes(j, "\n", 1);
    output_write(j->to.path, j->text, j->length);
}
