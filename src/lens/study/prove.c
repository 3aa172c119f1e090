// SPDX-License-Identifier: MIT
/* prove.c - every ray of the pupil, by boxes (prove/branch.c), as analyses: sums and bounds, element by
 * element, box by box, and limits.
 *
 * REFERENCES are those of "spot" and "opd": the chief ray of the primary wavelength, whatever clips it, and
 * the sphere of the chief ray of the wavelength itself.  So no ray that these trace is beyond a bound here.
 *
 * A RAY THAT BREAKS A LIMIT is traced anew with bounds on its rounding, and must break it with them. */
#include "analyses.h"
#include "study.h"

#include "../prove/branch.h"

#include <stdio.h>
#include <string.h>

static const double PER_CENT = 0.1; /* that may stay undecided, if nothing is said */
enum { BOXES = 10000 };

/* A field at a wavelength, and its proof. */
typedef struct proving {
    sgt_asking *ask;
    double undecided;
    size_t boxes, limits;
    sgt_prove_limit limit[SGT_PROVE_LIMITS];
    sgt_element **ending;      /* [bands] */
    const sgt_ray_end *chief;  /* [fields] */
    size_t i;
    prove_cell cell;
    prove_asked asked;
    proof of;
} proving;

typedef void tell_proof(proving *w);

static void set_opd(proving *w, size_t f, const band *b)
{
    enum { RAYS = 6, POINTS = 1 + 3 * RAYS * (RAYS + 1) };
    const sgt_asking *a = w->ask;
    sgt_ray_end own;
    prove_cell *c = &w->cell;
    sgt_pupil_point at[POINTS];
    c->waves = a->study->um / b->at.um;
    c->has_opd = c->waves > 0 &&
                 sgt_trace_chief(a->from, &a->beam[f], b->element, b->before, &own, NULL) &&
                 sgt_reference_of(a->lens, &a->primary.data, b->element, b->before, &own, a->lens->afocal,
                                  &c->about, NULL);
    sgt_ray_end *end = c->has_opd ? sgt_launch_take(a->from, POINTS, sizeof *end) : NULL;
    if (!end) return;
    double sum = 0, count = 0;
    sgt_pupil_points(SGT_PATTERN_HEXAPOLAR, RAYS, 1, POINTS, at);
    const sgt_pupil_rays rays = {POINTS, at, end};
    if (sgt_trace_pupil(a->from, &a->beam[f], b->element, b->before, &rays, NULL, NULL))
        for (size_t k = 0; k < POINTS; k++) {
            const double opd = c->waves * sgt_opd(&c->about, &end[k], NULL);
            if (isfinite(opd)) sum += opd, count++;
        }
    sgt_launch_forget(a->from, end);
    c->middle = count > 0 ? sum / count : 0;
}

static void set_cell(proving *w, size_t i)
{
    const sgt_asking *a = w->ask;
    const size_t f = i / a->bands;
    const band *b = &a->band[i % a->bands];
    const sgt_ray_end *chief = &w->chief[f];
    w->i = i;
    w->cell = (prove_cell){.from = a->from, .beam = &a->beam[f], .count = a->lens->count,
                           .e = w->ending[i % a->bands], .before = b->before, .afocal = a->lens->afocal,
                           .has_reference = chief->fate == SGT_PASSED, .reference = chief->p,
                           .reference_err = chief->p_err, .opd = sgt_opd};
    if (w->cell.afocal) w->cell.reference = chief->d, w->cell.reference_err = chief->d_err;
    set_opd(w, f, b);
    w->asked = (prove_asked){.cell = &w->cell, .undecided = w->undecided / 100, .boxes = w->boxes,
                             .limits = w->limits, .limit = w->limit, .run = a->study->opt.run,
                             .context = a->study->opt.context};
}

static const char *name_of(const proving *w, char text[80])
{
    const sgt_asking *a = w->ask;
    const size_t number = a->number[w->i / a->bands];
    if (a->bands == 1) snprintf(text, 80, "field %zu", number);
    else snprintf(text, 80, "field %zu, %.6g \302\265m", number, a->band[w->i % a->bands].at.um);
    return text;
}

static void say_about(const proving *w)
{
    const sgt_asking *a = w->ask;
    char who[80];
    const double left = 100 * w->of.undecided;
    name_of(w, who);
    if (!w->cell.has_reference)
        sgt_ask_say(a, SGT_STUDY_NOTE, "%s: the chief ray does not get through, so there is no reference",
                who);
    if (!(w->of.passes + w->of.undecided > 0))
        sgt_ask_say(a, SGT_STUDY_NOTE, "%s: no ray of the pupil passes", who);
    if (w->of.spent && !w->limits && left > w->undecided)
        sgt_ask_say(a, SGT_STUDY_NOTE, "%s: %zu boxes were spent, and %.3g %% of the pupil is undecided; "
                                       "give more --boxes", who, w->of.carried, left);
    const prove_box *b = w->of.box;
    for (size_t i = 0; i < w->of.count; i++)
        if (w->of.box[i].hopeless && (!b->hopeless
                || sgt_sector_area(&w->of.box[i].of) > sgt_sector_area(&b->of)))
            b = &w->of.box[i];
    if (b->hopeless)
        sgt_ask_say(a, SGT_STUDY_NOTE, "%s: at element %zu no box can be decided: %s", who, b->element + 1,
                    sgt_box_why_text(b->why));
}

/* Has this element, or any if it is 0, a clear aperture? */
static bool has_clearance(const proving *w, size_t element)
{
    for (size_t i = 0; i < w->ask->lens->count; i++) {
        const sgt_element *e = &w->ending[0][i];
        const bool round = e->semi_diameter > 0 && e->semi_diameter < 0x1p500;
        if ((round || (e->aperture && e->aperture->count > 0)) &&
            (element == 0 || element == i + 1))
            return true;
    }
    return false;
}

/* ------------------------------------------------------------------------ shards
 *
 * A share has some of the fields at some of the wavelengths, a run of their numbers: of each it writes the
 * proof, box by box, which who joins reads. */
