// SPDX-License-Identifier: MIT
/* map.c - what becomes of rays over the pupil or over the field, point by point. */
#include "analyses.h"
#include "study.h"

static void map_row(const sgt_asking *a, size_t number, const band *b, const sgt_lens_field *at,
                    const sgt_ray_end *end)
{
    const bool traced = end->aimed == SGT_MET;
    const double none = (double)NAN;
    const sgt_map_row row = {.field = number,
                             .wavelength = b->at.um,
                             .fx = at->x,
                             .fy = at->y,
                             .px = end->px,
                             .py = end->py,
                             .fate = sgt_fate_of(end),
                             .element = traced ? end->element + 1 : 0,
                             .evals = (size_t)end->evals,
                             .t_err = traced ? end->t_err : none,
                             .condition = traced ? end->condition : none};
    sgt_ask_row(a, &row);
}

/* ------------------------------------------------------------------ over the pupil */

static void map_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const sgt_asking *a = p->ask;
    (void)sum;
    for (size_t k = 0; k < count; k++)
        map_row(a, a->number[i / a->bands], &a->band[i % a->bands], &a->at[i / a->bands], &end[k]);
}

/* ------------------------------------------------------------------ over the field */

/* One ray of each field of a net of steps x steps, row by row from below; cells are band * steps^2 + point.
 */
typedef struct map_net { size_t steps; double half; } map_net;

static sgt_lens_field map_field(const map_net *net, size_t i)
{
    const size_t n = net->steps;
    const double x = 2 * (double)(i % n) / (double)(n - 1) - 1, y = 2 * (double)(i / n) / (double)(n - 1) - 1;
    return (sgt_lens_field){.x = net->half * x, .y = net->half * y, .weight = 1};
}

static bool map_net_place(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    const map_net *net = p->data;
    const sgt_asking *a = p->ask;
    const size_t points = net->steps * net->steps;
    const sgt_lens_field at = map_field(net, i % points);
    out->beam = &out->own, out->element = a->band[i / points].element,
    out->before = a->band[i / points].before;
    return sgt_launch_field(a->from, a->kind, &at, &out->own, fault);
}

static void map_net_lost(const pass *p, size_t i, sgt_lost_ray *out)
{
    const map_net *net = p->data;
    const size_t points = net->steps * net->steps;
    *out = (sgt_lost_ray){.kind = p->ask->kind, .at = map_field(net, i % points),
                          .wavelength = p->ask->band[i / points].at};
}

static void map_net_take(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    const map_net *net = p->data;
    const size_t points = net->steps * net->steps;
    const sgt_lens_field at = map_field(net, i % points);
    (void)sum;
    for (size_t k = 0; k < count; k++)
        map_row(p->ask, i % points + 1, &p->ask->band[i / points], &at, &end[k]);
}

static bool ask_map(sgt_asking *a)
{
    enum { STEPS = 21 };
    static const sgt_pupil_point centre = {0, 0, 1};
    const sgt_pupil chief = {.count = 1, .given = &centre};
    const sgt_map_options *o = a->options;
    const sgt_study_options *s = &a->study->opt;
    pass p = {.ask = a, .points = &a->fine, .cells = a->fields * a->bands,
              .wanted = END_EVALS | END_SLANT, .takes_ends = true, .place = sgt_place_study,
              .lost = sgt_lost_study, .take = map_take};
    if (!o->over) return o->steps ? sgt_ask_refuse(a, "steps", "goes with over field") : sgt_ask_pass(&p);
    const sgt_lens_field *far = sgt_ask_farthest(a);
    map_net net = {.steps = o->steps ? o->steps : STEPS, .half = fmax(fabs(far->x), fabs(far->y))};
    if (net.steps < 2) return sgt_ask_refuse(a, "steps", "2 or more");
    if (net.half == 0)
        return sgt_ask_refuse(a, "over", "field: the lens has no field off the axis; give a field");
    if (s->pattern || s->rays || s->across || s->points > 1)
        return sgt_ask_refuse(a, "over",
                              "field sends one ray of each field: the chief ray, or that of one point");
    p = (pass){.ask = a, .points = s->points ? &a->fine : &chief, .cells = net.steps * net.steps * a->bands,
               .wanted = END_EVALS | END_SLANT, .takes_ends = true, .data = &net, .place = map_net_place,
               .lost = map_net_lost, .take = map_net_take};
    return sgt_ask_pass(&p);
}

#define MAP_AT(member) offsetof(sgt_map_row, member)
static const sgt_column map_columns[] = {
    COLUMN_FIELD(sgt_map_row),
    COLUMN_WAVELENGTH(sgt_map_row, SGT_COLUMN_GROUPS),
    {.name = "fx", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, 0, MAP_AT(fx), 0, "the field,"},
    {.name = "fy", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, 0, MAP_AT(fy), 0,
     "as the lens gives it: degrees, or a height"},
    COLUMN_PUPIL(sgt_map_row, px, py),
    COLUMN_OF_FATE(sgt_map_row),
    {.name = "element", SGT_COLUMN_PLACE, SGT_UNIT_NONE, 0, MAP_AT(element), 0,
     "where it ended, counted from 1"},
    {.name = "evals", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, MAP_AT(evals), 0,
     "evaluations at all elements together"},
    {.name = "t_err", SGT_COLUMN_ERROR, SGT_UNIT_LENGTH, 0, MAP_AT(t_err), 0,
     "the largest bound on the error of a length between elements"},
    {.name = "condition", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, MAP_AT(condition), 0,
     "the largest 1 / cos of an angle of incidence: a surface that is off along its normal moves the hit by "
     "so many times as much"},
};

static const sgt_setting map_settings[] = {
    {.name = "over", SGT_SETTING_WORD, offsetof(sgt_map_options, over), "pupil|field", 0, 0,
     "pupil (the default) or field: from minus to plus the field of the lens which is farthest from the "
     "axis, in x and y, by the chief ray or that of one point of the pupil"},
    {.name = "steps", SGT_SETTING_COUNT, offsetof(sgt_map_options, steps), NULL, 2, 10000,
     "N x N fields (default 21)"},
};

const sgt_analysis sgt_map_analysis = {
    .name = "map", .title = "map",
    .help = "What becomes of rays, and what they cost: over the pupil of each field (the default), or of "
            "one ray of each field over a square of fields.  Where does this lens lose rays?  No number is "
            "of the image, so an afocal lens has the same columns.",
    .primary_alone = true, .pattern = SGT_PATTERN_CELLS, .rays = 41, ROWS_OF(sgt_map_row, map_columns),
    OPTIONS_OF(sgt_map_options), SETTINGS_OF(map_settings), .ask = ask_map};
