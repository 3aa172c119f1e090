// SPDX-License-Identifier: MIT
/* trade.c - sagitta trade: what does accuracy cost, and what does speed cost? */
#include "../trade/trade.h"

#include "commands.h"
#include "../base/input.h"
#include "../draw/chart.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------- arguments */

typedef struct trade_arguments {
    shared_options shared;
    trade_options trade;
    const char *picture;
} trade_arguments;

/* Appends numbers separated by commas to the list `to` is the place of: whole numbers if `most`. */
static void take_list(void *into, const option_row *row, const char *value)
{
    knob_list *list = (knob_list *)(void *)((char *)into + row->to);
    char copy[400];
    if (snprintf(copy, sizeof copy, "%s", value) >= (int)sizeof copy) fail_usage("--%s: too long", row->name);
    for (char *rest = copy, *word; (word = strtok_r(rest, ", ", &rest));) {
        if (list->count == sizeof list->value / sizeof list->value[0])
            fail_usage("--%s: at most %zu values", row->name, list->count);
        double x = row->most ? (double)options_integer(row->name, word, 1, row->most)
                             : options_number(row->name, word);
        if (!(x > 0)) fail_usage("--%s must be above 0, not \"%s\"", row->name, word);
        list->value[list->count++] = x;
    }
    if (!list->count) fail_usage("--%s needs a number", row->name);
}

static void take_proofs(void *into, const option_row *row, const char *value)
{
    trade_options *o = &((trade_arguments *)into)->trade;
    char copy[60];
    snprintf(copy, sizeof copy, "%s", value);
    size_t before = o->proofs;
    for (char *rest = copy, *word; (word = strtok_r(rest, ", ", &rest));) {
        const sgt_proof proof = (sgt_proof)options_word(row, word);
        if (o->proofs == sizeof o->proof / sizeof o->proof[0]) fail_usage("--proof: give each value once");
        o->proof[o->proofs++] = proof;
    }
    if (o->proofs == before) options_word(row, value);
}

static void trade_take_ray(void *into, const option_row *row, const char *value)
{
    (void)row;
    rays_parse(&((trade_arguments *)into)->trade.rays, value);
}

static const option_row trade_rows[] = {
    {"surface", "SPEC",
     "a surface, as in sagitta intersect, with --rays FILE or --ray\n"
     "Default: a thousand rays that suit the surface",
     OPTION_TEXT, .to = offsetof(trade_arguments, trade.surface)},
    {"ray", "\"...\"", "a ray for it: ox oy oz dx dy dz", OPTION_TAKE, .take = trade_take_ray},
    {"seconds", "S", "time to spend on measuring, about (default 3; without a lens or a surface 10)",
     OPTION_LENGTH, .to = offsetof(trade_arguments, trade.seconds)},
    {"picture", "FILE", "draw error against time: svg, png or pdf, by the ending of the name", OPTION_TEXT,
     .to = offsetof(trade_arguments, picture)},
    {"svg", "FILE", "--svg FILE is now --picture FILE", .kind = OPTION_REFUSED},
    {0},
};
static const option_row trade_setting_rows[] = {
    {"t-tol", "X,...", "default 1e-12,1e-9,1e-6,1e-3", OPTION_TAKE,
     .to = offsetof(trade_arguments, trade.t_tol), .take = take_list},
    {"max-evals", "N,...", "default: 1/2, 1/4 and 1/8 of what the worst ray takes", OPTION_TAKE,
     .to = offsetof(trade_arguments, trade.max_evals), .most = INT_MAX, .take = take_list},
    {"proof", "P,...", "estimate, root or first; default root,first", OPTION_TAKE, .least = SGT_ESTIMATE,
     .words = "estimate root first", .take = take_proofs},
    {"dt-min", "X,...",
     "level sets only: the fast search, which proves nothing\nDefault 1e-1,1e-2,1e-3,1e-4", OPTION_TAKE,
     .to = offsetof(trade_arguments, trade.dt_min), .take = take_list},
    {"iterations", "N,...",
     "level sets only: other values of N, in a table of their own\n"
     "Errors are against the largest N; default N - 4, N - 2 ... N + 4",
     OPTION_TAKE, .to = offsetof(trade_arguments, trade.iterations), .most = INT_MAX, .take = take_list},
    {"pick", "P", "first or near-seed; default: both, each measured against its own root", OPTION_WORD,
     .to = offsetof(trade_arguments, trade.pick), .least = SGT_FIRST, .words = "first near-seed"},
    {0},
};
static const option_group trade_own = {OPTIONS_OWN, "Options", .row = trade_rows},
                          trade_settings = {OPTIONS_OWN, "Options of settings; values by commas",
                                            .row = trade_setting_rows};

static exit_status trade_run(const command *c, int argc, char *argv[]);

