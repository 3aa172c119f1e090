// SPDX-License-Identifier: MIT
/* diagnose.c - sagitta diagnose: the solver watched, evaluation by evaluation.
 *
 * A function of x, or one surface and one ray, or one ray through a lens.  A function is the surface F = 0
 * met by the x axis, so that t is x; its own search is the library's Newton in a bracket, which takes a
 * start. Through a lens the library takes the ray from element to element.  A bare method replaces only the
 * search that is shown, so every method sees the same ray at each element.
 *
 * WHAT IS SHOWN of a lens, as text: the element where the ray ended, if it did; of a ray that passed, a row
 * for each element.  Which one to look at is the question there.  csv and json have every evaluation. */
#include "commands.h"
#include "contest.h"
#include "failed.h"
#include "passed.h"
#include "watched.h"
#include "../job/job.h"
#include "../base/memory.h"
#include "../../text/number.h"
#include "../base/input.h"
#include "../draw/chart.h"
#include "../read/surface.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <sagitta/formula.h>
#include <stdio.h>
#include <string.h>

/* At the end, for people: what has a unit. */
static const char legend_of_surface[] =
    "t, lo, hi: in lengths of the ray's direction.  f: F at t.  slope: the derivative of f by t.";
static const char legend_of_function[] =
    "t: x.  f: the function there.  slope: its derivative.  lo, hi: the bracket.";
static const char legend_of_lens[] =
    "t, lo, hi: from the element before, or the ray's start.  f: F at t.  slope: the derivative of f by t.";

static const column diagnose_head[] = {
    {"ray", COLUMN_COUNT}, {"element", COLUMN_COUNT}, {"eval", COLUMN_COUNT}, {"move", COLUMN_WORD},
    {"t", COLUMN_EXACT}, {"f", COLUMN_NUMBER}, {"slope", COLUMN_NUMBER},
    {"lo", COLUMN_EXACT}, {"hi", COLUMN_EXACT},
    {"f_lo", COLUMN_NUMBER}, {"f_hi", COLUMN_NUMBER},
    {"slope_lo", COLUMN_NUMBER}, {"slope_hi", COLUMN_NUMBER},
};
enum { HEAD_COUNT = sizeof diagnose_head / sizeof diagnose_head[0], OF_TEXT = HEAD_COUNT - 4 };

/* Text has no bounds: they would make it too wide. */
static table *rows_begin(const table_target *target)
{
    return table_begin(target, target->format == TABLE_TEXT ? OF_TEXT : HEAD_COUNT, diagnose_head);
}

typedef struct diagnose_arguments {
    shared_options shared;
    job_options job;
    const char *surface, *ray, *function, *bracket;
    double start;         /* NaN: not given */
    int element;          /* from 1; 0: not given */
    bool all_elements, method_given, compare;
    int method;           /* a method */
} diagnose_arguments;

