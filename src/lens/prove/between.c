// SPDX-License-Identifier: MIT
/* between.c - bounds for the rays of all fields and wavelengths between those of a lens.
 *
 * BRANCH AND BOUND as in branch.c, but boxes cover the rays and may overlap, for nothing is summed.  Fields
 * and wavelengths are first divided into parts, each with its own budget.  A part knows of others only what
 * sgt_between_look saw before all of them.  So its answer is the same wherever it is worked out.
 *
 * LARGEST LESS SMALLEST path difference is of one field and wavelength.  Fields and wavelengths of a part are
 * divided into NET cells a side.  Of each, the largest bound among the boxes that reach into it, and the
 * largest bound of -w: their sum bounds all of its fields.
 *
 * What a box is, and how it goes through the lens: between_through.c; what it shows: between_carry.c. */
#include "between_box.h"

#include <stdlib.h>

static const double WANTED_WITHIN = 0.02;
enum { NET = 8, LEAST_ROUND = 16, ROUND_SHARE = 16, DEEPEST = 24 };

enum { PARTS_U = 8, PARTS_OF_TWO = 2, PARTS_WAVE = 2 };

static size_t parts_of_field(const between_cell *c)
{
    return c->field_sides == 1 ? PARTS_U : c->field_sides ? PARTS_OF_TWO : 1;
}

size_t sgt_between_parts(const between_cell *c)
{
    const size_t u = parts_of_field(c), v = c->field_sides > 1 ? PARTS_OF_TWO : 1;
    return c->patches * u * v * (is_wide(c) ? PARTS_WAVE : 1);
}

size_t sgt_between_part_size(const between_cell *c)
{
    return sizeof(between_part) +
           prove_quantities(c->from->lens->count) * (sizeof(double) + sizeof(between_seen));
}

double *sgt_between_most(const between_cell *c, between_part *part)
{
    (void)c;
    return (double *)(void *)(part + 1);
}

between_seen *sgt_between_part_seen(const between_cell *c, between_part *part)
{
    return (between_seen *)(void *)(sgt_between_most(c, part) + prove_quantities(c->from->lens->count));
}

static between_box part_box(const between_cell *c, size_t i)
{
    const size_t us = parts_of_field(c), vs = c->field_sides > 1 ? PARTS_OF_TWO : 1,
                 ws = is_wide(c) ? PARTS_WAVE : 1;
    const size_t u = i % us, v = i / us % vs, w = i / us / vs % ws;
    const double wide = c->um[1] - c->um[0];
    between_box b = {.patch = i / us / vs / ws};
    if (us > 1) b.lo[SIDE_U] = (double)u / (double)us, b.hi[SIDE_U] = (double)(u + 1) / (double)us;
    if (vs > 1) b.lo[SIDE_V] = (double)v / (double)vs, b.hi[SIDE_V] = (double)(v + 1) / (double)vs;
    b.lo[SIDE_WAVE] = b.hi[SIDE_WAVE] = c->um[0];
    if (ws > 1) {
        b.lo[SIDE_WAVE] = w ? c->um[0] + wide * ((double)w / (double)ws) : c->um[0];
        b.hi[SIDE_WAVE] = w + 1 < ws ? c->um[0] + wide * ((double)(w + 1) / (double)ws) : c->um[1];
    }
    b.hi[SIDE_RADIUS] = 1;
    return b;
}

typedef struct part_search {
    const between_asked *asked;
    const between_net *net;
    through_room r;
    between_box whole;           /* the part */
    size_t quantities, count, room;
    between_box *box;
    double *bound;               /* [count * quantities] */
    between_seen *seen;          /* [quantities] */
    double *most, *wanted;       /* [quantities] */
    double high[NET * NET * NET], low[NET * NET * NET];
    size_t carried;
    bool passed, opd;            /* path differences are bounded now; before that the others */
} part_search;

static bool grow_boxes(part_search *s, size_t count)
{
    const sgt_allocator *by = &s->asked->cell->from->allocator;
    if (count <= s->room) return true;
    const size_t room = 2 * count + 64;
    between_box *box = by->resize(by->context, s->box, room * sizeof *box);
    if (box) s->box = box;
    double *bound = box ? by->resize(by->context, s->bound, room * s->quantities * sizeof *bound) : NULL;
    if (bound) s->bound = bound, s->room = room;
    return bound;
}

