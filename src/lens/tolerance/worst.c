// SPDX-License-Identifier: MIT
/* worst.c - the worst case of a tolerance, proven: a figure that no lens of the box exceeds.
 *
 * A box of values of all entries is carried through the lens with every ray of the figure (prove/wide.c):
 * entry i is v = middle + half s[i], and all numbers of the lens follow as build.c makes them: curvatures,
 * indices, places, shapes; and the pupil as first_order.c finds it.  So the distance of a ray from the chief
 * ray is
 *
 *     e(s) = a + B s,  to a rest,
 *
 * with the same s in all rays: what cancels between entries, or over the pupil, does so in the sum.
 *
 * THE FIGURE is a norm over the rays, each with its weight: F = |a + B s + r| <= |a + B s| + |rest|
 * (Minkowski).  With z = (1, s), |a + B s|^2 = z' G z, G = (a B)' (a B).  If D is a diagonal with D - G not
 * negative, z' G z <= z' D z <= the sum of D, as all |z[i]| <= 1.  D begins as the sums of |G| along rows and
 * is made smaller by coordinate steps on sum D - mu log det(D - G), mu falling.  By Nesterov (1998,
 * Optimization Methods and Software 9, 141) the least such sum is at most pi / 2 times the largest z' G z, so
 * the bound of F is at most 1.26 times what is so at some corner, but for rests.  That D - G is not negative
 * is decided by a Cholesky decomposition of a little less (Rump 2006, BIT 46, 433).
 *
 * RAYS THAT MAY BE CLIPPED.  With P the rays that pass in every lens and U those that may, the mean square
 * over those that pass is at most the sum over P and U by the weight of P.
 *
 * COMPENSATORS.  A paraxial one is where the paraxial image says.  One that seeks the best figure is at least
 * as good as any rule for it: the rule here is a straight line, by the derivatives of slope.c.
 *
 * A BOX IS CUT into halves along the entry whose part in D is largest, worst box first.  Both what D gives
 * away and the rests, which are of second order, get smaller.
 *
 * THE WORST LENS THAT IS SEEN is sought among corners: by that quadratic form, changing one sign at a time,
 * from several starts, and from the best of them by the figure itself.
 *
 * ROUNDING.  Wide numbers hold their own.  What edits round when a lens is built, and a trace that follows,
 * is below BUILT of each number, which is added; of the figure, below ROUNDED of it. */
#include "../optics/launch.h"
#include "../prove/wide.h"
#include "tolerance.h"

#include <sagitta/prove.h>
#include <sagitta/surfaces.h>

#include <stdio.h>
#include <string.h>

/* SHARED: parameters behind those of the entries, of what is not known of the pupil. */
enum { WORST_BOXES = 32, BATCH_OF_RAYS = 8, SHARED = 2, Z = WIDE + 1 };
static const double BUILT = 0x1p-42, ROUNDED = 1e-9, RADIANS = 0.017453292519943295;

typedef struct worst_ray {
    size_t field, band;
    double px, py, weight;
    bool chief;
} worst_ray;
typedef struct worst_end {
    wide_fate fate;
    size_t element;
    sgt_box_why why;
    wide x, y;
} worst_end;
typedef struct worst_band {
    double um, before, weight;
    sgt_element *e;
} worst_band;

/* What an entry moves by each unit of its value; built at its end. */
typedef struct entry_moves {
    sgt_vec3 *by;
    double *z, *bend;
} entry_moves;

typedef struct worst_box {
    double bound, lo[WIDE], hi[WIDE], part[WIDE];
} worst_box;

typedef struct worst {
    const sgt_tolerancing *t;
    arena memory;
    sgt_error *error;
    size_t count, n; /* elements; entries */
    sgt_launcher *from;
    size_t fields, bands, rays, chiefs, primary;
    sgt_field_beam *beam; /* [fields] */
    double *field_weight;
    sgt_lens_field *at; /* [fields]: in the kind of the lens, or another */
    sgt_field_kind kind;
    worst_band *band; /* the last is the primary one */
    worst_ray *ray;   /* [rays]: chief rays first, one of each field */
    size_t room;
    worst_end *end;
    sgt_pose *pose;     /* [count], with axes */
    entry_moves *moves; /* [n] */
    double extent;      /* a length, as long as the lens */
    wide_shape *shape;  /* [n]: of irregularities */
    wide *amount;       /* those of an element side by side: [n] */
    size_t *shapes_at;  /* [count + 1]: where they begin */
    double *follow;     /* [n]: where compensators that seek are, by each entry; the first */
    double *settled;    /* [n]: as designed */
    size_t seeker;
    /* of a box */
    wide *value;         /* [n] */
    wide *c, *z, *index; /* [count]: added to curvature; the place on the axis; added to the index */
    bool *bends;         /* is c off? */
    wide_motion *motion; /* [count]: into the frame of each, from that in front; 0: global */
    wide pupil, radius;
    wide *object; /* [2 fields]: of objects at a distance by angles */
} worst;

static bool fail_worst(worst *w, const char *key, const char *words)
{
    *w->error = (sgt_error){.line = w->t->of->line};
    snprintf(w->error->file, sizeof w->error->file, "%s", w->t->of->file);
    snprintf(w->error->key, sizeof w->error->key, "%s", key);
    snprintf(w->error->words, sizeof w->error->words, "%s", words);
    return false;
}

static bool fail_entry(worst *w, size_t i, const char *why)
{
    char about[SGT_TOLERANCE_SIZE], words[2 * SGT_TOLERANCE_SIZE], key[32];
    sgt_tolerance_text(&w->t->entry[i], about);
    snprintf(words, sizeof words, "%s: its worst case is not known: %s", about, why);
    snprintf(key, sizeof key, "tolerances[%zu]", i + 1);
    fail_worst(w, key, words);
    w->error->line = w->t->entry[i].line;
    return false;
}

static void *take_room(worst *w, size_t count, size_t size)
{
    void *room = sgt_arena_take(&w->memory, count * size + 1);
    if (room)
        memset(room, 0, count * size);
    else
        fail_worst(w, "", "no memory");
    return room;
}

/* ------------------------------------------------------------------------- the rays */

static void take_end(void *context, const void *row)
{
    worst *w = context;
    const sgt_ends_row *r = row;
    const sgt_study_options *o = &w->t->study;
    size_t f = r->field - 1;
    if (o->fields && o->field)
        for (f = 0; f + 1 < o->fields && o->field[f] != r->field;) f++;
    size_t b = 0;
    while (b + 1 < w->bands && w->band[b].um != r->wavelength) b++;
    if (w->rays == w->room) {
        const sgt_allocator *a = &w->memory.allocator;
        worst_ray *more = a->resize(a->context, w->ray, (2 * w->room + 64) * sizeof *more);
        if (!more) return;
        w->ray = more, w->room = 2 * w->room + 64;
    }
    w->ray[w->rays++] = (worst_ray){f, b, r->end.px, r->end.py, r->end.weight, false};
}

