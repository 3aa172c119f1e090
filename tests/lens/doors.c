// SPDX-License-Identifier: MIT
/* doors.c - any analysis of a lens as a program of C asks for it, for test_doors.py: doors LENS.
 *
 * Each line of standard input is a question:
 *
 *     first_order WAVELENGTH                           micrometres, or nan: the primary one; also parabasal
 *     room ANALYSIS N                                  with each of the last N words of its options not zero
 *     figure KIND RAYS PATH...                         residuals and values at the lens, and derivatives
 *     tolerance FIGURE RAYS TRIALS                     sensitivity, then so many trials
 *     ANALYSIS FIELDS WAVELENGTHS RAYS [weights=equal] [SETTING=X,X...]...
 *
 * FIELDS and WAVELENGTHS are numbers with commas, or -: by default.  A wavelength that is not a whole number
 * is in micrometres; "all" are all.  A word is given as its place.  Columns and settings are those of the
 * library's tables, so an analysis that is added is asked like the rest.  Numbers come out as the 16 digits
 * of their bits. */
#include <sagitta/figure.h>
#include <sagitta/study.h>
#include <sagitta/tolerance.h>

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 16 };

typedef struct asked { const sgt_study *study; const sgt_analysis *of; const void *options; } asked;

static void put_double(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    if (isnan(x)) printf(" nan");
    else printf(" %016llx", (unsigned long long)bits);
}

static void put_cell(const sgt_column *c, const char *at)
{
    size_t count;
    double number;
    int fate;
    switch (c->kind) {
    case SGT_COLUMN_COUNT:
    case SGT_COLUMN_PLACE: memcpy(&count, at, sizeof count), printf(" %016zx", count); return;
    case SGT_COLUMN_VERDICT: /* ints, too */
    case SGT_COLUMN_QUANTITY:
    case SGT_COLUMN_FATE: memcpy(&fate, at, sizeof fate), printf(" %d", fate); return;
    default: memcpy(&number, at, sizeof number), put_double(number);
    }
}

static void put_row(void *context, const void *row)
{
    const asked *a = context;
    char name[32], unit[32];
    printf("row");
    for (size_t i = 0; sgt_analysis_column(a->of, i); i++) {
        const sgt_column *c = sgt_analysis_column(a->of, i);
        if (sgt_study_column(a->study, a->of, a->options, i, name, unit))
            put_cell(c, (const char *)row + c->offset);
    }
    printf("\n");
}

static void put_sentence(void *context, sgt_remark_of_study kind, const char *sentence)
{
    (void)context;
    printf("%s %s\n", kind == SGT_STUDY_NOTE ? "note" : "legend", sentence);
}

static void put_fates(const sgt_fates *f)
{
    printf("fates %zu %zu %zu %zu %zu %zu %zu %zu", f->rays, f->passed, f->missed, f->clipped, f->tir,
           f->lost, f->none, f->unfound);
    put_double(f->within);
    printf(" %zu %zu %zu\n", f->folded, f->proven, f->evanescent);
}

static void put_fault(const sgt_error *e) { printf("refused %s: %s\n", e->key, e->words); }

static size_t read_list(char *words, double at[MOST])
{
    size_t count = 0;
    for (char *rest = words; *rest && count < MOST; rest += *rest == ',')
        at[count++] = strtod(rest, &rest);
    return count;
}

