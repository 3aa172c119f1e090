// SPDX-License-Identifier: MIT
/* shape.c - surfaces as lens files have them, read by the library's own reader (sagitta/lens.h).
 *
 * That reader takes one surface as text, `{type: sphere, radius: 20}`.  An object's map holds such a
 * surface and keys of this program beside it.  So the map is written out once more, without the keys of
 * this program, and given to the reader under the scene's name: files that it names are looked for beside
 * the scene.  What is written stands on the line on which it stands in the scene, so a fault is told with
 * the line that the user sees.  (An alias is written out where it is used.  If its anchor stands above, it
 * takes the line that has been reached.)  Types, keys, limits and messages are the reader's; a type that
 * comes to it later can be used here at once.  Surfaces of this program's own go to the reader as a table
 * (own.h). */
#include "shape.h"

#include "own.h"

#include <sagitta/lens.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text as far as it is written. */
enum { TEXT_MOST = 1 << 28, DEPTH_MOST = 64, KNOWN_SIZE = 1600 };
typedef struct writer { char *text; size_t length, room, line; } writer;

static void write_bytes(writer *w, const char *bytes, size_t length)
{
    if (w->room < w->length + length + 1)
        w->text = room(w->text, w->room = 2 * (w->length + length) + 4096, 1);
    memcpy(w->text + w->length, bytes, length);
    w->length += length;
    w->text[w->length] = 0;
}

static void write_words(writer *w, const char *words) { write_bytes(w, words, strlen(words)); }

static void go_to_line(writer *w, const node *n)
{
    for (; w->line < n->start_mark.line; w->line++) write_bytes(w, "\n", 1);
}

/* What is a number or a plain word anywhere stays one.  All else goes in quotes, with every byte that is
 * not a printing character of ASCII, and not of a longer one in UTF-8, by its number. */
static void write_scalar(writer *w, const node *n)
{
    const unsigned char *text = n->data.scalar.value;
    size_t length = n->data.scalar.length, plain = strspn((const char *)text, "+-.0123456789_"
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
    bool bare = n->data.scalar.style == YAML_PLAIN_SCALAR_STYLE && plain == length && length > 0 &&
                strspn((const char *)text, "-.") < length;
    if (bare) {
        write_bytes(w, (const char *)text, length);
        return;
    }
    write_words(w, "\"");
    for (size_t i = 0; i < length; i++) {
        char byte[8];
        bool kept = text[i] >= ' ' && text[i] != 127 && text[i] != '"' && text[i] != '\\';
        int size = snprintf(byte, sizeof byte, kept ? "%c" : "\\x%02X", text[i]);
        write_bytes(w, byte, (size_t)size);
    }
    write_words(w, "\"");
}

static void write_node(document *d, writer *w, const node *n, const char *key, int depth)
{
    if (depth > DEPTH_MOST || w->length > TEXT_MOST)
        document_fail(d, n, key, "too long, or holds itself: an alias within its own anchor");
    go_to_line(w, n);
    if (n->type == YAML_SCALAR_NODE) {
        write_scalar(w, n);
    } else if (n->type == YAML_SEQUENCE_NODE) {
        write_words(w, "[");
        for (int i = 0; i < n->data.sequence.items.top - n->data.sequence.items.start; i++) {
            if (i) write_words(w, ", ");
            write_node(d, w, document_item(d, n, i), key, depth + 1);
        }
        write_words(w, "]");
    } else {
        const node *item, *value;
        write_words(w, "{");
        for (int i = 0; (item = document_key(d, n, i, &value)); i++) {
            if (i) write_words(w, ", ");
            write_node(d, w, item, key, depth + 1);
            write_words(w, ": ");
            write_node(d, w, value, key, depth + 1);
        }
        write_words(w, "}");
    }
}

static bool is_automatic(const char *key, const node *value)
{
    return strcmp(key, "iterations") == 0 && value->type == YAML_SCALAR_NODE &&
           strcmp((const char *)value->data.scalar.value, "auto") == 0;
}

/* The surface of the map, without the keys in `more`. */
static char *surface_text(document *d, const node *map, const char *more)
{
    writer w = {0};
    const node *key, *value;
    go_to_line(&w, map);
    write_words(&w, "{");
    bool any = false;
    for (int i = 0; (key = document_key(d, map, i, &value)); i++) {
        const char *name = document_word(d, key, "key");
        if (document_is_among(name, more)) continue;
        if (any) write_words(&w, ", ");
        any = true;
        go_to_line(&w, key);
        write_scalar(&w, key);
        write_words(&w, ": ");
        if (is_automatic(name, value)) write_words(&w, "10"); /* until the view is known: levels.c */
        else write_node(d, &w, value, name, 1);
    }
    write_words(&w, "}");
    return w.text;
}

static const sgt_builtin *row_of(const char *type)
{
    const sgt_builtin *const tables[] = {sgt_builtins(), own_surfaces};
    for (int i = 0; i < 2; i++)
        for (const sgt_builtin *b = tables[i]; b->type; b++)
            if (strcmp(b->type, type) == 0) return b;
    return NULL;
}

/* A sheet may have a rim, or is a sag by name; the edge of a lens ends.  All else is closed, or its border
 * is that of a convex region: along a ray F falls and rises in turn. */
static bool is_sheet(document *d, const node *map, const sgt_builtin *row, const sgt_surface_ops *ops)
{
    bool sheet = ops == &edge_ops || document_find(d, map, "sag") || document_find(d, map, "semi_diameter");
    for (const sgt_param *p = row ? row->params : NULL; p && p->name; p++)
        sheet = sheet || strcmp(p->name, "semi_diameter") == 0;
    return sheet;
}

static bool is_bounded(const sgt_surface_ops *ops)
{
    const sgt_surface_ops *const all[] = {&sgt_torus_ops,      &sgt_ellipsoid_ops, &sgt_julia_ops,
                                          &sgt_mandelbrot_ops, &mandelbulb_ops,    &box_ops,
                                          &menger_ops,         &sierpinski_ops};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (ops == all[i]) return ops->span != NULL;
    return false;
}

void shape_read(document *d, const node *map, const char *more, object *o)
{
    const sgt_lens_options options = {.types = own_surfaces};
    sgt_error e;
    document_keys(d, map, "objects");
    char *text = surface_text(d, map, more);
    o->read = sgt_lens_read_surface(d->file, text, &options, &e);
    free(text);
    if (!o->read) {
        bool unknown = strncmp(e.words, "unknown key", strlen("unknown key")) == 0;
        fail_input("%s:%zu: %s%s%s%s%s", e.file, e.line, e.key, *e.key ? ": " : "", e.words,
                   unknown ? "; and of an object " : "", unknown ? more : "");
    }
    o->surface = o->read->element[0].surface;
    /* in the object's own room, where a film may change it */
    if (o->surface.ops == &sgt_julia_ops) {
        memcpy(&o->own.julia, o->surface.self, sizeof o->own.julia);
        o->surface.self = &o->own.julia;
    } else if (o->surface.ops == &sgt_mandelbrot_ops) {
        memcpy(&o->own.mandelbrot, o->surface.self, sizeof o->own.mandelbrot);
        o->surface.self = &o->own.mandelbrot;
    }
    const node *levels = document_find(d, map, "iterations");
    o->automatic = levels && is_automatic("iterations", levels);
    if (o->automatic && o->surface.self != &o->own)
        document_fail(d, levels, "iterations", "auto is of julia and mandelbrot only");
    o->bounded = is_bounded(o->surface.ops);
    o->sheet = is_sheet(d, map, row_of(o->read->surface[0].type), o->surface.ops);
}
