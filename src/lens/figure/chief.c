// SPDX-License-Identifier: MIT
/* chief.c - figures of chief rays and of first-order data: chief, efl, distortion. */
#include "asked.h"

static const sgt_pupil_point centre = {0, 0, 1};

bool sgt_chief_trace(asked *a, size_t field, size_t slot, bool unbent, bool vignetted, sgt_ray_change *end)
{
    flock *f = &a->rays;
    double one = 1, zero = 0;
    if (!sgt_flock_trace(f, field, slot, 1, &centre, true, unbent, vignetted))
        return sgt_ask_fail(&a->at.ask, "", "no memory");
    a->out->rays++;
    if (!f->there[0] || f->fate[0] != SGT_PASSED)
        return sgt_ask_fail(&a->at.ask, "", "field %zu: the chief ray does not get through",
                            a->at.ask.number[field]);
    *end = sgt_flock_end(f, 0);
    if (!a->paths) return true;
    sgt_ray_changes weight[FLOCK_ROWS] = {{.opl = NULL}};
    for (int r = 0; r < FLOCK_ROWS; r++) {
        for (int k = 0; k < 3; k++)
            weight[r].p[k] = k == r ? &one : &zero, weight[r].d[k] = k + 3 == r ? &one : &zero;
        weight[r].opl = r == 6 ? &one : &zero;
    }
    sgt_flock_back(f, FLOCK_ROWS, weight);
    a->out->backward++;
    for (size_t m = 0; m < a->paths; m++)
        for (size_t r = 0; r < FLOCK_ROWS; r++)
            sgt_flock_move(f, &a->motion[m], r, &a->chief[r * a->paths + m],
                           &a->chief_error[r * a->paths + m]);
    return true;
}

/* A value that is a residual, too. */
static void tell_plain(asked *a, size_t i, double x, double error)
{
    const sgt_figure_out *out = a->out;
    const bool none = isnan(x);
    if (out->residual) out->residual[i] = none ? 0 : x;
    if (out->value) out->value[i] = x;
    if (out->value_err) out->value_err[i] = error;
}

static void tell_slope(asked *a, size_t i, size_t m, double x, double error)
{
    const sgt_figure_out *out = a->out;
    const size_t at = i * a->paths + m;
    if (out->jacobian) out->jacobian[at] = isnan(x) ? 0 : x;
    if (out->gradient) out->gradient[at] = x;
    if (out->gradient_err) out->gradient_err[at] = error;
}

double sgt_chief_error(const asked *a)
{
    double error; /* of one ray */
    sgt_flock_errors(&a->rays, &error);
    return isnan(error) ? HUGE_VAL : error;
}

bool sgt_figure_chiefs(asked *a)
{
    const size_t fields = a->at.ask.fields, bands = a->at.ask.bands;
    for (size_t i = 0; i < fields * bands; i++) {
        sgt_ray_change end;
        if (!sgt_chief_trace(a, i / bands, i % bands, false, true, &end)) return false;
        const double error = a->out->value_err ? sgt_chief_error(a) : 0;
        tell_plain(a, 2 * i, end.p.x, error), tell_plain(a, 2 * i + 1, end.p.y, error);
        for (size_t m = 0; m < a->paths; m++)
            for (size_t r = 0; r < 2; r++)
                tell_slope(a, 2 * i + r, m, a->chief[r * a->paths + m], a->chief_error[r * a->paths + m]);
    }
    return true;
}

/* efl of a slot: the number is told with what differences of it show. */
bool sgt_figure_efl(asked *a)
{
    for (size_t b = 0; b < a->at.ask.bands; b++) {
        const size_t at = a->in.first + b * FIRST_NUMBERS;
        const double efl = a->at.ask.band[b].data.efl;
        if (isnan(efl)) return sgt_ask_fail(&a->at.ask, "", "the lens has no focal length");
        tell_plain(a, b, efl, 0x1p-52 * (double)(4 * a->at.ask.lens->count) * fabs(efl));
        for (size_t m = 0; m < a->paths; m++)
            tell_slope(a, b, m, a->motion[m].by[at], a->motion[m].error[at]);
    }
    return true;
}

bool sgt_figure_distortion(asked *a)
{
    const sgt_asking *ask = &a->at.ask;
    for (size_t i = 0; i < ask->fields * ask->bands; i++) {
        const size_t field = i / ask->bands, b = i % ask->bands, at = a->in.ideal + field * a->in.slots + b;
        const double ideal = a->at.number[at];
        sgt_field_point curve;
        sgt_ray_change end;
        if (!sgt_chief_trace(a, field, b, true, false, &end)) return false;
        if (!sgt_field_curve(ask->from, &ask->beam[field], ask->band[b].element, ask->band[b].before,
                             &ask->band[b].data, SGT_DISTORTION_TAN, &curve, a->error))
            return sgt_ask_fail(&a->at.ask, "", "no memory");
        if (ideal == 0) {
            tell_plain(a, i, (double)NAN, (double)NAN);
            for (size_t m = 0; m < a->paths; m++) tell_slope(a, i, m, (double)NAN, (double)NAN);
            continue;
        }
        /* the height is told along the field's plane, in which the point lies */
        const double length = hypot(end.p.x, end.p.y), height = curve.ideal * (1 + curve.distortion);
        if (!(fabs(fabs(height) - length) <= 1e-9 * length))
            return sgt_ask_fail(&a->at.ask, "",
                                "field %zu: no derivative of distortion: the lens has no plane of "
                                "symmetry through it",
                                ask->number[field]);
        const double side = copysign(1 / length, height), x = end.p.x * side, y = end.p.y * side;
        tell_plain(a, i, curve.distortion, curve.error / fabs(ideal));
        for (size_t m = 0; m < a->paths; m++) {
            const double dx = a->chief[m], dy = a->chief[a->paths + m], d_ideal = a->motion[m].by[at];
            const double error = a->chief_error[m] + a->chief_error[a->paths + m];
            tell_slope(a, i, m, (x * dx + y * dy - height / ideal * d_ideal) / ideal,
                       (error + fabs(height / ideal) * a->motion[m].error[at]) / fabs(ideal));
        }
    }
    return true;
}