/* Sets SETTING=X,X... in the options of an analysis; lists stay in `list`. */
static bool set(const sgt_analysis *of, char *options, char *words, double list[MOST])
{
    char *value = strchr(words, '=');
    const sgt_setting *s = NULL;
    for (size_t i = 0; value && (s = sgt_analysis_setting(of, i)); i++)
        if (strlen(s->name) == (size_t)(value - words) && !strncmp(s->name, words, strlen(s->name))) break;
    if (!s) return false;
    const sgt_list numbers = {read_list(value + 1, list), list};
    const bool flag = true;
    const size_t count = (size_t)list[0];
    const int word = (int)list[0];
    const char *text = value + 1;
    switch (s->kind) {
    case SGT_SETTING_FLAG: memcpy(options + s->offset, &flag, sizeof flag); break;
    case SGT_SETTING_COUNT: memcpy(options + s->offset, &count, sizeof count); break;
    case SGT_SETTING_WORD: memcpy(options + s->offset, &word, sizeof word); break;
    case SGT_SETTING_TEXT: memcpy(options + s->offset, &text, sizeof text); break;
    case SGT_SETTING_NUMBER:
    case SGT_SETTING_NUMBERS: memcpy(options + s->offset, &numbers, sizeof numbers); break;
    }
    return true;
}

static void ask(const sgt_lens *lens, const sgt_analysis *of, const sgt_study_options *how,
                const void *options)
{
    sgt_error error = {.line = 0};
    sgt_study *study = sgt_study_new(lens, how, &error);
    asked a = {study, of, options};
    const sgt_sink sink = {.context = &a, .row = put_row, .say = put_sentence};
    sgt_study_total total;
    char name[32], unit[32];
    printf("columns");
    for (size_t i = 0; study && sgt_analysis_column(of, i); i++)
        if (sgt_study_column(study, of, options, i, name, unit)) printf(" %s=%s", name, unit);
    printf("\n");
    if (!study || !sgt_study_run(study, of, options, &sink, &total, &error)) put_fault(&error);
    else put_fates(&total.fates);
    sgt_study_free(study);
}

static bool ask_analysis(const sgt_lens *lens, const sgt_analysis *of)
{
    char *fields = strtok(NULL, " "), *wavelengths = strtok(NULL, " "), *rays = strtok(NULL, " "), *words;
    double number[MOST], list[MOST][MOST];
    size_t field[MOST], settings = 0;
    sgt_wavelength wavelength[MOST];
    char *options = rays ? calloc(1, of->options_size + 1) : NULL;
    if (!options) return false;
    sgt_study_options how = {
        .rays = (size_t)strtoul(rays, NULL, 10), .field = field, .wavelength = wavelength};
    if (*fields != '-') how.fields = read_list(fields, number);
    for (size_t i = 0; i < how.fields; i++) field[i] = (size_t)number[i];
    how.every_wavelength = strcmp(wavelengths, "all") == 0;
    if (*wavelengths != '-' && !how.every_wavelength) how.wavelengths = read_list(wavelengths, number);
    for (size_t i = 0; i < how.wavelengths; i++)
        wavelength[i] = number[i] == floor(number[i]) ? (sgt_wavelength){(size_t)number[i], 0}
                                                      : (sgt_wavelength){0, number[i]};
    bool fine = true;
    while (fine && settings < MOST && (words = strtok(NULL, " "))) {
        if (strcmp(words, "weights=equal") == 0) how.equal_weights = true;
        else fine = set(of, options, words, list[settings++]);
    }
    if (fine) ask(lens, of, &how, options);
    free(options);
    return fine;
}

static bool ask_room(const sgt_lens *lens)
{
    const char *name = strtok(NULL, " "), *words = strtok(NULL, " ");
    const sgt_analysis *of = words ? sgt_analysis_named(name) : NULL;
    const size_t count = of ? (size_t)strtoul(words, NULL, 10) : 0;
    const uint64_t more = 1;
    sgt_study *study = sgt_study_new(lens, NULL, NULL);
    for (size_t i = 0; i < count; i++) {
        sgt_error error = {.line = 0};
        char *options = calloc(1, of->options_size);
        if (!options) return false;
        memcpy(options + of->options_size - (count - i) * sizeof more, &more, sizeof more);
        if (sgt_study_run(study, of, options, NULL, NULL, &error)) printf("ran\n");
        else put_fault(&error);
        free(options);
    }
    sgt_study_free(study);
    return of;
}

