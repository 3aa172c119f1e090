// SPDX-License-Identifier: MIT
/* between_rays.c - rays of a field and wavelength between, and the worst that are found: at a net of points,
 * and from there by steps to better neighbours.  Bounds are held against them, and they break limits. */
#include "between_box.h"

/* --------------------------------------------------------------------------- rays */

static sgt_vec2 field_at(const between_cell *c, size_t patch, const double s[SIDES])
{
    const between_patch *p = &c->patch[patch];
    const double u = s[SIDE_U], uv = u * s[SIDE_V], DEGREES = 57.29577951308232;
    sgt_vec2 f = {p->a.x + u * (p->b.x - p->a.x), p->a.y + u * (p->b.y - p->a.y)};
    if (c->field_sides > 1) f.x += uv * (p->c.x - p->b.x), f.y += uv * (p->c.y - p->b.y);
    if (c->beam.finite) return f;
    return (sgt_vec2){atan(f.x) * DEGREES, atan(f.y) * DEGREES};
}

static sgt_vec2 pupil_at(const double s[SIDES])
{
    const double degrees = 360 * s[SIDE_TURN];
    double c, sine;
    sgt_turns(1, &degrees, &c, &sine);
    return (sgt_vec2){s[SIDE_RADIUS] * c, s[SIDE_RADIUS] * sine};
}

between_ray sgt_between_ray(const between_cell *c, const between_seen *seen)
{
    const double none = (double)NAN;
    if (isnan(seen->value)) return (between_ray){none, none, none, none, none};
    const sgt_vec2 f = field_at(c, seen->patch, seen->at), p = pupil_at(seen->at);
    return (between_ray){f.x, f.y, seen->at[SIDE_WAVE], p.x, p.y};
}

/* The chief ray, whatever clips it. */
static sgt_ray_end chief_at(through_room *r, const sgt_element e[], double before)
{
    const size_t n = r->cell.count;
    const sgt_vec2 at = sgt_vignetted(&r->beam, 0, 0);
    sgt_ray ray = sgt_field_ray(&r->beam, at.x, at.y);
    sgt_ray_end end = {.fate = SGT_LOST};
    const size_t passed = sgt_trace_through(n, e, before, &ray, r->open, r->passages, &end.fate);
    end.element = passed;
    if (end.fate != SGT_PASSED) return end;
    sgt_vec3 d = ray.d;
    if (n > 1) d = out_of3(&e[n - 2].pose, r->passages[n - 2].direction);
    end.p = r->passages[n - 1].hit.p, end.d = into3(&e[n - 1].pose, d), end.opl = r->passages[n - 1].opl;
    return end;
}

void sgt_between_aim(through_room *r, size_t patch, const double s[SIDES])
{
    const between_cell *c = r->c;
    const sgt_vec2 f = field_at(c, patch, s);
    const double um = s[SIDE_WAVE];
    prove_cell *to = &r->cell;
    r->beam = c->beam;
    sgt_beam_point(c->from, &r->beam, f.x, f.y);
    const sgt_ray_end primary = chief_at(r, c->e_primary, c->before_primary);
    to->has_reference = primary.fate == SGT_PASSED, to->reference = to->afocal ? primary.d : primary.p;
    to->before = sgt_between_elements(r, um), to->e = r->traced;
    const sgt_ray_end own = chief_at(r, r->traced, to->before);
    to->has_opd =
        c->unit > 0 && um > 0 && sgt_between_front_known(c) &&
        c->reference(c->from->lens, c->data, r->traced, to->before, &own, to->afocal, &to->about, NULL);
    to->waves = c->unit / um;
}

bool sgt_between_passes(through_room *r, const double s[SIDES])
{
    const sgt_vec2 p = pupil_at(s);
    return sgt_carry_ray(&r->cell, r->rays, p.x, p.y, r->value) == SGT_PASSED;
}

void sgt_between_note(const through_room *r, size_t patch, const double s[SIDES], between_seen seen[])
{
    for (size_t q = 0; q < prove_quantities(r->cell.count); q++) {
        if (q == Q_HIGH || q == Q_LOW ||
            !(r->value[q] > seen[q].value || (isnan(seen[q].value) && !isnan(r->value[q]))))
            continue;
        seen[q] = (between_seen){.value = r->value[q], .patch = patch};
        memcpy(seen[q].at, s, sizeof seen[q].at);
    }
}

enum { RINGS_SEEN = 6, SPOKES = 16, PUPIL_SEEN = 1 + RINGS_SEEN * SPOKES };
static void pupil_point(size_t i, double s[SIDES])
{
    static const double ring[RINGS_SEEN] = {0.3, 0.6, 0.8, 0.9, 0.97, 1};
    s[SIDE_RADIUS] = i ? ring[(i - 1) / SPOKES] : 0,
    s[SIDE_TURN] = i ? (double)((i - 1) % SPOKES) / SPOKES : 0;
}

/* Rays of one field and wavelength at the net of the pupil: returns the largest less the smallest path
 * difference. */
