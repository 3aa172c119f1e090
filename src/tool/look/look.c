/* look.c - options into a study, and its rows into a table. */
#include "look.h"

#include "../base/input.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../base/tiles.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------- options */

/* The options of getopt_long, and what each of an analysis is: a setting, or a view. */
typedef struct known_options {
    struct option *option;
    size_t count;
    const sgt_setting **setting; /* [settings] */
    size_t settings;
} known_options;

enum { PICTURE = OPTION_AFTER_JOB, OWN, VIEW, SETTING = VIEW + 100 };

static void know_settings(known_options *k, const sgt_analysis *a)
{
    for (size_t i = 0; i < a->settings; i++) {
        const sgt_setting *s = &a->setting[i];
        bool known = false;
        for (size_t j = 0; j < k->settings; j++) known = known || strcmp(k->setting[j]->name, s->name) == 0;
        if (known) continue;
        k->option[k->count++] = (struct option){
            s->name, s->kind == SGT_SETTING_FLAG ? no_argument : required_argument, NULL,
            SETTING + (int)k->settings};
        k->setting[k->settings++] = s;
    }
}

static known_options options_of(const sgt_analysis *a, const look_way *way)
{
    static const struct option shared[] = {{"picture", required_argument, NULL, PICTURE},
                                           JOB_OPTIONS,
                                           PROOF_OPTION,
                                           THREADS_OPTION,
                                           ROWS_OPTIONS,
                                           SHARED_OPTIONS};
    enum { SHARED = sizeof shared / sizeof *shared, MORE = 100 };
    known_options k = {.option = memory_take(SHARED + MORE, sizeof *k.option),
                       .setting = memory_take(MORE, sizeof *k.setting)};
    know_settings(&k, a);
    for (const look_view *v = way->view; v && v->option; v++) {
        k.option[k.count++] = (struct option){v->option, v->setting ? required_argument : no_argument, NULL,
                                              VIEW + (int)(v - way->view)};
        know_settings(&k, sgt_analysis_named(v->analysis));
    }
    if (way->own) k.option[k.count++] = (struct option){way->own, required_argument, NULL, OWN};
    memcpy(k.option + k.count, shared, sizeof shared);
    return k;
}

typedef struct given { const sgt_setting *setting; const char *value; } given;

/* "tan or theta", "a, b or c" */
static const char *words_or(const char *words)
{
    char text[200];
    size_t n = 0;
    for (const char *w = words; *w && n + 8 < sizeof text; w++) {
        if (*w != '|') text[n++] = *w;
        else n += (size_t)snprintf(text + n, sizeof text - n, "%s", strchr(w + 1, '|') ? ", " : " or ");
    }
    text[n] = 0;
    return look_text("%s", text);
}

static int word_place(const sgt_setting *s, const char *value)
{
    const size_t length = strlen(value);
    int place = 0;
    for (const char *w = s->words; w; w = strchr(w, '|') ? strchr(w, '|') + 1 : NULL, place++)
        if (strcspn(w, "|") == length && strncmp(w, value, length) == 0) return place;
    fail_usage("--%s must be %s, not \"%s\"", s->name, words_or(s->words), value);
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
    case SGT_SETTING_WORD: *(int *)(void *)to = word_place(s, value); return;
    case SGT_SETTING_NUMBER:
    case SGT_SETTING_NUMBERS:
        *(sgt_list *)(void *)to = numbers_of(s, *(sgt_list *)(void *)to, value);
        return;
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
        if (strcmp(a->setting[i].name, name) == 0) return &a->setting[i];
    return NULL;
}

static const char *view_with(const look_way *way, const char *setting)
{
    for (const look_view *v = way->view; v && v->option; v++)
        if (setting_named(sgt_analysis_named(v->analysis), setting))
            return look_text("--%s%s", v->option, v->setting ? " N" : "");
    return "";
}

