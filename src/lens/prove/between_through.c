// SPDX-License-Identifier: MIT
/* between_through.c - a box of field, wavelength and pupil as a launch, and through the lens.
 *
 * A BOX has up to five sides: one or two of the field, the wavelength, and radius and angle in the pupil. Its
 * rays go through the lens together as models of second order (beam.h), whose parameters are the sides that
 * there are.
 *
 * FIELDS.  Slopes of chief rays from afar, or points of the object, fill the convex hull of those of the
 * fields: a line, or triangles.  The triangle a b c is a + u (b - a) + u v (c - b), which a model has without
 * a rest.  A ray from afar begins on the plane z = front, so that its point and slopes are such polynomials,
 * too; its path from the common wavefront is then longer by n0 d . (o - o0), d of unit length, o0 that of the
 * chief ray.
 *
 * THE PUPIL.  Of a sector r0 <= r <= r1, |angle| <= phi about its middle, a = r cos, b = r sin: with
 *
 *     A = a + b^2 / (2 r1)
 *
 * it lies in r0 cos phi + (r0 sin phi)^2 / (2 r1) <= A <= r1, |b| <= r1 sin phi.  For A(r, angle) rises with
 * r and falls with |angle|: its derivative by the angle is -r sin (1 - r / r1 cos).  So a = A - b^2 / (2 r1)
 * is a polynomial of second order, too.  It goes beyond r1 by b^4 / (8 r1^3) at most.
 *
 * INDICES are those of dispersion.c; what a phase in waves adds goes with the wavelength. */
#include "between_box.h"
#include "dispersion.h"

#include <sagitta/surfaces.h>

static const double RIM_WIDER = 1.0625;

/* ------------------------------------------------------------------------ memory */

void sgt_between_room_free(through_room *r)
{
    const sgt_launcher *from = r->c->from;
    for (int k = 0; k < VARIANTS; k++)
        sgt_launch_forget(from, r->own[k]), sgt_launch_forget(from, r->kept[k]);
    for (int k = 0; k < WAVES_KEPT; k++) {
        sgt_launch_forget(from, r->waves[k].index), sgt_launch_forget(from, r->waves[k].number);
        sgt_launch_forget(from, r->waves[k].per_wave);
    }
    sgt_launch_forget(from, r->at), sgt_launch_forget(from, r->medium), sgt_launch_forget(from, r->passages);
    sgt_launch_forget(from, r->open), sgt_launch_forget(from, r->traced), sgt_launch_forget(from, r->phase);
    sgt_launch_forget(from, r->value);
    sgt_carry_room_free(&r->cell, r->rays);
}

/* Which media depend on the wavelength: those of glasses, and those that are the same as in front. */
static void set_media(const between_cell *c, medium_over medium[])
{
    const sgt_lens *l = c->from->lens;
    sgt_glass now;
    bool varies = false;
    size_t line;
    for (size_t i = 0; i <= l->count; i++) {
        const bool named = sgt_lens_glass(l, i, &medium[i].glass, &line);
        if (named) now = medium[i].glass, varies = true;
        const double index = i ? c->e[i - 1].index : c->before,
                     other = i ? c->e_primary[i - 1].index : c->before_primary;
        if (!named && varies && index != SGT_MIRROR) {
            /* an index by numbers is that at all wavelengths; one as in front is the glass's */
            const bool same =
                index == sgt_glass_index(&now, c->um[0]) && other == sgt_glass_index(&now, c->primary);
            if (!same) varies = false;
        }
        medium[i].varies = varies;
        if (varies) medium[i].glass = now;
    }
}

