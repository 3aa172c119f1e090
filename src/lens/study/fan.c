// SPDX-License-Identifier: MIT
/* fan.c - transverse errors along lines of the pupil: where rays end, from where the chief ray of the primary
 * wavelength does.  Both are off by their p_err at most. */
#include "spot.h"

static void angles_of_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    (void)sum;
    sgt_spots_angles(p->data, i, count, end);
}

static void fan_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const spots *w = p->data;
    const sgt_asking *a = p->ask;
    const sgt_ray_end *about = &w->centre[i / a->bands];
    (void)sum;
    for (size_t k = 0; k < count; k++) {
        const sgt_fan_row row = {
            .field = a->number[i / a->bands], .wavelength = a->band[i % a->bands].at.um, .px = end[k].px,
            .py = end[k].py, .fate = sgt_fate_of(&end[k]), .ex = end[k].p.x - about->p.x,
            .ey = end[k].p.y - about->p.y, .e_err = end[k].p_err + about->p_err};
        sgt_ask_row(a, &row);
    }
}

static bool ask_fan(sgt_asking *a)
{
    spots w;
    if (!sgt_spots_begin(a, false, NULL, &w)) return false;
    sgt_spots_say_reference(&w);
    const pass p = {.ask = a, .points = &a->fine, .cells = w.cells, .wanted = END_POINT | END_POINT_ERROR,
                    .takes_ends = true, .data = &w, .place = sgt_spots_place, .lost = sgt_spots_lost,
                    .block = angles_of_block, .take = fan_take};
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                a->lens->afocal ? "ex, ey: angles from the chief ray of the primary "
                                  "wavelength."
                                : "ex, ey: from the chief ray of the primary wavelength.");
    return sgt_ask_pass(&p);
}

#define FAN_AT(member) offsetof(sgt_fan_row, member)
static const sgt_column fan_columns[] = {
    COLUMN_FIELD(sgt_fan_row),
    COLUMN_WAVELENGTH(sgt_fan_row, SGT_COLUMN_GROUPS),
    COLUMN_PUPIL(sgt_fan_row, px, py),
    COLUMN_OF_FATE(sgt_fan_row),
    {.name = "ex", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, FAN_AT(ex), FAN_AT(e_err), "the error in x"},
    {.name = "ey", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, FAN_AT(ey), FAN_AT(e_err),
     "and in y, in the frame of the last surface; of an afocal lens angles from the chief ray"},
    {.name = "e_err", SGT_COLUMN_ERROR, SGT_UNIT_IMAGE, 0, FAN_AT(e_err), 0,
     "rounding puts neither off by more"},
};

const sgt_analysis sgt_fan_analysis = {
    .name = "fan", .title = "ray fans",
    .help = "Transverse errors: where the rays of a field meet the image, from where the chief ray of the "
            "primary wavelength does.  By default for two lines across the pupil, in y (tangential) and in "
            "x (sagittal).",
    .pattern = SGT_PATTERN_CROSS, .rays = 41, .draw_x = "py", .draw_y = "ey",
    ROWS_OF(sgt_fan_row, fan_columns), .ask = ask_fan};
