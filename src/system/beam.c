// SPDX-License-Identifier: MIT
/* beam.c - a box of rays: the call, and models for the caller (model.h). */
#include "beam.h"
#include "model.h"

_Static_assert(MODEL_N == (int)SGT_MODEL_PARAMETERS && MODEL_Q == (int)SGT_MODEL_PAIRS, "the public model");
_Static_assert(sizeof(sag_kept[2]) <= sizeof(sgt_box_room), "room for what boxes share");

/* ------------------------------------------------------------------------- models */

sgt_model sgt_model_of(double x) { return (sgt_model){.c = x}; }

sgt_model sgt_model_parameter(int i, sgt_interval range)
{
    sgt_model x = {.c = sgt_interval_middle(range)};
    if (!(i >= 0 && i < MODEL_N) || !isfinite(range.lo) || !isfinite(range.hi))
        return (sgt_model){.rest = HUGE_VAL};
    x.by[i] = larger(range.hi - x.c, x.c - range.lo);
    x.rest = 2 * SGT_U * (fabs(x.c) + x.by[i]) + MODEL_LEAST;
    return x;
}

sgt_model sgt_model_between(sgt_interval range)
{
    sgt_model out;
    model_write(model_between(range), &out);
    return out;
}

void sgt_model_sum(const sgt_model *x, const sgt_model *y, sgt_model *out)
{
    model_write(model_sum(model_read(x), model_read(y)), out);
}

void sgt_model_difference(const sgt_model *x, const sgt_model *y, sgt_model *out)
{
    model_write(model_difference(model_read(x), model_read(y)), out);
}

void sgt_model_product(const sgt_model *x, const sgt_model *y, sgt_model *out)
{
    model_write(model_product(model_read(x), model_read(y)), out);
}

void sgt_model_scaled(const sgt_model *x, double k, sgt_model *out)
{
    model_write(model_scaled(model_read(x), k), out);
}

void sgt_model_plus(const sgt_model *x, double k, sgt_model *out)
{
    model_write(model_plus(model_read(x), k), out);
}

void sgt_model_inverse(const sgt_model *x, sgt_model *out) { model_write(model_inverse(model_read(x)), out); }
void sgt_model_root(const sgt_model *x, sgt_model *out) { model_write(model_root(model_read(x)), out); }

void sgt_model_polar(int i, sgt_interval radius, int j, sgt_interval angle, sgt_model *x, sgt_model *y)
{
    const sgt_model r = sgt_model_parameter(i, radius), a = sgt_model_parameter(j, angle);
    const model of = model_read(&r), by = model_read(&a);
    model_write(model_product(of, model_turned(by, true)), x);
    model_write(model_product(of, model_turned(by, false)), y);
}

/* A rest that is not finite, or anything that is a NaN. */
static bool model_is_known(const sgt_model *x)
{
    double sum = x->c + x->rest;
    for (int i = 0; i < MODEL_N; i++) sum += fabs(x->by[i]);
    for (int i = 0; i < MODEL_Q; i++) sum += fabs(x->pair[i]);
    return sum - sum == 0;
}

sgt_interval sgt_model_range(const sgt_model *x)
{
    return model_is_known(x) ? model_range(model_read(x)) : sgt_interval_all();
}

/* s_i has the mean 0, s_i s_j too, and s_i^2 has a third. */
sgt_interval sgt_model_mean(const sgt_model *x)
{
    double sum = x->c, size = fabs(x->c);
    if (!model_is_known(x)) return sgt_interval_all();
    for (int i = 0; i < MODEL_N; i++) {
        const double third = x->pair[SGT_MODEL_PAIR(i, i)] / 3;
        sum += third, size += fabs(third);
    }
    return sgt_interval_about(sum, (x->rest + MODEL_ROUND * size) * MODEL_MORE);
}

sgt_interval sgt_model_at(const sgt_model *x, const double s[SGT_MODEL_PARAMETERS])
{
    double sum = x->c, size = fabs(x->c);
    if (!model_is_known(x)) return sgt_interval_all();
    for (int j = 0; j < MODEL_N; j++) {
        double row = x->by[j], all = fabs(x->by[j]);
        for (int i = 0; i <= j; i++) {
            const double q = x->pair[SGT_MODEL_PAIR(i, j)];
            if (q != 0) row += q * s[i], all += fabs(q * s[i]);
        }
        if (all > 0) sum += row * s[j], size += all * fabs(s[j]);
    }
    return sgt_interval_about(sum, (x->rest + 4 * MODEL_ROUND * size) * MODEL_MORE);
}

/* ------------------------------------------------------------------------ the call */

static bool is_model(const sgt_model *x)
{
    return x->rest >= 0 && x->reserved_[0] == 0 && x->reserved_[1] == 0;
}

static bool is_number_sound(const sgt_box_lens *lens, const sgt_box_number *a)
{
    if (!a->value || !is_model(a->value) || !ROOM_IS_ZERO(a)) return false;
    if (a->element == SGT_BOX_BEFORE) return a->what == SGT_BOX_INDEX && a->which == 0;
    if (a->element >= lens->elements) return false;
    switch (a->what) {
    case SGT_BOX_INDEX:
        return a->which == 0;
    case SGT_BOX_PER_WAVE:
        return a->which == 0 && lens->e[a->element].phase && is_in_waves(lens->e[a->element].phase);
    case SGT_BOX_ORIGIN:
    case SGT_BOX_TURN:
        return a->which < 3;
    case SGT_BOX_SURFACE: { /* of the others none is known */
        const sgt_surface_ops *ops = in_set(lens->e[a->element].surface).ops;
        return a->which < (ops == &sgt_conic_ops ? 2 : ops == &sgt_even_asphere_ops ? 10 : SGT_BOX_BEFORE);
    }
    }
    return false;
}

