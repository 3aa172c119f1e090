/* spots.c - the spot of each field of a lens file, and its wavefront, by the functions of analysis.h.
 *
 *     spots LENS [RAYS_ACROSS] */
#include <sagitta/analysis.h>

#include <stdio.h>
#include <stdlib.h>

/* The lens is at its primary wavelength, as it was read. */
static bool print_field(const sgt_launcher *from, const sgt_lens *lens, size_t field, size_t count,
                        const sgt_pupil_point at[], sgt_error *error)
{
    sgt_ray_end *end = malloc(count * sizeof *end), chief;
    double *opd = malloc(2 * count * sizeof *opd), *opd_err = opd + count;
    sgt_field_beam beam;
    sgt_reference about;
    bool fine = end && opd && sgt_launch_field(from, lens->field_kind, &lens->field[field], &beam, error) &&
                sgt_trace_chief(from, &beam, lens->element, lens->index_before, &chief, error) &&
                sgt_trace_pupil(from, &beam, lens->element, lens->index_before, count, at, NULL, end, error);
    if (fine) {
        sgt_spot spot = sgt_spot_of(1, &(sgt_ends){count, end, 1}, NULL);
        printf("field %zu: %zu of %zu rays passed, rms %.6g +- %.1g", field + 1, spot.passed, spot.rays,
               spot.rms, spot.error);
        if (sgt_reference_of(lens, sgt_launcher_data(from), lens->element, lens->index_before, &chief, false,
                             &about, NULL)) {
            for (size_t i = 0; i < count; i++) opd[i] = sgt_opd(&about, &end[i], &opd_err[i]);
            sgt_wavefront front = sgt_wavefront_of(count, end, opd, opd_err);
            printf(", wavefront rms %.6g +- %.1g", front.rms, front.error);
        }
        printf("\n");
    }
    free(end);
    free(opd);
    return fine;
}

int main(int argc, char *argv[])
{
    sgt_error error = {.line = 0};
    sgt_lens *lens = argc > 1 ? sgt_lens_read(argv[1], NULL, &error) : NULL;
    sgt_launcher *from = lens ? sgt_launcher_new(lens, NULL, &error) : NULL;
    size_t across = argc > 2 ? (size_t)atoi(argv[2]) : 20;
    size_t count = sgt_pupil_points(SGT_PATTERN_CELLS, across, 0, 0, NULL);
    sgt_pupil_point *at = malloc(count * sizeof *at);
    bool fine = from && at;
    if (fine) sgt_pupil_points(SGT_PATTERN_CELLS, across, 0, count, at);
    for (size_t f = 0; fine && f < lens->fields; f++) fine = print_field(from, lens, f, count, at, &error);
    if (!fine)
        fprintf(stderr, "%s:%zu: %s: %s\n", error.file, error.line, error.key,
                argc > 1 ? error.words : "usage: spots LENS [RAYS_ACROSS]");
    free(at);
    sgt_launcher_free(from);
    sgt_lens_free(lens);
    return fine ? 0 : 1;
}
