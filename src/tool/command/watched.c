// SPDX-License-Identifier: MIT
/* watched.c - a ray through a lens, with every evaluation kept, element by element.
 *
 * A step does not say at which element it was made.  But sgt_trace stores the passage of an element before
 * it goes on to the next (system.h).  So all passages are marked before the trace, by a number of evaluations
 * that none can have.  At each step the elements that have lost their mark are done. */
#include "watched.h"

#include "../base/memory.h"
#include "../show/frame.h"

enum { NOT_YET = -1 };

int record_watch(void *data, const sgt_step *step)
{
    record *r = data;
    r->step = memory_room(r->step, r->count, &r->capacity, sizeof *r->step);
    r->step[r->count++] = *step;
    return 0;
}

watched watched_room(size_t elements)
{
    return (watched){.count = elements, .passage = memory_take(elements, sizeof(sgt_passage)),
                     .begin = memory_take(elements + 1, sizeof(size_t))};
}

static int watch_elements(void *data, const sgt_step *step)
{
    watched *w = data;
    while (w->passage[w->at].hit.evals != NOT_YET) w->begin[++w->at] = w->all.count;
    return record_watch(&w->all, step);
}

void watched_trace(watched *w, const sgt_element e[], double index_before, const sgt_ray *ray,
                   const sgt_options *opt)
{
    sgt_options own = *opt;
    sgt_ray from = *ray;
    own.watch = watch_elements, own.watch_data = w;
    w->launch = *ray;
    w->all.count = w->at = w->begin[0] = 0;
    for (size_t i = 0; i < w->count; i++) w->passage[i].hit.evals = NOT_YET;
    w->passed = sgt_trace(w->count, e, index_before, &from, w->passage, &w->fate, &own);
    while (w->at < w->count) w->begin[++w->at] = w->all.count;
}

record watched_at(const watched *w, size_t element)
{
    size_t begin = w->begin[element], count = w->begin[element + 1] - begin;
    return (record){.step = count ? w->all.step + begin : NULL, .count = count};
}

sgt_ray watched_ray(const watched *w, const lens *l, size_t element)
{
    if (element == 0) return w->launch;
    const sgt_passage *p = &w->passage[element - 1];
    const sgt_pose *pose = &l->element[element - 1].pose;
    return (sgt_ray){.o = frame_point_out(pose, p->hit.p), .d = frame_direction_out(pose, p->direction)};
}

sgt_arrival arrival_of(const lens *l, size_t element, sgt_vec3 o, sgt_vec3 direction, sgt_vec3 p)
{
    const sgt_pose *pose = &l->element[element].pose;
    const sgt_vec3 d = frame_direction_in(pose, direction);
    double length = vector_length(d);
    return (sgt_arrival){.from = frame_point_in(pose, o),
                         .direction = {d.x / length, d.y / length, d.z / length}, .p = p,
                         .index = element ? l->index[element - 1] : l->index_before,
                         .behind = l->index[element]};
}

sgt_arrival watched_arrival(const watched *w, const lens *l, size_t element)
{
    const sgt_ray ray = watched_ray(w, l, element);
    return arrival_of(l, element, ray.o, ray.d, w->passage[element].hit.p);
}
