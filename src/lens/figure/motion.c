// SPDX-License-Identifier: MIT
/* motion.c - how the numbers of a lens move with one number of its file.
 *
 * DIFFERENCES OF THE READER.  The lens is made anew, by the reader, at x - h and x + h, and its numbers v are
 * listed.  Most numbers of a file move all of them linearly: if v(h) + v(-h) = 2 v(0) to rounding, their
 * difference is the derivative.  (What is odd and not linear, a sine, has a cosine beside it.)  Else x - 2 h
 * and x + 2 h are taken as well; with the odd differences d(k) = v(k h) - v(-k h)
 *
 *     D2 = d(1) / (2 h),    D4 = (8 d(1) - d(2)) / (12 h),    off by h^4 / 30 times the fifth derivative
 *
 * (Fornberg 1988, Math. Comp. 51, 699).  No ray is traced, so this costs less than the rays of a spot; and
 * whatever the reader knows (breaks and their order, the dispersion of a glass, the pupil of an f-number) is
 * in it, without a second description of it that might differ.
 *
 * THE STEP is a power of two, some 2^-11 of x: x + k h is mostly exact, and so is all that is linear.
 * Lengths and angles that are small or 0 have the scale of the lens, or a radian.  Where focal length or
 * pupil change by more than 2^-8 from x - h to x + h, or the reader refuses a point, h is made less.  So D4
 * is off by some 4 (2^-11)^4 = 2^-42, and by the rounding 2^-53 2^11 of a number that x sets alone.
 *
 * A RADIUS is taken by its reciprocal, in which nearly everything is linear: d/dR = -1/R^2 d/d(1/R).
 *
 * THE ERROR.  If the terms of the series fall by the factor q from one to the next, D2 is off by q of the
 * derivative, and D4 by q^2.  Four times that is told, and the rounding of the numbers. */
#include "figure.h"

#include <stdio.h>
#include <string.h>

enum { POINTS = 2, TRIES = 5, SMALLER = 4, STEP = 11 };
enum { BEAM_RADIUS = 7, BEAM_WAVE = 9 }; /* places of numbers in a beam's row */
static const double ROUNDING = 0x1p-53, TOO_FAR = 0x1p-8, RADIAN = 57.29577951308232;

static bool refuses(sgt_error *error, const char *path, const char *why)
{
    *error = (sgt_error){.line = 0};
    snprintf(error->key, sizeof error->key, "%s", path);
    snprintf(error->words, sizeof error->words, "%s", why);
    return false;
}

/* The last key of a path, and its length; a name in brackets may have points. */
static size_t last_key(const char *path, const char **key)
{
    bool inside = false;
    *key = path;
    for (const char *at = path; *at; at++) {
        if (*at == '[' || *at == ']')
            inside = *at == '[';
        else if (*at == '.' && !inside)
            *key = at + 1;
    }
    return strcspn(*key, "[");
}

static bool key_is(const char *path, const char *word)
{
    const char *key;
    return last_key(path, &key) == strlen(word) && memcmp(key, word, strlen(word)) == 0;
}

static bool is_radius(const char *path)
{
    const char *key;
    return last_key(path, &key) >= 6 && memcmp(key, "radius", 6) == 0 && !strstr(path, "apertures");
}

/* How large x is, seen from what it does. */
static double scale_of(const sgt_lens *lens, const char *path, double x)
{
    static const char *const lengths[] = {"thickness", "decenter", "origin", "distance"};
    double size = 0, scale = fabs(x);
    for (size_t i = 0; i < lens->count; i++) size = fmax(size, length3(lens->element[i].pose.origin));
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        if (key_is(path, lengths[i])) scale = fmax(scale, size);
    if (key_is(path, "tilt") || key_is(path, "angle")) scale = fmax(scale, RADIAN);
    if (key_is(path, "conic")) scale = fmax(scale, 1);
    if (key_is(path, "fields")) scale = fmax(scale, lens->field_kind == SGT_FIELD_ANGLE ? RADIAN : size / 16);
    return scale > 0 ? scale : 1;
}

/* What is asked: by number m. */
typedef struct asking { const moved_lens *lens; size_t m; bool inverse; } asking;

