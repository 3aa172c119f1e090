// SPDX-License-Identifier: MIT
/* energy.c - encircled energy: how much of the light falls within a radius about a point of the image.
 *
 * It is geometrical: the share of the rays that pass, each with its weight, whose distance is at most the
 * radius.  Diffraction is not in it, so below the Airy radius it says nothing of a real image.
 *
 * The point is one for all wavelengths of a field: the centroid of all their rays, or the end of the chief
 * ray.  So the rays are traced twice or thrice: for the centroid, for the largest distance (unless radii are
 * given), and to be counted.
 *
 * UNSURE.  A ray is off by its p_err, and the point by its own.  If the radius lies between the distance less
 * both and the distance plus both, it is not certain on which side the ray is: its weight counts as unsure.
 * So rounding moves the fraction by no more than that share. */
#include "spot.h"

#include <string.h>

enum { RADII = 20, RADII_MOST = 1000 };

/* What is known of each field: the point, and of each cell (field * bands + band) the sums. */
typedef struct energy {
    spots of;                   /* of one image surface */
    spot_middle *middle;        /* [cells] */
    sgt_ray_end *about;         /* [fields]: p, p_err */
    double far;                 /* the largest distance */
    size_t steps;
    double *radius;             /* [steps], rising */
    double *within, *unsure; /* [cells * steps]: weight up to that radius but not the one before; about it */
    double *beyond;             /* [cells]: the weight beyond the last radius */
} energy;

static bool energy_place(const pass *p, size_t i, cell *out, sgt_error *fault)
{
    return sgt_place_study(p, i, out, fault);
}

/* --------------------------------------------------------------------- the point */

static void middle_of_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const energy *e = p->data;
    sgt_spots_angles(&e->of, i, count, end);
    sgt_middle_add(sum, (sgt_vec2){0, 0}, count, end);
}

static void keep_middle(const pass *p, size_t i, const sgt_fates *fates, void *sum)
{
    energy *e = p->data;
    (void)fates;
    e->middle[i] = sgt_middle_rounded(sum);
}

static void energy_points(energy *e, bool centroid)
{
    const sgt_asking *a = e->of.ask;
    for (size_t f = 0; f < a->fields; f++) {
        spot_middle all = {.w = 0};
        e->about[f] = e->of.centre[f];
        for (size_t b = 0; b < a->bands && centroid; b++)
            sgt_middle_join(&all, &e->middle[f * a->bands + b], sgt_spots_weight(a, b));
        if (!centroid) continue;
        const sgt_vec2 at = sgt_middle_of(&all);
        e->about[f].p = (sgt_vec3){at.x, at.y, 0}, e->about[f].p_err = all.off / all.w;
    }
}

/* ------------------------------------------------------------------ the distances */

static double distance_of(const sgt_ray_end *end, const sgt_ray_end *about)
{
    return hypot(end->p.x - about->p.x, end->p.y - about->p.y);
}

static void far_of_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const energy *e = p->data;
    double *far = sum;
    sgt_spots_angles(&e->of, i, count, end);
    for (size_t k = 0; k < count; k++)
        if (end[k].fate == SGT_PASSED) *far = fmax(*far, distance_of(&end[k], &e->about[i / p->ask->bands]));
}

static void keep_far(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    energy *e = p->data;
    double far;
    (void)i, (void)count, (void)end;
    memcpy(&far, sum, sizeof far);
    e->far = fmax(e->far, far);
}

/* The first radius that is not below x; steps: there is none. */
static size_t radius_from(const energy *e, double x)
{
    size_t low = 0, high = e->steps;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (e->radius[middle] < x) low = middle + 1;
        else high = middle;
    }
    return low;
}

/* A block's sums: weight within each radius, unsure at each, and beyond the last. */
static void count_block(const pass *p, size_t i, size_t count, sgt_ray_end end[], void *sum)
{
    const energy *e = p->data;
    const sgt_ray_end *about = &e->about[i / p->ask->bands];
    double *within = sum, *unsure = within + e->steps, *beyond = unsure + e->steps;
    sgt_spots_angles(&e->of, i, count, end);
    for (size_t k = 0; k < count; k++) {
        if (end[k].fate != SGT_PASSED) continue;
        const double r = distance_of(&end[k], about), off = end[k].p_err + about->p_err;
        const size_t first = radius_from(e, r);
        *(first < e->steps ? &within[first] : beyond) += end[k].weight;
        for (size_t s = radius_from(e, r - off); s < e->steps && e->radius[s] <= r + off; s++)
            unsure[s] += end[k].weight;
    }
}