/* Along the chief ray of each field. */
static void put_parabasal(const sgt_lens *lens, double um)
{
    for (size_t field = 1; field <= lens->fields; field++) {
        sgt_error error = {.line = 0};
        sgt_parabasal p;
        const bool known = sgt_field_parabasal(lens, um, field, &p, &error);
        const double x[] = {p.efl[0], p.efl[1], p.focus[0], p.focus[1], p.image[0], p.image[1],
                            p.magnification[0], p.magnification[1], p.power_xy};
        printf("parabasal");
        for (size_t k = 0; k < sizeof x / sizeof *x; k++) put_double(x[k]);
        printf("\nnot_parabasal %s\n", known ? "" : error.words);
    }
}

static void put_numbers(const char *name, size_t count, const double x[])
{
    printf("%s", name);
    for (size_t i = 0; i < count; i++) put_double(x[i]);
    printf("\n");
}

static bool ask_figure(const sgt_lens *lens)
{
    const char *kind = strtok(NULL, " "), *rays = strtok(NULL, " "), *path[MOST], *word;
    size_t paths = 0;
    while (paths < MOST && (word = strtok(NULL, " "))) path[paths++] = word;
    if (!paths) return false;
    const sgt_figure_options opt = {.kind = (sgt_figure_kind)strtol(kind, NULL, 10)};
    const sgt_study_options study = {.rays = (size_t)strtoul(rays, NULL, 10)};
    sgt_error error = {.line = 0};
    sgt_figure *f = sgt_figure_new(lens, &study, &opt, paths, path, &error);
    if (!f) return put_fault(&error), true;
    const sgt_figure_count n = sgt_figure_size(f);
    double x[MOST], *room = calloc((n.residuals + 2 * n.values) * (paths + 1), sizeof *room);
    if (!room) return false;
    double *jacobian = room + n.residuals, *value = jacobian + n.residuals * paths;
    double *gradient = value + n.values;
    sgt_figure_out out = {.residual = room, .jacobian = jacobian, .value = value, .gradient = gradient};
    sgt_figure_start(f, x);
    if (sgt_figure_eval(f, x, &out, &error)) {
        put_numbers("residual", n.residuals, room), put_numbers("jacobian", n.residuals * paths, jacobian);
        put_numbers("value", n.values, value), put_numbers("gradient", n.values * paths, gradient);
    } else put_fault(&error);
    free(room);
    sgt_figure_free(f);
    return true;
}

static void put_trial(void *context, const sgt_trial *trial)
{
    put_numbers("trial", 1, &trial->figure);
    put_numbers("drawn", *(const size_t *)context, trial->value);
}

static bool ask_tolerance(const sgt_lens *lens)
{
    const char *figure = strtok(NULL, " "), *rays = strtok(NULL, " "), *trials = strtok(NULL, " ");
    if (!trials) return false;
    const sgt_study_options study = {.rays = (size_t)strtoul(rays, NULL, 10)};
    const sgt_tolerancing_options opt = {.figure = (sgt_tolerancing_figure)strtol(figure, NULL, 10),
                                         .study = &study};
    sgt_error error = {.line = 0};
    sgt_sensitivity row[MOST * MOST];
    sgt_sensitivity_sum sum;
    size_t entries = sgt_lens_tolerances(lens, NULL), count = 0;
    sgt_tolerancing *t = sgt_tolerancing_new(lens, &opt, &error);
    bool fine = t && sgt_tolerancing_sensitivity(t, &count, row, &sum, &error);
    for (size_t i = 0; i < count && fine; i++) {
        const sgt_sensitivity *r = &row[i];
        const double x[] = {r->figure_lower, r->figure_upper, r->change_lower, r->change_upper, r->worse,
                            r->compensator_lower, r->compensator_upper, r->derivative, r->linear_lower,
                            r->linear_upper, r->compensator_derivative};
        printf("entry %zu\n", r->entry), put_numbers("sensitivity", sizeof x / sizeof *x, x);
    }
    if (fine) put_numbers("sum", 3, (const double[]){sum.nominal, sum.compensated, sum.estimate});
    fine = fine && sgt_tolerancing_trials(t, 1, 0, strtoul(trials, NULL, 10), put_trial, &entries, &error);
    if (!fine) put_fault(&error);
    sgt_tolerancing_free(t);
    return true;
}

