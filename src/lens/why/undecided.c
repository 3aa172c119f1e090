// SPDX-License-Identifier: MIT
/* undecided.c - the stretch of a ray still in doubt, and the reason.
 *
 * The library gives the stretch [lo, hi].  To find the reason, the library is asked again for every root
 * there, without a proof and without the rim.  What it says of these roots is true as it stands.  How far
 * each is from the rim is computed here. */
#include <sagitta/why.h>

#include "bare.h"
#include "say.h"
#include "../base/vec3.h"

#include <string.h>

enum { ENTRIES = 32, DEFAULT_EVALS = 2000 /* sagitta.h */ };

/* --------------------------------------------------- the roots in doubt */

typedef struct doubt {
    const sgt_search *of;
    sgt_options asked;
    rimless bare;
    sgt_hit root[ENTRIES];   /* inside the rim, or too near to it to tell */
    int roots, at_rim;       /* at_rim: the index of one that is too near to tell; -1: none */
    double rim;
} doubt;

/* The rim is soft by a part in 2^44 of r^2 (surfaces.h). */
static double edge_of(double rim) { return rim * (1 + 0x1p-45); }

/* -1: inside the rim; 1: outside; 0: too near to tell, by rounding. */
static int side_of_rim(const sgt_hit *root, double rim)
{
    double r = hypot(root->p.x, root->p.y), edge = edge_of(rim), slack = 2 * root->p_err + 0x1p-50 * edge;
    if (!(rim > 0) || r < edge - slack) return -1;
    return r > edge + slack ? 1 : 0;
}

static void look_for_roots(doubt *v)
{
    const sgt_search *s = v->of;
    v->at_rim = -1, v->rim = s->semi_diameter > 0 ? s->semi_diameter : v->bare.rim;
    sgt_hit entry[ENTRIES];
    const sgt_options plain = {.t_tol = v->asked.t_tol};
    int count = sgt_intersect_all(v->bare.surface, s->ray, ENTRIES, entry, &plain);
    for (int i = 0; i < count && i < ENTRIES; i++) {
        if (entry[i].status < 0 || entry[i].hi < s->hit->lo || entry[i].lo > s->hit->hi) continue;
        int side = side_of_rim(&entry[i], v->rim);
        if (side == 0) v->at_rim = v->roots;
        if (side <= 0) v->root[v->roots++] = entry[i];
    }
}

/* ---------------------------------------------------------------- the reason */

static const char budget_spent[] = "max_evals was used up first";

/* "t = 1.5 and 2", "t = 1, 2, 3 and 2 more" */
static void say_places(saying *to, const doubt *v)
{
    enum { SHOWN = 3 };
    for (int i = 0; i < v->roots && i < SHOWN; i++)
        sgt_say(to, "%s%s", i == 0 ? "t = " : i + 1 == v->roots ? " and " : ", ",
                sgt_written(v->root[i].t, 0).text);
    if (v->roots > SHOWN) sgt_say(to, " and %d more", v->roots - SHOWN);
}

/* Words for a ray that at t runs along the surface, to a thousandth of a radian, or meets it at the equator,
 * where it ends; else "".  If t is not finite, a ray counts that comes no nearer to the axis than there. */
static const char *where_of(const doubt *v, double t)
{
    const sgt_search *s = v->of;
    const rimless *b = &v->bare;
    const sgt_vec3 d = s->ray.d, p = along3(s->ray.o, t, d);
    double r = isfinite(t) ? hypot(p.x, p.y) : axis_distance3(s->ray.o, d);
    sgt_vec3 n;
    if (b->k > -1 && fabs((1 + b->k) * b->c * b->c * r * r - 1) < 1e-12)
        return "at the equator, where the surface ends, ";
    double f = s->surface.ops->value(s->surface.self, p, &n);
    return isfinite(f) && fabs(dot3(n, d)) < 1e-3 * length3(n) * length3(d) ? "the ray grazes; " : "";
}

/* Does the surface's enclosure leave open whether F ends or jumps in the stretch that is in doubt? */
static bool may_break(const sgt_search *s)
{
    const sgt_surface_ops *ops = s->surface.ops;
    const double lo = s->hit->lo, hi = s->hit->hi;
    sgt_interval slope;
    if (!ops->enclose || !isfinite(lo) || !isfinite(hi)) return false;
    ops->enclose(s->surface.self, &s->ray, (sgt_interval){lo, hi}, &slope);
    return !isfinite(slope.lo) || !isfinite(slope.hi);
}

