/* motion.c - how the numbers of a lens move with one number of its file.
 *
 * DIFFERENCES OF THE READER.  The lens is made anew, by the reader, at x + k h for k = -3 ... 3 without 0, and
 * its numbers are listed.  With the odd differences v(k) - v(-k) the derivative is
 *
 *     D6 = (45 d1 - 9 d2 + d3) / (60 h),      off by 36 / 7! f'''''''(x) h^6,
 *     D4 = (8 d1 - d2) / (12 h),              off by 4 / 5! f'''''(x) h^4
 *
 * (Fornberg 1988, Math. Comp. 51, 699).  No ray is traced, so that seven numbers of a lens cost less than the
 * rays of a spot; and whatever the reader knows (breaks and their order, pickups, the dispersion of a glass,
 * the pupil of an f-number) is in it, without a second description of it that might differ.
 *
 * THE STEP is a power of two, some 2^-11 of x: x + k h is mostly exact, and so is all that is linear.  Lengths
 * and angles that are small or 0 have the scale of the lens, or a radian.  Where focal length or pupil change
 * by more than 2^-5 over the stencil, or the reader refuses a point of it, h is made less.  So the rest of D6
 * is some (2^-6 / 3)^6 = 2^-45, and its rounding 2^-53 2^11 of a number that x sets alone.
 *
 * A RADIUS is taken by its reciprocal, in which nearly everything is linear: d/dR = -1/R^2 d/d(1/R).
 *
 * THE ERROR.  If the terms of the series fall by the factor q from one to the next, D4 is off by q^2 of f', and
 * D6 by q^3.  Four times that is told, and the rounding of the numbers. */
#include "figure.h"

#include <stdio.h>
#include <string.h>

enum { POINTS = 3, TRIES = 5, SMALLER = 4, STEP = 11 };
enum { BEAM_RADIUS = 7, BEAM_WAVE = 9 }; /* places of numbers in a beam's row */
static const double ULP = 0x1p-53, TOO_FAR = 0x1p-5, RADIAN = 57.29577951308232;

static bool refuse(sgt_error *error, const char *path, const char *why)
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
        if (*at == '[' || *at == ']') inside = *at == '[';
        else if (*at == '.' && !inside) *key = at + 1;
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

/* Looks at the lens with `to` at the path. */
static bool look_at(sgt_lens *copy, const char *path, double to, const looking *how, const layout *at, look *l,
                    sgt_error *error)
{
    layout same = *at;
    *l = (look){.study = NULL};
    if (!sgt_lens_set(copy, path, to, error) || !sgt_look_begin(l, copy, how, false, error)) return false;
    return sgt_look_list(l, &same, false) || refuse(error, path, "it changes what there is, not how much");
}

/* Does the focal length, or the size of a pupil, change too much over the stencil? */
static bool too_far(const layout *at, const look stencil[2 * POINTS])
{
    const double *low = stencil[0].number, *high = stencil[2 * POINTS - 1].number;
    for (size_t i = at->beams; i < at->ideal; i++) {
        const bool radius = i < at->stop && (i - at->beams) % BEAM_NUMBERS == BEAM_RADIUS;
        const bool efl = i >= at->first && (i - at->first) % FIRST_NUMBERS == 0;
        if (!radius && !efl) continue;
        if (fabs(high[i] - low[i]) > TOO_FAR * fmin(fabs(high[i]), fabs(low[i]))) return true;
    }
    return false;
}