static const option_row diagnose_rows[] = {
    {"surface", "SPEC", "one surface, as in sagitta intersect", OPTION_TEXT,
     .to = offsetof(diagnose_arguments, surface)},
    {"ray", "...",
     "with --surface the ray, six numbers in quotes; with LENS its number, from 0\n"
     "Or eight numbers, with tmin tmax at the end.  Of a lens by default the ray that took most\n"
     "evaluations",
     OPTION_TEXT, .to = offsetof(diagnose_arguments, ray)},
    {"function", "F(x)", "in place of a surface: any formula of x, as \"x^3 - x - 1\" (docs/formula.md)",
     OPTION_TEXT, .to = offsetof(diagnose_arguments, function)},
    {"start", "X",
     "where the search begins: x, or with --surface t\n"
     "With --surface only for --method newton and newton-normalised",
     OPTION_REAL, .to = offsetof(diagnose_arguments, start)},
    {"bracket", "\"A B\"", "with --function: the root is searched for between A and B", OPTION_TEXT,
     .to = offsetof(diagnose_arguments, bracket)},
    {"element", "J", "the search at element J of the lens, counted from 1", OPTION_WHOLE,
     .to = offsetof(diagnose_arguments, element), 1, INT_MAX},
    {"all-elements", NULL,
     "the search at each element that the ray reached\n"
     "csv and json have it anyway",
     OPTION_FLAG, .to = offsetof(diagnose_arguments, all_elements)},
    {"method", "M",
     "which search: safeguarded, newton, newton-normalised, bisection or march\n"
     "safeguarded (the default): what the library does; newton: Newton's steps alone, t is\n"
     "halved where F is NaN; newton-normalised: the same with the gradient scaled to length\n"
     "1, a common mistake; bisection: halves the span, or the bracket; march: steps, each the\n"
     "greatest of an estimate of the distance, Newton's step and --dt-min, and when F has\n"
     "changed sign halving down to --t-tol.  Of a ray that passed a lens, at each element.\n"
     "Newton's starts where the ray crosses the vertex plane (on a surface without one: in\n"
     "the middle of the span).  All but the first stop after --max-evals (default 100)",
     OPTION_WORD, .to = offsetof(diagnose_arguments, method), .least = METHOD_SAFEGUARDED + 1,
     .words = "safeguarded newton newton-normalised bisection march"},
    {"compare", NULL,
     "every method in each search of all rays: a row for each field and method\n"
     "How many settled, on the library's root, after how many evaluations, how far off",
     OPTION_FLAG, .to = offsetof(diagnose_arguments, compare)},
    {"picture", "FILE",
     "draw the search (of a lens: give --element); with --compare of a lens, methods by field\n"
     "svg, png or pdf, by the ending of the name",
     OPTION_TEXT, .to = offsetof(diagnose_arguments, shared.picture)},
    {0},
};
static const option_row diagnose_defocus_rows[] = {
    {"defocus", "Z", "with LENS: moves the last element by Z along its own z, as in sagitta spot",
     OPTION_REAL,
     .to = offsetof(job_options, defocus)},
    {0},
};
static const option_row diagnose_search_rows[] = {
    PICK_OPTION("the root that the library looks for: first or near-seed"),
    PROOF_OPTION("what the library must prove: estimate (the default), root or first\n"
                 "As in sagitta intersect and sagitta trace"),
    {0},
};
static const option_group diagnose_own = {OPTIONS_OWN, "Options", .row = diagnose_rows},
                          diagnose_defocus = {OPTIONS_OF_JOB, NULL, .row = diagnose_defocus_rows},
                          diagnose_search = {OPTIONS_SHARED, "The search", .row = diagnose_search_rows};

static exit_status diagnose_run(const command *c, int argc, char *argv[]);

static const char diagnose_all[] =
    "Columns\n"
    "  ray, element       the ray, counted from 0; the element, counted from 1\n"
    "  eval               the evaluation, counted from 1\n"
    "  move               how its t was chosen: seed, newton, bisect, march, retreat (F was NaN), or\n"
    "                     probe (beside a root)\n"
    "  t                  place on the ray, in lengths of its direction; through a lens: the length along\n"
    "                     the ray from the element before, or from its start at element 1\n"
    "  f, slope           F there, and its derivative by t; none (nan) if the row is over a cell\n"
    "  lo, hi             the bracket that holds the root, where there is one (like t); or the cell,\n"
    "                     and t is its middle\n"
    "  f_lo, f_hi         (csv, json) bounds of F all over the cell; at a point both are f\n"
    "  slope_lo, slope_hi (csv, json) the same of the slope\n"
    "\n"
    "Columns of --compare\n"
    "  field, method      the angle or height of the field; the method\n"
    "  rays, passed       how many rays, and how many of them pass the lens\n"
    "  searches           at elements where the library has met a root\n"
    "  settled, agree     how many ended by themselves, and on that root\n"
    "  undefined          in how many F was NaN on the way\n"
    "  evals, most        evaluations, on average and of one search\n"
    "  worst              the largest distance of a last t from the root; of safeguarded: its bound\n";