bool sgt_between_room_begin(through_room *r, const between_cell *c)
{
    const size_t n = c->from->lens->count;
    *r = (through_room){.c = c};
    bool fine = true;
    for (int k = 0; k < VARIANTS; k++) {
        r->own[k] = taken(c, n, sizeof *r->own[k]), r->kept[k] = taken(c, n, sizeof *r->kept[k]);
        fine = fine && r->own[k] && r->kept[k];
    }
    r->at = taken(c, n, sizeof *r->at), r->medium = taken(c, n + 1, sizeof *r->medium);
    r->passages = taken(c, n, sizeof *r->passages), r->open = taken(c, n, sizeof *r->open);
    r->traced = taken(c, n, sizeof *r->traced), r->phase = taken(c, n, sizeof *r->phase);
    r->value = taken(c, prove_quantities(n), sizeof *r->value);
    fine = fine && r->at && r->medium && r->passages && r->open && r->traced && r->phase && r->value;
    for (int k = 0; k < WAVES_KEPT; k++) {
        at_waves *w = &r->waves[k];
        w->lo = w->hi = (double)NAN;
        w->index = taken(c, n + 1, sizeof *w->index), w->number = taken(c, 2 * n + 1, sizeof *w->number);
        w->per_wave = taken(c, n, sizeof *w->per_wave);
        fine = fine && w->index && w->number && w->per_wave;
    }
    if (!fine) return false;
    r->cell = (prove_cell){.from = c->from, .beam = &r->beam, .count = n, .e = c->e, .before = c->before,
                           .afocal = c->from->lens->afocal, .opd = c->opd};
    r->rays = sgt_carry_room_new(&r->cell);
    if (!r->rays) return false;
    set_media(c, r->medium);
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < VARIANTS; k++) r->own[k][i] = k == 3 ? c->e_primary[i] : c->e[i];
        r->own[1][i].semi_diameter *= RIM_WIDER;
        for (int k = 1; k < VARIANTS; k++) r->own[k][i].aperture = NULL;
    }
    return true;
}

/* -------------------------------------------------------------------- wavelengths */

/* A phase whose path is in waves. */
static bool in_waves(const sgt_element *e)
{
    return e->phase && e->phase->kind != SGT_IDEAL_LENS && e->phase->kind != SGT_FACETS &&
           e->phase->per_wave != 0;
}

const char *sgt_between_lacks(const between_cell *c, size_t *element)
{
    const sgt_lens *l = c->from->lens;
    const char *why = NULL;
    through_room r;
    *element = 0;
    if (!is_wide(c)) return NULL;
    if (!sgt_between_room_begin(&r, c)) {
        sgt_between_room_free(&r);
        return "no memory";
    }
    for (size_t i = 0; i <= l->count && !why; i++) {
        *element = i ? i - 1 : 0;
        const bool table = r.medium[i].varies && r.medium[i].glass.formula == SGT_DISPERSION_PAIRS &&
                           r.medium[i].glass.count > 2;
        if (table) why = "its glass is a table of indices, which says nothing of the wavelengths between";
        if (i == 0 || why) continue;
        const sgt_element *one = &c->e[i - 1], *other = &c->e_primary[i - 1];
        if (one->phase && other->phase && one->phase != other->phase && !in_waves(one))
            why = "its conjugates depend on the wavelength in a way that is not known between";
    }
    sgt_between_room_free(&r);
    return why;
}

bool sgt_between_waves(through_room *r, int parameter, double lo, double hi, at_waves **out)
{
    const between_cell *c = r->c;
    const size_t n = c->from->lens->count;
    for (int k = 0; k < WAVES_KEPT; k++)
        if (r->waves[k].lo == lo && r->waves[k].hi == hi) return *out = &r->waves[k], true;
    at_waves *w = *out = &r->waves[r->next++ % WAVES_KEPT];
    w->lo = lo, w->hi = hi, w->numbers = 0;
    w->um = sgt_model_parameter(parameter, (sgt_interval){lo, hi});
    for (size_t i = 0; i <= n; i++) {
        const medium_over *m = &r->medium[i];
        if (!m->varies) continue;
        const bool again =
            i && r->medium[i - 1].varies && m->glass.coefficient == r->medium[i - 1].glass.coefficient;
        if (again) w->index[i] = w->index[i - 1];
        else if (!sgt_dispersion(&m->glass, &w->um, &w->index[i])) return w->lo = (double)NAN, false;
        if (i && c->e[i - 1].index == SGT_MIRROR) continue;
        w->number[w->numbers++] = (sgt_box_number){
            .element = i ? i - 1 : SGT_BOX_BEFORE, .what = SGT_BOX_INDEX, .value = &w->index[i]};
    }
    for (size_t i = 0; i < n; i++) {
        if (!in_waves(&c->e[i])) continue;
        sgt_model_scaled(&w->um, c->e[i].phase->per_wave / c->um[0], &w->per_wave[i]);
        w->per_wave[i].rest += SLACK * fabs(c->e[i].phase->per_wave) * (hi / c->um[0]);
        w->number[w->numbers++] =
            (sgt_box_number){.element = i, .what = SGT_BOX_PER_WAVE, .value = &w->per_wave[i]};
    }
    return true;
}

