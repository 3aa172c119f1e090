// SPDX-License-Identifier: MIT
/* figure.c - figures of a lens, residuals and derivatives.
 *
 * A NORM.  The residual of a ray is its error times the root of its share: with the weight W of a field among
 * all, and w of a ray among those of its field that pass, r = sqrt(W w) (p - reference).  So the sum of r^2
 * is the weighted mean of the fields' rms^2; and the rms of a field, R, has the derivative (sum of w e de) /
 * R.
 *
 * A PATH DIFFERENCE (../study/wavefront.c) is, with v = p - c, b = v . d and h^2 = v^2 - b^2,
 *
 *     OPD = L - L0 + n (h^2 / G - b),    G = R + root,  root = +-sqrt(R^2 - h^2) with the sign of R,
 *
 * and without h^2 / G where R is infinite.  With K = 1 / G + h^2 / (2 G^2 root) it moves by
 *
 *     dL - dL0 + n (2 K v - (2 K b + 1) d) . (dp - dc) - n (2 K b + 1) v . dd
 *              - n h^2 / G^2 (1 + R / root) dR + dn (h^2 / G - b) :
 *
 * one weighted sum of the end for each ray, and the chief ray's. */
#include "figure.h"

#include <stdio.h>
#include <string.h>

struct sgt_figure {
    sgt_allocator allocator;
    arena memory;
    sgt_lens *lens;
    sgt_study_options study;
    looking how;
    sgt_figure_options opt;
    size_t paths;
    const char **path;
    double *x;
    sgt_edit *edit;
    sgt_figure_count size;
};

static bool fail(sgt_error *error, const char *key, const char *words)
{
    if (!error) return false;
    *error = (sgt_error){.line = 0};
    snprintf(error->key, sizeof error->key, "%s", key);
    snprintf(error->words, sizeof error->words, "%s", words);
    return false;
}

/* ------------------------------------------------------------------------ what is asked */

/* An evaluation. */
typedef struct asked {
    sgt_figure *of;
    sgt_figure_out *out;
    sgt_error *error;
    look_of_lens at;
    layout in;
    flock rays;
    size_t paths;                /* 0: no derivatives are wanted */
    motion *motion;              /* [paths] */
    double *residual, *jacobian; /* of the caller, or room */
    /* of the group that is summed: an rms and its gradient */
    double *sum, *sum_error, *moved;
    bool bounds;   /* errors are wanted */
    double *chief; /* [FLOCK_ROWS * paths]: how a chief ray's end moves */
    double *chief_error;
} asked;

static double *room_of(asked *a, size_t count) { return sgt_ask_room(&a->at.ask, count, sizeof(double)); }

static bool gone(const asked *a) { return a->at.ask.failed; }

/* ---------------------------------------------------------------------- chief rays */

static const sgt_pupil_point centre = {0, 0, 1};

/* Traces one, and takes all of its end back. */
static bool trace_chief_of(asked *a, size_t field, size_t slot, bool unbent, bool vignetted,
                           sgt_ray_change *end)
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

/* -------------------------------------------------------------------------- values */

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

static double error_of_chief(const asked *a)
{
    const flock *f = &a->rays;
    const sgt_rays rays = {.o = {f->o[0], f->o[1], f->o[2]}, .d = {f->d[0], f->d[1], f->d[2]}};
    double point, grain;
    sgt_trace_error_batch(f->elements, f->own, f->before, 1, rays, f->passages,
                          (sgt_end_errors){.point = &point, .grain = &grain});
    return isnan(point + grain) ? HUGE_VAL : point + 4 * grain;
}

static bool ask_chiefs(asked *a)
{
    const size_t fields = a->at.ask.fields, bands = a->at.ask.bands;
    for (size_t i = 0; i < fields * bands; i++) {
        sgt_ray_change end;
        if (!trace_chief_of(a, i / bands, i % bands, false, true, &end)) return false;
        const double error = a->out->value_err ? error_of_chief(a) : 0;
        tell_plain(a, 2 * i, end.p.x, error), tell_plain(a, 2 * i + 1, end.p.y, error);
        for (size_t m = 0; m < a->paths; m++)
            for (size_t r = 0; r < 2; r++)
                tell_slope(a, 2 * i + r, m, a->chief[r * a->paths + m], a->chief_error[r * a->paths + m]);
    }
    return true;
}

/* efl of a slot: the number is told with what differences of it show. */
static bool ask_efl(asked *a)
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