const command command_diagnose = {
    .name = "diagnose",
    .usage = "(LENS | --surface SPEC --ray \"ox oy oz dx dy dz\" | --function F) [options]",
    .brief = "one ray, evaluation by evaluation",
    .what = "Shows how the root of one ray, or of a function, is found: a row for each evaluation of F (the "
            "surface is where F = 0), and then what to conclude.  Of a lens: why the ray ended, and the "
            "search at the element where it did. Of a ray that passed: a row for each element.  Of a ray "
            "that aiming did not find: how near the search came, and what stopped the rays that would be "
            "nearer.",
    .often = "surface ray function start bracket element method compare picture field fan format",
    .rays = "--fan 5",
    .examples = "  sagitta diagnose --surface '{type: sphere, radius: 20}' --ray '0 3 -5 0 0 1'\n"
                "  sagitta diagnose examples/lenses/double_gauss.yaml --field 14 --ray 4\n"
                "  sagitta diagnose --function 'x^3 - x - 1' --start 0 --bracket '-2 3'\n",
    .docs = "docs/newton.md, docs/tour.md",
    .all = diagnose_all,
    .group = {&diagnose_own, &diagnose_defocus, JOB_GROUPS, &diagnose_search, &options_solver,
              &options_output},
    .run = diagnose_run,
};

static void refuse_mixed(const diagnose_arguments *a, unsigned given)
{
    const bool alone = a->surface || a->function;
    if ((a->function != NULL) + (a->surface != NULL) + (a->job.lens != NULL) != 1)
        fail_usage(alone ? "give one of --function, --surface and a lens file; put each in quotes"
                         : "give --function F, --surface SPEC or a lens file");
    if (a->surface && !a->ray) fail_usage("--ray is missing; for example --ray \"ox oy oz dx dy dz\"");
    if (a->function && a->ray) fail_usage("--ray goes with --surface or a lens file, not with --function");
    if (a->bracket && !a->function)
        fail_usage("--bracket goes with --function; a ray has its tmin and tmax for that");
    if (a->function && a->method_given && a->method >= METHOD_BISECTION && !a->bracket)
        fail_usage("--method bisection and march need --bracket \"A B\"");
    if (a->function && isnan(a->start) && !a->bracket)
        fail_usage("give --start X, --bracket \"A B\", or both, with --function");
    if (a->function && a->shared.solver.proof)
        fail_usage("--proof is of rays; it does not go with --function");
    const bool bare_newton = a->method == METHOD_NEWTON || a->method == METHOD_NORMALISED || a->compare;
    if (!isnan(a->start) && !a->function && !(a->surface && bare_newton))
        fail_usage(
            "--start goes with --function, or with --surface and --method newton or newton-normalised");
    if (alone && (given & (1u << OPTIONS_OF_JOB | 1u << OPTIONS_OF_RAYS) || a->element || a->all_elements))
        fail_usage("--field, --fan, --grid, --rays, --skip-bad, --wavelength, --glass, --no-apertures, "
                   "--element and --all-elements go with a lens file, not with --%s",
                   a->surface ? "surface" : "function");
    if (a->element && a->all_elements) fail_usage("give --element or --all-elements, not both");
    if (a->compare && a->method_given) fail_usage("--compare shows every method: leave --method out");
    if (!a->shared.picture) return;
    chart_check("picture", a->shared.picture);
    if (!alone && !a->element && !a->compare) fail_usage("--picture: say of which search, by --element J");
    if (a->shared.target.path) output_check("output", a->shared.target.path);
    output_reserve("picture", a->shared.picture);
}

static diagnose_arguments diagnose_arguments_of(const command *c, int argc, char *argv[])
{
    diagnose_arguments a = {.start = (double)NAN};
    const unsigned given = command_read(c, &a, &a.job, &a.shared, argc, argv);
    a.method_given = a.method > 0;
    if (a.method_given) a.method--;
    if (optind + 1 < argc)
        fail_usage("unexpected argument \"%s\"; diagnose takes one lens file", argv[optind + 1]);
    if (optind < argc) a.job.lens = argv[optind];
    refuse_mixed(&a, given);
    return a;
}