static bool set_worst_bands(worst *w)
{
    const sgt_lens *l = w->t->base;
    const sgt_study_options *o = &w->t->study;
    const bool chief = w->t->opt.figure == SGT_TOLERANCING_BORESIGHT;
    w->bands = chief ? 0 : o->wavelengths ? o->wavelengths : l->wavelengths ? l->wavelengths : 1;
    w->band = take_room(w, w->bands + 1, sizeof *w->band);
    if (!w->band) return false;
    for (size_t i = 0; i <= w->bands; i++) {
        worst_band *b = &w->band[i];
        sgt_wavelength at = {.number = i == w->bands ? l->primary + 1 : i + 1};
        if (i < w->bands && o->wavelengths) at = o->wavelength[i];
        for (size_t k = 0; l->wavelength && k < l->wavelengths && !at.number; k++)
            if (l->wavelength[k] == at.um) at.number = k + 1;
        if (at.number > l->wavelengths && l->wavelength)
            return fail_worst(w, "wavelengths", "there is none of this number");
        *b = (worst_band){.um = at.number && l->wavelength ? l->wavelength[at.number - 1]
                                : l->wavelength            ? at.um
                                                           : (double)NAN,
                          .weight =
                              at.number && l->wavelength_weight ? l->wavelength_weight[at.number - 1] : 1};
        b->e = take_room(w, 2 * w->count, sizeof *b->e);
        if (!b->e || !sgt_lens_at(l, b->um, b->e + w->count, &b->before, w->error)) return false;
        sgt_launch_ending(w->count, b->e + w->count, b->e);
        for (size_t k = 0; k < w->count && o->open; k++) b->e[k].semi_diameter = 0, b->e[k].aperture = NULL;
        if (b->before == 0) b->before = 1;
    }
    w->primary = w->bands;
    return true;
}

static bool set_worst_fields(worst *w)
{
    const sgt_lens *l = w->t->base;
    const sgt_study_options *o = &w->t->study;
    const bool of_lens = !o->fields || o->field;
    const sgt_lens_aim pupil = SGT_LENS_AIM_PUPIL;
    const sgt_launcher_options opt = {.allocator = &w->memory.allocator, .aim = &pupil};
    w->fields = o->fields ? o->fields : l->fields;
    w->kind = of_lens || !o->field_kind ? l->field_kind : *o->field_kind;
    if ((o->aim ? *o->aim : l->aim) != SGT_LENS_AIM_PUPIL)
        return fail_worst(
            w, "", "rays that are aimed at the stop have no worst case that is known; give --aim paraxial");
    if (w->kind == SGT_FIELD_PARAXIAL_IMAGE_HEIGHT || w->kind == SGT_FIELD_REAL_IMAGE_HEIGHT)
        return fail_worst(
            w, "field_type",
            "fields by image heights have no worst case that is known; give angles or object heights");
    if (l->afocal) return fail_worst(w, "", "an afocal lens has no worst case that is known");
    w->from = sgt_launcher_new(l, &opt, w->error);
    w->beam = take_room(w, w->fields, sizeof *w->beam), w->at = take_room(w, w->fields, sizeof *w->at);
    w->field_weight = take_room(w, w->fields, sizeof *w->field_weight);
    w->object = take_room(w, 2 * w->fields, sizeof *w->object);
    if (!w->from || !w->beam || !w->at || !w->field_weight || !w->object) return false;
    for (size_t i = 0; i < w->fields; i++) {
        const size_t number = o->fields && o->field ? o->field[i] : i + 1;
        if (of_lens && (number < 1 || number > l->fields))
            return fail_worst(w, "fields", "there is none of this number");
        w->at[i] = of_lens ? l->field[number - 1] : o->field_at[i];
        w->field_weight[i] = of_lens ? w->at[i].weight : 1;
        for (size_t k = 0; k < i && o->fields && o->field; k++)
            if (o->field[k] == number) { /* asked for twice: one of the weight of both */
                w->field_weight[k] += w->field_weight[i], w->field_weight[i] = 0;
                break;
            }
        if (!sgt_launch_field(w->from, w->kind, &w->at[i], &w->beam[i], w->error)) return false;
    }
    return true;
}

static bool set_rays(worst *w)
{
    w->chiefs = w->fields;
    w->ray = w->memory.allocator.resize(w->memory.allocator.context, NULL, (w->fields + 64) * sizeof *w->ray);
    if (!w->ray) return fail_worst(w, "", "no memory");
    w->room = w->fields + 64;
    for (size_t i = 0; i < w->fields; i++) w->ray[w->rays++] = (worst_ray){i, w->primary, 0, 0, 0, true};
    if (w->t->opt.figure == SGT_TOLERANCING_BORESIGHT) return true;
    const sgt_analysis *spot = sgt_analysis_named("spot");
    sgt_study_options opt = w->t->study;
    const sgt_pattern pattern = spot->pattern;
    if (!opt.pattern && !opt.points) {
        opt.pattern = &pattern;
        if (!opt.rays && !opt.across) opt.rays = spot->rays;
    }
    opt.run = NULL;
    const sgt_sink sink = {.context = w, .row = take_end};
    sgt_study *study = sgt_study_new(w->t->base, &opt, w->error);
    const bool fine = study && sgt_study_run(study, sgt_analysis_named("ends"), NULL, &sink, NULL, w->error);
    sgt_study_free(study);
    return fine;
}

/* ---------------------------------------------------------------------- the entries */

/* W_yy of a sag at its vertex: its curvature.  NaN: not known. */
static double bend_of(sgt_surface s)
{
    const double zero = 0;
    double second[6], *to[6];
    if (!s.ops->second) return (double)NAN;
    for (int i = 0; i < 6; i++) to[i] = &second[i];
    s.ops->second(s.self, 1, (sgt_points){{&zero, &zero, &zero}}, to);
    return -second[3];
}

static sgt_pose with_axes(sgt_pose p)
{
    if (dot3(p.ex, p.ex) == 0) p.ex.x = p.ey.y = p.ez.z = 1;
    return p;
}

static const off_surface *put_off(const worst *w, size_t element)
{
    for (size_t k = 0; k < w->t->surfaces; k++)
        if (w->t->surface[k].number == element + 1) return &w->t->surface[k];
    return NULL;
}

static bool moves_of(worst *w, size_t i, double point[])
{
    const sgt_tolerance *e = &w->t->entry[i];
    entry_moves *m = &w->moves[i];
    const bool tilts = e->kind >= SGT_TOLERANCE_TILT_X && e->kind <= SGT_TOLERANCE_TILT_Z;
    const double end = fabs(e->upper) > fabs(e->lower) ? e->upper : e->lower;
    m->by = take_room(w, w->count, sizeof *m->by), m->z = take_room(w, w->count, sizeof *m->z);
    m->bend = take_room(w, w->count, sizeof *m->bend);
    sgt_lens *lens = sgt_lens_copy(w->t->base, w->error);
    if (!lens || !m->by || !m->z || !m->bend) return sgt_lens_free(lens), false;
    point[i] = end;
    sgt_first_order data;
    bool fine = sgt_build_at(w->t, lens, point, w->error) &&
                sgt_lens_first_order(lens, (double)NAN, &data, NULL, w->error);
    point[i] = 0;
    for (size_t k = 0; k < w->count && fine; k++) {
        const sgt_lens_surface *s = &lens->surface[k], *was = &w->t->base->surface[k];
        if (s->off_axis != was->off_axis || (tilts && fabs(s->z - was->z) > BUILT * w->extent))
            fine = fail_entry(w, i, "the surface is placed by origin");
        if (e->kind == SGT_TOLERANCE_THICKNESS) { /* the others are made from what they say */
            const sgt_vec3 by = minus3(lens->element[k].pose.origin, w->pose[k].origin);
            m->by[k] = (sgt_vec3){by.x / end, by.y / end, by.z / end};
        }
        if (!tilts) m->z[k] = (s->z - was->z) / end;
        /* (coma tilts the vertex, and no paraxial ray passes) */
        if (e->kind == SGT_TOLERANCE_IRREGULARITY && k + 1 == e->first)
            m->bend[k] =
                data.without_vertex == k + 1
                    ? (double)NAN
                    : (bend_of(lens->element[k].surface) - bend_of(w->t->base->element[k].surface)) / end;
    }
    sgt_lens_free(lens);
    return fine;
}

