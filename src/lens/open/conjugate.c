// SPDX-License-Identifier: MIT
/* conjugate.c - ideal lenses without an object_distance get the paraxial one.
 *
 * It is of each wavelength.  What is in front forms an image of the object, whose place depends on the
 * wavelength if the media have dispersion; so it is from there that the light of a wavelength comes, and that
 * plane has to be imaged without path differences.  With the distance of the primary wavelength the light of
 * another, perfectly focused in front, would get path differences from a lens that is ideal.
 *
 * A LENS OF TWO POWERS has two images of it.  As in all first-order data, the one that is meant is that of
 * rays in the plane x = 0.
 *
 * An image on the lens itself: all rays of an object point meet it in one point, and their paths are the same
 * in the limit of a small distance.  LEAST of the focal length stands for it. */
#include "conjugate.h"

#include "../optics/objects.h"

#include <math.h>

/* Is it an ideal lens whose object is not given? */
static bool is_open(const sgt_phase *p) { return p && p->kind == SGT_IDEAL_LENS && p->object_distance == 0; }

static double shortest(const sgt_phase *p)
{
    return p->focal_length_y == 0 ? fabs(p->focal_length)
                                  : fmin(fabs(p->focal_length), fabs(p->focal_length_y));
}

void sgt_find_conjugates(whole_lens *w, source *s)
{
    const double LEAST = 0x1p-60, MOST = 0x1p500;
    sgt_lens *l = &w->lens;
    const sgt_lens_surface *unknown = NULL;
    bool any = false;
    for (size_t i = 0; i < l->count; i++)
        any = any || is_open(w->element[i].phase);
    if (!any) return;
    if (!w->phase_at) w->phase_at = tree_room(s, l->wavelengths * l->count, sizeof *w->phase_at);
    double *distance = tree_room(s, l->count, sizeof *distance);
    for (size_t k = 0; k < l->wavelengths; k++) {
        sgt_paraxial_objects(l, l->wavelength ? l->wavelength[k] : (double)NAN, s, distance);
        for (size_t i = 0; i < l->count; i++) {
            const sgt_phase *given = w->element[i].phase;
            if (!is_open(given)) continue;
            const double least = fmax(LEAST * shortest(given), 1 / MOST), a = distance[i];
            sgt_phase *own = &w->phase_at[k * l->count + i];
            *own = *given;
            own->object_distance = fabs(a) <= MOST ? copysign(fmax(fabs(a), least), a) : HUGE_VAL;
            if (isnan(a) && !unknown) unknown = &w->about[i];
        }
    }
    sgt_put_phases(w, l->wavelength ? l->wavelength[l->primary] : (double)NAN, w->element);
    if (unknown)
        tree_remark(s, SGT_REMARK_NOTE, unknown->line, "object_distance",
                    "not given, and there is no paraxial image of the object in front of this ideal lens (a "
                    "surface there has no vertex, or is tilted by its origin): opl is counted from afar");
}
