/* trade.c - sagitta trade: what does accuracy cost, and what does speed cost? */
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
    "What does accuracy cost, and what does speed cost?  Changes one option at a time, with all\n"
    "others at their defaults, and measures each setting on this machine.  A surface may have any\n"
    "type except those about the Earth.\n"
    "\n"
    "Columns\n"
    "  setting            the option that is changed; see Settings\n"
    "  ns                 time per ray (nanoseconds of one thread, rays in memory)\n"
    "  evals              evaluations of F per ray; of a lens, at all its elements\n"
    "  err_median, err_99, err_worst\n"
    "                     the median, 99th percentile and largest of the errors against numbers of\n"
    "                     113 bits.  Of a surface: of t (lengths of the direction).  Of a lens: the\n"
    "                     distance of the last point from where it should be (length)\n"
    "  undecided          rays without an answer\n"
    "  wrong              rays with a wrong answer.  Of a surface: an error above t_err, or a hit\n"
    "                     that should be a miss, or the reverse.  Of a lens: another fate\n"
    "  best               1: no setting beats it (below)\n"
    "  path_worst         of a lens: the largest error of the optical path (length)\n"
    "  waves_worst        the same in wavelengths\n"
    "  effect             what the setting changes against the default, in words\n"
    "  case, rays, ns_low, ns_high\n"
    "                     csv and json only: what is measured, with how many rays, and the range\n"
    "                     that holds the true median time with 95 % probability\n"
    "\n"
    "One setting beats another if it gives as many outputs and proves as much, is worse in none of\n"
    "ns, err_99, undecided and wrong, and is better in one of them.  Times are equal if they\n"
    "differ by less than 10 %, or if their ranges ns_low to ns_high touch; errors are equal within\n"
    "a factor of 2.  A smaller error is no advantage if more rays are undecided.  Of equal settings\n"
    "the first is best.  A setting that changes nothing, or that hits nothing, is never best.\n"
    "\n"
    "Times are medians of several runs in shuffled order.  They differ from run to run, and more\n"
    "from machine to machine: compare only times of one run.\n"
    "\n"
    "Options\n"
    "  --surface SPEC     a surface, as in sagitta intersect, with --rays FILE or --ray\n"
    "                     \"ox oy oz dx dy dz\".  Default: a thousand rays that suit the surface\n"
    "  LENS               a lens file, and options for its rays, as in sagitta trace (but --grid 21\n"
    "                     by default)\n"
    "                     With neither: a conic, an asphere, a scan lens and a Julia set\n";
static const char trade_more_help[] =
    "\n"
    "Settings\n"
    "  default            all rays in one call; outputs: status, t, t_err, point and gradient, or of\n"
    "                     a lens fate, last point, last direction and path\n"
    "  single             one call for each ray\n"
    "  out=t, out=point   only t, or of a lens only the last point, is asked for\n"
    "  out=all            every output\n"
    "and these; values may be separated by commas, or the option repeated:\n"
    "  --t-tol X,...      default 1e-12,1e-9,1e-6,1e-3\n"
    "  --max-evals N,...  default: 1/2, 1/4 and 1/8 of what the worst ray takes\n"
    "  --proof P,...      estimate, root or first; default root,first\n"
    "  --dt-min X,...     level sets only: the fast search, which proves nothing; default\n"
    "                     1e-1,1e-2,1e-3,1e-4\n"
    "  --iterations N,... level sets only: other values of N, in a table of their own.  Errors are\n"
    "                     against the largest N; default N - 4, N - 2 ... N + 4\n"
    "  --pick P           first or near-seed; default: both, each measured against its own root\n"
    "\n"
    "  --seconds S        time to spend on measuring, about (default 10)\n"
    "  --svg FILE         draw error against time\n"
    "  --format F         text (for people, the default), csv or json\n"
    "  --hex              numbers in hexadecimal\n"
    "  --output FILE      write to FILE instead of standard output\n"
    "  --help, --version\n"
    "\n"
    "Exit status\n"
    "  0  measured, even if some ray is undecided\n"
    "  2  wrong arguments\n"
    "  3  bad input, or output that cannot be written\n";

/* -------------------------------------------------------------- arguments */

typedef struct trade_arguments {
    shared_options shared;
    trade_options trade;
    const char *svg;
} trade_arguments;

