// SPDX-License-Identifier: MIT
/* look.c - options into a study, and its rows into a table. */
#include "look.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../base/progress.h"
#include "../base/ranks.h"
#include "../base/threads.h"
#include "../base/tiles.h"

#include <limits.h>
#include <math.h>
#include <sagitta/edit.h>
#include <sagitta/prove.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------- options */

/* Settings as they are given, which are of an analysis that a later option may choose; and this option. */
typedef struct given { const sgt_setting *setting; const char *value; } given;
typedef struct asking {
    look *look;
    const look_way *way;
    const sgt_setting **setting; /* [row.to] */
    given *given;
    size_t settings, count;
    const look_view *view;
    const char *view_value;
} asking;

static void note_setting(void *into, const option_row *row, const char *value)
{
    asking *a = into;
    a->given[a->count++] = (given){a->setting[row->to], value};
}

static void note_view(void *into, const option_row *row, const char *value)
{
    asking *a = into;
    const look_view *v = a->way->view + row->to;
    if (a->view && a->view != v) fail_usage("give --%s or --%s, not both", a->view->option, v->option);
    if (a->view && v->several) value = memory_print("%s; %s", a->view_value, value);
    a->view = v, a->view_value = value;
}

static void take_picture(void *into, const option_row *row, const char *value)
{
    chart_check(row->name, value);
    ((shared_options *)into)->picture = value;
}

static const option_row look_rows[] = {
    {"picture", "FILE", "draw it: svg, png or pdf, by the ending of the name", OPTION_TAKE,
     .take = take_picture},
    PICK_OPTION("which root: near-seed or first, as in sagitta trace"),
    {0},
};
#define WEIGHTS_OPTION                                                                                    \
    {"weights", "WORD",                                                                                   \
     "area (the default): a ray counts by the area of the pupil that it stands for; equal: each alike\n"  \
     "They differ for --hexapolar.  OpticStudio has equal",                                               \
     OPTION_WORD, .to = offsetof(shared_options, weights), .words = "area equal"}

/* --proof all, of the analyses of a sample of rays. */
static bool proof_of_all;

static void take_proof(void *into, const option_row *row, const char *value)
{
    const int word = options_word(row, value);
    proof_of_all = word == 3;
    ((shared_options *)into)->solver.proof = (sgt_proof)(proof_of_all ? SGT_ESTIMATE : SGT_ESTIMATE + word);
}

static bool has_proof_of_all(const sgt_analysis *a)
{
    static const char *const names[] = {"spot", "fan", "opd", "map"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(a->name, names[i]) == 0) return true;
    return false;
}

static const option_row proof_rows[] = {
    WEIGHTS_OPTION,
    PROOF_OPTION("what must be proven of each hit: estimate, root or first (see sagitta trace)\n"
                 "A ray for which it is not is lost"),
    {0},
};
static const option_row proof_or_all_rows[] = {
    WEIGHTS_OPTION,
    {"proof", "P",
     "what must be proven of each hit: estimate, root or first (see sagitta trace)\n"
     "A ray for which it is not is lost.  all: nothing of a hit, but what is true of every ray of\n"
     "the pupil is proven beside the rays (sagitta prove), and a note says what they miss",
     OPTION_TAKE, .words = "estimate root first all", .take = take_proof},
    {0},
};
static const option_group look_group = {OPTIONS_SHARED, "The search, and the picture", .row = look_rows};

enum { OWN_MOST = 30 };

/* Appends the settings of an analysis, but for those that are there, and the one that is the argument of a
 * view. */
static option_row *look_settings(asking *to, option_row *row, const sgt_analysis *a, const char *argument)
{
    static const char *const value[] = {[SGT_SETTING_FLAG] = NULL, [SGT_SETTING_COUNT] = "N",
                                        [SGT_SETTING_WORD] = "WORD", [SGT_SETTING_NUMBER] = "X",
                                        [SGT_SETTING_NUMBERS] = "X,X...", [SGT_SETTING_TEXT] = "TEXT"};
    for (size_t i = 0; i < a->settings; i++) {
        const sgt_setting *s = sgt_analysis_setting(a, i);
        bool known = argument && strcmp(s->name, argument) == 0;
        for (size_t k = 0; k < to->settings; k++) known = known || strcmp(to->setting[k]->name, s->name) == 0;
        for (const option_row *own = to->way->own; own && own->name; own++)
            known = known || strcmp(own->name, s->name) == 0; /* over a number: --steps is of that */
        if (known) continue;
        *row++ = (option_row){s->name, value[s->kind], s->help, OPTION_TAKE, .to = to->settings,
                              .take = note_setting};
        to->setting[to->settings++] = s;
    }
    return row;
}

