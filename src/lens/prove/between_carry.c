// SPDX-License-Identifier: MIT
/* between_carry.c - what the rays of a box show at the elements and in the image.
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
 * one that is larger by |e| is met |e| / cos B earlier.  So c is the polynomial without its rest. */
#include "between_box.h"

#include <sagitta/surfaces.h>

enum { THIN = 4, THINNEST = 16 };

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
        if (sgt_between_through(r, 1, wave, launch, i + 1, NULL, &w) != SGT_BOX_PASSED) return false;
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

bool sgt_between_front_known(const between_cell *c)
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
    if (chief->known && (!lens->afocal || sgt_between_front_known(c))) {
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
    if (chief->own_known && sgt_between_front_known(c) && c->unit > 0 && c->um[0] > 0) {
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

void sgt_between_carry(through_room *r, between_box *b, double bound[])
{
    const between_cell *c = r->c;
    const size_t n = c->from->lens->count;
    int place[SIDES];
    const int fields = sgt_between_parameters(c, place);
    at_waves *wave = NULL;
    chief_rays chief = {.known = false};
    sgt_model field[2], pupil[2], centre[2] = {sgt_model_of(0), sgt_model_of(0)};
    ray_ends w;
    b->ended = b->bounded = b->hopeless = false, b->high = b->low = HUGE_VAL, b->why = SGT_BOX_NOTHING;
    for (int k = 0; k < CHOICES; k++) b->divide[k] = (signed char)side_longest(c, b, place);
    if (is_wide(c) && !sgt_between_waves(r, place[SIDE_WAVE], b->lo[SIDE_WAVE], b->hi[SIDE_WAVE], &wave)) {
        limit_nothing(r, &chief, 0, bound);
        for (int k = 0; k < CHOICES; k++) b->divide[k] = SIDE_WAVE;
        return;
    }
    sgt_between_field_model(c, b, place, field), sgt_between_pupil_model(b, place, pupil);
    const sgt_box_launch launch = sgt_between_launch(c, field, pupil, fields + 2);
    chief.launch = sgt_between_launch(c, field, centre, fields > 0 ? fields : 1);
    if (sgt_between_through(r, 0, wave, &launch, n, r->at, &w) == SGT_BOX_STOPPED) {
        b->ended = true;
        return;
    }
    chief.known = sgt_between_through(r, 3, NULL, &chief.launch, n, NULL, &chief.primary) == SGT_BOX_PASSED;
    if (!wave && c->um[0] == c->primary) chief.own_known = chief.known, chief.own = chief.primary;
    else
        chief.own_known =
            sgt_between_through(r, 2, wave, &chief.launch, n, NULL, &chief.own) == SGT_BOX_PASSED;
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
    if (sgt_between_through(r, 1, wave, &launch, n, r->at, &w) != SGT_BOX_PASSED ||
        !roots_are_same(r, wave, &launch))
        return;
    b->bounded = true;
    limit_ends(r, wave, &chief, &w, &launch, place, b, bound), limit_elements(r, n, 1, bound);
}
