// SPDX-License-Identifier: MIT
/* failed.c - why a ray ended at an element of a lens, in the words of its designer.
 *
 * What became of the ray is compared with what would have let it through: the radius with the aperture's,
 * the incidence with the critical angle, the place of its line with that of the surface.
 *
 * A LOST RAY was not decided.  What could decide it is not argued but tried: the ray is traced again with one
 * option changed, and the options that decide it are named. */
#include "failed.h"

#include "explain.h"
#include "../base/memory.h"
#include "../show/frame.h"

#include <sagitta/study.h>

#include <math.h>

/* "Element 2 (sphere, stop, rear of the field lens)" */
static const char *element_name(const lens *l, size_t at)
{
    const sgt_lens_surface *s = &l->surface[at];
    bool stop = l->of->stop_marked && l->of->stop == at;
    return memory_print("Element %zu (%s%s%s%.60s)", at + 1, s->type, stop ? ", stop" : "",
                        *s->name ? ", " : "", s->name);
}

/* A circle says by how much; other shapes have said it. */
static void explain_clipped(table *t, const failed *f)
{
    sgt_clipping by = sgt_clipped_by(&f->element[f->at], f->come.p);
    if (!(by.limit > 0)) return;
    double beyond = by.size - by.limit;
    table_line(t, "It is %.6g too far %s, %.3g %% of that radius.  --no-apertures would let it go on.",
               fabs(beyond), beyond > 0 ? "out" : "in", fabs(beyond) / by.limit * 100);
}

static void explain_tir(table *t, const failed *f)
{
    double critical = sgt_critical_angle(&f->come);
    table_line(t, "That is %.4g degrees beyond it.  The index is %.9g in front and %.9g behind.",
               sgt_incidence(&f->element[f->at], &f->come) - critical, f->come.index, f->come.behind);
}

static void explain_evanescent(table *t, const failed *f)
{
    const sgt_element *e = &f->element[f->at];
    const double wave = f->lens->wavelength / sgt_lens_unit(f->lens->of);
    sgt_hit hit = {.p = f->come.p};
    e->surface.ops->value(e->surface.self, f->come.p, &hit.n);
    const sgt_phased p = sgt_phase_at(e, f->come.index, f->come.direction, &hit);
    const double low = ceil(p.per_wave.lo / wave) + 0, high = floor(p.per_wave.hi / wave);
    if (low > high) table_line(t, "There is no order that passes.");
    else if (isfinite(low) && isfinite(high))
        table_line(t, "Of the orders, %g to %g pass; it is %g.", low, high, e->phase->per_wave / wave);
}

/* 0 for what is only the rounding of a length r. */
static double tidy(double x, double r) { return fabs(x) < 1e-12 * r ? 0 : x; }

/* Does the surface end at p, to within rounding? */
static bool is_edge(sgt_surface s, sgt_vec3 p)
{
    const double outward = 1 + 1e-9;
    return isnan(s.ops->value(s.self, (sgt_vec3){p.x * outward, p.y * outward, p.z}, NULL));
}

static void explain_missed(table *t, const failed *f)
{
    const sgt_surface s = f->search->surface;
    const sgt_nearest n = sgt_nearest_of(s, &f->search->ray);
    explain_miss(t, f->number, s, &f->search->ray);
    if (!n.known) return;
    double r = hypot(n.p.x, n.p.y), scale = r + n.distance, rim = f->search->semi_diameter;
    const char *where = is_edge(s, n.p)         ? ", its edge"
                        : rim > 0 && r > rim ? ", beyond its semi_diameter"
                                             : "";
    table_line(t, "Nearest approach: %.6g, at t = %.6g.  The surface is there at %.6g, %.6g, %.6g",
               n.distance, tidy(n.t, scale), tidy(n.p.x, scale), tidy(n.p.y, scale), tidy(n.p.z, scale));
    table_line(t, "(r = %.6g%s).  Estimated: the line was moved parallel to itself until it met.",
               tidy(r, scale), where);
}

/* ---------------------------------------------------------------- a lost ray */

typedef struct attempts {
    table *table;
    const failed *of;
    bool any;              /* has decided the ray */
    const char *in_vain;   /* the others */
} attempts;

/* Traces the ray to the element with other options. */
static void attempt(attempts *a, const sgt_options *with, const char *option)
{
    const failed *f = a->of;
    sgt_ray ray = *f->launch;
    sgt_fate fate;
    size_t passed = sgt_trace(f->at + 1, f->element, f->lens->index_before, &ray, NULL, &fate, with);
    if (passed >= f->at && fate >= 0) {
        table_line(a->table, "With %s it is decided: %s.", option, sgt_fate_text(fate));
        a->any = true;
        return;
    }
    a->in_vain = memory_print("%s%s%s", a->in_vain, *a->in_vain ? ", " : "", option);
}

/* Those options that may decide a ray, one at a time. */
static void attempt_all(attempts *a, const sgt_search *s)
{
    enum { MORE = 100, DEFAULT = 2000 /* sagitta.h */, MOST = 1000000000 };
    const sgt_options asked = *s->options;
    const int evals = asked.max_evals ? asked.max_evals : DEFAULT;
    sgt_options with = asked;
    with.max_evals = evals < MOST / MORE ? MORE * evals : MOST;
    attempt(a, &with, memory_print("--max-evals %d", with.max_evals));
    with = asked, with.proof = SGT_PROVE_ROOT;
    if (asked.proof == SGT_PROVE_FIRST) attempt(a, &with, "--proof root");
    with.proof = SGT_ESTIMATE;
    if (asked.proof) attempt(a, &with, "--proof estimate");
    with = asked, with.t_tol = 0;
    if (asked.t_tol > 0) attempt(a, &with, "the default of --t-tol");
    with = asked, with.dt_min = 0;
    if (s->fast) attempt(a, &with, "no --dt-min");
    with = asked, with.pick = s->near_seed ? SGT_FIRST : SGT_NEAR_SEED;
    attempt(a, &with, s->near_seed ? "--pick first" : "--pick near-seed");
}

static void explain_lost(table *t, const failed *f, const char *name)
{
    attempts a = {.table = t, .of = f, .in_vain = ""};
    options_say_undecided(t, memory_print("\n%s: lost, ", name), f->search);
    if (f->search->hit->status == SGT_INVALID) return;
    attempt_all(&a, f->search);
    if (!a.any) table_line(t, "Tried in vain: %s.", a.in_vain);
}

void failed_explain(table *t, const failed *f)
{
    const char *name = element_name(f->lens, f->at);
    if (f->fate == SGT_LOST) {
        explain_lost(t, f, name);
        return;
    }
    char why[WHY_SIZE];
    sgt_why_ended(&f->element[f->at], f->fate, &f->come, sizeof why, why);
    table_line(t, "\n%s: %s%s", name, *why ? why : sgt_fate_text(f->fate), *why ? "." : "");
    if (f->fate == SGT_CLIPPED) explain_clipped(t, f);
    if (f->fate == SGT_TIR) explain_tir(t, f);
    if (f->fate == SGT_EVANESCENT) explain_evanescent(t, f);
    if (f->fate == SGT_MISSED) explain_missed(t, f);
}
