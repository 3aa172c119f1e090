// SPDX-License-Identifier: MIT
/* branch.c - branch and bound over the boxes of a pupil.
 *
 * THE BOXES make up the disc at any time: one that is halved gives its place to its halves.  Each is PASSED
 * (all its rays pass), ended (all end at one element, by one cause) or UNDECIDED.  Its bounds hold for all
 * rays of it that pass.  So the largest bound of boxes that are not ended holds for every ray of the pupil.
 *
 * WHAT IS HALVED, until it is not needed any more:
 *   1. undecided boxes, the largest first, while their share of the area is above the one that may stay;
 *   2. beside them boxes whose bound is above the largest value of a traced ray by more than CLOSE of it;
 *   3. then boxes that pass, by what they leave open of a mean, while an rms is not known to RMS_CLOSE.
 * If limits are asked for, those boxes instead that may break one which is not broken as yet.
 *
 * ROUNDS.  Of the boxes to be halved the foremost ones are halved at once, in any threads: ROUND_LEAST of
 * them,
 * or the ROUND_PART-th part of all boxes.  How many there are depends on nothing else.  So neither does any
 * bit.
 *
 * RAYS are traced beside the boxes, through the middle of each and the corners of those in doubt: the largest
 * values among them say how close a bound is, and they break limits.
 *
 * A MEAN over the area that passes, of f >= 0 or of any sign.  Let P be the area that certainly passes, I the
 * integral of f over it, and u_i undecided boxes, in which f is at most h_i.  For each number M and whatever
 * part S of the undecided boxes passes,
 *
 *     integral over P and S of (f - M)  <=  I - M P + sum u_i max(0, h_i - M).
 *
 * (Of a box at an edge a part is in P, with f at most h_i, and a part is neither.)
 * If the right side is not above 0, the mean is at most M.  The least such M is found by steps of Dinkelbach
 * (1967, Management Science 13, 492), and then raised until the inequality holds with all roundings.  A lower
 * bound is that of -f. */
#include "branch.h"

#include <stdlib.h>
#include <string.h>

enum { ROUND_LEAST = 64, ROUND_MOST = 512, ROUND_PART = 32, AREA_PARTS = 8, RINGS = 10 };
enum { LEAST_BOXES = 4 }; /* the quarters of the disc */
static const double CLOSE = 0.01, RMS_CLOSE = 1e-4, UNBOUNDED = 1e-3;

/* ----------------------------------------------------------------------- memory */

static void *grown(const prove_asked *a, void *room, size_t count, size_t size)
{
    const sgt_allocator *by = &a->cell->from->allocator;
    if (count > SIZE_MAX / 4 / size) return NULL;
    return by->resize(by->context, room, count * size);
}

static bool make_room(proof *p, size_t count)
{
    if (count <= p->room) return true;
    const size_t room = 2 * count + 64;
    prove_box *box = grown(p->asked, p->box, room, sizeof *box);
    if (box) p->box = box;
    double *bound = box ? grown(p->asked, p->bound, room, p->quantities * sizeof *bound) : NULL;
    if (bound) p->bound = bound, p->room = room;
    return bound;
}

void sgt_proof_free(proof *p)
{
    const sgt_launcher *from = p->asked->cell->from;
    sgt_launch_forget(from, p->box), sgt_launch_forget(from, p->bound);
    sgt_launch_forget(from, p->most), sgt_launch_forget(from, p->seen);
    *p = (proof){.asked = p->asked};
}

/* ------------------------------------------------------------------------- rays */

static void note_seen(prove_seen seen[], size_t count, const double value[], double x, double y)
{
    for (size_t q = 0; q < count; q++)
        if (value[q] > seen[q].value || (isnan(seen[q].value) && !isnan(value[q])))
            seen[q] = (prove_seen){value[q], x, y};
}

static void see(const proof *p, carry_room *room, double x, double y, double value[], prove_seen seen[])
{
    if (sgt_carry_ray(p->asked->cell, room, x, y, value) == SGT_PASSED)
        note_seen(seen, p->quantities, value, x, y);
}

