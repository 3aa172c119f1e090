// SPDX-License-Identifier: MIT
/* between.c - bounds for the rays of all fields and wavelengths between those of a lens.
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
 * THE CHIEF RAY is a box of its own, with the sides of field and wavelength, through the centre of the
 * paraxial pupil, whatever items of apertures clip it.  Distances from it are differences of models with the
 * same parameters: what both owe to the field cancels, number by number.  Of path differences (carry.c has
 * the formulas) the centre of the sphere, its radius and the chief ray's path are such models.  With c in
 * place of the true centre c + e, a difference is off by n |e| times
 *
 *     |d - d0| + tan B + tan B0 + (1 / cos B - 1) + (1 / cos B0 - 1),   sin B = h / |R|,
 *
 * at most: a sphere that is moved by e is met e . N / (N . d) later, N its normal, at the angle B from d; and
 * one that is larger by |e| is met |e| / cos B earlier.  So c is the polynomial without its rest.
 *
 * INDICES are those of dispersion.c; what a phase in waves adds goes with the wavelength.
 *
 * BRANCH AND BOUND as in branch.c, but boxes cover the rays and may overlap, for nothing is summed.  Fields
 * and wavelengths are first divided into parts, each with its own budget.  A part knows of others only what
 * sgt_between_look saw before all of them.  So its answer is the same wherever it is worked out.
 *
 * LARGEST LESS SMALLEST path difference is of one field and wavelength.  Fields and wavelengths of a part are
 * divided into NET cells a side.  Of each, the largest bound among the boxes that reach into it, and the
 * largest bound of -w: their sum bounds all of its fields. */
#include "between.h"

#include "dispersion.h"

#include <sagitta/surfaces.h>

#include <stdlib.h>
#include <string.h>

static const double HALF_TURN = 3.141592653589793, WIDER = 1.0625, NEAR = 0.02, SLACK = 0x1p-46;
enum { NET = 8, LEAST_ROUND = 16, ROUND_SHARE = 16, DEEPEST = 24, CHOICES = 3, THIN = 4, THINNEST = 16 };

/* Which bound is too wide: each has its own best way to divide. */
enum { WAY_SPOT, WAY_OPD, WAY_ELEMENT };

typedef struct between_box {
    double lo[SIDES], hi[SIDES];
    size_t patch;
    bool ended, bounded, hopeless; /* no ray passes; bounds are not those of nothing; it cannot be divided */
    signed char divide[CHOICES];
    double high, low;            /* bounds of the path difference and of its negative */
    size_t element;
    sgt_box_why why;
} between_box;

/* ------------------------------------------------------------------------ memory */

typedef struct medium_over { sgt_glass glass; bool varies; } medium_over;

typedef struct at_waves {
    double lo, hi;
    sgt_model um, *index;
    size_t numbers;
    sgt_box_number *number;
    sgt_model *per_wave;
} at_waves;

typedef struct ray_ends { sgt_box_end end; sgt_model p[3], d[3], at[3], opl, whole; } ray_ends;

enum { WAVES_KEPT = 8, VARIANTS = 4 };
typedef struct through_room {
    const between_cell *c;
    sgt_element *own[VARIANTS];  /* the lens, a wider one, and without items: the chief ray's, at um[0] and at
                                    the primary wavelength */
    sgt_box_room *kept[VARIANTS];
    sgt_box_at *at;
    medium_over *medium;           /* [count + 1] */
    at_waves waves[WAVES_KEPT];
    size_t next;
    /* rays of one field at one wavelength */
    sgt_passage *passages;
    sgt_element *open, *traced;
    sgt_phase *phase;
    double *value;
    sgt_field_beam beam;
    prove_cell cell;
    carry_room *rays;
} through_room;

static void *taken(const between_cell *c, size_t count, size_t size)
{
    void *at = sgt_launch_take(c->from, count, size);
    if (at) memset(at, 0, (count ? count : 1) * size);
    return at;
}

static void room_free(through_room *r)
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

static bool is_wide(const between_cell *c) { return c->um[1] > c->um[0]; }

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

static bool room_begin(through_room *r, const between_cell *c)
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
        r->own[1][i].semi_diameter *= WIDER;
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
    if (!room_begin(&r, c)) {
        room_free(&r);
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
    room_free(&r);
    return why;
}