static bool ask_distortion(asked *a)
{
    const sgt_asking *ask = &a->at.ask;
    for (size_t i = 0; i < ask->fields * ask->bands; i++) {
        const size_t field = i / ask->bands, b = i % ask->bands, at = a->in.ideal + field * a->in.slots + b;
        const double ideal = a->at.number[at];
        sgt_field_point curve;
        sgt_ray_change end;
        if (!trace_chief_of(a, field, b, true, false, &end)) return false;
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

/* ---------------------------------------------------------------- sums of squares */

/* Rays of a field and wavelength at their places in residual and jacobian: `each` numbers a ray. */
typedef struct ray_group {
    size_t first, count, each;
} ray_group;

/* Of rays, or of several groups of them: its residuals e with weights w become sqrt(share w / W) e; the rms
 * of those is value[i].  about_mean: less their weighted mean. */
static void sum_up(asked *a, size_t value, ray_group g, const double weight[], double share, bool about_mean,
                   double off, double own_error[])
{
    const size_t paths = a->paths;
    double total = 0, square = 0;
    double mean[2] = {0, 0};
    for (size_t k = 0; k < g.count; k++) total += weight[k];
    for (size_t k = 0; k < g.count && about_mean; k++)
        for (size_t c = 0; c < g.each && weight[k] > 0; c++)
            mean[c] += weight[k] / total * a->residual[g.first + k * g.each + c];
    for (size_t m = 0; m < paths; m++) {
        double slope[2] = {0, 0}, sum = 0, sum_error = 0, moved = 0;
        for (size_t k = 0; k < g.count && about_mean; k++)
            for (size_t c = 0; c < g.each && weight[k] > 0; c++)
                slope[c] += weight[k] / total * a->jacobian[(g.first + k * g.each + c) * paths + m];
        for (size_t k = 0; k < g.count; k++)
            for (size_t c = 0; c < g.each && weight[k] > 0; c++) {
                const size_t row = g.first + k * g.each + c;
                a->jacobian[row * paths + m] -= slope[c];
                sum += weight[k] * (a->residual[row] - mean[c]) * a->jacobian[row * paths + m];
                moved += weight[k] * a->jacobian[row * paths + m] * a->jacobian[row * paths + m];
                if (own_error)
                    sum_error += weight[k] * own_error[row * paths + m] * own_error[row * paths + m];
            }
        a->sum[m] = sum / total, a->sum_error[m] = sqrt(sum_error / total);
        a->moved[m] = off * sqrt(moved / total); /* what is off in the errors of rays counts as well */
    }
    for (size_t k = 0; k < g.count; k++)
        for (size_t c = 0; c < g.each; c++) {
            const size_t row = g.first + k * g.each + c;
            const double scale = weight[k] > 0 ? sqrt(share * weight[k] / total) : 0;
            if (weight[k] > 0)
                square += weight[k] * (a->residual[row] - mean[c]) * (a->residual[row] - mean[c]);
            a->residual[row] = weight[k] > 0 ? scale * (a->residual[row] - mean[c]) : a->residual[row];
            for (size_t m = 0; m < paths; m++) a->jacobian[row * paths + m] *= scale;
        }
    const double rms = sqrt(square / total);
    const sgt_figure_out *out = a->out;
    if (out->value) out->value[value] = rms;
    if (out->value_err) out->value_err[value] = off + (double)g.count * 0x1p-52 * rms;
    for (size_t m = 0; m < paths; m++) {
        if (out->gradient) out->gradient[value * paths + m] = a->sum[m] / rms;
        if (out->gradient_err)
            out->gradient_err[value * paths + m] = (about_mean ? 2 : 1) * a->sum_error[m] + a->moved[m] / rms;
    }
}

/* The root of the weighted mean of the squares of all values before the last. */
static void sum_values(asked *a, const double share[])
{
    const sgt_figure_out *out = a->out;
    const size_t last = a->of->size.values - 1;
    double square = 0, error = 0;
    if (!out->value) return;
    for (size_t i = 0; i < last; i++) {
        square += share[i] > 0 ? share[i] * out->value[i] * out->value[i] : 0;
        if (out->value_err && share[i] > 0) error += share[i] * out->value_err[i] * out->value_err[i];
    }
    out->value[last] = sqrt(square);
    if (out->value_err) out->value_err[last] = sqrt(error);
    for (size_t m = 0; m < a->paths; m++) {
        double slope = 0, off = 0;
        for (size_t i = 0; i < last; i++) {
            if (!(share[i] > 0)) continue;
            const double by = share[i] * out->value[i] / out->value[last];
            if (out->gradient) slope += by * out->gradient[i * a->paths + m];
            if (out->gradient_err) off += by * out->gradient_err[i * a->paths + m];
        }
        if (out->gradient) out->gradient[last * a->paths + m] = slope;
        if (out->gradient_err) out->gradient_err[last * a->paths + m] = off;
    }
}

/* Shares of fields x bands, which add up to 1.  each: of every wavelength; else of fields. */
static double *shares_of(asked *a, bool each)
{
    const sgt_asking *ask = &a->at.ask;
    const size_t bands = each ? ask->bands : 1, count = ask->fields * bands;
    double *share = room_of(a, count + 1), total = 0;
    for (size_t i = 0; share && i < count; i++) {
        const double weight = each && ask->bands > 1 ? ask->band[i % bands].weight : 1;
        share[i] = weight * ask->at[i / bands].weight, total += share[i];
    }
    for (size_t i = 0; share && i < count; i++) share[i] = total > 0 ? share[i] / total : 1 / (double)count;
    return share;
}

/* What became of a ray, as a weight; NaN residuals of what is lost. */
static double weight_of_ray(asked *a, const flock *f, size_t k, double weight, size_t row, size_t each)
{
    const bool there = f->there[k], passed = there && f->fate[k] == SGT_PASSED;
    const bool clipped = there && f->fate[k] == SGT_CLIPPED;
    for (size_t c = 0; c < each && !passed; c++) {
        a->residual[row + c] = clipped ? 0 : (double)NAN;
        for (size_t m = 0; m < a->paths; m++) a->jacobian[(row + c) * a->paths + m] = 0;
    }
    a->out->clipped += clipped, a->out->lost += !passed && !clipped;
    return passed ? weight : 0;
}

/* Bounds on the points of rays that were traced. */
static void point_errors(const flock *f, double point[FLOCK])
{
    const sgt_rays rays = {.o = {f->o[0], f->o[1], f->o[2]}, .d = {f->d[0], f->d[1], f->d[2]}};
    double grain[FLOCK];
    sgt_trace_error_batch(f->elements, f->own, f->before, f->count, rays, f->passages,
                          (sgt_end_errors){.point = point, .grain = grain});
    for (size_t k = 0; k < f->count; k++) point[k] += 4 * grain[k];
}

/* How residual row + k * each + c moves with path m, less what `chief` moves by. */
static void move_rays(asked *a, size_t c, size_t each, size_t row, const double chief[], double error[])
{
    const flock *f = &a->rays;
    double moved[FLOCK], off[FLOCK];
    for (size_t m = 0; m < a->paths; m++) {
        sgt_flock_move(f, &a->motion[m], c, moved, error ? off : NULL);
        for (size_t k = 0; k < f->count; k++) {
            const size_t at = (row + k * each + c) * a->paths + m;
            const bool passed = f->there[k] && f->fate[k] == SGT_PASSED;
            a->jacobian[at] = passed ? moved[k] - (chief ? chief[m] : 0) : 0;
            if (error) error[at] = passed ? off[k] : 0;
        }
    }
}

/* Of a field: all wavelengths are one group. */
static bool spot_of_field(asked *a, size_t field, const double share[], double own_error[], double weight[])
{
    const sgt_asking *ask = &a->at.ask;
    const size_t points = ask->fine.count, each = 2, paths = a->paths;
    const bool centroid = a->of->opt.reference == 1;
    const ray_group g = {field * ask->bands * points * each, ask->bands * points, each};
    double one[FLOCK], zero[FLOCK] = {0}, off = 0, chief_off = 0, total = 0;
    sgt_ray_change end = {{0, 0, 0}, {0, 0, 0}, 0};
    flock *f = &a->rays;
    for (size_t k = 0; k < FLOCK; k++) one[k] = 1;
    const sgt_ray_changes x_and_y[2] = {{.p = {one, zero, zero}}, {.p = {zero, one, zero}}};
    if (!centroid && !trace_chief_of(a, field, ask->bands, false, true, &end)) return false;
    if (!centroid && a->bounds) chief_off = error_of_chief(a);
    for (size_t i = 0; i < ask->bands * points; i += f->count) {
        const size_t b = i / points, first = i % points, row = g.first + i * each;
        const size_t part = first % PUPIL_PART, left = points - first;
        size_t count = left < FLOCK ? left : FLOCK;
        sgt_pupil_point at[PUPIL_PART];
        const size_t whole = first - part, most = points - whole < PUPIL_PART ? points - whole : PUPIL_PART;
        sgt_pupil_part(&ask->fine, whole, most, at);
        if (count > most - part) count = most - part;
        if (!sgt_flock_trace(f, field, b, count, at + part, false, false, true))
            return sgt_ask_fail(&a->at.ask, "", "no memory");
        a->out->rays += count;
        const double band_weight = ask->bands > 1 ? ask->band[b].weight : 1;
        double point[FLOCK];
        if (a->bounds) point_errors(f, point);
        for (size_t k = 0; k < count; k++) {
            const sgt_ray_change ray = sgt_flock_end(f, k);
            a->residual[row + each * k] = ray.p.x - end.p.x,
                                     a->residual[row + each * k + 1] = ray.p.y - end.p.y;
            weight[i + k] = weight_of_ray(a, f, k, band_weight * at[part + k].weight, row + each * k, each);
            total += weight[i + k];
            if (a->bounds && weight[i + k] > 0) off += weight[i + k] * point[k] * point[k];
        }
        if (!paths) continue;
        sgt_flock_back(f, 2, x_and_y);
        a->out->backward += count;
        move_rays(a, 0, each, row, centroid ? NULL : a->chief, own_error);
        move_rays(a, 1, each, row, centroid ? NULL : a->chief + paths, own_error);
    }
    sum_up(a, field, g, weight, share[field], centroid, sqrt(off / total) + chief_off, own_error);
    return true;
}

static double *errors_of(asked *a)
{
    return a->paths && a->out->gradient_err ? room_of(a, a->of->size.residuals * a->paths) : NULL;
}

static bool ask_spots(asked *a)
{
    double *share = shares_of(a, false), *error = errors_of(a);
    double *weight = room_of(a, a->at.ask.bands * a->at.ask.fine.count);
    for (size_t field = 0; field < a->at.ask.fields && !gone(a); field++)
        if (!spot_of_field(a, field, share, error, weight)) return false;
    if (!gone(a)) sum_values(a, share);
    return !gone(a);
}

/* ----------------------------------------------------------------------- wavefronts */

/* The place of the index of the image space among the numbers of a trace. */
static size_t image_index(const flock *f)
{
    size_t at = 6;
    for (size_t i = 0; i + 1 < f->elements; i++)
        if (f->own[i].index != SGT_MIRROR && f->own[i].index != 0)
            at = sgt_trace_parameters(i + 1, f->own) - 1;
    return at;
}

/* A path difference, the weights by which the end of the ray moves it, and its derivatives by R and n. */
typedef struct opd_change {
    double opd, by_radius, by_index;
    sgt_vec3 p, d;
} opd_change;

static opd_change opd_moved(const sgt_reference *of, const sgt_ray_change *end)
{
    const double n = of->index, R = of->radius;
    const sgt_vec3 v = minus3(end->p, of->centre), d = end->d, none = {0, 0, 0};
    const double b = dot3(v, d), base = end->opl - of->opl;
    if (of->kind == SGT_REFERENCE_INFINITE)
        return (opd_change){base - n * b, 0, -b, along3(none, -n, d), along3(none, -n, v)};
    const sgt_vec3 across = along3(v, -b, d);
    const double h2 = dot3(across, across), root = copysign(sqrt(R * R - h2), R), G = R + root;
    const double K = 1 / G + h2 / (2 * G * G * root), back = 2 * K * b + 1;
    return (opd_change){base + n * (h2 / G - b), -n * h2 / (G * G) * (1 + R / root), h2 / G - b,
                        along3(along3(none, 2 * n * K, v), -n * back, d), along3(none, -n * back, v)};
}

static bool front_of_cell(asked *a, size_t panel, const double share[], double own_error[], double weight[])
{
    const sgt_asking *ask = &a->at.ask;
    const size_t field = panel / ask->bands, b = panel % ask->bands, points = ask->fine.count,
                 paths = a->paths;
    const double waves = a->at.study->um / ask->band[b].at.um;
    const ray_group g = {panel * points, points, 1};
    sgt_ray_change end;
    sgt_reference reference;
    flock *f = &a->rays;
    double off = 0;
    if (!trace_chief_of(a, field, b, true, true, &end)) return false;
    const sgt_ray_end chief = {.fate = SGT_PASSED, .p = end.p, .d = end.d, .opl = end.opl};
    if (!sgt_reference_of(ask->lens, &ask->primary.data, f->own, f->before, &chief, false, &reference,
                          a->error))
        return false;
    const sgt_vec3 from_pupil = minus3(end.p, (sgt_vec3){0, 0, ask->primary.data.exit_pupil});
    const size_t exit = a->in.first + ask->bands * FIRST_NUMBERS + 1;
    for (size_t i = 0; i < points; i += f->count) {
        const size_t part = i % PUPIL_PART, whole = i - part;
        const size_t most = points - whole < PUPIL_PART ? points - whole : PUPIL_PART;
        const size_t count = most - part < FLOCK ? most - part : FLOCK;
        sgt_pupil_point at[PUPIL_PART];
        sgt_pupil_part(&ask->fine, whole, most, at);
        if (!sgt_flock_trace(f, field, b, count, at + part, false, true, true))
            return sgt_ask_fail(&a->at.ask, "", "no memory");
        a->out->rays += count;
        opd_change diff[FLOCK];
        double w[FLOCK_ROWS][FLOCK];
        for (size_t k = 0; k < count; k++) {
            const sgt_ray_change ray = sgt_flock_end(f, k);
            diff[k] = opd_moved(&reference, &ray);
            a->residual[g.first + i + k] = waves * diff[k].opd;
            weight[i + k] = weight_of_ray(a, f, k, at[part + k].weight, g.first + i + k, 1);
            w[0][k] = diff[k].p.x, w[1][k] = diff[k].p.y, w[2][k] = diff[k].p.z;
            w[3][k] = diff[k].d.x, w[4][k] = diff[k].d.y, w[5][k] = diff[k].d.z, w[6][k] = 1;
            if (weight[i + k] > 0) off = fmax(off, 0x1p-50 * waves * (fabs(ray.opl) + fabs(reference.opl)));
        }
        if (!paths) continue;
        const sgt_ray_changes all = {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}, w[6], {0}};
        sgt_flock_back(f, 1, &all);
        a->out->backward += count;
        move_rays(a, 0, 1, g.first + i, NULL, own_error);
        for (size_t k = 0; k < count; k++) {
            if (!(f->there[k] && f->fate[k] == SGT_PASSED)) continue;
            for (size_t m = 0; m < paths; m++) {
                const double *c = a->chief + m;
                const sgt_vec3 dc = {c[0], c[paths], c[2 * paths]};
                const motion *by = &a->motion[m];
                double dR = dot3(from_pupil, minus3(dc, (sgt_vec3){0, 0, by->by[exit]})) / reference.radius;
                if (reference.kind == SGT_REFERENCE_INFINITE) dR = 0;
                double *to = &a->jacobian[(g.first + i + k) * paths + m];
                *to += -dot3(diff[k].p, dc) - c[6 * paths] + diff[k].by_radius * dR +
                       diff[k].by_index * by->by[b * a->in.trace + image_index(f)];
                *to *= waves;
                if (own_error) own_error[(g.first + i + k) * paths + m] *= waves;
            }
        }
    }
    sum_up(a, panel, g, weight, share[panel], true, off, own_error);
    return true;
}

static bool ask_fronts(asked *a)
{
    const sgt_asking *ask = &a->at.ask;
    for (size_t i = 0; i + 1 < ask->lens->count; i++)
        if (ask->lens->element[i].phase && a->paths)
            return sgt_ask_fail(&a->at.ask, "", "no derivatives of paths through an ideal lens (element %zu)",
                                i + 1);
    if (isnan(a->at.study->um))
        return sgt_ask_fail(&a->at.ask, "units", "must be mm, cm, m, um or in for differences in waves");
    for (size_t b = 0; b < ask->bands; b++)
        if (isnan(ask->band[b].at.um))
            return sgt_ask_fail(&a->at.ask, "wavelengths", "missing: paths are in waves");
    double *share = shares_of(a, true), *error = errors_of(a), *weight = room_of(a, ask->fine.count);
    for (size_t i = 0; i < ask->fields * ask->bands && !gone(a); i++)
        if (!front_of_cell(a, i, share, error, weight)) return false;
    if (!gone(a)) sum_values(a, share);
    return !gone(a);
}

/* ----------------------------------------------------------------------- the figure */

/* How many there are, of a lens as it is looked at. */
static sgt_figure_count figure_count(const sgt_figure *f, const look_of_lens *l)
{
    const sgt_asking *a = &l->ask;
    const size_t cells = a->fields * a->bands;
    sgt_figure_count c = {.paths = f->paths, .residuals = cells, .values = cells};
    switch (f->opt.kind) {
    case SGT_FIGURE_SPOT:
        c.residuals = 2 * cells * a->fine.count, c.values = a->fields + 1;
        break;
    case SGT_FIGURE_OPD:
        c.residuals = cells * a->fine.count, c.values = cells + 1;
        break;
    case SGT_FIGURE_CHIEF:
        c.residuals = c.values = 2 * cells;
        break;
    case SGT_FIGURE_EFL:
        c.residuals = c.values = a->bands;
        break;
    case SGT_FIGURE_DISTORTION:
        break;
    }
    return c;
}

static bool find_motions(asked *a)
{
    const sgt_figure *f = a->of;
    sgt_lens *copy = a->paths ? sgt_lens_copy(f->lens, a->error) : NULL;
    bool fine = copy || !a->paths;
    for (size_t m = 0; m < a->paths && fine; m++) {
        motion *to = &a->motion[m];
        to->by = room_of(a, a->in.end), to->error = room_of(a, a->in.end);
        f->edit[m].number = f->x[m];
        fine = !gone(a) && sgt_motion_of(copy, f->path[m], f->x[m], m ? &f->edit[m - 1] : NULL, &f->how,
                                         &a->in, &a->at, to, a->error);
    }
    sgt_lens_free(copy);
    return fine;
}

static bool prepare(asked *a)
{
    const sgt_figure_out *out = a->out;
    sgt_figure *f = a->of;
    const bool slopes = out->jacobian || out->gradient || out->gradient_err;
    a->paths = slopes ? f->paths : 0;
    if (!sgt_look_begin(&a->at, f->lens, &f->how, true, a->error)) return false;
    if (memcmp(
            &(sgt_figure_count[]) { figure_count(f, &a->at) } -> residuals, &f->size.residuals,
            sizeof(size_t)) != 0)
        return fail(a->error, "", "the lens has other residuals than at first");
    if (!sgt_look_list(&a->at, &a->in, true)) return sgt_ask_fail(&a->at.ask, "", "no memory");
    const size_t residuals = f->size.residuals;
    a->motion = sgt_ask_room(&a->at.ask, a->paths, sizeof *a->motion);
    a->residual = out->residual ? out->residual : room_of(a, residuals);
    a->jacobian = out->jacobian && a->paths ? out->jacobian : room_of(a, residuals * a->paths);
    a->chief = room_of(a, FLOCK_ROWS * a->paths), a->chief_error = room_of(a, FLOCK_ROWS * a->paths);
    a->sum = room_of(a, a->paths), a->sum_error = room_of(a, a->paths);
    a->moved = room_of(a, a->paths), a->bounds = out->value_err || (out->gradient_err && a->paths);
    if (gone(a)) return false;
    if (!find_motions(a)) return false;
    return sgt_flock_begin(&a->rays, &a->at, &a->in, a->paths, a->motion);
}

static bool ask(asked *a)
{
    switch (a->of->opt.kind) {
    case SGT_FIGURE_SPOT:
        return ask_spots(a);
    case SGT_FIGURE_OPD:
        return ask_fronts(a);
    case SGT_FIGURE_CHIEF:
        return ask_chiefs(a);
    case SGT_FIGURE_EFL:
        return ask_efl(a);
    case SGT_FIGURE_DISTORTION:
        return ask_distortion(a);
    }
    return false;
}

static bool put_numbers(sgt_figure *f, const double x[], sgt_error *error)
{
    for (size_t m = 0; m < f->paths; m++) f->edit[m].number = x[m];
    if (!sgt_lens_edit(f->lens, f->paths, f->edit, error)) return false;
    memcpy(f->x, x, f->paths * sizeof *x);
    return true;
}

bool sgt_figure_eval(sgt_figure *f, const double x[], sgt_figure_out *out, sgt_error *error)
{
    sgt_error unread;
    for (size_t i = 0; i < sizeof out->reserved_ / sizeof *out->reserved_; i++)
        if (out->reserved_[i])
            return fail(error, "sgt_figure_out.reserved_", "a member that this sagitta has not");
    out->rays = out->clipped = out->lost = out->backward = 0;
    asked a = {.of = f, .out = out, .error = error ? error : &unread};
    if (x && !put_numbers(f, x, a.error)) return false;
    const bool fine = prepare(&a) && ask(&a);
    sgt_look_end(&a.at);
    return fine;
}

/* ------------------------------------------------------------------------ begin, end */

static void *room_in(sgt_figure *f, size_t count, size_t size)
{
    void *room = sgt_arena_take(&f->memory, count * size + 1);
    if (room) memset(room, 0, count * size);
    return room;
}

static bool read_paths(sgt_figure *f, const char *const path[], sgt_error *error)
{
    f->path = room_in(f, f->paths, sizeof *f->path);
    f->x = room_in(f, f->paths, sizeof *f->x), f->edit = room_in(f, f->paths, sizeof *f->edit);
    if (!f->path || !f->x || !f->edit) return fail(error, "", "no memory");
    for (size_t m = 0; m < f->paths; m++) {
        if (!sgt_lens_get(f->lens, path[m], &f->x[m], error)) return false;
        if (!(f->path[m] = sgt_arena_text(&f->memory, path[m], strlen(path[m]))))
            return fail(error, "", "no memory");
        for (size_t k = 0; k < m; k++)
            if (strcmp(path[k], path[m]) == 0) return fail(error, path[m], "this path is given twice");
        f->edit[m] = (sgt_edit){.kind = SGT_EDIT_SET, .path = f->path[m]};
    }
    return true;
}

static bool begin_figure(sgt_figure *f, const sgt_lens *lens, const char *const path[], sgt_error *error)
{
    static const sgt_analysis *const of[] = {&sgt_spot_analysis, &sgt_wavefront_analysis, &sgt_field_analysis,
                                             &sgt_field_analysis, &sgt_field_analysis};
    if ((unsigned)f->opt.kind >= sizeof of / sizeof *of)
        return fail(error, "kind", "there is no such figure");
    if (f->opt.reference < 0 || f->opt.reference > 1) return fail(error, "reference", "must be 0 or 1");
    for (size_t i = 0; i < sizeof f->opt.reserved_ / sizeof *f->opt.reserved_; i++)
        if (f->opt.reserved_[i])
            return fail(error, "sgt_figure_options.reserved_", "a member that this sagitta has not");
    if (lens->afocal) return fail(error, "afocal", "no figures of an afocal lens");
    const bool rays = f->opt.kind == SGT_FIGURE_SPOT || f->opt.kind == SGT_FIGURE_CHIEF;
    f->how = (looking){&f->study, of[f->opt.kind], f->opt.kind == SGT_FIGURE_OPD, !rays};
    if (!(f->lens = sgt_lens_copy(lens, error)) || !read_paths(f, path, error)) return false;
    look_of_lens l;
    const bool fine = sgt_look_begin(&l, f->lens, &f->how, true, error);
    if (fine) f->size = figure_count(f, &l);
    sgt_look_end(&l);
    return fine;
}

sgt_figure *sgt_figure_new(const sgt_lens *lens, const sgt_study_options *study,
                           const sgt_figure_options *opt, size_t paths, const char *const path[],
                           sgt_error *error)
{
    const sgt_allocator a = sgt_allocator_or(study ? study->allocator : NULL);
    sgt_error unread;
    sgt_figure *f = a.resize(a.context, NULL, sizeof *f);
    if (!f) {
        fail(error, "", "no memory");
        return NULL;
    }
    *f = (sgt_figure){.allocator = a, .memory = {.allocator = a}, .paths = paths};
    if (study) f->study = *study;
    if (opt) f->opt = *opt;
    f->study.run = NULL;
    if (begin_figure(f, lens, path, error ? error : &unread)) return f;
    sgt_figure_free(f);
    return NULL;
}

void sgt_figure_free(sgt_figure *f)
{
    if (!f) return;
    const sgt_allocator a = f->allocator;
    sgt_lens_free(f->lens);
    sgt_arena_free(&f->memory);
    a.resize(a.context, f, 0);
}

sgt_figure_count sgt_figure_size(const sgt_figure *f) { return f->size; }

void sgt_figure_start(const sgt_figure *f, double x[]) { memcpy(x, f->x, f->paths * sizeof *x); }

sgt_lens *sgt_figure_lens(sgt_figure *f) { return f->lens; }
