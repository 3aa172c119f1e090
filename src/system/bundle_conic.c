// SPDX-License-Identifier: MIT
/* bundle_conic.c - a bundle of lines meets a conic.
 *
 * A CONIC.  A line crosses the vertex plane at (x, y, 0).  On it c (x^2 + y^2 + k1 z^2) - 2 z, k1 = 1 + k, is
 * A t^2 - 2 B t + C with
 *
 *     A = c (1 + k dz^2),   B = dz - c (x dx + y dy),   C = c (x^2 + y^2),   D = B^2 - A C.
 *
 * The root near the vertex is t = C / b, b = B + sign(B) sqrt(D); the other is b / A.  With
 * n = (-c x, -c y, v), v = 1 - k1 c z, the gradient of z - s times v,
 *
 *     n . d = sign(B) sqrt(D),   n . n = 1 + k c z (k1 c z - 2).
 *
 * No quotient by v: a ray at the equator is none of special note.  A root is on the sheet where v >= 0.  If
 * D < 0 for all rays, or v < 0, none meets it.
 *
 * THE OTHER ROOT may be meant instead only if it is on the sheet, and (ray/intersect.c, trace.c)
 *
 *     the near one is not on the sheet, or is outside the rim;
 *     or the near one is outside the aperture, and the other inside.
 *
 * The part is UNKNOWN unless that is excluded.  The other root has 1 - k1 c z = (A - k1 c dz b) / A.  Where A
 * may be 0 it may be at infinity.  If k1 <= 0, it is on the sheet only with c z >= 0, where r^2 >= 2 |z| /
 * |c|: so it is far out if |z| = |dz b / A| is large. */
#include "bundle.h"

/* A rim and an aperture are soft by a part in 2^44. */
static const double SOFT = 1 + 0x1p-40;

/* Is the other root of the conic certainly not meant? */
static bool other_excluded(double c, double k, double rim, double aperture, const bundle_lines *w, linear A,
                           linear b, const bundle_hit *near)
{
    double k1 = 1 + k;
    if (c == 0) return true; /* there is none */
    linear bent_z = form_scaled(form_product(b, w->d.z), k1 * c), on = form_difference(A, bent_z); /* v A */
    on = form_wider(on, BUNDLE_SLACK * (form_size(A) + form_size(bent_z))); /* k1 c has been rounded */
    if ((form_above(A, 0) && form_below(on, 0)) || (form_below(A, 0) && form_above(on, 0))) return true;
    if (!form_above(near->n.z, BUNDLE_SLACK)) return false;
    linear r2 = form_sum(form_square(near->p.x), form_square(near->p.y));
    bool in_rim = !(rim < HUGE_VAL) || form_below(r2, rim * rim * (1 - BUNDLE_SLACK));
    if (!in_rim) return false;
    if (!(aperture < HUGE_VAL) || form_below(r2, aperture * aperture * (1 - BUNDLE_SLACK))) return true;
    if (form_above(A, 0) || form_below(A, 0)) {
        linear t = form_quotient(b, A), x = form_sum(w->x, form_product(t, w->d.x)),
               y = form_sum(w->y, form_product(t, w->d.y));
        if (form_above(form_sum(form_square(x), form_square(y)), aperture * aperture * SOFT)) return true;
    }
    if (k1 > 0) return false;
    sgt_interval z = sgt_interval_absolute(form_range(form_product(w->d.z, b))), a = form_range(A);
    double most = sgt_interval_greatest(a), away2 = 2 * z.lo * (1 - BUNDLE_SLACK) / (most * fabs(c));
    return away2 > aperture * aperture * SOFT;
}

bundle_fate sgt_bundle_conic(double c, double k, double rim, double aperture, const bundle_lines *w,
                             bundle_hit *h)
{
    const form3 d = w->d;
    linear r2 = form_sum(form_square(w->x), form_square(w->y));
    linear across = form_sum(form_product(w->x, d.x), form_product(w->y, d.y));
    linear A = form_scaled(form_plus(form_scaled(form_square(d.z), k), 1), c);
    A = form_wider(A, fabs(c) * BUNDLE_SLACK * (1 + fabs(k)));
    linear B = form_difference(d.z, form_scaled(across, c)), C = form_scaled(r2, c);
    linear D = form_difference(form_square(B), form_product(A, C));
    if (form_below(D, 0)) return BUNDLE_GONE;
    bool up = form_above(B, 0);
    if (!up && !form_below(B, 0)) return BUNDLE_UNKNOWN;
    linear root = form_root(D), slope = up ? root : form_negative(root), b = form_sum(B, slope);
    linear t = form_quotient(C, b);
    h->p = (form3){form_sum(w->x, form_product(t, d.x)), form_sum(w->y, form_product(t, d.y)),
                   form_product(t, d.z)};
    linear cz = form_scaled(h->p.z, c), k1cz = form_sum(cz, form_scaled(cz, k));
    h->n = (form3){form_scaled(h->p.x, -c), form_scaled(h->p.y, -c), form_plus(form_negative(k1cz), 1)};
    h->size2 = form_plus(form_scaled(form_product(cz, form_plus(k1cz, -2)), k), 1);
    h->slope = slope, h->sign = up ? 1 : -1;
    if (!other_excluded(c, k, rim, aperture, w, A, b, h)) return BUNDLE_UNKNOWN;
    return form_below(h->n.z, 0) ? BUNDLE_GONE : BUNDLE_THERE;
}
