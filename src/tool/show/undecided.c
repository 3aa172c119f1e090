/* undecided.c - the stretch of a ray still in doubt, and the reason.
 *
 * The library gives the stretch [lo, hi].  To find the reason, the library is asked again for every root
 * there, without a proof and without the rim.  What it says of these roots is true as it stands.  How far
 * each is from the rim is computed here. */
#include "undecided.h"

#include "frame.h"
#include "../base/memory.h"
#include "../../text/number.h"
#include "profile.h"
#include "../read/rays.h"
#include "../read/surface.h"

#include <math.h>
#include <string.h>

enum { ENTRIES = 32, DEFAULT_EVALS = 2000 /* sagitta.h */ };

static const char RIM[] = "semi_diameter";

bool undecided_has_rim(sgt_surface s) { return surface_number(s, RIM) != NULL; }

bare_surface undecided_without_rim(sgt_surface s)
{
    const sgt_builtin *row = surface_row(s);
    bare_surface b = {.surface = s, .terms = row->family != SGT_FAMILY_CONIC};
    const double *rim = surface_number(s, RIM), *c = surface_number(s, "curvature"),
                 *k = surface_number(s, "conic");
    if (!rim) return b;
    char *bare = memory_take(1, row->size);
    memcpy(bare, s.self, row->size);
    memset(bare + ((const char *)rim - (const char *)s.self), 0, sizeof *rim);
    b.surface.self = bare;
    b.rim = *rim;
    /* with a curvature_x, c and k belong to one section only */
    if (!surface_number(s, "curvature_x")) b.c = c ? *c : 0, b.k = k ? *k : 0;
    if (row->family == SGT_FAMILY_ASPHERE) { /* of no terms it is a conic */
        const double *a = surface_number(s, "coefficients");
        b.terms = false;
        for (int i = 0; i < 8; i++) b.terms = b.terms || a[i] != 0;
    }
    return b;
}

/* --------------------------------------------------- the roots in doubt */

typedef struct view {
    sgt_hit root[ENTRIES];   /* inside the rim, or too near to it to tell */
    int roots, at_rim;       /* at_rim: the index of one that is too near to tell; -1: none */
    double rim;
} view;

/* The rim is soft by a part in 2^44 of r^2 (surfaces.h). */
static double edge_of(double rim) { return rim * (1 + 0x1p-45); }

/* -1: inside the rim; 1: outside; 0: too near to tell, by rounding. */
static int side_of_rim(const sgt_hit *root, double rim)
{
    double r = hypot(root->p.x, root->p.y), edge = edge_of(rim), slack = 2 * root->p_err + 0x1p-50 * edge;
    if (!(rim > 0) || r < edge - slack) return -1;
    return r > edge + slack ? 1 : 0;
}

static view view_of(const search *s)
{
    view v = {.at_rim = -1, .rim = s->semi_diameter};
    bare_surface b = undecided_without_rim(s->surface);
    if (!(v.rim > 0)) v.rim = b.rim;
    sgt_hit entry[ENTRIES];
    const sgt_options plain = {.t_tol = s->asked->t_tol};
    int count = sgt_intersect_all(b.surface, s->ray, ENTRIES, entry, &plain);
    for (int i = 0; i < count && i < ENTRIES; i++) {
        if (entry[i].status < 0 || entry[i].hi < s->hit->lo || entry[i].lo > s->hit->hi) continue;
        int side = side_of_rim(&entry[i], v.rim);
        if (side == 0) v.at_rim = v.roots;
        if (side <= 0) v.root[v.roots++] = entry[i];
    }
    return v;
}

/* ---------------------------------------------------------------- the reason */

static const char budget_spent[] = "--max-evals was used up first";

static const char *number_text(double x)
{
    char text[NUMBER_SIZE];
    number_print(text, x, false);
    return memory_print("%s", text);
}

/* "t = 1.5 and 2", "t = 1, 2, 3 and 2 more" */
static const char *places_of(const view *v)
{
    enum { SHOWN = 3 };
    const char *text = "";
    for (int i = 0; i < v->roots && i < SHOWN; i++)
        text = memory_print("%s%s%s", text, i == 0 ? "t = " : i + 1 == v->roots ? " and " : ", ",
                            number_text(v->root[i].t));
    return v->roots > SHOWN ? memory_print("%s and %d more", text, v->roots - SHOWN) : text;
}

/* Words for a ray that at t runs along the surface, to a thousandth of a radian, or meets it at the equator,
 * where it ends; else "".  If t is not finite, a ray counts that comes no nearer to the axis than there. */