typedef struct proof_head {
    uint64_t count, carried, spent;
    double passes, stops, undecided;
    sgt_interval f_mean, w_mean, ww_mean;
} proof_head;

static void write_proof(proving *w)
{
    sgt_asking *a = w->ask;
    const proof *p = &w->of;
    const proof_head head = {.count = p->count,
                             .carried = p->carried,
                             .spent = p->spent,
                             .passes = p->passes,
                             .stops = p->stops,
                             .undecided = p->undecided,
                             .f_mean = p->f_mean,
                             .w_mean = p->w_mean,
                             .ww_mean = p->ww_mean};
    sgt_shard_put(a, sizeof head, &head);
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        prove_box plain;
        memset(&plain, 0, sizeof plain); /* what is written has no bytes that nothing set */
        plain.of = b->of, plain.fate = b->fate, plain.element = b->element, plain.why = b->why;
        plain.hopeless = b->hopeless, plain.bounded = b->bounded, plain.divide = b->divide;
        plain.f_sum = b->f_sum, plain.w_sum = b->w_sum, plain.ww_sum = b->ww_sum;
        plain.f = b->f, plain.w = b->w, plain.ww = b->ww;
        sgt_shard_put(a, sizeof plain, &plain);
    }
    sgt_shard_put(a, p->count * p->quantities * sizeof *p->bound, p->bound);
    sgt_shard_put(a, p->quantities * sizeof *p->most, p->most);
    sgt_shard_put(a, p->quantities * sizeof *p->seen, p->seen);
}

/* false: it failed, and has said so. */
static bool read_proof(proving *w, size_t share)
{
    sgt_asking *a = w->ask;
    proof *p = &w->of;
    proof_head head;
    *p = (proof){.asked = &w->asked, .quantities = prove_quantities(w->cell.count)};
    if (!sgt_shard_get(a, share, sizeof head, &head)) return false;
    if (head.count < 1 || head.count > SIZE_MAX / 64 / (p->quantities * sizeof *p->bound))
        return sgt_shard_wrong(a, share);
    p->count = head.count, p->carried = head.carried, p->spent = head.spent, p->passes = head.passes;
    p->stops = head.stops, p->undecided = head.undecided, p->f_mean = head.f_mean, p->w_mean = head.w_mean;
    p->ww_mean = head.ww_mean;
    p->box = sgt_launch_take(a->from, p->count, sizeof *p->box);
    p->bound = sgt_launch_take(a->from, p->count * p->quantities, sizeof *p->bound);
    p->most = sgt_launch_take(a->from, p->quantities, sizeof *p->most);
    p->seen = sgt_launch_take(a->from, p->quantities, sizeof *p->seen);
    if (!p->box || !p->bound || !p->most || !p->seen) return sgt_ask_fail(a, "", "no memory");
    for (size_t i = 0; i < p->count; i++)
        if (!sgt_shard_get(a, share, sizeof *p->box, &p->box[i])) return false;
    return sgt_shard_get(a, share, p->count * p->quantities * sizeof *p->bound, p->bound) &&
           sgt_shard_get(a, share, p->quantities * sizeof *p->most, p->most) &&
           sgt_shard_get(a, share, p->quantities * sizeof *p->seen, p->seen);
}

static void tell_one(proving *w, tell_proof *tell)
{
    say_about(w), tell(w);
    w->ask->total.fates.lost += w->of.undecided > w->undecided / 100;
}

/* Works on cells first ... end - 1; tell NULL: writes them. */
static void prove_run(proving *w, size_t first, size_t end, tell_proof *tell)
{
    sgt_asking *a = w->ask;
    for (size_t i = first; i < end && !a->failed; i++) {
        set_cell(w, i);
        if (!sgt_proof_run(&w->asked, &w->of)) sgt_ask_fail(a, "", "no memory");
        else if (tell) tell_one(w, tell);
        else write_proof(w);
        sgt_proof_free(&w->of);
    }
}

static bool prove_share(proving *w, sgt_shard_of_pass head, size_t k, size_t of)
{
    if (!sgt_shard_head(w->ask, 0, head)) return false;
    prove_run(w, sgt_shard_begin(head.cells, k, of), sgt_shard_begin(head.cells, k + 1, of), NULL);
    return !w->ask->failed;
}

static bool prove_cells(proving *w, tell_proof *tell)
{
    sgt_asking *a = w->ask;
    const sgt_shard *s = a->study->opt.shard;
    const size_t cells = a->fields * a->bands, of = s ? sgt_shard_shares(a, cells) : 0;
    const sgt_shard_of_pass head = {cells, 1, prove_quantities(a->lens->count)};
    if (!s) prove_run(w, 0, cells, tell);
    for (size_t k; s && s->next && (k = s->next(s->context, of)) != 0;)
        if (!prove_share(w, head, k, of)) return false;
    if (!s || (s->number && s->next)) return !a->failed;
    if (s->number) return prove_share(w, head, s->number, of);
    for (size_t k = 1; k <= of && !a->failed; k++) {
        if (!sgt_shard_head(a, k, head)) return false;
        for (size_t i = sgt_shard_begin(cells, k, of); i < sgt_shard_begin(cells, k + 1, of) && !a->failed;
             i++) {
            set_cell(w, i);
            if (read_proof(w, k)) tell_one(w, tell);
            sgt_proof_free(&w->of);
        }
    }
    return !a->failed;
}

/* Fields from the axis to the farthest one, in place of those of the study. */
static bool set_steps(sgt_asking *a, size_t steps)
{
    const sgt_lens_field far = *sgt_ask_farthest(a);
    if (strcmp(a->of->name, "prove") != 0)
        return sgt_ask_refuse(a, "steps", "goes with the shares and bounds of whole pupils alone");
    if (steps == 1) return sgt_ask_refuse(a, "steps", "2 or more");
    sgt_lens_field *at = sgt_ask_room(a, steps, sizeof *at);
    a->beam = sgt_ask_room(a, steps, sizeof *a->beam), a->number = sgt_ask_room(a, steps, sizeof *a->number);
    a->fields = steps, a->of_lens = false, a->at = at;
    for (size_t i = 0; i < steps && !a->failed; i++) {
        const double u = (double)i / (double)(steps - 1);
        at[i] = (sgt_lens_field){.x = u * far.x, .y = u * far.y, .weight = 1}, a->number[i] = i + 1;
        if (!sgt_launch_field(a->from, a->kind, &at[i], &a->beam[i], a->error)) a->failed = true;
    }
    return !a->failed;
}