double sgt_between_elements(through_room *r, double um)
{
    const between_cell *c = r->c;
    const size_t n = c->from->lens->count;
    memcpy(r->traced, c->e, n * sizeof *r->traced);
    if (!is_wide(c) || um == c->um[0]) return c->before;
    for (size_t i = 0; i < n; i++) {
        const medium_over *m = &r->medium[i + 1];
        if (m->varies && c->e[i].index != SGT_MIRROR) r->traced[i].index = sgt_glass_index(&m->glass, um);
        if (!in_waves(&c->e[i])) continue;
        r->phase[i] = *c->e[i].phase, r->phase[i].per_wave *= um / c->um[0];
        r->traced[i].phase = &r->phase[i];
    }
    return r->medium[0].varies ? sgt_glass_index(&r->medium[0].glass, um) : c->before;
}

/* ------------------------------------------------------------------------- models */

/* M a + o, or of directions (o NULL) M a: M has the columns ex, ey, ez, or with `into` these as rows. */
static void turned_of(const sgt_pose *p, bool into, const sgt_model a[3], sgt_model out[3])
{
    if (dot3(p->ex, p->ex) == 0) {
        for (int k = 0; k < 3; k++) out[k] = a[k];
        return;
    }
    const double m[3][3] = {
        {p->ex.x, p->ex.y, p->ex.z}, {p->ey.x, p->ey.y, p->ey.z}, {p->ez.x, p->ez.y, p->ez.z}};
    sgt_model made[3];
    for (int i = 0; i < 3; i++) {
        made[i] = sgt_model_of(0);
        double size = 0;
        for (int k = 0; k < 3; k++) {
            sgt_model one;
            sgt_model_scaled(&a[k], into ? m[i][k] : m[k][i], &one);
            sgt_model_sum(&made[i], &one, &made[i]);
            size += sgt_interval_greatest(sgt_model_range(&a[k]));
        }
        add_rest(&made[i], SLACK * size); /* the axes are at right angles to rounding */
    }
    memcpy(out, made, sizeof made);
}

static void moved_of(const sgt_pose *p, bool into, sgt_model a[3])
{
    const double o[3] = {p->origin.x, p->origin.y, p->origin.z};
    for (int k = 0; into && k < 3; k++) sgt_model_plus(&a[k], -o[k], &a[k]);
    turned_of(p, into, a, a);
    for (int k = 0; !into && k < 3; k++) sgt_model_plus(&a[k], o[k], &a[k]);
}

/* ------------------------------------------------------------------------ launches */

int sgt_between_parameters(const between_cell *c, int place[SIDES])
{
    int count = 0;
    place[SIDE_U] = c->field_sides > 0 ? count++ : -1;
    place[SIDE_V] = c->field_sides > 1 ? count++ : -1;
    place[SIDE_WAVE] = is_wide(c) ? count++ : -1;
    place[SIDE_RADIUS] = count, place[SIDE_TURN] = count + 1;
    return count;
}

static sgt_model side_of(const between_box *b, const int place[SIDES], int side)
{
    if (place[side] < 0) return sgt_model_of(b->lo[side]);
    return sgt_model_parameter(place[side], (sgt_interval){b->lo[side], b->hi[side]});
}

void sgt_between_field_model(const between_cell *c, const between_box *b, const int place[SIDES],
                             sgt_model out[2])
{
    const between_patch *p = &c->patch[b->patch];
    const double a[2] = {p->a.x, p->a.y}, ab[2] = {p->b.x - p->a.x, p->b.y - p->a.y},
                 bc[2] = {p->c.x - p->b.x, p->c.y - p->b.y};
    const sgt_model u = side_of(b, place, SIDE_U), v = side_of(b, place, SIDE_V);
    sgt_model uv, one;
    sgt_model_product(&u, &v, &uv);
    for (int k = 0; k < 2; k++) {
        sgt_model_scaled(&u, ab[k], &out[k]), sgt_model_plus(&out[k], a[k], &out[k]);
        if (c->field_sides > 1) sgt_model_scaled(&uv, bc[k], &one), sgt_model_sum(&out[k], &one, &out[k]);
        add_rest(&out[k], SLACK * (fabs(a[k]) + fabs(ab[k]) + fabs(bc[k])));
    }
}