static void differ(const look stencil[2 * POINTS], double h, size_t i, double *by, double *error)
{
    double d[POINTS], most = 0;
    for (int k = 0; k < POINTS; k++) {
        const double below = stencil[POINTS - 1 - k].number[i], above = stencil[POINTS + k].number[i];
        d[k] = above - below;
        if (above == below || (isnan(above) && isnan(below))) d[k] = 0;
        most = fmax(most, fmax(fabs(above), fabs(below)));
    }
    *by = *error = 0;
    if (d[0] == 0 && d[1] == 0 && d[2] == 0) return;
    const double fourth = (8 * d[0] - d[1]) / (12 * h), sixth = (45 * d[0] - 9 * d[1] + d[2]) / (60 * h);
    const double q2 = fmin(fabs(sixth - fourth), fabs(sixth)) / fabs(sixth);
    *by = sixth;
    *error = sixth == 0 ? 0 : 4 * q2 * sqrt(q2) * fabs(sixth);
    *error += 2 * ULP * most / h;
}

/* The turn of each element about its own axes: of a rotation R, with the axes as columns, dR = R [w]. */
static void find_turns(const sgt_lens *lens, const layout *at, const look *now, motion *m)
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

/* The stencil about `at`, in x or in 1/x. */
static bool look_around(sgt_lens *copy, const char *path, double x, double h, bool inverse, const looking *how,
                        const layout *at, look stencil[2 * POINTS], sgt_error *error)
{
    bool fine = true;
    for (int i = 0; i < 2 * POINTS && fine; i++) {
        const int k = i < POINTS ? i - POINTS : i - POINTS + 1;
        const double to = (inverse ? 1 / x : x) + k * h;
        fine = look_at(copy, path, inverse ? 1 / to : to, how, at, &stencil[i], error);
    }
    return fine;
}

bool sgt_motion_of(sgt_lens *copy, const char *path, double x, const looking *how, const layout *at,
                   const look *now, motion *out, sgt_error *error)
{
    const bool inverse = is_radius(path);
    look stencil[2 * POINTS] = {{.study = NULL}};
    sgt_error first = {.line = 0}, unread;
    if (!isfinite(x))
        return refuse(error, path, inverse ? "no derivative by an infinite radius; take its curvature"
                                           : "no derivative by an infinite number");
    double scale = inverse ? 1 / fabs(x) : scale_of(copy, path, x);
    double h = ldexp(1, ilogb(scale) - STEP);
    bool fine = false;
    for (int i = 0; i < TRIES && !fine; i++, h = ldexp(h, -SMALLER)) {
        fine = look_around(copy, path, x, h, inverse, how, at, stencil, i == 0 ? &first : &unread) &&
               (!too_far(at, stencil) || i + 1 == TRIES);
        if (fine) break;
        for (int k = 0; k < 2 * POINTS; k++) sgt_look_end(&stencil[k]);
    }
    const double by_x = inverse ? -1 / (x * x) : 1;
    for (size_t i = 0; i < at->end && fine; i++) {
        differ(stencil, h, i, &out->by[i], &out->error[i]);
        out->by[i] *= by_x, out->error[i] *= fabs(by_x);
    }
    for (int k = 0; k < 2 * POINTS; k++) sgt_look_end(&stencil[k]);
    if (!sgt_lens_set(copy, path, x, &unread) || !fine) {
        *error = first;
        if (!*first.words) refuse(error, path, "no derivative: the lens changes too much about it");
        snprintf(error->key, sizeof error->key, "%s", path);
        return false;
    }
    find_turns(copy, at, now, out);
    /* where a wavefront begins is the same for all rays of a field: it may jump, and has no say */
    for (size_t i = at->beams + BEAM_WAVE; i < at->stop; i += BEAM_NUMBERS) out->by[i] = out->error[i] = 0;
    out->beams = !all_zero(out->by, at->beams, at->first);
    if (!all_zero(out->by, at->fixed, at->weights))
        return refuse(error, path, "no derivative: it is no parameter of its surface, or of an ideal lens");
    if (!all_zero(out->by, at->weights, at->end - at->slots))
        return refuse(error, path, "no derivative: weights are held fixed");
    if (how->path && !all_zero(out->by, at->end - at->slots, at->end))
        return refuse(error, path, "no derivative of waves by a wavelength");
    return true;
}
