// SPDX-License-Identifier: MIT
/* words.c - names of fields and wavelengths, and what became of the rays, in words. */
#include "look.h"

#include "../base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *look_fates_line(const look *l, const sgt_fates *f)
{
    const struct { size_t n; const char *word;
    } each[] = {
        {f->passed, "passed"},
        {f->missed, "missed a surface"},
        {f->clipped, "clipped"},
        {f->tir, "totally reflected"},
        {f->evanescent, "evanescent"},
        {f->lost, "lost"},
        {f->none, "not there, as is proven"},
    };
    char text[400];
    int n = snprintf(text, sizeof text, "%zu ray%s:", f->rays, f->rays == 1 ? "" : "s");
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        if (each[i].n)
            n += snprintf(text + n, sizeof text - (size_t)n, "%s %zu %s", text[n - 1] == ':' ? "" : ",",
                          each[i].n, each[i].word);
    if (l->shared.solver.proof)
        n += snprintf(text + n, sizeof text - (size_t)n, "; %zu proven", f->proven);
    if (f->folded) snprintf(text + n, sizeof text - (size_t)n, "; %zu on a fold of the pupil", f->folded);
    return memory_text(text, strlen(text));
}

/* ---------------------------------------------------------- the first lost ray */

static const char *field_option(const sgt_lost_ray *r)
{
    if (r->field) return memory_print(" --fields %zu", r->field);
    if (r->kind == SGT_FIELD_ANGLE && r->at.x == 0) return memory_print(" --field %.17g", r->at.y);
    return memory_print(" --field-at \"%.17g %.17g %s\"", r->at.x, r->at.y, job_field_kind(r->kind));
}

static const char *wavelength_option(const sgt_wavelength *w)
{
    if (w->number) return memory_print(" --wavelength %zu", w->number);
    if (isnan(w->um)) return "";
    const char *um = memory_print("%.17g", w->um);
    return memory_print(" --wavelength %s%s", um, strchr(um, '.') ? "" : ".0");
}

/* The options of sagitta diagnose that show it. */
static const char *lost_options(const look *l)
{
    static const char *const proof[] = {"estimate", "root", "first"};
    const sgt_lost_ray *r = &l->total.lost;
    const sgt_options *s = &l->shared.solver;
    return memory_print("%s%s%s%s --pupil \"%.17g %.17g\"%s%s%s%s%s", field_option(r),
                     r->open && !l->job.no_apertures ? " --no-apertures" : "",
                     r->defocus != 0 || look_given(l, "defocus") ? memory_print(" --defocus %.17g",
                                                                                r->defocus)
                                                                 : "",
                     wavelength_option(&r->wavelength), r->px, r->py, l->job.again ? l->job.again : "",
                     s->proof ? memory_print(" --proof %s", proof[s->proof]) : "",
                     s->pick == SGT_NEAR_SEED ? " --pick near-seed"
                     : s->pick                ? " --pick first"
                                              : "",
                     s->max_evals ? memory_print(" --max-evals %d", s->max_evals) : "",
                     s->dt_min > 0  ? memory_print(" --dt-min %.17g", s->dt_min)
                     : s->t_tol > 0 ? memory_print(" --t-tol %.17g", s->t_tol)
                                    : "");
}

const char *look_field_words(const look *l, size_t number)
{
    const sgt_lens_field *at = &l->fields.at[look_field_of(l, number)];
    if (!l->job.fields) return memory_print("--fields %zu", number);
    if (l->fields.kind == SGT_FIELD_ANGLE && at->x == 0) return memory_print("--field %.17g", at->y);
    return memory_print("--field-at \"%.17g %.17g %s\"", at->x, at->y, job_field_kind(l->fields.kind));
}

