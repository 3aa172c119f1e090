// SPDX-License-Identifier: MIT
/* between.c - bounds and limits for the fields and wavelengths between those of a study (prove/between.c).
 *
 * FIELDS.  Their beams are known: from afar each has a direction, else a point of the object.  Slopes, or
 * points, span a convex hull (Andrew 1979, Inf. Process. Lett. 9, 216): a point, a line, or a polygon, which
 * is cut into triangles at one of its corners.
 *
 * A SHARE OF A PUPIL is of one field, so there is none here; nor is there a mean.
 *
 * WHAT IS TOLD of each field and wavelength that is asked for by itself, and of all between as one, is put
 * together of parts.  Each is worked out by itself, in any thread or on any machine. */
#include "analyses.h"
#include "study.h"

#include "../prove/between.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BETWEEN_BOTH, BETWEEN_FIELDS, BETWEEN_WAVELENGTHS, BETWEEN_BOXES = 10000 };

/* All that is asked for together. */
typedef struct between_group {
    size_t field, band;         /* their places; SIZE_MAX: all between */
    between_cell cell;
    between_asked asked;
    between_net net;
    between_part *all;          /* of its parts */
    size_t parts;               /* that were taken */
} between_group;

typedef struct betweens {
    sgt_asking *ask;
    bool fields, wavelengths;   /* those between are meant */
    size_t groups, parts, boxes, limits;
    sgt_prove_limit limit[SGT_PROVE_LIMITS];
    between_group *group;
    sgt_element **ending, *primary; /* [bands] */
} betweens;

/* -------------------------------------------------------------------------- fields */

static sgt_vec2 point_of_beam(const sgt_field_beam *b)
{
    if (b->finite) return (sgt_vec2){b->object.x, b->object.y};
    return (sgt_vec2){b->direction.x / b->direction.z, b->direction.y / b->direction.z};
}