static const option_row *own_rows(asking *a)
{
    option_row *all = memory_take(OWN_MOST, sizeof *all), *row = look_settings(a, all, a->look->of, NULL);
    for (const look_view *v = a->way->view; v && v->option; v++) {
        *row++ = (option_row){v->option, v->several ? "TEXT" : v->setting ? "N" : NULL, v->help, OPTION_TAKE,
                              .to = (size_t)(v - a->way->view), .take = note_view};
        row = look_settings(a, row, sgt_analysis_named(v->analysis), v->setting);
    }
    for (const option_row *own = a->way->own; own && own->name; own++) *row++ = *own;
    return all;
}

/* Appends the numbers of a list with commas to one that was given before. */
static sgt_list numbers_of(const sgt_setting *s, sgt_list before, const char *value)
{
    double *at = memory_take(before.count + strlen(value) + 1, sizeof *at);
    sgt_list all = {.count = before.count, .at = at};
    char *rest, *list = memory_text(value, strlen(value));
    for (size_t i = 0; i < before.count; i++) at[i] = before.at[i];
    for (char *word = strtok_r(list, ",", &rest); word; word = strtok_r(NULL, ",", &rest))
        at[all.count++] = options_number(s->name, word);
    if (all.count == before.count) fail_usage("--%s must be a number, not \"%s\"", s->name, value);
    if (s->kind == SGT_SETTING_NUMBER && all.count > 1) at[0] = at[all.count - 1], all.count = 1;
    return all;
}

static void take_setting(look *l, const sgt_setting *s, const char *name, const char *value)
{
    char *to = (char *)l->options + s->offset;
    l->set[l->sets++] = s;
    switch (s->kind) {
    case SGT_SETTING_FLAG: *(bool *)(void *)to = true; return;
    case SGT_SETTING_COUNT:
        *(size_t *)(void *)to = (size_t)options_integer(name, value, (long)s->least, (long)s->most);
        return;
    case SGT_SETTING_WORD:
        *(int *)(void *)to = options_word(&(option_row){.name = s->name, .words = s->words}, value);
        return;
    case SGT_SETTING_NUMBER:
    case SGT_SETTING_NUMBERS:
        *(sgt_list *)(void *)to = numbers_of(s, *(sgt_list *)(void *)to, value);
        return;
    case SGT_SETTING_TEXT: *(const char **)(void *)to = value; return;
    }
}

bool look_given(const look *l, const char *setting)
{
    for (size_t i = 0; i < l->sets; i++)
        if (strcmp(l->set[i]->name, setting) == 0) return true;
    return false;
}

static const sgt_setting *setting_named(const sgt_analysis *a, const char *name)
{
    for (size_t i = 0; i < a->settings; i++)
        if (strcmp(sgt_analysis_setting(a, i)->name, name) == 0) return sgt_analysis_setting(a, i);
    return NULL;
}

static const char *view_with(const look_way *way, const char *setting)
{
    for (const look_view *v = way->view; v && v->option; v++)
        if (setting_named(sgt_analysis_named(v->analysis), setting))
            return memory_print("--%s%s", v->option, v->several ? " TEXT" : v->setting ? " N" : "");
    return "";
}

static const char *rays_by_default(const sgt_analysis *a, const look_view *v)
{
    const char *rays = look_default_rays(a);
    for (; v && v->option; v++)
        rays = memory_print("%s; with --%s %s", rays, v->option,
                         look_default_rays(sgt_analysis_named(v->analysis)));
    return rays;
}

static void take_lens(look *l, const command *c, int argc, char *argv[])
{
    job_options *o = &l->job;
    o->lens = command_file(c, "lens file", argc, argv), o->several = true;
    if (o->rays) fail_usage("--rays: %s launches the rays of fields; sagitta trace takes a file", c->name);
    if (o->skip_bad) fail_usage("--skip-bad goes with --rays; %s launches the rays of fields", c->name);
    /* (of an analysis without rays: all rays are meant, or chief rays) */
    const bool every = strncmp(l->of->name, "prove", 5) == 0;
    if (l->of->no_fields && (o->fields || o->numbers))
        fail_usage("--field, --fields: %s takes --from and --to", c->name);
    if (l->of->no_rays && (o->pupils || o->points))
        fail_usage("a pattern of rays is of no use here: %s",
                   every ? "all rays of the pupil are meant" : "the rays are those near the chief ray");
    if (l->of->no_rays && l->shared.weights)
        fail_usage(every ? "--weights: every ray of the pupil counts, by its area"
                         : "--weights: %s follows chief rays, each by itself", c->name);
    if (l->of->no_rays && l->shared.solver.proof)
        fail_usage(every ? "--proof: all that %s tells is proven"
                         : "--proof: %s follows chief rays and proves nothing; spot, fan, opd, map and "
                           "sweep do",
                   c->name);
    if (!l->of->primary_alone && !o->wavelengths) o->all_wavelengths = true;
    options_shard(&l->shared, l->shared.picture && l->of->part_of);
    l->picture = l->shared.picture;
    if (shard_is() && l->picture && l->of->part_of)
        fail_usage("--picture: it shows rays, which --shard has in no part of a sum; draw it by sagitta %s",
                   l->of->part_of);
    if (!l->picture || shard_is()) return;
    if (l->shared.target.path) output_check("output", l->shared.target.path);
    output_reserve("picture", l->picture);
}

