/* clipped.c - by what a ray was clipped, in words. */
#include "clipped.h"

#include <stdio.h>

void clipped_print(char text[CLIPPED_SIZE], const sgt_element *e, sgt_vec3 p)
{
    static const char *const shapes[] = {"",        "circle",  "annulus", "rectangle",
                                         "ellipse", "polygon", "spider"};
    sgt_clipping by = sgt_clipped_by(e, p);
    if (by.by == SGT_BY_SEMI_DIAMETER) {
        snprintf(text, CLIPPED_SIZE, "by its semi_diameter: r = %.9g is beyond %.9g", by.size,
                 by.limit);
        return;
    }
    if (by.by < 0) {
        snprintf(text, CLIPPED_SIZE, "at its edge");
        return;
    }
    const sgt_aperture_item *item = &e->aperture->items[by.by];
    const char *obscuring = item->obscuring ? ", obscuring" : "";
    int length = snprintf(text, CLIPPED_SIZE, "by aperture %d (%s%s)", by.by + 1, shapes[item->shape],
                          obscuring);
    if (item->shape == SGT_CIRCLE || item->shape == SGT_ANNULUS)
        snprintf(text + length, (size_t)(CLIPPED_SIZE - length), ": r = %.9g is %s %.9g", by.size,
                 by.size > by.limit ? "beyond" : "within", by.limit);
    else
        snprintf(text + length, (size_t)(CLIPPED_SIZE - length), ": %.3g %s its edge", by.size,
                 item->obscuring ? "within" : "beyond");
}