static void forget_seen(prove_seen seen[], size_t count)
{
    const double none = (double)NAN;
    for (size_t q = 0; q < count; q++) seen[q] = (prove_seen){none, none, none};
}

/* The centre and rings of the pupil, the last of them its edge. */
static void see_rings(const proof *p, carry_room *room, double value[])
{
    see(p, room, 0, 0, value, p->seen);
    for (size_t j = 1; j <= RINGS; j++)
        for (size_t i = 0; i < 8 * j; i++) {
            double x, y;
            const double r = (double)j / RINGS;
            sgt_sector_point(&(sector){0, r, 0, 0.5}, 1, (double)i / (4 * (double)j), &x, &y);
            see(p, room, x, y, value, p->seen);
        }
}

/* ------------------------------------------------------------------------ a round */

typedef struct half { prove_box box; double *bound, *value; prove_seen *seen; carry_room *room; } half;
typedef struct one_round { const proof *p; half *half; } one_round;

static void carry_half(void *data, size_t i)
{
    const one_round *r = data;
    const proof *p = r->p;
    half *h = &r->half[i];
    const sector *of = &h->box.of;
    double x, y;
    forget_seen(h->seen, p->quantities);
    for (size_t q = 0; q < p->quantities; q++) h->bound[q] = HUGE_VAL;
    h->box.fate = SGT_LOST;
    h->box.f = h->box.ww = (sgt_interval){0, HUGE_VAL}, h->box.w = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    if (!sgt_sector_is_fit(of)) return; /* too wide in angle: it is halved again */
    sgt_carry(p->asked->cell, h->room, &h->box, h->bound);
    if (h->box.fate != SGT_PASSED && h->box.fate != SGT_LOST) return;
    sgt_sector_point(of, 0.5, 0.5, &x, &y);
    see(p, h->room, x, y, h->value, h->seen);
    for (int corner = 0; corner < 4; corner++) {
        bool above = false;
        for (size_t q = 0; q < p->quantities; q++) above = above || !(h->bound[q] <= p->seen[q].value);
        if (!above) return;
        sgt_sector_point(of, corner & 1, corner >> 1, &x, &y);
        see(p, h->room, x, y, h->value, h->seen);
    }
}

/* ------------------------------------------------------------------------- a mean */

typedef enum mean_of { MEAN_F, MEAN_W, MEAN_WW } mean_of;

static sgt_interval sum_in(const prove_box *b, mean_of of)
{
    return of == MEAN_F ? b->f_sum : of == MEAN_W ? b->w_sum : b->ww_sum;
}

static sgt_interval range_in(const prove_box *b, mean_of of)
{
    return of == MEAN_F ? b->f : of == MEAN_W ? b->w : b->ww;
}

/* The integral of f over what passes less M times its area, rounded up, at most; sign -1: of -f. */
static double beyond(const proof *p, mean_of of, double sign, double M, double *area)
{
    double sum = 0, size = 0;
    *area = 0;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        const double share = sgt_sector_area(&b->of);
        double add = 0;
        if (b->fate == SGT_PASSED) {
            const sgt_interval s = sum_in(b, of);
            add = (sign > 0 ? s.hi : -s.lo) - M * share, *area += share;
            size += fabs(M) * share;
        } else if (b->fate == SGT_LOST) {
            const sgt_interval r = range_in(b, of);
            const double over = (sign > 0 ? r.hi : -r.lo) - M, part = over > 0 ? share - b->out : b->in;
            if (isnan(over)) return HUGE_VAL;
            if (part > 0) add = over * part, *area += part, size += fabs(M) * part;
        }
        sum += add, size += fabs(add);
    }
    /* each sum of n numbers rounds by n 2^-53 of the sum of their magnitudes, with what went into each */
    return sum + (double)(p->count + 8) * 0x1p-51 * size;
}