/* The first element that sgt_trace would not have; their number: none. */
static size_t first_unsound(const sgt_box_lens *lens)
{
    double index = lens->index_before == 0 ? 1 : lens->index_before;
    for (size_t i = 0; i < lens->elements; i++) {
        const sgt_element *e = &lens->e[i];
        if (!is_plain(e) || !is_aperture_sound(e) || !is_phase_sound(e) || !is_sound(e, index)) return i;
        if (!e->surface.ops || !e->surface.ops->value) return i;
        if (e->surface.ops == &sgt_conic_ops || in_set(e->surface).ops == &sgt_conic_ops) {
            const sgt_conic *q = e->surface.self;
            if (!isfinite(q->c) || !isfinite(q->k) || !(q->semi_diameter >= 0)) return i;
        }
        index = index_behind(e, index);
    }
    return lens->elements;
}

static bool is_launch_sound(const sgt_box_launch *launch)
{
    if (launch->parameters < 1 || launch->parameters > MODEL_N || !ROOM_IS_ZERO(launch)) return false;
    for (int k = 0; k < 3; k++)
        if (!is_model(&launch->o[k]) || !is_model(&launch->d[k])) return false;
    return true;
}

/* Those answers that stay however small the box is. */
static sgt_box_verdict told(sgt_box_verdict verdict, sgt_box_end *out)
{
    const bool stays = out->why == SGT_BOX_NO_BOUNDS || out->why == SGT_BOX_UNSOUND;
    if (verdict != SGT_BOX_CUT || stays) out->divide = -1;
    return verdict;
}

static bool is_call_sound(const sgt_box_lens *lens, bool launch, sgt_box_end *out)
{
    *out = (sgt_box_end){.verdict = SGT_BOX_CUT, .why = SGT_BOX_UNSOUND, .fate = SGT_LOST, .divide = -1};
    bool sound = launch && ROOM_IS_ZERO(lens) && (lens->numbers == 0 || lens->number);
    for (size_t i = 0; sound && i < lens->numbers; i++) sound = is_number_sound(lens, &lens->number[i]);
    if (!sound) return false;
    out->element = first_unsound(lens);
    if (out->element < lens->elements) return false;
    *out = (sgt_box_end){.verdict = SGT_BOX_CUT, .fate = SGT_LOST, .divide = -1};
    return true;
}

sgt_box_verdict sgt_box_trace(const sgt_box_lens *lens, const sgt_box_launch *launch, sgt_box_room room[],
                              sgt_box_at at[], sgt_box_end *out)
{
    const beam_task task = {.lens = lens, .launch = launch, .room = room, .at = at};
    if (!is_call_sound(lens, is_launch_sound(launch), out)) return SGT_BOX_CUT;
    const int n = launch->parameters;
    return told(n <= 2   ? sgt_box_walk_2(&task, out)
                : n <= 4 ? sgt_box_walk_4(&task, out)
                         : sgt_box_walk_8(&task, out),
                out);
}

static bool is_series_ray_sound(const sgt_series_ray *ray)
{
    for (int k = 0; k < 3; k++)
        if (!(ray->p[k].rest >= 0) || !ROOM_IS_ZERO(&ray->p[k]) || !(ray->d[k].rest >= 0) ||
            !ROOM_IS_ZERO(&ray->d[k]))
            return false;
    return true;
}

sgt_box_verdict sgt_series_trace(const sgt_box_lens *lens, const sgt_series_ray *launch, sgt_box_room room[],
                                 sgt_box_at at[], sgt_series_ray *arriving, sgt_series_ray *ends,
                                 sgt_box_end *out)
{
    const beam_task task = {
        .lens = lens, .room = room, .at = at, .from = launch, .arriving = arriving, .ends = ends};
    if (!is_call_sound(lens, is_series_ray_sound(launch), out)) return SGT_BOX_CUT;
    return told(sgt_box_walk_series(&task, out), out);
}

const char *sgt_box_verdict_text(sgt_box_verdict verdict)
{
    switch (verdict) {
    case SGT_BOX_PASSED:
        return "passed";
    case SGT_BOX_STOPPED:
        return "stopped";
    case SGT_BOX_CUT:
        return "cut";
    }
    return "?";
}

const char *sgt_box_why_text(sgt_box_why why)
{
    switch (why) {
    case SGT_BOX_NOTHING:
        return "decided";
    case SGT_BOX_AT_EDGE:
        return "at the edge of an aperture";
    case SGT_BOX_AT_SURFACE:
        return "not certain that each ray meets the surface";
    case SGT_BOX_AT_BENDING:
        return "not certain that each ray is bent";
    case SGT_BOX_AT_PLANE:
        return "rays may run along the vertex plane";
    case SGT_BOX_TOO_LARGE:
        return "the bounds are infinite";
    case SGT_BOX_NO_EDGE:
        return "a sag without a semi_diameter, met far from its vertex plane";
    case SGT_BOX_NO_BOUNDS:
        return "a surface or a phase without bounds over a box";
    case SGT_BOX_UNSOUND:
        return "not a lens or a launch that can be traced";
    }
    return "?";
}
