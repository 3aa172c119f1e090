// SPDX-License-Identifier: MIT
/* launch.c - a launcher: a lens and its pupil, and the rays of a field through it.
 *
 * THE PUPIL is that of the first-order data (sgt_lens_first_order): at the primary wavelength, the
 * paraxial image of the stop in object space, of the size that the lens defines.
 *
 * AIMING at the stop: aim.c, aim_map.c.  Fields by real image heights: aim_field.c.  All other fields:
 * beam.c. */
#include "launch.h"

#include "../base/arena.h"

#include <string.h>

/* --------------------------------------------------------------- the launcher */

sgt_launcher *sgt_launcher_new(const sgt_lens *lens, const sgt_launcher_options *opt, sgt_error *error)
{
    const sgt_launcher_options defaults = {.wavelength = 0};
    if (!opt) opt = &defaults;
    sgt_launcher blank = {.allocator = sgt_allocator_or(opt->allocator), .lens = lens,
                          .aim = opt->aim ? *opt->aim : lens->aim};
    sgt_launcher *from = sgt_launch_take(&blank, 1, sizeof *from);
    const bool other = !lens->wavelength && opt->wavelength != 0;
    if (from && other) blank.own = sgt_launch_take(&blank, lens->count, sizeof *blank.own);
    blank.element = other ? blank.own : lens->element;
    if (!from || (other && !blank.own)) {
        sgt_launch_memory(&blank, error);
        sgt_launch_forget(&blank, from);
        return NULL;
    }
    *from = blank;
    if (!PLAIN(from, opt, "sgt_launcher_options", error)) {
        sgt_launcher_free(from);
        return NULL;
    }
    const double um = lens->wavelength         ? lens->wavelength[lens->primary]
                      : opt->wavelength != 0 ? opt->wavelength
                                             : (double)NAN;
    if (sgt_lens_at(lens, um, from->own, &from->before, error) &&
        sgt_lens_first_order(lens, um, &from->data, NULL, error) &&
        (from->aim == SGT_LENS_AIM_PUPIL || sgt_aim_at_stop(from, error)))
        return from;
    sgt_launcher_free(from);
    return NULL;
}

void sgt_launcher_free(sgt_launcher *from)
{
    if (!from) return;
    const sgt_launcher was = *from;
    sgt_launch_forget(&was, from->own);
    sgt_launch_forget(&was, from);
}

const sgt_first_order *sgt_launcher_data(const sgt_launcher *from) { return &from->data; }

/* ----------------------------------------------------------------- a field */

bool sgt_launch_field(const sgt_launcher *from, sgt_field_kind kind, const sgt_lens_field *at,
                      sgt_field_beam *b, sgt_error *error)
{
    return sgt_beam_of_field(from, kind, at, b, error) &&
           (kind != SGT_FIELD_REAL_IMAGE_HEIGHT ||
            sgt_aim_field(from, b, (sgt_vec2){at->x, at->y}, error));
}

bool sgt_launch_columns(const sgt_launcher *from, const sgt_field_beam *b, size_t count,
                        const sgt_pupil_point at[], double *const o[3], double *const d[3])
{
    if (from->aim != SGT_LENS_AIM_PUPIL || !PLAIN(from, b, "sgt_field_beam", NULL)) return false;
    sgt_launch_unaimed(b, count, at, o, d);
    return true;
}

bool sgt_launch_rays(const sgt_launcher *from, const sgt_field_beam *b, const sgt_element e[],
                     double index_before, size_t count, const sgt_pupil_point at[], sgt_launched out[],
                     sgt_error *error)
{
    if (!PLAIN(from, b, "sgt_field_beam", error)) return false;
    if (from->aim != SGT_LENS_AIM_PUPIL) {
        sgt_aim_room *room = sgt_aim_room_new(from, count);
        if (!room) return sgt_launch_memory(from, error);
        sgt_aim_rays(&(sgt_colour_beam){from, b, e, index_before, NULL}, room, count, at, out);
        sgt_aim_room_free(from, room);
        return true;
    }
    for (size_t i = 0; i < count; i++) {
        sgt_vec2 q = sgt_vignetted(b, at[i].x, at[i].y);
        out[i] = (sgt_launched){.ray = sgt_field_ray(b, q.x, q.y), .status = SGT_MET};
    }
    return true;
}
