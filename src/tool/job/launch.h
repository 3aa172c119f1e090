// SPDX-License-Identifier: MIT
/* launch.h - the rays of the fields of a lens, by the library's launcher (analysis.h). */
#ifndef TOOL_LAUNCH_H
#define TOOL_LAUNCH_H
#include "../read/lens.h"
#include "../read/rays.h"

#include <sagitta/analysis.h>

/* Points in the unit circle of the pupil; they last until the command ends. */
typedef struct launch_pattern {
    size_t count;
    const sgt_pupil_point *at; /* single points; NULL: of the pattern, made when they are needed */
    const sgt_pupil *pattern;
} launch_pattern;
launch_pattern launch_points(sgt_pattern pattern, size_t n, uint64_t seed);

/* Some of them. */
void launch_points_part(const launch_pattern *points, size_t first, size_t count, sgt_pupil_point at[]);

/* What the launching of all fields shares. */
typedef struct launch_how {
    sgt_launcher *from;
    size_t count;              /* of rays that were asked for */
    size_t none, undecided;    /* for which aiming has proven that there is none, or found none */
    size_t folded;             /* that are on a fold of the pupil */
    ray_list missing;          /* that launch_field did not find */
    const size_t *field_number; /* of each field, counted from 0: its number in the lens */
} launch_how;

/* aim NULL: as the lens says.  A fault of the lens ends the command, and the message names the key. */
launch_how launch_by(const lens *l, const sgt_lens_aim *aim);

/* Rays of several fields at one wavelength, that are made when they are needed: field after field, each with
 * the same points. */
typedef struct launch_plan {
    const launch_how *how;
    const lens *traced;          /* the lens at the wavelength they are for */
    const sgt_element *element;  /* its elements, as they are traced */
    size_t fields;
    const sgt_field_beam *beam;  /* [fields] */
    const launch_pattern *points;
} launch_plan;

/* The beam of a field; a fault ends the command. */
sgt_field_beam launch_beam(const launch_how *how, sgt_field_kind kind, sgt_lens_field at);

/* Makes the rays first ... first + count - 1, at most TILE_RAYS.  May run in any thread. */
void launch_part(const launch_plan *plan, size_t first, size_t count, ray_block *to);

/* Notes and counts the rays that are not there, and counts those that are folded. */
void launch_take(launch_how *how, const ray_block *b);

/* Adds the rays of a field, the field-th, to the list.  Aimed ones are those of `traced`, the lens at the
 * wavelength they are for, with its elements as they are traced; a ray that is not there is left
 * out, counted, and noted. */
void launch_field(ray_list *list, launch_how *how, const lens *traced, const sgt_element *element,
                  size_t field, sgt_field_kind kind, sgt_lens_field at, const launch_pattern *points);

/* In words, of a ray that is not there: what is known of it. */
const char *launch_words(sgt_aimed status, double within);

/* Notes how many are not there, and how many are folded. */
void launch_note(const launch_how *how, size_t wavelengths);

#endif