/* The cells of the net that it reaches into. */
typedef struct net_range { size_t lo[3], hi[3]; } net_range;
static net_range net_of(const part_search *s, const between_box *b)
{
    net_range out;
    for (int k = 0; k < 3; k++) {
        const double from = s->whole.lo[k], width = s->whole.hi[k] - from;
        out.lo[k] = out.hi[k] = 0;
        if (!(width > 0)) continue;
        /* (a box ends at an edge of cells, or inside of one: one more is counted, in case of rounding) */
        const double lo = floor((b->lo[k] - from) / width * NET - 0x1p-20),
                     hi = floor((b->hi[k] - from) / width * NET + 0x1p-20);
        out.lo[k] = lo > 0 ? (size_t)lo : 0, out.hi[k] = hi < NET - 1 ? (size_t)hi : NET - 1;
    }
    return out;
}

#define EACH_CELL(n)                                       \
    for (size_t i_ = (n).lo[0]; i_ <= (n).hi[0]; i_++)     \
        for (size_t j_ = (n).lo[1]; j_ <= (n).hi[1]; j_++) \
            for (size_t k_ = (n).lo[2], at = (i_ * NET + j_) * NET + k_; k_ <= (n).hi[2]; k_++, at++)

static void gather_bounds(part_search *s)
{
    for (size_t q = 0; q < s->quantities; q++) s->most[q] = -HUGE_VAL;
    for (size_t k = 0; k < (size_t)NET * NET * NET; k++) s->high[k] = s->low[k] = -HUGE_VAL;
    for (size_t i = 0; i < s->count; i++) {
        const between_box *b = &s->box[i];
        if (b->ended) continue;
        for (size_t q = 0; q < s->quantities; q++)
            if (!(s->bound[i * s->quantities + q] <= s->most[q]))
                s->most[q] = s->bound[i * s->quantities + q];
        const net_range n = net_of(s, b);
        EACH_CELL(n) {
            if (!(b->high <= s->high[at])) s->high[at] = b->high;
            if (!(b->low <= s->low[at])) s->low[at] = b->low;
        }
    }
    s->most[Q_HIGH] = -HUGE_VAL, s->most[Q_LOW] = -HUGE_VAL;
    for (size_t k = 0; k < (size_t)NET * NET * NET; k++) {
        if (s->high[k] == -HUGE_VAL) continue;
        const double range = sgt_sum_above(s->high[k], s->low[k]);
        if (!(range <= s->most[Q_HIGH])) s->most[Q_HIGH] = range;
    }
}

static double seen_before(const part_search *s, size_t q)
{
    return isnan(s->seen[q].value) || s->net->seen[q].value > s->seen[q].value ? s->net->seen[q].value
                                                                               : s->seen[q].value;
}

static double value_wanted(const sgt_prove_limit *l)
{
    const double value = l->quantity == SGT_PROVE_CLEARANCE ? -l->value : l->value;
    return l->or_equal ? value : nextafter(value, -HUGE_VAL);
}

size_t sgt_between_quantities(const between_cell *c, const sgt_prove_limit *l, size_t *first, size_t *step)
{
    const size_t n = c->from->lens->count;
    *step = 1, *first = l->quantity == SGT_PROVE_EX     ? Q_EX
                        : l->quantity == SGT_PROVE_EY   ? Q_EY
                        : l->quantity == SGT_PROVE_SPOT ? Q_SPOT
                                                        : Q_HIGH;
    if (l->quantity != SGT_PROVE_INCIDENCE && l->quantity != SGT_PROVE_CLEARANCE) return 1;
    *first = prove_at_element(l->element ? l->element - 1 : 0,
                              l->quantity == SGT_PROVE_INCIDENCE ? Q_INCIDENCE : Q_INSIDE);
    *step = Q_EACH;
    return l->element ? 1 : n;
}