static double see_pupil(through_room *r, size_t patch, const double at[SIDES], between_seen seen[],
                        between_seen *high, between_seen *low, size_t *passed)
{
    double s[SIDES];
    memcpy(s, at, sizeof s);
    high->value = low->value = (double)NAN;
    sgt_between_aim(r, patch, s);
    for (size_t i = 0; i < PUPIL_SEEN; i++) {
        pupil_point(i, s);
        if (!sgt_between_passes(r, s)) continue;
        ++*passed;
        sgt_between_note(r, patch, s, seen);
        for (int side = 0; side < 2; side++) {
            between_seen *to = side ? low : high;
            const double value = r->value[side ? Q_LOW : Q_HIGH];
            if (!(value > to->value || (isnan(to->value) && !isnan(value)))) continue;
            to->value = value, to->patch = patch, memcpy(to->at, s, sizeof s);
        }
    }
    return high->value + low->value;
}

static double step_of(const between_cell *c, int side)
{
    if (side == SIDE_U || side == SIDE_V) return side < c->field_sides ? 0.125 : 0;
    if (side == SIDE_WAVE) return (c->um[1] - c->um[0]) / 8;
    return side == SIDE_RADIUS ? 0.1 : 0.5 / SPOKES;
}

/* Moves one side by a step; false: it cannot. */
static bool moved_by(const between_cell *c, double s[SIDES], int side, double step)
{
    const double low = side == SIDE_WAVE ? c->um[0] : 0, high = side == SIDE_WAVE ? c->um[1] : 1;
    if (step == 0) return false;
    s[side] += step;
    if (side == SIDE_TURN) s[side] -= floor(s[side]);
    else s[side] = fmin(fmax(s[side], low), high);
    return true;
}

/* Uphill from a ray, by steps that are halved; only in the pupil: of its field. */
static void climb(through_room *r, size_t q, int first, between_seen *best)
{
    enum { HALVINGS = 6 };
    if (isnan(best->value)) return;
    for (int k = 0; k < HALVINGS; k++)
        for (int side = first; side < SIDES; side++)
            for (int sign = -1; sign <= 1; sign += 2) {
                double s[SIDES];
                memcpy(s, best->at, sizeof s);
                if (!moved_by(r->c, s, side, sign * ldexp(step_of(r->c, side), -k))) break;
                sgt_between_aim(r, best->patch, s);
                if (sgt_between_passes(r, s) && r->value[q] > best->value)
                    best->value = r->value[q], memcpy(best->at, s, sizeof s);
            }
}

/* The same of the largest less the smallest difference, over fields and wavelengths. */
static void climb_range(through_room *r, between_net *net)
{
    enum { HALVINGS = 3 };
    between_seen *high = &net->seen[Q_HIGH], a, b;
    if (isnan(high->value)) return;
    double best = high->value + net->low.value;
    for (int k = 0; k < HALVINGS; k++)
        for (int side = 0; side < SIDE_RADIUS; side++)
            for (int sign = -1; sign <= 1; sign += 2) {
                double s[SIDES];
                memcpy(s, high->at, sizeof s);
                if (!moved_by(r->c, s, side, sign * ldexp(step_of(r->c, side), -k))) break;
                const double range = see_pupil(r, high->patch, s, net->seen, &a, &b, &net->passed);
                if (range > best) best = range, *high = a, net->low = b;
            }
    climb(r, Q_HIGH, SIDE_RADIUS, high), climb(r, Q_LOW, SIDE_RADIUS, &net->low);
    high->value += net->low.value;
}

bool sgt_between_look(const between_asked *asked, between_net *net)
{
    const between_cell *c = asked->cell;
    const size_t quantities = prove_quantities(c->from->lens->count);
    const size_t us = c->field_sides == 1 ? 9
                      : c->field_sides    ? 5
                                          : 1,
                 vs = c->field_sides > 1 ? 3 : 1, ws = is_wide(c) ? 5 : 1;
    through_room r;
    *net = (between_net){.seen = taken(c, quantities, sizeof *net->seen)};
    bool fine = net->seen && sgt_between_room_begin(&r, c);
    if (!net->seen) return false;
    for (size_t q = 0; q < quantities; q++) net->seen[q].value = (double)NAN;
    net->low.value = (double)NAN;
    double best = (double)NAN;
    for (size_t i = 0; fine && i < c->patches * us * vs * ws; i++) {
        const size_t u = i % us, v = i / us % vs, w = i / us / vs % ws, patch = i / us / vs / ws;
        const double s[SIDES] = {
            us > 1 ? (double)u / (double)(us - 1) : 0, vs > 1 ? (double)v / (double)(vs - 1) : 0,
            ws > 1 ? c->um[0] + (c->um[1] - c->um[0]) * (double)w / (double)(ws - 1) : c->um[0]};
        between_seen a, b;
        const double range = see_pupil(&r, patch, s, net->seen, &a, &b, &net->passed);
        net->lost_chiefs += !r.cell.has_reference;
        if (range > best || (isnan(best) && !isnan(range))) best = range, net->seen[Q_HIGH] = a, net->low = b;
    }
    if (fine) climb_range(&r, net);
    for (size_t q = 0; fine && q < quantities; q++)
        if (q != Q_HIGH && q != Q_LOW) climb(&r, q, 0, &net->seen[q]);
    sgt_between_room_free(&r);
    return fine;
}

void sgt_between_forget(const between_asked *asked, between_net *net)
{
    sgt_launch_forget(asked->cell->from, net->seen);
    net->seen = NULL;
}
