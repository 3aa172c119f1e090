/* trade.c - sagitta trade: what does accuracy cost, and speed? */
#include "../trade/trade.h"

#include "commands.h"
#include "../base/input.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char trade_help[] =
    "sagitta trade [--surface SPEC [--rays FILE] [--ray \"...\"] | LENS [rays]] [options]\n"
    "\n"
    "What does accuracy cost, and what is speed paid with?  Turns one knob after another,\n"
    "all others as they are by default, and prints for each setting: nanoseconds a ray,\n"
    "evaluations a ray, the median, the 99th percentile and the worst of the errors against\n"
    "arithmetic of 113 bits, how many rays are undecided, how many answers are wrong, and in\n"
    "words what it changes.  Surfaces of any type but those about the Earth.\n"
    "\n"
    "best marks the settings that no best one beats: is not slower, nor less accurate at the\n"
    "99th percentile, nor leaves more rays undecided or wrong, and is better in one of these, with\n"
    "outputs as many or more, and as much proven.  Of several that are the same the first alone is\n"
    "marked, and nothing that changes nothing.  Times within 10 % of each other count as equal, and\n"
    "so do those whose spreads touch (ns_low to ns_high in csv and json); errors within a factor of\n"
    "2; a smaller error of fewer rays, others being undecided, does not count.  What meets nothing\n"
    "is not best.\n"
    "\n"
    "Times are the processor's, of one thread, rays in memory: medians of several runs in\n"
    "shuffled order.  They differ from run to run, and more from machine to machine: compare\n"
    "those of one run.\n"
    "\n"
    "  --surface SPEC     a surface as sagitta intersect takes it, with --rays FILE, --ray\n"
    "                     \"ox oy oz dx dy dz\", or a thousand rays that suit it.  The error\n"
    "                     is that of t; wrong: it exceeds t_err, or a hit should be a miss\n"
    "                     or the other way round\n"
    "  LENS               a lens as sagitta trace takes it, its rays chosen in the same way (but\n"
    "                     --grid 21 by default).  The error is the distance from where the ray\n"
    "                     should end, path_worst that of the optical path, waves_worst the same\n"
    "                     in waves; wrong: its fate is another\n"
    "  neither            a conic, an asphere, a scan lens and a Julia set\n"
    "\n";
static const char trade_more_help[] =
    "\n"
    "Settings: default (in a batch; status, t, t_err, p, n, or of a lens fate, point,\n"
    "direction, path), single (one ray a call), out=t or out=point (nothing else asked for),\n"
    "out=all, and these, one by one or separated by commas:\n"
    "  --t-tol X,...      (1e-12,1e-9,1e-6,1e-3)\n"
    "  --max-evals N,...  (a half, a quarter and an eighth of what the worst ray takes)\n"
    "  --proof P,...      estimate, root or first (root,first)\n"
    "  --dt-min X,...     level sets: the fast way, not certain (1e-1,1e-2,1e-3,1e-4)\n"
    "  --iterations N,... level sets: other N, in a table of their own, with errors against the\n"
    "                     deepest: they are those of the model (N - 4 to N + 4)\n"
    "  --pick P           first or near-seed; without it both are tried, each against its own\n"
    "                     root\n"
    "\n"
    "  --seconds S        for the times, about (10)\n"
    "  --svg FILE         draws error against time\n"
    "  --format F         text (for people, the default), csv or json\n"
    "  --hex              numbers in hexadecimal\n"
    "  --output FILE      write there and not to standard output\n"
    "  --help, --version\n"
    "\n"
    "Exit status: 0, also where rays are undecided; 2 usage, 3 bad input,\n"
    "or an output that cannot be written.\n";

/* -------------------------------------------------------------- arguments */

typedef struct trade_arguments {
    shared_options shared;
    trade_options trade;
    const char *svg;
} trade_arguments;