static double turn_of(sgt_vec2 a, sgt_vec2 b, sgt_vec2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static int by_place(const void *a, const void *b)
{
    const sgt_vec2 *p = a, *q = b;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return p->y < q->y ? -1 : p->y > q->y;
}

/* The corners of the convex hull, counter-clockwise; of points on a line its ends.  Points within `slack` of
 * a line are on it. */
static size_t hull_of(size_t count, sgt_vec2 at[], sgt_vec2 out[])
{
    double size = 0;
    size_t n = 0;
    qsort(at, count, sizeof *at, by_place);
    for (size_t i = 0; i < count; i++) size = fmax(size, hypot(at[i].x - at[0].x, at[i].y - at[0].y));
    const double slack = 1e-12 * size * size;
    for (size_t i = 0; i < count; i++) {
        while (n >= 2 && turn_of(out[n - 2], out[n - 1], at[i]) <= slack) n--;
        out[n++] = at[i];
    }
    const size_t below = n + 1;
    for (size_t i = count; i-- > 0;) {
        while (n >= below && turn_of(out[n - 2], out[n - 1], at[i]) <= slack) n--;
        out[n++] = at[i];
    }
    return n > 1 ? n - 1 : n; /* the last is the first */
}

/* Where no beam has vignetting of its own, that of all; else none.  true: they differ. */
static bool vignetting_differs(const sgt_asking *a)
{
    for (size_t i = 1; i < a->fields; i++) {
        const sgt_field_beam *p = &a->beam[0], *q = &a->beam[i];
        if (p->shift.x != q->shift.x || p->shift.y != q->shift.y || p->scale.x != q->scale.x ||
            p->scale.y != q->scale.y || p->turn.x != q->turn.x || p->turn.y != q->turn.y)
            return true;
    }
    return false;
}

static bool set_fields_between(betweens *w, between_cell *of, const sgt_field_beam *beam, size_t count)
{
    sgt_asking *a = w->ask;
    sgt_vec2 *at = sgt_ask_room(a, count, sizeof *at),
             *corner = sgt_ask_room(a, 2 * count + 2, sizeof *corner);
    if (!at || !corner) return false;
    for (size_t i = 0; i < count; i++) at[i] = point_of_beam(&beam[i]);
    size_t corners = hull_of(count, at, corner);
    if (corners == 2 && corner[0].x == corner[1].x && corner[0].y == corner[1].y) corners = 1;
    of->beam = beam[0];
    of->field_sides = corners < 3 ? (int)corners - 1 : 2, of->patches = corners < 3 ? 1 : corners - 2;
    between_patch *patch = sgt_ask_room(a, of->patches, sizeof *patch);
    if (!patch) return false;
    for (size_t i = 0; i < of->patches; i++)
        patch[i] =
            (between_patch){corner[0], corner[corners > 1 ? i + 1 : 0], corner[corners > 2 ? i + 2 : 0]};
    of->patch = patch;
    for (size_t i = 0; i < count; i++) of->beam.front = fmin(of->beam.front, beam[i].front);
    return true;
}

/* --------------------------------------------------------------------- wavelengths */

static bool set_wavelengths_between(betweens *w, between_cell *of)
{
    sgt_asking *a = w->ask;
    size_t low = 0, high = 0, element;
    for (size_t i = 1; i < a->bands; i++) {
        if (a->band[i].at.um < a->band[low].at.um) low = i;
        if (a->band[i].at.um > a->band[high].at.um) high = i;
    }
    of->um[0] = a->band[low].at.um, of->um[1] = a->band[high].at.um;
    of->e = w->ending[low], of->before = a->band[low].before;
    if (!(of->um[1] > of->um[0])) return true;
    /* an index for each wavelength of the file has none between, as this says */
    double before;
    const double between = of->um[0] + 0.3819660112501051 * (of->um[1] - of->um[0]);
    if (!sgt_lens_at(a->lens, between, NULL, &before, a->error)) return a->failed = true, false;
    const char *why = sgt_between_lacks(of, &element);
    if (why) return sgt_ask_fail(a, "wavelengths", "element %zu: %s", element + 1, why);
    return true;
}

/* --------------------------------------------------------------------------- parts */

static bool part_work(void *data, size_t i, void *slot)
{
    const betweens *w = data;
    const between_group *g = &w->group[i / w->parts];
    return sgt_between_prove(&g->asked, &g->net, i % w->parts, slot);
}

static void tell_bounds(const betweens *w, const between_group *g);
static void tell_group_limits(const betweens *w, const between_group *g);

static void part_take(void *data, size_t i, void *slot)
{
    betweens *w = data;
    between_group *g = &w->group[i / w->parts];
    const between_cell *c = &g->cell;
    between_part *part = slot, *all = g->all;
    double *most = sgt_between_most(c, all), *other = sgt_between_most(c, part);
    between_seen *seen = sgt_between_part_seen(c, all), *more = sgt_between_part_seen(c, part);
    for (size_t q = 0; q < prove_quantities(w->ask->lens->count); q++) {
        if (!(other[q] <= most[q])) most[q] = other[q];
        if (more[q].value > seen[q].value || (isnan(seen[q].value) && !isnan(more[q].value)))
            seen[q] = more[q];
    }
    all->boxes += part->boxes, all->spent |= part->spent, all->passed |= part->passed;
    all->undecided += part->undecided / (double)w->parts;
    if (part->hopeless && !all->hopeless)
        all->hopeless = 1, all->element = part->element, all->why = part->why;
    if (++g->parts < w->parts) return;
    if (w->limits) tell_group_limits(w, g);
    else tell_bounds(w, g);
}

/* ---------------------------------------------------------------------------- rows */

static const char *between_name(const betweens *w, const between_group *g, char text[120])
{
    const sgt_asking *a = w->ask;
    char field[40] = "all fields between", wave[60] = "";
    if (g->field != SIZE_MAX) snprintf(field, sizeof field, "field %zu", a->number[g->field]);
    if (g->band == SIZE_MAX && g->cell.um[1] > g->cell.um[0])
        snprintf(wave, sizeof wave, ", %.6g to %.6g \302\265m", g->cell.um[0], g->cell.um[1]);
    else if (a->bands > 1) snprintf(wave, sizeof wave, ", %.6g \302\265m", g->cell.um[0]);
    snprintf(text, 120, "%s%s", field, wave);
    return text;
}

static void say_between(const betweens *w, const between_group *g)
{
    char who[120];
    between_name(w, g, who);
    if (g->net.lost_chiefs)
        sgt_ask_say(w->ask, SGT_STUDY_NOTE,
                    "%s: the chief ray of some field does not get through, so there is no reference", who);
    if (g->all->spent)
        sgt_ask_say(w->ask, SGT_STUDY_NOTE,
                    "%s: the boxes of some of %zu parts were spent, %zu each; more --boxes bring closer "
                    "bounds",
                    who, w->parts, w->boxes);
    if (g->all->hopeless)
        sgt_ask_say(w->ask, SGT_STUDY_NOTE, "%s: at element %zu some boxes cannot be decided: %s", who,
                    g->all->element + 1, sgt_box_why_text((sgt_box_why)g->all->why));
}

static size_t field_number_of(const betweens *w, const between_group *g)
{
    return g->field == SIZE_MAX ? 0 : w->ask->number[g->field];
}

static double wavelength_of_group(const between_group *g)
{
    return g->band == SIZE_MAX && g->cell.um[1] > g->cell.um[0] ? SGT_ALL_WAVELENGTHS : g->cell.um[0];
}

static bool any_passes(const between_group *g) { return g->all->passed || g->net.passed; }

/* Of which quantities of a limit, or all bounds: the worst_seen seen ray and the largest bound. */
typedef struct worst_seen { double bound, seen; between_ray ray, low; } worst_seen;
static worst_seen worst_ray_of(const betweens *w, const between_group *g, const sgt_prove_limit *l)
{
    const between_cell *c = &g->cell;
    const double none = (double)NAN, *most = sgt_between_most(c, g->all);
    const between_seen *seen = sgt_between_part_seen(c, g->all);
    between_seen best = {.value = none};
    size_t first, step;
    const size_t count = sgt_between_quantities(c, l, &first, &step);
    worst_seen out = {.bound = -HUGE_VAL};
    (void)w;
    for (size_t i = 0; i < count; i++) {
        const size_t q = first + i * step;
        out.bound = fmax(out.bound, isnan(most[q]) ? HUGE_VAL : most[q]);
        if (!isnan(seen[q].value) && !(seen[q].value <= best.value)) best = seen[q];
    }
    const between_seen nothing = {.value = none};
    out.seen = best.value, out.ray = sgt_between_ray(c, &best);
    out.low = sgt_between_ray(c, l->quantity == SGT_PROVE_OPD && !isnan(best.value) ? &g->net.low : &nothing);
    if (l->quantity == SGT_PROVE_CLEARANCE) out.bound = -out.bound, out.seen = -out.seen;
    return out;
}

static bool has_edge(const between_cell *c, size_t element)
{
    for (size_t i = 0; i < c->from->lens->count; i++) {
        const sgt_element *e = &c->e[i];
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        if ((round || (e->aperture && e->aperture->count > 0)) && (element == 0 || element == i + 1))
            return true;
    }
    return false;
}

static void tell_row(const betweens *w, const between_group *g, sgt_prove_quantity of, size_t element)
{
    const sgt_prove_limit asked = {.quantity = of, .element = element};
    const worst_seen is = worst_ray_of(w, g, &asked);
    const double none = (double)NAN;
    const bool known = any_passes(g) && !isnan(is.seen); /* of no ray: without a wavelength, or a chief ray */
    const sgt_prove_between_row row = {.field = field_number_of(w, g),
                                       .wavelength = wavelength_of_group(g),
                                       .quantity = (int)of,
                                       .element = element,
                                       .bound = known || isfinite(is.bound) ? is.bound : none,
                                       .seen = is.seen,
                                       .fx = is.ray.fx,
                                       .fy = is.ray.fy,
                                       .um = is.ray.um,
                                       .px = is.ray.px,
                                       .py = is.ray.py,
                                       .low_px = is.low.px,
                                       .low_py = is.low.py,
                                       .boxes = g->all->boxes,
                                       .spent = g->all->spent};
    w->ask->total.fates.lost += known && !isfinite(is.bound);
    sgt_ask_row(w->ask, &row);
}

static void tell_bounds(const betweens *w, const between_group *g)
{
    static const sgt_prove_quantity whole[] = {SGT_PROVE_EX, SGT_PROVE_EY, SGT_PROVE_SPOT, SGT_PROVE_OPD};
    const size_t count = w->ask->lens->count;
    say_between(w, g);
    if (!any_passes(g)) {
        char who[120];
        const double most = sgt_between_most(&g->cell, g->all)[prove_at_element(0, Q_HEIGHT)];
        sgt_ask_say(w->ask, SGT_STUDY_NOTE, "%s: no ray %s", between_name(w, g, who),
                    most == -HUGE_VAL ? "passes" : "was seen to pass");
    }
    for (int k = 0; k < 4; k++) tell_row(w, g, whole[k], 0);
    for (size_t i = 1; i <= count; i++) {
        tell_row(w, g, SGT_PROVE_INCIDENCE, i);
        if (has_edge(&g->cell, i)) tell_row(w, g, SGT_PROVE_CLEARANCE, i);
    }
}

static void tell_group_limits(const betweens *w, const between_group *g)
{
    say_between(w, g);
    for (size_t k = 0; k < w->limits; k++) {
        const sgt_prove_limit *l = &w->limit[k];
        const worst_seen is = worst_ray_of(w, g, l);
        const bool above = l->quantity == SGT_PROVE_CLEARANCE;
        /* with all that rounding may do: a part in 1e9, and of lengths 1e-11 of the pupil */
        const double slack = 1e-9 * fabs(l->value) + 1e-11 * fabs(g->cell.beam.radius);
        const double bound = above ? -is.bound : is.bound, value = above ? -l->value : l->value,
                     seen = above ? -is.seen : is.seen;
        const bool none = sgt_between_most(&g->cell, g->all)[prove_at_element(0, Q_HEIGHT)] == -HUGE_VAL;
        const sgt_limit_verdict verdict = !any_passes(g)  ? none ? SGT_LIMIT_EMPTY : SGT_LIMIT_UNDECIDED
                                          : l->or_equal   ? bound <= value         ? SGT_LIMIT_PROVEN
                                                            : seen > value + slack ? SGT_LIMIT_BROKEN
                                                                                   : SGT_LIMIT_UNDECIDED
                                          : bound < value ? SGT_LIMIT_PROVEN
                                          : seen > value + slack ? SGT_LIMIT_BROKEN
                                                                 : SGT_LIMIT_UNDECIDED;
        const sgt_prove_between_limit_row row = {
            .field = field_number_of(w, g),
            .wavelength = wavelength_of_group(g),
            .limit = k + 1,
            .verdict = verdict,
            .value = l->value,
            .bound = none ? (double)NAN : is.bound,
            .seen = is.seen,
            .fx = is.ray.fx,
            .fy = is.ray.fy,
            .um = is.ray.um,
            .px = is.ray.px,
            .py = is.ray.py,
            .low_px = is.low.px,
            .low_py = is.low.py,
            .undecided = verdict == SGT_LIMIT_UNDECIDED ? 100 * g->all->undecided : 0,
            .boxes = g->all->boxes};
        sgt_ask_row(w->ask, &row);
    }
}

/* ---------------------------------------------------------------------------- asking */

static bool read_limits(betweens *w, const sgt_prove_options *o)
{
    sgt_asking *a = w->ask;
    sgt_error why;
    if (!o->limit) return sgt_ask_refuse(a, "limit", "is missing: \"spot < 0.02\"");
    w->limits = sgt_prove_limit_read(o->limit, SGT_PROVE_LIMITS, w->limit, &why);
    if (!w->limits) return sgt_ask_refuse(a, "limit", "%s", why.words);
    for (size_t k = 0; k < w->limits; k++) {
        const sgt_prove_limit *l = &w->limit[k];
        if (l->quantity == SGT_PROVE_PASSES || l->quantity == SGT_PROVE_RMS ||
            l->quantity == SGT_PROVE_OPD_RMS)
            return sgt_ask_refuse(
                a, "limit",
                "%s is of one field at one wavelength; of those between there are ex, ey, spot, "
                "opd, incidence and clearance",
                sgt_prove_quantity_text((int)l->quantity));
        if (l->element > a->lens->count)
            return sgt_ask_refuse(a, "limit", "there is no element %zu: the lens has %zu", l->element,
                                  a->lens->count);
    }
    return true;
}

static bool set_group(betweens *w, size_t field, size_t nth)
{
    sgt_asking *a = w->ask;
    between_group *g = &w->group[w->groups++];
    *g = (between_group){.field = field, .band = nth};
    between_cell *c = &g->cell;
    *c = (between_cell){.from = a->from,
                        .primary = a->primary.at.um,
                        .unit = a->study->um,
                        .e_primary = w->primary,
                        .before_primary = a->primary.before,
                        .data = &a->primary.data,
                        .reference = sgt_reference_of,
                        .opd = sgt_opd};
    if (!set_fields_between(w, c, field == SIZE_MAX ? a->beam : &a->beam[field],
                            field == SIZE_MAX ? a->fields : 1))
        return false;
    if (field == SIZE_MAX && vignetting_differs(a)) {
        c->beam.shift = (sgt_vec2){0, 0}, c->beam.scale = (sgt_vec2){1, 1}, c->beam.turn = (sgt_vec2){1, 0};
        if (w->groups == 1)
            sgt_ask_say(a, SGT_STUDY_NOTE,
                        "the fields differ in their vignetting, and between them it is not known: the whole "
                        "pupil is taken of each");
    }
    if (nth == SIZE_MAX) {
        if (!set_wavelengths_between(w, c)) return false;
    } else {
        c->um[0] = c->um[1] = a->band[nth].at.um, c->e = w->ending[nth], c->before = a->band[nth].before;
    }
    g->all = sgt_ask_room(a, 1, sgt_between_part_size(c));
    if (!g->all) return false;
    w->parts = sgt_between_parts(c);
    for (size_t q = 0; q < prove_quantities(a->lens->count); q++) sgt_between_most(c, g->all)[q] = -HUGE_VAL;
    g->asked = (between_asked){.cell = c, .boxes = w->boxes, .limits = w->limits, .limit = w->limit};
    return true;
}

/* What is between is one point: which is then said. */
static void say_what_is_between(const betweens *w)
{
    const sgt_asking *a = w->ask;
    const between_cell *c = &w->group[0].cell;
    if (w->fields && c->field_sides == 0)
        sgt_ask_say(a, SGT_STUDY_NOTE, "all fields: there is one alone, and none between");
    if (w->wavelengths && !(c->um[1] > c->um[0]))
        sgt_ask_say(a, SGT_STUDY_NOTE, "all wavelengths: there is one alone, and none between");
    if (a->from->aim != SGT_LENS_AIM_PUPIL)
        sgt_ask_say(a, SGT_STUDY_NOTE,
                    "the lens aims its rays at the stop; what is proven is of the paraxial pupil, and of "
                    "the chief rays through its centre, as with --aim paraxial");
}

static bool between_each(sgt_asking *a, bool limits)
{
    const sgt_prove_options *o = a->options;
    betweens w = {.ask = a,
                  .boxes = o->boxes ? o->boxes : BETWEEN_BOXES,
                  .fields = o->between != BETWEEN_WAVELENGTHS,
                  .wavelengths = o->between != BETWEEN_FIELDS};
    if (o->between < 0 || o->between > BETWEEN_WAVELENGTHS)
        return sgt_ask_refuse(a, "between", "there is no such word");
    if (limits && !read_limits(&w, o)) return false;
    const size_t fields = w.fields ? 1 : a->fields, bands = w.wavelengths ? 1 : a->bands;
    w.group = sgt_ask_room(a, fields * bands, sizeof *w.group);
    w.ending = sgt_ask_room(a, a->bands, sizeof *w.ending),
    w.primary = sgt_ask_room(a, a->lens->count, sizeof *w.primary);
    for (size_t b = 0; b < a->bands && !a->failed; b++) {
        w.ending[b] = sgt_ask_room(a, a->lens->count, sizeof **w.ending);
        if (w.ending[b]) sgt_launch_ending(a->lens->count, a->band[b].element, w.ending[b]);
    }
    if (a->failed) return false;
    sgt_launch_ending(a->lens->count, a->primary.element, w.primary);
    for (size_t i = 0; i < fields * bands; i++)
        if (!set_group(&w, w.fields ? SIZE_MAX : i / bands, w.wavelengths ? SIZE_MAX : i % bands))
            return false;
    for (size_t k = 0; k < w.limits; k++)
        if (w.limit[k].quantity == SGT_PROVE_CLEARANCE && !has_edge(&w.group[0].cell, w.limit[k].element))
            return sgt_ask_refuse(a, "limit", "%s has a clear aperture, so there is no clearance",
                                  w.limit[k].element ? "it is not so that the element" : "no element");
    say_what_is_between(&w);
    bool fine = true;
    for (size_t i = 0; i < w.groups && fine; i++) {
        between_group *g = &w.group[i];
        fine = sgt_between_look(&g->asked, &g->net) || sgt_ask_fail(a, "", "no memory");
        for (size_t q = 0; fine && q < prove_quantities(a->lens->count); q++)
            sgt_between_part_seen(&g->cell, g->all)[q] = g->net.seen[q];
    }
    const rounds r = {.tasks = w.groups * w.parts,
                      .size = sgt_between_part_size(&w.group[0].cell),
                      .data = &w,
                      .work = part_work,
                      .take = part_take};
    fine = fine && sgt_shard_rounds(a, &r);
    for (size_t i = 0; i < w.groups; i++) sgt_between_forget(&w.group[i].asked, &w.group[i].net);
    if (!fine) return false;
    char text[SGT_PROVE_LIMIT_SIZE], what[120];
    for (size_t k = 0; k < w.limits; k++) {
        sgt_prove_limit_text(&w.limit[k], text);
        sgt_ask_say(a, SGT_STUDY_LEGEND, "limit %zu: %s", k + 1, text);
    }
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "%s every ray that passes, of %s%s, with at most %zu boxes for each of %zu parts.",
                w.limits ? "Limits for" : "Proven of", between_name(&w, &w.group[0], what),
                w.groups > 1 ? ", and so on" : "", w.boxes, w.parts);
    return true;
}