void look_verdict(const look *l)
{
    table *t = l->table;
    const char *primary = lens_primary(l->primary.of);
    const sgt_fates *f = &l->total.fates;
    if (primary) table_line(t, "%s", primary);
    table_line(t, "%s.", look_fates_line(l, f));
    if (!f->lost) return;
    if (f->unfound && f->within > 0)
        table_line(t, "%zu lost, as aiming did not find them: none lies within %g pupil radii; beyond that "
                      "there may be some.", f->unfound, f->within);
    else if (f->unfound)
        table_line(t, "%zu lost, as aiming did not find them; there may be some.", f->unfound);
    const char *quote = strpbrk(l->job.lens, " '()&;") ? "\"" : "";
    table_line(t, "What becomes of a lost ray could not be decided.  This shows the first:\n"
                  "    sagitta diagnose %s%s%s%s", quote, l->job.lens, quote, lost_options(l));
}

/* --------------------------------------------------------------- for pictures */

const char *look_title(const look *l, const char *what)
{
    const lens *of = &l->primary;
    const char *file = strrchr(of->of->file, '/');
    return memory_print("%s: %s", *of->name ? of->name : file ? file + 1 : of->of->file, what);
}

size_t look_colour(const look *l, size_t band)
{
    size_t shorter = 0;
    for (size_t b = 0; b < l->bands; b++) {
        const double one = l->band[b].wavelength, own = l->band[band].wavelength;
        shorter += one < own || (one == own && b < band);
    }
    return shorter;
}

const char *look_wavelength_name(const look *l, size_t band)
{
    const double um = l->band[band].wavelength;
    return isnan(um) ? NULL : memory_print("%.6g \302\265m", um);
}

const char *look_lens_line(const look *l)
{
    char text[400] = "";
    size_t n = 0;
    for (size_t i = 0; i < l->bands && n < sizeof text - 40 && !isnan(l->band[i].wavelength); i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%.6g", i ? ", " : "", l->band[i].wavelength);
    const char *units = l->primary.units;
    if (strcmp(units, "in") == 0) units = "inches";
    return memory_print("%s%slengths in %s%s%s", text, n ? " \302\265m; " : "",
                     *units ? units : "the unit of the lens", l->shared.weights ? "; each ray alike" : "",
                     l->shared.solver.proof == SGT_PROVE_FIRST  ? "; every hit proven to be the first"
                     : l->shared.solver.proof == SGT_PROVE_ROOT ? "; every root proven"
                                                                : "");
}

const char *look_signed(double x) { return memory_print("%s%g", x < 0 ? "\342\210\222" : "", fabs(x)); }

const char *look_field_name(const look *l, size_t field)
{
    const sgt_lens_field *at = &l->fields.at[field];
    const char *units = l->primary.units;
    const char *unit = l->fields.kind == SGT_FIELD_ANGLE ? "\302\260" : *units ? memory_print(" %s",
                                                                                              units) : "";
    const size_t number = l->fields.number[field] + 1;
    return at->x == 0 ? memory_print("field %zu: %s%s", number, look_signed(at->y), unit)
                      : memory_print("field %zu: %s, %s%s", number, look_signed(at->x), look_signed(at->y),
                                  unit);
}

const char *look_field_axis(const look *l)
{
    const char *units = l->primary.units;
    const char *what = l->fields.kind == SGT_FIELD_ANGLE           ? "field angle"
                       : l->fields.kind == SGT_FIELD_OBJECT_HEIGHT ? "object height"
                                                                   : "image height";
    return memory_print("%s (%s)", what,
                     l->fields.kind == SGT_FIELD_ANGLE ? "degrees"
                     : *units                          ? units
                                                       : "length");
}

const char *look_unit(const look *l, const char *name)
{
    char shown[32], unit[32];
    const size_t i = look_column(l, name);
    if (i == l->of->columns || !sgt_study_column(l->study, l->of, l->options, i, shown, unit)) return "";
    if (strcmp(unit, "um") == 0) return "\302\265m";
    const bool none = sgt_analysis_column(l->of, i)->dimension == SGT_UNIT_NONE;
    return memory_print("%s", *unit ? unit : none ? "" : "units of the lens");
}

const char *look_label(const look *l, const char *name)
{
    const char *unit = look_unit(l, name);
    return *unit ? memory_print("%s (%s)", name, unit) : name;
}
