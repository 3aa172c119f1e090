// SPDX-License-Identifier: MIT
/* lens.c - a lens as a command uses it.
 *
 * Reading is sagitta_lens's.  Here are the command's own manners: files are read by input.c, so
 * that no output overwrites them; an error ends the command; remarks become notes. */
#include "lens.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "earth.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

_Noreturn void lens_refuse(const sgt_error *e)
{
    const char *key = e->key, *colon = *key ? ": " : "";
    if (e->line) fail_input("%s:%zu: %s%s%s", e->file, e->line, key, colon, e->words);
    fail_input("%s%s%s%s%s", e->file, *e->file ? ": " : "", key, colon, e->words);
}

_Noreturn void lens_fail(const lens *l, const char *key, const char *format, ...)
{
    sgt_error e = {.line = l->of->line};
    va_list values;
    va_start(values, format);
    vsnprintf(e.words, sizeof e.words, format, values);
    va_end(values);
    snprintf(e.file, sizeof e.file, "%s", l->of->file);
    snprintf(e.key, sizeof e.key, "%s", key);
    lens_refuse(&e);
}

/* ------------------------------------------------------------------ options */

static const char **folder;
static size_t folders, folder_capacity;

void lens_glass_folder(const char *path)
{
    folder = memory_room(folder, folders, &folder_capacity, sizeof *folder);
    folder[folders++] = path;
}

static const char *configuration; /* NULL: not given */

void lens_configuration(const char *which)
{
    if (*which && strspn(which, "0123456789") == strlen(which)) {
        char *end;
        const long number = strtol(which, &end, 10);
        if (number < 1 || number > INT_MAX)
            fail_usage("--configuration must be a number from 1, a name, or all, not %s", which);
    }
    configuration = which;
}

static bool all_configurations(void) { return configuration && strcmp(configuration, "all") == 0; }

/* 0: it is no number. */
static int configuration_number(void)
{
    const char *c = configuration;
    return c && *c && strspn(c, "0123456789") == strlen(c) ? atoi(c) : 0;
}

static sgt_catalogue *glasses;

static void forget_glasses(void) { sgt_catalogue_free(glasses); }

/* The glasses that ship and those of --glass; NULL without --glass: the library then reads the table if it
 * needs it.  Of glasses with one name and no maker to decide, the last that was added is taken. */
static const sgt_catalogue *own_glasses(void)
{
    if (glasses || !folders) return glasses;
    sgt_error e;
    glasses = sgt_catalogue_new(NULL);
    if (!glasses) fail_input("out of memory");
    atexit(forget_glasses);
    if (!sgt_catalogue_add(glasses, NULL, &e)) lens_refuse(&e);
    for (size_t i = 0; i < folders; i++)
        if (!sgt_catalogue_add(glasses, folder[i], &e)) lens_refuse(&e);
    return glasses;
}

static const char *read_whole(void *context, const char *path, char **text, size_t *length)
{
    (void)context;
    input in;
    const char *fault = input_try(path, &in);
    *text = in.text, *length = in.length;
    return fault;
}

static void forget_text(void *context, char *text)
{
    (void)context;
    memory_drop(text);
}

sgt_lens_options lens_options(void)
{
    return (sgt_lens_options){.glasses = own_glasses(), .types = earth_types(),
                              .file_ops = earth_file_ops(), .complete = earth_complete,
                              .read = read_whole, .forget = forget_text};
}

/* --------------------------------------------------------------- the lens */

/* Lenses are freed when the command ends. */
static sgt_lens **lenses;
static size_t lens_count, lens_capacity;

static void free_lenses(void)
{
    for (size_t i = 0; i < lens_count; i++) sgt_lens_free(lenses[i]);
    free(lenses);
}

sgt_lens *lens_keep(sgt_lens *l)
{
    if (lens_count == lens_capacity) {
        if (!lenses) atexit(free_lenses);
        lens_capacity = lens_capacity ? 2 * lens_capacity : 8;
        sgt_lens **more = realloc(lenses, lens_capacity * sizeof *more);
        if (!more) fail_input("out of memory");
        lenses = more;
    }
    return lenses[lens_count++] = l;
}

bool lens_formula_of(sgt_surface s, const char **text, const sgt_named **parameter, size_t *count)
{
    for (size_t i = 0; i < lens_count; i++)
        for (size_t k = 1; k <= lenses[i]->count; k++)
            if (lenses[i]->element[k - 1].surface.self == s.self &&
                sgt_lens_formula(lenses[i], k, text, parameter, count))
                return true;
    return false;
}

/* --------------------------------------------------------------- what is set */

static sgt_edit *edit;
static size_t edits, edit_capacity;