static void take_options(look *l, const command *c, const look_way *way, int argc, char *argv[])
{
    const sgt_setting *setting[OWN_MOST];
    asking a = {.look = l, .way = way, .setting = setting,
                .given = memory_take((size_t)argc, sizeof *a.given)};
    const option_group own = {OPTIONS_OWN, "Options", .row = own_rows(&a)};
    const option_group proof = {OPTIONS_SHARED, NULL,
                                .row = has_proof_of_all(l->of) ? proof_or_all_rows : proof_rows,
                                .hidden = l->of->no_rays};
    const look_help columns = {l->of, way->view};
    command all = *c;
    all.usage = "LENS [options]", all.what = l->of->help;
    if (!all.docs) all.docs = "docs/analysis.md";
    all.rays = l->of->no_rays ? NULL : rays_by_default(l->of, way->view);
    all.print_all = look_print_columns, all.columns = look_column_words, all.context = &columns;
    const option_group *const groups[] = {
        &own, l->of->no_fields ? &job_no_fields : &job_fields_options,
        l->of->no_rays ? &job_no_pattern : &job_pattern_options, &job_no_file, &job_aim_options,
        &job_wavelength_options, &job_glass_options, &job_aperture_options, &look_group, &proof,
        &options_solver, &options_in_threads, &options_shards, &options_rows,
    };
    memcpy(all.group, groups, sizeof groups);
    command_read(&all, &a, &l->job, &l->shared, argc, argv);
    if (a.view) l->of = sgt_analysis_named(a.view->analysis);
    if (way->analysis) l->of = sgt_analysis_named(way->analysis(l));
    l->options = memory_take(l->of->options_size + 1, 1);
    l->set = memory_take(a.count + 1, sizeof *l->set);
    if (a.view && a.view->setting)
        take_setting(l, setting_named(l->of, a.view->setting), a.view->option, a.view_value);
    for (size_t i = 0; i < a.count; i++) {
        const char *name = a.given[i].setting->name;
        const sgt_setting *s = setting_named(l->of, name);
        if (!s) fail_usage("--%s goes with %s", name, view_with(way, name));
        take_setting(l, s, name, a.given[i].value);
    }
    take_lens(l, &all, argc, argv);
}

/* ------------------------------------------------------------------ the study */

/* Tasks that are at work, and whether the command is about to end. */
static int at_work, leaving;

/* Of sagitta prove: the tasks that are done are counted for --progress, by the thread that asks. */
static bool counts_tasks;
static size_t tasks_done, tasks_told;
static _Thread_local bool asks;

static void count_tasks(size_t more)
{
    const size_t done = __atomic_add_fetch(&tasks_done, more, __ATOMIC_RELAXED);
    if (!asks) return;
    progress_add(done - tasks_told);
    tasks_told = done;
}

static void in_threads(void *context, size_t tasks, void (*task)(void *data, size_t i), void *data)
{
    const int threads = *(const int *)context;
    (void)threads; /* unused without OpenMP */
    THREADS(omp parallel for schedule(dynamic) num_threads(threads))
    for (size_t i = 0; i < tasks; i++) {
        __atomic_add_fetch(&at_work, 1, __ATOMIC_SEQ_CST);
        if (!__atomic_load_n(&leaving, __ATOMIC_SEQ_CST)) task(data, i);
        if (counts_tasks) count_tasks(1);
        __atomic_sub_fetch(&at_work, 1, __ATOMIC_SEQ_CST);
    }
    ranks_serve();
}

/* At exit, before what they read is freed: the others are waited for.  Who leaves may be at work himself, as
 * rows are printed there. */
static void wait_for_threads(void)
{
    __atomic_store_n(&leaving, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&at_work, __ATOMIC_SEQ_CST) > 1) continue;
}

static sgt_study *studies[1];

static void free_study(void) { sgt_study_free(studies[0]); }