/* The members in their order. */
static bool ask_first_order(const sgt_lens *lens)
{
    static const struct { const char *name; size_t offset; } member[] = {
#define MEMBER(name) {#name, offsetof(sgt_first_order, name)}
        MEMBER(wavelength), MEMBER(power), MEMBER(efl), MEMBER(efl_image), MEMBER(ffd), MEMBER(bfd),
        MEMBER(focus), MEMBER(image), MEMBER(front_principal), MEMBER(rear_principal), MEMBER(front_nodal),
        MEMBER(rear_nodal), MEMBER(magnification), MEMBER(entrance_pupil), MEMBER(entrance_radius),
        MEMBER(exit_pupil), MEMBER(exit_radius), MEMBER(stop_radius), MEMBER(f_number),
        MEMBER(f_number_working), MEMBER(image_height), MEMBER(lagrange), MEMBER(petzval_radius),
        MEMBER(angular_magnification)
#undef MEMBER
    };
    const char *um = strtok(NULL, " ");
    sgt_error error = {.line = 0};
    sgt_first_order data;
    sgt_seidel *seidel = um ? calloc(lens->count, sizeof *seidel) : NULL;
    if (!seidel) return false;
    if (!sgt_lens_first_order(lens, strtod(um, NULL), &data, seidel, &error)) put_fault(&error);
    else {
        for (size_t i = 0; i < sizeof member / sizeof *member; i++) {
            double x;
            memcpy(&x, (const char *)&data + member[i].offset, sizeof x);
            printf("%s", member[i].name), put_double(x), printf("\n");
        }
        printf("without_vertex %016zx\n", data.without_vertex);
        for (size_t i = 0; i < lens->count; i++) {
            const double x[] = {seidel[i].spherical, seidel[i].coma, seidel[i].astigmatism, seidel[i].petzval,
                                seidel[i].distortion, seidel[i].chromatic[0], seidel[i].chromatic[1]};
            printf("seidel");
            for (size_t k = 0; k < sizeof x / sizeof *x; k++) put_double(x[k]);
            printf("\n");
        }
        printf("why_not %s\n", data.without_seidel ? data.without_seidel : "");
        put_parabasal(lens, strtod(um, NULL));
    }
    free(seidel);
    return true;
}

int main(int argc, char *argv[])
{
    sgt_error error = {.line = 0};
    sgt_lens *lens = argc == 2 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    bool fine = lens;
    if (!fine) fprintf(stderr, "%s:%zu: %s: %s\n", error.file, error.line, error.key, error.words);
    char line[1000];
    while (fine && fgets(line, sizeof line, stdin)) {
        line[strcspn(line, "\n")] = '\0';
        const char *what = strtok(line, " ");
        const sgt_analysis *of = what ? sgt_analysis_named(what) : NULL;
        fine = of                                          ? ask_analysis(lens, of)
               : what && strcmp(what, "first_order") == 0 ? ask_first_order(lens)
               : what && strcmp(what, "room") == 0        ? ask_room(lens)
               : what && strcmp(what, "figure") == 0      ? ask_figure(lens)
               : what && strcmp(what, "tolerance") == 0   ? ask_tolerance(lens)
                                                          : false;
        if (!fine) fprintf(stderr, "doors: not a question: %s\n", what ? what : "");
        printf("end\n");
    }
    sgt_lens_free(lens);
    return fine ? 0 : 1;
}
