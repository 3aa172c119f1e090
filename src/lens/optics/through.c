// SPDX-License-Identifier: MIT
/* through.c - a ray through a lens, whatever clips it; the last element as an image.
 *
 * THE LAST ELEMENT is where rays end.  An ideal lens there would add its own path to theirs, though the
 * light that it bends is looked at no more: so it counts as the plane that it stands on.
 *
 * WHATEVER CLIPS.  Sizes and references are those of rays through the surfaces, and do not depend on which
 * of them are obscured.  But a semi_diameter has a say in which root is meant (sgt_trace).  It clips a ray
 * only where no root lies inside, and then the root is the one without it.  So a ray that it clips is traced
 * again without that semi_diameter alone.  The items of an aperture have no say in the root. */
#include "launch.h"

void sgt_launch_ending(size_t count, const sgt_element e[], sgt_element out[])
{
    for (size_t i = 0; i < count; i++) out[i] = e[i];
    if (out[count - 1].phase) out[count - 1].index = 0, out[count - 1].phase = NULL;
}

size_t sgt_trace_through(size_t elements, const sgt_element e[], double before, const sgt_ray *launch,
                         sgt_element open[], sgt_passage passages[], sgt_fate *fate)
{
    for (size_t i = 0; i < elements; i++) open[i] = e[i], open[i].aperture = NULL;
    for (size_t left = elements;; left--) { /* each time one more element is open */
        sgt_ray ray = *launch;
        size_t passed = sgt_trace(elements, open, before, &ray, passages, fate, NULL);
        if (*fate != SGT_CLIPPED || left == 0) return passed;
        open[passed].semi_diameter = 0;
    }
}