/* --------------------------------------------------------------- one search */

static void diagnose_write_rows(table *t, bool text, size_t ray, size_t element, const record *r)
{
    for (size_t i = 0; i < r->count; i++) {
        const sgt_step *s = &r->step[i];
        table_count(t, (long long)ray);
        table_count(t, (long long)element + 1);
        table_count(t, (long long)i + 1); /* s->eval begins anew where the library searches twice */
        table_word(t, sgt_move_text(s->move));
        const double numbers[] = {s->t,    s->f,    s->slope,    s->lo,      s->hi,
                                  s->f_lo, s->f_hi, s->slope_lo, s->slope_hi};
        for (int k = 0; k < (text ? 5 : 9); k++)
            if (text && k > 0 && k < 3 && s->kind == SGT_OVER_CELL) table_empty(t);
            else table_number(t, numbers[k]);
    }
}

static contest_rules rules_of(const diagnose_arguments *a)
{
    return (contest_rules){a->start, &a->shared.solver};
}

/* Shows a search and what to conclude; told: why it is undecided has been said.  Returns whether it is
 * decided. */
static bool show(table *t, const diagnose_arguments *a, const char *title, size_t number, size_t element,
                 const record *seen, const sgt_search *s, bool told)
{
    const contest_rules rules = rules_of(a);
    sgt_search asked = *s;
    asked.options = &a->shared.solver; /* with the t_tol of the method that is shown */
    if (a->shared.picture) {
        const contest all = contest_run(&asked, seen, &rules);
        contest_draw(a->shared.picture, title, &all, (method)a->method, a->function != NULL);
    }
    if (a->method == METHOD_SAFEGUARDED) {
        diagnose_write_rows(t, a->shared.target.format == TABLE_TEXT, number, element, seen);
        explain_safeguarded(t, seen, s, told);
        return s->hit->status >= 0;
    }
    record bare = {.count = 0};
    const unguarded end = contest_bare((method)a->method, &asked, &rules, &bare);
    diagnose_write_rows(t, a->shared.target.format == TABLE_TEXT, number, element, &bare);
    explain_bare(t, (method)a->method, &bare, &end, &asked);
    return end.settled;
}

/* The options of the library's own search.  --max-evals, --dt-min and --t-tol are of the method
 * that is shown. */
static sgt_options own_options(const diagnose_arguments *a)
{
    sgt_options o = a->shared.solver;
    if (a->method != METHOD_SAFEGUARDED || a->compare) o.max_evals = 0, o.dt_min = o.t_tol = 0;
    return o;
}

/* A function of x is the surface F = 0 met by the x axis. */
static sgt_surface function_read(const char *text)
{
    sgt_formula *f = memory_take(1, sizeof *f);
    const size_t size = sgt_formula_room(text, 0);
    sgt_error e = {0};
    for (const char *c = text; *c;) {
        size_t n = 0;
        while (isalnum((unsigned char)c[n]) || c[n] == '_' || c[n] == '.') n++;
        if (n == 1 && strchr("yzr", *c)) fail_usage("--function: its variable is x, not %c", *c);
        c += n ? n : 1;
    }
    f->tape = sgt_formula_read(text, SGT_FORMULA_XYZ, 0, NULL, memory_take(size + 1, 1), size, &e);
    char *names = strstr(e.words, "; there are x, y, z, r, pi");
    if (names) *names = 0;
    if (!f->tape)
        fail_input("--function: column %zu: %s%s", e.column, e.words, names ? "; the variable is x" : "");
    return (sgt_surface){&sgt_formula_ops, f};
}

