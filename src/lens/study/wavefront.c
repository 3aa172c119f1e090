// SPDX-License-Identifier: MIT
/* wavefront.c - optical path differences, and Zernike polynomials fitted to them.
 *
 * THE PATH TO THE SPHERE.  A ray meets the last element at p, with the path L, and goes along d.  With
 * v = p - c, c the centre of the sphere, it is at the distance s of the sphere before p, where
 *
 *     s^2 - 2 s b + v^2 - R^2 = 0,   b = v . d,   s = b + sqrt(R^2 - h^2),   h^2 = v^2 - b^2 :
 *
 * h is the distance of the ray from c.  The chief ray goes through c, and its s is R.  So
 *
 *     OPD = (L - n s) - (L0 - n R) = L - L0 + n (h^2 / (R + sqrt(R^2 - h^2)) - b),
 *
 * in which nothing cancels but L and L0.  Where R is negative (the exit pupil behind the image) the
 * same holds.  With R infinite what is left is L - L0 - n b: the path to the foot of the perpendicular.
 * A plane across the chief ray: s = v . d0 / d . d0, and the chief ray's is 0.
 *
 * THE ERROR.  L and L0 have theirs (sgt_trace_error), and to first order a point of the ray that is off
 * changes L - n b by nothing.  Its direction is off by some u: 8 u |v|.  The point changes h^2 by
 * 2 h p_err, and with b and v . d0 that of the chief ray, c, counts by |d - d0|.
 *
 * SUMS of the differences v, with weights w, and of their squares are exact (exact.h).  The mean square about
 * the mean is small beside them, so each is rounded to 106 bits:
 *
 *     rms^2 = (S2 - S1^2 / S0) / S0,   S0 = sum w, S1 = sum w v, S2 = sum w v^2.
 *
 * Of it less than 2^-99 M^2 is lost, M the largest |v|; so of the rms less than 2^-49 M.
 *
 * THE ERROR OF AN RMS about the mean.  It is a norm of the differences less their mean, which is a
 * projection: so it is off by the rms of their errors at most, and hence by the largest of them.  Peak to
 * valley may be off by twice that, which bounds all numbers of a wavefront. */
#include "run.h"
#include "wavefront.h"
#include "zernike_fit.h"

#include "../base/arena.h"
#include "../optics/launch.h"
#include "../optics/pattern.h"

#include <sagitta/pair.h>

static const double ROUND = 0x1p-52;

double sgt_index_of_image(size_t count, const sgt_element e[], double index_before)
{
    double index = index_before == 0 ? 1 : index_before;
    for (size_t i = 0; i + 1 < count; i++) /* what the last one does to light is not looked at */
        if (e[i].index != SGT_MIRROR && e[i].index != 0) index = e[i].index;
    return index;
}

bool sgt_reference_of(const sgt_lens *lens, const sgt_first_order *data, const sgt_element e[],
                      double index_before, const sgt_ray_end *chief, bool afocal, sgt_reference *out,
                      sgt_error *error)
{
    const sgt_launcher of = {.lens = lens};
    if (chief->fate != SGT_PASSED)
        return sgt_launch_fail(&of, error, "", "the chief ray does not get through surface %zu",
                               chief->element + 1);
    *out = (sgt_reference){.kind = SGT_REFERENCE_SPHERE, .centre = chief->p, .along = chief->d,
                           .index = sgt_index_of_image(lens->count, e, index_before), .opl = chief->opl,
                           .opl_err = chief->opl_err, .p_err = chief->p_err};
    if (afocal) out->kind = SGT_REFERENCE_PLANE;
    else if (!isfinite(data->exit_pupil)) out->kind = SGT_REFERENCE_INFINITE;
    if (out->kind != SGT_REFERENCE_SPHERE) return true;
    const sgt_vec3 pupil = {0, 0, data->exit_pupil}, to = minus3(chief->p, pupil);
    out->radius = copysign(length3(to), dot3(to, chief->d));
    return true;
}

double sgt_opd(const sgt_reference *of, const sgt_ray_end *end, double *error)
{
    const double none = (double)NAN, n = of->index, R = of->radius;
    if (error) *error = none;
    if (end->fate != SGT_PASSED) return none;
    const sgt_vec3 v = minus3(end->p, of->centre), d = end->d, turn = minus3(d, of->along);
    const double b = dot3(v, d), base = end->opl - of->opl;
    double opd, off = end->opl_err + of->opl_err + n * of->p_err * length3(turn);
    if (of->kind == SGT_REFERENCE_PLANE) {
        double s = dot3(v, of->along) / dot3(d, of->along);
        opd = base - n * s;
        off += n * end->p_err * length3(turn);
    } else if (of->kind == SGT_REFERENCE_INFINITE) {
        opd = base - n * b;
    } else {
        const sgt_vec3 across = along3(v, -b, d);
        const double h2 = dot3(across, across), root = sqrt(R * R - h2);
        opd = base + n * (h2 / (R + copysign(root, R)) - b);
        off += n * (end->p_err + of->p_err) * sqrt(h2) / root;
    }
    off += 4 * ROUND * (fabs(base) + n * length3(v));
    if (error) *error = isnan(opd) ? none : isnan(off) ? HUGE_VAL : off;
    return opd;
}

