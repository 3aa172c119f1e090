// SPDX-License-Identifier: MIT
/* configure.c - configurations: the positions of a zoom, a scanner's angles, a lens hot and cold.
 *
 *     configurations:
 *       - name: wide
 *         surfaces[4].thickness: 2.5
 *         pupil.f_number: 4
 *       - name: tele
 *         surfaces[4].thickness: 11
 *
 * The value null leaves a key out.
 *
 * WHAT IT IS.  The values of the file are the base.  A configuration is a list of edits of the base: each key
 * is a path (sagitta/edit.h) and its value is put there, in the order of the file, as sgt_lens_set_text would
 * (../read/put.c).  The lens of a configuration is made of the tree that results, by the one maker that there
 * is (open.c).  So it is in every bit the lens of a file that has these values and no configurations; and
 * what the reader checks is checked.  The configurations do not depend on each other, nor on their order.
 *
 * WHEN IT IS MADE.  With the base each one is made once, and thrown away: a file whose third configuration is
 * no lens is refused when it is read, and not when somebody asks for the third.  So is an edit of the base.
 * That costs one making for each; there are at most CONFIGURATIONS_MOST.
 *
 * WHAT IS REFUSED beside that: two paths of one configuration that mean the same place, as radius and
 * curvature of a surface do, since one of them would be undone in silence; a name that two have, or that
 * looks like a number or is `all`, as they are chosen by name or number. */
#include "configure.h"

#include "../read/put.h"
#include "../../text/number.h"

#include <stdio.h>
#include <string.h>

static const char KEY[] = "configurations";

/* ------------------------------------------------------------------ made */

static bool holds_over(const node *n)
{
    if (n->over) return true;
    for (size_t i = 0; n->kind != NODE_SCALAR && i < n->count; i++)
        if (n->item[i] && holds_over(n->item[i])) return true;
    return false;
}

/* Does what is put there change which entries of `surfaces` are breaks? */
static bool moves_surfaces(const way *p)
{
    return p->count < 3 || sgt_step_is(&p->step[p->count - 1], "type");
}

/* null leaves a key out: what stands there is then as in a file without it. */
static bool is_null(const node *n)
{
    return n->kind == NODE_SCALAR && !n->quoted &&
           (strcmp(n->text, "null") == 0 || strcmp(n->text, "~") == 0);
}

static void remove_key(source *s, const way *p, const char *path, size_t line)
{
    char why[PATH_WHY];
    spot at;
    if (!sgt_path_find(s->root, p, p->count, &at, why)) tree_fail(s, line, path, "%s", why);
    if (at.in->kind != NODE_MAP) tree_fail(s, line, path, "a place in a list cannot be left out");
    if (!at.is) return;
    if (holds_over(at.is))
        tree_fail(s, line, path, "another path of this configuration has put a value there");
    tree_remove(at.in, at.at);
}

/* A part of what this configuration has put somewhere, or left out, is no second place to put something. */
static void refuse_part(source *s, const way *p, const char *path, size_t line)
{
    char why[PATH_WHY];
    spot at;
    for (size_t i = 1; i < p->count && sgt_path_find(s->root, p, i, &at, why) && at.is; i++)
        if (at.is->over)
            tree_fail(s, line, path, "another path of this configuration has put a value there, of which "
                      "this is a part");
}