/* Numbers separated by commas, after those that are there. */
static void take_list(knob_list *list, const char *option, bool whole)
{
    char copy[400];
    if (snprintf(copy, sizeof copy, "%s", optarg) >= (int)sizeof copy) fail_usage("--%s: too long", option);
    for (char *rest = copy, *word; (word = strtok_r(rest, ", ", &rest));) {
        if (list->count == sizeof list->value / sizeof list->value[0])
            fail_usage("--%s: at most %zu values", option, list->count);
        double x = whole ? (double)options_integer(option, word, 1, INT_MAX) : options_number(option, word);
        if (!(x > 0)) fail_usage("--%s wants numbers above 0, and \"%s\" is not", option, word);
        list->value[list->count++] = x;
    }
    if (!list->count) fail_usage("--%s wants a number", option);
}

static void take_proofs(trade_options *o)
{
    static const char *const name[] = {"estimate", "root", "first"};
    char copy[60];
    snprintf(copy, sizeof copy, "%s", optarg);
    size_t before = o->proofs;
    for (char *rest = copy, *word; (word = strtok_r(rest, ", ", &rest));) {
        size_t i = 0;
        while (i < 3 && strcmp(word, name[i]) != 0) i++;
        if (i == 3) fail_usage("--proof wants estimate, root or first, not \"%s\"", word);
        if (o->proofs == sizeof o->proof / sizeof o->proof[0]) fail_usage("--proof: each of them once");
        o->proof[o->proofs++] = (sgt_proof)i;
    }
    if (o->proofs == before) fail_usage("--proof wants estimate, root or first");
}

static void check(const trade_arguments *a)
{
    const job_options *j = &a->trade.job;
    bool rays = j->rays || a->trade.rays.count;
    if (a->trade.surface && j->lens) fail_usage("--surface or a lens, not both");
    if (a->trade.surface && (j->fields || j->fan || j->grid || j->wavelength || j->no_apertures))
        fail_usage("--field, --fan, --grid, --wavelength, --no-apertures: of a lens, and not of --surface");
    if (j->rays && a->trade.rays.count) fail_usage("--rays or --ray, not both");
    if (a->trade.rays.count && !a->trade.surface)
        fail_usage("--ray goes with --surface; for a lens --rays FILE");
    if (!a->trade.surface && !j->lens &&
        (rays || j->fields || j->fan || j->grid || j->wavelength || j->no_apertures || j->skip_bad))
        fail_usage("rays of whom?  A lens, or --surface, is missing");
}

static trade_arguments trade_arguments_of(int argc, char *argv[])
{
    enum { SURFACE = OPTION_AFTER_JOB, RAY, ITERATIONS, SECONDS, SVG, PROOF };
    static const struct option known[] = {
        {"surface", required_argument, NULL, SURFACE}, {"ray", required_argument, NULL, RAY},
        {"iterations", required_argument, NULL, ITERATIONS}, {"seconds", required_argument, NULL, SECONDS},
        {"svg", required_argument, NULL, SVG}, {"proof", required_argument, NULL, PROOF},
        JOB_OPTIONS, SHARED_OPTIONS, {0},
    };
    trade_arguments a = {.trade = {.seconds = 10}};
    for (int code; (code = getopt_long(argc, argv, "h", known, NULL)) != -1;) {
        switch (code) {
        case SURFACE: a.trade.surface = optarg; break;
        case RAY: rays_parse(&a.trade.rays, optarg); break;
        case ITERATIONS: take_list(&a.trade.iterations, "iterations", true); break;
        case SECONDS:
            a.trade.seconds = options_number("seconds", optarg);
            if (!(a.trade.seconds >= 0)) fail_usage("--seconds must not be negative");
            break;
        case SVG: a.svg = optarg; break;
        case PROOF: take_proofs(&a.trade); break;
        case OPTION_T_TOL: take_list(&a.trade.t_tol, "t-tol", false); break;
        case OPTION_DT_MIN: take_list(&a.trade.dt_min, "dt-min", false); break;
        case OPTION_MAX_EVALS: take_list(&a.trade.max_evals, "max-evals", true); break;
        case 'h':
        case OPTION_HELP: print_and_end("%s%s%s", trade_help, job_help, trade_more_help);
        default:
            if (!job_take(&a.trade.job, code)) options_take(&a.shared, code, trade_help);
        }
    }
    a.trade.pick = a.shared.solver.pick;
    if (optind < argc) a.trade.job.lens = argv[optind++];
    if (optind < argc) fail_usage("one lens at a time; what is \"%s\"?", argv[optind]);
    check(&a);
    if (a.svg) trade_picture_check();
    quad_check();
    return a;
}

