// SPDX-License-Identifier: MIT
/* wide.c - a ray through the lenses of a box of many parameters.
 *
 * AN ELEMENT is met by a line of four numbers x, y, u, v, and has few numbers of its own that vary: curvature
 * and indices.  Each of these is a wide number w.  With s = (w - c) / h, h its spread, which is from -1 to 1
 * in every lens of the box, they are the parameters of a box of beam.h with one element.  That answers with
 * models of second order in these s and a rest, for every s there is.  Each s is put in as the wide number it
 * is; second powers are from 0 to 1, products from -1 to 1.  So the parameters of the lens may be many, and
 * each box has eight or fewer.
 *
 * A SHAPE that is off adds to the sag s of a conic some d(x, y) = sum of a[k] Z[k].  Where a ray meets that
 * surface at Q, it also meets the conic that is moved by d(Q) along z.  In turn, let the conic be moved by
 * any w in [-W, W], W >= |d| at all points x, y where rays meet these: the point depends on w continuously,
 * so for some w it is w = d there, and that is a Q.  There is no other within the aperture if the ray is
 * steeper than the surface is anywhere in it: then z - s - d is monotone along the ray.  So Q is where the
 * conic is met that is moved by w = d(Q), a number of the size of d where rays meet it: first all w are
 * tried, then these.  The normal there is (-s_x - d_x, -s_y - d_y, 1), and the ray is bent by it:
 *
 *     d' = r d + (sqrt(1 - r^2 (1 - k^2)) - r k) n,  k = d . n, n of unit length,  r = n1 / n2,
 *
 * with the sign of k for that of the root, and d - 2 k n of a mirror.  A mirror of the shape alone, met along
 * its axis, sends light to d' = (2 Z_x, 2 Z_y, -1 + ...): with 1 - d'_z = 2 / (1 + slope^2),
 * Z_x = d'_x / (1 - d'_z).  So beam.h tells of slopes, too.
 *
 * APERTURES.  A box that is cut at the edge is carried through a wider aperture, as in carry.c. */
#include "wide.h"

#include <sagitta/surfaces.h>

#include <math.h>
#include <string.h>

static const double WIDE_GRAIN = 0x1p-44, WIDER_APERTURE = 1.0625;

void sgt_wide_of(double x, wide *out) { *out = (wide){.c = x}; }

void sgt_wide_between(sgt_interval x, wide *out)
{
    const double c = x.lo / 2 + x.hi / 2;
    *out = (wide){.c = c, .rest = fmax(x.hi - c, c - x.lo) * (1 + 0x1p-50) + 0x1p-1000};
    if (!(x.hi - x.lo < HUGE_VAL)) out->c = 0, out->rest = HUGE_VAL;
}

double sgt_wide_spread(const wide *x)
{
    double sum = x->rest;
    for (int i = 0; i < WIDE; i++) sum += fabs(x->by[i]);
    return sum * (1 + WIDE_GRAIN);
}

double sgt_wide_size(const wide *x) { return (fabs(x->c) + sgt_wide_spread(x)) * (1 + WIDE_GRAIN); }

sgt_interval sgt_wide_range(const wide *x)
{
    const double far = sgt_wide_spread(x) + WIDE_GRAIN * fabs(x->c);
    if (!(far < HUGE_VAL)) return (sgt_interval){-HUGE_VAL, HUGE_VAL};
    return (sgt_interval){x->c - far, x->c + far};
}

void sgt_wide_rest(wide *x, double more)
{
    x->rest = (x->rest + more) * (1 + 0x1p-50);
    if (isnan(x->rest + x->c)) x->rest = HUGE_VAL, x->c = 0;
}

void sgt_wide_plus(const wide *x, double k, wide *out)
{
    const double grain = WIDE_GRAIN * (sgt_wide_size(x) + fabs(k));
    *out = *x, out->c += k;
    sgt_wide_rest(out, grain);
}

void sgt_wide_scaled(const wide *x, double k, wide *out)
{
    const double grain = WIDE_GRAIN * sgt_wide_size(x) * fabs(k);
    out->c = x->c * k, out->rest = x->rest * fabs(k);
    for (int i = 0; i < WIDE; i++) out->by[i] = x->by[i] * k;
    sgt_wide_rest(out, grain);
}