static void keep_counts(const pass *p, size_t i, size_t count, const sgt_ray_end end[], const void *sum)
{
    energy *e = p->data;
    const double *within = sum, *unsure = within + e->steps;
    (void)count, (void)end;
    for (size_t s = 0; s < e->steps; s++)
        e->within[i * e->steps + s] += within[s], e->unsure[i * e->steps + s] += unsure[s];
    e->beyond[i] += unsure[e->steps];
}

/* Sets the point, the radii if there are none, and counts. */
static bool count_all(energy *e, const sgt_pupil *points, bool centroid, bool counts)
{
    sgt_asking *a = e->of.ask;
    const size_t cells = e->of.cells;
    pass p = {.ask = a, .points = points, .cells = cells, .wanted = END_POINT, .data = e,
              .place = energy_place, .lost = sgt_lost_study};
    e->middle = sgt_ask_room(a, cells, sizeof *e->middle);
    e->about = sgt_ask_room(a, a->fields, sizeof *e->about);
    if (a->failed) return false;
    if (counts) p.wanted |= END_POINT_ERROR; /* coarse: for its fraction alone */
    a->counts = false;
    p.before = true; /* the point, and the radii */
    p.size = sizeof(middle_sum), p.block = middle_of_block, p.merge = sgt_spots_merge_middles;
    p.exact = true, p.end = keep_middle;
    if (centroid && !sgt_ask_pass(&p)) return false;
    p.merge = NULL, p.end = NULL;
    energy_points(e, centroid);
    p.size = sizeof(double), p.block = far_of_block, p.take = keep_far;
    if (!e->radius) {
        e->radius = sgt_ask_room(a, e->steps, sizeof *e->radius);
        if (!e->radius || !sgt_ask_pass(&p)) return false;
        for (size_t s = 0; s < e->steps; s++) e->radius[s] = e->far * ((double)(s + 1) / (double)e->steps);
    }
    e->within = sgt_ask_room(a, cells * e->steps, sizeof *e->within);
    e->unsure = sgt_ask_room(a, cells * e->steps, sizeof *e->unsure);
    e->beyond = sgt_ask_room(a, cells, sizeof *e->beyond);
    if (a->failed) return false;
    a->counts = counts;
    p.before = false;
    p.size = (2 * e->steps + 1) * sizeof(double), p.block = count_block, p.take = keep_counts;
    return sgt_ask_pass(&p);
}

/* -------------------------------------------------------------------------- rows */

/* Of the bands first ... end - 1 of a field together: the fraction within radius s, and the share that is
 * unsure. */
static double fraction_of(const energy *e, size_t field, size_t first, size_t end, size_t s, double *unsure)
{
    const sgt_asking *a = e->of.ask;
    double within = 0, about = 0, passed = 0;
    for (size_t b = first; b < end; b++) {
        const size_t i = field * a->bands + b;
        const double weight = end - first > 1 ? sgt_spots_weight(a, b) : 1;
        double own = 0, all;
        for (size_t k = 0; k <= s; k++) own += e->within[i * e->steps + k];
        all = own; /* so that a fraction of all is 1, not some ulps less */
        for (size_t k = s + 1; k < e->steps; k++) all += e->within[i * e->steps + k];
        all += e->beyond[i];
        within += weight * own, about += weight * e->unsure[i * e->steps + s], passed += weight * all;
    }
    *unsure = about / passed;
    return within / passed;
}

static void energy_rows(const energy *fine, const energy *coarse, size_t field, size_t first, size_t end,
                        double um)
{
    const sgt_asking *a = fine->of.ask;
    for (size_t s = 0; s < fine->steps; s++) {
        double unused;
        sgt_energy_row row = {.field = a->number[field], .wavelength = um, .radius = fine->radius[s]};
        row.fraction = fraction_of(fine, field, first, end, s, &row.unsure);
        row.sampling = row.fraction - fraction_of(coarse, field, first, end, s, &unused);
        sgt_ask_row(a, &row);
    }
}

