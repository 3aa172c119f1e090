// SPDX-License-Identifier: MIT
/* sums.c - sums of squares of residuals.
 *
 * A NORM.  The residual of a ray is its error times the root of its share: with the weight W of a field among
 * all, and w of a ray among those of its field that pass, r = sqrt(W w) (p - reference).  So the sum of r^2
 * is the weighted mean of the fields' rms^2; and the rms of a field, R, has the derivative (sum of w e de) /
 * R. */
#include "asked.h"

/* What is off in the derivatives of rays moves that of their rms by no more than its own rms (Cauchy and
 * Schwarz).  But their errors are estimates, and this has seen four times what they tell: in a lens with
 * pickups, whose derivatives of rays nearly cancel. */
static const double ERRORS_OF_RAYS = 16;

void sgt_sum_up(asked *a, size_t value, ray_group g, const double weight[], double share, bool about_mean,
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
            out->gradient_err[value * paths + m] =
                ERRORS_OF_RAYS * ((about_mean ? 2 : 1) * a->sum_error[m] + a->moved[m] / rms);
    }
}

void sgt_sum_values(asked *a, const double share[])
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

double *sgt_sum_shares(asked *a, bool each)
{
    const sgt_asking *ask = &a->at.ask;
    const size_t bands = each ? ask->bands : 1, count = ask->fields * bands;
    double *share = sgt_asked_room(a, count + 1), total = 0;
    for (size_t i = 0; share && i < count; i++) {
        const double weight = each && ask->bands > 1 ? ask->band[i % bands].weight : 1;
        share[i] = weight * ask->at[i / bands].weight, total += share[i];
    }
    for (size_t i = 0; share && i < count; i++) share[i] = total > 0 ? share[i] / total : 1 / (double)count;
    return share;
}

double sgt_sum_weight(asked *a, const flock *f, size_t k, double weight, size_t row, size_t each)
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

void sgt_sum_moves(asked *a, size_t c, size_t each, size_t row, const double chief[], double error[])
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

double *sgt_sum_errors(asked *a)
{
    return a->paths && a->out->gradient_err ? sgt_asked_room(a, a->of->size.residuals * a->paths) : NULL;
}
