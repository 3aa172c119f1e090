/* help.c - the help of an analysis, from the tables of the library. */
#include "look.h"

#include "../base/bytes.h"

#include <stdio.h>

enum { LEFT = 21, RIGHT = 104 };

/* Appends words, broken at blanks, from the column `from` on; a line feed begins a new line. */
static void put_wrapped(bytes *to, const char *words, size_t from)
{
    size_t at = from;
    for (const char *word = words; *word;) {
        const size_t length = strcspn(word, " \n"), blanks = strspn(word + length, " ");
        if (at + length > RIGHT && at > from) {
            bytes_one(to, '\n');
            for (size_t i = 0; i < from; i++) bytes_one(to, ' ');
            at = from;
        }
        bytes_put(to, word, length);
        at += length;
        word += length;
        if (*word == '\n') bytes_one(to, '\n'), at = from, word++;
        else if (blanks && word[blanks]) {
            const bool fits = at + blanks + strcspn(word + blanks, " \n") <= RIGHT;
            for (size_t i = 0; i < blanks && fits; i++) bytes_one(to, ' ');
            at = fits ? at + blanks : RIGHT + 1, word += blanks;
        } else word += blanks;
    }
    bytes_one(to, '\n');
}

static void put_item(bytes *to, const char *name, const char *help)
{
    char head[80];
    const int n = snprintf(head, sizeof head, "  %-*s", LEFT - 2, name);
    bytes_put(to, head, (size_t)n);
    if (n > LEFT) {
        bytes_one(to, '\n');
        for (int i = 0; i < LEFT; i++) bytes_one(to, ' ');
    }
    put_wrapped(to, help, LEFT);
}

/* What of an afocal lens the names of some columns end in. */
static void put_afocal(bytes *to, const sgt_analysis *a, sgt_dimension of, const char *end, const char *what)
{
    bytes names = {.length = 0};
    for (size_t i = 0; i < a->columns; i++)
        if (a->column[i].dimension == of)
            bytes_text(&names, look_text("%s%s", names.length ? ", " : "", a->column[i].name));
    if (!names.length) return;
    bytes_one(&names, 0);
    put_item(to, look_text("..._%s", end),
             look_text("in place of %s, if the lens is afocal: %s", names.at, what));
}

static void put_columns(bytes *to, const sgt_analysis *a)
{
    for (size_t i = 0; i < a->columns; i++) {
        const sgt_column *c = &a->column[i];
        const char *when = c->flags & SGT_COLUMN_PROVEN   ? "with --proof"
                           : c->flags & SGT_COLUMN_GIVEN  ? "if it is given"
                           : c->flags & SGT_COLUMN_DETAIL ? "not in text"
                                                          : "";
        put_item(to, c->name, *when ? look_text("%s (%s)", c->help, when) : c->help);
    }
    put_afocal(to, a, SGT_UNIT_IMAGE, "mrad", "angles in milliradians");
    put_afocal(to, a, SGT_UNIT_FOCUS, "dioptre", "vergences in 1/m");
}

/* Those that `main` does not have, and not the one that is the argument of a view. */
static void put_settings(bytes *to, const sgt_analysis *a, const sgt_analysis *main, const char *argument)
{
    for (size_t i = 0; i < a->settings; i++) {
        const sgt_setting *s = &a->setting[i];
        bool known = argument && strcmp(s->name, argument) == 0;
        for (size_t k = 0; k < main->settings && a != main; k++)
            known = known || strcmp(main->setting[k].name, s->name) == 0;
        static const char *const value[] = {[SGT_SETTING_FLAG] = "", [SGT_SETTING_COUNT] = " N",
                                            [SGT_SETTING_WORD] = " WORD", [SGT_SETTING_NUMBER] = " X",
                                            [SGT_SETTING_NUMBERS] = " X,X..."};
        if (!known) put_item(to, look_text("--%s%s", s->name, value[s->kind]), s->help);
    }
}

const char *look_default_rays(const sgt_analysis *a)
{
    static const char *const name[] = {
        [SGT_PATTERN_FAN] = "fan", [SGT_PATTERN_GRID] = "grid", [SGT_PATTERN_HEXAPOLAR] = "hexapolar",
        [SGT_PATTERN_RANDOM] = "random", [SGT_PATTERN_SOBOL] = "sobol", [SGT_PATTERN_CELLS] = "cells",
        [SGT_PATTERN_CROSS] = "cross"};
    return look_text("--%s %zu", name[a->pattern], a->rays);
}

const char *look_help(const look *l, const look_way *way)
{
    const sgt_analysis *a = l->of;
    bytes all = {.length = 0};
    bytes_text(&all, look_text("sagitta %s LENS [options]\n\n", a->name));
    put_wrapped(&all, a->help, 0);
    bytes_text(&all, "\nColumns (lengths in the unit of the lens)\n");
    put_columns(&all, a);
    for (const look_view *v = way->view; v && v->option; v++) {
        const sgt_analysis *of = sgt_analysis_named(v->analysis);
        bytes_text(&all, look_text("\nColumns with --%s\n", v->option));
        put_columns(&all, of);
    }
    bytes_text(&all, "\nOptions\n");
    put_settings(&all, a, a, NULL);
    for (const look_view *v = way->view; v && v->option; v++) {
        put_item(&all, look_text("--%s%s", v->option, v->setting ? " N" : ""), v->help);
        put_settings(&all, sgt_analysis_named(v->analysis), a, v->setting);
    }
    if (way->own) put_item(&all, look_text("--%s WORD", way->own), way->own_help);
    put_item(&all, "--picture FILE", "draws it: svg, png or pdf, by the ending of the name");
    if (!a->no_rays)
        put_item(&all, "--proof P", "estimate, root or first: what must be proven of each hit (sagitta trace "
                                    "--help); a ray for which it is not is lost");
    if (!a->no_fields) bytes_text(&all, job_fields_help);
    if (!a->no_rays) {
        bytes_text(&all, job_patterns_help);
        const char *rays = look_default_rays(a);
        for (const look_view *v = way->view; v && v->option; v++)
            rays = look_text("%s; with --%s %s", rays, v->option,
                             look_default_rays(sgt_analysis_named(v->analysis)));
        put_item(&all, "none of these", rays);
    }
    bytes_text(&all, job_aim_help);
    bytes_text(&all, job_wavelength_help);
    put_item(&all, "", a->primary_alone ? "Default: its primary one" : "Default: all");
    bytes_text(&all, job_lens_help);
    bytes_text(&all, options_threads_help);
    bytes_text(&all, options_rows_help);
    bytes_one(&all, 0);
    return all.at;
}