static bool prove_each(sgt_asking *a, bool limits, tell_proof *tell)
{
    const sgt_prove_options *o = a->options;
    if (o->steps && !set_steps(a, o->steps)) return false;
    proving w = {.ask = a, .undecided = PER_CENT, .boxes = o->boxes ? o->boxes : BOXES};
    sgt_error why;
    if (o->undecided.count) w.undecided = o->undecided.at[0];
    if (!(w.undecided > 0 && w.undecided <= 100))
        return sgt_ask_refuse(a, "undecided", "must be above 0 and at most 100 per cent, not %g",
                w.undecided);
    if (limits) {
        if (!o->limit) return sgt_ask_refuse(a, "limit", "is missing: \"spot < 0.02\"");
        w.limits = sgt_prove_limit_read(o->limit, SGT_PROVE_LIMITS, w.limit, &why);
        if (!w.limits) return sgt_ask_refuse(a, "limit", "%s", why.words);
        for (size_t k = 0; k < w.limits; k++)
            if (w.limit[k].element > a->lens->count)
                return sgt_ask_refuse(a, "limit", "there is no element %zu: the lens has %zu",
                                      w.limit[k].element, a->lens->count);
    }
    sgt_element *first = a->primary.element;
    w.chief = sgt_ask_chiefs(a, 1, &first);
    w.ending = sgt_ask_room(a, a->bands, sizeof *w.ending);
    for (size_t b = 0; b < a->bands && !a->failed; b++) {
        w.ending[b] = sgt_ask_room(a, a->lens->count, sizeof **w.ending);
        if (w.ending[b]) sgt_launch_ending(a->lens->count, a->band[b].element, w.ending[b]);
    }
    if (a->failed) return false;
    for (size_t k = 0; k < w.limits; k++)
        if (w.limit[k].quantity == SGT_PROVE_CLEARANCE && !has_clearance(&w, w.limit[k].element))
            return w.limit[k].element
                       ? sgt_ask_refuse(a, "limit", "element %zu has no clear aperture, so there is no "
                                        "clearance", w.limit[k].element)
                       : sgt_ask_refuse(a, "limit", "no element has a clear aperture, so there is no "
                                        "clearance");
    if (a->from->aim != SGT_LENS_AIM_PUPIL)
        sgt_ask_say(a, SGT_STUDY_NOTE,
                    "the lens aims its rays at the stop; what is proven is of the paraxial "
                                       "pupil, as with --aim paraxial");
    return prove_cells(&w, tell);
}

/* ------------------------------------------------------------------------- a row */

static double share_of(const proof *p, size_t element, sgt_fate fate)
{
    double sum = 0;
    for (size_t i = 0; i < p->count; i++)
        if (p->box[i].fate == (int)fate && (element == SIZE_MAX || p->box[i].element == element))
            sum += sgt_sector_area(&p->box[i].of);
    for (size_t i = 0; i < p->count && fate == SGT_CLIPPED; i++)
        if (element == SIZE_MAX) sum += p->box[i].out;
        else if (p->box[i].element == element) sum += p->box[i].out_here;
    return 100 * sum;
}

/* A bound; NaN: no ray passes, or there is no reference. */
static double most_of(const proof *p, size_t q, bool known)
{
    return !known || p->most[q] == -HUGE_VAL ? (double)NAN : p->most[q];
}

static void tell_sums(proving *w)
{
    const sgt_asking *a = w->ask;
    const proof *p = &w->of;
    const bool known = w->cell.has_reference, waves = w->cell.has_opd;
    const double none = (double)NAN;
    const prove_seen nothing = {none, none, none}, *seen = p->seen;
    const prove_seen x = known ? seen[Q_EX] : nothing, y = known ? seen[Q_EY] : nothing;
    const prove_seen spot = known ? seen[Q_SPOT] : nothing;
    const prove_seen high = waves ? seen[Q_HIGH] : nothing, low = waves ? seen[Q_LOW] : nothing;
    sgt_interval rms = {none, none}, front = {none, none};
    if (known && p->passes + p->undecided > 0) rms = sgt_proof_rms(p->f_mean);
    if (waves && p->passes + p->undecided > 0) front = sgt_proof_rms_about_mean(p);
    const sgt_prove_row row = {
        .field = a->number[w->i / a->bands], .wavelength = a->band[w->i % a->bands].at.um,
        .passes = 100 * p->passes, .stops = 100 * p->stops, .undecided = 100 * p->undecided,
        .missed = share_of(p, SIZE_MAX, SGT_MISSED), .clipped = share_of(p, SIZE_MAX, SGT_CLIPPED),
        .tir = share_of(p, SIZE_MAX, SGT_TIR), .evanescent = share_of(p, SIZE_MAX, SGT_EVANESCENT),
        .ex = most_of(p, Q_EX, known), .ex_seen = x.value, .ex_px = x.x, .ex_py = x.y,
        .ey = most_of(p, Q_EY, known), .ey_seen = y.value, .ey_px = y.x, .ey_py = y.y,
        .spot = most_of(p, Q_SPOT, known), .spot_seen = spot.value, .spot_px = spot.x, .spot_py = spot.y,
        .rms_least = rms.lo, .rms = rms.hi,
        .opd_least = -most_of(p, Q_LOW, waves), .opd_most = most_of(p, Q_HIGH, waves),
        .pv = sgt_sum_above(most_of(p, Q_HIGH, waves), most_of(p, Q_LOW, waves)),
        .pv_seen = high.value + low.value, .low_px = low.x, .low_py = low.y, .high_px = high.x,
        .high_py = high.y, .opd_rms_least = front.lo, .opd_rms = front.hi, .boxes = p->carried,
        .spent = p->spent, .fx = a->at[w->i / a->bands].x, .fy = a->at[w->i / a->bands].y};
    sgt_ask_row(a, &row);
}