/* The numbers of the lens over a range of wavelengths.  parameter: that of the wavelength.  false: not known.
 */
static bool set_waves(through_room *r, int parameter, double lo, double hi, at_waves **out)
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

/* The lens at one wavelength, for rays. */
static double elements_at(through_room *r, double um)
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

static void add_rest(sgt_model *m, double by) { m->rest = sgt_sum_above(m->rest, by); }

static sgt_model dot_product(const sgt_model a[3], const sgt_model b[3])
{
    sgt_model sum, product;
    sgt_model_product(&a[0], &b[0], &sum);
    for (int k = 1; k < 3; k++)
        sgt_model_product(&a[k], &b[k], &product), sgt_model_sum(&sum, &product, &sum);
    return sum;
}

static void minus_of(const sgt_model a[3], const sgt_model b[3], sgt_model out[3])
{
    for (int k = 0; k < 3; k++) sgt_model_difference(&a[k], &b[k], &out[k]);
}

static void scaled_of(const sgt_model a[3], const sgt_model *by, sgt_model out[3])
{
    for (int k = 0; k < 3; k++) sgt_model_product(&a[k], by, &out[k]);
}

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

/* Which parameter each side is; -1: none, as it has no width.  Those of the field come first: the chief ray
 * has no others. */
static int parameters_of(const between_cell *c, int place[SIDES])
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

/* The field: slopes, or x and y of the object. */
static void field_of(const between_cell *c, const between_box *b, const int place[SIDES], sgt_model out[2])
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

/* Points of a pupil of radius 1 that hold the sector. */
static void pupil_of(const between_box *b, const int place[SIDES], sgt_model out[2])
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

/* The point x, y of the pupil of radius 1, after vignetting, as rays of the field. */
static sgt_box_launch launch_model(const between_cell *c, const sgt_model field[2], const sgt_model pupil[2],
                                int parameters)
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

/* Through one of the lenses of the room, element by element.  Of `ends`: p and opl in front of the last
 * element, d there, all in its frame, `at` where they meet it, and the whole path to there.  wave: NULL, as
 * the lens stands. */
static sgt_box_verdict through_of(through_room *r, int variant, const at_waves *wave,
                                  const sgt_box_launch *launch, size_t count, sgt_box_at at[], ray_ends *out)
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

/* ----------------------------------------------------------------------- the ends */

/* b = v . d and h^2 = v^2 - b^2, as carry.c has it. */
static void foot_model(const sgt_model v[3], const sgt_model d[3], sgt_model *b, sgt_model *h2)
{
    sgt_model V = dot_product(v, v), V2 = V, by, e[3], q[3], q2, less;
    const double sign = v[0].c * d[0].c + v[1].c * d[1].c + v[2].c * d[2].c < 0 ? -1 : 1;
    sgt_model_root(&V, &V), sgt_model_inverse(&V, &by), sgt_model_scaled(&by, sign, &by);
    scaled_of(v, &by, e), minus_of(d, e, q), q2 = dot_product(q, q);
    sgt_model_scaled(&q2, -0.5, &less), sgt_model_product(&V, &less, b), sgt_model_sum(b, &V, b);
    sgt_model_scaled(b, sign, b);
    sgt_model_scaled(&q2, -0.25, &less), sgt_model_plus(&less, 1, &less);
    sgt_model_product(&V2, &q2, h2), sgt_model_product(h2, &less, h2);
}

/* h^2 / (R + sqrt(R^2 - h^2)) */
static sgt_model beyond_foot(const sgt_model *h2, const sgt_model *R, const sgt_model *R2)
{
    sgt_model root, out;
    sgt_model_difference(R2, h2, &root), sgt_model_root(&root, &root);
    if (R->c < 0) sgt_model_scaled(&root, -1, &root);
    sgt_model_sum(&root, R, &root), sgt_model_inverse(&root, &root), sgt_model_product(h2, &root, &out);
    return out;
}

static double size_model(const sgt_model a[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double most = sgt_interval_greatest(sgt_model_range(&a[k]));
        sum += most * most;
    }
    return sqrt(sum) * (1 + SLACK);
}

/* The chief rays of a box. */
typedef struct chief_rays { bool known, own_known; ray_ends primary, own; sgt_box_launch launch; } chief_rays;