static bool ask_between(sgt_asking *a) { return between_each(a, false); }
static bool ask_between_limits(sgt_asking *a) { return between_each(a, true); }

/* -------------------------------------------------------------------------- tables */

#define RAY_OF(row)                                                                                      \
    {.name = "fx", SGT_COLUMN_EXACT, SGT_UNIT_SWEEP, 0, offsetof(row, fx), 0,                            \
     "the field of this ray: degrees, or the point of the object"},                                      \
    {.name = "fy", SGT_COLUMN_EXACT, SGT_UNIT_SWEEP, 0, offsetof(row, fy), 0, "in x and y"},             \
    {.name = "um", SGT_COLUMN_EXACT, SGT_UNIT_NONE, 0, offsetof(row, um), 0,                             \
     "its wavelength in micrometres,"},                                                                  \
    {.name = "px", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, 0, offsetof(row, px), 0,                            \
     "and where it goes through the pupil; of opd the"},                                                 \
    {.name = "py", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, 0, offsetof(row, py), 0,                            \
     "ray with the largest difference"},                                                                 \
    {.name = "low_px", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, offsetof(row, low_px), 0,    \
     "of opd: the ray with the"},                                                                        \
    {.name = "low_py", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, offsetof(row, low_py), 0,    \
     "smallest"}