/* Turns the tree of s into that of a configuration, which has no others. */
static void configure(source *s, size_t number)
{
    tree_forget_numbers(s->root);
    node **place = sgt_configurations_place(s->root), *map = (*place)->item[number - 1];
    tree_remove(s->root, (size_t)(place - s->root->item));
    s->chosen = map, s->chosen_number = number;
    places known = sgt_path_places(s, s->root);
    for (size_t i = 0; i < map->count; i++) {
        if (sgt_is_configuration_name(map->key[i])) continue;
        const char *path = map->key[i]->text;
        size_t line = map->key[i]->line;
        char why[PATH_WHY];
        node *old;
        way p;
        if (!sgt_path_read(&p, path, why)) tree_fail(s, line, path, "%s", why);
        if (sgt_step_is(&p.step[0], KEY)) tree_fail(s, line, path, "a configuration has none of its own");
        p.known = &known;
        refuse_part(s, &p, path, line);
        if (is_null(map->item[i])) {
            remove_key(s, &p, path, line);
            continue;
        }
        node **to = sgt_put_place(s, &p, path, &line, &old);
        if (old && holds_over(old))
            tree_fail(s, line, path, "another path of this configuration has put a value there");
        *to = map->item[i], (*to)->over = true;
        if (moves_surfaces(&p)) known = sgt_path_places(s, s->root);
    }
}

/* Is the fault told at the first line, that of the whole tree? */
static bool is_of_all(const source *s, const sgt_error *e) { return s->root && e->line == s->root->line; }

/* Is the fault that of the value of this path?  all: it is told at the line of the whole tree. */
static bool is_blamed(const sgt_error *e, const node *key, const node *value, bool all)
{
    const size_t whole = strlen(e->key);
    if (strcmp(e->key, key->text) == 0) return true;
    if (all && whole && strncmp(key->text, e->key, whole) == 0 && strchr(".[", key->text[whole])) return true;
    if (e->line != value->line && e->line != key->line) return false;
    const char *last = strrchr(e->key, '.'), *end = strrchr(key->text, '.');
    last = last ? last + 1 : e->key, end = end ? end + 1 : key->text;
    const size_t stem = strcspn(last, "[");
    return stem && strncmp(end, last, stem) == 0 && (!end[stem] || end[stem] == '[');
}

/* Behind a fault in the lens of a configuration: says of which, and by which of its paths. */
static void blame(const source *s)
{
    sgt_error *e = s->error;
    const node *map = s->chosen;
    if (!map || (!e->line && !*e->key)) return;
    char words[sizeof e->words];
    size_t i = 0;
    while (i < map->count && !is_blamed(e, map->key[i], map->item[i], is_of_all(s, e))) i++;
    const char *who = i < map->count ? map->key[i]->text : e->key;
    snprintf(words, sizeof words, "%.200s%s%.1100s", who, *who ? ": " : "", e->words);
    memcpy(e->words, words, sizeof words);
    if (i < map->count && is_of_all(s, e)) e->line = map->key[i]->line;
    if (!e->line) e->line = map->line;
    snprintf(e->key, sizeof e->key, "%s[%zu]", KEY, s->chosen_number);
}

static bool make_by(whole_lens *w, source *s, const whole_lens *base, size_t number)
{
    jmp_buf here;
    s->refused = &here;
    if (setjmp(here) != 0) return false;
    sgt_take_over(w, s, base);
    configure(s, number);
    sgt_make_lens(w, s);
    return true;
}

/* false: no memory of it is left. */
static bool make_configuration(whole_lens *w, const whole_lens *base, const sgt_lens_options *options,
                               size_t number, sgt_error *error)
{
    *w = (whole_lens){.memory = {.allocator = base->memory.allocator}};
    source s = {.arena = &w->memory, .options = options, .error = error, .file = base->lens.file};
    const bool fine = make_by(w, &s, base, number);
    if (!fine) blame(&s);
    sgt_end_making(w, &s);
    if (!fine) sgt_arena_free(&w->memory);
    return fine;
}

void sgt_check_configurations(const whole_lens *w, source *s)
{
    const size_t count = sgt_lens_configurations(&w->lens);
    for (size_t i = 1; i <= count; i++) {
        whole_lens trial;
        if (!make_configuration(&trial, w, s->options, i, s->error)) longjmp(*s->refused, 1);
        sgt_free_phases(&trial);
        sgt_arena_free(&trial.memory);
    }
}

/* ---------------------------------------------------------------- questions */