/* An irregularity of one fringe, by itself. */
static bool set_shape(worst *w, size_t i, wide_shape *out)
{
    enum { TERMS = 49 };
    const sgt_tolerance *e = &w->t->entry[i];
    sgt_zernike *z = take_room(w, 1, sizeof *z);
    double *term = take_room(w, TERMS, sizeof *term);
    if (!z || !term) return false;
    term[e->term - 1] = e->wavelength / w->t->um / 2;
    *z = (sgt_zernike){.norm = e->over, .order = SGT_FRINGE, .a = {term, 1, TERMS}};
    const sgt_element *own = &w->band[w->primary].e[e->first - 1];
    if (own->surface.ops != &sgt_conic_ops || own->phase)
        return fail_entry(w, i, "of no plane, sphere or conic");
    if (!(own->semi_diameter > 0)) return fail_entry(w, i, "the surface has no semi_diameter");
    if (!sgt_wide_shape((sgt_surface){&sgt_zernike_ops, z}, own->semi_diameter, out))
        return fail_entry(w, i, "its slopes are not known all over the surface");
    return true;
}

static bool set_entries(worst *w)
{
    const sgt_tolerancing *t = w->t;
    double *point = take_room(w, w->n + 1, sizeof *point);
    w->moves = take_room(w, w->n, sizeof *w->moves), w->shape = take_room(w, w->n, sizeof *w->shape);
    w->pose = take_room(w, w->count, sizeof *w->pose);
    w->amount = take_room(w, w->n, sizeof *w->amount);
    w->shapes_at = take_room(w, w->count + 1, sizeof *w->shapes_at);
    if (!point || !w->moves || !w->shape || !w->pose || !w->amount || !w->shapes_at) return false;
    w->extent = 1e-30;
    for (size_t k = 0; k < w->count; k++) {
        const sgt_element *e = &t->base->element[k];
        w->pose[k] = with_axes(e->pose);
        w->extent = fmax(w->extent, length3(e->pose.origin) + t->base->surface[k].size +
                                        (e->semi_diameter < 0x1p500 ? e->semi_diameter : 0));
    }
    for (size_t i = 0; i < w->n; i++) {
        const sgt_tolerance *e = &t->entry[i];
        const sgt_element *own = &t->base->element[e->first - 1];
        const bool bends = e->kind == SGT_TOLERANCE_RADIUS || e->kind == SGT_TOLERANCE_FRINGES;
        if (bends && own->surface.ops != &sgt_conic_ops && own->surface.ops != &sgt_even_asphere_ops)
            return fail_entry(w, i, "of no plane, sphere, conic or even asphere");
        if (!moves_of(w, i, point)) return false;
    }
    for (size_t k = 0, n = 0; k < w->count; k++) {
        w->shapes_at[k] = n;
        for (size_t i = 0; i < w->n; i++)
            if (t->entry[i].kind == SGT_TOLERANCE_IRREGULARITY && t->entry[i].first == k + 1 &&
                !set_shape(w, i, &w->shape[n++]))
                return false;
        w->shapes_at[k + 1] = n;
    }
    return true;
}

/* Where compensators that seek are: as designed, and along a line with each entry. */
static bool set_seekers(worst *w, sgt_error *error)
{
    const sgt_tolerancing *t = w->t;
    size_t seekers = 0, others = 0;
    w->settled = take_room(w, w->n + 1, sizeof *w->settled),
    w->follow = take_room(w, w->n + 1, sizeof *w->follow);
    w->seeker = w->n;
    if (!w->settled || !w->follow) return false;
    for (size_t i = w->n; i-- > 0;)
        if (t->entry[i].compensator == SGT_COMPENSATE_FIGURE)
            w->seeker = i, seekers++;
        else
            others += t->entry[i].compensator != SGT_NO_COMPENSATOR;
    if (!seekers) return true;
    double figure;
    if (!sgt_tolerancing_at(t, w->settled, &figure, error)) return false;
    if (others) return true; /* the derivative is of the first one of all */
    slopes s = {.figure = take_room(w, w->n + 1, sizeof(double)), .compensator = w->follow};
    if (!s.figure || !sgt_slopes_at(t, w->settled, &s, error)) return false;
    for (size_t i = 0; i < w->n; i++)
        if (!isfinite(w->follow[i]) || t->entry[i].compensator) w->follow[i] = 0;
    return true;
}

/* --------------------------------------------------------------------- a box of lenses */

static void add_wide(wide *to, double k, const wide *x) { sgt_wide_added(to, k, x, to); }

/* The values of the entries; compensators are still 0. */
static void set_values(worst *w, const worst_box *b)
{
    for (size_t i = 0; i < w->n; i++) {
        const double c = b->lo[i] / 2 + b->hi[i] / 2;
        w->value[i] = (wide){.c = c};
        if (w->t->entry[i].compensator)
            w->value[i].c = 0;
        else
            w->value[i].by[i] = fmax(b->hi[i] - c, c - b->lo[i]) * (1 + 0x1p-50);
    }
}

/* All rays of a lens have the same number x.  So what is not known of it is a parameter of its own, and what
 * it does to a ray and to the chief ray cancels. */
static void share_rest(wide *x, size_t slot) { x->by[slot] += x->rest * (1 + 0x1p-50), x->rest = 0; }

/* x is set within its box. */
static void into_box(const worst *w, size_t i, wide *x)
{
    const sgt_tolerance *e = &w->t->entry[i];
    const sgt_interval range = sgt_wide_range(x);
    if (!(range.lo >= e->lower && range.hi <= e->upper))
        sgt_wide_between((sgt_interval){fmin(fmax(range.lo, e->lower), e->upper),
                                        fmax(fmin(range.hi, e->upper), e->lower)},
                         x);
    share_rest(x, i);
}

/* Those that seek. */
static void set_seeking(worst *w)
{
    for (size_t i = 0; i < w->n; i++) {
        if (w->t->entry[i].compensator != SGT_COMPENSATE_FIGURE) continue;
        sgt_wide_of(w->settled[i], &w->value[i]);
        for (size_t k = 0; k < w->n && i == w->seeker; k++)
            if (w->follow[k] != 0) add_wide(&w->value[i], w->follow[k], &w->value[k]);
        into_box(w, i, &w->value[i]);
    }
}