/* The path difference in waves; ahead: how much longer the ray's path to its start is, beside the chief
 * ray's. n: the index of the image space. */
static sgt_model range_model(const between_cell *c, const ray_ends *ray, const ray_ends *chief,
                               const sgt_model *ahead, const sgt_model *n, const sgt_model *waves)
{
    const bool afocal = c->from->lens->afocal;
    sgt_model centre[3], v[3], v0[3], w, b, b0, h2, h20, t[3], far;
    double off = 0;
    for (int k = 0; k < 3; k++)
        centre[k] = chief->at[k], off += centre[k].rest * centre[k].rest, centre[k].rest = 0;
    off = sqrt(off) * (1 + SLACK);
    minus_of(ray->p, centre, v), minus_of(chief->p, centre, v0), minus_of(ray->d, chief->d, t);
    sgt_model_difference(&ray->opl, &chief->opl, &w), sgt_model_sum(&w, ahead, &w);
    double shift = size_model(t);
    if (afocal) {
        /* s = v . d0 / d . d0, and of the chief ray v0 . d0; d . d0 = 1 - |d - d0|^2 / 2 */
        sgt_model below = dot_product(t, t);
        sgt_model_scaled(&below, -0.5, &below), sgt_model_plus(&below, 1, &below), add_rest(&below, 0x1p-46);
        sgt_model_inverse(&below, &below);
        b = dot_product(v, chief->d), sgt_model_product(&b, &below, &b), b0 = dot_product(v0, chief->d);
        sgt_model_difference(&b, &b0, &b), sgt_model_scaled(&b, -1, &b);
        /* a plane that is moved by e: e . d0 (1 / d . d0 - 1) */
        shift = sgt_interval_greatest(sgt_model_range(&below)) - 1 + 0x1p-40;
    } else {
        foot_model(v, ray->d, &b, &h2), foot_model(v0, chief->d, &b0, &h20);
        sgt_model_difference(&b0, &b, &b);
        if (isfinite(c->data->exit_pupil)) {
            sgt_model to[3] = {centre[0], centre[1], centre[2]}, R2, R;
            sgt_model_plus(&to[2], -c->data->exit_pupil, &to[2]);
            R2 = dot_product(to, to), sgt_model_root(&R2, &R);
            const sgt_model along = dot_product(to, chief->d);
            const sgt_interval sign = sgt_model_range(&along);
            if (sign.hi < 0) sgt_model_scaled(&R, -1, &R);
            else if (!(sign.lo > 0)) R.rest = HUGE_VAL;
            const sgt_model one = beyond_foot(&h2, &R, &R2), other = beyond_foot(&h20, &R, &R2);
            sgt_model_sum(&b, &one, &b), sgt_model_difference(&b, &other, &b);
            const double least = fmin(fabs(sgt_model_range(&R).lo), fabs(sgt_model_range(&R).hi)) - off;
            const double h[2] = {sqrt(fmax(sgt_model_range(&h2).hi, 0)) + off,
                                 sqrt(fmax(sgt_model_range(&h20).hi, 0)) + off};
            for (int k = 0; k < 2; k++) {
                const double sine = h[k] / least, cosine = sqrt(1 - sine * sine);
                shift += least > 0 && sine < 0.5 ? sine / cosine + 1 / cosine - 1 : HUGE_VAL;
            }
        }
    }
    add_rest(&b, off * shift * (1 + 0x1p-30));
    sgt_model_product(&b, n, &far), sgt_model_sum(&w, &far, &w);
    sgt_model_product(&w, waves, &w);
    return w;
}

/* Of an afocal lens the angles to the chief ray, in milliradians, as sgt_ends_as_angles has them. */
static void angles_of(const ray_ends *ray, const ray_ends *chief, sgt_model *ex, sgt_model *ey)
{
    sgt_model off[3], y[3], x[3], by, ahead, one, other;
    const sgt_model *d = chief->d;
    minus_of(ray->d, d, off);
    y[0] = sgt_model_of(0), y[1] = d[2], sgt_model_scaled(&d[1], -1, &y[2]);
    by = dot_product(y, y), sgt_model_root(&by, &by), sgt_model_inverse(&by, &by), scaled_of(y, &by, y);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        sgt_model_product(&y[i], &d[j], &one), sgt_model_product(&y[j], &d[i], &other);
        sgt_model_difference(&one, &other, &x[k]);
    }
    ahead = dot_product(ray->d, d), sgt_model_inverse(&ahead, &ahead);
    *ex = dot_product(off, x), *ey = dot_product(off, y);
    sgt_model *const both[2] = {ex, ey};
    for (int k = 0; k < 2; k++) {
        sgt_model_product(both[k], &ahead, both[k]);
        const double most = sgt_interval_greatest(sgt_model_range(both[k]));
        add_rest(both[k], most * most * most / 3 * (1 + SLACK) + 0x1p-46); /* |atan q - q| <= |q|^3 / 3 */
        sgt_model_scaled(both[k], 1e3, both[k]);
    }
}

