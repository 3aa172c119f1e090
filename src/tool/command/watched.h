// SPDX-License-Identifier: MIT
/* watched.h - a ray through a lens, with every evaluation kept, element by element. */
#ifndef TOOL_WATCHED_H
#define TOOL_WATCHED_H
#include "../read/lens.h"

#include <sagitta/diagnose.h>
#include <sagitta/why.h>

/* Evaluations, as they were made. */
typedef struct record { sgt_step *step; size_t count, capacity; } record;

/* An sgt_options.watch that appends to a record; data: the record. */
int record_watch(void *data, const sgt_step *step);

typedef struct watched {
    size_t count;           /* of elements */
    sgt_ray launch;
    sgt_passage *passage;   /* [count]: valid up to the element where the ray ended, which is included */
    size_t *begin;          /* [count + 1]: where the evaluations at each element begin in `all` */
    record all;
    size_t passed;          /* how many elements */
    sgt_fate fate;
    size_t at;              /* while it is traced: the element of the next evaluation */
} watched;

/* Room for one ray at a time through so many elements. */
watched watched_room(size_t elements);

/* Traces a ray through all elements.  opt: as sgt_trace takes them; their watcher is not called. */
void watched_trace(watched *w, const sgt_element e[], double index_before, const sgt_ray *ray,
                   const sgt_options *opt);

/* The evaluations at one element; they belong to w. */
record watched_at(const watched *w, size_t element);

/* The ray as it comes to an element of the lens that it went through: in the global frame, from the launch or
 * the element before; and in the element's own. */
sgt_ray watched_ray(const watched *w, const lens *l, size_t element);
sgt_arrival watched_arrival(const watched *w, const lens *l, size_t element);

/* The same of any global ray that meets the element at p. */
sgt_arrival arrival_of(const lens *l, size_t element, sgt_vec3 o, sgt_vec3 direction, sgt_vec3 p);

#endif
