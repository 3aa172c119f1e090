// SPDX-License-Identifier: MIT
/* shade.h - the colours that rays of the camera see. */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H
#include "camera.h"
#include "meet.h"
#include "sample.h"

/* A ray of the camera, the index-th of its pixel, and the light it finds. */
typedef struct look { pixel pixel; uint32_t index; vec3 light; } look;

/* The memory that it takes; of one thread at a time. */
typedef struct desk desk;
desk *desk_new(void);
void desk_free(desk *d);

/* Fills in the light.  That of a look depends on its pixel and index alone, to the last bit, and
 * not on the others. */
void shade(const scene *s, const view *v, size_t n, look looks[], desk *d, tally *sum);

#endif