static bool ask_prove(sgt_asking *a)
{
    if (!prove_each(a, false, tell_sums)) return false;
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "Proven of every ray of the pupil.  passes, stops: these parts of its area "
                                     "certainly do.");
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "spot, pv: no ray that passes, or may pass, is beyond; ..._seen: of a ray "
                                     "that was traced.");
    sgt_ask_say(a, SGT_STUDY_LEGEND, "rms, opd_rms: over the area that passes, between ..._least and this.");
    return true;
}

/* ------------------------------------------------------------- element by element */

static void tell_elements(proving *w)
{
    const sgt_asking *a = w->ask;
    const proof *p = &w->of;
    for (size_t e = 0; e < a->lens->count; e++) {
        const size_t angle = prove_at_element(e, Q_INCIDENCE), in = prove_at_element(e, Q_INSIDE);
        const prove_seen *at = &p->seen[angle], *edge = &p->seen[in];
        const sgt_prove_element_row row = {
            .field = a->number[w->i / a->bands], .wavelength = a->band[w->i % a->bands].at.um,
            .element = e + 1, .missed = share_of(p, e, SGT_MISSED), .clipped = share_of(p, e, SGT_CLIPPED),
            .tir = share_of(p, e, SGT_TIR), .evanescent = share_of(p, e, SGT_EVANESCENT),
            .incidence = most_of(p, angle, true), .incidence_seen = at->value, .incidence_px = at->x,
            .incidence_py = at->y, .clearance = -most_of(p, in, true), .clearance_seen = -edge->value,
            .clearance_px = edge->x, .clearance_py = edge->y,
            .height = most_of(p, prove_at_element(e, Q_HEIGHT), true)};
        sgt_ask_row(a, &row);
    }
}

static bool ask_elements(sgt_asking *a)
{
    if (!prove_each(a, false, tell_elements)) return false;
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "missed, clipped, tir: parts of the pupil's area that certainly end there.");
    sgt_ask_say(a, SGT_STUDY_LEGEND, "No ray that passes has a larger incidence or height, or a smaller "
                                     "clearance from the edge of the clear aperture.");
    return true;
}

/* --------------------------------------------------------------------- box by box */

static void tell_regions(proving *w)
{
    const sgt_asking *a = w->ask;
    const proof *p = &w->of;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        const sgt_prove_region_row row = {
            .field = a->number[w->i / a->bands], .wavelength = a->band[w->i % a->bands].at.um,
            .r0 = b->of.r0, .r1 = b->of.r1, .angle0 = 360 * b->of.turn0, .angle1 = 360 * b->of.turn1,
            .fate = b->fate, .element = b->fate == SGT_PASSED ? 0 : b->element + 1,
            .share = 100 * sgt_sector_area(&b->of)};
        sgt_ask_row(a, &row);
    }
}

static bool ask_regions(sgt_asking *a)
{
    if (!prove_each(a, false, tell_regions)) return false;
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "Boxes of the pupil by radius and angle.  lost: not decided, as it is in "
                                     "doubt at that element.");
    return true;
}

/* -------------------------------------------------------------- samples, and the proof
 *
 * A REGION WITHOUT SAMPLES is made of the boxes that certainly end at one element by one cause, if no sample
 * ended there by that. */
static const double REGION_TOLD = 0.05, SHARE_TOLD = 1, WORST_TOLD = 1.1; /* per cent of the pupil; ratio */

typedef struct sampled {
    size_t rays, passed;
    double weight, through, spot, low, high;
    size_t *ended;              /* [elements * fates]: how many end at each */
} sampled;
enum { FATES_TOLD = SGT_EVANESCENT + 1 };

static bool sample(proving *w, sampled *out)
{
    sgt_asking *a = w->ask;
    const band *b = &a->band[w->i % a->bands];
    sgt_pupil_point at[PUPIL_PART];
    sgt_ray_end *end = sgt_launch_take(a->from, PUPIL_PART, sizeof *end);
    bool fine = end;
    *out = (sampled){.ended = sgt_launch_take(a->from, a->lens->count * FATES_TOLD, sizeof *out->ended),
                     .spot = (double)NAN, .low = (double)NAN, .high = (double)NAN};
    fine = fine && out->ended;
    if (out->ended) memset(out->ended, 0, a->lens->count * FATES_TOLD * sizeof *out->ended);
    for (size_t first = 0; fine && first < a->fine.count; first += PUPIL_PART) {
        const size_t left = a->fine.count - first, count = left < PUPIL_PART ? left : PUPIL_PART;
        sgt_pupil_part(&a->fine, first, count, at);
        fine = sgt_trace_pupil(a->from, &a->beam[w->i / a->bands], b->element, b->before,
                               &(sgt_pupil_rays){count, at, end}, NULL, NULL);
        for (size_t i = 0; fine && i < count; i++) {
            const bool through = end[i].fate == SGT_PASSED;
            out->rays++, out->passed += through, out->weight += at[i].weight,
                out->through += through ? at[i].weight : 0;
            if (!through && end[i].element < a->lens->count && (int)end[i].fate >= 0 &&
                (int)end[i].fate < FATES_TOLD)
                out->ended[end[i].element * FATES_TOLD + (size_t)end[i].fate]++;
            if (!through) continue;
            if (w->cell.has_reference) {
                sgt_ray_end one = end[i];
                sgt_vec3 from = w->cell.reference;
                if (w->cell.afocal)
                    sgt_ends_as_angles(&w->cell.reference, 1, &end[i], &one), from = (sgt_vec3){0, 0, 0};
                const double far = hypot(one.p.x - from.x, one.p.y - from.y);
                if (!(far <= out->spot)) out->spot = far;
            }
            if (w->cell.has_opd) {
                const double opd = w->cell.waves * sgt_opd(&w->cell.about, &end[i], NULL);
                if (!(opd <= out->high)) out->high = opd;
                if (!(opd >= out->low)) out->low = opd;
            }
        }
    }
    sgt_launch_forget(a->from, end);
    return fine || sgt_ask_fail(a, "", "no memory");
}