static void take_options(look *l, const look_way *way, int argc, char *argv[])
{
    const known_options k = options_of(l->of, way);
    const look_view *view = NULL;
    const char *view_value = NULL;
    given *all = memory_take((size_t)argc, sizeof *all);
    size_t count = 0;
    for (int code; (code = getopt_long(argc, argv, ROWS_LETTERS, k.option, NULL)) != -1;) {
        l->shared.scales = true;
        if (code == PICTURE) {
            chart_check("picture", optarg);
            l->picture = optarg;
        } else if (code == OWN) {
            if (!way->take_own(optarg))
                fail_usage("--%s must be %s, not \"%s\"", way->own, way->own_words, optarg);
        } else if (code >= SETTING) {
            all[count++] = (given){k.setting[code - SETTING], optarg};
        } else if (code >= VIEW) {
            const look_view *v = way->view + (code - VIEW);
            if (view && view != v) fail_usage("give --%s or --%s, not both", view->option, v->option);
            view = v, view_value = optarg;
        } else if (!job_take(&l->job, code)) {
            options_take(&l->shared, code, look_help(l, way));
        }
    }
    if (view) l->of = sgt_analysis_named(view->analysis);
    l->options = memory_take(l->of->options_size + 1, 1);
    l->set = memory_take(count + 1, sizeof *l->set);
    if (view && view->setting)
        take_setting(l, setting_named(l->of, view->setting), view->option, view_value);
    for (size_t i = 0; i < count; i++) {
        const char *name = all[i].setting->name;
        const sgt_setting *s = setting_named(l->of, name);
        if (!s) fail_usage("--%s goes with %s", name, view_with(way, name));
        take_setting(l, s, name, all[i].value);
    }
}

static void take_lens(look *l, int argc, char *argv[])
{
    const char *name = l->of->part_of ? l->of->part_of : l->of->name;
    job_options *o = &l->job;
    if (optind == argc) fail_usage("the lens file is missing: sagitta %s LENS", name);
    if (optind + 1 < argc)
        fail_usage("unexpected argument \"%s\"; %s takes one lens file", argv[optind + 1], name);
    if (o->rays) fail_usage("--rays: %s launches the rays of fields; sagitta trace takes a file", name);
    if (o->skip_bad) fail_usage("--skip-bad goes with --rays; %s launches the rays of fields", name);
    if (l->of->no_fields && (o->fields || o->numbers))
        fail_usage("--field, --fields: %s takes --from and --to", name);
    if (l->of->no_rays && (o->pupils || o->pattern_given || o->across))
        fail_usage("a pattern of rays is of no use here: the rays are those near the chief ray");
    if (l->of->no_rays && l->shared.solver.proof)
        fail_usage("--proof: %s follows chief rays and proves nothing; spot, fan, opd, map and sweep do",
                   name);
    o->lens = argv[optind], o->several = true;
    if (!l->of->primary_alone && !o->wavelengths) o->all_wavelengths = true;
    if (!l->picture) return;
    if (l->shared.target.path) output_check("output", l->shared.target.path);
    output_reserve("picture", l->picture);
}

/* ------------------------------------------------------------------ the study */

static void in_threads(void *context, size_t tasks, void (*task)(void *data, size_t i), void *data)
{
    const int threads = *(const int *)context;
    (void)threads; /* unused without OpenMP */
    THREADS(omp parallel for schedule(dynamic) num_threads(threads))
    for (size_t i = 0; i < tasks; i++) task(data, i);
}

static sgt_study *studies[1];

static void free_study(void) { sgt_study_free(studies[0]); }

/* A fault of a setting or of the points is one of the arguments. */
_Noreturn static void refuse(const look *l, const sgt_lens_error *e)
{
    if (!e->line && (setting_named(l->of, e->key) || strcmp(e->key, "rays") == 0))
        fail_usage("--%s: %s", e->key, e->words);
    if (strcmp(e->key, "wavelengths") == 0 && strstr(e->words, "give a wavelength"))
        fail_usage("%s: %s", e->file, e->words);
    lens_refuse(e);
}

