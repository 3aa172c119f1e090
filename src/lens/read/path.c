// SPDX-License-Identifier: MIT
/* path.c - paths, and the places in the tree that they mean.
 *
 *     path  = key { "." key | "[" place "]" | "[" name "]" }      place: digits, from 1
 *
 * The path is the place in the file, with one exception: the list `surfaces` has breaks among its surfaces,
 * and surfaces are counted without them in all tables of the project.  So surfaces[3] is the third entry that
 * is no break, and breaks[2] the second that is one. */
#include "path.h"

#include "../../text/number.h"
#include "../base/reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_digits(const char *text, size_t length)
{
    return length && strspn(text, "0123456789") >= length;
}

bool sgt_step_is(const path_step *step, const char *key)
{
    return step->text && !step->name && strlen(key) == step->length &&
           memcmp(step->text, key, step->length) == 0;
}

/* What stands in brackets, behind the first; NULL: `why`. */
static const char *read_brackets(path_step *step, const char *at, char why[PATH_WHY])
{
    const bool quoted = *at == '"' || *at == '\'';
    const char *end = strchr(at + quoted, quoted ? *at : ']');
    if (!end || end == at + quoted || (quoted && end[1] != ']')) {
        snprintf(why, PATH_WHY, "no path: [%.40s is no place and no name in brackets", at);
        return NULL;
    }
    *step = (path_step){.text = at + quoted, .length = (size_t)(end - at) - quoted, .name = true};
    if (quoted || !is_digits(at, step->length)) return end + 1 + quoted;
    long place;
    char digits[12];
    snprintf(digits, sizeof digits, "%.*s", step->length < 10 ? (int)step->length : 10, at);
    if (!number_read_integer(digits, 1, 999999999, &place)) {
        snprintf(why, PATH_WHY, "no path: places count from 1, and [%.20s is none", at);
        return NULL;
    }
    *step = (path_step){.place = (size_t)place};
    return end + 1;
}

bool sgt_path_read(way *p, const char *text, char why[PATH_WHY])
{
    const char *at = text;
    *p = (way){.count = 0};
    while (*at || !p->count) {
        if (p->count == PATH_STEPS) {
            snprintf(why, PATH_WHY, "no path: it has more than %d steps", PATH_STEPS);
            return false;
        }
        path_step *step = &p->step[p->count++];
        if (*at == '[' && p->count > 1) {
            if (!(at = read_brackets(step, at + 1, why))) return false;
            continue;
        }
        const bool first = p->count == 1, point = !first && *at == '.';
        const size_t length = strcspn(at + point, ".[");
        *step = (path_step){.text = at + point, .length = length};
        if (length == 0 || (!first && !point)) {
            snprintf(why, PATH_WHY, "no path: a key is missing at \"%.40s\"; write it as "
                     "surfaces[3].thickness", at);
            return false;
        }
        at += point + length;
    }
    return true;
}

/* ------------------------------------------------------------------ places */

static const node *value_of(const node *map, const char *key)
{
    for (size_t i = 0; map->kind == NODE_MAP && i < map->count; i++)
        if (map->key[i]->kind == NODE_SCALAR && strcmp(map->key[i]->text, key) == 0) return map->item[i];
    return NULL;
}

static bool holds_break(const node *entry)
{
    const node *type = value_of(entry, "type");
    return type && type->kind == NODE_SCALAR && strcmp(type->text, "break") == 0;
}

static bool is_called(const node *entry, const path_step *step)
{
    const node *name = value_of(entry, "name");
    return name && name->kind == NODE_SCALAR && strlen(name->text) == step->length &&
           memcmp(name->text, step->text, step->length) == 0;
}

places sgt_path_places(source *s, const node *root)
{
    places p = {.list = value_of(root, "surfaces")};
    if (!p.list || p.list->kind != NODE_LIST) return (places){.list = NULL};
    p.surface = tree_room(s, p.list->count, sizeof *p.surface);
    p.lies = tree_room(s, p.list->count, sizeof *p.lies);
    for (size_t i = 0; i < p.list->count; i++)
        if (holds_break(p.list->item[i])) p.lies[p.breaks++] = i;
        else p.surface[p.surfaces++] = i;
    return p;
}