/* How long a side is, in parts of the largest field, of the widest range of colours, of the pupil. */
static double length_of(const between_cell *c, const between_box *b, int side)
{
    const double weight[SIDES] = {1, 1, 0.5 / (is_wide(c) ? c->um[1] - c->um[0] : 1), 1,
                                  2 * HALF_TURN * b->hi[SIDE_RADIUS]};
    return weight[side] * (b->hi[side] - b->lo[side]);
}

static int side_longest(const between_cell *c, const between_box *b, const int place[SIDES])
{
    int side = -1;
    double best = 0;
    for (int s = 0; s < SIDES; s++)
        if (place[s] >= 0 && length_of(c, b, s) > best) best = length_of(c, b, s), side = s;
    return side;
}

/* Which side of the box a quantity depends on most, by what is not linear in it: what is left out is likely
 * to be of that.  Linear terms count less: halving these brings the halves apart.  No box gets very thin. */
static int side_by(const between_cell *c, const between_box *b, const sgt_model *const of[], int count,
                   const int place[SIDES])
{
    const int longest = side_longest(c, b, place);
    double best = -1;
    int side = -1;
    for (int s = 0; s < SIDES; s++) {
        if (place[s] < 0 || THINNEST * length_of(c, b, s) < length_of(c, b, longest)) continue;
        double sum = 0;
        for (int m = 0; m < count; m++) {
            sum += 0.25 * fabs(of[m]->by[place[s]]);
            for (int k = 0; k < SGT_MODEL_PARAMETERS; k++)
                sum += (k == place[s] ? 1 : 0.5) * fabs(of[m]->pair[SGT_MODEL_PAIR(place[s], k)]);
        }
        if (sum > best) best = sum, side = s;
    }
    return side;
}

/* ------------------------------------------------------------------------- bounds */

static double degrees_most(sgt_interval cosine)
{
    const double DEGREES = 57.29577951308233; /* 180 / pi, above it */
    return sgt_product_above(sgt_interval_arc_cosine((sgt_interval){cosine.lo, cosine.lo}).hi, DEGREES);
}

static bool has_rim(const sgt_element *e) { return e->semi_diameter > 0 && e->semi_diameter < 0x1p500; }
static bool has_items(const sgt_element *e) { return e->aperture && e->aperture->count > 0; }

/* As carry.c has it. */
static void limit_elements(const through_room *r, size_t count, int variant, double bound[])
{
    for (size_t i = 0; i < count; i++) {
        const sgt_element *e = &r->c->e[i], *used = &r->own[variant][i];
        double high = sgt_interval_hypotenuse(r->at[i].x, r->at[i].y).hi, inside = HUGE_VAL;
        if (has_rim(e)) {
            high = fmin(high, (used->semi_diameter - r->at[i].margin.lo) * (1 + 0x1p-48));
            high = fmin(high, e->semi_diameter * (1 + 0x1p-40));
            inside = fmax(e->semi_diameter - high - 0x1p-50 * e->semi_diameter, 0);
        }
        if (has_items(e)) inside = used->aperture ? fmin(inside, fmax(r->at[i].items, 0)) : 0;
        bound[prove_at_element(i, Q_INCIDENCE)] = degrees_most(r->at[i].cosine);
        bound[prove_at_element(i, Q_INSIDE)] = has_rim(e) || has_items(e) ? -inside : -HUGE_VAL;
        bound[prove_at_element(i, Q_HEIGHT)] = high;
    }
}