static double mean_at_most(const proof *p, mean_of of, double sign)
{
    enum { STEPS = 60, RAISES = 50 };
    double M = -HUGE_VAL, area;
    if (!(p->passes > 0) && !(p->undecided > 0)) return (double)NAN;
    /* begin at a mean of what passes, or of the least that the undecided boxes may have */
    M = 0;
    for (int k = 0; k < STEPS; k++) {
        const double left = beyond(p, of, sign, M, &area), step = left / area;
        if (!isfinite(left)) return HUGE_VAL;
        if (!(area > 0) || !(fabs(step) > 0x1p-45 * fabs(M))) break;
        M += step;
    }
    for (int k = 0; k < RAISES; k++) {
        if (beyond(p, of, sign, M, &area) <= 0) return M;
        M += ldexp(fabs(M), k - 48) + 0x1p-1000;
    }
    return HUGE_VAL;
}

static sgt_interval mean_over(const proof *p, mean_of of)
{
    const double hi = mean_at_most(p, of, 1), lo = -mean_at_most(p, of, -1);
    return (sgt_interval){lo, hi};
}

sgt_interval sgt_proof_rms(sgt_interval m)
{
    if (isnan(m.lo) || isnan(m.hi)) return m;
    if (!(m.lo > 0)) m.lo = 0;
    return sgt_interval_square_root(m);
}

/* The mean square about the mean is that about any number, less the square of the mean from there. */
sgt_interval sgt_proof_rms_about_mean(const proof *p)
{
    const sgt_interval mean2 = sgt_interval_square(p->w_mean);
    sgt_interval m = p->ww_mean;
    if (isnan(m.lo) || isnan(m.hi)) return m;
    m.lo = sgt_interval_difference(sgt_interval_of(m.lo), sgt_interval_of(mean2.hi)).lo;
    m.hi = sgt_interval_difference(sgt_interval_of(m.hi), sgt_interval_of(mean2.lo)).hi;
    return sgt_proof_rms(m);
}

/* --------------------------------------------------------------------- all of it */

static bool may_pass(const prove_box *b) { return b->fate == SGT_PASSED || b->fate == SGT_LOST; }

static void sum_up(proof *p)
{
    double in = 0, out = 0; /* (sums of whole boxes are exact) */
    p->passes = p->stops = p->undecided = 0;
    for (size_t q = 0; q < p->quantities; q++) p->most[q] = -HUGE_VAL;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        const double share = sgt_sector_area(&b->of);
        *(b->fate == SGT_PASSED ? &p->passes : b->fate == SGT_LOST ? &p->undecided : &p->stops) += share;
        if (b->fate == SGT_LOST) in += b->in, out += b->out;
        for (size_t q = 0; q < p->quantities && may_pass(b); q++)
            if (!(p->bound[i * p->quantities + q] <= p->most[q]))
                p->most[q] = p->bound[i * p->quantities + q];
    }
    p->passes += in, p->stops += out, p->undecided = fmax(p->undecided - in - out, 0);
}

static void take_means(proof *p)
{
    p->f_mean = mean_over(p, MEAN_F), p->w_mean = mean_over(p, MEAN_W), p->ww_mean = mean_over(p, MEAN_WW);
}

/* The quantities that a limit is about: [first, ...) in steps. */
typedef struct span { size_t first, count, step; } span;
static span span_of(const proof *p, const sgt_prove_limit *l)
{
    const size_t elements = p->asked->cell->count;
    switch (l->quantity) {
    case SGT_PROVE_EX: return (span){Q_EX, 1, 1};
    case SGT_PROVE_EY: return (span){Q_EY, 1, 1};
    case SGT_PROVE_SPOT: return (span){Q_SPOT, 1, 1};
    case SGT_PROVE_OPD: return (span){Q_HIGH, 2, 1};
    case SGT_PROVE_INCIDENCE:
    case SGT_PROVE_CLEARANCE: {
        const int of = l->quantity == SGT_PROVE_INCIDENCE ? Q_INCIDENCE : Q_INSIDE;
        if (l->element > elements) return (span){0, 0, 1};
        return l->element ? (span){prove_at_element(l->element - 1, of), 1, 1}
                          : (span){prove_at_element(0, of), elements, Q_EACH};
    }
    case SGT_PROVE_PASSES:
    case SGT_PROVE_RMS:
    case SGT_PROVE_OPD_RMS: break;
    }
    return (span){0, 0, 1};
}