/* A fault of a setting or of the points is one of the arguments. */
_Noreturn static void refuse(const look *l, const sgt_error *e)
{
    if (!e->line && (setting_named(l->of, e->key) || strcmp(e->key, "rays") == 0))
        fail_usage("--%s: %s", e->key, e->words);
    if (strcmp(e->key, "wavelengths") == 0 && strstr(e->words, "give a wavelength"))
        fail_usage("%s: %s", e->file, e->words);
    lens_refuse(e);
}

/* One of several shards, or their join. */
static sgt_shard shared_out = {.write = shard_write, .read = shard_read};

sgt_study_options look_study(look *l, const job_points_asked *points, int *threads)
{
    const job_options *o = &l->job;
    sgt_lens *of;
    const lens_list lenses = job_lenses(o);
    l->band = lenses.lens, l->bands = lenses.count, of = lenses.lens[0].of;
    l->primary = of->wavelength ? lens_at(of, (lens_wavelength){.um = (double)NAN}) : lenses.lens[0];
    lens_note_image(of);
    l->fields = job_fields(o, &l->primary);
    l->um = sgt_lens_unit(of);
    options_note_unread(&l->shared, l->primary.count, l->primary.element);
    size_t *number = memory_take(l->fields.count, sizeof *number);
    sgt_wavelength *wavelength = memory_take(l->bands, sizeof *wavelength);
    for (size_t i = 0; i < l->fields.count; i++) number[i] = l->fields.number[i] + 1;
    for (size_t i = 0; i < l->bands; i++)
        wavelength[i] = (sgt_wavelength){l->band[i].chosen, l->band[i].wavelength};
    *threads = options_threads(&l->shared);
    shared_out.number = shard_number(), shared_out.of = shard_count();
    shared_out.next = shard_ranks() ? shard_next : NULL;
    /* (A picture, or --proof all, may ask another analysis for the same points.) */
    const bool fixed = (l->picture && l->of->part_of) || proof_of_all;
    return (sgt_study_options){
        .aim = job_aim(o, of), .solver = &l->shared.solver, .open = o->no_apertures,
        .fields = o->fields || o->numbers ? l->fields.count : 0, .field = o->fields ? NULL : number,
        .field_at = l->fields.at, .field_kind = &l->fields.kind,
        .wavelengths = of->wavelength || o->wavelengths ? l->bands : 0, .wavelength = wavelength,
        .pattern = points->rays || fixed ? &points->pattern : NULL,
        .rays = fixed && !points->rays ? l->of->rays : points->rays, .seed = points->seed,
        .points = points->count, .point = points->at, .equal_weights = l->shared.weights,
        .run = *threads > 1 || shard_ranks() || counts_tasks ? in_threads : NULL, .context = threads,
        .shard = shard_count() ? &shared_out : NULL};
}

static void begin_study(look *l, const job_points_asked *points, int *threads)
{
    static bool registered;
    sgt_error e;
    const sgt_study_options options = look_study(l, points, threads);
    l->study = studies[0] = sgt_study_new(l->band[0].of, &options, &e);
    if (!l->study) lens_refuse(&e);
    if (!registered) {
        atexit(free_study);
        atexit(wait_for_threads);
    }
    registered = true;
}

/* ---------------------------------------------------------------------- rows */

size_t look_column(const look *l, const char *name)
{
    size_t i = 0;
    while (i < l->of->columns && strcmp(sgt_analysis_column(l->of, i)->name, name) != 0) i++;
    return i;
}

static size_t count_at(const void *row, size_t offset)
{
    size_t x;
    memcpy(&x, (const char *)row + offset, sizeof x);
    return x;
}

static double number_at(const void *row, size_t offset)
{
    double x;
    memcpy(&x, (const char *)row + offset, sizeof x);
    return x;
}

static int fate_at(const void *row, size_t offset)
{
    int x;
    memcpy(&x, (const char *)row + offset, sizeof x);
    return x;
}

double look_value(const look *l, const void *row, size_t place)
{
    const sgt_column *c = sgt_analysis_column(l->of, place);
    return c->kind == SGT_COLUMN_COUNT || c->kind == SGT_COLUMN_PLACE ? (double)count_at(row, c->offset)
           : c->kind == SGT_COLUMN_FATE || c->kind == SGT_COLUMN_VERDICT || c->kind == SGT_COLUMN_QUANTITY
               ? fate_at(row, c->offset)
               : number_at(row, c->offset);
}

const void *look_row(const look *l, size_t i) { return l->row + i * l->of->row_size; }

size_t look_band_of(const look *l, double um)
{
    size_t b = 0;
    while (b < l->bands && l->band[b].wavelength != um && !(isnan(um) && isnan(l->band[b].wavelength))) b++;
    return b;
}

