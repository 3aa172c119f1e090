// SPDX-License-Identifier: MIT
/* spots.c - the spots of a lens file, by study.h: the numbers of `sagitta spot LENS`, to the last bit.
 *
 *     spots LENS */
#include <sagitta/study.h>

#include <stdio.h>

static void print_spot(void *context, const void *row)
{
    const sgt_spot_row *spot = row;
    (void)context;
    if (spot->wavelength == SGT_ALL_WAVELENGTHS) return; /* this lens has one */
    printf("field %zu: %zu of %zu rays passed, rms %.9g, %zu digits\n", spot->field, spot->passed, spot->rays,
           spot->rms, spot->digits);
}

int main(int argc, char *argv[])
{
    sgt_error error = {.line = 0};
    sgt_lens *lens = argc > 1 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    sgt_study *study = lens ? sgt_study_new(lens, NULL, &error) : NULL;
    const sgt_sink sink = {.row = print_spot};
    bool fine = study && sgt_study_run(study, sgt_analysis_named("spot"), NULL, &sink, NULL, &error);
    if (!fine)
        fprintf(stderr, "%s:%zu: %s: %s\n", error.file, error.line, error.key,
                argc > 1 ? error.words : "usage: spots LENS");
    sgt_study_free(study);
    sgt_lens_free(lens);
    return fine ? 0 : 1;
}