/* The radii that are given, in rising order. */
static bool set_radii(energy *e, const sgt_list *given)
{
    sgt_asking *a = e->of.ask;
    if (!given->count) return true;
    e->steps = given->count;
    e->radius = sgt_ask_room(a, e->steps, sizeof *e->radius);
    for (size_t i = 0; i < e->steps && e->radius; i++) {
        size_t at = i;
        if (!(given->at[i] > 0)) return sgt_ask_refuse(a, "radius", "must be above 0, not %g", given->at[i]);
        for (; at > 0 && e->radius[at - 1] > given->at[i]; at--) e->radius[at] = e->radius[at - 1];
        e->radius[at] = given->at[i];
    }
    return e->radius;
}

static bool ask_energy(sgt_asking *a)
{
    const sgt_energy_options *o = a->options;
    const bool centroid = o->reference == 0;
    energy fine = {.steps = o->steps ? o->steps : RADII};
    if (o->radius.count > RADII_MOST) return sgt_ask_refuse(a, "radius", "%d at most", RADII_MOST);
    if (!sgt_spots_begin(a, centroid, NULL, &fine.of) || !set_radii(&fine, &o->radius)) return false;
    sgt_spots_say_reference(&fine.of);
    if (!count_all(&fine, &a->fine, centroid, true)) return false;
    energy coarse = {.of = fine.of, .steps = fine.steps, .radius = fine.radius};
    if (!count_all(&coarse, &a->coarse, centroid, false)) return false;
    for (size_t f = 0; f < a->fields; f++) {
        for (size_t b = 0; b < a->bands; b++) energy_rows(&fine, &coarse, f, b, b + 1, a->band[b].at.um);
        energy_rows(&fine, &coarse, f, 0, a->bands, SGT_ALL_WAVELENGTHS);
    }
    sgt_ask_say(a, SGT_STUDY_LEGEND,
                "fraction: of the light that passes, within the radius about %s, without "
                "diffraction.",
                centroid ? "the centroid of all wavelengths" : "the chief ray of the primary wavelength");
    return true;
}

/* ------------------------------------------------------------------------ tables */

#define ENERGY_AT(member) offsetof(sgt_energy_row, member)
static const sgt_column energy_columns[] = {
    COLUMN_FIELD(sgt_energy_row),
    COLUMN_WAVELENGTH(sgt_energy_row, SGT_COLUMN_GROUPS),
    {.name = "radius", SGT_COLUMN_NUMBER, SGT_UNIT_IMAGE, 0, ENERGY_AT(radius), 0, "about the reference"},
    {.name = "fraction", SGT_COLUMN_NUMBER, SGT_UNIT_NONE, 0, ENERGY_AT(fraction), 0,
     "of the light that passes: how much falls within the radius, 0 to 1"},
    {.name = "unsure", SGT_COLUMN_ERROR, SGT_UNIT_NONE, 0, ENERGY_AT(unsure), 0,
     "the share of which rounding leaves open whether it does: the fraction is off by no more"},
    {.name = "sampling", SGT_COLUMN_ERROR, SGT_UNIT_NONE, 0, ENERGY_AT(sampling), 0,
     "fraction, less that of half as many rays across the pupil"},
};

static const sgt_setting energy_settings[] = {
    {.name = "reference", SGT_SETTING_WORD, offsetof(sgt_energy_options, reference), "centroid|chief", 0, 0,
     "centroid (the default): the mean of the rays of all wavelengths; chief: where the chief ray of the "
     "primary "
     "wavelength ends"},
    {.name = "radius", SGT_SETTING_NUMBERS, offsetof(sgt_energy_options, radius), NULL, 0, 0,
     "the radii, in the unit of the image"},
    {.name = "steps", SGT_SETTING_COUNT, offsetof(sgt_energy_options, steps), NULL, 1, RADII_MOST,
     "or so many, up to the largest distance in any field (default 20)"},
};

const sgt_analysis sgt_energy_analysis = {.name = "energy",
                                          .title = "encircled energy",
                                          .help = "Encircled energy: how much of the light of a field falls "
                                                  "within a radius about a point of the image, "
                                                  "as rays have it, without diffraction.",
                                          .pattern = SGT_PATTERN_CELLS,
                                          .rays = 64,
                                          .draw_x = "radius",
                                          .draw_y = "fraction",
                                          .row_size = sizeof(sgt_energy_row),
                                          .columns = sizeof energy_columns / sizeof *energy_columns,
                                          .column = energy_columns,
                                          OPTIONS_OF(sgt_energy_options),
                                          .settings = sizeof energy_settings / sizeof *energy_settings,
                                          .setting = energy_settings,
                                          .ask = ask_energy};