/* What holds of any ray that passes: `reached` elements are met, as r->at says. */
static void limit_nothing(const through_room *r, const chief_rays *chief, size_t reached, double bound[])
{
    const size_t n = r->c->from->lens->count;
    const sgt_element *last = &r->c->e[n - 1];
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) bound[q] = HUGE_VAL;
    if (has_rim(last) && !r->c->from->lens->afocal && chief->known) {
        const double far = last->semi_diameter * (1 + 0x1p-40);
        const sgt_interval x = sgt_model_range(&chief->primary.at[0]),
                           y = sgt_model_range(&chief->primary.at[1]);
        bound[Q_EX] = sgt_sum_above(far, sgt_interval_greatest(x));
        bound[Q_EY] = sgt_sum_above(far, sgt_interval_greatest(y));
        bound[Q_SPOT] = sgt_sum_above(far, sgt_interval_hypotenuse(x, y).hi);
    }
    for (size_t i = 0; i < n; i++) {
        const sgt_element *e = &r->c->e[i];
        bound[prove_at_element(i, Q_INCIDENCE)] = 90;
        bound[prove_at_element(i, Q_INSIDE)] = has_rim(e) || has_items(e) ? 0 : -HUGE_VAL;
        bound[prove_at_element(i, Q_HEIGHT)] = has_rim(e) ? e->semi_diameter * (1 + 0x1p-40) : HUGE_VAL;
    }
    limit_elements(r, reached, 0, bound);
}

/* One root within R, as carry.c has it; d in the frame of the conic. */
static bool root_is_single(const sgt_conic *q, double R, const sgt_model d[3])
{
    const sgt_interval n = sgt_interval_absolute(sgt_model_range(&d[2]));
    const sgt_interval l = sgt_model_range(&d[0]), m = sgt_model_range(&d[1]);
    const sgt_interval cr = sgt_interval_product(sgt_interval_of(fabs(q->c)), sgt_interval_of(R));
    const sgt_interval k1 = sgt_interval_sum(sgt_interval_of(1), sgt_interval_of(q->k));
    const sgt_interval left =
        sgt_interval_difference(sgt_interval_of(1), sgt_interval_product(k1, sgt_interval_square(cr)));
    if (q->c == 0) return true;
    if (!(left.lo > 0) || !(n.lo > 0)) return false;
    const sgt_interval slope = sgt_interval_quotient(cr, sgt_interval_square_root(left));
    return n.lo > sgt_interval_product(slope, sgt_interval_hypotenuse(l, m)).hi;
}

static bool roots_are_same(through_room *r, const at_waves *wave, const sgt_box_launch *launch)
{
    ray_ends w;
    for (size_t i = 0; i < r->c->from->lens->count; i++) {
        const sgt_element *e = &r->c->e[i];
        const double R = sgt_interval_hypotenuse(r->at[i].x, r->at[i].y).hi;
        if (e->surface.ops != &sgt_conic_ops || !has_rim(e) || R < e->semi_diameter * (1 - 0x1p-40)) continue;
        if (through_of(r, 1, wave, launch, i + 1, NULL, &w) != SGT_BOX_PASSED) return false;
        if (!root_is_single(e->surface.self, R, w.d)) return false;
    }
    return true;
}

static double index_at_image(const between_cell *c)
{
    double index = c->before == 0 ? 1 : c->before;
    for (size_t i = 0; i + 1 < c->from->lens->count; i++)
        if (c->e[i].index != SGT_MIRROR && c->e[i].index != 0) index = c->e[i].index;
    return index;
}

/* Does the last element bend nothing? */
static bool front_known(const between_cell *c)
{
    const double index = c->e[c->from->lens->count - 1].index;
    return index == 0 || index == index_at_image(c);
}

