// SPDX-License-Identifier: MIT
/* write.c - a tree as YAML that a person likes to read.
 *
 * A list or map is written in one line, in brackets, if it is marked so or fits the line; else
 * each of its items has a line of its own.  What is read from one line in brackets is marked (yaml.c).
 * Words are quoted if YAML would read them as something else.  What is written reads back as the same
 * tree, with the same comments in front of it, and is written again byte for byte. */
#include "tree.h"

#include <stdio.h>
#include <string.h>

enum { LINE = 110, LENGTH_MOST = 1 << 30 }; /* aliases to aliases would be written out in full */

typedef struct writer { source *s; char *text; size_t length, room; } writer;

static void write_bytes(writer *w, const char *text, size_t length)
{
    if (w->length > LENGTH_MOST) tree_fail(w->s, 0, NULL, "too long to be written");
    while (w->length + length >= w->room) {
        size_t room = w->room ? 2 * w->room : 4096;
        char *more = tree_room(w->s, room, 1);
        if (w->length) memcpy(more, w->text, w->length);
        w->text = more, w->room = room;
    }
    memcpy(w->text + w->length, text, length);
    w->length += length;
}

static void write_text(writer *w, const char *text) { write_bytes(w, text, strlen(text)); }

static void write_indent(writer *w, size_t depth)
{
    for (size_t i = 0; i < depth; i++) write_text(w, "  ");
}

/* Does YAML read the word as it stands?  Names, numbers and plain words with blanks between.  (A word that
 * was not quoted in what was read may be true or false, and must stay so.) */
static bool is_plain_word(const char *text)
{
    size_t length = strlen(text);
    if (length == 0 || text[length - 1] == ' ') return false;
    if (strchr("-.+0123456789", *text) == NULL &&
        !((*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z') || *text == '_'))
        return false;
    if (*text == '-' && (text[1] == ' ' || length == 1)) return false;
    if (strncmp(text, "---", 3) == 0 || strncmp(text, "...", 3) == 0) return false;
    for (const char *c = text; *c; c++)
        if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') ||
              strchr(" _-+./()", *c)))
            return false;
    return true;
}

/* The character at c, if it must be escaped: a control character, a line end other than YAML's own, a byte
 * order mark and what is no character (YAML 1.2, 5.1 and 5.4); else 0.  *length: its bytes in UTF-8. */
static unsigned must_escape(const unsigned char *c, size_t *length)
{
    *length = 1;
    if (c[0] < 0x20 || c[0] == 0x7F) return c[0];
    if (c[0] == 0xC2 && c[1] >= 0x80 && c[1] < 0xA0) return *length = 2, c[1];
    if (c[0] != 0xE2 && c[0] != 0xEF) return 0;
    static const unsigned odd[] = {0x2028, 0x2029, 0xFEFF, 0xFFFE, 0xFFFF};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        if ((c[0] & 0x0Fu) == odd[i] >> 12 && c[1] == (0x80 | (odd[i] >> 6 & 0x3F)) &&
            c[2] == (0x80 | (odd[i] & 0x3F)))
            return *length = 3, odd[i];
    return 0;
}

/* In double quotes. */
static void write_quoted(writer *w, const char *text)
{
    write_text(w, "\"");
    size_t length;
    for (const unsigned char *c = (const unsigned char *)text; *c; c += length) {
        char escaped[8];
        unsigned u = must_escape(c, &length);
        if (*c == '"' || *c == '\\') snprintf(escaped, sizeof escaped, "\\%c", *c);
        else if (u) snprintf(escaped, sizeof escaped, "\\u%04X", u & 0xFFFF);
        else snprintf(escaped, sizeof escaped, "%c", *c);
        write_text(w, escaped);
    }
    write_text(w, "\"");
}

static void write_word(writer *w, const node *n)
{
    if (!n->quoted && is_plain_word(n->text)) write_text(w, n->text);
    else write_quoted(w, n->text);
}

static void write_inline(writer *w, const node *n)
{
    if (n->kind == NODE_SCALAR) {
        write_word(w, n);
        return;
    }
    write_text(w, n->kind == NODE_LIST ? "[" : "{");
    for (size_t i = 0; i < n->count; i++) {
        if (i) write_text(w, ", ");
        if (n->kind == NODE_MAP) write_word(w, n->key[i]), write_text(w, ": ");
        write_inline(w, n->item[i]);
    }
    write_text(w, n->kind == NODE_LIST ? "]" : "}");
}

/* Writes n in brackets if the line then stays short; else takes it back. */
static bool fits_line(writer *w, const node *n, size_t begin)
{
    size_t before = w->length;
    write_inline(w, n);
    if (n->inline_ || w->length - begin <= LINE) return true;
    w->length = before;
    return false;
}

static void write_block(writer *w, const node *n, size_t depth);

/* What follows a key or a dash; begin: where the line begins. */
static void write_value(writer *w, const node *n, size_t depth, size_t begin, bool top)
{
    bool large = top && n->kind == NODE_LIST && n->count && n->item[0]->kind == NODE_MAP;
    size_t before = w->length;
    write_text(w, " ");
    bool one_line = n->kind == NODE_SCALAR || n->count == 0;
    if (one_line) write_inline(w, n);
    else one_line = !large && fits_line(w, n, begin);
    if (!one_line) w->length = before;
    write_text(w, "\n");
    if (!one_line) write_block(w, n, depth);
}

static void write_block(writer *w, const node *n, size_t depth)
{
    for (size_t i = 0; i < n->count; i++) {
        size_t begin = w->length;
        write_indent(w, depth);
        if (n->kind == NODE_LIST) {
            const node *item = n->item[i];
            write_text(w, "-");
            if (item->kind != NODE_MAP || item->count == 0) {
                write_value(w, item, depth + 1, begin, false);
                continue;
            }
            write_text(w, " ");
            if (fits_line(w, item, begin)) {
                write_text(w, "\n");
                continue;
            }
            /* the first key stands behind the dash, the others below it */
            for (size_t k = 0; k < item->count; k++) {
                if (k) begin = w->length, write_indent(w, depth + 1);
                write_word(w, item->key[k]);
                write_text(w, ":");
                write_value(w, item->item[k], depth + 2, begin, false);
            }
        } else {
            write_word(w, n->key[i]);
            write_text(w, ":");
            write_value(w, n->item[i], depth + 1, begin, depth == 0);
        }
    }
}

/* What YAML does not take in a comment, or takes for the end of a line, becomes a blank. */
static void write_comment(writer *w, const char *text)
{
    write_text(w, *text ? "# " : "#");
    size_t length;
    for (const unsigned char *c = (const unsigned char *)text; *c; c += length) {
        if (must_escape(c, &length)) write_text(w, " ");
        else write_bytes(w, (const char *)c, length);
    }
    write_text(w, "\n");
}

char *sgt_write_line(source *s, const node *n, size_t *length)
{
    writer w = {.s = s};
    write_inline(&w, n);
    *length = w.length;
    write_bytes(&w, "", 1);
    return w.text;
}

char *sgt_write_yaml(source *s, size_t *length)
{
    writer w = {.s = s};
    for (size_t i = 0; i < s->comments; i++) write_comment(&w, s->comment[i]);
    write_block(&w, s->root, 0);
    *length = w.length;
    write_bytes(&w, "", 1);
    return w.text;
}