/* Differences of one weight, as they come one after another. */
typedef struct one_weight { double w; size_t rays; exact_run first, square; } one_weight;

static void front_end_of(one_weight *r, sgt_wavefront_sum *s)
{
    sgt_exact_run_end(&r->first, &s->first, r->w), sgt_exact_run_end(&r->square, &s->square, r->w);
    exact_add_product(&s->w, (double)r->rays, r->w);
    r->rays = 0;
}

void sgt_wavefront_add(sgt_wavefront_sum *s, size_t count, const sgt_ray_end end[], const double opd[],
                       const double error[])
{
    one_weight r = {.first = RUN_OF_FIRST, .square = RUN_OF_SQUARE};
    s->rays += count;
    for (size_t i = 0; i < count; i++) {
        const double v = opd[i] + 0; /* one zero: the least of both would depend on their order */
        if (isnan(v)) continue;
        s->least = s->passed ? fmin(s->least, v) : v, s->most = s->passed ? fmax(s->most, v) : v;
        s->passed++, s->off = fmax(s->off, error[i]);
        if (end[i].weight != r.w || r.rays == RUN_MOST) front_end_of(&r, s), r.w = end[i].weight;
        r.rays++;
        exact_run_add(&r.first, &s->first, r.w, v), exact_run_square(&r.square, &s->square, r.w, v);
    }
    front_end_of(&r, s);
}

void sgt_wavefront_merge(sgt_wavefront_sum *s, const sgt_wavefront_sum *more)
{
    if (more->passed) {
        s->least = s->passed ? fmin(s->least, more->least) : more->least;
        s->most = s->passed ? fmax(s->most, more->most) : more->most;
        s->off = fmax(s->off, more->off);
    }
    s->rays += more->rays, s->passed += more->passed;
    sgt_exact_merge(&s->w, &more->w), sgt_exact_merge(&s->first, &more->first);
    sgt_exact_merge(&s->square, &more->square);
}

/* Of what is lost of an rms, and of the rounding of a mean. */
static double rounding_of(const sgt_wavefront_sum *s)
{
    return 8 * ROUND * fmax(fabs(s->least), fabs(s->most));
}

double sgt_wavefront_rms_error(const sgt_wavefront_sum *s) { return s->off + rounding_of(s); }

static sgt_pair rounded_twice(const exact *s)
{
    sgt_pair p;
    p.hi = sgt_exact_value(s, &p.lo);
    return p;
}

sgt_wavefront sgt_wavefront_sum_of(const sgt_wavefront_sum *s)
{
    const double none = (double)NAN;
    sgt_wavefront w = {.rays = s->rays, .passed = s->passed, .mean = none, .rms = none, .least = none,
                       .most = none, .error = none};
    if (s->passed) w.least = s->least, w.most = s->most;
    const sgt_pair weight = rounded_twice(&s->w), first = rounded_twice(&s->first);
    if (!(weight.hi > 0)) return w;
    const sgt_pair mean = sgt_pair_quotient(first, weight);
    const sgt_pair about = sgt_pair_difference(rounded_twice(&s->square), sgt_pair_product(mean, first));
    w.mean = mean.hi, w.rms = sqrt(sgt_not_below_0(sgt_pair_quotient(about, weight).hi));
    w.error = 2 * s->off + rounding_of(s);
    return w;
}

sgt_wavefront sgt_wavefront_of(size_t count, const sgt_ray_end end[], const double opd[],
                               const double error[])
{
    sgt_wavefront_sum all = {.rays = 0};
    sgt_wavefront_add(&all, count, end, opd, error);
    return sgt_wavefront_sum_of(&all);
}

/* ------------------------------------------------------------------------ the fit */

bool sgt_zernike_fit(sgt_zernike_order order, size_t terms, const sgt_pupil_values *at, double coefficient[],
                     double *residual, const sgt_allocator *allocator, sgt_error *error)
{
    sgt_launcher none = {.allocator = sgt_allocator_or(allocator)};
    double *room = NULL;
    const size_t column = sgt_zernike_block_room(terms), triangle = sgt_zernike_triangle_room(terms);
    const bool some = terms > 0 && terms <= ZERNIKE_TERMS_MOST;
    if (some) room = sgt_launch_take(&none, column + triangle, sizeof *room);
    if (!room && some) return sgt_launch_memory(&none, error);
    if (!some)
        return sgt_launch_fail(&none, error, "", "%zu polynomials; 1 to %d", terms, (int)ZERNIKE_TERMS_MOST);
    zernike_block b = {.column = room};
    zernike_triangle t = sgt_zernike_triangle_in(terms, room + column);
    for (size_t first = 0; first < at->count; first += PUPIL_PART) {
        const size_t left = at->count - first;
        sgt_zernike_block_of(order, terms, left < PUPIL_PART ? left : PUPIL_PART, at->x + first,
                             at->y + first, at->value + first, at->weight + first, &b);
        sgt_zernike_absorb(&t, &b);
    }
    const bool fine =
        sgt_zernike_solve(&t, coefficient, residual) ||
        sgt_launch_fail(&none, error, "", "%zu points do not determine %zu coefficients", t.rows, terms);
    sgt_launch_forget(&none, room);
    return fine;
}