void sgt_between_pupil_model(const between_box *b, const int place[SIDES], sgt_model out[2])
{
    const double r0 = b->lo[SIDE_RADIUS], r1 = b->hi[SIDE_RADIUS], t0 = b->lo[SIDE_TURN],
                 t1 = b->hi[SIDE_TURN];
    const double phi = HALF_TURN * (t1 - t0), middle = HALF_TURN * (t0 + t1), s = sin(phi);
    const double low = r0 * cos(phi) + r0 * s * r0 * s / (2 * r1), far = SLACK * r1;
    const double C = cos(middle), S = sin(middle), sag = r1 * s * s / 2;
    sgt_model a = sgt_model_parameter(place[SIDE_RADIUS], (sgt_interval){low - far, r1 + far});
    sgt_model y = sgt_model_parameter(place[SIDE_TURN], (sgt_interval){-r1 * s - far, r1 * s + far});
    sgt_model one, other;
    a.pair[SGT_MODEL_PAIR(place[SIDE_TURN], place[SIDE_TURN])] -= sag;
    sgt_model_scaled(&a, C, &one), sgt_model_scaled(&y, -S, &other), sgt_model_sum(&one, &other, &out[0]);
    sgt_model_scaled(&a, S, &one), sgt_model_scaled(&y, C, &other), sgt_model_sum(&one, &other, &out[1]);
}

sgt_box_launch sgt_between_launch(const between_cell *c, const sgt_model field[2],
                                  const sgt_model pupil[2], int parameters)
{
    const sgt_field_beam *b = &c->beam;
    sgt_box_launch l = {.parameters = parameters};
    sgt_model x[2], one, other;
    sgt_model_scaled(&pupil[0], b->scale.x, &one), sgt_model_plus(&one, b->shift.x, &one);
    sgt_model_scaled(&pupil[1], b->scale.y, &other), sgt_model_plus(&other, b->shift.y, &other);
    x[0] = one, x[1] = other;
    if (b->turn.y != 0 || b->turn.x != 1) {
        sgt_model t;
        sgt_model_scaled(&one, b->turn.x, &x[0]), sgt_model_scaled(&other, -b->turn.y, &t);
        sgt_model_sum(&x[0], &t, &x[0]);
        sgt_model_scaled(&one, b->turn.y, &x[1]), sgt_model_scaled(&other, b->turn.x, &t);
        sgt_model_sum(&x[1], &t, &x[1]);
    }
    if (b->cone > 0 || b->finite) {
        const sgt_lens *lens = c->from->lens;
        l.o[0] = field[0], l.o[1] = field[1];
        sgt_model_scaled(&field[0], lens->object_slope.x, &l.o[2]);
        sgt_model_scaled(&field[1], lens->object_slope.y, &one), sgt_model_sum(&l.o[2], &one, &l.o[2]);
        sgt_model_plus(&l.o[2], lens->surface[0].z - lens->object_distance, &l.o[2]);
        add_rest(&l.o[2], SLACK * fabs(lens->object_distance));
        if (b->cone > 0) {
            sgt_model_scaled(&x[0], b->cone, &l.d[0]), sgt_model_scaled(&x[1], b->cone, &l.d[1]);
            l.d[2] = sgt_model_of(1);
            return l;
        }
        for (int k = 0; k < 2; k++)
            sgt_model_scaled(&x[k], b->radius, &l.d[k]), sgt_model_difference(&l.d[k], &l.o[k], &l.d[k]);
        sgt_model_scaled(&l.o[2], -1, &l.d[2]), sgt_model_plus(&l.d[2], b->pupil, &l.d[2]);
        /* light runs along +z even if the pupil lies in front of the object */
        for (int k = 0; k < 3 && l.d[2].c < 0; k++) sgt_model_scaled(&l.d[k], -1, &l.d[k]);
        if (sgt_model_range(&l.d[2]).lo <= 0 && l.d[2].c > 0) l.d[2].rest = HUGE_VAL;
        return l;
    }
    for (int k = 0; k < 2; k++) {
        sgt_model_scaled(&x[k], b->radius, &l.o[k]), sgt_model_scaled(&field[k], b->front - b->pupil, &one);
        sgt_model_sum(&l.o[k], &one, &l.o[k]), l.d[k] = field[k];
        add_rest(&l.o[k], SLACK * (fabs(b->front) + fabs(b->pupil)) *
                               sgt_interval_greatest(sgt_model_range(&field[k])));
    }
    l.o[2] = sgt_model_of(b->front), l.d[2] = sgt_model_of(1);
    return l;
}