/* Which radii and how much of the pupil end at an element by a fate. */
typedef struct lost_region { double share, r0, r1; } lost_region;
static lost_region region_of(const proof *p, size_t element, int fate)
{
    lost_region out = {0, 1, 0};
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        if (b->fate != fate || b->element != element) continue;
        out.share += 100 * sgt_sector_area(&b->of), out.r0 = fmin(out.r0, b->of.r0),
                                                    out.r1 = fmax(out.r1, b->of.r1);
    }
    return out;
}

static const char *fate_said(int fate)
{
    return fate == SGT_TIR       ? "totally reflected"
           : fate == SGT_CLIPPED ? "clipped"
           : fate == SGT_MISSED  ? "missed"
                                 : "evanescent";
}

static const char *ray_said(const prove_seen *s, char text[60])
{
    snprintf(text, 60, "--pupil \"%.6g %.6g\"", s->x, s->y);
    return text;
}

/* What samples missed, in sentences; how many there are. */
static size_t say_unseen(const proving *w, const sampled *s)
{
    const sgt_asking *a = w->ask;
    const proof *p = &w->of;
    const char *unit = a->lens->afocal ? "mrad" : sgt_ask_units(a);
    char who[80], ray[60], other[60];
    size_t told = 0;
    name_of(w, who);
    for (size_t e = 0; e < a->lens->count; e++)
        for (int fate = 0; fate < FATES_TOLD; fate++) {
            const lost_region r = region_of(p, e, fate);
            if (fate == SGT_PASSED || fate == SGT_LOST || s->ended[e * FATES_TOLD + (size_t)fate] ||
                !(r.share > REGION_TOLD))
                continue;
            told++;
            sgt_ask_say(a, SGT_STUDY_NOTE,
                        "%s: %.3g %% of the pupil is %s at element %zu, where no ray of the sample fell "
                        "(radii %.4g to %.4g)",
                        who, r.share, fate_said(fate), e + 1, r.r0, r.r1);
        }
    const double share = s->weight > 0 ? 100 * s->through / s->weight : (double)NAN;
    if (!told &&
        (share > 100 * (p->passes + p->undecided) + SHARE_TOLD || share < 100 * p->passes - SHARE_TOLD)) {
        told++;
        sgt_ask_say(a, SGT_STUDY_NOTE,
                    "%s: of the sample %.4g %% passes; of the pupil %.4g %% certainly does, and %.4g %% "
                    "certainly does not",
                    who, share, 100 * p->passes, 100 * p->stops);
    }
    const prove_seen *far = &p->seen[Q_SPOT], *high = &p->seen[Q_HIGH], *low = &p->seen[Q_LOW];
    const double floor =
        1e-9 * (fabs(w->cell.reference.x) + fabs(w->cell.reference.y) + w->cell.beam->radius);
    if (w->cell.has_reference && far->value > WORST_TOLD * s->spot + floor) {
        told++;
        sgt_ask_say(a, SGT_STUDY_NOTE,
                    "%s: some ray ends %.4g %s from the chief ray (%s); those of the sample end within "
                    "%.4g",
                    who, far->value, unit, ray_said(far, ray), s->spot);
    }
    if (w->cell.has_opd && high->value + low->value > WORST_TOLD * (s->high - s->low) + 1e-6) {
        told++;
        sgt_ask_say(a, SGT_STUDY_NOTE,
                    "%s: path differences range over %.4g waves (%s, %s); those of the sample over %.4g", who,
                    high->value + low->value, ray_said(high, ray), ray_said(low, other), s->high - s->low);
    }
    return told;
}

static void tell_samples(proving *w)
{
    const sgt_asking *a = w->ask;
    const proof *p = &w->of;
    const double none = (double)NAN;
    sampled s;
    if (sample(w, &s)) {
        const size_t missed = say_unseen(w, &s);
        const bool known = w->cell.has_reference, waves = w->cell.has_opd;
        const sgt_prove_sample_row row = {
            .field = a->number[w->i / a->bands],
            .wavelength = a->band[w->i % a->bands].at.um,
            .rays = s.rays,
            .passed = s.passed,
            .sampled = s.weight > 0 ? 100 * s.through / s.weight : none,
            .passes = 100 * p->passes,
            .stops = 100 * p->stops,
            .undecided = 100 * p->undecided,
            .spot_sampled = s.spot,
            .spot_seen = known ? p->seen[Q_SPOT].value : none,
            .spot = most_of(p, Q_SPOT, known),
            .pv_sampled = s.high - s.low,
            .pv_seen = waves ? p->seen[Q_HIGH].value + p->seen[Q_LOW].value : none,
            .pv = sgt_sum_above(most_of(p, Q_HIGH, waves), most_of(p, Q_LOW, waves)),
            .missed = missed};
        sgt_ask_row(a, &row);
    }
    sgt_launch_forget(a->from, s.ended);
}

static bool ask_samples(sgt_asking *a)
{
    if (a->study->opt.shard)
        return sgt_ask_refuse(a, "shard", "samples are held against the proof in one run");
    return prove_each(a, false, tell_samples);
}

/* ------------------------------------------------------------------------- limits */