void sgt_wide_added(const wide *x, double k, const wide *y, wide *out)
{
    const double grain = WIDE_GRAIN * (sgt_wide_size(x) + sgt_wide_size(y) * fabs(k));
    out->c = x->c + k * y->c, out->rest = x->rest + fabs(k) * y->rest;
    for (int i = 0; i < WIDE; i++) out->by[i] = x->by[i] + k * y->by[i];
    sgt_wide_rest(out, grain);
}

/* (sum of x_i s_i) (sum of y_i s_i): its squares are from 0 to 1, and its products from -1 to 1. */
void sgt_wide_product(const wide *x, const wide *y, wide *out)
{
    const double dx = sgt_wide_spread(x), dy = sgt_wide_spread(y), a = x->c, b = y->c;
    const double grain = WIDE_GRAIN * (fabs(a) + dx) * (fabs(b) + dy);
    double rest = fabs(a) * y->rest + fabs(b) * x->rest, middle = 0;
    if (dx > 0 && dy > 0) {
        int used[WIDE], count = 0;
        for (int i = 0; i < WIDE; i++)
            if (x->by[i] != 0 || y->by[i] != 0) used[count++] = i;
        for (int k = 0; k < count; k++) {
            const double xi = x->by[used[k]], yi = y->by[used[k]], half = xi * yi / 2;
            middle += half, rest += fabs(half);
            for (int j = 0; j < k; j++) rest += fabs(xi * y->by[used[j]] + yi * x->by[used[j]]);
        }
        rest += x->rest * dy + y->rest * dx;
    }
    for (int i = 0; i < WIDE; i++) out->by[i] = a * y->by[i] + b * x->by[i];
    out->c = a * b + middle, out->rest = rest;
    sgt_wide_rest(out, grain);
}

/* 1 / x = 1 / c - (x - c) / c^2 + (x - c)^2 / (c^2 x) */
void sgt_wide_inverse(const wide *x, wide *out)
{
    const double d = sgt_wide_spread(x), c = x->c, least = (fabs(c) - d) * (1 - WIDE_GRAIN);
    if (!(least > 0) || !(d < HUGE_VAL)) {
        *out = (wide){.rest = HUGE_VAL};
        return;
    }
    const double k = -1 / (c * c), rest = x->rest / (c * c) + d / least * d / (c * c);
    for (int i = 0; i < WIDE; i++) out->by[i] = k * x->by[i];
    out->c = 1 / c, out->rest = rest;
    sgt_wide_rest(out, WIDE_GRAIN * (1 / least + rest));
}

/* By Taylor's theorem, the second derivative at most 1. */
void sgt_wide_turn(const wide *angle, wide *cosine, wide *sine)
{
    const double d = sgt_wide_spread(angle), c = cos(angle->c), s = sin(angle->c);
    const wide from = *angle;
    sgt_wide_scaled(&from, -s, cosine), sgt_wide_scaled(&from, c, sine);
    cosine->c = c, sine->c = s;
    sgt_wide_rest(cosine, d * d / 2 + WIDE_GRAIN), sgt_wide_rest(sine, d * d / 2 + WIDE_GRAIN);
}

/* -------------------------------------------------------------------------- frames */

static void wide_dot(const wide row[3], const wide *const p[3], const wide *o, wide *out)
{
    wide sum = *o, product;
    for (int k = 0; k < 3; k++) {
        if (row[k].c == 0 && sgt_wide_spread(&row[k]) == 0) continue;
        sgt_wide_product(&row[k], p[k], &product);
        sgt_wide_added(&sum, 1, &product, &sum);
    }
    *out = sum;
}

bool sgt_wide_moved(const wide_motion *by, wide_line *line)
{
    static const wide zero = {.c = 0}, one = {.c = 1};
    wide p[3], d[3], inverse, product;
    const wide *const point[3] = {&line->x, &line->y, &zero}, *const ahead[3] = {&line->u, &line->v, &one};
    if (!by->turns) {
        for (int k = 0; k < 3; k++) sgt_wide_added(&by->o[k], 1, point[k], &p[k]);
        d[0] = line->u, d[1] = line->v;
    } else {
        for (int k = 0; k < 3; k++) {
            wide_dot(by->M[k], point, &by->o[k], &p[k]);
            wide_dot(by->M[k], ahead, &zero, &d[k]);
        }
        if (d[2].c < 0) line->ahead = -line->ahead;
        sgt_wide_inverse(&d[2], &inverse);
        if (!(inverse.rest < HUGE_VAL)) return false;
        sgt_wide_product(&d[0], &inverse, &d[0]), sgt_wide_product(&d[1], &inverse, &d[1]);
    }
    line->u = d[0], line->v = d[1];
    sgt_wide_product(&p[2], &d[0], &product), sgt_wide_added(&p[0], -1, &product, &line->x);
    sgt_wide_product(&p[2], &d[1], &product), sgt_wide_added(&p[1], -1, &product, &line->y);
    return line->x.rest + line->y.rest < HUGE_VAL;
}