static void want_bounds(part_search *s)
{
    const between_cell *c = s->asked->cell;
    const double floor_of = 1e-9 * c->beam.radius;
    for (size_t q = 0; q < s->quantities; q++) s->wanted[q] = HUGE_VAL;
    for (size_t k = 0; k < s->asked->limits; k++) {
        size_t first, step;
        const size_t count = sgt_between_quantities(c, &s->asked->limit[k], &first, &step);
        const double value = value_wanted(&s->asked->limit[k]);
        bool broken = false;
        for (size_t i = 0; i < count; i++) broken = broken || seen_before(s, first + i * step) > value;
        for (size_t i = 0; i < count && !broken; i++)
            s->wanted[first + i * step] = fmin(s->wanted[first + i * step], value);
    }
    if (s->asked->limits) return;
    for (size_t q = 0; q < s->quantities; q++) {
        const double seen = seen_before(s, q);
        double size = fabs(seen), least = floor_of;
        if (q >= Q_OF_ELEMENTS) {
            const int of = (int)((q - Q_OF_ELEMENTS) % Q_EACH);
            if (of == Q_HEIGHT) continue;
            if (of == Q_INSIDE) size = fabs(seen_before(s, q - Q_INSIDE + Q_HEIGHT));
            if (of == Q_INCIDENCE) least = 0.1;
        }
        if (q == Q_HIGH) least = 1e-6;
        if (q == Q_LOW || (q == Q_HIGH && !s->opd) || isnan(seen) ||
            (q < Q_OF_ELEMENTS && s->net->lost_chiefs))
            continue;
        s->wanted[q] = seen + fmax(WANTED_WITHIN * size, least);
    }
}

static double volume_of(const part_search *s, const between_box *b)
{
    double share = (b->hi[SIDE_RADIUS] - b->lo[SIDE_RADIUS]) * (b->hi[SIDE_RADIUS] + b->lo[SIDE_RADIUS]) *
                   (b->hi[SIDE_TURN] - b->lo[SIDE_TURN]);
    for (int k = 0; k < 3; k++)
        if (s->whole.hi[k] > s->whole.lo[k])
            share *= (b->hi[k] - b->lo[k]) / (s->whole.hi[k] - s->whole.lo[k]);
    return share;
}

/* By how much a box is above what is wanted, and which of its ways to divide is for that; 0: it is not. */
static double too_much(const part_search *s, size_t i, int *way)
{
    const between_box *b = &s->box[i];
    const double *bound = s->bound + i * s->quantities;
    double score = 0;
    *way = WAY_ELEMENT;
    if (b->ended) return 0;
    for (size_t q = 0; q < s->quantities; q++) {
        double over = q == Q_HIGH || q == Q_LOW ? 0 : bound[q] - s->wanted[q];
        if (q == Q_HIGH && s->wanted[q] < HUGE_VAL) {
            const net_range n = net_of(s, b);
            EACH_CELL(n) over = fmax(over, fmax(b->high + s->low[at], b->low + s->high[at]) - s->wanted[q]);
        }
        if (!(over > 0)) continue;
        const double unit = fabs(seen_before(s, q)) + 0x1p-100;
        const double by = isfinite(over / unit) && b->bounded ? over / unit : 1e6 * (1 + volume_of(s, b));
        if (by > score) score = by, *way = q <= Q_SPOT ? WAY_SPOT : q == Q_HIGH ? WAY_OPD : WAY_ELEMENT;
    }
    return score;
}

typedef struct choice { double score; size_t box; int side; } choice;
static int by_excess(const void *a, const void *b)
{
    const choice *x = a, *y = b;
    if (x->score != y->score) return x->score < y->score ? 1 : -1;
    return x->box < y->box ? -1 : x->box > y->box;
}

/* Can it be halved there? */
static bool can_halve(const part_search *s, const between_box *b, int side)
{
    const double whole = side < SIDE_RADIUS ? s->whole.hi[side] - s->whole.lo[side] : 1;
    return side >= 0 && b->hi[side] - b->lo[side] > ldexp(whole, -DEEPEST);
}

static void carry_box(part_search *s, size_t i)
{
    between_box *b = &s->box[i];
    double *bound = s->bound + i * s->quantities;
    for (size_t q = 0; q < s->quantities; q++) bound[q] = HUGE_VAL;
    sgt_between_carry(&s->r, b, bound);
    s->carried++;
}

/* The middle ray of a box. */
static void see_box(part_search *s, const between_box *b)
{
    double at[SIDES];
    if (b->ended) return;
    for (int k = 0; k < SIDES; k++) at[k] = (b->lo[k] + b->hi[k]) / 2;
    if (b->hi[SIDE_RADIUS] == 1) at[SIDE_RADIUS] = 1;
    sgt_between_aim(&s->r, b->patch, at);
    if (sgt_between_passes(&s->r, at)) s->passed = true, sgt_between_note(&s->r, b->patch, at, s->seen);
}