static void set_lens_numbers(worst *w)
{
    const sgt_tolerancing *t = w->t;
    for (size_t k = 0; k < w->count; k++) {
        const off_surface *o = put_off(w, k);
        wide off = {.c = 0}, power = {.c = 0};
        bool by_radius = false;
        w->z[k] = (wide){.c = t->base->surface[k].z, .rest = BUILT * w->extent};
        w->c[k] = w->index[k] = (wide){.c = 0}, w->bends[k] = false;
        size_t shape = w->shapes_at[k];
        for (size_t i = 0; i < w->n; i++) {
            const sgt_tolerance *e = &t->entry[i];
            const wide *v = &w->value[i];
            if (w->moves[i].z[k] != 0) add_wide(&w->z[k], w->moves[i].z[k], v);
            if (e->first != k + 1) continue;
            if (e->kind == SGT_TOLERANCE_INDEX) add_wide(&w->index[k], 1, v);
            if (e->kind == SGT_TOLERANCE_IRREGULARITY) w->amount[shape++] = *v;
            if (e->kind == SGT_TOLERANCE_RADIUS) add_wide(&off, 1, v), by_radius = true;
            if (e->kind == SGT_TOLERANCE_FRINGES)
                add_wide(&power, e->wavelength / t->um / (e->over * e->over), v);
        }
        if (!o || !o->curved) continue;
        w->bends[k] = true;
        if (by_radius && isfinite(o->radius)) { /* 1 / (R + off) - 1 / R = -off / (R (R + off)) */
            wide below;
            sgt_wide_plus(&off, o->radius, &below), sgt_wide_inverse(&below, &below);
            sgt_wide_product(&off, &below, &off), sgt_wide_scaled(&off, -1 / o->radius, &w->c[k]);
        }
        add_wide(&w->c[k], 1, &power);
        sgt_wide_rest(&w->c[k], BUILT * fabs(o->curvature));
    }
}

/* A turn about axis a of a frame, of the vectors v[count]. */
static void turn_wides(const sgt_pose *frame, int a, const wide *angle, size_t count, wide v[][3])
{
    const sgt_vec3 axis[3] = {frame->ex, frame->ey, frame->ez};
    wide cosine, sine, own[3], turned[3], product;
    sgt_wide_turn(angle, &cosine, &sine);
    for (size_t k = 0; k < count; k++) {
        for (int i = 0; i < 3; i++) {
            sgt_wide_scaled(&v[k][0], axis[i].x, &own[i]);
            add_wide(&own[i], axis[i].y, &v[k][1]), add_wide(&own[i], axis[i].z, &v[k][2]);
        }
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        turned[a] = own[a];
        sgt_wide_product(&cosine, &own[b], &turned[b]), sgt_wide_product(&sine, &own[c], &product);
        add_wide(&turned[b], -1, &product);
        sgt_wide_product(&sine, &own[b], &turned[c]), sgt_wide_product(&cosine, &own[c], &product);
        add_wide(&turned[c], 1, &product);
        const double *const part[3] = {&axis[0].x, &axis[1].x, &axis[2].x};
        for (int i = 0; i < 3; i++) {
            sgt_wide_scaled(&turned[0], part[0][i], &v[k][i]);
            add_wide(&v[k][i], part[1][i], &turned[1]), add_wide(&v[k][i], part[2][i], &turned[2]);
        }
    }
}

typedef struct wide_pose {
    wide axis[3][3], origin[3];
    bool turned;
} wide_pose;

static void vector_wide(sgt_vec3 v, wide out[3])
{
    sgt_wide_of(v.x, &out[0]), sgt_wide_of(v.y, &out[1]), sgt_wide_of(v.z, &out[2]);
}

static void add_vector(wide to[3], sgt_vec3 by, const wide *k)
{
    if (by.x != 0) add_wide(&to[0], by.x, k);
    if (by.y != 0) add_wide(&to[1], by.y, k);
    if (by.z != 0) add_wide(&to[2], by.z, k);
}

/* The place of an element, as build.c's put_place, and the thicknesses in front. */
static void pose_of(const worst *w, size_t k, wide_pose *out)
{
    const sgt_tolerancing *t = w->t;
    const sgt_pose *p = &w->pose[k];
    vector_wide(p->ex, out->axis[0]), vector_wide(p->ey, out->axis[1]), vector_wide(p->ez, out->axis[2]);
    vector_wide(p->origin, out->origin), out->turned = false;
    for (size_t i = 0; i < w->n; i++) {
        const sgt_tolerance *e = &t->entry[i];
        if (e->first > k + 1 || e->last < k + 1 || e->kind < SGT_TOLERANCE_DECENTER_X ||
            e->kind > SGT_TOLERANCE_TILT_Z)
            continue;
        const sgt_pose *frame = &w->pose[e->first - 1];
        const sgt_vec3 axis[3] = {frame->ex, frame->ey, frame->ez};
        if (e->kind <= SGT_TOLERANCE_DECENTER_Z) {
            add_vector(out->origin, axis[e->kind - SGT_TOLERANCE_DECENTER_X], &w->value[i]);
            continue;
        }
        const int a = (int)(e->kind - SGT_TOLERANCE_TILT_X);
        const sgt_vec3 pivot = along3(frame->origin, e->pivot, frame->ez);
        wide angle, from[1][3];
        sgt_wide_scaled(&w->value[i], RADIANS, &angle);
        sgt_wide_plus(&out->origin[0], -pivot.x, &from[0][0]),
            sgt_wide_plus(&out->origin[1], -pivot.y, &from[0][1]);
        sgt_wide_plus(&out->origin[2], -pivot.z, &from[0][2]);
        turn_wides(frame, a, &angle, 1, from);
        sgt_wide_plus(&from[0][0], pivot.x, &out->origin[0]),
            sgt_wide_plus(&from[0][1], pivot.y, &out->origin[1]);
        sgt_wide_plus(&from[0][2], pivot.z, &out->origin[2]);
        turn_wides(frame, a, &angle, 3, out->axis);
        out->turned = true;
    }
    for (size_t i = 0; i < w->n; i++)
        if (t->entry[i].kind == SGT_TOLERANCE_THICKNESS)
            add_vector(out->origin, w->moves[i].by[k], &w->value[i]);
    for (int i = 0; i < 3; i++) sgt_wide_rest(&out->origin[i], BUILT * w->extent);
    for (int i = 0; i < 3 && out->turned; i++)
        for (int j = 0; j < 3; j++) sgt_wide_rest(&out->axis[i][j], BUILT);
}

static void dot_wide(const wide a[3], const wide b[3], wide *out)
{
    wide product;
    sgt_wide_of(0, out);
    for (int i = 0; i < 3; i++) sgt_wide_product(&a[i], &b[i], &product), add_wide(out, 1, &product);
}

/* M = own axes . those in front, o = own axes . (origin in front - own). */
static void motion_between(const wide_pose *from, const wide_pose *to, bool parallel, wide_motion *out)
{
    wide way[3];
    for (int i = 0; i < 3; i++) sgt_wide_added(&from->origin[i], -1, &to->origin[i], &way[i]);
    out->turns = !parallel || from->turned || to->turned;
    for (int i = 0; i < 3; i++) {
        dot_wide(to->axis[i], way, &out->o[i]);
        for (int j = 0; j < 3 && out->turns; j++) dot_wide(to->axis[i], from->axis[j], &out->M[i][j]);
    }
}

static bool same_axes(const sgt_pose *a, const sgt_pose *b)
{
    return memcmp(&a->ex, &b->ex, sizeof a->ex) == 0 && memcmp(&a->ey, &b->ey, sizeof a->ey) == 0 &&
           memcmp(&a->ez, &b->ez, sizeof a->ez) == 0;
}