/* Of a quantity of rays: is it -inf everywhere, as no element has it, or no ray passes? */
static double largest(const proof *p, span s, const prove_seen **seen)
{
    double most = -HUGE_VAL;
    *seen = NULL;
    for (size_t k = 0; k < s.count; k++) {
        const size_t q = s.first + k * s.step;
        most = p->most[q] > most ? p->most[q] : most;
        if (!isnan(p->seen[q].value) && (!*seen || p->seen[q].value > (*seen)->value)) *seen = &p->seen[q];
    }
    return most;
}

/* The share of undecided and passing boxes that may break it. */
static double in_doubt(const proof *p, span s, double value)
{
    double sum = 0;
    for (size_t i = 0; i < p->count; i++) {
        bool may = false;
        for (size_t k = 0; k < s.count; k++)
            may = may || !(p->bound[i * p->quantities + s.first + k * s.step] <= value);
        if (may && may_pass(&p->box[i])) sum += sgt_sector_area(&p->box[i].of);
    }
    return sum;
}

static bool is_met(const sgt_prove_limit *l, double bound, double value)
{
    return l->or_equal ? bound <= value : bound < value;
}

/* The largest bound that meets it. */
static double largest_within(const sgt_prove_limit *l, double value)
{
    return l->or_equal ? value : nextafter(value, -HUGE_VAL);
}

static proof_limit limit_of_mean(const proof *p, sgt_interval rms, const sgt_prove_limit *l)
{
    const double none = (double)NAN, value = l->value;
    proof_limit out = {SGT_LIMIT_UNDECIDED, rms.hi, rms.lo, none, none, 0};
    if (is_met(l, rms.hi, value)) out.verdict = SGT_LIMIT_PROVEN;
    else if (rms.lo > value) out.verdict = SGT_LIMIT_BROKEN;
    else out.undecided = p->undecided;
    return out;
}

/* As if some ray passed. */
static proof_limit limit_of_rays(const proof *p, const sgt_prove_limit *l)
{
    const double none = (double)NAN;
    const span s = span_of(p, l);
    const prove_seen *seen;
    proof_limit out = {.x = none, .y = none, .seen = none};
    if (l->quantity == SGT_PROVE_RMS) return limit_of_mean(p, sgt_proof_rms(p->f_mean), l);
    if (l->quantity == SGT_PROVE_OPD_RMS) return limit_of_mean(p, sgt_proof_rms_about_mean(p), l);
    if (l->quantity == SGT_PROVE_PASSES) {
        out.bound = 100 * p->passes, out.seen = 100 * (p->passes + p->undecided);
        out.verdict = is_met(l, -out.bound, -l->value)   ? SGT_LIMIT_PROVEN
                      : !is_met(l, -out.seen, -l->value) ? SGT_LIMIT_BROKEN
                                                         : SGT_LIMIT_UNDECIDED;
        if (out.verdict == SGT_LIMIT_UNDECIDED) out.undecided = p->undecided;
        return out;
    }
    if (l->quantity == SGT_PROVE_OPD) { /* high + (-low) */
        const prove_seen *high = &p->seen[Q_HIGH], *low = &p->seen[Q_LOW];
        out.bound = sgt_sum_above(p->most[Q_HIGH], p->most[Q_LOW]), out.seen = high->value + low->value;
        out.x = high->x, out.y = high->y;
        if (is_met(l, out.bound, l->value)) out.verdict = SGT_LIMIT_PROVEN;
        else if (out.seen > l->value) out.verdict = SGT_LIMIT_BROKEN;
        else out.verdict = SGT_LIMIT_UNDECIDED, out.undecided = in_doubt(p, s, l->value / 2);
        return out;
    }
    const bool least = l->quantity == SGT_PROVE_CLEARANCE;
    const double value = least ? -l->value : l->value, most = largest(p, s, &seen);
    out.bound = least ? -most : most;
    if (seen) out.seen = least ? -seen->value : seen->value, out.x = seen->x, out.y = seen->y;
    out.verdict = is_met(l, most, value)         ? SGT_LIMIT_PROVEN
                  : seen && seen->value > value ? SGT_LIMIT_BROKEN
                                                : SGT_LIMIT_UNDECIDED;
    if (out.verdict == SGT_LIMIT_UNDECIDED) out.undecided = in_doubt(p, s, largest_within(l, value));
    return out;
}