static sgt_ray bracket_read(const char *text)
{
    sgt_ray ray = {.d = {1, 0, 0}, .tmin = -HUGE_VAL, .tmax = HUGE_VAL};
    if (!text) return ray;
    char *rest, *copy = memory_text(text, strlen(text));
    const char *lo = strtok_r(copy, " ,", &rest), *hi = strtok_r(NULL, " ,", &rest);
    if (!lo || !hi || strtok_r(NULL, " ,", &rest))
        fail_usage("--bracket must be two numbers in quotes, as in \"-2 3\", not \"%s\"", text);
    ray.tmin = options_number("bracket", lo), ray.tmax = options_number("bracket", hi);
    if (!(ray.tmin < ray.tmax)) fail_usage("--bracket: %s is not below %s", lo, hi);
    return ray;
}

/* One search without a lens.  Returns whether it is decided. */
static bool diagnose_alone(const diagnose_arguments *a)
{
    record seen = {.count = 0};
    sgt_options o = own_options(a);
    o.watch = record_watch, o.watch_data = &seen;
    sgt_ray ray;
    sgt_surface surface;
    sgt_hit hit;
    if (a->function) {
        explain_a_function();
        surface = function_read(a->function), ray = bracket_read(a->bracket);
        if (!(isnan(a->start) || (a->start >= ray.tmin && a->start <= ray.tmax)))
            fail_usage("--start %g is not within --bracket", a->start);
        hit = in_bracket(surface, &ray, a->start, &o);
        const sgt_hit proven = hit.status < 0 ? sgt_intersect(surface, ray, NULL) : hit;
        if (proven.status == SGT_MISS) hit.status = SGT_MISS;
    } else {
        ray_list rays = {.count = 0};
        rays_parse(&rays, a->ray);
        ray = rays.ray[0].ray, surface = surface_parse("--surface", a->surface);
        shared_options asked = a->shared;
        if (a->method == METHOD_MARCH || a->compare) asked.solver.dt_min = 0; /* is read */
        options_note_unread(&asked, 1, &(sgt_element){.surface = surface});
        hit = sgt_intersect(surface, ray, &o);
    }
    ray.tmax = ray_end(&ray);
    const char *title = a->function ? a->function : memory_print("%s, ray %s", a->surface, a->ray);
    const sgt_element alone = {.surface = surface};
    const sgt_search made = options_search(&a->shared, &alone, SGT_FIRST, ray, &hit);
    if (a->compare) {
        const contest_rules rules = rules_of(a);
        const contest all = contest_run(&made, &seen, &rules);
        tally sum[METHODS] = {{0}};
        for (int m = 0; m < METHODS; m++)
            sum[m] = (tally){.field = (double)NAN, .rays = 1, .passed = hit.status > 0};
        tally_add(sum, &all);
        if (a->shared.picture)
            contest_draw(a->shared.picture, title, &all, METHOD_SAFEGUARDED, a->function != NULL);
        tally_show(&a->shared.target, title, 1, sum, NULL, NULL);
        return hit.status >= 0;
    }
    table *t = rows_begin(&a->shared.target);
    const bool decided = show(t, a, title, 0, 0, &seen, &made, false);
    if (hit.status == SGT_MISS && a->function)
        table_line(t, "So F has no root in the bracket.  Bounds on F over whole pieces of it say so, not the "
                      "rows above.");
    else if (hit.status == SGT_MISS)
        explain_miss(t, 0, surface, &ray);
    table_line(t, "\n%s", a->function ? legend_of_function : legend_of_surface);
    table_end(t);
    return decided;
}

/* -------------------------------------------------------------------- a lens */

static const char *job_name(const job *j) { return *j->lens.name ? j->lens.name : j->lens.of->file; }

/* How many evaluations a ray takes, at --element or at all; *reached: how many elements it reached. */
static long evaluations(const diagnose_arguments *a, const job *j, const launch *l, sgt_passage passage[],
                        size_t *reached, sgt_fate *fate)
{
    sgt_options o = own_options(a);
    sgt_ray ray = l->ray;
    size_t passed = sgt_trace(j->lens.count, j->element, j->lens.index_before, &ray, passage, fate, &o);
    *reached = passed + (*fate != SGT_PASSED);
    long n = 0;
    for (size_t i = 0; i < *reached; i++)
        if (!a->element || (size_t)a->element == i + 1) n += passage[i].hit.evals;
    return n;
}