/* The same as find_in_list of a place that is known. */
static bool find_known(const places *p, node *list, const path_step *step, char kind, spot *out)
{
    if (!p || p->list != list || !kind || step->text) return false;
    if (step->place > (kind == 'b' ? p->breaks : p->surfaces)) return false;
    out->at = (kind == 'b' ? p->lies : p->surface)[step->place - 1], out->is = list->item[out->at];
    return true;
}

/* The place in a list.  kind 's', 'b': of the list of surfaces, those that are none or that are breaks. */
static bool find_in_list(const node *list, const path_step *step, char kind, spot *out, char why[PATH_WHY])
{
    size_t count = 0, called = 0;
    for (size_t i = 0; i < list->count; i++) {
        if (kind && holds_break(list->item[i]) != (kind == 'b')) continue;
        if (step->text ? is_called(list->item[i], step) && called++ == 0 : ++count == step->place)
            out->at = i, out->is = list->item[i];
    }
    const char *what = kind == 's' ? "surface" : kind == 'b' ? "break" : "entry";
    if (step->text && called > 1)
        snprintf(why, PATH_WHY, "%zu %ss are called \"%.*s\"; say which by its number", called, what,
                 step->length < 60 ? (int)step->length : 60, step->text);
    else if (step->text && !called)
        snprintf(why, PATH_WHY, "no %s is called \"%.*s\"", what, step->length < 60 ? (int)step->length : 60,
                 step->text);
    else if (!step->text && step->place > count)
        snprintf(why, PATH_WHY, "there is no %s %zu; there %s %zu", what, step->place,
                 count == 1 ? "is" : "are", count);
    else return true;
    return false;
}

static bool find_key(node *map, const path_step *step, spot *out)
{
    for (size_t i = 0; i < map->count; i++)
        if (map->key[i]->kind == NODE_SCALAR && sgt_step_is(step, map->key[i]->text)) {
            out->at = i, out->is = map->item[i];
            return true;
        }
    out->at = map->count;
    return false;
}

/* The key of a map that is most like one that it has not; NULL: none is like it. */
static const char *nearest_key(const node *map, const path_step *step)
{
    const char *near = NULL;
    size_t least = step->length / 3 + 1;
    for (size_t i = 0; i < map->count; i++) {
        const node *k = map->key[i];
        if (k->kind != NODE_SCALAR) continue;
        const piece key = {k->text, k->text + strlen(k->text)};
        const size_t apart = sgt_reader_distance((piece){step->text, step->text + step->length}, key);
        if (apart < least) near = k->text, least = apart;
    }
    return near;
}