/* No ray is known to pass. */
static bool none_passes(const proof *p)
{
    return !(p->passes > 0) && isnan(p->seen[prove_at_element(0, Q_HEIGHT)].value);
}

/* What is true of no rays is not called proven. */
proof_limit sgt_proof_limit(const proof *p, const sgt_prove_limit *l)
{
    const double none = (double)NAN;
    proof_limit out = limit_of_rays(p, l);
    if (l->quantity == SGT_PROVE_PASSES || !none_passes(p)) return out;
    if (!(p->undecided > 0)) return (proof_limit){SGT_LIMIT_EMPTY, none, none, none, none, 0};
    if (out.verdict == SGT_LIMIT_PROVEN) out.verdict = SGT_LIMIT_UNDECIDED, out.undecided = p->undecided;
    return out;
}

/* ------------------------------------------------------------ what is to be halved */

typedef struct candidate { double score; size_t box; } candidate;

static int by_score(const void *a, const void *b)
{
    const candidate *x = a, *y = b;
    if (x->score != y->score) return x->score < y->score ? 1 : -1;
    return x->box < y->box ? -1 : x->box > y->box;
}

/* Which way, of a box that can be halved; false: it cannot. */
static bool halving_of(const prove_box *b, bool *in_angle)
{
    const bool radius = sgt_sector_can_halve(&b->of, false), angle = sgt_sector_can_halve(&b->of, true);
    if (b->hopeless || (!radius && !angle)) return false;
    if (!radius || !angle) return *in_angle = angle, true;
    if (!sgt_sector_is_fit(&b->of)) return *in_angle = true, true;
    if (b->fate == SGT_LOST && b->divide >= 0) *in_angle = b->divide == 1;
    else *in_angle = 3.141592653589793 * (b->of.turn1 - b->of.turn0) * b->of.r1 > (b->of.r1 - b->of.r0) / 2;
    return true;
}

/* What is wanted of each quantity: a bound at most that. */
static void bounds_wanted(const proof *p, double wanted[])
{
    const prove_asked *a = p->asked;
    const prove_cell *c = a->cell;
    const double floor = 1e-9 * (fabs(c->reference.x) + fabs(c->reference.y) + c->beam->radius);
    const double pv = p->seen[Q_HIGH].value + p->seen[Q_LOW].value;
    for (size_t q = 0; q < p->quantities; q++) wanted[q] = HUGE_VAL;
    if (a->limits) {
        for (size_t k = 0; k < a->limits; k++) {
            const sgt_prove_limit *l = &a->limit[k];
            const proof_limit now = sgt_proof_limit(p, l);
            const span s = span_of(p, l);
            double value = largest_within(l, l->quantity == SGT_PROVE_CLEARANCE ? -l->value : l->value);
            if (now.verdict != SGT_LIMIT_UNDECIDED) continue;
            for (size_t i = 0; i < s.count; i++) {
                const size_t q = s.first + i * s.step;
                /* of two that add up, each by the other's bound of a ray */
                const double own = l->quantity == SGT_PROVE_OPD
                                       ? fmax(value - p->most[Q_HIGH + Q_LOW - q],
                                              p->seen[q].value + CLOSE * 0.1 * pv)
                                       : value;
                wanted[q] = fmin(wanted[q], own);
            }
        }
        return;
    }
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) {
        const double of = q == Q_HIGH || q == Q_LOW ? 0.5 * pv : p->seen[q].value;
        wanted[q] = p->seen[q].value + fmax(CLOSE * fabs(of), q >= Q_HIGH ? 1e-6 : floor);
        if (isnan(wanted[q])) wanted[q] = HUGE_VAL;
    }
    if (!c->has_reference) wanted[Q_EX] = wanted[Q_EY] = wanted[Q_SPOT] = HUGE_VAL;
    if (!c->has_opd) wanted[Q_HIGH] = wanted[Q_LOW] = HUGE_VAL;
    for (size_t i = 0; i < c->count; i++) {
        const size_t angle = prove_at_element(i, Q_INCIDENCE), in = prove_at_element(i, Q_INSIDE);
        const size_t high = prove_at_element(i, Q_HEIGHT);
        const double size = fabs(p->seen[high].value);
        wanted[angle] = p->seen[angle].value + fmax(CLOSE * p->seen[angle].value, 0.1);
        wanted[in] = p->seen[in].value + CLOSE * size + floor;
        wanted[high] = p->seen[high].value + CLOSE * size + floor;
        if (isnan(wanted[angle])) wanted[angle] = HUGE_VAL;
        if (isnan(wanted[in])) wanted[in] = HUGE_VAL;
        if (isnan(wanted[high])) wanted[high] = HUGE_VAL;
    }
}