/* ------------------------------------------------------------------ through the lens */

/* The part along z of a direction of unit length follows from the others, and has less of a rest so: where it
 * is refracted by g n, a rest of g goes along the normal n, which is nearly along z. */
static void mend_direction(sgt_model d[3])
{
    const sgt_interval z = sgt_model_range(&d[2]);
    sgt_model xx, yy, root;
    if (!(z.lo > 0 || z.hi < 0)) return;
    sgt_model_product(&d[0], &d[0], &xx), sgt_model_product(&d[1], &d[1], &yy), sgt_model_sum(&xx, &yy, &xx);
    sgt_model_scaled(&xx, -1, &xx), sgt_model_plus(&xx, 1, &xx), add_rest(&xx, 0x1p-46);
    sgt_model_root(&xx, &root);
    if (!(root.rest < d[2].rest)) return;
    d[2] = root;
    if (z.hi < 0) sgt_model_scaled(&d[2], -1, &d[2]);
}

sgt_box_verdict sgt_between_through(through_room *r, int variant, const at_waves *wave,
                                    const sgt_box_launch *launch, size_t count, sgt_box_at at[],
                                    ray_ends *out)
{
    const between_cell *c = r->c;
    const sgt_element *e = r->own[variant];
    const double before = variant == 3 ? c->before_primary : c->before;
    double index = before == 0 ? 1 : before;
    const sgt_model *index_model = wave && r->medium[0].varies ? &wave->index[0] : NULL;
    sgt_box_launch to = *launch;
    size_t next =
        0; /* of the numbers of `wave`, which are in the order of elements: first indices, then phases */
    out->whole = sgt_model_of(0);
    if (wave && r->medium[0].varies) next++;
    for (size_t i = 0; i < count; i++) {
        sgt_box_number number[3];
        size_t numbers = 0;
        if (index_model)
            number[numbers++] =
                (sgt_box_number){.element = SGT_BOX_BEFORE, .what = SGT_BOX_INDEX, .value = index_model};
        if (wave && r->medium[i + 1].varies && e[i].index != SGT_MIRROR)
            number[numbers++] =
                (sgt_box_number){.element = 0, .what = SGT_BOX_INDEX, .value = &wave->index[i + 1]};
        if (wave && in_waves(&e[i]))
            number[numbers++] =
                (sgt_box_number){.element = 0, .what = SGT_BOX_PER_WAVE, .value = &wave->per_wave[i]};
        const sgt_box_lens lens = {
            .elements = 1, .e = &e[i], .index_before = index, .numbers = numbers, .number = number};
        if (i + 1 == count) {
            out->opl = out->whole;
            memcpy(out->p, to.o, sizeof to.o), memcpy(out->d, to.d, sizeof to.d);
            moved_of(&e[i].pose, true, out->p), turned_of(&e[i].pose, true, out->d, out->d);
            if (count == 1) { /* of unit length */
                sgt_model square = dot_product(out->d, out->d);
                sgt_model_root(&square, &square), sgt_model_inverse(&square, &square),
                    scaled_of(out->d, &square, out->d);
            }
        }
        sgt_box_trace(&lens, &to, r->kept[variant] + i, at ? at + i : NULL, &out->end);
        out->end.element += i;
        if (out->end.verdict != SGT_BOX_PASSED) return out->end.verdict;
        sgt_model_sum(&out->whole, &out->end.opl, &out->whole);
        if (i + 1 == count) break;
        memcpy(to.o, out->end.p, sizeof to.o), memcpy(to.d, out->end.d, sizeof to.d);
        mend_direction(to.d);
        moved_of(&e[i].pose, false, to.o), turned_of(&e[i].pose, false, to.d, to.d);
        if (e[i].index == SGT_MIRROR || e[i].index == 0) continue;
        index = e[i].index, index_model = wave && r->medium[i + 1].varies ? &wave->index[i + 1] : NULL;
    }
    memcpy(out->at, out->end.p, sizeof out->at);
    return SGT_BOX_PASSED;
}
