// SPDX-License-Identifier: MIT
/* film.c - curves in time.
 *
 * Frame i is at i / rate seconds.  A track holds a value before its first time and after its last one.
 *
 * CATMULL-ROM (E. Catmull, R. Rom 1974) goes through its keys: between two, the cubic of Hermite whose slope
 * at a key is that between its neighbours, (v[i+1] - v[i-1]) / (t[i+1] - t[i-1]), at the ends that to the one
 * neighbour.  Value and slope are continuous, also where times are uneven.  It may overshoot its keys; what
 * then is out of range is an error, told before any frame is drawn.
 *
 * BEZIER: all values are the control points of one curve, by de Casteljau's scheme.  It stays within their
 * convex hull, and goes through the first and the last only.
 *
 * A frame is a function of its number: no frame depends on which others are drawn, or in what order. */
#include "film.h"

#include <sagitta/surfaces.h>
#include <stdio.h>
#include <string.h>

double film_along(const film *f, int frame) { return f->frames > 1 ? (double)frame / (f->frames - 1) : 0; }

static void bezier(const track *k, double time, double out[4])
{
    double v[MOST_KEYS][4], u = fmax(0, fmin(1, (time - k->time[0]) / (k->time[1] - k->time[0])));
    memcpy(v, k->value, sizeof v);
    for (int left = k->count - 1; left > 0; left--)
        for (int i = 0; i < left; i++)
            for (int c = 0; c < 4; c++) v[i][c] += u * (v[i + 1][c] - v[i][c]);
    memcpy(out, v[0], sizeof v[0]);
}

static double slope(const track *k, int i, int c)
{
    int a = i > 0 ? i - 1 : 0, b = i < k->count - 1 ? i + 1 : i;
    return (k->value[b][c] - k->value[a][c]) / (k->time[b] - k->time[a]);
}

static void catmull_rom(const track *k, double time, double out[4])
{
    int i = 0;
    while (i < k->count - 2 && time >= k->time[i + 1]) i++;
    double wide = k->time[i + 1] - k->time[i], u = fmax(0, fmin(1, (time - k->time[i]) / wide)), v = 1 - u;
    for (int c = 0; c < 4; c++)
        out[c] = v * v * (1 + 2 * u) * k->value[i][c] + u * u * (1 + 2 * v) * k->value[i + 1][c] +
                 u * v * wide * (v * slope(k, i, c) - u * slope(k, i + 1, c));
}

static bool set_object(object *o, const track *k, const double v[4])
{
    bool julia = o->surface.ops == &sgt_julia_ops;
    if (k->kind == TRACK_C && julia)
        memcpy(o->own.julia.c, v, sizeof o->own.julia.c);
    else if (k->kind == TRACK_SLICE && julia)
        o->own.julia.at[3] = v[0];
    else if (k->kind == TRACK_SLICE && o->surface.ops == &sgt_mandelbrot_ops)
        o->own.mandelbrot.at[3] = v[0];
    else
        return true;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (b->ops == o->surface.ops) return !b->object || !b->object(o->surface.self).param;
    return true;
}

static void still(path *p, const double v[4]) { *p = (path){1, {{v[0], v[1], v[2]}}}; }

bool film_set(scene *s, int frame, char why[FILM_WHY])
{
    const film *f = &s->film;
    for (int i = 0; i < f->tracks; i++) {
        const track *k = &f->track[i];
        double v[4];
        (k->bezier ? bezier : catmull_rom)(k, frame / f->rate, v);
        bool good = true;
        switch (k->kind) {
        case TRACK_POSITION:
            still(&s->camera.position, v);
            break;
        case TRACK_LOOK_AT:
            still(&s->camera.look_at, v);
            break;
        case TRACK_FIELD:
            good = v[0] >= 0.001 && v[0] <= 170;
            s->camera.field = v[0] * 0.017453292519943295;
            break;
        case TRACK_EXPOSURE:
            good = v[0] >= 0, s->exposure = v[0];
            break;
        case TRACK_C:
        case TRACK_SLICE:
            for (int n = 0; n < s->objects; n++)
                if (k->object < 0 || k->object == n) good = set_object(&s->object[n], k, v) && good;
        }
        if (!good) {
            snprintf(why, FILM_WHY, "frame %d: %s is out of range there: %g %g %g %g", frame + 1,
                     TRACK_NAMES[k->kind], v[0], v[1], v[2], v[3]);
            return false;
        }
    }
    return true;
}
