// SPDX-License-Identifier: MIT
/* study_aims.c - rays that a study aims by its fitted map, against those that are searched for:
 * study_aims LENS...
 *
 * The same points of the pupil go through sgt_trace_pupil, which knows no map.  Each ray has to meet the same
 * fate, to be folded or not in both, and to end at the same place with the same path, to within the told
 * errors of both.  The map has to be in use: without one no end differs in a bit, so a tenth of them has
 * to. */
#include <sagitta/study.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ACROSS = 40 };

typedef struct kept_rows { size_t count, room; sgt_ends_row *row; } kept_rows;

static void keep_row(void *context, const void *row)
{
    kept_rows *k = context;
    if (k->count == k->room) {
        k->room = 2 * k->room + 1000;
        k->row = realloc(k->row, k->room * sizeof *k->row);
        if (!k->row) exit(2);
    }
    memcpy(&k->row[k->count++], row, sizeof *k->row);
}

/* How many times the told errors two ends are apart; 0 where neither is told. */
static double apart(const sgt_ray_end *a, const sgt_ray_end *b)
{
    const double point = hypot(a->p.x - b->p.x, a->p.y - b->p.y), path = fabs(a->opl - b->opl);
    const double by_point = point == 0 ? 0 : point / (a->p_err + b->p_err);
    const double by_path = path == 0 ? 0 : path / (a->opl_err + b->opl_err);
    return a->fate == SGT_PASSED ? fmax(by_point, by_path) : 0;
}

/* The rows of a field and a wavelength; returns faults. */
static size_t compare(const sgt_lens *lens, const sgt_launcher *from, const sgt_ends_row row[], size_t count,
                      double *most, size_t *other)
{
    sgt_error error;
    sgt_field_beam beam;
    double before;
    size_t faults = 0;
    sgt_element *e = malloc(lens->count * sizeof *e);
    sgt_ray_end *end = malloc(count * sizeof *end);
    sgt_pupil_point *at = malloc(count * sizeof *at);
    if (!e || !end || !at) exit(2);
    for (size_t i = 0; i < count; i++)
        at[i] = (sgt_pupil_point){row[i].end.px, row[i].end.py, row[i].end.weight};
    if (!sgt_launch_field(from, lens->field_kind, &lens->field[row->field - 1], &beam, &error) ||
        !sgt_lens_at(lens, row->wavelength, e, &before, &error) ||
        !sgt_trace_pupil(from, &beam, e, before, &(sgt_pupil_rays){count, at, end}, NULL, &error)) {
        printf("%s\n", error.words);
        exit(1);
    }
    for (size_t i = 0; i < count; i++) {
        const sgt_ray_end *a = &row[i].end, *b = &end[i];
        const double far = apart(a, b);
        *most = fmax(*most, far), *other += memcmp(&a->p, &b->p, sizeof a->p) != 0;
        if (a->fate == b->fate && a->aimed == b->aimed && a->folded == b->folded && far <= 1) continue;
        if (faults++ == 0)
            printf("field %zu, %g: point %g %g: fates %d %d, folded %d %d, apart %g\n", row->field,
                   row->wavelength, at[i].x, at[i].y, a->fate, b->fate, a->folded, b->folded, far);
    }
    free(e), free(end), free(at);
    return faults;
}

int main(int argc, char *argv[])
{
    static const sgt_lens_aim stop = SGT_LENS_AIM_REAL_STOP;
    size_t faults = 0;
    for (int i = 1; i < argc; i++) {
        sgt_error error;
        kept_rows k = {.row = NULL};
        double most = 0;
        size_t other = 0;
        const sgt_sink sink = {.context = &k, .row = keep_row};
        const sgt_launcher_options aim = {.aim = &stop};
        sgt_lens *lens = sgt_lens_read(argv[i], NULL, &error);
        sgt_launcher *from = lens ? sgt_launcher_new(lens, &aim, &error) : NULL;
        sgt_study *study =
            from ? sgt_study_new(lens, &(sgt_study_options){.aim = &stop, .across = ACROSS}, &error) : NULL;
        if (!study || !sgt_study_run(study, sgt_analysis_named("ends"), NULL, &sink, NULL, &error)) {
            printf("%s: %s\n", argv[i], error.words);
            return 1;
        }
        for (size_t first = 0, end; first < k.count; first = end) {
            for (end = first; end < k.count && k.row[end].field == k.row[first].field &&
                              k.row[end].wavelength == k.row[first].wavelength;)
                end++;
            faults += compare(lens, from, k.row + first, end - first, &most, &other);
        }
        printf("%s: %zu rays, %zu with other bits, %.3g of the errors apart\n", argv[i], k.count, other,
               most);
        if (10 * other < k.count) faults++, printf("no map?\n");
        sgt_study_free(study), sgt_launcher_free(from), sgt_lens_free(lens);
        free(k.row);
    }
    printf("%zu faults\n", faults);
    return faults || argc < 2;
}