static const char trade_all[] =
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
    "Settings\n"
    "  default            all rays in one call; outputs: status, t, t_err, point and gradient, or of\n"
    "                     a lens fate, last point, last direction and path\n"
    "  single             one call for each ray\n"
    "  out=t, out=point   only t, or of a lens only the last point, is asked for\n"
    "  out=all            every output\n"
    "  floats             rays and answers of floats, of planes, conics and even aspheres; errors are\n"
    "                     of the rays that are rounded to floats, and evals is 0\n"
    "and those of the options below.\n";

const command command_trade = {
    .name = "trade", .usage = "[LENS | --surface SPEC [--rays FILE | --ray \"...\"]] [options]",
    .brief = "speed against accuracy, measured",
    .what = "What does accuracy cost, and what does speed cost?  Changes one option at a time, with all "
            "others at their defaults, and measures each setting on this machine.  Without a lens or a "
            "surface: a conic, an asphere, a scan lens and a Julia set.  A surface may have any type "
            "except those about the Earth.",
    .often = "surface rays ray t-tol max-evals proof seconds picture format output", .rays = "--grid 21",
    .examples = "  sagitta trade --surface '{type: conic, radius: 20, conic: -1}' --seconds 3\n"
                "  sagitta trade examples/lenses/cooke_triplet.yaml --picture trade.svg\n",
    .docs = "docs/accuracy.md, docs/data/trade.md", .all = trade_all,
    .exits = "  0  measured, even if some ray is undecided\n"
             "  2  wrong arguments\n"
             "  3  bad input, or output that cannot be written\n",
    .group = {&trade_own, &trade_settings, JOB_GROUPS, &options_output}, .run = trade_run,
};

static void check(const trade_arguments *a, bool of_lens)
{
    const job_options *j = &a->trade.job;
    bool rays = j->rays || a->trade.rays.count;
    if (a->trade.surface && j->lens) fail_usage("give --surface or a lens file, not both");
    if (a->trade.surface && of_lens)
        fail_usage("--field, --fan, --grid, --wavelength, --glass and --no-apertures go with a lens file, "
                   "not with --surface");
    if (j->rays && a->trade.rays.count) fail_usage("give --rays or --ray, not both");
    if (a->trade.rays.count && !a->trade.surface)
        fail_usage("--ray goes with --surface; for a lens give --rays FILE");
    if (!a->trade.surface && !j->lens && (rays || of_lens || j->skip_bad))
        fail_usage("there are options for rays, but no --surface and no lens file");
}

static trade_arguments trade_arguments_of(const command *c, int argc, char *argv[])
{
    trade_arguments a = {.trade = {.seconds = -1}};
    const unsigned given = command_read(c, &a, &a.trade.job, &a.shared, argc, argv);
    if (optind < argc) a.trade.job.lens = argv[optind++];
    if (optind < argc) fail_usage("unexpected argument \"%s\"; trade takes one lens file", argv[optind]);
    if (a.trade.seconds < 0) a.trade.seconds = a.trade.surface || a.trade.job.lens ? 3 : 10;
    check(&a, given & 1u << OPTIONS_OF_JOB);
    if (a.picture) chart_check("picture", a.picture);
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
        if (c->lens) options_note_unread(&asked, c->lens->count, c->lens->element);
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

/* Is there a best setting beside the base that tells as much and proves as much: time for accuracy? */
static bool any_trade(const trade_case *c)
{
    const setting *base = measure_base(c);
    for (size_t i = 0; i < c->settings; i++) {
        const setting *s = &c->setting[i];
        if (s->best && s != base && s->outputs == base->outputs && s->options.proof == base->options.proof)
            return true;
    }
    return false;
}

/* Under the rows: is there a trade, which knobs change nothing, and what each best setting does, if it is one
 * thing. */
static void write_words(table *t, const trade_case *c)
{
    if (!any_trade(c))
        table_line(t, "Here no accuracy can be traded for speed: of the settings that tell and prove as "
                      "much, one is best.");
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
    table_line(t, "undecided and wrong, and better in one of them.  Details: sagitta trade --help all.");
}

static exit_status trade_run(const command *c, int argc, char *argv[])
{
    trade_arguments a = trade_arguments_of(c, argc, argv);
    if (a.shared.target.path) output_check("output", a.shared.target.path);
    trade t = trade_cases(&a.trade);
    note_unread(&a, &t);
    if (a.picture) output_reserve("picture", a.picture);
    header h = header_of(&t, a.shared.target.format == TABLE_TEXT);
    table *written = table_begin(&a.shared.target, h.count, h.column);
    measure_all(&t, a.trade.seconds);
    trade_say_effects(&t);
    trade_write_rows(written, &h, &t);
    table_end(written);
    if (a.picture) trade_picture(a.picture, &t);
    return EXIT_DECIDED;
}