/* The ray that is asked for, if aiming has not found it: by its number, or the first if no ray is there. */
static const launch *missing_ray(const diagnose_arguments *a, const job *j)
{
    long number = 0;
    if (!j->how) return NULL;
    const ray_list *missing = &j->how->missing;
    if (!a->ray) return j->rays.count || !missing->count ? NULL : &missing->ray[0];
    if (!number_read_integer(a->ray, 0, LONG_MAX, &number)) return NULL;
    for (size_t i = 0; i < missing->count; i++)
        if (missing->ray[i].number == (size_t)number) return &missing->ray[i];
    return NULL;
}

/* How the search for it ended, in words. */
static void explain_nearest(table *t, const job *j, const sgt_launched *l)
{
    static const char *const stops[] = {[SGT_PASSED] = "passes", [SGT_CLIPPED] = "is clipped at",
                                        [SGT_TIR] = "is totally reflected at",
                                        [SGT_EVANESCENT] = "is evanescent at", [SGT_MISSED] = "misses"};
    const sgt_attempt *n = &l->nearest;
    const size_t element = n->element + 1;
    const char *what = n->fate < 0 ? "is undecided at" : stops[n->fate];
    const bool stopped = n->fate != SGT_PASSED;
    if (n->traces == 0) {
        table_line(t, "No ray of the field that the rims in front let through can meet it.");
        return;
    }
    if (isnan(n->miss)) {
        table_line(t, "No ray was found that gets to the stop.  The first that was tried, through %.6g, "
                      "%.6g of\nthe paraxial pupil, %s element %zu.", n->from.x, n->from.y, what, element);
        return;
    }
    table_line(t, "The nearest ray that was found goes through %.6g, %.6g of the paraxial pupil, and meets "
                  "the stop\n%.3g from the point.", n->to.x, n->to.y, n->miss);
    if (n->reason == SGT_AIM_AT_EDGE)
        table_line(t, "It is at the edge of the rays that were searched: nearer ones lie farther out.");
    if (n->reason == SGT_AIM_CUT && stopped)
        table_line(t, "A ray that would be nearer %s element %zu%s.", what, element,
                   element - 1 == j->lens.of->stop ? ", the stop" : "");
    if (n->reason == SGT_AIM_STUCK)
        table_line(t, "No ray beside it comes nearer: the rays of the field turn back short of the point.");
    if (n->reason == SGT_AIM_SPENT) table_line(t, "The search has spent its rays.");
}

/* A ray that is not there.  Returns whether that is decided. */
static bool diagnose_missing(const diagnose_arguments *a, const job *j, const launch *l)
{
    const sgt_field_beam beam = launch_beam(j->how, j->field_kind, j->field[l->field]);
    const sgt_pupil_point at = {l->px, l->py, 1};
    sgt_launched launched;
    if (!sgt_launch_rays(j->how->from, &beam, j->element, j->lens.index_before, 1, &at, &launched, NULL))
        fail_input("out of memory");
    table *t = table_begin(&a->shared.target, HEAD_COUNT, diagnose_head);
    table_line(t,
               "%s: ray %zu, field %zu, through %g, %g of the pupil.  It was not traced.  It has to meet\n"
               "the stop, element %zu, at %.6g, %.6g: %s.",
               job_name(j), l->number, j->field_number[l->field] + 1, l->px, l->py, j->lens.of->stop + 1,
               launched.wanted.x, launched.wanted.y, launch_words(l->status, l->within));
    explain_nearest(t, j, &launched);
    table_end(t);
    return l->status == SGT_NO_SUCH_RAY;
}