/* Does the ray break the limit with all that rounding may do to it? */
static bool breaks(const proving *w, const sgt_prove_limit *l, const proof_limit *found)
{
    const sgt_asking *a = w->ask;
    const band *b = &a->band[w->i % a->bands];
    const prove_seen *low = &w->of.seen[Q_LOW];
    const sgt_pupil_point at[2] = {{found->x, found->y, 1}, {low->x, low->y, 1}};
    sgt_ray_end end[2];
    const double slack = 1e-9 * fabs(l->value) + 1e-12 * fabs(found->seen);
    const bool length = l->quantity == SGT_PROVE_EX || l->quantity == SGT_PROVE_EY ||
                        l->quantity == SGT_PROVE_SPOT, opd = l->quantity == SGT_PROVE_OPD;
    if (isnan(found->x)) return true; /* of a mean or a share */
    if (!length && !opd)
        return l->quantity == SGT_PROVE_CLEARANCE ? found->seen < l->value - slack
                                                  : found->seen > l->value + slack;
    if (!sgt_trace_pupil(a->from, &a->beam[w->i / a->bands], b->element, b->before,
                         &(sgt_pupil_rays){opd ? 2 : 1, at, end}, NULL, NULL) ||
        end[0].fate != SGT_PASSED)
        return false;
    if (opd) {
        double off[2], one = sgt_opd(&w->cell.about, &end[0], &off[0]),
                       other = sgt_opd(&w->cell.about, &end[1], &off[1]);
        return w->cell.waves * (one - other - off[0] - off[1]) > l->value;
    }
    const double off = w->cell.afocal ? 1e3 * (end[0].d_err + w->cell.reference_err)
                                      : end[0].p_err + w->cell.reference_err;
    return found->seen - 2 * off > l->value;
}

static void tell_limits(proving *w)
{
    const sgt_asking *a = w->ask;
    for (size_t k = 0; k < w->limits; k++) {
        proof_limit found = sgt_proof_limit(&w->of, &w->limit[k]);
        if (found.verdict == SGT_LIMIT_BROKEN && !breaks(w, &w->limit[k], &found))
            found.verdict = SGT_LIMIT_UNDECIDED;
        const sgt_prove_limit_row row = {
            .field = a->number[w->i / a->bands], .wavelength = a->band[w->i % a->bands].at.um, .limit = k + 1,
            .verdict = found.verdict, .value = w->limit[k].value, .bound = found.bound, .seen = found.seen,
            .px = found.x, .py = found.y, .undecided = 100 * found.undecided, .boxes = w->of.carried};
        sgt_ask_row(a, &row);
    }
}

static bool ask_limits(sgt_asking *a)
{
    const sgt_prove_options *o = a->options;
    sgt_prove_limit limit[SGT_PROVE_LIMITS];
    char text[SGT_PROVE_LIMIT_SIZE];
    if (!prove_each(a, true, tell_limits)) return false;
    const size_t limits = sgt_prove_limit_read(o->limit, SGT_PROVE_LIMITS, limit, NULL);
    for (size_t k = 0; k < limits; k++) {
        static const char *const unit[] = {
            [SGT_PROVE_PASSES] = "% of the area of the pupil", [SGT_PROVE_OPD] = "waves",
            [SGT_PROVE_OPD_RMS] = "waves", [SGT_PROVE_INCIDENCE] = "degrees"};
        const sgt_prove_quantity q = limit[k].quantity;
        const char *in = q < sizeof unit / sizeof *unit && unit[q] ? unit[q]
                         : a->lens->afocal && q != SGT_PROVE_CLEARANCE ? "mrad"
                                                                       : a->lens->units;
        sgt_prove_limit_text(&limit[k], text);
        sgt_ask_say(a, SGT_STUDY_LEGEND, "limit %zu: %s%s%s", k + 1, text, *in ? " " : "", in);
    }
    return true;
}

/* ------------------------------------------------------------------------- tables */