static const char *where_of(const search *s, double t)
{
    const sgt_vec3 d = s->ray.d, p = vector_along(s->ray.o, d, t);
    bare_surface b = undecided_without_rim(s->surface);
    double r = isfinite(t) ? hypot(p.x, p.y) : vector_axis_distance(s->ray.o, d);
    sgt_vec3 n;
    if (b.k > -1 && fabs((1 + b.k) * b.c * b.c * r * r - 1) < 1e-12)
        return "at the equator, where the surface ends, ";
    double f = s->surface.ops->value(s->surface.self, p, &n);
    return isfinite(f) && fabs(vector_dot(n, d)) < 1e-3 * vector_length(n) * vector_length(d)
               ? "the ray grazes; "
               : "";
}

/* Does the surface's enclosure leave open whether F ends or jumps in the stretch that is in doubt? */
static bool may_break(const search *s)
{
    const sgt_surface_ops *ops = s->surface.ops;
    const double lo = s->hit->lo, hi = s->hit->hi;
    sgt_interval slope;
    if (!ops->enclose || !isfinite(lo) || !isfinite(hi)) return false;
    ops->enclose(s->surface.self, &s->ray, (sgt_interval){lo, hi}, &slope);
    return !isfinite(slope.lo) || !isfinite(slope.hi);
}

/* Was the budget spent?  Under a proof the status does not say so. */
static bool is_spent(const search *s)
{
    sgt_options same = *s->asked;
    same.proof = SGT_ESTIMATE, same.watch = NULL;
    return s->hit->evals >= (same.max_evals ? same.max_evals : DEFAULT_EVALS) ||
           sgt_intersect(s->surface, s->ray, &same).status == SGT_EXHAUSTED;
}

static const char *why_unproven(const search *s)
{
    if (s->fast) return "no root was found, but one may have been passed by";
    if (is_spent(s)) return budget_spent;
    const view v = view_of(s);
    const char *places = places_of(&v);
    if (v.rim > 0 && !(v.rim * v.rim > 0x1p-960))
        return "nothing can be decided: the square of semi_diameter is too small for a double";
    if (v.at_rim >= 0) {
        const sgt_hit *h = &v.root[v.at_rim];
        return memory_print("rounding hides on which side of the rim the root at t = %s is: r = %s, "
                            "and the rim ends at %s",
                            number_text(h->t), number_text(hypot(h->p.x, h->p.y)),
                            number_text(edge_of(v.rim)));
    }
    if (v.roots > 1 && s->near_seed && s->asked->proof == SGT_PROVE_FIRST)
        return memory_print("the root %s is not the only one: the ray meets the surface at %s",
                            profile_is_sag(s->surface) ? "near the vertex" : "that is picked", places);
    if (v.roots > 1)
        return memory_print("the ray meets the surface at %s, but none of these roots is proven", places);
    if (v.roots == 1 && v.root[0].status == SGT_GRAZE)
        return memory_print("the ray touches the surface at %s, as far as can be told: one root, two or none",
                            places);
    if (v.roots == 1)
        return memory_print("%sthere is a root at %s, at most %.2g off, but it is not proven to be the only "
                            "one%s",
                            where_of(s, v.root[0].t), places, v.root[0].t_err,
                            s->asked->t_tol > 0 ? "; a smaller --t-tol may help" : "");
    return memory_print("%sthere may be a root or none: %s", where_of(s, 0.5 * s->hit->lo + 0.5 * s->hit->hi),
                        may_break(s) ? "F may end, jump, or have a pole or a kink there"
                                     : "rounding hides which");
}

static const char *reason_of(const search *s)
{
    switch (s->hit->status) {
    case SGT_UNPROVEN: return why_unproven(s);
    case SGT_UNDEFINED:
        return isnan(s->hit->lo) ? "met, but without a normal there, or a direction behind it"
                                 : "F is NaN where the root would have to be";
    case SGT_EXHAUSTED: return budget_spent;
    case SGT_INVALID: return "the ray or the surface is invalid";
    default: return "no answer";
    }
}

/* " from t = 1 to 2"; "" for the whole ray. */
static const char *stretch_of(const search *s)
{
    const double lo = s->hit->lo, hi = s->hit->hi, tmax = ray_end(&s->ray);
    const bool starts = lo > s->ray.tmin, ends = hi < tmax;
    const char *from = number_text(lo), *to = number_text(hi);
    if (starts && ends && strcmp(from, to) == 0) return memory_print(" at t = %s", from);
    if (starts && ends) return memory_print(" from t = %s to %s", from, to);
    return starts ? memory_print(" from t = %s on", from) : ends ? memory_print(" up to t = %s", to) : "";
}

void undecided_explain(table *t, const char *who, const search *s)
{
    table_line(t, "%s%s%s: %s.", who, sgt_status_text(s->hit->status), stretch_of(s), reason_of(s));
}