#define FIELD_OR_ALL(row)                                                                                \
    {.name = "field", SGT_COLUMN_PLACE, SGT_UNIT_NONE, SGT_COLUMN_GROUPS, offsetof(row, field), 0,       \
     "the field, counted from 1; empty: all fields between"}
#define WAVELENGTH_OR_ALL(row)                                                                           \
    {.name = "wavelength", SGT_COLUMN_WAVELENGTH, SGT_UNIT_MICROMETRE, SGT_COLUMN_GROUPS,                \
     offsetof(row, wavelength), 0, "micrometres; all: all wavelengths between"}

#define BETWEEN(member) offsetof(sgt_prove_between_row, member)
static const sgt_column between_columns[] = {
    FIELD_OR_ALL(sgt_prove_between_row),
    WAVELENGTH_OR_ALL(sgt_prove_between_row),
    {.name = "quantity", SGT_COLUMN_QUANTITY, SGT_UNIT_NONE, 0, BETWEEN(quantity), 0,
     "ex, ey, spot: the distance from the chief ray (length; of an afocal lens mrad); opd: largest less "
     "smallest path difference (waves); incidence (degrees); clearance: from the edge of the clear "
     "aperture (length)"},
    {.name = "element", SGT_COLUMN_PLACE, SGT_UNIT_NONE, 0, BETWEEN(element), 0,
     "of incidence and clearance, counted from 1"},
    {.name = "bound", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, BETWEEN(bound), 0, "no ray that passes is beyond"},
    {.name = "seen", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, BETWEEN(seen), 0,
     "of the worst ray that was traced"},
    RAY_OF(sgt_prove_between_row),
    {.name = "boxes", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, BETWEEN(boxes), 0,
     "how many were carried through, of this field and wavelength"},
    {.name = "spent", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, BETWEEN(spent), 0,
     "1: as many as were allowed, so more of them would bring closer bounds"},
};

