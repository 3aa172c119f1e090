/* doors.c - spots, fans, sweeps and curves of a lens as a program of C asks for them, in hexadecimal, for
 * test_doors.py: doors LENS. */
#include <sagitta/study.h>

#include <stdio.h>

static void spot(void *context, const void *row)
{
    const sgt_spot_row *r = row;
    (void)context;
    printf("spot %zx %zx %a %a %zx\n", r->field, r->rays, r->rms, r->y, r->digits);
}

static void fan(void *context, const void *row)
{
    const sgt_fan_row *r = row;
    (void)context;
    printf("fan %zx %a %a %a\n", r->field, r->px, r->ey, r->e_err);
}

static void sweep(void *context, const void *row)
{
    const sgt_sweep_row *r = row;
    (void)context;
    printf("sweep %a %zx %a\n", r->at, r->passed, r->evals);
}

static void field(void *context, const void *row)
{
    const sgt_field_row *r = row;
    (void)context;
    printf("field %zx %a %a\n", r->field, r->fy, r->distortion_percent);
}

int main(int argc, char *argv[])
{
    static const struct { const char *name; void (*row)(void *context, const void *row); } each[] = {
        {"spot", spot}, {"fan", fan}, {"sweep", sweep}, {"field", field}};
    sgt_error error = {.line = 0};
    sgt_lens *lens = argc == 2 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    const sgt_study_options few = {.rays = 3};
    sgt_study *study = lens ? sgt_study_new(lens, &few, &error) : NULL;
    bool fine = study;
    for (size_t i = 0; i < sizeof each / sizeof *each && fine; i++) {
        const sgt_sink sink = {.row = each[i].row};
        fine = sgt_study_run(study, sgt_analysis_named(each[i].name), NULL, &sink, NULL, &error);
    }
    if (!fine) fprintf(stderr, "%s:%zu: %s: %s\n", error.file, error.line, error.key, error.words);
    sgt_study_free(study);
    sgt_lens_free(lens);
    return fine ? 0 : 1;
}