/* Where the path ends: the first = that is not in brackets. */
static const char *end_of_path(const char *text)
{
    int open = 0;
    for (; *text && (*text != '=' || open); text++) open += (*text == '[') - (*text == ']');
    return *text ? text : NULL;
}

void lens_edit(sgt_edit one)
{
    edit = memory_room(edit, edits, &edit_capacity, sizeof *edit);
    edit[edits++] = one;
}

void lens_edit_value(sgt_edit_kind kind, const char *option, const char *text)
{
    const char *end = end_of_path(text);
    if (!end || end == text)
        fail_usage("--%s must be PATH=VALUE, as surfaces[3].thickness=4.5, not \"%s\"", option, text);
    lens_edit((sgt_edit){.kind = kind, .path = memory_text(text, (size_t)(end - text)), .text = end + 1});
}

static bool strict;

void lens_be_strict(void) { strict = true; }

static bool no_ranges;

void lens_note_no_ranges(void) { no_ranges = true; }

/* Notes each glass that is used outside its range at the wavelength, once. */
static void note_ranges(const lens *l)
{
    sgt_glass g, before = {.name = NULL};
    size_t line;
    for (size_t i = 0; i <= l->count; i++) {
        if (!sgt_lens_glass(l->of, i, &g, &line) || sgt_glass_covers(&g, l->wavelength)) continue;
        if (before.name && strcmp(before.name, g.name) == 0) continue;
        static const char words[] = "%s:%zu: glass: %g micrometres is outside the range of %s, %g to %g";
        if (no_ranges && !strict) return;
        if (strict) fail_input(words, l->of->file, line, l->wavelength, g.name, g.from, g.to);
        note(words, l->of->file, line, l->wavelength, g.name, g.from, g.to);
        before = g;
    }
}

/* Without its elements. */
enum { NANOMETRES = 100 }; /* no lens has so many wavelengths: a slip of the unit */

static lens lens_chosen(sgt_lens *of, lens_wavelength at)
{
    lens l = {.of = of, .name = of->name, .units = of->units, .count = of->count, .surface = of->surface};
    if (at.place > of->wavelengths) {
        const char *slip = "";
        if (at.place >= NANOMETRES)
            slip = memory_print("; for %zu nanometres write micrometres, with a point: %.4f", at.place,
                                (double)at.place / 1000);
        fail_usage("--wavelength %zu: %s has %zu wavelength%s%s", at.place, of->file, of->wavelengths,
                   of->wavelengths == 1 ? "" : "s", slip);
    }
    l.chosen = at.place || !isnan(at.um) ? at.place : of->primary + 1;
    l.wavelength = at.um;
    for (size_t i = 0; of->wavelength && i < of->wavelengths && !l.chosen; i++)
        if (of->wavelength[i] == at.um) l.chosen = i + 1;
    if (l.chosen) l.wavelength = of->wavelength ? of->wavelength[l.chosen - 1] : (double)NAN;
    l.index = memory_take(l.count, sizeof *l.index);
    return l;
}

static bool lens_fill(lens *l, sgt_error *e)
{
    sgt_element *own = l->chosen == l->of->primary + 1 ? NULL : memory_take(l->count, sizeof *own);
    l->element = own ? own : l->of->element;
    if (!sgt_lens_at(l->of, l->wavelength, own, &l->index_before, e)) return false;
    for (size_t i = 0; i < l->count; i++)
        l->index[i] = l->surface[i].mirror ? (i ? l->index[i - 1] : l->index_before) : l->element[i].index;
    return true;
}

lens lens_at(sgt_lens *of, lens_wavelength at)
{
    lens l = lens_chosen(of, at);
    sgt_error e;
    if (!lens_fill(&l, &e)) lens_refuse(&e);
    note_ranges(&l);
    return l;
}

static bool quiet;

void lens_be_quiet(void) { quiet = true; }

bool lens_quiet(void) { return quiet; }

void lens_note_image(const sgt_lens *of)
{
    static bool told;
    const size_t last = of->count - 1;
    double before = of->index_before > 0 ? of->index_before : 1;
    for (size_t i = 0; i < last; i++)
        if (of->element[i].index > 0) before = of->element[i].index;
    const bool mirror = of->surface[last].mirror;
    const double behind = of->element[last].index;
    if (told || quiet || (!mirror && !(behind > 0 && behind != before))) return;
    told = true;
    note("%s:%zu: the last surface, surfaces[%zu], %s, and is taken for the image.  If the image lies behind "
         "it, end the file with a plane there", of->file, of->surface[last].line, of->count,
         mirror ? "reflects" : "refracts");
}