/* The N of --ray N, of a lens; 0 without it. */
static long ray_number(const diagnose_arguments *a)
{
    long number = 0;
    if (a->ray && !number_read_integer(a->ray, 0, LONG_MAX, &number))
        fail_usage("--ray: with a lens give the number of a ray, counted from 0, not \"%s\"", a->ray);
    return number;
}

/* The ray to show; *how: in words, by what it was chosen. */
static const launch *chosen_ray(const diagnose_arguments *a, const job *j, const char **how)
{
    sgt_passage *passage = memory_take(j->lens.count, sizeof *passage);
    const launch *chosen = NULL;
    const long number = ray_number(a);
    long most = -1;
    size_t reached = 0, chosen_reached = 0, alike = 0;
    sgt_fate fate, chosen_fate = SGT_PASSED;
    if ((size_t)a->element > j->lens.count)
        fail_usage("--element %d: the lens has %zu element%s", a->element, j->lens.count,
                   j->lens.count == 1 ? "" : "s");
    for (size_t i = 0; i < j->rays.count; i++) {
        const launch *l = &j->rays.ray[i];
        if (a->ray && l->number != (size_t)number) continue;
        long n = evaluations(a, j, l, passage, &reached, &fate);
        alike = n > most ? 1 : alike + (n == most);
        if (n > most) chosen = l, most = n, chosen_reached = reached, chosen_fate = fate;
    }
    if (!j->rays.count) fail_input("there are no rays");
    if (!chosen)
        fail_usage("--ray %s: there is no such ray; there %s %zu, counted from 0", a->ray,
                   j->rays.count == 1 ? "is" : "are", j->rays.count);
    *how = a->ray || j->rays.count == 1 ? ""
           : alike == 1                 ? ", the one that took most evaluations"
           : alike == j->rays.count     ? ", the first; each took as many evaluations"
                                        : ", the first of those that took most evaluations";
    if ((size_t)a->element > chosen_reached)
        fail_usage("--element %d: ray %zu does not get there; it is %s at element %zu", a->element,
                   chosen->number, sgt_fate_text(chosen_fate), chosen_reached);
    return chosen;
}

static bool diagnose_element(table *t, const diagnose_arguments *a, const job *j, size_t number,
                             const watched *w, size_t i)
{
    const sgt_element *e = &j->element[i];
    const sgt_options o = own_options(a);
    const sgt_ray ray = watched_ray(w, &j->lens, i);
    const record seen = watched_at(w, i);
    sgt_search made = options_search(&a->shared, e, SGT_NEAR_SEED, job_own_ray(&e->pose, &ray),
                                     &w->passage[i].hit);
    made.options = &o;
    const failed f = {.lens = &j->lens, .element = j->element, .at = i, .number = number,
                      .fate = i < w->passed ? SGT_PASSED : w->fate, .launch = &w->launch,
                      .come = watched_arrival(w, &j->lens, i), .search = &made};
    if (a->shared.target.format == TABLE_TEXT) failed_explain(t, &f);
    const char *title =
        memory_print("%s: ray %zu, element %zu (%s)", job_name(j), number, i + 1, j->lens.surface[i].type);
    return show(t, a, title, number, i, &seen, &made, f.fate == SGT_LOST);
}

/* Is every element shown by a row, and no search? */
static bool in_short(const diagnose_arguments *a, const watched *w)
{
    return a->shared.target.format == TABLE_TEXT && w->fate == SGT_PASSED && !a->element &&
           !a->all_elements && !a->method_given;
}