#define SUM(member) offsetof(sgt_prove_row, member)
#define PLACE(of, title, x, y)                                                                              \
    {.name = #x, SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, SUM(x), 0, title},                    \
    {.name = #y, SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, SUM(y), 0, "in the pupil"}
static const sgt_column prove_columns[] = {
    {.name = "field", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SUM(field), 0, "the field, counted from 1"},
    COLUMN_WAVELENGTH(sgt_prove_row, 0),
    {.name = "passes", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, SUM(passes), 0,
     "of the area of the pupil, all rays of it pass"},
    {.name = "stops", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, SUM(stops), 0, "no ray of it passes"},
    {.name = "undecided", SGT_COLUMN_ERROR, SGT_UNIT_PERCENT, 0, SUM(undecided), 0, "what is left"},
    {.name = "missed", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, SGT_COLUMN_DETAIL, SUM(missed), 0,
     "parts of stops: all rays miss a surface,"},
    {.name = "clipped", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, SGT_COLUMN_DETAIL, SUM(clipped), 0,
     "are clipped,"},
    {.name = "tir", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, SGT_COLUMN_DETAIL, SUM(tir), 0,
     "are totally reflected,"},
    {.name = "evanescent", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, SGT_COLUMN_DETAIL, SUM(evanescent), 0,
     "or their order of a phase does not exist"},
    {.name = "ex", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, SGT_COLUMN_DETAIL, SUM(ex), 0,
     "no ray ends farther from the chief ray of the primary wavelength in x"},
    {.name = "ex_seen", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, SGT_COLUMN_DETAIL, SUM(ex_seen), 0,
     "the farthest ray that was traced,"},
    PLACE(ex, "from", ex_px, ex_py),
    {.name = "ey", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, SGT_COLUMN_DETAIL, SUM(ey), 0, "the same in y"},
    {.name = "ey_seen", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, SGT_COLUMN_DETAIL, SUM(ey_seen), 0, ""},
    PLACE(ey, "from", ey_px, ey_py),
    {.name = "spot", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SUM(spot), 0, "no ray ends farther from it"},
    {.name = "spot_seen", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SUM(spot_seen), 0,
     "the farthest ray that was traced,"},
    PLACE(spot, "from", spot_px, spot_py),
    {.name = "rms_least", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SUM(rms_least), 0,
     "root of the mean square of the distances, over the area that passes: at least"},
    {.name = "rms", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SUM(rms), 0, "and at most"},
    {.name = "opd_least", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, SGT_COLUMN_DETAIL, SUM(opd_least), 0,
     "no path difference is below,"},
    {.name = "opd_most", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, SGT_COLUMN_DETAIL, SUM(opd_most), 0,
     "and none above"},
    {.name = "pv", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SUM(pv), 0,
     "largest less smallest path difference: at most"},
    {.name = "pv_seen", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SUM(pv_seen), 0, "of rays that were traced,"},
    PLACE(low, "the smallest from", low_px, low_py),
    PLACE(high, "the largest from", high_px, high_py),
    {.name = "opd_rms_least", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SUM(opd_rms_least), 0,
     "root of their mean square about the mean, over the area that passes: at least"},
    {.name = "opd_rms", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SUM(opd_rms), 0, "and at most"},
    {.name = "boxes", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SUM(boxes), 0, "how many were carried through"},
    {.name = "spent", SGT_COLUMN_COUNT, SGT_UNIT_NONE, SGT_COLUMN_DETAIL, SUM(spent), 0,
     "1: as many as were allowed, so more of them would bring closer bounds"},
    {.name = "fx", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, SGT_COLUMN_DETAIL, SUM(fx), 0, "the field,"},
    {.name = "fy", SGT_COLUMN_NUMBER, SGT_UNIT_FIELD, SGT_COLUMN_DETAIL, SUM(fy), 0,
     "as the lens gives it: degrees, or a height"},
};

#define EACH(member) offsetof(sgt_prove_element_row, member)
static const sgt_column elements_columns[] = {
    COLUMN_FIELD(sgt_prove_element_row),
    COLUMN_WAVELENGTH(sgt_prove_element_row, SGT_COLUMN_GROUPS),
    {.name = "element", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, EACH(element), 0, "counted from 1"},
    {.name = "missed", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, EACH(missed), 0,
     "of the area of the pupil: all rays of it end here, as they miss,"},
    {.name = "clipped", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, EACH(clipped), 0, "are clipped,"},
    {.name = "tir", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, EACH(tir), 0, "are totally reflected,"},
    {.name = "evanescent", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, SGT_COLUMN_DETAIL, EACH(evanescent), 0,
     "or their order of a phase does not exist"},
    {.name = "incidence", SGT_COLUMN_NUMBER, SGT_UNIT_DEGREE, 0, EACH(incidence), 0,
     "no ray that passes has a larger angle of incidence"},
    {.name = "incidence_seen", SGT_COLUMN_NUMBER, SGT_UNIT_DEGREE, 0, EACH(incidence_seen), 0,
     "the largest of rays that were traced,"},
    {.name = "incidence_px", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, EACH(incidence_px), 0,
     "from"},
    {.name = "incidence_py", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, EACH(incidence_py), 0,
     "in the pupil"},
    {.name = "clearance", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, EACH(clearance), 0,
     "no ray that passes is nearer to the edge of the clear aperture"},
    {.name = "clearance_seen", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, EACH(clearance_seen), 0,
     "the nearest that was traced,"},
    {.name = "clearance_px", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, EACH(clearance_px), 0,
     "from"},
    {.name = "clearance_py", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, SGT_COLUMN_DETAIL, EACH(clearance_py), 0,
     "in the pupil"},
    {.name = "height", SGT_COLUMN_NUMBER, SGT_UNIT_LENGTH, 0, EACH(height), 0,
     "no ray that passes is farther from the axis of the element"},
};

#define REGION(member) offsetof(sgt_prove_region_row, member)
static const sgt_column regions_columns[] = {
    COLUMN_FIELD(sgt_prove_region_row),
    COLUMN_WAVELENGTH(sgt_prove_region_row, SGT_COLUMN_GROUPS),
    {.name = "r0", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, 0, REGION(r0), 0,
     "a box of the pupil: from this radius"},
    {.name = "r1", SGT_COLUMN_EXACT, SGT_UNIT_PUPIL, 0, REGION(r1), 0, "to this,"},
    {.name = "angle0", SGT_COLUMN_EXACT, SGT_UNIT_DEGREE, 0, REGION(angle0), 0,
     "from this angle, from px toward py,"},
    {.name = "angle1", SGT_COLUMN_EXACT, SGT_UNIT_DEGREE, 0, REGION(angle1), 0, "to this"},
    {.name = "fate", SGT_COLUMN_FATE, SGT_UNIT_NONE, 0, REGION(fate), 0,
     "what becomes of all its rays; lost: not decided"},
    {.name = "element", SGT_COLUMN_PLACE, SGT_UNIT_NONE, 0, REGION(element), 0,
     "where they end, counted from 1; not decided: where it is in doubt"},
    {.name = "share", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, REGION(share), 0, "of the area of the pupil"},
};

#define SAMPLE(member) offsetof(sgt_prove_sample_row, member)
static const sgt_column samples_columns[] = {
    {.name = "field", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SAMPLE(field), 0, "the field, counted from 1"},
    COLUMN_WAVELENGTH(sgt_prove_sample_row, 0),
    {.name = "rays", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SAMPLE(rays), 0, "how many the sample has,"},
    {.name = "passed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SAMPLE(passed), 0, "how many of them pass,"},
    {.name = "sampled", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, SAMPLE(sampled), 0, "and what they weigh"},
    {.name = "passes", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, SAMPLE(passes), 0,
     "of the area of the pupil, all rays of it pass"},
    {.name = "stops", SGT_COLUMN_NUMBER, SGT_UNIT_PERCENT, 0, SAMPLE(stops), 0, "no ray of it passes"},
    {.name = "undecided", SGT_COLUMN_ERROR, SGT_UNIT_PERCENT, 0, SAMPLE(undecided), 0, "what is left"},
    {.name = "spot_sampled", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SAMPLE(spot_sampled), 0,
     "the largest distance from the chief ray of the primary wavelength: of the sample,"},
    {.name = "spot_seen", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SAMPLE(spot_seen), 0,
     "of a ray that the proof traced,"},
    {.name = "spot", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, SAMPLE(spot), 0, "of any ray at most"},
    {.name = "pv_sampled", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SAMPLE(pv_sampled), 0,
     "largest less smallest path difference: of the sample,"},
    {.name = "pv_seen", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SAMPLE(pv_seen), 0,
     "of rays that the proof traced,"},
    {.name = "pv", SGT_COLUMN_NUMBER, SGT_UNIT_WAVE, 0, SAMPLE(pv), 0, "of all rays at most"},
    {.name = "missed", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, SAMPLE(missed), 0,
     "in how many ways they differ, as notes say"},
};

#define LIMIT(member) offsetof(sgt_prove_limit_row, member)
static const sgt_column limits_columns[] = {
    COLUMN_FIELD(sgt_prove_limit_row),
    COLUMN_WAVELENGTH(sgt_prove_limit_row, 0),
    {.name = "limit", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, LIMIT(limit), 0, "which limit, counted from 1"},
    {.name = "verdict", SGT_COLUMN_VERDICT, SGT_UNIT_NONE, 0, LIMIT(verdict), 0,
     "proven of every ray; broken, by the ray of px, py; undecided; empty: no ray passes"},
    {.name = "value", SGT_COLUMN_EXACT, SGT_UNIT_NONE, 0, LIMIT(value), 0, "of the limit"},
    {.name = "bound", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, LIMIT(bound), 0, "no ray is beyond"},
    {.name = "seen", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, LIMIT(seen), 0,
     "of the worst ray that was traced; of a mean or a share: the other bound"},
    {.name = "px", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, 0, LIMIT(px), 0, "this ray; of pv the largest"},
    {.name = "py", SGT_COLUMN_NUMBER, SGT_UNIT_PUPIL, 0, LIMIT(py), 0, "in the pupil"},
    {.name = "undecided", SGT_COLUMN_ERROR, SGT_UNIT_PERCENT, 0, LIMIT(undecided), 0,
     "of the area of the pupil: where it may be broken, unless it is decided"},
    {.name = "boxes", SGT_COLUMN_COUNT, SGT_UNIT_NONE, 0, LIMIT(boxes), 0, "how many were carried through"},
};

#define UNDECIDED_SETTING                                                                                   \
    {                                                                                                       \
        .name = "undecided", SGT_SETTING_NUMBER, offsetof(sgt_prove_options, undecided), NULL, 0, 0,        \
            "per cent of the pupil's area that may stay undecided (default 0.1)"                            \
    }
#define BOXES_SETTING                                                                                       \
    {                                                                                                       \
        .name = "boxes", SGT_SETTING_COUNT, offsetof(sgt_prove_options, boxes), NULL, 1, 100000000,         \
            "at most so many boxes a field and wavelength (default 10000)"                                  \
    }
static const sgt_setting prove_settings[] = {
    UNDECIDED_SETTING, BOXES_SETTING,
    {.name = "steps", SGT_SETTING_COUNT, offsetof(sgt_prove_options, steps), NULL, 2, 10000,
     "of so many fields from the axis to the farthest one, without vignetting but by apertures"}};
static const sgt_setting limits_settings[] = {
    BOXES_SETTING,
    {.name = "limit", SGT_SETTING_TEXT, offsetof(sgt_prove_options, limit), NULL, 0, 0,
     "limits for every ray: \"spot < 0.02; incidence[3] < 40; pass > 99.9\"; of pass (per cent of the "
     "pupil's area), ex, ey, spot, rms (lengths; of an afocal lens mrad), opd, wavefront (waves, peak to "
     "valley and rms), incidence (degrees), clearance (from the edge of the clear aperture)"},
};

#define PROVE_HELP                                                                                          \
    "by boxes of the pupil, whose rays are carried through the lens together.  What is told is proven of "   \
    "every ray of the paraxial pupil, not of samples."

const sgt_analysis sgt_prove_analysis = {
    .name = "prove", .title = "every ray of the pupil: what certainly passes, and bounds",
    .help = "What certainly becomes of the rays of each field and wavelength, and bounds that none leaves, "
            PROVE_HELP,
    .no_rays = true, .draw_x = "field", .draw_y = "passes", ROWS_OF(sgt_prove_row, prove_columns),
    OPTIONS_OF(sgt_prove_options), SETTINGS_OF(prove_settings), .ask = ask_prove};

const sgt_analysis sgt_prove_elements_analysis = {
    .name = "prove_elements", .title = "every ray of the pupil, element by element", .part_of = "prove",
    .help = "Where rays certainly end, and bounds on angles of incidence and on distances to the edges of "
            "clear apertures at each element, " PROVE_HELP,
    .no_rays = true, ROWS_OF(sgt_prove_element_row, elements_columns), OPTIONS_OF(sgt_prove_options),
    SETTINGS_OF(prove_settings), .ask = ask_elements};

const sgt_analysis sgt_prove_regions_analysis = {
    .name = "prove_regions", .title = "the boxes of the pupil", .part_of = "prove",
    .help = "The boxes of the pupil, and what certainly becomes of the rays of each, " PROVE_HELP,
    .no_rays = true, ROWS_OF(sgt_prove_region_row, regions_columns), OPTIONS_OF(sgt_prove_options),
    SETTINGS_OF(prove_settings), .ask = ask_regions};

const sgt_analysis sgt_prove_limits_analysis = {
    .name = "prove_limits", .title = "limits for every ray", .part_of = "prove",
    .help = "Limits for every ray that passes: proven, broken or undecided, " PROVE_HELP,
    .no_rays = true, ROWS_OF(sgt_prove_limit_row, limits_columns), OPTIONS_OF(sgt_prove_options),
    SETTINGS_OF(limits_settings), .ask = ask_limits};

const sgt_analysis sgt_prove_samples_analysis = {
    .name = "prove_samples", .title = "rays of a sample, against every ray of the pupil", .part_of = "prove",
    .help = "What the rays of a pattern say of passing, of distances and path differences, beside what is "
            "true of every ray, " PROVE_HELP,
    .pattern = SGT_PATTERN_HEXAPOLAR, .rays = 6, ROWS_OF(sgt_prove_sample_row, samples_columns),
    OPTIONS_OF(sgt_prove_options), SETTINGS_OF(prove_settings), .ask = ask_samples};