bool sgt_path_find(node *root, const way *p, size_t count, spot *out, char why[PATH_WHY])
{
    *out = (spot){.is = root};
    char kind = 0;
    for (size_t i = 0; i < count; i++) {
        const path_step *step = &p->step[i];
        node *in = out->is;
        const char list_kind = kind;
        *out = (spot){.in = in};
        kind = 0;
        if (step->name || !step->text) {
            if (in->kind != NODE_LIST) {
                snprintf(why, PATH_WHY, "no list, so it has no place in brackets");
                return false;
            }
            out->surface = list_kind != 0;
            if (!find_known(p->known, in, step, list_kind, out) &&
                !find_in_list(in, step, list_kind, out, why))
                return false;
            continue;
        }
        path_step key = *step;
        if (i == 0 && sgt_step_is(step, "breaks")) key.text = "surfaces", key.length = 8, kind = 'b';
        else if (i == 0 && sgt_step_is(step, "surfaces")) kind = 's';
        if (in->kind != NODE_MAP) {
            snprintf(why, PATH_WHY, "%.*s is no key here: %s", step->length < 60 ? (int)step->length : 60,
                     step->text, in->kind == NODE_LIST ? "a place in the list is missing, as [1]"
                                                       : "a single value stands in front of it");
            return false;
        }
        if (!find_key(in, &key, out) && i + 1 < count) {
            const char *near = nearest_key(in, step);
            snprintf(why, PATH_WHY, "%.*s is not given%s%.60s%s", step->length < 60 ? (int)step->length : 60,
                     step->text, near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
            return false;
        }
    }
    return true;
}

/* ------------------------------------------------------------------ rivals */

static const char *turned_stem(const char *key, const char *from, const char *to, char room[PATH_KEY])
{
    const size_t stem = strlen(from);
    if (strncmp(key, from, stem) != 0) return NULL;
    snprintf(room, PATH_KEY, "%s%s", to, key + stem);
    return room;
}

const char *sgt_path_rival(const char *key, bool in_pupil, int i, char room[PATH_KEY])
{
    static const char *const sizes[] = {"semi_diameter", "diameter", "f_number", "working_f_number",
                                        "image_na", "object_na", "object_angle", "stop_size"};
    enum { SIZES = sizeof sizes / sizeof *sizes };
    int own = 0;
    while (in_pupil && own < SIZES && strcmp(sizes[own], key) != 0) own++;
    if (in_pupil) return own == SIZES || i >= SIZES - 1 ? NULL : sizes[i < own ? i : i + 1];
    if (i > 0) return NULL;
    if (strcmp(key, "index") == 0) return "glass";
    if (strcmp(key, "glass") == 0) return "index";
    const char *other = turned_stem(key, "radius", "curvature", room);
    return other ? other : turned_stem(key, "curvature", "radius", room);
}

node *sgt_path_value(node *root, const way *p, bool *inverse, char why[PATH_WHY])
{
    spot at;
    char key[PATH_KEY], room[PATH_KEY];
    *inverse = false;
    if (!sgt_path_find(root, p, p->count, &at, why)) return NULL;
    if (at.is) return at.is;
    const path_step *last = &p->step[p->count - 1];
    snprintf(key, sizeof key, "%.*s", last->length < PATH_KEY ? (int)last->length : PATH_KEY - 1, last->text);
    const char *rival = *key == 'r' || *key == 'c' ? sgt_path_rival(key, false, 0, room) : NULL;
    const path_step other = {.text = rival, .length = rival ? strlen(rival) : 0};
    if (rival && find_key(at.in, &other, &at)) {
        *inverse = true;
        return at.is;
    }
    snprintf(why, PATH_WHY, "not given in the file");
    return NULL;
}

/* ----------------------------------------------------------------- numbers */

bool sgt_path_number(const node *n, double *x)
{
    if (n->kind == NODE_MAP && n->is && n->is->value) n = n->is->value;
    if (n->kind != NODE_SCALAR) return false;
    if (number_read(n->text, x)) return true;
    *x = sgt_spectral_line(n->text);
    return !isnan(*x);
}

typedef struct walk {
    void (*each)(void *context, const char *path, const node *n);
    void *context;
    char text[SGT_PATH_SIZE];
} walk;

enum { WALK_DEPTH = 32 }; /* a lens that was read is not so deep */

static void walk_node(walk *w, const node *n, size_t length, int depth);

/* Goes on behind a step; what has no room is left out. */
static void walk_step(walk *w, const node *n, size_t length, int depth, const char *key, size_t place)
{
    const size_t room = sizeof w->text - length;
    const int more = key ? snprintf(w->text + length, room, "%s%s", length ? "." : "", key)
                         : snprintf(w->text + length, room, "[%zu]", place);
    if (more > 0 && (size_t)more < room) walk_node(w, n, length + (size_t)more, depth + 1);
    w->text[length] = 0;
}

static void walk_node(walk *w, const node *n, size_t length, int depth)
{
    if (n->kind == NODE_SCALAR && n->number) w->each(w->context, w->text, n);
    if (n->kind == NODE_SCALAR || depth >= WALK_DEPTH) return;
    const bool surfaces = n->kind == NODE_LIST && depth == 1 && strcmp(w->text, "surfaces") == 0;
    for (size_t i = 0, breaks = 0; i < n->count; i++) {
        if (surfaces && holds_break(n->item[i])) {
            memcpy(w->text, "breaks", 7);
            walk_step(w, n->item[i], 6, depth, NULL, ++breaks);
            memcpy(w->text, "surfaces", 9);
        } else {
            walk_step(w, n->item[i], length, depth, n->kind == NODE_MAP ? n->key[i]->text : NULL,
                      i + 1 - breaks);
        }
    }
}

void sgt_path_numbers(const node *root, void (*each)(void *context, const char *path, const node *n),
                      void *context)
{
    walk w = {each, context, ""};
    walk_node(&w, root, 0, 0);
}
