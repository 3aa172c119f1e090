/* shade.h - the colour that a ray of the camera sees. */
#ifndef RENDER_SHADE_H
#define RENDER_SHADE_H
#include "camera.h"
#include "meet.h"
#include "sample.h"

/* Of one sample of a pixel. */
vec3 shade(const scene *s, const view *v, pixel p, uint32_t index, tally *sum);

#endif
