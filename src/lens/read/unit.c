// SPDX-License-Identifier: MIT
/* unit.c - the unit of length of a lens, of which its file has a label. */
#include "phase.h"

#include <sagitta/study.h>

#include <math.h>
#include <string.h>

double sgt_unit_named(const char *label)
{
    static const struct { const char *name; double um; } known[] = {
        {"mm", 1e3}, {"cm", 1e4}, {"m", 1e6}, {"um", 1}, {"\302\265m", 1}, {"in", 25400}, {"inch", 25400},
        {"millimetres", 1e3}, {"millimeters", 1e3}, {"metres", 1e6}, {"meters", 1e6},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(label, known[i].name) == 0) return known[i].um;
    return (double)NAN;
}

double sgt_lens_unit(const sgt_lens *lens) { return sgt_unit_named(lens->units); }