static void begin_study(look *l, const job_points_asked *points, int *threads)
{
    const job_options *o = &l->job;
    sgt_lens_error e;
    sgt_lens *of;
    const lens_list lenses = job_lenses(o);
    l->band = lenses.lens, l->bands = lenses.count, of = lenses.lens[0].of;
    l->primary = of->wavelength ? lens_at(of, (lens_wavelength){.um = (double)NAN}) : lenses.lens[0];
    l->fields = job_fields(o, &l->primary);
    l->um = sgt_lens_unit(of);
    options_note_unread(&l->shared, l->primary.count, l->primary.element);
    size_t *number = memory_take(l->fields.count, sizeof *number);
    sgt_wavelength *wavelength = memory_take(l->bands, sizeof *wavelength);
    for (size_t i = 0; i < l->fields.count; i++) number[i] = l->fields.number[i] + 1;
    for (size_t i = 0; i < l->bands; i++)
        wavelength[i] = (sgt_wavelength){l->band[i].chosen, l->band[i].wavelength};
    *threads = options_threads(&l->shared);
    /* (A picture may ask another analysis for the same points.) */
    const bool fixed = l->picture && l->of->part_of;
    const bool by_default = !points->pattern_given && !points->rays && !points->across;
    const sgt_study_options options = {
        .aim = job_aim(o, of), .solver = &l->shared.solver, .open = o->no_apertures,
        .fields = o->fields || o->numbers ? l->fields.count : 0, .field = o->fields ? NULL : number,
        .field_at = l->fields.at, .field_kind = &l->fields.kind,
        .wavelengths = of->wavelength || o->wavelengths ? l->bands : 0, .wavelength = wavelength,
        .pattern = points->pattern_given || fixed ? &points->pattern : NULL,
        .rays = fixed && by_default ? l->of->rays : points->rays,
        .across = points->across, .seed = points->seed, .points = points->count, .point = points->at,
        .run = *threads > 1 ? in_threads : NULL, .context = threads};
    l->study = studies[0] = sgt_study_new(of, &options, &e);
    if (!l->study) lens_refuse(&e);
    atexit(free_study);
}

/* ---------------------------------------------------------------------- rows */

size_t look_column(const look *l, const char *name)
{
    size_t i = 0;
    while (i < l->of->columns && strcmp(l->of->column[i].name, name) != 0) i++;
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
    const sgt_column *c = &l->of->column[place];
    return c->kind == SGT_COLUMN_COUNT || c->kind == SGT_COLUMN_PLACE ? (double)count_at(row, c->offset)
           : c->kind == SGT_COLUMN_FATE                               ? fate_at(row, c->offset)
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
    bool text;                  /* for people, in the columns by default */
    size_t wavelength;          /* its column; of->columns: there is none */
    char *before;               /* the row before; NULL: none yet */
    const char **legend;
    size_t legends;
} printing;

static column head_of(const look *l, size_t i, char unit[32])
{
    static const column_kind kinds[] = {
        [SGT_COLUMN_NUMBER] = COLUMN_NUMBER, [SGT_COLUMN_EXACT] = COLUMN_EXACT,
        [SGT_COLUMN_ERROR] = COLUMN_ERROR,   [SGT_COLUMN_WAVELENGTH] = COLUMN_EXACT,
        [SGT_COLUMN_COUNT] = COLUMN_COUNT,   [SGT_COLUMN_PLACE] = COLUMN_COUNT,
        [SGT_COLUMN_WHOLE] = COLUMN_COUNT,   [SGT_COLUMN_FATE] = COLUMN_CODE};
    char name[32];
    sgt_study_column(l->study, l->of, l->options, i, name, unit);
    return (column){look_text("%s", name), kinds[l->of->column[i].kind]};
}

static void begin_table(printing *p)
{
    look *l = p->look;
    char name[32], unit[32];
    column *head = memory_take(l->of->columns, sizeof *head);
    const char **units = memory_take(l->of->columns, sizeof *units);
    p->place = memory_take(l->of->columns, sizeof *p->place);
    p->text = l->shared.target.format == TABLE_TEXT && !l->shared.target.columns;
    p->wavelength = look_column(l, "wavelength");
    for (size_t i = 0; i < l->of->columns; i++) {
        if (!sgt_study_column(l->study, l->of, l->options, i, name, unit)) continue;
        if (p->text && l->of->column[i].flags & SGT_COLUMN_DETAIL) continue;
        head[p->count] = head_of(l, i, unit), units[p->count] = look_text("%s", unit);
        p->place[p->count++] = i;
    }
    l->shared.target.unit = units;
    l->table = table_begin(&l->shared.target, p->count, head);
}

