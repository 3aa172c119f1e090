// SPDX-License-Identifier: MIT
/* contest.c - every search by every method: who settles, where, and after how many evaluations.
 *
 * The judge is the library's root of the same search.  A method agrees if it settles within the error of that
 * root (explain.c has the same rule).  Searches without a root are no contest and are left out. */
#include "contest.h"

#include "../base/memory.h"
#include "../draw/chart.h"

#include <math.h>

const char *const method_name[METHODS] = {"safeguarded", "newton", "newton-normalised", "bisection", "march"};

unguarded contest_bare(method m, const sgt_search *s, const contest_rules *rules, record *seen)
{
    const sgt_options *asked = rules->solver;
    const sgt_options o = {.max_evals = asked->max_evals ? asked->max_evals : BARE_EVALS,
                           .t_tol = asked->t_tol,
                           .dt_min = asked->dt_min,
                           .watch = record_watch,
                           .watch_data = seen};
    return unguarded_run(method_unguarded(m), s->surface, s->semi_diameter, &s->ray, rules->start, &o);
}

contest contest_run(const sgt_search *s, const record *own, const contest_rules *rules)
{
    contest c = {.s = *s, .seen = {*own}, .end = {{.settled = s->hit->status >= 0, .t = s->hit->t}}};
    for (method m = METHOD_NEWTON; m < METHODS; m++) c.end[m] = contest_bare(m, s, rules, &c.seen[m]);
    return c;
}

void contest_drop(contest *c)
{
    for (method m = METHOD_NEWTON; m < METHODS; m++) memory_drop(c->seen[m].step);
}

void tally_add(tally sum[], const contest *c)
{
    if (c->s.hit->status <= 0) return;
    for (method m = 0; m < METHODS; m++) {
        const record *seen = &c->seen[m];
        const bool own = m == METHOD_SAFEGUARDED;
        bool undefined = false;
        for (size_t i = 0; i < seen->count; i++)
            undefined = undefined || (seen->step[i].kind == SGT_AT_POINT && isnan(seen->step[i].f));
        sum[m].searches++, sum[m].settled += c->end[m].settled, sum[m].undefined += undefined;
        sum[m].agree += c->end[m].settled && explain_agrees(c->end[m].t, &c->s);
        sum[m].evals += seen->count;
        if (seen->count > sum[m].most) sum[m].most = seen->count;
        sum[m].worst = fmax(sum[m].worst, own ? c->s.hit->t_err : fabs(c->end[m].t - c->s.hit->t));
    }
}

/* ------------------------------------------------------------------- shown */

static double mean_evals(const tally *t)
{
    return t->searches ? round(100 * (double)t->evals / (double)t->searches) / 100 : (double)NAN;
}
static double lost_share(const tally *t)
{
    return t->searches ? 100 * (1 - (double)t->agree / (double)t->searches) : (double)NAN;
}
static double passed_share(const tally *t) { return 100 * (double)t->passed / (double)t->rays; }
static double worst_power(const tally *t) { return t->worst > 0 ? log10(t->worst) : (double)NAN; }

static chart_panel tally_panel(const char *axis, const char *title, const char *label,
                               double (*of)(const tally *), size_t methods, size_t fields, const tally sum[])
{
    chart_series *series = memory_take(METHODS, sizeof *series);
    for (size_t m = 0; m < methods; m++) {
        double *x = memory_take(fields, sizeof *x), *y = memory_take(fields, sizeof *y);
        for (size_t i = 0; i < fields; i++)
            x[i] = sum[i * METHODS + m].field, y[i] = of(&sum[i * METHODS + m]);
        series[m] = (chart_series){.name = memory_print("method %s", method_name[m]),
                                   .colour = m,
                                   .mark = (chart_mark)(CHART_PLUS + m),
                                   .dash = (chart_dash)(m % 3),
                                   .line = true,
                                   .count = fields,
                                   .x = x,
                                   .y = y};
    }
    return (chart_panel){
        .title = title, .x_label = axis, .y_label = label, .series_count = methods, .series = series};
}

void tally_show(const table_target *target, const char *title, size_t fields, const tally sum[],
                const char *path, const char *axis)
{
    static const column head[] = {
        {"field", COLUMN_NUMBER}, {"method", COLUMN_WORD},     {"rays", COLUMN_COUNT},
        {"passed", COLUMN_COUNT}, {"searches", COLUMN_COUNT},  {"settled", COLUMN_COUNT},
        {"agree", COLUMN_COUNT},  {"undefined", COLUMN_COUNT}, {"evals", COLUMN_NUMBER},
        {"most", COLUMN_COUNT},   {"worst", COLUMN_ERROR}};
    table *t = table_begin(target, sizeof head / sizeof *head, head);
    for (size_t i = 0; i < fields * METHODS; i++) {
        const tally *s = &sum[i];
        if (i && i % METHODS == 0) table_gap(t);
        if (isnan(s->field))
            table_empty(t);
        else
            table_number(t, s->field);
        table_word(t, method_name[i % METHODS]);
        const size_t counts[] = {s->rays, s->passed, s->searches, s->settled, s->agree, s->undefined};
        for (int k = 0; k < 6; k++) table_count(t, (long long)counts[k]);
        table_number(t, mean_evals(s));
        table_count(t, (long long)s->most);
        table_number(t, s->worst);
    }
    table_line(
        t, "searches: in which the library has met a root.  settled: ended by itself; agree: on that root.\n"
           "undefined: F was NaN on the way.  evals: on average; most: of one search.  worst: how far the\n"
           "last t was from the root; of safeguarded: its bound.");
    table_end(t);
    if (!path) return;
    const chart_panel panel[] = {
        tally_panel(axis, "Evaluations", "evaluations a search", mean_evals, METHODS, fields, sum),
        tally_panel(axis, "Searches that did not end on the root", "of all searches (%)", lost_share, METHODS,
                    fields, sum),
        tally_panel(axis, "The largest error", "log10 |t - root|", worst_power, METHODS, fields, sum),
        tally_panel(axis, "Rays that pass", "of all rays (%)", passed_share, 1, fields, sum)};
    chart_write(path, &(chart){.title = title, .columns = 2, .panels = 4, .panel = panel});
}