size_t look_field_of(const look *l, size_t number)
{
    size_t f = 0;
    while (f < l->fields.count && l->fields.number[f] + 1 != number) f++;
    return f;
}

/* What is printed: the columns that are there. */
typedef struct printing {
    look *look;
    const look_way *way;
    size_t count, *place;       /* [count]: which columns */
    const char **unit;          /* [count] */
    const sgt_column **column;  /* [count]: they */
    table_member *member;       /* [count]: the same for rows of csv */
    bool text;                  /* for people, in the columns by default */
    const sgt_column *wavelength; /* NULL: there is none */
    char *before;               /* the row before; NULL: none yet */
    const char **legend;
    size_t legends;
    bool chief; /* a chief ray that does not get through was explained */
} printing;

static column head_of(const look *l, size_t i, char unit[32])
{
    static const column_kind kinds[] = {
        [SGT_COLUMN_NUMBER] = COLUMN_NUMBER, [SGT_COLUMN_EXACT] = COLUMN_EXACT,
        [SGT_COLUMN_ERROR] = COLUMN_ERROR,   [SGT_COLUMN_WAVELENGTH] = COLUMN_EXACT,
        [SGT_COLUMN_COUNT] = COLUMN_COUNT,   [SGT_COLUMN_PLACE] = COLUMN_COUNT,
        [SGT_COLUMN_WHOLE] = COLUMN_COUNT,   [SGT_COLUMN_FATE] = COLUMN_CODE,
        [SGT_COLUMN_VERDICT] = COLUMN_CODE,   [SGT_COLUMN_QUANTITY] = COLUMN_CODE};
    char name[32];
    sgt_study_column(l->study, l->of, l->options, i, name, unit);
    return (column){memory_print("%s", name), kinds[sgt_analysis_column(l->of, i)->kind]};
}

typedef const char *code_word(int code);
static code_word *word_of(const sgt_column *c)
{
    return c->kind == SGT_COLUMN_VERDICT    ? sgt_limit_verdict_text
           : c->kind == SGT_COLUMN_QUANTITY ? sgt_prove_quantity_text
                                            : sgt_study_fate_text;
}

/* What put_column prints. */
static table_member member_of(const sgt_column *c)
{
    static const member_kind kinds[] = {
        [SGT_COLUMN_NUMBER] = MEMBER_NUMBER, [SGT_COLUMN_EXACT] = MEMBER_NUMBER,
        [SGT_COLUMN_ERROR] = MEMBER_NUMBER,  [SGT_COLUMN_WAVELENGTH] = MEMBER_NUMBER,
        [SGT_COLUMN_COUNT] = MEMBER_COUNT,   [SGT_COLUMN_PLACE] = MEMBER_COUNT,
        [SGT_COLUMN_WHOLE] = MEMBER_WHOLE,   [SGT_COLUMN_FATE] = MEMBER_CODE,
        [SGT_COLUMN_VERDICT] = MEMBER_CODE,   [SGT_COLUMN_QUANTITY] = MEMBER_CODE};
    return (table_member){.kind = kinds[c->kind], .offset = c->offset, .word = word_of(c),
                          .zero = c->kind == SGT_COLUMN_WAVELENGTH ? "all"
                                  : c->kind == SGT_COLUMN_PLACE    ? ""
                                                                   : NULL};
}

static void begin_table(printing *p)
{
    look *l = p->look;
    char name[32], unit[32];
    column *head = memory_take(l->of->columns + 1, sizeof *head), *first = head;
    const char **units = memory_take(l->of->columns + 1, sizeof *units), **first_unit = units;
    if (l->over) *head++ = (column){"at", COLUMN_NUMBER}, *units++ = "";
    p->place = memory_take(l->of->columns, sizeof *p->place);
    p->unit = units;
    p->column = memory_take(l->of->columns, sizeof *p->column);
    p->member = memory_take(l->of->columns, sizeof *p->member);
    p->text = l->shared.target.format == TABLE_TEXT && !l->shared.target.columns;
    p->wavelength = sgt_analysis_column(l->of, look_column(l, "wavelength"));
    for (size_t i = 0; i < l->of->columns; i++) {
        if (!sgt_study_column(l->study, l->of, l->options, i, name, unit)) continue;
        if (p->text && sgt_analysis_column(l->of, i)->flags & SGT_COLUMN_DETAIL) continue;
        head[p->count] = head_of(l, i, unit), units[p->count] = memory_print("%s", unit);
        p->column[p->count] = sgt_analysis_column(l->of, i);
        p->member[p->count] = member_of(p->column[p->count]);
        p->place[p->count++] = i;
    }
    l->shared.target.unit = first_unit;
    l->table = table_begin(&l->shared.target, p->count + l->over, first);
}