/* ------------------------------------------------------------------------ a small box */

/* Wide numbers as parameters of a box: each has a place, or none is left and it is an interval. */
typedef struct small_box {
    int count;
    const wide *of[SGT_MODEL_PARAMETERS];
    double h[SGT_MODEL_PARAMETERS];
} small_box;

static sgt_model placed_model(small_box *b, const wide *x)
{
    const double spread = sgt_wide_spread(x), size = fabs(x->c) + spread;
    if (spread == 0) return sgt_model_of(x->c);
    if (b->count == SGT_MODEL_PARAMETERS || !(spread < HUGE_VAL)) return sgt_model_between(sgt_wide_range(x));
    const double h = spread * (1 + 0x1p-30) + 0x1p-60 * size + 0x1p-1000;
    sgt_model m = sgt_model_of(x->c);
    m.by[b->count] = h;
    b->h[b->count] = h, b->of[b->count++] = x;
    return m;
}

/* The model with the wide numbers put in. */
static void put_in(const small_box *b, const sgt_model *m, wide *out)
{
    double size = fabs(m->c) + m->rest;
    wide sum = {.c = m->c, .rest = m->rest};
    for (int j = 0; j < b->count; j++) {
        const double k = m->by[j] / b->h[j], square = m->pair[SGT_MODEL_PAIR(j, j)];
        for (int i = 0; i < WIDE; i++) sum.by[i] += k * b->of[j]->by[i];
        sum.rest += fabs(k) * b->of[j]->rest + fabs(square) / 2, sum.c += square / 2;
        size += fabs(m->by[j]) + fabs(square);
        for (int i = 0; i < j; i++) sum.rest += fabs(m->pair[SGT_MODEL_PAIR(i, j)]);
    }
    *out = sum;
    sgt_wide_rest(out, WIDE_GRAIN * (size + sum.rest));
}

static sgt_model times_model(const sgt_model *x, const sgt_model *y)
{
    sgt_model out;
    sgt_model_product(x, y, &out);
    return out;
}

static sgt_model sum_model(const sgt_model *x, double k, const sgt_model *y)
{
    sgt_model out;
    sgt_model_scaled(y, k, &out);
    sgt_model_sum(x, &out, &out);
    return out;
}

static sgt_model dot_models(const sgt_model a[3], const sgt_model b[3])
{
    sgt_model sum = sgt_model_of(0);
    for (int k = 0; k < 3; k++) {
        const sgt_model one = times_model(&a[k], &b[k]);
        sum = sum_model(&sum, 1, &one);
    }
    return sum;
}

static void unit_models(sgt_model d[3])
{
    sgt_model by = dot_models(d, d);
    sgt_model_root(&by, &by), sgt_model_inverse(&by, &by);
    for (int k = 0; k < 3; k++) d[k] = times_model(&d[k], &by);
}

/* ------------------------------------------------------------------------- a shape */

/* The height and the slopes of a shape all over a rectangle; far: it is asked about as far as that.  false:
 * not known. */
static bool shape_over(sgt_surface shape, double far, sgt_interval x, sgt_interval y, sgt_interval out[3])
{
    const sgt_element mirror = {.surface = shape, .semi_diameter = 2 * far, .index = SGT_MIRROR};
    const sgt_box_lens lens = {.elements = 1, .e = &mirror};
    const sgt_box_launch along = {
        .parameters = 2,
        .o = {sgt_model_parameter(0, x), sgt_model_parameter(1, y), sgt_model_of(-1)},
        .d = {sgt_model_of(0), sgt_model_of(0), sgt_model_of(1)}};
    sgt_box_end end;
    if (sgt_box_trace(&lens, &along, NULL, NULL, &end) != SGT_BOX_PASSED) return false;
    sgt_model below;
    sgt_model_scaled(&end.d[2], -1, &below), sgt_model_plus(&below, 1, &below);
    sgt_model_inverse(&below, &below);
    const sgt_model gx = times_model(&end.d[0], &below), gy = times_model(&end.d[1], &below);
    out[0] = sgt_model_range(&end.p[2]), out[1] = sgt_model_range(&gx), out[2] = sgt_model_range(&gy);
    return isfinite(out[0].hi - out[0].lo) && isfinite(out[1].hi - out[1].lo) &&
           isfinite(out[2].hi - out[2].lo);
}