/* A word on standard error of what was asked for and is of no use. */
static void note_unread(const trade_arguments *a, const trade *t)
{
    shared_options asked = {
        .solver = {.pick = a->trade.pick, .dt_min = a->trade.dt_min.count ? a->trade.dt_min.value[0] : 0}};
    bool deep = false;
    for (size_t i = 0; i < t->count; i++) {
        const trade_case *c = &t->list[i];
        if (c->lens) options_note_unread(&asked, c->lens->lens.count, c->lens->element);
        else if (t->count <= 2)
            options_note_unread(&asked, 1, &(sgt_element){.surface = c->setting[0].surface});
        deep = deep || c->setting[0].turned == KNOB_ITERATIONS;
    }
    if (a->trade.iterations.count && !deep)
        note("--iterations: not used; it is for two numbers or more, and a level set (julia, mandelbrot) by "
             "itself");
}

/* ------------------------------------------------------------------ table */

/* For people the case stands above its rows, and the rays with it. */
static const column trade_head[] = {
    {"case", COLUMN_WORD}, {"setting", COLUMN_WORD}, {"ns", COLUMN_NUMBER}, {"evals", COLUMN_NUMBER},
    {"err_median", COLUMN_ERROR}, {"err_99", COLUMN_ERROR}, {"err_worst", COLUMN_ERROR},
    {"undecided", COLUMN_COUNT}, {"wrong", COLUMN_COUNT}, {"rays", COLUMN_COUNT}, {"best", COLUMN_COUNT},
    {"path_worst", COLUMN_ERROR}, {"waves_worst", COLUMN_ERROR},
    {"ns_low", COLUMN_NUMBER}, {"ns_high", COLUMN_NUMBER}, {"effect", COLUMN_WORD},
};
enum { HEAD_COUNT = sizeof trade_head / sizeof trade_head[0] };
typedef struct header { column column[HEAD_COUNT]; size_t count; bool text, lens; } header;

static bool trade_shown(const header *h, const char *name)
{
    if (strcmp(name, "case") == 0 || strcmp(name, "rays") == 0 || strncmp(name, "ns_", 3) == 0)
        return !h->text;
    return h->lens || (strcmp(name, "path_worst") != 0 && strcmp(name, "waves_worst") != 0);
}

static header header_of(const trade *all, bool text)
{
    header h = {.text = text};
    for (size_t i = 0; i < all->count; i++) h.lens = h.lens || all->list[i].lens;
    for (size_t i = 0; i < HEAD_COUNT; i++)
        if (trade_shown(&h, trade_head[i].name)) h.column[h.count++] = trade_head[i];
    return h;
}

static void write_setting(table *t, const header *h, const trade_case *c, const setting *s)
{
    const double numbers[] = {s->ns, s->evals, s->error_median, s->error_99, s->error_worst};
    if (!h->text) table_word(t, c->name);
    table_word(t, s->name);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) table_number(t, numbers[i]);
    table_count(t, (long long)s->undecided);
    table_count(t, (long long)s->wrong);
    if (!h->text) table_count(t, (long long)c->rays);
    table_count(t, s->best);
    if (h->lens) {
        table_number(t, c->lens ? s->path_worst : (double)NAN);
        table_number(t, c->lens ? s->waves_worst : (double)NAN);
    }
    if (!h->text) table_number(t, s->ns_low), table_number(t, s->ns_high);
    table_word(t, s->effect);
}