/* In text a number that rounding alone may have made is 0. */
static void keep_row(look *l, const void *row)
{
    const size_t size = l->of->row_size;
    if (l->rows == l->room) l->room = 2 * l->room + 64, l->row = memory_grow(l->row, l->room, size);
    if (l->over) {
        l->row_at = memory_room(l->row_at, l->rows, &l->row_at_room, sizeof *l->row_at);
        l->row_at[l->rows] = l->at;
    }
    memcpy(l->row + l->rows++ * size, row, size);
}

static void keep_any_row(void *context, const void *row) { keep_row(context, row); }

look look_again(const look *l, const char *analysis)
{
    look other = *l;
    sgt_error e;
    other.of = sgt_analysis_named(analysis), other.row = NULL, other.rows = other.room = 0;
    const sgt_sink sink = {.context = &other, .row = keep_any_row};
    if (!sgt_study_run(l->study, other.of, l->options, &sink, NULL, &e)) refuse(l, &e);
    return other;
}

static void note_sentence(void *context, sgt_remark_of_study kind, const char *sentence)
{
    (void)context;
    if (kind == SGT_STUDY_NOTE) note("%s", sentence);
}

/* --proof all: the same rays beside the proof, whose notes say what they miss.  And a line under the table.
 */
static void hold_against_proof(look *l)
{
    look other = *l;
    sgt_error e;
    double undecided = 0;
    size_t missed = 0;
    if (shard_is()) return;
    other.of = sgt_analysis_named("prove_samples"), other.row = NULL, other.rows = other.room = 0;
    const sgt_sink sink = {.context = &other, .row = keep_any_row, .say = note_sentence};
    if (!sgt_study_run(l->study, other.of, NULL, &sink, NULL, &e)) refuse(&other, &e);
    for (size_t i = 0; i < other.rows; i++) {
        const sgt_prove_sample_row *r = look_row(&other, i);
        undecided = fmax(undecided, r->undecided), missed += r->missed;
    }
    if (missed)
        table_line(
            l->table,
            "These rays miss something, as the notes say; sagitta prove tells what is true of every ray.");
    else
        table_line(l->table,
                   "Held against every ray of the pupil%s: no region of it is lost where none of these fell, "
                   "and the "
                   "worst ray that was found is not 1.1 times theirs.",
                   undecided > 0 ? memory_print(" but %.2g %% of it", undecided) : "");
}

static void put_double(const printing *p, const sgt_column *c, const void *row)
{
    const double x = number_at(row, c->offset), error = c->error ? number_at(row, c->error) : 0;
    table *t = p->look->table;
    if (isnan(x)) table_empty(t);
    else table_number(t, p->look->shared.target.format == TABLE_TEXT && fabs(x) <= error ? 0 : x);
}

static void put_column(const printing *p, const sgt_column *c, const void *row)
{
    table *t = p->look->table;
    switch (c->kind) {
    case SGT_COLUMN_NUMBER:
    case SGT_COLUMN_EXACT:
    case SGT_COLUMN_ERROR: put_double(p, c, row); return;
    case SGT_COLUMN_WAVELENGTH:
        if (number_at(row, c->offset) != SGT_ALL_WAVELENGTHS) put_double(p, c, row);
        else if (p->look->shared.target.format == TABLE_NPY) table_empty(t); /* a NaN */
        else table_word(t, "all");
        return;
    case SGT_COLUMN_COUNT: table_count(t, (long long)count_at(row, c->offset)); return;
    case SGT_COLUMN_WHOLE: table_count(t, (long long)number_at(row, c->offset)); return;
    case SGT_COLUMN_PLACE:
        if (count_at(row, c->offset)) table_count(t, (long long)count_at(row, c->offset));
        else table_empty(t);
        return;
    case SGT_COLUMN_FATE:
    case SGT_COLUMN_VERDICT:
    case SGT_COLUMN_QUANTITY:
        table_code(t, fate_at(row, c->offset), word_of(c)(fate_at(row, c->offset)));
        return;
    }
}

static bool new_group(const printing *p, const void *row)
{
    for (size_t i = 0; i < p->count && p->before; i++) {
        if (!(p->column[i]->flags & SGT_COLUMN_GROUPS)) continue;
        const double one = look_value(p->look, p->before, p->place[i]);
        const double other = look_value(p->look, row, p->place[i]);
        if (one != other && !(isnan(one) && isnan(other))) return true;
    }
    return false;
}