/* In text a number that rounding alone may have made is 0. */
static void keep_row(look *l, const void *row)
{
    const size_t size = l->of->row_size;
    if (l->rows == l->room) l->room = 2 * l->room + 64, l->row = memory_grow(l->row, l->room, size);
    memcpy(l->row + l->rows++ * size, row, size);
}

static void keep_any_row(void *context, const void *row) { keep_row(context, row); }

look look_again(const look *l, const char *analysis)
{
    look other = *l;
    sgt_lens_error e;
    other.of = sgt_analysis_named(analysis), other.row = NULL, other.rows = other.room = 0;
    const sgt_sink sink = {.context = &other, .row = keep_any_row};
    if (!sgt_study_run(l->study, other.of, l->options, &sink, NULL, &e)) refuse(l, &e);
    return other;
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
        table_code(t, fate_at(row, c->offset), sgt_study_fate_text(fate_at(row, c->offset)));
        return;
    }
}

static bool new_group(const printing *p, const void *row)
{
    const sgt_analysis *a = p->look->of;
    for (size_t i = 0; i < p->count && p->before; i++) {
        const sgt_column *c = &a->column[p->place[i]];
        if (!(c->flags & SGT_COLUMN_GROUPS)) continue;
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
    if (l->picture) keep_row(l, row);
    const bool together = p->wavelength < l->of->columns &&
                          number_at(row, l->of->column[p->wavelength].offset) == SGT_ALL_WAVELENGTHS;
    if (together && l->bands == 1 && l->shared.target.format == TABLE_TEXT) return;
    if (new_group(p, row)) table_gap(l->table);
    for (size_t i = 0; i < p->count; i++) put_column(p, &l->of->column[p->place[i]], row);
    if (!p->before) p->before = memory_take(size, 1);
    memcpy(p->before, row, size);
}

static void take_sentence(void *context, sgt_remark_of_study kind, const char *sentence)
{
    printing *p = context;
    if (kind == SGT_STUDY_NOTE) {
        note("%s", sentence);
        return;
    }
    p->legend = memory_grow(p->legend, p->legends + 1, sizeof *p->legend);
    p->legend[p->legends++] = look_text("%s", sentence);
}

static void keep_ends(void *context, size_t field, size_t surface, size_t wavelength, size_t count,
                      const sgt_ray_end end[])
{
    const printing *p = context;
    look *l = p->look;
    look_ends *e = &l->ends[(field * l->surfaces + surface) * l->bands + wavelength];
    if (e->count + count > e->room) {
        e->room = 2 * e->room + count;
        e->end = memory_grow(e->end, e->room, sizeof *e->end);
    }
    memcpy(e->end + e->count, end, count * sizeof *end);
    e->count += count;
}

exit_status look_run(const char *analysis, const look_way *way, int argc, char *argv[])
{
    look l = {.of = sgt_analysis_named(analysis)};
    printing p = {.look = &l, .way = way};
    sgt_sink sink = {.context = &p, .row = print_row, .say = take_sentence};
    sgt_lens_error e;
    int threads;
    take_options(&l, way, argc, argv);
    take_lens(&l, argc, argv);
    job_points_asked points = {.count = 0};
    if (!l.of->no_rays) points = job_points_of(&l.job, l.of->pattern);
    if (way->check) way->check(&l);
    begin_study(&l, &points, &threads);
    if (l.picture && way->ends) {
        const sgt_list *defocus =
            (const void *)((const char *)l.options + offsetof(sgt_spot_options, defocus));
        l.surfaces = defocus->count ? defocus->count : 1;
        l.ends = memory_take(l.fields.count * l.surfaces * l.bands, sizeof *l.ends);
        sink.ends = keep_ends;
    }
    begin_table(&p);
    if (!sgt_study_run(l.study, l.of, l.options, &sink, &l.total, &e)) refuse(&l, &e);
    for (size_t i = 0; i < p.legends; i++) table_line(l.table, "%s", p.legend[i]);
    look_verdict(&l);
    table_end(l.table);
    if (l.picture && way->draw) way->draw(&l);
    else if (l.picture) look_draw_curves(&l);
    return l.total.fates.lost ? EXIT_UNDECIDED : EXIT_DECIDED;
}