/* Was the budget spent?  Under a proof the status does not say so. */
static bool is_spent(const doubt *v)
{
    sgt_options same = v->asked;
    same.proof = SGT_ESTIMATE, same.watch = NULL;
    return v->of->hit->evals >= (same.max_evals ? same.max_evals : DEFAULT_EVALS) ||
           sgt_intersect(v->of->surface, v->of->ray, &same).status == SGT_EXHAUSTED;
}

static void say_unproven(saying *to, doubt *v)
{
    const sgt_search *s = v->of;
    if (s->fast || is_spent(v)) {
        sgt_say(to, "%s", s->fast ? "no root was found, but one may have been passed by" : budget_spent);
        return;
    }
    look_for_roots(v);
    if (v->rim > 0 && !(v->rim * v->rim > 0x1p-960)) {
        sgt_say(to, "nothing can be decided: the square of semi_diameter is too small for a double");
    } else if (v->at_rim >= 0) {
        const sgt_hit *h = &v->root[v->at_rim];
        sgt_say(to, "rounding hides on which side of the rim the root at t = %s is: r = %s, and the rim ends "
                    "at %s",
                sgt_written(h->t, 0).text, sgt_written(hypot(h->p.x, h->p.y), 0).text,
                sgt_written(edge_of(v->rim), 0).text);
    } else if (v->roots > 1 && s->near_seed && v->asked.proof == SGT_PROVE_FIRST) {
        sgt_say(to, "the root %s is not the only one: the ray meets the surface at ",
                sgt_is_sag(s->surface) ? "near the vertex" : "that is picked");
        say_places(to, v);
    } else if (v->roots > 1) {
        sgt_say(to, "the ray meets the surface at ");
        say_places(to, v);
        sgt_say(to, ", but none of these roots is proven");
    } else if (v->roots == 1 && v->root[0].status == SGT_GRAZE) {
        sgt_say(to, "the ray touches the surface at ");
        say_places(to, v);
        sgt_say(to, ", as far as can be told: one root, two or none");
    } else if (v->roots == 1) {
        sgt_say(to, "%sthere is a root at ", where_of(v, v->root[0].t));
        say_places(to, v);
        sgt_say(to, ", at most %s off, but it is not proven to be the only one%s",
                sgt_written(v->root[0].t_err, 2).text,
                v->asked.t_tol > 0 ? "; a smaller t_tol may help" : "");
    } else {
        sgt_say(to, "%sthere may be a root or none: %s", where_of(v, 0.5 * s->hit->lo + 0.5 * s->hit->hi),
                may_break(s) ? "F may end, jump, or have a pole or a kink there"
                             : "rounding hides which");
    }
}

static void say_reason(saying *to, doubt *v)
{
    switch (v->of->hit->status) {
    case SGT_UNPROVEN: say_unproven(to, v); break;
    case SGT_UNDEFINED:
        sgt_say(to, "%s", isnan(v->of->hit->lo) ? "met, but without a normal there, or a direction behind it"
                                                : "F is NaN where the root would have to be");
        break;
    case SGT_EXHAUSTED: sgt_say(to, "%s", budget_spent); break;
    case SGT_INVALID: sgt_say(to, "the ray or the surface is invalid"); break;
    default: sgt_say(to, "no answer");
    }
}

/* " from t = 1 to 2"; nothing for the whole ray. */
static void say_stretch(saying *to, const sgt_search *s)
{
    const double lo = s->hit->lo, hi = s->hit->hi;
    const bool starts = lo > s->ray.tmin, ends = hi < sgt_end_of(&s->ray);
    const written from = sgt_written(lo, 0), end = sgt_written(hi, 0);
    if (starts && ends && strcmp(from.text, end.text) == 0) sgt_say(to, " at t = %s", from.text);
    else if (starts && ends) sgt_say(to, " from t = %s to %s", from.text, end.text);
    else if (starts) sgt_say(to, " from t = %s on", from.text);
    else if (ends) sgt_say(to, " up to t = %s", end.text);
}

size_t sgt_why_undecided(const sgt_search *s, size_t size, char text[])
{
    saying to = {.size = size, .text = text};
    if (sgt_say_unknown(&to, s->reserved_, "sgt_search")) return to.length;
    sgt_say(&to, "%s", s->hit->status < 0 ? sgt_status_text(s->hit->status) : "");
    if (s->hit->status >= 0) return 0;
    doubt v = {.of = s, .bare = sgt_bare_of(s->surface)};
    if (s->options) v.asked = *s->options;
    say_stretch(&to, s);
    sgt_say(&to, ": ");
    say_reason(&to, &v);
    sgt_bare_end(&v.bare);
    return to.length;
}
