// SPDX-License-Identifier: MIT
/* failed.h - why a ray ended at an element of a lens: the first lines of a diagnosis. */
#ifndef TOOL_FAILED_H
#define TOOL_FAILED_H
#include "../read/lens.h"
#include "../show/table.h"

#include <sagitta/why.h>

/* A ray at an element where it ended, or that it passed. */
typedef struct failed {
    const lens *lens;
    const sgt_element *element;  /* [lens->count] */
    size_t at;                   /* the element, from 0 */
    sgt_fate fate;               /* of the ray there */
    const sgt_ray *launch;       /* the ray as it was launched */
    size_t number;
    sgt_arrival come;
    const sgt_search *search;        /* for the root there, by the library */
} failed;

/* "Element 2 (sphere, stop): clipped by its semi_diameter: r = 5.2 is beyond 5", and the lines below it. */
void failed_explain(table *t, const failed *f);

#endif