bool sgt_wide_shape(sgt_surface surface, double semi_diameter, wide_shape *out)
{
    enum { PARTS = 8 };
    const double far = semi_diameter * WIDER_APERTURE, step = 2 * far / PARTS, pad = 0x1p-30 * far;
    *out = (wide_shape){.surface = surface};
    if (!(semi_diameter > 0 && semi_diameter < 0x1p500)) return false;
    for (int i = 0; i < PARTS * PARTS; i++) { /* an enclosure of all at once is wide */
        const double x = step * (i % PARTS) - far, y = step * (double)(i / PARTS) - far;
        sgt_interval part[3];
        if (!shape_over(surface, far, (sgt_interval){x - pad, x + step + pad},
                        (sgt_interval){y - pad, y + step + pad}, part))
            return false;
        for (int k = 0; k < 3; k++)
            out->all[k] =
                i ? (sgt_interval){fmin(out->all[k].lo, part[k].lo), fmax(out->all[k].hi, part[k].hi)}
                  : part[k];
        out->steep = fmax(out->steep, sgt_interval_greatest(part[1]) + sgt_interval_greatest(part[2]));
    }
    return true;
}

/* The largest slope of a conic within r, of curvatures c. */
static double steepest(const sgt_conic *q, sgt_interval c, double r)
{
    const double cr = sgt_interval_greatest(c) * r, left = 1 - fmax(1 + q->k, 0) * cr * cr;
    return left > 0x1p-20 ? cr / sqrt(left) * (1 + 0x1p-30) : HUGE_VAL;
}

typedef struct off_shape {
    wide height, gx, gy, ratio;
    double steep;
} off_shape;

/* What is off where it is met in a rectangle; NULL: anywhere. */
static bool off_shape_over(const wide_element *of, const sgt_interval at[2], off_shape *out)
{
    *out = (off_shape){.steep = 0};
    for (size_t k = 0; k < of->shapes; k++) {
        const wide_shape *shape = &of->shape[k];
        sgt_interval z[3] = {shape->all[0], shape->all[1], shape->all[2]};
        wide by, product, *const part[3] = {&out->height, &out->gx, &out->gy};
        if (at && !shape_over(shape->surface, of->e->semi_diameter * WIDER_APERTURE, at[0], at[1], z))
            return false;
        out->steep += shape->steep * sgt_wide_size(&of->amount[k]);
        for (int i = 0; i < 3; i++) {
            sgt_wide_between(z[i], &by), sgt_wide_product(&by, &of->amount[k], &product);
            sgt_wide_added(part[i], 1, &product, part[i]);
        }
    }
    return true;
}

/* Bends d, of unit length, at the normal n, of any length. */
static void bend_models(bool mirror, const sgt_model *ratio, const sgt_model normal[3], sgt_model d[3])
{
    sgt_model n[3] = {normal[0], normal[1], normal[2]};
    unit_models(n);
    const sgt_model k = dot_models(d, n);
    sgt_model by;
    if (mirror) {
        sgt_model_scaled(&k, -2, &by);
    } else {
        sgt_model inside = times_model(&k, &k), r2 = times_model(ratio, ratio);
        sgt_model_plus(&inside, -1, &inside), inside = times_model(&inside, &r2);
        sgt_model_plus(&inside, 1, &inside), sgt_model_root(&inside, &inside);
        sgt_model_scaled(&inside, k.c < 0 ? -1 : 1, &inside);
        const sgt_model along = times_model(ratio, &k);
        by = sum_model(&inside, -1, &along);
        for (int i = 0; i < 3; i++) d[i] = times_model(ratio, &d[i]);
    }
    for (int i = 0; i < 3; i++) {
        const sgt_model turn = times_model(&by, &n[i]);
        d[i] = sum_model(&d[i], 1, &turn);
    }
}

/* ---------------------------------------------------------------------- an element */