static void print_row(void *context, const void *row)
{
    printing *p = context;
    look *l = p->look;
    const size_t size = l->of->row_size;
    if (l->picture || p->way->end) keep_row(l, row);
    if (!l->over && table_put_members(l->table, p->member, row)) return;
    const bool together = p->wavelength && number_at(row, p->wavelength->offset) == SGT_ALL_WAVELENGTHS;
    if (together && l->bands == 1 && l->shared.target.format == TABLE_TEXT) return;
    if (new_group(p, row)) table_gap(l->table);
    if (l->over) table_number(l->table, l->at);
    for (size_t i = 0; i < p->count; i++) put_column(p, p->column[i], row);
    if (!p->before) p->before = memory_take(size, 1);
    memcpy(p->before, row, size);
}

static void take_sentence(void *context, sgt_remark_of_study kind, const char *sentence)
{
    printing *p = context;
    if (p->look->step) return; /* it was said at the first */
    if (kind == SGT_STUDY_NOTE) {
        note("%s", sentence);
        size_t number;
        if (!p->chief && strstr(sentence, "the chief ray does not get through") &&
            sscanf(sentence, "field %zu", &number) == 1)
            note("sagitta diagnose %s %s --chief shows why", p->look->job.lens,
                 look_field_words(p->look, number)), p->chief = true;
        return;
    }
    p->legend = memory_grow(p->legend, p->legends + 1, sizeof *p->legend);
    p->legend[p->legends++] = memory_print("%s", sentence);
}

static void keep_ends(void *context, size_t field, size_t surface, size_t wavelength, size_t count,
                      const sgt_ray_end end[])
{
    const printing *p = context;
    look *l = p->look;
    look_ends *e = &l->ends[(field * l->surfaces + surface) * l->bands + wavelength];
    if (count > LOOK_ENDS - e->count) count = LOOK_ENDS - e->count;
    if (e->count + count > e->room) {
        e->room = 2 * e->room + count;
        e->end = memory_grow(e->end, e->room, sizeof *e->end);
    }
    memcpy(e->end + e->count, end, count * sizeof *end);
    e->count += count;
}

static void add_fates(sgt_fates *sum, const sgt_fates *f)
{
    sum->rays += f->rays, sum->passed += f->passed, sum->missed += f->missed, sum->clipped += f->clipped;
    sum->tir += f->tir, sum->lost += f->lost, sum->none += f->none, sum->proven += f->proven;
    sum->evanescent += f->evanescent;
}

/* The study at each value of the number, each of a copy of the lens. */
static void run_over(look *l, const job_points_asked *points, printing *p, const sgt_sink *sink, int *threads)
{
    const look_over *over = p->way->over;
    const int steps = *over->steps;
    sgt_lens *base = lens_open(l->job.lens);
    sgt_fates sum = {.rays = 0};
    sgt_error e;
    if (isnan(*over->from) || isnan(*over->to)) fail_usage("--over goes with --from and --to");
    for (int i = 0; i < steps; i++) {
        l->at = i + 1 == steps ? *over->to : *over->from + (*over->to - *over->from) * i / (steps - 1);
        l->job.of = sgt_lens_copy(base, &e);
        if (!l->job.of || !sgt_lens_set(lens_keep(l->job.of), *over->path, l->at, &e)) lens_refuse(&e);
        free_study(), studies[0] = NULL;
        begin_study(l, points, threads);
        if (i == 0) shard_begin(), begin_table(p);
        l->step = (size_t)i;
        lens_note_no_ranges();
        if (!sgt_study_run(l->study, l->of, l->options, sink, &l->total, &e)) refuse(l, &e);
        add_fates(&sum, &l->total.fates);
    }
    l->total.fates = sum;
}

/* Has the lens of this configuration the same columns as the first? */
static void check_columns(const printing *p, size_t number)
{
    const look *l = p->look;
    char name[32], unit[32];
    for (size_t i = 0, k = 0; i < l->of->columns; i++) {
        const bool there = sgt_study_column(l->study, l->of, l->options, i, name, unit);
        const bool was = k < p->count && p->place[k] == i;
        if (p->text && sgt_analysis_column(l->of, i)->flags & SGT_COLUMN_DETAIL) continue;
        if (there != was || (was && strcmp(p->unit[k], unit) != 0))
            fail_usage("--configuration all: configuration %zu has other columns or units than the first; "
                       "ask for it alone", number);
        k += was;
    }
}

