// SPDX-License-Identifier: MIT
/* sweep.c - how many rays meet which fate, against the field, in the y-z plane. */
#include "analyses.h"
#include "study.h"

/* Cells are band * steps + step. */
typedef struct sweep { bool angle; double from, to; size_t steps; } sweep;

/* Twice the farthest field of the lens. */
static double sweep_far(const sgt_asking *a, bool angle)
{
    const double DEGREE = 57.29577951308232, MOST = 89;
    double far = 0;
    for (size_t f = 0; f < a->fields; f++) {
        const sgt_field_beam *b = &a->beam[f];
        far = fmax(far, angle ? DEGREE * atan(hypot(b->direction.x, b->direction.y) / fabs(b->direction.z))
                              : hypot(b->object.x, b->object.y));
    }
    if (!angle) return 2 * far;
    return far > 0 ? fmin(2 * far, MOST) : MOST;
}

static sgt_lens_field sweep_field(const sweep *w, size_t step)
{
    return (sgt_lens_field){.y = w->from + (w->to - w->from) * (double)step / (double)(w->steps - 1),
                            .weight = 1};
}

static sgt_field_kind sweep_kind(const sweep *w)
{
    return w->angle ? SGT_FIELD_ANGLE : SGT_FIELD_OBJECT_HEIGHT;
}

static bool sweep_place(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    const sweep *w = p->data;
    const sgt_asking *a = p->ask;
    const band *b = &a->band[i / w->steps];
    const sgt_lens_field at = sweep_field(w, i % w->steps);
    out->beam = &out->own, out->element = b->element, out->before = b->before;
    return sgt_launch_field(a->from, sweep_kind(w), &at, &out->own, fault);
}

static void sweep_lost(const pass *p, size_t i, sgt_lost_ray *out)
{
    const sweep *w = p->data;
    *out = (sgt_lost_ray){.kind = sweep_kind(w), .at = sweep_field(w, i % w->steps),
                          .wavelength = p->ask->band[i / w->steps].at};
}

static void sweep_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    double *evals = sum;
    (void)p, (void)i;
    for (size_t k = 0; k < count; k++) *evals += end[k].evals;
}

static void sweep_merge(const void *p, void *into, const void *more)
{
    double *evals = into;
    (void)p;
    *evals += *(const double *)more; /* whole numbers: exact below 2^53 */
}

static void sweep_end(const pass *p, size_t i, const sgt_fates *f, void *sum)
{
    const sweep *w = p->data;
    const double *evals = sum;
    const sgt_sweep_row row = {
        .at = sweep_field(w, i % w->steps).y, .wavelength = p->ask->band[i / w->steps].at.um, .rays = f->rays,
        .passed = f->passed, .missed = f->missed, .clipped = f->clipped, .tir = f->tir, .lost = f->lost,
        .none = f->none, .evals = *evals / (double)f->rays, .proven = f->proven,
        .evanescent = f->evanescent};
    sgt_ask_row(p->ask, &row);
}

static bool ask_sweep(sgt_asking *a)
{
    enum { STEPS = 46 };
    const sgt_sweep_options *o = a->options;
    sweep w = {.angle = !isfinite(a->lens->object_distance), .steps = o->steps ? o->steps : STEPS};
    w.from = o->from.count ? o->from.at[0] : 0;
    w.to = o->to.count ? o->to.at[0] : sweep_far(a, w.angle);
    if (w.steps < 2) return sgt_ask_refuse(a, "steps", "2 or more");
    if (w.from == w.to)
        return sgt_ask_refuse(a, "from", "the same as to: %g; give a range of %s", w.to,
                            w.angle ? "angles" : "object heights");
    if (w.angle && !(fabs(w.from) < 90 && fabs(w.to) < 90))
        return sgt_ask_refuse(a, "to", "angles must be between -90 and 90 degrees, not %g to %g",
                            w.from, w.to);
    const pass p = {.ask = a,
                    .points = &a->fine,
                    .cells = a->bands * w.steps,
                    .wanted = END_EVALS,
                    .data = &w,
                    .place = sweep_place,
                    .lost = sweep_lost,
                    .size = sizeof(double),
                    .block = sweep_block,
                    .merge = sweep_merge,
                    .exact = true, /* whole numbers */
                    .end = sweep_end};
    return sgt_ask_pass(&p);
}

#define SWEEP_AT(member) offsetof(sgt_sweep_row, member)
static const sgt_column sweep_columns[] = {
    {.name = "at", SGT_COLUMN_NUMBER, SGT_UNIT_SWEEP, 0, SWEEP_AT(at), 0,
     "the field: its angle in degrees, or, of an object at a distance, its height"},
    COLUMN_WAVELENGTH(sgt_sweep_row, SGT_COLUMN_GROUPS),
    {.name = "rays", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(rays), 0, "how many were sent"},
    {.name = "passed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(passed), 0, "what became of them"},
    {.name = "missed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(missed), 0, ""},
    {.name = "clipped", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(clipped), 0, ""},
    {.name = "tir", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(tir), 0, "totally reflected"},
    {.name = "evanescent", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, SWEEP_AT(evanescent), 0,
     "the order of a phase does not exist for them"},
    {.name = "lost", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(lost), 0, "it could not be decided"},
    {.name = "none", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SWEEP_AT(none), 0,
     "proven: the rims in front of the stop let no such ray through.  A ray that aiming did not find, "
     "without a "
     "proof, is lost"},
    {.name = "evals", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, SWEEP_AT(evals), 0,
     "the mean number of evaluations of a ray, at all elements together"},
    {.name = "proven", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_PROVEN, SWEEP_AT(proven), 0,
     "passed, and proven at each surface"},
};

static const sgt_setting sweep_settings[] = {
    {.name = "from", SGT_SETTING_NUMBER, offsetof(sgt_sweep_options, from), NULL, 0, 0,
     "where the range begins,"},
    {.name = "to", SGT_SETTING_NUMBER, offsetof(sgt_sweep_options, to), NULL, 0, 0,
     "and where it ends.  By default from the axis to twice the field of the lens which is farthest from it, "
     "or "
     "to 89 degrees if it has none"},
    {.name = "steps", SGT_SETTING_COUNT, offsetof(sgt_sweep_options, steps), NULL, 2, 1000000,
     "how many fields (default 46)"},
};

const sgt_analysis sgt_sweep_analysis = {
    .name = "sweep",
    .title = "fates against the field",
    .help =
        "Counts what becomes of the rays of one field after another, in the y-z plane.  No number is of the "
        "image, so an afocal lens has the same columns.",
    .primary_alone = true,
    .no_fields = true,
    .pattern = SGT_PATTERN_HEXAPOLAR,
    .rays = 10,
    .row_size = sizeof(sgt_sweep_row),
    .columns = sizeof sweep_columns / sizeof *sweep_columns,
    .column = sweep_columns,
    OPTIONS_OF(sgt_sweep_options),
    .settings = sizeof sweep_settings / sizeof *sweep_settings,
    .setting = sweep_settings,
    .ask = ask_sweep};