#define BETWEEN_LIMIT(member) offsetof(sgt_prove_between_limit_row, member)
static const sgt_column between_limits_columns[] = {
    FIELD_OR_ALL(sgt_prove_between_limit_row),
    WAVELENGTH_OR_ALL(sgt_prove_between_limit_row),
    {.name = "limit", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(limit), 0,
     "which limit, counted from 1"},
    {.name = "verdict", SGT_COLUMN_VERDICT, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(verdict), 0,
     "proven of every ray; broken, by the ray of fx ... py; undecided; empty: no ray passes"},
    {.name = "value", SGT_COLUMN_EXACT, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(value), 0, "of the limit"},
    {.name = "bound", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(bound), 0, "no ray is beyond"},
    {.name = "seen", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(seen), 0,
     "of the worst ray that was traced"},
    RAY_OF(sgt_prove_between_limit_row),
    {.name = "undecided", SGT_COLUMN_ERROR, SGT_UNIT_PERCENT, 0, BETWEEN_LIMIT(undecided), 0,
     "of fields, wavelengths and pupil: where it may be broken, unless it is decided"},
    {.name = "boxes", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, BETWEEN_LIMIT(boxes), 0,
     "how many were carried through"},
};

#define BETWEEN_SETTINGS                                                                                 \
    {.name = "boxes", SGT_SETTING_COUNT, offsetof(sgt_prove_options, boxes), NULL, 1, 100000000,         \
     "at most so many boxes for each part of fields and wavelengths (default 10000)"},                   \
    {.name = "between", SGT_SETTING_WORD, offsetof(sgt_prove_options, between),                          \
     "both|fields|wavelengths", 0, 0,                                                                    \
     "what lies between those of the study and is meant, too: both (the default), fields, or "           \
     "wavelengths"}