static bool set_motions(worst *w)
{
    static const sgt_pose global = {.ex = {1, 0, 0}, .ey = {0, 1, 0}, .ez = {0, 0, 1}};
    const sgt_allocator *a = &w->memory.allocator;
    wide_pose *two = a->resize(a->context, NULL, 2 * sizeof *two);
    if (!two) return fail_worst(w, "", "no memory");
    wide_pose *from = &two[0], *to = &two[1];
    vector_wide(global.ex, from->axis[0]), vector_wide(global.ey, from->axis[1]);
    vector_wide(global.ez, from->axis[2]), vector_wide(global.origin, from->origin);
    from->turned = false;
    for (size_t k = 0; k < w->count; k++) {
        pose_of(w, k, to);
        motion_between(from, to, same_axes(k ? &w->pose[k - 1] : &global, &w->pose[k]), &w->motion[k]);
        wide_pose *was = from;
        from = to, to = was;
    }
    a->resize(a->context, two, 0);
    return true;
}

/* ---------------------------------------------------------------------- paraxial rays */

typedef struct wide_ray {
    wide y, w, n, z;
} wide_ray;

static void go_to_wide(wide_ray *r, const wide *z)
{
    wide way, by;
    sgt_wide_added(z, -1, &r->z, &way), sgt_wide_inverse(&r->n, &by);
    sgt_wide_product(&by, &r->w, &by), sgt_wide_product(&by, &way, &by);
    add_wide(&r->y, 1, &by), r->z = *z;
}

/* Of element k: its power, and the index behind it, with sign. */
static bool power_wide(const worst *w, size_t k, const wide *n, wide *power, wide *behind)
{
    const worst_band *b = &w->band[w->primary];
    const sgt_element *e = &b->e[w->count + k];
    const double focal_length = w->t->base->surface[k].focal_length;
    wide c, step;
    if (e->index == SGT_MIRROR)
        sgt_wide_scaled(n, -1, behind);
    else if (e->index == 0)
        *behind = *n;
    else {
        sgt_wide_plus(&w->index[k], e->index, behind), sgt_wide_rest(behind, BUILT);
        if (n->c < 0) sgt_wide_scaled(behind, -1, behind);
    }
    if (focal_length != 0) {
        sgt_wide_of(1 / focal_length, power);
        return true;
    }
    if (e->phase) return false;
    const double bend = bend_of(e->surface);
    sgt_wide_of(bend, &c);
    if (w->bends[k]) add_wide(&c, 1, &w->c[k]);
    for (size_t i = 0; i < w->n; i++)
        if (w->moves[i].bend[k] != 0) add_wide(&c, w->moves[i].bend[k], &w->value[i]);
    sgt_wide_rest(&c, BUILT * fabs(bend));
    sgt_wide_added(behind, -1, n, &step), sgt_wide_product(&c, &step, power);
    return isfinite(bend);
}

/* From the first vertex through the elements in front of `end`, and to its plane.  false: not known. */
static bool paraxial_wide(const worst *w, double y, bool parallel, size_t end, wide_ray *r)
{
    *r = (wide_ray){.y = {.c = y}, .n = {.c = w->band[w->primary].before}, .z = w->z[0]};
    if (!parallel) r->w = r->n;
    for (size_t k = 0; k < end; k++) {
        wide power, behind;
        if (!power_wide(w, k, &r->n, &power, &behind)) return false;
        if (k) go_to_wide(r, &w->z[k]);
        sgt_wide_product(&r->y, &power, &power), add_wide(&r->w, -1, &power), r->n = behind;
    }
    if (end) go_to_wide(r, &w->z[end]);
    return true;
}

static bool quotient_wide(const wide *a, const wide *b, wide *out)
{
    wide by;
    sgt_wide_inverse(b, &by), sgt_wide_product(a, &by, out);
    return out->rest < HUGE_VAL;
}

/* The image from the last element, along the axis: of an object from afar, or its axis point. */
static bool image_wide(const worst *w, wide *out)
{
    const sgt_lens *l = w->t->base;
    const size_t last = w->count - 1;
    wide_ray r, other;
    if (!paraxial_wide(w, 1, true, last, &r)) return false;
    if (isfinite(l->object_distance)) {
        if (!paraxial_wide(w, 0, false, last, &other)) return false;
        sgt_wide_scaled(&r.y, 0, &r.y), sgt_wide_scaled(&r.w, 0, &r.w);
        if (!paraxial_wide(w, l->object_distance, true, last, &r)) return false;
        add_wide(&r.y, 1, &other.y), add_wide(&r.w, 1, &other.w);
    }
    wide yn;
    sgt_wide_product(&r.y, &r.n, &yn), sgt_wide_scaled(&yn, -1, &yn);
    return quotient_wide(&yn, &r.w, out);
}

static bool set_wide_pupil(worst *w)
{
    const sgt_lens *l = w->t->base;
    const size_t stop = l->stop;
    wide_ray axial, high;
    wide efl = {.c = 0}, slope;
    if (l->telecentric) return true;
    sgt_wide_of(0, &w->pupil);
    if (!isnan(l->pupil_distance))
        sgt_wide_of(l->pupil_distance, &w->pupil);
    else if (stop) {
        if (!paraxial_wide(w, 0, false, stop, &axial) || !paraxial_wide(w, 1, true, stop, &high) ||
            !quotient_wide(&axial.y, &high.y, &w->pupil))
            return false;
    }
    const wide from_first = w->pupil;
    sgt_wide_of(l->pupil_size, &w->radius);
    const double d = l->object_distance;
    switch (l->pupil) {
    case SGT_PUPIL_RADIUS:
        break;
    case SGT_PUPIL_WORKING_F_NUMBER:
        if (isfinite(d)) return false; /* fall through */
    case SGT_PUPIL_F_NUMBER:
        if (!paraxial_wide(w, 1, true, w->count - 1, &high)) return false;
        sgt_wide_inverse(&high.w, &efl);
        sgt_wide_scaled(&efl, copysign(1, efl.c) / (2 * l->pupil_size), &w->radius);
        break;
    case SGT_PUPIL_STOP_SIZE:
        if (!paraxial_wide(w, 1, true, stop, &high)) return false;
        sgt_wide_inverse(&high.y, &w->radius);
        sgt_wide_scaled(&w->radius, copysign(1, high.y.c) * l->surface[stop].size, &w->radius);
        break;
    case SGT_PUPIL_OBJECT_NA:
    case SGT_PUPIL_OBJECT_ANGLE:
        sgt_wide_of(l->pupil == SGT_PUPIL_OBJECT_NA ? tan(asin(l->pupil_size / w->band[w->primary].before))
                                                    : tan(l->pupil_size * RADIANS),
                    &slope);
        sgt_wide_plus(&from_first, d, &efl);
        sgt_wide_product(&slope, &efl, &w->radius),
            sgt_wide_scaled(&w->radius, copysign(1, efl.c), &w->radius);
        break;
    case SGT_PUPIL_NONE:
        return false;
    }
    for (size_t f = 0; f < w->fields && isfinite(d); f++) {
        sgt_wide_of(w->at[f].x, &w->object[2 * f]), sgt_wide_of(w->at[f].y, &w->object[2 * f + 1]);
        if (w->kind != SGT_FIELD_ANGLE) continue;
        sgt_wide_plus(&from_first, d, &efl);
        sgt_wide_scaled(&efl, -tan(w->at[f].x * RADIANS), &w->object[2 * f]);
        sgt_wide_scaled(&efl, -tan(w->at[f].y * RADIANS), &w->object[2 * f + 1]);
    }
    add_wide(&w->pupil, 1, &w->z[0]);
    if (!(w->pupil.rest + w->radius.rest < HUGE_VAL)) return false;
    share_rest(&w->pupil, w->n), share_rest(&w->radius, w->n + 1);
    return true;
}