/* Appends numbers separated by commas to a list. */
static void take_list(knob_list *list, const char *option, bool whole)
{
    char copy[400];
    if (snprintf(copy, sizeof copy, "%s", optarg) >= (int)sizeof copy) fail_usage("--%s: too long", option);
    for (char *rest = copy, *word; (word = strtok_r(rest, ", ", &rest));) {
        if (list->count == sizeof list->value / sizeof list->value[0])
            fail_usage("--%s: at most %zu values", option, list->count);
        double x = whole ? (double)options_integer(option, word, 1, INT_MAX) : options_number(option, word);
        if (!(x > 0)) fail_usage("--%s must be above 0, not \"%s\"", option, word);
        list->value[list->count++] = x;
    }
    if (!list->count) fail_usage("--%s needs a number", option);
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
        if (i == 3) fail_usage("--proof must be estimate, root or first, not \"%s\"", word);
        if (o->proofs == sizeof o->proof / sizeof o->proof[0]) fail_usage("--proof: give each value once");
        o->proof[o->proofs++] = (sgt_proof)i;
    }
    if (o->proofs == before) fail_usage("--proof must be estimate, root or first");
}

/* Is there an option that only a lens has? */
static bool is_of_lens(const job_options *j)
{
    return j->fields || j->points || j->wavelengths || j->all_wavelengths || j->glass || j->strict ||
           j->no_apertures;
}

static void check(const trade_arguments *a)
{
    const job_options *j = &a->trade.job;
    bool rays = j->rays || a->trade.rays.count;
    if (a->trade.surface && j->lens) fail_usage("give --surface or a lens file, not both");
    if (a->trade.surface && is_of_lens(j))
        fail_usage("--field, --fan, --grid, --wavelength, --glass and --no-apertures go with a lens file, "
                   "not with --surface");
    if (j->rays && a->trade.rays.count) fail_usage("give --rays or --ray, not both");
    if (a->trade.rays.count && !a->trade.surface)
        fail_usage("--ray goes with --surface; for a lens give --rays FILE");
    if (!a->trade.surface && !j->lens &&
        (rays || is_of_lens(j) || j->skip_bad))
        fail_usage("there are options for rays, but no --surface and no lens file");
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
    for (int code; (code = getopt_long(argc, argv, "hq", known, NULL)) != -1;) {
        switch (code) {
        case SURFACE: a.trade.surface = optarg; break;
        case RAY: rays_parse(&a.trade.rays, optarg); break;
        case ITERATIONS: take_list(&a.trade.iterations, "iterations", true); break;
        case SECONDS:
            a.trade.seconds = options_number("seconds", optarg);
            if (!(a.trade.seconds >= 0)) fail_usage("--seconds must not be negative, but is %s", optarg);
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
    if (optind < argc) fail_usage("unexpected argument \"%s\"; trade takes one lens file", argv[optind]);
    check(&a);
    if (a.svg) trade_picture_check();
    if (!quad_there())
        fail_usage("trade is not available; this command was built without C++ or without numbers of 113 "
                   "bits, which it measures errors by");
    return a;
}

/* Notes on standard error which options have no effect here. */
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
        note("--iterations: not used; it needs two numbers or more, and a level set (julia, mandelbrot) "
             "given by "
             "--surface");
}

/* ------------------------------------------------------------------ table */

/* In text the case and its number of rays are not columns: they stand above the rows. */
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

/* Above the rows of a case: what it is, how many rays there are, and how many have no error. */
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
                   "(%zu of them are left out of the errors, because no exact answer is known: undecided, "
                   "touching, or beyond 113 bits)",
                   unknown);
}

/* A list in words: "a", "a and b", "a, b and c". */
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

/* The knobs of which no setting changes anything, for "t_tol changes nothing here". */
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

/* Under the rows: which knobs change nothing, and what each best setting does, if it is one thing. */
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
    bool surfaces = false;
    for (size_t i = 0; i < all->count; i++) surfaces = surfaces || !all->list[i].lens;
    table_line(t, "ns: nanoseconds a ray.  evals: evaluations a ray.  err: errors of %s.",
               !h->lens    ? "t, in lengths of the direction"
               : !surfaces ? "the last point, in lengths"
                           : "t, in lengths of the direction (of a lens: of the last point, in lengths)");
    if (h->lens)
        table_line(t, "path_worst: error of the optical path, in lengths; waves_worst: in wavelengths.");
    table_line(t, "best 1: none with as many outputs and as much proven is as good in ns, err_99,");
    table_line(t, "undecided and wrong, and better in one of them.  Details: sagitta trade --help.");
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