/* Looks at the lens with `to` in place of its number m. */
static bool look_with(const asking *a, double to, look_of_lens *l, sgt_error *error)
{
    const moved_lens *of = a->lens;
    layout same = *of->at;
    const double x = of->wanted[a->m];
    *l = (look_of_lens){.study = NULL};
    of->wanted[a->m] = to;
    const bool put = of->of->put(of->of->context, of->copy, of->has, of->wanted, error);
    if (put) memcpy(of->has, of->wanted, of->of->count * sizeof *of->has);
    of->wanted[a->m] = x;
    if (!put || !sgt_look_begin(l, of->copy, of->how, false, error)) return false;
    return sgt_look_list(l, &same, false) ||
           refuses(error, of->of->path[a->m], "it changes what there is, not how much");
}

/* Does the focal length, or the size of a pupil, change too much over the stencil? */
static bool too_far(const layout *at, const double low[], const double high[])
{
    for (size_t i = at->beams; i < at->ideal; i++) {
        const bool radius = i < at->stop && (i - at->beams) % BEAM_NUMBERS == BEAM_RADIUS;
        const bool efl = i >= at->first && (i - at->first) % FIRST_NUMBERS == 0;
        if (!radius && !efl) continue;
        if (fabs(high[i] - low[i]) > TOO_FAR * fmin(fabs(high[i]), fabs(low[i]))) return true;
    }
    return false;
}

/* A stencil; lines: the two points next to x alone are there, and are enough. */
typedef struct stencil {
    look_of_lens at[2 * POINTS];
    bool lines;
    double h;
} stencil;

/* Number i at x + k h. */
static double listed_at(const stencil *s, int k, size_t i)
{
    return s->at[k < 0 ? k + POINTS : k + POINTS - 1].number[i];
}

static void differ(const stencil *s, size_t i, double *by, double *error)
{
    const double most = fmax(fabs(listed_at(s, 1, i)), fabs(listed_at(s, -1, i)));
    const double first = listed_at(s, 1, i) - listed_at(s, -1, i);
    const double second = s->lines ? 2 * first : listed_at(s, 2, i) - listed_at(s, -2, i);
    *by = *error = 0;
    if ((first == 0 && second == 0) || isnan(most)) return;
    const double lower = first / (2 * s->h), higher = (8 * first - second) / (12 * s->h);
    const double q = fmin(fabs(higher - lower), fabs(higher)) / fabs(higher);
    *by = s->lines ? lower : higher;
    *error = (s->lines || higher == 0 ? 0 : 4 * q * q * fabs(higher)) + 2 * ROUNDING * most / s->h;
}

/* Do all numbers that matter lie on lines? */
static bool on_lines(const stencil *s, const looking *how, const layout *at, const look_of_lens *now)
{
    const size_t end = how->first ? at->fixed : at->first;
    for (size_t i = 0; i < end; i++) {
        const double above = listed_at(s, 1, i), below = listed_at(s, -1, i), here = now->number[i];
        const bool front = i >= at->beams && i < at->stop && (i - at->beams) % BEAM_NUMBERS == BEAM_WAVE;
        if (!front && fabs(above + below - 2 * here) > 4 * ROUNDING * (fabs(above) + fabs(below)))
            return false;
    }
    return true;
}

/* Do first-order data end beside x?  Of a lens with coma on a surface, say: its vertex has a slope. */
static bool is_lost(const stencil *s, const layout *at, const look_of_lens *now)
{
    for (size_t i = at->first; i < at->ideal; i++)
        if (!isnan(now->number[i]) && isnan(listed_at(s, 1, i) + listed_at(s, -1, i))) return true;
    return false;
}

/* The turn of each element about its own axes: of a rotation R, with the axes as columns, dR = R [w]. */
static void find_turns(const sgt_lens *lens, const layout *at, const look_of_lens *now, motion *m)
{
    for (size_t i = 0; i < lens->count; i++) {
        const size_t axes = at->axes + i * AXES;
        const double *e = now->number + axes, *de = m->by + axes, *off = m->error + axes;
        double w[3], off_w[3];
        for (int k = 0; k < 3; k++) { /* w.x = ez . dey, and so on */
            const int j = (k + 1) % 3, l = (k + 2) % 3;
            w[k] = off_w[k] = 0;
            for (int c = 0; c < 3; c++) {
                w[k] += e[3 * l + c] * de[3 * j + c];
                off_w[k] += fabs(e[3 * l + c]) * off[3 * j + c];
            }
        }
        for (size_t s = 0; s < at->slots; s++) {
            const band *b = sgt_look_slot(now, s);
            const size_t turn = s * at->trace + sgt_trace_parameters(i + 1, b->element) - 4;
            for (int k = 0; k < 3; k++) m->by[turn + (size_t)k] = w[k], m->error[turn + (size_t)k] = off_w[k];
        }
    }
}

