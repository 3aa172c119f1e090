// SPDX-License-Identifier: MIT
/* explain.c - why a call is SGT_INVALID, in words: sgt_explain_intersect, sgt_explain_leave (sagitta.h),
 * sgt_explain_trace (system.h), sgt_explain_aim (aim.h).
 *
 * The functions of the library look at their arguments with a few comparisons and answer with a status, since
 * they are called for each ray.  Here the same rules are asked one by one, and the first that is broken is
 * named.  tests/unit/test_explain.c breaks each, and holds this file to what the functions answer. */
#include "../surface/builtin.h"

#include <float.h>
#include <sagitta/aim.h>

/* Appends what fits. */
static void append(char *to, size_t size, const char *text)
{
    size_t at = 0;
    while (at + 1 < size && to[at]) at++;
    while (*text && at + 1 < size) to[at++] = *text++;
    to[at] = 0;
}

static void append_number(char *to, size_t size, size_t n)
{
    char digits[24], *at = digits + sizeof digits - 1;
    *at = 0;
    do *--at = (char)('0' + n % 10), n /= 10;
    while (n);
    append(to, size, at);
}

/* The argument is at fault; where in it: `part` (NULL: all of it).  Returns false. */
static bool blame(sgt_error *error, const char *argument, const char *part, const char *words)
{
    if (!error) return false;
    memset(error, 0, sizeof *error);
    append(error->key, sizeof error->key, argument);
    if (part) append(error->key, sizeof error->key, "."), append(error->key, sizeof error->key, part);
    append(error->words, sizeof error->words, words);
    return false;
}

/* In front of the key: "e[3].". */
static bool explain_within(sgt_error *error, const char *list, size_t place)
{
    if (!error) return false;
    char was[sizeof error->key];
    memcpy(was, error->key, sizeof was);
    error->key[0] = 0;
    append(error->key, sizeof error->key, list), append(error->key, sizeof error->key, "[");
    append_number(error->key, sizeof error->key, place), append(error->key, sizeof error->key, "].");
    append(error->key, sizeof error->key, was);
    return false;
}

/* What is reserved for later versions has to be zero. */
static bool explain_plain(const unsigned long long reserved[], size_t count, const char *argument,
                          sgt_error *error)
{
    for (size_t i = 0; i < count; i++) {
        if (!reserved[i]) continue;
        if (!blame(error, argument, "reserved_[",
                   "not zero: the program was compiled for a later version of ") &&
            !error)
            return false;
        append_number(error->key, sizeof error->key, i), append(error->key, sizeof error->key, "]");
        append(error->words, sizeof error->words, "sagitta, and asks for a member that ");
        append(error->words, sizeof error->words, sgt_version());
        append(error->words, sizeof error->words, ", which runs, has not");
        return false;
    }
    return true;
}

#define PLAIN(of, argument, error) \
    explain_plain((of)->reserved_, sizeof(of)->reserved_ / sizeof *(of)->reserved_, argument, error)

static bool explain_finite(sgt_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

static bool ray_sound(const sgt_ray *ray, bool whole_line, sgt_error *error)
{
    const sgt_vec3 d = ray->d;
    if (!explain_finite(ray->o)) return blame(error, "ray", "o", "not finite");
    if (!explain_finite(d)) return blame(error, "ray", "d", "not finite");
    if (!(fabs(d.x) >= DBL_MIN || fabs(d.y) >= DBL_MIN || fabs(d.z) >= DBL_MIN))
        return blame(error, "ray", "d", "zero or subnormal: it has no direction");
    if (whole_line) return true;
    const double lo = ray->tmin, hi = lo == 0 && ray->tmax == 0 ? HUGE_VAL : ray->tmax;
    if (isnan(lo)) return blame(error, "ray", "tmin", "not a number");
    if (isnan(hi)) return blame(error, "ray", "tmax", "not a number");
    if (lo > hi)
        return blame(error, "ray", "tmax",
                     "less than tmin; a tmax of 0 means infinity only if both are 0, else give INFINITY");
    if (lo == HUGE_VAL) return blame(error, "ray", "tmin", "infinity: nothing lies beyond it");
    if (hi == -HUGE_VAL) return blame(error, "ray", "tmax", "-infinity: nothing lies before it");
    return true;
}

static bool options_sound(const sgt_options *opt, sgt_error *error)
{
    static const char negative[] = "negative, or not a number";
    if (!opt) return true;
    if (!(opt->t_tol >= 0)) return blame(error, "opt", "t_tol", negative);
    if (!(opt->f_tol >= 0)) return blame(error, "opt", "f_tol", negative);
    if (!(opt->dt_min >= 0)) return blame(error, "opt", "dt_min", negative);
    if (opt->max_evals < 0) return blame(error, "opt", "max_evals", negative);
    if ((unsigned)opt->proof > SGT_PROVE_FIRST) return blame(error, "opt", "proof", "no sgt_proof");
    return PLAIN(opt, "opt", error);
}

/* Of a built-in surface the ranges of its parameters, and what its row has besides. */
static bool row_sound(const sgt_builtin *row, const void *self, sgt_error *error)
{
    for (const sgt_param *p = row->params; p->name; p++) {
        if (p->kind != SGT_PARAM_REAL && p->kind != SGT_PARAM_VECTOR) continue;
        for (int i = 0; i < p->count; i++) {
            double x;
            memcpy(&x, (const char *)self + p->offset + (size_t)i * sizeof x, sizeof x);
            bool unset = x == 0; /* the default, where 0 is not in the range */
            if (!(x >= p->lo && x <= p->hi) && !unset)
                return blame(error, "s.self", p->name, isfinite(x) ? "out of its range" : "not finite");
        }
    }
    sgt_objection no = row->object ? row->object(self) : (sgt_objection){NULL, NULL};
    return no.reason ? blame(error, "s.self", no.param, no.reason) : true;
}

static bool surface_sound(sgt_surface s, sgt_error *error)
{
    if (!s.ops) return blame(error, "s", "ops", "NULL");
    if (!s.ops->value) return blame(error, "s", "ops->value", "NULL: a surface needs it");
    const sgt_builtin *found = NULL;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++)
        if (row->ops == s.ops) found = row; /* the last of those that share it names all parameters */
    if (found) return row_sound(found, s.self, error);
    if (is_catalogue(s.ops)) { /* a formula */
        sgt_objection no = s.ops->own_->object(s.self);
        return no.reason ? blame(error, "s.self", no.param, no.reason) : true;
    }
    if (!s.ops->own_ && s.ops->size != 0 &&
        s.ops->size < offsetof(sgt_surface_ops, by_parameter) + sizeof s.ops->by_parameter)
        return blame(error, "s", "ops->size", "less than the table of version 0.2");
    return true;
}