/* Above the rows of a case: what it is, how many rays there are, and of how many the errors. */
static void write_about(table *t, const trade_case *c)
{
    size_t met = 0, unknown = 0;
    for (size_t i = 0; i < c->rays; i++) {
        met += c->setting[0].truth[i].known && c->setting[0].truth[i].met;
        unknown += !c->setting[0].truth[i].known;
    }
    table_line(t, "%s: %s; %zu ray%s, %zu of them %s", c->name, c->about, c->rays, c->rays == 1 ? "" : "s",
               met, c->lens ? "through to the end" : "met");
    if (unknown)
        table_line(t,
                   "(of %zu there is no truth to tell errors by: undecided, touching, or beyond the digits "
                   "of 113 bits)",
                   unknown);
}

/* Words put together: "a", then "a and b", then "a, b and c". */
typedef struct words { char text[600]; size_t count, last; } words;

static void words_add(words *w, const char *more)
{
    size_t length = strlen(w->text);
    w->last = length;
    w->count++;
    snprintf(w->text + length, sizeof w->text - length, "%s%s", length ? ", " : "", more);
}

static void words_end(words *w)
{
    char last[sizeof w->text];
    if (w->count < 2) return;
    snprintf(last, sizeof last, "%s", w->text + w->last + 2);
    snprintf(w->text + w->last, sizeof w->text - w->last, " and %s", last);
}

/* "t_tol changes nothing here": the knobs of which no setting does anything. */
static words idle_knobs(const trade_case *c)
{
    words idle = {.count = 0};
    for (int k = KNOB_NONE + 1; k < KNOBS; k++) {
        size_t tried = 0, nothing = 0;
        for (size_t i = 0; i < c->settings; i++) {
            if (c->setting[i].turned != (knob)k) continue;
            tried++;
            nothing += strcmp(c->setting[i].effect, "changes nothing") == 0;
        }
        if (tried && nothing == tried) words_add(&idle, trade_knob_name[k]);
    }
    words_end(&idle);
    return idle;
}

/* Under the rows: what is in vain, and what the best of the others do, if it is one thing. */
static void write_words(table *t, const trade_case *c)
{
    char text[1200] = "";
    words idle = idle_knobs(c);
    if (idle.count)
        snprintf(text, sizeof text, "%s %s nothing here", idle.text, idle.count > 1 ? "change" : "changes");
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        size_t length = strlen(text);
        if (!s->best || !*s->effect || *s->effect == 'n' || strchr(s->effect, ';')) continue;
        snprintf(text + length, sizeof text - length, "%s%s %s%s", length ? "; " : "", s->name,
                 *s->effect == 'c' ? "" : "is ", s->effect);
    }
    if (*text) table_line(t, "%s.\n", text);
}

static void trade_write_rows(table *t, const header *h, const trade *all)
{
    for (size_t i = 0; i < all->count; i++) {
        const trade_case *c = &all->list[i];
        write_about(t, c);
        for (size_t k = 0; k < c->settings; k++) write_setting(t, h, c, &c->setting[k]);
        write_words(t, c);
    }
    table_line(t, "best 1: no best one of its table, with as many outputs and as much proven, is as good in "
                  "time, err_99, undecided and wrong, and better in one;");
    table_line(t, "of several that are the same the first.  Times count as different by more than their "
                  "spread, and by 10 %%.");
}

exit_status command_trade(int argc, char *argv[])
{
    trade_arguments a = trade_arguments_of(argc, argv);
    if (a.shared.target.path) output_check("output", a.shared.target.path);
    trade t = trade_cases(&a.trade);
    note_unread(&a, &t);
    if (a.svg) output_reserve("svg", a.svg);
    header h = header_of(&t, a.shared.target.format == TABLE_TEXT);
    table *written = table_begin(&a.shared.target, h.count, h.column);
    trade_measure(&t, a.trade.seconds);
    trade_write_rows(written, &h, &t);
    table_end(written);
    if (a.svg) trade_picture(a.svg, &t);
    return EXIT_DECIDED;
}