/* Boxes too wide in angle to be carried through at all. */
static size_t unfit_boxes(const proof *p, candidate out[])
{
    size_t n = 0;
    for (size_t i = 0; i < p->count; i++)
        if (!sgt_sector_is_fit(&p->box[i].of)) out[n++] = (candidate){1, i};
    return n;
}

static double undecided_of(const prove_box *b) { return sgt_sector_area(&b->of) - b->in - b->out; }

static size_t undecided_boxes(const proof *p, candidate out[])
{
    size_t n = 0;
    bool in_angle;
    for (size_t i = 0; i < p->count; i++)
        if (p->box[i].fate == SGT_LOST && undecided_of(&p->box[i]) > 0 && halving_of(&p->box[i], &in_angle))
            out[n++] = (candidate){undecided_of(&p->box[i]), i};
    return n;
}

static size_t wide_boxes(const proof *p, const double wanted[], candidate out[])
{
    size_t n = 0;
    bool in_angle;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        const double share = sgt_sector_area(&b->of);
        double score = 0;
        if (!may_pass(b) || !halving_of(b, &in_angle)) continue;
        for (size_t q = 0; q < p->quantities; q++) {
            const double bound = p->bound[i * p->quantities + q], over = bound - wanted[q];
            if (!(bound > wanted[q])) continue;
            const double unit = fabs(p->seen[q].value) + 0x1p-100;
            score = fmax(score, isfinite(over) && (b->fate == SGT_PASSED || b->bounded) ? over / unit
                    : share);
        }
        /* of some nothing may ever be known, as at the edge of total reflection */
        if (b->fate == SGT_LOST && !b->bounded && !p->asked->limits
                && share < UNBOUNDED * p->asked->undecided)
            continue;
        if (score > 0) out[n++] = (candidate){score, i};
    }
    return n;
}

static double width_of(sgt_interval x) { return isfinite(x.hi - x.lo) ? x.hi - x.lo : 0; }

/* By what boxes leave open of the mean squares, in parts of what is known of them. */
static size_t open_boxes(const proof *p, bool f_wanted, bool w_wanted, candidate out[])
{
    const sgt_interval rms = sgt_proof_rms(p->f_mean), front = sgt_proof_rms_about_mean(p);
    const double area = p->passes;
    double open_f = 0, open_w = 0, lost_f = 0, lost_w = 0;
    size_t n = 0;
    bool in_angle;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        if (b->fate == SGT_PASSED) open_f += width_of(b->f_sum), open_w += width_of(b->ww_sum);
        if (b->fate != SGT_LOST) continue;
        open_f += b->in * width_of(b->f), open_w += b->in * width_of(b->ww);
        lost_f += undecided_of(b) * width_of(b->f), lost_w += undecided_of(b) * width_of(b->ww);
    }
    /* rms^2 is to be known to twice RMS_CLOSE; but no closer than a quarter of what the edge leaves open */
    const double goal_f = fmax(2 * RMS_CLOSE * rms.hi * rms.hi * area, 0.25 * lost_f);
    const double goal_w = fmax(2 * RMS_CLOSE * front.hi * front.hi * area, 0.25 * lost_w);
    f_wanted = f_wanted && p->asked->cell->has_reference && open_f > goal_f && isfinite(goal_f) && goal_f > 0;
    w_wanted = w_wanted && p->asked->cell->has_opd && open_w > goal_w && isfinite(goal_w) && goal_w > 0;
    if (!f_wanted && !w_wanted) return 0;
    for (size_t i = 0; i < p->count; i++) {
        const prove_box *b = &p->box[i];
        if (!may_pass(b) || !halving_of(b, &in_angle)) continue;
        const bool all = b->fate == SGT_PASSED;
        const double of_f = all ? width_of(b->f_sum) : b->in * width_of(b->f),
                     of_w = all ? width_of(b->ww_sum) : b->in * width_of(b->ww);
        const double score = fmax(f_wanted ? of_f / goal_f : 0, w_wanted ? of_w / goal_w : 0);
        if (score > 0) out[n++] = (candidate){score, i};
    }
    return n;
}

