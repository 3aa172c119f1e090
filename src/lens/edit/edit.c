// SPDX-License-Identifier: MIT
/* edit.c - a lens is copied, asked and changed by the paths of its file.
 *
 * ONE WAY TO A LENS.  An edit copies the tree into an arena of its own, changes the copy, and has the lens
 * made of it by the same function that made it when the file was read (../open/open.c).  If all went well the
 * new lens takes the place of the old one in its struct, and the old arena goes; else the new arena goes.  So
 *   - an edited lens is the lens of its written file: there is no second way to make one;
 *   - a lens whose edit was refused, or found no memory, is as it was: nothing of it was touched;
 *   - memory does not grow with the number of edits.
 *
 * WHAT IS NOT DONE AGAIN.  The text is not parsed and the catalogue of glasses not searched: glasses are
 * copied by their names (../read/medium.c).  For a lens of twelve surfaces an edit of a number is some
 * 140,000 instructions. */
#include "edit.h"

#include "../../text/number.h"

#include "../base/reader.h"
#include "../open/configure.h"
#include "../read/put.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------ faults */

static bool refuse_path(const sgt_lens *lens, const char *path, const char *why, sgt_error *error)
{
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    snprintf(error->file, sizeof error->file, "%s", lens->file);
    snprintf(error->key, sizeof error->key, "%s", path);
    snprintf(error->words, sizeof error->words, "%s", why);
    return false;
}

static const char *path_of(const sgt_edit *e) { return e->path ? e->path : ""; }

/* Of which edit a fault is that the reader found: the first whose path ends with the reader's key; else the
 * first, and the key stands before the words. */
static void name_path(sgt_error *error, size_t count, const sgt_edit edit[])
{
    char key[sizeof error->key], words[sizeof error->words];
    const char *last = strrchr(error->key, '.');
    snprintf(key, sizeof key, "%s", error->key);
    last = last ? last + 1 : error->key;
    const bool whole_path = strncmp(key, "surfaces[", 9) == 0 || strncmp(key, "breaks[", 7) == 0;
    const size_t stem = whole_path ? 0 : strcspn(last, "[");
    size_t i = 0;
    for (; i < count; i++) {
        const char *whole = path_of(&edit[i]), *end = strrchr(whole, '.');
        end = end ? end + 1 : whole;
        if (strcmp(whole, key) == 0 ||
            (stem && strncmp(end, last, stem) == 0 && (!end[stem] || end[stem] == '[')))
            break;
    }
    if (i == count && *key) {
        snprintf(words, sizeof words, "%s", error->words);
        snprintf(error->words, sizeof error->words, "%s: %.1200s", key, words);
    }
    snprintf(error->key, sizeof error->key, "%s", path_of(&edit[i < count ? i : 0]));
}

/* ----------------------------------------------------------------- changes */

/* A list of decimal numbers needs no parser of YAML, which takes ten times as long.  NULL: it is none. */
static node *list_of_numbers(source *s, const char *yaml, size_t line)
{
    if (!yaml || *yaml != '[') return NULL;
    const char *at = yaml + 1;
    double x;
    node *list = tree_node(s, NODE_LIST, line);
    list->inline_ = true;
    for (;;) {
        const char *end = at + strcspn(at, ",]");
        if (!number_read_decimal(at, end, &x)) return NULL;
        tree_append(s, list, tree_scalar(s, line, at, (size_t)(end - at)));
        if (*end == ']') return end[1] ? NULL : list;
        if (*end != ',' || end[1] != ' ') return NULL;
        at = end + 2;
    }
}

/* The tree of a piece of YAML, all of it at the line of what it replaces. */
static node *parse_value(source *s, const char *yaml, size_t line)
{
    node *list = list_of_numbers(s, yaml, line);
    if (list) return list;
    source own = *s;
    own.text = yaml ? yaml : "", own.length = strlen(own.text), own.root = NULL;
    own.comment = NULL, own.comments = own.comment_room = 0, own.only_line = line;
    sgt_read_yaml(&own);
    return own.root;
}

