// SPDX-License-Identifier: MIT
/* help.c - the columns of an analysis for --help all, from the tables of the library. */
#include "look.h"
#include "../base/memory.h"

#include "../base/bytes.h"

#include <stdio.h>
#include <string.h>

/* What of an afocal lens the names of some columns end in. */
static void print_afocal(const sgt_analysis *a, sgt_dimension of, const char *end, const char *what)
{
    bytes names = {.length = 0};
    for (size_t i = 0; i < a->columns; i++)
        if (sgt_analysis_column(a, i)->dimension == of)
            bytes_text(&names,
                       memory_print("%s%s", names.length ? ", " : "", sgt_analysis_column(a, i)->name));
    if (!names.length) return;
    bytes_one(&names, 0);
    command_print_item(memory_print("..._%s", end),
             memory_print("in place of %s, if the lens is afocal: %s", names.at, what));
}

static void print_columns(const sgt_analysis *a)
{
    for (size_t i = 0; i < a->columns; i++) {
        const sgt_column *c = sgt_analysis_column(a, i);
        const char *when = c->flags & SGT_COLUMN_PROVEN   ? "with --proof"
                           : c->flags & SGT_COLUMN_GIVEN  ? "if it is given"
                           : c->flags & SGT_COLUMN_DETAIL ? "not in text"
                                                          : "";
        command_print_item(c->name, *when ? memory_print("%s (%s)", c->help, when) : c->help);
    }
    print_afocal(a, SGT_UNIT_IMAGE, "mrad", "angles in milliradians");
    print_afocal(a, SGT_UNIT_FOCUS, "dioptre", "vergences in 1/m");
}

const char *look_default_rays(const sgt_analysis *a)
{
    static const char *const name[] = {
        [SGT_PATTERN_FAN] = "fan", [SGT_PATTERN_GRID] = "grid", [SGT_PATTERN_HEXAPOLAR] = "hexapolar",
        [SGT_PATTERN_RANDOM] = "random", [SGT_PATTERN_SOBOL] = "sobol", [SGT_PATTERN_CELLS] = "cells",
        [SGT_PATTERN_CROSS] = "cross"};
    return memory_print("--%s %zu", name[a->pattern], a->rays);
}

const char *look_column_words(const void *context)
{
    const look_help *h = context;
    const char *text = "";
    const sgt_analysis *of = h->of;
    const look_view *v = h->view;
    for (; of; of = v && v->option ? sgt_analysis_named((v++)->analysis) : NULL)
        for (size_t i = 0; i < of->columns; i++) {
            const char *name = sgt_analysis_column(of, i)->name;
            if (!strstr(memory_print(" %s ", text), memory_print(" %s ", name)))
                text = memory_print("%s%s%s", text, *text ? " " : "", name);
        }
    return text;
}

void look_print_columns(const void *context)
{
    const look_help *h = context;
    puts("Columns (lengths in the unit of the lens)");
    print_columns(h->of);
    for (const look_view *v = h->view; v && v->option; v++) {
        printf("\nColumns with --%s\n", v->option);
        print_columns(sgt_analysis_named(v->analysis));
    }
}