static const node *configurations_of(const sgt_lens *lens)
{
    node **place = sgt_configurations_place(((const whole_lens *)(const void *)lens)->root);
    return place ? *place : NULL;
}

size_t sgt_lens_configurations(const sgt_lens *lens)
{
    const node *list = configurations_of(lens);
    return list && list->kind == NODE_LIST ? list->count : 0;
}

const char *sgt_lens_configuration_name(const sgt_lens *lens, size_t number)
{
    return number && number <= sgt_lens_configurations(lens)
               ? sgt_name_of_configuration(configurations_of(lens)->item[number - 1])
               : "";
}

static size_t refuse_configuration(const sgt_lens *lens, sgt_error *error, const char *words)
{
    const node *list = configurations_of(lens);
    if (!error) return 0;
    *error = (sgt_error){.line = list ? list->line : 0};
    snprintf(error->file, sizeof error->file, "%s", lens->file);
    snprintf(error->key, sizeof error->key, "%s", KEY);
    snprintf(error->words, sizeof error->words, "%s", words);
    return 0;
}

/* "there are 3; there is no configuration 4" */
static bool refuse_number(const sgt_lens *lens, long number, sgt_error *error)
{
    const size_t count = sgt_lens_configurations(lens);
    char words[120];
    snprintf(words, sizeof words, "there %s %zu; there is no configuration %ld", count == 1 ? "is" : "are",
             count, number);
    refuse_configuration(lens, error, count ? words : "not given: the file has no configurations");
    return false;
}

bool sgt_choose_configuration(whole_lens *w, const source *s)
{
    const int wanted = s->options->configuration;
    const size_t count = sgt_lens_configurations(&w->lens);
    whole_lens made;
    if (!wanted || s->chosen_number || (!count && wanted == 1)) return true;
    if (wanted < 1 || (size_t)wanted > count) return refuse_number(&w->lens, wanted, s->error);
    if (!make_configuration(&made, w, s->options, (size_t)wanted, s->error)) return false;
    sgt_free_phases(w);
    sgt_arena_free(&w->memory);
    *w = made;
    return true;
}

size_t sgt_lens_configuration_named(const sgt_lens *lens, const char *name, sgt_error *error)
{
    const size_t count = sgt_lens_configurations(lens);
    char words[1200], all[900] = "";
    long number;
    size_t at = 0;
    if (number_read_integer(name, 1, CONFIGURATIONS_MOST, &number) && (size_t)number <= count)
        return (size_t)number;
    for (size_t i = 1; i <= count; i++) {
        const char *own = sgt_lens_configuration_name(lens, i);
        if (*own && strcmp(own, name) == 0) return i;
        if (at < sizeof all)
            at += (size_t)snprintf(all + at, sizeof all - at, "%s%zu%s%.60s", i > 1 ? ", " : "", i,
                                   *own ? " " : "", own);
    }
    if (!count) snprintf(words, sizeof words, "not given: there is no configuration \"%.60s\"", name);
    else
        snprintf(words, sizeof words, "there is no configuration \"%.60s\"; there %s %s", name,
                 count == 1 ? "is" : "are", all);
    return refuse_configuration(lens, error, words);
}

sgt_lens *sgt_lens_configured(const sgt_lens *lens, size_t number, sgt_error *error)
{
    const whole_lens *base = (const void *)lens;
    const sgt_allocator a = base->memory.allocator;
    const size_t count = sgt_lens_configurations(lens);
    sgt_error unread;
    if (!error) error = &unread;
    if (!number || number > count) {
        refuse_number(lens, (long)number, error);
        return NULL;
    }
    whole_lens *w = a.resize(a.context, NULL, sizeof *w);
    if (!w) refuse_configuration(lens, error, "no memory");
    else if (make_configuration(w, base, &base->options, number, error)) return &w->lens;
    a.resize(a.context, w, 0);
    return NULL;
}