/* The study of each configuration. */
static exit_status run_each(look *l, const lens_each *all, const job_points_asked *points, printing *p,
                            const sgt_sink *sink, int *threads)
{
    sgt_fates sum = {.rays = 0};
    exit_status worst = EXIT_DECIDED;
    sgt_error e;
    for (size_t i = 0; i < all->count; i++) {
        l->job.of = all->at[i];
        free_study(), studies[0] = NULL;
        begin_study(l, points, threads);
        if (i == 0) shard_begin(), begin_table(p);
        else check_columns(p, i + 1), table_gap(l->table);
        l->step = i, l->rows = 0, p->before = NULL;
        table_lead(l->table, i + 1);
        if (!sgt_study_run(l->study, l->of, l->options, sink, &l->total, &e)) refuse(l, &e);
        add_fates(&sum, &l->total.fates);
        if (!p->way->end || shard_is()) continue;
        table_line(l->table, "Configuration %zu%s%s:", i + 1, *all->name[i] ? ", " : "", all->name[i]);
        const exit_status status = p->way->end(l);
        if (status > worst) worst = status;
    }
    l->total.fates = sum;
    return worst;
}

exit_status look_run(const command *c, const look_way *way, int argc, char *argv[])
{
    look l = {.of = sgt_analysis_named(way->over ? way->over->analysis : c->name), .over = way->over};
    printing p = {.look = &l, .way = way};
    sgt_sink sink = {.context = &p, .row = print_row, .say = take_sentence};
    sgt_error e;
    int threads;
    if (!l.of) fail_usage("--figure: there is no analysis \"%s\"; see sagitta --help", way->over->analysis);
    take_options(&l, c, way, argc, argv);
    job_points_asked points = {.count = 0};
    if (!l.of->no_rays) points = job_points_of(&l.job, l.of->pattern);
    if (way->check) way->check(&l);
    if (proof_of_all && (shard_count() || shard_ranks() || l.job.pupils))
        fail_usage("--proof all: not with %s",
                   l.job.pupils ? "--pupil and --chief, which are single rays" : "shards");
    if (shard_ranks()) progress_begin(0, !l.shared.target.path, l.shared.progress);
    else if (way->counted) {
        counts_tasks = asks = true;
        progress_begin(0, !l.shared.target.path, l.shared.progress), progress_of(way->counted(&l));
    }
    const lens_each all = l.over ? (lens_each){.count = 0} : lens_open_each(l.job.lens);
    l.shared.target.leads = all.count;
    if (all.count && l.picture)
        fail_usage("--picture: shows one configuration; give its number or name, not --configuration all");
    exit_status worst = EXIT_DECIDED;
    if (all.count) {
        worst = run_each(&l, &all, &points, &p, &sink, &threads);
    } else if (l.over) {
        run_over(&l, &points, &p, &sink, &threads);
    } else {
        begin_study(&l, &points, &threads);
        if (l.picture && way->ends) {
            const sgt_list *defocus =
                (const void *)((const char *)l.options + offsetof(sgt_spot_options, defocus));
            l.surfaces = defocus->count ? defocus->count : 1;
            l.ends = memory_take(l.fields.count * l.surfaces * l.bands, sizeof *l.ends);
            sink.ends = keep_ends, sink.ends_most = LOOK_ENDS;
        }
        shard_begin();
        begin_table(&p);
        if (!sgt_study_run(l.study, l.of, l.options, &sink, &l.total, &e)) refuse(&l, &e);
    }
    shard_end();
    if (shard_is() && counts_tasks) progress_end();
    if (shard_is()) return EXIT_DECIDED;
    if (counts_tasks) count_tasks(0), progress_end();
    if (shard_ranks()) progress_rays(l.total.fates.rays), progress_end();
    for (size_t i = 0; i < p.legends; i++) table_line(l.table, "%s", p.legend[i]);
    if (proof_of_all) hold_against_proof(&l);
    if (all.count) table_line(l.table, "%s", lens_each_line(&all));
    const exit_status status = way->end && !all.count ? way->end(&l) : worst;
    if (!way->end) look_verdict(&l);
    table_end(l.table);
    if (l.picture && way->draw) way->draw(&l);
    else if (l.picture) look_draw_curves(&l);
    return way->end ? status : l.total.fates.lost ? EXIT_UNDECIDED : EXIT_DECIDED;
}

static exit_status run_plain(const command *c, int argc, char *argv[])
{
    return look_run(c, &(look_way){.draw = NULL}, argc, argv);
}

command look_command(const sgt_analysis *a)
{
    const char *often = "";
    for (size_t i = 0; i < a->settings; i++) often = memory_print("%s%s ", often, a->setting[i].name);
    return (command){
        .name = a->name, .brief = a->title, .run = run_plain,
        .often = memory_print("%sfields field hexapolar grid wavelength picture proof format output", often),
        .examples = memory_print("  sagitta %s examples/lenses/cooke_triplet.yaml\n"
                              "  sagitta %s examples/lenses/cooke_triplet.yaml --picture %s.svg\n",
                              a->name, a->name, a->name)};
}