/* How many boxes are halved at once. */
static size_t round_size(const proof *p)
{
    const size_t part = p->count / ROUND_PART;
    return part < ROUND_LEAST ? ROUND_LEAST : part > ROUND_MOST ? ROUND_MOST : part;
}

static bool limit_open(const proof *p, sgt_prove_quantity of)
{
    for (size_t k = 0; k < p->asked->limits; k++)
        if (p->asked->limit[k].quantity == of &&
            sgt_proof_limit(p, &p->asked->limit[k]).verdict == SGT_LIMIT_UNDECIDED)
            return true;
    return false;
}

static bool any_open(const proof *p)
{
    for (size_t k = 0; k < p->asked->limits; k++)
        if (sgt_proof_limit(p, &p->asked->limit[k]).verdict == SGT_LIMIT_UNDECIDED) return true;
    return false;
}

/* The boxes to be halved now, the foremost first.  needed: the budget has them already. */
static size_t choose(proof *p, double wanted[], candidate out[], bool *needed)
{
    for (size_t k = 0; k < p->asked->limits; k++) {
        const sgt_prove_quantity q = p->asked->limit[k].quantity;
        if (q == SGT_PROVE_RMS || q == SGT_PROVE_OPD_RMS) {
            take_means(p);
            break;
        }
    }
    const bool limits = p->asked->limits, rms = limit_open(p, SGT_PROVE_RMS),
               front = limit_open(p, SGT_PROVE_OPD_RMS),
               area = rms || front || limit_open(p, SGT_PROVE_PASSES) || (none_passes(p) && any_open(p));
    size_t n = unfit_boxes(p, out);
    if ((*needed = n > 0)) return n;
    bounds_wanted(p, wanted);
    if (limits ? area : p->undecided > p->asked->undecided) n = undecided_boxes(p, out);
    const size_t of_area = n;
    qsort(out, of_area, sizeof *out, by_score);
    if (limits && (rms || front)) n += open_boxes(p, rms, front, out + n);
    n += wide_boxes(p, wanted, out + n);
    if (!limits && n == 0) {
        take_means(p);
        n = open_boxes(p, true, true, out);
    }
    qsort(out + of_area, n - of_area, sizeof *out, by_score);
    /* most of the round for the area, if it needs so many */
    const size_t round = round_size(p), area_first = round - round / AREA_PARTS;
    for (size_t k = area_first; k < round && k < of_area && of_area + k - area_first < n; k++) {
        const candidate other = out[of_area + k - area_first];
        out[of_area + k - area_first] = out[k], out[k] = other;
    }
    return n;
}

/* --------------------------------------------------------------------- the loop */