/* Rays of directions d meet the conic, anywhere within r, once only: carry.c. */
static bool meet_once(const sgt_element *e, const wide *c, double r, const sgt_model d[3], double more)
{
    const sgt_conic *q = e->surface.self;
    sgt_interval curvature = sgt_interval_of(q->c);
    if (c) curvature = sgt_interval_sum(curvature, sgt_wide_range(c));
    const sgt_interval across = sgt_interval_hypotenuse(sgt_model_range(&d[0]), sgt_model_range(&d[1]));
    const sgt_interval along = sgt_interval_absolute(sgt_model_range(&d[2]));
    return along.lo > (steepest(q, curvature, r) + more) * across.hi * (1 + 0x1p-30);
}

typedef struct through_one {
    const wide_element *of;
    small_box box;
    sgt_box_launch launch;
    sgt_model c, before, behind, ratio, height, gx, gy;
    off_shape off;
} through_one;

static sgt_box_verdict trace_one(through_one *p, sgt_element *e, sgt_box_at *at, sgt_box_end *end)
{
    const wide_element *of = p->of;
    const bool bends = !of->shapes && e->index != SGT_MIRROR && e->index != 0;
    sgt_box_number number[4];
    size_t numbers = 0;
    double before = 1;
    if (of->c) number[numbers++] = (sgt_box_number){.what = SGT_BOX_SURFACE, .value = &p->c};
    if (of->shapes)
        before = 1;
    else if (sgt_wide_spread(of->before) == 0)
        before = of->before->c;
    else
        number[numbers++] =
            (sgt_box_number){.element = SGT_BOX_BEFORE, .what = SGT_BOX_INDEX, .value = &p->before};
    if (bends && sgt_wide_spread(of->behind) == 0)
        e->index = of->behind->c;
    else if (bends)
        number[numbers++] = (sgt_box_number){.what = SGT_BOX_INDEX, .value = &p->behind};
    if (of->shapes)
        number[numbers++] = (sgt_box_number){.what = SGT_BOX_ORIGIN, .which = 2, .value = &p->height};
    const sgt_box_lens lens = {
        .elements = 1, .e = e, .index_before = before, .numbers = numbers, .number = number};
    return sgt_box_trace(&lens, &p->launch, NULL, at, end);
}

/* The box, with what is off of the shape as far as it is known. */
static void set_passing(through_one *p, const wide_line *line)
{
    const wide_element *of = p->of;
    small_box *b = &p->box;
    const sgt_model x = placed_model(b, &line->x), y = placed_model(b, &line->y);
    const sgt_model u = placed_model(b, &line->u), v = placed_model(b, &line->v);
    if (of->c) p->c = placed_model(b, of->c);
    if (of->shapes) {
        /* of the indices their ratio alone counts */
        sgt_wide_inverse(of->behind, &p->off.ratio),
            sgt_wide_product(&p->off.ratio, of->before, &p->off.ratio);
        p->gx = placed_model(b, &p->off.gx), p->gy = placed_model(b, &p->off.gy);
        p->ratio = placed_model(b, &p->off.ratio), p->height = placed_model(b, &p->off.height);
    } else {
        p->behind = placed_model(b, of->behind), p->before = placed_model(b, of->before);
    }
    p->launch = (sgt_box_launch){
        .parameters = b->count ? b->count : 1, .o = {x, y, sgt_model_of(0)}, .d = {u, v, sgt_model_of(1)}};
    for (int k = 0; k < 3; k++) sgt_model_scaled(&p->launch.d[k], line->ahead, &p->launch.d[k]);
}

/* Where rays go behind a shape that is off. */
static void bend_off(through_one *p, sgt_box_end *end)
{
    const sgt_conic *q = p->of->e->surface.self;
    sgt_model c = sgt_model_of(q->c), slope, n[3] = {sgt_model_of(0), sgt_model_of(0), sgt_model_of(1)};
    sgt_model d[3] = {p->launch.d[0], p->launch.d[1], p->launch.d[2]};
    if (p->of->c) sgt_model_plus(&p->c, q->c, &c);
    slope = times_model(&c, &end->p[2]);
    sgt_model_scaled(&slope, -1 - q->k, &slope), slope.rest += 0x1p-50 * fabs(q->k);
    sgt_model_plus(&slope, 1, &slope), sgt_model_inverse(&slope, &slope);
    slope = times_model(&slope, &c);
    for (int k = 0; k < 2; k++) {
        const sgt_model s = times_model(&slope, &end->p[k]);
        n[k] = sum_model(&n[k], -1, &s), n[k] = sum_model(&n[k], -1, k ? &p->gy : &p->gx);
    }
    unit_models(d);
    bend_models(p->of->e->index == SGT_MIRROR, &p->ratio, n, d);
    sgt_model_sum(&end->p[2], &p->height, &end->p[2]); /* from the vertex of the conic that is not moved */
    for (int k = 0; k < 3; k++) end->d[k] = d[k], end->d[k].rest += 0x1p-44;
}

