// SPDX-License-Identifier: MIT
/* study_zernike.c - Zernike polynomials that a study fits to many rays, against sgt_zernike_fit of its path
 * differences: study_zernike LENS...
 *
 * Many rays over the whole pupil are fitted by sums about a fit of some of them, few ones by blocks.  Rays in
 * a corner of the pupil are many too, but are not like those of the sample, which is over the whole: the
 * study has to notice it.  There the polynomials are hardly independent, so that the sums would be off by
 * much more than what is allowed.  In each case the coefficients have to be those of all rays at once. */
#include <sagitta/analysis.h>
#include <sagitta/study.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TERMS = 15, ACROSS = 80, MOST_RAYS = 20 * ACROSS * ACROSS };

typedef struct kept {
    size_t rays, rows;
    sgt_opd_row ray[MOST_RAYS];
    sgt_zernike_row row[100 * TERMS];
} kept;

static void keep_ray(void *context, const void *row)
{
    kept *k = context;
    if (k->rays == MOST_RAYS) exit(2);
    memcpy(&k->ray[k->rays++], row, sizeof *k->ray);
}

static void keep_term(void *context, const void *row)
{
    kept *k = context;
    if (k->rows == sizeof k->row / sizeof *k->row) exit(2);
    memcpy(&k->row[k->rows++], row, sizeof *k->row);
}

/* How far the coefficients and the residual of a cell are off, in units of the values. */
static double apart(const sgt_opd_row ray[], size_t rays, const sgt_zernike_row term[])
{
    double coefficient[TERMS], residual, off = 0, size = 0;
    double *number = malloc(4 * rays * sizeof *number);
    if (!number) exit(2);
    for (size_t i = 0; i < rays; i++) {
        number[i] = ray[i].px, number[rays + i] = ray[i].py, number[2 * rays + i] = ray[i].opd;
        number[3 * rays + i] = 1;
        if (!isnan(ray[i].opd)) size = fmax(size, fabs(ray[i].opd));
    }
    const sgt_pupil_values at = {rays, number, number + rays, number + 2 * rays, number + 3 * rays};
    const bool fits = sgt_zernike_fit(SGT_NOLL, TERMS, &at, coefficient, &residual, NULL, NULL);
    free(number);
    if (!fits || isnan(term[0].coefficient)) return fits == !isnan(term[0].coefficient) ? 0 : HUGE_VAL;
    for (int j = 0; j < TERMS; j++) off = fmax(off, fabs(term[j].coefficient - coefficient[j]));
    return fmax(off, fabs(term[0].residual - residual)) / size;
}

static size_t compare(const char *name, const sgt_lens *lens, const sgt_study_options *o, double allowed,
                      kept *k)
{
    sgt_error error;
    const sgt_opd_options terms = {.terms = TERMS};
    const sgt_sink rays = {.context = k, .row = keep_ray}, rows = {.context = k, .row = keep_term};
    sgt_study *study = sgt_study_new(lens, o, &error);
    double most = 0;
    size_t cells = 0;
    k->rays = k->rows = 0;
    if (!study || !sgt_study_run(study, sgt_analysis_named("opd"), NULL, &rays, NULL, &error) ||
        !sgt_study_run(study, sgt_analysis_named("zernike"), &terms, &rows, NULL, &error)) {
        printf("%s: %s\n", name, error.words);
        return 1;
    }
    sgt_study_free(study);
    for (size_t first = 0, end; first < k->rays; first = end, cells++) {
        for (end = first; end < k->rays && k->ray[end].field == k->ray[first].field &&
                          k->ray[end].wavelength == k->ray[first].wavelength;)
            end++;
        if ((cells + 1) * TERMS > k->rows) return printf("%s: too few rows\n", name), 1;
        most = fmax(most, apart(k->ray + first, end - first, k->row + cells * TERMS));
    }
    printf("%s: %zu rays, %zu fits, %.2g apart\n", name, k->rays, cells, most);
    return !(most <= allowed) || cells * TERMS != k->rows || cells == 0;
}

int main(int argc, char *argv[])
{
    static const sgt_pattern grid = SGT_PATTERN_GRID;
    static sgt_pupil_point corner[ACROSS * ACROSS];
    size_t faults = 0;
    kept *k = malloc(sizeof *k);
    if (!k) return 2;
    for (size_t i = 0; i < ACROSS * ACROSS; i++) {
        const double x = (double)(i % ACROSS) / ACROSS, y = (double)(i / ACROSS) / ACROSS;
        corner[i] = (sgt_pupil_point){0.3 + 0.02 * x, 0.5 + 0.02 * y, 1};
    }
    for (int i = 1; i < argc; i++) {
        sgt_error error;
        sgt_lens *lens = sgt_lens_read(argv[i], NULL, &error);
        if (!lens) return printf("%s: %s\n", argv[i], error.words), 1;
        faults += compare("many", lens, &(sgt_study_options){.pattern = &grid, .rays = ACROSS}, 1e-11, k);
        faults += compare("few", lens, &(sgt_study_options){.pattern = &grid, .rays = 12}, 1e-12, k);
        faults += compare("a corner", lens,
                          &(sgt_study_options){.points = ACROSS * ACROSS, .point = corner}, 1e-3, k);
        sgt_lens_free(lens);
    }
    free(k);
    printf("%zu faults\n", faults);
    return faults || argc < 2;
}