/* Halves the boxes that are above what is wanted, the foremost first, round by round.  false: no memory. */
static bool divide_all(part_search *s, bool *spent)
{
    choice *chosen = NULL;
    bool fine = true;
    *spent = false;
    for (size_t room = 0;;) {
        if (room < s->count) {
            sgt_launch_forget(s->asked->cell->from, chosen);
            room = 2 * s->count, chosen = taken(s->asked->cell, room, sizeof *chosen);
            if (!chosen) return false;
        }
        size_t n = 0;
        want_bounds(s), gather_bounds(s);
        for (size_t i = 0; i < s->count; i++) {
            int way;
            const double score = too_much(s, i, &way);
            if (score > 0 && !s->box[i].hopeless && can_halve(s, &s->box[i], s->box[i].divide[way]))
                chosen[n++] = (choice){score, i, s->box[i].divide[way]};
        }
        if (n == 0 && !s->opd) { s->opd = true; continue; }
        if (n == 0) break;
        qsort(chosen, n, sizeof *chosen, by_excess);
        size_t most = s->count / ROUND_SHARE < LEAST_ROUND ? LEAST_ROUND : s->count / ROUND_SHARE;
        if (most > n) most = n;
        /* half of the budget is kept for path differences */
        const size_t budget = s->opd || s->asked->limits ? s->asked->boxes : s->asked->boxes / 2;
        const size_t left = budget > s->carried ? (budget - s->carried) / 2 : 0;
        if (most > left) most = left;
        if (most == 0 && !s->opd) { s->opd = true; continue; }
        if (most == 0) { *spent = true; break; }
        if (!grow_boxes(s, s->count + most)) { fine = false; break; }
        for (size_t k = 0; k < most; k++) {
            between_box *one = &s->box[chosen[k].box], *other = &s->box[s->count];
            const int side = chosen[k].side;
            const double middle = (one->lo[side] + one->hi[side]) / 2;
            *other = *one, one->hi[side] = other->lo[side] = middle;
            carry_box(s, chosen[k].box), carry_box(s, s->count);
            see_box(s, one), see_box(s, other);
            s->count++;
        }
    }
    sgt_launch_forget(s->asked->cell->from, chosen);
    return fine;
}

bool sgt_between_prove(const between_asked *asked, const between_net *net, size_t i, between_part *out)
{
    enum { QUARTERS = 4 };
    const between_cell *c = asked->cell;
    const size_t q = prove_quantities(c->from->lens->count);
    part_search *s = taken(c, 1, sizeof *s);
    if (!s) return false;
    s->asked = asked, s->net = net, s->whole = part_box(c, i), s->quantities = q;
    s->most = sgt_between_most(c, out), s->seen = sgt_between_part_seen(c, out),
    s->wanted = taken(c, q, sizeof *s->wanted);
    bool fine = s->wanted && sgt_between_room_begin(&s->r, c) && grow_boxes(s, QUARTERS), spent = false;
    *out = (between_part){.boxes = 0};
    for (size_t k = 0; fine && k < q; k++) s->seen[k].value = (double)NAN;
    for (int k = 0; fine && k < QUARTERS; k++) {
        s->box[k] = s->whole;
        s->box[k].lo[SIDE_TURN] = 0.25 * k, s->box[k].hi[SIDE_TURN] = 0.25 * (k + 1);
        s->count = (size_t)k + 1, carry_box(s, (size_t)k), see_box(s, &s->box[k]);
    }
    fine = fine && divide_all(s, &spent);
    if (fine) {
        out->boxes = s->carried, out->spent = spent, out->passed = s->passed;
        double largest = -1;
        for (size_t k = 0; k < s->count; k++) {
            int way;
            const between_box *b = &s->box[k];
            const double share = volume_of(s, b);
            if (too_much(s, k, &way) > 0) out->undecided += share;
            if (!b->ended && b->hopeless && share > largest)
                largest = share, out->hopeless = 1, out->element = b->element, out->why = (int)b->why;
        }
    }
    if (s->r.c) sgt_between_room_free(&s->r);
    sgt_launch_forget(c->from, s->wanted), sgt_launch_forget(c->from, s->box),
        sgt_launch_forget(c->from, s->bound);
    sgt_launch_forget(c->from, s);
    return fine;
}