/* Carries it once; the shape is off by p->off. */
static wide_fate carried_once(through_one *p, const wide_line *line, sgt_box_at *at, sgt_box_end *end)
{
    sgt_element own = *p->of->e, wider;
    const double size = own.semi_diameter;
    const bool conic = own.surface.ops == &sgt_conic_ops, round = size > 0 && size < 0x1p500;
    memset(&own.pose, 0, sizeof own.pose);
    if (p->of->shapes) own.index = 0, own.phase = NULL;
    set_passing(p, line);
    const sgt_box_verdict verdict = trace_one(p, &own, at, end);
    if (verdict == SGT_BOX_PASSED) return WIDE_PASSED;
    if (verdict == SGT_BOX_STOPPED) return p->of->shapes ? WIDE_UNKNOWN : WIDE_ENDED;
    if (end->why != SGT_BOX_AT_EDGE) return WIDE_UNKNOWN;
    wider = own, wider.aperture = NULL;
    if (round) wider.semi_diameter *= WIDER_APERTURE;
    if (trace_one(p, &wider, at, end) != SGT_BOX_PASSED) return WIDE_UNKNOWN;
    const double r = sgt_interval_hypotenuse(at->x, at->y).hi;
    if (conic && !meet_once(&own, p->of->c, r, p->launch.d, 0)) return WIDE_UNKNOWN;
    return WIDE_MAYBE;
}

wide_fate sgt_wide_through(const wide_element *of, wide_line *line, wide point[2], sgt_box_why *why)
{
    sgt_box_at at;
    sgt_box_end end;
    through_one p = {.of = of};
    *why = SGT_BOX_NO_BOUNDS;
    if (of->shapes) {
        /* where it is met, whatever is off of the shape */
        through_one first = {.of = of};
        if (of->e->surface.ops != &sgt_conic_ops || of->e->phase) return WIDE_UNKNOWN;
        off_shape_over(of, NULL, &first.off);
        const wide_fate fate = carried_once(&first, line, &at, &end);
        if (fate != WIDE_PASSED && fate != WIDE_MAYBE) return *why = end.why, WIDE_UNKNOWN;
        *why = SGT_BOX_AT_SURFACE;
        const double pad = 0x1p-40 * of->e->semi_diameter;
        const sgt_interval met[2] = {{at.x.lo - pad, at.x.hi + pad}, {at.y.lo - pad, at.y.hi + pad}};
        if (!meet_once(of->e, of->c, of->e->semi_diameter * WIDER_APERTURE, first.launch.d,
                       first.off.steep) ||
            !off_shape_over(of, met, &p.off))
            return WIDE_UNKNOWN;
    }
    const wide_fate fate = carried_once(&p, line, &at, &end);
    if (fate == WIDE_ENDED || fate == WIDE_UNKNOWN) return *why = end.why, fate;
    if (of->shapes) bend_off(&p, &end);
    sgt_model by, u, v;
    sgt_model_inverse(&end.d[2], &by);
    u = times_model(&end.d[0], &by), v = times_model(&end.d[1], &by);
    sgt_model x = times_model(&end.p[2], &u), y = times_model(&end.p[2], &v);
    x = sum_model(&end.p[0], -1, &x), y = sum_model(&end.p[1], -1, &y);
    if (!(x.rest + y.rest < HUGE_VAL)) return *why = SGT_BOX_AT_BENDING, WIDE_UNKNOWN;
    wide_line out = {.ahead = end.d[2].c < 0 ? -1 : 1};
    put_in(&p.box, &end.p[0], &point[0]), put_in(&p.box, &end.p[1], &point[1]);
    put_in(&p.box, &x, &out.x), put_in(&p.box, &y, &out.y);
    put_in(&p.box, &u, &out.u), put_in(&p.box, &v, &out.v);
    *line = out;
    return fate;
}