/* Puts a value where a path leads.  A number that stands there already stays as it is written. */
static void put_value(source *s, const way *p, const sgt_edit *e)
{
    double stands;
    node *old;
    size_t line = 0;
    const bool number = e->kind == SGT_EDIT_SET;
    node **place = sgt_put_place(s, p, e->path, &line, &old);
    if (number && *place && sgt_path_number(*place, &stands) &&
        memcmp(&stands, &e->number, sizeof stands) == 0)
        return;
    *place = number ? tree_number(s, line, e->number) : parse_value(s, e->text, line);
}

static void change(source *s, const sgt_edit *edit)
{
    editing e = {.s = s, .edit = edit};
    for (size_t i = 0; i < sizeof edit->reserved_ / sizeof *edit->reserved_; i++)
        if (edit->reserved_[i])
            sgt_edit_refuse(&e, "the program asks for a member that sagitta %s has not", sgt_version());
    if (edit->kind != SGT_EDIT_SCALE) e.at = sgt_edit_way(&e, path_of(edit));
    switch (edit->kind) {
    case SGT_EDIT_SET:
    case SGT_EDIT_SET_TEXT:
        put_value(s, &e.at, edit);
        return;
    case SGT_EDIT_INSERT:
        sgt_edit_insert(&e, parse_value(s, edit->text, s->root->line));
        return;
    case SGT_EDIT_REMOVE:
        sgt_edit_remove(&e);
        return;
    case SGT_EDIT_REVERSE:
        sgt_edit_reverse(&e);
        return;
    case SGT_EDIT_SCALE:
        sgt_edit_scale(&e);
        return;
    }
    sgt_edit_refuse(&e, "no kind of edit: %d", (int)edit->kind);
}

/* ------------------------------------------------------------- a new making */

/* false: error->key is the reader's, or the path if *changed is less than count. */
static bool make_anew(whole_lens *w, source *s, const whole_lens *old, size_t count, const sgt_edit edit[],
                      size_t *changed)
{
    jmp_buf here;
    s->refused = &here;
    if (setjmp(here) != 0) return false;
    sgt_take_over(w, s, old);
    for (; *changed < count; ++*changed) change(s, &edit[*changed]);
    tree_forget_numbers(s->root);
    sgt_make_lens(w, s);
    if (count) sgt_check_configurations(w, s); /* those of a copy are lenses */
    return true;
}

/* The lens with its edits, in *out, whose memory is new. */
static bool edited(const sgt_lens *lens, size_t count, const sgt_edit edit[], whole_lens *out,
                   sgt_error *error)
{
    const whole_lens *old = (const void *)lens;
    size_t changed = 0;
    *out = (whole_lens){.memory = {.allocator = old->memory.allocator}};
    source s = {.arena = &out->memory, .options = &old->options, .error = error, .file = lens->file};
    const bool fine = make_anew(out, &s, old, count, edit, &changed);
    sgt_end_making(out, &s);
    if (fine) return true;
    sgt_arena_free(&out->memory);
    if (changed < count)
        snprintf(error->key, sizeof error->key, "%s", path_of(&edit[changed]));
    else if (count)
        name_path(error, count, edit);
    return false;
}

/* A scale multiplies the numbers that the reader has read; so the lens is made before each. */
static size_t end_of_making(size_t from, size_t count, const sgt_edit edit[])
{
    size_t end = from < count ? from + 1 : count;
    while (end < count && edit[end].kind != SGT_EDIT_SCALE) end++;
    return end;
}

bool sgt_lens_edit(sgt_lens *lens, size_t count, const sgt_edit edit[], sgt_error *error)
{
    whole_lens *w = (void *)lens, made, new;
    sgt_error unread;
    const sgt_lens *from = lens;
    size_t done = 0;
    do {
        const size_t end = end_of_making(done, count, edit);
        const bool fine = edited(from, end - done, edit + done, &new, error ? error : &unread);
        if (from != lens) sgt_arena_free(&made.memory);
        if (!fine) return false;
        made = new, from = &made.lens, done = end;
    } while (done < count);
    sgt_free_phases(w);
    sgt_arena_free(&w->memory);
    *w = made;
    return true;
}

