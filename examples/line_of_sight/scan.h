// SPDX-License-Identifier: MIT
/* scan.h - all pixels of all lines: their rays, and what these met. */
#ifndef LINE_OF_SIGHT_SCAN_H
#define LINE_OF_SIGHT_SCAN_H
#include "camera.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Arrays of lines x pixels, line after line; what a ray has not met is NaN. */
typedef struct scan {
    struct camera camera;
    size_t rays, met, undecided;
    double *o[3], *d[3];                              /* metres; d of unit length */
    sgt_status *status;                              /* an sgt_status */
    int *evals;
    double *range, *range_err, *p[3], *n[3];          /* metres */
    double *latitude, *longitude, *height;            /* degrees, metres over WGS84 */
    /* degrees between the ray and the surface's downward normal */
    double *incidence;
    double seconds;                                   /* of the processor, that the batch took */
    double *memory_;
} scan;

scan scan_begin(const camera *c);                     /* o and d; ends the program where there is no memory */
void scan_meet(scan *s, sgt_surface surface);         /* the rest */
void scan_end(scan *s);

static inline size_t scan_index(const scan *s, int line, int pixel)
{
    return (size_t)line * (size_t)s->camera.pixels + (size_t)pixel;
}

#ifdef __cplusplus
}
#endif
#endif