bool sgt_explain_intersect(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, const sgt_hits *hits,
                           sgt_error *error)
{
    return surface_sound(s, error) && ray_sound(ray, false, error) && options_sound(opt, error) &&
           (!hits || PLAIN(hits, "hits", error));
}

static bool explain_start(const sgt_start *from, sgt_error *error)
{
    const sgt_vec3 d = from->d;
    if (!explain_finite(from->p))
        return blame(error, "from", "p", "not finite: a ray that met nothing has no point to start at");
    if (!(from->p_err >= 0 && from->p_err < HUGE_VAL))
        return blame(error, "from", "p_err", "negative, or not finite");
    if (!explain_finite(d)) return blame(error, "from", "d", "not finite");
    if (!(fabs(d.x) >= DBL_MIN || fabs(d.y) >= DBL_MIN || fabs(d.z) >= DBL_MIN))
        return blame(error, "from", "d", "zero or subnormal: it has no direction");
    if (!(from->tmax >= 0)) return blame(error, "from", "tmax", "negative, or not a number");
    return PLAIN(from, "from", error);
}

bool sgt_explain_leave(sgt_surface s, const sgt_start *from, const sgt_options *opt, const sgt_hits *hits,
                       sgt_error *error)
{
    return surface_sound(s, error) && explain_start(from, error) && options_sound(opt, error) &&
           (!hits || PLAIN(hits, "hits", error));
}

/* ------------------------------------------------------------------ lenses */

static bool explain_is_index(double index) { return index > 0 && index < HUGE_VAL; }
static bool is_length(double a) { return fabs(a) >= 0x1p-500 && fabs(a) <= 0x1p500; }

static bool aperture_sound(const sgt_element *e, sgt_error *error)
{
    if (!(e->semi_diameter >= 0)) return blame(error, "semi_diameter", NULL, "negative, or not a number");
    if (!e->aperture) return true;
    if (!PLAIN(e->aperture, "aperture", error)) return false;
    for (size_t i = 0; e->aperture->items && i < e->aperture->count; i++) {
        const sgt_aperture_item *item = &e->aperture->items[i];
        const sgt_aperture one = {.count = 1, .items = item};
        const sgt_element alone = {.aperture = &one};
        if (!PLAIN(item, "items", error)) return false;
        if (sgt_clipped_by(&alone, (sgt_vec3){0, 0, 0}).by != SGT_BY_UNSOUND) continue;
        blame(error, "shape", NULL, "the item is not as its shape needs it, or it has no known shape");
        return explain_within(error, "aperture->items", i);
    }
    if (sgt_clipped_by(e, (sgt_vec3){0, 0, 0}).by != SGT_BY_UNSOUND) return true;
    return blame(error, "aperture", NULL, "items that are NULL, or 2^31 and more");
}