/* The boxes that are chosen are halved, and their halves carried through. */
static bool halve(proof *p, one_round *r, const candidate chosen[], size_t count)
{
    const prove_asked *a = p->asked;
    size_t tasks = 0;
    if (!make_room(p, p->count + count)) return false;
    for (size_t k = 0; k < count; k++) {
        const size_t i = chosen[k].box;
        sector two[2];
        bool in_angle;
        if (!halving_of(&p->box[i], &in_angle)) continue;
        sgt_sector_halve(&p->box[i].of, in_angle, two);
        r->half[tasks++].box = (prove_box){.of = two[0]};
        r->half[tasks++].box = (prove_box){.of = two[1]};
    }
    if (a->run) a->run(a->context, tasks, carry_half, r);
    else
        for (size_t i = 0; i < tasks; i++) carry_half(r, i);
    for (size_t k = 0, t = 0; k < count; k++)
        for (int side = 0; side < 2; side++, t++) {
            const half *h = &r->half[t];
            const size_t i = side == 0 ? chosen[k].box : p->count++;
            p->box[i] = h->box;
            memcpy(p->bound + i * p->quantities, h->bound, p->quantities * sizeof *h->bound);
            for (size_t q = 0; q < p->quantities; q++)
                if (h->seen[q].value > p->seen[q].value ||
                    (isnan(p->seen[q].value) && !isnan(h->seen[q].value)))
                    p->seen[q] = h->seen[q];
        }
    for (size_t t = 0; t < tasks; t++) p->carried += sgt_sector_is_fit(&r->half[t].box.of);
    return true;
}

static bool branch(proof *p, one_round *r, double wanted[])
{
    candidate *chosen = NULL;
    size_t room = 0;
    bool fine = true;
    while (fine) {
        if (room < 2 * p->count + 2) {
            candidate *more = grown(p->asked, chosen, 4 * p->count + 64, sizeof *more);
            if (!more) { fine = false; break; }
            chosen = more, room = 4 * p->count + 64;
        }
        bool needed;
        const size_t n = choose(p, wanted, chosen, &needed);
        if (n == 0) break;
        if (needed && p->asked->boxes < LEAST_BOXES) { p->spent = true; break; }
        /* a box may be chosen for two reasons */
        const size_t most = round_size(p);
        size_t count = 0, left = p->asked->boxes > p->carried ? p->asked->boxes - p->carried : 0;
        for (size_t k = 0; k < n && count < most && (needed || left > 1); k++) {
            const size_t cost = needed ? 0 : 2;
            bool there = cost > left;
            for (size_t j = 0; j < count && !there; j++) there = chosen[j].box == chosen[k].box;
            if (!there) chosen[count++] = chosen[k], left -= cost;
        }
        if (count == 0) { p->spent = true; break; }
        fine = halve(p, r, chosen, count);
        if (fine) sum_up(p);
    }
    sgt_launch_forget(p->asked->cell->from, chosen);
    return fine;
}

bool sgt_proof_run(const prove_asked *asked, proof *p)
{
    const prove_cell *c = asked->cell;
    const size_t q = prove_quantities(c->count), halves = 2 * ROUND_MOST;
    *p = (proof){.asked = asked, .quantities = q};
    half *half_of = sgt_launch_take(c->from, halves, sizeof *half_of);
    double *numbers = sgt_launch_take(c->from, 2 * halves * q + q, sizeof *numbers);
    prove_seen *seen = sgt_launch_take(c->from, halves * q, sizeof *seen);
    p->most = sgt_launch_take(c->from, q, sizeof *p->most);
    p->seen = sgt_launch_take(c->from, q, sizeof *p->seen);
    bool fine = half_of && numbers && seen && p->most && p->seen && make_room(p, 1);
    size_t rooms = 0;
    for (; fine && rooms < halves; rooms++) {
        half_of[rooms] = (half){.bound = numbers + 2 * rooms * q, .value = numbers + (2 * rooms + 1) * q,
                                .seen = seen + rooms * q, .room = sgt_carry_room_new(c)};
        if (!half_of[rooms].room) { fine = false; break; }
    }
    if (fine) {
        one_round r = {p, half_of};
        forget_seen(p->seen, q);
        see_rings(p, half_of[0].room, half_of[0].value);
        half_of[0].box = (prove_box){.of = DISC_WHOLE};
        carry_half(&r, 0);
        p->box[0] = half_of[0].box, p->count = 1;
        memcpy(p->bound, half_of[0].bound, q * sizeof *p->bound);
        sum_up(p);
        fine = branch(p, &r, numbers + 2 * halves * q);
        if (fine) take_means(p);
    }
    for (size_t i = 0; i < rooms; i++) sgt_carry_room_free(c, half_of[i].room);
    sgt_launch_forget(c->from, half_of), sgt_launch_forget(c->from, numbers);
    sgt_launch_forget(c->from, seen);
    return fine;
}