sgt_lens *sgt_lens_copy(const sgt_lens *lens, sgt_error *error)
{
    const sgt_allocator a = ((const whole_lens *)(const void *)lens)->memory.allocator;
    sgt_error unread;
    if (!error) error = &unread;
    whole_lens *w = a.resize(a.context, NULL, sizeof *w);
    if (!w)
        refuse_path(lens, "", "no memory", error);
    else if (edited(lens, 0, NULL, w, error))
        return &w->lens;
    a.resize(a.context, w, 0);
    return NULL;
}

bool sgt_lens_set(sgt_lens *lens, const char *path, double x, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_SET, .path = path, .number = x}, error);
}

bool sgt_lens_set_text(sgt_lens *lens, const char *path, const char *yaml, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_SET_TEXT, .path = path, .text = yaml}, error);
}

bool sgt_lens_insert(sgt_lens *lens, const char *path, const char *yaml, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_INSERT, .path = path, .text = yaml}, error);
}

bool sgt_lens_remove(sgt_lens *lens, const char *path, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_REMOVE, .path = path}, error);
}

bool sgt_lens_reverse(sgt_lens *lens, const char *first, const char *last, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_REVERSE, .path = first, .text = last}, error);
}

bool sgt_lens_scale(sgt_lens *lens, double factor, sgt_error *error)
{
    return sgt_lens_edit(lens, 1, &(sgt_edit){.kind = SGT_EDIT_SCALE, .number = factor}, error);
}

/* --------------------------------------------------------------- questions */

static node *find(const sgt_lens *lens, const char *text, bool *inverse, sgt_error *error)
{
    const whole_lens *w = (const void *)lens;
    char why[PATH_WHY];
    way p;
    node *found = sgt_path_read(&p, text, why) ? sgt_path_value(w->root, &p, inverse, why) : NULL;
    if (!found) refuse_path(lens, text, why, error);
    return found;
}

bool sgt_lens_get(const sgt_lens *lens, const char *path, double *x, sgt_error *error)
{
    bool inverse;
    const node *n = find(lens, path, &inverse, error);
    *x = (double)NAN;
    if (!n) return false;
    if (!sgt_path_number(n, x)) {
        *x = (double)NAN;
        return refuse_path(lens, path, "is no number", error);
    }
    if (inverse) *x = 1 / *x;
    return true;
}

/* In an arena of its own, so that a const lens is asked from any thread. */
static bool write_found(source *s, const node *n, const char **text, size_t *length)
{
    jmp_buf here;
    s->refused = &here;
    if (setjmp(here) != 0) return false;
    *text = sgt_write_line(s, n, length);
    return true;
}

size_t sgt_lens_get_text(const sgt_lens *lens, const char *path, size_t room, char text[], sgt_error *error)
{
    const whole_lens *w = (const void *)lens;
    static const sgt_lens_options defaults = {0};
    bool inverse;
    const node *n = find(lens, path, &inverse, error);
    if (room) text[0] = 0;
    if (!n) return SIZE_MAX;
    if (inverse) {
        refuse_path(lens, path, "not given in the file", error);
        return SIZE_MAX;
    }
    arena memory = {.allocator = w->memory.allocator};
    sgt_error unread;
    const char *line;
    size_t length;
    source s = {.arena = &memory, .options = &defaults, .error = &unread, .file = lens->file};
    if (write_found(&s, n, &line, &length)) {
        if (room) snprintf(text, room, "%s", line);
    } else {
        refuse_path(lens, path, unread.words, error);
        length = SIZE_MAX;
    }
    sgt_arena_free(&memory);
    return length;
}

typedef struct listing {
    size_t most, count;
    sgt_lens_path *at;
} listing;

static void list_number(void *context, const char *path, const node *n)
{
    listing *l = context;
    sgt_lens_path one = {.value = (double)NAN};
    if (!sgt_path_number(n, &one.value)) return;
    snprintf(one.path, sizeof one.path, "%s", path);
    if (l->count < l->most) l->at[l->count] = one;
    l->count++;
}

size_t sgt_lens_paths(const sgt_lens *lens, size_t most, sgt_lens_path at[])
{
    const whole_lens *w = (const void *)lens;
    listing all = {.most = most, .at = at};
    sgt_path_numbers(w->root, list_number, &all);
    return all.count;
}