/* chosen: there is no need to say that there are configurations. */
static void note_remarks(const sgt_lens *l, bool chosen)
{
    size_t left_out = 0;
    for (size_t i = 0; i < l->remarks; i++) {
        const sgt_lens_remark *r = &l->remark[i];
        left_out += r->kind == SGT_REMARK_LEFT_OUT;
        if (chosen && r->kind == SGT_REMARK_NOTE && strcmp(r->key, "configurations") == 0) continue;
        if (!quiet) remark("%s:%zu: %s%s%s", l->file, r->line, r->key, *r->key ? ": " : "", r->words);
    }
    if (strict && left_out)
        fail_input("%s: %zu thing%s left out, and --strict was given", l->file, left_out,
                   left_out == 1 ? " was" : "s were");
}

static sgt_lens *read_lens(const char *path, int number)
{
    sgt_lens_options o = lens_options();
    sgt_error e;
    o.configuration = number;
    sgt_lens *of;
    if (strcmp(path, "-") == 0) {
        input in = input_read(path);
        of = sgt_lens_read_text(in.name, in.text, in.length, &o, &e);
    } else {
        of = sgt_lens_read(path, &o, &e);
    }
    if (!of) lens_refuse(&e);
    return lens_keep(of);
}

static sgt_lens *configured(sgt_lens *base, size_t number)
{
    sgt_error e;
    sgt_lens *of = sgt_lens_configured(base, number, &e);
    if (!of) lens_refuse(&e);
    return lens_keep(of);
}

static void make_edits(sgt_lens *of)
{
    sgt_error e;
    if (edits && !sgt_lens_edit(of, edits, edit, &e)) lens_refuse(&e);
}

sgt_lens *lens_open(const char *path)
{
    const int number = configuration_number();
    sgt_error e;
    if (all_configurations())
        fail_usage("--configuration all: this command takes one configuration, its number or name");
    sgt_lens *of = read_lens(path, number);
    if (configuration && !number) {
        const size_t place = sgt_lens_configuration_named(of, configuration, &e);
        if (!place) lens_refuse(&e);
        of = configured(of, place);
    }
    make_edits(of);
    note_remarks(of, configuration);
    return of;
}

sgt_lens *lens_open_whole(const char *path)
{
    if (!all_configurations()) return lens_open(path);
    sgt_lens *of = read_lens(path, 0);
    make_edits(of);
    note_remarks(of, true);
    return of;
}

lens_each lens_open_each(const char *path)
{
    lens_each all = {.count = 0};
    if (!all_configurations()) return all;
    sgt_lens *base = read_lens(path, 0);
    all.count = sgt_lens_configurations(base);
    if (!all.count)
        fail_input("%s: configurations: not given, and --configuration all asks for them", base->file);
    all.at = memory_take(all.count, sizeof *all.at), all.name = memory_take(all.count, sizeof *all.name);
    note_remarks(base, true);
    for (size_t i = 0; i < all.count; i++) {
        const char *name = sgt_lens_configuration_name(base, i + 1);
        all.name[i] = memory_text(name, strlen(name));
        all.at[i] = configured(base, i + 1);
        make_edits(all.at[i]);
    }
    return all;
}

const char *lens_each_line(const lens_each *all)
{
    const char *text = "Configurations:";
    for (size_t i = 0; i < all->count; i++)
        text = memory_print("%s%s %zu%s%s", text, i ? "," : "", i + 1, *all->name[i] ? " " : "",
                            all->name[i]);
    return memory_print("%s.", text);
}

void lens_write_check(const char *option, const char *path)
{
    static const char *const others[] = {".zmx", ".seq", ".zos", ".zar", ".len"};
    const size_t length = path ? strlen(path) : 0;
    for (size_t i = 0; i < sizeof others / sizeof *others && length > 4; i++)
        if (strcasecmp(path + length - 4, others[i]) == 0)
            fail_usage("--%s %s: what is written is a lens file, in YAML: end the name in .yaml", option,
                       path);
}

void lens_write(sgt_lens *of, const char *path)
{
    size_t length;
    const char *text = sgt_lens_yaml(of, &length);
    if (!text) fail_input("%s: could not be written as YAML", of->file);
    output_write(path, text, length);
}

lens lens_of_text(const char *name, const char *text)
{
    sgt_lens_options o = lens_options();
    sgt_error e;
    sgt_lens *of = sgt_lens_read_text(name, text, strlen(text), &o, &e);
    if (!of) lens_refuse(&e);
    return lens_at(lens_keep(of), (lens_wavelength){.um = (double)NAN});
}

const char *lens_primary(const sgt_lens *of)
{
    static char text[80];
    if (!of->wavelength || of->wavelengths < 2) return NULL;
    snprintf(text, sizeof text, "Primary wavelength: %.9g, number %zu of the lens.",
             of->wavelength[of->primary], of->primary + 1);
    return text;
}