/* All numbers of the lenses of a box.  false: paraxial rays do not tell. */
static bool set_lens(worst *w, const worst_box *b)
{
    const sgt_tolerancing *t = w->t;
    set_values(w, b), set_lens_numbers(w);
    for (size_t i = 0; i < w->n; i++) {
        wide image;
        if (t->entry[i].compensator != SGT_COMPENSATE_PARAXIAL) continue;
        if (!image_wide(w, &image)) return false;
        sgt_wide_plus(&image, -t->image, &w->value[i]);
        into_box(w, i, &w->value[i]);
        set_lens_numbers(w);
    }
    set_seeking(w), set_lens_numbers(w);
    return set_wide_pupil(w);
}

/* ----------------------------------------------------------------------------- rays */

/* The launch ray in the global frame, at z = 0 of that. */
static bool launch_wide(const worst *w, const worst_ray *ray, wide_line *line)
{
    const sgt_field_beam *b = &w->beam[ray->field];
    const sgt_vec2 q = sgt_vignetted(b, ray->px, ray->py);
    wide p[3], d[3], by, product;
    if (b->cone > 0) {
        const sgt_vec3 o = b->object;
        sgt_wide_of(o.x, &p[0]), sgt_wide_of(o.y, &p[1]), sgt_wide_of(o.z, &p[2]);
        add_wide(&p[2], 1, &w->z[0]), sgt_wide_plus(&p[2], -w->z[0].c, &p[2]);
        sgt_wide_of(b->cone * q.x, &line->u), sgt_wide_of(b->cone * q.y, &line->v);
    } else {
        sgt_wide_scaled(&w->radius, q.x, &p[0]), sgt_wide_scaled(&w->radius, q.y, &p[1]), p[2] = w->pupil;
        if (!b->finite) {
            sgt_wide_of(b->direction.x / b->direction.z, &line->u);
            sgt_wide_of(b->direction.y / b->direction.z, &line->v);
            if (!(b->direction.z > 0)) return false;
        } else {
            const wide *o = &w->object[2 * ray->field];
            const sgt_lens *l = w->t->base;
            wide oz = w->z[0];
            sgt_wide_plus(&oz, -l->object_distance, &oz);
            add_wide(&oz, l->object_slope.x, &o[0]), add_wide(&oz, l->object_slope.y, &o[1]);
            sgt_wide_added(&p[0], -1, &o[0], &d[0]), sgt_wide_added(&p[1], -1, &o[1], &d[1]);
            sgt_wide_added(&p[2], -1, &oz, &d[2]), sgt_wide_inverse(&d[2], &by);
            sgt_wide_product(&d[0], &by, &line->u), sgt_wide_product(&d[1], &by, &line->v);
        }
    }
    sgt_wide_rest(&line->u, BUILT), sgt_wide_rest(&line->v, BUILT);
    sgt_wide_product(&p[2], &line->u, &product), sgt_wide_added(&p[0], -1, &product, &line->x);
    sgt_wide_product(&p[2], &line->v, &product), sgt_wide_added(&p[1], -1, &product, &line->y);
    line->ahead = 1;
    return line->x.rest + line->y.rest + line->u.rest + line->v.rest < HUGE_VAL;
}

static void carry_wide(const worst *w, const worst_ray *ray, worst_end *out)
{
    const worst_band *band = &w->band[ray->band];
    wide_line line;
    wide before, behind, point[2];
    *out = (worst_end){.fate = WIDE_UNKNOWN, .why = SGT_BOX_AT_PLANE};
    if (!launch_wide(w, ray, &line)) return;
    wide_fate fate = WIDE_PASSED;
    sgt_wide_of(band->before, &before);
    for (size_t k = 0; k < w->count; k++) {
        const sgt_element *e = &band->e[k];
        const size_t shapes = w->shapes_at[k + 1] - w->shapes_at[k];
        out->element = k;
        if (!sgt_wide_moved(&w->motion[k], &line)) return;
        sgt_wide_rest(&line.x, BUILT * w->extent), sgt_wide_rest(&line.y, BUILT * w->extent);
        sgt_wide_rest(&line.u, BUILT), sgt_wide_rest(&line.v, BUILT);
        behind = before;
        if (e->index != 0 && e->index != SGT_MIRROR) {
            const off_surface *o = put_off(w, k);
            behind = (wide){.c = e->index};
            if (o && o->indexed) add_wide(&behind, 1, &w->index[k]), sgt_wide_rest(&behind, BUILT);
        }
        const wide_element of = {.e = e,
                                 .c = w->bends[k] ? &w->c[k] : NULL,
                                 .before = &before,
                                 .behind = &behind,
                                 .shapes = shapes,
                                 .shape = w->shape + w->shapes_at[k],
                                 .amount = w->amount + w->shapes_at[k]};
        const wide_fate here = sgt_wide_through(&of, &line, point, &out->why);
        if (here == WIDE_ENDED || here == WIDE_UNKNOWN) {
            out->fate = here;
            return;
        }
        if (here == WIDE_MAYBE) fate = WIDE_MAYBE;
        before = behind;
    }
    out->x = point[0], out->y = point[1];
    out->fate = out->x.rest + out->y.rest < HUGE_VAL ? fate : WIDE_UNKNOWN;
}

static void carry_batch(void *data, size_t i)
{
    const worst *w = data;
    for (size_t k = i * BATCH_OF_RAYS; k < w->rays && k < (i + 1) * BATCH_OF_RAYS; k++)
        carry_wide(w, &w->ray[k], &w->end[k]);
}

/* ------------------------------------------------------------------ the quadratic square_form */

typedef struct square_form {
    size_t n;
    double (*G)[Z], (*S)[Z], (*V)[Z], D[Z];
} square_form;