/* Of a surface in a phase: "s.self.c" is "phase.waves.self.c". */
static bool waves_sound(const sgt_phase *p, sgt_error *error)
{
    const sgt_surface s = p->waves;
    if (p->kind != SGT_FACETS && !isfinite(p->per_wave))
        return blame(error, "phase", "per_wave", "not finite");
    if (!surface_sound(s, error)) {
        if (!error) return false;
        char was[sizeof error->key];
        memcpy(was, error->key, sizeof was);
        memcpy(error->key, "phase.waves", sizeof "phase.waves");
        append(error->key, sizeof error->key, was + 1);
        return false;
    }
    if (p->kind != SGT_PHASE_FUNCTION && s.ops->own_ && !sgt_is_sag(s))
        return blame(error, "phase", "waves", "no sag, as SGT_PHASE_SAG and SGT_FACETS need");
    return true;
}

static bool phase_sound(const sgt_phase *p, sgt_error *error)
{
    if (!p) return true;
    if (p->kind < SGT_IDEAL_LENS || p->kind > SGT_FACETS)
        return blame(error, "phase", "kind", "no sgt_phase_kind");
    if (!PLAIN(p, "phase", error)) return false;
    if (p->kind != SGT_IDEAL_LENS) return waves_sound(p, error);
    const double fx = fabs(p->focal_length), fy = fabs(p->focal_length_y);
    if (!is_length(fx) && !(fx == HUGE_VAL && fy != 0))
        return blame(error, "phase", "focal_length", "not 2^-500 to 2^500 long");
    if (fy != 0 && !is_length(fy) && fy != HUGE_VAL)
        return blame(error, "phase", "focal_length_y", "not 0, infinite, or 2^-500 to 2^500 long");
    if (fx == HUGE_VAL && fy == HUGE_VAL)
        return blame(error, "phase", "focal_length_y", "infinite, and so is focal_length");
    double a = fabs(p->object_distance);
    return a == 0 || a == HUGE_VAL || is_length(a)
               ? true
               : blame(error, "phase", "object_distance", "not 0, infinite, or 2^-500 to 2^500 long");
}

static bool element_sound(const sgt_element *e, sgt_error *error)
{
    if (e->index != 0 && e->index != SGT_MIRROR && !explain_is_index(e->index))
        return blame(error, "index", NULL, "not above 0 and finite, nor SGT_MIRROR");
    return PLAIN(e, "element", error) && aperture_sound(e, error) && phase_sound(e->phase, error) &&
           surface_sound(e->surface, error);
}

static bool elements_sound(size_t elements, const sgt_element e[], double index_before, sgt_error *error)
{
    if (index_before != 0 && !explain_is_index(index_before))
        return blame(error, "index_before", NULL, "not above 0 and finite");
    for (size_t i = 0; i < elements; i++)
        if (!element_sound(&e[i], error)) return explain_within(error, "e", i);
    return true;
}

bool sgt_explain_trace(size_t elements, const sgt_element e[], double index_before, const sgt_ray *ray,
                       const sgt_options *opt, const sgt_traced *out, const sgt_passages passages[],
                       sgt_error *error)
{
    if (!elements_sound(elements, e, index_before, error) || !ray_sound(ray, true, error) ||
        !options_sound(opt, error) || (out && !PLAIN(out, "out", error)))
        return false;
    for (size_t i = 0; passages && i < elements; i++)
        if (!PLAIN(&passages[i], "passage", error) || !PLAIN(&passages[i].hits, "hits", error))
            return explain_within(error, "passages", i);
    return true;
}

static bool is_box(sgt_interval x) { return isfinite(x.lo) && isfinite(x.hi) && x.lo <= x.hi; }
static bool explain_is_zero(sgt_vec3 a) { return a.x == 0 && a.y == 0 && a.z == 0; }

bool sgt_explain_aim(size_t stop, const sgt_element e[], double index_before, const sgt_beam *b,
                     sgt_vec2 wanted, const sgt_aim_options *opt, sgt_error *error)
{
    const struct { const char *name; sgt_vec3 of; } vectors[] = {{"o", b->o}, {"ou", b->ou}, {"ov", b->ov},
                                                                 {"d", b->d}, {"du", b->du}, {"dv", b->dv}};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        if (!explain_finite(vectors[i].of)) return blame(error, "beam", vectors[i].name, "not finite");
    if (!is_box(b->u)) return blame(error, "beam", "u", "not finite, or lo > hi");
    if (!is_box(b->v)) return blame(error, "beam", "v", "not finite, or lo > hi");
    if (explain_is_zero(b->d) && explain_is_zero(b->du) && explain_is_zero(b->dv))
        return blame(error, "beam", "d", "no direction at all");
    if (!PLAIN(b, "beam", error)) return false;
    if (!isfinite(wanted.x) || !isfinite(wanted.y)) return blame(error, "wanted", NULL, "not finite");
    if (opt) {
        if (!(opt->tol >= 0)) return blame(error, "opt", "tol", "negative, or not a number");
        if (opt->max_traces < 0) return blame(error, "opt", "max_traces", "negative");
        for (size_t i = 0; i < opt->starts; i++)
            if (!isfinite(opt->start[i].x) || !isfinite(opt->start[i].y))
                return blame(error, "opt", "start", "not finite");
        if (!PLAIN(opt, "opt", error)) return false;
    }
    return elements_sound(stop + 1, e, index_before, error);
}