static void limit_ends(through_room *r, const at_waves *wave, const chief_rays *chief, const ray_ends *ray,
                       const sgt_box_launch *launch, const int place[SIDES], between_box *b, double bound[])
{
    const between_cell *c = r->c;
    const sgt_lens *lens = c->from->lens;
    for (size_t q = 0; q < Q_OF_ELEMENTS; q++) bound[q] = HUGE_VAL;
    b->high = b->low = HUGE_VAL;
    if (chief->known && (!lens->afocal || front_known(c))) {
        sgt_model ex, ey, xx, yy;
        if (lens->afocal) angles_of(ray, &chief->primary, &ex, &ey);
        else {
            sgt_model_difference(&ray->at[0], &chief->primary.at[0], &ex);
            sgt_model_difference(&ray->at[1], &chief->primary.at[1], &ey);
        }
        sgt_model_product(&ex, &ex, &xx), sgt_model_product(&ey, &ey, &yy);
        sgt_model_sum(&xx, &yy, &xx);
        const sgt_interval x = sgt_model_range(&ex), y = sgt_model_range(&ey);
        const sgt_interval f = sgt_interval_intersection(
            sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y)), sgt_model_range(&xx));
        bound[Q_EX] = sgt_interval_greatest(x), bound[Q_EY] = sgt_interval_greatest(y);
        bound[Q_SPOT] = sgt_square_root_above(f.hi);
        b->divide[WAY_SPOT] = (signed char)side_by(c, b, (const sgt_model *const[]){&ex, &ey}, 2, place);
    }
    if (chief->own_known && front_known(c) && c->unit > 0 && c->um[0] > 0) {
        sgt_model ahead = sgt_model_of(0), n = sgt_model_of(index_at_image(c)), waves;
        if (wave) {
            const sgt_model *index = r->medium[0].varies ? &wave->index[0] : NULL;
            for (size_t i = 0; i + 1 < lens->count; i++)
                if (c->e[i].index != SGT_MIRROR) index = r->medium[i + 1].varies ? &wave->index[i + 1] : NULL;
            if (index) n = *index;
            waves = wave->um;
            sgt_model_inverse(&waves, &waves), sgt_model_scaled(&waves, c->unit, &waves);
        } else {
            waves = sgt_model_of(c->unit / c->um[0]);
            add_rest(&waves, SLACK * waves.c);
        }
        if (!c->beam.finite && c->beam.cone == 0) {
            sgt_model d[3] = {launch->d[0], launch->d[1], launch->d[2]}, by = dot_product(d, d), off[3];
            minus_of(launch->o, chief->launch.o, off);
            sgt_model_root(&by, &by), sgt_model_inverse(&by, &by);
            ahead = dot_product(off, d), sgt_model_product(&ahead, &by, &ahead);
            if (wave && r->medium[0].varies) sgt_model_product(&ahead, &wave->index[0], &ahead);
            else if (c->before != 0) sgt_model_scaled(&ahead, c->before, &ahead);
        }
        const sgt_model w = range_model(c, ray, &chief->own, &ahead, &n, &waves);
        const sgt_interval range = sgt_model_range(&w);
        b->high = range.hi, b->low = -range.lo;
        b->divide[WAY_OPD] = (signed char)side_by(c, b, (const sgt_model *const[]){&w}, 1, place);
    }
}

static void carry(through_room *r, between_box *b, double bound[])
{
    const between_cell *c = r->c;
    const size_t n = c->from->lens->count;
    int place[SIDES];
    const int fields = parameters_of(c, place);
    at_waves *wave = NULL;
    chief_rays chief = {.known = false};
    sgt_model field[2], pupil[2], centre[2] = {sgt_model_of(0), sgt_model_of(0)};
    ray_ends w;
    b->ended = b->bounded = b->hopeless = false, b->high = b->low = HUGE_VAL, b->why = SGT_BOX_NOTHING;
    for (int k = 0; k < CHOICES; k++) b->divide[k] = (signed char)side_longest(c, b, place);
    if (is_wide(c) && !set_waves(r, place[SIDE_WAVE], b->lo[SIDE_WAVE], b->hi[SIDE_WAVE], &wave)) {
        limit_nothing(r, &chief, 0, bound);
        for (int k = 0; k < CHOICES; k++) b->divide[k] = SIDE_WAVE;
        return;
    }
    field_of(c, b, place, field), pupil_of(b, place, pupil);
    const sgt_box_launch launch = launch_model(c, field, pupil, fields + 2);
    chief.launch = launch_model(c, field, centre, fields > 0 ? fields : 1);
    if (through_of(r, 0, wave, &launch, n, r->at, &w) == SGT_BOX_STOPPED) {
        b->ended = true;
        return;
    }
    chief.known = through_of(r, 3, NULL, &chief.launch, n, NULL, &chief.primary) == SGT_BOX_PASSED;
    if (!wave && c->um[0] == c->primary) chief.own_known = chief.known, chief.own = chief.primary;
    else chief.own_known = through_of(r, 2, wave, &chief.launch, n, NULL, &chief.own) == SGT_BOX_PASSED;
    if (w.end.verdict == SGT_BOX_PASSED) {
        b->bounded = true;
        limit_ends(r, wave, &chief, &w, &launch, place, b, bound), limit_elements(r, n, 0, bound);
        return;
    }
    b->why = w.end.why, b->element = w.end.element;
    b->hopeless = w.end.divide < 0;
    limit_nothing(r, &chief, w.end.element, bound);
    /* the side that the answer depends on most; but a box that is thin there is wide elsewhere */
    for (int s = 0; s < SIDES && !b->hopeless; s++)
        for (int k = 0; k < CHOICES; k++)
            if (place[s] == w.end.divide && THIN * length_of(c, b, s) > length_of(c, b, b->divide[k]))
                b->divide[k] = (signed char)s;
    if (b->hopeless || w.end.why != SGT_BOX_AT_EDGE) return;
    if (through_of(r, 1, wave, &launch, n, r->at, &w) != SGT_BOX_PASSED || !roots_are_same(r, wave, &launch))
        return;
    b->bounded = true;
    limit_ends(r, wave, &chief, &w, &launch, place, b, bound), limit_elements(r, n, 1, bound);
}

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