static const sgt_setting between_settings[] = {BETWEEN_SETTINGS};
static const sgt_setting between_limits_settings[] = {
    BETWEEN_SETTINGS,
    {.name = "limit", SGT_SETTING_TEXT, offsetof(sgt_prove_options, limit), NULL, 0, 0,
     "limits for every ray: \"spot < 0.02; incidence[3] < 40\"; of ex, ey, spot (lengths; of an afocal lens "
     "mrad), opd (waves, peak to valley), incidence (degrees), clearance (from the edge of the clear "
     "aperture)"},
};

#define BETWEEN_HELP \
    "by boxes of field, wavelength and pupil, whose rays are carried through the lens together."

const sgt_analysis sgt_prove_between_analysis = {
    .name = "prove_between", .title = "every ray of all fields and wavelengths between: bounds",
    .part_of = "prove",
    .help = "Bounds that no ray leaves, of the fields and wavelengths between those of the lens, "
            BETWEEN_HELP,
    .no_rays = true, ROWS_OF(sgt_prove_between_row, between_columns), OPTIONS_OF(sgt_prove_options),
    SETTINGS_OF(between_settings), .ask = ask_between};

const sgt_analysis sgt_prove_between_limits_analysis = {
    .name = "prove_between_limits",
    .title = "limits for every ray of all fields and wavelengths between", .part_of = "prove",
    .help = "Limits for every ray that passes, of the fields and wavelengths between those of the lens: "
            "proven, broken or undecided, " BETWEEN_HELP,
    .no_rays = true, ROWS_OF(sgt_prove_between_limit_row, between_limits_columns),
    OPTIONS_OF(sgt_prove_options), SETTINGS_OF(between_limits_settings), .ask = ask_between_limits};