/* Is S less shift on its diagonal positive?  The inverse of S, if V is wanted. */
static bool cholesky(const square_form *f, double shift, double L[][Z])
{
    for (size_t i = 0; i < f->n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = f->S[i][j] - (i == j ? shift : 0);
            for (size_t k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
            if (i != j)
                L[i][j] = sum / L[j][j];
            else if (!(sum > 0))
                return false;
            else
                L[i][i] = sqrt(sum);
        }
    return true;
}

static void set_S(square_form *f)
{
    for (size_t i = 0; i < f->n; i++)
        for (size_t j = 0; j < f->n; j++) f->S[i][j] = (i == j ? f->D[i] : 0) - f->G[i][j];
}

static bool invert(square_form *f, double L[][Z])
{
    set_S(f);
    if (!cholesky(f, 0, L)) return false;
    for (size_t c = 0; c < f->n; c++) {
        double x[Z];
        for (size_t i = 0; i < f->n; i++) {
            x[i] = i == c;
            for (size_t k = 0; k < i; k++) x[i] -= L[i][k] * x[k];
            x[i] /= L[i][i];
        }
        for (size_t i = f->n; i-- > 0;) {
            for (size_t k = i + 1; k < f->n; k++) x[i] -= L[k][i] * x[k];
            x[i] /= L[i][i], f->V[i][c] = x[i];
        }
    }
    return true;
}

/* An upper bound of z' G z, |z[i]| <= 1; D: how it is made up. */
static double largest_form(square_form *f, double L[][Z])
{
    enum { SWEEPS = 60, ANEW = 6 };
    double rows[Z], trivial = 0, trace = 0;
    for (size_t i = 0; i < f->n; i++) {
        rows[i] = 0;
        for (size_t j = 0; j < f->n; j++) rows[i] += fabs(f->G[i][j]);
        trivial += rows[i], trace += f->G[i][i];
        f->D[i] = rows[i] * 1.0001 + 1e-9 * rows[0] + 1e-300;
    }
    double mu = trivial / (double)f->n;
    bool fine = isfinite(trivial) && trivial > 0;
    for (int sweep = 0; sweep < SWEEPS && fine; sweep++, mu *= 0.75) {
        if (sweep % ANEW == 0) fine = invert(f, L);
        for (size_t i = 0; i < f->n && fine; i++) {
            const double s = f->V[i][i], step = mu - 1 / s;
            double column[Z];
            if (!(s > 0)) {
                fine = false;
                break;
            }
            const double by = -step / (1 + step * s);
            f->D[i] += step;
            for (size_t k = 0; k < f->n; k++) column[k] = f->V[k][i];
            for (size_t k = 0; k < f->n; k++)
                for (size_t j = 0; j < f->n; j++) f->V[k][j] += by * column[k] * column[j];
        }
    }
    double sum = 0;
    for (size_t i = 0; i < f->n; i++) sum += f->D[i];
    /* rounding of the decomposition is below n^2 2^-52 of the trace */
    const double slack = 1e-11 * (sum + trace);
    set_S(f);
    fine = fine && sum < trivial;
    for (size_t i = 0; i < f->n && fine; i++) f->S[i][i] += 2 * slack;
    if (fine && cholesky(f, slack, L)) return (sum + 2 * slack * (double)f->n) * (1 + 1e-12);
    for (size_t i = 0; i < f->n; i++) f->D[i] = rows[i];
    return trivial * (1 + 1e-12);
}

/* ---------------------------------------------------------------------------- a bound */

/* Is the weight of the rays of a field that pass in every lens above 0?  Sets it. */
static void weigh_rays(const worst *w, double sure[])
{
    for (size_t f = 0; f < w->fields; f++) sure[f] = 0;
    for (size_t k = w->chiefs; k < w->rays; k++)
        if (w->end[k].fate == WIDE_PASSED)
            sure[w->ray[k].field] += w->ray[k].weight * w->band[w->ray[k].band].weight;
}

static void add_to_form(square_form *f, const wide *x, double weight)
{
    double row[Z];
    row[0] = x->c;
    for (size_t i = 1; i < f->n; i++) row[i] = x->by[i - 1];
    for (size_t i = 0; i < f->n; i++)
        for (size_t j = 0; row[i] != 0 && j <= i; j++) f->G[i][j] += weight * row[i] * row[j];
}

typedef struct judged {
    bool known;
    double bound;
    size_t element;
    const char *why;
} judged;

/* Why a ray has no bound at its element, in words. */
static const char *why_unknown(const worst_ray *r, const worst_end *end)
{
    if (r->chief && end->fate == WIDE_ENDED) return "the chief ray of a field ends there, in every lens";
    return sgt_box_why_text(end->why == SGT_BOX_NOTHING ? SGT_BOX_TOO_LARGE : end->why);
}

/* No lens of the box has a larger figure; f: the form, for what follows. */
static judged judge(worst *w, worst_box *b, square_form *f, double L[][Z], double sure[])
{
    judged out = {.known = false, .bound = HUGE_VAL, .element = SIZE_MAX};
    b->bound = HUGE_VAL;
    for (size_t i = 0; i < w->n; i++) b->part[i] = w->t->entry[i].compensator ? 0 : b->hi[i] - b->lo[i];
    for (size_t i = 0; i < w->n; i++) {
        const sgt_tolerance *e = &w->t->entry[i];
        b->part[i] /= e->upper - e->lower;
    }
    if (!set_lens(w, b) || !set_motions(w)) return out;
    const size_t tasks = (w->rays + BATCH_OF_RAYS - 1) / BATCH_OF_RAYS;
    if (w->t->run)
        w->t->run(w->t->context, tasks, carry_batch, w);
    else
        for (size_t i = 0; i < tasks; i++) carry_batch(w, i);
    double total = 0, rest = 0;
    const bool chief = w->t->opt.figure == SGT_TOLERANCING_BORESIGHT;
    weigh_rays(w, sure);
    f->n = w->n + SHARED + 1;
    for (size_t i = 0; i < f->n; i++) memset(f->G[i], 0, sizeof f->G[i]);
    for (size_t i = 0; i < w->fields; i++) total += w->field_weight[i];
    for (size_t k = 0; k < w->rays; k++) {
        const worst_ray *r = &w->ray[k];
        const worst_end *end = &w->end[k], *from = &w->end[r->field];
        const double of_field = w->field_weight[r->field] / total;
        if (!(of_field > 0)) continue;
        if (end->fate == WIDE_UNKNOWN || (r->chief && end->fate == WIDE_ENDED))
            return out.element = end->element, out.why = why_unknown(r, end), out;
        if (end->fate == WIDE_ENDED || (r->chief && !chief)) continue;
        wide x, y;
        if (chief) {
            sgt_wide_plus(&end->x, -w->t->chief[r->field].x, &x);
            sgt_wide_plus(&end->y, -w->t->chief[r->field].y, &y);
        } else {
            if (!(sure[r->field] > 0))
                return out.element = end->element, out.why = "no ray of a field is sure to pass", out;
            sgt_wide_added(&end->x, -1, &from->x, &x), sgt_wide_added(&end->y, -1, &from->y, &y);
        }
        const double weight =
            chief ? of_field : of_field * r->weight * w->band[r->band].weight / sure[r->field];
        add_to_form(f, &x, weight), add_to_form(f, &y, weight);
        rest += weight * (x.rest * x.rest + y.rest * y.rest);
    }
    double norms = 0;
    for (size_t i = 0; i < f->n; i++) {
        norms += sqrt(f->G[i][i]);
        for (size_t j = 0; j < i; j++) f->G[j][i] = f->G[i][j];
    }
    const double square = largest_form(f, L) + 1e-11 * norms * norms;
    for (size_t i = 0; i < w->n; i++)
        if (!w->t->entry[i].compensator) b->part[i] = f->D[i + 1];
    out.known = true;
    out.bound = b->bound = (sqrt(square) + sqrt(rest)) * (1 + ROUNDED);
    return out;
}

/* -------------------------------------------------------------------------- the search */

static double form_at(const square_form *f, const double z[])
{
    double sum = 0;
    for (size_t i = 0; i < f->n; i++)
        for (size_t j = 0; j < f->n; j++) sum += z[i] * f->G[i][j] * z[j];
    return sum;
}

/* The figure at the corner of the signs z; worst: the greatest as yet. */
static bool try_corner(worst *w, const double z[], double value[], sgt_worst_case *out, double worst_value[])
{
    double figure;
    for (size_t i = 0; i < w->n; i++) {
        const sgt_tolerance *e = &w->t->entry[i];
        value[i] = e->compensator ? 0 : z[i + 1] > 0 ? e->upper : e->lower;
    }
    if (!sgt_tolerancing_at(w->t, value, &figure, w->error)) return false;
    if (out->lenses++ == 0 || (!isnan(out->seen) && !(figure <= out->seen))) {
        out->seen = figure;
        memcpy(worst_value, value, w->n * sizeof *value);
    }
    return true;
}

static bool search_corners(worst *w, const square_form *f, double value[], sgt_worst_case *out,
                           double worst_value[])
{
    enum { STARTS = 16 };
    double best[Z] = {1}, most = -1;
    for (int start = 0; start < STARTS && f; start++) {
        double z[Z] = {1};
        for (size_t i = 1; i <= w->n; i++) {
            uint32_t bits[4], counter[4] = {(uint32_t)i, (uint32_t)start, 0, 0}, key[2] = {43, 0};
            sgt_philox(counter, key, bits);
            z[i] = start == 0 ? (f->G[0][i] < 0 ? -1 : 1) : bits[0] & 1 ? 1 : -1;
        }
        double at = form_at(f, z);
        for (bool better = true; better;) {
            better = false;
            for (size_t i = 1; i <= w->n; i++) {
                z[i] = -z[i];
                const double now = form_at(f, z);
                if (now > at * (1 + 1e-12))
                    at = now, better = true;
                else
                    z[i] = -z[i];
            }
        }
        if (at > most) most = at, memcpy(best, z, sizeof best);
    }
    for (size_t i = 1; i < Z && !f; i++) best[i] = 1;
    if (!try_corner(w, best, value, out, worst_value)) return false;
    enum { PASSES = 3 };
    for (int pass = 0; pass < PASSES; pass++) {
        const double was = out->seen;
        for (size_t i = 0; i < w->n; i++) {
            const double before = out->seen;
            if (w->t->entry[i].compensator) continue;
            best[i + 1] = -best[i + 1];
            if (!try_corner(w, best, value, out, worst_value)) return false;
            if (!(out->seen > before)) best[i + 1] = -best[i + 1];
        }
        if (!(out->seen > was)) break;
    }
    return true;
}

/* --------------------------------------------------------------------------- the whole */

static int verdict_of(const sgt_worst_options *o, const sgt_worst_case *c)
{
    if (!o->limit.count) return SGT_LIMIT_UNDECIDED;
    const double limit = o->limit.at[0];
    if (isnan(c->seen) || c->seen > limit * (1 + 2 * ROUNDED)) return SGT_LIMIT_BROKEN;
    return c->bound <= limit ? SGT_LIMIT_PROVEN : SGT_LIMIT_UNDECIDED;
}

static const double CLOSE_ENOUGH = 1.02;

static bool branch_lenses(worst *w, const sgt_worst_options *o, sgt_worst_case *out, double value[],
                          size_t cuts[])
{
    const size_t most = o->boxes ? o->boxes : WORST_BOXES;
    worst_box *box = take_room(w, most + 1, sizeof *box);
    double(*room)[Z] = take_room(w, (size_t)4 * Z, sizeof *room), *at = take_room(w, w->n + 1, sizeof *at);
    double *sure = take_room(w, w->fields, sizeof *sure);
    if (!box || !room || !at || !sure) return false;
    square_form f = {.G = room, .S = room + Z, .V = room + 2 * Z};
    for (size_t i = 0; i < w->n; i++)
        box[0].lo[i] = w->t->entry[i].lower, box[0].hi[i] = w->t->entry[i].upper;
    judged found = judge(w, &box[0], &f, room + 3 * Z, sure);
    if (!search_corners(w, found.known ? &f : NULL, at, out, value)) return false;
    size_t count = 1, open = 0;
    for (out->boxes = 1;; out->boxes += 2) {
        size_t worst_at = 0, cut = w->n;
        for (size_t i = 1; i < count; i++)
            if (!(box[i].bound <= box[worst_at].bound)) worst_at = i;
        out->bound = box[worst_at].bound, out->verdict = verdict_of(o, out);
        const worst_box from = box[worst_at];
        for (size_t i = 0; i < w->n; i++)
            if (from.part[i] > 0 && (cut == w->n || from.part[i] > from.part[cut])) cut = i;
        if (out->boxes + 2 > most || cut == w->n || out->verdict != SGT_LIMIT_UNDECIDED ||
            (!o->limit.count && out->bound <= CLOSE_ENOUGH * out->seen) || isnan(out->seen))
            break;
        const double middle = from.lo[cut] / 2 + from.hi[cut] / 2;
        if (!(middle > from.lo[cut] && middle < from.hi[cut])) break;
        if (cuts) cuts[cut]++;
        box[worst_at].hi[cut] = middle, box[count] = from, box[count].lo[cut] = middle;
        found = judge(w, &box[worst_at], &f, room + 3 * Z, sure);
        if (!found.known) open++;
        const judged other = judge(w, &box[count++], &f, room + 3 * Z, sure);
        if (!other.known) found = other;
    }
    if (!(out->bound < HUGE_VAL)) {
        out->element = found.element == SIZE_MAX ? 0 : found.element + 1;
        out->why = found.element == SIZE_MAX ? "the pupil or the paraxial image is not known for all lenses"
                                             : found.why;
    }
    return true;
}

bool sgt_tolerancing_worst(const sgt_tolerancing *t, const sgt_worst_options *opt, sgt_worst_case *out,
                           double value[], size_t cuts[], sgt_error *error)
{
    static const sgt_worst_options defaults = {.boxes = 0};
    sgt_error unread;
    if (!opt) opt = &defaults;
    if (!error) error = &unread;
    worst w = {.t = t,
               .memory = {.allocator = t->memory.allocator},
               .error = error,
               .count = t->base->count,
               .n = t->count};
    *out =
        (sgt_worst_case){.bound = HUGE_VAL, .seen = (double)NAN, .verdict = SGT_LIMIT_UNDECIDED, .why = ""};
    for (size_t i = 0; cuts && i < w.n; i++) cuts[i] = 0;
    bool fine = w.n + SHARED <= WIDE ||
                fail_worst(&w, "tolerances", "more than 62 entries have no worst case that is known");
    if (fine && t->opt.figure == SGT_TOLERANCING_OPD)
        fine = fail_worst(&w, "figure", "opd has no worst case that is known: spot and boresight have");
    for (size_t i = 0; i < sizeof opt->reserved_ / sizeof *opt->reserved_ && fine; i++)
        if (opt->reserved_[i])
            fine = fail_worst(&w, "sgt_worst_options",
                              "the program asks for a member that this version of sagitta has not");
    fine = fine && set_worst_bands(&w) && set_worst_fields(&w) && set_rays(&w) && set_entries(&w) &&
           set_seekers(&w, error);
    if (fine) {
        w.value = take_room(&w, w.n, sizeof *w.value), w.end = take_room(&w, w.rays, sizeof *w.end);
        w.c = take_room(&w, w.count, sizeof *w.c), w.z = take_room(&w, w.count, sizeof *w.z);
        w.index = take_room(&w, w.count, sizeof *w.index), w.bends = take_room(&w, w.count, sizeof *w.bends);
        w.motion = take_room(&w, w.count, sizeof *w.motion);
        fine = w.value && w.end && w.c && w.z && w.index && w.bends && w.motion &&
               branch_lenses(&w, opt, out, value, cuts);
    }
    w.memory.allocator.resize(w.memory.allocator.context, w.ray, 0);
    sgt_launcher_free(w.from);
    sgt_arena_free(&w.memory);
    return fine;
}