static bool all_zero(const double x[], size_t from, size_t to)
{
    while (from < to && x[from] == 0) from++;
    return from == to;
}

/* Looks at x - k h and x + k h, of x or of 1/x. */
static bool look_beside(const asking *a, double x, int k, stencil *s, sgt_error *error)
{
    for (int side = -1; side <= 1; side += 2) {
        const double to = (a->inverse ? 1 / x : x) + side * k * s->h;
        look_of_lens *l = &s->at[side < 0 ? POINTS - k : POINTS - 1 + k];
        if (!look_with(a, a->inverse ? 1 / to : to, l, error)) return false;
    }
    return true;
}

static void end_stencil(stencil *s)
{
    for (int k = 0; k < 2 * POINTS; k++) sgt_look_end(&s->at[k]);
}

bool sgt_motion_of(const moved_lens *l, size_t m, motion *out, sgt_error *error)
{
    const lens_numbers *of = l->of;
    const looking *how = l->how;
    const layout *at = l->at;
    const look_of_lens *now = l->now;
    const char *path = of->path[m];
    const double x = l->wanted[m];
    const bool inverse = !of->step && is_radius(path);
    const asking a = {l, m, inverse};
    stencil s = {.lines = false};
    sgt_error first = {.line = 0}, unread;
    if (!isfinite(x))
        return refuses(error, path,
                       inverse ? "no derivative by an infinite radius; take its curvature"
                               : "no derivative by an infinite number");
    const double scale = inverse ? 1 / fabs(x) : scale_of(l->copy, path, x);
    s.h = of->step ? of->step[m] : ldexp(1, ilogb(scale) - STEP);
    bool fine = false;
    for (int i = 0; i < TRIES && !fine; i++) {
        sgt_error *told = i == 0 ? &first : &unread;
        fine = look_beside(&a, x, 1, &s, told);
        fine = fine && (i + 1 == TRIES || !too_far(at, s.at[POINTS - 1].number, s.at[POINTS].number));
        s.lines = fine && on_lines(&s, how, at, now);
        fine = fine && (s.lines || look_beside(&a, x, 2, &s, told));
        if (fine) break;
        end_stencil(&s);
        s.h = ldexp(s.h, -SMALLER);
    }
    const bool lost = fine && (how->path || how->first) && is_lost(&s, at, now);
    const double by_x = inverse ? -1 / (x * x) : 1;
    for (size_t i = 0; i < at->end && fine; i++) {
        differ(&s, i, &out->by[i], &out->error[i]);
        out->by[i] *= by_x, out->error[i] *= fabs(by_x);
    }
    end_stencil(&s);
    if (!fine) {
        *error = first;
        if (!*first.words) refuses(error, path, "no derivative: the lens changes too much about it");
        snprintf(error->key, sizeof error->key, "%s", path);
        return false;
    }
    if (lost) return refuses(error, path, "no derivative: there is no exit pupil or focal length beside it");
    find_turns(l->copy, at, now, out);
    /* where a wavefront begins is the same for all rays of a field: it may jump, and has no say */
    for (size_t i = at->beams + BEAM_WAVE; i < at->stop; i += BEAM_NUMBERS) out->by[i] = out->error[i] = 0;
    out->beams = !all_zero(out->by, at->beams, at->first);
    if (!all_zero(out->by, at->fixed, at->weights))
        return refuses(error, path, "no derivative: it is no parameter of its surface or phase");
    if (!all_zero(out->by, at->weights, at->end - at->slots))
        return refuses(error, path, "no derivative: weights are held fixed");
    if (how->path && !all_zero(out->by, at->end - at->slots, at->end))
        return refuses(error, path, "no derivative of waves by a wavelength");
    return true;
}
