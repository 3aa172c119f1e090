// SPDX-License-Identifier: MIT
/* scan.c - rays as arrays, one batch, and then each point to its latitude, longitude and height. */
#include "scan.h"

#include "fail.h"
#include "geodetic.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

static const double DEGREE = 57.295779513082320877;

static void *room(size_t n, size_t size)
{
    void *p = calloc(n, size);
    if (!p) fail_input("out of memory for %zu pixels", n);
    return p;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

scan scan_begin(const camera *c)
{
    scan s = {.camera = *c, .rays = (size_t)c->lines * (size_t)c->pixels};
    double **array[] = {&s.o[0],  &s.o[1],      &s.o[2],     &s.d[0],      &s.d[1],   &s.d[2],
                        &s.range, &s.range_err, &s.p[0],     &s.p[1],      &s.p[2],   &s.n[0],
                        &s.n[1],  &s.n[2],      &s.latitude, &s.longitude, &s.height, &s.incidence};
    size_t arrays = sizeof array / sizeof *array;
    s.memory_ = room(arrays * s.rays, sizeof *s.memory_);
    for (size_t i = 0; i < arrays; i++) *array[i] = s.memory_ + i * s.rays;
    s.status = room(s.rays, sizeof *s.status);
    s.evals = room(s.rays, sizeof *s.evals);
    for (int line = 0; line < c->lines; line++) {
        station at = camera_station(c, line * c->line_time);
        for (int pixel = 0; pixel < c->pixels; pixel++) {
            size_t i = scan_index(&s, line, pixel);
            sgt_vec3 d = camera_look(c, &at, camera_angle(c, pixel));
            s.o[0][i] = at.place.x, s.o[1][i] = at.place.y, s.o[2][i] = at.place.z;
            s.d[0][i] = d.x, s.d[1][i] = d.y, s.d[2][i] = d.z;
        }
    }
    return s;
}

/* By the tangent, which is as good at 0 and 90 degrees as between. */
static double incidence(const scan *s, size_t i)
{
    double dx = s->d[0][i], dy = s->d[1][i], dz = s->d[2][i], nx = s->n[0][i], ny = s->n[1][i],
           nz = s->n[2][i];
    double x = dy * nz - dz * ny, y = dz * nx - dx * nz, z = dx * ny - dy * nx;
    return DEGREE * atan2(sqrt(x * x + y * y + z * z), -(dx * nx + dy * ny + dz * nz));
}

void scan_meet(scan *s, sgt_surface surface)
{
    /* tmin and tmax left NULL: from o on */
    sgt_rays rays = {.o = {s->o[0], s->o[1], s->o[2]}, .d = {s->d[0], s->d[1], s->d[2]}};
    sgt_hits hits = {.status = s->status, .evals = s->evals, .t = s->range, .t_err = s->range_err,
                     .p = {s->p[0], s->p[1], s->p[2]}, .n = {s->n[0], s->n[1], s->n[2]}};
    double began = now();
    s->met = sgt_intersect_batch(surface, s->rays, rays, hits, NULL);
    s->seconds = now() - began;
    s->undecided = 0;
    for (size_t i = 0; i < s->rays; i++) {
        geodetic g = {(double)NAN, (double)NAN, (double)NAN};
        if (s->status[i] > 0) g = geodetic_of((sgt_vec3){s->p[0][i], s->p[1][i], s->p[2][i]});
        s->latitude[i] = g.latitude, s->longitude[i] = g.longitude, s->height[i] = g.height;
        s->incidence[i] = s->status[i] > 0 ? incidence(s, i) : (double)NAN;
        s->undecided += s->status[i] < 0;
    }
}

void scan_end(scan *s)
{
    free(s->memory_);
    free(s->status);
    free(s->evals);
}