static bool diagnose_lens(const diagnose_arguments *a, const job *j, const launch *l, const char *how)
{
    const sgt_options o = own_options(a);
    const size_t count = j->lens.count;
    watched w = watched_room(count);
    watched_trace(&w, j->element, j->lens.index_before, &l->ray, &o);
    bool brief = in_short(a, &w), decided = true, failing = w.fate != SGT_PASSED;
    table *t = brief ? passed_begin(&a->shared.target, &j->lens)
                     : rows_begin(&a->shared.target);
    const char *name = job_name(j), *plural = count == 1 ? "" : "s";
    if (failing)
        table_line(t, "%s: ray %zu%s.  It passed %zu of %zu element%s.", name, l->number, how, w.passed,
                   count, plural);
    else
        table_line(t, "%s: ray %zu%s.  It passed all %zu element%s.", name, l->number, how, count, plural);
    if (brief) passed_write(t, j, &w);
    size_t first = 0, end = w.passed + failing;
    bool all = a->all_elements || a->shared.target.format != TABLE_TEXT;
    if (a->element) first = (size_t)a->element - 1, end = first + 1;
    else if (failing && !all) first = w.passed;
    for (size_t i = first; i < end && !brief; i++)
        decided = diagnose_element(t, a, j, l->number, &w, i) && decided;
    if (!brief) table_line(t, "\n%s", legend_of_lens);
    table_end(t);
    return decided && w.fate >= 0;
}

static double field_of(const sgt_lens_field *f)
{
    return f->x == 0 ? f->y : f->y == 0 ? f->x : hypot(f->x, f->y);
}

/* Every method at each element of all rays, or at --element of --ray, field by field. */
static bool compare_lens(const diagnose_arguments *a, const job *j)
{
    const sgt_options o = own_options(a);
    const contest_rules rules = rules_of(a);
    const size_t fields = j->fields ? j->fields : 1;
    tally *sum = memory_take(fields * METHODS, sizeof *sum);
    watched w = watched_room(j->lens.count);
    const long number = ray_number(a);
    bool decided = true;
    for (size_t i = 0; i < fields * METHODS; i++)
        sum[i].field = j->fields ? field_of(&j->field[i / METHODS]) : (double)NAN;
    for (size_t r = 0; r < j->rays.count; r++) {
        const launch *l = &j->rays.ray[r];
        tally *of = sum + l->field * METHODS;
        if (a->ray && l->number != (size_t)number) continue;
        watched_trace(&w, j->element, j->lens.index_before, &l->ray, &o);
        for (int m = 0; m < METHODS; m++) of[m].rays++, of[m].passed += w.fate == SGT_PASSED;
        decided = decided && w.fate >= 0;
        for (size_t i = 0; i < w.passed + (w.fate != SGT_PASSED); i++) {
            if (a->element && (size_t)a->element != i + 1) continue;
            const sgt_ray ray = watched_ray(&w, &j->lens, i);
            const record seen = watched_at(&w, i);
            const sgt_search s = options_search(&a->shared, &j->element[i], SGT_NEAR_SEED,
                                                job_own_ray(&j->element[i].pose, &ray), &w.passage[i].hit);
            contest each = contest_run(&s, &seen, &rules);
            tally_add(of, &each);
            contest_drop(&each);
        }
    }
    tally_show(&a->shared.target, job_name(j), fields, sum, a->shared.picture,
               j->field_kind == SGT_FIELD_ANGLE ? "field angle (degrees)" : "height of the field");
    return decided;
}

static exit_status diagnose_run(const command *c, int argc, char *argv[])
{
    diagnose_arguments a = diagnose_arguments_of(c, argc, argv);
    bool decided;
    if (!a.job.lens) {
        decided = diagnose_alone(&a);
    } else {
        job j = job_read(&a.job);
        shared_options asked = a.shared;
        if (a.method == METHOD_MARCH || a.compare) asked.solver.dt_min = 0; /* is read */
        options_note_unread(&asked, j.lens.count, j.element);
        const char *how = "";
        const launch *missing = a.compare ? NULL : missing_ray(&a, &j);
        const launch *l = a.compare ? NULL : missing ? missing : chosen_ray(&a, &j, &how);
        decided = a.compare ? compare_lens(&a, &j)
                  : missing ? diagnose_missing(&a, &j, l)
                            : diagnose_lens(&a, &j, l, how);
    }
    return decided ? EXIT_DECIDED : EXIT_UNDECIDED;
}
