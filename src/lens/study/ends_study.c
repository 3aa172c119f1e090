// SPDX-License-Identifier: MIT
/* ends_study.c - the study itself: where each ray ends, and how sure that is.
 *
 * THE ERROR OF THE PATH.  opl_err of an end is that of the path to the foot of a perpendicular from a fixed
 * point near p.  The path to p itself has also what p moves along the ray.  p stays on the last element: of
 * the slope s, where x and y are off by p_err, p is off by p_err sqrt(1 + s^2), in whatever direction. */
#include "analyses.h"
#include "study.h"
#include "wavefront.h"

#include <math.h>

static double error_of_opl(const sgt_ray_end *end, const sgt_element *last, double index)
{
    sgt_vec3 g;
    if (end->fate != SGT_PASSED) return end->opl_err;
    last->surface.ops->value(last->surface.self, end->p, &g);
    const double off = end->opl_err + index * end->p_err * hypot(1, hypot(g.x, g.y) / fabs(g.z));
    return isnan(off) ? HUGE_VAL : off;
}

static void ends_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const sgt_asking *a = p->ask;
    const band *at = &a->band[i % a->bands];
    const size_t elements = a->lens->count;
    const double index = sgt_index_of_image(elements, at->element, at->before);
    (void)sum;
    for (size_t k = 0; k < count; k++) {
        const sgt_ends_row row = {.field = a->number[i / a->bands],
                                  .wavelength = at->at.um, .fate = sgt_fate_of(&end[k]),
                                  .element = end[k].aimed == SGT_MET ? end[k].element + 1 : 0,
                                  .end = end[k],
                                  .opl_err = error_of_opl(&end[k], &at->element[elements - 1], index)};
        sgt_ask_row(a, &row);
    }
}

static bool ask_ends(sgt_asking *a)
{
    const pass p = {.ask = a, .points = &a->fine, .cells = a->fields * a->bands,
                    .wanted = END_ALL, .takes_ends = true,
                    .place = sgt_place_study,
                    .lost = sgt_lost_study, .take = ends_take};
    return sgt_ask_pass(&p);
}

#define ENDS_AT(member) offsetof(sgt_ends_row, member)
static const sgt_column ends_columns[] = {
    COLUMN_FIELD(sgt_ends_row),
    COLUMN_WAVELENGTH(sgt_ends_row, SGT_COLUMN_GROUPS),
    COLUMN_PUPIL(sgt_ends_row, end.px, end.py),
    {.name = "weight", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, ENDS_AT(end.weight), 0,
     "of the point, for a mean over the area: all add up to 1"},
    COLUMN_OF_FATE(sgt_ends_row),
    {.name = "element", SGT_COLUMN_PLACE, SGT_UNIT_NONE, 0, ENDS_AT(element), 0,
     "where it ended, counted from 1"},
    {.name = "x", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, ENDS_AT(end.p.x), ENDS_AT(end.p_err),
     "where it meets the last surface,"},
    {.name = "y", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, ENDS_AT(end.p.y), ENDS_AT(end.p_err),
     "in its frame"},
    {.name = "z", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, SGT_COLUMN_DETAIL, ENDS_AT(end.p.z), 0, ""},
    {.name = "l", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, ENDS_AT(end.d.x), 0,
     "the direction in front of it"},
    {.name = "m", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, ENDS_AT(end.d.y), 0, ""},
    {.name = "n", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, ENDS_AT(end.d.z), 0, ""},
    {.name = "opl", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, ENDS_AT(end.opl), 0,
     "the optical path from the object, or a plane wavefront"},
    {.name = "xy_err", SGT_COLUMN_ERROR, SGT_UNIT_LENGTH, 0, ENDS_AT(end.p_err), 0,
     "rounding puts neither x nor y off by more"},
    {.name = "opl_err", SGT_COLUMN_ERROR, SGT_UNIT_LENGTH, 0, ENDS_AT(opl_err), 0, "nor the path"},
    {.name = "within", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, ENDS_AT(end.within), 0,
     "of a ray that aiming has not found: proven, there is none so near"},
};

const sgt_analysis sgt_ends_analysis = {
    .name = "ends", .title = "ends of rays",
    .help = "Where the rays of each field and wavelength end, and how sure that is: what all other "
            "analyses are made of.",
    .pattern = SGT_PATTERN_HEXAPOLAR, .rays = 10, .draw_x = "x", .draw_y = "y",
    ROWS_OF(sgt_ends_row, ends_columns), .ask = ask_ends};
