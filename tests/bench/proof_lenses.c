// SPDX-License-Identifier: MIT
/* proof_lenses.c - see proof_lenses.h. */
#include "proof_lenses.h"

#include "../../src/tool/job/launch.h"
#include "../../src/tool/base/memory.h"

#include <math.h>

proof_lens proof_lens_read(const char *path, size_t rays)
{
    lens *l = memory_take(1, sizeof *l);
    *l = lens_at(lens_open(path), (lens_wavelength){.place = 1});
    launch_how how = launch_by(l, &(sgt_lens_aim){SGT_LENS_AIM_PUPIL});
    proof_field *field = memory_take(l->of->fields, sizeof *field);
    long side = lround(sqrt((double)rays / 0.785398)); /* of the square about the pupil, pi / 4 is in it */
    const launch_pattern grid = launch_points(SGT_PATTERN_GRID, (size_t)side, 0);
    for (size_t i = 0; i < l->of->fields; i++) {
        ray_list list = {0};
        launch_field(&list, &how, l, l->element, i, SGT_FIELD_ANGLE, l->of->field[i], &grid);
        sgt_ray *all = memory_take(list.count, sizeof *all);
        for (size_t j = 0; j < list.count; j++) all[j] = list.ray[j].ray;
        field[i] = (proof_field){l->of->field[i].y, list.count, all};
    }
    return (proof_lens){l->count, l->of->fields, l->element, l->index_before, field};
}