/* The rays of a field and wavelength from now on. */
static void aim_at_field(through_room *r, size_t patch, const double s[SIDES])
{
    const between_cell *c = r->c;
    const sgt_vec2 f = field_at(c, patch, s);
    const double um = s[SIDE_WAVE];
    prove_cell *to = &r->cell;
    r->beam = c->beam;
    sgt_beam_point(c->from, &r->beam, f.x, f.y);
    const sgt_ray_end primary = chief_at(r, c->e_primary, c->before_primary);
    to->has_reference = primary.fate == SGT_PASSED, to->reference = to->afocal ? primary.d : primary.p;
    to->before = elements_at(r, um), to->e = r->traced;
    const sgt_ray_end own = chief_at(r, r->traced, to->before);
    to->has_opd =
        c->unit > 0 && um > 0 && front_known(c) &&
        c->reference(c->from->lens, c->data, r->traced, to->before, &own, to->afocal, &to->about, NULL);
    to->waves = c->unit / um;
}

static bool ray_at(through_room *r, const double s[SIDES])
{
    const sgt_vec2 p = pupil_at(s);
    return sgt_carry_ray(&r->cell, r->rays, p.x, p.y, r->value) == SGT_PASSED;
}

static void note_ray(const through_room *r, size_t patch, const double s[SIDES], between_seen seen[])
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
    aim_at_field(r, patch, s);
    for (size_t i = 0; i < PUPIL_SEEN; i++) {
        pupil_point(i, s);
        if (!ray_at(r, s)) continue;
        ++*passed;
        note_ray(r, patch, s, seen);
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
                aim_at_field(r, best->patch, s);
                if (ray_at(r, s) && r->value[q] > best->value)
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
    bool fine = net->seen && room_begin(&r, c);
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
    room_free(&r);
    return fine;
}

void sgt_between_forget(const between_asked *asked, between_net *net)
{
    sgt_launch_forget(asked->cell->from, net->seen);
    net->seen = NULL;
}

/* ----------------------------------------------------------------- branch and bound */

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
        s->wanted[q] = seen + fmax(NEAR * size, least);
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
    carry(&s->r, b, bound);
    s->carried++;
}

/* The middle ray of a box. */
static void see_box(part_search *s, const between_box *b)
{
    double at[SIDES];
    if (b->ended) return;
    for (int k = 0; k < SIDES; k++) at[k] = (b->lo[k] + b->hi[k]) / 2;
    if (b->hi[SIDE_RADIUS] == 1) at[SIDE_RADIUS] = 1;
    aim_at_field(&s->r, b->patch, at);
    if (ray_at(&s->r, at)) s->passed = true, note_ray(&s->r, b->patch, at, s->seen);
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
    bool fine = s->wanted && room_begin(&s->r, c) && grow_boxes(s, QUARTERS), spent = false;
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
    if (s->r.c) room_free(&s->r);
    sgt_launch_forget(c->from, s->wanted), sgt_launch_forget(c->from, s->box),
        sgt_launch_forget(c->from, s->bound);
    sgt_launch_forget(c->from, s);
    return fine;
}
